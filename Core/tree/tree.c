/* SPDX-License-Identifier: BSD-3-Clause
 * Trees for first hits: one interface to all builders, and the statistics of a tree. */
#include "tree.h"

#include "matrix.h"

#include <stdio.h>
#include <string.h>

/* Most bricks of a field in the paper's trees, whose fields have an entry per voxel: 256^3 entries. */
#define PAPER_FIELD_BRICKS ((int64_t)1 << 18)
/* Bytes that fit a core's own cache. */
#define CACHED_BYTES 1e6

static const char* const method_names[STRATUS_TREE_METHODS] = { "hybrid", "hybrid-paper", "distance", "octant", "sah", "sweep", "lbvh",
  "ploc", "ac", "dpc", "kmeans", "wide", "auto" };

const char* stratus_tree_method_name(stratus_tree_method method)
{
  return (int)method >= 0 && (int)method < STRATUS_TREE_METHODS ? method_names[method] : "none";
}

stratus_tree_options stratus_tree_options_default(void)
{
  return (stratus_tree_options){ .method = STRATUS_TREE_AUTO,
    .max_depth = 32,
    .leaf_bricks = 4,
    .leaf_voxels = 1,
    .field_bricks = (int64_t)1 << 25,
    .field_emptiness = 512.0,
    .uniform = 0.1,
    .paper_threshold = 8.0 };
}

static stratus_status check_number(stratus_context* context, const char* name, double value, double lo, double hi)
{
  if (!(value >= lo && value <= hi)) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "%s %g outside %g..%g", name, value, lo, hi);
  }
  return STRATUS_OK;
}

static stratus_status check_options(stratus_context* context, const stratus_tree_options* o)
{
  TRY(check_number(context, "tree method", (double)o->method, 0, STRATUS_TREE_METHODS - 1));
  TRY(check_number(context, "greatest depth", o->max_depth, 1, 64));
  TRY(check_number(context, "bricks a leaf", o->leaf_bricks, 1, 64));
  TRY(check_number(context, "voxels a leaf", o->leaf_voxels, 1, 64));
  TRY(check_number(context, "bricks of a distance field", (double)o->field_bricks, 1, (double)((int64_t)1 << 29)));
  TRY(check_number(context, "emptiness of a distance field", o->field_emptiness, 1, 1e18));
  TRY(check_number(context, "uniformity", o->uniform, 0, 1e18));
  TRY(check_number(context, "the paper's threshold", o->paper_threshold, 0, 1e18));
  TRY(check_number(context, "bandwidth", o->bandwidth, 0, 1e9));
  TRY(check_number(context, "agglomeration by edges", o->agglomerative_by_edges, 0, 1));
  return check_number(context, "uncorrected flooding", o->uncorrected_flooding, 0, 1);
}

/* ---------------------------------------------------------------- shapes */

/* Makes one leaf, a distance field over everything. */
static stratus_status whole_shape(stratus_context* context, const stratus_voxels* voxels, stratus_tree_shape* shape)
{
  void* memory;
  TRY(stratus_allocate(context, 1, sizeof *shape->nodes, &memory));
  shape->nodes = memory;
  TRY(stratus_allocate(context, (size_t)voxels->brick_count, sizeof *shape->order, &memory));
  shape->order = memory;
  for (int64_t b = 0; b < voxels->brick_count; ++b) {
    shape->order[b] = (uint32_t)b;
  }
  shape->nodes[0] = (stratus_tree_node){ .kind_count = stratus_tree_kind_count(STRATUS_NODE_FIELD, (uint32_t)voxels->brick_count) };
  for (int a = 0; a < 3; ++a) {
    shape->nodes[0].lo[a] = (int32_t)voxels->lo[a];
    shape->nodes[0].hi[a] = (int32_t)voxels->hi[a];
  }
  shape->node_count = 1;
  return STRATUS_OK;
}

