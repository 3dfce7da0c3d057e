/* SPDX-License-Identifier: BSD-3-Clause
 * Splitting: several nodes of one level each hand their objects down to eight children, which take their places in Morton order in the
 * level below. All memory is allocated before the tree changes. */
#include "octree.h"

#include <string.h>

#define PARTED 32  /* a split must hand down at least one object in so many */
#define REPEATED 4 /* touching: a split must make at most this many copies of each object on average */

/* Lists that replace a split node's list: the children's in [0..7], its own in [8]. */
typedef struct parted {
  stratus_octree_list lists[9];
} parted;

static size_t octants_of(unsigned code, bool touching)
{
  return touching ? (size_t)__builtin_popcount(code) : code < 8;
}

/* Fills codes[] with each object's octants and allocates the new lists. *productive: the split separates the objects. */
static stratus_status part(
  const stratus_octree* tree, int level, const stratus_octree_place* place, uint8_t* codes, parted* parts, bool* productive)
{
  const bool touching = tree->options.placement == STRATUS_OCTREE_TOUCHING;
  const stratus_octree_list* list = &tree->levels[level].nodes[place->node];
  const double size = stratus_octree_cell_size(tree, level);
  size_t counts[9] = { 0 }, handed = 0;
  double corner[3];
  stratus_octree_cell_corner(tree, level, place, corner);
  memset(parts, 0, sizeof *parts);
  for (uint32_t i = 0; i < list->count; ++i) {
    float box[6];
    stratus_list_get(list, i, box);
    const unsigned code = stratus_octree_octants(tree, corner, size, box);
    codes[i] = (uint8_t)code;
    handed += octants_of(code, touching);
    for (unsigned o = 0; touching && o < 8; ++o) {
      counts[o] += code >> o & 1;
    }
    counts[8] += !touching && code == 8;
    counts[code & 7] += !touching && code < 8;
  }
  *productive = touching ? handed <= (size_t)REPEATED * list->count : handed * PARTED >= list->count;
  stratus_status status = STRATUS_OK;
  for (int o = 0; *productive && o < 9; ++o) {
    TRY_CLEANUP(stratus_list_allocate(tree->context, counts[o], &parts->lists[o]));
  }
cleanup:
  for (int o = 0; status != STRATUS_OK && o < 9; ++o) {
    stratus_list_release(tree->context, &parts->lists[o]);
  }
  return status;
}

/* Cannot fail: part() has allocated the lists. */
static void hand_down(stratus_octree* tree, const stratus_octree_list* list, const uint8_t* codes, parted* parts)
{
  const bool touching = tree->options.placement == STRATUS_OCTREE_TOUCHING;
  const uint32_t* ids = stratus_list_ids(list);
  for (uint32_t i = 0; i < list->count; ++i) {
    float box[6];
    stratus_list_get(list, i, box);
    for (unsigned octants = touching ? codes[i] : 1u << codes[i]; octants; octants &= octants - 1) {
      stratus_octree_list* to = &parts->lists[__builtin_ctz(octants)];
      const uint32_t slot = to->count++;
      stratus_list_clear_rest(to, slot);
      stratus_list_set(to, slot, box);
      stratus_list_ids(to)[slot] = ids[i];
      tree->slot[ids[i]] = slot;
    }
  }
}

/* Inserts `count` new groups into the level below, from its end backwards, and moves the new lists there. */
static void insert_groups(stratus_octree* tree, int level, const stratus_octree_place* places, const parted* parts, size_t count)
{
  stratus_octree_level *above = &tree->levels[level], *below = &tree->levels[level + 1];
  size_t from = below->groups, to = below->groups + count;
  for (size_t i = count; i-- > 0;) {
    const size_t node = places[i].node;
    const size_t before = stratus_octree_child_group(above, node), move = from - before;
    from = before;
    to -= move;
    memmove(below->nodes + 8 * to, below->nodes + 8 * from, move * 8 * sizeof *below->nodes);
    memmove(below->split + to, below->split + from, move);
    memmove(below->stuck + to, below->stuck + from, move);
    memmove(below->used + to, below->used + from, move * sizeof *below->used);
    --to;
    memcpy(below->nodes + 8 * to, parts[i].lists, 8 * sizeof *below->nodes);
    below->split[to] = below->stuck[to] = 0;
    below->used[to] = tree->clock;
  }
  for (size_t i = 0; i < count; ++i) {
    const size_t node = places[i].node;
    stratus_list_release(tree->context, &above->nodes[node]);
    above->nodes[node] = parts[i].lists[8];
    above->split[node >> 3] = (uint8_t)(above->split[node >> 3] | 1u << (node & 7));
  }
  below->groups += count;
  stratus_octree_count_splits(above);
  stratus_octree_count_splits(below);
  if (count > 0 && tree->depth < level + 1) {
    tree->depth = level + 1;
  }
}

stratus_status stratus_octree_split(
  stratus_octree* tree, int level, const stratus_octree_place* given, size_t count, uint64_t* splits, uint64_t* handed_down)
{
  stratus_octree_level* nodes = &tree->levels[level];
  stratus_status status = STRATUS_OK;
  size_t largest = 0, done = 0;
  void *parts_memory = NULL, *places_memory = NULL, *codes_memory = NULL;
  size_t objects = 0;
  if (count == 0) {
    return STRATUS_OK;
  }
  for (size_t i = 0; i < count; ++i) {
    largest += nodes->nodes[given[i].node].count;
  }
  TRY_CLEANUP(stratus_allocate(tree->context, count, sizeof(parted), &parts_memory));
  TRY_CLEANUP(stratus_allocate(tree->context, count, sizeof *given, &places_memory));
  TRY_CLEANUP(stratus_allocate(tree->context, largest, 1, &codes_memory));
  parted* parts = parts_memory;
  stratus_octree_place* places = places_memory;
  uint8_t* codes = codes_memory;
  TRY_CLEANUP(stratus_octree_reserve_groups(tree->context, &tree->levels[level + 1], tree->levels[level + 1].groups + count));
  for (size_t i = 0; i < count; ++i) {
    const size_t node = given[i].node;
    bool productive = false;
    TRY_CLEANUP(part(tree, level, &given[i], codes + objects, &parts[done], &productive));
    if (!productive) {
      nodes->stuck[node >> 3] = (uint8_t)(nodes->stuck[node >> 3] | 1u << (node & 7));
      continue;
    }
    objects += nodes->nodes[node].count;
    places[done++] = given[i];
  }
  objects = 0;
  for (size_t i = 0; i < done; ++i) {
    const stratus_octree_list* list = &nodes->nodes[places[i].node];
    hand_down(tree, list, codes + objects, &parts[i]);
    objects += list->count;
  }
  insert_groups(tree, level, places, parts, done);
  *splits += done;
  *handed_down += objects;
cleanup:
  for (size_t i = 0; status != STRATUS_OK && i < done; ++i) {
    for (int o = 0; o < 9; ++o) {
      stratus_list_release(tree->context, &((parted*)parts_memory)[i].lists[o]);
    }
  }
  stratus_release(tree->context, codes_memory);
  stratus_release(tree->context, places_memory);
  stratus_release(tree->context, parts_memory);
  return status;
}
