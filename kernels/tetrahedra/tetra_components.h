/* SPDX-License-Identifier: BSD-3-Clause
 * Values of several components, in the variant TETRA_LIT: each component is a medium of its own, or one has the opacity and the others the
 * colour. A stretch is cut into pieces, in each of which every component counts by the means of its running sums. */
#ifndef STRATUS_TETRA_COMPONENTS_H
#define STRATUS_TETRA_COMPONENTS_H

#include "tetra_shade.h"

#define TETRA_COMPONENTS 4
#define OPAQUE_DEPTH 1e4f /* of a piece that meets an entry of opacity 1 */

/* Places of a stretch's values in the tables of all components, at its start and at its end. */
typedef struct stratus_tetra_values {
  vfloat from[TETRA_COMPONENTS], to[TETRA_COMPONENTS];
} stratus_tetra_values;

/* A component's mean colour and its optical depth over a length, on a way between two places of its table. */
INLINE void component_mean(CONSTANT stratus_tetra_arguments* a, GLOBAL const int* all, int c, vfloat from, vfloat to, vfloat length,
  vmask mask, vfloat color[3], vfloat* depth)
{
  GLOBAL const int* sums = all + a->media.sums_at[c];
  const float last = a->media.last[c];
  const int entries = (int)last + 1;
  const vint low = v_to_int(v_clamp(from, 0.0f, last)), high = v_to_int(v_clamp(to, 0.0f, last)), rise = high - low;
  const vmask level = mask & vi_zero(rise);
  const vfloat one = v_set(1.0f), steps = v_reciprocal(v_max(v_abs(v_from_int(rise)), one));
  vint before[4], up_to[4];
  vfloat mean[4];
  gather_four_ints(sums, low, mask, before);
  gather_four_ints(sums, high, mask, up_to);
  for (int i = 0; i < 4; ++i) {
    mean[i] = v_abs(v_from_int(up_to[i] - before[i])) * steps;
  }
  if (m_any(level)) {
    gather_four_ints(sums, high + vi_set(entries), level, up_to);
    for (int i = 0; i < 4; ++i) {
      mean[i] = v_select(level, v_from_int(up_to[i]), mean[i]);
    }
  }
  *depth = v_min(mean[3] * v_set(a->media.depth_scale[c]) * length, v_set(1e18f));
  if (a->media.has_opaque[c]) {
    GLOBAL const int* rows = sums + 8 * entries;
    const vmask rises = vi_ge(high, low);
    const vint first = v_gather_ints(rows, low + vi_select(rises, vi_set(0), vi_set(entries)), mask);
    const vmask met = mask & ((rises & vi_ge(high, first)) | m_andnot(vi_ge(first, high), rises));
    if (m_any(met)) {
      gather_four_ints(sums, vi_select(met, first, high) + vi_set(entries), met, up_to);
      for (int i = 0; i < 4; ++i) {
        mean[i] = v_select(met, v_from_int(up_to[i]), mean[i]);
      }
      *depth = v_select(met & v_lt(v_set(0.0f), length), v_set(OPAQUE_DEPTH), *depth);
    }
  }
  const vfloat per_tau = v_reciprocal(v_max(mean[3], one));
  for (int i = 0; i < 3; ++i) {
    color[i] = mean[i] * per_tau;
  }
}

/* What all components make of a way: the light that it emits where nothing hides it, and its optical depth. */
INLINE void mix_components(CONSTANT stratus_tetra_arguments* a, GLOBAL const int* sums, const vfloat from[TETRA_COMPONENTS],
  const vfloat to[TETRA_COMPONENTS], vfloat length, vmask mask, vfloat glow[3], vfloat* depth)
{
  const vfloat zero = v_set(0.0f);
  const int last = a->media.components - 1;
  vfloat squares = zero, color[3], own;
  *depth = glow[0] = glow[1] = glow[2] = zero;
  for (int c = a->media.dependent ? last : 0; c <= last; ++c) {
    component_mean(a, sums, c, from[c], to[c], length, mask, color, &own);
    if (a->media.dependent && last == 1) {
      vfloat unused;
      component_mean(a, sums, 0, from[0], to[0], length, mask, color, &unused);
    } else if (a->media.dependent) {
      for (int i = 0; i < 3; ++i) {
        color[i] = v_set(0.5f) * (from[i] + to[i]);
      }
    }
    *depth = *depth + own;
    squares = v_fma(own, own, squares);
    for (int i = 0; i < 3; ++i) {
      glow[i] = v_fma(own, color[i], glow[i]);
    }
  }
  if (a->media.mean) {
    *depth = squares * v_reciprocal(v_max(*depth, v_set(1e-30f)));
  }
}

