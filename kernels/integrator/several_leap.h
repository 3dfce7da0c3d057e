/* SPDX-License-Identifier: BSD-3-Clause
 * Leaps over segments in which one of several volumes is transparent by its structure. */
#ifndef STRATUS_SEVERAL_LEAP_H
#define STRATUS_SEVERAL_LEAP_H

#include "several_state.h"
#include "tree_map.h"

/* Read the structure along the rays `inside` from s0 on. Returns the segment at which the volume is to be looked at again, i if it is to be
 * sampled. */
INLINE int several_leap(const several_source* from, several_volume* v, int i, vfloat s0, vmask inside, vmask live)
{
  CONSTANT stratus_ray_cast_arguments* a = from->a;
  stratus_packet* k = &v->k;
  const vfloat length = v_set((float)from->stride);
  const vfloat lo = v_max(s0, k->begin);
  vfloat s = lo;
  if (!from->preintegrated) {
    s = v_set(0.5f) * (lo + v_min(s0 + length, k->end));
  }
  const vmask waiting = live & k->live & v_le(s0 + length, k->begin);
  int next = several_aligned(from, v, several_least(v->offset, waiting));
  if (m_any(inside)) {
    vint block[3], byte;
    packet_blocks(a, k, s, block);
    if (a->map.tree) {
      byte = tree_bytes(a, from->map, block, inside);
    } else {
      byte = gather_map(from->map, block[0] + (block[1] + block[2] * vi_set(a->map.rows)) * vi_set(a->map.pitch) + k->octant, inside);
    }
    const vmask occupied = inside & vi_ge(byte, vi_set(128));
    const vfloat leave = v_min(cube_exit(a, k, block, byte & vi_set(127)), v_set(8e6f));
    const vmask beyond = m_andnot(inside, occupied) & v_le(k->end, leave); /* nothing shows on the rest of these rays */
    k->lookups -= mask_int(inside);
    /* pre-integrated: the first way that ends outside the cube; else the first whose middle may lie outside */
    const vint at = v_to_int(leave + v_set(from->preintegrated ? 0.0f : 0.5f) * length) + v->offset;
    const int leap = several_aligned(from, v, several_least(at, m_andnot(inside, occupied | beyond)));
    if (m_any(occupied) || (from->preintegrated && leap <= i)) {
      const int until = several_aligned(from, v, several_least(at, occupied));
      v->run = until != SEVERAL_NEVER && until > i + from->stride ? until : i + from->stride;
      return i;
    }
    next = leap < next ? leap : next;
  }
  next = next > i + from->stride ? next : i + from->stride;
  next = next < v->last ? next : SEVERAL_NEVER;
  if (m_any(inside)) {
    const int segments = (next < v->last ? next : v->last) - i;
    k->skipped -= mask_int(inside) * vi_set(from->stride == 1 ? segments : (segments + from->stride - 1) / from->stride);
  }
  return next;
}

#endif
