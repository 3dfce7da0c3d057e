/* SPDX-License-Identifier: BSD-3-Clause
 * A packet of rays: its lines, its place on them, and the numbers that the integrators gather. From pixels to a packet's first segments. */
#ifndef STRATUS_RAY_PACKET_H
#define STRATUS_RAY_PACKET_H

#include "packet.h"
#include "ray_setup.h"

/* 1: the rays are lit, at places that neighbouring stretches share (lit_places.h). */
#ifndef RAY_LIT
#define RAY_LIT 0
#endif

#if RAY_LIT
/* A bundle that was lit (lit_places.h): its place on the ray, half of its length, the field's slope along the ray there (0: there is no
 * bundle), and by how much its colour would change where the normal is turned round. */
typedef struct stratus_lit_bundle {
  float place, extent, slope, turned[3];
} stratus_lit_bundle;

/* The bundles of rays. The colours of a ray's open bundle are the packet's own. Closed bundles of all rays wait in a queue, so that light
 * is computed for as many of them at once as a packet has lanes. */
#define LIT_QUEUE (2 * STRATUS_WIDTH)
typedef struct stratus_lit_places {
  vfloat limit, gap;                    /* the largest spread of a bundle, in squares of samples, and the widest gap in it, a voxel */
  vfloat reach;                         /* where the last stretch ended */
  vfloat weight, first, second, origin; /* of the open bundles: their opacity, and the moments of their places about `origin` */
  float lit[3][STRATUS_WIDTH];          /* each ray's colours with light */
  /* of the closed bundles: as of a stratus_lit_bundle, and the number of the ray */
  float place[LIT_QUEUE], extent[LIT_QUEUE], opacity[LIT_QUEUE], color[3][LIT_QUEUE];
  int lane[LIT_QUEUE], count;
  stratus_lit_bundle last[STRATUS_WIDTH]; /* of each ray, the one that was lit last */
} stratus_lit_places;
#endif

typedef struct stratus_packet {
  vfloat p[3], d[3], inverse[3], begin, end, first;
  vfloat unit; /* the length of a sample in sample distances */
  vfloat transparency, red, green, blue, depth;
  /* pre-integrated: the value at the segment's front; extremes: the best value so far; sums: the sum, whose weight is in `red`; surfaces of
   * which only one is kept: how many the ray has met */
  vfloat front;
  vint i, last; /* the current segment, and the first behind the ray's end */
  vint run;     /* segments before it need not ask the structure */
  vint octant;  /* offset of the map of the ray's octant */
  vint samples, skipped, lookups;
  vmask live, hits;         /* hits: rays that meet the bounds */
  vmask fresh;              /* the value at the segment's front is still to be sampled */
  GLOBAL const int* grid;   /* the tables of a grid whose spacing changes */
  GLOBAL const int* lights; /* the maps of lights */
  vfloat surface[2];        /* slices: where the rays meet the surface, the nearer first, in samples; LARGEST_FLOAT where they do not */
#if RAY_LIT
  stratus_lit_places places;
#endif
} stratus_packet;

#if STRATUS_WIDTH > 1 && (defined(STRATUS_DEVICE) ? defined(STRATUS_DEVICE_AVX512) : STRATUS_ISA == 2)
INLINE vint mask_int(vmask m) { return vi_select(m, vi_set(-1), vi_set(0)); }
#else
INLINE vint mask_int(vmask m) { return m; }
#endif

/* The lengths, in sample distances, of parts of the rays that are so many samples long. */
INLINE vfloat packet_length(CONSTANT stratus_ray_cast_arguments* a, const stratus_packet* k, vfloat samples)
{
  if (RAY_RARE(RAY_FOLLOWS, a->lattice.follows)) {
    samples = samples * k->unit;
  }
  return samples;
}

INLINE vfloat segment_middle(const stratus_packet* k, vfloat fi)
{
  return v_set(0.5f) * (v_max(fi, k->begin) + v_min(fi + v_set(1.0f), k->end));
}

/* The first segment that begins at `end` or behind it. */
INLINE vint segment_behind(vfloat end)
{
  const vint whole = v_to_int(end);
  return vi_select(v_lt(v_from_int(whole), end), whole + vi_set(1), whole);
}

/* 1 if no ray of the packet at pixel (x, y) can meet anything. */
INLINE int packet_outside(CONSTANT stratus_ray_cast_arguments* a, int x, int y)
{
  return x + PACKET_X <= a->camera.window[0] || x >= a->camera.window[1] || y + PACKET_Y <= a->camera.window[2] || y >= a->camera.window[3];
}

/* A packet that has seen nothing. */
INLINE void packet_nothing(stratus_packet* k)
{
  k->samples = vi_set(0);
  k->skipped = vi_set(0);
  k->lookups = vi_set(0);
  k->transparency = k->unit = v_set(1.0f);
  k->red = k->green = k->blue = k->front = v_set(0.0f);
  k->depth = v_set(LARGEST_FLOAT);
  k->live = k->hits = k->fresh = m_none();
  k->grid = k->lights = 0;
}

