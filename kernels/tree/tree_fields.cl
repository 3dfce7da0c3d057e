/* SPDX-License-Identifier: BSD-3-Clause
 * Distance fields of a tree's leaves, all leaves at once: how far a ray of each octant may leap from a cell, what Core/tree/tree_octants.c
 * finds on the host, and the numbers of the masks. A cell is a bit. A leap of n is free if no bit is set among the n^3 cells that begin
 * with the cell: bits are gathered along y, then along z, then along x. */
#include "tree_arguments.h"

#ifndef BITS
#define BITS 2 /* of a code, and bytes of an entry */
#endif
#define CODES ((1 << BITS) - 1)

#ifdef STRATUS_ARGUMENTS_BYTES
/* An array of negative size, which does not compile, where the host lays the arguments out otherwise. */
typedef char stratus_arguments_agree[sizeof(stratus_leaf_arguments) == STRATUS_ARGUMENTS_BYTES ? 1 : -1];
#endif

typedef struct brick {
  ulong mask;
  ushort at[3], count;
} brick;

/* Cells that a code leaps: see stratus_leap_of_code(). */
static int leap_of(int code) { return BITS == 2 ? 1 << (code - 1) : (2 + (code & 1)) << (code >> 1) >> 1; }

/* Defines a function that finds the leaf of a word, a mask or a row: the last that begins at it or before. */
#define DEFINE_FIND(field)                                                                                                                 \
  static uint find_by_##field(__global const stratus_leaf_arguments* leaves, uint count, uint wanted)                                      \
  {                                                                                                                                        \
    uint low = 0, high = count - 1;                                                                                                        \
    while (low < high) {                                                                                                                   \
      const uint middle = low + (high - low + 1) / 2;                                                                                      \
      if (leaves[middle].field <= wanted) {                                                                                                \
        low = middle;                                                                                                                      \
      } else {                                                                                                                             \
        high = middle - 1;                                                                                                                 \
      }                                                                                                                                    \
    }                                                                                                                                      \
    return low;                                                                                                                            \
  }
DEFINE_FIND(first_word)
DEFINE_FIND(first_mask)
DEFINE_FIND(first_row)

/* Where a word lies. */
typedef struct place {
  uint leaf;
  int word, row[2]; /* in its row; the row's y and z */
} place;

static place place_of(__global const stratus_leaf_arguments* leaves, uint leaf_count, uint word)
{
  const uint low = find_by_first_word(leaves, leaf_count, word);
  const uint within = word - leaves[low].first_word, words = (uint)leaves[low].words, row = within / words;
  place p;
  p.leaf = low;
  p.word = (int)(within % words);
  p.row[0] = (int)(row % (uint)leaves[low].cells[1]);
  p.row[1] = (int)(row / (uint)leaves[low].cells[1]);
  return p;
}

__kernel void clear(__global uint* grid, ulong words)
{
  if (get_global_id(0) < words) {
    grid[get_global_id(0)] = 0;
  }
}

/* Sets the bits of occupied cells, and writes the masks. One item a brick: `first_mask` of the leaves rises with them. */
__kernel void mark(__global const brick* bricks, __global const uint* order, __global const stratus_leaf_arguments* leaves, uint leaf_count,
  uint count, __global uint* occupied, __global ulong* masks)
{
  const uint n = (uint)get_global_id(0);
  if (n >= count) {
    return;
  }
  const uint low = find_by_first_mask(leaves, leaf_count, n);
  __global const stratus_leaf_arguments* leaf = leaves + low;
  const brick b = bricks[order[leaf->first + (n - leaf->first_mask)]];
  const uint i = b.at[0] - leaf->at[0], j = b.at[1] - leaf->at[1], k = b.at[2] - leaf->at[2];
  atomic_or(occupied + leaf->first_word + (k * (uint)leaf->cells[1] + j) * (uint)leaf->words + i / 32, 1u << (i & 31));
  masks[n] = b.mask;
}

