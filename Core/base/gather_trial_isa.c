/* SPDX-License-Identifier: BSD-3-Clause
 * Reads of two neighbours in two rows, as of a cell's corners, compiled for one instruction set, STRATUS_ISA. */
#include "gather_trial.h"

#include "gather.h"
#include "instruction_set.h"

#ifdef __GNUC__
#pragma GCC diagnostic ignored "-Wunused-function" /* the packets' headers have more than this needs */
#endif

#define ROW 64
#define READS 256

float STRATUS_ISA_NAME(stratus_gather_trial)(const float* table, int seed, int gathers)
{
#if STRATUS_ISA == 2
  const vmask all = 0xffff;
  vint at = vi_lanes() + vi_set(seed);
  vfloat sum = v_set(0.0f);
  for (int n = 0; n < READS; ++n) {
    vfloat out[4];
    const vint index = at & vi_set(STRATUS_GATHER_TRIAL / 2 - 1);
    if (gathers) {
      vint low[2], high[2];
      GATHER_TWO(table, index, all, 4, low);
      GATHER_TWO(table + ROW, index, all, 4, high);
      for (int c = 0; c < 2; ++c) {
        out[c] = v_from_bits(low[c]);
        out[2 + c] = v_from_bits(high[c]);
      }
    } else {
      lane_places places;
      vfloat joined[4];
      lane_places_of(index, all, &places);
      for (int lane = 0; lane < 4; ++lane) {
        __m128 quad[4];
        for (int part = 0; part < 4; ++part) {
          const float* from = table + places.at[4 * part + lane];
          quad[part] =
            _mm_loadh_pi(_mm_castsi128_ps(_mm_loadl_epi64((const __m128i*)(const void*)from)), (const __m64*)(const void*)(from + ROW));
        }
        joined[lane] = join_quads(quad);
      }
      transpose_quads(joined, out);
    }
    sum = sum + ((out[0] + out[1]) + (out[2] + out[3]));
    at = at * vi_set(5) + vi_set(37);
  }
  return _mm512_reduce_add_ps(sum);
#else
  (void)table;
  (void)gathers;
  return (float)seed;
#endif
}
