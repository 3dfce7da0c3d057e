/* SPDX-License-Identifier: BSD-3-Clause
 * First hits by walking from voxel to voxel (Amanatides & Woo 1987) in double precision: the reference for every faster method.
 *
 * A ray crosses plane p of an axis at t = (p - origin) / direction, and nothing else is computed of a crossing. Crossings are taken in the
 * order of t, and at equal t in the order of the axes: a ray through an edge or a corner steps along x before y before z and meets the
 * voxels between. A crossing at t_min counts as made already, so that a ray that begins on a face begins in the voxel that it moves into. A
 * ray that runs within a plane between voxels is in the upper voxel. */
#include "voxels.h"

#include "vector.h"
#include "matrix.h"

#include <string.h>

typedef struct walk {
  const stratus_voxels* voxels;
  const stratus_voxel_borders* borders; /* may be NULL */
  double origin[3], direction[3];       /* in the frame where voxel (i,j,k) fills [i,i+1], or the space between its borders */
  double t_min, t_max;
} walk;

/* A crossing. axis 3: the ray's beginning, which comes after every crossing at the same t. */
typedef struct crossing {
  double t;
  int axis;
} crossing;

static bool is_after(double t, int axis, crossing than)
{
  return t > than.t || (t == than.t && axis > than.axis);
}

static double time_of(const walk* w, int axis, int64_t plane)
{
  return (stratus_voxel_border(w->borders, axis, plane) - w->origin[axis]) / w->direction[axis];
}

/* The n-th of the planes lo .. hi along an axis, in the order in which the ray crosses them. */
static int64_t plane_of(const walk* w, int axis, int64_t n)
{
  return w->direction[axis] > 0.0 ? w->voxels->lo[axis] + n : w->voxels->hi[axis] - n;
}

/* Finds the last crossing into the box of all voxels, or the ray's beginning if that is later. Returns false if the ray lies outside along
 * an axis on which it does not move. */
static bool enter_box(const walk* w, crossing* entry)
{
  *entry = (crossing){ w->t_min, 3 };
  for (int a = 0; a < 3; ++a) {
    if (w->direction[a] == 0.0) {
      const double place = w->origin[a];
      if (!(place >= stratus_voxel_border(w->borders, a, w->voxels->lo[a]) &&
            place < stratus_voxel_border(w->borders, a, w->voxels->hi[a]))) {
        return false;
      }
    } else {
      const double t = time_of(w, a, plane_of(w, a, 0));
      if (is_after(t, a, *entry)) {
        *entry = (crossing){ t, a };
      }
    }
  }
  return true;
}

/* Coordinate of the ray's voxel along an axis right after a crossing; lo-1 or hi: outside. Bisection counts the planes behind the ray,
 * since rounding at a far origin can put the point itself anywhere. */
static int64_t place_after(const walk* w, int axis, crossing entry)
{
  if (w->direction[axis] == 0.0) {
    int64_t first = w->voxels->lo[axis], last = w->voxels->hi[axis] - 1;
    while (first < last) {
      const int64_t middle = first + (last - first + 1) / 2;
      if (stratus_voxel_border(w->borders, axis, middle) <= w->origin[axis]) {
        first = middle;
      } else {
        last = middle - 1;
      }
    }
    return first;
  }
  int64_t from = 0, to = w->voxels->hi[axis] - w->voxels->lo[axis] + 1; /* the answer is in from .. to */
  while (from < to) {
    const int64_t middle = from + (to - from) / 2;
    if (is_after(time_of(w, axis, plane_of(w, axis, middle)), axis, entry)) {
      to = middle;
    } else {
      from = middle + 1;
    }
  }
  return w->direction[axis] > 0.0 ? w->voxels->lo[axis] + from - 1 : w->voxels->hi[axis] - from;
}

static double next_time(const walk* w, int axis, int64_t place)
{
  return w->direction[axis] == 0.0 ? INFINITY : time_of(w, axis, w->direction[axis] > 0.0 ? place + 1 : place);
}

