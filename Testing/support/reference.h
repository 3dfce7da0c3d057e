/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The picture that every renderer here is judged by, written apart from all of them: plain double precision, one ray at a time, small
 * midpoint steps, the transfer function evaluated point by point. It shares the public structs with the core and not a line of its code. */
#ifndef STRATUS_TESTING_REFERENCE_H
#define STRATUS_TESTING_REFERENCE_H

#include "stratus.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct reference_scene {
  const stratus_volume* volume;
  const stratus_transfer* transfer; /* of independent components: one each */
  const stratus_camera* camera;
  stratus_interpolation interpolation;
  const float* opaque_depth; /* window depths, as in stratus_image; may be NULL */
  int crop;                  /* as in stratus_ray_cast_options */
  double crop_bounds[6];
  int clip_plane_count;
  double clip_planes[STRATUS_CLIP_PLANES_MAX][4];
  const stratus_shading* shading; /* NULL: unlit */
  int dependent;                  /* as in stratus_ray_cast_options */
  const uint8_t* labels;          /* likewise: the mask, where there are labels */
  int label_count;
} reference_scene;

/* A value of whatever type as a double, which is what functions of it are defined on: by its indices, or by its number, x fastest. */
double reference_value(const stratus_volume* volume, int64_t i, int64_t j, int64_t k);
double reference_value_at(const stratus_volume* volume, int64_t number);

/* Draws into rgba (width*height*4 floats, premultiplied, bottom row first). step: length of a step in units of the shortest edge of a voxel
 * in the world, > 0. depth may be NULL: world distance from the eye (parallel: from its plane) to the first sample with opacity, INFINITY
 * where there is none. A ray stops when what is left of its light is below 1e-12. Returns 0, or -1 where memory runs out. */
int reference_render(const reference_scene* scene, int width, int height, double step, float* rgba, float* depth);

/* Halves the step, from 1/8, until two pictures in a row agree to at least wanted_db + 10 (or the step is 1/1024), and leaves the finer
 * one. reference_db: how well those two agree. */
int reference_converged(
  const reference_scene* scene, int width, int height, double wanted_db, float* rgba, float* depth, double* reference_db);

/* Peak signal to noise in dB of RGBA in 0..1 over the pixels where either picture has alpha > 0; INFINITY where they are equal. A value
 * that is not finite gives -INFINITY. */
double reference_psnr(const float* a, const float* b, size_t pixels);
/* The same in parts, for a figure over several views: adds to the sum of squares, the count of values, and raises the largest error. */
void reference_error(const float* a, const float* b, size_t pixels, double* squares, double* count, double* largest);

#ifdef __cplusplus
}
#endif
#endif
