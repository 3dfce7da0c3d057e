/* SPDX-License-Identifier: BSD-3-Clause
 * Shapes of opacity over the value, by the frequencies of values. */
#include "look_shapes.h"

#include <stdio.h>

/* The ramp has a knee, because values next to the background usually fill most of the volume and would hide the rest. */
#define KNEE_AT 0.4
#define KNEE_HEIGHT 0.15
/* The least height of the most frequent part of a state. */
#define STATE_LEAST 0.1
#define LOG_DECADES 1e-4

static void add_point(stratus_look_shape* shape, double value, double height)
{
  shape->value[shape->count] = value;
  shape->height[shape->count] = height;
  ++shape->count;
}

double stratus_look_height_at(const stratus_look_shape* shape, double value)
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

int stratus_look_largest_bin(const double* count, int bins)
{
  int largest = 0;
  for (int i = 1; i < bins; ++i) {
    largest = count[i] > count[largest] ? i : largest;
  }
  return largest;
}

void stratus_look_smooth(const stratus_look_histogram* h, double* count)
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

/* A ramp away from the background. */
void stratus_look_shape_ramp(const stratus_look_histogram* h, bool only_up, stratus_look_shape* shape, stratus_look* look)
{
  double count[STRATUS_LOOK_BINS];
  stratus_look_smooth(h, count);
  const bool bright = !only_up && stratus_look_largest_bin(count, h->bins) > h->bins / 2;
  for (int i = 0; i < h->bins / 2 && bright; ++i) {
    const double kept = count[i];
    count[i] = count[h->bins - 1 - i];
    count[h->bins - 1 - i] = kept;
  }
  const int peak = stratus_look_largest_bin(count, h->bins);
  /* If a single value is the background, the ramp starts right behind it. Integers are in the middle of their bins. */
  const double lone = h->count[stratus_look_largest_bin(h->count, h->bins)], width = stratus_look_bin_width(h);
  const double bins = fmin(lone > 0.5 * h->values.finite ? peak + 0.5 : end_of_background(count, h->bins, peak), h->bins - 1.0);
  const double low = h->values.low, high = h->values.high;
  const double from = fmin(fmax(bright ? h->last - bins * width : h->first + bins * width, low), high), to = bright ? low : high;
  /* Matter absorbs light in proportion to its amount. */
  const double bend = only_up ? KNEE_AT : KNEE_HEIGHT, knee = from + KNEE_AT * (to - from), middle = (peak + 0.5) * width;
  add_point(shape, low, bright ? 1.0 : 0.0);
  add_point(shape, bright ? knee : from, bright ? bend : 0.0);
  add_point(shape, bright ? from : knee, bright ? 0.0 : bend);
  add_point(shape, high, bright ? 0.0 : 1.0);
  look->low = bright ? low : from;
  look->high = bright ? from : high;
  snprintf(
    look->reason, sizeof look->reason, "background around %g, opacity 0 at %.4g", bright ? h->last - middle : h->first + middle, from);
}

/* From 0 in both directions. */
void stratus_look_shape_signed(const stratus_look_histogram* h, stratus_look_shape* shape, stratus_look* look)
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

void stratus_look_shape_decibels(const stratus_look_histogram* h, stratus_look_shape* shape, stratus_look* look)
{
  const double high = h->values.high, low = fmax(h->values.low, high + 10.0 * log10(LOG_DECADES));
  add_point(shape, low, 0.0);
  add_point(shape, low + KNEE_AT * (high - low), KNEE_HEIGHT);
  add_point(shape, high, 1.0);
  look->low = low;
  look->high = high;
  snprintf(look->reason, sizeof look->reason, "decibels, opacity 0 at %.4g", low);
}

/* Values that are more frequent than they would be if all were equally frequent are more transparent in proportion, so that each part of
 * the range has about the same share of the optical depth. Otherwise one water mass would hide all others. */
void stratus_look_shape_state(
  const stratus_look_histogram* h, const double share[STRATUS_LOOK_PARTS], stratus_look_shape* shape, stratus_look* look)
{
  const double width = (h->values.high - h->values.low) / STRATUS_LOOK_PARTS;
  double total = 0.0;
  for (int p = 0; p < STRATUS_LOOK_PARTS; ++p) {
    total += share[p];
  }
  for (int p = -1; p <= STRATUS_LOOK_PARTS; ++p) { /* the ends are as high as the middles of the first and last part */
    const int part = p < 0 ? 0 : p < STRATUS_LOOK_PARTS ? p : STRATUS_LOOK_PARTS - 1;
    const double value = p < 0 ? h->values.low : p < STRATUS_LOOK_PARTS ? h->values.low + (p + 0.5) * width : h->values.high;
    add_point(shape, value, fmax(STATE_LEAST, fmin(total / (STRATUS_LOOK_PARTS * share[part]), 1.0)));
  }
  look->low = h->values.low;
  look->high = h->values.high;
  snprintf(look->reason, sizeof look->reason, "fills the grid, rare values show most");
}

/* A ramp over the logarithm of the value. */
stratus_status stratus_look_shape_log(
  stratus_context* context, const stratus_look_histogram* h, double least, stratus_look_shape* shape, stratus_look* look)
{
  if (!(h->values.high > 0.0)) {
    return stratus_fail(
      context, STRATUS_INVALID_ARGUMENT, "logarithmic: the largest value is %g, there is no value above 0", h->values.high);
  }
  const double low = fmax(fmax(h->values.low, least), LOG_DECADES * h->values.high), decades = log(h->values.high / low);
  add_point(shape, fmin(0.0, low), 0.0);
  for (int i = 0; i <= STRATUS_LOOK_LOG_PIECES; ++i) {
    const double t = (double)i / STRATUS_LOOK_LOG_PIECES;
    add_point(shape, low * exp(t * decades),
      t < KNEE_AT ? t / KNEE_AT * KNEE_HEIGHT : KNEE_HEIGHT + (t - KNEE_AT) / (1.0 - KNEE_AT) * (1.0 - KNEE_HEIGHT));
  }
  look->low = low;
  look->high = h->values.high;
  snprintf(look->reason, sizeof look->reason, "over the logarithm: opacity 0 at %.4g", low);
  return STRATUS_OK;
}
