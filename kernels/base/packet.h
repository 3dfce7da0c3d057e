/* SPDX-License-Identifier: BSD-3-Clause
 * The vector types and operations that traversal is written in. A packet holds STRATUS_WIDTH rays, one in each lane.
 *
 *   C11      STRATUS_ISA 2: 16 lanes of AVX-512; 1: 8 lanes of AVX2; 0: 4 lanes of the compiler's vectors; STRATUS_WIDTH 1: scalar
 *   OpenCL C STRATUS_DEVICE, STRATUS_WIDTH 16 (a CPU: a packet a work item) or 1 (a GPU: one ray a work item)
 *
 * vfloat, vint and vmask hold a lane a ray. Masks combine by & and |, and m_andnot. Every function here is a single correctly rounded
 * operation, or a selection, so that all dialects give the same bits. v_min and v_max give b where a or b is a NaN. */
#ifndef STRATUS_PACKET_H
#define STRATUS_PACKET_H

#ifdef STRATUS_DEVICE
#pragma OPENCL FP_CONTRACT OFF
#define GLOBAL __global
#define CONSTANT __constant
#define INLINE static inline
#define OUTLINE static __attribute__((unused))
#ifndef STRATUS_WIDTH
#define STRATUS_WIDTH 1
#endif
/* A work item that holds a packet fills the vectors already. Some compilers, such as Intel's for CPUs, would spread a kernel over many work
 * items a vector. The hint prevents this: 16 items of 16 lanes each would need ten times as long. */
#if STRATUS_WIDTH == 16
#define PACKET_KERNEL __kernel __attribute__((vec_type_hint(float16)))
#else
#define PACKET_KERNEL __kernel
#endif
#else
#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>
#define GLOBAL
#define CONSTANT const
#define INLINE static inline __attribute__((always_inline))
/* Of long functions that few rays come to, or that several places call: they are not inlined on the host, where each copy would take its
 * time to compile. Not every file needs each. */
#define OUTLINE static __attribute__((noinline, unused))
typedef unsigned char uchar;
typedef unsigned short ushort;
typedef unsigned int uint;
#ifndef STRATUS_ISA
#define STRATUS_ISA 0
#endif
#ifndef STRATUS_WIDTH
#define STRATUS_WIDTH (STRATUS_ISA == 2 ? 16 : STRATUS_ISA == 1 ? 8 : 4)
#endif
#endif

/* A packet covers PACKET_X by PACKET_Y pixels. */
#if STRATUS_WIDTH == 16
#define PACKET_X 4
#define PACKET_X_LOG2 2
#elif STRATUS_WIDTH == 8
#define PACKET_X 4
#define PACKET_X_LOG2 2
#elif STRATUS_WIDTH == 4
#define PACKET_X 2
#define PACKET_X_LOG2 1
#elif STRATUS_WIDTH == 1
#define PACKET_X 1
#define PACKET_X_LOG2 0
#else
#error "STRATUS_WIDTH must be 1, 4, 8 or 16"
#endif
#define PACKET_Y (STRATUS_WIDTH / PACKET_X)

#define LARGEST_FLOAT 3.402823466e+38f

/* ------------------------------------------------------------------------------------------------ scalar, either language */
#if STRATUS_WIDTH == 1
typedef float vfloat;
typedef int vint;
typedef int vmask;

