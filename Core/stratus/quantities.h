/* SPDX-License-Identifier: BSD-3-Clause
 * Numbers of each pixel's ray, in the units of the data. */
#ifndef STRATUS_PUBLIC_QUANTITIES_H
#define STRATUS_PUBLIC_QUANTITIES_H

#include "ray_cast.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The field is the one that mode composite draws: within clip planes, crop regions and masks, in front of opaque geometry, without hidden
 * cells and values that are not finite. Lengths and depths are in world units, or as `measure` says. Depths are distances along the ray
 * from the eye (parallel: from its plane). */
typedef enum stratus_quantity {
  STRATUS_QUANTITY_INTEGRAL, /* of the field over the ray's length: a column density; 0 where the ray meets no value */
  STRATUS_QUANTITY_LENGTH,   /* on which the ray meets values */
  STRATUS_QUANTITY_MEAN,     /* the integral by the length */
  STRATUS_QUANTITY_MAXIMUM,  /* the largest value */
  STRATUS_QUANTITY_MAXIMUM_DEPTH,
  STRATUS_QUANTITY_CELLS,               /* the number of cells with a value that the ray passes; with nearest interpolation, of values */
  STRATUS_QUANTITY_TRANSMITTANCE,       /* the part of light that passes, 0..1, by the transfer function */
  STRATUS_QUANTITY_TRANSMITTANCE_DEPTH, /* where the transmittance falls to `threshold` */
  STRATUS_QUANTITY_COUNT
} stratus_quantity;

/* Return a quantity's name: "integral", "length", "mean", "maximum", "maximum_depth", "cells", "transmittance" or "transmittance_depth";
 * "unknown" for other numbers. */
STRATUS_API const char* stratus_quantity_name(stratus_quantity quantity);

/* Write a quantity's unit, such as "kg m-2" of the integral of values in "kg/m3" over metres.
 * - values: the unit of the values; NULL or "": unknown, and so is then the unit of integral, mean and maximum.
 * - metres: 1: lengths are in metres, 0: in the grid's units, which are written "grid units".
 * - text: receives the unit, cut to size bytes with the ending 0; "" where it is unknown, "1" for cells and transmittance. */
STRATUS_API void stratus_quantity_unit(stratus_quantity quantity, const char* values, int metres, char* text, size_t size);

typedef struct stratus_quantities {
  int width, height;         /* 1..65536 */
  const float* opaque_depth; /* as in stratus_image */
  int component;             /* of the values, 0..3. Default 0. Transmittance is of all components. */
  double threshold;          /* of the transmittance, above 0 and below 1. Default .5. */
  /* 3x3, row by row, has an inverse or is all 0: takes a vector of the world to coordinates in which lengths and depths are measured. So
   * metres of a world in kilometres are 1000 times the identity, and a world with heights stretched by 10 has 0.1 for z. Default all 0: the
   * world's own. */
  double measure[9];
  int blocks; /* 1: the inputs are blocks of one volume, as in stratus_ray_caster_render_blocks(). Default 0: several. */
  /* Out: width*height floats each, bottom row first. NULL (default): not wanted. A number that a ray does not have is NAN: mean, maximum
   * and its depth where the ray meets no value, and transmittance_depth where the transmittance stays above the threshold. */
  float* of[STRATUS_QUANTITY_COUNT];
} stratus_quantities;

/* Return quantities with their defaults. The caller sets the size and what is wanted. */
STRATUS_API stratus_quantities stratus_quantities_default(void);

/* Compute numbers of each pixel's ray.
 * - inputs, count: as in stratus_ray_caster_render_several(), or in stratus_ray_caster_render_blocks(). The mode of their options is not
 *   read. Transfer functions, sampling and light are read only for transmittance, without which a transfer may be NULL.
 *
 * Integral, length, maximum and cells pass from cell to cell. Along a ray the field in a cell is a cubic, and in a tetrahedron linear. Its
 * integral has a closed form, and its maximum is at an end or where it turns: there is no error but the rounding of floats. Of several
 * inputs, integrals, lengths and cells add up, and the largest maximum counts. The depth of a threshold is found to 1e-4 of the
 * transmittance, by pictures that end at other depths; it needs a handful of them. Where the eye is inside the data, transmittance_depth
 * leaves out the first thousandth of the data's depth.
 *
 * A failed call leaves the arrays undefined. */
STRATUS_API stratus_status stratus_ray_caster_render_quantities(
  const stratus_ray_cast_input* inputs, int count, const stratus_camera* camera, const stratus_quantities* quantities);

#ifdef __cplusplus
}
#endif

#endif
