/* SPDX-License-Identifier: BSD-3-Clause
 * Stretches along which the field is linear, on rays that gather no light: sums of values, and surfaces. */
#ifndef STRATUS_TETRA_MODES_H
#define STRATUS_TETRA_MODES_H

#include "tetra_pixel.h"
#include "tetra_shade.h"
/* A device's kernel holds a file where it is included first: files that other variants need, too, must be included above. */
#if TETRA_LIT
#include "tetra_components.h"
#else
typedef int stratus_tetra_stretch; /* of no use */
#endif

/* Add the mean of a stretch times its length: red of opacity times value, green of the values that count. The sums of a place are of
 * opacity times value, of opacity, and of the values that count. value: replaces the value; 0: the table's. */
INLINE void tetra_add(CONSTANT stratus_tetra_arguments* a, GLOBAL const int* sums, stratus_tetra_light* light, vmask mask,
  const stratus_tetra_place* from, const stratus_tetra_place* to, const vfloat* value, vfloat length, vfloat near)
{
  const vint rise = to->entry - from->entry, one = vi_set(1);
  const vmask level = mask & vi_zero(rise);
  vint span[4], own[4];
  for (int c = 0; c < 4; ++c) {
    span[c] = to->sum[c] - from->sum[c];
  }
  if (m_any(level)) {
    gather_four_ints(sums, to->entry + vi_set((int)a->table.last + 1), level, own);
    for (int c = 0; c < 4; ++c) {
      span[c] = vi_select(level, own[c], span[c]);
    }
  }
  const vfloat per_entry = length * v_reciprocal(v_abs(v_from_int(vi_select(level, one, rise)))), zero = v_set(0.0f);
  vfloat added = v_abs(v_from_int(span[0]));
  if (value) {
    added = v_abs(v_from_int(span[1])) * *value;
  }
  light->red = v_select(mask, v_fma(per_entry, added, light->red), light->red);
  light->green = v_select(mask, v_fma(per_entry, v_abs(v_from_int(span[3])), light->green), light->green);
  if (a->picture.want_depth) {
    const vmask hit = mask & v_lt(zero, v_abs(v_from_int(span[1]))) & v_le(v_set(LARGEST_FLOAT), light->depth);
    light->depth = v_select(hit, near, light->depth);
  }
}

/* Composite a surface, whose colour is multiplied by its opacity, at a world distance. lit: NULL where it is not lit. Where rays keep only
 * one of their surfaces, the nearer ones are forgotten, and the farther ones left out. */
INLINE void tetra_surface(CONSTANT stratus_tetra_arguments* a, stratus_tetra_light* light, const stratus_tetra_lit* lit, vmask mask,
  const vfloat color[4], vfloat distance)
{
  const vfloat zero = v_set(0.0f), one = v_set(1.0f), number = v_set(a->kept);
  if (a->kept > 0.0f) {
    mask = m_andnot(mask, v_le(number, light->most));
  }
  const vfloat opacity = v_select(mask, color[3], zero);
  tetra_gather(light, lit, v_select(mask, light->transparency, zero), color);
  light->transparency = v_fma(zero - light->transparency, opacity, light->transparency);
  if (a->picture.want_depth) {
    const vmask hit = mask & v_lt(zero, opacity) & v_le(v_set(LARGEST_FLOAT), light->depth);
    light->depth = v_select(hit, distance, light->depth);
  }
  if (a->kept > 0.0f) { /* a surface whose opacity is lost in 1 doesn't count, because its pixel shows nothing */
    const vmask shown = mask & v_lt(light->transparency, one);
    light->most = v_select(shown, light->most + one, light->most);
    const vmask passed = shown & v_lt(light->most, number);
    light->red = v_select(passed, zero, light->red);
    light->green = v_select(passed, zero, light->green);
    light->blue = v_select(passed, zero, light->blue);
    light->transparency = v_select(passed, one, light->transparency);
    light->depth = v_select(passed, v_set(LARGEST_FLOAT), light->depth);
  }
}

#endif
