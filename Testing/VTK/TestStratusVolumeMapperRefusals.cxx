// SPDX-License-Identifier: BSD-3-Clause
// What VTK's own mappers of volumes have and this one has not: each is refused by one error, never drawn wrong. (The table in
// docs/vtk-parity.md.) What VTK's mappers ignore is left out here, too, with one warning.
#include "refusal_testing.h"

#include "vtkContourValues.h"
#include "vtkExecutive.h"
#include "vtkLight.h"
#include "vtkMultiVolume.h"
#include "vtkPlane.h"
#include "vtkPlaneCollection.h"
#include "vtkPoints.h"
#include "vtkStructuredGrid.h"
#include "vtkShaderProperty.h"
#include "vtkTransform.h"

namespace {
void Components()
{
  vtkNew<vtkImageData> triples;
  triples->SetDimensions(5, 5, 5);
  triples->AllocateScalars(VTK_UNSIGNED_CHAR, 3);
  triples->GetPointData()->GetScalars()->Fill(1);
  for (int blend = vtkVolumeMapper::COMPOSITE_BLEND; blend <= vtkVolumeMapper::ADDITIVE_BLEND; ++blend) {
    Refused(
      "three dependent components", "3 dependent components",
      [&](Scene& s) {
        s.Mapper->SetInputData(triples);
        s.Mapper->SetBlendMode(blend);
        s.Volume->GetProperty()->IndependentComponentsOff();
      },
      [](Scene& s) {
        s.Mapper->SetInputData(s.Image);
        s.Mapper->SetBlendModeToComposite();
        s.Volume->GetProperty()->IndependentComponentsOn();
      });
  }
}

void SetMode(Scene& scene, int blend)
{
  vtkNew<vtkPlane> plane;
  plane->SetOrigin(14, 14, 14);
  plane->SetNormal(1, 1, 1);
  scene.Volume->GetProperty()->SetSliceFunction(plane);
  scene.Volume->GetProperty()->GetIsoSurfaceValues()->SetValue(0, 0.4);
  scene.Mapper->SetRenderMode(blend < 0 ? vtkStratusVolumeMapper::FIRST_HIT_MODE : vtkStratusVolumeMapper::COMPOSITE_MODE);
  scene.Mapper->SetBlendMode(std::max(blend, 0));
  if (blend == vtkVolumeMapper::MINIMUM_INTENSITY_BLEND) {
    scene.Opacity->AddPoint(0.0, 0.5); // the least value, which all rays meet, must show
  }
}

void SetGradientOpacity(Scene& scene)
{
  vtkNew<vtkPiecewiseFunction> gradient;
  gradient->AddPoint(0, 0);
  gradient->AddPoint(0.1, 1);
  scene.Volume->GetProperty()->SetGradientOpacity(gradient);
}

// Half of the volume has labels, by which it is opaque and red.
void SetLabels(Scene& scene)
{
  vtkNew<vtkColorTransferFunction> red;
  vtkNew<vtkPiecewiseFunction> opaque;
  red->AddRGBPoint(0, 1, 0, 0);
  opaque->AddPoint(0, 1);
  scene.Volume->GetProperty()->SetLabelColor(1, red);
  scene.Volume->GetProperty()->SetLabelScalarOpacity(1, opaque);
}

void SetLabelMap(Scene& scene)
{
  vtkNew<vtkImageData> labels;
  labels->CopyStructure(scene.Image);
  labels->AllocateScalars(VTK_UNSIGNED_CHAR, 1);
  auto* bytes = static_cast<unsigned char*>(labels->GetScalarPointer());
  std::fill_n(bytes, labels->GetNumberOfPoints(), static_cast<unsigned char>(0));
  std::fill_n(bytes, labels->GetNumberOfPoints() / 2, static_cast<unsigned char>(1));
  SetLabels(scene);
  scene.Mapper->SetMaskInput(labels);
  scene.Mapper->SetMaskTypeToLabelMap();
  scene.Mapper->SetMaskBlendFactor(0.5f); // has no meaning, either
}

void SetTransfer2D(Scene& scene)
{
  vtkNew<vtkImageData> function;
  function->SetDimensions(4, 4, 1);
  function->AllocateScalars(VTK_FLOAT, 4);
  function->GetPointData()->GetScalars()->Fill(0.5);
  scene.Volume->GetProperty()->SetTransferFunction2D(function);
  scene.Volume->GetProperty()->SetTransferFunctionMode(vtkVolumeProperty::TF_2D);
}

// Settings that VTK's mappers ignore: the picture is the one without them. Presets leave them on when a program changes the mode.
void Unused()
{
  const int surfaces = vtkVolumeMapper::ISOSURFACE_BLEND, last = vtkVolumeMapper::SLICE_BLEND;
  for (int blend = -1; blend <= last; ++blend) { // -1: first hits
    const auto mode = [blend](Scene& s) { SetMode(s, blend); };
    LeftOut("functions of labels without a label map", "functions of labels", mode, SetLabels);
    LeftOut(
      "a clipping plane's transform", "transforms of clipping planes",
      [&](Scene& s) {
        mode(s);
        vtkNew<vtkPlane> plane;
        plane->SetOrigin(10, 10, 10);
        s.Mapper->AddClippingPlane(plane);
      },
      [](Scene& s) {
        vtkNew<vtkTransform> transform;
        transform->Translate(5, 6, 7);
        s.Mapper->GetClippingPlanes()->GetItem(0)->SetTransform(transform);
      });
    if (blend == vtkVolumeMapper::COMPOSITE_BLEND) {
      continue;
    }
    LeftOut("gradient opacity", "GradientOpacity", mode, SetGradientOpacity);
    LeftOut("a label map", "label map", mode, SetLabelMap);
    LeftOut("a function of two variables", "TransferFunction2D", mode, SetTransfer2D);
    if (blend >= 0 && blend != surfaces) {
      LeftOut("light", "Shade", mode, [](Scene& s) {
        s.Volume->GetProperty()->ShadeOn();
        for (int l = 0; l < 9; ++l) { // which are too many where there is light
          s.Renderer->AddLight(vtkNew<vtkLight>());
        }
      });
    }
  }
  LeftOut(
    "a slice's transform", "transform of SliceFunction", [](Scene& s) { SetMode(s, vtkVolumeMapper::SLICE_BLEND); },
    [](Scene& s) {
      vtkNew<vtkTransform> transform;
      transform->Translate(5, 6, 7);
      s.Volume->GetProperty()->GetSliceFunction()->SetTransform(transform);
    });
  LeftOut(
    "all at once", "Shade", [](Scene& s) { SetMode(s, vtkVolumeMapper::MAXIMUM_INTENSITY_BLEND); },
    [](Scene& s) {
      s.Volume->GetProperty()->ShadeOn();
      SetGradientOpacity(s);
      SetLabelMap(s);
      SetTransfer2D(s);
    });
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
  Components();
  Unused();
  Lights();
  Props();
  Peeling();
  SeveralVolumes();
  return Failures == 0 ? 0 : 1;
}
