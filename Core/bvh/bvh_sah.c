/* SPDX-License-Identifier: BSD-3-Clause
 * Binned surface area heuristic (SAH; Wald 2007), top-down. At each node the boxes' middles sort them into bins along every axis, and the
 * node splits at the cheapest border between bins. Where the middles span fewer values than there are bins, each value has its own bin and
 * the split is exact. Bins hold integers, so that the tree does not depend on how threads share the work. */
#include "bvh_build.h"

#define BINS 32
#define TASK_ITEMS 2048       /* a smaller range stays with the thread that finds it */
#define CHUNK_ITEMS (1 << 15) /* larger ranges are binned by several threads */

typedef struct bin {
  stratus_box box;
  uint32_t count;
} bin;

typedef struct binning {
  int32_t least[3];
  int bins[3]; /* 1 if all middles agree along the axis */
  double scale[3];
  bin bin[3][BINS];
} binning;

typedef struct split {
  double cost;
  int axis; /* -1 if there is none */
  int bin;  /* first bin of the right side */
} split;

static int bin_of(const binning* b, const stratus_box* box, int axis)
{
  return (int)((double)(stratus_box_middle(box, axis) - b->least[axis]) * b->scale[axis]);
}

/* ---- bounds of the middles, hi included */

static stratus_box bound_middles(const stratus_bvh_item* items, uint32_t begin, uint32_t end)
{
  stratus_box bounds = stratus_box_none();
  for (uint32_t i = begin; i < end; ++i) {
    for (int a = 0; a < 3; ++a) {
      const int32_t middle = stratus_box_middle(&items[i].box, a);
      bounds.lo[a] = middle < bounds.lo[a] ? middle : bounds.lo[a];
      bounds.hi[a] = middle > bounds.hi[a] ? middle : bounds.hi[a];
    }
  }
  return bounds;
}

static void bound_chunk(const stratus_bvh_item* items, uint32_t begin, uint32_t end, stratus_box* bounds)
{
  const stratus_box own = bound_middles(items, begin, end);
#pragma omp critical(stratus_bvh_bounds)
  stratus_box_add(bounds, &own);
}

static uint32_t chunk_end(uint32_t first, uint32_t end)
{
  return end - first > CHUNK_ITEMS ? first + CHUNK_ITEMS : end;
}

static stratus_box bound_middles_by_chunks(const stratus_bvh_item* items, uint32_t begin, uint32_t end)
{
  stratus_box bounds = stratus_box_none();
  stratus_box* const shared_bounds = &bounds;
#pragma omp taskgroup
  for (uint32_t first = begin; first < end; first += CHUNK_ITEMS) {
#pragma omp task
    bound_chunk(items, first, chunk_end(first, end), shared_bounds);
  }
  return bounds;
}

/* ---- bins */

static void empty_bins(binning* b, const stratus_box* middles)
{
  for (int a = 0; a < 3; ++a) {
    const int64_t places = (int64_t)middles->hi[a] - middles->lo[a] + 1;
    b->least[a] = middles->lo[a];
    b->bins[a] = places < BINS ? (int)places : BINS;
    b->scale[a] = (double)b->bins[a] / (double)places;
    for (int i = 0; i < b->bins[a]; ++i) {
      b->bin[a][i] = (bin){ stratus_box_none(), 0 };
    }
  }
}

static void fill_bins(binning* b, const stratus_bvh_item* items, uint32_t begin, uint32_t end)
{
  for (int a = 0; a < 3; ++a) {
    for (uint32_t i = begin; b->bins[a] > 1 && i < end; ++i) {
      bin* to = b->bin[a] + bin_of(b, &items[i].box, a);
      stratus_box_add(&to->box, &items[i].box);
      ++to->count;
    }
  }
}

static void fill_chunk(binning* b, const stratus_box* middles, const stratus_bvh_item* items, uint32_t begin, uint32_t end)
{
  binning own;
  empty_bins(&own, middles);
  fill_bins(&own, items, begin, end);
#pragma omp critical(stratus_bvh_bins)
  for (int a = 0; a < 3; ++a) {
    for (int i = 0; i < own.bins[a]; ++i) {
      stratus_box_add(&b->bin[a][i].box, &own.bin[a][i].box);
      b->bin[a][i].count += own.bin[a][i].count;
    }
  }
}

