/* SPDX-License-Identifier: BSD-3-Clause
 * The state of a packet on its march, and what does not depend on the type of the volume's values: which lanes ask the structure, the exit
 * of an empty cube, transfer function and compositing. */
#ifndef STRATUS_RAY_SEGMENT_H
#define STRATUS_RAY_SEGMENT_H

#include "ray_setup.h"

/* When the structure is asked: as soon as so many lanes need it, all that are left do, or one has waited so many samples. A lane that waits
 * takes samples which add nothing. */
#define SKIP_LANES STRATUS_WIDTH
#define SKIP_PATIENCE 64

/* What wide types are relative to, and an index into any volume. */
#ifdef STRATUS_DEVICE
#define BIAS_OF(a) as_double(((ulong)(uint)(a)->bias_high << 32) | (ulong)(uint)(a)->bias_low)
typedef ulong stratus_index;
#else
INLINE double stratus_bias(const stratus_ray_cast_arguments* a)
{
  const uint64_t bits = ((uint64_t)(uint32_t)a->bias_high << 32) | (uint64_t)(uint32_t)a->bias_low;
  double bias;
  memcpy(&bias, &bits, sizeof bias);
  return bias;
}
#define BIAS_OF(a) stratus_bias(a)
typedef uint64_t stratus_index;
#endif

typedef struct stratus_packet {
  vfloat p[3], d[3], inverse[3], begin, end, first;
  vfloat transparency, red, green, blue, depth;
  vfloat front; /* pre-integrated: value at the segment's front; extremes: the best so far; sums: the sum, whose weight is in `red` */
  vint i, last; /* segment, and the end of the ray in whole segments */
  vint run;     /* segments below it need not ask the structure */
  vint octant;  /* offset of the ray's map */
  vint samples, skipped, lookups;
  vmask live, hits; /* hits: rays that met the bounds */
  vmask fresh;      /* the front value is still to be sampled */
} stratus_packet;

/* What one sample of every ray finds in the segment [lo, lo + weight]. */
typedef struct stratus_sample {
  vfloat value, lo, weight;
  GLOBAL const void* values; /* of the volume that it is from */
  GLOBAL const uchar* hidden;
} stratus_sample;

#if STRATUS_WIDTH > 1 && (defined(STRATUS_DEVICE) ? defined(STRATUS_DEVICE_AVX512) : STRATUS_ISA == 2)
INLINE vint mask_int(vmask m) { return vi_select(m, vi_set(-1), vi_set(0)); }
#else
INLINE vint mask_int(vmask m) { return m; }
#endif

INLINE vfloat segment_middle(const stratus_packet* k, vfloat fi)
{
  return v_set(0.5f) * (v_max(fi, k->begin) + v_min(fi + v_set(1.0f), k->end));
}

INLINE vmask lanes_to_skip(const stratus_packet* k)
{
  const vmask need = k->live & vi_ge(k->i, k->run);
#if STRATUS_WIDTH > 1
  const int count = m_count(need);
  if (count && count < SKIP_LANES && count < m_count(k->live) && !m_any(k->live & vi_ge(k->i, k->run + vi_set(SKIP_PATIENCE)))) {
    return m_none();
  }
#endif
  return need;
}

INLINE vint gather_map(GLOBAL const uchar* map, vint index, vmask mask)
{
#if STRATUS_WIDTH == 1
  return mask ? (int)map[index] : 0;
#elif defined(STRATUS_DEVICE) && defined(STRATUS_DEVICE_AVX512)
  return STRATUS_GATHER(map, index, mask, 1) & (int16)(255);
#elif !defined(STRATUS_DEVICE) && STRATUS_ISA == 2
  return (vint)_mm512_mask_i32gather_epi32(_mm512_setzero_si512(), mask, (__m512i)index, map, 1) & vi_set(255);
#else
  int li[STRATUS_WIDTH];
  vi_store(li, vi_select(mask, index, vi_set(0)));
  for (int lane = 0; lane < STRATUS_WIDTH; ++lane) {
    li[lane] = map[li[lane]];
  }
  return vi_load(li);
#endif
}

/* In samples, where the rays leave the cube of blocks nearer than `distance`, told a little early: by more than the roundings of the division
 * and the product can amount to. */
