/* SPDX-License-Identifier: BSD-3-Clause
 * Rays through the blocks (a walk as in Amanatides & Woo 1987): free paths by delta tracking, and transmittance by ratio tracking. Both
 * draw tentative collisions of the block's largest extinction, so that empty blocks cost one step of the walk. */
#include "path.h"

/* Below this, an estimate of the transmittance ends at random, or is raised to this. */
#define ROULETTE_BELOW 0.05

typedef struct walk {
  int64_t block[3];
  double exit[3]; /* where the ray leaves the block through a plane of each axis */
  double begin, end;
  double majorant;
} walk;

/* Keeps the part of the ray where at + slope s >= 0. */
static void keep(double at, double slope, stratus_path_ray* ray)
{
  if (slope > 0.0) {
    ray->begin = fmax(ray->begin, -at / slope);
  } else if (slope < 0.0) {
    ray->end = fmin(ray->end, -at / slope);
  } else if (at < 0.0) {
    ray->end = -(double)INFINITY;
  }
}

void stratus_path_clip(const stratus_path_field* f, stratus_path_ray* ray)
{
  for (int a = 0; a < 3; ++a) {
    keep(ray->from[a] - f->lo[a], ray->along[a], ray);
    keep(f->hi[a] - ray->from[a], -ray->along[a], ray);
  }
  for (int i = 0; i < f->plane_count; ++i) {
    const double* p = f->planes[i];
    keep(p[0] * ray->from[0] + p[1] * ray->from[1] + p[2] * ray->from[2] + p[3],
      p[0] * ray->along[0] + p[1] * ray->along[1] + p[2] * ray->along[2], ray);
  }
}

/* Finds where the ray leaves the block along an axis. The outer blocks have no end. */
static void set_exit(const stratus_path_field* f, const stratus_path_ray* ray, int axis, walk* w)
{
  const double along = ray->along[axis];
  const int64_t border = w->block[axis] + (along > 0.0);
  const bool ends = along != 0.0 && border > 0 && border < f->blocks[axis];
  w->exit[axis] = ends ? (stratus_path_value_place(f, axis, border * f->block_size) - ray->from[axis]) / along : (double)INFINITY;
}

static void enter(const stratus_path_field* f, const stratus_path_ray* ray, walk* w)
{
  w->end = fmin(fmin(w->exit[0], w->exit[1]), fmin(w->exit[2], ray->end));
  w->majorant = f->majorant[(w->block[2] * f->blocks[1] + w->block[1]) * f->blocks[0] + w->block[0]];
}

static void begin_walk(const stratus_path_field* f, const stratus_path_ray* ray, walk* w)
{
  w->begin = ray->begin;
  for (int a = 0; a < 3; ++a) {
    w->block[a] = stratus_path_cell(f, a, 0, f->cells[a] - 1, ray->from[a] + ray->begin * ray->along[a]) / f->block_size;
    set_exit(f, ray, a, w);
  }
  enter(f, ray, w);
}

/* Returns false at the ray's end. */
static bool next_block(const stratus_path_field* f, const stratus_path_ray* ray, walk* w)
{
  int axis = w->exit[0] <= w->exit[1] ? 0 : 1;
  axis = w->exit[axis] <= w->exit[2] ? axis : 2;
  if (!(w->exit[axis] < ray->end)) {
    return false;
  }
  w->begin = fmax(w->begin, w->exit[axis]);
  w->block[axis] += ray->along[axis] > 0.0 ? 1 : -1;
  set_exit(f, ray, axis, w);
  enter(f, ray, w);
  return true;
}

/* Returns an optical depth of random length: of the mean 1. */
static double free_depth(stratus_path_random* random)
{
  return -log1p(-stratus_path_uniform(random));
}

/* Passes over `depth` of the blocks' optical depth. Returns where that is, and the extinction and the value there; INFINITY at the end. */
static double next_collision(const stratus_path_field* f, stratus_path_ray* ray, walk* w, double depth, double* extinction, double* value)
{
  for (;;) {
    const double passed = w->majorant * (w->end - w->begin);
    if (depth < passed) {
      w->begin += depth / w->majorant;
      break;
    }
    depth -= fmax(passed, 0.0);
    if (!next_block(f, ray, w)) {
      return (double)INFINITY;
    }
  }
  const double place[3] = { ray->from[0] + w->begin * ray->along[0], ray->from[1] + w->begin * ray->along[1],
    ray->from[2] + w->begin * ray->along[2] };
  ++ray->lookups;
  *extinction = stratus_path_value(f, w->block, place, value) ? stratus_path_extinction(f, *value) : 0.0;
  return w->begin;
}

double stratus_path_collide(const stratus_path_field* f, stratus_path_ray* ray, stratus_path_random* random, double* value)
{
  walk w;
  if (!(ray->begin < ray->end)) {
    return (double)INFINITY;
  }
  for (begin_walk(f, ray, &w);;) {
    double extinction = 0.0;
    const double at = next_collision(f, ray, &w, free_depth(random), &extinction, value);
    if (!isfinite(at) || stratus_path_uniform(random) * w.majorant < extinction) {
      return at;
    }
  }
}

double stratus_path_transmittance(const stratus_path_field* f, stratus_path_ray* ray, stratus_path_random* random)
{
  walk w;
  double left = 1.0;
  if (!(ray->begin < ray->end)) {
    return 1.0;
  }
  begin_walk(f, ray, &w);
  while (left > 0.0) {
    double extinction = 0.0, value;
    if (!isfinite(next_collision(f, ray, &w, free_depth(random), &extinction, &value))) {
      break;
    }
    left *= fmax(1.0 - extinction / w.majorant, 0.0);
    if (left > 0.0 && left < ROULETTE_BELOW) {
      left = stratus_path_uniform(random) * ROULETTE_BELOW < left ? ROULETTE_BELOW : 0.0;
    }
  }
  return left;
}
