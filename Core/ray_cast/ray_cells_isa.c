/* SPDX-License-Identifier: BSD-3-Clause
 * Composite rays, cell by cell, compiled for one instruction set, STRATUS_ISA. */
#include "ray_cast_packets.h"

#define STRATUS_PREINTEGRATED 0
#define STRATUS_RAY_MODE STRATUS_RAY_CELLS
#define STRATUS_RAY_SET cells
#include "ray_cast_tiles.h"

stratus_ray_cast_tile* STRATUS_ISA_NAME(stratus_ray_cells_tile)(int type)
{
  return tiles_cells[type + 1];
}
