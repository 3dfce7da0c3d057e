/* SPDX-License-Identifier: BSD-3-Clause
 * Jump flooding (Rong & Tan 2006) as host and device share it, C11 and OpenCL C: how a voxel remembers the nearest effective one, and how
 * much nearer a pass brought it, from operations that both round alike. */
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

/* Position (i,j,k) is k << shift_z | j << shift_y | i: in the order of the voxels' indices. At most 31 bits. */
#define FLOOD_UNKNOWN 0xffffffffu
#define FLOOD_RATIO_ONE 65536.0f /* of the whole numbers that ratios are added up in, so that their order does not matter */

/* 1/sqrt(a) for a >= 1 to some 1e-7, by Newton's steps from a guess in the exponent: a device's own root is not rounded as the host's is.
 */
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

/* New over old distance from their squares, 1 <= now < before, in units of 1/FLOOD_RATIO_ONE. */
FLOOD_INLINE int flood_ratio(float now, float before)
{
  return (int)(now * flood_inverse_root(now) * flood_inverse_root(before) * FLOOD_RATIO_ONE + 0.5f);
}

#endif
