/* SPDX-License-Identifier: BSD-3-Clause
 * The transfer function's own pieces: its extremes over an interval of values, and the values and the fetched floats that show. */
#include "transfer_pieces.h"

#include "volume.h"

#include <string.h>

/* ---------------------------------------------------------------- curves */

/* Adds a point. Of points of equal x, the first gives the limit from below, the last the value. */
static void add_point(stratus_curve* curve, double x, double value)
{
  if (curve->count > 0 && curve->x[curve->count - 1] == x) {
    curve->at[curve->count - 1] = value;
    return;
  }
  curve->x[curve->count] = x;
  curve->at[curve->count] = curve->left[curve->count] = value;
  ++curve->count;
}

static void widen(double extremes[2], double value)
{
  extremes[0] = value < extremes[0] ? value : extremes[0];
  extremes[1] = value > extremes[1] ? value : extremes[1];
}

static void fill_extremes(stratus_curve* curve)
{
  for (size_t i = 0; i < curve->leaves; ++i) {
    double* leaf = curve->extremes[curve->leaves + i];
    leaf[0] = INFINITY;
    leaf[1] = -INFINITY;
    if (i < curve->count) {
      widen(leaf, curve->at[i]);
      widen(leaf, curve->left[i]);
    }
  }
  for (size_t node = curve->leaves - 1; node > 0; --node) {
    memcpy(curve->extremes[node], curve->extremes[2 * node], sizeof *curve->extremes);
    widen(curve->extremes[node], curve->extremes[2 * node + 1][0]);
    widen(curve->extremes[node], curve->extremes[2 * node + 1][1]);
  }
}

static size_t leaves_of(size_t points)
{
  size_t leaves = 1;
  while (leaves < points) {
    leaves *= 2;
  }
  return leaves;
}

static size_t curve_doubles(size_t points)
{
  return 3 * points + 4 * leaves_of(points);
}

/* Lays an empty curve of at most `points` points out in *memory, and moves *memory behind it. */
static void lay_out(stratus_curve* curve, size_t points, double** memory)
{
  *curve = (stratus_curve){ .leaves = leaves_of(points), .x = *memory, .at = *memory + points, .left = *memory + 2 * points };
  curve->extremes = (double(*)[2])(*memory + 3 * points);
  *memory += curve_doubles(points);
}

static void fill_opacity(stratus_curve* curve, const stratus_transfer* transfer)
{
  const double(*point)[2] = (const double(*)[2])transfer->opacity;
  const size_t count = transfer->opacity_count;
  if (!transfer->clamp) {
    add_point(curve, point[0][0], 0.0);
  }
  for (size_t i = 0; i < count; ++i) {
    add_point(curve, point[i][0], point[i][1]);
  }
  if (!transfer->clamp) { /* beyond the last point, but not at it */
    const double beyond = nextafter(point[count - 1][0], INFINITY);
    add_point(curve, beyond, point[count - 1][1]);
    add_point(curve, beyond, 0.0);
  }
  fill_extremes(curve);
}

stratus_status stratus_pieces_create(stratus_context* context, const stratus_transfer* transfer, stratus_pieces** out)
{
  void* memory;
  const size_t opacities = transfer->opacity_count + 2, colors = transfer->color_count;
  TRY(stratus_allocate(
    context, sizeof(stratus_pieces) + (curve_doubles(opacities) + 3 * curve_doubles(colors)) * sizeof(double), 1, &memory));
  stratus_pieces* pieces = memory;
  double* at = (double*)(void*)(pieces + 1);
  pieces->context = context;
  lay_out(&pieces->opacity, opacities, &at);
  fill_opacity(&pieces->opacity, transfer);
  for (size_t c = 0; c < 3; ++c) {
    lay_out(&pieces->color[c], colors, &at);
    for (size_t i = 0; i < colors; ++i) {
      add_point(&pieces->color[c], transfer->color[4 * i], transfer->color[4 * i + 1 + c]);
    }
    fill_extremes(&pieces->color[c]);
  }
  *out = pieces;
  return STRATUS_OK;
}

void stratus_pieces_destroy(stratus_pieces* pieces)
{
  if (pieces) {
    stratus_release(pieces->context, pieces);
  }
}

