/* SPDX-License-Identifier: BSD-3-Clause
 * Pictures that renderers fill. */
#ifndef STRATUS_PICTURE_H
#define STRATUS_PICTURE_H

#include "base.h"

/* Checks that the image and its colours exist, and that its sides are within limits. */
stratus_status stratus_image_check(stratus_context* context, const stratus_image* image);
/* Sets all pixels to transparent, their depth to INFINITY and their samples to 0. */
void stratus_image_clear(const stratus_image* image);

#endif
