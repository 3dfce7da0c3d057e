/* SPDX-License-Identifier: BSD-3-Clause
 * The transfer function's own pieces. Their results are exact in double, because no table of samples is involved. */
#ifndef STRATUS_TRANSFER_PIECES_H
#define STRATUS_TRANSFER_PIECES_H

#include "stratus/volume.h"
#include "base.h"

/* ---- values of the function */

/* A piecewise linear function of a number. Piece i begins at x[i] with the value at[i], and rises or falls towards left[i+1], the limit
 * from below at x[i+1]. All values below x[0] have left[0], all from x[count-1] on have at[count-1]. */
typedef struct stratus_curve {
  size_t count, leaves;
  double *x, *at, *left;
  double (*extremes)[2]; /* heap of least and greatest of left[i] and at[i]: leaf i is extremes[leaves + i] */
} stratus_curve;

/* Where several points have one value, the last counts at that value and the first towards smaller values. Without clamping, opacity is 0
 * outside the points. */
typedef struct stratus_pieces {
  stratus_context* context;
  stratus_curve opacity, color[3];
} stratus_pieces;

stratus_status stratus_pieces_create(stratus_context* context, const stratus_transfer* transfer, stratus_pieces** pieces);
void stratus_pieces_destroy(stratus_pieces* pieces);
/* Return where x is between left and right, left <= x <= right, left < right: 0 at left, 1 at right, never outside 0..1. Differences of
 * large numbers may overflow, differences of their halves do not. */
static inline double stratus_part_between(double x, double left, double right)
{
  const double width = right - left;
  return isfinite(width) ? (x - left) / width : (0.5 * x - 0.5 * left) / (0.5 * right - 0.5 * left);
}
/* Returns the number of ascending x that are <= value. */
size_t stratus_points_until(const double* x, size_t count, double value);
/* The curve at x. */
double stratus_curve_at(const stratus_curve* curve, double x);
/* Gives the greatest lower and the least upper bound of the curve over the closed interval lo..hi, whose ends may be infinite. They are
 * INFINITY and -INFINITY if lo > hi. */
void stratus_curve_extremes(const stratus_curve* curve, double lo, double hi, double extremes[2]);

/* ---- values that show */

/* Intervals in ascending order, disjoint, ends included. Each holds at least one double. */
typedef struct stratus_intervals {
  int64_t count;
  double (*of)[2];
} stratus_intervals;

/* Finds the values of opacity above 0. The caller releases intervals->of. */
stratus_status stratus_transfer_intervals(stratus_context* context, const stratus_transfer* transfer, stratus_intervals* intervals);
/* Append lo..hi if lo <= hi. If there is no double between it and the last interval, lengthen that interval. */
void stratus_intervals_append(stratus_intervals* intervals, double lo, double hi);

/* ---- fetched values that show */

/* How values become the floats that traversal sees, see stratus_volume_fetch(). The float f is the value f + bias. If `wide` is set, f
 * also stands for all values that are fetched as f; if `integer` is set too, these are whole numbers. */
typedef struct stratus_fetching {
  double bias;
  bool wide, integer;
} stratus_fetching;

stratus_fetching stratus_volume_fetching(const stratus_volume* volume);
static inline double stratus_fetching_value(const stratus_fetching* fetching, float fetched)
{
  return (double)fetched + fetching->bias;
}
/* Number floats in their order, and back. */
int64_t stratus_float_rank(float number);
float stratus_float_of_rank(int64_t rank);
/* Returns the least float whose value is at least `value`; INFINITY if there is none. */
float stratus_fetching_above(const stratus_fetching* fetching, double value);

/* Intervals of floats in ascending order, disjoint, ends included, with a float between any two. */
typedef struct stratus_shown {
  int64_t count;
  float (*of)[2];
} stratus_shown;

/* Find the floats that a value of the intervals is fetched as, and the floats whose own value is in an interval, as interpolated values may
 * be. The caller frees shown->of. */
stratus_status stratus_shown_create(
  stratus_context* context, const stratus_fetching* fetching, const stratus_intervals* intervals, stratus_shown* shown);
/* The same for the values of opacity above 0. */
stratus_status stratus_shown_of_transfer(
  stratus_context* context, const stratus_fetching* fetching, const stratus_transfer* transfer, stratus_shown* shown);
/* Returns the number of intervals that end below `value`, which is the index of the interval that holds it if there is one. */
int64_t stratus_shown_below(const stratus_shown* shown, float value);
/* Returns whether an interval meets lo..hi, ends included. */
bool stratus_shown_meets(const stratus_shown* shown, float lo, float hi);

#endif
