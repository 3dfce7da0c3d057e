/* SPDX-License-Identifier: BSD-3-Clause
 * Slices: the values on a surface of the world, where a ray meets it (slice.h). Included by ray_cast.h with STRATUS_RAY_MODE set to
 * STRATUS_RAY_SLICE. */
#ifndef STRATUS_RAY_SLICE_H
#define STRATUS_RAY_SLICE_H

/* Finds where the rays of the packet at pixel (x, y) meet the surface. */
INLINE void slice_begin(CONSTANT stratus_ray_cast_arguments* a, int x, int y, const stratus_rays* rays, stratus_packet* k)
{
  float at[2][STRATUS_WIDTH], px[STRATUS_WIDTH], py[STRATUS_WIDTH];
  for (int lane = 0; lane < STRATUS_WIDTH; ++lane) {
    px[lane] = (float)(x + (lane & (PACKET_X - 1)));
    py[lane] = (float)(y + (lane >> PACKET_X_LOG2));
  }
  for (int part = 0; part < STRATUS_WIDTH; part += REAL_WIDTH) {
    real origin[3], direction[3], degree[3], roots[2], samples_per_k, unit;
    const real first = r_add(r_load(rays->whole[0] + part), r_load(rays->whole[1] + part));
    const real k_per_sample = ray_line(a, px + part, py + part, origin, direction, &samples_per_k, &unit);
    for (int axis = 0; axis < 3; ++axis) {
      direction[axis] = r_mul(direction[axis], k_per_sample);
      origin[axis] = r_sub(r_add(origin[axis], r_mul(first, direction[axis])), r_of(a->slice.center[axis]));
    }
    slice_along(&a->slice, origin, direction, degree);
    slice_roots(degree, roots);
    r_store(at[0] + part, roots[0]);
    r_store(at[1] + part, roots[1]);
  }
  k->surface[0] = v_load(at[0]);
  k->surface[1] = v_load(at[1]);
}
#endif

/* Puts what the values on the surface show, where they show by their own opacity, one point behind the other. Several components show what
 * a sample of composite shows, of a length over which each one's opacity is as given. */
INLINE void RAY_NAME(ray_march)(CONSTANT stratus_ray_cast_arguments* a, value_source values, GLOBAL const uchar* hidden,
  GLOBAL const uchar* map, GLOBAL const uchar* rough, GLOBAL const void* table, stratus_packet* k)
{
  const vfloat from = v_max(v_from_int(k->i), k->begin), to = v_min(v_from_int(k->last), k->end);
  (void)map;
  (void)rough;
  for (int n = 0; n < 2; ++n) {
    const vmask there = k->live & v_le(from, k->surface[n]) & v_lt(k->surface[n], to) & v_le(v_set(a->termination), k->transparency);
    if (m_any(there)) {
      const vfloat s = v_select(there, k->surface[n], from);
      k->samples -= mask_int(there);
      if (RAY_RARE(RAY_COMPONENTS, a->media.components > 1)) {
        stratus_sample sample;
        sample.value = sample.weight = v_set(0.0f);
        sample.lo = s;
        sample.length = v_set(1.0f);
        sample.values = values;
        sample.hidden = hidden;
        const vmask live = k->live;
        k->live = there;
        RAY_NAME(shade_components)(a, table, k, &sample);
        k->live = live;
        surface_kept(a, k, there);
        continue;
      }
      const vfloat x[3] = { v_fma(s, k->d[0], k->p[0]), v_fma(s, k->d[1], k->p[1]), v_fma(s, k->d[2], k->p[2]) };
      const vfloat value = RAY_NAME(ray_value)(a, values, hidden, k->grid, x, there);
      const vmask valid = there & v_finite(value);
      vfloat layer[4];
      gather_four((GLOBAL const float*)table, table_entry(&a->table, table, value), valid, layer);
      composite(a, k, valid, layer, s);
      surface_kept(a, k, valid);
    }
  }
  k->live = m_none();
}
