/* SPDX-License-Identifier: BSD-3-Clause
 * Planes of the hybrid tree by density (Guo et al. 2025, 3.1). The functions find the density's peak, the deviation of the voxels from it,
 * and the axis along which density falls most steeply. The plane is the border of the peak's cluster on that axis. Where the cluster spans
 * the node or does not exist, the plane is the border of the density itself.
 *
 * A coordinate is a core of a cluster if its window holds half of the voxels that an even spread would put there. Even data then form one
 * cluster; with the mean itself as the threshold they would form a random number of clusters. */
#include "hybrid_tree.h"

#include <string.h>

/* Copies the node's bricks to an array of their own and computes their bandwidth and density. */
static stratus_status make_own(hybrid_build* build, const hybrid_node* node)
{
  const double wanted = build->options->bandwidth;
  void* memory;
  if (!build->gathered) {
    TRY(stratus_allocate(build->context, (size_t)build->voxels->brick_count, sizeof *build->gathered, &memory));
    build->gathered = memory;
  }
  stratus_density_destroy(build->density);
  build->density = NULL;
  for (uint32_t i = 0; i < node->count; ++i) {
    build->gathered[i] = build->voxels->bricks[build->shape->order[node->first + i]];
  }
  build->bandwidth = wanted;
  if (wanted <= 0.0) {
    TRY(stratus_density_bandwidth_of(build->context, build->gathered, node->count, &build->bandwidth, NULL));
  }
  return stratus_density_create(
    build->context, build->gathered, node->count, build->bandwidth, build->paper || build->options->exact_density, &build->density);
}

/* Computes one density for the whole tree, at the first node that needs it. */
static stratus_status make_common(hybrid_build* build)
{
  const stratus_voxels* voxels = build->voxels;
  build->bandwidth = build->options->bandwidth;
  if (build->bandwidth <= 0.0) {
    TRY(stratus_density_bandwidth_of(build->context, voxels->bricks, voxels->brick_count, &build->bandwidth, NULL));
  }
  return stratus_density_create(
    build->context, voxels->bricks, voxels->brick_count, build->bandwidth, build->paper || build->options->exact_density, &build->density);
}

static const stratus_brick* bricks_of(const hybrid_build* build, const hybrid_node* node, const uint32_t** which)
{
  *which = build->gathered ? NULL : build->shape->order + node->first;
  return build->gathered ? build->gathered : build->voxels->bricks;
}

/* Computes the deviations of eq. 8. */
static void find_deviations(const hybrid_build* build, const hybrid_node* node, hybrid_view* view)
{
  const uint32_t* which;
  const stratus_brick* bricks = bricks_of(build, node, &which);
  double sum[3] = { 0.0, 0.0, 0.0 };
  int64_t voxels = 0;
  for (uint32_t i = 0; i < node->count; ++i) {
    const stratus_brick* b = bricks + (which ? which[i] : i);
    voxels += b->count;
    for (uint64_t bits = b->mask; bits; bits &= bits - 1) {
      const int bit = __builtin_ctzll(bits);
      const double x = STRATUS_BRICK * b->at[0] + (bit & 3) - view->peak[0], y = STRATUS_BRICK * b->at[1] + (bit >> 2 & 3) - view->peak[1],
                   z = STRATUS_BRICK * b->at[2] + (bit >> 4) - view->peak[2];
      sum[0] += x * x;
      sum[1] += y * y;
      sum[2] += z * z;
    }
  }
  for (int a = 0; a < 3; ++a) {
    view->deviation[a] = sqrt(sum[a] / (double)voxels);
  }
}

stratus_status stratus_hybrid_measure(hybrid_build* build, const hybrid_node* node, hybrid_view* view)
{
  const uint32_t* which;
  if (build->options->density_per_node || build->paper) {
    TRY(make_own(build, node));
  } else if (!build->density) {
    TRY(make_common(build));
  }
  if (build->statistics->bandwidth <= 0.0) {
    build->statistics->bandwidth = build->bandwidth;
  }
  const stratus_brick* bricks = bricks_of(build, node, &which);
  stratus_density_peak(build->density, bricks, which, node->count, view->peak);
  find_deviations(build, node, view);
  return STRATUS_OK;
}

