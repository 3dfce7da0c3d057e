// SPDX-License-Identifier: BSD-3-Clause
// The boxes of a tree's nodes, to look at. Private to the module.
#ifndef vtkStratusTreeBoxes_h
#define vtkStratusTreeBoxes_h

#include "vtkStratusInput.h"

class vtkPolyData;

// cells: voxels of the tree are cells between values, else cubes about values. World is the image's: no matrix of a prop.
VTK_STRATUS_PRIVATE void vtkStratusTreeBoxes(const stratus_tree* tree, const stratus_volume& volume, bool cells, vtkPolyData* output);

#endif
