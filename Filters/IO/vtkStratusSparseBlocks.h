// SPDX-License-Identifier: BSD-3-Clause
// Divides what a sparse grid has into few boxes that hold little else. Private to the module.
#ifndef vtkStratusSparseBlocks_h
#define vtkStratusSparseBlocks_h

#include <cstddef>
#include <cstdint>
#include <vector>

// Cells Low..High-1 along each axis; cell i is the interval from voxel i to i+1.
struct vtkStratusCellBox {
  int64_t Low[3], High[3];
};

// Voxels of an image of the box, which has the voxels at both ends.
double vtkStratusVoxelsOf(const vtkStratusCellBox& box);

// Returns at most `most` boxes that don't overlap and cover all given boxes; none of them is empty. A box is cut in two by the plane that
// leaves the fewest voxels, starting with the box where that saves the most, until at least half of the voxels are in given boxes. `most`
// >= 1.
std::vector<vtkStratusCellBox> vtkStratusDivide(std::vector<vtkStratusCellBox> given, size_t most);

#endif
