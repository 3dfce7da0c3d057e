/* SPDX-License-Identifier: BSD-3-Clause
 * Composites what several volumes show from one change to the next.
 */
#ifndef STRATUS_SEVERAL_INTERVAL_H
#define STRATUS_SEVERAL_INTERVAL_H

#include "several_state.h"
#include "several_way.h"
#if SEVERAL_CELLS
#include "several_cells.h"
#endif
#if SEVERAL_MESHES
#include "several_mesh.h"
#endif

/* Nothing changes on the rays before a volume whose path shows anything is sampled next. So a ray composites from one such change to the
 * next. It makes no difference where a path shows nothing, and whether it was sampled or skipped. */

/* The part of the path that is between u0 and u1 segments behind the beginning of segment `since`. */
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
  several_end first = { v_fma(way->rise, t0, way->front), vi_set(0) }, last = { v_fma(way->rise, t1, way->front), vi_set(0) };
  first.entry = table_entry(&a->table, from->table, first.value);
  last.entry = table_entry(&a->table, from->table, last.value);
  vfloat rate[4], across;
  several_rate(from, way, &first, &last, mask, rate, &across);
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

/* Composites what is from `start` to `stop` segments behind `since` in several pieces on the rays of the mask. */
INLINE void several_pieces(const several_source* from, const several_volume* volumes, int count, vint since, vmask mask, vfloat pieces,
  vfloat start, vfloat stop, vfloat lo, stratus_packet* k)
{
  const vfloat share = (stop - start) * v_reciprocal(pieces), one = v_set(1.0f);
  vfloat piece = v_set(0.0f);
  do {
    const vmask last = v_le(pieces, piece + one);
    const vfloat u0 = start + piece * share, u1 = v_select(last, stop, start + (piece + one) * share);
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

/* Rays that end between `start` and *stop segments behind `since`, which then is there. wall: the colour that ends them. */
INLINE vmask several_walls(
  const several_source* from, const several_volume* volumes, int count, vint since, vmask mask, vfloat start, vfloat* stop, vfloat wall[3])
{
  vmask stops = m_none();
  for (int n = 0; n < count; ++n) {
    const several_way* way = &volumes[n].ways[volumes[n].now];
    if (volumes[n].shows && m_any(way->stops)) {
      const vfloat at = v_max(way->hi - v_from_int(since - volumes[n].offset), start);
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

/* Add the volume's contribution between two places: by its mean rate on the path, or, in a part of a stretch, by the values at the
 * places. */
INLINE void several_add_way(const several_source* from, const several_volume* v, vfloat begin, vfloat end, vmask mask, vfloat sum[4])
{
  const several_way* way = &v->ways[v->now];
  const vfloat length = end - begin;
  vmask part = m_none();
  if (several_has_stretches(from)) {
    part = mask & v_lt(begin, end) & v_lt(v_set(0.0f), v_abs(way->rise)) & (v_lt(way->lo, begin) | v_lt(end, way->hi));
  }
  for (int c = 0; c < 4; ++c) {
    const vfloat whole = v_fma(way->rate[c], length, sum[c]);
    sum[c] = v_select(part, sum[c], whole);
  }
  if (m_any(part)) {
    several_add_part(from, v, begin, end, part, sum);
  }
}

/* Composites what all volumes show from `start` to `stop` segments behind `since` on the rays of the mask. None takes another way within.
 */
INLINE void several_stretch(const several_source* from, const several_volume* volumes, int count, vint since, vfloat start, vfloat stop,
  vmask mask, stratus_packet* k)
{
  const vfloat zero = v_set(0.0f), one = v_set(1.0f);
  vfloat sum[4] = { zero, zero, zero, zero }, wall[3] = { zero, zero, zero }, error = zero, nearest = v_set(LARGEST_FLOAT);
  const vmask stops = several_walls(from, volumes, count, since, mask, start, &stop, wall);
  for (int n = 0; n < count; ++n) {
    const several_volume* v = &volumes[n];
    if (v->shows) {
      CONSTANT stratus_table_arguments* t = &from[n].a->table;
      const several_way* way = &v->ways[v->now];
      vfloat begin, end;
      several_part(v, since, start, stop, &begin, &end);
      const vfloat length = end - begin;
      several_add_way(&from[n], v, begin, end, mask, sum);
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
    several_pieces(from, volumes, count, since, several, v_select(several, pieces_for(q), one), start, stop, nearest, k);
  }
  if (m_any(stops)) {
    vfloat layer[4] = { wall[0], wall[1], wall[2], v_select(stops, one, zero) };
    for (int c = 0; c < 3; ++c) {
      layer[c] = v_select(stops, layer[c], zero);
    }
    composite(from[0].a, k, stops, layer, nearest);
  }
  k->live = m_andnot(k->live, stops | v_lt(k->transparency, v_set(from[0].a->termination)));
}

#if SEVERAL_STRETCHES
/* Gives the rays of the mask their next stretch. Returns those that wait for it, as several_cells_next() has it. */
INLINE vmask several_next(const several_source* from, several_volume* v, vmask mask, vmask going, vmask live)
{
#if SEVERAL_MESHES
  if (from->mesh) {
    several_mesh_next(from, v, mask);
    return m_none();
  }
#endif
#if SEVERAL_CELLS
  return several_cells_next(from, v, mask, going, live);
#else
  (void)going;
  (void)live;
  return m_none();
#endif
}

/* From `u` segments behind `since` on, at which the rays `going` are: gives those whose stretch has ended another, and takes from `going`
 * those that have to wait for it. Lowers *until to where each ray's stretch ends or, at a whole segment before it where that is far,
 * begins. live: rays that are not at their end. */
INLINE void several_until(const several_source* from, several_volume* v, vint since, vfloat u, vmask live, vmask* going, vfloat* until)
{
  const several_way* way = &v->ways[v->now];
  const vfloat s0 = v_from_int(since - v->offset), one = v_set(1.0f);
  for (;;) {
    const vmask ended = m_andnot(*going & v_le(way->hi - s0, u), way->stops);
    if (!m_any(ended)) {
      break;
    }
    *going = m_andnot(*going, several_next(from, v, ended, *going, live));
  }
  const vfloat begins = way->lo - s0, ends = v_max(way->hi - s0, u);
  const vfloat whole = v_from_int(v_to_int(v_clamp(begins, 0.0f, (float)SEVERAL_SEGMENTS_MOST)));
  const vmask before = v_lt(u, begins),
              far = before & v_le(one, begins - u) & v_lt(u, whole) & v_lt(begins, v_set((float)SEVERAL_SEGMENTS_MOST));
  *until = v_min(v_select(far, whole, v_select(before, begins, ends)), *until);
}
#endif

/* Composites what all volumes show from segment `since` to i on the rays of the mask: at once, or, where there are stretches, from one of
 * their ends to the next. */
OUTLINE void several_interval(
  const several_source* from, several_volume* volumes, int count, vint since, int i, vmask mask, int stretches, stratus_packet* k)
{
  vfloat start = v_set(0.0f), stop = v_from_int(vi_set(i) - since);
  do {
    vfloat until = stop;
    vmask going = mask;
#if SEVERAL_STRETCHES
    for (int n = 0; stretches && n < count; ++n) {
      if (several_has_stretches(&from[n]) && volumes[n].shows) {
        several_until(&from[n], &volumes[n], since, start, k->live, &going, &until);
      }
    }
    until = v_select(going, until, start);
#endif
    several_stretch(from, volumes, count, since, start, until, going, k);
#if SEVERAL_STRETCHES
    mask = mask & k->live & (v_lt(until, stop) | m_andnot(mask, going));
    /* places stay near `since`, so that floats distinguish them */
    const vint whole = vi_select(mask, v_to_int(v_select(mask, until, v_set(0.0f))), vi_set(0));
    since = since + whole;
    start = until - v_from_int(whole);
    stop = v_from_int(vi_set(i) - since);
#endif
  } while (stretches && m_any(mask));
}

/* Composites the same interval where every path has one value, that of its middle. Then no path is cut, and no ray ends at a wall. */
INLINE void several_interval_of_middles(
  const several_source* from, const several_volume* volumes, int count, vint since, int i, vmask mask, stratus_packet* k)
{
  const vfloat zero = v_set(0.0f), stop = v_from_int(vi_set(i) - since);
  vfloat sum[4] = { zero, zero, zero, zero }, nearest = v_set(LARGEST_FLOAT);
  for (int n = 0; n < count; ++n) {
    const several_volume* v = &volumes[n];
    if (v->shows) {
      vfloat begin, end;
      several_part(v, since, zero, stop, &begin, &end);
      for (int c = 0; c < 4; ++c) {
        sum[c] = v_fma(v->ways[v->now].rate[c], end - begin, sum[c]);
      }
      if (from[0].a->picture.want_depth) {
        const vmask here = v_lt(begin, end) & v_lt(zero, v->ways[v->now].rate[3]);
        nearest = v_select(here, v_min(begin + v->k.first, nearest), nearest);
      }
    }
  }
  several_composite(from[0].a, k, mask & v_lt(zero, sum[3]), sum, nearest);
  k->live = m_andnot(k->live, v_lt(k->transparency, v_set(from[0].a->termination)));
}

/* Lanes on which a path shows anything. */
INLINE vmask several_shown(const several_way* way, int shows)
{
  vmask mask = m_none();
  if (shows) {
    mask = v_lt(v_set(0.0f), way->rate[3]) | way->stops;
  }
  return mask;
}

#endif
