// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusMask.h"

#include "vtkImageData.h"
#include "vtkPointData.h"
#include "vtkUnsignedCharArray.h"

#include <algorithm>
#include <cmath>

bool vtkStratusMask::Set(vtkImageData* mask, std::string& error)
{
  this->Image = mask;
  this->Bytes = vtkUnsignedCharArray::SafeDownCast(mask->GetPointData()->GetScalars());
  mask->GetExtent(this->Extent);
  if (!this->Bytes || this->Bytes->GetNumberOfComponents() != 1 || this->Bytes->GetNumberOfTuples() < mask->GetNumberOfPoints()) {
    error = "MaskInput has no point scalars of one unsigned char each";
    return false;
  }
  return true;
}

vtkMTimeType vtkStratusMask::GetTime() const
{
  return std::max(this->Image->GetMTime(), this->Bytes->GetMTime());
}

unsigned char vtkStratusMask::GetAt(const double place[3]) const
{
  double index[3];
  int nearest[3];
  bool inside = true;
  this->Image->TransformPhysicalPointToContinuousIndex(place, index);
  for (int a = 0; a < 3; ++a) {
    nearest[a] = static_cast<int>(std::floor(std::min(std::max(index[a], -1e9), 1e9) + 0.5));
    inside = inside && nearest[a] >= this->Extent[2 * a] && nearest[a] <= this->Extent[2 * a + 1];
  }
  return inside ? this->Bytes->GetValue(this->Image->ComputePointId(nearest)) : 0;
}
