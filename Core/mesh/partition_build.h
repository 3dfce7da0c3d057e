/* SPDX-License-Identifier: BSD-3-Clause
 * Types and functions that the partition's files share. While the mesh is being cut, the leaves of the K-D tree hold their cells. */
#ifndef STRATUS_PARTITION_BUILD_H
#define STRATUS_PARTITION_BUILD_H

#include "mesh.h"

typedef struct stratus_kdtree_cell {
  int32_t vertex[4];
  int32_t origin; /* the mesh's cell */
} stratus_kdtree_cell;

typedef struct stratus_kdtree_node {
  stratus_kdtree_cell* cells; /* a leaf's; NULL in inner nodes */
  int64_t count;
  size_t capacity;
  double box[6]; /* bounds by the planes above it, in the frame */
  stratus_partition_node plane;
} stratus_kdtree_node;

struct stratus_partition {
  stratus_context* context;
  stratus_partition_options options;
  double frame[9];
  stratus_kdtree_node* nodes;
  size_t node_capacity;
  int32_t node_count, leaf_count;

  double* points;
  double* along;    /* the points in the frame; `points` itself while the frame is the identity */
  double tolerance; /* points at most this far from a plane are on it */
  size_t point_capacity, along_capacity;
  int64_t point_count, old_points;
  int32_t* ends;
  size_t ends_capacity;
  double* weights;
  size_t weights_capacity;

  uint8_t* cut; /* for each of the mesh's cells: it has been cut. Released when the tree is done */
  int64_t tiny_pieces, cut_cells;
  int rotations;

  /* the result */
  int64_t cell_count, largest_leaf;
  int32_t *vertices, *cells, *leaf;
  stratus_partition_node* tree;
};

typedef struct stratus_kdtree_plane {
  int axis; /* -1: none is admissible */
  double value;
  double growth, imbalance; /* beta, alpha */
} stratus_kdtree_plane;

/* A point's height above a plane, 0 if it is on it. It depends only on the point, so that all cells at the point agree. */
static inline double stratus_kdtree_above(double coordinate, double value, double tolerance)
{
  const double above = coordinate - value;
  return fabs(above) <= tolerance ? 0.0 : above;
}

/* How many pieces a cell has below and above a plane, from its vertices below and above it. A cell that is not cut has 0 and 0. */
static inline void stratus_kdtree_pieces(int below, int above, int* pieces_below, int* pieces_above)
{
  static const int8_t pieces[4][4] = { { 0, 0, 0, 0 }, { 0, 1, 1, 1 }, { 0, 2, 3, 0 }, { 0, 3, 0, 0 } }; /* [this side][other side] */
  *pieces_below = pieces[below & 3][above & 3];
  *pieces_above = pieces[above & 3][below & 3];
}

/* ---- partition_planes.c */
stratus_status stratus_kdtree_choose_plane(
  const stratus_partition* partition, const stratus_kdtree_node* node, stratus_kdtree_plane* plane);

/* ---- partition_cut.c: gives a node two children, and divides those cells of other leaves that share a cut edge. */
stratus_status stratus_kdtree_cut(stratus_partition* partition, int32_t node, const stratus_kdtree_plane* plane);

/* ---- partition_leaves.c: lists a leaf's cells so that those near in space are near in memory. */
stratus_status stratus_kdtree_list_cells(const stratus_partition* partition, stratus_kdtree_node* node);

/* ---- partition_storage.c: grows an array to hold at least `needed` elements, and keeps the first `used`. */
stratus_status stratus_kdtree_reserve(stratus_context* context, void** memory, size_t* capacity, size_t needed, size_t used, size_t size);

#endif
