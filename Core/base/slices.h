/* SPDX-License-Identifier: BSD-3-Clause
 * The surface of slices as rays take it, for every renderer that has them. */
#ifndef STRATUS_SLICES_H
#define STRATUS_SLICES_H

#include "base.h"
#include "slice_arguments.h"
#include "stratus/ray_cast.h"

stratus_status stratus_slice_check(stratus_context* context, const stratus_slice* slice);
/* Sets the surface in coordinates that the affine matrix takes to the world. */
void stratus_slice_set(const stratus_slice* slice, const double to_world[16], stratus_slice_arguments* a);

#endif
