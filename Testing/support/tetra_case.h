/* SPDX-License-Identifier: BSD-3-Clause
 * Random small meshes of tetrahedra, and their reference picture, which shares no code with the renderer. It intersects each ray with every
 * cell in double precision by barycentric coordinates, sorts the intervals by entry, and integrates each by quadrature from point to point
 * of the functions. */
#ifndef STRATUS_TESTING_TETRA_CASE_H
#define STRATUS_TESTING_TETRA_CASE_H

#include "linear_between.h"
#include "picture_size.h"
#include "stratus.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define TETRA_PIXELS_MOST (45 * 37)
/* Odd numbers, so that a pixel is in the middle. */
#define TETRA_WIDTH (CASE_SMALL ? 23 : 45)
#define TETRA_HEIGHT (CASE_SMALL ? 19 : 37)
#define TETRA_PIXELS (CASE_SMALL ? 23 * 19 : TETRA_PIXELS_MOST)

typedef struct tetra_case {
  stratus_mesh mesh;
  double* points;
  int32_t* vertices;
  float* values;
  uint8_t* hidden;
  stratus_transfer transfer;
  const stratus_transfer* transfers; /* of labels; NULL: there is only `transfer` */
  stratus_camera camera;
  stratus_tetra_options options;
  const float* opaque_depth;
  double opacity[8], color[12];
} tetra_case;

typedef struct tetra_picture {
  float rgba[4 * TETRA_PIXELS_MOST], depth[TETRA_PIXELS_MOST];
  uint8_t rgba8[4 * TETRA_PIXELS_MOST];
  uint32_t samples[TETRA_PIXELS_MOST];
  stratus_tetra_report report;
} tetra_picture;

/* The method that draws cases. Tests of results that must not depend on it run once with each method. */
static stratus_tetra_method tetra_method = STRATUS_TETRA_METHOD_MARCH;

static inline double tetra_uniform(uint32_t* state, double lo, double hi)
{
  *state = *state * 1664525u + 1013904223u;
  return lo + (hi - lo) * (double)(*state >> 8) / 16777216.0;
}

/* Makes a cube of n^3 boxes with six cells each about the box's diagonal. Points move by up to `jitter` of a box, the corners of cells are
 * shuffled, and a share `missing` of the cells is left out. Values are within 0..1 and vary smoothly. */
static inline void tetra_create(tetra_case* c, int n, double jitter, double missing, uint32_t seed)
{
  static const int path[6][2] = { { 0, 1 }, { 0, 2 }, { 1, 0 }, { 1, 2 }, { 2, 0 }, { 2, 1 } };
  const int side = n + 1;
  uint32_t s = seed * 7919u + 5u;
  memset(c, 0, sizeof *c);
  c->mesh = stratus_mesh_default();
  c->points = calloc((size_t)(side * side * side), 3 * sizeof(double));
  c->values = calloc((size_t)(6 * side * side * side), sizeof(float)); /* also enough for a value per cell */
  c->vertices = calloc((size_t)(6 * n * n * n), 4 * sizeof(int32_t));
  c->hidden = calloc((size_t)(6 * n * n * n), 1);
  assert_true(c->points && c->values && c->vertices && c->hidden);
  for (int i = 0; i < side * side * side; ++i) {
    const int at[3] = { i % side, i / side % side, i / side / side };
    for (int a = 0; a < 3; ++a) {
      c->points[3 * i + a] = at[a] + tetra_uniform(&s, -jitter, jitter);
    }
    c->values[i] = (float)(0.5 + 0.25 * sin(1.9 * at[0] + 0.7 * at[1] + seed) + 0.25 * cos(1.3 * at[2] - 0.9 * at[1]));
  }
  for (int box = 0; box < n * n * n; ++box) {
    const int corner = (box / n / n * side + box / n % n) * side + box % n, step[3] = { 1, side, side * side };
    for (int t = 0; t < 6; ++t) {
      const int a = corner + step[path[t][0]], b = a + step[path[t][1]], last = corner + 1 + side + side * side;
      const int32_t v[4] = { corner, a, b, last };
      const int turn = (int)tetra_uniform(&s, 0, 3.999);
      if (tetra_uniform(&s, 0, 1) >= missing) {
        for (int i = 0; i < 4; ++i) {
          c->vertices[4 * c->mesh.cell_count + i] = v[(i * (turn & 1 ? 3 : 1) + turn) & 3];
        }
        ++c->mesh.cell_count;
      }
    }
  }
  c->mesh.points = c->points;
  c->mesh.point_count = side * side * side;
  c->mesh.vertices = c->vertices;
  c->mesh.values = c->values;
  const double opacity[8] = { 0.0, 0.0, 0.3, 0.05, 0.6, 0.7, 1.0, 0.2 };
  const double color[12] = { 0.0, 0.2, 0.3, 0.9, 0.5, 0.9, 0.8, 0.2, 1.0, 1.0, 0.1, 0.1 };
  memcpy(c->opacity, opacity, sizeof opacity);
  memcpy(c->color, color, sizeof color);
  c->transfer = stratus_transfer_default();
  c->transfer.opacity = c->opacity;
  c->transfer.opacity_count = 4;
  c->transfer.color = c->color;
  c->transfer.color_count = 3;
  c->options = stratus_tetra_options_default();
  c->options.termination = 1.0;
  c->options.method = tetra_method;
}

