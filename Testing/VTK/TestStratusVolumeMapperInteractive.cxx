// SPDX-License-Identifier: BSD-3-Clause
// While the window wants a frame rate the picture may be coarser; a still picture is exact. The allotted time is set, not measured, so that
// no check depends on the machine's speed.
#include "mapper_testing.h"

#include "vtkCullerCollection.h"

int main()
{
  Scene scene(300, 200);
  // Without cullers the renderer allots the window's time as it is: 1/rate seconds to the one volume.
  scene.Renderer->GetCullers()->RemoveAllItems();
  scene.Window->SetDesiredUpdateRate(0.0001);
  const std::vector<float> exact = scene.Picture();
  const double exactStep = scene.Mapper->GetUsedSampleDistance();
  CHECK(scene.Mapper->GetUsedImageSampleDistance() == 1.0, "the still picture is coarse");

  scene.Window->SetDesiredUpdateRate(1e6); // a microsecond: as coarse as it may get
  const std::vector<float> coarse = scene.Picture();
  CHECK(scene.Mapper->GetUsedImageSampleDistance() == scene.Mapper->GetMaximumImageSampleDistance(), "%g pixels a ray",
    scene.Mapper->GetUsedImageSampleDistance());
  CHECK(std::fabs(scene.Mapper->GetUsedSampleDistance() - 2.0 * exactStep) < 1e-9 * exactStep, "step of %g instead of %g",
    scene.Mapper->GetUsedSampleDistance(), 2.0 * exactStep);
  CHECK(coarse != exact, "no coarser under a high rate");

  scene.Mapper->SetMaximumImageSampleDistance(3);
  scene.Mapper->SetMaximumSampleDistanceFactor(1);
  scene.Render();
  CHECK(scene.Mapper->GetUsedImageSampleDistance() == 3.0, "%g pixels a ray", scene.Mapper->GetUsedImageSampleDistance());
  CHECK(scene.Mapper->GetUsedSampleDistance() == exactStep, "longer steps than allowed");

  scene.Mapper->SetInteractiveUpdateRate(1e7);
  CHECK(scene.Picture() == exact, "coarse below the interactive rate");
  scene.Mapper->SetInteractiveUpdateRate(1.0);
  scene.Mapper->AutoAdjustSampleDistancesOff();
  CHECK(scene.Picture() == exact, "coarse though adjustment is off");
  scene.Mapper->AutoAdjustSampleDistancesOn();
  scene.Render();
  CHECK(scene.Mapper->GetUsedImageSampleDistance() > 1.0, "no coarser again");

  scene.Window->SetDesiredUpdateRate(0.0001);
  CHECK(scene.Picture() == exact, "the still picture after moving is not the exact one");
  CHECK(
    scene.Mapper->GetRangeBuilds() == 1, "value ranges built %llu times", static_cast<unsigned long long>(scene.Mapper->GetRangeBuilds()));

  scene.Window->SetDesiredUpdateRate(1.0); // a second is plenty: exact at an interactive rate too
  CHECK(scene.Picture() == exact, "coarser than the allotted time requires");
  CHECK(scene.Errors->Count == 0, "%s", scene.Errors->Text.c_str());
  return Failures == 0 ? 0 : 1;
}
