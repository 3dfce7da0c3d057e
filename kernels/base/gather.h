/* SPDX-License-Identifier: BSD-3-Clause
 * More gathers than packet.h has: each lane loads from an index of its own. A lane outside the mask reads nothing and gets 0. */
#ifndef STRATUS_GATHER_H
#define STRATUS_GATHER_H

#include "packet.h"

/* v_gather_bytes loads four bytes at base + at[lane], which need not be aligned; v_gather_ints loads base[at[lane]]. vi_outside returns the
 * lanes whose a is not in 0..n-1, vi_zero the lanes whose a is 0. */
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

#if !defined(STRATUS_DEVICE) && STRATUS_ISA > 0 && STRATUS_WIDTH > 1
#define LANES_LOAD 1
/* Where each lane loads from. On some processors loads one by one are ahead of the gather instructions wherever a lane wants two or more
 * neighbours: these carry a gather out as many loads, one gather after another, so that misses of the caches do not overlap. On others
 * gathers are ahead (STRATUS_GATHERS, see instruction_set.h). */
typedef struct lane_places {
  _Alignas(64) uint32_t at[STRATUS_WIDTH];
} lane_places;

/* Lanes outside the mask load from 0. The compiler is kept from taking the places out of the register one by one, which costs more than to
 * load them from memory. */
INLINE void lane_places_of(vint index, vmask mask, lane_places* places)
{
  vi_store((int*)places->at, vi_select(mask, index, vi_set(0)));
#ifdef __GNUC__
  __asm__("" : "+m"(*places));
#endif
}

/* Joins the four values each of lanes j, j + 4, ... */
INLINE vfloat join_quads(const __m128 quad[STRATUS_WIDTH / 4])
{
#if STRATUS_ISA == 2
  const __m256 low = _mm256_insertf128_ps(_mm256_castps128_ps256(quad[0]), quad[1], 1),
               high = _mm256_insertf128_ps(_mm256_castps128_ps256(quad[2]), quad[3], 1);
  return _mm512_insertf32x8(_mm512_castps256_ps512(low), high, 1);
#else
  return (vfloat)_mm256_insertf128_ps(_mm256_castps128_ps256(quad[0]), quad[1], 1);
#endif
}

#if STRATUS_ISA == 2
#define QUAD_LOW(a, b) _mm512_unpacklo_ps(a, b)
#define QUAD_HIGH(a, b) _mm512_unpackhi_ps(a, b)
#define QUAD_JOIN(a, b, places) _mm512_shuffle_ps(a, b, places)
#else
#define QUAD_LOW(a, b) (vfloat) _mm256_unpacklo_ps((__m256)(a), (__m256)(b))
#define QUAD_HIGH(a, b) (vfloat) _mm256_unpackhi_ps((__m256)(a), (__m256)(b))
#define QUAD_JOIN(a, b, places) (vfloat) _mm256_shuffle_ps((__m256)(a), (__m256)(b), places)
#endif

/* joined[j] holds the four values each of lanes j, j + 4, ...; out[c] is value c of every lane. */
INLINE void transpose_quads(const vfloat joined[4], vfloat out[4])
{
  const vfloat a = QUAD_LOW(joined[0], joined[1]), b = QUAD_HIGH(joined[0], joined[1]), c = QUAD_LOW(joined[2], joined[3]),
               d = QUAD_HIGH(joined[2], joined[3]);
  out[0] = QUAD_JOIN(a, c, 0x44);
  out[1] = QUAD_JOIN(a, c, 0xee);
  out[2] = QUAD_JOIN(b, d, 0x44);
  out[3] = QUAD_JOIN(b, d, 0xee);
}
#undef QUAD_LOW
#undef QUAD_HIGH
#undef QUAD_JOIN
#endif

#if !defined(STRATUS_DEVICE) && STRATUS_ISA == 2 && STRATUS_WIDTH == 16
/* out: the ints at base + scale * index, and those behind them; scale is a literal. */
#define GATHER_TWO(base, index, mask, scale, out)                                                                                          \
  gather_apart(_mm512_mask_i32gather_epi64(                                                                                                \
                 _mm512_setzero_si512(), (__mmask8)(mask), _mm512_castsi512_si256((__m512i)(index)), (const void*)(base), scale),          \
    _mm512_mask_i32gather_epi64(                                                                                                           \
      _mm512_setzero_si512(), (__mmask8)((mask) >> 8), _mm512_extracti64x4_epi64((__m512i)(index), 1), (const void*)(base), scale),        \
    out)
INLINE void gather_apart(__m512i low, __m512i high, vint out[2])
{
  const __m512i even = _mm512_setr_epi32(0, 2, 4, 6, 8, 10, 12, 14, 16, 18, 20, 22, 24, 26, 28, 30);
  const __m512i odd = _mm512_setr_epi32(1, 3, 5, 7, 9, 11, 13, 15, 17, 19, 21, 23, 25, 27, 29, 31);
  out[0] = (vint)_mm512_permutex2var_epi32(low, even, high);
  out[1] = (vint)_mm512_permutex2var_epi32(low, odd, high);
}
#endif

