// SPDX-License-Identifier: BSD-3-Clause
// The steps of a simulation: a grid whose values change, while its points and cells keep their content. Neighbours and borders stay, in
// whatever objects a step comes, and each picture is a new mapper's.
#include "tetrahedra_scene.h"

#include "vtkCellArray.h"
#include "vtkUnsignedCharArray.h"

namespace {
// Adds a layer of hexahedra below the cells of MakeGrid(), so that a part of the cells is divided.
void AddHexahedra(vtkUnstructuredGrid* grid)
{
  const vtkIdType side = Boxes + 1;
  vtkPoints* points = grid->GetPoints();
  auto* values = vtkFloatArray::SafeDownCast(grid->GetPointData()->GetScalars());
  const vtkIdType first = points->GetNumberOfPoints();
  for (int j = 0; j < side; ++j) {
    for (int i = 0; i < side; ++i) {
      points->InsertNextPoint(i, j, -1.0);
      values->InsertNextValue(FieldAt(i, 0));
    }
  }
  for (vtkIdType j = 0; j < Boxes; ++j) {
    for (vtkIdType i = 0; i < Boxes; ++i) {
      const vtkIdType a = j * side + i, b = first + a;
      const vtkIdType cell[8] = { b, b + 1, b + side + 1, b + side, a, a + 1, a + side + 1, a + side };
      grid->InsertNextCell(VTK_HEXAHEDRON, 8, cell);
    }
  }
}

// The values of a step. Their range stays.
void SetStep(vtkUnstructuredGrid* grid, int step)
{
  auto* values = vtkFloatArray::SafeDownCast(grid->GetPointData()->GetScalars());
  for (vtkIdType i = 1; i + 1 < values->GetNumberOfValues(); ++i) {
    values->SetValue(i, 0.3f + 0.2f * static_cast<float>(std::sin(0.37 * static_cast<double>(i) + step)));
  }
  values->Modified();
}

void Draw(GridScene& scene, vtkUnstructuredGrid* grid, vtkTypeUInt64 geometry, vtkTypeUInt64 values, const char* what)
{
  scene.Tetrahedra->SetInputData(grid);
  const std::vector<float> kept = scene.GridPicture();
  CHECK(scene.Tetrahedra->GetGeometryBuilds() == geometry, "%s: geometry was built %llu times, %llu were right", what,
    static_cast<unsigned long long>(scene.Tetrahedra->GetGeometryBuilds()), static_cast<unsigned long long>(geometry));
  CHECK(scene.Tetrahedra->GetValueBuilds() == values, "%s: values were taken %llu times, %llu were right", what,
    static_cast<unsigned long long>(scene.Tetrahedra->GetValueBuilds()), static_cast<unsigned long long>(values));
  vtkNew<vtkStratusTetrahedraMapper> other;
  other->SetInputData(grid);
  other->SetMethod(scene.Tetrahedra->GetMethod());
  scene.Volume->SetMapper(other);
  scene.Render();
  vtkImageData* image = other->GetLastImage();
  const float* rgba = image ? vtkFloatArray::SafeDownCast(image->GetPointData()->GetArray("RGBA"))->GetPointer(0) : nullptr;
  CHECK(rgba && !kept.empty() && std::equal(kept.begin(), kept.end(), rgba), "%s: a new mapper draws another picture", what);
  scene.Volume->SetMapper(scene.Tetrahedra);
}

void Steps(bool hexahedra, int method)
{
  GridScene scene;
  scene.Tetrahedra->SetMethod(method);
  if (hexahedra) {
    AddHexahedra(scene.Grid);
  }
  SetStep(scene.Grid, 0);
  Draw(scene, scene.Grid, 1, 1, "first");
  SetStep(scene.Grid, 1);
  Draw(scene, scene.Grid, 1, 2, "in the same arrays");
  for (int step = 2; step < 4; ++step) { // as readers do
    vtkNew<vtkUnstructuredGrid> grid;
    grid->DeepCopy(scene.Grid);
    SetStep(grid, step);
    Draw(scene, grid, 1, static_cast<vtkTypeUInt64>(step) + 1, "in a grid of its own");
  }
  vtkNew<vtkUnstructuredGrid> shallow;
  shallow->ShallowCopy(scene.Grid);
  Draw(scene, shallow, 1, 5, "in a shallow copy");
  shallow->Modified();
  Draw(scene, shallow, 1, 5, "modified, and the same");
}

// Changes of more than the values rebuild the geometry.
void OtherGeometry()
{
  GridScene scene;
  SetStep(scene.Grid, 0);
  Draw(scene, scene.Grid, 1, 1, "first");
  scene.Grid->GetPoints()->SetPoint(100, 2.1, 0.1, 2.2);
  scene.Grid->GetPoints()->Modified();
  Draw(scene, scene.Grid, 2, 2, "a point was moved");
  vtkNew<vtkUnsignedCharArray> ghosts;
  ghosts->SetName(vtkDataSetAttributes::GhostArrayName());
  ghosts->SetNumberOfTuples(scene.Grid->GetNumberOfCells());
  ghosts->FillValue(0);
  scene.Grid->GetCellData()->AddArray(ghosts);
  Draw(scene, scene.Grid, 2, 3, "flags that hide nothing");
  ghosts->SetValue(200, vtkDataSetAttributes::HIDDENCELL);
  ghosts->Modified();
  Draw(scene, scene.Grid, 3, 4, "a cell was hidden");
  auto* values = vtkFloatArray::SafeDownCast(scene.Grid->GetPointData()->GetScalars());
  values->SetValue(57, std::nanf(""));
  values->Modified();
  Draw(scene, scene.Grid, 4, 5, "a value is not a number");
  vtkNew<vtkUnstructuredGrid> fewer;
  fewer->DeepCopy(scene.Grid);
  fewer->GetCellData()->Initialize();
  fewer->SetCells(VTK_TETRA, [&] {
    vtkNew<vtkCellArray> cells;
    for (vtkIdType c = 0; c < scene.Grid->GetNumberOfCells() / 2; ++c) {
      cells->InsertNextCell(scene.Grid->GetCell(c));
    }
    return vtkSmartPointer<vtkCellArray>(cells);
  }());
  Draw(scene, fewer, 5, 6, "half of the cells");
}
} // namespace

int main()
{
  for (const int method : { vtkStratusTetrahedraMapper::MARCH_METHOD, vtkStratusTetrahedraMapper::PROJECT_METHOD }) {
    Steps(false, method);
    Steps(true, method);
  }
  OtherGeometry();
  return Failures ? 1 : 0;
}
