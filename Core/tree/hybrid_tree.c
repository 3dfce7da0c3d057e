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

#include <stdio.h>
#include <string.h>

#define DEPTH_MAX 64
#define DENSITY_LEAST 64 /* bricks; in smaller nodes density finds no better planes than boxes do */
#define NEARLY_AS_CHEAP 1.25
#define FIELD_LONGEST (1 << 14) /* cells along an axis of a field; a cell is a brick, in the paper's trees a voxel */

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

/* ---- where to split */

/* Halves the bricks if the larger side could no longer be divided into leaves of `leaf_bricks`, though the node itself could. */
static void keep_depth(hybrid_build* build, const hybrid_node* node, hybrid_plane* plane, int** how)
{
  const int levels = build->options->max_depth - node->depth;
  const uint64_t leaf = (uint64_t)build->options->leaf_bricks;
  if (levels > 32 || node->count > leaf << levels || node->count <= leaf << (levels - 1)) {
    return;
  }
  const uint32_t below = stratus_hybrid_plane_below(build, node, plane);
  if ((below > node->count - below ? below : node->count - below) > leaf << (levels - 1)) {
    *plane = stratus_hybrid_plane_median(build, node);
    *how = &build->statistics->median_splits;
  }
}

/* Chooses the plane that splits a node. *even is 1 if the node passes its method's node test. */
static stratus_status choose_plane(hybrid_build* build, const hybrid_node* node, hybrid_view* view, hybrid_plane* plane, int* even)
{
  stratus_tree_statistics* statistics = build->statistics;
  hybrid_plane dense = { .axis = -1, .cost = INFINITY };
  int clustered = 0;
  *even = 1;
  if (build->paper ? !node->sparse : node->count >= DENSITY_LEAST && too_empty(build, node)) {
    TRY(stratus_hybrid_measure(build, node, view));
    const double uneven = stratus_hybrid_unevenness(node, view, build->paper);
    *even = build->paper ? uneven < build->options->paper_threshold : uneven <= build->options->uniform;
    if (build->paper && *even && field_fits(build, node)) {
      return STRATUS_OK; /* the node becomes a leaf */
    }
    if (!*even) {
      TRY(stratus_hybrid_plane_density(build, node, view, &dense, &clustered));
    }
  }
  int* how = clustered ? &statistics->dbscan_splits : &statistics->density_splits;
  *plane = dense;
  if (dense.axis < 0 || !build->paper) {
    const hybrid_plane sah = stratus_hybrid_plane_sah(build, node);
    if (dense.axis < 0 || dense.cost > NEARLY_AS_CHEAP * sah.cost) {
      *plane = sah;
      how = &statistics->sah_splits;
    }
  }
  keep_depth(build, node, plane, &how);
  ++*how;
  return STRATUS_OK;
}

/* ---- nodes */

static stratus_status reserve_nodes(hybrid_build* build, uint32_t count)
{
  stratus_tree_shape* shape = build->shape;
  void* memory;
  if (count <= build->node_max) {
    return STRATUS_OK;
  }
  const uint32_t wanted = build->node_max < 32 ? 64 : 2 * build->node_max;
  TRY(stratus_allocate(build->context, wanted, sizeof *shape->nodes, &memory));
  if (shape->node_count) {
    memcpy(memory, shape->nodes, shape->node_count * sizeof *shape->nodes);
  }
  stratus_release(build->context, shape->nodes);
  shape->nodes = memory;
  build->node_max = wanted;
  return STRATUS_OK;
}

static void make_leaf(hybrid_build* build, const hybrid_node* node, stratus_node_kind kind)
{
  stratus_tree_node* leaf = build->shape->nodes + node->number;
  leaf->first = node->first;
  leaf->kind_count = stratus_tree_kind_count(kind, node->count);
}

/* Splits the node into the children sides[]. */
static stratus_status split(hybrid_build* build, const hybrid_node* node, const hybrid_plane* plane, hybrid_node sides[2])
{
  stratus_tree_shape* shape = build->shape;
  const uint32_t first = shape->node_count;
  TRY(reserve_nodes(build, first + 2));
  stratus_hybrid_partition(build, node, plane, sides, shape->nodes + first);
  shape->nodes[node->number].first = first;
  shape->nodes[node->number].kind_count = stratus_tree_kind_count(STRATUS_NODE_INNER, 0);
  shape->node_count += 2;
  for (uint32_t side = 0; side < 2; ++side) {
    sides[side].number = first + side;
    sides[side].depth = node->depth + 1;
    sides[side].sparse = node->sparse;
  }
  return STRATUS_OK;
}