/* Sets up the rays of the packet at pixel (x, y). Returns those whose pixel is in the picture. */
INLINE vmask packet_rays(CONSTANT stratus_ray_cast_arguments* a, GLOBAL const float* opaque_depth, int x, int y, stratus_rays* rays)
{
  const vint px = (vi_lanes() & vi_set(PACKET_X - 1)) + vi_set(x), py = (vi_lanes() >> vi_set(PACKET_X_LOG2)) + vi_set(y);
  float fx[STRATUS_WIDTH], fy[STRATUS_WIDTH], fz[STRATUS_WIDTH], fw[STRATUS_WIDTH];
  v_store(fx, v_from_int(px));
  v_store(fy, v_from_int(py));
  if (a->camera.has_opaque_depth) {
    for (int lane = 0; lane < STRATUS_WIDTH; ++lane) {
      const int lx = x + (lane & (PACKET_X - 1)), ly = y + (lane >> PACKET_X_LOG2);
      fz[lane] = lx < a->picture.width && ly < a->picture.height ? opaque_depth[(size_t)ly * (size_t)a->picture.width + (size_t)lx] : 1.0f;
    }
  }
  if (RAY_RARE(RAY_JITTER, a->lattice.jitter)) {
    for (int lane = 0; lane < STRATUS_WIDTH; ++lane) {
      fw[lane] = ray_jitter(x + (lane & (PACKET_X - 1)), y + (lane >> PACKET_X_LOG2), a->lattice.seed);
    }
  }
  for (int part = 0; part < STRATUS_WIDTH; part += REAL_WIDTH) {
    ray_setup_part(a, fx + part, fy + part, fz + part, fw + part, part, rays);
  }
  return vi_lt(px, vi_set(a->picture.width)) & vi_lt(py, vi_set(a->picture.height));
}

/* Make a packet of its rays: whole segments, the part that this piece owns, and the visible box. */
INLINE void packet_begin(CONSTANT stratus_ray_cast_arguments* a, const stratus_rays* rays, vmask inside, stratus_packet* k)
{
  const vfloat zero = v_set(0.0f), most = v_set(8e6f);
  packet_nothing(k);
  k->begin = v_load(rays->begin);
  k->end = v_load(rays->end);
  k->live = inside & v_lt(k->begin, k->end);
  k->hits = k->live;
  k->begin = v_select(k->live, k->begin, zero);
  k->end = v_select(k->live, k->end, zero); /* lanes that are not live stay at a harmless place */
  k->first = v_load(rays->first);
  if (RAY_RARE(RAY_FOLLOWS, a->lattice.follows)) {
    k->unit = v_load(rays->unit);
  }
  k->octant = vi_set(0);
  for (int axis = 0; axis < 3; ++axis) {
    k->p[axis] = v_load(rays->p[axis]);
    k->d[axis] = v_load(rays->d[axis]);
    k->inverse[axis] = v_load(rays->inverse[axis]);
    const vmask forward = v_lt(zero, k->inverse[axis]);
    k->octant = k->octant + vi_select(forward, vi_set(a->map.octant_stride << axis), vi_set(0));
  }
  k->last = segment_behind(v_min(k->end, most));
  k->i = vi_set(0);
  if (RAY_RARE(RAY_PIECE, a->crop.has_piece)) { /* segments whose middle is in [piece_begin, piece_end) */
    const vfloat from = v_clamp(v_load(rays->piece_begin) + v_set(0.5f), 0.0f, 8e6f),
                 to = v_clamp(v_load(rays->piece_end) + v_set(0.5f), 0.0f, 8e6f);
    const vint i0 = v_to_int(from), i1 = v_to_int(to);
    k->i = vi_select(v_lt(v_from_int(i0), from), i0, i0 - vi_set(1));
    k->i = vi_max(k->i, vi_set(0));
    k->last = vi_min(k->last, vi_select(v_lt(v_from_int(i1), to), i1, i1 - vi_set(1)));
  }
  k->run = vi_set(0x7fffffff);
  if (a->map.structure) {
    vfloat enter = zero, leave = most;
    for (int axis = 0; axis < 3; ++axis) {
      const vfloat lo = (v_set(a->map.occupied[0][axis]) - k->p[axis]) * k->inverse[axis];
      const vfloat hi = (v_set(a->map.occupied[1][axis]) - k->p[axis]) * k->inverse[axis];
      enter = v_max(enter, v_min(lo, hi));
      leave = v_min(v_max(lo, hi), leave);
    }
    /* one segment of slack each way; a ray that misses the box ends here */
    const vint i0 = vi_max(v_to_int(v_min(enter, most)) - vi_set(1), k->i);
    const vint i1 = vi_min(
      vi_select(v_lt(leave, v_fma(enter, v_set(0.999999f), v_set(-1.0f))), vi_set(0), v_to_int(v_max(leave, zero)) + vi_set(2)), k->last);
    const vint segments = vi_max(k->last - k->i, vi_set(0)), left = vi_max(i1 - i0, vi_set(0));
    k->skipped = vi_select(k->live, segments - left, vi_set(0));
    k->i = i0;
    k->last = i1;
    k->run = vi_set(0);
  }
  k->last = vi_select(k->live, k->last, vi_set(0));
  k->live = k->live & vi_lt(k->i, k->last);
}

#endif
