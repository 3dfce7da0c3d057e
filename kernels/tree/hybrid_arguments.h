/* SPDX-License-Identifier: BSD-3-Clause
 * The kernels' arguments for the nodes of a hybrid tree's level. */
#ifndef STRATUS_HYBRID_ARGUMENTS_H
#define STRATUS_HYBRID_ARGUMENTS_H

#define HYBRID_BINS 32 /* most bins of an axis in the surface area heuristic */

/* Scalars of four bytes only: the same bytes on host and device. */
typedef struct stratus_hybrid_slot {
  int first;                      /* of the node's bricks in the order */
  int lo[3], hi[3];               /* tight box of its bricks, [lo, hi) in bricks */
  int from[3], to[3];             /* tight box of its voxels */
  int peak[3];                    /* its densest voxel */
  int axis;                       /* of planes and histograms */
  int plane[2];                   /* bricks below plane[0] go to the lower child; both are offered */
  int at;                         /* where the node's sums begin in their array */
  int whole;                      /* 1: the voxels of a brick are one mass at its middle */
  unsigned reach_low, reach_high; /* squared distances below reach count, in doubled coordinates */
} stratus_hybrid_slot;

/* Some of a node's bricks, which one work-group takes: order[first .. first + count - 1]. */
typedef struct stratus_hybrid_chunk {
  int slot, first, count;
  int below, above; /* where those below the plane and the others go in the new order */
} stratus_hybrid_chunk;

#endif
