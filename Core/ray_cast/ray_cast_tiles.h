/* SPDX-License-Identifier: BSD-3-Clause
 * The tile functions of one kind of march: one for each type of values that has its own fetch, and a generic one for all others. The
 * including file defines STRATUS_RAY_SET, the kind's name, STRATUS_PREINTEGRATED and, unless rays composite, STRATUS_RAY_MODE. Defines the
 * table tiles_NAME, indexed by stratus_type + 1. Only rays that composite by a lattice have fetches for int8 and float64. */
#define STRATUS_TYPE -1
#define RAY_NAME(x) JOIN(x, JOIN(STRATUS_RAY_SET, any))
#include "ray_cast_tile.h"
#ifndef STRATUS_RAY_MODE
#define STRATUS_TYPE 0
#define RAY_NAME(x) JOIN(x, JOIN(STRATUS_RAY_SET, int8))
#include "ray_cast_tile.h"
#endif
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
#ifndef STRATUS_RAY_MODE
#define STRATUS_TYPE 9
#define RAY_NAME(x) JOIN(x, JOIN(STRATUS_RAY_SET, float64))
#include "ray_cast_tile.h"
#endif

#define TILE_OF(type) JOIN(tile, JOIN(STRATUS_RAY_SET, type))
static stratus_ray_cast_tile* const JOIN(tiles, STRATUS_RAY_SET)[11] = { TILE_OF(any),
#ifndef STRATUS_RAY_MODE
  TILE_OF(int8),
#else
  TILE_OF(any),
#endif
  TILE_OF(uint8), TILE_OF(int16), TILE_OF(uint16), TILE_OF(any), TILE_OF(any), TILE_OF(any), TILE_OF(any), TILE_OF(float32),
#ifndef STRATUS_RAY_MODE
  TILE_OF(float64)
#else
  TILE_OF(any)
#endif
};

#undef TILE_OF
#undef STRATUS_RAY_SET
