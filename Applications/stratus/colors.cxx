// SPDX-License-Identifier: BSD-3-Clause
#include "colors.h"

#include "support.h"

#include <algorithm>
#include <cmath>

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
    { "cividis", { 0, 0, .126, .302, .25, .255, .302, .42, .5, .486, .482, .471, .75, .737, .686, .435, 1, 1, .918, .275 } },
    // Of quantities of the sea, each from little to much, lighter or darker all along.
    { "temperature", { 0, .05, .12, .30, .25, .30, .22, .55, .5, .63, .30, .50, .75, .93, .50, .25, 1, .98, .90, .45 } },
    { "salinity", { 0, .16, .09, .42, .25, .10, .30, .55, .5, .25, .52, .55, .75, .45, .74, .48, 1, .98, .93, .60 } },
    { "algae", { 0, .90, .95, .82, .3, .62, .80, .52, .6, .22, .60, .36, .85, .05, .38, .27, 1, .05, .18, .12 } },
    { "sediment", { 0, .93, .93, .70, .3, .83, .70, .43, .6, .65, .45, .28, .85, .40, .26, .24, 1, .17, .12, .13 } },
    { "oxygen", { 0, .30, .02, .04, .25, .50, .10, .08, .5, .45, .45, .47, .75, .72, .73, .74, 1, .95, .88, .35 } },
    { "depth", { 0, .99, .99, .80, .25, .56, .82, .65, .5, .28, .60, .62, .75, .24, .36, .58, 1, .15, .10, .25 } },
    { "fire", { 0, .05, .0, .02, .35, .55, .06, .04, .65, .95, .45, .05, .88, 1, .88, .35, 1, 1, 1, .92 } },
    { "gray", { 0, 0, 0, 0, 1, 1, 1, 1 } },
    { "white", { 0, 1, 1, 1 } },
  };
  return maps;
}
} // namespace

namespace cli {

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
// Between two points colours are linear in the value, so a map over the logarithm needs many of them.
std::vector<double> logarithmic_color(const std::string& name, double low, double high)
{
  constexpr int pieces = 64;
  const std::vector<double> map = parse_color(name, 0.0, 1.0);
  std::vector<double> points;
  size_t at = 0;
  for (int i = 0; i <= pieces; ++i) {
    const double t = static_cast<double>(i) / pieces;
    while (at + 8 < map.size() && map[at + 4] < t) {
      at += 4;
    }
    points.push_back(low * std::pow(high / low, t));
    const bool last = at + 4 >= map.size(); // a map of one colour
    const double width = last ? 1.0 : map[at + 4] - map[at];
    const double part = last || width <= 0.0 ? 0.0 : std::min(std::max((t - map[at]) / width, 0.0), 1.0);
    for (size_t c = 1; c < 4; ++c) {
      points.push_back(last ? map[at + c] : map[at + c] + part * (map[at + 4 + c] - map[at + c]));
    }
  }
  return points;
}
} // namespace cli
