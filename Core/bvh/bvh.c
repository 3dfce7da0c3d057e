/* SPDX-License-Identifier: BSD-3-Clause
 * Bounding volume hierarchies over boxes: checks of the input, choice of the builder, and the checks and the cost measure that apply to
 * every tree. */
#include "bvh_build.h"

static bool box_is_sound(const stratus_box* box)
{
  for (int a = 0; a < 3; ++a) {
    if (box->lo[a] >= box->hi[a] || box->lo[a] < -STRATUS_BVH_COORDINATE_MAX || box->hi[a] > STRATUS_BVH_COORDINATE_MAX) {
      return false;
    }
  }
  return true;
}

static stratus_status check_input(
  stratus_context* context, const stratus_box* boxes, uint32_t count, const stratus_bvh_options* options, const stratus_bvh* bvh)
{
  if (!boxes || !options || !bvh) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "boxes, options and hierarchy must not be NULL");
  }
  if (count < 1 || count > STRATUS_BVH_BOXES_MAX) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "%u boxes outside 1..%u", count, STRATUS_BVH_BOXES_MAX);
  }
  if (options->method < STRATUS_TREE_SAH || options->method > STRATUS_TREE_KMEANS) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "method %d is no bounding volume hierarchy: %d..%d", (int)options->method,
      (int)STRATUS_TREE_SAH, (int)STRATUS_TREE_KMEANS);
  }
  if (options->leaf_boxes < 1 || options->leaf_boxes > 64) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "leaf_boxes %d outside 1..64", options->leaf_boxes);
  }
  if (options->max_depth < 1 || options->max_depth > 64) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "max_depth %d outside 1..64", options->max_depth);
  }
  if (options->measure != STRATUS_BVH_SURFACE && options->measure != STRATUS_BVH_EDGES) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "measure %d outside 0..1", (int)options->measure);
  }
  uint32_t unsound = count;
#pragma omp parallel for schedule(static) num_threads(context->threads) reduction(min : unsound)
  for (uint32_t i = 0; i < count; ++i) {
    unsound = box_is_sound(boxes + i) || unsound < i ? unsound : i;
  }
  if (unsound < count) {
    const stratus_box* b = boxes + unsound;
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "box %u, [%d,%d) x [%d,%d) x [%d,%d), is empty or outside -%d..%d", unsound,
      b->lo[0], b->hi[0], b->lo[1], b->hi[1], b->lo[2], b->hi[2], STRATUS_BVH_COORDINATE_MAX, STRATUS_BVH_COORDINATE_MAX);
  }
  return STRATUS_OK;
}

static stratus_status run_builder(stratus_tree_method method, stratus_bvh_build* build)
{
  switch (method) {
    case STRATUS_TREE_SAH:
      return stratus_bvh_build_sah(build);
    case STRATUS_TREE_SWEEP:
      return stratus_bvh_build_sweep(build);
    case STRATUS_TREE_LBVH:
      return stratus_bvh_build_lbvh(build);
    case STRATUS_TREE_PLOC:
      return stratus_bvh_build_ploc(build);
    case STRATUS_TREE_AC:
      return stratus_bvh_build_agglomerative(build);
    case STRATUS_TREE_DPC:
      return stratus_bvh_build_density_peaks(build);
    case STRATUS_TREE_KMEANS:
      return stratus_bvh_build_k_means(build);
    case STRATUS_TREE_HYBRID: /* all methods have a case, so that the compiler warns of a new one */
    case STRATUS_TREE_HYBRID_PAPER:
    case STRATUS_TREE_DISTANCE:
    case STRATUS_TREE_OCTANT:
    case STRATUS_TREE_WIDE:
    case STRATUS_TREE_AUTO:
      break;
  }
  return stratus_fail(build->context, STRATUS_INVALID_ARGUMENT, "method %d has no builder", (int)method);
}

stratus_status stratus_bvh_create(
  stratus_context* context, const stratus_box* boxes, uint32_t count, const stratus_bvh_options* options, stratus_bvh* bvh)
{
  stratus_status status = STRATUS_OK;
  stratus_bvh_build build = { .context = context, .count = count };
  void* pairs = NULL;

  TRY(check_input(context, boxes, count, options, bvh));
  const stratus_stage stage = stratus_stage_begin(context);
  build.max_depth = options->max_depth;
  build.measure = options->measure;
  TRY_CLEANUP(stratus_bvh_sort_boxes(&build, boxes));
  if (count > 1) {
    TRY_CLEANUP(stratus_progress(context, "hierarchy", 0.2));
    TRY_CLEANUP(stratus_allocate(context, count - 1, sizeof *build.pairs, &pairs));
    build.pairs = pairs;
    TRY_CLEANUP(run_builder(options->method, &build));
    TRY_CLEANUP(stratus_progress(context, "hierarchy", 0.8));
  }
  stratus_release(context, build.codes); /* the layout does not use them, and it needs memory */
  build.codes = NULL;
  TRY_CLEANUP(stratus_bvh_layout(&build, options->leaf_boxes, bvh));
  stratus_stage_end(context, &stage, "hierarchy", bvh->node_count * sizeof *bvh->nodes + count * sizeof *bvh->order);

cleanup:
  stratus_release(context, build.boxes);
  stratus_release(context, build.number);
  stratus_release(context, build.codes);
  stratus_release(context, pairs);
  return status;
}

