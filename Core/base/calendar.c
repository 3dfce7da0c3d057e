/* SPDX-License-Identifier: BSD-3-Clause
 * Moments as text by the calendars of the CF conventions. */
#include "stratus/calendar.h"

#include "base.h"

#include <ctype.h>
#include <stdio.h>
#include <string.h>

#define DAY 86400.0
/* Half a step of floats of 32 bits, relative to their value. */
#define FLOAT_STEP 6e-8

typedef enum calendar { STANDARD, GREGORIAN, JULIAN, NO_LEAP, ALL_LEAP, DAYS_360, CALENDARS } calendar;

/* Returns the days from 1970-01-01 to a date. Years are counted from March, so that the leap day is the last. */
static long days_since_1970(int year, int month, int day, bool julian)
{
  const int y = month > 2 ? year : year - 1, m = (month + 9) % 12;
  const long of_year = (153L * m + 2) / 5 + day - 1;
  return 365L * y + y / 4 + of_year - (julian ? 719470L : 719468L + y / 100 - y / 400);
}

static bool is_julian(calendar kind, int year, int month, int day)
{
  return kind == JULIAN || (kind == STANDARD && (year < 1582 || (year == 1582 && (month < 10 || (month == 10 && day < 15)))));
}

static int days_in(calendar kind, int year, int month)
{
  static const int days[] = { 31, 28, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31 };
  const bool leaps =
    kind == ALL_LEAP || (kind != NO_LEAP && year % 4 == 0 && (is_julian(kind, year, month, 1) || year % 100 != 0 || year % 400 == 0));
  return kind == DAYS_360 ? 30 : days[month - 1] + (month == 2 && leaps ? 1 : 0);
}

/* Returns the days from an origin of the calendar's own to a date. */
static long days_of(calendar kind, int year, int month, int day)
{
  if (kind == STANDARD || kind == GREGORIAN || kind == JULIAN) {
    return days_since_1970(year, month, day, is_julian(kind, year, month, day));
  }
  long days = (kind == DAYS_360 ? 360L : kind == ALL_LEAP ? 366L : 365L) * year + day - 1;
  for (int before = 1; before < month; ++before) {
    days += days_in(kind, year, before);
  }
  return days;
}

/* Finds the date of days since the calendar's origin. Returns false outside the years 1 to 9999. */
static bool date_of(calendar kind, double days, int* year, int* month, int* day)
{
  if (!(days >= (double)days_of(kind, 1, 1, 1) && days <= (double)days_of(kind, 9999, 12, days_in(kind, 9999, 12)))) {
    return false;
  }
  const long wanted = (long)days;
  int low = 1, high = 9999; /* the last year that doesn't begin later */
  while (low < high) {
    const int middle = (low + high + 1) / 2;
    if (days_of(kind, middle, 1, 1) <= wanted) {
      low = middle;
    } else {
      high = middle - 1;
    }
  }
  *year = low;
  for (*month = 12; *month > 1 && days_of(kind, *year, *month, 1) > wanted; --*month) {}
  *day = 1 + (int)(wanted - days_of(kind, *year, *month, 1));
  if (kind == STANDARD && *year == 1582 && *month == 10 && *day > 4) {
    *day += 10; /* the days that the reform left out */
  }
  return true;
}

/* Reads digits, at most `most` of them, as a number in low..high. */
static bool read_number(const char** at, int most, int low, int high, int* value)
{
  int digits = 0;
  for (*value = 0; digits < most && isdigit((unsigned char)**at); ++digits, ++*at) {
    *value = 10 * *value + (**at - '0');
  }
  return digits > 0 && *value >= low && *value <= high;
}

static bool read_char(const char** at, const char* any)
{
  const bool found = **at != '\0' && strchr(any, **at) != NULL;
  *at += found ? 1 : 0;
  return found;
}

