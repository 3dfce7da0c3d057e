/* SPDX-License-Identifier: BSD-3-Clause
 * Jump flooding (Rong & Tan 2006), the parts that host and device share: how a voxel remembers the nearest effective one, and how much
 * nearer a pass brought it. Both dialects round these operations alike. */
#ifndef STRATUS_JUMP_FLOODING_H
#define STRATUS_JUMP_FLOODING_H

#ifdef STRATUS_DEVICE
#pragma OPENCL FP_CONTRACT OFF
#define FLOOD_INLINE static inline
typedef uint flood_position;
#else
#include <stdint.h>
#include <string.h>
#define FLOOD_INLINE static inline
typedef uint32_t flood_position;
#endif

/* Position (i,j,k) is k << shift_z | j << shift_y | i, of at most 31 bits. Positions compare as the voxels' indices do. */
#define FLOOD_UNKNOWN 0xffffffffu
#define FLOOD_RATIO_ONE 65536.0f /* ratios are summed as integers in units of 1/65536, so that their order does not matter */

/* 1/sqrt(a) for a >= 1, with an error of about 1e-7, by Newton's steps from a guess by the bits: a device's own root may round otherwise
 * than the host's. */
FLOOD_INLINE float flood_inverse_root(float a)
{
  float r;
#ifdef STRATUS_DEVICE
  r = as_float(0x5f375a86 - (as_int(a) >> 1));
#else
  int32_t bits;
  memcpy(&bits, &a, sizeof bits);
  bits = 0x5f375a86 - (bits >> 1);
  memcpy(&r, &bits, sizeof r);
#endif
  r = r * (1.5f - 0.5f * a * r * r);
  r = r * (1.5f - 0.5f * a * r * r);
  return r * (1.5f - 0.5f * a * r * r);
}

/* The new distance over the old one, from their squares, 1 <= now < before; in units of 1/FLOOD_RATIO_ONE. */
FLOOD_INLINE int flood_ratio(float now, float before)
{
  return (int)(now * flood_inverse_root(now) * flood_inverse_root(before) * FLOOD_RATIO_ONE + 0.5f);
}

#ifdef STRATUS_DEVICE
/* The same of 16 voxels. */
static inline float16 flood_inverse_roots(float16 a)
{
  float16 r = as_float16((int16)(0x5f375a86) - (as_int16(a) >> (int16)(1)));
  r = r * (1.5f - 0.5f * a * r * r);
  r = r * (1.5f - 0.5f * a * r * r);
  return r * (1.5f - 0.5f * a * r * r);
}

static inline int16 flood_ratios(float16 now, float16 before)
{
  return convert_int16(now * flood_inverse_roots(now) * flood_inverse_roots(before) * FLOOD_RATIO_ONE + 0.5f);
}
#endif

#endif
