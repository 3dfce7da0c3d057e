/* SPDX-License-Identifier: BSD-3-Clause
 * From pixels to rays, in double precision: where a packet's rays meet the bounds, on the one lattice of samples that is anchored at the
 * eye. Positions are rebased at the first sample inside, so that floats hold them from there on. */
#ifndef STRATUS_RAY_SETUP_H
#define STRATUS_RAY_SETUP_H

#include "ray_cast_arguments.h"

/* The rays of one packet. The sample at s (in samples from the start of segment 0) has the index coordinates p + s d. Segment i spans
 * [max(i, begin), min(i+1, end)]. */
typedef struct stratus_rays {
  float p[3][STRATUS_WIDTH], d[3][STRATUS_WIDTH], inverse[3][STRATUS_WIDTH];
  float begin[STRATUS_WIDTH], end[STRATUS_WIDTH];
  float first[STRATUS_WIDTH];                                 /* the lattice index of segment 0, for depth */
  float unit[STRATUS_WIDTH];                                  /* the length of a sample in sample distances; set if lattice.follows is */
  float whole[2][STRATUS_WIDTH];                              /* the sum is that index, exactly, and without jitter */
  float piece_begin[STRATUS_WIDTH], piece_end[STRATUS_WIDTH]; /* the part that this piece owns, in samples */
  float layers[2][STRATUS_WIDTH];                             /* where the first layer begins and how deep each is, in samples */
  float crossing[3][2][STRATUS_WIDTH];                        /* where the ray crosses the planes between crop regions, in samples */
} stratus_rays;

/* The number of layers that rays store one by one, on the host only: else 0. */
#ifdef STRATUS_DEVICE
#define RAY_LAYERS(a) 0
#else
#define RAY_LAYERS(a) (a)->camera.layers
#endif

/* The smallest displacement of a sample along an axis, in voxels. It keeps reciprocals finite, and the product of two in the range of
 * floats; and it moves no ray by a thousandth of a voxel, even if the eye is 1e11 samples away, as from voxels of very unequal sides. */
#define SMALLEST_STEP 1e-14f

INLINE real ray_away_from_zero(real d)
{
  const real plus = r_number(SMALLEST_STEP), minus = r_neg(plus), zero = r_number(0.0f);
  return r_select(r_lt(d, zero), r_min(d, minus), r_max(d, plus));
}

INLINE void ray_clip_slab(real origin, real inverse, stratus_pair lo, stratus_pair hi, real* begin, real* end)
{
  const real a = r_mul(r_sub(r_of(lo), origin), inverse), b = r_mul(r_sub(r_of(hi), origin), inverse);
  *begin = r_max(*begin, r_min(a, b));
  *end = r_min(*end, r_max(a, b));
}

/* Clips the ray origin + s direction to the half space n x + d >= 0. */
INLINE void ray_clip_plane(CONSTANT stratus_pair* plane, const real* origin, const real* direction, real* begin, real* end)
{
  const real zero = r_number(0.0f);
  real height = r_of(plane[3]), slope = zero;
  for (int axis = 0; axis < 3; ++axis) {
    height = r_add(height, r_mul(r_of(plane[axis]), origin[axis]));
    slope = r_add(slope, r_mul(r_of(plane[axis]), direction[axis]));
  }
  const rmask rising = r_lt(zero, slope), falling = r_lt(slope, zero);
  /* where the slope is zero the quotient is not used */
  const real crossing = r_neg(r_div(height, slope));
  *begin = r_select(rising, r_max(*begin, crossing), *begin);
  *end = r_select(falling, r_min(*end, crossing), *end);
  const rmask outside = r_lt(height, zero);
  *end = r_select(rising, *end, r_select(falling, *end, r_select(outside, r_number(-1e30f), *end)));
}

