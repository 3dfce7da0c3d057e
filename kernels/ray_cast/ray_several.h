/* SPDX-License-Identifier: BSD-3-Clause
 * The march of a packet of rays through several volumes at once, front to back. All have one lattice of samples, which is anchored at the
 * eye; each has its own place on it, its own bounds, structure and table, and takes a sample of every `stride` segments. Within a segment
 * optical depths add up, and colours weigh by them.
 *
 * The lanes of a packet go through the lattice together, so that all of them take the samples of a volume at once. What a lane gathers does
 * not depend on its neighbours: positions are relative to where its own ray enters the volume, as in ray_setup.h. A structure tells up to
 * which segment its volume is transparent on all lanes; such segments would have added exactly zero. */
#ifndef STRATUS_RAY_SEVERAL_H
#define STRATUS_RAY_SEVERAL_H

#include "lighting.h"
#include "tree_map.h"

#define SEVERAL_MOST 8
#define SEVERAL_NEVER 0x7fffffff

/* The field, or its gradient, at a position in a volume: RAY_NAME(ray_value) and RAY_NAME(ray_gradient) of its type of values. */
typedef void several_value(CONSTANT stratus_ray_cast_arguments* a, value_source values, GLOBAL const uchar* hidden, GLOBAL const int* grid,
  const vfloat x[3], vmask mask, vfloat* value);
typedef void several_gradient(
  CONSTANT stratus_ray_cast_arguments* a, value_source values, GLOBAL const int* grid, const vfloat x[3], vmask mask, vfloat g[3]);

/* What all rays read of a volume. */
typedef struct several_source {
  CONSTANT stratus_ray_cast_arguments* a;
  value_source values;
  GLOBAL const uchar *hidden, *map;
  GLOBAL const int* grid;
  /* Pre-integrated: running sums. Midpoint: for each entry its colour times optical depth, and optical depth, of a segment's length; and
   * with light or gradient opacity, what these read besides. */
  GLOBAL const void *table, *besides;
  several_value* value;
  several_gradient* gradient;
  int stride;        /* segments of the lattice to a sample of this volume, at least 1 */
  int lit;           /* 1: it has light or gradient opacity */
  int preintegrated; /* 1: between the values at both ends of a sample's way; 0: by the value in its middle */
} several_source;

/* What a volume shows from `lo` to `hi` on each ray. Places are in segments from the one in which the ray enters the volume. */
typedef struct several_way {
  vfloat lo, hi, front, rise; /* the field goes from `front` at lo to `front` + `rise` at hi */
  vfloat rate[4];             /* colour times optical depth, and optical depth, of a segment's length */
  vfloat entries;             /* of the table, for each segment's length of the way */
  vmask stops;                /* rays that end at hi, in the colour `wall` */
  vfloat wall[3];
  stratus_lit_sample lighting; /* set where the volume has light or gradient opacity */
} several_way;

typedef struct several_volume {
  stratus_packet k; /* the rays as this volume has them */
  vint offset;      /* the packet's number of the segment in which a ray enters */
  int phase;        /* segments from the beginning of a sample's way to the packet's first */
  int next, run;    /* the segment at which a sample or a look-up is due; before `run` the structure need not be asked */
  int last;         /* the first segment behind all rays' ends */
  vfloat ahead;     /* pre-integrated: the value at the end of the way, which is the next one's front */
  vmask knows;      /* the rays that have it */
  several_way ways[2];
  int now;          /* which of them is the way that rays are on; the other is the coming one */
  int shows, comes; /* whether anything shows on these */
} several_volume;

/* The smallest number in the lanes of the mask. */
INLINE int several_least(vint a, vmask mask)
{
#if !defined(STRATUS_DEVICE) && STRATUS_ISA == 2
  return _mm512_mask_reduce_min_epi32(mask, (__m512i)a);
#else
  int lanes[STRATUS_WIDTH], least = SEVERAL_NEVER;
  vi_store(lanes, vi_select(mask, a, vi_set(SEVERAL_NEVER)));
  for (int lane = 0; lane < STRATUS_WIDTH; ++lane) {
    least = lanes[lane] < least ? lanes[lane] : least;
  }
  return least;
#endif
}

/* Where the way of the sample begins in which segment i is. */
INLINE int several_aligned(const several_source* from, const several_volume* v, int i)
{
  return i == SEVERAL_NEVER || from->stride == 1 ? i : i - (i + v->phase) % from->stride;
}

