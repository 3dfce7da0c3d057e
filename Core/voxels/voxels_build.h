/* SPDX-License-Identifier: BSD-3-Clause
 * What the makers of sets of effective voxels share: the object from a mask a brick, and rows of values to ask or to hash. */
#ifndef STRATUS_VOXELS_BUILD_H
#define STRATUS_VOXELS_BUILD_H

#include "voxels.h"

/* Values that show: ascending, disjoint, ends included, none that holds no double. */
typedef struct stratus_intervals {
  int64_t count;
  double (*of)[2];
} stratus_intervals;

/* ---- voxels.c */

/* An empty set with its dimensions checked: 1..2^18 along each axis. */
stratus_status stratus_voxels_create_empty(stratus_context* context, const int64_t dimensions[3], stratus_voxels** voxels);
/* Bricks, count and bounds from one mask for each of bricks_along[0]*[1]*[2] bricks, x fastest. */
stratus_status stratus_voxels_take_masks(stratus_voxels* voxels, const uint64_t* masks);
/* Counts of each brick, count and bounds from bricks that have their places and masks. */
void stratus_voxels_measure(stratus_voxels* voxels);

/* ---- criterion.c */
stratus_status stratus_criterion_check(stratus_context* context, const stratus_criterion* criterion);
/* The values that the criterion shows, exactly; intervals->of is the caller's to release. */
stratus_status stratus_intervals_create(stratus_context* context, const stratus_criterion* criterion, stratus_intervals* intervals);
/* Keeps the intervals of a criterion on voxels; if there are more than fit, one that is equal to nobody's. */
void stratus_origin_take(stratus_origin* origin, const stratus_intervals* intervals);
/* The same for cells: what either sampling's table shows over the ranges' values, rounded outward; of a criterion without transfer
 * function, itself. An end beyond the ranges' values is infinite. */
stratus_status stratus_origin_take_cells(
  stratus_context* context, const stratus_value_range* ranges, const stratus_criterion* criterion, stratus_origin* origin);

/* ---- volume_hash.c */

/* Row (j, k) of the values, contiguous: in place, or gathered into `room` of dimensions[0] values where they are strided. */
const void* stratus_volume_row(const stratus_volume* volume, int64_t j, int64_t k, void* room);
/* A volume's hash is the sum of its rows' (in any order) and of its shape's. `row` as from stratus_volume_row(). */
uint64_t stratus_volume_hash_row(const stratus_volume* volume, int64_t j, int64_t k, const void* row);
uint64_t stratus_volume_hash_shape(const stratus_volume* volume);

#endif
