/* SPDX-License-Identifier: BSD-3-Clause
 * The octree as an object: its options, creation and destruction, and the questions that need no walk through the tree. */
#include "octree.h"

#include <string.h>

#define LEAF_OBJECTS_MAX (1 << 20)

stratus_octree_options stratus_octree_options_default(void)
{
  return (stratus_octree_options){ .placement = STRATUS_OCTREE_ENCLOSING,
    .stop = STRATUS_OCTREE_STOP_PIXELS,
    .levels = STRATUS_OCTREE_LEVELS_MAX,
    .leaf_objects = 256,
    .pixels = 32.0,
    .c = 35.0,
    .looseness = 1.25,
    .collapse_after = 256,
    .split_budget = 0 };
}

static stratus_status check_options(stratus_context* context, const stratus_octree_options* o)
{
  if ((int)o->placement < 0 || o->placement > STRATUS_OCTREE_TOUCHING) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "octree placement %d outside 0..%d", (int)o->placement, STRATUS_OCTREE_TOUCHING);
  }
  if ((int)o->stop < 0 || o->stop > STRATUS_OCTREE_STOP_STATIC) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "octree stop %d outside 0..%d", (int)o->stop, STRATUS_OCTREE_STOP_STATIC);
  }
  if (o->levels < 0 || o->levels > STRATUS_OCTREE_LEVELS_MAX) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "octree levels %d outside 0..%d", o->levels, STRATUS_OCTREE_LEVELS_MAX);
  }
  if (o->leaf_objects < 1 || o->leaf_objects > LEAF_OBJECTS_MAX) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "octree leaf_objects %d outside 1..%d", o->leaf_objects, LEAF_OBJECTS_MAX);
  }
  if (!(o->pixels > 0.0) || !isfinite(o->pixels)) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "octree pixels %g, must be positive and finite", o->pixels);
  }
  if (!(o->c > 0.0) || !isfinite(o->c)) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "octree c %g, must be positive and finite", o->c);
  }
  if (!(o->looseness >= 1.0 && o->looseness <= 2.0)) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "octree looseness %g outside 1..2", o->looseness);
  }
  if (o->collapse_after < 0) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "octree collapse_after %d, must be 0 or more", o->collapse_after);
  }
  if (o->split_budget < 0) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "octree split_budget %lld, must be 0 or more", (long long)o->split_budget);
  }
  return STRATUS_OK;
}

static void forget_hull(stratus_octree* tree)
{
  for (int a = 0; a < 3; ++a) {
    tree->hull[2 * a] = INFINITY;
    tree->hull[2 * a + 1] = -INFINITY;
  }
}

stratus_status stratus_octree_create(stratus_context* context, const stratus_octree_options* options, stratus_octree** out)
{
  if (!context) {
    return STRATUS_INVALID_ARGUMENT;
  }
  if (!out) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "octree is NULL");
  }
  const stratus_octree_options defaults = stratus_octree_options_default();
  TRY(check_options(context, options ? options : &defaults));
  void* memory = NULL;
  TRY(stratus_allocate_zero(context, 1, sizeof(stratus_octree), &memory));
  stratus_octree* tree = memory;
  tree->context = context;
  tree->options = options ? *options : defaults;
  tree->pad = tree->options.placement == STRATUS_OCTREE_ENCLOSING ? 0.5 * (tree->options.looseness - 1.0) : 0.0;
  tree->free_head = STRATUS_NO_ID;
  forget_hull(tree);
  stratus_status status = stratus_octree_levels_create(tree);
  if (status == STRATUS_OK) {
    status = stratus_octree_view_create(tree, &tree->walker);
  }
  if (status != STRATUS_OK) {
    stratus_octree_destroy(tree);
    return status;
  }
  *out = tree;
  return STRATUS_OK;
}

void stratus_octree_destroy(stratus_octree* tree)
{
  if (!tree) {
    return;
  }
  stratus_context* context = tree->context;
  stratus_octree_view_destroy(tree->walker);
  stratus_octree_levels_release(tree);
  stratus_list_release(context, &tree->unbounded);
  stratus_release(context, tree->bounds);
  stratus_release(context, tree->turned);
  stratus_release(context, tree->slot);
  stratus_release(context, tree->kind);
  stratus_release(context, tree);
}

void stratus_octree_clear(stratus_octree* tree)
{
  if (!tree) {
    return;
  }
  stratus_context* context = tree->context;
  /* Level 0 keeps its one group, so that a cleared tree needs no allocation. */
  for (int l = 0; l <= tree->depth; ++l) {
    for (size_t n = 0; n < 8 * tree->levels[l].groups; ++n) {
      stratus_list_release(context, &tree->levels[l].nodes[n]);
    }
    tree->levels[l].groups = l == 0;
  }
  tree->levels[0].split[0] = tree->levels[0].stuck[0] = 0;
  stratus_list_release(context, &tree->unbounded);
  tree->depth = 0;
  tree->rooted = tree->has_origin = false;
  tree->reach = 0.0;
  forget_hull(tree);
  tree->limit = tree->count = tree->unbounded_count = 0;
  tree->free_head = STRATUS_NO_ID;
}

/* ---- questions */

size_t stratus_octree_count(const stratus_octree* tree)
{
  return tree ? tree->count : 0;
}

size_t stratus_octree_id_limit(const stratus_octree* tree)
{
  return tree ? tree->limit : 0;
}

stratus_status stratus_octree_bounds(const stratus_octree* tree, uint32_t id, double bounds[6])
{
  if (!tree || !bounds) {
    return tree ? stratus_fail(tree->context, STRATUS_INVALID_ARGUMENT, "octree bounds is NULL") : STRATUS_INVALID_ARGUMENT;
  }
  TRY(stratus_octree_check_ids(tree, &id, 1));
  memcpy(bounds, tree->bounds[id], sizeof tree->bounds[id]);
  return STRATUS_OK;
}
