// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusMultiVolume.h"

#include "vtkStratusVolumeMapperInternals.h"

#include "vtkBoundingBox.h"
#include "vtkImageData.h"
#include "vtkMath.h"
#include "vtkObjectFactory.h"
#include "vtkRenderWindow.h"
#include "vtkRenderer.h"
#include "vtkVolumeProperty.h"

#include <algorithm>
#include <chrono>
#include <cmath>

class VTK_STRATUS_PRIVATE vtkStratusMultiVolume::Internals
{
public:
  explicit Internals(vtkStratusMultiVolume* prop);
  ~Internals();

  bool Render(vtkRenderer* renderer, std::string& error);
  vtkImageData* GetLastImage();
  vtkStratusVolumeMapper* GetMapper(int port) const;
  int GetLowest() const; // the lowest port with a volume; -1: none

  vtkStratusMultiVolume* Prop;
  vtkSmartPointer<vtkVolume> Volumes[STRATUS_SEVERAL_MAX];
  stratus_ray_cast_report Reports[STRATUS_SEVERAL_MAX]; // of each port
  stratus_ray_cast_report Whole;                        // of the first of them that is drawn
  vtkStratusDisplay Display;
  std::string LastError;

private:
  bool OnProgress();
  bool Describe(vtkRenderer* renderer, std::string& error);
  bool PrepareContext(std::string& error);
  double ChooseCoarseness(vtkRenderer* renderer) const;
  void LearnTime();
  bool Cast(vtkRenderer* renderer, const float* opaqueDepth, bool bytes, std::string& error);

  vtkStratusContext Context;
  stratus_ray_caster* Casters[STRATUS_SEVERAL_MAX] = {};
  // What is drawn, by the number of visible volumes so far.
  int Count = 0;
  int Ports[STRATUS_SEVERAL_MAX];
  stratus_ray_cast_options Options[STRATUS_SEVERAL_MAX];
  stratus_ray_cast_input Inputs[STRATUS_SEVERAL_MAX];
  vtkStratusVolumeMapper* First = nullptr; // the mapper whose settings hold for the whole picture
  vtkRenderer* Renderer = nullptr;
  vtkStratusPicture Picture;
  bool HasPicture = false, HasSamples = false;
  double FullMilliseconds = 0.0; // estimated time of an exact picture, 0: unknown
  vtkMTimeType LearnedFor = 0;
  std::vector<float> Rgba, Depth, PartDepth;
  std::vector<unsigned char> Bytes;
  std::vector<uint32_t> Samples;
  vtkSmartPointer<vtkImageData> LastImage;
};

vtkStratusMultiVolume::Internals::Internals(vtkStratusMultiVolume* prop)
    : Prop(prop), Reports(), Whole(), Context([this](double) { return this->OnProgress(); })
{
  this->Context.OnRelease = [this] {
    for (stratus_ray_caster*& caster : this->Casters) {
      stratus_ray_caster_destroy(caster);
      caster = nullptr;
    }
  };
}

vtkStratusMultiVolume::Internals::~Internals()
{
  this->Context.OnRelease();
  this->Context.OnRelease = nullptr; // members that it uses are destroyed before the context
}

bool vtkStratusMultiVolume::Internals::OnProgress()
{
  vtkRenderWindow* window = this->Renderer ? this->Renderer->GetRenderWindow() : nullptr;
  return window && window->CheckAbortStatus();
}

vtkStratusVolumeMapper* vtkStratusMultiVolume::Internals::GetMapper(int port) const
{
  return this->Volumes[port] ? vtkStratusVolumeMapper::SafeDownCast(this->Volumes[port]->GetMapper()) : nullptr;
}

int vtkStratusMultiVolume::Internals::GetLowest() const
{
  const auto found = std::find_if(std::begin(this->Volumes), std::end(this->Volumes), [](vtkVolume* volume) { return volume != nullptr; });
  return found == std::end(this->Volumes) ? -1 : static_cast<int>(found - this->Volumes);
}

bool vtkStratusMultiVolume::Internals::PrepareContext(std::string& error)
{
  this->Context.SetDevice(this->First->GetDevice(), this->First->NumberOfThreads, error);
  bool ready = error.empty() && this->Context.Prepare(this->First->NumberOfThreads, error);
  for (int n = 0; ready && n < this->Count; ++n) {
    stratus_ray_caster*& caster = this->Casters[this->Ports[n]];
    ready = caster || stratus_ray_caster_create(this->Context.Get(), &caster) == STRATUS_OK;
    if (!ready) {
      error = stratus_context_message(this->Context.Get());
    }
    this->Inputs[n].caster = caster;
  }
  return ready;
}

