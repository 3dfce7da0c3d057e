// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusMultiBlockVolumeMapper.h"

#include "vtkStratusAMR.h"
#include "vtkStratusBlockMask.h"
#include "vtkStratusDepthOrder.h"
#include "vtkStratusJointPicture.h"
#include "vtkStratusVolumeMapperInternals.h"
#include "vtkStratusSurfaces.h"

#include "vtkAlgorithm.h"
#include "vtkBoundingBox.h"
#include "vtkCallbackCommand.h"
#include "vtkCompositeDataSet.h"
#include "vtkDataObjectTree.h"
#include "vtkDataSetAttributes.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkMath.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkRectilinearGrid.h"
#include "vtkRenderWindow.h"
#include "vtkRenderer.h"
#include "vtkSmartPointer.h"
#include "vtkUniformGridAMR.h"
#include "vtkUnsignedCharArray.h"
#include "vtkVolume.h"
#include "vtkVolumeProperty.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <new>
#include <string>
#include <vector>

namespace {

struct Block {
  vtkDataSet* Grid = nullptr;
  double Bounds[6];
};

// The bounds of a structured grid without the cells that another piece owns, which lie about those that this one owns. Returns false where
// it owns none.
bool OwnedBounds(vtkDataSet* grid, double bounds[6])
{
  vtkUnsignedCharArray* flags = grid->GetCellGhostArray();
  if (!flags || flags->GetNumberOfValues() != grid->GetNumberOfCells()) {
    grid->GetBounds(bounds);
    return vtkMath::AreBoundsInitialized(bounds);
  }
  const auto owned = [](unsigned char flag) { return !(flag & vtkDataSetAttributes::DUPLICATECELL); };
  const unsigned char* begin = flags->GetPointer(0);
  const unsigned char* end = begin + flags->GetNumberOfValues();
  const unsigned char* first = std::find_if(begin, end, owned);
  if (first == end) {
    return false;
  }
  const unsigned char* last = std::find_if(std::make_reverse_iterator(end), std::make_reverse_iterator(begin), owned).base() - 1;
  vtkBoundingBox box;
  for (const unsigned char* cell : { first, last }) {
    double corner[6];
    grid->GetCellBounds(cell - begin, corner);
    box.AddBounds(corner);
  }
  box.GetBounds(bounds);
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

} // namespace

class vtkStratusMultiBlockVolumeMapper::Internals
{
public:
  Internals();
  ~Internals();

  // `error` is set where nothing can be drawn.
  std::vector<Block> Find(vtkStratusMultiBlockVolumeMapper* mapper, vtkVolume* volume, std::string& warning, std::string& error);
  void Configure(vtkStratusMultiBlockVolumeMapper* from, const std::vector<Block>& blocks); // makes a mapper of each block
  void Configure(vtkStratusMultiBlockVolumeMapper* from, vtkStratusVolumeMapper* to) const;
  void PassUpdates(vtkStratusMultiBlockVolumeMapper* from, vtkStratusVolumeMapper* to); // its requests to draw again
  bool CutMask(std::string& error);                                                     // gives each block its part of the mask
  bool Measure(vtkRenderer* renderer, vtkVolume* volume, double choice[4]); // vtkStratusMultiBlockVolumeMapper::MeasureSampling()
  // Draws all mappers' blocks in one picture. `error` stays empty where an abort ended it.
  bool Render(vtkRenderer* renderer, vtkVolume* volume, std::string& error);

  vtkNew<vtkStratusVolumeMapper> Settings, Whole;
  std::vector<vtkSmartPointer<vtkStratusVolumeMapper>> Mappers; // of the blocks, in the input's order
  std::vector<vtkStratusBlockMask> Masks;                       // of the blocks
  vtkStratusJointPicture Picture;
  vtkStratusCellFinder Finder;
  std::string Error, Warning;
  bool IsRefined = false; // whether the input is AMR
  double Transfer2DRanges[4] = { 0., -1., 0., -1. };

private:
  bool OnProgress();
  std::vector<Block> FindBlocks(vtkDataObject* input, vtkStratusMultiBlockVolumeMapper* mapper, std::string& warning) const;
  std::vector<Block> FindRefined(vtkUniformGridAMR* input, vtkStratusMultiBlockVolumeMapper* mapper, vtkVolume* volume, std::string& error);
  bool Describe(vtkRenderer* renderer, vtkVolume* volume, std::string& error);
  bool PrepareContext(std::string& error);
  bool Cast(const stratus_camera& camera, const stratus_image& image, bool whole, std::string& error);

