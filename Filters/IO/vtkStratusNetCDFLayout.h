// SPDX-License-Identifier: BSD-3-Clause
// Which dimensions of a netCDF variable are x, y, z and time, and at which index the others are read. Private to the module.
#ifndef vtkStratusNetCDFLayout_h
#define vtkStratusNetCDFLayout_h

#include "vtkStratusNetCDFModel.h"

#include <array>
#include <functional>
#include <string>
#include <vector>

class vtkStratusNetCDFLayout
{
public:
  // axis_of: returns 0, 1, 2 for a dimension along x, y, z, and -1 for one without a named axis.
  //
  // Dimensions of one value and dimensions that the file's selection names are no axes. Of two times the last is the time. If more than
  // three dimensions are left, the three for which axis_of names an axis are the axes, otherwise the last three. The outermost one of the
  // others is the time if the variable has no other time and this dimension no coordinates. All others, including an ensemble, are read at
  // index 0.
  vtkStratusNetCDFLayout(
    const vtkStratusNetCDFModel& file, const vtkStratusNetCDFModel::Variable& variable, const std::function<int(int dimension)>& axis_of);

  bool IsVolume() const { return this->Count == 3; }
  size_t GetCount() const { return this->Count; } // of axes; more than three are three
  // The dimensions of x, y, z, if the variable is a volume.
  const std::array<int, 3>& GetAxes() const { return this->Axes; }
  int GetTime() const { return this->Time; } // -1: none
  // Returns whether this dimension is read at one index: the variable's own time at the step, others at the selected one.
  bool IsFixed(int dimension) const { return this->File.IsSelected(dimension) || this->IsOther(dimension); }
  size_t IndexOf(int dimension, size_t step) const { return dimension == this->Time ? step : this->File.IndexOf(dimension); }
  // Returns "; ..." for each dimension that is read at one of several indices, "" if there is none.
  std::string Describe() const;

private:
  bool IsOther(int dimension) const;
  bool IsEnsemble(int dimension) const;
  void FindTime();
  void LeaveThree(std::vector<int>& space, const std::function<int(int)>& axis_of);
  void Sort(const std::vector<int>& space, const std::function<int(int)>& axis_of);

  const vtkStratusNetCDFModel& File;
  const vtkStratusNetCDFModel::Variable& Of;
  std::array<int, 3> Axes = { { -1, -1, -1 } };
  size_t Count = 0;
  int Time = -1;
  std::vector<int> Others; // dimensions of several values that are neither axes nor time nor selected
};

#endif
