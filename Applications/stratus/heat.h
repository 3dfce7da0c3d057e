// SPDX-License-Identifier: BSD-3-Clause
// Shows the samples per pixel as colours, with a labelled colour bar.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace cli {

constexpr int heat_bar_width = 112; // in pixels, in addition to the picture

// Returns RGB bytes, bottom row first, width + heat_bar_width pixels per row. `color` is a value of --color, over 0 .. the most samples of
// a pixel.
std::vector<uint8_t> heat_map(const std::vector<uint32_t>& samples, int width, int height, const std::string& color);
} // namespace cli
