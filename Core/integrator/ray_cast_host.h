/* SPDX-License-Identifier: BSD-3-Clause
 * The traversal on the host, compiled once for each instruction set and picked at run time. */
#ifndef STRATUS_RAY_CAST_HOST_H
#define STRATUS_RAY_CAST_HOST_H

#include "base.h"
#include "instruction_set.h"
#include "ray_cast_arguments.h"

#include <stdint.h>

/* The variants of the traversal, each compiled separately: the first two once for each type of values. */
typedef enum stratus_ray_variant {
  STRATUS_VARIANT_MIDPOINT,
  STRATUS_VARIANT_PREINTEGRATED,
  STRATUS_VARIANT_EXTREMES, /* maxima and minima */
  STRATUS_VARIANT_SUMS,     /* means and sums */
  STRATUS_VARIANT_ISOSURFACE,
  STRATUS_VARIANT_CELLS,       /* composite, cell by cell */
  STRATUS_VARIANT_LOCAL,       /* composite, cell by cell in rough blocks */
  STRATUS_VARIANT_LIT,         /* the same two, lit */
  STRATUS_VARIANT_TRANSFER_2D, /* composite, by a function of two variables */
  STRATUS_VARIANT_SLICE,
  STRATUS_VARIANT_QUANTITIES,       /* numbers of the field, cell by cell */
  STRATUS_VARIANT_SHADING_MIDPOINT, /* samples are lit, gradient-thinned, multi-component or labelled */
  STRATUS_VARIANT_SHADING_PREINTEGRATED
} stratus_ray_variant;

typedef struct stratus_ray_counts {
  uint64_t rays, samples, skipped, lookups;
} stratus_ray_counts;

/* The arrays that a frame reads and writes. */
typedef struct stratus_ray_cast_frame {
  const stratus_ray_cast_arguments* arguments;
  const void* values;
  const uint8_t* hidden;
  const uint8_t* map;
  const uint8_t* rough;  /* the map of rough blocks; NULL but for rule local */
  const int32_t* grid;   /* the tables of a grid whose spacing changes (kernels/field/stretched_grid.h); NULL: none */
  const int32_t* lights; /* the maps of lights (kernels/base/light_map.h); NULL: none */
  const void* table;     /* midpoint: 4 floats per entry, then 4 more (optical depth, 0, 0, 0) per entry; pre-integrated: sums */
  const float* opaque_depth;
  float* rgba;
  float* depth;      /* NULL: not wanted */
  uint32_t* samples; /* NULL: not wanted */
  uint8_t* rgba8;    /* NULL: not wanted */
} stratus_ray_cast_frame;

/* Marches the rays of pixels [x0, x1) x [y0, y1); x0 and y0 are multiples of 8. */
typedef void stratus_ray_cast_tile(const stratus_ray_cast_frame* frame, int x0, int y0, int x1, int y1, stratus_ray_counts* counts);

/* Returns the traversal for stratus_type `type` (-1: generic), compiled for this machine's highest instruction set or for `isa` (0..3),
 * whichever is lower. */
stratus_ray_cast_tile* stratus_ray_cast_tile_for(int isa, int type, stratus_ray_variant variant);

/* One definition for each instruction set. */
stratus_ray_cast_tile* stratus_ray_cast_tile_isa0(int type, stratus_ray_variant variant);
stratus_ray_cast_tile* stratus_ray_cast_tile_isa1(int type, stratus_ray_variant variant);
stratus_ray_cast_tile* stratus_ray_cast_tile_isa2(int type, stratus_ray_variant variant);
stratus_ray_cast_tile* stratus_ray_cast_tile_isa3(int type, stratus_ray_variant variant);
stratus_ray_cast_tile stratus_ray_extremes_tile_isa0, stratus_ray_extremes_tile_isa1, stratus_ray_extremes_tile_isa2,
  stratus_ray_extremes_tile_isa3;
stratus_ray_cast_tile stratus_ray_sums_tile_isa0, stratus_ray_sums_tile_isa1, stratus_ray_sums_tile_isa2, stratus_ray_sums_tile_isa3;
stratus_ray_cast_tile stratus_ray_isosurface_tile_isa0, stratus_ray_isosurface_tile_isa1, stratus_ray_isosurface_tile_isa2,
  stratus_ray_isosurface_tile_isa3;
stratus_ray_cast_tile stratus_ray_cells_tile_isa0, stratus_ray_cells_tile_isa1, stratus_ray_cells_tile_isa2, stratus_ray_cells_tile_isa3;
stratus_ray_cast_tile stratus_ray_local_tile_isa0, stratus_ray_local_tile_isa1, stratus_ray_local_tile_isa2, stratus_ray_local_tile_isa3;
stratus_ray_cast_tile stratus_ray_lit_tile_isa0, stratus_ray_lit_tile_isa1, stratus_ray_lit_tile_isa2, stratus_ray_lit_tile_isa3;
stratus_ray_cast_tile stratus_ray_transfer_2d_tile_isa0, stratus_ray_transfer_2d_tile_isa1, stratus_ray_transfer_2d_tile_isa2,
  stratus_ray_transfer_2d_tile_isa3;
stratus_ray_cast_tile stratus_ray_slice_tile_isa0, stratus_ray_slice_tile_isa1, stratus_ray_slice_tile_isa2, stratus_ray_slice_tile_isa3;
stratus_ray_cast_tile stratus_ray_quantities_tile_isa0, stratus_ray_quantities_tile_isa1, stratus_ray_quantities_tile_isa2,
  stratus_ray_quantities_tile_isa3;
stratus_ray_cast_tile stratus_ray_shading_tile_isa0, stratus_ray_shading_tile_isa1, stratus_ray_shading_tile_isa2,
  stratus_ray_shading_tile_isa3;
stratus_ray_cast_tile stratus_ray_shading_pre_tile_isa0, stratus_ray_shading_pre_tile_isa1, stratus_ray_shading_pre_tile_isa2,
  stratus_ray_shading_pre_tile_isa3;

#endif
