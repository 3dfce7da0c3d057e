// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusMeshView.h"

#include "vtkStratusArrays.h"
#include "vtkStratusVersions.h"

#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkDataSetAttributes.h"
#include "vtkFieldData.h"
#include "vtkIdTypeArray.h"
#include "vtkMatrix4x4.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkStructuredGrid.h"
#include "vtkUnsignedCharArray.h"

#include <algorithm>
#include <cmath>

namespace {
uint64_t HashArray(vtkAbstractArray* array, uint64_t seed)
{
  vtkDataArray* data = vtkDataArray::SafeDownCast(array);
  if (!data) {
    return stratus_hash(nullptr, 0, seed);
  }
  const vtkIdType tuples = data->GetNumberOfTuples();
  const int components = data->GetNumberOfComponents();
  seed = stratus_hash(nullptr, 0, seed + static_cast<uint64_t>(data->GetDataType()) + 64 * static_cast<uint64_t>(components));
  if (data->HasStandardMemoryLayout()) {
    return stratus_hash(data->GetVoidPointer(0), static_cast<size_t>(tuples * components * data->GetDataTypeSize()), seed);
  }
  std::vector<double> tuple(static_cast<size_t>(components));
  for (vtkIdType i = 0; i < tuples; ++i) {
    data->GetTuple(i, tuple.data());
    seed = stratus_hash(tuple.data(), tuple.size() * sizeof(double), seed);
  }
  return seed;
}

// The hash of all that SetGeometry() reads.
uint64_t HashGrid(vtkUnstructuredGrid* grid)
{
  const std::array<vtkAbstractArray*, 4> faces = vtkStratusFaceArrays(grid);
  vtkCellArray* cells = grid->GetCells(); // null in a grid after Initialize()
  vtkAbstractArray* const arrays[] = { grid->GetPoints() ? grid->GetPoints()->GetData() : nullptr,
    cells ? cells->GetConnectivityArray() : nullptr, cells ? cells->GetOffsetsArray() : nullptr, vtkStratusCellTypes(grid), faces[0],
    faces[1], faces[2], faces[3], grid->GetPointData()->GetAbstractArray(vtkDataSetAttributes::GhostArrayName()),
    grid->GetCellData()->GetAbstractArray(vtkDataSetAttributes::GhostArrayName()), grid->GetCellData()->GetHigherOrderDegrees(),
    grid->GetPointData()->GetRationalWeights(), grid->GetCellData()->GetAbstractArray(vtkStratusLeafArray),
    grid->GetFieldData()->GetAbstractArray(vtkStratusPartitionArray) };
  uint64_t hash = 1;
  for (vtkAbstractArray* array : arrays) {
    hash = HashArray(array, hash);
  }
  return hash;
}
} // namespace

bool vtkStratusMeshView::SetGeometry(vtkDataSet* grid, std::string& error)
{
  auto* cells = vtkUnstructuredGrid::SafeDownCast(grid);
  auto* lattice = vtkStructuredGrid::SafeDownCast(grid);
  vtkMTimeType time = grid->GetMTime();
  time = cells ? std::max(time, cells->GetMeshMTime()) : time;
  time = lattice && lattice->GetPoints() ? std::max(time, lattice->GetPoints()->GetMTime()) : time;
  if (this->Grid != grid || this->Time != time) {
    this->Grid = grid;
    this->Time = time;
    this->IsLattice = lattice != nullptr;
    if (lattice) { // the core asks whether its content has changed
      this->Geometry = vtkTimeStamp();
      this->Divided = nullptr;
      this->HasLeaves = false;
      this->Refusal.clear();
      this->Accepted = this->Lattice.Set(lattice, this->Refusal);
      std::copy_n(this->Lattice.GetBounds(), 6, this->Bounds);
    } else {
      this->Divide(cells);
      grid->GetBounds(this->Bounds);
    }
  }
  error = this->Refusal;
  return this->Accepted;
}

// Divides the grid into tetrahedra, if its content has changed.
void vtkStratusMeshView::Divide(vtkUnstructuredGrid* grid)
{
  const uint64_t content = HashGrid(grid);
  if (this->Geometry.GetMTime() > 0 && this->Content == content) {
    return;
  }
  this->Content = content;
  this->Divided = nullptr;
  this->Refusal.clear();
  this->Accepted = this->Tetrahedra.Set(grid, this->Refusal) && this->SetHidden(grid, this->Refusal);
  this->Geometry.Modified();
  if (this->Accepted && this->Tetrahedra.Vertices.empty()) {
    this->Refusal = this->Tetrahedra.DescribeLeftOut();
    this->Accepted = false;
  }
  this->HasLeaves = this->Accepted && this->Tetrahedra.CellByCell && this->Leaves.Set(grid);
}

