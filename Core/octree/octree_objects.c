/* SPDX-License-Identifier: BSD-3-Clause
 * Objects of the octree: insertion, movement and removal. Manages their ids, their bounds, and their places in the nodes' lists. */
#include "octree.h"

#include <string.h>

#define IDS_MAX ((size_t)UINT32_MAX - 1)

/* ---- ids */

static stratus_status reserve_objects(stratus_octree* tree, size_t needed)
{
  stratus_context* context = tree->context;
  if (needed <= tree->capacity) {
    return STRATUS_OK;
  }
  if (needed > IDS_MAX) {
    return stratus_fail(context, STRATUS_OVERFLOW, "octree: %zu objects, at most %zu", needed, IDS_MAX);
  }
  const size_t room = tree->capacity + tree->capacity / 2 > needed ? tree->capacity + tree->capacity / 2 : needed;
  /* Each array counts its own capacity here. The tree's capacity rises only after all four have grown. */
  size_t have[4] = { tree->capacity, tree->capacity, tree->capacity, tree->capacity };
  void *bounds = tree->bounds, *slot = tree->slot, *kind = tree->kind, *turned = tree->turned;
  stratus_status status = stratus_octree_reserve(context, &bounds, &have[0], room, tree->limit, sizeof *tree->bounds);
  tree->bounds = bounds;
  if (status == STRATUS_OK) {
    status = stratus_octree_reserve(context, &slot, &have[1], room, tree->limit, sizeof *tree->slot);
    tree->slot = slot;
  }
  if (status == STRATUS_OK) {
    status = stratus_octree_reserve(context, &kind, &have[2], room, tree->limit, sizeof *tree->kind);
    tree->kind = kind;
  }
  if (status == STRATUS_OK && tree->turned) {
    status = stratus_octree_reserve(context, &turned, &have[3], room, tree->limit, sizeof *tree->turned);
    tree->turned = turned;
  }
  tree->capacity = status == STRATUS_OK ? room : tree->capacity;
  return status;
}

static stratus_status reserve_turned(stratus_octree* tree)
{
  void* memory = tree->turned;
  if (!tree->turned && tree->capacity > 0) {
    TRY(stratus_allocate(tree->context, tree->capacity, sizeof *tree->turned, &memory));
    tree->turned = memory;
  }
  return STRATUS_OK;
}

static uint32_t take_id(stratus_octree* tree)
{
  uint32_t id = tree->free_head;
  if (id == STRATUS_NO_ID) {
    id = (uint32_t)tree->limit++;
  } else {
    tree->free_head = tree->slot[id];
  }
  ++tree->count;
  return id;
}

static void free_id(stratus_octree* tree, uint32_t id)
{
  tree->kind[id] = STRATUS_OBJECT_FREE;
  tree->slot[id] = tree->free_head;
  tree->free_head = id;
  --tree->count;
}

static bool is_used(const stratus_octree* tree, uint32_t id)
{
  return id < tree->limit && tree->kind[id] != STRATUS_OBJECT_FREE;
}

/* ---- bounds */

/* An object as the caller gave it: its bounds and, unless NULL, the turned box within them. */
typedef struct given {
  double bounds[6];
  const double* turned;
  uint8_t kind;
} given;

static stratus_status read_bounds(stratus_context* context, const double* numbers, bool turned, size_t index, given* g)
{
  g->turned = turned ? numbers : NULL;
  g->kind = turned ? STRATUS_OBJECT_TURNED : STRATUS_OBJECT_BOX;
  for (int a = 0; a < 3; ++a) {
    if (turned) {
      /* One step outward covers the rounding of the sum. */
      const double half = (fabs(numbers[3 + a]) + fabs(numbers[6 + a]) + fabs(numbers[9 + a])) * (1.0 + 1e-15);
      g->bounds[2 * a] = nextafter(numbers[a] - half, -INFINITY);
      g->bounds[2 * a + 1] = nextafter(numbers[a] + half, INFINITY);
    } else {
      g->bounds[2 * a] = numbers[2 * a];
      g->bounds[2 * a + 1] = numbers[2 * a + 1];
    }
    if (g->bounds[2 * a] > g->bounds[2 * a + 1]) {
      return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "octree object %zu of the call has bounds %g..%g on axis %d, must not fall",
        index, g->bounds[2 * a], g->bounds[2 * a + 1], a);
    }
  }
  if (!stratus_bounds_finite(g->bounds)) {
    g->kind = STRATUS_OBJECT_UNBOUNDED;
  }
  return STRATUS_OK;
}

