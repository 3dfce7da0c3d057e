/* SPDX-License-Identifier: BSD-3-Clause
 * The bound of each block, for rays that look for the largest or smallest value. Behind the map's own bytes lie the bits of a float a
 * block, x fastest: the block's largest value (the negative of its smallest where that is looked for), rounded up by more than
 * interpolation can round. */
#ifndef STRATUS_RAY_EXTREMES_H
#define STRATUS_RAY_EXTREMES_H

#include "ray_blocks.h"

/* Lanes of `mask` whose block may hold something better than `best`. */
INLINE vmask best_may_be_in(CONSTANT stratus_ray_cast_arguments* a, GLOBAL const uchar* map, const vint block[3], vfloat best, vmask mask)
{
  GLOBAL const int* bounds = (GLOBAL const int*)(map + (size_t)a->map.bounds_at * 64);
  const vint index = block[0] + (block[1] + block[2] * vi_set(a->map.bounds_rows)) * vi_set(a->map.bounds_across);
  return mask & v_lt(best, v_from_bits(gather_int32(bounds, index, mask)));
}

#endif
