/* SPDX-License-Identifier: BSD-3-Clause
 * Isosurfaces along a packet of rays, cell by cell. Along a ray the field in a cell is a cubic, whose roots are where the ray meets the
 * surfaces. Included by ray_cast.h with STRATUS_RAY_MODE set to STRATUS_RAY_ISOSURFACE.
 *
 * A ray meets plane n of an axis at (n - p) / d, rounded once, and passes from cell to cell at these numbers only. A leap ends at such a
 * number, too. So the cells behind a leap are those to which a walk without leaps would have come, and the bits do not depend on the
 * structure. */
#ifndef STRATUS_RAY_ISOSURFACE_H
#define STRATUS_RAY_ISOSURFACE_H

#include "cell_cubic.h"

/* Not inlined: few cells come this far, and the code is long. */
#ifdef STRATUS_DEVICE
#define SURFACE_OUTLINE static
#else
#define SURFACE_OUTLINE static __attribute__((noinline))
#endif

/* Where the ray is: s, the cell, and the planes by which it enters and leaves the cell. */
typedef struct surface_walk {
  vfloat s, leave, end;
  vfloat enter_at[3], leave_at[3];
  vint cell[3];
  vfloat run; /* up to this s the structure need not be asked */
} surface_walk;

INLINE vfloat plane_met(const stratus_packet* k, int axis, vint plane) { return (v_from_int(plane) - k->p[axis]) * k->inverse[axis]; }

/* The cell that each ray enters at its point s. */
INLINE void surface_cell(const stratus_packet* k, surface_walk* w)
{
  const vfloat zero = v_set(0.0f), one = v_set(1.0f);
  const vint step = vi_set(1), none = vi_set(0);
  w->leave = w->end;
  for (int axis = 0; axis < 3; ++axis) {
    const vmask forward = v_lt(zero, k->inverse[axis]);
    vint cell = v_to_int(v_fma(w->s, k->d[axis], k->p[axis]) + one) - step; /* never below -1 */
    /* the product is rounded, so that the cell may be one off */
    const vfloat before = plane_met(k, axis, vi_select(forward, cell, cell + step));
    cell = cell - vi_select(v_lt(w->s, before), vi_select(forward, step, none - step), none);
    const vfloat after = plane_met(k, axis, vi_select(forward, cell + step, cell));
    cell = cell + vi_select(v_le(after, w->s), vi_select(forward, step, none - step), none);
    w->cell[axis] = cell;
    w->enter_at[axis] = plane_met(k, axis, vi_select(forward, cell, cell + step));
    w->leave_at[axis] = plane_met(k, axis, vi_select(forward, cell + step, cell));
    w->leave = v_min(w->leave_at[axis], w->leave);
  }
}

/* The cell whose values are read. Where positions are clamped that is the border's cell. */
INLINE vint surface_inside(CONSTANT stratus_ray_cast_arguments* a, const surface_walk* w, int axis)
{
  return vi_max(vi_min(w->cell[axis], vi_set(a->values.dimensions[axis] - 2)), vi_set(0));
}

/* The fraction of the cell along an axis at point s of the ray: exactly 0 or 1 where the ray meets the plane at s. */
INLINE vfloat surface_fraction(const stratus_packet* k, int axis, vint inside, vfloat s, vfloat met, vint plane)
{
  const vfloat base = v_from_int(inside), at = v_fma(s, k->d[axis], k->p[axis]) - base, exact = v_from_int(plane) - base;
  const vmask there = v_le(met, s) & v_le(s, met);
  return v_clamp(v_select(there, exact, at), 0.0f, 1.0f);
}

/* Leaps over cubes of blocks that hold no contour value. */
INLINE void surface_skip(CONSTANT stratus_ray_cast_arguments* a, GLOBAL const uchar* map, stratus_packet* k, surface_walk* w)
{
  vmask need = k->live & v_le(w->run, w->s);
  while (m_any(need)) {
    vint block[3], byte;
    for (int axis = 0; axis < 3; ++axis) {
      block[axis] = surface_inside(a, w, axis) >> vi_set(a->map.block_log2);
    }
    if (a->map.tree) {
      byte = tree_bytes(a, map, block, need);
    } else {
      byte = gather_map(map, block[0] + (block[1] + block[2] * vi_set(a->map.rows)) * vi_set(a->map.pitch) + k->octant, need);
    }
    k->lookups -= mask_int(need);
    const vmask occupied = need & vi_ge(byte, vi_set(128));
    const vint distance = byte & vi_set(127);
    vfloat leave = w->end;
    for (int axis = 0; axis < 3; ++axis) {
      const vmask forward = v_lt(v_set(0.0f), k->inverse[axis]);
      const vint face = vi_select(forward, block[axis] + distance, block[axis] - distance + vi_set(1));
      leave = v_min(plane_met(k, axis, face << vi_set(a->map.block_log2)), leave);
    }
    const vmask leap = m_andnot(need, occupied) & v_lt(w->s, leave); /* in the volume's rim, where values are clamped, there is no leap */
    w->run = v_select(m_andnot(need, leap), v_max(leave, w->leave), w->run);
    leave = v_select(leap, leave, w->s); /* in other lanes a plane may be farther than an int can hold */
    k->skipped = k->skipped + (v_to_int(leave) - v_to_int(w->s));
    w->s = leave;
    k->live = m_andnot(k->live, leap & v_le(w->end, w->s));
    need = leap & k->live;
    if (m_any(need)) {
      surface_cell(k, w);
    }
  }
}

