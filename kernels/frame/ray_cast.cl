/* SPDX-License-Identifier: BSD-3-Clause
 * The ray cast on a device. Where STRATUS_WIDTH is 1 (a GPU) a work item does one ray; else (a CPU) it does a tile in packets, as the host
 * does. */
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
#ifndef STRATUS_RAY_MODE
#define STRATUS_RAY_MODE 0
#endif
/* Pixels along each side of a work item's tile of packets. */
#ifndef RAY_TILE
#define RAY_TILE 16
#endif

#include "ray_packet.h"

#include "ray_cast.h"
#include "ray_store.h"

#ifdef STRATUS_ARGUMENTS_BYTES
/* An array of negative size, which does not compile, where the host lays the arguments out otherwise. */
typedef char stratus_arguments_agree[sizeof(stratus_ray_cast_arguments) == STRATUS_ARGUMENTS_BYTES ? 1 : -1];
#endif

/* The kernel's arguments that say where the values are. */
#if RAY_IN_PAGES
#define VALUE_ARGUMENTS                                                                                                                    \
  __global const void *slab0, __global const void *slab1, __global const void *slab2, __global const void *slab3, __global const int *pages
#define VALUE_SOURCE                                                                                                                       \
  {                                                                                                                                        \
    { slab0, slab1, slab2, slab3 }, pages, 0                                                                                               \
  }
#else
#define VALUE_ARGUMENTS __global const void* only_slab
#define VALUE_SOURCE only_slab
#endif

#if STRATUS_WIDTH == 1
/* counts: rays, samples, skipped, lookups of each row of pixels, so that 32 bits hold them. */
PACKET_KERNEL void ray_cast(__constant stratus_ray_cast_arguments* a, VALUE_ARGUMENTS, __global const uchar* hidden,
  __global const uchar* map, __global const uchar* rough, __global const int* grid, __global const int* lights, __global const void* table,
  __global const float* opaque_depth, __global float* rgba, __global uchar* rgba8, __global float* depth, __global uint* samples,
  __global uint* counts)
{
  const value_source values = VALUE_SOURCE;
  const stratus_pixels to = { rgba, rgba8, depth, samples };
  const int x = (int)get_global_id(0), y = (int)get_global_id(1);
  if (x >= a->picture.width || y >= a->picture.height) {
    return;
  }
  stratus_packet k;
  packet_nothing(&k);
  if (!packet_outside(a, x, y)) {
    stratus_crop crop;
    const int pieces = RAY_RARE(RAY_REGIONS, a->crop.regions) ? CROP_PIECES : 1;
    RAY_NAME(ray_load)(a, opaque_depth, grid, lights, x, y, &k, &crop);
    for (int piece = 0; piece < pieces; ++piece) {
      if (RAY_RARE(RAY_REGIONS, a->crop.regions)) {
        crop_enter(a, &crop, piece, 0, &k);
      }
      if (m_any(k.live)) {
        RAY_NAME(ray_march)(a, values, hidden, map, rough, table, &k);
      }
    }
  }
#if STRATUS_RAY_MODE != STRATUS_RAY_COMPOSITE
  RAY_NAME(ray_finish)(a, values, hidden, table, &k);
#endif
  store_pixel(a, &to, x, y, (float4)(k.red, k.green, k.blue, 1.0f - k.transparency), k.depth, (uint)k.samples);
  if (k.hits) {
    __global uint* count = counts + 4 * y;
    atomic_inc(count);
    atomic_add(count + 1, (uint)k.samples);
    atomic_add(count + 2, (uint)k.skipped);
    atomic_add(count + 3, (uint)k.lookups);
  }
}

#else
/* counts: rays, samples, skipped, lookups of each tile. 32 bits hold a tile's, and no other work item adds to them. */
PACKET_KERNEL void ray_cast(__constant stratus_ray_cast_arguments* a, VALUE_ARGUMENTS, __global const uchar* hidden,
  __global const uchar* map, __global const uchar* rough, __global const int* grid, __global const int* lights, __global const void* table,
  __global const float* opaque_depth, __global float* rgba, __global uchar* rgba8, __global float* depth, __global uint* samples,
  __global uint* counts)
{
  const value_source values = VALUE_SOURCE;
  const stratus_pixels to = { rgba, rgba8, depth, samples };
  const int x0 = (int)get_global_id(0) * RAY_TILE, y0 = (int)get_global_id(1) * RAY_TILE;
  const int x1 = min(x0 + RAY_TILE, a->picture.width), y1 = min(y0 + RAY_TILE, a->picture.height);
  const int pieces = RAY_RARE(RAY_REGIONS, a->crop.regions) ? CROP_PIECES : 1;
  vint taken = vi_set(0), skipped = vi_set(0), lookups = vi_set(0);
  uint rays = 0;
  for (int y = y0; y < y1; y += PACKET_Y) {
    for (int x = x0; x < x1; x += PACKETS_TOGETHER * PACKET_X) {
      stratus_packet k[PACKETS_TOGETHER];
      stratus_crop crop[PACKETS_TOGETHER];
      for (int i = 0; i < PACKETS_TOGETHER; ++i) {
        if (packet_outside(a, x + i * PACKET_X, y)) {
          packet_nothing(&k[i]);
          crop[i].all = m_none();
        } else {
          RAY_NAME(ray_load)
          (a, opaque_depth, grid, lights, x + i * PACKET_X, y, &k[i],
            &crop[i]); /* a packet beyond the picture has no live ray and stores nothing */
        }
      }
      for (int piece = 0; piece < pieces; ++piece) {
        for (int i = 0; RAY_RARE(RAY_REGIONS, a->crop.regions) && i < PACKETS_TOGETHER; ++i) {
          crop_enter(a, &crop[i], piece, 0, &k[i]);
        }
#if PACKETS_TOGETHER == 2
        RAY_NAME(ray_march_two)(a, values, hidden, map, rough, table, &k[0], &k[1]);
#else
        RAY_NAME(ray_march)(a, values, hidden, map, rough, table, &k[0]);
#endif
      }
      for (int i = 0; i < PACKETS_TOGETHER; ++i) {
#if STRATUS_RAY_MODE != STRATUS_RAY_COMPOSITE
        RAY_NAME(ray_finish)(a, values, hidden, table, &k[i]);
#endif
        store_packet(a, &to, &k[i], x + i * PACKET_X, y);
        rays += (uint)m_count(k[i].hits);
        taken = taken + k[i].samples;
        skipped = skipped + k[i].skipped;
        lookups = lookups + k[i].lookups;
      }
    }
  }
  const size_t tile = get_global_id(1) * get_global_size(0) + get_global_id(0);
  vstore4((uint4)(rays, sum_lanes(taken), sum_lanes(skipped), sum_lanes(lookups)), tile, counts);
}
#endif
