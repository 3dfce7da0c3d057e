// SPDX-License-Identifier: BSD-3-Clause
// Samples a pixel: their sum equals the report's count, they follow structure and coarseness, and counting changes no pixel.
#include "mapper_testing.h"

#include "vtkCullerCollection.h"
#include "vtkTypeUInt32Array.h"

namespace {
// Of the last picture, or nullptr.
vtkTypeUInt32Array* SamplesOf(Scene& scene)
{
  return vtkTypeUInt32Array::SafeDownCast(scene.Mapper->GetLastImage()->GetPointData()->GetArray("Samples"));
}

vtkTypeUInt64 Sum(vtkTypeUInt32Array* samples)
{
  vtkTypeUInt64 sum = 0;
  for (vtkIdType pixel = 0; samples && pixel < samples->GetNumberOfValues(); ++pixel) {
    sum += samples->GetValue(pixel);
  }
  return sum;
}

void CountsWhatTheReportCounts()
{
  Scene scene;
  const std::vector<float> plain = scene.Picture();
  CHECK(!SamplesOf(scene), "counted without being asked");
  scene.Mapper->CountSamplesOn();
  CHECK(!SamplesOf(scene), "samples of a picture that was drawn without them");
  for (int structure = vtkStratusVolumeMapper::NO_STRUCTURE; structure <= vtkStratusVolumeMapper::HYBRID_STRUCTURE; ++structure) {
    scene.Mapper->SetStructure(structure);
    CHECK(scene.Picture() == plain, "structure %d: counting changes the picture", structure);
    vtkTypeUInt32Array* samples = SamplesOf(scene);
    CHECK(samples && samples->GetNumberOfValues() * 4 == static_cast<vtkIdType>(plain.size()), "structure %d: a count a pixel", structure);
    CHECK(Sum(samples) == scene.Mapper->GetSamplesTaken() && Sum(samples) > 0, "structure %d: %llu in the pixels, %llu in the report",
      structure, static_cast<unsigned long long>(Sum(samples)), static_cast<unsigned long long>(scene.Mapper->GetSamplesTaken()));
    int unseen = 0; // no sample, and yet something in the pixel
    for (vtkIdType pixel = 0; samples && pixel < samples->GetNumberOfValues(); ++pixel) {
      unseen += samples->GetValue(pixel) == 0 && plain[4 * static_cast<size_t>(pixel) + 3] != 0.0f ? 1 : 0;
    }
    CHECK(unseen == 0, "structure %d: %d pixels show what was never sampled", structure, unseen);
  }
  scene.Mapper->CountSamplesOff();
  CHECK(SamplesOf(scene), "the picture was drawn with samples, whatever the next one counts");
  scene.Render();
  CHECK(!SamplesOf(scene), "counted after it was switched off");
}

// Nothing of the volume in sight: there are no samples, and the array says so.
void CountsNone()
{
  Scene scene;
  scene.Mapper->CountSamplesOn();
  scene.Renderer->GetCullers()->RemoveAllItems(); // or VTK would not ask the mapper at all
  scene.Renderer->GetActiveCamera()->Yaw(170);
  scene.Renderer->ResetCameraClippingRange();
  scene.Render();
  vtkTypeUInt32Array* samples = SamplesOf(scene);
  CHECK(samples && samples->GetNumberOfValues() > 0 && Sum(samples) == 0, "looking away counts %llu",
    static_cast<unsigned long long>(Sum(samples)));
}

void CountsFirstHits()
{
  Scene scene;
  scene.Mapper->CountSamplesOn();
  scene.Mapper->SetRenderModeToFirstHit();
  scene.Render();
  vtkTypeUInt32Array* samples = SamplesOf(scene);
  CHECK(samples && samples->GetRange()[1] == 1.0, "more than one hit a pixel");
  CHECK(Sum(samples) == scene.Mapper->GetSamplesTaken() && Sum(samples) > 0, "hits: %llu", static_cast<unsigned long long>(Sum(samples)));
}
} // namespace

int main(int, char**)
{
  CountsWhatTheReportCounts();
  CountsNone();
  CountsFirstHits();
  return Failures == 0 ? 0 : 1;
}
