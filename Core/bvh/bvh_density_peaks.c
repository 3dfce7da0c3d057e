/* SPDX-License-Identifier: BSD-3-Clause
 * Clustering by density peaks (Rodriguez & Laio 2014). A box's density is the number of boxes within a cutoff distance. Its delta is the
 * distance to the nearest box of higher density. The boxes with the greatest density * delta are centres; every other box joins the cluster
 * of its nearest denser neighbour.
 *
 * Boxes with the same middle form one site with a weight. Both searches use a binary tree over the sites in Morton order, whose bounds
 * spare them most pairs. Lengths are squares of half voxels, in integers. Among equal densities the site that comes first counts as
 * denser. */
#include "bvh_build.h"

#include "radix_sort.h"

#include <string.h>

#define LEVELS_MAX 32
#define BOXES_A_CENTRE 64   /* boxes for each cluster, on average */
#define CENTRES_MAX 1024    /* limit on the number of clusters */
#define NEIGHBOURS .01      /* share of all sites within the cutoff, as in the paper */
#define NEIGHBOURS_MAX 128. /* limit on the number of sites within the cutoff */
#define SAMPLES_FROM 128u
#define SAMPLES_TO 2048u

typedef struct block {
  stratus_box bounds; /* of twice the boxes' middles, hi included */
  uint64_t weight;
  uint64_t densest; /* greatest density in the block, as density << 32 | ~site */
} block;

typedef struct density_peaks {
  const stratus_bvh_build* build;
  uint32_t sites;
  uint32_t* first;          /* rank of a site's first box; sites + 1 entries */
  uint32_t* denser;         /* a site's nearest denser site; the densest site names itself */
  uint64_t* delta;          /* squared distance to the nearest denser site */
  uint32_t* cluster;        /* by site */
  uint32_t* order;          /* sites by rising density, or by rising density * delta */
  uint64_t* keys;           /* keys of that order */
  block* level[LEVELS_MAX]; /* block b of level v covers sites b << v .. ((b+1) << v) - 1 */
  int levels;
  uint64_t cutoff; /* squared */
} density_peaks;

static uint32_t level_size(uint32_t count, int level)
{
  return ((count - 1) >> level) + 1;
}

/* ---- distances */

static uint64_t squared(int64_t x, int64_t y, int64_t z)
{
  return (uint64_t)(x * x) + (uint64_t)(y * y) + (uint64_t)(z * z);
}

static uint64_t distance_between(const stratus_box* a, const stratus_box* b) /* between two points, given by their lo */
{
  return squared((int64_t)a->lo[0] - b->lo[0], (int64_t)a->lo[1] - b->lo[1], (int64_t)a->lo[2] - b->lo[2]);
}

static uint64_t least_distance(const stratus_box* point, const stratus_box* bounds)
{
  int64_t d[3];
  for (int a = 0; a < 3; ++a) {
    const int64_t below = (int64_t)bounds->lo[a] - point->lo[a], above = (int64_t)point->lo[a] - bounds->hi[a];
    d[a] = below > 0 ? below : above > 0 ? above : 0;
  }
  return squared(d[0], d[1], d[2]);
}

static uint64_t greatest_distance(const stratus_box* point, const stratus_box* bounds)
{
  int64_t d[3];
  for (int a = 0; a < 3; ++a) {
    const int64_t low = (int64_t)point->lo[a] - bounds->lo[a], high = (int64_t)bounds->hi[a] - point->lo[a];
    d[a] = low > high ? low : high;
  }
  return squared(d[0], d[1], d[2]);
}

/* ---- sites and the tree over them */

static void find_sites(density_peaks* p)
{
  p->sites = 0;
  for (uint32_t i = 0; i < p->build->count; ++i) {
    if (i == 0 || p->build->codes[i] != p->build->codes[i - 1]) {
      p->first[p->sites++] = i;
    }
  }
  p->first[p->sites] = p->build->count;
}

static block merge_blocks(const block* a, const block* b)
{
  block both = *a;
  stratus_box_add(&both.bounds, &b->bounds);
  both.weight += b->weight;
  both.densest = b->densest > both.densest ? b->densest : both.densest;
  return both;
}

static void merge_levels(const density_peaks* p)
{
  for (int level = 1; level < p->levels; ++level) {
    const uint32_t below = level_size(p->sites, level - 1);
#pragma omp parallel for schedule(static) num_threads(p->build->context->threads) if (below > 4096)
    for (uint32_t b = 0; b < level_size(p->sites, level); ++b) {
      const block* first = p->level[level - 1] + 2 * (size_t)b;
      p->level[level][b] = 2 * b + 1 < below ? merge_blocks(first, first + 1) : *first;
    }
  }
}