/* Adds copies of the mesh that overlap it, each moved by `apart` against the one before: no order of whole cells is right. */
static inline void tetra_copy(tetra_case* c, int copies, double apart)
{
  const int64_t points = c->mesh.point_count, cells = c->mesh.cell_count;
  c->points = realloc(c->points, (size_t)(copies * points) * 3 * sizeof(double));
  c->values = realloc(c->values, (size_t)(copies * points) * sizeof(float));
  c->vertices = realloc(c->vertices, (size_t)(copies * cells) * 4 * sizeof(int32_t));
  assert_true(c->points && c->values && c->vertices);
  for (int64_t copy = 1; copy < copies; ++copy) {
    for (int64_t i = 0; i < 3 * points; ++i) {
      c->points[3 * copy * points + i] = c->points[i] + apart * (double)copy;
    }
    for (int64_t i = 0; i < points; ++i) {
      c->values[copy * points + i] = c->values[i];
    }
    for (int64_t i = 0; i < 4 * cells; ++i) {
      c->vertices[4 * copy * cells + i] = c->vertices[i] + (int32_t)(copy * points);
    }
  }
  c->mesh.points = c->points;
  c->mesh.values = c->values;
  c->mesh.vertices = c->vertices;
  c->mesh.point_count = copies * points;
  c->mesh.cell_count = copies * cells;
}

/* Turns a mesh of tetra_create() into a lattice of its n^3 boxes, whole ones, which draws the same cells. Its reference has no list. */
static inline void tetra_as_lattice(tetra_case* c, int n)
{
  c->mesh.lattice[0] = c->mesh.lattice[1] = c->mesh.lattice[2] = n + 1;
  c->mesh.vertices = NULL;
  c->mesh.cell_count = n * n * n;
}

static inline void tetra_destroy(tetra_case* c)
{
  free(c->points);
  free(c->values);
  free(c->vertices);
  free(c->hidden);
}

/* Set-up and tear-down of a group whose state is a context of the host. */
static inline int tetra_start(void** state)
{
  stratus_context* context = NULL;
  stratus_context_options options = stratus_context_options_default();
  options.device = "host";
  const stratus_status status = stratus_context_create(&options, &context, NULL, 0);
  *state = context;
  return status == STRATUS_OK ? 0 : -1;
}

static inline int tetra_stop(void** state)
{
  stratus_context_destroy(*state);
  return 0;
}

/* Sets the camera to scene camera number `view`, outside a cube of edge n. */
static inline void tetra_camera(stratus_context* context, tetra_case* c, int n, int view, int parallel)
{
  const double bounds[6] = { 0, n, 0, n, 0, n };
  assert_int_equal(stratus_scene_camera(context, bounds, 2, view, parallel, (double)TETRA_WIDTH / TETRA_HEIGHT, &c->camera), STRATUS_OK);
}

static inline void tetra_draw(stratus_context* context, const tetra_case* c, tetra_picture* p)
{
  stratus_tetra_caster* caster = NULL;
  memset(p, 0x5a, sizeof *p);
  const stratus_image image = { .width = TETRA_WIDTH,
    .height = TETRA_HEIGHT,
    .rgba = p->rgba,
    .depth = p->depth,
    .rgba8 = p->rgba8,
    .samples = p->samples,
    .opaque_depth = c->opaque_depth };
  assert_int_equal(stratus_tetra_caster_create(context, &caster), STRATUS_OK);
  const stratus_transfer* transfer = c->transfers ? c->transfers : &c->transfer;
  const stratus_status status = stratus_tetra_caster_render(caster, &c->mesh, transfer, &c->camera, &c->options, &image, &p->report);
  if (status != STRATUS_OK) {
    print_error("%s\n", stratus_context_message(context));
  }
  assert_int_equal(status, STRATUS_OK);
  assert_int_equal(p->report.method, tetra_method);
  stratus_tetra_caster_destroy(caster);
}

