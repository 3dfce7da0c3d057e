/* SPDX-License-Identifier: BSD-3-Clause
 * Walks rays through one distance field, a packet at a time, up to the first occupied voxel. Positions are in voxels: voxel i is i .. i+1.
 *
 * A position in float is off by up to `slack`. A ray leaps from cell to cell, and the cell where it lands is certain unless it lands near
 * an edge of the lattice, where two coordinates are within slack of an integer. Only there can it miss a voxel or meet a wrong one, and
 * only a voxel that touches the edge. So a ray that lands near an edge with an occupied voxel about it is given up as doubtful, and the
 * caller walks it again in double precision. The answer is exact, and float does nearly all of the work. */
#ifndef STRATUS_FIRST_HIT_H
#define STRATUS_FIRST_HIT_H

#include "first_hit_arguments.h"
#include "gather.h"

typedef struct stratus_hit_packet {
  vfloat o[3], d[3], inverse[3];
  vfloat end; /* where the ray ends, in lengths of d */
  vint cell[3];
  vint octant_shift; /* bits to shift an entry by to reach the code of the ray's octant */
  vmask up[3];       /* directions >= 0 */
  vmask live, hit, doubtful;
  vint visited;
} stratus_hit_packet;

/* 1 if voxel (x,y,z) of the field is occupied, 0 if it is not or lies beyond the field. */
INLINE int hit_occupied(
  CONSTANT stratus_hit_arguments* a, GLOBAL const uchar* entries, GLOBAL const int* rows, GLOBAL const int* masks, int x, int y, int z)
{
  const int i = (x >> a->cell_log2) - a->at[0], j = (y >> a->cell_log2) - a->at[1], k = (z >> a->cell_log2) - a->at[2];
  if (i < 0 || i >= a->cells[0] || j < 0 || j >= a->cells[1] || k < 0 || k >= a->cells[2]) {
    return 0;
  }
  const int row = k * a->cells[1] + j;
  GLOBAL const uchar* e = entries + (size_t)(row * a->cells[0] + i) * (size_t)a->entry_bytes;
  const uint entry = (uint)e[0] | (uint)e[1] << 8 | (a->entry_bytes == 3 ? (uint)e[2] << 16 : 0u);
  if (entry & ((1u << a->entry_bytes) - 1u)) {
    return 0;
  }
  if (a->cell_log2 == 0) {
    return 1;
  }
  const int bit = (z & 3) << 4 | (y & 3) << 2 | (x & 3);
  return (masks[2 * (rows[a->row_start + row] + (int)(entry >> a->entry_bytes)) + (bit >> 5)] >> (bit & 31)) & 1;
}

/* 1 if one of the voxels that touch the edge at `position` is occupied. */
INLINE int hit_doubt(CONSTANT stratus_hit_arguments* a, GLOBAL const uchar* entries, GLOBAL const int* rows, GLOBAL const int* masks,
  const float position[3], const int cell[3])
{
  int other[3];
  for (int axis = 0; axis < 3; ++axis) {
    const float f = position[axis] - (float)cell[axis];
    other[axis] = f < a->slack ? -1 : f > 1.0f - a->slack ? 1 : 0;
  }
  for (int corner = 0; corner < 8; ++corner) {
    int c[3];
    for (int axis = 0; axis < 3; ++axis) {
      c[axis] = cell[axis] + (corner >> axis & 1 ? other[axis] : 0);
    }
    if (hit_occupied(a, entries, rows, masks, c[0], c[1], c[2])) {
      return 1;
    }
  }
  return 0;
}

/* One step of every live ray. A ray whose cell is an occupied voxel is hit; any other moves on, and ends where it leaves the field. The
 * last three parameters repeat fields of the arguments, so that the compiler sees them as constants. */
