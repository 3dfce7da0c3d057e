/* SPDX-License-Identifier: BSD-3-Clause
 * What one frame tells every ray, the same bytes on host and device: scalars of four bytes only. Positions are index coordinates,
 * lengths along a ray are in samples (sample distances) unless they say otherwise. */
#ifndef STRATUS_RAY_CAST_ARGUMENTS_H
#define STRATUS_RAY_CAST_ARGUMENTS_H

#include "real.h"

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

typedef struct stratus_ray_cast_arguments {
  /* ray k (forward + u right + v up) from eye; parallel: from eye + u right + v up along forward */
  stratus_pair eye[3], forward[3], right[3], up[3];
  /* squared world length of forward + u right + v up: [0] + u [1] + v [2] + u u [3] + u v [4] + v v [5] */
  stratus_pair metric[6];
  stratus_pair near_k, far_k; /* far_k only if has_far */
  stratus_pair reach;         /* samples to beyond the volume's farthest corner */
  stratus_pair per_step;      /* 1 / sample distance, world */
  stratus_pair pixel[2];      /* 1/width, 1/height */
  stratus_pair box[2][3];     /* bounds, crop included, drawn in by a hair so that rounding keeps every sample inside */
  stratus_pair piece[2][3];   /* owned part: a segment belongs to it if its middle does */
  stratus_pair clip[STRATUS_CLIP_MAX][4];
  float occupied[2][3]; /* box of occupied blocks, unbounded where it ends with the volume */
  float last[3];        /* largest position along each axis (cell_centered clamps to it) */
  float table_scale, table_offset, table_last;
  float shown_first, shown_beyond; /* pre-integrated: entries outside [shown_first, shown_beyond) are transparent */
  float tau_scale;                 /* pre-integrated: optical depth of one unit of the sums */
  float color_slope;               /* pre-integrated: most that a colour changes from entry to entry, over the error allowed */
  int has_opaque;    /* pre-integrated: entries of opacity 1 are among those that show; behind the sums stands where: opaque_on_the_way() */
  float termination; /* of transparency: 1 - alpha */
  float world_step;  /* the sample distance as a float, for depth */
  int width, height;
  int window[4]; /* x0, x1, y0, y1: pixels outside show nothing */
  int parallel;
  int clip_count;
  int has_far, has_piece, has_depth; /* has_depth: opaque depth is given */
  int want_depth, want_samples, want_bytes;
  int clamp; /* cell_centered: positions are clamped to 0..last */
  int nearest;
  int dimensions[3];
  int row, slice;                /* values from one row to the next, one slice to the next (when they fit) */
  int tail;                      /* largest index from which 4 bytes may be read (8-bit types) */
  int structure;                 /* 0: march without */
  int blocks_pitch, blocks_rows; /* of the map: a row, rows in a slice */
  int block_log2;
  int octant_stride; /* bytes between the eight maps, 0 if there is one */
  int tree;          /* > 0: the map is a tree of so many nodes (tree_map.h) */
  int has_hidden;
  int type, stride;         /* of the generic fetch */
  int row_high, slice_high; /* upper 32 bits of row and slice for the generic fetch */
  int bias_low, bias_high;  /* bits of the double that wide types are relative to */
  /* modes */
  float sign, top;                   /* extremes: 1 for maxima, -1 for minima, and sign times the value that none passes */
  float counted_first, counted_last; /* sums: the values that count, ends included */
  float grey_scale, grey_offset;     /* sums: a value's shade is value * scale + offset */
  float sum_scale;                   /* sums: of a sum over whole samples; 0: the mean is shown */
  int sum;                           /* 1: rays show something wherever they meet the bounds */
  int contour_count;
  int bounds_at;                  /* extremes: where the blocks' bounds begin in the map, in 64 bytes */
  int bounds_across, bounds_rows; /* blocks a row, rows a slice */
  int crop_regions;               /* 0, or which of the 27 regions between crop_plane are shown: bit x + 3 y + 9 z, each 0..2 */
  int jitter, seed;               /* 1: each ray's lattice lies farther from the eye, by a part of a sample that pixel and seed decide */
  stratus_pair crop_plane[3][2];
  float contour[STRATUS_CONTOURS_MAX][5]; /* isosurfaces, by rising values: value, colour times opacity, opacity */
  /* shading */
  int shade, two_sided, light_count;
  float normal[9];                      /* rows: from a value's index gradient to a normal, of any length */
  float place[9];                       /* rows: from index displacements to the world's, in units of the shortest voxel edge */
  float material[4];                    /* ambient, diffuse, specular, specular power */
  float light[8][3], light_color[8][3]; /* directions of length 1 to the light, or its position as `place` has it */
  int light_positional[8];
  int components, dependent; /* components 0 and 1: one value */
  int component_bytes;       /* from a value to the next component's */
  float gradient_length[3];  /* from a value's index gradient to value per mean spacing */
  int shading_first[4];      /* of each component: its table's first entry in the table of all, in floats; .. */
  float shading_scale[4], shading_offset[4],
    shading_last[4];                     /* .. its entries, as table_scale, table_offset and table_last are component 0's; .. */
  int factor_first[4];                   /* .. its gradient opacity's first entry, likewise, -1: none; .. */
  float factor_scale[4], factor_last[4]; /* .. and that one's entries */
  float component_weight[4];
  int label_first,
    label_count; /* labels 0..label_count: where their scale, offset, last entry and first entry / 4 stand, in floats. 0: no labels */
} stratus_ray_cast_arguments;

/* 4-byte scalars throughout: no padding in either language. */
#define STRATUS_RAY_CAST_ARGUMENTS_WORDS                                                                                                   \
  (2 * (12 + 6 + 2 + 1 + 1 + 2 + 6 + 6 + 24) + 6 + 3 + 9 + 36 + 8 + 1 + 3 + 3 + 12 + 80 + 3 + 22 + 56 + 6 + 32 + 2)

#endif
