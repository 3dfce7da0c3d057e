/* SPDX-License-Identifier: BSD-3-Clause
 * A tree as the march asks it. */
#ifndef STRATUS_TREE_MAP_LAYER_H
#define STRATUS_TREE_MAP_LAYER_H

#include "tree.h"

/* Of a tree whose bricks are the blocks, of block_size cells, of a march. Stands where a distance map may stand. STRATUS_OVERFLOW beyond
 * 2^31 bytes. */
stratus_status stratus_tree_map_create(stratus_context* context, const stratus_tree* tree, int block_size, stratus_distance_map** map);

/* A hybrid tree of the occupied blocks: a block is a brick of 4^3 voxels, whatever its size in cells. */
stratus_status stratus_tree_of_occupancy(stratus_context* context, const stratus_occupancy* occupancy, stratus_tree** tree);

#endif
