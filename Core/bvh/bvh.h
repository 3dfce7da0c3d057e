/* SPDX-License-Identifier: BSD-3-Clause
 * Bounding volume hierarchies: the nodes that all trees share, and a hierarchy over boxes. */
#ifndef STRATUS_BVH_H
#define STRATUS_BVH_H

#include "stratus/tree.h"
#include "base.h"

/* [lo, hi) in voxels. Children of an inner node are `first` and `first + 1`; a leaf of bricks has bricks first .. first + count - 1 of the
 * tree's; a leaf of a distance field is fields[first]. kind_count: kind << 30 | count. The root is node 0. The same bytes on host and
 * device. */
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

/* A hierarchy over boxes as a builder leaves it: nodes, and the boxes' numbers in the leaves' order (leaf: order[first .. first+count-1]).
 */
typedef struct stratus_bvh {
  stratus_tree_node* nodes; /* of node_count_max = 2*boxes - 1 */
  uint32_t node_count;
  uint32_t* order; /* of `boxes` */
} stratus_bvh;

typedef struct stratus_box {
  int32_t lo[3], hi[3]; /* [lo, hi) in voxels */
} stratus_box;

typedef struct stratus_bvh_options {
  stratus_tree_method method; /* SAH .. KMEANS */
  int leaf_boxes;             /* most boxes a leaf, 1..64 */
  int max_depth; /* 1..64: deeper is made a leaf where leaf_boxes allows it, else split at the median (of the boxes' Morton order),
                  * whatever the depth */
} stratus_bvh_options;

/* bvh.c: any builder, 1 <= count < 2^29, lo < hi, coordinates within 2^28. Boxes may overlap and repeat. The same tree at any thread count
 * and on any device. On failure *bvh is untouched. */
stratus_status stratus_bvh_create(
  stratus_context* context, const stratus_box* boxes, uint32_t count, const stratus_bvh_options* options, stratus_bvh* bvh);
void stratus_bvh_release(stratus_context* context, stratus_bvh* bvh);
/* Every box in exactly one leaf, node boxes tight, children behind their parents. */
stratus_status stratus_bvh_check(stratus_context* context, const stratus_bvh* bvh, const stratus_box* boxes, uint32_t count);
/* Surface area heuristic over the root's area: an inner node costs 1, a leaf 1 a box, a distance field 1. */
double stratus_bvh_sah(const stratus_tree_node* nodes, uint32_t node_count);

#endif
