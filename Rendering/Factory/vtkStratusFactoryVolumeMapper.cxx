// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusFactoryVolumeMapper.h"

#include "vtkStratusFactory.h"
#include "vtkStratusVolumeMapper.h"

#include "vtkImageData.h"
#include "vtkObjectFactory.h"
#include "vtkShaderProperty.h"
#include "vtkVersionMacros.h"
#include "vtkVolume.h"
#include "vtkVolumeProperty.h"

vtkStandardNewMacro(vtkStratusFactoryVolumeMapper);

vtkStratusFactoryVolumeMapper::vtkStratusFactoryVolumeMapper()
{
  // VTK's definitions of these two settings, since the program was written for VTK's mappers.
  this->Own->SetGradientOpacityDistance(-1.0);
  this->Own->SetComponentMixingToMean();
  vtkStratusKeepQuiet(this->Own);
}

vtkStratusFactoryVolumeMapper::~vtkStratusFactoryVolumeMapper() = default;

// Finds settings that vtkStratusVolumeMapper does not receive and so cannot refuse. Returns "" if there are none.
std::string vtkStratusFactoryVolumeMapper::FindHindrance(vtkVolume* volume)
{
  if (this->GetInputCount() > 1 || this->GetNumberOfInputConnections(0) != 1) {
    return "several volumes share one mapper";
  }
  vtkShaderProperty* shaders = volume->GetShaderProperty();
  if (shaders && (shaders->HasVertexShaderCode() || shaders->HasFragmentShaderCode() || shaders->GetNumberOfShaderReplacements() > 0)) {
    return "the volume has shaders of its own";
  }
#if VTK_VERSION_NUMBER >= VTK_VERSION_CHECK(9, 2, 0)
  if (this->GetVolumetricScatteringBlending() > 0.0f || this->GetGlobalIlluminationReach() > 0.0f) {
    return "light is scattered or casts shadows";
  }
  if (this->GetComputeNormalFromOpacity()) {
    return "normals are computed from opacity";
  }
#endif
  return "";
}

void vtkStratusFactoryVolumeMapper::TakeSettings()
{
  vtkStratusVolumeMapper* own = this->Own;
  vtkStratusTakeInput(own, this);
  own->SetBlendMode(this->BlendMode);
  own->SetAverageIPScalarRange(this->AverageIPScalarRange);
  own->SetCropping(this->Cropping);
  own->SetCroppingRegionPlanes(this->CroppingRegionPlanes);
  own->SetCroppingRegionFlags(this->CroppingRegionFlags);
  // Steps are left to the tolerance: a program sets them for the sake of the picture or of speed, of which each has its own way here.
  own->SetAutoAdjustSampleDistances(this->AutoAdjustSampleDistances);
  own->SetImageSampleDistance(this->ImageSampleDistance);
  own->SetMaximumImageSampleDistance(this->MaximumImageSampleDistance);
  own->SetFinalColorWindow(this->FinalColorWindow);
  own->SetFinalColorLevel(this->FinalColorLevel);
  own->SetUseJittering(this->UseJittering);
  own->SetMaskInput(this->MaskInput);
  own->SetMaskType(this->MaskType);
  own->SetMaskBlendFactor(this->MaskBlendFactor);
  own->SetTransfer2DYAxisArray(this->Transfer2DYAxisArray);
  own->SetRenderToImage(this->RenderToImage);
  own->SetDepthImageScalarType(this->DepthImageScalarType);
}

void vtkStratusFactoryVolumeMapper::Render(vtkRenderer* renderer, vtkVolume* volume)
{
  std::string reason = this->FindHindrance(volume);
  if (reason.empty()) {
    this->TakeSettings();
    this->Own->Render(renderer, volume);
    reason = this->Own->GetLastError();
  }
  this->DrawnByOwn = reason.empty();
  if (!this->DrawnByOwn) {
    vtkStratusSayWhyNot(reason);
    this->Superclass::Render(renderer, volume);
  }
}

void vtkStratusFactoryVolumeMapper::ReleaseGraphicsResources(vtkWindow* window)
{
  this->Own->ReleaseGraphicsResources(window);
  this->Superclass::ReleaseGraphicsResources(window);
}

void vtkStratusFactoryVolumeMapper::GetColorImage(vtkImageData* image)
{
  if (this->DrawnByOwn) {
    this->Own->GetColorImage(image);
  } else {
    this->Superclass::GetColorImage(image);
  }
}

void vtkStratusFactoryVolumeMapper::GetDepthImage(vtkImageData* image)
{
  if (this->DrawnByOwn) {
    this->Own->GetDepthImage(image);
  } else {
    this->Superclass::GetDepthImage(image);
  }
}

void vtkStratusFactoryVolumeMapper::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "DrawnByOwn: " << this->DrawnByOwn << "\n";
  os << indent << "Own:\n";
  this->Own->PrintSelf(os, indent.GetNextIndent());
}
