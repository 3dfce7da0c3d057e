/* SPDX-License-Identifier: BSD-3-Clause
 * Light along a packet of rays, cell by cell. Along a ray the field in a cell is a cubic. The way through a cell is cut into pieces in
 * which the cubic hardly departs from its chord, and each piece is pre-integrated between the values at its ends. With nearest
 * interpolation the cells are the boxes about the values, and each is one piece. Included by ray_cast.h with STRATUS_RAY_MODE set to
 * STRATUS_RAY_CELLS. */
#ifndef STRATUS_RAY_CELLS_H
#define STRATUS_RAY_CELLS_H

/* Most pieces of a cell. */
#define CELL_PIECES 32.0f

/* The way of every ray through its cell: the field at w in 0..1 is k[0] + k[1] w + k[2] w^2 + k[3] w^3, within lo..hi. */
typedef struct cell_way {
  vfloat k[4], lo, hi;
} cell_way;

/* The field at w. */
INLINE vfloat cell_way_at(const cell_way* c, vfloat w) { return v_fma(v_fma(v_fma(c->k[3], w, c->k[2]), w, c->k[1]), w, c->k[0]); }

/* A value kept within the cell's values, because a structure tells what shows from these. */
INLINE vfloat cell_within(const cell_way* c, vfloat value) { return v_min(v_max(value, c->lo), c->hi); }

/* Lanes in which an entry between those of lo and hi shows. */
INLINE vmask cell_shows(CONSTANT stratus_ray_cast_arguments* a, GLOBAL const int* sums, vfloat lo, vfloat hi, vmask mask)
{
  const vfloat first = table_place(&a->table, lo), last = table_place(&a->table, hi);
  mask = mask & v_lt(first, v_set(a->table.shown_beyond)) & v_le(v_set(a->table.shown_first), last);
  if (m_any(mask)) {
    const vint low = entry_in_cell(&a->table, sums, v_to_int(first), lo, mask);
    const vint high = entry_in_cell(&a->table, sums, v_to_int(last), hi, mask);
    mask = mask & v_lt(v_set(0.0f), tau_between(sums, low, high + vi_set(1), mask));
  }
  return mask;
}

/* Lanes whose cell is not hidden. */
INLINE vmask cell_not_hidden(CONSTANT stratus_ray_cast_arguments* a, GLOBAL const uchar* hidden, const vint cell[3], vmask mask)
{
  if (m_any(mask) && (a->values.has_hidden & HIDDEN_CELLS)) {
    const vfloat x[3] = { v_from_int(cell[0]), v_from_int(cell[1]), v_from_int(cell[2]) };
    mask = mask & v_finite(ray_hide_by(a, hidden, HIDDEN_CELLS, x, mask, v_set(0.0f)));
  }
  return mask;
}

/* The cubic on the way of each ray through its cell, whose corners are v. */
INLINE void cell_cubic(const stratus_packet* k, const cell_walk* w, const vint inside[3], const vfloat v[8], cell_way* way)
{
  vfloat e[3], d[3];
  for (int axis = 0; axis < 3; ++axis) {
    const vfloat base = v_from_int(inside[axis]);
    e[axis] = v_clamp(v_fma(w->s, k->d[axis], k->p[axis]) - base, 0.0f, 1.0f);
    d[axis] = v_clamp(v_fma(w->leave, k->d[axis], k->p[axis]) - base, 0.0f, 1.0f) - e[axis];
  }
  cubic_coefficients(v, e, d, way->k);
}

/* Into how many pieces the way is cut. In each of n pieces a cubic departs from its chord by at most its largest second derivative over 8
 * n^2. The second derivative is largest at an end. */
INLINE vfloat cell_pieces(CONSTANT stratus_ray_cast_arguments* a, const cell_way* way, vmask mask)
{
  const vfloat one = v_set(1.0f), twice = way->k[2] + way->k[2];
  const vfloat bend = v_max(v_abs(twice), v_abs(v_fma(v_set(6.0f), way->k[3], twice)));
  const vfloat square = v_min(bend * v_set(a->lattice.pieces_per_bend), v_set(CELL_PIECES * CELL_PIECES));
  if (!m_any(mask & v_lt(one, square))) {
    return one;
  }
  const vfloat root = square * v_inverse_root(v_max(square, v_set(1e-30f))), whole = v_from_int(v_to_int(root));
  return v_clamp(v_select(v_lt(whole, root), whole + one, whole), 1.0f, CELL_PIECES);
}

/* Composites a piece of the way, from k->front to `value`. */
INLINE void cell_integrate(
  CONSTANT stratus_ray_cast_arguments* a, GLOBAL const int* sums, stratus_packet* k, vmask mask, vfloat value, vfloat length, vfloat s)
{
  integrate_segment(a, sums, k, mask, value, length, s);
  k->live = m_andnot(k->live, mask & v_lt(k->transparency, v_set(a->termination)));
}

/* Composites the ways of the lanes in `mask`, piece by piece. A piece's chord is moved so that its mean is the cubic's, which makes the
 * piece exact where the function is linear. */
INLINE void cell_composite(
  CONSTANT stratus_ray_cast_arguments* a, GLOBAL const int* sums, stratus_packet* k, const cell_walk* w, const cell_way* way, vmask mask)
{
  const vfloat one = v_set(1.0f), pieces = cell_pieces(a, way, mask), share = v_reciprocal(pieces), length = (w->leave - w->s) * share;
  const vfloat shift = share * share * v_set(-1.0f / 6.0f), steeper = v_set(3.0f) * way->k[3];
  vfloat piece = v_set(0.0f), front = way->k[0];
  while (m_any(mask)) {
    const vfloat from = v_fma(piece, length, w->s), middle = v_fma(piece, share, v_set(0.5f) * share);
    piece = piece + one;
    const vfloat value = cell_way_at(way, piece * share), move = shift * v_fma(steeper, middle, way->k[2]);
    k->front = cell_within(way, front + move);
    cell_integrate(a, sums, k, mask, cell_within(way, value + move), length, from);
    front = value;
    mask = mask & k->live & v_lt(piece, pieces);
  }
}

