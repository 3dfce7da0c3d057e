// SPDX-License-Identifier: BSD-3-Clause
// What ranks of ParaView, which each have a piece of the data, find out together. Private to the module.
#pragma once

class vtkMultiProcessController;

namespace stratus {

// How many ranks there are: 1 without MPI.
int count_ranks();

// Gives the bounds about those of all ranks, each of which may be uninitialized. Returns false, and leaves `whole`, if all are. Every rank
// of the controller must call it.
bool join_bounds(vtkMultiProcessController* controller, const double mine[6], double whole[6]);
} // namespace stratus
