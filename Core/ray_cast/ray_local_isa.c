/* SPDX-License-Identifier: BSD-3-Clause
 * Composite rays, cell by cell in rough blocks, compiled for one instruction set, STRATUS_ISA. */
#include "ray_cast_packets.h"

#define STRATUS_PREINTEGRATED 0
#define STRATUS_RAY_MODE STRATUS_RAY_LOCAL
#define STRATUS_RAY_SET local
#include "ray_cast_tiles.h"

stratus_ray_cast_tile* STRATUS_ISA_NAME(stratus_ray_local_tile)(int type)
{
  return tiles_local[type + 1];
}
