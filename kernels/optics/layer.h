/* SPDX-License-Identifier: BSD-3-Clause
 * Layers: the colour and opacity that the transfer function's table has for a sample or a segment, and how light changes them. */
#ifndef STRATUS_LAYER_H
#define STRATUS_LAYER_H

#include "packet_math.h"
#include "ray_packet.h"
#include "transfer_table.h"

/* Change layers of a sample distance to `weight` of the optical depth. */
INLINE void scale_layer(
  CONSTANT stratus_ray_cast_arguments* a, GLOBAL const float* table, vint entry, vmask mask, vfloat weight, vfloat layer[4])
{
  const vmask part = m_andnot(mask, v_le(weight, v_set(1.0f)) & v_le(v_set(1.0f), weight)) & v_lt(v_set(0.0f), layer[3]);
  if (m_any(part)) { /* on most lattices only the segments at a ray's ends are not a sample distance long */
    vfloat last[4];
    gather_four(table + 4 * a->table.entries, entry, part, last);
    const vfloat alpha = v_absorbed(last[0] * weight),
                 ratio = v_select(part, alpha * v_reciprocal(v_max(layer[3], v_set(1e-30f))), v_set(1.0f));
    for (int c = 0; c < 4; ++c) {
      layer[c] = layer[c] * ratio;
    }
  }
}

/* How light and gradient change a sample. `factor` multiplies its optical depth, and a colour C of opacity A becomes C diffuse + A
 * specular. */
typedef struct stratus_lit_sample {
  vfloat factor, diffuse[3], specular[3];
} stratus_lit_sample;

INLINE void light_layer(const stratus_lit_sample* lighting, vfloat layer[4])
{
  for (int c = 0; c < 3; ++c) {
    layer[c] = v_fma(layer[c], lighting->diffuse[c], layer[3] * lighting->specular[c]);
  }
}

/* The lanes of the mask whose segments show anything. */
INLINE vmask segment_shows(
  CONSTANT stratus_ray_cast_arguments* a, GLOBAL const int* sums, const stratus_packet* k, vmask mask, vfloat value)
{
  const vint entry = table_entry(&a->table, sums, value), front = table_entry(&a->table, sums, k->front);
  return mask & v_lt(v_set(0.0f), tau_between(sums, vi_min(entry, front), vi_max(entry, front) + vi_set(1), mask));
}

/* The part of a range between two places in the table's grid that is within the table's span: the fraction of the range before it, and its
 * own fraction. */
INLINE void part_within(CONSTANT stratus_table_arguments* t, vfloat from, vfloat to, vfloat* before, vfloat* part)
{
  const vfloat zero = v_set(0.0f), way = to - from, size = v_reciprocal(v_max(v_abs(way), v_set(1e-30f)));
  const vfloat per_way = v_select(v_lt(way, zero), zero - size, size);
  const vfloat first = (zero - from) * per_way, last = (v_set(t->last + 1.0f) - from) * per_way;
  *before = v_clamp(v_min(first, last), 0.0f, 1.0f);
  *part = v_clamp(v_max(first, last), 0.0f, 1.0f) - *before;
}

#endif
