/* SPDX-License-Identifier: BSD-3-Clause
 * Moments as text, and times of files by the calendars of the CF conventions: against a walk from day to day. */
#include "structures.h"

#include "stratus/calendar.h"

#include <stdio.h>

static stratus_context* context;

static void refused(stratus_status status, const char* words)
{
  assert_int_equal(status, STRATUS_INVALID_ARGUMENT);
  if (!strstr(stratus_context_message(context), words)) {
    fail_msg("'%s' is not in the message '%s'", words, stratus_context_message(context));
  }
}

static void moments_are_counted_from_1970(void** state)
{
  static const struct {
    const char* text;
    double seconds;
  } cases[] = { { "1970-01-01", 0.0 }, { "1970-01-01T00:00:01.5Z", 1.5 }, { "1969-12-31 23:59", -60.0 }, { "2000-03-01", 951868800.0 },
    { "2024-06-01 09:00", 1717232400.0 }, { "2024-06-01_09:00:00", 1717232400.0 }, { "2024-06-01T11:00:00+02:00", 1717232400.0 },
    { "2024-06-01 04:30 -0430", 1717232400.0 }, { "2024-6-1 9:0:0 UTC", 1717232400.0 }, { "2001-09-09 01:46:40", 1000000000.0 },
    { "1900-01-01", -2208988800.0 } };
  static const char* const bad[] = { "", "2024", "2024-13-01", "2024-02-30", "1900-02-29", "2024-06-01 25:00", "2024-06-01 09:61", "noon",
    "2024-06-01 09:00 home", "2024-06-01x", "0-01-01" };
  (void)state;
  double seconds = 7.0;
  for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i) {
    if (stratus_time_parse(context, cases[i].text, &seconds) != STRATUS_OK || seconds != cases[i].seconds) {
      fail_msg("'%s' is %.17g: %s", cases[i].text, seconds, stratus_context_message(context));
    }
  }
  for (size_t i = 0; i < sizeof bad / sizeof *bad; ++i) {
    refused(stratus_time_parse(context, bad[i], &seconds), "is no moment like 2024-06-01");
  }
}

/* The calendars' rules, as a person turns the leaves. */
typedef struct leaf {
  int year, month, day;
} leaf;

static bool leaps(const char* calendar, int year)
{
  const bool julian = strcmp(calendar, "julian") == 0 || (strcmp(calendar, "standard") == 0 && year < 1582);
  return strcmp(calendar, "all_leap") == 0 ||
    (strcmp(calendar, "noleap") != 0 && (julian ? year % 4 == 0 : year % 400 == 0 || (year % 4 == 0 && year % 100 != 0)));
}

static leaf turned(const char* calendar, leaf now)
{
  const bool short_month = now.month == 4 || now.month == 6 || now.month == 9 || now.month == 11;
  const int last = strcmp(calendar, "360_day") == 0 ? 30 : now.month == 2 ? (leaps(calendar, now.year) ? 29 : 28) : short_month ? 30 : 31;
  if (strcmp(calendar, "standard") == 0 && now.year == 1582 && now.month == 10 && now.day == 4) {
    now.day = 14;
  }
  ++now.day;
  if (now.day > last) {
    now.day = 1;
    now.month = now.month % 12 + 1;
    now.year += now.month == 1 ? 1 : 0;
  }
  return now;
}

static void every_day_of_every_calendar_is_the_one_after_the_last(void** state)
{
  static const char* const calendars[] = { "standard", "proleptic_gregorian", "julian", "noleap", "all_leap", "360_day" };
  (void)state;
  for (size_t c = 0; c < sizeof calendars / sizeof *calendars; ++c) {
    leaf now = { 1495, 1, 1 };
    for (int days = 0; now.year < 2105; ++days, now = turned(calendars[c], now)) {
      char expected[64], text[STRATUS_TIME_TEXT] = "";
      snprintf(expected, sizeof expected, "%04d-%02d-%02d 18:00", now.year, now.month, now.day);
      const stratus_status status = stratus_time_write(context, days + 0.75, "days since 1495-01-01", calendars[c], text);
      if (status != STRATUS_OK || strcmp(text, expected) != 0) {
        fail_msg("day %d of %s is '%s', not '%s': %s", days, calendars[c], text, expected, stratus_context_message(context));
      }
      double value = -1.0;
      assert_int_equal(stratus_time_value(context, text, "days since 1495-01-01", calendars[c], &value), STRATUS_OK);
      assert_true(value == days + 0.75);
    }
  }
}

