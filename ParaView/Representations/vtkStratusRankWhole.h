// SPDX-License-Identifier: BSD-3-Clause
// Gathers the ranks' pieces of a grid on one rank. Private to the module.
//
// The step that a frame needs depends on whole rays: for a piece of the data the automatic step differs, and is often finer.
#pragma once

#include "vtkSmartPointer.h"
#include "vtkType.h"

#include <string>
#include <vector>

class vtkDataSet;
class vtkMultiProcessController;

namespace stratus {

// Gives rank 0 the whole image or rectilinear grid of which each rank has a piece, with the arrays `names` of points or cells and with
// ghost arrays. piece: this rank's, or nullptr; an empty one counts as none. `gathered`, equal on all ranks, is true if the pieces fit
// together and their arrays have at most `most` bytes; otherwise nothing is sent. The other ranks get nullptr. Every rank of the controller
// must call it.
vtkSmartPointer<vtkDataSet> gather_whole(vtkMultiProcessController* controller, vtkDataSet* piece, const std::vector<std::string>& names,
  bool cells, vtkIdType most, bool& gathered);
} // namespace stratus
