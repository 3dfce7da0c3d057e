/* SPDX-License-Identifier: BSD-3-Clause
 * Cameras, and the images that renderers fill. */
#ifndef STRATUS_PUBLIC_CAMERA_H
#define STRATUS_PUBLIC_CAMERA_H

#include "context.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A camera. It assigns one ray to each pixel. u and v are -1..1 at the window's edges: pixel i of n has its centre at (2i+1)/n - 1. For
 * near_k <= k <= far_k the ray is
 *   perspective: eye + k (forward + u right + v up)      parallel: eye + u right + v up + k forward.
 * If |forward| = 1 and right and up are orthogonal to it, then k is the distance from the plane through the eye. Samples are at (n + 1/2)
 * sample distances from the eye (parallel: from its plane), where n is an integer.
 *
 * Renderers refuse numbers that are not finite, a forward vector with a squared length outside 1e-30..1e30, and a perspective camera whose
 * three vectors are in one plane. */
typedef struct stratus_camera {
  /* Position, world coordinates. */
  double eye[3];
  double forward[3];
  double right[3];
  double up[3];
  double near_k; /* Start of the rays, in units of forward; >= 0 (parallel: any), finite. Default 0. */
  double far_k;  /* End of the rays, in units of forward; > near_k, may be INFINITY. Default INFINITY. */
  int parallel;  /* 1: parallel rays, 0: perspective. Default 0. */
} stratus_camera;

/* Make a perspective camera.
 * - eye, focal: positions in the world, finite, different. The camera looks from eye to focal.
 * - view_up: direction that points up in the image, of any length > 0, not parallel to the view direction.
 * - view_angle: full vertical angle in degrees, 0..180, ends excluded.
 * - aspect: width/height of the image, > 0, finite.
 * - camera: receives the camera, with near_k 0 and far_k INFINITY.
 *
 * Returns STRATUS_INVALID_ARGUMENT for values outside these ranges. */
STRATUS_API stratus_status stratus_camera_perspective(stratus_context* context, const double eye[3], const double focal[3],
  const double view_up[3], double view_angle, double aspect, stratus_camera* camera);
/* Make a parallel camera. parallel_scale: half the height of the window in world units, > 0, finite. The other parameters and refusals are
 * as in stratus_camera_perspective(). */
STRATUS_API stratus_status stratus_camera_parallel(stratus_context* context, const double eye[3], const double focal[3],
  const double view_up[3], double parallel_scale, double aspect, stratus_camera* camera);

/* Make a camera that sees a whole box, as large as fits into the image with a border of 1/20.
 * - bounds: xmin, xmax, ymin, ymax, zmin, zmax, finite, of a box with a diagonal > 0, such as of stratus_volume_bounds().
 * - up_axis: 0..2, the axis that points up in the image.
 * - azimuth: degrees about up_axis, from the axis after it (x for z) towards the one after that. elevation: degrees above the horizon,
 *   -89..89. The eye is in this direction.
 * - view_angle: as in stratus_camera_perspective(); 0: parallel rays. aspect: as there.
 *
 * Returns STRATUS_INVALID_ARGUMENT for values outside these ranges. */
STRATUS_API stratus_status stratus_camera_frame(stratus_context* context, const double bounds[6], int up_axis, double azimuth,
  double elevation, double view_angle, double aspect, stratus_camera* camera);

/* The image that a renderer fills, and the geometry that ends its rays. The caller owns all buffers. Each has width*height pixels, bottom
 * row first. */
typedef struct stratus_image {
  int width;   /* 1..65536 */
  int height;  /* 1..65536 */
  float* rgba; /* out: 4 floats for each pixel, premultiplied by alpha; 0 where nothing shows */
  /* Out, may be NULL: world distance along the ray from the eye (parallel: from its plane) to the first segment that contributes. INFINITY
   * if none does. */
  float* depth;
  uint8_t* rgba8;    /* out, may be NULL: rgba times 255, rounded to the nearest; values above 1 become 255 */
  uint32_t* samples; /* out, may be NULL: number of samples taken in the pixel */
  /* In, may be NULL: OpenGL window depth of opaque geometry, 0..1. Rays end there. 0 is near_k and 1 is far_k: far_k must be finite, and
   * near_k of a perspective camera > 0. */
  const float* opaque_depth;
} stratus_image;

/* Write an image's rgba8, or its rgba if rgba8 is NULL, as a PNG file of 8 bits. A file of that name stays as it was
 * until the new one is whole (PATH.part).
 * - background: red, green and blue, 0..1, under the image. NULL: the file has transparency.
 *
 * Returns STRATUS_INVALID_ARGUMENT without pixels or a path, STRATUS_FILE_ERROR with the system's words, and STRATUS_UNSUPPORTED where
 * the core was built without zlib. */
STRATUS_API stratus_status stratus_image_write(
  stratus_context* context, const stratus_image* image, const double background[3], const char* path);

#ifdef __cplusplus
}
#endif

#endif
