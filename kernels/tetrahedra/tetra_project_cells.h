/* SPDX-License-Identifier: BSD-3-Clause
 * Intersects the rays of a packet with a cell: where they enter and leave it.
 *
 * pass_cell() serves any cell. Like the march, it decides by the signs of the cell's edges as rays see them, which are exact and the same
 * for all cells that share an edge. meet_planes() serves most cells, by their four planes. A ray meets plane k at s = 1 - w0/w (parallel:
 * z - z0), where index 0 is the cell's first point. s is linear over the screen, and relative to the cell, so that a small cell far away
 * keeps its digits. The ray enters at the largest s of the planes that face the eye, and leaves at the smallest s of the others. A cell for
 * which floats are too inaccurate (seen edge-on, thin, or partly behind the eye) takes pass_cell(). */
#ifndef STRATUS_TETRA_PROJECT_CELLS_H
#define STRATUS_TETRA_PROJECT_CELLS_H

#include "tetra_project_tile.h"

/* Cells that come nearer than this to the eye's plane, in units of the largest coordinate, have no safe outline in floats. */
#define NEAREST_OUTLINE 0x1p-6f
/* Planes serve if rounding moves barycentric coordinates by less than 2^-13, and crossings by less than 2^-12 of the cell's depth. Their
 * few operations have a relative error of 2^-22, so these limits bound the magnitudes that are rounded. */
#define COORDINATE_MOST 0x1p9f
#define CROSSING_MOST 0x1p10f

typedef struct ray_piece {
  vfloat at, to, first, last;
} ray_piece;

/* ---- any cell */

typedef struct cell_points {
  vfloat a[4], b[4], z[4], s[4];
} cell_points;

INLINE void load_points(const project_tile* t, uint cell, cell_points* c)
{
  const stratus_project_view* v = t->view;
  for (int i = 0; i < 4; ++i) {
    GLOBAL const float* point = v->points + 4 * (size_t)v->vertices[4 * (size_t)cell + (size_t)i];
    c->a[i] = v_set(point[0]);
    c->b[i] = v_set(point[1]);
    c->z[i] = v_set(point[2]);
    c->s[i] = v_set(t->arguments->cell_values ? v->cell_values[cell] : point[3]);
  }
}

/* Extends the piece, for rays of `mask`, to where they pass face pqr. */
INLINE void pass_face(const cell_points* c, vmask mask, int p, int q, int r, vfloat qr, vfloat pr, vfloat pq, ray_piece* piece)
{
  const vfloat edge[3] = { v_abs(qr), v_abs(pr), v_abs(pq) }, z[3] = { c->z[p], c->z[q], c->z[r] }, s[3] = { c->s[p], c->s[q], c->s[r] };
  vfloat at, value;
  if (!m_any(mask)) {
    return;
  }
  tetra_cross(edge, z, s, &at, &value);
  const vmask nearer = mask & v_lt(at, piece->at), farther = mask & v_lt(piece->to, at);
  piece->at = v_select(nearer, at, piece->at);
  piece->first = v_select(nearer, value, piece->first);
  piece->to = v_select(farther, at, piece->to);
  piece->last = v_select(farther, value, piece->last);
}

/* Sets the piece of each live ray inside the cell. Returns the rays that meet the cell. */
INLINE vmask pass_cell(const cell_points* c, vfloat us, vfloat uw, vfloat vs, vfloat vw, vmask live, ray_piece* piece)
{
  const int ends[6][2] = { { 0, 1 }, { 0, 2 }, { 0, 3 }, { 1, 2 }, { 1, 3 }, { 2, 3 } };
  const vfloat zero = v_set(0.0f);
  vfloat x[4], y[4], e[6];
  vmask n[6];
  for (int i = 0; i < 4; ++i) {
    x[i] = v_fma(zero - us, c->z[i], c->a[i] - uw);
    y[i] = v_fma(zero - vs, c->z[i], c->b[i] - vw);
  }
  for (int i = 0; i < 6; ++i) {
    const int p = ends[i][0], q = ends[i][1];
    e[i] = tetra_edge(x[p], y[p], x[q], y[q]);
    n[i] = tetra_negative(e[i], x[p], y[p], x[q], y[q]);
  }
  /* a ray passes face pqr if edges pq, qr and rp have one sign; rp has the opposite sign of pr */
#define PASSED(pq, qr, pr) (live & (m_andnot(n[pq] & n[qr], n[pr]) | m_andnot(n[pr], n[pq] | n[qr])))
  const vmask f0 = PASSED(3, 5, 4), f1 = PASSED(1, 5, 2), f2 = PASSED(0, 4, 2), f3 = PASSED(0, 3, 1);
#undef PASSED
  piece->at = v_set(LARGEST_FLOAT);
  piece->to = v_set(-LARGEST_FLOAT);
  piece->first = piece->last = zero;
  pass_face(c, f0, 1, 2, 3, e[5], e[4], e[3], piece);
  pass_face(c, f1, 0, 2, 3, e[5], e[2], e[1], piece);
  pass_face(c, f2, 0, 1, 3, e[4], e[2], e[0], piece);
  pass_face(c, f3, 0, 1, 2, e[3], e[1], e[0], piece);
  return v_lt(piece->at, piece->to);
}

