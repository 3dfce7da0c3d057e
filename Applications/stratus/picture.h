// SPDX-License-Identifier: BSD-3-Clause
// Converts float pixels to 8 bits over a background, and encodes them as PNG, JPEG, TIFF or BMP.
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
// Whether dark text shows better on it than bright text. A transparent background is dark.
bool is_bright(const background& behind);

// Decodes a screen's level: the inverse of stratus_screen_level().
double from_screen(double level);

// Returns 3 bytes per pixel, or 4 for a transparent background, bottom row first. With 4 bytes alpha is not premultiplied, as PNG requires.
// linear: colours are radiances, which are encoded for a screen; the background is already.
std::vector<uint8_t> to_bytes(const std::vector<float>& rgba, int width, int height, const background& behind, bool linear);

enum class picture_format { png, jpeg, tiff, bmp, exr };
// Returns the format that the name's extension says, PNG for a name without one. Throws usage, with a list of the supported formats, for
// another extension, and for OpenEXR if this was built without it.
picture_format format_of_picture(const std::string& path);

// Encodes pixels of 3 or 4 bytes, bottom row first. Only PNG supports 4. OpenEXR is not supported here, since it stores floats.
std::vector<uint8_t> encode(picture_format format, const std::vector<uint8_t>& bytes, int width, int height);
} // namespace cli
