// SPDX-License-Identifier: BSD-3-Clause
// Shows a number of each pixel as colours, with a labelled colour bar.
#pragma once

#include "support.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace cli {

// The finite values among others, and how many there are.
struct value_range {
  double low = 0.0, high = 0.0;
  size_t count = 0;
};
value_range range_of(const std::vector<float>& values);

// The values at the ends of the bar, low < high, and what they are.
struct heat_scale {
  double low, high;
  std::string title, units;
};

// RGB bytes, bottom row first, width pixels per row: the map and, right of it, the bar.
struct heat_picture {
  int width = 0;
  std::vector<uint8_t> rgb;
};

// `color` is a value of --color, over the scale. Pixels without a finite value are black.
heat_picture heat_map(
  const context& core, const std::vector<float>& values, int width, int height, const heat_scale& scale, const std::string& color);
} // namespace cli
