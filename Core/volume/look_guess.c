/* SPDX-License-Identifier: BSD-3-Clause
 * Guesses a transfer function from the frequencies of values and the kind of the variable. */
#include "look_sample.h"
#include "look_shapes.h"
#include "volume_kept.h"

#include <stdio.h>
#include <string.h>

/* The values at each end of the range that may be outliers, as a share of the finite ones, and the least share of the range that they take
 * up if they are. */
#define OUTLIERS 1e-3
#define OUTLIERS_RANGE 0.5
/* Two-sided values reach at least this share of the larger side on the other, and are this near to 0 most often. Schemes of advection
 * undershoot 0 by some per cent, which is no second side. */
#define TWO_SIDED 0.1
/* Amounts that are nowhere below this share of the largest fill the grid. */
#define FILLS_GRID 0.5
/* Optical depth of a ray through the shown values. */
#define RAY_DEPTH 2.0
#define MOST_OPACITY 0.98
/* Opacity follows 1 - exp(-x) in so many pieces between two points. */
#define PIECES 6
/* Shapes of more points need no pieces. */
#define MOST_SIMPLE 5

/* ---- the range and the background */

/* Finds the edges of the bins between which all values are but a share of OUTLIERS at each end. */
static void trimmed_range(const stratus_look_histogram* h, double range[2])
{
  const double most = OUTLIERS * h->values.finite;
  int from = 0, to = h->bins;
  double below = 0.0, above = 0.0;
  while (from + 1 < to && below + h->count[from] <= most) {
    below += h->count[from++];
  }
  while (to - 1 > from && above + h->count[to - 1] <= most) {
    above += h->count[--to];
  }
  range[0] = h->first + from * stratus_look_bin_width(h);
  range[1] = h->first + to * stratus_look_bin_width(h);
}

/* Counts again without outliers, as long as they take up much of the range. */
static stratus_status leave_out_outliers(stratus_context* context, const stratus_volume* volumes, int count,
  const stratus_look_shared* shared, size_t shared_count, stratus_look_histogram* h)
{
  void* memory = NULL;
  stratus_status status = STRATUS_OK;
  TRY(stratus_allocate(context, 1, sizeof(stratus_look_histogram), &memory));
  stratus_look_histogram* const other = memory;
  for (bool again = true; again && h->bins > 1;) {
    double range[2];
    trimmed_range(h, range);
    again = range[1] - range[0] < (1.0 - OUTLIERS_RANGE) * (h->last - h->first);
    if (again) {
      TRY_CLEANUP(stratus_look_histogram_make(context, volumes, count, shared, shared_count, range, other));
      again = other->bins > 1; /* otherwise what is left out is all that there is to see */
    }
    if (again) {
      *h = *other;
    }
  }
cleanup:
  stratus_release(context, memory);
  return status;
}

/* Decides between the kind that is claimed and the kind that the values show. */
static stratus_look_kind kind_by_values(const stratus_look_histogram* h, stratus_look_kind claimed)
{
  const double low = h->values.low, high = h->values.high, most = fmax(-low, high);
  const bool sided = low < 0.0 && high > 0.0;
  if (claimed == STRATUS_LOOK_SIGNED) {
    return sided ? claimed : STRATUS_LOOK_UNKNOWN;
  }
  if (claimed == STRATUS_LOOK_AMOUNT || claimed == STRATUS_LOOK_TRACER) {
    return low > FILLS_GRID * high ? STRATUS_LOOK_STATE : claimed;
  }
  if (claimed == STRATUS_LOOK_UNKNOWN && sided && fmin(-low, high) >= TWO_SIDED * most) {
    double count[STRATUS_LOOK_BINS];
    stratus_look_smooth(h, count);
    const double common = h->first + (stratus_look_largest_bin(count, h->bins) + 0.5) * stratus_look_bin_width(h);
    return fabs(common) <= TWO_SIDED * most ? STRATUS_LOOK_SIGNED : claimed;
  }
  return claimed;
}

/* ---- optical depth */

/* Returns the mean length of rays that meet something, weighted by the heights of the shape, if they are `length` long. Values are in no
 * order: what is shown is taken for one body. */
