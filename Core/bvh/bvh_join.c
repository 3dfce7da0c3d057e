/* SPDX-License-Identifier: BSD-3-Clause
 * Joining clusters: a tree over ranges of items becomes the upper part of the tree over the items. */
#include "bvh_build.h"

#include <string.h>

typedef struct joint {
  const stratus_bvh_join* join;
  stratus_bvh_pair* pairs;
  uint32_t* order; /* ranges from left to right */
  uint32_t* left;  /* by pair of join->of: number of ranges under its left child */
} joint;

/* Appends the ranges under a child to the first `listed` entries of the order; returns their new number. */
static uint32_t list_ranges(const joint* j, uint32_t child, uint32_t listed)
{
  if (child & STRATUS_BVH_LEAF) {
    j->order[listed] = child & ~STRATUS_BVH_LEAF;
    return listed + 1;
  }
  const uint32_t middle = list_ranges(j, j->join->of[child].child[0], listed);
  j->left[child] = middle - listed;
  return list_ranges(j, j->join->of[child].child[1], middle);
}

static void link_ranges(const joint* j, uint32_t child, uint32_t first, uint32_t* result)
{
  if (child & STRATUS_BVH_LEAF) {
    j->join->child[first] = result;
    return;
  }
  const uint32_t middle = first + j->left[child], pair = j->join->start[middle] - 1; /* as in stratus_bvh_split_items() */
  *result = pair;
  link_ranges(j, j->join->of[child].child[0], first, j->pairs[pair].child);
  link_ranges(j, j->join->of[child].child[1], middle, j->pairs[pair].child + 1);
}

void stratus_bvh_join_ranges(
  const stratus_bvh_join* join, stratus_bvh_item* items, stratus_bvh_item* spare, stratus_bvh_pair* pairs, uint32_t* child)
{
  const joint j = { join, pairs, join->room, join->room + join->ranges };
  uint32_t* start = j.left + join->ranges;
  uint32_t at = join->start[0];
  const uint32_t begin = at, end = join->start[join->ranges];
  (void)list_ranges(&j, join->root, 0);
  for (uint32_t r = 0; r < join->ranges; ++r) {
    const uint32_t from = join->start[j.order[r]], count = join->start[j.order[r] + 1] - from;
    memcpy(spare + at, items + from, count * sizeof *items);
    start[r] = at;
    at += count;
  }
  start[join->ranges] = end;
  memcpy(items + begin, spare + begin, (end - begin) * sizeof *items);
  memcpy(join->start, start, (join->ranges + 1) * sizeof *start);
  link_ranges(&j, join->root, 0, child);
}
