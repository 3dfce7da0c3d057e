/* SPDX-License-Identifier: BSD-3-Clause
 * What a picture of several volumes tells of each, besides its stratus_ray_cast_arguments: the same bytes on host and device. */
#ifndef STRATUS_RAY_SEVERAL_ARGUMENTS_H
#define STRATUS_RAY_SEVERAL_ARGUMENTS_H

typedef struct stratus_several_arguments {
  int stride;        /* segments of the lattice to one of its samples */
  int lit;           /* 1: it has light or gradient opacity */
  int preintegrated; /* 0: the midpoint rule */
  int unused;
} stratus_several_arguments;

#endif
