/* SPDX-License-Identifier: BSD-3-Clause
 * Composite rays, compiled for one instruction set, STRATUS_ISA: all fast types and the generic one, under both sampling rules. */
#include "ray_cast_packets.h"

#define STRATUS_PREINTEGRATED 0
#define STRATUS_TYPE -1
#define RAY_NAME(x) JOIN(x, mid_any)
#include "ray_cast_tile.h"
#define STRATUS_TYPE 0
#define RAY_NAME(x) JOIN(x, mid_int8)
#include "ray_cast_tile.h"
#define STRATUS_TYPE 1
#define RAY_NAME(x) JOIN(x, mid_uint8)
#include "ray_cast_tile.h"
#define STRATUS_TYPE 2
#define RAY_NAME(x) JOIN(x, mid_int16)
#include "ray_cast_tile.h"
#define STRATUS_TYPE 3
#define RAY_NAME(x) JOIN(x, mid_uint16)
#include "ray_cast_tile.h"
#define STRATUS_TYPE 8
#define RAY_NAME(x) JOIN(x, mid_float32)
#include "ray_cast_tile.h"
#define STRATUS_TYPE 9
#define RAY_NAME(x) JOIN(x, mid_float64)
#include "ray_cast_tile.h"
#undef STRATUS_PREINTEGRATED

#define STRATUS_PREINTEGRATED 1
#define STRATUS_TYPE -1
#define RAY_NAME(x) JOIN(x, pre_any)
#include "ray_cast_tile.h"
#define STRATUS_TYPE 0
#define RAY_NAME(x) JOIN(x, pre_int8)
#include "ray_cast_tile.h"
#define STRATUS_TYPE 1
#define RAY_NAME(x) JOIN(x, pre_uint8)
#include "ray_cast_tile.h"
#define STRATUS_TYPE 2
#define RAY_NAME(x) JOIN(x, pre_int16)
#include "ray_cast_tile.h"
#define STRATUS_TYPE 3
#define RAY_NAME(x) JOIN(x, pre_uint16)
#include "ray_cast_tile.h"
#define STRATUS_TYPE 8
#define RAY_NAME(x) JOIN(x, pre_float32)
#include "ray_cast_tile.h"
#define STRATUS_TYPE 9
#define RAY_NAME(x) JOIN(x, pre_float64)
#include "ray_cast_tile.h"

stratus_ray_cast_tile* STRATUS_ISA_NAME(stratus_ray_cast_tile)(int type, stratus_ray_variant variant)
{
  static stratus_ray_cast_tile* const tiles[2][11] = {
    { tile_mid_any, tile_mid_int8, tile_mid_uint8, tile_mid_int16, tile_mid_uint16, tile_mid_any, tile_mid_any, tile_mid_any, tile_mid_any,
      tile_mid_float32, tile_mid_float64 },
    { tile_pre_any, tile_pre_int8, tile_pre_uint8, tile_pre_int16, tile_pre_uint16, tile_pre_any, tile_pre_any, tile_pre_any, tile_pre_any,
      tile_pre_float32, tile_pre_float64 },
  };
  return tiles[variant == STRATUS_VARIANT_PREINTEGRATED][type + 1];
}
