/* SPDX-License-Identifier: BSD-3-Clause
 * Order across gaps. A ray may leave a cell into a gap and enter another cell behind it: the first cell's face then hides the second's. A
 * cell with an entry gate waits for every cell of its leaf that has an exit gate which hides this entry. */
#include "visibility_order.h"

#define DEPTH_SLACK 1e-12 /* exceeds rounding errors of depths near 0, as `seen` is scaled to 1 */

static double length_squared(double x, double y, double z)
{
  return x * x + y * y + z * z;
}

/* Sets a gate's depths: no point of its face is nearer than `low` or farther than `high`, whatever the rounding. */
static void find_depths(const stratus_gates* gates, stratus_gate* gate, const stratus_view_point points[3])
{
  const stratus_view_point *p = points, *q = points + 1, *r = points + 2;
  double low, high;
  if (gates->parallel) {
    low = stratus_smaller(stratus_smaller(p->z, q->z), r->z);
    high = stratus_larger(stratus_larger(p->z, q->z), r->z);
  } else { /* low: a ball around the face comes no nearer */
    const double x = (p->x + q->x + r->x) / 3.0, y = (p->y + q->y + r->y) / 3.0, z = (p->z + q->z + r->z) / 3.0;
    double radius = length_squared(p->x - x, p->y - y, p->z - z);
    radius = stratus_larger(radius, length_squared(q->x - x, q->y - y, q->z - z));
    radius = stratus_larger(radius, length_squared(r->x - x, r->y - y, r->z - z));
    high = stratus_larger(length_squared(p->x, p->y, p->z), length_squared(q->x, q->y, q->z));
    high = sqrt(stratus_larger(high, length_squared(r->x, r->y, r->z)));
    low = sqrt(length_squared(x, y, z)) - sqrt(radius);
  }
  gate->low = (float)(low - 1e-6 * fabs(low) - DEPTH_SLACK);
  gate->high = (float)(high + 1e-6 * fabs(high) + DEPTH_SLACK);
}

/* Bounds the work in a leaf. Each ring across gaps uses up some of it: overlapping cells make rings without end, and finding each passes
 * many cells. */
static void set_bounds(stratus_gates* gates, int64_t cells)
{
  gates->tests_left = (int64_t)(STRATUS_GATE_TESTS * (double)gates->count * sqrt((double)gates->count));
  gates->ring_tests = gates->tests_left / (STRATUS_GATE_RINGS + (int64_t)sqrt((double)cells)) + 1;
}

/* Where a leaf's nodes begin. The trees of the leaves before it have at most a seventh as many nodes as gates, and one more per level. */
static int64_t nodes_before(int64_t gates, int64_t leaf)
{
  return gates / (STRATUS_GATE_CHILDREN - 1) + STRATUS_GATE_LEVELS_MAX * leaf;
}

void stratus_gates_open(stratus_gates* gates, stratus_visibility_order* order, int32_t leaf)
{
  const int64_t first = order->gap_begin[leaf];
  *gates = (stratus_gates){ .order = order,
    .parallel = order->view.parallel,
    .sides = order->view.parallel ? 1 : 6,
    .faces = order->gap_faces + first,
    .count = order->gap_begin[leaf + 1] - first,
    .gates = order->gates + first,
    .nodes = order->gate_nodes + nodes_before(first, leaf) };
  set_bounds(gates, order->leaf_begin[leaf + 1] - order->leaf_begin[leaf]);
  int64_t ways_in = 0, ways_out = 0;
  for (int64_t g = 0; g < gates->count; ++g) {
    stratus_gate* gate = gates->gates + g;
    const unsigned state = (unsigned)order->state[stratus_gate_cell(gates, g)] >> gates->faces[g] % 4;
    stratus_view_point points[3];
    gate->facing = (int8_t)((int)(state & 1) - (int)(state >> 4 & 1));
    gate->passed = 0;
    ways_in += gate->facing < 0;
    ways_out += gate->facing > 0;
    if (gate->facing != 0) {
      stratus_gate_points(gates, g, points);
      find_depths(gates, gate, points);
      stratus_gate_see(gates, gate, points);
    }
  }
  if (ways_in == 0 || ways_out == 0) {
    return;
  }
  stratus_gates_build_tree(gates);
  for (int64_t g = 0; g < gates->count; ++g) {
    const int facing = gates->gates[g].facing;
    order->waiting[stratus_gate_cell(gates, g)] |= (uint8_t)(facing < 0 ? STRATUS_GATE_IN : facing > 0 ? STRATUS_GATE_OUT : 0);
  }
}

/* A cell's first gate; its other gates follow it. */
static int64_t first_gate(const stratus_gates* gates, uint32_t cell)
{
  int64_t gate = gates->order->gap_at[cell / STRATUS_GAP_BLOCK] - (gates->faces - gates->order->gap_faces);
  gate = gate > 0 ? gate : 0; /* the block may begin in the leaf before */
  while (gate < gates->count && stratus_gate_cell(gates, gate) < cell) {
    ++gate;
  }
  return gate;
}

/* Return the cell for which an entry waits; STRATUS_NO_CELL: none. */
static uint32_t cell_before(stratus_gates* gates, int64_t way_in)
{
  const int64_t way_out = gates->gates[way_in].facing < 0 ? stratus_gates_search(gates, way_in) : -1;
  return way_out < 0 ? STRATUS_NO_CELL : stratus_gate_cell(gates, way_out);
}

uint32_t stratus_gates_before(stratus_gates* gates, uint32_t cell)
{
  uint32_t before = STRATUS_NO_CELL;
  for (int64_t g = first_gate(gates, cell); before == STRATUS_NO_CELL && g < gates->count && stratus_gate_cell(gates, g) == cell; ++g) {
    before = cell_before(gates, g);
  }
  return before;
}

bool stratus_gates_cut(stratus_gates* gates, uint32_t cell, uint32_t before)
{
  bool cut = false;
  for (int64_t g = first_gate(gates, cell); g < gates->count && stratus_gate_cell(gates, g) == cell; ++g) {
    if (cell_before(gates, g) == before) {
      gates->gates[g].facing = 0;
      cut = true;
    }
  }
  gates->tests_left -= gates->ring_tests;
  return cut;
}

void stratus_gates_pass(stratus_gates* gates, uint32_t cell)
{
  for (int64_t g = first_gate(gates, cell); g < gates->count && stratus_gate_cell(gates, g) == cell; ++g) {
    gates->gates[g].passed = 1;
    if (gates->gates[g].facing > 0) {
      stratus_gates_take_from_tree(gates, g);
    }
  }
}

stratus_status stratus_gates_allocate(stratus_visibility_order* order, int64_t gaps)
{
  const size_t count = (size_t)gaps, nodes = (size_t)nodes_before(gaps, order->leaf_count);
  void* memory;
  TRY(stratus_order_allocate(order, count, sizeof *order->gates, &memory));
  order->gates = memory;
  TRY(stratus_order_allocate(order, nodes, sizeof *order->gate_nodes, &memory));
  order->gate_nodes = memory;
  return STRATUS_OK;
}
