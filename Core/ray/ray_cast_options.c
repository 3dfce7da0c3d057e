/* SPDX-License-Identifier: BSD-3-Clause
 * Render options: their names and defaults. */
#include "stratus/ray_cast.h"

#include "lights.h"
#include "ray_mode.h"

const char* stratus_structure_name(stratus_structure structure)
{
  static const char* const names[] = { "auto", "none", "block", "distance", "octant", "hybrid" };
  return (unsigned)structure < sizeof names / sizeof *names ? names[structure] : "unknown";
}

const char* stratus_sampling_name(stratus_sampling sampling)
{
  static const char* const names[] = { "auto", "midpoint", "pre-integrated", "cells", "local" };
  return (unsigned)sampling < sizeof names / sizeof *names ? names[sampling] : "unknown";
}

stratus_ray_cast_options stratus_ray_cast_options_default(void)
{
  return (stratus_ray_cast_options){ .sampling.tolerance = 0.001,
    .light.shading = stratus_shading_default(),
    .optics.average_range = { -INFINITY, INFINITY },
    .clipping.crop_regions = STRATUS_CROP_INSIDE };
}

bool stratus_ray_clips_gradients(const stratus_ray_cast_options* options)
{
  return options->clipping.clip_gradients && options->clipping.clip_plane_count > 0;
}
