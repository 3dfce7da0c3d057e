/* SPDX-License-Identifier: BSD-3-Clause
 * Levels of the octree as arrays in Morton order (Li & Huang 2024, 3.1): the root's cell, the root's growth, and nodes that merge with
 * their children. A level's nodes merge in one pass, since each merge moves all groups behind it. */
#include "octree.h"

#include <float.h>
#include <string.h>

#define FIRST_GRID 1024.0    /* the root's first corner is a multiple of its width / 1024, so that all cells are exact in double */
#define FIRST_GROWTH 65536.0 /* growth of the root's width beyond which cells might be inexact */

stratus_status stratus_octree_reserve_groups(stratus_context* context, stratus_octree_level* level, size_t needed)
{
  if (needed <= level->capacity) {
    return STRATUS_OK;
  }
  const size_t room = level->capacity + level->capacity / 2 > needed ? level->capacity + level->capacity / 2 : needed;
  stratus_octree_level larger = { .groups = level->groups, .capacity = room };
  stratus_status status = STRATUS_OK;
  void *nodes = NULL, *split = NULL, *stuck = NULL, *rank = NULL, *used = NULL;
  TRY_CLEANUP(stratus_allocate_zero(context, room, 8 * sizeof *larger.nodes, &nodes));
  TRY_CLEANUP(stratus_allocate_zero(context, room, 1, &split));
  TRY_CLEANUP(stratus_allocate_zero(context, room, 1, &stuck));
  TRY_CLEANUP(stratus_allocate_zero(context, room, sizeof *larger.rank, &rank));
  TRY_CLEANUP(stratus_allocate_zero(context, room, sizeof *larger.used, &used));
  larger.nodes = nodes, larger.split = split, larger.stuck = stuck, larger.rank = rank, larger.used = used;
  if (level->groups > 0) {
    memcpy(nodes, level->nodes, level->groups * 8 * sizeof *larger.nodes);
    memcpy(split, level->split, level->groups);
    memcpy(stuck, level->stuck, level->groups);
    memcpy(rank, level->rank, level->groups * sizeof *larger.rank);
    memcpy(used, level->used, level->groups * sizeof *larger.used);
  }
  stratus_release(context, level->nodes);
  nodes = level->split, split = level->stuck, stuck = level->rank, rank = level->used, used = NULL;
  *level = larger;
cleanup:
  stratus_release(context, nodes);
  stratus_release(context, split);
  stratus_release(context, stuck);
  stratus_release(context, rank);
  stratus_release(context, used);
  return status;
}

static void release_level(stratus_context* context, stratus_octree_level* level)
{
  for (size_t n = 0; n < 8 * level->groups; ++n) {
    stratus_list_release(context, &level->nodes[n]);
  }
  stratus_release(context, level->nodes);
  stratus_release(context, level->split);
  stratus_release(context, level->stuck);
  stratus_release(context, level->rank);
  stratus_release(context, level->used);
  *level = (stratus_octree_level){ 0 };
}

stratus_status stratus_octree_levels_create(stratus_octree* tree)
{
  TRY(stratus_octree_reserve_groups(tree->context, &tree->levels[0], 1));
  tree->levels[0].groups = 1;
  return STRATUS_OK;
}

void stratus_octree_levels_release(stratus_octree* tree)
{
  for (int l = 0; l <= STRATUS_OCTREE_LEVELS_MAX; ++l) {
    release_level(tree->context, &tree->levels[l]);
  }
  tree->depth = 0;
  tree->rooted = false;
}

void stratus_octree_count_splits(stratus_octree_level* level)
{
  uint32_t before = 0;
  for (size_t g = 0; g < level->groups; ++g) {
    level->rank[g] = before;
    before += (uint32_t)__builtin_popcount(level->split[g]);
  }
}

/* ---- the root's cell */

/* Fits the root's cell to its list: a cube whose width is a power of two. The origin moves to the objects' middle, where floats resolve
 * them best. */
