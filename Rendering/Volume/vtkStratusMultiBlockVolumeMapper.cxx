// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusMultiBlockVolumeMapper.h"

#include "vtkStratusVolumeMapper.h"

#include "vtkAlgorithm.h"
#include "vtkBoundingBox.h"
#include "vtkCamera.h"
#include "vtkCompositeDataSet.h"
#include "vtkDataObjectTree.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkMath.h"
#include "vtkMatrix4x4.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPlaneCollection.h"
#include "vtkRectilinearGrid.h"
#include "vtkRenderer.h"
#include "vtkSmartPointer.h"
#include "vtkVolume.h"

#include <algorithm>
#include <array>
#include <string>
#include <vector>

namespace {

// Where rays come from in the data's coordinates: a point, or a direction for parallel projections.
struct Eye {
  double Point[4];                            // w is 0 for a direction, which points away from the scene
  double Middle(const double bounds[6]) const // how far the box's middle is, in some unit
  {
    double sum = 0.0;
    for (int axis = 0; axis < 3; ++axis) {
      const double middle = 0.5 * (bounds[2 * axis] + bounds[2 * axis + 1]);
      sum += this->Point[3] != 0.0 ? (middle - this->Point[axis]) * (middle - this->Point[axis]) : -middle * this->Point[axis];
    }
    return sum;
  }
};

struct Block {
  vtkDataSet* Grid = nullptr;
  double Bounds[6];
};

Eye EyeOf(vtkRenderer* renderer, vtkVolume* volume)
{
  vtkCamera* camera = renderer->GetActiveCamera();
  Eye eye = { { 0.0, 0.0, 0.0, camera->GetParallelProjection() ? 0.0 : 1.0 } };
  const double* from = camera->GetPosition();
  const double* along = camera->GetDirectionOfProjection();
  for (int axis = 0; axis < 3; ++axis) {
    eye.Point[axis] = camera->GetParallelProjection() ? -along[axis] : from[axis];
  }
  vtkNew<vtkMatrix4x4> inverse;
  vtkMatrix4x4::Invert(volume->GetMatrix(), inverse);
  inverse->MultiplyPoint(eye.Point, eye.Point);
  return eye;
}

// Whether `near` may hide something of `far`: no plane across an axis that parts them has the eye on the side of `far`.
bool MayHide(const Block& near, const Block& far, const Eye& eye)
{
  for (int axis = 0; axis < 3; ++axis) {
    const double plane[2] = { far.Bounds[2 * axis + 1], far.Bounds[2 * axis] };
    if (near.Bounds[2 * axis] >= plane[0] && eye.Point[axis] <= (eye.Point[3] != 0.0 ? plane[0] : 0.0)) {
      return false; // far is below the plane, as the eye is
    }
    if (near.Bounds[2 * axis + 1] <= plane[1] && eye.Point[axis] >= (eye.Point[3] != 0.0 ? plane[1] : 0.0)) {
      return false;
    }
  }
  return true;
}

bool Overlap(const Block& a, const Block& b)
{
  bool overlap = true;
  for (int axis = 0; overlap && axis < 3; ++axis) {
    overlap = a.Bounds[2 * axis] < b.Bounds[2 * axis + 1] && b.Bounds[2 * axis] < a.Bounds[2 * axis + 1];
  }
  return overlap;
}

// The blocks from back to front: always one that hides none of those left, the farthest of these; where each hides another, which only
// blocks that overlap or three that pass one another do, the farthest of all.
std::vector<size_t> Order(const std::vector<Block>& blocks, const Eye& eye)
{
  std::vector<size_t> left(blocks.size());
  for (size_t i = 0; i < left.size(); ++i) {
    left[i] = i;
  }
  std::stable_sort(
    left.begin(), left.end(), [&](size_t a, size_t b) { return eye.Middle(blocks[a].Bounds) > eye.Middle(blocks[b].Bounds); });
  std::vector<size_t> order;
  while (!left.empty()) {
    auto next = std::find_if(left.begin(), left.end(), [&](size_t i) {
      return std::none_of(left.begin(), left.end(), [&](size_t other) { return other != i && MayHide(blocks[i], blocks[other], eye); });
    });
    next = next == left.end() ? left.begin() : next;
    order.push_back(*next);
    left.erase(next);
  }
  return order;
}
} // namespace

class vtkStratusMultiBlockVolumeMapper::Internals
{
public:
  vtkNew<vtkStratusVolumeMapper> Settings;
  std::vector<vtkSmartPointer<vtkStratusVolumeMapper>> Mappers; // of the blocks, in the input's order
  std::string Error, Warning;

