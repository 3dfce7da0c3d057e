/* SPDX-License-Identifier: BSD-3-Clause
 * Sums of weights for bandwidths that reach over many bricks. Points are sorted into cells no smaller than the bandwidth, so that a point's
 * neighbours are in 27 cells, three to a row.
 *
 * If the density is exact, a point is a voxel. Over bricks, the bricks of a bin are one point in the bin's middle, weighted by their
 * voxels. A bin's edge is a quarter to an eighth of the bandwidth. Each of its bricks gets the density at the bin's middle, at most .87
 * edges from its own. Each voxel in reach then errs by at most min(1, 1.54 * .87 * edge / bandwidth). The unit is a voxel's contribution at
 * its own position. */
#include "density_plan.h"

#include <stdlib.h>

#define SLICES 64 /* steps between which the caller may cancel, since the work can be quadratic voxel by voxel */

/* A point in doubled coordinates, which are integers even for a bin's middle between voxels. */
typedef struct density_point {
  uint64_t key; /* of the cell: z, y, x, 20 bits each, plus 1 */
  int64_t number;
  uint64_t weight;
  uint64_t sum;
  int32_t at[3];
} density_point;

static density_point make_point(int32_t x, int32_t y, int32_t z, int64_t number, uint64_t weight, int shift)
{
  const uint64_t key = (uint64_t)((z >> shift) + 1) << 40 | (uint64_t)((y >> shift) + 1) << 20 | (uint64_t)((x >> shift) + 1);
  return (density_point){ key, number, weight, 0, { x, y, z } };
}

static void make_voxels(const stratus_brick* bricks, int64_t count, int shift, density_point* points)
{
  int64_t number = 0;
  for (int64_t b = 0; b < count; ++b) {
    for (uint64_t bits = bricks[b].mask; bits; bits &= bits - 1) {
      const int bit = __builtin_ctzll(bits);
      points[number] = make_point(8 * bricks[b].at[0] + 2 * (bit & 3), 8 * bricks[b].at[1] + 2 * (bit >> 2 & 3),
        8 * bricks[b].at[2] + 2 * (bit >> 4), number, 1, shift);
      ++number;
    }
  }
}

static void make_bins(const stratus_brick* bricks, int64_t count, int shift, double bandwidth, density_point* points)
{
  int32_t edge = STRATUS_BRICK;
  while (8.0 * edge <= bandwidth && edge < STRATUS_AXIS_MAX) {
    edge *= 2;
  }
  for (int64_t b = 0; b < count; ++b) {
    int32_t middle[3];
    for (int a = 0; a < 3; ++a) {
      middle[a] = 2 * (STRATUS_BRICK * bricks[b].at[a] / edge * edge) + edge - 1;
    }
    points[b] = make_point(middle[0], middle[1], middle[2], b, bricks[b].count, shift);
  }
}

static int compare_points(const void* left, const void* right)
{
  const density_point *a = left, *b = right;
  if (a->key != b->key) {
    return a->key < b->key ? -1 : 1;
  }
  for (int axis = 2; axis >= 0; --axis) {
    if (a->at[axis] != b->at[axis]) {
      return a->at[axis] < b->at[axis] ? -1 : 1;
    }
  }
  return a->number < b->number ? -1 : a->number > b->number;
}

/* Merges points at the same place. which[number] becomes the index of the merged point. Returns the number of points that remain. */
static int64_t merge_points(density_point* points, int64_t count, uint64_t* which)
{
  int64_t merged = 0;
  for (int64_t i = 0; i < count; ++i) {
    density_point* last = points + merged - 1;
    if (merged && last->key == points[i].key && last->at[0] == points[i].at[0] && last->at[1] == points[i].at[1] &&
      last->at[2] == points[i].at[2]) {
      last->weight += points[i].weight;
    } else {
      points[merged++] = points[i];
    }
    which[points[i].number] = (uint64_t)merged - 1;
  }
  return merged;
}

static int64_t first_point(const density_point* points, int64_t count, uint64_t key)
{
  int64_t low = 0;
  while (low < count) {
    const int64_t middle = low + (count - low) / 2;
    if (points[middle].key < key) {
      low = middle + 1;
    } else {
      count = middle;
    }
  }
  return low;
}

/* Finds the points in reach of a cell: nine rows of up to three cells, each a range [first, end) of points. */
static void find_ranges(const density_point* points, int64_t count, uint64_t key, int64_t ranges[9][2])
{
  const uint64_t z = (uint64_t)1 << 40, y = (uint64_t)1 << 20;
  for (uint64_t row = 0; row < 9; ++row) {
    const uint64_t first = key - z - y - 1 + row / 3 * z + row % 3 * y;
    ranges[row][0] = first_point(points, count, first);
    ranges[row][1] = ranges[row][0] + first_point(points + ranges[row][0], count - ranges[row][0], first + 3);
  }
}

static uint64_t sum_point(const density_point* points, const density_point* point, int64_t ranges[9][2], double bandwidth)
{
  uint64_t sum = 0;
  for (int row = 0; row < 9; ++row) {
    for (int64_t i = ranges[row][0]; i < ranges[row][1]; ++i) {
      const double x = points[i].at[0] - point->at[0], y = points[i].at[1] - point->at[1], z = points[i].at[2] - point->at[2];
      sum += points[i].weight * density_weight(0.25 * (x * x + y * y + z * z), bandwidth);
    }
  }
  return sum;
}

static stratus_status sum_points(stratus_context* context, density_point* points, int64_t count, double bandwidth)
{
  for (int slice = 0; slice < SLICES; ++slice) {
    TRY(stratus_progress(context, "density", (double)slice / SLICES));
#pragma omp parallel for schedule(dynamic, 16) num_threads(context->threads) if (count >= DENSITY_PARALLEL)
    for (int64_t i = count * slice / SLICES; i < count * (slice + 1) / SLICES; ++i) {
      int64_t ranges[9][2];
      find_ranges(points, count, points[i].key, ranges);
      points[i].sum = sum_point(points, points + i, ranges, bandwidth);
    }
  }
  return STRATUS_OK;
}

stratus_status stratus_density_cells(
  stratus_context* context, const stratus_brick* bricks, int64_t count, double bandwidth, int exact, const int64_t* start, uint64_t* sums)
{
  const int64_t values = exact ? start[count] : count;
  void* memory;
  int shift = 1; /* cells of 2^shift doubled coordinates, at most as large as the grid */
  while (shift < 20 && (double)(1 << shift) < 2.0 * bandwidth) {
    ++shift;
  }
  TRY(stratus_allocate(context, (size_t)values, sizeof(density_point), &memory));
  density_point* points = memory;
  if (exact) {
    make_voxels(bricks, count, shift, points);
  } else {
    make_bins(bricks, count, shift, bandwidth, points);
  }
  qsort(points, (size_t)values, sizeof *points, compare_points);
  const stratus_status status = sum_points(context, points, merge_points(points, values, sums), bandwidth);
  for (int64_t i = 0; i < values; ++i) {
    sums[i] = points[sums[i]].sum;
  }
  stratus_release(context, points);
  return status;
}
