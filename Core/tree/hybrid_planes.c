/* SPDX-License-Identifier: BSD-3-Clause
 * Planes of the hybrid tree: the surface area heuristic over bins of bricks (Wald 2007), medians, and the partition. A node's bricks stay
 * in ascending order, because a density requires that order. */
#include "hybrid_tree.h"

#include <string.h>

#define BINS 32

typedef struct bin {
  int64_t count;
  int32_t lo[3], hi[3]; /* bricks, [lo, hi) */
} bin;

static const bin empty_bin = { 0, { INT32_MAX, INT32_MAX, INT32_MAX }, { 0, 0, 0 } };

static void grow(bin* b, const stratus_brick* brick)
{
  ++b->count;
  for (int a = 0; a < 3; ++a) {
    const int32_t at = brick->at[a];
    b->lo[a] = at < b->lo[a] ? at : b->lo[a];
    b->hi[a] = at >= b->hi[a] ? at + 1 : b->hi[a];
  }
}

static void join(bin* b, const bin* other)
{
  b->count += other->count;
  for (int a = 0; a < 3; ++a) {
    b->lo[a] = other->lo[a] < b->lo[a] ? other->lo[a] : b->lo[a];
    b->hi[a] = other->hi[a] > b->hi[a] ? other->hi[a] : b->hi[a];
  }
}

/* Returns half of a bin's surface times its number of bricks. */
static double cost_of(const bin* b)
{
  const double x = b->hi[0] - b->lo[0], y = b->hi[1] - b->lo[1], z = b->hi[2] - b->lo[2];
  return b->count ? (x * y + y * z + z * x) * (double)b->count : 0.0;
}

static const stratus_brick* brick_of(const hybrid_build* build, const hybrid_node* node, uint32_t i)
{
  return build->voxels->bricks + build->shape->order[node->first + i];
}

double stratus_hybrid_plane_cost(const hybrid_build* build, const hybrid_node* node, int axis, int32_t brick)
{
  bin sides[2] = { empty_bin, empty_bin };
  for (uint32_t i = 0; i < node->count; ++i) {
    const stratus_brick* b = brick_of(build, node, i);
    grow(sides + (b->at[axis] >= brick), b);
  }
  return cost_of(sides) + cost_of(sides + 1);
}

static void fill_bins(const hybrid_build* build, const hybrid_node* node, const int32_t used[3], bin bins[3][BINS])
{
  for (int a = 0; a < 3; ++a) {
    for (int i = 0; i < BINS; ++i) {
      bins[a][i] = empty_bin;
    }
  }
  for (uint32_t i = 0; i < node->count; ++i) {
    const stratus_brick* b = brick_of(build, node, i);
    for (int a = 0; a < 3; ++a) {
      grow(bins[a] + (b->at[a] - node->lo[a]) * used[a] / (node->hi[a] - node->lo[a]), b);
    }
  }
}

hybrid_plane stratus_hybrid_plane_sah(const hybrid_build* build, const hybrid_node* node)
{
  bin bins[3][BINS];
  int32_t used[3];
  hybrid_plane best = { .axis = -1, .cost = INFINITY };
  for (int a = 0; a < 3; ++a) {
    const int32_t extent = node->hi[a] - node->lo[a];
    used[a] = extent < BINS ? extent : BINS;
  }
  fill_bins(build, node, used, bins);
  for (int a = 0; a < 3; ++a) {
    double above[BINS];
    bin side = empty_bin;
    for (int i = used[a] - 1; i > 0; --i) {
      join(&side, bins[a] + i);
      above[i] = cost_of(&side);
    }
    side = empty_bin;
    for (int i = 1; i < used[a]; ++i) {
      join(&side, bins[a] + i - 1);
      const double cost = cost_of(&side) + above[i];
      if (cost < best.cost) {
        const int32_t extent = node->hi[a] - node->lo[a];
        best = (hybrid_plane){ a, node->lo[a] + (i * extent + used[a] - 1) / used[a], cost };
      }
    }
  }
  return best;
}

