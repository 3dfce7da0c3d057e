/* SPDX-License-Identifier: BSD-3-Clause
 * Stretches that are lit, and whose opacity is multiplied, by the field's gradient: of each of several components, or of one. This is the
 * variant TETRA_LIT. Between the two faces of a cell the gradient is interpolated as the field is. A stretch is cut into pieces, each of
 * which is lit at the middle of its optical depth. */
#ifndef STRATUS_TETRA_LIGHT_H
#define STRATUS_TETRA_LIGHT_H

#include "light.h"
#include "tetra_pixel.h"
#include "tetra_shade.h"

/* The fewest pieces, squared, of a stretch on which gradient opacity multiplies the opacity of a length: a piece's transparency is then not
 * a linear function of its optical depth. */
#define TETRA_PIECES_THINNED 256.0f
/* The same of one that meets entries of opacity 1, which thin to none where the gradient opacity is 0. */
#define TETRA_PIECES_OPAQUE 16.0f
/* The optical depth of opacity 1 over factor_way, and the least gradient opacity that leaves it opaque. */
#define TETRA_WALL_WAY 80.0f
#define TETRA_WALL 0.98f
#define TETRA_MOMENTS 10 /* ints for each entry before the moments' ints, see stratus_tetra_sums() */

typedef struct stratus_tetra_stretch {
  vfloat us, uw, vs, vw;       /* of its ray */
  vfloat begin, rise;          /* z at its start, and from there to its end */
  vfloat gradient[3], turn[3]; /* at its start, and from there to its end */
  vfloat length;               /* in the world */
  vfloat tau_scale;            /* the optical depth of a unit of the sums over a unit of length */
  vfloat factor_scale;         /* from gradients to steps of the gradient opacity */
  GLOBAL const int* lights;    /* the scene's */
} stratus_tetra_stretch;

INLINE void stretch_gradient(const stratus_tetra_stretch* s, vfloat part, vfloat g[3])
{
  for (int axis = 0; axis < 3; ++axis) {
    g[axis] = v_fma(part, s->turn[axis], s->gradient[axis]);
  }
}

/* Component c's gradient opacity of a gradient. scale: the stretch's factor_scale. */
INLINE vfloat tetra_factor(
  CONSTANT stratus_tetra_arguments* a, GLOBAL const float* factors, int c, vfloat scale, const vfloat g[3], vmask mask)
{
  const vint first = vi_set(c * ((int)a->factor_last + 2));
  return factor_of_gradient((GLOBAL const int*)factors, first, scale, a->factor_last, g, mask);
}

/* Component c's light and gradient opacity at a part of the stretch. way: the optical depth over factor_way there, read only where that is
 * not 0. */
OUTLINE void tetra_light_at(CONSTANT stratus_tetra_arguments* a, GLOBAL const float* factors, int c, const stratus_tetra_stretch* s,
  vfloat part, vfloat way, vmask mask, stratus_tetra_lit* lit)
{
  const vfloat z = v_fma(part, s->rise, s->begin), one = v_set(1.0f);
  const vfloat x[3] = { v_fma(s->us, z, s->uw), v_fma(s->vs, z, s->vw), z }, d[3] = { s->us, s->vs, one };
  vfloat g[3];
  stretch_gradient(s, part, g);
  lit->factor = one;
  for (int i = 0; i < 3; ++i) {
    lit->diffuse[i] = one;
    lit->specular[i] = v_set(0.0f);
  }
  if (a->thins >> c & 1) {
    lit->factor = tetra_factor(a, factors, c, s->factor_scale, g, mask);
    if (a->factor_way > 0.0f) {
      lit->factor = factor_of_way(lit->factor, way);
    }
  }
  if (a->light.on >> c & 1) {
    light_at(&a->light, s->lights, 0, c, x, d, g, lit->diffuse, lit->specular, 0);
  }
}

