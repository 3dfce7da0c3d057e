/* SPDX-License-Identifier: BSD-3-Clause
 * Rays that march from cell to cell through faces. A ray holds the three points of the face by which it entered, in its own coordinates
 * (tetra_arguments.h), and knows the fourth point of the cell: with it the face by which it leaves, and by that the next cell and its
 * fourth point.
 *
 * Whether a ray passes a face depends on the signs of its edges alone, found exactly and the same from either side; zero counts as if all
 * points were moved by (e, e^2), e vanishing. So a ray passes none or two faces of each cell, whatever its shape, and a way through cells
 * that begins at a border face ends at another. */
#ifndef STRATUS_TETRA_MARCH_H
#define STRATUS_TETRA_MARCH_H

#include "tetra_shade.h"

/* What all rays read. */
typedef struct stratus_tetra_scene {
  GLOBAL const int* cells; /* eight ints a cell: for each of its points, lowest name first, the next cell opposite and its fourth point */
  GLOBAL const float* points;      /* x, y, z, value each */
  GLOBAL const int* sums;          /* stratus_tetra_sums(): up to each entry's middle, then each entry's own, then opaque ones */
  GLOBAL const float* cell_values; /* if the arguments say so */
} stratus_tetra_scene;

typedef struct stratus_tetra_ray {
  vfloat us, uw, vs, vw;         /* x = (a - uw) - us z, y = (b - vw) - vs z */
  vfloat begin, end;             /* what is seen of it, in z */
  vfloat length, offset;         /* world distance = offset + length z */
  vfloat x[3], y[3], z[3], s[3]; /* the face's points, and their values; turning from the first to the second and third is positive */
  vfloat edge[3];                /* opposite each: twice the area that the others and the ray span, >= 0 */
  vint name[3], fourth;
  vint cell;                 /* where its ints begin; negative: outside */
  vfloat at, value;          /* where the ray entered the cell, and the field there */
  stratus_tetra_place place; /* of the value in the table */
} stratus_tetra_ray;

/* A cell that was passed: where the ray leaves it, and the field there. */
typedef struct stratus_tetra_passage {
  vfloat to, last;
  vmask seen; /* lanes that found a face to leave by */
  vfloat from, first;
} stratus_tetra_passage;

/* px qy - py qx with a sign that is exact (Kahan's way: both products' roundings are known). */
INLINE vfloat tetra_edge(vfloat px, vfloat py, vfloat qx, vfloat qy)
{
  const vfloat product = py * qx, rounding = v_fma(py, qx, -product);
  return v_fma(px, qy, -product) - rounding;
}

/* Of edges that are zero: whether they count as negative. */
INLINE vmask tetra_tie(vmask zero, vfloat px, vfloat py, vfloat qx, vfloat qy)
{
  const vmask below = v_lt(py, qy), level = m_andnot(v_le(py, qy), below);
  return zero & (below | (level & v_lt(qx, px)));
}

INLINE vmask tetra_negative(vfloat edge, vfloat px, vfloat py, vfloat qx, vfloat qy)
{
  const vfloat zero = v_set(0.0f);
  vmask negative = v_lt(edge, zero);
  const vmask tie = m_andnot(v_le(edge, zero), negative);
  if (m_any(tie)) {
    negative = negative | tetra_tie(tie, px, py, qx, qy);
  }
  return negative;
}

/* Where the ray passes the face, and the field there: weights are the edges, with a hair of each so that a face seen edge-on has a
 * middle. */
INLINE void tetra_cross(const vfloat edge[3], const vfloat z[3], const vfloat s[3], vfloat* at, vfloat* value)
{
  const vfloat zero = v_set(0.0f), hair = v_set(1e-30f);
  const vfloat p = v_max(edge[0], zero) + hair, q = v_max(edge[1], zero) + hair, r = v_max(edge[2], zero) + hair;
  const vfloat share = v_reciprocal(p + (q + r));
  *at = v_fma(p, z[0], v_fma(q, z[1], r * z[2])) * share;
  *value = v_fma(p, s[0], v_fma(q, s[1], r * s[2])) * share;
}

/* Replaces one of the face's points by the fourth: `mask[i]` lanes drop point i. d: x, y, z, value; e: edges from d to each point. */
INLINE void tetra_turn(stratus_tetra_ray* r, const vmask mask[3], const vfloat d[4], const vfloat e[3])
{
  const vfloat m0 = -e[0], m1 = -e[1], m2 = -e[2];
  const vfloat edge0 = v_select(mask[2], m1, v_select(mask[1], e[2], r->edge[0]));
  const vfloat edge1 = v_select(mask[2], e[0], v_select(mask[0], m2, r->edge[1]));
  const vfloat edge2 = v_select(mask[0], e[1], v_select(mask[1], m0, r->edge[2]));
  r->edge[0] = edge0;
  r->edge[1] = edge1;
  r->edge[2] = edge2;
  for (int i = 0; i < 3; ++i) {
    r->x[i] = v_select(mask[i], d[0], r->x[i]);
    r->y[i] = v_select(mask[i], d[1], r->y[i]);
    r->z[i] = v_select(mask[i], d[2], r->z[i]);
    r->s[i] = v_select(mask[i], d[3], r->s[i]);
    r->name[i] = vi_select(mask[i], r->fourth, r->name[i]);
  }
}

