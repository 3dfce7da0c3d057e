/* SPDX-License-Identifier: BSD-3-Clause
 * Light along a packet of rays, cell by cell. Along a ray the field in a cell is a cubic. The way through a cell is cut into pieces in
 * which the cubic hardly departs from its chord, and each piece is pre-integrated between the values at its ends. With nearest
 * interpolation the cells are the boxes about the values, and each is one piece. Included by ray_cast.h with STRATUS_RAY_MODE set to
 * STRATUS_RAY_CELLS or STRATUS_RAY_LOCAL. */
#ifndef STRATUS_RAY_CELLS_H
#define STRATUS_RAY_CELLS_H

/* Most pieces of a cell. */
#define CELL_PIECES 32.0f

/* Pieces are composited once one in so many lanes has any. */
#define CELL_WAITING 3

/* The way of every ray through its cell: the field at w in 0..1 is k[0] + k[1] w + k[2] w^2 + k[3] w^3, within lo..hi. The pieces that are
 * left begin at `from`, where the field is `front`, and are `share` long each. */
typedef struct cell_way {
  vfloat k[4], lo, hi;
  vfloat from, front, share, left;
} cell_way;

/* The field at w. */
INLINE vfloat cell_way_at(const cell_way* c, vfloat w) { return v_fma(v_fma(v_fma(c->k[3], w, c->k[2]), w, c->k[1]), w, c->k[0]); }

/* A value kept within the cell's values, because a structure tells what shows from these. */
INLINE vfloat cell_within(const cell_way* c, vfloat value) { return v_min(v_max(value, c->lo), c->hi); }

/* Lanes whose cell is not hidden. */
INLINE vmask cell_not_hidden(CONSTANT stratus_ray_cast_arguments* a, GLOBAL const uchar* hidden, const vint cell[3], vmask mask)
{
  if ((RAY_RARE(RAY_HIDDEN, a->values.has_hidden) & HIDDEN_CELLS) && m_any(mask)) {
    const vfloat x[3] = { v_from_int(cell[0]), v_from_int(cell[1]), v_from_int(cell[2]) };
    mask = mask & v_finite(ray_hide_by(a, hidden, HIDDEN_CELLS, x, mask, v_set(0.0f)));
  }
  return mask;
}

/* The cubic on the way of each ray through its cell, whose corners are v. */
INLINE void cell_cubic(CONSTANT stratus_ray_cast_arguments* a, const stratus_packet* k, const cell_walk* w, const vint inside[3],
  const vfloat v[8], cell_way* way)
{
  vfloat e[3], d[3];
  for (int axis = 0; axis < 3; ++axis) {
    e[axis] = cell_place(a, k, axis, inside[axis], w->s);
    d[axis] = cell_place(a, k, axis, inside[axis], w->leave) - e[axis];
  }
  cubic_coefficients(v, e, d, way->k);
}

/* Narrows the way to the part from..to beyond which nothing shows. At w the cubic departs from its chord by -w (1 - w) (k[2] + k[3] (1 +
 * w)), so that it lies between two parallels to the chord, and these meet the table's first and last cell that show at the part's ends.
 * Places in the table are taken with a margin for all that rounding may do to them. */
INLINE void cell_part_that_shows(CONSTANT stratus_ray_cast_arguments* a, const cell_way* way, vfloat* from, vfloat* to)
{
  const vfloat zero = v_set(0.0f), scale = v_set(a->table.scale), quarter = v_set(0.25f * a->table.scale);
  const vfloat near_end = way->k[2] + way->k[3], far_end = near_end + way->k[3], rise = (way->k[1] + near_end) * scale;
  const vfloat begin = v_fma(way->k[0], scale, v_set(a->table.offset));
  const vfloat margin = v_fma(v_max(v_abs(way->lo), v_abs(way->hi)) * scale, v_set(0x1p-18f), v_set(1.0f));
  const vfloat below = v_fma(v_max(v_max(near_end, far_end), zero), quarter, margin),
               above = v_fma(v_max(v_max(zero - near_end, zero - far_end), zero), quarter, margin);
  const vfloat first = v_set(a->table.shown_first <= 0.0f ? -1e30f : a->table.shown_first) - above - begin,
               beyond = v_set(a->table.shown_beyond > a->table.last ? 1e30f : a->table.shown_beyond) + below - begin;
  const vfloat inverse = v_signed_reciprocal(rise), one_end = first * inverse, other_end = beyond * inverse;
  *from = v_clamp(v_min(one_end, other_end), 0.0f, 1.0f);
  *to = v_clamp(v_max(one_end, other_end), 0.0f, 1.0f);
}

