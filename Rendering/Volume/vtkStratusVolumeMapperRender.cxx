// SPDX-License-Identifier: BSD-3-Clause
// Draws one picture of vtkStratusVolumeMapper: chooses its coarseness, reads depths, casts rays and displays the result.
#include "vtkStratusVolumeMapperInternals.h"

#include "vtkStratusJointPicture.h"

#include "vtkCommand.h"
#include "vtkImageData.h"
#include "vtkRenderWindow.h"
#include "vtkRenderer.h"
#include "vtkVolume.h"
#include "vtkVolumeProperty.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

namespace {
double Now() // milliseconds
{
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now().time_since_epoch()).count();
}
} // namespace

// ---------------------------------------------------------------- coarseness

vtkStratusVolumeMapper::Internals::Coarseness vtkStratusVolumeMapper::Internals::ChooseCoarseness(vtkRenderer* renderer, vtkVolume* prop)
{
  const vtkStratusVolumeMapper* mapper = this->Mapper;
  Coarseness coarseness;
  coarseness.Pixels = mapper->ImageSampleDistance;
  vtkRenderWindow* window = renderer->GetRenderWindow();
  // The time of a full picture holds only for the settings and geometry that it was learned from.
  const stratus_volume& volume = this->Image.GetVolume();
  std::array<double, 27> learnedFor;
  learnedFor[0] = mapper->SampleDistance;
  std::copy_n(volume.spacing, 3, learnedFor.begin() + 1);
  std::copy_n(volume.matrix, 12, learnedFor.begin() + 4);
  learnedFor[16] = static_cast<double>(prop->GetProperty()->GetMTime());
  learnedFor[17] = mapper->RenderMode + 100.0 * mapper->BlendMode;
  learnedFor[18] = mapper->ImageErrorTolerance;
  learnedFor[19] = mapper->Sampling;
  learnedFor[20] = mapper->CellError;
  learnedFor[21] = mapper->LightSpread;
  learnedFor[22] = mapper->Shadows;
  learnedFor[23] = mapper->VolumetricScatteringBlending;
  learnedFor[24] = mapper->ScatteringAnisotropy;
  learnedFor[25] = mapper->MultipleScattering;
  learnedFor[26] = mapper->GlobalIlluminationReach;
  if (learnedFor != this->LearnedFor) {
    this->LearnedFor = learnedFor;
    this->FullMilliseconds = 0.0;
  }
  const bool interactive = mapper->AutoAdjustSampleDistances && window && window->GetDesiredUpdateRate() >= mapper->InteractiveUpdateRate;
  if (!interactive || this->FullMilliseconds <= 0.0) {
    return coarseness;
  }
  // Only casting can be made faster, so that the time to display the picture is subtracted.
  const double allotted = 1000.0 * prop->GetAllocatedRenderTime();
  const double available = std::max(allotted - this->DrawMilliseconds, 0.1 * allotted);
  const double excess = available > 0.0 ? this->FullMilliseconds / available : std::numeric_limits<double>::max();
  if (excess > 1.0) {
    const bool steps = !this->IsFirstHit() && !this->IsPath() &&
      mapper->BlendMode < vtkVolumeMapper::ISOSURFACE_BLEND &&              // nor have slices steps
      !this->FullFollows && this->FullSampling != STRATUS_SAMPLING_CELLS && // nor have rays that follow the voxels one step for all
      this->FullSampling != STRATUS_SAMPLING_LOCAL;                         // cells have no step, local is not for asking
    coarseness.Step = !steps ? 1.0 : std::min(excess, mapper->MaximumSampleDistanceFactor);
    coarseness.Pixels *= std::sqrt(excess / coarseness.Step);
    coarseness.Pixels = std::max(mapper->ImageSampleDistance, std::min(coarseness.Pixels, mapper->MaximumImageSampleDistance));
  }
  return coarseness;
}

void vtkStratusVolumeMapper::Internals::LearnTime(const Coarseness& coarseness)
{
  if (coarseness.Step == 1.0) {
    this->FullSampleDistance = this->Report.sample_distance;
    this->FullSampling = this->Report.sampling;
    this->FullFollows = this->Report.follows_voxels != 0;
  }
  const double rays = static_cast<double>(this->Picture.Size[0]) * this->Picture.Size[1];
  const double base = this->Mapper->ImageSampleDistance;
  const double all = static_cast<double>(this->Picture.Rectangle[2]) * this->Picture.Rectangle[3] / (base * base);
  // Paths fill PathSeconds however coarse a picture is; it needs only two of them.
  const double needed =
    this->IsPath() ? 2e3 * this->PathReport.seconds / std::max(1.0, static_cast<double>(this->PathReport.samples)) : this->Report.cast_ms;
  this->FullMilliseconds = needed * coarseness.Step * std::max(1.0, all / rays);
}

// ---------------------------------------------------------------- a picture

