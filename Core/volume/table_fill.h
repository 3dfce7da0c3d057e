/* SPDX-License-Identifier: BSD-3-Clause
 * The arguments that describe a transfer function's table to kernels. */
#ifndef STRATUS_TABLE_FILL_H
#define STRATUS_TABLE_FILL_H

#include "volume.h"
#include "table_arguments.h"

/* Returns the cell of an entry, or the number of cells for `size`. */
static inline int stratus_table_cell_of_entry(const stratus_table* table, int entry)
{
  int lo = 0, hi = table->cells;
  while (table->first && lo < hi) {
    const int middle = (lo + hi) / 2;
    if (table->first[middle + 1] <= entry) {
      lo = middle + 1;
    } else {
      hi = middle;
    }
  }
  return table->first ? lo : entry;
}

static inline stratus_table_arguments stratus_table_arguments_of(const stratus_table* table)
{
  return (stratus_table_arguments){ .scale = table->scale,
    .offset = table->offset,
    .last = (float)(table->cells - 1),
    .entries = table->size,
    .unit = stratus_table_unit(table),
    .jumps = table->jumps,
    .search_steps = table->search_steps,
    .first_at = (int)stratus_table_first_at(table),
    .bound_at = (int)stratus_table_bound_at(table),
    .widths_at = (int)stratus_table_widths_at(table),
    .shown_first = (float)stratus_table_cell_of_entry(table, table->next_shown[0]),
    .shown_beyond = table->last_shown < 0 ? 0.0f : (float)(stratus_table_cell_of_entry(table, table->last_shown) + 1),
    .tau_scale = table->sum_scale,
    .cut = table->cut,
    .color_slope = table->color_slope,
    .color_most = table->color_most,
    .has_opaque = table->has_opaque,
    .stretches = table->stretches,
    .stretches_at = (int)stratus_table_stretches_at(table),
    .stretch_steps = table->stretch_steps };
}

#endif
