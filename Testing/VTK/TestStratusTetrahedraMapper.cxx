// SPDX-License-Identifier: BSD-3-Clause
// vtkStratusTetrahedraMapper draws the image mapper's picture of an equal field. The window shows the picture; opaque geometry, matrices,
// scalars of cells, ghosts and both blend modes count; other inputs are refused.
#include "tetrahedra_scene.h"

#include "vtkActor.h"
#include "vtkPlane.h"
#include "vtkPlaneSource.h"
#include "vtkPolyDataMapper.h"

namespace {
void TestAgainstTheImageMapper()
{
  GridScene scene;
  CHECK(scene.GridLight() > 100.0, "the picture is all but empty");
  for (int view = 0; view < 4; ++view) {
    scene.Look(35 + 80 * view, 20 - 15 * view);
    scene.Renderer->GetActiveCamera()->SetParallelProjection(view & 1);
    scene.Renderer->ResetCamera();
    const double psnr = scene.Psnr();
    CHECK(psnr > SamePicture, "view %d: %.1f dB", view, psnr);
  }
  scene.Volume->SetScale(1.0, -0.7, 1.3); // a mirror too
  scene.Volume->RotateZ(20);
  scene.Volume->SetPosition(6e6, 0, 0);
  scene.Renderer->ResetCamera();
  const double moved = scene.Psnr();
  CHECK(moved > SamePicture - 4.0, "moved: %.1f dB", moved); // VTK's own camera is worse out there
}

void TestMethods()
{
  GridScene scene;
  CHECK(
    scene.Tetrahedra->GetMethod() == vtkStratusTetrahedraMapper::AUTO_METHOD, "the default is %s", scene.Tetrahedra->GetMethodAsString());
  scene.Tetrahedra->SetMethodToMarch();
  const std::vector<float> marched = scene.GridPicture();
  CHECK(std::string(scene.Tetrahedra->GetMethodUsedAsString()) == "march", "it is %s", scene.Tetrahedra->GetMethodUsedAsString());
  scene.Tetrahedra->SetMethodToProject();
  const std::vector<float> projected = scene.GridPicture();
  CHECK(std::string(scene.Tetrahedra->GetMethodUsedAsString()) == "project", "it is %s", scene.Tetrahedra->GetMethodUsedAsString());
  CHECK(scene.Tetrahedra->GetNumberOfCellsInView() > 0 && scene.Tetrahedra->GetNumberOfSegments() > 0, "nothing was projected");
  double squares = 0.0;
  for (size_t i = 0; i < marched.size() && i < projected.size(); ++i) {
    squares += 255.0 * 255.0 * (marched[i] - projected[i]) * (marched[i] - projected[i]);
  }
  const double rmse = std::sqrt(squares / std::max<size_t>(1, marched.size()));
  CHECK(marched.size() == projected.size() && rmse < 0.01, "the two methods differ by %.4f of 255", rmse);
  scene.Tetrahedra->SetMethodToAuto();
  const std::vector<float> chosen = scene.GridPicture();
  const bool marches = std::string(scene.Tetrahedra->GetMethodUsedAsString()) == "march";
  CHECK(chosen == (marches ? marched : projected), "auto draws a picture of its own");
  CHECK(std::string(scene.Tetrahedra->GetMethodReason()).size() > 10, "there is no reason");
}

void TestInside()
{
  GridScene scene;
  vtkCamera* camera = scene.Renderer->GetActiveCamera();
  camera->SetPosition(2.3, 2.9, 3.1);
  camera->SetFocalPoint(5, 3, 2.8);
  camera->SetClippingRange(0.5, 20);
  const double psnr = scene.Psnr();
  CHECK(psnr > SamePicture, "%.1f dB", psnr);
  CHECK(scene.Tetrahedra->GetNumberOfSegments() > 0, "no segments");
}

void TestShown()
{
  GridScene scene;
  const double background[3] = { 0.2, 0.5, 0.9 };
  scene.Renderer->SetBackground(0.2, 0.5, 0.9);
  const std::vector<float> picture = scene.GridPicture();
  const std::vector<unsigned char> bytes = scene.Bytes();
  double worst = picture.empty() ? 255.0 : 0.0;
  for (size_t p = 0; 4 * p < picture.size(); ++p) {
    for (size_t c = 0; c < 3; ++c) {
      const double meant = picture[4 * p + c] + (1.0 - picture[4 * p + 3]) * background[c];
      worst = std::max(worst, std::fabs(255.0 * meant - bytes[4 * p + c]));
    }
  }
  CHECK(worst <= 1.0, "the window is off by %.2f of 255", worst);
}

// A wall across the middle: rays end there, as the image mapper's do.
void TestOpaque()
{
  GridScene scene;
  vtkNew<vtkPlaneSource> wall;
  wall->SetOrigin(-5, -5, 3);
  wall->SetPoint1(11, -5, 3.5);
  wall->SetPoint2(-5, 11, 3);
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputConnection(wall->GetOutputPort());
  vtkNew<vtkActor> actor;
  actor->SetMapper(mapper);
  const double before = scene.GridLight();
  scene.Renderer->AddActor(actor);
  const double psnr = scene.Psnr();
  CHECK(psnr > SamePicture, "%.1f dB", psnr);
  CHECK(scene.GridLight() < 0.9 * before, "the wall hides nothing: %g of %g", scene.GridLight(), before);
}

void TestScalarsAndGhosts()
{
  GridScene scene;
  const std::vector<float> whole = scene.GridPicture();
  vtkNew<vtkFloatArray> cells;
  cells->SetName("cells");
  for (vtkIdType i = 0; i < scene.Grid->GetNumberOfCells(); ++i) {
    cells->InsertNextValue(0.5f);
  }
  scene.Grid->GetCellData()->AddArray(cells);
  scene.Tetrahedra->SetScalarMode(VTK_SCALAR_MODE_USE_CELL_FIELD_DATA);
  scene.Tetrahedra->SelectScalarArray("cells");
  const std::vector<float> constant = scene.GridPicture();
  CHECK(!constant.empty() && constant != whole, "scalars of cells change nothing");
  scene.Tetrahedra->SetScalarMode(VTK_SCALAR_MODE_DEFAULT);
  CHECK(scene.GridPicture() == whole, "the first scalars give another picture the second time");
  vtkNew<vtkUnsignedCharArray> ghosts;
  ghosts->SetName("vtkGhostType");
  ghosts->SetNumberOfValues(scene.Grid->GetNumberOfCells());
  ghosts->Fill(vtkDataSetAttributes::DUPLICATECELL);
  scene.Grid->GetCellData()->AddArray(ghosts);
  scene.Grid->Modified();
  CHECK(scene.GridLight() == 0.0, "cells of another piece are drawn");
  ghosts->Fill(0);
  ghosts->SetValue(700, vtkDataSetAttributes::HIDDENCELL);
  scene.Grid->Modified();
  const std::vector<float> hole = scene.GridPicture();
  CHECK(!hole.empty() && hole != whole, "a blanked cell is drawn");
}

void TestMaximum()
{
  GridScene scene;
  scene.Tetrahedra->SetBlendMode(vtkUnstructuredGridVolumeMapper::MAXIMUM_INTENSITY_BLEND);
  const std::vector<float> picture = scene.GridPicture();
  float largest = 0.0f;
  for (size_t p = 0; 4 * p < picture.size(); ++p) {
    largest = std::max(largest, picture[4 * p + 3]);
  }
  // the largest value is .9, at the cube's edge: opacity .15 + .35 * 5/6
  CHECK(largest > 0.40f && largest < 0.442f, "the largest alpha is %g", largest);
}

void TestRefusals()
{
  GridScene scene;
  const auto refuses = [&](const char* word) {
    const int before = scene.GridErrors->Count;
    CHECK(scene.GridPicture().empty(), "%s: something is drawn", word);
    CHECK(scene.GridErrors->Count == before + 1 && scene.GridErrors->Has(word), "%s: %d errors, '%s'", word,
      scene.GridErrors->Count - before, scene.GridErrors->Text.c_str());
    scene.Render();
    CHECK(scene.GridErrors->Count == before + 1, "%s: reported again", word);
  };
  for (int p = 0; p < 7; ++p) {
    vtkNew<vtkPlane> plane;
    scene.Tetrahedra->AddClippingPlane(plane);
  }
  refuses("7 clipping planes");
  scene.Tetrahedra->RemoveAllClippingPlanes();
  vtkNew<vtkFloatArray> flags;
  vtkNew<vtkUnsignedCharArray> few;
  flags->SetNumberOfTuples(scene.Grid->GetNumberOfPoints());
  few->SetNumberOfTuples(3);
  for (vtkDataArray* ghosts : { static_cast<vtkDataArray*>(flags), static_cast<vtkDataArray*>(few) }) {
    ghosts->SetName("vtkGhostType");
    ghosts->Fill(0);
    scene.Grid->GetPointData()->AddArray(ghosts);
    scene.Grid->Modified();
    refuses(ghosts == flags ? "float, it must have one unsigned char for each" : "'vtkGhostType' has 3 tuples");
    scene.Grid->GetPointData()->RemoveArray("vtkGhostType");
  }
  scene.Grid->InsertNextCell(VTK_LAGRANGE_PYRAMID, 4, scene.Grid->GetCell(0)->GetPointIds()->GetPointer(0));
  scene.Grid->Modified();
  refuses("(74)");
  vtkNew<vtkUnstructuredGrid> empty;
  empty->Initialize(); // it has no array of cells then
  scene.Tetrahedra->SetInputData(empty);
  const int before = scene.GridErrors->Count;
  CHECK(scene.GridPicture().empty() && scene.GridErrors->Count == before, "an empty grid is an error: %s", scene.GridErrors->Text.c_str());
  vtkNew<vtkUnstructuredGrid> bare;
  MakeGrid(bare);
  bare->GetPointData()->Initialize();
  scene.Tetrahedra->SetInputData(bare);
  refuses("no scalar array");
  MakeGrid(bare);
  scene.Tetrahedra->SetInputData(bare);
  CHECK(scene.GridLight() > 100.0, "nothing is drawn after errors");
}
} // namespace

int main()
{
  TestAgainstTheImageMapper();
  TestMethods();
  TestInside();
  TestShown();
  TestOpaque();
  TestScalarsAndGhosts();
  TestMaximum();
  TestRefusals();
  return Failures ? 1 : 0;
}