/* ---- the structure */

/* Asks the structure about the way from s0 on of the rays `inside`. Returns the segment at which the volume is to be looked at again, i
 * where it is to be sampled. */
INLINE int several_leap(const several_source* from, several_volume* v, int i, vfloat s0, vmask inside, vmask live)
{
  CONSTANT stratus_ray_cast_arguments* a = from->a;
  stratus_packet* k = &v->k;
  const vfloat length = v_set((float)from->stride);
  const vfloat lo = v_max(s0, k->begin);
  vfloat s = lo;
  if (!from->preintegrated) {
    s = v_set(0.5f) * (lo + v_min(s0 + length, k->end));
  }
  const vmask waiting = live & k->live & v_le(s0 + length, k->begin);
  int next = several_aligned(from, v, several_least(v->offset, waiting));
  if (m_any(inside)) {
    vint block[3], byte;
    packet_blocks(a, k, s, block);
    if (a->map.tree) {
      byte = tree_bytes(a, from->map, block, inside);
    } else {
      byte = gather_map(from->map, block[0] + (block[1] + block[2] * vi_set(a->map.rows)) * vi_set(a->map.pitch) + k->octant, inside);
    }
    const vmask occupied = inside & vi_ge(byte, vi_set(128));
    const vfloat leave = v_min(cube_exit(a, k, block, byte & vi_set(127)), v_set(8e6f));
    const vmask beyond = m_andnot(inside, occupied) & v_le(k->end, leave); /* nothing shows on the rest of these rays */
    k->lookups -= mask_int(inside);
    /* pre-integrated: the first way that ends outside the cube; else the first whose middle may lie outside */
    const vint at = v_to_int(leave + v_set(from->preintegrated ? 0.0f : 0.5f) * length) + v->offset;
    const int leap = several_aligned(from, v, several_least(at, m_andnot(inside, occupied | beyond)));
    if (m_any(occupied) || (from->preintegrated && leap <= i)) {
      const int until = several_aligned(from, v, several_least(at, occupied));
      v->run = until != SEVERAL_NEVER && until > i + from->stride ? until : i + from->stride;
      return i;
    }
    next = leap < next ? leap : next;
  }
  next = next > i + from->stride ? next : i + from->stride;
  next = next < v->last ? next : SEVERAL_NEVER;
  if (m_any(inside)) {
    const int segments = (next < v->last ? next : v->last) - i;
    k->skipped -= mask_int(inside) * vi_set(from->stride == 1 ? segments : (segments + from->stride - 1) / from->stride);
  }
  return next;
}

/* ---- a sample's way */

/* Cuts off what lies beyond the table, where the volume is transparent. */
INLINE void several_cut(CONSTANT stratus_table_arguments* t, vmask mask, several_way* way)
{
  const vfloat scale = v_set(t->scale), offset = v_set(t->offset), length = way->hi - way->lo;
  const vfloat from = v_clamp(v_fma(way->front, scale, offset), -1e30f, 1e30f),
               to = v_clamp(v_fma(way->front + way->rise, scale, offset), -1e30f, 1e30f);
  const vmask cut = mask & (v_lt(v_min(from, to), v_set(0.0f)) | v_lt(v_set(t->last + 1.0f), v_max(from, to)));
  if (m_any(cut)) {
    vfloat before, part;
    part_within(t, from, to, &before, &part);
    way->front = v_select(cut, v_fma(way->rise, before, way->front), way->front);
    way->rise = v_select(cut, way->rise * part, way->rise);
    way->lo = v_select(cut, v_fma(length, before, way->lo), way->lo);
    way->hi = v_select(cut, v_fma(length, part, way->lo), way->hi);
  }
}