uint32_t stratus_hybrid_plane_below(const hybrid_build* build, const hybrid_node* node, const hybrid_plane* plane)
{
  uint32_t below = 0;
  for (uint32_t i = 0; i < node->count; ++i) {
    below += brick_of(build, node, i)->at[plane->axis] < plane->brick;
  }
  return below;
}

/* Finds the plane across the longest axis by bisection: the lowest one with at least half of the bricks below it. */
hybrid_plane stratus_hybrid_plane_median(const hybrid_build* build, const hybrid_node* node)
{
  hybrid_plane plane = { .axis = 0 };
  for (int a = 1; a < 3; ++a) {
    plane.axis = node->hi[a] - node->lo[a] > node->hi[plane.axis] - node->lo[plane.axis] ? a : plane.axis;
  }
  int32_t low = node->lo[plane.axis] + 1, high = node->hi[plane.axis] - 1;
  while (low < high) {
    plane.brick = low + (high - low) / 2;
    if (stratus_hybrid_plane_below(build, node, &plane) >= node->count / 2) {
      high = plane.brick;
    } else {
      low = plane.brick + 1;
    }
  }
  plane.brick = low;
  plane.cost = stratus_hybrid_plane_cost(build, node, plane.axis, low);
  return plane;
}

/* ---- boxes */

/* Finds the first and the last of four groups of bits that hold a set bit. */
static void ends(uint64_t mask, uint64_t group, int step, int32_t* first, int32_t* last)
{
  *first = 0;
  *last = 3;
  while (!(mask & group << step * *first)) {
    ++*first;
  }
  while (!(mask & group << step * *last)) {
    --*last;
  }
}

void stratus_hybrid_tight_box(const hybrid_build* build, hybrid_node* node, stratus_tree_node* box)
{
  static const uint64_t groups[3] = { 0x1111111111111111u, 0x000f000f000f000fu, 0xffffu };
  bin all = empty_bin;
  for (int a = 0; a < 3; ++a) {
    box->lo[a] = INT32_MAX;
    box->hi[a] = 0;
  }
  for (uint32_t i = 0; i < node->count; ++i) {
    const stratus_brick* b = brick_of(build, node, i);
    grow(&all, b);
    for (int a = 0; a < 3; ++a) {
      const int32_t at = STRATUS_BRICK * b->at[a];
      if (at < box->lo[a] || at + STRATUS_BRICK > box->hi[a]) {
        int32_t first, last;
        ends(b->mask, groups[a], a == 0 ? 1 : a == 1 ? 4 : 16, &first, &last);
        box->lo[a] = at + first < box->lo[a] ? at + first : box->lo[a];
        box->hi[a] = at + last >= box->hi[a] ? at + last + 1 : box->hi[a];
      }
    }
  }
  memcpy(node->lo, all.lo, sizeof node->lo);
  memcpy(node->hi, all.hi, sizeof node->hi);
}

void stratus_hybrid_partition(
  hybrid_build* build, const hybrid_node* node, const hybrid_plane* plane, hybrid_node sides[2], stratus_tree_node boxes[2])
{
  uint32_t* order = build->shape->order + node->first;
  uint32_t below = 0, above = 0;
  for (uint32_t i = 0; i < node->count; ++i) {
    const uint32_t number = order[i];
    if (build->voxels->bricks[number].at[plane->axis] < plane->brick) {
      order[below++] = number;
    } else {
      build->scratch[above++] = number;
    }
  }
  memcpy(order + below, build->scratch, above * sizeof *order);
  sides[0] = (hybrid_node){ .first = node->first, .count = below };
  sides[1] = (hybrid_node){ .first = node->first + below, .count = above };
  for (int side = 0; side < 2; ++side) {
    stratus_hybrid_tight_box(build, sides + side, boxes + side);
  }
}
