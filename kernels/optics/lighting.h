/* SPDX-License-Identifier: BSD-3-Clause
 * How the gradient at a sample, and the light that falls on it, change its entry. */
#ifndef STRATUS_LIGHTING_H
#define STRATUS_LIGHTING_H

#include "light.h"
#include "layer.h"

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