/* Builds a baseline's hierarchy over the voxels' boxes. The bricks of its leaves have one bit each. */
static stratus_status hierarchy(
  stratus_context* context, const stratus_voxels* voxels, const stratus_tree_options* options, stratus_tree* tree)
{
  const stratus_bvh_options wanted = { .method = options->method,
    .leaf_boxes = options->leaf_voxels,
    .max_depth = options->max_depth,
    .measure = options->agglomerative_by_edges ? STRATUS_BVH_EDGES : STRATUS_BVH_SURFACE };
  stratus_status status = STRATUS_OK;
  stratus_bvh bvh = { 0 };
  stratus_box* boxes = NULL;
  void* memory;
  uint32_t n = 0;
  if (voxels->count >= 1 << 29) {
    return stratus_fail(context, STRATUS_OVERFLOW, "%lld voxels: a hierarchy takes at most %d", (long long)voxels->count, (1 << 29) - 1);
  }
  TRY(stratus_allocate(context, (size_t)voxels->count, sizeof *boxes, &memory));
  boxes = memory;
  TRY_CLEANUP(stratus_allocate(context, (size_t)voxels->count, sizeof *tree->bricks, &memory));
  tree->bricks = memory;
  for (int64_t b = 0; b < voxels->brick_count; ++b) {
    const stratus_brick* brick = &voxels->bricks[b];
    for (uint64_t left = brick->mask; left; left &= left - 1, ++n) {
      const int bit = __builtin_ctzll(left);
      const int32_t at[3] = { brick->at[0] * 4 + (bit & 3), brick->at[1] * 4 + (bit >> 2 & 3), brick->at[2] * 4 + (bit >> 4) };
      for (int a = 0; a < 3; ++a) {
        boxes[n].lo[a] = at[a];
        boxes[n].hi[a] = at[a] + 1;
      }
    }
  }
  TRY_CLEANUP(stratus_bvh_create(context, boxes, n, &wanted, &bvh));
  for (uint32_t i = 0; i < n; ++i) {
    const int32_t* at = boxes[bvh.order[i]].lo;
    tree->bricks[i] = (stratus_brick){ .mask = 1ull << ((at[2] & 3) << 4 | (at[1] & 3) << 2 | (at[0] & 3)),
      .at = { (uint16_t)(at[0] >> 2), (uint16_t)(at[1] >> 2), (uint16_t)(at[2] >> 2) },
      .count = 1 };
  }
  tree->brick_count = n;
  tree->nodes = bvh.nodes;
  tree->node_count = bvh.node_count;
  bvh.nodes = NULL;

cleanup:
  stratus_bvh_release(context, &bvh);
  stratus_release(context, boxes);
  return status;
}

/* Makes one leaf of all bricks, and the hierarchy over them. */
static stratus_status wide(stratus_context* context, const stratus_voxels* voxels, stratus_tree* tree)
{
  void* memory;
  if (voxels->brick_count > STRATUS_NODE_COUNT_MAX) {
    return stratus_fail(
      context, STRATUS_OVERFLOW, "%lld bricks: a tree takes at most %u", (long long)voxels->brick_count, STRATUS_NODE_COUNT_MAX);
  }
  const stratus_stage stage = stratus_stage_begin(context);
  const uint32_t count = (uint32_t)voxels->brick_count;
  TRY(stratus_allocate(context, 1, sizeof *tree->nodes, &memory));
  tree->nodes = memory;
  tree->nodes[0] = (stratus_tree_node){ .kind_count = stratus_tree_kind_count(STRATUS_NODE_BRICKS, count) };
  for (int a = 0; a < 3; ++a) {
    tree->nodes[0].lo[a] = (int32_t)voxels->lo[a];
    tree->nodes[0].hi[a] = (int32_t)voxels->hi[a];
  }
  tree->node_count = 1;
  TRY(stratus_allocate(context, count, sizeof *tree->bricks, &memory));
  tree->bricks = memory;
  tree->brick_count = count;
  memcpy(tree->bricks, voxels->bricks, count * sizeof *tree->bricks);
  TRY(stratus_wide_create(context, &tree->bricks, count, &tree->wide));
  stratus_stage_end(context, &stage, "wide hierarchy", stratus_tree_memory(tree));
  return STRATUS_OK;
}

