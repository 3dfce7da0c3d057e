/* SPDX-License-Identifier: BSD-3-Clause
 * The common layout of all trees: nodes, leaves of bricks, leaves of distance fields; and what builders share. */
#ifndef STRATUS_TREE_H
#define STRATUS_TREE_H

#include "bvh.h"
#include "density.h"
#include "voxels.h"

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
