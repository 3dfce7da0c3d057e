// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusJointPicture.h"

#include "vtkStratusMultiBlockVolumeMapper.h"
#include "vtkStratusMultiVolume.h"
#include "vtkStratusVolumeMapper.h"

#include "vtkImageData.h"
#include "vtkRenderWindow.h"
#include "vtkRenderer.h"
#include "vtkVolume.h"

#include <algorithm>
#include <cmath>

bool vtkStratusJointPicture::EndsNoRay(vtkProp* other)
{
  if (vtkStratusMultiVolume::SafeDownCast(other)) {
    return true;
  }
  vtkVolume* volume = vtkVolume::SafeDownCast(other);
  vtkStratusVolumeMapper* mapper = volume ? vtkStratusVolumeMapper::SafeDownCast(volume->GetMapper()) : nullptr;
  auto* blocks = volume ? vtkStratusMultiBlockVolumeMapper::SafeDownCast(volume->GetMapper()) : nullptr;
  mapper = blocks ? blocks->GetSettings() : mapper;
  return mapper && mapper->GetRenderMode() == vtkStratusVolumeMapper::COMPOSITE_MODE;
}

// Returns the pixels between rays: fewer rays while the window's desired update rate is too high for exact frames.
double vtkStratusJointPicture::ChooseCoarseness(const Scene& scene) const
{
  vtkStratusVolumeMapper* mapper = scene.Settings;
  vtkRenderWindow* window = scene.Renderer->GetRenderWindow();
  const bool interactive =
    mapper->GetAutoAdjustSampleDistances() && window && window->GetDesiredUpdateRate() >= mapper->GetInteractiveUpdateRate();
  const double allotted = 1000.0 * scene.Prop->GetAllocatedRenderTime(), pixels = mapper->GetImageSampleDistance();
  if (!interactive || !(allotted > 0.0) || this->FullMilliseconds <= allotted || this->LearnedFor != scene.Prop->GetRedrawMTime()) {
    return pixels;
  }
  const double wanted = pixels * std::sqrt(this->FullMilliseconds / allotted);
  return std::max(pixels, std::min(wanted, mapper->GetMaximumImageSampleDistance()));
}

void vtkStratusJointPicture::LearnTime(const Scene& scene)
{
  const double rays = static_cast<double>(this->Picture.Size[0]) * this->Picture.Size[1];
  const double base = scene.Settings->GetImageSampleDistance();
  const double all = static_cast<double>(this->Picture.Rectangle[2]) * this->Picture.Rectangle[3] / (base * base);
  this->FullMilliseconds = scene.Milliseconds * std::max(1.0, all / rays);
  this->LearnedFor = scene.Prop->GetRedrawMTime();
}

bool vtkStratusJointPicture::Begin(
  vtkRenderer* renderer, vtkProp* prop, vtkAbstractMapper* mapper, const std::string& lastError, std::string& error)
{
  if (!this->Display.Begin(renderer, prop, mapper, lastError, error)) {
    return false;
  }
  this->HasPicture = false;
  return true;
}

stratus_status vtkStratusJointPicture::Scene::Finish(
  const stratus_ray_cast_input* inputs, int count, const stratus_camera& camera, const stratus_image& image, const int window[4])
{
  const int all[4] = { 0, image.width, 0, image.height };
  std::copy_n(this->TakesShadows ? all : window, 4, this->Window);
  return this->TakesShadows ? stratus_ray_caster_shade_surfaces(inputs, count, &camera, &image) : STRATUS_OK;
}

bool vtkStratusJointPicture::Render(Scene& scene, std::string& error)
{
  vtkRenderer* renderer = scene.Renderer;
  const bool solid = scene.Settings->GetRenderMode() == vtkStratusVolumeMapper::FIRST_HIT_MODE;
  this->HasSamples = scene.Settings->GetCountSamples() != 0;
  if (!this->Quantities.Set(scene.Settings->GetQuantities(), scene.Settings->GetTransmittanceThreshold(), error)) {
    return false;
  }
  this->Picture.TakesShadows = scene.TakesShadows;
  if (!this->Picture.Set(renderer, scene.Boxes, this->ChooseCoarseness(scene), solid)) {
    error = "the camera's projection has no inverse";
    return false;
  }
  this->HasPicture = this->Picture.IsEmpty();
  if (this->HasPicture) {
    return true;
  }
  const vtkStratusPicture::Others others = this->Picture.FindOthers(renderer, scene.Prop, EndsNoRay);
  const float* opaqueDepth = this->Picture.ReadOpaqueDepth(renderer, others);
  this->Rgba.resize(4 * static_cast<size_t>(this->Picture.Size[0]) * this->Picture.Size[1]);
  this->Bytes.resize(this->Rgba.size());
  vtkStratusDisplay::Pixels pixels = vtkStratusDisplay::ChoosePixels(
    renderer, others, scene.Settings->GetFinalColorWindow(), scene.Settings->GetFinalColorLevel(), this->Bytes);
  const stratus_image image = this->Picture.MakeRoom(
    this->Rgba, this->Depth, opaqueDepth, this->HasSamples ? &this->Samples : nullptr, pixels.Bytes ? &this->Bytes : nullptr);
  if (!scene.Cast(this->Picture.Camera, image, true, error) || !scene.Measure(this->Picture.Camera, image, this->Quantities, error)) {
    return false;
  }
  this->HasPicture = true;
  this->LearnTime(scene);
  pixels.Rgba = this->Rgba.data();
  pixels.Encodes = scene.Settings->GetScreenEncoding() != 0;
  std::copy_n(scene.Window, 4, pixels.Window);
  pixels.Depth = &this->Depth;
  pixels.WritesDepth = solid;
  pixels.Finder = scene.Finder;
  if (!solid && scene.Settings->GetBlendMode() == vtkVolumeMapper::COMPOSITE_BLEND) {
    this->CastPart = scene.Cast;
    pixels.Cast = [this](const float* depths, std::vector<float>& rgba) {
      if (this->Picture.IsWhole(depths)) {
        rgba = this->Rgba;
        return true;
      }
      std::string unused;
      const stratus_image part = this->Picture.MakeRoom(rgba, this->PartDepth, depths);
      return this->CastPart(this->Picture.Camera, part, false, unused);
    };
  }
  return this->Display.Draw(renderer, this->Picture, pixels, error);
}

vtkImageData* vtkStratusJointPicture::GetLastImage()
{
  if (!this->HasPicture) {
    return nullptr;
  }
  this->LastImage = this->Picture.MakeImage(this->Rgba, this->Depth, this->HasSamples ? &this->Samples : nullptr);
  this->Quantities.AddTo(this->LastImage, this->Picture);
  return this->LastImage;
}
