/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Pictures of the ray cast's other modes, written apart from it: double precision, one ray at a time, as slow and plain as that can be. It
 * shares the public structs with the core and not a line of its code. */
#ifndef STRATUS_TESTING_REFERENCE_MODES_H
#define STRATUS_TESTING_REFERENCE_MODES_H

#include "stratus.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Draws what options->mode asks for, but first hits; of the options count: interpolation, average_range, contours, crop (bounds and
 * regions) and mask. step: length of a step, world. Isosurfaces don't step: each cell on a ray's way is cut into 64 parts, and sign changes
 * are halved. rgba: premultiplied, bottom row first. depth: world distance to the first contribution, INFINITY where there is none;
 * extremes: to the extreme value. */
void reference_modes_render(const stratus_volume* volume, const stratus_transfer* transfer, const stratus_camera* camera,
  const stratus_ray_cast_options* options, int width, int height, double step, float* rgba, float* depth);

#ifdef __cplusplus
}
#endif
#endif
