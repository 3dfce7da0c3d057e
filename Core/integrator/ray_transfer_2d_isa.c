/* SPDX-License-Identifier: BSD-3-Clause
 * Composite rays by a function of two variables, compiled for one instruction set, STRATUS_ISA. */
#include "ray_cast_packets.h"
#include "ray_reading.h"

#define STRATUS_PREINTEGRATED 0
#define STRATUS_RAY_MODE STRATUS_RAY_TRANSFER_2D
#define STRATUS_TYPE -2
#define RAY_NAME(x) JOIN(x, transfer_2d)
#define RAY_TILE_NAME stratus_ray_transfer_2d_tile
#include "ray_cast_tile.h"
