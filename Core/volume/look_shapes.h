/* SPDX-License-Identifier: BSD-3-Clause
 * Shapes of opacity over the value, and columns of a grid that are measured by them. */
#ifndef STRATUS_LOOK_SHAPES_H
#define STRATUS_LOOK_SHAPES_H

#include "look_histogram.h"

/* Parts of the range of a state in which values are counted. */
enum { STRATUS_LOOK_PARTS = 12, STRATUS_LOOK_LOG_PIECES = 32 };

/* Heights 0..1 of the extinction over the value, linear between points. */
typedef struct stratus_look_shape {
  double value[STRATUS_LOOK_LOG_PIECES + 2], height[STRATUS_LOOK_LOG_PIECES + 2];
  int count;
} stratus_look_shape;

/* ---- look_shapes.c */

double stratus_look_height_at(const stratus_look_shape* shape, double value);
int stratus_look_largest_bin(const double* count, int bins);
void stratus_look_smooth(const stratus_look_histogram* histogram, double* count);
/* Each function adds the points of a shape, and sets range and reason of the look. A ramp leads away from the background. */
void stratus_look_shape_ramp(const stratus_look_histogram* histogram, bool only_up, stratus_look_shape* shape, stratus_look* look);
void stratus_look_shape_signed(const stratus_look_histogram* histogram, stratus_look_shape* shape, stratus_look* look);
/* Over the decades below the largest value, of which each has 10 units. */
void stratus_look_shape_decibels(const stratus_look_histogram* histogram, stratus_look_shape* shape, stratus_look* look);
/* share: of the parts of the range, in any unit. */
void stratus_look_shape_state(
  const stratus_look_histogram* histogram, const double share[STRATUS_LOOK_PARTS], stratus_look_shape* shape, stratus_look* look);
/* least: the value at which opacity is 0, unless that is less than the least value, or below four decades. */
stratus_status stratus_look_shape_log(
  stratus_context* context, const stratus_look_histogram* histogram, double least, stratus_look_shape* shape, stratus_look* look);

/* ---- look_columns.c */

/* World length of a step along a grid's axis, per unit of its coordinates. */
double stratus_look_world_step(const stratus_volume* volume, int axis);
/* The part of the range that a value is in. */
int stratus_look_part_of(const stratus_look_values* range, double value);
/* Measure all columns. sums: with a shape, [0] is the sum of the columns' lengths weighted by its heights, and [1] the sum of their
 * squares; without, the lengths of values by the parts of the range. Values out of the range are left out: some outliers would outweigh all
 * others. The sums do not depend on the number of threads. */
stratus_status stratus_look_measure_columns(stratus_context* context, const stratus_volume* volumes, int count,
  const stratus_look_options* options, const stratus_look_values* range, const stratus_look_shape* shape, double sums[STRATUS_LOOK_PARTS]);

#endif
