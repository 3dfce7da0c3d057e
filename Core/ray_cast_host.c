/* SPDX-License-Identifier: BSD-3-Clause
 * The traversal headers compiled for one instruction set, STRATUS_ISA: every type, both sampling rules. */
#include "ray_cast.h"

#include "../kernels/ray_segment.h"

#ifdef __GNUC__
#pragma GCC diagnostic ignored "-Wunused-function" /* each type uses its part of the fetches */
#endif

static void store_packet(const stratus_ray_cast_frame* frame, const stratus_packet* k, int x, int y, stratus_ray_counts* counts)
{
  const stratus_ray_cast_arguments* a = frame->arguments;
  const vfloat one = v_set(1.0f);
  float color[4][STRATUS_WIDTH], depth[STRATUS_WIDTH];
  int samples[STRATUS_WIDTH], skipped[STRATUS_WIDTH], lookups[STRATUS_WIDTH];
  v_store(color[0], k->red);
  v_store(color[1], k->green);
  v_store(color[2], k->blue);
  v_store(color[3], one - k->transparency);
  v_store(depth, k->depth);
  vi_store(samples, k->samples);
  vi_store(skipped, k->skipped);
  vi_store(lookups, k->lookups);
  counts->rays += (uint64_t)m_count(k->hits);
  for (int lane = 0; lane < STRATUS_WIDTH; ++lane) {
    counts->samples += (uint64_t)samples[lane];
    counts->skipped += (uint64_t)skipped[lane];
    counts->lookups += (uint64_t)lookups[lane];
    const int px = x + lane % PACKET_X, py = y + lane / PACKET_X;
    if (px < a->width && py < a->height) {
      const size_t pixel = (size_t)py * (size_t)a->width + (size_t)px;
      for (int c = 0; c < 4; ++c) {
        frame->rgba[4 * pixel + (size_t)c] = color[c][lane];
      }
      if (frame->depth) {
        frame->depth[pixel] = depth[lane] >= LARGEST_FLOAT ? INFINITY : depth[lane];
      }
      if (frame->samples) {
        frame->samples[pixel] = (uint32_t)samples[lane];
      }
    }
  }
}

#define JOIN_(a, b) a##_##b
#define JOIN(a, b) JOIN_(a, b)

#define STRATUS_PREINTEGRATED 0
#define STRATUS_TYPE -1
#define RAY_NAME(x) JOIN(x, mid_any)
#include "ray_cast_tile.h"
#define STRATUS_TYPE 0
#define RAY_NAME(x) JOIN(x, mid_int8)
#include "ray_cast_tile.h"
#define STRATUS_TYPE 1
#define RAY_NAME(x) JOIN(x, mid_uint8)
#include "ray_cast_tile.h"
#define STRATUS_TYPE 2
#define RAY_NAME(x) JOIN(x, mid_int16)
#include "ray_cast_tile.h"
#define STRATUS_TYPE 3
#define RAY_NAME(x) JOIN(x, mid_uint16)
#include "ray_cast_tile.h"
#define STRATUS_TYPE 8
#define RAY_NAME(x) JOIN(x, mid_float32)
#include "ray_cast_tile.h"
#define STRATUS_TYPE 9
#define RAY_NAME(x) JOIN(x, mid_float64)
#include "ray_cast_tile.h"
#undef STRATUS_PREINTEGRATED

#define STRATUS_PREINTEGRATED 1
#define STRATUS_TYPE -1
#define RAY_NAME(x) JOIN(x, pre_any)
#include "ray_cast_tile.h"
#define STRATUS_TYPE 0
#define RAY_NAME(x) JOIN(x, pre_int8)
#include "ray_cast_tile.h"
#define STRATUS_TYPE 1
#define RAY_NAME(x) JOIN(x, pre_uint8)
#include "ray_cast_tile.h"
#define STRATUS_TYPE 2
#define RAY_NAME(x) JOIN(x, pre_int16)
#include "ray_cast_tile.h"
#define STRATUS_TYPE 3
#define RAY_NAME(x) JOIN(x, pre_uint16)
#include "ray_cast_tile.h"
#define STRATUS_TYPE 8
#define RAY_NAME(x) JOIN(x, pre_float32)
#include "ray_cast_tile.h"
#define STRATUS_TYPE 9
#define RAY_NAME(x) JOIN(x, pre_float64)
#include "ray_cast_tile.h"

#if STRATUS_ISA == 2
#define TILE_ISA stratus_ray_cast_tile_isa2
#elif STRATUS_ISA == 1
#define TILE_ISA stratus_ray_cast_tile_isa1
#else
#define TILE_ISA stratus_ray_cast_tile_isa0
#endif

stratus_ray_cast_tile* TILE_ISA(int type, int preintegrated)
{
  static stratus_ray_cast_tile* const tiles[2][11] = {
    { tile_mid_any, tile_mid_int8, tile_mid_uint8, tile_mid_int16, tile_mid_uint16, tile_mid_any, tile_mid_any, tile_mid_any, tile_mid_any,
      tile_mid_float32, tile_mid_float64 },
    { tile_pre_any, tile_pre_int8, tile_pre_uint8, tile_pre_int16, tile_pre_uint16, tile_pre_any, tile_pre_any, tile_pre_any, tile_pre_any,
      tile_pre_float32, tile_pre_float64 },
  };
  return tiles[preintegrated][type + 1];
}
