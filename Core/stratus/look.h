/* SPDX-License-Identifier: BSD-3-Clause
 * Defaults for a first picture: transfer functions by a variable's kind and values, and how much heights are exaggerated. */
#ifndef STRATUS_PUBLIC_LOOK_H
#define STRATUS_PUBLIC_LOOK_H

#include "volume.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Kinds of variables. */
typedef enum stratus_look_kind {
  STRATUS_LOOK_UNKNOWN, /* the values decide */
  STRATUS_LOOK_AMOUNT,  /* of a matter that is here and not there: cloud water, concentrations, speed */
  STRATUS_LOOK_STATE,   /* of the matter that fills the grid: temperature, salinity, pressure */
  STRATUS_LOOK_SIGNED,  /* departs from 0 in two directions: components of a velocity, tendencies, anomalies */
  STRATUS_LOOK_TRACER,  /* an amount that thins out by mixing: concentrations, aerosol, dust, chlorophyll. Its values may be lognormal. */
  STRATUS_LOOK_DECIBELS /* the logarithm of an amount, 10 for each decade: the reflectivity that a radar measures */
} stratus_look_kind;

/* Find out what a variable of a file is.
 * - name: the variable's; a path before it ("run1/qc") is ignored
 * - standard_name: of the CF conventions. It decides if it is known, then the unit, then the name
 * - units: of the values, as the CF conventions write them
 * - bright: 1 for a picture with a bright background, 0 for a dark one
 * - color_map: receives the name of a map for stratus_color_map_points(), or NULL if the kind is UNKNOWN. Large amounts differ most from
 *   the background
 * NULL and "" are no text. */
STRATUS_API stratus_look_kind stratus_look_kind_of(
  const char* name, const char* standard_name, const char* units, int bright, const char** color_map);

/* The values of a volume, or of its blocks. */
typedef struct stratus_look_values {
  double low, high;          /* of the finite values; low > high: there are none */
  double finite, not_finite; /* numbers of values */
} stratus_look_values;

/* Count the values of volumes that are blocks of one. A point that blocks share counts once.
 * - volumes: `count` views of one type, at least 1 */
STRATUS_API stratus_status stratus_look_count(
  stratus_context* context, const stratus_volume* volumes, int count, stratus_look_values* values);

typedef struct stratus_look_options {
  stratus_look_kind kind; /* default UNKNOWN */
  int logarithmic; /* 1: over the logarithm of the value, at most four decades. 0 (default): if the values are lognormal. -1: never. */
  /* The grid's axis 0..2 of columns whose optical depth is column_depth. -1 (default): there are none, and a ray through the shown values
   * has an optical depth of about 2. */
  int column_axis;
  double column_depth; /* > 0. Default 1.5. */
  /* NULL (default): the volume's own. Otherwise the world length along the column that each value stands for, one for each value of the
   * only volume. */
  const double* thickness;
  int unordered; /* 1: the values are in no spatial order, so that only their frequencies count. Default 0. */
} stratus_look_options;

STRATUS_API stratus_look_options stratus_look_options_default(void);

/* Points of opacity at most. */
#define STRATUS_LOOK_POINTS 40

/* An opacity for stratus_transfer, and the range of colours. */
typedef struct stratus_look {
  double opacity[80]; /* pairs of value and opacity */
  size_t opacity_count;
  double unit_distance;   /* world length to which `opacity` refers: the edge of a cube as large as a voxel, or less */
  double low, high;       /* values of the first and the last colour */
  int logarithmic;        /* 1: opacity and colours are over the logarithm of the value; low > 0 */
  stratus_look_kind kind; /* that of the options; if it is UNKNOWN or contradicts the values, the kind that they show */
  char reason[256];       /* a text for people */
} stratus_look;

/* Guess an opacity from the values.
 * - The 1/1000 of the values at each end is left out of the range if the range of the others is less than half as wide: these are outliers.
 * - SIGNED: opacity rises from 0 at the value 0 in both directions, up to the larger end of the range. Colours reach as far on both sides.
 *   Values of unknown kind are SIGNED if each side reaches at least a tenth as far as the other, and the most frequent value is within a
 *   tenth of the range's larger end around 0. Values on one side of 0 are never SIGNED.
 * - TRACER, and UNKNOWN if all values are above 0: lognormal values are drawn over the logarithm. Values are lognormal if the positive
 *   values of the range, without 1/1000 at each end, span at least two decades, and their median is in the middle third of that span, on
 * the logarithmic scale. A plume over a background, whose median is the background, is not. Otherwise a TRACER is like an AMOUNT.
 * - AMOUNT: transparent up to the most frequent value, the background, and in proportion to the amount above it. If the least value is
 *   above half of the largest, the values are a STATE.
 * - STATE: values that are more frequent than they would be if all were equally frequent are more transparent in proportion, down to 1/10.
 * - DECIBELS: a ramp over the four decades (40 dB) below the largest value.
 * - UNKNOWN: a ramp above the most frequent value, or below it if it is in the upper half of the range.
 * The ramps of UNKNOWN, SIGNED and DECIBELS rise slowly in their first 2/5, because values next to the background usually fill most of the
 * volume. The optical depth of columns is their mean, each weighted by its own depth, so that empty columns do not count. Of a volume of
 * more than 2^26 values, without `thickness`, every so manieth value along each axis is taken, about 2^24 in all. volumes and count: as of
 * stratus_look_count(). options: NULL for the defaults. */
STRATUS_API stratus_status stratus_look_guess(
  stratus_context* context, const stratus_volume* volumes, int count, const stratus_look_options* options, stratus_look* look);

/* Return the factor of heights that makes a flat box, lower than a tenth of its width, a fifth as high as it is wide, rounded to two
 * digits. Of other boxes, and of boxes without a height or a width, the factor is 1.
 * - bounds: xmin, xmax, ymin, ymax, zmin, zmax; NULL is a box without a height
 * - up: the axis of heights, 0..2; the width is the larger extent of the other two */
STRATUS_API double stratus_look_height_factor(const double bounds[6], int up);

#ifdef __cplusplus
}
#endif

#endif
