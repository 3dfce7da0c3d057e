/* SPDX-License-Identifier: BSD-3-Clause
 * A tree as the march asks it. */
#ifndef STRATUS_TREE_MAP_LAYER_H
#define STRATUS_TREE_MAP_LAYER_H

#include "tree.h"

typedef struct stratus_tree_map {
  stratus_context* context;
  int nodes;
  size_t bytes_size; /* with 64 bytes of padding, which traversal may read */
  uint8_t* bytes;    /* kernels/tree_map.h has the layout */
} stratus_tree_map;

/* Of a tree whose bricks are the blocks of a march. STRATUS_OVERFLOW beyond 2^31 bytes. */
stratus_status stratus_tree_map_create(stratus_context* context, const stratus_tree* tree, stratus_tree_map** map);
void stratus_tree_map_destroy(stratus_tree_map* map); /* takes NULL */

/* A hybrid tree of the occupied blocks: a block is a brick of 4^3 voxels, whatever its size in cells. */
stratus_status stratus_tree_of_occupancy(stratus_context* context, const stratus_occupancy* occupancy, stratus_tree** tree);

#endif
