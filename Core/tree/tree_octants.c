/* SPDX-License-Identifier: BSD-3-Clause
 * Finds how far a ray of each octant may leap from a cell. Cells are bits, 64 per word. A leap of n is free if no bit is set among the n^3
 * cells that begin with the cell; a few shifts and ORs along each axis decide that for a whole word. Leaps are tried from short to long,
 * and a code counts the free ones. */
#include "tree_fields.h"

#include <string.h>

/* A grid of cells as bits: rows[0]*rows[1] rows of `words` words. Bits beyond a row's end are 0. */
typedef struct bit_grid {
  int64_t words, rows[2], size; /* size: number of words */
} bit_grid;

/* to[i] = from[i] | from[i + by] for cells along a row, 0 < |by| < 64. */
static void or_along_rows(const bit_grid* grid, const uint64_t* restrict from, int by, uint64_t* restrict to)
{
  const int64_t n = grid->words;
  if (n == 1) {
    for (int64_t w = 0; w < grid->size; ++w) {
      to[w] = from[w] | (by > 0 ? from[w] >> by : from[w] << -by);
    }
    return;
  }
  for (int64_t row = 0; row < grid->size; row += n) {
    const uint64_t* restrict f = from + row;
    uint64_t* restrict t = to + row;
    if (by > 0) {
      for (int64_t w = 0; w < n - 1; ++w) {
        t[w] = f[w] | f[w] >> by | f[w + 1] << (64 - by);
      }
      t[n - 1] = f[n - 1] | f[n - 1] >> by;
    } else {
      t[0] = f[0] | f[0] << -by;
      for (int64_t w = 1; w < n; ++w) {
        t[w] = f[w] | f[w] << -by | f[w - 1] >> (64 + by);
      }
    }
  }
}

/* The same by whole words, within runs of `run` words. Along y a run is a slice, along z the whole grid. */
static void or_along_runs(int64_t size, int64_t run, const uint64_t* restrict from, int64_t by, uint64_t* restrict to)
{
  const int64_t away = by < 0 ? -by : by, both = run > away ? run - away : 0;
  for (int64_t first = 0; first < size; first += run) {
    const uint64_t* restrict f = from + first;
    uint64_t* restrict t = to + first;
    if (by > 0) {
      for (int64_t w = 0; w < both; ++w) {
        t[w] = f[w] | f[w + away];
      }
      memcpy(t + both, f + both, (size_t)(run - both) * sizeof *t);
    } else {
      memcpy(t, f, (size_t)(run - both) * sizeof *t);
      for (int64_t w = 0; w < both; ++w) {
        t[w + away] = f[w + away] | f[w];
      }
    }
  }
}

/* ORs each cell with the cells that follow it along an axis, `cells` in all. Returns the buffer that holds the result: `from`, `to` or
 * `spare`. */
static uint64_t* dilate(const bit_grid* grid, int axis, int sign, int cells, const uint64_t* from, uint64_t* to, uint64_t* spare)
{
  for (int now = 1; now < cells;) {
    const int step = cells - now < now ? cells - now : now;
    if (axis == 0) {
      or_along_rows(grid, from, sign * step, to);
    } else {
      const int64_t stride = axis == 1 ? grid->words : grid->words * grid->rows[0];
      or_along_runs(grid->size, stride * grid->rows[axis - 1], from, sign * step * stride, to);
    }
    now += step;
    from = to;
    to = spare;
    spare = (uint64_t*)from;
  }
  return (uint64_t*)from;
}

/* Adds 1 to an octant's code in the free cells. Each bit of the code is a plane of bits. */
static void count_free(const bit_grid* grid, int bits, const uint64_t* blocked, const uint64_t* inside, uint64_t* planes)
{
  const int64_t n = grid->size;
  for (int64_t w = 0; w < n; ++w) {
    const uint64_t free = ~blocked[w] & inside[w];
    const uint64_t carry = planes[w] & free;
    planes[w] ^= free;
    if (bits == 3) {
      const uint64_t carry2 = planes[n + w] & carry;
      planes[n + w] ^= carry;
      planes[2 * n + w] ^= carry2;
    } else {
      planes[n + w] ^= carry;
    }
  }
}

/* Transposes an 8x8 bit matrix by blocks of 1, 2 and 4. A byte per plane becomes a byte per cell. */
static uint64_t transpose(uint64_t x)
{
  uint64_t t = (x ^ x >> 7) & 0x00aa00aa00aa00aaull;
  x ^= t ^ t << 7;
  t = (x ^ x >> 14) & 0x0000cccc0000ccccull;
  x ^= t ^ t << 14;
  t = (x ^ x >> 28) & 0x00000000f0f0f0f0ull;
  return x ^ t ^ t << 28;
}

