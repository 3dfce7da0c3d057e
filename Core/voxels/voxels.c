/* SPDX-License-Identifier: BSD-3-Clause
 * Effective voxels: the set, made from one mask for each brick, and queries of it. */
#include "voxels_build.h"

#include "matrix.h"

#include <string.h>

/* Nanoseconds of one thread for a possible brick, and for one with voxels. */
#define MASK_NS 1.0
#define BRICK_NS 3.0

/* ---------------------------------------------------------------- construction */

stratus_status stratus_voxels_create_empty(stratus_context* context, const int64_t dimensions[3], stratus_voxels** out)
{
  static const char axis[] = "xyz";
  void* memory;
  size_t bricks;
  for (int a = 0; a < 3; ++a) {
    if (dimensions[a] < 1 || dimensions[a] > STRATUS_AXIS_MAX) {
      return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "dimension along %c is %lld voxels, must be in 1..%d", axis[a],
        (long long)dimensions[a], STRATUS_AXIS_MAX);
    }
  }
  TRY(stratus_allocate_zero(context, 1, sizeof(stratus_voxels), &memory));
  stratus_voxels* voxels = memory;
  voxels->context = context;
  for (int a = 0; a < 3; ++a) {
    voxels->dimensions[a] = dimensions[a];
    voxels->bricks_along[a] = (dimensions[a] + STRATUS_BRICK - 1) / STRATUS_BRICK;
    voxels->index_to_world[5 * a] = 1.0;
  }
  voxels->index_to_world[15] = 1.0;
  const stratus_status status = stratus_product(
    context, "bricks", (size_t)voxels->bricks_along[0], (size_t)voxels->bricks_along[1], (size_t)voxels->bricks_along[2], &bricks);
  if (status != STRATUS_OK) {
    stratus_release(context, voxels);
    return status;
  }
  *out = voxels;
  return STRATUS_OK;
}

stratus_status stratus_voxels_place(stratus_voxels* voxels, const double index_to_world[16])
{
  double inverse[16];
  if (!stratus_matrix_invert_affine(index_to_world, inverse)) {
    const double* m = index_to_world;
    return stratus_fail(voxels->context, STRATUS_INVALID_ARGUMENT,
      "the voxels' matrix with the columns (%g, %g, %g), (%g, %g, %g), (%g, %g, %g), (%g, %g, %g) has no inverse within doubles", m[0],
      m[4], m[8], m[1], m[5], m[9], m[2], m[6], m[10], m[3], m[7], m[11]);
  }
  memcpy(voxels->index_to_world, index_to_world, sizeof voxels->index_to_world);
  return STRATUS_OK;
}

/* Counts the bricks that hold a voxel: start[row] is their number in all rows of masks before. */
static void count_rows(const stratus_voxels* voxels, const uint64_t* masks, int threads, int64_t* start)
{
  const int64_t n = voxels->bricks_along[0], rows = voxels->bricks_along[1] * voxels->bricks_along[2];
#pragma omp parallel for schedule(static) num_threads(threads)
  for (int64_t row = 0; row < rows; ++row) {
    const uint64_t* mask = masks + row * n;
    int64_t count = 0;
    for (int64_t i = 0; i < n; ++i) {
      count += mask[i] != 0;
    }
    start[row + 1] = count;
  }
  start[0] = 0;
  for (int64_t row = 0; row < rows; ++row) {
    start[row + 1] += start[row];
  }
}

static void write_rows(stratus_voxels* voxels, const uint64_t* masks, int threads, const int64_t* start)
{
  const int64_t n = voxels->bricks_along[0], ny = voxels->bricks_along[1], rows = ny * voxels->bricks_along[2];
#pragma omp parallel for schedule(static) num_threads(threads)
  for (int64_t row = 0; row < rows; ++row) {
    stratus_brick* brick = voxels->bricks + start[row];
    for (int64_t i = 0; i < n && brick < voxels->bricks + start[row + 1]; ++i) {
      if (masks[row * n + i]) {
        *brick++ = (stratus_brick){ .mask = masks[row * n + i], .at = { (uint16_t)i, (uint16_t)(row % ny), (uint16_t)(row / ny) } };
      }
    }
  }
}

stratus_status stratus_voxels_take_masks(stratus_voxels* voxels, const uint64_t* masks)
{
  stratus_context* context = voxels->context;
  const size_t rows = (size_t)(voxels->bricks_along[1] * voxels->bricks_along[2]);
  const int threads = stratus_threads_for(context, MASK_NS * (double)rows * (double)voxels->bricks_along[0]);
  stratus_status status;
  void *start = NULL, *bricks;
  TRY_CLEANUP(stratus_allocate(context, rows + 1, sizeof(int64_t), &start));
  count_rows(voxels, masks, threads, start);
  voxels->brick_count = ((int64_t*)start)[rows];
  TRY_CLEANUP(stratus_allocate(context, (size_t)voxels->brick_count, sizeof(stratus_brick), &bricks));
  voxels->bricks = bricks;
  write_rows(voxels, masks, threads, start);
  stratus_voxels_measure(voxels);
cleanup:
  stratus_release(context, start);
  return status;
}

/* Layers of a brick along an axis that hold any voxel, as four bits. The bits of each layer are folded onto its lowest, and these are moved
 * together. */
