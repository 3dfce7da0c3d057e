// SPDX-License-Identifier: BSD-3-Clause
// Gives each rank of ParaView the boxes of AMR that all have. Private to the module.
#pragma once

#include "vtkSmartPointer.h"

class vtkMultiProcessController;
class vtkOverlappingAMR;

namespace stratus {

// Readers deal boxes out one by one, but a rank's part of a picture must be a box of the space, and a value between levels needs the boxes
// around. So each rank gets all boxes, with their arrays of numbers. Every rank of the controller must call it; levels, origin and spacings
// are the same on all.
vtkSmartPointer<vtkOverlappingAMR> gather(vtkMultiProcessController* ranks, vtkOverlappingAMR* mine);
} // namespace stratus
