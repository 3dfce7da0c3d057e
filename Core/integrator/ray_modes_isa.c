/* SPDX-License-Identifier: BSD-3-Clause
 * Maxima, minima and sums along rays, compiled for one instruction set, STRATUS_ISA. */
#include "ray_cast_packets.h"
#include "ray_reading.h"

#define STRATUS_PREINTEGRATED 0
#define STRATUS_RAY_MODE STRATUS_RAY_EXTREMES
#define STRATUS_TYPE -2
#define RAY_NAME(x) JOIN(x, extremes)
#define RAY_TILE_NAME stratus_ray_extremes_tile
#include "ray_cast_tile.h"
#undef RAY_TILE_NAME
#undef STRATUS_RAY_MODE
#undef STRATUS_PREINTEGRATED

#define STRATUS_PREINTEGRATED 0
#define STRATUS_RAY_MODE STRATUS_RAY_SUMS
#define STRATUS_TYPE -2
#define RAY_NAME(x) JOIN(x, sums)
#define RAY_TILE_NAME stratus_ray_sums_tile
#include "ray_cast_tile.h"
