/* SPDX-License-Identifier: BSD-3-Clause
 * Quantities of the field along rays, compiled for one instruction set, STRATUS_ISA. */
#include "ray_cast_packets.h"

#define STRATUS_PREINTEGRATED 0
#define STRATUS_RAY_MODE STRATUS_RAY_QUANTITIES
#define STRATUS_RAY_SET quantities
#include "ray_cast_tiles.h"

stratus_ray_cast_tile* STRATUS_ISA_NAME(stratus_ray_quantities_tile)(int type)
{
  return tiles_quantities[type + 1];
}
