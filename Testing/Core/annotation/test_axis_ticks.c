/* SPDX-License-Identifier: BSD-3-Clause
 * Round numbers along axes, and how they are written. */
#include "structures.h"

#include "stratus/annotation.h"

#include <stdio.h>

static stratus_context* context;

static void assert_ticks(const stratus_axis* axis, int kilo, double low, double high, int most, const char* expected)
{
  stratus_axis_tick ticks[STRATUS_AXIS_TICKS];
  char found[STRATUS_AXIS_TICKS * (sizeof ticks->text + 1)] = "";
  int count = -1;
  assert_int_equal(stratus_axis_find_ticks(context, axis, kilo, low, high, most, ticks, &count), STRATUS_OK);
  assert_true(count >= 0 && count <= most);
  for (int i = 0; i < count; ++i) {
    assert_true(ticks[i].place >= low - 1e-6 * (high - low) && ticks[i].place <= high + 1e-6 * (high - low));
    assert_true(i == 0 || ticks[i].place > ticks[i - 1].place);
    strcat(strcat(found, i ? " " : ""), ticks[i].text);
  }
  if (strcmp(found, expected) != 0) {
    fail_msg("%g..%g: '%s', not '%s'", low, high, found, expected);
  }
}

static void numbers_are_round(void** state)
{
  (void)state;
  stratus_axis axis = stratus_axis_default();
  assert_ticks(&axis, 0, 0.0, 1.0, 6, "0 0.2 0.4 0.6 0.8 1");
  assert_ticks(&axis, 0, 0.0, 1.0, 5, "0 0.5 1");
  assert_ticks(&axis, 0, -1.0, 1.0, 4, "-1 0 1");
  assert_ticks(&axis, 0, 3.1, 3.4, 10, "3.1 3.15 3.2 3.25 3.3 3.35 3.4");
  assert_ticks(&axis, 0, 1.1, 1.9, 1, "");
  assert_ticks(&axis, 1, 0.0, 12e3, 4, "0 5 10"); /* m as km */
  assert_ticks(&axis, 0, 1e-9, 5e-9, 5, "1e-09 2e-09 3e-09 4e-09 5e-09");
  axis.scale = 1.0 / 1400.0; /* heights that are exaggerated have true numbers */
  assert_ticks(&axis, 0, 0.0, 1400.0 * 5000.0, 6, "0 1000 2000 3000 4000 5000");
  axis.scale = -1.0 / 1400.0; /* depths are above 0, and the deepest is lowest */
  assert_ticks(&axis, 0, -1400.0 * 5700.0, -1400.0 * 0.5, 4, "4000 2000");
}

static void degrees_have_hemispheres(void** state)
{
  (void)state;
  const double metres = 6371000.0 * 3.14159265358979323846 / 180.0; /* of a degree */
  stratus_axis axis = stratus_axis_default();
  axis.kind = STRATUS_AXIS_LONGITUDE;
  assert_ticks(&axis, 0, -180.0, 180.0, 5,
    "180\xc2\xb0 90\xc2\xb0W 0\xc2\xb0 90\xc2\xb0"
    "E 180\xc2\xb0");
  assert_ticks(&axis, 0, 0.0, 357.5, 8,
    "0\xc2\xb0 45\xc2\xb0"
    "E 90\xc2\xb0"
    "E 135\xc2\xb0"
    "E 180\xc2\xb0 135\xc2\xb0W 90\xc2\xb0W 45\xc2\xb0W");
  assert_ticks(&axis, 0, -63.1, -61.9, 3, "63\xc2\xb0W 62.5\xc2\xb0W 62\xc2\xb0W");
  assert_ticks(&axis, 0, 530.0, 545.0, 4,
    "170\xc2\xb0"
    "E 175\xc2\xb0"
    "E 180\xc2\xb0 175\xc2\xb0W");
  axis.kind = STRATUS_AXIS_LATITUDE;
  axis.scale = 1.0 / metres;
  assert_ticks(&axis, 0, -45.0 * metres, 45.0 * metres, 4, "30\xc2\xb0S 0\xc2\xb0 30\xc2\xb0N");
  assert_ticks(&axis, 0, 11.0 * metres, 13.0 * metres, 3, "11\xc2\xb0N 12\xc2\xb0N 13\xc2\xb0N");
}

