/* SPDX-License-Identifier: BSD-3-Clause
 * Values of several components, in the variant TETRA_LIT: each component is a medium of its own, or one has the opacity and the others the
 * colour. A stretch is cut into pieces, in each of which every component counts by the means of its running sums. */
#ifndef STRATUS_TETRA_COMPONENTS_H
#define STRATUS_TETRA_COMPONENTS_H

#include "tetra_light.h"

#define TETRA_COMPONENTS 4
#define OPAQUE_DEPTH 1e4f /* of a piece that meets an entry of opacity 1 */

/* Places of a stretch's values in the tables of all components, at its start and at its end. */
typedef struct stratus_tetra_values {
  vfloat from[TETRA_COMPONENTS], to[TETRA_COMPONENTS];
} stratus_tetra_values;

/* A stretch of several components. */
typedef struct stratus_tetra_mixture {
  const stratus_tetra_values* values;
  const stratus_tetra_stretch* gradients; /* of those components whose light or opacity depends on them; 0: none is lit or thinned */
  GLOBAL const int* sums;                 /* of all components */
  GLOBAL const float* factors;            /* their gradient opacities */
  vfloat length;                          /* in the world */
} stratus_tetra_mixture;

/* A component's contribution on a path. */
typedef struct stratus_tetra_medium {
  vfloat color[3], depth; /* the mean colour, and the optical depth */
  vfloat tau;             /* the mean of the sums an entry, 0 where nothing shows */
  vfloat middle;          /* middle of the optical depth, as a fraction of the path, where the component's gradient counts */
  vmask opaque;           /* the path meets an entry of opacity 1, and `middle` is where */
} stratus_tetra_medium;

INLINE int component_has_gradient(CONSTANT stratus_tetra_arguments* a, int c) { return (a->light.on | a->thins) >> c & 1; }

/* Lanes whose path from one entry of a component to another meets an entry of its rows behind the sums; *first is the first such entry of
 * each, as of opaque_on_the_way(). */
INLINE vmask component_meets(
  CONSTANT stratus_tetra_arguments* a, GLOBAL const int* all, int c, vint low, vint high, vmask mask, vint* first)
{
  const int entries = (int)a->media.last[c] + 1;
  const vmask rises = vi_ge(high, low);
  *first = v_gather_ints(all + a->media.sums_at[c] + 8 * entries, low + vi_select(rises, vi_set(0), vi_set(entries)), mask);
  return mask & ((rises & vi_ge(high, *first)) | m_andnot(vi_ge(*first, high), rises));
}

/* Compute component c's contribution on a path of `length` between two places of its table, without its gradient. */
INLINE void component_mean(CONSTANT stratus_tetra_arguments* a, GLOBAL const int* all, int c, vfloat from, vfloat to, vfloat length,
  vmask mask, stratus_tetra_medium* medium)
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
  medium->middle = v_set(0.5f);
  if (component_has_gradient(a, c)) {
    medium->middle = tetra_middle_of(sums, entries, low, high, v_from_int(up_to[3] - before[3]), mask);
  }
  if (m_any(level)) {
    gather_four_ints(sums, high + vi_set(entries), level, up_to);
    for (int i = 0; i < 4; ++i) {
      mean[i] = v_select(level, v_from_int(up_to[i]), mean[i]);
    }
  }
  medium->opaque = m_none();
  medium->depth = v_min(mean[3] * v_set(a->media.depth_scale[c]) * length, v_set(1e18f));
  if (a->media.has_opaque[c]) {
    vint first;
    const vmask met = component_meets(a, all, c, low, high, mask, &first);
    if (m_any(met)) {
      gather_four_ints(sums, vi_select(met, first, high) + vi_set(entries), met, up_to);
      for (int i = 0; i < 4; ++i) {
        mean[i] = v_select(met, v_from_int(up_to[i]), mean[i]);
      }
      medium->opaque = met & v_lt(v_set(0.0f), length);
      medium->depth = v_select(medium->opaque, v_set(OPAQUE_DEPTH), medium->depth);
      if (component_has_gradient(a, c)) {
        medium->middle = v_select(medium->opaque, v_clamp(v_abs(v_from_int(first - low)) * steps, 0.0f, 1.0f), medium->middle);
      }
    }
  }
  medium->tau = mean[3];
  const vfloat per_tau = v_reciprocal(v_max(mean[3], one));
  for (int i = 0; i < 3; ++i) {
    medium->color[i] = mean[i] * per_tau;
  }
}

