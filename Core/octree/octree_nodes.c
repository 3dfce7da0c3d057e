/* SPDX-License-Identifier: BSD-3-Clause
 * Inspection of the octree: its nodes, its bytes, and a check of its invariants. */
#include "octree.h"

#include <string.h>

/* Calls `visit` for every node, level by level. */
static stratus_status for_each_node(const stratus_octree* tree,
  stratus_status (*visit)(const stratus_octree* tree, int level, const stratus_octree_place* place, void* user), void* user)
{
  stratus_context* context = tree->context;
  stratus_status status = STRATUS_OK;
  void *now_memory = NULL, *next_memory = NULL;
  size_t now_capacity = 0, next_capacity = 0, count = 1;
  TRY(stratus_octree_reserve(context, &now_memory, &now_capacity, 1, 0, sizeof(stratus_octree_place)));
  *(stratus_octree_place*)now_memory = (stratus_octree_place){ 0 };
  for (int l = 0; count > 0; ++l) {
    const stratus_octree_level* level = &tree->levels[l];
    size_t next = 0;
    TRY_CLEANUP(stratus_octree_reserve(context, &next_memory, &next_capacity, 8 * count, 0, sizeof(stratus_octree_place)));
    for (size_t i = 0; i < count; ++i) {
      const stratus_octree_place* place = (const stratus_octree_place*)now_memory + i;
      TRY_CLEANUP(visit(tree, l, place, user));
      for (unsigned o = 0; o < 8 && stratus_octree_is_split(level, place->node); ++o) {
        ((stratus_octree_place*)next_memory)[next++] = stratus_octree_child(place, stratus_octree_child_group(level, place->node), o);
      }
    }
    void* swap = now_memory;
    const size_t swap_capacity = now_capacity;
    now_memory = next_memory, now_capacity = next_capacity;
    next_memory = swap, next_capacity = swap_capacity;
    count = next;
  }
cleanup:
  stratus_release(context, now_memory);
  stratus_release(context, next_memory);
  return status;
}

void stratus_octree_get_statistics(const stratus_octree* tree, stratus_octree_statistics* statistics)
{
  if (!tree || !statistics) {
    if (statistics) {
      *statistics = (stratus_octree_statistics){ 0 };
    }
    return;
  }
  stratus_octree_statistics s = { .objects = tree->count, .unbounded = tree->unbounded_count, .depth = tree->depth };
  size_t bytes = sizeof *tree, lists = 0;
  for (int l = 0; l <= tree->depth; ++l) {
    const stratus_octree_level* level = &tree->levels[l];
    bytes += level->capacity * (8 * sizeof *level->nodes + 2 + sizeof *level->rank + sizeof *level->used);
    s.nodes += l == 0 ? 1 : 8 * level->groups;
    for (size_t n = 0; n < 8 * level->groups; ++n) {
      s.references += level->nodes[n].count;
      lists += stratus_list_bytes(&level->nodes[n]);
    }
    for (size_t g = 0; g < level->groups; ++g) {
      s.split_nodes += (size_t)__builtin_popcount(level->split[g]);
    }
  }
  if (!tree->rooted) {
    s.nodes = 1;
  }
  const size_t packs = (tree->count - tree->unbounded_count + STRATUS_PACK - 1) / STRATUS_PACK;
  const size_t least = stratus_list_bytes(&(stratus_octree_list){ .packs = (uint32_t)packs });
  const size_t given = sizeof *tree->bounds + sizeof *tree->kind + sizeof *tree->slot + (tree->turned ? sizeof *tree->turned : 0);
  s.object_bytes = tree->limit * given + least;
  s.bytes = bytes + (lists > least ? lists - least : 0);
  for (int a = 0; a < 3 && tree->rooted; ++a) {
    s.root[2 * a] = tree->origin[a] + tree->corner[a];
    s.root[2 * a + 1] = tree->origin[a] + (tree->corner[a] + tree->edge);
  }
  *statistics = s;
}

/* ---- nodes */

typedef struct shower {
  const stratus_frustum_plan* plan; /* NULL: none */
  stratus_octree_node* next;
} shower;

static stratus_status show(const stratus_octree* tree, int level, const stratus_octree_place* place, void* user)
{
  shower* s = user;
  stratus_octree_node* node = s->next++;
  const double size = stratus_octree_cell_size(tree, level);
  double corner[3];
  stratus_octree_cell_corner(tree, level, place, corner);
  for (int a = 0; a < 3; ++a) {
    node->bounds[2 * a] = tree->rooted ? tree->origin[a] + corner[a] : 0.0;
    node->bounds[2 * a + 1] = tree->rooted ? tree->origin[a] + (corner[a] + size) : 0.0;
  }
  node->level = level;
  node->split = stratus_octree_is_split(&tree->levels[level], place->node);
  node->objects = tree->levels[level].nodes[place->node].count;
  node->side = STRATUS_SIDE_CROSSING;
  if (s->plan && tree->rooted) {
    node->side = s->plan->empty ? STRATUS_SIDE_OUTSIDE : stratus_plan_side(s->plan, s->plan->used, node->bounds);
  }
  return STRATUS_OK;
}

