// SPDX-License-Identifier: BSD-3-Clause
// What the values look like: written by the user, the scene's own, or guessed from the histogram.
#pragma once

#include "support.h"

#include <string>
#include <vector>

namespace cli {

// How often the values of a volume come.
struct histogram {
  double low = 0.0, high = 0.0;   // of the finite values; low > high: there is none
  double first = 0.0, last = 0.0; // edges of the first and last bin; few integers lie in the middle of a bin each
  std::vector<double> count;      // of equally wide bins
  double finite = 0.0;
  double not_finite = 0.0;

  double width() const { return (this->last - this->first) / static_cast<double>(this->count.size()); }
};
histogram histogram_of(const stratus_volume& volume);

// A transfer function that owns its points.
class transfer
{
public:
  std::vector<double> opacity; // pairs
  std::vector<double> color;   // quadruples
  double unit_distance = 1.0;
  std::string origin; // where it comes from, for people

  stratus_transfer view() const;
  // The values between which there is something to see.
  void shown(double& low, double& high) const;
};

// Transparent over the value that dominates (the air, the background) and a ramp away from it, as steep as a view through the whole needs.
void guess_opacity(const stratus_volume& volume, const histogram& values, transfer& result);
// "value:alpha,value:alpha,..."
std::vector<double> parse_opacity(const std::string& text);
// A named colour map, stretched from low to high, or "value:r:g:b,...".
std::vector<double> parse_color(const std::string& text, double low, double high);
std::string color_names();

// Options may be empty: then the scene's own (may be null), else guesses.
transfer make_transfer(
  const stratus_volume& volume, const stratus_scene* scene, const std::string& opacity, const std::string& color, double unit_distance);
} // namespace cli
