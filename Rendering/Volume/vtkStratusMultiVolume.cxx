// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusMultiVolume.h"

#include "vtkStratusDepthOrder.h"
#include "vtkStratusJointPicture.h"
#include "vtkStratusMeshDescription.h"
#include "vtkStratusTetrahedraMapper.h"
#include "vtkStratusVolumeMapperInternals.h"
#include "vtkStratusSurfaces.h"

#include "vtkBoundingBox.h"
#include "vtkCommand.h"
#include "vtkImageData.h"
#include "vtkMath.h"
#include "vtkObjectFactory.h"
#include "vtkRenderWindow.h"
#include "vtkRenderer.h"
#include "vtkVolumeProperty.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <new>

class VTK_STRATUS_PRIVATE vtkStratusMultiVolume::Internals
{
public:
  explicit Internals(vtkStratusMultiVolume* prop);
  ~Internals();

  bool Render(vtkRenderer* renderer, std::string& error);
  vtkStratusVolumeMapper* GetMapper(int port) const;
  int GetLowest() const; // the lowest port with a volume; -1: none

  vtkStratusMultiVolume* Prop;
  vtkSmartPointer<vtkVolume> Volumes[STRATUS_SEVERAL_MAX];
  stratus_ray_cast_report Reports[STRATUS_SEVERAL_MAX]; // of each port
  stratus_ray_cast_report Whole;                        // of the first of them that is drawn
  vtkStratusJointPicture Picture;
  std::string LastError;

private:
  bool OnProgress();
  bool Describe(vtkRenderer* renderer, std::string& error);
  bool DescribeVolume(vtkRenderer* renderer, vtkVolume* volume, vtkStratusVolumeMapper* mapper, std::string& error);
  bool DescribeMesh(vtkRenderer* renderer, vtkVolume* volume, vtkStratusTetrahedraMapper* mapper, std::string& error);
  bool PrepareContext(std::string& error);
  bool Cast(const stratus_camera& camera, const stratus_image& image, bool whole, std::string& error);

  vtkStratusContext Context;
  stratus_ray_caster* Casters[STRATUS_SEVERAL_MAX] = {};
  stratus_tetra_caster* TetraCasters[STRATUS_SEVERAL_MAX] = {};
  // The drawn volumes, indexed by the number of visible volumes so far. Options are of volumes, descriptions of meshes.
  int Count = 0;
  int Ports[STRATUS_SEVERAL_MAX];
  stratus_ray_cast_options Options[STRATUS_SEVERAL_MAX];
  vtkStratusMeshDescription Meshes[STRATUS_SEVERAL_MAX];
  stratus_ray_cast_input Inputs[STRATUS_SEVERAL_MAX];
  vtkStratusVolumeMapper* First = nullptr; // the mapper whose settings hold for the whole picture
  vtkRenderer* Renderer = nullptr;
  vtkStratusJointPicture::Scene Scene;
};