INLINE vfloat v_set(float a) { return a; }
INLINE vint vi_set(int a) { return a; }
INLINE vint vi_lanes(void) { return 0; }
INLINE vfloat v_fma(vfloat a, vfloat b, vfloat c)
{
#ifdef STRATUS_DEVICE
  return fma(a, b, c);
#else
  return fmaf(a, b, c);
#endif
}
INLINE vfloat v_min(vfloat a, vfloat b) { return a < b ? a : b; }
INLINE vfloat v_max(vfloat a, vfloat b) { return a > b ? a : b; }
INLINE vint vi_min(vint a, vint b) { return a < b ? a : b; }
INLINE vint vi_max(vint a, vint b) { return a > b ? a : b; }
INLINE vmask v_lt(vfloat a, vfloat b) { return -(a < b); }
INLINE vmask v_le(vfloat a, vfloat b) { return -(a <= b); }
INLINE vmask vi_lt(vint a, vint b) { return -(a < b); }
INLINE vmask vi_ge(vint a, vint b) { return -(a >= b); }
INLINE vfloat v_select(vmask m, vfloat a, vfloat b) { return m ? a : b; }
INLINE vint vi_select(vmask m, vint a, vint b) { return m ? a : b; }
INLINE vmask m_andnot(vmask a, vmask b) { return a & ~b; }
INLINE vmask m_none(void) { return 0; }
INLINE int m_any(vmask m) { return m; }
INLINE int m_count(vmask m) { return m ? 1 : 0; }
INLINE vfloat v_from_int(vint a) { return (float)a; }
INLINE vint v_to_int(vfloat a) { return (int)a; }
#ifdef STRATUS_DEVICE
INLINE vfloat v_from_bits(vint a) { return as_float(a); }
INLINE vint v_to_bits(vfloat a) { return as_int(a); }
#else
INLINE vfloat v_from_bits(vint a)
{
  float f;
  memcpy(&f, &a, sizeof f);
  return f;
}
INLINE vint v_to_bits(vfloat a)
{
  int i;
  memcpy(&i, &a, sizeof i);
  return i;
}
#endif
INLINE void v_store(float* p, vfloat a) { *p = a; }
INLINE void vi_store(int* p, vint a) { *p = a; }
INLINE vfloat v_load(const float* p) { return *p; }
INLINE vint vi_load(const int* p) { return *p; }

/* ------------------------------------------------------------------------------------------------ OpenCL, 16 lanes */
#elif defined(STRATUS_DEVICE)
typedef float16 vfloat;
typedef int16 vint;

#if defined(__AVX512F__) && __has_builtin(__builtin_ia32_cmpps512_mask) && __has_builtin(__builtin_ia32_cmpd512_mask) &&                   \
  __has_builtin(__builtin_ia32_minps512) && __has_builtin(__builtin_ia32_maxps512) && __has_builtin(__builtin_ia32_selectps_512) &&        \
  __has_builtin(__builtin_ia32_selectd_512) && __has_builtin(__builtin_ia32_gathersiv16si)
/* OpenCL C has no type for a mask register and no gather, so that PoCL on a CPU with AVX-512 uses clang's builtins. */
#define STRATUS_DEVICE_AVX512 1
#endif

#ifdef STRATUS_DEVICE_AVX512
typedef ushort vmask;
typedef int stratus_i16 __attribute__((__vector_size__(64)));
typedef float stratus_f16 __attribute__((__vector_size__(64)));
typedef long stratus_l8 __attribute__((__vector_size__(64)));
typedef int stratus_i8 __attribute__((__vector_size__(32)));
#define STRATUS_I16(a) __builtin_astype((a), stratus_i16)
#define STRATUS_F16(a) __builtin_astype((a), stratus_f16)
#define STRATUS_COMPARE_FLOAT(a, b, what) ((ushort)__builtin_ia32_cmpps512_mask(STRATUS_F16(a), STRATUS_F16(b), what, (ushort)0xffff, 4))
#define STRATUS_COMPARE_INT(a, b, what) ((ushort)__builtin_ia32_cmpd512_mask(STRATUS_I16(a), STRATUS_I16(b), what, (ushort)0xffff))
/* 16 ints from base + scale*index, 0 in other lanes; scale is a literal. */
#define STRATUS_GATHER(base, index, mask, scale)                                                                                           \
  __builtin_astype(                                                                                                                        \
    __builtin_ia32_gathersiv16si(STRATUS_I16((int16)(0)), (const void*)(uintptr_t)(base), STRATUS_I16(index), mask, scale), int16)
/* 8 longs from base + scale*index, 0 in other lanes. */
#define STRATUS_GATHER_LONG(base, index, mask, scale)                                                                                      \
  __builtin_astype(__builtin_ia32_gathersiv8di(__builtin_astype((long8)(0), stratus_l8), (const void*)(uintptr_t)(base),                   \
                     __builtin_astype((index), stratus_i8), mask, scale),                                                                  \
    int16)
