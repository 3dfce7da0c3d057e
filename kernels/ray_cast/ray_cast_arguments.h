/* SPDX-License-Identifier: BSD-3-Clause
 * What one frame tells every ray, the same bytes on host and device: scalars of four bytes only. Positions are index coordinates,
 * lengths along a ray are in samples (sample distances) unless they say otherwise. */
#ifndef STRATUS_RAY_CAST_ARGUMENTS_H
#define STRATUS_RAY_CAST_ARGUMENTS_H

#include "picture_arguments.h"
#include "real.h"
#include "table_arguments.h"

#define STRATUS_CLIP_MAX 6

/* has_hidden: what the hidden bytes hold: a mask, a byte a value, 0 where it takes the value out; then a byte a cell, 1 where that is
 * hidden. */
#define HIDDEN_CELLS 1
#define HIDDEN_BY_MASK 2
#define HIDDEN_LABELS 4 /* the mask's bytes are labels, and hide nothing */

#define STRATUS_CONTOURS_MAX 16

/* What a ray makes of its samples: light behind light; the largest (or smallest) value; a sum of values. */
#define STRATUS_RAY_COMPOSITE 0
#define STRATUS_RAY_EXTREMES 1
#define STRATUS_RAY_SUMS 2
#define STRATUS_RAY_ISOSURFACE 3 /* isosurfaces */
/* Light behind light, where a sample is more than its value's colour and opacity: lit, thinned, of several components. */
#define STRATUS_RAY_SHADING 4

/* Where rays begin and go: ray k (forward + u right + v up) from eye; parallel: from eye + u right + v up along forward. */
typedef struct stratus_ray_camera {
  stratus_pair eye[3], forward[3], right[3], up[3];
  /* squared world length of forward + u right + v up: [0] + u [1] + v [2] + u u [3] + u v [4] + v v [5] */
  stratus_pair metric[6];
  stratus_pair near_k, far_k; /* far_k only if has_far */
  stratus_pair pixel[2];      /* 1/width, 1/height */
  int window[4];              /* x0, x1, y0, y1: pixels outside show nothing */
  int parallel, has_far;
  int has_opaque_depth; /* 1: rays end where opaque geometry hides them */
} stratus_ray_camera;

/* The samples of every ray. */
typedef struct stratus_ray_lattice {
  stratus_pair reach;    /* samples to beyond the volume's farthest corner */
  stratus_pair per_step; /* 1 / sample distance, world */
  float step;            /* the sample distance as a float, for depth */
  int jitter, seed;      /* 1: each ray's lattice lies farther from the eye, by a part of a sample that pixel and seed decide */
} stratus_ray_lattice;

/* What bounds leave of a ray. */
typedef struct stratus_ray_crop {
  stratus_pair box[2][3];   /* bounds, crop included, drawn in by a hair so that rounding keeps every sample inside */
  stratus_pair piece[2][3]; /* owned part: a segment belongs to it if its middle does */
  stratus_pair clip[STRATUS_CLIP_MAX][4];
  stratus_pair plane[3][2];
  int clip_count, has_piece;
  int regions; /* 0, or which of the 27 regions between the planes are shown: bit x + 3 y + 9 z, each 0..2 */
} stratus_ray_crop;

/* The volume's values and how they lie in memory. */
typedef struct stratus_ray_values {
  float last[3]; /* largest position along each axis (cell_centered clamps to it) */
  int clamp;     /* cell_centered: positions are clamped to 0..last */
  int nearest;
  int has_hidden;
  int dimensions[3];
  int row, slice;           /* values from one row to the next, one slice to the next (when they fit) */
  int tail;                 /* largest index from which 4 bytes may be read (8-bit types) */
  int type, stride;         /* of the generic fetch */
  int row_high, slice_high; /* upper 32 bits of row and slice for the generic fetch */
  int bias_low, bias_high;  /* bits of the double that wide types are relative to */
} stratus_ray_values;

/* The structure that tells which segments need no samples. */
typedef struct stratus_ray_map {
  int structure;        /* 0: march without */
  float occupied[2][3]; /* box of occupied blocks, unbounded where it ends with the volume */
  int pitch, rows;      /* blocks of a row, rows in a slice */
  int block_log2;
  int octant_stride;              /* bytes between the eight maps, 0 if there is one */
  int tree;                       /* > 0: the map is a tree of so many nodes (tree_map.h) */
  int bounds_at;                  /* extremes: where the blocks' bounds begin in the map, in 64 bytes */
  int bounds_across, bounds_rows; /* blocks a row, rows a slice */
} stratus_ray_map;

/* Extremes, sums and isosurfaces. */
typedef struct stratus_ray_mode {
  float sign, top;                   /* extremes: 1 for maxima, -1 for minima, and sign times the value that none passes */
  float counted_first, counted_last; /* sums: the values that count, ends included */
  float grey_scale, grey_offset;     /* sums: a value's shade is value * scale + offset */
  float sum_scale;                   /* sums: of a sum over whole samples; 0: the mean is shown */
  int sum;                           /* 1: rays show something wherever they meet the bounds */
  int contour_count;
  float contour[STRATUS_CONTOURS_MAX][5]; /* isosurfaces, by rising values: value, colour times opacity, opacity */
} stratus_ray_mode;

typedef struct stratus_ray_lights {
  int on, two_sided, count;
  float normal[9];                 /* rows: from a value's index gradient to a normal, of any length */
  float place[9];                  /* rows: from index displacements to the world's, in units of the shortest voxel edge */
  float material[4];               /* ambient, diffuse, specular, specular power */
  float vector[8][3], color[8][3]; /* directions of length 1 to the light, or its position as `place` has it */
  int positional[8];
} stratus_ray_lights;

/* Of shaded samples: components and labels, each with a table of its own in the table of all, and gradient opacity. */
typedef struct stratus_ray_media {
  int components, dependent;          /* components 0 and 1: one value */
  int component_bytes;                /* from a value to the next component's */
  float gradient_length[3];           /* from a value's index gradient to value per mean spacing */
  int first[4];                       /* a component's table: its first entry, in floats */
  float scale[4], offset[4], last[4]; /* a component's table: as in stratus_table_arguments */
  int factor_first[4];                /* a component's gradient opacity: its first entry, in floats; -1: none */
  float factor_scale[4], factor_last[4];
  float weight[4];
  int label_first, label_count; /* labels 0..label_count: where their scale, offset, last entry and first entry / 4 stand, in floats.
                                 * 0: no labels */
} stratus_ray_media;

typedef struct stratus_ray_cast_arguments {
  stratus_picture_arguments picture;
  stratus_ray_camera camera;
  stratus_ray_lattice lattice;
  float termination; /* of transparency: 1 - alpha */
  stratus_ray_crop crop;
  stratus_ray_values values;
  stratus_ray_map map;
  stratus_table_arguments table;
  stratus_ray_mode mode;
  stratus_ray_lights light;
  stratus_ray_media media;
} stratus_ray_cast_arguments;

#endif
