/* SPDX-License-Identifier: BSD-3-Clause
 * How fast this machine can sample at all: the yardstick of method `floor`. */
#define _POSIX_C_SOURCE 200809L
#include "rate.h"

#include <omp.h>
#include <stdint.h>
#include <stdlib.h>
#include <time.h>

#if defined(__x86_64__)
#include <immintrin.h>
#endif

#define SIDE 32
#define STEPS 30
#define TABLE 1024

typedef float row16[16] __attribute__((aligned(64)));

typedef struct work {
  float* block;
  float* table; /* alpha by value */
} work;

static double now(void)
{
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* One packet of 16 rays next to each other along x, marching along z with a slant; returns something so that nothing is optimised away. */
static float packet_portable(const work* w, float x0, float y0, float slant)
{
  row16 x, y, alpha = { 0 };
  for (int lane = 0; lane < 16; ++lane) {
    x[lane] = x0 + 0.7f * (float)lane;
    y[lane] = y0;
  }
  for (int step = 0; step < STEPS; ++step) {
    const int k = step;
    for (int lane = 0; lane < 16; ++lane) {
      const int i = (int)x[lane], j = (int)y[lane];
      const float f = x[lane] - (float)i, g = y[lane] - (float)j, h = 0.37f;
      const float* c = w->block + (k * SIDE + j) * SIDE + i;
      const float a = c[0] + f * (c[1] - c[0]), b = c[SIDE] + f * (c[SIDE + 1] - c[SIDE]);
      const float* d = c + SIDE * SIDE;
      const float e = d[0] + f * (d[1] - d[0]), m = d[SIDE] + f * (d[SIDE + 1] - d[SIDE]);
      const float low = a + g * (b - a), high = e + g * (m - e);
      const float value = low + h * (high - low);
      alpha[lane] += (1.0f - alpha[lane]) * w->table[(int)(value * (TABLE - 1))];
      x[lane] += slant;
      y[lane] += slant;
    }
  }
  return alpha[0] + alpha[15];
}

#if defined(__x86_64__)
__attribute__((target("avx512f"))) static inline __m512 lerp16(__m512 a, __m512 b, __m512 t)
{
  return _mm512_fmadd_ps(t, _mm512_sub_ps(b, a), a);
}

__attribute__((target("avx512f"))) static float packet_avx512(const work* w, float x0, float y0, float slant)
{
  const __m512 lanes = _mm512_set_ps(15, 14, 13, 12, 11, 10, 9, 8, 7, 6, 5, 4, 3, 2, 1, 0);
  const __m512 h = _mm512_set1_ps(0.37f), move = _mm512_set1_ps(slant), one = _mm512_set1_ps(1.0f);
  __m512 x = _mm512_fmadd_ps(lanes, _mm512_set1_ps(0.7f), _mm512_set1_ps(x0)), y = _mm512_set1_ps(y0), alpha = _mm512_setzero_ps();
  for (int step = 0; step < STEPS; ++step) {
    const __m512i i = _mm512_cvttps_epi32(x), j = _mm512_cvttps_epi32(y);
    const __m512 f = _mm512_sub_ps(x, _mm512_cvtepi32_ps(i)), g = _mm512_sub_ps(y, _mm512_cvtepi32_ps(j));
    const __m512i at = _mm512_add_epi32(_mm512_slli_epi32(j, 5), i);
    const float* c = w->block + step * SIDE * SIDE;
    const float* d = c + SIDE * SIDE;
    const __m512 a = lerp16(_mm512_i32gather_ps(at, c, 4), _mm512_i32gather_ps(at, c + 1, 4), f);
    const __m512 b = lerp16(_mm512_i32gather_ps(at, c + SIDE, 4), _mm512_i32gather_ps(at, c + SIDE + 1, 4), f);
    const __m512 e = lerp16(_mm512_i32gather_ps(at, d, 4), _mm512_i32gather_ps(at, d + 1, 4), f);
    const __m512 m = lerp16(_mm512_i32gather_ps(at, d + SIDE, 4), _mm512_i32gather_ps(at, d + SIDE + 1, 4), f);
    const __m512 value = lerp16(lerp16(a, b, g), lerp16(e, m, g), h);
    const __m512 own = _mm512_i32gather_ps(_mm512_cvttps_epi32(_mm512_mul_ps(value, _mm512_set1_ps(TABLE - 1))), w->table, 4);
    alpha = _mm512_fmadd_ps(_mm512_sub_ps(one, alpha), own, alpha);
    x = _mm512_add_ps(x, move);
    y = _mm512_add_ps(y, move);
  }
  return _mm512_reduce_add_ps(alpha);
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

static float march(const work* w, int wide, uint32_t* random)
{
  *random = *random * 1664525u + 1013904223u;
  const float x0 = (float)(*random >> 24) / 64.0f, y0 = (float)(*random >> 16 & 255) / 16.0f, slant = (float)(*random >> 8 & 255) / 1024.0f;
#if defined(__x86_64__)
  if (wide) {
    return packet_avx512(w, x0, y0, slant);
  }
#endif
  (void)wide;
  return packet_portable(w, x0, y0, slant);
}

double bench_sample_rate(void)
{
  const int wide = has_avx512();
  double best = 0.0;
  volatile float sink = 0.0f;
  work w = { malloc(SIDE * SIDE * SIDE * sizeof(float)), malloc(TABLE * sizeof(float)) };
  for (int i = 0; w.block && i < SIDE * SIDE * SIDE; ++i) {
    w.block[i] = (float)(i * 7919 % 1000) / 1000.0f;
  }
  for (int i = 0; w.table && i < TABLE; ++i) {
    w.table[i] = (float)i / (50.0f * TABLE);
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
