// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusRayQuantities.h"

#include "vtkStratusAMR.h"
#include "vtkStratusBlocks.h"
#include "vtkStratusContext.h"
#include "vtkStratusInput.h"
#include "vtkStratusMeshView.h"
#include "vtkStratusQuantities.h"

#include "vtkCellData.h"
#include "vtkCompositeDataSet.h"
#include "vtkDataArray.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkMath.h"
#include "vtkMatrix3x3.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkRectilinearGrid.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkStructuredGrid.h"
#include "vtkUniformGridAMR.h"
#include "vtkUnstructuredGridBase.h"

#include <algorithm>
#include <cmath>
#include <new>

vtkStandardNewMacro(vtkStratusRayQuantities);

namespace {
constexpr int MostCells = 1024, Side = 512, MostRays = 16384;

// Where the rays are: the image's middle and the vectors from there to its edges, and their direction and length.
struct Rays {
  double Right[3], Up[3], Forward[3]; // of length 1
  double Middle[3];
  double Half[2], Depth;
  int Size[2];
};

void AddBounds(vtkDataSet* set, double bounds[6])
{
  double own[6];
  set->GetBounds(own);
  for (int axis = 0; axis < 3 && set->GetNumberOfPoints() > 0; ++axis) {
    bounds[2 * axis] = std::min(bounds[2 * axis], own[2 * axis]);
    bounds[2 * axis + 1] = std::max(bounds[2 * axis + 1], own[2 * axis + 1]);
  }
}

// The axes along the image's, where rays look along one.
void FindAxes(int view, int axes[2])
{
  axes[0] = view == vtkStratusRayQuantities::X_AXIS ? 1 : 0;
  axes[1] = view == vtkStratusRayQuantities::X_AXIS || view == vtkStratusRayQuantities::Y_AXIS ? 2 : 1;
}

// The number of cells along an axis of data with an extent; else 0.
int CellsAlong(vtkInformation* info, int axis)
{
  int extent[6] = { 0, 0, 0, 0, 0, 0 };
  if (info->Has(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT())) {
    info->Get(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT(), extent);
  }
  return std::min(std::max(extent[2 * axis + 1] - extent[2 * axis], 0), MostCells);
}

// Gives the output the rays' places. For an axis the image has the world's axes, which more filters understand than a turned image.
void PlaceImage(const Rays& rays, int view, vtkImageData* output)
{
  using Filter = vtkStratusRayQuantities;
  int axes[2];
  FindAxes(view, axes);
  const int first = axes[0], second = axes[1];
  int dimensions[3] = { 1, 1, 1 };
  double spacing[3] = { 1.0, 1.0, 1.0 }, origin[3];
  dimensions[first] = rays.Size[0];
  dimensions[second] = rays.Size[1];
  spacing[first] = 2.0 * rays.Half[0] / rays.Size[0];
  spacing[second] = 2.0 * rays.Half[1] / rays.Size[1];
  for (int axis = 0; axis < 3; ++axis) {
    origin[axis] =
      rays.Middle[axis] - (rays.Half[0] - 0.5 * spacing[first]) * rays.Right[axis] - (rays.Half[1] - 0.5 * spacing[second]) * rays.Up[axis];
  }
  output->SetDimensions(dimensions);
  output->SetSpacing(spacing);
  output->SetOrigin(origin);
  if (view == Filter::ANY_DIRECTION) {
    const double *r = rays.Right, *u = rays.Up, *f = rays.Forward;
    output->SetDirectionMatrix(r[0], u[0], -f[0], r[1], u[1], -f[1], r[2], u[2], -f[2]);
  }
}
} // namespace

class vtkStratusRayQuantities::Internals
{
public:
  explicit Internals(vtkStratusRayQuantities* filter)
      : Filter(filter), Context([filter](double fraction) {
          filter->UpdateProgress(fraction);
          return filter->GetAbortExecute() != 0;
        })
  {
    this->Context.OnRelease = [this]() { this->ReleaseCasters(); };
  }
  ~Internals() { this->ReleaseCasters(); }

  bool Run(vtkDataObject* input, vtkImageData* output, std::string& error);

