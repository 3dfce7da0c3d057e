/* SPDX-License-Identifier: BSD-3-Clause
 * Rays that stand for all pictures of a volume: where they go, and how much each counts. */
#ifndef STRATUS_RAY_PROBE_RAYS_H
#define STRATUS_RAY_PROBE_RAYS_H

#include "ray_caster.h"

/* Rays go in patches of parallel rays. A patch is a picture of its own. */
#define STRATUS_PROBE_WIDTH 4
#define STRATUS_PROBE_HEIGHT 4
#define STRATUS_PROBE_PATCHES 40

typedef struct stratus_probe_patch {
  stratus_camera camera;
  double weight; /* of each of its rays */
} stratus_probe_patch;

/* Classes of blocks by how much the transfer functions change over their values: class c holds variations of 4^-c to 4^(1-c), the last
 * one all smaller ones. */
#define STRATUS_PROBE_CLASSES 6

typedef struct stratus_probe_classes {
  int64_t blocks[3];
  int block_size;
  uint8_t* of; /* class of each block, STRATUS_PROBE_CLASSES where it is empty; the caller releases it */
  int64_t count[STRATUS_PROBE_CLASSES];
  double depth[STRATUS_PROBE_CLASSES]; /* the greatest optical depth of a voxel's length at the least values of a class's blocks */
  double deepest;                      /* the same of all values of the volume */
} stratus_probe_classes;

/* Make patches through occupied blocks, in directions spread over the sphere. Blocks are drawn by classes of how much the transfer
 * functions change over their values, so that a small rough part of a large smooth volume is met, too. A patch weighs the inverse of the
 * density of rays at its place, so that weighted sums over the rays represent sums over images. The blocks are 4^3 voxels whatever size the
 * user set, so that a structure decides nothing. *count: 0 if no block is occupied, and then there are no classes. */
stratus_status stratus_ray_probe_rays(
  stratus_ray_caster* caster, stratus_probe_patch patches[STRATUS_PROBE_PATCHES], int* count, stratus_probe_classes* classes);

/* Adds up, over the cells of all occupied blocks, how much the transfer functions change within a cell's block, to the nearest class. Both
 * are 0 if no block is occupied. Needs value ranges, transfer functions and occupancy. */
stratus_status stratus_ray_probe_changes(const stratus_ray_caster* caster, double* changes, double* cells);

#endif
