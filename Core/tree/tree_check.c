/* SPDX-License-Identifier: BSD-3-Clause
 * Checks a tree against the voxels that it was made of. */
#include "tree.h"

#include <string.h>

#define WRONG(...) stratus_fail(context, STRATUS_INVALID_ARGUMENT, __VA_ARGS__)

/* The voxels that the leaves checked so far hold. */
typedef struct census {
  const stratus_voxels* voxels;
  uint64_t* seen; /* a mask per brick */
  int64_t count;
} census;

static int64_t find_brick(const stratus_voxels* voxels, const int32_t at[3])
{
  int64_t lo = 0, hi = voxels->brick_count;
  while (lo < hi) {
    const int64_t middle = lo + (hi - lo) / 2;
    const stratus_brick* b = &voxels->bricks[middle];
    const int before = b->at[2] != at[2] ? b->at[2] < at[2] : b->at[1] != at[1] ? b->at[1] < at[1] : b->at[0] < at[0];
    if (before) {
      lo = middle + 1;
    } else {
      hi = middle;
    }
  }
  return lo < voxels->brick_count && voxels->bricks[lo].at[0] == at[0] && voxels->bricks[lo].at[1] == at[1] &&
      voxels->bricks[lo].at[2] == at[2]
    ? lo
    : -1;
}

/* Counts the voxels of a mask and widens [lo, hi) to contain them. Returns false if one is not effective or was counted before. */
static bool count_mask(census* c, const int32_t at[3], uint64_t mask, int32_t lo[3], int32_t hi[3])
{
  const int64_t brick = find_brick(c->voxels, at);
  if (brick < 0 || (mask & ~c->voxels->bricks[brick].mask) || (mask & c->seen[brick])) {
    return false;
  }
  c->seen[brick] |= mask;
  for (; mask; mask &= mask - 1) {
    const int bit = __builtin_ctzll(mask);
    const int32_t voxel[3] = { at[0] * 4 + (bit & 3), at[1] * 4 + (bit >> 2 & 3), at[2] * 4 + (bit >> 4) };
    for (int a = 0; a < 3; ++a) {
      lo[a] = voxel[a] < lo[a] ? voxel[a] : lo[a];
      hi[a] = voxel[a] + 1 > hi[a] ? voxel[a] + 1 : hi[a];
    }
    ++c->count;
  }
  return true;
}

/* ---------------------------------------------------------------- distance fields */

/* Counts the occupied cells in [lo, hi), clipped to the field. sums[] holds the counts of [0, i) x [0, j) x [0, k). */
static int64_t occupied_in(const stratus_tree_field* f, const int64_t* sums, const int64_t lo[3], const int64_t hi[3])
{
  const int64_t nx = f->cells[0] + 1, ny = f->cells[1] + 1;
  int64_t sum = 0;
  for (int corner = 0; corner < 8; ++corner) {
    int64_t at[3];
    for (int a = 0; a < 3; ++a) {
      at[a] = corner >> a & 1 ? hi[a] : lo[a];
      at[a] = at[a] < 0 ? 0 : at[a] > f->cells[a] ? f->cells[a] : at[a];
    }
    const int64_t term = sums[(at[2] * ny + at[1]) * nx + at[0]];
    sum += __builtin_popcount((unsigned)corner) % 2 ? term : -term;
  }
  return sum;
}

static stratus_status check_leaps(stratus_context* context, const stratus_tree* tree, const stratus_tree_field* f, const int64_t* sums)
{
  for (int32_t k = 0; k < f->cells[2]; ++k) {
    for (int32_t j = 0; j < f->cells[1]; ++j) {
      for (int32_t i = 0; i < f->cells[0]; ++i) {
        for (int octant = 0; octant < 8; ++octant) {
          uint64_t mask;
          const int32_t leap = stratus_tree_field_leap(tree, f, octant, i, j, k, &mask);
          const int32_t at[3] = { i, j, k };
          int64_t lo[3], hi[3];
          for (int a = 0; a < 3; ++a) {
            const bool up = octant >> a & 1;
            lo[a] = up && tree->octants ? at[a] : at[a] - leap + 1;
            hi[a] = !up && tree->octants ? at[a] + 1 : at[a] + leap;
          }
          if (mask == 0 && (leap < 1 || occupied_in(f, sums, lo, hi) != 0)) {
            return WRONG("cell %d %d %d of a distance field: a leap of %d is too long", i, j, k, leap);
          }
        }
      }
    }
  }
  return STRATUS_OK;
}