/* Mask of the brick that holds the last voxel, so that only a change of brick costs a search. */
typedef struct brick_cache {
  int64_t at[3];
  uint64_t mask;
} brick_cache;

static bool is_effective(const walk* w, brick_cache* cache, const int64_t at[3])
{
  const int64_t brick[3] = { at[0] / STRATUS_BRICK, at[1] / STRATUS_BRICK, at[2] / STRATUS_BRICK };
  if (memcmp(brick, cache->at, sizeof brick) != 0) {
    memcpy(cache->at, brick, sizeof brick);
    cache->mask = stratus_voxels_mask(w->voxels, brick[0], brick[1], brick[2]);
  }
  return cache->mask >> ((at[2] % 4 * 4 + at[1] % 4) * 4 + at[0] % 4) & 1;
}

/* Sets t, voxel, face and visited of a hit; the caller sets its other fields. */
static void walk_ray(const walk* w, brick_cache* cache, stratus_hit* hit)
{
  crossing last;
  if (w->voxels->count == 0 || !enter_box(w, &last)) {
    return;
  }
  int64_t at[3];
  double next[3];
  for (int a = 0; a < 3; ++a) {
    at[a] = place_after(w, a, last);
    next[a] = next_time(w, a, at[a]);
  }
  for (;;) {
    for (int a = 0; a < 3; ++a) {
      if (at[a] < w->voxels->lo[a] || at[a] >= w->voxels->hi[a]) {
        return;
      }
    }
    if (!(last.t <= w->t_max && last.t < INFINITY)) {
      return;
    }
    ++hit->visited;
    if (is_effective(w, cache, at)) {
      break;
    }
    const int axis = next[0] <= next[1] ? (next[0] <= next[2] ? 0 : 2) : (next[1] <= next[2] ? 1 : 2);
    last = (crossing){ next[axis], axis };
    at[axis] += w->direction[axis] > 0.0 ? 1 : -1;
    next[axis] = next_time(w, axis, at[axis]);
  }
  hit->t = last.t;
  hit->face = last.axis == 3 ? -1 : 2 * last.axis + (w->direction[last.axis] < 0.0);
  for (int a = 0; a < 3; ++a) {
    hit->voxel[a] = (int32_t)at[a];
  }
}

/* ---------------------------------------------------------------- world */

/* World to the frame where voxel (i,j,k) fills [i,i+1] and so on: borders of voxels are whole numbers, to the bit for a list. */
static bool invert_to_corner(const double index_to_world[16], double world_to_corner[16])
{
  if (!stratus_matrix_invert_affine(index_to_world, world_to_corner)) {
    return false;
  }
  for (int a = 0; a < 3; ++a) {
    world_to_corner[4 * a + 3] += 0.5;
  }
  return true;
}

bool stratus_ray_usable(const double to_voxels[16], const stratus_ray* ray)
{
  double o[3], d[3];
  stratus_matrix_point(to_voxels, ray->origin, o);
  stratus_matrix_vector(to_voxels, ray->direction, d);
  const double sum = o[0] + o[1] + o[2] + d[0] + d[1] + d[2], longest = fmax(fmax(fabs(d[0]), fabs(d[1])), fabs(d[2]));
  return isfinite(sum + ray->t_min) && longest >= STRATUS_RAY_SHORTEST && !isnan(ray->t_max);
}

