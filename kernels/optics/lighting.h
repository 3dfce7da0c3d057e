/* SPDX-License-Identifier: BSD-3-Clause
 * How the gradient at a sample, and the light that falls on it, change its entry. */
#ifndef STRATUS_LIGHTING_H
#define STRATUS_LIGHTING_H

#include "light.h"
#include "layer.h"

/* Pieces of a cell are cut for their light only if they are longer than this part of the ray's path through it. */
#define LIGHT_PIECE_LEAST (1.0f / 64.0f)

/* The variance of the places of a stretch's opacity o, over the square of its length: extinction counts as even along it. With the optical
 * depth t it is 1 / t^2 - (1 - o) / o^2, which this series in o follows to 0.003 at o = 1/2 and to 0.03 at 0.9. */
INLINE vfloat light_variance(vfloat o) { return v_fma(o * o, v_fma(o, v_set(-1.0f / 240.0f), v_set(-1.0f / 240.0f)), v_set(1.0f / 12.0f)); }

/* In how many parts a stretch is to be cut whose spread, its opacity times the variance of its places, is beyond `limit`; of n parts each
 * spreads 1 / n^3 as far. */
INLINE vfloat light_parts(vfloat limit, vfloat spread)
{
  return v_select(v_lt(limit * v_set(64.0f), spread), v_set(8.0f), v_select(v_lt(limit * v_set(8.0f), spread), v_set(4.0f), v_set(2.0f)));
}

/* The entry of a value in component c's table. */
INLINE vint shading_entry(CONSTANT stratus_ray_cast_arguments* a, GLOBAL const void* table, int c, vfloat value)
{
  const vint cell = v_to_int(v_clamp(v_fma(value, v_set(a->media.scale[c]), v_set(a->media.offset[c])), 0.0f, a->media.last[c]));
  if (a->media.search_steps[c]) {
    GLOBAL const int* words = (GLOBAL const int*)table;
    return search_entry(
      words + a->media.first_at[c], words + a->media.bound_at[c], a->media.search_steps[c], cell, value, vi_ge(cell, vi_set(0)));
  }
  return cell;
}

/* A gradient opacity where the index gradient is g. Each lane has a function of its own: `first` is where its entries begin, and `scale` of
 * them are in a unit of the magnitude. */
INLINE vfloat gradient_opacity(
  CONSTANT stratus_ray_cast_arguments* a, GLOBAL const void* table, vint first, vfloat scale, const vfloat g[3], vmask mask)
{
  CONSTANT float* length = a->media.gradient_length;
  const vfloat even[3] = { g[0] * v_set(length[0]), g[1] * v_set(length[1]), g[2] * v_set(length[2]) };
  return factor_of_gradient((GLOBAL const int*)table, first, scale, a->media.factor_last, even, mask);
}

#endif