static stratus_status check_field(
  stratus_context* context, const stratus_tree* tree, const stratus_tree_field* f, census* c, int32_t lo[3], int32_t hi[3])
{
  const int64_t nx = f->cells[0] + 1, ny = f->cells[1] + 1, nz = f->cells[2] + 1;
  stratus_status status = STRATUS_OK;
  void* memory;
  size_t size;
  TRY(stratus_product(context, "sums of a distance field", (size_t)nx, (size_t)ny, (size_t)nz, &size));
  TRY(stratus_allocate_zero(context, size, sizeof(int64_t), &memory));
  int64_t* const sums = memory;
  for (int32_t k = 0; k < f->cells[2] && status == STRATUS_OK; ++k) {
    for (int32_t j = 0; j < f->cells[1] && status == STRATUS_OK; ++j) {
      int64_t row = 0;
      for (int32_t i = 0; i < f->cells[0]; ++i) {
        uint64_t mask;
        stratus_tree_field_leap(tree, f, 0, i, j, k, &mask);
        row += mask != 0;
        const int64_t at_sum = ((k + 1) * ny + j + 1) * nx + i + 1;
        sums[at_sum] = row + sums[at_sum - nx] + sums[at_sum - ny * nx] - sums[at_sum - ny * nx - nx];
        int32_t at[3] = { f->at[0] + i, f->at[1] + j, f->at[2] + k };
        if (mask && tree->cell_log2 == 0) {
          mask <<= (at[2] & 3) << 4 | (at[1] & 3) << 2 | (at[0] & 3);
          for (int a = 0; a < 3; ++a) {
            at[a] >>= 2;
          }
        }
        if (mask && !count_mask(c, at, mask, lo, hi)) {
          status = WRONG("cell %d %d %d of a distance field holds a voxel that is none, or another leaf's", at[0], at[1], at[2]);
          break;
        }
      }
    }
  }
  if (status == STRATUS_OK) {
    status = check_leaps(context, tree, f, sums);
  }
  stratus_release(context, sums);
  return status;
}

/* ---------------------------------------------------------------- nodes */

static stratus_status check_nodes(stratus_context* context, const stratus_tree* tree, census* c, stratus_box* boxes)
{
  for (uint32_t n = tree->node_count; n-- > 0;) {
    const stratus_tree_node* node = &tree->nodes[n];
    stratus_box* box = &boxes[n];
    for (int a = 0; a < 3; ++a) {
      box->lo[a] = INT32_MAX;
      box->hi[a] = INT32_MIN;
    }
    switch (stratus_tree_node_kind(node)) {
      case STRATUS_NODE_INNER:
        if (node->first <= n || node->first + 1 >= tree->node_count) {
          return WRONG("node %u has children %u and %u of %u nodes", n, node->first, node->first + 1, tree->node_count);
        }
        for (int a = 0; a < 3; ++a) {
          const stratus_box *left = &boxes[node->first], *right = left + 1;
          box->lo[a] = left->lo[a] < right->lo[a] ? left->lo[a] : right->lo[a];
          box->hi[a] = left->hi[a] > right->hi[a] ? left->hi[a] : right->hi[a];
        }
        break;
      case STRATUS_NODE_BRICKS:
        for (uint32_t b = 0; b < stratus_tree_node_count(node); ++b) {
          const stratus_brick* brick = &tree->bricks[node->first + b];
          const int32_t at[3] = { brick->at[0], brick->at[1], brick->at[2] };
          if (!count_mask(c, at, brick->mask, box->lo, box->hi)) {
            return WRONG("brick %d %d %d holds a voxel that is none, or another leaf's", at[0], at[1], at[2]);
          }
        }
        break;
      case STRATUS_NODE_FIELD:
        TRY(check_field(context, tree, &tree->fields[node->first], c, box->lo, box->hi));
        break;
    }
    if (memcmp(box->lo, node->lo, sizeof box->lo) != 0 || memcmp(box->hi, node->hi, sizeof box->hi) != 0) {
      return WRONG("node %u: its box %d %d %d .. %d %d %d is not the tight one, %d %d %d .. %d %d %d", n, node->lo[0], node->lo[1],
        node->lo[2], node->hi[0], node->hi[1], node->hi[2], box->lo[0], box->lo[1], box->lo[2], box->hi[0], box->hi[1], box->hi[2]);
    }
  }
  return STRATUS_OK;
}

stratus_status stratus_tree_check(stratus_context* context, const stratus_tree* tree, const stratus_voxels* voxels)
{
  stratus_status status = STRATUS_OK;
  void *seen = NULL, *boxes = NULL;
  if (!context) {
    return STRATUS_INVALID_ARGUMENT;
  }
  if (!tree || !voxels) {
    return WRONG("%s is NULL", tree ? "voxels" : "tree");
  }
  if (tree->statistics.uncorrected) {
    return WRONG("the distances of the tree's leaves are flooded ones without correction");
  }
  TRY_CLEANUP(stratus_allocate_zero(context, (size_t)voxels->brick_count, sizeof(uint64_t), &seen));
  TRY_CLEANUP(stratus_allocate(context, tree->node_count, sizeof(stratus_box), &boxes));
  census c = { .voxels = voxels, .seen = seen };
  TRY_CLEANUP(check_nodes(context, tree, &c, boxes));
  if (c.count != voxels->count) {
    status = WRONG("the leaves hold %lld of %lld voxels", (long long)c.count, (long long)voxels->count);
  }

cleanup:
  stratus_release(context, seen);
  stratus_release(context, boxes);
  return status;
}
