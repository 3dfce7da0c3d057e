/* SPDX-License-Identifier: BSD-3-Clause
 * The components of a volume's values. Included by ray_cast.h once for each STRATUS_TYPE, where a ray reads several of them. */
#ifndef STRATUS_COMPONENT_H
#define STRATUS_COMPONENT_H

/* Not inlined: few samples come this far, and the code is long. */
#ifdef STRATUS_DEVICE
#define OUTLINE static
#else
#define OUTLINE static __attribute__((noinline))
#endif

/* The contribution of a sample's label: the entry in the table of its label, the layer of that over a whole sample, how far behind entries
 * their optical depths are, and how light and gradient change it. */
typedef struct stratus_label_sample {
  vfloat layer[4];
  vint entry, depths;
  stratus_lit_sample lighting;
} stratus_label_sample;

#if RAY_IN_PAGES
INLINE value_source component_values(value_source values, int c)
{
  values.component = c;
  return values;
}
#define COMPONENT_VALUES(a, values, c) component_values(values, c)
#else
#define COMPONENT_VALUES(a, values, c) ((GLOBAL const uchar*)(values) + (size_t)(c) * (size_t)(uint)(a)->media.component_bytes)
#endif
#endif

#if !STRATUS_PREINTEGRATED
/* The value of component c at the sample. */
OUTLINE vfloat RAY_NAME(component_value)(
  CONSTANT stratus_ray_cast_arguments* a, const stratus_packet* k, const stratus_sample* sample, int c, vmask mask)
{
  const vfloat s = v_fma(v_set(0.5f), sample->weight, sample->lo);
  const vfloat x[3] = { v_fma(s, k->d[0], k->p[0]), v_fma(s, k->d[1], k->p[1]), v_fma(s, k->d[2], k->p[2]) };
  return RAY_NAME(ray_value)(a, COMPONENT_VALUES(a, sample->values, c), sample->hidden, k->grid, x, mask);
}
#endif
