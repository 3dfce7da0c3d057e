/* SPDX-License-Identifier: BSD-3-Clause
 * Tree over the clusters of density peaks: an agglomerative tree over the clusters' boxes, with a SAH tree in each cluster. */
#include "bvh_build.h"

#include <string.h>

typedef struct cluster_lists {
  const uint32_t* of; /* cluster of each box, by rank */
  uint32_t count;
  uint32_t *start, *room, **child;
  stratus_box* boxes;
  stratus_bvh_pair* pairs;
} cluster_lists;

/* Sorts the items by cluster and computes each cluster's box. */
static void sort_items(const stratus_bvh_build* build, const cluster_lists* c, const stratus_bvh_item* from, stratus_bvh_item* to)
{
  memset(c->start, 0, (c->count + 1) * sizeof *c->start);
  for (uint32_t i = 0; i < build->count; ++i) {
    ++c->start[c->of[i] + 1];
  }
  for (uint32_t i = 0; i < c->count; ++i) {
    c->start[i + 1] += c->start[i];
    c->room[i] = c->start[i];
    c->boxes[i] = stratus_box_none();
  }
  for (uint32_t i = 0; i < build->count; ++i) {
    stratus_box_add(c->boxes + c->of[i], &from[i].box);
    to[c->room[c->of[i]]++] = from[i];
  }
}

static stratus_status join_clusters(stratus_bvh_build* build, const cluster_lists* c, stratus_bvh_item* items)
{
  stratus_status status = STRATUS_OK;
  stratus_bvh_item* sorted = NULL;
  uint32_t top = 0;
  TRY(stratus_bvh_items_create(build, &sorted));
  sort_items(build, c, items, sorted);
  TRY_CLEANUP(stratus_bvh_agglomerate(build->context, STRATUS_BVH_EDGES, c->boxes, c->count, c->pairs, &top));
  const stratus_bvh_join join = { c->count, c->pairs, top, c->start, c->child, c->room };
  stratus_bvh_join_ranges(&join, sorted, items, build->pairs, &build->root);
#pragma omp parallel for schedule(dynamic, 1) num_threads(build->context->threads)
  for (uint32_t i = 0; i < c->count; ++i) {
    stratus_bvh_split_items(sorted, c->start[i], c->start[i + 1], 0, build->max_depth, build->pairs, c->child[i]);
  }

cleanup:
  stratus_release(build->context, sorted);
  return status;
}

static stratus_status build_over_clusters(stratus_bvh_build* build, const uint32_t* of, uint32_t clusters, stratus_bvh_item* items)
{
  stratus_status status = STRATUS_OK;
  stratus_context* context = build->context;
  cluster_lists c = { .of = of, .count = clusters };
  void *numbers = NULL, *child = NULL, *boxes = NULL, *pairs = NULL;

  TRY_CLEANUP(stratus_allocate(context, 4 * (size_t)clusters + 2, sizeof(uint32_t), &numbers));
  TRY_CLEANUP(stratus_allocate(context, clusters, sizeof *c.child, &child));
  TRY_CLEANUP(stratus_allocate(context, clusters, sizeof *c.boxes, &boxes));
  TRY_CLEANUP(stratus_allocate(context, clusters, sizeof *c.pairs, &pairs));
  c.start = numbers;
  c.room = c.start + clusters + 1;
  c.child = child;
  c.boxes = boxes;
  c.pairs = pairs;
  TRY_CLEANUP(join_clusters(build, &c, items));

cleanup:
  stratus_release(context, numbers);
  stratus_release(context, child);
  stratus_release(context, boxes);
  stratus_release(context, pairs);
  return status;
}

stratus_status stratus_bvh_build_density_peaks(stratus_bvh_build* build)
{
  stratus_status status = STRATUS_OK;
  uint32_t clusters = 0;
  stratus_bvh_item* items = NULL;
  void* cluster = NULL;

  TRY_CLEANUP(stratus_allocate(build->context, build->count, sizeof(uint32_t), &cluster));
  TRY_CLEANUP(stratus_bvh_density_clusters(build, cluster, &clusters));
  TRY_CLEANUP(stratus_bvh_items_create(build, &items));
  if (clusters > 1) {
    TRY_CLEANUP(build_over_clusters(build, cluster, clusters, items));
  } else {
#pragma omp parallel num_threads(build->context->threads)
#pragma omp single
    stratus_bvh_split_items(items, 0, build->count, 0, build->max_depth, build->pairs, &build->root);
  }

cleanup:
  stratus_release(build->context, items);
  stratus_release(build->context, cluster);
  return status;
}
