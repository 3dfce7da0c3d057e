// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusMeshView.h"

#include "vtkCellData.h"
#include "vtkCellTypes.h"
#include "vtkDataArray.h"
#include "vtkIdList.h"
#include "vtkMatrix4x4.h"
#include "vtkPointData.h"
#include "vtkUnsignedCharArray.h"

#include <algorithm>
#include <limits>

bool vtkStratusMeshView::Set(vtkUnstructuredGrid* grid, vtkDataArray* array, bool cells, vtkMatrix4x4* matrix, std::string& error)
{
  const vtkMTimeType time = std::max(grid->GetMTime(), grid->GetMeshMTime());
  if (this->Grid != grid || this->Time != time) {
    this->Grid = grid;
    this->Time = time;
    this->Refusal.clear();
    this->Accepted = this->CopyCells(grid, this->Refusal) && this->CopyHidden(grid, this->Refusal);
    if (this->Accepted) {
      this->CopyPoints(grid);
    }
  }
  if (!this->Accepted) {
    error = this->Refusal;
    return false;
  }
  const vtkIdType count = cells ? grid->GetNumberOfCells() : grid->GetNumberOfPoints();
  if (array->GetNumberOfTuples() < count) {
    error = "the scalar array has " + std::to_string(array->GetNumberOfTuples()) + " values, the grid has " + std::to_string(count) +
      (cells ? " cells" : " points");
    return false;
  }
  if (this->Carrier->GetNumberOfPoints() != count) {
    this->Carrier->SetDimensions(static_cast<int>(count), 1, 1);
  }
  if (!this->Values.Set(this->Carrier, array, false, nullptr, error)) {
    return false;
  }
  const stratus_volume& values = this->Values.GetVolume();
  this->Mesh = stratus_mesh_default();
  this->Mesh.points = this->Points.data();
  this->Mesh.point_count = static_cast<int64_t>(this->Points.size() / 3);
  this->Mesh.vertices = this->Vertices.data();
  this->Mesh.cell_count = static_cast<int64_t>(this->Vertices.size() / 4);
  this->Mesh.values = values.values;
  this->Mesh.type = values.type;
  this->Mesh.value_stride = values.value_stride;
  this->Mesh.cell_values = cells ? 1 : 0;
  this->Mesh.hidden = this->Hidden.empty() ? nullptr : this->Hidden.data();
  this->Mesh.revision = values.revision ^ (static_cast<uint64_t>(time) * UINT64_C(0x9E3779B97F4A7C15));
  if (matrix) {
    std::copy(&matrix->Element[0][0], &matrix->Element[0][0] + 16, this->Mesh.matrix);
  }
  grid->GetBounds(this->Bounds);
  return true;
}

bool vtkStratusMeshView::CopyCells(vtkUnstructuredGrid* grid, std::string& error)
{
  const vtkIdType cells = grid->GetNumberOfCells();
  constexpr vtkIdType most = std::numeric_limits<int32_t>::max();
  this->Vertices.clear();
  if (grid->GetNumberOfPoints() > most || cells > most) {
    error = "the grid has " + std::to_string(grid->GetNumberOfPoints()) + " points and " + std::to_string(cells) + " cells, at most " +
      std::to_string(most) + " of each are supported";
    return false;
  }
  this->Vertices.resize(4 * static_cast<size_t>(cells));
  vtkNew<vtkIdList> list;
  for (vtkIdType cell = 0; cell < cells; ++cell) {
    const int type = grid->GetCellType(cell);
    grid->GetCellPoints(cell, list);
    const vtkIdType count = list->GetNumberOfIds();
    if (type != VTK_TETRA || count != 4) {
      error = "cell " + std::to_string(cell) + " is a " + vtkCellTypes::GetClassNameFromTypeId(type) + " of " + std::to_string(count) +
        " points, only tetrahedra (vtkTetra) are supported: vtkDataSetTriangleFilter makes them";
      return false;
    }
    for (int i = 0; i < 4; ++i) {
      const vtkIdType point = list->GetId(i);
      if (point < 0 || point >= grid->GetNumberOfPoints()) {
        error = "cell " + std::to_string(cell) + " names point " + std::to_string(point) + ", outside 0.." +
          std::to_string(grid->GetNumberOfPoints() - 1);
        return false;
      }
      this->Vertices[4 * static_cast<size_t>(cell) + i] = static_cast<int32_t>(point);
    }
  }
  return true;
}

void vtkStratusMeshView::CopyPoints(vtkUnstructuredGrid* grid)
{
  this->Points.resize(3 * static_cast<size_t>(grid->GetNumberOfPoints()));
  for (vtkIdType i = 0; i < grid->GetNumberOfPoints(); ++i) {
    grid->GetPoint(i, &this->Points[3 * static_cast<size_t>(i)]);
  }
}

// Cells that another piece owns, blanked ones, and those that touch a blanked point.
bool vtkStratusMeshView::CopyHidden(vtkUnstructuredGrid* grid, std::string& error)
{
  vtkUnsignedCharArray* points = grid->GetPointGhostArray();
  vtkUnsignedCharArray* cells = grid->GetCellGhostArray();
  this->Hidden.clear();
  if ((points && points->GetNumberOfTuples() < grid->GetNumberOfPoints()) ||
    (cells && cells->GetNumberOfTuples() < grid->GetNumberOfCells())) {
    error = "the array vtkGhostType is shorter than the grid";
    return false;
  }
  if (!points && !cells) {
    return true;
  }
  this->Hidden.resize(this->Vertices.size() / 4);
  for (size_t cell = 0; cell < this->Hidden.size(); ++cell) {
    bool hidden = cells && (cells->GetValue(static_cast<vtkIdType>(cell)) & (STRATUS_GHOST_DUPLICATE | STRATUS_GHOST_HIDDEN_CELL));
    for (size_t i = 0; points && i < 4; ++i) {
      hidden = hidden || (points->GetValue(this->Vertices[4 * cell + i]) & STRATUS_GHOST_HIDDEN_POINT);
    }
    this->Hidden[cell] = hidden ? 1 : 0;
  }
  return true;
}

stratus_volume vtkStratusMeshView::GetBox() const
{
  stratus_volume box = stratus_volume_default();
  std::copy_n(this->Mesh.matrix, 16, box.matrix);
  for (int a = 0; a < 3; ++a) {
    const double width = this->Bounds[2 * a + 1] - this->Bounds[2 * a];
    box.dimensions[a] = 2;
    box.origin[a] = this->Bounds[2 * a];
    box.spacing[a] = width > 0.0 ? width : 1e-30; // a flat grid has a box, too
  }
  return box;
}
