/* SPDX-License-Identifier: BSD-3-Clause
 * Planes of the hybrid tree: the surface area heuristic over bins of bricks (Wald 2007), planes that are offered, and medians. */
#include "hybrid_tree.h"

static void join(hybrid_bin* b, const hybrid_bin* other)
{
  b->count += other->count;
  for (int a = 0; a < 3; ++a) {
    b->lo[a] = other->lo[a] < b->lo[a] ? other->lo[a] : b->lo[a];
    b->hi[a] = other->hi[a] > b->hi[a] ? other->hi[a] : b->hi[a];
  }
}

/* Returns half of a bin's surface times its number of bricks. */
static double cost_of(const hybrid_bin* b)
{
  const double x = b->hi[0] - b->lo[0], y = b->hi[1] - b->lo[1], z = b->hi[2] - b->lo[2];
  return b->count ? (x * y + y * z + z * x) * (double)b->count : 0.0;
}

hybrid_plane stratus_hybrid_plane_sah(const hybrid_node* node, const hybrid_bin* bins)
{
  hybrid_plane best = { .axis = -1, .cost = INFINITY };
  for (int a = 0; a < 3; ++a) {
    const int32_t used = hybrid_bins_along(node, a);
    double above[HYBRID_BINS];
    hybrid_bin side = hybrid_no_bricks;
    for (int i = used - 1; i > 0; --i) {
      join(&side, bins + i);
      above[i] = cost_of(&side);
    }
    side = hybrid_no_bricks;
    for (int i = 1; i < used; ++i) {
      join(&side, bins + i - 1);
      const double cost = cost_of(&side) + above[i];
      if (cost < best.cost) {
        const int32_t extent = node->hi[a] - node->lo[a];
        best = (hybrid_plane){ a, node->lo[a] + (i * extent + used - 1) / used, (uint32_t)side.count, cost };
      }
    }
    bins += used;
  }
  return best;
}

hybrid_plane stratus_hybrid_plane_offered(const hybrid_work* work)
{
  hybrid_plane best = { .axis = -1, .cost = INFINITY };
  for (int i = 0; i < work->offers; ++i) {
    const double cost = cost_of(&work->sides[i][0]) + cost_of(&work->sides[i][1]);
    if (cost < best.cost) {
      best = (hybrid_plane){ work->axis, work->offered[i], (uint32_t)work->sides[i][0].count, cost };
    }
  }
  return best;
}

static uint32_t count_below(const hybrid_build* build, const hybrid_node* node, int axis, int32_t plane)
{
  uint32_t below = 0;
  for (uint32_t i = 0; i < node->count; ++i) {
    below += hybrid_brick(build, node, i)->at[axis] < plane;
  }
  return below;
}

hybrid_plane stratus_hybrid_plane_median(const hybrid_build* build, const hybrid_node* node)
{
  hybrid_plane plane = { .axis = 0 };
  for (int a = 1; a < 3; ++a) {
    plane.axis = node->hi[a] - node->lo[a] > node->hi[plane.axis] - node->lo[plane.axis] ? a : plane.axis;
  }
  int32_t low = node->lo[plane.axis] + 1, high = node->hi[plane.axis] - 1;
  while (low < high) {
    plane.brick = low + (high - low) / 2;
    if (count_below(build, node, plane.axis, plane.brick) >= node->count / 2) {
      high = plane.brick;
    } else {
      low = plane.brick + 1;
    }
  }
  plane.brick = low;
  plane.below = count_below(build, node, plane.axis, low);
  return plane;
}
