// SPDX-License-Identifier: BSD-3-Clause
// A file that several threads read at any place. Private to the module.
#ifndef vtkStratusOpenFile_h
#define vtkStratusOpenFile_h

#include "vtkStratusPrivate.h"

#include <cstddef>
#include <cstdint>
#include <string>

// Opens the file until the object is destroyed: a file that is renamed, removed or replaced meanwhile keeps its bytes.
class VTK_STRATUS_PRIVATE vtkStratusOpenFile
{
public:
  explicit vtkStratusOpenFile(const std::string& path);
  ~vtkStratusOpenFile();
  vtkStratusOpenFile(const vtkStratusOpenFile&) = delete;
  void operator=(const vtkStratusOpenFile&) = delete;

  bool IsOpen() const { return this->Handle >= 0; }
  int GetHandle() const { return this->Handle; }
  // Reads all of the bytes; false if there are fewer, or the disk fails.
  bool Read(int64_t at, void* to, size_t bytes) const;
  // Lets the system read ahead.
  void Expect(int64_t at, int64_t bytes) const;

private:
  int Handle = -1;
};

#endif
