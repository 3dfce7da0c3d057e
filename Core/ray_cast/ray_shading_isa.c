/* SPDX-License-Identifier: BSD-3-Clause
 * Shaded rays (samples lit, gradient-thinned, multi-component or labelled), compiled for one instruction set, STRATUS_ISA. Types without a
 * fetch of their own use the generic one, until ray_fetched.c copies their values as floats. */
#include "ray_cast_packets.h"

#define STRATUS_RAY_MODE STRATUS_RAY_SHADING

#define STRATUS_PREINTEGRATED 0
#define STRATUS_TYPE -1
#define RAY_NAME(x) JOIN(x, shading_any)
#include "ray_cast_tile.h"
#define STRATUS_TYPE 1
#define RAY_NAME(x) JOIN(x, shading_uint8)
#include "ray_cast_tile.h"
#define STRATUS_TYPE 2
#define RAY_NAME(x) JOIN(x, shading_int16)
#include "ray_cast_tile.h"
#define STRATUS_TYPE 3
#define RAY_NAME(x) JOIN(x, shading_uint16)
#include "ray_cast_tile.h"
#define STRATUS_TYPE 8
#define RAY_NAME(x) JOIN(x, shading_float32)
#include "ray_cast_tile.h"
#undef STRATUS_PREINTEGRATED

#define STRATUS_PREINTEGRATED 1
#define STRATUS_TYPE -1
#define RAY_NAME(x) JOIN(x, shading_pre_any)
#include "ray_cast_tile.h"
#define STRATUS_TYPE 1
#define RAY_NAME(x) JOIN(x, shading_pre_uint8)
#include "ray_cast_tile.h"
#define STRATUS_TYPE 2
#define RAY_NAME(x) JOIN(x, shading_pre_int16)
#include "ray_cast_tile.h"
#define STRATUS_TYPE 3
#define RAY_NAME(x) JOIN(x, shading_pre_uint16)
#include "ray_cast_tile.h"
#define STRATUS_TYPE 8
#define RAY_NAME(x) JOIN(x, shading_pre_float32)
#include "ray_cast_tile.h"

stratus_ray_cast_tile* STRATUS_ISA_NAME(stratus_ray_shading_tile)(int type, stratus_ray_variant variant)
{
  static stratus_ray_cast_tile* const tiles[2][11] = {
    { tile_shading_any, tile_shading_any, tile_shading_uint8, tile_shading_int16, tile_shading_uint16, tile_shading_any, tile_shading_any,
      tile_shading_any, tile_shading_any, tile_shading_float32, tile_shading_any },
    { tile_shading_pre_any, tile_shading_pre_any, tile_shading_pre_uint8, tile_shading_pre_int16, tile_shading_pre_uint16,
      tile_shading_pre_any, tile_shading_pre_any, tile_shading_pre_any, tile_shading_pre_any, tile_shading_pre_float32,
      tile_shading_pre_any },
  };
  return tiles[variant == STRATUS_VARIANT_SHADING_PREINTEGRATED][type + 1];
}
