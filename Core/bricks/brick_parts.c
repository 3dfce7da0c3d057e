/* SPDX-License-Identifier: BSD-3-Clause
 * Parts of an array of bricks. In the array itself a part is a row of bricks along x, or several: neighbours along x share pages of memory.
 * Its values are runs of bytes, one for each layer of values, or one in all if the part has whole layers. A tile is a part of whole bricks
 * whose values follow one another, so that it has pages of its own. The first part along an axis may begin before the array, as a brick
 * that it has only a part of does. */
#include "bricks.h"

#include <stdlib.h>
#include <string.h>

#define RUN_LEAST ((size_t)64 << 10)   /* bytes: pages that several parts share are then few */
#define TILE_LEAST ((int64_t)64 << 10) /* bytes: a fault costs little next to reading them */
#define TILE_ROW ((int64_t)128)        /* bytes of a row of a tile, where a source has no bricks: two lines of the cache come at once */
#define LAYERS_LEAST 16                /* of a part, where a source has no bricks */

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

/* Returns how many values there are along an axis from where the first brick begins. */
static int64_t from_first_brick(const stratus_brick_source* s, int axis)
{
  return s->before[axis] + s->dimensions[axis];
}

/* Counts the parts of the sides that are chosen. A side of all values begins with the array. */
static void count_parts(stratus_brick_view* view)
{
  const stratus_brick_source* s = &view->bricks->source;
  view->parts = 1;
  for (int a = 0; a < 3; ++a) {
    const bool all = view->side[a] >= from_first_brick(s, a);
    view->side[a] = all ? s->dimensions[a] : view->side[a];
    view->before[a] = all ? 0 : s->before[a];
    view->across[a] = (view->before[a] + s->dimensions[a] + view->side[a] - 1) / view->side[a];
    view->parts *= view->across[a];
  }
}

static size_t row_bytes(const stratus_brick_source* s)
{
  return (size_t)s->dimensions[0] * stratus_type_size(s->type);
}

/* Whether the source reads any box as well as another: its bricks are values, or some components of one. */
static bool has_no_bricks(const stratus_brick_source* s)
{
  const bool narrow = s->brick[0] * (int64_t)stratus_type_size(s->type) <= TILE_ROW || s->brick[0] == s->components;
  return narrow && s->brick[1] == 1 && s->brick[2] == 1;
}

void stratus_brick_rows_divide(stratus_brick_view* view)
{
  const stratus_brick_source* s = &view->bricks->source;
  const size_t row = row_bytes(s);
  const int64_t rows = from_first_brick(s, 1), layers = from_first_brick(s, 2);
  view->side[0] = from_first_brick(s, 0);
  view->side[1] = enough(least(s->brick[1], rows), rows, row);
  view->side[2] = least(has_no_bricks(s) ? LAYERS_LEAST : s->brick[2], layers);
  if (view->side[1] == rows) {
    view->side[2] = enough(view->side[2], layers, row * (size_t)s->dimensions[1]);
  }
  count_parts(view);
}

