/* SPDX-License-Identifier: BSD-3-Clause
 * The intervals of values that a criterion shows, and the origin of a structure, which decides what the structure may replace. */
#ifndef STRATUS_CRITERION_H
#define STRATUS_CRITERION_H

#include "volume.h"

#define STRATUS_BRICK 4 /* side of a brick of voxels, and of the blocks of cells that an origin is computed over */
#define STRATUS_INTERVALS_MAX 64

/* Where a set of voxels comes from. This decides what a tree of it may replace. */
typedef struct stratus_origin {
  uint64_t hash; /* hash of values, type, dimensions and hidden parts; 0: made from a list, which no tree covers */
  int32_t cells; /* 1: made by stratus_voxels_create_cells() */
  /* Number of intervals of values that show. If they are more than the maximum, cells merge them across their narrowest gaps, and the
   * merged intervals then choose the cells. Voxels replace them by a single one from INFINITY to -INFINITY, so that no tree covers
   * another's. */
  int32_t intervals;
  double interval[STRATUS_INTERVALS_MAX][2]; /* ascending, disjoint, ends included */
} stratus_origin;

stratus_status stratus_criterion_check(stratus_context* context, const stratus_criterion* criterion);
/* Finds the values that the criterion shows, exactly. The caller releases intervals->of. */
stratus_status stratus_intervals_create(stratus_context* context, const stratus_criterion* criterion, stratus_intervals* intervals);
/* Keeps the intervals of a criterion on voxels. If they do not fit, one interval from INFINITY to -INFINITY, which equals no other
 * origin's, replaces them. */
void stratus_origin_take(stratus_origin* origin, const stratus_intervals* intervals);
/* Keeps those intervals of a criterion on cells that meet the ranges' values. An end beyond these values becomes infinite. */
stratus_status stratus_origin_take_cells(
  stratus_context* context, const stratus_value_range* ranges, const stratus_criterion* criterion, stratus_origin* origin);

/* Finds the intervals of values that a criterion shows. cells: reads the whole volume, whose values decide which intervals count. */
stratus_status stratus_criterion_intervals(
  stratus_context* context, const stratus_volume* volume, const stratus_criterion* criterion, int cells, stratus_origin* origin);
/* Returns 1 if a structure made for `tree` may replace one made for `wanted`: both have the same use and hash, and the intervals cover. For
 * cells the wanted intervals are within the tree's. For voxels both have the same intervals, since a voxel too many would be hit. */
int stratus_origin_covers(const stratus_origin* tree, const stratus_origin* wanted);

#endif
