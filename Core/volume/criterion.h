/* SPDX-License-Identifier: BSD-3-Clause
 * Which values a criterion shows, and what a structure was made from. */
#ifndef STRATUS_CRITERION_H
#define STRATUS_CRITERION_H

#include "volume.h"

/* Values that show: ascending, disjoint, ends included, none that holds no double. */
typedef struct stratus_intervals {
  int64_t count;
  double (*of)[2];
} stratus_intervals;

#define STRATUS_BRICK 4 /* side of a brick of voxels, and of the blocks of cells that an origin is measured over */
#define STRATUS_INTERVALS_MAX 64

/* What a tree may stand in for. */
typedef struct stratus_origin {
  uint64_t hash;     /* of values, type, dimensions and hidden parts; 0: a list, which nothing covers */
  int32_t cells;     /* 1: of stratus_voxels_create_cells() */
  int32_t intervals; /* of values that show. More than the maximum: of cells, merged across their narrowest gaps (and cells
                      * chosen by that); of voxels, a single one from INFINITY to -INFINITY, so that no tree covers another's. */
  double interval[STRATUS_INTERVALS_MAX][2]; /* ascending, disjoint, ends included */
} stratus_origin;

stratus_status stratus_criterion_check(stratus_context* context, const stratus_criterion* criterion);
/* The values that the criterion shows, exactly; intervals->of is the caller's to release. */
stratus_status stratus_intervals_create(stratus_context* context, const stratus_criterion* criterion, stratus_intervals* intervals);
/* Keeps the intervals of a criterion on voxels; if there are more than fit, one that is equal to nobody's. */
void stratus_origin_take(stratus_origin* origin, const stratus_intervals* intervals);
/* The same for cells: what either sampling's table shows over the ranges' values, rounded outward; of a criterion without transfer
 * function, itself. An end beyond the ranges' values is infinite. */
stratus_status stratus_origin_take_cells(
  stratus_context* context, const stratus_value_range* ranges, const stratus_criterion* criterion, stratus_origin* origin);

/* The intervals of values that a criterion shows. cells: reads the whole volume, for the tables span its values. */
stratus_status stratus_criterion_intervals(
  stratus_context* context, const stratus_volume* volume, const stratus_criterion* criterion, int cells, stratus_origin* origin);
/* 1 if what was made for `tree` may stand in for what would be made for `wanted`: the same use and hash, and for cells intervals that lie
 * within the tree's, for voxels the very same ones, since a voxel too many would be hit. */
int stratus_origin_covers(const stratus_origin* tree, const stratus_origin* wanted);

#endif