INLINE void hit_step(CONSTANT stratus_hit_arguments* a, GLOBAL const uchar* entries, GLOBAL const int* rows, GLOBAL const int* masks,
  stratus_hit_packet* k, const int octants, const int entry_bytes, const int cell_log2)
{
  const vint low = vi_set((1 << entry_bytes) - 1), one = vi_set(1);
  const vfloat half_one = v_set(0.5f), certain = v_set(0.5f - a->slack);
  vint block[3], far[3], near[3];
  for (int axis = 0; axis < 3; ++axis) {
    block[axis] = k->cell[axis] >> vi_set(cell_log2);
  }
  const vint row = (block[1] - vi_set(a->at[1])) + (block[2] - vi_set(a->at[2])) * vi_set(a->cells[1]);
  const vint index = (block[0] - vi_set(a->at[0])) + row * vi_set(a->cells[0]);
  const vint entry = v_gather_bytes(entries, entry_bytes == 2 ? index + index : (index + index) + index, k->live);
  const vmask occupied = k->live & vi_zero(entry & low);
  k->visited = vi_select(k->live, k->visited + one, k->visited);
  vint leap;
  if (octants) {
    const vint code = (entry >> k->octant_shift) & low;
    if (entry_bytes == 2) {
      leap = (one << code) >> one;
    } else {
      leap = ((vi_set(2) + (code & one)) << (code >> one)) >> one;
    }
  } else {
    leap = (entry & vi_set(0xffff)) >> vi_set(2);
  }
  for (int axis = 0; axis < 3; ++axis) {
    const vint first = vi_set(a->at[axis]), beyond = vi_set(a->at[axis] + a->cells[axis]); /* no leap goes beyond the field's border */
    far[axis] = vi_select(k->up[axis], vi_min(block[axis] + leap, beyond), vi_max(block[axis] + one - leap, first)) << vi_set(cell_log2);
    near[axis] = vi_select(k->up[axis], block[axis] << vi_set(cell_log2), ((block[axis] + one) << vi_set(cell_log2)) - one);
  }
  if (m_any(occupied)) {
    vmask found = occupied;
    if (cell_log2) {
      const vint number = v_gather_ints(rows, row + vi_set(a->row_start), occupied) +
        ((entry & vi_set(entry_bytes == 2 ? 0xffff : 0xffffff)) >> vi_set(entry_bytes));
      const vint three = vi_set(3);
      const vint bit = (k->cell[0] & three) | (k->cell[1] & three) << vi_set(2) | (k->cell[2] & three) << vi_set(4);
      const vint word = v_gather_ints(masks, number + number + (bit >> vi_set(5)), occupied);
      found = m_andnot(occupied, vi_zero((word >> (bit & vi_set(31))) & one));
    }
    k->hit = k->hit | found;
    k->live = m_andnot(k->live, found);
    for (int axis = 0; axis < 3; ++axis) {
      far[axis] = vi_select(occupied, vi_select(k->up[axis], k->cell[axis] + one, k->cell[axis]), far[axis]);
      near[axis] = vi_select(occupied, k->cell[axis], near[axis]);
    }
  }
  vfloat leave[3], next;
  for (int axis = 0; axis < 3; ++axis) {
    leave[axis] = (v_from_int(far[axis]) - k->o[axis]) * k->inverse[axis];
  }
  next = v_min(v_min(leave[0], leave[1]), leave[2]);
  vmask edge[3], left = v_lt(k->end, next);
  vfloat position[3];
  for (int axis = 0; axis < 3; ++axis) {
    position[axis] = v_fma(next, k->d[axis], k->o[axis]);
    const vint last = vi_select(k->up[axis], far[axis] - one, far[axis]);
    const vint beyond = vi_select(k->up[axis], far[axis], far[axis] - one);
    const vint in = vi_min(vi_max(v_to_int(position[axis]), vi_min(near[axis], last)), vi_max(near[axis], last));
    const vint cell = vi_select(v_le(leave[axis], next), beyond, in);
    k->cell[axis] = vi_select(k->live, cell, k->cell[axis]);
    edge[axis] = v_lt(certain, v_abs((position[axis] - v_from_int(cell)) - half_one));
    left = left | vi_outside((cell >> vi_set(cell_log2)) - vi_set(a->at[axis]), vi_set(a->cells[axis]));
  }
  const vmask doubt = k->live & ((edge[0] & edge[1]) | (edge[2] & (edge[0] | edge[1])));
  k->live = m_andnot(k->live, left);
  if (m_any(doubt)) {
    float p[3][STRATUS_WIDTH];
    int c[3][STRATUS_WIDTH], lanes[STRATUS_WIDTH];
    for (int axis = 0; axis < 3; ++axis) {
      v_store(p[axis], position[axis]);
      vi_store(c[axis], k->cell[axis]);
    }
    vi_store(lanes, vi_select(doubt, one, vi_set(0)));
    for (int lane = 0; lane < STRATUS_WIDTH; ++lane) {
      const float here[3] = { p[0][lane], p[1][lane], p[2][lane] };
      const int cell[3] = { c[0][lane], c[1][lane], c[2][lane] };
      lanes[lane] = lanes[lane] && hit_doubt(a, entries, rows, masks, here, cell);
    }
    const vmask doubtful = m_andnot(doubt, vi_zero(vi_load(lanes)));
    k->doubtful = k->doubtful | doubtful;
    k->live = m_andnot(k->live, doubtful);
  }
}

#endif
