/* SPDX-License-Identifier: BSD-3-Clause
 * A volume among several whose rays go from cell to cell, or do so in rough blocks and from sample to sample elsewhere. They hand out one
 * stretch after the other on which the field counts as straight and shows anything. A stretch follows from only the ray, the values and the
 * function, not from the structure or from the other rays of the packet. */
#ifndef STRATUS_SEVERAL_CELLS_H
#define STRATUS_SEVERAL_CELLS_H

#include "several_way.h"

/* Rays that have a stretch go on once they are one in so many; the others wait, so that the walk has most of the lanes at work. */
#define SEVERAL_WAITING 3

/* Finds the next runs of the rays of the mask, which are at the end of one, and puts them there. */
INLINE void several_cells_run(const several_source* from, several_volume* v, vmask mask)
{
  CONSTANT stratus_ray_cast_arguments* a = from->a;
  stratus_packet* k = &v->k;
  several_cells_rays* c = &v->cells;
  cell_walk* w = &c->walk;
  local_runs r;
  if (!m_any(mask)) {
    return;
  }
  r.begin = w->s;
  r.to = w->end;
  r.end = c->end;
  r.rough = c->rough;
  local_find(a, from->rough, k, mask, &r);
  c->rough = r.rough;
  w->end = v_select(mask, r.to, w->end);
  w->run = v_select(mask, v_select(r.rough, v_set(LARGEST_FLOAT), v_set(a->map.structure ? -1.0f : LARGEST_FLOAT)), w->run);
  c->began = v_select(mask, r.begin, c->began);
  k->live = k->live | mask;
  cell_enter(a, k, w);
}

/* Lets the rays of the mask, which have reached the end of a run, begin the next one or end. */
INLINE void several_cells_turn(const several_source* from, several_volume* v, vmask mask)
{
  several_cells_rays* c = &v->cells;
  if (from->cells == SEVERAL_LOCAL && m_any(mask)) {
    c->walk.s = v_select(mask, c->walk.end, c->walk.s);
    several_cells_run(from, v, mask & v_lt(c->walk.s, c->end));
  }
}

/* Moves the rays of the mask into the cells behind theirs. */
INLINE void several_cells_leave(const several_source* from, several_volume* v, vmask mask)
{
  if (m_any(mask)) {
    cell_leave(from->a, &v->k, mask, &v->cells.walk);
    several_cells_turn(from, v, m_andnot(mask, v->k.live));
  }
}

/* Visit a cell on the rays of the mask, behind the part that the structure marks transparent. */
INLINE void several_cells_visit(const several_source* from, several_volume* v, vmask mask)
{
  CONSTANT stratus_ray_cast_arguments* a = from->a;
  several_cells_rays* c = &v->cells;
  cell_walk* w = &c->walk;
  cell_way* way = &c->way;
  vint at[3];
  if (a->map.structure) {
    cell_skip(a, from->map, &v->k, cell_lanes_to_skip(mask, w), w);
    mask = mask & v->k.live;
  }
  v->k.samples -= mask_int(mask);
  if (RAY_RARE(RAY_NEAREST, a->values.nearest)) { /* a box about a value is one piece, of that value */
    vint hides[3];
    for (int axis = 0; axis < 3; ++axis) {
      const vint last = vi_set(a->values.dimensions[axis] - 1), nearest = (w->cell[axis] + vi_set(w->halves)) >> vi_set(w->halves);
      at[axis] = vi_max(vi_min(nearest, last), vi_set(0));
      hides[axis] = w->halves ? cell_inside(a, w, axis) : at[axis];
    }
    const vfloat value = several_nearest_at(from, at, mask);
    const vmask shown = cell_not_hidden(a, from->hidden, hides, mask & v_lt(w->s, w->leave) & v_finite(value));
    for (int i = 0; i < 4; ++i) {
      way->k[i] = v_select(shown, i ? v_set(0.0f) : value, way->k[i]);
    }
    way->lo = v_select(shown, value, way->lo);
    way->hi = v_select(shown, value, way->hi);
    way->front = v_select(shown, value, way->front);
    way->from = v_select(shown, v_set(0.0f), way->from);
    way->share = v_select(shown, v_set(1.0f), way->share);
    way->left = v_select(shown, v_set(1.0f), way->left);
    c->waiting = c->waiting | shown;
  } else {
    vfloat corners[8];
    for (int axis = 0; axis < 3; ++axis) {
      at[axis] = cell_inside(a, w, axis);
    }
    several_corners_at(from, at, mask, corners);
    c->waiting = c->waiting | cell_look(a, from->hidden, (GLOBAL const int*)from->table, &v->k, w, at, corners, mask, way);
  }
  several_cells_leave(from, v, m_andnot(mask, c->waiting));
}

