// SPDX-License-Identifier: BSD-3-Clause
// Collective operations of ParaView's ranks, each of which has a piece of the data. Private to the module.
#pragma once

#include "vtkSmartPointer.h"
#include "vtkType.h"

#include <string>
#include <vector>

class vtkDataObject;
class vtkInformation;
class vtkMatrix4x4;
class vtkMultiProcessController;
class vtkPlaneCollection;
class vtkRenderer;

namespace stratus {

// How many ranks there are: 1 without MPI.
int count_ranks();

// This one's number, 0 without MPI.
int get_rank();

// Returns, for each count in `mine`, the sum of this count over the ranks before this one. Every rank must call it.
std::vector<vtkIdType> count_before(const std::vector<vtkIdType>& mine);

// Computes the union of all ranks' bounds, each of which may be uninitialized. Returns false, and leaves `whole`, if all are. Every rank
// of the controller must call it.
bool join_bounds(vtkMultiProcessController* controller, const double mine[6], double whole[6]);

// Returns the first rank's array that is not "", and sets whether it is of cells. Names are cut after 255 bytes. Every rank must call it.
std::string agree_on_array(vtkMultiProcessController* controller, const std::string& mine, bool& on_cells);

// Returns, on rank 0, the messages of all ranks if any message differs from its last one: a line for each rank with a message, which names
// it. last: this rank's last message, to be kept for the next call. Messages are cut after 511 bytes. Every rank must call it.
std::string join_words(vtkMultiProcessController* controller, const std::string& mine, std::string& last);

// Returns what a rank has to say: why its picture failed, else what is wrong with its part, else which device was refused, else, on rank 0,
// that shadows are left out, or that projections of several ranks don't join. mode: one of vtkVolumeMapper's blend modes; dark: whether
// shadows are left out.
std::string choose_words(vtkMultiProcessController* controller, const std::string& failed, const std::string& problem,
  const std::string& refusal, int mode, bool dark);

// Returns the fault of this rank's part, or "": that it overlaps the part of a rank behind it, or, on rank 0, that parts leave gaps. The
// bounds may be uninitialized. Every rank must call it.
std::string judge_parts(vtkMultiProcessController* controller, const double mine[6]);

// Returns planes in the faces of a rank's bounds that are not faces of all ranks' bounds; their normals point into the rank's part. matrix:
// from the bounds' coordinates to the world's.
vtkSmartPointer<vtkPlaneCollection> planes_between(const double own[6], const double whole[6], vtkMatrix4x4* matrix);

// Keeps the previous data if the new data of all ranks lack the array that is shown, as a time step may. array: its name and association,
// as an algorithm's input array; now, before: this rank's data, or nullptr; lost: whether the last call kept them, and whether this one
// does. Returns, on rank 0 and once, the message to print. Every rank must call it.
std::string keep_if_lost(vtkInformation* array, vtkSmartPointer<vtkDataObject>& now, vtkDataObject* before, bool& lost);

// Whether any visible prop of the renderer has translucent surfaces.
bool has_translucent(vtkRenderer* renderer);
} // namespace stratus
