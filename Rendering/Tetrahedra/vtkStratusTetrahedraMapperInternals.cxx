// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusTetrahedraMapperInternals.h"

#include "vtkStratusLights.h"
#include "vtkStratusSlice.h"

#include "vtkCommand.h"
#include "vtkContourValues.h"
#include "vtkDataArray.h"
#include "vtkDataObjectTree.h"
#include "vtkMath.h"
#include "vtkRenderWindow.h"
#include "vtkRenderer.h"
#include "vtkStructuredGrid.h"
#include "vtkUnstructuredGrid.h"
#include "vtkVolume.h"
#include "vtkVolumeProperty.h"

#include <algorithm>
#include <cmath>

vtkStratusTetrahedraMapper::Internals::Internals(vtkStratusTetrahedraMapper* mapper)
    : Mapper(mapper), Context([this](double fraction) { return this->OnProgress(fraction); })
{
  this->Context.OnRelease = [this] {
    stratus_tetra_caster_destroy(this->Caster);
    this->Caster = nullptr;
  };
}

vtkStratusTetrahedraMapper::Internals::~Internals()
{
  this->Context.OnRelease();
  this->Context.OnRelease = nullptr; // members that it uses are destroyed before the context
}

bool vtkStratusTetrahedraMapper::Internals::OnProgress(double fraction)
{
  this->Mapper->InvokeEvent(vtkCommand::VolumeMapperRenderProgressEvent, &fraction);
  vtkRenderWindow* window = this->Renderer ? this->Renderer->GetRenderWindow() : nullptr;
  return window && window->CheckAbortStatus();
}

// ---------------------------------------------------------------- settings and input

bool vtkStratusTetrahedraMapper::Internals::CheckMapper(std::string& error) const
{
  if (this->Mapper->BlendMode < COMPOSITE_BLEND || this->Mapper->BlendMode > SLICE_BLEND) {
    error = "blend mode " + std::to_string(this->Mapper->BlendMode) + " is not supported, only composite (0) to slice (6) are";
  } else if (this->Mapper->RenderMode == FIRST_HIT_MODE && this->Mapper->BlendMode != COMPOSITE_BLEND) {
    error = "blend mode " + std::to_string(this->Mapper->BlendMode) + " is not supported in first hits, only composite (0) is";
  } else if (!std::isfinite(this->Mapper->GradientOpacityDistance)) {
    error = "GradientOpacityDistance is " + std::to_string(this->Mapper->GradientOpacityDistance) +
      ", it must be finite: 0 for optical depths, below 0 for half of the mean spacing";
  }
  return error.empty();
}

// Notes the settings that the picture does not use. SetShading() notes Shade and gradient opacity, which depend on the components.
void vtkStratusTetrahedraMapper::Internals::NoteLeftOut(vtkVolumeProperty* property)
{
  this->LeftOut.Begin();
  if (property->GetTransferFunctionMode() == vtkVolumeProperty::TF_2D) {
    this->LeftOut.Add("TransferFunction2D, which meshes do not use");
  }
  if (this->HasLabelMap() && !this->HasLabels()) {
    this->LeftOut.AddUnused("the label map", stratus_tetra_mode_name(this->GetMode()));
  } else if (property->GetNumberOfLabels() > 0 && !this->HasLabels()) {
    this->LeftOut.Add("functions of labels, which need a MaskInput of type label map");
  }
  this->LeftOut.AddTransforms(this->Mapper, this->Mapper->BlendMode == SLICE_BLEND ? property->GetSliceFunction() : nullptr);
}

bool vtkStratusTetrahedraMapper::Internals::SetClipPlanes(stratus_tetra_options& options, std::string& error) const
{
  if (!vtkStratusClipPlanes(this->Mapper, STRATUS_TETRA_CLIP_PLANES_MAX, options.clip_planes, options.clip_plane_count, error)) {
    return false;
  }
  options.crop = this->Mapper->Cropping ? 1 : 0;
  options.crop_regions = static_cast<uint32_t>(this->Mapper->CroppingRegionFlags);
  std::copy_n(this->Mapper->CroppingRegionPlanes, 6, options.crop_bounds);
  return true;
}

