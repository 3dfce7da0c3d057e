// SPDX-License-Identifier: BSD-3-Clause
// Transfer functions given by the user, taken from the scene, or guessed from the histogram.
#pragma once

#include "options.h"
#include "support.h"

#include <string>
#include <vector>

namespace cli {

// The values that a guess is made from: a volume, its blocks, or the values of a mesh as a volume.
struct look_input {
  std::vector<stratus_volume> volumes;
  std::vector<double> thickness;      // see stratus_look_options
  std::vector<unsigned char> ordered; // values of the volume, if they are a copy
  bool unordered = false;
};

// A volume, or its blocks, which have values of one type.
using volumes = std::vector<const stratus_volume*>;

// A transfer function that owns its points.
class transfer
{
public:
  std::vector<double> opacity; // pairs
  std::vector<double> color;   // quadruples
  double unit_distance = 1.0;
  double low = 0.0, high = 1.0; // what is shown, over which colours are stretched
  bool logarithmic = false;
  std::string origin; // where the function comes from, for the user

  stratus_transfer view() const;
  void color_at(double value, float rgb[3]) const;
  // Finds the values between which the function shows something.
  void shown(double& low, double& high) const;
};

// Parses "value:alpha,value:alpha,...".
std::vector<double> parse_opacity(const std::string& text);
// Options that were not given take the scene's own function, or a guess where `scene` is null or the scale is logarithmic.
transfer make_transfer(const context& core, const look_input& data, const stratus_scene* scene, const options& o);
// Counts the finite values and finds their range.
stratus_look_values count_values(const context& core, const look_input& data);
} // namespace cli
