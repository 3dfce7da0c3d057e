// SPDX-License-Identifier: BSD-3-Clause
// Converts float pixels to 8 bits over a background, and encodes them as PNG.
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

// Parses "dark", "light", "black", "white", "transparent", "r:g:b", or "r:g:b,r:g:b" from bottom to top.
background parse_background(const std::string& text);

// Returns 3 bytes per pixel, or 4 for a transparent background, bottom row first. With 4 bytes alpha is not premultiplied, as PNG requires.
std::vector<uint8_t> to_bytes(const std::vector<float>& rgba, int width, int height, const background& behind);

std::vector<uint8_t> encode_png(const std::vector<uint8_t>& bytes, int width, int height);
} // namespace cli
