/* SPDX-License-Identifier: BSD-3-Clause
 * Builds wide hierarchies, level by level. A range of bricks in Morton order becomes a node. A node opens the child whose codes differ in
 * the highest bit, until it has 16 children or all of them have at most 16 bricks. So nodes above bricks are full, and the memory is the
 * bricks' own and about 14 bytes more for each brick. */
#include "wide_tree.h"

#include "bvh_build.h"
#include "morton.h"
#include "radix_sort.h"

#include <string.h>

/* Where a node's children begin among the sorted bricks; child c holds the bricks cut[c] .. cut[c + 1] - 1. */
typedef struct cuts {
  uint32_t cut[STRATUS_WIDE + 1];
  uint32_t count, inner;
} cuts;

/* A node without boxes: its sorted bricks first .. end - 1, and the fields of stratus_wide_node about its children. */
typedef struct stem {
  uint32_t first, end, node, brick;
  uint8_t count, inner;
} stem;

typedef struct wide_build {
  stratus_context* context;
  uint64_t* codes;          /* sorted */
  uint32_t *sorted, *order; /* the brick of each code; of each leaf in the nodes' order */
  stem* stems;
  uint32_t node_count, capacity, placed; /* placed: bricks that are leaves so far */
} wide_build;

stratus_box stratus_wide_box(const stratus_wide_node* node, int c)
{
  stratus_box box;
  for (int a = 0; a < 3; ++a) {
    box.lo[a] = (int32_t)node->at[a] + (node->lo[a][c] << node->shift);
    box.hi[a] = (int32_t)node->at[a] + (node->hi[a][c] << node->shift);
  }
  return box;
}

/* First and last set bit of a mask that is not empty, in steps of 1 << log2 bits. */
static inline void span(uint64_t bits, int log2, int32_t at, int32_t* lo, int32_t* hi)
{
  *lo = at + (__builtin_ctzll(bits) >> log2);
  *hi = at + ((63 - __builtin_clzll(bits)) >> log2) + 1;
}

stratus_box stratus_brick_box(const stratus_brick* brick)
{
  const uint64_t mask = brick->mask, plane = (mask | mask >> 16 | mask >> 32 | mask >> 48) & 0xffff;
  const uint64_t row = (plane | plane >> 4 | plane >> 8 | plane >> 12) & 0xf;
  stratus_box box;
  span(row, 0, 4 * brick->at[0], &box.lo[0], &box.hi[0]);
  span(plane, 2, 4 * brick->at[1], &box.lo[1], &box.hi[1]);
  span(mask, 4, 4 * brick->at[2], &box.lo[2], &box.hi[2]);
  return box;
}

/* ---------------------------------------------------------------- order */

static stratus_status sort_bricks(wide_build* build, const stratus_brick* bricks, uint32_t count)
{
  uint32_t least[3] = { UINT32_MAX, UINT32_MAX, UINT32_MAX }, extent = 0;
  int axis_bits = 0;
  for (uint32_t b = 0; b < count; ++b) {
    for (int a = 0; a < 3; ++a) {
      least[a] = bricks[b].at[a] < least[a] ? bricks[b].at[a] : least[a];
    }
  }
#pragma omp parallel for schedule(static) num_threads(build->context->threads) reduction(| : extent)
  for (uint32_t b = 0; b < count; ++b) {
    const uint32_t x = bricks[b].at[0] - least[0], y = bricks[b].at[1] - least[1], z = bricks[b].at[2] - least[2];
    build->codes[b] = morton_code(x, y, z, 0);
    build->sorted[b] = b;
    extent |= x | y | z;
  }
  while (extent >> axis_bits) {
    ++axis_bits;
  }
  TRY(stratus_radix_sort(build->context, build->codes, build->sorted, count, 3 * axis_bits));
  for (uint32_t b = 1; b < count; ++b) {
    if (build->codes[b] == build->codes[b - 1]) {
      const stratus_brick* twice = &bricks[build->sorted[b]];
      return stratus_fail(
        build->context, STRATUS_INVALID_ARGUMENT, "brick %d %d %d is there twice", twice->at[0], twice->at[1], twice->at[2]);
    }
  }
  return STRATUS_OK;
}

/* ---------------------------------------------------------------- levels */

/* The highest bit in which codes of the range differ; -1 where the range is not to be opened. */
static int openness(const wide_build* build, uint32_t first, uint32_t end)
{
  return end - first <= STRATUS_WIDE ? -1 : 63 - __builtin_clzll(build->codes[first] ^ build->codes[end - 1]);
}

/* The first brick of the range whose code has the bit set. */
static uint32_t upper_half(const wide_build* build, uint32_t first, uint32_t end, int bit)
{
  while (first < end) {
    const uint32_t middle = first + (end - first) / 2;
    if (build->codes[middle] >> bit & 1) {
      end = middle;
    } else {
      first = middle + 1;
    }
  }
  return first;
}

