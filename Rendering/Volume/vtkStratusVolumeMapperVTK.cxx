// SPDX-License-Identifier: BSD-3-Clause
// Features of vtkStratusVolumeMapper for programs that were written for VTK's own mappers: vectors, frames as images, VTK's definition of
// gradient opacity and a warning where it matters.
#include "vtkStratusVolumeMapperInternals.h"

#include "vtkCellData.h"
#include "vtkDataArray.h"
#include "vtkDataSet.h"
#include "vtkFloatArray.h"
#include "vtkImageData.h"
#include "vtkPiecewiseFunction.h"
#include "vtkPointData.h"
#include "vtkUnsignedShortArray.h"
#include "vtkVolumeProperty.h"

#include <algorithm>
#include <cmath>

// ---------------------------------------------------------------- vectors

int vtkStratusVolumeMapper::Internals::GetVectorComponent(vtkDataArray* array) const
{
  return this->Mapper->VectorMode == COMPONENT && array->GetNumberOfComponents() > 1 ? this->Mapper->VectorComponent : -1;
}

// ---------------------------------------------------------------- pictures as images

namespace {
void Shape(vtkImageData* image, const vtkStratusPicture& picture, int type, int components)
{
  image->SetDimensions(picture.Viewport[2], picture.Viewport[3], 1);
  image->AllocateScalars(type, components);
  image->GetPointData()->GetScalars()->SetName(components == 4 ? "RGBA" : "Depth");
}

// The ray of pixel i of `pixels`, where `rays` cover the part from `first` on; -1: none does.
int Ray(int i, int first, int pixels, int rays)
{
  const int at = i - first;
  return at >= 0 && at < pixels ? static_cast<int>((at + 0.5) * rays / pixels) : -1;
}

// Calls set(pixel, ray) for each pixel of the viewport; ray -1 where the volume has none.
template <typename Function> void ForPixels(const vtkStratusPicture& picture, const Function& set)
{
  for (int j = 0; j < picture.Viewport[3]; ++j) {
    const int row = picture.IsEmpty() ? -1 : Ray(j, picture.Rectangle[1], picture.Rectangle[3], picture.Size[1]);
    for (int i = 0; i < picture.Viewport[2]; ++i) {
      const int column = row < 0 ? -1 : Ray(i, picture.Rectangle[0], picture.Rectangle[2], picture.Size[0]);
      const vtkIdType ray = column < 0 ? -1 : static_cast<vtkIdType>(row) * picture.Size[0] + column;
      set(static_cast<vtkIdType>(j) * picture.Viewport[2] + i, ray);
    }
  }
}
} // namespace

void vtkStratusVolumeMapper::Internals::FillColorImage(vtkImageData* image) const
{
  image->Initialize();
  if (!this->HasPicture) {
    return;
  }
  Shape(image, this->Picture, VTK_UNSIGNED_CHAR, 4);
  auto* bytes = static_cast<unsigned char*>(image->GetScalarPointer());
  ForPixels(this->Picture, [&](vtkIdType pixel, vtkIdType ray) {
    for (vtkIdType c = 0; c < 4; ++c) {
      const float value = ray < 0 ? 0.0f : this->Rgba[static_cast<size_t>(4 * ray + c)];
      bytes[4 * pixel + c] = static_cast<unsigned char>(255.0f * std::min(std::max(value, 0.0f), 1.0f) + 0.5f);
    }
  });
}

void vtkStratusVolumeMapper::Internals::FillDepthImage(vtkImageData* image, int type) const
{
  image->Initialize();
  if (!this->HasPicture) {
    return;
  }
  std::vector<float> depth;
  if (!this->Picture.IsEmpty()) {
    this->Picture.ToWindowDepth(this->Depth, depth);
  }
  Shape(image, this->Picture, type, 1);
  vtkDataArray* array = image->GetPointData()->GetScalars();
  const double scale = type == VTK_FLOAT ? 1.0 : array->GetDataTypeMax(), half = type == VTK_FLOAT ? 0.0 : 0.5;
  ForPixels(this->Picture, [&](vtkIdType pixel, vtkIdType ray) {
    const double value = scale * (ray < 0 ? 1.0f : depth[static_cast<size_t>(ray)]);
    array->SetComponent(pixel, 0, half > 0.0 ? std::floor(value + half) : value);
  });
}

