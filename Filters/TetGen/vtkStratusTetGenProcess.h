// SPDX-License-Identifier: BSD-3-Clause
// Runs the program stratus-tetgen with a request, a time limit and a way to stop it. Private to the module.
#ifndef vtkStratusTetGenProcess_h
#define vtkStratusTetGenProcess_h

#include "tetgen_exchange.h"
#include "vtkStratusPrivate.h"

#include <cstdio>
#include <functional>
#include <string>

// Thrown inside the module and caught by the filter.
struct VTK_STRATUS_PRIVATE vtkStratusTetGenFailure {
  std::string Text;
};

// A file without a name, which ends with the object. Parent and child share its read and write position, so Rewind() precedes each use.
class VTK_STRATUS_PRIVATE vtkStratusTetGenSpool
{
public:
  vtkStratusTetGenSpool();
  ~vtkStratusTetGenSpool();
  vtkStratusTetGenSpool(const vtkStratusTetGenSpool&) = delete;
  void operator=(const vtkStratusTetGenSpool&) = delete;

  void Write(const void* values, size_t bytes);
  void Rewind();
  // Returns false where the file ends before `bytes` are read.
  bool Read(void* values, size_t bytes);
  std::string ReadText(size_t most);
  int GetDescriptor() const { return this->Descriptor; }

private:
  std::FILE* File = nullptr;
  int Descriptor = -1; // 16 or above, clear of the descriptors that the child uses, and closed in the child by exec
};

// Returns the program's path: `asked` if it is not empty, else the program next to the module's library. Throws where there is none.
VTK_STRATUS_PRIVATE std::string vtkStratusTetGenFindProgram(const std::string& asked);

// Runs the program to its end and calls `stop` repeatedly with the seconds that have passed. Throws if the program crashes, exceeds its
// time, is stopped, or reports a failure.
VTK_STRATUS_PRIVATE void vtkStratusTetGenRun(const std::string& program, double time_limit, vtkStratusTetGenSpool& request,
  vtkStratusTetGenSpool& answer, const std::function<bool(double)>& stop);

#endif
