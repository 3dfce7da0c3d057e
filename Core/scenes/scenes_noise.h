/* SPDX-License-Identifier: BSD-3-Clause
 * Value noise on an integer hash. It defines the volumes of record to the last bit: single precision, in this order of operations. */
#ifndef STRATUS_SCENES_NOISE_H
#define STRATUS_SCENES_NOISE_H

#include <stdint.h>

#define NOISE_OCTAVES_MAX 6

static inline uint32_t noise_hash(uint32_t x, uint32_t y, uint32_t z, uint32_t seed)
{
  uint32_t k = (x * 0x9E3779B1u) ^ (y * 0x85EBCA77u) ^ (z * 0xC2B2AE3Du) ^ (seed * 0x27D4EB2Fu);
  k ^= k >> 15;
  k *= 0x2C1B3C6Du;
  k ^= k >> 12;
  k *= 0x297A2D39u;
  return k ^ (k >> 15);
}

/* Returns a random number in 0..1 at a lattice point. */
static inline float noise_corner(uint32_t x, uint32_t y, uint32_t z, uint32_t seed)
{
  return (float)(noise_hash(x, y, z, seed) >> 8) * (1.0f / 16777216.0f);
}

/* Returns the i-th random number of a seed, in 0..1. */
static inline float noise_unit(uint32_t i, uint32_t seed)
{
  return noise_corner(i, 17, 91, seed);
}

static inline float noise_mix(float a, float b, float t)
{
  return a + t * (b - a);
}

static inline float noise_fade(float t)
{
  return t * t * (3.0f - 2.0f * t);
}

/* One octave along a row of x. It keeps the last lattice cell, which neighbouring voxels mostly share. */
typedef struct noise_octave {
  uint32_t seed, cell, j, k;
  float v, w;            /* fade along y, z */
  float near[4], far[4]; /* corners (j,k) (j+1,k) (j,k+1) (j+1,k+1) at `cell` and `cell`+1 */
} noise_octave;

/* Fractal noise along the row (y, z). Coordinates are >= 0. */
typedef struct noise_row {
  int octaves;
  noise_octave octave[NOISE_OCTAVES_MAX];
} noise_row;

static inline void noise_row_start(noise_row* row, float y, float z, int octaves, uint32_t seed)
{
  row->octaves = octaves;
  for (int o = 0; o < octaves; ++o) {
    noise_octave* octave = row->octave + o;
    octave->seed = seed + (uint32_t)o;
    octave->cell = UINT32_MAX - 1; /* no row reaches this cell or the next one */
    octave->j = (uint32_t)y;
    octave->k = (uint32_t)z;
    octave->v = noise_fade(y - (float)octave->j);
    octave->w = noise_fade(z - (float)octave->k);
    y *= 2.03f;
    z *= 2.03f;
  }
}

static inline void noise_corners(const noise_octave* octave, uint32_t cell, float corner[4])
{
  for (uint32_t c = 0; c < 4; ++c) {
    corner[c] = noise_corner(cell, octave->j + (c & 1), octave->k + (c >> 1), octave->seed);
  }
}

static inline float noise_octave_value(noise_octave* octave, float x)
{
  const uint32_t cell = (uint32_t)x;
  if (cell != octave->cell) {
    if (cell == octave->cell + 1) {
      for (int c = 0; c < 4; ++c) {
        octave->near[c] = octave->far[c];
      }
    } else {
      noise_corners(octave, cell, octave->near);
    }
    noise_corners(octave, cell + 1, octave->far);
    octave->cell = cell;
  }
  const float u = noise_fade(x - (float)cell);
  const float* near = octave->near;
  const float* far = octave->far;
  const float front = noise_mix(noise_mix(near[0], far[0], u), noise_mix(near[1], far[1], u), octave->v);
  const float back = noise_mix(noise_mix(near[2], far[2], u), noise_mix(near[3], far[3], u), octave->v);
  return noise_mix(front, back, octave->w);
}

static inline float noise_row_value(noise_row* row, float x)
{
  float sum = 0.0f;
  float gain = 0.5f;
  for (int o = 0; o < row->octaves; ++o) {
    sum += gain * noise_octave_value(row->octave + o, x);
    x *= 2.03f;
    gain *= 0.5f;
  }
  return sum;
}

#endif
