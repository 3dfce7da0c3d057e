/* SPDX-License-Identifier: BSD-3-Clause
 * Colour maps: known bytes of their owners' maps, reversed maps, names, values of points, refusals. cmake/make-color-maps --check and
 * Testing/Python/test_color_map_bytes.py compare all bytes with the libraries. */
#include "structures.h"

#include "stratus/color_map.h"

#include <stdio.h>
#include <string.h>

static stratus_context* context;

static void get(const char* name, double low, double high, double* points)
{
  if (stratus_color_map_points(context, name, low, high, points) != STRATUS_OK) {
    fail_msg("%s", stratus_context_message(context));
  }
}

static void check_bytes(const char* name, int row, int red, int green, int blue)
{
  static double points[4 * STRATUS_COLOR_MAP_COLORS];
  const int expected[3] = { red, green, blue };
  get(name, 0.0, 1.0, points);
  for (int c = 0; c < 3; ++c) {
    if (points[4 * row + 1 + c] != expected[c] / 255.0) { /* a byte's share of 255, exactly */
      fail_msg("%s, row %d, colour %d: %.17g, not %d", name, row, c, 255.0 * points[4 * row + 1 + c], expected[c]);
    }
  }
}

/* As matplotlib 3.11, cmocean 3.0.3 and ParaView print them. */
static void maps_have_the_bytes_of_their_owners(void** state)
{
  (void)state;
  check_bytes("viridis", 0, 68, 1, 84);
  check_bytes("viridis", 128, 32, 144, 140);
  check_bytes("viridis", 255, 253, 231, 36);
  check_bytes("magma", 0, 0, 0, 3);
  check_bytes("magma", 128, 182, 54, 121);
  check_bytes("magma", 255, 251, 252, 191);
  check_bytes("inferno", 0, 0, 0, 3);
  check_bytes("inferno", 128, 187, 55, 84);
  check_bytes("inferno", 255, 252, 254, 164);
  check_bytes("plasma", 0, 12, 7, 134);
  check_bytes("plasma", 128, 203, 71, 119);
  check_bytes("plasma", 255, 239, 248, 33);
  check_bytes("cividis", 0, 0, 34, 77);
  check_bytes("cividis", 128, 124, 123, 120);
  check_bytes("cividis", 255, 253, 231, 55);
  check_bytes("turbo", 0, 48, 18, 59);
  check_bytes("turbo", 128, 164, 252, 59);
  check_bytes("turbo", 255, 122, 4, 2);
  check_bytes("coolwarm", 0, 58, 76, 192);
  check_bytes("coolwarm", 128, 221, 220, 219);
  check_bytes("coolwarm", 255, 179, 3, 38);
  check_bytes("thermal", 0, 3, 35, 51);
  check_bytes("thermal", 128, 176, 95, 129);
  check_bytes("thermal", 255, 231, 250, 90);
  check_bytes("haline", 0, 41, 24, 107);
  check_bytes("haline", 128, 59, 147, 135);
  check_bytes("haline", 255, 253, 238, 153);
  check_bytes("balance", 0, 23, 28, 66);
  check_bytes("balance", 128, 240, 236, 235);
  check_bytes("balance", 255, 60, 9, 17);
  check_bytes("matter", 0, 253, 237, 176);
  check_bytes("matter", 128, 206, 67, 86);
  check_bytes("matter", 255, 47, 15, 61);
  check_bytes("cool-warm", 0, 59, 76, 192);
  check_bytes("cool-warm", 255, 180, 4, 38);
  check_bytes("white", 77, 255, 255, 255);
}

static void reversed_maps_begin_with_the_last_color(void** state)
{
  static double points[4 * STRATUS_COLOR_MAP_COLORS], reversed[4 * STRATUS_COLOR_MAP_COLORS];
  (void)state;
  int count = 0;
  for (const char* name = NULL; (name = stratus_color_map_name(count)) != NULL; ++count) {
    char turned[64];
    snprintf(turned, sizeof turned, "%s_r", name);
    get(name, -3.0, 5.0, points);
    get(turned, -3.0, 5.0, reversed);
    for (int i = 0; i < STRATUS_COLOR_MAP_COLORS; ++i) {
      const int other = STRATUS_COLOR_MAP_COLORS - 1 - i;
      assert_true(points[4 * i] == reversed[4 * i]);
      assert_memory_equal(points + 4 * i + 1, reversed + 4 * other + 1, 3 * sizeof(double));
    }
  }
  assert_true(count > 30);
  assert_null(stratus_color_map_name(-1));
  assert_null(stratus_color_map_name(count));
}

