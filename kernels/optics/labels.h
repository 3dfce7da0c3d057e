/* SPDX-License-Identifier: BSD-3-Clause
 * Samples in the colours and opacities of their labels. Included by ray_cast.h once for each STRATUS_TYPE, where samples are
 * shaded. */

#if !STRATUS_PREINTEGRATED
/* The optical depths of the entries over a whole sample, if gradient opacity needs them. table: of entries colour times alpha, and alpha;
 * behind these, from entry `depths` on, each one's optical depth. */
INLINE vfloat RAY_NAME(entry_depth)(CONSTANT stratus_ray_cast_arguments* a, GLOBAL const float* table, vint depths, vmask mask)
{
  vfloat depth[4] = { v_set(0.0f), v_set(0.0f), v_set(0.0f), v_set(0.0f) };
  if (a->media.factor_reach > 0.0f) {
    gather_four(table, depths, mask, depth);
  }
  return depth[0];
}

/* The labels of the values nearest to the positions x; 0 for labels that have no functions of their own. */
OUTLINE vint RAY_NAME(label_at)(
  CONSTANT stratus_ray_cast_arguments* a, GLOBAL const uchar* hidden, GLOBAL const int* grid, const vfloat x[3], vmask mask)
{
  float place[3][STRATUS_WIDTH];
  int wanted[STRATUS_WIDTH], label[STRATUS_WIDTH];
  vfloat snapped[3] = { x[0], x[1], x[2] };
  vi_store(wanted, vi_select(mask, vi_set(1), vi_set(0)));
  if (RAY_STRETCHED(a)) {
    grid_snap(a, grid, snapped);
  }
  for (int axis = 0; axis < 3; ++axis) {
    vfloat at = snapped[axis];
    if (a->values.clamp & !RAY_STRETCHED(a)) {
      at = v_clamp(at, 0.0f, a->values.last[axis]);
    }
    v_store(place[axis], at);
  }
  for (int lane = 0; lane < STRATUS_WIDTH; ++lane) {
    label[lane] = wanted[lane] ? (int)hidden[hidden_place(a, 1, place[0][lane], place[1][lane], place[2][lane])] : 0;
    label[lane] = label[lane] <= a->media.label_count ? label[lane] : 0;
  }
  return vi_load(label);
}

/* Finds what samples show in the colours and opacities of their labels. Returns the rays on which anything shows. */
OUTLINE vmask RAY_NAME(labels_at)(CONSTANT stratus_ray_cast_arguments* a, GLOBAL const void* table, const stratus_packet* k,
  const stratus_sample* sample, stratus_label_sample* shown)
{
  GLOBAL const float* floats = (GLOBAL const float*)table;
  const vfloat s = v_fma(v_set(0.5f), sample->weight, sample->lo), zero = v_set(0.0f);
  const vfloat x[3] = { v_fma(s, k->d[0], k->p[0]), v_fma(s, k->d[1], k->p[1]), v_fma(s, k->d[2], k->p[2]) };
  const vmask valid = k->live & v_finite(sample->value);
  GLOBAL const int* ints = (GLOBAL const int*)table;
  const vint label = RAY_NAME(label_at)(a, sample->hidden, k->grid, x, valid), record = label + label + label, numbers = record + vi_set(1);
  vfloat of[4];
  vint place[4];
  gather_four(floats + a->media.label_first, record, valid, of);
  for (int i = 0; i < 4; ++i) {
    place[i] = v_gather_ints(ints + a->media.label_first + i, numbers << vi_set(2), valid);
  }
  vint entry = v_to_int(v_min(v_max(v_fma(sample->value, of[0], of[1]), zero), of[2]));
  if (a->media.label_steps) { /* a label whose entries are cells has none to search in */
    const vmask divided = valid & vi_lt(vi_set(0), place[2]);
    const vint cell = entry + place[2];
    entry = vi_select(divided, v_gather_ints(ints, cell, divided), entry);
    const vint beyond = v_gather_ints(ints + 1, cell, divided);
    for (int ahead = 1 << (a->media.label_steps - 1); ahead > 0; ahead >>= 1) {
      const vint next = entry + vi_set(ahead);
      const vmask inside = divided & vi_lt(next, beyond);
      entry = vi_select(inside & v_le(v_from_bits(v_gather_ints(ints, next + place[3], inside)), sample->value), next, entry);
    }
  }
  shown->entry = entry + place[0];
  shown->depths = place[1];
  gather_four(floats, shown->entry, valid, shown->layer);
  const vmask shows = valid & v_lt(zero, shown->layer[3]);
  if (m_any(shows)) {
    const vfloat depth = RAY_NAME(entry_depth)(a, floats, shown->entry + place[1], shows);
    vint factors = vi_set(-1);
    if (a->media.label_factors) {
      factors = v_gather_ints(ints + a->media.label_first, (record + vi_set(2)) << vi_set(2), shows);
    }
    RAY_NAME(ray_light_by)(a, sample, table, 0, k, s, depth, factors, of[3], shows, &shown->lighting);
  }
  return shows;
}
#endif
