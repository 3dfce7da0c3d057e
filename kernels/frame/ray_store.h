/* SPDX-License-Identifier: BSD-3-Clause
 * Stores rays as pixels of a device's picture. */
#ifndef STRATUS_RAY_STORE_H
#define STRATUS_RAY_STORE_H

#include "ray_packet.h"

typedef struct stratus_pixels {
  __global float* rgba;
  __global uchar* rgba8;
  __global float* depth;
  __global uint* samples;
} stratus_pixels;

static void store_pixel(
  __constant stratus_ray_cast_arguments* a, const stratus_pixels* to, int x, int y, float4 color, float far, uint taken)
{
  if (x < a->picture.width && y < a->picture.height) {
    const size_t pixel = (size_t)y * (size_t)a->picture.width + (size_t)x;
    vstore4(color, pixel, to->rgba);
    if (a->picture.want_bytes) {
      const float4 bytes = color * 255.0f + 0.5f;
      vstore4(convert_uchar4(min(bytes, 255.0f)), pixel, to->rgba8);
    }
    if (a->picture.want_depth) {
      to->depth[pixel] = far >= LARGEST_FLOAT ? INFINITY : far;
    }
    if (a->picture.want_samples) {
      to->samples[pixel] = taken;
    }
  }
}

#if STRATUS_WIDTH > 1
/* Four pixels of a row. */
static void store_four(__constant stratus_ray_cast_arguments* a, const stratus_pixels* to, size_t pixel, float4 red, float4 green,
  float4 blue, float4 alpha, float4 far, int4 taken)
{
  const float16 row = (float16)(red.x, green.x, blue.x, alpha.x, red.y, green.y, blue.y, alpha.y, red.z, green.z, blue.z, alpha.z, red.w,
    green.w, blue.w, alpha.w);
  vstore16(row, 0, to->rgba + 4 * pixel);
  if (a->picture.want_bytes) {
    const float16 bytes = row * 255.0f + 0.5f;
    vstore16(convert_uchar16(v_min(bytes, v_set(255.0f))), 0, to->rgba8 + 4 * pixel);
  }
  if (a->picture.want_depth) {
    vstore4(select(far, (float4)(INFINITY), far >= LARGEST_FLOAT), 0, to->depth + pixel);
  }
  if (a->picture.want_samples) {
    vstore4(as_uint4(taken), 0, to->samples + pixel);
  }
}

static void store_packet(__constant stratus_ray_cast_arguments* a, const stratus_pixels* to, const stratus_packet* k, int x, int y)
{
  const vfloat opacity = v_set(1.0f) - k->transparency;
  if (x + PACKET_X <= a->picture.width && y + PACKET_Y <= a->picture.height) {
    const size_t width = (size_t)a->picture.width, pixel = (size_t)y * width + (size_t)x;
    store_four(a, to, pixel, k->red.s0123, k->green.s0123, k->blue.s0123, opacity.s0123, k->depth.s0123, k->samples.s0123);
    store_four(a, to, pixel + width, k->red.s4567, k->green.s4567, k->blue.s4567, opacity.s4567, k->depth.s4567, k->samples.s4567);
    store_four(a, to, pixel + 2 * width, k->red.s89ab, k->green.s89ab, k->blue.s89ab, opacity.s89ab, k->depth.s89ab, k->samples.s89ab);
    store_four(a, to, pixel + 3 * width, k->red.scdef, k->green.scdef, k->blue.scdef, opacity.scdef, k->depth.scdef, k->samples.scdef);
    return;
  }
  float red[STRATUS_WIDTH], green[STRATUS_WIDTH], blue[STRATUS_WIDTH], alpha[STRATUS_WIDTH], far[STRATUS_WIDTH];
  int taken[STRATUS_WIDTH];
  v_store(red, k->red);
  v_store(green, k->green);
  v_store(blue, k->blue);
  v_store(alpha, opacity);
  v_store(far, k->depth);
  vi_store(taken, k->samples);
  for (int lane = 0; lane < STRATUS_WIDTH; ++lane) {
    store_pixel(a, to, x + (lane & (PACKET_X - 1)), y + (lane >> PACKET_X_LOG2), (float4)(red[lane], green[lane], blue[lane], alpha[lane]),
      far[lane], (uint)taken[lane]);
  }
}

static uint sum_lanes(vint lanes)
{
  const uint8 a = as_uint8(lanes.lo) + as_uint8(lanes.hi);
  const uint4 b = a.lo + a.hi;
  const uint2 c = b.lo + b.hi;
  return c.x + c.y;
}
#endif

#endif