static stratus_status make_levels(density_peaks* p)
{
  size_t total = 1, at = 0;
  void* memory;
  for (p->levels = 1; level_size(p->sites, p->levels - 1) > 1; ++p->levels) {
    total += level_size(p->sites, p->levels - 1);
  }
  TRY(stratus_allocate(p->build->context, total, sizeof(block), &memory));
  for (int level = 0; level < p->levels; ++level) {
    p->level[level] = (block*)memory + at;
    at += level_size(p->sites, level);
  }
  for (uint32_t s = 0; s < p->sites; ++s) {
    const stratus_box* box = p->build->boxes + p->first[s];
    const int32_t x = stratus_box_middle(box, 0), y = stratus_box_middle(box, 1), z = stratus_box_middle(box, 2);
    p->level[0][s] = (block){ { { x, y, z }, { x, y, z } }, p->first[s + 1] - p->first[s], 0 };
  }
  merge_levels(p);
  return STRATUS_OK;
}

/* Finds the distance within which a site has, on average, the share NEIGHBOURS of all sites. A sample of pairs estimates it. */
static stratus_status find_cutoff(density_peaks* p)
{
  stratus_status status = STRATUS_OK;
  stratus_context* context = p->build->context;
  const uint32_t from = p->sites < SAMPLES_FROM ? p->sites : SAMPLES_FROM, to = p->sites < SAMPLES_TO ? p->sites : SAMPLES_TO;
  uint32_t count = 0;
  void *keys = NULL, *values = NULL;

  TRY_CLEANUP(stratus_allocate(context, (size_t)from * to, sizeof(uint64_t), &keys));
  TRY_CLEANUP(stratus_allocate_zero(context, (size_t)from * to, sizeof(uint32_t), &values));
  uint64_t* distances = keys;
  for (uint32_t i = 0; i < from; ++i) {
    const uint32_t site = (uint32_t)((uint64_t)p->sites * i / from);
    for (uint32_t j = 0; j < to; ++j) {
      const uint32_t other = (uint32_t)((uint64_t)p->sites * j / to);
      if (other != site) {
        distances[count++] = distance_between(&p->level[0][site].bounds, &p->level[0][other].bounds);
      }
    }
  }
  TRY_CLEANUP(stratus_radix_sort(context, distances, values, count, 64));
  const double share = fmin(NEIGHBOURS, NEIGHBOURS_MAX / (double)p->sites);
  p->cutoff = distances[(size_t)(share * (double)(count - 1))];

cleanup:
  stratus_release(context, keys);
  stratus_release(context, values);
  return status;
}

/* ---- density and delta */

static uint64_t count_near(const density_peaks* p, const stratus_box* point, int level, uint32_t b)
{
  const block* at = p->level[level] + b;
  if (least_distance(point, &at->bounds) > p->cutoff) {
    return 0;
  }
  if (greatest_distance(point, &at->bounds) <= p->cutoff) {
    return at->weight;
  }
  const uint32_t first = 2 * b; /* a block of one site never comes here, since its least and greatest distances are equal */
  return count_near(p, point, level - 1, first) +
    (first + 1 < level_size(p->sites, level - 1) ? count_near(p, point, level - 1, first + 1) : 0);
}

static void find_densities(const density_peaks* p)
{
#pragma omp parallel for schedule(dynamic, 64) num_threads(p->build->context->threads)
  for (uint32_t s = 0; s < p->sites; ++s) {
    p->keys[s] = count_near(p, &p->level[0][s].bounds, p->levels - 1, 0);
  }
  for (uint32_t s = 0; s < p->sites; ++s) {
    p->level[0][s].densest = p->keys[s] << 32 | ~s;
  }
  merge_levels(p);
}

typedef struct denser_search {
  const density_peaks* p;
  const block* site;
  uint32_t number, best;
  uint64_t distance;
} denser_search;

static void search_block(denser_search* s, int level, uint32_t b)
{
  const block* at = s->p->level[level] + b;
  if (at->densest <= s->site->densest) {
    return;
  }
  const uint64_t distance = least_distance(&s->site->bounds, &at->bounds);
  if (distance >= s->distance) {
    return;
  }
  if (level == 0) {
    s->best = b;
    s->distance = distance;
    return;
  }
  const uint32_t near = 2 * b + (s->number >> (level - 1) & 1);
  for (uint32_t c = 0; c < 2; ++c) {
    if ((near ^ c) < level_size(s->p->sites, level - 1)) {
      search_block(s, level - 1, near ^ c);
    }
  }
}

