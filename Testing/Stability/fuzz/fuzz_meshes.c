/* SPDX-License-Identifier: BSD-3-Clause
 * Meshes of tetrahedra: lattices, with holes, bent and shuffled, and random cells that overlap, are flat, or name a point twice. */
#include "fuzz.h"

#include <stdlib.h>

typedef struct draft {
  double* points;
  int32_t* vertices;
  int64_t point_count, cell_count;
} draft;

static const int32_t cube[6][4] = { { 0, 1, 3, 7 }, { 0, 1, 7, 5 }, { 0, 5, 7, 4 }, { 0, 3, 2, 7 }, { 0, 2, 6, 7 }, { 0, 6, 4, 7 } };

static draft make_lattice(fuzz* f, int largest)
{
  const int n[3] = { 1 + (int)fuzz_below(f, (uint64_t)largest), 1 + (int)fuzz_below(f, (uint64_t)largest),
    1 + (int)fuzz_below(f, (uint64_t)largest) };
  const double bend = fuzz_chance(f, 0.5) ? 0.0 : 0.1, kept = fuzz_chance(f, 0.6) ? 1.0 : fuzz_between(f, 0.2, 1.0);
  const double scale = fuzz_chance(f, 0.8) ? 1.0 : fuzz_scale(f, 1e-6, 1e6), offset = fuzz_chance(f, 0.9) ? 0.0 : 1e4 * scale;
  draft d = { .point_count = (int64_t)(n[0] + 1) * (n[1] + 1) * (n[2] + 1) };
  d.points = malloc((size_t)d.point_count * 3 * sizeof *d.points);
  d.vertices = malloc((size_t)n[0] * (size_t)n[1] * (size_t)n[2] * 24 * sizeof *d.vertices);
  for (int64_t p = 0; p < d.point_count; ++p) {
    const int64_t at[3] = { p % (n[0] + 1), p / (n[0] + 1) % (n[1] + 1), p / ((int64_t)(n[0] + 1) * (n[1] + 1)) };
    for (int axis = 0; axis < 3; ++axis) {
      d.points[3 * p + axis] = scale * ((double)at[axis] + bend * fuzz_between(f, -1.0, 1.0)) + offset;
    }
  }
  for (int c = 0; c < 6 * n[0] * n[1] * n[2]; ++c) {
    const int x = c / 6 % n[0], y = c / 6 / n[0] % n[1], z = c / 6 / (n[0] * n[1]);
    if (!fuzz_chance(f, kept) && d.cell_count > 0) {
      continue;
    }
    for (int v = 0; v < 4; ++v) {
      const int corner = cube[c % 6][v];
      d.vertices[4 * d.cell_count + v] = (x + (corner & 1)) + (n[0] + 1) * ((y + (corner >> 1 & 1)) + (n[1] + 1) * (z + (corner >> 2)));
    }
    ++d.cell_count;
  }
  return d;
}

static draft make_soup(fuzz* f, int largest)
{
  draft d = { .point_count = 4 + (int64_t)fuzz_below(f, (uint64_t)(8 * largest)),
    .cell_count = (int64_t)fuzz_below(f, (uint64_t)(12 * largest)) };
  const double flat = fuzz_chance(f, 0.5) ? 0.0 : 0.5, steps = fuzz_chance(f, 0.5) ? 0.0 : 3.0;
  d.points = malloc((size_t)d.point_count * 3 * sizeof *d.points);
  d.vertices = malloc((size_t)d.cell_count * 4 * sizeof *d.vertices + 1);
  for (int64_t i = 0; i < 3 * d.point_count; ++i) {
    d.points[i] = fuzz_between(f, 0.0, 4.0);
    d.points[i] = steps > 0.0 ? floor(d.points[i]) : d.points[i]; /* coplanar points, many in one place */
  }
  for (int64_t c = 0; c < d.cell_count; ++c) {
    for (int v = 0; v < 4; ++v) {
      d.vertices[4 * c + v] = (int32_t)fuzz_below(f, (uint64_t)d.point_count);
    }
    if (fuzz_chance(f, 0.3 * flat)) {
      d.vertices[4 * c + 3] = d.vertices[4 * c];
    }
  }
  return d;
}

static void shuffle(fuzz* f, draft* d)
{
  for (int64_t c = d->cell_count; c-- > 1;) {
    const int64_t with = (int64_t)fuzz_below(f, (uint64_t)c + 1);
    int32_t cell[4];
    memcpy(cell, d->vertices + 4 * c, sizeof cell);
    memcpy(d->vertices + 4 * c, d->vertices + 4 * with, sizeof cell);
    memcpy(d->vertices + 4 * with, cell, sizeof cell);
    if (fuzz_chance(f, 0.3)) { /* the other orientation */
      const int32_t first = d->vertices[4 * c];
      d->vertices[4 * c] = d->vertices[4 * c + 1];
      d->vertices[4 * c + 1] = first;
    }
  }
}