/* ---- most cells */

/* The planes of a batch of cells, one cell per lane. Plane k is at s = c + a dx + b dy; the field at s is
 * value + (vc + va dx + vb dy - vs s)/(1 - shear s). */
typedef struct cell_planes {
  float a[4][STRATUS_WIDTH], b[4][STRATUS_WIDTH], c[4][STRATUS_WIDTH];
  float value[STRATUS_WIDTH], va[STRATUS_WIDTH], vb[STRATUS_WIDTH], vc[STRATUS_WIDTH], vs[STRATUS_WIDTH], least[STRATUS_WIDTH],
    most[STRATUS_WIDTH];
  float z[STRATUS_WIDTH], w[STRATUS_WIDTH]; /* of the cell's first point */
  int fronts[STRATUS_WIDTH];                /* bit k: plane k faces the eye; 0: the planes are too inaccurate */
} cell_planes;

/* Each component has the relative error of a float, so that collinear or coincident points do not leave a product of rounding errors. */
INLINE void cross_product(const vfloat p[3], const vfloat q[3], vfloat out[3])
{
  for (int axis = 0; axis < 3; ++axis) {
    const int i = (axis + 1) % 3, j = (axis + 2) % 3;
    out[axis] = tetra_edge(p[i], p[j], q[i], q[j]);
  }
}

/* Load the points as the tile's first pixel sees them: x, y, z, value; points 1 to 3 are relative to point 0. */
INLINE void see_cells(const project_tile* t, const int* cells, vfloat p[4][4], cell_planes* out, vfloat* nearest, vfloat* depth)
{
  const stratus_project_view* v = t->view;
  CONSTANT stratus_tetra_arguments* a = t->arguments;
  const int padded = a->picture.width + TETRA_PADDING;
  GLOBAL const float *columns = v->lines + t->x0, *rows = v->lines + 2 * padded + t->y0;
  const vfloat zero = v_set(0.0f), us = v_set(columns[0]), uw = v_set(columns[padded]), vs = v_set(rows[0]),
               vw = v_set(rows[a->picture.height + TETRA_PADDING]);
  const vint cell = vi_load(cells);
  const vmask all = vi_lt(vi_set(-1), cell);
  vfloat near = v_set(LARGEST_FLOAT), far = v_set(-LARGEST_FLOAT), least = near, most = far;
  for (int i = 0; i < 4; ++i) {
    vfloat q[4];
    gather_four(v->points, v_gather_ints(v->vertices, (cell << vi_set(2)) + vi_set(i), all), all, q);
    p[i][0] = v_fma(zero - us, q[2], q[0] - uw);
    p[i][1] = v_fma(zero - vs, q[2], q[1] - vw);
    p[i][2] = q[2];
    p[i][3] = a->cell_values ? gather_float(v->cell_values, cell, all) : q[3];
    near = v_min(near, q[2]);
    far = v_max(far, q[2]);
    least = v_min(least, p[i][3]);
    most = v_max(most, p[i][3]);
  }
  v_store(out->least, least);
  v_store(out->most, most);
  v_store(out->value, p[0][3]);
  v_store(out->z, p[0][2]);
  *nearest = v_fma(v_set(a->shear), near, v_set(a->middle));
  *depth = far - near;
  for (int i = 1; i < 4; ++i) {
    for (int c = 0; c < 4; ++c) {
      p[i][c] = p[i][c] - p[0][c];
    }
  }
}

