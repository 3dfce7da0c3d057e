/* SPDX-License-Identifier: BSD-3-Clause
 * What the two files that fill distance fields share. */
#ifndef STRATUS_TREE_FIELDS_H
#define STRATUS_TREE_FIELDS_H

#include "tree.h"

/* Cells that code 1.. of 2 or of 3 bits leaps: 1, 2, 4, or 1, 2, 3, 4, 6, 8, 12. */
static inline int32_t stratus_leap_of_code(int bits, int code)
{
  return bits == 2 ? 1 << (code - 1) : (2 + (code & 1)) << (code >> 1) >> 1;
}

/* tree_octants.c: fills the field's entries, 0 where a cell is occupied. Cells are bricks. */
stratus_status stratus_tree_octants(stratus_context* context, const stratus_voxels* voxels, const stratus_tree_shape* shape,
  const stratus_tree_node* node, const stratus_tree_field* field, stratus_tree* tree);

#endif
