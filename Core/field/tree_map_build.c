/* SPDX-License-Identifier: BSD-3-Clause
 * Converts a tree to a map for the march: the nodes' boxes in blocks, and for each leaf a distance map of its own blocks. See
 * kernels/field/tree_map.h for the layout. */
#include "tree_map_build.h"

#include <string.h>

#define PADDING 64
/* Leaves of at most this many blocks get no distance transform; all their distances are 1. */
#define SMALL_LEAF 64

typedef struct extent {
  int32_t lo[3], n[3];
} extent;

static extent blocks_of(const stratus_tree_node* node)
{
  extent e;
  for (int a = 0; a < 3; ++a) {
    e.lo[a] = node->lo[a] / STRATUS_BRICK;
    e.n[a] = (node->hi[a] - 1) / STRATUS_BRICK - e.lo[a] + 1;
  }
  return e;
}

static size_t volume_of(const extent* e)
{
  return (size_t)e->n[0] * (size_t)e->n[1] * (size_t)e->n[2];
}

static void mark(const extent* e, const int32_t at[3], uint8_t* occupied)
{
  occupied[((size_t)(at[2] - e->lo[2]) * (size_t)e->n[1] + (size_t)(at[1] - e->lo[1])) * (size_t)e->n[0] + (size_t)(at[0] - e->lo[0])] = 1;
}

/* Sets the bytes of the leaf's occupied blocks to 1, all others to 0. */
static void mark_leaf(const stratus_tree* tree, const stratus_tree_node* node, const extent* e, uint8_t* occupied)
{
  memset(occupied, 0, volume_of(e));
  if (stratus_tree_node_kind(node) == STRATUS_NODE_BRICKS) {
    for (uint32_t b = 0; b < stratus_tree_node_count(node); ++b) {
      const stratus_brick* brick = &tree->bricks[node->first + b];
      mark(e, (const int32_t[3]){ brick->at[0], brick->at[1], brick->at[2] }, occupied);
    }
    return;
  }
  const stratus_tree_field* field = &tree->fields[node->first];
  const int shift = tree->cell_log2 ? 0 : 2; /* from cells to blocks */
  for (int32_t k = 0; k < field->cells[2]; ++k) {
    for (int32_t j = 0; j < field->cells[1]; ++j) {
      for (int32_t i = 0; i < field->cells[0]; ++i) {
        uint64_t mask;
        if (stratus_tree_field_leap(tree, field, 0, i, j, k, &mask) == 0) {
          const int32_t at[3] = { (field->at[0] + i) >> shift, (field->at[1] + j) >> shift, (field->at[2] + k) >> shift };
          mark(e, at, occupied);
        }
      }
    }
  }
}

static stratus_status fill_leaf(stratus_context* context, const extent* e, uint8_t* bytes)
{
  stratus_occupancy occupancy = { .context = context, .block_size = STRATUS_BRICK, .occupied = bytes };
  const size_t blocks = volume_of(e);
  stratus_distance_map* map = NULL;
  if (blocks <= SMALL_LEAF) {
    for (size_t b = 0; b < blocks; ++b) {
      bytes[b] = bytes[b] ? 129 : 1;
    }
    return STRATUS_OK;
  }
  for (int a = 0; a < 3; ++a) {
    occupancy.blocks[a] = occupancy.hi[a] = e->n[a];
  }
  for (size_t b = 0; b < blocks; ++b) {
    occupancy.count += bytes[b];
  }
  TRY(stratus_distance_map_create(context, &occupancy, STRATUS_DISTANCE_FULL, &map));
  for (size_t row = 0; row < (size_t)e->n[1] * (size_t)e->n[2]; ++row) {
    memcpy(bytes + row * (size_t)e->n[0], map->bytes + row * map->pitch, (size_t)e->n[0]);
  }
  stratus_distance_map_destroy(map);
  return STRATUS_OK;
}

static stratus_status fill(stratus_context* context, const stratus_tree* tree, stratus_distance_map* map)
{
  int32_t* const records = (int32_t*)(void*)map->bytes;
  size_t place = (tree->node_count + (size_t)tree->statistics.leaves) * 8 * sizeof(int32_t);
  int32_t leaves = 0;
  for (uint32_t n = 0; n < tree->node_count; ++n) {
    const stratus_tree_node* node = &tree->nodes[n];
    const extent e = blocks_of(node);
    int32_t* const record = records + 8 * n;
    const bool inner = stratus_tree_node_kind(node) == STRATUS_NODE_INNER;
    for (int a = 0; a < 3; ++a) {
      record[a] = e.lo[a];
      record[3 + a] = e.lo[a] + e.n[a] - 1;
    }
    record[6] = inner ? (int32_t)node->first : leaves;
    record[7] = !inner;
    if (!inner) {
      int32_t* const leaf = records + 8 * (tree->node_count + (uint32_t)leaves++);
      for (int a = 0; a < 3; ++a) {
        leaf[a] = e.lo[a];
        leaf[3 + a] = e.n[a];
      }
      leaf[6] = (int32_t)place;
      leaf[7] = 0;
      mark_leaf(tree, node, &e, map->bytes + place);
      TRY(fill_leaf(context, &e, map->bytes + place));
      place += volume_of(&e);
    }
  }
  memset(map->bytes + place, 127, PADDING);
  return STRATUS_OK;
}

