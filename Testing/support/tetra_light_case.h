/* SPDX-License-Identifier: BSD-3-Clause
 * The reference of tetrahedra that are lit or thinned by the gradient, written from the contract in stratus/tetrahedra.h in doubles. It
 * works in the world: gradients come from the moved and stretched mesh, so that no matrix is inverted or transposed. */
#ifndef STRATUS_TESTING_TETRA_LIGHT_CASE_H
#define STRATUS_TESTING_TETRA_LIGHT_CASE_H

#include "tetra_case.h"

/* Points and their gradients in one space. */
typedef struct tetra_space {
  double (*points)[3], (*gradients)[3];
  double spacing; /* the edge of a cube that six cells of the mean volume fill */
} tetra_space;

static inline void tetra_solve(const double m[3][3], const double right[3], double out[3])
{
  const double* z = (const double[3]){ 0.0, 0.0, 0.0 };
  const double whole = tetra_volume(z, m[0], m[1], m[2]);
  double columns[3][3];
  for (int i = 0; i < 3; ++i) { /* Cramer's rule on the transpose */
    double n[3][3];
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 3; ++column) {
        n[row][column] = column == i ? right[row] : m[row][column];
      }
    }
    memcpy(columns, n, sizeof n);
    out[i] = tetra_volume(z, columns[0], columns[1], columns[2]) / whole;
  }
}

static inline bool tetra_cell_shows(const tetra_case* c, int64_t cell)
{
  bool shows = !(c->mesh.hidden && c->mesh.hidden[cell]);
  for (int i = 0; i < 4; ++i) {
    shows = shows && isfinite(c->values[c->mesh.cell_values ? cell : c->mesh.vertices[4 * cell + i]]);
  }
  return shows;
}

/* Adds weight times value to all points of a cell. */
static inline void tetra_spread(const tetra_case* c, int64_t cell, double weight, const double value[3], double (*sums)[4])
{
  for (int i = 0; i < 4; ++i) {
    double* sum = sums[c->mesh.vertices[4 * cell + i]];
    for (int a = 0; a < 3; ++a) {
      sum[a] += weight * value[a];
    }
    sum[3] += weight;
  }
}

/* world 0: local coordinates. */
static inline tetra_space tetra_space_create(const tetra_case* c, int world)
{
  const int64_t count = c->mesh.point_count;
  const double* m = c->mesh.matrix;
  tetra_space space = { calloc((size_t)count, sizeof *space.points), calloc((size_t)count, sizeof *space.gradients), 0.0 };
  double(*sums)[4] = calloc((size_t)count, sizeof *sums), *values = calloc((size_t)count, sizeof *values), all = 0.0, cells = 0.0;
  assert_true(space.points && space.gradients && sums && values);
  for (int64_t i = 0; i < count; ++i) {
    const double* p = c->mesh.points + 3 * i;
    for (int a = 0; a < 3; ++a) {
      space.points[i][a] = world ? m[4 * a] * p[0] + m[4 * a + 1] * p[1] + m[4 * a + 2] * p[2] + m[4 * a + 3] : p[a];
    }
    values[i] = (double)c->values[i];
  }
  for (int pass = c->mesh.cell_values ? 0 : 1; pass < 2; ++pass) {
    memset(sums, 0, (size_t)count * sizeof *sums);
    for (int64_t cell = 0; cell < c->mesh.cell_count; ++cell) {
      const int32_t* v = c->mesh.vertices + 4 * cell;
      const double volume = fabs(tetra_volume(space.points[v[0]], space.points[v[1]], space.points[v[2]], space.points[v[3]]));
      double edge[3][3], rise[3], g[3] = { 0.0, 0.0, 0.0 };
      if (!tetra_cell_shows(c, cell) || volume == 0.0) {
        continue;
      }
      for (int i = 0; i < 3; ++i) {
        for (int a = 0; a < 3; ++a) {
          edge[i][a] = space.points[v[i + 1]][a] - space.points[v[0]][a];
        }
        rise[i] = values[v[i + 1]] - values[v[0]];
      }
      if (pass == 0) {
        g[0] = (double)c->values[cell];
      } else {
        tetra_solve((const double(*)[3])edge, rise, g);
        all += volume;
        cells += 1.0;
      }
      tetra_spread(c, cell, volume, g, sums);
    }
    for (int64_t i = 0; i < count; ++i) {
      for (int a = 0; a < 3 && sums[i][3] > 0.0; ++a) {
        space.gradients[i][a] = sums[i][a] / sums[i][3];
      }
      values[i] = pass == 0 && sums[i][3] > 0.0 ? sums[i][0] / sums[i][3] : values[i];
    }
  }
  space.spacing = cbrt(all / cells);
  free(sums);
  free(values);
  return space;
}

