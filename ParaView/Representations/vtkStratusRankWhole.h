// SPDX-License-Identifier: BSD-3-Clause
// Puts the pieces of a grid that ranks have together on one of them. Private to the module.
//
// Which step a picture needs shows along whole rays: pieces alone ask for other steps than the whole, and often for finer ones.
#pragma once

#include "vtkSmartPointer.h"
#include "vtkType.h"

#include <string>
#include <vector>

class vtkDataSet;
class vtkMultiProcessController;

namespace stratus {

// Gives rank 0 the image or rectilinear grid of which each rank has a piece, with the arrays `names` of points or cells and with what is
// hidden. piece: this rank's, or nullptr; an empty one counts as none. `gathered` tells, on all ranks alike, whether the pieces fit
// together and their arrays have `most` bytes at most; else nothing is sent. The other ranks get nullptr. Every rank of the controller must
// call it.
vtkSmartPointer<vtkDataSet> gather_whole(vtkMultiProcessController* controller, vtkDataSet* piece, const std::vector<std::string>& names,
  bool cells, vtkIdType most, bool& gathered);
} // namespace stratus
