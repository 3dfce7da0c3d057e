// SPDX-License-Identifier: BSD-3-Clause
// Text as pixels, by VTK's FreeType, which needs no display; and round numbers for scales.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace cli {

struct text_image {
  int width = 0, height = 0;
  std::vector<uint8_t> coverage; // 0..255, bottom row first
};
// Throws failure where VTK has no font.
text_image render_text(const std::string& text, int size);
// Returns the smallest of 1, 2 or 5 times a power of ten that is at least `least`.
double round_step(double least);
} // namespace cli
