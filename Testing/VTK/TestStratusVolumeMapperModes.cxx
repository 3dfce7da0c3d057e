// SPDX-License-Identifier: BSD-3-Clause
// Blend modes, crop regions, masks and jitter in the window, compared with the double reference and, for an estimate of their agreement,
// with VTK's own GPU mapper. Every setter shows in the picture.
#include "mapper_testing.h"

#include "Testing/support/reference_modes.h"

#include "vtkContourValues.h"
#include "vtkOpenGLGPUVolumeRayCastMapper.h"
#include "vtkPlane.h"

#include <limits>

namespace {
// Returns the reference's picture with `options`.
std::vector<float> Expected(Scene& scene, const stratus_ray_cast_options& options)
{
  const SceneFunctions functions(scene);
  vtkFloatArray* values = vtkFloatArray::SafeDownCast(scene.Image->GetPointData()->GetScalars());
  const stratus_volume volume = ReferenceVolume(scene.Image, values, false, scene.Volume->GetMatrix());
  const stratus_camera camera = ReferenceCamera(scene.Renderer);
  const int* size = scene.Renderer->GetSize();
  std::vector<float> rgba(4 * scene.Pixels()), depth(scene.Pixels());
  reference_modes_render(&volume, &functions.Transfer, &camera, &options, size[0], size[1], 1.0 / 16, rgba.data(), depth.data());
  return rgba;
}

// PSNR of what VTK's mapper shows over black, in 8 bits, against the same.
double VtkPsnr(Scene& scene, const std::vector<float>& expected)
{
  vtkNew<vtkOpenGLGPUVolumeRayCastMapper> mapper;
  mapper->SetInputData(scene.Image);
  mapper->SetBlendMode(scene.Mapper->GetBlendMode());
  mapper->SetAverageIPScalarRange(scene.Mapper->GetAverageIPScalarRange());
  mapper->SetCropping(scene.Mapper->GetCropping());
  mapper->SetCroppingRegionPlanes(scene.Mapper->GetCroppingRegionPlanes());
  mapper->SetCroppingRegionFlags(scene.Mapper->GetCroppingRegionFlags());
  mapper->SetMaskInput(scene.Mapper->GetMaskInput());
  mapper->SetMaskTypeToBinary();
  mapper->AutoAdjustSampleDistancesOff();
  mapper->SetSampleDistance(0.1f);
  scene.Volume->SetMapper(mapper);
  scene.Render();
  const std::vector<unsigned char> bytes = scene.Bytes();
  scene.Volume->SetMapper(scene.Mapper);
  std::vector<float> shown(4 * scene.Pixels());
  for (size_t p = 0; p < scene.Pixels(); ++p) {
    for (size_t c = 0; c < 3; ++c) {
      shown[4 * p + c] = bytes[4 * p + c] / 255.0f;
    }
    shown[4 * p + 3] = expected[4 * p + 3]; // the window keeps no alpha of the volume's
  }
  return reference_psnr(shown.data(), expected.data(), scene.Pixels());
}

// least_db: limit in dB for samples every tenth of a voxel. At their rims, surfaces are wholly right or wrong.
void Against(const char* what, Scene& scene, const stratus_ray_cast_options& options, double least_db)
{
  scene.Mapper->SetSampleDistance(0.1);
  const std::vector<float> picture = scene.Picture(), expected = Expected(scene, options);
  CHECK(scene.Errors->Count == 0, "%s: %s", what, scene.Errors->Text.c_str());
  CHECK(!picture.empty(), "%s: no picture", what);
  double lit = 0.0;
  for (float value : expected) {
    lit += value;
  }
  CHECK(lit > 10.0, "%s: the reference's picture is all but empty (%g)", what, lit);
  const double db = picture.empty() ? 0.0 : reference_psnr(picture.data(), expected.data(), scene.Pixels());
  CHECK(db >= least_db, "%s: %.1f dB", what, db);
  std::printf("%-24s %.1f dB; vtkOpenGLGPUVolumeRayCastMapper, in 8 bits: %.1f dB\n", what, db, VtkPsnr(scene, expected));
}

void BlendModes()
{
  const std::pair<int, stratus_mode> modes[] = { { vtkVolumeMapper::MAXIMUM_INTENSITY_BLEND, STRATUS_MODE_MAXIMUM },
    { vtkVolumeMapper::MINIMUM_INTENSITY_BLEND, STRATUS_MODE_MINIMUM }, { vtkVolumeMapper::AVERAGE_INTENSITY_BLEND, STRATUS_MODE_AVERAGE },
    { vtkVolumeMapper::ADDITIVE_BLEND, STRATUS_MODE_ADDITIVE }, { vtkVolumeMapper::ISOSURFACE_BLEND, STRATUS_MODE_ISOSURFACE } };
  for (const auto& mode : modes) {
    Scene scene;
    if (mode.second == STRATUS_MODE_MINIMUM) { // of two blobs on nothing it is nothing everywhere: of two holes it is not
      vtkFloatArray* values = vtkFloatArray::SafeDownCast(scene.Image->GetPointData()->GetScalars());
      for (vtkIdType i = 0; i < values->GetNumberOfValues(); ++i) {
        values->SetValue(i, 1.0f - values->GetValue(i));
      }
    }
    stratus_ray_cast_options options = stratus_ray_cast_options_default();
    options.mode = mode.second;
    const double contours[3] = { 0.6, 0.2, 0.35 };
    options.optics.contour_count = 3;
    std::copy_n(contours, 3, options.optics.contours);
    for (int n = 0; n < 3; ++n) {
      scene.Volume->GetProperty()->GetIsoSurfaceValues()->SetValue(n, contours[n]);
    }
    scene.Mapper->SetBlendMode(mode.first);
    Against(stratus_mode_name(mode.second), scene, options, mode.second == STRATUS_MODE_ISOSURFACE ? 35.0 : 55.0);
    scene.Mapper->AuditOn();
    scene.Render();
    CHECK(scene.Mapper->GetDifferingPixels() == 0, "%s: skipping changes the picture", stratus_mode_name(mode.second));
  }
}

// Bytes of red, green, blue and what opacity is of, in every mode.
void DependentComponents()
{
  const std::pair<int, stratus_mode> modes[] = { { vtkVolumeMapper::MAXIMUM_INTENSITY_BLEND, STRATUS_MODE_MAXIMUM },
    { vtkVolumeMapper::MINIMUM_INTENSITY_BLEND, STRATUS_MODE_MINIMUM }, { vtkVolumeMapper::AVERAGE_INTENSITY_BLEND, STRATUS_MODE_AVERAGE },
    { vtkVolumeMapper::ADDITIVE_BLEND, STRATUS_MODE_ADDITIVE }, { vtkVolumeMapper::ISOSURFACE_BLEND, STRATUS_MODE_ISOSURFACE },
    { vtkVolumeMapper::SLICE_BLEND, STRATUS_MODE_SLICE } };
  for (const auto& mode : modes) {
    Scene scene;
    vtkNew<vtkUnsignedCharArray> bytes;
    const vtkSmartPointer<vtkFloatArray> field = vtkFloatArray::SafeDownCast(scene.Image->GetPointData()->GetScalars());
    bytes->SetNumberOfComponents(4);
    for (vtkIdType i = 0; i < field->GetNumberOfValues(); ++i) {
      const double value = mode.second == STRATUS_MODE_MINIMUM ? 1.0 - field->GetValue(i) : field->GetValue(i);
      bytes->InsertNextTuple4(
        7.0 * static_cast<double>(i % 33), 255.0 - 200.0 * value, 30.0 + 5.0 * static_cast<double>(i / 33 % 29), 250.0 * value);
    }
    scene.Image->GetPointData()->SetScalars(bytes);
    scene.Opacity->RemoveAllPoints();
    scene.Opacity->AddPoint(10.0, 0.1);
    scene.Opacity->AddPoint(255.0, 0.8);
    stratus_ray_cast_options options = stratus_ray_cast_options_default();
    options.mode = mode.second;
    options.optics.dependent = 1;
    options.optics.contour_count = 1;
    options.optics.contours[0] = 60.0;
    options.slice.linear[0] = options.slice.linear[1] = options.slice.linear[2] = 1.0;
    std::fill_n(options.slice.center, 3, 13.0);
    vtkNew<vtkPlane> plane;
    plane->SetOrigin(options.slice.center);
    plane->SetNormal(options.slice.linear);
    scene.Volume->GetProperty()->GetIsoSurfaceValues()->SetValue(0, 60.0);
    scene.Volume->GetProperty()->SetSliceFunction(plane);
    scene.Volume->GetProperty()->IndependentComponentsOff();
    scene.Mapper->SetBlendMode(mode.first);
    scene.Mapper->SetSampleDistance(0.1);
    const std::vector<float> picture = scene.Picture();
    const SceneFunctions functions(scene);
    stratus_volume volume = ReferenceVolume(scene.Image, field, false, scene.Volume->GetMatrix());
    volume.values = bytes->GetPointer(0);
    volume.type = STRATUS_UINT8;
    volume.components = 4;
    volume.value_stride = 4;
    const stratus_camera camera = ReferenceCamera(scene.Renderer);
    const int* size = scene.Renderer->GetSize();
    std::vector<float> expected(4 * scene.Pixels()), depth(scene.Pixels());
    reference_modes_render(&volume, &functions.Transfer, &camera, &options, size[0], size[1], 1.0 / 16, expected.data(), depth.data());
    CHECK(scene.Errors->Count == 0, "%s: %s", stratus_mode_name(mode.second), scene.Errors->Text.c_str());
    const double db = picture.empty() ? 0.0 : reference_psnr(picture.data(), expected.data(), scene.Pixels());
    std::printf("%-24s %.1f dB\n", (std::string("RGBA, ") + stratus_mode_name(mode.second)).c_str(), db);
    // where two samples are almost equally extreme, either has the colour
    CHECK(db >= 50.0, "RGBA, %s: %.1f dB", stratus_mode_name(mode.second), db);
    scene.Mapper->AuditOn();
    scene.Render();
    CHECK(scene.Mapper->GetDifferingPixels() == 0, "RGBA, %s: skipping changes the picture", stratus_mode_name(mode.second));
  }
}

void AverageRange()
{
  Scene scene;
  stratus_ray_cast_options options = stratus_ray_cast_options_default();
  options.mode = STRATUS_MODE_AVERAGE;
  options.optics.average_range[0] = 0.3;
  options.optics.average_range[1] = 0.6;
  scene.Mapper->SetBlendModeToAverageIntensity();
  const double all = scene.Light();
  scene.Mapper->SetAverageIPScalarRange(0.3, 0.6);
  CHECK(scene.Light() != all, "the range of values that count changes nothing");
  Against("average of 0.3..0.6", scene, options, 40.0); // where the range begins, some samples count or don't
}

void Contours()
{
  Scene scene;
  vtkContourValues* contours = scene.Volume->GetProperty()->GetIsoSurfaceValues();
  scene.Mapper->SetBlendModeToIsoSurface();
  contours->SetValue(0, 0.5);
  const double one = scene.Light();
  contours->SetValue(1, 0.2);
  CHECK(scene.Light() > one, "a second surface adds nothing");
  contours->SetNumberOfContours(17);
  scene.Render();
  CHECK(scene.Errors->Count == 1 && scene.Errors->Has("17 isosurface values"), "17 contours: '%s'", scene.Errors->Text.c_str());
  contours->SetNumberOfContours(0);
  scene.Render();
  CHECK(scene.Errors->Has("0 contour values"), "no contours: '%s'", scene.Errors->Text.c_str());
  contours->SetNumberOfContours(1);
  scene.Volume->GetProperty()->SetInterpolationTypeToNearest();
  scene.Render();
  CHECK(scene.Errors->Has("nearest"), "nearest: '%s'", scene.Errors->Text.c_str());
}

void CropRegions()
{
  const std::pair<int, const char*> sets[] = { { VTK_CROP_SUBVOLUME, "subvolume" }, { VTK_CROP_FENCE, "fence" },
    { VTK_CROP_INVERTED_FENCE, "inverted fence" }, { VTK_CROP_CROSS, "cross" }, { VTK_CROP_INVERTED_CROSS, "inverted cross" },
    { 1 << 12, "region 12" }, { 1 << 14, "region 14" }, { 1 << 10, "region 10" }, { 1 << 16, "region 16" } };
  for (const auto& set : sets) {
    Scene scene;
    stratus_ray_cast_options options = stratus_ray_cast_options_default();
    options.clipping.crop = 1;
    options.clipping.crop_regions = static_cast<uint32_t>(set.first);
    double planes[6];
    scene.Image->GetBounds(planes);
    for (int a = 0; a < 3; ++a) {
      const double low = planes[2 * a], width = planes[2 * a + 1] - low;
      planes[2 * a] = options.clipping.crop_bounds[2 * a] = low + 0.35 * width;
      planes[2 * a + 1] = options.clipping.crop_bounds[2 * a + 1] = low + 0.6 * width;
    }
    scene.Mapper->CroppingOn();
    scene.Mapper->SetCroppingRegionPlanes(planes);
    scene.Mapper->SetCroppingRegionFlags(set.first);
    Against(set.second, scene, options, 48.0);
  }
  Scene none;
  none.Mapper->CroppingOn();
  none.Mapper->SetCroppingRegionFlags(0);
  CHECK(none.Light() == 0.0 && none.Errors->Count == 0, "no region shown, and yet something is");
}

void Masks()
{
  Scene scene;
  vtkNew<vtkImageData> mask;
  mask->CopyStructure(scene.Image);
  mask->AllocateScalars(VTK_UNSIGNED_CHAR, 1);
  unsigned char* bytes = static_cast<unsigned char*>(mask->GetScalarPointer());
  for (vtkIdType i = 0; i < mask->GetNumberOfPoints(); ++i) {
    bytes[i] = i % 33 < 16 || i / 33 % 29 > 20 ? 255 : 0;
  }
  const double whole = scene.Light();
  scene.Mapper->SetMaskInput(mask);
  CHECK(scene.Mapper->GetMaskInput() == mask, "the mask is another");
  stratus_ray_cast_options options = stratus_ray_cast_options_default();
  options.mask.bytes = bytes;
  scene.Mapper->SetSamplingToMidpoint();
  Against("binary mask", scene, options, 40.0);
  const double masked = scene.Light();
  CHECK(masked > 0.0 && masked < whole, "the mask takes nothing out");
  std::fill_n(bytes, mask->GetNumberOfPoints(), static_cast<unsigned char>(0));
  mask->Modified();
  CHECK(scene.Light() == 0.0, "the mask has changed, the picture not");
  CHECK(scene.Errors->Count == 0, "binary masks: '%s'", scene.Errors->Text.c_str());
  vtkNew<vtkImageData> small;
  small->SetDimensions(5, 5, 5);
  small->AllocateScalars(VTK_UNSIGNED_CHAR, 1);
  scene.Mapper->SetMaskInput(small);
  scene.Render();
  CHECK(scene.Errors->Has("5 x 5 x 5"), "another size: '%s'", scene.Errors->Text.c_str());
  small->AllocateScalars(VTK_FLOAT, 1);
  scene.Mapper->SetSampleDistance(0.2); // so that the error is reported again
  scene.Render();
  CHECK(scene.Errors->Has("unsigned char"), "floats: '%s'", scene.Errors->Text.c_str());
  scene.Mapper->SetMaskInput(nullptr);
  CHECK(scene.Light() > 0.9 * whole, "without mask nothing is drawn");
}

// Of solid voxels the middle region and those that a mask keeps can be shown; other regions are refused, and nothing is drawn.
void FirstHits()
{
  Scene scene(64, 48);
  scene.Mapper->SetRenderModeToFirstHit();
  const double whole = scene.Light();
  double planes[6];
  scene.Image->GetBounds(planes);
  planes[0] = 0.4 * planes[1];
  scene.Mapper->CroppingOn();
  scene.Mapper->SetCroppingRegionPlanes(planes);
  scene.Mapper->SetCroppingRegionFlagsToSubVolume();
  const double part = scene.Light();
  CHECK(part > 0.1 * whole && part < 0.9 * whole && scene.Errors->Count == 0, "cropped first hits: %g of %g, '%s'", part, whole,
    scene.Errors->Text.c_str());
  scene.Mapper->SetCroppingRegionFlagsToFence();
  CHECK(
    scene.Picture().empty() && scene.Errors->Count == 1 && scene.Errors->Has("crop regions"), "a fence: '%s'", scene.Errors->Text.c_str());
  scene.Mapper->CroppingOff();
  vtkNew<vtkImageData> mask;
  mask->CopyStructure(scene.Image);
  mask->AllocateScalars(VTK_UNSIGNED_CHAR, 1);
  const vtkSmartPointer<vtkFloatArray> values = vtkFloatArray::SafeDownCast(scene.Image->GetPointData()->GetScalars());
  vtkNew<vtkFloatArray> cleared;
  cleared->DeepCopy(values);
  for (vtkIdType i = 0; i < mask->GetNumberOfPoints(); ++i) {
    const bool keeps = i % 33 < 14 || i / 33 % 29 > 16;
    static_cast<unsigned char*>(mask->GetScalarPointer())[i] = keeps ? 1 : 0;
    cleared->SetValue(i, keeps ? values->GetValue(i) : 0.0f); // of opacity 0
  }
  scene.Mapper->SetMaskInput(mask);
  const std::vector<float> masked = scene.Picture();
  scene.Mapper->SetMaskInput(nullptr);
  scene.Image->GetPointData()->SetScalars(cleared);
  CHECK(scene.Picture() == masked && scene.Errors->Count == 1, "masked first hits are not those of voxels without opacity: '%s'",
    scene.Errors->Text.c_str());
  const double left = scene.Light();
  CHECK(left > 0.1 * whole && left < 0.95 * whole, "the mask hides nothing, or all: %g of %g", left, whole);
  scene.Image->GetPointData()->SetScalars(values);
  CHECK(scene.Light() == whole, "first hits after what was refused are others");
}

void Jitter()
{
  Scene scene;
  scene.Mapper->SetSamplingToMidpoint(); // an automatic rule may be cells, which have no samples that jitter moves
  scene.Mapper->SetSampleDistance(1.5);
  CHECK(!scene.Mapper->GetUseJittering() && scene.Mapper->GetJitterSeed() == 0, "defaults");
  const std::vector<float> plain = scene.Picture();
  scene.Mapper->UseJitteringOn();
  const std::vector<float> noisy = scene.Picture();
  CHECK(noisy != plain, "jitter changes nothing");
  scene.Mapper->SetNumberOfThreads(3);
  CHECK(scene.Picture() == noisy, "jitter depends on the number of threads");
  scene.Mapper->SetJitterSeed(7);
  CHECK(scene.Picture() != noisy, "the seed changes nothing");
  scene.Mapper->UseJitteringOff();
  CHECK(scene.Picture() == plain, "jitter off is not as before");
}
} // namespace

int main()
{
  BlendModes();
  DependentComponents();
  AverageRange();
  Contours();
  CropRegions();
  Masks();
  FirstHits();
  Jitter();
  return Failures ? 1 : 0;
}
