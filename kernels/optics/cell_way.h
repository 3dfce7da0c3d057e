/* SPDX-License-Identifier: BSD-3-Clause
 * The way of a ray through a cell. Along a ray the field in a cell is a cubic. The way is cut into pieces in which the cubic hardly departs
 * from its chord. */
#ifndef STRATUS_CELL_WAY_H
#define STRATUS_CELL_WAY_H

#include "cell_cubic.h"
#include "cell_walk.h"
#include "transfer_table.h"
#include "value_source.h"

/* Most pieces of a cell. */
#define CELL_PIECES 32.0f
/* More pieces than a path through a cell has that is cut where the field passes from one stretch of the function to the next. */
#define CELL_STRETCHES 4096.0f
/* Steps of the search for the place where a path passes to the next stretch. After three the place is off by 2e-4 of the path in the root
 * mean square, and by 1e-5 in the median of hard cases. */
#define CELL_CROSSING_STEPS 3

/* The way of every ray through its cell: the field at w in 0..1 is k[0] + k[1] w + k[2] w^2 + k[3] w^3, within lo..hi. The pieces that are
 * left begin at `from`, where the field is `front`, and are `share` long each. If the function has stretches, a piece is in one of them,
 * number `stretch`. Then pieces are at most `share` long, and the last one ends at `to`. */
typedef struct cell_way {
  vfloat k[4], lo, hi;
  vfloat from, front, share, left, to;
  vint stretch;
} cell_way;

/* The number of the function's stretches if paths through cells are cut at them. */
#define CELL_BY_STRETCHES(a) RAY_RARE(RAY_JUMPS, (a)->table.stretches)

/* The field at w. */
INLINE vfloat cell_way_at(const cell_way* c, vfloat w) { return v_fma(v_fma(v_fma(c->k[3], w, c->k[2]), w, c->k[1]), w, c->k[0]); }

/* A value limited to the cell's values, because a structure decides by these whether anything shows. */
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

/* The cubic on the path of each ray through its cell, whose corners are v. */
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

/* Narrow the path to the part from..to beyond which nothing shows. At w the cubic departs from its chord by -w (1 - w) (k[2] + k[3] (1 +
 * w)), so that it is between two parallels to the chord. These meet the table's first and last cell that show at the part's ends. Places in
 * the table have a margin for all roundings. */
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

/* Return the lanes of `mask` whose cell, with corners v, shows something, and set their paths through it. */
INLINE vmask cell_look(CONSTANT stratus_ray_cast_arguments* a, GLOBAL const uchar* hidden, GLOBAL const int* sums, const stratus_packet* k,
  const cell_walk* w, const vint inside[3], const vfloat v[8], vmask mask, cell_way* ways)
{
  cell_way way;
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
    way.front = cell_way_at(&way, from);
    if (CELL_BY_STRETCHES(a)) {
      way.from = from;
      way.share = to - from;
      way.left = v_set(CELL_STRETCHES);
      way.to = to;
      ways->stretch = vi_select(mask, table_stretch(&a->table, sums, ways->stretch, cell_within(&way, way.front), mask), ways->stretch);
    } else {
      cell_cut(a, &way, from, to, mask);
      way.to = v_set(2.0f); /* the number of pieces ends the path */
    }
    for (int i = 0; i < 4; ++i) {
      ways->k[i] = v_select(mask, way.k[i], ways->k[i]);
    }
    ways->lo = v_select(mask, way.lo, ways->lo);
    ways->hi = v_select(mask, way.hi, ways->hi);
    ways->from = v_select(mask, way.from, ways->from);
    ways->front = v_select(mask, way.front, ways->front);
    ways->share = v_select(mask, way.share, ways->share);
    ways->left = v_select(mask, way.left, ways->left);
    ways->to = v_select(mask, way.to, ways->to);
  }
  return mask;
}

/* Where the cubic passes `level` between w = lo and w = hi, where it is monotone. rises: the lanes in which it rises. Each step solves the
 * parabola that touches the cubic at the last place, because the next turn may be as near as the level itself. */
INLINE vfloat cell_crossing(const cell_way* c, vfloat lo, vfloat hi, vfloat level, vmask rises)
{
  const vfloat zero = v_set(0.0f), two = v_set(2.0f), least = v_set(1e-30f);
  const vfloat scale = v_reciprocal(v_max(v_max(v_max(v_abs(c->k[1]), v_abs(c->k[2])), v_abs(c->k[3])), least));
  const vfloat k0 = (c->k[0] - level) * scale, k1 = c->k[1] * scale, k2 = c->k[2] * scale, k3 = c->k[3] * scale, three = v_set(3.0f) * k3;
  const vfloat begin = v_fma(v_fma(v_fma(k3, lo, k2), lo, k1), lo, k0), end = v_fma(v_fma(v_fma(k3, hi, k2), hi, k1), hi, k0);
  vfloat w = v_lerp(lo, hi, v_clamp(begin * v_signed_reciprocal(begin - end), 0.0f, 1.0f));
  for (int step = 0; step < CELL_CROSSING_STEPS; ++step) {
    const vfloat off = v_fma(v_fma(v_fma(k3, w, k2), w, k1), w, k0), slope = v_fma(v_fma(three, w, two * k2), w, k1);
    const vfloat bend = v_fma(three, w, k2), square = v_max(v_fma(slope, slope, zero - v_set(4.0f) * off * bend), zero);
    const vmask below = v_lt(off, zero), before = (below & rises) | m_andnot(m_andnot(v_le(w, w), below), rises);
    lo = v_select(before, w, lo);
    hi = v_select(before, hi, w);
    const vfloat steep = v_abs(slope) + square * v_inverse_root(v_max(square, least));
    const vfloat move = two * off * v_reciprocal(v_max(steep, least));
    w = v_min(v_max(v_select(rises, w - move, w + move), lo), hi);
  }
  return w;
}

