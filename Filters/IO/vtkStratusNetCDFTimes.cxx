// SPDX-License-Identifier: BSD-3-Clause
// The times of vtkStratusNetCDFModel: which dimensions are times, and their steps.
#include "vtkStratusNetCDFModel.h"
#include "vtkStratusText.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace {
bool IsTimesName(const std::string& text)
{
  static constexpr std::array<const char*, 16> names = { "t", "nt", "month", "months", "mon", "year", "years", "season", "day", "days",
    "hour", "hours", "date", "dates", "record", "step" };
  const std::string name = vtkStratusLowerCase(text);
  return name.find("time") != std::string::npos || std::find(names.begin(), names.end(), name) != names.end();
}

// Days from 1970-01-01 in the Gregorian calendar.
double DaysOf(int year, int month, int day)
{
  const int shifted = month > 2 ? year : year - 1; // years begin in March, so that leap days are at their ends
  const int era = (shifted >= 0 ? shifted : shifted - 399) / 400, of_era = shifted - era * 400;
  const int of_year = (153 * (month + (month > 2 ? -3 : 9)) + 2) / 5 + day - 1;
  return era * 146097.0 + of_era * 365 + of_era / 4 - of_era / 100 + of_year - 719468;
}

// Reads "2020-06-01", "2020-06-01_12:00:00", "2020-06-01T12:00:00.5Z". Returns false for other texts.
bool ReadMoment(const std::string& text, double& seconds)
{
  int year = 0, month = 0, day = 0, hour = 0, minute = 0, end = 0;
  double second = 0.0;
  if (std::sscanf(text.c_str(), "%4d-%2d-%2d%n", &year, &month, &day, &end) < 3 || month < 1 || month > 12 || day < 1 || day > 31) {
    return false;
  }
  const std::string rest = text.substr(static_cast<size_t>(end));
  if (!rest.empty() &&
    (std::string("_T ").find(rest[0]) == std::string::npos || std::sscanf(rest.c_str() + 1, "%2d:%2d:%lf", &hour, &minute, &second) < 1)) {
    return false;
  }
  seconds = DaysOf(year, month, day) * 86400.0 + hour * 3600.0 + minute * 60.0 + second;
  return true;
}

bool Ascend(const std::vector<double>& values)
{
  return std::adjacent_find(values.begin(), values.end(), [](double a, double b) { return !(b > a); }) == values.end();
}

std::vector<double> Counted(size_t count)
{
  std::vector<double> steps(count);
  for (size_t i = 0; i < count; ++i) {
    steps[i] = static_cast<double>(i);
  }
  return steps;
}
} // namespace

// The variable of numbers along a time, nullptr if there is none.
const vtkStratusNetCDFModel::Variable* vtkStratusNetCDFModel::TimeOf(int dimension) const
{
  const auto along = [dimension](
                       const Variable& one) { return one.Dimensions.size() == 1 && one.Dimensions[0] == dimension && one.HasNumbers(); };
  const auto is_time = [this](const Variable& one) {
    return this->Text(one, "units").find(" since ") != std::string::npos || this->Text(one, "standard_name") == "time" ||
      this->Text(one, "axis") == "T";
  };
  const Variable* own = this->CoordinateOf(dimension);
  if (own && along(*own) && (IsTimesName(own->BaseName()) || is_time(*own))) {
    return own;
  }
  const auto found = std::find_if(this->Variables.begin(), this->Variables.end(), // WRF's XTIME along the dimension Time
    [&](const Variable& one) { return along(one) && is_time(one); });
  return found == this->Variables.end() ? nullptr : &*found;
}

// The variable of texts along a time, nullptr if there is none.
const vtkStratusNetCDFModel::Variable* vtkStratusNetCDFModel::TextsOf(int dimension) const
{
  const auto found = std::find_if(this->Variables.begin(), this->Variables.end(), [this, dimension](const Variable& one) {
    const bool texts = one.Dimensions.size() == (one.Type == vtkStratusNetCDFText ? 1 : 2) &&
      (one.Type == vtkStratusNetCDFText || one.Type == vtkStratusNetCDFChar);
    return texts && one.Dimensions[0] == dimension &&
      (IsTimesName(one.BaseName()) || this->Text(one, "standard_name") == "time" || this->Text(one, "axis") == "T");
  });
  return found == this->Variables.end() ? nullptr : &*found;
}

bool vtkStratusNetCDFModel::IsTime(int dimension) const
{
  if (this->IsSelected(dimension)) {
    return false;
  }
  return this->TimeOf(dimension) || this->TextsOf(dimension) || (!this->CoordinateOf(dimension) && IsTimesName(this->NameOf(dimension)));
}

vtkStratusNetCDFModel::TimeSteps vtkStratusNetCDFModel::ReadTimes(int dimension) const
{
  const Variable* const time = this->TimeOf(dimension);
  const Variable* const texts = time ? nullptr : this->TextsOf(dimension);
  const size_t count = this->LengthOf(dimension);
  if (count == 0) {
    this->Fail("time '" + this->NameOf(dimension) + "' has no steps");
  }
  if (time) {
    const std::vector<double> times = this->ReadComplete(*time, "time");
    const std::string units = this->Text(*time, "units");
    if (Ascend(times)) {
      return { times, units, "", this->Text(*time, "calendar") };
    }
    if (units.find(" since ") == std::string::npos && this->Text(*time, "standard_name") != "time") {
      return { Counted(count), "", "; steps of time are counted from 0, because '" + time->Name + "' does not increase" };
    }
    for (size_t i = 1; i < times.size(); ++i) {
      if (!(times[i] > times[i - 1])) {
        this->Fail("time '" + time->Name + "' must increase: step " + std::to_string(i) + " is at " + vtkStratusNumberText(times[i]) +
          ", after " + vtkStratusNumberText(times[i - 1]));
      }
    }
  }
  if (texts) {
    const std::vector<std::string> moments = this->ReadTexts(*texts);
    std::vector<double> times(count, 0.0);
    bool all = true;
    for (size_t i = 0; i < count; ++i) {
      all = all && ReadMoment(moments[i], times[i]);
    }
    if (all && Ascend(times)) {
      const double first = times[0];
      std::transform(times.begin(), times.end(), times.begin(), [first](double one) { return one - first; });
      std::string since = moments[0];
      std::replace(since.begin(), since.end(), '_', ' ');
      return { times, "seconds since " + since, "" };
    }
    return { Counted(count), "", "; steps of time are counted from 0, because '" + texts->Name + "' is text, and not ascending moments" };
  }
  return { Counted(count), "", "; steps of time '" + this->NameOf(dimension) + "' are counted from 0, because it has no coordinates" };
}
