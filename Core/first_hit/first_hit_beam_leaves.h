/* SPDX-License-Identifier: BSD-3-Clause
 * Beams of rays (first_hit_beams.h) through trees. A beam descends to the leaves that its cross-section touches, front leaves first, and is
 * placed again in the field of each. One of two siblings is before a plane across an axis, and the rays meet it first.
 *
 * Included by first_hit_isa.c. */
#ifndef STRATUS_FIRST_HIT_BEAM_LEAVES_H
#define STRATUS_FIRST_HIT_BEAM_LEAVES_H

#include "first_hit_beams.h"

#define BEAM_STACK 130 /* a beam leaves one node behind at each level; trees are at most 128 deep */

/* Set the cells in which a beam is placed to the cells of a box of voxels. */
static inline void beam_cells(const int32_t lo[3], const int32_t hi[3], stratus_hit_arguments* a)
{
  for (int axis = 0; axis < 3; ++axis) {
    a->at[axis] = lo[axis] / STRATUS_BRICK;
    a->cells[axis] = (hi[axis] - 1) / STRATUS_BRICK - a->at[axis] + 1;
  }
}

/* Returns whether the beam touches a box of voxels, [lo, hi). */
static inline bool beam_touches(const stratus_hit_arguments* a, const hit_beam* beam, const int32_t lo[3], const int32_t hi[3])
{
  const float cell = 1.0f / STRATUS_BRICK;
  const int axes[3] = { beam->axis, beam->across[0], beam->across[1] };
  float low[3], high[3];
  for (int n = 0; n < 3; ++n) {
    const int axis = axes[n], first = a->at[axis] * STRATUS_BRICK, beyond = first + a->cells[axis] * STRATUS_BRICK;
    low[n] = ((float)(beam->up[axis] ? lo[axis] - first : beyond - hi[axis]) - a->slack) * cell;
    high[n] = ((float)(beam->up[axis] ? hi[axis] - first : beyond - lo[axis]) + a->slack) * cell;
  }
  const float from = low[0] > beam->begin ? low[0] : beam->begin, to = high[0] < beam->end ? high[0] : beam->end;
  const four borders = beam_between(beam, from, to);
  return from <= to && borders[0] <= high[1] && borders[1] <= high[2] && borders[2] >= low[1] && borders[3] >= low[2];
}

static inline bool beam_alive(const beam_rays* rays)
{
  int left = 0;
  for (int part = 0; part < BEAM_PARTS; ++part) {
    left |= m_any(rays->live[part]);
  }
  return left != 0;
}

/* Walk the beam through a leaf. `a` and `beam` belong to the whole tree. */
static inline void beam_walk_leaf(const stratus_hit_batch* batch, const stratus_hit_arguments* a, const stratus_hit_chunk* c,
  const hit_beam* beam, const stratus_tree_node* node, beam_rays* rays, int* looks)
{
  const stratus_tree* tree = batch->tree;
  if (stratus_tree_node_kind(node) == STRATUS_NODE_FIELD) {
    const stratus_tree_field* field = &tree->fields[node->first];
    stratus_hit_arguments own = *a;
    hit_beam placed = *beam;
    beam_cells(node->lo, node->hi, &own);
    own.row_start = (int)field->first_row;
    beam_place(&own, &placed);
    placed.origin += field->first_entry;
    beam_borders(&own, c, &placed);
    beam_walk_field(batch, &own, c, &placed, rays, looks);
    return;
  }
  for (uint32_t b = node->first; b < node->first + stratus_tree_node_count(node); ++b) {
    const stratus_brick* brick = &tree->bricks[b];
    const int32_t lo[3] = { brick->at[0] * STRATUS_BRICK, brick->at[1] * STRATUS_BRICK, brick->at[2] * STRATUS_BRICK };
    const int32_t hi[3] = { lo[0] + STRATUS_BRICK, lo[1] + STRATUS_BRICK, lo[2] + STRATUS_BRICK };
    *looks += 1;
    for (uint64_t left = beam_touches(a, beam, lo, hi) ? brick->mask : 0; left; left &= left - 1) {
      const int bit = __builtin_ctzll(left);
      const int voxel[3] = { lo[0] + (bit & 3), lo[1] + (bit >> 2 & 3), lo[2] + (bit >> 4) };
      beam_meet(a, beam, voxel, rays);
    }
  }
  beam_settle(rays);
}

/* Returns 0 or 1, the child that rays of the beam meet first. */
static inline uint32_t beam_nearer(const hit_beam* beam, const stratus_tree_node child[2])
{
  for (int axis = 0; axis < 3; ++axis) {
    if (beam->up[axis] ? child[1].lo[axis] >= child[0].hi[axis] : child[0].lo[axis] >= child[1].hi[axis]) {
      return 0;
    }
  }
  return 1;
}

static inline void beam_walk_leaves(const stratus_hit_batch* batch, const stratus_hit_arguments* a, const stratus_hit_chunk* c,
  const hit_beam* beam, beam_rays* rays, int* looks)
{
  const stratus_tree_node* nodes = batch->tree->nodes;
  uint32_t stack[BEAM_STACK];
  int top = 0;
  stack[top++] = 0;
  while (top > 0 && beam_alive(rays)) {
    const stratus_tree_node* node = &nodes[stack[--top]];
    *looks += 1;
    if (!beam_touches(a, beam, node->lo, node->hi)) {
      continue;
    }
    if (stratus_tree_node_kind(node) != STRATUS_NODE_INNER) {
      beam_walk_leaf(batch, a, c, beam, node, rays, looks);
      continue;
    }
    const uint32_t nearer = beam_nearer(beam, nodes + node->first);
    stack[top++] = node->first + 1 - nearer;
    stack[top++] = node->first + nearer;
  }
}

/* Walks BEAM rays of a chunk from `first` on, if they make a narrow beam or miss the tree. Returns false if they do not. */
static inline bool beam_walk(const stratus_hit_batch* batch, const stratus_hit_arguments* a, int first, stratus_hit_chunk* c)
{
  stratus_hit_arguments whole = *a;
  hit_beam beam = { .first = first };
  beam_rays rays;
  int looks = 0;
  const int live = beam_direction(c, first, &beam);
  if (live < 0) {
    return false;
  }
  if (batch->leaves) {
    beam_cells(batch->tree->nodes[0].lo, batch->tree->nodes[0].hi, &whole);
  }
  beam_place(&whole, &beam);
  if (live > 0 && !beam_borders(&whole, c, &beam)) {
    return false;
  }
  beam_take_rays(c, &beam, &rays);
  if (live > 0 && batch->leaves) {
    beam_walk_leaves(batch, &whole, c, &beam, &rays, &looks);
  } else if (live > 0) {
    beam_walk_field(batch, &whole, c, &beam, &rays, &looks);
  }
  beam_store(&beam, &rays, live, looks, c);
  return true;
}

#endif
