/* SPDX-License-Identifier: BSD-3-Clause
 * The bit work of tree_octants.c, compiled for one instruction set, STRATUS_ISA: dilations of bit grids, codes that count free leaps, and
 * entries made of codes. */
#include "tree_fields.h"

#include <string.h>

#if STRATUS_ISA == 2
#include <immintrin.h>
#endif

/* to[i] = from[i] | from[i + by] for cells along a row, 0 < |by| < 64. */
static void or_along_rows(const stratus_bit_grid* grid, const uint64_t* restrict from, int by, uint64_t* restrict to)
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

/* ORs each cell with the cells that follow it along y (axis 1) or z (axis 2), `cells` in all. Returns the buffer that holds the result:
 * `from`, `to` or `spare`. */
static const uint64_t* dilate(
  const stratus_bit_grid* grid, int axis, int sign, int cells, const uint64_t* from, uint64_t* to, uint64_t* spare)
{
  const int64_t stride = axis == 1 ? grid->words : grid->words * grid->rows[0];
  for (int now = 1; now < cells;) {
    const int step = cells - now < now ? cells - now : now;
    or_along_runs(grid->size, stride * grid->rows[axis - 1], from, sign * step * stride, to);
    now += step;
    from = to;
    to = spare;
    spare = (uint64_t*)from;
  }
  return from;
}

/* Takes the cells that are free for a code into the planes of the code's bits. Cells free for a code are free for all smaller ones, and a
 * cell's code is the largest that it is free for. So bit b of it is the exclusive or over the codes that are multiples of 2^b. */
static void take_free(const stratus_bit_grid* grid, int bits, int code, const uint64_t* restrict blocked, const uint64_t* restrict empty,
  uint64_t* restrict planes)
{
  const int64_t n = grid->size;
  for (int bit = 0; bit < bits && code % (1 << bit) == 0; ++bit) {
    uint64_t* restrict const plane = planes + bit * n;
    if (code == 1 << bit) {
      for (int64_t w = 0; w < n; ++w) {
        plane[w] = ~blocked[w] & empty[w];
      }
    } else {
      for (int64_t w = 0; w < n; ++w) {
        plane[w] ^= ~blocked[w] & empty[w];
      }
    }
  }
}

/* Computes the codes of the two octants with one pair of signs along x and y. `room` has space for 5 grids. */
static void find_leaps(
  const stratus_bit_grid* grid, int bits, int xy, const uint64_t* occupied, const uint64_t* empty, uint64_t* room, uint64_t* planes)
{
  const int64_t n = grid->size;
  const int sx = xy & 1 ? 1 : -1, sy = xy & 2 ? 1 : -1;
  const uint64_t* x = occupied; /* dilated along x; no leap is longer than twice the one before, so that one pass makes the next */
  int along_x = 1;
  for (int code = 1; code < 1 << bits; ++code) {
    const int cells = stratus_leap_of_code(bits, code);
    if (cells > along_x) {
      uint64_t* const wider = x == room ? room + n : room;
      or_along_rows(grid, x, sx * (cells - along_x), wider);
      x = wider;
      along_x = cells;
    }
    const uint64_t* const y = dilate(grid, 1, sy, cells, x, room + 2 * n, room + 3 * n);
    uint64_t* const spare = y == room + 2 * n ? room + 3 * n : room + 2 * n;
    for (int z = 0; z < 2; ++z) {
      take_free(grid, bits, code, dilate(grid, 2, z ? 1 : -1, cells, y, room + 4 * n, spare), empty, planes + (xy + 4 * z) * bits * n);
    }
  }
}

#if STRATUS_ISA == 2

/* Returns a byte for each of 64 cells: bit p of a cell's byte is its bit in plane p of eight, `apart` words apart. */
static inline __m512i bytes_of(const uint64_t* planes, int64_t apart)
{
  __m512i bytes = _mm512_setzero_si512();
  for (int p = 0; p < 8; ++p) {
    bytes = _mm512_mask_add_epi8(bytes, planes[p * apart], bytes, _mm512_set1_epi8((char)(1 << p)));
  }
  return bytes;
}

/* Stores the lowest three bytes of 16 numbers of 32 bits, `count` of them. */
static inline void store_three(__m512i numbers, int64_t count, uint8_t* to)
{
  const __m512i three_of_four = _mm512_broadcast_i32x4(_mm_setr_epi8(0, 1, 2, 4, 5, 6, 8, 9, 10, 12, 13, 14, -1, -1, -1, -1));
  const __m512i together = _mm512_setr_epi32(0, 1, 2, 4, 5, 6, 8, 9, 10, 12, 13, 14, 3, 7, 11, 15);
  const __m512i packed = _mm512_permutexvar_epi32(together, _mm512_shuffle_epi8(numbers, three_of_four));
  _mm512_mask_storeu_epi8(to, ~(uint64_t)0 >> (64 - 3 * (count < 16 ? count : 16)), packed);
}

static void write_row(const uint64_t* planes, int64_t apart, int bits, int64_t cells, uint8_t* entries)
{
  for (int64_t first = 0; first < cells; first += 64, ++planes) {
    uint8_t bytes[3][64] = { { 0 } };
    for (int part = 0; part < bits; ++part) {
      _mm512_storeu_si512(bytes[part], bytes_of(planes + part * 8 * apart, apart));
    }
    for (int64_t i = 0; i < 64 && first + i < cells; i += 16) {
      __m512i number = _mm512_cvtepu8_epi32(_mm_loadu_si128((const __m128i*)(const void*)(bytes[0] + i)));
      const __m512i second = _mm512_cvtepu8_epi32(_mm_loadu_si128((const __m128i*)(const void*)(bytes[1] + i)));
      number = _mm512_or_si512(number, _mm512_slli_epi32(second, 8));
      if (bits == 2) {
        const __mmask16 some = (__mmask16)(0xffff >> (cells - first - i < 16 ? 16 - (cells - first - i) : 0));
        _mm512_mask_cvtepi32_storeu_epi16(entries + 2 * (first + i), some, number);
      } else {
        const __m512i third = _mm512_cvtepu8_epi32(_mm_loadu_si128((const __m128i*)(const void*)(bytes[2] + i)));
        store_three(_mm512_or_si512(number, _mm512_slli_epi32(third, 16)), cells - first - i, entries + 3 * (first + i));
      }
    }
  }
}

#else

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

#endif

const stratus_octant_functions STRATUS_ISA_NAME(stratus_octant_functions) = { find_leaps, write_row };