INLINE vmask v_lt(vfloat a, vfloat b) { return STRATUS_COMPARE_FLOAT(a, b, 0x11); }
INLINE vmask v_le(vfloat a, vfloat b) { return STRATUS_COMPARE_FLOAT(a, b, 0x12); }
INLINE vmask vi_lt(vint a, vint b) { return STRATUS_COMPARE_INT(a, b, 1); }
INLINE vmask vi_ge(vint a, vint b) { return STRATUS_COMPARE_INT(a, b, 5); }
INLINE vfloat v_select(vmask m, vfloat a, vfloat b)
{
  return __builtin_astype(__builtin_ia32_selectps_512(m, STRATUS_F16(a), STRATUS_F16(b)), float16);
}
INLINE vint vi_select(vmask m, vint a, vint b)
{
  return __builtin_astype(__builtin_ia32_selectd_512(m, STRATUS_I16(a), STRATUS_I16(b)), int16);
}
INLINE vfloat v_min(vfloat a, vfloat b) { return __builtin_astype(__builtin_ia32_minps512(STRATUS_F16(a), STRATUS_F16(b), 4), float16); }
INLINE vfloat v_max(vfloat a, vfloat b) { return __builtin_astype(__builtin_ia32_maxps512(STRATUS_F16(a), STRATUS_F16(b), 4), float16); }
INLINE vmask m_andnot(vmask a, vmask b) { return (ushort)(a & ~b); }
INLINE vmask m_none(void) { return 0; }
INLINE int m_any(vmask m) { return m != 0; }
INLINE int m_count(vmask m) { return (int)popcount((uint)m); }
#else
typedef int16 vmask;
INLINE vmask v_lt(vfloat a, vfloat b) { return a < b; }
INLINE vmask v_le(vfloat a, vfloat b) { return a <= b; }
INLINE vmask vi_lt(vint a, vint b) { return a < b; }
INLINE vmask vi_ge(vint a, vint b) { return a >= b; }
INLINE vfloat v_select(vmask m, vfloat a, vfloat b) { return m ? a : b; }
INLINE vint vi_select(vmask m, vint a, vint b) { return m ? a : b; }
INLINE vfloat v_min(vfloat a, vfloat b) { return v_select(v_lt(a, b), a, b); }
INLINE vfloat v_max(vfloat a, vfloat b) { return v_select(v_lt(b, a), a, b); }
INLINE vmask m_andnot(vmask a, vmask b) { return a & ~b; }
INLINE vmask m_none(void) { return (int16)(0); }
INLINE int m_any(vmask m) { return any(m); }
INLINE int m_count(vmask m)
{
  const int8 a = m.lo + m.hi;
  const int4 b = a.lo + a.hi;
  const int2 c = b.lo + b.hi;
  return -(c.x + c.y);
}
#endif

INLINE vfloat v_set(float a) { return (float16)(a); }
INLINE vint vi_set(int a) { return (int16)(a); }
INLINE vint vi_lanes(void) { return (int16)(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15); }
INLINE vfloat v_fma(vfloat a, vfloat b, vfloat c) { return fma(a, b, c); }
INLINE vint vi_min(vint a, vint b) { return min(a, b); }
INLINE vint vi_max(vint a, vint b) { return max(a, b); }
INLINE vfloat v_from_int(vint a) { return convert_float16(a); }
INLINE vint v_to_int(vfloat a) { return convert_int16(a); }
INLINE vfloat v_from_bits(vint a) { return as_float16(a); }
INLINE vint v_to_bits(vfloat a) { return as_int16(a); }
INLINE void v_store(float* p, vfloat a) { vstore16(a, 0, p); }
INLINE void vi_store(int* p, vint a) { vstore16(a, 0, p); }
INLINE vfloat v_load(const float* p) { return vload16(0, p); }
INLINE vint vi_load(const int* p) { return vload16(0, p); }

