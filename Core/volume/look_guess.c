/* SPDX-License-Identifier: BSD-3-Clause
 * Guesses a transfer function from the frequencies of values, and from what they are. */
#include "look_histogram.h"

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
/* The ramp has a knee, because values next to the background usually fill most of the volume and would hide the rest. */
#define KNEE_AT 0.4
#define KNEE_HEIGHT 0.15
/* Parts of the range of a state in which values are counted, and the least height of the most frequent. */
#define STATE_PARTS 12
#define STATE_LEAST 0.1
/* Optical depth of a ray through the shown values. */
#define RAY_DEPTH 2.0
#define MOST_OPACITY 0.98
/* Opacity follows 1 - exp(-x) in so many pieces between two points. */
#define PIECES 6
/* Shapes of more points need no pieces. */
#define MOST_SIMPLE 5
#define LOG_PIECES 32
#define LOG_DECADES 1e-4

/* Heights 0..1 of the extinction over the value, linear between points. */
typedef struct look_shape {
  double value[LOG_PIECES + 2], height[LOG_PIECES + 2];
  int count;
} look_shape;

static void add_point(look_shape* shape, double value, double height)
{
  shape->value[shape->count] = value;
  shape->height[shape->count] = height;
  ++shape->count;
}

static double height_at(const look_shape* shape, double value)
{
  int at = 0;
  while (at + 1 < shape->count && shape->value[at + 1] < value) {
    ++at;
  }
  if (value <= shape->value[0] || at + 1 == shape->count) {
    return value <= shape->value[0] ? shape->height[0] : shape->height[shape->count - 1];
  }
  const double width = shape->value[at + 1] - shape->value[at];
  return shape->height[at] + (width > 0.0 ? (value - shape->value[at]) / width : 1.0) * (shape->height[at + 1] - shape->height[at]);
}

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

static int largest_bin(const double* count, int bins)
{
  int largest = 0;
  for (int i = 1; i < bins; ++i) {
    largest = count[i] > count[largest] ? i : largest;
  }
  return largest;
}

static void smooth(const stratus_look_histogram* h, double* count)
{
  const int reach = h->bins / 256;
  for (int i = 0; i < h->bins; ++i) {
    const int from = i > reach ? i - reach : 0, to = i + reach + 1 < h->bins ? i + reach + 1 : h->bins;
    count[i] = 0.0;
    for (int j = from; j < to; ++j) {
      count[i] += h->count[j] / (to - from);
    }
  }
}

/* Finds the end of the background: from its peak on, the first bin below 3/10 of the peak, or the floor of the valley before the next rise,
 * whichever comes first. */
static int end_of_background(const double* count, int bins, int peak)
{
  int floor = peak;
  for (int i = peak + 1; i < bins; ++i) {
    floor = count[i] < count[floor] ? i : floor;
    if (count[i] < 0.3 * count[peak]) {
      return i;
    }
    if (count[i] > 1.5 * count[floor]) {
      return floor;
    }
  }
  return peak;
}

/* ---- shapes */

/* A ramp away from the background. */
static void shape_ramp(const stratus_look_histogram* h, bool only_up, look_shape* shape, stratus_look* look)
{
  double count[STRATUS_LOOK_BINS];
  smooth(h, count);
  const bool bright = !only_up && largest_bin(count, h->bins) > h->bins / 2;
  for (int i = 0; i < h->bins / 2 && bright; ++i) {
    const double kept = count[i];
    count[i] = count[h->bins - 1 - i];
    count[h->bins - 1 - i] = kept;
  }
  const int peak = largest_bin(count, h->bins);
  /* If a single value is the background, the ramp starts right behind it. Integers are in the middle of their bins. */
  const double lone = h->count[largest_bin(h->count, h->bins)], width = stratus_look_bin_width(h);
  const double bins = fmin(lone > 0.5 * h->values.finite ? peak + 0.5 : end_of_background(count, h->bins, peak), h->bins - 1.0);
  const double low = h->values.low, high = h->values.high;
  const double from = fmin(fmax(bright ? h->last - bins * width : h->first + bins * width, low), high), to = bright ? low : high;
  const double knee = from + KNEE_AT * (to - from), middle = (peak + 0.5) * width;
  add_point(shape, low, bright ? 1.0 : 0.0);
  add_point(shape, bright ? knee : from, bright ? KNEE_HEIGHT : 0.0);
  add_point(shape, bright ? from : knee, bright ? 0.0 : KNEE_HEIGHT);
  add_point(shape, high, bright ? 0.0 : 1.0);
  look->low = bright ? low : from;
  look->high = bright ? from : high;
  snprintf(
    look->reason, sizeof look->reason, "background around %g, opacity 0 at %.4g", bright ? h->last - middle : h->first + middle, from);
}