size_t stratus_points_until(const double* x, size_t count, double value)
{
  size_t lo = 0, hi = count;
  while (lo < hi) {
    const size_t middle = (lo + hi) / 2;
    if (x[middle] <= value) {
      lo = middle + 1;
    } else {
      hi = middle;
    }
  }
  return lo;
}

/* The curve at x, of which `until` is stratus_points_until(). */
static double value_in(const stratus_curve* curve, double x, size_t until)
{
  if (until == 0) {
    return curve->left[0];
  }
  const size_t i = until - 1;
  if (until == curve->count) {
    return curve->at[i];
  }
  const double t = stratus_part_between(x, curve->x[i], curve->x[until]);
  return curve->at[i] + t * (curve->left[until] - curve->at[i]);
}

double stratus_curve_at(const stratus_curve* curve, double x)
{
  return value_in(curve, x, stratus_points_until(curve->x, curve->count, x));
}

void stratus_curve_extremes(const stratus_curve* curve, double lo, double hi, double extremes[2])
{
  extremes[0] = INFINITY;
  extremes[1] = -INFINITY;
  if (!(lo <= hi)) {
    return;
  }
  const size_t first = stratus_points_until(curve->x, curve->count, lo),
               beyond = stratus_points_until(curve->x, curve->count, hi); /* points in (lo, hi] */
  widen(extremes, value_in(curve, lo, first));
  widen(extremes, value_in(curve, hi, beyond));
  for (size_t a = curve->leaves + first, b = curve->leaves + beyond; a < b; a /= 2, b /= 2) {
    if (a % 2) {
      widen(extremes, curve->extremes[a][0]);
      widen(extremes, curve->extremes[a++][1]);
    }
    if (b % 2) {
      widen(extremes, curve->extremes[--b][0]);
      widen(extremes, curve->extremes[b][1]);
    }
  }
}

/* ---------------------------------------------------------------- values that show */

void stratus_intervals_append(stratus_intervals* intervals, double lo, double hi)
{
  if (!(lo <= hi)) {
    return;
  }
  if (intervals->count > 0 && lo <= nextafter(intervals->of[intervals->count - 1][1], INFINITY)) {
    intervals->of[intervals->count - 1][1] = fmax(hi, intervals->of[intervals->count - 1][1]);
    return;
  }
  intervals->of[intervals->count][0] = lo;
  intervals->of[intervals->count][1] = hi;
  ++intervals->count;
}

/* Of points of equal value, the last counts at that value and the first towards smaller values. */
static void append_opacity(stratus_intervals* list, const stratus_transfer* transfer)
{
  const double(*point)[2] = (const double(*)[2])transfer->opacity;
  const size_t count = transfer->opacity_count;
  if (transfer->clamp && point[0][1] > 0.0) {
    stratus_intervals_append(list, -INFINITY, nextafter(point[0][0], -INFINITY));
  }
  for (size_t i = 0; i < count; ++i) {
    const bool last = i + 1 == count, step = !last && point[i + 1][0] == point[i][0];
    if (!step && point[i][1] > 0.0) {
      stratus_intervals_append(list, point[i][0], point[i][0]);
    }
    if (!last && !step && (point[i][1] > 0.0 || point[i + 1][1] > 0.0)) {
      stratus_intervals_append(list, nextafter(point[i][0], INFINITY), nextafter(point[i + 1][0], -INFINITY));
    }
  }
  if (transfer->clamp && point[count - 1][1] > 0.0) {
    stratus_intervals_append(list, nextafter(point[count - 1][0], INFINITY), INFINITY);
  }
}

stratus_status stratus_transfer_intervals(stratus_context* context, const stratus_transfer* transfer, stratus_intervals* intervals)
{
  void* memory;
  TRY(stratus_allocate(context, 2 * transfer->opacity_count + 1, sizeof *intervals->of, &memory));
  *intervals = (stratus_intervals){ .of = memory };
  append_opacity(intervals, transfer);
  return STRATUS_OK;
}

/* ---------------------------------------------------------------- fetched values that show */

stratus_fetching stratus_volume_fetching(const stratus_volume* volume)
{
  return (stratus_fetching){
    .bias = stratus_volume_bias(volume), .wide = stratus_type_is_wide(volume->type), .integer = stratus_type_is_integer(volume->type)
  };
}

