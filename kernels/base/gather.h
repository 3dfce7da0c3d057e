/* SPDX-License-Identifier: BSD-3-Clause
 * Loads from a place a lane, beside what packet.h has. Lanes outside the mask read nothing and get 0. */
#ifndef STRATUS_GATHER_H
#define STRATUS_GATHER_H

#include "packet.h"

/* Four bytes from base + at[lane], whatever the alignment; and the int base[at[lane]]. */
#if STRATUS_WIDTH == 1
#ifdef STRATUS_DEVICE
INLINE vint v_gather_bytes(GLOBAL const uchar* base, vint at, vmask mask)
{
  return mask ? (int)((uint)base[at] | (uint)base[at + 1] << 8 | (uint)base[at + 2] << 16 | (uint)base[at + 3] << 24) : 0;
}
#else
INLINE vint v_gather_bytes(const uchar* base, vint at, vmask mask)
{
  int value = 0;
  if (mask) {
    memcpy(&value, base + at, sizeof value);
  }
  return value;
}
#endif
INLINE vint v_gather_ints(GLOBAL const int* base, vint at, vmask mask) { return mask ? base[at] : 0; }
INLINE vmask vi_outside(vint a, vint n) { return -((uint)a >= (uint)n); }
INLINE vmask vi_zero(vint a) { return -(a == 0); }

#elif defined(STRATUS_DEVICE)
#ifdef STRATUS_DEVICE_AVX512
INLINE vint v_gather_bytes(GLOBAL const uchar* base, vint at, vmask mask) { return STRATUS_GATHER(base, at, mask, 1); }
INLINE vint v_gather_ints(GLOBAL const int* base, vint at, vmask mask) { return STRATUS_GATHER(base, at, mask, 4); }
INLINE vmask vi_zero(vint a) { return STRATUS_COMPARE_INT(a, (int16)(0), 0); }
#else
INLINE vint v_gather_bytes(GLOBAL const uchar* base, vint at, vmask mask)
{
  int place[16], on[16], value[16];
  vstore16(at, 0, place);
  vstore16(mask, 0, on);
  for (int lane = 0; lane < 16; ++lane) {
    GLOBAL const uchar* from = base + place[lane];
    value[lane] = on[lane] ? (int)((uint)from[0] | (uint)from[1] << 8 | (uint)from[2] << 16 | (uint)from[3] << 24) : 0;
  }
  return vload16(0, value);
}
INLINE vint v_gather_ints(GLOBAL const int* base, vint at, vmask mask)
{
  int place[16], on[16], value[16];
  vstore16(at, 0, place);
  vstore16(mask, 0, on);
  for (int lane = 0; lane < 16; ++lane) {
    value[lane] = on[lane] ? base[place[lane]] : 0;
  }
  return vload16(0, value);
}
INLINE vmask vi_zero(vint a) { return a == (int16)(0); }
#endif
INLINE vmask vi_outside(vint a, vint n) { return vi_lt(a, vi_set(0)) | vi_ge(a, n); }

#elif STRATUS_ISA == 2
INLINE vint v_gather_bytes(const uchar* base, vint at, vmask mask)
{
  return (vint)_mm512_mask_i32gather_epi32(_mm512_setzero_si512(), mask, (__m512i)at, base, 1);
}
INLINE vint v_gather_ints(const int* base, vint at, vmask mask)
{
  return (vint)_mm512_mask_i32gather_epi32(_mm512_setzero_si512(), mask, (__m512i)at, base, 4);
}
INLINE vmask vi_outside(vint a, vint n) { return _mm512_cmpge_epu32_mask((__m512i)a, (__m512i)n); }
INLINE vmask vi_zero(vint a) { return _mm512_testn_epi32_mask((__m512i)a, (__m512i)a); }

#else
#if STRATUS_ISA == 1
INLINE vint v_gather_bytes(const uchar* base, vint at, vmask mask)
{
  return (vint)_mm256_mask_i32gather_epi32(_mm256_setzero_si256(), (const int*)(const void*)base, (__m256i)at, (__m256i)mask, 1);
}
INLINE vint v_gather_ints(const int* base, vint at, vmask mask)
{
  return (vint)_mm256_mask_i32gather_epi32(_mm256_setzero_si256(), base, (__m256i)at, (__m256i)mask, 4);
}
#else
INLINE vint v_gather_bytes(const uchar* base, vint at, vmask mask)
{
  vint r = { 0 };
  VEC_EACH
  {
    int value = 0;
    if (mask[lane]) {
      memcpy(&value, base + at[lane], sizeof value);
    }
    r[lane] = value;
  }
  return r;
}
INLINE vint v_gather_ints(const int* base, vint at, vmask mask)
{
  vint r = { 0 };
  VEC_EACH r[lane] = mask[lane] ? base[at[lane]] : 0;
  return r;
}
#endif
INLINE vmask vi_outside(vint a, vint n) { return vi_lt(a, vi_set(0)) | vi_ge(a, n); }
INLINE vmask vi_zero(vint a) { return (vmask)(a == vi_set(0)); }
#endif

#endif
