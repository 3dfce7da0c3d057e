/* SPDX-License-Identifier: BSD-3-Clause
 * Leaps over segments in which one of several volumes is transparent by its structure. */
#ifndef STRATUS_SEVERAL_LEAP_H
#define STRATUS_SEVERAL_LEAP_H

#include "several_state.h"
#include "tree_map.h"

/* Asks the structure once, from segment `i` on or where less is known of a ray, which part of each ray of the mask comes next. */
INLINE void several_look(const several_source* from, several_volume* v, vint i, vmask mask)
{
  CONSTANT stratus_ray_cast_arguments* a = from->a;
  stratus_packet* k = &v->k;
  const vint at = vi_max(v->shown_until, i), last = k->last + v->offset;
  const vfloat length = v_set((float)from->stride), s0 = v_from_int(at - v->offset), lo = v_max(s0, k->begin);
  const vmask asked = mask, gone = mask & (vi_ge(at, last) | v_le(k->end, s0)); /* at their ends, where there are no blocks any more */
  mask = m_andnot(mask, gone);
  vfloat s = lo;
  if (!from->preintegrated) {
    s = v_set(0.5f) * (lo + v_min(s0 + length, k->end));
  }
  vint block[3], byte;
  packet_blocks(a, k, s, block);
  if (a->map.tree) {
    byte = tree_bytes(a, from->map, block, mask);
  } else {
    byte = gather_map(from->map, block[0] + (block[1] + block[2] * vi_set(a->map.rows)) * vi_set(a->map.pitch) + k->octant, mask);
  }
  k->lookups -= mask_int(mask);
  const vmask occupied = mask & vi_ge(byte, vi_set(128));
  const vfloat leave = v_min(cube_exit(a, k, block, byte & vi_set(127)), v_set(8e6f));
  /* pre-integrated: the first way that ends outside the cube; else the first whose middle may lie outside */
  vint next = v_to_int(leave + v_set(from->preintegrated ? 0.0f : 0.5f) * length);
  next = several_aligned_rays(from, v, next) + v->offset;
  const vmask stays = occupied | (mask & vi_ge(at, next)), leaps = m_andnot(mask, stays);
  next = vi_max(next, at + vi_set(from->stride));
  const vfloat passed = v_from_int(vi_min(next, last) - at) * v_set(1.0f / (float)from->stride);
  k->skipped = k->skipped + vi_select(leaps, v_to_int(passed + v_set(0.999f)), vi_set(0));
  next = vi_select(gone | (leaps & (vi_ge(next, last) | v_le(k->end, leave))), vi_set(SEVERAL_NEVER), next);
  v->shown_from = vi_select(asked, vi_select(stays, at, next), v->shown_from);
  v->shown_until = vi_select(asked, next, v->shown_until);
}

/* Returns the segment, of those from i on, at which the volume is to be sampled or looked at again; i if it is to be sampled. */
INLINE int several_leap(const several_source* from, several_volume* v, int i, vmask live)
{
  const vint now = vi_set(i);
  live = live & v->k.live;
  for (;;) {
    const vmask behind = live & vi_lt(now, v->shown_until), shown = behind & vi_ge(now, v->shown_from);
    if (m_any(shown)) { /* all are sampled as long as one of them is in a block that is not transparent */
      v->run = several_most(vi_min(v->shown_until, v->k.last + v->offset), shown) + (i - v->began) / SEVERAL_LOOKS;
      return i;
    }
    if (!m_any(m_andnot(live, behind))) {
      v->began = several_least(v->shown_from, live);
      return v->began < v->last ? v->began : SEVERAL_NEVER;
    }
    /* all rays on whose way nothing is known to show, since a look takes the same time for one of them */
    several_look(from, v, now, live & vi_ge(vi_max(v->shown_from, now), v->shown_until) & vi_lt(v->shown_until, vi_set(SEVERAL_NEVER)));
  }
}

#endif
