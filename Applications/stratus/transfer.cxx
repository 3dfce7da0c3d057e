// SPDX-License-Identifier: BSD-3-Clause
#include "transfer.h"

#include "colors.h"

#include <algorithm>
#include <cmath>

namespace {

// Finds the end of the background: from its peak on, the first bin below 3/10 of the peak, or the floor of the valley before the next rise,
// whichever comes first.
size_t end_of_background(const std::vector<double>& count, size_t peak)
{
  size_t floor = peak;
  for (size_t i = peak + 1; i < count.size(); ++i) {
    if (count[i] < count[floor]) {
      floor = i;
    }
    if (count[i] < 0.3 * count[peak]) {
      return i;
    }
    if (count[i] > 1.5 * count[floor]) {
      return floor;
    }
  }
  return peak;
}

std::vector<double> smoothed(const std::vector<double>& count)
{
  const size_t reach = count.size() / 256;
  std::vector<double> result(count.size());
  for (size_t i = 0; i < count.size(); ++i) {
    const size_t from = i > reach ? i - reach : 0;
    const size_t to = std::min(i + reach + 1, count.size());
    for (size_t j = from; j < to; ++j) {
      result[i] += count[j] / static_cast<double>(to - from);
    }
  }
  return result;
}

// The ramp has a knee, because values next to the background usually fill most of the volume and would hide the rest.
const double knee_at = 0.4;
const double knee_height = 0.15;

double ramp(double t)
{
  return t < knee_at ? t / knee_at * knee_height : knee_height + (t - knee_at) / (1.0 - knee_at) * (1.0 - knee_height);
}

// Returns the opacity at the ramp's top with which a ray through the shown values collects an optical depth of about 2. `place` maps a
// value to its position on the ramp, 0..1.
template <class Place> double top_opacity(const cli::histogram& h, const Place& place)
{
  double weight = 0.0;
  double shown = 0.0;
  for (size_t i = 0; i < h.count.size(); ++i) {
    const double center = h.first + (static_cast<double>(i) + 0.5) * h.width();
    const double height = place(center);
    if (height > 0.0) {
      weight += ramp(std::min(height, 1.0)) * h.count[i];
      shown += h.count[i];
    }
  }
  if (shown <= 0.0) {
    return 0.5;
  }
  const double total = std::max(h.finite, 1.0);
  const double length = std::cbrt(h.finite + h.not_finite);
  const double footprint = std::pow(shown / total, 2.0 / 3.0);
  const double depth_at_one = weight / total * length / footprint;
  return std::min(std::max(1.0 - std::exp(-2.0 / std::max(depth_at_one, 1e-6)), 0.004), 0.9);
}
} // namespace

