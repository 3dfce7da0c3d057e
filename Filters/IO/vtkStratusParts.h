// SPDX-License-Identifier: BSD-3-Clause
// Parts of structured grids, which ranks and filters request: their extents, their values, and the flags of cells and points that belong to
// another rank's part. Private to the module.
#ifndef vtkStratusParts_h
#define vtkStratusParts_h

#include "vtkStratusPrivate.h"

#include <array>
#include <cstdint>

class vtkDataSet;
class vtkInformation;

// A box of a grid's points or cells, from the grid's first.
struct vtkStratusBox {
  std::array<int64_t, 3> Low, Size;
};

// Finds the part of the whole extent that a pipeline's information requests: `part` with the layers of ghost cells, `owned` without.
// Returns false if the request is empty.
VTK_STRATUS_PRIVATE bool vtkStratusFindPart(vtkInformation* request, const int whole[6], int part[6], int owned[6]);

// Returns the points or cells of a part.
VTK_STRATUS_PRIVATE vtkStratusBox vtkStratusBoxOf(const int whole[6], const int part[6], bool cells);

// Cuts a part out of an image or a grid that has the whole extent. Arrays with another number of values than the whole's are the part's
// already.
VTK_STRATUS_PRIVATE void vtkStratusCutGrid(vtkDataSet* grid, const int whole[6], const int part[6]);

// Gives an image or a grid the flags that say which of its points and cells are not in `owned`, as VTK gives them to a source that gives
// parts. in_bricks: the flags are computed when something looks at them, and take no memory until then.
VTK_STRATUS_PRIVATE void vtkStratusFlagDuplicates(vtkDataSet* grid, const int owned[6], bool in_bricks);

#endif
