/* SPDX-License-Identifier: BSD-3-Clause
 * Interface that the builders of sets of effective voxels share: the set from one mask for each brick, and rows of values to test or to
 * hash. */
#ifndef STRATUS_VOXELS_BUILD_H
#define STRATUS_VOXELS_BUILD_H

#include "threads.h"
#include "voxels.h"

/* End of an interval in the type in which values are compared: their own, or double for 64-bit integers, as everywhere else. */
typedef union stratus_bound {
  int64_t i; /* of integers of at most 32 bits */
  double d;  /* of all other types */
} stratus_bound;

typedef struct stratus_bounds {
  stratus_bound lo, hi;
} stratus_bounds;

/* A value is effective if it is in one of the intervals and is not hidden. */
typedef struct stratus_scan {
  const stratus_volume* volume;
  const stratus_bounds* intervals;
  int64_t count;
  const uint8_t* ghosts; /* one byte of flags for each value; NULL if there are none */
  uint8_t hidden;        /* flags that exclude a value */
} stratus_scan;

/* ---- voxels_device.c: gives the same bricks */
/* Returns whether the context's device makes the set: it builds, and can hold a layer of values and all masks. */
bool stratus_voxels_on_device(const stratus_context* context, const stratus_volume* volume, const stratus_voxels* voxels);
/* Sets brick_count and bricks of a set that is empty. The caller measures it. */
stratus_status stratus_device_voxels(stratus_context* context, const stratus_scan* scan, stratus_voxels* voxels);

/* ---- voxels.c */

/* Creates an empty set. It checks the dimensions: 1..2^18 along each axis. */
stratus_status stratus_voxels_create_empty(stratus_context* context, const int64_t dimensions[3], stratus_voxels** voxels);
/* Sets the matrix from voxel coordinates to the world, or fails if that has no inverse within doubles: rays need it, and saved trees. */
stratus_status stratus_voxels_place(stratus_voxels* voxels, const double index_to_world[16]);
/* Sets bricks, count and bounds from one mask for each of bricks_along[0]*[1]*[2] bricks, x fastest. */
stratus_status stratus_voxels_take_masks(stratus_voxels* voxels, const uint64_t* masks);
/* Sets each brick's count, and the total count and bounds, from bricks that have their places and masks. */
void stratus_voxels_measure(stratus_voxels* voxels);
/* Ends the stage that made the set. */
void stratus_voxels_end_stage(const stratus_voxels* voxels, const stratus_stage* stage);

#endif
