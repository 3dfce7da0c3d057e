// SPDX-License-Identifier: BSD-3-Clause
// The values of an image file, one behind the other, whatever they are encoded as and however many files they are in. Private to the
// module.
#ifndef vtkStratusImageValues_h
#define vtkStratusImageValues_h

#include "vtkStratusImageFile.h"
#include "vtkStratusPrivate.h"

#include <cstdint>
#include <functional>
#include <memory>

// The bytes of one file's values, in order. Next() and Skip() throw vtkStratusReadError where the file has no more.
class VTK_STRATUS_PRIVATE vtkStratusImageBytes
{
public:
  virtual ~vtkStratusImageBytes() = default;
  // Puts out the next `values` values of `size` bytes each.
  virtual void Next(char* to, int64_t values, size_t size) = 0;
  virtual void Skip(int64_t values, size_t size) = 0;
};

class VTK_STRATUS_PRIVATE vtkStratusImageValues
{
public:
  // Opens nothing yet, but looks at the lengths of all files. Throws where they can't hold the values, so that a wrong size in a header
  // takes no memory. `progress` gets the part that is done, 0..1, and may throw.
  vtkStratusImageValues(const vtkStratusImageFile& file, const std::function<void(double)>& progress);
  ~vtkStratusImageValues();
  vtkStratusImageValues(const vtkStratusImageValues&) = delete;
  void operator=(const vtkStratusImageValues&) = delete;

  // Puts out the next values in the machine's order of bytes.
  void Next(void* to, int64_t values);
  void Skip(int64_t values);

private:
  // Calls work(values of this file that are next, the number before them) until `values` are done.
  template <class Work> void Walk(int64_t values, const Work& work);
  void CheckLength(const std::string& path) const;

  const vtkStratusImageFile& File;
  std::function<void(double)> Progress;
  size_t Size;     // bytes of a value
  int64_t All;     // values of all files
  int64_t PerFile; // values of each file
  int64_t Done = 0;
  std::unique_ptr<vtkStratusImageBytes> Bytes; // of the file that is open
};

#endif
