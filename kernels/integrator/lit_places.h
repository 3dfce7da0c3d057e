/* SPDX-License-Identifier: BSD-3-Clause
 * Light at shared places. A ray composites its stretches without light. Stretches that follow one another make a bundle, which is lit at
 * one place: the mean of its stretches' places, weighted by their opacities. Light along a ray is smooth. So the error of a bundle is, to
 * second order, half of its spread times the second derivative of light; the spread is the sum of opacities times squared distances from
 * the mean. A bundle is closed where its spread would pass a limit. Thus faint stretches, and those behind others, share a place over a
 * long way, and a stretch that makes most of a pixel has its own.
 *
 * Where normals are turned towards the eye, light jumps where the field turns along the ray, since there the normal is turned round. The
 * jump is found between the places of two bundles, where the slope along the ray is 0 if it is straight between them. The part of a bundle
 * that is on the other side takes the light that it has there: its stretches count as even over the extent that has their spread.
 *
 * Closed bundles wait until the packet has one for each lane. A bundle follows from its ray, and a ray adds up the light of its
 * bundles in their order, so that no pixel depends on the others of its packet. Included by ray_cast.h. */
#ifndef STRATUS_LIT_PLACES_H
#define STRATUS_LIT_PLACES_H

/* A ray before a stretch. */
typedef struct lit_before {
  vfloat transparency, red, green, blue, depth;
} lit_before;

INLINE lit_before lit_before_stretch(const stratus_packet* k)
{
  const lit_before before = { k->transparency, k->red, k->green, k->blue, k->depth };
  return before;
}

/* A stretch that a ray has composited: its opacity times what was left of the ray, its mean place and the spread of its places about that,
 * in samples. */
typedef struct lit_stretch {
  vfloat weight, place, spread, begin, end;
} lit_stretch;

/* Extinction counts as even along a stretch. Of the optical depth t and the opacity o the mean place is then 1 / t - (1 - o) / o of its
 * length, which this series in o follows to 0.003 at o = 1/2 and to 0.03 at 0.9. Stretches of more opacity are cut, unless they are short.
 */
INLINE lit_stretch lit_stretch_of(const lit_before* before, const stratus_packet* k, vfloat begin, vfloat length)
{
  lit_stretch s;
  s.weight = before->transparency - k->transparency;
  const vfloat o = s.weight * v_reciprocal(v_max(before->transparency, v_set(1e-30f)));
  vfloat mean = v_fma(o, v_set(-863.0f / 60480.0f), v_set(-3.0f / 160.0f));
  mean = v_fma(o, mean, v_set(-19.0f / 720.0f));
  mean = v_fma(o, mean, v_set(-1.0f / 24.0f));
  mean = v_fma(o, mean, v_set(-1.0f / 12.0f));
  mean = v_fma(o, mean, v_set(0.5f));
  s.place = v_fma(mean, length, begin);
  s.spread = s.weight * light_variance(o) * (length * length);
  s.begin = begin;
  s.end = begin + length;
  return s;
}

/* Takes back the stretches of the mask that spread too far to be lit at one place, and returns their lanes. parts: in how many they are to
 * be cut. */
INLINE vmask lit_take_back(stratus_packet* k, const lit_before* before, vmask mask, const lit_stretch* s, vfloat* parts)
{
  const vfloat limit = k->places.limit;
  mask = mask & v_lt(limit, s->spread);
  *parts = v_set(1.0f);
  if (m_any(mask)) {
    *parts = v_select(mask, light_parts(limit, s->spread), *parts);
    k->transparency = v_select(mask, before->transparency, k->transparency);
    k->red = v_select(mask, before->red, k->red);
    k->green = v_select(mask, before->green, k->green);
    k->blue = v_select(mask, before->blue, k->blue);
    k->depth = v_select(mask, before->depth, k->depth);
  }
  return mask;
}

INLINE void lit_begin(CONSTANT stratus_ray_cast_arguments* a, stratus_packet* k)
{
  stratus_lit_places* p = &k->places;
  const vfloat zero = v_set(0.0f);
  v_store(p->lit[0], k->red);
  v_store(p->lit[1], k->green);
  v_store(p->lit[2], k->blue);
  k->red = k->green = k->blue = zero;
  const vfloat voxels = v_reciprocal(v_max(v_dot3(k->d, k->d), v_set(1e-30f)));
  p->limit = v_set(a->lattice.light_spread) * voxels;
  p->gap = voxels * v_inverse_root(v_max(voxels, v_set(1e-30f)));
  p->reach = zero;
  p->weight = p->first = p->second = p->origin = zero;
  p->count = 0;
  for (int lane = 0; lane < STRATUS_WIDTH; ++lane) {
    p->lane[lane] = lane; /* entries that are not used read some place, too */
    p->place[lane] = p->opacity[lane] = p->color[0][lane] = p->color[1][lane] = p->color[2][lane] = 0.0f;
    p->last[lane].slope = 0.0f;
  }
}

