/* SPDX-License-Identifier: BSD-3-Clause
 * What a packet of rays through several volumes holds: of each volume what all rays read, and where its rays are.
 */
#ifndef STRATUS_SEVERAL_STATE_H
#define STRATUS_SEVERAL_STATE_H

#include "lighting.h"

/* A device compiles a kernel for as many volumes as there are. */
#ifndef SEVERAL_MOST
#define SEVERAL_MOST 8
#endif
#define SEVERAL_NEVER 0x7fffffff

/* Numbers of the lattice's segments from the eye on. */
#ifdef STRATUS_DEVICE
typedef long several_number_t;
#else
typedef int64_t several_number_t;
#endif
#define SEVERAL_FARTHEST 4e18f

#ifndef STRATUS_DEVICE
/* The field, or its gradient, at a position in a volume: RAY_NAME(ray_value) and RAY_NAME(ray_gradient) of its type of values. */
typedef void several_value(CONSTANT stratus_ray_cast_arguments* a, value_source values, GLOBAL const uchar* hidden, GLOBAL const int* grid,
  const vfloat x[3], vmask mask, vfloat* value);
typedef void several_gradient(
  CONSTANT stratus_ray_cast_arguments* a, value_source values, GLOBAL const int* grid, const vfloat x[3], vmask mask, vfloat g[3]);
#endif

/* What all rays read of a volume. */
typedef struct several_source {
  CONSTANT stratus_ray_cast_arguments* a;
  value_source values;
  GLOBAL const uchar *hidden, *map;
  GLOBAL const int* grid;
  /* Pre-integrated: running sums. Midpoint: for each entry its colour times optical depth, and optical depth, of a segment's length; and
   * with light or gradient opacity, what these read besides. */
  GLOBAL const void *table, *besides;
#ifndef STRATUS_DEVICE
  several_value* value;
  several_gradient* gradient;
#endif
  int stride;        /* segments of the lattice to a sample of this volume, at least 1 */
  int lit;           /* 1: it has light or gradient opacity */
  int preintegrated; /* 1: between the values at both ends of a sample's way; 0: by the value in its middle */
} several_source;

/* What a volume shows from `lo` to `hi` on each ray. Places are in segments from the one in which the ray enters the volume. */
typedef struct several_way {
  vfloat lo, hi, front, rise; /* the field goes from `front` at lo to `front` + `rise` at hi */
  vfloat rate[4];             /* colour times optical depth, and optical depth, of a segment's length */
  vfloat entries;             /* of the table, for each segment's length of the way */
  vmask stops;                /* rays that end at hi, in the colour `wall` */
  vfloat wall[3];
  stratus_lit_sample lighting; /* set where the volume has light or gradient opacity */
} several_way;

typedef struct several_volume {
  stratus_packet k; /* the rays as this volume has them */
  vint offset;      /* the packet's number of the segment in which a ray enters */
  int phase;        /* segments from the beginning of a sample's way to the packet's first */
  int next, run;    /* the segment at which a sample or a look-up is due; before `run` the structure need not be asked */
  int last;         /* the first segment behind all rays' ends */
  vfloat ahead;     /* pre-integrated: the value at the end of the way, which is the next one's front */
  vmask knows;      /* the rays that have it */
  several_way ways[2];
  int now;          /* which of them is the way that rays are on; the other is the coming one */
  int shows, comes; /* whether anything shows on these */
} several_volume;

/* The field, and its gradient, at x. A device has no pointers to functions, and one type of values for all volumes. */
INLINE vfloat several_value_at(const several_source* from, const vfloat x[3], vmask mask)
{
#ifdef STRATUS_DEVICE
  return RAY_NAME(ray_value)(from->a, from->values, from->hidden, from->grid, x, mask);
#else
  vfloat value;
  from->value(from->a, from->values, from->hidden, from->grid, x, mask, &value);
  return value;
#endif
}

INLINE void several_gradient_at(const several_source* from, const vfloat x[3], vmask mask, vfloat g[3])
{
#ifdef STRATUS_DEVICE
  RAY_NAME(ray_gradient)(from->a, from->values, from->grid, x, mask, g);
#else
  from->gradient(from->a, from->values, from->grid, x, mask, g);
#endif
}

/* The smallest number in the lanes of the mask. */
INLINE int several_least(vint a, vmask mask)
{
#if !defined(STRATUS_DEVICE) && STRATUS_ISA == 2
  return _mm512_mask_reduce_min_epi32(mask, (__m512i)a);
#else
  int lanes[STRATUS_WIDTH], least = SEVERAL_NEVER;
  vi_store(lanes, vi_select(mask, a, vi_set(SEVERAL_NEVER)));
  for (int lane = 0; lane < STRATUS_WIDTH; ++lane) {
    least = lanes[lane] < least ? lanes[lane] : least;
  }
  return least;
#endif
}

/* Where the way of the sample begins in which segment i is. */
INLINE int several_aligned(const several_source* from, const several_volume* v, int i)
{
  return i == SEVERAL_NEVER || from->stride == 1 ? i : i - (i + v->phase) % from->stride;
}

#endif