/* Lanes whose cell holds a surface: its corners are finite and lie on both sides of a contour value. */
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
SURFACE_OUTLINE void RAY_NAME(surface_show)(CONSTANT stratus_ray_cast_arguments* a, GLOBAL const void* values, GLOBAL const uchar* hidden,
  stratus_packet* k, vmask mask, vfloat s, vfloat layer[4])
{
  vfloat x[3];
  for (int axis = 0; axis < 3; ++axis) {
    x[axis] = v_fma(s, k->d[axis], k->p[axis]);
    if (a->values.clamp) {
      x[axis] = v_clamp(x[axis], 0.0f, a->values.last[axis]);
    }
  }
  if (a->values.has_hidden & HIDDEN_BY_MASK) {
    mask = mask & v_finite(ray_hide_by(a, hidden, HIDDEN_BY_MASK, x, mask, v_set(0.0f)));
  }
  if (a->light.on) {
    vfloat g[3];
    stratus_lit_sample lighting;
    RAY_NAME(ray_gradient)(a, values, x, mask, g);
    ray_light(a, x, k->d, g, lighting.diffuse, lighting.specular);
    light_layer(&lighting, layer);
  }
  for (int c = 0; c < 4; ++c) {
    layer[c] = v_select(mask, layer[c], v_set(0.0f));
  }
  composite(a, k, mask, layer, s);
  k->live = m_andnot(k->live, mask & v_lt(k->transparency, v_set(a->termination)));
}

/* Composites all surfaces in the cells of the rays in `mask`, in the order in which the rays meet them: piece by piece, and within a piece
 * by rising or falling values. */
SURFACE_OUTLINE void RAY_NAME(surface_roots)(CONSTANT stratus_ray_cast_arguments* a, GLOBAL const void* values, GLOBAL const uchar* hidden,
  stratus_packet* k, const surface_walk* w, const stratus_cubic* cubic, vmask mask)
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
        RAY_NAME(surface_show)(a, values, hidden, k, meets, v_fma(at, w->leave - w->s, w->s), layer);
      }
    }
  }
}

/* Visits the cell of every live ray. */
INLINE void RAY_NAME(surface_visit)(
  CONSTANT stratus_ray_cast_arguments* a, GLOBAL const void* values, GLOBAL const uchar* hidden, stratus_packet* k, const surface_walk* w)
{
  vint inside[3];
  vfloat v[8];
  for (int axis = 0; axis < 3; ++axis) {
    inside[axis] = surface_inside(a, w, axis);
  }
  RAY_NAME(fetch_cell)(a, values, inside[0], inside[1], inside[2], k->live, v);
  k->samples -= mask_int(k->live);
  vmask crosses = surface_crosses(a, v, k->live);
  if (m_any(crosses) && (a->values.has_hidden & HIDDEN_CELLS)) {
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
      e[axis] = surface_fraction(k, axis, inside[axis], w->s, w->enter_at[axis], vi_select(forward, low, high));
      f[axis] = surface_fraction(k, axis, inside[axis], w->leave, w->leave_at[axis], vi_select(forward, high, low));
    }
    cubic_of_cell(v, e, f, &cubic);
    RAY_NAME(surface_roots)(a, values, hidden, k, w, &cubic, crosses);
  }
}

INLINE void RAY_NAME(ray_march)(CONSTANT stratus_ray_cast_arguments* a, GLOBAL const void* values, GLOBAL const uchar* hidden,
  GLOBAL const uchar* map, GLOBAL const void* table, stratus_packet* k)
{
  surface_walk w;
  (void)table;
  if (!m_any(k->live)) {
    return;
  }
  w.s = v_max(v_from_int(k->i), k->begin);
  w.end = v_min(v_from_int(k->last), k->end);
  w.run = v_select(v_lt(v_from_int(k->run), v_set(1.0f)), v_set(-1.0f), v_set(LARGEST_FLOAT));
  k->live = k->live & v_lt(w.s, w.end);
  w.s = v_select(k->live, w.s, v_set(0.0f)); /* lanes that are not live stay at a harmless place */
  w.end = v_select(k->live, w.end, v_set(0.0f));
  while (m_any(k->live)) {
    surface_cell(k, &w);
    if (a->map.structure) {
      surface_skip(a, map, k, &w);
    }
    RAY_NAME(surface_visit)(a, values, hidden, k, &w);
    /* a ray always advances, even where two planes are too near for floats to tell apart */
    w.s = v_select(k->live, v_select(v_lt(w.s, w.leave), w.leave, v_fma(w.s, v_set(1e-6f), w.s + v_set(1e-6f))), w.s);
    k->live = k->live & v_lt(w.s, w.end);
  }
}

#if PACKETS_TOGETHER == 2
INLINE void RAY_NAME(ray_march_two)(CONSTANT stratus_ray_cast_arguments* a, GLOBAL const void* values, GLOBAL const uchar* hidden,
  GLOBAL const uchar* map, GLOBAL const void* table, stratus_packet* left, stratus_packet* right)
{
  RAY_NAME(ray_march)(a, values, hidden, map, table, left);
  RAY_NAME(ray_march)(a, values, hidden, map, table, right);
}
#endif

INLINE void RAY_NAME(ray_finish)(CONSTANT stratus_ray_cast_arguments* a, GLOBAL const void* table, stratus_packet* k)
{
  (void)a;
  (void)table;
  (void)k;
}
