/* SPDX-License-Identifier: BSD-3-Clause
 * The arguments of one frame that every ray through tetrahedra reads: scalars of four bytes only, the same bytes on host and device.
 *
 * A point is at eye + a right + b up + c forward. A ray has coordinates of its own, x = a - u w and y = b - v w with w = c (parallel: w =
 * 1), in which it is the line x = y = 0. They are a shear of space, so that points behind the eye are like all others. z is c measured from
 * the mesh's middle and scaled to about 1; in perspective a, b and w have the same scale. A parallel camera's right and up may lean along
 * forward: that part is removed from them, and added to where rays begin and end. */
#ifndef STRATUS_TETRA_ARGUMENTS_H
#define STRATUS_TETRA_ARGUMENTS_H

#include "light_arguments.h"
#include "picture_arguments.h"
#include "slice_arguments.h"
#include "table_arguments.h"

/* 1: the variant whose light and opacity depend on the gradient. */
#ifndef TETRA_LIT
#define TETRA_LIT 0
#endif
/* Pixels along a tile's edge. */
#define TETRA_TILE 16
#define TETRA_TILE_LOG2 4
/* Columns and rows of rays that are stored beyond the picture, so that packets may read past its edge. */
#define TETRA_PADDING 32
/* Ints of a cell, and of a border face. A border face has: its three points; the fourth point of its cell; the cell; the columns and the
 * rows of pixels that it may cover (first | last << 16); 1 if those are not known. */
#define TETRA_CELL 8
#define TETRA_FACE 8
/* How a ray combines its cells. */
#define TETRA_LIGHT 0      /* light behind light */
#define TETRA_EXTREMES 1   /* the largest or smallest value */
#define TETRA_ADD 2        /* the mean or the sum of values */
#define TETRA_SURFACES 3   /* surfaces of contour values, light behind light */
#define TETRA_SLICE 4      /* the values on a surface of the world, light behind light */
#define TETRA_HITS 5       /* the first cell that shows anything: its points, of which the host makes a picture */
#define TETRA_QUANTITIES 6 /* the field's integral, length, largest value and number of cells */
#define TETRA_STRETCHES 7  /* none: rays hand out what they see of cells, among several volumes */
/* Added to the numbers that a hit stores, so that they are the bits of floats between 0 and 1. */
#define TETRA_HIT_NAME 0x10000000
/* Ints of a label's record, which are before the labels' sums: where its sums begin, laid out as stratus_tetra_sums(); the bits of the
 * floats tau_scale and factor_scale; which set of gradient opacities it has. */
#define TETRA_LABEL 4
#define TETRA_PLANES 12 /* of clip planes and the sides of a box */
#define TETRA_CONTOURS 16

/* A bit says of each hexahedron whether it shows. */
#define TETRA_LATTICE 1
/* A byte says so by TETRA_TURNS_SHOWN, and by the bit TETRA_TURN() of each of its tetrahedra whether that turns left. A tetrahedron's
 * points in rising order are a hexahedron's first corner and then one step d along each axis; steps along x are the smallest, along z the
 * largest. */
#define TETRA_LATTICE_TURNS 2
#define TETRA_TURNS_SHOWN 4
#define TETRA_TURN(d0, d1, d2) (((d0) < (d1)) + 2 * ((d0) < (d2)) + 4 * ((d1) < (d2))) /* 0, 1, 3, 4, 6, 7 */

/* Values of several components: each has a table of its own, of which points know the places. */
typedef struct stratus_tetra_media_arguments {
  int components;                /* 0: one, and the rest means nothing, except `labels` */
  int labels;                    /* 1: a cell's label chooses its function, of tables as the frame's */
  int dependent;                 /* 1: the last has the opacity, and the others the colour: a value of a table, or red, green and blue */
  int mean;                      /* 1: independent components count by their share of the optical depth */
  int sums_at[4];                /* where a component's sums begin, laid out as stratus_tetra_sums() */
  float last[4], depth_scale[4]; /* its last entry; the optical depth of a unit of its sums over a unit of length */
  int has_opaque[4];
  float weight[4];     /* of a component; depth_scale has it in it */
  float way_scale[4];  /* the optical depth of a unit of its sums over factor_way, whatever the weight */
  int gradients_at[4]; /* which of the sets of gradients is its own; -1: neither light nor opacity depends on it */
  int points;          /* gradients in a set */
  /* Sums of dependent components: the first one's value as a part of its range is place * grey[0] + grey[1], and counts from counted[0] to
   * counted[1]. */
  float grey[2], counted[2];
} stratus_tetra_media_arguments;

typedef struct stratus_tetra_arguments {
  stratus_picture_arguments picture;
  stratus_table_arguments table;
  float termination; /* of transparency: 1 - alpha */
  float pieces;      /* the square of the number of pieces of a stretch of optical depth 1 over which a colour changes by 1 */
  float middle;      /* w where z is 0 */
  float shear;       /* dw/dz: 1, parallel 0 */
  float begin, end;  /* the part that is seen, in z, of the ray through the window's middle */
  float lean[2];     /* parallel: by how much a ray's ends rise, in z, over u and over v; else 0 */
  float square[6];   /* the squared length of a unit of c along a ray, over the square of the length of `forward`: [0] + u [1] + v [2] + u u
                        [3] + u v [4] + v v   [5] */
  float per_z, per_frame; /* world lengths along `forward` of a unit of z, and of the middle's c */
  int columns;            /* of tiles */
  int cell_values;
  int lattice; /* TETRA_LATTICE...: cells of a lattice, whose neighbours follow from the names of their points; 0: listed cells */
  int mode;
  float sign; /* extremes: 1, or -1 for the smallest value */
  float grey; /* sums: factor of the sum; 0: it is divided by the length over which values count */
  /* > 0: marched extremes and sums store what a ray has kept in place of its colour, as kernels/integrator/ray_modes.h says, but no blue; a
   * factor of sums. Isosurfaces and slices store only this one of a ray's surfaces, the nearest is 1. */
  float kept;
  int contour_count[4];
  float contour[4][TETRA_CONTOURS][5]; /* of each independent component, sorted by value: value, colour times opacity, opacity */
  stratus_slice_arguments slice;       /* in (a, b, z) */
  int plane_count;
  float plane[TETRA_PLANES][6]; /* a ray is seen where [0] + u [1] + v [2] + ([3] + u [4] + v [5]) z >= 0 */
  int regions;                  /* not 0: which crop regions show, of those between these planes */
  float crop[3][2][6];          /* along each axis of the mesh, the lower and the upper plane, as `plane` has them */
  /* > 0: rays that gather light or surfaces store so many pictures, one after the other, each of a part of the same depth of begin..end;
   * only pixels that show something are stored */
  int layers;
  float layer_depth;                   /* of such a part, in z */
  int steps_most;                      /* the most cells that a ray can pass from one border face to the next */
  int has_ends;                        /* 1: rays end at opaque geometry, each pixel at a depth of its own */
  stratus_tetra_media_arguments media; /* of the variant TETRA_LIT, as all that follows */
  stratus_light_arguments light;       /* of the variant TETRA_LIT, as all that follows; places are (a, b, z) */
  float bend[2]; /* by how much light changes at most where a normal turns by an angle, and how much it bends by the angle's square */
  int thins;     /* bit c: component c has a gradient opacity; of one component bit 0 */
  float factor_scale[4], factor_last; /* from gradients to steps of each component's gradient opacity, and the last step of all */
  /* > 0: gradient opacities multiply the opacity of a segment of this world length; 0: the optical depth */
  float factor_way;
} stratus_tetra_arguments;

#endif
