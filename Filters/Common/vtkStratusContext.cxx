// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusContext.h"

#include "vtkDoubleArray.h"
#include "vtkIdTypeArray.h"
#include "vtkNew.h"
#include "vtkStringArray.h"
#include "vtkTable.h"

#include <utility>

vtkStratusContext::vtkStratusContext(std::function<bool(double)> progress) : Progress(std::move(progress)) {}

vtkStratusContext::~vtkStratusContext()
{
  if (this->OnRelease) {
    this->OnRelease();
  }
  stratus_context_destroy(this->Context);
}

int vtkStratusContext::OnProgress(void* self, const char*, double fraction)
{
  return static_cast<vtkStratusContext*>(self)->Progress(fraction) ? 1 : 0;
}

bool vtkStratusContext::Create(const std::string& device, int threads, std::string& error)
{
  stratus_context_options options = stratus_context_options_default();
  options.device = device.c_str();
  options.threads = threads;
  options.progress = &vtkStratusContext::OnProgress;
  options.progress_user = this;
  char message[1024] = "";
  stratus_context* context = nullptr;
  if (stratus_context_create(&options, &context, message, sizeof message) != STRATUS_OK) {
    error = std::string(message) + "; devices are: auto, host";
    for (int i = 0; i < stratus_device_count(); ++i) {
      char name[256];
      if (stratus_device_name(i, name, sizeof name) == STRATUS_OK) {
        error += ", " + std::to_string(i) + " (" + name + ")";
      }
    }
    return false;
  }
  if (this->OnRelease) {
    this->OnRelease();
  }
  stratus_context_destroy(this->Context);
  this->Context = context;
  this->Device = device;
  this->Threads = threads;
  return true;
}

bool vtkStratusContext::Prepare(int threads, std::string& error)
{
  return (this->Context && this->Threads == threads) || this->Create(this->Device, threads, error);
}

bool vtkStratusContext::SetDevice(const char* device, int threads, std::string& error)
{
  const std::string name = device && *device ? device : "auto";
  return name != this->Device && this->Create(name, threads, error);
}

void vtkStratusContext::GetBuildReport(vtkTable* table) const
{
  stratus_build_stage stages[STRATUS_BUILD_STAGES_MAX];
  const int count = stratus_context_get_build_report(this->Context, stages, STRATUS_BUILD_STAGES_MAX);
  vtkNew<vtkStringArray> names, places;
  vtkNew<vtkDoubleArray> milliseconds;
  vtkNew<vtkIdTypeArray> bytes, kernels;
  names->SetName("Stage");
  places->SetName("Where");
  milliseconds->SetName("Milliseconds");
  bytes->SetName("Bytes");
  kernels->SetName("Kernels");
  for (int i = 0; i < count; ++i) {
    names->InsertNextValue(stages[i].name);
    places->InsertNextValue(stages[i].where);
    milliseconds->InsertNextValue(stages[i].ms);
    bytes->InsertNextValue(static_cast<vtkIdType>(stages[i].bytes));
    kernels->InsertNextValue(static_cast<vtkIdType>(stages[i].kernels));
  }
  table->Initialize();
  for (vtkAbstractArray* column : { static_cast<vtkAbstractArray*>(names), static_cast<vtkAbstractArray*>(places),
         static_cast<vtkAbstractArray*>(milliseconds), static_cast<vtkAbstractArray*>(bytes), static_cast<vtkAbstractArray*>(kernels) }) {
    table->AddColumn(column);
  }
}

void vtkStratusContext::KeepBuildReport(vtkTable* table) const
{
  if (stratus_context_get_build_report(this->Context, nullptr, 0) > 0) {
    this->GetBuildReport(table);
  }
}
