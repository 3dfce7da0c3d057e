/* SPDX-License-Identifier: BSD-3-Clause
 * Boxes and cameras for the tests of the octree, and slow, obvious tests of boxes against frustums: against each plane in long double, and
 * by clipping the box's faces. */
#ifndef STRATUS_TESTING_OCTREE_CASE_H
#define STRATUS_TESTING_OCTREE_CASE_H

#include "stratus.h"

#include "structures.h"

static inline double random_unit(uint32_t* random)
{
  return (double)next_random(random) / 16777216.0;
}

/* Makes uneven bounds: clusters of clusters, and a range of sizes of 1 to 100. */
static inline void random_bounds(uint32_t* random, double scale, double bounds[6])
{
  const double spread = pow(random_unit(random), 3.0), size = 0.001 * pow(100.0, random_unit(random));
  for (int a = 0; a < 3; ++a) {
    const double center = 0.3 * (double)random_below(random, 4) + spread * (random_unit(random) - 0.5), half = size * random_unit(random);
    bounds[2 * a] = scale * (center - half);
    bounds[2 * a + 1] = scale * (center + half);
  }
}

/* inside: receives a point of the frustum; may be NULL. */
static inline stratus_frustum random_frustum(stratus_context* context, uint32_t* random, double scale, double inside[3])
{
  stratus_camera camera;
  stratus_frustum frustum;
  double eye[3], focal[3];
  for (int a = 0; a < 3; ++a) {
    eye[a] = scale * (2.0 * random_unit(random) - 0.5);
    focal[a] = scale * random_unit(random);
  }
  const double up[3] = { 0.1, 0.9, 0.2 };
  const int parallel = random_below(random, 3) == 0;
  const double angle = 5.0 + 80.0 * random_unit(random), half = scale * (0.02 + 0.5 * random_unit(random)),
               aspect = 0.5 + random_unit(random);
  assert_int_equal(parallel ? stratus_camera_parallel(context, eye, focal, up, half, aspect, &camera)
                            : stratus_camera_perspective(context, eye, focal, up, angle, aspect, &camera),
    STRATUS_OK);
  camera.near_k = scale * 0.1 * random_unit(random);
  camera.far_k = random_below(random, 3) == 0 ? INFINITY : camera.near_k + scale * (0.1 + random_unit(random));
  /* Off-axis: the window's middle does not lie straight ahead. */
  const double skew = random_below(random, 2) ? 0.8 * random_unit(random) : 0.0;
  for (int a = 0; a < 3; ++a) {
    camera.forward[a] += parallel ? 0.0 : skew * camera.right[a];
  }
  assert_int_equal(stratus_frustum_from_camera(context, &camera, &frustum), STRATUS_OK);
  for (int a = 0; inside && a < 3; ++a) {
    inside[a] = camera.eye[a] + (camera.near_k + 0.05 * scale) * camera.forward[a];
  }
  return frustum;
}

/* Returns how far the box reaches into the half-space that holds least of it, relative to the size of the terms. Below 0 it is outside. */
static inline long double reach_of(const stratus_frustum* frustum, const double bounds[6])
{
  long double worst = INFINITY;
  for (int p = 0; p < 6; ++p) {
    const double* n = frustum->planes[p];
    long double value = n[3], size = fabsl((long double)n[3]);
    for (int a = 0; a < 3; ++a) {
      const long double lo = (long double)n[a] * bounds[2 * a], hi = (long double)n[a] * bounds[2 * a + 1];
      value += lo > hi ? lo : hi;
      size += fmaxl(fabsl(lo), fabsl(hi));
    }
    worst = fminl(worst, size > 0.0L ? value / size : 0.0L);
  }
  return worst;
}

typedef struct polygon {
  long double points[24][3];
  int count;
} polygon;

static inline void cut_polygon(polygon* face, const double plane[4], long double room)
{
  polygon cut = { .count = 0 };
  for (int i = 0; i < face->count; ++i) {
    const long double *p = face->points[i], *q = face->points[(i + 1) % face->count];
    const long double s = plane[0] * p[0] + plane[1] * p[1] + plane[2] * p[2] + plane[3] + room;
    const long double t = plane[0] * q[0] + plane[1] * q[1] + plane[2] * q[2] + plane[3] + room;
    if (s >= 0.0L) {
      memcpy(cut.points[cut.count++], p, sizeof cut.points[0]);
    }
    if ((s >= 0.0L) != (t >= 0.0L)) {
      for (int a = 0; a < 3; ++a) {
        cut.points[cut.count][a] = p[a] + s / (s - t) * (q[a] - p[a]);
      }
      ++cut.count;
    }
  }
  *face = cut;
}

/* Returns whether the box, widened by `room`, meets the frustum: one of its faces does, or it holds `inside`, a point of the frustum.
 * Planes must have unit normals. */
static inline bool box_meets_frustum(const stratus_frustum* frustum, const double bounds[6], const double inside[3], double room)
{
  /* Decides most boxes early: they lie wholly outside one half-space, or have their centre inside all six. */
  bool holds = true;
  for (int p = 0; p < 6; ++p) {
    const double* n = frustum->planes[p];
    long double most = n[3] + room, middle = n[3];
    for (int a = 0; a < 3; ++a) {
      const long double lo = (long double)n[a] * bounds[2 * a], hi = (long double)n[a] * bounds[2 * a + 1];
      most += lo > hi ? lo : hi;
      middle += 0.5L * (lo + hi);
    }
    if (most < 0.0L) {
      return false;
    }
    holds = holds && middle >= 0.0L;
  }
  if (holds) {
    return true;
  }
  holds = true;
  for (int a = 0; a < 3; ++a) {
    holds = holds && inside[a] >= bounds[2 * a] - room && inside[a] <= bounds[2 * a + 1] + room;
  }
  for (int f = 0; f < 6 && !holds; ++f) {
    const int a = f / 2, b = (a + 1) % 3, c = (a + 2) % 3;
    polygon face = { .count = 4 };
    for (int i = 0; i < 4; ++i) {
      face.points[i][a] = bounds[f];
      face.points[i][b] = bounds[i == 1 || i == 2 ? 2 * b + 1 : 2 * b];
      face.points[i][c] = bounds[i >= 2 ? 2 * c + 1 : 2 * c];
    }
    for (int p = 0; p < 6 && face.count > 0; ++p) {
      cut_polygon(&face, frustum->planes[p], room);
    }
    holds = face.count > 0;
  }
  return holds;
}

static inline int compare_ids(const void* a, const void* b)
{
  const uint32_t x = *(const uint32_t*)a, y = *(const uint32_t*)b;
  return x < y ? -1 : x > y;
}

/* Returns a sorted copy of the list. Fails if an id occurs twice. */
static inline uint32_t* sorted_ids(const stratus_octree_visible* visible)
{
  uint32_t* ids = malloc((visible->count + 1) * sizeof *ids);
  if (visible->count > 0) {
    memcpy(ids, visible->ids, visible->count * sizeof *ids);
    qsort(ids, visible->count, sizeof *ids, compare_ids);
  }
  for (size_t i = 1; i < visible->count; ++i) {
    assert_true(ids[i - 1] < ids[i]);
  }
  return ids;
}

static inline void assert_same_visible(const stratus_octree_visible* a, const stratus_octree_visible* b)
{
  uint32_t *x = sorted_ids(a), *y = sorted_ids(b);
  assert_int_equal(a->count, b->count);
  assert_true(a->count == 0 || memcmp(x, y, a->count * sizeof *x) == 0);
  free(x);
  free(y);
}

#endif
