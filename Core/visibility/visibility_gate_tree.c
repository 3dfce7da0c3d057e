/* SPDX-License-Identifier: BSD-3-Clause
 * A tree over exit gates, searched for one that hides an entry gate. Each node covers consecutive gates, which are near one another, by a
 * box in the view. A view of parallel rays has one side, a plane; a perspective view has six, the sides of a cube around the eye. */
#include "visibility_order.h"

/* A point's coordinates relative to a side of the cube: two along the side, and one towards it. */
static void turn_to(int side, const stratus_view_point* point, double turned[3])
{
  const double p[3] = { point->x, point->y, point->z };
  const int axis = side / 2;
  turned[0] = p[(axis + 1) % 3];
  turned[1] = p[(axis + 2) % 3];
  turned[2] = side % 2 ? -p[axis] : p[axis];
}

/* A side sees a face unless all three points lie beyond one of the side's four edges. */
static bool side_sees(int side, const stratus_view_point points[3])
{
  unsigned outside = 15;
  for (int i = 0; i < 3; ++i) {
    double p[3];
    turn_to(side, points + i, p);
    outside &= (unsigned)(p[0] > p[2]) | (unsigned)(-p[0] > p[2]) << 1 | (unsigned)(p[1] > p[2]) << 2 | (unsigned)(-p[1] > p[2]) << 3;
  }
  return outside == 0;
}

static void include(float box[4], double u, double v)
{
  box[0] = (float)u < box[0] ? (float)u : box[0];
  box[1] = (float)u > box[1] ? (float)u : box[1];
  box[2] = (float)v < box[2] ? (float)v : box[2];
  box[3] = (float)v > box[3] ? (float)v : box[3];
}

/* The side that a face lies wholly within; -1: the face reaches over an edge of the cube. */
static int only_side(const stratus_view_point points[3])
{
  const double x = fabs(points->x), y = fabs(points->y), z = fabs(points->z);
  const int side = x > y && x > z ? (points->x > 0.0 ? 0 : 1) : y > z ? (points->y > 0.0 ? 2 : 3) : points->z > 0.0 ? 4 : 5;
  for (int i = 0; i < 3; ++i) {
    double p[3];
    turn_to(side, points + i, p);
    if (!(fabs(p[0]) < p[2] && fabs(p[1]) < p[2])) {
      return -1;
    }
  }
  return side;
}

/* Boxes hold for one side: a gate that several sides see has none. */
static bool has_box(unsigned sides)
{
  return (sides & (sides - 1)) == 0;
}

void stratus_gate_see(const stratus_gates* gates, stratus_gate* gate, const stratus_view_point points[3])
{
  const int only = gates->parallel ? 0 : only_side(points);
  gate->box[0] = gate->box[2] = INFINITY;
  gate->box[1] = gate->box[3] = -INFINITY;
  if (only < 0) {
    gate->sides = 0;
    for (int side = 0; side < gates->sides; ++side) {
      gate->sides |= (uint8_t)(side_sees(side, points) << side);
    }
    if (has_box(gate->sides)) { /* the face is not wholly within that side: its box covers the side */
      include(gate->box, -INFINITY, -INFINITY);
      include(gate->box, INFINITY, INFINITY);
    }
    return;
  }
  gate->sides = (uint8_t)(1u << only);
  for (int i = 0; i < 3; ++i) {
    double p[3] = { points[i].x, points[i].y, 1.0 };
    if (!gates->parallel) {
      turn_to(only, points + i, p);
    }
    include(gate->box, p[0] / p[2], p[1] / p[2]);
  }
}

/* Whether a gate or node can hide `other`: it is not wholly behind it, and a side sees both, with boxes that overlap. */
static bool may_lie_before(float low, unsigned sides, const float box[4], const stratus_gate* other)
{
  const float* q = other->box;
  if (!(low < other->high) || !(sides & other->sides)) {
    return false;
  }
  return !has_box(sides) || !has_box(other->sides) || !(box[0] > q[1] || q[0] > box[1] || box[2] > q[3] || q[2] > box[3]);
}

static void cover(stratus_gate_node* node, float low, unsigned sides, const float box[4], uint32_t left)
{
  if (left > 0) {
    node->low = low < node->low ? low : node->low;
    node->sides |= (uint8_t)sides;
    include(node->box, box[0], box[2]);
    include(node->box, box[1], box[3]);
    node->left += left;
  }
}

void stratus_gates_build_tree(stratus_gates* gates)
{
  int64_t below = gates->count, begin = 0;
  gates->levels = 0;
  do {
    const int64_t count = (below + STRATUS_GATE_CHILDREN - 1) / STRATUS_GATE_CHILDREN;
    const stratus_gate_node* children = gates->levels > 0 ? gates->nodes + gates->level_begin[gates->levels - 1] : NULL;
    for (int64_t n = 0; n < count; ++n) {
      stratus_gate_node node = { .low = INFINITY, .box = { INFINITY, -INFINITY, INFINITY, -INFINITY } };
      for (int64_t c = STRATUS_GATE_CHILDREN * n; c < STRATUS_GATE_CHILDREN * (n + 1) && c < below; ++c) {
        if (children) {
          cover(&node, children[c].low, children[c].sides, children[c].box, children[c].left);
        } else if (gates->gates[c].facing > 0) {
          cover(&node, gates->gates[c].low, gates->gates[c].sides, gates->gates[c].box, 1);
        }
      }
      gates->nodes[begin + n] = node;
    }
    gates->level_begin[gates->levels++] = begin;
    begin += count;
    below = count;
  } while (below > 1);
}

int64_t stratus_gates_search(stratus_gates* gates, int64_t way_in)
{
  struct {
    int level;
    int64_t node;
  } stack[STRATUS_GATE_CHILDREN * STRATUS_GATE_LEVELS_MAX];
  const stratus_gate* other = gates->gates + way_in;
  const uint32_t cell = stratus_gate_cell(gates, way_in);
  int pending = 1;
  stack[0].level = gates->levels - 1;
  stack[0].node = 0;
  while (pending > 0 && gates->tests_left >= 0) {
    const int level = stack[--pending].level;
    const int64_t number = stack[pending].node, first = STRATUS_GATE_CHILDREN * number;
    const int64_t below = level > 0 ? gates->level_begin[level] - gates->level_begin[level - 1] : gates->count;
    const int64_t end = first + STRATUS_GATE_CHILDREN < below ? first + STRATUS_GATE_CHILDREN : below;
    gates->tests += end - first;
    gates->tests_left -= end - first;
    for (int64_t i = first; i < end; ++i) {
      if (level > 0) {
        const stratus_gate_node* node = gates->nodes + gates->level_begin[level - 1] + i;
        if (node->left > 0 && may_lie_before(node->low, node->sides, node->box, other)) {
          stack[pending].level = level - 1;
          stack[pending++].node = i;
        }
        continue;
      }
      const stratus_gate* gate = gates->gates + i;
      if (gate->facing > 0 && !gate->passed && may_lie_before(gate->low, gate->sides, gate->box, other) &&
        stratus_gate_cell(gates, i) != cell && stratus_gate_lies_before(gates, i, way_in)) {
        return i;
      }
    }
  }
  return -1;
}

void stratus_gates_take_from_tree(stratus_gates* gates, int64_t way_out)
{
  for (int level = 0; level < gates->levels; ++level) {
    way_out /= STRATUS_GATE_CHILDREN;
    --gates->nodes[gates->level_begin[level] + way_out].left;
  }
}
