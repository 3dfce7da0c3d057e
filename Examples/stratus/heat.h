// SPDX-License-Identifier: BSD-3-Clause
// Samples a pixel as colours, with a bar that tells which colour is how many.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace cli {

constexpr int heat_bar_width = 112; // pixels beside the picture

// RGB, bottom row first, width + heat_bar_width pixels a row. color: as --color has it, over 0 .. the most samples of a pixel.
std::vector<uint8_t> heat_map(const std::vector<uint32_t>& samples, int width, int height, const std::string& color);
} // namespace cli
