/* SPDX-License-Identifier: BSD-3-Clause
 * Sums of the hybrid tree's builder on the host, a node after the other, nodes by threads. A node's bricks stay in ascending order, because
 * a density requires that order. */
#include "hybrid_tree.h"
#include "threads.h"

#include <string.h>

#define BRICK_NS 20.0 /* of one thread, for a brick of a sum */

/* Bits of a brick in its first layer along an axis, and how far the next layer's are shifted. */
static const uint64_t layer_bits[3] = { 0x1111111111111111u, 0x000f000f000f000fu, 0xffffu };
static const int layer_shift[3] = { 1, 4, 16 };

static int layer_count(uint64_t mask, int axis, int layer)
{
  return __builtin_popcountll(mask & layer_bits[axis] << layer_shift[axis] * layer);
}

static int threads_of(const hybrid_build* build, hybrid_work* const* works, uint32_t count)
{
  double bricks = 0.0;
  for (uint32_t w = 0; w < count; ++w) {
    bricks += works[w]->node.count;
  }
  const int threads = stratus_threads_for(build->context, BRICK_NS * bricks);
  return (uint32_t)threads < count ? threads : (int)count;
}

#define EACH_NODE                                                                                                                          \
  _Pragma("omp parallel for schedule(dynamic, 1) num_threads(threads_of(build, works, count))") for (uint32_t w = 0; w < count; ++w)

/* ---- density */

static void find_squares(const hybrid_build* build, hybrid_work* work)
{
  work->voxels = 0;
  work->squares[0] = work->squares[1] = work->squares[2] = 0.0;
  for (uint32_t i = 0; i < work->node.count; ++i) {
    const stratus_brick* b = hybrid_brick(build, &work->node, i);
    work->voxels += b->count;
    for (int a = 0; a < 3; ++a) {
      for (int layer = 0; layer < STRATUS_BRICK; ++layer) {
        const double d = STRATUS_BRICK * b->at[a] + layer - work->peak[a];
        work->squares[a] += layer_count(b->mask, a, layer) * d * d;
      }
    }
  }
}

static stratus_status peaks(hybrid_build* build, hybrid_work* const* works, uint32_t count, bool own)
{
  EACH_NODE
  {
    hybrid_work* work = works[w];
    const stratus_brick* bricks = own ? build->gathered : build->voxels->bricks;
    stratus_density_peak(build->density, bricks, own ? NULL : build->shape->order + work->node.first, work->node.count, work->peak);
    find_squares(build, work);
  }
  return STRATUS_OK;
}

static stratus_status lines(hybrid_build* build, hybrid_work* const* works, uint32_t count, stratus_density_line* to, size_t size)
{
  (void)size;
  EACH_NODE
  {
    const hybrid_work* work = works[w];
    stratus_density_sum_lines(build->voxels->bricks, build->shape->order + work->node.first, work->node.count, work->bandwidth,
      hybrid_exact(build), work->peak, work->lo, work->hi, to + work->at);
  }
  return STRATUS_OK;
}

static stratus_status histograms(hybrid_build* build, hybrid_work* const* works, uint32_t count, int64_t* counts, size_t size)
{
  memset(counts, 0, size * sizeof *counts);
  EACH_NODE
  {
    const hybrid_work* work = works[w];
    for (uint32_t i = 0; i < work->node.count; ++i) {
      const stratus_brick* b = hybrid_brick(build, &work->node, i);
      int64_t* const at = counts + work->at + (size_t)(STRATUS_BRICK * (b->at[work->axis] - work->node.lo[work->axis]));
      for (int layer = 0; layer < STRATUS_BRICK; ++layer) {
        at[layer] += layer_count(b->mask, work->axis, layer);
      }
    }
  }
  return STRATUS_OK;
}

/* ---- surface area */

static void grow(hybrid_bin* b, const stratus_brick* brick)
{
  ++b->count;
  for (int a = 0; a < 3; ++a) {
    const int32_t at = brick->at[a];
    b->lo[a] = at < b->lo[a] ? at : b->lo[a];
    b->hi[a] = at >= b->hi[a] ? at + 1 : b->hi[a];
  }
}