int64_t stratus_float_rank(float number)
{
  int32_t bits;
  memcpy(&bits, &number, sizeof bits);
  return bits < 0 ? INT64_C(-2147483648) - bits : bits;
}

float stratus_float_of_rank(int64_t rank)
{
  const int32_t bits = (int32_t)(rank < 0 ? INT64_C(-2147483648) - rank : rank);
  float number;
  memcpy(&number, &bits, sizeof number);
  return number;
}

float stratus_fetching_above(const stratus_fetching* fetching, double value)
{
  if (fetching->bias == 0.0) {
    return stratus_float_above(value);
  }
  /* The sum with the bias is rounded, and may be the same for very many floats. */
  int64_t lo = stratus_float_rank(-INFINITY), hi = stratus_float_rank(INFINITY);
  while (lo < hi) {
    const int64_t middle = lo + (hi - lo) / 2;
    if (stratus_fetching_value(fetching, stratus_float_of_rank(middle)) >= value) {
      hi = middle;
    } else {
      lo = middle + 1;
    }
  }
  return stratus_float_of_rank(lo);
}

/* Append lo..hi if lo <= hi, or lengthen the last interval if there is no float between. */
static void append_floats(stratus_shown* shown, float lo, float hi)
{
  if (!(lo <= hi)) {
    return;
  }
  if (shown->count > 0 && lo <= nextafterf(shown->of[shown->count - 1][1], INFINITY)) {
    float* last = shown->of[shown->count - 1];
    last[1] = hi > last[1] ? hi : last[1];
    return;
  }
  shown->of[shown->count][0] = lo;
  shown->of[shown->count][1] = hi;
  ++shown->count;
}

static void append_fetched(stratus_shown* shown, const stratus_fetching* fetching, double lo, double hi)
{
  float first = stratus_fetching_above(fetching, lo), last = stratus_fetching_above(fetching, hi);
  last = stratus_fetching_value(fetching, last) > hi ? nextafterf(last, -INFINITY) : last;
  if (fetching->bias != 0.0 && isfinite(last)) { /* the last of the floats that have this value */
    last = nextafterf(stratus_fetching_above(fetching, nextafter(hi, INFINITY)), -INFINITY);
  }
  if (fetching->wide) {
    const double least = fetching->integer ? ceil(lo) : lo, most = fetching->integer ? floor(hi) : hi;
    const float from = (float)(least - fetching->bias), to = (float)(most - fetching->bias);
    if (least <= most && !(first <= last)) {
      first = from;
      last = to;
    } else if (least <= most) { /* the two overlap: a float between them would be nearest to the values that are fetched beyond it */
      first = from < first ? from : first;
      last = to > last ? to : last;
    }
  }
  append_floats(shown, first, last);
}

stratus_status stratus_shown_create(
  stratus_context* context, const stratus_fetching* fetching, const stratus_intervals* intervals, stratus_shown* shown)
{
  void* memory;
  TRY(stratus_allocate(context, (size_t)intervals->count + 1, sizeof *shown->of, &memory));
  *shown = (stratus_shown){ .of = memory };
  for (int64_t i = 0; i < intervals->count; ++i) {
    append_fetched(shown, fetching, intervals->of[i][0], intervals->of[i][1]);
  }
  return STRATUS_OK;
}

stratus_status stratus_shown_of_transfer(
  stratus_context* context, const stratus_fetching* fetching, const stratus_transfer* transfer, stratus_shown* shown)
{
  stratus_intervals intervals;
  TRY(stratus_transfer_intervals(context, transfer, &intervals));
  const stratus_status status = stratus_shown_create(context, fetching, &intervals, shown);
  stratus_release(context, intervals.of);
  return status;
}

int64_t stratus_shown_below(const stratus_shown* shown, float value)
{
  int64_t lo = 0, hi = shown->count;
  while (lo < hi) {
    const int64_t middle = (lo + hi) / 2;
    if (shown->of[middle][1] < value) {
      lo = middle + 1;
    } else {
      hi = middle;
    }
  }
  return lo;
}

bool stratus_shown_meets(const stratus_shown* shown, float lo, float hi)
{
  const int64_t at = stratus_shown_below(shown, lo);
  return lo <= hi && at < shown->count && shown->of[at][0] <= hi;
}