/* ---- the reference */

typedef struct tetra_stretch {
  double from, to, first, last;
} tetra_stretch;

static inline int tetra_nearer(const void* a, const void* b)
{
  const double d = ((const tetra_stretch*)a)->from - ((const tetra_stretch*)b)->from;
  return (d > 0) - (d < 0);
}

static inline double tetra_volume(const double a[3], const double b[3], const double c[3], const double d[3])
{
  double u[3], v[3], w[3];
  for (int i = 0; i < 3; ++i) {
    u[i] = b[i] - a[i];
    v[i] = c[i] - a[i];
    w[i] = d[i] - a[i];
  }
  return u[0] * (v[1] * w[2] - v[2] * w[1]) - u[1] * (v[0] * w[2] - v[2] * w[0]) + u[2] * (v[0] * w[1] - v[1] * w[0]);
}

/* Finds the stretch of the ray inside the cell. Each barycentric coordinate is linear along the ray. */
static inline int tetra_meet(
  const tetra_case* c, int64_t cell, const double origin[3], const double along[3], double from, double to, tetra_stretch* stretch)
{
  const int32_t* v = c->mesh.vertices + 4 * cell;
  const double* m = c->mesh.matrix;
  double p[4][3], value[4], coordinate[2][4];
  if (v[0] == v[1] || v[0] == v[2] || v[0] == v[3] || v[1] == v[2] || v[1] == v[3] || v[2] == v[3]) {
    return 0; /* no volume, whatever rounding makes of it */
  }
  for (int i = 0; i < 4; ++i) {
    for (int a = 0; a < 3; ++a) {
      const double* q = c->mesh.points + 3 * (int64_t)v[i];
      p[i][a] = m[4 * a] * q[0] + m[4 * a + 1] * q[1] + m[4 * a + 2] * q[2] + m[4 * a + 3] - origin[a];
    }
    value[i] = (double)c->values[c->mesh.cell_values ? cell : v[i]];
    if (!isfinite(value[i])) {
      return 0;
    }
  }
  const double whole = tetra_volume(p[0], p[1], p[2], p[3]);
  double size = 0.0;
  for (int i = 0; i < 9; ++i) {
    size = fmax(size, fabs(p[i / 3 + 1][i % 3] - p[0][i % 3]));
  }
  /* smaller volumes are rounding errors of a cell without volume */
  if ((c->mesh.hidden && c->mesh.hidden[cell]) || fabs(whole) <= 1e-14 * size * size * size) {
    return 0;
  }
  /* The ray is measured at its point nearest to the cell, and at a second point as far from there as the cell reaches. Points on another
   * scale would lose the cell's digits to rounding. */
  double reach = 0.0, nearest = 0.0, square = 0.0;
  for (int a = 0; a < 3; ++a) {
    nearest += 0.25 * (p[0][a] + p[1][a] + p[2][a] + p[3][a]) * along[a];
    square += along[a] * along[a];
  }
  nearest /= square;
  from -= nearest;
  to -= nearest;
  for (int i = 0; i < 4; ++i) {
    for (int a = 0; a < 3; ++a) {
      p[i][a] -= nearest * along[a];
    }
    reach = fmax(reach, sqrt((p[i][0] * p[i][0] + p[i][1] * p[i][1] + p[i][2] * p[i][2]) / square));
  }
  for (int i = 0; i < 4; ++i) {
    for (int end = 0; end < 2; ++end) {
      double q[4][3];
      memcpy(q, p, sizeof q);
      for (int a = 0; a < 3; ++a) {
        q[i][a] = end ? along[a] * reach : 0.0;
      }
      coordinate[end][i] = tetra_volume(q[0], q[1], q[2], q[3]) / whole;
    }
    const double start = coordinate[0][i], rise = (coordinate[1][i] - start) / reach;
    if (rise == 0.0 ? start < 0.0 : 0) {
      return 0;
    }
    from = rise > 0.0 ? fmax(from, -start / rise) : from;
    to = rise < 0.0 ? fmin(to, -start / rise) : to;
  }
  if (!(from < to)) {
    return 0;
  }
  *stretch = (tetra_stretch){ .from = nearest + from, .to = nearest + to };
  for (int i = 0; i < 4; ++i) {
    const double rise = (coordinate[1][i] - coordinate[0][i]) / reach;
    stretch->first += value[i] * (coordinate[0][i] + from * rise);
    stretch->last += value[i] * (coordinate[0][i] + to * rise);
  }
  return 1;
}