  vtkNew<vtkCallbackCommand> Updates; // of the one block
  vtkStratusContext Context;
  vtkStratusAMR Refined;        // of the input, where it is AMR
  std::string RefinedError;     // why there are no grids of it
  vtkMTimeType RefinedTime = 0; // of the data that it was made of, the next three too
  vtkDataObject* RefinedOf = nullptr;
  std::string RefinedFor;
  std::vector<stratus_ray_caster*> Casters; // of the blocks
  std::vector<stratus_ray_cast_options> Options;
  std::vector<stratus_ray_cast_input> Inputs;
  vtkRenderer* Renderer = nullptr; // set while rendering
  vtkStratusJointPicture::Scene Scene;
};

vtkStratusMultiBlockVolumeMapper::Internals::Internals() : Context([this](double) { return this->OnProgress(); })
{
  this->Context.OnRelease = [this] {
    for (stratus_ray_caster* caster : this->Casters) {
      stratus_ray_caster_destroy(caster);
    }
    this->Casters.clear();
    this->Picture.ForgetTime();
  };
}

vtkStratusMultiBlockVolumeMapper::Internals::~Internals()
{
  this->Context.OnRelease();
  this->Context.OnRelease = nullptr; // members that it uses are destroyed before the context
}

bool vtkStratusMultiBlockVolumeMapper::Internals::OnProgress()
{
  vtkRenderWindow* window = this->Renderer ? this->Renderer->GetRenderWindow() : nullptr;
  return window && window->CheckAbortStatus();
}

vtkStandardNewMacro(vtkStratusMultiBlockVolumeMapper);

vtkStratusMultiBlockVolumeMapper::vtkStratusMultiBlockVolumeMapper() : Internal(new Internals) {}

vtkStratusMultiBlockVolumeMapper::~vtkStratusMultiBlockVolumeMapper() = default;

int vtkStratusMultiBlockVolumeMapper::FillInputPortInformation(int, vtkInformation* info)
{
  info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkImageData");
  info->Append(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkRectilinearGrid");
  info->Append(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkDataObjectTree");
  info->Append(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkUniformGridAMR");
  return 1;
}

std::vector<Block> vtkStratusMultiBlockVolumeMapper::Internals::Find(
  vtkStratusMultiBlockVolumeMapper* mapper, vtkVolume* volume, std::string& warning, std::string& error)
{
  vtkDataObject* input = mapper->GetInputDataObject(0, 0);
  auto* refined = vtkUniformGridAMR::SafeDownCast(input);
  this->IsRefined = refined != nullptr;
  return refined ? this->FindRefined(refined, mapper, volume, error) : this->FindBlocks(input, mapper, warning);
}

// The grids of AMR are made when data, array or interpolation change.
std::vector<Block> vtkStratusMultiBlockVolumeMapper::Internals::FindRefined(
  vtkUniformGridAMR* input, vtkStratusMultiBlockVolumeMapper* mapper, vtkVolume* volume, std::string& error)
{
  vtkVolumeProperty* property = volume->GetProperty();
  const bool solid = this->Settings->GetRenderMode() == vtkStratusVolumeMapper::FIRST_HIT_MODE;
  const bool nearest = solid || property->GetInterpolationType() == VTK_NEAREST_INTERPOLATION;
  const bool composite = !solid && mapper->GetBlendMode() == vtkVolumeMapper::COMPOSITE_BLEND;
  bool by_gradient = solid && this->Settings->GetNormals() == vtkStratusVolumeMapper::GRADIENT_NORMALS;
  for (int c = 0; c < STRATUS_COMPONENTS_MAX; ++c) {
    by_gradient = by_gradient || (composite && property->HasGradientOpacity(c)) ||
      (property->GetShade(c) && (composite || (!solid && mapper->GetBlendMode() == vtkVolumeMapper::ISOSURFACE_BLEND)));
  }
  by_gradient =
    by_gradient || (composite && (property->GetTransferFunctionMode() == vtkVolumeProperty::TF_2D || property->HasLabelGradientOpacity()));
  const std::string wanted = std::to_string(mapper->GetScalarMode()) + " " + std::to_string(mapper->GetArrayAccessMode()) + " " +
    std::to_string(mapper->GetArrayId()) + " " + std::to_string(nearest) + " " + std::to_string(mapper->GetPiece()) + "/" +
    std::to_string(mapper->GetNumberOfPieces()) + " " + (mapper->GetArrayName() ? mapper->GetArrayName() : "");
  const vtkMTimeType time = vtkStratusAMR::GetTime(input);
  const bool same = input == this->RefinedOf && time == this->RefinedTime && wanted == this->RefinedFor;
  if (!same || (by_gradient && !this->Refined.HasGradients())) {
    const auto find = [mapper](vtkDataSet* box, bool& cells) {
      int on_cells = 0;
      vtkDataArray* array = vtkAbstractMapper::GetScalars(
        box, mapper->GetScalarMode(), mapper->GetArrayAccessMode(), mapper->GetArrayId(), mapper->GetArrayName(), on_cells);
      cells = on_cells == 1;
      return array;
    };
    this->RefinedError.clear();
    this->Refined.Set(input, find, { nearest, by_gradient, mapper->GetPiece(), mapper->GetNumberOfPieces() }, this->RefinedError);
    this->RefinedOf = input;
    this->RefinedTime = time;
    this->RefinedFor = wanted;
  }
  error = this->RefinedError;
  std::vector<Block> blocks;
  for (const auto& grid : this->Refined.GetGrids()) {
    Block block;
    block.Grid = grid;
    grid->GetBounds(block.Bounds);
    blocks.push_back(block);
  }
  return blocks;
}

std::vector<Block> vtkStratusMultiBlockVolumeMapper::Internals::FindBlocks(
  vtkDataObject* input, vtkStratusMultiBlockVolumeMapper* mapper, std::string& warning) const
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
      if (OwnedBounds(grid, block.Bounds)) {
        blocks.push_back(block);
      }
    }
  }
  return blocks;
}

void vtkStratusMultiBlockVolumeMapper::Internals::Configure(vtkStratusMultiBlockVolumeMapper* from, const std::vector<Block>& blocks)
{
  this->Mappers.resize(blocks.size());
  for (size_t i = 0; i < blocks.size(); ++i) {
    if (!this->Mappers[i]) {
      this->Mappers[i] = vtkSmartPointer<vtkStratusVolumeMapper>::New();
    }
    this->Configure(from, this->Mappers[i]);
    this->Mappers[i]->Internal->Gradients = this->IsRefined ? vtkStratusAMR::GetGradients(blocks[i].Grid) : nullptr;
    this->Mappers[i]->Internal->GradientLength = this->IsRefined ? this->Refined.GetSpacing() : 0.0;
    if (this->IsRefined) { // grids made here, which have the one array
      this->Mappers[i]->SetScalarMode(VTK_SCALAR_MODE_DEFAULT);
      this->Mappers[i]->SetArrayAccessMode(VTK_GET_ARRAY_BY_NAME);
    }
    this->Mappers[i]->SetInputDataObject(blocks[i].Grid);
    this->Mappers[i]->Internal->PickedOf = vtkCompositeDataSet::SafeDownCast(from->GetInputDataObject(0, 0));
  }
  if (blocks.size() == 1) { // several have a context in common, and their mappers none
    this->Mappers[0]->SetDevice(this->Settings->GetDevice());
    this->PassUpdates(from, this->Mappers[0]);
  }
}

// The block's mapper shows coarse pictures of large files only to programs that draw again, which observe this mapper.
void vtkStratusMultiBlockVolumeMapper::Internals::PassUpdates(vtkStratusMultiBlockVolumeMapper* from, vtkStratusVolumeMapper* to)
{
  to->RemoveObserver(this->Updates);
  if (from->HasObserver(vtkCommand::UpdateEvent)) {
    this->Updates->SetClientData(from);
    this->Updates->SetCallback([](vtkObject*, unsigned long event, void* mapper, void*) {
      static_cast<vtkStratusMultiBlockVolumeMapper*>(mapper)->InvokeEvent(event);
    });
    to->AddObserver(vtkCommand::UpdateEvent, this->Updates);
  }
}

bool vtkStratusMultiBlockVolumeMapper::Internals::CutMask(std::string& error)
{
  vtkImageData* mask = this->Settings->GetMaskInput();
  this->Masks.resize(this->Mappers.size());
  for (size_t i = 0; i < this->Mappers.size() && error.empty(); ++i) {
    vtkStratusVolumeMapper* block = this->Mappers[i];
    int on_cells = 0;
    vtkDataSet* grid = vtkDataSet::SafeDownCast(block->GetDataObjectInput());
    if (mask && grid) {
      vtkAbstractMapper::GetScalars(
        grid, block->GetScalarMode(), block->GetArrayAccessMode(), block->GetArrayId(), block->GetArrayName(), on_cells);
    }
    block->SetMaskInput(mask && grid ? this->Masks[i].Get(mask, grid, on_cells == 1, error) : nullptr);
    block->SetMaskType(this->Settings->GetMaskType());
  }
  return error.empty();
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
  to->SetLightSpread(settings->GetLightSpread());
  to->SetShadows(settings->GetShadows());
  to->SetVolumetricScatteringBlending(settings->GetVolumetricScatteringBlending());
  to->SetScatteringAnisotropy(settings->GetScatteringAnisotropy());
  to->SetGlobalIlluminationReach(settings->GetGlobalIlluminationReach());
  to->SetMultipleScattering(settings->GetMultipleScattering());
  to->SetSkyZenith(settings->GetSkyZenith());
  to->SetSkyHorizon(settings->GetSkyHorizon());
  to->SetSkyUp(settings->GetSkyUp());
  to->SetSun(settings->GetSun());
  to->SetScreenEncoding(settings->GetScreenEncoding());
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
  to->SetNumberOfThreads(settings->GetNumberOfThreads());
  to->SetAudit(settings->GetAudit());
  to->SetCountSamples(settings->GetCountSamples());
  to->SetQuantities(settings->GetQuantities());
  to->SetTransmittanceThreshold(settings->GetTransmittanceThreshold());
  std::copy_n(this->Transfer2DRanges, 4, to->Internal->Transfer2DRanges);
}

// Asks each block's mapper what it draws.
bool vtkStratusMultiBlockVolumeMapper::Internals::Describe(vtkRenderer* renderer, vtkVolume* volume, std::string& error)
{
  const size_t count = this->Mappers.size();
  if (this->Settings->GetRenderMode() == vtkStratusVolumeMapper::PATH_MODE) {
    error = vtkStratusJointPicture::NoPaths;
    return false;
  }
  double ranges[4] = { HUGE_VAL, -HUGE_VAL, HUGE_VAL, -HUGE_VAL }; // of all blocks
  for (size_t i = 0; i<count&& this->Transfer2DRanges[0]> this->Transfer2DRanges[1]; ++i) {
    this->Mappers[i]->Internal->AddTransfer2DRanges(volume->GetProperty(), ranges);
  }
  this->Options.resize(count);
  this->Inputs.assign(count, stratus_ray_cast_input());
  this->Scene.Boxes.clear();
  for (size_t i = 0; i < count; ++i) {
    vtkStratusVolumeMapper::Internals& block = *this->Mappers[i]->Internal;
    if (ranges[0] <= ranges[1]) {
      std::copy_n(ranges, 4, block.Transfer2DRanges);
    }
    if (!block.Describe(renderer, volume, this->Options[i], error)) {
      error = "block " + std::to_string(i) + ": " + error;
      return false;
    }
    this->Inputs[i].volume = &block.Image.GetVolume();
    this->Inputs[i].transfer = block.Functions.data();
    this->Inputs[i].options = &this->Options[i];
  }
  return true;
}

bool vtkStratusMultiBlockVolumeMapper::Internals::PrepareContext(std::string& error)
{
  const int threads = this->Settings->GetNumberOfThreads();
  this->Context.SetDevice(this->Settings->GetDevice(), threads, error);
  if (!error.empty() || !this->Context.Prepare(threads, error)) {
    return false;
  }
  for (size_t i = this->Mappers.size(); i < this->Casters.size(); ++i) {
    stratus_ray_caster_destroy(this->Casters[i]);
  }
  this->Casters.resize(this->Mappers.size(), nullptr);
  for (size_t i = 0; i < this->Casters.size(); ++i) {
    // The picture's rectangle relies on a volume that is right.
    if ((!this->Casters[i] && stratus_ray_caster_create(this->Context.Get(), &this->Casters[i]) != STRATUS_OK) ||
      stratus_volume_check(this->Context.Get(), this->Inputs[i].volume) != STRATUS_OK) {
      error = "block " + std::to_string(i) + ": " + stratus_context_message(this->Context.Get());
      return false;
    }
    this->Inputs[i].caster = this->Casters[i];
    const bool boxed = this->Options[i].clipping.crop && this->Options[i].clipping.crop_regions == STRATUS_CROP_INSIDE;
    this->Scene.Boxes.push_back({ this->Inputs[i].volume, boxed ? this->Options[i].clipping.crop_bounds : nullptr });
    this->Mappers[i]->Internal->OfferTree(this->Casters[i], this->Context.Get());
  }
  return true;
}

bool vtkStratusMultiBlockVolumeMapper::Internals::Cast(
  const stratus_camera& camera, const stratus_image& image, bool whole, std::string& error)
{
  std::vector<stratus_ray_cast_report> reports(this->Inputs.size());
  const int count = static_cast<int>(this->Inputs.size());
  stratus_status status = stratus_ray_caster_render_blocks(this->Inputs.data(), count, &camera, &image, reports.data());
  if (status == STRATUS_OK && whole) {
    stratus_ray_cast_report all = stratus_ray_cast_report();
    for (size_t i = 0; i < reports.size(); ++i) {
      this->Mappers[i]->Internal->Report = reports[i];
      stratus_ray_cast_report_add(&all, &reports[i]);
    }
    this->Scene.Milliseconds = all.cast_ms;
    status = this->Scene.Finish(this->Inputs.data(), count, camera, image, all.window);
  }
  if (status != STRATUS_OK && status != STRATUS_CANCELLED) {
    error = stratus_context_message(this->Context.Get());
  }
  return status == STRATUS_OK;
}

bool vtkStratusMultiBlockVolumeMapper::Internals::Measure(vtkRenderer* renderer, vtkVolume* volume, double choice[4])
{
  if (this->Mappers.size() == 1) {
    return this->Mappers[0]->MeasureSampling(renderer, volume, choice);
  }
  std::string unused;
  if (!this->Describe(renderer, volume, unused) || !this->PrepareContext(unused)) {
    return false;
  }
  bool any = false;
  for (size_t i = 0; i < this->Mappers.size(); ++i) {
    double own[4];
    if (this->Mappers[i]->Internal->Probe(this->Casters[i], this->Options[i], own)) {
      choice[0] = any ? std::max(choice[0], own[0]) : own[0];
      choice[1] = any ? std::min(choice[1], own[1]) : own[1];
      choice[2] = any ? std::min(choice[2], own[2]) : own[2];
      choice[3] = any ? std::min(choice[3], own[3]) : own[3];
      any = true;
    }
  }
  return any;
}

bool vtkStratusMultiBlockVolumeMapper::Internals::Render(vtkRenderer* renderer, vtkVolume* volume, std::string& error)
{
  if (!this->Picture.Begin(renderer, volume, volume->GetMapper(), this->Error, error)) {
    return error.empty();
  }
  if (!this->Describe(renderer, volume, error) || !this->PrepareContext(error)) {
    return false;
  }
  this->Mappers[0]->Internal->LeftOut.Warn(volume->GetMapper()); // each block leaves out the same
  this->Scene.Renderer = renderer;
  this->Scene.Prop = volume;
  this->Scene.Settings = this->Mappers[0];
  this->Scene.TakesShadows = vtkStratusSurfaces::TakeShadows(renderer, this->Inputs.data(), static_cast<int>(this->Inputs.size()));
  this->Scene.Cast = [this](const stratus_camera& camera, const stratus_image& image, bool whole, std::string& why) {
    return this->Cast(camera, image, whole, why);
  };
  this->Scene.Measure = [this, volume](
                          const stratus_camera& camera, const stratus_image& image, vtkStratusQuantities& quantities, std::string& why) {
    quantities.ForgetVolumes();
    quantities.AddVolume(volume->GetMapper(), volume);
    return quantities.Compute(this->Context.Get(), this->Inputs.data(), static_cast<int>(this->Inputs.size()), true, camera, image, why);
  };
  this->Scene.Finder = renderer->GetSelector() ? &this->Finder : nullptr;
  if (this->Scene.Finder) {
    this->Finder.Set(volume->GetMapper()->GetInputDataObject(0, 0), volume->GetMatrix());
  }
  this->Renderer = renderer;
  const bool drawn = this->Picture.Render(this->Scene, error);
  this->Renderer = nullptr;
  return drawn;
}

void vtkStratusMultiBlockVolumeMapper::Render(vtkRenderer* renderer, vtkVolume* volume)
{
  if (vtkStratusDepthOrder::Draw(renderer, volume, this)) {
    return;
  }
  this->GetInputAlgorithm()->Update();
  std::string error, warning;
  const std::vector<Block> blocks = this->Internal->Find(this, volume, warning, error);
  auto& mappers = this->Internal->Mappers;
  this->Internal->Configure(this, blocks);
  if (error.empty()) {
    this->Internal->CutMask(error);
  }
  const bool behind =
    this->GetBlendMode() == COMPOSITE_BLEND && this->GetSettings()->GetRenderMode() != vtkStratusVolumeMapper::FIRST_HIT_MODE;
  for (size_t i = 0; i < blocks.size() && behind && !this->Internal->IsRefined; ++i) {
    for (size_t j = 0; j < i && warning.empty(); ++j) {
      if (Overlap(blocks[i], blocks[j])) {
        warning = "blocks overlap, and are drawn one over the other";
      }
    }
  }
  if (!error.empty()) {
    mappers.clear();
  } else if (blocks.size() == 1) { // draws and reports by itself
    mappers[0]->Render(renderer, volume);
    error = mappers[0]->GetLastError();
  } else if (!blocks.empty()) {
    try {
      this->Internal->Render(renderer, volume, error);
    } catch (const std::bad_alloc&) {
      error = "there is not enough memory for the picture";
    }
  }
  if (!error.empty() && error != this->Internal->Error && mappers.size() != 1) {
    vtkErrorMacro(<< error << "; nothing is drawn");
  }
  if (!warning.empty() && warning != this->Internal->Warning) {
    vtkWarningMacro(<< warning);
  }
  this->Internal->Error = error;
  this->Internal->Warning = warning;
}

vtkImageData* vtkStratusMultiBlockVolumeMapper::GetLastImage()
{
  auto& mappers = this->Internal->Mappers;
  return mappers.size() == 1 ? mappers[0]->GetLastImage() : this->Internal->Picture.GetLastImage();
}

bool vtkStratusMultiBlockVolumeMapper::MeasureSampling(vtkRenderer* renderer, vtkVolume* volume, double choice[4], vtkDataSet* whole)
{
  if (whole) {
    this->Internal->Configure(this, this->Internal->Whole);
    const double own[4] = { 0.0, -1.0, 0.0, -1.0 };
    std::copy_n(own, 4, this->Internal->Whole->Internal->Transfer2DRanges);
    this->Internal->Whole->SetInputDataObject(whole);
    this->Internal->Whole->SetMaskInput(this->Internal->Settings->GetMaskInput());
    this->Internal->Whole->SetMaskType(this->Internal->Settings->GetMaskType());
    this->Internal->Whole->SetDevice(this->Internal->Settings->GetDevice());
    return this->Internal->Whole->MeasureSampling(renderer, volume, choice);
  }
  std::string unused, error;
  this->Internal->Configure(this, this->Internal->Find(this, volume, unused, error));
  return error.empty() && this->Internal->CutMask(error) && this->Internal->Measure(renderer, volume, choice);
}

void vtkStratusMultiBlockVolumeMapper::SetTransfer2DRanges(const double ranges[4])
{
  if (!std::equal(ranges, ranges + 4, this->Internal->Transfer2DRanges)) {
    std::copy_n(ranges, 4, this->Internal->Transfer2DRanges);
    this->Modified();
  }
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
    double bounds[6];
    if (auto* grid = vtkDataSet::SafeDownCast(input)) {
      if (OwnedBounds(grid, bounds)) {
        std::copy_n(bounds, 6, this->Bounds);
      }
    } else if (auto* refined = vtkUniformGridAMR::SafeDownCast(input)) {
      if (vtkStratusAMR::GetBounds(refined, this->Piece, this->NumberOfPieces, bounds)) {
        std::copy_n(bounds, 6, this->Bounds);
      }
    } else if (auto* tree = vtkCompositeDataSet::SafeDownCast(input)) {
      vtkBoundingBox box;
      for (vtkDataSet* block : vtkCompositeDataSet::GetDataSets(tree)) {
        if (OwnedBounds(block, bounds)) {
          box.AddBounds(bounds);
        }
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
  this->Internal->Picture.ReleaseGraphicsResources(window);
  this->Superclass::ReleaseGraphicsResources(window);
}

void vtkStratusMultiBlockVolumeMapper::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Piece: " << this->Piece << " of " << this->NumberOfPieces << "\n";
  os << indent << "NumberOfBlocks: " << this->GetNumberOfBlocks() << "\n";
  os << indent << "LastError: " << this->Internal->Error << "\n";
  os << indent << "Settings:\n";
  this->Internal->Settings->PrintSelf(os, indent.GetNextIndent());
}
