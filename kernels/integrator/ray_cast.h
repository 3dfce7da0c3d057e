/* SPDX-License-Identifier: BSD-3-Clause
 * The march of a packet of rays through a volume, front to back. It leaps over the parts that the structure marks transparent. Included
 * once for each STRATUS_TYPE, STRATUS_PREINTEGRATED (0 or 1) and STRATUS_RAY_MODE (none: composite). RAY_NAME(x) is the inclusion's own
 * name of the function x.
 *
 * Every structure meets the same samples. The structure only decides which segments need none; such a segment would have added exactly
 * zero, so that the bits of the image do not depend on the structure. */
#ifndef RAY_NAME
#error "RAY_NAME is not set"
#endif

#include "ray_crop.h"
#include "ray_composite.h"
#include "slice.h"
#include "tree_map.h"
#include "value_source.h"

#ifndef STRATUS_RAY_MODE
#define STRATUS_RAY_MODE STRATUS_RAY_COMPOSITE
#define RAY_MODE_OPEN 1
#endif

/* Whether rays go from cell to cell, at least in part. */
#ifndef RAY_BY_CELLS
#define RAY_BY_CELLS                                                                                                                       \
  (STRATUS_RAY_MODE == STRATUS_RAY_ISOSURFACE || STRATUS_RAY_MODE == STRATUS_RAY_CELLS || STRATUS_RAY_MODE == STRATUS_RAY_LOCAL ||         \
    STRATUS_RAY_MODE == STRATUS_RAY_QUANTITIES)
#endif
/* Whether rays take samples of the lattice, at least in part. */
#ifndef RAY_BY_SAMPLES
#define RAY_BY_SAMPLES ((!RAY_BY_CELLS && STRATUS_RAY_MODE != STRATUS_RAY_SLICE) || STRATUS_RAY_MODE == STRATUS_RAY_LOCAL)
#endif

/* 1: the includer walks from cell to cell by itself, or looks functions of two variables up. */
#ifndef RAY_WITH_CELLS
#define RAY_WITH_CELLS 0
#endif
#ifndef RAY_WITH_FUNCTIONS_2D
#define RAY_WITH_FUNCTIONS_2D 0
#endif

/* Where the values are that rays follow: in these modes, of dependent components the last one's. */
#undef FOLLOWED_VALUES
#if STRATUS_RAY_MODE == STRATUS_RAY_EXTREMES || STRATUS_RAY_MODE == STRATUS_RAY_SUMS || STRATUS_RAY_MODE == STRATUS_RAY_ISOSURFACE
#define FOLLOWED_VALUES(a, values) COMPONENT_VALUES(a, values, RAY_RARE(RAY_COMPONENTS, (a)->media.dependent))
#else
#define FOLLOWED_VALUES(a, values) (values)
#endif

#include "fetch.h"
#if STRATUS_RAY_MODE == STRATUS_RAY_EXTREMES
#include "ray_extremes.h"
#endif

#include "ray_value.h"

/* Moves the rays of `need` over transparent segments. Sets, for those that stay in an occupied block, up to which segment they need not
 * ask again (run). */
INLINE void RAY_NAME(ray_skip)(CONSTANT stratus_ray_cast_arguments* a, GLOBAL const uchar* map, stratus_packet* k, vmask need)
{
  do {
    const vfloat fi = v_from_int(k->i);
#if STRATUS_PREINTEGRATED
    const vfloat s = v_max(fi, k->begin);
#else
    const vfloat s = segment_middle(k, fi);
#endif
    vint block[3];
    packet_blocks(a, k, s, block);
    const vint index = block[0] + (block[1] + block[2] * vi_set(a->map.rows)) * vi_set(a->map.pitch) + k->octant;
    vint byte;
    if (RAY_RARE(RAY_TREE, a->map.tree)) {
      byte = tree_bytes(a, map, block, need);
    } else {
      byte = gather_map(map, index, need);
    }
    vmask occupied = need & vi_ge(byte, vi_set(128));
#if STRATUS_RAY_MODE == STRATUS_RAY_EXTREMES
    /* a block that holds nothing better is passed like an empty one; nothing is known of its neighbours yet */
    byte = vi_select(occupied, vi_set(1), byte);
    occupied = best_may_be_in(a, map, block, k->front, occupied);
#endif
    const vfloat leave = cube_exit(a, k, block, byte & vi_set(127));
    k->lookups -= mask_int(need);
#if STRATUS_PREINTEGRATED
    vint next = v_to_int(leave); /* the first segment that ends outside the cube */
    const vmask stay = occupied | (need & vi_ge(k->i, next));
    const vint run = vi_max(next, k->i) + vi_set(1);
#else
    const vint next = vi_max(v_to_int(leave + v_set(0.5f)), k->i + vi_set(1)); /* the first segment whose middle may lie outside the cube */
    const vmask stay = occupied;
    const vint run = next;
#endif
    const vmask leap = m_andnot(need, stay);
    const vmask done = leap & (vi_ge(next, k->last) | v_le(k->end, leave));
    k->run = vi_select(stay, run, k->run);
    k->skipped = vi_select(leap, k->skipped + (vi_min(next, k->last) - k->i), k->skipped);
    k->i = vi_select(leap, next, k->i);
#if STRATUS_PREINTEGRATED
    k->fresh = k->fresh | leap;
#endif
    need = m_andnot(leap, done);
    k->live = m_andnot(k->live, done);
  } while (m_any(need));
}