static double expected_length(const stratus_look_histogram* h, const stratus_look_shape* shape, double length)
{
  double weight = 0.0, shown = 0.0;
  for (int i = 0; i < h->bins; ++i) {
    const double height = stratus_look_height_at(shape, h->first + (i + 0.5) * stratus_look_bin_width(h));
    weight += height * h->count[i];
    shown += height > 0.0 ? h->count[i] : 0.0;
  }
  const double total = fmax(h->values.finite, 1.0);
  return shown > 0.0 ? weight / total * length / pow(shown / total, 2.0 / 3.0) : 0.0;
}

/* Edge of a cube of the world as large as a voxel. */
static double voxel_edge(const stratus_volume* v)
{
  const double* m = v->matrix;
  const double bigger =
    fabs(m[0] * (m[5] * m[10] - m[6] * m[9]) - m[1] * (m[4] * m[10] - m[6] * m[8]) + m[2] * (m[4] * m[9] - m[5] * m[8]));
  return cbrt(v->spacing[0] * v->spacing[1] * v->spacing[2] * bigger);
}

/* Sets the optical depth of the unit distance at height 1, or -1 if opacity is linear between points, and the opacity there. Shortens the
 * unit distance if the opacity would be above MOST_OPACITY. */
static stratus_status find_depth(stratus_context* context, const stratus_volume* volumes, int count, const stratus_look_options* o,
  const stratus_look_histogram* h, const stratus_look_shape* shape, double* unit, double* depth, double* top)
{
  if (o->column_axis < 0) {
    const double length = expected_length(h, shape, cbrt(h->values.finite + h->values.not_finite)); /* in voxels */
    *depth = -1.0;
    *top = length > 0.0 ? fmin(fmax(-expm1(-RAY_DEPTH / fmax(length, 1e-6)), 0.004), 0.9) : 0.5;
    return STRATUS_OK;
  }
  double sums[STRATUS_LOOK_PARTS] = { 0.0 }, length = 0.0;
  if (o->unordered) {
    const double step = stratus_look_world_step(volumes, o->column_axis) * volumes->spacing[o->column_axis];
    length = expected_length(h, shape, step * (double)volumes->dimensions[o->column_axis]);
  } else {
    TRY(stratus_look_measure_columns(context, volumes, count, o, &h->values, shape, sums));
    length = sums[0] > 0.0 ? sums[1] / sums[0] : 0.0;
  }
  const double most = -log1p(-MOST_OPACITY), wanted = length > 0.0 ? o->column_depth * *unit / length : most;
  *unit *= wanted > most ? most / wanted : 1.0;
  *depth = fmin(wanted, most);
  *top = -expm1(-*depth);
  return STRATUS_OK;
}

static void add_opacity(stratus_look* look, double value, double opacity)
{
  look->opacity[2 * look->opacity_count] = value;
  look->opacity[2 * look->opacity_count + 1] = opacity;
  ++look->opacity_count;
}

static void set_opacity(const stratus_look_shape* shape, double depth, double top, stratus_look* look)
{
  look->opacity_count = 0;
  const int pieces = shape->count > MOST_SIMPLE ? 1 : PIECES;
  for (int i = 0; i < shape->count; ++i) {
    const double value = shape->value[i], height = shape->height[i];
    for (int piece = 1; piece < pieces && i > 0 && depth > 0.0 && height != shape->height[i - 1]; ++piece) {
      const double part = (double)piece / pieces, before = shape->value[i - 1];
      add_opacity(look, before + part * (value - before), -expm1(-depth * (shape->height[i - 1] + part * (height - shape->height[i - 1]))));
    }
    add_opacity(look, value, depth > 0.0 ? -expm1(-depth * height) : top * height);
  }
}

/* Names the opacities where the ramps bend and end. */
static void describe_opacity(const stratus_look_shape* shape, stratus_look* look)
{
  const int last = shape->count - 1;
  const bool down = shape->height[0] > shape->height[last], bends = shape->count == 4;
  const int named[2] = { down ? 1 : last - 1, down ? 0 : last };
  for (int i = bends ? 0 : 1; i < 2; ++i) {
    const double value = shape->value[named[i]];
    double opacity = 0.0;
    for (size_t k = 0; k < look->opacity_count; ++k) {
      opacity = look->opacity[2 * k] == value ? look->opacity[2 * k + 1] : opacity;
    }
    const size_t length = strlen(look->reason);
    snprintf(look->reason + length, sizeof look->reason - length, ", %.3g at %.4g", opacity, value);
  }
}