vtkStratusMultiVolume::Internals::Internals(vtkStratusMultiVolume* prop)
    : Prop(prop), Reports(), Whole(), Context([this](double) { return this->OnProgress(); })
{
  this->Context.OnRelease = [this] {
    for (stratus_ray_caster*& caster : this->Casters) {
      stratus_ray_caster_destroy(caster);
      caster = nullptr;
    }
    for (stratus_tetra_caster*& caster : this->TetraCasters) {
      stratus_tetra_caster_destroy(caster);
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
    stratus_ray_cast_input& input = this->Inputs[n];
    stratus_ray_caster*& caster = this->Casters[this->Ports[n]];
    stratus_tetra_caster*& tetra = this->TetraCasters[this->Ports[n]];
    if (input.mesh) {
      ready = tetra || stratus_tetra_caster_create(this->Context.Get(), &tetra) == STRATUS_OK;
      input.tetra = tetra;
    } else {
      ready = caster || stratus_ray_caster_create(this->Context.Get(), &caster) == STRATUS_OK;
      input.caster = caster;
    }
    if (!ready) {
      error = stratus_context_message(this->Context.Get());
    }
  }
  return ready;
}

// Asks a mapper of images and rectilinear grids what its volume draws.
bool vtkStratusMultiVolume::Internals::DescribeVolume(
  vtkRenderer* renderer, vtkVolume* volume, vtkStratusVolumeMapper* mapper, std::string& error)
{
  if (mapper->GetRenderMode() == vtkStratusVolumeMapper::PATH_MODE) {
    error = vtkStratusJointPicture::NoPaths;
  } else if (mapper->Internal->Describe(renderer, volume, this->Options[this->Count], error)) {
    mapper->Internal->LeftOut.Warn(mapper);
  }
  this->First = this->First ? this->First : mapper;
  this->Inputs[this->Count].volume = &mapper->Internal->Image.GetVolume();
  this->Inputs[this->Count].transfer = mapper->Internal->Functions.data();
  this->Inputs[this->Count].options = &this->Options[this->Count];
  return error.empty();
}

// Asks a mapper of tetrahedra.
bool vtkStratusMultiVolume::Internals::DescribeMesh(
  vtkRenderer* renderer, vtkVolume* volume, vtkStratusTetrahedraMapper* mapper, std::string& error)
{
  vtkStratusMeshDescription& mesh = this->Meshes[this->Count];
  if (!mapper->Describe(renderer, volume, mesh)) {
    error = mesh.Error;
    return false;
  }
  this->Inputs[this->Count].mesh = mesh.Mesh;
  this->Inputs[this->Count].transfer = mesh.Transfer;
  this->Inputs[this->Count].tetra_options = &mesh.Options;
  return true;
}

// Asks the mappers what their volumes draw.
bool vtkStratusMultiVolume::Internals::Describe(vtkRenderer* renderer, std::string& error)
{
  this->Count = 0;
  this->First = nullptr;
  for (int port = 0; port < STRATUS_SEVERAL_MAX; ++port) {
    vtkVolume* volume = this->Volumes[port];
    if (!volume || !volume->GetVisibility()) {
      continue;
    }
    vtkAbstractVolumeMapper* mapper = volume->GetMapper();
    volume->GetMatrix(); // computes it
    this->Inputs[this->Count] = stratus_ray_cast_input();
    if (auto* images = vtkStratusVolumeMapper::SafeDownCast(mapper)) {
      this->DescribeVolume(renderer, volume, images, error);
    } else if (auto* meshes = vtkStratusTetrahedraMapper::SafeDownCast(mapper)) {
      if (this->DescribeMesh(renderer, volume, meshes, error) && !this->Inputs[this->Count].mesh) {
        continue; // it has no cells
      }
    } else {
      error = mapper ? std::string("a mapper of class ") + mapper->GetClassName() + " is not supported" : std::string("there is no mapper");
      error += ", the volume must have a vtkStratusVolumeMapper or a vtkStratusTetrahedraMapper";
    }
    if (!error.empty()) {
      error = "the volume at port " + std::to_string(port) + ": " + error;
      return false;
    }
    this->Ports[this->Count] = port;
    ++this->Count;
  }
  if (this->Count > 0 && !this->First) {
    error = "no volume has a vtkStratusVolumeMapper, whose settings hold for the whole picture: at least one must";
  }
  return error.empty();
}

bool vtkStratusMultiVolume::Internals::Cast(const stratus_camera& camera, const stratus_image& image, bool whole, std::string& error)
{
  stratus_ray_cast_report reports[STRATUS_SEVERAL_MAX];
  stratus_status status = stratus_ray_caster_render_several(this->Inputs, this->Count, &camera, &image, reports);
  if (whole) {
    std::fill(std::begin(this->Reports), std::end(this->Reports), stratus_ray_cast_report());
    this->Whole = status == STRATUS_OK ? reports[0] : stratus_ray_cast_report();
    for (int n = 0; status == STRATUS_OK && n < this->Count; ++n) {
      this->Reports[this->Ports[n]] = reports[n];
    }
    this->Scene.Milliseconds = this->Whole.cast_ms;
    status = status == STRATUS_OK ? this->Scene.Finish(this->Inputs, this->Count, camera, image, this->Whole.window) : status;
  }
  if (status != STRATUS_OK && status != STRATUS_CANCELLED) {
    error = stratus_context_message(this->Context.Get());
  }
  return status == STRATUS_OK;
}

bool vtkStratusMultiVolume::Internals::Render(vtkRenderer* renderer, std::string& error)
{
  const int lowest = this->GetLowest();
  if (lowest < 0) {
    return true;
  }
  if (!this->Picture.Begin(renderer, this->Prop, this->Volumes[lowest]->GetMapper(), this->LastError, error)) {
    return error.empty();
  }
  if (!this->Describe(renderer, error) || this->Count == 0) {
    return error.empty();
  }
  if (!this->PrepareContext(error)) {
    return false;
  }
  this->Scene.Boxes.clear();
  for (int n = 0; n < this->Count; ++n) {
    if (this->Inputs[n].mesh) {
      this->Scene.Boxes.push_back({ &this->Meshes[n].Box, nullptr });
      continue;
    }
    if (stratus_volume_check(this->Context.Get(), this->Inputs[n].volume) != STRATUS_OK) { // the rectangle relies on it
      error = stratus_context_message(this->Context.Get());
      return false;
    }
    const bool boxed = this->Options[n].clipping.crop && this->Options[n].clipping.crop_regions == STRATUS_CROP_INSIDE;
    this->Scene.Boxes.push_back({ this->Inputs[n].volume, boxed ? this->Options[n].clipping.crop_bounds : nullptr });
  }
  this->Scene.Renderer = renderer;
  this->Scene.Prop = this->Prop;
  this->Scene.Settings = this->First;
  this->Scene.TakesShadows = vtkStratusSurfaces::TakeShadows(renderer, this->Inputs, this->Count);
  this->Scene.Cast = [this](const stratus_camera& camera, const stratus_image& image, bool whole, std::string& why) {
    return this->Cast(camera, image, whole, why);
  };
  this->Scene.Measure = [this](
                          const stratus_camera& camera, const stratus_image& image, vtkStratusQuantities& quantities, std::string& why) {
    quantities.ForgetVolumes();
    for (int n = 0; n < this->Count; ++n) {
      vtkVolume* volume = this->Volumes[this->Ports[n]];
      quantities.AddVolume(volume->GetMapper(), volume);
    }
    return quantities.Compute(this->Context.Get(), this->Inputs, this->Count, false, camera, image, why);
  };
  this->Renderer = renderer;
  const bool drawn = this->Picture.Render(this->Scene, error);
  this->Renderer = nullptr;
  return drawn;
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
  if (renderer && vtkStratusDepthOrder::Draw(renderer, this, nullptr)) {
    return 1;
  }
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

// The volumes are held only while they are drawn: the first one's mapper holds the prop that mixes them.
std::string vtkStratusMultiVolume::Mix(vtkRenderer* renderer, vtkVolume* prop, const std::vector<vtkVolume*>& volumes)
{
  const auto start = std::chrono::steady_clock::now();
  const auto isImage = [](vtkVolume* volume) { return vtkStratusVolumeMapper::SafeDownCast(volume->GetMapper()) != nullptr; };
  auto* first = vtkStratusVolumeMapper::SafeDownCast((*std::find_if(volumes.begin(), volumes.end(), isImage))->GetMapper());
  if (!first->Internal->Joint) {
    first->Internal->Joint = vtkSmartPointer<vtkStratusMultiVolume>::New();
  }
  vtkStratusMultiVolume* joint = first->Internal->Joint;
  double allotted = 0.0;
  for (vtkVolume* volume : volumes) {
    allotted += volume->GetAllocatedRenderTime();
    volume->GetMapper()->InvokeEvent(vtkCommand::VolumeMapperRenderStartEvent, nullptr);
  }
  joint->SetPropertyKeys(prop->GetPropertyKeys()); // by which a pass that peels marks what it draws
  joint->SetAllocatedRenderTime(allotted, renderer);
  std::copy(volumes.begin(), volumes.end(), joint->Internal->Volumes);
  std::string error;
  try {
    joint->Internal->Render(renderer, error);
  } catch (const std::bad_alloc&) {
    error = "there is not enough memory for the picture";
  }
  joint->Internal->LastError = error;
  for (size_t n = 0; n < volumes.size(); ++n) {
    joint->Internal->Volumes[n] = nullptr;
    if (auto* mapper = vtkStratusVolumeMapper::SafeDownCast(volumes[n]->GetMapper())) {
      mapper->Internal->SetMixed(joint->Internal->Reports[n]);
      mapper->TimeToDraw = mapper == first ? std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() : 0.0;
      if (mapper != first) {
        mapper->Internal->ReleaseJoint(renderer);
      }
    }
    volumes[n]->GetMapper()->InvokeEvent(vtkCommand::VolumeMapperRenderEndEvent, nullptr);
  }
  return error;
}

void vtkStratusMultiVolume::ReleaseGraphicsResources(vtkWindow* window)
{
  this->Internal->Picture.ReleaseGraphicsResources(window);
  this->Superclass::ReleaseGraphicsResources(window);
}

const char* vtkStratusMultiVolume::GetLastError()
{
  return this->Internal->LastError.c_str();
}

vtkImageData* vtkStratusMultiVolume::GetLastImage()
{
  return this->Internal->Picture.GetLastImage();
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