  int Size[2] = { 1, 1 };

private:
  // Returns the array of a grid, and whether it is of cells; the first one stays as Array.
  vtkDataArray* FindArray(vtkDataSet* set, bool& cells);
  bool AddGrid(vtkDataSet* grid, vtkDataArray* array, bool cells, const float* gradients, std::string& error);
  bool AddMesh(vtkDataSet* grid, vtkDataArray* array, bool cells, std::string& error);
  bool AddAll(vtkDataObject* input, std::string& error);
  bool AddComposite(vtkCompositeDataSet* whole, std::string& error);
  bool MakeCasters(std::string& error);
  bool Place(Rays& rays, std::string& error) const;
  void ReleaseCasters();

  vtkStratusRayQuantities* Filter;
  vtkStratusContext Context;
  vtkStratusQuantities Quantities;
  std::vector<std::unique_ptr<vtkStratusImageView>> Grids;
  std::unique_ptr<vtkStratusMeshView> Mesh;
  vtkStratusAMR Refined;
  vtkStratusBlocks Blocks;
  std::vector<stratus_ray_caster*> Casters;
  stratus_tetra_caster* Tetra = nullptr;
  vtkDataArray* Array = nullptr; // the first one; while the filter runs
  double Bounds[6];
};

void vtkStratusRayQuantities::Internals::ReleaseCasters()
{
  for (stratus_ray_caster* caster : this->Casters) {
    stratus_ray_caster_destroy(caster);
  }
  this->Casters.clear();
  stratus_tetra_caster_destroy(this->Tetra);
  this->Tetra = nullptr;
}

vtkDataArray* vtkStratusRayQuantities::Internals::FindArray(vtkDataSet* set, bool& cells)
{
  int association = 0;
  vtkDataArray* array = this->Filter->GetInputArrayToProcess(0, set, association);
  cells = association == vtkDataObject::CELL;
  this->Array = this->Array ? this->Array : array;
  return array;
}

bool vtkStratusRayQuantities::Internals::AddGrid(
  vtkDataSet* grid, vtkDataArray* array, bool cells, const float* gradients, std::string& error)
{
  this->Grids.push_back(std::make_unique<vtkStratusImageView>());
  AddBounds(grid, this->Bounds);
  if (!this->Grids.back()->Set(grid, array, cells, nullptr, error, 1, 0)) {
    return false;
  }
  this->Grids.back()->SetGradients(gradients);
  return true;
}

bool vtkStratusRayQuantities::Internals::AddMesh(vtkDataSet* grid, vtkDataArray* array, bool cells, std::string& error)
{
  this->Mesh = std::make_unique<vtkStratusMeshView>();
  AddBounds(grid, this->Bounds);
  return this->Mesh->Set(grid, array, cells, nullptr, error, STRATUS_COMPONENTS_MAX);
}

// Images and rectilinear grids stay blocks; where there is another grid among them, all become one mesh.
bool vtkStratusRayQuantities::Internals::AddComposite(vtkCompositeDataSet* whole, std::string& error)
{
  std::vector<vtkDataSet*> parts = vtkCompositeDataSet::GetDataSets(whole);
  const auto is_empty = [](vtkDataSet* part) { return part->GetNumberOfPoints() == 0; };
  parts.erase(std::remove_if(parts.begin(), parts.end(), is_empty), parts.end());
  if (std::all_of(parts.begin(), parts.end(), [](vtkDataSet* part) { return vtkStratusAsImage(part) != nullptr; })) {
    for (vtkDataSet* part : parts) {
      bool cells = false;
      vtkDataArray* array = this->FindArray(part, cells);
      if (array && !this->AddGrid(part, array, cells, nullptr, error)) {
        return false;
      }
    }
    return true;
  }
  const auto find = [this](vtkDataSet* part, int& of_cells) {
    bool cells = false;
    vtkDataArray* array = this->FindArray(part, cells);
    of_cells = cells ? 1 : 0;
    return array;
  };
  if (!this->Blocks.Set(whole, find, error, false)) {
    return false;
  }
  return !this->Blocks.GetGrid() || this->AddMesh(this->Blocks.GetGrid(), this->Blocks.GetScalars(), this->Blocks.OfCells(), error);
}

