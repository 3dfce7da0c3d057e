/* SPDX-License-Identifier: BSD-3-Clause
 * Least and greatest value of each block of cells, including the halo that interpolation reads.
 *
 * A row of blocks shares (B+1)^2 rows of values. They are reduced elementwise into one row of extremes, which vectorises for any type,
 * and that row is reduced along x by doubling windows. Rows that two rows of blocks share are read twice, the second time from cache. */
#include "look_sample.h"
#include "value_range_kept.h"
#include "volume.h"
#include "volume_kept.h"
#include "volume_device.h"

#include <float.h>
#include <omp.h>
#include <string.h>

#define BLOCK_SIZE_DEFAULT 4
#define BLOCK_SIZE_MOST 32
/* Eight octant maps of a byte a block. With value ranges, blocks then take at most half a GiB, which leaves a volume that is larger than
 * memory most of it; and traversal addresses the maps with one int. */
#define MAP_BYTES_MOST 0x1p28
#define LANES 16
#define ROW_BYTES 8 /* bytes of the widest value or extreme */

/* One row of blocks, and one thread's scratch to reduce it. */
typedef struct span {
  const stratus_volume* volume;
  double bias;
  bool tiled;         /* values are copied from tiles */
  int64_t x0, nx;     /* first value, and values along x */
  int64_t y0, z0, ny; /* first row of values, and number of rows along y */
  int64_t rows;       /* number of rows in all */
  int64_t blocks;     /* number of blocks along x */
  int size;           /* width of a block in cells */
  void *lo, *hi;      /* nx extremes each */
  void* strided;      /* four rows of nx values */
  uint8_t* bad;       /* nx flags */
  float *block_lo, *block_hi;
  uint8_t* gaps;
} span;

#define NARROW(a) ((float)(a))
#define WIDE(a) ((float)((double)(a)-bias))
#define SAME(v) (v)

#define TYPE int8_t
#define ACC int8_t
#define NAME(f) f##_int8
#define LOAD SAME
#define FETCH NARROW
#define FLOATS 0
#include "value_range_rows.h"

#define TYPE uint8_t
#define ACC uint8_t
#define NAME(f) f##_uint8
#define LOAD SAME
#define FETCH NARROW
#define FLOATS 0
#include "value_range_rows.h"

#define TYPE int16_t
#define ACC int16_t
#define NAME(f) f##_int16
#define LOAD SAME
#define FETCH NARROW
#define FLOATS 0
#include "value_range_rows.h"

#define TYPE uint16_t
#define ACC uint16_t
#define NAME(f) f##_uint16
#define LOAD SAME
#define FETCH NARROW
#define FLOATS 0
#include "value_range_rows.h"

#define TYPE int32_t
#define ACC int32_t
#define NAME(f) f##_int32
#define LOAD SAME
#define FETCH WIDE
#define FLOATS 0
#include "value_range_rows.h"

#define TYPE uint32_t
#define ACC uint32_t
#define NAME(f) f##_uint32
#define LOAD SAME
#define FETCH WIDE
#define FLOATS 0
#include "value_range_rows.h"

#define TYPE int64_t
#define ACC int64_t
#define NAME(f) f##_int64
#define LOAD SAME
#define FETCH WIDE
#define FLOATS 0
#include "value_range_rows.h"

#define TYPE uint64_t
#define ACC uint64_t
#define NAME(f) f##_uint64
#define LOAD SAME
#define FETCH WIDE
#define FLOATS 0
#include "value_range_rows.h"

#define TYPE float
#define ACC float
#define NAME(f) f##_float32
#define LOAD SAME
#define FETCH SAME
#define FLOATS 1
#include "value_range_rows.h"

/* Doubles are fetched before they are compared: one that overflows a float counts as not finite, as it does everywhere else. */
#define TYPE double
#define ACC float
#define NAME(f) f##_float64
#define LOAD WIDE
#define FETCH SAME
#define FLOATS 1
#include "value_range_rows.h"
#include "device.h"

