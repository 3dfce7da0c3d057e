/* SPDX-License-Identifier: BSD-3-Clause
 * The field at a position. Included after fetch.h, once for each STRATUS_TYPE. */

/* Not finite where a corner is not, or where the cell or the value is hidden. */
INLINE vfloat RAY_NAME(ray_value)(CONSTANT stratus_ray_cast_arguments* a, value_source values, GLOBAL const uchar* hidden,
  GLOBAL const int* grid, const vfloat position[3], vmask mask)
{
#if STRATUS_TYPE == -2
  return RAY_READING(a)->value(a, values, hidden, grid, position, mask);
#else
  vfloat x[3] = { position[0], position[1], position[2] };
  const int stretched = RAY_STRETCHED(a), nearest = RAY_RARE(RAY_NEAREST, a->values.nearest);
  const int hides = RAY_RARE(RAY_HIDDEN, a->values.has_hidden) & (HIDDEN_BY_MASK | HIDDEN_CELLS);
  if (stretched) {
    if (nearest | hides) {
      vfloat y[3] = { x[0], x[1], x[2] };
      grid_snap(a, grid, y);
      for (int axis = 0; axis < 3; ++axis) {
        x[axis] = y[axis];
      }
    }
  } else if (a->values.clamp) {
    for (int axis = 0; axis < 3; ++axis) {
      x[axis] = v_clamp(x[axis], 0.0f, a->values.last[axis]);
    }
  }
  vfloat value;
  if (nearest) {
    const vfloat half_one = v_set(0.5f);
    value = RAY_NAME(fetch_nearest)(a, values, v_to_int(x[0] + half_one), v_to_int(x[1] + half_one), v_to_int(x[2] + half_one), mask);
  } else {
    vint i = v_to_int(x[0]), j = v_to_int(x[1]), k = v_to_int(x[2]);
    vfloat f = x[0] - v_from_int(i), g = x[1] - v_from_int(j), h = x[2] - v_from_int(k);
    if (stretched) {
      const vfloat y[3] = { position[0], position[1], position[2] };
      vint cell[3];
      vfloat fraction[3];
      grid_find(a, grid, y, cell, fraction);
      i = cell[0], j = cell[1], k = cell[2];
      f = fraction[0], g = fraction[1], h = fraction[2];
    }
    vfloat v[8];
    RAY_NAME(fetch_cell)(a, values, i, j, k, mask, v);
    value = v_lerp(v_lerp(v_lerp(v[0], v[1], f), v_lerp(v[2], v[3], f), g), v_lerp(v_lerp(v[4], v[5], f), v_lerp(v[6], v[7], f), g), h);
  }
  if (hides) {
    value = ray_hide(a, hidden, x, mask, value);
  }
  return value;
#endif
}