bool vtkStratusRayQuantities::Internals::AddAll(vtkDataObject* input, std::string& error)
{
  this->Grids.clear();
  this->Mesh.reset();
  this->Array = nullptr;
  for (int side = 0; side < 6; ++side) {
    this->Bounds[side] = side % 2 ? -HUGE_VAL : HUGE_VAL;
  }
  if (auto* amr = vtkUniformGridAMR::SafeDownCast(input)) {
    const auto find = [this](vtkDataSet* box, bool& cells) { return this->FindArray(box, cells); };
    bool added = this->Refined.Set(amr, find, vtkStratusAMR::Use(), error);
    for (const auto& grid : this->Refined.GetGrids()) {
      vtkDataSetAttributes* data =
        this->Refined.HasCells() ? static_cast<vtkDataSetAttributes*>(grid->GetCellData()) : grid->GetPointData();
      added = added && this->AddGrid(grid, data->GetScalars(), this->Refined.HasCells(), vtkStratusAMR::GetGradients(grid), error);
    }
    return added;
  }
  if (auto* whole = vtkCompositeDataSet::SafeDownCast(input)) {
    return this->AddComposite(whole, error);
  }
  vtkDataSet* set = vtkDataSet::SafeDownCast(input);
  bool cells = false;
  vtkDataArray* array = set ? this->FindArray(set, cells) : nullptr;
  if (!array) {
    return true; // reported with the other inputs that have none
  }
  return vtkStratusAsImage(set) ? this->AddGrid(set, array, cells, nullptr, error) : this->AddMesh(set, array, cells, error);
}

bool vtkStratusRayQuantities::Internals::MakeCasters(std::string& error)
{
  stratus_status status = STRATUS_OK;
  while (this->Casters.size() < this->Grids.size() && status == STRATUS_OK) {
    stratus_ray_caster* caster = nullptr;
    status = stratus_ray_caster_create(this->Context.Get(), &caster);
    this->Casters.push_back(caster);
  }
  if (status == STRATUS_OK && this->Mesh && !this->Tetra) {
    status = stratus_tetra_caster_create(this->Context.Get(), &this->Tetra);
  }
  error = status == STRATUS_OK ? "" : stratus_context_message(this->Context.Get());
  return status == STRATUS_OK;
}

bool vtkStratusRayQuantities::Internals::Place(Rays& rays, std::string& error) const
{
  const int view = this->Filter->View;
  int across[2];
  FindAxes(view, across);
  if (view != ANY_DIRECTION) {
    for (int axis = 0; axis < 3; ++axis) {
      rays.Right[axis] = axis == across[0] ? 1.0 : 0.0;
      rays.Up[axis] = axis == across[1] ? 1.0 : 0.0;
      rays.Forward[axis] = axis == view ? -1.0 : 0.0;
    }
  } else {
    std::copy_n(this->Filter->Direction, 3, rays.Forward);
    const double length = vtkMath::Normalize(rays.Forward);
    if (!(length > 0.0) || !std::isfinite(length)) {
      error = "Direction must be finite and longer than 0";
      return false;
    }
    const bool steep = std::abs(rays.Forward[2]) > 0.999;
    const double upright[3] = { 0.0, steep ? 1.0 : 0.0, steep ? 0.0 : 1.0 };
    vtkMath::Cross(rays.Forward, upright, rays.Right);
    vtkMath::Normalize(rays.Right);
    vtkMath::Cross(rays.Right, rays.Forward, rays.Up);
  }
  double lo[3] = { HUGE_VAL, HUGE_VAL, HUGE_VAL }, hi[3] = { -HUGE_VAL, -HUGE_VAL, -HUGE_VAL };
  const double* axes[3] = { rays.Right, rays.Up, rays.Forward };
  for (int corner = 0; corner < 8; ++corner) {
    const double at[3] = { this->Bounds[corner & 1], this->Bounds[2 + (corner >> 1 & 1)], this->Bounds[4 + (corner >> 2)] };
    for (int axis = 0; axis < 3; ++axis) {
      lo[axis] = std::min(lo[axis], vtkMath::Dot(at, axes[axis]));
      hi[axis] = std::max(hi[axis], vtkMath::Dot(at, axes[axis]));
    }
  }
  for (int axis = 0; axis < 3; ++axis) {
    rays.Middle[axis] = 0.5 * (lo[0] + hi[0]) * rays.Right[axis] + 0.5 * (lo[1] + hi[1]) * rays.Up[axis] + lo[2] * rays.Forward[axis];
  }
  rays.Depth = hi[2] - lo[2];
  for (int side = 0; side < 2; ++side) {
    rays.Half[side] = 0.5 * (hi[side] - lo[side]);
    if (!(rays.Half[side] > 0.0)) {
      error = "the data are flat, and no ray goes through them";
      return false;
    }
  }
  std::copy_n(this->Size, 2, rays.Size);
  return true;
}