static void open_range(const wide_build* build, uint32_t first, uint32_t end, cuts* to)
{
  int open[STRATUS_WIDE];
  uint32_t n = 1;
  if (end - first <= STRATUS_WIDE) {
    for (n = 0; first + n < end; ++n) {
      to->cut[n] = first + n;
    }
    to->cut[n] = end;
    to->count = n;
    to->inner = 0;
    return;
  }
  to->cut[0] = first;
  to->cut[1] = end;
  open[0] = openness(build, first, end);
  while (n < STRATUS_WIDE) {
    uint32_t best = 0;
    for (uint32_t c = 1; c < n; ++c) {
      best = open[c] > open[best] ? c : best;
    }
    if (open[best] < 0) {
      break;
    }
    const uint32_t middle = upper_half(build, to->cut[best], to->cut[best + 1], open[best]);
    memmove(to->cut + best + 2, to->cut + best + 1, (n - best) * sizeof *to->cut);
    memmove(open + best + 1, open + best, (n - best) * sizeof *open);
    to->cut[best + 1] = middle;
    open[best] = openness(build, to->cut[best], middle);
    open[best + 1] = openness(build, middle, to->cut[best + 2]);
    ++n;
  }
  to->count = n;
  to->inner = 0;
  for (uint32_t c = 0; c < n; ++c) {
    to->inner += to->cut[c + 1] - to->cut[c] > 1;
  }
}

static stratus_status reserve(wide_build* build, uint32_t count)
{
  void* stems;
  if (count <= build->capacity) {
    return STRATUS_OK;
  }
  const uint32_t wanted = count > 2 * build->capacity ? count : 2 * build->capacity;
  TRY(stratus_allocate(build->context, wanted, sizeof *build->stems, &stems));
  if (build->node_count) {
    memcpy(stems, build->stems, build->node_count * sizeof *build->stems);
  }
  stratus_release(build->context, build->stems);
  build->stems = stems;
  build->capacity = wanted;
  return STRATUS_OK;
}

/* Gives the node its children: ranges of the next level, and leaves. */
static void place_children(wide_build* build, const cuts* from, stem* node)
{
  uint32_t inner = 0, leaves = 0;
  node->count = (uint8_t)from->count;
  node->inner = (uint8_t)from->inner;
  for (uint32_t c = 0; c < from->count; ++c) {
    if (from->cut[c + 1] - from->cut[c] > 1) {
      build->stems[node->node + inner++] = (stem){ .first = from->cut[c], .end = from->cut[c + 1] };
    } else {
      build->order[node->brick + leaves++] = build->sorted[from->cut[c]];
    }
  }
}

/* Opens the nodes first .. end - 1, and appends the next level's. */
static stratus_status grow_level(wide_build* build, uint32_t first, uint32_t end)
{
  const int64_t n = end - first;
  uint32_t next = end, brick = build->placed;
  void* memory;
  TRY(stratus_allocate(build->context, (size_t)n, sizeof(cuts), &memory));
  cuts* const all = memory;
#pragma omp parallel for schedule(static) num_threads(build->context->threads)
  for (int64_t i = 0; i < n; ++i) {
    open_range(build, build->stems[first + i].first, build->stems[first + i].end, &all[i]);
  }
  for (int64_t i = 0; i < n; ++i) {
    build->stems[first + i].node = next;
    build->stems[first + i].brick = brick;
    next += all[i].inner;
    brick += all[i].count - all[i].inner;
  }
  const stratus_status status = reserve(build, next);
  if (status == STRATUS_OK) {
#pragma omp parallel for schedule(static) num_threads(build->context->threads)
    for (int64_t i = 0; i < n; ++i) {
      place_children(build, &all[i], &build->stems[first + i]);
    }
    build->node_count = next;
    build->placed = brick;
  }
  stratus_release(build->context, all);
  return status;
}

/* ---------------------------------------------------------------- boxes */

