// SPDX-License-Identifier: BSD-3-Clause
// What ranks of ParaView, which each have a piece of the data, find out together. Private to the module.
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

// Returns, of what this rank has so many of each, how many the ranks before it have. Every rank must call it.
std::vector<vtkIdType> count_before(const std::vector<vtkIdType>& mine);

// Gives the bounds about those of all ranks, each of which may be uninitialized. Returns false, and leaves `whole`, if all are. Every rank
// of the controller must call it.
bool join_bounds(vtkMultiProcessController* controller, const double mine[6], double whole[6]);

// Returns the first rank's array that is not "", and sets whether it is of cells. Names are cut after 255 bytes. Every rank must call it.
std::string agree_on_array(vtkMultiProcessController* controller, const std::string& mine, bool& on_cells);

// Returns, on rank 0, what ranks say where any says something else than the last time: a line a rank that says anything, which names it.
// last: what this rank said, to be kept for the next call. Words are cut after 511 bytes. Every rank must call it.
std::string join_words(vtkMultiProcessController* controller, const std::string& mine, std::string& last);

// Returns what a rank has to say: why its picture failed, else what is wrong with its part, else which device was refused, else, on rank 0,
// that projections of several ranks don't join. mode: one of vtkVolumeMapper's blend modes.
std::string choose_words(
  vtkMultiProcessController* controller, const std::string& failed, const std::string& problem, const std::string& refusal, int mode);

// Returns what is wrong with this rank's part among those of all, whose bounds may be uninitialized: that it overlaps the part of a rank
// behind it, or, on rank 0, that parts leave gaps. Every rank must call it.
std::string judge_parts(vtkMultiProcessController* controller, const double mine[6]);

// Returns planes in the faces of a rank's bounds that are not faces of all ranks' bounds; their normals point into the rank's part. matrix:
// from the bounds' coordinates to the world's.
vtkSmartPointer<vtkPlaneCollection> planes_between(const double own[6], const double whole[6], vtkMatrix4x4* matrix);

// Keeps the data of before where the new ones of all ranks lack the array that is shown, as a step in time may. array: its name and
// association, as an algorithm is told them; now, before: this rank's data, or nullptr; lost: whether the last call kept them, and whether
// this one does. Returns, on rank 0 and once, what is to be said. Every rank must call it.
std::string keep_if_lost(vtkInformation* array, vtkSmartPointer<vtkDataObject>& now, vtkDataObject* before, bool& lost);

// Whether any visible prop of the renderer has translucent surfaces.
bool has_translucent(vtkRenderer* renderer);
} // namespace stratus
