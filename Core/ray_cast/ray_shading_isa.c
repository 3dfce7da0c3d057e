/* SPDX-License-Identifier: BSD-3-Clause
 * Shaded rays (samples lit, gradient-thinned, multi-component or labelled), compiled for one instruction set, STRATUS_ISA. */
#include "ray_cast_packets.h"

#define STRATUS_RAY_MODE STRATUS_RAY_SHADING

#define STRATUS_PREINTEGRATED 0
#define STRATUS_RAY_SET shading
#include "ray_cast_tiles.h"
#undef STRATUS_PREINTEGRATED

#define STRATUS_PREINTEGRATED 1
#define STRATUS_RAY_SET shading_pre
#include "ray_cast_tiles.h"

stratus_ray_cast_tile* STRATUS_ISA_NAME(stratus_ray_shading_tile)(int type, stratus_ray_variant variant)
{
  return (variant == STRATUS_VARIANT_SHADING_PREINTEGRATED ? tiles_shading_pre : tiles_shading)[type + 1];
}
