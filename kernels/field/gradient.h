/* SPDX-License-Identifier: BSD-3-Clause
 * The field's gradient at a sample. Included after fetch.h, once for each STRATUS_TYPE.
 *
 * It interpolates the central differences at the cell's eight corners, which is the central difference of the interpolated field. It reads
 * 32 of the 4x4x4 values about the cell. A corner that lacks a neighbour, because the volume ends or the value there is not finite, takes
 * the one-sided difference.
 *
 * Where spacing changes, a corner takes the slope of the parabola through it and its two neighbours: the mean of the slopes on both sides,
 * each weighted by the length of the other side. It is of second order on any spacing, as the central difference is on equal spacing,
 * whereas the difference of the neighbours over their distance is of first order only.
 *
 * A volume may have gradients at its values instead, which are interpolated as values are. */
#ifndef STRATUS_GRADIENT_H
#define STRATUS_GRADIENT_H
/* Interpolates, at t, the central differences at the neighbouring values `from` and `to`. lower, upper: lanes where `before`, or `after`,
 * lies beyond the volume. */
INLINE vfloat gradient_between(vfloat before, vfloat from, vfloat to, vfloat after, vfloat t, vmask lower, vmask upper)
{
  const vfloat inner = to - from, half_one = v_set(0.5f);
  const vfloat left = v_select(m_andnot(v_finite(before), lower), (to - before) * half_one, inner);
  const vfloat right = v_select(m_andnot(v_finite(after), upper), (after - from) * half_one, inner);
  return v_lerp(left, right, t);
}

/* The same where spacing changes. `cell`: between `from` and `to`. The gradient is by mean index coordinates. */
INLINE vfloat gradient_stretched(CONSTANT stratus_ray_cast_arguments* a, GLOBAL const int* grid, int axis, vint cell, vfloat before,
  vfloat from, vfloat to, vfloat after, vfloat t, vmask lower, vmask upper)
{
  const vint lengths = vi_set(a->grid.inverse_at[axis]), weights = vi_set(a->grid.weight_at[axis]), one = vi_set(1);
  const vint last = vi_set(a->values.dimensions[axis] - 2), none = vi_set(0);
  const vfloat inner = (to - from) * grid_floats(grid, lengths + cell);
  const vfloat below = (from - before) * grid_floats(grid, lengths + vi_max(cell - one, none)),
               above = (after - to) * grid_floats(grid, lengths + vi_max(vi_min(cell + one, last), none));
  const vfloat from_parabola = v_fma(grid_floats(grid, weights + cell), below - inner, inner),
               to_parabola = v_fma(grid_floats(grid, weights + cell + one), inner - above, above);
  const vfloat left = v_select(m_andnot(v_finite(before), lower), from_parabola, inner),
               right = v_select(m_andnot(v_finite(after), upper), to_parabola, inner);
  return v_lerp(left, right, t);
}

/* The derivatives along an axis that the volume has at its values. */
INLINE value_source derivatives(CONSTANT stratus_ray_cast_arguments* a, value_source values, int axis)
{
#if RAY_IN_PAGES
  (void)a;
  values.component += 1 + axis;
  return values;
#else
  return (GLOBAL const float*)values + (size_t)(1 + axis) * (size_t)(uint)a->values.gradient_at;
#endif
}

INLINE vfloat bilinear(const vfloat v[4], vfloat f, vfloat g) { return v_lerp(v_lerp(v[0], v[1], f), v_lerp(v[2], v[3], f), g); }

/* The lanes whose positions clip planes hide. */
INLINE vmask clipped_off(CONSTANT stratus_ray_cast_arguments* a, const vfloat x[3])
{
  vmask off = m_none();
  for (int plane = 0; plane < a->crop.clip_count; ++plane) {
    CONSTANT stratus_pair* n = a->crop.clip[plane];
    const vfloat height = v_fma(v_set(n[0].hi), x[0], v_fma(v_set(n[1].hi), x[1], v_fma(v_set(n[2].hi), x[2], v_set(n[3].hi))));
    off = off | v_lt(height, v_set(0.0f));
  }
  return off;
}
#endif

