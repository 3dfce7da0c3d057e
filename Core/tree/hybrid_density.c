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
  TRY(build->sums->order(build, node->first, node->count));
  for (uint32_t i = 0; i < node->count; ++i) {
    build->gathered[i] = *hybrid_brick(build, node, i);
  }
  build->bandwidth = wanted;
  if (wanted <= 0.0) {
    TRY(stratus_density_bandwidth_of(build->context, build->gathered, node->count, &build->bandwidth, NULL));
  }
  return stratus_density_create(build->context, build->gathered, node->count, build->bandwidth, hybrid_exact(build), &build->density);
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
    build->context, voxels->bricks, voxels->brick_count, build->bandwidth, hybrid_exact(build), &build->density);
}

stratus_status stratus_hybrid_measure(hybrid_build* build, hybrid_work* const* works, uint32_t count)
{
  const bool own = build->options->density_per_node || build->paper;
  if (!own && count && !build->density) {
    TRY(make_common(build));
  }
  for (uint32_t w = 0; w < count; ++w) {
    if (own) {
      TRY(make_own(build, &works[w]->node));
      TRY(build->sums->peaks(build, works + w, 1, true));
    }
    works[w]->measured = true;
    works[w]->bandwidth = build->bandwidth;
    if (build->statistics->bandwidth <= 0.0) {
      build->statistics->bandwidth = build->bandwidth;
    }
  }
  return own || !count ? STRATUS_OK : build->sums->peaks(build, works, count, false);
}

double stratus_hybrid_unevenness(const hybrid_work* work, int paper)
{
  double least = INFINITY, most = 0.0;
  for (int a = 0; a < 3; ++a) {
    const double deviation = sqrt(work->squares[a] / (double)work->voxels); /* eq. 8, voxels */
    const double relative = deviation / (paper ? 1.0 : (double)STRATUS_BRICK * (work->node.hi[a] - work->node.lo[a]));
    least = fmin(least, relative);
    most = fmax(most, relative);
  }
  return most - least;
}

/* Offers the plane between bricks nearest to `position` (voxels) if it divides the node. */
static void offer(hybrid_work* work, int32_t position)
{
  const int32_t brick = (position + STRATUS_BRICK / 2) / STRATUS_BRICK;
  if (brick > work->node.lo[work->axis] && brick < work->node.hi[work->axis]) {
    work->offered[work->offers++] = brick;
  }
}

static int32_t extent_of(const hybrid_work* work)
{
  return STRATUS_BRICK * (work->node.hi[work->axis] - work->node.lo[work->axis]);
}

/* Finds the axis and the side of the steepest fall of each node's density, and its border. */
static stratus_status find_falls(hybrid_build* build, hybrid_work* const* works, uint32_t count)
{
  size_t size = 0;
  void* memory;
  for (uint32_t w = 0; w < count; ++w) {
    works[w]->at = size;
    size += stratus_density_line_start(works[w]->lo, works[w]->hi, 3);
  }
  TRY(stratus_allocate(build->context, size, sizeof(stratus_density_line), &memory));
  stratus_density_line* const lines = memory;
  const stratus_status status = build->sums->lines(build, works, count, lines, size);
  for (uint32_t w = 0; w < count && status == STRATUS_OK; ++w) {
    hybrid_work* work = works[w];
    stratus_density_borders borders;
    double fall = 0.0;
    stratus_density_scan_lines(lines + work->at, work->voxels, work->bandwidth, work->peak, work->lo, work->hi, &borders);
    work->axis = -1;
    for (int i = 0; i < 6; ++i) {
      if (borders.fall[i / 2][i % 2] > fall) {
        fall = borders.fall[i / 2][i % 2];
        work->axis = i / 2;
        work->side = i % 2;
        work->border = borders.position[i / 2][i % 2];
      }
    }
  }
  stratus_release(build->context, memory);
  return status;
}

/* Offers both borders of each peak's cluster. */
static stratus_status offer_clusters(hybrid_build* build, hybrid_work* const* works, uint32_t count)
{
  size_t size = 0;
  void* memory;
  for (uint32_t w = 0; w < count; ++w) {
    works[w]->at = size;
    size += (size_t)extent_of(works[w]);
  }
  TRY(stratus_allocate(build->context, size, sizeof(int64_t), &memory));
  int64_t* const counts = memory;
  const stratus_status status = build->sums->histograms(build, works, count, counts, size);
  for (uint32_t w = 0; w < count && status == STRATUS_OK; ++w) {
    hybrid_work* work = works[w];
    const int32_t start = STRATUS_BRICK * work->node.lo[work->axis], extent = extent_of(work);
    int32_t lo, hi, clusters;
    const int32_t eps = (int32_t)fmin(fmax(floor(work->bandwidth + 0.5), 1.0), STRATUS_AXIS_MAX);
    const double even = (double)work->voxels * fmin((2.0 * eps + 1.0) / extent, 1.0);
    const int64_t least = (int64_t)fmax(ceil(0.5 * even), 1.0);
    work->offers = 0;
    if (stratus_dbscan_counts(counts + work->at, extent, eps, least, work->peak[work->axis] - start, &lo, &hi, &clusters)) {
      offer(work, start + lo);
      offer(work, start + hi);
    }
    work->clustered = work->offers > 0;
    if (!work->clustered) {
      offer(work, work->border);
    }
  }
  stratus_release(build->context, memory);
  return status;
}

stratus_status stratus_hybrid_planes_density(hybrid_build* build, hybrid_work* const* works, uint32_t count)
{
  stratus_status status = STRATUS_OK;
  uint32_t falling = 0;
  void* memory;
  TRY(stratus_allocate(build->context, count, sizeof *works, &memory));
  hybrid_work** const list = memory;
  TRY_CLEANUP(find_falls(build, works, count));
  for (uint32_t w = 0; w < count; ++w) {
    if (works[w]->axis >= 0) {
      list[falling++] = works[w];
    }
  }
  TRY_CLEANUP(offer_clusters(build, list, falling));
  TRY_CLEANUP(build->sums->sides(build, list, falling));
  for (uint32_t w = 0; w < falling; ++w) {
    list[w]->plane = stratus_hybrid_plane_offered(list[w]);
  }
cleanup:
  stratus_release(build->context, memory);
  return status;
}
