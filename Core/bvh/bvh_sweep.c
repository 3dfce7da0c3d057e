/* SPDX-License-Identifier: BSD-3-Clause
 * Full-sweep surface area heuristic, top-down: every split is tried. Boxes are sorted once by their middles along each axis, and each split
 * keeps all three orders sorted. The other builders' trees are measured against this one. */
#include "bvh_build.h"

#include "radix_sort.h"

#include <string.h>

#define TASK_BOXES 1024 /* a smaller range stays with the thread that finds it */

typedef struct sweep {
  const stratus_box* boxes;
  stratus_bvh_pair* pairs;
  uint32_t* order[3]; /* ranks along each axis; a node owns the same range of all three */
  uint32_t* spare;    /* scratch; a node uses only its own range of this array and the next */
  double* right_cost;
  uint8_t* on_right; /* by rank */
  int max_depth;
} sweep;

typedef struct best_split {
  double cost;
  uint32_t uneven; /* difference between the counts of the two sides; the least breaks ties, so that boxes in one place split evenly */
  uint32_t middle;
  int axis;
} best_split;

static void sweep_axis(const sweep* s, uint32_t begin, uint32_t end, int axis, best_split* best)
{
  const uint32_t* order = s->order[axis];
  stratus_box right = stratus_box_none(), left = right;
  for (uint32_t i = end - 1; i > begin; --i) {
    stratus_box_add(&right, s->boxes + order[i]);
    s->right_cost[i] = stratus_box_area(&right) * (double)(end - i);
  }
  for (uint32_t i = begin + 1; i < end; ++i) {
    stratus_box_add(&left, s->boxes + order[i - 1]);
    const double cost = stratus_box_area(&left) * (double)(i - begin) + s->right_cost[i];
    const uint32_t uneven = i - begin > end - i ? (i - begin) - (end - i) : (end - i) - (i - begin);
    if (cost < best->cost || (cost == best->cost && uneven < best->uneven)) {
      *best = (best_split){ cost, uneven, i, axis };
    }
  }
}

/* Partitions the other two orders into the left and the right side; both remain sorted. */
static void part_orders(const sweep* s, uint32_t begin, uint32_t end, int axis, uint32_t middle)
{
  for (uint32_t i = begin; i < end; ++i) {
    s->on_right[s->order[axis][i]] = i >= middle;
  }
  for (int a = 0; a < 3; ++a) {
    uint32_t* order = s->order[a];
    uint32_t left = begin, right = middle;
    for (uint32_t i = begin; a != axis && i < end; ++i) {
      s->spare[s->on_right[order[i]] ? right++ : left++] = order[i];
    }
    if (a != axis) {
      memcpy(order + begin, s->spare + begin, (size_t)(end - begin) * sizeof *order);
    }
  }
}

static void split_ranks(const sweep* s, uint32_t begin, uint32_t end, int depth, uint32_t* child)
{
  for (; end - begin > 1; ++depth) {
    best_split best = { INFINITY, 0, begin + (end - begin) / 2, 0 };
    for (int a = 0; a < 3 && depth < s->max_depth && end - begin > 2; ++a) {
      sweep_axis(s, begin, end, a, &best);
    }
    const uint32_t middle = best.middle;
    part_orders(s, begin, end, best.axis, middle);
    stratus_bvh_pair* pair = s->pairs + (middle - 1); /* as in stratus_bvh_split_items() */
    *child = middle - 1;
#pragma omp task if (middle - begin >= TASK_BOXES)
    split_ranks(s, begin, middle, depth + 1, pair->child);
    child = pair->child + 1;
    begin = middle;
  }
  *child = STRATUS_BVH_LEAF | s->order[0][begin];
}

static stratus_status sort_axis(const stratus_bvh_build* build, int axis, uint64_t* keys, uint32_t* order)
{
#pragma omp parallel for schedule(static) num_threads(build->context->threads)
  for (uint32_t i = 0; i < build->count; ++i) {
    keys[i] = (uint64_t)((int64_t)stratus_box_middle(build->boxes + i, axis) + 2 * STRATUS_BVH_COORDINATE_MAX);
    order[i] = i;
  }
  return stratus_radix_sort(build->context, keys, order, build->count, 31);
}

stratus_status stratus_bvh_build_sweep(stratus_bvh_build* build)
{
  stratus_status status = STRATUS_OK;
  stratus_context* context = build->context;
  const uint32_t n = build->count;
  void *orders = NULL, *keys = NULL, *costs = NULL, *on_right = NULL;

  TRY_CLEANUP(stratus_allocate(context, n, 4 * sizeof(uint32_t), &orders));
  TRY_CLEANUP(stratus_allocate(context, n, sizeof(uint64_t), &keys));
  TRY_CLEANUP(stratus_allocate(context, n, 1, &on_right));
  uint32_t* order = orders;
  sweep s = { build->boxes, build->pairs, { order, order + n, order + 2 * (size_t)n }, order + 3 * (size_t)n, NULL, on_right,
    build->max_depth };
  for (int a = 0; a < 3; ++a) {
    TRY_CLEANUP(sort_axis(build, a, keys, s.order[a]));
  }
  stratus_release(context, keys);
  keys = NULL;
  TRY_CLEANUP(stratus_allocate(context, n, sizeof(double), &costs));
  s.right_cost = costs;
#pragma omp parallel num_threads(context->threads)
#pragma omp single
  split_ranks(&s, 0, n, 0, &build->root);

cleanup:
  stratus_release(context, orders);
  stratus_release(context, keys);
  stratus_release(context, costs);
  stratus_release(context, on_right);
  return status;
}