/* Ends the way before an entry of opacity 1. Returns the lanes whose way has no other entries before it. */
INLINE vmask several_stop(
  CONSTANT stratus_table_arguments* t, GLOBAL const int* sums, vmask mask, vint front, vint* entry, several_way* way)
{
  vint first;
  const vmask stops = opaque_on_the_way(t, sums + 4 * (t->entries + 1), front, *entry, mask & v_lt(way->lo, way->hi), &first);
  if (!m_any(stops)) {
    return stops;
  }
  const vint one = vi_set(1), low = vi_min(*entry, front), beyond = vi_max(*entry, front) + one;
  const vmask rises = vi_ge(first, front), at_once = stops & vi_zero(first - front);
  const vfloat before =
    width_between(t, sums, vi_select(rises, front, first + one), vi_select(rises, first, front + one), m_andnot(stops, at_once));
  const vfloat part = before * v_reciprocal(v_max(width_between(t, sums, low, beyond, stops), v_set(1.0f)));
  vfloat sum[4];
  sums_between(sums, first, first + one, stops, sum);
  const vfloat per_tau = v_reciprocal(v_max(sum[3], v_set(1.0f)));
  for (int c = 0; c < 3; ++c) {
    way->wall[c] = sum[c] * per_tau;
  }
  way->stops = stops;
  way->hi = v_select(stops, v_fma(way->hi - way->lo, part, way->lo), way->hi);
  way->rise = v_select(stops, way->rise * part, way->rise);
  *entry = vi_select(stops, vi_select(rises, first - one, first + one), *entry);
  return at_once;
}

/* How light and gradient change the way, by the gradient in its middle. */
INLINE void several_light(const several_source* from, const stratus_packet* k, vmask mask, several_way* way)
{
  CONSTANT stratus_ray_cast_arguments* a = from->a;
  const vfloat s = v_set(0.5f) * (way->lo + way->hi);
  const vfloat x[3] = { v_fma(s, k->d[0], k->p[0]), v_fma(s, k->d[1], k->p[1]), v_fma(s, k->d[2], k->p[2]) };
  vfloat g[3];
  from->gradient(a, from->values, from->grid, x, mask, g);
  way->lighting.factor = v_set(1.0f);
  if (a->media.factor_first[0] >= 0) {
    way->lighting.factor = gradient_opacity(a, from->besides, vi_set(a->media.factor_first[0]), v_set(a->media.factor_scale[0]), g, mask);
  }
  for (int c = 0; c < 3; ++c) {
    way->lighting.diffuse[c] = v_set(1.0f);
    way->lighting.specular[c] = v_set(0.0f);
  }
  if (a->light.on) {
    ray_light(a, 0, x, k->d, g, way->lighting.diffuse, way->lighting.specular);
  }
}

/* Lights what a segment's length of a way shows. */
INLINE void several_light_rate(const several_way* way, vmask mask, vfloat rate[4])
{
  light_layer(&way->lighting, rate);
  for (int c = 0; c < 4; ++c) {
    rate[c] = v_select(mask, rate[c] * way->lighting.factor, v_set(0.0f));
  }
}

/* What a segment's length of a way between two values shows. */
INLINE vmask several_rate(
  const several_source* from, const several_way* way, vint low, vint beyond, vmask mask, vfloat rate[4], vfloat* width)
{
  CONSTANT stratus_ray_cast_arguments* a = from->a;
  GLOBAL const int* sums = (GLOBAL const int*)from->table;
  sums_between(sums, low, beyond, mask, rate);
  mask = mask & v_lt(v_set(0.0f), rate[3]);
  *width = v_max(width_between(&a->table, sums, low, beyond, mask), v_set(1.0f));
  const vfloat scale = v_select(mask, v_set(a->table.tau_scale) * v_reciprocal(*width), v_set(0.0f));
  for (int c = 0; c < 4; ++c) {
    rate[c] = rate[c] * scale;
  }
  if (from->lit) {
    several_light_rate(way, mask, rate);
  }
  return mask;
}

/* Makes the coming way one of the value in its middle. */
INLINE void several_shade_middle(const several_source* from, several_volume* v, vmask mask)
{
  several_way* way = &v->ways[1 - v->now];
  gather_four((GLOBAL const float*)from->table, table_entry(&from->a->table, from->besides, way->front), mask, way->rate);
  const vmask shown = mask & v_lt(v_set(0.0f), way->rate[3]);
  way->stops = m_none();
  way->entries = v_set(0.0f);
  v->comes = m_any(shown) != 0;
  if (from->lit && v->comes) {
    several_light(from, &v->k, shown, way);
    several_light_rate(way, shown, way->rate);
  }
}