INLINE vfloat cube_exit(CONSTANT stratus_ray_cast_arguments* a, const stratus_packet* k, const vint block[3], vint distance)
{
  vfloat leave = v_set(1e7f);
  for (int axis = 0; axis < 3; ++axis) {
    const vmask forward = v_lt(v_set(0.0f), k->inverse[axis]);
    const vint face = vi_select(forward, block[axis] + distance, block[axis] - distance + vi_set(1));
    const vfloat plane = v_from_int(face << vi_set(a->block_log2));
    leave = v_min((plane - k->p[axis]) * k->inverse[axis], leave);
  }
  return v_max(v_fma(leave, v_set(-0x1p-21f), leave - v_set(0x1p-10f)), v_set(0.0f));
}

/* No ray of the packet at pixel (x, y) can meet anything. */
INLINE int packet_outside(CONSTANT stratus_ray_cast_arguments* a, int x, int y)
{
  return x + PACKET_X <= a->window[0] || x >= a->window[1] || y + PACKET_Y <= a->window[2] || y >= a->window[3];
}

/* What a packet that has seen nothing holds. */
INLINE void packet_nothing(stratus_packet* k)
{
  k->samples = vi_set(0);
  k->skipped = vi_set(0);
  k->lookups = vi_set(0);
  k->transparency = v_set(1.0f);
  k->red = k->green = k->blue = k->front = v_set(0.0f);
  k->depth = v_set(LARGEST_FLOAT);
  k->live = k->hits = k->fresh = m_none();
}

/* Rays to packet: whole segments, the owned part, and the box of what can be seen. */
INLINE void packet_begin(CONSTANT stratus_ray_cast_arguments* a, const stratus_rays* rays, vmask inside, stratus_packet* k)
{
  const vfloat zero = v_set(0.0f), most = v_set(8e6f);
  packet_nothing(k);
  k->begin = v_load(rays->begin);
  k->end = v_load(rays->end);
  k->live = inside & v_lt(k->begin, k->end);
  k->hits = k->live;
  k->begin = v_select(k->live, k->begin, zero);
  k->end = v_select(k->live, k->end, zero); /* lanes that are not live stay at a harmless place */
  k->first = v_load(rays->first);
  k->octant = vi_set(0);
  for (int axis = 0; axis < 3; ++axis) {
    k->p[axis] = v_load(rays->p[axis]);
    k->d[axis] = v_load(rays->d[axis]);
    k->inverse[axis] = v_load(rays->inverse[axis]);
    const vmask forward = v_lt(zero, k->inverse[axis]);
    k->octant = k->octant + vi_select(forward, vi_set(a->octant_stride << axis), vi_set(0));
  }
  const vint whole = v_to_int(v_min(k->end, most));
  k->last = vi_select(k->live & v_lt(v_from_int(whole), k->end), whole + vi_set(1), whole);
  k->i = vi_set(0);
  if (a->has_piece) { /* segments whose middle lies in [piece_begin, piece_end) */
    const vfloat from = v_clamp(v_load(rays->piece_begin) + v_set(0.5f), 0.0f, 8e6f),
                 to = v_clamp(v_load(rays->piece_end) + v_set(0.5f), 0.0f, 8e6f);
    const vint i0 = v_to_int(from), i1 = v_to_int(to);
    k->i = vi_select(v_lt(v_from_int(i0), from), i0, i0 - vi_set(1));
    k->i = vi_max(k->i, vi_set(0));
    k->last = vi_min(k->last, vi_select(v_lt(v_from_int(i1), to), i1, i1 - vi_set(1)));
  }
  k->run = vi_set(0x7fffffff);
  if (a->structure) {
    vfloat enter = zero, leave = most;
    for (int axis = 0; axis < 3; ++axis) {
      const vfloat lo = (v_set(a->occupied[0][axis]) - k->p[axis]) * k->inverse[axis];
      const vfloat hi = (v_set(a->occupied[1][axis]) - k->p[axis]) * k->inverse[axis];
      enter = v_max(enter, v_min(lo, hi));
      leave = v_min(v_max(lo, hi), leave);
    }
    /* one segment of slack each way, and a miss ends here */
    const vint i0 = vi_max(v_to_int(v_min(enter, most)) - vi_set(1), k->i);
    const vint i1 = vi_min(
      vi_select(v_lt(leave, v_fma(enter, v_set(0.999999f), v_set(-1.0f))), vi_set(0), v_to_int(v_max(leave, zero)) + vi_set(2)), k->last);
    const vint segments = vi_max(k->last - k->i, vi_set(0)), left = vi_max(i1 - i0, vi_set(0));
    k->skipped = vi_select(k->live, segments - left, vi_set(0));
    k->i = i0;
    k->last = i1;
    k->run = vi_set(0);
  }
  k->last = vi_select(k->live, k->last, vi_set(0));
  k->live = k->live & vi_lt(k->i, k->last);
}