static void levels_are_those_of_the_file(void** state)
{
  (void)state;
  /* Heights of the standard atmosphere, to metres. */
  static const double levels[] = { 111, 1000, 762, 925, 1457, 850, 3012, 700, 5574, 500, 9164, 300, 11784, 200, 16180, 100, 20576, 50 };
  stratus_axis axis = stratus_axis_default();
  axis.kind = STRATUS_AXIS_LEVELS;
  axis.levels = levels;
  axis.level_count = sizeof levels / sizeof *levels / 2;
  assert_ticks(&axis, 0, 0.0, 21000.0, 64, "1000 925 850 700 500 300 200 100 50");
  assert_ticks(&axis, 0, 0.0, 21000.0, 4, "1000 500 200 50"); /* 5250 m apart, 1000 first, then 500; 100 is too near to 200 */
  assert_ticks(&axis, 0, 0.0, 21000.0, 1, "1000");
  assert_ticks(&axis, 0, 1000.0, 10000.0, 64, "850 700 500 300");
}

static void refused(stratus_status status, const char* words)
{
  assert_int_equal(status, STRATUS_INVALID_ARGUMENT);
  if (!strstr(stratus_context_message(context), words)) {
    fail_msg("'%s' is not in the message '%s'", words, stratus_context_message(context));
  }
}

static void wrong_axes_are_refused(void** state)
{
  (void)state;
  stratus_axis axis = stratus_axis_default();
  stratus_axis_tick ticks[STRATUS_AXIS_TICKS];
  int count = 7;
  refused(stratus_axis_find_ticks(context, &axis, 0, 1.0, 1.0, 5, ticks, &count), "from 1 to 1");
  refused(stratus_axis_find_ticks(context, &axis, 0, 0.0, INFINITY, 5, ticks, &count), "from 0 to inf");
  refused(stratus_axis_find_ticks(context, &axis, 0, 0.0, 1.0, 0, ticks, &count), "0 ticks, must be 1..64");
  refused(stratus_axis_find_ticks(context, &axis, 0, 0.0, 1.0, 65, ticks, &count), "65 ticks, must be 1..64");
  refused(stratus_axis_find_ticks(context, NULL, 0, 0.0, 1.0, 5, ticks, &count), "NULL");
  axis.scale = 0.0;
  refused(stratus_axis_find_ticks(context, &axis, 0, 0.0, 1.0, 5, ticks, &count), "scale 0");
  axis = stratus_axis_default();
  axis.kind = (stratus_axis_kind)9;
  refused(stratus_axis_find_ticks(context, &axis, 0, 0.0, 1.0, 5, ticks, &count), "kind 9, must be 0..3");
  axis.kind = STRATUS_AXIS_LEVELS;
  refused(stratus_axis_find_ticks(context, &axis, 0, 0.0, 1.0, 5, ticks, &count), "an axis of levels has none");
  const double bad[] = { 0.0, NAN };
  axis.levels = bad;
  axis.level_count = 1;
  refused(stratus_axis_find_ticks(context, &axis, 0, 0.0, 1.0, 5, ticks, &count), "level 0");
  assert_int_equal(stratus_axis_find_ticks(NULL, &axis, 0, 0.0, 1.0, 5, ticks, &count), STRATUS_INVALID_ARGUMENT);
  assert_int_equal(count, 7);
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

int test_axis_ticks(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(numbers_are_round),
    cmocka_unit_test(degrees_have_hemispheres),
    cmocka_unit_test(levels_are_those_of_the_file),
    cmocka_unit_test(wrong_axes_are_refused),
  };
  return cmocka_run_group_tests(tests, make, destroy);
}