bool vtkStratusVolumeMapper::Internals::Cast(
  vtkRenderer* renderer, const stratus_ray_cast_options& options, const float* opaqueDepth, bool bytes, std::string& error)
{
  const stratus_image image = this->Picture.MakeRoom(
    this->Rgba, this->Depth, opaqueDepth, this->HasSamples ? &this->Samples : nullptr, bytes ? &this->Bytes : nullptr);
  this->Renderer = renderer;
  const stratus_ray_cast_input input = this->InputOf(options);
  stratus_context_start_build_report(this->Context.Get());
  stratus_status status = this->IsPath()
    ? this->CastPaths(options, image)
    : stratus_ray_caster_render(input.caster, input.volume, input.transfer, &this->Picture.Camera, &options, &image, &this->Report);
  if (status == STRATUS_OK && this->Picture.TakesShadows) {
    status = stratus_ray_caster_shade_surfaces(&input, 1, &this->Picture.Camera, &image);
    const int all[4] = { 0, image.width, 0, image.height };
    std::copy_n(all, 4, this->Report.window);
  }
  if (status != STRATUS_OK && status != STRATUS_CANCELLED) {
    error = stratus_context_message(this->Context.Get());
  }
  const bool drawn =
    status == STRATUS_OK && this->Quantities.Compute(this->Context.Get(), &input, 1, false, this->Picture.Camera, image, error);
  this->Renderer = nullptr;
  this->Context.KeepBuildReport(this->BuildReport);
  return drawn;
}

// Casts the rays of the last frame up to window depths, in place of the opaque ones. The frame's reports are kept.
bool vtkStratusVolumeMapper::Internals::CastTo(const stratus_ray_cast_options& options, const float* depths, std::vector<float>& rgba)
{
  if (this->Picture.IsWhole(depths)) {
    rgba = this->Rgba;
    return true;
  }
  const stratus_image image = this->Picture.MakeRoom(rgba, this->PartDepth, depths);
  stratus_ray_cast_options plain = options;
  stratus_ray_cast_report report;
  plain.skipping.audit = 0;
  const stratus_ray_cast_input input = this->InputOf(plain);
  return stratus_ray_caster_render(input.caster, input.volume, input.transfer, &this->Picture.Camera, &plain, &image, &report) ==
    STRATUS_OK;
}

bool vtkStratusVolumeMapper::Internals::Describe(
  vtkRenderer* renderer, vtkVolume* prop, stratus_ray_cast_options& options, std::string& error)
{
  vtkVolumeProperty* property = prop->GetProperty();
  if (!this->CheckMapper(error) || !this->CheckScene(prop, error)) {
    return false;
  }
  this->NoteLeftOut(property);
  return this->PrepareInput(prop, error) && this->SetOptions(property, options, error) && this->SetShading(renderer, prop, options, error);
}

bool vtkStratusVolumeMapper::Internals::Measure(vtkRenderer* renderer, vtkVolume* prop, double choice[4])
{
  std::string error;
  stratus_ray_cast_options options;
  return this->Describe(renderer, prop, options, error) && this->PrepareContext(error) && this->Probe(this->Caster, options, choice);
}

// The choice does not depend on the camera, so that a frame of one ray is enough.
bool vtkStratusVolumeMapper::Internals::Probe(stratus_ray_caster* caster, stratus_ray_cast_options options, double choice[4])
{
  float rgba[4];
  stratus_image image = stratus_image();
  image.width = image.height = 1;
  image.rgba = rgba;
  stratus_camera camera = stratus_camera();
  camera.forward[2] = camera.right[0] = camera.up[1] = 1.0;
  camera.far_k = 1.0;
  stratus_ray_cast_report report = stratus_ray_cast_report();
  options.skipping.audit = 0;
  const stratus_status status =
    stratus_ray_caster_render(caster, &this->Image.GetVolume(), this->Functions.data(), &camera, &options, &image, &report);
  choice[0] = std::min<int>(report.sampling, CELLS_SAMPLING);
  choice[1] = report.sample_distance;
  choice[2] = report.cell_error;
  choice[3] = report.light_spread;
  return status == STRATUS_OK;
}

