/* SPDX-License-Identifier: BSD-3-Clause
 * Layout: a builder's binary tree over single boxes becomes an array of nodes. A bottom-up pass computes tight boxes and turns subtrees
 * into leaves where that costs less. Subtrees below the depth's bound are split again at the median. A top-down pass gives each subtree its
 * own stretch of the nodes and of the order: siblings are neighbours, the rest is depth-first. Threads share the work by subtree, and every
 * index follows from only the tree. A device lays out trees whose depth needs no bound. */
#include "bvh_build.h"

#include "device.h"
#include "radix_sort.h"

#include <stdatomic.h>

#define NO_PARENT UINT32_MAX
#define TASK_BOXES 4096 /* a smaller subtree stays with the thread that finds it */

typedef struct subtree {
  stratus_box box;
  uint32_t boxes;
  uint32_t nodes;  /* number of its nodes in the layout; 1: a leaf */
  uint32_t height; /* levels below its root */
  uint32_t forced; /* 1: at the depth's bound, so that it becomes a leaf if it has few enough boxes, whatever the cost */
  double cost;
} subtree;

typedef struct layout {
  const stratus_bvh_build* build;
  uint32_t leaf_boxes;
  uint32_t max_depth;
  subtree* subtrees;           /* by pair */
  uint32_t* pair_parent;       /* by pair */
  uint32_t* box_parent;        /* by box */
  atomic_uchar* children_done; /* by pair */
  stratus_tree_node* nodes;
  uint32_t* order;
} layout;

static void find_parents(const layout* l)
{
  const stratus_bvh_build* build = l->build;
#pragma omp parallel for schedule(static) num_threads(build->context->threads)
  for (uint32_t p = 0; p < build->count - 1; ++p) {
    for (int c = 0; c < 2; ++c) {
      const uint32_t child = build->pairs[p].child[c];
      *(child & STRATUS_BVH_LEAF ? l->box_parent + (child & ~STRATUS_BVH_LEAF) : l->pair_parent + child) = p;
    }
    atomic_init(l->children_done + p, 0);
  }
  l->pair_parent[build->root] = NO_PARENT;
}

static subtree subtree_of(const layout* l, uint32_t child)
{
  if (!(child & STRATUS_BVH_LEAF)) {
    return l->subtrees[child];
  }
  subtree leaf = { .box = l->build->boxes[child & ~STRATUS_BVH_LEAF], .boxes = 1, .nodes = 1 };
  leaf.cost = stratus_box_area(&leaf.box);
  return leaf;
}

static void merge_children(const layout* l, uint32_t pair)
{
  const subtree left = subtree_of(l, l->build->pairs[pair].child[0]), right = subtree_of(l, l->build->pairs[pair].child[1]);
  subtree* s = l->subtrees + pair;
  s->box = left.box;
  stratus_box_add(&s->box, &right.box);
  s->boxes = left.boxes + right.boxes;
  s->nodes = 1 + left.nodes + right.nodes;
  s->height = 1 + (left.height > right.height ? left.height : right.height);
  const double area = stratus_box_area(&s->box), as_leaf = area * (double)s->boxes;
  s->cost = area + left.cost + right.cost;
  if (s->boxes <= l->leaf_boxes && (as_leaf <= s->cost || s->forced)) {
    s->cost = as_leaf;
    s->nodes = 1;
    s->height = 0;
  }
}

/* Computes all subtrees. Each box climbs towards the root: the first of two children that arrives at a pair stops there, the second finds
 * both done and merges them. */
static void merge_all(const layout* l)
{
  find_parents(l);
#pragma omp parallel for schedule(static) num_threads(l->build->context->threads)
  for (uint32_t box = 0; box < l->build->count; ++box) {
    uint32_t pair = l->box_parent[box];
    while (pair != NO_PARENT && atomic_fetch_add_explicit(l->children_done + pair, 1, memory_order_acq_rel) == 1) {
      merge_children(l, pair);
      pair = l->pair_parent[pair];
    }
  }
}

/* ---- bounding the depth */

