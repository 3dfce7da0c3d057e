// SPDX-License-Identifier: BSD-3-Clause
// The mapper's float picture against the double reference, for every way a camera or a volume can lie; and what the window shows against
// the float picture.
#include "mapper_testing.h"

#include "vtkWindowToImageFilter.h"

namespace {
// A quarter of a voxel a step reaches 82 dB and more on this field; a picture that is off by a pixel or half a voxel falls below 50.
constexpr double SmoothDb = 78.0;
// Nearest interpolation jumps at voxel walls, where a midpoint rule meets the reference only to within its step.
constexpr double NearestDb = 58.0;

void Compare(const char* what, const std::function<void(Scene&)>& change, vtkFloatArray* cells = nullptr, double wanted = SmoothDb)
{
  Scene scene;
  scene.Mapper->SetSampleDistance(0.25);
  change(scene);
  scene.Render();
  CHECK(scene.Errors->Count == 0, "%s: %s", what, scene.Errors->Text.c_str());
  const double psnr = ReferencePsnr(scene, nullptr, cells);
  std::printf("%-28s %6.1f dB\n", what, psnr);
  CHECK(psnr >= wanted, "%s: %.1f dB against the reference", what, psnr);
  // Half a step of rounding, and as much again for a window that blends in bytes.
  const double shown = scene.ShownError(scene.Renderer->GetBackground());
  CHECK(shown <= 1.0, "%s: the window differs from the cast picture by %.2f of 255", what, shown);
}

void Cameras()
{
  Compare("perspective", [](Scene&) {});
  Compare("over a background", [](Scene& s) { s.Renderer->SetBackground(0.2, 0.4, 0.8); });
  Compare("parallel", [](Scene& s) { s.Renderer->GetActiveCamera()->ParallelProjectionOn(); });
  Compare("off-centre window", [](Scene& s) { s.Renderer->GetActiveCamera()->SetWindowCenter(0.3, -0.4); });
  Compare("off-centre, parallel", [](Scene& s) {
    s.Renderer->GetActiveCamera()->ParallelProjectionOn();
    s.Renderer->GetActiveCamera()->SetWindowCenter(-0.25, 0.35);
  });
  Compare("sheared view", [](Scene& s) {
    s.Renderer->GetActiveCamera()->ParallelProjectionOn();
    s.Renderer->GetActiveCamera()->SetViewShear(0.2, -0.1, 1.0);
  });
  Compare("off-axis projection", [](Scene& s) {
    // A screen before the eye, off to one side of it: before VTK 9.3 in the coordinates of the eye, since then of the world, here the same.
    s.Image->SetOrigin(-12.4, -15, -73.2);
    vtkCamera* camera = s.Renderer->GetActiveCamera();
    camera->SetPosition(0, 0, 0);
    camera->SetFocalPoint(0, 0, -60);
    camera->SetViewUp(0, 1, 0);
    camera->SetClippingRange(1, 200);
    camera->SetScreenBottomLeft(-13, -14, -60);
    camera->SetScreenBottomRight(17, -14, -60);
    camera->SetScreenTopRight(17, 12, -60);
    camera->SetUseOffAxisProjection(1);
  });
  Compare("camera inside", [](Scene& s) {
    vtkCamera* camera = s.Renderer->GetActiveCamera();
    camera->SetPosition(14, 14, 13);
    camera->SetFocalPoint(4, 8, 10);
    camera->SetViewAngle(70);
    s.Renderer->ResetCameraClippingRange();
  });
  Compare("near plane inside", [](Scene& s) {
    vtkCamera* camera = s.Renderer->GetActiveCamera();
    camera->SetClippingRange(camera->GetDistance() - 3, camera->GetDistance() + 100);
  });
  Compare("partly out of the window", [](Scene& s) { s.Renderer->GetActiveCamera()->Yaw(12); });
  Compare("viewport in a corner", [](Scene& s) { s.Renderer->SetViewport(0.31, 0.27, 0.93, 0.99); });
  Compare("far from the origin", [](Scene& s) {
    s.Image->SetOrigin(6.0e6, -3.0e6, 2.0e5);
    s.Look(35, 20);
  });
}

void Volumes()
{
  Compare("extent from 7, -3, 11", [](Scene& s) {
    s.Image->SetExtent(7, 39, -3, 25, 11, 35);
    s.Image->SetOrigin(5, 6, -7);
    s.Look(-40, 10);
  });
  Compare("direction matrix", [](Scene& s) {
    const double turn[9] = { 0.6, -0.8, 0, 0.8, 0.6, 0, 0, 0, 1 };
    s.Image->SetDirectionMatrix(turn);
    s.Image->SetExtent(3, 35, 2, 30, 1, 25);
    s.Look(20, 30);
  });
  Compare("rotated, scaled and moved", [](Scene& s) {
    s.Volume->RotateWXYZ(50, 1, 2, 3);
    s.Volume->SetScale(1.4, 0.8, 1.1);
    s.Volume->SetPosition(3, -20, 8);
    s.Look(35, 20);
  });
  Compare("mirrored", [](Scene& s) {
    s.Volume->SetScale(-1, 1, 1);
    s.Look(35, 20);
  });
  Compare(
    "nearest",
    [](Scene& s) {
      s.Volume->GetProperty()->SetInterpolationTypeToNearest();
      s.Mapper->SetSampleDistance(0.03);
    },
    nullptr, NearestDb);
  vtkNew<vtkFloatArray> cells;
  Compare(
    "cell data",
    [&](Scene& s) {
      FillField(s.Image, true, "cells");
      s.Image->GetPointData()->Initialize();
      cells->ShallowCopy(s.Image->GetCellData()->GetScalars());
    },
    cells);
}

// VTK draws large pictures in tiles; each tile's rays are the whole picture's.
void Tiles()
{
  Scene whole(160, 120), tiles(80, 60);
  whole.Render();
  vtkNew<vtkWindowToImageFilter> tiled;
  tiled->SetInput(tiles.Window);
  tiled->SetScale(2, 2);
  tiled->FixBoundaryOff();
  tiled->ReadFrontBufferOff();
  tiled->Update();
  vtkNew<vtkWindowToImageFilter> single;
  single->SetInput(whole.Window);
  single->ReadFrontBufferOff();
  single->Update();
  vtkDataArray* a = tiled->GetOutput()->GetPointData()->GetScalars();
  vtkDataArray* b = single->GetOutput()->GetPointData()->GetScalars();
  CHECK(a->GetNumberOfValues() == b->GetNumberOfValues(), "tiles give another size");
  double worst = 0.0;
  for (vtkIdType t = 0; t < std::min(a->GetNumberOfTuples(), b->GetNumberOfTuples()); ++t) {
    worst = std::max(worst, std::fabs(a->GetComponent(t, 0) - b->GetComponent(t, 0)));
  }
  CHECK(worst <= 1.0, "tiles differ from the whole by %g of 255", worst);
}

// A window with several samples a pixel shows the same, though the picture is drawn in pieces, without its empty rows and margins. No pixel
// is drawn twice or left out where pieces meet. Software OpenGL rounds three times where it blends over a colour: 1.3 of 255 at most.
void Multisampled()
{
  for (const int samples : { 4, 8 }) {
    for (const double gray : { 0.0, 0.6 }) {
      Scene scene(333, 251);
      scene.Renderer->SetBackground(gray, gray, gray);
      scene.Window->SetMultiSamples(samples);
      scene.Render();
      const double shown = scene.ShownError(scene.Renderer->GetBackground());
      CHECK(
        shown <= (gray > 0.0 ? 1.3 : 1.0), "with %d samples a pixel over %g what is shown differs by %.2f of 255", samples, gray, shown);
    }
  }
}

// A volume behind the camera: nothing drawn, nothing said.
void OutOfSight()
{
  Scene scene;
  scene.Render();
  vtkCamera* camera = scene.Renderer->GetActiveCamera();
  camera->Yaw(180);
  camera->SetClippingRange(1, 1000);
  scene.Render();
  for (unsigned char byte : scene.Bytes()) {
    CHECK(byte == 0 || byte == 255, "a volume behind the camera is seen");
  }
  CHECK(scene.Errors->Count == 0, "%s", scene.Errors->Text.c_str());
}
} // namespace

int main()
{
  Cameras();
  Volumes();
  Tiles();
  Multisampled();
  OutOfSight();
  return Failures == 0 ? 0 : 1;
}
