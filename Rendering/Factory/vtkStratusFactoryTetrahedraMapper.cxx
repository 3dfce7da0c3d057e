// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusFactoryTetrahedraMapper.h"

#include "vtkStratusFactory.h"
#include "vtkStratusTetrahedraMapper.h"

#include "vtkObjectFactory.h"

vtkStandardNewMacro(vtkStratusFactoryTetrahedraMapper);

vtkStratusFactoryTetrahedraMapper::vtkStratusFactoryTetrahedraMapper()
{
  this->Own->SetComponentMixingToMean(); // as VTK's mappers do
  vtkStratusKeepQuiet(this->Own);
}

vtkStratusFactoryTetrahedraMapper::~vtkStratusFactoryTetrahedraMapper() = default;

void vtkStratusFactoryTetrahedraMapper::Render(vtkRenderer* renderer, vtkVolume* volume)
{
  vtkStratusTetrahedraMapper* own = this->Own;
  std::string reason = this->GetNumberOfInputConnections(0) == 1 ? "" : "there is no input";
  if (reason.empty()) {
    vtkStratusTakeInput(own, this);
    own->SetBlendMode(this->BlendMode);
    own->Render(renderer, volume);
    reason = own->GetLastError();
  }
  if (!reason.empty()) {
    vtkStratusSayWhyNot(reason);
    this->Superclass::Render(renderer, volume);
  }
}

void vtkStratusFactoryTetrahedraMapper::ReleaseGraphicsResources(vtkWindow* window)
{
  this->Own->ReleaseGraphicsResources(window);
  this->Superclass::ReleaseGraphicsResources(window);
}

void vtkStratusFactoryTetrahedraMapper::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Own:\n";
  this->Own->PrintSelf(os, indent.GetNextIndent());
}
