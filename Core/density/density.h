/* SPDX-License-Identifier: BSD-3-Clause
 * The density of effective voxels, by which the hybrid tree splits its nodes: bandwidth, density, peaks and borders, and clusters on a
 * line. */
#ifndef STRATUS_DENSITY_H
#define STRATUS_DENSITY_H

#include "voxels.h"

/* ---- density.c: the density of the voxels in a set of bricks. It has the same bits at any thread count, and on host and device. */
typedef struct stratus_density {
  stratus_context* context;
  double bandwidth;
  /* 1: of[] holds one density for each voxel (bricks in order, bits ascending). 0: one for each brick, at the brick's middle. */
  int exact;
  int64_t count; /* of bricks */
  float* of;
  int64_t* start; /* exact: of[start[b]] is the first voxel of brick b; brick_count + 1 entries. NULL if not exact. */
} stratus_density;

/* Computes the density. bricks: `count` bricks, any subset of a set's bricks in its order, such as a node's. bandwidth > 0. */
stratus_status stratus_density_create(
  stratus_context* context, const stratus_brick* bricks, int64_t count, double bandwidth, int exact, stratus_density** density);
void stratus_density_destroy(stratus_density* density);
/* Computes the bandwidth by eq. 3 and 4, as stratus_density_bandwidth() does. */
stratus_status stratus_density_bandwidth_of(
  stratus_context* context, const stratus_brick* bricks, int64_t count, double* bandwidth, double* raw);
/* Finds the densest effective voxel. The candidates are bricks which[0..count-1] (NULL: all `count`) of those that the density was made of.
 * Ties go to the first voxel in (z, y, x). A density that is not exact gives the densest brick's voxel nearest to the brick's middle, with
 * the same rule for ties. */
void stratus_density_peak(
  const stratus_density* density, const stratus_brick* bricks, const uint32_t* which, int64_t count, int32_t peak[3]);
/* The steepest falls of density along each axis through the peak, on both sides. A fall is the first sign change of the second derivative
 * (eq. 11; sampled at voxel borders from the peak outward, within [lo, hi)). `fall` is the magnitude of the first derivative there, and 0
 * where there is no such place. position[axis][side] is a plane between voxels position-1 and position. Sums are over the node's bricks. */
typedef struct stratus_density_borders {
  int32_t position[3][2];
  double fall[3][2];
} stratus_density_borders;
/* The sums from which the derivatives at a plane on a line through the peak are made. They are over the voxels within the bandwidth of the
 * plane's point. D is twice the offset along the line, q the squared distance across it. All are whole numbers. */
typedef struct stratus_density_line {
  double count;       /* voxels */
  double curvature;   /* sum of 3 D^2 + 4 q */
  double slope;       /* sum of D */
  double slope_cubic; /* sum of D (D^2 + 4 q) */
} stratus_density_line;

/* Return the index of the first plane of `axis` among the lines of a box: planes lo[0]..hi[0], then the planes of y and z. axis 3: their
 * number. */
size_t stratus_density_line_start(const int32_t lo[3], const int32_t hi[3], int axis);
/* Returns whether the sums take a brick's voxels as one mass at its middle. */
bool stratus_density_takes_whole_bricks(double bandwidth, int exact);
/* Fills the sums of all planes of the three lines. */
void stratus_density_sum_lines(const stratus_brick* bricks, const uint32_t* which, int64_t count, double bandwidth, int exact,
  const int32_t peak[3], const int32_t lo[3], const int32_t hi[3], stratus_density_line* lines);
/* Finds the borders from the sums. voxels: the number of voxels that the sums were made of. */
void stratus_density_scan_lines(stratus_density_line* lines, int64_t voxels, double bandwidth, const int32_t peak[3], const int32_t lo[3],
  const int32_t hi[3], stratus_density_borders* borders);

/* ---- dbscan.c: one-dimensional DBSCAN of coordinates given as counts: counts[i] voxels have coordinate i, 0 <= i < n. A coordinate with
 * at least min_points voxels within eps >= 1 coordinates is a core. Finds the cluster [*lo, *hi) that holds coordinate `peak`, and the
 * number of clusters, *clusters. Returns the cluster's number of cores, 0 if the peak is noise. */
int32_t stratus_dbscan_counts(
  const int64_t* counts, int32_t n, int32_t eps, int64_t min_points, int32_t peak, int32_t* lo, int32_t* hi, int32_t* clusters);

#endif
