/* SPDX-License-Identifier: BSD-3-Clause
 * Least and greatest value of each block of cells, including the halo that interpolation reads. */
#include "look_sample.h"
#include "value_range_kept.h"
#include "value_range_reduce.h"
#include "volume.h"
#include "volume_kept.h"
#include "volume_device.h"

#include <string.h>

#define BLOCK_SIZE_DEFAULT 4
#define BLOCK_SIZE_MOST 32
/* Eight octant maps of a byte a block. With value ranges, blocks then take at most half a GiB, which leaves a volume that is larger than
 * memory most of it; and traversal addresses the maps with one int. */
#define MAP_BYTES_MOST 0x1p28
#define LANES 16

/* Finds the blocks, at most two along each axis, that hold `at`. shared (cell_centered): `at` is a value, and one on the border of two
 * blocks belongs to both. */
static int touched(int64_t at, int64_t size, int64_t blocks, int shared, int64_t first[2])
{
  int count = 0;
  if (at / size < blocks) {
    first[count++] = at / size;
  }
  if (shared && at % size == 0 && at > 0) {
    first[count++] = at / size - 1;
  }
  return count;
}

static void flag_hidden(const stratus_volume* volume, const uint8_t* hidden, stratus_value_range* ranges)
{
  int64_t n[3];
  for (int a = 0; a < 3; ++a) {
    n[a] = volume->cell_centered || volume->dimensions[a] == 1 ? volume->dimensions[a] : volume->dimensions[a] - 1;
  }
  const int64_t *blocks = ranges->blocks, size = ranges->block_size;
  for (int64_t k = 0; k < n[2]; ++k) {
    for (int64_t j = 0; j < n[1]; ++j) {
      for (int64_t i = 0; i < n[0]; ++i) {
        if (!hidden[(k * n[1] + j) * n[0] + i]) {
          continue;
        }
        int64_t bx[2], by[2], bz[2];
        const int nx = touched(i, size, blocks[0], volume->cell_centered, bx);
        const int ny = touched(j, size, blocks[1], volume->cell_centered, by);
        const int nz = touched(k, size, blocks[2], volume->cell_centered, bz);
        for (int c = 0; c < nx * ny * nz; ++c) {
          ranges->gaps[(bz[c / (nx * ny)] * blocks[1] + by[c / nx % ny]) * blocks[0] + bx[c % nx]] = 1;
        }
      }
    }
  }
}

/* Keeps independent extremes in lanes: a single running minimum would wait for itself. */
static void widen_lanes(const float* restrict lo, const float* restrict hi, float* restrict least, float* restrict most)
{
  for (int lane = 0; lane < LANES; ++lane) {
    least[lane] = lo[lane] < least[lane] ? lo[lane] : least[lane];
    most[lane] = hi[lane] > most[lane] ? hi[lane] : most[lane];
  }
}

/* Reduces the ranges of all blocks. A block without values holds INFINITY and -INFINITY, which never win. */
static void reduce_whole(stratus_context* context, stratus_value_range* ranges)
{
  const int64_t count = ranges->blocks[0] * ranges->blocks[1] * ranges->blocks[2], groups = count / LANES;
  float lo = INFINITY, hi = -INFINITY;
#pragma omp parallel num_threads(context->threads) reduction(min : lo) reduction(max : hi)
  {
    float least[LANES], most[LANES];
    lo = INFINITY; /* the reduction itself may start at FLT_MAX, which is a value */
    hi = -INFINITY;
    for (int lane = 0; lane < LANES; ++lane) {
      least[lane] = INFINITY;
      most[lane] = -INFINITY;
    }
#pragma omp for schedule(static)
    for (int64_t g = 0; g < groups; ++g) {
      widen_lanes(ranges->lo + g * LANES, ranges->hi + g * LANES, least, most);
    }
    for (int lane = 0; lane < LANES; ++lane) {
      lo = least[lane] < lo ? least[lane] : lo;
      hi = most[lane] > hi ? most[lane] : hi;
    }
  }
  for (int64_t b = groups * LANES; b < count; ++b) {
    lo = ranges->lo[b] < lo ? ranges->lo[b] : lo;
    hi = ranges->hi[b] > hi ? ranges->hi[b] : hi;
  }
  ranges->whole_lo = lo;
  ranges->whole_hi = hi;
}

int stratus_value_range_block_size(const stratus_volume* volume, int wanted)
{
  int size = wanted ? wanted : BLOCK_SIZE_DEFAULT;
  while (size < BLOCK_SIZE_MOST) {
    double bytes = 8.0;
    for (int axis = 0; axis < 3; ++axis) {
      bytes *= ceil((double)volume->dimensions[axis] / size + (axis == 0 ? 64.0 : 0.0));
    }
    if (bytes < MAP_BYTES_MOST) {
      break;
    }
    size *= 2;
  }
  return size;
}