/* Gathers along y, towards + for direction 1, else towards -: one grid of `words` words for each direction and code. */
__kernel void gather_y(
  __global const stratus_leaf_arguments* leaves, uint leaf_count, uint words, __global const uint* occupied, __global uint* along_y)
{
  const uint word = (uint)get_global_id(0), direction = (uint)get_global_id(1);
  if (word >= words) {
    return;
  }
  const place p = place_of(leaves, leaf_count, word);
  const int step = direction ? leaves[p.leaf].words : -leaves[p.leaf].words;
  const int rows = direction ? leaves[p.leaf].cells[1] - p.row[0] : p.row[0] + 1;
  uint bits = 0;
  int done = 0;
  for (int code = 1; code <= CODES; ++code) {
    const int cells = min(leap_of(code), rows);
    for (; done < cells; ++done) {
      bits |= occupied[(long)word + done * step];
    }
    along_y[(ulong)(direction * CODES + (uint)code - 1) * words + word] = bits;
  }
}

/* Gathers along z. directions: bit 0 is that along y, bit 1 that along z. */
__kernel void gather_z(
  __global const stratus_leaf_arguments* leaves, uint leaf_count, uint words, __global const uint* along_y, __global uint* along_z)
{
  const uint word = (uint)get_global_id(0), directions = (uint)get_global_id(1);
  if (word >= words) {
    return;
  }
  const place p = place_of(leaves, leaf_count, word);
  const int up = directions >> 1 & 1, slice = leaves[p.leaf].words * leaves[p.leaf].cells[1], step = up ? slice : -slice;
  const int rows = up ? leaves[p.leaf].cells[2] - p.row[1] : p.row[1] + 1;
  for (int code = 1; code <= CODES; ++code) {
    const int cells = min(leap_of(code), rows);
    __global const uint* from = along_y + (ulong)((directions & 1) * CODES + (uint)code - 1) * words + word;
    uint bits = 0;
    for (int done = 0; done < cells; ++done) {
      bits |= from[(long)done * step];
    }
    along_z[(ulong)(directions * CODES + (uint)code - 1) * words + word] = bits;
  }
}

/* Transposes an 8x8 bit matrix by blocks of 1, 2 and 4. A byte per plane becomes a byte per cell. */
static ulong transpose(ulong x)
{
  ulong t = (x ^ x >> 7) & 0x00aa00aa00aa00aaUL;
  x ^= t ^ t << 7;
  t = (x ^ x >> 14) & 0x0000cccc0000ccccUL;
  x ^= t ^ t << 14;
  t = (x ^ x >> 28) & 0x00000000f0f0f0f0UL;
  return x ^ t ^ t << 28;
}

/* Gathers along x and writes the entries of a word's cells. A cell free for a code is free for all smaller ones, so that bit b of its code
 * is the exclusive or over the codes that are multiples of 2^b. */
