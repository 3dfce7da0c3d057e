// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusVolumeMapper.h"

#include "vtkStratusDepthOrder.h"
#include "vtkStratusVolumeMapperInternals.h"
#include "vtkStratusVolumeMixer.h"

#include "vtkCommand.h"
#include "vtkImageData.h"
#include "vtkLight.h"
#include "vtkInformation.h"
#include "vtkObjectFactory.h"
#include "vtkRenderWindow.h"
#include "vtkRenderer.h"
#include "vtkVolume.h"

#include <chrono>
#include <cmath>
#include <new>
#include <utility>

vtkStandardNewMacro(vtkStratusVolumeMapper);

vtkStratusVolumeMapper::vtkStratusVolumeMapper() : Internal(new Internals(this))
{
  vtkStratusRegisterMixer();
}

vtkStratusVolumeMapper::~vtkStratusVolumeMapper()
{
  this->SetTransfer2DYAxisArray(nullptr);
  this->SetQuantities(nullptr);
}

int vtkStratusVolumeMapper::FillInputPortInformation(int, vtkInformation* info)
{
  info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkImageData");
  info->Append(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkRectilinearGrid");
  return 1;
}

void vtkStratusVolumeMapper::Render(vtkRenderer* ren, vtkVolume* vol)
{
  if (vtkStratusDepthOrder::Draw(ren, vol, this)) {
    return;
  }
  const auto start = std::chrono::steady_clock::now();
  this->InvokeEvent(vtkCommand::VolumeMapperRenderStartEvent, nullptr);
  std::string error;
  try {
    this->Internal->Render(ren, vol, error);
  } catch (const std::bad_alloc&) {
    error = "there is not enough memory for the picture";
  }
  std::swap(error, this->Internal->LastError);
  if (!this->Internal->LastError.empty() && this->Internal->LastError != error) { // reported once, not with every picture
    vtkErrorMacro(<< this->Internal->LastError << "; nothing is drawn");
  }
  this->InvokeEvent(vtkCommand::VolumeMapperRenderEndEvent, nullptr);
  this->TimeToDraw = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

bool vtkStratusVolumeMapper::MeasureSampling(vtkRenderer* renderer, vtkVolume* volume, double choice[4])
{
  try {
    return this->Internal->Measure(renderer, volume, choice);
  } catch (const std::bad_alloc&) {
    return false;
  }
}

void vtkStratusVolumeMapper::ReleaseGraphicsResources(vtkWindow* window)
{
  this->Internal->Display.ReleaseGraphicsResources(window);
  if (this->Internal->Joint) {
    this->Internal->Joint->ReleaseGraphicsResources(window);
  }
  this->Superclass::ReleaseGraphicsResources(window);
}

void vtkStratusVolumeMapper::SetDevice(const char* device)
{
  std::string error;
  if (this->Internal->Context.SetDevice(device, this->NumberOfThreads, error)) {
    this->Modified();
  } else if (!error.empty()) {
    vtkErrorMacro(<< error);
  }
}

// Not in the header, because VTK 9.2's smart pointers convert to pointers of complete classes only.
vtkLight* vtkStratusVolumeMapper::GetSun()
{
  return this->Sun;
}

void vtkStratusVolumeMapper::SetSun(vtkLight* light)
{
  if (this->Sun != light) {
    this->Sun = light;
    this->Modified();
  }
}

vtkImageData* vtkStratusVolumeMapper::GetMaskInput()
{
  return this->MaskInput;
}

void vtkStratusVolumeMapper::SetMaskInput(vtkImageData* mask)
{
  if (this->MaskInput != mask) {
    this->MaskInput = mask;
    this->Modified();
  }
}

void vtkStratusVolumeMapper::SetImageErrorTolerance(double tolerance)
{
  if (!(tolerance >= 0.0) || !std::isfinite(tolerance)) {
    vtkErrorMacro(<< "ImageErrorTolerance " << tolerance << " must be at least 0 and finite; " << this->ImageErrorTolerance << " stays");
  } else if (this->ImageErrorTolerance != tolerance) {
    this->ImageErrorTolerance = tolerance;
    this->Modified();
  }
}

const char* vtkStratusVolumeMapper::GetDevice()
{
  return this->Internal->Context.GetDevice().c_str();
}

const char* vtkStratusVolumeMapper::GetDeviceName()
{
  std::string error;
  return this->Internal->PrepareContext(error) ? stratus_context_device(this->Internal->Context.Get()) : "";
}

vtkTable* vtkStratusVolumeMapper::GetBuildReport()
{
  return this->Internal->BuildReport;
}

const char* vtkStratusVolumeMapper::GetStructureAsString()
{
  return stratus_structure_name(static_cast<stratus_structure>(this->Structure));
}

const char* vtkStratusVolumeMapper::GetRenderModeAsString()
{
  return this->RenderMode == PATH_MODE ? "path" : stratus_mode_name(static_cast<stratus_mode>(this->RenderMode));
}

bool vtkStratusVolumeMapper::GetToleranceMet()
{
  return this->Internal->Report.tolerance_met != 0;
}

bool vtkStratusVolumeMapper::GetCarriedTreeUsed()
{
  return this->Internal->Report.offered_tree != 0;
}

double* vtkStratusVolumeMapper::GetBounds()
{
  double* bounds = this->Superclass::GetBounds();
  this->Internal->WidenBounds(bounds);
  return bounds;
}

const char* vtkStratusVolumeMapper::GetSamplingAsString()
{
  return stratus_sampling_name(static_cast<stratus_sampling>(this->Sampling));
}

const char* vtkStratusVolumeMapper::GetStructureUsedAsString()
{
  return stratus_structure_name(this->Internal->Report.structure);
}

const char* vtkStratusVolumeMapper::GetSamplingUsedAsString()
{
  return stratus_sampling_name(this->Internal->Report.sampling);
}

const char* vtkStratusVolumeMapper::GetLastError()
{
  return this->Internal->LastError.c_str();
}

const char* vtkStratusVolumeMapper::GetReason()
{
  return this->Internal->Report.why;
}

vtkTypeUInt64 vtkStratusVolumeMapper::GetFunctionBuilds()
{
  return this->Internal->GetFunctionBuilds();
}

double vtkStratusVolumeMapper::GetUsedImageSampleDistance()
{
  return this->Internal->UsedCoarseness;
}

double vtkStratusVolumeMapper::GetDrawTime()
{
  return this->Internal->DrawMilliseconds;
}

vtkImageData* vtkStratusVolumeMapper::GetLastImage()
{
  return this->Internal->GetLastImage();
}

#define REPORT(type, getter, field)                                                                                                        \
  type vtkStratusVolumeMapper::getter()                                                                                                    \
  {                                                                                                                                        \
    return this->Internal->Report.field;                                                                                                   \
  }
REPORT(vtkTypeUInt64, GetSamplesTaken, samples)
REPORT(vtkTypeUInt64, GetSamplesSkipped, skipped)
REPORT(vtkTypeUInt64, GetStructureLookups, lookups)
REPORT(vtkTypeUInt64, GetDifferingPixels, differing_pixels)
REPORT(vtkTypeUInt64, GetBlocks, blocks)
REPORT(vtkTypeUInt64, GetOccupiedBlocks, occupied_blocks)
REPORT(vtkTypeUInt64, GetStructureBytes, structure_bytes)
REPORT(vtkTypeUInt64, GetRangeBuilds, range_builds)
REPORT(vtkTypeUInt64, GetTableBuilds, table_builds)
REPORT(vtkTypeUInt64, GetOccupancyBuilds, occupancy_builds)
REPORT(vtkTypeUInt64, GetStructureBuilds, structure_builds)
REPORT(vtkTypeUInt64, GetUploads, uploads)
REPORT(double, GetRangeTime, range_ms)
REPORT(double, GetTableTime, table_ms)
REPORT(double, GetOccupancyTime, occupancy_ms)
REPORT(double, GetStructureTime, structure_ms)
REPORT(double, GetUploadTime, upload_ms)
REPORT(double, GetCastTime, cast_ms)
REPORT(double, GetUsedSampleDistance, sample_distance)
REPORT(double, GetExpectedError, expected_error)
REPORT(double, GetProbeTime, probe_ms)
REPORT(vtkTypeUInt64, GetProbeSamples, probe_samples)
REPORT(vtkTypeUInt64, GetProbeBuilds, probe_builds)

void vtkStratusVolumeMapper::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "SampleDistance: " << this->SampleDistance << "\n";
  os << indent << "AutoAdjustSampleDistances: " << (this->AutoAdjustSampleDistances ? "On" : "Off") << "\n";
  os << indent << "InteractiveUpdateRate: " << this->InteractiveUpdateRate << "\n";
  os << indent << "ImageSampleDistance: " << this->ImageSampleDistance << "\n";
  os << indent << "MaximumImageSampleDistance: " << this->MaximumImageSampleDistance << "\n";
  os << indent << "MaximumSampleDistanceFactor: " << this->MaximumSampleDistanceFactor << "\n";
  os << indent << "FinalColorWindow: " << this->FinalColorWindow << "\n";
  os << indent << "FinalColorLevel: " << this->FinalColorLevel << "\n";
  os << indent << "RenderMode: " << this->GetRenderModeAsString() << "\n";
  os << indent << "PathTolerance: " << this->PathTolerance << "\n";
  os << indent << "PathSeconds: " << this->PathSeconds << "\n";
  os << indent << "Normals: " << (this->Normals == GRADIENT_NORMALS ? "gradient" : "faces") << "\n";
  os << indent << "Structure: " << this->GetStructureAsString() << "\n";
  os << indent << "Sampling: " << this->GetSamplingAsString() << "\n";
  os << indent << "CellError: " << this->CellError << "\n";
  os << indent << "LightSpread: " << this->LightSpread << "\n";
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
  os << indent << "ImageErrorTolerance: " << this->ImageErrorTolerance << "\n";
  os << indent << "Termination: " << this->Termination << "\n";
  os << indent << "BlockSize: " << this->BlockSize << "\n";
  os << indent << "Device: " << this->GetDevice() << "\n";
  os << indent << "NumberOfThreads: " << this->NumberOfThreads << "\n";
  os << indent << "Audit: " << (this->Audit ? "On" : "Off") << "\n";
  os << indent << "MaskInput: " << this->MaskInput.GetPointer() << "\n";
  os << indent << "MaskType: " << (this->MaskType == BinaryMaskType ? "binary" : "label map") << "\n";
  os << indent << "MaskBlendFactor: " << this->MaskBlendFactor << "\n";
  os << indent << "GradientOpacityDistance: " << this->GradientOpacityDistance << "\n";
  os << indent << "ComponentMixing: " << (this->ComponentMixing == MEAN_COMPONENTS ? "mean" : "add") << "\n";
  os << indent << "VectorMode: " << this->VectorMode << "\n";
  os << indent << "VectorComponent: " << this->VectorComponent << "\n";
  os << indent << "RenderToImage: " << (this->RenderToImage ? "On" : "Off") << "\n";
  os << indent << "DepthImageScalarType: " << this->DepthImageScalarType << "\n";
  os << indent << "Transfer2DYAxisArray: " << (this->Transfer2DYAxisArray ? this->Transfer2DYAxisArray : "(none)") << "\n";
  os << indent << "UseJittering: " << (this->UseJittering ? "On" : "Off") << "\n";
  os << indent << "JitterSeed: " << this->JitterSeed << "\n";
  os << indent << "CountSamples: " << (this->CountSamples ? "On" : "Off") << "\n";
  os << indent << "Quantities: " << (this->Quantities ? this->Quantities : "") << "\n";
  os << indent << "TransmittanceThreshold: " << this->TransmittanceThreshold << "\n";
  os << indent << "Last picture: structure " << this->GetStructureUsedAsString() << ", sampling " << this->GetSamplingUsedAsString()
     << ", sample distance " << this->GetUsedSampleDistance() << ", " << this->GetUsedImageSampleDistance() << " pixels a ray, "
     << this->GetSamplesTaken() << " samples, " << this->GetSamplesSkipped() << " skipped, " << this->GetCastTime()
     << " ms, expected error " << this->GetExpectedError() << "\n";
}