/* Converts one row of 8*bits planes, `apart` words apart, to entries of `bits` bytes each. */
static void write_row(const uint64_t* planes, int64_t apart, int bits, int64_t cells, uint8_t* entries)
{
  for (int64_t first = 0; first < cells; first += 8) {
    const int64_t w = first / 64;
    const int shift = (int)(first % 64), n = cells - first < 8 ? (int)(cells - first) : 8;
    uint8_t bytes[3][8];
    for (int part = 0; part < bits; ++part) {
      uint64_t matrix = 0;
      for (int p = 0; p < 8; ++p) {
        matrix |= (planes[(part * 8 + p) * apart + w] >> shift & 255u) << (8 * p);
      }
      matrix = transpose(matrix);
      for (int c = 0; c < 8; ++c) {
        bytes[part][c] = (uint8_t)(matrix >> (8 * c));
      }
    }
    for (int c = 0; c < n; ++c) {
      for (int part = 0; part < bits; ++part) {
        entries[(first + c) * bits + part] = bytes[part][c];
      }
    }
  }
}

/* Computes the codes of the two octants with one pair of signs along x and y. `room` has space for 4 grids. */
static void find_leaps(
  const bit_grid* grid, int bits, int xy, const uint64_t* occupied, const uint64_t* inside, uint64_t* room, uint64_t* planes)
{
  const int64_t n = grid->size;
  const int sx = xy & 1 ? 1 : -1, sy = xy & 2 ? 1 : -1;
  for (int code = 1; code < 1 << bits; ++code) {
    const int cells = stratus_leap_of_code(bits, code);
    const uint64_t* const x = dilate(grid, 0, sx, cells, occupied, room, room + n);
    uint64_t* const other = x == room ? room + n : room;
    const uint64_t* const y = dilate(grid, 1, sy, cells, x, other, room + 2 * n);
    uint64_t* const spare = y == room + 2 * n ? other : room + 2 * n;
    for (int z = 0; z < 2; ++z) {
      const uint64_t* const blocked = dilate(grid, 2, z ? 1 : -1, cells, y, room + 3 * n, spare);
      count_free(grid, bits, blocked, inside, planes + (xy + 4 * z) * bits * n);
    }
  }
}

/* Sets the bits of the occupied cells, and the bits of the empty ones. */
static void mark_bits(const stratus_voxels* voxels, const stratus_tree_shape* shape, const stratus_tree_node* node,
  const stratus_tree_field* field, const bit_grid* grid, uint64_t* occupied, uint64_t* empty)
{
  const uint32_t count = stratus_tree_node_count(node);
  memset(occupied, 0, (size_t)grid->size * sizeof *occupied);
  for (uint32_t b = 0; b < count; ++b) {
    const stratus_brick* brick = &voxels->bricks[shape->order[node->first + b]];
    const int64_t i = brick->at[0] - field->at[0], j = brick->at[1] - field->at[1], k = brick->at[2] - field->at[2];
    occupied[(k * grid->rows[0] + j) * grid->words + i / 64] |= 1ull << (i % 64);
  }
  for (int64_t w = 0; w < grid->size; ++w) {
    const int64_t left = field->cells[0] - w % grid->words * 64;
    empty[w] = ~occupied[w] & (left < 64 ? (1ull << left) - 1 : ~0ull);
  }
}

stratus_status stratus_tree_octants(stratus_context* context, const stratus_voxels* voxels, const stratus_tree_shape* shape,
  const stratus_tree_node* node, const stratus_tree_field* field, stratus_tree* tree)
{
  const int bits = tree->entry_bytes;
  const bit_grid grid = { .words = (field->cells[0] + 63) / 64,
    .rows = { field->cells[1], field->cells[2] },
    .size = (field->cells[0] + 63) / 64 * (int64_t)field->cells[1] * field->cells[2] };
  const int64_t n = grid.size;
  void* memory;
  TRY(stratus_allocate(context, (size_t)n, (size_t)(2 + 8 * bits + 4 * 4) * sizeof(uint64_t), &memory));
  uint64_t* const occupied = memory;
  uint64_t *const empty = occupied + n, *const planes = empty + n, *const room = planes + 8 * bits * n;
  mark_bits(voxels, shape, node, field, &grid, occupied, empty);
  memset(planes, 0, (size_t)(8 * bits * n) * sizeof *planes);
  const int threads = n > 256 ? context->threads : 1;
#pragma omp parallel num_threads(threads)
  {
#pragma omp for schedule(dynamic, 1)
    for (int xy = 0; xy < 4; ++xy) {
      find_leaps(&grid, bits, xy, occupied, empty, room + xy * 4 * n, planes);
    }
#pragma omp for schedule(static)
    for (int64_t row = 0; row < grid.rows[0] * grid.rows[1]; ++row) {
      uint8_t* const entries = tree->entries + ((size_t)field->first_entry + (size_t)(row * field->cells[0])) * (size_t)bits;
      write_row(planes + row * grid.words, n, bits, field->cells[0], entries);
    }
  }
  stratus_release(context, memory);
  return STRATUS_OK;
}
