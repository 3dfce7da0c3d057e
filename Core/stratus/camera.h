/* SPDX-License-Identifier: BSD-3-Clause
 * Cameras, and the pictures that renderers fill. */
#ifndef STRATUS_PUBLIC_CAMERA_H
#define STRATUS_PUBLIC_CAMERA_H

#include "context.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A camera, which assigns one ray to each pixel. With u, v in -1..1 at the window's edges (pixel i of n has its centre at (2i+1)/n - 1),
 * the ray is, for near_k <= k <= far_k,
 *   perspective: eye + k (forward + u right + v up)      parallel: eye + u right + v up + k forward.
 * If |forward| = 1, and right and up are orthogonal to it, k is the distance from the plane through the eye. Samples lie at (n + 1/2)
 * sample distances from the eye (parallel: from its plane), n an integer. */
typedef struct stratus_camera {
  double eye[3];
  double forward[3];
  double right[3];
  double up[3];
  double near_k; /* >= 0 (parallel: any), finite. Default 0. */
  double far_k;  /* > near_k, may be INFINITY. Default INFINITY. */
  int parallel;  /* 1: parallel rays, 0: perspective. Default 0. */
} stratus_camera;

/* Makes a perspective camera. view_angle: full vertical angle, degrees in (0,180); aspect: width/height. */
STRATUS_API stratus_status stratus_camera_perspective(stratus_context* context, const double eye[3], const double focal[3],
  const double view_up[3], double view_angle, double aspect, stratus_camera* camera);
/* Makes a parallel camera. parallel_scale: half the height of the window in world units, > 0. */
STRATUS_API stratus_status stratus_camera_parallel(stratus_context* context, const double eye[3], const double focal[3],
  const double view_up[3], double parallel_scale, double aspect, stratus_camera* camera);

/* The picture that a renderer fills, and the geometry that ends its rays. The caller owns all buffers, of width*height pixels each, bottom
 * row first. */
typedef struct stratus_image {
  int width;   /* 1..65536 */
  int height;  /* 1..65536 */
  float* rgba; /* out: 4 floats for each pixel, premultiplied by alpha; 0 where nothing shows */
  /* Out, may be NULL: world distance along the ray from the eye (parallel: from its plane) to the first segment that contributes; INFINITY
   * where none does. */
  float* depth;
  uint8_t* rgba8;    /* out, may be NULL: rgba times 255, rounded to the nearest; values above 1 become 255 */
  uint32_t* samples; /* out, may be NULL: number of samples taken in the pixel */
  /* In, may be NULL: OpenGL window depth in 0..1 of opaque geometry, at which rays end. The depths lie between near_k and far_k, which both
   * must be finite. */
  const float* opaque_depth;
} stratus_image;

#ifdef __cplusplus
}
#endif

#endif
