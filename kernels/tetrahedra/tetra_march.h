/* SPDX-License-Identifier: BSD-3-Clause
 * Marches rays from cell to cell through their faces. A ray holds the three points of the face by which it entered a cell, in coordinates
 * of its own (tetra_arguments.h), and the name of the cell's fourth point. The fourth point decides by which face the ray leaves. That face
 * gives the next cell and its fourth point.
 *
 * Whether a ray passes a face depends only on the signs of its edges. Signs are exact, and the same seen from the cells on either side. An
 * edge of exactly zero gets the sign that it would have if all points were moved by (e, e^2) for a vanishing e. So a ray passes none or two
 * of the faces of a cell of any shape, and a path that begins at a border face ends at another. */
#ifndef STRATUS_TETRA_MARCH_H
#define STRATUS_TETRA_MARCH_H

#include "tetra_modes.h"

/* The mesh and the sums, which all rays read. */
typedef struct stratus_tetra_scene {
  /* eight ints a cell: for each of its points, lowest name first, the next cell behind the opposite face, and that cell's fourth point. Of
   * a lattice: a bit or a byte for each point, of the hexahedron whose first corner it is (tetra_arguments.h). */
  GLOBAL const int* cells;
  GLOBAL const float* points; /* x, y, z and value of each */
  GLOBAL const int* sums; /* stratus_tetra_sums(): running sums up to each entry's middle, then each entry's own, then the opaque entries */
  GLOBAL const float* cell_values; /* read only if the arguments' cell_values is set */
  GLOBAL const float*
    /* of points, four floats each, a set for each component; this and the next are read only by the variant TETRA_LIT */
    gradients;
  GLOBAL const float* factors;    /* the gradient opacities of components */
  GLOBAL const float* components; /* of points or cells, four floats each: places in the components' tables; or of cells their labels */
  GLOBAL const int* media;        /* sums of the components, or of labels behind their records */
  GLOBAL const float* colors;     /* extremes and slices: colours of the table's entries */
  GLOBAL const int* lights;       /* the maps of lights (light_map.h); read only by the variant TETRA_LIT */
} stratus_tetra_scene;

typedef struct stratus_tetra_ray {
  vfloat us, uw, vs, vw;         /* x = (a - uw) - us z, y = (b - vw) - vs z */
  vfloat begin, end;             /* the part of the ray that is seen, in z */
  vfloat length, offset;         /* world distance = offset + length z */
  vfloat x[3], y[3], z[3], s[3]; /* the face's points and their values; the turn from the first point to the second and third is positive */
  vfloat edge[3];                /* opposite each point: twice the area of the triangle of the other two and the ray, >= 0 */
  vint name[3], fourth;
  vint cell;                 /* as in stratus_tetra_face; negative: the ray is outside */
  vfloat at, value;          /* z where the ray entered the cell, and the field there */
  stratus_tetra_place place; /* place of that value in the table */
  vfloat slice[2];           /* z where the ray meets the slice, the nearer one first */
} stratus_tetra_ray;

/* The passage of one cell: where the ray leaves it, and the field there. */
typedef struct stratus_tetra_passage {
  vfloat to, last;
  vmask seen; /* lanes that found a face to leave by */
  vfloat from, first;
  vint name[3], fourth; /* of the face by which the ray entered, in the variant TETRA_LIT and of hits; of hits what they store last */
#if TETRA_LIT
  vfloat edge[3]; /* of that face */
  vint cell;      /* the one that was passed */
#endif
} stratus_tetra_passage;

/* px qy - py qx, with an exact sign: fma gives the rounding errors of both products (Kahan). */
INLINE vfloat tetra_edge(vfloat px, vfloat py, vfloat qx, vfloat qy)
{
  const vfloat product = py * qx, rounding = v_fma(py, qx, -product);
  return v_fma(px, qy, -product) - rounding;
}

/* Which of the edges that are zero count as negative. */
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

/* Where the ray passes the face (*at, in z), and the field there. The edges are the weights of the opposite points. A tiny number is added
 * to each, so that a face seen edge-on is passed at its middle. */
