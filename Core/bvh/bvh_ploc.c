/* SPDX-License-Identifier: BSD-3-Clause
 * Parallel locally-ordered clustering (Meister & Bittner 2018). Clusters are in Morton order. Each finds the neighbour, at most RADIUS
 * places away, that makes the least box with it, and two clusters that chose each other merge. Rounds repeat until one cluster is left.
 * Ties go to the neighbour whose place gives the least XOR with the cluster's own. Both sides then choose the same pair, so that every
 * round merges something, and in a lattice or among boxes in one place half of the clusters. A device makes the same tree. */
#include "bvh_build.h"

#include "device.h"

#include <string.h>

#define RADIUS 16
#define CHUNK 2048

/* Boxes as floats, one array for each coordinate, which vectorises. They only guide the merging; the layout computes exact boxes. */
typedef struct clusters {
  float* side[6];  /* lo x y z, hi x y z */
  uint32_t* child; /* as in a pair */
} clusters;

typedef struct ploc {
  stratus_bvh_build* build;
  clusters now, next;
  uint32_t* nearest; /* by cluster: place of its nearest cluster */
  uint32_t* kept;    /* by chunk: clusters that remain after the round, then the sum over all chunks before */
  uint32_t* merged;  /* by chunk: merges, then the same sum */
  uint32_t count, pairs;
} ploc;

/* Half of the surface area of the union of cluster i with each of `count` clusters from `first` on. The function is symmetric to the
 * bit. */
static void union_areas(const clusters* c, uint32_t i, uint32_t first, uint32_t count, float* areas)
{
  const float lx = c->side[0][i], ly = c->side[1][i], lz = c->side[2][i], hx = c->side[3][i], hy = c->side[4][i], hz = c->side[5][i];
  const float *alx = c->side[0] + first, *aly = c->side[1] + first, *alz = c->side[2] + first;
  const float *ahx = c->side[3] + first, *ahy = c->side[4] + first, *ahz = c->side[5] + first;
  for (uint32_t j = 0; j < count; ++j) {
    const float x = (ahx[j] > hx ? ahx[j] : hx) - (alx[j] < lx ? alx[j] : lx);
    const float y = (ahy[j] > hy ? ahy[j] : hy) - (aly[j] < ly ? aly[j] : ly);
    const float z = (ahz[j] > hz ? ahz[j] : hz) - (alz[j] < lz ? alz[j] : lz);
    areas[j] = x * y + y * z + z * x;
  }
}

static uint32_t find_nearest(const ploc* p, uint32_t i)
{
  float areas[2 * RADIUS + 1];
  const uint32_t first = i > RADIUS ? i - RADIUS : 0, end = p->count - i > RADIUS ? i + RADIUS + 1 : p->count;
  uint32_t best = i;
  float best_area = INFINITY;
  union_areas(&p->now, i, first, end - first, areas);
  for (uint32_t j = first; j < end; ++j) {
    const float area = areas[j - first];
    if (j != i && (area < best_area || (area == best_area && (i ^ j) < (i ^ best)))) {
      best = j;
      best_area = area;
    }
  }
  return best;
}

static uint32_t chunk_end(const ploc* p, uint32_t chunk)
{
  return p->count - chunk * CHUNK > CHUNK ? (chunk + 1) * CHUNK : p->count;
}

static bool merges(const ploc* p, uint32_t i)
{
  return p->nearest[p->nearest[i]] == i;
}

static void count_chunk(const ploc* p, uint32_t chunk)
{
  uint32_t kept = 0, merged = 0;
  for (uint32_t i = chunk * CHUNK; i < chunk_end(p, chunk); ++i) {
    const bool pair = merges(p, i);
    kept += !pair || i < p->nearest[i];
    merged += pair && i < p->nearest[i];
  }
  p->kept[chunk] = kept;
  p->merged[chunk] = merged;
}

