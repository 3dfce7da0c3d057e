/* SPDX-License-Identifier: BSD-3-Clause
 * Colour maps by name, from the table that cmake/make-color-maps writes. */
#include "stratus/color_map.h"

#include "base.h"
#include "color_maps.h"

#include <stdio.h>
#include <string.h>

#define PREFIX "cmo."
#define REVERSED "_r"

/* Maps of cmocean by the quantity that they are for. */
static const struct {
  const char* quantity;
  const char* name;
} quantities[] = { { "temperature", "thermal" }, { "salinity", "haline" }, { "sediment", "turbid" }, { "oxygen", "oxy" },
  { "depth", "deep" } };

static bool is_equal(const char* name, const char* text, size_t length)
{
  return strlen(name) == length && memcmp(name, text, length) == 0;
}

static const stratus_color_map* find_name(const char* text, size_t length)
{
  for (int i = 0; i < STRATUS_COLOR_MAPS; ++i) {
    if (is_equal(stratus_color_maps[i].name, text, length)) {
      return stratus_color_maps + i;
    }
  }
  return NULL;
}

/* A name without "cmo." is cmocean's where no other map has it. */
static const stratus_color_map* find_map(const char* text, size_t length)
{
  const stratus_color_map* found = find_name(text, length);
  for (int i = 0; i < STRATUS_COLOR_MAPS && !found; ++i) {
    const char* const name = stratus_color_maps[i].name;
    if (strncmp(name, PREFIX, strlen(PREFIX)) == 0 && is_equal(name + strlen(PREFIX), text, length)) {
      found = stratus_color_maps + i;
    }
  }
  for (size_t i = 0; i < sizeof quantities / sizeof *quantities && !found; ++i) {
    if (is_equal(quantities[i].quantity, text, length)) {
      found = find_map(quantities[i].name, strlen(quantities[i].name));
    }
  }
  return found;
}

const char* stratus_color_map_name(int number)
{
  if (number < 0 || number >= STRATUS_COLOR_MAPS) {
    return NULL;
  }
  const char* const name = stratus_color_maps[number].name;
  const bool prefixed = strncmp(name, PREFIX, strlen(PREFIX)) == 0;
  return prefixed && !find_name(name + strlen(PREFIX), strlen(name) - strlen(PREFIX)) ? name + strlen(PREFIX) : name;
}

static stratus_status fail_unknown(stratus_context* context, const char* name)
{
  char names[512] = "";
  size_t length = 0;
  for (int i = 0; i < STRATUS_COLOR_MAPS && length < sizeof names; ++i) {
    length += (size_t)snprintf(names + length, sizeof names - length, "%s%s", i > 0 ? ", " : "", stratus_color_map_name(i));
  }
  return stratus_fail(
    context, STRATUS_INVALID_ARGUMENT, "'%.64s' is no colour map, must be one of %s, or one of these with _r, reversed", name, names);
}

static int digit_of(char c)
{
  return c >= 'a' ? c - 'a' + 10 : c - '0';
}

stratus_status stratus_color_map_points(stratus_context* context, const char* name, double low, double high, double* points)
{
  if (!context) {
    return STRATUS_INVALID_ARGUMENT;
  }
  if (!name || !points) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "%s is NULL", name ? "points" : "name");
  }
  if (!isfinite(low) || !isfinite(high) || low > high) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "values %g to %g of a colour map, must be finite and in order", low, high);
  }
  const size_t length = strlen(name), suffix = strlen(REVERSED);
  const bool reversed = length > suffix && strcmp(name + length - suffix, REVERSED) == 0;
  const stratus_color_map* const map = find_map(name, reversed ? length - suffix : length);
  if (!map) {
    return fail_unknown(context, name);
  }
  const int last = STRATUS_COLOR_MAP_COLORS - 1;
  for (int i = 0; i <= last; ++i) {
    const int place = low == high ? STRATUS_COLOR_MAP_COLORS / 2 : i, row = reversed ? last - place : place;
    const double part = (double)i / last;
    points[4 * i] = i == last ? high : fmin(2.0 * (0.5 * low + part * (0.5 * high - 0.5 * low)), high); /* halves do not overflow */
    for (int c = 0; c < 3; ++c) {
      const char* const digits = map->digits + 6 * row + 2 * c;
      points[4 * i + 1 + c] = (16 * digit_of(digits[0]) + digit_of(digits[1])) / 255.0;
    }
  }
  return STRATUS_OK;
}
