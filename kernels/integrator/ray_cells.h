/* SPDX-License-Identifier: BSD-3-Clause
 * Light along a packet of rays, cell by cell. Along a ray the field in a cell is a cubic. The way through a cell is cut into pieces in
 * which the cubic hardly departs from its chord, and each piece is pre-integrated between the values at its ends. With nearest
 * interpolation the cells are the boxes about the values, and each is one piece. Included by ray_cast.h with STRATUS_RAY_MODE set to
 * STRATUS_RAY_CELLS or STRATUS_RAY_LOCAL. */
#ifndef STRATUS_RAY_CELLS_H
#define STRATUS_RAY_CELLS_H

/* Pieces are composited once one in so many lanes has any. */
#define CELL_WAITING 3

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

/* Composites a piece in one stretch of the function, whose opacity is constant and whose colours are linear. `length`: of the whole path.
 * The piece's light is exact if the field in the piece is straight: colours at the front then count more, by a share that follows from the
 * depth. Where the field bends too much, the piece is ended early and only its first part is composited. Returns the part of the whole path
 * that is composited. */
INLINE vfloat cell_integrate_stretch(CONSTANT stratus_ray_cast_arguments* a, GLOBAL const int* sums, stratus_packet* k, vmask mask,
  const cell_way* way, cell_piece* piece, vfloat length, vfloat s)
{
  const vfloat zero = v_set(0.0f), one = v_set(1.0f);
  table_shown shown;
  vfloat layer[4];
  table_stretch_at(&a->table, sums, way->stretch, cell_within(way, cell_way_mean(way, way->from, piece->to)), mask, &shown);
  mask = mask & v_lt(zero, shown.tau);
  vfloat depth = v_select(mask, packet_length(a, k, length * (piece->to - way->from)) * v_set(a->table.tau_scale) * shown.tau, zero);
  const vfloat steepest = v_max(v_max(v_abs(shown.slope[0]), v_abs(shown.slope[1])), v_abs(shown.slope[2]));
  const vfloat error = depth * steepest * cell_way_departs(way, way->from, piece->to) * v_set(TABLE_COLOR_ERROR_INVERSE);
  const vmask cut = mask & v_lt(one, error);
  if (m_any(cut)) {
    const vfloat share = v_select(cut, v_reciprocal(pieces_for(error)), one), mean = cell_way_mean(way, way->from, piece->to);
    piece->to = v_select(cut, v_fma(piece->to - way->from, share, way->from), piece->to);
    piece->value = v_select(cut, cell_way_at(way, piece->to), piece->value);
    piece->next = vi_select(cut, way->stretch, piece->next);
    depth = depth * share;
    const vfloat moved = cell_way_mean(way, way->from, piece->to) - mean;
    for (int c = 0; c < 3; ++c) {
      shown.color[c] = v_select(cut, v_fma(shown.slope[c], moved, shown.color[c]), shown.color[c]);
    }
  }
  if (m_any(mask)) {
    const vfloat share = cell_absorbed_share(depth, mask), rise = piece->value - way->front;
    layer[3] = v_min(v_select(mask, share * depth, zero), one);
    const vfloat before = v_fma(v_set(0.5f), layer[3], share - one);
    for (int c = 0; c < 3; ++c) {
      layer[c] = v_select(mask, v_fma(shown.slope[c] * rise, before, shown.color[c] * layer[3]), zero);
      layer[c] = v_min(v_max(layer[c], zero), layer[3]);
    }
    composite(a, k, mask, layer, s);
  }
  return piece->to - way->from;
}

#endif

/* Composite the next piece of the cell paths of the lanes in `mask`. Returns the lanes that have pieces left. */
INLINE vmask RAY_NAME(cell_composite)(CONSTANT stratus_ray_cast_arguments* a, value_source values, GLOBAL const uchar* hidden,
  GLOBAL const int* sums, stratus_packet* k, const cell_walk* w, cell_way* way, vmask mask)
{
  const vfloat length = w->leave - w->s, begin = v_fma(way->from, length, w->s);
  cell_piece piece;
  vfloat share = cell_next(a, sums, way, mask, &piece);
#if RAY_LIT
  const lit_before before = lit_before_stretch(k);
#endif
  if (CELL_BY_STRETCHES(a)) {
    share = cell_integrate_stretch(a, sums, k, mask, way, &piece, length, begin);
  } else {
    cell_integrate(a, sums, k, mask, piece.front, piece.back, packet_length(a, k, length * share), begin);
  }
#if RAY_LIT
  vfloat parts;
  const lit_stretch lit = lit_stretch_of(&before, k, begin, length * share);
  const vmask again = lit_take_back(k, &before, mask & v_lt(v_set(LIGHT_PIECE_LEAST), share), &lit, &parts);
  way->share = v_select(again, share * v_reciprocal(parts), way->share);
  way->left = v_select(again, way->left * parts, way->left);
  mask = m_andnot(mask, again);
  RAY_NAME(lit_pass)(a, values, hidden, sums, k, &before, mask, &lit);
#else
  (void)values;
  (void)hidden;
  const vmask again = m_none();
#endif
  const vmask left = cell_pass_piece(way, &piece, mask);
  k->live = m_andnot(k->live, mask & v_lt(k->transparency, v_set(a->termination)));
  return (left | again) & k->live;
}

/* Visits the cells of the lanes in `mask`. Returns the lanes whose path shows something, and writes their paths to `ways`. */
INLINE vmask RAY_NAME(cell_visit)(CONSTANT stratus_ray_cast_arguments* a, value_source values, GLOBAL const uchar* hidden,
  GLOBAL const int* sums, stratus_packet* k, const cell_walk* w, vmask mask, cell_way* ways)
{
  vint inside[3];
  vfloat v[8];
  for (int axis = 0; axis < 3; ++axis) {
    inside[axis] = cell_inside(a, w, axis);
  }
  RAY_NAME(fetch_cell)(a, values, inside[0], inside[1], inside[2], mask, v);
  k->samples -= mask_int(mask);
  return cell_look(a, hidden, sums, k, w, inside, v, mask, ways);
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
  cell_integrate(a, sums, k, mask, value, value, packet_length(a, k, w->leave - w->s), w->s);
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
  ways.k[0] = ways.k[1] = ways.k[2] = ways.k[3] = ways.lo = ways.hi = ways.from = ways.front = ways.share = ways.left = ways.to =
    v_set(0.0f);
  ways.stretch = vi_set(0);
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
        waiting = waiting | RAY_NAME(cell_visit)(a, values, hidden, sums, k, &w, done, &ways);
      }
    } else {
      waiting = RAY_NAME(cell_composite)(a, values, hidden, sums, k, &w, &ways, waiting);
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
  const vfloat p[3] = { k->p[0], k->p[1], k->p[2] }, d[3] = { k->d[0], k->d[1], k->d[2] },
               inverse[3] = { k->inverse[0], k->inverse[1], k->inverse[2] };
  cell_boxes(a, k, halves);
  RAY_NAME(cell_march)(a, values, hidden, map, table, k, 1, halves);
  for (int axis = 0; axis < 3; ++axis) {
    k->p[axis] = p[axis];
    k->d[axis] = d[axis];
    k->inverse[axis] = inverse[axis];
  }
}
#endif
