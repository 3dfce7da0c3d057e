/* SPDX-License-Identifier: BSD-3-Clause
 * The shape of the hybrid tree (Guo et al. 2025): which nodes become distance fields, and where nodes are split.
 *
 * HYBRID makes a node a distance field as soon as the field is neither too large nor too empty. It computes no density for such a node,
 * because a field suits uneven voxels as well as even ones. All other nodes are split. A node that is only too large is split by the
 * surface area heuristic, because any cut serves. A node that is too empty is split where a cut removes empty space. If its voxels lie
 * unevenly about their density's peak (eq. 8 over the extents, above `uniform`), that is the border of the peak's cluster. The border is
 * rejected if it costs more than 1.25 times the best plane of the surface area heuristic; it then belongs to no real cluster. Even nodes
 * and nodes of few bricks are split by surface area as well. Nodes of few bricks end as leaves of bricks.
 *
 * HYBRID_PAPER follows the paper: it computes density anew at each node, tests evenness in voxels, tests the side with the peak again, and
 * divides the other side by surface area. Unlike the paper, it keeps the default cap on a field's bricks and cuts between bricks. */
#include "hybrid_tree.h"

#include "density_plan.h"
#include "device.h"

#include <stdio.h>
#include <string.h>

#define DENSITY_LEAST 64 /* bricks; in smaller nodes density finds no better planes than boxes do */
#define NEARLY_AS_CHEAP 1.25
#define FIELD_LONGEST (1 << 14) /* cells along an axis of a field; a cell is a brick, in the paper's trees a voxel */
/* Nodes of a level are worked on in batches, so that their sums take some megabytes at most. */
#define BATCH_NODES 4096
#define BATCH_PLANES (1 << 18) /* between voxels, along the three axes of all nodes */

static double volume_of(const hybrid_node* node)
{
  return (double)(node->hi[0] - node->lo[0]) * (node->hi[1] - node->lo[1]) * (node->hi[2] - node->lo[2]);
}

static bool field_fits(const hybrid_build* build, const hybrid_node* node)
{
  bool fits = volume_of(node) <= (double)build->options->field_bricks;
  for (int a = 0; a < 3; ++a) {
    fits = fits && node->hi[a] - node->lo[a] <= FIELD_LONGEST / (build->paper ? STRATUS_BRICK : 1);
  }
  return fits;
}

static bool too_empty(const hybrid_build* build, const hybrid_node* node)
{
  return volume_of(node) > build->options->field_emptiness * (double)node->count;
}

static bool field_pays(const hybrid_build* build, const hybrid_node* node)
{
  return field_fits(build, node) && !too_empty(build, node);
}

static bool has_density(const hybrid_build* build, const hybrid_node* node)
{
  return build->paper ? !node->sparse : node->count >= DENSITY_LEAST && too_empty(build, node);
}

/* ---- leaves */

static void make_leaf(hybrid_build* build, const hybrid_node* node, stratus_node_kind kind)
{
  stratus_tree_node* leaf = build->shape->nodes + node->number;
  leaf->first = node->first;
  leaf->kind_count = stratus_tree_kind_count(kind, node->count);
}

/* Makes the node a leaf if no sum over its bricks is needed for that; returns whether it did. */
static bool settles(hybrid_build* build, const hybrid_node* node)
{
  const stratus_tree_options* options = build->options;
  if ((int64_t)node->count <= options->leaf_bricks || (node->depth == options->max_depth && (node->sparse || !field_fits(build, node)))) {
    make_leaf(build, node, STRATUS_NODE_BRICKS);
    return true;
  }
  if (node->depth == options->max_depth || (!build->paper && field_pays(build, node))) {
    make_leaf(build, node, STRATUS_NODE_FIELD);
    return true;
  }
  return false;
}

/* ---- where to split */

/* Tests whether the voxels lie evenly about their peak, for nodes that have one. */
static stratus_status test_nodes(hybrid_build* build, hybrid_work* works, uint32_t count, hybrid_work** list)
{
  uint32_t measured = 0;
  for (uint32_t w = 0; w < count; ++w) {
    works[w].even = true;
    if (has_density(build, &works[w].node)) {
      list[measured++] = &works[w];
    }
  }
  TRY(stratus_hybrid_measure(build, list, measured));
  for (uint32_t w = 0; w < measured; ++w) {
    const double uneven = stratus_hybrid_unevenness(list[w], build->paper);
    list[w]->even = build->paper ? uneven < build->options->paper_threshold : uneven <= build->options->uniform;
    if (build->paper && list[w]->even && field_fits(build, &list[w]->node)) {
      make_leaf(build, &list[w]->node, STRATUS_NODE_FIELD);
      list[w]->settled = true;
    }
  }
  return STRATUS_OK;
}

