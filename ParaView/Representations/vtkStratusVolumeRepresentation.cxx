// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusVolumeRepresentation.h"

#include "vtkStratusVolumeMapper.h"

#include "vtkObjectFactory.h"

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