/* Reads "09:00", "09:00:30", "09:00:30.5" or "09" as seconds. */
static bool read_clock(const char** at, double* seconds)
{
  int hour = 0, minute = 0, second = 0;
  double part = 0.0;
  if (!read_number(at, 2, 0, 24, &hour)) {
    return false;
  }
  if (read_char(at, ":")) {
    if (!read_number(at, 2, 0, 59, &minute) || (read_char(at, ":") && !read_number(at, 2, 0, 60, &second))) {
      return false;
    }
    double unit = 0.1;
    if (read_char(at, ".")) {
      for (; isdigit((unsigned char)**at); ++*at, unit *= 0.1) {
        part += unit * (**at - '0');
      }
    }
  }
  *seconds = 3600.0 * hour + 60.0 * minute + second + part;
  return *seconds <= DAY;
}

/* Reads "Z", "UTC", "+02:00" or "-0330" as the seconds that the zone is ahead of UTC; nothing is UTC. */
static bool read_zone(const char** at, double* seconds)
{
  *seconds = 0.0;
  while (read_char(at, " ")) {}
  if (strncmp(*at, "UTC", 3) == 0 || strncmp(*at, "GMT", 3) == 0) {
    *at += 3;
  } else if (!read_char(at, "Zz")) {
    const double sign = **at == '-' ? -1.0 : 1.0;
    int hour = 0, minute = 0;
    if (read_char(at, "+-")) {
      if (!read_number(at, 2, 0, 14, &hour)) {
        return false;
      }
      (void)read_char(at, ":");
      if (**at && !read_number(at, 2, 0, 59, &minute)) {
        return false;
      }
    }
    *seconds = sign * (3600.0 * hour + 60.0 * minute);
  }
  return true;
}

/* Reads a moment as seconds since the calendar's origin. */
static bool read_moment(calendar kind, const char* text, double* seconds)
{
  const char* at = text;
  int year = 0, month = 0, day = 0;
  double clock = 0.0, zone = 0.0;
  bool good = read_number(&at, 4, 1, 9999, &year) && read_char(&at, "-") && read_number(&at, 2, 1, 12, &month) && read_char(&at, "-") &&
    read_number(&at, 2, 1, days_in(kind, year, month), &day);
  if (good && *at && read_char(&at, "Tt _")) {
    good = read_clock(&at, &clock);
  }
  if (!good || !read_zone(&at, &zone) || *at) {
    return false;
  }
  *seconds = DAY * (double)days_of(kind, year, month, day) + clock - zone;
  return true;
}

stratus_status stratus_time_parse(stratus_context* context, const char* text, double* seconds)
{
  if (!context) {
    return STRATUS_INVALID_ARGUMENT;
  }
  if (!text || !seconds) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "%s is NULL", text ? "seconds" : "text");
  }
  double found = 0.0;
  if (!read_moment(GREGORIAN, text, &found)) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT,
      "time '%.64s' is no moment like 2024-06-01, 2024-06-01 09:00, 2024-06-01T09:00:30Z or 2024-06-01 09:00 +02:00", text);
  }
  *seconds = found;
  return STRATUS_OK;
}

double stratus_time_unit(const char* units)
{
  static const struct {
    const char* name;
    double seconds;
  } known[] = { { "s", 1 }, { "sec", 1 }, { "secs", 1 }, { "second", 1 }, { "seconds", 1 }, { "ms", 1e-3 }, { "msec", 1e-3 },
    { "millisecond", 1e-3 }, { "milliseconds", 1e-3 }, { "min", 60 }, { "mins", 60 }, { "minute", 60 }, { "minutes", 60 }, { "h", 3600 },
    { "hr", 3600 }, { "hrs", 3600 }, { "hour", 3600 }, { "hours", 3600 }, { "d", DAY }, { "day", DAY }, { "days", DAY },
    { "week", 7 * DAY }, { "weeks", 7 * DAY } };
  const size_t length = units ? strcspn(units, " ") : 0;
  for (size_t i = 0; length > 0 && i < sizeof known / sizeof *known; ++i) {
    if (strlen(known[i].name) == length && strncmp(units, known[i].name, length) == 0) {
      return known[i].seconds;
    }
  }
  return 0.0;
}