static void fill_bins_by_chunks(binning* b, const stratus_box* middles, const stratus_bvh_item* items, uint32_t begin, uint32_t end)
{
#pragma omp taskgroup
  for (uint32_t first = begin; first < end; first += CHUNK_ITEMS) {
#pragma omp task
    fill_chunk(b, middles, items, first, chunk_end(first, end));
  }
}

static void find_split_along(const binning* b, int axis, split* best)
{
  double right_cost[BINS];
  bin right = { stratus_box_none(), 0 }, left = right;
  for (int i = b->bins[axis] - 1; i > 0; --i) {
    stratus_box_add(&right.box, &b->bin[axis][i].box);
    right.count += b->bin[axis][i].count;
    right_cost[i] = right.count ? stratus_box_area(&right.box) * (double)right.count : 0.0;
  }
  for (int i = 1; i < b->bins[axis]; ++i) {
    stratus_box_add(&left.box, &b->bin[axis][i - 1].box);
    left.count += b->bin[axis][i - 1].count;
    /* The first and the last bin are never empty, so neither side is. */
    const double cost = stratus_box_area(&left.box) * (double)left.count + right_cost[i];
    if (cost < best->cost) {
      *best = (split){ cost, axis, i };
    }
  }
}

/* Partitions the items by side; returns the first item of the right side. */
static uint32_t part_items(const binning* b, const split* s, stratus_bvh_item* items, uint32_t begin, uint32_t end)
{
  for (;;) {
    while (begin < end && bin_of(b, &items[begin].box, s->axis) < s->bin) {
      ++begin;
    }
    while (begin < end && bin_of(b, &items[end - 1].box, s->axis) >= s->bin) {
      --end;
    }
    if (begin == end) {
      return begin;
    }
    const stratus_bvh_item swap = items[begin];
    items[begin++] = items[--end];
    items[end] = swap;
  }
}

static uint32_t split_range(stratus_bvh_item* items, uint32_t begin, uint32_t end)
{
  binning b;
  split best = { INFINITY, -1, 0 };
  const bool large = end - begin > 2 * CHUNK_ITEMS;
  const stratus_box middles = large ? bound_middles_by_chunks(items, begin, end) : bound_middles(items, begin, end);
  empty_bins(&b, &middles);
  if (large) {
    fill_bins_by_chunks(&b, &middles, items, begin, end);
  } else {
    fill_bins(&b, items, begin, end);
  }
  for (int a = 0; a < 3; ++a) {
    find_split_along(&b, a, &best);
  }
  return best.axis < 0 ? begin + (end - begin) / 2 : part_items(&b, &best, items, begin, end);
}

void stratus_bvh_split_items(
  stratus_bvh_item* items, uint32_t begin, uint32_t end, int depth, int max_depth, stratus_bvh_pair* pairs, uint32_t* child)
{
  for (; end - begin > 1; ++depth) {
    const uint32_t middle = end - begin == 2 || depth >= max_depth ? begin + (end - begin) / 2 : split_range(items, begin, end);
    stratus_bvh_pair* pair = pairs + (middle - 1);
    *child = middle - 1;
#pragma omp task if (middle - begin >= TASK_ITEMS)
    stratus_bvh_split_items(items, begin, middle, depth + 1, max_depth, pairs, pair->child);
    child = pair->child + 1;
    begin = middle;
  }
  *child = STRATUS_BVH_LEAF | items[begin].rank;
}

stratus_status stratus_bvh_items_create(const stratus_bvh_build* build, stratus_bvh_item** items)
{
  void* memory;
  TRY(stratus_allocate(build->context, build->count, sizeof **items, &memory));
  *items = memory;
#pragma omp parallel for schedule(static) num_threads(build->context->threads)
  for (uint32_t i = 0; i < build->count; ++i) {
    (*items)[i] = (stratus_bvh_item){ build->boxes[i], i };
  }
  return STRATUS_OK;
}

stratus_status stratus_bvh_build_sah(stratus_bvh_build* build)
{
  stratus_bvh_item* items = NULL;
  TRY(stratus_bvh_items_create(build, &items));
#pragma omp parallel num_threads(build->context->threads)
#pragma omp single
  stratus_bvh_split_items(items, 0, build->count, 0, build->max_depth, build->pairs, &build->root);
  stratus_release(build->context, items);
  return STRATUS_OK;
}
