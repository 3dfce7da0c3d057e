// SPDX-License-Identifier: BSD-3-Clause
// Transfer functions given by the user, taken from the scene, or guessed from the histogram.
#pragma once

#include "histogram.h"
#include "options.h"
#include "support.h"

#include <string>
#include <vector>

namespace cli {

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

// Guesses an opacity that is transparent over the dominant value (the air, the background) and a ramp away from it. The ramp's height suits
// a view through the whole volume.
void guess_opacity(const histogram& values, transfer& result);
// Parses "value:alpha,value:alpha,...".
std::vector<double> parse_opacity(const std::string& text);
// Options that were not given take the scene's own function, or a guess where `scene` is null or the scale is logarithmic.
transfer make_transfer(const volumes& all, const stratus_scene* scene, const options& o);
} // namespace cli
