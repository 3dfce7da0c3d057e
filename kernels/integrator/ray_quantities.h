/* SPDX-License-Identifier: BSD-3-Clause
 * Quantities of the field along a packet of rays, cell by cell. Along a ray the field in a cell is a cubic: its integral has a closed form,
 * and its largest value is at an end or where it turns. Included by ray_cast.h with STRATUS_RAY_MODE set to STRATUS_RAY_QUANTITIES.
 *
 * A pixel holds: red, the largest value; green, the integral of the field; blue, the length on which the field has a value; alpha, 1 where
 * that length is not 0; depth, where the largest value is; samples, the number of cells. Values are relative to the bias of the volume's
 * fetches. Lengths are the world's. */
#ifndef STRATUS_RAY_QUANTITIES_H
#define STRATUS_RAY_QUANTITIES_H

/* The largest value of a cubic in 0..1, and where it is. */
INLINE vfloat cubic_largest(const vfloat k[4], vfloat* at)
{
  vfloat turn[2], largest = k[0];
  *at = v_set(0.0f);
  cubic_turns(k, &turn[0], &turn[1]);
  for (int i = 0; i < 3; ++i) {
    const vfloat w = i < 2 ? turn[i] : v_set(1.0f), value = v_fma(v_fma(v_fma(k[3], w, k[2]), w, k[1]), w, k[0]);
    const vmask better = v_lt(largest, value);
    largest = v_select(better, value, largest);
    *at = v_select(better, w, *at);
  }
  return largest;
}

/* The fraction of the cell along an axis at point s of the ray, in 0..1. Half cells have positions in halves. */
INLINE vfloat quantities_place(
  CONSTANT stratus_ray_cast_arguments* a, const stratus_packet* k, const cell_walk* w, int axis, vint inside, vfloat s)
{
  vfloat place = cell_place(a, k, axis, inside, s);
  if (w->halves && !RAY_STRETCHED(a)) {
    place = v_clamp(v_fma(v_set(0.5f), v_fma(s, k->d[axis], k->p[axis]), v_set(0.0f) - v_from_int(inside)), 0.0f, 1.0f);
  }
  return place;
}

#endif

/* The cubic of the cell, or of the half cell, that each ray is in. Returns the rays of the mask on which it has a value. With nearest
 * interpolation it is a constant. */
INLINE vmask RAY_NAME(quantities_cell)(CONSTANT stratus_ray_cast_arguments* a, value_source values, GLOBAL const uchar* hidden,
  const stratus_packet* k, const cell_walk* w, const vint inside[3], const vint nearest[3], vmask mask, vfloat cubic[4])
{
  const int hides = RAY_RARE(RAY_HIDDEN, a->values.has_hidden) & (HIDDEN_BY_MASK | HIDDEN_CELLS);
  cubic[1] = cubic[2] = cubic[3] = v_set(0.0f);
  if (RAY_RARE(RAY_NEAREST, a->values.nearest)) {
    cubic[0] = RAY_NAME(fetch_nearest)(a, values, nearest[0], nearest[1], nearest[2], mask);
    mask = mask & v_finite(cubic[0]);
  } else {
    vfloat v[8], e[3], d[3];
    RAY_NAME(fetch_cell)(a, values, inside[0], inside[1], inside[2], mask, v);
    vfloat nothing = v[0] * v_set(0.0f); /* not a number where a corner is not finite */
    for (int corner = 1; corner < 8; ++corner) {
      nothing = v_fma(v[corner], v_set(0.0f), nothing);
    }
    mask = mask & v_le(nothing, v_set(0.0f));
    for (int axis = 0; axis < 3; ++axis) {
      e[axis] = quantities_place(a, k, w, axis, inside[axis], w->s);
      d[axis] = quantities_place(a, k, w, axis, inside[axis], w->leave) - e[axis];
    }
    cubic_coefficients(v, e, d, cubic);
  }
  if (hides & HIDDEN_BY_MASK) {
    const vfloat x[3] = { v_from_int(nearest[0]), v_from_int(nearest[1]), v_from_int(nearest[2]) };
    mask = mask & v_finite(ray_hide_by(a, hidden, HIDDEN_BY_MASK, x, mask, v_set(0.0f)));
  }
  if (hides & HIDDEN_CELLS) {
    const int of_values = RAY_RARE(RAY_NEAREST, a->values.nearest) && !w->halves; /* each box is in one cell, or is one */
    vfloat x[3];
    for (int axis = 0; axis < 3; ++axis) {
      x[axis] = v_from_int(of_values ? nearest[axis] : inside[axis]);
    }
    mask = mask & v_finite(ray_hide_by(a, hidden, HIDDEN_CELLS, x, mask, v_set(0.0f)));
  }
  return mask;
}