/* Cuts the part from..to into pieces. In each of n pieces a cubic departs from its chord by at most its largest second derivative over 8
 * n^2 times the square of the part. The second derivative is largest at an end. */
INLINE void cell_cut(CONSTANT stratus_ray_cast_arguments* a, cell_way* way, vfloat from, vfloat to, vmask mask)
{
  const vfloat one = v_set(1.0f), six = v_set(6.0f), twice = way->k[2] + way->k[2], steeper = six * way->k[3];
  const vfloat bend = v_max(v_abs(v_fma(steeper, from, twice)), v_abs(v_fma(steeper, to, twice)));
  way->share = to - from;
  way->from = from;
  way->left = one;
  const vfloat square = v_min(bend * way->share * way->share * v_set(a->lattice.pieces_per_bend), v_set(CELL_PIECES * CELL_PIECES));
  if (m_any(mask & v_lt(one, square))) {
    const vmask two = v_lt(one, square), three = v_lt(v_set(4.0f), square), four = v_lt(v_set(9.0f), square);
    vfloat per_piece = v_select(four, v_set(0.25f), v_select(three, v_set(1.0f / 3.0f), v_select(two, v_set(0.5f), one)));
    way->left = v_select(four, v_set(4.0f), v_select(three, v_set(3.0f), v_select(two, v_set(2.0f), one)));
    const vmask more = v_lt(v_set(16.0f), square);
    if (m_any(mask & more)) {
      const vfloat root = square * v_inverse_root(v_max(square, one)), whole = v_from_int(v_to_int(root));
      const vfloat many = v_min(v_select(v_lt(whole, root), whole + one, whole), v_set(CELL_PIECES));
      way->left = v_select(more, many, way->left);
      per_piece = v_select(more, v_reciprocal(v_max(many, one)), per_piece);
    }
    way->share = way->share * per_piece;
  }
}

/* The part of light that each unit of optical depth takes, (1 - exp(-x)) / x: by its series where x is small. */
#define CELL_DEPTH_SMALL 0.25f

INLINE vfloat cell_absorbed_share(vfloat x, vmask mask)
{
  vfloat share = v_set(-1.0f / 720.0f);
  share = v_fma(share, x, v_set(1.0f / 120.0f));
  share = v_fma(share, x, v_set(-1.0f / 24.0f));
  share = v_fma(share, x, v_set(1.0f / 6.0f));
  share = v_fma(share, x, v_set(-0.5f));
  share = v_fma(share, x, v_set(1.0f));
  const vmask large = v_lt(v_set(CELL_DEPTH_SMALL), x);
  if (m_any(mask & large)) {
    share = v_select(large, v_absorbed(x) * v_reciprocal(v_max(x, v_set(CELL_DEPTH_SMALL))), share);
  }
  return share;
}

/* Composites the layer that sums of entries give, `per_tau` of optical depth a unit. */
INLINE void cell_layer(CONSTANT stratus_ray_cast_arguments* a, stratus_packet* k, vmask mask, vfloat sum[4], vfloat per_tau, vfloat s)
{
  const vfloat zero = v_set(0.0f), share = cell_absorbed_share(v_select(mask, sum[3] * per_tau, zero), mask);
  const vfloat part = v_select(mask, share * per_tau, zero);
  for (int c = 0; c < 4; ++c) {
    sum[c] = sum[c] * part;
  }
  sum[3] = v_min(sum[3], v_set(1.0f)); /* the product is rounded */
  composite(a, k, mask, sum, s);
}