// Asks the mappers what their volumes draw.
bool vtkStratusMultiVolume::Internals::Describe(vtkRenderer* renderer, std::string& error)
{
  this->Count = 0;
  for (int port = 0; port < STRATUS_SEVERAL_MAX; ++port) {
    vtkVolume* volume = this->Volumes[port];
    if (!volume || !volume->GetVisibility()) {
      continue;
    }
    vtkStratusVolumeMapper* mapper = this->GetMapper(port);
    if (!mapper) {
      error = volume->GetMapper() ? std::string("a mapper of class ") + volume->GetMapper()->GetClassName() + " is not supported"
                                  : std::string("there is no mapper");
      error += ", the volume must have a vtkStratusVolumeMapper";
    } else if (mapper->RenderMode != vtkStratusVolumeMapper::COMPOSITE_MODE) {
      error = "first hits are not supported by vtkStratusMultiVolume, only render mode composite is";
    } else {
      volume->GetMatrix(); // computes it
      mapper->Internal->Describe(renderer, volume, this->Options[this->Count], error);
    }
    if (!error.empty()) {
      error = "the volume at port " + std::to_string(port) + ": " + error;
      return false;
    }
    this->First = this->Count == 0 ? mapper : this->First;
    this->Ports[this->Count] = port;
    this->Inputs[this->Count] = stratus_ray_cast_input();
    this->Inputs[this->Count].volume = &mapper->Internal->Image.GetVolume();
    this->Inputs[this->Count].transfer = mapper->Internal->Functions.data();
    this->Inputs[this->Count].options = &this->Options[this->Count];
    ++this->Count;
  }
  return true;
}

// Returns the pixels between rays: fewer rays while the window asks for more pictures a second than exact ones allow.
double vtkStratusMultiVolume::Internals::ChooseCoarseness(vtkRenderer* renderer) const
{
  const vtkStratusVolumeMapper* mapper = this->First;
  vtkRenderWindow* window = renderer->GetRenderWindow();
  const bool interactive = mapper->AutoAdjustSampleDistances && window && window->GetDesiredUpdateRate() >= mapper->InteractiveUpdateRate;
  const double allotted = 1000.0 * this->Prop->GetAllocatedRenderTime();
  if (!interactive || !(allotted > 0.0) || this->FullMilliseconds <= allotted || this->LearnedFor != this->Prop->GetRedrawMTime()) {
    return mapper->ImageSampleDistance;
  }
  const double wanted = mapper->ImageSampleDistance * std::sqrt(this->FullMilliseconds / allotted);
  return std::max(mapper->ImageSampleDistance, std::min(wanted, mapper->MaximumImageSampleDistance));
}

void vtkStratusMultiVolume::Internals::LearnTime()
{
  const double rays = static_cast<double>(this->Picture.Size[0]) * this->Picture.Size[1];
  const double base = this->First->ImageSampleDistance;
  const double all = static_cast<double>(this->Picture.Rectangle[2]) * this->Picture.Rectangle[3] / (base * base);
  this->FullMilliseconds = this->Whole.cast_ms * std::max(1.0, all / rays);
  this->LearnedFor = this->Prop->GetRedrawMTime();
}

bool vtkStratusMultiVolume::Internals::Cast(vtkRenderer* renderer, const float* opaqueDepth, bool bytes, std::string& error)
{
  const stratus_image image = this->Picture.MakeRoom(
    this->Rgba, this->Depth, opaqueDepth, this->HasSamples ? &this->Samples : nullptr, bytes ? &this->Bytes : nullptr);
  stratus_ray_cast_report reports[STRATUS_SEVERAL_MAX];
  this->Renderer = renderer;
  const stratus_status status = stratus_ray_caster_render_several(this->Inputs, this->Count, &this->Picture.Camera, &image, reports);
  this->Renderer = nullptr;
  if (status != STRATUS_OK && status != STRATUS_CANCELLED) {
    error = stratus_context_message(this->Context.Get());
  }
  std::fill(std::begin(this->Reports), std::end(this->Reports), stratus_ray_cast_report());
  this->Whole = status == STRATUS_OK ? reports[0] : stratus_ray_cast_report();
  for (int n = 0; status == STRATUS_OK && n < this->Count; ++n) {
    this->Reports[this->Ports[n]] = reports[n];
  }
  return status == STRATUS_OK;
}

