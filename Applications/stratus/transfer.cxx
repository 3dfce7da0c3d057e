// SPDX-License-Identifier: BSD-3-Clause
#include "transfer.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>

namespace {

struct color_map {
  const char* name;
  std::vector<double> points; // position 0..1, r, g, b
};

const std::vector<color_map>& color_maps()
{
  static const std::vector<color_map> maps = {
    { "storm", { 0, .06, .16, .42, .2, .12, .42, .72, .42, .55, .82, .88, .62, .98, .95, .80, .8, .98, .62, .22, 1, .80, .12, .12 } },
    { "cloud", { 0, .35, .45, .75, .5, .85, .9, .95, 1, 1, .95, .85 } },
    { "rainbow", { 0, .1, .2, .8, .5, .9, .9, .3, 1, .9, .1, .1 } },
    { "cool-warm", { 0, .23, .30, .75, .5, .87, .87, .87, 1, .71, .02, .15 } },
    { "viridis",
      { 0, .267, .005, .329, .2, .254, .265, .530, .4, .164, .471, .558, .6, .135, .659, .518, .8, .478, .821, .318, 1, .993, .906,
        .144 } },
    { "fire", { 0, .05, .0, .02, .35, .55, .06, .04, .65, .95, .45, .05, .88, 1, .88, .35, 1, 1, 1, .92 } },
    { "gray", { 0, 0, 0, 0, 1, 1, 1, 1 } },
    { "white", { 0, 1, 1, 1 } },
  };
  return maps;
}

template <class T> void count_values(const stratus_volume& volume, cli::histogram& h)
{
  const T* values = static_cast<const T*>(volume.values);
  const int64_t n = volume.dimensions[0] * volume.dimensions[1] * volume.dimensions[2];
  const int64_t stride = volume.value_stride;
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
#pragma omp parallel for reduction(min : low) reduction(max : high)
  for (int64_t i = 0; i < n; ++i) {
    const double value = static_cast<double>(values[i * stride]);
    if (std::isfinite(value)) {
      low = std::min(low, value);
      high = std::max(high, value);
    }
  }
  h.low = low;
  h.high = high;
  if (low > high) {
    h.not_finite = static_cast<double>(n);
    return;
  }
  // A range of few integers gets a bin for each, so that no bin mixes the background with what is drawn.
  const bool integers = std::numeric_limits<T>::is_integer && high - low < 1024.0;
  const size_t bins = low == high ? 1 : integers ? static_cast<size_t>(high - low) + 1 : 1024;
  h.first = integers ? low - 0.5 : low;
  h.last = integers ? high + 0.5 : high;
  const double scale = low == high ? 0.0 : static_cast<double>(bins) / (h.last - h.first);
  std::vector<int64_t> total(bins + 1, 0);
#pragma omp parallel
  {
    std::vector<int64_t> mine(bins + 1, 0);
#pragma omp for nowait
    for (int64_t i = 0; i < n; ++i) {
      const double value = static_cast<double>(values[i * stride]);
      ++mine[std::isfinite(value) ? std::min(static_cast<size_t>((value - h.first) * scale), bins - 1) : bins];
    }
#pragma omp critical
    std::transform(total.begin(), total.end(), mine.begin(), total.begin(), [](int64_t a, int64_t b) { return a + b; });
  }
  h.count.assign(total.begin(), total.end() - 1);
  h.not_finite = static_cast<double>(total[bins]);
  h.finite = static_cast<double>(n) - h.not_finite;
}

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

// Returns the opacity at the ramp's top with which a ray through the shown values collects an optical depth of about 2.
double top_opacity(const stratus_volume& volume, const cli::histogram& h, double from, double to)
{
  double weight = 0.0;
  double shown = 0.0;
  for (size_t i = 0; i < h.count.size(); ++i) {
    const double center = h.first + (static_cast<double>(i) + 0.5) * h.width();
    const double height = (center - from) / (to - from);
    if (height > 0.0) {
      weight += ramp(std::min(height, 1.0)) * h.count[i];
      shown += h.count[i];
    }
  }
  if (shown <= 0.0) {
    return 0.5;
  }
  const double total = std::max(h.finite, 1.0);
  const double length = std::cbrt(static_cast<double>(volume.dimensions[0] * volume.dimensions[1] * volume.dimensions[2]));
  const double footprint = std::pow(shown / total, 2.0 / 3.0);
  const double depth_at_one = weight / total * length / footprint;
  return std::min(std::max(1.0 - std::exp(-2.0 / std::max(depth_at_one, 1e-6)), 0.004), 0.9);
}
} // namespace

