/* SPDX-License-Identifier: BSD-3-Clause
 * Light behind light: layers of colour and opacity are composited front to back. */
#ifndef STRATUS_RAY_COMPOSITE_H
#define STRATUS_RAY_COMPOSITE_H

#include "layer.h"

/* Composites a layer, colour times alpha and alpha, behind what the rays have gathered. lo: where its segment begins. */
INLINE void composite(CONSTANT stratus_ray_cast_arguments* a, stratus_packet* k, vmask mask, const vfloat layer[4], vfloat lo)
{
  if (a->picture.want_depth) {
    const vmask hit = mask & v_lt(v_set(0.0f), layer[3]) & v_le(v_set(LARGEST_FLOAT), k->depth);
    k->depth = v_select(hit, packet_length(a, k, lo + k->first) * v_set(a->lattice.step), k->depth);
  }
  k->red = v_fma(k->transparency, layer[0], k->red);
  k->green = v_fma(k->transparency, layer[1], k->green);
  k->blue = v_fma(k->transparency, layer[2], k->blue);
  k->transparency = v_fma(v_set(0.0f) - k->transparency, layer[3], k->transparency);
}

/* Where a ray keeps only one of its surfaces (mode.kept), which it counts in `front`: forgets the surface that the rays of the mask have
 * composited, or ends there. A surface whose opacity is lost in 1 doesn't count, because its pixel shows nothing. */
INLINE void surface_kept(CONSTANT stratus_ray_cast_arguments* a, stratus_packet* k, vmask mask)
{
  if (a->mode.kept) {
    const vfloat zero = v_set(0.0f), one = v_set(1.0f), number = v_set((float)a->mode.kept);
    const vmask shown = mask & v_lt(k->transparency, one);
    k->front = v_select(shown, k->front + one, k->front);
    const vmask passed = shown & v_lt(k->front, number);
    k->red = v_select(passed, zero, k->red);
    k->green = v_select(passed, zero, k->green);
    k->blue = v_select(passed, zero, k->blue);
    k->transparency = v_select(passed, one, k->transparency);
    k->depth = v_select(passed, v_set(LARGEST_FLOAT), k->depth);
    k->live = m_andnot(k->live, m_andnot(shown, passed));
  }
}

/* The midpoint rule. table: for each entry colour times alpha, and alpha, of a whole segment; behind these each entry's optical depth. */
INLINE void shade_sample(
  CONSTANT stratus_ray_cast_arguments* a, GLOBAL const float* table, stratus_packet* k, vmask mask, vfloat value, vfloat weight, vfloat lo)
{
  const vint entry = table_entry(&a->table, table, value);
  vfloat layer[4];
  gather_four(table, entry, mask, layer);
  scale_layer(a, table, entry, mask, weight, layer);
  composite(a, k, mask, layer, lo);
}

/* Pre-integration: the field counts as linear between the values at a segment's ends. sums: running sums of red, green and blue times tau,
 * and of tau, up to each entry. lighting: NULL if a sample has only its value's colour and opacity. */
