/* SPDX-License-Identifier: BSD-3-Clause
 * Rays that gather no light: the largest or smallest value of their samples, or a sum. Included by ray_cast.h with STRATUS_RAY_MODE set. A
 * segment that the structure leaves out would have changed nothing, so that skipping is as exact here as it is for light.
 *
 * Pictures of several grids are put together from the states of their rays (Core/ray_cast/ray_kept.h). A pixel then holds such a state:
 * red is the best value, or the integral of opacity times grey; green is the length on which values count, of means only; blue is the
 * integral of the opacity, of sums and means. Lengths are the world's. Alpha is 1 where the ray has a state. */

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
  RAY_NAME(ray_advance)(k, v_le(v_set(a->mode.top), k->front)); /* no value of the volume is better */
}

/* The colour of the best value; nothing where the table shows it transparent. */
INLINE void RAY_NAME(ray_finish)(CONSTANT stratus_ray_cast_arguments* a, GLOBAL const void* table, stratus_packet* k)
{
  const vmask found = k->hits & v_lt(v_set(-LARGEST_FLOAT), k->front);
  vfloat layer[4];
  if (a->mode.kept) {
    const vfloat value = v_set(a->mode.sign) * k->front;
    const vmask counts = found & v_le(v_set(a->mode.counted_first), value) & v_le(value, v_set(a->mode.counted_last));
    k->red = v_select(counts, value, v_set(0.0f));
    k->transparency = v_select(counts, v_set(0.0f), v_set(1.0f));
    k->depth = v_select(counts, k->depth, v_set(LARGEST_FLOAT));
    return;
  }
  gather_four((GLOBAL const float*)table, table_entry(&a->table, table, v_set(a->mode.sign) * k->front), found, layer);
  k->red = layer[0];
  k->green = layer[1];
  k->blue = layer[2];
  k->transparency = v_set(1.0f) - layer[3];
  k->depth = v_select(v_lt(v_set(0.0f), layer[3]), k->depth, v_set(LARGEST_FLOAT));
}

#else
/* Adds opacity times value, where a value counts as its part of the range that is shown from black to white. */
INLINE void RAY_NAME(ray_shade)(
  CONSTANT stratus_ray_cast_arguments* a, GLOBAL const void* table, stratus_packet* k, const stratus_sample* sample)
{
  const vfloat value = sample->value;
  const vmask counts = k->live & v_finite(value) & v_le(v_set(a->mode.counted_first), value) & v_le(value, v_set(a->mode.counted_last));
  vfloat layer[4];
  gather_four((GLOBAL const float*)table, table_entry(&a->table, table, value), counts, layer);
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
INLINE void RAY_NAME(ray_finish)(CONSTANT stratus_ray_cast_arguments* a, GLOBAL const void* table, stratus_packet* k)
{
  const vfloat zero = v_set(0.0f), one = v_set(1.0f);
  vmask shown = k->hits;
  vfloat scale = v_set(a->mode.sum_scale);
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
  (void)table;
  k->red = k->green = k->blue = grey;
  k->transparency = v_select(shown, zero, one);
}
#endif
