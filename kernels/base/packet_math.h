/* SPDX-License-Identifier: BSD-3-Clause
 * Reciprocal, inverse square root and exponential, from only + - * fma and operations on bits. They give the same bits in every dialect,
 * which a device's own division and exponential do not. */
#ifndef STRATUS_PACKET_MATH_H
#define STRATUS_PACKET_MATH_H

#include "packet.h"

/* 1/a for a > 0, off by one or two roundings: Newton's iteration from a guess by the bits. */
INLINE vfloat v_reciprocal(vfloat a)
{
  const vint bits = v_to_bits(a), magnitude = bits & vi_set(0x7fffffff); /* lanes outside the mask may be negative */
  vfloat r = v_from_bits((vi_set(0x7ef311c7) - magnitude) | (bits - magnitude));
  for (int iteration = 0; iteration < 3; ++iteration) {
    r = v_fma(r, v_fma(v_set(0.0f) - a, r, v_set(1.0f)), r);
  }
  return r;
}

/* 1/sqrt(a) for a > 0, in the same way. */
INLINE vfloat v_inverse_root(vfloat a)
{
  const vfloat half_a = v_set(0.5f) * a;
  vfloat r = v_from_bits(vi_set(0x5f375a86) - (v_to_bits(a) >> vi_set(1)));
  for (int iteration = 0; iteration < 4; ++iteration) {
    r = r * v_fma(v_set(0.0f) - half_a * r, r, v_set(1.5f));
  }
  return r;
}

/* 1 - exp(-x) for x >= 0, with a relative error of about 3e-7. x is n ln 2 + t: a series gives exp(-t), and the bits of an exponent 2^-n.
 */
INLINE vfloat v_absorbed(vfloat x)
{
  x = v_min(x, v_set(80.0f)); /* beyond 80 the result is 1 as a float, and n would leave the exponent's range */
  const vint n = v_to_int(x * v_set(1.44269504f));
  const vfloat t = v_max(v_fma(v_from_int(n), v_set(-0.69314718f), x), v_set(0.0f)), minus = v_set(0.0f) - t;
  vfloat series = v_set(1.0f / 40320.0f);
  series = v_fma(series, minus, v_set(1.0f / 5040.0f));
  series = v_fma(series, minus, v_set(1.0f / 720.0f));
  series = v_fma(series, minus, v_set(1.0f / 120.0f));
  series = v_fma(series, minus, v_set(1.0f / 24.0f));
  series = v_fma(series, minus, v_set(1.0f / 6.0f));
  series = v_fma(series, minus, v_set(0.5f));
  series = v_fma(series, minus, v_set(1.0f)) * t;
  const vfloat scale = v_from_bits((vi_set(127) - n) << vi_set(23));
  return v_min(v_fma(scale, series, v_set(1.0f) - scale), v_set(1.0f));
}

#endif
