/* SPDX-License-Identifier: BSD-3-Clause
 * Light along a packet of rays, by two rules: from sample to sample where the transfer function hardly changes, cell by cell where it
 * does (local_runs.h). The lattice of smooth runs is the ray's own, cut to each run. Included by ray_cast.h with STRATUS_RAY_MODE set to
 * STRATUS_RAY_LOCAL. */
#ifndef STRATUS_RAY_LOCAL_H
#define STRATUS_RAY_LOCAL_H

/* Composites a part of a segment in which the field is `value`. */
INLINE void local_composite(
  CONSTANT stratus_ray_cast_arguments* a, GLOBAL const int* sums, stratus_packet* k, vmask mask, vfloat value, vfloat length, vfloat s)
{
  if (RAY_RARE(RAY_OPAQUE | RAY_CUT, a->table.has_opaque | a->table.cut)) {
    cell_integrate(a, sums, k, mask, value, value, length, s);
    return;
  }
  const vfloat place = table_place(&a->table, value);
  mask = mask & v_lt(place, v_set(a->table.shown_beyond)) & v_le(v_set(a->table.shown_first), place);
  if (m_any(mask)) {
    const vint entry = entry_in_cell(&a->table, sums, v_to_int(place), value, mask), beyond = entry + vi_set(1);
    vfloat sum[4];
    sums_between(sums, entry, beyond, mask, sum);
    mask = mask & v_lt(v_set(0.0f), sum[3]);
    if (m_any(mask)) {
      const vfloat width = v_max(width_between(&a->table, sums, entry, beyond, mask), v_set(1.0f));
      cell_layer(a, k, mask, sum, length * v_set(a->table.tau_scale) * v_reciprocal(width), s);
    }
  }
}

#endif

/* Marches the live rays, all of them in smooth runs. */
INLINE void RAY_NAME(local_march)(CONSTANT stratus_ray_cast_arguments* a, value_source values, GLOBAL const uchar* hidden,
  GLOBAL const uchar* map, GLOBAL const int* sums, stratus_packet* k)
{
  while (m_any(k->live) && RAY_NAME(ray_leap)(a, map, k)) {
    const stratus_sample sample = RAY_NAME(ray_sample)(a, values, hidden, k);
    k->samples -= mask_int(k->live);
#if RAY_LIT
    const lit_before before = lit_before_stretch(k);
#endif
    local_composite(a, sums, k, k->live & v_finite(sample.value), sample.value, sample.length, sample.lo);
#if RAY_LIT
    vfloat parts;
    const lit_stretch stretch = lit_stretch_of(&before, k, sample.lo, sample.weight);
    vmask cut = lit_take_back(k, &before, k->live, &stretch, &parts);
    RAY_NAME(lit_pass)(a, values, hidden, sums, k, &before, m_andnot(k->live, cut), &stretch);
    const vfloat share = v_reciprocal(parts), part = sample.weight * share;
    for (vfloat n = v_set(0.0f); m_any(cut); n = n + v_set(1.0f), cut = cut & v_lt(n, parts)) { /* of one value, lit at several places */
      const lit_before mine = lit_before_stretch(k);
      const vfloat begin = v_fma(n, part, sample.lo);
      local_composite(a, sums, k, cut, sample.value, sample.length * share, begin);
      const lit_stretch piece = lit_stretch_of(&mine, k, begin, part);
      RAY_NAME(lit_pass)(a, values, hidden, sums, k, &mine, cut, &piece);
    }
#endif
    k->i = k->i + vi_set(1);
    k->live = m_andnot(k->live, vi_ge(k->i, k->last) | v_lt(k->transparency, v_set(a->termination)));
  }
}

/* Rays take a run each in turns: all that are in smooth runs first, then all that are in rough ones, so that neighbours keep together. */
INLINE void RAY_NAME(ray_march)(CONSTANT stratus_ray_cast_arguments* a, value_source values, GLOBAL const uchar* hidden,
  GLOBAL const uchar* map, GLOBAL const uchar* rough, GLOBAL const void* table, stratus_packet* k)
{
  const vfloat zero = v_set(0.0f), whole_begin = k->begin, whole_end = k->end;
  const vint never = vi_set(0x7fffffff);
  local_runs r;
#if RAY_LIT
  lit_begin(a, k);
  if (a->rough.rows == 0) { /* all blocks are rough */
    RAY_NAME(cell_march)(a, values, hidden, map, table, k, 0, 0);
    RAY_NAME(lit_end)(a, values, hidden, table, k);
    return;
  }
#endif
  r.begin = v_max(v_from_int(k->i), k->begin);
  r.end = v_min(v_from_int(k->last), k->end);
  vmask left = k->live & v_lt(r.begin, r.end);
  r.begin = v_select(left, r.begin, zero); /* lanes without a path stay at a harmless place */
  r.end = v_select(left, r.end, zero);
  r.to = r.end;
  r.rough = m_none();
  local_find(a, rough, k, left, &r);
  while (m_any(left)) {
    for (int kind = 0; kind < 2; ++kind) {
      vmask mine = m_andnot(left, r.rough);
      if (kind) {
        mine = left & r.rough;
      }
      if (!m_any(mine)) {
        continue;
      }
      k->live = mine;
      k->begin = v_select(mine, r.begin, zero);
      k->end = v_select(mine, r.to, zero);
      k->i = v_to_int(k->begin);
      k->last = segment_behind(k->end);
      if (kind) {
        k->run = never; /* every block on the path may show something */
        RAY_NAME(cell_march)(a, values, hidden, map, table, k, 0, 0);
      } else {
        k->run = a->map.structure ? k->i : never;
        RAY_NAME(local_march)(a, values, hidden, map, (GLOBAL const int*)table, k);
      }
      left = m_andnot(left, mine & (v_lt(k->transparency, v_set(a->termination)) | v_le(r.end, r.to)));
      r.begin = v_select(mine, r.to, r.begin);
      local_find(a, rough, k, left & mine, &r);
    }
  }
  k->begin = whole_begin;
  k->end = whole_end;
  k->live = m_none();
#if RAY_LIT
  RAY_NAME(lit_end)(a, values, hidden, table, k);
#endif
}