/* How much component c's light changes over the stretch, for the number of its pieces. depth: its optical depth. If light changes evenly,
 * the light at the middle of the optical depth is exact, except for the part of the depth that hides itself; if light bends, it is not. */
OUTLINE vfloat tetra_light_pieces(
  CONSTANT stratus_tetra_arguments* a, GLOBAL const float* factors, int c, const stratus_tetra_stretch* s, vfloat depth, vmask mask)
{
  const vfloat one = v_set(1.0f), zero = v_set(0.0f), most = v_min(depth, one);
  vfloat q = zero, g[3][3];
  for (int i = 0; i < 3; ++i) {
    stretch_gradient(s, v_set(0.5f * (float)i), g[i]);
  }
  if (a->light.on >> c & 1) {
    vfloat normal[2][3];
    for (int end = 0; end < 2; ++end) {
      (void)v_scale3(g[2 * end]);
      v_transform3(a->light.normal, g[2 * end], normal[end]);
      v_normalize3(normal[end], 0.0f);
      stretch_gradient(s, v_set((float)end), g[2 * end]);
    }
    const vfloat along = v_dot3(normal[0], normal[1]);
    const vfloat square = v_max(v_set(2.0f) * (one - (a->light.two_sided ? v_abs(along) : along)), zero);
    const vfloat angle = v_root(v_max(square, v_set(1e-20f)));
    q = v_fma(depth * angle, v_set(a->bend[0]), most * square * v_set(0.5f * a->bend[1]));
  }
  for (int i = 0; (a->light.on >> c & 1) && i < a->light.count; ++i) {
    if (a->light.map_at[i] >= 0) { /* the light that passes to the stretch changes along it */
      vfloat p[3];
      for (int at = 0; at < 3; ++at) {
        const vfloat z = v_fma(v_set(0.5f * (float)at), s->rise, s->begin);
        const vfloat x[3] = { v_fma(s->us, z, s->uw), v_fma(s->vs, z, s->vw), z };
        p[at] = light_map_passing(&a->light, s->lights, i, x);
      }
      const vfloat bend = v_abs(v_fma(v_set(-0.5f), p[0] + p[2], p[1]));
      q = q + v_fma(depth, v_abs(p[2] - p[0]), v_set(8.0f) * most * bend);
    }
  }
  if (a->thins >> c & 1) {
    vfloat f[3];
    for (int i = 0; i < 3; ++i) {
      f[i] = tetra_factor(a, factors, c, s->factor_scale, g[i], mask);
    }
    const vfloat bend = v_abs(v_fma(v_set(-0.5f), f[0] + f[2], f[1]));
    q = q + v_fma(depth, v_abs(f[2] - f[0]), v_set(8.0f) * most * bend);
  }
  q = q * v_set(a->pieces);
  if ((a->thins >> c & 1) && a->factor_way > 0.0f) {
    q = v_select(v_lt(one, most * v_set(a->pieces)), v_max(q, v_set(TETRA_PIECES_THINNED)), q);
  }
  return q;
}

/* The middle of the optical depth between two entries of a table of `entries` entries, as a fraction of the distance between them. tau: the
 * rise of the sums of optical depth. */
INLINE vfloat tetra_middle_of(GLOBAL const int* sums, int entries, vint low, vint high, vfloat tau, vmask mask)
{
  GLOBAL const int* moments = sums + TETRA_MOMENTS * entries;
  const vfloat centre = v_set(0.5f), rise = v_from_int(high - low);
  const vmask any = mask & v_lt(centre, v_abs(tau)) & v_lt(centre, v_abs(rise));
  vint before[2], up_to[2];
  if (!m_any(any)) {
    return centre;
  }
  gather_pair(moments, low << vi_set(1), any, before);
  gather_pair(moments, high << vi_set(1), any, up_to);
  const vfloat moment = v_fma(v_from_int(up_to[0] - before[0]), v_set(65536.0f), v_from_int(up_to[1] - before[1]));
  /* tau and rise have the same sign */
  const vfloat size = v_reciprocal(v_select(any, tau * rise, v_set(1.0f)));
  const vfloat middle = v_fma(v_set(0.0f) - v_from_int(low), tau, moment) * size;
  return v_select(any, v_clamp(middle, 0.0f, 1.0f), centre);
}

