// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusVolumeMapperInternals.h"

#include "vtkStratusSlice.h"

#include "vtkCommand.h"
#include "vtkContourValues.h"
#include "vtkDataArray.h"
#include "vtkImageData.h"
#include "vtkImplicitFunction.h"
#include "vtkPiecewiseFunction.h"
#include "vtkPointData.h"
#include "vtkRenderWindow.h"
#include "vtkRenderer.h"
#include "vtkShaderProperty.h"
#include "vtkVolume.h"
#include "vtkVolumeProperty.h"

#include <algorithm>
#include <cmath>
#include <sstream>

vtkStratusVolumeMapper::Internals::Internals(vtkStratusVolumeMapper* mapper)
    : Mapper(mapper), Context([this](double fraction) { return this->OnProgress(fraction); })
{
  this->Report.expected_error = std::nan("");
  this->Report.tolerance_met = 1;
  this->Context.OnRelease = [this] {
    stratus_ray_caster_destroy(this->Caster);
    stratus_path_tracer_destroy(this->Tracer);
    this->ReleaseCoarse();
    this->Caster = nullptr;
    this->Tracer = nullptr;
    this->PathReport = stratus_path_report();
    this->OfferedTo = nullptr; // the next caster may get the same address
    this->FullMilliseconds = 0.0;
  };
}

vtkStratusVolumeMapper::Internals::~Internals()
{
  this->Context.OnRelease();
  this->Context.OnRelease = nullptr; // members that it uses are destroyed before the context
}

bool vtkStratusVolumeMapper::Internals::OnProgress(double fraction)
{
  this->Mapper->InvokeEvent(vtkCommand::VolumeMapperRenderProgressEvent, &fraction);
  vtkRenderWindow* window = this->Renderer ? this->Renderer->GetRenderWindow() : nullptr;
  return window && window->CheckAbortStatus();
}

bool vtkStratusVolumeMapper::Internals::PrepareContext(std::string& error)
{
  if (!this->Context.Prepare(this->Mapper->NumberOfThreads, error)) {
    return false;
  }
  if (!this->Caster && stratus_ray_caster_create(this->Context.Get(), &this->Caster) != STRATUS_OK) {
    error = stratus_context_message(this->Context.Get());
    return false;
  }
  return true;
}

// ---------------------------------------------------------------- settings and input

bool vtkStratusVolumeMapper::Internals::CheckMapper(std::string& error) const
{
  const vtkStratusVolumeMapper* mapper = this->Mapper;
  const int blend = mapper->BlendMode;
  if (blend < vtkVolumeMapper::COMPOSITE_BLEND || blend > vtkVolumeMapper::SLICE_BLEND) {
    error = "blend mode " + std::to_string(blend) + " is not supported, only composite (0) to slice (6) are";
  } else if ((this->IsFirstHit() || this->IsPath()) && blend != vtkVolumeMapper::COMPOSITE_BLEND) {
    error = "blend mode " + std::to_string(blend) + " is not supported in " + (this->IsPath() ? "paths" : "first hits") +
      ", only composite (0) is";
  } else if (this->HasLabels() && mapper->MaskBlendFactor != 1.0f) {
    error = "MaskBlendFactor is " + std::to_string(mapper->MaskBlendFactor) + ", only 1 is supported: labels replace what the property has";
  } else if (!std::isfinite(mapper->GradientOpacityDistance)) {
    error = "GradientOpacityDistance is " + std::to_string(mapper->GradientOpacityDistance) +
      ", it must be finite: 0 for optical depths, below 0 for half of the mean spacing";
  } else if (mapper->FinalColorWindow == 0.0f || !std::isfinite(mapper->FinalColorWindow) || !std::isfinite(mapper->FinalColorLevel)) {
    error = "FinalColorWindow is " + std::to_string(mapper->FinalColorWindow) + " and FinalColorLevel " +
      std::to_string(mapper->FinalColorLevel) + ", they must be finite and the window not 0";
  }
  return error.empty();
}