INLINE void tetra_cross(const vfloat edge[3], const vfloat z[3], const vfloat s[3], vfloat* at, vfloat* value)
{
  const vfloat zero = v_set(0.0f), hair = v_set(1e-30f);
  const vfloat p = v_max(edge[0], zero) + hair, q = v_max(edge[1], zero) + hair, r = v_max(edge[2], zero) + hair;
  const vfloat share = v_reciprocal(p + (q + r));
  *at = v_fma(p, z[0], v_fma(q, z[1], r * z[2])) * share;
  *value = v_fma(p, s[0], v_fma(q, s[1], r * s[2])) * share;
}

/* Replaces one of the face's points by the fourth point: lanes of `mask[i]` drop point i. d: the fourth point's x, y, z and value; e:
 * edges from it to each point. */
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

/* The number of a tetrahedron's bit, TETRA_TURN() of its steps. */
INLINE vint tetra_turn_bit(vint d0, vint d1, vint d2)
{
  const vint zero = vi_set(0);
  return vi_select(vi_lt(d0, d1), vi_set(1), zero) + vi_select(vi_lt(d0, d2), vi_set(2), zero) + vi_select(vi_lt(d1, d2), vi_set(4), zero);
}

/* The next cell of a lattice, next[0], and its fourth point, next[1]. A path ends where tetrahedra that turn left meet others: there both
 * are on the same side of their face, which is a border face of each. The points of a tetrahedron, in rising order, go from a hexahedron's
 * first corner to its last along three edges. In the tetrahedron behind a face two of these edges have changed places, or the first has
 * become the last, or the last the first. Order the points in a ring: the next cell's fourth point is previous + following - dropped. The
 * lowest point of the next cell names its hexahedron. */
INLINE void tetra_lattice_next(
  CONSTANT stratus_tetra_arguments* a, const stratus_tetra_scene* scene, const stratus_tetra_ray* r, vint dropped, vmask live, vint next[2])
{
  const vint low = vi_min(r->name[0], r->name[1]), high = vi_max(r->name[0], r->name[1]);
  const vint other_low = vi_min(r->name[2], r->fourth), other_high = vi_max(r->name[2], r->fourth);
  const vint middle = vi_max(low, other_low), other_middle = vi_min(high, other_high);
  const vint first = vi_min(low, other_low), last = vi_max(high, other_high);
  const vint second = vi_min(middle, other_middle), third = vi_max(middle, other_middle);
  const vmask is_first = vi_lt(dropped, second), is_last = vi_lt(third, dropped);
  const vint opposite = vi_select(is_first, third, vi_select(vi_lt(dropped, third), last, vi_select(is_last, second, first)));
  const vint fourth = (first - dropped) + (second - dropped) + (third - opposite) + last;
  const vint cell = vi_select(is_first, second, vi_select(is_last, fourth, first));
  const vmask inside = live & vi_ge(cell, vi_set(0));
  next[1] = fourth;
  if (a->lattice == TETRA_LATTICE) {
    const vint at = cell >> vi_set(5), bits = v_gather_ints(scene->cells, at, inside) >> (cell - (at << vi_set(5)));
    const vmask shown = m_andnot(inside, vi_zero(bits & vi_set(1)));
    next[0] = vi_select(shown, cell << vi_set(3), vi_set(-1));
  } else {
    const vint d0 = second - first, d1 = third - second, d2 = last - third; /* the tetrahedron's steps, and the next tetrahedron's */
    const vmask is_low = vi_lt(dropped, third);
    const vint n0 = vi_select(is_last, d2, vi_select(is_low, d1, d0));
    const vint n1 = vi_select(is_first, d2, vi_select(is_last, d0, vi_select(is_low, d0, d2)));
    const vint n2 = vi_select(is_first, d0, vi_select(is_last, d1, vi_select(is_low, d2, d1)));
    const vint at = cell >> vi_set(2), byte = v_gather_ints(scene->cells, at, inside) >> ((cell - (at << vi_set(2))) << vi_set(3));
    const vint left = (byte >> tetra_turn_bit(n0, n1, n2)) & vi_set(1), turns = left - (r->cell & vi_set(1));
    const vmask goes_on = m_andnot(inside & vi_zero(turns), vi_zero(byte & vi_set(TETRA_TURNS_SHOWN)));
    next[0] = vi_select(goes_on, (cell << vi_set(3)) + left, vi_set(-1));
  }
}