/* ------------------------------------------------------------------------------------------------ C, AVX-512 */
#elif STRATUS_ISA == 2
#include <immintrin.h>
typedef __m512 vfloat;
typedef int vint __attribute__((vector_size(64), may_alias));
typedef __mmask16 vmask;

INLINE vfloat v_set(float a) { return _mm512_set1_ps(a); }
INLINE vint vi_set(int a) { return (vint)_mm512_set1_epi32(a); }
INLINE vint vi_lanes(void) { return (vint){ 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15 }; }
INLINE vfloat v_fma(vfloat a, vfloat b, vfloat c) { return _mm512_fmadd_ps(a, b, c); }
INLINE vfloat v_min(vfloat a, vfloat b) { return _mm512_min_ps(a, b); }
INLINE vfloat v_max(vfloat a, vfloat b) { return _mm512_max_ps(a, b); }
INLINE vint vi_min(vint a, vint b) { return (vint)_mm512_min_epi32((__m512i)a, (__m512i)b); }
INLINE vint vi_max(vint a, vint b) { return (vint)_mm512_max_epi32((__m512i)a, (__m512i)b); }
INLINE vmask v_lt(vfloat a, vfloat b) { return _mm512_cmp_ps_mask(a, b, _CMP_LT_OQ); }
INLINE vmask v_le(vfloat a, vfloat b) { return _mm512_cmp_ps_mask(a, b, _CMP_LE_OQ); }
INLINE vmask vi_lt(vint a, vint b) { return _mm512_cmplt_epi32_mask((__m512i)a, (__m512i)b); }
INLINE vmask vi_ge(vint a, vint b) { return _mm512_cmpge_epi32_mask((__m512i)a, (__m512i)b); }
INLINE vfloat v_select(vmask m, vfloat a, vfloat b) { return _mm512_mask_mov_ps(b, m, a); }
INLINE vint vi_select(vmask m, vint a, vint b) { return (vint)_mm512_mask_mov_epi32((__m512i)b, m, (__m512i)a); }
INLINE vmask m_andnot(vmask a, vmask b) { return (vmask)(a & (vmask)~b); }
INLINE vmask m_none(void) { return 0; }
INLINE int m_any(vmask m) { return m != 0; }
INLINE int m_count(vmask m) { return __builtin_popcount(m); }
INLINE vfloat v_from_int(vint a) { return _mm512_cvtepi32_ps((__m512i)a); }
INLINE vint v_to_int(vfloat a) { return (vint)_mm512_cvttps_epi32(a); }
INLINE vfloat v_from_bits(vint a) { return _mm512_castsi512_ps((__m512i)a); }
INLINE vint v_to_bits(vfloat a) { return (vint)_mm512_castps_si512(a); }
INLINE void v_store(float* p, vfloat a) { _mm512_storeu_ps(p, a); }
INLINE void vi_store(int* p, vint a) { _mm512_storeu_si512(p, (__m512i)a); }
INLINE vfloat v_load(const float* p) { return _mm512_loadu_ps(p); }
INLINE vint vi_load(const int* p) { return (vint)_mm512_loadu_si512(p); }

/* ------------------------------------------------------------------------------------------------ C, compiler vectors */
#else
#if STRATUS_ISA == 1
#include <immintrin.h>
#endif
typedef float vfloat __attribute__((vector_size(4 * STRATUS_WIDTH), may_alias));
typedef int vint __attribute__((vector_size(4 * STRATUS_WIDTH), may_alias));
typedef vint vmask;

#define VEC_EACH for (int lane = 0; lane < STRATUS_WIDTH; ++lane)