/* A piece of a stretch: the values' places, and the part of the stretch where it begins and how much of it it is. */
typedef struct stratus_tetra_piece {
  stratus_tetra_place from, to;
  vfloat at, part;
} stratus_tetra_piece;

/* The mean optical depth over factor_way of a piece between two entries. tau: the rise of the sums of optical depth. */
INLINE vfloat tetra_way(
  CONSTANT stratus_tetra_arguments* a, GLOBAL const int* sums, const stratus_tetra_stretch* s, vint from, vint to, vfloat tau, vmask mask)
{
  const vint rise = to - from;
  const vmask level = mask & vi_zero(rise);
  vfloat mean = v_abs(tau) * v_reciprocal(v_max(v_abs(v_from_int(rise)), v_set(1.0f)));
  if (m_any(level)) {
    vint own[4];
    gather_four_ints(sums, to + vi_set((int)a->table.last + 1), level, own);
    mean = v_select(level, v_from_int(own[3]), mean);
  }
  return v_min(mean * s->tau_scale * v_set(a->factor_way), v_set(1e20f));
}

/* The optical depth of a wall, which opacity 1 thinned over factor_way leaves of a length behind it in the world. */
INLINE vfloat tetra_wall_depth(CONSTANT stratus_tetra_arguments* a, const stratus_tetra_lit* lit, vfloat rest)
{
  return v_max(lit->factor * v_set(TETRA_WALL_WAY) * rest * v_set(1.0f / a->factor_way), v_set(0.0f));
}

/* Composites what opacity 1 hides. */
INLINE void tetra_light_end(CONSTANT stratus_tetra_arguments* a, GLOBAL const int* sums, GLOBAL const float* factors,
  const stratus_tetra_stretch* s, const stratus_tetra_piece* p, stratus_tetra_light* light, vmask mask, vint entry, vfloat near)
{
  const vfloat zero = v_set(0.0f), one = v_set(1.0f);
  const vfloat steps = v_abs(v_from_int(entry - p->from.entry)), whole = v_abs(v_from_int(p->to.entry - p->from.entry));
  const vfloat part = v_clamp(steps * v_reciprocal(v_max(whole, one)), 0.0f, 1.0f);
  stratus_tetra_lit lit;
  tetra_light_at(a, factors, 0, s, v_fma(part, p->part, p->at), v_set(TETRA_WALL_WAY), mask, &lit);
  vfloat alpha = one;
  if (a->thins && a->factor_way > 0.0f) { /* what an opaque way has become over the rest of the piece */
    const vfloat rest = v_select(v_lt(zero, whole), one - part, one) * p->part * s->length;
    alpha = v_select(v_lt(lit.factor, v_set(TETRA_WALL)), v_absorbed(tetra_wall_depth(a, &lit, rest)), one);
  } else if (a->thins) {
    alpha = v_select(v_lt(zero, lit.factor), one, zero);
  }
  tetra_end(a, sums, light, mask & v_lt(zero, alpha), entry, alpha, near, &lit);
}

