/* SPDX-License-Identifier: BSD-3-Clause
 * Chooses how the rays of a scene sample: rule and step. */
#ifndef STRATUS_RAY_SAMPLING_H
#define STRATUS_RAY_SAMPLING_H

#include "stratus/ray_cast.h"
#include "volume.h"

/* How rays sample. It depends on values and options, never on timings, so that equal input gives an equal choice. */
typedef struct stratus_ray_choice {
  stratus_sampling sampling;
  double sample_distance; /* cells: a voxel, which is only their unit of length */
  /* Each ray's samples are as long as its way through a voxel, or through as many or such a part of one as sample_distance has of
   * stratus_ray_voxel_length(); sample_distance is then the shortest sample. */
  bool follows;
  double cell_error; /* cells, local: as in stratus_ray_cast_options */
  /* cells, local, lit: how far what a ray shows may spread about one place of light, as opacity times squared voxels
   * (kernels/ray_cast/lit_places.h) */
  double light_spread;
  bool provisional; /* not measured yet: stratus_ray_probe() is to replace it */
  /* The probe's results; NaN and true without a probe. */
  double expected_error;
  bool met;
} stratus_ray_choice;

/* The inputs of a choice, except values and transfer functions. */
typedef struct stratus_ray_choice_inputs {
  double sample_distance, cell_error, light_spread, tolerance, voxel;
  stratus_sampling sampling;
  stratus_interpolation interpolation;
  int shade, mean_components, together, clips_gradients;
  double gradient_distance, gradient_length;
  stratus_material materials[4];
} stratus_ray_choice_inputs;

/* Make the choice that holds if the user sets rule and step, or if every step gives the same image. Otherwise the choice is provisional. */
void stratus_ray_choose(const stratus_ray_caster* caster, const stratus_ray_cast_options* options, stratus_ray_choice* choice);
/* Returns the tolerance that governs: the default one where the user has set rule and step by hand. */
double stratus_ray_tolerance(const stratus_ray_cast_options* options);
/* Whether rays of a rule pass through cells, by pieces of choice.cell_error, everywhere or in rough blocks. */
static inline bool stratus_ray_visits_cells(stratus_sampling sampling)
{
  return sampling == STRATUS_SAMPLING_CELLS || sampling == STRATUS_SAMPLING_LOCAL;
}
/* Whether gradients take clipped_value in place of values that clip planes hide. */
bool stratus_ray_clips_gradients(const stratus_ray_cast_options* options);
/* Whether rays of the choice take light at places of their own. */
bool stratus_ray_lights_places(const stratus_ray_caster* caster);
/* Whether a rule can draw the scene at all. */
bool stratus_ray_can_sample(const stratus_ray_caster* caster, const stratus_ray_cast_options* options, stratus_sampling sampling);
/* Returns the world length of a voxel's shortest edge, among the axes along which the volume extends; less where that would cross a
 * thousand layers of voxels. */
double stratus_ray_voxel_length(const stratus_volume* volume);
/* Whether automatic samples follow each ray's way through the voxels. */
bool stratus_ray_follows_voxels(const stratus_volume* volume);
/* Gives, for samples that follow the voxels and are at least sample_distance long, how many of them a ray takes in passing a voxel along
 * each axis; along an axis without extent a thousandth of that. */
void stratus_ray_samples_a_voxel(const stratus_volume* volume, double sample_distance, double samples[3]);

#endif
