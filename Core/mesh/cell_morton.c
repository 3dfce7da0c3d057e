/* SPDX-License-Identifier: BSD-3-Clause
 * Sorts cells by the Morton code of their place. The partition's leaves, the visibility order and the march through tetrahedra use it. */
#include "cell_morton.h"

#include "radix_sort.h"

#include "morton.h"

static uint32_t place_on_axis(double at, int bits)
{
  const uint32_t last = ((uint32_t)1 << bits) - 1;
  return at > 0.0 ? (at < (double)last ? (uint32_t)at : last) : 0;
}

stratus_status stratus_morton_order(stratus_context* context, const stratus_morton_cells* cells, uint32_t* order)
{
  void* memory;
  TRY(stratus_allocate(context, (size_t)cells->count, sizeof(uint64_t), &memory));
  uint64_t* keys = memory;
  const int bits = cells->axis_bits;
#pragma omp parallel for schedule(static) num_threads(context->threads)
  for (int64_t cell = 0; cell < cells->count; ++cell) {
    double at[3];
    const uint64_t group = cells->place(cells->data, cell, at);
    const uint64_t code = morton_code(place_on_axis(at[0], bits), place_on_axis(at[1], bits), place_on_axis(at[2], bits), 0);
    keys[cell] = group << 3 * bits | code;
    order[cell] = (uint32_t)cell;
  }
  const stratus_status status = stratus_radix_sort(context, keys, order, (uint32_t)cells->count, 3 * bits + cells->group_bits);
  stratus_release(context, keys);
  return status;
}
