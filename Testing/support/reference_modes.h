/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The reference for the ray cast's modes other than composite: double precision, one ray at a time, slow and plain. It shares the public
 * structs with the core, but none of its code. */
#ifndef STRATUS_TESTING_REFERENCE_MODES_H
#define STRATUS_TESTING_REFERENCE_MODES_H

#include "stratus.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Draws options->mode, except first hits. It obeys these options: interpolation, average_range, contours, crop (bounds and regions), mask,
 * dependent and, for slices of several components, mean_components. step: length of a step in the world. Isosurfaces take no steps: each
 * cell on a ray is cut into 64 parts, and sign changes are found by bisection. rgba: premultiplied, bottom row first. depth: world distance
 * to the first contribution, INFINITY if there is none; extremes: to the extreme value. */
void reference_modes_render(const stratus_volume* volume, const stratus_transfer* transfer, const stratus_camera* camera,
  const stratus_ray_cast_options* options, int width, int height, double step, float* rgba, float* depth);

/* A surface on a ray: world distance, colour and opacity. */
typedef struct reference_layer {
  double t, color[4];
} reference_layer;

/* Finds the surfaces on each pixel's ray, in modes isosurface and slice, from the nearest on. layers: room for `most` a pixel. counts: how
 * many a pixel has. */
void reference_modes_layers(const stratus_volume* volume, const stratus_transfer* transfer, const stratus_camera* camera,
  const stratus_ray_cast_options* options, int width, int height, int most, reference_layer* layers, int* counts);

#ifdef __cplusplus
}
#endif
#endif
