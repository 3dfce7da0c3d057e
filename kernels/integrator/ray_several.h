/* SPDX-License-Identifier: BSD-3-Clause
 * The march of a packet of rays through several volumes at once, front to back. All have one lattice of samples, which is anchored at the
 * eye. Each has its own place on it, its own bounds, structure and table, and is sampled every `stride` segments. Within a segment optical
 * depths add up, and colours are weighted by them.
 *
 * The lanes of a packet go through the lattice together, so that all of them sample a volume at once. A lane's result does not depend on
 * its neighbours: positions are relative to where its own ray enters the volume, as in ray_setup.h. A structure gives the segment up to
 * which its volume is transparent on all lanes; such segments would have added exactly zero. */
#ifndef STRATUS_RAY_SEVERAL_H
#define STRATUS_RAY_SEVERAL_H

#include "several_interval.h"
#include "several_leap.h"
#include "several_way.h"

/* Takes the sample that is due at segment i, or leaps. live: rays that are not at their end. */
INLINE void several_advance(const several_source* from, several_volume* v, int i, vmask live)
{
  stratus_packet* k = &v->k;
  v->comes = 0;
  if (i >= v->last) {
    v->next = SEVERAL_NEVER;
    return;
  }
  const vfloat s0 = v_from_int(vi_set(i) - v->offset), s1 = s0 + v_set((float)from->stride);
  const vfloat lo = v_min(v_max(s0, k->begin), k->end), hi = v_max(v_min(s1, k->end), lo);
  /* the values of rays that have ended are read, too: the read need not wait for the colour of the last segment */
  const vmask within = k->live & v_lt(lo, hi), inside = live & within;
  if (from->a->map.structure && i >= v->run) {
    v->next = several_leap(from, v, i, live);
    if (v->next > i) {
      v->knows = m_none();
      return;
    }
  }
  v->next = i + from->stride;
  if (!m_any(inside)) {
    return;
  }
  vfloat s = hi;
  if (!from->preintegrated) {
    s = v_set(0.5f) * (lo + hi);
  }
  const vfloat x[3] = { v_fma(s, k->d[0], k->p[0]), v_fma(s, k->d[1], k->p[1]), v_fma(s, k->d[2], k->p[2]) };
  const vfloat value = several_value_at(from, x, within);
  vfloat front = value;
  k->samples -= mask_int(inside);
  if (from->preintegrated) {
    const vmask fresh = m_andnot(inside, v->knows);
    front = v->ahead;
    if (m_any(fresh)) {
      const vfloat y[3] = { v_fma(lo, k->d[0], k->p[0]), v_fma(lo, k->d[1], k->p[1]), v_fma(lo, k->d[2], k->p[2]) };
      const vfloat entered = several_value_at(from, y, fresh);
      k->samples -= mask_int(fresh);
      front = v_select(fresh, entered, front);
    }
    v->ahead = value;
    v->knows = inside;
  }
  v->ways[1 - v->now].lo = lo;
  v->ways[1 - v->now].hi = hi;
  v->ways[1 - v->now].front = front;
  v->ways[1 - v->now].rise = value - front;
#if SEVERAL_MEDIA
  if (from->media) { /* each component has its own values that are not finite */
    several_shade_media(from, v, inside);
    return;
  }
#endif
  const vmask valid = inside & v_finite(value) & v_finite(front);
  if (from->preintegrated) {
    several_shade(from, v, valid);
  } else {
    several_shade_middle(from, v, valid);
  }
}

/* Gives every ray its number of the packet's first segment, and each volume where it is due. whole: of each volume, the number of the
 * segment in which a ray enters it. */
INLINE void several_number(
  const several_source* from, several_volume* volumes, int count, several_number_t whole[SEVERAL_PARTS][STRATUS_WIDTH])
{
  several_number_t least = (several_number_t)SEVERAL_FARTHEST;
  int meets[SEVERAL_PARTS][STRATUS_WIDTH];
  for (int n = 0; n < count; ++n) {
    vi_store(meets[n], vi_select(volumes[n].k.live, vi_set(1), vi_set(0)));
    for (int lane = 0; lane < STRATUS_WIDTH; ++lane) {
      least = meets[n][lane] && whole[n][lane] < least ? whole[n][lane] : least;
    }
  }
  for (int n = 0; n < count; ++n) {
    several_volume* v = &volumes[n];
    int offset[STRATUS_WIDTH];
    for (int lane = 0; lane < STRATUS_WIDTH; ++lane) {
      offset[lane] = meets[n][lane] ? (int)(whole[n][lane] - least) : 0;
    }
    v->offset = vi_load(offset);
    v->shown_from = v->shown_until = several_aligned_rays(&from[n], v, v->k.i) + v->offset;
    v->next = v->began = several_least(v->shown_until, v->k.live);
    const int last = several_most(v->k.last + v->offset, v->k.live);
    v->last = last == -SEVERAL_NEVER ? 0 : last;
    if (several_has_stretches(&from[n])) { /* it takes them where the others' ways are composited */
      v->next = SEVERAL_NEVER;
    }
    v->run = from[n].a->map.structure ? 0 : SEVERAL_NEVER;
  }
}

