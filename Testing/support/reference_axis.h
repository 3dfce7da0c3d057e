/* SPDX-License-Identifier: BSD-3-Clause
 * The axes of a volume as the references see them. Along an axis without coordinates a place is an index coordinate; along one with
 * coordinates it is a coordinate itself, so that rays are straight in places. Private to the references. */
#ifndef STRATUS_TESTING_REFERENCE_AXIS_H
#define STRATUS_TESTING_REFERENCE_AXIS_H

#include "stratus.h"

#include <math.h>

/* The position of a place among the values of an axis. */
typedef struct reference_spot {
  int64_t cell;    /* the values before and behind are cell and cell + 1, as far as there is one */
  double fraction; /* position between them, 0..1 */
  int64_t nearest; /* the value whose box the place is in */
} reference_spot;

/* Returns the length of a place's unit along the axis, before direction and matrix. */
static inline double reference_axis_unit(const stratus_volume* v, int axis)
{
  return v->coordinates[axis] ? 1.0 : v->spacing[axis];
}

/* Returns the mean spacing of an axis. */
static inline double reference_axis_mean(const stratus_volume* v, int axis)
{
  const int64_t steps = v->dimensions[axis] - (v->cell_centered ? 0 : 1);
  return v->coordinates[axis] ? fabs(v->coordinates[axis][steps] - v->coordinates[axis][0]) / (double)steps : v->spacing[axis];
}

/* Returns the place of value i. */
static inline double reference_axis_place(const stratus_volume* v, int axis, int64_t i)
{
  const double* x = v->coordinates[axis];
  return !x ? (double)i : v->cell_centered ? 0.5 * (x[i] + x[i + 1]) : x[i];
}

/* Returns the place of the border between the boxes of value i - 1 and i; i = 0..dimensions. */
static inline double reference_axis_border(const stratus_volume* v, int axis, int64_t i)
{
  const double* x = v->coordinates[axis];
  const int64_t n = v->dimensions[axis];
  if (!x) {
    return (double)i - 0.5;
  }
  return v->cell_centered ? x[i] : i == 0 ? x[0] : i == n ? x[n - 1] : 0.5 * (x[i - 1] + x[i]);
}

/* Returns the place of the volume's end on one side. */
static inline double reference_axis_end(const stratus_volume* v, int axis, int side)
{
  const int64_t n = v->dimensions[axis];
  if (!v->coordinates[axis]) {
    return side ? (double)n - (v->cell_centered ? 0.5 : 1.0) : v->cell_centered ? -0.5 : 0.0;
  }
  return reference_axis_border(v, axis, side ? n : 0);
}

/* Returns the place of a position along the grid's axis, such as a crop plane. */
static inline double reference_axis_crop(const stratus_volume* v, int axis, double position)
{
  const double from = position - v->origin[axis];
  return v->coordinates[axis] ? from : from / v->spacing[axis] - (v->cell_centered ? 0.5 : 0.0);
}

/* Finds a place by bisection in the coordinates themselves. */
static inline reference_spot reference_axis_find(const stratus_volume* v, int axis, double place)
{
  const int64_t n = v->dimensions[axis];
  reference_spot spot = { 0, 0.0, 0 };
  if (!v->coordinates[axis]) {
    const double top = (double)(n - 1), q = place < 0.0 ? 0.0 : place > top ? top : place;
    spot.cell = (int64_t)q;
    spot.cell = spot.cell > n - 2 && n > 1 ? n - 2 : spot.cell;
    spot.fraction = q - (double)spot.cell;
    spot.nearest = (int64_t)floor(place + 0.5);
    spot.nearest = spot.nearest < 0 ? 0 : spot.nearest >= n ? n - 1 : spot.nearest;
    return spot;
  }
  const double sign = v->coordinates[axis][1] > v->coordinates[axis][0] ? 1.0 : -1.0;
  for (int64_t beyond = n > 1 ? n - 1 : 1; beyond - spot.cell > 1;) {
    const int64_t middle = (spot.cell + beyond) / 2;
    *(sign * reference_axis_place(v, axis, middle) <= sign * place ? &spot.cell : &beyond) = middle;
  }
  if (n > 1) {
    spot.nearest = spot.cell + (sign * reference_axis_border(v, axis, spot.cell + 1) <= sign * place);
    const double from = reference_axis_place(v, axis, spot.cell), to = reference_axis_place(v, axis, spot.cell + 1);
    spot.fraction = fmin(fmax((place - from) / (to - from), 0.0), 1.0);
  }
  return spot;
}

#endif