stratus_status stratus_octree_nodes(const stratus_octree* tree, const stratus_frustum* frustum, stratus_octree_node* nodes)
{
  if (!tree) {
    return STRATUS_INVALID_ARGUMENT;
  }
  if (!nodes) {
    return stratus_fail(tree->context, STRATUS_INVALID_ARGUMENT, "octree nodes is NULL");
  }
  stratus_frustum_plan plan;
  if (frustum) {
    TRY(stratus_frustum_check(tree->context, frustum));
    stratus_frustum_prepare(frustum, false, &plan);
  }
  shower s = { .plan = frustum ? &plan : NULL, .next = nodes };
  return for_each_node(tree, show, &s);
}

/* ---- check */

typedef struct checker {
  uint32_t* seen; /* number of lists that hold the object, by id */
  size_t references;
  int level;
  size_t node;
  bool there;
} checker;

static stratus_status is_here(stratus_octree* tree, int level, size_t node, void* user)
{
  checker* c = user;
  (void)tree;
  c->there |= c->level == level && c->node == node;
  return STRATUS_OK;
}

static stratus_status count_place(stratus_octree* tree, int level, size_t node, void* user)
{
  (void)tree, (void)level, (void)node;
  ++*(size_t*)user;
  return STRATUS_OK;
}

static stratus_status check_node(const stratus_octree* tree, int level, const stratus_octree_place* place, void* user)
{
  checker* c = user;
  const stratus_octree_list* list = &tree->levels[level].nodes[place->node];
  for (uint32_t i = 0; i < list->count; ++i) {
    const uint32_t id = stratus_list_ids(list)[i];
    float box[6], right[6];
    if (id >= tree->limit || (tree->kind[id] != STRATUS_OBJECT_BOX && tree->kind[id] != STRATUS_OBJECT_TURNED)) {
      return stratus_fail(tree->context, STRATUS_INVALID_ARGUMENT, "octree: level %d holds %u, which is no object", level, (unsigned)id);
    }
    stratus_list_get(list, i, box);
    stratus_octree_relative(tree, tree->bounds[id], right);
    c->level = level, c->node = place->node, c->there = false;
    (void)stratus_octree_visit_places((stratus_octree*)tree, right, is_here, c);
    if (memcmp(box, right, sizeof box) != 0 || !c->there) {
      return stratus_fail(tree->context, STRATUS_INVALID_ARGUMENT, "octree: object %u is not at its place on level %d, node %u",
        (unsigned)id, level, (unsigned)place->node);
    }
    if (tree->options.placement == STRATUS_OCTREE_ENCLOSING && tree->slot[id] != i) {
      return stratus_fail(tree->context, STRATUS_INVALID_ARGUMENT, "octree: object %u is in slot %u, not %u", (unsigned)id, (unsigned)i,
        (unsigned)tree->slot[id]);
    }
    ++c->seen[id];
    ++c->references;
  }
  return STRATUS_OK;
}

static stratus_status check_objects(const stratus_octree* tree, const checker* c)
{
  size_t used = 0, unbounded = 0;
  for (uint32_t i = 0; i < tree->unbounded.count; ++i) {
    c->seen[stratus_list_ids(&tree->unbounded)[i]]++;
  }
  for (uint32_t id = 0; id < tree->limit; ++id) {
    size_t places = 0;
    if (tree->kind[id] == STRATUS_OBJECT_UNBOUNDED) {
      ++unbounded;
      places = 1;
    } else if (tree->kind[id] != STRATUS_OBJECT_FREE) {
      float box[6];
      stratus_octree_relative(tree, tree->bounds[id], box);
      if (tree->rooted && !stratus_octree_root_holds(tree, box)) {
        return stratus_fail(tree->context, STRATUS_INVALID_ARGUMENT, "octree: object %u is beyond the root", (unsigned)id);
      }
      (void)stratus_octree_visit_places((stratus_octree*)tree, box, count_place, &places);
    }
    used += tree->kind[id] != STRATUS_OBJECT_FREE;
    if (c->seen[id] != places) {
      return stratus_fail(
        tree->context, STRATUS_INVALID_ARGUMENT, "octree: object %u is in %u lists, not %zu", (unsigned)id, (unsigned)c->seen[id], places);
    }
  }
  if (used != tree->count || unbounded != tree->unbounded_count || unbounded != tree->unbounded.count) {
    return stratus_fail(tree->context, STRATUS_INVALID_ARGUMENT, "octree: %zu objects, %zu of them unbounded, but counts are %zu and %zu",
      used, unbounded, tree->count, tree->unbounded_count);
  }
  return STRATUS_OK;
}

stratus_status stratus_octree_check(const stratus_octree* tree)
{
  if (!tree) {
    return STRATUS_INVALID_ARGUMENT;
  }
  void* memory = NULL;
  checker c = { 0 };
  TRY(stratus_allocate_zero(tree->context, tree->limit, sizeof *c.seen, &memory));
  c.seen = memory;
  stratus_octree_statistics statistics;
  stratus_octree_get_statistics(tree, &statistics);
  stratus_status status = for_each_node(tree, check_node, &c);
  if (status == STRATUS_OK) {
    status = check_objects(tree, &c);
  }
  /* Only the levels' count includes nodes that no parent leads to. */
  if (status == STRATUS_OK && c.references != statistics.references) {
    status = stratus_fail(tree->context, STRATUS_INVALID_ARGUMENT, "octree: %zu references in the levels, %zu from the root",
      statistics.references, c.references);
  }
  stratus_release(tree->context, memory);
  return status;
}
