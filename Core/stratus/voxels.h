/* SPDX-License-Identifier: BSD-3-Clause
 * Effective voxels, the rays that hit them, and their density. */
#ifndef STRATUS_PUBLIC_VOXELS_H
#define STRATUS_PUBLIC_VOXELS_H

#include "volume.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Effective voxels are the voxels that a criterion makes visible (Guo et al. 2025, section 3). Voxel (i,j,k) is the cube of edge 1 about
 * (i,j,k) in index coordinates. A set has at most 2^18 voxels along an axis. */

typedef struct stratus_voxels stratus_voxels;

/* Create the set of finite values that meet the criterion, without values that are hidden or that another piece owns. Cell flags count if
 * the volume is cell_centered. A volume with coordinates gives STRATUS_UNSUPPORTED, because voxels have equal spacing. */
STRATUS_API stratus_status stratus_voxels_create(
  stratus_context* context, const stratus_volume* volume, const stratus_criterion* criterion, stratus_voxels** voxels);
/* Create the set for ray casts: every voxel of the 4^3 blocks of cells whose value range shows anything. The ranges are the ones of
 * stratus_value_range; a criterion without transfer function is rounded outward. Structure HYBRID can use a tree of this set. Voxel (i,j,k)
 * is cell (i,j,k), between the values at (i,j,k) and (i+1,j+1,k+1). Brick b (4^3 voxels) is block b. The dimensions are 4 times the ranges'
 * blocks. For a volume with coordinates, index coordinates replace world coordinates. */
STRATUS_API stratus_status stratus_voxels_create_cells(
  stratus_context* context, const stratus_volume* volume, const stratus_criterion* criterion, stratus_voxels** voxels);
/* Create a set from `count` triples i, j, k, each in 0..dimensions-1; a repeated triple counts once. Index (i,j,k) is world (i+.5, j+.5,
 * k+.5), so that the voxel fills [i,i+1] x [j,j+1] x [k,k+1]. A triple beyond the dimensions gives STRATUS_INVALID_ARGUMENT. */
STRATUS_API stratus_status stratus_voxels_create_list(
  stratus_context* context, const int64_t dimensions[3], const int32_t* positions, size_t count, stratus_voxels** voxels);
STRATUS_API void stratus_voxels_destroy(stratus_voxels* voxels);
/* Return the number of effective voxels. */
STRATUS_EXPERIMENTAL int64_t stratus_voxels_count(const stratus_voxels* voxels);
STRATUS_EXPERIMENTAL void stratus_voxels_dimensions(const stratus_voxels* voxels, int64_t dimensions[3]);
/* Return 1 if the voxel is effective, otherwise 0. */
STRATUS_EXPERIMENTAL int stratus_voxels_get(const stratus_voxels* voxels, int64_t i, int64_t j, int64_t k); /* 0 beyond the dimensions */
/* Get the tight box of the effective voxels, [lo, hi); lo = hi = 0 if there are none. */
STRATUS_EXPERIMENTAL void stratus_voxels_bounds(const stratus_voxels* voxels, int64_t lo[3], int64_t hi[3]);

typedef struct stratus_ray {
  /* A ray: origin + t direction for t_min <= t <= t_max. */
  double origin[3];    /* world coordinates */
  double direction[3]; /* world coordinates, any length > 0 (its longest component is at least 1e-290 voxels) */
  double t_min, t_max; /* t_max may be INFINITY */
} stratus_ray;

typedef struct stratus_hit {
  double t;         /* t where the ray enters the voxel, t_min if it begins inside; INFINITY if it hits nothing */
  int32_t voxel[3]; /* -1 each if the ray hits nothing */
  /* The voxel's face through which the ray enters: 2*axis, plus 1 for the upper face of that axis. -1 if the ray begins inside or hits
   * nothing. */
  int32_t face;
  /* World coordinates, length 1: the outward normal of that face. If the ray begins inside, the reverse of its direction. */
  float normal[3];
  uint32_t visited; /* number of nodes visited, plus steps in distance fields; of a beam, the ray's share */
} stratus_hit;

/* Find the first effective voxel along each of `count` rays, by a plain walk from voxel to voxel in double precision on one thread. The
 * walk is slow: it is the reference for stratus_tree_first_hit(). A ray with a number that is not finite (except t_max), or without a
 * direction, gives STRATUS_INVALID_ARGUMENT. */
STRATUS_EXPERIMENTAL stratus_status stratus_voxels_first_hit(
  stratus_context* context, const stratus_voxels* voxels, const stratus_ray* rays, size_t count, stratus_hit* hits);

/* Kernel density of effective voxels (Guo et al. 2025, eq. 2 to 5) with the quartic kernel. Its constant in three dimensions is 105 / (32
 * pi), which makes the kernel integrate to 1. Lengths are in voxels, between voxel centres. */

/* Compute the bandwidth in voxels by eq. 3 and 4, but never below 1: the radii of a shell hardly deviate, and below 1 each voxel sees only
 * itself. Fewer than two voxels give 1. raw, may be NULL: the bandwidth as printed, without the lower bound. */
STRATUS_EXPERIMENTAL stratus_status stratus_density_bandwidth(
  stratus_context* context, const stratus_voxels* voxels, double* bandwidth, double* raw);
/* Compute the density at a point in index coordinates, with its first (eq. 10) and second (eq. 11) partial derivatives. bandwidth: in
 * voxels, > 0. first and second may be NULL. */
STRATUS_EXPERIMENTAL stratus_status stratus_density_at(stratus_context* context, const stratus_voxels* voxels, double bandwidth,
  const double point[3], double* density, double first[3], double second[3]);

#ifdef __cplusplus
}
#endif

#endif
