/* SPDX-License-Identifier: BSD-3-Clause
 * The leaves of the K-D tree. The tree is checked once. Each view walks it: at every plane the child on the eye's side comes first. */
#include "visibility_order.h"

#include <string.h>

#define FRAME_SLACK 1e-9 /* of the mesh's size: rounding moves points off a plane of a turned frame */

static stratus_status check_tree(stratus_context* context, const stratus_leaves* leaves)
{
  if (!leaves->nodes || !leaves->leaf) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "leaves: nodes or leaf is NULL");
  }
  if (leaves->leaf_count < 1 || leaves->leaf_count > STRATUS_LEAVES_MAX) {
    return stratus_fail(
      context, STRATUS_INVALID_ARGUMENT, "leaves: leaf_count %d outside 1..%d", (int)leaves->leaf_count, STRATUS_LEAVES_MAX);
  }
  if (leaves->node_count != 2 * leaves->leaf_count - 1) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "leaves: node_count %d, a tree of %d leaves has %d", (int)leaves->node_count,
      (int)leaves->leaf_count, 2 * (int)leaves->leaf_count - 1);
  }
  for (int i = 0; i < 9; ++i) {
    if (!isfinite(leaves->frame[i])) {
      return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "leaves: frame[%d] is %g, must be finite", i, leaves->frame[i]);
    }
  }
  for (int32_t n = 0; n < leaves->node_count; ++n) {
    const stratus_partition_node* node = leaves->nodes + n;
    const bool leaf = node->axis == -1 && node->below >= 0 && node->below < leaves->leaf_count;
    /* Children have higher numbers than their parents, so no node is its own ancestor. */
    const bool inner = node->axis >= 0 && node->axis < 3 && node->below > n && node->above > n && node->below < leaves->node_count &&
      node->above < leaves->node_count && node->below != node->above && isfinite(node->value);
    if (!leaf && !inner) {
      return stratus_fail(context, STRATUS_INVALID_ARGUMENT,
        "leaves: node %d is no leaf and no plane (axis %d, children %d and %d of %d, value %g)", (int)n, (int)node->axis, (int)node->below,
        (int)node->above, (int)leaves->node_count, node->value);
    }
  }
  return STRATUS_OK;
}

/* Fills boxes with 6 numbers a leaf, its box in the tree's frame, and refuses nodes or leaves that are not reached exactly once. */
static stratus_status find_boxes(stratus_context* context, const stratus_leaves* leaves, double* boxes, int32_t* parents)
{
  memset(parents, 0xff, (size_t)leaves->node_count * sizeof *parents);
  for (int32_t l = 0; l < leaves->leaf_count; ++l) {
    boxes[6 * l] = NAN;
  }
  for (int32_t n = 0; n < leaves->node_count; ++n) {
    const stratus_partition_node* node = leaves->nodes + n;
    const bool leaf = node->axis < 0;
    if ((n > 0 && parents[n] < 0) || (leaf && !isnan(boxes[6 * node->below])) ||
      (!leaf && (parents[node->below] >= 0 || parents[node->above] >= 0))) {
      return stratus_fail(
        context, STRATUS_INVALID_ARGUMENT, "leaves: node %d, its leaf or one of its children is reached more or less than once", (int)n);
    }
    if (!leaf) {
      parents[node->below] = parents[node->above] = n;
      continue;
    }
    double* box = boxes + 6 * node->below;
    for (int a = 0; a < 3; ++a) {
      box[2 * a] = -INFINITY;
      box[2 * a + 1] = INFINITY;
    }
    for (int32_t child = n, parent; (parent = parents[child]) >= 0; child = parent) {
      const stratus_partition_node* plane = leaves->nodes + parent;
      double* side = box + 2 * plane->axis + (plane->below == child);
      *side = plane->below == child ? fmin(*side, plane->value) : fmax(*side, plane->value);
    }
  }
  return STRATUS_OK;
}

static double frame_coordinate(const double frame[9], int axis, const double point[3])
{
  return frame[3 * axis] * point[0] + frame[3 * axis + 1] * point[1] + frame[3 * axis + 2] * point[2];
}

static bool frame_is_identity(const double frame[9])
{
  static const double identity[9] = { 1, 0, 0, 0, 1, 0, 0, 0, 1 };
  return memcmp(frame, identity, sizeof identity) == 0;
}

