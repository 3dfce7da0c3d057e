/* SPDX-License-Identifier: BSD-3-Clause
 * Measures this machine's sample rate in a tight loop, for the estimate of method `floor`. */
#define _POSIX_C_SOURCE 200809L
#include "rate.h"

#include <omp.h>
#include <stdint.h>
#include <stdlib.h>
#include <time.h>

#if defined(__x86_64__)
#include <immintrin.h>
#endif

#define SIDE_LOG2 6
#define SIDE (1 << SIDE_LOG2)
#define STEPS 48
#define TABLE 1024

typedef float row16[16] __attribute__((aligned(64)));

typedef struct work {
  float* block;
  float* table; /* TABLE reds, then greens, blues and alphas */
} work;

/* The start of a packet of 16 neighbouring rays, and their common step. */
typedef struct packet {
  float start[3], step[3];
} packet;

static double now(void)
{
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

#define NEIGHBOURS 0.7f /* voxels between rays */

/* Both versions return part of the picture, so that the compiler removes nothing. */
static float packet_portable(const work* w, const packet* p)
{
  row16 x[3], color[3] = { { 0 } }, left;
  for (int lane = 0; lane < 16; ++lane) {
    x[0][lane] = p->start[0] + NEIGHBOURS * (float)lane;
    x[1][lane] = p->start[1];
    x[2][lane] = p->start[2];
    left[lane] = 1.0f;
  }
  for (int step = 0; step < STEPS; ++step) {
    for (int lane = 0; lane < 16; ++lane) {
      const int i = (int)x[0][lane], j = (int)x[1][lane], k = (int)x[2][lane];
      const float f = x[0][lane] - (float)i, g = x[1][lane] - (float)j, h = x[2][lane] - (float)k;
      const float* c = w->block + (k * SIDE + j) * SIDE + i;
      const float* d = c + SIDE * SIDE;
      const float a = c[0] + f * (c[1] - c[0]), b = c[SIDE] + f * (c[SIDE + 1] - c[SIDE]);
      const float e = d[0] + f * (d[1] - d[0]), m = d[SIDE] + f * (d[SIDE + 1] - d[SIDE]);
      const float low = a + g * (b - a), high = e + g * (m - e);
      const int at = (int)((low + h * (high - low)) * (TABLE - 1));
      for (int n = 0; n < 3; ++n) {
        color[n][lane] += left[lane] * w->table[n * TABLE + at];
        x[n][lane] += p->step[n];
      }
      left[lane] -= left[lane] * w->table[3 * TABLE + at];
    }
  }
  return color[0][0] + color[1][5] + color[2][10] + left[15];
}

#if defined(__x86_64__)
__attribute__((target("avx512f"))) static inline __m512 lerp16(__m512 a, __m512 b, __m512 t)
{
  return _mm512_fmadd_ps(t, _mm512_sub_ps(b, a), a);
}

__attribute__((target("avx512f"))) static float packet_avx512(const work* w, const packet* p)
{
  const __m512 lanes = _mm512_set_ps(15, 14, 13, 12, 11, 10, 9, 8, 7, 6, 5, 4, 3, 2, 1, 0);
  __m512 x = _mm512_fmadd_ps(lanes, _mm512_set1_ps(NEIGHBOURS), _mm512_set1_ps(p->start[0]));
  __m512 y = _mm512_set1_ps(p->start[1]), z = _mm512_set1_ps(p->start[2]);
  __m512 color[3] = { _mm512_setzero_ps(), _mm512_setzero_ps(), _mm512_setzero_ps() }, left = _mm512_set1_ps(1.0f);
  const float* c = w->block;
  const float* d = c + SIDE * SIDE;
  for (int step = 0; step < STEPS; ++step) {
    const __m512i i = _mm512_cvttps_epi32(x), j = _mm512_cvttps_epi32(y), k = _mm512_cvttps_epi32(z);
    const __m512 f = _mm512_sub_ps(x, _mm512_cvtepi32_ps(i)), g = _mm512_sub_ps(y, _mm512_cvtepi32_ps(j)),
                 h = _mm512_sub_ps(z, _mm512_cvtepi32_ps(k));
    const __m512i row = _mm512_add_epi32(_mm512_slli_epi32(k, SIDE_LOG2), j), cell = _mm512_add_epi32(_mm512_slli_epi32(row, SIDE_LOG2), i);
    const __m512 a = lerp16(_mm512_i32gather_ps(cell, c, 4), _mm512_i32gather_ps(cell, c + 1, 4), f);
    const __m512 b = lerp16(_mm512_i32gather_ps(cell, c + SIDE, 4), _mm512_i32gather_ps(cell, c + SIDE + 1, 4), f);
    const __m512 e = lerp16(_mm512_i32gather_ps(cell, d, 4), _mm512_i32gather_ps(cell, d + 1, 4), f);
    const __m512 m = lerp16(_mm512_i32gather_ps(cell, d + SIDE, 4), _mm512_i32gather_ps(cell, d + SIDE + 1, 4), f);
    const __m512 value = lerp16(lerp16(a, b, g), lerp16(e, m, g), h);
    const __m512i at = _mm512_cvttps_epi32(_mm512_mul_ps(value, _mm512_set1_ps(TABLE - 1)));
    for (int n = 0; n < 3; ++n) {
      color[n] = _mm512_fmadd_ps(left, _mm512_i32gather_ps(at, w->table + n * TABLE, 4), color[n]);
    }
    left = _mm512_fnmadd_ps(left, _mm512_i32gather_ps(at, w->table + 3 * TABLE, 4), left);
    x = _mm512_add_ps(x, _mm512_set1_ps(p->step[0]));
    y = _mm512_add_ps(y, _mm512_set1_ps(p->step[1]));
    z = _mm512_add_ps(z, _mm512_set1_ps(p->step[2]));
  }
  return _mm512_reduce_add_ps(_mm512_add_ps(_mm512_add_ps(color[0], color[1]), _mm512_add_ps(color[2], left)));
}
#endif

static int has_avx512(void)
{
#if defined(__x86_64__)
  return __builtin_cpu_supports("avx512f");
#else
  return 0;
#endif
}

const char* bench_sample_loop(void)
{
  return has_avx512() ? "AVX-512" : "portable";
}

/* Marches a random packet that stays inside the block: 48 steps of at most 0.8 voxels along each axis from near its corner. */
static float march(const work* w, int wide, uint32_t* random)
{
  packet p;
  *random = *random * 1664525u + 1013904223u;
  p.start[0] = (float)(*random >> 24) / 32.0f;
  p.start[1] = (float)(*random >> 16 & 255) / 16.0f;
  p.start[2] = (float)(*random >> 8 & 255) / 16.0f;
  for (int axis = 0; axis < 3; ++axis) {
    p.step[axis] = 0.2f + (float)(*random >> (8 + 5 * axis) & 31) / 64.0f;
  }
#if defined(__x86_64__)
  if (wide) {
    return packet_avx512(w, &p);
  }
#endif
  (void)wide;
  return packet_portable(w, &p);
}

double bench_sample_rate(void)
{
  const int wide = has_avx512();
  double best = 0.0;
  volatile float sink = 0.0f;
  work w = { malloc(SIDE * SIDE * SIDE * sizeof(float)), malloc(4 * TABLE * sizeof(float)) };
  for (int i = 0; w.block && i < SIDE * SIDE * SIDE; ++i) {
    w.block[i] = (float)(i * 7919 % 1000) / 1000.0f;
  }
  for (int i = 0; w.table && i < 4 * TABLE; ++i) {
    w.table[i] = (float)(i % TABLE) / (50.0f * TABLE);
  }
  for (int attempt = 0; w.block && w.table && attempt < 5; ++attempt) {
    enum { PACKETS = 20000 };
    const double start = now();
#pragma omp parallel
    {
      uint32_t random = 17u + (uint32_t)omp_get_thread_num();
      float sum = 0.0f;
      for (int i = 0; i < PACKETS; ++i) {
        sum += march(&w, wide, &random);
      }
#pragma omp critical
      sink = sink + sum;
    }
    const double rate = 16.0 * STEPS * PACKETS * omp_get_max_threads() / (now() - start);
    best = rate > best ? rate : best;
  }
  free(w.block);
  free(w.table);
  return best;
}
