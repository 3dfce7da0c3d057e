// SPDX-License-Identifier: BSD-3-Clause
// The pixels of a picture and the values of each, written as a PNG of colours or samples, or as an OpenEXR file of all.
#pragma once

#include "annotation.h"
#include "heat.h"
#include "options.h"
#include "output.h"
#include "picture.h"

#include <vector>

namespace cli {

class frame
{
public:
  // Throws usage if the output is a heat map as .exr, or an .exr in a program that was built without OpenEXR.
  explicit frame(const options& o);
  // Borrows the arrays that the options need.
  stratus_image view();
  // Sets the units of numbers of rays: lengths are measured in the coordinates of the data, not of the scene, which `scale` stretches.
  // metres: of a unit of the coordinates, 0: unknown. values: the unit of the values, "": unknown.
  void set_units(const double scale[3], double metres, const std::string& values);
  // Whether the picture is of colours, and no pixel would differ from the background in 8 bits.
  bool shows_nothing() const;
  // The numbers of rays that the options need; none: nothing is wanted.
  stratus_quantities numbers();
  bool has_numbers() const { return !this->Wanted.empty(); }
  // Describes the range of each of these numbers in a line.
  std::vector<std::string> describe_numbers() const;
  // Describes the samples per pixel in a line, or returns "" where they were not counted.
  std::string describe_samples() const;
  // Puts annotations around the picture, unless it shows other numbers than colours.
  void annotate(const context& core, const annotation& wish, const scene_frame& place, const transfer& look, const std::string& time);
  void write(const context& core, output_file& file) const;

private:
  bool shows_colors() const { return !this->ShowsSamples && (this->IsExr || this->Wanted.empty()); }
  std::vector<uint8_t> encode_exr() const;
  std::string units_of(stratus_quantity quantity) const;
  heat_scale scale_of(size_t number) const;

  int Width, Height;
  background Behind;
  std::string Color;
  picture_format Format;
  bool IsExr, ShowsSamples, Linear; // Linear: colours are radiances
  std::vector<float> Rgba, Depth;
  std::vector<stratus_quantity> Wanted;
  double Threshold;
  double Measure[3] = { 1.0, 1.0, 1.0 };
  bool InMetres = false;
  std::string ValueUnits;
  std::vector<std::vector<float>> Numbers; // of each that is wanted
  std::vector<uint32_t> Samples;
};
} // namespace cli
