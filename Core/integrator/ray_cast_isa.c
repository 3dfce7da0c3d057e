/* SPDX-License-Identifier: BSD-3-Clause
 * Composite rays, compiled for one instruction set, STRATUS_ISA, under both sampling rules. */
#include "ray_cast_packets.h"
#include "ray_reading.h"

#define STRATUS_PREINTEGRATED 0
#define STRATUS_RAY_SET mid
#include "ray_cast_tiles.h"
#undef STRATUS_PREINTEGRATED

#define STRATUS_PREINTEGRATED 1
#define STRATUS_RAY_SET pre
#include "ray_cast_tiles.h"

stratus_ray_cast_tile* STRATUS_ISA_NAME(stratus_ray_cast_tile)(int type, stratus_ray_variant variant)
{
  return (variant == STRATUS_VARIANT_PREINTEGRATED ? tiles_pre : tiles_mid)[type + 1];
}
