// SPDX-License-Identifier: BSD-3-Clause
// vtkStratusTetrahedraMapper and cells other than tetrahedra: every kind gives the image mapper's picture of an equal field, whole cells
// are hidden, and scalars of cells stay constant in a cell. Cells without volume are ignored and counted, and unchanged grids are not
// rebuilt.
#include "tetrahedra_scene.h"
#include "vtkStratusPartitionFilter.h"

#include "vtkFieldData.h"
#include "vtkShortArray.h"

namespace {
// The linear field of the scene's image on any grid of the same cube.
void AddDensity(vtkUnstructuredGrid* grid)
{
  vtkNew<vtkFloatArray> values;
  values->SetName("density");
  for (vtkIdType i = 0; i < grid->GetNumberOfPoints(); ++i) {
    const Vector p = PointOf(grid, i);
    values->InsertNextValue(static_cast<float>(0.1 * p[0] + 0.05 * p[2]));
  }
  grid->GetPointData()->SetScalars(values);
}

void EveryKindOfCell()
{
  Grid grids[] = { MixedGrid(Boxes), CubesOf(Boxes, VTK_WEDGE),
    Elevated(MixedGrid(3), VTK_QUADRATIC_HEXAHEDRON, VTK_QUADRATIC_WEDGE, VTK_QUADRATIC_PYRAMID, 3, 0.04),
    Elevated(MixedGrid(3), VTK_TRIQUADRATIC_HEXAHEDRON, VTK_BIQUADRATIC_QUADRATIC_WEDGE, VTK_TRIQUADRATIC_PYRAMID, 3, 0.04),
    Elevated(CubesOf(3, VTK_HEXAHEDRON), VTK_BIQUADRATIC_QUADRATIC_HEXAHEDRON, 0, 0, 3, 0.04),
    Elevated(CubesOf(3, VTK_WEDGE), 0, VTK_QUADRATIC_LINEAR_WEDGE, 0, 3, 0.04) };
  for (int g = 0; g < 6; ++g) {
    GridScene scene;
    vtkPoints* points = grids[g]->GetPoints();
    for (vtkIdType i = 0; i < points->GetNumberOfPoints() && g > 1; ++i) { // as large as the image
      const Vector p = PointOf(grids[g], i);
      points->SetPoint(i, 2.0 * p[0], 2.0 * p[1], 2.0 * p[2]);
    }
    AddDensity(grids[g]);
    scene.Tetrahedra->SetInputData(grids[g]);
    for (int view = 0; view < 2; ++view) {
      scene.Look(35 + 130 * view, 20 - 40 * view);
      const double psnr = scene.Psnr();
      CHECK(psnr > SamePicture, "grid %d, view %d: %.1f dB", g, view, psnr);
    }
    CHECK(scene.Tetrahedra->GetNumberOfTetrahedra() > 4 * grids[g]->GetNumberOfCells() / 2, "grid %d: %lld tetrahedra of %lld cells", g,
      static_cast<long long>(scene.Tetrahedra->GetNumberOfTetrahedra()), static_cast<long long>(grids[g]->GetNumberOfCells()));
    CHECK(
      scene.Tetrahedra->GetNumberOfIgnoredCells() == 0 && scene.GridErrors->Count == 0, "grid %d: %s", g, scene.GridErrors->Text.c_str());
  }
}

// A field that is not linear, and scalars of cells: the partition filter's tetrahedra of the grid give the grid's picture.
void TheFilterDividesAlike()
{
  for (int cells = 0; cells < 2; ++cells) {
    GridScene scene(64, 48);
    Grid grid = Elevated(MixedGrid(3), VTK_QUADRATIC_HEXAHEDRON, VTK_QUADRATIC_WEDGE, VTK_QUADRATIC_PYRAMID, 3, 0.04);
    vtkNew<vtkShortArray> values; // the middles' are rounded
    values->SetName("values");
    const vtkIdType count = cells ? grid->GetNumberOfCells() : grid->GetNumberOfPoints();
    for (vtkIdType i = 0; i < count; ++i) {
      values->InsertNextValue(static_cast<short>(7 * i % 100));
    }
    (cells ? static_cast<vtkDataSetAttributes*>(grid->GetCellData()) : grid->GetPointData())->SetScalars(values);
    scene.Opacity->RemoveAllPoints();
    scene.Opacity->AddPoint(20, 0.0);
    scene.Opacity->AddPoint(100, 0.5);
    scene.Color->RemoveAllPoints();
    scene.Color->AddRGBPoint(0, 0.1, 0.2, 0.9);
    scene.Color->AddRGBPoint(100, 1.0, 0.7, 0.1);
    scene.Tetrahedra->SetInputData(grid);
    const std::vector<float> direct = scene.GridPicture();
    vtkNew<vtkStratusPartitionFilter> filter;
    filter->SetInputData(grid);
    filter->SetDepth(0);
    scene.Tetrahedra->SetInputConnection(filter->GetOutputPort());
    const std::vector<float> filtered = scene.GridPicture();
    CHECK(!direct.empty() && direct == filtered, "%s: the filter's tetrahedra give another picture", cells ? "cells" : "points");
    const std::vector<double> reference = TetraReference(scene, filter->GetOutput(),
      cells ? filter->GetOutput()->GetCellData()->GetScalars() : filter->GetOutput()->GetPointData()->GetScalars(), cells != 0);
    scene.Tetrahedra->SetTermination(1.0);
    const double error = TetraError(scene.GridPicture(), reference);
    CHECK(error < 0.05, "%s: RMSE %.4f of 255", cells ? "cells" : "points", error);
  }
}

// Every way of hiding one of two hexahedra gives the picture of the other hexahedron.
void WholeCellsAreHidden()
{
  GridScene scene;
  scene.Tetrahedra->SetMethodToMarch(); // the cheaper method of one cell may be another than of two
  Grid both = Grid::New(), one = Grid::New();
  vtkNew<vtkPoints> points;
  for (int i = 0; i < 12; ++i) {
    points->InsertNextPoint(i % 3, i / 3 % 2, i / 6);
  }
  const vtkIdType left[8] = { 0, 1, 4, 3, 6, 7, 10, 9 }, right[8] = { 1, 2, 5, 4, 7, 8, 11, 10 };
  both->SetPoints(points);
  both->InsertNextCell(VTK_HEXAHEDRON, 8, left);
  both->InsertNextCell(VTK_HEXAHEDRON, 8, right);
  AddDensity(both);
  one->SetPoints(points);
  one->InsertNextCell(VTK_HEXAHEDRON, 8, left);
  AddDensity(one);
  for (Grid& grid : { std::ref(both), std::ref(one) }) {
    auto* values = vtkFloatArray::SafeDownCast(grid->GetPointData()->GetScalars());
    for (vtkIdType i = 0; i < 12; ++i) {
      values->SetValue(i, 0.5f + 0.1f * values->GetValue(i));
    }
  }
  scene.Tetrahedra->SetInputData(both);
  scene.Renderer->ResetCamera();
  const std::vector<float> whole = scene.GridPicture();
  scene.Tetrahedra->SetInputData(one);
  const std::vector<float> single = scene.GridPicture();
  CHECK(!single.empty() && single != whole, "one cell looks like two");
  scene.Tetrahedra->SetInputData(both);
  auto* values = vtkFloatArray::SafeDownCast(both->GetPointData()->GetScalars());
  const float kept = values->GetValue(8);
  for (float none : { std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity() }) {
    values->SetValue(8, none);
    values->Modified();
    CHECK(scene.GridPicture() == single, "a cell with a corner of %g is drawn", static_cast<double>(none));
  }
  values->SetValue(8, kept);
  values->Modified();
  CHECK(scene.GridPicture() == whole, "a number again, but the cell stays hidden");
  vtkUnsignedCharArray* ghosts = both->AllocatePointGhostArray();
  ghosts->SetValue(2, vtkDataSetAttributes::HIDDENPOINT);
  both->Modified();
  CHECK(scene.GridPicture() == single, "a cell with a blanked corner is drawn");
  both->GetPointData()->RemoveArray("vtkGhostType");
  for (unsigned char flag : { vtkDataSetAttributes::HIDDENCELL, vtkDataSetAttributes::DUPLICATECELL }) {
    both->AllocateCellGhostArray()->SetValue(0, 0);
    both->GetCellGhostArray()->SetValue(1, flag);
    both->Modified();
    CHECK(scene.GridPicture() == single, "a cell with flag %d is drawn", flag);
  }
}

// Pieces of a cell with a blanked corner are blanked, too, those that do not touch it included.
void TheFilterHidesAlike()
{
  GridScene scene;
  scene.Tetrahedra->SetMethodToMarch();
  Grid grid = MixedGrid(Boxes);
  AddDensity(grid);
  scene.Tetrahedra->SetInputData(grid);
  const std::vector<float> whole = scene.GridPicture();
  vtkUnsignedCharArray* ghosts = grid->AllocatePointGhostArray();
  for (vtkIdType point : { 60, 61, 110, 200, 340 }) {
    ghosts->SetValue(point, vtkDataSetAttributes::HIDDENPOINT);
  }
  grid->Modified();
  const std::vector<float> direct = scene.GridPicture();
  vtkNew<vtkStratusPartitionFilter> filter;
  filter->SetInputData(grid);
  for (int depth : { 0, 3 }) {
    filter->SetDepth(depth);
    filter->SetLeafCells(50);
    scene.Tetrahedra->SetInputConnection(filter->GetOutputPort());
    const std::vector<float> filtered = scene.GridPicture();
    double worst = filtered.size() == direct.size() && !direct.empty() ? 0.0 : 1.0;
    for (size_t i = 0; i < direct.size() && worst < 1.0; ++i) {
      worst = std::max(worst, std::fabs(static_cast<double>(direct[i]) - static_cast<double>(filtered[i])));
    }
    CHECK(worst < (depth ? 2e-4 : 1e-9), "depth %d: pixels differ by %g", depth, worst);
  }
  CHECK(direct != whole, "blanked points hide nothing");
}

// Projection sorts a partition's leaves in parallel, as long as they are where the partition says.
void LeavesAreSortedInParallel()
{
  GridScene scene;
  vtkNew<vtkStratusPartitionFilter> filter;
  filter->SetInputData(scene.Grid);
  filter->SetLeafCells(20);
  filter->Update();
  Grid cut = Grid::New(), whole = Grid::New();
  cut->DeepCopy(filter->GetOutput());
  whole->DeepCopy(cut);
  whole->GetFieldData()->Initialize();
  scene.Tetrahedra->SetMethodToProject();
  for (int moved = 0; moved < 2; ++moved) {
    for (vtkIdType i = 0; i < cut->GetNumberOfPoints() && moved; ++i) {
      const Vector p = PointOf(cut, i);
      for (vtkUnstructuredGrid* grid : { cut.Get(), whole.Get() }) {
        grid->GetPoints()->SetPoint(i, p[0] + 0.4 * p[1], p[1] + 0.3 * p[2], p[2] + 0.2 * p[0]);
        grid->GetPoints()->Modified();
      }
    }
    scene.Tetrahedra->SetInputData(whole);
    const std::vector<float> plain = scene.GridPicture();
    CHECK(scene.Tetrahedra->GetNumberOfLeaves() == 1, "%lld leaves of no partition",
      static_cast<long long>(scene.Tetrahedra->GetNumberOfLeaves()));
    scene.Tetrahedra->SetInputData(cut);
    for (int time = 0; time < 2; ++time) {
      const std::vector<float> picture = scene.GridPicture();
      double worst = picture.size() == plain.size() && !plain.empty() ? 0.0 : 1.0;
      for (size_t i = 0; i < plain.size() && worst < 1.0; ++i) {
        worst = std::max(worst, std::fabs(static_cast<double>(picture[i]) - static_cast<double>(plain[i])));
      }
      // another order that is also right: only pieces shorter than rounding may be reversed
      CHECK(worst < 1e-4, "moved %d: pixels differ by %g", moved, worst);
      CHECK(scene.Tetrahedra->GetNumberOfLeaves() == (moved ? 1 : 8), "moved %d: %lld leaves", moved,
        static_cast<long long>(scene.Tetrahedra->GetNumberOfLeaves()));
    }
  }
  scene.Tetrahedra->SetMethodToMarch();
  scene.GridPicture();
  CHECK(scene.Tetrahedra->GetNumberOfLeaves() == 0, "a march sorted leaves");
  CHECK(scene.GridErrors->Count == 0, "%s", scene.GridErrors->Text.c_str());
}

void WhatHasNoVolumeIsIgnored()
{
  GridScene scene;
  const std::vector<float> single = scene.GridPicture();
  const vtkIdType corners[4] = { 0, 1, 8, 7 };
  const int flat[] = { VTK_VERTEX, VTK_LINE, VTK_TRIANGLE, VTK_QUAD };
  const int sizes[] = { 1, 2, 3, 4 };
  for (int i = 0; i < 4; ++i) {
    scene.Grid->InsertNextCell(flat[i], sizes[i], corners);
  }
  scene.Grid->Modified();
  CHECK(scene.GridPicture() == single, "polygons among the cells change the picture");
  CHECK(scene.Tetrahedra->GetNumberOfIgnoredCells() == 4, "%lld cells ignored",
    static_cast<long long>(scene.Tetrahedra->GetNumberOfIgnoredCells()));
  Grid surface = Grid::New();
  surface->SetPoints(scene.Grid->GetPoints());
  surface->InsertNextCell(VTK_QUAD, 4, corners);
  surface->InsertNextCell(VTK_LINE, 2, corners);
  AddDensity(surface);
  scene.Tetrahedra->SetInputData(surface);
  CHECK(scene.GridPicture().empty() && scene.GridErrors->Count == 1 && scene.GridErrors->Has("no cell with a volume: 2"), "'%s'",
    scene.GridErrors->Text.c_str());
}

// Divided once: another view builds nothing, changed values do.
void WhatIsBuiltIsKept()
{
  GridScene scene;
  Grid grid = MixedGrid(Boxes);
  AddDensity(grid);
  scene.Tetrahedra->SetInputData(grid);
  const std::vector<float> before = scene.GridPicture();
  CHECK(scene.Tetrahedra->GetBuildMilliseconds() > 0.0, "nothing was built");
  scene.Look(90, 10);
  scene.GridPicture();
  CHECK(scene.Tetrahedra->GetBuildMilliseconds() == 0.0, "a new view builds for %g ms", scene.Tetrahedra->GetBuildMilliseconds());
  auto* values = vtkFloatArray::SafeDownCast(grid->GetPointData()->GetScalars());
  for (vtkIdType i = 0; i < values->GetNumberOfValues(); ++i) {
    values->SetValue(i, 1.0f - values->GetValue(i));
  }
  values->Modified();
  scene.Look(35, 20);
  const std::vector<float> after = scene.GridPicture();
  CHECK(!after.empty() && after != before, "changed values change nothing");
  vtkNew<vtkStratusTetrahedraMapper> other;
  other->SetInputData(grid);
  scene.Volume->SetMapper(other);
  scene.Render();
  vtkImageData* image = other->GetLastImage();
  const float* rgba = image ? vtkFloatArray::SafeDownCast(image->GetPointData()->GetArray("RGBA"))->GetPointer(0) : nullptr;
  CHECK(rgba && std::equal(after.begin(), after.end(), rgba), "a new mapper draws another picture");
}
} // namespace

int main()
{
  EveryKindOfCell();
  TheFilterDividesAlike();
  WholeCellsAreHidden();
  TheFilterHidesAlike();
  LeavesAreSortedInParallel();
  WhatHasNoVolumeIsIgnored();
  WhatIsBuiltIsKept();
  return Failures ? 1 : 0;
}
