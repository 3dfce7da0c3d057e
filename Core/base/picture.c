/* SPDX-License-Identifier: BSD-3-Clause
 * Checks, clears and adds the pictures that renderers fill. */
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

void stratus_image_part_destroy(stratus_context* context, stratus_image* part)
{
  stratus_release(context, part->rgba);
  stratus_release(context, part->depth);
  stratus_release(context, part->samples);
  part->rgba = part->depth = NULL;
  part->samples = NULL;
}

stratus_status stratus_image_part_create(stratus_context* context, const stratus_image* image, stratus_image* part)
{
  const size_t pixels = (size_t)image->width * (size_t)image->height;
  stratus_status status;
  void* memory = NULL;
  *part = *image;
  part->rgba = part->depth = NULL;
  part->samples = NULL;
  part->rgba8 = NULL;
  TRY_CLEANUP(stratus_allocate(context, pixels, 4 * sizeof(float), &memory));
  part->rgba = memory;
  if (image->depth) {
    TRY_CLEANUP(stratus_allocate(context, pixels, sizeof(float), &memory));
    part->depth = memory;
  }
  if (image->samples) {
    TRY_CLEANUP(stratus_allocate(context, pixels, sizeof(uint32_t), &memory));
    part->samples = memory;
  }
  return STRATUS_OK;
cleanup:
  stratus_image_part_destroy(context, part);
  return status;
}

void stratus_image_add(const stratus_image* sum, const stratus_image* part, float weight, bool opaque)
{
  const size_t pixels = (size_t)sum->width * (size_t)sum->height;
  for (size_t i = 0; i < pixels; ++i) {
    stratus_pixel_add(sum->rgba + 4 * i, part->rgba + 4 * i, weight, opaque);
    if (sum->depth) {
      sum->depth[i] = fminf(sum->depth[i], part->depth[i]);
    }
    if (sum->samples) {
      sum->samples[i] += part->samples[i];
    }
  }
}

void stratus_image_fill_bytes(const stratus_image* image)
{
  const size_t values = 4 * (size_t)image->width * (size_t)image->height;
  for (size_t i = 0; image->rgba8 && i < values; ++i) {
    image->rgba8[i] = stratus_image_byte(image->rgba[i]);
  }
}

void stratus_window_join(int window[4], const int other[4])
{
  if (other[0] >= other[1] || other[2] >= other[3]) {
    return;
  }
  const bool none = window[0] >= window[1] || window[2] >= window[3];
  for (int side = 0; side < 4; ++side) {
    const bool farther = side % 2 ? other[side] > window[side] : other[side] < window[side];
    window[side] = none || farther ? other[side] : window[side];
  }
}