typedef void (*reduce_function)(const span*);

static reduce_function reduce_of(stratus_type type)
{
  switch (type) {
    case STRATUS_INT8:
      return reduce_int8;
    case STRATUS_UINT8:
      return reduce_uint8;
    case STRATUS_INT16:
      return reduce_int16;
    case STRATUS_UINT16:
      return reduce_uint16;
    case STRATUS_INT32:
      return reduce_int32;
    case STRATUS_UINT32:
      return reduce_uint32;
    case STRATUS_INT64:
      return reduce_int64;
    case STRATUS_UINT64:
      return reduce_uint64;
    case STRATUS_FLOAT32:
      return reduce_float32;
    case STRATUS_FLOAT64:
      return reduce_float64;
  }
  return NULL;
}

/* Returns the bytes of a thread's scratch, which give_room() divides. */
static size_t room_bytes(int64_t nx)
{
  const size_t row = ((size_t)nx * ROW_BYTES + 63) / 64 * 64;
  return 7 * row; /* lo, hi, four strided rows, bad */
}

static void give_room(span* s, uint8_t* memory)
{
  const size_t row = room_bytes(s->nx) / 7;
  s->lo = memory;
  s->hi = memory + row;
  s->strided = memory + 2 * row;
  s->bad = memory + 6 * row;
}

/* Returns the one value that all tiles are known to have in which block number i of a span's row has values, or NaN. */
static float only_value(const span* s, int64_t i)
{
  const stratus_constants* parts = s->volume->constants;
  const int64_t *n = s->volume->dimensions, x1 = (i + 1) * s->size;
  const int64_t lo[3] = { i * s->size, s->y0, s->z0 };
  const int64_t hi[3] = { x1 < n[0] ? x1 : n[0] - 1, s->y0 + s->ny - 1, s->z0 + s->rows / s->ny - 1 };
  int64_t first[3], last[3];
  for (int a = 0; a < 3; ++a) {
    first[a] = (parts->before[a] + lo[a]) / parts->side[a];
    last[a] = (parts->before[a] + hi[a]) / parts->side[a];
  }
  const float one = parts->only[(first[2] * parts->across[1] + first[1]) * parts->across[0] + first[0]];
  bool same = fabsf(one) <= FLT_MAX;
  for (int64_t k = first[2]; k <= last[2]; ++k) {
    for (int64_t j = first[1]; j <= last[1]; ++j) {
      for (int64_t x = first[0]; x <= last[0]; ++x) {
        same = same && parts->only[(k * parts->across[1] + j) * parts->across[0] + x] == one;
      }
    }
  }
  return same ? one : NAN;
}

/* Finds the ranges of a row of blocks, and takes what a coarse copy has of its values, if there is one (not NULL). */
static void reduce_row(
  span* s, const stratus_value_range* ranges, reduce_function reduce, int64_t j, int64_t k, const stratus_look_sample* sample)
{
  const int64_t *n = s->volume->dimensions, size = ranges->block_size;
  const int64_t y1 = (j + 1) * size < n[1] ? (j + 1) * size : n[1] - 1;
  const int64_t z1 = (k + 1) * size < n[2] ? (k + 1) * size : n[2] - 1;
  const int64_t block = (k * ranges->blocks[1] + j) * ranges->blocks[0];
  s->y0 = j * size;
  s->z0 = k * size;
  s->ny = y1 - s->y0 + 1;
  s->rows = s->ny * (z1 - s->z0 + 1);
  for (int64_t i = 0, end; i < ranges->blocks[0]; i = end) {
    const float one = s->tiled ? only_value(s, i) : NAN;
    end = s->tiled ? i + 1 : ranges->blocks[0];
    while (isnan(one) && end < ranges->blocks[0] && isnan(only_value(s, end))) {
      ++end;
    }
    s->x0 = i * size;
    s->nx = (end * size < n[0] ? end * size : n[0] - 1) - s->x0 + 1;
    s->blocks = end - i;
    s->block_lo = ranges->lo + block + i;
    s->block_hi = ranges->hi + block + i;
    s->gaps = ranges->gaps + block + i;
    if (isnan(one)) {
      reduce(s);
    } else {
      s->block_lo[0] = s->block_hi[0] = one + 0.0f; /* as reduce() has zeros */
      s->gaps[0] = 0;
    }
  }
  if (sample) {
    stratus_look_sample_rows(
      sample, s->volume, s->y0, j + 1 < ranges->blocks[1] ? s->y0 + size : n[1], s->z0, k + 1 < ranges->blocks[2] ? s->z0 + size : n[2]);
  }
}

