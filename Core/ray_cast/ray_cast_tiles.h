/* SPDX-License-Identifier: BSD-3-Clause
 * The tile functions of rays that composite by a lattice: one for each type of values that has its own fetch, and a generic one for all
 * others. The including file defines STRATUS_RAY_SET, the kind's name, and STRATUS_PREINTEGRATED. Defines the table tiles_NAME, indexed by
 * stratus_type + 1. */
#define STRATUS_TYPE -1
#define RAY_NAME(x) JOIN(x, JOIN(STRATUS_RAY_SET, any))
#include "ray_cast_tile.h"
#define STRATUS_TYPE 0
#define RAY_NAME(x) JOIN(x, JOIN(STRATUS_RAY_SET, int8))
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
#define STRATUS_TYPE 9
#define RAY_NAME(x) JOIN(x, JOIN(STRATUS_RAY_SET, float64))
#include "ray_cast_tile.h"

#define TILE_OF(type) JOIN(tile, JOIN(STRATUS_RAY_SET, type))
static stratus_ray_cast_tile* const JOIN(tiles, STRATUS_RAY_SET)[11] = { TILE_OF(any), TILE_OF(int8), TILE_OF(uint8), TILE_OF(int16),
  TILE_OF(uint16), TILE_OF(any), TILE_OF(any), TILE_OF(any), TILE_OF(any), TILE_OF(float32), TILE_OF(float64) };

#undef TILE_OF
#undef STRATUS_RAY_SET
