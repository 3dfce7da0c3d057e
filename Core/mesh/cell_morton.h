/* SPDX-License-Identifier: BSD-3-Clause
 * Cells in order of a Morton curve through space. Mesh generators write cells in any order. Code that goes from neighbour to neighbour, or
 * along a ray, then waits for memory, unless cells that are near in space are also near in memory. */
#ifndef STRATUS_CELL_MORTON_H
#define STRATUS_CELL_MORTON_H

#include "volume.h"

/* This many cells fit a cache in any order. */
#define STRATUS_MORTON_FEW_CELLS 4096

/* The cells to sort. They may be anything that has a place. */
typedef struct stratus_morton_cells {
  int64_t count;  /* < 2^32 */
  int axis_bits;  /* the curve has 2^axis_bits places along each axis; at most 21 */
  int group_bits; /* group numbers are below 2^group_bits; 3*axis_bits + group_bits <= 64 */
  const void* data;
  /* Sets at[] to a cell's place, 0 to 2^axis_bits along each axis; numbers beyond are clamped, and NaN counts as 0. Returns the cell's
   * group: groups are sorted first. Many threads call it at once. */
  uint32_t (*place)(const void* data, int64_t cell, double at[3]);
} stratus_morton_cells;

/* order: out, `count` cell numbers along the curve. Cells at one place keep their order. */
stratus_status stratus_morton_order(stratus_context* context, const stratus_morton_cells* cells, uint32_t* order);

#endif