/* From 0 in both directions. */
static void shape_signed(const stratus_look_histogram* h, look_shape* shape, stratus_look* look)
{
  const double most = fmax(-h->values.low, h->values.high);
  add_point(shape, -most, 1.0);
  add_point(shape, -KNEE_AT * most, KNEE_HEIGHT);
  add_point(shape, 0.0, 0.0);
  add_point(shape, KNEE_AT * most, KNEE_HEIGHT);
  add_point(shape, most, 1.0);
  look->low = -most;
  look->high = most;
  snprintf(look->reason, sizeof look->reason, "two-sided, opacity 0 at 0");
}

/* Values that are more frequent than they would be if all were equally frequent are more transparent in proportion, so that each part of
 * the range has about the same share of the optical depth. Otherwise one water mass would hide all others. */
static void shape_state(const stratus_look_histogram* h, look_shape* shape, stratus_look* look)
{
  const double width = (h->values.high - h->values.low) / STATE_PARTS;
  double share[STATE_PARTS] = { 0.0 };
  for (int i = 0; i < h->bins; ++i) {
    const double part = (h->first + (i + 0.5) * stratus_look_bin_width(h) - h->values.low) / width;
    share[part < STATE_PARTS - 1 ? (int)part : STATE_PARTS - 1] += h->count[i] / h->values.finite;
  }
  add_point(shape, h->values.low, fmax(STATE_LEAST, fmin(1.0 / (STATE_PARTS * share[0]), 1.0)));
  for (int p = 0; p < STATE_PARTS; ++p) {
    add_point(shape, h->values.low + (p + 0.5) * width, fmax(STATE_LEAST, fmin(1.0 / (STATE_PARTS * share[p]), 1.0)));
  }
  add_point(shape, h->values.high, shape->height[STATE_PARTS]);
  look->low = h->values.low;
  look->high = h->values.high;
  snprintf(look->reason, sizeof look->reason, "fills the grid, rare values show most");
}

/* A ramp over the logarithm of the value. */
static stratus_status shape_log(stratus_context* context, const stratus_look_histogram* h, look_shape* shape, stratus_look* look)
{
  if (!(h->values.high > 0.0)) {
    return stratus_fail(
      context, STRATUS_INVALID_ARGUMENT, "logarithmic: the largest value is %g, there is no value above 0", h->values.high);
  }
  const double low = fmax(h->values.low, LOG_DECADES * h->values.high), decades = log(h->values.high / low);
  add_point(shape, fmin(0.0, low), 0.0);
  for (int i = 0; i <= LOG_PIECES; ++i) {
    const double t = (double)i / LOG_PIECES;
    add_point(shape, low * exp(t * decades),
      t < KNEE_AT ? t / KNEE_AT * KNEE_HEIGHT : KNEE_HEIGHT + (t - KNEE_AT) / (1.0 - KNEE_AT) * (1.0 - KNEE_HEIGHT));
  }
  look->low = low;
  look->high = h->values.high;
  snprintf(look->reason, sizeof look->reason, "over the logarithm: opacity 0 at %.4g", low);
  return STRATUS_OK;
}