bool vtkStratusMultiVolume::Internals::Render(vtkRenderer* renderer, std::string& error)
{
  const int lowest = this->GetLowest();
  if (lowest < 0) {
    return true;
  }
  if (!this->Display.Begin(renderer, this->Prop, this->Volumes[lowest]->GetMapper(), this->LastError, error)) {
    return error.empty();
  }
  this->HasPicture = false; // a refused picture leaves no image
  if (!this->Describe(renderer, error) || this->Count == 0) {
    return error.empty();
  }
  this->HasSamples = this->First->CountSamples != 0;
  if (!this->PrepareContext(error)) {
    return false;
  }
  std::vector<vtkStratusPicture::Box> boxes;
  for (int n = 0; n < this->Count; ++n) {
    if (stratus_volume_check(this->Context.Get(), this->Inputs[n].volume) != STRATUS_OK) { // the rectangle relies on it
      error = stratus_context_message(this->Context.Get());
      return false;
    }
    const bool boxed = this->Options[n].crop && this->Options[n].crop_regions == STRATUS_CROP_INSIDE;
    boxes.push_back({ this->Inputs[n].volume, boxed ? this->Options[n].crop_bounds : nullptr });
  }
  if (!this->Picture.Set(renderer, boxes, this->ChooseCoarseness(renderer))) {
    error = "the camera's projection has no inverse";
    return false;
  }
  this->HasPicture = this->Picture.IsEmpty();
  if (this->HasPicture) {
    return true;
  }
  const vtkStratusPicture::Others others = this->Picture.FindOthers(renderer, this->Prop, [](vtkProp* other) {
    return vtkStratusMultiVolume::SafeDownCast(other) != nullptr; // writes no depth
  });
  const float* opaqueDepth = this->Picture.ReadOpaqueDepth(renderer, others);
  this->Rgba.resize(4 * static_cast<size_t>(this->Picture.Size[0]) * this->Picture.Size[1]);
  this->Bytes.resize(this->Rgba.size());
  vtkStratusDisplay::Pixels pixels =
    vtkStratusDisplay::ChoosePixels(renderer, others, this->First->FinalColorWindow, this->First->FinalColorLevel, this->Bytes);
  if (!this->Cast(renderer, opaqueDepth, pixels.Bytes != nullptr, error)) {
    return false;
  }
  this->HasPicture = true;
  this->LearnTime();
  pixels.Rgba = this->Rgba.data();
  std::copy_n(this->Whole.window, 4, pixels.Window);
  pixels.Depth = &this->Depth;
  pixels.Cast = [this](const float* depths, std::vector<float>& rgba) {
    if (this->Picture.IsWhole(depths)) {
      rgba = this->Rgba;
      return true;
    }
    const stratus_image image = this->Picture.MakeRoom(rgba, this->PartDepth, depths);
    stratus_ray_cast_report reports[STRATUS_SEVERAL_MAX];
    return stratus_ray_caster_render_several(this->Inputs, this->Count, &this->Picture.Camera, &image, reports) == STRATUS_OK;
  };
  return this->Display.Draw(renderer, this->Picture, pixels, error);
}

vtkImageData* vtkStratusMultiVolume::Internals::GetLastImage()
{
  if (!this->HasPicture) {
    return nullptr;
  }
  this->LastImage = this->Picture.MakeImage(this->Rgba, this->Depth, this->HasSamples ? &this->Samples : nullptr);
  return this->LastImage;
}

// ---------------------------------------------------------------- the prop

vtkStandardNewMacro(vtkStratusMultiVolume);

vtkStratusMultiVolume::vtkStratusMultiVolume() : Internal(new Internals(this)) {}

vtkStratusMultiVolume::~vtkStratusMultiVolume() = default;

void vtkStratusMultiVolume::SetVolume(vtkVolume* volume, int port)
{
  if (port < 0 || port >= STRATUS_SEVERAL_MAX) {
    vtkErrorMacro(<< "port " << port << " must be 0.." << STRATUS_SEVERAL_MAX - 1);
    return;
  }
  if (volume == this) {
    vtkErrorMacro(<< "a vtkStratusMultiVolume can't hold itself");
    return;
  }
  for (int other = 0; volume && other < STRATUS_SEVERAL_MAX; ++other) {
    if (other != port && this->Internal->Volumes[other] == volume) {
      vtkErrorMacro(<< "the volume for port " << port << " is at port " << other << " already; remove it there");
      return;
    }
  }
  if (this->Internal->Volumes[port] != volume) {
    this->Internal->Volumes[port] = volume;
    this->Modified();
  }
}

vtkVolume* vtkStratusMultiVolume::GetVolume(int port)
{
  return port >= 0 && port < STRATUS_SEVERAL_MAX ? this->Internal->Volumes[port].GetPointer() : nullptr;
}

int vtkStratusMultiVolume::GetNumberOfVolumes()
{
  return static_cast<int>(std::count_if(
    std::begin(this->Internal->Volumes), std::end(this->Internal->Volumes), [](vtkVolume* volume) { return volume != nullptr; }));
}

