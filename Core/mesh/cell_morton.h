/* SPDX-License-Identifier: BSD-3-Clause
 * Cells along a Morton curve through space. Mesh generators write cells in any order; what then goes from neighbour to neighbour, or along
 * a ray, spends its time on memory, unless cells near one another in space are so in memory, too. */
#ifndef STRATUS_CELL_MORTON_H
#define STRATUS_CELL_MORTON_H

#include "volume.h"

/* So many cells fit a cache in any order. */
#define STRATUS_MORTON_FEW_CELLS 4096

/* Cells, of anything that has a place. */
typedef struct stratus_morton_cells {
  int64_t count;  /* < 2^32 */
  int axis_bits;  /* the curve passes 2^axis_bits places along each axis; at most 21 */
  int group_bits; /* groups are below 2^group_bits; 3 axis_bits + group_bits <= 64 */
  const void* data;
  /* at: where a cell is, from 0 to 2^axis_bits along each axis; what lies beyond counts as at the end, NaN as 0. Returns the cell's group:
   * one group comes after the other. Called by many threads at once. */
  uint32_t (*place)(const void* data, int64_t cell, double at[3]);
} stratus_morton_cells;

/* order: count of them; the cells along the curve, those at one place as they come. */
stratus_status stratus_morton_order(stratus_context* context, const stratus_morton_cells* cells, uint32_t* order);

#endif
