/* SPDX-License-Identifier: BSD-3-Clause
 * Random voxels and rays, and a comparison of a tree's first hits with those of the plain walk. */
#ifndef STRATUS_TESTING_FIRST_HITS_H
#define STRATUS_TESTING_FIRST_HITS_H

#include "stratus.h"

#include "volume.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

/* Makes a context of the host with this instruction set, or the best that there is below it. */
static inline stratus_context* host_with_isa(int isa, int threads)
{
  stratus_context_options options = stratus_context_options_default();
  stratus_context* context = NULL;
  options.device = "host";
  options.threads = threads;
  assert_int_equal(stratus_context_create(&options, &context, NULL, 0), STRATUS_OK);
  context->isa = isa < context->isa ? isa : context->isa;
  return context;
}

static inline uint32_t next_random(uint32_t* state)
{
  *state = *state * 1664525u + 1013904223u;
  return *state >> 8;
}

static inline double unit_random(uint32_t* state)
{
  return next_random(state) / 16777216.0;
}

/* fill: share of the voxels, 0..1, that are effective. cluster > 0: these lie in four random cubes of that half edge. */
static inline stratus_voxels* random_voxels(
  stratus_context* context, const int64_t dimensions[3], double fill, int cluster, uint32_t* random)
{
  const size_t cells = (size_t)(dimensions[0] * dimensions[1] * dimensions[2]);
  int32_t* positions = malloc((cells + 1) * 3 * sizeof *positions);
  int32_t corner[4][3];
  size_t count = 0;
  stratus_voxels* voxels = NULL;
  for (int b = 0; b < 4; ++b) {
    for (int a = 0; a < 3; ++a) {
      corner[b][a] = (int32_t)(unit_random(random) * (double)dimensions[a]);
    }
  }
  for (int32_t k = 0; k < dimensions[2]; ++k) {
    for (int32_t j = 0; j < dimensions[1]; ++j) {
      for (int32_t i = 0; i < dimensions[0]; ++i) {
        bool inside = cluster == 0;
        for (int b = 0; b < 4; ++b) {
          inside |= abs(i - corner[b][0]) < cluster && abs(j - corner[b][1]) < cluster && abs(k - corner[b][2]) < cluster;
        }
        if (inside && unit_random(random) < fill) {
          positions[3 * count] = i;
          positions[3 * count + 1] = j;
          positions[3 * count + 2] = k;
          ++count;
        }
      }
    }
  }
  assert_int_equal(stratus_voxels_create_list(context, dimensions, positions, count, &voxels), STRATUS_OK);
  free(positions);
  return voxels;
}

/* Makes a ray along an axis that is slow along the two others, and runs beside a plane between voxels, at times between bricks. */
static inline void slow_ray(const int64_t dimensions[3], uint32_t* random, stratus_ray* ray)
{
  const int along = (int)(next_random(random) % 3);
  for (int a = 0; a < 3; ++a) {
    const double size = (double)dimensions[a], step = next_random(random) % 2 ? 1.0 : 4.0;
    if (a == along) {
      ray->direction[a] = next_random(random) % 2 ? 1.0 : -1.0;
      ray->origin[a] = (unit_random(random) * 2.0 - 0.5) * size;
    } else {
      ray->direction[a] = pow(10.0, -9.0 * unit_random(random)) * (next_random(random) % 2 ? 1.0 : -1.0);
      ray->origin[a] = floor(unit_random(random) * size / step) * step;
      ray->origin[a] += pow(10.0, -9.0 * unit_random(random)) * (unit_random(random) - 0.5) * (double)(next_random(random) % 8 != 0);
    }
  }
}

/* Makes a random ray of nine kinds: arbitrary rays, and hard ones along axes, through corners and edges, from faces, from inside, from
 * behind, short, or beside planes. */
