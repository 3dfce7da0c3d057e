/* SPDX-License-Identifier: BSD-3-Clause
 * What the makers of sets of effective voxels share: the object from a mask a brick. */
#ifndef STRATUS_VOXELS_BUILD_H
#define STRATUS_VOXELS_BUILD_H

#include "voxels.h"

/* ---- voxels.c */

/* An empty set with its dimensions checked: 1..2^18 along each axis. */
stratus_status stratus_voxels_create_empty(stratus_context* context, const int64_t dimensions[3], stratus_voxels** voxels);
/* Bricks, count and bounds from one mask for each of bricks_along[0]*[1]*[2] bricks, x fastest. */
stratus_status stratus_voxels_take_masks(stratus_voxels* voxels, const uint64_t* masks);
/* Counts of each brick, count and bounds from bricks that have their places and masks. */
void stratus_voxels_measure(stratus_voxels* voxels);

#endif