/* Lights and thins what component c makes of the part at..at+part of a stretch. */
INLINE void light_component(CONSTANT stratus_tetra_arguments* a, const stratus_tetra_mixture* m, int c, vfloat at, vfloat part, vmask mask,
  stratus_tetra_medium* medium)
{
  const vfloat zero = v_set(0.0f), one = v_set(1.0f);
  vfloat way = v_min(medium->tau * v_set(a->media.way_scale[c]), v_set(1e20f));
  stratus_tetra_lit lit;
  way = v_select(medium->opaque, v_set(TETRA_WALL_WAY), way);
  tetra_light_at(a, m->factors, c, m->gradients + c, v_fma(medium->middle, part, at), way, mask, &lit);
  for (int i = 0; i < 3; ++i) {
    medium->color[i] = v_fma(medium->color[i], lit.diffuse[i], lit.specular[i]);
  }
  if (a->thins >> c & 1) {
    const vfloat thinned = medium->depth * lit.factor;
    vfloat opaque = v_select(v_lt(zero, lit.factor), medium->depth, zero);
    if (a->factor_way > 0.0f) { /* optical depth of an opaque path over the rest of the piece */
      const vfloat rest = (one - medium->middle) * part * m->length * v_set(TETRA_WALL_WAY * a->media.weight[c] / a->factor_way);
      opaque = v_select(v_lt(lit.factor, v_set(TETRA_WALL)), v_min(lit.factor * rest, v_set(OPAQUE_DEPTH)), medium->depth);
    }
    medium->depth = v_select(medium->opaque, opaque, thinned);
  }
}

/* Mix all components over the part at..at+part of a stretch, between the places `from` and `to` of their tables: glow, the light that it
 * emits if nothing hides it, and its optical depth. own: the optical depths of components, without gradient opacity. */
INLINE void mix_components(CONSTANT stratus_tetra_arguments* a, const stratus_tetra_mixture* m, const vfloat from[TETRA_COMPONENTS],
  const vfloat to[TETRA_COMPONENTS], vfloat at, vfloat part, vmask mask, vfloat glow[3], vfloat* depth, vfloat own[TETRA_COMPONENTS])
{
  const vfloat zero = v_set(0.0f), length = m->length * part;
  const int last = a->media.components - 1;
  vfloat squares = zero;
  *depth = glow[0] = glow[1] = glow[2] = zero;
  for (int c = a->media.dependent ? last : 0; c <= last; ++c) {
    stratus_tetra_medium medium;
    component_mean(a, m->sums, c, from[c], to[c], length, mask, &medium);
    own[c] = medium.depth;
    if (a->media.dependent && last == 1) {
      stratus_tetra_medium colors;
      component_mean(a, m->sums, 0, from[0], to[0], length, mask, &colors);
      for (int i = 0; i < 3; ++i) {
        medium.color[i] = colors.color[i];
      }
    } else if (a->media.dependent) {
      for (int i = 0; i < 3; ++i) {
        medium.color[i] = v_set(0.5f) * (from[i] + to[i]);
      }
    }
    if (m->gradients && component_has_gradient(a, c)) {
      light_component(a, m, c, at, part, mask, &medium);
    }
    *depth = *depth + medium.depth;
    squares = v_fma(medium.depth, medium.depth, squares);
    for (int i = 0; i < 3; ++i) {
      glow[i] = v_fma(medium.depth, medium.color[i], glow[i]);
    }
  }
  if (a->media.mean) {
    *depth = squares * v_reciprocal(v_max(*depth, v_set(1e-30f)));
  }
}

