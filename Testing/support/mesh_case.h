/* SPDX-License-Identifier: BSD-3-Clause
 * Meshes of tetrahedra for tests, and a check of visibility orders by rays. */
#ifndef STRATUS_MESH_CASE_H
#define STRATUS_MESH_CASE_H

#include "stratus.h"

#include "volume.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

/* Makes a context of the host. */
static inline stratus_context* mesh_context(int threads)
{
  stratus_context_options options = stratus_context_options_default();
  stratus_context* context = NULL;
  options.device = "host";
  options.threads = threads;
  assert_int_equal(stratus_context_create(&options, &context, NULL, 0), STRATUS_OK);
  return context;
}

/* A mesh that owns its arrays. */
typedef struct mesh_case {
  double* points;
  int32_t* vertices;
  int64_t point_count, cell_count;
} mesh_case;

static inline uint32_t mesh_random(uint32_t* state)
{
  *state = *state * 1664525u + 1013904223u;
  return *state >> 8;
}

/* 0 <= x < 1 */
static inline double mesh_random_unit(uint32_t* state)
{
  return mesh_random(state) / 16777216.0;
}

static inline stratus_mesh mesh_case_view(const mesh_case* mesh)
{
  stratus_mesh view = stratus_mesh_default();
  view.points = mesh->points;
  view.point_count = mesh->point_count;
  view.vertices = mesh->vertices;
  view.cell_count = mesh->cell_count;
  return view;
}

static inline mesh_case mesh_case_allocate(int64_t points, int64_t cells)
{
  mesh_case mesh = { calloc((size_t)points * 3 + 1, sizeof(double)), calloc((size_t)cells * 4 + 1, sizeof(int32_t)), points, cells };
  assert_non_null(mesh.points);
  assert_non_null(mesh.vertices);
  return mesh;
}

static inline void mesh_case_free(mesh_case* mesh)
{
  free(mesh->points);
  free(mesh->vertices);
}

/* Makes a conforming mesh of n[0]*n[1]*n[2] unit cubes, six cells each (Kuhn). jitter moves inner points by at most so much; below .2 it
 * inverts no cell. */
static inline mesh_case mesh_grid(const int n[3], double jitter, uint32_t seed)
{
  static const int path[6][3] = { { 0, 1, 2 }, { 0, 2, 1 }, { 1, 0, 2 }, { 1, 2, 0 }, { 2, 0, 1 }, { 2, 1, 0 } };
  const int step[3] = { 1, n[0] + 1, (n[0] + 1) * (n[1] + 1) };
  mesh_case mesh = mesh_case_allocate((int64_t)step[2] * (n[2] + 1), 6 * (int64_t)n[0] * n[1] * n[2]);
  int64_t cell = 0;
  for (int k = 0; k <= n[2]; ++k) {
    for (int j = 0; j <= n[1]; ++j) {
      for (int i = 0; i <= n[0]; ++i) {
        const int at[3] = { i, j, k }, point = i + j * step[1] + k * step[2];
        for (int a = 0; a < 3; ++a) {
          const double moved = at[a] > 0 && at[a] < n[a] ? jitter * (2.0 * mesh_random_unit(&seed) - 1.0) : 0.0;
          mesh.points[3 * point + a] = at[a] + moved;
        }
        for (int c = 0; c < 6 && i < n[0] && j < n[1] && k < n[2]; ++c, ++cell) {
          int corner = mesh.vertices[4 * cell] = point;
          for (int v = 0; v < 3; ++v) {
            mesh.vertices[4 * cell + v + 1] = corner += step[path[c][v]];
          }
        }
      }
    }
  }
  return mesh;
}

/* Shuffles the cells, and the vertices of each cell. */
static inline void mesh_shuffle(mesh_case* mesh, uint32_t seed)
{
  for (int64_t i = mesh->cell_count - 1; i > 0; --i) {
    const int64_t j = mesh_random(&seed) % (i + 1);
    int32_t cell[4];
    memcpy(cell, mesh->vertices + 4 * i, sizeof cell);
    memcpy(mesh->vertices + 4 * i, mesh->vertices + 4 * j, sizeof cell);
    memcpy(mesh->vertices + 4 * j, cell, sizeof cell);
  }
  for (int64_t i = 0; i < mesh->cell_count; ++i) {
    int32_t* v = mesh->vertices + 4 * i;
    for (int p = 3; p > 0; --p) {
      const int q = (int)(mesh_random(&seed) % (uint32_t)(p + 1));
      const int32_t kept = v[p];
      v[p] = v[q];
      v[q] = kept;
    }
  }
}

