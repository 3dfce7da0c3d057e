/* SPDX-License-Identifier: BSD-3-Clause
 * k-means clustering (Meister & Bittner 2016), top-down. Each node's boxes form at most 8 clusters by the distance of their corners to the
 * clusters' mean corners. Agglomerative clustering joins the clusters, and each cluster becomes a node in turn. Means come from sums of
 * integers, so that they do not depend on the order of threads. */
#include "bvh_build.h"

#include <string.h>

#define CLUSTERS 8
#define ITERATIONS 5
#define CANDIDATES 64
#define TASK_ITEMS 1024       /* a smaller cluster stays with the thread that finds it */
#define CHUNK_ITEMS (1 << 14) /* larger nodes are assigned by several threads */

typedef struct k_means {
  stratus_bvh_item *items, *spare;
  uint8_t* cluster; /* by item */
  stratus_bvh_pair* pairs;
  int max_depth;
} k_means;

typedef struct mean {
  double corner[6]; /* lo, hi */
} mean;

typedef struct sums {
  int64_t corner[CLUSTERS][6];
  int64_t count[CLUSTERS];
} sums;

static double distance_to(const mean* m, const stratus_box* box)
{
  double sum = 0.0;
  for (int a = 0; a < 3; ++a) {
    const double lo = (double)box->lo[a] - m->corner[a], hi = (double)box->hi[a] - m->corner[3 + a];
    sum += lo * lo + hi * hi;
  }
  return sum;
}

static mean mean_of_one(const stratus_box* box)
{
  return (mean){ { box->lo[0], box->lo[1], box->lo[2], box->hi[0], box->hi[1], box->hi[2] } };
}

/* Chooses the first means: boxes far from each other, among candidates evenly spaced in the node's order. */
static void choose_means(const k_means* k, uint32_t begin, uint32_t end, mean means[CLUSTERS])
{
  double least[CANDIDATES];
  const uint32_t candidates = end - begin < CANDIDATES ? end - begin : CANDIDATES;
  uint32_t chosen = 0;
  for (uint32_t c = 0; c < candidates; ++c) {
    least[c] = INFINITY;
  }
  for (int m = 0; m < CLUSTERS; ++m) {
    means[m] = mean_of_one(&k->items[begin + (uint32_t)((uint64_t)(end - begin) * chosen / candidates)].box);
    uint32_t farthest = 0;
    for (uint32_t c = 0; c < candidates; ++c) {
      const stratus_box* box = &k->items[begin + (uint32_t)((uint64_t)(end - begin) * c / candidates)].box;
      const double distance = distance_to(means + m, box);
      least[c] = distance < least[c] ? distance : least[c];
      farthest = least[c] > least[farthest] ? c : farthest;
    }
    chosen = farthest;
  }
}

static void assign_items(const k_means* k, uint32_t begin, uint32_t end, const mean means[CLUSTERS], sums* s)
{
  *s = (sums){ .count = { 0 } };
  for (uint32_t i = begin; i < end; ++i) {
    const stratus_box* box = &k->items[i].box;
    int nearest = 0;
    double least = INFINITY;
    for (int m = 0; m < CLUSTERS; ++m) {
      const double distance = distance_to(means + m, box);
      nearest = distance < least ? m : nearest;
      least = distance < least ? distance : least;
    }
    k->cluster[i] = (uint8_t)nearest;
    ++s->count[nearest];
    for (int a = 0; a < 3; ++a) {
      s->corner[nearest][a] += box->lo[a];
      s->corner[nearest][3 + a] += box->hi[a];
    }
  }
}

static void assign_chunk(const k_means* k, uint32_t begin, uint32_t end, const mean means[CLUSTERS], sums* s)
{
  sums own;
  assign_items(k, begin, end, means, &own);
#pragma omp critical(stratus_k_means)
  for (int m = 0; m < CLUSTERS; ++m) {
    s->count[m] += own.count[m];
    for (int c = 0; c < 6; ++c) {
      s->corner[m][c] += own.corner[m][c];
    }
  }
}

static void assign_by_chunks(const k_means* k, uint32_t begin, uint32_t end, const mean means[CLUSTERS], sums* s)
{
  *s = (sums){ .count = { 0 } };
#pragma omp taskgroup
  for (uint32_t first = begin; first < end; first += CHUNK_ITEMS) {
#pragma omp task
    assign_chunk(k, first, end - first > CHUNK_ITEMS ? first + CHUNK_ITEMS : end, means, s);
  }
}

/* Sorts the items by cluster. start[] gets the first item of each cluster that has any, and the end. Returns the number of these
 * clusters. */
static uint32_t sort_items(const k_means* k, uint32_t begin, uint32_t end, const int64_t counts[CLUSTERS], uint32_t start[CLUSTERS + 1])
{
  uint32_t to[CLUSTERS], at = begin, clusters = 0;
  for (int m = 0; m < CLUSTERS; ++m) {
    to[m] = at;
    if (counts[m]) {
      start[clusters++] = at;
    }
    at += (uint32_t)counts[m];
  }
  start[clusters] = end;
  for (uint32_t i = begin; i < end; ++i) {
    k->spare[to[k->cluster[i]]++] = k->items[i];
  }
  memcpy(k->items + begin, k->spare + begin, (end - begin) * sizeof *k->items);
  return clusters;
}