bool vtkStratusTetrahedraMapper::Internals::SetShading(
  vtkRenderer* renderer, vtkVolume* volume, stratus_tetra_options& options, std::string& error)
{
  vtkVolumeProperty* property = volume->GetProperty();
  options.gradient_distance = this->Mapper->GradientOpacityDistance;
  options.dependent = property->GetIndependentComponents() ? 0 : 1;
  options.mean_components = this->Mapper->ComponentMixing == MEAN_COMPONENTS ? 1 : 0;
  const int media = options.dependent ? 1 : std::max(this->Mesh.GetMesh().components, 1);
  const bool thins = std::any_of(
    this->Functions.begin(), this->Functions.begin() + media, [](const stratus_transfer& function) { return function.gradient_count > 0; });
  if (thins && options.mode != STRATUS_TETRA_COMPOSITE) {
    this->LeftOut.AddUnused("GradientOpacity", stratus_tetra_mode_name(options.mode));
    for (int c = 0; c < media; ++c) {
      this->Functions[c].gradient_count = 0;
    }
  }
  bool alike = true;
  const bool lit = vtkStratusSetMaterials(property, media, this->Materials.data(), alike);
  options.normals = static_cast<stratus_normals>(this->Mapper->Normals);
  if (lit && options.mode != STRATUS_TETRA_COMPOSITE && options.mode != STRATUS_TETRA_ISOSURFACE &&
    options.mode != STRATUS_TETRA_FIRST_HIT) {
    this->LeftOut.AddUnused("Shade", stratus_tetra_mode_name(options.mode));
    options.shade = 0;
    return true;
  }
  options.materials = alike ? nullptr : this->Materials.data();
  options.shade = property->GetShade();
  vtkStratusSetScattering(this->Mapper, volume, options.shading);
  options.shading.surfaces = lit && options.shading.shadows ? this->Surfaces.Find(renderer) : nullptr;
  return !lit || vtkStratusSetShading(renderer, this->Mapper->GetSun(), property, options.shading, error);
}

stratus_tetra_mode vtkStratusTetrahedraMapper::Internals::GetMode() const
{
  return this->Mapper->RenderMode == FIRST_HIT_MODE
    ? STRATUS_TETRA_FIRST_HIT
    : static_cast<stratus_tetra_mode>(this->Mapper->BlendMode); // both count from composite to slice alike
}

bool vtkStratusTetrahedraMapper::Internals::SetMode(vtkVolumeProperty* property, stratus_tetra_options& options, std::string& error) const
{
  options.mode = this->GetMode();
  std::copy_n(this->Mapper->AverageIPScalarRange, 2, options.average_range);
  vtkContourValues* contours = options.mode == STRATUS_TETRA_ISOSURFACE ? property->GetIsoSurfaceValues() : nullptr;
  const int count = contours ? contours->GetNumberOfContours() : 0;
  if (count > STRATUS_TETRA_CONTOURS_MAX) {
    error = std::to_string(count) + " isosurface values are not supported, at most " + std::to_string(STRATUS_TETRA_CONTOURS_MAX) + " are";
    return false;
  }
  options.contour_count = count;
  for (int n = 0; n < count; ++n) {
    options.contours[n] = contours->GetValue(n);
  }
  return options.mode != STRATUS_TETRA_SLICE || vtkStratusSetSlice(property, options.slice, error);
}

// Finds a grid's values, one for each tuple where the colour function says so. Without a property, as in a question for bounds before the
// first picture, all components stay.
vtkDataArray* vtkStratusTetrahedraMapper::Internals::FindScalars(vtkDataSet* grid, int& cells, std::string& error)
{
  vtkStratusTetrahedraMapper* mapper = this->Mapper;
  vtkDataArray* array =
    vtkAbstractMapper::GetScalars(grid, mapper->ScalarMode, mapper->ArrayAccessMode, mapper->ArrayId, mapper->ArrayName, cells);
  const int components = array ? array->GetNumberOfComponents() : 0;
  const int wanted = this->Property && array ? vtkStratusVectors::Find(this->Property, components) : vtkStratusVectors::All;
  if (wanted >= components) {
    error = "the colour function's VectorComponent is " + std::to_string(wanted) + ", the array has " + std::to_string(components) +
      " components: 0 to " + std::to_string(components - 1);
    return nullptr;
  }
  return wanted == vtkStratusVectors::All ? array : this->Vectors.Get(array, wanted, grid->GetMTime());
}

