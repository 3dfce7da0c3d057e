// SPDX-License-Identifier: BSD-3-Clause
// Arrays whose values stay in their file: the system reads a page when it is first looked at, and forgets it when memory is short. Private
// to the module.
#ifndef vtkStratusMappedFile_h
#define vtkStratusMappedFile_h

#include "vtkStratusParts.h"
#include "vtkStratusPrivate.h"

#include "vtkSmartPointer.h"
#include "vtkType.h"

#include <cstdint>
#include <string>

class vtkDataArray;

// Returns a number that the file's bytes have in every process, from its length, its time and a sample of `bytes` bytes from `begin` on;
// never 0, but where the file cannot be read. bytes < 0: to its end.
VTK_STRATUS_PRIVATE uint64_t vtkStratusIdentityOfFile(const std::string& path, int64_t begin, int64_t bytes);

// Returns an array called `name`, of a type of VTK's numbers over the file's bytes from `begin` on, or null where the file can't be mapped:
// on a system or a file system without mappings, or where `begin` is no multiple of a value's size. What the program writes into the array
// stays in memory. A file that is renamed or removed keeps its values. Where one is cut short, or the disk fails, the values that are
// missing are 0, and count (stratus_volume.missing). The array's identity (vtkStratusIdentityOf()) follows from the file's
// length, time and a sample of its bytes.
VTK_STRATUS_PRIVATE vtkSmartPointer<vtkDataArray> vtkStratusMapFile(
  const std::string& path, int64_t begin, const char* name, int type, int components, vtkIdType tuples);

// Returns the points of a box of such values, of sizes x, y, z, as an array that is mapped; or as bricks, if the box is not one run of the
// file's bytes, or if a limit of memory is set (vtkStratusHasBrickMemory()) that it exceeds. Null where it can't be made.
// bricks: also as bricks where the values can't be mapped because of the place at which they begin. swaps: the file has the other order of
// bytes, which only bricks can have.
VTK_STRATUS_PRIVATE vtkSmartPointer<vtkDataArray> vtkStratusLeaveRaw(const std::string& path, int64_t begin, const char* name, int type,
  int components, const int64_t sizes[3], const vtkStratusBox& box, bool bricks = false, bool swaps = false);

#endif
