/* SPDX-License-Identifier: BSD-3-Clause
 * What one frame tells every ray through tetrahedra: scalars of four bytes only, the same on host and device. The line of a ray is x = y
 * = 0 in coordinates of its own, x = a - u w, y = b - v w, where a point lies at eye + a right + b up + c forward and w is c (parallel:
 * 1): a shear, so that points behind the eye are like others. Parallel: right and up less what of them is along forward, which is added to
 * where rays begin and end. z is c from the mesh's middle, scaled to about 1, as a, b and w are in perspective. */
#ifndef STRATUS_TETRA_ARGUMENTS_H
#define STRATUS_TETRA_ARGUMENTS_H

#include "picture_arguments.h"
#include "table_arguments.h"

/* Pixels of a tile's edge. */
#define TETRA_TILE 16
#define TETRA_TILE_LOG2 4
/* Lines of rays beyond the picture, so that packets may read past it. */
#define TETRA_PADDING 32
/* Ints of a cell, and of a border face: its three points, the fourth of its cell, the cell, columns and rows of pixels that it may cover
 * (first, and last << 16), whether those are not known. */
#define TETRA_CELL 8
#define TETRA_FACE 8

typedef struct stratus_tetra_arguments {
  stratus_picture_arguments picture;
  stratus_table_arguments table;
  float termination; /* of transparency: 1 - alpha */
  float middle;      /* w where z is 0 */
  float shear;       /* dw/dz: 1, parallel 0 */
  float begin, end;  /* what is seen, in z, of the ray through the window's middle */
  float lean[2];     /* parallel: by how much z of one k rises over u and v; else 0 */
  float square[6];   /* of a ray's length a unit of c: [0] + u [1] + v [2] + u u [3] + u v [4] + v v [5], over the square of `forward`'s */
  float per_z, per_frame; /* world lengths of one z and of the middle's c along `forward` */
  int columns;            /* of tiles */
  int cell_values;
  int maximum;
  int steps_most; /* cells that one way can pass */
  int has_ends;   /* pixels have ends of their own: what is opaque */
} stratus_tetra_arguments;

#endif