/* ---- public functions */

stratus_look_options stratus_look_options_default(void)
{
  return (stratus_look_options){ .kind = STRATUS_LOOK_UNKNOWN, .column_axis = -1, .column_depth = 1.5 };
}

static stratus_status check_volumes(stratus_context* context, const stratus_volume* volumes, int count)
{
  if (!volumes || count < 1) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, volumes ? "%d volumes, must be at least 1" : "volumes is NULL", count);
  }
  for (int n = 0; n < count; ++n) {
    TRY(stratus_volume_check(context, volumes + n));
    if (volumes[n].type != volumes->type) {
      return stratus_fail(
        context, STRATUS_INVALID_ARGUMENT, "volume %d is of type %d, must be of the first one's, %d", n, volumes[n].type, volumes->type);
    }
  }
  return STRATUS_OK;
}

static stratus_status check_options(stratus_context* context, const stratus_look_options* o, int count)
{
  if ((int)o->kind < STRATUS_LOOK_UNKNOWN || o->kind > STRATUS_LOOK_DECIBELS) {
    return stratus_fail(
      context, STRATUS_INVALID_ARGUMENT, "kind %d, must be in %d..%d", (int)o->kind, STRATUS_LOOK_UNKNOWN, STRATUS_LOOK_DECIBELS);
  }
  if (o->logarithmic < -1 || o->logarithmic > 1) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "logarithmic %d, must be in -1..1", o->logarithmic);
  }
  if (o->column_axis < -1 || o->column_axis > 2) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "axis of columns %d, must be in -1..2", o->column_axis);
  }
  if (!(o->column_depth > 0.0) || !isfinite(o->column_depth)) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "optical depth of columns %g, must be above 0 and finite", o->column_depth);
  }
  if (o->thickness && count != 1) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "thickness is for 1 volume, not %d", count);
  }
  return STRATUS_OK;
}

/* Makes the histogram, of which the caller releases the memory. */
static stratus_status make_histogram(
  stratus_context* context, const stratus_volume* volumes, int count, bool trims, stratus_look_histogram** histogram)
{
  stratus_look_shared* shared = NULL;
  void* memory = NULL;
  size_t shared_count = 0;
  stratus_status status = STRATUS_OK;
  *histogram = NULL;
  TRY_CLEANUP(stratus_look_find_shared(context, volumes, count, &shared, &shared_count));
  TRY_CLEANUP(stratus_allocate(context, 1, sizeof(stratus_look_histogram), &memory));
  TRY_CLEANUP(stratus_look_histogram_make(context, volumes, count, shared, shared_count, NULL, memory));
  if (trims) {
    TRY_CLEANUP(leave_out_outliers(context, volumes, count, shared, shared_count, memory));
  }
  *histogram = memory;
  memory = NULL;
cleanup:
  stratus_release(context, shared);
  stratus_release(context, memory);
  return status;
}

stratus_status stratus_look_count(stratus_context* context, const stratus_volume* volumes, int count, stratus_look_values* values)
{
  stratus_look_histogram* histogram = NULL;
  if (!context) {
    return STRATUS_INVALID_ARGUMENT;
  }
  if (!values) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "values is NULL");
  }
  TRY(check_volumes(context, volumes, count));
  TRY(make_histogram(context, volumes, count, false, &histogram));
  *values = histogram->values;
  stratus_release(context, histogram);
  return STRATUS_OK;
}

/* Counts the values in the parts of the range. Columns count lengths, because levels are often closer where more happens. */
static stratus_status count_parts(stratus_context* context, const stratus_volume* volumes, int count, const stratus_look_options* o,
  const stratus_look_histogram* h, double share[STRATUS_LOOK_PARTS])
{
  if (o->column_axis >= 0 && !o->unordered) {
    return stratus_look_measure_columns(context, volumes, count, o, &h->values, NULL, share);
  }
  for (int i = 0; i < h->bins; ++i) {
    share[stratus_look_part_of(&h->values, h->first + (i + 0.5) * stratus_look_bin_width(h))] += h->count[i];
  }
  return STRATUS_OK;
}