static void move_chunk(const ploc* p, uint32_t chunk)
{
  uint32_t to = p->kept[chunk], pair = p->pairs + p->merged[chunk];
  for (uint32_t i = chunk * CHUNK; i < chunk_end(p, chunk); ++i) {
    const uint32_t j = p->nearest[i];
    const bool merging = merges(p, i);
    if (merging && j < i) {
      continue;
    }
    const uint32_t other = merging ? j : i;
    for (int s = 0; s < 6; ++s) {
      const float a = p->now.side[s][i], b = p->now.side[s][other];
      p->next.side[s][to] = (s < 3) == (a < b) ? a : b;
    }
    p->next.child[to] = p->now.child[i];
    if (merging) {
      p->build->pairs[pair] = (stratus_bvh_pair){ { p->now.child[i], p->now.child[j] } };
      p->next.child[to] = pair++;
    }
    ++to;
  }
}

static void run_round(ploc* p)
{
  const int threads = p->build->context->threads;
  const uint32_t chunks = (p->count - 1) / CHUNK + 1;
  uint32_t kept = 0, merged = 0;
#pragma omp parallel num_threads(threads) if (chunks > 1)
  {
#pragma omp for schedule(static)
    for (uint32_t i = 0; i < p->count; ++i) {
      p->nearest[i] = find_nearest(p, i);
    }
#pragma omp for schedule(static)
    for (uint32_t chunk = 0; chunk < chunks; ++chunk) {
      count_chunk(p, chunk);
    }
#pragma omp single
    for (uint32_t chunk = 0; chunk < chunks; ++chunk) {
      const uint32_t here_kept = p->kept[chunk], here_merged = p->merged[chunk];
      p->kept[chunk] = kept;
      p->merged[chunk] = merged;
      kept += here_kept;
      merged += here_merged;
    }
#pragma omp for schedule(static)
    for (uint32_t chunk = 0; chunk < chunks; ++chunk) {
      move_chunk(p, chunk);
    }
  }
  const clusters swap = p->now;
  p->now = p->next;
  p->next = swap;
  p->count = kept;
  p->pairs += merged;
}

static stratus_status make_clusters(const stratus_bvh_build* build, clusters* c)
{
  void* memory;
  TRY(stratus_allocate(build->context, build->count, 6 * sizeof(float), &memory));
  for (int s = 0; s < 6; ++s) {
    c->side[s] = (float*)memory + (size_t)s * build->count;
  }
  TRY(stratus_allocate(build->context, build->count, sizeof(uint32_t), &memory));
  c->child = memory;
  return STRATUS_OK;
}

static void start_clusters(const stratus_bvh_build* build, const clusters* c)
{
#pragma omp parallel for schedule(static) num_threads(build->context->threads)
  for (uint32_t i = 0; i < build->count; ++i) {
    for (int a = 0; a < 3; ++a) {
      c->side[a][i] = (float)build->boxes[i].lo[a];
      c->side[3 + a][i] = (float)build->boxes[i].hi[a];
    }
    c->child[i] = STRATUS_BVH_LEAF | i;
  }
}

static stratus_status build_on_host(stratus_bvh_build* build)
{
  stratus_status status = STRATUS_OK;
  stratus_context* context = build->context;
  ploc p = { .build = build, .count = build->count };
  const uint32_t chunks = (build->count - 1) / CHUNK + 1;
  void *nearest = NULL, *counts = NULL;

  TRY_CLEANUP(make_clusters(build, &p.now));
  TRY_CLEANUP(make_clusters(build, &p.next));
  TRY_CLEANUP(stratus_allocate(context, build->count, sizeof(uint32_t), &nearest));
  TRY_CLEANUP(stratus_allocate(context, chunks, 2 * sizeof(uint32_t), &counts));
  p.nearest = nearest;
  p.kept = counts;
  p.merged = p.kept + chunks;
  start_clusters(build, &p.now);
  while (p.count > 1) {
    run_round(&p);
  }

cleanup:
  stratus_release(context, p.now.side[0]);
  stratus_release(context, p.now.child);
  stratus_release(context, p.next.side[0]);
  stratus_release(context, p.next.child);
  stratus_release(context, nearest);
  stratus_release(context, counts);
  return status;
}

stratus_status stratus_bvh_build_ploc(stratus_bvh_build* build)
{
  build->root = build->count - 2; /* the last round's pair */
  if (stratus_device_takes_boxes(build->context, build->count)) {
    const stratus_status status = stratus_device_ploc(build->context, build->boxes, build->count, build->pairs);
    if (!stratus_device_hands_back(build->context, status)) {
      return status;
    }
  }
  return build_on_host(build);
}
