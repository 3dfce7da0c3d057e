/* SPDX-License-Identifier: BSD-3-Clause
 * Cameras, and the pictures that renderers fill. */
#ifndef STRATUS_PUBLIC_CAMERA_H
#define STRATUS_PUBLIC_CAMERA_H

#include "context.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Rays of the picture. With u, v in -1..1 at the window's edges (pixel i of n has its centre at (2i+1)/n - 1), the
 * ray is, for near_k <= k <= far_k,
 *   perspective: eye + k (forward + u right + v up)      parallel: eye + u right + v up + k forward.
 * So with |forward| = 1 and right, up orthogonal to it, k is the distance to the eye's plane. Samples lie at (n + 1/2)
 * sample distances from the eye (parallel: from its plane), n an integer. */
typedef struct stratus_camera {
  double eye[3];
  double forward[3];
  double right[3];
  double up[3];
  double near_k; /* >= 0 (parallel: any), finite. Default 0. */
  double far_k;  /* > near_k, may be INFINITY. Default INFINITY. */
  int parallel;  /* default 0 */
} stratus_camera;

/* Perspective camera: view_angle is the full vertical angle, degrees in (0,180); aspect is width/height. */
STRATUS_API stratus_status stratus_camera_perspective(stratus_context* context, const double eye[3], const double focal[3],
  const double view_up[3], double view_angle, double aspect, stratus_camera* camera);
/* Parallel camera: parallel_scale is half the height of the window in world units, > 0. */
STRATUS_API stratus_status stratus_camera_parallel(stratus_context* context, const double eye[3], const double focal[3],
  const double view_up[3], double parallel_scale, double aspect, stratus_camera* camera);

/* The picture and what bounds it. All buffers are the caller's, width*height pixels, bottom row first. */
typedef struct stratus_image {
  int width;                 /* 1..65536 */
  int height;                /* 1..65536 */
  float* rgba;               /* out: 4 floats a pixel, premultiplied by alpha; 0 where nothing is */
  float* depth;              /* out, may be NULL: world distance along the ray from the eye (parallel: from its plane) to the first segment
                              * that contributes; INFINITY where none does */
  uint8_t* rgba8;            /* out, may be NULL: rgba in 0..255, rounded to the nearest; above 1 is 255 */
  uint32_t* samples;         /* out, may be NULL: samples taken in the pixel */
  const float* opaque_depth; /* in, may be NULL: OpenGL window depth 0..1 of opaque geometry between near_k and far_k (both
                              * finite then); rays end there */
} stratus_image;

#ifdef __cplusplus
}
#endif

#endif
