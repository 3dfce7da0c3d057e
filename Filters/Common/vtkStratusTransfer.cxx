// SPDX-License-Identifier: BSD-3-Clause
// Converts vtkVolumeProperty's functions to the core's piecewise linear ones. Functions that are piecewise linear are copied exactly,
// others are sampled densely.
#include "vtkStratusInput.h"

#include "vtkColorTransferFunction.h"
#include "vtkPiecewiseFunction.h"
#include "vtkVolumeProperty.h"

#include <algorithm>
#include <cmath>

namespace {
constexpr int SamplesOfAFunction = 4096;

// Returns positions at which to sample a function that is curved between its nodes. Each interval is divided evenly (in the logarithm where
// the function's axis is logarithmic). Two positions enclose its midpoint, where a sharp node makes a step.
std::vector<double> DensePositions(const std::vector<double>& nodes, const std::vector<double>& midpoints, bool logarithmic)
{
  std::vector<double> positions;
  const int pieces = std::max(16, SamplesOfAFunction / static_cast<int>(std::max<size_t>(nodes.size(), 2) - 1));
  for (size_t n = 0; n + 1 < nodes.size(); ++n) {
    const double a = nodes[n], b = nodes[n + 1];
    const bool logs = logarithmic && a > 0.0 && b > 0.0;
    const auto at = [&](double t) { return logs ? a * std::pow(b / a, t) : a + t * (b - a); };
    for (int p = 0; p < pieces; ++p) {
      positions.push_back(at(static_cast<double>(p) / pieces));
    }
    positions.push_back(at(std::max(0.0, midpoints[n] - 1e-7)));
    positions.push_back(at(std::min(1.0, midpoints[n] + 1e-7)));
    positions.push_back(std::nextafter(b, a)); // the value left of a step at the next node
  }
  positions.push_back(nodes.back());
  std::sort(positions.begin(), positions.end());
  positions.erase(std::unique(positions.begin(), positions.end()), positions.end());
  return positions;
}

bool IsStraight(double midpoint, double sharpness)
{
  return midpoint == 0.5 && sharpness == 0.0;
}

// Appends each node as its position and `values` equal values. Returns false where the function has no node.
bool AppendPiecewise(vtkPiecewiseFunction* function, size_t values, std::vector<double>& result)
{
  std::vector<double> nodes, midpoints;
  bool exact = !function->GetUseLogScale();
  for (int n = 0; n < function->GetSize(); ++n) {
    double node[4];
    function->GetNodeValue(n, node);
    nodes.push_back(node[0]);
    midpoints.push_back(node[2]);
    exact = exact && IsStraight(node[2], node[3]);
    result.push_back(node[0]);
    result.insert(result.end(), values, node[1]);
  }
  if (!exact && nodes.size() > 1) {
    result.clear();
    for (double x : DensePositions(nodes, midpoints, function->GetUseLogScale())) {
      result.push_back(x);
      result.insert(result.end(), values, function->GetValue(x));
    }
  }
  return !nodes.empty();
}

void AppendColor(std::vector<double>& result, double x, const double rgb[3])
{
  const double node[4] = { x, rgb[0], rgb[1], rgb[2] };
  result.insert(result.end(), node, node + 4);
}

bool AppendColors(vtkColorTransferFunction* function, std::vector<double>& result)
{
  std::vector<double> nodes, midpoints;
  // Only VTK's own class is known to interpolate linearly: a derived class may colour otherwise (discretised, indexed).
  bool exact = std::string(function->GetClassName()) == "vtkColorTransferFunction" && function->GetColorSpace() == VTK_CTF_RGB &&
    function->GetScale() == VTK_CTF_LINEAR;
  for (int n = 0; n < function->GetSize(); ++n) {
    double node[6];
    function->GetNodeValue(n, node);
    nodes.push_back(node[0]);
    midpoints.push_back(node[4]);
    exact = exact && IsStraight(node[4], node[5]);
    AppendColor(result, node[0], node + 1);
  }
  if (nodes.empty()) {
    return false;
  }
  if (!exact && nodes.size() > 1) {
    result.clear();
    for (double x : DensePositions(nodes, midpoints, function->GetScale() == VTK_CTF_LOG10)) {
      double rgb[3];
      function->GetColor(x, rgb);
      for (double& channel : rgb) { // some colour spaces overshoot
        channel = std::min(1.0, std::max(0.0, channel));
      }
      AppendColor(result, x, rgb);
    }
  }
  if (!function->GetClamping()) { // black beyond the ends, by a step at each end
    const double black[3] = { 0, 0, 0 };
    const double first[4] = { nodes.front(), 0, 0, 0 };
    result.insert(result.begin(), first, first + 4);
    AppendColor(result, nodes.back(), black);
  }
  return true;
}
// Appends nothing where the function is 1 everywhere. A function that does not clamp is 0 beyond its ends, by a step at each end.
void AppendGradient(vtkPiecewiseFunction* function, std::vector<double>& result)
{
  if (!AppendPiecewise(function, 1, result)) {
    return;
  }
  bool plain = true;
  for (size_t i = 1; i < result.size(); i += 2) {
    plain = plain && result[i] == 1.0;
  }
  if (!function->GetClamping()) {
    const double first[2] = { result[0], 0.0 };
    const double last[2] = { result[result.size() - 2], 0.0 };
    result.insert(result.begin(), first, first + 2);
    result.insert(result.end(), last, last + 2);
  } else if (plain) {
    result.clear();
  }
}
} // namespace

