/* SPDX-License-Identifier: BSD-3-Clause
 * Peeling of one leaf: a cell comes when all that hide it through faces have come. Of several that may come the nearest does, by buckets of
 * distance, which keeps cells in order that share no face; or all of a layer do, as in the paper. */
#include "visibility_order.h"

#include <string.h>

#define CELLS_PER_BUCKET 8
#define STEPS_PER_CELL 64 /* that searching for cycles may take, before the rest goes by distance */

typedef struct leaf_peel {
  stratus_visibility_order* order;
  const uint32_t* listed; /* NULL: first, first + 1, .. */
  uint32_t first;
  int64_t count, emitted;
  uint32_t* out;
  stratus_peeling peeling;
  /* nearest */
  uint32_t* heads;
  int buckets, nearest; /* no bucket before `nearest` holds a cell */
  float low, scale;
  /* layers: out[emitted..ready) may come, up to out[layer_end) in this layer */
  int64_t ready, layer_end;
  /* cycles */
  int64_t unreleased, steps; /* cells listed before `unreleased` have come or are ready */
  stratus_peel_counts counts;
} leaf_peel;

static inline uint32_t leaf_cell(const leaf_peel* peel, int64_t i)
{
  return peel->listed ? peel->listed[i] : peel->first + (uint32_t)i;
}

static inline void push(leaf_peel* peel, uint32_t cell)
{
  if (peel->peeling == STRATUS_PEELING_LAYERS) {
    peel->out[peel->ready++] = cell;
    return;
  }
  const int bucket = (int)((peel->order->key[cell] - peel->low) * peel->scale);
  peel->order->next[cell] = peel->heads[bucket];
  peel->heads[bucket] = cell;
  peel->nearest = bucket < peel->nearest ? bucket : peel->nearest;
}

/* STRATUS_NO_CELL if none is ready. */
static inline uint32_t pop(leaf_peel* peel)
{
  if (peel->peeling == STRATUS_PEELING_LAYERS) {
    if (peel->emitted == peel->ready) {
      return STRATUS_NO_CELL;
    }
    if (peel->emitted == peel->layer_end) {
      peel->layer_end = peel->ready;
      peel->counts.layers++;
    }
    return peel->out[peel->emitted];
  }
  while (peel->nearest < peel->buckets) {
    const uint32_t cell = peel->heads[peel->nearest];
    if (cell != STRATUS_NO_CELL) {
      peel->heads[peel->nearest] = peel->order->next[cell];
      return cell;
    }
    peel->nearest++;
  }
  return STRATUS_NO_CELL;
}

static void make_buckets(leaf_peel* peel)
{
  float high = -INFINITY;
  peel->low = INFINITY;
  for (int64_t i = 0; i < peel->count; i++) {
    const float key = peel->order->key[leaf_cell(peel, i)];
    peel->low = key < peel->low ? key : peel->low;
    high = key > high ? key : high;
  }
  const int64_t wanted = peel->count / CELLS_PER_BUCKET + 1;
  peel->buckets = (int)(wanted < STRATUS_BUCKETS_MAX ? wanted : STRATUS_BUCKETS_MAX);
  /* Below the number of buckets whatever the rounding: the factor takes more off than two operations can add. */
  const float scale = (float)peel->buckets * (1.0f - 4.0f * 0x1p-23f) / (high - peel->low);
  peel->scale = high > peel->low && scale <= 0x1p100f ? scale : 0.0f;
  memset(peel->heads, 0xff, (size_t)peel->buckets * sizeof *peel->heads);
  peel->nearest = peel->buckets;
}

/* Makes a cell ready, or all that are left, by distance. */
static void unstick(leaf_peel* peel)
{
  stratus_visibility_order* order = peel->order;
  while (peel->steps < STEPS_PER_CELL * peel->count) {
    while (order->waiting[leaf_cell(peel, peel->unreleased)] == 0) {
      peel->unreleased++;
    }
    const uint32_t cell = stratus_order_break_cycle(order, leaf_cell(peel, peel->unreleased), &peel->steps);
    peel->counts.cycles++;
    if (order->waiting[cell] == 0) {
      push(peel, cell);
      return;
    }
  }
  for (int64_t i = peel->unreleased; i < peel->count; i++) {
    const uint32_t cell = leaf_cell(peel, i);
    if (order->waiting[cell] > 0) {
      peel->out[peel->emitted++] = cell;
      peel->counts.forced++;
    }
  }
  stratus_order_sort_by_key(order, peel->out + peel->count - peel->counts.forced, peel->counts.forced);
}

static void emit(leaf_peel* peel, uint32_t cell)
{
  stratus_visibility_order* order = peel->order;
  peel->out[peel->emitted++] = cell;
  const int32_t* neighbours = order->adjacency->neighbours + 4 * (int64_t)cell;
  const unsigned after = order->state[cell] & 15u;
  for (int f = 0; f < 4; f++) {
    if (after >> f & 1 && --order->waiting[neighbours[f]] == 0) {
      push(peel, (uint32_t)neighbours[f]);
    }
  }
}

stratus_peel_counts stratus_order_peel_leaf(stratus_visibility_order* order, int32_t leaf, stratus_peeling peeling, uint32_t* heads)
{
  const int64_t begin = order->leaf_begin[leaf];
  leaf_peel peel = { .order = order,
    .listed = order->listed ? order->listed + begin : NULL,
    .first = (uint32_t)begin,
    .count = order->leaf_begin[leaf + 1] - begin,
    .out = order->cells + order->leaf_output[leaf],
    .peeling = peeling,
    .heads = heads };
  if (peeling == STRATUS_PEELING_NEAREST) {
    make_buckets(&peel);
  }
  /* From the back, as a bucket gives its last one first. */
  for (int64_t i = peel.count - 1; i >= 0; i--) {
    const uint32_t cell = leaf_cell(&peel, i);
    if (order->waiting[cell] == 0) {
      push(&peel, cell);
    }
  }
  while (peel.emitted < peel.count) {
    const uint32_t cell = pop(&peel);
    if (cell != STRATUS_NO_CELL) {
      emit(&peel, cell);
    } else {
      unstick(&peel);
    }
  }
  return peel.counts;
}
