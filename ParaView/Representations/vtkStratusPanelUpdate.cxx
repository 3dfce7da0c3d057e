// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusPanelUpdate.h"

#include "vtkCallbackCommand.h"
#include "vtkCompositeRepresentation.h"
#include "vtkNew.h"
#include "vtkPVDataRepresentation.h"
#include "vtkProcessModule.h"
#include "vtkRenderer.h"
#include "vtkSMProxy.h"
#include "vtkSMProxyIterator.h"
#include "vtkSMProxyManager.h"
#include "vtkSMSessionProxyManager.h"
#include "vtkSMTrace.h"

namespace {

void ask(vtkObject*, unsigned long, void* representation, void*)
{
  vtkSMSessionProxyManager* proxies =
    vtkSMProxyManager::IsInitialized() ? vtkSMProxyManager::GetProxyManager()->GetActiveSessionProxyManager() : nullptr;
  // A trace takes what changes while the panel's settings do for settings, too, and a script that sets it ends in an error.
  if (!proxies || vtkSMTrace::GetActiveTracer()) {
    return;
  }
  vtkNew<vtkSMProxyIterator> each;
  each->SetSessionProxyManager(proxies);
  each->SetModeToOneGroup();
  for (each->Begin("representations"); !each->IsAtEnd(); each->Next()) {
    auto* types = vtkCompositeRepresentation::SafeDownCast(each->GetProxy()->GetClientSideObject());
    if (types && types->GetActiveRepresentation() == representation) {
      each->GetProxy()->UpdatePropertyInformation();
    }
  }
}
} // namespace

void stratus::PanelUpdate::Enter(vtkRenderer* renderer, vtkPVDataRepresentation* representation)
{
  this->Leave();
  const int process = vtkProcessModule::GetProcessType();
  if (process != vtkProcessModule::PROCESS_CLIENT && process != vtkProcessModule::PROCESS_BATCH) {
    return;
  }
  vtkNew<vtkCallbackCommand> command;
  command->SetClientData(representation);
  command->SetCallback(ask);
  this->Renderer = renderer;
  this->Observer = renderer->AddObserver(vtkCommand::EndEvent, command);
}

void stratus::PanelUpdate::Leave()
{
  if (this->Renderer) {
    this->Renderer->RemoveObserver(this->Observer);
  }
  this->Renderer = nullptr;
}