/* Blades of an iris: `count` blocks of three cells around an axis, each over the next block and under the one before. */
static inline mesh_case mesh_iris(int count)
{
  mesh_case mesh = mesh_case_allocate(3 * count, 3 * count);
  for (int b = 0; b < count; ++b) {
    const double angle = 6.283185307179586 * b / count, lean = angle + 1.2 * 6.283185307179586 / count;
    const double radius[3] = { 1.0, 3.0, 2.0 }, height[3] = { 0.0, 0.0, 1.0 };
    for (int i = 0; i < 3; ++i) {
      double* p = mesh.points + 3 * (3 * b + i);
      p[0] = radius[i] * cos(i < 2 ? angle : lean);
      p[1] = radius[i] * sin(i < 2 ? angle : lean);
      p[2] = height[i];
    }
    const int p = 3 * b, q = 3 * ((b + 1) % count);
    const int32_t cells[12] = { p, p + 1, p + 2, q, p + 1, p + 2, q, q + 1, p + 2, q, q + 1, q + 2 };
    memcpy(mesh.vertices + 12 * b, cells, sizeof cells);
  }
  return mesh;
}

/* Makes a mesh of both meshes' points and cells, the first's before the second's. Frees both. */
static inline mesh_case mesh_join(mesh_case a, mesh_case b)
{
  mesh_case mesh = mesh_case_allocate(a.point_count + b.point_count, a.cell_count + b.cell_count);
  memcpy(mesh.points, a.points, (size_t)a.point_count * 3 * sizeof(double));
  memcpy(mesh.points + 3 * a.point_count, b.points, (size_t)b.point_count * 3 * sizeof(double));
  memcpy(mesh.vertices, a.vertices, (size_t)a.cell_count * 4 * sizeof(int32_t));
  for (int64_t i = 0; i < 4 * b.cell_count; ++i) {
    mesh.vertices[4 * a.cell_count + i] = b.vertices[i] + (int32_t)a.point_count;
  }
  mesh_case_free(&a);
  mesh_case_free(&b);
  return mesh;
}

static inline void mesh_move(mesh_case* mesh, const double scale[3], const double offset[3])
{
  for (int64_t i = 0; i < 3 * mesh->point_count; ++i) {
    mesh->points[i] = mesh->points[i] * scale[i % 3] + offset[i % 3];
  }
}

static inline void mesh_bounds(const mesh_case* mesh, double bounds[6])
{
  for (int a = 0; a < 3; ++a) {
    bounds[2 * a] = INFINITY;
    bounds[2 * a + 1] = -INFINITY;
  }
  for (int64_t i = 0; i < 3 * mesh->point_count; ++i) {
    bounds[2 * (i % 3)] = fmin(bounds[2 * (i % 3)], mesh->points[i]);
    bounds[2 * (i % 3) + 1] = fmax(bounds[2 * (i % 3) + 1], mesh->points[i]);
  }
}

/* ---- the oracle */

typedef struct mesh_interval {
  double low, high;
  int64_t rank; /* place of the cell in the visibility order */
} mesh_interval;

/* Returns the bounding boxes of the cells, 6 numbers each. The caller frees them. */
static inline double* mesh_boxes(const mesh_case* mesh)
{
  double* boxes = malloc((size_t)mesh->cell_count * 6 * sizeof(double) + 1);
  assert_non_null(boxes);
  for (int64_t c = 0; c < mesh->cell_count; ++c) {
    for (int i = 0; i < 12; ++i) {
      const double x = mesh->points[3 * (int64_t)mesh->vertices[4 * c + i / 3] + i % 3];
      double* box = boxes + 6 * c + 2 * (i % 3);
      box[0] = i < 3 || x < box[0] ? x : box[0];
      box[1] = i < 3 || x > box[1] ? x : box[1];
    }
  }
  return boxes;
}

static inline bool mesh_clip_box(const double* box, const double origin[3], const double direction[3])
{
  double low = 0.0, high = INFINITY;
  for (int a = 0; a < 3; ++a) {
    if (direction[a] == 0.0) {
      if (origin[a] < box[2 * a] || origin[a] > box[2 * a + 1]) {
        return false;
      }
      continue;
    }
    const double t0 = (box[2 * a] - origin[a]) / direction[a], t1 = (box[2 * a + 1] - origin[a]) / direction[a];
    low = fmax(low, fmin(t0, t1));
    high = fmin(high, fmax(t0, t1));
  }
  return low <= high;
}

/* Finds the interval of t >= 0 in which origin + t direction is inside the cell, by the planes of its faces. Returns whether the interval
 * is longer than `least`. */