/* Cuts the next pieces of the rays of the mask, which are lit, until each is so short or so faint that one place lights it. */
OUTLINE void several_cells_cut(const several_source* from, several_volume* v, vmask mask)
{
  CONSTANT stratus_ray_cast_arguments* a = from->a;
  GLOBAL const int* sums = (GLOBAL const int*)from->table;
  const stratus_packet* k = &v->k;
  const cell_walk* w = &v->cells.walk;
  cell_way* way = &v->cells.way;
  const vfloat limit = v_set(a->lattice.light_spread) * v_reciprocal(v_max(v_dot3(k->d, k->d), v_set(1e-30f)));
  do {
    cell_piece piece;
    const vfloat share = cell_next(a, sums, way, mask, &piece);
    const vint first = table_entry(&a->table, sums, piece.front), last = table_entry(&a->table, sums, piece.back);
    const vint low = vi_min(first, last), beyond = vi_max(first, last) + vi_set(1);
    const vfloat width = v_max(width_between(&a->table, sums, low, beyond, mask), v_set(1.0f)), length = (w->leave - w->s) * share;
    const vfloat depth = tau_between(sums, low, beyond, mask) * (length * v_set(a->table.tau_scale)) * v_reciprocal(width);
    const vfloat opacity = v_absorbed(v_select(mask, depth, v_set(0.0f))), spread = opacity * light_variance(opacity) * (length * length);
    mask = mask & v_lt(limit, spread) & v_lt(v_set(LIGHT_PIECE_LEAST), share);
    const vfloat parts = light_parts(limit, spread);
    way->share = v_select(mask, share * v_reciprocal(parts), way->share);
    way->left = v_select(mask, way->left * parts, way->left);
  } while (m_any(mask));
}

/* Set `next` to the next piece of the cell paths of the rays of the mask. */
INLINE vmask several_cells_piece(const several_source* from, several_volume* v, vmask mask, several_way* next)
{
  several_cells_rays* c = &v->cells;
  const cell_walk* w = &c->walk;
  const vfloat length = w->leave - w->s, lo = v_fma(c->way.from, length, w->s);
  cell_piece piece;
  cell_next(from->a, (GLOBAL const int*)from->table, &c->way, mask, &piece);
  /* a cell's last piece ends where the next cell begins */
  const vmask whole = piece.last & v_lt(v_set(0.99999f), piece.to);
  const vfloat hi = v_select(whole, w->leave, v_fma(piece.to, length, w->s));
  next->lo = v_select(mask, lo, next->lo);
  next->hi = v_select(mask, hi, next->hi);
  next->front = v_select(mask, piece.front, next->front);
  next->rise = v_select(mask, piece.back - piece.front, next->rise);
  const vmask left = cell_pass_piece(&c->way, &piece, mask);
  c->waiting = m_andnot(c->waiting, m_andnot(mask, left));
  several_cells_leave(from, v, m_andnot(mask, left));
  return mask & v_lt(lo, hi);
}

