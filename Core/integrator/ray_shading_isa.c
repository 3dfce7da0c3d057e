/* SPDX-License-Identifier: BSD-3-Clause
 * Shaded rays (samples lit, gradient-thinned, multi-component or labelled), compiled for one instruction set, STRATUS_ISA. */
#include "ray_cast_packets.h"
#include "ray_reading.h"

#define STRATUS_PREINTEGRATED 0
#define STRATUS_RAY_MODE STRATUS_RAY_SHADING
#define STRATUS_TYPE -2
#define RAY_NAME(x) JOIN(x, shading)
#define RAY_TILE_NAME stratus_ray_shading_tile
#include "ray_cast_tile.h"
#undef RAY_TILE_NAME
#undef STRATUS_RAY_MODE
#undef STRATUS_PREINTEGRATED

#define STRATUS_PREINTEGRATED 1
#define STRATUS_RAY_MODE STRATUS_RAY_SHADING
#define STRATUS_TYPE -2
#define RAY_NAME(x) JOIN(x, shading_pre)
#define RAY_TILE_NAME stratus_ray_shading_pre_tile
#include "ray_cast_tile.h"