typedef struct median_split {
  const layout* layout;
  const uint32_t* ranks; /* in rising order */
  const uint32_t* pairs; /* pairs to use again, one fewer than ranks */
  uint32_t used;
} median_split;

static uint32_t split_at_median(median_split* m, uint32_t begin, uint32_t end)
{
  if (end - begin == 1) {
    return STRATUS_BVH_LEAF | m->ranks[begin];
  }
  const uint32_t pair = m->pairs[m->used++], middle = begin + (end - begin) / 2;
  m->layout->subtrees[pair].forced = 1;
  m->layout->build->pairs[pair].child[0] = split_at_median(m, begin, middle);
  m->layout->build->pairs[pair].child[1] = split_at_median(m, middle, end);
  return pair;
}

/* Splits the subtree of a pair at the depth's bound anew. The arrays have room for any subtree. Its root remains the same pair. */
static stratus_status part_again(const layout* l, uint32_t root, uint32_t* pairs, uint32_t* ranks, uint64_t* keys)
{
  stratus_context* context = l->build->context;
  uint32_t pair_count = 0, rank_count = 0;
  pairs[pair_count++] = root;
  for (uint32_t i = 0; i < pair_count; ++i) {
    for (int c = 0; c < 2; ++c) {
      const uint32_t child = l->build->pairs[pairs[i]].child[c];
      if (child & STRATUS_BVH_LEAF) {
        keys[rank_count] = child & ~STRATUS_BVH_LEAF;
        ranks[rank_count++] = child & ~STRATUS_BVH_LEAF;
      } else {
        pairs[pair_count++] = child;
      }
    }
  }
  TRY(stratus_radix_sort(context, keys, ranks, rank_count, 32));
  median_split m = { l, ranks, pairs, 0 };
  (void)split_at_median(&m, 0, rank_count);
  return STRATUS_OK;
}

typedef struct deep_search {
  const layout* layout;
  uint32_t *pairs, *ranks;
  uint64_t* keys;
} deep_search;

static stratus_status bound_subtree(const deep_search* d, uint32_t pair, uint32_t depth)
{
  const layout* l = d->layout;
  if (depth + l->subtrees[pair].height <= l->max_depth) {
    return STRATUS_OK;
  }
  if (depth == l->max_depth) {
    return part_again(l, pair, d->pairs, d->ranks, d->keys);
  }
  for (int c = 0; c < 2; ++c) {
    const uint32_t child = l->build->pairs[pair].child[c];
    if (!(child & STRATUS_BVH_LEAF)) {
      TRY(bound_subtree(d, child, depth + 1));
    }
  }
  return STRATUS_OK;
}

static stratus_status bound_depth(const layout* l)
{
  stratus_status status = STRATUS_OK;
  stratus_context* context = l->build->context;
  void *pairs = NULL, *ranks = NULL, *keys = NULL;
  if (l->subtrees[l->build->root].height <= l->max_depth) {
    return STRATUS_OK;
  }
  TRY_CLEANUP(stratus_allocate(context, l->build->count, sizeof(uint32_t), &pairs));
  TRY_CLEANUP(stratus_allocate(context, l->build->count, sizeof(uint32_t), &ranks));
  TRY_CLEANUP(stratus_allocate(context, l->build->count, sizeof(uint64_t), &keys));
  const deep_search search = { l, pairs, ranks, keys };
  TRY_CLEANUP(bound_subtree(&search, l->build->root, 0));
  merge_all(l);

cleanup:
  stratus_release(context, pairs);
  stratus_release(context, ranks);
  stratus_release(context, keys);
  return status;
}

/* ---- nodes */

static uint32_t* list_boxes(const layout* l, uint32_t child, uint32_t* order)
{
  if (child & STRATUS_BVH_LEAF) {
    *order = l->build->number[child & ~STRATUS_BVH_LEAF];
    return order + 1;
  }
  return list_boxes(l, l->build->pairs[child].child[1], list_boxes(l, l->build->pairs[child].child[0], order));
}

