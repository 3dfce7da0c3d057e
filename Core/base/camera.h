/* SPDX-License-Identifier: BSD-3-Clause
 * What every renderer asks of a camera. */
#ifndef STRATUS_CAMERA_H
#define STRATUS_CAMERA_H

#include "base.h"

/* STRATUS_INVALID_ARGUMENT for a camera that no ray can be made of, or that the image's opaque depth cannot be read with. */
stratus_status stratus_camera_check(stratus_context* context, const stratus_camera* camera, const stratus_image* image);
/* Pixels [window[0], window[1]) x [window[2], window[3]) that the box [lo, hi] covers, and one more on each side; all of the `sides` pixels
 * where the box reaches behind the eye. Vectors as in stratus_camera, in the box's coordinates. */
void stratus_camera_window(const double eye[3], const double right[3], const double up[3], const double forward[3], bool parallel,
  const double lo[3], const double hi[3], const int sides[2], int window[4]);

#endif
