// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusVolumeMapperInternals.h"

#include "vtkCommand.h"
#include "vtkDataArray.h"
#include "vtkImageData.h"
#include "vtkPiecewiseFunction.h"
#include "vtkPlane.h"
#include "vtkPlaneCollection.h"
#include "vtkRenderWindow.h"
#include "vtkRenderer.h"
#include "vtkVolume.h"
#include "vtkVolumeProperty.h"

#include <algorithm>
#include <cmath>

vtkStratusVolumeMapper::Internals::Internals(vtkStratusVolumeMapper* mapper)
    : Mapper(mapper), Context([this](double fraction) { return this->OnProgress(fraction); })
{
  this->Context.OnRelease = [this] {
    stratus_ray_caster_destroy(this->Caster);
    this->Caster = nullptr;
    this->OfferedTo = nullptr; // the next one may come to the same address
    this->FullMilliseconds = 0.0;
  };
}

vtkStratusVolumeMapper::Internals::~Internals()
{
  this->Context.OnRelease();
  this->Context.OnRelease = nullptr; // members that it touches go before the context does
}

bool vtkStratusVolumeMapper::Internals::OnProgress(double fraction)
{
  this->Mapper->InvokeEvent(vtkCommand::VolumeMapperRenderProgressEvent, &fraction);
  vtkRenderWindow* window = this->Renderer ? this->Renderer->GetRenderWindow() : nullptr;
  return window && window->CheckAbortStatus();
}

bool vtkStratusVolumeMapper::Internals::SetDevice(const std::string& device, std::string& error)
{
  return this->Context.Create(device, this->Mapper->NumberOfThreads, error);
}

bool vtkStratusVolumeMapper::Internals::PrepareContext(std::string& error)
{
  const int threads = this->Mapper->NumberOfThreads;
  if ((!this->Context.Get() || this->Context.GetThreads() != threads) && !this->Context.Create(this->Context.GetDevice(), threads, error)) {
    return false;
  }
  if (!this->Caster && stratus_ray_caster_create(this->Context.Get(), &this->Caster) != STRATUS_OK) {
    error = stratus_context_message(this->Context.Get());
    return false;
  }
  return true;
}

// ---------------------------------------------------------------- what is asked for

bool vtkStratusVolumeMapper::Internals::CheckMapper(std::string& error) const
{
  const vtkStratusVolumeMapper* mapper = this->Mapper;
  if (mapper->BlendMode != vtkVolumeMapper::COMPOSITE_BLEND) {
    error = "blend mode " + std::to_string(mapper->BlendMode) + " is not supported, only composite (0) is";
  } else if (mapper->Cropping && mapper->CroppingRegionFlags != VTK_CROP_SUBVOLUME) {
    error = "cropping region flags " + std::to_string(mapper->CroppingRegionFlags) + " are not supported, only the subvolume (" +
      std::to_string(VTK_CROP_SUBVOLUME) + ") is";
  } else if (mapper->FinalColorWindow == 0.0f || !std::isfinite(mapper->FinalColorWindow) || !std::isfinite(mapper->FinalColorLevel)) {
    error = "FinalColorWindow is " + std::to_string(mapper->FinalColorWindow) + " and FinalColorLevel " +
      std::to_string(mapper->FinalColorLevel) + ", they must be finite and the window not 0";
  }
  return error.empty();
}

bool vtkStratusVolumeMapper::Internals::CheckProperty(vtkVolumeProperty* property, std::string& error) const
{
  if (property->GetShade() && !this->IsFirstHit()) {
    error = "shading is not supported, only ShadeOff is (first hits: both are)";
  } else if (property->GetTransferFunctionMode() != vtkVolumeProperty::TF_1D) {
    error = "two-dimensional transfer functions are not supported, only TF_1D is";
  } else if (property->GetNumberOfLabels() > 0) {
    error = "label maps are not supported, only the scalar transfer functions are";
  } else if (property->GetUseClippedVoxelIntensity()) {
    error = "UseClippedVoxelIntensity is not supported, only off is";
  } else if (!property->GetDisableGradientOpacity() && property->HasGradientOpacity()) {
    vtkPiecewiseFunction* gradient = property->GetGradientOpacity();
    for (int n = 0; n < gradient->GetSize(); ++n) {
      double node[4];
      gradient->GetNodeValue(n, node);
      if (node[1] != 1.0) {
        error = "gradient opacity is not supported, only a function that is 1 everywhere, or DisableGradientOpacityOn";
      }
    }
  }
  return error.empty();
}