bool vtkStratusMeshView::Set(
  vtkDataSet* grid, vtkDataArray* array, bool cells, vtkMatrix4x4* matrix, std::string& error, int mostComponents)
{
  this->Several.clear();
  if (!this->SetGeometry(grid, error)) {
    return false;
  }
  const vtkIdType expected = cells ? grid->GetNumberOfCells() : grid->GetNumberOfPoints();
  if (array->GetNumberOfTuples() < expected) {
    error = "the scalar array has " + std::to_string(array->GetNumberOfTuples()) + " values, the grid has " + std::to_string(expected) +
      (cells ? " cells" : " points");
    return false;
  }
  const bool whole = this->IsLattice || this->Tetrahedra.CellByCell;
  vtkDataArray* values_of = whole ? array : this->Spread(array, cells);
  this->Mesh = this->IsLattice ? this->Lattice.GetMesh() : this->Tetrahedra.GetMesh();
  this->Mesh.geometry = this->IsLattice ? this->Mesh.geometry : this->Geometry.GetMTime();
  const int64_t count = cells ? this->Mesh.cell_count : this->Mesh.point_count;
  if (this->Carrier->GetNumberOfPoints() != count) {
    this->Carrier->SetDimensions(static_cast<int>(count), 1, 1);
  }
  if (!this->Values.Set(this->Carrier, values_of, false, nullptr, error, mostComponents)) {
    return false;
  }
  const stratus_volume& values = this->Values.GetVolume();
  const std::vector<uint8_t>& hidden = this->IsLattice ? this->Lattice.GetHidden() : whole ? this->Hidden : this->DividedHidden;
  this->Mesh.values = values.values;
  this->Mesh.type = values.type;
  this->Mesh.value_stride = values.value_stride;
  this->Mesh.components = values.components;
  this->Mesh.cell_values = cells ? 1 : 0;
  this->Mesh.hidden = hidden.empty() ? nullptr : hidden.data();
  const vtkMTimeType geometry = this->IsLattice ? this->Time : this->Geometry.GetMTime();
  this->Mesh.revision = values.revision ^ (static_cast<uint64_t>(geometry) * UINT64_C(0x9E3779B97F4A7C15));
  if (matrix) {
    std::copy(&matrix->Element[0][0], &matrix->Element[0][0] + 16, this->Mesh.matrix);
  }
  return true;
}

bool vtkStratusMeshView::SetSeveral(const Grids& grids, bool cells, vtkMatrix4x4* matrix, std::string& error, int mostComponents)
{
  stratus_mesh whole = stratus_mesh_default();
  std::vector<uint64_t> revisions;
  this->Grid = nullptr; // a single grid is read anew
  this->Geometry = vtkTimeStamp();
  this->IsLattice = true;
  this->HasLeaves = false;
  this->Several.resize(grids.size());
  this->Blocks.resize(grids.size());
  for (size_t n = 0; n < grids.size(); ++n) {
    std::unique_ptr<vtkStratusMeshView>& part = this->Several[n];
    part = part ? std::move(part) : std::make_unique<vtkStratusMeshView>();
    if (!part->Set(grids[n].first, grids[n].second, cells, nullptr, error, mostComponents)) {
      error = "block " + std::to_string(n) + ": " + error;
      return false;
    }
    const stratus_mesh& mesh = this->Blocks[n] = part->GetMesh();
    whole.type = mesh.type;
    whole.components = mesh.components;
    whole.cell_values = mesh.cell_values;
    whole.point_count += mesh.point_count;
    whole.cell_count += mesh.cell_count;
    revisions.push_back(mesh.revision);
    for (int side = 0; side < 6; ++side) {
      const bool widens = side % 2 ? part->Bounds[side] > this->Bounds[side] : part->Bounds[side] < this->Bounds[side];
      this->Bounds[side] = n == 0 || widens ? part->Bounds[side] : this->Bounds[side];
    }
  }
  whole.blocks = this->Blocks.data();
  whole.block_count = static_cast<int>(this->Blocks.size());
  whole.revision = stratus_hash(revisions.data(), revisions.size() * sizeof revisions[0], 0);
  const double* last = matrix ? &matrix->Element[0][0] : this->Mesh.matrix;
  std::copy(last, last + 16, whole.matrix);
  this->Mesh = whole;
  return true;
}

