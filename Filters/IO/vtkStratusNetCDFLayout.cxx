// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusNetCDFLayout.h"
#include "vtkStratusText.h"

#include <algorithm>

vtkStratusNetCDFLayout::vtkStratusNetCDFLayout(
  const vtkStratusNetCDFModel& file, const vtkStratusNetCDFModel::Variable& variable, const std::function<int(int dimension)>& axis_of)
    : File(file), Of(variable)
{
  this->FindTime();
  std::vector<int> space;
  for (int dimension : variable.Dimensions) {
    if (file.IsSpread(dimension) && dimension != this->Time) {
      const bool other = file.IsTime(dimension) || this->IsEnsemble(dimension);
      (other ? this->Others : space).push_back(dimension);
    }
  }
  if (space.size() > 3) {
    this->LeaveThree(space, axis_of);
  }
  this->Count = space.size();
  if (this->Count == 3) {
    this->Sort(space, axis_of);
  }
}

// The last time that has several steps, else the last one.
void vtkStratusNetCDFLayout::FindTime()
{
  for (int dimension : this->Of.Dimensions) {
    if (this->File.IsTime(dimension) && (this->Time < 0 || this->File.LengthOf(dimension) > 1 || this->File.LengthOf(this->Time) <= 1)) {
      this->Time = dimension;
    }
  }
}

bool vtkStratusNetCDFLayout::IsEnsemble(int dimension) const
{
  static const std::vector<std::string> names = { "number", "member", "members", "ensemble", "ens", "realization", "realisation",
    "sample" };
  const vtkStratusNetCDFModel::Variable* own = this->File.CoordinateOf(dimension);
  const std::string name = vtkStratusLowerCase(this->File.NameOf(dimension));
  return std::find(names.begin(), names.end(), name) != names.end() || name.compare(0, 8, "ensemble") == 0 ||
    (own && (this->File.Text(*own, "standard_name") == "realization" || this->File.Text(*own, "axis") == "E"));
}

void vtkStratusNetCDFLayout::LeaveThree(std::vector<int>& space, const std::function<int(int)>& axis_of)
{
  const int outermost = space[0];
  const auto named = [&](int dimension) { return axis_of(dimension) >= 0; };
  while (space.size() > 3) {
    const auto unnamed = std::find_if_not(space.begin(), space.end(), named);
    const auto drop = unnamed == space.end() ? space.begin() : unnamed;
    if (*drop == outermost && this->Time < 0 && !this->File.CoordinateOf(outermost)) {
      this->Time = outermost;
    } else {
      this->Others.push_back(*drop);
    }
    space.erase(drop);
  }
}

// By the metadata of the dimensions' coordinates, if that names each axis once; otherwise x is the last.
void vtkStratusNetCDFLayout::Sort(const std::vector<int>& space, const std::function<int(int)>& axis_of)
{
  this->Axes = { { space[2], space[1], space[0] } };
  std::array<int, 3> named = { { -1, -1, -1 } };
  for (int dimension : space) {
    const int axis = axis_of(dimension);
    if (axis < 0 || named[static_cast<size_t>(axis)] >= 0) {
      return;
    }
    named[static_cast<size_t>(axis)] = dimension;
  }
  this->Axes = named;
}

bool vtkStratusNetCDFLayout::IsOther(int dimension) const
{
  return std::find(this->Others.begin(), this->Others.end(), dimension) != this->Others.end();
}

std::string vtkStratusNetCDFLayout::Describe() const
{
  std::string text;
  for (int dimension : this->Of.Dimensions) {
    text += this->IsFixed(dimension) ? this->File.DescribeIndex(dimension) : "";
  }
  return text;
}
