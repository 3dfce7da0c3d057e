/* SPDX-License-Identifier: BSD-3-Clause
 * The arguments of each volume in an image of several, in addition to its stratus_ray_cast_arguments: the same bytes on host and device. */
#ifndef STRATUS_RAY_SEVERAL_ARGUMENTS_H
#define STRATUS_RAY_SEVERAL_ARGUMENTS_H

#include "real.h"

/* How a volume's rays go: from sample to sample of the lattice, from cell to cell, or from cell to cell in rough blocks only. */
#define SEVERAL_BY_SAMPLES 0
#define SEVERAL_BY_CELLS 1
#define SEVERAL_LOCAL 2

/* Kinds of samples that are more than one value's colour and opacity. */
#define SEVERAL_COMPONENTS 1
#define SEVERAL_LABELS 2
#define SEVERAL_FUNCTION_2D 3

/* Where a mesh's rays are: z is at k = middle + per_z z - lean[0] u - lean[1] v of the camera. */
typedef struct stratus_several_places {
  stratus_pair middle, per_z, lean[2];
} stratus_several_places;

typedef struct stratus_several_arguments {
  int stride;        /* segments of the lattice to one of its samples */
  int lit;           /* 1: it has light or gradient opacity, or is a mesh of several components */
  int preintegrated; /* 0: the midpoint rule */
  int media;         /* SEVERAL_COMPONENTS, SEVERAL_LABELS or SEVERAL_FUNCTION_2D; 0: each sample is one value's colour and opacity */
  float segment;     /* media: a segment's length in samples, for which its table is made */
  int cells;         /* SEVERAL_BY_SAMPLES, SEVERAL_BY_CELLS or SEVERAL_LOCAL */
  int mesh;          /* 1: a mesh of tetrahedra */
  stratus_several_places places; /* of a mesh */
} stratus_several_arguments;

#endif
