/* SPDX-License-Identifier: BSD-3-Clause
 * Cropping to any of the 27 regions that two planes along each axis make. A ray is cut into pieces that pass through shown regions only.
 * All pieces keep the ray's lattice of samples and are marched one by one, so that the march itself knows of no region. */
#ifndef STRATUS_RAY_CROP_H
#define STRATUS_RAY_CROP_H

#include "ray_segment.h"

/* Six planes cut a ray into at most seven parts. Neighbouring parts that are shown are one piece, so that there are at most four. */
#define CROP_PIECES 4

typedef struct stratus_crop {
  float from[CROP_PIECES][STRATUS_WIDTH], to[CROP_PIECES][STRATUS_WIDTH];
  vint first, last; /* the segments that the whole ray may take */
  vmask all;
} stratus_crop;

/* 1 if the ray of `lane` is in a shown region at s. */
INLINE int crop_shows(CONSTANT stratus_ray_cast_arguments* a, const stratus_rays* rays, int lane, float s)
{
  int region = 0;
  for (int axis = 2; axis >= 0; --axis) {
    const float low = rays->crossing[axis][0][lane], high = rays->crossing[axis][1][lane];
    const int forward = rays->d[axis][lane] > 0.0f;
    const int below = forward ? s < low : s > low, above = forward ? s > high : s < high;
    region = 3 * region + (below ? 0 : above ? 2 : 1);
  }
  return a->crop.regions >> region & 1;
}

/* Finds the pieces of each ray, from..to. Unused pieces are empty and come last. */
INLINE void crop_pieces(CONSTANT stratus_ray_cast_arguments* a, const stratus_rays* rays, float from[CROP_PIECES][STRATUS_WIDTH],
  float to[CROP_PIECES][STRATUS_WIDTH])
{
  for (int lane = 0; lane < STRATUS_WIDTH; ++lane) {
    const float begin = rays->begin[lane], end = rays->end[lane];
    float cut[8];
    int cuts = 0, pieces = 0, shown = 0;
    cut[cuts++] = begin;
    for (int side = 0; side < 6; ++side) {
      const float s = rays->crossing[side / 2][side % 2][lane];
      int at = cuts;
      if (!(s > begin && s < end)) {
        continue;
      }
      for (; at > 1 && cut[at - 1] > s; --at) {
        cut[at] = cut[at - 1];
      }
      cut[at] = s;
      ++cuts;
    }
    cut[cuts] = end;
    for (int i = 0; i < cuts; ++i) {
      const int shows = cut[i] < cut[i + 1] && crop_shows(a, rays, lane, 0.5f * (cut[i] + cut[i + 1]));
      if (shows && !shown && pieces < CROP_PIECES) {
        from[pieces++][lane] = cut[i];
      }
      if (shows) {
        to[pieces - 1][lane] = cut[i + 1];
      }
      shown = cut[i] < cut[i + 1] ? shows : shown;
    }
    for (; pieces < CROP_PIECES; ++pieces) {
      from[pieces][lane] = to[pieces][lane] = 0.0f;
    }
  }
}

/* Keeps what all pieces of a packet's rays share, and cuts the rays. */
INLINE void crop_begin(CONSTANT stratus_ray_cast_arguments* a, const stratus_rays* rays, const stratus_packet* k, stratus_crop* crop)
{
  crop->first = k->i;
  crop->last = k->last;
  crop->all = k->live;
  crop_pieces(a, rays, crop->from, crop->to);
}

/* Starts the rays on piece number `piece`, unless they have ended. Not inlined: few frames are cropped so, and the march should be
 * compiled as if there were none. */
#ifdef STRATUS_DEVICE
static
#else
static
  __attribute__((noinline))
#endif
  void
  crop_enter(CONSTANT stratus_ray_cast_arguments* a, const stratus_crop* crop, int piece, stratus_packet* k)
{
  if (!m_any(crop->all)) {
    return;
  }
  const vfloat begin = v_load(crop->from[piece]), end = v_load(crop->to[piece]);
  const vmask mask = crop->all & v_lt(begin, end) & v_le(v_set(a->termination), k->transparency);
  const vint beyond = segment_behind(v_min(end, v_set(8e6f)));
  k->begin = v_select(mask, begin, v_set(0.0f));
  k->end = v_select(mask, end, v_set(0.0f));
  k->i = vi_max(v_to_int(v_min(k->begin, v_set(8e6f))), crop->first);
  k->last = vi_select(mask, vi_min(beyond, crop->last), vi_set(0));
  k->run = vi_set(a->map.structure ? 0 : 0x7fffffff);
  k->live = mask & vi_lt(k->i, k->last);
  k->fresh = k->live;
}

#endif