// Checks the prop's settings other than its property.
bool vtkStratusVolumeMapper::Internals::CheckScene(vtkVolume* prop, std::string& error) const
{
  vtkShaderProperty* shaders = prop->GetShaderProperty();
  if (shaders && (shaders->GetNumberOfShaderReplacements() > 0 || shaders->HasFragmentShaderCode() || shaders->HasVertexShaderCode())) {
    error = "shaders of the prop's own are not supported, there is none that they could change";
  }
  return error.empty();
}

stratus_mode vtkStratusVolumeMapper::Internals::GetMode() const
{
  static const stratus_mode blends[] = { STRATUS_MODE_COMPOSITE, STRATUS_MODE_MAXIMUM, STRATUS_MODE_MINIMUM, STRATUS_MODE_AVERAGE,
    STRATUS_MODE_ADDITIVE, STRATUS_MODE_ISOSURFACE, STRATUS_MODE_SLICE };
  return this->IsFirstHit() ? STRATUS_MODE_FIRST_HIT : blends[this->Mapper->BlendMode];
}

bool vtkStratusVolumeMapper::Internals::HasLight() const
{
  const stratus_mode mode = this->GetMode();
  return mode == STRATUS_MODE_COMPOSITE || mode == STRATUS_MODE_FIRST_HIT || mode == STRATUS_MODE_ISOSURFACE;
}

bool vtkStratusVolumeMapper::Internals::HasLabelMap() const
{
  return this->Mapper->MaskInput && this->Mapper->MaskType == LabelMapMaskType;
}

bool vtkStratusVolumeMapper::Internals::HasLabels() const
{
  return this->HasLabelMap() && this->GetMode() == STRATUS_MODE_COMPOSITE;
}

bool vtkStratusVolumeMapper::Internals::IsSupported(vtkVolumeProperty* property) const
{
  std::string unused;
  stratus_ray_cast_options options = stratus_ray_cast_options_default();
  if (!this->CheckMapper(unused)) {
    return false;
  }
  options.mode = this->GetMode();
  return this->SetContours(property, options, unused) &&
    (options.mode != STRATUS_MODE_SLICE || vtkStratusSetSlice(property, options.slice, unused));
}

// Notes the settings that the picture does not use. SetTransfers() notes gradient opacity.
void vtkStratusVolumeMapper::Internals::NoteLeftOut(vtkVolumeProperty* property)
{
  const stratus_mode mode = this->GetMode();
  const char* name = stratus_mode_name(mode);
  this->LeftOut.Begin();
  bool shade = false;
  for (int c = 0; c < STRATUS_COMPONENTS_MAX; ++c) {
    shade = shade || property->GetShade(c);
  }
  if (shade && !this->HasLight()) {
    this->LeftOut.AddUnused("Shade", name);
  }
  if (this->HasLabelMap() && !this->HasLabels()) {
    this->LeftOut.AddUnused("the label map", name);
  } else if (property->GetNumberOfLabels() > 0 && !this->HasLabels()) {
    this->LeftOut.Add("functions of labels, which need a MaskInput of type label map");
  }
  if (property->GetTransferFunctionMode() == vtkVolumeProperty::TF_2D && !this->HasTransfer2D(property)) {
    this->LeftOut.AddUnused("TransferFunction2D", name);
  }
  this->LeftOut.AddTransforms(this->Mapper, mode == STRATUS_MODE_SLICE ? property->GetSliceFunction() : nullptr);
}

