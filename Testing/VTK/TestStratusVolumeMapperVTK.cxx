// SPDX-License-Identifier: BSD-3-Clause
// Calls of programs that use VTK's own mappers: vectors, pictures as images, VTK's meaning of gradient opacity and of components compared
// with VTK's own pictures, and calls that are kept without an effect.
#include "mapper_testing.h"

#include "vtkDoubleArray.h"
#include "vtkFixedPointVolumeRayCastMapper.h"
#include "vtkShortArray.h"
#include "vtkUnsignedShortArray.h"

namespace {
// Three components whose magnitude is twice the scene's field, the second of which is the field.
template <typename Array> vtkSmartPointer<Array> Vectors(vtkImageData* image, double scale, int components = 3)
{
  auto array = vtkSmartPointer<Array>::New();
  vtkDataArray* field = image->GetPointData()->GetArray("density");
  array->SetNumberOfComponents(components);
  array->SetName("vectors");
  array->SetNumberOfTuples(image->GetNumberOfPoints());
  array->Fill(0.0);
  for (vtkIdType i = 0; i < image->GetNumberOfPoints(); ++i) {
    const double value = scale * field->GetComponent(i, 0);
    array->SetComponent(i, 1, value);
    array->SetComponent(i, 2, -std::sqrt(3.0) * value);
  }
  image->GetPointData()->AddArray(array);
  image->GetPointData()->SetActiveScalars("vectors");
  return array;
}

double Worst(const std::vector<float>& a, const std::vector<float>& b)
{
  double worst = a.size() == b.size() && !a.empty() ? 0.0 : 1.0;
  for (size_t i = 0; i < std::min(a.size(), b.size()); ++i) {
    worst = std::max(worst, std::fabs(static_cast<double>(a[i]) - b[i]));
  }
  return worst;
}

void VectorModes()
{
  Scene scene;
  scene.Mapper->SetSampleDistance(0.5);
  scene.Mapper->SetSamplingToMidpoint();
  const std::vector<float> plain = scene.Picture();
  vtkVolumeProperty* property = scene.Volume->GetProperty();
  const vtkSmartPointer<vtkFloatArray> vectors = Vectors<vtkFloatArray>(scene.Image, 1.0, 6); // more than any picture mixes
  scene.Render();
  CHECK(scene.Errors->Count == 1 && scene.Errors->Has("6 components"), "six components: %s", scene.Errors->Text.c_str());
  scene.Mapper->SetVectorMode(vtkStratusVolumeMapper::COMPONENT);
  scene.Mapper->SetVectorComponent(1);
  vtkNew<vtkPiecewiseFunction> none;
  none->AddPoint(0.0, 0.0);
  property->SetScalarOpacity(1, none);
  CHECK(scene.Picture() == plain, "component 1 is another picture than its values by the functions of component 0");
  property->IndependentComponentsOff();
  CHECK(scene.Picture() == plain, "of dependent components, component 1 has other functions than component 0's");
  property->IndependentComponentsOn();
  scene.Mapper->SetVectorComponent(0);
  CHECK(scene.Light() == 0.0, "component 0 is not what it is, zero");
  scene.Mapper->SetVectorComponent(6);
  scene.Render();
  CHECK(scene.Errors->Count == 2 && scene.Errors->Has("VectorComponent is 6, must be 0 to 5"), "%s", scene.Errors->Text.c_str());
  CHECK(scene.Mapper->GetLastImage() == nullptr, "a refused picture is there");
  scene.Mapper->SetVectorComponent(-3);
  CHECK(scene.Mapper->GetVectorComponent() == 0, "component %d", scene.Mapper->GetVectorComponent());

  scene.Mapper->SetVectorMode(vtkStratusVolumeMapper::MAGNITUDE);
  vtkNew<vtkPiecewiseFunction> twice;
  vtkNew<vtkColorTransferFunction> color;
  for (int n = 0; n < scene.Opacity->GetSize(); ++n) {
    double node[4];
    scene.Opacity->GetNodeValue(n, node);
    twice->AddPoint(2.0 * node[0], node[1]);
  }
  for (int n = 0; n < scene.Color->GetSize(); ++n) {
    double node[6];
    scene.Color->GetNodeValue(n, node);
    color->AddRGBPoint(2.0 * node[0], node[1], node[2], node[3]);
  }
  property->SetScalarOpacity(twice);
  property->SetColor(color);
  double worst = Worst(scene.Picture(), plain);
  CHECK(worst < 1e-5, "the magnitude is off by %g", worst);
  const vtkTypeUInt64 builds = scene.Mapper->GetRangeBuilds();
  scene.Render();
  CHECK(scene.Mapper->GetRangeBuilds() == builds, "magnitudes are made with every picture");
  vectors->Fill(0.0);
  vectors->Modified();
  CHECK(scene.Light() == 0.0, "magnitudes stay as they were");

  const vtkSmartPointer<vtkShortArray> whole = Vectors<vtkShortArray>(scene.Image, 10000.0); // magnitudes of integers are not rounded
  for (vtkPiecewiseFunction* function : { twice.Get() }) {
    function->RemoveAllPoints();
    function->AddPoint(2000.0, 0.0);
    function->AddPoint(8000.0, 0.15);
    function->AddPoint(20000.0, 0.5);
  }
  color->RemoveAllPoints();
  color->AddRGBPoint(0.0, 0.1, 0.2, 0.9);
  color->AddRGBPoint(10000.0, 0.9, 0.8, 0.3);
  color->AddRGBPoint(20000.0, 1.0, 0.2, 0.1);
  worst = Worst(scene.Picture(), plain);
  CHECK(worst < 2e-3, "the magnitude of shorts is off by %g", worst);
  scene.Image->GetPointData()->SetActiveScalars("density");
  property->SetScalarOpacity(scene.Opacity);
  property->SetColor(scene.Color);
  CHECK(scene.Picture() == plain, "the magnitude of one component is not that component");
  CHECK(scene.Errors->Count == 2, "%s", scene.Errors->Text.c_str());
}

void MagnitudesOfCells()
{
  Scene scene;
  FillField(scene.Image, true, "density");
  scene.Image->GetPointData()->Initialize();
  scene.Mapper->SetScalarModeToUseCellData();
  const std::vector<float> plain = scene.Picture();
  vtkDataArray* field = scene.Image->GetCellData()->GetScalars();
  vtkNew<vtkDoubleArray> vectors;
  vectors->SetNumberOfComponents(2);
  for (vtkIdType i = 0; i < field->GetNumberOfTuples(); ++i) {
    vectors->InsertNextTuple2(0.6 * field->GetComponent(i, 0), -0.8 * field->GetComponent(i, 0));
  }
  scene.Image->GetCellData()->SetScalars(vectors);
  scene.Mapper->SetVectorMode(vtkStratusVolumeMapper::MAGNITUDE);
  const double worst = Worst(scene.Picture(), plain);
  CHECK(scene.Errors->Count == 0 && worst < 1e-5, "off by %g, %s", worst, scene.Errors->Text.c_str());
  vectors->SetNumberOfTuples(5);
  scene.Render();
  CHECK(scene.Errors->Count == 1 && scene.Errors->Has("5 values"), "too few values: %s", scene.Errors->Text.c_str());
}

void Images()
{
  Scene scene;
  scene.Renderer->SetBackground(0.2, 0.4, 0.6);
  const std::vector<float> plain = scene.Picture();
  const std::vector<unsigned char> window = scene.Bytes();
  scene.Mapper->RenderToImageOn();
  scene.Render();
  const std::vector<unsigned char> empty = scene.Bytes();
  int shown = 0;
  for (size_t i = 0; i < empty.size(); i += 4) {
    shown += empty[i] != 51 || empty[i + 1] != 102 || empty[i + 2] != 153;
  }
  CHECK(shown == 0 && window != empty, "%d pixels of the window show something", shown);
  vtkNew<vtkImageData> colors, depths;
  scene.Mapper->GetColorImage(colors);
  scene.Mapper->GetDepthImage(depths);
  const auto* bytes = static_cast<const unsigned char*>(colors->GetScalarPointer());
  CHECK(bytes && colors->GetScalarType() == VTK_UNSIGNED_CHAR && colors->GetNumberOfScalarComponents() == 4, "colours are bytes");
  CHECK(depths->GetScalarType() == VTK_FLOAT && depths->GetNumberOfScalarComponents() == 1, "depths are floats");
  CHECK(colors->GetDimensions()[0] == scene.Renderer->GetSize()[0] && colors->GetDimensions()[1] == scene.Renderer->GetSize()[1],
    "the image has the viewport's size");
  double worst = 0.0, nearest = 1.0, farthest = 0.0;
  int lit = 0;
  const float* distance = scene.Depth();
  for (size_t p = 0; bytes && p < scene.Pixels(); ++p) {
    for (size_t c = 0; c < 4; ++c) {
      worst = std::max(worst, std::fabs(255.0 * plain[4 * p + c] - bytes[4 * p + c]));
    }
    const double depth = static_cast<const float*>(depths->GetScalarPointer())[p];
    lit += plain[4 * p + 3] > 0.0f;
    CHECK(std::isinf(distance[p]) == (depth == 1.0), "pixel %zu: depth %g, distance %g", p, depth, static_cast<double>(distance[p]));
    if (depth < 1.0) {
      nearest = std::min(nearest, depth);
      farthest = std::max(farthest, depth);
    }
  }
  CHECK(worst <= 0.51 && lit > 1000, "colours are off by %g of 255, %d pixels", worst, lit);
  CHECK(nearest > 0.0 && farthest < 1.0 && nearest < farthest, "depths %g to %g", nearest, farthest);
  scene.Mapper->SetDepthImageScalarTypeToUnsignedShort();
  vtkNew<vtkImageData> shorts;
  scene.Mapper->GetDepthImage(shorts);
  double off = 0.0;
  for (vtkIdType p = 0; p < shorts->GetNumberOfPoints(); ++p) {
    off = std::max(off,
      std::fabs(
        shorts->GetPointData()->GetScalars()->GetComponent(p, 0) - 65535.0 * depths->GetPointData()->GetScalars()->GetComponent(p, 0)));
  }
  CHECK(shorts->GetScalarType() == VTK_UNSIGNED_SHORT && off <= 0.51, "shorts are off by %g", off);
  scene.Mapper->SetDepthImageScalarTypeToUnsignedChar();
  CHECK(scene.Mapper->GetDepthImageScalarType() == VTK_UNSIGNED_CHAR, "type %d", scene.Mapper->GetDepthImageScalarType());
  scene.Mapper->SetDepthImageScalarType(VTK_LONG);
  CHECK(scene.Mapper->GetDepthImageScalarType() == VTK_FLOAT, "type %d", scene.Mapper->GetDepthImageScalarType());
  scene.Mapper->RenderToImageOff();
  scene.Render();
  CHECK(scene.Bytes() == window, "the window shows another picture than before");
  scene.Mapper->SetBlendMode(99);
  scene.Render();
  scene.Mapper->GetColorImage(colors);
  CHECK(colors->GetNumberOfPoints() == 0, "a refused picture has an image");
  scene.Mapper->GetColorImage(nullptr);
}

// A slab of opacity 1 whose gradient opacity is .2 everywhere: as VTK means it, one sample shows a fifth.
void GradientOpacityOfOpacities()
{
  Scene scene(60, 60);
  int warned = 0;
  vtkNew<ErrorObserver> warnings;
  scene.Mapper->AddObserver(vtkCommand::WarningEvent, warnings);
  vtkVolumeProperty* property = scene.Volume->GetProperty();
  vtkNew<vtkPiecewiseFunction> opaque, fifth;
  opaque->AddPoint(0.0, 1.0);
  fifth->AddPoint(0.0, 0.2);
  vtkNew<vtkImageData> slab;
  slab->SetDimensions(20, 20, 2);
  slab->AllocateScalars(VTK_FLOAT, 1);
  std::fill_n(static_cast<float*>(slab->GetScalarPointer()), 800, 1.0f);
  scene.Mapper->SetInputData(slab);
  property->SetScalarOpacity(opaque);
  property->SetScalarOpacityUnitDistance(1.0);
  scene.Look(0, 0);
  scene.Render();
  CHECK(warnings->Count == warned, "a warning without a gradient opacity: %s", warnings->Text.c_str());
  property->SetGradientOpacity(fifth);
  const auto alpha = [&] {
    const std::vector<float> picture = scene.Picture();
    return picture.empty() ? -1.0 : static_cast<double>(picture[4 * (30 * 60 + 30) + 3]);
  };
  double seen = alpha();
  CHECK(seen > 0.999, "by optical depths, opacity 1 shows %g", seen);
  CHECK(warnings->Count == ++warned && warnings->Has("SetGradientOpacityDistance"), "%d warnings", warnings->Count);
  scene.Mapper->SetGradientOpacityDistance(1.0);
  vtkNew<vtkFixedPointVolumeRayCastMapper> fixed;
  seen = alpha();
  CHECK(std::fabs(seen - 0.2) < 2e-3, "over the slab's thickness it shows %g", seen);
  scene.Mapper->SetGradientOpacityDistance(-1.0);
  seen = alpha();
  CHECK(std::fabs(seen - 0.36) < 2e-3, "over half of the spacing it shows %g", seen);
  scene.Mapper->SetGradientOpacityDistance(0.0);
  opaque->AddPoint(2.0, 0.9);
  scene.Render();
  CHECK(warnings->Count == warned, "the warning comes again");
  scene.Mapper->SetGradientOpacityDistance(std::nan(""));
  scene.Render();
  CHECK(scene.Errors->Count == 1 && scene.Errors->Has("GradientOpacityDistance"), "%s", scene.Errors->Text.c_str());
}

// Draws with VTK's fixed point mapper at a step of a quarter of a voxel, and returns the window's mean and largest difference to ours, of
// 255.
double BesideVTK(Scene& scene, double& largest, int blend = vtkVolumeMapper::COMPOSITE_BLEND)
{
  const std::vector<unsigned char> ours = (scene.Render(), scene.Bytes());
  vtkNew<vtkFixedPointVolumeRayCastMapper> fixed;
  fixed->SetInputData(scene.Image);
  fixed->SetBlendMode(blend);
  fixed->SetSampleDistance(0.25f);
  fixed->AutoAdjustSampleDistancesOff();
  fixed->SetImageSampleDistance(1.0f);
  scene.Volume->SetMapper(fixed);
  const std::vector<unsigned char> theirs = (scene.Render(), scene.Bytes());
  scene.Volume->SetMapper(scene.Mapper);
  double sum = 0.0;
  int lit = 0;
  largest = 0.0;
  for (size_t i = 0; i < ours.size(); ++i) {
    const double off = std::abs(static_cast<int>(ours[i]) - static_cast<int>(theirs[i]));
    if (i % 4 < 3 && ours[i] && theirs[i]) { // VTK's picture is stretched by up to .4 pixels, which moves its borders
      ++lit;
      sum += off;
      largest = std::max(largest, off);
    }
  }
  return lit ? sum / lit : 255.0;
}

void ComponentsByTheirShare()
{
  Scene scene(140, 140); // square: VTK's mapper takes another window's aspect in its first picture
  vtkVolumeProperty* property = scene.Volume->GetProperty();
  const std::vector<float> single = scene.Picture();
  vtkNew<vtkFloatArray> three;
  three->SetNumberOfComponents(3);
  for (vtkIdType i = 0; i < scene.Image->GetNumberOfPoints(); ++i) {
    const double value = scene.Image->GetPointData()->GetArray("density")->GetComponent(i, 0);
    three->InsertNextTuple3(value, value, value);
  }
  scene.Image->GetPointData()->SetScalars(three);
  vtkNew<vtkColorTransferFunction> color;
  for (int c = 0; c < 3; ++c) {
    property->SetScalarOpacity(c, scene.Opacity);
    property->SetScalarOpacityUnitDistance(c, 1.5);
    property->SetColor(c, scene.Color);
    property->SetComponentWeight(c, 1.0 / 3.0);
  }
  scene.Mapper->SetSampleDistance(0.25);
  scene.Mapper->SetComponentMixingToMean();
  CHECK(scene.Mapper->GetComponentMixing() == vtkStratusVolumeMapper::MEAN_COMPONENTS, "mixing %d", scene.Mapper->GetComponentMixing());
  const std::vector<float> mean = scene.Picture();
  double alphas[2] = { 0.0, 0.0 };
  for (size_t p = 3; p < mean.size(); p += 4) {
    alphas[0] += single[p];
    alphas[1] += mean[p];
  }
  // a third of the optical depth of each, by their shares a third of the one
  CHECK(alphas[1] < 0.6 * alphas[0] && alphas[1] > 0.3 * alphas[0], "alpha %g of %g", alphas[1], alphas[0]);
  double largest[2];
  const double share = BesideVTK(scene, largest[0]);
  scene.Mapper->SetComponentMixingToAdd();
  const double added = BesideVTK(scene, largest[1]);
  std::printf("compared with VTK's fixed point mapper, of 255: by share %.2f (%.0f at most), added %.2f (%.0f)\n", share, largest[0], added,
    largest[1]);
  CHECK(share < 2.5 && added > 3.0 * share, "by share %g, added %g of 255", share, added);
  CHECK(scene.Errors->Count == 0, "%s", scene.Errors->Text.c_str());
}

// Three fields, of which each has colours of its own, by one value a ray.
void ComponentsOfOneValue()
{
  Scene scene(140, 140); // square: VTK's mapper takes another window's aspect in its first picture
  vtkVolumeProperty* property = scene.Volume->GetProperty();
  vtkNew<vtkUnsignedCharArray> three; // VTK's mapper shifts and scales other types
  three->SetNumberOfComponents(3);
  int n[3];
  scene.Image->GetDimensions(n);
  for (int k = 0; k < n[2]; ++k) {
    for (int j = 0; j < n[1]; ++j) {
      for (int i = 0; i < n[0]; ++i) {
        const double x = i / (n[0] - 1.0), y = j / (n[1] - 1.0), z = k / (n[2] - 1.0);
        three->InsertNextTuple3(255.0 * Field(x, y, z), 255.0 * Field(y, 1.0 - x, z), 255.0 * Field(1.0 - z, y, x));
      }
    }
  }
  scene.Image->GetPointData()->SetScalars(three);
  vtkNew<vtkPiecewiseFunction> opacity;
  opacity->AddPoint(10.0, 0.0);
  opacity->AddPoint(255.0, 0.8);
  vtkNew<vtkColorTransferFunction> colors[3];
  for (int c = 0; c < 3; ++c) {
    colors[c]->AddRGBPoint(0.0, c == 0, c == 1, c == 2);
    colors[c]->AddRGBPoint(255.0, 1.0, c == 1, 0.5);
    property->SetScalarOpacity(c, opacity);
    property->SetColor(c, colors[c]);
    property->SetComponentWeight(c, c == 1 ? 0.5 : 1.0);
  }
  scene.Mapper->SetSampleDistance(0.25);
  for (int blend : { vtkVolumeMapper::MAXIMUM_INTENSITY_BLEND, vtkVolumeMapper::MINIMUM_INTENSITY_BLEND }) {
    double largest;
    scene.Mapper->SetBlendMode(blend);
    opacity->RemoveAllPoints();
    opacity->AddPoint(blend == vtkVolumeMapper::MINIMUM_INTENSITY_BLEND ? 0.0 : 10.0, blend == vtkVolumeMapper::MINIMUM_INTENSITY_BLEND);
    opacity->AddPoint(255.0, 0.8);
    const double off = BesideVTK(scene, largest, blend);
    std::printf("mode %d of three components compared with VTK's: %.2f of 255 in the mean, %.0f at most\n", blend, off, largest);
    CHECK(off < 3.0, "mode %d: %g of 255", blend, off);
  }
  for (int blend : { vtkVolumeMapper::AVERAGE_INTENSITY_BLEND, vtkVolumeMapper::ADDITIVE_BLEND }) {
    scene.Mapper->SetBlendMode(blend);
    CHECK(scene.Light() > 100.0, "mode %d shows nothing", blend);
  }
  CHECK(scene.Errors->Count == 0, "%s", scene.Errors->Text.c_str());
}

// Calls that are kept for programs change no bit of the picture.
void KeptCalls()
{
  Scene scene;
  vtkStratusVolumeMapper* mapper = scene.Mapper;
  const std::vector<float> plain = scene.Picture();
  CHECK(mapper->IsRenderSupported(scene.Window, scene.Volume->GetProperty()) == 1, "the property is supported");
  CHECK(mapper->IsRenderSupported(scene.Window, nullptr) == 0, "no property is not");
  mapper->SetBlendModeToMaximumIntensity();
  scene.Volume->GetProperty()->ShadeOn();
  CHECK(mapper->IsRenderSupported(scene.Window, scene.Volume->GetProperty()) == 1, "what is left out is supported");
  scene.Volume->GetProperty()->ShadeOff();
  mapper->SetBlendModeToSlice();
  CHECK(mapper->IsRenderSupported(scene.Window, scene.Volume->GetProperty()) == 0, "what is refused is not supported");
  mapper->SetBlendModeToComposite();
  CHECK(mapper->GetRequestedRenderMode() == vtkStratusVolumeMapper::DefaultRenderMode, "mode %d", mapper->GetRequestedRenderMode());
  mapper->SetRequestedRenderModeToGPU();
  CHECK(mapper->GetRequestedRenderMode() == vtkStratusVolumeMapper::GPURenderMode, "mode %d", mapper->GetRequestedRenderMode());
  mapper->SetRequestedRenderModeToRayCast();
  mapper->SetRequestedRenderModeToOSPRay();
  mapper->SetRequestedRenderModeToDefault();
  CHECK(mapper->GetLastUsedRenderMode() == vtkStratusVolumeMapper::RayCastRenderMode, "mode %d", mapper->GetLastUsedRenderMode());
  mapper->SetMaxMemoryInBytes(1000);
  mapper->SetMaxMemoryFraction(5.0f);
  CHECK(mapper->GetMaxMemoryInBytes() == 1000 && mapper->GetMaxMemoryFraction() == 1.0f, "memory");
  mapper->SetReportProgress(false);
  mapper->SetInterpolationModeToNearestNeighbor();
  mapper->SetInterpolationModeToLinear();
  mapper->SetInterpolationModeToCubic();
  CHECK(mapper->GetInterpolationMode() == 2, "interpolation %d", mapper->GetInterpolationMode());
  mapper->InteractiveAdjustSampleDistancesOff();
  mapper->SetInteractiveSampleDistance(9.0f);
  mapper->LockSampleDistanceToInputSpacingOn();
  mapper->SetMinimumImageSampleDistance(7.0f);
  mapper->IntermixIntersectingGeometryOff();
  mapper->UseDepthPassOn();
  mapper->SetColorRangeType(1);
  mapper->SetScalarOpacityRangeType(1);
  mapper->SetGradientOpacityRangeType(1);
  mapper->SetMaskBlendFactor(2.0f);
  CHECK(mapper->GetMaskBlendFactor() == 1.0f, "blend factor %g", static_cast<double>(mapper->GetMaskBlendFactor()));
  CHECK(scene.Picture() == plain, "a call that is kept changes the picture");
  mapper->SetMaskBlendFactor(0.5f);
  CHECK(scene.Picture() == plain, "without labels the blend factor changes the picture");
  vtkNew<vtkImageData> map;
  map->SetDimensions(scene.Image->GetDimensions());
  map->AllocateScalars(VTK_UNSIGNED_CHAR, 1);
  std::fill_n(static_cast<unsigned char*>(map->GetScalarPointer()), map->GetNumberOfPoints(), static_cast<unsigned char>(1));
  mapper->SetMaskInput(map);
  mapper->SetMaskTypeToLabelMap();
  CHECK(scene.Errors->Count == 0, "%s", scene.Errors->Text.c_str());
  scene.Render();
  CHECK(scene.Errors->Count == 1 && scene.Errors->Has("MaskBlendFactor"), "%s", scene.Errors->Text.c_str());
}
} // namespace

int main()
{
  VectorModes();
  MagnitudesOfCells();
  Images();
  GradientOpacityOfOpacities();
  ComponentsByTheirShare();
  ComponentsOfOneValue();
  KeptCalls();
  std::printf("%d failures\n", Failures);
  return Failures ? 1 : 0;
}
