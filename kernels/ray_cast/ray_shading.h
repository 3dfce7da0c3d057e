/* SPDX-License-Identifier: BSD-3-Clause
 * Samples that show more than one value's colour and opacity: lit, thinned where the field is flat (or steep), of several components, or
 * labelled. Included by ray_cast.h with STRATUS_RAY_MODE set to STRATUS_RAY_SHADING.
 *
 * Light and gradient are computed only where something shows, and they only thin or colour that. So a segment that the structure leaves
 * out would have added exactly zero here, too. */

/* How light and the gradient of component c change samples at s on their rays, in the lanes of `mask`. depth: the samples' optical depth
 * over a whole sample; read only if media.factor_reach is not 0. factor_first, factor_scale: of each lane's gradient opacity; factor_first
 * is negative if a lane has none. */
OUTLINE void RAY_NAME(ray_light_by)(CONSTANT stratus_ray_cast_arguments* a, value_source values, GLOBAL const void* table, int c,
  const stratus_packet* k, vfloat s, vfloat depth, vint factor_first, vfloat factor_scale, vmask mask, stratus_lit_sample* lighting)
{
  const vfloat x[3] = { v_fma(s, k->d[0], k->p[0]), v_fma(s, k->d[1], k->p[1]), v_fma(s, k->d[2], k->p[2]) }, one = v_set(1.0f);
  const vmask thins = mask & vi_ge(factor_first, vi_set(0));
  const int lit = a->light.on >> c & 1;
  vfloat g[3] = { v_set(0.0f), v_set(0.0f), v_set(0.0f) };
  lighting->factor = one;
  if (lit || m_any(thins)) {
    RAY_NAME(ray_gradient)(a, COMPONENT_VALUES(a, values, c), k->grid, x, mask, g);
  }
  if (m_any(thins)) {
    const vfloat factor = gradient_opacity(a, table, factor_first, factor_scale, g, thins);
    lighting->factor =
      v_select(thins, a->media.factor_reach > 0.0f ? factor_of_way(factor, depth * v_set(a->media.factor_reach)) : factor, one);
  }
  if (lit) {
    light_at(&a->light, c, x, k->d, g, lighting->diffuse, lighting->specular);
  } else {
    for (int i = 0; i < 3; ++i) {
      lighting->diffuse[i] = one;
      lighting->specular[i] = v_set(0.0f);
    }
  }
}

/* The same, where all lanes have the gradient opacity of component c. */
INLINE void RAY_NAME(ray_light_sample)(CONSTANT stratus_ray_cast_arguments* a, value_source values, GLOBAL const void* table, int c,
  const stratus_packet* k, vfloat s, vfloat depth, vmask mask, stratus_lit_sample* lighting)
{
  RAY_NAME(ray_light_by)
  (a, values, table, c, k, s, depth, vi_set(a->media.factor_first[c]), v_set(a->media.factor_scale[c]), mask, lighting);
}

#if !STRATUS_PREINTEGRATED
/* The optical depths of the entries over a whole sample, if gradient opacity needs them. table: of entries colour times alpha, and alpha;
 * behind these, from entry `depths` on, each one's optical depth. */
INLINE vfloat RAY_NAME(entry_depth)(CONSTANT stratus_ray_cast_arguments* a, GLOBAL const float* table, vint depths, vmask mask)
{
  vfloat depth[4] = { v_set(0.0f), v_set(0.0f), v_set(0.0f), v_set(0.0f) };
  if (a->media.factor_reach > 0.0f) {
    gather_four(table, depths, mask, depth);
  }
  return depth[0];
}

/* Adds a medium to `sum`: its light, its optical depth and, last, the square of that. layer: its light and, last, its optical depth, both
 * over a whole sample. Component c's gradient lights and thins it. */
