// SPDX-License-Identifier: BSD-3-Clause
// Two-dimensional transfer functions, slices and the intensity of clipped voxels, as VTK's property has them: held against the double
// reference, and with VTK's own mapper of the GPU.
#include "mapper_testing.h"
#include "refusal_testing.h"

#include "Testing/support/reference_modes.h"

#include "vtkBox.h"
#include "vtkCone.h"
#include "vtkCylinder.h"
#include "vtkOpenGLGPUVolumeRayCastMapper.h"
#include "vtkPlane.h"
#include "vtkPlaneCollection.h"
#include "vtkQuadric.h"
#include "vtkSphere.h"

#include <functional>

namespace {
const int Columns = 48, Rows = 24;

// Opacity over values of .15 to .6 and gradients that are neither flat nor steepest; colours by both.
void FillFunction(vtkImageData* function)
{
  function->SetDimensions(Columns, Rows, 1);
  function->AllocateScalars(VTK_FLOAT, 4);
  for (int j = 0; j < Rows; ++j) {
    for (int i = 0; i < Columns; ++i) {
      const double x = (i + 0.5) / Columns, y = (j + 0.5) / Rows, u = (x - 0.4) / 0.25, v = (y - 0.55) / 0.4;
      const double opacity[4] = { x, 1.0 - y, 0.3 + 0.5 * y, std::max(0.0, 0.7 * (1.0 - u * u - v * v)) };
      for (int c = 0; c < 4; ++c) {
        function->SetScalarComponentFromDouble(i, j, 0, c, opacity[c]);
      }
    }
  }
}

stratus_transfer_2d FunctionOf(vtkImageData* image, double unit, const double values[2], const double second[2])
{
  stratus_transfer_2d of = stratus_transfer_2d();
  of.rgba = static_cast<const float*>(image->GetScalarPointer());
  of.columns = Columns;
  of.rows = Rows;
  std::copy_n(values, 2, of.value_range);
  std::copy_n(second, 2, of.second_range);
  of.unit_distance = unit;
  return of;
}

// PSNR between our picture over black and what VTK's mapper shows, in 8 bits.
double BesideVtk(Scene& scene, const std::function<void(vtkOpenGLGPUVolumeRayCastMapper*)>& more = nullptr)
{
  const std::vector<float> ours = scene.Picture();
  vtkNew<vtkOpenGLGPUVolumeRayCastMapper> mapper;
  mapper->SetInputData(scene.Image);
  mapper->SetBlendMode(scene.Mapper->GetBlendMode());
  mapper->SetClippingPlanes(scene.Mapper->GetClippingPlanes());
  mapper->AutoAdjustSampleDistancesOff();
  mapper->SetSampleDistance(0.1f);
  if (more) {
    more(mapper);
  }
  scene.Volume->SetMapper(mapper);
  scene.Render();
  const std::vector<unsigned char> bytes = scene.Bytes();
  scene.Volume->SetMapper(scene.Mapper);
  std::vector<float> shown(4 * scene.Pixels());
  for (size_t p = 0; p < scene.Pixels(); ++p) {
    for (size_t c = 0; c < 3; ++c) {
      shown[4 * p + c] = bytes[4 * p + c] / 255.0f;
    }
    shown[4 * p + 3] = ours[4 * p + 3];
  }
  return reference_psnr(shown.data(), ours.data(), scene.Pixels());
}

// vtks: distance of VTK's picture from ours in dB; 0: VTK cannot draw it.
void Expect(const char* what, double db, double least, double vtks)
{
  CHECK(db >= least, "%s: %.1f dB", what, db);
  std::printf("%-24s %.1f dB", what, db);
  if (vtks > 0.0) {
    std::printf("; vtkOpenGLGPUVolumeRayCastMapper's picture is %.1f dB from ours", vtks);
  }
  std::printf("\n");
}

void ByGradient()
{
  Scene scene;
  vtkNew<vtkImageData> function;
  FillFunction(function);
  vtkVolumeProperty* property = scene.Volume->GetProperty();
  const double plain = scene.Light();
  property->SetTransferFunctionMode(vtkVolumeProperty::TF_2D);
  property->SetTransferFunction2D(function);
  scene.Mapper->SetImageErrorTolerance(0.0005);
  scene.Mapper->AuditOn();
  CHECK(scene.Light() != plain, "the function changes nothing");
  CHECK(scene.Errors->Count == 0, "%s", scene.Errors->Text.c_str());
  CHECK(scene.Mapper->GetDifferingPixels() == 0, "skipping changes the picture");
  CHECK(scene.Mapper->GetToleranceMet(), "%s", scene.Mapper->GetReason());
  double values[2];
  scene.Image->GetPointData()->GetScalars()->GetRange(values);
  const double second[2] = { 0.0, 0.25 * (values[1] - values[0]) };
  const stratus_transfer_2d of = FunctionOf(function, property->GetScalarOpacityUnitDistance(), values, second);
  const double db = ReferencePsnr(scene, [&](reference_scene& s) { s.transfer_2d = &of; });
  scene.Mapper->AuditOff();
  property->SetScalarOpacityUnitDistance(1.0); // VTK's mapper takes opacities of this function a sample
  Expect("value and gradient", db, 63.0, BesideVtk(scene, [](vtkOpenGLGPUVolumeRayCastMapper* m) { m->SetSampleDistance(1.0f); }));
  const std::vector<float> before = scene.Picture();
  for (int j = 0; j < Rows; ++j) {
    function->SetScalarComponentFromDouble(Columns / 3, j, 0, 3, 1.0);
  }
  function->GetPointData()->GetScalars()->Modified();
  CHECK(scene.Picture() != before, "a new column changes nothing");
  property->SetTransferFunctionMode(vtkVolumeProperty::TF_1D);
  property->SetScalarOpacityUnitDistance(1.5);
  CHECK(std::fabs(scene.Light() - plain) < 1e-3 * plain, "one dimension is as before");
}

void BySecondArray()
{
  Scene scene;
  vtkNew<vtkImageData> function;
  FillFunction(function);
  vtkVolumeProperty* property = scene.Volume->GetProperty();
  vtkFloatArray* values = vtkFloatArray::SafeDownCast(scene.Image->GetPointData()->GetScalars());
  vtkNew<vtkFloatArray> second;
  second->SetName("height");
  std::vector<float> pairs;
  for (vtkIdType i = 0; i < values->GetNumberOfValues(); ++i) {
    second->InsertNextValue(static_cast<float>(100.0 + i / (33 * 29) + 3.0 * std::sin(0.2 * (i % 33))));
    pairs.push_back(values->GetValue(i));
    pairs.push_back(second->GetValue(i));
  }
  scene.Image->GetPointData()->AddArray(second);
  property->SetTransferFunctionMode(vtkVolumeProperty::TF_2D);
  property->SetTransferFunction2D(function);
  scene.Mapper->SetTransfer2DYAxisArray("height");
  scene.Mapper->SetSampleDistance(0.1);
  scene.Mapper->AuditOn();
  scene.Render();
  CHECK(scene.Errors->Count == 0, "%s", scene.Errors->Text.c_str());
  CHECK(scene.Mapper->GetDifferingPixels() == 0, "skipping changes the picture");
  double range[2], other[2];
  values->GetRange(range);
  second->GetRange(other);
  const stratus_transfer_2d of = FunctionOf(function, property->GetScalarOpacityUnitDistance(), range, other);
  const double db = ReferencePsnr(scene, [&](reference_scene& s) {
    static stratus_volume volume;
    volume = *s.volume;
    volume.values = pairs.data();
    volume.components = 2;
    volume.value_stride = 2;
    s.volume = &volume;
    s.transfer_2d = &of;
  });
  property->SetScalarOpacityUnitDistance(1.0);
  Expect("value and second array", db, 58.0, BesideVtk(scene, [](vtkOpenGLGPUVolumeRayCastMapper* m) {
    m->SetSampleDistance(1.0f);
    m->SetTransfer2DYAxisArray("height");
  }));
  scene.Mapper->SetTransfer2DYAxisArray("depth");
  scene.Render();
  CHECK(scene.Errors->Has("no array 'depth'") && scene.Errors->Has("height"), "'%s'", scene.Errors->Text.c_str());
}

void Slices()
{
  Scene scene;
  const double center[3] = { 13, 13, 13 };
  vtkNew<vtkPlane> plane;
  vtkNew<vtkSphere> sphere;
  vtkNew<vtkCylinder> cylinder;
  vtkNew<vtkCone> cone;
  vtkNew<vtkQuadric> quadric;
  plane->SetOrigin(center);
  plane->SetNormal(0.2, 0.3, 0.9);
  sphere->SetCenter(center);
  sphere->SetRadius(7.0);
  cylinder->SetCenter(center);
  cylinder->SetAxis(0.3, 0.4, 1.0);
  cylinder->SetRadius(4.0);
  cone->SetAngle(40.0);
  quadric->SetCoefficients(0.5, 1, 0.2, 0.1, 0, 0.1, -14, -26, -6, 160);
  vtkImplicitFunction* const functions[] = { plane, sphere, cylinder, cone, quadric };
  scene.Opacity->RemoveAllPoints();
  scene.Opacity->AddPoint(0.0, 0.1);
  scene.Opacity->AddPoint(0.8, 1.0);
  scene.Mapper->SetBlendModeToSlice();
  for (vtkImplicitFunction* function : functions) {
    scene.Volume->GetProperty()->SetSliceFunction(function);
    const std::vector<float> picture = scene.Picture();
    CHECK(scene.Errors->Count == 0, "%s", scene.Errors->Text.c_str());
    // the reference's surface is VTK's own function, at points along each ray
    const SceneFunctions transfer(scene);
    const stratus_volume volume = ReferenceVolume(
      scene.Image, vtkFloatArray::SafeDownCast(scene.Image->GetPointData()->GetScalars()), false, scene.Volume->GetMatrix());
    const stratus_camera camera = ReferenceCamera(scene.Renderer);
    stratus_ray_cast_options options = stratus_ray_cast_options_default();
    options.mode = STRATUS_MODE_SLICE;
    double origin[3] = { 0, 0, 0 }, x[3], value[4];
    options.slice.constant = function->FunctionValue(origin); // a function of second degree by its values at ten points
    for (int a = 0; a < 3; ++a) {
      for (int side = 0; side < 2; ++side) {
        std::copy_n(origin, 3, x);
        x[a] = side ? 1.0 : -1.0;
        value[side] = function->FunctionValue(x) - options.slice.constant;
      }
      options.slice.square[a] = 0.5 * (value[0] + value[1]);
      options.slice.linear[a] = 0.5 * (value[1] - value[0]);
    }
    for (int a = 0; a < 3; ++a) {
      const int b = (a + 1) % 3;
      std::copy_n(origin, 3, x);
      x[a] = x[b] = 1.0;
      options.slice.square[3 + a] = function->FunctionValue(x) - options.slice.constant - options.slice.square[a] -
        options.slice.square[b] - options.slice.linear[a] - options.slice.linear[b];
    }
    const int* size = scene.Renderer->GetSize();
    std::vector<float> expected(4 * scene.Pixels()), depth(scene.Pixels());
    reference_modes_render(&volume, &transfer.Transfer, &camera, &options, size[0], size[1], 1.0 / 16, expected.data(), depth.data());
    double lit = 0.0;
    for (float v : expected) {
      lit += v;
    }
    CHECK(lit > 100.0, "%s: the reference's picture is all but empty (%g)", function->GetClassName(), lit);
    const double db = picture.empty() ? 0.0 : reference_psnr(picture.data(), expected.data(), scene.Pixels());
    Expect(function->GetClassName(), db, 45.0, function == plane ? BesideVtk(scene) : 0.0); // rims are met in one picture or in both
  }
}

// PSNR against the reference in the renderer's own light, along the camera's direction.
double ClippedPsnr(Scene& scene, vtkPlane* plane, int clipped, double value)
{
  return ReferencePsnr(scene, [&](reference_scene& s) {
    static stratus_shading shading;
    shading = stratus_ray_cast_options_default().light.shading;
    shading.light_count = 1;
    shading.lights[0] = stratus_light();
    for (int a = 0; a < 3; ++a) {
      shading.lights[0].color[a] = 1.0;
      shading.lights[0].vector[a] = -scene.Renderer->GetActiveCamera()->GetDirectionOfProjection()[a];
    }
    s.shading = &shading;
    s.clip_gradients = clipped;
    s.clipped_value = value;
    s.clip_plane_count = 1;
    double* p = s.clip_planes[0];
    plane->GetNormal(p);
    p[3] = -vtkMath::Dot(p, plane->GetOrigin());
  });
}

void ClippedIntensity()
{
  Scene scene;
  vtkNew<vtkPlane> plane;
  plane->SetOrigin(11, 11, 11);
  plane->SetNormal(0.2, 0.3, -0.9);
  scene.Opacity->RemoveAllPoints();
  scene.Opacity->AddPoint(0.1, 0.0);
  scene.Opacity->AddPoint(0.2, 0.9);
  scene.Mapper->AddClippingPlane(plane);
  scene.Mapper->SetSampleDistance(0.05);
  vtkVolumeProperty* property = scene.Volume->GetProperty();
  property->ShadeOn();
  property->SetAmbient(0.1); // as the core's default
  property->SetDiffuse(0.9);
  property->SetSpecular(0.0);
  const double whole = scene.Light(), db_whole = ClippedPsnr(scene, plane, 0, 0.0);
  CHECK(db_whole >= 50.0, "without: %.1f dB", db_whole);
  property->UseClippedVoxelIntensityOn();
  property->SetClippedVoxelIntensity(0.0);
  CHECK(scene.Light() != whole, "the intensity beyond the plane changes nothing");
  CHECK(scene.Errors->Count == 0, "%s", scene.Errors->Text.c_str());
  const double db = ClippedPsnr(scene, plane, 1, 0.0);
  Expect("clipped intensity", db, 50.0, BesideVtk(scene));
  property->SetClippedVoxelIntensity(VTK_DOUBLE_MIN);
  for (float v : scene.Picture()) {
    CHECK(std::isfinite(v), "VTK's default intensity gives %g", v);
  }
}

void Refusals()
{
  vtkNew<vtkImageData> function;
  FillFunction(function);
  const auto off = [](Scene& s) {
    s.Volume->GetProperty()->SetTransferFunctionMode(vtkVolumeProperty::TF_1D);
    s.Mapper->SetBlendModeToComposite();
    s.Mapper->SetSamplingToAuto();
  };
  const auto on = [&](Scene& s) {
    s.Volume->GetProperty()->SetTransferFunctionMode(vtkVolumeProperty::TF_2D);
    s.Volume->GetProperty()->SetTransferFunction2D(function);
  };
  Refused(
    "cells of two variables", "sampling cells",
    [&](Scene& s) {
      on(s);
      s.Mapper->SetSamplingToCells();
    },
    off);
  Refused(
    "an opacity above 1", "outside 0..1",
    [&](Scene& s) {
      on(s);
      function->SetScalarComponentFromDouble(3, 2, 0, 3, 1.5);
      function->Modified();
    },
    off);
  vtkNew<vtkBox> box;
  const auto composite = [](Scene& s) { s.Mapper->SetBlendModeToComposite(); };
  Refused(
    "a box", "vtkBox",
    [&](Scene& s) {
      s.Mapper->SetBlendModeToSlice();
      s.Volume->GetProperty()->SetSliceFunction(box);
    },
    composite);
}
} // namespace

int main()
{
  ByGradient();
  BySecondArray();
  Slices();
  ClippedIntensity();
  Refusals();
  return Failures == 0 ? 0 : 1;
}