/* Prepare the packet at pixel (x, y) for each volume. k: the light that the rays gather. */
INLINE void several_load(
  const several_source* from, int count, GLOBAL const float* opaque_depth, int x, int y, several_volume* volumes, stratus_packet* k)
{
  several_number_t whole[SEVERAL_PARTS][STRATUS_WIDTH];
  packet_nothing(k);
  for (int n = 0; n < count; ++n) {
    CONSTANT stratus_ray_cast_arguments* a = from[n].a;
    several_volume* v = &volumes[n];
    stratus_rays rays;
    int phase[STRATUS_WIDTH];
    v->now = v->shows = v->comes = 0;
    v->knows = m_none();
    v->ahead = v_set(0.0f);
    v->phase = vi_set(0);
#if SEVERAL_MESHES
    if (from[n].mesh) {
      several_mesh_load(&from[n], v, x, y, whole[n]);
      k->hits = k->hits | v->k.hits;
      k->live = k->live | v->k.live;
      continue;
    }
#endif
    if (packet_outside(a, x, y)) {
      packet_nothing(&v->k);
      v->k.i = v->k.last = vi_set(0);
      continue;
    }
    const vmask inside = packet_rays(a, opaque_depth, x, y, &rays);
    packet_begin(a, &rays, inside, &v->k);
    if (RAY_RARE(RAY_REGIONS, a->crop.regions)) {
      stratus_crop crop;
      crop_begin(a, &rays, &v->k, &crop);
      crop_enter(a, &crop, from[n].piece, 0, &v->k);
      v->k.skipped = from[n].piece ? vi_set(0) : v->k.skipped; /* the whole ray's, which counts once */
    }
    v->k.grid = from[n].grid;
    v->k.lights = from[n].lights;
    for (int lane = 0; lane < STRATUS_WIDTH; ++lane) {
      const float far = rays.whole[0][lane] < SEVERAL_FARTHEST ? rays.whole[0][lane] : SEVERAL_FARTHEST;
      whole[n][lane] = (several_number_t)far + (several_number_t)rays.whole[1][lane];
      phase[lane] = (int)(whole[n][lane] % from[n].stride);
      phase[lane] += phase[lane] < 0 ? from[n].stride : 0;
    }
    v->phase = vi_load(phase);
#if SEVERAL_CELLS
    if (from[n].cells) {
      several_cells_load(&from[n], v);
    }
#endif
    k->hits = k->hits | v->k.hits;
    k->live = k->live | v->k.live;
  }
  k->first = v_set(0.0f);
  several_number(from, volumes, count, whole);
}

INLINE void several_march(const several_source* from, several_volume* volumes, int count, stratus_packet* k)
{
  vint since = vi_set(0);
  int i = 0, stretches = 0, middles = 1;
  for (int n = 0; n < count; ++n) {
    stretches |= several_has_stretches(&from[n]) && volumes[n].shows;
    middles &= !several_has_stretches(&from[n]) && !from[n].preintegrated;
  }
  for (int n = 0; stretches && n < count; ++n) { /* places are counted from where each ray meets anything, so that they round alike */
    const vint first = vi_select(volumes[n].k.live, volumes[n].offset, vi_set(SEVERAL_NEVER));
    since = n == 0 ? first : vi_min(since, first);
  }
  while (m_any(k->live) && i != SEVERAL_NEVER) {
    int next = SEVERAL_NEVER, shows = 0;
    vmask changed = m_none();
    for (int n = 0; n < count; ++n) {
      several_volume* v = &volumes[n];
      shows |= v->shows;
      if (v->next <= i && v->next != SEVERAL_NEVER) {
        several_advance(&from[n], v, v->next, k->live); /* the first sample may begin before segment 0 */
        changed = changed | several_shown(&v->ways[v->now], v->shows) | several_shown(&v->ways[1 - v->now], v->comes);
      } else {
        v->comes = -1; /* stays on its way */
      }
      next = v->next < next ? v->next : next;
    }
    if (m_any(changed)) {
      if (shows && middles) {
        several_interval_of_middles(from, volumes, count, since, i, changed & k->live, k);
      } else if (shows) {
        several_interval(from, volumes, count, since, i, changed & k->live, stretches, k);
      }
      since = vi_select(changed, vi_set(i), since);
    }
    for (int n = 0; n < count; ++n) {
      if (volumes[n].comes >= 0) {
        volumes[n].now = 1 - volumes[n].now;
        volumes[n].shows = volumes[n].comes;
      }
    }
    i = next;
  }
  if (stretches && m_any(k->live)) { /* the part behind all samples */
    several_interval(from, volumes, count, since, SEVERAL_NEVER, k->live, stretches, k);
  }
  for (int n = 0; n < count; ++n) {
    k->samples = k->samples + volumes[n].k.samples;
    k->lookups = k->lookups + volumes[n].k.lookups;
    k->skipped = k->skipped + volumes[n].k.skipped;
  }
}

#endif