static stratus_status check_cells(const stratus_visibility_order* order, const stratus_leaves* leaves, const double* boxes)
{
  double size = 0.0;
  for (int i = 0; i < 6; ++i) {
    size = fmax(size, fabs(order->bounds[i]));
  }
  const bool turned = !frame_is_identity(leaves->frame);
  const double slack = (turned ? FRAME_SLACK : STRATUS_PLANE_TOLERANCE) * size;
  int64_t wrong = INT64_MAX;
#pragma omp parallel for schedule(static) num_threads(order->context->threads) reduction(min : wrong)
  for (int64_t cell = 0; cell < order->cell_count; ++cell) {
    const int32_t leaf = leaves->leaf[cell];
    bool right = leaf >= 0 && leaf < leaves->leaf_count;
    for (int i = 0; i < 12 && right; ++i) {
      const double* point = order->points + 3 * (int64_t)order->vertices[4 * cell + i / 3];
      const double* box = boxes + 6 * (int64_t)leaf + 2 * (i % 3);
      const double x = turned ? frame_coordinate(leaves->frame, i % 3, point) : point[i % 3];
      right = x >= box[0] - slack && x <= box[1] + slack;
    }
    wrong = !right && cell < wrong ? cell : wrong;
  }
  if (wrong != INT64_MAX) {
    return stratus_fail(order->context, STRATUS_INVALID_ARGUMENT, "leaves: cell %lld is not within the box of its leaf %d, of 0..%d",
      (long long)wrong, (int)leaves->leaf[wrong], (int)leaves->leaf_count - 1);
  }
  return STRATUS_OK;
}

static stratus_status allocate_leaves(stratus_visibility_order* order)
{
  void* memory;
  TRY(stratus_allocate(order->context, (size_t)order->node_count, sizeof *order->nodes, &memory));
  order->nodes = memory;
  TRY(stratus_allocate_zero(order->context, (size_t)order->leaf_count + 1, sizeof *order->leaf_begin, &memory));
  order->leaf_begin = memory;
  TRY(stratus_allocate_zero(order->context, (size_t)order->leaf_count, sizeof *order->leaf_output, &memory));
  order->leaf_output = memory;
  TRY(stratus_allocate_zero(order->context, (size_t)order->leaf_count, sizeof *order->leaf_order, &memory));
  order->leaf_order = memory;
  return STRATUS_OK;
}

stratus_status stratus_order_check_leaves(const stratus_visibility_order* order, const stratus_leaves* leaves)
{
  stratus_context* context = order->context;
  stratus_status status = STRATUS_OK;
  void *boxes = NULL, *parents = NULL;
  if (!leaves) {
    return STRATUS_OK;
  }
  TRY(check_tree(context, leaves));
  TRY_CLEANUP(stratus_allocate(context, (size_t)leaves->leaf_count, 6 * sizeof(double), &boxes));
  TRY_CLEANUP(stratus_allocate(context, (size_t)leaves->node_count, sizeof(int32_t), &parents));
  TRY_CLEANUP(find_boxes(context, leaves, boxes, parents));
  TRY_CLEANUP(check_cells(order, leaves, boxes));

cleanup:
  stratus_release(context, boxes);
  stratus_release(context, parents);
  return status;
}

stratus_status stratus_order_take_leaves(stratus_visibility_order* order, const stratus_leaves* leaves)
{
  if (!leaves) {
    order->node_count = order->leaf_count = 1;
    TRY(allocate_leaves(order));
    order->nodes[0] = (stratus_partition_node){ .axis = -1 };
    return stratus_order_take_cells(order, order->side, NULL);
  }
  order->node_count = leaves->node_count;
  order->leaf_count = leaves->leaf_count;
  memcpy(order->frame, leaves->frame, sizeof order->frame);
  TRY(allocate_leaves(order));
  memcpy(order->nodes, leaves->nodes, (size_t)leaves->node_count * sizeof *order->nodes);
  return stratus_order_take_cells(order, order->side, leaves->leaf);
}

bool stratus_order_sort_leaves(stratus_visibility_order* order, const stratus_view* view)
{
  /* The stack holds far children, fewer than there are leaves, so leaf_output has room for it. */
  int64_t* stack = order->leaf_output;
  int32_t found = 0, pending = 0;
  bool changed = false;
  for (int32_t n = 0; n >= 0;) {
    const stratus_partition_node* node = order->nodes + n;
    if (node->axis < 0) {
      changed = changed || order->leaf_order[found] != node->below;
      order->leaf_order[found++] = node->below;
      n = pending > 0 ? (int32_t)stack[--pending] : -1;
      continue;
    }
    const bool below_first = view->parallel ? frame_coordinate(order->frame, node->axis, view->direction) >= 0.0
                                            : frame_coordinate(order->frame, node->axis, view->eye) <= node->value;
    stack[pending++] = below_first ? node->above : node->below;
    n = below_first ? node->below : node->above;
  }
  int64_t output = 0;
  for (int32_t i = 0; i < order->leaf_count; ++i) {
    const int32_t leaf = order->leaf_order[i];
    order->leaf_output[leaf] = output;
    output += order->leaf_begin[leaf + 1] - order->leaf_begin[leaf];
  }
  return changed;
}