// Warns where the inside of the cropping planes misses a turned or mirrored image, which is then not shown at all.
void vtkStratusVolumeMapper::Internals::WarnOfCrop(const stratus_ray_cast_options& options)
{
  const stratus_volume& volume = this->Image.GetVolume();
  bool turned = false;
  for (int i = 0; i < 9; ++i) {
    turned = turned || volume.direction[i] != (i % 4 == 0 ? 1.0 : 0.0);
  }
  for (int a = 0; turned && options.clipping.crop && options.clipping.crop_regions == STRATUS_CROP_INSIDE && a < 3; ++a) {
    const double* planes = this->Mapper->CroppingRegionPlanes + 2 * a;
    const double begin = volume.origin[a] - this->Image.GetCropOffset()[a];
    const double end = begin + volume.spacing[a] * static_cast<double>(volume.dimensions[a] - (volume.cell_centered ? 0 : 1));
    if (begin < end && (planes[1] <= begin || planes[0] >= end)) {
      std::ostringstream text;
      text << "nothing is shown: the cropping planes " << planes[0] << " and " << planes[1] << " miss the image, which extends from "
           << begin << " to " << end << " along its own "
           << "xyz"[a] << " axis. Cropping planes are along the image's own axes, before its "
           << "direction matrix, and not along the axes of GetBounds()";
      this->LeftOut.WarnOnce(this->Mapper, text.str());
      return;
    }
  }
}

vtkTypeUInt64 vtkStratusVolumeMapper::Internals::GetFunctionBuilds() const
{
  vtkTypeUInt64 builds = 0;
  for (const vtkStratusTransferView& view : this->Transfers) {
    builds += view.GetBuilds();
  }
  return builds;
}

// Sets one transfer function, or one for each independent component, or one for each label.
bool vtkStratusVolumeMapper::Internals::SetTransfers(vtkVolumeProperty* property, std::string& error)
{
  const int components = this->Image.GetVolume().components;
  const bool composite = this->GetMode() == STRATUS_MODE_COMPOSITE;
  const int media = property->GetIndependentComponents() ? components : 1;
  const int labels = this->HasLabels() ? vtkStratusTransferView::FindHighestLabel(property) : 0;
  this->Functions.resize(static_cast<size_t>(std::max(media, 1 + labels)));
  this->Transfers.resize(std::max(this->Functions.size(), this->Transfers.size())); // those not needed now keep their count
  bool thins = false;
  for (int c = 0; c < media; ++c) {
    if (!this->Transfers[c].Set(property, c, error)) {
      return false;
    }
    this->Functions[c] = this->Transfers[c].GetTransfer();
    if (this->Functions[c].gradient_count > 0 && !composite) {
      this->Functions[c].gradient_count = 0;
      thins = true;
    }
  }
  if (thins) {
    this->LeftOut.AddUnused("GradientOpacity", stratus_mode_name(this->GetMode()));
  }
  for (int l = 1; l <= labels; ++l) {
    if (!this->Transfers[l].SetLabel(property, l, this->Transfers[0], error)) {
      return false;
    }
    this->Functions[l] = this->Transfers[l].GetTransfer();
  }
  return true;
}

bool vtkStratusVolumeMapper::Internals::PrepareInput(vtkVolume* prop, std::string& error)
{
  vtkStratusVolumeMapper* mapper = this->Mapper;
  if (mapper->GetNumberOfInputConnections(0) > 0) {
    mapper->GetInputAlgorithm()->Update();
  }
  vtkDataSet* image = vtkStratusAsImage(mapper->GetDataObjectInput());
  if (!image) {
    vtkDataObject* input = mapper->GetDataObjectInput();
    error = input
      ? std::string("an input of class ") + input->GetClassName() + " is not supported, only vtkImageData and vtkRectilinearGrid are"
      : std::string("there is no input, a vtkImageData or vtkRectilinearGrid is needed");
    return false;
  }
  if (image->GetNumberOfPoints() < 1) {
    error = "the input image is empty, it needs at least one point";
    return false;
  }
  image = this->IsFirstHit() ? image : this->Sheet.Get(image); // a voxel of first hits has a thickness anyway
  bool cells = false;
  vtkDataArray* array = this->FindArray(image, cells, error);
  if (!array) {
    return false;
  }
  const int component = this->GetVectorComponent(array);
  const bool magnitude = mapper->VectorMode == MAGNITUDE && array->GetNumberOfComponents() > 1;
  this->Vectors.Sweep();
  const float* gradients = this->FindGradients(array, component, magnitude);
  array = magnitude ? this->Vectors.Get(array, vtkStratusVectors::Magnitude, image->GetMTime()) : array;
  if (this->IsPath() && HasTransfer2D(prop->GetProperty())) {
    error = "TransferFunctionMode is TF_2D, which is not supported in paths, only TF_1D is";
    return false;
  }
  if (HasTransfer2D(prop->GetProperty())) {
    return this->PrepareTransfer2D(prop, image, array, cells, component, gradients, error);
  }
  if (!this->Image.Set(image, array, cells, prop->GetMatrix(), error, STRATUS_COMPONENTS_MAX, component)) {
    return false;
  }
  this->Image.SetGradients(gradients);
  return this->SetTransfers(prop->GetProperty(), error);
}

