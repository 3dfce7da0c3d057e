// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusCellFinder.h"

#include "vtkStratusUncut.h"
#include "vtkStratusVersions.h"

#include "vtkCompositeDataIterator.h"
#include "vtkCompositeDataSet.h"
#include "vtkDataSet.h"
#include "vtkGenericCell.h"
#include "vtkIdList.h"
#include "vtkImageData.h"
#include "vtkMath.h"
#include "vtkMatrix4x4.h"
#include "vtkNew.h"
#include "vtkRectilinearGrid.h"
#include "vtkStaticCellLocator.h"
#include "vtkStructuredData.h"

#include <algorithm>
#include <cmath>

namespace {
// How far a place is moved along the ray, in cell lengths: the reported place is on a cell's border, up to rounding.
constexpr double NUDGE = 1e-3;

double Outside(const double bounds[6], const double place[3])
{
  double most = 0.0;
  for (int a = 0; a < 3; ++a) {
    most = std::max({ most, bounds[2 * a] - place[a], place[a] - bounds[2 * a + 1] });
  }
  return most;
}

vtkIdType NearestPoint(vtkDataSet* data, vtkIdList* points, const double place[3])
{
  vtkIdType nearest = -1;
  double least = VTK_DOUBLE_MAX;
  for (vtkIdType i = 0; i < points->GetNumberOfIds(); ++i) {
    double point[3];
    data->GetPoint(points->GetId(i), point);
    const double square = vtkMath::Distance2BetweenPoints(point, place);
    if (square < least) {
      least = square;
      nearest = points->GetId(i);
    }
  }
  return nearest;
}

vtkIdType FindInImage(vtkImageData* image, const double place[3], bool points)
{
  double index[3];
  int ijk[3];
  const int* extent = image->GetExtent();
  image->TransformPhysicalPointToContinuousIndex(place, index);
  for (int a = 0; a < 3; ++a) {
    const int last = points ? extent[2 * a + 1] : std::max(extent[2 * a + 1] - 1, extent[2 * a]);
    const double whole = std::floor(points ? index[a] + 0.5 : index[a]);
    ijk[a] = static_cast<int>(std::min(std::max(whole, static_cast<double>(extent[2 * a])), static_cast<double>(last)));
  }
  const int* numbered = vtkStratusGetUncut(image); // of a part of a box of AMR, as in the box
  return points ? vtkStructuredData::ComputePointIdForExtent(numbered, ijk) : vtkStructuredData::ComputeCellIdForExtent(numbered, ijk);
}

// Returns the number of an image's points, which its numbers of points and cells are below.
vtkIdType CountNumbers(vtkImageData* image)
{
  const int* e = vtkStratusGetUncut(image);
  return vtkIdType(e[1] - e[0] + 1) * (e[3] - e[2] + 1) * (e[5] - e[4] + 1);
}

vtkIdType FindInRectilinear(vtkRectilinearGrid* grid, const double bounds[6], const double place[3], bool points)
{
  double within[3], share[3];
  int ijk[3];
  for (int a = 0; a < 3; ++a) {
    within[a] = std::min(std::max(place[a], bounds[2 * a]), bounds[2 * a + 1]);
  }
  if (!vtkStratusFindCell(grid, within, ijk, share)) {
    return -1;
  }
  for (int a = 0; points && a < 3; ++a) {
    ijk[a] += share[a] > 0.5 ? 1 : 0;
  }
  return points ? grid->ComputePointId(ijk) : grid->ComputeCellId(ijk);
}
} // namespace

vtkStratusCellFinder::vtkStratusCellFinder()
{
  vtkMatrix4x4::Identity(this->ToData);
}

vtkStratusCellFinder::~vtkStratusCellFinder() = default;