/* Makes the node a leaf, or splits it. *count is the number of its children. */
static stratus_status decide(hybrid_build* build, const hybrid_node* node, hybrid_node sides[2], int* count)
{
  const stratus_tree_options* options = build->options;
  hybrid_plane plane;
  hybrid_view view;
  int even;
  *count = 0;
  if ((int64_t)node->count <= options->leaf_bricks || (node->depth == options->max_depth && (node->sparse || !field_fits(build, node)))) {
    make_leaf(build, node, STRATUS_NODE_BRICKS);
    return STRATUS_OK;
  }
  if (node->depth == options->max_depth || (!build->paper && field_pays(build, node))) {
    make_leaf(build, node, STRATUS_NODE_FIELD);
    return STRATUS_OK;
  }
  TRY(choose_plane(build, node, &view, &plane, &even));
  if (build->paper && !node->sparse && even && field_fits(build, node)) {
    make_leaf(build, node, STRATUS_NODE_FIELD);
    return STRATUS_OK;
  }
  TRY(split(build, node, &plane, sides));
  *count = 2;
  if (build->paper && !node->sparse && !even) {
    /* The side without the peak is divided by surface area only. If an even node is too large for a field, both sides are tested. */
    const int above = view.peak[plane.axis] >= STRATUS_BRICK * plane.brick;
    sides[!above].sparse = 1;
  }
  return STRATUS_OK;
}

static stratus_status grow_tree(hybrid_build* build)
{
  hybrid_node stack[DEPTH_MAX + 2];
  int waiting = 1;
  stack[0] = (hybrid_node){ .count = (uint32_t)build->voxels->brick_count };
  for (int a = 0; a < 3; ++a) {
    stack[0].lo[a] = (int32_t)(build->voxels->lo[a] / STRATUS_BRICK);
    stack[0].hi[a] = (int32_t)((build->voxels->hi[a] + STRATUS_BRICK - 1) / STRATUS_BRICK);
    build->shape->nodes[0].lo[a] = (int32_t)build->voxels->lo[a];
    build->shape->nodes[0].hi[a] = (int32_t)build->voxels->hi[a];
  }
  build->volume = volume_of(stack);
  while (waiting > 0) {
    const hybrid_node node = stack[--waiting];
    hybrid_node sides[2];
    int count;
    TRY(decide(build, &node, sides, &count));
    for (int i = count - 1; i >= 0; --i) {
      stack[waiting++] = sides[i];
    }
  }
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
  hybrid_build build = { .context = context, .voxels = voxels, .options = options, .statistics = statistics, .shape = shape };
  void* memory;
  build.paper = options->method == STRATUS_TREE_HYBRID_PAPER;
  if (voxels->brick_count > STRATUS_NODE_COUNT_MAX) {
    return stratus_fail(
      context, STRATUS_OVERFLOW, "%lld bricks: a tree takes at most %u", (long long)voxels->brick_count, STRATUS_NODE_COUNT_MAX);
  }
  *shape = (stratus_tree_shape){ .nodes = NULL };
  statistics->bandwidth = 0.0;
  statistics->dbscan_splits = statistics->density_splits = statistics->sah_splits = statistics->median_splits = 0;
  TRY_CLEANUP(stratus_allocate(context, bricks, sizeof *shape->order, &memory));
  shape->order = memory;
  for (uint32_t b = 0; b < bricks; ++b) {
    shape->order[b] = b;
  }
  TRY_CLEANUP(stratus_allocate(context, bricks, sizeof *build.scratch, &memory));
  build.scratch = memory;
  TRY_CLEANUP(reserve_nodes(&build, 1));
  shape->node_count = 1;
  TRY_CLEANUP(grow_tree(&build));
  explain(&build);

cleanup:
  stratus_density_destroy(build.density);
  stratus_release(context, build.scratch);
  stratus_release(context, build.counts);
  stratus_release(context, build.gathered);
  if (status != STRATUS_OK) {
    stratus_release(context, shape->nodes);
    stratus_release(context, shape->order);
    *shape = (stratus_tree_shape){ .nodes = NULL };
  }
  return status;
}
