/* SPDX-License-Identifier: BSD-3-Clause
 * Walks rays through a distance field, a packet at a time, up to the first occupied voxel. Positions are in voxels: voxel i is i .. i+1.
 *
 * A position in float is off by up to `slack`. A ray leaps from cell to cell, and the voxel where it lands is certain unless it lands near
 * an edge of the lattice, where a second coordinate is near an integer. Only there can it miss a voxel or meet a wrong one, and only a
 * voxel that touches the edge. So a ray that lands near an edge with an occupied voxel about it is given up as doubtful, and the caller
 * walks it again in double precision. The answer is exact, and float does nearly all of the work.
 *
 * A ray that is slow along an axis, by less than a slack in a length, runs along a plane across it for long. Where floats have it cross
 * the plane, and where it does, may be voxels apart. Within occupied bricks it is seen at every voxel that it passes. Between bricks it is
 * not, so that a slow ray that lands near a brick's border of that axis is doubtful, too. */
#ifndef STRATUS_FIRST_HIT_H
#define STRATUS_FIRST_HIT_H

#include "first_hit_arguments.h"
#include "gather.h"

/* The arrays of a tree. One of one field has no use for the last three. */
typedef struct stratus_hit_tables {
  GLOBAL const uchar* entries;
  GLOBAL const int *rows, *masks;
  GLOBAL const int *nodes, *fields, *bricks; /* records of 8, 8 and 4 ints: the structs of bvh.h, tree.h and voxels.h */
} stratus_hit_tables;

/* The field of a packet: one field that all lanes share, or a leaf of its own in each lane. */
#define STRATUS_HIT_FIELD 0
#define STRATUS_HIT_LEAVES 1

typedef struct stratus_hit_packet {
  vfloat o[3], d[3], inverse[3];
  vfloat end; /* where the ray ends, in lengths of d */
  vint cell[3];
  vint octant_shift; /* bits to shift an entry by to reach the code of the ray's octant */
  vmask up[3];       /* directions >= 0 */
  vmask live, hit, doubtful;
  vint visited;
  /* In a tree of leaves: */
  vmask seeking;                                /* lanes that look for their next leaf; the live ones are in one */
  vint at[3], cells[3], first_entry, first_row; /* the lane's field */
  vint brick;                                   /* or its brick, a field of one cell; -1: none */
} stratus_hit_packet;

/* The field of one lane. */
typedef struct stratus_hit_place {
  int at[3], cells[3], first_entry, first_row, brick;
} stratus_hit_place;

/* 1 if voxel (x,y,z) of the field is occupied, 0 if it is not or lies beyond the field. */
INLINE int hit_occupied(
  CONSTANT stratus_hit_arguments* a, const stratus_hit_tables* tables, const stratus_hit_place* f, int x, int y, int z)
{
  const int log2 = f->brick < 0 ? a->cell_log2 : 2, bit = (z & 3) << 4 | (y & 3) << 2 | (x & 3);
  const int i = (x >> log2) - f->at[0], j = (y >> log2) - f->at[1], k = (z >> log2) - f->at[2];
  if (i < 0 || i >= f->cells[0] || j < 0 || j >= f->cells[1] || k < 0 || k >= f->cells[2]) {
    return 0;
  }
  if (f->brick >= 0) {
    return (tables->bricks[4 * f->brick + (bit >> 5)] >> (bit & 31)) & 1;
  }
  const int row = k * f->cells[1] + j;
  GLOBAL const uchar* e = tables->entries + (size_t)(f->first_entry + row * f->cells[0] + i) * (size_t)a->entry_bytes;
  const uint entry = (uint)e[0] | (uint)e[1] << 8 | (a->entry_bytes == 3 ? (uint)e[2] << 16 : 0u);
  if (entry & ((1u << a->entry_bytes) - 1u)) {
    return 0;
  }
  if (a->cell_log2 == 0) {
    return 1;
  }
  return (tables->masks[2 * (tables->rows[f->first_row + row] + (int)(entry >> a->entry_bytes)) + (bit >> 5)] >> (bit & 31)) & 1;
}

/* Returns 1 if a voxel within `reach` of `position`, which is in voxel `cell` or next to it, is occupied, or if another brick is within
 * reach across an axis along which the ray is slow. */
INLINE int hit_doubt(CONSTANT stratus_hit_arguments* a, const stratus_hit_tables* tables, const stratus_hit_place* field,
  const float position[3], const int cell[3], const int slow[3], float reach)
{
  const int log2 = field->brick < 0 ? a->cell_log2 : 2;
  int other[3];
  for (int axis = 0; axis < 3; ++axis) {
    const float f = position[axis] - (float)cell[axis];
    other[axis] = f < 0.5f ? (f < reach ? -1 : 0) : f > 1.0f - reach ? 1 : 0;
    if (slow[axis] && (cell[axis] + other[axis]) >> log2 != cell[axis] >> log2) {
      return 1;
    }
  }
  for (int corner = 0; corner < 8; ++corner) {
    int c[3];
    for (int axis = 0; axis < 3; ++axis) {
      c[axis] = cell[axis] + (corner >> axis & 1 ? other[axis] : 0);
    }
    if (hit_occupied(a, tables, field, c[0], c[1], c[2])) {
      return 1;
    }
  }
  return 0;
}

