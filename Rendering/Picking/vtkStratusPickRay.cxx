// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusPickRay.h"

#include "vtkPiecewiseFunction.h"

#include <algorithm>
#include <cmath>

// Between two points a piecewise function rises or falls all along, also with midpoints and sharpness.
double vtkStratusPickRay::GetMost(double a, double b) const
{
  double most = std::max(this->Opacity->GetValue(a), this->Opacity->GetValue(b));
  for (int i = 0; i < this->Opacity->GetSize(); ++i) {
    double node[4];
    this->Opacity->GetNodeValue(i, node);
    if (node[0] > std::min(a, b) && node[0] < std::max(a, b)) {
      most = std::max(most, node[1]);
    }
  }
  return most;
}

bool vtkStratusPickRay::FindInPiece(double from, double to, const std::function<double(double t)>& value, double& t) const
{
  const double first = value(from), last = value(to);
  if (!std::isfinite(first) || !std::isfinite(last) || !(this->GetMost(first, last) >= this->Bound)) {
    return false;
  }
  double low = from, high = to;
  if (this->Opacity->GetValue(first) >= this->Bound) {
    high = from;
  }
  for (int step = 0; step < 60 && high > low; ++step) {
    const double middle = 0.5 * (low + high);
    (this->GetMost(first, value(middle)) >= this->Bound ? high : low) = middle;
  }
  t = high;
  return true;
}
