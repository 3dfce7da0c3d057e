/* SPDX-License-Identifier: BSD-3-Clause
 * Chooses how the rays of a scene sample: rule and step. */
#ifndef STRATUS_RAY_SAMPLING_H
#define STRATUS_RAY_SAMPLING_H

#include "stratus/ray_cast.h"
#include "ray_integrator.h"
#include "ray_voxels.h"

/* The inputs of a choice, except values and transfer functions. */
typedef struct stratus_ray_choice_inputs {
  double sample_distance, cell_error, light_spread, tolerance, voxel;
  stratus_sampling sampling;
  stratus_interpolation interpolation;
  int shade, mean_components, together, clips_gradients;
  double gradient_distance, gradient_length;
  stratus_material materials[4]; /* without materials of components, the first is the shading's */
  int one_sided, lights, shadows;
  double scattering, anisotropy;
} stratus_ray_choice_inputs;

/* Make the choice that holds if the user sets rule and step, or if every step gives the same image. Otherwise the choice is provisional. */
void stratus_ray_choose(const stratus_ray_caster* caster, const stratus_ray_cast_options* options, stratus_ray_choice* choice);
/* Returns the tolerance that governs: the default one where the user has set rule and step by hand. */
double stratus_ray_tolerance(const stratus_ray_cast_options* options);
/* Whether a rule can draw the scene at all. */
bool stratus_ray_can_sample(const stratus_ray_caster* caster, const stratus_ray_cast_options* options, stratus_sampling sampling);

#endif