static void times_of_files_are_moments(void** state)
{
  static const struct {
    double value;
    const char *units, *calendar, *text;
  } cases[] = { { 2.0, "hours since 2024-06-01 09:00", "", "2024-06-01 11:00" },
    { 40587.0, "days since 1858-11-17 00:00:00", NULL, "1970-01-01 00:00" }, /* the modified Julian day of 1970 */
    { 719164.0, "days since 1-1-1", "gregorian", "1970-01-01 00:00" },
    { 719162.0, "days since 1-1-1", "proleptic_gregorian", "1970-01-01 00:00" },
    { 13.0, "days since 1970-01-01", "julian", "1970-01-14 00:00" },
    { -1.0, "seconds since 2000-03-01", "standard", "2000-02-29 23:59:59" }, { -1.0, "d since 2000-03-01", "365_day", "2000-02-28 00:00" },
    { 29.0, "days since 2000-02-01", "366_day", "2000-03-01 00:00" }, { 0.0, "days since 2000-02-30", "360_day", "2000-02-30 00:00" },
    { 90.0, "minutes since 2000-01-01 00:00 +02:00", "standard", "1999-12-31 23:30" },
    { 1500.0, "ms since 2000-01-01", "standard", "2000-01-01 00:00:02" }, { 86399.6, "s since 1999-12-31", "standard", "2000-01-01 00:00" },
    { (double)(8000.0F + 1.0F / 24.0F), "days since 2000-01-01", "standard", "2021-11-26 01:00" },
    { (double)(1.0F / 3.0F), "hours since 2000-01-01", "standard", "2000-01-01 00:20" },
    { 3652058.0, "days since 1-1-1", "proleptic_gregorian", "9999-12-31 00:00" } };
  (void)state;
  for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i) {
    char text[STRATUS_TIME_TEXT] = "";
    const stratus_status status = stratus_time_write(context, cases[i].value, cases[i].units, cases[i].calendar, text);
    if (status != STRATUS_OK || strcmp(text, cases[i].text) != 0) {
      fail_msg("%g %s is '%s', not '%s': %s", cases[i].value, cases[i].units, text, cases[i].text, stratus_context_message(context));
    }
  }
}

static void other_units_and_calendars_are_refused(void** state)
{
  static const char* const units[] = { "", "hours", "hours since", "hours since noon", "months since 2001-01-01", "years since 2001-01-01",
    "m", "since 2001-01-01", "days since 2001-02-29", "days since 0-1-1" };
  (void)state;
  char text[STRATUS_TIME_TEXT] = "kept";
  double value = 7.0;
  for (size_t i = 0; i < sizeof units / sizeof *units; ++i) {
    refused(stratus_time_write(context, 1.0, units[i], "standard", text), "is no unit of time since a moment");
    refused(stratus_time_value(context, "2001-01-01", units[i], "standard", &value), "is no unit of time since a moment");
  }
  refused(stratus_time_write(context, 1.0, NULL, NULL, text), "units is NULL");
  refused(stratus_time_write(context, 1.0, "days since 2001-01-01", "none", text), "calendar 'none' is not known");
  refused(stratus_time_write(context, 1e9, "days since 2001-01-01", "", text), "is outside the years 1..9999");
  refused(stratus_time_write(context, -1.0, "days since 1-1-1", "noleap", text), "is outside the years 1..9999");
  refused(stratus_time_write(context, NAN, "days since 2001-01-01", "", text), "is outside the years 1..9999");
  refused(stratus_time_write(context, INFINITY, "days since 2001-01-01", "", text), "is outside the years 1..9999");
  refused(
    stratus_time_value(context, "2000-02-30", "days since 2001-01-01", "", &value), "'2000-02-30' is no moment of the calendar standard");
  refused(stratus_time_value(context, "2000-02-29", "days since 2001-01-01", "noleap", &value), "is no moment of the calendar noleap");
  assert_string_equal(text, "kept");
  assert_true(value == 7.0);
}

static void units_of_time_are_known(void** state)
{
  static const struct {
    const char* text;
    double seconds;
  } cases[] = { { "ms", 0.001 }, { "s", 1 }, { "seconds", 1 }, { "min", 60 }, { "minutes since 2001-01-01", 60 }, { "h", 3600 },
    { "hours", 3600 }, { "d", 86400 }, { "days since 2001-01-01", 86400 }, { "weeks", 604800 }, { "", 0 }, { "month", 0 }, { "m", 0 },
    { "hour2", 0 }, { " s", 0 } };
  (void)state;
  for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i) {
    if (stratus_time_unit(cases[i].text) != cases[i].seconds) {
      fail_msg("'%s' has %g seconds", cases[i].text, stratus_time_unit(cases[i].text));
    }
  }
  assert_true(stratus_time_unit(NULL) == 0.0);
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

int test_calendar(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(moments_are_counted_from_1970),
    cmocka_unit_test(every_day_of_every_calendar_is_the_one_after_the_last),
    cmocka_unit_test(times_of_files_are_moments),
    cmocka_unit_test(other_units_and_calendars_are_refused),
    cmocka_unit_test(units_of_time_are_known),
  };
  return cmocka_run_group_tests(tests, make, destroy);
}
