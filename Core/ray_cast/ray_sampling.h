/* SPDX-License-Identifier: BSD-3-Clause
 * Chooses the sampling rule and sample distance of a scene. */
#ifndef STRATUS_RAY_SAMPLING_H
#define STRATUS_RAY_SAMPLING_H

#include "stratus/ray_cast.h"
#include "volume.h"

/* The choice for a scene. It depends on values and options, never on timings, so that equal input gives an equal choice. */
typedef struct stratus_ray_choice {
  stratus_sampling sampling;
  double sample_distance;
  double bend;      /* distance of the opacity from linear over a voxel, relative to the opacity */
  double sharpness; /* mean change of opacity over a voxel, in blocks that show something */
} stratus_ray_choice;

void stratus_ray_choose(const stratus_value_range* ranges, double voxel, const stratus_transfer* transfer,
  stratus_interpolation interpolation, stratus_sampling sampling, double sample_distance, stratus_ray_choice* choice);
double stratus_ray_voxel_length(
  const stratus_volume* volume); /* world length of a voxel's shortest edge, among the axes along which the volume extends */

#endif
