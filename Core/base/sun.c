/* SPDX-License-Identifier: BSD-3-Clause
 * The position of the sun by time and place. */
#include "stratus/cloud.h"

#include "base.h"

#include <ctype.h>
#include <stdio.h>
#include <string.h>

#define DAY 86400.0
#define RADIANS (3.14159265358979323846 / 180.0)

/* Returns the days from 1970-01-01 to a date of the Gregorian calendar. Years are counted from March, so that the leap day is the last. */
static long days_of(int year, int month, int day)
{
  const int y = month > 2 ? year : year - 1, m = (month + 9) % 12;
  const long of_year = (153L * m + 2) / 5 + day - 1;
  return 365L * y + y / 4 - y / 100 + y / 400 + of_year - 719468L;
}

static int days_in(int year, int month)
{
  static const int days[] = { 31, 28, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31 };
  return days[month - 1] + (month == 2 && (year % 4 == 0 && (year % 100 != 0 || year % 400 == 0)) ? 1 : 0);
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

stratus_status stratus_time_parse(stratus_context* context, const char* text, double* seconds)
{
  if (!context) {
    return STRATUS_INVALID_ARGUMENT;
  }
  if (!text || !seconds) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "%s is NULL", text ? "seconds" : "text");
  }
  const char* at = text;
  int year = 0, month = 0, day = 0;
  double clock = 0.0, zone = 0.0;
  bool good = read_number(&at, 4, 1, 9999, &year) && read_char(&at, "-") && read_number(&at, 2, 1, 12, &month) && read_char(&at, "-") &&
    read_number(&at, 2, 1, days_in(year, month), &day);
  if (good && *at && read_char(&at, "Tt _")) {
    good = read_clock(&at, &clock);
  }
  if (!good || !read_zone(&at, &zone) || *at) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT,
      "time '%.64s' is no moment like 2024-06-01, 2024-06-01 09:00, 2024-06-01T09:00:30Z or 2024-06-01 09:00 +02:00", text);
  }
  *seconds = DAY * (double)days_of(year, month, day) + clock - zone;
  return STRATUS_OK;
}

stratus_status stratus_sun_position(
  stratus_context* context, double seconds, double latitude, double longitude, double* azimuth, double* elevation)
{
  if (!context) {
    return STRATUS_INVALID_ARGUMENT;
  }
  if (!azimuth || !elevation) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "%s is NULL", azimuth ? "elevation" : "azimuth");
  }
  const double first = DAY * (double)days_of(1900, 1, 1), last = DAY * (double)days_of(2101, 1, 1);
  if (!(seconds >= first && seconds < last)) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "time %g s since 1970 is in the year %.0f, must be in 1900..2100", seconds,
      floor(1970.0 + seconds / (365.2425 * DAY)));
  }
  if (!(latitude >= -90.0 && latitude <= 90.0)) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "latitude %g degrees, must be in -90..90", latitude);
  }
  if (!(longitude >= -360.0 && longitude <= 360.0)) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "longitude %g degrees, must be in -360..360", longitude);
  }
  const double days = seconds / DAY - 10957.5; /* from 2000-01-01 12:00 */
  const double anomaly = (357.528 + 0.9856003 * days) * RADIANS, mean = 280.460 + 0.9856474 * days;
  const double ecliptic = (mean + 1.915 * sin(anomaly) + 0.020 * sin(2.0 * anomaly)) * RADIANS;
  const double obliquity = (23.439 - 0.0000004 * days) * RADIANS;
  const double ascension = atan2(cos(obliquity) * sin(ecliptic), cos(ecliptic)), declination = asin(sin(obliquity) * sin(ecliptic));
  /* Greenwich's sidereal time, hours: a day's turn and the share of a year's. */
  const double hours = fmod(seconds, DAY) / 3600.0, sidereal = 6.697375 + 0.0657098242 * days + hours;
  const double angle = (15.0 * sidereal + longitude) * RADIANS - ascension, place = latitude * RADIANS;
  const double height = sin(declination) * sin(place) + cos(declination) * cos(place) * cos(angle);
  const double east = -cos(declination) * sin(angle), north = sin(declination) * cos(place) - cos(declination) * sin(place) * cos(angle);
  const double turned = atan2(east, north) / RADIANS;
  *elevation = atan2(height, sqrt(east * east + north * north)) / RADIANS;
  *azimuth = turned < 0.0 ? fmod(turned + 360.0, 360.0) : turned;
  return STRATUS_OK;
}

stratus_status stratus_sun_direction(stratus_context* context, double azimuth, double elevation, int up, double direction[3])
{
  if (!context) {
    return STRATUS_INVALID_ARGUMENT;
  }
  if (!direction) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "direction is NULL");
  }
  if (!(azimuth >= -360.0 && azimuth <= 360.0)) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "azimuth of the sun %g degrees, must be in -360..360", azimuth);
  }
  if (!(elevation >= -90.0 && elevation <= 90.0)) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "elevation of the sun %g degrees, must be in -90..90", elevation);
  }
  if (up < 0 || up > 2) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "upward axis %d, must be in 0..2", up);
  }
  direction[up] = sin(elevation * RADIANS);
  direction[(up + 1) % 3] = cos(elevation * RADIANS) * sin(azimuth * RADIANS);
  direction[(up + 2) % 3] = cos(elevation * RADIANS) * cos(azimuth * RADIANS);
  return STRATUS_OK;
}