/* Finds planes by density for uneven nodes. */
static stratus_status find_density_planes(hybrid_build* build, hybrid_work* works, uint32_t count, hybrid_work** list)
{
  uint32_t uneven = 0;
  for (uint32_t w = 0; w < count; ++w) {
    works[w].plane = (hybrid_plane){ .axis = -1, .cost = INFINITY };
    if (works[w].measured && !works[w].even && !works[w].settled) {
      list[uneven++] = &works[w];
    }
  }
  return stratus_hybrid_planes_density(build, list, uneven);
}

/* Count the chosen plane. If its larger side could not end in leaves of `leaf_bricks` within max_depth, but the node could, then replace it
 * by the median. */
static stratus_status keep_depth(hybrid_build* build, hybrid_work* work, int* how)
{
  const hybrid_node* node = &work->node;
  const int levels = build->options->max_depth - node->depth;
  const uint64_t leaf = (uint64_t)build->options->leaf_bricks;
  const uint32_t below = work->plane.below, larger = below > node->count - below ? below : node->count - below;
  if (levels <= 32 && node->count <= leaf << levels && node->count > leaf << (levels - 1) && larger > leaf << (levels - 1)) {
    TRY(build->sums->order(build, node->first, node->count));
    work->plane = stratus_hybrid_plane_median(build, node);
    how = &build->statistics->median_splits;
  }
  ++*how;
  return STRATUS_OK;
}

/* Chooses the plane of every node that has not become a leaf: that by density, or by surface area where there is none or where it is
 * cheaper by far. */
static stratus_status choose_planes(hybrid_build* build, hybrid_work* works, uint32_t count, hybrid_work** list)
{
  stratus_tree_statistics* statistics = build->statistics;
  stratus_status status = STRATUS_OK;
  size_t size = 0;
  uint32_t open = 0;
  void* memory;
  for (uint32_t w = 0; w < count; ++w) {
    hybrid_work* work = &works[w];
    if (!work->settled && (work->plane.axis < 0 || !build->paper)) {
      work->at = size;
      size += (size_t)(hybrid_bins_along(&work->node, 0) + hybrid_bins_along(&work->node, 1) + hybrid_bins_along(&work->node, 2));
      list[open++] = work;
    }
  }
  TRY(stratus_allocate(build->context, size, sizeof(hybrid_bin), &memory));
  hybrid_bin* const bins = memory;
  TRY_CLEANUP(build->sums->bins(build, list, open, bins, size));
  open = 0;
  for (uint32_t w = 0; w < count; ++w) {
    hybrid_work* work = &works[w];
    int* how = work->clustered ? &statistics->dbscan_splits : &statistics->density_splits;
    if (work->settled) {
      continue;
    }
    if (work->plane.axis < 0 || !build->paper) {
      const hybrid_plane sah = stratus_hybrid_plane_sah(&work->node, bins + work->at);
      if (work->plane.axis < 0 || work->plane.cost > NEARLY_AS_CHEAP * sah.cost) {
        work->plane = sah;
        how = &statistics->sah_splits;
      }
    }
    TRY_CLEANUP(keep_depth(build, work, how));
  }
cleanup:
  stratus_release(build->context, memory);
  return status;
}

/* ---- nodes */

static stratus_status reserve_nodes(hybrid_build* build, uint32_t count)
{
  stratus_tree_shape* shape = build->shape;
  void* memory;
  if (count <= build->node_max) {
    return STRATUS_OK;
  }
  uint32_t wanted = build->node_max < 32 ? 64 : 2 * build->node_max;
  wanted = wanted < count ? count : wanted;
  TRY(stratus_allocate(build->context, wanted, sizeof *shape->nodes, &memory));
  if (shape->node_count) {
    memcpy(memory, shape->nodes, shape->node_count * sizeof *shape->nodes);
  }
  stratus_release(build->context, shape->nodes);
  shape->nodes = memory;
  build->node_max = wanted;
  return STRATUS_OK;
}

/* Makes the node an inner one, whose children go to the next level. */
static void add_children(hybrid_build* build, hybrid_work* work, hybrid_node children[2])
{
  stratus_tree_shape* shape = build->shape;
  const uint32_t first = shape->node_count;
  shape->nodes[work->node.number].first = first;
  shape->nodes[work->node.number].kind_count = stratus_tree_kind_count(STRATUS_NODE_INNER, 0);
  shape->node_count += 2;
  for (uint32_t side = 0; side < 2; ++side) {
    shape->nodes[first + side] = work->box[side];
    children[side] = work->child[side];
    children[side].number = first + side;
    children[side].depth = work->node.depth + 1;
    children[side].sparse = work->node.sparse;
  }
  if (build->paper && !work->node.sparse && !work->even) {
    /* The side without the peak is divided by surface area only. If an even node is too large for a field, both sides are tested. */
    const int above = work->peak[work->plane.axis] >= STRATUS_BRICK * work->plane.brick;
    children[!above].sparse = 1;
  }
}