/* Makes a node of a stem. boxes: of the nodes behind it; its own is set. */
static void enclose(const stem* from, const stratus_brick* bricks, stratus_box* boxes, uint32_t number, stratus_wide_node* node)
{
  stratus_box child[STRATUS_WIDE], all = stratus_box_none();
  int32_t extent = 0;
  int shift = 0;
  for (int c = 0; c < from->count; ++c) {
    child[c] = c < from->inner ? boxes[from->node + (uint32_t)c] : stratus_brick_box(&bricks[from->brick + (uint32_t)(c - from->inner)]);
    stratus_box_add(&all, &child[c]);
  }
  *node = (stratus_wide_node){ .node = from->node, .brick = from->brick, .count = from->count, .inner = from->inner };
  for (int a = 0; a < 3; ++a) {
    extent = all.hi[a] - all.lo[a] > extent ? all.hi[a] - all.lo[a] : extent;
    node->at[a] = (float)all.lo[a];
  }
  while ((extent + (1 << shift) - 1) >> shift > UINT8_MAX) {
    ++shift;
  }
  node->shift = (uint8_t)shift;
  for (int a = 0; a < 3; ++a) {
    for (int c = 0; c < STRATUS_WIDE; ++c) {
      node->lo[a][c] = c < node->count ? (uint8_t)((child[c].lo[a] - all.lo[a]) >> shift) : UINT8_MAX;
      node->hi[a][c] = c < node->count ? (uint8_t)((child[c].hi[a] - all.lo[a] + (1 << shift) - 1) >> shift) : 0;
    }
  }
  boxes[number] = all;
}

#define CACHE_LINE 64

/* Makes the nodes, a level at a time from the last. Level l ends before node level[l]. */
static stratus_status make_nodes(
  const wide_build* build, const uint32_t* level, uint32_t levels, const stratus_brick* bricks, stratus_wide* wide)
{
  void *memory, *nodes;
  TRY(stratus_allocate(build->context, build->node_count, sizeof(stratus_box), &memory));
  stratus_box* const boxes = memory;
  const stratus_status status = stratus_allocate(build->context, build->node_count * sizeof *wide->nodes + CACHE_LINE, 1, &nodes);
  if (status == STRATUS_OK) {
    wide->memory = nodes;
    wide->nodes = (void*)(((uintptr_t)nodes + CACHE_LINE - 1) / CACHE_LINE * CACHE_LINE);
    wide->node_count = build->node_count;
    while (levels > 0) {
      const int64_t end = level[--levels], first = levels ? level[levels - 1] : 0;
#pragma omp parallel for schedule(static) num_threads(build->context->threads)
      for (int64_t n = first; n < end; ++n) {
        enclose(&build->stems[n], bricks, boxes, (uint32_t)n, &wide->nodes[n]);
      }
    }
  }
  stratus_release(build->context, boxes);
  return status;
}

/* Makes the hierarchy's stems, and then its nodes over the bricks in the leaves' order, *ordered. */
static stratus_status grow(wide_build* build, const stratus_brick* bricks, uint32_t count, stratus_brick** ordered, stratus_wide* wide)
{
  uint32_t level[64], levels = 0;
  void* memory;
  TRY(reserve(build, 1));
  build->stems[0] = (stem){ .first = 0, .end = count };
  build->node_count = 1;
  for (uint32_t first = 0; first < build->node_count; first = level[levels - 1]) {
    level[levels++] = build->node_count;
    TRY(stratus_progress(build->context, "tree", 0.5));
    TRY(grow_level(build, first, build->node_count));
  }
  TRY(stratus_allocate(build->context, count, sizeof *bricks, &memory));
  stratus_brick* const to = *ordered = memory;
#pragma omp parallel for schedule(static) num_threads(build->context->threads)
  for (uint32_t b = 0; b < count; ++b) {
    to[b] = bricks[build->order[b]];
  }
  return make_nodes(build, level, levels, to, wide);
}

stratus_status stratus_wide_create(stratus_context* context, stratus_brick** bricks, uint32_t count, stratus_wide* wide)
{
  wide_build build = { .context = context };
  stratus_status status = STRATUS_OK;
  stratus_brick* ordered = NULL;
  void* memory;
  TRY_CLEANUP(stratus_allocate(context, count, sizeof *build.codes, &memory));
  build.codes = memory;
  TRY_CLEANUP(stratus_allocate(context, count, sizeof *build.sorted, &memory));
  build.sorted = memory;
  TRY_CLEANUP(stratus_allocate(context, count, sizeof *build.order, &memory));
  build.order = memory;
  TRY_CLEANUP(sort_bricks(&build, *bricks, count));
  TRY_CLEANUP(grow(&build, *bricks, count, &ordered, wide));
  stratus_release(context, *bricks);
  *bricks = ordered;
  ordered = NULL;

cleanup:
  stratus_release(context, ordered);
  stratus_release(context, build.stems);
  stratus_release(context, build.order);
  stratus_release(context, build.sorted);
  stratus_release(context, build.codes);
  return status;
}

double stratus_wide_sah(const stratus_wide* wide)
{
  stratus_box root = stratus_box_none();
  double cost = 0.0;
  for (uint32_t n = 0; n < wide->node_count; ++n) {
    for (int c = 0; c < wide->nodes[n].count; ++c) {
      const stratus_box box = stratus_wide_box(&wide->nodes[n], c);
      cost += stratus_box_area(&box);
      if (n == 0) {
        stratus_box_add(&root, &box);
      }
    }
  }
  return 1.0 + cost / stratus_box_area(&root);
}
