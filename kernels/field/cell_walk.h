/* SPDX-License-Identifier: BSD-3-Clause
 * The walk of a packet of rays from cell to cell.
 *
 * A ray meets plane n of an axis at (n - p) / d, rounded once, and passes from cell to cell at these numbers only. A leap ends at such a
 * number, too. So the cells behind a leap are those to which a walk without leaps would have come, and the bits do not depend on the
 * structure. */
#ifndef STRATUS_CELL_WALK_H
#define STRATUS_CELL_WALK_H

#include "ray_blocks.h"
#include "tree_map.h"

/* Where the ray is: s, the cell, and the planes by which it enters and leaves the cell. */
typedef struct cell_walk {
  vfloat s, leave, end;
  vfloat enter_at[3], leave_at[3];
  vfloat ahead[3]; /* the plane that is met at leave_at */
  vint cell[3];
  vfloat run; /* up to this s the structure need not be asked */
  int halves; /* 1: the planes are half a cell apart, so that cell c of the volume is 2 c and 2 c + 1; else 0 */
  int boxes;  /* 1: cells are the boxes about values, and plane n is before value n; else 0. Read in stretched grids only. */
} cell_walk;

/* Where a plane is. */
INLINE vfloat walk_plane(CONSTANT stratus_ray_cast_arguments* a, const stratus_packet* k, const cell_walk* w, int axis, vint plane)
{
  vfloat at = v_from_int(plane);
  if (RAY_STRETCHED(a)) {
    at = grid_plane_rare(a, k->grid, axis, (plane << vi_set(1 - w->halves)) - vi_set(w->boxes));
  }
  return at;
}

INLINE vfloat plane_met(CONSTANT stratus_ray_cast_arguments* a, const stratus_packet* k, const cell_walk* w, int axis, vint plane)
{
  return (walk_plane(a, k, w, axis, plane) - k->p[axis]) * k->inverse[axis];
}

/* The cell at a position, up to rounding. */
INLINE vint walk_cell(CONSTANT stratus_ray_cast_arguments* a, const stratus_packet* k, const cell_walk* w, int axis, vfloat at)
{
  vint cell = v_to_int(at + v_set(1.0f)) - vi_set(1); /* never below -1 */
  if (RAY_STRETCHED(a)) {
    cell = (grid_last_plane(a, k->grid, axis, at) + vi_set(w->boxes)) >> vi_set(1 - w->halves);
  }
  return cell;
}

/* The cell that each ray enters at its point s. */
INLINE void cell_enter(CONSTANT stratus_ray_cast_arguments* a, const stratus_packet* k, cell_walk* w)
{
  const vint zero = vi_set(0), one = vi_set(1);
  w->leave = w->end;
  for (int axis = 0; axis < 3; ++axis) {
    const vmask forward = v_lt(v_set(0.0f), k->inverse[axis]);
    const vint step = vi_select(forward, one, vi_set(-1)), to_near = vi_select(forward, zero, one);
    const vint cell = walk_cell(a, k, w, axis, v_fma(w->s, k->d[axis], k->p[axis]));
    /* the product is rounded, so that the cell may be one off */
    const vfloat before = plane_met(a, k, w, axis, cell + to_near), after = plane_met(a, k, w, axis, cell + to_near + step);
    w->cell[axis] = cell + vi_select(v_lt(w->s, before), zero - step, vi_select(v_le(after, w->s), step, zero));
    w->enter_at[axis] = plane_met(a, k, w, axis, w->cell[axis] + to_near);
    w->ahead[axis] = walk_plane(a, k, w, axis, w->cell[axis] + to_near + step);
    w->leave_at[axis] = (w->ahead[axis] - k->p[axis]) * k->inverse[axis];
    w->leave = v_min(w->leave_at[axis], w->leave);
  }
}