static inline stratus_ray random_ray(const int64_t dimensions[3], uint32_t* random)
{
  stratus_ray ray = { .t_max = INFINITY };
  const uint32_t kind = next_random(random) % 9;
  for (int a = 0; a < 3; ++a) {
    const double size = (double)dimensions[a];
    ray.origin[a] = (unit_random(random) * 3.0 - 1.0) * size;
    ray.direction[a] = unit_random(random) * 2.0 - 1.0;
    if (kind == 1) { /* along edges and diagonals of voxels */
      ray.origin[a] = floor(ray.origin[a]);
      ray.direction[a] = (double)(next_random(random) % 3) - 1.0;
    } else if (kind == 2) { /* through the centres of voxels, along axes and diagonals */
      ray.origin[a] = floor(ray.origin[a]) + 0.5;
      ray.direction[a] = (double)(next_random(random) % 3) - 1.0;
    } else if (kind == 3) { /* from inside */
      ray.origin[a] = unit_random(random) * size;
    } else if (kind == 4) { /* from anywhere to a corner of a voxel */
      ray.direction[a] = floor(unit_random(random) * size) - ray.origin[a];
    }
  }
  if (kind == 5) {
    ray.t_min = unit_random(random);
    ray.t_max =
      ray.t_min + unit_random(random) * (double)dimensions[0] * (next_random(random) % 2 ? pow(10.0, -9.0 * unit_random(random)) : 1.0);
  }
  if (kind == 7 && next_random(random) % 8 == 0) {
    ray.t_max = -1e-6; /* an empty ray */
  }
  if (kind == 6) { /* almost along an axis */
    ray.direction[next_random(random) % 3] *= 1e-6;
  }
  if (kind == 8) {
    slow_ray(dimensions, random, &ray);
  }
  if (ray.direction[0] == 0.0 && ray.direction[1] == 0.0 && ray.direction[2] == 0.0) {
    ray.direction[next_random(random) % 3] = kind == 1 ? -1.0 : 1.0;
  }
  if (next_random(random) % 4 == 0) {
    ray.direction[next_random(random) % 3] *= -1.0; /* also turns 0 into -0 */
  }
  if (next_random(random) % 4 == 0) {
    ray.t_min -= unit_random(random) * 2.0 * (double)dimensions[0];
  }
  return ray;
}

/* Checks that the tree's hits equal the walk's to the bit. Rays are in the world of stratus_voxels_create_list(). */
static inline void compare_hits(
  stratus_context* context, const stratus_voxels* voxels, const stratus_tree* tree, const stratus_ray* rays, size_t count)
{
  stratus_hit* ours = malloc(count * sizeof *ours);
  stratus_hit* theirs = malloc(count * sizeof *theirs);
  assert_int_equal(stratus_voxels_first_hit(context, voxels, rays, count, theirs), STRATUS_OK);
  assert_int_equal(stratus_tree_first_hit(context, tree, rays, count, ours), STRATUS_OK);
  for (size_t i = 0; i < count; ++i) {
    const stratus_hit *a = &ours[i], *b = &theirs[i];
    if (memcmp(a->voxel, b->voxel, sizeof a->voxel) != 0 || a->t != b->t || a->face != b->face ||
      memcmp(a->normal, b->normal, sizeof a->normal) != 0) {
      const stratus_ray* r = &rays[i];
      fail_msg(
        "ray %zu from %.17g %.17g %.17g along %.17g %.17g %.17g, t %g..%g: voxel %d %d %d face %d at %.17g, not %d %d %d face %d at %.17g",
        i, r->origin[0], r->origin[1], r->origin[2], r->direction[0], r->direction[1], r->direction[2], r->t_min, r->t_max, a->voxel[0],
        a->voxel[1], a->voxel[2], a->face, a->t, b->voxel[0], b->voxel[1], b->voxel[2], b->face, b->t);
    }
    if (a->t < INFINITY && a->face >= 0) {
      assert_true(a->normal[a->face / 2] == (a->face % 2 ? 1.0f : -1.0f));
    }
  }
  free(ours);
  free(theirs);
}

#endif
