// SPDX-License-Identifier: BSD-3-Clause
// Float pixels -> 8 bits over a background -> PNG.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace cli {

struct background {
  bool transparent = false;
  double bottom[3] = { 0.05, 0.06, 0.09 };
  double top[3] = { 0.16, 0.20, 0.28 };
};

// "dark", "light", "black", "white", "transparent", "r:g:b", or "r:g:b,r:g:b" from bottom to top.
background parse_background(const std::string& text);

// 3 or, where the background is transparent, 4 bytes a pixel (then alpha is not premultiplied, as PNG wants), bottom row first.
std::vector<uint8_t> to_bytes(const std::vector<float>& rgba, int width, int height, const background& behind);

std::vector<uint8_t> encode_png(const std::vector<uint8_t>& bytes, int width, int height);
} // namespace cli