/* Which byte of one a cell, or (by_value) a value, is that of the cell, or the nearest value, at index coordinates x, y, z. */
INLINE size_t hidden_place(CONSTANT stratus_ray_cast_arguments* a, int by_value, float x, float y, float z)
{
  const float place[3] = { x, y, z };
  size_t cell = 0;
  for (int axis = 2; axis >= 0; --axis) {
    const int between = a->dimensions[axis] > 1 ? a->dimensions[axis] - 1 : 1, cells = by_value ? a->dimensions[axis] : between;
    const int at = (int)(by_value ? place[axis] + 0.5f : place[axis]);
    cell = cell * (size_t)cells + (size_t)(at < cells ? at : cells - 1);
  }
  return cell;
}

/* value, or a NaN where `what` of HIDDEN_CELLS and HIDDEN_BY_MASK takes it out. */
INLINE vfloat ray_hide_by(
  CONSTANT stratus_ray_cast_arguments* a, GLOBAL const uchar* hidden, int what, const vfloat x[3], vmask mask, vfloat value)
{
  float lx[3][STRATUS_WIDTH], lv[STRATUS_WIDTH];
  int lm[STRATUS_WIDTH];
  v_store(lv, value);
  vi_store(lm, vi_select(mask, vi_set(1), vi_set(0)));
  for (int axis = 0; axis < 3; ++axis) {
    v_store(lx[axis], x[axis]);
  }
  for (int lane = 0; lane < STRATUS_WIDTH; ++lane) {
    if (lm[lane]) {
      const float x0 = lx[0][lane], x1 = lx[1][lane], x2 = lx[2][lane];
      size_t masked = 0; /* bytes of the mask, which come first */
      if (a->has_hidden & (HIDDEN_BY_MASK | HIDDEN_LABELS)) {
        masked = (size_t)a->dimensions[0] * (size_t)a->dimensions[1] * (size_t)a->dimensions[2];
      }
      if (what & HIDDEN_BY_MASK) {
        lv[lane] = hidden[hidden_place(a, 1, x0, x1, x2)] ? lv[lane] : NAN;
      }
      if (what & HIDDEN_CELLS) { /* a byte a cell between values; a byte a value where those of cells are taken as they are */
        lv[lane] = hidden[masked + hidden_place(a, a->clamp && a->nearest, x0, x1, x2)] ? NAN : lv[lane];
      }
    }
  }
  return v_load(lv);
}

INLINE vfloat ray_hide(CONSTANT stratus_ray_cast_arguments* a, GLOBAL const uchar* hidden, const vfloat x[3], vmask mask, vfloat value)
{
  return ray_hide_by(a, hidden, a->has_hidden, x, mask, value);
}

/* 1/a to a rounding or two, by Newton's iteration from the bits: the same on every device, as a division is not. a > 0. */
INLINE vfloat v_reciprocal(vfloat a)
{
  const vint bits = v_to_bits(a), magnitude = bits & vi_set(0x7fffffff); /* lanes that count for nothing may be negative */
  vfloat r = v_from_bits((vi_set(0x7ef311c7) - magnitude) | (bits - magnitude));
  for (int iteration = 0; iteration < 3; ++iteration) {
    r = v_fma(r, v_fma(v_set(0.0f) - a, r, v_set(1.0f)), r);
  }
  return r;
}

/* The same of 1/sqrt(a). a > 0. */
INLINE vfloat v_inverse_root(vfloat a)
{
  const vfloat half_a = v_set(0.5f) * a;
  vfloat r = v_from_bits(vi_set(0x5f375a86) - (v_to_bits(a) >> vi_set(1)));
  for (int iteration = 0; iteration < 4; ++iteration) {
    r = r * v_fma(v_set(0.0f) - half_a * r, r, v_set(1.5f));
  }
  return r;
}

