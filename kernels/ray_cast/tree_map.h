/* SPDX-License-Identifier: BSD-3-Clause
 * A tree as the march reads it: what a distance map tells of a block is found through nodes and leaves. tree_map_build.c writes the
 * buffer. It begins with records of 8 ints, first those of `nodes` nodes, then those of the leaves; the leaves' bytes follow.
 *
 *   node: first block x y z; last block x y z; first child, or leaf; 1 if that is a leaf
 *   leaf: first block x y z; blocks along x, y, z; where its bytes begin; 0
 *
 * A byte is that of a distance map: 1..127, the Chebyshev distance to the nearest occupied block of the leaf; 128 or more, occupied. */
#ifndef STRATUS_TREE_MAP_H
#define STRATUS_TREE_MAP_H

#include "ray_segment.h"

#define TREE_STACK 132

INLINE int tree_larger(int a, int b) { return a > b ? a : b; }

/* The Chebyshev distance from a block to a node's box; 0 inside. */
INLINE int tree_distance(GLOBAL const int* node, int x, int y, int z)
{
  const int dx = tree_larger(node[0] - x, x - node[3]), dy = tree_larger(node[1] - y, y - node[4]),
            dz = tree_larger(node[2] - z, z - node[5]);
  return tree_larger(tree_larger(tree_larger(dx, dy), dz), 0);
}

INLINE int tree_leaf_byte(GLOBAL const uchar* map, GLOBAL const int* leaf, int x, int y, int z)
{
  const int row = (z - leaf[2]) * leaf[4] + (y - leaf[1]);
  return (int)map[(size_t)leaf[6] + (size_t)row * (size_t)leaf[3] + (size_t)(x - leaf[0])];
}

/* The byte of one block: the nearest of what all leaves tell. Boxes of bricks do not overlap, so that at most one leaf holds the block
 * itself. */
INLINE int tree_byte(GLOBAL const uchar* map, int nodes, int x, int y, int z)
{
  GLOBAL const int* records = (GLOBAL const int*)map;
  int stack[TREE_STACK], top = 0, nearest = 127;
  stack[top++] = 0;
  while (top > 0) {
    GLOBAL const int* node = records + 8 * stack[--top];
    const int away = tree_distance(node, x, y, z);
    if (away >= nearest) {
      continue;
    }
    if (!node[7]) {
      GLOBAL const int* child = records + 8 * node[6];
      const int near = tree_distance(child, x, y, z) <= tree_distance(child + 8, x, y, z) ? 0 : 1;
      stack[top++] = node[6] + 1 - near;
      stack[top++] = node[6] + near;
    } else if (away > 0) {
      nearest = away;
    } else {
      const int byte = tree_leaf_byte(map, records + 8 * (nodes + node[6]), x, y, z);
      if (byte > 127) {
        return byte;
      }
      nearest = byte < nearest ? byte : nearest;
    }
  }
  return nearest;
}

/* The bytes of the packet's blocks. A tree of one leaf is read for all lanes at once. */
INLINE vint tree_bytes(CONSTANT stratus_ray_cast_arguments* a, GLOBAL const uchar* map, const vint block[3], vmask mask)
{
  GLOBAL const int* records = (GLOBAL const int*)map;
  if (a->map.tree == 1) {
    GLOBAL const int* leaf = records + 8;
    vint away = vi_set(0), in[3];
    for (int axis = 0; axis < 3; ++axis) {
      const vint first = vi_set(records[axis]), last = vi_set(records[3 + axis]);
      away = vi_max(away, vi_max(first - block[axis], block[axis] - last));
      in[axis] = block[axis] - first;
    }
    const vmask inside = mask & vi_lt(away, vi_set(1));
    const vint index = in[0] + (in[1] + in[2] * vi_set(leaf[4])) * vi_set(leaf[3]) + vi_set(leaf[6]);
    const vint byte = gather_map(map, index, inside);
    return vi_select(inside, byte, vi_min(away, vi_set(127)));
  }
  int x[STRATUS_WIDTH], y[STRATUS_WIDTH], z[STRATUS_WIDTH], on[STRATUS_WIDTH];
  vi_store(x, block[0]);
  vi_store(y, block[1]);
  vi_store(z, block[2]);
  vi_store(on, vi_select(mask, vi_set(1), vi_set(0)));
  for (int lane = 0; lane < STRATUS_WIDTH; ++lane) {
    x[lane] = on[lane] ? tree_byte(map, a->map.tree, x[lane], y[lane], z[lane]) : 127;
  }
  return vi_load(x);
}

#endif