bool vtkStratusVolumeMapper::Internals::PrepareInput(vtkVolume* prop, std::string& error)
{
  vtkStratusVolumeMapper* mapper = this->Mapper;
  if (mapper->GetNumberOfInputConnections(0) > 0) {
    mapper->GetInputAlgorithm()->Update();
  }
  vtkImageData* image = vtkImageData::SafeDownCast(mapper->GetInput());
  if (!image) {
    error = "there is no input, a vtkImageData is needed";
    return false;
  }
  if (image->GetNumberOfPoints() < 1) {
    error = "the input image is empty, it needs at least one point";
    return false;
  }
  int cells = 0;
  vtkDataArray* array =
    vtkAbstractMapper::GetScalars(image, mapper->ScalarMode, mapper->ArrayAccessMode, mapper->ArrayId, mapper->ArrayName, cells);
  if (!array || cells > 1) {
    const bool named = mapper->ScalarMode > VTK_SCALAR_MODE_USE_CELL_DATA;
    const bool byId = mapper->ArrayAccessMode == VTK_GET_ARRAY_BY_ID;
    error = "there is no scalar array";
    if (named) {
      error += byId ? " number " + std::to_string(mapper->ArrayId) : " '" + std::string(mapper->ArrayName ? mapper->ArrayName : "") + "'";
    }
    error += std::string(" for scalar mode ") + mapper->GetScalarModeAsString() + ": " + vtkStratusArrayNames(image);
    return false;
  }
  return this->Image.Set(image, array, cells == 1, prop->GetMatrix(), error) && this->Transfer.Set(prop->GetProperty(), error);
}

bool vtkStratusVolumeMapper::Internals::SetClipPlanes(stratus_ray_cast_options& options, std::string& error) const
{
  vtkPlaneCollection* planes = this->Mapper->GetClippingPlanes();
  const int count = planes ? planes->GetNumberOfItems() : 0;
  if (count > STRATUS_CLIP_PLANES_MAX) {
    error = std::to_string(count) + " clipping planes are not supported, at most " + std::to_string(STRATUS_CLIP_PLANES_MAX) + " are";
    return false;
  }
  options.clip_plane_count = count;
  for (int p = 0; p < count; ++p) {
    vtkPlane* plane = planes->GetItem(p);
    if (plane->GetTransform()) {
      error = "clipping planes with a transform are not supported, only those of origin and normal";
      return false;
    }
    double normal[3], origin[3];
    plane->GetNormal(normal);
    plane->GetOrigin(origin);
    std::copy(normal, normal + 3, options.clip_planes[p]);
    options.clip_planes[p][3] = -(normal[0] * origin[0] + normal[1] * origin[1] + normal[2] * origin[2]);
  }
  return true;
}

bool vtkStratusVolumeMapper::Internals::SetOptions(vtkVolumeProperty* property, stratus_ray_cast_options& options, std::string& error) const
{
  const vtkStratusVolumeMapper* mapper = this->Mapper;
  options = stratus_ray_cast_options_default();
  options.mode = static_cast<stratus_mode>(mapper->RenderMode);
  options.normals = static_cast<stratus_normals>(mapper->Normals);
  options.structure = static_cast<stratus_structure>(mapper->Structure);
  options.sampling = static_cast<stratus_sampling>(mapper->Sampling);
  options.interpolation =
    property->GetInterpolationType() == VTK_NEAREST_INTERPOLATION ? STRATUS_INTERPOLATION_NEAREST : STRATUS_INTERPOLATION_LINEAR;
  options.sample_distance = mapper->SampleDistance > 0.0 ? mapper->SampleDistance : 0.0;
  options.termination = mapper->Termination;
  options.block_size = mapper->BlockSize;
  options.audit = mapper->Audit ? 1 : 0;
  if (mapper->Cropping) {
    options.crop = 1;
    for (int b = 0; b < 6; ++b) {
      options.crop_bounds[b] = mapper->CroppingRegionPlanes[b] + this->Image.GetCropOffset()[b / 2];
    }
  }
  return this->SetClipPlanes(options, error);
}
