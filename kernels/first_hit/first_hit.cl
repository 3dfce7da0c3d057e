/* SPDX-License-Identifier: BSD-3-Clause
 * First hits in a tree. Each work item walks STRATUS_WIDTH neighbouring rays, through one distance field or, with STRATUS_LEAVES, through
 * many leaves. */
#ifndef STRATUS_DEVICE
#define STRATUS_DEVICE 1
#endif
#ifndef STRATUS_WIDTH
#define STRATUS_WIDTH 1
#endif
#ifndef STRATUS_LEAVES
#define STRATUS_LEAVES 0
#endif
#ifndef STRATUS_OCTANTS
#define STRATUS_OCTANTS 1
#endif
#ifndef STRATUS_ENTRY_BYTES
#define STRATUS_ENTRY_BYTES 2
#endif
#ifndef STRATUS_CELL_LOG2
#define STRATUS_CELL_LOG2 2
#endif

#include "first_hit_leaves.h"

#ifdef STRATUS_ARGUMENTS_BYTES
/* An array of negative size, which does not compile, where the host lays the arguments out otherwise. */
typedef char stratus_arguments_agree[sizeof(stratus_hit_arguments) == STRATUS_ARGUMENTS_BYTES ? 1 : -1];
#endif

/* rays: arrays of `count` floats, in the order origin x y z, direction x y z, inverse direction x y z, end; then arrays of `count` ints,
 * cell x y z. results: arrays of `count` ints, in the order state (STRATUS_HIT_*), voxel x y z, steps. One field reads no nodes, fields and
 * bricks. */
PACKET_KERNEL void first_hit(__constant stratus_hit_arguments* a, __global const uchar* entries, __global const int* rows,
  __global const int* masks, __global const int* nodes, __global const int* fields, __global const int* bricks, __global const float* rays,
  __global int* results)
{
  const int count = a->count, first = (int)get_global_id(0) * STRATUS_WIDTH;
  if (first >= count) {
    return;
  }
  const stratus_hit_tables tables = { entries, rows, masks, nodes, fields, bricks };
  float f[10][STRATUS_WIDTH];
  int cell[3][STRATUS_WIDTH], on[STRATUS_WIDTH];
  __global const int* cells = (__global const int*)(rays + 10 * (size_t)count);
  for (int lane = 0; lane < STRATUS_WIDTH; ++lane) {
    const int ray = min(first + lane, count - 1);
    for (int i = 0; i < 10; ++i) {
      f[i][lane] = rays[(size_t)i * (size_t)count + (size_t)ray];
    }
    for (int axis = 0; axis < 3; ++axis) {
      cell[axis][lane] = cells[(size_t)axis * (size_t)count + (size_t)ray];
    }
    on[lane] = first + lane < count && f[9][lane] >= 0.0f;
  }
  stratus_hit_packet k;
  vint octant = vi_set(0);
  for (int axis = 0; axis < 3; ++axis) {
    k.o[axis] = v_load(f[axis]);
    k.d[axis] = v_load(f[3 + axis]);
    k.inverse[axis] = v_load(f[6 + axis]);
    k.cell[axis] = vi_load(cell[axis]);
    k.up[axis] = v_lt(v_set(0.0f), k.d[axis]);
    octant = octant | vi_select(k.up[axis], vi_set(1 << axis), vi_set(0));
  }
  k.octant_shift = octant * vi_set(a->entry_bytes);
  k.end = v_load(f[9]);
  k.live = m_andnot(v_le(v_set(0.0f), k.end), vi_zero(vi_load(on)));
  k.hit = m_none();
  k.doubtful = m_none();
  k.visited = vi_set(0);
  k.seeking = m_none();
#if STRATUS_LEAVES
  stratus_hit_search search;
  search.top = search.node = search.count = search.first = search.key = search.number = vi_set(0);
  k.first_entry = k.first_row = k.brick = vi_set(0);
  for (int axis = 0; axis < 3; ++axis) {
    k.at[axis] = k.cells[axis] = vi_set(0);
  }
  hit_begin(&k, &search, k.live);
  k.live = m_none();
  while (m_any(k.live | k.seeking)) {
    hit_step_leaves(a, &tables, &k, &search, STRATUS_OCTANTS, STRATUS_ENTRY_BYTES, STRATUS_CELL_LOG2);
  }
#else
  while (m_any(k.live)) {
    hit_step(a, &tables, &k, STRATUS_HIT_FIELD, STRATUS_OCTANTS, STRATUS_ENTRY_BYTES, STRATUS_CELL_LOG2);
  }
#endif
  int state[STRATUS_WIDTH], visited[STRATUS_WIDTH];
  vi_store(
    state, vi_select(k.hit, vi_set(STRATUS_HIT_VOXEL), vi_select(k.doubtful, vi_set(STRATUS_HIT_DOUBTFUL), vi_set(STRATUS_HIT_NONE))));
  vi_store(visited, k.visited);
  for (int axis = 0; axis < 3; ++axis) {
    vi_store(cell[axis], k.cell[axis]);
  }
  for (int lane = 0; lane < STRATUS_WIDTH; ++lane) {
    const size_t ray = (size_t)(first + lane), n = (size_t)count;
    if (first + lane < count) {
      results[ray] = state[lane];
      for (int axis = 0; axis < 3; ++axis) {
        results[(size_t)(1 + axis) * n + ray] = cell[axis][lane];
      }
      results[4 * n + ray] = visited[lane];
    }
  }
}