/* Puts the lanes of the mask, one after the other, to an array. */
INLINE void lit_queue(float* queue, vmask mask, const int* lanes, int count, vfloat v)
{
#if STRATUS_WIDTH == 1
  (void)lanes;
  (void)count;
  queue[0] = mask ? v : queue[0];
#elif !defined(STRATUS_DEVICE) && STRATUS_ISA == 2
  (void)lanes;
  (void)count;
  _mm512_storeu_ps(queue, _mm512_maskz_compress_ps(mask, v)); /* the places behind the last lane are free */
#else
  float all[STRATUS_WIDTH];
  (void)mask;
  v_store(all, v);
  for (int i = 0; i < count; ++i) {
    queue[i] = all[lanes[i]];
  }
#endif
}

/* The numbers of these lanes. */
INLINE vfloat lit_of_lanes(vfloat v, const int* lanes)
{
#if STRATUS_WIDTH == 1
  (void)lanes;
  return v;
#elif !defined(STRATUS_DEVICE) && STRATUS_ISA == 2
  return _mm512_permutexvar_ps(_mm512_loadu_si512(lanes), v);
#else
  float all[STRATUS_WIDTH], picked[STRATUS_WIDTH];
  v_store(all, v);
  for (int i = 0; i < STRATUS_WIDTH; ++i) {
    picked[i] = all[lanes[i]];
  }
  return v_load(picked);
#endif
}

/* Closes the open bundles of the lanes in `mask`, which have these colours. The queue must have fewer entries than a packet has lanes. */
INLINE void lit_close(stratus_packet* k, vmask mask, vfloat red, vfloat green, vfloat blue)
{
  stratus_lit_places* p = &k->places;
  const vfloat each = v_reciprocal(v_max(p->weight, v_set(1e-30f))), mean = p->first * each, place = mean + p->origin;
  const vfloat variance = v_max(v_fma(v_set(0.0f) - mean, mean, p->second * each), v_set(1e-12f));
#if !defined(STRATUS_DEVICE) && STRATUS_ISA == 2
  const int count = m_count(mask);
  _mm512_storeu_si512(p->lane + p->count, _mm512_maskz_compress_epi32(mask, (__m512i)vi_lanes()));
#else
  int wanted[STRATUS_WIDTH], count = 0;
  vi_store(wanted, vi_select(mask, vi_set(1), vi_set(0)));
  for (int lane = 0; lane < STRATUS_WIDTH; ++lane) {
    p->lane[p->count + count] = lane;
    count += wanted[lane];
  }
#endif
  lit_queue(p->color[0] + p->count, mask, p->lane + p->count, count, red);
  lit_queue(p->color[1] + p->count, mask, p->lane + p->count, count, green);
  lit_queue(p->color[2] + p->count, mask, p->lane + p->count, count, blue);
  lit_queue(p->opacity + p->count, mask, p->lane + p->count, count, p->weight);
  lit_queue(p->place + p->count, mask, p->lane + p->count, count, place);
  lit_queue(p->extent + p->count, mask, p->lane + p->count, count, v_set(1.7320508f) * (variance * v_inverse_root(variance)));
  p->count += count;
}

/* The part of a bundle behind a place on its ray. */
INLINE float lit_behind(const stratus_lit_bundle* b, float place)
{
  const float part = (b->place + b->extent - place) / (2.0f * b->extent);
  return part > 0.0f ? part < 1.0f ? part : 1.0f : 0.0f;
}

/* Finds where light jumps between the last bundle of a ray and the next one, and turns the light of their parts that are on the other side.
 */
INLINE void lit_turn(stratus_lit_places* p, int lane, const stratus_lit_bundle* next)
{
  const stratus_lit_bundle* last = &p->last[lane];
  if ((last->slope < 0.0f) != (next->slope < 0.0f) && last->slope != 0.0f) {
    const float turn = last->place + (next->place - last->place) * (last->slope / (last->slope - next->slope));
    const float behind = lit_behind(last, turn), before = 1.0f - lit_behind(next, turn);
    for (int c = 0; c < 3; ++c) {
      p->lit[c][lane] += behind * last->turned[c] + before * next->turned[c];
    }
  }
  p->last[lane] = *next;
}
#endif

