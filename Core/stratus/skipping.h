/* SPDX-License-Identifier: BSD-3-Clause
 * Structures that let a ray skip empty space: value ranges of blocks, occupancy, distance maps. */
#ifndef STRATUS_PUBLIC_SKIPPING_H
#define STRATUS_PUBLIC_SKIPPING_H

#include "volume.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Block b of size B (a power of two) owns the cells [b B, (b+1) B) along each axis. Its range covers voxels b B .. (b+1) B, and so includes
 * the halo that interpolation reads. Built structures are immutable. */

typedef struct stratus_value_range stratus_value_range;

/* Finds the value range of each block. block_size: 2, 4, 8, 16 or 32; 0: the default, 4. */
STRATUS_EXPERIMENTAL stratus_status stratus_value_range_create(
  stratus_context* context, const stratus_volume* volume, int block_size, stratus_value_range** ranges);
STRATUS_EXPERIMENTAL void stratus_value_range_destroy(stratus_value_range* ranges);
/* Gives the number of blocks along each axis, and their size. Either pointer may be NULL. */
STRATUS_EXPERIMENTAL void stratus_value_range_blocks(const stratus_value_range* ranges, int64_t blocks[3], int* block_size);
/* Gives the range of the whole volume's finite values. STRATUS_INVALID_ARGUMENT if there are none. */
STRATUS_EXPERIMENTAL stratus_status stratus_value_range_whole(const stratus_value_range* ranges, double* low, double* high);
/* Gives the range of one block's finite values; low > high if it has none, or if there is no such block. *gaps is 1 if some value in the
 * block is not finite or hidden. */
STRATUS_EXPERIMENTAL void stratus_value_range_block(
  const stratus_value_range* ranges, int64_t i, int64_t j, int64_t k, double* low, double* high, int* gaps);

typedef enum stratus_sampling {
  STRATUS_SAMPLING_AUTO,
  STRATUS_SAMPLING_MIDPOINT, /* one value in the middle of each segment */
  /* The transfer function is integrated between the values at a segment's ends (Engel, Kraus & Ertl 2001), from cumulative tables. A
   * segment of high optical depth is cut into pieces where its colour changes. */
  STRATUS_SAMPLING_PREINTEGRATED,
  /* Pictures of volumes, composite. Rays pass from cell to cell. The way through a cell, where the field along the ray is a cubic, is cut
   * into pieces that are nearly straight, and each is pre-integrated. With nearest interpolation the cells are the boxes about the values,
   * so that the picture is exact. */
  STRATUS_SAMPLING_CELLS,
  /* What an automatic rule may take, and what cannot be asked for: CELLS in the blocks of 4^3 voxels where the transfer function changes
   * much, MIDPOINT in all others. The tolerance decides where that is. */
  STRATUS_SAMPLING_LOCAL
} stratus_sampling;

typedef struct stratus_occupancy stratus_occupancy;

/* Marks the occupied blocks: those where the transfer function shows anything over the hull of the block's range, exactly. Types of more
 * than 24 bits are compared as the floats that stand for them. Unless sampling is MIDPOINT, a block with gaps counts if anything shows in
 * the volume at all. */
STRATUS_EXPERIMENTAL stratus_status stratus_occupancy_create(stratus_context* context, const stratus_value_range* ranges,
  const stratus_transfer* transfer, stratus_sampling sampling, stratus_occupancy** occupancy);
/* Marks the blocks whose range meets lower..upper, ends included, lower <= upper, infinities allowed. The comparison is exact. Types of
 * more than 24 bits are compared as the floats that stand for them, and lower and upper are rounded in the same way: such a float counts if
 * any value that it may stand for does. */
STRATUS_EXPERIMENTAL stratus_status stratus_occupancy_create_between(
  stratus_context* context, const stratus_value_range* ranges, double lower, double upper, stratus_occupancy** occupancy);
STRATUS_EXPERIMENTAL void stratus_occupancy_destroy(stratus_occupancy* occupancy);
STRATUS_EXPERIMENTAL void stratus_occupancy_blocks(const stratus_occupancy* occupancy, int64_t blocks[3], int* block_size);
STRATUS_EXPERIMENTAL int64_t stratus_occupancy_count(const stratus_occupancy* occupancy); /* number of occupied blocks */
/* Returns 1 if the block is occupied; 0 if it is empty, and beyond the blocks. */
STRATUS_EXPERIMENTAL int stratus_occupancy_get(const stratus_occupancy* occupancy, int64_t i, int64_t j, int64_t k);
/* Gives the smallest box of occupied blocks, [lo, hi) in blocks; lo = hi = 0 if no block is occupied. */
STRATUS_EXPERIMENTAL void stratus_occupancy_bounds(const stratus_occupancy* occupancy, int64_t lo[3], int64_t hi[3]);

typedef enum stratus_distance_kind {
  STRATUS_DISTANCE_BLOCK, /* 1 in every empty block: rays skip one block at a time */
  STRATUS_DISTANCE_FULL,  /* Chebyshev distance to the nearest occupied block (Deakin & Knackstedt 2019), O(n) sweeps */
  STRATUS_DISTANCE_PAPER, /* the same by the paper's O(n D) transform, with the paper's limit of 255: the baseline */
  STRATUS_DISTANCE_OCTANT /* eight maps: distance to the nearest occupied block among those that a ray of that octant can reach */
} stratus_distance_kind;

typedef struct stratus_distance_map stratus_distance_map;

/* Makes a distance map. The occupancy is read during the call only. */
STRATUS_EXPERIMENTAL stratus_status stratus_distance_map_create(
  stratus_context* context, const stratus_occupancy* occupancy, stratus_distance_kind kind, stratus_distance_map** map);
STRATUS_EXPERIMENTAL void stratus_distance_map_destroy(stratus_distance_map* map);
/* Returns the distance in blocks from block (i,j,k): 0 in an occupied block, at most 127, in STRATUS_DISTANCE_PAPER 255 (a
 * longer distance is given as this), 0 beyond the blocks. octant: 0..7, where bit a is set if the ray moves towards + on axis a; only
 * STRATUS_DISTANCE_OCTANT uses it. */
STRATUS_EXPERIMENTAL int stratus_distance_map_get(const stratus_distance_map* map, int octant, int64_t i, int64_t j, int64_t k);
STRATUS_EXPERIMENTAL size_t stratus_distance_map_bytes(const stratus_distance_map* map);

STRATUS_EXPERIMENTAL const char* stratus_sampling_name(stratus_sampling sampling);

#ifdef __cplusplus
}
#endif

#endif