/* Decides between the kind that is claimed and the kind that the values show. */
static stratus_look_kind kind_by_values(const stratus_look_histogram* h, stratus_look_kind claimed)
{
  const double low = h->values.low, high = h->values.high, most = fmax(-low, high);
  const bool sided = low < 0.0 && high > 0.0;
  if (claimed == STRATUS_LOOK_SIGNED) {
    return sided ? claimed : STRATUS_LOOK_UNKNOWN;
  }
  if (claimed == STRATUS_LOOK_AMOUNT) {
    return low > FILLS_GRID * high ? STRATUS_LOOK_STATE : claimed;
  }
  if (claimed == STRATUS_LOOK_UNKNOWN && sided && fmin(-low, high) >= TWO_SIDED * most) {
    double count[STRATUS_LOOK_BINS];
    smooth(h, count);
    const double common = h->first + (largest_bin(count, h->bins) + 0.5) * stratus_look_bin_width(h);
    return fabs(common) <= TWO_SIDED * most ? STRATUS_LOOK_SIGNED : claimed;
  }
  return claimed;
}

/* ---- optical depth */

/* World length of a step along a grid's axis, per unit of its coordinates. */
static double world_step(const stratus_volume* v, int axis)
{
  double square = 0.0;
  for (int r = 0; r < 3; ++r) {
    double part = 0.0;
    for (int c = 0; c < 3; ++c) {
      part += v->matrix[4 * r + c] * v->direction[3 * c + axis];
    }
    square += part * part;
  }
  return sqrt(square);
}

/* World length along the axis that the value at an index stands for. */
static double thickness_at(const stratus_volume* v, int axis, int64_t at)
{
  const double* const x = v->coordinates[axis];
  const int64_t last = v->dimensions[axis] - 1;
  if (!x) {
    return v->spacing[axis] * (v->cell_centered || last == 0 || (at > 0 && at < last) ? 1.0 : 0.5);
  }
  if (v->cell_centered) {
    return fabs(x[at + 1] - x[at]);
  }
  return 0.5 * fabs(x[at < last ? at + 1 : at] - x[at > 0 ? at - 1 : at]);
}

/* Adds up the columns' lengths, weighted by the heights of the shape, and their squares. Values out of the range are left out: some
 * outliers would outweigh all others. */
static void add_columns(const stratus_context* context, const stratus_volume* v, const stratus_look_options* o,
  const stratus_look_values* range, const look_shape* shape, double sums[2])
{
  const int axis = o->column_axis, a = (axis + 1) % 3, b = (axis + 2) % 3;
  const int64_t step[3] = { 1, v->dimensions[0], v->dimensions[0] * v->dimensions[1] };
  const double scale = o->thickness ? 1.0 : world_step(v, axis);
  double all = 0.0, all_squares = 0.0;
#pragma omp parallel for num_threads(context->threads) reduction(+ : all, all_squares)
  for (int64_t column = 0; column < v->dimensions[a] * v->dimensions[b]; ++column) {
    const int64_t base = column % v->dimensions[a] * step[a] + column / v->dimensions[a] * step[b];
    double length = 0.0;
    for (int64_t i = 0; i < v->dimensions[axis]; ++i) {
      double value;
      stratus_look_values_get(v, base + i * step[axis], 1, &value);
      const double thickness = o->thickness ? o->thickness[base + i * step[axis]] : scale * thickness_at(v, axis, i);
      length += value >= range->low && value <= range->high && isfinite(thickness) ? height_at(shape, value) * thickness : 0.0;
    }
    all += length;
    all_squares += length * length;
  }
  sums[0] += all;
  sums[1] += all_squares;
}

/* Returns the mean length of rays that meet something, weighted by the heights of the shape, if they are `length` long. Values are in no
 * order: what is shown is taken for one body. */
