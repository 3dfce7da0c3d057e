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

void draw_bar(canvas& to, int left, uint32_t most, vtkColorTransferFunction* colors)
{
  const int tall = std::max(2, to.height - 2 * bar_margin), bottom = (to.height - tall) / 2;
  for (int j = 0; j < tall; ++j) {
    uint8_t rgb[3];
    look_up(colors, static_cast<double>(most) * j / (tall - 1), rgb);
    for (int i = 0; i < bar_wide; ++i) {
      to.set(left + bar_left + i, bottom + j, rgb);
    }
  }
  if (to.height < 2 * bar_margin + line_height) {
    return; // no room for text
  }
  const double step = std::max(1.0, round_step(std::max(1.0, static_cast<double>(most)) * line_height / tall));
  for (double value = 0.0; value <= static_cast<double>(most); value += step) {
    const int y = bottom + static_cast<int>(std::lround(value / std::max<double>(most, 1.0) * (tall - 1)));
    write_text(to, grouped(static_cast<unsigned long long>(value)), left + text_left, y);
  }
  write_text(to, "samples a pixel", left + 8, to.height - bar_margin / 2 + 1);
}
} // namespace

std::vector<uint8_t> heat_map(const std::vector<uint32_t>& samples, int width, int height, const std::string& color)
{
  const uint32_t most = samples.empty() ? 0 : *std::max_element(samples.begin(), samples.end());
  vtkNew<vtkColorTransferFunction> colors;
  const std::vector<double> points = parse_color(color.empty() ? "fire" : color, 0.0, std::max<double>(most, 1.0));
  for (size_t i = 0; i < points.size(); i += 4) {
    colors->AddRGBPoint(points[i], points[i + 1], points[i + 2], points[i + 3]);
  }
  canvas result = { width + heat_bar_width, height, {} };
  result.rgb.assign(3 * static_cast<size_t>(result.width) * static_cast<size_t>(height), 0);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      uint8_t rgb[3];
      look_up(colors, samples[static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x)], rgb);
      result.set(x, y, rgb);
    }
  }
  draw_bar(result, width, most, colors);
  return std::move(result.rgb);
}
} // namespace cli
