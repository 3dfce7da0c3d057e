/* SPDX-License-Identifier: BSD-3-Clause
 * Declarations that the builders of bounding volume hierarchies share. Each builder makes a binary tree down to single boxes by a method of
 * its own. bvh_layout.c then gathers boxes into leaves where that is cheaper, limits the depth, and lays the nodes out. Builders therefore
 * differ only in the shape of their trees. */
#ifndef STRATUS_BVH_BUILD_H
#define STRATUS_BVH_BUILD_H

#include "bvh.h"

#define STRATUS_BVH_LEAF 0x80000000u
#define STRATUS_BVH_BOXES_MAX 0x1fffffffu
#define STRATUS_BVH_COORDINATE_MAX (1 << 28) /* sums of two coordinates, and differences of such sums, fit an int32_t */

/* An inner node. A child is the index of a pair, or STRATUS_BVH_LEAF | rank of a box. */
typedef struct stratus_bvh_pair {
  uint32_t child[2];
} stratus_bvh_pair;

/* Input and result of a builder. Boxes are in the order of their Morton codes; equal codes keep the caller's order. A box's rank is its
 * index in that order. */
typedef struct stratus_bvh_build {
  stratus_context* context;
  uint32_t count; /* number of boxes; builders are called with at least 2 */
  int max_depth;  /* below this depth the layout splits at the median, whatever the builder's split */
  stratus_bvh_measure measure;
  stratus_box* boxes;
  uint32_t* number;        /* index in the caller's boxes, for each rank */
  uint64_t* codes;         /* Morton code, for each rank */
  stratus_bvh_pair* pairs; /* count - 1 pairs, the builder's result: each box, and each pair except the root, is a child exactly once */
  uint32_t root;
} stratus_bvh_build;

/* ---- bvh_morton.c */
/* Sorts boxes into `build`, whose context, count and max_depth are set. After a failure the caller releases the arrays that it finds
 * there. */
stratus_status stratus_bvh_sort_boxes(stratus_bvh_build* build, const stratus_box* boxes);

/* ---- bvh_device.c, bvh_ploc_device.c, bvh_layout_device.c: give the same bits as the host */
/* True if the context's device builds structures and can hold so many boxes. */
bool stratus_device_takes_boxes(const stratus_context* context, uint32_t count);
/* Fills `count` codes in the order of the boxes. least: the least lo + hi of all boxes along each axis. */
stratus_status stratus_device_morton_codes(
  stratus_context* context, const stratus_box* boxes, uint32_t count, const int32_t least[3], int shift, uint64_t* codes);
stratus_status stratus_device_morton_hierarchy(stratus_context* context, const uint64_t* codes, uint32_t count, stratus_bvh_pair* pairs);
/* boxes: sorted by their codes. */
stratus_status stratus_device_ploc(stratus_context* context, const stratus_box* boxes, uint32_t count, stratus_bvh_pair* pairs);
/* True if the context's device builds structures, has double, and can hold the layout of so many boxes. */
bool stratus_device_takes_layout(const stratus_context* context, uint32_t count);
/* Sets *done, and the hierarchy, unless the tree is deeper than build->max_depth, which the host bounds, or 128 levels before subtrees
 * become leaves. */
stratus_status stratus_device_layout(const stratus_bvh_build* build, int leaf_boxes, stratus_bvh* bvh, bool* done);

/* ---- builders: each fills pairs and root */
stratus_status stratus_bvh_build_sah(stratus_bvh_build* build);
stratus_status stratus_bvh_build_sweep(stratus_bvh_build* build);
stratus_status stratus_bvh_build_lbvh(stratus_bvh_build* build);
stratus_status stratus_bvh_build_ploc(stratus_bvh_build* build);
stratus_status stratus_bvh_build_agglomerative(stratus_bvh_build* build);
stratus_status stratus_bvh_build_density_peaks(stratus_bvh_build* build);
stratus_status stratus_bvh_build_k_means(stratus_bvh_build* build);

