/* SPDX-License-Identifier: BSD-3-Clause
 * Shared by the two files that fill distance fields. */
#ifndef STRATUS_TREE_FIELDS_H
#define STRATUS_TREE_FIELDS_H

#include "tree.h"

/* Returns the cells that a code leaps: 1, 2, 4 for codes 1 to 3 of 2 bits; 1, 2, 3, 4, 6, 8, 12 for codes 1 to 7 of 3 bits. */
static inline int32_t stratus_leap_of_code(int bits, int code)
{
  return bits == 2 ? 1 << (code - 1) : (2 + (code & 1)) << (code >> 1) >> 1;
}

/* tree_octants.c: fills the field's entries with codes, and with 0 where a cell is occupied. Cells must be bricks. */
stratus_status stratus_tree_octants(stratus_context* context, const stratus_voxels* voxels, const stratus_tree_shape* shape,
  const stratus_tree_node* node, const stratus_tree_field* field, stratus_tree* tree);

#endif
