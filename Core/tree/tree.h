/* SPDX-License-Identifier: BSD-3-Clause
 * The layout common to all trees, whose nodes bvh.h declares: leaves of distance fields, and the tree itself. */
#ifndef STRATUS_TREE_H
#define STRATUS_TREE_H

#include "stratus/tree.h"
#include "bvh.h"
#include "density.h"
#include "voxels.h"
#include "wide_tree.h"

/* The shape of a tree: hybrid_tree.c (which also sets the statistics' splits and `why`) or whole_shape() in tree.c makes it, and tree.c
 * makes its fields and the rest. Hierarchies of bvh and wide trees have no shape. A node of kind FIELD lists bricks [first, first+count) of
 * `order`. */
typedef struct stratus_tree_shape {
  stratus_tree_node* nodes;
  uint32_t node_count;
  uint32_t* order; /* a permutation of the voxels' bricks */
} stratus_tree_shape;
stratus_status stratus_hybrid_tree_shape(stratus_context* context, const stratus_voxels* voxels, const stratus_tree_options* options,
  stratus_tree_shape* shape, stratus_tree_statistics* statistics);

/* ---- tree_fields.c: leaves of distance fields. An entry holds how far a ray may leap from a cell, for each octant of directions (bit a of
 * an octant is set: the ray moves towards + on axis a). A cell is a brick or, in the paper's trees, a voxel. A field knows nothing beyond
 * its own cells.
 *
 * An entry has `entry_bytes` 2 or 3, little-endian. Its lowest 2 or 3 bits are 0 in an occupied cell. The other bits are then the number of
 * the cell's mask, counted from rows[first_row + k*cells[1] + j]. In an empty cell of a tree with `octants`, bits o*2.. or o*3.. are the
 * code of octant o: a leap of 1, 2, 4 cells for codes 1, 2, 3 of two bits, of 1, 2, 3, 4, 6, 8, 12 for codes 1 to 7 of three bits. Without
 * `octants` the lowest two bits hold 1, and the other 14 bits the Chebyshev distance to the nearest occupied cell or, in the paper's trees,
 * a shorter leap. A leap of n cells stays within the n^3 cells that begin with the cell (without `octants`: the (2n-1)^3 around it), all of
 * which are known to be empty. In an uncorrected tree, these bits are the flooded Euclidean distance in parts of a voxel. */
typedef struct stratus_tree_field {
  int32_t at[3];        /* first cell */
  int32_t cells[3];     /* along each axis; rows of 2-byte entries with masks have at most STRATUS_FIELD_ROW_MAX */
  uint32_t first_entry; /* cell (i,j,k) has entry first_entry + (k*cells[1] + j)*cells[0] + i */
  uint32_t first_row;
} stratus_tree_field;

#define STRATUS_FIELD_ROW_MAX (1 << 14)
/* Parts of a voxel in which an uncorrected tree's distances are stored, rounded down; longer ones than 14 bits hold are cut. */
#define STRATUS_FLOODED_PARTS 32

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
  int32_t octants;     /* 1: leaps per octant, 0: Chebyshev distances; the same for all fields of a tree */
  int32_t entry_bytes; /* 2 or 3 */
  int32_t cell_log2;   /* 2: cells are bricks; 0: voxels */
  uint32_t entry_count, row_count, mask_count;
  uint8_t* entries; /* entry_count*entry_bytes bytes, and 4 bytes of padding */
  uint32_t* rows;
  uint64_t* masks;
  /* Of a tree whose only node is a leaf of all bricks: the hierarchy over them. It is made from the bricks, also where a tree is loaded. */
  stratus_wide wide;
};

/* Makes a field of the bricks order[node.first ..] for every node of kind FIELD, and sets the node's `first` to the field's number. */
stratus_status stratus_tree_make_fields(
  stratus_context* context, const stratus_voxels* voxels, const stratus_tree_shape* shape, stratus_tree* tree);
/* Returns the bytes of a tree of one field of octants over all voxels, of which there are some. */
double stratus_tree_octant_bytes(const stratus_voxels* voxels);
/* Returns 0 if cell (i,j,k) of a field is occupied, or else how far a ray of `octant` may leap, 1 or more. *mask gets an occupied cell's
 * voxels, else 0. */
int32_t stratus_tree_field_leap(
  const stratus_tree* tree, const stratus_tree_field* field, int octant, int32_t i, int32_t j, int32_t k, uint64_t* mask);

/* ---- tree.c */
stratus_status stratus_tree_count_up(stratus_context* context, stratus_tree* tree); /* sets the statistics of nodes and leaves */
size_t stratus_tree_memory(const stratus_tree* tree);
/* tree_arrays_check.c: checks that nodes, bricks, fields and masks refer only to each other. The header must have been checked before. */
stratus_status stratus_tree_check_arrays(stratus_context* context, const stratus_tree* tree);
/* tree_bytes.c: write size and checksum into the header of a saved tree of more than 24 bytes, whatever its other contents. Fuzzers repair
 * changed bytes with it. */
void stratus_tree_seal(void* bytes, size_t size);
/* tree_bytes.c: return whether the tree has the dimensions of a tree of this volume. */
bool stratus_tree_fits(const stratus_tree* tree, const stratus_volume* volume);

/* ---- tree_check.c */
/* Checks against the voxels that each voxel is in exactly one leaf, boxes are tight, and no distance is too long. If not, returns
 * STRATUS_INVALID_ARGUMENT with a message; always for an uncorrected tree, whose distances nobody vouches for. */
stratus_status stratus_tree_check(stratus_context* context, const stratus_tree* tree, const stratus_voxels* voxels);

#endif
