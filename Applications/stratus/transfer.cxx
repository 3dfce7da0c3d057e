// SPDX-License-Identifier: BSD-3-Clause
#include "transfer.h"

#include "colors.h"
#include "picture.h"

#include <algorithm>
#include <cmath>

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

stratus_look_values count_values(const context& core, const look_input& data)
{
  stratus_look_values values = {};
  core.check(stratus_look_count(core, data.volumes.data(), static_cast<int>(data.volumes.size()), &values), "values");
  return values;
}

static stratus_look guess(const context& core, const look_input& data, stratus_look_kind kind, const options& o)
{
  stratus_look_options how = stratus_look_options_default();
  how.kind = kind;
  how.logarithmic = o.logarithmic ? 1 : o.linear ? -1 : 0;
  how.column_axis = !o.about.earth && kind == STRATUS_LOOK_UNKNOWN ? -1 : data.thickness.empty() && !o.up.empty() ? o.up[0] - 'x' : 2;
  how.thickness = data.thickness.empty() ? nullptr : data.thickness.data();
  how.unordered = data.unordered ? 1 : 0;
  stratus_look look = {};
  core.check(
    stratus_look_guess(core, data.volumes.data(), static_cast<int>(data.volumes.size()), &how, &look), o.logarithmic ? "--log" : "opacity");
  return look;
}

// The edge of a cube of the world as large as a voxel.
static double voxel_of(const stratus_volume& volume)
{
  const double* m = volume.matrix;
  const double bigger =
    std::fabs(m[0] * (m[5] * m[10] - m[6] * m[9]) - m[1] * (m[4] * m[10] - m[6] * m[8]) + m[2] * (m[4] * m[9] - m[5] * m[8]));
  return std::cbrt(volume.spacing[0] * volume.spacing[1] * volume.spacing[2] * bigger);
}

// Sets opacity and the range of colours by a guess.
static void set_guess(const stratus_look& look, transfer& result)
{
  result.opacity.assign(look.opacity, look.opacity + 2 * look.opacity_count);
  result.unit_distance = result.unit_distance > 0.0 ? result.unit_distance : look.unit_distance;
  for (size_t i = 1; i < result.opacity.size() && result.unit_distance != look.unit_distance; i += 2) {
    result.opacity[i] = -std::expm1(result.unit_distance / look.unit_distance * std::log1p(-result.opacity[i]));
  }
  result.low = look.low;
  result.high = look.high;
  result.logarithmic = look.logarithmic != 0;
  result.origin = std::string("histogram") + (result.logarithmic ? ", " : ": ") + look.reason;
}

// Surfaces are opaque, several isosurfaces by half, so that all of them show.
static void set_surfaces(const options& o, transfer& result)
{
  if (o.mode == STRATUS_MODE_SLICE || o.mode == STRATUS_MODE_ISOSURFACE) {
    const double opacity = o.mode == STRATUS_MODE_ISOSURFACE && o.contours.size() > 1 ? 0.5 : 1.0;
    result.opacity = { result.low, opacity };
    result.origin = format("%g for surfaces", opacity);
  }
}

transfer make_transfer(const context& core, const look_input& data, const stratus_scene* scene, const options& o)
{
  transfer result;
  const bool own = scene && !o.logarithmic; // the scene's function
  const char* map = nullptr;
  const stratus_look_kind kind = stratus_look_kind_of(
    o.about.name.c_str(), o.about.standard_name.c_str(), o.about.units.c_str(), is_bright(parse_background(o.background)) ? 1 : 0, &map);
  std::string usual = map ? map : "storm";
  result.unit_distance = o.unit_distance > 0.0 ? o.unit_distance : scene ? scene->transfer.unit_distance : 0.0;
  result.logarithmic = o.logarithmic;
  if (!o.opacity.empty()) {
    result.opacity = parse_opacity(o.opacity);
    result.origin = o.cloud ? "proportional to the water" : "as given";
  } else if (own) {
    result.opacity.assign(scene->transfer.opacity, scene->transfer.opacity + 2 * scene->transfer.opacity_count);
    result.origin = "the scene's own";
  }
  if (!result.opacity.empty()) {
    result.unit_distance = result.unit_distance > 0.0 ? result.unit_distance : voxel_of(data.volumes[0]);
    result.shown(result.low, result.high);
  } else {
    const stratus_look look = guess(core, data, kind, o);
    set_guess(look, result);
    usual = !map && look.kind == STRATUS_LOOK_SIGNED ? "cool-warm" : usual;
  }
  if (o.opacity.empty()) {
    set_surfaces(o, result);
  }
  if (o.logarithmic && !(result.low > 0.0)) { // opacities that were given may begin at 0
    result.low = guess(core, data, kind, o).low;
    result.high = std::max(result.high, result.low);
  }
  if (o.color.empty() && own) {
    result.color.assign(scene->transfer.color, scene->transfer.color + 4 * scene->transfer.color_count);
    return result;
  }
  const std::string name = o.color.empty() ? usual : o.color;
  const bool given = name.find(':') != std::string::npos;
  result.color =
    result.logarithmic && !given ? logarithmic_color(name, result.low, result.high) : parse_color(name, result.low, result.high);
  return result;
}
} // namespace cli
