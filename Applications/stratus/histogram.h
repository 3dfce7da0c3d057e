// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "stratus.h"

#include <vector>

namespace cli {

// A volume, or its blocks, which have values of one type.
using volumes = std::vector<const stratus_volume*>;

// The frequencies of a volume's values.
struct histogram {
  double low = 0.0, high = 0.0;   // of the finite values; low > high: there are none
  double first = 0.0, last = 0.0; // edges of the first and last bin; each of few integers is in the middle of its own bin
  std::vector<double> count;      // values in each bin; bins are equally wide
  double finite = 0.0;
  double not_finite = 0.0;

  double width() const { return (this->last - this->first) / static_cast<double>(this->count.size()); }
};
// Counts a point that blocks share once, so that the frequencies do not depend on how a volume was divided.
histogram histogram_of(const volumes& all);
} // namespace cli