/* Copies the bricks of brick leaves, in the leaves' order, and makes the fields of the other leaves. */
static stratus_status fill_leaves(stratus_context* context, const stratus_voxels* voxels, stratus_tree_shape* shape, stratus_tree* tree)
{
  void* memory;
  uint32_t count = 0;
  TRY(stratus_allocate(context, shape->node_count, sizeof *tree->nodes, &memory));
  tree->nodes = memory;
  tree->node_count = shape->node_count;
  memcpy(tree->nodes, shape->nodes, shape->node_count * sizeof *tree->nodes);
  for (uint32_t n = 0; n < tree->node_count; ++n) {
    count += stratus_tree_node_kind(&tree->nodes[n]) == STRATUS_NODE_BRICKS ? stratus_tree_node_count(&tree->nodes[n]) : 0;
  }
  TRY(stratus_allocate(context, count, sizeof *tree->bricks, &memory));
  tree->bricks = memory;
  for (uint32_t n = 0; n < tree->node_count; ++n) {
    stratus_tree_node* node = &tree->nodes[n];
    if (stratus_tree_node_kind(node) == STRATUS_NODE_BRICKS) {
      const uint32_t first = node->first;
      node->first = tree->brick_count;
      for (uint32_t b = 0; b < stratus_tree_node_count(node); ++b) {
        tree->bricks[tree->brick_count++] = voxels->bricks[shape->order[first + b]];
      }
    }
  }
  return stratus_tree_make_fields(context, voxels, shape, tree);
}

/* What `auto` makes, and why: the structure of fewer bytes, but a field that fits a core's cache in any case, because a step there costs a
 * ray less than a node of a hierarchy. */
static stratus_tree_method cheapest(const stratus_voxels* voxels, char* why, size_t size)
{
  const double field = stratus_tree_octant_bytes(voxels), wide = (double)voxels->brick_count * STRATUS_WIDE_BYTES;
  if (field <= CACHED_BYTES) {
    snprintf(why, size, "one distance field of %.0f kB, which a core's cache holds", field / 1e3);
    return STRATUS_TREE_OCTANT;
  }
  if (field <= wide && field <= INT32_MAX - 64) { /* up to which a tree numbers a field's bytes */
    snprintf(why, size, "one distance field of %.0f kB; a wide hierarchy would take some %.0f", field / 1e3, wide / 1e3);
    return STRATUS_TREE_OCTANT;
  }
  snprintf(why, size, "a wide hierarchy of some %.0f kB; one distance field would take %.0f", wide / 1e3, field / 1e3);
  return STRATUS_TREE_WIDE;
}

static stratus_status build(stratus_context* context, const stratus_voxels* voxels, const stratus_tree_options* options, stratus_tree* tree)
{
  stratus_tree_shape shape = { 0 };
  stratus_status status = STRATUS_OK;
  tree->octants = options->method != STRATUS_TREE_DISTANCE && options->method != STRATUS_TREE_HYBRID_PAPER;
  tree->cell_log2 = options->method == STRATUS_TREE_HYBRID_PAPER ? 0 : 2;
  tree->statistics.uncorrected = tree->cell_log2 == 0 && options->uncorrected_flooding;
  if (options->method == STRATUS_TREE_WIDE) {
    return wide(context, voxels, tree);
  }
  if (options->method >= STRATUS_TREE_SAH) {
    return hierarchy(context, voxels, options, tree);
  }
  const stratus_stage shape_stage = stratus_stage_begin(context);
  if (options->method == STRATUS_TREE_DISTANCE || options->method == STRATUS_TREE_OCTANT) {
    TRY_CLEANUP(whole_shape(context, voxels, &shape));
  } else {
    stratus_tree_options capped = *options;
    if (tree->cell_log2 == 0 && capped.field_bricks > PAPER_FIELD_BRICKS) {
      capped.field_bricks = PAPER_FIELD_BRICKS;
    }
    TRY_CLEANUP(stratus_hybrid_tree_shape(context, voxels, &capped, &shape, &tree->statistics));
  }
  stratus_stage_end(
    context, &shape_stage, "tree shape", shape.node_count * sizeof *shape.nodes + (size_t)voxels->brick_count * sizeof *shape.order);
  const stratus_stage leaves_stage = stratus_stage_begin(context);
  TRY_CLEANUP(fill_leaves(context, voxels, &shape, tree));
  stratus_stage_end(context, &leaves_stage, "tree leaves", stratus_tree_memory(tree));

cleanup:
  stratus_release(context, shape.nodes);
  stratus_release(context, shape.order);
  return status;
}

