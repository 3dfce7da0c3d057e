/* SPDX-License-Identifier: BSD-3-Clause
 * The structure's blocks on a ray: which lanes read the structure, in which block a ray is, and where it leaves an empty cube. */
#ifndef STRATUS_RAY_BLOCKS_H
#define STRATUS_RAY_BLOCKS_H

#include "gather.h"
#include "stretched_grid.h"
#include "ray_packet.h"

/* Read the structure when every live lane needs it, or when one lane has waited SKIP_PATIENCE samples. By then the lane has wasted about
 * the cost of one read. */
#define SKIP_PATIENCE STRATUS_WIDTH

INLINE vmask lanes_to_skip(const stratus_packet* k)
{
  const vmask need = k->live & vi_ge(k->i, k->run);
#if STRATUS_WIDTH > 1
  const int count = m_count(need);
  if (count && count < m_count(k->live) && !m_any(k->live & vi_ge(k->i, k->run + vi_set(SKIP_PATIENCE)))) {
    return m_none();
  }
#endif
  return need;
}

INLINE vint gather_map(GLOBAL const uchar* map, vint index, vmask mask)
{
#if STRATUS_WIDTH == 1
  return mask ? (int)map[index] : 0;
#elif defined(STRATUS_DEVICE) && defined(STRATUS_DEVICE_AVX512)
  return STRATUS_GATHER(map, index, mask, 1) & (int16)(255);
#elif !defined(STRATUS_DEVICE) && STRATUS_ISA == 2
  return (vint)_mm512_mask_i32gather_epi32(_mm512_setzero_si512(), mask, (__m512i)index, map, 1) & vi_set(255);
#else
  int li[STRATUS_WIDTH];
  vi_store(li, vi_select(mask, index, vi_set(0)));
  for (int lane = 0; lane < STRATUS_WIDTH; ++lane) {
    li[lane] = map[li[lane]];
  }
  return vi_load(li);
#endif
}

/* The blocks in which the rays are at s. */
INLINE void packet_blocks(CONSTANT stratus_ray_cast_arguments* a, const stratus_packet* k, vfloat s, vint block[3])
{
  if (RAY_STRETCHED(a)) {
    const vfloat y[3] = { v_fma(s, k->d[0], k->p[0]), v_fma(s, k->d[1], k->p[1]), v_fma(s, k->d[2], k->p[2]) };
    vint cell[3];
    grid_cells(a, k->grid, y, cell);
    for (int axis = 0; axis < 3; ++axis) {
      block[axis] = cell[axis] >> vi_set(a->map.block_log2);
    }
  } else {
    for (int axis = 0; axis < 3; ++axis) {
      vfloat x = v_fma(s, k->d[axis], k->p[axis]);
      if (a->values.clamp) {
        x = v_clamp(x, 0.0f, a->values.last[axis]);
      }
      block[axis] = v_to_int(x) >> vi_set(a->map.block_log2);
    }
  }
}

/* Where the rays leave the cube of blocks nearer than `distance`, in samples. The result is a little too early, by more than division and
 * product can round. */
INLINE vfloat cube_exit(CONSTANT stratus_ray_cast_arguments* a, const stratus_packet* k, const vint block[3], vint distance)
{
  vfloat leave = v_set(1e7f);
  for (int axis = 0; axis < 3; ++axis) {
    const vmask forward = v_lt(v_set(0.0f), k->inverse[axis]);
    const vint face = vi_select(forward, block[axis] + distance, block[axis] - distance + vi_set(1));
    vfloat plane = v_from_int(face << vi_set(a->map.block_log2));
    if (RAY_STRETCHED(a)) {
      plane = grid_plane_rare(a, k->grid, axis, face << vi_set(a->map.block_log2 + 1));
    }
    leave = v_min((plane - k->p[axis]) * k->inverse[axis], leave);
  }
  return v_max(v_fma(leave, v_set(-0x1p-21f), leave - v_set(0x1p-10f)), v_set(0.0f));
}

#endif
