// SPDX-License-Identifier: BSD-3-Clause
#include "histogram.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <limits>

namespace {

int64_t number_of(const stratus_volume& v)
{
  return v.dimensions[0] * v.dimensions[1] * v.dimensions[2];
}

using position = std::array<double, 3>;

// World position of a value, without the matrix, which all blocks share.
position position_of(const stratus_volume& v, const std::array<int64_t, 3>& at)
{
  position local, result;
  for (size_t a = 0; a < 3; ++a) {
    local[a] = v.coordinates[a] ? v.coordinates[a][at[a]] : v.spacing[a] * static_cast<double>(at[a]);
  }
  for (size_t r = 0; r < 3; ++r) {
    result[r] = v.origin[r] + v.direction[3 * r] * local[0] + v.direction[3 * r + 1] * local[1] + v.direction[3 * r + 2] * local[2];
  }
  return result;
}

struct box {
  position low, high;

  // With a slack of a millionth of a cell, since the coordinates of two blocks are rounded apart.
  explicit box(const stratus_volume& v)
  {
    this->low.fill(std::numeric_limits<double>::infinity());
    this->high.fill(-std::numeric_limits<double>::infinity());
    for (int corner = 0; corner < 8; ++corner) {
      std::array<int64_t, 3> at;
      for (size_t a = 0; a < 3; ++a) {
        at[a] = corner >> a & 1 ? v.dimensions[a] - 1 : 0;
      }
      const position p = position_of(v, at);
      for (size_t a = 0; a < 3; ++a) {
        this->low[a] = std::min(this->low[a], p[a]);
        this->high[a] = std::max(this->high[a], p[a]);
      }
    }
    const double slack = 1e-6 * std::min({ std::fabs(v.spacing[0]), std::fabs(v.spacing[1]), std::fabs(v.spacing[2]) });
    for (size_t a = 0; a < 3; ++a) {
      this->low[a] -= slack;
      this->high[a] += slack;
    }
  }
  bool meets(const box& other) const
  {
    bool all = true;
    for (size_t a = 0; a < 3; ++a) {
      all = all && this->low[a] <= other.high[a] && other.low[a] <= this->high[a];
    }
    return all;
  }
  bool contains(const position& p) const
  {
    bool all = true;
    for (size_t a = 0; a < 3; ++a) {
      all = all && this->low[a] <= p[a] && p[a] <= this->high[a];
    }
    return all;
  }
};

// A point on the border of a block that an earlier block has, too.
struct shared_value {
  const stratus_volume* volume;
  int64_t index;
};
using shared_values = std::vector<shared_value>;

void find_shared(const stratus_volume& v, const std::vector<box>& earlier, shared_values& result)
{
  const int64_t* n = v.dimensions;
  for (int64_t z = 0; z < n[2] && !earlier.empty(); ++z) {
    for (int64_t y = 0; y < n[1]; ++y) {
      const bool whole_row = z == 0 || z == n[2] - 1 || y == 0 || y == n[1] - 1;
      for (int64_t x = 0; x < n[0]; x += whole_row || n[0] < 2 ? 1 : n[0] - 1) {
        const position p = position_of(v, { x, y, z });
        if (std::any_of(earlier.begin(), earlier.end(), [&p](const box& other) { return other.contains(p); })) {
          result.push_back({ &v, x + n[0] * (y + n[1] * z) });
        }
      }
    }
  }
}

shared_values find_shared(const cli::volumes& all)
{
  shared_values result;
  std::vector<box> boxes;
  for (const stratus_volume* volume : all) {
    boxes.emplace_back(*volume);
    std::vector<box> touching;
    std::copy_if(boxes.begin(), boxes.end() - 1, std::back_inserter(touching), [&](const box& b) { return b.meets(boxes.back()); });
    if (!volume->cell_centered) {
      find_shared(*volume, touching, result);
    }
  }
  return result;
}

template <class T, class Each> void each_value(const cli::volumes& all, const Each& each)
{
  for (const stratus_volume* volume : all) {
    each(static_cast<const T*>(volume->values), number_of(*volume), volume->value_stride);
  }
}

template <class T> void count_values(const cli::volumes& all, const shared_values& shared, cli::histogram& h)
{
  double low = std::numeric_limits<double>::infinity();
  double high = -low, number = 0.0;
  each_value<T>(all, [&](const T* values, int64_t n, int64_t stride) {
    number += static_cast<double>(n);
#pragma omp parallel for reduction(min : low) reduction(max : high)
    for (int64_t i = 0; i < n; ++i) {
      const double value = static_cast<double>(values[i * stride]);
      if (std::isfinite(value)) {
        low = std::min(low, value);
        high = std::max(high, value);
      }
    }
  });
  h.low = low;
  h.high = high;
  if (low > high) {
    h.not_finite = number - static_cast<double>(shared.size());
    return;
  }
  // If the range holds few integers, each gets a bin of its own, so that no bin mixes the background with visible values.
  const bool integers = std::numeric_limits<T>::is_integer && high - low < 1024.0;
  const size_t bins = low == high ? 1 : integers ? static_cast<size_t>(high - low) + 1 : 1024;
  h.first = integers ? low - 0.5 : low;
  h.last = integers ? high + 0.5 : high;
  const double scale = low == high ? 0.0 : static_cast<double>(bins) / (h.last - h.first);
  const auto bin_of = [&h, scale, bins](double value) {
    return std::isfinite(value) ? std::min(static_cast<size_t>((value - h.first) * scale), bins - 1) : bins;
  };
  std::vector<int64_t> total(bins + 1, 0);
  each_value<T>(all, [&](const T* values, int64_t n, int64_t stride) {
#pragma omp parallel
    {
      std::vector<int64_t> mine(bins + 1, 0);
#pragma omp for nowait
      for (int64_t i = 0; i < n; ++i) {
        const double value = static_cast<double>(values[i * stride]);
        ++mine[bin_of(value)];
      }
#pragma omp critical
      std::transform(total.begin(), total.end(), mine.begin(), total.begin(), [](int64_t a, int64_t b) { return a + b; });
    }
  });
  for (const shared_value& again : shared) {
    const double value = static_cast<double>(static_cast<const T*>(again.volume->values)[again.index * again.volume->value_stride]);
    --total[bin_of(value)];
  }
  number -= static_cast<double>(shared.size());
  h.count.assign(total.begin(), total.end() - 1);
  h.not_finite = static_cast<double>(total[bins]);
  h.finite = number - h.not_finite;
}
} // namespace

namespace cli {

histogram histogram_of(const volumes& all)
{
  const shared_values shared = find_shared(all);
  histogram h;
  switch (all[0]->type) {
    case STRATUS_INT8:
      count_values<int8_t>(all, shared, h);
      break;
    case STRATUS_UINT8:
      count_values<uint8_t>(all, shared, h);
      break;
    case STRATUS_INT16:
      count_values<int16_t>(all, shared, h);
      break;
    case STRATUS_UINT16:
      count_values<uint16_t>(all, shared, h);
      break;
    case STRATUS_INT32:
      count_values<int32_t>(all, shared, h);
      break;
    case STRATUS_UINT32:
      count_values<uint32_t>(all, shared, h);
      break;
    case STRATUS_INT64:
      count_values<int64_t>(all, shared, h);
      break;
    case STRATUS_UINT64:
      count_values<uint64_t>(all, shared, h);
      break;
    case STRATUS_FLOAT32:
      count_values<float>(all, shared, h);
      break;
    case STRATUS_FLOAT64:
      count_values<double>(all, shared, h);
      break;
  }
  return h;
}
} // namespace cli
