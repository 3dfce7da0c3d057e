/* SPDX-License-Identifier: BSD-3-Clause
 * The arguments of one frame that every ray reads, in structs by use: scalars of four bytes only, the same bytes on host and device.
 * Positions are index coordinates. Lengths along a ray are in samples (sample distances) unless a comment says otherwise. */
#ifndef STRATUS_RAY_CAST_ARGUMENTS_H
#define STRATUS_RAY_CAST_ARGUMENTS_H

#include "light_arguments.h"
#include "picture_arguments.h"
#include "slice_arguments.h"
#include "table_arguments.h"

#define STRATUS_CLIP_MAX 6

/* Features that few frames have. A device builds its kernel with the features that the frame has (RAY_HAS), which takes half of the time of
 * building all of them. rarities() in ray_cast_device.c returns a frame's features. */
#define RAY_REGIONS 0x001    /* crop regions */
#define RAY_CLIP 0x002       /* clip planes */
#define RAY_PIECE 0x004      /* a piece of a volume */
#define RAY_JITTER 0x008     /* a lattice of its own for each ray */
#define RAY_HIDDEN 0x010     /* hidden values or cells */
#define RAY_NEAREST 0x020    /* nearest values */
#define RAY_TREE 0x040       /* a tree in the map's place */
#define RAY_COMPONENTS 0x080 /* several components */
#define RAY_LABELS 0x100     /* a label for each value */
#define RAY_OPAQUE 0x200     /* functions that are opaque somewhere, */
#define RAY_CUT 0x400        /* transparent beyond their ends, */
#define RAY_JUMPS 0x800      /* or that jump */
#define RAY_GRID 0x2000      /* a grid whose spacing changes */
#define RAY_FOLLOWS 0x4000   /* samples whose length follows the ray's way through the voxels */
#define RAY_GRADIENTS 0x8000 /* gradients that the volume has at its values */
#ifndef RAY_HAS
#define RAY_HAS 0xefff
#endif
/* Values in pages, which only devices know, and only where the whole volume does not fit one of their allocations. */
#define RAY_PAGES 0x1000
#define RAY_IN_PAGES (RAY_HAS & RAY_PAGES)

/* A page holds the values of PAGE_SIDE^3 cells, both ends included, so that a cell's corners are in one page: x fastest, one component
 * after the other. Values beyond the volume's end repeat its last. An entry of the page table is the slab's number << PAGE_SLAB_SHIFT, and
 * the page's place in the slab; negative where the device has no page. */
#define PAGE_LOG2 3
#define PAGE_SIDE (1 << PAGE_LOG2)
#define PAGE_ROW (PAGE_SIDE + 1)
#define PAGE_VALUES (PAGE_ROW * PAGE_ROW * PAGE_ROW)
#define PAGE_SLABS 4
#define PAGE_SLAB_SHIFT 29
/* A field of the arguments, which is 0 where the frame has none of `what`. */
#define RAY_RARE(what, field) (RAY_HAS & (what) ? (field) : 0)

/* has_hidden: the contents of the hidden bytes. The mask comes first, a byte for each value, 0 where it hides the value; then a byte for
 * each cell, 1 where the cell is hidden. */
#define HIDDEN_CELLS 1
#define HIDDEN_BY_MASK 2
#define HIDDEN_LABELS 4 /* the mask's bytes are labels and hide nothing */

#define STRATUS_CONTOURS_MAX 16

/* How a ray combines its samples (STRATUS_RAY_MODE). */
#define STRATUS_RAY_COMPOSITE 0  /* light behind light */
#define STRATUS_RAY_EXTREMES 1   /* the largest or smallest value */
#define STRATUS_RAY_SUMS 2       /* the mean or the sum of values */
#define STRATUS_RAY_ISOSURFACE 3 /* surfaces of contour values, light behind light */
/* Composite, too, but a sample is more than its value's colour and opacity: lit, thinned by the gradient, of several components, or
 * labelled. */
#define STRATUS_RAY_SHADING 4
#define STRATUS_RAY_CELLS 5       /* light behind light, cell by cell */
#define STRATUS_RAY_LOCAL 6       /* light behind light, cell by cell in rough blocks, from sample to sample elsewhere */
#define STRATUS_RAY_TRANSFER_2D 7 /* light behind light, by a function of the value and of a second number */
#define STRATUS_RAY_SLICE 8       /* the values on a surface of the world, light behind light */
#define STRATUS_RAY_QUANTITIES 9  /* the field's integral, length and largest value, cell by cell */

