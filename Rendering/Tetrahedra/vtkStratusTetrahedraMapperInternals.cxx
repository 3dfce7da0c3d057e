// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusTetrahedraMapperInternals.h"

#include "vtkCommand.h"
#include "vtkDataArray.h"
#include "vtkPiecewiseFunction.h"
#include "vtkPlaneCollection.h"
#include "vtkRenderWindow.h"
#include "vtkRenderer.h"
#include "vtkStructuredGrid.h"
#include "vtkUnstructuredGrid.h"
#include "vtkVolume.h"
#include "vtkVolumeProperty.h"

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

bool vtkStratusTetrahedraMapper::Internals::CheckProperty(vtkVolumeProperty* property, std::string& error) const
{
  vtkPlaneCollection* planes = this->Mapper->GetClippingPlanes();
  if (planes && planes->GetNumberOfItems() > 0) {
    error = std::to_string(planes->GetNumberOfItems()) + " clipping planes are not supported, none may be set";
  } else if (this->Mapper->BlendMode != COMPOSITE_BLEND && this->Mapper->BlendMode != MAXIMUM_INTENSITY_BLEND) {
    error = "blend mode " + std::to_string(this->Mapper->BlendMode) + " is not supported, only composite (0) and maximum intensity (1) are";
  } else if (property->GetShade()) {
    error = "shading is not supported, only ShadeOff is";
  } else if (property->GetTransferFunctionMode() != vtkVolumeProperty::TF_1D) {
    error = "two-dimensional transfer functions are not supported, only TF_1D is";
  } else if (property->GetNumberOfLabels() > 0) {
    error = "label maps are not supported, only the scalar transfer functions are";
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

// The input, which is up to date; nullptr, with the reason in `error`, where it is missing or of another class.
vtkDataSet* vtkStratusTetrahedraMapper::Internals::FindGrid(std::string& error) const
{
  vtkDataObject* input = this->Mapper->GetDataObjectInput();
  if (vtkUnstructuredGrid::SafeDownCast(input) || vtkStructuredGrid::SafeDownCast(input)) {
    return vtkDataSet::SafeDownCast(input);
  }
  error = (input ? std::string("the input is a ") + input->GetClassName() : std::string("there is no input")) +
    ", a vtkUnstructuredGrid or vtkStructuredGrid is needed";
  return nullptr;
}

const double* vtkStratusTetrahedraMapper::Internals::FindBounds()
{
  std::string error;
  auto* grid = vtkStructuredGrid::SafeDownCast(this->FindGrid(error));
  return grid && this->Mesh.SetGeometry(grid, error) ? this->Mesh.GetBounds() : nullptr;
}

bool vtkStratusTetrahedraMapper::Internals::PrepareInput(vtkVolume* prop, bool& empty, std::string& error)
{
  vtkStratusTetrahedraMapper* mapper = this->Mapper;
  if (mapper->GetNumberOfInputConnections(0) > 0) {
    mapper->GetInputAlgorithm()->Update();
  }
  vtkDataSet* grid = this->FindGrid(error);
  if (!grid) {
    return false;
  }
  empty = grid->GetNumberOfCells() == 0 || grid->GetNumberOfPoints() == 0;
  if (empty) {
    return true;
  }
  int cells = 0;
  vtkDataArray* array =
    vtkAbstractMapper::GetScalars(grid, mapper->ScalarMode, mapper->ArrayAccessMode, mapper->ArrayId, mapper->ArrayName, cells);
  if (!array || cells > 1) {
    error = std::string("there is no scalar array for scalar mode ") + mapper->GetScalarModeAsString();
    return false;
  }
  return this->Mesh.Set(grid, array, cells == 1, prop->GetMatrix(), error) && this->Transfer.Set(prop->GetProperty(), error);
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

// ---------------------------------------------------------------- a picture

bool vtkStratusTetrahedraMapper::Internals::Cast(vtkRenderer* renderer, const float* opaqueDepth, std::string& error)
{
  const size_t pixels = static_cast<size_t>(this->Picture.Size[0]) * this->Picture.Size[1];
  this->Rgba.resize(4 * pixels);
  this->Depth.resize(pixels);
  stratus_image image = stratus_image();
  image.width = this->Picture.Size[0];
  image.height = this->Picture.Size[1];
  image.rgba = this->Rgba.data();
  image.depth = this->Depth.data();
  image.opaque_depth = opaqueDepth;
  stratus_tetra_options options = stratus_tetra_options_default();
  options.termination = this->Mapper->Termination;
  options.tolerance = this->Mapper->ImageErrorTolerance;
  options.method = static_cast<stratus_tetra_method>(this->Mapper->Method);
  options.mode = this->Mapper->BlendMode == MAXIMUM_INTENSITY_BLEND ? STRATUS_TETRA_MAXIMUM : STRATUS_TETRA_COMPOSITE;
  options.leaves = this->Mesh.GetLeaves();
  this->Renderer = renderer;
  const auto draw = [&] {
    return stratus_tetra_caster_render(
      this->Caster, &this->Mesh.GetMesh(), &this->Transfer.GetTransfer(), &this->Picture.Camera, &options, &image, &this->Report);
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
  this->Renderer = nullptr;
  this->Context.KeepBuildReport(this->BuildReport);
  if (status != STRATUS_OK && status != STRATUS_CANCELLED) {
    error = stratus_context_message(this->Context.Get());
  }
  return status == STRATUS_OK;
}

bool vtkStratusTetrahedraMapper::Internals::Render(vtkRenderer* renderer, vtkVolume* prop, std::string& error)
{
  if (!this->Display.Begin(renderer, prop, this->Mapper, this->LastError, error)) {
    return error.empty();
  }
  bool empty = false;
  this->HasPicture = false;
  if (!this->CheckProperty(prop->GetProperty(), error) || !this->PrepareInput(prop, empty, error) || !this->PrepareContext(error)) {
    return false;
  }
  if (empty) {
    return true;
  }
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
  if (!this->Cast(renderer, opaqueDepth, error)) {
    return false;
  }
  this->HasPicture = true;
  vtkStratusDisplay::Pixels pixels;
  pixels.Rgba = this->Rgba.data();
  pixels.Window[1] = this->Picture.Size[0];
  pixels.Window[3] = this->Picture.Size[1];
  pixels.Depth = &this->Depth;
  return this->Display.Draw(renderer, this->Picture, pixels, error);
}

vtkImageData* vtkStratusTetrahedraMapper::Internals::GetLastImage()
{
  if (!this->HasPicture) {
    return nullptr;
  }
  this->LastImage = this->Picture.MakeImage(this->Rgba, this->Depth, nullptr);
  return this->LastImage;
}
