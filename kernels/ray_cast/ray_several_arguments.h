/* SPDX-License-Identifier: BSD-3-Clause
 * What a picture of several volumes tells of each, besides its stratus_ray_cast_arguments: the same bytes on host and device. */
#ifndef STRATUS_RAY_SEVERAL_ARGUMENTS_H
#define STRATUS_RAY_SEVERAL_ARGUMENTS_H

/* How a volume's rays go: from sample to sample of the lattice, from cell to cell, or from cell to cell in rough blocks only. */
#define SEVERAL_BY_SAMPLES 0
#define SEVERAL_BY_CELLS 1
#define SEVERAL_LOCAL 2

/* What its samples are more than one value's colour and opacity by. */
#define SEVERAL_COMPONENTS 1
#define SEVERAL_LABELS 2
#define SEVERAL_FUNCTION_2D 3

typedef struct stratus_several_arguments {
  int stride;        /* segments of the lattice to one of its samples */
  int lit;           /* 1: it has light or gradient opacity */
  int preintegrated; /* 0: the midpoint rule */
  int media;         /* what its samples are more than one value's colour and opacity by; 0: nothing */
  float segment;     /* media: a segment's length in samples, of which its table is */
  int cells;         /* how its rays go: SEVERAL_BY_SAMPLES, SEVERAL_BY_CELLS, SEVERAL_LOCAL */
} stratus_several_arguments;

#endif
