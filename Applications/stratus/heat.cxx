// SPDX-License-Identifier: BSD-3-Clause
#include "heat.h"

#include "colors.h"
#include "transfer.h"

#include <algorithm>
#include <cmath>

namespace cli {

namespace {
constexpr int least_bar = 112; // pixels, in addition to the map

// Finds how wide a picture is whose bar leaves the map its width. Text grows with the picture.
int find_width(const context& core, const stratus_annotation& bar, int width, int height)
{
  int extra = least_bar;
  for (int pass = 0; pass < 8; ++pass) {
    double room[4];
    core.check(stratus_annotation_room(core, &bar, width + extra, height, room), "the colour bar");
    const int needed = width + extra - static_cast<int>(std::floor(room[1]));
    if (needed <= extra) {
      break;
    }
    extra = needed;
  }
  return width + extra;
}
} // namespace

value_range range_of(const std::vector<float>& values)
{
  value_range range;
  for (const float value : values) {
    if (std::isfinite(value)) {
      range.low = range.count > 0 ? std::min(range.low, static_cast<double>(value)) : value;
      range.high = range.count > 0 ? std::max(range.high, static_cast<double>(value)) : value;
      ++range.count;
    }
  }
  return range;
}

heat_picture heat_map(
  const context& core, const std::vector<float>& values, int width, int height, const heat_scale& scale, const std::string& color)
{
  transfer colors;
  colors.color = parse_color(color.empty() ? "fire" : color, scale.low, scale.high);
  stratus_annotation bar = stratus_annotation_default();
  bar.color = colors.color.data();
  bar.color_count = colors.color.size() / 4;
  bar.low = scale.low;
  bar.high = scale.high;
  bar.bar_title = scale.title.c_str();
  bar.bar_units = scale.units.c_str();
  heat_picture result;
  result.width = find_width(core, bar, width, height);
  std::vector<float> rgba(4 * static_cast<size_t>(result.width) * static_cast<size_t>(height));
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const float value = values[static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x)];
      if (std::isfinite(value)) {
        colors.color_at(value, &rgba[4 * (static_cast<size_t>(y) * static_cast<size_t>(result.width) + static_cast<size_t>(x))]);
      }
    }
  }
  stratus_image image = {};
  image.width = result.width;
  image.height = height;
  image.rgba = rgba.data();
  stratus_camera camera = {}; // of nothing in the world
  camera.forward[2] = camera.right[0] = camera.up[1] = 1.0;
  core.check(stratus_annotation_draw(core, &bar, &camera, &image, nullptr, 0, nullptr), "the colour bar");
  for (size_t i = 0; i < rgba.size(); i += 4) {
    for (size_t c = 0; c < 3; ++c) {
      result.rgb.push_back(static_cast<uint8_t>(std::lround(255.0F * std::min(std::max(rgba[i + c], 0.0F), 1.0F))));
    }
  }
  return result;
}
} // namespace cli
