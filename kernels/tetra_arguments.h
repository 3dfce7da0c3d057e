/* SPDX-License-Identifier: BSD-3-Clause
 * What one frame tells every ray through tetrahedra: scalars of four bytes only, the same on host and device. The line of a ray is x = y = 0 in
 * coordinates of its own, x = a - u w, y = b - v w, where a point lies at eye + a right + b up + c forward and w is c (parallel: 1): a shear, so
 * that points behind the eye are like others. z is c from the mesh's middle, scaled to about 1, as a, b and w are in perspective. */
#ifndef STRATUS_TETRA_ARGUMENTS_H
#define STRATUS_TETRA_ARGUMENTS_H

#include "ray_cast_arguments.h"

/* Pixels of a tile's edge. */
#define TETRA_TILE 16

typedef struct stratus_tetra_arguments {
  stratus_ray_cast_arguments table; /* of it only what shading reads: table, termination, depth; `lo` of shading is world distance */
  float middle; /* w where z is 0 */
  float shear;  /* dw/dz: 1, parallel 0 */
  int stride;   /* ints of a cell: neighbour opposite its lowest point .. highest, exclusive or of its points, its value if cell_values */
  int cell_values;
  int maximum;
  int steps_most; /* cells that one way can pass */
} stratus_tetra_arguments;

#endif
