/* SPDX-License-Identifier: BSD-3-Clause
 * Colour and opacity by a function of two variables: the value, and the gradient's magnitude or the value of a second component. Included
 * by ray_cast.h once for each STRATUS_TYPE.
 *
 * The function is bilinear between its entries. A structure knows only a block's values: where all entries of the columns about them are
 * transparent, then every interpolation between them is transparent, too, exactly. */
#ifndef STRATUS_FUNCTION_2D_H
#define STRATUS_FUNCTION_2D_H

/* The entry at or before a place in entries, and in *part the way to the next; nearest interpolation takes the nearest entry. */
INLINE vint entry_before(CONSTANT stratus_ray_cast_arguments* a, vfloat place, int entries, vfloat* part)
{
  const vint entry = vi_min(v_to_int(place), vi_set(entries - 2));
  *part = place - v_from_int(entry);
  if (RAY_RARE(RAY_NEAREST, a->values.nearest)) {
    *part = v_select(v_lt(*part, v_set(0.5f)), v_set(0.0f), v_set(1.0f));
  }
  return entry;
}

/* The place of numbers among the columns (axis 0) or rows (axis 1). */
INLINE vfloat entry_place(CONSTANT stratus_ray_cast_arguments* a, int axis, vfloat number)
{
  CONSTANT stratus_ray_function_2d* t = &a->transfer_2d;
  return v_clamp(v_fma(number - v_set(t->base[axis]), v_set(t->scale[axis]), v_set(-0.5f)), 0.0f, t->last[axis]);
}

/* The lanes whose columns show anything in some row. */
INLINE vmask columns_show(CONSTANT stratus_ray_cast_arguments* a, GLOBAL const float* table, vint column, vfloat part, vmask mask)
{
  GLOBAL const int* opacities = (GLOBAL const int*)(table + a->transfer_2d.opacity_at);
  const vfloat low = v_from_bits(v_gather_ints(opacities, column, mask)), high = v_from_bits(v_gather_ints(opacities + 1, column, mask));
  return mask & v_lt(v_set(0.0f), v_lerp(low, high, part));
}

/* The magnitude of an index gradient, per mean spacing. Rows end long before magnitudes whose squares are no floats. */
INLINE vfloat gradient_magnitude(CONSTANT stratus_ray_cast_arguments* a, const vfloat g[3])
{
  vfloat v[3];
  for (int axis = 0; axis < 3; ++axis) {
    v[axis] = g[axis] * v_set(a->media.gradient_length[axis]);
  }
  const vfloat largest = v_scale3(v), square = v_dot3(v, v);
  const vmask any = v_lt(v_set(0.0f), largest) & v_lt(v_set(0.0f), square) & v_finite(square);
  const vfloat length = square * v_inverse_root(v_select(any, square, v_set(1.0f)));
  /* v_scale3() has brought the largest component to 1..4 */
  const vfloat reached = v_max(v_max(v_abs(v[0]), v_abs(v[1])), v_abs(v[2]));
  return v_select(any, largest * (length * v_reciprocal(v_select(any, reached, v_set(1.0f)))), v_set(0.0f));
}

/* Colour and opacity between four entries. */
INLINE void between_entries(CONSTANT stratus_ray_cast_arguments* a, GLOBAL const float* table, vint column, vint row, vfloat across,
  vfloat up, vmask mask, vfloat out[4])
{
  const vint entry = row * vi_set(a->transfer_2d.columns) + column, above = entry + vi_set(a->transfer_2d.columns);
  vfloat corner[4][4];
  gather_four(table, entry, mask, corner[0]);
  gather_four(table, entry + vi_set(1), mask, corner[1]);
  gather_four(table, above, mask, corner[2]);
  gather_four(table, above + vi_set(1), mask, corner[3]);
  for (int c = 0; c < 4; ++c) {
    out[c] = v_lerp(v_lerp(corner[0][c], corner[1][c], across), v_lerp(corner[2][c], corner[3][c], across), up);
  }
}

/* The optical depth of an opacity, over the length that opacities are of. */
INLINE vfloat depth_of_entry(vfloat entry)
{
  const vfloat one = v_set(1.0f), opacity = v_clamp(entry, 0.0f, 1.0f);
  return v_select(v_lt(opacity, one), depth_of_opacity(opacity, one - opacity), v_set(1e18f));
}
#endif

/* Compute the colour and opacity of samples whose values are at `across` behind a column: `shown` has colour and, last, opacity over the
 * length to which opacities refer. lighting: set if there is light. Returns the rays of the mask on which anything shows. */
OUTLINE vmask RAY_NAME(two_at)(CONSTANT stratus_ray_cast_arguments* a, GLOBAL const float* table, const stratus_packet* k,
  const stratus_sample* sample, vint column, vfloat across, vmask mask, vfloat shown[4], stratus_lit_sample* lighting)
{
  const vfloat s = v_fma(v_set(0.5f), sample->weight, sample->lo), zero = v_set(0.0f);
  const vfloat x[3] = { v_fma(s, k->d[0], k->p[0]), v_fma(s, k->d[1], k->p[1]), v_fma(s, k->d[2], k->p[2]) };
  const int by_gradient = !a->transfer_2d.second;
  vfloat g[3] = { zero, zero, zero }, number, up;
  if (by_gradient) {
    RAY_NAME(ray_gradient)(a, sample->values, k->grid, x, mask, g);
    number = gradient_magnitude(a, g);
  } else {
    number = RAY_NAME(component_value)(a, k, sample, 1, mask);
    mask = mask & v_finite(number);
    number = v_select(mask, number, zero);
  }
  const vint row = entry_before(a, entry_place(a, 1, number), a->transfer_2d.rows, &up);
  between_entries(a, table, column, row, across, up, mask, shown);
  mask = mask & v_lt(zero, shown[3]);
  if (a->light.on && m_any(mask)) {
    if (!by_gradient && light_reflects(&a->light)) {
      RAY_NAME(ray_gradient)(a, sample->values, k->grid, x, mask, g);
    }
    light_at(&a->light, k->lights, 0, 0, x, k->d, g, lighting->diffuse, lighting->specular, 0);
  }
  return mask;
}