static stratus_status reduce_on_host(
  stratus_context* context, const stratus_volume* volume, stratus_value_range* ranges, const stratus_look_sample* sample)
{
  const reduce_function reduce = reduce_of(volume->type);
  const int64_t rows = ranges->blocks[1] * ranges->blocks[2];
  const int threads = (int64_t)context->threads < rows ? context->threads : (int)rows;
  const size_t room = room_bytes(volume->dimensions[0]);
  void* memory = NULL;
  stratus_status status = STRATUS_OK;
  int stop = 0;

  TRY(stratus_allocate(context, (size_t)threads, room, &memory));
#pragma omp parallel num_threads(threads)
  {
    const int thread = omp_get_thread_num();
    span s = {
      .volume = volume,
      .bias = ranges->bias,
      .tiled = stratus_volume_has_constants(volume),
      .nx = volume->dimensions[0],
      .size = ranges->block_size,
    };
    give_room(&s, (uint8_t*)memory + (size_t)thread * room);
#pragma omp for schedule(static)
    for (int64_t row = 0; row < rows; ++row) {
      int stopped;
#pragma omp atomic read
      stopped = stop;
      if (stopped) {
        continue;
      }
      reduce_row(&s, ranges, reduce, row % ranges->blocks[1], row / ranges->blocks[1], sample);
      /* Only the calling thread reports progress; the first rows are its share. */
      if (thread == 0 && row % ranges->blocks[1] == 0) {
        status = stratus_progress(context, "value ranges", (double)row * threads / (double)rows);
        if (status != STRATUS_OK) {
#pragma omp atomic write
          stop = 1;
        }
      }
    }
  }
  stratus_release(context, memory);
  return status;
}

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
  const stratus_status status = reduce_on_host(context, volume, ranges, sample.memory ? &sample : NULL);
  if (status == STRATUS_OK && sample.memory && stratus_volume_check_missing(context, volume) == STRATUS_OK) {
    stratus_look_sample_keep(volume, &sample);
  }
  stratus_release(context, sample.memory);
  return status;
}

/* Sets ranges by the ranges of smaller blocks, whose size divides the size of the larger ones. */
static void join_blocks(const stratus_value_range* small, stratus_value_range* ranges)
{
  const int64_t factor = ranges->block_size / small->block_size, count = ranges->blocks[0] * ranges->blocks[1] * ranges->blocks[2];
  ranges->bias = small->bias;
  ranges->whole_lo = small->whole_lo;
  ranges->whole_hi = small->whole_hi;
  for (int64_t b = 0; b < count; ++b) {
    ranges->lo[b] = INFINITY;
    ranges->hi[b] = -INFINITY;
    ranges->gaps[b] = 0;
  }
  int64_t from = 0;
  for (int64_t k = 0; k < small->blocks[2]; ++k) {
    for (int64_t j = 0; j < small->blocks[1]; ++j) {
      const int64_t row = (k / factor * ranges->blocks[1] + j / factor) * ranges->blocks[0];
      for (int64_t i = 0; i < small->blocks[0]; ++i, ++from) {
        const int64_t to = row + i / factor;
        ranges->lo[to] = small->lo[from] < ranges->lo[to] ? small->lo[from] : ranges->lo[to];
        ranges->hi[to] = small->hi[from] > ranges->hi[to] ? small->hi[from] : ranges->hi[to];
        ranges->gaps[to] |= small->gaps[from];
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
