// SPDX-License-Identifier: BSD-3-Clause
// Rows of floats -> the bytes of an OpenEXR file: scan lines, ZIP, lossless. Knows nothing of VTK, so that the command line uses it, too.
// Private to the module.
#ifndef vtkStratusEXRFile_h
#define vtkStratusEXRFile_h

#include <functional>
#include <string>
#include <vector>

#ifdef _WIN32
#define VTK_STRATUS_PRIVATE
#else
#define VTK_STRATUS_PRIVATE __attribute__((visibility("hidden")))
#endif

struct VTK_STRATUS_PRIVATE vtkStratusEXRChannel {
  std::string Name;                        // as viewers know them: R, G, B, A, Z, else any; 1..255 bytes, no two the same
  std::function<void(int, float*)> GetRow; // fills one row, 0 is the bottom one; may throw
};

// Gets the fraction done; throws to stop.
using vtkStratusEXRProgress = std::function<void(double)>;

// The file's bytes: a picture goes through memory, packed, and reaches a disk, a pipe or nobody when it is whole. EXR's first row is the
// top one. Throws std::runtime_error with a sentence, std::bad_alloc, and what callbacks throw. width, height: at least 1.
VTK_STRATUS_PRIVATE std::vector<unsigned char> vtkStratusEncodeEXR(
  int width, int height, const std::vector<vtkStratusEXRChannel>& channels, const vtkStratusEXRProgress& progress = nullptr);

#endif
