/* SPDX-License-Identifier: BSD-3-Clause
 * Shared by the files of the hybrid tree's builder: the current node, and planes that may split it. Planes lie between bricks, so that they
 * cut none. */
#ifndef STRATUS_HYBRID_TREE_H
#define STRATUS_HYBRID_TREE_H

#include "tree.h"

/* A node to be split or made a leaf. Its bricks are order[first .. first+count-1], ascending. */
typedef struct hybrid_node {
  uint32_t number;
  uint32_t first, count;
  int32_t depth;
  int sparse;           /* paper: the side of a split without the peak, divided by surface area into leaves of bricks */
  int32_t lo[3], hi[3]; /* tight box of its bricks, [lo, hi) in bricks */
} hybrid_node;

typedef struct hybrid_build {
  stratus_context* context;
  const stratus_voxels* voxels;
  const stratus_tree_options* options;
  stratus_tree_statistics* statistics;
  stratus_tree_shape* shape;
  uint32_t node_max;        /* capacity of shape->nodes */
  uint32_t* scratch;        /* for partitions, one entry per brick */
  int64_t* counts;          /* along the longest axis, allocated for the first plane by density */
  stratus_density* density; /* of all bricks, or of `gathered` */
  stratus_brick* gathered;  /* bricks of one node, if each node gets a density of its own */
  double bandwidth;
  double volume; /* of the root, in bricks */
  int paper;
} hybrid_build;

typedef struct hybrid_plane {
  int axis;      /* -1: none */
  int32_t brick; /* bricks with at[axis] < brick are on the lower side */
  double cost;   /* surface area heuristic, in faces of bricks */
} hybrid_plane;

/* hybrid_planes.c */
double stratus_hybrid_plane_cost(const hybrid_build* build, const hybrid_node* node, int axis, int32_t brick);
hybrid_plane stratus_hybrid_plane_sah(const hybrid_build* build, const hybrid_node* node);
hybrid_plane stratus_hybrid_plane_median(const hybrid_build* build, const hybrid_node* node);
/* Counts the node's bricks below the plane. */
uint32_t stratus_hybrid_plane_below(const hybrid_build* build, const hybrid_node* node, const hybrid_plane* plane);
/* Moves the bricks below the plane to the front and keeps the order of each side. Fills `first`, `count` and the boxes of both sides, and
 * the boxes of their nodes. */
void stratus_hybrid_partition(
  hybrid_build* build, const hybrid_node* node, const hybrid_plane* plane, hybrid_node sides[2], stratus_tree_node boxes[2]);
/* Finds the box of the node's bricks, in bricks (`node`) and in voxels (`box`), both tight. */
void stratus_hybrid_tight_box(const hybrid_build* build, hybrid_node* node, stratus_tree_node* box);

/* hybrid_density.c: the peak of a node's density, and the deviation of its voxels from the peak. */
typedef struct hybrid_view {
  int32_t peak[3];
  double deviation[3]; /* eq. 8, voxels */
} hybrid_view;

stratus_status stratus_hybrid_measure(hybrid_build* build, const hybrid_node* node, hybrid_view* view);
/* Returns the greatest difference between two axes' deviations, relative to the node's extents, or in voxels as in the paper. */
double stratus_hybrid_unevenness(const hybrid_node* node, const hybrid_view* view, int paper);
/* Finds the plane by density. *clustered is 1 if it is a border of the peak's cluster. */
stratus_status stratus_hybrid_plane_density(
  hybrid_build* build, const hybrid_node* node, const hybrid_view* view, hybrid_plane* plane, int* clustered);

#endif
