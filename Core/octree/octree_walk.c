/* SPDX-License-Identifier: BSD-3-Clause
 * The walk through the tree, one level after the other. The nodes of a level that are to be split are split together (Li & Huang 2024,
 * 3.2). The lists that the walk reaches become jobs. Each level is visited in Morton order, so that a tree always gives the same jobs. */
#include "octree.h"

stratus_status stratus_octree_view_create(stratus_octree* tree, stratus_octree_view** out)
{
  if (!tree) {
    return STRATUS_INVALID_ARGUMENT;
  }
  if (!out) {
    return stratus_fail(tree->context, STRATUS_INVALID_ARGUMENT, "octree view is NULL");
  }
  void* memory = NULL;
  TRY(stratus_allocate_zero(tree->context, 1, sizeof(stratus_octree_view), &memory));
  *out = memory;
  (*out)->tree = tree;
  return STRATUS_OK;
}

void stratus_octree_view_destroy(stratus_octree_view* view)
{
  if (!view) {
    return;
  }
  stratus_context* context = view->tree->context;
  stratus_release(context, view->ids);
  stratus_release(context, view->coverage);
  stratus_release(context, view->depth);
  stratus_release(context, view->stamps);
  stratus_release(context, view->places[0]);
  stratus_release(context, view->places[1]);
  stratus_release(context, view->batch);
  stratus_release(context, view->jobs);
  stratus_release(context, view->keep);
  stratus_release(context, view->unsure);
  stratus_release(context, view);
}

stratus_status stratus_octree_view_reserve_stamps(stratus_octree_view* view)
{
  void* stamps = view->stamps;
  const size_t before = view->stamps_capacity;
  TRY(stratus_octree_reserve(view->tree->context, &stamps, &view->stamps_capacity, view->tree->limit, before, sizeof *view->stamps));
  view->stamps = stamps;
  for (size_t i = before; i < view->stamps_capacity; ++i) {
    view->stamps[i] = view->stamp;
  }
  if (++view->stamp == 0) {
    /* The stamp has wrapped after 2^32 calls: old stamps could seem new. */
    for (size_t i = 0; i < view->stamps_capacity; ++i) {
      view->stamps[i] = 0;
    }
    view->stamp = 1;
  }
  return STRATUS_OK;
}

static stratus_status reserve_places(stratus_octree_view* view, int side, size_t needed, size_t used)
{
  void* memory = view->places[side];
  TRY(stratus_octree_reserve(view->tree->context, &memory, &view->places_capacity[side], needed, used, sizeof **view->places));
  view->places[side] = memory;
  return STRATUS_OK;
}

static stratus_status add_jobs(stratus_octree_view* view, const stratus_octree_list* list, unsigned mask)
{
  const uint32_t chunk = STRATUS_JOB_PACKS * STRATUS_PACK;
  void* memory = view->jobs;
  TRY(stratus_octree_reserve(
    view->tree->context, &memory, &view->jobs_capacity, view->job_count + list->count / chunk + 1, view->job_count, sizeof *view->jobs));
  view->jobs = memory;
  for (uint32_t from = 0; from < list->count; from += chunk) {
    const uint32_t count = list->count - from < chunk ? list->count - from : chunk;
    view->jobs[view->job_count++] = (stratus_octree_job){ .boxes = list->boxes + (size_t)(from / STRATUS_PACK) * STRATUS_PACK_FLOATS,
      .ids = stratus_list_ids(list) + from,
      .hints = stratus_list_hints(list) + from / STRATUS_PACK,
      .count = count,
      .mask = mask,
      .first = view->packs };
    view->packs += (count + STRATUS_PACK - 1) / STRATUS_PACK;
  }
  return STRATUS_OK;
}

/* Conditions that every stop rule shares. */
static bool may_split(const stratus_octree* tree, int level, const stratus_octree_place* place)
{
  const stratus_octree_level* nodes = &tree->levels[level];
  return level < tree->options.levels && nodes->nodes[place->node].count > (uint32_t)tree->options.leaf_objects &&
    !stratus_octree_is_split(nodes, place->node) && !(nodes->stuck[place->node >> 3] >> (place->node & 7) & 1);
}

static stratus_status split_level(stratus_octree_view* view, stratus_octree_walk* walk, int level, int side, size_t count)
{
  stratus_octree* tree = view->tree;
  const stratus_octree_place* places = view->places[side];
  void* memory = view->batch;
  size_t batch = 0;
  if (level == tree->options.levels || tree->options.levels == 0) {
    return STRATUS_OK;
  }
  TRY(stratus_octree_reserve(tree->context, &memory, &view->batch_capacity, count, 0, sizeof *view->batch));
  view->batch = memory;
  for (size_t i = 0; i < count; ++i) {
    if (places[i].mask && walk->budget > 0 && may_split(tree, level, &places[i]) && walk->divides(tree, walk->self, level, &places[i])) {
      walk->budget -= tree->levels[level].nodes[places[i].node].count;
      view->batch[batch++] = places[i];
    }
  }
  return stratus_octree_split(tree, level, view->batch, batch, &walk->splits, &walk->handed_down);
}