// Finds the grid, or the grids, of an input that is up to date. None: the input is a composite data set without cells.
bool vtkStratusTetrahedraMapper::Internals::FindDrawn(Drawn& drawn, std::string& error)
{
  std::string lacking;
  const auto find = [&](vtkDataSet* grid, int& cells) { return this->FindScalars(grid, cells, lacking); };
  vtkDataObject* input = this->Mapper->GetDataObjectInput();
  drawn = { nullptr, nullptr, false, nullptr };
  if (vtkUnstructuredGrid::SafeDownCast(input) || vtkStructuredGrid::SafeDownCast(input)) {
    drawn.Grid = vtkDataSet::SafeDownCast(input);
    if (drawn.Grid->GetNumberOfCells() == 0 || drawn.Grid->GetNumberOfPoints() == 0) {
      drawn.Grid = nullptr;
      return true;
    }
    int cells = 0;
    drawn.Scalars = find(drawn.Grid, cells);
    drawn.Cells = cells == 1;
    if (!drawn.Scalars || cells > 1) {
      error = lacking.empty() ? std::string("there is no scalar array for scalar mode ") + this->Mapper->GetScalarModeAsString() : lacking;
    }
    return error.empty();
  }
  if (auto* whole = vtkDataObjectTree::SafeDownCast(input)) {
    const bool taken = this->Blocks.Set(whole, find, error, true);
    if (!lacking.empty()) {
      error = lacking;
      return false;
    }
    const bool several = !this->Blocks.GetLattices().empty();
    drawn = { this->Blocks.GetGrid(), this->Blocks.GetScalars(), this->Blocks.OfCells(), several ? &this->Blocks.GetLattices() : nullptr };
    return taken;
  }
  error = (input ? std::string("the input is a ") + input->GetClassName() : std::string("there is no input")) +
    ", a vtkUnstructuredGrid, a vtkStructuredGrid or a composite data set of such is needed";
  return false;
}

bool vtkStratusTetrahedraMapper::Internals::SetMesh(const Drawn& drawn, vtkMatrix4x4* matrix, std::string& error)
{
  return drawn.Several ? this->Mesh.SetSeveral(*drawn.Several, drawn.Cells, matrix, error, STRATUS_COMPONENTS_MAX)
                       : this->Mesh.Set(drawn.Grid, drawn.Scalars, drawn.Cells, matrix, error, STRATUS_COMPONENTS_MAX);
}

const double* vtkStratusTetrahedraMapper::Internals::FindBounds()
{
  std::string error;
  vtkDataObject* input = this->Mapper->GetDataObjectInput();
  if (auto* grid = vtkStructuredGrid::SafeDownCast(input)) {
    return this->Mesh.SetGeometry(grid, error) ? this->Mesh.GetBounds() : nullptr;
  }
  if (auto* whole = vtkDataObjectTree::SafeDownCast(input)) {
    Drawn drawn;
    vtkMath::UninitializeBounds(this->Box);
    const bool found = this->FindDrawn(drawn, error);
    if (found && drawn.Several && this->SetMesh(drawn, nullptr, error)) {
      return this->Mesh.GetBounds();
    }
    if (found && drawn.Grid) {
      drawn.Grid->GetBounds(this->Box);
    } else {
      whole->GetBounds(this->Box);
    }
    return this->Box;
  }
  return nullptr;
}

// Sets one transfer function, or one for each independent component, or one for each label.
bool vtkStratusTetrahedraMapper::Internals::SetTransfers(vtkVolumeProperty* property, std::string& error)
{
  const int media = property->GetIndependentComponents() ? std::max(this->Mesh.GetMesh().components, 1) : 1;
  const int labels = this->HasLabels() ? vtkStratusTransferView::FindHighestLabel(property) : 0;
  this->Functions.resize(static_cast<size_t>(std::max(media, 1 + labels)));
  this->Transfers.resize(std::max(this->Functions.size(), this->Transfers.size())); // those not needed now keep their count
  for (int c = 0; c < media; ++c) {
    if (!this->Transfers[c].Set(property, c, error)) {
      return false;
    }
    this->Functions[c] = this->Transfers[c].GetTransfer();
  }
  for (int l = 1; l <= labels; ++l) {
    if (!this->Transfers[l].SetLabel(property, l, this->Transfers[0], error)) {
      return false;
    }
    this->Functions[l] = this->Transfers[l].GetTransfer();
  }
  return true;
}

