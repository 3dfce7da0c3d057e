/* SPDX-License-Identifier: BSD-3-Clause
 * First hits among voxels whose widths change from one to the next, as in a rectilinear grid. */
#ifndef STRATUS_FIRST_HIT_STRETCHED_RAYS_H
#define STRATUS_FIRST_HIT_STRETCHED_RAYS_H

#include "tree.h"
#include "voxels.h"

/* Find the first effective voxel of each ray, as stratus_voxels_first_hit_between() does. Only `voxel` and `visited` of the hits are set.
 * The tree is one field of bricks (methods OCTANT and DISTANCE), and its matrices are for the mean spacing. Runs on the context's device if
 * that has doubles. */
stratus_status stratus_tree_first_voxels_between(stratus_context* context, const stratus_tree* tree, const stratus_voxel_borders* borders,
  const stratus_ray* rays, size_t count, stratus_hit* hits);

#endif
