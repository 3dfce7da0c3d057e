/* SPDX-License-Identifier: BSD-3-Clause
 * Entry point of the ray cast: a packet of STRATUS_WIDTH rays a work item. */
#ifndef STRATUS_DEVICE
#define STRATUS_DEVICE 1
#endif
#ifndef STRATUS_WIDTH
#define STRATUS_WIDTH 1
#endif
#ifndef STRATUS_TYPE
#define STRATUS_TYPE 8
#endif
#ifndef STRATUS_PREINTEGRATED
#define STRATUS_PREINTEGRATED 0
#endif
#define RAY_NAME(x) kernel_##x

#include "ray_segment.h"

#include "ray_cast.h"

static void store_pixel(__constant stratus_ray_cast_arguments* a, __global float4* rgba, __global float* depth, __global uint* samples,
  int x, int y, float4 color, float far, uint taken)
{
  if (x < a->width && y < a->height) {
    const size_t pixel = (size_t)y * (size_t)a->width + (size_t)x;
    rgba[pixel] = color;
    if (a->want_depth) {
      depth[pixel] = far >= LARGEST_FLOAT ? INFINITY : far;
    }
    if (a->want_samples) {
      samples[pixel] = taken;
    }
  }
}

/* counts: rays, samples, skipped, lookups, a row of packets each, so that 32 bits hold them. */
__kernel void ray_cast(__constant stratus_ray_cast_arguments* a, __global const void* values, __global const uchar* hidden,
  __global const uchar* map, __global const void* table, __global const float* opaque_depth, __global float4* rgba, __global float* depth,
  __global uint* samples, __global uint* counts)
{
  const int column = (int)get_global_id(0), row = (int)get_global_id(1);
  const int x = column * PACKET_X, y = row * PACKET_Y;
  if (x >= a->width || y >= a->height) {
    return;
  }
  if (packet_outside(a, x, y)) {
    for (int lane = 0; lane < STRATUS_WIDTH; ++lane) {
      store_pixel(a, rgba, depth, samples, x + (lane & (PACKET_X - 1)), y + (lane >> PACKET_X_LOG2), (float4)(0.0f), LARGEST_FLOAT, 0u);
    }
    return;
  }
  stratus_packet k;
  kernel_ray_load(a, opaque_depth, x, y, &k);
  if (m_any(k.live)) {
    kernel_ray_march(a, values, hidden, map, table, &k);
  }
  float red[STRATUS_WIDTH], green[STRATUS_WIDTH], blue[STRATUS_WIDTH], alpha[STRATUS_WIDTH], far[STRATUS_WIDTH];
  int taken[STRATUS_WIDTH], skipped[STRATUS_WIDTH], lookups[STRATUS_WIDTH];
  v_store(red, k.red);
  v_store(green, k.green);
  v_store(blue, k.blue);
  v_store(alpha, v_set(1.0f) - k.transparency);
  v_store(far, k.depth);
  vi_store(taken, k.samples);
  vi_store(skipped, k.skipped);
  vi_store(lookups, k.lookups);
  uint sum[3] = { 0, 0, 0 };
  for (int lane = 0; lane < STRATUS_WIDTH; ++lane) {
    store_pixel(a, rgba, depth, samples, x + (lane & (PACKET_X - 1)), y + (lane >> PACKET_X_LOG2),
      (float4)(red[lane], green[lane], blue[lane], alpha[lane]), far[lane], (uint)taken[lane]);
    sum[0] += (uint)taken[lane];
    sum[1] += (uint)skipped[lane];
    sum[2] += (uint)lookups[lane];
  }
  const uint hits = (uint)m_count(k.hits);
  if (hits) {
    __global uint* count = counts + 4 * row;
    atomic_add(count, hits);
    atomic_add(count + 1, sum[0]);
    atomic_add(count + 2, sum[1]);
    atomic_add(count + 3, sum[2]);
  }
}
