/* SPDX-License-Identifier: BSD-3-Clause
 * Sampling rule, sample distance and structure of a scene. */
#ifndef STRATUS_RAY_SAMPLING_H
#define STRATUS_RAY_SAMPLING_H

#include "stratus/ray_cast.h"
#include "volume.h"

/* What the scene asks for, decided from counts alone, so that the same input always gets the same answer. */
typedef struct stratus_ray_choice {
  stratus_sampling sampling;
  stratus_structure structure;
  double sample_distance;
  double bend;      /* how far the opacity is from linear over a sample, relative to the opacity */
  double sharpness; /* mean change of opacity over a voxel, where something shows */
} stratus_ray_choice;

void stratus_ray_choose(const stratus_value_range* ranges, double voxel, const stratus_transfer* transfer,
  stratus_interpolation interpolation, stratus_sampling sampling, double sample_distance, stratus_ray_choice* choice);
double stratus_ray_voxel_length(const stratus_volume* volume); /* shortest edge of a voxel along which the volume extends, world */

#endif
