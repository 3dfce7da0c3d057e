/* SPDX-License-Identifier: BSD-3-Clause
 * Isosurfaces along a packet of rays, cell by cell. Along a ray the field in a cell is a cubic, whose roots are where the ray meets the
 * surfaces. Included by ray_cast.h with STRATUS_RAY_MODE set to STRATUS_RAY_ISOSURFACE. */
#ifndef STRATUS_RAY_ISOSURFACE_H
#define STRATUS_RAY_ISOSURFACE_H

/* Lanes whose cell holds a surface: its corners are finite and on both sides of a contour value. */
INLINE vmask surface_crosses(CONSTANT stratus_ray_cast_arguments* a, const vfloat v[8], vmask mask)
{
  vfloat lo = v[0], hi = v[0];
  mask = mask & v_finite(v[0]);
  for (int corner = 1; corner < 8; ++corner) {
    mask = mask & v_finite(v[corner]);
    lo = v_min(lo, v[corner]);
    hi = v_max(hi, v[corner]);
  }
  vmask any = m_none();
  for (int n = 0; n < a->mode.contour_count; ++n) {
    any = any | (v_lt(lo, v_set(a->mode.contour[n][0])) & v_le(v_set(a->mode.contour[n][0]), hi));
  }
  return mask & any;
}

#endif

/* Composites the surface at point s of the rays. */
OUTLINE void RAY_NAME(surface_show)(CONSTANT stratus_ray_cast_arguments* a, value_source values, GLOBAL const uchar* hidden,
  GLOBAL const void* table, stratus_packet* k, vmask mask, vfloat s, vfloat layer[4])
{
  if (RAY_RARE(RAY_COMPONENTS, a->media.dependent)) { /* the last component has the surface and its opacity */
    vfloat color[4];
    mask = RAY_NAME(dependent_color)(a, table, values, hidden, k, s, mask, color);
    for (int c = 0; c < 3; ++c) {
      layer[c] = color[c] * layer[3];
    }
  }
  vfloat x[3];
  for (int axis = 0; axis < 3; ++axis) {
    x[axis] = v_fma(s, k->d[axis], k->p[axis]);
    if (a->values.clamp & !RAY_STRETCHED(a)) {
      x[axis] = v_clamp(x[axis], 0.0f, a->values.last[axis]);
    }
  }
  if (RAY_RARE(RAY_HIDDEN, a->values.has_hidden) & HIDDEN_BY_MASK) {
    vfloat snapped[3] = { x[0], x[1], x[2] };
    if (RAY_STRETCHED(a)) {
      grid_snap(a, k->grid, snapped);
    }
    mask = mask & v_finite(ray_hide_by(a, hidden, HIDDEN_BY_MASK, snapped, mask, v_set(0.0f)));
  }
  if (a->light.on) {
    vfloat g[3] = { v_set(0.0f), v_set(0.0f), v_set(0.0f) };
    stratus_lit_sample lighting;
    if (light_reflects(&a->light)) {
      RAY_NAME(ray_gradient)(a, FOLLOWED_VALUES(a, values), k->grid, x, mask, g);
    }
    light_at(&a->light, k->lights, 0, 0, x, k->d, g, lighting.diffuse, lighting.specular, 0);
    light_layer(&lighting, layer);
  }
  for (int c = 0; c < 4; ++c) {
    layer[c] = v_select(mask, layer[c], v_set(0.0f));
  }
  composite(a, k, mask, layer, s);
  surface_kept(a, k, mask);
  k->live = m_andnot(k->live, mask & v_lt(k->transparency, v_set(a->termination)));
}

/* Composites all surfaces in the cells of the rays in `mask`, in the order in which the rays meet them: piece by piece, and within a piece
 * by rising or falling values. */
