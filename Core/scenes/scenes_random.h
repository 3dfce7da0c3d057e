/* SPDX-License-Identifier: BSD-3-Clause
 * The random numbers of the scenes of record. */
#ifndef STRATUS_SCENES_RANDOM_H
#define STRATUS_SCENES_RANDOM_H

#include <math.h>
#include <stdint.h>

#define TWO_PI 6.283185307179586

/* A Weyl counter with mixed bits (Steele, Lea & Flood 2014). */
static inline uint64_t random_bits(uint64_t* state)
{
  *state += UINT64_C(0x9e3779b97f4a7c15);
  uint64_t z = *state;
  z = (z ^ z >> 30) * UINT64_C(0xbf58476d1ce4e5b9);
  z = (z ^ z >> 27) * UINT64_C(0x94d049bb133111eb);
  return z ^ z >> 31;
}

static inline double random_unit(uint64_t* state)
{
  return (double)(random_bits(state) >> 11) * 0x1p-53;
}

static inline double random_normal(uint64_t* state)
{
  const double a = random_unit(state) + 1e-18, b = random_unit(state);
  return sqrt(-2.0 * log(a)) * cos(TWO_PI * b);
}

static inline int random_below(uint64_t* state, int n)
{
  return (int)(random_bits(state) % (uint64_t)n);
}

#endif