static double expected_length(const stratus_look_histogram* h, const look_shape* shape, double length)
{
  double weight = 0.0, shown = 0.0;
  for (int i = 0; i < h->bins; ++i) {
    const double height = height_at(shape, h->first + (i + 0.5) * stratus_look_bin_width(h));
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

/* Sets the opacity at height 1, and shortens the unit distance if it would be above MOST_OPACITY. Returns the optical depth of the unit
 * distance there, or -1 if opacity is linear between points. */
static double find_depth(stratus_context* context, const stratus_volume* volumes, int count, const stratus_look_options* o,
  const stratus_look_histogram* h, const look_shape* shape, double* unit, double* top)
{
  if (o->column_axis < 0) {
    const double length = expected_length(h, shape, cbrt(h->values.finite + h->values.not_finite)); /* in voxels */
    *top = length > 0.0 ? fmin(fmax(-expm1(-RAY_DEPTH / fmax(length, 1e-6)), 0.004), 0.9) : 0.5;
    return -1.0;
  }
  double sums[2] = { 0.0, 0.0 }, length = 0.0;
  if (o->unordered) {
    const double height =
      world_step(volumes, o->column_axis) * volumes->spacing[o->column_axis] * (double)volumes->dimensions[o->column_axis];
    length = expected_length(h, shape, height);
  } else {
    for (int n = 0; n < count; ++n) {
      add_columns(context, volumes + n, o, &h->values, shape, sums);
    }
    length = sums[0] > 0.0 ? sums[1] / sums[0] : 0.0;
  }
  const double most = -log1p(-MOST_OPACITY), depth = length > 0.0 ? o->column_depth * *unit / length : most;
  *unit *= depth > most ? most / depth : 1.0;
  *top = -expm1(-fmin(depth, most));
  return fmin(depth, most);
}

static void add_opacity(stratus_look* look, double value, double opacity)
{
  look->opacity[2 * look->opacity_count] = value;
  look->opacity[2 * look->opacity_count + 1] = opacity;
  ++look->opacity_count;
}

static void set_opacity(const look_shape* shape, double depth, double top, stratus_look* look)
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
static void describe_opacity(const look_shape* shape, stratus_look* look)
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
  if ((int)o->kind < STRATUS_LOOK_UNKNOWN || o->kind > STRATUS_LOOK_SIGNED) {
    return stratus_fail(
      context, STRATUS_INVALID_ARGUMENT, "kind %d, must be in %d..%d", (int)o->kind, STRATUS_LOOK_UNKNOWN, STRATUS_LOOK_SIGNED);
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

static stratus_status guess(stratus_context* context, const stratus_volume* volumes, int count, const stratus_look_options* o,
  const stratus_look_histogram* h, stratus_look* look)
{
  look_shape shape = { .count = 0 };
  look->unit_distance = voxel_edge(volumes);
  look->kind = kind_by_values(h, o->kind);
  if (o->logarithmic && !(h->values.high > 0.0 && h->values.low == h->values.high)) {
    TRY(shape_log(context, h, &shape, look));
  } else if (h->bins < 2) { /* no or only one value */
    look->low = look->high = h->bins ? h->values.low : 0.0;
    add_opacity(look, look->low, 0.05);
    snprintf(look->reason, sizeof look->reason, "one value only: a haze");
    return STRATUS_OK;
  } else if (look->kind == STRATUS_LOOK_SIGNED) {
    shape_signed(h, &shape, look);
  } else if (look->kind == STRATUS_LOOK_STATE) {
    shape_state(h, &shape, look);
  } else {
    shape_ramp(h, look->kind == STRATUS_LOOK_AMOUNT, &shape, look);
  }
  double top = 0.0;
  const double depth = find_depth(context, volumes, count, o, h, &shape, &look->unit_distance, &top);
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
  TRY(make_histogram(context, volumes, count, true, &histogram));
  const stratus_status status = guess(context, volumes, count, &o, histogram, &made);
  stratus_release(context, histogram);
  if (status == STRATUS_OK) {
    *look = made;
  }
  return status;
}