static inline bool mesh_clip_cell(
  const mesh_case* mesh, int64_t cell, const double origin[3], const double direction[3], double least, mesh_interval* hit)
{
  const double* p[4];
  hit->low = 0.0;
  hit->high = INFINITY;
  for (int i = 0; i < 4; ++i) {
    p[i] = mesh->points + 3 * (int64_t)mesh->vertices[4 * cell + i];
  }
  for (int f = 0; f < 4; ++f) {
    const double *a = p[(f + 1) % 4], *b = p[(f + 2) % 4], *c = p[(f + 3) % 4];
    double u[3], v[3], normal[3], start = 0.0, slope = 0.0, inner = 0.0;
    for (int i = 0; i < 3; ++i) {
      u[i] = b[i] - a[i];
      v[i] = c[i] - a[i];
    }
    for (int i = 0; i < 3; ++i) {
      normal[i] = u[(i + 1) % 3] * v[(i + 2) % 3] - u[(i + 2) % 3] * v[(i + 1) % 3];
      start += normal[i] * (origin[i] - a[i]);
      slope += normal[i] * direction[i];
      inner += normal[i] * (p[f][i] - a[i]);
    }
    if (inner == 0.0) {
      return false;
    }
    start = inner < 0.0 ? -start : start;
    slope = inner < 0.0 ? -slope : slope;
    if (slope == 0.0) {
      if (start < 0.0) {
        return false;
      }
    } else if (slope > 0.0) {
      hit->low = fmax(hit->low, -start / slope);
    } else {
      hit->high = fmin(hit->high, -start / slope);
    }
  }
  return hit->high - hit->low > least;
}

static int mesh_compare_intervals(const void* p, const void* q)
{
  const mesh_interval *a = p, *b = q;
  const double x = a->low + a->high, y = b->low + b->high;
  return (x > y) - (x < y);
}

/* Checks the visibility order `cells` by rays from the camera's eye (parallel: along its forward) through `rays` random points of random
 * cells. *pairs counts the pairs of consecutive cells on rays. Returns how many of them are in the wrong order in `cells`. Intervals
 * shorter than 1e-9 of the mesh do not count, because rounding could have caused them. */
static inline int64_t mesh_wrong_pairs(
  const mesh_case* mesh, const stratus_camera* camera, const uint32_t* cells, int rays, uint32_t seed, int64_t* pairs)
{
  double bounds[6], size = 0.0;
  int64_t wrong = 0;
  int64_t* rank = malloc((size_t)mesh->cell_count * sizeof *rank + 1);
  mesh_interval* hits = malloc((size_t)mesh->cell_count * sizeof *hits + 1);
  double* boxes = mesh_boxes(mesh);
  assert_true(rank && hits);
  for (int64_t i = 0; i < mesh->cell_count; ++i) {
    rank[i] = -1;
  }
  for (int64_t i = 0; i < mesh->cell_count; ++i) {
    assert_true(cells[i] < mesh->cell_count && rank[cells[i]] < 0); /* each cell occurs once */
    rank[cells[i]] = i;
  }
  mesh_bounds(mesh, bounds);
  for (int a = 0; a < 3; ++a) {
    size = fmax(size, bounds[2 * a + 1] - bounds[2 * a]);
  }
  for (int r = 0; r < rays && mesh->cell_count > 0; ++r) {
    const int64_t through = mesh_random(&seed) % mesh->cell_count;
    const int32_t* v = mesh->vertices + 4 * through;
    double target[3] = { 0 }, origin[3], direction[3], weight[4], sum = 0.0, length = 0.0;
    for (int i = 0; i < 4; ++i) {
      sum += weight[i] = mesh_random_unit(&seed) + 1e-3;
    }
    for (int i = 0; i < 12; ++i) {
      target[i % 3] += weight[i / 3] / sum * mesh->points[3 * (int64_t)v[i / 3] + i % 3];
    }
    for (int a = 0; a < 3; ++a) {
      direction[a] = camera->parallel ? camera->forward[a] : target[a] - camera->eye[a];
      length += direction[a] * direction[a];
    }
    for (int a = 0; a < 3; ++a) {
      direction[a] /= sqrt(length);
      origin[a] = camera->parallel ? target[a] - 4.0 * size * direction[a] : camera->eye[a];
    }
    int64_t count = 0;
    if (!mesh_clip_cell(mesh, through, origin, direction, 1e-9 * size, hits)) {
      continue; /* the cell is flat, and the ray may run between its neighbours, inside none */
    }
    for (int64_t c = 0; c < mesh->cell_count; ++c) {
      if (mesh_clip_box(boxes + 6 * c, origin, direction) && mesh_clip_cell(mesh, c, origin, direction, 1e-9 * size, hits + count)) {
        hits[count++].rank = rank[c];
      }
    }
    qsort(hits, (size_t)count, sizeof *hits, mesh_compare_intervals);
    for (int64_t i = 1; i < count; ++i) {
      if (hits[i - 1].high <= hits[i].low + 1e-10 * size) {
        wrong += hits[i - 1].rank > hits[i].rank;
        ++*pairs;
      }
    }
  }
  free(rank);
  free(hits);
  free(boxes);
  return wrong;
}

#endif
