// SPDX-License-Identifier: BSD-3-Clause
// Opacity of exactly 1 is opaque, however short the ray's path is compared with the unit distance: a slab in which only one value has
// opacity 1, and labels in metres next to equal labels in voxels.
#include "mapper_testing.h"

namespace {
constexpr int Side = 24;

// A volume of `Side` values an axis, `spacing` apart, seen along z by a parallel camera that scales with it. The unit distance is 1.
struct Cube : Scene {
  explicit Cube(double spacing) : Scene(48, 48)
  {
    this->Image->SetDimensions(Side, Side, Side);
    this->Image->SetSpacing(spacing, spacing, spacing);
    this->Opacity->RemoveAllPoints();
    this->Opacity->AllowDuplicateScalarsOn();
    this->Color->RemoveAllPoints();
    this->Volume->GetProperty()->SetScalarOpacityUnitDistance(1.0);
  }

  template <typename Value> void Fill(int type, Value&& value)
  {
    this->Image->AllocateScalars(type, 1);
    for (int k = 0; k < Side; ++k) {
      for (int j = 0; j < Side; ++j) {
        for (int i = 0; i < Side; ++i) {
          this->Image->SetScalarComponentFromDouble(i, j, k, 0, value(i, j, k));
        }
      }
    }
    this->Image->Modified();
  }

  void LookAlongZ(double spacing)
  {
    vtkCamera* camera = this->Renderer->GetActiveCamera();
    const double middle = 0.5 * (Side - 1) * spacing;
    camera->ParallelProjectionOn();
    camera->SetPosition(middle, middle, 4.0 * Side * spacing);
    camera->SetFocalPoint(middle, middle, middle);
    camera->SetViewUp(0, 1, 0);
    camera->SetParallelScale(0.55 * Side * spacing);
    camera->SetClippingRange(2.0 * Side * spacing, 6.0 * Side * spacing);
  }
};

using Set = void (vtkStratusVolumeMapper::*)();
const std::pair<const char*, Set> Samplings[] = { { "automatic", &vtkStratusVolumeMapper::SetSamplingToAuto },
  { "midpoint", &vtkStratusVolumeMapper::SetSamplingToMidpoint }, { "pre-integrated", &vtkStratusVolumeMapper::SetSamplingToPreintegrated },
  { "cells", &vtkStratusVolumeMapper::SetSamplingToCells } };
const double Spacings[] = { 1.0, 0.001, 1e-6 };

// Only value 1 has opacity 1: the end of a ramp, a peak, and an end held beyond.
void ASlab()
{
  for (int type : { VTK_FLOAT, VTK_UNSIGNED_CHAR }) {
    for (double spacing : Spacings) {
      for (const auto& sampling : Samplings) {
        for (int function = 0; function < 3; ++function) {
          Cube scene(spacing);
          scene.Fill(type, [&](int, int, int k) { return k >= 8 && k < 16 ? 1.0 : k == 0 && function > 0 ? 2.0 : 0.0; });
          scene.Opacity->AddPoint(0, 0);
          scene.Opacity->AddPoint(1, 1);
          if (function > 0) {
            scene.Opacity->AddPoint(2, function == 1 ? 0 : 1);
          }
          scene.Color->AddRGBPoint(0, 1, 1, 1);
          ((*scene.Mapper).*sampling.second)();
          scene.LookAlongZ(spacing);
          scene.Render();
          CHECK(scene.Errors->Count == 0, "%s", scene.Errors->Text.c_str());
          const float* picture = scene.Rgba();
          if (!picture) {
            continue;
          }
          const float* pixel = picture + 4 * (24 * 48 + 24);
          const std::vector<unsigned char> bytes = scene.Bytes();
          CHECK(pixel[3] >= 0.999f && bytes[4 * (24 * 48 + 24)] == 255, "%s, spacing %g, function %d, type %d: opacity %g, %d of 255",
            sampling.first, spacing, function, type, pixel[3], bytes[4 * (24 * 48 + 24)]);
        }
      }
    }
  }
}

// Labels look in metres, and in micrometres, as they do in voxels. They are shown by windows of width 1 between vertical steps, or by peaks
// at the label. Between a peak's foot and its top light depends on the length, so that peaks are compared within the label only.
void Labels(bool peaks, bool nearest, int sampling)
{
  std::vector<float> voxels;
  for (double spacing : Spacings) {
    Cube scene(spacing);
    scene.Fill(VTK_UNSIGNED_CHAR, [](int i, int j, int k) {
      const bool within = i >= 3 && i < 21 && j >= 3 && j < 21 && k >= 3 && k < 21;
      return within ? (i < 12 ? 3.0 : j < 12 ? 5.0 : 9.0) : 0.0;
    });
    for (int label : { 3, 5 }) {
      scene.Opacity->AddPoint(label - 0.5, 0);
      scene.Opacity->AddPoint(peaks ? label : label - 0.5, 1);
      if (!peaks) {
        scene.Opacity->AddPoint(label + 0.5, 1);
      }
      scene.Opacity->AddPoint(label + 0.5, 0);
    }
    scene.Color->AddRGBPoint(3, 1, 0.5, 0);
    scene.Color->AddRGBPoint(5, 0, 0.5, 1);
    if (nearest) {
      scene.Volume->GetProperty()->SetInterpolationTypeToNearest();
    }
    ((*scene.Mapper).*Samplings[sampling].second)();
    // The same lattice in each unit: windows are narrower than a step where values rise from 0 to 9.
    scene.Mapper->SetSampleDistance(0.25 * spacing);
    scene.LookAlongZ(spacing);
    scene.Render();
    CHECK(scene.Errors->Count == 0, "%s", scene.Errors->Text.c_str());
    const float* picture = scene.Rgba();
    if (!picture) {
      continue;
    }
    const std::vector<float> rgba(picture, picture + 4 * scene.Pixels());
    const std::string what = std::string(Samplings[sampling].first) + (nearest ? ", nearest" : "") + (peaks ? ", peaks" : "");
    const float* label3 = &rgba[4 * (24 * 48 + 16)];
    CHECK(label3[3] >= 0.999f && label3[0] > 0.99f, "%s, spacing %g: label 3 has opacity %g and red %g", what.c_str(), spacing, label3[3],
      label3[0]);
    voxels = voxels.empty() || peaks ? rgba : voxels;
    double sum = 0.0;
    for (size_t n = 0; n < rgba.size(); ++n) {
      sum += std::pow(rgba[n] - voxels[n], 2.0);
    }
    // Places are rounded where windows begin and end: some pixels along the labels' edges.
    const double error = std::sqrt(sum / static_cast<double>(rgba.size()));
    CHECK(error <= 0.02, "%s: spacing %g differs from voxels by %g", what.c_str(), spacing, error);
  }
}
} // namespace

int main()
{
  ASlab();
  for (int n = 0; n < 16; ++n) {
    Labels((n & 1) != 0, (n & 2) != 0, n / 4);
  }
  return Failures == 0 ? 0 : 1;
}
