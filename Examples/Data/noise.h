/* SPDX-License-Identifier: BSD-3-Clause
 * Smooth random fields, the same on every machine. */
#ifndef NOISE_H
#define NOISE_H

#include <math.h>
#include <stdint.h>

/* A random number in -1..1 for each point of a lattice. */
static inline double lattice_noise(int32_t x, int32_t y, int32_t z)
{
  uint32_t h = (uint32_t)x * 0x8da6b343u ^ (uint32_t)y * 0xd8163841u ^ (uint32_t)z * 0xcb1ab31fu;
  h = (h ^ h >> 15) * 0x2c1b3c6du;
  h = (h ^ h >> 12) * 0x297a2d39u;
  h ^= h >> 15;
  return h / 2147483647.5 - 1.0;
}

static inline double smooth_step(double t)
{
  return t * t * (3.0 - 2.0 * t);
}

/* Interpolates the lattice's numbers smoothly. */
static inline double noise(double x, double y, double z)
{
  const double fx = floor(x), fy = floor(y), fz = floor(z);
  const double u = smooth_step(x - fx), v = smooth_step(y - fy), w = smooth_step(z - fz);
  double sum = 0.0;
  for (int c = 0; c < 8; ++c) {
    const double weight = (c & 1 ? u : 1.0 - u) * (c & 2 ? v : 1.0 - v) * (c & 4 ? w : 1.0 - w);
    sum += weight * lattice_noise((int32_t)fx + (c & 1), (int32_t)fy + (c >> 1 & 1), (int32_t)fz + (c >> 2));
  }
  return sum;
}

/* The same of noises folded at 0, whose bulges are round and whose furrows are sharp: -1..1. */
static inline double billows(double x, double y, double z, int octaves)
{
  double sum = 0.0, strength = 0.5;
  for (int i = 0; i < octaves; ++i, strength *= 0.5) {
    const double scale = (double)(1 << i);
    sum += strength * (2.0 * fabs(noise(x * scale, y * scale, z * scale)) - 0.5);
  }
  return sum;
}

/* The sum of `octaves` noises, each half as strong and twice as fine as the one before. */
static inline double turbulence(double x, double y, double z, int octaves)
{
  double sum = 0.0, strength = 1.0;
  for (int i = 0; i < octaves; ++i, strength *= 0.5) {
    const double scale = (double)(1 << i);
    sum += strength * noise(x * scale, y * scale, z * scale);
  }
  return sum;
}

#endif
