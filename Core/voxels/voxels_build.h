/* SPDX-License-Identifier: BSD-3-Clause
 * Interface that the builders of sets of effective voxels share: the set from one mask for each brick, and rows of values to test or to
 * hash. */
#ifndef STRATUS_VOXELS_BUILD_H
#define STRATUS_VOXELS_BUILD_H

#include "threads.h"
#include "voxels.h"

/* ---- voxels.c */

/* Creates an empty set. It checks the dimensions: 1..2^18 along each axis. */
stratus_status stratus_voxels_create_empty(stratus_context* context, const int64_t dimensions[3], stratus_voxels** voxels);
/* Sets bricks, count and bounds from one mask for each of bricks_along[0]*[1]*[2] bricks, x fastest. */
stratus_status stratus_voxels_take_masks(stratus_voxels* voxels, const uint64_t* masks);
/* Sets each brick's count, and the total count and bounds, from bricks that have their places and masks. */
void stratus_voxels_measure(stratus_voxels* voxels);
/* Ends the stage that made the set. */
void stratus_voxels_end_stage(const stratus_voxels* voxels, const stratus_stage* stage);

#endif
