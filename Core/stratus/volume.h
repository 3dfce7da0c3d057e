/* SPDX-License-Identifier: BSD-3-Clause
 * Views of the data: volumes on regular grids, transfer functions and criteria. */
#ifndef STRATUS_PUBLIC_VOLUME_H
#define STRATUS_PUBLIC_VOLUME_H

#include "context.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum stratus_type {
  STRATUS_INT8,
  STRATUS_UINT8,
  STRATUS_INT16,
  STRATUS_UINT16,
  STRATUS_INT32,
  STRATUS_UINT32,
  STRATUS_INT64,
  STRATUS_UINT64,
  STRATUS_FLOAT32,
  STRATUS_FLOAT64
} stratus_type;

STRATUS_API size_t stratus_type_size(stratus_type type); /* size in bytes of a value; 0 for a number that is not a type */

#define STRATUS_COMPONENTS_MAX 4

/* Bits of a ghost flag: the bits of vtkDataSetAttributes that the core reads. It ignores the others. */
#define STRATUS_GHOST_DUPLICATE 1u    /* point or cell: another piece owns it */
#define STRATUS_GHOST_HIDDEN_POINT 2u /* point: the cells that touch it are transparent */
#define STRATUS_GHOST_HIDDEN_CELL 32u /* cell: it is transparent */

/* The same values in another layout, in which neighbours along all three axes are near one another in memory. Value (i,j,k) is `bytes` into
 * `values`, where bytes = at[0][i] + at[1][j] + at[2][k]. */
typedef struct stratus_tiles {
  const void* values;    /* NULL (default): there are none */
  const uint64_t* at[3]; /* for each axis, dimensions + 1 numbers of bytes; the last one repeats the one before it */
  int64_t dimensions[3]; /* of the volume */
} stratus_tiles;

/* The parts in which the values of an array are read from its file (stratus_bricks_parts()). */
typedef struct stratus_parts stratus_parts;

/* A view of values on a regular grid. Values may be NaN or infinite: a cell with such a corner is transparent (nearest interpolation: a
 * voxel with such a value).
 *
 * Types of more than 24 bits are read as differences from one of their values, computed in double, so that a large offset costs no digits.
 * This value is the one of least magnitude among some thousand that are examined. Integers beyond 2^53 are rounded to doubles first. A
 * double that differs from it by more than floats hold counts as infinite. A FLOAT64 volume whose values differ, but are all equal as
 * floats, gives STRATUS_INVALID_ARGUMENT. Fill values that count as infinite do not make values differ. */
typedef struct stratus_volume {
  const void* values; /* dimensions[0]*[1]*[2] values, x fastest, value_stride apart */
  stratus_type type;
  int64_t dimensions[3]; /* number of values along x, y, z; each >= 1 */
  int64_t value_stride;  /* distance between consecutive values, in values, >= 1; default 1 */
  double origin[3];      /* local position of voxel (0,0,0); if cell_centered, of the first cell's corner */
  double spacing[3];     /* each > 0; not read along axes that have coordinates */
  double direction[9];   /* row-major rotation: local = origin + direction * (spacing * index); default identity */
  double matrix[16];     /* row-major affine: world = matrix * local; default identity; mirror and shear allowed */
  /* 1: each value belongs to a cell. The volume is dimensions*spacing wide, and linear interpolation clamps within half a cell of its
   * border. Default 0: values sit on points, and the volume is (dimensions-1)*spacing wide. */
  int cell_centered;
  const uint8_t* point_ghosts; /* one flag for each value, NULL: none; ignored if cell_centered */
  /* One flag for each cell, NULL: none. Along an axis there are dimensions-1 cells, but 1 where that is 0, as VTK counts the cells of flat
   * images. If cell_centered, there are `dimensions` cells. */
  const uint8_t* cell_ghosts;
  uint64_t revision; /* the caller raises it when values or ghost flags change under the same pointer. Default 0. */
  /* Grids whose spacing changes (rectilinear). For each axis NULL (default), or positions that replace spacing * index: `dimensions`
   * positions of the values; if cell_centered, dimensions + 1 positions of the cells' borders. There are at least 2, all finite, and they
   * rise or fall strictly. Neighbours are at least 2^-19 of the whole extent apart, because floats distinguish no closer positions along a
   * ray. Linear interpolation is between the values' positions; a cell's value is at the cell's middle. */
  const double* coordinates[3];
  /* 1..4, default 1 (0 counts as 1), at most value_stride. Component c of value v is values[v*value_stride + c]. Ray casts use all
   * components, except in modes first hit, isosurface and slice: these give STRATUS_UNSUPPORTED for more than 1. Everything else reads the
   * first component. */
  int components;
  /* NULL (default): gradients are differences of neighbouring values. Otherwise the gradient at each value, which is interpolated as values
   * are: the derivative of component c along the grid's axis i, per unit of local length, is gradients[(3*c + i)*count + v] at value v of
   * `count`. Parts of a larger field have no seams in their light if they agree on it where they meet. Rays read gradients in place if
   * they directly follow the values in memory, of one component, FLOAT32 and value_stride 1; otherwise as copies, floats of at most 2 GB.
   */
  const float* gradients;
  /* A number that these values have in every process, such as a hash of a file's size, time and a sample of its bytes; 0 (default): none.
   * The value ranges of a volume with an identity and without ghosts are kept in the cache's folder (the environment's STRATUS_CACHE_DIR,
   * else $XDG_CACHE_HOME/stratus, else $HOME/.cache/stratus; at most 1 GiB in all), so that later processes read them instead of all
   * values. Other values, or the same in another order, need another identity. */
  uint64_t identity;
  /* NULL (default), or how many bytes of the values their source could not supply so far, as where a mapped file is cut short while it is
   * read. Once this is not 0, calls fail with STRATUS_INVALID_ARGUMENT, and what they draw then is undefined. */
  const uint64_t* missing;
  /* The values once more, of all components and with value_stride, for rays on the host and the pages of devices; code that reads all
   * values reads `values`. For arrays that are larger than memory (stratus_bricks_tiles()). */
  stratus_tiles tiles;
  /* NULL (default), or the parts of an array of which `values` are all values: value ranges and coarse copies are then made part after
   * part, as they come from the file. Where the parts are of other values or dimensions, `values` are read. */
  const stratus_parts* parts;
} stratus_volume;

