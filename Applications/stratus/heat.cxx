// SPDX-License-Identifier: BSD-3-Clause
#include "heat.h"

#include "colors.h"
#include "support.h"
#include "text.h"

#include <vtkColorTransferFunction.h>
#include <vtkNew.h>

#include <algorithm>
#include <cmath>

namespace cli {

namespace {
constexpr int bar_left = 16, bar_wide = 18, bar_margin = 28, text_left = 42, text_size = 13, line_height = 24;
constexpr uint8_t text_level = 230;

struct canvas {
  int width, height;
  std::vector<uint8_t> rgb;

  void set(int x, int y, const uint8_t color[3])
  {
    if (x >= 0 && y >= 0 && x < this->width && y < this->height) {
      std::copy_n(color, 3, &this->rgb[3 * (static_cast<size_t>(y) * static_cast<size_t>(this->width) + static_cast<size_t>(x))]);
    }
  }
};

void look_up(vtkColorTransferFunction* colors, double value, uint8_t rgb[3])
{
  double color[3];
  colors->GetColor(value, color);
  for (int c = 0; c < 3; ++c) {
    rgb[c] = static_cast<uint8_t>(std::lround(255.0 * std::min(std::max(color[c], 0.0), 1.0)));
  }
}

// Writes text over the canvas, the middle of its left edge at x, y.
void write_text(canvas& to, const std::string& text, int x, int y)
{
  const text_image image = render_text(text, text_size);
  for (int j = 0; j < image.height; ++j) {
    for (int i = 0; i < image.width; ++i) {
      const uint8_t level = static_cast<uint8_t>(image.coverage[static_cast<size_t>(j * image.width + i)] * text_level / 255);
      const uint8_t color[3] = { level, level, level };
      if (level > 0) {
        to.set(x + i, y + j - image.height / 2, color);
      }
    }
  }
}

void draw_bar(canvas& to, int left, const heat_scale& scale, vtkColorTransferFunction* colors)
{
  const int tall = std::max(2, to.height - 2 * bar_margin), bottom = (to.height - tall) / 2;
  for (int j = 0; j < tall; ++j) {
    uint8_t rgb[3];
    look_up(colors, scale.low + (scale.high - scale.low) * j / (tall - 1), rgb);
    for (int i = 0; i < bar_wide; ++i) {
      to.set(left + bar_left + i, bottom + j, rgb);
    }
  }
  if (to.height < 2 * bar_margin + line_height) {
    return; // no room for text
  }
  const double extent = scale.high - scale.low, step = round_step(extent * line_height / tall);
  for (double n = std::ceil(scale.low / step); n * step <= scale.high + 1e-9 * extent; ++n) {
    const int y = bottom + static_cast<int>(std::lround((n * step - scale.low) / extent * (tall - 1)));
    const bool whole = std::floor(step) == step && std::abs(n * step) < 1e9 && n >= 0.0;
    write_text(to, whole ? grouped(static_cast<unsigned long long>(n * step)) : format("%.4g", n * step), left + text_left, y);
  }
  write_text(to, scale.title, left + 8, to.height - bar_margin / 2 + 1);
  write_text(to, scale.units, left + 8, bar_margin / 2 - 1);
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

std::vector<uint8_t> heat_map(const std::vector<float>& values, int width, int height, const heat_scale& scale, const std::string& color)
{
  vtkNew<vtkColorTransferFunction> colors;
  const std::vector<double> points = parse_color(color.empty() ? "fire" : color, scale.low, scale.high);
  for (size_t i = 0; i < points.size(); i += 4) {
    colors->AddRGBPoint(points[i], points[i + 1], points[i + 2], points[i + 3]);
  }
  canvas result = { width + heat_bar_width, height, {} };
  result.rgb.assign(3 * static_cast<size_t>(result.width) * static_cast<size_t>(height), 0);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const float value = values[static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x)];
      uint8_t rgb[3] = { 0, 0, 0 };
      if (std::isfinite(value)) {
        look_up(colors, value, rgb);
      }
      result.set(x, y, rgb);
    }
  }
  draw_bar(result, width, scale, colors);
  return std::move(result.rgb);
}
} // namespace cli
