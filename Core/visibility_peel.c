/* SPDX-License-Identifier: BSD-3-Clause
 * Peeling of one leaf: a cell comes when all that hide it through faces have come. Of several that may come one of the nearest does,
 * by coarse buckets of distance, so that few have to be held back for others across gaps; or all of a layer do, as in the paper, and gaps are crossed as it comes. */
#include "visibility_order.h"

#include <string.h>

#define STEPS_PER_CELL 64 /* that searching for cycles may take, before the rest goes by distance */

typedef struct leaf_peel {
  stratus_visibility_order* order;
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
  int64_t unreleased, steps, gate_steps; /* cells listed before `unreleased` have come or are ready */
  bool faces_broken;
  stratus_peel_counts counts;
  stratus_gates gates; /* nearest */
} leaf_peel;

static inline uint32_t leaf_cell(const leaf_peel* peel, int64_t i)
{
  return peel->first + (uint32_t)i;
}

static inline void push(leaf_peel* peel, uint32_t cell, float key)
{
  if (peel->peeling == STRATUS_PEELING_LAYERS) {
    peel->out[peel->ready++] = cell;
    return;
  }
  stratus_ordered_cell* ordered = peel->order->ordered + cell;
  const int bucket = (int)((key - peel->low) * peel->scale);
  ordered->next = peel->heads[bucket];
  peel->heads[bucket] = cell;
  peel->nearest = bucket < peel->nearest ? bucket : peel->nearest;
  /* When it comes, these will be asked whether they wait for more: now it is known which. */
  for (int f = 0; f < 4; f++) {
    if (ordered->state >> f & 1) {
      STRATUS_FETCH(peel->order->ordered + ordered->neighbours[f]);
    }
  }
}

/* A cell that was in no list yet. */
static inline void push_first(leaf_peel* peel, uint32_t cell)
{
  push(peel, cell, peel->order->ordered[cell].key);
}

/* One that was held back. */
static inline void push_again(leaf_peel* peel, uint32_t cell)
{
  push(peel, cell, stratus_order_key(peel->order, cell));
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
      peel->heads[peel->nearest] = peel->order->ordered[cell].next;
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
    const float key = peel->order->ordered[leaf_cell(peel, i)].key;
    peel->low = key < peel->low ? key : peel->low;
    high = key > high ? key : high;
  }
  peel->buckets = (int)stratus_order_buckets(peel->count);
  /* Below the number of buckets whatever the rounding: the factor takes more off than two operations can add. */
  const float scale = (float)peel->buckets * (1.0f - 4.0f * 0x1p-23f) / (high - peel->low);
  peel->scale = high > peel->low && scale <= 0x1p100f ? scale : 0.0f;
  memset(peel->heads, 0xff, (size_t)peel->buckets * sizeof *peel->heads);
  peel->nearest = peel->buckets;
}

/* A cell that waits for neighbours, STRATUS_NO_CELL if none does. */
static uint32_t find_waiting(leaf_peel* peel)
{
  for (; peel->unreleased < peel->count; peel->unreleased++) {
    const uint32_t cell = leaf_cell(peel, peel->unreleased);
    if (stratus_order_waits_for(peel->order, cell) > 0) {
      return cell;
    }
  }
  return STRATUS_NO_CELL;
}

/* What is held back comes, the nearest or, if there were many, all. A ring of its own, unless one through faces was broken before: that one
 * may well lead across gaps in many places. */
static void yield_gate(leaf_peel* peel)
{
  do {
    push_again(peel, stratus_gates_yield(&peel->gates, &peel->gate_steps));
    peel->counts.cycles += !peel->faces_broken;
  } while (peel->gates.held > 0 && peel->gate_steps > STEPS_PER_CELL * peel->count);
}

/* Makes a cell ready, or all that are left, by distance. Of a ring that leads across gaps what is held back there gives way. */
static void unstick(leaf_peel* peel)
{
  stratus_visibility_order* order = peel->order;
  while (peel->steps < STEPS_PER_CELL * peel->count) {
    const uint32_t start = find_waiting(peel);
    const uint32_t cell = start == STRATUS_NO_CELL ? start : stratus_order_break_cycle(order, start, &peel->steps);
    if (cell == STRATUS_NO_CELL) {
      yield_gate(peel);
      return;
    }
    peel->counts.cycles++;
    peel->faces_broken = true;
    if (stratus_order_waits_for(order, cell) == 0) {
      order->ordered[cell].waiting &= (uint8_t)~STRATUS_GATE_IN; /* the ring may well lead across gaps, too */
      push_first(peel, cell);
      return;
    }
  }
  if (peel->gates.held > 0) {
    while (peel->gates.held > 0) {
      yield_gate(peel);
    }
    return;
  }
  for (int64_t i = peel->unreleased; i < peel->count; i++) {
    const uint32_t cell = leaf_cell(peel, i);
    if (stratus_order_waits_for(order, cell) > 0) {
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
  const int32_t* neighbours = order->ordered[cell].neighbours;
  const unsigned after = order->ordered[cell].state & 15u;
  for (int f = 0; f < 4; f++) {
    if (after >> f & 1 && (--order->ordered[neighbours[f]].waiting & 7) == 0) {
      push_first(peel, (uint32_t)neighbours[f]);
    }
  }
  if (order->ordered[cell].waiting & STRATUS_GATE_OUT) {
    for (uint32_t released = stratus_gates_pass(&peel->gates, cell), following; released != STRATUS_NO_CELL; released = following) {
      following = order->ordered[released].next;
      push_again(peel, released);
    }
  }
}

stratus_peel_counts stratus_order_peel_leaf(stratus_visibility_order* order, int32_t leaf, stratus_peeling peeling, uint32_t* heads)
{
  const int64_t begin = order->leaf_begin[leaf];
  leaf_peel peel = { .order = order,
    .first = (uint32_t)begin,
    .count = order->leaf_begin[leaf + 1] - begin,
    .out = order->cells + order->leaf_output[leaf],
    .peeling = peeling,
    .heads = heads };
  if (peeling == STRATUS_PEELING_NEAREST) {
    make_buckets(&peel);
    stratus_gates_open(&peel.gates, order, leaf);
  }
  /* From the back, as a bucket gives its last one first. */
  for (int64_t i = peel.count - 1; i >= 0; i--) {
    const uint32_t cell = leaf_cell(&peel, i);
    if (stratus_order_waits_for(order, cell) == 0) {
      push_first(&peel, cell);
    }
  }
  while (peel.emitted < peel.count) {
    const uint32_t cell = pop(&peel);
    if (cell == STRATUS_NO_CELL) {
      unstick(&peel);
    } else if (!(order->ordered[cell].waiting & STRATUS_GATE_IN) || !stratus_gates_hold(&peel.gates, cell)) {
      emit(&peel, cell);
    }
  }
  for (int64_t i = 0; i < peel.count && order->listed; i++) {
    peel.out[i] = order->listed[peel.out[i]];
  }
  return peel.counts;
}
