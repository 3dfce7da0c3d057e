// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusTetrahedraMapper.h"

#include "vtkStratusDepthOrder.h"
#include "vtkStratusTetrahedraMapperInternals.h"

#include "vtkCommand.h"
#include "vtkDataObjectTree.h"
#include "vtkImageData.h"
#include "vtkLight.h"
#include "vtkInformation.h"
#include "vtkObjectFactory.h"
#include "vtkRenderer.h"
#include "vtkUnstructuredGridBase.h"
#include "vtkVolume.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <new>

vtkStandardNewMacro(vtkStratusTetrahedraMapper);

vtkStratusTetrahedraMapper::vtkStratusTetrahedraMapper() : Internal(new Internals(this)) {}

vtkStratusTetrahedraMapper::~vtkStratusTetrahedraMapper()
{
  this->SetQuantities(nullptr);
}

int vtkStratusTetrahedraMapper::FillInputPortInformation(int, vtkInformation* info)
{
  info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkUnstructuredGrid");
  info->Append(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkStructuredGrid");
  info->Append(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkDataObjectTree");
  return 1;
}

void vtkStratusTetrahedraMapper::SetInputData(vtkUnstructuredGridBase* grid)
{
  this->SetInputDataInternal(0, grid);
}

void vtkStratusTetrahedraMapper::SetInputData(vtkDataSet* grid)
{
  this->SetInputDataInternal(0, grid);
}

void vtkStratusTetrahedraMapper::SetInputData(vtkDataObjectTree* blocks)
{
  this->SetInputDataInternal(0, blocks);
}

double* vtkStratusTetrahedraMapper::GetBounds()
{
  if (this->GetNumberOfInputConnections(0) > 0) {
    this->GetInputAlgorithm()->Update();
  }
  const double* bounds = this->Internal->FindBounds();
  if (!bounds) {
    return this->Superclass::GetBounds();
  }
  std::copy_n(bounds, 6, this->Bounds);
  return this->Bounds;
}

void vtkStratusTetrahedraMapper::Render(vtkRenderer* ren, vtkVolume* vol)
{
  if (vtkStratusDepthOrder::Draw(ren, vol, this)) {
    return;
  }
  const auto start = std::chrono::steady_clock::now();
  this->InvokeEvent(vtkCommand::VolumeMapperRenderStartEvent, nullptr);
  std::string error;
  bool drawn = false;
  try {
    drawn = this->Internal->Render(ren, vol, error);
  } catch (const std::bad_alloc&) {
    error = "there is not enough memory for the picture";
  }
  if (drawn) {
    this->Internal->LastError.clear();
  } else if (!error.empty() && error != this->Internal->LastError) {
    this->Internal->LastError = error; // reported once, not with every picture
    vtkErrorMacro(<< error << "; nothing is drawn");
  }
  this->InvokeEvent(vtkCommand::VolumeMapperRenderEndEvent, nullptr);
  this->TimeToDraw = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

bool vtkStratusTetrahedraMapper::Describe(vtkRenderer* renderer, vtkVolume* volume, vtkStratusMeshDescription& description)
{
  return this->Internal->Describe(renderer, volume, description);
}

void vtkStratusTetrahedraMapper::ReleaseGraphicsResources(vtkWindow* window)
{
  this->Internal->Display.ReleaseGraphicsResources(window);
  this->Superclass::ReleaseGraphicsResources(window);
}

void vtkStratusTetrahedraMapper::SetDevice(const char* device)
{
  std::string error;
  if (this->Internal->Context.SetDevice(device, this->NumberOfThreads, error)) {
    this->Modified();
  } else if (!error.empty()) {
    vtkErrorMacro(<< error);
  }
}

// Not in the header, because VTK 9.2's smart pointers convert to pointers of complete classes only.
vtkLight* vtkStratusTetrahedraMapper::GetSun()
{
  return this->Sun;
}

void vtkStratusTetrahedraMapper::SetSun(vtkLight* light)
{
  if (this->Sun != light) {
    this->Sun = light;
    this->Modified();
  }
}

vtkImageData* vtkStratusTetrahedraMapper::GetMaskInput()
{
  return this->MaskInput;
}

void vtkStratusTetrahedraMapper::SetMaskInput(vtkImageData* mask)
{
  if (this->MaskInput != mask) {
    this->MaskInput = mask;
    this->Modified();
  }
}

void vtkStratusTetrahedraMapper::SetImageErrorTolerance(double tolerance)
{
  if (!(tolerance >= 0.0) || !std::isfinite(tolerance)) {
    vtkErrorMacro(<< "ImageErrorTolerance " << tolerance << " must be at least 0 and finite; " << this->ImageErrorTolerance << " stays");
  } else if (this->ImageErrorTolerance != tolerance) {
    this->ImageErrorTolerance = tolerance;
    this->Modified();
  }
}

const char* vtkStratusTetrahedraMapper::GetDevice()
{
  return this->Internal->Context.GetDevice().c_str();
}

const char* vtkStratusTetrahedraMapper::GetDeviceName()
{
  std::string error;
  return this->Internal->PrepareContext(error) ? stratus_context_device(this->Internal->Context.Get()) : "";
}

vtkTable* vtkStratusTetrahedraMapper::GetBuildReport()
{
  return this->Internal->BuildReport;
}

double vtkStratusTetrahedraMapper::GetMarchMilliseconds()
{
  return this->Internal->Report.march_ms;
}

const char* vtkStratusTetrahedraMapper::GetMethodAsString()
{
  return stratus_tetra_method_name(static_cast<stratus_tetra_method>(this->Method));
}

const char* vtkStratusTetrahedraMapper::GetLastError()
{
  return this->Internal->LastError.c_str();
}

const char* vtkStratusTetrahedraMapper::GetMethodUsedAsString()
{
  return stratus_tetra_method_name(this->Internal->Report.method);
}

const char* vtkStratusTetrahedraMapper::GetMethodReason()
{
  return this->Internal->Report.why;
}

double vtkStratusTetrahedraMapper::GetSortMilliseconds()
{
  return this->Internal->Report.sort_ms;
}

double vtkStratusTetrahedraMapper::GetBinMilliseconds()
{
  return this->Internal->Report.bin_ms;
}

double vtkStratusTetrahedraMapper::GetProjectMilliseconds()
{
  return this->Internal->Report.project_ms;
}

vtkIdType vtkStratusTetrahedraMapper::GetNumberOfCellsInView()
{
  return static_cast<vtkIdType>(this->Internal->Report.cells_in_view);
}

vtkIdType vtkStratusTetrahedraMapper::GetNumberOfPixelsDrawnAgain()
{
  return static_cast<vtkIdType>(this->Internal->Report.again);
}

vtkIdType vtkStratusTetrahedraMapper::GetNumberOfLeaves()
{
  return this->Internal->Report.leaves;
}

double vtkStratusTetrahedraMapper::GetBuildMilliseconds()
{
  return this->Internal->Report.build_ms;
}

vtkIdType vtkStratusTetrahedraMapper::GetNumberOfSegments()
{
  return static_cast<vtkIdType>(this->Internal->Report.segments);
}

vtkIdType vtkStratusTetrahedraMapper::GetNumberOfEntries()
{
  return static_cast<vtkIdType>(this->Internal->Report.entries);
}

vtkIdType vtkStratusTetrahedraMapper::GetNumberOfTetrahedra()
{
  return static_cast<vtkIdType>(this->Internal->Report.cells);
}

vtkIdType vtkStratusTetrahedraMapper::GetNumberOfBlankedTetrahedra()
{
  return static_cast<vtkIdType>(this->Internal->Report.blanked);
}

vtkIdType vtkStratusTetrahedraMapper::GetNumberOfIgnoredCells()
{
  return this->Internal->GetNumberOfIgnoredCells();
}

vtkTypeUInt64 vtkStratusTetrahedraMapper::GetFunctionBuilds()
{
  return this->Internal->GetFunctionBuilds();
}

vtkTypeUInt64 vtkStratusTetrahedraMapper::GetGeometryBuilds()
{
  return this->Internal->Report.mesh_builds;
}

vtkTypeUInt64 vtkStratusTetrahedraMapper::GetValueBuilds()
{
  return this->Internal->Report.value_builds;
}

vtkImageData* vtkStratusTetrahedraMapper::GetLastImage()
{
  return this->Internal->GetLastImage();
}

void vtkStratusTetrahedraMapper::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  const stratus_tetra_report& report = this->Internal->Report;
  os << indent << "RenderMode: " << (this->RenderMode == FIRST_HIT_MODE ? "FirstHit" : "Composite") << "\n";
  os << indent << "Normals: " << (this->Normals == GRADIENT_NORMALS ? "Gradient" : "Faces") << "\n";
  os << indent << "ImageErrorTolerance: " << this->ImageErrorTolerance << "\n";
  os << indent << "Shadows: " << this->Shadows << "\n";
  os << indent << "VolumetricScatteringBlending: " << this->VolumetricScatteringBlending << "\n";
  os << indent << "ScatteringAnisotropy: " << this->ScatteringAnisotropy << "\n";
  os << indent << "GlobalIlluminationReach: " << this->GlobalIlluminationReach << "\n";
  os << indent << "MultipleScattering: " << this->MultipleScattering << "\n";
  os << indent << "SkyZenith: " << this->SkyZenith[0] << " " << this->SkyZenith[1] << " " << this->SkyZenith[2] << "\n";
  os << indent << "SkyHorizon: " << this->SkyHorizon[0] << " " << this->SkyHorizon[1] << " " << this->SkyHorizon[2] << "\n";
  os << indent << "SkyUp: " << this->SkyUp[0] << " " << this->SkyUp[1] << " " << this->SkyUp[2] << "\n";
  os << indent << "Sun: " << this->Sun.GetPointer() << "\n";
  os << indent << "ScreenEncoding: " << this->ScreenEncoding << "\n";
  os << indent << "Termination: " << this->Termination << "\n";
  os << indent << "ComponentMixing: " << this->ComponentMixing << "\n";
  os << indent << "GradientOpacityDistance: " << this->GradientOpacityDistance << "\n";
  os << indent << "AverageIPScalarRange: " << this->AverageIPScalarRange[0] << " " << this->AverageIPScalarRange[1] << "\n";
  os << indent << "Cropping: " << (this->Cropping ? "On" : "Off") << "\n";
  os << indent << "CroppingRegionPlanes:";
  for (const double plane : this->CroppingRegionPlanes) {
    os << " " << plane;
  }
  os << "\n";
  os << indent << "CroppingRegionFlags: " << this->CroppingRegionFlags << "\n";
  os << indent << "MaskInput: " << this->MaskInput.GetPointer() << "\n";
  os << indent << "MaskType: " << (this->MaskType == BinaryMaskType ? "binary" : "label map") << "\n";
  os << indent << "Quantities: " << (this->Quantities ? this->Quantities : "") << "\n";
  os << indent << "TransmittanceThreshold: " << this->TransmittanceThreshold << "\n";
  os << indent << "NumberOfThreads: " << this->NumberOfThreads << "\n";
  os << indent << "Device: " << this->GetDevice() << "\n";
  os << indent << "Method: " << this->GetMethodAsString() << "\n";
  os << indent << "Method Used: " << stratus_tetra_method_name(report.method) << " (" << report.why << ")\n";
  os << indent << "Sort Milliseconds: " << report.sort_ms << "\n";
  os << indent << "Bin Milliseconds: " << report.bin_ms << "\n";
  os << indent << "Project Milliseconds: " << report.project_ms << "\n";
  os << indent << "Cells In View: " << report.cells_in_view << "\n";
  os << indent << "Pixels Drawn Again: " << report.again << "\n";
  os << indent << "March Milliseconds: " << report.march_ms << "\n";
  os << indent << "Build Milliseconds: " << report.build_ms << "\n";
  os << indent << "Tetrahedra: " << report.cells << "\n";
  os << indent << "Ignored Cells: " << this->Internal->GetNumberOfIgnoredCells() << "\n";
  os << indent << "Blanked Tetrahedra: " << report.blanked << "\n";
  os << indent << "Segments: " << report.segments << "\n";
  os << indent << "Entries: " << report.entries << "\n";
  os << indent << "Geometry Builds: " << report.mesh_builds << "\n";
  os << indent << "Value Builds: " << report.value_builds << "\n";
}