/* How far the lattice of the ray through pixel (x, y) is moved, in 0..1 of a sample. It depends only on pixel and seed. */
INLINE float ray_jitter(int x, int y, int seed)
{
  uint h = (uint)x * 0x9e3779b1u ^ (uint)y * 0x85ebca77u ^ (uint)seed * 0xc2b2ae3du;
  h = (h ^ h >> 16) * 0x85ebca6bu; /* Murmur3's finalizer (Appleby) */
  h = (h ^ h >> 13) * 0xc2b2ae35u;
  h ^= h >> 16;
  return (float)(int)(h >> 8) * 0x1p-24f;
}

/* REAL_WIDTH rays of the pixels x, y (whole numbers): index origins, directions by k. Returns the samples that a unit of k is, in *per_k,
 * and its reciprocal. *unit: the length of a sample in sample distances. */
INLINE real ray_line(
  CONSTANT stratus_ray_cast_arguments* a, const float* x, const float* y, real origin[3], real direction[3], real* per_k, real* unit)
{
  const real half_one = r_number(0.5f), one = r_number(1.0f), two = r_number(2.0f);
  const real u = r_sub(r_mul(r_mul(r_add(r_load(x), half_one), two), r_of(a->camera.pixel[0])), one);
  const real v = r_sub(r_mul(r_mul(r_add(r_load(y), half_one), two), r_of(a->camera.pixel[1])), one);
  real length = r_of(a->camera.metric[0]);
  for (int axis = 0; axis < 3; ++axis) {
    const real offset = r_add(r_mul(u, r_of(a->camera.right[axis])), r_mul(v, r_of(a->camera.up[axis])));
    origin[axis] = a->camera.parallel ? r_add(r_of(a->camera.eye[axis]), offset) : r_of(a->camera.eye[axis]);
    direction[axis] = a->camera.parallel ? r_of(a->camera.forward[axis]) : r_add(r_of(a->camera.forward[axis]), offset);
  }
  if (!a->camera.parallel) {
    length = r_add(
      length, r_mul(u, r_add(r_of(a->camera.metric[1]), r_add(r_mul(u, r_of(a->camera.metric[3])), r_mul(v, r_of(a->camera.metric[4]))))));
    length = r_add(length, r_mul(v, r_add(r_of(a->camera.metric[2]), r_mul(v, r_of(a->camera.metric[5])))));
  }
  length = r_sqrt(length);
  *per_k = r_mul(length, r_of(a->lattice.per_step));
  *unit = one;
  if (RAY_RARE(RAY_FOLLOWS, a->lattice.follows)) {
    const real distances = *per_k;
    *per_k = r_number(0.0f);
    for (int axis = 0; axis < 3; ++axis) {
      *per_k = r_max(*per_k, r_mul(r_max(direction[axis], r_neg(direction[axis])), r_of(a->lattice.per_voxel[axis])));
    }
    *unit = r_div(distances, *per_k);
  }
  return r_div(one, *per_k);
}

/* Sets up REAL_WIDTH rays of the packet, from ray number `part` on. x, y: their pixels (whole numbers); z: their opaque depths; w: their
 * jitter. */
