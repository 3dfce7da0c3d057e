/* SPDX-License-Identifier: BSD-3-Clause
 * Rays through the blocks (a walk as in Amanatides & Woo 1987): free paths by delta tracking, and transmittance by ratio tracking. Both
 * draw tentative collisions of the block's largest extinction, so that empty blocks cost one step of the walk. Where that is high, as next
 * to opaque voxels, they draw tentative collisions of shorter stretches. */
#include "path.h"

/* Below this, an estimate of the transmittance ends at random, or is raised to this. */
#define ROULETTE_BELOW 0.05

/* A stretch whose largest extinction gives a greater optical depth is cut into shorter ones, which have largest extinctions of their own.
 */
#define DEPTH_MOST 32.0

/* A walk through boxes of size^3 cells. The outer boxes have no end. */
typedef struct boxes {
  int64_t at[3], size;
  double exit[3]; /* where the ray leaves the box through a plane of each axis */
} boxes;

/* A stretch of the ray in one block and, if `fine`, in one cell. */
typedef struct walk {
  boxes block, cell;
  double begin, end, majorant; /* of the stretch */
  double left;                 /* optical depth of the majorant from begin to end */
  double block_end, cell_end;
  bool fine;
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

static void set_exit(const stratus_path_field* f, const stratus_path_ray* ray, int axis, boxes* b)
{
  const double along = ray->along[axis];
  const int64_t border = (b->at[axis] + (along > 0.0)) * b->size;
  const bool ends = along != 0.0 && border > 0 && border < f->cells[axis];
  b->exit[axis] = ends ? (stratus_path_value_place(f, axis, border) - ray->from[axis]) / along : (double)INFINITY;
}

static double first_exit(const boxes* b)
{
  return fmin(fmin(b->exit[0], b->exit[1]), b->exit[2]);
}

static void next_box(const stratus_path_field* f, const stratus_path_ray* ray, boxes* b)
{
  int axis = b->exit[0] <= b->exit[1] ? 0 : 1;
  axis = b->exit[axis] <= b->exit[2] ? axis : 2;
  b->at[axis] += ray->along[axis] > 0.0 ? 1 : -1;
  set_exit(f, ray, axis, b);
}

static double place_on(const stratus_path_ray* ray, int axis, double at)
{
  return ray->from[axis] + at * ray->along[axis];
}

static void set_stretch(walk* w, double end, double majorant)
{
  w->end = end;
  w->majorant = majorant;
  w->left = fmax(majorant * (end - w->begin), 0.0);
}

/* Begins a stretch in the cell: all that is left of it, or a half, a quarter and so on. A stretch that doubles cannot halve is opaque
 * enough by DEPTH_MOST. */
static void enter_stretch(const stratus_path_field* f, const stratus_path_ray* ray, walk* w)
{
  for (double end = w->cell_end;;) {
    const double half = 0.5 * (w->begin + end);
    double from[3], to[3];
    for (int a = 0; a < 3; ++a) {
      from[a] = place_on(ray, a, w->begin);
      to[a] = place_on(ray, a, end);
    }
    set_stretch(w, end, stratus_path_majorant(f, w->cell.at, from, to));
    if (w->left <= DEPTH_MOST) {
      return;
    }
    if (!(half > w->begin && half < end)) {
      set_stretch(w, end, DEPTH_MOST / (end - w->begin));
      return;
    }
    end = half;
  }
}

static void enter_cell(const stratus_path_field* f, const stratus_path_ray* ray, walk* w)
{
  w->cell_end = fmin(first_exit(&w->cell), w->block_end);
  enter_stretch(f, ray, w);
}

static void enter_block(const stratus_path_field* f, const stratus_path_ray* ray, walk* w)
{
  w->block_end = fmin(first_exit(&w->block), ray->end);
  set_stretch(w, w->block_end, f->majorant[(w->block.at[2] * f->blocks[1] + w->block.at[1]) * f->blocks[0] + w->block.at[0]]);
  w->fine = w->left > DEPTH_MOST;
  for (int a = 0; w->fine && a < 3; ++a) {
    const int64_t first = w->block.at[a] * f->block_size, beyond = first + f->block_size;
    const int64_t last = (beyond < f->cells[a] ? beyond : f->cells[a]) - 1;
    w->cell.at[a] = stratus_path_cell(f, a, first, last, place_on(ray, a, w->begin));
    set_exit(f, ray, a, &w->cell);
  }
  if (w->fine) {
    enter_cell(f, ray, w);
  }
}

static void begin_walk(const stratus_path_field* f, const stratus_path_ray* ray, walk* w)
{
  w->begin = ray->begin;
  w->block.size = f->block_size;
  w->cell.size = 1;
  for (int a = 0; a < 3; ++a) {
    w->block.at[a] = stratus_path_cell(f, a, 0, f->cells[a] - 1, place_on(ray, a, ray->begin)) / f->block_size;
    set_exit(f, ray, a, &w->block);
  }
  enter_block(f, ray, w);
}

/* Goes on to the next stretch. Returns false at the ray's end. */
static bool next_stretch(const stratus_path_field* f, const stratus_path_ray* ray, walk* w)
{
  w->begin = fmax(w->begin, w->end);
  if (w->fine && w->end < w->cell_end) {
    enter_stretch(f, ray, w);
  } else if (w->fine && w->cell_end < w->block_end) {
    next_box(f, ray, &w->cell);
    enter_cell(f, ray, w);
  } else if (w->block_end < ray->end) {
    next_box(f, ray, &w->block);
    enter_block(f, ray, w);
  } else {
    return false;
  }
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
  while (depth >= w->left) {
    depth -= w->left;
    if (!next_stretch(f, ray, w)) {
      return (double)INFINITY;
    }
  }
  w->left -= depth;
  w->begin = w->end - w->left / w->majorant;
  const double place[3] = { place_on(ray, 0, w->begin), place_on(ray, 1, w->begin), place_on(ray, 2, w->begin) };
  ++ray->lookups;
  *extinction = stratus_path_value(f, w->block.at, place, value) ? stratus_path_extinction(f, *value) : 0.0;
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
