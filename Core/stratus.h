/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Stratus: uneven volumes drawn fast and exactly. This header includes all public headers of the core, whose comments are the contract.
 *
 * Conventions
 * - Arrays of a grid are indexed a[(k*ny + j)*nx + i]: x runs fastest. Images start at the bottom left, as in OpenGL.
 * - "Index coordinates" put the centre of voxel (i,j,k) at (i,j,k). "World" coordinates are those of the camera.
 * - Inputs are borrowed const views. A call reads them while it runs, and not later unless its comment says so.
 * - _destroy frees an object that _create made, and takes NULL. An object uses its context until it is destroyed: destroy the context last.
 * - A call that fails returns a status, leaves its outputs unchanged, and leaves a sentence in stratus_context_message() with the value and
 *   the allowed range.
 * - Options may be NULL and then have their defaults. Any other pointer may be NULL only where a comment says so. Otherwise a call that
 *   returns a status refuses NULL with STRATUS_INVALID_ARGUMENT, without a message if no object is there to hold one. A call without
 *   a status treats an object that is NULL as an empty one, and writes to no address that is NULL.
 * - One context serves one thread at a time. Different contexts are independent, and several threads may create theirs at once. The core's
 *   only global state is what was measured of this machine, and a lock: a single thread at a time asks OpenCL for its devices, since some
 *   platforms allow no more. Threads wait for one another where the same is measured.
 * - Each calling thread, and each OpenMP thread, needs 128 KiB of stack on the host. An OpenCL implementation may need more.
 */
#ifndef STRATUS_H
#define STRATUS_H

#include "stratus/version.h"
#include "stratus/context.h"
#include "stratus/volume.h"
#include "stratus/camera.h"
#include "stratus/skipping.h"
#include "stratus/voxels.h"
#include "stratus/distance_field.h"
#include "stratus/tree.h"
#include "stratus/ray_cast.h"
#include "stratus/octree.h"
#include "stratus/mesh.h"
#include "stratus/visibility.h"
#include "stratus/tetrahedra.h"
#include "stratus/scenes.h"

#endif
