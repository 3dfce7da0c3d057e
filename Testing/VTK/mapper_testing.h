// SPDX-License-Identifier: BSD-3-Clause
// Helpers of the mapper's tests: a scene of one volume, its picture in floats and in bytes, and the reference's picture of the same scene.
#ifndef mapper_testing_h
#define mapper_testing_h

#include "Testing/support/reference.h"
#include "stratus.h"
#include "vtkStratusVolumeMapper.h"

#include "vtkCamera.h"
#include "vtkCellData.h"
#include "vtkColorTransferFunction.h"
#include "vtkCommand.h"
#include "vtkFloatArray.h"
#include "vtkImageData.h"
#include "vtkMath.h"
#include "vtkMatrix3x3.h"
#include "vtkMatrix4x4.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPiecewiseFunction.h"
#include "vtkPointData.h"
#include "vtkRenderWindow.h"
#include "vtkRenderer.h"
#include "vtkUnsignedCharArray.h"
#include "vtkVolume.h"
#include "vtkVolumeProperty.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <string>
#include <vector>

static int Failures = 0;

// Prints and counts a condition that does not hold, and goes on.
#define CHECK(condition, ...)                                                                                                              \
  do {                                                                                                                                     \
    if (!(condition)) {                                                                                                                    \
      ++Failures;                                                                                                                          \
      std::printf("%s:%d: %s does not hold: ", __FILE__, __LINE__, #condition);                                                            \
      std::printf(__VA_ARGS__);                                                                                                            \
      std::printf("\n");                                                                                                                   \
    }                                                                                                                                      \
  } while (0)

// Counts errors and keeps the last one, so that VTK does not print them.
class ErrorObserver : public vtkCommand
{
public:
  static ErrorObserver* New() { return new ErrorObserver; }
  void Execute(vtkObject*, unsigned long, void* text) override
  {
    ++this->Count;
    this->Text = static_cast<const char*>(text);
  }
  bool Has(const char* word) const { return this->Text.find(word) != std::string::npos; }
  int Count = 0;
  std::string Text;
};

// A smooth, uneven field in 0..1: two blobs in empty space, so that blocks of all kinds occur.
inline float Field(double x, double y, double z)
{
  const auto blob = [&](double cx, double cy, double cz, double radius) {
    const double d = std::sqrt((x - cx) * (x - cx) + (y - cy) * (y - cy) + (z - cz) * (z - cz)) / radius;
    return d < 1.0 ? (1.0 - d * d) * (1.0 - d * d) : 0.0;
  };
  return static_cast<float>(std::min(1.0, blob(0.35, 0.4, 0.45, 0.3) + 0.7 * blob(0.7, 0.6, 0.6, 0.22)));
}

inline void FillField(vtkImageData* image, bool cells, const char* name, double scale = 1.0)
{
  int points[3];
  image->GetDimensions(points);
  const int off = cells ? 1 : 0;
  vtkNew<vtkFloatArray> array;
  array->SetName(name);
  for (int k = 0; k < points[2] - off; ++k) {
    for (int j = 0; j < points[1] - off; ++j) {
      for (int i = 0; i < points[0] - off; ++i) {
        const double half = 0.5 * off;
        array->InsertNextValue(
          static_cast<float>(scale * Field((i + half) / (points[0] - 1), (j + half) / (points[1] - 1), (k + half) / (points[2] - 1))));
      }
    }
  }
  if (cells) {
    image->GetCellData()->SetScalars(array);
  } else {
    image->GetPointData()->SetScalars(array);
  }
}

// A window with one volume of 33 x 29 x 25 points on a black background.
struct Scene {
  explicit Scene(int width = 160, int height = 120)
  {
    this->Image->SetDimensions(33, 29, 25);
    this->Image->SetSpacing(0.9, 1.0, 1.1);
    FillField(this->Image, false, "density");
    this->Opacity->AddPoint(0.1, 0.0);
    this->Opacity->AddPoint(0.4, 0.15);
    this->Opacity->AddPoint(1.0, 0.5);
    this->Color->AddRGBPoint(0.0, 0.1, 0.2, 0.9);
    this->Color->AddRGBPoint(0.5, 0.9, 0.8, 0.3);
    this->Color->AddRGBPoint(1.0, 1.0, 0.2, 0.1);
    vtkVolumeProperty* property = this->Volume->GetProperty();
    property->SetScalarOpacity(this->Opacity);
    property->SetColor(this->Color);
    property->SetInterpolationTypeToLinear();
    property->SetScalarOpacityUnitDistance(1.5);
    this->Mapper->SetInputData(this->Image);
    this->Mapper->SetDevice("host");
    this->Volume->SetMapper(this->Mapper);
    this->Mapper->AddObserver(vtkCommand::ErrorEvent, this->Errors);
    this->Renderer->AddViewProp(this->Volume);
    this->Window->SetMultiSamples(0);
    this->Window->SetSize(width, height);
    this->Window->AddRenderer(this->Renderer);
    this->Look(35, 20);
  }

  void Look(double azimuth, double elevation)
  {
    vtkCamera* camera = this->Renderer->GetActiveCamera();
    camera->SetPosition(0, 0, 1);
    camera->SetFocalPoint(0, 0, 0);
    camera->SetViewUp(0, 1, 0);
    camera->Azimuth(azimuth);
    camera->Elevation(elevation);
    this->Renderer->ResetCamera();
    camera->Zoom(1.3);
  }

  void Render()
  {
    this->Window->Render();
    this->Window->WaitForCompletion();
  }

  const float* Rgba()
  {
    vtkImageData* image = this->Mapper->GetLastImage();
    return image ? vtkFloatArray::SafeDownCast(image->GetPointData()->GetArray("RGBA"))->GetPointer(0) : nullptr;
  }
  const float* Depth()
  {
    vtkImageData* image = this->Mapper->GetLastImage();
    return image ? vtkFloatArray::SafeDownCast(image->GetPointData()->GetArray("Depth"))->GetPointer(0) : nullptr;
  }
  // Draws and returns a copy of the picture, which the next picture does not overwrite.
  std::vector<float> Picture()
  {
    this->Render();
    std::vector<float> picture;
    if (const float* rgba = this->Rgba()) {
      picture.assign(rgba, rgba + 4 * this->Pixels());
    }
    return picture;
  }
  size_t Pixels() { return static_cast<size_t>(this->Renderer->GetSize()[0]) * static_cast<size_t>(this->Renderer->GetSize()[1]); }
  double Light()
  {
    double sum = 0.0;
    for (float value : this->Picture()) {
      sum += value;
    }
    return sum;
  }

  // Returns the bytes that the window shows in the renderer's viewport.
  std::vector<unsigned char> Bytes()
  {
    const int* origin = this->Renderer->GetOrigin();
    const int* size = this->Renderer->GetSize();
    vtkNew<vtkUnsignedCharArray> pixels;
    this->Window->GetRGBACharPixelData(origin[0], origin[1], origin[0] + size[0] - 1, origin[1] + size[1] - 1, 1, pixels);
    return std::vector<unsigned char>(pixels->GetPointer(0), pixels->GetPointer(0) + pixels->GetNumberOfValues());
  }

  // Returns the largest difference, in 1/255, between the float picture over `background` and the window.
  double ShownError(const double background[3])
  {
    const std::vector<unsigned char> bytes = this->Bytes();
    const float* rgba = this->Rgba();
    double worst = rgba ? 0.0 : 255.0;
    for (size_t p = 0; rgba && p < this->Pixels(); ++p) {
      for (size_t c = 0; c < 3; ++c) {
        const double meant = rgba[4 * p + c] + (1.0 - rgba[4 * p + 3]) * background[c];
        worst = std::max(worst, std::fabs(255.0 * meant - bytes[4 * p + c]));
      }
    }
    return worst;
  }

  vtkNew<vtkImageData> Image;
  vtkNew<vtkPiecewiseFunction> Opacity;
  vtkNew<vtkColorTransferFunction> Color;
  vtkNew<vtkStratusVolumeMapper> Mapper;
  vtkNew<vtkVolume> Volume;
  vtkNew<vtkRenderer> Renderer;
  vtkNew<vtkRenderWindow> Window;
  vtkNew<ErrorObserver> Errors;
};

// Computes the window's rays only from VTK's composite matrix, which the mapper does not use.
inline stratus_camera ReferenceCamera(vtkRenderer* renderer)
{
  vtkCamera* active = renderer->GetActiveCamera();
  vtkNew<vtkMatrix4x4> inverse;
  inverse->DeepCopy(active->GetCompositeProjectionTransformMatrix(renderer->GetTiledAspectRatio(), -1, 1));
  inverse->Invert();
  const auto point = [&](double u, double v, double z, double result[3]) {
    const double window[4] = { u, v, z, 1 };
    double world[4];
    inverse->MultiplyPoint(window, world);
    for (int a = 0; a < 3; ++a) {
      result[a] = world[a] / world[3];
    }
  };
  double nearCenter[3], farCenter[3], right[3], up[3], farRight[3], normal[3];
  point(0, 0, -1, nearCenter);
  point(0, 0, 1, farCenter);
  point(1, 0, -1, right);
  point(0, 1, -1, up);
  point(1, 0, 1, farRight);
  double along[3];
  for (int a = 0; a < 3; ++a) {
    right[a] -= nearCenter[a];
    up[a] -= nearCenter[a];
    farRight[a] -= farCenter[a];
    along[a] = farCenter[a] - nearCenter[a];
  }
  vtkMath::Cross(up, right, normal);
  vtkMath::Normalize(normal);
  const double between = vtkMath::Dot(along, normal); // the near and far planes
  stratus_camera camera = stratus_camera();
  camera.parallel = active->GetParallelProjection();
  // The planes' distances from the eye are proportional to their widths.
  const double ratio = vtkMath::Norm(right) / vtkMath::Norm(farRight);
  camera.near_k = between * ratio / (1.0 - ratio);
  if (camera.parallel) {
    const double* position = active->GetPosition();
    camera.near_k = 0.0;
    for (int a = 0; a < 3; ++a) {
      camera.near_k += (nearCenter[a] - position[a]) * normal[a];
    }
  }
  camera.far_k = camera.near_k + between;
  for (int a = 0; a < 3; ++a) {
    camera.forward[a] = along[a] / between;
    camera.eye[a] = nearCenter[a] - camera.near_k * camera.forward[a];
    const double scale = camera.parallel ? 1.0 : 1.0 / camera.near_k;
    camera.right[a] = right[a] * scale;
    camera.up[a] = up[a] * scale;
  }
  return camera;
}

inline stratus_volume ReferenceVolume(vtkImageData* image, vtkFloatArray* values, bool cells, vtkMatrix4x4* matrix)
{
  stratus_volume volume = stratus_volume_default();
  volume.values = values->GetPointer(0);
  volume.type = STRATUS_FLOAT32;
  volume.cell_centered = cells ? 1 : 0;
  int points[3], extent[6];
  image->GetDimensions(points);
  image->GetExtent(extent);
  image->GetSpacing(volume.spacing);
  // VTK itself finds the position of the first point.
  image->TransformIndexToPhysicalPoint(extent[0], extent[2], extent[4], volume.origin);
  std::copy_n(image->GetDirectionMatrix()->GetData(), 9, volume.direction);
  std::copy_n(&matrix->Element[0][0], 16, volume.matrix);
  for (int a = 0; a < 3; ++a) {
    volume.dimensions[a] = points[a] - (cells ? 1 : 0);
  }
  return volume;
}

// The functions of a scene's property in the core's terms.
struct SceneFunctions {
  explicit SceneFunctions(Scene& scene)
  {
    for (int n = 0; n < scene.Opacity->GetSize(); ++n) {
      double node[4];
      scene.Opacity->GetNodeValue(n, node);
      this->Opacity.insert(this->Opacity.end(), node, node + 2);
    }
    for (int n = 0; n < scene.Color->GetSize(); ++n) {
      double node[6];
      scene.Color->GetNodeValue(n, node);
      this->Color.insert(this->Color.end(), node, node + 4);
    }
    this->Transfer.opacity = this->Opacity.data();
    this->Transfer.opacity_count = this->Opacity.size() / 2;
    this->Transfer.color = this->Color.data();
    this->Transfer.color_count = this->Color.size() / 4;
    this->Transfer.unit_distance = scene.Volume->GetProperty()->GetScalarOpacityUnitDistance();
  }
  std::vector<double> Opacity, Color;
  stratus_transfer Transfer = stratus_transfer_default();
};

// Returns the PSNR in dB of the scene's float picture against the reference at 1/16 voxel. `more` may add cropping, planes, opaque depth.
inline double ReferencePsnr(Scene& scene, const std::function<void(reference_scene&)>& more = nullptr, vtkFloatArray* cellValues = nullptr)
{
  const SceneFunctions functions(scene);
  vtkFloatArray* values = cellValues ? cellValues : vtkFloatArray::SafeDownCast(scene.Image->GetPointData()->GetScalars());
  const stratus_volume volume = ReferenceVolume(scene.Image, values, cellValues != nullptr, scene.Volume->GetMatrix());
  const stratus_camera camera = ReferenceCamera(scene.Renderer);
  reference_scene reference = reference_scene();
  reference.volume = &volume;
  reference.transfer = &functions.Transfer;
  reference.camera = &camera;
  reference.interpolation = scene.Volume->GetProperty()->GetInterpolationType() == VTK_NEAREST_INTERPOLATION ? STRATUS_INTERPOLATION_NEAREST
                                                                                                             : STRATUS_INTERPOLATION_LINEAR;
  if (more) {
    more(reference);
  }
  std::vector<float> rgba(4 * scene.Pixels());
  const int* size = scene.Renderer->GetSize();
  if (reference_render(&reference, size[0], size[1], 1.0 / 16, rgba.data(), nullptr) != 0 || !scene.Rgba()) {
    return -1.0;
  }
  double lit = 0.0;
  for (float value : rgba) {
    lit += value;
  }
  CHECK(lit > 100.0, "the reference's picture is all but empty, which would prove nothing (%g)", lit);
  return reference_psnr(scene.Rgba(), rgba.data(), scene.Pixels());
}

#endif
