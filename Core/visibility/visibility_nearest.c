/* SPDX-License-Identifier: BSD-3-Clause
 * One leaf's cells, nearest first by steps of some: each comes after all that hide it, through faces or across gaps, which are looked for
 * depth first (Williams 1992). A cell that is met while it waits itself closes a ring, which loses a relation. Where rings across gaps, or
 * what has to be looked at to find what hides a cell there, are too many, no gap is looked across any more: cells come after those that
 * hide them through faces. */
#include "visibility_order.h"

/* `waiting` of a cell. Bits 0 to 3: neighbours that may have to come before it and were not asked yet. */
#define FACES 0x0fu
#define STARTED 0x10u /* it waits, or has come */
#define CAME 0x20u
#define GATES (STRATUS_GATE_IN | STRATUS_GATE_OUT)
#define STEPS_PER_GATE 32

typedef struct leaf_search {
  stratus_visibility_order* order;
  uint8_t* waiting;
  const int32_t* neighbours;
  uint32_t first;
  int64_t count, emitted, steps;
  int64_t face_rings, gap_rings, forced;
  uint32_t *out, *bottom; /* cells that wait for the one on top of them are kept where the last ones will come to stand: top..bottom */
  stratus_gates gates;
} leaf_search;

/* Of the neighbours asked for, those that have not come. Without branches: they would be guessed wrong half the time. */
static inline unsigned still_to_come(const uint8_t* waiting, const int32_t neighbours[4], unsigned asked)
{
  const unsigned came = (waiting[neighbours[0]] & CAME) | (waiting[neighbours[1]] & CAME) << 1 | (waiting[neighbours[2]] & CAME) << 2 |
    (waiting[neighbours[3]] & CAME) << 3;
  return asked & ~(came / CAME);
}

/* The face through which `before` comes before a cell, -1: it does across a gap. */
static int face_towards(const stratus_visibility_order* order, uint32_t cell, uint32_t before)
{
  const unsigned faces = stratus_order_before(order, cell);
  int f = 3;
  while (f >= 0 && !(faces >> f & 1 && order->neighbours[4 * (int64_t)cell + f] == (int32_t)before)) {
    --f;
  }
  return f;
}

/* The relation of a ring that gives way: across a gap if any is, else the one that is seen smallest. The cells from `top` down to `last`
 * wait each for the one above, and top's for `last`. Returns the place of the cell that waited. */
static uint32_t* find_least(leaf_search* search, uint32_t* top, uint32_t last)
{
  const stratus_visibility_order* order = search->order;
  uint32_t *least = top, before = last;
  double least_size = INFINITY;
  for (uint32_t* at = top;; before = *at++) {
    const int face = face_towards(order, *at, before);
    const double size = face < 0 ? -1.0 : stratus_order_face_size(order, *at, face);
    if (size < least_size) {
      least_size = size;
      least = at;
    }
    ++search->steps;
    if (*at == last) {
      return least;
    }
  }
}

/* One of a ring waits no more: see find_least(), or, if rings were too many to look at whole, the one on top. What it waited for has to be
 * looked for again. Returns its place, which is on top now. */
static uint32_t* break_ring(leaf_search* search, uint32_t* top, uint32_t last)
{
  stratus_visibility_order* order = search->order;
  uint32_t* const least = search->steps > order->steps_per_cell * search->count ? top : find_least(search, top, last);
  const uint32_t before = least == top ? last : least[-1];
  const int face = face_towards(order, *least, before);
  for (; top < least; ++top) {
    const unsigned gates = search->waiting[*top] & GATES;
    search->waiting[*top] = (uint8_t)(gates | stratus_order_before(order, *top));
    search->steps += gates & STRATUS_GATE_IN ? STEPS_PER_GATE : 1;
  }
  if (face >= 0) {
    stratus_order_cut(order, *least, face);
    ++search->face_rings;
    return least;
  }
  if (!stratus_gates_cut(&search->gates, *least, before)) {
    search->waiting[*least] &= (uint8_t)~STRATUS_GATE_IN;
  }
  ++search->gap_rings;
  return least;
}

/* All that a cell has to wait for, and itself. */
static void bring(leaf_search* search, uint32_t cell)
{
  uint8_t* const waiting = search->waiting; /* bytes might be anything's: what is not a local is read again after each */
  const int32_t* const neighbours = search->neighbours;
  uint32_t *top = search->bottom, *out = search->out + search->emitted;
  uint32_t* const bottom = top;
  for (;;) {
    const unsigned waits = waiting[cell];
    const int32_t* const around = neighbours + 4 * (int64_t)cell;
    const unsigned pending = waits & FACES ? still_to_come(waiting, around, waits & FACES) : 0;
    uint32_t before = STRATUS_NO_CELL;
    if (pending) {
      before = (uint32_t)around[__builtin_ctz(pending)];
    } else if (waits & STRATUS_GATE_IN) {
      before = stratus_gates_before(&search->gates, cell);
      search->forced += before == STRATUS_NO_CELL && search->gates.tests_left < 0;
    }
    if (before == STRATUS_NO_CELL) {
      waiting[cell] = STARTED | CAME;
      *out++ = cell;
      if (waits & STRATUS_GATE_OUT) {
        stratus_gates_pass(&search->gates, cell);
      }
      if (top == bottom) {
        break;
      }
      cell = *top++;
      continue;
    }
    waiting[cell] = (uint8_t)((waits & GATES) | STARTED | (pending & (pending - 1))); /* not to be asked for again */
    *--top = cell;
    cell = before;
    if (waiting[cell] & STARTED) {
      top = break_ring(search, top, cell);
      cell = *top++;
    }
  }
  search->emitted = out - search->out;
}

static void begin_leaf(leaf_search* search, int32_t leaf)
{
  stratus_visibility_order* order = search->order;
  for (int64_t i = 0; i < search->count; ++i) {
    const uint32_t cell = search->first + (uint32_t)i;
    search->waiting[cell] = (uint8_t)stratus_order_before(order, cell);
    if (i % 4 == 0) { /* the whole leaf's are asked for at random soon: now the memory can still be read in a row */
      STRATUS_FETCH(search->neighbours + 4 * (int64_t)cell);
    }
  }
  stratus_gates_open(&search->gates, order, leaf);
}

stratus_peel_counts stratus_order_leaf_nearest(stratus_visibility_order* order, int32_t leaf, stratus_order_seed* seeds)
{
  const int64_t begin = order->leaf_begin[leaf];
  leaf_search search = { .order = order,
    .waiting = order->waiting,
    .neighbours = order->neighbours,
    .first = (uint32_t)begin,
    .count = order->leaf_begin[leaf + 1] - begin,
    .out = order->cells + order->leaf_output[leaf] };
  search.bottom = search.out + search.count;
  begin_leaf(&search, leaf);
  stratus_order_sort_seeds(order, leaf, seeds);
  const uint32_t end = search.first + (uint32_t)search.count;
  for (int64_t s = 0; s < stratus_order_seed_count(search.count); ++s) {
    for (uint32_t cell = seeds[s].first; cell < end && cell < seeds[s].first + STRATUS_SEED_CELLS; ++cell) {
      if (!(search.waiting[cell] & CAME)) {
        bring(&search, cell);
      }
    }
  }
  /* One through faces may well lead across gaps in many places. */
  return (stratus_peel_counts){ .cycles = search.face_rings > 0 ? search.face_rings : search.gap_rings,
    .forced = search.forced,
    .overlaps = search.gap_rings,
    .gate_tests = search.gates.tests };
}