/* Makes the coming way of what the field does on it, in the lanes of the mask. */
INLINE void several_shade(const several_source* from, several_volume* v, vmask mask)
{
  CONSTANT stratus_ray_cast_arguments* a = from->a;
  GLOBAL const int* sums = (GLOBAL const int*)from->table;
  several_way* way = &v->ways[1 - v->now];
  const vfloat zero = v_set(0.0f), length = way->hi - way->lo;
  const vfloat front_place = table_place(&a->table, way->front), place = table_place(&a->table, way->front + way->rise);
  mask =
    mask & v_lt(v_min(place, front_place), v_set(a->table.shown_beyond)) & v_le(v_set(a->table.shown_first), v_max(place, front_place));
  v->comes = 0;
  way->stops = m_none();
  way->rate[0] = way->rate[1] = way->rate[2] = way->rate[3] = zero;
  if (!m_any(mask)) {
    return;
  }
  const vint front = entry_in_cell(&a->table, sums, v_to_int(front_place), way->front, mask);
  vint entry = entry_in_cell(&a->table, sums, v_to_int(place), way->front + way->rise, mask);
  vmask shown = mask;
  if (a->table.cut) {
    several_cut(&a->table, mask, way);
  }
  if (a->table.has_opaque) {
    shown = m_andnot(shown, several_stop(&a->table, sums, mask, front, &entry, way));
  }
  if (from->lit) {
    const vint low = vi_min(front, entry), beyond = vi_max(front, entry) + vi_set(1);
    const vmask lit = way->stops | (shown & v_lt(zero, tau_between(sums, low, beyond, shown)));
    if (!m_any(lit)) {
      return;
    }
    several_light(from, &v->k, lit, way);
  }
  vfloat width;
  shown = several_rate(from, way, vi_min(front, entry), vi_max(front, entry) + vi_set(1), shown, way->rate, &width);
  way->entries = width * v_reciprocal(v_max(length, v_set(1e-3f)));
  v->comes = m_any(shown | way->stops) != 0;
}

/* Takes the sample that is due at segment i, or leaps. live: rays that are not at their end. */
INLINE void several_advance(const several_source* from, several_volume* v, int i, vmask live)
{
  stratus_packet* k = &v->k;
  v->comes = 0;
  if (i >= v->last) {
    v->next = SEVERAL_NEVER;
    return;
  }
  i = several_aligned(from, v, i);
  const vfloat s0 = v_from_int(vi_set(i) - v->offset), s1 = s0 + v_set((float)from->stride);
  const vfloat lo = v_min(v_max(s0, k->begin), k->end), hi = v_max(v_min(s1, k->end), lo);
  const vmask inside = live & k->live & v_lt(lo, hi);
  if (from->a->map.structure && i >= v->run) {
    v->next = several_leap(from, v, i, s0, inside, live);
    if (v->next > i) {
      v->knows = m_none();
      return;
    }
  }
  v->next = i + from->stride;
  if (!m_any(inside)) {
    return;
  }
  vfloat s = hi;
  if (!from->preintegrated) {
    s = v_set(0.5f) * (lo + hi);
  }
  const vfloat x[3] = { v_fma(s, k->d[0], k->p[0]), v_fma(s, k->d[1], k->p[1]), v_fma(s, k->d[2], k->p[2]) };
  vfloat value, front;
  from->value(from->a, from->values, from->hidden, from->grid, x, inside, &value);
  k->samples -= mask_int(inside);
  front = value;
  if (from->preintegrated) {
    const vmask fresh = m_andnot(inside, v->knows);
    front = v->ahead;
    if (m_any(fresh)) {
      const vfloat y[3] = { v_fma(lo, k->d[0], k->p[0]), v_fma(lo, k->d[1], k->p[1]), v_fma(lo, k->d[2], k->p[2]) };
      vfloat entered;
      from->value(from->a, from->values, from->hidden, from->grid, y, fresh, &entered);
      k->samples -= mask_int(fresh);
      front = v_select(fresh, entered, front);
    }
    v->ahead = value;
    v->knows = inside;
  }
  v->ways[1 - v->now].lo = lo;
  v->ways[1 - v->now].hi = hi;
  v->ways[1 - v->now].front = front;
  v->ways[1 - v->now].rise = value - front;
  const vmask valid = inside & v_finite(value) & v_finite(front);
  if (from->preintegrated) {
    several_shade(from, v, valid);
  } else {
    several_shade_middle(from, v, valid);
  }
}

/* ---- intervals
 * Of what the rays are on, nothing changes before a volume whose way shows anything takes its next sample. So a ray composites from one
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

/* ---- the march */

