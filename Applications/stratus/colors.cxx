// SPDX-License-Identifier: BSD-3-Clause
#include "colors.h"

#include "nearest.h"
#include "support.h"

#include <cmath>

namespace cli {

static std::vector<double> parse_points(const std::string& text)
{
  std::vector<double> points;
  for (const std::string& point : split(text, ',')) {
    const std::vector<std::string> fields = split(point, ':');
    if (fields.size() != 4) {
      throw usage("--color: '" + point + "' is not value:r:g:b");
    }
    for (const std::string& field : fields) {
      points.push_back(number(field, "--color"));
    }
  }
  return points;
}

static std::vector<std::string> color_maps()
{
  std::vector<std::string> names;
  while (const char* name = stratus_color_map_name(static_cast<int>(names.size()))) {
    names.emplace_back(name);
  }
  return names;
}

std::vector<double> parse_color(const std::string& text, double low, double high)
{
  if (text.find(':') != std::string::npos) {
    return parse_points(text);
  }
  const context core("host", 1);
  std::vector<double> points(4 * STRATUS_COLOR_MAP_COLORS);
  if (stratus_color_map_points(core, text.c_str(), low, high, points.data()) != STRATUS_OK) {
    throw usage("--color: " + std::string(stratus_context_message(core)) + "; or a list value:r:g:b,..." + meant(text, color_maps()));
  }
  return points;
}

std::string color_names(const std::string& between)
{
  std::string text;
  for (const std::string& name : color_maps()) {
    text += (text.empty() ? "" : between) + name;
  }
  return text;
}

std::vector<double> logarithmic_color(const std::string& name, double low, double high)
{
  std::vector<double> points = parse_color(name, 0.0, 1.0);
  for (size_t i = 0; i < points.size(); i += 4) {
    points[i] = low * std::pow(high / low, points[i]);
  }
  return points;
}
} // namespace cli