/* Sample every live ray at its next place. The value is fetched for all lanes that are inside the volume, also for ended rays: whether a
 * ray has ended depends on the colour of the last sample, and the fetch need not wait for that. */
INLINE stratus_sample RAY_NAME(ray_sample)(
  CONSTANT stratus_ray_cast_arguments* a, value_source values, GLOBAL const uchar* hidden, const stratus_packet* k)
{
  const vfloat fi = v_from_int(k->i), one = v_set(1.0f);
  const vmask inside = vi_lt(k->i, k->last);
  const vfloat lo = v_min(v_max(fi, k->begin), k->end), hi = v_min(fi + one, k->end);
#if STRATUS_PREINTEGRATED
  const vfloat s = v_select(k->fresh, lo, hi);
#else
  const vfloat s = v_set(0.5f) * (lo + hi);
#endif
  const vfloat x[3] = { v_fma(s, k->d[0], k->p[0]), v_fma(s, k->d[1], k->p[1]), v_fma(s, k->d[2], k->p[2]) };
  stratus_sample sample;
  sample.value = RAY_NAME(ray_value)(a, FOLLOWED_VALUES(a, values), hidden, k->grid, x, inside);
  sample.lo = lo;
  sample.weight = hi - lo;
  sample.length = packet_length(a, k, sample.weight);
  sample.values = values;
  sample.hidden = hidden;
  return sample;
}

/* These are included here and not where they are used, because a device is sent each header once, in only one of the branches below. */
#if RAY_LIT || (STRATUS_RAY_MODE != STRATUS_RAY_COMPOSITE && STRATUS_RAY_MODE != STRATUS_RAY_CELLS && STRATUS_RAY_MODE != STRATUS_RAY_LOCAL)
#if STRATUS_RAY_MODE != STRATUS_RAY_EXTREMES && STRATUS_RAY_MODE != STRATUS_RAY_SUMS
#include "gradient.h"
#endif
#include "lighting.h"
#include "component.h"
#endif
#if RAY_LIT || STRATUS_RAY_MODE == STRATUS_RAY_SHADING || STRATUS_RAY_MODE == STRATUS_RAY_SLICE
#include "light_near.h"
#endif
#if STRATUS_RAY_MODE == STRATUS_RAY_SHADING || STRATUS_RAY_MODE == STRATUS_RAY_SLICE
#include "ray_media.h"
#include "ray_components.h"
#endif
#if STRATUS_RAY_MODE == STRATUS_RAY_SHADING
#include "labels.h"
#endif
#if STRATUS_RAY_MODE == STRATUS_RAY_TRANSFER_2D || RAY_WITH_FUNCTIONS_2D
#include "function_2d.h"
#endif
#if RAY_BY_CELLS || RAY_WITH_CELLS
#include "cell_cubic.h"
#include "cell_walk.h"
#endif
#if STRATUS_RAY_MODE == STRATUS_RAY_CELLS || STRATUS_RAY_MODE == STRATUS_RAY_LOCAL || RAY_WITH_CELLS
#include "cell_way.h"
#include "local_runs.h"
#endif
#if RAY_LIT
#include "lit_places.h"
#endif
#if STRATUS_RAY_MODE == STRATUS_RAY_SHADING
#include "ray_shading.h"
#elif STRATUS_RAY_MODE == STRATUS_RAY_ISOSURFACE
#include "ray_isosurface.h"
#elif STRATUS_RAY_MODE == STRATUS_RAY_TRANSFER_2D
#include "ray_transfer_2d.h"
#elif STRATUS_RAY_MODE == STRATUS_RAY_SLICE
#include "ray_slice.h"
#elif STRATUS_RAY_MODE == STRATUS_RAY_QUANTITIES
#include "ray_quantities.h"
#elif STRATUS_RAY_MODE == STRATUS_RAY_CELLS || STRATUS_RAY_MODE == STRATUS_RAY_LOCAL
#include "ray_cells.h"
#elif STRATUS_RAY_MODE != STRATUS_RAY_COMPOSITE
#include "ray_modes.h"
#else
/* Puts what the sample shows behind what the rays have gathered, and moves on to the next segment. */
INLINE void RAY_NAME(ray_shade)(
  CONSTANT stratus_ray_cast_arguments* a, GLOBAL const void* table, stratus_packet* k, const stratus_sample* sample)
{
  const vfloat value = sample->value, length = sample->length, lo = sample->lo;
  k->samples -= mask_int(k->live);
#if STRATUS_PREINTEGRATED
  const vmask whole = m_andnot(k->live, k->fresh); /* rays that know the value at the segment's front */
  const vmask valid = whole & v_finite(value) & v_finite(k->front);
  integrate_segment(a, (GLOBAL const int*)table, k, valid, value, length, lo);
  k->front = value;
  k->i = vi_select(k->fresh, k->i, k->i + vi_set(1));
  k->fresh = m_none();
#else
  shade_sample(a, (GLOBAL const float*)table, k, k->live & v_finite(value), value, length, lo);
  k->i = k->i + vi_set(1);
#endif
  k->live = m_andnot(k->live, vi_ge(k->i, k->last) | v_lt(k->transparency, v_set(a->termination)));
}
#endif

