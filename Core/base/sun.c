/* SPDX-License-Identifier: BSD-3-Clause
 * The position of the sun by time and place. */
#include "stratus/cloud.h"

#include "base.h"

#define DAY 86400.0
#define FIRST_MOMENT (DAY * -25567.0) /* 1900-01-01 */
#define LAST_MOMENT (DAY * 47847.0)   /* 2101-01-01 */
#define RADIANS (3.14159265358979323846 / 180.0)

stratus_status stratus_sun_position(
  stratus_context* context, double seconds, double latitude, double longitude, double* azimuth, double* elevation)
{
  if (!context) {
    return STRATUS_INVALID_ARGUMENT;
  }
  if (!azimuth || !elevation) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "%s is NULL", azimuth ? "elevation" : "azimuth");
  }
  if (!(seconds >= FIRST_MOMENT && seconds < LAST_MOMENT)) {
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
