/* SPDX-License-Identifier: BSD-3-Clause
 * Round numbers along an axis, and how they are written. */
#include "axis_ticks.h"

#include <stdio.h>
#include <stdlib.h>

#define SLACK 1e-9 /* of a step: rounding of an axis' ends */

stratus_axis stratus_axis_default(void)
{
  const stratus_axis axis = { .scale = 1.0 };
  return axis;
}

double stratus_round_step(double least, bool degrees)
{
  static const double of_degrees[] = { 1.0, 2.0, 5.0, 10.0, 15.0, 30.0, 45.0, 60.0, 90.0 };
  for (size_t i = 0; degrees && least > 0.5 && i < sizeof of_degrees / sizeof *of_degrees; ++i) {
    if (of_degrees[i] >= least * (1.0 - 1e-12)) {
      return of_degrees[i];
    }
  }
  const double power = pow(10.0, floor(log10(least)));
  for (double factor = 1.0; factor < 9.0; factor = factor == 2.0 ? 5.0 : 2.0 * factor) {
    if (factor * power >= least * (1.0 - 1e-12)) {
      return factor * power;
    }
  }
  return 10.0 * power;
}

void stratus_number_text(double value, char text[32])
{
  snprintf(text, 32, "%.9g", fabs(value) < 1e-300 ? 0.0 : value);
}

static void degree_text(double value, bool longitude, char text[32])
{
  double at = longitude ? remainder(value, 360.0) : value;
  at = fabs(at) < 1e-9 ? 0.0 : at;
  const bool half_turn = longitude && fabs(fabs(at) - 180.0) < 1e-9;
  const char* side = at == 0.0 || half_turn ? "" : longitude ? (at < 0.0 ? "W" : "E") : at < 0.0 ? "S" : "N";
  snprintf(text, 32, "%.9g\xc2\xb0%s", fabs(at), side);
}

/* The largest power of ten, or 5 or 2 times one, that divides a number. */
static double roundness(double number)
{
  static const double factors[] = { 5.0, 2.0, 1.0 };
  if (number == 0.0) {
    return INFINITY;
  }
  for (int power = (int)floor(log10(fabs(number))); power > -9; --power) {
    for (int i = 0; i < 3; ++i) {
      const double unit = factors[i] * pow(10.0, power), count = number / unit;
      if (fabs(count) >= 1.0 - 1e-9 && fabs(count - round(count)) < 1e-6) {
        return unit;
      }
    }
  }
  return 0.0;
}

typedef struct level {
  double place, number, round;
} level;

static int by_roundness(const void* first, const void* second)
{
  const level *a = first, *b = second;
  return a->round != b->round ? (a->round < b->round ? 1 : -1) : (a->place > b->place) - (a->place < b->place);
}

static int by_place(const void* first, const void* second)
{
  const stratus_axis_tick *a = first, *b = second;
  return (a->place > b->place) - (a->place < b->place);
}

static stratus_status find_levels(
  stratus_context* context, const stratus_axis* axis, double low, double high, int most, stratus_axis_tick* ticks, int* count)
{
  void* memory = NULL;
  TRY(stratus_allocate(context, axis->level_count, sizeof(level), &memory));
  level* const levels = memory;
  const double apart = (high - low) / most, slack = SLACK * (high - low);
  for (size_t i = 0; i < axis->level_count; ++i) {
    levels[i].place = axis->levels[2 * i];
    levels[i].number = axis->levels[2 * i + 1];
    levels[i].round = roundness(levels[i].number);
  }
  qsort(levels, axis->level_count, sizeof(level), by_roundness);
  for (size_t i = 0; i < axis->level_count && *count < most; ++i) {
    const double place = levels[i].place;
    bool free = place >= low - slack && place <= high + slack;
    for (int t = 0; t < *count; ++t) {
      free = free && fabs(ticks[t].place - place) >= apart;
    }
    if (free) {
      ticks[*count].place = place;
      snprintf(ticks[*count].text, sizeof ticks[*count].text, "%.6g", levels[i].number);
      ++*count;
    }
  }
  stratus_release(context, memory);
  qsort(ticks, (size_t)*count, sizeof *ticks, by_place);
  return STRATUS_OK;
}

stratus_status stratus_axis_find_ticks(
  stratus_context* context, const stratus_axis* axis, int kilo, double low, double high, int most, stratus_axis_tick* ticks, int* count)
{
  if (!context) {
    return STRATUS_INVALID_ARGUMENT;
  }
  if (!axis || !ticks || !count) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "axis, ticks or count is NULL");
  }
  if (!(low < high) || !isfinite(low) || !isfinite(high)) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "an axis from %g to %g, ends must be finite and ascending", low, high);
  }
  if (most < 1 || most > STRATUS_AXIS_TICKS) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "%d ticks, must be 1..%d", most, STRATUS_AXIS_TICKS);
  }
  TRY(stratus_axis_check(context, axis));
  *count = 0;
  if (axis->kind == STRATUS_AXIS_LEVELS) {
    return find_levels(context, axis, low, high, most, ticks, count);
  }
  const double scale = axis->scale / (kilo ? 1000.0 : 1.0);
  const double first = fmin(low * scale, high * scale), last = fmax(low * scale, high * scale);
  const bool longitude = axis->kind == STRATUS_AXIS_LONGITUDE, degrees = longitude || axis->kind == STRATUS_AXIS_LATITUDE;
  double step = stratus_round_step((last - first) / most, degrees);
  if (floor(last / step + SLACK) - ceil(first / step - SLACK) + 1.0 > most) {
    step = stratus_round_step(step * 1.01, degrees);
  }
  const double begin = ceil(first / step - SLACK);
  for (int i = 0; i < most && (begin + i) * step <= last + SLACK * step; ++i) {
    const double number = (begin + i) * step;
    stratus_axis_tick* const tick = &ticks[*count];
    tick->place = number / scale;
    if (degrees) {
      degree_text(number, longitude, tick->text);
    } else {
      stratus_number_text(number, tick->text);
    }
    ++*count;
  }
  qsort(ticks, (size_t)*count, sizeof *ticks, by_place);
  return STRATUS_OK;
}

stratus_status stratus_axis_check(stratus_context* context, const stratus_axis* axis)
{
  if (axis->kind < STRATUS_AXIS_NUMBER || axis->kind > STRATUS_AXIS_LEVELS) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "an axis of kind %d, must be 0..%d", (int)axis->kind, (int)STRATUS_AXIS_LEVELS);
  }
  if (axis->kind != STRATUS_AXIS_LEVELS && (!isfinite(axis->scale) || axis->scale == 0.0)) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "an axis with scale %g, must be finite and not 0", axis->scale);
  }
  if (axis->kind == STRATUS_AXIS_LEVELS && (!axis->levels || axis->level_count < 1)) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "an axis of levels has none");
  }
  for (size_t i = 0; axis->kind == STRATUS_AXIS_LEVELS && i < 2 * axis->level_count; ++i) {
    if (!isfinite(axis->levels[i])) {
      return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "level %zu of an axis is not finite", i / 2);
    }
  }
  return STRATUS_OK;
}