void vtkStratusMultiVolume::SetProperty(vtkVolumeProperty*) {}

vtkVolumeProperty* vtkStratusMultiVolume::GetProperty()
{
  const int lowest = this->Internal->GetLowest();
  return lowest < 0 ? nullptr : this->Internal->Volumes[lowest]->GetProperty();
}

double* vtkStratusMultiVolume::GetBounds()
{
  vtkBoundingBox all;
  for (vtkVolume* volume : this->Internal->Volumes) {
    const double* bounds = volume && volume->GetVisibility() && volume->GetMapper() ? volume->GetBounds() : nullptr;
    if (bounds && bounds[0] <= bounds[1]) {
      all.AddBounds(bounds);
    }
  }
  vtkMath::UninitializeBounds(this->Bounds);
  if (all.IsValid()) {
    all.GetBounds(this->Bounds);
  }
  return this->Bounds;
}

vtkMTimeType vtkStratusMultiVolume::GetMTime()
{
  vtkMTimeType time = this->vtkProp3D::GetMTime();
  for (vtkVolume* volume : this->Internal->Volumes) {
    time = std::max(time, volume ? volume->GetMTime() : 0);
  }
  return time;
}

vtkMTimeType vtkStratusMultiVolume::GetRedrawMTime()
{
  vtkMTimeType time = this->GetMTime();
  for (vtkVolume* volume : this->Internal->Volumes) {
    time = std::max(time, volume ? volume->GetRedrawMTime() : 0);
  }
  return time;
}

void vtkStratusMultiVolume::ShallowCopy(vtkProp* prop)
{
  vtkStratusMultiVolume* other = vtkStratusMultiVolume::SafeDownCast(prop);
  for (int port = 0; other && port < STRATUS_SEVERAL_MAX; ++port) {
    this->Internal->Volumes[port] = other->Internal->Volumes[port];
  }
  this->Superclass::ShallowCopy(prop);
}

int vtkStratusMultiVolume::RenderVolumetricGeometry(vtkViewport* viewport)
{
  const auto start = std::chrono::steady_clock::now();
  std::string error;
  vtkRenderer* renderer = vtkRenderer::SafeDownCast(viewport);
  if (renderer) {
    this->Internal->Render(renderer, error);
  }
  std::swap(error, this->Internal->LastError);
  if (!this->Internal->LastError.empty() && this->Internal->LastError != error) { // reported once, not with every picture
    vtkErrorMacro(<< this->Internal->LastError << "; nothing is drawn");
  }
  this->EstimatedRenderTime += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return this->Internal->LastError.empty() && this->Internal->GetLowest() >= 0 ? 1 : 0;
}

void vtkStratusMultiVolume::ReleaseGraphicsResources(vtkWindow* window)
{
  this->Internal->Display.ReleaseGraphicsResources(window);
  this->Superclass::ReleaseGraphicsResources(window);
}

const char* vtkStratusMultiVolume::GetLastError()
{
  return this->Internal->LastError.c_str();
}

vtkImageData* vtkStratusMultiVolume::GetLastImage()
{
  return this->Internal->GetLastImage();
}

#define REPORT(type, getter, field)                                                                                                        \
  type vtkStratusMultiVolume::getter()                                                                                                     \
  {                                                                                                                                        \
    return this->Internal->Whole.field;                                                                                                    \
  }
REPORT(vtkTypeUInt64, GetSamplesTaken, samples)
REPORT(vtkTypeUInt64, GetSamplesSkipped, skipped)
REPORT(vtkTypeUInt64, GetDifferingPixels, differing_pixels)
REPORT(double, GetCastTime, cast_ms)

const char* vtkStratusMultiVolume::GetReason(int port)
{
  return this->GetVolume(port) ? this->Internal->Reports[port].why : "";
}

double vtkStratusMultiVolume::GetUsedSampleDistance(int port)
{
  return this->GetVolume(port) ? this->Internal->Reports[port].sample_distance : 0.0;
}

void vtkStratusMultiVolume::PrintSelf(ostream& os, vtkIndent indent)
{
  this->vtkProp3D::PrintSelf(os, indent);
  for (int port = 0; port < STRATUS_SEVERAL_MAX; ++port) {
    if (vtkVolume* volume = this->Internal->Volumes[port]) {
      os << indent << "Volume " << port << ": " << volume << "\n";
    }
  }
  os << indent << "Last picture: " << this->GetSamplesTaken() << " samples, " << this->GetSamplesSkipped() << " skipped, "
     << this->GetCastTime() << " ms\n";
}
