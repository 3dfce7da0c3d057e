/* SPDX-License-Identifier: BSD-3-Clause
 * The layout of a hierarchy: what Core/bvh/bvh_layout.c does on the host, level by level. Each pair's depth comes from doubling: a step
 * adds the depth of the pair that it looks at and then looks twice as far up. Pairs sorted by depth are levels. Subtrees are computed from
 * the deepest level up, and their places from the root down. A launch takes a level by many groups, or some levels with few pairs by one
 * group. */
#pragma OPENCL EXTENSION cl_khr_fp64 : enable
#pragma OPENCL FP_CONTRACT OFF
#ifndef GROUP
#define GROUP 64
#endif

#define LEAF 0x80000000u
#define NO_NODE 0xffffffffu
#define NO_LEVEL 0xffffffffu
#define TOO_DEEP 255u     /* the level of all pairs that are deeper than doubling reaches */
#define BRICKS (1u << 30) /* kind of a node, of which an inner one has 0 */

typedef struct subtree {
  double cost;
  int lo[3], hi[3];
  uint boxes, nodes, height; /* nodes 1: a leaf */
  uint unused;
} subtree;

/* links: of each pair, another above it and how far. */
__kernel void parents(__global const uint2* pairs, uint count, uint root, __global uint2* links)
{
  const uint p = (uint)get_global_id(0);
  if (p < count) {
    const uint2 child = pairs[p];
    if (!(child.x & LEAF)) {
      links[child.x] = (uint2)(p, 1);
    }
    if (!(child.y & LEAF)) {
      links[child.y] = (uint2)(p, 1);
    }
    if (p == root) {
      links[p] = (uint2)(p, 0);
    }
  }
}

__kernel void climb(__global const uint2* links, uint count, __global uint2* result)
{
  const uint p = (uint)get_global_id(0);
  if (p < count) {
    const uint2 link = links[p], above = links[link.x];
    result[p] = (uint2)(above.x, link.y + above.y);
  }
}

__kernel void depths(__global const uint2* links, uint count, uint root, __global ulong* keys, __global uint* values)
{
  const uint p = (uint)get_global_id(0);
  if (p < count) {
    keys[p] = links[p].x == root ? links[p].y : TOO_DEEP;
    values[p] = p;
  }
}

/* begin: the first place of each level among the sorted pairs. */
__kernel void levels(__global const ulong* keys, uint count, __global uint* begin)
{
  const uint i = (uint)get_global_id(0);
  if (i < count && (i == 0 || keys[i - 1] != keys[i])) {
    begin[keys[i]] = i;
  }
}

static double area_of(const subtree* s)
{
  const double x = (double)s->hi[0] - (double)s->lo[0], y = (double)s->hi[1] - (double)s->lo[1], z = (double)s->hi[2] - (double)s->lo[2];
  return x * y + y * z + z * x;
}

static subtree subtree_of(__global const subtree* subtrees, __global const int* boxes, uint child)
{
  if (!(child & LEAF)) {
    return subtrees[child];
  }
  subtree leaf;
  __global const int* box = boxes + 6 * (size_t)(child & ~LEAF);
  for (int a = 0; a < 3; ++a) {
    leaf.lo[a] = box[a];
    leaf.hi[a] = box[3 + a];
  }
  leaf.cost = area_of(&leaf);
  leaf.boxes = leaf.nodes = 1;
  leaf.height = 0;
  return leaf;
}

static void merge_children(__global const uint2* pairs, __global const int* boxes, uint leaf_boxes, uint pair, __global subtree* subtrees)
{
  const subtree left = subtree_of(subtrees, boxes, pairs[pair].x), right = subtree_of(subtrees, boxes, pairs[pair].y);
  subtree s;
  for (int a = 0; a < 3; ++a) {
    s.lo[a] = min(left.lo[a], right.lo[a]);
    s.hi[a] = max(left.hi[a], right.hi[a]);
  }
  s.boxes = left.boxes + right.boxes;
  s.nodes = 1 + left.nodes + right.nodes;
  s.height = 1 + max(left.height, right.height);
  s.unused = 0;
  const double area = area_of(&s), as_leaf = area * (double)s.boxes;
  s.cost = area + left.cost + right.cost;
  if (s.boxes <= leaf_boxes && as_leaf <= s.cost) {
    s.cost = as_leaf;
    s.nodes = 1;
    s.height = 0;
  }
  subtrees[pair] = s;
}

