// SPDX-License-Identifier: BSD-3-Clause
// vtkStratusTetrahedraMapper and structured grids: curvilinear grids against the double reference of their tetrahedra, which are listed
// here; blanked and ghost cells and points, values and coordinates that are not finite, left-handed grids and poles; steps of values;
// refused inputs.
#include "tetrahedra_scene.h"

#include "vtkCellData.h"
#include "vtkStructuredGrid.h"
#include "vtkTrivialProducer.h"
#include "vtkUnsignedCharArray.h"

namespace {
using Structured = vtkSmartPointer<vtkStructuredGrid>;
const int Size[3] = { 7, 6, 8 }; // points
constexpr vtkIdType Points = 7 * 6 * 8, Cells = 6 * 5 * 7;

// A bent grid, its points of the given type.
Structured Bent(int type, bool cells)
{
  auto grid = Structured::New();
  vtkNew<vtkPoints> points;
  vtkNew<vtkFloatArray> values;
  points->SetDataType(type);
  values->SetName("density");
  for (vtkIdType p = 0; p < Points; ++p) {
    const double i = static_cast<double>(p % Size[0]), j = static_cast<double>(p / Size[0] % Size[1]);
    const double k = static_cast<double>(p / Size[0] / Size[1]);
    points->InsertNextPoint(i + 0.3 * std::sin(j + 0.6 * k), j + 0.25 * std::cos(1.2 * i), 0.8 * k + 0.4 * std::sin(0.9 * i) * std::cos(j));
  }
  for (vtkIdType v = 0; v < (cells ? Cells : Points); ++v) {
    values->InsertNextValue(0.35f + 0.3f * static_cast<float>(std::sin(0.37 * static_cast<double>(v))));
  }
  grid->SetDimensions(Size);
  grid->SetPoints(points);
  (cells ? static_cast<vtkDataSetAttributes*>(grid->GetCellData()) : grid->GetPointData())->SetScalars(values);
  return grid;
}

// The tetrahedra of the cells that VTK finds visible and whose points and values are finite. values: of its points or cells.
Grid Listed(vtkStructuredGrid* from, vtkSmartPointer<vtkFloatArray>& values, bool cells)
{
  static const int ways[6][2] = { { 1, 3 }, { 1, 5 }, { 2, 3 }, { 2, 6 }, { 4, 5 }, { 4, 6 } };
  auto grid = Grid::New();
  auto* all = vtkFloatArray::SafeDownCast(cells ? from->GetCellData()->GetScalars() : from->GetPointData()->GetScalars());
  values = vtkSmartPointer<vtkFloatArray>::New();
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  for (vtkIdType p = 0; p < Points; ++p) {
    double x[3];
    from->GetPoint(p, x);
    points->InsertNextPoint(std::isfinite(x[0]) ? x[0] : 0.0, x[1], x[2]);
  }
  grid->SetPoints(points);
  for (vtkIdType cell = 0; cell < Cells; ++cell) {
    const vtkIdType row = Size[0], layer = row * Size[1];
    const vtkIdType first =
      cell % (Size[0] - 1) + cell / (Size[0] - 1) % (Size[1] - 1) * row + cell / (Size[0] - 1) / (Size[1] - 1) * layer;
    vtkIdType corner[8];
    bool shows = from->IsCellVisible(cell) != 0 && (!cells || std::isfinite(all->GetValue(cell)));
    for (int c = 0; c < 8; ++c) {
      double x[3];
      corner[c] = first + (c & 1) + (c >> 1 & 1) * row + (c >> 2) * layer;
      from->GetPoint(corner[c], x);
      shows = shows && from->IsPointVisible(corner[c]) && std::isfinite(x[0]) && (cells || std::isfinite(all->GetValue(corner[c])));
    }
    for (int t = 0; t < 6 && shows; ++t) {
      const vtkIdType v[4] = { corner[0], corner[ways[t][0]], corner[ways[t][1]], corner[7] };
      grid->InsertNextCell(VTK_TETRA, 4, v);
      if (cells) {
        values->InsertNextValue(all->GetValue(cell));
      }
    }
  }
  if (!cells) {
    values->DeepCopy(all);
  }
  return grid;
}

void IsRight(GridScene& scene, vtkStructuredGrid* grid, bool cells, const char* what)
{
  vtkSmartPointer<vtkFloatArray> values;
  const Grid listed = Listed(grid, values, cells);
  scene.Tetrahedra->SetInputData(grid);
  scene.Tetrahedra->SetTermination(1.0);
  scene.Renderer->ResetCamera();
  const std::vector<double> reference = TetraReference(scene, listed, values, cells);
  for (const int method : { vtkStratusTetrahedraMapper::AUTO_METHOD, vtkStratusTetrahedraMapper::PROJECT_METHOD }) {
    scene.Tetrahedra->SetMethod(method);
    const double error = TetraError(scene.GridPicture(), reference);
    CHECK(error < 0.1, "%s, method %d: RMSE %.4f of 255", what, method, error);
    const std::string used = scene.Tetrahedra->GetMethodUsedAsString();
    CHECK(used == (method == vtkStratusTetrahedraMapper::AUTO_METHOD ? "march" : "project"), "%s: drawn by %s", what, used.c_str());
  }
  CHECK(scene.GridErrors->Count == 0, "%s: %s", what, scene.GridErrors->Text.c_str());
  CHECK(scene.Tetrahedra->GetNumberOfTetrahedra() == 6 * Cells, "%s: %lld tetrahedra", what,
    static_cast<long long>(scene.Tetrahedra->GetNumberOfTetrahedra()));
}

void CurvilinearGrids()
{
  for (const bool cells : { false, true }) {
    for (const int type : { VTK_FLOAT, VTK_DOUBLE }) {
      GridScene scene(48, 36);
      const Structured grid = Bent(type, cells);
      IsRight(scene, grid, cells, cells ? "cells" : "points");
      for (vtkIdType p = 0; p < Points; ++p) { // left-handed
        double x[3];
        grid->GetPoint(p, x);
        grid->GetPoints()->SetPoint(p, -x[0], x[1], x[2]);
      }
      grid->GetPoints()->Modified();
      IsRight(scene, grid, cells, "left-handed");
      for (vtkIdType p = 0; p < Points; p += Size[0]) { // a pole: an edge of the grid is a line
        grid->GetPoints()->SetPoint(p, 0.5, 2.5, 0.8 * static_cast<double>(p / Size[0] / Size[1]));
      }
      grid->GetPoints()->Modified();
      IsRight(scene, grid, cells, "around a pole");
    }
  }
}

void HiddenCells()
{
  for (const bool cells : { false, true }) {
    GridScene scene(48, 36);
    const Structured grid = Bent(VTK_DOUBLE, cells);
    grid->BlankCell(17);
    grid->BlankCell(Cells - 1);
    IsRight(scene, grid, cells, "blanked cells");
    grid->BlankPoint(101);
    IsRight(scene, grid, cells, "a blanked point");
    auto* values = vtkFloatArray::SafeDownCast(cells ? grid->GetCellData()->GetScalars() : grid->GetPointData()->GetScalars());
    values->SetValue(60, std::nanf(""));
    values->Modified();
    IsRight(scene, grid, cells, "a dry value");
    const double nothing = std::nan("");
    grid->GetPoints()->SetPoint(5, nothing, nothing, nothing);
    grid->GetPoints()->Modified();
    IsRight(scene, grid, cells, "fill values in coordinates");
    grid->GetPoints()->SetPoint(0, -1e30, 0, 0); // only a hidden cell has it
    grid->BlankCell(0);
    grid->GetPoints()->Modified();
    CHECK(scene.Tetrahedra->GetBounds()[0] > -10.0, "bounds begin at %g", scene.Tetrahedra->GetBounds()[0]);
    IsRight(scene, grid, cells, "a fill value that is a number");
  }
}

void Steps()
{
  GridScene scene(48, 36);
  for (int step = 0; step < 5; ++step) { // as readers do: in a grid of its own
    const Structured grid = Bent(VTK_FLOAT, false);
    auto* values = vtkFloatArray::SafeDownCast(grid->GetPointData()->GetScalars());
    values->SetValue(40, 0.3f + 0.05f * static_cast<float>(step));
    scene.Tetrahedra->SetInputData(grid);
    const std::vector<float> kept = scene.GridPicture();
    CHECK(scene.Tetrahedra->GetGeometryBuilds() == 1 && scene.Tetrahedra->GetValueBuilds() == static_cast<vtkTypeUInt64>(step) + 1,
      "step %d: %llu and %llu builds", step, static_cast<unsigned long long>(scene.Tetrahedra->GetGeometryBuilds()),
      static_cast<unsigned long long>(scene.Tetrahedra->GetValueBuilds()));
    vtkNew<vtkStratusTetrahedraMapper> other;
    other->SetInputData(grid);
    scene.Volume->SetMapper(other);
    scene.Render();
    const float* rgba = vtkFloatArray::SafeDownCast(other->GetLastImage()->GetPointData()->GetArray("RGBA"))->GetPointer(0);
    CHECK(!kept.empty() && std::equal(kept.begin(), kept.end(), rgba), "step %d: a new mapper draws another picture", step);
    scene.Volume->SetMapper(scene.Tetrahedra);
  }
}

void Refuses(vtkStructuredGrid* grid, const char* reason)
{
  GridScene scene(48, 36);
  vtkNew<vtkTrivialProducer> source;
  source->SetOutput(grid);
  scene.Tetrahedra->SetInputConnection(source->GetOutputPort());
  scene.Render();
  CHECK(scene.GridErrors->Count == 1 && scene.GridErrors->Text.find(reason) != std::string::npos, "%d errors, not of \"%s\": %s",
    scene.GridErrors->Count, reason, scene.GridErrors->Text.c_str());
}

void WhatIsRefused()
{
  Structured grid = Bent(VTK_DOUBLE, false);
  grid->GetPoints()->SetNumberOfPoints(Points - 1);
  Refuses(grid, "coordinates of 335, must have 336");
  grid = Bent(VTK_DOUBLE, false);
  grid->GetPointData()->GetScalars()->SetNumberOfTuples(Points - 3);
  Refuses(grid, "has 333 values, the grid has 336 points");
  grid = Bent(VTK_DOUBLE, false);
  grid->SetDimensions(Size[0] * Size[1], 1, Size[2]);
  Refuses(grid, "42 x 1 x 8 points and so no cell with a volume");
  grid = Bent(VTK_DOUBLE, false);
  vtkNew<vtkUnsignedCharArray> ghosts;
  ghosts->SetName(vtkDataSetAttributes::GhostArrayName());
  ghosts->SetNumberOfTuples(7);
  grid->GetCellData()->AddArray(ghosts);
  Refuses(grid, "it must have one unsigned char for each of the 210 cells");
  vtkNew<vtkStructuredGrid> empty;
  GridScene scene(48, 36);
  scene.Tetrahedra->SetInputData(empty);
  scene.Render();
  CHECK(scene.GridErrors->Count == 0, "an empty grid: %s", scene.GridErrors->Text.c_str());
}
} // namespace

int main()
{
  CurvilinearGrids();
  HiddenCells();
  Steps();
  WhatIsRefused();
  return Failures ? 1 : 0;
}