static void fit_root(stratus_octree* tree)
{
  const stratus_octree_list* list = &tree->levels[0].nodes[0];
  const uint32_t* ids = stratus_list_ids(list);
  double least[3] = { INFINITY, INFINITY, INFINITY }, greatest[3] = { -INFINITY, -INFINITY, -INFINITY }, width = 0.0;
  for (uint32_t i = 0; i < list->count; ++i) {
    for (int a = 0; a < 3; ++a) {
      least[a] = fmin(least[a], tree->bounds[ids[i]][2 * a]);
      greatest[a] = fmax(greatest[a], tree->bounds[ids[i]][2 * a + 1]);
    }
  }
  for (int a = 0; a < 3; ++a) {
    tree->hull[2 * a] = least[a], tree->hull[2 * a + 1] = greatest[a];
    tree->origin[a] = 0.5 * (least[a] + greatest[a]);
    least[a] = INFINITY, greatest[a] = -INFINITY;
  }
  tree->reach = 0.0;
  for (uint32_t i = 0; i < list->count; ++i) {
    float box[6];
    double lo[3], hi[3];
    stratus_octree_relative(tree, tree->bounds[ids[i]], box);
    stratus_list_set(list, i, box);
    stratus_octree_extent(tree, box, lo, hi);
    for (int a = 0; a < 3; ++a) {
      least[a] = fmin(least[a], lo[a]);
      greatest[a] = fmax(greatest[a], hi[a]);
      tree->reach = fmax(tree->reach, fmax(fabs(lo[a]), fabs(hi[a])));
    }
  }
  for (int a = 0; a < 3; ++a) {
    width = fmax(width, greatest[a] - least[a]);
  }
  int exponent;
  (void)frexp(fmax(1.01 * width, (double)FLT_MIN), &exponent);
  tree->edge = tree->first_edge = ldexp(1.0, exponent);
  for (int a = 0; a < 3; ++a) {
    /* Objects are in the cube's middle, so that they can spread to each side. */
    const double corner = 0.5 * (least[a] + greatest[a]) - 0.5 * tree->edge;
    tree->corner[a] = floor(corner * (FIRST_GRID / tree->edge) + 0.5) * (tree->edge / FIRST_GRID);
  }
  tree->rooted = true;
}

void stratus_octree_make_root(stratus_octree* tree)
{
  const stratus_octree_level* top = &tree->levels[0];
  if (!tree->rooted && tree->options.levels > 0 && top->nodes[0].count > (uint32_t)tree->options.leaf_objects && !(top->stuck[0] & 1)) {
    fit_root(tree);
  }
}

/* ---- merging */

static void gather(stratus_octree* tree, const stratus_octree_list* from, stratus_octree_list* to)
{
  const uint32_t* ids = from->count ? stratus_list_ids(from) : NULL;
  for (uint32_t i = 0; i < from->count; ++i) {
    const uint32_t guess = tree->slot[ids[i]];
    float box[6];
    /* An object may be in several children. Its slot then shows that the new list already holds it. */
    if (tree->options.placement == STRATUS_OCTREE_TOUCHING && guess < to->count && stratus_list_ids(to)[guess] == ids[i]) {
      continue;
    }
    stratus_list_get(from, i, box);
    tree->slot[ids[i]] = to->count;
    stratus_list_clear_rest(to, to->count);
    stratus_list_set(to, to->count, box);
    stratus_list_ids(to)[to->count++] = ids[i];
  }
}

static bool is_stale(const stratus_octree* tree, const stratus_octree_level* below, size_t group, int64_t age)
{
  return below->split[group] == 0 && (int64_t)(uint32_t)(tree->clock - below->used[group]) > age;
}

/* Allocates a list with room for the node's objects and its children's. */
static stratus_status allocate_whole(
  stratus_octree* tree, const stratus_octree_list* own, const stratus_octree_list* children, stratus_octree_list* whole)
{
  size_t count = own->count;
  for (int o = 0; o < 8; ++o) {
    count += children[o].count;
  }
  return stratus_list_allocate(tree->context, count, whole);
}

