/* SPDX-License-Identifier: BSD-3-Clause
 * Cropping to any of the 27 regions that two planes along each axis make. A ray is cut into pieces that pass through shown regions only.
 * All pieces keep the ray's lattice of samples and are marched one by one, so that the march itself knows of no region. */
#ifndef STRATUS_RAY_CROP_H
#define STRATUS_RAY_CROP_H

#include "crop.h"
#include "ray_packet.h"

typedef struct stratus_crop {
  float from[CROP_PIECES][STRATUS_WIDTH], to[CROP_PIECES][STRATUS_WIDTH];
  vint first, last; /* the segments that the whole ray may take */
  vmask all;
} stratus_crop;

/* Keeps what all pieces of a packet's rays share, and cuts the rays. */
INLINE void crop_begin(CONSTANT stratus_ray_cast_arguments* a, const stratus_rays* rays, const stratus_packet* k, stratus_crop* crop)
{
  crop->first = k->i;
  crop->last = k->last;
  crop->all = k->live;
  crop_pieces(a->crop.regions, rays->begin, rays->end, rays->crossing, rays->d, crop->from, crop->to);
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
