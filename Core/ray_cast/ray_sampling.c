/* SPDX-License-Identifier: BSD-3-Clause
 * Which sampling rules can draw a scene, and what the user leaves open. */
#include "ray_sampling.h"

#include "ray_caster.h"

/* Axes without extent limit the voxel length only if they are this many times shorter than the others. The limit bounds the length of a
 * sample along them. */
#define FLAT_SHORTER 1000.0

double stratus_ray_voxel_length(const stratus_volume* volume)
{
  double m[16], shortest = INFINITY, flat = INFINITY;
  stratus_volume_index_to_world(volume, m);
  for (int axis = 0; axis < 3; ++axis) {
    const double length = sqrt(m[axis] * m[axis] + m[4 + axis] * m[4 + axis] + m[8 + axis] * m[8 + axis]);
    double* least = volume->dimensions[axis] > 1 || volume->cell_centered ? &shortest : &flat;
    *least = length < *least ? length : *least;
  }
  return fmin(shortest, FLAT_SHORTER * flat);
}

bool stratus_ray_can_sample(const stratus_ray_caster* caster, const stratus_ray_cast_options* options, stratus_sampling sampling)
{
  return sampling == STRATUS_SAMPLING_MIDPOINT ||
    (options->mode == STRATUS_MODE_COMPOSITE && options->interpolation != STRATUS_INTERPOLATION_NEAREST &&
      !stratus_ray_shading_several(caster));
}

void stratus_ray_choose(const stratus_ray_caster* caster, const stratus_ray_cast_options* options, stratus_ray_choice* choice)
{
  const bool composite = stratus_ray_can_sample(caster, options, STRATUS_SAMPLING_PREINTEGRATED);
  const bool surfaces = options->mode == STRATUS_MODE_ISOSURFACE; /* these rays step from cell to cell: a voxel is only their unit */
  *choice = (stratus_ray_choice){ .sampling = options->sampling, .expected_error = NAN, .met = true };
  if (!composite) {
    choice->sampling = STRATUS_SAMPLING_MIDPOINT;
  } else if (options->sampling == STRATUS_SAMPLING_AUTO) {
    choice->sampling = STRATUS_SAMPLING_PREINTEGRATED;
  }
  const bool open_rule = composite && options->sampling == STRATUS_SAMPLING_AUTO, open_step = !(options->sample_distance > 0.0);
  choice->sample_distance = open_step || surfaces ? caster->inputs.voxel : options->sample_distance;
  choice->provisional = !surfaces && (open_rule || open_step);
}