bool stratus_brick_tiles_divide(stratus_brick_view* view, size_t page)
{
  const stratus_brick_source* s = &view->bricks->source;
  const int64_t value = (int64_t)stratus_type_size(s->type);
  const int64_t n[3] = { from_first_brick(s, 0), from_first_brick(s, 1), from_first_brick(s, 2) };
  int64_t bytes = value;
  for (int a = 0; a < 3; ++a) {
    view->side[a] = least(s->brick[a], n[a]);
    bytes *= view->side[a];
  }
  if (has_no_bricks(s)) {
    const int64_t points = TILE_ROW / value / s->brick[0];
    view->side[0] = least((points > 1 ? points : 1) * s->brick[0], n[0]);
    bytes = value * view->side[0];
  }
  for (bool grows = true; grows && bytes < TILE_LEAST;) { /* double the shortest side that can grow */
    int shortest = -1;
    for (int a = 0; a < 3; ++a) {
      if (view->side[a] < n[a] && (shortest < 0 || view->side[a] < view->side[shortest])) {
        shortest = a;
      }
    }
    grows = shortest >= 0;
    if (grows) {
      const int64_t side = view->side[shortest], longer = least(2 * side, n[shortest]);
      view->side[shortest] = longer;
      bytes = bytes / side * longer;
    }
  }
  count_parts(view);
  bytes = value * view->side[0] * view->side[1] * view->side[2];
  view->tile = ((size_t)bytes + page - 1) / page * page;
  view->bytes = view->tile * (size_t)view->parts;
  int64_t pitch = value, tiles = 1;
  for (int a = 0; a < 3; ++a) {
    const int64_t of_point = a == 0 && s->components > 1 ? s->components : 1, points = s->dimensions[a] / of_point;
    uint64_t* const at = malloc(((size_t)points + 1) * sizeof *at);
    view->bricks->at[a] = at;
    if (!at) {
      return false;
    }
    for (int64_t i = 0; i <= points; ++i) {
      /* one more, for the cell behind the last value */
      const int64_t here = view->before[a] + (i < points ? i : points - 1) * of_point;
      at[i] = (uint64_t)(here / view->side[a] * tiles) * view->tile + (uint64_t)(here % view->side[a] * pitch);
    }
    view->bricks->shown.at[a] = at;
    view->bricks->shown.dimensions[a] = points;
    pitch *= view->side[a];
    tiles *= view->across[a];
  }
  return true;
}

/* A box of values. inset: of its first value in its tile. */
typedef struct box {
  int64_t lo[3], size[3], inset[3];
} box;

static box box_of(const stratus_brick_view* view, int64_t part)
{
  const int64_t at[3] = { part % view->across[0], part / view->across[0] % view->across[1], part / (view->across[0] * view->across[1]) };
  box b;
  for (int a = 0; a < 3; ++a) {
    const int64_t begin = at[a] * view->side[a] - view->before[a];
    b.lo[a] = begin < 0 ? 0 : begin;
    b.inset[a] = view->tiled ? b.lo[a] - begin : 0;
    b.size[a] = least(begin + view->side[a], view->bricks->source.dimensions[a]) - b.lo[a];
  }
  return b;
}

/* Gives how many bytes values, rows and layers of a part are apart in a room. A tile at the array's end is as wide as all others. */
static void find_pitch(const stratus_brick_view* view, const box* part, size_t pitch[3])
{
  const int64_t* const size = view->tiled ? view->side : part->size;
  pitch[0] = stratus_type_size(view->bricks->source.type);
  pitch[1] = pitch[0] * (size_t)size[0];
  pitch[2] = pitch[1] * (size_t)size[1];
}

void stratus_brick_part_box(const stratus_brick_view* view, int64_t part, int64_t lo[3], int64_t size[3], int64_t inset[3], size_t pitch[3])
{
  const box b = box_of(view, part);
  memcpy(lo, b.lo, sizeof b.lo);
  memcpy(size, b.size, sizeof b.size);
  memcpy(inset, b.inset, sizeof b.inset);
  find_pitch(view, &b, pitch);
}

/* Whether the values of a part are one run. */
static bool is_one_run(const stratus_brick_view* view)
{
  return view->tiled || view->across[1] == 1;
}

int64_t stratus_brick_runs(const stratus_brick_view* view, int64_t part)
{
  return is_one_run(view) ? 1 : box_of(view, part).size[2];
}

uint64_t stratus_brick_part_bytes(const stratus_brick_view* view, int64_t part)
{
  const box b = box_of(view, part);
  return (uint64_t)(b.size[0] * b.size[1] * b.size[2]) * stratus_type_size(view->bricks->source.type);
}

stratus_brick_run stratus_brick_run_at(const stratus_brick_view* view, int64_t part, int64_t run)
{
  const box b = box_of(view, part);
  const size_t row = row_bytes(&view->bricks->source);
  if (view->tiled) {
    return (stratus_brick_run){ (size_t)part * view->tile, ((size_t)part + 1) * view->tile };
  }
  const size_t begin = (size_t)((b.lo[2] + run) * view->bricks->source.dimensions[1] + b.lo[1]) * row;
  return (stratus_brick_run){ begin, begin + (size_t)(b.size[1] * (is_one_run(view) ? b.size[2] : 1)) * row };
}

