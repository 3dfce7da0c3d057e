/* SPDX-License-Identifier: BSD-3-Clause
 * The common layout of all trees: nodes, leaves of bricks, leaves of distance fields; and what builders share. */
#ifndef STRATUS_TREE_H
#define STRATUS_TREE_H

#include "voxels.h"

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

/* ---- density.c: the field that the hybrid tree splits by. Deterministic: the same bits at any thread count and on host and device. */
typedef struct stratus_density {
  stratus_context* context;
  double bandwidth;
  int exact; /* 1: of[] has a density a voxel (bricks in order, bits ascending); 0: a density a brick, at the brick's middle */
  float* of;
  int64_t* start; /* exact: of[start[b]] is the first voxel of brick b; brick_count + 1 entries. NULL if not exact. */
} stratus_density;

/* bricks: count of them, any subset of a set's, in its order (a node's). bandwidth > 0. */
stratus_status stratus_density_create(
  stratus_context* context, const stratus_brick* bricks, int64_t count, double bandwidth, int exact, stratus_density** density);
void stratus_density_destroy(stratus_density* density);
stratus_status stratus_density_bandwidth_of(
  stratus_context* context, const stratus_brick* bricks, int64_t count, double* bandwidth, double* raw);
/* The densest effective voxel among the bricks numbered which[0..count-1] (NULL: all `count`) of those the density was made of; ties go to
 * the first in (z, y, x). Not exact: the densest brick's voxel nearest to its middle, ties the same. */
void stratus_density_peak(
  const stratus_density* density, const stratus_brick* bricks, const uint32_t* which, int64_t count, int32_t peak[3]);
/* Where density falls most steeply along each axis through the peak: for every axis and both sides, the first change of sign of the second
 * derivative (eq. 11; sampled at voxel borders from the peak outward, within [lo, hi)), and the first derivative's size there.
 * position[axis][side] in voxels (a plane between voxels position-1 and position), fall = 0 where there is none. Sums over the node's
 * bricks. */
typedef struct stratus_density_borders {
  int32_t position[3][2];
  double fall[3][2];
} stratus_density_borders;
stratus_status stratus_density_find_borders(stratus_context* context, const stratus_brick* bricks, const uint32_t* which, int64_t count,
  double bandwidth, int exact, const int32_t peak[3], const int32_t lo[3], const int32_t hi[3], stratus_density_borders* borders);

/* ---- dbscan.c: 1-D DBSCAN of coordinates given as counts: counts[i] voxels have coordinate i, 0 <= i < n; reach eps >= 1 in coordinates,
 * min_points. Finds the cluster that holds coordinate `peak`: [*lo, *hi); returns its number of core coordinates, 0 if the peak is noise.
 * *clusters: how many. */
int32_t stratus_dbscan_counts(
  const int64_t* counts, int32_t n, int32_t eps, int64_t min_points, int32_t peak, int32_t* lo, int32_t* hi, int32_t* clusters);

/* Builders of shapes. hybrid_tree.c: fills nodes (with kind FIELD where a field is to stand: bricks [first, first+count) of `order`, not
 * yet a field), order of bricks, and the statistics' splits and why; tree.c makes the fields and the rest. */
typedef struct stratus_tree_shape {
  stratus_tree_node* nodes;
  uint32_t node_count;
  uint32_t* order; /* of the voxels' bricks: a permutation */
} stratus_tree_shape;
stratus_status stratus_hybrid_tree_shape(stratus_context* context, const stratus_voxels* voxels, const stratus_tree_options* options,
  stratus_tree_shape* shape, stratus_tree_statistics* statistics);

/* ---- tree_fields.c: leaves of distance fields: how far a ray may leap from a cell, for each octant of directions (bit a set: it moves
 * towards
 * + on axis a). A cell is a brick, or, in the paper's trees, a voxel. Beyond the leaf's own cells a field knows nothing.
 *
 * An entry is of `entry_bytes` 2 or 3 little-endian bytes. Its lowest 2 or 3 bits are 0 in a cell that is occupied, whose other bits are
 * then the number of its mask behind rows[first_row + k*cells[1] + j]. Else, with `octants`, bits o*2.. or o*3.. are a code of octant o: a
 * leap of 1, 2, 4 cells for codes 1, 2, 3 of two bits, of 1, 2, 3, 4, 6, 8, 12 for codes 1 to 7 of three. Without `octants` the other 14
 * bits are the Chebyshev distance to the nearest occupied cell, and the lowest two are 1. A leap of n cells from a cell stays within the
 * n^3 cells that begin with it (Chebyshev: the (2n-1)^3 about it), all of which but itself are known to be empty. */
typedef struct stratus_tree_field {
  int32_t at[3];        /* first cell */
  int32_t cells[3];     /* along each axis, at most 2^14 */
  uint32_t first_entry; /* entry (k*cells[1] + j)*cells[0] + i behind it */
  uint32_t first_row;
} stratus_tree_field;

#define STRATUS_FIELD_ROW_MAX (1 << 14)

struct stratus_tree {
  stratus_context* context;
  stratus_tree_statistics statistics;
  int32_t dimensions[3];
  double index_to_world[16], world_to_index[16];
  stratus_origin origin;
  stratus_tree_node* nodes;
  stratus_brick* bricks; /* of leaves of bricks; in voxel hierarchies one bit each */
  stratus_tree_field* fields;
  uint32_t node_count, brick_count, field_count;
  int32_t octants;     /* see above: the same for all fields of a tree */
  int32_t entry_bytes; /* 2 or 3 */
  int32_t cell_log2;   /* 2: cells are bricks; 0: voxels */
  uint32_t entry_count, row_count, mask_count;
  uint8_t* entries; /* entry_count*entry_bytes, and 4 bytes of padding */
  uint32_t* rows;
  uint64_t* masks;
};

/* Fields over the bricks numbered order[node.first ..] of every node of kind FIELD, whose `first` becomes the field's number. */
stratus_status stratus_tree_make_fields(
  stratus_context* context, const stratus_voxels* voxels, const stratus_tree_shape* shape, stratus_tree* tree);
/* Whether cell (i,j,k) of a field is occupied, or how far a ray of `octant` may leap, 1 or more. */
int32_t stratus_tree_field_leap(
  const stratus_tree* tree, const stratus_tree_field* field, int octant, int32_t i, int32_t j, int32_t k, uint64_t* mask);

/* ---- tree.c */
stratus_status stratus_tree_count_up(stratus_context* context, stratus_tree* tree); /* the statistics that follow from nodes and leaves */
size_t stratus_tree_memory(const stratus_tree* tree);
/* tree_arrays_check.c: nodes, bricks, fields and masks lead nowhere but to each other; the header has been looked at. */
stratus_status stratus_tree_check_arrays(stratus_context* context, const stratus_tree* tree);
/* tree_bytes.c: whether the tree's dimensions are those of a tree of this volume. */
bool stratus_tree_fits(const stratus_tree* tree, const stratus_volume* volume);

#endif
