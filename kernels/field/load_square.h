/* SPDX-License-Identifier: BSD-3-Clause
 * Loads four values of a volume as floats, where a lane's values are loaded one by one (LANES_LOAD). */
#ifndef STRATUS_LOAD_SQUARE_H
#define STRATUS_LOAD_SQUARE_H

#include "gather.h"

#ifdef LANES_LOAD
/* The floats of two neighbours at `low`, and of two at `high`. type: a stratus_type whose fetch is compiled, known when this is. bias: of
 * doubles, which are relative to it. */
INLINE __m128 load_square(int type, double bias, const void* low, const void* high)
{
  if (type == 8) {
    return _mm_loadh_pi(_mm_castsi128_ps(_mm_loadl_epi64((const __m128i*)low)), (const __m64*)high);
  }
  if (type == 9) {
    const __m128d pair[2] = { _mm_loadu_pd((const double*)low), _mm_loadu_pd((const double*)high) };
    return _mm256_cvtpd_ps(_mm256_sub_pd(_mm256_insertf128_pd(_mm256_castpd128_pd256(pair[0]), pair[1], 1), _mm256_set1_pd(bias)));
  }
  if (type >= 2) {
    int two[2];
    memcpy(&two[0], low, sizeof two[0]);
    memcpy(&two[1], high, sizeof two[1]);
    const __m128i square = _mm_insert_epi32(_mm_cvtsi32_si128(two[0]), two[1], 1);
    return _mm_cvtepi32_ps(type == 2 ? _mm_cvtepi16_epi32(square) : _mm_cvtepu16_epi32(square));
  }
  uint16_t two[2];
  memcpy(&two[0], low, sizeof two[0]);
  memcpy(&two[1], high, sizeof two[1]);
  const __m128i square = _mm_insert_epi16(_mm_cvtsi32_si128(two[0]), two[1], 1);
  return _mm_cvtepi32_ps(type == 0 ? _mm_cvtepi8_epi32(square) : _mm_cvtepu8_epi32(square));
}
#endif

#endif
