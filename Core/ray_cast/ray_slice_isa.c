/* SPDX-License-Identifier: BSD-3-Clause
 * Slices, compiled for one instruction set, STRATUS_ISA. A ray takes two samples at most, so that the generic fetch serves all types. */
#include "ray_cast_packets.h"

#define STRATUS_PREINTEGRATED 0
#define STRATUS_RAY_MODE STRATUS_RAY_SLICE
#define STRATUS_TYPE -1
#define RAY_NAME(x) JOIN(x, slice)
#include "ray_cast_tile.h"

stratus_ray_cast_tile* STRATUS_ISA_NAME(stratus_ray_slice_tile)(int type)
{
  (void)type;
  return tile_slice;
}