INLINE vfloat v_set(float a) { return a - (vfloat){ 0 }; }
INLINE vint vi_set(int a) { return a - (vint){ 0 }; }
INLINE vint vi_lanes(void)
{
  vint r = { 0 };
  VEC_EACH r[lane] = lane;
  return r;
}
INLINE vint vi_select(vmask m, vint a, vint b) { return (a & m) | (b & ~m); }
INLINE vfloat v_select(vmask m, vfloat a, vfloat b) { return (vfloat)vi_select(m, (vint)a, (vint)b); }
INLINE vmask v_lt(vfloat a, vfloat b) { return (vmask)(a < b); }
INLINE vmask v_le(vfloat a, vfloat b) { return (vmask)(a <= b); }
INLINE vmask vi_lt(vint a, vint b) { return (vmask)(a < b); }
INLINE vmask vi_ge(vint a, vint b) { return (vmask)(a >= b); }
INLINE vint vi_min(vint a, vint b) { return vi_select(vi_lt(a, b), a, b); }
INLINE vint vi_max(vint a, vint b) { return vi_select(vi_lt(b, a), a, b); }
#if STRATUS_ISA == 1
INLINE vfloat v_fma(vfloat a, vfloat b, vfloat c) { return (vfloat)_mm256_fmadd_ps((__m256)a, (__m256)b, (__m256)c); }
INLINE vfloat v_min(vfloat a, vfloat b) { return (vfloat)_mm256_min_ps((__m256)a, (__m256)b); }
INLINE vfloat v_max(vfloat a, vfloat b) { return (vfloat)_mm256_max_ps((__m256)a, (__m256)b); }
INLINE int m_bits(vmask m) { return _mm256_movemask_ps((__m256)m); }
INLINE int m_any(vmask m) { return m_bits(m) != 0; }
INLINE int m_count(vmask m) { return __builtin_popcount((unsigned)m_bits(m)); }
#else
INLINE vfloat v_fma(vfloat a, vfloat b, vfloat c)
{
  vfloat r = { 0 };
  VEC_EACH r[lane] = fmaf(a[lane], b[lane], c[lane]);
  return r;
}
INLINE vfloat v_min(vfloat a, vfloat b) { return v_select(v_lt(a, b), a, b); }
INLINE vfloat v_max(vfloat a, vfloat b) { return v_select(v_lt(b, a), a, b); }
INLINE int m_count(vmask m)
{
  int n = 0;
  VEC_EACH n -= m[lane];
  return n;
}
INLINE int m_any(vmask m)
{
  int n = 0;
  VEC_EACH n |= m[lane];
  return n;
}
#endif
INLINE vmask m_andnot(vmask a, vmask b) { return a & ~b; }
INLINE vmask m_none(void) { return vi_set(0); }
INLINE vfloat v_from_int(vint a) { return __builtin_convertvector(a, vfloat); }
INLINE vint v_to_int(vfloat a) { return __builtin_convertvector(a, vint); }
INLINE vfloat v_from_bits(vint a) { return (vfloat)a; }
INLINE vint v_to_bits(vfloat a) { return (vint)a; }
INLINE void v_store(float* p, vfloat a) { memcpy(p, &a, sizeof a); }
INLINE void vi_store(int* p, vint a) { memcpy(p, &a, sizeof a); }
INLINE vfloat v_load(const float* p)
{
  vfloat r;
  memcpy(&r, p, sizeof r);
  return r;
}
INLINE vint vi_load(const int* p)
{
  vint r;
  memcpy(&r, p, sizeof r);
  return r;
}
#endif

/* How many packets march side by side. AVX-512 has registers for two, and one computes while the other waits for its gathers. */
#if STRATUS_WIDTH == 16 && (defined(STRATUS_DEVICE) ? defined(STRATUS_DEVICE_AVX512) : STRATUS_ISA == 2)
#define PACKETS_TOGETHER 2
#else
#define PACKETS_TOGETHER 1
#endif

INLINE vfloat v_clamp(vfloat a, float lo, float hi) { return v_min(v_max(a, v_set(lo)), v_set(hi)); }
INLINE vfloat v_abs(vfloat a) { return v_from_bits(v_to_bits(a) & vi_set(0x7fffffff)); }
INLINE vmask v_finite(vfloat a) { return v_le(v_abs(a), v_set(LARGEST_FLOAT)); }
INLINE vfloat v_lerp(vfloat a, vfloat b, vfloat t) { return v_fma(t, b - a, a); }

#endif
