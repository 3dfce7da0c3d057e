/* SPDX-License-Identifier: BSD-3-Clause
 * A tree as a map for the march. */
#ifndef STRATUS_TREE_MAP_BUILD_H
#define STRATUS_TREE_MAP_BUILD_H

#include "tree.h"

/* Makes a map that replaces a distance map. The tree's bricks are the march's blocks of block_size cells. Returns STRATUS_OVERFLOW beyond
 * 2^31 bytes. */
stratus_status stratus_tree_map_create(stratus_context* context, const stratus_tree* tree, int block_size, stratus_distance_map** map);

/* Return the number of blocks in the tree's leaves, which is the size of its map. */
size_t stratus_tree_map_blocks(const stratus_tree* tree);

/* Builds a hybrid tree of the occupied blocks. Each block is a brick of 4^3 voxels, whatever its size in cells. */
stratus_status stratus_tree_of_occupancy(stratus_context* context, const stratus_occupancy* occupancy, stratus_tree** tree);

#endif
