// SPDX-License-Identifier: BSD-3-Clause
// The sets of effective voxels that distance transforms are timed on. Random sets come from a generator of their own, so that every run
// has the same.
//
//   sparse     one voxel in 1000, anywhere
//   clustered  every second voxel of 20 balls of radius size/20, anywhere
//   dense      every second voxel, anywhere
//   single     one voxel, off the middle
//   none, all
//   plate      one voxel thick, tilted against all axes, from an eighth to seven eighths of the box
//   shell      a hollow ball of radius .4 size, one voxel thick
#include "bench.h"
#include "distance.h"

#include <cmath>

namespace bench {

namespace {

struct chance {
  uint64_t state = 20251121;
  uint64_t below(uint64_t n)
  {
    state = state * 6364136223846793005u + 1442695040888963407u;
    return (state >> 33) % n;
  }
};

using set = std::vector<uint8_t>;

void fill_one_in(uint64_t n, set& effective)
{
  chance c;
  for (uint8_t& e : effective) {
    e = c.below(n) == 0;
  }
}

void fill_balls(int64_t size, set& effective)
{
  chance c;
  const auto edge = static_cast<uint64_t>(size);
  const int64_t radius = size / 20;
  for (int ball = 0; ball < 20; ++ball) {
    const int64_t x = static_cast<int64_t>(c.below(edge));
    const int64_t y = static_cast<int64_t>(c.below(edge));
    const int64_t z = static_cast<int64_t>(c.below(edge));
    for (int64_t k = std::max<int64_t>(z - radius, 0); k <= std::min(z + radius, size - 1); ++k) {
      for (int64_t j = std::max<int64_t>(y - radius, 0); j <= std::min(y + radius, size - 1); ++j) {
        for (int64_t i = std::max<int64_t>(x - radius, 0); i <= std::min(x + radius, size - 1); ++i) {
          if ((i - x) * (i - x) + (j - y) * (j - y) + (k - z) * (k - z) <= radius * radius && c.below(2) == 0) {
            effective[static_cast<size_t>((k * size + j) * size + i)] = 1;
          }
        }
      }
    }
  }
}

void fill_plate(int64_t size, set& effective)
{
  for (int64_t j = size / 8; j < size - size / 8; ++j) {
    for (int64_t i = size / 8; i < size - size / 8; ++i) {
      const double x = static_cast<double>(i) - 0.5 * static_cast<double>(size);
      const double y = static_cast<double>(j) - 0.5 * static_cast<double>(size);
      const auto k = static_cast<int64_t>(std::floor(0.5 * static_cast<double>(size) + 0.31 * x + 0.17 * y));
      effective[static_cast<size_t>((k * size + j) * size + i)] = 1;
    }
  }
}

void fill_shell(int64_t size, set& effective)
{
  const double centre = 0.5 * static_cast<double>(size - 1);
  const double radius = 0.4 * static_cast<double>(size);
  for (size_t v = 0; v < effective.size(); ++v) {
    const auto at = static_cast<int64_t>(v);
    const double x = static_cast<double>(at % size) - centre;
    const double y = static_cast<double>(at / size % size) - centre;
    const double z = static_cast<double>(at / (size * size)) - centre;
    effective[v] = std::fabs(std::sqrt(x * x + y * y + z * z) - radius) < 0.5;
  }
}
} // namespace

std::vector<std::string> distance_case_names()
{
  return { "sparse", "clustered", "dense", "single", "none", "all", "plate", "shell" };
}

distance_case make_distance_case(const std::string& name, int64_t size)
{
  distance_case c;
  c.name = name + "-" + std::to_string(size);
  c.size = size;
  c.effective.assign(static_cast<size_t>(size * size * size), 0);
  if (name == "sparse") {
    fill_one_in(1000, c.effective);
  } else if (name == "clustered") {
    fill_balls(size, c.effective);
  } else if (name == "dense") {
    fill_one_in(2, c.effective);
  } else if (name == "single") {
    c.effective[static_cast<size_t>((2 * size / 5 * size + size / 2) * size + size / 3)] = 1;
  } else if (name == "all") {
    c.effective.assign(c.effective.size(), 1);
  } else if (name == "plate") {
    fill_plate(size, c.effective);
  } else if (name == "shell") {
    fill_shell(size, c.effective);
  } else if (name != "none") {
    throw failure("unknown case " + name);
  }
  return c;
}
} // namespace bench