/* Leap over samples of the rays of the mask in which the structure marks the volume transparent. Returns the rays that stay. */
INLINE vmask several_cells_leap(const several_source* from, several_volume* v, vmask mask, vfloat middle, vfloat hi)
{
  CONSTANT stratus_ray_cast_arguments* a = from->a;
  stratus_packet* k = &v->k;
  cell_walk* w = &v->cells.walk;
  const vmask asks = mask & v_le(w->run, w->s);
  if (!m_any(asks)) {
    return mask;
  }
  vint block[3], byte;
  packet_blocks(a, k, middle, block);
  if (RAY_RARE(RAY_TREE, a->map.tree)) {
    byte = tree_bytes(a, from->map, block, asks);
  } else {
    byte = gather_map(from->map, block[0] + (block[1] + block[2] * vi_set(a->map.rows)) * vi_set(a->map.pitch) + k->octant, asks);
  }
  k->lookups -= mask_int(asks);
  const vmask occupied = asks & vi_ge(byte, vi_set(128)), leaps = m_andnot(asks, occupied);
  const vfloat leave = v_clamp(cube_exit(a, k, block, byte & vi_set(127)), 0.0f, 8e6f);
  /* the first sample whose middle may lie outside the cube */
  const vint stride = vi_set(from->stride), phase = v->phase;
  vint sample = several_sample_of(from, v_to_int(leave) + phase);
  const vfloat to_middle = v_set(0.5f * (float)from->stride);
  sample = sample + vi_select(v_lt(v_from_int(sample * stride - phase) + to_middle, leave), vi_set(1), vi_set(0));
  const vfloat first = v_min(v_max(v_from_int(sample * stride - phase), hi), w->end);
  w->run = v_select(occupied, v_fma(w->s - v->cells.began, v_set(1.0f / SEVERAL_LOOKS), v_max(first, hi)), w->run);
  k->skipped = k->skipped + vi_select(leaps, v_to_int((first - w->s) * v_set(1.0f / (float)from->stride)), vi_set(0));
  w->s = v_select(leaps, first, w->s);
  v->cells.began = v_select(leaps, first, v->cells.began);
  return m_andnot(mask, leaps);
}

/* Set `next` to a sample's path on the rays of the mask, all of them in smooth runs. Returns the rays on which it may show anything. */
INLINE vmask several_cells_sample(const several_source* from, several_volume* v, vmask mask, several_way* next)
{
  CONSTANT stratus_ray_cast_arguments* a = from->a;
  stratus_packet* k = &v->k;
  several_cells_rays* c = &v->cells;
  cell_walk* w = &c->walk;
  const vint sample = several_sample_of(from, v_to_int(w->s) + v->phase) + vi_set(1);
  const vfloat lo = w->s, hi = v_min(v_max(v_from_int(sample * vi_set(from->stride) - v->phase), lo), w->end);
  const vfloat middle = v_set(0.5f) * (lo + hi);
  vmask stays = mask, shown = m_none();
  if (a->map.structure) {
    stays = several_cells_leap(from, v, mask, middle, hi);
  }
  if (m_any(stays)) {
    const vfloat x[3] = { v_fma(middle, k->d[0], k->p[0]), v_fma(middle, k->d[1], k->p[1]), v_fma(middle, k->d[2], k->p[2]) };
    const vfloat value = several_value_at(from, x, stays), place = table_place(&a->table, value);
    k->samples -= mask_int(stays);
    shown = stays & v_lt(lo, hi) & v_finite(value) & v_lt(place, v_set(a->table.shown_beyond)) & v_le(v_set(a->table.shown_first), place);
    next->lo = v_select(shown, lo, next->lo);
    next->hi = v_select(shown, hi, next->hi);
    next->front = v_select(shown, value, next->front);
    next->rise = v_select(shown, v_set(0.0f), next->rise);
    w->s = v_select(stays, hi, w->s);
  }
  const vmask ended = mask & v_le(w->end, w->s);
  k->live = m_andnot(k->live, ended);
  several_cells_turn(from, v, ended);
  return shown;
}

/* Gives the rays of the mask their next stretch, or one beyond everything where none is left. Returns those that still wait for theirs:
 * none, or so many that enough of the rays `going` have one. live: rays that are not at their end. */