/* The next piece of a path: the cubic's values at its ends, which are at way->from and at `to`, are way->front and `value`. The piece
 * counts as straight from `front` to `back`. next: the stretch behind it. last: no piece is behind it. */
typedef struct cell_piece {
  vfloat to, value, front, back;
  vint next;
  vmask last;
} cell_piece;

/* The field's mean from w = from to w = to. */
INLINE vfloat cell_way_mean(const cell_way* c, vfloat from, vfloat to)
{
  const vfloat sum = from + to, squares = v_fma(from, from, to * to), product = from * to;
  const vfloat mean = v_fma(v_set(1.0f / 3.0f) * c->k[2], squares + product, v_fma(v_set(0.5f) * c->k[1], sum, c->k[0]));
  return v_fma(v_set(0.25f) * c->k[3], sum * squares, mean);
}

/* By how much the field departs from its chord between w = from and w = to, at most. */
INLINE vfloat cell_way_departs(const cell_way* c, vfloat from, vfloat to)
{
  const vfloat twice = c->k[2] + c->k[2], steeper = v_set(6.0f) * c->k[3], length = to - from;
  return v_max(v_abs(v_fma(steeper, from, twice)), v_abs(v_fma(steeper, to, twice))) * (length * length * v_set(0.125f));
}

/* The next piece of a path, up to where the field leaves its stretch of the function. The field turns at most twice. Only turns ahead
 * count, so that a path goes on from a turn at the very border of two stretches. */
INLINE void cell_next_stretch(
  CONSTANT stratus_ray_cast_arguments* a, GLOBAL const int* sums, const cell_way* way, vmask mask, cell_piece* piece)
{
  const vfloat low = table_stretch_begin(&a->table, sums, way->stretch, mask),
               high = table_stretch_begin(&a->table, sums, way->stretch + vi_set(1), mask);
  const vfloat to = v_min(way->from + way->share, way->to);
  piece->to = to;
  piece->value = cell_way_at(way, to);
  piece->next = way->stretch;
  piece->last = mask & v_le(way->to, to);
  if (m_any(mask & (v_lt(way->lo, low) | v_le(high, way->hi)))) { /* other cells are in their stretch as a whole */
    vfloat begin = way->from, end = to, level = high, turn[3];
    vmask inside = mask, rises = m_none();
    cubic_turns(way->k, &turn[0], &turn[1]);
    turn[2] = to;
    for (int n = 0; n < 3; ++n) {
      const vfloat at = v_min(turn[n], to), value = cell_within(way, cell_way_at(way, at));
      const vmask ahead = inside & v_lt(way->from, at), up = ahead & v_le(high, value), down = ahead & v_lt(value, low);
      level = v_select(down, low, level);
      end = v_select(up | down, at, end);
      rises = rises | up;
      inside = m_andnot(inside, up | down);
      begin = v_select(inside & ahead, at, begin);
    }
    const vmask leaves = m_andnot(mask, inside);
    if (m_any(leaves)) {
      piece->to = v_select(leaves, cell_crossing(way, begin, end, level, rises), piece->to);
      piece->value = v_select(leaves, level, piece->value);
      piece->next = vi_select(leaves, way->stretch + vi_select(rises, vi_set(1), vi_set(-1)), piece->next);
      piece->last = m_andnot(piece->last, leaves);
    }
  }
  /* the chord's mean is the cubic's, and the chord is in the stretch */
  const vfloat move = cell_way_mean(way, way->from, piece->to) - v_set(0.5f) * (way->front + piece->value);
  piece->front = v_min(v_max(cell_within(way, way->front + move), low), high);
  piece->back = v_min(v_max(cell_within(way, piece->value + move), low), high);
}

/* A piece's chord is moved so that its mean is the cubic's, which makes the piece exact where the function is linear. */
INLINE void cell_next_piece(const cell_way* way, cell_piece* piece)
{
  piece->to = way->from + way->share;
  piece->value = cell_way_at(way, piece->to);
  piece->next = way->stretch;
  piece->last = v_lt(way->left, v_set(1.5f));
  const vfloat middle = v_fma(v_set(0.5f), way->share, way->from);
  const vfloat move = way->share * way->share * v_set(-1.0f / 6.0f) * v_fma(v_set(3.0f) * way->k[3], middle, way->k[2]);
  piece->front = cell_within(way, way->front + move);
  piece->back = cell_within(way, piece->value + move);
}

/* The next piece of a path. Returns the part of the whole path that the piece is. */
INLINE vfloat cell_next(CONSTANT stratus_ray_cast_arguments* a, GLOBAL const int* sums, const cell_way* way, vmask mask, cell_piece* piece)
{
  vfloat share = way->share;
  if (CELL_BY_STRETCHES(a)) {
    cell_next_stretch(a, sums, way, mask, piece);
    share = piece->to - way->from;
  } else {
    cell_next_piece(way, piece);
  }
  return share;
}

/* Leaves the piece behind. Returns the lanes of `mask` that have pieces left. */
INLINE vmask cell_pass_piece(cell_way* way, const cell_piece* piece, vmask mask)
{
  way->from = v_select(mask, piece->to, way->from);
  way->front = v_select(mask, piece->value, way->front);
  way->left = v_select(mask, way->left - v_set(1.0f), way->left);
  way->stretch = vi_select(mask, piece->next, way->stretch);
  return mask & v_lt(v_set(0.5f), way->left) & v_lt(way->from, way->to);
}

#endif