// Marks cells that another piece owns, hidden cells, and cells that touch a hidden point.
bool vtkStratusMeshView::SetHidden(vtkUnstructuredGrid* grid, std::string& error)
{
  vtkUnsignedCharArray* points = nullptr;
  vtkUnsignedCharArray* cells = nullptr;
  this->Hidden.clear();
  if (!vtkStratusFindGhosts(grid->GetPointData(), grid->GetNumberOfPoints(), "points of the grid", points, error) ||
    !vtkStratusFindGhosts(grid->GetCellData(), grid->GetNumberOfCells(), "cells of the grid", cells, error)) {
    return false;
  }
  if (!points && !cells) {
    return true;
  }
  const vtkStratusTetrahedra& parts = this->Tetrahedra;
  this->Hidden.resize(parts.Cells.size());
  for (size_t part = 0; part < this->Hidden.size(); ++part) {
    bool hidden = cells && (cells->GetValue(parts.Cells[part]) & (STRATUS_GHOST_DUPLICATE | STRATUS_GHOST_HIDDEN_CELL));
    for (size_t i = 0; points && i < 4; ++i) {
      const vtkIdType point = parts.Vertices[4 * part + i];
      hidden = hidden || (point < parts.GridPoints && (points->GetValue(point) & STRATUS_GHOST_HIDDEN_POINT));
    }
    this->Hidden[part] = hidden ? 1 : 0;
  }
  this->HideWhole(this->Hidden);
  return true;
}

// Hides all parts of a cell that has a hidden part. The parts of a cell are consecutive.
void vtkStratusMeshView::HideWhole(std::vector<uint8_t>& hidden) const
{
  const std::vector<vtkIdType>& cells = this->Tetrahedra.Cells;
  for (size_t begin = 0, end; begin < cells.size(); begin = end) {
    uint8_t any = 0;
    for (end = begin; end < cells.size() && cells[end] == cells[begin]; ++end) {
      any = std::max(any, hidden[end]);
    }
    std::fill(hidden.begin() + static_cast<std::ptrdiff_t>(begin), hidden.begin() + static_cast<std::ptrdiff_t>(end), any);
  }
}

// Copies the array's values to the tetrahedra and points into which cells were divided, if the grid or the array has changed.
vtkDataArray* vtkStratusMeshView::Spread(vtkDataArray* array, bool cells)
{
  if (this->Divided && this->Source == array && this->DividedCells == cells && this->DividedTime == array->GetMTime()) {
    return this->Divided;
  }
  const vtkStratusTetrahedra& parts = this->Tetrahedra;
  this->Source = array;
  this->DividedCells = cells;
  this->DividedTime = array->GetMTime();
  this->Divided = vtkSmartPointer<vtkDataArray>::Take(vtkDataArray::CreateDataArray(array->GetDataType()));
  this->Divided->SetName(array->GetName());
  this->Divided->SetNumberOfComponents(array->GetNumberOfComponents());
  if (cells) {
    this->Divided->SetNumberOfTuples(static_cast<vtkIdType>(parts.Cells.size()));
    for (size_t part = 0; part < parts.Cells.size(); ++part) {
      this->Divided->SetTuple(static_cast<vtkIdType>(part), parts.Cells[part], array);
    }
  } else {
    this->Divided->SetNumberOfTuples(static_cast<vtkIdType>(parts.Points.size() / 3));
    parts.CopyPointValues(array, this->Divided);
  }
  this->DividedHidden = this->Hidden;
  if (!cells) {
    this->HideNotFinite();
  }
  return this->Divided;
}

// Hides the whole cell where a value is not finite. The core would hide only the tetrahedra at that corner.
void vtkStratusMeshView::HideNotFinite()
{
  std::vector<uint8_t> bad(static_cast<size_t>(this->Divided->GetNumberOfTuples()));
  for (size_t i = 0; i < bad.size(); ++i) {
    for (int c = 0; c < this->Divided->GetNumberOfComponents(); ++c) {
      bad[i] |= std::isfinite(this->Divided->GetComponent(static_cast<vtkIdType>(i), c)) ? 0 : 1;
    }
  }
  if (std::find(bad.begin(), bad.end(), 1) == bad.end()) {
    return;
  }
  this->DividedHidden.resize(this->Tetrahedra.Cells.size());
  for (size_t i = 0; i < this->Tetrahedra.Vertices.size(); ++i) {
    if (bad[static_cast<size_t>(this->Tetrahedra.Vertices[i])]) {
      this->DividedHidden[i / 4] = 1;
    }
  }
  this->HideWhole(this->DividedHidden);
}

stratus_volume vtkStratusMeshView::GetBox() const
{
  stratus_volume box = stratus_volume_default();
  std::copy_n(this->Mesh.matrix, 16, box.matrix);
  for (int a = 0; a < 3; ++a) {
    const double width = this->Bounds[2 * a + 1] - this->Bounds[2 * a];
    box.dimensions[a] = 2;
    box.origin[a] = this->Bounds[2 * a];
    box.spacing[a] = width > 0.0 ? width : 1e-30; // a flat grid needs a box with a volume, too
  }
  return box;
}