/* If a product or a share of components is mixed from their means, the error falls with the square of the number of pieces: by three
 * quarters from a whole stretch, `glow` and `depth`, to two halves. Returns that square, if the halves' difference requires it. */
INLINE vfloat mixing_pieces(
  CONSTANT stratus_tetra_arguments* a, const stratus_tetra_mixture* m, vmask mask, const vfloat glow[3], vfloat depth)
{
  const vfloat centre = v_set(0.5f);
  vfloat middle[TETRA_COMPONENTS], own[TETRA_COMPONENTS], first[3], second[3], depths[2], change;
  for (int c = 0; c < TETRA_COMPONENTS; ++c) {
    middle[c] = centre * (m->values->from[c] + m->values->to[c]);
  }
  mix_components(a, m, m->values->from, middle, v_set(0.0f), centre, mask, first, depths, own);
  mix_components(a, m, middle, m->values->to, centre, centre, mask, second, depths + 1, own);
  change = v_abs(depth - (depths[0] + depths[1]));
  for (int i = 0; i < 3; ++i) {
    change = v_max(change, v_abs(glow[i] - (first[i] + second[i])));
  }
  return v_set(16.0f * a->pieces) * change * v_reciprocal(v_max(v_min(depth, v_set(1.0f)), v_set(1e-20f)));
}

/* Into how many pieces light and gradient opacity cut the stretch, squared. */
INLINE vfloat lit_pieces(
  CONSTANT stratus_tetra_arguments* a, const stratus_tetra_mixture* m, vmask mask, const vfloat own[TETRA_COMPONENTS])
{
  vfloat q = v_set(0.0f);
  for (int c = a->media.dependent ? a->media.components - 1 : 0; c < a->media.components; ++c) {
    if (component_has_gradient(a, c)) {
      q = q + tetra_light_pieces(a, m->factors, c, m->gradients + c, own[c], mask);
      q = a->media.has_opaque[c] && (a->thins >> c & 1) ? v_max(q, v_set(TETRA_PIECES_OPAQUE)) : q;
    }
  }
  return q;
}

/* Returns the lanes whose stretch shows anything; *pieces: into how many pieces it is cut. */
INLINE vmask tetra_media_pieces(CONSTANT stratus_tetra_arguments* a, const stratus_tetra_mixture* m, vmask mask, vfloat* pieces)
{
  const vfloat one = v_set(1.0f), zero = v_set(0.0f);
  vfloat glow[3], depth, own[TETRA_COMPONENTS], all = zero;
  mix_components(a, m, m->values->from, m->values->to, zero, one, mask, glow, &depth, own);
  for (int c = a->media.dependent ? a->media.components - 1 : 0; c < a->media.components; ++c) {
    all = all + own[c];
  }
  mask = mask & v_lt(zero, all);
  if (!m_any(mask)) {
    *pieces = one;
    return mask;
  }
  vfloat q = depth * v_set(a->pieces); /* a colour changes by 1 at most */
  if (a->media.dependent || a->media.mean) {
    q = v_max(q, mixing_pieces(a, m, mask, glow, depth));
  }
  if (a->light.on || a->thins) {
    q = v_max(q, lit_pieces(a, m, mask, own));
  }
  *pieces = tetra_pieces_of(q);
  return mask;
}

/* Composites a stretch. */
OUTLINE void tetra_media(
  CONSTANT stratus_tetra_arguments* a, const stratus_tetra_mixture* m, stratus_tetra_light* light, vmask mask, vfloat near)
{
  const vfloat one = v_set(1.0f), zero = v_set(0.0f);
  const stratus_tetra_values* values = m->values;
  vfloat glow[3], depth, from[TETRA_COMPONENTS], to[TETRA_COMPONENTS], own[TETRA_COMPONENTS], pieces, piece = zero, at = zero;
  mask = tetra_media_pieces(a, m, mask, &pieces);
  if (!m_any(mask)) {
    return;
  }
  const vfloat share = v_reciprocal(pieces);
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
    mix_components(a, m, from, to, at, next - at, mask, glow, &depth, own);
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
