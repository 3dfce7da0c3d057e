/* SPDX-License-Identifier: BSD-3-Clause
 * Functions on cameras that all renderers use. */
#ifndef STRATUS_CAMERA_H
#define STRATUS_CAMERA_H

#include "base.h"

/* Returns STRATUS_INVALID_ARGUMENT for a camera that defines no rays, or that gives the image's opaque depth no meaning. */
stratus_status stratus_camera_check(stratus_context* context, const stratus_camera* camera, const stratus_image* image);
/* Gives where an OpenGL window depth of 0..1 is, in units of forward. */
double stratus_camera_place(const stratus_camera* camera, double depth);
/* Gives a pixel's ray: its place at k = 0, from the eye (perspective: 0, 0, 0), and its way over one unit of k. */
void stratus_camera_ray(const stratus_camera* camera, const int sides[2], int x, int y, double from[3], double along[3]);
/* Finds the pixels [window[0], window[1]) x [window[2], window[3]) that the box [lo, hi] covers, and one more on each side. Where the box
 * reaches behind the eye, they are all of the `sides` pixels. Vectors are as in stratus_camera, in the box's coordinates. */
void stratus_camera_window(const double eye[3], const double right[3], const double up[3], const double forward[3], bool parallel,
  const double lo[3], const double hi[3], const int sides[2], int window[4]);

#endif
