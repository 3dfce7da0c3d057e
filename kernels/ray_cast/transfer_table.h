/* SPDX-License-Identifier: BSD-3-Clause
 * From values to light: the transfer function's table, a sample or a segment of it, and compositing front to back. */
#ifndef STRATUS_TRANSFER_TABLE_H
#define STRATUS_TRANSFER_TABLE_H

#include "packet_math.h"
#include "ray_segment.h"

/* Where a value falls in the table: its entry and a fraction. */
INLINE vfloat table_place(CONSTANT stratus_ray_cast_arguments* a, vfloat value)
{
  return v_clamp(v_fma(value, v_set(a->table_scale), v_set(a->table_offset)), 0.0f, a->table_last);
}

INLINE vint table_entry(CONSTANT stratus_ray_cast_arguments* a, vfloat value) { return v_to_int(table_place(a, value)); }

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

/* What a sample shows beside its value's colour and opacity: the optical depth times `factor`; a colour C of opacity A as C diffuse + A
 * specular. */
typedef struct stratus_lit_sample {
  vfloat factor, diffuse[3], specular[3];
} stratus_lit_sample;

INLINE void light_layer(const stratus_lit_sample* lighting, vfloat layer[4])
{
  for (int c = 0; c < 3; ++c) {
    layer[c] = v_fma(layer[c], lighting->diffuse[c], layer[3] * lighting->specular[c]);
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

/* Lanes whose ways from one entry to another meet an entry of opacity 1, and the first that each meets. rows: behind the sums. */
INLINE vmask opaque_on_the_way(CONSTANT stratus_ray_cast_arguments* a, GLOBAL const int* rows, vint from, vint to, vmask mask, vint* first)
{
  const vmask rises = vi_ge(to, from);
  *first = gather_int32(rows, from + vi_select(rises, vi_set(0), vi_set((int)a->table_last + 1)), mask);
  return mask & ((rises & vi_ge(to, *first)) | m_andnot(vi_ge(*first, to), rises));
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
INLINE vmask segment_shows(
  CONSTANT stratus_ray_cast_arguments* a, GLOBAL const int* sums, const stratus_packet* k, vmask mask, vfloat value)
{
  const vint entry = table_entry(a, value), front = table_entry(a, k->front);
  return mask & v_lt(v_set(0.0f), sum_between(a, sums, 3, vi_min(entry, front), vi_max(entry, front) + vi_set(1), mask));
}

/* Pre-integration between the values at a segment's ends, the field taken as linear in between. sums: running sums over the entries of red,
 * green, blue times tau, and tau. lighting: 0 where there is no more to a sample than its value. */
INLINE void integrate_lit(CONSTANT stratus_ray_cast_arguments* a, GLOBAL const int* sums, stratus_packet* k, vmask mask, vfloat value,
  vfloat weight, vfloat lo, const stratus_lit_sample* lighting)
{
  const vfloat zero = v_set(0.0f), one = v_set(1.0f);
  const vfloat place = table_place(a, value), front_place = table_place(a, k->front);
  /* most segments, even of occupied blocks, pass beside all that shows: they need not read the sums */
  mask = mask & v_lt(v_min(place, front_place), v_set(a->shown_beyond)) & v_le(v_set(a->shown_first), v_max(place, front_place));
  if (!m_any(mask)) {
    return;
  }
  const vint front = v_to_int(front_place);
  vint entry = v_to_int(place);
  vint low = vi_min(entry, front), beyond = vi_max(entry, front) + vi_set(1);
  vfloat depth_scale = weight * v_set(a->tau_scale), rise = value - k->front;
  vint opaque_entry = front;
  vmask opaque = m_none();
  if (a->has_opaque) {
    opaque = opaque_on_the_way(a, sums + 4 * ((int)a->table_last + 2), front, entry, mask & v_lt(zero, weight), &opaque_entry);
    if (m_any(opaque)) { /* the segment ends before that entry, which is put behind it */
      const vint before = vi_max(opaque_entry, front) - vi_min(opaque_entry, front);
      const vfloat part = v_from_int(before) * v_reciprocal(v_from_int(beyond - low));
      depth_scale = v_select(opaque, depth_scale * part, depth_scale);
      rise = v_select(opaque, rise * part, rise);
      entry = vi_select(opaque, vi_select(vi_ge(opaque_entry, front), opaque_entry - vi_set(1), opaque_entry + vi_set(1)), entry);
      mask = m_andnot(mask, opaque & vi_ge(vi_set(0), before));
      low = vi_select(mask, vi_min(entry, front), low);
      beyond = vi_select(mask, vi_max(entry, front) + vi_set(1), beyond);
    }
  }
  vfloat tau = sum_between(a, sums, 3, low, beyond, mask);
  mask = mask & v_lt(zero, tau);
  if (!m_any(mask | opaque)) {
    return;
  }
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
      if (lighting) {
        light_layer(lighting, layer);
      }
      composite(a, k, lit, layer, lo);
    }
    mask = mask & several & v_lt(piece, pieces);
  } while (m_any(mask));
  if (m_any(opaque)) {
    vfloat layer[4];
    const vint next = opaque_entry + vi_set(1);
    const vfloat per_tau = v_reciprocal(v_max(sum_between(a, sums, 3, opaque_entry, next, opaque), one));
    for (int c = 0; c < 3; ++c) {
      layer[c] = sum_between(a, sums, c, opaque_entry, next, opaque) * per_tau;
    }
    layer[3] = v_select(opaque, one, zero);
    if (lighting) {
      light_layer(lighting, layer);
    }
    composite(a, k, opaque, layer, lo);
  }
}

INLINE void integrate_segment(
  CONSTANT stratus_ray_cast_arguments* a, GLOBAL const int* sums, stratus_packet* k, vmask mask, vfloat value, vfloat weight, vfloat lo)
{
  integrate_lit(a, sums, k, mask, value, weight, lo, 0);
}

#endif
