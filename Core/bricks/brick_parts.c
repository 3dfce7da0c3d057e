/* SPDX-License-Identifier: BSD-3-Clause
 * Parts of an array of bricks: a row of bricks along x, or several. The values of a part are runs of bytes in the array, one for each layer
 * of values, or one in all if the part has whole layers. */
#include "bricks.h"

#include <stdlib.h>
#include <string.h>

#define RUN_LEAST ((size_t)64 << 10) /* bytes: pages that several parts share are then few */

static int64_t least(int64_t a, int64_t b)
{
  return a < b ? a : b;
}

/* Returns the least multiple of `step` for which count * bytes >= RUN_LEAST, at most `all`. */
static int64_t enough(int64_t step, int64_t all, size_t bytes)
{
  const int64_t wanted = (int64_t)((RUN_LEAST + bytes - 1) / bytes), steps = (wanted + step - 1) / step;
  return steps >= (all + step - 1) / step ? all : steps * step;
}

void stratus_brick_parts_divide(stratus_bricks* bricks)
{
  const stratus_brick_source* s = &bricks->source;
  bricks->rows = enough(least(s->brick[1], s->dimensions[1]), s->dimensions[1], bricks->row);
  bricks->layers = least(s->brick[2], s->dimensions[2]);
  if (bricks->rows == s->dimensions[1]) {
    bricks->layers = enough(bricks->layers, s->dimensions[2], bricks->row * (size_t)bricks->rows);
  }
  bricks->across = (s->dimensions[1] + bricks->rows - 1) / bricks->rows;
  bricks->parts = bricks->across * ((s->dimensions[2] + bricks->layers - 1) / bricks->layers);
}

/* The box of rows and layers of a part. */
typedef struct box {
  int64_t y, z, rows, layers;
} box;

static box box_of(const stratus_bricks* bricks, int64_t part)
{
  const int64_t* n = bricks->source.dimensions;
  const int64_t y = part % bricks->across * bricks->rows, z = part / bricks->across * bricks->layers;
  return (box){ .y = y, .z = z, .rows = least(bricks->rows, n[1] - y), .layers = least(bricks->layers, n[2] - z) };
}

int64_t stratus_brick_runs(const stratus_bricks* bricks, int64_t part)
{
  return bricks->across == 1 ? 1 : box_of(bricks, part).layers;
}

uint64_t stratus_brick_part_bytes(const stratus_bricks* bricks, int64_t part)
{
  const box b = box_of(bricks, part);
  return (uint64_t)(b.rows * b.layers) * bricks->row;
}

stratus_brick_run stratus_brick_run_at(const stratus_bricks* bricks, int64_t part, int64_t run)
{
  const box b = box_of(bricks, part);
  const size_t begin = (size_t)((b.z + run) * bricks->source.dimensions[1] + b.y) * bricks->row;
  return (stratus_brick_run){ begin, begin + (size_t)(bricks->across == 1 ? b.rows * b.layers : b.rows) * bricks->row };
}

int64_t stratus_brick_part_of(const stratus_bricks* bricks, size_t byte)
{
  const int64_t row = (int64_t)(byte / bricks->row), rows = bricks->source.dimensions[1];
  return row / rows / bricks->layers * bricks->across + row % rows / bricks->rows;
}

stratus_brick_run stratus_brick_inner(const stratus_bricks* bricks, size_t page, stratus_brick_run run)
{
  const size_t begin = (run.begin + page - 1) / page * page, end = run.end == bricks->bytes ? bricks->mapped : run.end / page * page;
  return (stratus_brick_run){ begin, end < begin ? begin : end };
}

/* Fills a box of values that cannot be read. */
static void fill(stratus_type type, void* values, size_t count)
{
  if (type == STRATUS_FLOAT32) {
    for (size_t i = 0; i < count; ++i) {
      ((float*)values)[i] = NAN;
    }
  } else if (type == STRATUS_FLOAT64) {
    for (size_t i = 0; i < count; ++i) {
      ((double*)values)[i] = (double)NAN;
    }
  } else {
    memset(values, 0, count * stratus_type_size(type));
  }
}

/* Reads a box of the array that begins at `lo`. scratch: memory of a box, or NULL where there is none. Returns the bytes that are missing.
 */
static uint64_t read_box(const stratus_bricks* bricks, const int64_t lo[3], const int64_t size[3], char* scratch)
{
  const stratus_brick_source* s = &bricks->source;
  const size_t value = stratus_type_size(s->type), count = (size_t)size[0] * (size_t)size[1] * (size_t)size[2],
               row = (size_t)size[0] * value;
  char* const at = bricks->store + (size_t)(lo[2] * s->dimensions[1] + lo[1]) * bricks->row + (size_t)lo[0] * value;
  /* Whole rows of whole layers, or of one layer, are in the array as the source writes them. */
  const bool in_place = size[0] == s->dimensions[0] && (size[1] == s->dimensions[1] || size[2] == 1);
  char* const to = in_place ? at : scratch;
  const int failed = to ? s->read(s->user, lo, size, to) : 1;
  if (failed && to) {
    fill(s->type, to, count);
  }
  for (int64_t z = 0; !in_place && z < size[2]; ++z) {
    for (int64_t y = 0; y < size[1]; ++y) {
      char* const place = at + (size_t)(z * s->dimensions[1] + y) * bricks->row;
      if (scratch) {
        memcpy(place, scratch + (size_t)(z * size[1] + y) * row, row);
      } else {
        fill(s->type, place, (size_t)size[0]);
      }
    }
  }
  return failed ? count * value : 0;
}

uint64_t stratus_brick_part_read(const stratus_bricks* bricks, int64_t part)
{
  const stratus_brick_source* s = &bricks->source;
  const box b = box_of(bricks, part);
  uint64_t missing = 0;
  char* scratch = NULL;
  int64_t step[3] = { least(s->brick[0], s->dimensions[0]), least(s->brick[1], b.rows), least(s->brick[2], b.layers) };
  if (step[0] == s->dimensions[0]) { /* one call for all of it: whole rows */
    step[1] = b.rows;
    step[2] = bricks->across == 1 ? b.layers : step[2];
  }
  if (step[0] < s->dimensions[0] || (bricks->across > 1 && step[2] > 1)) {
    scratch = malloc((size_t)(step[0] * step[1] * step[2]) * stratus_type_size(s->type));
  }
  for (int64_t z = 0; z < b.layers; z += step[2]) {
    for (int64_t y = 0; y < b.rows; y += step[1]) {
      for (int64_t x = 0; x < s->dimensions[0]; x += step[0]) {
        const int64_t lo[3] = { x, b.y + y, b.z + z };
        const int64_t size[3] = { least(step[0], s->dimensions[0] - x), least(step[1], b.rows - y), least(step[2], b.layers - z) };
        missing += read_box(bricks, lo, size, scratch);
      }
    }
  }
  free(scratch);
  return missing;
}