/* The lanes of `near` that hit_doubt(). A lane's reach is slack + late/4: the error of a position across a slow axis is two roundings, a
 * quarter of the slack, and `late` is the slack over the ray's speed across the plane where it landed. */
INLINE vmask hit_doubts(CONSTANT stratus_hit_arguments* a, const stratus_hit_tables* tables, const stratus_hit_packet* k, vmask near,
  const vfloat position[3], const vint cell[3], vfloat late, const int kind)
{
  float p[3][STRATUS_WIDTH], inverse[3][STRATUS_WIDTH], w[STRATUS_WIDTH];
  int c[3][STRATUS_WIDTH], at[3][STRATUS_WIDTH], cells[3][STRATUS_WIDTH], entry[STRATUS_WIDTH], row[STRATUS_WIDTH], brick[STRATUS_WIDTH],
    lanes[STRATUS_WIDTH];
  for (int axis = 0; axis < 3; ++axis) {
    v_store(p[axis], position[axis]);
    v_store(inverse[axis], k->inverse[axis]);
    vi_store(c[axis], cell[axis]);
    if (kind == STRATUS_HIT_LEAVES) {
      vi_store(at[axis], k->at[axis]);
      vi_store(cells[axis], k->cells[axis]);
    }
  }
  if (kind == STRATUS_HIT_LEAVES) {
    vi_store(entry, k->first_entry);
    vi_store(row, k->first_row);
    vi_store(brick, k->brick);
  }
  v_store(w, late);
  vi_store(lanes, vi_select(near, vi_set(1), vi_set(0)));
  for (int lane = 0; lane < STRATUS_WIDTH; ++lane) {
    if (lanes[lane]) {
      const float here[3] = { p[0][lane], p[1][lane], p[2][lane] };
      const int in[3] = { c[0][lane], c[1][lane], c[2][lane] };
      stratus_hit_place field;
      int slow[3];
      for (int axis = 0; axis < 3; ++axis) {
        slow[axis] = inverse[axis][lane] * a->slack > 1.0f || inverse[axis][lane] * a->slack < -1.0f;
        field.at[axis] = kind == STRATUS_HIT_LEAVES ? at[axis][lane] : a->at[axis];
        field.cells[axis] = kind == STRATUS_HIT_LEAVES ? cells[axis][lane] : a->cells[axis];
      }
      field.first_entry = kind == STRATUS_HIT_LEAVES ? entry[lane] : 0;
      field.first_row = kind == STRATUS_HIT_LEAVES ? row[lane] : a->row_start;
      field.brick = kind == STRATUS_HIT_LEAVES ? brick[lane] : -1;
      lanes[lane] = hit_doubt(a, tables, &field, here, in, slow, a->slack + 0.25f * w[lane]);
    }
  }
  return m_andnot(near, vi_zero(vi_load(lanes)));
}

/* One step of every live ray. A ray whose cell is an occupied voxel is hit; any other moves on. Where it leaves the field it ends, or seeks
 * its next leaf. The last four parameters repeat values of the arguments, so that the compiler sees them as constants. */
