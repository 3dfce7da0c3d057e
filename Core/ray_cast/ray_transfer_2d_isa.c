/* SPDX-License-Identifier: BSD-3-Clause
 * Composite rays by a function of two variables, compiled for one instruction set, STRATUS_ISA. */
#include "ray_cast_packets.h"

#define STRATUS_PREINTEGRATED 0
#define STRATUS_RAY_MODE STRATUS_RAY_TRANSFER_2D
#define STRATUS_RAY_SET transfer_2d
#include "ray_cast_tiles.h"

stratus_ray_cast_tile* STRATUS_ISA_NAME(stratus_ray_transfer_2d_tile)(int type)
{
  return tiles_transfer_2d[type + 1];
}
