/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The reference renderer, against which tests compare all others. It works in plain double precision, one ray at a time. In a cell the
 * field along a ray is a cubic, which is cut where it crosses a point of the transfer function, so that vertical steps cost no accuracy.
 * With shading or several components it takes small midpoint steps instead. It shares the public structs with the core, but none of its
 * code. */
#ifndef STRATUS_TESTING_REFERENCE_H
#define STRATUS_TESTING_REFERENCE_H

#include "stratus.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct reference_scene {
  const stratus_volume* volume;
  const stratus_transfer* transfer; /* one for each independent component or label */
  const stratus_camera* camera;
  stratus_interpolation interpolation;
  const float* opaque_depth; /* window depths, as in stratus_image; may be NULL */
  int crop;                  /* as in stratus_ray_cast_options */
  double crop_bounds[6];
  uint32_t crop_regions; /* as in stratus_ray_cast_options; 0: the inside. Several volumes only */
  int clip_plane_count;
  double clip_planes[STRATUS_CLIP_PLANES_MAX][4];
  const stratus_shading* shading;    /* NULL: unlit, unless materials say otherwise */
  const stratus_material* materials; /* as in stratus_ray_cast_options; shading has the lights */
  int dependent;                     /* as in stratus_ray_cast_options, as the next two */
  int mean_components;
  double gradient_distance;
  const stratus_transfer_2d* transfer_2d; /* as in stratus_ray_cast_options; `transfer` then stays unread, but for its unit_distance */
  int clip_gradients;                     /* as in stratus_ray_cast_options, as the next */
  double clipped_value;
  const uint8_t* labels; /* the mask as in stratus_ray_cast_options, if there are labels */
  int label_count;
  int tile; /* n > 1: only one pixel of each n x n is drawn, see reference_picks(); the others stay transparent */
} reference_scene;

/* Whether a pixel is drawn: one in each tile, at a place that differs from tile to tile, so that no pattern of a picture hides from them.
 */
int reference_picks(int tile, int x, int y);

/* Returns a value of any type as a double, by its indices or by its number (x fastest). Transfer functions are defined on doubles. */
double reference_value(const stratus_volume* volume, int64_t i, int64_t j, int64_t k);
double reference_value_at(const stratus_volume* volume, int64_t number);

/* Draws into rgba (width*height*4 floats, premultiplied, bottom row first). step > 0: largest length of a step, or of a piece of
 * quadrature, in units of a voxel's shortest edge in the world. depth may be NULL: world distance from the eye (parallel: from its plane)
 * to the first opacity, INFINITY where there is none. A ray stops when its transparency falls below 1e-12. Returns 0, or -1 if memory runs
 * out. */
int reference_render(const reference_scene* scene, int width, int height, double step, float* rgba, float* depth);

/* Halves the step, from 1 (with shading: 1/8), until two successive pictures agree to at least wanted_db + 10 or the step is 1/1024, and
 * returns the finer one. *reference_db: the agreement of these two. */
int reference_converged(
  const reference_scene* scene, int width, int height, double wanted_db, float* rgba, float* depth, double* reference_db);

/* Peak signal to noise in dB of RGBA in 0..1 over the pixels where either picture has alpha > 0; INFINITY where they are equal. A value
 * that is not finite gives -INFINITY. */
double reference_psnr(const float* a, const float* b, size_t pixels);
/* Accumulates the error of one of several pictures: adds to the sum of squares and the count of values, and raises the largest error. */
void reference_error(const float* a, const float* b, size_t pixels, double* squares, double* count, double* largest);

#ifdef __cplusplus
}
#endif
#endif