bool vtkStratusTransferView::Set(vtkVolumeProperty* property, int index, std::string& error)
{
  this->Opacity.clear();
  this->Color.clear();
  this->Gradient.clear();
  vtkPiecewiseFunction* opacity = property->GetScalarOpacity(index);
  if (!AppendPiecewise(opacity, 1, this->Opacity)) {
    error = "the scalar opacity function has no points, it needs at least 1";
    return false;
  }
  const bool colored = property->GetColorChannels(index) == 3 ? AppendColors(property->GetRGBTransferFunction(index), this->Color)
                                                              : AppendPiecewise(property->GetGrayTransferFunction(index), 3, this->Color);
  if (!colored) {
    error = "the colour transfer function has no points, it needs at least 1";
    return false;
  }
  this->Transfer = stratus_transfer_default();
  this->Transfer.opacity = this->Opacity.data();
  this->Transfer.opacity_count = this->Opacity.size() / 2;
  this->Transfer.color = this->Color.data();
  this->Transfer.color_count = this->Color.size() / 4;
  if (!property->GetDisableGradientOpacity(index) && property->HasGradientOpacity(index)) {
    AppendGradient(property->GetGradientOpacity(index), this->Gradient);
  }
  this->Transfer.gradient = this->Gradient.empty() ? nullptr : this->Gradient.data();
  this->Transfer.gradient_count = this->Gradient.size() / 2;
  this->Transfer.weight = property->GetComponentWeight(index);
  this->Transfer.unit_distance = property->GetScalarOpacityUnitDistance(index);
  this->Transfer.clamp = opacity->GetClamping() ? 1 : 0;
  return true;
}

bool vtkStratusTransferView::SetLabel(vtkVolumeProperty* property, int label, std::string& error)
{
  vtkPiecewiseFunction* opacity = property->GetLabelScalarOpacity(label);
  vtkColorTransferFunction* color = property->GetLabelColor(label);
  if (!this->Set(property, 0, error)) {
    return false;
  }
  if (opacity) {
    this->Opacity.clear();
    if (!AppendPiecewise(opacity, 1, this->Opacity)) {
      error = "the scalar opacity function of label " + std::to_string(label) + " has no points, it needs at least 1";
      return false;
    }
    this->Transfer.clamp = opacity->GetClamping() ? 1 : 0;
  }
  if (color) {
    this->Color.clear();
    if (!AppendColors(color, this->Color)) {
      error = "the colour transfer function of label " + std::to_string(label) + " has no points, it needs at least 1";
      return false;
    }
  }
  this->Transfer.opacity = this->Opacity.data();
  this->Transfer.opacity_count = this->Opacity.size() / 2;
  this->Transfer.color = this->Color.data();
  this->Transfer.color_count = this->Color.size() / 4;
  this->Transfer.gradient = nullptr;
  this->Transfer.gradient_count = 0;
  return true;
}