/* Lights the first closed bundles, as many as a packet has lanes. */
OUTLINE void RAY_NAME(lit_shade)(
  CONSTANT stratus_ray_cast_arguments* a, value_source values, GLOBAL const uchar* hidden, GLOBAL const void* table, stratus_packet* k)
{
  stratus_lit_places* p = &k->places;
  const int count = p->count < STRATUS_WIDTH ? p->count : STRATUS_WIDTH;
  const vmask mask = vi_lt(vi_lanes(), vi_set(count));
  const vfloat place = v_load(p->place), opacity = v_load(p->opacity);
  vfloat x[3], d[3];
  for (int c = 0; c < 3; ++c) {
    d[c] = lit_of_lanes(k->d[c], p->lane);
    x[c] = v_fma(place, d[c], lit_of_lanes(k->p[c], p->lane));
    if (RAY_RARE(RAY_PIECE, a->crop.has_piece)) {
      x[c] = v_min(v_max(x[c], v_set(a->crop.lit[0][c])), v_set(a->crop.lit[1][c]));
    }
  }
  vfloat g[3] = { v_set(0.0f), v_set(0.0f), v_set(0.0f) }, diffuse[3], specular[3];
  if (light_reflects(&a->light)) {
    RAY_NAME(ray_gradient)(a, values, k->grid, x, mask, g);
  }
  vfloat passing[8];
  if (a->light.near) {
    RAY_NAME(light_near)(a, values, hidden, table, k, x, mask, passing);
  }
  vfloat turned[6];
  light_at(&a->light, k->lights, a->light.near ? passing : 0, 0, x, d, g, diffuse, specular, a->light.turns ? turned : 0);
  float light[3][STRATUS_WIDTH], other[3][STRATUS_WIDTH], slope[STRATUS_WIDTH];
  for (int c = 0; c < 3; ++c) {
    v_store(light[c], v_fma(v_load(p->color[c]), diffuse[c], opacity * specular[c]));
  }
  if (a->light.turns) {
    v_store(slope, v_dot3(g, d));
    for (int c = 0; c < 3; ++c) {
      v_store(other[c], v_fma(v_load(p->color[c]), turned[c], opacity * turned[3 + c]));
    }
  }
  for (int i = 0; i < count; ++i) { /* one after the other, so that sums do not depend on how many are lit at once */
    const int lane = p->lane[i];
    for (int c = 0; c < 3; ++c) {
      p->lit[c][lane] += light[c][i];
    }
    if (a->light.turns) {
      const stratus_lit_bundle next = { p->place[i], p->extent[i], slope[i], { other[0][i], other[1][i], other[2][i] } };
      lit_turn(p, lane, &next);
    }
  }
  p->count -= count;
  if (p->count > 0) { /* the others move up */
    for (int c = 0; c < 3; ++c) {
      v_store(p->color[c], v_load(p->color[c] + STRATUS_WIDTH));
    }
    v_store(p->opacity, v_load(p->opacity + STRATUS_WIDTH));
    v_store(p->place, v_load(p->place + STRATUS_WIDTH));
    v_store(p->extent, v_load(p->extent + STRATUS_WIDTH));
    for (int i = 0; i < p->count; ++i) {
      p->lane[i] = p->lane[STRATUS_WIDTH + i];
    }
  }
}

/* Puts a stretch that the rays of `mask` have composited into their open bundles. */
INLINE void RAY_NAME(lit_pass)(CONSTANT stratus_ray_cast_arguments* a, value_source values, GLOBAL const uchar* hidden,
  GLOBAL const void* table, stratus_packet* k, const lit_before* before, vmask mask, const lit_stretch* s)
{
  stratus_lit_places* p = &k->places;
  const vfloat zero = v_set(0.0f);
  mask = mask & v_lt(k->transparency, before->transparency);
  if (!m_any(mask)) {
    return;
  }
  const vfloat weight = s->weight, place = s->place, own = s->spread;
  const vmask open = v_lt(zero, p->weight);
  p->origin = v_select(m_andnot(mask, open), place, p->origin);
  const vfloat away = place - p->origin, moved = weight * away;
  vfloat sum = p->weight + weight, first = p->first + moved, second = p->second + v_fma(moved, away, own);
  const vfloat spread = v_fma(first * v_reciprocal(v_max(sum, v_set(1e-30f))), zero - first, second);
  const vmask closes = mask & open & (v_lt(p->limit, spread) | v_lt(p->reach + p->gap, s->begin));
  if (m_any(closes)) {
    lit_close(k, closes, before->red, before->green, before->blue);
    k->red = v_select(closes, k->red - before->red, k->red);
    k->green = v_select(closes, k->green - before->green, k->green);
    k->blue = v_select(closes, k->blue - before->blue, k->blue);
    p->origin = v_select(closes, place, p->origin);
    sum = v_select(closes, weight, sum);
    first = v_select(closes, zero, first);
    second = v_select(closes, own, second);
  }
  p->reach = v_select(mask, s->end, p->reach);
  p->weight = v_select(mask, sum, p->weight);
  p->first = v_select(mask, first, p->first);
  p->second = v_select(mask, second, p->second);
  if (p->count >= STRATUS_WIDTH) {
    RAY_NAME(lit_shade)(a, values, hidden, table, k);
  }
}

/* Lights what is left, and gives the packet its colours. */
INLINE void RAY_NAME(lit_end)(
  CONSTANT stratus_ray_cast_arguments* a, value_source values, GLOBAL const uchar* hidden, GLOBAL const void* table, stratus_packet* k)
{
  stratus_lit_places* p = &k->places;
  lit_close(k, v_lt(v_set(0.0f), p->weight), k->red, k->green, k->blue);
  while (p->count > 0) {
    RAY_NAME(lit_shade)(a, values, hidden, table, k);
  }
  k->red = v_load(p->lit[0]);
  k->green = v_load(p->lit[1]);
  k->blue = v_load(p->lit[2]);
}
