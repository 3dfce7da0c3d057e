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

/* Where voxels begin along each axis whose spacing changes, in voxel coordinates of the mean spacing: voxel i fills at[i] .. at[i + 1]. The
 * borders rise strictly, from number -1 to STRATUS_BORDERS_BEYOND(voxels). NULL: voxel i fills i .. i + 1. */
typedef struct stratus_voxel_borders {
  const double* at[3];
} stratus_voxel_borders;

/* Number of the last border along an axis of n voxels: bricks reach beyond the voxels. */
#define STRATUS_BORDERS_BEYOND(n) (((n) + STRATUS_BRICK - 1) / STRATUS_BRICK * STRATUS_BRICK + 1)

static inline double stratus_voxel_border(const stratus_voxel_borders* borders, int axis, int64_t voxel)
{
  return borders && borders->at[axis] ? borders->at[axis][voxel] : (double)voxel;
}

/* ---- voxels.c */

/* Mask of brick (i,j,k), found by bisection; 0 if there is no such brick. */
uint64_t stratus_voxels_mask(const stratus_voxels* voxels, int64_t i, int64_t j, int64_t k);

/* ---- voxel_walk.c */

#define STRATUS_RAY_SHORTEST 1e-290 /* least length, in voxels, of a direction's longest component */

/* True if a ray can be followed among voxels. All methods of first hits ask this function, so that they agree. */
bool stratus_ray_usable(const double to_voxels[16], const stratus_ray* ray);
/* stratus_voxels_first_hit() among voxels of these borders; borders may be NULL. */
stratus_status stratus_voxels_first_hit_between(stratus_context* context, const stratus_voxels* voxels,
  const stratus_voxel_borders* borders, const stratus_ray* rays, size_t count, stratus_hit* hits);
/* Reports why a ray cannot be followed. */
stratus_status stratus_ray_refuse(stratus_context* context, const double to_voxels[16], const stratus_ray* ray, size_t index);

#endif
