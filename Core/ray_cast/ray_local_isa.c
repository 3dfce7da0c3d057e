/* SPDX-License-Identifier: BSD-3-Clause
 * Composite rays, cell by cell in rough blocks, compiled for one instruction set, STRATUS_ISA. Types without a fetch of their own use the
 * generic one, until ray_fetched.c copies their values as floats. */
#include "ray_cast_packets.h"

#define STRATUS_PREINTEGRATED 0
#define STRATUS_RAY_MODE STRATUS_RAY_LOCAL

#define STRATUS_TYPE -1
#define RAY_NAME(x) JOIN(x, local_any)
#include "ray_cast_tile.h"
#define STRATUS_TYPE 1
#define RAY_NAME(x) JOIN(x, local_uint8)
#include "ray_cast_tile.h"
#define STRATUS_TYPE 2
#define RAY_NAME(x) JOIN(x, local_int16)
#include "ray_cast_tile.h"
#define STRATUS_TYPE 3
#define RAY_NAME(x) JOIN(x, local_uint16)
#include "ray_cast_tile.h"
#define STRATUS_TYPE 8
#define RAY_NAME(x) JOIN(x, local_float32)
#include "ray_cast_tile.h"

stratus_ray_cast_tile* STRATUS_ISA_NAME(stratus_ray_local_tile)(int type)
{
  static stratus_ray_cast_tile* const tiles[11] = { tile_local_any, tile_local_any, tile_local_uint8, tile_local_int16, tile_local_uint16,
    tile_local_any, tile_local_any, tile_local_any, tile_local_any, tile_local_float32, tile_local_any };
  return tiles[type + 1];
}