bool vtkStratusVolumeMapper::Internals::Render(vtkRenderer* renderer, vtkVolume* prop, std::string& error)
{
  if (!this->Display.Begin(renderer, prop, this->Mapper, this->LastError, error)) {
    return error.empty();
  }
  this->HasPicture = false; // a refused picture leaves no image
  this->ReleaseJoint(renderer);
  this->HasSamples = this->Mapper->CountSamples != 0;
  stratus_ray_cast_options options;
  if (!this->Quantities.Set(this->Mapper->Quantities, this->Mapper->TransmittanceThreshold, error) ||
    !this->Describe(renderer, prop, options, error) || !this->PrepareContext(error)) {
    return false;
  }
  // Rendering checks the volume, too, but the picture's rectangle already relies on it.
  if (stratus_volume_check(this->Context.Get(), &this->Image.GetVolume()) != STRATUS_OK) {
    error = stratus_context_message(this->Context.Get());
    return false;
  }
  this->LeftOut.Warn(this->Mapper);
  this->Quantities.ForgetVolumes();
  this->Quantities.AddVolume(this->Mapper, prop);
  this->WarnOfCrop(options);
  this->WarnOfGradientOpacity(prop->GetProperty());
  this->OfferTree(this->Caster, this->Context.Get());
  this->ChooseCoarse(renderer, options);
  const Coarseness coarseness = this->ShowsCoarse ? Coarseness() : this->ChooseCoarseness(renderer, prop);
  if (coarseness.Step > 1.0) {
    options.sampling.distance = coarseness.Step * this->FullSampleDistance;
    options.sampling.rule = this->FullSampling; // rule and step by hand: nothing is probed while a camera moves
  }
  const bool boxed = options.clipping.crop && options.clipping.crop_regions == STRATUS_CROP_INSIDE;
  const bool toImage = this->Mapper->RenderToImage && !renderer->GetSelector();
  const stratus_ray_cast_input input = this->InputOf(options);
  this->Picture.TakesShadows = !toImage && vtkStratusSurfaces::TakeShadows(renderer, &input, 1);
  if (!this->Picture.Set(
        renderer, this->Image.GetVolume(), boxed ? options.clipping.crop_bounds : nullptr, coarseness.Pixels, this->IsFirstHit())) {
    error = "the camera's projection has no inverse";
    return false;
  }
  this->UsedCoarseness = coarseness.Pixels;
  this->HasPicture = this->Picture.IsEmpty();
  if (this->HasPicture) {
    return true;
  }
  const double start = Now();
  const vtkStratusPicture::Others others = this->Picture.FindOthers(renderer, prop, vtkStratusJointPicture::EndsNoRay);
  const float* opaqueDepth = toImage ? nullptr : this->Picture.ReadOpaqueDepth(renderer, others);
  const double read = Now();
  this->Rgba.resize(4 * static_cast<size_t>(this->Picture.Size[0]) * this->Picture.Size[1]);
  this->Bytes.resize(this->Rgba.size());
  vtkStratusDisplay::Pixels pixels =
    vtkStratusDisplay::ChoosePixels(renderer, others, this->Mapper->FinalColorWindow, this->Mapper->FinalColorLevel, this->Bytes);
  const uint64_t reads = this->Image.GetReads() ? *this->Image.GetReads() : 0;
  if (!this->Cast(renderer, options, opaqueDepth, pixels.Bytes != nullptr, error)) {
    return false;
  }
  this->HasPicture = true;
  if (!this->ShowsCoarse) {
    this->HasToRead = this->Image.GetReads() && *this->Image.GetReads() != reads;
    this->LearnTime(coarseness);
  }
  if (toImage) {
    return true;
  }
  const double cast = Now();
  pixels.Rgba = this->Rgba.data();
  pixels.Encodes = this->Mapper->ScreenEncoding != 0;
  std::copy_n(this->Report.window, 4, pixels.Window);
  pixels.Depth = &this->Depth;
  pixels.WritesDepth = this->IsFirstHit();
  if (renderer->GetSelector()) {
    this->Finder.Set(this->PickedOf ? this->PickedOf.Get() : this->Mapper->GetDataObjectInput(), prop->GetMatrix());
    pixels.Finder = &this->Finder;
  }
  if (!this->IsFirstHit() && !this->IsPath() && this->Mapper->BlendMode == vtkVolumeMapper::COMPOSITE_BLEND) {
    pixels.Cast = [this, options](const float* depths, std::vector<float>& rgba) { return this->CastTo(options, depths, rgba); };
  }
  const bool drawn = this->Display.Draw(renderer, this->Picture, pixels, error);
  if (drawn) {
    this->DrawMilliseconds = Now() - cast + read - start;
  }
  if (drawn && (this->ShowsCoarse || (this->IsPath() && !this->Mapper->GetPathFinished()))) {
    this->Mapper->InvokeEvent(vtkCommand::UpdateEvent);
  }
  return drawn;
}

void vtkStratusVolumeMapper::Internals::SetMixed(const stratus_ray_cast_report& report)
{
  this->Report = report;
  this->HasPicture = false;
  this->LastError.clear();
}

// A selector draws each volume by itself for a moment.
void vtkStratusVolumeMapper::Internals::ReleaseJoint(vtkRenderer* renderer)
{
  if (this->Joint && !renderer->GetSelector()) {
    this->Joint->ReleaseGraphicsResources(renderer->GetRenderWindow());
    this->Joint = nullptr;
  }
}

vtkImageData* vtkStratusVolumeMapper::Internals::GetLastImage()
{
  if (!this->HasPicture) {
    return nullptr;
  }
  this->LastImage = this->Picture.MakeImage(this->Rgba, this->Depth, this->HasSamples ? &this->Samples : nullptr);
  this->Quantities.AddTo(this->LastImage, this->Picture);
  return this->LastImage;
}
