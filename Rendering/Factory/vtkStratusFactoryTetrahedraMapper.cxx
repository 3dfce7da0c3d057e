// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusFactoryTetrahedraMapper.h"

#include "vtkStratusFactory.h"
#include "vtkStratusTetrahedraMapper.h"

#include "vtkAlgorithmOutput.h"
#include "vtkCallbackCommand.h"
#include "vtkObjectFactory.h"

vtkStandardNewMacro(vtkStratusFactoryTetrahedraMapper);

vtkStratusFactoryTetrahedraMapper::vtkStratusFactoryTetrahedraMapper()
{
  this->Own->SetComponentMixingToMean(); // as VTK's mappers do
  vtkNew<vtkCallbackCommand> hears;      // an error that somebody hears is not printed: VTK's mapper draws then
  this->Own->AddObserver(vtkCommand::ErrorEvent, hears);
}

vtkStratusFactoryTetrahedraMapper::~vtkStratusFactoryTetrahedraMapper() = default;

void vtkStratusFactoryTetrahedraMapper::Render(vtkRenderer* renderer, vtkVolume* volume)
{
  vtkStratusTetrahedraMapper* own = this->Own;
  std::string reason = this->GetNumberOfInputConnections(0) == 1 ? "" : "there is no input";
  if (reason.empty()) {
    if (own->GetNumberOfInputConnections(0) != 1 || own->GetInputConnection(0, 0) != this->GetInputConnection(0, 0)) {
      own->SetInputConnection(this->GetInputConnection(0, 0));
    }
    own->SetScalarMode(this->ScalarMode);
    if (this->ArrayAccessMode == VTK_GET_ARRAY_BY_ID) {
      own->SelectScalarArray(this->ArrayId);
    } else {
      own->SelectScalarArray(this->ArrayName);
    }
    own->SetArrayAccessMode(this->ArrayAccessMode);
    own->SetBlendMode(this->BlendMode);
    own->SetClippingPlanes(this->ClippingPlanes);
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