/* Writes a subtree: its root at index `node`, the nodes below it from `below` on, its boxes from `first` on. */
static void write_nodes(const layout* l, uint32_t child, uint32_t node, uint32_t below, uint32_t first)
{
  for (;;) {
    const subtree s = subtree_of(l, child);
    stratus_tree_node* n = l->nodes + node;
    for (int a = 0; a < 3; ++a) {
      n->lo[a] = s.box.lo[a];
      n->hi[a] = s.box.hi[a];
    }
    if (s.nodes == 1) {
      n->first = first;
      n->kind_count = stratus_tree_kind_count(STRATUS_NODE_BRICKS, s.boxes);
      (void)list_boxes(l, child, l->order + first);
      return;
    }
    n->first = below;
    n->kind_count = stratus_tree_kind_count(STRATUS_NODE_INNER, 0);
    const stratus_bvh_pair* pair = l->build->pairs + child;
    const subtree left = subtree_of(l, pair->child[0]);
    const uint32_t left_child = pair->child[0];
#pragma omp task if (left.boxes >= TASK_BOXES)
    write_nodes(l, left_child, below, below + 2, first);
    child = pair->child[1];
    node = below + 1;
    below += 1 + left.nodes;
    first += left.boxes;
  }
}

static stratus_status make_nodes(layout* l, stratus_bvh* bvh)
{
  stratus_context* context = l->build->context;
  const uint32_t root = l->build->count == 1 ? STRATUS_BVH_LEAF : l->build->root, count = subtree_of(l, root).nodes;
  void *nodes = NULL, *order = NULL;
  TRY(stratus_allocate(context, count, sizeof *l->nodes, &nodes));
  const stratus_status status = stratus_allocate(context, l->build->count, sizeof *l->order, &order);
  if (status != STRATUS_OK) {
    stratus_release(context, nodes);
    return status;
  }
  l->nodes = nodes;
  l->order = order;
#pragma omp parallel num_threads(context->threads)
#pragma omp single
  write_nodes(l, root, 0, 1, 0);
  *bvh = (stratus_bvh){ .nodes = nodes, .node_count = count, .order = order };
  return STRATUS_OK;
}

static stratus_status layout_on_host(const stratus_bvh_build* build, int leaf_boxes, stratus_bvh* bvh)
{
  stratus_status status = STRATUS_OK;
  stratus_context* context = build->context;
  layout l = { .build = build, .leaf_boxes = (uint32_t)leaf_boxes, .max_depth = (uint32_t)build->max_depth };
  void *subtrees = NULL, *pair_parent = NULL, *box_parent = NULL, *done = NULL;

  if (build->count > 1) {
    TRY_CLEANUP(stratus_allocate_zero(context, build->count - 1, sizeof *l.subtrees, &subtrees));
    TRY_CLEANUP(stratus_allocate(context, build->count - 1, sizeof *l.pair_parent, &pair_parent));
    TRY_CLEANUP(stratus_allocate(context, build->count, sizeof *l.box_parent, &box_parent));
    TRY_CLEANUP(stratus_allocate(context, build->count - 1, sizeof *l.children_done, &done));
    l.subtrees = subtrees;
    l.pair_parent = pair_parent;
    l.box_parent = box_parent;
    l.children_done = done;
    merge_all(&l);
    TRY_CLEANUP(bound_depth(&l));
  }
  TRY_CLEANUP(make_nodes(&l, bvh));

cleanup:
  stratus_release(context, subtrees);
  stratus_release(context, pair_parent);
  stratus_release(context, box_parent);
  stratus_release(context, done);
  return status;
}

stratus_status stratus_bvh_layout(const stratus_bvh_build* build, int leaf_boxes, stratus_bvh* bvh)
{
  if (stratus_device_takes_layout(build->context, build->count)) {
    bool done;
    const stratus_status status = stratus_device_layout(build, leaf_boxes, bvh, &done);
    if (!stratus_device_hands_back(build->context, status) && (status != STRATUS_OK || done)) {
      return status;
    }
  }
  return layout_on_host(build, leaf_boxes, bvh);
}
