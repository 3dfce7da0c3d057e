/* SPDX-License-Identifier: BSD-3-Clause
 * The inner loops of value_range.c for one type. value_range.c includes this file once for each type and defines
 *   TYPE     the type of the values
 *   ACC      the type of the extremes: TYPE itself for integers (a range of integers is exact and cheap), float for both floats
 *   NAME(f)  a function's name with the type's suffix
 *   LOAD(v)  a value as an ACC; `bias` is in scope
 *   FETCH(a) an ACC as the fetched value; `bias` is in scope
 *   FLOATS   1 if values may be NaN or infinite (as floats)
 * A row is a run of `nx` values along x. */

/* Row r of a span, copied to `scratch` if its values are apart. */
static const TYPE* NAME(row)(const span* s, int64_t r, void* scratch)
{
  const char* const values = s->values + (size_t)(r / s->ny) * s->pitch[2] + (size_t)(r % s->ny) * s->pitch[1];
  if (s->pitch[0] == sizeof(TYPE)) {
    return (const TYPE*)(const void*)values;
  }
  TYPE* copy = scratch;
  for (int64_t x = 0; x < s->nx; ++x) {
    copy[x] = *(const TYPE*)(const void*)(values + (size_t)x * s->pitch[0]);
  }
  return copy;
}

/* Widens lo and hi elementwise by four rows at once, so that the extremes are loaded and stored once for four values. NaN never wins a
 * comparison. Returns non-zero if a value is not finite; NAME(careful) must then remove infinities. */
static int NAME(widen)(const TYPE* const rows[4], int64_t nx, double bias, ACC* restrict lo, ACC* restrict hi)
{
  const TYPE* restrict a = rows[0], * restrict b = rows[1], * restrict c = rows[2], * restrict d = rows[3];
  int bad = 0;
  (void)bias;
  for (int64_t x = 0; x < nx; ++x) {
    const ACC va = LOAD(a[x]), vb = LOAD(b[x]), vc = LOAD(c[x]), vd = LOAD(d[x]);
#if FLOATS
    bad |= !(fabsf(va) <= FLT_MAX) | !(fabsf(vb) <= FLT_MAX) | !(fabsf(vc) <= FLT_MAX) | !(fabsf(vd) <= FLT_MAX);
#endif
    ACC least = lo[x], most = hi[x];
    least = va < least ? va : least;
    most = va > most ? va : most;
    least = vb < least ? vb : least;
    most = vb > most ? vb : most;
    least = vc < least ? vc : least;
    most = vc > most ? vc : most;
    lo[x] = vd < least ? vd : least;
    hi[x] = vd > most ? vd : most;
  }
  return bad;
}

/* Set lo[x] to the least of lo[x .. x+size], cut at the row's end, by doubling windows, and hi[x] to the greatest of hi[x .. x+size]. */
static void NAME(window)(int64_t nx, int size, ACC* lo, ACC* hi)
{
  for (int step = 1; step <= size; step *= 2) {
    const int64_t ahead = step < size ? step : 1; /* windows of 2, 4 .. size values, then one more value: the halo */
    for (int64_t x = 0; x < nx - ahead; ++x) {
      lo[x] = lo[x + ahead] < lo[x] ? lo[x + ahead] : lo[x];
      hi[x] = hi[x + ahead] > hi[x] ? hi[x + ahead] : hi[x];
    }
  }
}

#if FLOATS
/* Recompute lo and hi from only the finite values. bad[x]: a value of column x is not finite. */
static void NAME(careful)(const span* s, ACC* lo, ACC* hi, uint8_t* bad)
{
  const double bias = s->bias;
  (void)bias;
  for (int64_t x = 0; x < s->nx; ++x) {
    lo[x] = INFINITY;
    hi[x] = -INFINITY;
    bad[x] = 0;
  }
  for (int64_t r = 0; r < s->rows; ++r) {
    const TYPE* values = NAME(row)(s, r, s->strided);
    for (int64_t x = 0; x < s->nx; ++x) {
      const ACC v = LOAD(values[x]);
      const int finite = fabsf(v) <= FLT_MAX;
      bad[x] |= (uint8_t)!finite;
      lo[x] = finite && v < lo[x] ? v : lo[x];
      hi[x] = finite && v > hi[x] ? v : hi[x];
    }
  }
}
#endif

/* Sets the flags of the blocks that have columns with values that are not finite. */
static void NAME(flag)(span* s, const uint8_t* bad)
{
  (void)bad;
  for (int64_t b = 0; b < s->blocks; ++b) {
    s->gaps[b] = 0;
  }
  s->first_gap = 0;
#if FLOATS
  s->first_gap = bad ? bad[0] : 0;
  for (int64_t x = 0; bad && x < s->nx; ++x) {
    const int64_t at = s->lead + x, b = at / s->size;
    if (b < s->blocks) {
      s->gaps[b] |= bad[x];
    }
    if (at % s->size == 0 && b > 0) { /* the halo of the block before */
      s->gaps[b - 1] |= bad[x];
    }
  }
#endif
}

/* Reduces a row of blocks to their ranges, and the first values along x to theirs. */
static void NAME(reduce)(span* s)
{
  ACC *begin_lo = s->lo, *begin_hi = s->hi, *lo = begin_lo + s->lead, *hi = begin_hi + s->lead;
  const double bias = s->bias;
  int bad = 0;
  (void)bias;
  const TYPE* first = NAME(row)(s, 0, s->strided);
  for (int64_t x = 0; x < s->nx; ++x) {
    lo[x] = hi[x] = LOAD(first[x]);
  }
  for (int64_t r = 0; r < s->rows; r += 4) {
    const TYPE* rows[4];
    for (int64_t i = 0; i < 4; ++i) { /* where no row is left, the last one again, which changes nothing */
      const int64_t at = r + i < s->rows ? r + i : s->rows - 1;
      rows[i] = NAME(row)(s, at, (TYPE*)s->strided + i * s->nx);
    }
    bad |= NAME(widen)(rows, s->nx, bias, lo, hi);
  }
#if FLOATS
  if (bad) {
    NAME(careful)(s, lo, hi, s->bad);
  }
#endif
  NAME(flag)(s, bad ? s->bad : NULL);
  s->first_lo = FETCH(lo[0]) + 0.0f; /* -0 becomes 0: the order of zeros must not show in the bits */
  s->first_hi = FETCH(hi[0]) + 0.0f;
  for (int64_t x = 0; x < s->lead; ++x) { /* other parts have these values; those of the first column are of their block, too */
    begin_lo[x] = lo[0];
    begin_hi[x] = hi[0];
  }
  NAME(window)(s->lead + s->nx, s->size, begin_lo, begin_hi);
  for (int64_t b = 0; b < s->blocks; ++b) {
    const ACC least = begin_lo[b * s->size], most = begin_hi[b * s->size];
    s->block_lo[b] = FETCH(least) + 0.0f;
    s->block_hi[b] = FETCH(most) + 0.0f;
  }
}

#undef TYPE
#undef ACC
#undef NAME
#undef LOAD
#undef FETCH
#undef FLOATS
