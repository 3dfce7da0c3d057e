/* SPDX-License-Identifier: BSD-3-Clause
 * Meshes of tetrahedra that are put together from points, cells and boxes of cells. */
#ifndef STRATUS_TESTING_TETRA_PARTS_H
#define STRATUS_TESTING_TETRA_PARTS_H

#include "tetra_case.h"

/* Allocates room for so many points and cells, and leaves none. */
static inline void tetra_clear(tetra_case* c, size_t points, size_t cells)
{
  c->points = realloc(c->points, points * 3 * sizeof(double));
  c->values = realloc(c->values, points * sizeof(float));
  c->vertices = realloc(c->vertices, cells * 4 * sizeof(int32_t));
  assert_true(c->points && c->values && c->vertices);
  c->mesh.points = c->points;
  c->mesh.values = c->values;
  c->mesh.vertices = c->vertices;
  c->mesh.point_count = c->mesh.cell_count = 0;
}

static inline int32_t tetra_add_point(tetra_case* c, double x, double y, double z)
{
  const int64_t at = c->mesh.point_count++;
  c->points[3 * at] = x;
  c->points[3 * at + 1] = y;
  c->points[3 * at + 2] = z;
  c->values[at] = (float)(0.5 + 0.25 * sin(1.9 * x + 0.7 * y) + 0.25 * cos(1.3 * z - 0.9 * y));
  return (int32_t)at;
}

static inline void tetra_add_cell(tetra_case* c, int32_t p, int32_t q, int32_t r, int32_t s)
{
  const int32_t cell[4] = { p, q, r, s };
  memcpy(c->vertices + 4 * c->mesh.cell_count++, cell, sizeof cell);
}

/* Adds a box of n^3 times six cells with points of its own. */
static inline void tetra_add_box(tetra_case* c, int n, const double low[3], const double size[3])
{
  static const int path[6][2] = { { 0, 1 }, { 0, 2 }, { 1, 0 }, { 1, 2 }, { 2, 0 }, { 2, 1 } };
  const int32_t first = (int32_t)c->mesh.point_count, step[3] = { 1, n + 1, (n + 1) * (n + 1) };
  for (int i = 0; i < (n + 1) * step[2]; ++i) {
    tetra_add_point(
      c, low[0] + size[0] * (i % step[1]) / n, low[1] + size[1] * (i / step[1] % step[1]) / n, low[2] + size[2] * (i / step[2]) / n);
  }
  for (int box = 0; box < n * n * n; ++box) {
    const int32_t corner = first + box % n + box / n % n * step[1] + box / n / n * step[2];
    for (int t = 0; t < 6; ++t) {
      const int32_t a = corner + step[path[t][0]];
      tetra_add_cell(c, corner, a, a + step[path[t][1]], corner + step[0] + step[1] + step[2]);
    }
  }
}

#endif
