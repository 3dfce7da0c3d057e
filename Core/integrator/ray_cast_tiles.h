/* SPDX-License-Identifier: BSD-3-Clause
 * The tile functions of rays that composite by a lattice. They do so little else for a sample that a call to read it takes 2 to 5 per cent
 * of a frame, so there is one for each common type of values, and one that reads all others by ray_reading.h. The including file defines
 * STRATUS_RAY_SET, the kind's name, and STRATUS_PREINTEGRATED. Defines the table tiles_NAME, indexed by stratus_type + 1. */
#define STRATUS_TYPE -2
#define RAY_NAME(x) JOIN(x, JOIN(STRATUS_RAY_SET, any))
#include "ray_cast_tile.h"
#define STRATUS_TYPE 1
#define RAY_NAME(x) JOIN(x, JOIN(STRATUS_RAY_SET, uint8))
#include "ray_cast_tile.h"
#define STRATUS_TYPE 2
#define RAY_NAME(x) JOIN(x, JOIN(STRATUS_RAY_SET, int16))
#include "ray_cast_tile.h"
#define STRATUS_TYPE 3
#define RAY_NAME(x) JOIN(x, JOIN(STRATUS_RAY_SET, uint16))
#include "ray_cast_tile.h"
#define STRATUS_TYPE 8
#define RAY_NAME(x) JOIN(x, JOIN(STRATUS_RAY_SET, float32))
#include "ray_cast_tile.h"

#define TILE_OF(type) JOIN(tile, JOIN(STRATUS_RAY_SET, type))
static stratus_ray_cast_tile* const JOIN(tiles, STRATUS_RAY_SET)[11] = { TILE_OF(any), TILE_OF(any), TILE_OF(uint8), TILE_OF(int16),
  TILE_OF(uint16), TILE_OF(any), TILE_OF(any), TILE_OF(any), TILE_OF(any), TILE_OF(float32), TILE_OF(any) };

#undef TILE_OF
#undef STRATUS_RAY_SET
