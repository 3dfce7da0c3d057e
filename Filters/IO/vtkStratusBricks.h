// SPDX-License-Identifier: BSD-3-Clause
// Arrays of a file's bricks, which are read when something looks at them, in bounded memory. Private to the module.
#ifndef vtkStratusBricks_h
#define vtkStratusBricks_h

#include "vtkStratusPrivate.h"

#include "vtkSmartPointer.h"
#include "vtkType.h"

#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

class vtkDataArray;

// The values of a file, and how its bricks are read. Sizes are of x, y, z; `Brick` is what the file reads best.
struct vtkStratusBrickSource {
  std::string Name;
  int Type = VTK_FLOAT, Components = 1;
  std::array<int64_t, 3> Dimensions, Brick;
  std::array<int64_t, 3> Before = { { 0, 0, 0 } }; // points of the first brick that precede the array; below Brick
  uint64_t Identity = 0;                           // as stratus_volume has it
  // Empty, or of each brick, x fastest, the one value that all of its values are, or NaN; for one component of a float or 8 or 16 bits.
  std::vector<float> Only;
  // Writes the box of `size` values from `lo` on, components first, then x. Returns false if it cannot be read. Called by other threads.
  std::function<bool(const int64_t lo[3], const int64_t size[3], void* values)> Read;
};

// Restricts a source to a box of its points. Bricks begin where they did.
VTK_STRATUS_PRIVATE void vtkStratusCutSource(
  vtkStratusBrickSource& source, const std::array<int64_t, 3>& lo, const std::array<int64_t, 3>& size);

// Whether the system can stop who reads a page that is not there.
VTK_STRATUS_PRIVATE bool vtkStratusHasBricks();
// Returns the array; null where the system cannot do that.
VTK_STRATUS_PRIVATE vtkSmartPointer<vtkDataArray> vtkStratusMakeBricks(const vtkStratusBrickSource& source);

// Lets the system read values of the array ahead, where values of another array of its shape are in memory, such as the time step that is
// shown. like: null ends it. Does nothing for arrays that are not bricks.
VTK_STRATUS_PRIVATE void vtkStratusReadAhead(vtkDataArray* array, vtkDataArray* like);

// The bytes that all such arrays of the process take at most. 0: half of the memory that was free at the first call.
VTK_STRATUS_PRIVATE void vtkStratusSetBrickMemory(vtkTypeInt64 bytes);
VTK_STRATUS_PRIVATE vtkTypeInt64 vtkStratusGetBrickMemory();
// Whether the limit was set to a number.
VTK_STRATUS_PRIVATE bool vtkStratusHasBrickMemory();
VTK_STRATUS_PRIVATE vtkTypeInt64 vtkStratusGetBrickMemoryUsed();
// The bytes that were read into such arrays so far.
VTK_STRATUS_PRIVATE vtkTypeInt64 vtkStratusGetBrickBytesRead();

#endif