vtkDataArray* vtkStratusVolumeMapper::Internals::FindArray(vtkDataSet* image, bool& cells, std::string& error) const
{
  vtkStratusVolumeMapper* mapper = this->Mapper;
  int where = 0;
  vtkDataArray* array =
    vtkAbstractMapper::GetScalars(image, mapper->ScalarMode, mapper->ArrayAccessMode, mapper->ArrayId, mapper->ArrayName, where);
  cells = where == 1;
  if (!array || where > 1) {
    const bool named = mapper->ScalarMode > VTK_SCALAR_MODE_USE_CELL_DATA;
    const bool byId = mapper->ArrayAccessMode == VTK_GET_ARRAY_BY_ID;
    error = "there is no scalar array";
    if (named) {
      error += byId ? " number " + std::to_string(mapper->ArrayId) : " '" + std::string(mapper->ArrayName ? mapper->ArrayName : "") + "'";
    }
    error += std::string(" for scalar mode ") + mapper->GetScalarModeAsString() + ": " + vtkStratusArrayNames(image);
    return nullptr;
  }
  return array;
}

bool vtkStratusVolumeMapper::Internals::SetMask(vtkVolumeProperty* property, stratus_ray_cast_options& options, std::string& error)
{
  vtkImageData* mask = this->Mapper->MaskInput;
  if (!mask || (this->HasLabelMap() && !this->HasLabels())) {
    return true;
  }
  const int64_t* wanted = this->Image.GetVolume().dimensions;
  const uint64_t time = mask->GetMTime();
  int dimensions[3];
  mask->GetDimensions(dimensions);
  if (this->Sheet.IsOf(this->Mapper->GetDataObjectInput()) && !this->Image.GetVolume().cell_centered) { // as the input has become
    mask = vtkImageData::SafeDownCast(this->MaskSheet.Get(mask));
    mask->GetDimensions(dimensions);
  }
  vtkUnsignedCharArray* bytes = vtkUnsignedCharArray::SafeDownCast(mask->GetPointData()->GetScalars());
  if (!bytes || bytes->GetNumberOfComponents() != 1) {
    error = "MaskInput has no point scalars of one unsigned char each";
  } else if (dimensions[0] != wanted[0] || dimensions[1] != wanted[1] || dimensions[2] != wanted[2]) {
    error = "MaskInput has " + std::to_string(dimensions[0]) + " x " + std::to_string(dimensions[1]) + " x " +
      std::to_string(dimensions[2]) + " points, the input " + std::to_string(wanted[0]) + " x " + std::to_string(wanted[1]) + " x " +
      std::to_string(wanted[2]) + " values";
  } else if (bytes->GetNumberOfTuples() < mask->GetNumberOfPoints()) {
    error = "MaskInput's array has " + std::to_string(bytes->GetNumberOfTuples()) + " values for " +
      std::to_string(mask->GetNumberOfPoints()) + " points";
  } else {
    options.mask.label_count = this->HasLabels() ? vtkStratusTransferView::FindHighestLabel(property) : 0;
    options.mask.bytes = this->HasLabels() && options.mask.label_count == 0 ? nullptr : bytes->GetPointer(0);
    options.mask.revision = std::max<uint64_t>({ bytes->GetMTime(), mask->GetMTime(), time });
  }
  return error.empty();
}

