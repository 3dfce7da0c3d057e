// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusSheet.h"

#include "vtkCellData.h"
#include "vtkDoubleArray.h"
#include "vtkIdList.h"
#include "vtkImageData.h"
#include "vtkMatrix3x3.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkRectilinearGrid.h"

#include <algorithm>
#include <cmath>

namespace {
bool FindDimensions(vtkDataSet* grid, int dimensions[3])
{
  if (auto* image = vtkImageData::SafeDownCast(grid)) {
    image->GetDimensions(dimensions);
  } else if (auto* rectilinear = vtkRectilinearGrid::SafeDownCast(grid)) {
    rectilinear->GetDimensions(dimensions);
  } else {
    return false;
  }
  return dimensions[0] > 0 && dimensions[1] > 0 && dimensions[2] > 0;
}

vtkDataArray* FindAxis(vtkRectilinearGrid* grid, int axis)
{
  return axis == 0 ? grid->GetXCoordinates() : axis == 1 ? grid->GetYCoordinates() : grid->GetZCoordinates();
}

// Whether a rectilinear grid has a coordinate for each point.
bool HasCoordinates(vtkRectilinearGrid* grid, const int dimensions[3])
{
  bool all = true;
  for (int a = 0; a < 3; ++a) {
    vtkDataArray* axis = FindAxis(grid, a);
    all = all && axis && axis->GetNumberOfTuples() == dimensions[a];
  }
  return all;
}

// Returns the mean spacing along an axis; 0: it has none.
double FindSpacing(vtkDataSet* grid, int axis, int points)
{
  if (auto* image = vtkImageData::SafeDownCast(grid)) {
    return std::fabs(image->GetSpacing()[axis]);
  }
  vtkDataArray* coordinates = FindAxis(vtkRectilinearGrid::SafeDownCast(grid), axis);
  const bool known = coordinates && points > 1 && coordinates->GetNumberOfTuples() == points;
  return known ? std::fabs(coordinates->GetComponent(points - 1, 0) - coordinates->GetComponent(0, 0)) / (points - 1) : 0.0;
}

// Copies the values of points, each twice along flat axes.
void CopyPoints(vtkDataSet* from, vtkDataSet* to, const int dimensions[3], const double thickness[3])
{
  vtkNew<vtkIdList> sources, targets;
  const int size[3] = { thickness[0] > 0.0 ? 2 : dimensions[0], thickness[1] > 0.0 ? 2 : dimensions[1],
    thickness[2] > 0.0 ? 2 : dimensions[2] };
  const vtkIdType count = static_cast<vtkIdType>(size[0]) * size[1] * size[2];
  sources->SetNumberOfIds(count);
  targets->SetNumberOfIds(count);
  for (vtkIdType id = 0; id < count; ++id) {
    const vtkIdType at[3] = { id % size[0], id / size[0] % size[1], id / size[0] / size[1] };
    vtkIdType source = 0;
    for (int a = 2; a >= 0; --a) {
      source = source * dimensions[a] + (thickness[a] > 0.0 ? 0 : at[a]);
    }
    sources->SetId(id, source);
    targets->SetId(id, id);
  }
  to->GetPointData()->CopyAllOn();
  to->GetPointData()->CopyAllocate(from->GetPointData(), count);
  to->GetPointData()->CopyData(from->GetPointData(), sources, targets);
}
} // namespace

bool vtkStratusSheet::FindThickness(vtkDataSet* grid, double thickness[3])
{
  int dimensions[3];
  std::fill_n(thickness, 3, 0.0);
  if (!FindDimensions(grid, dimensions) || (dimensions[0] > 1 && dimensions[1] > 1 && dimensions[2] > 1)) {
    return false;
  }
  auto* rectilinear = vtkRectilinearGrid::SafeDownCast(grid);
  if (rectilinear && !HasCoordinates(rectilinear, dimensions)) {
    return false; // which is an error elsewhere
  }
  double sum = 0.0;
  int extended = 0;
  for (int a = 0; a < 3; ++a) {
    if (dimensions[a] > 1) {
      sum += FindSpacing(grid, a, dimensions[a]);
      ++extended;
    }
  }
  const double mean = sum > 0.0 && std::isfinite(sum) ? sum / extended : 1.0;
  for (int a = 0; a < 3; ++a) {
    const double own = dimensions[a] > 1 ? 0.0 : FindSpacing(grid, a, dimensions[a]);
    thickness[a] = dimensions[a] > 1 ? 0.0 : own > 0.0 && std::isfinite(own) ? own : mean;
  }
  return true;
}

vtkDataSet* vtkStratusSheet::Get(vtkDataSet* grid)
{
  double thickness[3];
  if (!grid || !FindThickness(grid, thickness)) {
    this->Thick = nullptr;
    return grid;
  }
  if (this->Thick && this->Of == grid && this->Time == grid->GetMTime()) {
    return this->Thick;
  }
  int dimensions[3];
  FindDimensions(grid, dimensions);
  if (auto* image = vtkImageData::SafeDownCast(grid)) {
    vtkNew<vtkImageData> made;
    int extent[6];
    double origin[3], spacing[3];
    image->GetExtent(extent);
    image->GetOrigin(origin);
    image->GetSpacing(spacing);
    const double* direction = image->GetDirectionMatrix()->GetData();
    for (int a = 0; a < 3; ++a) {
      if (thickness[a] > 0.0) {
        // the first of the two layers lies half the thickness before the one
        const double shift = extent[2 * a] * (spacing[a] - thickness[a]) - 0.5 * thickness[a];
        for (int b = 0; b < 3; ++b) {
          origin[b] += direction[3 * b + a] * shift;
        }
        spacing[a] = thickness[a];
        extent[2 * a + 1] = extent[2 * a] + 1;
      }
    }
    made->SetExtent(extent);
    made->SetOrigin(origin);
    made->SetSpacing(spacing);
    made->SetDirectionMatrix(image->GetDirectionMatrix());
    this->Thick = made;
  } else {
    auto* rectilinear = vtkRectilinearGrid::SafeDownCast(grid);
    vtkNew<vtkRectilinearGrid> made;
    int extent[6];
    rectilinear->GetExtent(extent);
    vtkSmartPointer<vtkDataArray> axes[3];
    for (int a = 0; a < 3; ++a) {
      axes[a] = FindAxis(rectilinear, a);
      if (thickness[a] > 0.0) {
        vtkNew<vtkDoubleArray> two;
        const double place = axes[a]->GetComponent(0, 0);
        two->InsertNextValue(place - 0.5 * thickness[a]);
        two->InsertNextValue(place + 0.5 * thickness[a]);
        axes[a] = two;
        extent[2 * a + 1] = extent[2 * a] + 1;
      }
    }
    made->SetExtent(extent);
    made->SetXCoordinates(axes[0]);
    made->SetYCoordinates(axes[1]);
    made->SetZCoordinates(axes[2]);
    this->Thick = made;
  }
  CopyPoints(grid, this->Thick, dimensions, thickness);
  this->Thick->GetCellData()->ShallowCopy(grid->GetCellData());
  this->Of = grid;
  this->Time = grid->GetMTime();
  return this->Thick;
}
