/* SPDX-License-Identifier: BSD-3-Clause
 * Pictures that renderers fill. */
#ifndef STRATUS_PICTURE_H
#define STRATUS_PICTURE_H

#include "base.h"

#include <math.h>
#include <stdbool.h>

/* Checks that the image and its colours exist, and that its sides are within limits. */
stratus_status stratus_image_check(stratus_context* context, const stratus_image* image);
/* Sets all pixels to transparent, their depth to INFINITY and their samples to 0. */
void stratus_image_clear(const stratus_image* image);

/* Pictures of parts, which are drawn one after the other and added. */
/* Makes room for a part of the image: colours in float and, where the image has them, depth and samples. */
stratus_status stratus_image_part_create(stratus_context* context, const stratus_image* image, stratus_image* part);
void stratus_image_part_destroy(stratus_context* context, stratus_image* part);
/* Add a part's premultiplied colours times weight, up to 1. Its alpha is added in the same way; if images are opaque, the larger alpha
 * stays. The nearer depth stays. Samples add up. The sum's bytes are unchanged. */
void stratus_image_add(const stratus_image* sum, const stratus_image* part, float weight, bool opaque);
/* Adds one pixel in the same way, but for depth and samples. */
static inline void stratus_pixel_add(float sum[4], const float part[4], float weight, bool opaque)
{
  for (int c = 0; c < 3; ++c) {
    sum[c] = fminf(sum[c] + weight * part[c], 1.0f);
  }
  sum[3] = opaque ? fmaxf(sum[3], part[3]) : fminf(sum[3] + weight * part[3], 1.0f);
}
/* Rounds a colour, which is never negative, to a byte; those above 1 become 255. */
static inline uint8_t stratus_image_byte(float color)
{
  const float value = color * 255.0f + 0.5f;
  return (uint8_t)(int)(value < 255.0f ? value : 255.0f);
}
/* Sets the bytes, if there are any, from the colours in float. */
void stratus_image_fill_bytes(const stratus_image* image);
/* Widens a window of pixels, x0, x1, y0, y1, by another; either may be empty. */
void stratus_window_join(int window[4], const int other[4]);

#endif
