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

static int64_t bricks_along(const stratus_brick_source* s, int axis)
{
  return (s->dimensions[axis] + s->brick[axis] - 1) / s->brick[axis];
}

/* Returns the value that all of a brick's blocks have, or NaN: a block's range is of its cells' corners, so that the blocks in which a
 * brick begins have all of its values. Zeros of either sign count as one value. */
static float only_value(const stratus_brick_source* s, const stratus_value_range* ranges, const int64_t brick[3])
{
  int64_t first[3], last[3];
  for (int a = 0; a < 3; ++a) {
    const int64_t lo = brick[a] * s->brick[a], hi = least(lo + s->brick[a], s->dimensions[a]) - 1;
    first[a] = least(lo / ranges->block_size, ranges->blocks[a] - 1);
    last[a] = least(hi / ranges->block_size, ranges->blocks[a] - 1);
  }
  const float one = ranges->lo[(first[2] * ranges->blocks[1] + first[1]) * ranges->blocks[0] + first[0]];
  for (int64_t k = first[2]; k <= last[2]; ++k) {
    for (int64_t j = first[1]; j <= last[1]; ++j) {
      const int64_t row = (k * ranges->blocks[1] + j) * ranges->blocks[0];
      for (int64_t i = first[0]; i <= last[0]; ++i) {
        if (ranges->lo[row + i] != one || ranges->hi[row + i] != one || ranges->gaps[row + i]) {
          return NAN;
        }
      }
    }
  }
  return one;
}

void stratus_brick_find_only(stratus_context* context, stratus_bricks* bricks)
{
  const stratus_brick_source* s = &bricks->source;
  stratus_volume volume = stratus_volume_default();
  volume.type = s->type;
  volume.identity = s->identity;
  memcpy(volume.dimensions, s->dimensions, sizeof volume.dimensions);
  const int64_t n[3] = { bricks_along(s, 0), bricks_along(s, 1), bricks_along(s, 2) };
  const int64_t size = stratus_value_range_block_size(&volume, 0);
  bool small = s->identity == 0 || stratus_type_is_wide(s->type);
  for (int a = 0; a < 3; ++a) { /* many bricks in a block would look at it again and again */
    small = small || (s->brick[a] < size && s->brick[a] < s->dimensions[a]);
  }
  stratus_value_range* const ranges = small ? NULL : stratus_value_range_find_kept(context, &volume);
  bricks->only = ranges ? malloc((size_t)(n[0] * n[1] * n[2]) * sizeof *bricks->only) : NULL;
  for (int64_t b = 0; bricks->only && b < n[0] * n[1] * n[2]; ++b) {
    const int64_t brick[3] = { b % n[0], b / n[0] % n[1], b / n[0] / n[1] };
    bricks->only[b] = only_value(s, ranges, brick);
  }
  stratus_value_range_destroy(ranges);
}

/* Fills a box of whole bricks with the one value that all of them are known to have; else returns false. */
static bool fill_with_one(const stratus_bricks* bricks, const int64_t lo[3], const int64_t size[3], void* values)
{
  const stratus_brick_source* s = &bricks->source;
  if (!bricks->only) {
    return false;
  }
  const int64_t nx = bricks_along(s, 0), ny = bricks_along(s, 1);
  const float one = bricks->only[(lo[2] / s->brick[2] * ny + lo[1] / s->brick[1]) * nx + lo[0] / s->brick[0]];
  for (int64_t z = lo[2]; z < lo[2] + size[2]; z += s->brick[2]) {
    for (int64_t y = lo[1]; y < lo[1] + size[1]; y += s->brick[1]) {
      for (int64_t x = lo[0]; x < lo[0] + size[0]; x += s->brick[0]) {
        if (!(bricks->only[(z / s->brick[2] * ny + y / s->brick[1]) * nx + x / s->brick[0]] == one)) {
          return false;
        }
      }
    }
  }
  const size_t count = (size_t)(size[0] * size[1] * size[2]), bytes = stratus_type_size(s->type);
  for (size_t i = 0; i < count && bytes == 4; ++i) {
    ((float*)values)[i] = one;
  }
  for (size_t i = 0; i < count && bytes == 2; ++i) {
    ((uint16_t*)values)[i] = (uint16_t)(int)one;
  }
  if (bytes == 1) {
    memset(values, (int)one, count);
  }
  return true;
}

/* Reads the box of a part that begins `y` rows and `z` layers into it, at x `x`. room: of the part. scratch: of a box that is not in the
 * room as the source writes it. Returns the bytes that are missing. */
static uint64_t read_box(const stratus_bricks* bricks, const box* b, const int64_t at[3], const int64_t size[3], char* room, char* scratch)
{
  const stratus_brick_source* s = &bricks->source;
  const size_t value = stratus_type_size(s->type), count = (size_t)(size[0] * size[1] * size[2]), row = (size_t)size[0] * value;
  const int64_t lo[3] = { at[0], b->y + at[1], b->z + at[2] };
  char* const place = room + (size_t)(at[2] * b->rows + at[1]) * bricks->row + (size_t)at[0] * value;
  char* const to = scratch ? scratch : place;
  const int failed = fill_with_one(bricks, lo, size, to) ? 0 : s->read(s->user, lo, size, to);
  if (failed) {
    fill(s->type, to, count);
  }
  for (int64_t z = 0; scratch && z < size[2]; ++z) {
    for (int64_t y = 0; y < size[1]; ++y) {
      memcpy(place + (size_t)(z * b->rows + y) * bricks->row, scratch + (size_t)(z * size[1] + y) * row, row);
    }
  }
  return failed ? count * value : 0;
}

uint64_t stratus_brick_part_read(const stratus_bricks* bricks, int64_t part, stratus_brick_room* room)
{
  const stratus_brick_source* s = &bricks->source;
  const box b = box_of(bricks, part);
  const size_t bytes = (size_t)stratus_brick_part_bytes(bricks, part);
  int64_t step[3] = { least(s->brick[0], s->dimensions[0]), least(s->brick[1], b.rows), least(s->brick[2], b.layers) };
  const bool whole = step[0] == s->dimensions[0]; /* one call for all rows of some layers, which the room has as the source writes them */
  step[1] = whole ? b.rows : step[1];
  const size_t scratch = whole ? 0 : (size_t)(step[0] * step[1] * step[2]) * stratus_type_size(s->type);
  if (room->capacity < bytes + scratch) {
    free(room->bytes);
    room->bytes = malloc(bytes + scratch);
    room->capacity = room->bytes ? bytes + scratch : 0;
  }
  if (!room->bytes) {
    return bytes;
  }
  uint64_t missing = 0;
  for (int64_t z = 0; z < b.layers; z += step[2]) {
    for (int64_t y = 0; y < b.rows; y += step[1]) {
      for (int64_t x = 0; x < s->dimensions[0]; x += step[0]) {
        const int64_t at[3] = { x, y, z };
        const int64_t size[3] = { least(step[0], s->dimensions[0] - x), least(step[1], b.rows - y), least(step[2], b.layers - z) };
        missing += read_box(bricks, &b, at, size, room->bytes, whole ? NULL : room->bytes + bytes);
      }
    }
  }
  return missing;
}