/* 1 - exp(-x), x >= 0, to some 3e-7 of its value: x = n ln 2 + t, a series in t, 2^-n by its bits. */
INLINE vfloat v_absorbed(vfloat x)
{
  const vint n = v_to_int(v_min(x, v_set(80.0f)) * v_set(1.44269504f));
  const vfloat t = v_max(v_fma(v_from_int(n), v_set(-0.69314718f), x), v_set(0.0f)), minus = v_set(0.0f) - t;
  vfloat series = v_set(1.0f / 40320.0f);
  series = v_fma(series, minus, v_set(1.0f / 5040.0f));
  series = v_fma(series, minus, v_set(1.0f / 720.0f));
  series = v_fma(series, minus, v_set(1.0f / 120.0f));
  series = v_fma(series, minus, v_set(1.0f / 24.0f));
  series = v_fma(series, minus, v_set(1.0f / 6.0f));
  series = v_fma(series, minus, v_set(0.5f));
  series = v_fma(series, minus, v_set(1.0f)) * t;
  const vfloat scale = v_from_bits((vi_set(127) - n) << vi_set(23));
  return v_min(v_fma(scale, series, v_set(1.0f) - scale), v_set(1.0f));
}

/* Where a value falls in the table: its entry and a fraction. */
INLINE vfloat table_place(CONSTANT stratus_ray_cast_arguments* a, vfloat value)
{
  return v_clamp(v_fma(value, v_set(a->table_scale), v_set(a->table_offset)), 0.0f, a->table_last);
}

INLINE vint table_entry(CONSTANT stratus_ray_cast_arguments* a, vfloat value)
{
  return v_to_int(table_place(a, value));
}

/* Four consecutive floats (as bits) from table + 4 entry; 0 in other lanes. */
INLINE void gather_four(GLOBAL const float* table, vint entry, vmask mask, vfloat out[4])
{
#if STRATUS_WIDTH == 1
  for (int c = 0; c < 4; ++c) {
    out[c] = mask ? table[4 * entry + c] : 0.0f;
  }
#elif defined(STRATUS_DEVICE) && defined(STRATUS_DEVICE_AVX512)
  const int16 twice = entry + entry;
  for (int c = 0; c < 4; c += 2) {
    const int16 low = STRATUS_GATHER_LONG(table + c, twice.lo, (uchar)mask, 8),
                high = STRATUS_GATHER_LONG(table + c, twice.hi, (uchar)(mask >> 8), 8);
    out[c] = as_float16((int16)(low.even, high.even));
    out[c + 1] = as_float16((int16)(low.odd, high.odd));
  }
#elif !defined(STRATUS_DEVICE) && STRATUS_ISA == 2
  const __m512i even = _mm512_setr_epi32(0, 2, 4, 6, 8, 10, 12, 14, 16, 18, 20, 22, 24, 26, 28, 30);
  const __m512i odd = _mm512_setr_epi32(1, 3, 5, 7, 9, 11, 13, 15, 17, 19, 21, 23, 25, 27, 29, 31);
  const __m512i zero = _mm512_setzero_si512(), twice = (__m512i)(entry + entry);
  for (int c = 0; c < 4; c += 2) {
    const __m512i low = _mm512_mask_i32gather_epi64(zero, (__mmask8)mask, _mm512_castsi512_si256(twice), table + c, 8);
    const __m512i high = _mm512_mask_i32gather_epi64(zero, (__mmask8)(mask >> 8), _mm512_extracti64x4_epi64(twice, 1), table + c, 8);
    out[c] = _mm512_castsi512_ps(_mm512_permutex2var_epi32(low, even, high));
    out[c + 1] = _mm512_castsi512_ps(_mm512_permutex2var_epi32(low, odd, high));
  }
#else
  int li[STRATUS_WIDTH];
  float lv[4][STRATUS_WIDTH];
  vi_store(li, vi_select(mask, entry, vi_set(-1)));
  for (int lane = 0; lane < STRATUS_WIDTH; ++lane) {
    for (int c = 0; c < 4; ++c) {
      lv[c][lane] = li[lane] >= 0 ? table[4 * li[lane] + c] : 0.0f;
    }
  }
  for (int c = 0; c < 4; ++c) {
    out[c] = v_load(lv[c]);
  }
#endif
}

