/* SPDX-License-Identifier: BSD-3-Clause
 * Random voxels and rays, and a comparison of a tree's first hits with the plain walk's. */
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

/* fill: share of the voxels, 0..1, that are effective. cluster > 0: these are in four random cubes of that half edge. */
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

/* Makes a ray along an axis that is slow along the two others, and runs along a plane between voxels, at times between bricks. */
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
 * behind, short, or along planes. */
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

/* Checks a wide hierarchy of one voxel: its node has one child and 15 places without. From very far away, all planes are at one distance as
 * floats round it, so that the boxes of all 16 places seem to be met. Host: builds the tree. */
static inline void rays_from_very_far_visit_only_children(stratus_context* host, stratus_context* context)
{
  enum { RAYS = 4000, VISITS = 6 }; /* visits: the leaf, the node and the brick, and again in doubles */
  static const int64_t dimensions[3] = { 9, 9, 9 };
  static const int32_t position[3] = { 3, 4, 5 };
  static stratus_ray rays[RAYS];
  static stratus_hit ours[RAYS], theirs[RAYS];
  stratus_tree_options options = stratus_tree_options_default();
  stratus_voxels* voxels = NULL;
  stratus_tree* tree = NULL;
  uint32_t random = 5;
  options.method = STRATUS_TREE_WIDE;
  assert_int_equal(stratus_voxels_create_list(host, dimensions, position, 1, &voxels), STRATUS_OK);
  assert_int_equal(stratus_tree_create(host, voxels, &options, &tree), STRATUS_OK);
  for (int i = 0; i < RAYS; ++i) {
    const double far = pow(10.0, 30.0 * unit_random(&random));
    rays[i] = (stratus_ray){ .t_max = INFINITY };
    for (int a = 0; a < 3; ++a) {
      rays[i].direction[a] = unit_random(&random) - 0.5;
      rays[i].origin[a] = position[a] + unit_random(&random) - far * rays[i].direction[a];
    }
  }
  assert_int_equal(stratus_voxels_first_hit(host, voxels, rays, RAYS, theirs), STRATUS_OK);
  assert_int_equal(stratus_tree_first_hit(context, tree, rays, RAYS, ours), STRATUS_OK);
  for (int i = 0; i < RAYS; ++i) {
    if (ours[i].visited > VISITS || (ours[i].t < INFINITY && ours[i].t != theirs[i].t)) {
      fail_msg("ray %d from %g %g %g: %u visits, hit at %.17g; by the walk at %.17g", i, rays[i].origin[0], rays[i].origin[1],
        rays[i].origin[2], ours[i].visited, ours[i].t, theirs[i].t);
    }
  }
  stratus_tree_destroy(tree);
  stratus_voxels_destroy(voxels);
}

#endif
