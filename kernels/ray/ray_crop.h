/* SPDX-License-Identifier: BSD-3-Clause
 * Cropping to any of the 27 regions that two planes along each axis make, and to layers, each of which is stored as a picture of its own. A
 * ray is cut into pieces that pass through shown regions only. All pieces keep the ray's lattice of samples and are marched one by one, so
 * that the march itself knows of no region and of no layer. */
#ifndef STRATUS_RAY_CROP_H
#define STRATUS_RAY_CROP_H

#include "crop.h"
#include "ray_packet.h"

typedef struct stratus_crop {
  float from[CROP_PIECES][STRATUS_WIDTH], to[CROP_PIECES][STRATUS_WIDTH];
  vfloat begin, depth; /* where the ray's first layer begins, and how deep each is */
  vint first, last;    /* the segments that the whole ray may take */
  vmask all;
} stratus_crop;

/* Keeps what all pieces of a packet's rays share, and cuts the rays. */
INLINE void crop_begin(CONSTANT stratus_ray_cast_arguments* a, const stratus_rays* rays, const stratus_packet* k, stratus_crop* crop)
{
  crop->first = k->i;
  crop->last = k->last;
  crop->all = k->live;
  if (RAY_LAYERS(a)) {
    crop->begin = v_load(rays->layers[0]);
    crop->depth = v_load(rays->layers[1]);
  }
  if (RAY_RARE(RAY_REGIONS, a->crop.regions)) {
    crop_pieces(a->crop.regions, rays->begin, rays->end, rays->crossing, rays->d, crop->from, crop->to);
  } else {
    v_store(crop->from[0], v_load(rays->begin));
    v_store(crop->to[0], v_load(rays->end));
  }
}

/* Starts the rays on piece number `piece`, in layer number `layer` if there are any, unless they have ended. Not inlined: few frames are
 * cropped so, and the march should be compiled as if there were none. */
#ifdef STRATUS_DEVICE
static
#else
static
  __attribute__((noinline))
#endif
  void
  crop_enter(CONSTANT stratus_ray_cast_arguments* a, const stratus_crop* crop, int piece, int layer, stratus_packet* k)
{
  if (!m_any(crop->all)) {
    return;
  }
  vfloat begin = v_load(crop->from[piece]), end = v_load(crop->to[piece]);
  if (RAY_LAYERS(a)) {
    begin = v_max(begin, v_fma(v_set((float)layer), crop->depth, crop->begin));
    end = v_min(end, v_fma(v_set((float)(layer + 1)), crop->depth, crop->begin));
  }
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

/* Makes rays gather anew in the next layer, unless they have ended. */
INLINE void crop_next_layer(CONSTANT stratus_ray_cast_arguments* a, stratus_crop* crop, stratus_packet* k)
{
  const vfloat zero = v_set(0.0f);
  crop->all = crop->all & v_le(v_set(a->termination), k->transparency);
  k->transparency = v_set(1.0f);
  k->red = k->green = k->blue = k->front = zero;
  k->depth = v_set(LARGEST_FLOAT);
}

#endif