/* Puts a layer of colour (times alpha) and alpha behind what the rays have gathered. lo: where its segment begins. */
INLINE void composite(CONSTANT stratus_ray_cast_arguments* a, stratus_packet* k, vmask mask, const vfloat layer[4], vfloat lo)
{
  if (a->want_depth) {
    const vmask hit = mask & v_lt(v_set(0.0f), layer[3]) & v_le(v_set(LARGEST_FLOAT), k->depth);
    k->depth = v_select(hit, (lo + k->first) * v_set(a->world_step), k->depth);
  }
  k->red = v_fma(k->transparency, layer[0], k->red);
  k->green = v_fma(k->transparency, layer[1], k->green);
  k->blue = v_fma(k->transparency, layer[2], k->blue);
  k->transparency = v_fma(v_set(0.0f) - k->transparency, layer[3], k->transparency);
}

/* Layers of whole segments made those of a part of the optical depth: `weight` of it. */
INLINE void shorten_layer(
  CONSTANT stratus_ray_cast_arguments* a, GLOBAL const float* table, vint entry, vmask mask, vfloat weight, vfloat layer[4])
{
  const vmask part = mask & v_lt(weight, v_set(1.0f)) & v_lt(v_set(0.0f), layer[3]);
  if (m_any(part)) { /* the ends of a ray */
    vfloat last[4];
    gather_four(table + 4 * ((int)a->table_last + 1), entry, part, last);
    const vfloat alpha = v_absorbed(last[0] * weight),
                 ratio = v_select(part, alpha * v_reciprocal(v_max(layer[3], v_set(1e-30f))), v_set(1.0f));
    for (int c = 0; c < 4; ++c) {
      layer[c] = layer[c] * ratio;
    }
  }
}

/* What a sample shows beside its value's colour and opacity: the optical depth times `factor`; a colour C of opacity A as C diffuse + A specular. */
typedef struct stratus_look {
  vfloat factor, diffuse[3], specular[3];
} stratus_look;

INLINE void light_layer(const stratus_look* look, vfloat layer[4])
{
  for (int c = 0; c < 3; ++c) {
    layer[c] = v_fma(layer[c], look->diffuse[c], layer[3] * look->specular[c]);
  }
}

/* Midpoint rule. table: colour times alpha and alpha of a whole segment, an entry each; then the entries' optical depths. */
INLINE void shade_sample(
  CONSTANT stratus_ray_cast_arguments* a, GLOBAL const float* table, stratus_packet* k, vmask mask, vfloat value, vfloat weight, vfloat lo)
{
  const vint entry = table_entry(a, value);
  vfloat layer[4];
  gather_four(table, entry, mask, layer);
  shorten_layer(a, table, entry, mask, weight, layer);
  composite(a, k, mask, layer, lo);
}

/* One int of each lane from table[index], 0 in other lanes. */
INLINE vint gather_int32(GLOBAL const int* table, vint index, vmask mask)
{
#if STRATUS_WIDTH == 1
  return mask ? table[index] : 0;
#elif defined(STRATUS_DEVICE) && defined(STRATUS_DEVICE_AVX512)
  return STRATUS_GATHER(table, index, mask, 4);
#elif !defined(STRATUS_DEVICE) && STRATUS_ISA == 2
  return (vint)_mm512_mask_i32gather_epi32(_mm512_setzero_si512(), mask, (__m512i)index, table, 4);
#else
  int li[STRATUS_WIDTH], lv[STRATUS_WIDTH];
  vi_store(li, vi_select(mask, index, vi_set(-1)));
  for (int lane = 0; lane < STRATUS_WIDTH; ++lane) {
    lv[lane] = li[lane] >= 0 ? table[li[lane]] : 0;
  }
  return vi_load(lv);
#endif
}

/* Sum number `which` (0..2 red, green, blue times tau, 3 tau) over entries low..beyond-1. Differences of ints are exact, so a transparent
 * stretch gives exactly zero. */
INLINE vfloat sum_between(CONSTANT stratus_ray_cast_arguments* a, GLOBAL const int* sums, int which, vint low, vint beyond, vmask mask)
{
  GLOBAL const int* sum = sums + which * ((int)a->table_last + 2);
  return v_from_int(gather_int32(sum, beyond, mask) - gather_int32(sum, low, mask));
}

/* Into how many pieces a segment goes, so that averaging the colour of each is wrong by little: from optical depth and the most that the
 * colour can change over its entries. The error falls with the square of the number. */
