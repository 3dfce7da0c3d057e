/* SPDX-License-Identifier: BSD-3-Clause
 * Places where rays are in rough blocks. A map of blocks of its own holds the rough blocks, independent of the structure. A ray is a
 * sequence of runs, the longest parts of it whose blocks are all smooth or all rough. One run ends and the next begins where a cell does,
 * at a plane's number (cell_walk.h). */
#ifndef STRATUS_LOCAL_RUNS_H
#define STRATUS_LOCAL_RUNS_H

#include "cell_walk.h"

/* Where the run of every ray begins, where it ends and where the ray does, in samples. */
typedef struct local_runs {
  vfloat begin, to, end;
  vmask rough;
} local_runs;

/* The bytes of the map of rough blocks in the blocks where the walk is, and where rays leave the cubes of blocks of the same kind. */
INLINE vint local_byte(
  CONSTANT stratus_ray_cast_arguments* a, GLOBAL const uchar* rough, const stratus_packet* k, const cell_walk* w, vmask mask, vfloat* leave)
{
  vint block[3];
  for (int axis = 0; axis < 3; ++axis) {
    block[axis] = cell_inside(a, w, axis) >> vi_set(a->rough.block_log2);
  }
  const vint byte = gather_map(rough, block[0] + (block[1] + block[2] * vi_set(a->rough.rows)) * vi_set(a->rough.pitch), mask);
  *leave = cell_cube_exit(a, k, w, block, byte & vi_set(127), a->rough.block_log2);
  return byte;
}

/* Finds the runs that begin at r->begin in the lanes of the mask. */
INLINE void local_find(CONSTANT stratus_ray_cast_arguments* a, GLOBAL const uchar* rough, stratus_packet* k, vmask mask, local_runs* r)
{
  vmask first = mask;
  cell_walk w;
  w.s = r->begin;
  w.end = r->end;
  w.halves = w.boxes = 0;
  while (m_any(mask)) {
    vfloat leave;
    cell_enter(a, k, &w);
    const vint byte = local_byte(a, rough, k, &w, mask, &leave);
    const vmask is_rough = mask & vi_ge(byte, vi_set(128));
    k->lookups -= mask_int(mask);
    r->rough = m_andnot(r->rough, first) | (is_rough & first);
    first = m_none();
    mask = (is_rough & r->rough) | m_andnot(m_andnot(mask, is_rough), r->rough);
    leave = v_max(leave, w.leave); /* in the volume's rim, where values are clamped, the border's block is behind the ray */
    leave = v_min(beyond_plane(w.s, leave), w.end);
    r->to = v_select(mask, leave, r->to);
    mask = mask & v_lt(leave, w.end);
    w.s = v_select(mask, leave, w.s);
  }
}

#endif
