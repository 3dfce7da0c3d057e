// SPDX-License-Identifier: BSD-3-Clause
// Deals cells out to the ranks that draw them. Private to the module.
//
// ParaView's own redistribution gives a rank the cells that reach into its box, with points numbered anew and composite data lost. Light
// needs more: the gradient at a point is a mean over all cells about it. And tetrahedra need points in one order on all ranks, because a
// cell is divided from the point with the lowest number on.
#pragma once

#include "vtkSmartPointer.h"

#include <string>
#include <vector>

class vtkBoundingBox;
class vtkDataObject;
class vtkMultiProcessController;
class vtkUnstructuredGrid;

namespace stratus {

struct Dealing {
  std::vector<std::string> names; // of the arrays that come along; blocks that lack any of them are left out
  bool cells = false;             // they are arrays of cells, not of points
  int layers = 0;                 // of further cells, each about the points of those before
};

// Returns the cells that reach into this rank's box, and layers of cells about their points. mine: this rank's data, a data set or a tree
// of them. Cells that are hidden, or that other ranks own, are left out. Points of equal coordinates and values are merged, in an order
// that depends only on the data. problem: why a block of this rank is left out, or "". Every rank of the controller must call it.
vtkSmartPointer<vtkUnstructuredGrid> deal_cells(vtkMultiProcessController* controller, vtkDataObject* mine,
  const std::vector<vtkBoundingBox>& boxes, const Dealing& dealing, std::string& problem);
} // namespace stratus
