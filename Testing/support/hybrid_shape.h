/* SPDX-License-Identifier: BSD-3-Clause
 * Shapes of hybrid trees for tests, and the checks that each shape must pass. */
#ifndef STRATUS_TESTING_HYBRID_SHAPE_H
#define STRATUS_TESTING_HYBRID_SHAPE_H

#include "voxel_sets.h"
#include "tree.h"

typedef struct hybrid_shape {
  stratus_tree_shape shape;
  stratus_tree_statistics statistics;
  uint32_t fields, leaves, inner;
  int depth;
  int64_t most_in_leaf; /* bricks */
  double most_empty;    /* the most bricks that a field covers per occupied one */
} hybrid_shape;

static inline stratus_tree_options hybrid_options(stratus_tree_method method)
{
  return (stratus_tree_options){ .method = method,
    .max_depth = 32,
    .leaf_bricks = 4,
    .leaf_voxels = 1,
    .field_bricks = 1 << 25,
    .field_emptiness = 64.0,
    .uniform = 0.1,
    .paper_threshold = 8.0,
    .exact_density = method == STRATUS_TREE_HYBRID_PAPER,
    .density_per_node = method == STRATUS_TREE_HYBRID_PAPER };
}

/* Finds the tight box of `count` bricks of `order`, in voxels. */
static inline void plain_box(const stratus_voxels* voxels, const uint32_t* order, uint32_t count, int32_t lo[3], int32_t hi[3])
{
  for (int a = 0; a < 3; ++a) {
    lo[a] = INT32_MAX;
    hi[a] = 0;
  }
  for (uint32_t i = 0; i < count; ++i) {
    const stratus_brick* b = voxels->bricks + order[i];
    for (int bit = 0; bit < 64; ++bit) {
      const int32_t at[3] = { 4 * b->at[0] + bit % 4, 4 * b->at[1] + bit / 4 % 4, 4 * b->at[2] + bit / 16 };
      for (int a = 0; a < 3 && b->mask >> bit & 1; ++a) {
        lo[a] = at[a] < lo[a] ? at[a] : lo[a];
        hi[a] = at[a] >= hi[a] ? at[a] + 1 : hi[a];
      }
    }
  }
}

static inline void check_leaf(const stratus_tree_options* options, const stratus_tree_node* node, int depth, hybrid_shape* s)
{
  const uint32_t count = stratus_tree_node_count(node);
  double volume = 1.0;
  for (int a = 0; a < 3; ++a) {
    volume *= count ? (node->hi[a] - 1) / 4 - node->lo[a] / 4 + 1 : 0;
  }
  if (stratus_tree_node_kind(node) == STRATUS_NODE_FIELD) {
    assert_true(volume <= (double)options->field_bricks);
    s->most_empty = fmax(s->most_empty, volume / count);
    ++s->fields;
    if (options->method == STRATUS_TREE_HYBRID && depth < options->max_depth) {
      assert_true(volume <= options->field_emptiness * count);
    }
  } else {
    assert_int_equal(stratus_tree_node_kind(node), STRATUS_NODE_BRICKS);
    ++s->leaves;
    s->most_in_leaf = count > s->most_in_leaf ? count : s->most_in_leaf;
    assert_true(depth == options->max_depth || (int64_t)count <= options->leaf_bricks);
  }
}

/* Checks node n and all nodes below it. Returns how many bricks they hold, which must follow order[first]. */
static inline uint32_t check_node(
  const stratus_voxels* voxels, const stratus_tree_options* options, uint32_t n, uint32_t first, int depth, hybrid_shape* s)
{
  const stratus_tree_node* node = s->shape.nodes + n;
  uint32_t count;
  int32_t lo[3], hi[3];
  s->depth = depth > s->depth ? depth : s->depth;
  assert_true(depth <= options->max_depth);
  if (stratus_tree_node_kind(node) == STRATUS_NODE_INNER) {
    ++s->inner;
    assert_true(node->first > n && node->first + 1 < s->shape.node_count);
    count = check_node(voxels, options, node->first, first, depth + 1, s);
    assert_true(count > 0);
    const uint32_t above = check_node(voxels, options, node->first + 1, first + count, depth + 1, s);
    assert_true(above > 0);
    count += above;
  } else {
    count = stratus_tree_node_count(node);
    assert_int_equal(node->first, first);
    check_leaf(options, node, depth, s);
  }
  plain_box(voxels, s->shape.order + first, count, lo, hi);
  if (count) {
    assert_memory_equal(node->lo, lo, sizeof lo);
    assert_memory_equal(node->hi, hi, sizeof hi);
  }
  return count;
}

static inline void free_shape(stratus_context* context, hybrid_shape* s)
{
  stratus_release(context, s->shape.nodes);
  stratus_release(context, s->shape.order);
}

/* Makes a shape and checks that its order is a permutation of the bricks, each brick is in one leaf, boxes are tight, and leaves obey the
 * options. */
static inline hybrid_shape make_shape(stratus_context* context, const stratus_voxels* voxels, const stratus_tree_options* options)
{
  hybrid_shape s = { .depth = 0 };
  const size_t bricks = (size_t)voxels->brick_count;
  if (stratus_hybrid_tree_shape(context, voxels, options, &s.shape, &s.statistics) != STRATUS_OK) {
    fail_msg("%s", stratus_context_message(context));
  }
  uint8_t* seen = calloc(bricks + 1, 1);
  assert_non_null(seen);
  for (size_t i = 0; i < bricks; ++i) {
    assert_true(s.shape.order[i] < bricks);
    assert_int_equal(seen[s.shape.order[i]]++, 0);
  }
  free(seen);
  assert_int_equal(check_node(voxels, options, 0, 0, 0, &s), bricks);
  assert_int_equal(s.inner + s.fields + s.leaves, s.shape.node_count);
  assert_int_equal(
    s.statistics.dbscan_splits + s.statistics.density_splits + s.statistics.sah_splits + s.statistics.median_splits, s.inner);
  assert_true(strlen(s.statistics.why) > 20 && strlen(s.statistics.why) < sizeof s.statistics.why - 1);
  return s;
}

#endif