OUTLINE void RAY_NAME(ray_add_medium)(CONSTANT stratus_ray_cast_arguments* a, GLOBAL const void* table, int c, const stratus_packet* k,
  const stratus_sample* sample, vmask mask, vfloat layer[4], vfloat sum[5])
{
  const vmask shows = mask & v_lt(v_set(0.0f), layer[3]);
  stratus_lit_sample lighting;
  if (m_any(shows)) {
    RAY_NAME(ray_light_sample)(a, sample->values, table, c, k, v_fma(v_set(0.5f), sample->weight, sample->lo), layer[3], shows, &lighting);
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
  vfloat value = RAY_NAME(component_value)(a, k, sample, last, k->live), layer[4], color[4];
  vmask valid = k->live & v_finite(value);
  gather_four((GLOBAL const float*)table + a->media.first[last], shading_entry(a, table, last, value), valid, layer);
  valid = valid & v_lt(v_set(0.0f), layer[3]);
  if (!m_any(valid)) {
    return;
  }
  if (last == 1) {
    value = RAY_NAME(component_value)(a, k, sample, 0, valid);
    valid = valid & v_finite(value);
    gather_four((GLOBAL const float*)table + a->media.first[0], shading_entry(a, table, 0, value), valid, color);
  } else {
    for (int c = 0; c < 3; ++c) {
      color[c] = RAY_NAME(component_value)(a, k, sample, c, valid) * v_set(1.0f / 255.0f);
    }
  }
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

/* The labels of the values nearest to the positions x; 0 for labels that have no functions of their own. */
OUTLINE vint RAY_NAME(label_at)(
  CONSTANT stratus_ray_cast_arguments* a, GLOBAL const uchar* hidden, GLOBAL const int* grid, const vfloat x[3], vmask mask)
{
  float place[3][STRATUS_WIDTH];
  int wanted[STRATUS_WIDTH], label[STRATUS_WIDTH];
  vfloat snapped[3] = { x[0], x[1], x[2] };
  vi_store(wanted, vi_select(mask, vi_set(1), vi_set(0)));
  if (RAY_STRETCHED(a)) {
    grid_snap(a, grid, snapped);
  }
  for (int axis = 0; axis < 3; ++axis) {
    vfloat at = snapped[axis];
    if (a->values.clamp & !RAY_STRETCHED(a)) {
      at = v_clamp(at, 0.0f, a->values.last[axis]);
    }
    v_store(place[axis], at);
  }
  for (int lane = 0; lane < STRATUS_WIDTH; ++lane) {
    label[lane] = wanted[lane] ? (int)hidden[hidden_place(a, 1, place[0][lane], place[1][lane], place[2][lane])] : 0;
    label[lane] = label[lane] <= a->media.label_count ? label[lane] : 0;
  }
  return vi_load(label);
}

/* Finds what samples show in the colours and opacities of their labels. Returns the rays on which anything shows. */
OUTLINE vmask RAY_NAME(labels_at)(CONSTANT stratus_ray_cast_arguments* a, GLOBAL const void* table, const stratus_packet* k,
  const stratus_sample* sample, stratus_label_sample* shown)
{
  GLOBAL const float* floats = (GLOBAL const float*)table;
  const vfloat s = v_fma(v_set(0.5f), sample->weight, sample->lo), zero = v_set(0.0f);
  const vfloat x[3] = { v_fma(s, k->d[0], k->p[0]), v_fma(s, k->d[1], k->p[1]), v_fma(s, k->d[2], k->p[2]) };
  const vmask valid = k->live & v_finite(sample->value);
  GLOBAL const int* ints = (GLOBAL const int*)table;
  const vint label = RAY_NAME(label_at)(a, sample->hidden, k->grid, x, valid), record = label + label + label, numbers = record + vi_set(1);
  vfloat of[4];
  vint place[4];
  gather_four(floats + a->media.label_first, record, valid, of);
  for (int i = 0; i < 4; ++i) {
    place[i] = v_gather_ints(ints + a->media.label_first + i, numbers << vi_set(2), valid);
  }
  vint entry = v_to_int(v_min(v_max(v_fma(sample->value, of[0], of[1]), zero), of[2]));
  if (a->media.label_steps) { /* a label whose entries are cells has none to search in */
    const vmask divided = valid & vi_lt(vi_set(0), place[2]);
    const vint cell = entry + place[2];
    entry = vi_select(divided, v_gather_ints(ints, cell, divided), entry);
    const vint beyond = v_gather_ints(ints + 1, cell, divided);
    for (int ahead = 1 << (a->media.label_steps - 1); ahead > 0; ahead >>= 1) {
      const vint next = entry + vi_set(ahead);
      const vmask inside = divided & vi_lt(next, beyond);
      entry = vi_select(inside & v_le(v_from_bits(v_gather_ints(ints, next + place[3], inside)), sample->value), next, entry);
    }
  }
  shown->entry = entry + place[0];
  shown->depths = place[1];
  gather_four(floats, shown->entry, valid, shown->layer);
  const vmask shows = valid & v_lt(zero, shown->layer[3]);
  if (m_any(shows)) {
    const vfloat depth = RAY_NAME(entry_depth)(a, floats, shown->entry + place[1], shows);
    vint factors = vi_set(-1);
    if (a->media.label_factors) {
      factors = v_gather_ints(ints + a->media.label_first, (record + vi_set(2)) << vi_set(2), shows);
    }
    RAY_NAME(ray_light_by)(a, sample->values, table, 0, k, s, depth, factors, of[3], shows, &shown->lighting);
  }
  return shows;
}

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
    RAY_NAME(ray_light_sample)(a, sample->values, table, 0, k, v_fma(v_set(0.5f), weight, lo), weight, shows, &lighting);
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
      RAY_NAME(ray_light_sample)(a, sample->values, table, 0, k, v_fma(v_set(0.5f), weight, lo), depth, shows, &lighting);
      scale_layer(a, (GLOBAL const float*)table, entry, shows, sample->length * lighting.factor, layer);
      light_layer(&lighting, layer);
      composite(a, k, shows, layer, lo);
    }
  }
  k->i = k->i + vi_set(1);
#endif
  k->live = m_andnot(k->live, vi_ge(k->i, k->last) | v_lt(k->transparency, v_set(a->termination)));
}

INLINE void RAY_NAME(ray_finish)(CONSTANT stratus_ray_cast_arguments* a, GLOBAL const void* table, stratus_packet* k)
{
  (void)a;
  (void)table;
  (void)k;
}
