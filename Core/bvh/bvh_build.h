/* SPDX-License-Identifier: BSD-3-Clause
 * What the builders of bounding volume hierarchies share. Each makes a binary tree down to single boxes, in whatever way is its own;
 * bvh_layout.c then gathers boxes into leaves where that is cheaper, bounds the depth and lays the nodes out. So builders differ in shape
 * only. */
#ifndef STRATUS_BVH_BUILD_H
#define STRATUS_BVH_BUILD_H

#include "bvh.h"

#define STRATUS_BVH_LEAF 0x80000000u
#define STRATUS_BVH_BOXES_MAX 0x1fffffffu
#define STRATUS_BVH_COORDINATE_MAX (1 << 28) /* differences of sums of two fit an int32_t */

/* An inner node. A child is the number of a pair, or STRATUS_BVH_LEAF | rank of a box. */
typedef struct stratus_bvh_pair {
  uint32_t child[2];
} stratus_bvh_pair;

/* Boxes in the order of their Morton codes, equal codes in the caller's order; a box's place there is its rank. */
typedef struct stratus_bvh_build {
  stratus_context* context;
  uint32_t count; /* of boxes, >= 2 where builders are called */
  int max_depth;  /* deeper a builder may split as it likes: the layout will split at the median */
  stratus_box* boxes;
  uint32_t* number;        /* the caller's, by rank */
  uint64_t* codes;         /* by rank */
  stratus_bvh_pair* pairs; /* count - 1, the builder's result: every box and every pair but the root is a child once */
  uint32_t root;
} stratus_bvh_build;

/* ---- bvh_morton.c */
/* Sorts boxes into `build`, whose context, count and max_depth are set. On failure what was allocated is the caller's to release. */
stratus_status stratus_bvh_sort_boxes(stratus_bvh_build* build, const stratus_box* boxes);

/* ---- bvh_device.c: the same to the bit as on the host. */
/* Whether the context's device should build structures, and can take as many boxes. */
bool stratus_device_takes_boxes(const stratus_context* context, uint32_t count);
/* least: of lo + hi; codes: count, in the order of boxes. */
stratus_status stratus_device_morton_codes(
  stratus_context* context, const stratus_box* boxes, uint32_t count, const int32_t least[3], int shift, uint64_t* codes);
stratus_status stratus_device_morton_hierarchy(stratus_context* context, const uint64_t* codes, uint32_t count, stratus_bvh_pair* pairs);

/* ---- builders: fill pairs and root */
stratus_status stratus_bvh_build_sah(stratus_bvh_build* build);
stratus_status stratus_bvh_build_sweep(stratus_bvh_build* build);
stratus_status stratus_bvh_build_lbvh(stratus_bvh_build* build);
stratus_status stratus_bvh_build_ploc(stratus_bvh_build* build);
stratus_status stratus_bvh_build_agglomerative(stratus_bvh_build* build);
stratus_status stratus_bvh_build_density_peaks(stratus_bvh_build* build);
stratus_status stratus_bvh_build_k_means(stratus_bvh_build* build);

/* bvh_density_peaks.c: each box's cluster by rank, numbered in the order of ranks; *clusters: how many. */
stratus_status stratus_bvh_density_clusters(const stratus_bvh_build* build, uint32_t* cluster, uint32_t* clusters);

/* A box and its rank, where a builder moves boxes. */
typedef struct stratus_bvh_item {
  stratus_box box;
  uint32_t rank;
} stratus_bvh_item;

stratus_status stratus_bvh_items_create(const stratus_bvh_build* build, stratus_bvh_item** items);
/* Binned SAH over items [begin, end), which it reorders. The pair that splits a range before item m is pair m - 1: every place splits once,
 * so pairs need no counter and no order of threads. *child: the range's root, as in a pair. To be called within a parallel region, by one
 * thread. */
void stratus_bvh_split_items(
  stratus_bvh_item* items, uint32_t begin, uint32_t end, int depth, int max_depth, stratus_bvh_pair* pairs, uint32_t* child);

/* Of a union of two clusters: how far they are from each other. */
typedef enum stratus_bvh_measure { STRATUS_BVH_SURFACE, STRATUS_BVH_EDGES } stratus_bvh_measure;

/* Locally optimal merging of 2 <= count boxes; pairs: count - 1, leaves are places in `boxes`. Near places win ties, so boxes come in an
 * order that keeps neighbours together. */
stratus_status stratus_bvh_agglomerate(
  stratus_context* context, stratus_bvh_measure measure, const stratus_box* boxes, uint32_t count, stratus_bvh_pair* pairs, uint32_t* root);
/* ---- bvh_join.c: joins consecutive ranges of items by a tree over the ranges: puts the ranges in the tree's order, fills the pairs of the
 * places between them, and tells where the root of each range is to be stored. */
typedef struct stratus_bvh_join {
  uint32_t ranges;            /* >= 2 */
  const stratus_bvh_pair* of; /* ranges - 1, over the ranges as they lie at first */
  uint32_t root;              /* in `of` */
  uint32_t* start;            /* ranges + 1, in items; changes with the order */
  uint32_t** child;           /* out: by range, as they lie at the end */
  uint32_t* room;             /* 3 * ranges + 1, for the function itself */
} stratus_bvh_join;
/* spare: a copy of the ranges' items finds room there, at the same places. *child: the root, as in a pair. */
void stratus_bvh_join_ranges(
  const stratus_bvh_join* join, stratus_bvh_item* items, stratus_bvh_item* spare, stratus_bvh_pair* pairs, uint32_t* child);

/* ---- bvh_layout.c: from pairs to nodes; leaf_boxes as in the options. */
stratus_status stratus_bvh_layout(const stratus_bvh_build* build, int leaf_boxes, stratus_bvh* bvh);

/* ---- small change */

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

/* Half of the surface. */
static inline double stratus_box_area(const stratus_box* box)
{
  const double x = (double)box->hi[0] - (double)box->lo[0], y = (double)box->hi[1] - (double)box->lo[1],
               z = (double)box->hi[2] - (double)box->lo[2];
  return x * y + y * z + z * x;
}

/* Twice the middle along an axis. */
static inline int32_t stratus_box_middle(const stratus_box* box, int axis)
{
  return box->lo[axis] + box->hi[axis];
}

#endif
