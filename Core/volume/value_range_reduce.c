/* SPDX-License-Identifier: BSD-3-Clause
 * Finds the least and the greatest value of each block from a volume's values.
 *
 * A row of blocks shares (B+1)^2 rows of values. They are reduced elementwise into one row of extremes, which vectorises for any type,
 * and that row is reduced along x by doubling windows. Rows that two rows of blocks share are read twice, the second time from cache.
 *
 * The values of a file come in parts, each once, and blocks that have values of several parts are widened by each of them. */
#include "value_range_reduce.h"

#include <float.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>

#define ROW_BYTES 8 /* bytes of the widest value or extreme */

/* The rows of a part that are in one row of blocks, and one thread's scratch to reduce them. */
typedef struct span {
  const char* values; /* of the first row */
  size_t pitch[3];    /* bytes from a value to the next one along each axis */
  double bias;
  int64_t lead;   /* values of the first block that precede the part */
  int64_t nx, ny; /* values along x, and rows along y */
  int64_t rows;   /* number of rows in all */
  int64_t blocks; /* number of blocks along x */
  int size;       /* width of a block in cells */
  void *lo, *hi;  /* lead + nx extremes each */
  void* strided;  /* four rows of nx values */
  uint8_t* bad;   /* nx flags */
  float *block_lo, *block_hi;
  uint8_t* gaps;
  float first_lo, first_hi; /* of the first values along x */
  uint8_t first_gap;
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

typedef void (*reduce_function)(span*);

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

/* Returns the bytes of a row of scratch: values or extremes, of `nx` values and what precedes them in their block. */
static size_t row_bytes(const stratus_value_range* ranges, int64_t nx)
{
  return ((size_t)(nx + ranges->block_size) * ROW_BYTES + 63) / 64 * 64;
}

/* Returns the bytes of a thread's scratch, which give_room() divides: for seven rows, and for the ranges of a row of blocks. */
static size_t room_bytes(const stratus_value_range* ranges, int64_t nx)
{
  return 7 * row_bytes(ranges, nx) + ((size_t)ranges->blocks[0] * (2 * sizeof(float) + 1) + 63) / 64 * 64;
}

static void give_room(span* s, const stratus_value_range* ranges, int64_t nx, uint8_t* memory)
{
  const size_t row = row_bytes(ranges, nx);
  s->lo = memory;
  s->hi = memory + row;
  s->strided = memory + 2 * row;
  s->bad = memory + 6 * row;
  s->block_lo = (float*)(void*)(memory + 7 * row);
  s->block_hi = s->block_lo + ranges->blocks[0];
  s->gaps = (uint8_t*)(s->block_hi + ranges->blocks[0]);
}

/* Gives the first and the last block along an axis that have any of `count` values from `lo` on. A value on the border of two blocks is in
 * both. */
static void blocks_of(const stratus_value_range* ranges, int axis, int64_t lo, int64_t count, int64_t* first, int64_t* last)
{
  const int64_t size = ranges->block_size, end = (lo + count - 1) / size;
  *first = lo % size == 0 && lo > 0 ? lo / size - 1 : lo / size;
  *last = end < ranges->blocks[axis] ? end : ranges->blocks[axis] - 1;
}

/* Puts the rows of a part that are in blocks (.,j,k) into a span. */
static void take_rows(span* s, const stratus_value_range* ranges, const stratus_part* part, int64_t j, int64_t k)
{
  const int64_t size = ranges->block_size, at[2] = { j * size, k * size };
  int64_t lo[2], hi[2];
  for (int a = 0; a < 2; ++a) {
    const int64_t begin = part->lo[a + 1], last = begin + part->size[a + 1] - 1;
    lo[a] = at[a] > begin ? at[a] : begin;
    hi[a] = at[a] + size < last ? at[a] + size : last;
  }
  const stratus_part rows = stratus_part_rows(part, lo[0], hi[0] + 1, lo[1], hi[1] + 1);
  s->values = rows.values;
  memcpy(s->pitch, rows.pitch, sizeof s->pitch);
  s->ny = rows.size[1];
  s->rows = s->ny * rows.size[2];
}

void stratus_value_range_widen(const stratus_value_range* ranges, int64_t block, float lo, float hi, uint8_t gap)
{
  ranges->lo[block] = lo < ranges->lo[block] ? lo : ranges->lo[block];
  ranges->hi[block] = hi > ranges->hi[block] ? hi : ranges->hi[block];
  ranges->gaps[block] |= gap;
}

/* Widens the ranges of the blocks that have any value of a part. */
static void reduce_part(span* s, const stratus_value_range* ranges, reduce_function reduce, const stratus_part* part)
{
  int64_t first[3], last[3];
  for (int a = 0; a < 3; ++a) {
    blocks_of(ranges, a, part->lo[a], part->size[a], &first[a], &last[a]);
  }
  const int64_t own = part->lo[0] / ranges->block_size; /* the block before it, if any, has the first values only */
  s->lead = part->lo[0] % ranges->block_size;
  s->nx = part->size[0];
  s->blocks = last[0] - own + 1;
  for (int64_t k = first[2]; k <= last[2]; ++k) {
    for (int64_t j = first[1]; j <= last[1]; ++j) {
      const int64_t row = (k * ranges->blocks[1] + j) * ranges->blocks[0];
      if (part->values) {
        take_rows(s, ranges, part, j, k);
        reduce(s);
      }
#pragma omp critical(stratus_value_range)
      for (int64_t i = first[0]; i <= last[0]; ++i) {
        if (!part->values) {
          stratus_value_range_widen(ranges, row + i, part->one + 0.0f, part->one + 0.0f, 0); /* as reduce() has zeros */
        } else if (i < own) {
          stratus_value_range_widen(ranges, row + i, s->first_lo, s->first_hi, s->first_gap);
        } else {
          stratus_value_range_widen(ranges, row + i, s->block_lo[i - own], s->block_hi[i - own], s->gaps[i - own]);
        }
      }
    }
  }
}

/* Finds the ranges of row of blocks number `row` of a volume, and takes what a coarse copy has of its values, if there is one (not NULL).
 */
static void reduce_row(span* s, const stratus_value_range* ranges, reduce_function reduce, const stratus_part* whole, int64_t row,
  const stratus_look_sample* sample)
{
  const int64_t size = ranges->block_size, j = row % ranges->blocks[1], k = row / ranges->blocks[1];
  take_rows(s, ranges, whole, j, k);
  s->nx = whole->size[0];
  s->blocks = ranges->blocks[0];
  s->block_lo = ranges->lo + row * ranges->blocks[0];
  s->block_hi = ranges->hi + row * ranges->blocks[0];
  s->gaps = ranges->gaps + row * ranges->blocks[0];
  reduce(s);
  if (sample) {
    const stratus_part part = stratus_part_rows(whole, j * size, j + 1 < ranges->blocks[1] ? (j + 1) * size : whole->size[1], k * size,
      k + 1 < ranges->blocks[2] ? (k + 1) * size : whole->size[2]);
    stratus_look_sample_part(sample, &part);
  }
}

void stratus_value_range_begin_blocks(const stratus_value_range* ranges)
{
  const int64_t count = ranges->blocks[0] * ranges->blocks[1] * ranges->blocks[2];
  for (int64_t b = 0; b < count; ++b) {
    ranges->lo[b] = INFINITY;
    ranges->hi[b] = -INFINITY;
    ranges->gaps[b] = 0;
  }
}

/* Data that the threads share. */
typedef struct job {
  stratus_context* context;
  const stratus_value_range* ranges;
  const stratus_look_sample* sample; /* NULL: none is taken */
  const stratus_parts* parts;        /* NULL: values are read in place */
  reduce_function reduce;
  int64_t count, done;
  int stop;
  stratus_status status;
} job;

/* Reduces row of blocks, or part, number n. Only the calling thread, number 0, reports progress. */
static void do_one(job* of, int thread, span* s, stratus_part* part, int64_t n)
{
  int stopped;
#pragma omp atomic read
  stopped = of->stop;
  if (stopped) {
    return;
  }
  if (of->parts) {
    of->parts->read(of->parts->user, n, part);
    reduce_part(s, of->ranges, of->reduce, part);
    if (of->sample) {
      stratus_look_sample_part(of->sample, part);
    }
  } else {
    reduce_row(s, of->ranges, of->reduce, part, n, of->sample);
  }
  int64_t done;
#pragma omp atomic capture
  done = ++of->done;
  if (thread == 0 && (of->parts || n % of->ranges->blocks[1] == 0)) {
    of->status = stratus_progress(of->context, "value ranges", (double)done / (double)of->count);
    if (of->status != STRATUS_OK) {
#pragma omp atomic write
      of->stop = 1;
    }
  }
}

stratus_status stratus_value_range_reduce(
  stratus_context* context, const stratus_volume* volume, stratus_value_range* ranges, const stratus_look_sample* sample)
{
  job of = {
    .context = context, .ranges = ranges, .sample = sample, .parts = stratus_volume_parts(volume), .reduce = reduce_of(volume->type)
  };
  of.count = of.parts ? of.parts->count : ranges->blocks[1] * ranges->blocks[2];
  const int threads = (int64_t)context->threads < of.count ? context->threads : (int)of.count;
  const int64_t at_once = of.parts || threads < 1 ? 1 : (of.count + threads - 1) / threads; /* rows in one run for each thread */
  const size_t room = room_bytes(ranges, volume->dimensions[0]);
  void* memory = NULL;
  TRY(stratus_allocate(context, (size_t)threads, room, &memory));
  if (of.parts) {
    stratus_value_range_begin_blocks(ranges);
  }
#pragma omp parallel num_threads(threads)
  {
    const int thread = omp_get_thread_num();
    span s = { .bias = ranges->bias, .size = ranges->block_size };
    stratus_part part = stratus_volume_whole(volume);
    give_room(&s, ranges, volume->dimensions[0], (uint8_t*)memory + (size_t)thread * room);
#pragma omp for schedule(monotonic : dynamic, at_once)
    for (int64_t n = 0; n < of.count; ++n) {
      do_one(&of, thread, &s, &part, n);
    }
    free(part.room);
  }
  stratus_release(context, memory);
  return of.status;
}