OUTLINE vmask several_cells_next(const several_source* from, several_volume* v, vmask mask, vmask going, vmask live)
{
  const vfloat zero = v_set(0.0f), beyond = v_set(SEVERAL_BEYOND);
  several_cells_rays* c = &v->cells;
  several_way *way = &v->ways[v->now], *next = &v->ways[1 - v->now];
  const int wanted = m_count(going);
  vmask left = mask;
  next->lo = next->hi = beyond;
  next->front = next->rise = zero;
  do {
    const vmask walks = m_andnot(live & v->k.live & c->rough, c->waiting);
    if (m_any(left & walks)) {
      several_cells_visit(from, v, walks);
    }
    vmask found = m_none();
    const vmask pieces = left & c->waiting, samples = m_andnot(left & v->k.live, c->rough | c->waiting);
    if (m_any(pieces)) {
      if (from->lit) {
        several_cells_cut(from, v, pieces);
      }
      found = several_cells_piece(from, v, pieces, next);
    }
    if (m_any(samples)) {
      found = found | several_cells_sample(from, v, samples, next);
    }
    if (m_any(found)) {
      several_shade(from, v, found);
      found = found & (v_lt(zero, next->rate[3]) | next->stops);
      several_take(v, found);
      if (from->lit) {
        several_take_light(v, found);
      }
      left = m_andnot(left, found);
    }
    const vmask ended = m_andnot(left, c->waiting | v->k.live);
    if (m_any(ended)) {
      way->lo = v_select(ended, beyond, way->lo);
      way->hi = v_select(ended, beyond, way->hi);
      way->rate[3] = v_select(ended, zero, way->rate[3]);
      way->stops = m_andnot(way->stops, ended);
      left = m_andnot(left, ended);
    }
  } while (m_any(left) && (wanted - m_count(left)) * SEVERAL_WAITING < wanted);
  v->comes = -1; /* nothing is due of stretches */
  return left;
}

/* Makes the volume's rays ready, before their first stretch. */
INLINE void several_cells_load(const several_source* from, several_volume* v)
{
  CONSTANT stratus_ray_cast_arguments* a = from->a;
  stratus_packet* k = &v->k;
  several_cells_rays* c = &v->cells;
  several_way* way = &v->ways[0];
  const vfloat zero = v_set(0.0f);
  const int nearest = RAY_RARE(RAY_NEAREST, a->values.nearest) != 0,
            halves = nearest & ((RAY_RARE(RAY_HIDDEN, a->values.has_hidden) & HIDDEN_CELLS) != 0) & !a->values.clamp;
  if (nearest) {
    cell_boxes(a, k, halves);
  }
  const vint behind = k->last;
  cell_begin(k, halves, nearest & !halves, &c->walk);
  c->way.k[0] = c->way.k[1] = c->way.k[2] = c->way.k[3] = c->way.lo = c->way.hi = zero;
  c->way.from = c->way.front = c->way.share = c->way.left = zero;
  c->way.to = v_set(2.0f);
  c->way.stretch = vi_set(0);
  c->waiting = m_none();
  c->rough = v_le(zero, zero);
  c->began = zero;
  if (from->cells == SEVERAL_LOCAL) { /* samples begin and end with the lattice, wherever the structure's box does */
    const vint stride = vi_set(from->stride), first = several_sample_of(from, v_to_int(c->walk.s) + v->phase) * stride - v->phase;
    const vint last = (several_sample_of(from, behind + v->phase) + vi_set(1)) * stride - v->phase;
    c->walk.s = v_select(k->live, v_max(v_from_int(first), k->begin), zero);
    c->walk.end = v_select(k->live, v_min(v_from_int(last), k->end), zero);
    c->end = c->walk.end;
    several_cells_run(from, v, k->live);
  } else {
    c->end = c->walk.end;
    cell_enter(a, k, &c->walk);
  }
  way->lo = v_set(SEVERAL_BEYOND);
  way->hi = v_select(k->live, v_set(-SEVERAL_BEYOND), way->lo); /* request the first stretch */
  way->lo = v_select(k->live, way->hi, way->lo);
  way->rate[0] = way->rate[1] = way->rate[2] = way->rate[3] = way->front = way->rise = way->entries = zero;
  way->wall[0] = way->wall[1] = way->wall[2] = zero;
  way->stops = m_none();
  v->shows = m_any(k->live) != 0;
}

#endif
