/* SPDX-License-Identifier: BSD-3-Clause
 * The entries of a transfer function's table: which floats have which entry, and the value at which an entry takes the function. */
#ifndef STRATUS_TABLE_ENTRIES_H
#define STRATUS_TABLE_ENTRIES_H

#include "volume.h"

/* A uniform grid of cells over the values. A cell is one entry unless the function has features in it that are narrower than the cell. It
 * is then divided, so that no entry of it mixes two pieces of the function. */
typedef struct stratus_table_entries {
  double from, width; /* the value in the middle of cell 0, and the width of a cell */
  float scale, offset;
  int cells, size; /* of the grid; of entries */
  bool cut;        /* sums: values lie beyond the grid, and are transparent there */
  int steps;       /* bisections that find an entry within a cell; 0: no cell is divided */
  int32_t* first;  /* cells+1: the first entry of each cell, and `size`. NULL if no cell is divided, as the next */
  float* bound;    /* size: an entry that is not its cell's first begins at this float */
  double* value;   /* size: where the function is taken */
  double* wide;    /* size: the extent of the entry's values; NULL if no cell is divided */
  uint8_t* shows;  /* size: 1 if the function shows on all floats of the entry */
} stratus_table_entries;

/* least: the least number of cells, unless the values are whole numbers that as few cells distinguish. */
stratus_status stratus_table_entries_create(stratus_context* context, const stratus_transfer* transfer, const stratus_pieces* pieces,
  const stratus_table_values* values, int least, stratus_table_entries* entries);
void stratus_table_entries_release(stratus_context* context, stratus_table_entries* entries);

#endif
