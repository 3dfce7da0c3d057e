/* SPDX-License-Identifier: BSD-3-Clause
 * Stores packets as pixels and counts on the host. Every file that compiles the traversal for one instruction set, STRATUS_ISA, includes
 * it. */
#ifndef STRATUS_RAY_CAST_PACKETS_H
#define STRATUS_RAY_CAST_PACKETS_H

#include "ray_cast_host.h"

#include "ray_packet.h"

#ifdef __GNUC__
#pragma GCC diagnostic ignored "-Wunused-function" /* each type uses only some of the fetches */
#endif

/* A tile's counters. Each lane counts for itself; add_counts() sums the lanes once per tile. */
typedef struct tile_counts {
  vint samples, skipped, lookups;
  uint64_t rays;
} tile_counts;

static void store_pixels(const stratus_ray_cast_frame* frame, const stratus_packet* k, int x, int y)
{
  const stratus_ray_cast_arguments* a = frame->arguments;
  float color[4][STRATUS_WIDTH];
  v_store(color[0], k->red);
  v_store(color[1], k->green);
  v_store(color[2], k->blue);
  v_store(color[3], v_set(1.0f) - k->transparency);
  for (int lane = 0; lane < STRATUS_WIDTH; ++lane) {
    const int px = x + lane % PACKET_X, py = y + lane / PACKET_X;
    if (px < a->picture.width && py < a->picture.height) {
      float* pixel = frame->rgba + 4 * ((size_t)py * (size_t)a->picture.width + (size_t)px);
      for (int c = 0; c < 4; ++c) {
        pixel[c] = color[c][lane];
      }
    }
  }
}

#if STRATUS_ISA == 2
/* store_pixels() for a packet wholly inside the picture. After the 4x4 transposes, each 128-bit quarter of a register is one pixel. */
static void store_rows(const stratus_ray_cast_frame* frame, const stratus_packet* k, int x, int y)
{
  const size_t row = 4 * (size_t)frame->arguments->picture.width;
  float* pixel = frame->rgba + (size_t)y * row + 4 * (size_t)x;
  const __m512 alpha = v_set(1.0f) - k->transparency;
  const __m512d rg0 = _mm512_castps_pd(_mm512_unpacklo_ps(k->red, k->green)), rg1 = _mm512_castps_pd(_mm512_unpackhi_ps(k->red, k->green));
  const __m512d ba0 = _mm512_castps_pd(_mm512_unpacklo_ps(k->blue, alpha)), ba1 = _mm512_castps_pd(_mm512_unpackhi_ps(k->blue, alpha));
  const __m512 column[4] = { _mm512_castpd_ps(_mm512_unpacklo_pd(rg0, ba0)), _mm512_castpd_ps(_mm512_unpackhi_pd(rg0, ba0)),
    _mm512_castpd_ps(_mm512_unpacklo_pd(rg1, ba1)), _mm512_castpd_ps(_mm512_unpackhi_pd(rg1, ba1)) };
  for (size_t c = 0; c < 4; ++c) {
    _mm_storeu_ps(pixel + 4 * c, _mm512_extractf32x4_ps(column[c], 0));
    _mm_storeu_ps(pixel + row + 4 * c, _mm512_extractf32x4_ps(column[c], 1));
    _mm_storeu_ps(pixel + 2 * row + 4 * c, _mm512_extractf32x4_ps(column[c], 2));
    _mm_storeu_ps(pixel + 3 * row + 4 * c, _mm512_extractf32x4_ps(column[c], 3));
  }
}

/* store_extras() for a packet wholly inside the picture. */
static void store_extra_rows(const stratus_ray_cast_frame* frame, const stratus_packet* k, int x, int y)
{
  const size_t width = (size_t)frame->arguments->picture.width, pixel = (size_t)y * width + (size_t)x;
  if (frame->depth) {
    const __m512 depth = v_select(v_le(v_set(LARGEST_FLOAT), k->depth), v_set(INFINITY), k->depth);
    _mm_storeu_ps(frame->depth + pixel, _mm512_extractf32x4_ps(depth, 0));
    _mm_storeu_ps(frame->depth + pixel + width, _mm512_extractf32x4_ps(depth, 1));
    _mm_storeu_ps(frame->depth + pixel + 2 * width, _mm512_extractf32x4_ps(depth, 2));
    _mm_storeu_ps(frame->depth + pixel + 3 * width, _mm512_extractf32x4_ps(depth, 3));
  }
  if (frame->samples) {
    _mm_storeu_si128((__m128i*)(frame->samples + pixel), _mm512_extracti32x4_epi32((__m512i)k->samples, 0));
    _mm_storeu_si128((__m128i*)(frame->samples + pixel + width), _mm512_extracti32x4_epi32((__m512i)k->samples, 1));
    _mm_storeu_si128((__m128i*)(frame->samples + pixel + 2 * width), _mm512_extracti32x4_epi32((__m512i)k->samples, 2));
    _mm_storeu_si128((__m128i*)(frame->samples + pixel + 3 * width), _mm512_extracti32x4_epi32((__m512i)k->samples, 3));
  }
}
#endif

/* Stores depths and sample counts, if they are wanted. */
static void store_extras(const stratus_ray_cast_frame* frame, const stratus_packet* k, int x, int y)
{
  const stratus_ray_cast_arguments* a = frame->arguments;
  float depth[STRATUS_WIDTH];
  int samples[STRATUS_WIDTH];
  v_store(depth, k->depth);
  vi_store(samples, k->samples);
  for (int lane = 0; lane < STRATUS_WIDTH; ++lane) {
    const int px = x + lane % PACKET_X, py = y + lane / PACKET_X;
    if (px < a->picture.width && py < a->picture.height) {
      const size_t pixel = (size_t)py * (size_t)a->picture.width + (size_t)px;
      if (frame->depth) {
        frame->depth[pixel] = depth[lane] >= LARGEST_FLOAT ? INFINITY : depth[lane];
      }
      if (frame->samples) {
        frame->samples[pixel] = (uint32_t)samples[lane];
      }
    }
  }
}

static void store_packet(const stratus_ray_cast_frame* frame, const stratus_packet* k, int x, int y, tile_counts* counts)
{
#if STRATUS_ISA == 2
  if (x + PACKET_X <= frame->arguments->picture.width && y + PACKET_Y <= frame->arguments->picture.height) {
    store_rows(frame, k, x, y);
    store_extra_rows(frame, k, x, y);
  } else
#endif
  {
    store_pixels(frame, k, x, y);
    if (frame->depth || frame->samples) {
      store_extras(frame, k, x, y);
    }
  }
  counts->rays += (uint64_t)m_count(k->hits);
  counts->samples += k->samples;
  counts->skipped += k->skipped;
  counts->lookups += k->lookups;
}

static void add_counts(const tile_counts* tile, stratus_ray_counts* counts)
{
  int samples[STRATUS_WIDTH], skipped[STRATUS_WIDTH], lookups[STRATUS_WIDTH];
  vi_store(samples, tile->samples);
  vi_store(skipped, tile->skipped);
  vi_store(lookups, tile->lookups);
  counts->rays += tile->rays;
  for (int lane = 0; lane < STRATUS_WIDTH; ++lane) {
    counts->samples += (uint64_t)samples[lane];
    counts->skipped += (uint64_t)skipped[lane];
    counts->lookups += (uint64_t)lookups[lane];
  }
}

#endif