/* Puts the rays at their begin. Returns 0 if none is live. */
INLINE int cell_begin(stratus_packet* k, int halves, int boxes, cell_walk* w)
{
  w->s = v_max(v_from_int(k->i), k->begin);
  w->end = v_min(v_from_int(k->last), k->end);
  w->run = v_select(v_lt(v_from_int(k->run), v_set(1.0f)), v_set(-1.0f), v_set(LARGEST_FLOAT));
  w->halves = halves;
  w->boxes = boxes;
  k->live = k->live & v_lt(w->s, w->end);
  w->s = v_select(k->live, w->s, v_set(0.0f)); /* lanes that are not live stay at a harmless place */
  w->end = v_select(k->live, w->end, v_set(0.0f));
  return m_any(k->live);
}

/* The place where a ray at s continues that leaves its cell or block at `leave`. A ray always advances, even if floats cannot distinguish
 * two planes. */
INLINE vfloat beyond_plane(vfloat s, vfloat leave) { return v_select(v_lt(s, leave), leave, v_fma(s, v_set(1e-6f), s + v_set(1e-6f))); }

/* Moves the rays of `mask` into the cells behind theirs. Only the planes that a ray has met are taken anew; they are met at the numbers
 * that cell_enter() computes. */
INLINE void cell_leave(CONSTANT stratus_ray_cast_arguments* a, stratus_packet* k, vmask mask, cell_walk* w)
{
  w->s = v_select(mask, beyond_plane(w->s, w->leave), w->s);
  k->live = m_andnot(k->live, mask & v_le(w->end, w->s));
  w->leave = w->end;
  for (int axis = 0; axis < 3; ++axis) {
    const vmask forward = v_lt(v_set(0.0f), k->inverse[axis]), met = mask & v_le(w->leave_at[axis], w->s);
    w->enter_at[axis] = v_select(met, w->leave_at[axis], w->enter_at[axis]);
    w->cell[axis] = vi_select(met, w->cell[axis] + vi_select(forward, vi_set(1), vi_set(-1)), w->cell[axis]);
    vfloat next = w->ahead[axis] + v_select(forward, v_set(1.0f), v_set(-1.0f));
    if (RAY_STRETCHED(a)) {
      next = walk_plane(a, k, w, axis, vi_select(forward, w->cell[axis] + vi_set(1), w->cell[axis]));
    }
    w->ahead[axis] = v_select(met, next, w->ahead[axis]);
    w->leave_at[axis] = (w->ahead[axis] - k->p[axis]) * k->inverse[axis];
    w->leave = v_min(w->leave_at[axis], w->leave);
  }
  if (m_any(mask & k->live & v_le(w->leave, w->s))) { /* several planes of an axis at once */
    cell_enter(a, k, w);
  }
}

/* Makes the boxes about values cells, or halves of cells where boxes are cut at the cells' planes. */
INLINE void cell_boxes(CONSTANT stratus_ray_cast_arguments* a, stratus_packet* k, int halves)
{
  const int even = !RAY_STRETCHED(a), twice = even & halves, moved = even & !halves; /* stretched grids have planes of both kinds */
  const vfloat scale = v_set(twice ? 2.0f : 1.0f), shift = v_set(moved ? 0.5f : 0.0f), shrink = v_set(twice ? 0.5f : 1.0f);
  for (int axis = 0; axis < 3; ++axis) {
    k->p[axis] = v_fma(k->p[axis], scale, shift);
    k->d[axis] = k->d[axis] * scale;
    k->inverse[axis] = k->inverse[axis] * shrink;
  }
}

/* The cell whose values are read. Where positions are clamped that is the border's cell. */
INLINE vint cell_inside(CONSTANT stratus_ray_cast_arguments* a, const cell_walk* w, int axis)
{
  return vi_max(vi_min(w->cell[axis] >> vi_set(w->halves), vi_set(a->values.dimensions[axis] - 2)), vi_set(0));
}