/* Nodes merge one at a time. When memory runs out, merged nodes stay so, and the loop goes on only to close the gaps between groups. */
stratus_status stratus_octree_collapse(stratus_octree* tree, int level, int64_t age, uint64_t* collapses)
{
  stratus_octree_level *above = &tree->levels[level], *below = &tree->levels[level + 1];
  stratus_status status = STRATUS_OK;
  size_t group = 0, kept = 0;
  for (size_t node = 0; node < 8 * above->groups; ++node) {
    if (!stratus_octree_is_split(above, node)) {
      continue;
    }
    stratus_octree_list* children = below->nodes + 8 * group;
    stratus_octree_list whole = { 0 };
    const bool stale = status == STRATUS_OK && is_stale(tree, below, group, age);
    if (stale) {
      status = allocate_whole(tree, &above->nodes[node], children, &whole);
    }
    if (stale && status == STRATUS_OK) {
      gather(tree, &above->nodes[node], &whole);
      stratus_list_release(tree->context, &above->nodes[node]);
      for (int o = 0; o < 8; ++o) {
        gather(tree, &children[o], &whole);
        stratus_list_release(tree->context, &children[o]);
      }
      above->nodes[node] = whole;
      above->split[node >> 3] = (uint8_t)(above->split[node >> 3] & ~(1u << (node & 7)));
      ++*collapses;
    } else if (kept == group) {
      ++kept;
    } else {
      memcpy(below->nodes + 8 * kept, children, 8 * sizeof *children);
      below->split[kept] = below->split[group];
      below->stuck[kept] = below->stuck[group];
      below->used[kept++] = below->used[group];
    }
    ++group;
  }
  below->groups = kept;
  stratus_octree_count_splits(above);
  stratus_octree_count_splits(below);
  while (tree->depth > 0 && tree->levels[tree->depth].groups == 0) {
    --tree->depth;
  }
  return status;
}

/* The whole tree into the root's list; the next split makes a new root. */
static stratus_status flatten(stratus_octree* tree)
{
  uint64_t collapses = 0;
  while (tree->depth > 0) {
    TRY(stratus_octree_collapse(tree, tree->depth - 1, -1, &collapses));
  }
  tree->rooted = false;
  tree->levels[0].stuck[0] = 0;
  return STRATUS_OK;
}

/* Makes the root one of eight children of a new root, twice as wide. A root that is not split only loses its cell: its next split fits a
 * new one. */
static stratus_status raise_root(stratus_octree* tree, unsigned octant)
{
  uint64_t collapses = 0;
  if (tree->depth == tree->options.levels && tree->depth > 0) {
    TRY(stratus_octree_collapse(tree, tree->depth - 1, -1, &collapses));
  }
  if (tree->depth == 0) {
    tree->rooted = false;
    return STRATUS_OK;
  }
  stratus_octree_level top = { 0 };
  TRY(stratus_octree_reserve_groups(tree->context, &top, 1));
  /* The shift below overwrites this level. It has no groups left, but it still owns arrays. */
  release_level(tree->context, &tree->levels[tree->depth + 1]);
  memmove(tree->levels + 1, tree->levels, (size_t)(tree->depth + 1) * sizeof *tree->levels);
  stratus_octree_level* old = &tree->levels[1];
  const stratus_octree_list root = old->nodes[0];
  const unsigned split = old->split[0] & 1u;
  old->nodes[0] = (stratus_octree_list){ 0 };
  old->nodes[octant] = root;
  old->split[0] = (uint8_t)(split << octant);
  old->stuck[0] = 0;
  old->used[0] = tree->clock;
  top.groups = 1;
  top.split[0] = 1;
  tree->levels[0] = top;
  ++tree->depth;
  stratus_octree_count_splits(&tree->levels[0]);
  stratus_octree_count_splits(&tree->levels[1]);
  for (int a = 0; a < 3; ++a) {
    tree->corner[a] -= octant >> a & 1 ? tree->edge : 0.0;
  }
  tree->edge *= 2.0;
  return STRATUS_OK;
}

stratus_status stratus_octree_grow(stratus_octree* tree, const float box[6])
{
  while (tree->rooted && !stratus_octree_root_holds(tree, box)) {
    double lo[3], hi[3];
    unsigned octant = 0;
    stratus_octree_extent(tree, box, lo, hi);
    for (int a = 0; a < 3; ++a) {
      /* The new root extends towards the box: on each axis where the box reaches below the old root, that root becomes the upper half. */
      octant |= (unsigned)(lo[a] <= tree->corner[a]) << a;
    }
    if (tree->edge >= tree->first_edge * FIRST_GROWTH) {
      return flatten(tree);
    }
    TRY(raise_root(tree, octant));
  }
  return STRATUS_OK;
}