#if STRATUS_TYPE != -2
/* Whether the volume has gradients at its values, which are floats then. */
#undef RAY_STORED
#if STRATUS_TYPE == 8 || STRATUS_TYPE == -1
#define RAY_STORED(a) RAY_RARE(RAY_GRADIENTS, (a)->values.gradient_at)
#else
#define RAY_STORED(a) 0
#endif

/* The values i and i+1 of row (j, k). At the volume's end both are the last value. */
INLINE void RAY_NAME(fetch_two)(
  CONSTANT stratus_ray_cast_arguments* a, value_source values, vint i, vint j, vint k, vmask mask, vfloat* v0, vfloat* v1)
{
#if STRATUS_TYPE < 0 || RAY_IN_PAGES
  *v0 = RAY_NAME(fetch_nearest)(a, values, i, j, k, mask);
  *v1 = RAY_NAME(fetch_nearest)(a, values, vi_min(i + vi_set(1), vi_set(a->values.dimensions[0] - 1)), j, k, mask);
#else
  RAY_NAME(fetch_pair)(a, values, RAY_NAME(fixed_index)(a, i, j, k), mask, 1, v0, v1);
#endif
}

/* The gradient for nearest interpolation: differences at the voxel itself. */
INLINE void RAY_NAME(voxel_gradient)(
  CONSTANT stratus_ray_cast_arguments* a, value_source values, GLOBAL const int* grid, const vfloat x[3], vmask mask, vfloat g[3])
{
  vint at[3];
  vfloat snapped[3] = { x[0], x[1], x[2] };
  if (RAY_STRETCHED(a)) {
    grid_snap(a, grid, snapped);
  }
  for (int axis = 0; axis < 3; ++axis) {
    vfloat place = snapped[axis];
    if (a->values.clamp & !RAY_STRETCHED(a)) {
      place = v_clamp(place, 0.0f, a->values.last[axis]);
    }
    at[axis] = v_to_int(place + v_set(0.5f));
  }
  if (RAY_STORED(a)) {
    for (int axis = 0; axis < 3; ++axis) {
      const vfloat stored = RAY_NAME(fetch_nearest)(a, derivatives(a, values, axis), at[0], at[1], at[2], mask);
      g[axis] = stored * v_set(a->values.gradient_scale[axis]);
    }
    return;
  }
  const vfloat here = RAY_NAME(fetch_nearest)(a, values, at[0], at[1], at[2], mask), zero = v_set(0.0f);
  for (int axis = 0; axis < 3; ++axis) {
    vint side[3] = { at[0], at[1], at[2] };
    side[axis] = vi_max(at[axis] - vi_set(1), vi_set(0));
    const vfloat low = RAY_NAME(fetch_nearest)(a, values, side[0], side[1], side[2], mask);
    const vmask lower = v_finite(low) & vi_ge(at[axis], vi_set(1));
    side[axis] = vi_min(at[axis] + vi_set(1), vi_set(a->values.dimensions[axis] - 1));
    const vfloat high = RAY_NAME(fetch_nearest)(a, values, side[0], side[1], side[2], mask);
    const vmask upper = v_finite(high) & vi_lt(at[axis], vi_set(a->values.dimensions[axis] - 1));
    const vfloat difference = v_select(upper, high, here) - v_select(lower, low, here);
    g[axis] = v_select(lower & upper, difference * v_set(0.5f), v_select(lower | upper, difference, zero));
    if (RAY_STRETCHED(a)) {
      const vint lengths = vi_set(a->grid.inverse_at[axis]), last = vi_max(vi_set(a->values.dimensions[axis] - 2), vi_set(0));
      const vfloat below = (here - low) * grid_floats(grid, lengths + vi_max(at[axis] - vi_set(1), vi_set(0))),
                   above = (high - here) * grid_floats(grid, lengths + vi_min(at[axis], last));
      const vfloat parabola = v_fma(grid_floats(grid, vi_set(a->grid.weight_at[axis]) + at[axis]), below - above, above);
      g[axis] = v_select(lower & upper, parabola, v_select(lower, below, v_select(upper, above, zero)));
    }
  }
}

/* The differences between four values along an axis, interpolated at t. */
INLINE vfloat RAY_NAME(gradient_along)(CONSTANT stratus_ray_cast_arguments* a, GLOBAL const int* grid, int axis, vint cell, vfloat before,
  vfloat from, vfloat to, vfloat after, vfloat t, vmask lower, vmask upper)
{
  vfloat g = gradient_between(before, from, to, after, t, lower, upper);
  if (RAY_STRETCHED(a)) {
    g = gradient_stretched(a, grid, axis, cell, before, from, to, after, t, lower, upper);
  }
  return g;
}

