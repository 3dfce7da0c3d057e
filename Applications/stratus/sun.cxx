// SPDX-License-Identifier: BSD-3-Clause
#include "sun.h"

#include "support.h"

#include <vtkDataSet.h>

#include <cmath>

namespace {

// Of --cloud where time or place is not known: degrees clockwise from north, and above the horizon.
constexpr double usual_azimuth = 120.0, usual_elevation = 40.0;
// A sun that is lower lights little, so that --cloud does not take it unasked.
constexpr double least_elevation = 5.0;
// Of the sphere on which the reader of netCDF puts longitudes and latitudes.
constexpr double earth_radius = 6371000.0;

// Returns whether a calendar counts days since a moment, seconds since 1970, as the Gregorian one does.
bool is_gregorian(const std::string& calendar, double since)
{
  constexpr double first_day = -12219292800.0; // 1582-10-15; before it the calendar "standard" is the Julian one
  return calendar == "proleptic_gregorian" ||
    ((calendar.empty() || calendar == "standard" || calendar == "gregorian") && since >= first_day);
}

// Finds a step's moment, seconds since 1970. Returns false if the file's times have no reference in the Gregorian calendar.
bool find_moment(const cli::series* in, size_t step, double& seconds)
{
  const std::string units = in ? in->units() : "";
  const size_t since = units.find(" since ");
  const double unit = stratus_time_unit(units.c_str());
  if (!in || in->times().empty() || since == std::string::npos || unit == 0.0) {
    return false;
  }
  const cli::context core("host", 1);
  const size_t at = units.find_first_not_of(' ', since + 7);
  if (at == std::string::npos || stratus_time_parse(core, units.c_str() + at, &seconds) != STRATUS_OK ||
    !is_gregorian(in->calendar(), seconds)) {
    return false;
  }
  seconds += unit * in->times()[step];
  return true;
}

// Finds latitude and longitude of the grid's middle. Returns false if its coordinates are none of a sphere.
bool find_place(const cli::series* in, vtkDataSet* grid, double& latitude, double& longitude)
{
  if (!in || !grid || in->axis_name(0) != "east" || in->axis_name(1) != "north") {
    return false;
  }
  const double degree = std::acos(-1.0) / 180.0, *bounds = grid->GetBounds();
  const double north = 0.5 * (bounds[2] + bounds[3]) / earth_radius,
               east = 0.5 * (bounds[0] + bounds[1]) / (earth_radius * std::cos(north));
  latitude = north / degree;
  longitude = std::remainder(east / degree, 360.0);
  return true;
}

std::string describe(const double* at)
{
  return cli::format("azimuth %.1f, elevation %.1f degrees", at[0], at[1]);
}
} // namespace

std::string cli::set_sun(options& o, const options& given, const series* in, vtkDataSet* grid, size_t step)
{
  const bool asked = !given.sun_time.empty(), chosen = given.cloud && !asked && given.suns.empty() && given.sun_at.empty();
  if (!asked && !chosen) {
    return "";
  }
  const context core("host", 1);
  double seconds = 0.0, place[2] = {};
  bool has_moment = false, has_place = true;
  if (asked && given.sun_time != "file") {
    core.check(stratus_time_parse(core, given.sun_time.c_str(), &seconds), "--sun-time");
    has_moment = true;
  } else {
    has_moment = find_moment(in, step, seconds);
  }
  if (given.place.size() == 2) {
    place[0] = given.place[0];
    place[1] = given.place[1];
  } else {
    has_place = find_place(in, grid, place[0], place[1]);
  }
  if (asked && !has_moment) {
    throw usage("--sun-time file: '" + o.source +
      "' has no times since a date of the Gregorian calendar: give the moment, such as --sun-time 2024-06-01T15:30");
  }
  if (asked && !has_place) {
    throw usage("--sun-time: '" + o.source + "' has no longitudes and latitudes: give --place LATITUDE,LONGITUDE");
  }
  double at[2] = { usual_azimuth, usual_elevation };
  if (has_moment && has_place) {
    core.check(stratus_sun_position(core, seconds, place[0], place[1], &at[0], &at[1]), asked ? "--sun-time" : "'" + o.source + "'");
    const std::string where = describe(at) + format(", at latitude %.2f, longitude %.2f", place[0], place[1]);
    if (asked && at[1] <= 0.0) {
      throw failure("--sun-time: the sun is below the horizon: " + where);
    }
    if (asked || at[1] >= least_elevation) {
      o.sun_at.assign(at, at + 2);
      return where;
    }
  }
  o.sun_at = { usual_azimuth, usual_elevation };
  return describe(o.sun_at.data()) +
    (has_moment && has_place ? ", because at the file's time and place it is " + format("%.1f degrees above the horizon", at[1])
                             : std::string(", as usual, because the file's ") + (has_place ? "time" : "place") + " is not known");
}
