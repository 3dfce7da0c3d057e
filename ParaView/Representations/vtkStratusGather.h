// SPDX-License-Identifier: BSD-3-Clause
// Gives each rank of ParaView the parts of boxes of AMR that its part of the picture needs. Private to the module.
#pragma once

#include "vtkSmartPointer.h"

class vtkMultiProcessController;
class vtkOverlappingAMR;

namespace stratus {

// Readers deal boxes out one by one, but a rank's part of a picture must be a box of the space, and a value between levels needs the boxes
// around. So each rank gets, with their arrays of numbers, the parts of boxes that its piece needs (vtkStratusAMRParts), and the places of
// all boxes. If the data can't be drawn, each gets all boxes. Every rank of the controller must call it; levels, origin and spacings are
// the same on all.
vtkSmartPointer<vtkOverlappingAMR> gather(vtkMultiProcessController* ranks, vtkOverlappingAMR* mine);
} // namespace stratus