/* Return a view with the defaults. The caller sets at least values, type and dimensions. */
STRATUS_API stratus_volume stratus_volume_default(void);
/* Check a view: pointers, dimensions, overflow of sizes, finite positive spacing, invertible matrices. */
STRATUS_API stratus_status stratus_volume_check(stratus_context* context, const stratus_volume* volume);

/* A coarse copy of a large volume: one value in so many along each axis, about 2^24 in all, in the same place. */
typedef struct stratus_coarse stratus_coarse;
/* Reads the copy that is kept of a volume of one component with an identity and more than 2^26 values, since its value ranges were found.
 * STRATUS_UNSUPPORTED if none is kept. No value of the volume is read. */
STRATUS_API stratus_status stratus_coarse_recall(stratus_context* context, const stratus_volume* volume, stratus_coarse** coarse);
STRATUS_API const stratus_volume* stratus_coarse_volume(const stratus_coarse* coarse);
STRATUS_API void stratus_coarse_destroy(stratus_coarse* coarse);

/* A transfer function, piecewise linear between points of non-decreasing value. Two points of equal value make a step. */
typedef struct stratus_transfer {
  /* opacity_count pairs: value, and opacity in 0..1 per unit_distance. If the opacity is 1 over an interval of values, then the medium is
   * opaque there, however short the ray's path through it. A single value of opacity 1 does not stop a ray whose values only pass through
   * it. */
  const double* opacity;
  size_t opacity_count; /* >= 1 */
  const double* color;  /* color_count quadruples: value, then red, green, blue in 0..1 */
  size_t color_count;   /* >= 1 */
  double unit_distance; /* world length to which `opacity` refers, > 0. Default 1. */
  /* 1 (default): the opacity of an end point holds beyond it. 0: values beyond the end points are transparent. Colours always hold beyond
   * the end points. */
  int clamp;
  /* Used by ray casts in composite mode: gradient_count pairs of the gradient's magnitude and a factor in 0..1 of the optical depth. The
   * factors of the end points hold beyond them. Opacity 1 stays opaque under any factor above 0. The magnitude is in values per mean
   * spacing of the grid, as in VTK's mappers, whatever the volume's matrix. Default NULL and 0: no factor. */
  const double* gradient;
  size_t gradient_count;
  double weight; /* factor of the optical depth of an independent component, 0..1. Default 1. */
} stratus_transfer;

/* Return a function with the defaults. The caller sets at least its points. */
STRATUS_API stratus_transfer stratus_transfer_default(void);
/* Check a transfer function: points that are finite and in order, opacities and colours in 0..1, a positive finite unit distance. */
STRATUS_API stratus_status stratus_transfer_check(stratus_context* context, const stratus_transfer* transfer);

/* The values that show, for structures that read nothing else from a transfer function. */
typedef struct stratus_criterion {
  const stratus_transfer* transfer; /* if not NULL, values of opacity > 0 show. Default NULL. */
  /* If transfer is NULL, values in lower..upper show, ends included; lower <= upper, infinities allowed. Default: all values. */
  double lower, upper;
} stratus_criterion;

/* Return the criterion with its defaults: all values show. */
STRATUS_API stratus_criterion stratus_criterion_default(void);

/* Compute the world bounds of a volume: xmin xmax ymin ymax zmin zmax. */
STRATUS_API stratus_status stratus_volume_bounds(stratus_context* context, const stratus_volume* volume, double bounds[6]);

#ifdef __cplusplus
}
#endif

#endif
