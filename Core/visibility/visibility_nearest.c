/* SPDX-License-Identifier: BSD-3-Clause
 * Peels one leaf, nearest seeds first. Before a cell is listed, a depth-first search lists all cells that hide it, through faces or across
 * gaps (Williams 1992). A cell that the search meets while it waits itself closes a ring, and one relation of the ring is dropped. Where
 * rings across gaps or tests of gates become too many, gaps no longer count, and cells only wait for those that hide them through faces. */
#include "visibility_order.h"

/* The bits of `waiting`. Bits 0 to 3, a bit a face: the neighbour has to come first, and has not been looked at. */
#define FACES 0x0fu
#define STARTED 0x10u /* the cell waits, or is listed */
#define CAME 0x20u    /* the cell is listed */
#define GATES (STRATUS_GATE_IN | STRATUS_GATE_OUT)
#define STEPS_PER_GATE 32

typedef struct leaf_search {
  stratus_visibility_order* order;
  uint8_t* waiting;
  const int32_t* neighbours;
  uint32_t first;
  int64_t count, emitted, steps;
  int64_t face_rings, gap_rings, forced;
  uint32_t *out, *bottom; /* the stack of waiting cells, each waiting for the one above, grows down from `bottom`, the end of `out` */
  stratus_gates gates;
} leaf_search;

/* Which of the neighbours behind faces `asked` are not listed yet. Branches would be mispredicted half the time, so there are none. */
static inline unsigned still_to_come(const uint8_t* waiting, const int32_t neighbours[4], unsigned asked)
{
  const unsigned came = (waiting[neighbours[0]] & CAME) | (waiting[neighbours[1]] & CAME) << 1 | (waiting[neighbours[2]] & CAME) << 2 |
    (waiting[neighbours[3]] & CAME) << 3;
  return asked & ~(came / CAME);
}

/* The face through which `before` comes before a cell; -1: across a gap. */
static int face_towards(const stratus_visibility_order* order, uint32_t cell, uint32_t before)
{
  const unsigned faces = stratus_order_before(order, cell);
  int f = 3;
  while (f >= 0 && !(faces >> f & 1 && order->neighbours[4 * (int64_t)cell + f] == (int32_t)before)) {
    --f;
  }
  return f;
}

/* Chooses the relation of a ring to drop: one across a gap if there is any, else the one whose face is seen smallest. On the stack each
 * cell of the ring, from `top` to `last`, waits for the one above it, and the top one for `last`. Returns the place of the cell that waits
 * no more. */
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

/* Drops a relation of a ring: find_least() chooses it, or it is the top cell's once rings have taken too many steps. Cells above its cell
 * leave the stack, and wait anew. Returns the place of its cell, the new top. */
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

/* Lists a cell after all that it waits for. */
static void bring(leaf_search* search, uint32_t cell)
{
  uint8_t* const waiting = search->waiting; /* a local: stores to bytes may alias the struct, which would be read again after each */
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
    waiting[cell] = (uint8_t)((waits & GATES) | STARTED | (pending & (pending - 1))); /* the neighbour now looked at is no longer pending */
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
    if (i % 4 == 0) { /* the search reads the leaf's neighbours in random order: here they are still fetched in sequence */
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
  /* A ring through faces may also cross gaps in many places: rings across gaps count only where there is no other. */
  return (stratus_peel_counts){ .cycles = search.face_rings > 0 ? search.face_rings : search.gap_rings,
    .forced = search.forced,
    .overlaps = search.gap_rings,
    .gate_tests = search.gates.tests };
}