static unsigned layers_of(uint64_t m, int axis)
{
  if (axis == 2) {
    m |= m >> 8;
    m |= m >> 4;
    m |= m >> 2;
    m |= m >> 1;
    return (unsigned)((m & 1) | (m >> 15 & 2) | (m >> 30 & 4) | (m >> 45 & 8));
  }
  m |= m >> 32;
  m |= m >> 16;
  if (axis == 1) {
    m |= m >> 2;
    m |= m >> 1;
    return (unsigned)((m & 1) | (m >> 3 & 2) | (m >> 6 & 4) | (m >> 9 & 8));
  }
  m |= m >> 8;
  m |= m >> 4;
  return (unsigned)(m & 15);
}

/* Widens [lo, hi) by a brick. Most bricks are within it and cost only comparisons. */
static void widen(const stratus_brick* brick, int64_t lo[3], int64_t hi[3])
{
  for (int a = 0; a < 3; ++a) {
    const int64_t first = (int64_t)brick->at[a] * STRATUS_BRICK;
    if (first < lo[a] || first + STRATUS_BRICK > hi[a]) {
      const unsigned layers = layers_of(brick->mask, a);
      const int64_t low = first + __builtin_ctz(layers), high = first + 32 - __builtin_clz(layers);
      lo[a] = low < lo[a] ? low : lo[a];
      hi[a] = high > hi[a] ? high : hi[a];
    }
  }
}

void stratus_voxels_measure(stratus_voxels* voxels)
{
  int64_t count = 0, lo[3] = { INT64_MAX, INT64_MAX, INT64_MAX }, hi[3] = { 0, 0, 0 };
  const int threads = stratus_threads_for(voxels->context, BRICK_NS * (double)voxels->brick_count);
#pragma omp parallel num_threads(threads) reduction(+ : count)
  {
    int64_t low[3] = { INT64_MAX, INT64_MAX, INT64_MAX }, high[3] = { 0, 0, 0 };
#pragma omp for schedule(static) nowait
    for (int64_t b = 0; b < voxels->brick_count; ++b) {
      stratus_brick* brick = voxels->bricks + b;
      brick->count = (uint16_t)__builtin_popcountll(brick->mask);
      count += brick->count;
      widen(brick, low, high);
    }
#pragma omp critical(stratus_voxels_measure)
    for (int a = 0; a < 3; ++a) {
      lo[a] = low[a] < lo[a] ? low[a] : lo[a];
      hi[a] = high[a] > hi[a] ? high[a] : hi[a];
    }
  }
  voxels->count = count;
  for (int a = 0; a < 3; ++a) {
    voxels->lo[a] = count ? lo[a] : 0;
    voxels->hi[a] = count ? hi[a] : 0;
  }
}

void stratus_voxels_end_stage(const stratus_voxels* voxels, const stratus_stage* stage)
{
  stratus_stage_end(voxels->context, stage, "effective voxels", (size_t)voxels->brick_count * sizeof *voxels->bricks);
}

/* ---------------------------------------------------------------- queries */

void stratus_voxels_destroy(stratus_voxels* voxels)
{
  if (voxels) {
    stratus_context* context = voxels->context;
    stratus_release(context, voxels->bricks);
    stratus_release(context, voxels);
  }
}

int64_t stratus_voxels_count(const stratus_voxels* voxels)
{
  return voxels ? voxels->count : 0;
}

void stratus_voxels_dimensions(const stratus_voxels* voxels, int64_t dimensions[3])
{
  for (int a = 0; dimensions && a < 3; ++a) {
    dimensions[a] = voxels ? voxels->dimensions[a] : 0;
  }
}

void stratus_voxels_bounds(const stratus_voxels* voxels, int64_t lo[3], int64_t hi[3])
{
  for (int a = 0; a < 3; ++a) {
    if (lo) {
      lo[a] = voxels ? voxels->lo[a] : 0;
    }
    if (hi) {
      hi[a] = voxels ? voxels->hi[a] : 0;
    }
  }
}

uint64_t stratus_voxels_mask(const stratus_voxels* voxels, int64_t i, int64_t j, int64_t k)
{
  const uint64_t wanted = (uint64_t)k << 32 | (uint64_t)j << 16 | (uint64_t)i;
  const stratus_brick* bricks = voxels->bricks;
  int64_t from = 0, to = voxels->brick_count;
  while (from < to) {
    const int64_t middle = from + (to - from) / 2;
    const uint16_t* at = bricks[middle].at;
    if (((uint64_t)at[2] << 32 | (uint64_t)at[1] << 16 | at[0]) < wanted) {
      from = middle + 1;
    } else {
      to = middle;
    }
  }
  const bool found = from < voxels->brick_count && bricks[from].at[0] == i && bricks[from].at[1] == j && bricks[from].at[2] == k;
  return found ? bricks[from].mask : 0;
}

int stratus_voxels_get(const stratus_voxels* voxels, int64_t i, int64_t j, int64_t k)
{
  if (!voxels) {
    return 0;
  }
  const int64_t* n = voxels->dimensions;
  if (i < 0 || j < 0 || k < 0 || i >= n[0] || j >= n[1] || k >= n[2]) {
    return 0;
  }
  return (int)(stratus_voxels_mask(voxels, i / 4, j / 4, k / 4) >> ((k % 4 * 4 + j % 4) * 4 + i % 4) & 1);
}
