// SPDX-License-Identifier: BSD-3-Clause
// Shows a number of each pixel as colours, with a labelled colour bar.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace cli {

constexpr int heat_bar_width = 112; // in pixels, in addition to the picture

// The finite values among others, and how many there are.
struct value_range {
  double low = 0.0, high = 0.0;
  size_t count = 0;
};
value_range range_of(const std::vector<float>& values);

// The values at the ends of the bar, low < high, and what they are.
struct heat_scale {
  double low, high;
  std::string title, units; // units: a line below the title; "": none
};

// Returns RGB bytes, bottom row first, width + heat_bar_width pixels per row. `color` is a value of --color, over the scale. Pixels without
// a finite value are black.
std::vector<uint8_t> heat_map(const std::vector<float>& values, int width, int height, const heat_scale& scale, const std::string& color);
} // namespace cli