bool vtkStratusRayQuantities::Internals::Run(vtkDataObject* input, vtkImageData* output, std::string& error)
{
  const vtkStratusRayQuantities* f = this->Filter;
  std::string names;
  const std::pair<bool, const char*> wishes[] = { { f->Integral, "integral" }, { f->Length, "length" }, { f->Mean, "mean" },
    { f->Maximum, "maximum" }, { f->MaximumDepth, "maximum_depth" }, { f->Cells, "cells" } };
  for (const auto& wish : wishes) {
    names += wish.first ? std::string(wish.second) + " " : "";
  }
  if (names.empty()) {
    error = "no quantity is chosen";
    return false;
  }
  this->Context.SetDevice(f->Device, 0, error);
  if (!error.empty() || !this->Quantities.Set(names.c_str(), 0.5, error) || !this->Context.Prepare(0, error) ||
    !this->AddAll(input, error)) {
    return false;
  }
  if (this->Grids.empty() && !this->Mesh) {
    error = "the input has no grid with the array";
    return false;
  }
  Rays rays;
  if (!this->Place(rays, error) || !this->MakeCasters(error)) {
    return false;
  }
  stratus_camera camera = stratus_camera();
  camera.parallel = 1;
  camera.near_k = -1e-3 * rays.Depth; // nothing of the data is cut off by rounding
  camera.far_k = 1.001 * rays.Depth;
  for (int axis = 0; axis < 3; ++axis) {
    camera.eye[axis] = rays.Middle[axis];
    camera.forward[axis] = rays.Forward[axis];
    camera.right[axis] = rays.Half[0] * rays.Right[axis];
    camera.up[axis] = rays.Half[1] * rays.Up[axis];
  }
  std::vector<stratus_ray_cast_input> inputs(this->Mesh ? 1 : this->Grids.size());
  const stratus_ray_cast_options options = stratus_ray_cast_options_default();
  const stratus_tetra_options tetra_options = stratus_tetra_options_default();
  for (size_t i = 0; i < inputs.size(); ++i) {
    inputs[i].caster = this->Mesh ? nullptr : this->Casters[i];
    inputs[i].volume = this->Mesh ? nullptr : &this->Grids[i]->GetVolume();
    inputs[i].options = this->Mesh ? nullptr : &options;
    inputs[i].tetra = this->Mesh ? this->Tetra : nullptr;
    inputs[i].mesh = this->Mesh ? &this->Mesh->GetMesh() : nullptr;
    inputs[i].tetra_options = this->Mesh ? &tetra_options : nullptr;
  }
  const double identity[9] = { 1, 0, 0, 0, 1, 0, 0, 0, 1 };
  this->Quantities.ForgetVolumes();
  this->Quantities.AddData(input, this->Array, identity);
  stratus_image image = stratus_image();
  image.width = rays.Size[0];
  image.height = rays.Size[1];
  if (!this->Quantities.Compute(this->Context.Get(), inputs.data(), static_cast<int>(inputs.size()), !this->Mesh, camera, image, error)) {
    return false;
  }
  PlaceImage(rays, f->View, output);
  this->Quantities.AddTo(output);
  output->GetPointData()->SetActiveScalars(output->GetPointData()->GetArrayName(0));
  return true;
}

