/* SPDX-License-Identifier: BSD-3-Clause
 * Samples that show more than one value's colour and opacity: lit, thinned where the field is flat (or steep), of several components, or
 * labelled. Included by ray_cast.h with STRATUS_RAY_MODE set to STRATUS_RAY_SHADING.
 *
 * Light and gradient are computed only where something shows, and they only thin or colour that. So a segment that the structure leaves
 * out would have added exactly zero here, too. */

#if !STRATUS_PREINTEGRATED
/* Composites samples in the colours and opacities of their labels. */
OUTLINE void RAY_NAME(shade_labels)(
  CONSTANT stratus_ray_cast_arguments* a, GLOBAL const void* table, stratus_packet* k, const stratus_sample* sample)
{
  stratus_label_sample shown;
  const vmask shows = RAY_NAME(labels_at)(a, table, k, sample, &shown);
  if (m_any(shows)) {
    vfloat layer[4] = { shown.layer[0], shown.layer[1], shown.layer[2], shown.layer[3] };
    const vfloat thick = sample->length * shown.lighting.factor;
    const vmask part = m_andnot(shows, v_le(thick, v_set(1.0f)) & v_le(v_set(1.0f), thick));
    if (m_any(part)) { /* as scale_layer() */
      vfloat depth[4];
      gather_four((GLOBAL const float*)table, shown.entry + shown.depths, part, depth);
      const vfloat alpha = v_absorbed(depth[0] * thick),
                   ratio = v_select(part, alpha * v_reciprocal(v_max(layer[3], v_set(1e-30f))), v_set(1.0f));
      for (int c = 0; c < 4; ++c) {
        layer[c] = layer[c] * ratio;
      }
    }
    light_layer(&shown.lighting, layer);
    composite(a, k, shows, layer, sample->lo);
  }
}
#endif

/* Composites the sample and moves on to the next segment. */
OUTLINE void RAY_NAME(ray_shade)(
  CONSTANT stratus_ray_cast_arguments* a, GLOBAL const void* table, stratus_packet* k, const stratus_sample* sample)
{
  const vfloat value = sample->value, weight = sample->weight, lo = sample->lo;
  stratus_lit_sample lighting;
  k->samples -= mask_int(k->live);
#if STRATUS_PREINTEGRATED
  const vmask whole = m_andnot(k->live, k->fresh); /* rays that know the value at the segment's front */
  const vmask shows = segment_shows(a, (GLOBAL const int*)table, k, whole & v_finite(value) & v_finite(k->front), value);
  if (m_any(shows)) {
    RAY_NAME(ray_light_sample)(a, sample, table, 0, k, v_fma(v_set(0.5f), weight, lo), weight, shows, &lighting);
    integrate_lit(a, (GLOBAL const int*)table, k, shows, value, sample->length * lighting.factor, lo, &lighting);
  }
  k->front = value;
  k->i = vi_select(k->fresh, k->i, k->i + vi_set(1));
  k->fresh = m_none();
#else
  if (RAY_RARE(RAY_COMPONENTS, a->media.components > 1)) {
    RAY_NAME(shade_components)(a, table, k, sample);
  } else if (RAY_RARE(RAY_LABELS, a->media.label_count > 0)) {
    RAY_NAME(shade_labels)(a, table, k, sample);
  } else {
    const vint entry = table_entry(&a->table, table, value);
    vfloat layer[4];
    gather_four((GLOBAL const float*)table, entry, k->live & v_finite(value), layer);
    const vmask shows = k->live & v_finite(value) & v_lt(v_set(0.0f), layer[3]);
    if (m_any(shows)) {
      const vfloat depth = RAY_NAME(entry_depth)(a, (GLOBAL const float*)table + 4 * a->table.entries, entry, shows);
      RAY_NAME(ray_light_sample)(a, sample, table, 0, k, v_fma(v_set(0.5f), weight, lo), depth, shows, &lighting);
      scale_layer(a, (GLOBAL const float*)table, entry, shows, sample->length * lighting.factor, layer);
      light_layer(&lighting, layer);
      composite(a, k, shows, layer, lo);
    }
  }
  k->i = k->i + vi_set(1);
#endif
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
