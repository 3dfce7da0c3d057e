/* SPDX-License-Identifier: BSD-3-Clause
 * Agglomerative clustering (Walter et al. 2008): the two clusters whose union is smallest merge, until one is left. The size is the union's
 * surface area, as in the paper, or the sum of its edges.
 *
 * Neither makes the cheaper tree of every set. Nodes of up to 8 voxels cost less than the sweep's, but clusters grow without regard to each
 * other and do not tile a volume: by surface area, the boxes of an evenly filled volume's nodes of 64 to 255 voxels have twice the volume
 * of the set's box, the sweep's as much as that box. Such trees cost 1.19 to 1.24 times as much as the sweep's on the sets of record 17K to
 * 35K, and 1.23 to 1.27 times on even noise. By edges small clusters are rounder and overlap less: 1.10 to 1.14, and 1.17 to 1.18.
 * Voxels of a surface, such as the paper's scenes have, leave room around each cluster: 1.08 to 1.10 by surface area, 1.12 to 1.14 by
 * edges. The order of ties changes a cost by a fiftieth at most.
 *
 * By either measure, merging never shrinks the distance of two clusters. Two clusters that are each other's nearest may therefore merge at
 * once, in any order, and the tree is the one of the greedy method. The search for nearest clusters runs in rounds, and in parallel.
 *
 * A merged cluster keeps the lower of its two places. Among clusters at equal distance the nearest is the one whose place gives the least
 * XOR with the searching place. Merging preserves this order too, so that ties, which are the rule in a lattice, leave no choice.
 *
 * A binary tree over places bounds the search. A node keeps the greatest lo and the least hi of its clusters along each axis: a union with
 * any of them is at least as large as the union with that interval. The search visits nodes in rising order of the XOR of places, so that a
 * tie found later never wins. */
#include "bvh_build.h"

#define LEVELS_MAX 32
#define SEARCHES_SHARED 64 /* searches in a round that are worth several threads */

/* Interval that each box of a node reaches across: the greatest lo and the least hi, so that hi < lo as a rule. lo INT32_MIN and hi
 * INT32_MAX: the node has no box. */
typedef struct reach {
  int32_t lo[3], hi[3];
} reach;

typedef struct agglomeration {
  stratus_context* context;
  stratus_bvh_measure measure;
  uint32_t count;
  stratus_bvh_pair* pairs;
  uint32_t made;    /* number of pairs */
  stratus_box* box; /* by place, as are the next three arrays */
  uint32_t* child;  /* as in a pair */
  uint32_t* nearest;
  uint32_t* changed; /* round of the place's last merge */
  uint32_t* live;    /* places that hold a cluster */
  uint32_t* search;  /* places whose nearest cluster is searched in this round */
  uint32_t live_count, search_count, round;
  reach* level[LEVELS_MAX]; /* node n of level v covers places n << v .. ((n+1) << v) - 1 */
  int levels;
} agglomeration;

static reach reach_none(void)
{
  return (reach){ { INT32_MIN, INT32_MIN, INT32_MIN }, { INT32_MAX, INT32_MAX, INT32_MAX } };
}

static void reach_add(reach* r, const reach* other)
{
  for (int a = 0; a < 3; ++a) {
    r->lo[a] = other->lo[a] > r->lo[a] ? other->lo[a] : r->lo[a];
    r->hi[a] = other->hi[a] < r->hi[a] ? other->hi[a] : r->hi[a];
  }
}

static uint32_t level_size(uint32_t count, int level)
{
  return ((count - 1) >> level) + 1;
}

/* ---- search */

typedef struct nearest_search {
  const agglomeration* g;
  stratus_box box;
  uint32_t place;
  uint32_t best;
  double best_distance;
} nearest_search;

static double least_union(const agglomeration* g, const stratus_box* box, const reach* r)
{
  double edge[3];
  for (int a = 0; a < 3; ++a) {
    const int32_t lo = r->lo[a] < box->lo[a] ? r->lo[a] : box->lo[a], hi = r->hi[a] > box->hi[a] ? r->hi[a] : box->hi[a];
    edge[a] = (double)hi - (double)lo;
  }
  return g->measure == STRATUS_BVH_SURFACE ? edge[0] * edge[1] + edge[1] * edge[2] + edge[2] * edge[0] : edge[0] + edge[1] + edge[2];
}

static void search_node(nearest_search* s, int level, uint32_t node)
{
  const reach* r = s->g->level[level] + node;
  if (r->hi[0] == INT32_MAX) {
    return;
  }
  const double distance = least_union(s->g, &s->box, r);
  if (distance >= s->best_distance) {
    return;
  }
  if (level == 0) {
    s->best = node;
    s->best_distance = distance;
    return;
  }
  const uint32_t near = 2 * node + (s->place >> (level - 1) & 1); /* the half that shares one more bit with the place */
  for (int c = 0; c < 2; ++c) {
    const uint32_t child = near ^ (uint32_t)c;
    if (child < level_size(s->g->count, level - 1)) {
      search_node(s, level - 1, child);
    }
  }
}

static uint32_t find_nearest(const agglomeration* g, uint32_t place)
{
  nearest_search s = { g, g->box[place], place, place, INFINITY };
  for (int level = 0; level < g->levels; ++level) {
    const uint32_t sibling = (place >> level) ^ 1u;
    if (sibling < level_size(g->count, level)) {
      search_node(&s, level, sibling);
    }
  }
  return s.best;
}