static void other_names_are_the_maps_that_they_stand_for(void** state)
{
  static const char* const pairs[][2] = { { "cmo.thermal", "thermal" }, { "temperature", "thermal" }, { "salinity", "haline" },
    { "sediment_r", "cmo.turbid_r" }, { "oxygen", "oxy" }, { "depth", "deep" } };
  static double points[4 * STRATUS_COLOR_MAP_COLORS], other[4 * STRATUS_COLOR_MAP_COLORS];
  (void)state;
  for (size_t i = 0; i < sizeof pairs / sizeof *pairs; ++i) {
    get(pairs[i][0], 0.0, 1.0, points);
    get(pairs[i][1], 0.0, 1.0, other);
    assert_memory_equal(points, other, sizeof points);
  }
  get("gray", 0.0, 1.0, points); /* of matplotlib */
  get("cmo.gray", 0.0, 1.0, other);
  assert_memory_not_equal(points, other, sizeof points);
}

static void points_reach_from_the_first_value_to_the_last(void** state)
{
  static const double ranges[][2] = { { 0.1, 0.7 }, { -1e308, 1e308 }, { 273.15, 273.1500000001 }, { -5.0, -5.0 } };
  static double points[4 * STRATUS_COLOR_MAP_COLORS];
  (void)state;
  for (size_t r = 0; r < sizeof ranges / sizeof *ranges; ++r) {
    const double low = ranges[r][0], high = ranges[r][1];
    get("viridis", low, high, points);
    assert_true(points[0] == low && points[4 * (STRATUS_COLOR_MAP_COLORS - 1)] == high);
    for (int i = 1; i < STRATUS_COLOR_MAP_COLORS; ++i) {
      assert_true(points[4 * i] >= points[4 * (i - 1)]);
    }
  }
  for (int i = 0; i < STRATUS_COLOR_MAP_COLORS; ++i) { /* of one value */
    assert_true(points[4 * i] == -5.0 && points[4 * i + 1] == 32 / 255.0);
  }
}

static void refused(const char* name, double low, double high, const char* words)
{
  double points[4 * STRATUS_COLOR_MAP_COLORS] = { 7.0 };
  assert_int_equal(stratus_color_map_points(context, name, low, high, points), STRATUS_INVALID_ARGUMENT);
  assert_true(points[0] == 7.0);
  if (!strstr(stratus_context_message(context), words)) {
    fail_msg("'%s' is not in the message '%s'", words, stratus_context_message(context));
  }
}

static void unknown_maps_and_values_are_refused(void** state)
{
  (void)state;
  refused("viridi", 0, 1, "'viridi' is no colour map, must be one of viridis, magma");
  refused("viridi", 0, 1, "white, or one of these with _r");
  refused("", 0, 1, "'' is no colour map");
  refused("_r", 0, 1, "'_r' is no colour map");
  refused("viridis_r_r", 0, 1, "is no colour map");
  refused("cmo.viridis", 0, 1, "is no colour map");
  refused("Viridis", 0, 1, "is no colour map");
  refused("viridis", 1, 0, "values 1 to 0");
  refused("viridis", NAN, 0, "must be finite and in order");
  refused("viridis", 0, INFINITY, "must be finite and in order");
}

static int make(void** state)
{
  (void)state;
  context = make_context("host", 1);
  return 0;
}

static int destroy(void** state)
{
  (void)state;
  stratus_context_destroy(context);
  return 0;
}

int test_color_map(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(maps_have_the_bytes_of_their_owners),
    cmocka_unit_test(reversed_maps_begin_with_the_last_color),
    cmocka_unit_test(other_names_are_the_maps_that_they_stand_for),
    cmocka_unit_test(points_reach_from_the_first_value_to_the_last),
    cmocka_unit_test(unknown_maps_and_values_are_refused),
  };
  return cmocka_run_group_tests(tests, make, destroy);
}