INLINE vfloat segment_pieces(CONSTANT stratus_ray_cast_arguments* a, vfloat depth, vfloat entries)
{
  const vfloat q = depth * entries * v_set(a->color_slope), zero = v_set(0.0f), one = v_set(1.0f);
  vfloat pieces = one + v_select(v_lt(one, q), one, zero) + v_select(v_lt(v_set(4.0f), q), one, zero);
  pieces = pieces + v_select(v_lt(v_set(9.0f), q), v_set(2.0f), zero) + v_select(v_lt(v_set(25.0f), q), v_set(3.0f), zero);
  return pieces + v_select(v_lt(v_set(64.0f), q), v_set(8.0f), zero);
}

/* Of lanes in the mask, those whose segments show anything. */
INLINE vmask segment_shows(CONSTANT stratus_ray_cast_arguments* a, GLOBAL const int* sums, const stratus_packet* k, vmask mask, vfloat value)
{
  const vint entry = table_entry(a, value), front = table_entry(a, k->front);
  return mask & v_lt(v_set(0.0f), sum_between(a, sums, 3, vi_min(entry, front), vi_max(entry, front) + vi_set(1), mask));
}

/* Pre-integration between the values at a segment's ends, the field taken as linear in between. sums: running sums over the entries of red,
 * green, blue times tau, and tau. look: 0 where there is no more to a sample than its value. */
INLINE void integrate_look(CONSTANT stratus_ray_cast_arguments* a, GLOBAL const int* sums, stratus_packet* k, vmask mask, vfloat value,
  vfloat weight, vfloat lo, const stratus_look* look)
{
  const vfloat zero = v_set(0.0f), one = v_set(1.0f);
  const vfloat place = table_place(a, value), front_place = table_place(a, k->front);
  /* most segments, even of occupied blocks, pass beside all that shows: they need not read the sums */
  mask = mask & v_lt(v_min(place, front_place), v_set(a->shown_beyond)) & v_le(v_set(a->shown_first), v_max(place, front_place));
  if (!m_any(mask)) {
    return;
  }
  const vint entry = v_to_int(place), front = v_to_int(front_place);
  vint low = vi_min(entry, front), beyond = vi_max(entry, front) + vi_set(1);
  vfloat tau = sum_between(a, sums, 3, low, beyond, mask);
  mask = mask & v_lt(zero, tau);
  if (!m_any(mask)) {
    return;
  }
  const vfloat depth_scale = weight * v_set(a->tau_scale), rise = value - k->front;
  vfloat entries = v_from_int(beyond - low);
  const vfloat pieces = segment_pieces(a, tau * depth_scale * v_reciprocal(v_max(entries, one)), entries);
  const vmask several = mask & v_lt(one, pieces);
  vfloat share = one, piece = zero;
  vint from = front;
  if (m_any(several)) {
    share = v_select(several, v_reciprocal(pieces), one);
  }
  do {
    vint to = entry;
    if (m_any(several)) { /* of several pieces, this one; the last ends where the segment does */
      piece = piece + one;
      to = vi_select(v_lt(piece, pieces), table_entry(a, v_fma(rise, piece * share, k->front)), entry);
      low = vi_min(from, to);
      beyond = vi_max(from, to) + vi_set(1);
      entries = v_from_int(beyond - low);
      tau = sum_between(a, sums, 3, low, beyond, mask);
      from = to;
    }
    const vmask lit = mask & v_lt(zero, tau);
    if (m_any(lit)) {
      vfloat layer[4];
      const vfloat depth = tau * (depth_scale * share) * v_reciprocal(v_max(entries, one));
      layer[3] = v_select(lit, v_absorbed(v_select(lit, depth, zero)), zero);
      const vfloat per_tau = v_select(lit, layer[3] * v_reciprocal(v_max(tau, one)), zero);
      for (int c = 0; c < 3; ++c) {
        layer[c] = sum_between(a, sums, c, low, beyond, lit) * per_tau;
      }
      if (look) {
        light_layer(look, layer);
      }
      composite(a, k, lit, layer, lo);
    }
    mask = mask & several & v_lt(piece, pieces);
  } while (m_any(mask));
}

INLINE void integrate_segment(
  CONSTANT stratus_ray_cast_arguments* a, GLOBAL const int* sums, stratus_packet* k, vmask mask, vfloat value, vfloat weight, vfloat lo)
{
  integrate_look(a, sums, k, mask, value, weight, lo, 0);
}

#endif