/* edge: of a cube of the world as large as a voxel. */
static stratus_status guess(stratus_context* context, const stratus_volume* volumes, int count, double edge, const stratus_look_options* o,
  const stratus_look_histogram* h, stratus_look* look)
{
  stratus_look_shape shape = { .count = 0 };
  look->unit_distance = edge;
  look->kind = kind_by_values(h, o->kind);
  const bool may_be = look->kind == STRATUS_LOOK_TRACER || look->kind == STRATUS_LOOK_UNKNOWN;
  const bool wanted = o->logarithmic > 0 && !(h->values.high > 0.0 && h->values.low == h->values.high);
  double least = 0.0;
  if (wanted ||
    (o->logarithmic == 0 && may_be && stratus_look_is_lognormal(context, volumes, count, h, look->kind == STRATUS_LOOK_TRACER, &least))) {
    look->logarithmic = 1;
    TRY(stratus_look_shape_log(context, h, least, &shape, look));
  } else if (h->bins < 2) { /* no or only one value */
    look->low = look->high = h->bins ? h->values.low : 0.0;
    add_opacity(look, look->low, 0.05);
    snprintf(look->reason, sizeof look->reason, "one value only: a haze");
    return STRATUS_OK;
  } else if (look->kind == STRATUS_LOOK_SIGNED) {
    stratus_look_shape_signed(h, &shape, look);
  } else if (look->kind == STRATUS_LOOK_DECIBELS) {
    stratus_look_shape_decibels(h, &shape, look);
  } else if (look->kind == STRATUS_LOOK_STATE) {
    double share[STRATUS_LOOK_PARTS] = { 0.0 };
    TRY(count_parts(context, volumes, count, o, h, share));
    stratus_look_shape_state(h, share, &shape, look);
  } else {
    stratus_look_shape_ramp(h, look->kind == STRATUS_LOOK_AMOUNT || look->kind == STRATUS_LOOK_TRACER, &shape, look);
  }
  double top = 0.0, depth = 0.0;
  TRY(find_depth(context, volumes, count, o, h, &shape, &look->unit_distance, &depth, &top));
  set_opacity(&shape, depth, top, look);
  describe_opacity(&shape, look);
  return STRATUS_OK;
}

stratus_status stratus_look_guess(
  stratus_context* context, const stratus_volume* volumes, int count, const stratus_look_options* options, stratus_look* look)
{
  const stratus_look_options o = options ? *options : stratus_look_options_default();
  stratus_look_histogram* histogram = NULL;
  stratus_look made = { .opacity_count = 0 };
  if (!context) {
    return STRATUS_INVALID_ARGUMENT;
  }
  if (!look) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "look is NULL");
  }
  TRY(check_volumes(context, volumes, count));
  TRY(check_options(context, &o, count));
  const bool samples = count == 1 && !o.thickness && stratus_look_samples(volumes);
  const double edge = voxel_edge(volumes), all = (double)stratus_volume_count(volumes);
  stratus_look_sample sample = { .memory = NULL };
  stratus_status status = STRATUS_OK;
  if (samples && stratus_kept_is_possible(volumes)) { /* the copy is taken while all values are read for these */
    stratus_value_range* ranges = NULL;
    TRY(stratus_value_range_create(context, volumes, 0, &ranges));
    stratus_value_range_destroy(ranges);
  }
  if (samples) {
    TRY(stratus_look_sample_make(context, volumes, &sample));
    volumes = &sample.view;
  }
  TRY_CLEANUP(make_histogram(context, volumes, count, true, &histogram));
  if (samples) {
    stratus_look_histogram_scale(histogram, all / (double)stratus_volume_count(&sample.view));
  }
  status = guess(context, volumes, count, edge, &o, histogram, &made);
cleanup:
  stratus_release(context, histogram);
  stratus_release(context, sample.memory);
  if (status == STRATUS_OK) {
    *look = made;
  }
  return status;
}
