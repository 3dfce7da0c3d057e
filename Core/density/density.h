/* SPDX-License-Identifier: BSD-3-Clause
 * Interface of the methods that sum a density over bricks: weights in fixed point, and the search for neighbouring bricks.
 *
 * A weight of the kernel is rounded once, to 28 bits behind the point, and sums of weights are integers. Any order of summation, any number
 * of threads and any device therefore give the same bits. For each voxel in reach, rounding changes a density by at most 2^-29 of what one
 * voxel adds at its own place. */
#ifndef STRATUS_DENSITY_H
#define STRATUS_DENSITY_H

#include "voxels.h"

/* ---- density.c: the field that the hybrid tree splits by. Deterministic: the same bits at any thread count and on host and device. */
typedef struct stratus_density {
  stratus_context* context;
  double bandwidth;
  int exact; /* 1: of[] has a density a voxel (bricks in order, bits ascending); 0: a density a brick, at the brick's middle */
  float* of;
  int64_t* start; /* exact: of[start[b]] is the first voxel of brick b; brick_count + 1 entries. NULL if not exact. */
} stratus_density;

/* bricks: count of them, any subset of a set's, in its order (a node's). bandwidth > 0. */
stratus_status stratus_density_create(
  stratus_context* context, const stratus_brick* bricks, int64_t count, double bandwidth, int exact, stratus_density** density);
void stratus_density_destroy(stratus_density* density);
stratus_status stratus_density_bandwidth_of(
  stratus_context* context, const stratus_brick* bricks, int64_t count, double* bandwidth, double* raw);
/* The densest effective voxel among the bricks numbered which[0..count-1] (NULL: all `count`) of those the density was made of; ties go to
 * the first in (z, y, x). Not exact: the densest brick's voxel nearest to its middle, ties the same. */
void stratus_density_peak(
  const stratus_density* density, const stratus_brick* bricks, const uint32_t* which, int64_t count, int32_t peak[3]);
/* Where density falls most steeply along each axis through the peak: for every axis and both sides, the first change of sign of the second
 * derivative (eq. 11; sampled at voxel borders from the peak outward, within [lo, hi)), and the first derivative's size there.
 * position[axis][side] in voxels (a plane between voxels position-1 and position), fall = 0 where there is none. Sums over the node's
 * bricks. */
typedef struct stratus_density_borders {
  int32_t position[3][2];
  double fall[3][2];
} stratus_density_borders;
stratus_status stratus_density_find_borders(stratus_context* context, const stratus_brick* bricks, const uint32_t* which, int64_t count,
  double bandwidth, int exact, const int32_t peak[3], const int32_t lo[3], const int32_t hi[3], stratus_density_borders* borders);

/* ---- dbscan.c: 1-D DBSCAN of coordinates given as counts: counts[i] voxels have coordinate i, 0 <= i < n; reach eps >= 1 in coordinates,
 * min_points. Finds the cluster that holds coordinate `peak`: [*lo, *hi); returns its number of core coordinates, 0 if the peak is noise.
 * *clusters: how many. */
int32_t stratus_dbscan_counts(
  const int64_t* counts, int32_t n, int32_t eps, int64_t min_points, int32_t peak, int32_t* lo, int32_t* hi, int32_t* clusters);

#endif