/* The rays: ray k (forward + u right + v up) from eye; parallel: from eye + u right + v up along forward. */
typedef struct stratus_ray_camera {
  stratus_pair eye[3], forward[3], right[3], up[3];
  /* squared world length of forward + u right + v up: [0] + u [1] + v [2] + u u [3] + u v [4] + v v [5] */
  stratus_pair metric[6];
  stratus_pair near_k, far_k; /* far_k only if has_far */
  stratus_pair layer_k;       /* only if layers is set */
  stratus_pair pixel[2];      /* 1/width, 1/height of the picture */
  int window[4];              /* x0, x1, y0, y1: pixels outside show nothing */
  int parallel, has_far;
  int has_opaque_depth; /* 1: rays end where opaque geometry hides them */
  int layers;           /* > 0: on the host rays store so many pictures, one after the other, each of a part layer_k deep from near_k on */
} stratus_ray_camera;

/* The samples of every ray. */
typedef struct stratus_ray_lattice {
  stratus_pair reach;    /* as many samples as reach beyond the volume's farthest corner */
  stratus_pair per_step; /* 1 / sample distance, in the world */
  float step;            /* the sample distance as a float, for depth */
  /* 1: each ray's samples are as long as its own way through a part of a voxel. per_voxel: samples a ray takes in passing a voxel along
   * each axis, of which the largest number counts. */
  int follows;
  stratus_pair per_voxel[3];
  /* cells: the square of the number of pieces of a path through a cell, over the field's largest second derivative on it */
  float pieces_per_bend;
  /* lit cells and lit local: the spread of a bundle that is lit at one place (lit_places.h), in squares of voxels */
  float light_spread;
  int jitter, seed; /* jitter 1: each ray's lattice lies farther from the eye by a part of a sample, which pixel and seed decide */
} stratus_ray_lattice;

/* The bounds that cut rays. */
typedef struct stratus_ray_crop {
  stratus_pair box[2][3];   /* bounds, crop included, drawn in by a hair so that rounding keeps every sample inside */
  stratus_pair piece[2][3]; /* the part that this piece owns: a segment belongs to it if its middle does */
  float lit[2][3];          /* has_piece: the part in which gradients have all neighbours, and at least what the piece owns */
  stratus_pair clip[STRATUS_CLIP_MAX][4];
  stratus_pair plane[3][2];
  int clip_count, has_piece;
  int clipped;         /* 1: gradients take clipped_value in place of values that clip planes hide */
  float clipped_value; /* relative to the bias, as rays see values */
  int regions; /* the regions between the planes that are shown: bit x + 3 y + 9 z, each 0..2; 0: there are none, and the box is all */
} stratus_ray_crop;

#define RAY_READING_TILES 11 /* values.reading of values in tiles */

/* The volume's values and their layout in memory. */
typedef struct stratus_ray_values {
  float last[3]; /* the largest position along each axis, which `clamp` clamps to, and grids */
  int clamp;     /* 1 for cell_centered volumes: positions are clamped to 0..last */
  int nearest;
  int has_hidden;
  int dimensions[3];
  int row, slice;           /* how many values lie from one row to the next, and from one slice to the next (their low 32 bits) */
  int tail;                 /* the largest index from which 4 bytes may be read (8-bit types) */
  int reading;              /* the host's functions for them: 1 + the number of a type that has its own fetch; 0: the generic fetch */
  int type, stride;         /* read by the generic fetch only, as the next two */
  int row_high, slice_high; /* high 32 bits of row and slice */
  int bias_low, bias_high;  /* bits of the double that wide types are relative to */
  /* > 0: so many values behind a component's values begin the planes of its derivatives along the axes, each as many floats. Times
   * gradient_scale they are per index. 0: gradients are differences. */
  int gradient_at;
  float gradient_scale[3];
  int pages_across, pages_rows, page_components; /* of the page table: pages in a row, rows in a slice; and components in a page */
} stratus_ray_values;

/* The structure that marks the segments that need no samples. */
typedef struct stratus_ray_map {
  int structure;        /* 0: march without */
  float occupied[2][3]; /* the box of the occupied blocks; unbounded where it ends with the volume */
  int pitch, rows;      /* bytes from one row of blocks to the next; rows in a slice */
  int block_log2;
  int octant_stride;              /* bytes from one octant's map to the next; 0 if one map serves all */
  int tree;                       /* > 0: the map is a tree of so many nodes (tree_map.h) */
  int bounds_at;                  /* extremes: where the blocks' bounds begin in the map, in units of 64 bytes */
  int bounds_across, bounds_rows; /* blocks in a row of bounds, rows in a slice */
} stratus_ray_map;

/* The tables of a grid whose spacing changes, for each axis (stretched_grid.h): where bins' first values, planes, inverse lengths of cells
 * and values' weights begin. Positions are then mean index coordinates. */
