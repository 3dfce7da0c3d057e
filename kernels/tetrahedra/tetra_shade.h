/* SPDX-License-Identifier: BSD-3-Clause
 * Light of a stretch of a ray along which the field is taken as linear between two values. It comes from running sums over the table's
 * entries. A ray keeps the sums at its present value, so that each cell reads them at one place only. */
#ifndef STRATUS_TETRA_SHADE_H
#define STRATUS_TETRA_SHADE_H

#include "packet_math.h"
#include "tetra_arguments.h"
#include "tetra_gather.h"
#include "transfer_table.h"

/* The most that a stretch's weight is, so that long stretches do not overflow. At this weight a stretch that shows is opaque in any case:
 * the least sum, 1, spread over 2^16 entries and 256 pieces, is an optical depth of 2^16. */
#define OPAQUE_WEIGHT 0x1p40f
/* Matter behind so little transparency changes no float. */
#define OPAQUE_TRANSPARENCY 0x1p-24f

/* The light that a ray has gathered. */
typedef struct stratus_tetra_light {
  vfloat red, green, blue, transparency, depth;
  vfloat most; /* maximum: the largest value; surfaces of which only one is kept: how many the ray has met */
} stratus_tetra_light;

/* A value's place in the table: the entry nearest to it, and the sums of red, green and blue times tau, and of tau, up to that entry's
 * middle. */
typedef struct stratus_tetra_place {
  vint entry, sum[4];
} stratus_tetra_place;

INLINE stratus_tetra_place tetra_place(CONSTANT stratus_tetra_arguments* a, GLOBAL const int* sums, vfloat value, vmask mask)
{
  stratus_tetra_place place;
  place.entry = table_entry(&a->table, sums, value);
  gather_four_ints(sums, place.entry, mask, place.sum);
  return place;
}

INLINE stratus_tetra_place tetra_place_select(vmask mask, const stratus_tetra_place* a, const stratus_tetra_place* b)
{
  stratus_tetra_place place;
  place.entry = vi_select(mask, a->entry, b->entry);
  for (int c = 0; c < 4; ++c) {
    place.sum[c] = vi_select(mask, a->sum[c], b->sum[c]);
  }
  return place;
}

/* The effect of light and gradient at a place: a colour C of opacity A becomes C diffuse + A specular, and the optical depth is
 * multiplied. */
typedef struct stratus_tetra_lit {
  vfloat diffuse[3], specular[3], factor;
} stratus_tetra_lit;

/* Add `scale` of a medium's colour and opacity to the light that a ray has gathered. */
INLINE void tetra_gather(stratus_tetra_light* light, const stratus_tetra_lit* lit, vfloat scale, const vfloat color[4])
{
  vfloat c[3] = { color[0], color[1], color[2] };
  for (int i = 0; lit && i < 3; ++i) {
    c[i] = v_fma(c[i], lit->diffuse[i], color[3] * lit->specular[i]);
  }
  light->red = v_fma(scale, c[0], light->red);
  light->green = v_fma(scale, c[1], light->green);
  light->blue = v_fma(scale, c[2], light->blue);
}

/* (1 - exp(-x)) / x for x >= 0, with a relative error of 4e-7: the mean transparency of a medium of optical depth x to light from its
 * front. */
INLINE vfloat v_absorbed_share(vfloat x, vmask mask)
{
  const vfloat one = v_set(1.0f), minus = -v_min(x, one);
  vfloat share = v_set(1.0f / 362880.0f);
  share = v_fma(share, minus, v_set(1.0f / 40320.0f));
  share = v_fma(share, minus, v_set(1.0f / 5040.0f));
  share = v_fma(share, minus, v_set(1.0f / 720.0f));
  share = v_fma(share, minus, v_set(1.0f / 120.0f));
  share = v_fma(share, minus, v_set(1.0f / 24.0f));
  share = v_fma(share, minus, v_set(1.0f / 6.0f));
  share = v_fma(share, minus, v_set(0.5f));
  share = v_fma(share, minus, one);
  const vmask deep = mask & v_lt(one, x);
  if (m_any(deep)) {
    share = v_select(deep, v_absorbed(v_select(deep, x, one)) * v_reciprocal(v_max(x, one)), share);
  }
  return share;
}

/* The rise of the sums between two places of the table, which has the sign of the entries' rise: running sums never fall. A stretch within
 * one entry uses that entry, so that a transparent entry stays transparent next to a visible one; returns the lanes of such stretches. */
