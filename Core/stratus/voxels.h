/* SPDX-License-Identifier: BSD-3-Clause
 * Effective voxels, rays among them, and the densities of them. */
#ifndef STRATUS_PUBLIC_VOXELS_H
#define STRATUS_PUBLIC_VOXELS_H

#include "volume.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The voxels that a criterion makes visible (Guo et al. 2025, section 3). Voxel (i,j,k) is the cube of edge 1 about (i,j,k) in index
 * coordinates. At most 2^18 voxels along an axis. */

typedef struct stratus_voxels stratus_voxels;

/* Finite values that meet the criterion, but none that is hidden or owned by another piece (cell flags count where cell_centered). */
STRATUS_API stratus_status stratus_voxels_create(
  stratus_context* context, const stratus_volume* volume, const stratus_criterion* criterion, stratus_voxels** voxels);
/* For ray casting: every voxel of the 4^3 blocks of cells whose value range shows anything (a block's ranges as stratus_value_range has
 * them; what a criterion without transfer function tells is rounded outward). A tree of it may serve structure HYBRID. Voxel (i,j,k) is
 * cell (i,j,k), between the values of that place and the next; brick (a 4^3 of voxels) b is block b; dimensions: 4 times the ranges'
 * blocks. */
STRATUS_API stratus_status stratus_voxels_create_cells(
  stratus_context* context, const stratus_volume* volume, const stratus_criterion* criterion, stratus_voxels** voxels);
/* `count` triples of i, j, k, each in 0..dimensions-1; one that comes twice counts once. Index (i,j,k) is world (i+.5, j+.5, k+.5): the
 * voxel fills [i,i+1] and so on. */
STRATUS_API stratus_status stratus_voxels_create_list(
  stratus_context* context, const int64_t dimensions[3], const int32_t* positions, size_t count, stratus_voxels** voxels);
STRATUS_API void stratus_voxels_destroy(stratus_voxels* voxels);
STRATUS_EXPERIMENTAL int64_t stratus_voxels_count(const stratus_voxels* voxels);
STRATUS_EXPERIMENTAL void stratus_voxels_dimensions(const stratus_voxels* voxels, int64_t dimensions[3]);
STRATUS_EXPERIMENTAL int stratus_voxels_get(const stratus_voxels* voxels, int64_t i, int64_t j, int64_t k); /* 0 beyond the dimensions */
/* Tight box [lo, hi) in voxels; lo = hi = 0 if there is none. */
STRATUS_EXPERIMENTAL void stratus_voxels_bounds(const stratus_voxels* voxels, int64_t lo[3], int64_t hi[3]);

typedef struct stratus_ray {
  double origin[3];    /* world */
  double direction[3]; /* world, any length > 0 (longest component at least 1e-290 voxels) */
  double t_min, t_max; /* origin + t direction, t_min <= t <= t_max; t_max may be INFINITY */
} stratus_ray;

typedef struct stratus_hit {
  double t;         /* where the ray enters the voxel, t_min if it begins inside; INFINITY: no hit */
  int32_t voxel[3]; /* -1: no hit */
  int32_t face; /* 2*axis + (1 if it is the upper one) of the voxel's face that the ray enters by; -1 where it begins inside, or no hit */
  float normal[3];  /* outward, world, of that face (of length 1); begun inside: against the direction */
  uint32_t visited; /* nodes and steps in distance fields */
} stratus_hit;

/* The first effective voxel along each of `count` rays, by a plain walk from voxel to voxel in double precision, one thread: slow, and the
 * measure of stratus_tree_first_hit(). */
STRATUS_EXPERIMENTAL stratus_status stratus_voxels_first_hit(
  stratus_context* context, const stratus_voxels* voxels, const stratus_ray* rays, size_t count, stratus_hit* hits);

/* Kernel density of effective voxels (eq. 2 to 5) with the quartic kernel, whose constant in three dimensions is 105 / (32 pi) for
 * densities a voxel to add up to 1. Lengths are voxels, at voxel centres. */

/* Bandwidth by eq. 3 and 4, never below 1 voxel (a shell's deviation of radii is next to nothing, and below 1 a voxel sees only itself);
 * 1 for fewer than two voxels. `raw`, may be NULL: as printed, unbounded below. */
STRATUS_EXPERIMENTAL stratus_status stratus_density_bandwidth(
  stratus_context* context, const stratus_voxels* voxels, double* bandwidth, double* raw);
/* Density at a point in index coordinates, with its first (eq. 10) and second (eq. 11) partial derivatives. first, second: may be NULL. */
STRATUS_EXPERIMENTAL stratus_status stratus_density_at(stratus_context* context, const stratus_voxels* voxels, double bandwidth,
  const double point[3], double* density, double first[3], double second[3]);

#ifdef __cplusplus
}
#endif

#endif