/* Makes leaves of some nodes of a batch and splits the others; next[] gets their *next_count children. list: room for the batch. */
static stratus_status split_batch(
  hybrid_build* build, hybrid_work* works, uint32_t count, hybrid_work** list, hybrid_node* next, uint32_t* next_count)
{
  uint32_t open = 0;
  TRY(test_nodes(build, works, count, list));
  TRY(find_density_planes(build, works, count, list));
  TRY(choose_planes(build, works, count, list));
  for (uint32_t w = 0; w < count; ++w) {
    if (!works[w].settled) {
      list[open++] = &works[w];
    }
  }
  TRY(build->sums->divide(build, list, open));
  TRY(reserve_nodes(build, build->shape->node_count + 2 * open));
  for (uint32_t w = 0; w < open; ++w) {
    add_children(build, list[w], next + *next_count);
    *next_count += 2;
  }
  return STRATUS_OK;
}

static hybrid_work work_on(const hybrid_build* build, const hybrid_node* node)
{
  hybrid_work work = { .node = *node, .axis = -1 };
  memcpy(work.lo, build->shape->nodes[node->number].lo, sizeof work.lo);
  memcpy(work.hi, build->shape->nodes[node->number].hi, sizeof work.hi);
  return work;
}

/* Works on a level's nodes, batch by batch; next[] gets the *next_count nodes of the next level. room: for BATCH_NODES nodes each. */
static stratus_status grow_level(hybrid_build* build, const hybrid_node* nodes, uint32_t count, hybrid_work* room, hybrid_work** list,
  hybrid_node* next, uint32_t* next_count)
{
  uint32_t n = 0;
  *next_count = 0;
  while (n < count) {
    uint32_t open = 0;
    size_t planes = 0;
    for (; n < count && open < BATCH_NODES && planes < BATCH_PLANES; ++n) {
      if (!settles(build, &nodes[n])) {
        room[open] = work_on(build, &nodes[n]);
        planes += stratus_density_line_start(room[open].lo, room[open].hi, 3);
        ++open;
      }
    }
    if (open) {
      TRY(stratus_progress(build->context, "tree", 0.0));
      TRY(split_batch(build, room, open, list, next, next_count));
    }
  }
  return STRATUS_OK;
}

static stratus_status grow_from(hybrid_build* build, const hybrid_node* root)
{
  stratus_status status = STRATUS_OK;
  uint32_t count = 1;
  void *nodes = NULL, *next = NULL, *room = NULL, *list = NULL;
  TRY_CLEANUP(stratus_allocate(build->context, 1, sizeof *root, &nodes));
  *(hybrid_node*)nodes = *root;
  TRY_CLEANUP(stratus_allocate(build->context, BATCH_NODES, sizeof(hybrid_work), &room));
  TRY_CLEANUP(stratus_allocate(build->context, BATCH_NODES, sizeof(hybrid_work*), &list));
  while (count) {
    TRY_CLEANUP(stratus_allocate(build->context, (size_t)count * 2, sizeof *root, &next));
    TRY_CLEANUP(grow_level(build, nodes, count, room, list, next, &count));
    stratus_release(build->context, nodes);
    nodes = next;
    next = NULL;
  }
  TRY_CLEANUP(build->sums->order(build, 0, root->count));
cleanup:
  stratus_release(build->context, list);
  stratus_release(build->context, room);
  stratus_release(build->context, next);
  stratus_release(build->context, nodes);
  return status;
}

/* Makes the shape a single node of all bricks, in their order. */
static void begin(hybrid_build* build)
{
  stratus_tree_statistics* s = build->statistics;
  build->shape->node_count = 1;
  for (uint32_t b = 0; b < (uint32_t)build->voxels->brick_count; ++b) {
    build->shape->order[b] = b;
  }
  for (int a = 0; a < 3; ++a) {
    build->shape->nodes[0].lo[a] = (int32_t)build->voxels->lo[a];
    build->shape->nodes[0].hi[a] = (int32_t)build->voxels->hi[a];
  }
  s->bandwidth = 0.0;
  s->dbscan_splits = s->density_splits = s->sah_splits = s->median_splits = 0;
}

static stratus_status grow_tree(hybrid_build* build)
{
  hybrid_node root = { .count = (uint32_t)build->voxels->brick_count };
  for (int a = 0; a < 3; ++a) {
    root.lo[a] = (int32_t)(build->voxels->lo[a] / STRATUS_BRICK);
    root.hi[a] = (int32_t)((build->voxels->hi[a] + STRATUS_BRICK - 1) / STRATUS_BRICK);
  }
  build->volume = volume_of(&root);
  begin(build);
  if (settles(build, &root)) {
    return STRATUS_OK; /* most trees are one field */
  }
  if (stratus_hybrid_on_device(build)) {
    stratus_status status = stratus_hybrid_device_create(build);
    build->sums = &stratus_hybrid_sums_device;
    if (status == STRATUS_OK) {
      status = grow_from(build, &root);
    }
    stratus_hybrid_device_destroy(build);
    if (!stratus_device_hands_back(build->context, status)) {
      return status;
    }
    build->sums = &stratus_hybrid_sums_host;
    begin(build);
  }
  return grow_from(build, &root);
}