INLINE void ray_setup_part(
  CONSTANT stratus_ray_cast_arguments* a, const float* x, const float* y, const float* z, const float* w, int part, stratus_rays* rays)
{
  const real zero = r_number(0.0f), one = r_number(1.0f);
  real origin[3], direction[3], samples_per_k, unit;
  const real k_per_sample = ray_line(a, x, y, origin, direction, &samples_per_k, &unit);

  real begin = r_mul(r_of(a->camera.near_k), samples_per_k), end = r_of(a->lattice.reach);
  if (a->camera.has_far) {
    end = r_min(end, r_mul(r_of(a->camera.far_k), samples_per_k));
  }
  if (a->camera.has_opaque_depth) {
    const real depth = r_load(z), near_k = r_of(a->camera.near_k), far_k = r_of(a->camera.far_k),
               extent = r_mul(depth, r_sub(far_k, near_k));
    const real k = a->camera.parallel ? r_add(near_k, extent) : r_div(r_mul(near_k, far_k), r_sub(far_k, extent));
    end = r_min(end, r_mul(k, samples_per_k));
  }
  for (int plane = 0; plane < RAY_RARE(RAY_CLIP, a->crop.clip_count); ++plane) {
    real step[3];
    for (int axis = 0; axis < 3; ++axis) {
      step[axis] = r_mul(direction[axis], k_per_sample);
    }
    ray_clip_plane(a->crop.clip[plane], origin, step, &begin, &end);
  }
  real inverse[3];
  for (int axis = 0; axis < 3; ++axis) {
    direction[axis] = ray_away_from_zero(r_mul(direction[axis], k_per_sample));
  }
  /* three reciprocals by one division */
  const real xy = r_mul(direction[0], direction[1]), per_xyz = r_div(one, r_mul(xy, direction[2]));
  inverse[0] = r_mul(per_xyz, r_mul(direction[1], direction[2]));
  inverse[1] = r_mul(per_xyz, r_mul(direction[0], direction[2]));
  inverse[2] = r_mul(per_xyz, xy);
  for (int axis = 0; axis < 3; ++axis) {
    ray_clip_slab(origin[axis], inverse[axis], a->crop.box[0][axis], a->crop.box[1][axis], &begin, &end);
  }
  real shift = zero;
  if (RAY_RARE(RAY_JITTER, a->lattice.jitter)) { /* the same line, with its origin moved against the ray by `shift` samples */
    shift = r_load(w);
    begin = r_add(begin, shift);
    end = r_add(end, shift);
    for (int axis = 0; axis < 3; ++axis) {
      origin[axis] = r_sub(origin[axis], r_mul(shift, direction[axis]));
    }
  }
  /* rays that miss get any numbers, but small ones */
  const rmask miss = r_lt(end, begin);
  begin = r_select(miss, zero, begin);
  end = r_select(miss, r_neg(one), end);
  const real first = r_floor(begin);
  r_store(rays->begin + part, r_sub(begin, first));
  r_store(rays->end + part, r_sub(end, first));
  r_store(rays->first + part, RAY_RARE(RAY_JITTER, a->lattice.jitter) ? r_sub(first, shift) : first);
  if (RAY_RARE(RAY_FOLLOWS, a->lattice.follows)) {
    r_store(rays->unit + part, unit);
  }
  r_store(rays->whole[0] + part, first);
  r_store(rays->whole[1] + part, r_sub(first, r_load(rays->whole[0] + part)));
  if (RAY_LAYERS(a)) {
    r_store(rays->layers[0] + part, r_sub(r_mul(r_of(a->camera.near_k), samples_per_k), first));
    r_store(rays->layers[1] + part, r_mul(r_of(a->camera.layer_k), samples_per_k));
  }
  for (int side = 0; RAY_RARE(RAY_REGIONS, a->crop.regions) && side < 6; ++side) {
    const int axis = side / 2;
    const real crossing = r_mul(r_sub(r_of(a->crop.plane[axis][side % 2]), origin[axis]), inverse[axis]);
    r_store(rays->crossing[axis][side % 2] + part, r_sub(crossing, first));
  }
  if (RAY_RARE(RAY_PIECE, a->crop.has_piece)) {
    real piece_begin = r_neg(one), piece_end = r_add(r_sub(end, first), one);
    piece_begin = r_add(piece_begin, first);
    piece_end = r_add(piece_end, first);
    for (int axis = 0; axis < 3; ++axis) {
      ray_clip_slab(origin[axis], inverse[axis], a->crop.piece[0][axis], a->crop.piece[1][axis], &piece_begin, &piece_end);
    }
    r_store(rays->piece_begin + part, r_sub(piece_begin, first));
    r_store(rays->piece_end + part, r_sub(piece_end, first));
  }
  for (int axis = 0; axis < 3; ++axis) {
    r_store(rays->p[axis] + part, r_select(miss, zero, r_add(origin[axis], r_mul(first, direction[axis]))));
    r_store(rays->d[axis] + part, direction[axis]);
    r_store(rays->inverse[axis] + part, inverse[axis]);
  }
}

#endif
