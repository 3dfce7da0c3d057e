// SPDX-License-Identifier: BSD-3-Clause
// Arrays whose values stay in their file: the system reads a page when it is first looked at, and forgets it when memory is short. Private
// to the module.
#ifndef vtkStratusMappedFile_h
#define vtkStratusMappedFile_h

#include "vtkStratusPrivate.h"

#include "vtkSmartPointer.h"
#include "vtkType.h"

#include <cstdint>
#include <string>

class vtkDataArray;

// Returns an array called `name`, of a type of VTK's numbers over the file's bytes from `begin` on, or null where the file can't be mapped:
// on a system or a file system without mappings, or where `begin` is no multiple of a value's size. What the program writes into the array
// stays in memory. A file that is renamed or removed keeps its values. Where one is cut short, or the disk fails, the values that are
// missing are 0, and vtkStratusMissingOf() counts them. The array's identity (vtkStratusIdentityOf()) follows from the file's
// length, time and a sample of its bytes.
VTK_STRATUS_PRIVATE vtkSmartPointer<vtkDataArray> vtkStratusMapFile(
  const std::string& path, int64_t begin, const char* name, int type, int components, vtkIdType tuples);

#endif
