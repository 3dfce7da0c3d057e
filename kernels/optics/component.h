/* SPDX-License-Identifier: BSD-3-Clause
 * The components of a volume's values. Included by ray_cast.h once for each STRATUS_TYPE, where a ray reads several of them. */
#ifndef STRATUS_COMPONENT_H
#define STRATUS_COMPONENT_H

/* The contribution of a sample's label: the entry in the table of its label, the layer of that over a whole sample, how far behind entries
 * their optical depths are, and how light and gradient change it. */
typedef struct stratus_label_sample {
  vfloat layer[4];
  vint entry, depths;
  stratus_lit_sample lighting;
} stratus_label_sample;

#endif

#if !STRATUS_PREINTEGRATED
/* The value of component c at s on the rays. */
OUTLINE vfloat RAY_NAME(component_at)(CONSTANT stratus_ray_cast_arguments* a, value_source values, GLOBAL const uchar* hidden,
  const stratus_packet* k, vfloat s, int c, vmask mask)
{
  const vfloat x[3] = { v_fma(s, k->d[0], k->p[0]), v_fma(s, k->d[1], k->p[1]), v_fma(s, k->d[2], k->p[2]) };
  return RAY_NAME(ray_value)(a, COMPONENT_VALUES(a, values, c), hidden, k->grid, x, mask);
}

/* The same at the sample. */
INLINE vfloat RAY_NAME(component_value)(
  CONSTANT stratus_ray_cast_arguments* a, const stratus_packet* k, const stratus_sample* sample, int c, vmask mask)
{
  return RAY_NAME(component_at)(a, sample->values, sample->hidden, k, v_fma(v_set(0.5f), sample->weight, sample->lo), c, mask);
}

/* The colour of dependent components at s on the rays: of two, the first one's in its table; of four, the first three. Returns the lanes of
 * `mask` that have one. */
INLINE vmask RAY_NAME(dependent_color)(CONSTANT stratus_ray_cast_arguments* a, GLOBAL const void* table, value_source values,
  GLOBAL const uchar* hidden, const stratus_packet* k, vfloat s, vmask mask, vfloat color[4])
{
  if (a->media.dependent == 1) {
    const vfloat value = RAY_NAME(component_at)(a, values, hidden, k, s, 0, mask);
    mask = mask & v_finite(value);
    gather_four((GLOBAL const float*)table + a->media.first[0], shading_entry(a, table, 0, value), mask, color);
  } else {
    for (int c = 0; c < 3; ++c) {
      const vfloat value = RAY_NAME(component_at)(a, values, hidden, k, s, c, mask);
      mask = mask & v_finite(value);
      color[c] = v_clamp(value * v_set(1.0f / 255.0f), 0.0f, 1.0f);
    }
  }
  return mask;
}
#endif
