/* SPDX-License-Identifier: BSD-3-Clause
 * Lit composite rays, cell by cell everywhere or in rough blocks, compiled for one instruction set, STRATUS_ISA. */
#define RAY_LIT 1
#include "ray_cast_packets.h"
#include "ray_reading.h"

#define STRATUS_PREINTEGRATED 0
#define STRATUS_RAY_MODE STRATUS_RAY_LOCAL
#define STRATUS_TYPE -2
#define RAY_NAME(x) JOIN(x, lit)
#define RAY_TILE_NAME stratus_ray_lit_tile
#include "ray_cast_tile.h"