#endif

/* Visits the cell of every live ray. */
INLINE void RAY_NAME(cell_visit)(CONSTANT stratus_ray_cast_arguments* a, GLOBAL const void* values, GLOBAL const uchar* hidden,
  GLOBAL const int* sums, stratus_packet* k, const cell_walk* w)
{
  vint inside[3];
  vfloat v[8];
  cell_way way;
  for (int axis = 0; axis < 3; ++axis) {
    inside[axis] = cell_inside(a, w, axis);
  }
  RAY_NAME(fetch_cell)(a, values, inside[0], inside[1], inside[2], k->live, v);
  k->samples -= mask_int(k->live);
  vmask mask = k->live & v_lt(w->s, w->leave) & v_finite(v[0]);
  way.lo = way.hi = v[0];
  for (int corner = 1; corner < 8; ++corner) {
    mask = mask & v_finite(v[corner]);
    way.lo = v_min(way.lo, v[corner]);
    way.hi = v_max(way.hi, v[corner]);
  }
  mask = cell_not_hidden(a, hidden, inside, cell_shows(a, sums, way.lo, way.hi, mask));
  if (m_any(mask)) {
    cell_cubic(k, w, inside, v, &way);
    cell_composite(a, sums, k, w, &way, mask);
  }
}

/* Visits the box about a value, or the part of it that is in one cell, of every live ray. */
INLINE void RAY_NAME(cell_visit_nearest)(CONSTANT stratus_ray_cast_arguments* a, GLOBAL const void* values, GLOBAL const uchar* hidden,
  GLOBAL const int* sums, stratus_packet* k, const cell_walk* w)
{
  vint at[3], hides[3];
  for (int axis = 0; axis < 3; ++axis) {
    const vint last = vi_set(a->values.dimensions[axis] - 1), nearest = (w->cell[axis] + vi_set(w->halves)) >> vi_set(w->halves);
    at[axis] = vi_max(vi_min(nearest, last), vi_set(0));
    hides[axis] = w->halves ? cell_inside(a, w, axis) : at[axis];
  }
  const vfloat value = RAY_NAME(fetch_nearest)(a, values, at[0], at[1], at[2], k->live);
  k->samples -= mask_int(k->live);
  vmask mask = k->live & v_lt(w->s, w->leave) & v_finite(value);
  mask = cell_not_hidden(a, hidden, hides, cell_shows(a, sums, value, value, mask));
  if (m_any(mask)) {
    k->front = value;
    cell_integrate(a, sums, k, mask, value, w->leave - w->s, w->s);
  }
}

INLINE void RAY_NAME(cell_march)(CONSTANT stratus_ray_cast_arguments* a, GLOBAL const void* values, GLOBAL const uchar* hidden,
  GLOBAL const uchar* map, GLOBAL const void* table, stratus_packet* k, int nearest, int halves)
{
  GLOBAL const int* sums = (GLOBAL const int*)table;
  cell_walk w;
  if (!m_any(k->live) || !cell_begin(k, halves, &w)) {
    return;
  }
  do {
    cell_enter(k, &w);
    if (a->map.structure) {
      cell_skip(a, map, k, cell_lanes_to_skip(k, &w), &w);
    }
    if (nearest) {
      RAY_NAME(cell_visit_nearest)(a, values, hidden, sums, k, &w);
    } else {
      RAY_NAME(cell_visit)(a, values, hidden, sums, k, &w);
    }
    cell_leave(k, &w);
  } while (m_any(k->live));
}

/* Boxes about values are cells half a cell further on. Where cells of a volume of points are hidden, boxes are cut at the cells' planes,
 * too: then the planes are half a cell apart. */
INLINE void RAY_NAME(ray_march)(CONSTANT stratus_ray_cast_arguments* a, GLOBAL const void* values, GLOBAL const uchar* hidden,
  GLOBAL const uchar* map, GLOBAL const void* table, stratus_packet* k)
{
  if (!a->values.nearest) {
    RAY_NAME(cell_march)(a, values, hidden, map, table, k, 0, 0);
    return;
  }
  const int halves = (a->values.has_hidden & HIDDEN_CELLS) && !a->values.clamp;
  const vfloat scale = v_set(halves ? 2.0f : 1.0f), shift = v_set(halves ? 0.0f : 0.5f), shrink = v_set(halves ? 0.5f : 1.0f);
  const vfloat p[3] = { k->p[0], k->p[1], k->p[2] }, d[3] = { k->d[0], k->d[1], k->d[2] },
               inverse[3] = { k->inverse[0], k->inverse[1], k->inverse[2] };
  for (int axis = 0; axis < 3; ++axis) {
    k->p[axis] = v_fma(p[axis], scale, shift);
    k->d[axis] = d[axis] * scale;
    k->inverse[axis] = inverse[axis] * shrink;
  }
  RAY_NAME(cell_march)(a, values, hidden, map, table, k, 1, halves);
  for (int axis = 0; axis < 3; ++axis) {
    k->p[axis] = p[axis];
    k->d[axis] = d[axis];
    k->inverse[axis] = inverse[axis];
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