static stratus_status sides(hybrid_build* build, hybrid_work* const* works, uint32_t count)
{
  EACH_NODE
  {
    hybrid_work* work = works[w];
    for (int offer = 0; offer < work->offers; ++offer) {
      work->sides[offer][0] = work->sides[offer][1] = hybrid_no_bricks;
      for (uint32_t i = 0; i < work->node.count; ++i) {
        const stratus_brick* b = hybrid_brick(build, &work->node, i);
        grow(&work->sides[offer][b->at[work->axis] >= work->offered[offer]], b);
      }
    }
  }
  return STRATUS_OK;
}

static void fill_bins(const hybrid_build* build, const hybrid_node* node, hybrid_bin* bins)
{
  const int32_t used[3] = { hybrid_bins_along(node, 0), hybrid_bins_along(node, 1), hybrid_bins_along(node, 2) };
  for (int i = 0; i < used[0] + used[1] + used[2]; ++i) {
    bins[i] = hybrid_no_bricks;
  }
  for (uint32_t i = 0; i < node->count; ++i) {
    const stratus_brick* b = hybrid_brick(build, node, i);
    hybrid_bin* along = bins;
    for (int a = 0; a < 3; ++a) {
      grow(along + (b->at[a] - node->lo[a]) * used[a] / (node->hi[a] - node->lo[a]), b);
      along += used[a];
    }
  }
}

static stratus_status bins(hybrid_build* build, hybrid_work* const* works, uint32_t count, hybrid_bin* to, size_t size)
{
  (void)size;
  EACH_NODE
  {
    fill_bins(build, &works[w]->node, to + works[w]->at);
  }
  return STRATUS_OK;
}

/* ---- division */

/* Finds the first and the last layer along an axis that hold a voxel. */
static void find_ends(uint64_t mask, int axis, int32_t* first, int32_t* last)
{
  *first = 0;
  *last = STRATUS_BRICK - 1;
  while (!layer_count(mask, axis, *first)) {
    ++*first;
  }
  while (!layer_count(mask, axis, *last)) {
    --*last;
  }
}

/* Finds the box of the node's bricks, in bricks (`node`) and in voxels (`box`), both tight. */
static void find_box(const hybrid_build* build, hybrid_node* node, stratus_tree_node* box)
{
  hybrid_bin all = hybrid_no_bricks;
  for (int a = 0; a < 3; ++a) {
    box->lo[a] = INT32_MAX;
    box->hi[a] = 0;
  }
  for (uint32_t i = 0; i < node->count; ++i) {
    const stratus_brick* b = hybrid_brick(build, node, i);
    grow(&all, b);
    for (int a = 0; a < 3; ++a) {
      const int32_t at = STRATUS_BRICK * b->at[a];
      if (at < box->lo[a] || at + STRATUS_BRICK > box->hi[a]) {
        int32_t first, last;
        find_ends(b->mask, a, &first, &last);
        box->lo[a] = at + first < box->lo[a] ? at + first : box->lo[a];
        box->hi[a] = at + last >= box->hi[a] ? at + last + 1 : box->hi[a];
      }
    }
  }
  memcpy(node->lo, all.lo, sizeof node->lo);
  memcpy(node->hi, all.hi, sizeof node->hi);
}

static void divide_node(const hybrid_build* build, hybrid_work* work)
{
  const hybrid_node* node = &work->node;
  uint32_t *const order = build->shape->order + node->first, *const scratch = build->scratch + node->first;
  uint32_t below = 0, above = 0;
  for (uint32_t i = 0; i < node->count; ++i) {
    const uint32_t number = order[i];
    if (build->voxels->bricks[number].at[work->plane.axis] < work->plane.brick) {
      order[below++] = number;
    } else {
      scratch[above++] = number;
    }
  }
  memcpy(order + below, scratch, above * sizeof *order);
  work->child[0] = (hybrid_node){ .first = node->first, .count = below };
  work->child[1] = (hybrid_node){ .first = node->first + below, .count = above };
  for (int side = 0; side < 2; ++side) {
    find_box(build, &work->child[side], &work->box[side]);
  }
}

static stratus_status divide(hybrid_build* build, hybrid_work* const* works, uint32_t count)
{
  EACH_NODE
  {
    divide_node(build, works[w]);
  }
  return STRATUS_OK;
}

static stratus_status order(hybrid_build* build, uint32_t first, uint32_t count)
{
  (void)build;
  (void)first;
  (void)count;
  return STRATUS_OK;
}

const hybrid_sums stratus_hybrid_sums_host = { peaks, lines, histograms, sides, bins, divide, order };
