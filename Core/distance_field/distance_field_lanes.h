/* SPDX-License-Identifier: BSD-3-Clause
 * Lanes of squared distances for distance_field_body.h. A lane has FIELD_BITS bits (16, 32 or 64), and a vector as many lanes as a register
 * of FIELD_ISA holds (2: AVX-512, 1: AVX2, 0: any). This file is included once for each pair. Every function carries both numbers in its
 * name, and as an attribute the instruction set that it may use, so that no file needs compiler flags of its own. Only the minimum and the
 * test for a positive lane are written as intrinsics: the compiler finds the others. */
#define FIELD_JOIN3(name, bits, isa) name##_##bits##_##isa
#define FIELD_JOIN(name, bits, isa) FIELD_JOIN3(name, bits, isa)
#define NAME(name) FIELD_JOIN(name, FIELD_BITS, FIELD_ISA)

#if FIELD_ISA == 2
#define FIELD_TARGET TARGET_AVX512
#define VECTOR_BYTES 64
#elif FIELD_ISA == 1
#define FIELD_TARGET TARGET_AVX2
#define VECTOR_BYTES 32
#else
#define FIELD_TARGET
#define VECTOR_BYTES 16
#endif
#define FIELD_INLINE static ALWAYS_INLINE FIELD_TARGET

/* FAR is the squared distance that means "none known", and FAR_LINE is its root. Sums of squares up to FAR fit a lane. */
#if FIELD_BITS == 16
#define VALUE int16_t
#define FAR_LINE FIELD_FAR_LINE_16
#elif FIELD_BITS == 32
#define VALUE int32_t
#define FAR_LINE FIELD_FAR_LINE_32
#else
#define VALUE int64_t
#define FAR_LINE FIELD_FAR_LINE_64
#endif
#define FAR ((VALUE)((int64_t)FAR_LINE * FAR_LINE))
#define LANES (VECTOR_BYTES * 8 / FIELD_BITS)

typedef VALUE NAME(vector) __attribute__((vector_size(VECTOR_BYTES), may_alias));
typedef VALUE NAME(loose) __attribute__((vector_size(VECTOR_BYTES), may_alias, aligned(FIELD_BITS / 8)));
typedef int64_t NAME(longs) __attribute__((vector_size(VECTOR_BYTES), may_alias));
#define vector NAME(vector)

FIELD_INLINE vector NAME(load)(const VALUE* p)
{
  return *(const NAME(loose)*)p;
}

FIELD_INLINE void NAME(store)(VALUE* p, vector a)
{
  *(NAME(loose)*)p = a;
}

FIELD_INLINE vector NAME(all)(VALUE a)
{
  return a - (vector){ 0 };
}

/* Returns a where the mask's lanes are -1, b where they are 0. */
FIELD_INLINE vector NAME(select)(vector mask, vector a, vector b)
{
  return (a & mask) | (b & ~mask);
}

FIELD_INLINE vector NAME(least)(vector a, vector b)
{
#if FIELD_ISA == 2 && FIELD_BITS == 16
  return (vector)_mm512_min_epi16((__m512i)a, (__m512i)b);
#elif FIELD_ISA == 2
  return (vector)_mm512_min_epi32((__m512i)a, (__m512i)b);
#elif FIELD_ISA == 1 && FIELD_BITS == 16
  return (vector)_mm256_min_epi16((__m256i)a, (__m256i)b);
#elif FIELD_ISA == 1
  return (vector)_mm256_min_epi32((__m256i)a, (__m256i)b);
#else
  return NAME(select)((vector)(a < b), a, b);
#endif
}

/* True if any lane is above 0. */
FIELD_INLINE int NAME(positive)(vector a)
{
#if FIELD_ISA == 2 && FIELD_BITS == 16
  return _mm512_cmpgt_epi16_mask((__m512i)a, _mm512_setzero_si512()) != 0;
#elif FIELD_ISA == 2
  return _mm512_cmpgt_epi32_mask((__m512i)a, _mm512_setzero_si512()) != 0;
#elif FIELD_ISA == 1
  return _mm256_movemask_epi8((__m256i)(a > 0)) != 0;
#else
  const NAME(longs) set = (NAME(longs))(a > 0);
  return (set[0] | set[1]) != 0;
#endif
}

/* Negates a where the mask's lanes are -1. */
FIELD_INLINE vector NAME(flip)(vector a, vector mask)
{
  return (a ^ mask) - mask;
}

/* Lane i is -1 where bit first + i of a row of bits is set. `first` is a multiple of LANES. */
FIELD_INLINE vector NAME(spread_bits)(const uint64_t* bits, int64_t first)
{
  const uint64_t word = bits[first >> 6] >> (first & 63);
#if FIELD_ISA == 2 && FIELD_BITS == 16
  return (vector)_mm512_movm_epi16((__mmask32)word);
#elif FIELD_ISA == 2
  return (vector)_mm512_movm_epi32((__mmask16)word);
#elif FIELD_BITS == 64
  return -((vector){ (int64_t)(word & 1), (int64_t)(word >> 1 & 1) });
#else
  vector mine = { 0 };
  for (int i = 0; i < LANES; ++i) {
    mine[i] = (VALUE)(1u << i); /* the compiler folds this into a constant */
  }
  return (vector)((NAME(all)((VALUE)(word & ((1u << LANES) - 1))) & mine) != 0);
#endif
}