INLINE vmask tetra_span(CONSTANT stratus_tetra_arguments* a, GLOBAL const int* sums, const stratus_tetra_place* from,
  const stratus_tetra_place* to, vmask mask, vint span[4])
{
  const vmask level = mask & vi_zero(to->entry - from->entry);
  for (int c = 0; c < 4; ++c) {
    span[c] = to->sum[c] - from->sum[c];
  }
  if (m_any(level)) {
    vint own[4];
    gather_four_ints(sums, to->entry + vi_set((int)a->table.last + 1), level, own);
    for (int c = 0; c < 4; ++c) {
      span[c] = vi_select(level, own[c], span[c]);
    }
  }
  return level;
}

/* Composites the light between two places of the table. weight: length times the optical depth of one unit of the sums. lit: NULL where
 * nothing is lit or thinned. */
INLINE void tetra_composite(CONSTANT stratus_tetra_arguments* a, GLOBAL const int* sums, stratus_tetra_light* light, vmask mask,
  const stratus_tetra_place* from, const stratus_tetra_place* to, vfloat weight, vfloat near, const stratus_tetra_lit* lit)
{
  const vint rise = to->entry - from->entry, one = vi_set(1);
  vint span[4];
  const vmask level = tetra_span(a, sums, from, to, mask, span);
  const vfloat tau = v_abs(v_from_int(span[3]));
  mask = mask & v_lt(v_set(0.0f), tau);
  if (!m_any(mask)) {
    return;
  }
  vfloat per_entry = weight * v_reciprocal(v_abs(v_from_int(vi_select(level, one, rise))));
  if (lit) {
    per_entry = per_entry * lit->factor;
  }
  const vfloat depth = tau * per_entry, share = v_absorbed_share(depth, mask);
  const vfloat scale = v_select(mask, light->transparency * (per_entry * share), v_set(0.0f));
  const vfloat color[4] = { v_abs(v_from_int(span[0])), v_abs(v_from_int(span[1])), v_abs(v_from_int(span[2])), tau };
  tetra_gather(light, lit, scale, color);
  const vfloat alpha = v_select(mask, v_min(depth * share, v_set(1.0f)), v_set(0.0f));
  light->transparency = v_fma(-light->transparency, alpha, light->transparency);
  if (a->picture.want_depth) {
    const vmask hit = v_lt(v_set(0.0f), alpha) & v_le(v_set(LARGEST_FLOAT), light->depth);
    light->depth = v_select(hit, near, light->depth);
  }
}

/* Into how many pieces a stretch is cut, by the square of their number. */
INLINE vfloat tetra_pieces_of(vfloat q)
{
  const vfloat zero = v_set(0.0f);
  vfloat pieces = v_set(1.0f) + v_select(v_lt(v_set(1.0f), q), v_set(1.0f), zero) + v_select(v_lt(v_set(4.0f), q), v_set(1.0f), zero);
  pieces = pieces + v_select(v_lt(v_set(9.0f), q), v_set(2.0f), zero) + v_select(v_lt(v_set(25.0f), q), v_set(3.0f), zero);
  pieces = pieces + v_select(v_lt(v_set(64.0f), q), v_set(8.0f), zero) + v_select(v_lt(v_set(256.0f), q), v_set(16.0f), zero);
  pieces = pieces + v_select(v_lt(v_set(1024.0f), q), v_set(32.0f), zero) + v_select(v_lt(v_set(4096.0f), q), v_set(64.0f), zero);
  return pieces + v_select(v_lt(v_set(16384.0f), q), v_set(128.0f), zero);
}

/* The square of the number of pieces. depth: a stretch's optical depth times the entries that it spans, of which there are `entries`. A
 * colour changes by the table's steepest change an entry, and by no more than 1. */
INLINE vfloat tetra_pieces(CONSTANT stratus_tetra_arguments* a, vfloat depth, vfloat entries)
{
  const vfloat most = depth * v_reciprocal(v_max(entries, v_set(1.0f))) * v_set(a->pieces);
  return v_min(depth * v_set(a->table.color_slope), most);
}

/* A stretch that meets nothing opaque, from value `first` at place `from` to `last` at place `to`, cut into pieces where averaging its
 * colours would show. */