/* Finds the calendar, the unit in seconds, and the moment of the value 0, in seconds since the calendar's origin. */
static stratus_status find_origin(
  stratus_context* context, const char* units, const char* name, calendar* kind, double* unit, double* origin)
{
  static const char* const names[CALENDARS][2] = { { "standard", "gregorian" }, { "proleptic_gregorian", "" }, { "julian", "" },
    { "noleap", "365_day" }, { "all_leap", "366_day" }, { "360_day", "" } };
  if (!units) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "units is NULL");
  }
  const char* own = name && *name ? name : names[STANDARD][0];
  int found = 0;
  while (found < CALENDARS && strcmp(own, names[found][0]) != 0 && strcmp(own, names[found][1]) != 0) {
    ++found;
  }
  if (found == CALENDARS) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT,
      "calendar '%.64s' is not known: it is none of standard, proleptic_gregorian, julian, noleap, all_leap and 360_day", own);
  }
  *kind = (calendar)found;
  *unit = stratus_time_unit(units);
  const char* since = strstr(units, " since ");
  since = since ? since + 7 + strspn(since + 7, " ") : NULL;
  if (!(*unit > 0.0) || !since || !read_moment(*kind, since, origin)) {
    return stratus_fail(
      context, STRATUS_INVALID_ARGUMENT, "'%.64s' is no unit of time since a moment, such as hours since 2001-01-01", units);
  }
  return STRATUS_OK;
}

stratus_status stratus_time_write(
  stratus_context* context, double value, const char* units, const char* calendar_name, char text[STRATUS_TIME_TEXT])
{
  if (!context) {
    return STRATUS_INVALID_ARGUMENT;
  }
  if (!text) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "text is NULL");
  }
  calendar kind = STANDARD;
  double unit = 0.0, origin = 0.0;
  const stratus_status status = find_origin(context, units, calendar_name, &kind, &unit, &origin);
  if (status != STRATUS_OK) {
    return status;
  }
  double seconds = origin + unit * value;
  const double minute = 60.0 * floor(seconds / 60.0 + 0.5);
  seconds = fabs(seconds - minute) <= FLOAT_STEP * fabs(unit * value) + 1e-3 ? minute : floor(seconds + 0.5);
  const double days = floor(seconds / DAY);
  int year = 0, month = 0, day = 0;
  if (!date_of(kind, days, &year, &month, &day)) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "the time %g %.64s is outside the years 1..9999", value, units);
  }
  const int clock = (int)(seconds - DAY * days);
  const int length = snprintf(text, STRATUS_TIME_TEXT, "%04d-%02d-%02d %02d:%02d", year, month, day, clock / 3600, clock / 60 % 60);
  if (clock % 60 != 0) {
    (void)snprintf(text + length, STRATUS_TIME_TEXT - (size_t)length, ":%02d", clock % 60);
  }
  return STRATUS_OK;
}

stratus_status stratus_time_value(stratus_context* context, const char* moment, const char* units, const char* calendar_name, double* value)
{
  if (!context) {
    return STRATUS_INVALID_ARGUMENT;
  }
  if (!moment || !value) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "%s is NULL", moment ? "value" : "moment");
  }
  calendar kind = STANDARD;
  double unit = 0.0, origin = 0.0, seconds = 0.0;
  const stratus_status status = find_origin(context, units, calendar_name, &kind, &unit, &origin);
  if (status != STRATUS_OK) {
    return status;
  }
  if (!read_moment(kind, moment, &seconds)) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "time '%.64s' is no moment of the calendar %.64s, like 2024-06-01 09:00", moment,
      calendar_name && *calendar_name ? calendar_name : "standard");
  }
  *value = (seconds - origin) / unit;
  return STRATUS_OK;
}
