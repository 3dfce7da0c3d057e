/* SPDX-License-Identifier: BSD-3-Clause
 * Samples whose colour and opacity are a function of two variables (function_2d.h). Included by ray_cast.h with STRATUS_RAY_MODE set to
 * STRATUS_RAY_TRANSFER_2D. */
#ifndef STRATUS_RAY_TRANSFER_2D_H
#define STRATUS_RAY_TRANSFER_2D_H

/* Makes colour and opacity over the length that opacities are of a layer: colour times alpha, and alpha, of a length in sample distances.
 */
INLINE void thicken_layer(CONSTANT stratus_ray_cast_arguments* a, vfloat length, vfloat layer[4])
{
  layer[3] = v_absorbed(depth_of_entry(layer[3]) * (length * v_set(a->transfer_2d.reach)));
  for (int c = 0; c < 3; ++c) {
    layer[c] = layer[c] * layer[3];
  }
}
#endif

/* Composites the samples of `mask`, whose values' columns show. */
OUTLINE void RAY_NAME(shade_by_two)(CONSTANT stratus_ray_cast_arguments* a, GLOBAL const float* table, stratus_packet* k,
  const stratus_sample* sample, vint column, vfloat across, vmask mask)
{
  vfloat layer[4];
  stratus_lit_sample lighting;
  mask = RAY_NAME(two_at)(a, table, k, sample, column, across, mask, layer, &lighting);
  if (m_any(mask)) {
    thicken_layer(a, sample->length, layer);
    if (a->light.on) {
      light_layer(&lighting, layer);
    }
    for (int c = 0; c < 4; ++c) {
      layer[c] = v_select(mask, layer[c], v_set(0.0f));
    }
    composite(a, k, mask, layer, sample->lo);
  }
}

/* Composites the sample and moves on to the next segment. */
INLINE void RAY_NAME(ray_shade)(
  CONSTANT stratus_ray_cast_arguments* a, GLOBAL const void* table, stratus_packet* k, const stratus_sample* sample)
{
  const vmask valid = k->live & v_finite(sample->value);
  const vfloat value = v_select(valid, sample->value, v_set(0.0f));
  vfloat across;
  const vint column = entry_before(a, entry_place(a, 0, value), a->transfer_2d.columns, &across);
  const vmask shows = columns_show(a, (GLOBAL const float*)table, column, across, valid);
  k->samples -= mask_int(k->live);
  if (m_any(shows)) {
    RAY_NAME(shade_by_two)(a, (GLOBAL const float*)table, k, sample, column, across, shows);
  }
  k->i = k->i + vi_set(1);
  k->live = m_andnot(k->live, vi_ge(k->i, k->last) | v_lt(k->transparency, v_set(a->termination)));
}

INLINE void RAY_NAME(ray_finish)(
  CONSTANT stratus_ray_cast_arguments* a, value_source values, GLOBAL const uchar* hidden, GLOBAL const void* table, stratus_packet* k)
{
  (void)a;
  (void)values;
  (void)hidden;
  (void)table;
  (void)k;
}
