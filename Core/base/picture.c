/* SPDX-License-Identifier: BSD-3-Clause
 * Checks and clears the pictures that renderers fill. */
#include "picture.h"

#include <string.h>

#define SIDE_MOST 65536

stratus_status stratus_image_check(stratus_context* context, const stratus_image* image)
{
  if (!image || !image->rgba) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "image%s is NULL", image ? "'s rgba buffer" : "");
  }
  if (image->width < 1 || image->width > SIDE_MOST || image->height < 1 || image->height > SIDE_MOST) {
    return stratus_fail(
      context, STRATUS_INVALID_ARGUMENT, "image of %d x %d pixels, each side must be 1..%d", image->width, image->height, SIDE_MOST);
  }
  return STRATUS_OK;
}

void stratus_image_clear(const stratus_image* image)
{
  const size_t pixels = (size_t)image->width * (size_t)image->height;
  memset(image->rgba, 0, pixels * 4 * sizeof *image->rgba);
  for (size_t i = 0; image->depth && i < pixels; ++i) {
    image->depth[i] = INFINITY;
  }
  if (image->samples) {
    memset(image->samples, 0, pixels * sizeof *image->samples);
  }
  if (image->rgba8) {
    memset(image->rgba8, 0, pixels * 4);
  }
}