typedef struct stratus_ray_grid_arguments {
  int on;                              /* 0: the grid has equal spacing, and the rest means nothing */
  float bins_per_unit[3], last_bin[3]; /* the bin of a position: (int) clamp(position * bins_per_unit, 0, last_bin) */
  int even[3];                         /* whether the axis has equal spacing; else 0 */
  int last_cell[3];                    /* the number of the axis's last cell between values */
  int search_steps[3], first_at[3], plane_at[3], inverse_at[3], weight_at[3];
} stratus_ray_grid_arguments;

/* Which blocks are rough: a byte a block, as in a map of full distances. */
typedef struct stratus_ray_rough {
  int pitch, rows; /* bytes from one row of blocks to the next; rows in a slice */
  int block_log2;
} stratus_ray_rough;

/* Extremes, sums and isosurfaces. */
typedef struct stratus_ray_mode {
  float sign, top;                   /* extremes: 1 for maxima, -1 for minima, and sign times the value that none passes */
  float counted_first, counted_last; /* the values that count in a sum, and that an extreme may show, ends included */
  float grey_scale, grey_offset;     /* sums: the grey of a value is value * scale + offset */
  float sum_scale;                   /* sums: factor of a sum over samples; 0: the mean is shown */
  int sum;                           /* 1: rays show something wherever they meet the bounds */
  /* 0: a ray stores its colour. 1 and more: extremes and sums store what it has kept (ray_modes.h). Isosurfaces and slices store only
   * this one of its surfaces, the nearest is 1. */
  int kept;
  int contour_count;
  float contour[STRATUS_CONTOURS_MAX][5]; /* isosurfaces, sorted by value: value, colour times opacity, opacity */
} stratus_ray_mode;

/* Shading by several tables: each component and each label has its own table, and each component its own gradient opacity. All are in one
 * array of floats. */
typedef struct stratus_ray_media {
  int components;                     /* 0 and 1: one value */
  int dependent;                      /* the last component, which has the opacity, where the others have the colour; else 0 */
  int mean;                           /* independent components count by their share of the optical depth */
  int component_bytes;                /* from a value to the next component's */
  float gradient_length[3];           /* takes a value's index gradient to value per mean spacing */
  int first[4];                       /* where each component's table begins */
  float scale[4], offset[4], last[4]; /* a component's table: as in stratus_table_arguments, as the next row */
  int search_steps[4], first_at[4], bound_at[4];
  int factor_first[4]; /* where each component's gradient opacity begins; -1: it has none */
  float factor_scale[4], factor_last;
  float factor_reach; /* > 0: gradient opacities multiply the opacity of so many samples' way; 0: the optical depth */
  float weight[4];
  /* label_first: where the records of labels 0..label_count begin. Four floats: scale, offset and last cell of a label's grid, and the
   * factor_scale of its gradient opacity. Four ints: its table's first entry / 4; the number of its entries; where the first entries of its
   * cells begin, 0 if entries are cells; where the entries' bounds begin. Four ints: factor_first, and three that are 0. label_count 0:
   * there are no labels. label_steps: the most bisections of a label's table. */
  int label_first, label_count, label_steps;
  int label_factors; /* some label has a gradient opacity */
} stratus_ray_media;

/* A function of two variables, in entries of red, green, blue and opacity, a row of columns after the other. Values have columns, and
 * gradient magnitudes or values of the second component have rows. Behind the entries stands each column's largest opacity. */
typedef struct stratus_ray_function_2d {
  int second;                       /* 1: rows are of the second component's values, 0: of the gradient's magnitude */
  int columns, rows;                /* each at least 2 */
  float base[2], scale[2], last[2]; /* the place among columns, rows: clamp((number - base) * scale - 1/2, 0, last) */
  int opacity_at;                   /* where the columns' largest opacities begin */
  float reach;                      /* a sample's length in the lengths that opacities are of */
} stratus_ray_function_2d;

typedef struct stratus_ray_cast_arguments {
  stratus_picture_arguments picture;
  stratus_ray_camera camera;
  stratus_ray_lattice lattice;
  float termination; /* of transparency: 1 - alpha */
  stratus_ray_crop crop;
  stratus_ray_values values;
  stratus_ray_grid_arguments grid;
  stratus_ray_map map;
  stratus_ray_rough rough;
  stratus_table_arguments table;
  stratus_ray_mode mode;
  stratus_light_arguments light; /* places are index coordinates; `place` takes them to units of the shortest voxel edge */
  stratus_ray_media media;
  stratus_ray_function_2d transfer_2d;
  stratus_slice_arguments slice; /* in index coordinates */
} stratus_ray_cast_arguments;

#endif
