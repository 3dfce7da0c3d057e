/* SPDX-License-Identifier: BSD-3-Clause
 * The order of boxes along an eye's rays. */
#ifndef STRATUS_BLOCK_ORDER_H
#define STRATUS_BLOCK_ORDER_H

#include "base.h"

/* A box along the axes of the coordinates that all boxes and the eye are given in. */
typedef struct stratus_block_box {
  double lo[3], hi[3];
} stratus_block_box;

/* Where rays come from. */
typedef struct stratus_block_eye {
  double point[3]; /* parallel: the direction in which rays go */
  bool parallel;
} stratus_block_eye;

/* Sets order[0..count-1] to the boxes' numbers, so that no box hides one that comes before it. Boxes that reach into one another by less
 * than `slack` count as side by side. Where they reach farther, or three hide one another in a ring, the nearest middle comes first; then
 * overlap[0] and overlap[1] are the numbers of two boxes that overlap, else -1. */
stratus_status stratus_block_order(stratus_context* context, const stratus_block_box* boxes, int count, const stratus_block_eye* eye,
  double slack, int* order, int overlap[2]);

#endif
