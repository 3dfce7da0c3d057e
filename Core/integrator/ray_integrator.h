/* SPDX-License-Identifier: BSD-3-Clause
 * The numbers that a ray keeps, and its march: a caster's part of the state that has mode, rule and step. */
#ifndef STRATUS_RAY_INTEGRATOR_H
#define STRATUS_RAY_INTEGRATOR_H

#include "stratus/ray_cast.h"
#include "ray_cast_arguments.h"
#include "volume.h"

/* The options that decide, with the transfer function, which values matter. */
typedef struct stratus_ray_shown {
  stratus_mode mode;
  double average_range[2];
  int contour_count;
  double contours[STRATUS_CONTOURS_MAX];
} stratus_ray_shown;

/* How rays sample. It depends on values and options, never on timings, so that equal input gives an equal choice. */
typedef struct stratus_ray_choice {
  stratus_sampling sampling;
  double sample_distance; /* cells: a voxel, which is only their unit of length */
  /* Each ray's samples are as long as its way through a voxel, or through as many or such a part of one as sample_distance has of
   * stratus_ray_voxel_length(); sample_distance is then the shortest sample. */
  bool follows;
  double cell_error; /* cells, local: as in stratus_ray_cast_options */
  /* cells, local, lit: how far what a ray shows may spread about one place of light, as opacity times squared voxels
   * (kernels/integrator/lit_places.h) */
  double light_spread;
  bool provisional; /* not measured yet: stratus_ray_probe() is to replace it */
  /* The probe's results; NaN and true without a probe. */
  double expected_error;
  bool met;
} stratus_ray_choice;

/* Whether rays of a rule pass through cells, by pieces of choice.cell_error, everywhere or in rough blocks. */
static inline bool stratus_ray_visits_cells(stratus_sampling sampling)
{
  return sampling == STRATUS_SAMPLING_CELLS || sampling == STRATUS_SAMPLING_LOCAL;
}

typedef struct stratus_ray_integrator {
  stratus_ray_shown shown; /* mode and values of `values` */
  stratus_shown values;    /* the fetched values that matter; of NULL: not known yet */
  stratus_ray_choice choice;
  int keeps; /* > 0: pictures hold what rays keep (ray_kept.h), of surfaces this one of each ray, the nearest is 1 */
} stratus_ray_integrator;

#endif