// Sets the range of average intensity and the values of isosurfaces.
bool vtkStratusVolumeMapper::Internals::SetContours(
  vtkVolumeProperty* property, stratus_ray_cast_options& options, std::string& error) const
{
  if (options.mode == STRATUS_MODE_AVERAGE) {
    std::copy_n(this->Mapper->AverageIPScalarRange, 2, options.optics.average_range);
  }
  if (options.mode != STRATUS_MODE_ISOSURFACE) {
    return true;
  }
  vtkContourValues* contours = property->GetIsoSurfaceValues();
  const int count = contours ? contours->GetNumberOfContours() : 0;
  if (count > STRATUS_CONTOURS_MAX) {
    error = std::to_string(count) + " isosurface values are not supported, at most " + std::to_string(STRATUS_CONTOURS_MAX) + " are";
    return false;
  }
  options.optics.contour_count = count;
  for (int n = 0; n < count; ++n) {
    options.optics.contours[n] = contours->GetValue(n);
  }
  return true;
}

bool vtkStratusVolumeMapper::Internals::SetOptions(vtkVolumeProperty* property, stratus_ray_cast_options& options, std::string& error)
{
  const vtkStratusVolumeMapper* mapper = this->Mapper;
  options = stratus_ray_cast_options_default();
  options.mode = this->GetMode();
  options.light.normals = static_cast<stratus_normals>(mapper->Normals);
  options.skipping.structure = static_cast<stratus_structure>(mapper->Structure);
  options.sampling.rule = static_cast<stratus_sampling>(mapper->Sampling);
  options.sampling.interpolation =
    property->GetInterpolationType() == VTK_NEAREST_INTERPOLATION ? STRATUS_INTERPOLATION_NEAREST : STRATUS_INTERPOLATION_LINEAR;
  options.sampling.distance = mapper->SampleDistance <= 0.0 ? 0.0 : mapper->SampleDistance; // the core refuses NaN
  options.sampling.cell_error = mapper->CellError <= 0.0 ? 0.0 : mapper->CellError;
  options.sampling.light_spread = mapper->LightSpread <= 0.0 ? 0.0 : mapper->LightSpread;
  options.sampling.termination = mapper->Termination;
  options.sampling.tolerance = mapper->ImageErrorTolerance;
  options.optics.gradient_distance = this->GetGradientOpacityDistance();
  options.optics.gradient_length = this->GradientLength;
  options.optics.mean_components = mapper->ComponentMixing == MEAN_COMPONENTS ? 1 : 0;
  options.optics.dependent = property->GetIndependentComponents() ? 0 : 1;
  options.skipping.block_size = mapper->BlockSize;
  options.skipping.audit = mapper->Audit ? 1 : 0;
  if (mapper->Cropping) {
    options.clipping.crop = 1;
    options.clipping.crop_regions = static_cast<uint32_t>(mapper->CroppingRegionFlags);
    for (int b = 0; b < 6; ++b) {
      options.clipping.crop_bounds[b] = mapper->CroppingRegionPlanes[b] + this->Image.GetCropOffset()[b / 2];
    }
  }
  options.optics.transfer_2d = HasTransfer2D(property) ? &this->Transfer2D : nullptr;
  options.clipping.clip_gradients = property->GetUseClippedVoxelIntensity() ? 1 : 0;
  options.clipping.clipped_value = property->GetClippedVoxelIntensity();
  options.sampling.jitter = mapper->UseJittering ? 1 : 0;
  options.sampling.jitter_seed = mapper->JitterSeed;
  return this->SetMask(property, options, error) && this->SetContours(property, options, error) &&
    (options.mode != STRATUS_MODE_SLICE || vtkStratusSetSlice(property, options.slice, error)) &&
    vtkStratusClipPlanes(this->Mapper, STRATUS_CLIP_PLANES_MAX, options.clipping.clip_planes, options.clipping.clip_plane_count, error);
}