int64_t stratus_brick_part_of(const stratus_brick_view* view, size_t byte, size_t* end)
{
  if (view->tiled) {
    *end = (byte / view->tile + 1) * view->tile;
    return (int64_t)(byte / view->tile);
  }
  const size_t bytes = row_bytes(&view->bricks->source);
  const int64_t row = (int64_t)(byte / bytes), rows = view->bricks->source.dimensions[1];
  *end = ((size_t)row + 1) * bytes;
  return (row / rows + view->before[2]) / view->side[2] * view->across[1] + (row % rows + view->before[1]) / view->side[1];
}

stratus_brick_run stratus_brick_inner(const stratus_brick_view* view, size_t page, stratus_brick_run run)
{
  const size_t begin = (run.begin + page - 1) / page * page, end = run.end == view->bytes ? view->mapped : run.end / page * page;
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
  return (from_first_brick(s, axis) + s->brick[axis] - 1) / s->brick[axis];
}

/* Returns the value that all of a brick's blocks have, or NaN: a block's range is of its cells' corners, so that the blocks in which a
 * brick begins have all of its values. Zeros of either sign count as one value. */
static float only_value(const stratus_brick_source* s, const stratus_value_range* ranges, const int64_t brick[3])
{
  int64_t first[3], last[3];
  for (int a = 0; a < 3; ++a) {
    const int64_t begin = brick[a] * s->brick[a] - s->before[a], lo = begin < 0 ? 0 : begin;
    const int64_t hi = least(begin + s->brick[a], s->dimensions[a]) - 1;
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
  const size_t all = (size_t)(n[0] * n[1] * n[2]) * sizeof *bricks->only;
  if (s->only) {
    bricks->only = malloc(all);
    if (bricks->only) {
      memcpy(bricks->only, s->only, all);
    }
    bricks->source.only = NULL; /* the caller's */
    return;
  }
  const int64_t size = stratus_value_range_block_size(&volume, 0);
  bool small = s->identity == 0 || stratus_type_is_wide(s->type);
  for (int a = 0; a < 3; ++a) { /* many bricks in a block would look at it again and again */
    small = small || (s->brick[a] < size && s->brick[a] < s->dimensions[a]);
  }
  stratus_value_range* const ranges = small ? NULL : stratus_value_range_find_kept(context, &volume);
  bricks->only = ranges ? malloc(all) : NULL;
  for (int64_t b = 0; bricks->only && b < n[0] * n[1] * n[2]; ++b) {
    const int64_t brick[3] = { b % n[0], b / n[0] % n[1], b / n[0] / n[1] };
    bricks->only[b] = only_value(s, ranges, brick);
  }
  stratus_value_range_destroy(ranges);
}

float stratus_brick_only_value(const stratus_bricks* bricks, const int64_t lo[3], const int64_t size[3])
{
  const stratus_brick_source* s = &bricks->source;
  const int64_t nx = bricks_along(s, 0), ny = bricks_along(s, 1);
  int64_t first[3], last[3];
  if (!bricks->only) {
    return NAN;
  }
  for (int a = 0; a < 3; ++a) {
    first[a] = (s->before[a] + lo[a]) / s->brick[a];
    last[a] = (s->before[a] + lo[a] + size[a] - 1) / s->brick[a];
  }
  const float one = bricks->only[(first[2] * ny + first[1]) * nx + first[0]];
  for (int64_t z = first[2]; z <= last[2]; ++z) {
    for (int64_t y = first[1]; y <= last[1]; ++y) {
      for (int64_t x = first[0]; x <= last[0]; ++x) {
        if (!(bricks->only[(z * ny + y) * nx + x] == one)) {
          return NAN;
        }
      }
    }
  }
  return one;
}

/* Fills a box of whole bricks with the one value that all of them are known to have; else returns false. */
static bool fill_with_one(const stratus_bricks* bricks, const int64_t lo[3], const int64_t size[3], void* values)
{
  const float one = stratus_brick_only_value(bricks, lo, size);
  if (isnan(one)) {
    return false;
  }
  stratus_type_fill(bricks->source.type, one, values, (size_t)(size[0] * size[1] * size[2]));
  return true;
}

/* A part in the room, with the bytes from a value to the next one along each axis. */
typedef struct part_room {
  char* bytes;
  size_t pitch[3];
} part_room;

/* Reads a box of values of a part. scratch: where the source writes it, if not as the room has it. Returns the bytes that are missing. */
static uint64_t read_box(
  const stratus_bricks* bricks, const box* part, const int64_t lo[3], const int64_t size[3], const part_room* room, char* scratch)
{
  const stratus_brick_source* s = &bricks->source;
  const size_t value = stratus_type_size(s->type), count = (size_t)(size[0] * size[1] * size[2]), row = (size_t)size[0] * value;
  char* place = room->bytes;
  for (int a = 0; a < 3; ++a) {
    place += (size_t)(part->inset[a] + lo[a] - part->lo[a]) * room->pitch[a];
  }
  char* const to = scratch ? scratch : place;
  const int failed = fill_with_one(bricks, lo, size, to) ? 0 : s->read(s->user, lo, size, to);
  if (failed) {
    fill(s->type, to, count);
  }
  for (int64_t z = 0; scratch && z < size[2]; ++z) {
    for (int64_t y = 0; y < size[1]; ++y) {
      memcpy(place + (size_t)z * room->pitch[2] + (size_t)y * room->pitch[1], scratch + (size_t)(z * size[1] + y) * row, row);
    }
  }
  return failed ? count * value : 0;
}

/* Returns how many values the source reads at once along an axis, from value number `at` on: to the brick's end, or to `end`. */
static int64_t reach(const stratus_brick_source* s, int axis, int64_t at, int64_t end)
{
  return least(s->brick[axis] - (s->before[axis] + at) % s->brick[axis], end - at);
}

uint64_t stratus_brick_part_read(const stratus_brick_view* view, int64_t part, stratus_brick_room* room)
{
  const stratus_bricks* bricks = view->bricks;
  const stratus_brick_source* s = &bricks->source;
  const box b = box_of(view, part);
  const size_t value = stratus_type_size(s->type), bytes = view->tiled ? view->tile : (size_t)stratus_brick_part_bytes(view, part);
  part_room at_hand;
  find_pitch(view, &b, at_hand.pitch);
  const bool any = has_no_bricks(s);
  const int64_t most[3] = { any ? b.size[0] : least(s->brick[0], b.size[0]), any ? b.size[1] : least(s->brick[1], b.size[1]),
    any ? b.size[2] : least(s->brick[2], b.size[2]) };
  /* one call for all rows of some layers, which the room has as the source writes them */
  const bool whole = at_hand.pitch[1] == (size_t)most[0] * value && at_hand.pitch[2] == (size_t)b.size[1] * at_hand.pitch[1];
  const size_t scratch = whole ? 0 : (size_t)(most[0] * most[1] * most[2]) * value;
  if (room->capacity < bytes + scratch) {
    free(room->bytes);
    room->bytes = malloc(bytes + scratch);
    room->capacity = room->bytes ? bytes + scratch : 0;
  }
  if (!room->bytes) {
    return stratus_brick_part_bytes(view, part);
  }
  at_hand.bytes = room->bytes;
  uint64_t missing = 0;
  if (view->tiled && bytes > stratus_brick_part_bytes(view, part)) {
    memset(room->bytes, 0, bytes); /* the rest beyond the grid */
  }
  int64_t at[3], size[3], end[3];
  for (int a = 0; a < 3; ++a) {
    end[a] = b.lo[a] + b.size[a];
  }
  for (at[2] = b.lo[2]; at[2] < end[2]; at[2] += size[2]) {
    size[2] = any ? b.size[2] : reach(s, 2, at[2], end[2]);
    for (at[1] = b.lo[1]; at[1] < end[1]; at[1] += size[1]) {
      size[1] = any || whole ? b.size[1] : reach(s, 1, at[1], end[1]);
      for (at[0] = b.lo[0]; at[0] < end[0]; at[0] += size[0]) {
        size[0] = any || whole ? b.size[0] : reach(s, 0, at[0], end[0]);
        missing += read_box(bricks, &b, at, size, &at_hand, whole ? NULL : room->bytes + bytes);
      }
    }
  }
  return missing;
}