/* Composites a piece that the function's table does not allow to be composited at once, in `pieces`. scale: its length. */
INLINE void cell_integrate_parts(CONSTANT stratus_ray_cast_arguments* a, GLOBAL const int* sums, stratus_packet* k, vmask mask,
  vfloat front, vint from, vfloat value, vint last, vfloat pieces, vfloat scale, vfloat s)
{
  const vfloat one = v_set(1.0f), share = v_reciprocal(pieces), step = (value - front) * share, part = scale * share;
  vfloat piece = one, sum[4], width;
  table_end begin, end;
  table_end_at(&a->table, sums, front, from, RAY_RARE(RAY_JUMPS, a->table.jumps) ? mask : m_none(), &begin);
  do {
    const vmask ends = v_le(pieces, piece);
    const vfloat at = v_select(ends, value, v_fma(step, piece, front));
    const vint to = vi_select(ends, last, table_entry(&a->table, sums, at));
    if (RAY_RARE(RAY_JUMPS, a->table.jumps)) {
      table_end_at(&a->table, sums, at, to, mask, &end);
      width = sums_from_to(&a->table, &begin, &end, sum);
      begin = end;
    } else {
      const vint low = vi_min(from, to), beyond = vi_max(from, to) + vi_set(1);
      sums_between(sums, low, beyond, mask, sum);
      width = v_max(width_between(&a->table, sums, low, beyond, mask), one);
    }
    const vmask lit = mask & v_lt(v_set(0.0f), sum[3]);
    if (m_any(lit)) {
      cell_layer(a, k, lit, sum, part * v_reciprocal(width), s);
    }
    from = to;
    mask = m_andnot(mask, ends);
    piece = piece + one;
  } while (m_any(mask));
}

/* Lanes whose piece meets an entry of opacity 1, or leaves what the table spans. */
INLINE vmask cell_lanes_apart(CONSTANT stratus_ray_cast_arguments* a, GLOBAL const int* sums, vmask mask, vfloat front, vint from,
  vfloat value, vint last, vfloat length)
{
  const vfloat scale = v_set(a->table.scale), offset = v_set(a->table.offset);
  vmask apart = m_none();
  if (RAY_RARE(RAY_OPAQUE, a->table.has_opaque)) {
    vint first;
    apart = opaque_on_the_way(&a->table, sums + 4 * (a->table.entries + 1), from, last, mask & v_lt(v_set(0.0f), length), &first);
  }
  if (RAY_RARE(RAY_CUT, a->table.cut)) {
    const vfloat lowest = v_fma(v_min(front, value), scale, offset), highest = v_fma(v_max(front, value), scale, offset);
    apart = apart | (mask & (v_lt(lowest, v_set(0.0f)) | v_lt(v_set(a->table.last + 1.0f), highest)));
  }
  return apart;
}

/* Composites a piece in which the field goes from `front` to `value`, as integrate_segment() does, which takes the lanes of
 * cell_lanes_apart(). */
INLINE void cell_integrate(CONSTANT stratus_ray_cast_arguments* a, GLOBAL const int* sums, stratus_packet* k, vmask mask, vfloat front,
  vfloat value, vfloat length, vfloat s)
{
  const vfloat one = v_set(1.0f), place = table_place(&a->table, value), front_place = table_place(&a->table, front);
  mask =
    mask & v_lt(v_min(place, front_place), v_set(a->table.shown_beyond)) & v_le(v_set(a->table.shown_first), v_max(place, front_place));
  const vint from = entry_in_cell(&a->table, sums, v_to_int(front_place), front, mask);
  const vint last = entry_in_cell(&a->table, sums, v_to_int(place), value, mask);
  if (RAY_RARE(RAY_OPAQUE | RAY_CUT, a->table.has_opaque | a->table.cut)) {
    const vmask apart = cell_lanes_apart(a, sums, mask, front, from, value, last, length);
    if (m_any(apart)) {
      k->front = front;
      integrate_segment(a, sums, k, apart, value, length, s);
      mask = m_andnot(mask, apart);
    }
  }
  vfloat sum[4], width, across;
  if (RAY_RARE(RAY_JUMPS, a->table.jumps)) {
    table_end begin, end;
    table_end_at(&a->table, sums, front, from, mask, &begin);
    table_end_at(&a->table, sums, value, last, mask, &end);
    width = sums_from_to(&a->table, &begin, &end, sum);
    across = v_max(width, begin.width + end.width); /* a colour may jump between neighbours */
  } else {
    const vint low = vi_min(from, last), beyond = vi_max(from, last) + vi_set(1);
    sums_between(sums, low, beyond, mask, sum);
    across = width = v_max(width_between(&a->table, sums, low, beyond, mask), one);
  }
  mask = mask & v_lt(v_set(0.0f), sum[3]);
  const vfloat scale = length * v_set(a->table.tau_scale), per_tau = scale * v_reciprocal(width);
  const vfloat error = segment_error(&a->table, sum[3] * per_tau, across);
  const vmask plain = mask & v_le(error, one);
  if (m_any(plain)) {
    cell_layer(a, k, plain, sum, per_tau, s);
  }
  mask = m_andnot(mask, plain);
  if (m_any(mask)) {
    cell_integrate_parts(a, sums, k, mask, front, from, value, last, pieces_for(error), scale, s);
  }
}

