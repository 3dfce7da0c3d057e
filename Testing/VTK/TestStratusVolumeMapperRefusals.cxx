// SPDX-License-Identifier: BSD-3-Clause
// What VTK's own mappers of volumes have and this one has not: each is refused by one error, never drawn wrong. (The table in
// docs/vtk-parity.md.)
#include "refusal_testing.h"

#include "vtkExecutive.h"
#include "vtkLight.h"
#include "vtkMultiVolume.h"
#include "vtkPlane.h"
#include "vtkPoints.h"
#include "vtkStructuredGrid.h"
#include "vtkShaderProperty.h"
#include "vtkTransform.h"

namespace {
void Shading()
{
  vtkNew<vtkPiecewiseFunction> gradient;
  gradient->AddPoint(0, 0);
  gradient->AddPoint(1, 1);
  Refused(
    "gradient opacity of a maximum", "gradient opacity",
    [&](Scene& s) {
      s.Volume->GetProperty()->SetGradientOpacity(gradient);
      s.Mapper->SetBlendModeToMaximumIntensity();
    },
    [](Scene& s) {
      s.Volume->GetProperty()->DisableGradientOpacityOn();
      s.Mapper->SetBlendModeToComposite();
    });
  vtkNew<vtkImageData> pairs;
  pairs->SetDimensions(5, 5, 5);
  pairs->AllocateScalars(VTK_UNSIGNED_CHAR, 2);
  pairs->GetPointData()->GetScalars()->Fill(1);
  for (int blend = vtkVolumeMapper::MAXIMUM_INTENSITY_BLEND; blend <= vtkVolumeMapper::ISOSURFACE_BLEND; ++blend) {
    Refused(
      "two dependent components in another mode, and any of surfaces", "2 components",
      [&](Scene& s) {
        s.Mapper->SetInputData(pairs);
        s.Mapper->SetBlendMode(blend);
        s.Volume->GetProperty()->SetIndependentComponents(blend == vtkVolumeMapper::ISOSURFACE_BLEND);
      },
      [](Scene& s) {
        s.Mapper->SetInputData(s.Image);
        s.Volume->GetProperty()->IndependentComponentsOn();
        s.Mapper->SetBlendModeToComposite();
      });
  }
  vtkNew<vtkImageData> labels;
  for (bool first : { false, true }) {
    Refused(
      "labels in another mode", "label maps",
      [&](Scene& s) {
        labels->CopyStructure(s.Image);
        labels->AllocateScalars(VTK_UNSIGNED_CHAR, 1);
        labels->GetPointData()->GetScalars()->Fill(1);
        s.Mapper->SetMaskInput(labels);
        s.Mapper->SetMaskTypeToLabelMap();
        s.Mapper->SetBlendMode(first ? vtkVolumeMapper::COMPOSITE_BLEND : vtkVolumeMapper::ADDITIVE_BLEND);
        s.Mapper->SetRenderMode(first ? vtkStratusVolumeMapper::FIRST_HIT_MODE : vtkStratusVolumeMapper::COMPOSITE_MODE);
      },
      [](Scene& s) {
        s.Mapper->SetMaskInput(nullptr);
        s.Mapper->SetBlendModeToComposite();
        s.Mapper->SetRenderModeToComposite();
      });
  }
  vtkNew<vtkTransform> transform;
  Refused(
    "clipping plane with a transform", "transform",
    [&](Scene& s) {
      vtkNew<vtkPlane> plane;
      plane->SetTransform(transform);
      s.Mapper->AddClippingPlane(plane);
    },
    [](Scene& s) { s.Mapper->RemoveAllClippingPlanes(); });
}

void Lights()
{
  Refused(
    "nine lights", "more than 8 lights",
    [](Scene& s) {
      s.Volume->GetProperty()->ShadeOn();
      s.Renderer->RemoveAllLights();
      for (int l = 0; l < 9; ++l) {
        s.Renderer->AddLight(vtkNew<vtkLight>());
      }
    },
    [](Scene& s) { s.Volume->GetProperty()->ShadeOff(); });
  Refused(
    "a lamp that gets brighter with the distance without end", "attenuation",
    [](Scene& s) {
      vtkNew<vtkLight> lamp;
      lamp->SetPositional(1);
      lamp->SetConeAngle(90);
      lamp->SetAttenuationValues(-1, 0.1, 0);
      s.Renderer->AddLight(lamp);
      s.Volume->GetProperty()->ShadeOn();
    },
    [](Scene& s) { s.Volume->GetProperty()->ShadeOff(); });
}

void Props()
{
  Refused(
    "shaders of one's own", "shaders",
    [](Scene& s) { s.Volume->GetShaderProperty()->AddFragmentShaderReplacement("//VTK::Base::Impl", true, "", false); },
    [](Scene& s) { s.Volume->GetShaderProperty()->ClearAllFragmentShaderReplacements(); });
  vtkNew<vtkStructuredGrid> grid;
  vtkNew<vtkPoints> points;
  vtkNew<vtkFloatArray> values;
  for (int i = 0; i < 27; ++i) {
    points->InsertNextPoint(i % 3, i / 3 % 3, i / 9);
  }
  values->SetNumberOfTuples(27);
  values->Fill(1.0);
  grid->SetDimensions(3, 3, 3);
  grid->SetPoints(points);
  grid->GetPointData()->SetScalars(values);
  vtkNew<ErrorObserver> pipeline;
  Refused(
    "structured grid", "vtkStructuredGrid is not supported",
    [&](Scene& s) {
      s.Mapper->GetExecutive()->AddObserver(vtkCommand::ErrorEvent, pipeline); // it says so, too
      s.Mapper->SetInputDataObject(grid);
    },
    [](Scene& s) { s.Mapper->SetInputData(s.Image); });
}

// ParaView sets it for every view, so it must not keep the volume from being drawn.
void Peeling()
{
  Scene scene(64, 48);
  const std::vector<float> before = scene.Picture();
  scene.Renderer->SetUseDepthPeeling(1);
  scene.Renderer->SetUseDepthPeelingForVolumes(true);
  CHECK(scene.Picture() == before, "depth peeling of volumes: another picture");
  CHECK(scene.Light() > 10.0, "depth peeling of volumes: nothing is shown");
  CHECK(scene.Errors->Count == 0, "depth peeling of volumes: %s", scene.Errors->Text.c_str());
}

// VTK's own prop of several volumes looks for VTK's own mapper, and says so.
void SeveralVolumes()
{
  Scene scene(64, 48);
  CHECK(scene.Light() > 10.0, "nothing to see");
  vtkNew<vtkMultiVolume> several;
  vtkNew<ErrorObserver> errors;
  several->AddObserver(vtkCommand::ErrorEvent, errors);
  several->SetVolume(scene.Volume);
  several->SetMapper(scene.Mapper);
  scene.Renderer->RemoveViewProp(scene.Volume);
  scene.Renderer->AddViewProp(several);
  scene.Render();
  CHECK(
    errors->Count > 0 && errors->Has("only supported by vtkGPUVolumeRayCastMapper"), "several volumes in one: '%s'", errors->Text.c_str());
  CHECK(IsBlack(scene), "several volumes in one: something is drawn");
}
} // namespace

int main()
{
  Shading();
  Lights();
  Props();
  Peeling();
  SeveralVolumes();
  return Failures == 0 ? 0 : 1;
}
