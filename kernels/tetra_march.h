/* SPDX-License-Identifier: BSD-3-Clause
 * Rays that march from cell to cell through faces. A ray holds the three points of the face by which it entered, in its own coordinates
 * (tetra_arguments.h); the fourth point of the cell, the exclusive or of all four with these three, tells the face by which it leaves.
 *
 * Whether a ray passes a face depends on the signs of its edges alone, found exactly and the same from either side; zero counts as if all points
 * were moved by (e, e^2), e vanishing. So a ray passes none or two faces of each cell, whatever its shape, and a way through cells
 * that begins at a border face ends at another. */
#ifndef STRATUS_TETRA_MARCH_H
#define STRATUS_TETRA_MARCH_H

#include "gather.h"
#include "ray_segment.h"
#include "tetra_arguments.h"

typedef struct stratus_tetra_ray {
  vfloat us, uw, vs, vw;        /* x = (a - uw) - us z, y = (b - vw) - vs z */
  vfloat begin, end;            /* what is seen of it, in z */
  vfloat length, offset;        /* world distance = offset + length z */
  vfloat x[3], y[3], z[3], s[3]; /* the face's points, and their values; turning from the first to the second and third is positive */
  vfloat edge[3];               /* opposite each: twice the area that the others and the ray span, >= 0 */
  vint name[3];
  vint cell; /* where its ints begin; negative: outside */
  vfloat at, value; /* where the ray entered the cell, and the field there */
  vint steps;
} stratus_tetra_ray;

/* px qy - py qx with a sign that is exact (Kahan's way: both products' roundings are known). */
INLINE vfloat tetra_edge(vfloat px, vfloat py, vfloat qx, vfloat qy)
{
  const vfloat zero = v_set(0.0f), product = py * qx, rounding = v_fma(py, qx, zero - product);
  return v_fma(px, qy, zero - product) - rounding;
}

INLINE vmask tetra_negative(vfloat edge, vfloat px, vfloat py, vfloat qx, vfloat qy)
{
  const vfloat zero = v_set(0.0f);
  vmask negative = v_lt(edge, zero);
  const vmask tie = m_andnot(v_le(edge, zero), negative);
  if (m_any(tie)) {
    const vmask below = v_lt(py, qy), level = m_andnot(v_le(py, qy), below);
    negative = negative | (tie & (below | (level & v_lt(qx, px))));
  }
  return negative;
}

/* Where the ray passes the face, and the field there: weights are the edges, with a hair of each so that a face seen edge-on has a middle. */
INLINE void tetra_cross(const vfloat edge[3], const vfloat z[3], const vfloat s[3], vfloat* at, vfloat* value)
{
  const vfloat zero = v_set(0.0f), hair = v_set(1e-30f);
  const vfloat p = v_max(edge[0], zero) + hair, q = v_max(edge[1], zero) + hair, r = v_max(edge[2], zero) + hair;
  const vfloat share = v_reciprocal(p + (q + r));
  *at = v_fma(p, z[0], v_fma(q, z[1], r * z[2])) * share;
  *value = v_fma(p, s[0], v_fma(q, s[1], r * s[2])) * share;
}

/* Replaces one of the face's points by the fourth: `mask[i]` lanes drop point i. d: x, y, z, value; e: edges from d to each point. */
INLINE void tetra_turn(stratus_tetra_ray* r, const vmask mask[3], vint name, const vfloat d[4], const vfloat e[3])
{
  const vfloat zero = v_set(0.0f), m0 = zero - e[0], m1 = zero - e[1], m2 = zero - e[2];
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
    r->name[i] = vi_select(mask[i], name, r->name[i]);
  }
}

/* The largest value so far is kept in k->front, and where it is in k->depth. */
INLINE void tetra_maximum(stratus_packet* k, vmask mask, vfloat first, vfloat last, vfloat near, vfloat far)
{
  const vfloat larger = v_max(first, last);
  const vmask more = mask & v_lt(k->front, larger);
  k->front = v_select(more, larger, k->front);
  k->depth = v_select(more, v_select(v_lt(first, last), far, near), k->depth);
}