/* The gradient of the whole field, as ray_gradient(). */
INLINE void RAY_NAME(field_gradient)(
  CONSTANT stratus_ray_cast_arguments* a, value_source values, GLOBAL const int* grid, const vfloat x[3], vmask mask, vfloat g[3])
{
  if (RAY_RARE(RAY_NEAREST, a->values.nearest)) {
    RAY_NAME(voxel_gradient)(a, values, grid, x, mask, g);
    return;
  }
  vint at[3], before[3], after[3];
  vfloat t[3], v[8], line[3][4];
  vmask lower[3], upper[3];
  vint cell[3];
  vfloat fraction[3];
  if (RAY_STRETCHED(a)) {
    grid_find(a, grid, x, cell, fraction);
  }
  for (int axis = 0; axis < 3; ++axis) {
    const int end = a->values.dimensions[axis] - 1;
    vfloat place = x[axis];
    if (a->values.clamp) {
      place = v_clamp(place, 0.0f, a->values.last[axis]);
    }
    at[axis] = vi_max(vi_min(v_to_int(place), vi_set(end - 1)), vi_set(0));
    t[axis] = place - v_from_int(at[axis]);
    if (RAY_STRETCHED(a)) {
      at[axis] = cell[axis];
      t[axis] = fraction[axis];
    }
    lower[axis] = vi_lt(at[axis], vi_set(1));
    upper[axis] = vi_ge(at[axis], vi_set(end - 1));
    before[axis] = vi_max(at[axis] - vi_set(1), vi_set(0));
    after[axis] = vi_min(at[axis] + vi_set(2), vi_set(end));
  }
  if (RAY_STORED(a)) {
    for (int axis = 0; axis < 3; ++axis) {
      RAY_NAME(fetch_cell)(a, derivatives(a, values, axis), at[0], at[1], at[2], mask, v);
      g[axis] = v_lerp(bilinear(v, t[0], t[1]), bilinear(v + 4, t[0], t[1]), t[2]) * v_set(a->values.gradient_scale[axis]);
    }
    return;
  }
  RAY_NAME(fetch_cell)(a, values, at[0], at[1], at[2], mask, v);
  for (int row = 0; row < 4; ++row) { /* along x, on the four edges of the cell that run along x */
    const vint j = at[1] + vi_set(row & 1), k = at[2] + vi_set(row >> 1);
    const vint y = vi_min(j, vi_set(a->values.dimensions[1] - 1)), z = vi_min(k, vi_set(a->values.dimensions[2] - 1));
    const vfloat left = RAY_NAME(fetch_nearest)(a, values, before[0], y, z, mask),
                 right = RAY_NAME(fetch_nearest)(a, values, after[0], y, z, mask);
    line[0][row] = RAY_NAME(gradient_along)(a, grid, 0, at[0], left, v[2 * row], v[2 * row + 1], right, t[0], lower[0], upper[0]);
  }
  for (int side = 0; side < 2; ++side) { /* along y on the edges at both ends of z, along z on the edges at both ends of y */
    const vint j = vi_min(at[1] + vi_set(side), vi_set(a->values.dimensions[1] - 1)),
               k = vi_min(at[2] + vi_set(side), vi_set(a->values.dimensions[2] - 1));
    vfloat low[2], high[2];
    RAY_NAME(fetch_two)(a, values, at[0], before[1], k, mask, &low[0], &low[1]);
    RAY_NAME(fetch_two)(a, values, at[0], after[1], k, mask, &high[0], &high[1]);
    for (int i = 0; i < 2; ++i) {
      line[1][i + 2 * side] =
        RAY_NAME(gradient_along)(a, grid, 1, at[1], low[i], v[i + 4 * side], v[i + 2 + 4 * side], high[i], t[1], lower[1], upper[1]);
    }
    RAY_NAME(fetch_two)(a, values, at[0], j, before[2], mask, &low[0], &low[1]);
    RAY_NAME(fetch_two)(a, values, at[0], j, after[2], mask, &high[0], &high[1]);
    for (int i = 0; i < 2; ++i) {
      line[2][i + 2 * side] =
        RAY_NAME(gradient_along)(a, grid, 2, at[2], low[i], v[i + 2 * side], v[i + 2 * side + 4], high[i], t[2], lower[2], upper[2]);
    }
  }
  g[0] = bilinear(line[0], t[1], t[2]);
  g[1] = bilinear(line[1], t[0], t[2]);
  g[2] = bilinear(line[2], t[0], t[1]);
}

