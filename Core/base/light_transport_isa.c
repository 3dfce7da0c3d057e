/* SPDX-License-Identifier: BSD-3-Clause
 * Light along one direction through a box of cells, compiled for one instruction set, STRATUS_ISA. */
#include "light_transport.h"

#include "instruction_set.h"
#include "packet_math.h"

#ifdef __GNUC__
#pragma GCC diagnostic ignored "-Wunused-function" /* the packets' headers have more than this needs */
#endif

_Static_assert(STRATUS_WIDTH <= STRATUS_TRANSPORT_PAD, "a packet may go beyond the end of a row");

/* Values at the places from which light comes, between four cells. */
INLINE vfloat before(const float* at, ptrdiff_t back, ptrdiff_t down, const vfloat weights[4])
{
  return v_fma(weights[0], v_load(at),
    v_fma(weights[1], v_load(at + back), v_fma(weights[2], v_load(at + down), weights[3] * v_load(at + back + down))));
}

/* A polynomial without a constant term, from the highest power down. */
INLINE vfloat polynomial(vfloat x, float c5, float c4, float c3, float c2, float c1)
{
  return v_fma(v_fma(v_fma(v_fma(v_set(c5), x, v_set(c4)), x, v_set(c3)), x, v_set(c2)), x, v_set(c1)) * x;
}

/* Shares of the source at the end, and at the beginning, of a segment of an optical depth. They are differences, which lose digits where
 * the depth is small: there series are used. */
INLINE void shares(vfloat depth, vfloat absorbed, vfloat* end, vfloat* begin)
{
  const vfloat one = v_set(1.0f), small = v_min(depth, v_set(0.25f));
  const vfloat mean = absorbed * v_reciprocal(v_max(depth, v_set(1e-10f)));
  const vmask thin = v_lt(depth, v_set(0.25f));
  *end = v_select(thin, polynomial(small, 1.0f / 720.0f, -1.0f / 120.0f, 1.0f / 24.0f, -1.0f / 6.0f, 0.5f), one - mean);
  *begin = v_select(thin, polynomial(small, 1.0f / 144.0f, -1.0f / 30.0f, 1.0f / 8.0f, -1.0f / 3.0f, 0.5f), mean - (one - absorbed));
}

void STRATUS_ISA_NAME(stratus_transport_sweep)(const stratus_transport_sweep* s)
{
  const float aside = s->part[0], below = s->part[1];
  const vfloat weights[4] = { v_set((1.0f - aside) * (1.0f - below)), v_set(aside * (1.0f - below)), v_set((1.0f - aside) * below),
    v_set(aside * below) };
  const vfloat half_step = v_set(0.5f * s->step), sky = v_set(s->sky), weight = v_set(s->weight), zero = v_set(0.0f);
  const ptrdiff_t back = s->back[0], down = s->back[1] * (ptrdiff_t)s->row;
  const ptrdiff_t upstream = s->reverse ? (ptrdiff_t)s->plane : -(ptrdiff_t)s->plane;
  for (int plane = 0; plane < 2; ++plane) {
    for (size_t i = 0; i < s->plane; ++i) {
      s->radiance[plane][i] = s->sky;
    }
  }
  for (int k = 0; k < s->size[2]; ++k) {
    const size_t z = (size_t)(s->reverse ? s->size[2] - k : k + 1);
    const float* from = s->radiance[k & 1];
    float* to = s->radiance[1 - (k & 1)];
    for (int j = 0; j < s->size[1]; ++j) {
      const size_t in_plane = (size_t)(j + 1) * s->row + 1, row = z * s->plane + in_plane;
      for (int i = 0; i < s->size[0]; i += STRATUS_WIDTH) {
        const size_t at = row + (size_t)i, there = in_plane + (size_t)i;
        const vfloat here = v_load(s->extinction + at), there_extinction = before(s->extinction + at + upstream, back, down, weights);
        const vfloat emission = before(s->emission + at + upstream, back, down, weights);
        const vfloat depth = (there_extinction + here) * half_step, absorbed = v_absorbed(depth);
        /* a vacuum's source is not known, and counts as that at the other end */
        const vmask matter_here = v_lt(zero, here), matter_there = v_lt(zero, there_extinction);
        const vfloat source_there = emission * v_reciprocal(v_max(there_extinction, v_set(1e-30f)));
        const vfloat source = v_select(matter_here, v_load(s->source + at), source_there);
        vfloat end, begin;
        shares(depth, absorbed, &end, &begin);
        vfloat light = before(from + there, back, down, weights) * (v_set(1.0f) - absorbed);
        light = v_fma(end, source, v_fma(begin, v_select(matter_there, source_there, source), light));
        light = v_select(vi_lt(vi_lanes(), vi_set(s->size[0] - i)), light, sky);
        v_store(to + there, light);
        v_store(s->sum + at, v_fma(weight, light, v_load(s->sum + at)));
      }
    }
  }
}
