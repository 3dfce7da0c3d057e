/* SPDX-License-Identifier: BSD-3-Clause
 * Pairs the faces of a mesh on the context's OpenCL device. */
#ifndef STRATUS_ADJACENCY_DEVICE_H
#define STRATUS_ADJACENCY_DEVICE_H

#include "mesh.h"

/* Whether the device builds, the mesh has many faces, and they fit. */
bool stratus_adjacency_on_device(const stratus_context* context, const stratus_mesh* mesh);
/* Fills `neighbours` and counts broken and folded faces. `orientation` is there. */
stratus_status stratus_adjacency_pair_on_device(stratus_context* context, const stratus_mesh* mesh, stratus_adjacency* adjacency);

#endif