void stratus_bvh_release(stratus_context* context, stratus_bvh* bvh)
{
  if (bvh) {
    stratus_release(context, bvh->nodes);
    stratus_release(context, bvh->order);
    *bvh = (stratus_bvh){ .nodes = NULL };
  }
}

/* ---- check */

typedef struct checker {
  stratus_context* context;
  const stratus_bvh* bvh;
  const stratus_box* boxes;
  uint32_t count;
  uint8_t *node_seen, *box_seen;
  stratus_box* tight; /* by node: the box that its boxes require */
} checker;

#define WRONG(c, ...) stratus_fail((c)->context, STRATUS_INVALID_ARGUMENT, __VA_ARGS__)

static stratus_status check_inner(const checker* c, uint32_t i)
{
  const uint32_t first = c->bvh->nodes[i].first;
  if (first <= i || first >= c->bvh->node_count - 1) {
    return WRONG(c, "node %u of %u has children %u and %u", i, c->bvh->node_count, first, first + 1);
  }
  for (uint32_t child = first; child < first + 2; ++child) {
    if (c->node_seen[child]++) {
      return WRONG(c, "node %u has two parents", child);
    }
  }
  return STRATUS_OK;
}

static stratus_status check_leaf(const checker* c, uint32_t i)
{
  const stratus_tree_node* node = c->bvh->nodes + i;
  const uint32_t count = stratus_tree_node_count(node);
  if (stratus_tree_node_kind(node) != STRATUS_NODE_BRICKS || count < 1 || node->first >= c->count || count > c->count - node->first) {
    return WRONG(c, "node %u: kind %d with %u boxes from %u on of %u", i, (int)stratus_tree_node_kind(node), count, node->first, c->count);
  }
  for (uint32_t place = node->first; place < node->first + count; ++place) {
    const uint32_t box = c->bvh->order[place];
    if (box >= c->count || c->box_seen[box]++) {
      return WRONG(c, "place %u has box %u of %u, no such box or one twice", place, box, c->count);
    }
    stratus_box_add(c->tight + i, c->boxes + box);
  }
  return STRATUS_OK;
}

static stratus_status check_box(const checker* c, uint32_t i)
{
  const stratus_tree_node* node = c->bvh->nodes + i;
  const stratus_box* t = c->tight + i;
  for (int a = 0; a < 3; ++a) {
    if (node->lo[a] != t->lo[a] || node->hi[a] != t->hi[a]) {
      return WRONG(c, "node %u is [%d,%d) along axis %d, its boxes are [%d,%d)", i, node->lo[a], node->hi[a], a, t->lo[a], t->hi[a]);
    }
  }
  return STRATUS_OK;
}

static stratus_status check_nodes(const checker* c)
{
  for (uint32_t i = 0; i < c->bvh->node_count; ++i) {
    c->tight[i] = stratus_box_none();
    if (i > 0 && !c->node_seen[i]) {
      return WRONG(c, "node %u has no parent before it", i);
    }
    TRY(stratus_tree_node_kind(c->bvh->nodes + i) == STRATUS_NODE_INNER ? check_inner(c, i) : check_leaf(c, i));
  }
  for (uint32_t i = c->bvh->node_count; i-- > 0;) {
    const stratus_tree_node* node = c->bvh->nodes + i;
    if (stratus_tree_node_kind(node) == STRATUS_NODE_INNER) {
      stratus_box_add(c->tight + i, c->tight + node->first);
      stratus_box_add(c->tight + i, c->tight + node->first + 1);
    }
    TRY(check_box(c, i));
  }
  for (uint32_t box = 0; box < c->count; ++box) {
    if (!c->box_seen[box]) {
      return WRONG(c, "box %u is in no leaf", box);
    }
  }
  return STRATUS_OK;
}

stratus_status stratus_bvh_check(stratus_context* context, const stratus_bvh* bvh, const stratus_box* boxes, uint32_t count)
{
  stratus_status status = STRATUS_OK;
  void *node_seen = NULL, *box_seen = NULL, *tight = NULL;
  if (bvh->node_count < 1 || bvh->node_count >= 2 * (uint64_t)count) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "%u nodes for %u boxes", bvh->node_count, count);
  }
  TRY_CLEANUP(stratus_allocate_zero(context, bvh->node_count, 1, &node_seen));
  TRY_CLEANUP(stratus_allocate_zero(context, count, 1, &box_seen));
  TRY_CLEANUP(stratus_allocate(context, bvh->node_count, sizeof(stratus_box), &tight));
  const checker c = { context, bvh, boxes, count, node_seen, box_seen, tight };
  TRY_CLEANUP(check_nodes(&c));

cleanup:
  stratus_release(context, node_seen);
  stratus_release(context, box_seen);
  stratus_release(context, tight);
  return status;
}

double stratus_bvh_sah(const stratus_tree_node* nodes, uint32_t node_count)
{
  double cost = 0.0, root = 1.0;
  for (uint32_t i = 0; i < node_count; ++i) {
    const stratus_tree_node* n = nodes + i;
    const stratus_box box = { { n->lo[0], n->lo[1], n->lo[2] }, { n->hi[0], n->hi[1], n->hi[2] } };
    const double area = stratus_box_area(&box);
    root = i == 0 ? area : root;
    cost += stratus_tree_node_kind(n) == STRATUS_NODE_BRICKS ? area * (double)stratus_tree_node_count(n) : area;
  }
  return root > 0.0 ? cost / root : 0.0;
}
