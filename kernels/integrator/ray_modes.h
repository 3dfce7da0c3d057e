/* SPDX-License-Identifier: BSD-3-Clause
 * Rays that gather no light: the largest or smallest value of their samples, or a sum. Included by ray_cast.h with STRATUS_RAY_MODE set. A
 * segment that the structure leaves out would have changed nothing, so that skipping is as exact here as it is for light.
 *
 * Pictures of several grids are put together from the states of their rays (Core/frame/ray_kept.h). A pixel then holds such a state:
 * red is the best value, or the integral of opacity times grey; green is the length on which values count, of means only; blue is the
 * integral of the opacity, of sums and means. Lengths are the world's. Alpha is 1 where the ray has a state. Of dependent components, best
 * values have a colour: green and blue are its red and green, and its blue is added to alpha.
 *
 * Of dependent components, rays keep the last one's best value, in the others' colour there. Sums are of the last one's opacity times the
 * first one's value, as VTK's mappers add them. */

INLINE void RAY_NAME(ray_advance)(stratus_packet* k, vmask done)
{
  k->i = k->i + vi_set(1);
  k->live = m_andnot(k->live, vi_ge(k->i, k->last) | done);
}

#if STRATUS_RAY_MODE == STRATUS_RAY_EXTREMES
/* Keeps the best value, and where the ray first met it. Minima are maxima of the negative values. */
INLINE void RAY_NAME(ray_shade)(
  CONSTANT stratus_ray_cast_arguments* a, GLOBAL const void* table, stratus_packet* k, const stratus_sample* sample)
{
  const vfloat value = v_set(a->mode.sign) * sample->value;
  const vmask better = k->live & v_finite(value) & v_lt(k->front, value);
  (void)table;
  k->samples -= mask_int(k->live);
  k->front = v_select(better, value, k->front);
  k->depth = v_select(better, packet_length(a, k, sample->lo + k->first) * v_set(a->lattice.step), k->depth);
  if (RAY_RARE(RAY_COMPONENTS, a->media.dependent)) { /* where the colour is */
    k->green = v_select(better, v_fma(v_set(0.5f), sample->weight, sample->lo), k->green);
  }
  RAY_NAME(ray_advance)(k, v_le(v_set(a->mode.top), k->front)); /* no value of the volume is better */
}

/* The colour of the best value; nothing where the table shows it transparent. */
INLINE void RAY_NAME(ray_finish)(
  CONSTANT stratus_ray_cast_arguments* a, value_source values, GLOBAL const uchar* hidden, GLOBAL const void* table, stratus_packet* k)
{
  vmask found = k->hits & v_lt(v_set(-LARGEST_FLOAT), k->front);
  const vfloat value = v_set(a->mode.sign) * k->front, zero = v_set(0.0f), one = v_set(1.0f);
  const int dependent = RAY_RARE(RAY_COMPONENTS, a->media.dependent) && m_any(found);
  vfloat layer[4], color[4] = { zero, zero, zero, zero };
  if (dependent) {
    found = RAY_NAME(dependent_color)(a, table, values, hidden, k, k->green, found, color);
  }
  if (a->mode.kept) {
    const vmask counts = found & v_le(v_set(a->mode.counted_first), value) & v_le(value, v_set(a->mode.counted_last));
    k->red = v_select(counts, value, zero);
    k->green = v_select(counts, color[0], zero);
    k->blue = v_select(counts, color[1], zero);
    k->transparency = v_select(counts, zero - color[2], one);
    k->depth = v_select(counts, k->depth, v_set(LARGEST_FLOAT));
    return;
  }
  gather_four((GLOBAL const float*)table, table_entry(&a->table, table, value), found, layer);
  for (int c = 0; dependent && c < 3; ++c) {
    layer[c] = v_select(found, color[c] * layer[3], zero);
  }
  k->red = layer[0];
  k->green = layer[1];
  k->blue = layer[2];
  k->transparency = one - layer[3];
  k->depth = v_select(v_lt(zero, layer[3]), k->depth, v_set(LARGEST_FLOAT));
}

#else
/* Adds opacity times value, where a value counts as its part of the range that is shown from black to white. */
INLINE void RAY_NAME(ray_shade)(
  CONSTANT stratus_ray_cast_arguments* a, GLOBAL const void* table, stratus_packet* k, const stratus_sample* sample)
{
  vfloat value = sample->value, layer[4];
  vmask counts = k->live & v_finite(value);
  if (RAY_RARE(RAY_COMPONENTS, a->media.dependent)) {
    value = RAY_NAME(component_value)(a, k, sample, 0, counts);
    counts = counts & v_finite(value);
  }
  counts = counts & v_le(v_set(a->mode.counted_first), value) & v_le(value, v_set(a->mode.counted_last));
  gather_four((GLOBAL const float*)table, table_entry(&a->table, table, sample->value), counts, layer);
  const vfloat grey = v_fma(value, v_set(a->mode.grey_scale), v_set(a->mode.grey_offset)) * layer[3];
  k->samples -= mask_int(k->live);
  k->front = v_select(counts, v_fma(grey, sample->length, k->front), k->front);
  k->red = v_select(counts, k->red + sample->length, k->red);
  k->blue = v_select(counts, v_fma(layer[3], sample->length, k->blue), k->blue);
  const vmask first = counts & v_lt(v_set(0.0f), layer[3]) & v_le(v_set(LARGEST_FLOAT), k->depth);
  k->depth = v_select(first, packet_length(a, k, sample->lo + k->first) * v_set(a->lattice.step), k->depth);
  RAY_NAME(ray_advance)(k, m_none());
}

/* Grey and opaque wherever something was added: the sum, or the mean where sum_scale is 0. */
INLINE void RAY_NAME(ray_finish)(
  CONSTANT stratus_ray_cast_arguments* a, value_source values, GLOBAL const uchar* hidden, GLOBAL const void* table, stratus_packet* k)
{
  const vfloat zero = v_set(0.0f), one = v_set(1.0f);
  vmask shown = k->hits;
  vfloat scale = v_set(a->mode.sum_scale);
  (void)values;
  (void)hidden;
  (void)table;
  if (a->mode.kept) {
    const vfloat length = v_set(a->lattice.step);
    k->green = k->red * v_set(a->mode.sum_scale == 0.0f ? a->lattice.step : 0.0f); /* sums skip values without opacity, means do not */
    k->red = k->front * length;
    k->blue = k->blue * length;
    k->transparency = v_select(shown, zero, one);
    return;
  }
  if (a->mode.sum_scale == 0.0f) {
    shown = shown & v_lt(zero, k->red);
    scale = v_reciprocal(v_max(k->red, v_set(1e-30f)));
  }
  const vfloat grey = v_select(shown, v_clamp(k->front * scale, 0.0f, 1.0f), zero);
  k->red = k->green = k->blue = grey;
  k->transparency = v_select(shown, zero, one);
}
#endif
