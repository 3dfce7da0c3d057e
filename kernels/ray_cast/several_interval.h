/* SPDX-License-Identifier: BSD-3-Clause
 * Composites what several volumes show from one change to the next.
 */
#ifndef STRATUS_SEVERAL_INTERVAL_H
#define STRATUS_SEVERAL_INTERVAL_H

#include "several_state.h"
#include "several_way.h"

/* Of what the rays are on, nothing changes before a volume whose way shows anything takes its next sample. So a ray composites from one
 * such change to the next. Where a way shows nothing, and whether it was sampled or skipped, makes no difference to that. */

/* The part of the way that is between u0 and u1 segments behind the beginning of segment `since`. */
INLINE void several_part(const several_volume* v, vint since, vfloat u0, vfloat u1, vfloat* from, vfloat* to)
{
  const several_way* way = &v->ways[v->now];
  const vfloat s0 = v_from_int(since - v->offset);
  *from = v_max(s0 + u0, way->lo);
  *to = v_max(v_min(s0 + u1, way->hi), *from);
}

/* Adds what the volume shows between two places, by the values there. */
INLINE void several_add_part(const several_source* from, const several_volume* v, vfloat begin, vfloat end, vmask mask, vfloat sum[4])
{
  CONSTANT stratus_ray_cast_arguments* a = from->a;
  const several_way* way = &v->ways[v->now];
  mask = mask & v_lt(begin, end) & v_lt(v_set(0.0f), way->rate[3]);
  if (!from->preintegrated) {
    for (int c = 0; c < 4; ++c) {
      sum[c] = v_select(mask, v_fma(way->rate[c], end - begin, sum[c]), sum[c]);
    }
    return;
  }
  const vfloat per_length = v_reciprocal(v_max(way->hi - way->lo, v_set(1e-6f)));
  const vfloat t0 = v_clamp((begin - way->lo) * per_length, 0.0f, 1.0f), t1 = v_clamp((end - way->lo) * per_length, 0.0f, 1.0f);
  const vint e0 = table_entry(&a->table, from->table, v_fma(way->rise, t0, way->front)),
             e1 = table_entry(&a->table, from->table, v_fma(way->rise, t1, way->front));
  vfloat rate[4], width;
  several_rate(from, way, vi_min(e0, e1), vi_max(e0, e1) + vi_set(1), mask, rate, &width);
  for (int c = 0; c < 4; ++c) {
    sum[c] = v_select(mask, v_fma(rate[c], end - begin, sum[c]), sum[c]);
  }
}

/* (1 - exp(-x)) / x, the part of light that each unit of optical depth takes: by its series where x is small. */
INLINE vfloat several_absorbed_share(vfloat x, vmask mask)
{
  const float small = 0.25f;
  vfloat share = v_fma(v_set(-1.0f / 720.0f), x, v_set(1.0f / 120.0f));
  share = v_fma(share, x, v_set(-1.0f / 24.0f));
  share = v_fma(share, x, v_set(1.0f / 6.0f));
  share = v_fma(share, x, v_set(-0.5f));
  share = v_fma(share, x, v_set(1.0f));
  const vmask large = v_lt(v_set(small), x);
  if (m_any(mask & large)) {
    share = v_select(large, v_absorbed(x) * v_reciprocal(v_max(x, v_set(small))), share);
  }
  return share;
}

/* Composites light and optical depth as one layer. lo: where it begins, for depth. */
INLINE void several_composite(CONSTANT stratus_ray_cast_arguments* a, stratus_packet* k, vmask mask, const vfloat sum[4], vfloat lo)
{
  vfloat layer[4];
  const vfloat share = v_select(mask, several_absorbed_share(v_select(mask, sum[3], v_set(0.0f)), mask), v_set(0.0f));
  for (int c = 0; c < 4; ++c) {
    layer[c] = sum[c] * share;
  }
  layer[3] = v_min(layer[3], v_set(1.0f)); /* the product is rounded */
  composite(a, k, mask, layer, lo);
}