/* Gauss's points on 0..1, their weights, and the integrals of their Lagrange polynomials up to each point. */
#define TETRA_ROOT15 3.872983346207416885
static const double tetra_gauss[3] = { 0.5 - TETRA_ROOT15 / 10.0, 0.5, 0.5 + TETRA_ROOT15 / 10.0 };
static const double tetra_weights[3] = { 5.0 / 18.0, 4.0 / 9.0, 5.0 / 18.0 };
static const double tetra_partial[3][3] = { { 5.0 / 36.0, 2.0 / 9.0 - TETRA_ROOT15 / 15.0, 5.0 / 36.0 - TETRA_ROOT15 / 30.0 },
  { 5.0 / 36.0 + TETRA_ROOT15 / 24.0, 2.0 / 9.0, 5.0 / 36.0 - TETRA_ROOT15 / 24.0 },
  { 5.0 / 36.0 + TETRA_ROOT15 / 30.0, 2.0 / 9.0 + TETRA_ROOT15 / 15.0, 5.0 / 36.0 } };

/* Composites a part of a stretch by collocation at Gauss's points, of order 6. length: of the part, over the unit distance. opacity, color:
 * at the points. */
static inline void tetra_add_part(double length, const double opacity[3], double color[3][3], double rgba[4])
{
  double density[3], total = 0.0, sum = 0.0, glow[3] = { 0.0, 0.0, 0.0 };
  for (int g = 0; g < 3; ++g) {
    density[g] = opacity[g] < 1.0 ? -log1p(-fmax(opacity[g], 0.0)) : INFINITY;
    total += length * tetra_weights[g] * density[g];
  }
  for (int g = 0; g < 3; ++g) { /* the light that a point sends out of the part */
    const double* p = tetra_partial[g];
    const double before = length * (p[0] * density[0] + p[1] * density[1] + p[2] * density[2]);
    const double sent = isfinite(total) ? tetra_weights[g] * density[g] * exp(-before) : g == 0 ? 1.0 : 0.0;
    for (int k = 0; k < 3; ++k) {
      glow[k] += sent * color[g][k];
    }
    sum += sent;
  }
  const double alpha = -expm1(-total);
  for (int k = 0; k < 3 && sum > 0.0; ++k) {
    rgba[k] += (1.0 - rgba[3]) * alpha * glow[k] / sum;
  }
  rgba[3] += (1.0 - rgba[3]) * alpha;
}

/* Composites the piece a..b of a stretch, 0..1 being all of it, on which opacity and colour are linear. */
static inline void tetra_integrate_piece(
  const tetra_case* c, const tetra_stretch* s, double a, double b, double length, double rgba[4], double* depth)
{
  enum { PARTS_LEAST = 2, PARTS_MOST = 200 };
  const double way = (b - a) * (s->to - s->from) * length / c->transfer.unit_distance;
  double at[2][4], most = 0.0; /* at a quarter and at three quarters: the ends may be steps */
  for (int i = 0; i < 2; ++i) {
    const double x = s->first + (a + (0.25 + 0.5 * i) * (b - a)) * (s->last - s->first);
    at[i][0] = linear_between(c->transfer.opacity, c->transfer.opacity_count, 2, 1, x);
    for (size_t k = 1; k < 4; ++k) {
      at[i][k] = linear_between(c->transfer.color, c->transfer.color_count, 4, k, x);
    }
  }
  for (int i = 0; i < 2; ++i) {
    most = fmax(most, at[i][0] + 0.5 * (at[i][0] - at[1 - i][0]));
  }
  if (most <= 0.0) {
    return;
  }
  /* Parts of an optical depth of at most .5 err by some 1e-8. */
  const double deepest = most < 1.0 ? -2.0 * log1p(-most) * way : INFINITY;
  const int parts = (int)fmin(fmax(ceil(deepest), PARTS_LEAST), PARTS_MOST);
  for (int part = 0; part < parts && rgba[3] < 1.0 - 1e-12; ++part) {
    double opacity[3], color[3][3];
    for (int g = 0; g < 3; ++g) {
      const double t = 2.0 * ((part + tetra_gauss[g]) / parts - 0.25);
      opacity[g] = at[0][0] + t * (at[1][0] - at[0][0]);
      for (int k = 0; k < 3; ++k) {
        color[g][k] = at[0][k + 1] + t * (at[1][k + 1] - at[0][k + 1]);
      }
    }
    tetra_add_part(way / parts, opacity, color, rgba);
    if (rgba[3] > 0.0 && isinf(*depth)) {
      *depth = (s->from + (a + (b - a) * part / parts) * (s->to - s->from)) * length;
    }
  }
}

