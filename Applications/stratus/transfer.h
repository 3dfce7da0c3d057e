// SPDX-License-Identifier: BSD-3-Clause
// Transfer functions given by the user, taken from the scene, or guessed from the histogram.
#pragma once

#include "options.h"
#include "support.h"

#include <string>
#include <vector>

namespace cli {

// A volume, or its blocks, which have values of one type.
using volumes = std::vector<const stratus_volume*>;

// The frequencies of a volume's values.
struct histogram {
  double low = 0.0, high = 0.0;   // of the finite values; low > high: there are none
  double first = 0.0, last = 0.0; // edges of the first and last bin; if each of few integers has its own bin, it lies in the middle
  std::vector<double> count;      // values in each bin; bins are equally wide
  double finite = 0.0;
  double not_finite = 0.0;

  double width() const { return (this->last - this->first) / static_cast<double>(this->count.size()); }
};
histogram histogram_of(const volumes& all);

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
