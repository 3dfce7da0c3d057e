/* SPDX-License-Identifier: BSD-3-Clause
 * The kernels' arguments for a distance field that is a leaf of a tree. */
#ifndef STRATUS_TREE_ARGUMENTS_H
#define STRATUS_TREE_ARGUMENTS_H

/* Scalars of four bytes only: the same bytes on host and device. Cells are bits, 32 in a word; a row of cells has whole words. */
typedef struct stratus_leaf_arguments {
  int at[3], cells[3];  /* first cell, and their number along each axis */
  int words;            /* of a row */
  unsigned first_word;  /* where the leaf's words begin among all leaves' */
  unsigned first_entry; /* its entries */
  unsigned first_row;   /* its rows */
  unsigned first_mask;  /* its masks, one for each of its bricks */
  unsigned first;       /* its bricks in the order */
} stratus_leaf_arguments;

#endif
