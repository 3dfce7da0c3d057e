/* SPDX-License-Identifier: BSD-3-Clause
 * Shared by the methods that find first hits. This room finds hits and computes no colours. Core/frame/first_hit_shading.c computes the
 * colour of a hit. */
#ifndef STRATUS_FIRST_HIT_BATCH_H
#define STRATUS_FIRST_HIT_BATCH_H

#include "first_hit_arguments.h"
#include "instruction_set.h"
#include "tree.h"

/* Data that all rays of a batch need. In voxel coordinates voxel i is i .. i+1, so they are index coordinates + 1/2. */
typedef struct stratus_hit_batch {
  const stratus_tree* tree;
  double to_voxels[16]; /* rows of 4: world -> voxel coordinates */
  double lo[3], hi[3];  /* of the root's box */
  double normal[6][3];  /* of face 2*axis + upper, in world coordinates, of length 1 */
  float slack;          /* greatest error of a float position */
  bool leaves;          /* the tree is not one distance field */
} stratus_hit_batch;

void stratus_hit_batch_begin(const stratus_tree* tree, stratus_hit_batch* batch);
/* Return true if packets, beams or a device may walk the tree: a wide hierarchy; or one distance field, or siblings separated by planes, if
 * the tree's distances are not uncorrected floodings and float positions are off by at most 0.05 voxels. */
bool stratus_hit_takes_packets(const stratus_hit_batch* batch);
/* Return the kernels' arguments for a tree that packets may walk; `count` is 0. */
stratus_hit_arguments stratus_hit_arguments_of(const stratus_hit_batch* batch);

#define STRATUS_HIT_CHUNK 512 /* rays that a thread takes at once: their state fits the second-level cache */

/* A chunk's `count` rays in the form that traversal takes. end < 0: the ray misses the root's box. */
typedef struct stratus_hit_chunk {
  int count;
  const stratus_ray* rays;
  const stratus_ray* ahead; /* the next chunk's rays, prefetched while this chunk is walked */
  int more;                 /* their number */
  const stratus_hit* hits;  /* where this chunk's hits will be stored */
  float o[3][STRATUS_HIT_CHUNK], d[3][STRATUS_HIT_CHUNK], inverse[3][STRATUS_HIT_CHUNK], end[STRATUS_HIT_CHUNK];
  int cell[3][STRATUS_HIT_CHUNK];
  int state[STRATUS_HIT_CHUNK], visited[STRATUS_HIT_CHUNK]; /* out: STRATUS_HIT_*, steps; `cell` is then the voxel */
} stratus_hit_chunk;

/* Prefetch some of the next chunk's rays and of this chunk's hits, with numbers `from` up to `to`. Returns the next number. A walk calls it
 * at each step. Without it each chunk would begin and end by waiting for memory. */
static inline int stratus_hit_fetch(const stratus_hit_chunk* chunk, int from, int to)
{
  const int few = from + 4 < to ? from + 4 : to;
  for (; from < few; ++from) {
    if (from < chunk->more) {
      __builtin_prefetch(chunk->ahead + from);
    }
    __builtin_prefetch(chunk->hits + from, 1);
  }
  return from;
}

/* first_hit_isa.c, for each instruction set. prepare converts rays to a chunk and returns false if ray *bad is unusable. walk traverses the
 * tree. finish converts the chunk to hits. */
typedef bool stratus_hit_prepare(const stratus_hit_batch* batch, const stratus_ray* rays, int count, stratus_hit_chunk* chunk, int* bad);
typedef void stratus_hit_walk(const stratus_hit_batch* batch, stratus_hit_chunk* chunk);
typedef void stratus_hit_finish(const stratus_hit_batch* batch, const stratus_ray* rays, const stratus_hit_chunk* chunk, stratus_hit* hits);

typedef struct stratus_hit_functions {
  stratus_hit_prepare* prepare;
  stratus_hit_walk* walk;
  stratus_hit_finish* finish;
} stratus_hit_functions;
const stratus_hit_functions* stratus_hit_functions_for(const stratus_context* context); /* first_hit_functions.c */
extern const stratus_hit_functions stratus_hit_functions_isa0, stratus_hit_functions_isa1, stratus_hit_functions_isa2;

/* first_hit_exact.c: find the hit of one ray in any tree, in double precision. The voxel and the bits of t equal voxel_walk.c's. */
void stratus_first_hit_exact(const stratus_hit_batch* batch, const stratus_ray* ray, stratus_hit* hit);
/* Computes the hit of a known voxel; t is INFINITY if the ray misses it or meets it outside t_min..t_max. */
void stratus_hit_of_voxel(const stratus_hit_batch* batch, const stratus_ray* ray, const int voxel[3], stratus_hit* hit);

/* first_hit_device.c: finds the hits of a batch on the context's device. */
stratus_status stratus_first_hit_device(
  stratus_context* context, const stratus_tree* tree, const stratus_ray* rays, size_t count, stratus_hit* hits);

#endif
