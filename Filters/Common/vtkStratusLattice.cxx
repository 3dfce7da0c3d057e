// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusLattice.h"

#include "vtkStratusArrays.h"

#include "vtkCellData.h"
#include "vtkDoubleArray.h"
#include "vtkPointData.h"
#include "vtkStructuredGrid.h"
#include "vtkUnsignedCharArray.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace {
std::string WriteExtent(const int n[3])
{
  return std::to_string(n[0]) + " x " + std::to_string(n[1]) + " x " + std::to_string(n[2]);
}

vtkIdType Product(const int n[3])
{
  return static_cast<vtkIdType>(n[0]) * n[1] * n[2];
}
} // namespace

bool vtkStratusLattice::Set(vtkStructuredGrid* grid, std::string& error)
{
  vtkUnsignedCharArray* points = nullptr;
  vtkUnsignedCharArray* cells = nullptr;
  grid->GetDimensions(this->Points);
  if (*std::min_element(this->Points, this->Points + 3) < 2) {
    error = "the structured grid has " + WriteExtent(this->Points) +
      " points and so no cell with a volume, at least 2 along each axis are needed";
    return false;
  }
  if (!this->SetPoints(grid, error)) {
    return false;
  }
  const int between[3] = { this->Points[0] - 1, this->Points[1] - 1, this->Points[2] - 1 };
  if (!vtkStratusFindGhosts(grid->GetPointData(), Product(this->Points), "points of the grid", points, error) ||
    !vtkStratusFindGhosts(grid->GetCellData(), Product(between), "cells of the grid", cells, error)) {
    return false;
  }
  const auto time_of = [](vtkObject* object) { return object ? object->GetMTime() : 0; };
  const Origin from = { grid->GetPoints(), points, cells, { { time_of(grid->GetPoints()), time_of(points), time_of(cells) } },
    { { this->Points[0], this->Points[1], this->Points[2] } } };
  if (this->IsFrom(from)) { // of a film, whose points stay
    return true;
  }
  this->From = Origin();
  this->Hidden.clear();
  if (points || cells) {
    this->Hide(points, cells);
  }
  this->FindBounds();
  this->From = from;
  this->Geometry.Modified();
  return true;
}

bool vtkStratusLattice::IsFrom(const Origin& origin) const
{
  return origin.Points == this->From.Points && origin.PointGhosts == this->From.PointGhosts && origin.CellGhosts == this->From.CellGhosts &&
    origin.Times == this->From.Times && origin.Extent == this->From.Extent;
}

bool vtkStratusLattice::SetPoints(vtkStructuredGrid* grid, std::string& error)
{
  const vtkIdType needed = Product(this->Points), there = grid->GetPoints() ? grid->GetPoints()->GetNumberOfPoints() : 0;
  if (there != needed) {
    error = "the structured grid of " + WriteExtent(this->Points) + " points has coordinates of " + std::to_string(there) + ", must have " +
      std::to_string(needed);
    return false;
  }
  vtkDataArray* data = grid->GetPoints()->GetData();
  this->Doubles = nullptr;
  this->Floats = nullptr;
  this->Kept = data;
  if (data->HasStandardMemoryLayout() && data->GetDataType() == VTK_FLOAT) {
    this->Floats = static_cast<const float*>(data->GetVoidPointer(0));
    return true;
  }
  if (!data->HasStandardMemoryLayout() || data->GetDataType() != VTK_DOUBLE) {
    this->Kept = vtkSmartPointer<vtkDoubleArray>::New();
    this->Kept->DeepCopy(data);
  }
  this->Doubles = static_cast<const double*>(this->Kept->GetVoidPointer(0));
  return true;
}

// Hides cells that another piece owns, hidden cells, and cells that touch a hidden point.
void vtkStratusLattice::Hide(vtkUnsignedCharArray* points, vtkUnsignedCharArray* cells)
{
  const vtkIdType row = this->Points[0], layer = row * this->Points[1];
  vtkIdType cell = 0;
  this->Hidden.resize(static_cast<size_t>(row - 1) * (this->Points[1] - 1) * (this->Points[2] - 1));
  for (int k = 0; k < this->Points[2] - 1; ++k) {
    for (int j = 0; j < this->Points[1] - 1; ++j) {
      for (int i = 0; i < this->Points[0] - 1; ++i, ++cell) {
        const vtkIdType first = k * layer + j * row + i;
        bool hidden = cells && (cells->GetValue(cell) & (STRATUS_GHOST_DUPLICATE | STRATUS_GHOST_HIDDEN_CELL));
        for (int c = 0; points && c < 8; ++c) {
          hidden = hidden || (points->GetValue(first + (c & 1) + (c >> 1 & 1) * row + (c >> 2) * layer) & STRATUS_GHOST_HIDDEN_POINT);
        }
        this->Hidden[static_cast<size_t>(cell)] = hidden ? 1 : 0;
      }
    }
  }
}

void vtkStratusLattice::FindBounds()
{
  const vtkIdType row = this->Points[0], layer = row * this->Points[1];
  std::vector<bool> used(this->Hidden.empty() ? 0 : static_cast<size_t>(Product(this->Points)), false);
  size_t cell = 0;
  for (int k = 0; k < this->Points[2] - 1 && !used.empty(); ++k) {
    for (int j = 0; j < this->Points[1] - 1; ++j) {
      for (int i = 0; i < this->Points[0] - 1; ++i) {
        for (int c = 0; !this->Hidden[cell] && c < 8; ++c) {
          used[static_cast<size_t>((k + (c >> 2)) * layer + (j + (c >> 1 & 1)) * row + i + (c & 1))] = true;
        }
        ++cell;
      }
    }
  }
  double lo[3], hi[3];
  std::fill_n(lo, 3, std::numeric_limits<double>::infinity());
  std::fill_n(hi, 3, -std::numeric_limits<double>::infinity());
  for (vtkIdType p = 0; p < Product(this->Points); ++p) {
    for (int a = 0; a < 3 && (used.empty() || used[static_cast<size_t>(p)]); ++a) {
      const double x = this->Floats ? static_cast<double>(this->Floats[3 * p + a]) : this->Doubles[3 * p + a];
      if (std::isfinite(x)) {
        lo[a] = std::min(lo[a], x);
        hi[a] = std::max(hi[a], x);
      }
    }
  }
  for (int a = 0; a < 3; ++a) {
    this->Bounds[2 * a] = lo[a] <= hi[a] ? lo[a] : 0.0;
    this->Bounds[2 * a + 1] = lo[a] <= hi[a] ? hi[a] : 0.0;
  }
}

stratus_mesh vtkStratusLattice::GetMesh() const
{
  stratus_mesh mesh = stratus_mesh_default();
  std::copy(this->Points, this->Points + 3, mesh.lattice);
  mesh.points = this->Doubles;
  mesh.float_points = this->Floats;
  mesh.geometry = this->Geometry.GetMTime();
  mesh.point_count = Product(this->Points);
  mesh.cell_count = static_cast<int64_t>(this->Points[0] - 1) * (this->Points[1] - 1) * (this->Points[2] - 1);
  return mesh;
}