static stratus_status check_call(const stratus_octree* tree, const double* numbers, const uint32_t* ids, size_t count, bool turned)
{
  if (!tree) {
    return STRATUS_INVALID_ARGUMENT;
  }
  if (count > 0 && (!numbers || !ids)) {
    return stratus_fail(tree->context, STRATUS_INVALID_ARGUMENT, "octree %s is NULL", numbers ? "ids" : "bounds");
  }
  TRY(stratus_array_check(tree->context, "boxes", count, (turned ? 12 : 6) * sizeof *numbers));
  for (size_t i = 0; i < count; ++i) {
    given g;
    TRY(read_bounds(tree->context, numbers + (turned ? 12 : 6) * i, turned, i, &g));
  }
  return STRATUS_OK;
}

/* ---- places */

typedef struct visitor {
  const float* box;
  uint32_t id;
  /* the last place that note_place() met: the only one where places is 1 */
  int level;
  size_t node;
  size_t places;
} visitor;

static stratus_status add_to(stratus_octree* tree, int level, size_t node, void* user)
{
  const visitor* v = user;
  stratus_octree_level* l = &tree->levels[level];
  TRY(stratus_list_append(tree->context, &l->nodes[node], v->box, v->id, &tree->slot[v->id]));
  l->stuck[node >> 3] = (uint8_t)(l->stuck[node >> 3] & ~(1u << (node & 7)));
  return STRATUS_OK;
}

static stratus_status take_from(stratus_octree* tree, int level, size_t node, void* user)
{
  const visitor* v = user;
  stratus_octree_list* list = &tree->levels[level].nodes[node];
  const uint32_t slot = stratus_list_find(list, v->id, tree->slot[v->id]);
  if (slot != UINT32_MAX) { /* absent if memory ran out before it was added here */
    stratus_list_remove(list, slot, tree->slot);
  }
  return STRATUS_OK;
}

static stratus_status note_place(stratus_octree* tree, int level, size_t node, void* user)
{
  visitor* v = user;
  (void)tree;
  v->level = level;
  v->node = node;
  ++v->places;
  return STRATUS_OK;
}

static void unplace(stratus_octree* tree, uint32_t id)
{
  float box[6];
  visitor v = { .box = box, .id = id };
  if (tree->kind[id] == STRATUS_OBJECT_UNBOUNDED) {
    stratus_list_remove(&tree->unbounded, stratus_list_find(&tree->unbounded, id, tree->slot[id]), tree->slot);
    --tree->unbounded_count;
  } else {
    stratus_octree_relative(tree, tree->bounds[id], box);
    (void)stratus_octree_visit_places(tree, box, take_from, &v);
  }
}

/* Adds the object to every list where its bounds belong. After a failure no list holds it. */
static stratus_status place(stratus_octree* tree, uint32_t id)
{
  float box[6] = { 0 };
  visitor v = { .box = box, .id = id };
  tree->slot[id] = 0;
  if (tree->kind[id] == STRATUS_OBJECT_UNBOUNDED) {
    TRY(stratus_list_append(tree->context, &tree->unbounded, box, id, &tree->slot[id]));
    ++tree->unbounded_count;
    return STRATUS_OK;
  }
  if (!tree->has_origin) {
    for (int a = 0; a < 3; ++a) {
      tree->origin[a] = 0.5 * (tree->bounds[id][2 * a] + tree->bounds[id][2 * a + 1]);
    }
    tree->has_origin = true;
  }
  stratus_octree_relative(tree, tree->bounds[id], box);
  TRY(stratus_octree_grow(tree, box));
  double lo[3], hi[3];
  stratus_octree_extent(tree, box, lo, hi);
  for (int a = 0; a < 3; ++a) {
    tree->reach = fmax(tree->reach, fmax(fabs(lo[a]), fabs(hi[a])));
  }
  const stratus_status status = stratus_octree_visit_places(tree, box, add_to, &v);
  if (status != STRATUS_OK) {
    (void)stratus_octree_visit_places(tree, box, take_from, &v);
  }
  return status;
}

