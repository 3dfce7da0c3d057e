/* SPDX-License-Identifier: BSD-3-Clause
 * Pictures that a renderer is given to fill. */
#ifndef STRATUS_IMAGE_H
#define STRATUS_IMAGE_H

#include "base.h"

/* Whether there is one, of sides that are allowed. */
stratus_status stratus_image_check(stratus_context* context, const stratus_image* image);
/* Nothing there, nothing hit, nothing counted. */
void stratus_image_clear(const stratus_image* image);

#endif
