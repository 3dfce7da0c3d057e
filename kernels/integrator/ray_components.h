/* SPDX-License-Identifier: BSD-3-Clause
 * Composites samples of several components (ray_media.h). Included by ray_cast.h once for each STRATUS_TYPE, where samples are shaded and
 * where slices are cut. */

#if !STRATUS_PREINTEGRATED
/* Composites the layer of a sample's components behind the layers that the rays have gathered. */
OUTLINE void RAY_NAME(shade_components)(
  CONSTANT stratus_ray_cast_arguments* a, GLOBAL const void* table, stratus_packet* k, const stratus_sample* sample)
{
  const vfloat zero = v_set(0.0f);
  vfloat sum[5];
  const vmask shows = RAY_NAME(components_at)(a, table, k, sample, sum);
  if (m_any(shows)) {
    vfloat layer[4];
    const vfloat depth = sum[3];
    layer[3] = v_select(shows, v_absorbed(depth * sample->length), zero);
    const vfloat per_depth = v_select(shows, layer[3] * v_reciprocal(v_max(depth, v_set(1e-30f))), zero);
    for (int c = 0; c < 3; ++c) {
      layer[c] = sum[c] * per_depth;
    }
    composite(a, k, shows, layer, sample->lo);
  }
}
#endif
