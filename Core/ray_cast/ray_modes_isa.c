/* SPDX-License-Identifier: BSD-3-Clause
 * Maxima, minima and sums along rays, compiled for one instruction set, STRATUS_ISA. Types without a fetch of their own use the generic
 * one, until ray_fetched.c copies their values as floats. */
#include "ray_cast_packets.h"

#define STRATUS_PREINTEGRATED 0

#define STRATUS_RAY_MODE STRATUS_RAY_EXTREMES
#define STRATUS_TYPE -1
#define RAY_NAME(x) JOIN(x, extremes_any)
#include "ray_cast_tile.h"
#define STRATUS_TYPE 1
#define RAY_NAME(x) JOIN(x, extremes_uint8)
#include "ray_cast_tile.h"
#define STRATUS_TYPE 2
#define RAY_NAME(x) JOIN(x, extremes_int16)
#include "ray_cast_tile.h"
#define STRATUS_TYPE 3
#define RAY_NAME(x) JOIN(x, extremes_uint16)
#include "ray_cast_tile.h"
#define STRATUS_TYPE 8
#define RAY_NAME(x) JOIN(x, extremes_float32)
#include "ray_cast_tile.h"
#undef STRATUS_RAY_MODE

#define STRATUS_RAY_MODE STRATUS_RAY_SUMS
#define STRATUS_TYPE -1
#define RAY_NAME(x) JOIN(x, sums_any)
#include "ray_cast_tile.h"
#define STRATUS_TYPE 1
#define RAY_NAME(x) JOIN(x, sums_uint8)
#include "ray_cast_tile.h"
#define STRATUS_TYPE 2
#define RAY_NAME(x) JOIN(x, sums_int16)
#include "ray_cast_tile.h"
#define STRATUS_TYPE 3
#define RAY_NAME(x) JOIN(x, sums_uint16)
#include "ray_cast_tile.h"
#define STRATUS_TYPE 8
#define RAY_NAME(x) JOIN(x, sums_float32)
#include "ray_cast_tile.h"
#undef STRATUS_RAY_MODE

stratus_ray_cast_tile* STRATUS_ISA_NAME(stratus_ray_modes_tile)(int type, stratus_ray_variant variant)
{
  static stratus_ray_cast_tile* const tiles[2][11] = {
    { tile_extremes_any, tile_extremes_any, tile_extremes_uint8, tile_extremes_int16, tile_extremes_uint16, tile_extremes_any,
      tile_extremes_any, tile_extremes_any, tile_extremes_any, tile_extremes_float32, tile_extremes_any },
    { tile_sums_any, tile_sums_any, tile_sums_uint8, tile_sums_int16, tile_sums_uint16, tile_sums_any, tile_sums_any, tile_sums_any,
      tile_sums_any, tile_sums_float32, tile_sums_any },
  };
  return variant == STRATUS_VARIANT_ISOSURFACE ? STRATUS_ISA_NAME(stratus_ray_isosurface_tile)(type)
    : variant == STRATUS_VARIANT_CELLS         ? STRATUS_ISA_NAME(stratus_ray_cells_tile)(type)
    : variant == STRATUS_VARIANT_LOCAL         ? STRATUS_ISA_NAME(stratus_ray_local_tile)(type)
                                               : tiles[variant == STRATUS_VARIANT_SUMS][type + 1];
}