/* Fills each box's cluster by rank (bvh_density_peaks.c). Clusters are numbered in the order of their first ranks. *clusters is their
 * number. */
stratus_status stratus_bvh_density_clusters(const stratus_bvh_build* build, uint32_t* cluster, uint32_t* clusters);

/* A box and its rank, for builders that reorder boxes. */
typedef struct stratus_bvh_item {
  stratus_box box;
  uint32_t rank;
} stratus_bvh_item;

stratus_status stratus_bvh_items_create(const stratus_bvh_build* build, stratus_bvh_item** items);
/* Splits items [begin, end) by the binned surface area heuristic (SAH) and reorders them. A split before item m becomes pair m - 1. Each
 * position splits at most once, so that pairs need no counter and do not depend on the order of threads. *child receives the range's root,
 * as in a pair. One thread of a parallel region calls this function. */
void stratus_bvh_split_items(
  stratus_bvh_item* items, uint32_t begin, uint32_t end, int depth, int max_depth, stratus_bvh_pair* pairs, uint32_t* child);

/* Merges clusters that are each other's nearest, beginning with `count` >= 2 boxes. Fills count - 1 pairs, whose leaves are indices in
 * `boxes`. Ties go to boxes with near indices, so the boxes' order should keep neighbours together. */
stratus_status stratus_bvh_agglomerate(
  stratus_context* context, stratus_bvh_measure measure, const stratus_box* boxes, uint32_t count, stratus_bvh_pair* pairs, uint32_t* root);
/* ---- bvh_join.c: joins consecutive ranges of items by a tree over the ranges. The function reorders the ranges to the order of that tree,
 * fills the pairs that split between them, and reports the address for each range's root. */
typedef struct stratus_bvh_join {
  uint32_t ranges;            /* >= 2 */
  const stratus_bvh_pair* of; /* ranges - 1 pairs; their leaves are indices of ranges in the original order */
  uint32_t root;              /* index of the root in `of` */
  uint32_t* start;            /* first item of each range, and the end: ranges + 1 numbers; updated with the order */
  uint32_t** child;           /* result: where to store the root of each range, in the new order */
  uint32_t* room;             /* scratch of 3 * ranges + 1 numbers */
} stratus_bvh_join;
/* spare: scratch for a copy of the items, at the same indices. *child: the root, as in a pair. */
void stratus_bvh_join_ranges(
  const stratus_bvh_join* join, stratus_bvh_item* items, stratus_bvh_item* spare, stratus_bvh_pair* pairs, uint32_t* child);

/* ---- bvh_layout.c: turns pairs into nodes; leaf_boxes as in the options */
stratus_status stratus_bvh_layout(const stratus_bvh_build* build, int leaf_boxes, stratus_bvh* bvh);

/* ---- helpers */

static inline void stratus_box_add(stratus_box* box, const stratus_box* other)
{
  for (int a = 0; a < 3; ++a) {
    box->lo[a] = other->lo[a] < box->lo[a] ? other->lo[a] : box->lo[a];
    box->hi[a] = other->hi[a] > box->hi[a] ? other->hi[a] : box->hi[a];
  }
}

static inline stratus_box stratus_box_none(void)
{
  return (stratus_box){ { INT32_MAX, INT32_MAX, INT32_MAX }, { INT32_MIN, INT32_MIN, INT32_MIN } };
}

/* Half of the box's surface area. */
static inline double stratus_box_area(const stratus_box* box)
{
  const double x = (double)box->hi[0] - (double)box->lo[0], y = (double)box->hi[1] - (double)box->lo[1],
               z = (double)box->hi[2] - (double)box->lo[2];
  return x * y + y * z + z * x;
}

/* Twice the box's middle along an axis. */
static inline int32_t stratus_box_middle(const stratus_box* box, int axis)
{
  return box->lo[axis] + box->hi[axis];
}

#endif
