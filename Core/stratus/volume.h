/* SPDX-License-Identifier: BSD-3-Clause
 * Views of the data: volumes on regular grids, and transfer functions, criteria. */
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

STRATUS_API size_t stratus_type_size(stratus_type type); /* bytes; 0 for no type */

#define STRATUS_COMPONENTS_MAX 4

/* vtkDataSetAttributes' ghost bits, as far as they matter here. */
#define STRATUS_GHOST_DUPLICATE 1u    /* point or cell: another piece owns it */
#define STRATUS_GHOST_HIDDEN_POINT 2u /* point: cells that touch it are transparent */
#define STRATUS_GHOST_HIDDEN_CELL 32u /* cell: transparent */

/* A view of values on a regular grid.
 * Values may be NaN or infinite: a cell with such a corner is transparent (nearest interpolation: such a voxel). Types of more than 24
 * bits are taken relative to one of their values (the least in magnitude of some thousand), in double, so that an offset costs no digits.
 */
typedef struct stratus_volume {
  const void* values; /* dimensions[0]*[1]*[2] values, x fastest, value_stride apart */
  stratus_type type;
  int64_t dimensions[3];       /* values along x, y, z; each >= 1 */
  int64_t value_stride;        /* distance between consecutive values, in values, >= 1; default 1 */
  double origin[3];            /* local position of voxel (0,0,0), or of the corner of the first cell if cell_centered */
  double spacing[3];           /* > 0 */
  double direction[9];         /* row-major rotation: local = origin + direction * (spacing * index); default identity */
  double matrix[16];           /* row-major affine: world = matrix * local; default identity; mirror and shear allowed */
  int cell_centered;           /* 1: a value belongs to a cell: the volume is dimensions*spacing wide and, where linear, clamps
                                * within half a cell of its border. Default 0: values sit on points, the volume is (dimensions-1)*spacing wide. */
  const uint8_t* point_ghosts; /* dimensions[] flags, NULL: none; not used if cell_centered */
  const uint8_t* cell_ghosts; /* a flag a cell, NULL: none. Cells along an axis: dimensions-1, but 1 where that is 0, as VTK counts those of
                               * flat images; cell_centered: dimensions. */
  uint64_t revision;          /* the caller raises it when values or ghosts change under the same pointer. Default 0. */
  int components; /* 1..4, default 1 (0 is 1): value v's component c is values[v*value_stride + c]. More than 1: ray casts in composite
                   * mode only; everything else takes component 0. */
} stratus_volume;

STRATUS_API stratus_volume stratus_volume_default(void);
/* Checks a view: pointers, dimensions, overflow, finite positive spacing, invertible matrices. */
STRATUS_API stratus_status stratus_volume_check(stratus_context* context, const stratus_volume* volume);

/* A transfer function: piecewise linear between points of non-decreasing value (equal values make a step). */
typedef struct stratus_transfer {
  const double* opacity; /* opacity_count pairs: value, opacity in 0..1 per unit_distance; 1 is opaque, however short the way
                          * through it. A single value at which the function is 1 is passed on the way to others. */
  size_t opacity_count;  /* >= 1 */
  const double* color;   /* color_count quadruples: value, red, green, blue in 0..1 */
  size_t color_count;    /* >= 1 */
  double unit_distance;  /* world length that `opacity` is per, > 0. Default 1. */
  int clamp;             /* 1: the end points' opacity holds beyond them. 0: transparent there. Default 1. Colours always hold. */
  /* Ray cast, composite: gradient_count pairs: the gradient's magnitude, and what the optical depth is multiplied by there, in 0..1 (above
   * 0, opacity 1 stays opaque); the ends hold beyond. The magnitude is in values per mean spacing of the grid (as VTK's mappers have it),
   * whatever the volume's matrix. Default NULL, 0: none. */
  const double* gradient;
  size_t gradient_count;
  double weight; /* independent components: what their optical depth is multiplied by, 0..1. Default 1. */
} stratus_transfer;

STRATUS_API stratus_transfer stratus_transfer_default(void);
STRATUS_API stratus_status stratus_transfer_check(stratus_context* context, const stratus_transfer* transfer);

/* Which values show, for structures that ask no more of a transfer function. */
typedef struct stratus_criterion {
  const stratus_transfer* transfer; /* not NULL: values of opacity > 0. Default NULL. */
  double lower, upper;              /* else values in lower..upper, ends included, lower <= upper, infinities allowed. Default: all. */
} stratus_criterion;

STRATUS_API stratus_criterion stratus_criterion_default(void);

/* World bounds of a volume. */
STRATUS_API stratus_status stratus_volume_bounds(stratus_context* context, const stratus_volume* volume, double bounds[6]);

#ifdef __cplusplus
}
#endif

#endif