/* Composites the next piece of the ways of the lanes in `mask`. Returns the lanes that have pieces left. A piece's chord is moved so that
 * its mean is the cubic's, which makes the piece exact where the function is linear. */
INLINE vmask cell_composite(
  CONSTANT stratus_ray_cast_arguments* a, GLOBAL const int* sums, stratus_packet* k, const cell_walk* w, cell_way* way, vmask mask)
{
  const vfloat length = w->leave - w->s, begin = v_fma(way->from, length, w->s), to = way->from + way->share;
  const vfloat middle = v_fma(v_set(0.5f), way->share, way->from), value = cell_way_at(way, to);
  const vfloat move = way->share * way->share * v_set(-1.0f / 6.0f) * v_fma(v_set(3.0f) * way->k[3], middle, way->k[2]);
  cell_integrate(a, sums, k, mask, cell_within(way, way->front + move), cell_within(way, value + move), length * way->share, begin);
  way->from = v_select(mask, to, way->from);
  way->front = v_select(mask, value, way->front);
  way->left = v_select(mask, way->left - v_set(1.0f), way->left);
  k->live = m_andnot(k->live, mask & v_lt(k->transparency, v_set(a->termination)));
  return mask & k->live & v_lt(v_set(0.5f), way->left);
}

#endif

/* Visits the cells of the lanes in `mask`. Returns the lanes whose way shows something, and what their way is. */
INLINE vmask RAY_NAME(cell_visit)(CONSTANT stratus_ray_cast_arguments* a, value_source values, GLOBAL const uchar* hidden,
  stratus_packet* k, const cell_walk* w, vmask mask, cell_way* ways)
{
  vint inside[3];
  vfloat v[8];
  cell_way way;
  for (int axis = 0; axis < 3; ++axis) {
    inside[axis] = cell_inside(a, w, axis);
  }
  RAY_NAME(fetch_cell)(a, values, inside[0], inside[1], inside[2], mask, v);
  k->samples -= mask_int(mask);
  mask = mask & v_lt(w->s, w->leave);
  way.lo = way.hi = v[0];
  vfloat nothing = v[0] * v_set(0.0f); /* not a number where a corner is not finite */
  for (int corner = 1; corner < 8; ++corner) {
    nothing = v_fma(v[corner], v_set(0.0f), nothing);
    way.lo = v_min(way.lo, v[corner]);
    way.hi = v_max(way.hi, v[corner]);
  }
  const vfloat first = v_set(a->table.shown_first), beyond = v_set(a->table.shown_beyond);
  const vfloat lowest = table_place(&a->table, way.lo), highest = table_place(&a->table, way.hi);
  mask = mask & v_le(nothing, v_set(0.0f)) & v_lt(lowest, beyond) & v_le(first, highest);
  mask = cell_not_hidden(a, hidden, inside, mask);
  if (m_any(mask)) {
    vfloat from = v_set(0.0f), to = v_set(1.0f);
    cell_cubic(a, k, w, inside, v, &way);
    if (m_any(mask & (v_lt(lowest, first) | v_le(beyond, highest)))) {
      cell_part_that_shows(a, &way, &from, &to);
      mask = mask & v_lt(from, to);
    }
    cell_cut(a, &way, from, to, mask);
    way.front = cell_way_at(&way, from);
    for (int i = 0; i < 4; ++i) {
      ways->k[i] = v_select(mask, way.k[i], ways->k[i]);
    }
    ways->lo = v_select(mask, way.lo, ways->lo);
    ways->hi = v_select(mask, way.hi, ways->hi);
    ways->from = v_select(mask, way.from, ways->from);
    ways->front = v_select(mask, way.front, ways->front);
    ways->share = v_select(mask, way.share, ways->share);
    ways->left = v_select(mask, way.left, ways->left);
  }
  return mask;
}

