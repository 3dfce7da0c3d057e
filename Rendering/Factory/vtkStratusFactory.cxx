// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusFactory.h"

#include "vtkStratusFactoryTetrahedraMapper.h"
#include "vtkStratusFactoryVolumeMapper.h"

#include "vtkAbstractVolumeMapper.h"
#include "vtkAlgorithmOutput.h"
#include "vtkCallbackCommand.h"
#include "vtkNew.h"
#include "vtkVersion.h"

#include <cstdio>
#include <mutex>
#include <set>

vtkStandardNewMacro(vtkStratusFactory);

namespace {
VTK_CREATE_CREATE_FUNCTION(vtkStratusFactoryVolumeMapper);
VTK_CREATE_CREATE_FUNCTION(vtkStratusFactoryTetrahedraMapper);
} // namespace

vtkStratusFactory::vtkStratusFactory()
{
  // vtkSmartVolumeMapper and vtkMultiBlockVolumeMapper make the first themselves.
  this->RegisterOverride("vtkGPUVolumeRayCastMapper", "vtkStratusFactoryVolumeMapper", "draws by Stratus where it can", 1,
    vtkObjectFactoryCreatevtkStratusFactoryVolumeMapper);
  this->RegisterOverride("vtkProjectedTetrahedraMapper", "vtkStratusFactoryTetrahedraMapper", "draws by Stratus where it can", 1,
    vtkObjectFactoryCreatevtkStratusFactoryTetrahedraMapper);
}

const char* vtkStratusFactory::GetVTKSourceVersion() VTK_FUTURE_CONST
{
  return VTK_SOURCE_VERSION;
}

const char* vtkStratusFactory::GetDescription() VTK_FUTURE_CONST
{
  return "Stratus's mappers in place of VTK's";
}

void vtkStratusTakeInput(vtkAbstractVolumeMapper* own, vtkAbstractVolumeMapper* of_vtk)
{
  if (own->GetNumberOfInputConnections(0) != 1 || own->GetInputConnection(0, 0) != of_vtk->GetInputConnection(0, 0)) {
    own->SetInputConnection(of_vtk->GetInputConnection(0, 0));
  }
  own->SetScalarMode(of_vtk->GetScalarMode());
  if (of_vtk->GetArrayAccessMode() == VTK_GET_ARRAY_BY_ID) {
    own->SelectScalarArray(of_vtk->GetArrayId());
  } else {
    own->SelectScalarArray(of_vtk->GetArrayName());
  }
  own->SetArrayAccessMode(of_vtk->GetArrayAccessMode());
  own->SetClippingPlanes(of_vtk->GetClippingPlanes());
}

void vtkStratusKeepQuiet(vtkAbstractVolumeMapper* own)
{
  vtkNew<vtkCallbackCommand> hears; // an error that somebody hears is not printed
  own->AddObserver(vtkCommand::ErrorEvent, hears);
}

void vtkStratusSayWhyNot(const std::string& reason)
{
  static std::mutex lock;
  static std::set<std::string> said;
  const std::lock_guard<std::mutex> guard(lock);
  if (said.insert(reason).second) {
    std::fprintf(stderr, "Stratus: VTK's mapper draws, because %s\n", reason.c_str());
  }
}

extern "C" __attribute__((visibility("default"))) void* stratus_make_factory()
{
  return static_cast<vtkObjectFactory*>(vtkStratusFactory::New());
}