#if RAY_BY_SAMPLES
/* Asks the structure once enough rays need it. Returns 0 if no ray is left. */
INLINE int RAY_NAME(ray_leap)(CONSTANT stratus_ray_cast_arguments* a, GLOBAL const uchar* map, stratus_packet* k)
{
  if (a->map.structure) {
    const vmask need = lanes_to_skip(k);
    if (m_any(need)) {
      RAY_NAME(ray_skip)(a, map, k, need);
      return m_any(k->live);
    }
  }
  return 1;
}
#endif

#if STRATUS_RAY_MODE == STRATUS_RAY_LOCAL
#include "ray_local.h"
#elif RAY_BY_SAMPLES
INLINE void RAY_NAME(ray_march)(CONSTANT stratus_ray_cast_arguments* a, value_source values, GLOBAL const uchar* hidden,
  GLOBAL const uchar* map, GLOBAL const uchar* rough, GLOBAL const void* table, stratus_packet* k)
{
  (void)rough;
  while (m_any(k->live) && RAY_NAME(ray_leap)(a, map, k)) {
    const stratus_sample sample = RAY_NAME(ray_sample)(a, values, hidden, k);
    RAY_NAME(ray_shade)(a, table, k, &sample);
  }
}

#if PACKETS_TOGETHER == 2
/* March two packets side by side: while one waits for its values, the other computes. The bits equal a separate march of each packet. */
INLINE void RAY_NAME(ray_march_two)(CONSTANT stratus_ray_cast_arguments* a, value_source values, GLOBAL const uchar* hidden,
  GLOBAL const uchar* map, GLOBAL const uchar* rough, GLOBAL const void* table, stratus_packet* left, stratus_packet* right)
{
  while (m_any(left->live) && m_any(right->live) && RAY_NAME(ray_leap)(a, map, left) && RAY_NAME(ray_leap)(a, map, right)) {
    const stratus_sample one = RAY_NAME(ray_sample)(a, values, hidden, left), other = RAY_NAME(ray_sample)(a, values, hidden, right);
    RAY_NAME(ray_shade)(a, table, left, &one);
    RAY_NAME(ray_shade)(a, table, right, &other);
  }
  RAY_NAME(ray_march)(a, values, hidden, map, rough, table, m_any(left->live) ? left : right);
}
#endif
#endif

#if RAY_BY_CELLS || STRATUS_RAY_MODE == STRATUS_RAY_SLICE
#if PACKETS_TOGETHER == 2
INLINE void RAY_NAME(ray_march_two)(CONSTANT stratus_ray_cast_arguments* a, value_source values, GLOBAL const uchar* hidden,
  GLOBAL const uchar* map, GLOBAL const uchar* rough, GLOBAL const void* table, stratus_packet* left, stratus_packet* right)
{
  RAY_NAME(ray_march)(a, values, hidden, map, rough, table, left);
  RAY_NAME(ray_march)(a, values, hidden, map, rough, table, right);
}
#endif

#if STRATUS_RAY_MODE != STRATUS_RAY_QUANTITIES
INLINE void RAY_NAME(ray_finish)(
  CONSTANT stratus_ray_cast_arguments* a, value_source values, GLOBAL const uchar* hidden, GLOBAL const void* table, stratus_packet* k)
{
  (void)a;
  (void)values;
  (void)hidden;
  (void)table;
  (void)k;
}
#endif
#endif

/* Makes the rays of the packet at pixel (x, y) ready for their first segment. `crop` is set only where the frame shows crop regions or
 * stores layers. */
INLINE void RAY_NAME(ray_load)(CONSTANT stratus_ray_cast_arguments* a, GLOBAL const float* opaque_depth, GLOBAL const int* grid,
  GLOBAL const int* lights, int x, int y, stratus_packet* k, stratus_crop* crop)
{
  stratus_rays rays;
  const vmask inside = packet_rays(a, opaque_depth, x, y, &rays);
  packet_begin(a, &rays, inside, k);
  k->grid = grid;
  k->lights = lights;
#if STRATUS_PREINTEGRATED
  k->fresh = k->live;
#endif
  if (RAY_RARE(RAY_REGIONS, a->crop.regions) || RAY_LAYERS(a)) {
    crop_begin(a, &rays, k, crop);
  }
#if STRATUS_RAY_MODE == STRATUS_RAY_SLICE
  slice_begin(a, x, y, &rays, k);
#endif
#if STRATUS_RAY_MODE == STRATUS_RAY_EXTREMES || STRATUS_RAY_MODE == STRATUS_RAY_QUANTITIES
  k->front = v_set(-LARGEST_FLOAT);
#endif
}

#ifdef RAY_MODE_OPEN
#undef RAY_MODE_OPEN
#undef STRATUS_RAY_MODE
#endif
