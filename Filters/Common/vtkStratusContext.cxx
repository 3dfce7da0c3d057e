// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusContext.h"

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