/* The four floats from table[4 entry] on, bit by bit as they are. */
INLINE void gather_four(GLOBAL const float* table, vint entry, vmask mask, vfloat out[4])
{
#if STRATUS_WIDTH == 1
  for (int c = 0; c < 4; ++c) {
    out[c] = mask ? table[4 * entry + c] : 0.0f;
  }
#elif defined(STRATUS_DEVICE) && defined(STRATUS_DEVICE_AVX512)
  const int16 twice = entry + entry;
  for (int c = 0; c < 4; c += 2) {
    const int16 low = STRATUS_GATHER_LONG(table + c, twice.lo, (uchar)mask, 8),
                high = STRATUS_GATHER_LONG(table + c, twice.hi, (uchar)(mask >> 8), 8);
    out[c] = as_float16((int16)(low.even, high.even));
    out[c + 1] = as_float16((int16)(low.odd, high.odd));
  }
#elif defined(STRATUS_GATHERS)
  const vint twice = entry + entry;
  for (int c = 0; c < 4; c += 2) {
    vint two[2];
    GATHER_TWO(table + c, twice, mask, 8, two);
    out[c] = v_from_bits(two[0]);
    out[c + 1] = v_from_bits(two[1]);
  }
#elif defined(LANES_LOAD)
  lane_places places;
  vfloat joined[4];
  lane_places_of(entry << vi_set(2), mask, &places);
  for (int j = 0; j < 4; ++j) {
    __m128 quad[STRATUS_WIDTH / 4];
    for (int i = 0; i < STRATUS_WIDTH / 4; ++i) {
      quad[i] = _mm_loadu_ps(table + places.at[4 * i + j]);
    }
    joined[j] = join_quads(quad);
  }
  transpose_quads(joined, out);
  for (int c = 0; c < 4; ++c) {
    out[c] = v_select(mask, out[c], v_set(0.0f));
  }
#else
  int li[STRATUS_WIDTH];
  float lv[4][STRATUS_WIDTH];
  vi_store(li, vi_select(mask, entry, vi_set(-1)));
  for (int lane = 0; lane < STRATUS_WIDTH; ++lane) {
    for (int c = 0; c < 4; ++c) {
      lv[c][lane] = li[lane] >= 0 ? table[4 * li[lane] + c] : 0.0f;
    }
  }
  for (int c = 0; c < 4; ++c) {
    out[c] = v_load(lv[c]);
  }
#endif
}

/* The four ints from table[4 entry] on. */
INLINE void gather_four_ints(GLOBAL const int* table, vint entry, vmask mask, vint out[4])
{
#if STRATUS_WIDTH == 1
  for (int c = 0; c < 4; ++c) {
    out[c] = mask ? table[4 * entry + c] : 0;
  }
#elif defined(LANES_LOAD) || defined(STRATUS_DEVICE_AVX512)
  vfloat bits[4];
  gather_four((GLOBAL const float*)table, entry, mask, bits);
  for (int c = 0; c < 4; ++c) {
    out[c] = v_to_bits(bits[c]);
  }
#else
  const vint at = entry << vi_set(2);
  for (int c = 0; c < 4; ++c) {
    out[c] = v_gather_ints(table + c, at, mask);
  }
#endif
}

/* The int table[index]. */
INLINE vint gather_int32(GLOBAL const int* table, vint index, vmask mask)
{
#if STRATUS_WIDTH == 1
  return mask ? table[index] : 0;
#elif defined(STRATUS_DEVICE) && defined(STRATUS_DEVICE_AVX512)
  return STRATUS_GATHER(table, index, mask, 4);
#elif !defined(STRATUS_DEVICE) && STRATUS_ISA == 2
  return (vint)_mm512_mask_i32gather_epi32(_mm512_setzero_si512(), mask, (__m512i)index, table, 4);
#else
  int li[STRATUS_WIDTH], lv[STRATUS_WIDTH];
  vi_store(li, vi_select(mask, index, vi_set(-1)));
  for (int lane = 0; lane < STRATUS_WIDTH; ++lane) {
    lv[lane] = li[lane] >= 0 ? table[li[lane]] : 0;
  }
  return vi_load(lv);
#endif
}

/* What AVX-512 has an instruction for. GATHER_FLOAT loads a float, GATHER_DWORD four bytes at base + (index << scale_log2); LOGICAL_RIGHT
 * shifts to the right and fills with zeros. */
#if defined(STRATUS_DEVICE) && defined(STRATUS_DEVICE_AVX512)
#define GATHER_DWORD(base, index, mask, scale_log2) STRATUS_GATHER(base, index, mask, 1 << (scale_log2))
#define GATHER_FLOAT(base, index, mask) as_float16(STRATUS_GATHER(base, index, mask, 4))
#define LOGICAL_RIGHT(a, n) as_int16(as_uint16(a) >> as_uint16(n))
#elif !defined(STRATUS_DEVICE) && STRATUS_ISA == 2 && STRATUS_WIDTH == 16
#ifdef STRATUS_GATHERS
#define GATHER_DWORD(base, index, mask, scale_log2)                                                                                        \
  ((vint)_mm512_mask_i32gather_epi32(_mm512_setzero_si512(), (mask), (__m512i)(index), (base), 1 << (scale_log2)))
#define LOGICAL_RIGHT(a, n) ((vint)_mm512_srlv_epi32((__m512i)(a), (__m512i)(n)))
#endif
#define GATHER_FLOAT(base, index, mask) _mm512_mask_i32gather_ps(_mm512_setzero_ps(), (mask), (__m512i)(index), (base), 4)
#endif

#endif
