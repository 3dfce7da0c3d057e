/* SPDX-License-Identifier: BSD-3-Clause
 * Bounding volume hierarchies: the nodes that all trees share, and a hierarchy over boxes. */
#ifndef STRATUS_BVH_H
#define STRATUS_BVH_H

#include "stratus/tree.h"
#include "base.h"

/* A node and its box, [lo, hi) in voxels. The root is node 0. The children of an inner node are `first` and `first + 1`. A leaf of bricks
 * holds the tree's bricks first .. first + count - 1. A leaf of a distance field holds fields[first]. kind_count is kind << 30 | count.
 * Host and device use the same bytes. */
typedef struct stratus_tree_node {
  int32_t lo[3], hi[3];
  uint32_t first;
  uint32_t kind_count;
} stratus_tree_node;

#define STRATUS_NODE_COUNT_MAX 0x3fffffffu

static inline stratus_node_kind stratus_tree_node_kind(const stratus_tree_node* node)
{
  return (stratus_node_kind)(node->kind_count >> 30);
}
static inline uint32_t stratus_tree_node_count(const stratus_tree_node* node)
{
  return node->kind_count & STRATUS_NODE_COUNT_MAX;
}
static inline uint32_t stratus_tree_kind_count(stratus_node_kind kind, uint32_t count)
{
  return (uint32_t)kind << 30 | count;
}

/* A hierarchy over boxes as a builder makes it: nodes, and the boxes' numbers in the order of the leaves. A leaf holds order[first .. first
 * + count - 1]. */
typedef struct stratus_bvh {
  stratus_tree_node* nodes; /* node_count of them; the capacity is 2*boxes - 1 */
  uint32_t node_count;
  uint32_t* order; /* one entry for each box */
} stratus_bvh;

typedef struct stratus_box {
  int32_t lo[3], hi[3]; /* [lo, hi) in voxels */
} stratus_box;

/* Distance of two clusters: the size of their union, as its surface area or the sum of its edges. */
typedef enum stratus_bvh_measure { STRATUS_BVH_SURFACE, STRATUS_BVH_EDGES } stratus_bvh_measure;

typedef struct stratus_bvh_options {
  stratus_tree_method method; /* STRATUS_TREE_SAH to STRATUS_TREE_KMEANS */
  int leaf_boxes;             /* most boxes in a leaf, 1..64 */
  /* 1..64. A node at this depth becomes a leaf where leaf_boxes allows it. Otherwise it is split at the median of the boxes' Morton order,
   * and its depth is not limited. */
  int max_depth;
  stratus_bvh_measure measure; /* of STRATUS_TREE_AC; the other methods ignore it */
} stratus_bvh_options;

/* Builds a hierarchy by any of these methods: 1 <= count < 2^29, lo < hi, coordinates within 2^28 (bvh.c). Boxes may overlap and repeat.
 * The tree does not depend on the number of threads or the device. On failure *bvh is unchanged. */
stratus_status stratus_bvh_create(
  stratus_context* context, const stratus_box* boxes, uint32_t count, const stratus_bvh_options* options, stratus_bvh* bvh);
void stratus_bvh_release(stratus_context* context, stratus_bvh* bvh);
/* Checks that every box is in exactly one leaf, that node boxes are tight, and that children come after their parents. */
stratus_status stratus_bvh_check(stratus_context* context, const stratus_bvh* bvh, const stratus_box* boxes, uint32_t count);
/* Returns the surface area heuristic over the root's area: an inner node costs 1, a leaf 1 for each box, a distance field 1. */
double stratus_bvh_sah(const stratus_tree_node* nodes, uint32_t node_count);

#endif
