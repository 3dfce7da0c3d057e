/* SPDX-License-Identifier: BSD-3-Clause
 * A pixel: the part of its ray that is seen, and its place in the picture. */
#ifndef STRATUS_TETRA_PIXEL_H
#define STRATUS_TETRA_PIXEL_H

#include "packet_math.h"
#include "tetra_arguments.h"
#include "tetra_gather.h"

/* The arrays of a picture; all but rgba are written only if the arguments want them. */
typedef struct stratus_tetra_picture {
  GLOBAL float* rgba;
  GLOBAL uchar* rgba8;
  GLOBAL float* depth;
  GLOBAL uint* samples;
} stratus_tetra_picture;

/* The visible part of a ray, from begin to end in z. World distance is offset + length z. */
typedef struct stratus_tetra_sight {
  vfloat length, offset, begin, end;
} stratus_tetra_sight;

INLINE vfloat v_root(vfloat a)
{
  vfloat r = v_from_bits(vi_set(0x5f375a86) - (v_to_bits(a) >> vi_set(1)));
  const vfloat halved = v_set(0.5f) * a;
  for (int iteration = 0; iteration < 3; ++iteration) {
    r = r * v_fma(halved * r, -r, v_set(1.5f));
  }
  return a * r;
}

/* A plane's function of z on rays: start + slope z. u, v: as of tetra_clip(). */
INLINE void tetra_plane(CONSTANT float* c, vfloat u, vfloat v, vfloat* start, vfloat* slope)
{
  *start = v_fma(u, v_set(c[1]), v_fma(v, v_set(c[2]), v_set(c[0])));
  *slope = v_fma(u, v_set(c[4]), v_fma(v, v_set(c[5]), v_set(c[3])));
}

/* Cuts what rays see at planes. us, uw, vs, vw: as of tetra_sight(). */
INLINE void tetra_clip(CONSTANT stratus_tetra_arguments* a, vfloat us, vfloat uw, vfloat vs, vfloat vw, stratus_tetra_sight* sight)
{
  const vfloat zero = v_set(0.0f), u = a->shear > 0.0f ? us : uw, v = a->shear > 0.0f ? vs : vw;
  for (int p = 0; p < a->plane_count; ++p) {
    vfloat start, slope;
    tetra_plane(a->plane[p], u, v, &start, &slope);
    const vmask rises = v_lt(zero, slope), falls = v_lt(slope, zero), level = m_andnot(m_andnot(v_le(slope, slope), rises), falls);
    const vfloat at = v_select(falls, start, zero - start) * v_reciprocal(v_max(v_abs(slope), v_set(1e-30f)));
    sight->begin = v_select(rises, v_max(sight->begin, at), sight->begin);
    sight->end = v_select(falls, v_min(sight->end, at), sight->end);
    sight->end = v_select(level & v_lt(start, zero), v_set(-LARGEST_FLOAT), sight->end);
  }
}

/* Return the visible part of the rays of pixels x, y. us, uw, vs, vw: their parts by column and by row. ends: read only if the arguments
 * say has_ends. */
INLINE stratus_tetra_sight tetra_sight(
  CONSTANT stratus_tetra_arguments* a, GLOBAL const float* ends, vfloat us, vfloat uw, vfloat vs, vfloat vw, vint x, vint y, vmask mask)
{
  stratus_tetra_sight sight;
  const vfloat square = v_fma(us, v_fma(us, v_set(a->square[3]), v_fma(vs, v_set(a->square[4]), v_set(a->square[1]))),
    v_fma(vs, v_fma(vs, v_set(a->square[5]), v_set(a->square[2])), v_set(a->square[0])));
  const vfloat length = v_root(square);
  /* only parallel rays lean, whose uw and vw are u and v */
  const vfloat lean = v_fma(uw, v_set(a->lean[0]), vw * v_set(a->lean[1]));
  sight.length = length * v_set(a->per_z);
  sight.offset = length * v_fma(-lean, v_set(a->per_z), v_set(a->per_frame));
  sight.begin = lean + v_set(a->begin);
  if (a->has_ends) {
    sight.end = gather_float(ends, x + y * vi_set(a->picture.width), mask);
  } else {
    sight.end = lean + v_set(a->end);
  }
  tetra_clip(a, us, uw, vs, vw, &sight);
  return sight;
}

INLINE void tetra_store_pixel(
  const stratus_tetra_picture* picture, CONSTANT stratus_tetra_arguments* a, int x, int y, const float rgba[4], float depth, uint segments)
{
  const size_t at = (size_t)y * (size_t)a->picture.width + (size_t)x;
  depth = a->shear > 0.0f && depth < 0.0f ? 0.0f : depth; /* perspective: a depth at the eye may be rounded to behind it */
  for (int c = 0; c < 4; ++c) {
    picture->rgba[4 * at + (size_t)c] = rgba[c];
  }
  for (int c = 0; c < 4 && a->picture.want_bytes; ++c) {
    const float value = rgba[c] * 255.0f + 0.5f;
    picture->rgba8[4 * at + (size_t)c] = (uchar)(int)(value < 255.0f ? value : 255.0f); /* premultiplied light is never below 0 */
  }
  if (a->picture.want_depth) {
    picture->depth[at] = rgba[3] > 0.0f && depth < LARGEST_FLOAT ? depth : INFINITY;
  }
  if (a->picture.want_samples) {
    picture->samples[at] = segments;
  }
}

#endif