/* Adds the cell of every live ray. last: the cell that each ray has counted last. */
INLINE void RAY_NAME(quantities_visit)(CONSTANT stratus_ray_cast_arguments* a, value_source values, GLOBAL const uchar* hidden,
  stratus_packet* k, const cell_walk* w, vint last[3])
{
  const int by_value = RAY_RARE(RAY_NEAREST, a->values.nearest) != 0;
  const vfloat zero = v_set(0.0f);
  vint inside[3], nearest[3];
  vfloat cubic[4], at;
  for (int axis = 0; axis < 3; ++axis) {
    inside[axis] = cell_inside(a, w, axis);
    nearest[axis] = (w->cell[axis] + vi_set(w->halves)) >> vi_set(w->halves);
    nearest[axis] = vi_max(vi_min(nearest[axis], vi_set(a->values.dimensions[axis] - 1)), vi_set(0));
  }
  const vmask mask = RAY_NAME(quantities_cell)(a, values, hidden, k, w, inside, nearest, k->live & v_lt(w->s, w->leave), cubic);
  if (!m_any(mask)) {
    return;
  }
  vint other = vi_set(0);
  for (int axis = 0; axis < 3; ++axis) {
    const vint cell = by_value ? nearest[axis] : inside[axis];
    other = other | (cell - last[axis]);
    last[axis] = vi_select(mask, cell, last[axis]);
  }
  k->samples -= mask_int(m_andnot(mask, vi_zero(other)));
  const vfloat extent = w->leave - w->s, length = v_select(mask, packet_length(a, k, extent) * v_set(a->lattice.step), zero);
  const vfloat mean = v_fma(v_set(0.25f), cubic[3], v_fma(v_set(1.0f / 3.0f), cubic[2], v_fma(v_set(0.5f), cubic[1], cubic[0])));
  k->green = v_fma(v_select(mask, mean, zero), length, k->green);
  k->blue = k->blue + length;
  const vfloat largest = cubic_largest(cubic, &at);
  const vmask better = mask & v_lt(k->front, largest);
  k->front = v_select(better, largest, k->front);
  k->depth = v_select(better, packet_length(a, k, v_fma(at, extent, w->s) + k->first) * v_set(a->lattice.step), k->depth);
}

/* A mask hides the boxes about values: then the planes are half a cell apart, as where hidden cells cut boxes of nearest interpolation. */
INLINE void RAY_NAME(ray_march)(CONSTANT stratus_ray_cast_arguments* a, value_source values, GLOBAL const uchar* hidden,
  GLOBAL const uchar* map, GLOBAL const uchar* rough, GLOBAL const void* table, stratus_packet* k)
{
  if (!m_any(k->live)) {
    return;
  }
  const int nearest = RAY_RARE(RAY_NEAREST, a->values.nearest) != 0, hides = RAY_RARE(RAY_HIDDEN, a->values.has_hidden);
  const int halves = nearest ? (hides & HIDDEN_CELLS) != 0 && !a->values.clamp : (hides & HIDDEN_BY_MASK) != 0;
  const vfloat p[3] = { k->p[0], k->p[1], k->p[2] }, d[3] = { k->d[0], k->d[1], k->d[2] },
               inverse[3] = { k->inverse[0], k->inverse[1], k->inverse[2] };
  vint last[3] = { vi_set(-1), vi_set(-1), vi_set(-1) };
  cell_walk w;
  (void)rough;
  (void)table;
  if (nearest || halves) {
    cell_boxes(a, k, halves);
  }
  if (cell_begin(k, halves, nearest && !halves, &w)) {
    cell_enter(a, k, &w);
    do {
      if (a->map.structure) {
        cell_skip(a, map, k, cell_lanes_to_skip(k->live, &w), &w);
      }
      RAY_NAME(quantities_visit)(a, values, hidden, k, &w, last);
      cell_leave(a, k, k->live, &w);
    } while (m_any(k->live));
  }
  for (int axis = 0; axis < 3; ++axis) { /* the next crop region begins anew */
    k->p[axis] = p[axis];
    k->d[axis] = d[axis];
    k->inverse[axis] = inverse[axis];
  }
}

INLINE void RAY_NAME(ray_finish)(
  CONSTANT stratus_ray_cast_arguments* a, value_source values, GLOBAL const uchar* hidden, GLOBAL const void* table, stratus_packet* k)
{
  const vmask found = v_lt(v_set(0.0f), k->blue);
  (void)a;
  (void)values;
  (void)hidden;
  (void)table;
  k->red = v_select(found, k->front, v_set(0.0f));
  k->transparency = v_select(found, v_set(0.0f), v_set(1.0f));
  k->depth = v_select(found, k->depth, v_set(LARGEST_FLOAT));
}
