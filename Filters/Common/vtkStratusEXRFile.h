// SPDX-License-Identifier: BSD-3-Clause
// Encodes rows of floats as an OpenEXR file: scan lines, ZIP, lossless. It uses no VTK, so that the command line can compile it in. Private
// to the module.
#ifndef vtkStratusEXRFile_h
#define vtkStratusEXRFile_h

#include "vtkStratusPrivate.h"

#include <functional>
#include <string>
#include <vector>

struct VTK_STRATUS_PRIVATE vtkStratusEXRChannel {
  std::string Name;                        // 1..255 bytes, unique; viewers know R, G, B, A and Z
  std::function<void(int, float*)> GetRow; // fills one row, row 0 is the bottom one; may throw
  std::string Units{};                     // an attribute "NAME.units" of the file; "": none
};

// Gets the fraction done, 0..1. Throws to stop.
using vtkStratusEXRProgress = std::function<void(double)>;

// Returns the whole file, so that no half of it reaches a disk or a pipe. EXR's first row is the top one. Throws std::runtime_error with a
// message, std::bad_alloc, and the callbacks' exceptions. width and height are at least 1.
VTK_STRATUS_PRIVATE std::vector<unsigned char> vtkStratusEncodeEXR(
  int width, int height, const std::vector<vtkStratusEXRChannel>& channels, const vtkStratusEXRProgress& progress = nullptr);

#endif