INLINE void tetra_light_piece(CONSTANT stratus_tetra_arguments* a, GLOBAL const int* sums, GLOBAL const float* factors,
  const stratus_tetra_stretch* s, const stratus_tetra_piece* p, stratus_tetra_light* light, vmask mask, vfloat near)
{
  stratus_tetra_place end = p->to;
  vint entry = p->to.entry;
  vmask opaque = m_none();
  vfloat part = p->part;
  if (a->table.has_opaque) {
    vmask before;
    vfloat share = v_set(1.0f);
    opaque = tetra_before_opaque(a, sums, mask & v_lt(v_set(0.0f), s->length), &p->from, &p->to, &entry, &end, &share, &before);
    if (m_any(opaque)) {
      part = part * share;
      mask = m_andnot(mask, opaque) | before;
    }
  }
  if (m_any(mask)) {
    const vfloat weight = v_min(part * s->length * s->tau_scale, v_set(OPAQUE_WEIGHT));
    const vfloat tau = v_from_int(end.sum[3] - p->from.sum[3]);
    const vfloat middle = tetra_middle_of(sums, (int)a->table.last + 1, p->from.entry, end.entry, tau, mask);
    const vfloat at = v_fma(middle, part, p->at);
    vfloat way = v_set(0.0f);
    stratus_tetra_lit lit;
    if (a->factor_way > 0.0f) {
      way = tetra_way(a, sums, s, p->from.entry, end.entry, tau, mask);
    }
    tetra_light_at(a, factors, 0, s, at, way, mask, &lit);
    tetra_composite(a, sums, light, mask, &p->from, &end, weight, near, &lit);
  }
  if (m_any(opaque)) {
    tetra_light_end(a, sums, factors, s, p, light, opaque, entry, near);
  }
}

/* Returns into how many pieces a stretch between two places of the table is cut. */
INLINE vfloat tetra_stretch_pieces(CONSTANT stratus_tetra_arguments* a, GLOBAL const int* sums, GLOBAL const float* factors,
  const stratus_tetra_stretch* s, vmask mask, const stratus_tetra_place* from, const stratus_tetra_place* to)
{
  const vfloat weight = v_min(s->length * s->tau_scale, v_set(OPAQUE_WEIGHT));
  const vfloat entries = v_abs(v_from_int(to->entry - from->entry));
  const vfloat sum = v_abs(v_from_int(to->sum[3] - from->sum[3])) * weight;
  vfloat depth = sum * v_reciprocal(v_max(entries, v_set(1.0f)));
  const vmask level = mask & vi_zero(to->entry - from->entry);
  if (m_any(level)) {
    vint own[4];
    gather_four_ints(sums, to->entry + vi_set((int)a->table.last + 1), level, own);
    depth = v_select(level, v_from_int(own[3]) * weight, depth);
  }
  vfloat q = v_max(tetra_pieces(a, sum, entries), tetra_light_pieces(a, factors, 0, s, depth, mask));
  if (a->table.has_opaque && a->thins) {
    q = v_max(q, v_set(TETRA_PIECES_OPAQUE));
  }
  return tetra_pieces_of(q);
}

/* Composites a stretch from value `first` at place `from` to `last` at place `to`. */
INLINE void tetra_light_stretch(CONSTANT stratus_tetra_arguments* a, GLOBAL const int* sums, GLOBAL const float* factors,
  const stratus_tetra_stretch* s, stratus_tetra_light* light, vmask mask, vfloat first, vfloat last, const stratus_tetra_place* from,
  const stratus_tetra_place* to, vfloat near)
{
  const vfloat one = v_set(1.0f), pieces = tetra_stretch_pieces(a, sums, factors, s, mask, from, to), share = v_reciprocal(pieces);
  stratus_tetra_piece p;
  vfloat piece = v_set(0.0f);
  p.from = *from;
  p.at = v_set(0.0f);
  do {
    piece = piece + one;
    const vmask more = mask & v_lt(piece, pieces);
    const vfloat next = v_select(more, piece * share, one);
    p.to = *to; /* the last piece ends where the stretch does */
    p.part = next - p.at;
    if (m_any(more)) {
      const stratus_tetra_place middle = tetra_place(a, sums, v_fma(last - first, next, first), more);
      p.to = tetra_place_select(more, &middle, to);
    }
    tetra_light_piece(a, sums, factors, s, &p, light, mask, near);
    p.from = p.to;
    p.at = next;
    mask = more & v_lt(v_set(OPAQUE_TRANSPARENCY), light->transparency);
  } while (m_any(mask));
}

#endif