/* ---- changes */

static void update_reach(const agglomeration* g, uint32_t place, bool holds)
{
  reach* leaf = g->level[0] + place;
  *leaf = reach_none();
  if (holds) {
    const stratus_box* box = g->box + place;
    *leaf = (reach){ { box->lo[0], box->lo[1], box->lo[2] }, { box->hi[0], box->hi[1], box->hi[2] } };
  }
  for (int level = 1; level < g->levels; ++level) {
    const uint32_t node = place >> level, first = 2 * node;
    reach r = g->level[level - 1][first];
    if (first + 1 < level_size(g->count, level - 1)) {
      reach_add(&r, g->level[level - 1] + first + 1);
    }
    g->level[level][node] = r;
  }
}

static void merge(agglomeration* g, uint32_t low, uint32_t high)
{
  g->pairs[g->made] = (stratus_bvh_pair){ { g->child[low], g->child[high] } };
  g->child[low] = g->made++;
  stratus_box_add(g->box + low, g->box + high);
  g->changed[low] = g->changed[high] = g->round;
  g->nearest[high] = high; /* marks the place as empty */
  update_reach(g, low, true);
  update_reach(g, high, false);
}

/* Runs one round. A cluster's nearest remains so until one of the two merges, since no merged cluster is nearer than its parts were. Only
 * clusters where either merged in the last round are searched again. */
static void run_round(agglomeration* g)
{
  uint32_t live = 0;
  g->search_count = 0;
  for (uint32_t i = 0; i < g->live_count; ++i) {
    const uint32_t place = g->live[i];
    if (g->round > 1 && g->nearest[place] == place) {
      continue;
    }
    g->live[live++] = place;
    if (g->round == 1 || g->changed[place] == g->round - 1 || g->changed[g->nearest[place]] == g->round - 1) {
      g->search[g->search_count++] = place;
    }
  }
  g->live_count = live;
#pragma omp parallel for schedule(dynamic, 16) num_threads(g->context->threads) if (g->search_count >= SEARCHES_SHARED)
  for (uint32_t i = 0; i < g->search_count; ++i) {
    g->nearest[g->search[i]] = find_nearest(g, g->search[i]);
  }
  /* Of two clusters that are each other's nearest, at least one was searched in this round: else they would have merged before. */
  for (uint32_t i = 0; i < g->search_count; ++i) {
    const uint32_t place = g->search[i], other = g->nearest[place];
    if (g->changed[place] != g->round && other != place && g->nearest[other] == place) {
      merge(g, place < other ? place : other, place < other ? other : place);
    }
  }
  ++g->round;
}

static stratus_status make_reaches(agglomeration* g, const stratus_box* boxes, void** memory)
{
  size_t total = 0, at = 0;
  for (g->levels = 1; level_size(g->count, g->levels - 1) > 1; ++g->levels) {
    total += level_size(g->count, g->levels - 1);
  }
  TRY(stratus_allocate(g->context, total + 1, sizeof(reach), memory));
  for (int level = 0; level < g->levels; ++level) {
    g->level[level] = (reach*)*memory + at;
    at += level_size(g->count, level);
  }
  for (uint32_t i = 0; i < g->count; ++i) {
    const stratus_box* box = boxes + i;
    g->level[0][i] = (reach){ { box->lo[0], box->lo[1], box->lo[2] }, { box->hi[0], box->hi[1], box->hi[2] } };
  }
  for (int level = 1; level < g->levels; ++level) {
    for (uint32_t node = 0; node < level_size(g->count, level); ++node) {
      reach r = g->level[level - 1][2 * (size_t)node];
      if (2 * node + 1 < level_size(g->count, level - 1)) {
        reach_add(&r, g->level[level - 1] + 2 * (size_t)node + 1);
      }
      g->level[level][node] = r;
    }
  }
  return STRATUS_OK;
}

stratus_status stratus_bvh_agglomerate(
  stratus_context* context, stratus_bvh_measure measure, const stratus_box* boxes, uint32_t count, stratus_bvh_pair* pairs, uint32_t* root)
{
  stratus_status status = STRATUS_OK;
  agglomeration g = { .context = context, .measure = measure, .count = count, .pairs = pairs, .live_count = count, .round = 1 };
  void *box = NULL, *numbers = NULL, *reaches = NULL;

  TRY_CLEANUP(stratus_allocate(context, count, sizeof *g.box, &box));
  TRY_CLEANUP(stratus_allocate(context, count, 5 * sizeof(uint32_t), &numbers));
  TRY_CLEANUP(make_reaches(&g, boxes, &reaches));
  g.box = box;
  g.child = numbers;
  g.nearest = g.child + count;
  g.changed = g.nearest + count;
  g.live = g.changed + count;
  g.search = g.live + count;
  for (uint32_t i = 0; i < count; ++i) {
    g.box[i] = boxes[i];
    g.child[i] = STRATUS_BVH_LEAF | i;
    g.nearest[i] = g.live[i] = i;
    g.changed[i] = 0;
  }
  while (g.made < count - 1) {
    run_round(&g);
  }
  *root = count - 2;

cleanup:
  stratus_release(context, box);
  stratus_release(context, numbers);
  stratus_release(context, reaches);
  return status;
}

stratus_status stratus_bvh_build_agglomerative(stratus_bvh_build* build)
{
  return stratus_bvh_agglomerate(build->context, build->measure, build->boxes, build->count, build->pairs, &build->root);
}