/* Makes a point's coordinate or a cell's point number invalid. */
static void spoil(fuzz* f, draft* d)
{
  for (int64_t i = 0; i < 3 * d->point_count && i < 60; ++i) {
    if (fuzz_odd(f)) {
      d->points[i] = fuzz_odd_real(f);
    }
  }
  for (int64_t i = 0; i < 4 * d->cell_count && i < 60; ++i) {
    d->vertices[i] = fuzz_odd(f) ? (int32_t)(uint32_t)(uint64_t)fuzz_odd_integer(f) : d->vertices[i];
  }
}

/* Adds values of points or cells, made as a volume's are. */
static void add_values(fuzz* f, fuzz_tetrahedra* t)
{
  stratus_mesh* m = &t->view;
  m->cell_values = fuzz_chance(f, 0.3);
  const int64_t count = m->cell_values ? m->cell_count : m->point_count;
  if (count > 0) {
    t->row = fuzz_row(f, count);
    m->values = t->row.view.values;
    m->type = t->row.view.type;
    m->value_stride = t->row.view.value_stride;
    t->low = t->row.low;
    t->high = t->row.high;
  }
}

void fuzz_mesh_changes(fuzz* f, fuzz_tetrahedra* mesh)
{
  if (mesh->view.values && fuzz_is_tame(f)) {
    fuzz_row_changes(f, &mesh->row);
    ++mesh->view.revision;
  }
}

static void add_hidden(fuzz* f, stratus_mesh* m)
{
  uint8_t* hidden = malloc((size_t)m->cell_count + 1);
  for (int64_t c = 0; c < m->cell_count; ++c) {
    hidden[c] = (uint8_t)(fuzz_chance(f, 0.2) ? 1 + fuzz_below(f, 255) : 0);
  }
  m->hidden = fuzz_input(f, hidden, (size_t)m->cell_count);
  free(hidden);
}

/* Measures the mesh's bounds in the world; 0..1 along each axis if they are unknown. */
static void look_at(fuzz_tetrahedra* t)
{
  const stratus_mesh* m = &t->view;
  double width = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    double low = INFINITY, high = -INFINITY;
    for (int64_t p = 0; m->points && p < m->point_count; ++p) {
      const double* from = m->points + 3 * p;
      const double* row = m->matrix + 4 * axis;
      const double at = row[0] * from[0] + row[1] * from[1] + row[2] * from[2] + row[3];
      low = fmin(low, at);
      high = fmax(high, at);
    }
    const bool known = isfinite(low) && isfinite(high) && high > low && high - low < 1e100;
    t->bounds[2 * axis] = known ? low : 0.0;
    t->bounds[2 * axis + 1] = known ? high : 1.0;
    width = fmax(width, t->bounds[2 * axis + 1] - t->bounds[2 * axis]);
  }
  t->edge = 0.3 * width;
}

fuzz_tetrahedra fuzz_mesh(fuzz* f, int largest)
{
  static const int64_t wrong[] = { -1, INT64_MIN, (int64_t)1 << 31, (int64_t)1 << 40, INT64_MAX };
  fuzz_tetrahedra t = { .view = CALL(stratus_mesh_default()), .high = 1.0, .sound = fuzz_chance(f, 0.7) };
  stratus_mesh* m = &t.view;
  draft d = t.sound ? make_lattice(f, largest) : make_soup(f, largest);
  if (fuzz_chance(f, 0.6)) {
    shuffle(f, &d);
  }
  spoil(f, &d);
  m->point_count = d.point_count;
  m->cell_count = d.cell_count;
  m->points = fuzz_input(f, d.points, (size_t)d.point_count * 3 * sizeof *d.points);
  m->vertices = fuzz_input(f, d.vertices, (size_t)d.cell_count * 4 * sizeof *d.vertices);
  free(d.points);
  free(d.vertices);
  add_values(f, &t);
  if (fuzz_chance(f, 0.2)) {
    add_hidden(f, m);
  }
  if (fuzz_chance(f, 0.5)) {
    fuzz_matrix(f, m->matrix);
  }
  m->revision = fuzz_below(f, 3);
  look_at(&t);
  m->points = fuzz_pointer(f, m->points);
  m->vertices = fuzz_pointer(f, m->vertices);
  m->values = fuzz_pointer(f, m->values);
  m->point_count = fuzz_odd(f) ? wrong[fuzz_below(f, 5)] : m->point_count;
  m->cell_count = fuzz_odd(f) ? wrong[fuzz_below(f, 5)] : m->cell_count;
  m->type = fuzz_odd(f) ? (stratus_type)(STRATUS_FLOAT64 + 1 + (int)fuzz_below(f, 9)) : m->type;
  m->value_stride = fuzz_odd(f) ? -(int64_t)fuzz_below(f, 3) : m->value_stride;
  m->cell_values = fuzz_odd(f) ? 2 : m->cell_values;
  return t;
}
