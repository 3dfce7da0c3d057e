// SPDX-License-Identifier: BSD-3-Clause
// Colour maps by name, and colours that the user gives.
#pragma once

#include <string>
#include <vector>

namespace cli {

// Returns a named colour map as quadruples of value, red, green, blue, stretched from low to high, or parses "value:r:g:b,...".
std::vector<double> parse_color(const std::string& text, double low, double high);
// The names of all maps.
std::string color_names(const std::string& between);
// A colour map over the logarithm of the value from low to high, both above 0.
std::vector<double> logarithmic_color(const std::string& name, double low, double high);
} // namespace cli