/* Moves the rays through one cell to its next face. */
INLINE stratus_tetra_passage tetra_pass(
  CONSTANT stratus_tetra_arguments* a, const stratus_tetra_scene* scene, stratus_tetra_ray* r, vmask live)
{
  const vfloat zero = v_set(0.0f);
  vfloat d[4], e[3];
  gather_four(scene->points, r->fourth, live, d);
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
  vint next[2];
  if (a->lattice) {
    tetra_lattice_next(a, scene, r, dropped, live, next);
  } else {
    const vint two = vi_set(2), none = vi_set(0);
    vint at = r->cell + vi_select(vi_lt(r->fourth, dropped), two, none);
    for (int i = 0; i < 3; ++i) {
      at = at + vi_select(vi_lt(r->name[i], dropped), two, none);
    }
    gather_pair(scene->cells, at, live, next);
  }
  passage.from = r->at;
  passage.first = r->value;
  if (a->cell_values) {
    passage.first = gather_float(scene->cell_values, r->cell >> vi_set(3), live);
  }
#if TETRA_LIT
  passage.cell = r->cell;
  for (int i = 0; i < 3; ++i) {
    passage.edge[i] = r->edge[i];
  }
#endif
  if (TETRA_LIT || a->mode == TETRA_HITS) {
    for (int i = 0; i < 3; ++i) {
      passage.name[i] = r->name[i];
    }
    passage.fourth = a->cell_values ? r->cell >> vi_set(3) : r->fourth;
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
  if (!a->lattice) {
    prefetch_ints(scene->cells, r->cell);
  }
  return passage;
}

#if TETRA_LIT
/* Floats of points, `count` of four, where a ray passes a face, as tetra_cross() has the value. */
INLINE void tetra_face_floats(GLOBAL const float* floats, int count, const vint name[3], const vfloat edge[3], vmask mask, vfloat g[4])
{
  const vfloat zero = v_set(0.0f), hair = v_set(1e-30f);
  vfloat weight[3], sum = zero;
  g[0] = g[1] = g[2] = g[3] = zero;
  for (int i = 0; i < 3; ++i) {
    weight[i] = v_max(edge[i], zero) + hair;
    sum = sum + weight[i];
  }
  const vfloat share = v_reciprocal(sum);
  for (int i = 0; i < 3; ++i) {
    vfloat q[4];
    gather_four(floats, name[i], mask, q);
    for (int axis = 0; axis < count; ++axis) {
      g[axis] = v_fma(weight[i] * share, q[axis], g[axis]);
    }
  }
}

/* The part begin..end, in z, of a cell that was passed, with component c's gradients. */
INLINE stratus_tetra_stretch tetra_stretch(CONSTANT stratus_tetra_arguments* a, const stratus_tetra_scene* scene, int c,
  const stratus_tetra_ray* r, const stratus_tetra_passage* passage, vfloat begin, vfloat end, vmask mask)
{
  GLOBAL const float* gradients = scene->gradients + 4 * ((size_t)a->media.gradients_at[c] * (size_t)a->media.points);
  const vfloat per_z = v_reciprocal(v_max(passage->to - passage->from, v_set(1e-30f)));
  const vfloat from = v_clamp((begin - passage->from) * per_z, 0.0f, 1.0f), to = v_clamp((end - passage->from) * per_z, 0.0f, 1.0f);
  stratus_tetra_stretch s;
  vfloat near[4], far[4];
  tetra_face_floats(gradients, 3, passage->name, passage->edge, mask, near);
  tetra_face_floats(gradients, 3, r->name, r->edge, mask, far);
  for (int axis = 0; axis < 3; ++axis) {
    s.gradient[axis] = v_fma(far[axis] - near[axis], from, near[axis]);
    s.turn[axis] = (far[axis] - near[axis]) * (to - from);
  }
  s.lights = scene->lights;
  s.us = r->us;
  s.uw = r->uw;
  s.vs = r->vs;
  s.vw = r->vw;
  s.begin = begin;
  s.rise = end - begin;
  s.length = (end - begin) * r->length;
  s.tau_scale = v_set(a->table.tau_scale);
  s.factor_scale = v_set(a->factor_scale[c]);
  return s;
}

/* The places of a cell's values at the ends of the part begin..end of it. */
INLINE void tetra_values_of(CONSTANT stratus_tetra_arguments* a, const stratus_tetra_scene* scene, const stratus_tetra_ray* r,
  const stratus_tetra_passage* passage, vfloat begin, vfloat end, vmask mask, stratus_tetra_values* values)
{
  const vfloat per_z = v_reciprocal(v_max(passage->to - passage->from, v_set(1e-30f)));
  const vfloat from = v_clamp((begin - passage->from) * per_z, 0.0f, 1.0f), to = v_clamp((end - passage->from) * per_z, 0.0f, 1.0f);
  if (a->cell_values) {
    gather_four(scene->components, passage->cell >> vi_set(3), mask, values->from);
    for (int c = 0; c < TETRA_COMPONENTS; ++c) {
      values->to[c] = values->from[c];
    }
  } else {
    vfloat first[4], last[4];
    tetra_face_floats(scene->components, 4, passage->name, passage->edge, mask, first);
    tetra_face_floats(scene->components, 4, r->name, r->edge, mask, last);
    for (int c = 0; c < TETRA_COMPONENTS; ++c) {
      values->from[c] = v_fma(last[c] - first[c], from, first[c]);
      values->to[c] = v_fma(last[c] - first[c], to, first[c]);
      if (a->mode == TETRA_SURFACES) { /* the same as of the next cell, so that no surface on their face is lost or counts twice */
        values->to[c] = v_select(v_le(passage->to, end), last[c], values->to[c]);
      }
    }
  }
}

/* Mixes a cell's components at the place z: their light, and their optical depth over a unit of length. */
INLINE void tetra_mix_at(CONSTANT stratus_tetra_arguments* a, const stratus_tetra_scene* scene, const stratus_tetra_ray* r,
  const stratus_tetra_passage* passage, vfloat z, vmask mask, vfloat glow[3], vfloat* depth)
{
  stratus_tetra_values values;
  vfloat own[TETRA_COMPONENTS];
  tetra_values_of(a, scene, r, passage, z, z, mask, &values);
  const stratus_tetra_mixture mixture = { &values, 0, scene->media, scene->factors, v_set(1.0f) };
  mix_components(a, &mixture, values.from, values.from, v_set(0.0f), v_set(1.0f), mask, glow, depth, own);
}

/* The colour of dependent components at the place z. */
INLINE void tetra_color_at(CONSTANT stratus_tetra_arguments* a, const stratus_tetra_scene* scene, const stratus_tetra_ray* r,
  const stratus_tetra_passage* passage, vfloat z, vmask mask, vfloat color[3])
{
  vfloat depth;
  tetra_mix_at(a, scene, r, passage, z, mask, color, &depth);
  const vfloat per_depth = v_reciprocal(v_max(depth, v_set(1e-30f)));
  for (int i = 0; i < 3; ++i) {
    color[i] = color[i] * per_depth;
  }
}

/* Adds the last component's opacity times the first one's value on the part begin..end of a cell, as tetra_add() adds one component's.
 * first, last: values of the last component at both ends. */
INLINE void tetra_add_product(CONSTANT stratus_tetra_arguments* a, const stratus_tetra_scene* scene, const stratus_tetra_ray* r,
  stratus_tetra_light* light, const stratus_tetra_passage* passage, vfloat begin, vfloat end, vfloat first, vfloat last, vmask mask)
{
  CONSTANT stratus_tetra_media_arguments* m = &a->media;
  const vfloat zero = v_set(0.0f), one = v_set(1.0f);
  stratus_tetra_values values;
  tetra_values_of(a, scene, r, passage, begin, end, mask, &values);
  const vfloat start = v_fma(values.from[0], v_set(m->grey[0]), v_set(m->grey[1])),
               stop = v_fma(values.to[0], v_set(m->grey[0]), v_set(m->grey[1]));
  const vfloat rise = stop - start, low = v_set(m->counted[0]), high = v_set(m->counted[1]);
  const vmask varies = v_lt(zero, v_abs(rise)), inside = v_le(low, start) & v_le(start, high);
  const vfloat per_rise = v_reciprocal(v_select(varies, v_abs(rise), one)); /* only the part whose values count */
  const vfloat enters = v_select(v_lt(zero, rise), low - start, start - high) * per_rise,
               leaves = v_select(v_lt(zero, rise), high - start, start - low) * per_rise;
  const vfloat from = v_select(varies, v_max(enters, zero), zero), to = v_select(varies, v_min(leaves, one), v_select(inside, one, zero));
  mask = mask & v_lt(from, to);
  if (!m_any(mask)) {
    return;
  }
  const vfloat begins = v_fma(from, end - begin, begin);
  const stratus_tetra_place place = tetra_place(a, scene->sums, v_fma(from, last - first, first), mask),
                            next = tetra_place(a, scene->sums, v_fma(to, last - first, first), mask);
  const vfloat opacity = v_from_int(next.sum[1] - place.sum[1]);
  const vfloat middle = tetra_middle_of(scene->sums, (int)a->table.last + 1, place.entry, next.entry, opacity, mask);
  const vfloat value = v_fma(v_fma(middle, to - from, from), rise, start);
  tetra_add(
    a, scene->sums, light, mask, &place, &next, &value, (to - from) * (end - begin) * r->length, v_fma(begins, r->length, r->offset));
}

/* Sets the stretches of those components whose light or opacity depends on their gradients. */
INLINE void tetra_component_stretches(CONSTANT stratus_tetra_arguments* a, const stratus_tetra_scene* scene, const stratus_tetra_ray* r,
  const stratus_tetra_passage* passage, vfloat begin, vfloat end, vmask mask, stratus_tetra_stretch stretches[TETRA_COMPONENTS])
{
  for (int c = 0; c < a->media.components; ++c) {
    if (component_has_gradient(a, c)) {
      stretches[c] = tetra_stretch(a, scene, c, r, passage, begin, end, mask);
    }
  }
}

/* Adds the light of several components on the part begin..end of a cell that was passed. */
OUTLINE void tetra_shade_components(CONSTANT stratus_tetra_arguments* a, const stratus_tetra_scene* scene, const stratus_tetra_ray* r,
  stratus_tetra_light* light, const stratus_tetra_passage* passage, vfloat begin, vfloat end, vmask mask, vfloat near)
{
  stratus_tetra_values values;
  tetra_values_of(a, scene, r, passage, begin, end, mask, &values);
  stratus_tetra_stretch stretches[TETRA_COMPONENTS];
  tetra_component_stretches(a, scene, r, passage, begin, end, mask, stretches);
  const stratus_tetra_mixture mixture = { &values, stretches, scene->media, scene->factors, (end - begin) * r->length };
  tetra_media(a, &mixture, light, mask, near);
}

/* Adds the light of the part begin..end of cells, from value `first` to `last`, by the function of each cell's label. Labels take turns. */
OUTLINE void tetra_shade_labels(CONSTANT stratus_tetra_arguments* a, const stratus_tetra_scene* scene, const stratus_tetra_ray* r,
  stratus_tetra_light* light, const stratus_tetra_passage* passage, vfloat begin, vfloat end, vfloat first, vfloat last, vmask mask,
  vfloat near)
{
  const vint label = v_to_int(gather_float(scene->components, passage->cell >> vi_set(3), mask)), none = vi_set(-1);
  while (m_any(mask)) {
    int of[STRATUS_WIDTH], turn = -1;
    vi_store(of, vi_select(mask, label, none));
    for (int lane = 0; lane < STRATUS_WIDTH; ++lane) {
      turn = of[lane] > turn ? of[lane] : turn;
    }
    const vmask mine = mask & vi_zero(label - vi_set(turn));
    GLOBAL const int *record = scene->media + TETRA_LABEL * turn, *sums = scene->media + record[0];
    const stratus_tetra_place from = tetra_place(a, sums, first, mine), to = tetra_place(a, sums, last, mine);
    const vfloat tau_scale = v_from_bits(vi_set(record[1]));
    if (a->light.on | a->thins) {
      stratus_tetra_stretch stretch = tetra_stretch(a, scene, 0, r, passage, begin, end, mine);
      stretch.tau_scale = tau_scale;
      stretch.factor_scale = stretch.factor_scale * v_from_bits(vi_set(record[2]));
      GLOBAL const float* factors = scene->factors + (size_t)record[3] * ((size_t)a->factor_last + 2);
      tetra_light_stretch(a, sums, factors, &stretch, light, mine, first, last, &from, &to, near);
    } else { /* the frame's own tau_scale is 1 */
      tetra_integrate(a, sums, light, mine, first, last, &from, &to, (end - begin) * r->length * tau_scale, near);
    }
    mask = m_andnot(mask, mine);
  }
}

/* Returns the lanes whose stretch may show: its sums differ, or it is within one entry. */
INLINE vmask tetra_may_show(CONSTANT stratus_tetra_arguments* a, const stratus_tetra_place* from, const stratus_tetra_place* to, vmask mask)
{
  return a->table.has_opaque ? mask : m_andnot(mask, m_andnot(vi_zero(to->sum[3] - from->sum[3]), vi_zero(to->entry - from->entry)));
}
#endif

/* Keeps the largest value so far, and where it is. Minima are maxima of the negative values. Returns the rays that have a larger one. */
INLINE vmask tetra_extreme(stratus_tetra_light* light, vmask mask, vfloat first, vfloat last, vfloat near, vfloat far)
{
  const vfloat larger = v_max(first, last);
  const vmask more = mask & v_lt(light->most, larger);
  light->most = v_select(more, larger, light->most);
  light->depth = v_select(more, v_select(v_lt(first, last), far, near), light->depth);
  return more;
}

/* Adds a cell to a ray's quantities, which kernels/integrator/ray_quantities.h describes: red, the integral; green, the length; blue, the
 * number of cells. The field is linear. */
INLINE void tetra_measure(stratus_tetra_light* light, vmask mask, vfloat first, vfloat last, vfloat near, vfloat length)
{
  const vfloat zero = v_set(0.0f), mean = v_set(0.5f) * (first + last);
  (void)tetra_extreme(light, mask, first, last, near, near + length);
  length = v_select(mask, length, zero);
  light->red = v_fma(v_select(mask, mean, zero), length, light->red);
  light->green = light->green + length;
  light->blue = light->blue + v_select(mask, v_set(1.0f), zero);
}

#if TETRA_LIT
/* Composites a surface of component c at a part of begin..end of a cell, in its light. Dependent components have their own colour. */
OUTLINE void tetra_lit_surface(CONSTANT stratus_tetra_arguments* a, const stratus_tetra_scene* scene, const stratus_tetra_ray* r,
  stratus_tetra_light* light, const stratus_tetra_passage* passage, int c, vfloat begin, vfloat end, vfloat part, vmask mask,
  vfloat color[4], vfloat distance)
{
  stratus_tetra_lit lit;
  if (a->media.dependent) {
    tetra_color_at(a, scene, r, passage, v_fma(part, end - begin, begin), mask, color);
    for (int i = 0; i < 3; ++i) {
      color[i] = color[i] * color[3];
    }
  }
  if (a->light.on >> c & 1) {
    const stratus_tetra_stretch stretch = tetra_stretch(a, scene, c, r, passage, begin, end, mask);
    tetra_light_at(a, 0, c, &stretch, part, v_set(0.0f), mask, &lit);
  }
  tetra_surface(a, light, a->light.on >> c & 1 ? &lit : 0, mask, color, distance);
}
#endif

/* Composite the surfaces that the part begin..end of a cell passes, from value `first` to `last`, in their order along it. Surfaces of
 * several independent components at one place are in the components' order. A surface is where the field passes its value upwards or
 * downwards, so that one on the border of two cells counts once. */
OUTLINE void tetra_surfaces(CONSTANT stratus_tetra_arguments* a, const stratus_tetra_scene* scene, const stratus_tetra_ray* r,
  stratus_tetra_light* light, const stratus_tetra_passage* passage, vfloat begin, vfloat end, vfloat first, vfloat last, vmask mask)
{
  const vfloat one = v_set(1.0f), none = v_set(2.0f), zero = v_set(0.0f);
  vfloat at = v_set(-1.0f); /* the last surface so far: its part of the stretch, and its number */
  vint number = vi_set(0);
#if TETRA_LIT
  const int several = a->media.components && !a->media.dependent, count = several ? a->media.components : 1;
  stratus_tetra_values values;
  values.from[0] = first;
  values.to[0] = last;
  if (several) {
    tetra_values_of(a, scene, r, passage, begin, end, mask, &values);
  }
#else
  const int count = 1;
  (void)scene;
  (void)passage;
#endif
  for (;;) {
    vfloat next = none, color[4] = { zero, zero, zero, zero };
    vint found = vi_set(0);
    for (int c = 0; c < count; ++c) {
#if TETRA_LIT
      first = values.from[c];
      last = values.to[c];
#endif
      for (int n = 0; n < a->contour_count[c]; ++n) {
        CONSTANT float* surface = a->contour[c][n];
        const vfloat value = v_set(surface[0]);
        const vmask below = v_lt(first, value), ends_below = v_lt(last, value);
        vmask met = mask & (m_andnot(below, ends_below) | m_andnot(ends_below, below));
        if (!m_any(met)) {
          continue;
        }
        const vfloat part = (value - first) * v_reciprocal(v_select(met, last - first, one));
        const vint of = vi_set(TETRA_CONTOURS * c + n);
        met = met & v_lt(part, next) & (v_lt(at, part) | (v_le(at, part) & vi_lt(number, of)));
        next = v_select(met, part, next);
        found = vi_select(met, of, found);
        for (int i = 0; i < 4; ++i) {
          color[i] = v_select(met, v_set(surface[1 + i]), color[i]);
        }
      }
    }
    mask = mask & v_lt(next, none);
    if (!m_any(mask)) {
      return;
    }
    const vfloat distance = v_fma(next, (end - begin) * r->length, v_fma(begin, r->length, r->offset));
#if TETRA_LIT
    for (int c = 0; c < count; ++c) {
      const vmask mine = mask & vi_ge(found, vi_set(TETRA_CONTOURS * c)) & vi_lt(found, vi_set(TETRA_CONTOURS * (c + 1)));
      if (m_any(mine)) {
        tetra_lit_surface(
          a, scene, r, light, passage, a->media.dependent ? a->media.components - 1 : c, begin, end, next, mine, color, distance);
      }
    }
#else
    tetra_surface(a, light, 0, mask, color, distance);
#endif
    at = next;
    number = found;
  }
}

/* Composites the values that the part begin..end of a cell shows on the slice. */
OUTLINE void tetra_slice(CONSTANT stratus_tetra_arguments* a, const stratus_tetra_scene* scene, const stratus_tetra_ray* r,
  stratus_tetra_light* light, const stratus_tetra_passage* passage, vfloat begin, vfloat end, vmask mask)
{
  const vfloat slope = (passage->last - passage->first) * v_reciprocal(v_max(passage->to - passage->from, v_set(1e-30f)));
  for (int n = 0; n < 2; ++n) {
    const vmask met = mask & v_le(begin, r->slice[n]) & v_lt(r->slice[n], end);
    if (m_any(met)) {
      const vfloat z = v_select(met, r->slice[n], begin), value = v_fma(slope, z - passage->from, passage->first);
      vfloat color[4];
      gather_four(scene->colors, table_entry(&a->table, scene->colors, value), met, color);
#if TETRA_LIT
      if (a->media.components) {
        vfloat depth;
        tetra_mix_at(a, scene, r, passage, z, met, color, &depth);
        const vfloat share = v_absorbed_share(depth, met);
        for (int i = 0; i < 3; ++i) {
          color[i] = color[i] * share;
        }
        color[3] = v_min(depth * share, v_set(1.0f));
      }
#endif
      tetra_surface(a, light, 0, met, color, v_fma(z, r->length, r->offset));
    }
  }
}

/* Ends rays at a cell whose part begin..end shows, between the values `first` and `last` or of any independent component. Keeps the numbers
 * of the cell's points, of which the first three are the face by which the ray entered. Of values of cells the fourth number is the
 * cell's. */
OUTLINE void tetra_hit(CONSTANT stratus_tetra_arguments* a, const stratus_tetra_scene* scene, const stratus_tetra_ray* r,
  stratus_tetra_light* light, const stratus_tetra_passage* passage, vfloat begin, vfloat end, vfloat first, vfloat last, vmask mask)
{
  vint entry;
#if TETRA_LIT
  stratus_tetra_values values;
  vmask met = m_none();
  (void)first;
  (void)last;
  tetra_values_of(a, scene, r, passage, begin, end, mask, &values);
  for (int c = 0; c < a->media.components; ++c) {
    const vint from = v_to_int(v_clamp(values.from[c], 0.0f, a->media.last[c])),
               to = v_to_int(v_clamp(values.to[c], 0.0f, a->media.last[c]));
    if (a->media.weight[c] > 0.0f) {
      met = met | component_meets(a, scene->media, c, from, to, mask, &entry);
    }
  }
#else
  const vint from = table_entry(&a->table, scene->colors, first), to = table_entry(&a->table, scene->colors, last);
  const vmask met = opaque_on_the_way(&a->table, scene->sums + 8 * a->table.entries, from, to, mask, &entry);
  (void)r;
  (void)begin;
  (void)end;
#endif
  const vint plus = vi_set(TETRA_HIT_NAME);
  light->red = v_select(met, v_from_bits(passage->name[0] + plus), light->red);
  light->green = v_select(met, v_from_bits(passage->name[1] + plus), light->green);
  light->blue = v_select(met, v_from_bits(passage->name[2] + plus), light->blue);
  light->most = v_select(met, v_from_bits(passage->fourth + plus), light->most);
  light->transparency = v_select(met, v_set(0.0f), light->transparency);
}

/* Add the light of a cell that was passed, cut to the visible part. Returns the lanes whose path has ended: they are outside, hidden by
 * matter in front, or beyond the visible part. */
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
  if (a->mode == TETRA_EXTREMES) {
    const vfloat sign = v_set(a->sign);
    const vmask more = tetra_extreme(light, mask, sign * first, sign * last, near, v_fma(end, r->length, r->offset));
#if TETRA_LIT
    if (a->media.components && m_any(more)) { /* dependent ones */
      vfloat color[3];
      tetra_color_at(a, scene, r, passage, v_select(v_lt(sign * first, sign * last), end, begin), more, color);
      light->red = v_select(more, color[0], light->red);
      light->green = v_select(more, color[1], light->green);
      light->blue = v_select(more, color[2], light->blue);
    }
#else
    (void)more;
#endif
  } else if (a->mode == TETRA_QUANTITIES) {
    tetra_measure(light, mask, first, last, near, (end - begin) * r->length);
  } else if (a->mode == TETRA_SURFACES) {
    tetra_surfaces(a, scene, r, light, passage, begin, end, first, last, mask);
  } else if (a->mode == TETRA_SLICE) {
    tetra_slice(a, scene, r, light, passage, begin, end, mask);
  } else if (a->mode == TETRA_HITS) {
    tetra_hit(a, scene, r, light, passage, begin, end, first, last, mask);
#if TETRA_LIT
  } else if (a->mode == TETRA_ADD && a->media.components) {
    tetra_add_product(a, scene, r, light, passage, begin, end, first, last, mask);
  } else if (a->media.labels) {
    tetra_shade_labels(a, scene, r, light, passage, begin, end, first, last, mask, near);
#endif
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
    if (a->mode == TETRA_ADD) {
      tetra_add(a, scene->sums, light, mask, &from, &to, 0, (end - begin) * r->length, near);
    } else {
#if TETRA_LIT
      const vmask some = a->media.components ? mask : tetra_may_show(a, &from, &to, mask);
      if (m_any(some) && a->media.components) {
        tetra_shade_components(a, scene, r, light, passage, begin, end, some, near);
      } else if (m_any(some)) {
        const stratus_tetra_stretch stretch = tetra_stretch(a, scene, 0, r, passage, begin, end, some);
        tetra_light_stretch(a, scene->sums, scene->factors, &stretch, light, some, first, last, &from, &to, near);
      }
#else
      tetra_integrate(a, scene->sums, light, mask, first, last, &from, &to, (end - begin) * r->length, near);
#endif
    }
  }
  if ((a->mode == TETRA_SURFACES || a->mode == TETRA_SLICE) && a->kept > 0.0f) {
    r->end = v_select(v_le(v_set(a->kept), light->most), v_set(-LARGEST_FLOAT), r->end);
  }
  return live & (vi_lt(r->cell, vi_set(0)) | v_lt(light->transparency, v_set(a->termination)) | v_le(r->end, passage->to));
}

/* Starts rays at a face whose points they hold: finds where they enter, and the field there. */
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
  int places = a->mode == TETRA_LIGHT || a->mode == TETRA_ADD;
#if TETRA_LIT
  places = places && !a->media.labels; /* which have sums of their own */
#endif
  if (places) {
    const stratus_tetra_place place = tetra_place(a, scene->sums, value, mask);
    r->place = tetra_place_select(mask, &place, &r->place);
  }
}

#endif