INLINE void hit_step(CONSTANT stratus_hit_arguments* a, const stratus_hit_tables* tables, stratus_hit_packet* k, const int kind,
  const int octants, const int entry_bytes, const int cell_log2)
{
  const vint low = vi_set((1 << entry_bytes) - 1), one = vi_set(1);
  const vfloat half_one = v_set(0.5f);
  /* A lane that walks a brick takes its steps by voxels, in cells of bricks. */
  const int brick_log2 = kind == STRATUS_HIT_LEAVES ? 2 : cell_log2;
  vint block[3], far[3], near[3], at[3], cells[3], shift = vi_set(cell_log2);
  vmask bricks = m_none(), in_field = k->live;
  if (kind == STRATUS_HIT_LEAVES) {
    bricks = vi_ge(k->brick, vi_set(0));
    in_field = m_andnot(k->live, bricks);
    if (cell_log2 != brick_log2) {
      shift = vi_select(bricks, vi_set(brick_log2), shift);
    }
  }
  for (int axis = 0; axis < 3; ++axis) {
    at[axis] = kind == STRATUS_HIT_LEAVES ? k->at[axis] : vi_set(a->at[axis]);
    cells[axis] = kind == STRATUS_HIT_LEAVES ? k->cells[axis] : vi_set(a->cells[axis]);
    block[axis] = k->cell[axis] >> shift;
  }
  const vint row = (block[1] - at[1]) + (block[2] - at[2]) * cells[1];
  vint index = (block[0] - at[0]) + row * cells[0];
  if (kind == STRATUS_HIT_LEAVES) {
    index = index + k->first_entry;
  }
  const vint entry = v_gather_bytes(tables->entries, entry_bytes == 2 ? index + index : (index + index) + index, in_field);
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
    const vint first = at[axis], beyond = at[axis] + cells[axis]; /* no leap goes beyond the field's border */
    far[axis] = vi_select(k->up[axis], vi_min(block[axis] + leap, beyond), vi_max(block[axis] + one - leap, first)) << shift;
    near[axis] = vi_select(k->up[axis], block[axis] << shift, ((block[axis] + one) << shift) - one);
  }
  if (m_any(occupied)) {
    vmask found = occupied;
    if (cell_log2 || kind == STRATUS_HIT_LEAVES) {
      const vint three = vi_set(3);
      const vint bit = (k->cell[0] & three) | (k->cell[1] & three) << vi_set(2) | (k->cell[2] & three) << vi_set(4);
      const vint upper = bit >> vi_set(5);
      vint word = vi_set(-1);
      if (cell_log2) {
        const vmask masked = occupied & in_field;
        const vint row_start = kind == STRATUS_HIT_LEAVES ? k->first_row : vi_set(a->row_start);
        const vint number = v_gather_ints(tables->rows, row + row_start, masked) +
          ((entry & vi_set(entry_bytes == 2 ? 0xffff : 0xffffff)) >> vi_set(entry_bytes));
        word = v_gather_ints(tables->masks, number + number + upper, masked);
      }
      if (kind == STRATUS_HIT_LEAVES) {
        const vmask own = occupied & bricks;
        if (m_any(own)) {
          word = vi_select(own, v_gather_ints(tables->bricks, (k->brick << vi_set(2)) + upper, own), word);
        }
      }
      found = m_andnot(occupied, vi_zero((word >> (bit & vi_set(31))) & one));
    }
    k->hit = k->hit | found;
    k->live = m_andnot(k->live, found);
    for (int axis = 0; axis < 3; ++axis) {
      far[axis] = vi_select(occupied, vi_select(k->up[axis], k->cell[axis] + one, k->cell[axis]), far[axis]);
      near[axis] = vi_select(occupied, k->cell[axis], near[axis]);
    }
  }
  vfloat leave[3], next, late = v_set(0.0f);
  for (int axis = 0; axis < 3; ++axis) {
    leave[axis] = (v_from_int(far[axis]) - k->o[axis]) * k->inverse[axis];
  }
  next = v_min(v_min(leave[0], leave[1]), leave[2]);
  for (int axis = 0; axis < 3; ++axis) {
    late = v_select(v_le(leave[axis], next), v_max(late, v_abs(k->inverse[axis])), late);
  }
  late = late * v_set(a->slack);
  /* A second coordinate is as uncertain as the time of the crossing. */
  const vfloat certain = v_fma(late, v_set(-0.25f), v_set(0.5f - a->slack));
  const vmask ended = v_lt(k->end + late, next);
  vmask edge[3], left = m_none();
  vfloat position[3];
  for (int axis = 0; axis < 3; ++axis) {
    position[axis] = v_fma(next, k->d[axis], k->o[axis]);
    const vint last = vi_select(k->up[axis], far[axis] - one, far[axis]);
    const vint beyond = vi_select(k->up[axis], far[axis], far[axis] - one);
    const vint in = vi_min(vi_max(v_to_int(position[axis]), vi_min(near[axis], last)), vi_max(near[axis], last));
    const vint cell = vi_select(v_le(leave[axis], next), beyond, in);
    k->cell[axis] = vi_select(k->live, cell, k->cell[axis]);
    edge[axis] = v_lt(certain, v_abs((position[axis] - v_from_int(cell)) - half_one));
    left = left | vi_outside((cell >> shift) - at[axis], cells[axis]);
  }
  const vmask doubt = k->live & ((edge[0] & edge[1]) | (edge[2] & (edge[0] | edge[1])) | v_lt(v_set(1.0f), late));
  if (kind == STRATUS_HIT_LEAVES) {
    k->seeking = k->seeking | m_andnot(k->live & left, ended);
  }
  k->live = m_andnot(k->live, left | ended);
  if (m_any(doubt)) {
    const vmask doubtful = hit_doubts(a, tables, k, doubt, position, k->cell, late, kind);
    k->doubtful = k->doubtful | doubtful;
    k->live = m_andnot(k->live, doubtful);
    if (kind == STRATUS_HIT_LEAVES) {
      k->seeking = m_andnot(k->seeking, doubtful);
    }
  }
}

#endif
