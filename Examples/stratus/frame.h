// SPDX-License-Identifier: BSD-3-Clause
// A picture's pixels with what is known of each, and the file they become: PNG of colours or of samples, or OpenEXR of all.
#pragma once

#include "options.h"
#include "output.h"
#include "picture.h"

#include <vector>

namespace cli {

class frame
{
public:
  // Tells at once, by throwing usage, what cannot become a file: an OUT.exr where OpenEXR was not there to build with, a heat map in it.
  explicit frame(const options& o);
  // Borrows what the options ask for.
  stratus_image view();
  // Samples a pixel in a line, where they were counted.
  std::string describe_samples() const;
  void write(output_file& file) const;

private:
  std::vector<uint8_t> encode_exr() const;

  int Width, Height;
  background Behind;
  std::string Color;
  bool IsExr, ShowsSamples;
  std::vector<float> Rgba, Depth;
  std::vector<uint32_t> Samples;
};
} // namespace cli