double stratus_hybrid_unevenness(const hybrid_node* node, const hybrid_view* view, int paper)
{
  double least = INFINITY, most = 0.0;
  for (int a = 0; a < 3; ++a) {
    const double deviation = view->deviation[a] / (paper ? 1.0 : (double)STRATUS_BRICK * (node->hi[a] - node->lo[a]));
    least = fmin(least, deviation);
    most = fmax(most, deviation);
  }
  return most - least;
}

/* Takes the plane between bricks nearest to `position` (voxels) if it divides the node and is cheaper than *best. */
static void offer(const hybrid_build* build, const hybrid_node* node, int axis, int32_t position, hybrid_plane* best)
{
  const int32_t brick = (position + STRATUS_BRICK / 2) / STRATUS_BRICK;
  if (brick > node->lo[axis] && brick < node->hi[axis]) {
    const double cost = stratus_hybrid_plane_cost(build, node, axis, brick);
    if (cost < best->cost) {
      *best = (hybrid_plane){ axis, brick, cost };
    }
  }
}

/* Offers both borders of the peak's cluster. */
static stratus_status offer_cluster(hybrid_build* build, const hybrid_node* node, const hybrid_view* view, int axis, hybrid_plane* best)
{
  const int32_t start = STRATUS_BRICK * node->lo[axis], extent = STRATUS_BRICK * (node->hi[axis] - node->lo[axis]);
  const uint32_t* which;
  const stratus_brick* bricks = bricks_of(build, node, &which);
  int64_t voxels = 0;
  int32_t lo, hi, clusters;
  memset(build->counts, 0, sizeof *build->counts * (size_t)extent);
  for (uint32_t i = 0; i < node->count; ++i) {
    const stratus_brick* b = bricks + (which ? which[i] : i);
    voxels += b->count;
    for (uint64_t bits = b->mask; bits; bits &= bits - 1) {
      build->counts[STRATUS_BRICK * b->at[axis] - start + (__builtin_ctzll(bits) >> 2 * axis & 3)]++;
    }
  }
  const int32_t eps = (int32_t)fmin(fmax(floor(build->bandwidth + 0.5), 1.0), STRATUS_AXIS_MAX);
  const double even = (double)voxels * fmin((2.0 * eps + 1.0) / extent, 1.0);
  const int64_t least = (int64_t)fmax(ceil(0.5 * even), 1.0);
  if (stratus_dbscan_counts(build->counts, extent, eps, least, view->peak[axis] - start, &lo, &hi, &clusters)) {
    offer(build, node, axis, start + lo, best);
    offer(build, node, axis, start + hi, best);
  }
  return STRATUS_OK;
}

stratus_status stratus_hybrid_plane_density(
  hybrid_build* build, const hybrid_node* node, const hybrid_view* view, hybrid_plane* plane, int* clustered)
{
  const stratus_tree_node* box = build->shape->nodes + node->number;
  const uint32_t* which;
  const stratus_brick* bricks = bricks_of(build, node, &which);
  stratus_density_borders borders;
  int axis = -1, steepest = 0;
  double fall = 0.0;
  void* memory;
  if (!build->counts) {
    int64_t longest = 0;
    for (int a = 0; a < 3; ++a) {
      longest = build->voxels->bricks_along[a] > longest ? build->voxels->bricks_along[a] : longest;
    }
    TRY(stratus_allocate(build->context, (size_t)(STRATUS_BRICK * longest), sizeof *build->counts, &memory));
    build->counts = memory;
  }
  *plane = (hybrid_plane){ .axis = -1, .cost = INFINITY };
  *clustered = 0;
  TRY(stratus_density_find_borders(build->context, bricks, which, node->count, build->bandwidth,
    build->paper || build->options->exact_density, view->peak, box->lo, box->hi, &borders));
  for (int i = 0; i < 6; ++i) {
    if (borders.fall[i / 2][i % 2] > fall) {
      fall = borders.fall[i / 2][i % 2];
      axis = i / 2;
      steepest = i % 2;
    }
  }
  if (axis < 0) {
    return STRATUS_OK;
  }
  TRY(offer_cluster(build, node, view, axis, plane));
  *clustered = plane->axis >= 0;
  if (!*clustered) {
    offer(build, node, axis, borders.position[axis][steepest], plane);
  }
  return STRATUS_OK;
}