/* Through one cell, to its next face. */
INLINE stratus_tetra_passage tetra_pass(
  CONSTANT stratus_tetra_arguments* a, const stratus_tetra_scene* scene, stratus_tetra_ray* r, vmask live)
{
  const vfloat zero = v_set(0.0f);
  vfloat d[4], e[3];
  gather_four_floats(scene->points, r->fourth, live, d);
  d[0] = v_fma(-r->us, d[2], d[0] - r->uw);
  d[1] = v_fma(-r->vs, d[2], d[1] - r->vw);
  vmask negative[3], tie[3];
  for (int i = 0; i < 3; ++i) {
    e[i] = tetra_edge(d[0], d[1], r->x[i], r->y[i]);
    negative[i] = v_lt(e[i], zero);
    tie[i] = live & m_andnot(v_le(e[i], zero), negative[i]);
  }
  if (m_any(tie[0] | tie[1] | tie[2])) {
    for (int i = 0; i < 3; ++i) {
      negative[i] = negative[i] | tetra_tie(tie[i], d[0], d[1], r->x[i], r->y[i]);
    }
  }
  vmask drop[3];
  drop[2] = live & m_andnot(negative[1], negative[0]);
  drop[0] = live & m_andnot(negative[2], negative[1]);
  drop[1] = live & m_andnot(negative[0], negative[2]);
  stratus_tetra_passage passage;
  passage.seen = drop[0] | drop[1] | drop[2];
  const vint dropped = vi_select(drop[0], r->name[0], vi_select(drop[1], r->name[1], r->name[2]));
  const vint two = vi_set(2), none = vi_set(0);
  vint at = r->cell + vi_select(vi_lt(r->fourth, dropped), two, none), next[2];
  for (int i = 0; i < 3; ++i) {
    at = at + vi_select(vi_lt(r->name[i], dropped), two, none);
  }
  gather_pair(scene->cells, at, live, next);
  passage.from = r->at;
  passage.first = r->value;
  if (a->cell_values) {
    passage.first = gather_float(scene->cell_values, r->cell >> vi_set(3), live);
  }
  tetra_turn(r, drop, d, e);
  tetra_cross(r->edge, r->z, r->s, &passage.to, &passage.last);
  if (a->cell_values) {
    passage.last = passage.first;
  }
  r->at = passage.to;
  r->value = passage.last;
  r->fourth = next[1];
  r->cell = vi_select(passage.seen, next[0], vi_select(live, vi_set(-2), r->cell));
  prefetch_ints(scene->cells, r->cell);
  return passage;
}

/* The largest value so far, and where it is. */
INLINE void tetra_maximum(stratus_tetra_light* light, vmask mask, vfloat first, vfloat last, vfloat near, vfloat far)
{
  const vfloat larger = v_max(first, last);
  const vmask more = mask & v_lt(light->most, larger);
  light->most = v_select(more, larger, light->most);
  light->depth = v_select(more, v_select(v_lt(first, last), far, near), light->depth);
}

/* Light of a cell that was passed, cut to what is seen. Returns the lanes that are done with their way: outside, hidden by what lies in
 * front, or beyond what is seen. */
INLINE vmask tetra_shade(CONSTANT stratus_tetra_arguments* a, const stratus_tetra_scene* scene, stratus_tetra_ray* r,
  stratus_tetra_light* light, const stratus_tetra_passage* passage, vmask live)
{
  const vfloat begin = v_max(passage->from, r->begin), end = v_min(passage->to, r->end);
  const vmask mask = passage->seen & v_lt(begin, end), cut = mask & (v_lt(passage->from, begin) | v_lt(end, passage->to));
  vfloat first = passage->first, last = passage->last;
  if (m_any(cut)) {
    const vfloat slope = (last - first) * v_reciprocal(v_max(passage->to - passage->from, v_set(1e-30f))), start = first;
    first = v_select(cut, v_fma(slope, begin - passage->from, start), first);
    last = v_select(cut, v_fma(slope, end - passage->from, start), last);
  }
  const vfloat near = v_fma(begin, r->length, r->offset);
  if (a->maximum) {
    tetra_maximum(light, mask, first, last, near, v_fma(end, r->length, r->offset));
  } else {
    stratus_tetra_place from = r->place, to;
    r->place = to = tetra_place(a, scene->sums, passage->last, passage->seen);
    if (a->cell_values) {
      from = to;
    }
    if (m_any(cut)) {
      const stratus_tetra_place cut_from = tetra_place(a, scene->sums, first, cut), cut_to = tetra_place(a, scene->sums, last, cut);
      from = tetra_place_select(cut, &cut_from, &from);
      to = tetra_place_select(cut, &cut_to, &to);
    }
    tetra_integrate(a, scene->sums, light, mask, first, last, &from, &to, (end - begin) * r->length, near);
  }
  return live & (vi_lt(r->cell, vi_set(0)) | v_lt(light->transparency, v_set(a->termination)) | v_le(r->end, passage->to));
}

/* A ray comes in by a face whose points it has: what it finds there. */
INLINE void tetra_enter(CONSTANT stratus_tetra_arguments* a, const stratus_tetra_scene* scene, stratus_tetra_ray* r, vmask mask)
{
  vfloat at, value, edge[3];
  for (int i = 0; i < 3; ++i) {
    const int p = (i + 1) % 3, q = (i + 2) % 3;
    edge[i] = tetra_edge(r->x[p], r->y[p], r->x[q], r->y[q]);
    r->edge[i] = v_select(mask, edge[i], r->edge[i]);
  }
  tetra_cross(r->edge, r->z, r->s, &at, &value);
  r->at = v_select(mask, at, r->at);
  r->value = v_select(mask, value, r->value);
  if (!a->maximum) {
    const stratus_tetra_place place = tetra_place(a, scene->sums, value, mask);
    r->place = tetra_place_select(mask, &place, &r->place);
  }
}

#endif