static stratus_status check_block_size(stratus_context* context, int block_size)
{
  if (block_size < 2 || block_size > 32 || (block_size & (block_size - 1)) != 0) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "block_size %d, must be 2, 4, 8, 16 or 32, or 0 for the default", block_size);
  }
  return STRATUS_OK;
}

static stratus_status allocate_blocks(stratus_context* context, const stratus_volume* volume, stratus_value_range* ranges)
{
  int64_t cells[3];
  size_t count;
  void* memory;
  stratus_volume_cells(volume, cells);
  for (int a = 0; a < 3; ++a) {
    ranges->blocks[a] = cells[a] ? (cells[a] + ranges->block_size - 1) / ranges->block_size : 1;
  }
  TRY(stratus_product(context, "blocks", (size_t)ranges->blocks[0], (size_t)ranges->blocks[1], (size_t)ranges->blocks[2], &count));
  TRY(stratus_allocate(context, count, sizeof *ranges->lo, &memory));
  ranges->lo = memory;
  TRY(stratus_allocate(context, count, sizeof *ranges->hi, &memory));
  ranges->hi = memory;
  TRY(stratus_allocate(context, count, sizeof *ranges->gaps, &memory));
  ranges->gaps = memory;
  return STRATUS_OK;
}

static stratus_status reduce(stratus_context* context, const stratus_volume* volume, stratus_value_range* ranges)
{
  if (stratus_device_builds(context) && stratus_device_takes_volume(context, volume)) {
    const stratus_status status = stratus_device_value_range(context, volume, ranges);
    if (!stratus_device_hands_back(context, status)) {
      return status;
    }
  }
  /* The coarse copy of a large volume is taken now that all its values are read. */
  stratus_look_sample sample = { .memory = NULL };
  if (stratus_kept_is_possible(volume) && stratus_look_samples(volume)) {
    TRY(stratus_look_sample_begin(context, volume, &sample));
  }
  const stratus_status status = stratus_value_range_reduce(context, volume, ranges, sample.memory ? &sample : NULL);
  if (status == STRATUS_OK && sample.memory && stratus_volume_check_missing(context, volume) == STRATUS_OK) {
    stratus_look_sample_keep(volume, &sample);
  }
  stratus_release(context, sample.memory);
  return status;
}

/* Sets ranges by the ranges of smaller blocks, whose size divides the size of the larger ones. */
static void join_blocks(const stratus_value_range* small, stratus_value_range* ranges)
{
  const int64_t factor = ranges->block_size / small->block_size;
  ranges->bias = small->bias;
  ranges->whole_lo = small->whole_lo;
  ranges->whole_hi = small->whole_hi;
  stratus_value_range_begin_blocks(ranges);
  int64_t from = 0;
  for (int64_t k = 0; k < small->blocks[2]; ++k) {
    for (int64_t j = 0; j < small->blocks[1]; ++j) {
      const int64_t row = (k / factor * ranges->blocks[1] + j / factor) * ranges->blocks[0];
      for (int64_t i = 0; i < small->blocks[0]; ++i, ++from) {
        const int64_t to = row + i / factor;
        stratus_value_range_widen(ranges, to, small->lo[from], small->hi[from], small->gaps[from]);
      }
    }
  }
}

/* Finds the ranges by all values. */
static stratus_status find_ranges(stratus_context* context, const stratus_volume* volume, stratus_value_range* ranges)
{
  uint8_t* hidden = NULL;
  ranges->bias = stratus_volume_bias(volume);
  stratus_status status = stratus_volume_hidden_cells(context, volume, &hidden);
  if (status == STRATUS_OK) {
    status = reduce(context, volume, ranges);
  }
  if (status == STRATUS_OK) {
    if (hidden) {
      flag_hidden(volume, hidden, ranges);
    }
    reduce_whole(context, ranges);
    status = stratus_volume_check_missing(context, volume);
  }
  stratus_release(context, hidden);
  return status;
}

/* Makes ranges of a size of blocks, whose values are not set. */
static stratus_status begin(stratus_context* context, const stratus_volume* volume, int block_size, stratus_value_range** out)
{
  void* memory;
  TRY(stratus_allocate_zero(context, 1, sizeof(stratus_value_range), &memory));
  stratus_value_range* const ranges = memory;
  ranges->context = context;
  ranges->block_size = block_size;
  ranges->wide = stratus_type_is_wide(volume->type);
  ranges->integer = stratus_type_is_integer(volume->type);
  const stratus_status status = allocate_blocks(context, volume, ranges);
  if (status != STRATUS_OK) {
    stratus_value_range_destroy(ranges);
    return status;
  }
  *out = ranges;
  return STRATUS_OK;
}

