// SPDX-License-Identifier: BSD-3-Clause
// A context of the core that reports progress to VTK and honours VTK's abort. Private to the modules, never installed.
#ifndef vtkStratusContext_h
#define vtkStratusContext_h

#include "vtkStratusInput.h"

#include <functional>
#include <string>

class vtkTable;

class VTK_STRATUS_PRIVATE vtkStratusContext
{
public:
  // `progress` gets the fraction done, 0..1, and returns whether to stop.
  explicit vtkStratusContext(std::function<bool(double)> progress);
  ~vtkStratusContext();
  vtkStratusContext(const vtkStratusContext&) = delete;
  void operator=(const vtkStratusContext&) = delete;

  // Makes a new context for this device and number of threads. On failure the old context stays, and `error` lists the available devices.
  bool Create(const std::string& device, int threads, std::string& error);
  // Makes a context of the device where there is none, or where its number of threads is another.
  bool Prepare(int threads, std::string& error);
  // Takes a device by its name; nullptr and "" are "auto". Returns whether it is another than before; if it does not exist, `error` says
  // so.
  bool SetDevice(const char* device, int threads, std::string& error);
  // Writes the context's report to the table: "Stage", "Where", "Milliseconds", "Bytes", "Kernels".
  void GetBuildReport(vtkTable* table) const;
  // Fills the table unless the report is empty, so that the table describes the last frame that built anything.
  void KeepBuildReport(vtkTable* table) const;
  stratus_context* Get() const { return this->Context; }
  const std::string& GetDevice() const { return this->Device; }
  int GetThreads() const { return this->Threads; }
  // Called before the context is destroyed or replaced.
  std::function<void()> OnRelease;

private:
  static int OnProgress(void* self, const char* stage, double fraction);

  std::function<bool(double)> Progress;
  stratus_context* Context = nullptr;
  std::string Device = "auto";
  int Threads = 0;
};

#endif
