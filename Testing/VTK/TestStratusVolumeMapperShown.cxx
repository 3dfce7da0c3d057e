// SPDX-License-Identifier: BSD-3-Clause
// The window shows the mapper's picture over the earlier content: copied into an empty frame buffer, blended over anything else.
#include "mapper_testing.h"

#include "vtkActor2D.h"
#include "vtkPolyData.h"
#include "vtkPolyDataMapper2D.h"

namespace {
const double Black[3] = { 0, 0, 0 };

// Bytes of the whole window.
std::vector<unsigned char> WindowBytes(Scene& scene)
{
  const int* size = scene.Window->GetSize();
  vtkNew<vtkUnsignedCharArray> pixels;
  scene.Window->GetRGBACharPixelData(0, 0, size[0] - 1, size[1] - 1, 1, pixels);
  return std::vector<unsigned char>(pixels->GetPointer(0), pixels->GetPointer(0) + pixels->GetNumberOfValues());
}

// Copied or blended (a visible actor that draws nothing forbids the copy), a single volume on black gives equal bytes, alpha included.
void CopiedAsBlended()
{
  Scene scene;
  scene.Window->SetAlphaBitPlanes(1);
  scene.Render();
  const std::vector<unsigned char> copied = WindowBytes(scene);
  CHECK(scene.ShownError(Black) <= 0.51, "a copied picture differs by %.2f of 255", scene.ShownError(Black));
  vtkNew<vtkActor2D> nothing;
  vtkNew<vtkPolyDataMapper2D> empty;
  vtkNew<vtkPolyData> points;
  empty->SetInputData(points);
  nothing->SetMapper(empty);
  scene.Renderer->AddViewProp(nothing);
  scene.Render();
  CHECK(WindowBytes(scene) == copied, "copied and blended bytes differ");
}

// An older picture leaves nothing elsewhere in the window.
void NothingStays()
{
  Scene scene;
  scene.Render();
  const std::vector<unsigned char> first = WindowBytes(scene);
  scene.Renderer->GetActiveCamera()->Azimuth(100);
  scene.Renderer->GetActiveCamera()->Zoom(0.4);
  scene.Render();
  CHECK(WindowBytes(scene) != first, "another view shows the same");
  CHECK(scene.ShownError(Black) <= 0.51, "after another view the picture differs by %.2f of 255", scene.ShownError(Black));
}

// A second volume of ours adds to the first.
void TwoVolumes()
{
  Scene scene;
  scene.Render();
  std::vector<unsigned char> single = WindowBytes(scene);
  vtkNew<vtkStratusVolumeMapper> mapper;
  vtkNew<vtkVolume> volume;
  mapper->SetInputData(scene.Image);
  mapper->SetDevice("host");
  volume->SetMapper(mapper);
  volume->SetProperty(scene.Volume->GetProperty());
  volume->SetPosition(20, 0, 0);
  scene.Renderer->AddViewProp(volume);
  scene.Render();
  const std::vector<unsigned char> both = WindowBytes(scene);
  size_t lost = 0, lit = 0;
  for (size_t p = 0; p < both.size(); p += 4) {
    const int before = single[p] + single[p + 1] + single[p + 2], after = both[p] + both[p + 1] + both[p + 2];
    lit += before > 30;
    lost += before > 30 && after == 0;
  }
  CHECK(lit > 500, "the first volume lights %zu pixels only", lit);
  CHECK(lost == 0, "the second volume erased %zu of %zu pixels", lost, lit);
  CHECK(both != single, "the second volume shows nothing");
}

// Two renderers side by side: neither draws into the other's half; a kept colour buffer is blended with.
void Renderers()
{
  Scene scene(200, 90);
  scene.Renderer->SetViewport(0.5, 0, 1, 1);
  vtkNew<vtkRenderer> left;
  left->SetViewport(0, 0, 0.5, 1);
  left->SetBackground(0.2, 0.6, 0.4);
  scene.Window->AddRenderer(left);
  scene.Render();
  const std::vector<unsigned char> bytes = WindowBytes(scene);
  size_t wrong = 0;
  for (size_t p = 0; p < bytes.size(); p += 4) {
    wrong += p / 4 % 200 < 100 && (bytes[p] != 51 || bytes[p + 1] != 153 || bytes[p + 2] != 102);
  }
  CHECK(wrong == 0, "%zu pixels of the other renderer's half changed", wrong);
  CHECK(scene.ShownError(Black) <= 0.51, "in half a window the picture differs by %.2f of 255", scene.ShownError(Black));
}

// The layer above keeps the colours of the one below.
void Layers()
{
  Scene scene;
  vtkNew<vtkRenderer> below;
  const double color[3] = { 0.4, 0.2, 0.6 };
  below->SetBackground(0.4, 0.2, 0.6);
  scene.Window->SetNumberOfLayers(2);
  scene.Renderer->SetLayer(1);
  scene.Window->AddRenderer(below);
  scene.Render();
  // Blended in bytes: software OpenGL rounds up to three times.
  CHECK(scene.ShownError(color) <= 1.5, "over another layer the picture differs by %.2f of 255", scene.ShownError(color));
}
} // namespace

int main()
{
  CopiedAsBlended();
  NothingStays();
  TwoVolumes();
  Renderers();
  Layers();
  return Failures == 0 ? 0 : 1;
}