/* Composites the interval from `since` on, `stop` long, in several pieces on the rays of the mask. */
INLINE void several_pieces(const several_source* from, const several_volume* volumes, int count, vint since, vmask mask, vfloat pieces,
  vfloat stop, vfloat lo, stratus_packet* k)
{
  const vfloat share = stop * v_reciprocal(pieces), one = v_set(1.0f);
  vfloat piece = v_set(0.0f);
  do {
    const vmask last = v_le(pieces, piece + one);
    const vfloat u0 = piece * share, u1 = v_select(last, stop, (piece + one) * share);
    vfloat sum[4] = { v_set(0.0f), v_set(0.0f), v_set(0.0f), v_set(0.0f) };
    for (int n = 0; n < count; ++n) {
      if (volumes[n].shows) {
        vfloat begin, end;
        several_part(&volumes[n], since, u0, u1, &begin, &end);
        several_add_part(&from[n], &volumes[n], begin, end, mask, sum);
      }
    }
    const vmask shown = mask & v_lt(v_set(0.0f), sum[3]);
    if (m_any(shown)) {
      several_composite(from[0].a, k, shown, sum, lo);
    }
    mask = m_andnot(mask, last);
    piece = piece + one;
  } while (m_any(mask));
}

/* Rays that end in the interval from `since` on, which is *stop long and then ends there. wall: the colour that ends them. */
INLINE vmask several_walls(
  const several_source* from, const several_volume* volumes, int count, vint since, vmask mask, vfloat* stop, vfloat wall[3])
{
  vmask stops = m_none();
  for (int n = 0; n < count; ++n) {
    const several_way* way = &volumes[n].ways[volumes[n].now];
    if (volumes[n].shows && m_any(way->stops)) {
      const vfloat at = v_max(way->hi - v_from_int(since - volumes[n].offset), v_set(0.0f));
      const vmask first = mask & way->stops & v_le(at, *stop);
      *stop = v_select(first, at, *stop);
      for (int c = 0; c < 3; ++c) {
        vfloat color = way->wall[c];
        if (from[n].lit) {
          color = v_fma(color, way->lighting.diffuse[c], way->lighting.specular[c]);
        }
        wall[c] = v_select(first, color, wall[c]);
      }
      stops = stops | first;
    }
  }
  return stops;
}

/* Composites what all volumes show from segment `since` to i on the rays of the mask. */
INLINE void several_interval(
  const several_source* from, const several_volume* volumes, int count, vint since, int i, vmask mask, stratus_packet* k)
{
  const vfloat zero = v_set(0.0f), one = v_set(1.0f);
  vfloat sum[4] = { zero, zero, zero, zero }, wall[3] = { zero, zero, zero }, error = zero, nearest = v_set(LARGEST_FLOAT);
  vfloat stop = v_from_int(vi_set(i) - since);
  const vmask stops = several_walls(from, volumes, count, since, mask, &stop, wall);
  for (int n = 0; n < count; ++n) {
    const several_volume* v = &volumes[n];
    if (v->shows) {
      CONSTANT stratus_table_arguments* t = &from[n].a->table;
      const several_way* way = &v->ways[v->now];
      vfloat begin, end;
      several_part(v, since, zero, stop, &begin, &end);
      const vfloat length = end - begin;
      for (int c = 0; c < 4; ++c) {
        sum[c] = v_fma(way->rate[c], length, sum[c]);
      }
      const vmask here = v_lt(begin, end) & v_lt(zero, way->rate[3]);
      const vmask there = here | (stops & way->stops);
      nearest = v_select(there, v_min(begin + v->k.first, nearest), nearest);
      error = v_select(here, v_max(v_min(way->entries * length * v_set(t->color_slope), v_set(t->color_most)), error), error);
    }
  }
  const vmask shown = mask & v_lt(zero, sum[3]);
  const vfloat q = sum[3] * error;
  const vmask several = shown & v_lt(one, q), single = m_andnot(shown, several);
  if (m_any(single)) {
    several_composite(from[0].a, k, single, sum, nearest);
  }
  if (m_any(several)) {
    several_pieces(from, volumes, count, since, several, v_select(several, pieces_for(q), one), stop, nearest, k);
  }
  if (m_any(stops)) {
    vfloat layer[4] = { wall[0], wall[1], wall[2], v_select(stops, one, zero) };
    for (int c = 0; c < 3; ++c) {
      layer[c] = v_select(stops, layer[c], zero);
    }
    composite(from[0].a, k, stops, layer, nearest);
  }
  k->live = m_andnot(k->live, v_lt(k->transparency, v_set(from[0].a->termination)));
}

/* Lanes on which a way shows anything. */
INLINE vmask several_shown(const several_way* way, int shows)
{
  vmask mask = m_none();
  if (shows) {
    mask = v_lt(v_set(0.0f), way->rate[3]) | way->stops;
  }
  return mask;
}

#endif
