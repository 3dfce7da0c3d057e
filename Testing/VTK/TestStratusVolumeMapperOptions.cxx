// SPDX-License-Identifier: BSD-3-Clause
// Every setter does what it says, in pixels or in counts; and no choice of structure, block size or threads changes the picture.
#include "mapper_testing.h"

#include <limits>
#include <sstream>

namespace {
void Structures()
{
  Scene scene;
  scene.Mapper->AuditOn();
  scene.Mapper->SetStructureToNone();
  const std::vector<float> plain = scene.Picture();
  const vtkTypeUInt64 all = scene.Mapper->GetSamplesTaken();
  CHECK(scene.Mapper->GetSamplesSkipped() == 0, "no structure, and samples skipped");
  const std::pair<int, const char*> structures[] = { { vtkStratusVolumeMapper::BLOCK_STRUCTURE, "block" },
    { vtkStratusVolumeMapper::DISTANCE_STRUCTURE, "distance" }, { vtkStratusVolumeMapper::OCTANT_STRUCTURE, "octant" },
    { vtkStratusVolumeMapper::HYBRID_STRUCTURE, "hybrid" } };
  for (const auto& structure : structures) {
    scene.Mapper->SetStructure(structure.first);
    CHECK(scene.Picture() == plain, "structure %s changes the picture", structure.second);
    CHECK(scene.Mapper->GetDifferingPixels() == 0, "structure %s: the audit finds differing pixels", structure.second);
    CHECK(scene.Mapper->GetSamplesTaken() < all && scene.Mapper->GetSamplesSkipped() > 0, "structure %s skips nothing", structure.second);
    CHECK(std::string(scene.Mapper->GetStructureUsedAsString()) == structure.second, "%s instead of %s",
      scene.Mapper->GetStructureUsedAsString(), structure.second);
    CHECK(scene.Mapper->GetStructureBytes() > 0, "%s takes no memory", structure.second);
  }
  scene.Mapper->SetStructureToAuto();
  CHECK(scene.Picture() == plain, "the automatic structure changes the picture");
  CHECK(*scene.Mapper->GetReason(), "there is no reason");
  for (int size : { 2, 8, 16, 32 }) {
    const vtkTypeUInt64 blocks = scene.Mapper->GetBlocks();
    scene.Mapper->SetBlockSize(size);
    CHECK(scene.Picture() == plain, "block size %d changes the picture", size);
    CHECK(scene.Mapper->GetBlocks() != blocks, "block size %d changes no block", size);
  }
  for (int threads : { 1, 2, 3 }) {
    scene.Mapper->SetNumberOfThreads(threads);
    CHECK(scene.Picture() == plain, "%d threads change the picture", threads);
  }
  CHECK(scene.Mapper->GetOccupiedBlocks() <= scene.Mapper->GetBlocks(), "more blocks occupied than there are");
}

void Sampling()
{
  Scene scene;
  scene.Mapper->CountSamplesOn(); // so that no time chooses the structure, on which counts hang
  scene.Mapper->SetSamplingToMidpoint();
  scene.Mapper->SetSampleDistance(1.0);
  const std::vector<float> middle = scene.Picture();
  const vtkTypeUInt64 samples = scene.Mapper->GetSamplesTaken();
  CHECK(scene.Mapper->GetUsedSampleDistance() == 1.0, "used %g", scene.Mapper->GetUsedSampleDistance());
  scene.Mapper->SetSampleDistance(0.5);
  CHECK(scene.Picture() != middle, "the sample distance changes nothing");
  const double ratio = static_cast<double>(scene.Mapper->GetSamplesTaken()) / static_cast<double>(samples);
  CHECK(ratio > 1.8 && ratio < 2.2, "half the distance takes %.2f times the samples", ratio);
  scene.Mapper->SetSampleDistance(-1);
  scene.Render();
  CHECK(scene.Mapper->GetUsedSampleDistance() > 0.1 && scene.Mapper->GetUsedSampleDistance() < 10.0, "automatic distance %g",
    scene.Mapper->GetUsedSampleDistance());
  scene.Mapper->SetSampleDistance(1.0);
  scene.Mapper->SetSamplingToPreintegrated();
  CHECK(scene.Picture() != middle, "pre-integration changes nothing");
  CHECK(std::string(scene.Mapper->GetSamplingUsedAsString()) == scene.Mapper->GetSamplingAsString(), "%s",
    scene.Mapper->GetSamplingUsedAsString());
  scene.Volume->GetProperty()->SetInterpolationTypeToNearest();
  scene.Render();
  CHECK(std::string(scene.Mapper->GetSamplingUsedAsString()) == stratus_sampling_name(STRATUS_SAMPLING_MIDPOINT),
    "nearest interpolation is sampled %s", scene.Mapper->GetSamplingUsedAsString());
}

void Termination()
{
  Scene scene;
  scene.Mapper->CountSamplesOn(); // so that no time chooses the structure, on which counts hang
  scene.Opacity->AddPoint(0.3, 0.9);
  scene.Mapper->SetTermination(1.0);
  scene.Render();
  const vtkTypeUInt64 all = scene.Mapper->GetSamplesTaken();
  scene.Mapper->SetTermination(0.5);
  scene.Render();
  CHECK(scene.Mapper->GetSamplesTaken() < all, "rays do not end early");
}

void FinalColor()
{
  Scene scene;
  scene.Mapper->SetFinalColorWindow(0.5f);
  scene.Mapper->SetFinalColorLevel(0.4f);
  scene.Render();
  const std::vector<unsigned char> bytes = scene.Bytes();
  const float* rgba = scene.Rgba();
  double worst = 0.0, lit = 0.0;
  for (size_t p = 0; p < scene.Pixels(); ++p) {
    for (size_t c = 0; c < 3; ++c) {
      // The colour c = premultiplied/alpha is shown as (c - level) / window + 1/2, times alpha.
      const double meant = (rgba[4 * p + c] - 0.4 * rgba[4 * p + 3]) / 0.5 + 0.5 * rgba[4 * p + 3];
      lit += bytes[4 * p + c];
      worst = std::max(worst, std::fabs(255.0 * std::min(1.0, std::max(0.0, meant)) - bytes[4 * p + c]));
    }
  }
  CHECK(lit > 0.0 && worst <= 1.0, "window and level differ by %.2f of 255", worst);
}

void ImageSampleDistance()
{
  Scene scene;
  scene.Mapper->CountSamplesOn(); // so that no time chooses the structure, on which counts hang
  scene.Render();
  const vtkTypeUInt64 samples = scene.Mapper->GetSamplesTaken();
  const double light = scene.Light();
  scene.Mapper->SetImageSampleDistance(2);
  const double coarse = scene.Light();
  const double ratio = static_cast<double>(scene.Mapper->GetSamplesTaken()) / static_cast<double>(samples);
  CHECK(ratio > 0.22 && ratio < 0.28, "half the rays along each axis take %.2f of the samples", ratio);
  CHECK(std::fabs(coarse / light - 1.0) < 0.02, "the coarse picture has the light of %g instead of %g", coarse, light);
  CHECK(scene.Mapper->GetUsedImageSampleDistance() == 2.0, "used %g", scene.Mapper->GetUsedImageSampleDistance());
  // The window shows the coarse picture, interpolated: it is bright where the volume is.
  double shown = 0.0;
  for (unsigned char byte : scene.Bytes()) {
    shown += byte == 255 ? 0 : byte;
  }
  CHECK(shown > 0.0, "the coarse picture is not shown");
}

// Depth is finite exactly where there is opacity, and is within the volume.
void Depth()
{
  Scene scene;
  const std::vector<float> rgba = scene.Picture(); // a copy: asking for the depth makes the image anew
  const float* depth = scene.Depth();
  const double distance = scene.Renderer->GetActiveCamera()->GetDistance();
  for (size_t p = 0; p < scene.Pixels(); ++p) {
    CHECK((rgba[4 * p + 3] > 0.0f) == std::isfinite(depth[p]), "pixel %zu: alpha %g, depth %g", p, rgba[4 * p + 3], depth[p]);
    CHECK(
      !std::isfinite(depth[p]) || std::fabs(depth[p] - distance) < 30.0, "pixel %zu: depth %g, the volume is at %g", p, depth[p], distance);
  }
}

class ProgressObserver : public vtkCommand
{
public:
  static ProgressObserver* New() { return new ProgressObserver; }
  void Execute(vtkObject*, unsigned long event, void* data) override
  {
    this->Starts += event == vtkCommand::VolumeMapperRenderStartEvent;
    this->Ends += event == vtkCommand::VolumeMapperRenderEndEvent;
    if (event == vtkCommand::VolumeMapperRenderProgressEvent) {
      ++this->Steps;
      // Do what an observer of AbortCheckEvent would do. The window calls those at most five times a second.
      this->Window->SetAbortRender(this->Aborts);
      const double fraction = *static_cast<double*>(data);
      CHECK(fraction >= 0.0 && fraction <= 1.0, "progress of %g", fraction);
    }
  }
  int Starts = 0, Steps = 0, Ends = 0, Aborts = 0;
  vtkRenderWindow* Window = nullptr;
};

void ProgressAndAbort()
{
  Scene scene;
  vtkNew<ProgressObserver> observer;
  observer->Window = scene.Window;
  scene.Mapper->AddObserver(vtkCommand::AnyEvent, observer);
  const std::vector<float> whole = scene.Picture();
  CHECK(observer->Starts == 1 && observer->Ends == 1 && observer->Steps > 0, "%d starts, %d steps, %d ends", observer->Starts,
    observer->Steps, observer->Ends);
  observer->Aborts = 1;
  scene.Render();
  CHECK(scene.Rgba() == nullptr, "an aborted picture is taken for a whole one");
  observer->Aborts = 0;
  scene.Window->SetAbortRender(0);
  CHECK(scene.Picture() == whole, "the picture after an abort is another");
  CHECK(scene.Errors->Count == 0, "an abort is reported as an error: %s", scene.Errors->Text.c_str());
}

void Printing()
{
  Scene scene;
  scene.Render();
  std::ostringstream text;
  scene.Mapper->Print(text);
  for (const char* word : { "SampleDistance", "AutoAdjustSampleDistances", "InteractiveUpdateRate", "ImageSampleDistance",
         "MaximumImageSampleDistance", "MaximumSampleDistanceFactor", "FinalColorWindow", "FinalColorLevel", "Structure", "Sampling",
         "Termination", "BlockSize", "Device: host", "NumberOfThreads", "Audit" }) {
    CHECK(text.str().find(word) != std::string::npos, "PrintSelf says nothing of %s", word);
  }
  CHECK(std::string(scene.Mapper->GetDeviceName()).find("host") != std::string::npos, "device %s", scene.Mapper->GetDeviceName());
}
} // namespace

int main()
{
  Structures();
  Sampling();
  Termination();
  FinalColor();
  ImageSampleDistance();
  Depth();
  ProgressAndAbort();
  Printing();
  return Failures == 0 ? 0 : 1;
}