/* ---------------------------------------------------------------- statistics */

size_t stratus_tree_memory(const stratus_tree* tree)
{
  return tree->node_count * sizeof *tree->nodes + tree->brick_count * sizeof *tree->bricks + tree->field_count * sizeof *tree->fields +
    (size_t)tree->entry_count * (size_t)tree->entry_bytes + tree->row_count * sizeof *tree->rows + tree->mask_count * sizeof *tree->masks +
    tree->wide.node_count * sizeof *tree->wide.nodes;
}

/* Computes the depth of every node; parents come before children. */
static void find_depths(const stratus_tree* tree, uint8_t* depth)
{
  if (tree->node_count) {
    depth[0] = 0;
  }
  for (uint32_t n = 0; n < tree->node_count; ++n) {
    if (stratus_tree_node_kind(&tree->nodes[n]) == STRATUS_NODE_INNER) {
      depth[tree->nodes[n].first] = depth[tree->nodes[n].first + 1] = (uint8_t)(depth[n] < 255 ? depth[n] + 1 : 255);
    }
  }
}

stratus_status stratus_tree_count_up(stratus_context* context, stratus_tree* tree)
{
  stratus_tree_statistics* s = &tree->statistics;
  void* memory;
  TRY(stratus_allocate(context, tree->node_count, 1, &memory));
  uint8_t* const depth = memory;
  find_depths(tree, depth);
  s->nodes = tree->node_count;
  s->field_leaves = tree->field_count;
  s->leaves = 0;
  s->depth = 0;
  for (uint32_t n = 0; n < tree->node_count; ++n) {
    if (stratus_tree_node_kind(&tree->nodes[n]) != STRATUS_NODE_INNER) {
      ++s->leaves;
      s->depth = depth[n] > s->depth ? depth[n] : s->depth;
    }
  }
  s->field_bricks = tree->cell_log2 ? tree->entry_count : tree->entry_count / 64;
  s->bytes = stratus_tree_memory(tree);
  s->wide_nodes = tree->wide.node_count;
  s->sah = tree->wide.node_count ? stratus_wide_sah(&tree->wide) : stratus_bvh_sah(tree->nodes, tree->node_count);
  stratus_release(context, depth);
  return STRATUS_OK;
}

static void complete_why(stratus_tree* tree)
{
  stratus_tree_statistics* s = &tree->statistics;
  if (s->voxels == 0) {
    snprintf(s->why, sizeof s->why, "no effective voxel");
  } else if (!s->why[0]) {
    snprintf(s->why, sizeof s->why, "%s as asked", stratus_tree_method_name(s->method));
  }
}

