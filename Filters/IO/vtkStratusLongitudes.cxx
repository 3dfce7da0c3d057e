// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusLongitudes.h"

#include "vtkStratusReaderCore.h"

#include "stratus/globe.h"

namespace vtkStratusLongitudes {

namespace {
bool IsMonotone(const std::vector<double>& values)
{
  for (size_t i = 1; i < values.size(); ++i) {
    if (!((values[i] - values[i - 1]) * (values[1] - values[0]) > 0.0)) {
      return false;
    }
  }
  return true;
}
} // namespace

bool Unwrap(std::vector<double>& degrees, const std::array<size_t, 3>& lengths, const std::array<size_t, 3>& strides)
{
  int64_t counts[3], steps[3];
  for (size_t axis = 0; axis < 3; ++axis) {
    counts[axis] = static_cast<int64_t>(lengths[axis]);
    steps[axis] = static_cast<int64_t>(strides[axis]);
  }
  int changed = 0;
  const vtkStratusReaderCore core;
  core.Check(stratus_longitudes_unwrap(core, counts, steps, degrees.data(), &changed), "longitudes: ");
  return changed != 0;
}

bool UnwrapAxis(std::vector<double>& degrees)
{
  std::vector<double> continuous = degrees;
  if (degrees.empty() || !Unwrap(continuous, { { degrees.size(), 1, 1 } }, { { 1, 0, 0 } }) || !IsMonotone(continuous)) {
    return false;
  }
  degrees = continuous;
  return true;
}
} // namespace vtkStratusLongitudes