/* The fraction of the cell along an axis at point s of the ray, in 0..1. */
INLINE vfloat cell_place(CONSTANT stratus_ray_cast_arguments* a, const stratus_packet* k, int axis, vint inside, vfloat s)
{
  const vfloat at = v_fma(s, k->d[axis], k->p[axis]);
  vfloat place = v_clamp(at - v_from_int(inside), 0.0f, 1.0f);
  if (RAY_STRETCHED(a)) {
    place = grid_fraction_rare(a, k->grid, axis, inside, at);
  }
  return place;
}

/* The same: exactly 0 or 1 where the ray meets the plane at s. */
INLINE vfloat cell_fraction(
  CONSTANT stratus_ray_cast_arguments* a, const stratus_packet* k, int axis, vint inside, vfloat s, vfloat met, vint plane)
{
  const vfloat base = v_from_int(inside), at = cell_place(a, k, axis, inside, s), exact = v_from_int(plane) - base;
  const vmask there = v_le(met, s) & v_le(s, met);
  return v_clamp(v_select(there, exact, at), 0.0f, 1.0f);
}

/* The structure is asked once all lanes of `mask` need it, or one lane has waited for CELL_PATIENCE voxels. A lane that waits visits cells,
 * which add nothing. */
#define CELL_PATIENCE 3.0f

INLINE vmask cell_lanes_to_skip(vmask mask, const cell_walk* w)
{
  const vmask need = mask & v_le(w->run, w->s);
#if STRATUS_WIDTH > 1
  const int count = m_count(need);
  if (count && count < m_count(mask) && !m_any(need & v_le(w->run + v_set(CELL_PATIENCE), w->s))) {
    return m_none();
  }
#endif
  return need;
}

/* Where rays leave the cubes of blocks nearer than `distance`, at their end at the latest. block_log2: of a block's size in planes. */
INLINE vfloat cell_cube_exit(
  CONSTANT stratus_ray_cast_arguments* a, const stratus_packet* k, const cell_walk* w, const vint block[3], vint distance, int block_log2)
{
  vfloat leave = w->end;
  for (int axis = 0; axis < 3; ++axis) {
    const vmask forward = v_lt(v_set(0.0f), k->inverse[axis]);
    const vint face = vi_select(forward, block[axis] + distance, block[axis] - distance + vi_set(1));
    leave = v_min(plane_met(a, k, w, axis, face << vi_set(block_log2)), leave);
  }
  return leave;
}

/* Moves the rays of `need` over cubes of blocks that hold nothing that shows. */
INLINE void cell_skip(CONSTANT stratus_ray_cast_arguments* a, GLOBAL const uchar* map, stratus_packet* k, vmask need, cell_walk* w)
{
  while (m_any(need)) {
    vint block[3], byte;
    for (int axis = 0; axis < 3; ++axis) {
      block[axis] = cell_inside(a, w, axis) >> vi_set(a->map.block_log2);
    }
    if (RAY_RARE(RAY_TREE, a->map.tree)) {
      byte = tree_bytes(a, map, block, need);
    } else {
      byte = gather_map(map, block[0] + (block[1] + block[2] * vi_set(a->map.rows)) * vi_set(a->map.pitch) + k->octant, need);
    }
    k->lookups -= mask_int(need);
    const vmask occupied = need & vi_ge(byte, vi_set(128));
    const vint distance = byte & vi_set(127);
    vfloat leave = cell_cube_exit(a, k, w, block, distance, a->map.block_log2 + w->halves);
    const vmask leap = m_andnot(need, occupied) & v_lt(w->s, leave); /* in the volume's rim, where values are clamped, there is no leap */
    w->run = v_select(m_andnot(need, leap), v_max(leave, w->leave), w->run);
    leave = v_select(leap, leave, w->s); /* in other lanes a plane may be farther than an int can hold */
    k->skipped = k->skipped + (v_to_int(leave) - v_to_int(w->s));
    w->s = leave;
    k->live = m_andnot(k->live, leap & v_le(w->end, w->s));
    need = leap & k->live;
    if (m_any(need)) {
      cell_enter(a, k, w);
    }
  }
}

#endif