vtkTypeUInt64 vtkStratusTetrahedraMapper::Internals::GetFunctionBuilds() const
{
  vtkTypeUInt64 builds = 0;
  for (const vtkStratusTransferView& view : this->Transfers) {
    builds += view.GetBuilds();
  }
  return builds;
}

bool vtkStratusTetrahedraMapper::Internals::PrepareInput(vtkVolume* prop, bool& empty, std::string& error)
{
  Drawn drawn;
  if (this->Mapper->GetNumberOfInputConnections(0) > 0) {
    this->Mapper->GetInputAlgorithm()->Update();
  }
  this->Property = prop->GetProperty();
  this->Vectors.Sweep();
  if (!this->FindDrawn(drawn, error)) {
    return false;
  }
  empty = !drawn.Grid && !drawn.Several;
  if (empty) {
    return true;
  }
  const bool blocks = vtkDataObjectTree::SafeDownCast(this->Mapper->GetDataObjectInput()) != nullptr;
  const std::string left = blocks ? this->Blocks.DescribeLeftOut() : std::string();
  if (!left.empty() && left != this->LastLeftOut) { // warned of once, not with every frame
    vtkWarningWithObjectMacro(this->Mapper, << left << (left.find(" blocks ") == std::string::npos ? " is" : " are") << " not drawn");
  }
  this->LastLeftOut = left;
  return this->SetMesh(drawn, prop->GetMatrix(), error) && this->SetMask(prop->GetProperty(), error) &&
    this->SetTransfers(prop->GetProperty(), error);
}

bool vtkStratusTetrahedraMapper::Internals::SetMask(vtkVolumeProperty* property, std::string& error)
{
  const stratus_mesh& mesh = this->Mesh.GetMesh();
  const bool labels = this->HasLabels() && vtkStratusTransferView::FindHighestLabel(property) > 0;
  const bool used = labels || (this->Mapper->MaskInput && !this->HasLabelMap());
  this->Shown = used ? this->Mask.Apply(mesh, this->Mapper->MaskInput, labels, error) : &mesh;
  return this->Shown != nullptr;
}

bool vtkStratusTetrahedraMapper::Internals::PrepareContext(std::string& error)
{
  if (!this->Context.Prepare(this->Mapper->NumberOfThreads, error)) {
    return false;
  }
  if (!this->Caster && stratus_tetra_caster_create(this->Context.Get(), &this->Caster) != STRATUS_OK) {
    error = stratus_context_message(this->Context.Get());
    return false;
  }
  return true;
}

bool vtkStratusTetrahedraMapper::Internals::SetOptions(
  vtkVolumeProperty* property, stratus_tetra_options& options, std::string& error) const
{
  options = stratus_tetra_options_default();
  options.termination = this->Mapper->Termination;
  options.tolerance = this->Mapper->ImageErrorTolerance;
  options.method = static_cast<stratus_tetra_method>(this->Mapper->Method);
  options.leaves = this->Mesh.GetLeaves();
  options.label_count = this->HasLabels() ? vtkStratusTransferView::FindHighestLabel(property) : 0;
  return this->SetMode(property, options, error) && this->SetClipPlanes(options, error);
}

bool vtkStratusTetrahedraMapper::Internals::Describe(vtkRenderer* renderer, vtkVolume* prop, vtkStratusMeshDescription& description)
{
  bool empty = false;
  description = vtkStratusMeshDescription();
  this->HasPicture = false; // the other module has it
  this->NoteLeftOut(prop->GetProperty());
  if (!this->CheckMapper(description.Error) || !this->PrepareInput(prop, empty, description.Error) ||
    !this->SetOptions(prop->GetProperty(), description.Options, description.Error) ||
    !this->SetShading(renderer, prop, description.Options, description.Error)) {
    return false;
  }
  this->LeftOut.Warn(this->Mapper);
  if (!empty) {
    description.Mesh = this->Shown;
    description.Transfer = this->Functions.data();
    description.Box = this->Mesh.GetBox();
  }
  return true;
}

// ---------------------------------------------------------------- a picture

stratus_ray_cast_input vtkStratusTetrahedraMapper::Internals::InputOf(const stratus_tetra_options& options)
{
  stratus_ray_cast_input input = stratus_ray_cast_input();
  input.tetra = this->Caster;
  input.mesh = this->Shown;
  input.transfer = this->Functions.data();
  input.tetra_options = &options;
  return input;
}

