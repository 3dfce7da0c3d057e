// SPDX-License-Identifier: BSD-3-Clause
// The program stratus-tetgen, run with a request, a time limit and a way to stop it. Private to the module.
#ifndef vtkStratusTetGenProcess_h
#define vtkStratusTetGenProcess_h

#include "tetgen_exchange.h"

#include <cstdio>
#include <functional>
#include <string>

#define VTK_STRATUS_PRIVATE __attribute__((visibility("hidden")))

// Thrown inside the module, caught by the filter.
struct VTK_STRATUS_PRIVATE vtkStratusTetGenFailure {
  std::string Text;
};

// A file without a name, which is gone with the object. Its place in the file is 0 where it is handed on.
class VTK_STRATUS_PRIVATE vtkStratusTetGenSpool
{
public:
  vtkStratusTetGenSpool();
  ~vtkStratusTetGenSpool();
  vtkStratusTetGenSpool(const vtkStratusTetGenSpool&) = delete;
  void operator=(const vtkStratusTetGenSpool&) = delete;

  void Write(const void* values, size_t bytes);
  void Rewind();
  // False where the file ends before.
  bool Read(void* values, size_t bytes);
  std::string ReadText(size_t most);
  int GetDescriptor() const { return this->Descriptor; }

private:
  std::FILE* File = nullptr;
  int Descriptor = -1; // above those that a child process has by convention, closed there by itself
};

// Where the program is: `asked` if it is not empty, else beside the module's library.
VTK_STRATUS_PRIVATE std::string vtkStratusTetGenFindProgram(const std::string& asked);

// Runs it to its end. `stop` is asked all the while, with the seconds that have passed; throws where the program crashes, runs over its
// time, is stopped, or says that it failed.
VTK_STRATUS_PRIVATE void vtkStratusTetGenRun(const std::string& program, double time_limit, vtkStratusTetGenSpool& request,
  vtkStratusTetGenSpool& answer, const std::function<bool(double)>& stop);

#endif