/* Composites a stretch in pieces that end where the value is a point of a function. */
static inline void tetra_integrate(const tetra_case* c, const tetra_stretch* s, double length, double rgba[4], double* depth)
{
  const size_t opacities = c->transfer.opacity_count, points = opacities + c->transfer.color_count;
  for (double a = 0.0, b = 1.0; a < 1.0 && rgba[3] < 1.0 - 1e-12; a = b) {
    b = 1.0;
    for (size_t i = 0; i < points; ++i) {
      const double point = i < opacities ? c->transfer.opacity[2 * i] : c->transfer.color[4 * (i - opacities)];
      const double t = (point - s->first) / (s->last - s->first);
      b = t > a && t < b ? t : b;
    }
    if (b - a > 1e-9) { /* shorter pieces are rounding's */
      tetra_integrate_piece(c, s, a, b, length, rgba, depth);
    }
  }
}

/* Finds a bounding ball of each cell, 4 numbers each: the mean of the corners in the world, and their largest squared distance from it. */
static inline void tetra_balls(const tetra_case* c, double* balls)
{
  const double* m = c->mesh.matrix;
  for (int64_t cell = 0; cell < c->mesh.cell_count; ++cell) {
    double p[4][3], *ball = balls + 4 * cell;
    memset(ball, 0, 4 * sizeof *ball);
    for (int i = 0; i < 4; ++i) {
      const double* q = c->mesh.points + 3 * (int64_t)c->mesh.vertices[4 * cell + i];
      for (int a = 0; a < 3; ++a) {
        p[i][a] = m[4 * a] * q[0] + m[4 * a + 1] * q[1] + m[4 * a + 2] * q[2] + m[4 * a + 3];
        ball[a] += 0.25 * p[i][a];
      }
    }
    for (int i = 0; i < 4; ++i) {
      double square = 0.0;
      for (int a = 0; a < 3; ++a) {
        square += (p[i][a] - ball[a]) * (p[i][a] - ball[a]);
      }
      ball[3] = fmax(ball[3], square);
    }
  }
}

/* Whether the line surely misses the ball, with a margin for rounding. No line misses a ball that is not finite. */
static inline bool tetra_passes(const double ball[4], const double origin[3], const double along[3])
{
  double square = 0.0, far = 0.0, forward = 0.0;
  for (int a = 0; a < 3; ++a) {
    const double d = ball[a] - origin[a];
    square += along[a] * along[a];
    far += d * d;
    forward += d * along[a];
  }
  return far - forward * forward / square > 1.01 * ball[3] + 1e-9 * far;
}

/* Cuts from..to of a ray at the plane with n (origin + t along) + d >= 0. */
static inline void tetra_cut(const double n[3], double d, const double origin[3], const double along[3], double* from, double* to)
{
  const double start = n[0] * origin[0] + n[1] * origin[1] + n[2] * origin[2] + d;
  const double rise = n[0] * along[0] + n[1] * along[1] + n[2] * along[2];
  *from = rise > 0.0 ? fmax(*from, -start / rise) : *from;
  *to = rise < 0.0 ? fmin(*to, -start / rise) : *to;
  *to = rise == 0.0 && start < 0.0 ? -INFINITY : *to;
}

/* Cuts a ray at clip planes and at the crop's box, whose sides are parallel to two axes of the mesh in the world. */
static inline void tetra_cut_ray(const tetra_case* c, const double origin[3], const double along[3], double* from, double* to)
{
  const double* m = c->mesh.matrix;
  const double axis[3][3] = { { m[0], m[4], m[8] }, { m[1], m[5], m[9] }, { m[2], m[6], m[10] } };
  for (int p = 0; p < c->options.clip_plane_count; ++p) {
    tetra_cut(c->options.clip_planes[p], c->options.clip_planes[p][3], origin, along, from, to);
  }
  for (int side = 0; c->options.crop && c->options.crop_regions == STRATUS_CROP_INSIDE && side < 6; ++side) {
    const double *u = axis[(side / 2 + 1) % 3], *v = axis[(side / 2 + 2) % 3], *w = axis[side / 2], bound = c->options.crop_bounds[side];
    double normal[3], across = 0.0, offset = 0.0, n[3];
    for (int a = 0; a < 3; ++a) {
      normal[a] = u[(a + 1) % 3] * v[(a + 2) % 3] - u[(a + 2) % 3] * v[(a + 1) % 3];
      across += normal[a] * w[a];
    }
    for (int a = 0; a < 3; ++a) {
      n[a] = (side & 1 ? -1.0 : 1.0) * normal[a] / across;
      offset += n[a] * m[4 * a + 3];
    }
    tetra_cut(n, -offset - (side & 1 ? -1.0 : 1.0) * bound, origin, along, from, to);
  }
}