INLINE void integrate_lit(CONSTANT stratus_ray_cast_arguments* a, GLOBAL const int* sums, stratus_packet* k, vmask mask, vfloat value,
  vfloat weight, vfloat lo, const stratus_lit_sample* lighting)
{
  const vfloat zero = v_set(0.0f), one = v_set(1.0f);
  const vfloat place = table_place(&a->table, value), front_place = table_place(&a->table, k->front);
  /* most segments, even in occupied blocks, miss all that shows, and need not read the sums */
  mask =
    mask & v_lt(v_min(place, front_place), v_set(a->table.shown_beyond)) & v_le(v_set(a->table.shown_first), v_max(place, front_place));
  if (!m_any(mask)) {
    return;
  }
  const vint front = entry_in_cell(&a->table, sums, v_to_int(front_place), k->front, mask);
  vint entry = entry_in_cell(&a->table, sums, v_to_int(place), value, mask);
  vint low = vi_min(entry, front), beyond = vi_max(entry, front) + vi_set(1);
  vfloat depth_scale = weight * v_set(a->table.tau_scale), rise = value - k->front, begin = k->front;
  if (RAY_RARE(RAY_CUT, a->table.cut)) { /* values beyond the table are transparent, and have no part in the means */
    const vfloat from = v_clamp(v_fma(k->front, v_set(a->table.scale), v_set(a->table.offset)), -1e30f, 1e30f),
                 to = v_clamp(v_fma(value, v_set(a->table.scale), v_set(a->table.offset)), -1e30f, 1e30f);
    const vmask beyond_table = mask & (v_lt(v_min(from, to), zero) | v_lt(v_set(a->table.last + 1.0f), v_max(from, to)));
    if (m_any(beyond_table)) {
      vfloat before, part;
      part_within(&a->table, from, to, &before, &part);
      begin = v_select(beyond_table, v_fma(rise, before, begin), begin);
      rise = v_select(beyond_table, rise * part, rise);
      depth_scale = v_select(beyond_table, depth_scale * part, depth_scale);
    }
  }
  vint opaque_entry = front;
  vmask opaque = m_none();
  if (RAY_RARE(RAY_OPAQUE, a->table.has_opaque)) {
    opaque = opaque_on_the_way(&a->table, sums + 4 * (a->table.entries + 1), front, entry, mask & v_lt(zero, weight), &opaque_entry);
    if (m_any(opaque)) { /* the segment is cut before the opaque entry, which is composited behind it */
      const vint before = vi_max(opaque_entry, front) - vi_min(opaque_entry, front);
      const vmask rises = vi_ge(opaque_entry, front);
      const vint one_more = vi_set(1);
      const vfloat way = width_between(&a->table, sums, vi_select(rises, front, opaque_entry + one_more),
        vi_select(rises, opaque_entry, front + one_more), opaque & vi_lt(vi_set(0), before));
      const vfloat part = way * v_reciprocal(v_max(width_between(&a->table, sums, low, beyond, opaque), one));
      depth_scale = v_select(opaque, depth_scale * part, depth_scale);
      rise = v_select(opaque, rise * part, rise);
      entry = vi_select(opaque, vi_select(rises, opaque_entry - vi_set(1), opaque_entry + vi_set(1)), entry);
      mask = m_andnot(mask, opaque & vi_ge(vi_set(0), before));
      low = vi_select(mask, vi_min(entry, front), low);
      beyond = vi_select(mask, vi_max(entry, front) + vi_set(1), beyond);
    }
  }
  vfloat sum[4];
  sums_between(sums, low, beyond, mask, sum);
  mask = mask & v_lt(zero, sum[3]);
  if (!m_any(mask | opaque)) {
    return;
  }
  vfloat entries = width_between(&a->table, sums, low, beyond, mask);
  const vfloat pieces = pieces_for(segment_error(&a->table, sum[3] * depth_scale * v_reciprocal(v_max(entries, one)), entries));
  const vmask several = mask & v_lt(one, pieces);
  vfloat share = one, piece = zero;
  vint from = front;
  if (m_any(several)) {
    share = v_select(several, v_reciprocal(pieces), one);
  }
  do {
    vint to = entry;
    if (m_any(several)) { /* the next piece; the last piece ends where the segment does */
      piece = piece + one;
      to = vi_select(v_lt(piece, pieces), table_entry(&a->table, sums, v_fma(rise, piece * share, begin)), entry);
      low = vi_min(from, to);
      beyond = vi_max(from, to) + vi_set(1);
      entries = width_between(&a->table, sums, low, beyond, mask);
      sums_between(sums, low, beyond, mask, sum);
      from = to;
    }
    const vmask lit = mask & v_lt(zero, sum[3]);
    if (m_any(lit)) {
      vfloat layer[4];
      const vfloat depth = sum[3] * (depth_scale * share) * v_reciprocal(v_max(entries, one));
      layer[3] = v_select(lit, v_absorbed(v_select(lit, depth, zero)), zero);
      const vfloat per_tau = v_select(lit, layer[3] * v_reciprocal(v_max(sum[3], one)), zero);
      for (int c = 0; c < 3; ++c) {
        layer[c] = sum[c] * per_tau;
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
    sums_between(sums, opaque_entry, next, opaque, sum);
    const vfloat per_tau = v_reciprocal(v_max(sum[3], one));
    for (int c = 0; c < 3; ++c) {
      layer[c] = sum[c] * per_tau;
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