/* Gives every ray its number of the packet's first segment, and each volume where it is due. */
INLINE void several_number(const several_source* from, several_volume* volumes, int count, double whole[SEVERAL_MOST][STRATUS_WIDTH])
{
  double least = 1e300;
  int meets[SEVERAL_MOST][STRATUS_WIDTH];
  for (int n = 0; n < count; ++n) {
    vi_store(meets[n], vi_select(volumes[n].k.live, vi_set(1), vi_set(0)));
    for (int lane = 0; lane < STRATUS_WIDTH; ++lane) {
      least = meets[n][lane] && whole[n][lane] < least ? whole[n][lane] : least;
    }
  }
  least = least < 1e300 ? least : 0.0; /* no ray meets any volume */
  for (int n = 0; n < count; ++n) {
    several_volume* v = &volumes[n];
    int offset[STRATUS_WIDTH];
    for (int lane = 0; lane < STRATUS_WIDTH; ++lane) {
      offset[lane] = meets[n][lane] ? (int)(whole[n][lane] - least) : 0;
    }
    const double turns = least / from[n].stride;
    v->offset = vi_load(offset);
    v->phase = (int)(least - (double)from[n].stride * (double)(int64_t)turns);
    v->phase += v->phase < 0 ? from[n].stride : 0;
    v->next = several_least(v->k.i + v->offset, v->k.live);
    const int beyond = several_least(vi_set(0) - (v->k.last + v->offset), v->k.live);
    v->last = beyond == SEVERAL_NEVER ? 0 : -beyond;
    v->run = from[n].a->map.structure ? 0 : SEVERAL_NEVER;
  }
}

/* Makes the packet at pixel (x, y) ready, as each volume sees it. k: what the rays gather. */
INLINE void several_load(
  const several_source* from, int count, GLOBAL const float* opaque_depth, int x, int y, several_volume* volumes, stratus_packet* k)
{
  double whole[SEVERAL_MOST][STRATUS_WIDTH];
  packet_nothing(k);
  for (int n = 0; n < count; ++n) {
    CONSTANT stratus_ray_cast_arguments* a = from[n].a;
    several_volume* v = &volumes[n];
    stratus_rays rays;
    v->now = v->shows = v->comes = 0;
    v->knows = m_none();
    v->ahead = v_set(0.0f);
    if (packet_outside(a, x, y)) {
      packet_nothing(&v->k);
      v->k.i = v->k.last = vi_set(0);
      continue;
    }
    const vmask inside = packet_rays(a, opaque_depth, x, y, &rays);
    packet_begin(a, &rays, inside, &v->k);
    v->k.grid = from[n].grid;
    for (int lane = 0; lane < STRATUS_WIDTH; ++lane) {
      whole[n][lane] = (double)rays.whole[0][lane] + (double)rays.whole[1][lane];
    }
    k->hits = k->hits | v->k.hits;
    k->live = k->live | v->k.live;
  }
  k->first = v_set(0.0f);
  several_number(from, volumes, count, whole);
}

INLINE void several_march(const several_source* from, several_volume* volumes, int count, stratus_packet* k)
{
  vint since = vi_set(0);
  int i = 0;
  while (m_any(k->live) && i != SEVERAL_NEVER) {
    int next = SEVERAL_NEVER, shows = 0;
    vmask changed = m_none();
    for (int n = 0; n < count; ++n) {
      several_volume* v = &volumes[n];
      shows |= v->shows;
      if (v->next <= i) {
        several_advance(&from[n], v, i, k->live);
        changed = changed | several_shown(&v->ways[v->now], v->shows) | several_shown(&v->ways[1 - v->now], v->comes);
      } else {
        v->comes = -1; /* stays on its way */
      }
      next = v->next < next ? v->next : next;
    }
    if (m_any(changed)) {
      if (shows) {
        several_interval(from, volumes, count, since, i, changed & k->live, k);
      }
      since = vi_select(changed, vi_set(i), since);
    }
    for (int n = 0; n < count; ++n) {
      if (volumes[n].comes >= 0) {
        volumes[n].now = 1 - volumes[n].now;
        volumes[n].shows = volumes[n].comes;
      }
    }
    i = next;
  }
  for (int n = 0; n < count; ++n) {
    k->samples = k->samples + volumes[n].k.samples;
    k->lookups = k->lookups + volumes[n].k.lookups;
    k->skipped = k->skipped + volumes[n].k.skipped;
  }
}

#endif