/* Searches near blocks first: those whose numbers share the most bits with the site's. */
static void find_denser(const density_peaks* p)
{
#pragma omp parallel for schedule(dynamic, 64) num_threads(p->build->context->threads)
  for (uint32_t number = 0; number < p->sites; ++number) {
    denser_search s = { p, p->level[0] + number, number, number, UINT64_MAX };
    for (int level = 0; level < p->levels; ++level) {
      const uint32_t sibling = (number >> level) ^ 1u;
      if (sibling < level_size(p->sites, level)) {
        search_block(&s, level, sibling);
      }
    }
    p->denser[number] = s.best;
    /* The densest site has no denser one. A delta above all others makes it a centre. */
    p->delta[number] = s.best != number ? s.distance : 4 * greatest_distance(&s.site->bounds, &p->level[p->levels - 1]->bounds);
  }
}

/* ---- clusters */

static stratus_status sort_sites(const density_peaks* p)
{
  for (uint32_t s = 0; s < p->sites; ++s) {
    p->order[s] = s;
  }
  return stratus_radix_sort(p->build->context, p->keys, p->order, p->sites, 64);
}

/* Finds each site's cluster. Clusters are numbered in the order of the sites; *clusters is their number. */
static stratus_status find_clusters(const density_peaks* p, uint32_t* number, uint32_t* clusters)
{
  const uint32_t wanted = p->build->count / BOXES_A_CENTRE, most = wanted < 2 ? 2 : wanted < CENTRES_MAX ? wanted : CENTRES_MAX;
  for (uint32_t s = 0; s < p->sites; ++s) {
    const double gamma = (double)(p->level[0][s].densest >> 32) * sqrt((double)p->delta[s]);
    memcpy(p->keys + s, &gamma, sizeof gamma); /* positive doubles sort as their bits do */
    p->cluster[s] = UINT32_MAX;
  }
  TRY(sort_sites(p));
  for (uint32_t c = 0; c < most && c < p->sites; ++c) {
    p->cluster[p->order[p->sites - 1 - c]] = p->order[p->sites - 1 - c];
  }
  for (uint32_t s = 0; s < p->sites; ++s) {
    p->keys[s] = p->level[0][s].densest;
    number[s] = UINT32_MAX;
  }
  TRY(sort_sites(p));
  for (uint32_t i = p->sites; i-- > 0;) {
    const uint32_t s = p->order[i];
    if (p->cluster[s] == UINT32_MAX) {
      p->cluster[s] = p->denser[s] == s ? s : p->cluster[p->denser[s]];
    }
  }
  *clusters = 0;
  for (uint32_t s = 0; s < p->sites; ++s) {
    uint32_t* n = number + p->cluster[s];
    *n = *n == UINT32_MAX ? (*clusters)++ : *n;
    p->cluster[s] = *n;
  }
  return STRATUS_OK;
}

static stratus_status cluster_sites(density_peaks* p, uint32_t* clusters)
{
  stratus_context* context = p->build->context;
  void* number = NULL;
  TRY(make_levels(p));
  TRY(find_cutoff(p));
  find_densities(p);
  find_denser(p);
  TRY(stratus_allocate(context, p->sites, sizeof(uint32_t), &number));
  const stratus_status status = find_clusters(p, number, clusters);
  stratus_release(context, number);
  return status;
}

stratus_status stratus_bvh_density_clusters(const stratus_bvh_build* build, uint32_t* cluster, uint32_t* clusters)
{
  stratus_status status = STRATUS_OK;
  stratus_context* context = build->context;
  density_peaks p = { .build = build };
  const size_t count = build->count;
  void *numbers = NULL, *wide = NULL;

  TRY_CLEANUP(stratus_allocate(context, 4 * count + 1, sizeof(uint32_t), &numbers));
  TRY_CLEANUP(stratus_allocate(context, 2 * count, sizeof(uint64_t), &wide));
  p.denser = numbers;
  p.cluster = p.denser + count;
  p.order = p.cluster + count;
  p.first = p.order + count;
  p.delta = wide;
  p.keys = p.delta + count;
  find_sites(&p);
  *clusters = 1;
  p.cluster[0] = 0;
  if (p.sites > 1) {
    TRY_CLEANUP(cluster_sites(&p, clusters));
  }
  for (uint32_t s = 0; s < p.sites; ++s) {
    for (uint32_t i = p.first[s]; i < p.first[s + 1]; ++i) {
      cluster[i] = p.cluster[s];
    }
  }

cleanup:
  stratus_release(context, p.level[0]);
  stratus_release(context, numbers);
  stratus_release(context, wide);
  return status;
}