__kernel void entries(__global const stratus_leaf_arguments* leaves, uint leaf_count, uint words, __global const uint* occupied,
  __global const uint* along_z, __global uchar* entries)
{
  const uint word = (uint)get_global_id(0);
  if (word >= words) {
    return;
  }
  const place p = place_of(leaves, leaf_count, word);
  const int last = p.word == leaves[p.leaf].words - 1, first = p.word == 0;
  const uint empty = ~occupied[word];
  uint planes[8 * BITS];
  for (int i = 0; i < 8 * BITS; ++i) {
    planes[i] = 0;
  }
  for (int directions = 0; directions < 4; ++directions) {
    for (int code = 1; code <= CODES; ++code) {
      __global const uint* own = along_z + (ulong)(directions * CODES + code - 1) * words + word;
      ulong up = (ulong)own[0] | (last ? 0 : (ulong)own[1] << 32), down = (ulong)own[0] << 32 | (first ? 0 : (ulong)own[-1]);
      for (int now = 1, cells = leap_of(code); now < cells;) {
        const int step = min(now, cells - now);
        up |= up >> step;
        down |= down << step;
        now += step;
      }
      const uint free_up = ~(uint)up & empty, free_down = ~(uint)(down >> 32) & empty;
      for (int bit = 0; bit < BITS && code % (1 << bit) == 0; ++bit) {
        planes[(2 * directions + 1) * BITS + bit] ^= free_up;
        planes[2 * directions * BITS + bit] ^= free_down;
      }
    }
  }
  const int left = min(leaves[p.leaf].cells[0] - 32 * p.word, 32);
  const ulong at = leaves[p.leaf].first_entry +
    ((ulong)p.row[1] * (ulong)leaves[p.leaf].cells[1] + (ulong)p.row[0]) * (ulong)leaves[p.leaf].cells[0] + 32 * (ulong)p.word;
  for (int cell = 0; cell < left; cell += 8) {
    ulong bytes[BITS];
    for (int part = 0; part < BITS; ++part) {
      ulong matrix = 0;
      for (int plane = 0; plane < 8; ++plane) {
        matrix |= (ulong)(planes[8 * part + plane] >> cell & 255u) << (8 * plane);
      }
      bytes[part] = transpose(matrix);
    }
    for (int c = 0; c < min(8, left - cell); ++c) {
      for (int part = 0; part < BITS; ++part) {
        entries[(at + (ulong)(cell + c)) * BITS + (ulong)part] = (uchar)(bytes[part] >> (8 * c));
      }
    }
  }
}

/* Finds where the masks of each row begin: a leaf's bricks are in ascending order. One item a row. */
__kernel void rows(__global const brick* bricks, __global const uint* order, __global const stratus_leaf_arguments* leaves, uint leaf_count,
  uint mask_count, uint count, __global uint* rows)
{
  const uint n = (uint)get_global_id(0);
  if (n >= count) {
    return;
  }
  const uint low = find_by_first_row(leaves, leaf_count, n);
  __global const stratus_leaf_arguments* leaf = leaves + low;
  const uint within = n - leaf->first_row, wide = (uint)leaf->cells[1], end = low + 1 < leaf_count ? leaf[1].first_mask : mask_count;
  const uint y = (uint)leaf->at[1] + within % wide, z = (uint)leaf->at[2] + within / wide;
  uint from = leaf->first_mask, to = end;
  while (from < to) {
    const uint middle = from + (to - from) / 2;
    __global const brick* b = bricks + order[leaf->first + (middle - leaf->first_mask)];
    if (b->at[2] < z || (b->at[2] == z && b->at[1] < y)) {
      from = middle + 1;
    } else {
      to = middle;
    }
  }
  rows[n] = from;
}

/* Writes the entries of occupied cells: the number of the cell's mask in its row. One item a row. */
__kernel void numbers(__global const brick* bricks, __global const uint* order, __global const stratus_leaf_arguments* leaves,
  uint leaf_count, uint mask_count, uint count, __global const uint* rows, __global uchar* entries)
{
  const uint n = (uint)get_global_id(0);
  if (n >= count) {
    return;
  }
  const uint low = find_by_first_row(leaves, leaf_count, n);
  __global const stratus_leaf_arguments* leaf = leaves + low;
  const int is_last = n + 1 == count || (low + 1 < leaf_count && leaf[1].first_row == n + 1);
  const uint leaf_end = low + 1 < leaf_count ? leaf[1].first_mask : mask_count, end = is_last ? leaf_end : rows[n + 1];
  for (uint mask = rows[n]; mask < end; ++mask) {
    const uint i = bricks[order[leaf->first + (mask - leaf->first_mask)]].at[0] - (uint)leaf->at[0];
    const uint value = (mask - rows[n]) << BITS;
    __global uchar* entry = entries + ((ulong)leaf->first_entry + (ulong)(n - leaf->first_row) * (ulong)leaf->cells[0] + i) * BITS;
    for (int part = 0; part < BITS; ++part) {
      entry[part] = (uchar)(value >> (8 * part));
    }
  }
}