namespace cli {

histogram histogram_of(const stratus_volume& volume)
{
  histogram h;
  switch (volume.type) {
    case STRATUS_INT8:
      count_values<int8_t>(volume, h);
      break;
    case STRATUS_UINT8:
      count_values<uint8_t>(volume, h);
      break;
    case STRATUS_INT16:
      count_values<int16_t>(volume, h);
      break;
    case STRATUS_UINT16:
      count_values<uint16_t>(volume, h);
      break;
    case STRATUS_INT32:
      count_values<int32_t>(volume, h);
      break;
    case STRATUS_UINT32:
      count_values<uint32_t>(volume, h);
      break;
    case STRATUS_INT64:
      count_values<int64_t>(volume, h);
      break;
    case STRATUS_UINT64:
      count_values<uint64_t>(volume, h);
      break;
    case STRATUS_FLOAT32:
      count_values<float>(volume, h);
      break;
    case STRATUS_FLOAT64:
      count_values<double>(volume, h);
      break;
  }
  return h;
}

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

void guess_opacity(const stratus_volume& volume, const histogram& h, transfer& result)
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
  // If a single value is the background, the ramp starts right behind it; integers lie in the middle of their bins.
  const double lone = *std::max_element(h.count.begin(), h.count.end());
  double bins = lone > 0.5 * h.finite ? static_cast<double>(peak) + 0.5 : static_cast<double>(end_of_background(count, peak));
  bins = std::min(bins, static_cast<double>(count.size()) - 1.0);
  double from = bright ? h.last - bins * h.width() : h.first + bins * h.width();
  from = std::min(std::max(from, h.low), h.high);
  const double to = bright ? h.low : h.high;
  const double top = top_opacity(volume, h, from, to);
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

std::vector<double> parse_color(const std::string& text, double low, double high)
{
  for (const color_map& map : color_maps()) {
    if (text == map.name) {
      std::vector<double> points = map.points;
      for (size_t i = 0; i < points.size(); i += 4) {
        points[i] = low + points[i] * (high - low);
      }
      return points;
    }
  }
  std::vector<double> points;
  for (const std::string& point : split(text, ',')) {
    const std::vector<std::string> fields = split(point, ':');
    if (fields.size() != 4) {
      throw usage("--color: '" + point + "' is neither value:r:g:b nor one of " + color_names());
    }
    for (const std::string& field : fields) {
      points.push_back(number(field, "--color"));
    }
  }
  if (points.empty()) {
    throw usage("--color: no points");
  }
  return points;
}

std::string color_names()
{
  std::string names;
  for (const color_map& map : color_maps()) {
    names += std::string(names.empty() ? "" : ", ") + map.name;
  }
  return names;
}

transfer make_transfer(
  const stratus_volume& volume, const stratus_scene* scene, const std::string& opacity, const std::string& color, double unit_distance)
{
  transfer result;
  const double voxel = std::cbrt(volume.spacing[0] * volume.spacing[1] * volume.spacing[2]);
  result.unit_distance = unit_distance > 0.0 ? unit_distance : scene ? scene->transfer.unit_distance : voxel;
  if (!opacity.empty()) {
    result.opacity = parse_opacity(opacity);
    result.origin = "as given";
  } else if (scene) {
    result.opacity.assign(scene->transfer.opacity, scene->transfer.opacity + 2 * scene->transfer.opacity_count);
    result.origin = "the scene's own";
  } else {
    guess_opacity(volume, histogram_of(volume), result);
    if (unit_distance > 0.0) { // the guess is per voxel edge
      for (size_t i = 1; i < result.opacity.size(); i += 2) {
        result.opacity[i] = -std::expm1(unit_distance / voxel * std::log1p(-result.opacity[i]));
      }
    }
  }
  double low = 0.0;
  double high = 1.0;
  result.shown(low, high);
  if (color.empty() && scene) {
    result.color.assign(scene->transfer.color, scene->transfer.color + 4 * scene->transfer.color_count);
  } else {
    result.color = parse_color(color.empty() ? "storm" : color, low, high);
  }
  return result;
}
} // namespace cli
