/* SPDX-License-Identifier: BSD-3-Clause
 * Transforms that compute Chebyshev distances in a grid of blocks. distance_map.c chooses one. */
#ifndef STRATUS_DISTANCE_SWEEP_H
#define STRATUS_DISTANCE_SWEEP_H

#include "volume.h"

#define DISTANCE_MAX 127       /* a longer distance is stored as this */
#define DISTANCE_OCCUPIED 128  /* added to the inner distance of an occupied block */
#define DISTANCE_MAX_PAPER 255 /* the same in the paper's map, which knows no inner distances */

/* Distances of occupied blocks to the nearest empty block, within the box [lo, lo+n), which holds all occupied blocks. */
typedef struct distance_inner {
  int64_t lo[3], n[3];
  size_t pitch;
  uint8_t* bytes; /* n[2]*n[1] rows, pitch apart; 0 in empty blocks. NULL: no block is empty, and all distances are DISTANCE_MAX */
} distance_inner;

/* Fills map->bytes by O(n) sweeps, STRATUS_DISTANCE_FULL or STRATUS_DISTANCE_OCTANT. */
stratus_status stratus_distance_sweep(stratus_context* context, const stratus_occupancy* occupancy, stratus_distance_map* map);

/* Fills map->bytes by the paper's O(n D) transform: 0 in occupied blocks, elsewhere the distance, at most DISTANCE_MAX_PAPER. */
stratus_status stratus_distance_paper(stratus_context* context, const stratus_occupancy* occupancy, stratus_distance_map* map);

#endif
