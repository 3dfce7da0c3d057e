/* SPDX-License-Identifier: BSD-3-Clause
 * What the ways to a first hit share. */
#ifndef STRATUS_FIRST_HIT_LAYER_H
#define STRATUS_FIRST_HIT_LAYER_H

#include "instruction_set.h"
#include "tree.h"

/* What all rays of a batch need. Voxel coordinates: voxel i is i .. i+1, so they are index coordinates + 1/2. */
typedef struct stratus_hit_batch {
  const stratus_tree* tree;
  double to_voxels[16];      /* rows of 4: world -> voxel coordinates */
  double lo[3], hi[3];       /* of the root's box */
  double normal[6][3];       /* of face 2*axis + upper, world, of length 1 */
  float slack;               /* how far a float position may be off */
  const int32_t* mask_words; /* tree->masks as the kernel reads them */
} stratus_hit_batch;

void stratus_hit_batch_begin(const stratus_tree* tree, stratus_hit_batch* batch);

#define STRATUS_HIT_CHUNK 512 /* rays that a thread takes at once: their state stays in the second cache */

/* A chunk's rays as traversal takes them, `count` of them. end < 0: it misses the root's box. */
typedef struct stratus_hit_chunk {
  int count;
  const char* ahead;  /* memory of the next chunk's rays, .. */
  size_t ahead_bytes; /* .. asked for while this chunk is walked */
  float o[3][STRATUS_HIT_CHUNK], d[3][STRATUS_HIT_CHUNK], inverse[3][STRATUS_HIT_CHUNK], end[STRATUS_HIT_CHUNK];
  int cell[3][STRATUS_HIT_CHUNK];
  int state[STRATUS_HIT_CHUNK], visited[STRATUS_HIT_CHUNK];       /* out: STRATUS_HIT_*, steps; cell: the voxel */
  double from[3][STRATUS_HIT_CHUNK], along[3][STRATUS_HIT_CHUNK]; /* the ray in voxel coordinates */
} stratus_hit_chunk;

/* first_hit_isa.c, for each instruction set. rays -> chunk, false if ray *bad can't be used; one distance field; chunk -> hits. */
typedef bool stratus_hit_prepare(const stratus_hit_batch* batch, const stratus_ray* rays, int count, stratus_hit_chunk* chunk, int* bad);
typedef void stratus_hit_walk(const stratus_hit_batch* batch, stratus_hit_chunk* chunk);
typedef void stratus_hit_finish(const stratus_hit_batch* batch, const stratus_ray* rays, const stratus_hit_chunk* chunk, stratus_hit* hits);

typedef struct stratus_hit_functions {
  stratus_hit_prepare* prepare;
  stratus_hit_walk* walk;
  stratus_hit_finish* finish;
} stratus_hit_functions;
const stratus_hit_functions* stratus_hit_functions_for(const stratus_context* context); /* first_hit_batch.c */
extern const stratus_hit_functions stratus_hit_functions_isa0, stratus_hit_functions_isa1, stratus_hit_functions_isa2;

/* first_hit_exact.c: any tree, one ray, double precision: the voxel that the plain walk finds, to the bit of t. */
void stratus_first_hit_exact(const stratus_hit_batch* batch, const stratus_ray* ray, stratus_hit* hit);
/* The hit of a known voxel; t INFINITY if the ray misses it or meets it outside t_min..t_max. from, along: the ray in voxel coordinates. */
void stratus_hit_of_voxel(const stratus_hit_batch* batch, const stratus_ray* ray, const double from[3], const double along[3],
  const int voxel[3], stratus_hit* hit);

/* first_hit_device.c: walks all rays of a batch on the context's device; chunks as above, count/STRATUS_HIT_CHUNK of them rounded up. */
stratus_status stratus_first_hit_device(
  stratus_context* context, const stratus_tree* tree, const stratus_ray* rays, size_t count, stratus_hit* hits);

#endif
