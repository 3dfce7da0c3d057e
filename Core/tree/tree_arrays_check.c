/* SPDX-License-Identifier: BSD-3-Clause
 * Checks of the arrays of a tree that was read from bytes. All numbers and leaps are checked before the tree is returned. */
#include "tree.h"

#include <string.h>

#define DEPTH_MAX 128
#define WRONG(...) stratus_fail(context, STRATUS_INVALID_ARGUMENT, __VA_ARGS__)

static bool box_inside(const stratus_tree_node* node, const int32_t lo[3], const int32_t hi[3])
{
  for (int a = 0; a < 3; ++a) {
    if (node->lo[a] < lo[a] || node->hi[a] > hi[a] || node->lo[a] >= node->hi[a]) {
      return false;
    }
  }
  return true;
}

/* Return whether a leaf's bricks are in its box, voxel by voxel, and belong to no other leaf. */
static bool bricks_fit(const stratus_tree* tree, const stratus_tree_node* node, uint8_t* taken)
{
  for (uint32_t b = node->first; b < node->first + stratus_tree_node_count(node); ++b) {
    const stratus_brick* brick = &tree->bricks[b];
    if (taken[b]) {
      return false;
    }
    taken[b] = 1;
    for (uint64_t left = brick->mask; left; left &= left - 1) {
      const int bit = __builtin_ctzll(left);
      const int32_t voxel[3] = { brick->at[0] * 4 + (bit & 3), brick->at[1] * 4 + (bit >> 2 & 3), brick->at[2] * 4 + (bit >> 4) };
      for (int a = 0; a < 3; ++a) {
        if (voxel[a] < node->lo[a] || voxel[a] >= node->hi[a]) {
          return false;
        }
      }
    }
  }
  return true;
}

/* Return whether a plane across an axis is between the children of a node. First hits in hybrid trees rely on it. */
static bool plane_between(const stratus_tree_node child[2])
{
  bool between = false;
  for (int a = 0; a < 3; ++a) {
    between |= child[0].hi[a] <= child[1].lo[a] || child[1].hi[a] <= child[0].lo[a];
  }
  return between;
}

/* Checks that each node but the root is the child of an earlier node, that children lie inside their parents, and that the leaves hold as
 * many bricks and fields as the tree. */
static stratus_status check_nodes(stratus_context* context, const stratus_tree* tree, uint8_t* depth, uint8_t* taken)
{
  static const int32_t zero[3] = { 0, 0, 0 };
  const bool hybrid = tree->statistics.method == STRATUS_TREE_HYBRID || tree->statistics.method == STRATUS_TREE_HYBRID_PAPER;
  uint32_t bricks = 0, fields = 0;
  memset(depth, 255, tree->node_count);
  for (uint32_t n = 0; n < tree->node_count; ++n) {
    const stratus_tree_node* node = &tree->nodes[n];
    const uint32_t count = stratus_tree_node_count(node);
    if (n == 0) {
      depth[0] = 0;
    }
    if (depth[n] == 255 || !box_inside(node, zero, tree->dimensions)) {
      return WRONG("node %u of the tree is nobody's child, or has no box in the volume", n);
    }
    switch (node->kind_count >> 30) {
      case STRATUS_NODE_INNER:
        if (node->first <= n || node->first >= tree->node_count - 1 || depth[n] >= DEPTH_MAX || depth[node->first] != 255 ||
          depth[node->first + 1] != 255 || !box_inside(&tree->nodes[node->first], node->lo, node->hi) ||
          !box_inside(&tree->nodes[node->first + 1], node->lo, node->hi)) {
          return WRONG("node %u of the tree has children that can't be its own", n);
        }
        if (hybrid && !plane_between(&tree->nodes[node->first])) {
          return WRONG("node %u of the tree has children that overlap", n);
        }
        depth[node->first] = depth[node->first + 1] = (uint8_t)(depth[n] + 1);
        break;
      case STRATUS_NODE_BRICKS:
        if (count == 0 || node->first > tree->brick_count || count > tree->brick_count - node->first || !bricks_fit(tree, node, taken)) {
          return WRONG("node %u of the tree has bricks that are not there, or not its own", n);
        }
        bricks += count;
        break;
      case STRATUS_NODE_FIELD:
        if (node->first >= tree->field_count) {
          return WRONG("node %u of the tree has a distance field that is not there", n);
        }
        ++fields;
        break;
      default:
        return WRONG("node %u of the tree is of no kind", n);
    }
  }
  return bricks == tree->brick_count && fields == tree->field_count ? STRATUS_OK : WRONG("the tree has leaves twice, or none");
}

static stratus_status check_bricks(stratus_context* context, const stratus_tree* tree)
{
  for (uint32_t b = 0; b < tree->brick_count; ++b) {
    const stratus_brick* brick = &tree->bricks[b];
    if (brick->mask == 0 || brick->count != __builtin_popcountll(brick->mask)) {
      return WRONG("brick %u of the tree is empty, or has another number of voxels than it says", b);
    }
  }
  return STRATUS_OK;
}

