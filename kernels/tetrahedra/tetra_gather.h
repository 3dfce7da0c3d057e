/* SPDX-License-Identifier: BSD-3-Clause
 * Gathers of several ints or floats that lie side by side, a place for each lane: they share a cache line, and one instruction loads two.
 * A lane outside the mask reads nothing and gets 0. */
#ifndef STRATUS_TETRA_GATHER_H
#define STRATUS_TETRA_GATHER_H

#include "gather.h"

#ifdef STRATUS_DEVICE
INLINE float scalar_from_bits(int bits) { return as_float(bits); }
INLINE int scalar_bits(float value) { return as_int(value); }
#if STRATUS_WIDTH == 1
INLINE vfloat v_load_global(GLOBAL const float* p) { return *p; }
#else
INLINE vfloat v_load_global(GLOBAL const float* p) { return vload16(0, p); }
#endif
#else
INLINE float scalar_from_bits(int bits)
{
  float value;
  memcpy(&value, &bits, sizeof value);
  return value;
}
INLINE int scalar_bits(float value)
{
  int bits;
  memcpy(&bits, &value, sizeof bits);
  return bits;
}
INLINE vfloat v_load_global(const float* p) { return v_load(p); }
#endif

/* The ints base[at] and base[at + 1]. */
INLINE void gather_pair(GLOBAL const int* base, vint at, vmask mask, vint out[2])
{
#if STRATUS_WIDTH > 1 && defined(STRATUS_DEVICE) && defined(STRATUS_DEVICE_AVX512)
  const int16 low = STRATUS_GATHER_LONG(base, at.lo, (uchar)mask, 4), high = STRATUS_GATHER_LONG(base, at.hi, (uchar)(mask >> 8), 4);
  out[0] = (int16)(low.even, high.even);
  out[1] = (int16)(low.odd, high.odd);
#elif !defined(STRATUS_DEVICE) && STRATUS_WIDTH == 16
  GATHER_TWO(base, at, mask, 4, out);
#else
  out[0] = v_gather_ints(base, at, mask);
  out[1] = v_gather_ints(base, at + vi_set(1), mask);
#endif
}

/* Prefetches the cache lines of base[at], which the next step reads. */
INLINE void prefetch_ints(GLOBAL const int* base, vint at)
{
#if STRATUS_WIDTH == 16 && (!defined(STRATUS_DEVICE) || defined(STRATUS_DEVICE_AVX512))
  int place[STRATUS_WIDTH];
  vi_store(place, at);
  for (int lane = 0; lane < STRATUS_WIDTH; ++lane) {
    __builtin_prefetch((const void*)(uintptr_t)(base + place[lane]));
  }
#else
  (void)base;
  (void)at;
#endif
}

/* The float base[at]. */
INLINE vfloat gather_float(GLOBAL const float* base, vint at, vmask mask)
{
#if STRATUS_WIDTH == 16
  return v_from_bits(v_gather_ints((GLOBAL const int*)base, at, mask));
#else
  float lv[STRATUS_WIDTH];
  int li[STRATUS_WIDTH];
  vi_store(li, vi_select(mask, at, vi_set(-1)));
  for (int lane = 0; lane < STRATUS_WIDTH; ++lane) {
    lv[lane] = li[lane] >= 0 ? base[li[lane]] : 0.0f;
  }
  return v_load(lv);
#endif
}

#endif
