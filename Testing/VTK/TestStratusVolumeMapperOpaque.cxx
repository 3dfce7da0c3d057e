// SPDX-License-Identifier: BSD-3-Clause
// Opaque geometry inside the volume ends rays: in float against the reference with equal depths, and in the window.
#include "mapper_testing.h"

#include "vtkActor.h"
#include "vtkAxesActor.h"
#include "vtkFollower.h"
#include "vtkLineSource.h"
#include "vtkPolyData.h"
#include "vtkPolyDataMapper.h"
#include "vtkProperty.h"
#include "vtkSphereSource.h"
#include "vtkTransform.h"

#include <numeric>

namespace {
struct Opaque {
  Opaque(Scene& scene, double x, double y, double z, double radius)
  {
    this->Sphere->SetCenter(x, y, z);
    this->Sphere->SetRadius(radius);
    this->Sphere->SetThetaResolution(40);
    this->Sphere->SetPhiResolution(40);
    this->Mapper->SetInputConnection(this->Sphere->GetOutputPort());
    this->Actor->SetMapper(this->Mapper);
    this->Actor->GetProperty()->LightingOff();
    this->Actor->GetProperty()->SetColor(0.2, 1.0, 0.4);
    scene.Renderer->AddActor(this->Actor);
  }
  vtkNew<vtkSphereSource> Sphere;
  vtkNew<vtkPolyDataMapper> Mapper;
  vtkNew<vtkActor> Actor;
};

void Inside(bool parallel)
{
  Scene scene;
  scene.Mapper->SetSampleDistance(0.25);
  Opaque opaque(scene, 14, 13, 12, 6);
  scene.Renderer->GetActiveCamera()->SetParallelProjection(parallel);
  scene.Render();
  // The depths and colours behind the volume, from a picture without it, with the same clipping range.
  double range[2];
  scene.Renderer->GetActiveCamera()->GetClippingRange(range);
  scene.Volume->VisibilityOff();
  scene.Renderer->GetActiveCamera()->SetClippingRange(range);
  scene.Render();
  const int* size = scene.Renderer->GetSize();
  std::vector<float> depth(scene.Pixels());
  scene.Window->GetZbufferData(0, 0, size[0] - 1, size[1] - 1, depth.data());
  const std::vector<unsigned char> behind = scene.Bytes();
  scene.Volume->VisibilityOn();
  scene.Renderer->GetActiveCamera()->SetClippingRange(range);
  scene.Render();
  const double psnr = ReferencePsnr(scene, [&](reference_scene& reference) { reference.opaque_depth = depth.data(); });
  std::printf("opaque sphere, %s: %.1f dB\n", parallel ? "parallel" : "perspective", psnr);
  // A ray that ends half a step wrong, or not at all, falls below 60.
  CHECK(psnr >= 78.0, "%.1f dB against the reference", psnr);

  const std::vector<unsigned char> shown = scene.Bytes();
  const float* rgba = scene.Rgba();
  double worst = 0.0;
  size_t covered = 0;
  for (size_t p = 0; p < scene.Pixels(); ++p) {
    covered += depth[p] < 1.0f && rgba[4 * p + 3] > 0.0f;
    for (size_t c = 0; c < 3; ++c) {
      worst = std::max(worst, std::fabs(255.0 * rgba[4 * p + c] + (1.0 - rgba[4 * p + 3]) * behind[4 * p + c] - shown[4 * p + c]));
    }
  }
  CHECK(covered > 200, "only %zu pixels show the volume before the sphere", covered);
  CHECK(worst <= 1.0, "what is shown differs by %.2f of 255", worst);
}

// In front of the volume it hides it, behind it does not; hidden itself, or gone, it leaves no trace.
void AroundIt()
{
  Scene scene;
  const std::vector<float> plain = scene.Picture();
  double center[3], toEye[3];
  scene.Renderer->GetActiveCamera()->GetFocalPoint(center);
  scene.Renderer->GetActiveCamera()->GetDirectionOfProjection(toEye);
  Opaque before(scene, center[0] - 40 * toEye[0], center[1] - 40 * toEye[1], center[2] - 40 * toEye[2], 12);
  scene.Renderer->ResetCameraClippingRange();
  CHECK(scene.Light() < 0.5 * std::accumulate(plain.begin(), plain.end(), 0.0), "a sphere in front hides too little");
  before.Sphere->SetCenter(center[0] + 40 * toEye[0], center[1] + 40 * toEye[1], center[2] + 40 * toEye[2]);
  scene.Renderer->ResetCameraClippingRange();
  scene.Render();
  double worst = 0.0;
  const float* rgba = scene.Rgba();
  for (size_t i = 0; i < plain.size(); ++i) {
    worst = std::max(worst, std::fabs(static_cast<double>(rgba[i]) - plain[i]));
  }
  // The clipping range is another one, so the rays' ends round differently; nothing more.
  CHECK(worst < 1e-4, "a sphere behind changes the volume by %g", worst);
  before.Actor->VisibilityOff();
  scene.Renderer->ResetCameraClippingRange();
  CHECK(scene.Picture() == plain, "a hidden actor changes the picture");
}

// An axes actor's own bounds are symmetric about the origin. After a move they no longer contain the axes.
void Axes()
{
  Scene scene;
  scene.Image->SetOrigin(-80, -80, -80);
  scene.Renderer->ResetCamera();
  const std::vector<float> plain = scene.Picture();
  vtkNew<vtkAxesActor> axes;
  vtkNew<vtkTransform> away;
  away->Translate(-84, -68, -53);
  axes->SetUserTransform(away);
  axes->SetTotalLength(30, 16, 16);
  axes->AxisLabelsOff();
  scene.Renderer->AddActor(axes);
  const std::vector<float> part = scene.Picture();
  vtkNew<vtkFollower> nothing;
  vtkNew<vtkPolyDataMapper> empty;
  vtkNew<vtkPolyData> noCells;
  empty->SetInputData(noCells);
  nothing->SetMapper(empty);
  scene.Renderer->AddActor(nothing);
  CHECK(part != plain, "the axes hide nothing");
  CHECK(scene.Picture() == part, "the axes hide more when all of the depth is read");
}

// Coarse pictures end at the geometry too.
void Coarse()
{
  Scene scene;
  Opaque opaque(scene, 14, 13, 12, 6);
  const double fine = scene.Light();
  scene.Mapper->SetImageSampleDistance(3);
  const double coarse = scene.Light();
  CHECK(std::fabs(coarse / fine - 1.0) < 0.1, "light of %g fine and %g coarse", fine, coarse);
}

// Depth is read only near props whose bounds contain what they draw. A follower's bounds don't, so a follower that draws nothing makes the
// mapper read the whole depth. Both pictures must be equal, also in a window with a gradient.
void Near(int samples)
{
  Scene scene;
  scene.Window->SetMultiSamples(samples);
  scene.Renderer->GradientBackgroundOn();
  scene.Renderer->SetBackground(.1, .2, .3);
  scene.Renderer->SetBackground2(.8, .6, .5);
  const std::vector<float> plain = scene.Picture();
  Opaque small(scene, 8, 20, 20, 3);
  vtkNew<vtkLineSource> line;
  vtkNew<vtkPolyDataMapper> mapper;
  vtkNew<vtkActor> wide;
  line->SetPoint1(20, 4, 24);
  line->SetPoint2(24, 9, 24);
  mapper->SetInputConnection(line->GetOutputPort());
  wide->SetMapper(mapper);
  wide->GetProperty()->SetLineWidth(7);
  scene.Renderer->AddActor(wide);
  const std::vector<float> part = scene.Picture();
  const std::vector<unsigned char> shown = scene.Bytes();
  vtkNew<vtkFollower> nothing;
  vtkNew<vtkPolyDataMapper> empty;
  vtkNew<vtkPolyData> noCells;
  empty->SetInputData(noCells);
  nothing->SetMapper(empty);
  scene.Renderer->AddActor(nothing);
  CHECK(part != plain, "the actors hide nothing with %d samples", samples);
  CHECK(scene.Picture() == part, "a part of the depth gives another picture than all of it with %d samples", samples);
  CHECK(scene.Bytes() == shown, "a part of the depth shows something else than all of it with %d samples", samples);

  scene.Volume->VisibilityOff();
  scene.Render();
  const std::vector<unsigned char> behind = scene.Bytes();
  double worst = 0.0;
  for (size_t p = 0; p < scene.Pixels(); ++p) {
    for (size_t c = 0; c < 3; ++c) {
      const double meant = 255.0 * part[4 * p + c] + (1.0 - part[4 * p + 3]) * behind[4 * p + c];
      worst = std::max(worst, std::fabs(meant - shown[4 * p + c]));
    }
  }
  // One rounding here; with samples the frame buffer rounds what it blends, and the window's resolve rounds once more.
  CHECK(worst <= (samples > 0 ? 2.5 : .51), "the window with %d samples shows up to %.2f of 255 wrong", samples, worst);
}
} // namespace

int main()
{
  Near(0);
  Near(8);
  Axes();
  Inside(false);
  Inside(true);
  AroundIt();
  Coarse();
  return Failures == 0 ? 0 : 1;
}