/* What lies between (from, first) and (to, last) of the line, cut to what is seen. */
INLINE void tetra_shade(CONSTANT stratus_tetra_arguments* a, GLOBAL const int* sums, const stratus_tetra_ray* r, stratus_packet* k, vmask mask,
  vfloat to, vfloat last)
{
  const vfloat begin = v_max(r->at, r->begin), end = v_min(to, r->end);
  vfloat first = r->value;
  mask = mask & v_lt(begin, end);
  const vmask cut = mask & (v_lt(r->at, begin) | v_lt(end, to));
  if (m_any(cut)) {
    const vfloat slope = (last - first) * v_reciprocal(v_max(to - r->at, v_set(1e-30f))), start = first;
    first = v_select(cut, v_fma(slope, begin - r->at, start), first);
    last = v_select(cut, v_fma(slope, end - r->at, start), last);
  }
  if (!m_any(mask)) {
    return;
  }
  const vfloat near = v_fma(begin, r->length, r->offset);
  if (a->maximum) {
    tetra_maximum(k, mask, first, last, near, v_fma(end, r->length, r->offset));
  } else {
    k->front = first;
    integrate_segment(&a->table, sums, k, mask, last, (end - begin) * r->length, near);
  }
}

/* Through one cell. Returns the lanes that are done with their way: outside, hidden by what lies in front, or beyond what is seen. */
INLINE vmask tetra_step(CONSTANT stratus_tetra_arguments* a, GLOBAL const int* cells, GLOBAL const float* points, GLOBAL const int* sums,
  stratus_tetra_ray* r, stratus_packet* k, vmask live)
{
  const vint one = vi_set(1), none = vi_set(0);
  const vint name =
    vi_select(live, r->name[0] ^ r->name[1] ^ r->name[2] ^ v_gather_ints(cells, r->cell + vi_set(4), live), none);
  vfloat d[4], e[3];
  gather_four(points, name, live, d);
  d[0] = v_fma(v_set(0.0f) - r->us, d[2], d[0] - r->uw);
  d[1] = v_fma(v_set(0.0f) - r->vs, d[2], d[1] - r->vw);
  vmask negative[3];
  for (int i = 0; i < 3; ++i) {
    e[i] = tetra_edge(d[0], d[1], r->x[i], r->y[i]);
    negative[i] = tetra_negative(e[i], d[0], d[1], r->x[i], r->y[i]);
  }
  vmask drop[3];
  drop[2] = live & m_andnot(negative[1], negative[0]);
  drop[0] = live & m_andnot(negative[2], negative[1]);
  drop[1] = live & m_andnot(negative[0], negative[2]);
  const vmask stuck = m_andnot(live, drop[0] | drop[1] | drop[2]);
  const vint dropped = vi_select(drop[0], r->name[0], vi_select(drop[1], r->name[1], r->name[2]));
  vint rank = vi_select(vi_lt(name, dropped), one, none);
  for (int i = 0; i < 3; ++i) {
    rank = rank + vi_select(vi_lt(r->name[i], dropped), one, none);
  }
  const vint next = v_gather_ints(cells, r->cell + rank, live);
  const vint within = a->cell_values ? v_gather_ints(cells, r->cell + vi_set(5), live) : none;
  tetra_turn(r, drop, name, d, e);
  vfloat to, last;
  tetra_cross(r->edge, r->z, r->s, &to, &last);
  if (a->cell_values) {
    r->value = last = v_from_bits(within);
  }
  tetra_shade(a, sums, r, k, m_andnot(live, stuck), to, last);
  r->at = to;
  r->value = last;
  r->cell = vi_select(live, vi_select(stuck, vi_set(-2), next), r->cell);
  r->steps = r->steps + one;
  return live & (vi_lt(r->cell, none) | v_lt(k->transparency, v_set(a->table.termination)) | v_le(r->end, to) |
                  vi_ge(r->steps, vi_set(a->steps_most)));
}

#endif