namespace cli {

stratus_transfer transfer::view() const
{
  stratus_transfer result = stratus_transfer_default();
  result.opacity = this->opacity.data();
  result.opacity_count = this->opacity.size() / 2;
  result.color = this->color.data();
  result.color_count = this->color.size() / 4;
  result.unit_distance = this->unit_distance;
  return result;
}

void transfer::color_at(double value, float rgb[3]) const
{
  const std::vector<double>& c = this->color;
  size_t at = 0;
  while (at + 8 < c.size() && c[at + 4] < value) {
    at += 4;
  }
  const size_t next = at + 4 < c.size() ? at + 4 : at;
  const double width = c[next] - c[at];
  const double part = width > 0.0 ? std::min(std::max((value - c[at]) / width, 0.0), 1.0) : 0.0;
  for (size_t i = 0; i < 3; ++i) {
    rgb[i] = static_cast<float>(c[at + 1 + i] + part * (c[next + 1 + i] - c[at + 1 + i]));
  }
}

void transfer::shown(double& low, double& high) const
{
  const size_t n = this->opacity.size() / 2;
  size_t first = 0;
  size_t last = n - 1;
  while (first + 1 < n && this->opacity[2 * first + 1] <= 0.0 && this->opacity[2 * first + 3] <= 0.0) {
    ++first;
  }
  while (last > first && this->opacity[2 * last + 1] <= 0.0 && this->opacity[2 * last - 1] <= 0.0) {
    --last;
  }
  low = this->opacity[2 * first];
  high = this->opacity[2 * last];
}

void guess_opacity(const histogram& h, transfer& result)
{
  if (h.count.size() < 2) { // no or only one value: a haze
    result.opacity = { h.low <= h.high ? h.low : 0.0, 0.05 };
    result.origin = "one value only: a haze";
    return;
  }
  std::vector<double> count = smoothed(h.count);
  const bool bright = std::max_element(count.begin(), count.end()) - count.begin() > static_cast<std::ptrdiff_t>(count.size() / 2);
  if (bright) {
    std::reverse(count.begin(), count.end());
  }
  const size_t peak = static_cast<size_t>(std::max_element(count.begin(), count.end()) - count.begin());
  // If a single value is the background, the ramp starts right behind it. Integers are in the middle of their bins.
  const double lone = *std::max_element(h.count.begin(), h.count.end());
  double bins = lone > 0.5 * h.finite ? static_cast<double>(peak) + 0.5 : static_cast<double>(end_of_background(count, peak));
  bins = std::min(bins, static_cast<double>(count.size()) - 1.0);
  double from = bright ? h.last - bins * h.width() : h.first + bins * h.width();
  from = std::min(std::max(from, h.low), h.high);
  const double to = bright ? h.low : h.high;
  const double top = top_opacity(h, [from, to](double value) { return (value - from) / (to - from); });
  const double knee = from + knee_at * (to - from);
  if (bright) {
    result.opacity = { to, top, knee, knee_height * top, from, 0.0, h.high, 0.0 };
  } else {
    result.opacity = { h.low, 0.0, from, 0.0, knee, knee_height * top, to, top };
  }
  const double middle = (static_cast<double>(peak) + 0.5) * h.width();
  result.origin = format("histogram: background around %g, opacity 0 at %.4g, %.3g at %.4g, %.3g at %.4g",
    bright ? h.last - middle : h.first + middle, from, knee_height * top, knee, top, to);
}

std::vector<double> parse_opacity(const std::string& text)
{
  std::vector<double> points;
  for (const std::string& point : split(text, ',')) {
    const std::vector<std::string> fields = split(point, ':');
    if (fields.size() != 2) {
      throw usage("--opacity: '" + point + "' is not value:alpha");
    }
    for (const std::string& field : fields) {
      points.push_back(number(field, "--opacity"));
    }
  }
  if (points.empty()) {
    throw usage("--opacity: no points");
  }
  return points;
}

// The lowest value of a logarithmic scale: four decades below the largest, or the lowest value if that is larger.
static double lowest_of_log(const histogram& h)
{
  if (!(h.high > 0.0)) {
    throw failure(format("--log: the largest value is %g, there is no value above 0", h.low <= h.high ? h.high : 0.0));
  }
  return std::max(h.low, 1e-4 * h.high);
}

// A straight ramp over the logarithm of the value.
static void guess_log_opacity(const histogram& h, transfer& result)
{
  constexpr int pieces = 32;
  const double low = lowest_of_log(h), decades = std::log(h.high / low);
  if (decades <= 0.0) {
    guess_opacity(h, result);
    return;
  }
  const double top = top_opacity(h, [=](double value) { return value > low ? std::log(value / low) / decades : 0.0; });
  result.opacity = { std::min(0.0, low), 0.0 };
  for (int i = 0; i <= pieces; ++i) {
    const double t = static_cast<double>(i) / pieces;
    result.opacity.push_back(low * std::exp(t * decades));
    result.opacity.push_back(ramp(t) * top);
  }
  result.origin = format("histogram, over the logarithm: opacity 0 at %.4g, %.3g at %.4g", low, top, h.high);
}

static void set_opacity(const volumes& all, const stratus_scene* scene, const options& o, double voxel, transfer& result)
{
  if (!o.opacity.empty()) {
    result.opacity = parse_opacity(o.opacity);
    result.origin = o.cloud ? "proportional to the water" : "as given";
  } else if (scene && !o.logarithmic) {
    result.opacity.assign(scene->transfer.opacity, scene->transfer.opacity + 2 * scene->transfer.opacity_count);
    result.origin = "the scene's own";
  } else {
    (o.logarithmic ? guess_log_opacity : guess_opacity)(histogram_of(all), result);
    for (size_t i = 1; i < result.opacity.size() && result.unit_distance != voxel; i += 2) { // the guess is per voxel edge
      result.opacity[i] = -std::expm1(result.unit_distance / voxel * std::log1p(-result.opacity[i]));
    }
  }
}

transfer make_transfer(const volumes& all, const stratus_scene* scene, const options& o)
{
  transfer result;
  const stratus_volume& volume = *all[0];
  const double* m = volume.matrix;
  const double bigger =
    std::fabs(m[0] * (m[5] * m[10] - m[6] * m[9]) - m[1] * (m[4] * m[10] - m[6] * m[8]) + m[2] * (m[4] * m[9] - m[5] * m[8]));
  const double voxel = std::cbrt(volume.spacing[0] * volume.spacing[1] * volume.spacing[2] * bigger);
  result.unit_distance = o.unit_distance > 0.0 ? o.unit_distance : scene ? scene->transfer.unit_distance : voxel;
  set_opacity(all, scene, o, voxel, result);
  result.shown(result.low, result.high);
  result.logarithmic = o.logarithmic;
  if (o.logarithmic && !(result.low > 0.0)) { // opacities that were given may begin at 0
    result.low = lowest_of_log(histogram_of(all));
    result.high = std::max(result.high, result.low);
  }
  if (o.color.empty() && scene && !o.logarithmic) {
    result.color.assign(scene->transfer.color, scene->transfer.color + 4 * scene->transfer.color_count);
  } else {
    const std::string name = o.color.empty() ? "storm" : o.color;
    const bool given = name.find(':') != std::string::npos;
    result.color = o.logarithmic && !given ? logarithmic_color(name, result.low, result.high) : parse_color(name, result.low, result.high);
  }
  return result;
}
} // namespace cli