/* Adds the children of one split node to places[side]; returns the new count. */
static size_t enter_children(
  stratus_octree_view* view, stratus_octree_walk* walk, int level, const stratus_octree_place* place, int side, size_t count)
{
  stratus_octree* tree = view->tree;
  stratus_octree_level* below = &tree->levels[level + 1];
  const size_t group = stratus_octree_child_group(&tree->levels[level], place->node);
  uint8_t masks[8] = { 0 };
  if (place->mask) {
    const double half = 0.5 * stratus_octree_cell_size(tree, level);
    double center[3];
    stratus_octree_cell_corner(tree, level, place, center);
    for (int a = 0; a < 3; ++a) {
      center[a] += half;
    }
    walk->children(tree, walk->self, place->mask, center, 0.5 * half, masks);
    walk->nodes_tested += 8;
    below->used[group] = tree->clock;
  }
  for (unsigned o = 0; o < 8; ++o) {
    stratus_octree_place child = stratus_octree_child(place, group, o);
    if (!(masks[o] & 0x80) && (below->nodes[child.node].count > 0 || stratus_octree_is_split(below, child.node))) {
      child.mask = masks[o];
      view->places[side][count++] = child;
    }
  }
  return count;
}

/* Tests the root as the upper child (octant 7) of a cell whose centre is the root's least corner. */
static unsigned root_mask(const stratus_octree* tree, stratus_octree_walk* walk)
{
  uint8_t masks[8];
  if (!tree->rooted || tree->options.levels == 0 || walk->mask == 0) {
    return walk->mask;
  }
  walk->children(tree, walk->self, walk->mask, tree->corner, 0.5 * tree->edge, masks);
  ++walk->nodes_tested;
  return masks[7];
}

stratus_status stratus_octree_walk_nodes(stratus_octree_view* view, stratus_octree_walk* walk)
{
  stratus_octree* tree = view->tree;
  size_t count = 1;
  view->job_count = 0;
  view->packs = 0;
  walk->nodes_tested = walk->splits = walk->handed_down = 0;
  TRY(reserve_places(view, 0, 1, 0));
  view->places[0][0] = (stratus_octree_place){ .mask = root_mask(tree, walk) };
  if (view->places[0][0].mask & 0x80) {
    return STRATUS_OK;
  }
  for (int level = 0, side = 0; count > 0; ++level, side = !side) {
    TRY(split_level(view, walk, level, side, count));
    TRY(reserve_places(view, !side, 8 * count, 0));
    const stratus_octree_level* nodes = &tree->levels[level];
    size_t next = 0;
    for (size_t i = 0; i < count; ++i) {
      const stratus_octree_place* place = &view->places[side][i];
      const stratus_octree_list* list = &nodes->nodes[place->node];
      if (list->count > 0) {
        TRY(add_jobs(view, list, (place->mask ? walk->boxes_stick_out : walk->test_whole) ? walk->mask : place->mask));
      }
      if (stratus_octree_is_split(nodes, place->node)) {
        next = enter_children(view, walk, level, place, !side, next);
      }
    }
    count = next;
  }
  return STRATUS_OK;
}

stratus_status stratus_octree_split_all(stratus_octree_view* view, uint64_t* splits, uint64_t* handed_down)
{
  stratus_octree* tree = view->tree;
  size_t count = 1;
  TRY(reserve_places(view, 0, 1, 0));
  view->places[0][0] = (stratus_octree_place){ 0 };
  for (int level = 0, side = 0; count > 0 && level < tree->options.levels; ++level, side = !side) {
    void* memory = view->batch;
    size_t batch = 0, next = 0;
    TRY(stratus_octree_reserve(tree->context, &memory, &view->batch_capacity, count, 0, sizeof *view->batch));
    view->batch = memory;
    for (size_t i = 0; i < count; ++i) {
      if (may_split(tree, level, &view->places[side][i])) {
        view->batch[batch++] = view->places[side][i];
      }
    }
    TRY(stratus_octree_split(tree, level, view->batch, batch, splits, handed_down));
    TRY(reserve_places(view, !side, 8 * count, 0));
    for (size_t i = 0; i < count; ++i) {
      const stratus_octree_place* place = &view->places[side][i];
      if (stratus_octree_is_split(&tree->levels[level], place->node)) {
        const size_t group = stratus_octree_child_group(&tree->levels[level], place->node);
        for (unsigned o = 0; o < 8; ++o) {
          view->places[!side][next++] = stratus_octree_child(place, group, o);
        }
      }
    }
    count = next;
  }
  return STRATUS_OK;
}