/* The group's part of a level: of its sorted pairs .x to .y - 1. */
static uint2 part_of(__global const uint* begin, uint level, uint count, uint chunk)
{
  const uint from = begin[level], next = begin[level + 1], size = (next == NO_LEVEL ? count : next) - from;
  const uint skip = min((uint)get_group_id(0) * chunk, size);
  return (uint2)(from + skip, from + skip + min(chunk, size - skip));
}

/* Subtrees of levels first down to last. */
__kernel void combine(__global const uint* sorted, __global const uint* begin, uint first, uint last, uint count, uint chunk,
  __global const uint2* pairs, __global const int* boxes, uint leaf_boxes, __global subtree* subtrees)
{
  for (uint level = first + 1; level-- > last;) {
    const uint2 part = part_of(begin, level, count, chunk);
    for (uint i = part.x + (uint)get_local_id(0); i < part.y; i += GROUP) {
      merge_children(pairs, boxes, leaf_boxes, sorted[i], subtrees);
    }
    barrier(CLK_GLOBAL_MEM_FENCE);
  }
}

typedef struct target {
  __global int* nodes; /* lo, hi, first, kind and count of each */
  __global const uint* number;
  __global uint* order;
  __global uint4* places;
} target;

static void write_node(const target* t, uint node, const subtree* s, uint first, uint kind_count)
{
  __global int* to = t->nodes + 8 * (size_t)node;
  for (int a = 0; a < 3; ++a) {
    to[a] = s->lo[a];
    to[3 + a] = s->hi[a];
  }
  to[6] = (int)first;
  to[7] = (int)kind_count;
}

/* place: the subtree's node, the first node below it and its first box. Node NO_NODE: it is within a leaf. */
static void place_child(const target* t, uint child, const subtree* s, uint4 place)
{
  if (!(child & LEAF)) {
    t->places[child] = place;
    return;
  }
  t->order[place.z] = t->number[child & ~LEAF];
  if (place.x != NO_NODE) {
    write_node(t, place.x, s, place.z, BRICKS | 1u);
  }
}

/* Nodes and order of levels first to last. places: the root's place is already there. */
__kernel void place(__global const uint* sorted, __global const uint* begin, uint first, uint last, uint count, uint chunk,
  __global const uint2* pairs, __global const int* boxes, __global const subtree* subtrees, __global const uint* number,
  __global uint4* places, __global int* nodes, __global uint* order)
{
  const target t = { nodes, number, order, places };
  for (uint level = first; level <= last; ++level) {
    const uint2 part = part_of(begin, level, count, chunk);
    for (uint i = part.x + (uint)get_local_id(0); i < part.y; i += GROUP) {
      const uint pair = sorted[i];
      const uint2 child = pairs[pair];
      const uint4 at = places[pair];
      const subtree s = subtrees[pair];
      const subtree left = subtree_of(subtrees, boxes, child.x), right = subtree_of(subtrees, boxes, child.y);
      const bool has_children = at.x != NO_NODE && s.nodes > 1;
      if (at.x != NO_NODE) {
        write_node(&t, at.x, &s, s.nodes > 1 ? at.y : at.z, s.nodes > 1 ? 0 : BRICKS | s.boxes);
      }
      place_child(&t, child.x, &left, (uint4)(has_children ? at.y : NO_NODE, at.y + 2, at.z, 0));
      place_child(&t, child.y, &right, (uint4)(has_children ? at.y + 1 : NO_NODE, at.y + 1 + left.nodes, at.z + left.boxes, 0));
    }
    barrier(CLK_GLOBAL_MEM_FENCE);
  }
}
