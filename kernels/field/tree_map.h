/* SPDX-License-Identifier: BSD-3-Clause
 * A tree as the march reads it: the distances that a distance map holds for blocks are found through nodes and leaves. tree_map_build.c
 * writes the buffer. It begins with records of 8 ints, first `nodes` nodes, then the leaves; the leaves' bytes follow.
 *
 *   node: first block x y z; last block x y z; first child, or leaf; 1 if that is a leaf
 *   leaf: first block x y z; blocks along x, y, z; where its bytes begin; 0
 *
 * A byte has the meaning of a distance map's: 1..127, the Chebyshev distance to the nearest occupied block of the leaf; 128 or more,
 * occupied. */
#ifndef STRATUS_TREE_MAP_H
#define STRATUS_TREE_MAP_H

#include "ray_blocks.h"

#define TREE_STACK 132

/* The Chebyshev distance from each lane's block to a node's box; 0 inside. */
INLINE vint tree_distance(GLOBAL const int* node, const vint block[3])
{
  vint away = vi_set(0);
  for (int axis = 0; axis < 3; ++axis) {
    away = vi_max(away, vi_max(vi_set(node[axis]) - block[axis], block[axis] - vi_set(node[3 + axis])));
  }
  return away;
}

/* A leaf's byte for each lane's block: the byte in the leaf's box, or outside it the distance to the box. */
INLINE vint tree_leaf_bytes(GLOBAL const uchar* map, GLOBAL const int* leaf, const vint block[3], vint away, vmask mask)
{
  const vmask inside = mask & vi_lt(away, vi_set(1));
  const vint index = (block[0] - vi_set(leaf[0])) +
    ((block[1] - vi_set(leaf[1])) + (block[2] - vi_set(leaf[2])) * vi_set(leaf[4])) * vi_set(leaf[3]) + vi_set(leaf[6]);
  return vi_select(inside, gather_map(map, index, inside), vi_min(away, vi_set(127)));
}

/* The bytes of the packet's blocks: the nearest distance over all leaves. Boxes of bricks do not overlap, so that at most one leaf holds a
 * block itself. The lanes descend together, to the nodes that are nearer to one of them than the distance that it knows. */
INLINE vint tree_bytes(CONSTANT stratus_ray_cast_arguments* a, GLOBAL const uchar* map, const vint block[3], vmask mask)
{
  GLOBAL const int* records = (GLOBAL const int*)map;
  const vint farthest = vi_set(127);
  int stack[TREE_STACK], top = 0;
  vint nearest = farthest;
  if (a->map.tree == 1) {
    return tree_leaf_bytes(map, records + 8, block, tree_distance(records, block), mask);
  }
  stack[top++] = 0;
  while (top > 0) {
    GLOBAL const int* node = records + 8 * stack[--top];
    const vint away = tree_distance(node, block);
    const vmask wanted = mask & vi_lt(away, nearest);
    if (!m_any(wanted)) {
      continue;
    }
    if (!node[7]) {
      GLOBAL const int* child = records + 8 * node[6];
      const vmask second = wanted & vi_lt(tree_distance(child + 8, block), tree_distance(child, block));
      const int near = 2 * m_count(second) > m_count(wanted);
      stack[top++] = node[6] + 1 - near;
      stack[top++] = node[6] + near;
    } else {
      const vint byte = tree_leaf_bytes(map, records + 8 * (a->map.tree + node[6]), block, away, wanted);
      const vmask occupied = wanted & vi_ge(byte, vi_set(128));
      nearest = vi_select(occupied, byte, vi_select(wanted, vi_min(nearest, byte), nearest));
      mask = m_andnot(mask, occupied);
    }
  }
  return nearest;
}

#endif