INLINE void tetra_integrate_clear(CONSTANT stratus_tetra_arguments* a, GLOBAL const int* sums, stratus_tetra_light* light, vmask mask,
  vfloat first, vfloat last, const stratus_tetra_place* from, const stratus_tetra_place* to, vfloat length, vfloat near)
{
  const vfloat one = v_set(1.0f), weight = v_min(length * v_set(a->table.tau_scale), v_set(OPAQUE_WEIGHT));
  const vfloat depth = v_abs(v_from_int(to->sum[3] - from->sum[3])) * weight; /* times the number of entries that the stretch spans */
  const vmask several = mask & v_lt(one, depth * v_set(a->table.color_slope));
  if (!m_any(several)) {
    tetra_composite(a, sums, light, mask, from, to, weight, near, 0);
    return;
  }
  const vfloat entries = v_abs(v_from_int(to->entry - from->entry));
  const vfloat pieces = v_select(several, tetra_pieces_of(tetra_pieces(a, depth, entries)), one),
               share = v_select(several, v_reciprocal(pieces), one);
  vfloat piece = v_set(0.0f);
  stratus_tetra_place begin = *from;
  do {
    piece = piece + one;
    const vmask more = mask & v_lt(piece, pieces);
    stratus_tetra_place end = *to; /* the last piece ends where the stretch does */
    if (m_any(more)) {
      const stratus_tetra_place middle = tetra_place(a, sums, v_fma(last - first, piece * share, first), more);
      end = tetra_place_select(more, &middle, to);
    }
    tetra_composite(a, sums, light, mask, &begin, &end, weight * share, near, 0);
    begin = end;
    mask = more & v_lt(v_set(OPAQUE_TRANSPARENCY), light->transparency);
  } while (m_any(mask));
}

/* Composites entry `entry`, of opacity 1, which is thinned to alpha. lit: as of tetra_composite(). */
INLINE void tetra_end(CONSTANT stratus_tetra_arguments* a, GLOBAL const int* sums, stratus_tetra_light* light, vmask mask, vint entry,
  vfloat alpha, vfloat near, const stratus_tetra_lit* lit)
{
  vint own[4];
  gather_four_ints(sums, entry + vi_set((int)a->table.last + 1), mask, own);
  const vfloat zero = v_set(0.0f), per_tau = v_reciprocal(v_max(v_from_int(own[3]), v_set(1.0f)));
  const vfloat scale = v_select(mask, light->transparency * alpha * per_tau, zero);
  const vfloat color[4] = { v_from_int(own[0]), v_from_int(own[1]), v_from_int(own[2]), v_from_int(own[3]) };
  tetra_gather(light, lit, scale, color);
  light->transparency = v_select(mask, light->transparency - light->transparency * alpha, light->transparency);
  if (a->picture.want_depth) {
    light->depth = v_select(mask & v_le(v_set(LARGEST_FLOAT), light->depth), near, light->depth);
  }
}

/* The part of a stretch before its first opaque entry. Returns the lanes that meet one, *entry; *end: the place where the part before ends;
 * *part: its share of the stretch; *before: the lanes among them that have such a part. */
INLINE vmask tetra_before_opaque(CONSTANT stratus_tetra_arguments* a, GLOBAL const int* sums, vmask mask, const stratus_tetra_place* from,
  const stratus_tetra_place* to, vint* entry, stratus_tetra_place* end, vfloat* part, vmask* before)
{
  GLOBAL const int* rows = sums + 8 * ((int)a->table.last + 1);
  const vmask opaque = opaque_on_the_way(&a->table, rows, from->entry, to->entry, mask, entry);
  *before = m_none();
  if (m_any(opaque)) {
    const vint one = vi_set(1), steps = vi_max(*entry, from->entry) - vi_min(*entry, from->entry);
    *before = opaque & vi_lt(one, steps);
    const vint whole = vi_max(to->entry, from->entry) - vi_min(to->entry, from->entry);
    *part = v_select(*before, v_from_int(steps - one) * v_reciprocal(v_from_int(vi_max(whole, one))), v_set(1.0f));
    end->entry = vi_select(*before, vi_select(vi_ge(*entry, from->entry), *entry - one, *entry + one), to->entry);
    gather_four_ints(sums, end->entry, *before, end->sum);
    *end = tetra_place_select(*before, end, to);
  }
  return opaque;
}

/* Any stretch: the part before the first opaque entry, then that entry. */
INLINE void tetra_integrate(CONSTANT stratus_tetra_arguments* a, GLOBAL const int* sums, stratus_tetra_light* light, vmask mask,
  vfloat first, vfloat last, const stratus_tetra_place* from, const stratus_tetra_place* to, vfloat length, vfloat near)
{
  stratus_tetra_place end = *to;
  vint entry = to->entry;
  vmask opaque = m_none();
  if (a->table.has_opaque) {
    vmask before;
    vfloat part = v_set(1.0f);
    opaque = tetra_before_opaque(a, sums, mask & v_lt(v_set(0.0f), length), from, to, &entry, &end, &part, &before);
    if (m_any(opaque)) {
      last = v_select(before, v_fma(last - first, part, first), last);
      length = length * part;
      mask = m_andnot(mask, opaque) | before;
    }
  }
  tetra_integrate_clear(a, sums, light, mask, first, last, from, &end, length, near);
  if (m_any(opaque)) {
    tetra_end(a, sums, light, opaque, entry, v_set(1.0f), near, 0);
  }
}

#endif