vtkStratusRayQuantities::vtkStratusRayQuantities() : Internal(new Internals(this))
{
  this->SetInputArrayToProcess(0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS_THEN_CELLS, vtkDataSetAttributes::SCALARS);
}

vtkStratusRayQuantities::~vtkStratusRayQuantities()
{
  this->SetDevice(nullptr);
}

int vtkStratusRayQuantities::FillInputPortInformation(int, vtkInformation* info)
{
  info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkImageData");
  for (const char* type : { "vtkRectilinearGrid", "vtkStructuredGrid", "vtkUnstructuredGrid", "vtkDataObjectTree", "vtkUniformGridAMR" }) {
    info->Append(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), type);
  }
  return 1;
}

int vtkStratusRayQuantities::RequestInformation(vtkInformation*, vtkInformationVector** inputs, vtkInformationVector* outputs)
{
  int axes[2], extent[6] = { 0, 0, 0, 0, 0, 0 };
  FindAxes(this->View, axes);
  for (int side = 0; side < 2; ++side) {
    const int own = this->View == ANY_DIRECTION ? 0 : CellsAlong(inputs[0]->GetInformationObject(0), axes[side]);
    if (this->Resolution[side] < 0 || this->Resolution[side] > MostRays) {
      vtkErrorMacro(<< "Resolution " << this->Resolution[side] << " must be 0.." << MostRays);
      return 0;
    }
    this->Internal->Size[side] = this->Resolution[side] > 0 ? this->Resolution[side] : own > 0 ? own : Side;
    extent[2 * axes[side] + 1] = this->Internal->Size[side] - 1;
  }
  outputs->GetInformationObject(0)->Set(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT(), extent, 6);
  return 1;
}

// All of the input is needed, whatever part of the output is.
int vtkStratusRayQuantities::RequestUpdateExtent(vtkInformation*, vtkInformationVector** inputs, vtkInformationVector* outputs)
{
  vtkInformation *in = inputs[0]->GetInformationObject(0), *out = outputs->GetInformationObject(0);
  if (in->Has(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT())) {
    int extent[6];
    in->Get(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT(), extent);
    in->Set(vtkStreamingDemandDrivenPipeline::UPDATE_EXTENT(), extent, 6);
  }
  this->Pieces = out->Has(vtkStreamingDemandDrivenPipeline::UPDATE_NUMBER_OF_PIECES())
    ? out->Get(vtkStreamingDemandDrivenPipeline::UPDATE_NUMBER_OF_PIECES())
    : 1;
  return 1;
}

int vtkStratusRayQuantities::RequestData(vtkInformation*, vtkInformationVector** inputs, vtkInformationVector* outputs)
{
  vtkImageData* output = vtkImageData::GetData(outputs);
  std::string error;
  output->Initialize();
  try {
    if (this->Pieces > 1) {
      error = "numbers of rays are computed on one rank, and there are " + std::to_string(this->Pieces);
    } else if (!this->Internal->Run(vtkDataObject::GetData(inputs[0]), output, error)) {
      output->Initialize();
    }
  } catch (const std::bad_alloc&) {
    error = "there is not enough memory";
  }
  if (!error.empty()) {
    vtkErrorMacro(<< error);
  }
  return error.empty() ? 1 : 0;
}

void vtkStratusRayQuantities::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Integral: " << this->Integral << "\n";
  os << indent << "Length: " << this->Length << "\n";
  os << indent << "Mean: " << this->Mean << "\n";
  os << indent << "Maximum: " << this->Maximum << "\n";
  os << indent << "MaximumDepth: " << this->MaximumDepth << "\n";
  os << indent << "Cells: " << this->Cells << "\n";
  os << indent << "View: " << this->View << "\n";
  os << indent << "Direction: " << this->Direction[0] << " " << this->Direction[1] << " " << this->Direction[2] << "\n";
  os << indent << "Resolution: " << this->Resolution[0] << " " << this->Resolution[1] << "\n";
  os << indent << "Device: " << (this->Device ? this->Device : "auto") << "\n";
}