/* Visits the box about a value, or the part of it that is in one cell, of every live ray. */
INLINE void RAY_NAME(cell_visit_nearest)(CONSTANT stratus_ray_cast_arguments* a, value_source values, GLOBAL const uchar* hidden,
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
  const vmask mask = cell_not_hidden(a, hidden, hides, k->live & v_lt(w->s, w->leave) & v_finite(value));
  cell_integrate(a, sums, k, mask, value, value, w->leave - w->s, w->s);
  k->live = m_andnot(k->live, mask & v_lt(k->transparency, v_set(a->termination)));
}

/* Lanes walk each for itself: a lane whose cell shows something waits until one in CELL_WAITING has pieces to composite, and a lane that
 * has composited its pieces goes on. */
INLINE void RAY_NAME(cell_march)(CONSTANT stratus_ray_cast_arguments* a, value_source values, GLOBAL const uchar* hidden,
  GLOBAL const uchar* map, GLOBAL const void* table, stratus_packet* k, int nearest, int halves)
{
  GLOBAL const int* sums = (GLOBAL const int*)table;
  cell_walk w;
  cell_way ways;
  vmask waiting = m_none();
  if (!m_any(k->live) || !cell_begin(k, halves, nearest && !halves, &w)) {
    return;
  }
  ways.k[0] = ways.k[1] = ways.k[2] = ways.k[3] = ways.lo = ways.hi = ways.from = ways.front = ways.share = ways.left = v_set(0.0f);
  cell_enter(a, k, &w);
  do {
    vmask done = waiting;
    if (m_count(waiting) * CELL_WAITING < m_count(k->live)) {
      done = m_andnot(k->live, waiting);
      if (a->map.structure) {
        cell_skip(a, map, k, cell_lanes_to_skip(done, &w), &w);
        done = done & k->live;
      }
      if (nearest) {
        RAY_NAME(cell_visit_nearest)(a, values, hidden, sums, k, &w);
      } else {
        waiting = waiting | RAY_NAME(cell_visit)(a, values, hidden, k, &w, done, &ways);
      }
    } else {
      waiting = cell_composite(a, sums, k, &w, &ways, waiting);
    }
    cell_leave(a, k, m_andnot(done, waiting), &w);
  } while (m_any(k->live));
}

#if STRATUS_RAY_MODE == STRATUS_RAY_CELLS
/* Boxes about values are cells half a cell further on. Where cells of a volume of points are hidden, boxes are cut at the cells' planes,
 * too: then the planes are half a cell apart. */
INLINE void RAY_NAME(ray_march)(CONSTANT stratus_ray_cast_arguments* a, value_source values, GLOBAL const uchar* hidden,
  GLOBAL const uchar* map, GLOBAL const uchar* rough, GLOBAL const void* table, stratus_packet* k)
{
  (void)rough;
  if (!RAY_RARE(RAY_NEAREST, a->values.nearest)) {
    RAY_NAME(cell_march)(a, values, hidden, map, table, k, 0, 0);
    return;
  }
  const int halves = (RAY_RARE(RAY_HIDDEN, a->values.has_hidden) & HIDDEN_CELLS) && !a->values.clamp;
  const int even = !RAY_STRETCHED(a), twice = even & halves, moved = even & !halves; /* stretched grids have planes of both kinds */
  const vfloat scale = v_set(twice ? 2.0f : 1.0f), shift = v_set(moved ? 0.5f : 0.0f), shrink = v_set(twice ? 0.5f : 1.0f);
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
#endif