/* A place's coordinate along an axis of the mesh, by volumes of the moved axes. */
static inline double tetra_local(const tetra_case* c, int axis, const double place[3])
{
  static const double zero[3] = { 0.0, 0.0, 0.0 };
  const double* m = c->mesh.matrix;
  double column[3][3], to[3];
  for (int a = 0; a < 3; ++a) {
    for (int i = 0; i < 3; ++i) {
      column[i][a] = m[4 * a + i];
    }
    to[a] = place[a] - m[4 * a + 3];
  }
  const double whole = tetra_volume(zero, column[0], column[1], column[2]);
  memcpy(column[axis], to, sizeof to);
  return tetra_volume(zero, column[0], column[1], column[2]) / whole;
}

/* Cuts a stretch at the planes between crop regions. Returns how many of its parts are in regions that show, and stores these. */
static inline size_t tetra_crop(
  const tetra_case* c, const double origin[3], const double along[3], const tetra_stretch* whole, tetra_stretch parts[7])
{
  double cuts[8] = { 0.0, 1.0 }, ends[2][3], local[2][3];
  int count = 2;
  size_t shown = 0;
  if (!c->options.crop || c->options.crop_regions == STRATUS_CROP_INSIDE) {
    parts[0] = *whole;
    return 1;
  }
  for (int end = 0; end < 2; ++end) {
    for (int a = 0; a < 3; ++a) {
      ends[end][a] = origin[a] + (end ? whole->to : whole->from) * along[a];
    }
    for (int a = 0; a < 3; ++a) {
      local[end][a] = tetra_local(c, a, ends[end]);
    }
  }
  for (int side = 0; side < 6; ++side) {
    const double a = local[0][side / 2], b = local[1][side / 2], t = (c->options.crop_bounds[side] - a) / (b - a);
    if (t > 0.0 && t < 1.0) {
      int at = count++;
      for (; cuts[at - 1] > t; --at) {
        cuts[at] = cuts[at - 1];
      }
      cuts[at] = t;
    }
  }
  for (int i = 0; i + 1 < count; ++i) {
    const double middle = 0.5 * (cuts[i] + cuts[i + 1]), extent = whole->to - whole->from, rise = whole->last - whole->first;
    int region = 0;
    for (int a = 2; a >= 0; --a) {
      const double x = local[0][a] + middle * (local[1][a] - local[0][a]), *bounds = c->options.crop_bounds + 2 * a;
      region = 3 * region + (x < bounds[0] ? 0 : x > bounds[1] ? 2 : 1);
    }
    if (cuts[i] < cuts[i + 1] && c->options.crop_regions >> region & 1u) {
      parts[shown++] = (tetra_stretch){ whole->from + cuts[i] * extent, whole->from + cuts[i + 1] * extent, whole->first + cuts[i] * rise,
        whole->first + cuts[i + 1] * rise };
    }
  }
  return shown;
}

/* The least and greatest value of cells that show. */
static inline void tetra_range(const tetra_case* c, double range[2])
{
  range[0] = INFINITY;
  range[1] = -INFINITY;
  for (int64_t cell = 0; cell < c->mesh.cell_count; ++cell) {
    double lo = INFINITY, hi = -INFINITY, sum = 0.0;
    for (int i = 0; i < 4; ++i) {
      const double value = (double)c->values[c->mesh.cell_values ? cell : c->mesh.vertices[4 * cell + i]];
      lo = fmin(lo, value);
      hi = fmax(hi, value);
      sum += value;
    }
    if (isfinite(sum) && !(c->mesh.hidden && c->mesh.hidden[cell])) {
      range[0] = fmin(range[0], lo);
      range[1] = fmax(range[1], hi);
    }
  }
}