stratus_status stratus_tree_create(
  stratus_context* context, const stratus_voxels* voxels, const stratus_tree_options* options, stratus_tree** out)
{
  const double start = stratus_now_ms();
  const stratus_tree_options defaults = stratus_tree_options_default();
  stratus_status status = STRATUS_OK;
  stratus_tree* tree = NULL;
  void* memory;
  if (!context) {
    return STRATUS_INVALID_ARGUMENT;
  }
  if (!voxels || !out) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "%s is NULL", voxels ? "tree" : "voxels");
  }
  options = options ? options : &defaults;
  TRY(check_options(context, options));
  TRY(stratus_progress(context, "tree", 0.0));
  TRY(stratus_allocate_zero(context, 1, sizeof *tree, &memory));
  tree = memory;
  tree->context = context;
  tree->origin = voxels->origin;
  tree->entry_bytes = 2; /* distance fields may set 3; without fields or nodes the width must be valid, too */
  memcpy(tree->index_to_world, voxels->index_to_world, sizeof tree->index_to_world);
  (void)stratus_matrix_invert_affine(tree->index_to_world, tree->world_to_index); /* stratus_voxels_place() has refused what has none */
  for (int a = 0; a < 3; ++a) {
    tree->dimensions[a] = (int32_t)voxels->dimensions[a];
  }
  stratus_tree_options resolved = *options;
  if (options->method == STRATUS_TREE_AUTO) {
    resolved.method = voxels->count > 0 ? cheapest(voxels, tree->statistics.why, sizeof tree->statistics.why) : STRATUS_TREE_OCTANT;
  }
  if (voxels->count > 0) {
    TRY_CLEANUP(build(context, voxels, &resolved, tree));
  }
  tree->statistics.method = resolved.method;
  tree->statistics.voxels = voxels->count;
  tree->statistics.bricks = voxels->brick_count;
  TRY_CLEANUP(stratus_tree_count_up(context, tree));
  complete_why(tree);
  TRY_CLEANUP(stratus_progress(context, "tree", 1.0));
  tree->statistics.build_ms = stratus_now_ms() - start;
  *out = tree;
  tree = NULL;

cleanup:
  stratus_tree_destroy(tree);
  return status;
}

void stratus_tree_destroy(stratus_tree* tree)
{
  if (tree) {
    stratus_context* context = tree->context;
    stratus_release(context, tree->nodes);
    stratus_release(context, tree->bricks);
    stratus_release(context, tree->fields);
    stratus_release(context, tree->entries);
    stratus_release(context, tree->rows);
    stratus_release(context, tree->masks);
    stratus_release(context, tree->wide.memory);
    stratus_release(context, tree);
  }
}

void stratus_tree_get_statistics(const stratus_tree* tree, stratus_tree_statistics* statistics)
{
  if (statistics) {
    *statistics = tree ? tree->statistics : (stratus_tree_statistics){ 0 };
  }
}

/* ---------------------------------------------------------------- boxes */

static int64_t voxels_of_field(const stratus_tree* tree, const stratus_tree_field* field)
{
  int64_t count = 0;
  for (int32_t k = 0; k < field->cells[2]; ++k) {
    for (int32_t j = 0; j < field->cells[1]; ++j) {
      for (int32_t i = 0; i < field->cells[0]; ++i) {
        uint64_t mask;
        stratus_tree_field_leap(tree, field, 0, i, j, k, &mask);
        count += __builtin_popcountll(mask);
      }
    }
  }
  return count;
}

void stratus_tree_boxes(const stratus_tree* tree, stratus_node_box* boxes)
{
  if (!tree || !boxes) {
    return;
  }
  for (uint32_t n = 0; n < tree->node_count; ++n) {
    const stratus_tree_node* node = &tree->nodes[n];
    stratus_node_box* box = &boxes[n];
    box->kind = stratus_tree_node_kind(node);
    box->depth = n == 0 ? 0 : box->depth;
    box->voxels = 0;
    for (int a = 0; a < 3; ++a) {
      box->lo[a] = node->lo[a];
      box->hi[a] = node->hi[a];
    }
    if (box->kind == STRATUS_NODE_INNER) {
      boxes[node->first].depth = boxes[node->first + 1].depth = box->depth + 1;
    } else if (box->kind == STRATUS_NODE_FIELD) {
      box->voxels = voxels_of_field(tree, &tree->fields[node->first]);
    } else {
      for (uint32_t b = 0; b < stratus_tree_node_count(node); ++b) {
        box->voxels += __builtin_popcountll(tree->bricks[node->first + b].mask);
      }
    }
  }
  for (uint32_t n = tree->node_count; n-- > 0;) {
    if (boxes[n].kind == STRATUS_NODE_INNER) {
      boxes[n].voxels = boxes[tree->nodes[n].first].voxels + boxes[tree->nodes[n].first + 1].voxels;
    }
  }
}
