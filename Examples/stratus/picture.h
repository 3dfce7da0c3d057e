// SPDX-License-Identifier: BSD-3-Clause
// Float pixels -> 8 bits over a background -> a PNG file that is either whole or not there.
#pragma once

#include <cstdint>
#include <cstdio>
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

// A file that appears under its name only by commit(): until then it has a temporary name beside it, and without commit() it is removed.
// What exists and is no regular file (a pipe, a device) is written in place.
class output_file
{
public:
  explicit output_file(const std::string& path); // throws failure where it cannot be written
  ~output_file();
  output_file(const output_file&) = delete;
  output_file& operator=(const output_file&) = delete;

  void write(const std::vector<uint8_t>& bytes);
  void commit();

private:
  [[noreturn]] void fail(int reason);

  std::string Path;
  std::string Temporary; // empty: written in place
  std::FILE* File = nullptr;
};
} // namespace cli
