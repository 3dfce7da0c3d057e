/* SPDX-License-Identifier: BSD-3-Clause
 * Samples of several components, and how light and the gradient change them. Included by ray_cast.h once for each STRATUS_TYPE,
 * where samples are shaded and, for their components, where slices are cut. */

/* How light and the gradient of component c change samples at s on their rays, in the lanes of `mask`. depth: the samples' optical depth
 * over a whole sample; read only if media.factor_reach is not 0. factor_first, factor_scale: of each lane's gradient opacity; factor_first
 * is negative if a lane has none. */
OUTLINE void RAY_NAME(ray_light_by)(CONSTANT stratus_ray_cast_arguments* a, const stratus_sample* sample, GLOBAL const void* table, int c,
  const stratus_packet* k, vfloat s, vfloat depth, vint factor_first, vfloat factor_scale, vmask mask, stratus_lit_sample* lighting)
{
  const vfloat x[3] = { v_fma(s, k->d[0], k->p[0]), v_fma(s, k->d[1], k->p[1]), v_fma(s, k->d[2], k->p[2]) }, one = v_set(1.0f);
  const vmask thins = mask & vi_ge(factor_first, vi_set(0));
  const int lit = a->light.on >> c & 1;
  vfloat g[3] = { v_set(0.0f), v_set(0.0f), v_set(0.0f) };
  lighting->factor = one;
  if ((lit && light_reflects(&a->light)) || m_any(thins)) {
    RAY_NAME(ray_gradient)(a, COMPONENT_VALUES(a, sample->values, c), k->grid, x, mask, g);
  }
  if (m_any(thins)) {
    const vfloat factor = gradient_opacity(a, table, factor_first, factor_scale, g, thins);
    lighting->factor =
      v_select(thins, a->media.factor_reach > 0.0f ? factor_of_way(factor, depth * v_set(a->media.factor_reach)) : factor, one);
  }
  if (lit) {
    vfloat passing[8];
    if (a->light.near) {
      RAY_NAME(light_near)(a, sample->values, sample->hidden, table, k, x, mask, passing);
    }
    light_at(&a->light, k->lights, a->light.near ? passing : 0, c, x, k->d, g, lighting->diffuse, lighting->specular, 0);
  } else {
    for (int i = 0; i < 3; ++i) {
      lighting->diffuse[i] = one;
      lighting->specular[i] = v_set(0.0f);
    }
  }
}

/* The same, where all lanes have the gradient opacity of component c. */
INLINE void RAY_NAME(ray_light_sample)(CONSTANT stratus_ray_cast_arguments* a, const stratus_sample* sample, GLOBAL const void* table,
  int c, const stratus_packet* k, vfloat s, vfloat depth, vmask mask, stratus_lit_sample* lighting)
{
  RAY_NAME(ray_light_by)
  (a, sample, table, c, k, s, depth, vi_set(a->media.factor_first[c]), v_set(a->media.factor_scale[c]), mask, lighting);
}

#if !STRATUS_PREINTEGRATED
/* Adds a medium to `sum`: its light, its optical depth and, last, the square of that. layer: its light and, last, its optical depth, both
 * over a whole sample. Component c's gradient lights and thins it. */
OUTLINE void RAY_NAME(ray_add_medium)(CONSTANT stratus_ray_cast_arguments* a, GLOBAL const void* table, int c, const stratus_packet* k,
  const stratus_sample* sample, vmask mask, vfloat layer[4], vfloat sum[5])
{
  const vmask shows = mask & v_lt(v_set(0.0f), layer[3]);
  stratus_lit_sample lighting;
  if (m_any(shows)) {
    RAY_NAME(ray_light_sample)(a, sample, table, c, k, v_fma(v_set(0.5f), sample->weight, sample->lo), layer[3], shows, &lighting);
    light_layer(&lighting, layer);
    const vfloat share = lighting.factor * v_set(a->media.weight[c]), depth = v_min(layer[3] * share, v_set(1e18f));
    for (int i = 0; i < 4; ++i) {
      sum[i] = v_select(shows, v_fma(layer[i], share, sum[i]), sum[i]);
    }
    sum[4] = v_select(shows, v_fma(depth, depth, sum[4]), sum[4]); /* 1e18 is opaque, and its square a float */
  }
}

/* Independent components: each is a medium, and both their optical depths and their light add up. */
INLINE void RAY_NAME(add_independent)(
  CONSTANT stratus_ray_cast_arguments* a, GLOBAL const void* table, const stratus_packet* k, const stratus_sample* sample, vfloat sum[5])
{
  for (int c = 0; c < a->media.components; ++c) {
    const vfloat value = RAY_NAME(component_value)(a, k, sample, c, k->live);
    vfloat layer[4];
    gather_four((GLOBAL const float*)table + a->media.first[c], shading_entry(a, table, c, value), k->live & v_finite(value), layer);
    RAY_NAME(ray_add_medium)(a, table, c, k, sample, k->live, layer, sum);
  }
}

/* Dependent components: the last has the opacity, and the others the colour. */
INLINE void RAY_NAME(add_dependent)(
  CONSTANT stratus_ray_cast_arguments* a, GLOBAL const void* table, const stratus_packet* k, const stratus_sample* sample, vfloat sum[5])
{
  const int last = a->media.dependent;
  const vfloat value = RAY_NAME(component_value)(a, k, sample, last, k->live);
  vfloat layer[4], color[4];
  vmask valid = k->live & v_finite(value);
  gather_four((GLOBAL const float*)table + a->media.first[last], shading_entry(a, table, last, value), valid, layer);
  valid = valid & v_lt(v_set(0.0f), layer[3]);
  if (!m_any(valid)) {
    return;
  }
  const vfloat s = v_fma(v_set(0.5f), sample->weight, sample->lo);
  valid = RAY_NAME(dependent_color)(a, table, sample->values, sample->hidden, k, s, valid, color);
  for (int c = 0; c < 3; ++c) {
    layer[c] = color[c] * layer[3];
  }
  RAY_NAME(ray_add_medium)(a, table, last, k, sample, valid, layer, sum);
}

/* Compute the components' contributions at samples: `sum` has their light and, last, their optical depth, over a whole sample. Returns the
 * rays on which anything shows. */
OUTLINE vmask RAY_NAME(components_at)(
  CONSTANT stratus_ray_cast_arguments* a, GLOBAL const void* table, const stratus_packet* k, const stratus_sample* sample, vfloat sum[5])
{
  for (int i = 0; i < 5; ++i) {
    sum[i] = v_set(0.0f);
  }
  if (a->media.dependent) {
    RAY_NAME(add_dependent)(a, table, k, sample, sum);
  } else {
    RAY_NAME(add_independent)(a, table, k, sample, sum);
  }
  const vmask shows = k->live & v_lt(v_set(0.0f), sum[3]);
  if (a->media.mean) {
    sum[3] = v_max(sum[4] * v_reciprocal(v_max(v_min(sum[3], v_set(4e18f)), v_set(1e-30f))), v_set(1e-30f));
  }
  return shows;
}
#endif
