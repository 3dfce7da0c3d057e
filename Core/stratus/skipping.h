/* SPDX-License-Identifier: BSD-3-Clause
 * Structures that let a ray skip empty space: value ranges of blocks, occupancy, distance maps. */
#ifndef STRATUS_PUBLIC_SKIPPING_H
#define STRATUS_PUBLIC_SKIPPING_H

#include "volume.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Block b of size B (a power of two) owns the cells [b B, (b+1) B) along each axis. Its range covers voxels b B .. (b+1) B, and so includes
 * the halo that interpolation reads. Structures do not change once they are built. */

typedef struct stratus_value_range stratus_value_range;

/* Find the value range of each block. block_size: 2, 4, 8, 16 or 32 voxels; 0: the default, 4, or larger
 * for a volume of more than 2^31 values. Another size gives
 * STRATUS_INVALID_ARGUMENT. */
STRATUS_EXPERIMENTAL stratus_status stratus_value_range_create(
  stratus_context* context, const stratus_volume* volume, int block_size, stratus_value_range** ranges);
STRATUS_EXPERIMENTAL void stratus_value_range_destroy(stratus_value_range* ranges);
/* Get the number of blocks along each axis, and their size in voxels. Either pointer may be NULL. */
STRATUS_EXPERIMENTAL void stratus_value_range_blocks(const stratus_value_range* ranges, int64_t blocks[3], int* block_size);
/* Get the range of the whole volume's finite values. STRATUS_INVALID_ARGUMENT if there are none. */
STRATUS_EXPERIMENTAL stratus_status stratus_value_range_whole(const stratus_value_range* ranges, double* low, double* high);
/* Get the range of one block's finite values; low > high if it has none, or if there is no such block. *gaps is 1 if some value in the
 * block is not finite or is hidden. */
STRATUS_EXPERIMENTAL void stratus_value_range_block(
  const stratus_value_range* ranges, int64_t i, int64_t j, int64_t k, double* low, double* high, int* gaps);

typedef enum stratus_sampling {
  /* The cheapest rule that keeps the tolerance. */
  STRATUS_SAMPLING_AUTO,
  STRATUS_SAMPLING_MIDPOINT, /* one value in the middle of each segment */
  /* The transfer function is integrated between the values at a segment's ends (Engel, Kraus & Ertl 2001), from cumulative tables. A
   * segment of high optical depth is cut into pieces where its colour changes. */
  STRATUS_SAMPLING_PREINTEGRATED,
  /* Images of volumes, mode composite. Rays pass from cell to cell. Along a ray through a cell the field is a cubic. The ray's path through
   * the cell is cut into pieces that are nearly straight, and each piece is pre-integrated. With nearest interpolation the cells are the
   * boxes about the values, so that the image is exact. */
  STRATUS_SAMPLING_CELLS,
  /* CELLS in the blocks of 4^3 voxels where the transfer function changes much, MIDPOINT in all others. The tolerance decides which blocks
   * those are. Only an automatic rule may choose LOCAL; requesting it gives STRATUS_INVALID_ARGUMENT. */
  STRATUS_SAMPLING_LOCAL
} stratus_sampling;

typedef struct stratus_occupancy stratus_occupancy;

/* Mark the occupied blocks: the blocks where the transfer function shows anything over the hull of the block's range. The test is exact.
 * Types of more than 24 bits are compared as the floats that represent them. Unless sampling is MIDPOINT, a block with gaps is occupied if
 * anything shows in the volume at all. */
STRATUS_EXPERIMENTAL stratus_status stratus_occupancy_create(stratus_context* context, const stratus_value_range* ranges,
  const stratus_transfer* transfer, stratus_sampling sampling, stratus_occupancy** occupancy);
/* Mark the blocks whose range meets lower..upper, ends included; lower <= upper, infinities allowed. The comparison is exact. Types of more
 * than 24 bits are compared as the floats that represent them, and lower and upper are rounded in the same way: such a float counts if any
 * value that it may represent does. */
STRATUS_EXPERIMENTAL stratus_status stratus_occupancy_create_between(
  stratus_context* context, const stratus_value_range* ranges, double lower, double upper, stratus_occupancy** occupancy);
STRATUS_EXPERIMENTAL void stratus_occupancy_destroy(stratus_occupancy* occupancy);
/* Get the number of blocks along each axis, and their size in voxels. Either pointer may be NULL. */
STRATUS_EXPERIMENTAL void stratus_occupancy_blocks(const stratus_occupancy* occupancy, int64_t blocks[3], int* block_size);
STRATUS_EXPERIMENTAL int64_t stratus_occupancy_count(const stratus_occupancy* occupancy); /* the number of occupied blocks */
/* Return 1 if the block is occupied; 0 if it is empty or does not exist. */
STRATUS_EXPERIMENTAL int stratus_occupancy_get(const stratus_occupancy* occupancy, int64_t i, int64_t j, int64_t k);
/* Get the smallest box of occupied blocks, [lo, hi) in blocks; lo = hi = 0 if no block is occupied. */
STRATUS_EXPERIMENTAL void stratus_occupancy_bounds(const stratus_occupancy* occupancy, int64_t lo[3], int64_t hi[3]);

typedef enum stratus_distance_kind {
  STRATUS_DISTANCE_BLOCK, /* 1 in every empty block: rays skip one block at a time */
  STRATUS_DISTANCE_FULL,  /* Chebyshev distance to the nearest occupied block (Deakin & Knackstedt 2019), O(n) sweeps */
  STRATUS_DISTANCE_PAPER, /* the same distance by the paper's O(n D) transform, with the paper's limit of 255: the baseline */
  STRATUS_DISTANCE_OCTANT /* eight maps: distance to the nearest occupied block among those that a ray of that octant can reach */
} stratus_distance_kind;

typedef struct stratus_distance_map stratus_distance_map;

/* Create a distance map. The occupancy is read during the call only. */
STRATUS_EXPERIMENTAL stratus_status stratus_distance_map_create(
  stratus_context* context, const stratus_occupancy* occupancy, stratus_distance_kind kind, stratus_distance_map** map);
STRATUS_EXPERIMENTAL void stratus_distance_map_destroy(stratus_distance_map* map);
/* Return the distance in blocks from block (i,j,k): 0 in an occupied block and beyond the blocks. A distance above 127 is given as 127, in
 * STRATUS_DISTANCE_PAPER above 255 as 255. octant: 0..7, where bit a is set if the ray moves towards + on axis a; only
 * STRATUS_DISTANCE_OCTANT uses it. */
STRATUS_EXPERIMENTAL int stratus_distance_map_get(const stratus_distance_map* map, int octant, int64_t i, int64_t j, int64_t k);
/* Return the size of the map in bytes. */
STRATUS_EXPERIMENTAL size_t stratus_distance_map_bytes(const stratus_distance_map* map);

/* Return a rule's name: "auto", "midpoint", "pre-integrated", "cells" or "local"; "unknown" for other numbers. */
STRATUS_EXPERIMENTAL const char* stratus_sampling_name(stratus_sampling sampling);

#ifdef __cplusplus
}
#endif

#endif
