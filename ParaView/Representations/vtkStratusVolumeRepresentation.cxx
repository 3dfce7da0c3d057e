// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusVolumeRepresentation.h"

#include "vtkStratusVolumeMapper.h"

#include "vtkColorTransferFunction.h"
#include "vtkObjectFactory.h"
#include "vtkPVLODVolume.h"
#include "vtkVolumeProperty.h"

#include <algorithm>

vtkStandardNewMacro(vtkStratusVolumeRepresentation);

vtkStratusVolumeRepresentation::vtkStratusVolumeRepresentation()
{
  this->VolumeMapper.TakeReference(vtkStratusVolumeMapper::New());
}

vtkStratusVolumeRepresentation::~vtkStratusVolumeRepresentation() = default;

// Returns nullptr where the superclass has set another mapper, as it does for composite data.
vtkStratusVolumeMapper* vtkStratusVolumeRepresentation::GetStratusMapper()
{
  return vtkStratusVolumeMapper::SafeDownCast(this->VolumeMapper);
}

void vtkStratusVolumeRepresentation::UpdateMapperParameters()
{
  this->Superclass::UpdateMapperParameters();
  vtkStratusVolumeMapper* mapper = this->GetStratusMapper();
  if (!mapper) {
    return;
  }
  this->Actor->SetVisibility(this->Actor->GetVisibility() && this->GetVisibility());
  // A colour map shows a vector's magnitude or one of its components; components that the property takes as colour and opacity are left
  // as they are.
  vtkColorTransferFunction* colors = this->Property->GetRGBTransferFunction(0);
  const bool magnitude = colors->GetVectorMode() != vtkScalarsToColors::COMPONENT;
  mapper->SetVectorMode(!this->Property->GetIndependentComponents() ? vtkStratusVolumeMapper::DISABLED
      : magnitude                                                   ? vtkStratusVolumeMapper::MAGNITUDE
                                                                    : vtkStratusVolumeMapper::COMPONENT);
  const int component = std::max(colors->GetVectorComponent(), 0);
  mapper->SetVectorComponent(component);
  if (!magnitude && component > 0 && component < VTK_MAX_VRCOMP) { // ParaView edits the first component's functions, whichever shows
    this->Property->SetColor(component, colors);
    this->Property->SetScalarOpacity(component, this->Property->GetScalarOpacity(0));
    this->Property->SetScalarOpacityUnitDistance(component, this->Property->GetScalarOpacityUnitDistance(0));
  }
}

void vtkStratusVolumeRepresentation::ApplyBlendMode()
{
  this->VolumeMapper->SetBlendMode(this->Projection != vtkVolumeMapper::COMPOSITE_BLEND ? this->Projection : this->BlendMode);
}

void vtkStratusVolumeRepresentation::SetBlendMode(int mode)
{
  this->BlendMode = mode;
  this->ApplyBlendMode();
}

void vtkStratusVolumeRepresentation::SetProjection(int mode)
{
  this->Projection = mode;
  this->ApplyBlendMode();
}

void vtkStratusVolumeRepresentation::SetRenderMode(int mode)
{
  if (vtkStratusVolumeMapper* mapper = this->GetStratusMapper()) {
    mapper->SetRenderMode(mode);
  }
}

void vtkStratusVolumeRepresentation::SetNormals(int normals)
{
  if (vtkStratusVolumeMapper* mapper = this->GetStratusMapper()) {
    mapper->SetNormals(normals);
  }
}

void vtkStratusVolumeRepresentation::SetStructure(int structure)
{
  if (vtkStratusVolumeMapper* mapper = this->GetStratusMapper()) {
    mapper->SetStructure(structure);
  }
}

void vtkStratusVolumeRepresentation::SetSampling(int sampling)
{
  if (vtkStratusVolumeMapper* mapper = this->GetStratusMapper()) {
    mapper->SetSampling(sampling);
  }
}

void vtkStratusVolumeRepresentation::SetSampleDistance(double distance)
{
  if (vtkStratusVolumeMapper* mapper = this->GetStratusMapper()) {
    mapper->SetSampleDistance(distance);
  }
}

void vtkStratusVolumeRepresentation::SetCellError(double error)
{
  if (vtkStratusVolumeMapper* mapper = this->GetStratusMapper()) {
    mapper->SetCellError(error);
  }
}

void vtkStratusVolumeRepresentation::SetImageErrorTolerance(double tolerance)
{
  if (vtkStratusVolumeMapper* mapper = this->GetStratusMapper()) {
    mapper->SetImageErrorTolerance(tolerance);
  }
}

void vtkStratusVolumeRepresentation::SetTermination(double opacity)
{
  if (vtkStratusVolumeMapper* mapper = this->GetStratusMapper()) {
    mapper->SetTermination(opacity);
  }
}

void vtkStratusVolumeRepresentation::SetDevice(const char* device)
{
  if (vtkStratusVolumeMapper* mapper = this->GetStratusMapper()) {
    mapper->SetDevice(device);
  }
}

void vtkStratusVolumeRepresentation::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "VolumeMapper:\n";
  this->VolumeMapper->PrintSelf(os, indent.GetNextIndent());
}
