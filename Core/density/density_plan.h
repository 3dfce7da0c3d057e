/* SPDX-License-Identifier: BSD-3-Clause
 * Interface of the methods that sum a density over bricks: weights in fixed point, and the search for neighbouring bricks.
 *
 * A weight of the kernel is rounded once, to 28 bits behind the point, and sums of weights are integers. Any order of summation, any number
 * of threads and any device therefore give the same bits. For each voxel in reach, rounding changes a density by at most 2^-29 of a voxel's
 * contribution at its own position. */
#ifndef STRATUS_DENSITY_PLAN_H
#define STRATUS_DENSITY_PLAN_H

#include "density.h"

#define DENSITY_POINT 28    /* bits behind the point; the sum of fifteen weights fits 32 bits */
#define DENSITY_REACH_MAX 7 /* bricks on each side; a row of voxels across them fits 64 bits */
#define DENSITY_SIDE_MAX (STRATUS_BRICK * (2 * DENSITY_REACH_MAX + 1))
#define DENSITY_PARALLEL 2048 /* fewer bricks are not worth a team of threads */

/* 105 / (32 pi): the integral of (1 - t^2)^2 over the unit ball becomes 1. */
#define DENSITY_CONSTANT 1.0444543140405631

/* A row of voxels in reach of a voxel. `offset` is relative to the voxel's own row among the rows gathered around a brick. `table` is the
 * index where the row's sums begin. */
typedef struct density_row {
  int32_t offset;
  int32_t table;
} density_row;

/* Precomputed sums of weights. Exact: a row's window of 2*radius + 1 bits is looked up in `chunks` pieces of `width` bits, at
 * table[row.table + (piece << width) + bits]. Over bricks: table[(|dz|*(reach+1) + |dy|)*(reach+1) + |dx|] is the mean weight of a brick's
 * 64 positions, seen from a brick's middle. */
typedef struct density_plan {
  stratus_context* context;
  double bandwidth;
  int exact;
  int radius; /* greatest whole number of voxels below the bandwidth */
  int reach;  /* bricks on each side */
  int width, chunks;
  int row_count;
  size_t table_size;
  density_row* rows;
  uint32_t* table;
} density_plan;

/* True if the bricks in reach are few enough for a plan. Otherwise stratus_density_cells() computes the sums. */
bool stratus_density_plan_fits(double bandwidth, int exact);
stratus_status stratus_density_plan_create(stratus_context* context, double bandwidth, int exact, density_plan* plan);
void stratus_density_plan_release(density_plan* plan);

/* Both functions fill sums[] in fixed point. Exact: one sum for each voxel, where start[b] is the first voxel of brick b. Otherwise: one
 * for each brick. */
stratus_status stratus_density_rows(
  const density_plan* plan, const stratus_brick* bricks, int64_t count, const int64_t* start, uint64_t* sums); /* density_rows.c */
stratus_status stratus_density_cells(stratus_context* context, const stratus_brick* bricks, int64_t count, double bandwidth, int exact,
  const int64_t* start, uint64_t* sums); /* density_cells.c */
/* ---- density_device.c: gives the same bits on the context's OpenCL device */
bool stratus_device_takes_density(const stratus_context* context, const density_plan* plan, int64_t count, int64_t voxels);
stratus_status stratus_device_density(
  stratus_context* context, const density_plan* plan, const stratus_brick* bricks, int64_t count, const int64_t* start, uint64_t* sums);

/* Returns the kernel's weight (1 - t^2)^2 in fixed point at a squared distance; 0 from the bandwidth on. */
static inline uint64_t density_weight(double squared, double bandwidth)
{
  const double rest = 1.0 - squared / (bandwidth * bandwidth);
  return rest > 0.0 ? (uint64_t)(rest * rest * (double)(1u << DENSITY_POINT) + 0.5) : 0;
}

/* Returns the key of a brick's position, which may lie up to DENSITY_REACH_MAX + 1 bricks outside the grid. Keys rise in the order of
 * bricks. */
static inline uint64_t density_key(int64_t x, int64_t y, int64_t z)
{
  return (uint64_t)(z + 8) << 40 | (uint64_t)(y + 8) << 20 | (uint64_t)(x + 8);
}

static inline uint64_t density_brick_key(const stratus_brick* brick)
{
  return density_key(brick->at[0], brick->at[1], brick->at[2]);
}

/* Returns the index of the first brick whose key is not below `key`. The bricks are in ascending order. */
static inline int64_t density_first_brick(const stratus_brick* bricks, int64_t count, uint64_t key)
{
  int64_t low = 0;
  while (low < count) {
    const int64_t middle = low + (count - low) / 2;
    if (density_brick_key(bricks + middle) < key) {
      low = middle + 1;
    } else {
      count = middle;
    }
  }
  return low;
}

#endif
