/* SPDX-License-Identifier: BSD-3-Clause
 * Several volumes as one medium, by the reference renderer: at every place along a ray optical depths and emitted light of all volumes add
 * up. */
#ifndef STRATUS_TESTING_REFERENCE_SEVERAL_H
#define STRATUS_TESTING_REFERENCE_SEVERAL_H

#include "reference.h"

#ifdef __cplusplus
extern "C" {
#endif

#define REFERENCE_SEVERAL_MAX 8

/* Draws 1..8 scenes, all from the camera and with the opaque depth of the first, as reference_render() does, in midpoint steps between the
 * places where a ray enters or leaves a volume. step: the largest, in units of the shortest voxel edge of all volumes, > 0. */
int reference_render_several(const reference_scene* scenes, int count, int width, int height, double step, float* rgba, float* depth);

/* As reference_converged(), from a step of 1/4 on to 1/512. */
int reference_converged_several(
  const reference_scene* scenes, int count, int width, int height, double wanted_db, float* rgba, float* depth, double* reference_db);

#ifdef __cplusplus
}
#endif
#endif