static stratus_status check_entries(stratus_context* context, const stratus_tree* tree, const stratus_tree_field* field)
{
  const uint32_t n = (uint32_t)field->cells[0];
  const int bits = tree->entry_bytes;
  const uint32_t low = (1u << bits) - 1u;
  for (uint32_t row = 0; row < (uint32_t)field->cells[1] * (uint32_t)field->cells[2]; ++row) {
    const uint8_t* e = tree->entries + ((size_t)field->first_entry + (size_t)row * n) * (size_t)bits;
    for (uint32_t i = 0; i < n; ++i, e += bits) {
      const uint32_t entry = (uint32_t)e[0] | (uint32_t)e[1] << 8 | (bits == 3 ? (uint32_t)e[2] << 16 : 0u);
      bool fine = true;
      if (!(entry & low)) {
        fine = tree->cell_log2 == 0 ||
          (tree->rows[field->first_row + row] < tree->mask_count &&
            (entry >> bits) < tree->mask_count - tree->rows[field->first_row + row]);
      } else if (tree->octants) {
        for (int octant = 1; octant < 8; ++octant) {
          fine = fine && (entry >> (octant * bits) & low) != 0;
        }
      } else {
        fine = entry >> 2 >= 1;
      }
      if (!fine) {
        return WRONG("a distance field of the tree has a cell that leads nowhere");
      }
    }
  }
  return STRATUS_OK;
}

static stratus_status check_fields(stratus_context* context, const stratus_tree* tree)
{
  uint64_t entries = 0, rows = 0;
  for (uint32_t f = 0; f < tree->field_count; ++f) {
    const stratus_tree_field* field = &tree->fields[f];
    bool fine = field->first_entry == entries && field->first_row == rows;
    for (int a = 0; a < 3; ++a) {
      fine = fine && field->at[a] >= 0 && field->cells[a] >= 1 && field->cells[a] <= STRATUS_AXIS_MAX &&
        ((int64_t)field->at[a] + field->cells[a] - 1) << tree->cell_log2 < tree->dimensions[a];
    }
    entries += fine ? (uint64_t)field->cells[0] * (uint64_t)field->cells[1] * (uint64_t)field->cells[2] : 0;
    rows += fine ? (uint64_t)field->cells[1] * (uint64_t)field->cells[2] : 0;
    if (!fine || entries > tree->entry_count || (tree->cell_log2 && rows > tree->row_count)) {
      return WRONG("distance field %u of the tree lies outside the volume or its entries", f);
    }
    TRY(check_entries(context, tree, field));
  }
  return entries == tree->entry_count ? STRATUS_OK : WRONG("the tree has entries that are no distance field's");
}

/* Returns the bits of a brick that lie outside the node's box; its first voxel is `first`. */
static uint64_t bits_outside(const stratus_tree_node* node, const int32_t first[3])
{
  uint64_t outside = 0;
  for (int bit = 0; bit < 64; ++bit) {
    const int32_t voxel[3] = { first[0] + (bit & 3), first[1] + (bit >> 2 & 3), first[2] + (bit >> 4) };
    for (int a = 0; a < 3; ++a) {
      outside |= voxel[a] < node->lo[a] || voxel[a] >= node->hi[a] ? 1ull << bit : 0;
    }
  }
  return outside;
}

/* Returns whether no voxel of a field's border bricks lies outside the node. The entries must have been checked before. */
static bool masks_fit(const stratus_tree* tree, const stratus_tree_node* node, const stratus_tree_field* field)
{
  const int32_t* n = field->cells;
  for (int32_t k = 0; k < n[2] && tree->cell_log2; ++k) {
    for (int32_t j = 0; j < n[1]; ++j) {
      const bool whole_row = k == 0 || k == n[2] - 1 || j == 0 || j == n[1] - 1;
      for (int32_t i = 0; i < n[0]; i += whole_row || n[0] == 1 ? 1 : n[0] - 1) {
        const int32_t first[3] = { (field->at[0] + i) * 4, (field->at[1] + j) * 4, (field->at[2] + k) * 4 };
        uint64_t mask;
        stratus_tree_field_leap(tree, field, 0, i, j, k, &mask);
        if (mask && (mask & bits_outside(node, first))) {
          return false;
        }
      }
    }
  }
  return true;
}

/* Checks that each node of a field covers exactly the field's cells. */
static stratus_status check_covers(stratus_context* context, const stratus_tree* tree)
{
  for (uint32_t n = 0; n < tree->node_count; ++n) {
    const stratus_tree_node* node = &tree->nodes[n];
    if (stratus_tree_node_kind(node) == STRATUS_NODE_FIELD) {
      const stratus_tree_field* field = &tree->fields[node->first];
      for (int a = 0; a < 3; ++a) {
        if (node->lo[a] >> tree->cell_log2 != field->at[a] || (node->hi[a] - 1) >> tree->cell_log2 != field->at[a] + field->cells[a] - 1) {
          return WRONG("node %u of the tree and its distance field lie apart", n);
        }
      }
      if (!masks_fit(tree, node, field)) {
        return WRONG("node %u of the tree has a distance field with voxels beyond its box", n);
      }
    }
  }
  return STRATUS_OK;
}

stratus_status stratus_tree_check_arrays(stratus_context* context, const stratus_tree* tree)
{
  void* depth;
  TRY(stratus_allocate_zero(context, (size_t)tree->node_count + tree->brick_count, 1, &depth));
  const stratus_status status = check_nodes(context, tree, depth, (uint8_t*)depth + tree->node_count);
  stratus_release(context, depth);
  TRY(status);
  TRY(check_bricks(context, tree));
  if (tree->statistics.method == STRATUS_TREE_WIDE && (tree->node_count > 1 || tree->field_count > 0)) {
    return WRONG("a tree of %u nodes and %u distance fields; a wide one is a leaf of bricks", tree->node_count, tree->field_count);
  }
  TRY(check_fields(context, tree));
  return check_covers(context, tree);
}