  std::vector<Block> Find(vtkDataObject* input, vtkStratusMultiBlockVolumeMapper* mapper, std::string& warning);
  void Configure(vtkStratusMultiBlockVolumeMapper* from, vtkStratusVolumeMapper* to) const;
};

vtkStandardNewMacro(vtkStratusMultiBlockVolumeMapper);

vtkStratusMultiBlockVolumeMapper::vtkStratusMultiBlockVolumeMapper() : Internal(new Internals) {}

vtkStratusMultiBlockVolumeMapper::~vtkStratusMultiBlockVolumeMapper() = default;

int vtkStratusMultiBlockVolumeMapper::FillInputPortInformation(int, vtkInformation* info)
{
  info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkImageData");
  info->Append(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkRectilinearGrid");
  info->Append(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkDataObjectTree");
  return 1;
}

std::vector<Block> vtkStratusMultiBlockVolumeMapper::Internals::Find(
  vtkDataObject* input, vtkStratusMultiBlockVolumeMapper* mapper, std::string& warning)
{
  std::vector<vtkDataSet*> grids;
  auto* tree = vtkDataObjectTree::SafeDownCast(input);
  if (tree) {
    grids = vtkCompositeDataSet::GetDataSets(tree);
  } else if (auto* grid = vtkDataSet::SafeDownCast(input)) {
    grids.push_back(grid);
  }
  std::vector<Block> blocks;
  for (vtkDataSet* grid : grids) {
    int unused = 0;
    const bool kind = vtkImageData::SafeDownCast(grid) || vtkRectilinearGrid::SafeDownCast(grid);
    if (tree && !kind) {
      warning = std::string("a block is a ") + grid->GetClassName() + ", no image and no rectilinear grid, and is left out";
    } else if (tree && grid->GetNumberOfPoints() == 0) {
      continue;
    } else if (tree &&
      !vtkAbstractMapper::GetScalars(
        grid, mapper->GetScalarMode(), mapper->GetArrayAccessMode(), mapper->GetArrayId(), mapper->GetArrayName(), unused)) {
      warning = std::string("a block lacks the array \"") + (mapper->GetArrayName() ? mapper->GetArrayName() : "") + "\", and is left out";
    } else {
      Block block;
      block.Grid = grid;
      grid->GetBounds(block.Bounds);
      blocks.push_back(block);
    }
  }
  return blocks;
}

void vtkStratusMultiBlockVolumeMapper::Internals::Configure(vtkStratusMultiBlockVolumeMapper* from, vtkStratusVolumeMapper* to) const
{
  vtkStratusVolumeMapper* settings = this->Settings;
  to->SetScalarMode(from->GetScalarMode());
  if (from->GetArrayAccessMode() == VTK_GET_ARRAY_BY_ID) {
    to->SelectScalarArray(from->GetArrayId());
  } else {
    to->SelectScalarArray(from->GetArrayName());
  }
  to->SetBlendMode(from->GetBlendMode());
  to->SetAverageIPScalarRange(from->GetAverageIPScalarRange());
  to->SetCropping(from->GetCropping());
  to->SetCroppingRegionPlanes(from->GetCroppingRegionPlanes());
  to->SetCroppingRegionFlags(from->GetCroppingRegionFlags());
  to->SetClippingPlanes(from->GetClippingPlanes());
  to->SetRenderMode(settings->GetRenderMode());
  to->SetNormals(settings->GetNormals());
  to->SetSampleDistance(settings->GetSampleDistance());
  to->SetAutoAdjustSampleDistances(settings->GetAutoAdjustSampleDistances());
  to->SetInteractiveUpdateRate(settings->GetInteractiveUpdateRate());
  to->SetImageSampleDistance(settings->GetImageSampleDistance());
  to->SetMaximumImageSampleDistance(settings->GetMaximumImageSampleDistance());
  to->SetMaximumSampleDistanceFactor(settings->GetMaximumSampleDistanceFactor());
  to->SetFinalColorWindow(settings->GetFinalColorWindow());
  to->SetFinalColorLevel(settings->GetFinalColorLevel());
  to->SetStructure(settings->GetStructure());
  to->SetSampling(settings->GetSampling());
  to->SetCellError(settings->GetCellError());
  to->SetGradientOpacityDistance(settings->GetGradientOpacityDistance());
  to->SetComponentMixing(settings->GetComponentMixing());
  to->SetVectorMode(settings->GetVectorMode());
  to->SetVectorComponent(settings->GetVectorComponent());
  to->SetTransfer2DYAxisArray(settings->GetTransfer2DYAxisArray());
  to->SetUseJittering(settings->GetUseJittering());
  to->SetJitterSeed(settings->GetJitterSeed());
  to->SetImageErrorTolerance(settings->GetImageErrorTolerance());
  to->SetTermination(settings->GetTermination());
  to->SetBlockSize(settings->GetBlockSize());
  to->SetDevice(settings->GetDevice());
  to->SetNumberOfThreads(settings->GetNumberOfThreads());
  to->SetAudit(settings->GetAudit());
  to->SetCountSamples(settings->GetCountSamples());
}

void vtkStratusMultiBlockVolumeMapper::Render(vtkRenderer* renderer, vtkVolume* volume)
{
  this->GetInputAlgorithm()->Update();
  std::string error, warning;
  const std::vector<Block> blocks = this->Internal->Find(this->GetInputDataObject(0, 0), this, warning);
  auto& mappers = this->Internal->Mappers;
  const int mode = this->GetBlendMode();
  const bool blends = mode == COMPOSITE_BLEND || mode == ISOSURFACE_BLEND || mode == SLICE_BLEND;
  if (blocks.size() > 1 && !blends) {
    error = "blend mode " + std::to_string(mode) + " is not supported for more than one block; composite, isosurface and slice are";
  } else {
    mappers.resize(blocks.size());
    for (size_t i = 0; i < blocks.size(); ++i) {
      if (!mappers[i]) {
        mappers[i] = vtkSmartPointer<vtkStratusVolumeMapper>::New();
      }
      this->Internal->Configure(this, mappers[i]);
      mappers[i]->SetInputDataObject(blocks[i].Grid);
      for (size_t j = 0; j < i; ++j) {
        if (Overlap(blocks[i], blocks[j])) {
          warning = "blocks overlap, and are drawn one over the other";
        }
      }
    }
    bool first = true;
    for (const size_t i : Order(blocks, EyeOf(renderer, volume))) {
      mappers[i]->FollowsBlock = !first;
      mappers[i]->Render(renderer, volume);
      error = mappers[i]->GetLastError()[0] ? mappers[i]->GetLastError() : error;
      first = false;
    }
  }
  if (!error.empty() && error != this->Internal->Error && mappers.empty()) { // each block's mapper has told of its own
    vtkErrorMacro(<< error << "; nothing is drawn");
  }
  if (!warning.empty() && warning != this->Internal->Warning) {
    vtkWarningMacro(<< warning);
  }
  this->Internal->Error = error;
  this->Internal->Warning = warning;
}

vtkStratusVolumeMapper* vtkStratusMultiBlockVolumeMapper::GetSettings()
{
  return this->Internal->Settings;
}

int vtkStratusMultiBlockVolumeMapper::GetNumberOfBlocks()
{
  return static_cast<int>(this->Internal->Mappers.size());
}

vtkStratusVolumeMapper* vtkStratusMultiBlockVolumeMapper::GetBlockMapper(int block)
{
  return block >= 0 && block < this->GetNumberOfBlocks() ? this->Internal->Mappers[static_cast<size_t>(block)].Get() : nullptr;
}

const char* vtkStratusMultiBlockVolumeMapper::GetLastError()
{
  return this->Internal->Error.c_str();
}

double* vtkStratusMultiBlockVolumeMapper::GetBounds()
{
  vtkMath::UninitializeBounds(this->Bounds);
  if (this->GetNumberOfInputConnections(0) > 0) {
    this->GetInputAlgorithm()->Update();
    vtkDataObject* input = this->GetInputDataObject(0, 0);
    if (auto* grid = vtkDataSet::SafeDownCast(input)) {
      grid->GetBounds(this->Bounds);
    } else if (auto* tree = vtkCompositeDataSet::SafeDownCast(input)) {
      vtkBoundingBox box;
      for (vtkDataSet* block : vtkCompositeDataSet::GetDataSets(tree)) {
        box.AddBounds(block->GetBounds());
      }
      if (box.IsValid()) {
        box.GetBounds(this->Bounds);
      }
    }
  }
  return this->Bounds;
}

vtkMTimeType vtkStratusMultiBlockVolumeMapper::GetMTime()
{
  return std::max(this->Superclass::GetMTime(), this->Internal->Settings->GetMTime());
}

void vtkStratusMultiBlockVolumeMapper::ReleaseGraphicsResources(vtkWindow* window)
{
  for (const auto& mapper : this->Internal->Mappers) {
    if (mapper) {
      mapper->ReleaseGraphicsResources(window);
    }
  }
  this->Superclass::ReleaseGraphicsResources(window);
}

void vtkStratusMultiBlockVolumeMapper::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "NumberOfBlocks: " << this->GetNumberOfBlocks() << "\n";
  os << indent << "LastError: " << this->Internal->Error << "\n";
  os << indent << "Settings:\n";
  this->Internal->Settings->PrintSelf(os, indent.GetNextIndent());
}