static void store(stratus_octree* tree, uint32_t id, const given* g)
{
  memcpy(tree->bounds[id], g->bounds, sizeof g->bounds);
  tree->kind[id] = g->kind;
  for (int a = 0; a < 3 && g->kind != STRATUS_OBJECT_UNBOUNDED; ++a) {
    tree->hull[2 * a] = fmin(tree->hull[2 * a], g->bounds[2 * a]);
    tree->hull[2 * a + 1] = fmax(tree->hull[2 * a + 1], g->bounds[2 * a + 1]);
  }
  if (g->kind == STRATUS_OBJECT_TURNED) {
    memcpy(tree->turned[id], g->turned, sizeof *tree->turned);
  }
}

/* ---- insert, move, remove */

static stratus_status insert(stratus_octree* tree, const double* numbers, size_t count, uint32_t* ids, bool turned)
{
  TRY(check_call(tree, numbers, ids, count, turned));
  size_t needed = 0;
  if (__builtin_add_overflow(tree->limit, count, &needed)) {
    return stratus_fail(tree->context, STRATUS_OVERFLOW, "octree: %zu more objects than %zu, at most %zu", count, tree->limit, IDS_MAX);
  }
  TRY(reserve_objects(tree, needed));
  if (turned && count > 0) {
    TRY(reserve_turned(tree));
  }
  /* A large batch gets exact room. A small one grows the list by half, since exact room would copy the list at every call. */
  stratus_octree_list* root = &tree->levels[0].nodes[0];
  if (!tree->rooted && count > root->count / 2) {
    TRY(stratus_list_reserve(tree->context, root, root->count + count));
  }
  tree->changed = true;
  for (size_t i = 0; i < count; ++i) {
    given g;
    (void)read_bounds(tree->context, numbers + (turned ? 12 : 6) * i, turned, i, &g);
    ids[i] = take_id(tree);
    store(tree, ids[i], &g);
    const stratus_status status = place(tree, ids[i]);
    if (status != STRATUS_OK) {
      free_id(tree, ids[i]);
      while (i-- > 0) {
        unplace(tree, ids[i]);
        free_id(tree, ids[i]);
      }
      return status;
    }
  }
  return STRATUS_OK;
}

stratus_status stratus_octree_insert(stratus_octree* tree, const double* bounds, size_t count, uint32_t* ids)
{
  return insert(tree, bounds, count, ids, false);
}

stratus_status stratus_octree_insert_oriented(stratus_octree* tree, const double* boxes, size_t count, uint32_t* ids)
{
  return insert(tree, boxes, count, ids, true);
}

/* Moves an object that stays in its one node: only its box in the list changes. Returns false if the object must leave its node. */
static bool move_within(stratus_octree* tree, uint32_t id, const given* g)
{
  float from[6], to[6];
  visitor old = { 0 }, new = { 0 };
  if (tree->kind[id] == STRATUS_OBJECT_UNBOUNDED || g->kind == STRATUS_OBJECT_UNBOUNDED) {
    return false;
  }
  stratus_octree_relative(tree, tree->bounds[id], from);
  stratus_octree_relative(tree, g->bounds, to);
  if (tree->rooted && !stratus_octree_root_holds(tree, to)) {
    return false;
  }
  (void)stratus_octree_visit_places(tree, from, note_place, &old);
  (void)stratus_octree_visit_places(tree, to, note_place, &new);
  if (old.places != 1 || new.places != 1 || old.level != new.level || old.node != new.node) {
    return false;
  }
  stratus_octree_level* level = &tree->levels[new.level];
  double lo[3], hi[3];
  stratus_octree_extent(tree, to, lo, hi);
  for (int a = 0; a < 3; ++a) {
    tree->reach = fmax(tree->reach, fmax(fabs(lo[a]), fabs(hi[a])));
  }
  const uint32_t slot = stratus_list_find(&level->nodes[new.node], id, tree->slot[id]);
  stratus_list_set(&level->nodes[new.node], slot, to);
  tree->slot[id] = slot;
  level->stuck[new.node >> 3] = (uint8_t)(level->stuck[new.node >> 3] & ~(1u << (new.node & 7)));
  store(tree, id, g);
  return true;
}