bool vtkStratusTetrahedraMapper::Internals::Cast(
  vtkRenderer* renderer, stratus_tetra_options& options, const float* opaqueDepth, std::string& error)
{
  const stratus_image image = this->Picture.MakeRoom(this->Rgba, this->Depth, opaqueDepth);
  this->Renderer = renderer;
  const auto draw = [&] {
    this->Options = options;
    return stratus_tetra_caster_render(
      this->Caster, this->Shown, this->Functions.data(), &this->Picture.Camera, &options, &image, &this->Report);
  };
  stratus_context_start_build_report(this->Context.Get());
  stratus_status status = draw();
  if (status == STRATUS_INVALID_ARGUMENT && options.leaves) {
    options.leaves = nullptr;
    status = draw();
    if (status == STRATUS_OK) { // the core had refused the leaves
      this->Mesh.DropLeaves();
    }
  }
  const stratus_ray_cast_input input = this->InputOf(this->Options);
  if (status == STRATUS_OK && this->Picture.TakesShadows) {
    status = stratus_ray_caster_shade_surfaces(&input, 1, &this->Picture.Camera, &image);
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

bool vtkStratusTetrahedraMapper::Internals::Render(vtkRenderer* renderer, vtkVolume* prop, std::string& error)
{
  if (!this->Display.Begin(renderer, prop, this->Mapper, this->LastError, error)) {
    return error.empty();
  }
  bool empty = false;
  this->HasPicture = false;
  this->NoteLeftOut(prop->GetProperty());
  if (!this->Quantities.Set(this->Mapper->Quantities, this->Mapper->TransmittanceThreshold, error) || !this->CheckMapper(error) ||
    !this->PrepareInput(prop, empty, error) || !this->PrepareContext(error)) {
    return false;
  }
  if (empty) {
    return true;
  }
  stratus_tetra_options options;
  if (!this->SetOptions(prop->GetProperty(), options, error) || !this->SetShading(renderer, prop, options, error)) {
    return false;
  }
  this->LeftOut.Warn(this->Mapper);
  const stratus_ray_cast_input input = this->InputOf(options);
  this->Picture.TakesShadows = vtkStratusSurfaces::TakeShadows(renderer, &input, 1);
  if (!this->Picture.Set(renderer, this->Mesh.GetBox(), nullptr, 1.0)) {
    error = "the camera's projection has no inverse";
    return false;
  }
  this->HasPicture = this->Picture.IsEmpty();
  if (this->HasPicture) {
    return true;
  }
  const vtkStratusPicture::Others others = this->Picture.FindOthers(renderer, prop, [](vtkProp*) { return false; });
  const float* opaqueDepth = this->Picture.ReadOpaqueDepth(renderer, others);
  if (!this->Cast(renderer, options, opaqueDepth, error)) {
    return false;
  }
  this->HasPicture = true;
  vtkStratusDisplay::Pixels pixels;
  pixels.Rgba = this->Rgba.data();
  pixels.Encodes = this->Mapper->ScreenEncoding != 0;
  pixels.Window[1] = this->Picture.Size[0];
  pixels.Window[3] = this->Picture.Size[1];
  pixels.Depth = &this->Depth;
  pixels.WritesDepth = this->Options.mode == STRATUS_TETRA_FIRST_HIT;
  if (renderer->GetSelector()) {
    this->Finder.Set(this->Mapper->GetDataObjectInput(), prop->GetMatrix());
    pixels.Finder = &this->Finder;
  }
  if (this->Options.mode == STRATUS_TETRA_COMPOSITE) {
    pixels.Cast = [this](const float* depths, std::vector<float>& rgba) {
      if (this->Picture.IsWhole(depths)) {
        rgba = this->Rgba;
        return true;
      }
      const stratus_image image = this->Picture.MakeRoom(rgba, this->PartDepth, depths);
      stratus_tetra_report report;
      return stratus_tetra_caster_render(
               this->Caster, this->Shown, this->Functions.data(), &this->Picture.Camera, &this->Options, &image, &report) == STRATUS_OK;
    };
  }
  return this->Display.Draw(renderer, this->Picture, pixels, error);
}

vtkImageData* vtkStratusTetrahedraMapper::Internals::GetLastImage()
{
  if (!this->HasPicture) {
    return nullptr;
  }
  this->LastImage = this->Picture.MakeImage(this->Rgba, this->Depth, nullptr);
  this->Quantities.AddTo(this->LastImage, this->Picture);
  return this->LastImage;
}
