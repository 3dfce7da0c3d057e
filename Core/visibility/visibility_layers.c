/* SPDX-License-Identifier: BSD-3-Clause
 * Peels one leaf in layers (Li et al. 2012, section 3.1). The first layer is all cells that no neighbour hides; each next layer is all
 * cells that only cells of the layers before it hide. Relations across gaps are ignored. */
#include "visibility_order.h"

/* `out` holds the cells that are listed, up to `emitted`, then those that are ready, up to `ready`. The current layer ends at `layer_end`.
 * A cell's `waiting` counts the neighbours that come before it and are not listed yet. */
typedef struct leaf_peel {
  stratus_visibility_order* order;
  uint32_t first;
  int64_t count, emitted, ready, layer_end;
  uint32_t* out;
  int64_t unreleased, steps; /* the leaf's first `unreleased` cells are listed or ready */
  stratus_peel_counts counts;
} leaf_peel;

/* A cell that waits for a neighbour; STRATUS_NO_CELL: none does. */
static uint32_t find_waiting(leaf_peel* peel)
{
  for (; peel->unreleased < peel->count; ++peel->unreleased) {
    const uint32_t cell = peel->first + (uint32_t)peel->unreleased;
    if (peel->order->waiting[cell] > 0) {
      return cell;
    }
  }
  return STRATUS_NO_CELL;
}

/* A face through which a waiting cell waits for a neighbour that waits itself. When nothing is ready, every waiting cell has one. */
static int face_in_front(const stratus_visibility_order* order, uint32_t cell)
{
  const int32_t* neighbours = order->neighbours + 4 * (int64_t)cell;
  const unsigned before = stratus_order_before(order, cell);
  int f = 0;
  while (f < 3 && !(before >> f & 1 && order->waiting[neighbours[f]] > 0)) {
    ++f;
  }
  return f;
}

static uint32_t cell_in_front(const stratus_visibility_order* order, uint32_t cell)
{
  return (uint32_t)order->neighbours[4 * (int64_t)cell + face_in_front(order, cell)];
}

/* Nothing is ready, yet cells wait: some form a ring. Drops the ring's relation whose face is seen smallest, and returns the cell that
 * waited by it, which may still wait for others. */
static uint32_t break_cycle(leaf_peel* peel, uint32_t start)
{
  /* A walk from cell to the cell in front must meet a cell again. It compares with `kept`, which moves up whenever the walk's length has
   * doubled (Brent 1980). */
  stratus_visibility_order* order = peel->order;
  uint32_t kept = start, cell = cell_in_front(order, start);
  int64_t power = 1, length = 1;
  for (; kept != cell; ++length, ++peel->steps) {
    if (length == power) {
      kept = cell;
      power *= 2;
      length = 0;
    }
    cell = cell_in_front(order, cell);
  }
  uint32_t least = cell;
  double least_size = INFINITY;
  do {
    const double size = stratus_order_face_size(order, cell, face_in_front(order, cell));
    if (size < least_size) {
      least_size = size;
      least = cell;
    }
    cell = cell_in_front(order, cell);
    ++peel->steps;
  } while (cell != kept);
  stratus_order_cut(order, least, face_in_front(order, least));
  --order->waiting[least];
  ++peel->counts.cycles;
  return least;
}

/* Makes one cell ready by breaking rings; after too many steps lists all cells that are left, nearest seeds first. */
static void unstick(leaf_peel* peel, int32_t leaf, stratus_order_seed* seeds)
{
  stratus_visibility_order* order = peel->order;
  while (peel->steps < order->steps_per_cell * peel->count) {
    const uint32_t cell = break_cycle(peel, find_waiting(peel));
    if (order->waiting[cell] == 0) {
      peel->out[peel->ready++] = cell;
      return;
    }
  }
  stratus_order_sort_seeds(order, leaf, seeds);
  const uint32_t end = peel->first + (uint32_t)peel->count;
  for (int64_t s = 0; s < stratus_order_seed_count(peel->count); ++s) {
    for (uint32_t cell = seeds[s].first; cell < end && cell < seeds[s].first + STRATUS_SEED_CELLS; ++cell) {
      if (order->waiting[cell] > 0) {
        peel->out[peel->emitted++] = cell;
        ++peel->counts.forced;
      }
    }
  }
}

stratus_peel_counts stratus_order_leaf_layers(stratus_visibility_order* order, int32_t leaf, stratus_order_seed* seeds)
{
  const int64_t begin = order->leaf_begin[leaf];
  leaf_peel peel = {
    .order = order, .first = (uint32_t)begin, .count = order->leaf_begin[leaf + 1] - begin, .out = order->cells + order->leaf_output[leaf]
  };
  for (int64_t i = 0; i < peel.count; ++i) {
    const uint32_t cell = peel.first + (uint32_t)i;
    const unsigned before = stratus_order_before(order, cell);
    order->waiting[cell] = (uint8_t)stratus_order_count_faces(before);
    if (before == 0) {
      peel.out[peel.ready++] = cell;
    }
  }
  while (peel.emitted < peel.count) {
    if (peel.emitted == peel.ready) {
      unstick(&peel, leaf, seeds);
      continue;
    }
    if (peel.emitted == peel.layer_end) {
      peel.layer_end = peel.ready;
      ++peel.counts.layers;
    }
    const uint32_t cell = peel.out[peel.emitted++];
    const int32_t* neighbours = order->neighbours + 4 * (int64_t)cell;
    const unsigned after = stratus_order_after(order, cell);
    for (int f = 0; f < 4; ++f) {
      if (after >> f & 1 && --order->waiting[neighbours[f]] == 0) {
        peel.out[peel.ready++] = (uint32_t)neighbours[f];
      }
    }
  }
  return peel.counts;
}
