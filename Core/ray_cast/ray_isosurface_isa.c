/* SPDX-License-Identifier: BSD-3-Clause
 * Isosurfaces, compiled for one instruction set, STRATUS_ISA. */
#include "ray_cast_packets.h"

#define STRATUS_PREINTEGRATED 0
#define STRATUS_RAY_MODE STRATUS_RAY_ISOSURFACE
#define STRATUS_RAY_SET isosurface
#include "ray_cast_tiles.h"

stratus_ray_cast_tile* STRATUS_ISA_NAME(stratus_ray_isosurface_tile)(int type)
{
  return tiles_isosurface[type + 1];
}