/* The mean or the sum of opacity times value along the stretches of a ray. */
static inline void tetra_sum(
  const tetra_case* c, const tetra_stretch* met, size_t count, double length, const double range[2], double rgba[4])
{
  enum { STEPS = 200 };
  const bool mean = c->options.mode == STRATUS_TETRA_AVERAGE;
  double sum = 0.0, counted = 0.0;
  for (size_t i = 0; i < count; ++i) {
    const tetra_stretch* s = met + i;
    double begin = 0.0, end = 1.0;
    if (mean) { /* only the parts with values in the range */
      const double rise = s->last - s->first, low = c->options.average_range[0], high = c->options.average_range[1];
      const double a = (low - s->first) / rise, b = (high - s->first) / rise;
      const bool level = rise == 0.0, counts = s->first >= low && s->first <= high;
      begin = level ? 0.0 : fmax(begin, fmin(a, b));
      end = level ? (double)counts : fmin(end, fmax(a, b));
    }
    for (int step = 0; step < STEPS && begin < end; ++step) {
      const double t = begin + (step + 0.5) / STEPS * (end - begin), x = s->first + t * (s->last - s->first);
      const double part = (end - begin) * (s->to - s->from) * length / STEPS;
      const double a = linear_between(c->transfer.opacity, c->transfer.opacity_count, 2, 1, x);
      sum += range[1] > range[0] ? a * (x - range[0]) / (range[1] - range[0]) * part : 0.0;
      counted += part;
    }
  }
  if (counted > 0.0) {
    rgba[0] = rgba[1] = rgba[2] = fmin(sum / (mean ? counted : c->transfer.unit_distance), 1.0);
    rgba[3] = 1.0;
  }
}

/* The surfaces that a stretch of a ray passes. */
static inline void tetra_contours(const tetra_case* c, const tetra_stretch* s, double length, double rgba[4], double* depth)
{
  double done = -1.0;
  for (;;) { /* the next along the stretch */
    double next = 2.0, value = 0.0;
    for (int n = 0; n < c->options.contour_count; ++n) {
      const double contour = c->options.contours[n], at = (contour - s->first) / (s->last - s->first);
      if ((s->first < contour) != (s->last < contour) && at > done && at < next) {
        next = at;
        value = contour;
      }
    }
    if (next > 1.0) {
      return;
    }
    const double a = linear_between(c->transfer.opacity, c->transfer.opacity_count, 2, 1, value);
    for (size_t k = 0; k < 3; ++k) {
      rgba[k] += (1.0 - rgba[3]) * a * linear_between(c->transfer.color, c->transfer.color_count, 4, k + 1, value);
    }
    rgba[3] += (1.0 - rgba[3]) * a;
    *depth = a > 0.0 && isinf(*depth) ? (s->from + next * (s->to - s->from)) * length : *depth;
    done = next;
  }
}

/* The slice's function at a point of a ray. */
static inline double tetra_slice_at(const stratus_slice* f, const double origin[3], const double along[3], double t)
{
  double d[3], sum = f->constant;
  for (int a = 0; a < 3; ++a) {
    d[a] = origin[a] + t * along[a] - f->center[a];
  }
  for (int a = 0; a < 3; ++a) {
    sum += d[a] * (f->linear[a] + f->square[a] * d[a] + f->square[3 + a] * d[(a + 1) % 3]);
  }
  return sum;
}

/* The values on the slice that a stretch of a ray shows. Along it the function is a parabola, which is cut at its vertex and bisected. */
static inline void tetra_slices(
  const tetra_case* c, const tetra_stretch* s, const double origin[3], const double along[3], double length, double rgba[4], double* depth)
{
  const stratus_slice* f = &c->options.slice;
  const double middle = 0.5 * (s->from + s->to), half = 0.5 * (s->to - s->from);
  const double a = tetra_slice_at(f, origin, along, s->from), b = tetra_slice_at(f, origin, along, middle),
               e = tetra_slice_at(f, origin, along, s->to), bend = a - 2.0 * b + e;
  const double vertex = fmin(fmax(bend == 0.0 ? s->from : middle + 0.5 * half * (a - e) / bend, s->from), s->to);
  const double ends[3] = { s->from, vertex, s->to };
  for (int part = 0; part < 2; ++part) {
    double lo = ends[part], hi = ends[part + 1];
    const int below = tetra_slice_at(f, origin, along, lo) < 0.0;
    if (!(lo < hi) || below == (tetra_slice_at(f, origin, along, hi) < 0.0)) {
      continue;
    }
    for (int step = 0; step < 60; ++step) {
      const double at = 0.5 * (lo + hi);
      *((tetra_slice_at(f, origin, along, at) < 0.0) == below ? &lo : &hi) = at;
    }
    const double x = s->first + (lo - s->from) / (s->to - s->from) * (s->last - s->first);
    const double alpha = linear_between(c->transfer.opacity, c->transfer.opacity_count, 2, 1, x);
    for (size_t k = 0; k < 3; ++k) {
      rgba[k] += (1.0 - rgba[3]) * alpha * linear_between(c->transfer.color, c->transfer.color_count, 4, k + 1, x);
    }
    rgba[3] += (1.0 - rgba[3]) * alpha;
    *depth = alpha > 0.0 && isinf(*depth) ? lo * length : *depth;
  }
}

