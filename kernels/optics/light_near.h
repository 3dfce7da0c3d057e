/* SPDX-License-Identifier: BSD-3-Clause
 * The part of a light that passes the matter next to a place. A map of light has nodes some voxels apart, between which dense matter
 * hides itself: so a ray goes from the place towards the light, a few steps of half a voxel, and the map is read where it ends.
 * Included by ray_cast.h once for each STRATUS_TYPE. */

#ifndef NEAR_OWN
#define NEAR_OWN 2.001f /* steps of half a voxel; the rounding of a step counts for nothing */
#endif

/* The optical depth between two values, of `part` of a step to light i, which has near_length sample distances. */
INLINE vfloat RAY_NAME(near_depth)(
  CONSTANT stratus_ray_cast_arguments* a, int i, GLOBAL const void* table, vfloat first, vfloat last, vfloat part, vmask mask)
{
  const vfloat zero = v_set(0.0f), most = v_set(80.0f);
#if STRATUS_PREINTEGRATED || RAY_LIT
  GLOBAL const int* sums = (GLOBAL const int*)table;
  const vint from = table_entry(&a->table, sums, first), to = table_entry(&a->table, sums, last);
  const vint low = vi_min(from, to), beyond = vi_max(from, to) + vi_set(1);
  const vfloat tau = tau_between(sums, low, beyond, mask), width = v_max(width_between(&a->table, sums, low, beyond, mask), v_set(1.0f));
  vfloat within = part;
  if (RAY_RARE(RAY_CUT, a->table.cut)) { /* values beyond the table are transparent */
    vfloat before, inside;
    part_within(&a->table, v_clamp(v_fma(first, v_set(a->table.scale), v_set(a->table.offset)), -1e30f, 1e30f),
      v_clamp(v_fma(last, v_set(a->table.scale), v_set(a->table.offset)), -1e30f, 1e30f), &before, &inside);
    within = within * inside;
  }
  vfloat depth = tau * v_set(a->light.near_length[i] * a->table.tau_scale) * within * v_reciprocal(width);
  if (RAY_RARE(RAY_OPAQUE, a->table.has_opaque)) { /* however short the step is */
    vint entry;
    const vmask met = mask & v_lt(zero, within);
    const vmask opaque = opaque_on_the_way(&a->table, sums + 4 * (a->table.entries + 1), from, to, met, &entry);
    depth = v_select(opaque, most, depth);
  }
#else
  const vint entry = table_entry(&a->table, table, v_set(0.5f) * (first + last));
  vfloat depths[4];
  gather_four((GLOBAL const float*)table + 4 * a->table.entries, entry, mask, depths);
  const vfloat depth = v_set(a->light.near_length[i]) * part * depths[0];
#endif
  return v_select(mask, v_min(depth, most), zero);
}

/* Lanes whose value has opacity 1. */
INLINE vmask RAY_NAME(near_opaque)(CONSTANT stratus_ray_cast_arguments* a, GLOBAL const void* table, vfloat value, vmask mask)
{
#if STRATUS_PREINTEGRATED || RAY_LIT
  if (RAY_RARE(RAY_OPAQUE, a->table.has_opaque)) {
    GLOBAL const int* sums = (GLOBAL const int*)table;
    vint first;
    const vint entry = table_entry(&a->table, sums, value);
    return opaque_on_the_way(&a->table, sums + 4 * (a->table.entries + 1), entry, entry, mask, &first);
  }
  return m_none();
#else
  vfloat depths[4];
  gather_four((GLOBAL const float*)table + 4 * a->table.entries, table_entry(&a->table, table, value), mask, depths);
  return mask & v_le(v_set(1e29f), depths[0]);
#endif
}

