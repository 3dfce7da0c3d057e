/* SPDX-License-Identifier: BSD-3-Clause
 * Lines of distance_field_body.h, which includes this file after its types. The lower envelope works on one line. The zigzag searches as
 * many lines, or as many voxels of a row, as a vector has lanes.
 *
 * The zigzag of a vector looks outward, n = 1, 2 .., and keeps c = best - n^2. This needs one subtraction a step and no sum that could
 * overflow. The search stops when no lane of c is above 0. */

/* ---- lower envelope */

/* Adds the parabola about u with height g to the hull of a run [first, end); returns the new top. */
FIELD_INLINE int64_t NAME(push)(field_hull* hull, int64_t top, int64_t u, int64_t g, int64_t first, int64_t end)
{
  while (top >= 0) {
    const field_hull h = hull[top];
    const int64_t old = h.start - h.at, now = h.start - u;
    if (old * old + h.height <= now * now + g) {
      break;
    }
    --top;
  }
  int64_t start = first;
  if (top >= 0) {
    const field_hull h = hull[top];
    /* The parabolas cross at h.start or beyond, so that the quotient is not negative. It is one of integers below 2^53, which never rounds
     * up to the next integer. */
    start = 1 + (int64_t)((double)(u * u - h.at * h.at + g - h.height) / (double)(2 * (u - h.at)));
  }
  if (start < end) {
    hull[++top] = (field_hull){ u, g, start };
  }
  return top;
}

/* Envelope of a line of signed squared distances. Each run of one sign needs only its own values and the zeros at its two ends: nothing
 * beyond these is nearer. */
static FIELD_TARGET void NAME(envelope_line)(const VALUE* s, int64_t n, field_hull* hull, VALUE* out)
{
  for (int64_t first = 0, end; first < n; first = end) {
    end = first + 1;
    if (s[first] == 0) {
      out[first] = 0;
      continue;
    }
    const int inside = s[first] < 0;
    while (end < n && s[end] != 0 && (s[end] < 0) == inside) {
      ++end;
    }
    int64_t top = first > 0 ? NAME(push)(hull, -1, first - 1, 0, first, end) : -1;
    for (int64_t i = first; i < end; ++i) {
      const int64_t height = inside ? -(int64_t)s[i] : s[i];
      top = height < FAR ? NAME(push)(hull, top, i, height, first, end) : top;
    }
    top = end < n ? NAME(push)(hull, top, end, 0, first, end) : top;
    for (int64_t i = end - 1; i >= first; --i) {
      const int64_t away = top >= 0 ? i - hull[top].at : 0, sum = top >= 0 ? away * away + hull[top].height : FAR;
      const VALUE far = sum < FAR ? (VALUE)sum : FAR;
      out[i] = inside ? (VALUE)-far : far;
      top -= top > 0 && i == hull[top].start;
    }
  }
}

/* ---- zigzag */

typedef struct NAME(aim) {
  vector c, inside; /* c = best - n^2 */
  int kinds;        /* bit 0: some lane outside can still get nearer, bit 1: some lane inside */
  int64_t n;        /* the next step */
} NAME(aim);
#define aim NAME(aim)

FIELD_INLINE aim NAME(take_aim)(vector target)
{
  aim a;
  a.inside = (vector)(target < 0);
  a.c = NAME(flip)(target, a.inside);
  a.kinds = NAME(positive)(target) | NAME(positive)(-a.inside) << 1;
  a.n = 1;
  return a;
}

/* Finds the range first..last of the line that holds targets for the kinds of `a`. */
FIELD_INLINE void NAME(range_of)(const aim* a, const field_range* range, int64_t* first, int64_t* last)
{
  const int some = a->kinds == 2, other = a->kinds != 1;
  *first = range[some].first < range[other].first ? range[some].first : range[other].first;
  *last = range[some].last > range[other].last ? range[some].last : range[other].last;
}

FIELD_INLINE void NAME(start_at)(aim* a, int64_t n)
{
  if (n > a->n) {
    a->n = n > FAR_LINE ? FAR_LINE : n; /* farther targets are not nearer than FAR */
  }
  a->c -= NAME(all)((VALUE)(a->n * a->n));
}

/* Searches at n*one and n*other from its own place, for n up to `last`. */
FIELD_INLINE void NAME(look)(aim* a, const VALUE* plus, const VALUE* minus, int64_t one, int64_t other, int64_t last)
{
  const VALUE* only = a->kinds == 1 ? plus : minus;
  vector c = a->c;
  int64_t n = a->n;
  if (a->kinds != 3) {
    for (; n <= last && NAME(positive)(c); ++n) {
      c = NAME(least)(c, NAME(least)(NAME(load)(only + n * one), NAME(load)(only + n * other)));
      c -= NAME(all)((VALUE)(2 * n + 1));
    }
  } else {
    for (; n <= last && NAME(positive)(c); ++n) {
      const vector out = NAME(least)(NAME(load)(plus + n * one), NAME(load)(plus + n * other));
      const vector in = NAME(least)(NAME(load)(minus + n * one), NAME(load)(minus + n * other));
      c = NAME(least)(c, NAME(select)(a->inside, in, out));
      c -= NAME(all)((VALUE)(2 * n + 1));
    }
  }
  a->c = c;
  a->n = n;
}

/* Squared distances found, at most FAR, without their sign. */
FIELD_INLINE vector NAME(found)(const aim* a)
{
  return a->c + NAME(all)((VALUE)(a->n * a->n));
}

/* Searches the vector at x of the row in r. Returns the number of steps. */
FIELD_INLINE int64_t NAME(search_row)(const room* r, const field_range* range, int64_t x, VALUE* out)
{
  aim a = NAME(take_aim)(NAME(load)(r->line + x));
  int64_t steps = 0;
  if (a.kinds) {
    int64_t first, last;
    NAME(range_of)(&a, range, &first, &last);
    const int64_t below = first - (x + LANES - 1), above = x - last;
    const int64_t left = x + LANES - 1 - first, right = last - x;
    NAME(start_at)(&a, below > above ? below : above);
    steps = -a.n;
    NAME(look)(&a, r->plus + x, r->minus + x, -1, 1, left > right ? left : right);
    steps += a.n;
    NAME(store)(out + x, NAME(flip)(NAME(found)(&a), a.inside));
  } else {
    NAME(store)(out + x, a.c);
  }
  return steps;
}

/* Searches entry k of a tile. Returns the number of steps. */
FIELD_INLINE int64_t NAME(search_tile)(const VALUE* plus, const VALUE* minus, const field_range* range, int64_t k, vector* out)
{
  const VALUE *p = plus + k * LANES, *m = minus + k * LANES;
  vector target = NAME(load)(p);
  if (plus != minus) {
    target -= NAME(load)(m);
  }
  aim a = NAME(take_aim)(target);
  int64_t steps = 0;
  if (a.kinds) {
    int64_t first, last;
    NAME(range_of)(&a, range, &first, &last);
    const int64_t left = k - first, right = last - k;
    NAME(start_at)(&a, left < 0 ? -left : -right);
    steps = -a.n;
    if (left > 0 && right > 0) {
      NAME(look)(&a, p, m, -LANES, LANES, left < right ? left : right);
    }
    if (left > right) {
      NAME(look)(&a, p, m, -LANES, -LANES, left);
    } else {
      NAME(look)(&a, p, m, LANES, LANES, right);
    }
    steps += a.n;
    *out = NAME(flip)(NAME(found)(&a), a.inside);
  } else {
    *out = a.c;
  }
  return steps;
}
