// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusBlockMask.h"

#include "vtkStratusMask.h"

#include "vtkDataArray.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkRectilinearGrid.h"
#include "vtkUnsignedCharArray.h"

#include <algorithm>

namespace {

// Where the values of an image or rectilinear grid are.
class Values
{
public:
  Values(vtkDataSet* block, bool cells)
      : Image(vtkImageData::SafeDownCast(block)), Grid(vtkRectilinearGrid::SafeDownCast(block)), Cells(cells)
  {
    if (this->Image) {
      this->Image->GetDimensions(this->Dimensions);
      this->Image->GetExtent(this->Extent);
    } else {
      this->Grid->GetDimensions(this->Dimensions);
    }
    for (int a = 0; a < 3; ++a) {
      this->Counts[a] = cells ? std::max(this->Dimensions[a] - 1, 1) : this->Dimensions[a];
    }
  }

  void GetPlace(const int at[3], double place[3]) const
  {
    double index[3];
    for (int a = 0; a < 3; ++a) {
      const bool between = this->Cells && this->Dimensions[a] > 1;
      if (this->Image) {
        index[a] = this->Extent[2 * a] + at[a] + (between ? 0.5 : 0.0);
        continue;
      }
      vtkDataArray* axis = a == 0 ? this->Grid->GetXCoordinates() : a == 1 ? this->Grid->GetYCoordinates() : this->Grid->GetZCoordinates();
      place[a] = between ? 0.5 * (axis->GetComponent(at[a], 0) + axis->GetComponent(at[a] + 1, 0)) : axis->GetComponent(at[a], 0);
    }
    if (this->Image) {
      this->Image->TransformContinuousIndexToPhysicalPoint(index, place);
    }
  }

  int Counts[3];

private:
  vtkImageData* Image;
  vtkRectilinearGrid* Grid;
  bool Cells;
  int Dimensions[3], Extent[6];
};

} // namespace

vtkImageData* vtkStratusBlockMask::Get(vtkImageData* mask, vtkDataSet* block, bool cells, std::string& error)
{
  vtkStratusMask bytes;
  if (!bytes.Set(mask, error)) {
    return nullptr;
  }
  const vtkMTimeType time = std::max(bytes.GetTime(), block->GetMTime());
  if (this->Part && this->Mask == mask && this->Of == block && this->Cells == cells && this->Time == time) {
    return this->Part;
  }
  const Values values(block, cells);
  int at[3];
  vtkNew<vtkUnsignedCharArray> part;
  part->SetNumberOfTuples(static_cast<vtkIdType>(values.Counts[0]) * values.Counts[1] * values.Counts[2]);
  unsigned char* to = part->GetPointer(0);
  for (at[2] = 0; at[2] < values.Counts[2]; ++at[2]) {
    for (at[1] = 0; at[1] < values.Counts[1]; ++at[1]) {
      for (at[0] = 0; at[0] < values.Counts[0]; ++at[0]) {
        double place[3];
        values.GetPlace(at, place);
        *to++ = bytes.GetAt(place);
      }
    }
  }
  this->Part = vtkSmartPointer<vtkImageData>::New();
  this->Part->SetDimensions(values.Counts);
  this->Part->GetPointData()->SetScalars(part);
  this->Mask = mask;
  this->Of = block;
  this->Cells = cells;
  this->Time = time;
  return this->Part;
}
