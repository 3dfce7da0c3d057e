// SPDX-License-Identifier: BSD-3-Clause
// Every kind of function a vtkVolumeProperty can hold, against VTK's own word on its value: a slab of constant value, seen straight on,
// shows exactly one colour and one opacity.
#include "mapper_testing.h"

#include "vtkDiscretizableColorTransferFunction.h"

namespace {
// A slab one unit distance thick: its middle pixel has the opacity and colour of `value` itself.
void Slab(const char* what, vtkVolumeProperty* property, double value, double opacity, const double rgb[3])
{
  Scene scene(33, 33);
  vtkNew<vtkImageData> slab;
  slab->SetDimensions(3, 3, 2);
  slab->AllocateScalars(VTK_FLOAT, 1);
  slab->GetPointData()->GetScalars()->Fill(value);
  // The range of the data spans the functions, as users' data do.
  slab->SetScalarComponentFromDouble(0, 0, 0, 0, 0.02);
  slab->SetScalarComponentFromDouble(2, 2, 1, 0, 10.0);
  property->SetScalarOpacityUnitDistance(1.0);
  property->SetInterpolationTypeToNearest();
  scene.Volume->SetProperty(property);
  scene.Mapper->SetInputData(slab);
  scene.Mapper->SetTermination(1.0);
  scene.Mapper->SetSampleDistance(0.01);
  vtkCamera* camera = scene.Renderer->GetActiveCamera();
  camera->ParallelProjectionOn();
  scene.Look(0, 0);
  scene.Render();
  CHECK(scene.Errors->Count == 0, "%s: %s", what, scene.Errors->Text.c_str());
  const float* pixel = scene.Rgba() + 4 * (16 * 33 + 16);
  // Tables have some thousand entries over the range of the data, and VTK's functions bend by less than this between two.
  CHECK(std::fabs(pixel[3] - opacity) < 2e-3, "%s at %g: opacity %g, VTK says %g", what, value, pixel[3], opacity);
  for (int c = 0; c < 3; ++c) {
    CHECK(
      std::fabs(pixel[c] - opacity * rgb[c]) < 3e-3, "%s at %g: channel %d is %g, VTK says %g", what, value, c, pixel[c], opacity * rgb[c]);
  }
}

void Check(const char* what, const std::function<void(vtkPiecewiseFunction*, vtkColorTransferFunction*)>& change,
  vtkColorTransferFunction* color = nullptr)
{
  for (double value : { 0.05, 0.7, 2.3, 4.9, 8.1 }) {
    vtkNew<vtkVolumeProperty> property;
    vtkNew<vtkPiecewiseFunction> opacity;
    vtkNew<vtkColorTransferFunction> plain;
    vtkColorTransferFunction* rgb = color ? color : plain.Get();
    rgb->RemoveAllPoints();
    opacity->AddPoint(0.03, 0.2);
    opacity->AddPoint(3, 0.8);
    opacity->AddPoint(9, 0.4);
    rgb->AddRGBPoint(0.03, 1, 0.2, 0.1);
    rgb->AddRGBPoint(3, 0.2, 0.9, 0.3);
    rgb->AddRGBPoint(9, 0.1, 0.3, 1);
    change(opacity, rgb);
    property->SetScalarOpacity(opacity);
    property->SetColor(rgb);
    double expected[3];
    rgb->GetColor(value, expected);
    Slab(what, property, value, opacity->GetValue(value), expected);
  }
}

void Grey()
{
  vtkNew<vtkVolumeProperty> property;
  vtkNew<vtkPiecewiseFunction> opacity, grey;
  opacity->AddPoint(0, 0.5);
  grey->AddPoint(0, 0.1);
  grey->AddPoint(10, 0.9);
  property->SetScalarOpacity(opacity);
  property->SetColor(grey);
  const double expected[3] = { 0.42, 0.42, 0.42 };
  Slab("grey", property, 4.0, 0.5, expected);
}

// Beyond the ends of a function that does not clamp VTK says 0.
void Ends()
{
  const double red[3] = { 1, 0, 0 };
  for (bool clamp : { true, false }) {
    vtkNew<vtkVolumeProperty> property;
    vtkNew<vtkPiecewiseFunction> opacity;
    vtkNew<vtkColorTransferFunction> color;
    opacity->AddPoint(1, 0.5);
    opacity->AddPoint(2, 0.5);
    opacity->SetClamping(clamp);
    color->AddRGBPoint(0, 1, 0, 0);
    property->SetScalarOpacity(opacity);
    property->SetColor(color);
    Slab("within", property, 1.5, 0.5, red);
    Slab("beyond", property, 5.0, clamp ? 0.5 : 0.0, red);
    Slab("before", property, 0.5, clamp ? 0.5 : 0.0, red);
  }
  vtkNew<vtkVolumeProperty> property;
  vtkNew<vtkPiecewiseFunction> opacity;
  vtkNew<vtkColorTransferFunction> color;
  opacity->AddPoint(0, 0.5);
  color->AddRGBPoint(1, 1, 0, 0);
  color->AddRGBPoint(2, 1, 0, 0);
  color->ClampingOff();
  property->SetScalarOpacity(opacity);
  property->SetColor(color);
  const double black[3] = { 0, 0, 0 };
  Slab("colour within", property, 1.5, 0.5, red);
  Slab("colour beyond", property, 5.0, 0.5, black);
  Slab("colour before", property, 0.5, 0.5, black);
}
} // namespace

int main()
{
  using Opacity = vtkPiecewiseFunction;
  using Color = vtkColorTransferFunction;
  Check("straight", [](Opacity*, Color*) {});
  Check("midpoint and sharpness", [](Opacity* o, Color* c) {
    o->AddPoint(1, 0.1, 0.3, 0.6);
    c->AddRGBPoint(1, 0, 0.5, 1, 0.7, 0.4);
  });
  Check("sharp as a step", [](Opacity* o, Color* c) {
    o->AddPoint(1, 0.1, 0.45, 1.0);
    c->AddRGBPoint(1, 0, 0.5, 1, 0.45, 1.0);
  });
  Check("HSV", [](Opacity*, Color* c) { c->SetColorSpaceToHSV(); });
  Check("Lab", [](Opacity*, Color* c) { c->SetColorSpaceToLab(); });
  Check("diverging", [](Opacity*, Color* c) { c->SetColorSpaceToDiverging(); });
  Check("logarithmic", [](Opacity* o, Color* c) {
    o->SetUseLogScale(true);
    c->SetScaleToLog10();
  });
  vtkNew<vtkDiscretizableColorTransferFunction> discrete;
  discrete->DiscretizeOn();
  discrete->SetNumberOfValues(5);
  Check(
    "discretised", [&](Opacity*, Color*) { discrete->Build(); }, discrete);
  Grey();
  Ends();
  return Failures == 0 ? 0 : 1;
}
