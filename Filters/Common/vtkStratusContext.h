// SPDX-License-Identifier: BSD-3-Clause
// A context of the core, with VTK's progress and abort. Private to the modules, never installed.
#ifndef vtkStratusContext_h
#define vtkStratusContext_h

#include "vtkStratusInput.h"

#include <functional>
#include <string>

class VTK_STRATUS_PRIVATE vtkStratusContext
{
public:
  // progress: gets 0..1, returns whether to stop.
  explicit vtkStratusContext(std::function<bool(double)> progress);
  ~vtkStratusContext();
  vtkStratusContext(const vtkStratusContext&) = delete;
  void operator=(const vtkStratusContext&) = delete;

  // Makes it anew for this device and number of threads, or leaves it as it is and tells which devices there are.
  bool Create(const std::string& device, int threads, std::string& error);
  stratus_context* Get() const { return this->Context; }
  const std::string& GetDevice() const { return this->Device; }
  int GetThreads() const { return this->Threads; }
  // Called before the context goes.
  std::function<void()> OnRelease;

private:
  static int OnProgress(void* self, const char* stage, double fraction);

  std::function<bool(double)> Progress;
  stratus_context* Context = nullptr;
  std::string Device = "auto";
  int Threads = 0;
};

#endif
