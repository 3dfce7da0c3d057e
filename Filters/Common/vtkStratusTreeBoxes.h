// SPDX-License-Identifier: BSD-3-Clause
// Draws the boxes of a tree's nodes. Private to the module.
#ifndef vtkStratusTreeBoxes_h
#define vtkStratusTreeBoxes_h

#include "vtkStratusInput.h"

class vtkPolyData;

// `cells`: the tree's voxels are cells between values; otherwise they are unit cubes about values. World coordinates are the image's,
// without a prop's matrix.
VTK_STRATUS_PRIVATE void vtkStratusTreeBoxes(const stratus_tree* tree, const stratus_volume& volume, bool cells, vtkPolyData* output);

#endif