/* Where a product or a share of components is mixed of their means, the error falls with the square of the number of pieces: by three
 * quarters from a whole stretch, `glow` and `depth`, to two halves. Returns that square, where the halves' difference asks for it. */
INLINE vfloat mixing_pieces(CONSTANT stratus_tetra_arguments* a, GLOBAL const int* sums, const stratus_tetra_values* values, vfloat length,
  vmask mask, const vfloat glow[3], vfloat depth)
{
  const vfloat centre = v_set(0.5f);
  vfloat middle[TETRA_COMPONENTS], first[3], second[3], depths[2], change;
  for (int c = 0; c < TETRA_COMPONENTS; ++c) {
    middle[c] = centre * (values->from[c] + values->to[c]);
  }
  mix_components(a, sums, values->from, middle, centre * length, mask, first, depths);
  mix_components(a, sums, middle, values->to, centre * length, mask, second, depths + 1);
  change = v_abs(depth - (depths[0] + depths[1]));
  for (int i = 0; i < 3; ++i) {
    change = v_max(change, v_abs(glow[i] - (first[i] + second[i])));
  }
  return v_set(16.0f * a->pieces) * change * v_reciprocal(v_max(v_min(depth, v_set(1.0f)), v_set(1e-20f)));
}

/* Composites a stretch. */
INLINE void tetra_media(CONSTANT stratus_tetra_arguments* a, GLOBAL const int* sums, const stratus_tetra_values* values,
  stratus_tetra_light* light, vmask mask, vfloat length, vfloat near)
{
  const vfloat one = v_set(1.0f), zero = v_set(0.0f);
  vfloat glow[3], depth, from[TETRA_COMPONENTS], to[TETRA_COMPONENTS];
  mix_components(a, sums, values->from, values->to, length, mask, glow, &depth);
  mask = mask & v_lt(zero, depth);
  if (!m_any(mask)) {
    return;
  }
  vfloat q = depth * v_set(a->pieces); /* a colour changes by 1 at most */
  if (a->media.dependent || a->media.mean) {
    q = v_max(q, mixing_pieces(a, sums, values, length, mask, glow, depth));
  }
  const vfloat pieces = tetra_pieces_of(q), share = v_reciprocal(pieces);
  vfloat piece = zero, at = zero;
  for (int c = 0; c < TETRA_COMPONENTS; ++c) {
    from[c] = values->from[c];
  }
  do {
    piece = piece + one;
    const vmask more = mask & v_lt(piece, pieces);
    const vfloat next = v_select(more, piece * share, one);
    for (int c = 0; c < TETRA_COMPONENTS; ++c) {
      to[c] = v_select(more, v_fma(values->to[c] - values->from[c], next, values->from[c]), values->to[c]);
    }
    mix_components(a, sums, from, to, length * (next - at), mask, glow, &depth);
    const vmask shows = mask & v_lt(zero, depth);
    const vfloat shares = v_absorbed_share(v_select(shows, depth, zero), shows);
    const vfloat alpha = v_select(shows, v_min(depth * shares, one), zero), scale = v_select(shows, light->transparency * shares, zero);
    light->red = v_fma(scale, glow[0], light->red);
    light->green = v_fma(scale, glow[1], light->green);
    light->blue = v_fma(scale, glow[2], light->blue);
    light->transparency = v_fma(zero - light->transparency, alpha, light->transparency);
    if (a->picture.want_depth) {
      light->depth = v_select(shows & v_lt(zero, alpha) & v_le(v_set(LARGEST_FLOAT), light->depth), near, light->depth);
    }
    for (int c = 0; c < TETRA_COMPONENTS; ++c) {
      from[c] = to[c];
    }
    at = next;
    mask = more & v_lt(v_set(OPAQUE_TRANSPARENCY), light->transparency);
  } while (m_any(mask));
}

#endif
