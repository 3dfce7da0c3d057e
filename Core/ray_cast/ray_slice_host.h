/* SPDX-License-Identifier: BSD-3-Clause
 * Slices: the surface, by index coordinates. */
#ifndef STRATUS_RAY_SLICE_HOST_H
#define STRATUS_RAY_SLICE_HOST_H

#include "stratus/ray_cast.h"
#include "ray_cast_arguments.h"

stratus_status stratus_ray_slice_check(stratus_context* context, const stratus_slice* slice);
/* Sets the surface; in modes other than slice, nothing. */
void stratus_ray_slice_arguments_of(
  const stratus_volume* volume, const stratus_ray_cast_options* options, stratus_ray_cast_arguments* arguments);

#endif