/* The field at x, whatever hides it; at its end beyond. Grids of equal spacing only. */
INLINE vfloat RAY_NAME(field_at)(CONSTANT stratus_ray_cast_arguments* a, value_source values, const vfloat x[3], vmask mask)
{
  vint at[3];
  vfloat t[3], v[8];
  for (int axis = 0; axis < 3; ++axis) {
    const vfloat place = v_clamp(x[axis], 0.0f, a->values.last[axis]);
    at[axis] = v_to_int(place + v_set(RAY_RARE(RAY_NEAREST, a->values.nearest) ? 0.5f : 0.0f));
    t[axis] = place - v_from_int(at[axis]);
  }
  if (RAY_RARE(RAY_NEAREST, a->values.nearest)) {
    return RAY_NAME(fetch_nearest)(a, values, at[0], at[1], at[2], mask);
  }
  RAY_NAME(fetch_cell)(a, values, at[0], at[1], at[2], mask, v);
  return v_lerp(v_lerp(v_lerp(v[0], v[1], t[0]), v_lerp(v[2], v[3], t[0]), t[1]),
    v_lerp(v_lerp(v[4], v[5], t[0]), v_lerp(v[6], v[7], t[0]), t[1]), t[2]);
}

/* Takes the gradient anew along the axes along which a clip plane hides a neighbour, a voxel before or behind x: with clipped_value in its
 * place. A neighbour that the volume does not have, or whose value is not finite, gives way to the field at x. Not inlined: few frames ask
 * for it. */
OUTLINE void RAY_NAME(clip_gradient)(
  CONSTANT stratus_ray_cast_arguments* a, value_source values, const vfloat x[3], vmask mask, vfloat g[3])
{
  const vfloat hidden = v_set(a->crop.clipped_value), half_one = v_set(0.5f), one = v_set(1.0f);
  for (int axis = 0; axis < 3; ++axis) {
    vfloat y[2][3], value[2];
    vmask off[2], there[2];
    for (int side = 0; side < 2; ++side) {
      for (int i = 0; i < 3; ++i) {
        y[side][i] = x[i];
      }
      y[side][axis] = x[axis] + v_set(side ? 1.0f : -1.0f);
      off[side] = mask & clipped_off(a, y[side]);
      there[side] = v_le(v_set(0.0f), y[side][axis]) & v_le(y[side][axis], v_set((float)(a->values.dimensions[axis] - 1)));
    }
    const vmask any = off[0] | off[1];
    if (!m_any(any)) {
      continue;
    }
    for (int side = 0; side < 2; ++side) {
      value[side] = RAY_NAME(field_at)(a, values, y[side], any);
      there[side] = (there[side] & v_finite(value[side])) | off[side];
      value[side] = v_select(off[side], hidden, value[side]);
    }
    const vfloat here = RAY_NAME(field_at)(a, values, x, any);
    const vfloat rise = v_select(there[1], value[1], here) - v_select(there[0], value[0], here);
    g[axis] = v_select(any, rise * v_select(there[0] & there[1], half_one, one), g[axis]);
  }
}
#endif

/* g: change of the value per voxel (mean voxel) along each axis, at the position x. Lanes outside `mask` get any number. */
INLINE void RAY_NAME(ray_gradient)(
  CONSTANT stratus_ray_cast_arguments* a, value_source values, GLOBAL const int* grid, const vfloat x[3], vmask mask, vfloat g[3])
{
#if STRATUS_TYPE == -2
  RAY_READING(a)->gradient(a, values, grid, x, mask, g);
#else
  RAY_NAME(field_gradient)(a, values, grid, x, mask, g);
  if (RAY_RARE(RAY_CLIP, a->crop.clipped)) {
    RAY_NAME(clip_gradient)(a, values, x, mask, g);
  }
#endif
}
