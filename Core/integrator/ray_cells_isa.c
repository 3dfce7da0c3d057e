/* SPDX-License-Identifier: BSD-3-Clause
 * Composite rays, cell by cell, compiled for one instruction set, STRATUS_ISA. */
#include "ray_cast_packets.h"
#include "ray_reading.h"

#define STRATUS_PREINTEGRATED 0
#define STRATUS_RAY_MODE STRATUS_RAY_CELLS
#define STRATUS_TYPE -2
#define RAY_NAME(x) JOIN(x, cells)
#define RAY_TILE_NAME stratus_ray_cells_tile
#include "ray_cast_tile.h"