/* Draws the reference. rgba: 4*TETRA_PIXELS; depth: TETRA_PIXELS or NULL. */
static inline void tetra_reference(const tetra_case* c, double* rgba, double* depth)
{
  tetra_stretch *met = calloc(7 * ((size_t)c->mesh.cell_count + 1), sizeof *met), whole;
  double* balls = malloc(((size_t)c->mesh.cell_count + 1) * 4 * sizeof *balls);
  assert_non_null(met);
  assert_non_null(balls);
  double range[2];
  tetra_balls(c, balls);
  tetra_range(c, range);
  for (int pixel = 0; pixel < TETRA_PIXELS; ++pixel) {
    const double u = (2.0 * (pixel % TETRA_WIDTH) + 1.0) / TETRA_WIDTH - 1.0, v = (2.0 * (pixel / TETRA_WIDTH) + 1.0) / TETRA_HEIGHT - 1.0;
    const stratus_camera* k = &c->camera;
    double origin[3], along[3], from = k->near_k, to = k->far_k, first = INFINITY, *out = rgba + 4 * pixel;
    size_t count = 0;
    for (int a = 0; a < 3; ++a) {
      const double side = u * k->right[a] + v * k->up[a];
      origin[a] = k->eye[a] + (k->parallel ? side : 0.0);
      along[a] = k->forward[a] + (k->parallel ? 0.0 : side);
    }
    if (c->opaque_depth) {
      const double d = (double)c->opaque_depth[pixel];
      to = k->parallel ? k->near_k + d * (k->far_k - k->near_k) : k->near_k * k->far_k / (k->far_k - d * (k->far_k - k->near_k));
    }
    tetra_cut_ray(c, origin, along, &from, &to);
    for (int64_t cell = 0; cell < c->mesh.cell_count; ++cell) {
      if (!tetra_passes(balls + 4 * cell, origin, along) && tetra_meet(c, cell, origin, along, from, to, &whole)) {
        count += tetra_crop(c, origin, along, &whole, met + count);
      }
    }
    qsort(met, count, sizeof *met, tetra_nearer);
    memset(out, 0, 4 * sizeof *out);
    const double length = sqrt(along[0] * along[0] + along[1] * along[1] + along[2] * along[2]);
    const double sign = c->options.mode == STRATUS_TETRA_MINIMUM ? -1.0 : 1.0;
    double largest = -INFINITY;
    for (size_t i = 0; i < count; ++i) {
      largest = fmax(largest, fmax(sign * met[i].first, sign * met[i].last));
      if (c->options.mode == STRATUS_TETRA_ISOSURFACE) {
        tetra_contours(c, met + i, length, out, &first);
      }
      if (c->options.mode == STRATUS_TETRA_SLICE) {
        tetra_slices(c, met + i, origin, along, length, out, &first);
      }
      if (c->options.mode == STRATUS_TETRA_COMPOSITE) {
        tetra_integrate(c, met + i, length, out, &first);
      }
    }
    if (c->options.mode == STRATUS_TETRA_AVERAGE || c->options.mode == STRATUS_TETRA_ADDITIVE) {
      tetra_sum(c, met, count, length, range, out);
    }
    if ((c->options.mode == STRATUS_TETRA_MAXIMUM || c->options.mode == STRATUS_TETRA_MINIMUM) && count > 0) {
      largest *= sign;
      out[3] = linear_between(c->transfer.opacity, c->transfer.opacity_count, 2, 1, largest);
      for (size_t i = 0; i < 3; ++i) {
        out[i] = out[3] * linear_between(c->transfer.color, c->transfer.color_count, 4, i + 1, largest);
      }
    }
    if (depth) {
      depth[pixel] = first;
    }
  }
  free(met);
  free(balls);
}

/* Returns the root mean square error of RGBA in 0..255 over the pixels that either picture shows. */
static inline double tetra_error(const float* rgba, const double* reference, double* largest)
{
  double squares = 0.0, count = 0.0;
  *largest = 0.0;
  for (int pixel = 0; pixel < TETRA_PIXELS; ++pixel) {
    if (rgba[4 * pixel + 3] > 0.0f || reference[4 * pixel + 3] > 0.0) {
      for (int c = 0; c < 4; ++c) {
        const double d = 255.0 * ((double)rgba[4 * pixel + c] - reference[4 * pixel + c]);
        squares += d * d;
        *largest = fmax(*largest, isfinite(d) ? fabs(d) : INFINITY);
        count += 1.0;
      }
    }
  }
  return count > 0.0 ? sqrt(squares / count) : INFINITY; /* two empty pictures do not count as agreement */
}

#endif