OUTLINE void RAY_NAME(surface_roots)(CONSTANT stratus_ray_cast_arguments* a, value_source values, GLOBAL const uchar* hidden,
  GLOBAL const void* table, stratus_packet* k, const cell_walk* w, const stratus_cubic* cubic, vmask mask)
{
  for (int piece = 0; piece < 3; ++piece) {
    const vfloat from = cubic->value[piece], to = cubic->value[piece + 1];
    const vmask rising = v_lt(from, to);
    for (int n = 0; n < a->mode.contour_count; ++n) {
      CONSTANT float *up = a->mode.contour[n], *down = a->mode.contour[a->mode.contour_count - 1 - n];
      const vfloat level = v_select(rising, v_set(up[0]), v_set(down[0]));
      const vmask below = v_lt(from, level), ends_below = v_lt(to, level);
      const vmask meets = mask & k->live & (m_andnot(below, ends_below) | m_andnot(ends_below, below));
      if (m_any(meets)) {
        const vfloat at = cubic_root(cubic, piece, level, below);
        vfloat layer[4];
        for (int c = 0; c < 4; ++c) {
          layer[c] = v_select(rising, v_set(up[1 + c]), v_set(down[1 + c]));
        }
        RAY_NAME(surface_show)(a, values, hidden, table, k, meets, v_fma(at, w->leave - w->s, w->s), layer);
      }
    }
  }
}

/* Visits the cell of every live ray. */
INLINE void RAY_NAME(surface_visit)(CONSTANT stratus_ray_cast_arguments* a, value_source values, GLOBAL const uchar* hidden,
  GLOBAL const void* table, stratus_packet* k, const cell_walk* w)
{
  vint inside[3];
  vfloat v[8];
  for (int axis = 0; axis < 3; ++axis) {
    inside[axis] = cell_inside(a, w, axis);
  }
  RAY_NAME(fetch_cell)(a, FOLLOWED_VALUES(a, values), inside[0], inside[1], inside[2], k->live, v);
  k->samples -= mask_int(k->live);
  vmask crosses = surface_crosses(a, v, k->live);
  if (RAY_RARE(RAY_HIDDEN, a->values.has_hidden & HIDDEN_CELLS) && m_any(crosses)) {
    vfloat x[3];
    for (int axis = 0; axis < 3; ++axis) {
      x[axis] = v_from_int(inside[axis]);
    }
    crosses = crosses & v_finite(ray_hide_by(a, hidden, HIDDEN_CELLS, x, crosses, v_set(0.0f)));
  }
  if (m_any(crosses)) {
    vfloat e[3], f[3];
    stratus_cubic cubic;
    for (int axis = 0; axis < 3; ++axis) {
      const vmask forward = v_lt(v_set(0.0f), k->inverse[axis]);
      const vint low = w->cell[axis], high = low + vi_set(1);
      e[axis] = cell_fraction(a, k, axis, inside[axis], w->s, w->enter_at[axis], vi_select(forward, low, high));
      f[axis] = cell_fraction(a, k, axis, inside[axis], w->leave, w->leave_at[axis], vi_select(forward, high, low));
    }
    cubic_of_cell(v, e, f, &cubic);
    RAY_NAME(surface_roots)(a, values, hidden, table, k, w, &cubic, crosses);
  }
}

INLINE void RAY_NAME(ray_march)(CONSTANT stratus_ray_cast_arguments* a, value_source values, GLOBAL const uchar* hidden,
  GLOBAL const uchar* map, GLOBAL const uchar* rough, GLOBAL const void* table, stratus_packet* k)
{
  cell_walk w;
  (void)rough;
  if (!m_any(k->live) || !cell_begin(k, 0, 0, &w)) {
    return;
  }
  cell_enter(a, k, &w);
  do {
    if (a->map.structure) {
      cell_skip(a, map, k, k->live & v_le(w.run, w.s), &w);
    }
    RAY_NAME(surface_visit)(a, values, hidden, table, k, &w);
    cell_leave(a, k, k->live, &w);
  } while (m_any(k->live));
}
