// SPDX-License-Identifier: BSD-3-Clause
// What the mapper can't draw it refuses: one error that names the reason, nothing drawn, and the next good picture is as before.
#include "mapper_testing.h"

#include "vtkBitArray.h"
#include "vtkContourValues.h"
#include "vtkCullerCollection.h"
#include "vtkExecutive.h"
#include "vtkLight.h"
#include "vtkMultiVolume.h"
#include "vtkPlane.h"
#include "vtkPlaneCollection.h"
#include "vtkRectilinearGrid.h"
#include "vtkShaderProperty.h"
#include "vtkTransform.h"

#include <limits>

namespace {
bool IsBlack(Scene& scene)
{
  const std::vector<unsigned char> bytes = scene.Bytes();
  for (size_t p = 0; p < scene.Pixels(); ++p) {
    if (bytes[4 * p] || bytes[4 * p + 1] || bytes[4 * p + 2]) {
      return false;
    }
  }
  return true;
}

// Breaks a scene that has drawn, looks for `word` in one error, mends it, and wants the first picture again.
void Refused(const char* what, const char* word, const std::function<void(Scene&)>& breaks, const std::function<void(Scene&)>& mends)
{
  Scene scene(64, 48);
  const std::vector<float> before = scene.Picture();
  CHECK(scene.Errors->Count == 0, "%s: %s", what, scene.Errors->Text.c_str());
  breaks(scene);
  scene.Render();
  CHECK(scene.Errors->Count == 1, "%s: %d errors", what, scene.Errors->Count);
  CHECK(scene.Errors->Has(word), "%s: '%s' says nothing of '%s'", what, scene.Errors->Text.c_str(), word);
  CHECK(IsBlack(scene), "%s: something is drawn", what);
  scene.Render();
  CHECK(scene.Errors->Count == 1, "%s: told again with every picture", what);
  mends(scene);
  CHECK(scene.Picture() == before, "%s: the picture after it is another", what);
  CHECK(scene.Errors->Count == 1, "%s: still refused: %s", what, scene.Errors->Text.c_str());
}

void Modes()
{
  Refused(
    "slice", "blend mode", [](Scene& s) { s.Mapper->SetBlendModeToSlice(); },
    [](Scene& s) { s.Mapper->SetBlendModeToComposite(); });
  Refused(
    "shading of a maximum", "shading",
    [](Scene& s) {
      s.Volume->GetProperty()->ShadeOn();
      s.Mapper->SetBlendModeToMaximumIntensity();
    },
    [](Scene& s) {
      s.Volume->GetProperty()->ShadeOff();
      s.Mapper->SetBlendModeToComposite();
    });
  vtkNew<vtkPiecewiseFunction> gradient;
  gradient->AddPoint(0, 0);
  gradient->AddPoint(1, 1);
  Refused(
    "gradient opacity in first hits", "gradient opacity",
    [&](Scene& s) {
      s.Volume->GetProperty()->SetGradientOpacity(gradient);
      s.Mapper->SetRenderModeToFirstHit();
    },
    [](Scene& s) {
      s.Volume->GetProperty()->DisableGradientOpacityOn();
      s.Mapper->SetRenderModeToComposite();
    });
  Refused(
    "2D transfer function", "TF_1D", [](Scene& s) { s.Volume->GetProperty()->SetTransferFunctionMode(vtkVolumeProperty::TF_2D); },
    [](Scene& s) { s.Volume->GetProperty()->SetTransferFunctionMode(vtkVolumeProperty::TF_1D); });
  vtkNew<vtkColorTransferFunction> label;
  label->AddRGBPoint(0, 1, 1, 1);
  Refused(
    "label functions without a label map", "label", [&](Scene& s) { s.Volume->GetProperty()->SetLabelColor(1, label); },
    [](Scene& s) { s.Volume->GetProperty()->SetLabelColor(1, nullptr); });
  Refused(
    "isosurface without values", "0 contour values",
    [](Scene& s) {
      s.Mapper->SetBlendModeToIsoSurface();
      s.Volume->GetProperty()->GetIsoSurfaceValues()->SetNumberOfContours(0);
    },
    [](Scene& s) { s.Mapper->SetBlendModeToComposite(); });
  Refused(
    "maxima of first hits", "blend mode",
    [](Scene& s) {
      s.Mapper->SetRenderModeToFirstHit();
      s.Mapper->SetBlendModeToMaximumIntensity();
    },
    [](Scene& s) {
      s.Mapper->SetRenderModeToComposite();
      s.Mapper->SetBlendModeToComposite();
    });
  Refused(
    "seven clipping planes", "clipping planes",
    [](Scene& s) {
      for (int p = 0; p < 7; ++p) {
        s.Mapper->AddClippingPlane(vtkNew<vtkPlane>());
      }
    },
    [](Scene& s) { s.Mapper->RemoveAllClippingPlanes(); });
  Refused(
    "colour window 0", "FinalColorWindow", [](Scene& s) { s.Mapper->SetFinalColorWindow(0); },
    [](Scene& s) { s.Mapper->SetFinalColorWindow(1); });
  Refused(
    "block size 3", "block", [](Scene& s) { s.Mapper->SetBlockSize(3); }, [](Scene& s) { s.Mapper->SetBlockSize(0); });
}

// Of each of these VTK's mappers have something that this one has not.
void Looks()
{
  Refused(
    "intensity of what is clipped", "UseClippedVoxelIntensity", [](Scene& s) { s.Volume->GetProperty()->UseClippedVoxelIntensityOn(); },
    [](Scene& s) { s.Volume->GetProperty()->UseClippedVoxelIntensityOff(); });
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
      "two components in another mode", "2 components",
      [&](Scene& s) {
        s.Mapper->SetInputData(pairs);
        s.Mapper->SetBlendMode(blend);
      },
      [](Scene& s) {
        s.Mapper->SetInputData(s.Image);
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
    "a lamp that fades", "attenuation",
    [](Scene& s) {
      vtkNew<vtkLight> lamp;
      lamp->SetPositional(1);
      lamp->SetConeAngle(90);
      lamp->SetAttenuationValues(1, 0.1, 0);
      s.Renderer->AddLight(lamp);
      s.Volume->GetProperty()->ShadeOn();
    },
    [](Scene& s) { s.Volume->GetProperty()->ShadeOff(); });
}

void Props()
{
  Refused(
    "depth peeling of volumes", "UseDepthPeelingForVolumes",
    [](Scene& s) {
      s.Renderer->SetUseDepthPeeling(1);
      s.Renderer->SetUseDepthPeelingForVolumes(true);
    },
    [](Scene& s) {
      s.Renderer->SetUseDepthPeeling(0);
      s.Renderer->SetUseDepthPeelingForVolumes(false);
    });
  Refused(
    "shaders of one's own", "shaders",
    [](Scene& s) { s.Volume->GetShaderProperty()->AddFragmentShaderReplacement("//VTK::Base::Impl", true, "", false); },
    [](Scene& s) { s.Volume->GetShaderProperty()->ClearAllFragmentShaderReplacements(); });
  vtkNew<vtkRectilinearGrid> grid;
  vtkNew<vtkFloatArray> ticks, values;
  for (int i = 0; i < 3; ++i) {
    ticks->InsertNextValue(static_cast<float>(i * i));
  }
  values->SetNumberOfTuples(27);
  values->Fill(1.0);
  grid->SetDimensions(3, 3, 3);
  grid->SetXCoordinates(ticks);
  grid->SetYCoordinates(ticks);
  grid->SetZCoordinates(ticks);
  grid->GetPointData()->SetScalars(values);
  vtkNew<ErrorObserver> pipeline;
  Refused(
    "rectilinear grid", "vtkRectilinearGrid is not supported",
    [&](Scene& s) {
      s.Mapper->GetExecutive()->AddObserver(vtkCommand::ErrorEvent, pipeline); // it says so, too
      static_cast<vtkVolumeMapper*>(s.Mapper)->SetInputData(grid);
    },
    [](Scene& s) { s.Mapper->SetInputData(s.Image); });
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
  CHECK(errors->Count > 0 && errors->Has("only supported by vtkGPUVolumeRayCastMapper"), "several volumes in one: '%s'", errors->Text.c_str());
  CHECK(IsBlack(scene), "several volumes in one: something is drawn");
}

void Functions()
{
  vtkNew<vtkPiecewiseFunction> empty;
  Refused(
    "opacity without points", "no points", [&](Scene& s) { s.Volume->GetProperty()->SetScalarOpacity(empty); },
    [](Scene& s) { s.Volume->GetProperty()->SetScalarOpacity(s.Opacity); });
  vtkNew<vtkColorTransferFunction> colorless;
  Refused(
    "colour without points", "no points", [&](Scene& s) { s.Volume->GetProperty()->SetColor(colorless); },
    [](Scene& s) { s.Volume->GetProperty()->SetColor(s.Color); });
  vtkNew<vtkPiecewiseFunction> beyond;
  beyond->AddPoint(0, 0);
  beyond->AddPoint(1, 1.5);
  Refused(
    "opacity of 1.5", "1.5", [&](Scene& s) { s.Volume->GetProperty()->SetScalarOpacity(beyond); },
    [](Scene& s) { s.Volume->GetProperty()->SetScalarOpacity(s.Opacity); });
  for (double nothing : { std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN() }) {
    Refused(
      "sample distance that is no length", "sample distance", [&](Scene& s) { s.Mapper->SetSampleDistance(nothing); },
      [](Scene& s) { s.Mapper->SetSampleDistance(-1); });
    Refused(
      "crop plane that is nowhere", "crop bounds",
      [&](Scene& s) {
        s.Mapper->CroppingOn();
        s.Mapper->SetCroppingRegionPlanes(nothing, 5, 0, 5, 0, 5);
      },
      [](Scene& s) { s.Mapper->CroppingOff(); });
  }
  Refused(
    "crop planes in reverse", "reversed",
    [](Scene& s) {
      s.Mapper->CroppingOn();
      s.Mapper->SetCroppingRegionPlanes(5, 1, 0, 5, 0, 5);
    },
    [](Scene& s) { s.Mapper->CroppingOff(); });
  Refused(
    "range of averages in reverse", "reversed",
    [](Scene& s) {
      s.Mapper->SetBlendModeToAverageIntensity();
      s.Mapper->SetAverageIPScalarRange(2, 1);
    },
    [](Scene& s) { s.Mapper->SetBlendModeToComposite(); });
  Refused(
    "unit distance 0", "distance", [](Scene& s) { s.Volume->GetProperty()->SetScalarOpacityUnitDistance(0); },
    [](Scene& s) { s.Volume->GetProperty()->SetScalarOpacityUnitDistance(1.5); });
}

void Data()
{
  vtkNew<vtkImageData> empty;
  Refused(
    "empty image", "empty", [&](Scene& s) { s.Mapper->SetInputData(empty); }, [](Scene& s) { s.Mapper->SetInputData(s.Image); });
  vtkNew<vtkImageData> bare;
  bare->SetDimensions(5, 5, 5);
  Refused(
    "no scalars", "no scalar array", [&](Scene& s) { s.Mapper->SetInputData(bare); }, [](Scene& s) { s.Mapper->SetInputData(s.Image); });
  Refused(
    "array that is not there", "'nowhere'",
    [](Scene& s) {
      s.Mapper->SetScalarModeToUsePointFieldData();
      s.Mapper->SelectScalarArray("nowhere");
    },
    [](Scene& s) { s.Mapper->SelectScalarArray("density"); });
  Refused(
    "array number 9", "number 9",
    [](Scene& s) {
      s.Mapper->SetScalarModeToUsePointFieldData();
      s.Mapper->SelectScalarArray(9);
    },
    [](Scene& s) { s.Mapper->SelectScalarArray(0); });
  Refused(
    "no cell data", "'density' (points)", [](Scene& s) { s.Mapper->SetScalarModeToUseCellData(); },
    [](Scene& s) { s.Mapper->SetScalarModeToUsePointData(); });
  vtkNew<vtkImageData> vectors;
  vectors->SetDimensions(5, 5, 5);
  vectors->AllocateScalars(VTK_FLOAT, 5);
  Refused(
    "five components", "5 components", [&](Scene& s) { s.Mapper->SetInputData(vectors); },
    [](Scene& s) { s.Mapper->SetInputData(s.Image); });
  vtkNew<vtkImageData> bits;
  bits->SetDimensions(5, 5, 5);
  vtkNew<vtkBitArray> array;
  array->SetNumberOfTuples(125);
  bits->GetPointData()->SetScalars(array);
  Refused(
    "bit array", "bit", [&](Scene& s) { s.Mapper->SetInputData(bits); }, [](Scene& s) { s.Mapper->SetInputData(s.Image); });
  vtkNew<vtkImageData> shortened;
  shortened->SetDimensions(5, 5, 5);
  vtkNew<vtkFloatArray> few;
  few->SetNumberOfTuples(100);
  shortened->GetPointData()->SetScalars(few);
  Refused(
    "array too short", "100", [&](Scene& s) { s.Mapper->SetInputData(shortened); }, [](Scene& s) { s.Mapper->SetInputData(s.Image); });
  for (double bad : { 0.0, -1.0, std::numeric_limits<double>::quiet_NaN() }) {
    vtkNew<vtkImageData> image;
    image->SetDimensions(5, 5, 5);
    image->AllocateScalars(VTK_FLOAT, 1);
    image->SetSpacing(1, bad, 1);
    Refused(
      "spacing", "spacing",
      [&](Scene& s) {
        s.Renderer->GetCullers()->RemoveAllItems(); // VTK's own drops bounds that are not numbers without a word
        s.Mapper->SetInputData(image);
      },
      [](Scene& s) { s.Mapper->SetInputData(s.Image); });
  }
  Refused(
    "matrix that flattens", "matrix", [](Scene& s) { s.Volume->SetScale(1, 0, 1); }, [](Scene& s) { s.Volume->SetScale(1, 1, 1); });
}

// VTK draws nothing, silently, for a volume whose mapper has no input; the process must live through it.
void NoInput()
{
  Scene scene(64, 48);
  scene.Mapper->SetInputConnection(0, nullptr);
  vtkNew<ErrorObserver> pipeline;
  scene.Mapper->GetExecutive()->AddObserver(vtkCommand::ErrorEvent, pipeline);
  scene.Render();
  CHECK(IsBlack(scene), "something is drawn without an input");
  scene.Mapper->Render(scene.Renderer, scene.Volume);
  CHECK(scene.Errors->Count == 1 && scene.Errors->Has("no input"), "%s", scene.Errors->Text.c_str());
}

void Device()
{
  Scene scene(64, 48);
  const std::vector<float> before = scene.Picture();
  scene.Mapper->SetDevice("no such device");
  CHECK(scene.Errors->Count == 1 && scene.Errors->Has("host"), "no list of devices in '%s'", scene.Errors->Text.c_str());
  CHECK(std::string(scene.Mapper->GetDevice()) == "host", "the device became %s", scene.Mapper->GetDevice());
  CHECK(scene.Picture() == before, "a device that is refused changes the picture");
}
} // namespace

int main()
{
  Modes();
  Looks();
  Lights();
  Props();
  SeveralVolumes();
  Functions();
  Data();
  NoInput();
  Device();
  return Failures == 0 ? 0 : 1;
}
