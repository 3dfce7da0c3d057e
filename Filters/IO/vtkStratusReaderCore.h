// SPDX-License-Identifier: BSD-3-Clause
// A context of the core on the host, whose failures are the reader's. Private to the module.
#ifndef vtkStratusReaderCore_h
#define vtkStratusReaderCore_h

#include "vtkStratusReadError.h"

#include "stratus/context.h"

#include <string>

class vtkStratusReaderCore
{
public:
  vtkStratusReaderCore()
  {
    stratus_context_options options = stratus_context_options_default();
    options.device = "host";
    options.threads = 1;
    char message[256] = "";
    if (stratus_context_create(&options, &this->Context, message, sizeof message) != STRATUS_OK) {
      throw vtkStratusReadError{ message };
    }
  }
  ~vtkStratusReaderCore() { stratus_context_destroy(this->Context); }
  vtkStratusReaderCore(const vtkStratusReaderCore&) = delete;
  void operator=(const vtkStratusReaderCore&) = delete;

  operator stratus_context*() const { return this->Context; }
  // Throws if a call failed. where: before the message
  void Check(stratus_status status, const std::string& where = "") const
  {
    if (status != STRATUS_OK) {
      throw vtkStratusReadError{ where + stratus_context_message(this->Context) };
    }
  }

private:
  stratus_context* Context = nullptr;
};

#endif