void vtkStratusVolumeMapper::GetColorImage(vtkImageData* image)
{
  if (image) {
    this->Internal->FillColorImage(image);
  }
}

void vtkStratusVolumeMapper::GetDepthImage(vtkImageData* image)
{
  if (image) {
    this->Internal->FillDepthImage(image, this->DepthImageScalarType);
  }
}

void vtkStratusVolumeMapper::SetDepthImageScalarType(int type)
{
  const int taken = type == VTK_UNSIGNED_CHAR || type == VTK_UNSIGNED_SHORT ? type : VTK_FLOAT;
  if (this->DepthImageScalarType != taken) {
    this->DepthImageScalarType = taken;
    this->Modified();
  }
}

int vtkStratusVolumeMapper::IsRenderSupported(vtkRenderWindow*, vtkVolumeProperty* property)
{
  return property && this->Internal->IsSupported(property) ? 1 : 0;
}

// ---------------------------------------------------------------- gradient opacity

namespace {
// A sample's opacity, in 0..1, may be so far from VTK's before a warning says so: 13 of 255.
const double MuchOfOpacity = 0.05;

// The mean spacing along an axis of the grid.
double Spacing(const stratus_volume& volume, int axis)
{
  const double* at = volume.coordinates[axis];
  const int64_t last = volume.cell_centered ? volume.dimensions[axis] : volume.dimensions[axis] - 1; // coordinates are of points
  return at ? (at[last] - at[0]) / static_cast<double>(last) : volume.spacing[axis];
}

// Half of the mean spacing of the world, by which vtkSmartVolumeMapper samples where it chooses itself. length: > 0: a spacing of the data
// that counts in place of the grid's.
double HalfMeanSpacing(const stratus_volume& volume, double length)
{
  double sum = 0.0;
  for (int a = 0; a < 3; ++a) {
    double square = 0.0;
    for (int row = 0; row < 3; ++row) {
      double step = 0.0;
      for (int b = 0; b < 3; ++b) {
        step += volume.matrix[4 * row + b] * volume.direction[3 * b + a] * (length > 0.0 ? length : Spacing(volume, a));
      }
      square += step * step;
    }
    sum += std::sqrt(square);
  }
  return sum / 6.0;
}

// The difference between the two definitions of gradient opacity, in the opacity of a ray segment as long as `units` unit distances.
double Difference(double opacity, double factor, double units)
{
  const double depth = opacity < 1.0 ? -std::log1p(-opacity) * units : 1e30;
  return std::fabs(factor * -std::expm1(-depth) + std::expm1(-factor * depth));
}
} // namespace

double vtkStratusVolumeMapper::Internals::GetGradientOpacityDistance() const
{
  const double distance = this->Mapper->GradientOpacityDistance;
  return distance < 0.0 ? HalfMeanSpacing(this->Image.GetVolume(), this->GradientLength) : distance;
}

// Says once where a picture will differ by much from what VTK's mappers would show, because opacity is high where gradient opacity is low.
void vtkStratusVolumeMapper::Internals::WarnOfGradientOpacity(vtkVolumeProperty* property)
{
  if (this->Warned || this->Mapper->GradientOpacityDistance != 0.0 || this->WarnedOf == property->GetMTime()) {
    return;
  }
  this->WarnedOf = property->GetMTime();
  for (const stratus_transfer& function : this->Functions) {
    const double units = HalfMeanSpacing(this->Image.GetVolume(), this->GradientLength) / function.unit_distance;
    double opacity = 0.0, worst = 0.0, factor = 1.0; // the difference grows with the opacity
    for (size_t o = 0; o < function.opacity_count; ++o) {
      opacity = std::max(opacity, function.opacity[2 * o + 1]);
    }
    for (size_t g = 0; g < function.gradient_count; ++g) {
      const double now = Difference(opacity, function.gradient[2 * g + 1], units);
      factor = now > worst ? function.gradient[2 * g + 1] : factor;
      worst = std::max(worst, now);
    }
    if (worst > MuchOfOpacity) {
      this->Warned = true;
      vtkWarningWithObjectMacro(
        this->Mapper, << "gradient opacity multiplies the optical depth here, and the opacity of a sample in VTK's mappers: at opacity "
                      << opacity << " and gradient opacity " << factor << " a sample of half a voxel differs by " << worst
                      << "; SetGradientOpacityDistance(-1) gives VTK's meaning");
      return;
    }
  }
}
