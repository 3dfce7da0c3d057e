// SPDX-License-Identifier: BSD-3-Clause
// The mapper refuses data and settings that it cannot draw: one error names the reason, nothing is drawn, and the next valid picture is
// right.
#include "refusal_testing.h"

#include "vtkBitArray.h"
#include "vtkContourValues.h"
#include "vtkCullerCollection.h"
#include "vtkExecutive.h"
#include "vtkPlane.h"
#include "vtkPlaneCollection.h"

#include <limits>

namespace {
void Modes()
{
  Refused(
    "slice of nothing", "needs a SliceFunction", [](Scene& s) { s.Mapper->SetBlendModeToSlice(); },
    [](Scene& s) { s.Mapper->SetBlendModeToComposite(); });
  Refused(
    "2D transfer function", "TransferFunction2D is not set",
    [](Scene& s) { s.Volume->GetProperty()->SetTransferFunctionMode(vtkVolumeProperty::TF_2D); },
    [](Scene& s) { s.Volume->GetProperty()->SetTransferFunctionMode(vtkVolumeProperty::TF_1D); });
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
  vtkNew<vtkImageData> mask;
  vtkNew<vtkUnsignedCharArray> bytes;
  bytes->SetNumberOfTuples(3);
  bytes->Fill(1);
  mask->GetPointData()->SetScalars(bytes);
  Refused(
    "mask too short", "3 values for",
    [&](Scene& s) {
      mask->SetDimensions(s.Image->GetDimensions());
      s.Mapper->SetMaskInput(mask);
    },
    [](Scene& s) { s.Mapper->SetMaskInput(nullptr); });
  vtkNew<vtkImageData> shortened;
  shortened->SetDimensions(5, 5, 5);
  vtkNew<vtkFloatArray> few;
  few->SetNumberOfTuples(100);
  shortened->GetPointData()->SetScalars(few);
  Refused(
    "array too short", "100", [&](Scene& s) { s.Mapper->SetInputData(shortened); }, [](Scene& s) { s.Mapper->SetInputData(s.Image); });
  const auto ghosts = [](const char* what, const char* word, vtkDataArray* flags, int components, vtkIdType tuples) {
    flags->SetName("vtkGhostType");
    flags->SetNumberOfComponents(components);
    flags->SetNumberOfTuples(tuples);
    flags->Fill(0);
    Refused(
      what, word,
      [flags](Scene& s) {
        s.Image->GetPointData()->AddArray(flags);
        s.Image->Modified();
      },
      [](Scene& s) {
        s.Image->GetPointData()->RemoveArray("vtkGhostType");
        s.Image->Modified();
      });
  };
  const vtkIdType points = Scene(8, 8).Image->GetNumberOfPoints();
  ghosts("few ghosts", "'vtkGhostType' has 9 tuples of 1 unsigned char", vtkNew<vtkUnsignedCharArray>(), 1, 9);
  ghosts("ghosts of two components", "of 2 unsigned char, it must have one", vtkNew<vtkUnsignedCharArray>(), 2, points);
  ghosts("ghosts in floats", "of 1 float, it must have one", vtkNew<vtkFloatArray>(), 1, points);
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
  Functions();
  Data();
  NoInput();
  Device();
  return Failures == 0 ? 0 : 1;
}
