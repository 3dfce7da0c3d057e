/* SPDX-License-Identifier: BSD-3-Clause
 * Wide hierarchies over bricks: nodes of up to 16 children, whose boxes fit two cache lines as bytes (compressed wide hierarchies: Ylitie
 * et al. 2017). The shape is a linear hierarchy over Morton codes, so that siblings never overlap. */
#ifndef STRATUS_WIDE_TREE_H
#define STRATUS_WIDE_TREE_H

#include "base.h"
#include "bvh.h"
#include "voxels.h"

#define STRATUS_WIDE 16
/* Bytes of the hierarchy and its bricks, for each brick: nodes have 9 to 10 children where sets are large. */
#define STRATUS_WIDE_BYTES 30
/* Stack size: each level leaves at most 15 siblings. A node uses 4 of the 48 code bits, unless its children are bricks. */
#define STRATUS_WIDE_STACK (15 * 14 + STRATUS_WIDE)

/* The root is node 0, and parents come before children. Child c is node `node + c` if c < inner, else brick `brick + c - inner`. Its box is
 * at + (lo[c] << shift) .. at + (hi[c] << shift) in voxels, tight where shift is 0. Places behind `count` have lo 255 and hi 0, and no
 * child: whoever reads 16 places at once masks them out. */
typedef struct stratus_wide_node {
  float at[3]; /* whole numbers */
  uint32_t node, brick;
  uint8_t count, inner, shift, unused[9];
  uint8_t lo[3][STRATUS_WIDE], hi[3][STRATUS_WIDE]; /* each of 16 bytes that are loaded at once */
} stratus_wide_node;

_Static_assert(sizeof(stratus_wide_node) == 128, "a node is two cache lines");

typedef struct stratus_wide {
  stratus_wide_node* nodes; /* at the start of a cache line within `memory` */
  uint32_t node_count;      /* 0: there is none */
  void* memory;
} stratus_wide;

/* Make a hierarchy over `count` >= 1 bricks, and bring them into the order of its leaves: *bricks is replaced. STRATUS_INVALID_ARGUMENT if
 * two bricks are at the same place. The result depends only on the set, not on the bricks' order. On failure nothing is changed. */
stratus_status stratus_wide_create(stratus_context* context, stratus_brick** bricks, uint32_t count, stratus_wide* wide);
/* The box of child c, [lo, hi) in voxels. */
stratus_box stratus_wide_box(const stratus_wide_node* node, int c);
/* The tight box of a brick's voxels. */
stratus_box stratus_brick_box(const stratus_brick* brick);
/* The surface area heuristic as stratus_bvh_sah() has it: a node costs 1, a brick 1. */
double stratus_wide_sah(const stratus_wide* wide);

#endif
