/* SPDX-License-Identifier: BSD-3-Clause
 * A set of effective voxels, from which trees are built: bricks of 4^3 voxels with one bit each. Only bricks that hold a voxel are
 * stored. */
#ifndef STRATUS_VOXELS_H
#define STRATUS_VOXELS_H

#include "stratus/voxels.h"
#include "criterion.h"
#include "volume.h"

#define STRATUS_AXIS_MAX (1 << 18) /* voxels along an axis: brick coordinates fit 16 bits */

/* Bit (z*4 + y)*4 + x of mask is voxel (4*at[0] + x, 4*at[1] + y, 4*at[2] + z). Host and device share the layout. */
typedef struct stratus_brick {
  uint64_t mask;
  uint16_t at[3];
  uint16_t count; /* number of bits in mask, 1..64 */
} stratus_brick;

struct stratus_voxels {
  stratus_context* context;
  int64_t dimensions[3];
  int64_t bricks_along[3];
  int64_t count; /* number of voxels */
  int64_t brick_count;
  stratus_brick* bricks; /* in ascending order of (at[2], at[1], at[0]) */
  int64_t lo[3], hi[3];  /* tight box of the voxels */
  double index_to_world[16];
  stratus_origin origin;
};

/* ---- voxels.c */

/* Mask of brick (i,j,k), found by bisection; 0 if there is no such brick. */
uint64_t stratus_voxels_mask(const stratus_voxels* voxels, int64_t i, int64_t j, int64_t k);

/* ---- voxel_walk.c */

#define STRATUS_RAY_SHORTEST 1e-290 /* least length, in voxels, of a direction's longest component */

/* True if a ray can be followed among voxels. All methods of first hits ask this function, so that they agree. */
bool stratus_ray_usable(const double to_voxels[16], const stratus_ray* ray);
/* Reports why a ray cannot be followed. */
stratus_status stratus_ray_refuse(stratus_context* context, const double to_voxels[16], const stratus_ray* ray, size_t index);

#endif