void vtkStratusCellFinder::Set(vtkDataObject* input, vtkMatrix4x4* matrix)
{
  std::vector<Grid> before;
  std::swap(before, this->Grids);
  this->Most = 0;
  auto* composite = vtkCompositeDataSet::SafeDownCast(input);
  this->IsComposite = composite != nullptr;
  if (composite) {
    const auto each = vtkSmartPointer<vtkCompositeDataIterator>::Take(composite->NewIterator());
    for (each->InitTraversal(); !each->IsDoneWithTraversal(); each->GoToNextItem()) {
      this->Add(vtkDataSet::SafeDownCast(each->GetCurrentDataObject()), each->GetCurrentFlatIndex(), before);
    }
  } else {
    this->Add(vtkDataSet::SafeDownCast(input), 0, before);
  }
  // Where boxes of AMR overlap, the finest is shown.
  std::stable_sort(this->Grids.begin(), this->Grids.end(), [](const Grid& a, const Grid& b) { return a.Length < b.Length; });
  vtkMatrix4x4::Identity(this->ToData);
  if (matrix) {
    vtkMatrix4x4::Invert(&matrix->Element[0][0], this->ToData);
  }
}

void vtkStratusCellFinder::Add(vtkDataSet* data, unsigned int block, std::vector<Grid>& before)
{
  if (!data || data->GetNumberOfCells() == 0) {
    return;
  }
  Grid grid;
  auto* const image = vtkImageData::SafeDownCast(data);
  grid.Data = data;
  grid.Block = block;
  data->GetBounds(grid.Bounds);
  // Of an image, whatever its shape, because this orders boxes of AMR by their level.
  grid.Length = image ? vtkMath::Norm(image->GetSpacing()) : data->GetLength() / std::cbrt(static_cast<double>(data->GetNumberOfCells()));
  if (!image && !vtkRectilinearGrid::SafeDownCast(data)) {
    const auto same = [data](const Grid& other) { return other.Data == data && other.Locator && other.Time == data->GetMTime(); };
    const auto found = std::find_if(before.begin(), before.end(), same);
    grid.Time = data->GetMTime();
    if (found != before.end()) {
      grid.Locator = found->Locator;
    } else {
      grid.Locator = vtkSmartPointer<vtkStaticCellLocator>::New();
      grid.Locator->SetDataSet(data);
      grid.Locator->BuildLocator();
    }
  }
  this->Most = std::max({ this->Most, data->GetNumberOfCells(), image ? CountNumbers(image) : data->GetNumberOfPoints() });
  this->Grids.push_back(grid);
}

// nearest: in a mesh, the nearest cell where none holds the place.
vtkIdType vtkStratusCellFinder::FindIn(const Grid& grid, const double place[3], bool points, bool nearest)
{
  if (auto* image = vtkImageData::SafeDownCast(grid.Data)) {
    return FindInImage(image, place, points);
  }
  if (auto* rectilinear = vtkRectilinearGrid::SafeDownCast(grid.Data)) {
    return FindInRectilinear(rectilinear, grid.Bounds, place, points);
  }
  double copy[3] = { place[0], place[1], place[2] }, closest[3], square;
  int part = 0;
  vtkIdType number = grid.Locator->FindCell(copy);
  if (number < 0 && nearest) {
    grid.Locator->FindClosestPoint(copy, closest, this->Cell, number, part, square);
  }
  if (number < 0 || !points) {
    return number;
  }
  vtkNew<vtkIdList> corners;
  grid.Data->GetCellPoints(number, corners);
  return NearestPoint(grid.Data, corners, place);
}

vtkStratusCellFinder::Found vtkStratusCellFinder::Find(const double place[3], const double direction[3], bool points)
{
  double end[4] = { place[0] + direction[0], place[1] + direction[1], place[2] + direction[2], 1.0 }, along[3];
  double start[4] = { place[0], place[1], place[2], 1.0 };
  vtkMatrix4x4::MultiplyPoint(this->ToData, start, start);
  vtkMatrix4x4::MultiplyPoint(this->ToData, end, end);
  vtkMath::Subtract(end, start, along);
  vtkMath::Normalize(along);
  Found found;
  const Grid* nearest = nullptr;
  double least = VTK_DOUBLE_MAX, inside[3];
  for (const Grid& grid : this->Grids) {
    for (int a = 0; a < 3; ++a) {
      inside[a] = start[a] + NUDGE * grid.Length * along[a];
    }
    const double outside = Outside(grid.Bounds, inside);
    if (outside < least) {
      least = outside;
      nearest = &grid;
    }
    if (outside == 0.0) {
      found.Element = FindIn(grid, inside, points, false);
      found.Block = grid.Block;
    }
    if (found.Element >= 0) {
      return found;
    }
  }
  if (nearest) {
    found.Element = FindIn(*nearest, start, points, true);
    found.Block = nearest->Block;
  }
  return found;
}