static inline void tetra_space_destroy(tetra_space* space)
{
  free(space->points);
  free(space->gradients);
}

/* The gradient of `space` in a cell, at the place p of the world. */
static inline void tetra_gradient_at(
  const tetra_case* c, const tetra_space* world, const tetra_space* space, int64_t cell, const double p[3], double g[3])
{
  const int32_t* v = c->mesh.vertices + 4 * cell;
  const double* q[4] = { world->points[v[0]], world->points[v[1]], world->points[v[2]], world->points[v[3]] };
  const double whole = tetra_volume(q[0], q[1], q[2], q[3]);
  memset(g, 0, 3 * sizeof *g);
  for (int i = 0; i < 4; ++i) {
    const double* o[4] = { q[0], q[1], q[2], q[3] };
    o[i] = p;
    const double weight = tetra_volume(o[0], o[1], o[2], o[3]) / whole;
    for (int a = 0; a < 3; ++a) {
      g[a] += weight * space->gradients[v[i]][a];
    }
  }
}

static inline double tetra_dot(const double a[3], const double b[3])
{
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline void tetra_unit(double v[3])
{
  const double length = sqrt(tetra_dot(v, v));
  for (int a = 0; a < 3; ++a) {
    v[a] = length > 0.0 ? v[a] / length : 0.0;
  }
}

/* Computes the lit colour for a colour of opacity 1 at the place p of a ray. */
static inline void tetra_illuminate(const tetra_case* c, const double p[3], const double along[3], const double g[3], double rgb[3])
{
  const stratus_shading* s = &c->options.shading;
  double normal[3] = { -g[0], -g[1], -g[2] }, ray[3] = { along[0], along[1], along[2] };
  double diffuse[3] = { s->ambient, s->ambient, s->ambient }, specular[3] = { 0.0, 0.0, 0.0 };
  tetra_unit(normal);
  tetra_unit(ray);
  const double turn = !s->one_sided && tetra_dot(normal, ray) > 0.0 ? -1.0 : 1.0;
  stratus_light eye = { .color = { 1.0, 1.0, 1.0 }, .positional = !c->camera.parallel };
  for (int a = 0; a < 3; ++a) {
    eye.vector[a] = c->camera.parallel ? -c->camera.forward[a] : c->camera.eye[a];
    normal[a] *= turn;
  }
  for (int i = 0; i < (s->light_count < 0 ? 1 : s->light_count); ++i) {
    const stratus_light* light = s->light_count < 0 ? &eye : s->lights + i;
    double to[3], half_way[3], part = 1.0;
    for (int a = 0; a < 3; ++a) {
      to[a] = light->vector[a] - (light->positional ? p[a] : 0.0);
    }
    const double *k = light->attenuation, r = sqrt(tetra_dot(to, to));
    if (light->positional && k[0] + k[1] + k[2] > 0.0) {
      part = 1.0 / (k[0] + k[1] * r + k[2] * r * r);
    }
    tetra_unit(to);
    for (int a = 0; a < 3; ++a) {
      half_way[a] = to[a] - ray[a];
    }
    tetra_unit(half_way);
    const double cosine = tetra_dot(normal, to), gloss = tetra_dot(normal, half_way);
    const double* shine = light->separate_specular ? light->specular_color : light->color;
    for (int a = 0; a < 3 && cosine > 0.0; ++a) {
      diffuse[a] += part * s->diffuse * cosine * light->color[a];
      specular[a] += gloss > 0.0 ? part * s->specular * pow(gloss, s->specular_power) * shine[a] : 0.0;
    }
  }
  for (int a = 0; a < 3; ++a) {
    rgb[a] = rgb[a] * diffuse[a] + specular[a];
  }
}

typedef struct tetra_lit_stretch {
  tetra_stretch stretch;
  int64_t cell;
} tetra_lit_stretch;

/* Shades one place of a ray, of the opacity `alpha` there, and adds it. */
static inline void tetra_add_lit(const tetra_case* c, const tetra_space* world, int64_t cell, const double p[3], const double along[3],
  double value, double alpha, double out[4])
{
  double g[3], rgb[3];
  for (size_t k = 0; k < 3; ++k) {
    rgb[k] = linear_between(c->transfer.color, c->transfer.color_count, 4, k + 1, value);
  }
  if (c->options.shade) {
    tetra_gradient_at(c, world, world, cell, p, g);
    tetra_illuminate(c, p, along, g, rgb);
  }
  for (int k = 0; k < 3; ++k) {
    out[k] += (1.0 - out[3]) * alpha * rgb[k];
  }
  out[3] += (1.0 - out[3]) * alpha;
}

/* The opacity of a step of length `way` at a place. */
static inline double tetra_thinned(
  const tetra_case* c, const tetra_space* world, const tetra_space* local, int64_t cell, const double p[3], double value, double way)
{
  const double a = linear_between(c->transfer.opacity, c->transfer.opacity_count, 2, 1, value);
  const double asked = c->options.gradient_distance, *m = c->mesh.matrix;
  const double stretched = cbrt(fabs(tetra_volume((const double[3]){ 0, 0, 0 }, m, m + 4, m + 8)));
  const double d = asked < 0.0 ? 0.5 * local->spacing * stretched : asked;
  double per_length = -log1p(-fmin(a, 1.0 - 1e-15)) / c->transfer.unit_distance, factor = 1.0, g[3];
  if (c->transfer.gradient_count > 0) {
    tetra_gradient_at(c, world, local, cell, p, g);
    factor = linear_between(c->transfer.gradient, c->transfer.gradient_count, 2, 1, sqrt(tetra_dot(g, g)) * local->spacing);
  }
  if (a >= 1.0 && (d == 0.0 || factor >= 1.0)) {
    return factor > 0.0 ? 1.0 : 0.0;
  }
  per_length = d > 0.0 ? -log1p(factor * expm1(-per_length * d)) / d : factor * per_length;
  return -expm1(-per_length * way);
}

static inline void tetra_integrate_lit(const tetra_case* c, const tetra_space* world, const tetra_space* local, const tetra_lit_stretch* s,
  const double origin[3], const double along[3], double out[4])
{
  enum { STEPS = 100 };
  const double length = sqrt(tetra_dot(along, along)), first = s->stretch.first, rise = s->stretch.last - first;
  for (int i = 0; i < STEPS && c->options.mode == STRATUS_TETRA_COMPOSITE; ++i) {
    const double t = (i + 0.5) / STEPS, at = s->stretch.from + t * (s->stretch.to - s->stretch.from), value = first + t * rise;
    const double p[3] = { origin[0] + at * along[0], origin[1] + at * along[1], origin[2] + at * along[2] };
    const double alpha = tetra_thinned(c, world, local, s->cell, p, value, (s->stretch.to - s->stretch.from) * length / STEPS);
    if (alpha > 0.0) {
      tetra_add_lit(c, world, s->cell, p, along, value, alpha, out);
    }
  }
  double done = -1.0;
  for (; c->options.mode == STRATUS_TETRA_ISOSURFACE;) { /* the next along the stretch */
    double next = 2.0, value = 0.0;
    for (int n = 0; n < c->options.contour_count; ++n) {
      const double contour = c->options.contours[n], t = (contour - first) / rise;
      if ((first < contour) != (s->stretch.last < contour) && t > done && t < next) {
        next = t;
        value = contour;
      }
    }
    if (next > 1.0) {
      return;
    }
    const double at = s->stretch.from + next * (s->stretch.to - s->stretch.from);
    const double p[3] = { origin[0] + at * along[0], origin[1] + at * along[1], origin[2] + at * along[2] };
    tetra_add_lit(c, world, s->cell, p, along, value, linear_between(c->transfer.opacity, c->transfer.opacity_count, 2, 1, value), out);
    done = next;
  }
}

static inline int tetra_lit_nearer(const void* a, const void* b)
{
  return tetra_nearer(&((const tetra_lit_stretch*)a)->stretch, &((const tetra_lit_stretch*)b)->stretch);
}

/* The case with the functions of a cell's label. */
static inline tetra_case tetra_of_label(const tetra_case* c, int64_t cell)
{
  tetra_case own = *c;
  if (c->transfers) {
    const int label = c->mesh.labels[cell];
    own.transfer = c->transfers[label <= c->options.label_count ? label : 0];
    if (own.transfer.gradient_count == 0) {
      own.transfer.gradient = c->transfers[0].gradient;
      own.transfer.gradient_count = c->transfers[0].gradient_count;
    }
  }
  return own;
}

/* Draws the reference, 4*TETRA_PIXELS. Light may be above 1. */
static inline void tetra_reference_lit(const tetra_case* c, double* rgba)
{
  tetra_lit_stretch* met = calloc((size_t)c->mesh.cell_count + 1, sizeof *met);
  tetra_space world = tetra_space_create(c, 1), local = tetra_space_create(c, 0);
  assert_non_null(met);
  for (int pixel = 0; pixel < TETRA_PIXELS; ++pixel) {
    const double u = (2.0 * (pixel % TETRA_WIDTH) + 1.0) / TETRA_WIDTH - 1.0, v = (2.0 * (pixel / TETRA_WIDTH) + 1.0) / TETRA_HEIGHT - 1.0;
    const stratus_camera* k = &c->camera;
    double origin[3], along[3], from = k->near_k, to = k->far_k, *out = rgba + 4 * pixel;
    size_t count = 0;
    for (int a = 0; a < 3; ++a) {
      const double side = u * k->right[a] + v * k->up[a];
      origin[a] = k->eye[a] + (k->parallel ? side : 0.0);
      along[a] = k->forward[a] + (k->parallel ? 0.0 : side);
    }
    tetra_cut_ray(c, origin, along, &from, &to);
    for (int64_t cell = 0; cell < c->mesh.cell_count; ++cell) {
      met[count].cell = cell;
      count += (size_t)tetra_meet(c, cell, origin, along, from, to, &met[count].stretch);
    }
    qsort(met, count, sizeof *met, tetra_lit_nearer);
    memset(out, 0, 4 * sizeof *out);
    for (size_t i = 0; i < count; ++i) {
      const tetra_case own = tetra_of_label(c, met[i].cell);
      if (own.options.mode == STRATUS_TETRA_COMPOSITE && !own.options.shade && own.transfer.gradient_count == 0) {
        double first = INFINITY; /* by finer quadrature, as functions may be narrow or opaque */
        tetra_integrate(&own, &met[i].stretch, sqrt(tetra_dot(along, along)), out, &first);
      } else {
        tetra_integrate_lit(&own, &world, &local, met + i, origin, along, out);
      }
    }
  }
  tetra_space_destroy(&world);
  tetra_space_destroy(&local);
  free(met);
}

#endif