/* Cuts the part *from..*to of the path from x to the planes within which matter is seen. */
INLINE void RAY_NAME(near_bounds)(CONSTANT stratus_ray_cast_arguments* a, const vfloat x[3], const vfloat way[3], vfloat* from, vfloat* to)
{
  const vfloat zero = v_set(0.0f), hair = v_set(1e-20f);
  for (int axis = 0; axis < 3; ++axis) {
    const vfloat d = v_select(v_lt(way[axis], zero), v_min(way[axis], zero - hair), v_max(way[axis], hair)), inverse = v_reciprocal(d);
    const vfloat low = (v_set(a->crop.box[0][axis].hi) - x[axis]) * inverse, high = (v_set(a->crop.box[1][axis].hi) - x[axis]) * inverse;
    *from = v_max(*from, v_min(low, high));
    *to = v_min(*to, v_max(low, high));
  }
  for (int plane = 0; plane < RAY_RARE(RAY_CLIP, a->crop.clip_count); ++plane) {
    CONSTANT stratus_pair* n = a->crop.clip[plane];
    const vfloat normal[3] = { v_set(n[0].hi), v_set(n[1].hi), v_set(n[2].hi) };
    const vfloat height = v_dot3(normal, x) + v_set(n[3].hi), slope = v_dot3(normal, way);
    const vfloat crossing = zero - height * v_reciprocal(v_select(v_lt(slope, zero), v_min(slope, zero - hair), v_max(slope, hair)));
    *from = v_select(v_le(zero, slope), v_max(*from, crossing), *from);
    *to = v_select(v_lt(slope, zero), v_min(*to, crossing), *to);
  }
}

/* The part of light i that passes the matter on `way` from the places x. Opaque matter shows its surface: a place in it, which may be a
 * little below the surface, is lit if the light leaves the opaque matter within NEAR_OWN steps. */
INLINE vfloat RAY_NAME(light_passing_near)(CONSTANT stratus_ray_cast_arguments* a, value_source values, GLOBAL const uchar* hidden,
  GLOBAL const void* table, const stratus_packet* k, int i, const vfloat x[3], const vfloat way[3], vmask mask)
{
  const vfloat zero = v_set(0.0f), steps = v_set((float)a->light.near_steps[i]), share = v_reciprocal(steps);
  vfloat from = zero, to = v_set(1.0f), depth = zero, front = zero;
  RAY_NAME(near_bounds)(a, x, way, &from, &to);
  const vmask any = mask & v_lt(from, to);
  const vfloat part = v_select(any, to - from, zero);
  vmask own = any; /* all matter so far is opaque */
  from = v_select(any, from, zero);
  for (int n = 0; n <= a->light.near_steps[i]; ++n) {
    const vfloat s = v_fma(v_set((float)n) * share, part, from);
    const vfloat y[3] = { v_fma(s, way[0], x[0]), v_fma(s, way[1], x[1]), v_fma(s, way[2], x[2]) };
    const vfloat value = RAY_NAME(ray_value)(a, values, hidden, k->grid, y, any);
    const vmask ends = v_finite(value);
    if (n > 0) {
      const vmask valid = any & v_finite(front) & ends;
      const vfloat first = v_select(valid, front, zero), last = v_select(valid, value, zero);
      const vfloat step = RAY_NAME(near_depth)(a, i, table, first, last, part, valid);
      depth = depth + v_select(own & v_le(s * steps, v_set(NEAR_OWN)), zero, step);
    }
    if (m_any(own)) {
      own = RAY_NAME(near_opaque)(a, table, v_select(ends, value, zero), own & ends);
    }
    front = value;
  }
  return v_set(1.0f) - v_absorbed(v_min(depth, v_set(80.0f)));
}

/* For each light that has a map, the part that passes to the places x: first the matter next to them, then the rest by the map. */
OUTLINE void RAY_NAME(light_near)(CONSTANT stratus_ray_cast_arguments* a, value_source values, GLOBAL const uchar* hidden,
  GLOBAL const void* table, const stratus_packet* k, const vfloat x[3], vmask mask, vfloat passing[8])
{
  for (int i = 0; i < a->light.count; ++i) {
    vfloat end[3] = { x[0], x[1], x[2] }, near = v_set(1.0f);
    if (a->light.map_at[i] < 0) {
      continue;
    }
    if (a->light.near_steps[i] > 0) {
      vfloat way[3];
      light_near_way(&a->light, i, x, way);
      near = RAY_NAME(light_passing_near)(a, values, hidden, table, k, i, x, way, mask);
      for (int axis = 0; axis < 3; ++axis) {
        end[axis] = x[axis] + way[axis];
      }
    }
    vfloat q[3];
    vint face = light_map_place(&a->light, i, end, q);
    passing[i] = near * light_map_matter(&a->light, k->lights, i, q, face);
    if (a->light.surface_at[i] >= 0) {
      face = light_map_place(&a->light, i, x, q);
      passing[i] = passing[i] * light_map_surfaces(&a->light, k->lights, i, q, face);
    }
  }
}
