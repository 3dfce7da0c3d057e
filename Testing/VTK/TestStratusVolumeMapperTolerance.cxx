// SPDX-License-Identifier: BSD-3-Clause
// The tolerance through the mapper: functions, data and settings are probed, cameras are not; the probe's error keeps the tolerance; looser
// tolerances cost less; settings made by hand need no tolerance.
#include "mapper_testing.h"

namespace {
using Mapper = vtkStratusVolumeMapper;

// The scene's probes so far must be as many.
#define CHECK_PROBES(scene, count, what)                                                                                                   \
  CHECK((scene).Mapper->GetProbeBuilds() == (count), "%s: %llu probes, %s", what,                                                          \
    static_cast<unsigned long long>((scene).Mapper->GetProbeBuilds()), (scene).Mapper->GetReason())

void WhatIsProbed()
{
  Scene scene(64, 48);
  Mapper* mapper = scene.Mapper;
  scene.Render();
  CHECK_PROBES(scene, 1u, "a first picture");
  CHECK(mapper->GetProbeSamples() > 0 && mapper->GetProbeTime() > 0.0, "a probe without samples or time");
  const std::string sampling = mapper->GetSamplingUsedAsString();
  const double step = mapper->GetUsedSampleDistance(), expected = mapper->GetExpectedError();
  for (double azimuth : { 80.0, 170.0, 260.0 }) {
    scene.Look(azimuth, -30);
    scene.Render();
    CHECK(mapper->GetProbeSamples() == 0 && mapper->GetProbeTime() == 0.0, "a camera's turn is probed");
    CHECK(
      sampling == mapper->GetSamplingUsedAsString() && step == mapper->GetUsedSampleDistance() && expected == mapper->GetExpectedError(),
      "a camera's turn changes the sampling to %s", mapper->GetReason());
  }
  mapper->CroppingOn();
  mapper->SetCroppingRegionPlanes(4, 20, 4, 20, 4, 20);
  scene.Render();
  mapper->CroppingOff();
  CHECK_PROBES(scene, 1u, "cameras and a crop");

  scene.Opacity->AddPoint(0.7, 0.9);
  scene.Render();
  CHECK_PROBES(scene, 2u, "an edit of the opacity");
  scene.Color->AddRGBPoint(0.7, 0.0, 0.0, 0.0);
  scene.Render();
  CHECK_PROBES(scene, 3u, "an edit of the colour");
  scene.Color->Modified();
  scene.Volume->GetProperty()->Modified();
  scene.Render();
  CHECK_PROBES(scene, 3u, "an edit that changes nothing");
  FillField(scene.Image, false, "density", 0.8);
  scene.Image->Modified();
  scene.Render();
  CHECK_PROBES(scene, 4u, "new data");
  mapper->SetImageErrorTolerance(0.01);
  scene.Render();
  CHECK_PROBES(scene, 5u, "another tolerance");
  scene.Volume->GetProperty()->ShadeOn();
  scene.Render();
  CHECK_PROBES(scene, 6u, "light");
  CHECK(scene.Errors->Count == 0, "%s", scene.Errors->Text.c_str());
}

// A narrow band and a smooth function: the expected error keeps the tolerance, and so does the picture compared with the finest one.
void Ladder()
{
  for (bool narrow : { false, true }) {
    Scene scene(96, 72);
    Mapper* mapper = scene.Mapper;
    if (narrow) {
      scene.Opacity->RemoveAllPoints();
      for (double x : { 0.0, 0.45, 0.5, 0.55, 1.0 }) {
        scene.Opacity->AddPoint(x, x == 0.5 ? 0.5 : 0.0);
      }
    }
    mapper->SetImageErrorTolerance(0.0);
    const std::vector<float> finest = scene.Picture();
    CHECK(std::isnan(mapper->GetExpectedError()), "the finest setting expects %g", mapper->GetExpectedError());
    std::vector<float> last;
    for (double tolerance : { 0.05, 0.001 }) {
      mapper->SetImageErrorTolerance(tolerance);
      const std::vector<float> picture = scene.Picture();
      double squares = 0.0, lit = 0.0;
      for (size_t p = 0; p < scene.Pixels(); ++p) {
        for (size_t c = 0; c < 4; ++c) {
          const double difference = static_cast<double>(picture[4 * p + c]) - static_cast<double>(finest[4 * p + c]);
          squares += difference * difference;
        }
        lit += picture[4 * p + 3] > 0.0f || finest[4 * p + 3] > 0.0f ? 4.0 : 0.0;
      }
      const double error = std::sqrt(squares / lit);
      CHECK(mapper->GetToleranceMet() && mapper->GetExpectedError() <= tolerance, "%g expected at %g: %s", mapper->GetExpectedError(),
        tolerance, mapper->GetReason());
      CHECK(error <= tolerance, "the picture errs by %g at %g: %s", error, tolerance, mapper->GetReason());
      CHECK(picture != last, "tolerances .05 and .001 have one picture: %s", mapper->GetReason());
      last = picture;
    }
  }
}

// Rule and step set by hand leave nothing to measure; if only one is set, the other is probed.
void ByHand()
{
  Scene scene(64, 48);
  Mapper* mapper = scene.Mapper;
  mapper->SetSamplingToPreintegrated();
  mapper->SetSampleDistance(0.5);
  scene.Render();
  CHECK_PROBES(scene, 0u, "rule and step by hand");
  CHECK(std::isnan(mapper->GetExpectedError()) && mapper->GetToleranceMet(), "%g expected without a probe", mapper->GetExpectedError());
  mapper->SetSamplingToCells();
  mapper->SetCellError(0.01);
  scene.Render();
  CHECK_PROBES(scene, 0u, "rule and error of cells by hand");
  mapper->SetSamplingToMidpoint();
  mapper->SetSampleDistance(-1);
  scene.Render();
  CHECK_PROBES(scene, 1u, "the rule by hand");
  CHECK(std::string(mapper->GetSamplingUsedAsString()) == "midpoint", "%s is used", mapper->GetSamplingUsedAsString());
  mapper->SetSamplingToAuto();
  mapper->SetSampleDistance(0.5);
  scene.Render();
  CHECK_PROBES(scene, 2u, "the step by hand");
  CHECK(mapper->GetUsedSampleDistance() == 0.5 || std::string(mapper->GetSamplingUsedAsString()) == "cells", "a step of %g",
    mapper->GetUsedSampleDistance());
}

// While a camera moves, pictures are coarser by hand: neither they nor the still one after them are probed.
void Moving()
{
  Scene scene(300, 200);
  scene.Window->SetDesiredUpdateRate(0.0001);
  const std::vector<float> exact = scene.Picture();
  for (double rate : { 1e3, 1e6, 1e5 }) {
    scene.Window->SetDesiredUpdateRate(rate);
    scene.Render();
    CHECK_PROBES(scene, 1u, "a coarse picture");
  }
  scene.Window->SetDesiredUpdateRate(0.0001);
  CHECK(scene.Picture() == exact, "the still picture after moving is another");
  CHECK_PROBES(scene, 1u, "the still picture after moving");
  scene.Opacity->AddPoint(0.7, 0.9); // the first picture after an edit is a whole one, and only this picture is probed
  scene.Window->SetDesiredUpdateRate(1e6);
  scene.Render();
  scene.Window->SetDesiredUpdateRate(0.0001);
  scene.Render();
  CHECK_PROBES(scene, 2u, "an edit while moving");
}
} // namespace

int main()
{
  WhatIsProbed();
  Ladder();
  ByHand();
  Moving();
  return Failures == 0 ? 0 : 1;
}