/* Out of memory: the object returns to its old node, whose list still has room. */
static stratus_status move_one(stratus_octree* tree, uint32_t id, const given* g)
{
  if (move_within(tree, id, g)) {
    return STRATUS_OK;
  }
  given old = { .kind = tree->kind[id] };
  double numbers[12];
  memcpy(old.bounds, tree->bounds[id], sizeof old.bounds);
  if (old.kind == STRATUS_OBJECT_TURNED) {
    memcpy(numbers, tree->turned[id], sizeof numbers);
    old.turned = numbers;
  }
  /* Growth may fail or rearrange the tree, so it comes before the object leaves its node. */
  if (g->kind != STRATUS_OBJECT_UNBOUNDED && tree->has_origin) {
    float box[6];
    stratus_octree_relative(tree, g->bounds, box);
    TRY(stratus_octree_grow(tree, box));
  }
  unplace(tree, id);
  store(tree, id, g);
  const stratus_status status = place(tree, id);
  if (status != STRATUS_OK) {
    store(tree, id, &old);
    (void)place(tree, id);
  }
  return status;
}

stratus_status stratus_octree_check_ids(const stratus_octree* tree, const uint32_t* ids, size_t count)
{
  for (size_t i = 0; i < count; ++i) {
    if (!is_used(tree, ids[i])) {
      return stratus_fail(tree->context, STRATUS_INVALID_ARGUMENT, "octree has no object %u (%zu of the call); ids in use are below %zu",
        (unsigned)ids[i], i, tree->limit);
    }
  }
  return STRATUS_OK;
}

static stratus_status move(stratus_octree* tree, const uint32_t* ids, const double* numbers, size_t count, bool turned)
{
  TRY(check_call(tree, numbers, ids, count, turned));
  TRY(stratus_octree_check_ids(tree, ids, count));
  if (turned && count > 0) {
    TRY(reserve_turned(tree));
  }
  tree->changed = true;
  for (size_t i = 0; i < count; ++i) {
    given g;
    (void)read_bounds(tree->context, numbers + (turned ? 12 : 6) * i, turned, i, &g);
    TRY(move_one(tree, ids[i], &g));
  }
  return STRATUS_OK;
}

stratus_status stratus_octree_move(stratus_octree* tree, const uint32_t* ids, const double* bounds, size_t count)
{
  return move(tree, ids, bounds, count, false);
}

stratus_status stratus_octree_move_oriented(stratus_octree* tree, const uint32_t* ids, const double* boxes, size_t count)
{
  return move(tree, ids, boxes, count, true);
}

stratus_status stratus_octree_remove(stratus_octree* tree, const uint32_t* ids, size_t count)
{
  if (!tree) {
    return STRATUS_INVALID_ARGUMENT;
  }
  if (count > 0 && !ids) {
    return stratus_fail(tree->context, STRATUS_INVALID_ARGUMENT, "octree ids is NULL");
  }
  TRY(stratus_array_check(tree->context, "ids", count, sizeof *ids));
  TRY(stratus_octree_check_ids(tree, ids, count));
  /* The top bit of kind marks an id that the call has named, so that a second mention is found. */
  stratus_status status = STRATUS_OK;
  size_t marked = 0;
  for (; marked < count && status == STRATUS_OK; ++marked) {
    if (tree->kind[ids[marked]] & 0x80) {
      status =
        stratus_fail(tree->context, STRATUS_INVALID_ARGUMENT, "octree object %u comes twice among those to remove", (unsigned)ids[marked]);
      break;
    }
    tree->kind[ids[marked]] |= 0x80;
  }
  for (size_t i = 0; i < marked; ++i) {
    tree->kind[ids[i]] &= 0x7f;
  }
  for (size_t i = 0; i < count && status == STRATUS_OK; ++i) {
    tree->changed = true;
    unplace(tree, ids[i]);
    free_id(tree, ids[i]);
  }
  return status;
}