/* Renumber the nodes in the order of a walk that finishes the lower child first, so that nodes that a ray visits together are near each
 * other in memory. */
static stratus_status number_by_depth(hybrid_build* build)
{
  stratus_tree_shape* shape = build->shape;
  void* memory;
  uint32_t stack[STRATUS_HYBRID_DEPTH_MAX + 2], waiting = 1, next = 1;
  TRY(stratus_allocate(build->context, shape->node_count, sizeof *shape->nodes, &memory));
  stratus_tree_node* const nodes = memory;
  nodes[0] = shape->nodes[0];
  stack[0] = 0;
  while (waiting > 0) {
    stratus_tree_node* node = nodes + stack[--waiting];
    if (stratus_tree_node_kind(node) == STRATUS_NODE_INNER) {
      memcpy(nodes + next, shape->nodes + node->first, 2 * sizeof *nodes);
      node->first = next;
      stack[waiting++] = next + 1;
      stack[waiting++] = next;
      next += 2;
    }
  }
  stratus_release(build->context, shape->nodes);
  shape->nodes = nodes;
  return STRATUS_OK;
}

/* ---- the whole shape */

static void explain(const hybrid_build* build)
{
  stratus_tree_statistics* s = build->statistics;
  const stratus_tree_options* options = build->options;
  const double count = (double)build->voxels->brick_count, volume = build->volume;
  uint32_t fields = 0, leaves = 0;
  for (uint32_t n = 0; n < build->shape->node_count; ++n) {
    fields += stratus_tree_node_kind(build->shape->nodes + n) == STRATUS_NODE_FIELD;
    leaves += stratus_tree_node_kind(build->shape->nodes + n) == STRATUS_NODE_BRICKS;
  }
  if (build->shape->node_count == 1) {
    snprintf(s->why, sizeof s->why,
      "one %s: %.0f occupied bricks in a box of %.0f; a distance field may cover %lld, and %g for each occupied one",
      fields ? "distance field" : "leaf of bricks", count, volume, (long long)options->field_bricks, options->field_emptiness);
    return;
  }
  snprintf(s->why, sizeof s->why,
    "%.0f occupied bricks in a box of %.0f: %s; fields %u, leaves of bricks %u; splits by cluster %d, density %d, surface area %d, median "
    "%d",
    count, volume,
    build->paper                               ? "the paper's node test fails"
      : volume > (double)options->field_bricks ? "too large for one field"
                                               : "too empty for one field",
    fields, leaves, s->dbscan_splits, s->density_splits, s->sah_splits, s->median_splits);
}

stratus_status stratus_hybrid_tree_shape(stratus_context* context, const stratus_voxels* voxels, const stratus_tree_options* options,
  stratus_tree_shape* shape, stratus_tree_statistics* statistics)
{
  stratus_status status = STRATUS_OK;
  const uint32_t bricks = (uint32_t)voxels->brick_count;
  hybrid_build build = {
    .context = context, .voxels = voxels, .options = options, .statistics = statistics, .shape = shape, .sums = &stratus_hybrid_sums_host
  };
  void* memory;
  build.paper = options->method == STRATUS_TREE_HYBRID_PAPER;
  if (voxels->brick_count > STRATUS_NODE_COUNT_MAX) {
    return stratus_fail(
      context, STRATUS_OVERFLOW, "%lld bricks: a tree takes at most %u", (long long)voxels->brick_count, STRATUS_NODE_COUNT_MAX);
  }
  *shape = (stratus_tree_shape){ .nodes = NULL };
  TRY_CLEANUP(stratus_allocate(context, bricks, sizeof *shape->order, &memory));
  shape->order = memory;
  TRY_CLEANUP(stratus_allocate(context, bricks, sizeof *build.scratch, &memory));
  build.scratch = memory;
  TRY_CLEANUP(reserve_nodes(&build, 1));
  TRY_CLEANUP(grow_tree(&build));
  TRY_CLEANUP(number_by_depth(&build));
  explain(&build);

cleanup:
  stratus_density_destroy(build.density);
  stratus_release(context, build.scratch);
  stratus_release(context, build.gathered);
  if (status != STRATUS_OK) {
    stratus_release(context, shape->nodes);
    stratus_release(context, shape->order);
    *shape = (stratus_tree_shape){ .nodes = NULL };
  }
  return status;
}