static stratus_status make(stratus_context* context, const stratus_volume* volume, int block_size, stratus_value_range** out)
{
  stratus_status status = STRATUS_OK;
  stratus_value_range *ranges = NULL, *small = NULL;
  TRY(begin(context, volume, block_size, &ranges));
  if (!stratus_value_range_recall(volume, ranges)) {
    /* All values of a large file are read once, for the blocks that rays skip. */
    const int least = stratus_value_range_block_size(volume, 0);
    if (block_size > least && stratus_kept_is_possible(volume)) {
      TRY_CLEANUP(make(context, volume, least, &small));
      join_blocks(small, ranges);
    } else {
      TRY_CLEANUP(find_ranges(context, volume, ranges));
    }
    stratus_value_range_keep(volume, ranges);
  }
  *out = ranges;
  ranges = NULL;
cleanup:
  stratus_value_range_destroy(small);
  stratus_value_range_destroy(ranges);
  return status;
}

stratus_value_range* stratus_value_range_find_kept(stratus_context* context, const stratus_volume* volume)
{
  stratus_value_range* ranges = NULL;
  if (begin(context, volume, stratus_value_range_block_size(volume, 0), &ranges) == STRATUS_OK &&
    stratus_value_range_recall(volume, ranges)) {
    return ranges;
  }
  stratus_value_range_destroy(ranges);
  return NULL;
}

stratus_status stratus_value_range_create(stratus_context* context, const stratus_volume* volume, int block_size, stratus_value_range** out)
{
  stratus_value_range* ranges = NULL;
  if (!context) {
    return STRATUS_INVALID_ARGUMENT;
  }
  if (!out) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "ranges is NULL");
  }
  TRY(stratus_volume_check(context, volume));
  block_size = block_size ? block_size : stratus_value_range_block_size(volume, 0);
  TRY(check_block_size(context, block_size));
  const stratus_stage stage = stratus_stage_begin(context);
  TRY(stratus_progress(context, "value ranges", 0.0));
  TRY(make(context, volume, block_size, &ranges));
  stratus_stage_end(context, &stage, "value ranges",
    (size_t)(ranges->blocks[0] * ranges->blocks[1] * ranges->blocks[2]) * (sizeof *ranges->lo + sizeof *ranges->hi + sizeof *ranges->gaps));
  const stratus_status status = stratus_progress(context, "value ranges", 1.0);
  if (status != STRATUS_OK) {
    stratus_value_range_destroy(ranges);
    return status;
  }
  *out = ranges;
  return STRATUS_OK;
}

void stratus_value_range_destroy(stratus_value_range* ranges)
{
  if (ranges) {
    stratus_context* context = ranges->context;
    stratus_release(context, ranges->lo);
    stratus_release(context, ranges->hi);
    stratus_release(context, ranges->gaps);
    stratus_device_buffer_release(ranges->device_lo);
    stratus_device_buffer_release(ranges->device_hi);
    stratus_release(context, ranges);
  }
}

void stratus_value_range_blocks(const stratus_value_range* ranges, int64_t blocks[3], int* block_size)
{
  for (int a = 0; blocks && a < 3; ++a) {
    blocks[a] = ranges ? ranges->blocks[a] : 0;
  }
  if (block_size) {
    *block_size = ranges ? ranges->block_size : 0;
  }
}

stratus_status stratus_value_range_whole(const stratus_value_range* ranges, double* low, double* high)
{
  if (!ranges) {
    return STRATUS_INVALID_ARGUMENT;
  }
  if (!(ranges->whole_lo <= ranges->whole_hi)) {
    return stratus_fail(ranges->context, STRATUS_INVALID_ARGUMENT, "the volume has no finite value, so that its values have no range");
  }
  if (low) {
    *low = (double)ranges->whole_lo + ranges->bias;
  }
  if (high) {
    *high = (double)ranges->whole_hi + ranges->bias;
  }
  return STRATUS_OK;
}

void stratus_value_range_block(const stratus_value_range* ranges, int64_t i, int64_t j, int64_t k, double* low, double* high, int* gaps)
{
  const bool there = ranges && i >= 0 && j >= 0 && k >= 0 && i < ranges->blocks[0] && j < ranges->blocks[1] && k < ranges->blocks[2];
  const int64_t block = there ? (k * ranges->blocks[1] + j) * ranges->blocks[0] + i : 0;
  if (low) {
    *low = there ? (double)ranges->lo[block] + ranges->bias : (double)INFINITY;
  }
  if (high) {
    *high = there ? (double)ranges->hi[block] + ranges->bias : -(double)INFINITY;
  }
  if (gaps) {
    *gaps = there && ranges->gaps[block];
  }
}