stratus_status stratus_ray_refuse(stratus_context* context, const double to_voxels[16], const stratus_ray* ray, size_t index)
{
  double direction[3];
  if (!stratus_vector_finite(ray->origin) || !stratus_vector_finite(ray->direction) || !isfinite(ray->t_min) || isnan(ray->t_max)) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT,
      "ray %zu has a number that is not finite: origin %g %g %g, direction %g %g %g, t %g..%g", index, ray->origin[0], ray->origin[1],
      ray->origin[2], ray->direction[0], ray->direction[1], ray->direction[2], ray->t_min, ray->t_max);
  }
  stratus_matrix_vector(to_voxels, ray->direction, direction);
  if (fmax(fmax(fabs(direction[0]), fabs(direction[1])), fabs(direction[2])) < STRATUS_RAY_SHORTEST) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT,
      "ray %zu has direction %g %g %g, must be longer than 0: its longest component %g voxels", index, ray->direction[0], ray->direction[1],
      ray->direction[2], STRATUS_RAY_SHORTEST);
  }
  return stratus_fail(context, STRATUS_INVALID_ARGUMENT,
    "ray %zu with origin %g %g %g and direction %g %g %g leaves the range of doubles among voxels", index, ray->origin[0], ray->origin[1],
    ray->origin[2], ray->direction[0], ray->direction[1], ray->direction[2]);
}

static stratus_status check_rays(stratus_context* context, const double to_voxels[16], const stratus_ray* rays, size_t count)
{
  for (size_t r = 0; r < count; ++r) {
    if (!stratus_ray_usable(to_voxels, rays + r)) {
      return stratus_ray_refuse(context, to_voxels, rays + r, r);
    }
  }
  return STRATUS_OK;
}

/* Scales v to length `sign`, whatever its length. */
static void normalize(const double v[3], double sign, float normal[3])
{
  const double longest = fmax(fmax(fabs(v[0]), fabs(v[1])), fabs(v[2]));
  const double x = v[0] / longest, y = v[1] / longest, z = v[2] / longest, scale = sign / sqrt(x * x + y * y + z * z);
  normal[0] = (float)(x * scale);
  normal[1] = (float)(y * scale);
  normal[2] = (float)(z * scale);
}

/* A plane's normal goes to the world by the inverse transpose, whatever is mirrored or sheared: row `axis` of the matrix from world to
 * index. */
static void set_normal(const double world_to_index[16], const stratus_ray* ray, stratus_hit* hit)
{
  if (hit->face >= 0) {
    normalize(world_to_index + 4 * (hit->face / 2), hit->face % 2 ? 1.0 : -1.0, hit->normal);
  } else {
    normalize(ray->direction, -1.0, hit->normal);
  }
}

stratus_status stratus_voxels_first_hit(
  stratus_context* context, const stratus_voxels* voxels, const stratus_ray* rays, size_t count, stratus_hit* hits)
{
  return stratus_voxels_first_hit_between(context, voxels, NULL, rays, count, hits);
}

stratus_status stratus_voxels_first_hit_between(stratus_context* context, const stratus_voxels* voxels,
  const stratus_voxel_borders* borders, const stratus_ray* rays, size_t count, stratus_hit* hits)
{
  if (!context) {
    return STRATUS_INVALID_ARGUMENT;
  }
  if (!voxels || (count > 0 && (!rays || !hits))) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "%s is NULL", !voxels ? "voxels" : !rays ? "rays" : "hits");
  }
  TRY(stratus_array_check(context, "rays", count, sizeof *rays));
  double corner[16];
  if (!invert_to_corner(voxels->index_to_world, corner)) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "the voxels' matrix is singular");
  }
  TRY(check_rays(context, corner, rays, count));
  brick_cache cache = { { -1, -1, -1 }, 0 };
  for (size_t r = 0; r < count; ++r) {
    stratus_hit hit = { .t = INFINITY, .voxel = { -1, -1, -1 }, .face = -1 };
    walk w = { .voxels = voxels, .borders = borders, .t_min = rays[r].t_min, .t_max = rays[r].t_max };
    stratus_matrix_point(corner, rays[r].origin, w.origin);
    stratus_matrix_vector(corner, rays[r].direction, w.direction);
    walk_ray(&w, &cache, &hit);
    if (hit.voxel[0] >= 0) {
      set_normal(corner, rays + r, &hit);
    }
    hits[r] = hit;
  }
  return STRATUS_OK;
}