static void find_planes(const project_tile* t, const int* cells, cell_planes* out)
{
  CONSTANT stratus_tetra_arguments* a = t->arguments;
  const vfloat zero = v_set(0.0f), one = v_set(1.0f), two = v_set(2.0f), shear = v_set(a->shear);
  vfloat p[4][4], m[4][3], side[2][3], nearest, depth, va = zero, vb = zero, vc = zero, vs = zero;
  see_cells(t, cells, p, out, &nearest, &depth);
  const vfloat w = v_fma(shear, p[0][2], v_set(a->middle));
  const vfloat across = w * (two * v_reciprocal(v_set((float)a->picture.width)));
  const vfloat upwards = w * (two * v_reciprocal(v_set((float)a->picture.height)));
  cross_product(p[2], p[3], m[1]);
  cross_product(p[3], p[1], m[2]);
  cross_product(p[1], p[2], m[3]);
  for (int axis = 0; axis < 3; ++axis) {
    side[0][axis] = p[2][axis] - p[1][axis];
    side[1][axis] = p[1][axis] - p[3][axis]; /* this way round, m[0] = -(m[1] + m[2] + m[3]) */
  }
  cross_product(side[0], side[1], m[0]);
  const vfloat volume = v_fma(p[1][0], m[1][0], v_fma(p[1][1], m[1][1], p[1][2] * m[1][2])), per_volume = v_reciprocal(volume);
  /* the cell's extent about its first point, plus that point's distance from the tile's first pixel */
  const vfloat wide = v_max(v_max(v_abs(p[1][0]), v_abs(p[2][0])), v_abs(p[3][0])) + v_abs(p[0][0]);
  const vfloat high = v_max(v_max(v_abs(p[1][1]), v_abs(p[2][1])), v_abs(p[3][1])) + v_abs(p[0][1]);
  vmask fit = v_le(v_set(NEAREST_OUTLINE), nearest);
  vint fronts = vi_set(0);
  for (int k = 0; k < 4; ++k) { /* barycentric coordinate k; at depth w0 it is `level` at the first pixel */
    const vfloat x = m[k][0] * per_volume, y = m[k][1] * per_volume, z = m[k][2] * per_volume, start = k ? zero : one;
    const vfloat level = start - v_fma(x, p[0][0], y * p[0][1]), fall = v_fma(shear, level, zero - z * w), per_fall = v_reciprocal(fall);
    const vfloat doubt = v_fma(v_abs(x), wide, v_abs(y) * high);
    fit = fit & v_le(doubt, v_set(COORDINATE_MOST)) & v_le(doubt * v_abs(per_fall) * w, v_set(CROSSING_MOST) * depth);
    fronts = fronts | vi_select(v_lt(fall, zero), vi_set(1 << k), vi_set(0));
    v_store(out->a[k], x * across * per_fall);
    v_store(out->b[k], y * upwards * per_fall);
    v_store(out->c[k], level * per_fall);
    if (k) {
      va = v_fma(p[k][3], x * across, va);
      vb = v_fma(p[k][3], y * upwards, vb);
      vc = v_fma(p[k][3], level, vc);
      vs = v_fma(p[k][3], fall, vs);
    }
  }
  fit = fit & vi_lt(fronts, vi_set(15));
  v_store(out->va, va);
  v_store(out->vb, vb);
  v_store(out->vc, vc);
  v_store(out->vs, vs);
  v_store(out->w, w);
  vi_store(out->fronts, vi_select(fit, fronts, vi_set(0)));
}

/* One cell of a batch. The planes that face the eye come first. */
typedef struct one_cell {
  vfloat a[4], b[4], c[4];
  vfloat value, va, vb, vc, vs, least, most, z, w, shear;
  int fronts; /* number of planes that face the eye */
} one_cell;

INLINE void take_cell(const project_tile* t, const cell_planes* planes, int l, one_cell* c)
{
  int from = 0, to = 3;
  for (int k = 0; k < 4; ++k) {
    const int place = planes->fronts[l] >> k & 1 ? from++ : to--;
    c->a[place] = v_set(planes->a[k][l]);
    c->b[place] = v_set(planes->b[k][l]);
    c->c[place] = v_set(planes->c[k][l]);
  }
  c->fronts = from;
  c->value = v_set(planes->value[l]);
  c->va = v_set(planes->va[l]);
  c->vb = v_set(planes->vb[l]);
  c->vc = v_set(planes->vc[l]);
  c->vs = v_set(planes->vs[l]);
  c->least = v_set(planes->least[l]);
  c->most = v_set(planes->most[l]);
  c->z = v_set(planes->z[l]);
  c->w = v_set(planes->w[l]);
  c->shear = v_set(t->arguments->shear);
}

/* Finds where rays enter and leave the cell, in s, and returns those that meet it. rows: each plane's b dy + c. */
INLINE vmask meet_planes(const one_cell* c, int fronts, const vfloat rows[4], vfloat dx, vfloat* near, vfloat* far)
{
  vfloat s[4];
  for (int k = 0; k < 4; ++k) {
    s[k] = v_fma(c->a[k], dx, rows[k]);
  }
  *near = s[0];
  *far = s[3];
  for (int k = 1; k < 3; ++k) {
    if (k < fronts) {
      *near = v_max(*near, s[k]);
    } else {
      *far = v_min(*far, s[k]);
    }
  }
  return v_lt(*near, *far);
}

/* Converts a piece from s to z, and finds the field at its ends. */
INLINE void cut_piece(const one_cell* c, vfloat dx, vfloat dy, vfloat near, vfloat far, ray_piece* piece)
{
  const vfloat zero = v_set(0.0f), one = v_set(1.0f);
  const vfloat enter = v_reciprocal(v_fma(zero - c->shear, near, one)), leave = v_reciprocal(v_fma(zero - c->shear, far, one));
  const vfloat level = v_fma(c->va, dx, v_fma(c->vb, dy, c->vc));
  piece->at = v_fma(c->w * near, enter, c->z);
  piece->to = v_fma(c->w * far, leave, c->z);
  piece->first = v_min(v_max(v_fma(v_fma(zero - c->vs, near, level), enter, c->value), c->least), c->most);
  piece->last = v_min(v_max(v_fma(v_fma(zero - c->vs, far, level), leave, c->value), c->least), c->most);
}

#endif
