// SPDX-License-Identifier: BSD-3-Clause
// The setters that name one choice each do what the choice by number does, and every number out of its range becomes the nearest within it.
#include "mapper_testing.h"

#include <limits>

namespace {
using Mapper = vtkStratusVolumeMapper;

void Structures()
{
  Scene scene(64, 48);
  const std::pair<void (Mapper::*)(), const char*> choices[] = { { &Mapper::SetStructureToNone, "none" },
    { &Mapper::SetStructureToBlock, "block" }, { &Mapper::SetStructureToDistance, "distance" }, { &Mapper::SetStructureToOctant, "octant" },
    { &Mapper::SetStructureToHybrid, "hybrid" } };
  for (const auto& choice : choices) {
    (scene.Mapper->*choice.first)();
    scene.Render();
    CHECK(std::string(scene.Mapper->GetStructureUsedAsString()) == choice.second, "%s: %s is used", choice.second,
      scene.Mapper->GetStructureUsedAsString());
    CHECK((scene.Mapper->GetSamplesSkipped() > 0) == (choice.second != std::string("none")), "%s: %llu samples skipped", choice.second,
      static_cast<unsigned long long>(scene.Mapper->GetSamplesSkipped()));
  }
  scene.Mapper->SetStructureToAuto();
  CHECK(std::string(scene.Mapper->GetStructureAsString()) == "auto", "%s is no auto", scene.Mapper->GetStructureAsString());
}

void Samplings()
{
  Scene scene(64, 48);
  scene.Mapper->SetSampleDistance(1.0);
  scene.Mapper->SetSamplingToPreintegrated();
  const std::vector<float> integrated = scene.Picture();
  const std::string name = scene.Mapper->GetSamplingUsedAsString();
  scene.Mapper->SetSamplingToMidpoint();
  const std::vector<float> middle = scene.Picture();
  CHECK(middle != integrated && name != scene.Mapper->GetSamplingUsedAsString(), "both are sampled %s", name.c_str());
  scene.Mapper->SetSampling(Mapper::PREINTEGRATED_SAMPLING);
  CHECK(scene.Picture() == integrated, "pre-integration by its number is another");
  scene.Mapper->SetSamplingToCells();
  scene.Mapper->SetCellError(1e-3);
  const std::vector<float> cells = scene.Picture();
  CHECK(std::string(scene.Mapper->GetSamplingUsedAsString()) == "cells" && std::string(scene.Mapper->GetSamplingAsString()) == "cells",
    "cells are sampled %s", scene.Mapper->GetSamplingUsedAsString());
  CHECK(cells != middle && cells != integrated, "cells are as another rule");
  scene.Mapper->SetCellError(0.5);
  CHECK(scene.Picture() != cells, "the error of cells changes nothing");
  scene.Mapper->SetCellError(1e-3);
  scene.Volume->GetProperty()->ShadeOn();
  scene.Mapper->SetLightSpread(1e-4);
  const std::vector<float> lit = scene.Picture();
  scene.Mapper->SetLightSpread(10.0);
  CHECK(lit != cells && scene.Picture() != lit, "the spread of light changes nothing");
  scene.Mapper->SetLightSpread(-1.0); // as 0: by the tolerance
  CHECK(scene.Picture() != lit && scene.Errors->Count == 0, "a negative spread: %s", scene.Errors->Text.c_str());
  scene.Volume->GetProperty()->ShadeOff();
  scene.Mapper->SetCellError(-1.0); // as 0: by the tolerance
  scene.Render();
  CHECK(scene.Errors->Count == 0 && scene.Mapper->GetExpectedError() <= scene.Mapper->GetImageErrorTolerance(), "expected error %g: %s",
    scene.Mapper->GetExpectedError(), scene.Errors->Text.c_str());
  scene.Mapper->SetSamplingToAuto(); // a step of 1 keeps the tolerance by no rule that has steps in a band narrower than the data's own
  scene.Opacity->RemoveAllPoints();
  for (double x : { 0.0, 0.498, 0.5, 0.502, 1.0 }) {
    scene.Opacity->AddPoint(x, x == 0.5 ? 0.9 : 0.0);
  }
  scene.Render();
  CHECK(std::string(scene.Mapper->GetSamplingUsedAsString()) == "cells", "a narrow band is sampled %s: %s",
    scene.Mapper->GetSamplingUsedAsString(), scene.Mapper->GetReason());
}

// Settings that the rule "cells" cannot draw are refused by name. Another rule draws them at once.
void CellsRefused()
{
  for (bool mask : { false, true }) {
    Scene scene(64, 48);
    vtkNew<vtkImageData> bytes;
    bytes->CopyStructure(scene.Image);
    bytes->AllocateScalars(VTK_UNSIGNED_CHAR, 1);
    bytes->GetPointData()->GetScalars()->Fill(1);
    scene.Mapper->SetMaskInput(mask ? bytes.Get() : nullptr);
    vtkNew<vtkPiecewiseFunction> steep;
    steep->AddPoint(0.0, 1.0);
    steep->AddPoint(1.0, 0.5);
    scene.Volume->GetProperty()->SetDisableGradientOpacity(mask);
    scene.Volume->GetProperty()->SetGradientOpacity(steep);
    scene.Mapper->SetSamplingToCells();
    scene.Render();
    CHECK(scene.Errors->Count == 1 && scene.Errors->Has("sampling by cells") && scene.Errors->Has(mask ? "mask" : "gradient opacity"), "%s",
      scene.Errors->Text.c_str());
    scene.Mapper->SetSamplingToAuto();
    CHECK(scene.Light() > 0.0 && *scene.Mapper->GetLastError() == '\0', "then %s", scene.Mapper->GetLastError());
  }
}

void RenderModesAndNormals()
{
  Scene scene(64, 48);
  vtkVolumeProperty* property = scene.Volume->GetProperty();
  const std::vector<float> light = scene.Picture();
  scene.Mapper->SetRenderMode(Mapper::FIRST_HIT_MODE);
  property->ShadeOn();
  const std::vector<float> faces = scene.Picture();
  CHECK(faces != light, "first hits are as light");
  scene.Mapper->SetNormals(Mapper::GRADIENT_NORMALS);
  const std::vector<float> slopes = scene.Picture();
  CHECK(slopes != faces, "gradients are as faces");
  scene.Mapper->SetNormalsToFaces();
  CHECK(scene.Picture() == faces, "SetNormalsToFaces does not");
  scene.Mapper->SetNormalsToGradient();
  CHECK(scene.Picture() == slopes, "SetNormalsToGradient does not");
  scene.Mapper->SetNormals(-1);
  CHECK(scene.Mapper->GetNormals() == Mapper::FACE_NORMALS, "normals %d", scene.Mapper->GetNormals());
  scene.Mapper->SetNormals(9);
  CHECK(scene.Mapper->GetNormals() == Mapper::GRADIENT_NORMALS, "normals %d", scene.Mapper->GetNormals());
  scene.Mapper->SetRenderMode(9);
  CHECK(scene.Mapper->GetRenderMode() == Mapper::PATH_MODE, "mode %d", scene.Mapper->GetRenderMode());
  scene.Mapper->SetRenderMode(-9);
  property->ShadeOff();
  CHECK(scene.Mapper->GetRenderMode() == Mapper::COMPOSITE_MODE && scene.Picture() == light, "mode %d", scene.Mapper->GetRenderMode());
}

// Each switch is on after 1 and after 7, off after 0 and -7, and its effect is seen.
void Switches()
{
  Scene scene(64, 48);
  const auto samples = [&] { return scene.Mapper->GetLastImage()->GetPointData()->GetArray("Samples") != nullptr; };
  scene.Mapper->SetSamplingToMidpoint(); // an automatic rule may be cells, which have no samples that jitter moves
  scene.Mapper->SetSampleDistance(1.5);
  const std::vector<float> plain = scene.Picture();
  for (int value : { 1, 0, 7, -7 }) {
    const int meant = value > 0;
    scene.Mapper->SetAudit(value);
    scene.Mapper->SetCountSamples(value);
    scene.Mapper->SetUseJittering(value);
    scene.Mapper->SetAutoAdjustSampleDistances(value);
    CHECK(scene.Mapper->GetAudit() == meant && scene.Mapper->GetCountSamples() == meant && scene.Mapper->GetUseJittering() == meant &&
        scene.Mapper->GetAutoAdjustSampleDistances() == meant,
      "%d switches wrongly", value);
    scene.Window->SetDesiredUpdateRate(1e6);
    scene.Render();
    CHECK((scene.Mapper->GetUsedImageSampleDistance() > 1.0) == (meant == 1), "%d: %g pixels a ray", value,
      scene.Mapper->GetUsedImageSampleDistance());
    CHECK(samples() == (meant == 1), "%d: samples of pixels", value);
    scene.Window->SetDesiredUpdateRate(0.0001);
    CHECK((scene.Picture() != plain) == (meant == 1), "%d: jitter", value);
  }
  // An audit shows in nothing but its count, which is 0 as long as all is well, and in its time.
  scene.Mapper->SetStructureToDistance();
  scene.Mapper->AuditOn();
  scene.Render();
  CHECK(scene.Mapper->GetAudit() == 1 && scene.Mapper->GetDifferingPixels() == 0, "the audit finds pixels");
  scene.Mapper->AuditOff();
  CHECK(scene.Mapper->GetAudit() == 0 && scene.Picture() == plain, "AuditOff changes the picture");
}

void Masks()
{
  Scene scene(64, 48);
  vtkNew<vtkImageData> mask;
  mask->CopyStructure(scene.Image);
  mask->AllocateScalars(VTK_UNSIGNED_CHAR, 1);
  mask->GetPointData()->GetScalars()->Fill(0);
  const std::vector<float> whole = scene.Picture();
  scene.Mapper->SetMaskInput(mask);
  scene.Mapper->SetMaskType(Mapper::LabelMapMaskType);
  CHECK(scene.Picture() == whole, "a map of label 0 hides something");
  scene.Mapper->SetMaskType(Mapper::BinaryMaskType);
  CHECK(scene.Light() == 0.0, "a mask of 0 hides nothing");
  scene.Mapper->SetMaskType(5);
  CHECK(scene.Mapper->GetMaskType() == Mapper::LabelMapMaskType, "mask type %d", scene.Mapper->GetMaskType());
  scene.Mapper->SetMaskType(-5);
  CHECK(scene.Mapper->GetMaskType() == Mapper::BinaryMaskType, "mask type %d", scene.Mapper->GetMaskType());
}

void Ranges()
{
  const double most = std::numeric_limits<double>::max();
  vtkNew<Mapper> mapper;
  struct Range {
    const char* Name;
    void (Mapper::*Set)(double);
    double (Mapper::*Get)();
    double Lowest, Highest;
  };
  const Range ranges[] = { { "InteractiveUpdateRate", &Mapper::SetInteractiveUpdateRate, &Mapper::GetInteractiveUpdateRate, 1e-10, 1e10 },
    { "ImageSampleDistance", &Mapper::SetImageSampleDistance, &Mapper::GetImageSampleDistance, 1, 100 },
    { "MaximumImageSampleDistance", &Mapper::SetMaximumImageSampleDistance, &Mapper::GetMaximumImageSampleDistance, 1, 100 },
    { "MaximumSampleDistanceFactor", &Mapper::SetMaximumSampleDistanceFactor, &Mapper::GetMaximumSampleDistanceFactor, 1, 100 },
    { "Termination", &Mapper::SetTermination, &Mapper::GetTermination, 0, 1 } };
  for (const Range& range : ranges) {
    (mapper->*range.Set)(-most);
    CHECK((mapper->*range.Get)() == range.Lowest, "%s: %g", range.Name, (mapper->*range.Get)());
    (mapper->*range.Set)(most);
    CHECK((mapper->*range.Get)() == range.Highest, "%s: %g", range.Name, (mapper->*range.Get)());
  }
  for (int value : { -1, 1000000 }) {
    mapper->SetNumberOfThreads(value);
    mapper->SetStructure(value);
    mapper->SetSampling(value);
    CHECK(mapper->GetNumberOfThreads() == (value < 0 ? 0 : 1024), "%d threads", mapper->GetNumberOfThreads());
    CHECK(
      mapper->GetStructure() == (value < 0 ? Mapper::AUTO_STRUCTURE : Mapper::HYBRID_STRUCTURE), "structure %d", mapper->GetStructure());
    CHECK(mapper->GetSampling() == (value < 0 ? Mapper::AUTO_SAMPLING : Mapper::CELLS_SAMPLING), "sampling %d", mapper->GetSampling());
  }
}

// A tolerance that is none is refused by name, value and range, and the last one stays. Where sampling, step and termination are set by
// hand the tolerance changes nothing; where they are not, a looser one takes fewer samples.
void Tolerances()
{
  Scene scene(80, 60);
  Mapper* mapper = scene.Mapper;
  CHECK(mapper->GetImageErrorTolerance() == 0.001 && mapper->GetTermination() == 0.0, "defaults %g and %g",
    mapper->GetImageErrorTolerance(), mapper->GetTermination());
  mapper->SetImageErrorTolerance(0.02);
  const vtkMTimeType before = mapper->GetMTime();
  const double none[] = { -0.5, std::nan(""), std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity() };
  for (double tolerance : none) {
    const int count = scene.Errors->Count;
    mapper->SetImageErrorTolerance(tolerance);
    CHECK(scene.Errors->Count == count + 1 && scene.Errors->Has("ImageErrorTolerance") && scene.Errors->Has("at least 0"), "%g: %s",
      tolerance, scene.Errors->Text.c_str());
    CHECK(scene.Errors->Has(tolerance == -0.5 ? "-0.5"
              : std::isnan(tolerance)         ? "nan"
                                              : "inf"),
      "%g: %s", tolerance, scene.Errors->Text.c_str());
    CHECK(mapper->GetImageErrorTolerance() == 0.02 && mapper->GetMTime() == before, "the last tolerance does not stay");
  }
  mapper->SetImageErrorTolerance(0.02);
  CHECK(mapper->GetMTime() == before, "the same tolerance is a modification");
  mapper->CountSamplesOn();
  vtkTypeUInt64 samples = 0;
  for (double tolerance : { 0.1, 0.001, 0.0 }) {
    mapper->SetImageErrorTolerance(tolerance);
    scene.Render();
    CHECK(scene.Mapper->GetSamplesTaken() >= samples, "tolerance %g takes fewer samples than a looser one", tolerance);
    samples = scene.Mapper->GetSamplesTaken();
  }
  mapper->SetSamplingToMidpoint();
  mapper->SetSampleDistance(0.05);
  mapper->SetTermination(0.99);
  const std::vector<float> fine = scene.Picture();
  mapper->SetImageErrorTolerance(0.1);
  CHECK(scene.Picture() == fine, "a tolerance changes a picture whose settings are set by hand");
}
} // namespace

int main()
{
  Tolerances();
  Structures();
  Samplings();
  CellsRefused();
  RenderModesAndNormals();
  Switches();
  Masks();
  Ranges();
  return Failures == 0 ? 0 : 1;
}