size_t stratus_tree_map_blocks(const stratus_tree* tree)
{
  size_t blocks = 0;
  for (uint32_t n = 0; n < tree->node_count; ++n) {
    if (stratus_tree_node_kind(&tree->nodes[n]) != STRATUS_NODE_INNER) {
      const extent e = blocks_of(&tree->nodes[n]);
      blocks += volume_of(&e);
    }
  }
  return blocks;
}

stratus_status stratus_tree_map_create(stratus_context* context, const stratus_tree* tree, int block_size, stratus_distance_map** out)
{
  double size = ((double)tree->node_count + (double)tree->statistics.leaves) * 8 * sizeof(int32_t) + PADDING;
  void* memory;
  for (uint32_t n = 0; n < tree->node_count; ++n) {
    if (stratus_tree_node_kind(&tree->nodes[n]) != STRATUS_NODE_INNER) {
      const extent e = blocks_of(&tree->nodes[n]);
      size += (double)e.n[0] * (double)e.n[1] * (double)e.n[2];
    }
  }
  if (size > (double)INT32_MAX) {
    return stratus_fail(context, STRATUS_OVERFLOW, "a tree of %.3g bytes of blocks: at most %d", size, INT32_MAX);
  }
  TRY(stratus_allocate_zero(context, 1, sizeof(stratus_distance_map), &memory));
  stratus_distance_map* map = memory;
  map->context = context;
  map->tree_nodes = (int)tree->node_count;
  map->block_size = block_size;
  map->bytes_size = (size_t)size;
  for (int a = 0; a < 3; ++a) {
    map->blocks[a] = (tree->dimensions[a] + STRATUS_BRICK - 1) / STRATUS_BRICK;
  }
  stratus_status status = stratus_allocate(context, map->bytes_size, 1, &memory);
  if (status == STRATUS_OK) {
    map->bytes = memory;
    status = fill(context, tree, map);
  }
  if (status != STRATUS_OK) {
    stratus_distance_map_destroy(map);
    return status;
  }
  *out = map;
  return STRATUS_OK;
}

stratus_status stratus_tree_of_occupancy(stratus_context* context, const stratus_occupancy* occupancy, stratus_tree** tree)
{
  stratus_voxels voxels = { .context = context, .brick_count = occupancy->count, .count = occupancy->count * 64 };
  void* memory;
  int64_t next = 0;
  for (int a = 0; a < 3; ++a) {
    if (occupancy->blocks[a] > STRATUS_AXIS_MAX / STRATUS_BRICK) {
      return stratus_fail(context, STRATUS_UNSUPPORTED, "a tree of %lld blocks along an axis: at most %d", (long long)occupancy->blocks[a],
        STRATUS_AXIS_MAX / STRATUS_BRICK);
    }
    voxels.bricks_along[a] = occupancy->blocks[a];
    voxels.dimensions[a] = occupancy->blocks[a] * STRATUS_BRICK;
    voxels.lo[a] = occupancy->lo[a] * STRATUS_BRICK;
    voxels.hi[a] = occupancy->hi[a] * STRATUS_BRICK;
    voxels.index_to_world[5 * a] = 1.0;
  }
  voxels.index_to_world[15] = 1.0;
  TRY(stratus_allocate(context, (size_t)occupancy->count, sizeof *voxels.bricks, &memory));
  voxels.bricks = memory;
  for (int64_t k = 0, b = 0; k < occupancy->blocks[2]; ++k) {
    for (int64_t j = 0; j < occupancy->blocks[1]; ++j) {
      for (int64_t i = 0; i < occupancy->blocks[0]; ++i, ++b) {
        if (occupancy->occupied[b]) {
          voxels.bricks[next++] = (stratus_brick){ .mask = ~0ull, .at = { (uint16_t)i, (uint16_t)j, (uint16_t)k }, .count = 64 };
        }
      }
    }
  }
  stratus_tree_options options = stratus_tree_options_default();
  options.method = STRATUS_TREE_HYBRID;
  const stratus_status status = stratus_tree_create(context, &voxels, &options, tree);
  stratus_release(context, voxels.bricks);
  return status;
}