static uint32_t find_clusters(const k_means* k, uint32_t begin, uint32_t end, uint32_t start[CLUSTERS + 1])
{
  mean means[CLUSTERS];
  sums s;
  choose_means(k, begin, end, means);
  for (int iteration = 0;; ++iteration) {
    if (end - begin > 2 * CHUNK_ITEMS) {
      assign_by_chunks(k, begin, end, means, &s);
    } else {
      assign_items(k, begin, end, means, &s);
    }
    if (iteration == ITERATIONS) {
      return sort_items(k, begin, end, s.count, start);
    }
    for (int m = 0; m < CLUSTERS; ++m) {
      for (int c = 0; c < 6 && s.count[m]; ++c) {
        means[m].corner[c] = (double)s.corner[m][c] / (double)s.count[m];
      }
    }
  }
}

/* Agglomerative clustering of 2 to CLUSTERS boxes, which it overwrites. */
static void merge_few(stratus_box* boxes, uint32_t count, stratus_bvh_pair* pairs)
{
  uint32_t child[CLUSTERS];
  for (uint32_t i = 0; i < count; ++i) {
    child[i] = STRATUS_BVH_LEAF | i;
  }
  for (uint32_t left = count; left > 1; --left) {
    uint32_t low = 0, high = 1;
    double least = INFINITY;
    for (uint32_t i = 0; i < left; ++i) {
      for (uint32_t j = i + 1; j < left; ++j) {
        stratus_box both = boxes[i];
        stratus_box_add(&both, boxes + j);
        const double area = stratus_box_area(&both);
        if (area < least) {
          least = area;
          low = i;
          high = j;
        }
      }
    }
    stratus_box_add(boxes + low, boxes + high);
    pairs[count - left] = (stratus_bvh_pair){ { child[low], child[high] } };
    child[low] = count - left;
    boxes[high] = boxes[left - 1];
    child[high] = child[left - 1];
  }
}

/* Find the ranges that a node splits into: single items if there are few, otherwise its clusters. A node splits into halves if it has only
 * one cluster or is at the depth's bound. */
static uint32_t find_ranges(const k_means* k, uint32_t begin, uint32_t end, int depth, uint32_t start[CLUSTERS + 1])
{
  uint32_t ranges = 0;
  if (end - begin <= CLUSTERS) {
    for (ranges = 0; ranges <= end - begin; ++ranges) {
      start[ranges] = begin + ranges;
    }
    return end - begin;
  }
  if (depth < k->max_depth) {
    ranges = find_clusters(k, begin, end, start);
  }
  if (ranges < 2) {
    memcpy(start, (const uint32_t[]){ begin, begin + (end - begin) / 2, end }, 3 * sizeof *start);
    ranges = 2;
  }
  return ranges;
}

static void split_node(const k_means* k, uint32_t begin, uint32_t end, int depth, uint32_t* child)
{
  if (end - begin == 1) {
    *child = STRATUS_BVH_LEAF | k->items[begin].rank;
    return;
  }
  uint32_t start[CLUSTERS + 1], room[3 * CLUSTERS + 1], *result[CLUSTERS];
  stratus_box boxes[CLUSTERS];
  stratus_bvh_pair of[CLUSTERS - 1];
  const uint32_t ranges = find_ranges(k, begin, end, depth, start);
  for (uint32_t r = 0; r < ranges; ++r) {
    boxes[r] = stratus_box_none();
    for (uint32_t i = start[r]; i < start[r + 1]; ++i) {
      stratus_box_add(boxes + r, &k->items[i].box);
    }
  }
  merge_few(boxes, ranges, of);
  const stratus_bvh_join join = { ranges, of, ranges - 2, start, result, room };
  stratus_bvh_join_ranges(&join, k->items, k->spare, k->pairs, child);
  for (uint32_t r = 0; r < ranges; ++r) {
    const uint32_t first = start[r], last = start[r + 1];
    uint32_t* range_child = result[r];
#pragma omp task if (last - first >= TASK_ITEMS)
    split_node(k, first, last, depth + 1, range_child);
  }
}

stratus_status stratus_bvh_build_k_means(stratus_bvh_build* build)
{
  stratus_status status = STRATUS_OK;
  stratus_context* context = build->context;
  k_means k = { .pairs = build->pairs, .max_depth = build->max_depth };
  void *spare = NULL, *cluster = NULL;

  TRY_CLEANUP(stratus_bvh_items_create(build, &k.items));
  TRY_CLEANUP(stratus_allocate(context, build->count, sizeof *k.spare, &spare));
  TRY_CLEANUP(stratus_allocate(context, build->count, 1, &cluster));
  k.spare = spare;
  k.cluster = cluster;
#pragma omp parallel num_threads(context->threads)
#pragma omp single
  split_node(&k, 0, build->count, 0, &build->root);

cleanup:
  stratus_release(context, k.items);
  stratus_release(context, spare);
  stratus_release(context, cluster);
  return status;
}
