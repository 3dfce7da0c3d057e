/* SPDX-License-Identifier: BSD-3-Clause
 * Stratus draws uneven volumes fast and exactly. This header includes all public headers of the core. Their comments are the contract.
 *
 * Conventions
 * - Arrays of a grid are indexed a[(k*ny + j)*nx + i]: x runs fastest. Images start at the bottom left, as in OpenGL.
 * - Index coordinates put the centre of voxel (i,j,k) at (i,j,k). World coordinates are the camera's coordinates.
 * - Inputs are borrowed const views. A call reads them while it runs. It reads them later only if its comment says so.
 * - _destroy frees an object that _create made. It accepts NULL. An object uses its context until it is destroyed: destroy the context
 *   last.
 * - A call that fails returns a status and leaves its outputs unchanged. stratus_context_message() then names the value that was refused
 *   and its allowed range.
 * - Options may be NULL, which means their defaults. Any other pointer may be NULL only if a comment says so. If a required pointer is
 *   NULL, a call that returns a status returns STRATUS_INVALID_ARGUMENT. It leaves no message if there is no object to hold one. A call
 *   without a status treats a NULL object as an empty one, and writes nothing through a NULL pointer.
 * - One context serves one thread at a time. Different contexts are independent, and several threads may create contexts at once. The
 *   core's only global state is its measurements of this machine, and a lock: one thread at a time queries OpenCL's devices, because some
 *   platforms allow no more. Threads that need the same measurement wait for one another.
 * - Each calling thread and each OpenMP thread needs 128 KiB of stack on the host. An OpenCL implementation may need more. */
#ifndef STRATUS_H
#define STRATUS_H

#include "stratus/version.h"
#include "stratus/context.h"
#include "stratus/volume.h"
#include "stratus/bricks.h"
#include "stratus/calendar.h"
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
#include "stratus/quantities.h"
#include "stratus/path.h"
#include "stratus/cloud.h"
#include "stratus/color_map.h"
#include "stratus/look.h"
#include "stratus/annotation.h"
#include "stratus/globe.h"
#include "stratus/layers.h"
#include "stratus/scenes.h"

#endif
