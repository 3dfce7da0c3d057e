/* SPDX-License-Identifier: BSD-3-Clause
 * First hits through every tree, compared with a walk from voxel to voxel in double precision. */
#include "first_hits.h"
#include "tree.h"
#include "testing.h"

#define RAYS 600

static void check_tree(stratus_context* context, const stratus_voxels* voxels, stratus_tree_method method, uint32_t* random)
{
  stratus_tree_options options = stratus_tree_options_default();
  stratus_tree* tree = NULL;
  stratus_ray rays[RAYS];
  int64_t dimensions[3];
  options.method = method;
  options.leaf_bricks = 1 + (int)(next_random(random) % 4);
  options.leaf_voxels = 1 + (int)(next_random(random) % 3);
  options.field_emptiness = 1.0 + (double)(next_random(random) % 5); /* so that small sets are split, too */
  stratus_voxels_dimensions(voxels, dimensions);
  for (int i = 0; i < RAYS; ++i) {
    rays[i] = random_ray(dimensions, random);
  }
  if (stratus_tree_create(context, voxels, &options, &tree) != STRATUS_OK) {
    fail_msg("%s: %s", stratus_tree_method_name(method), stratus_context_message(context));
  }
  if (stratus_tree_check(context, tree, voxels) != STRATUS_OK) {
    fail_msg("%s: %s", stratus_tree_method_name(method), stratus_context_message(context));
  }
  compare_hits(context, voxels, tree, rays, RAYS);
  stratus_tree_destroy(tree);
}

static void every_tree_hits_what_the_walk_hits(void** state)
{
  (void)state;
  uint32_t random = 1;
  for (int isa = 0; isa <= 2; ++isa) {
    stratus_context* context = host_with_isa(isa, 1 + isa % 2);
    for (int round = 0; round < (few_run() ? 8 : 30); ++round) {
      int64_t dimensions[3];
      for (int a = 0; a < 3; ++a) {
        dimensions[a] = 1 + (int64_t)(unit_random(&random) * (round % 3 == 0 ? 9 : 70));
      }
      const double fill = round % 5 == 0 ? 1.0 : round % 5 == 1 ? 0.003 : unit_random(&random);
      stratus_voxels* voxels = random_voxels(context, dimensions, fill, round % 4 == 3 ? 6 : 0, &random);
      for (int method = 0; method < STRATUS_TREE_METHODS; ++method) {
        const bool slow = method >= STRATUS_TREE_AC && stratus_voxels_count(voxels) > 5000;
        if (!slow) {
          check_tree(context, voxels, (stratus_tree_method)method, &random);
        }
      }
      stratus_voxels_destroy(voxels);
    }
    stratus_context_destroy(context);
  }
}

#define TILES 8 /* of 8 x 8 rays */

/* Rays of a picture in tiles of 8 x 8: through a point in or before the set, or parallel, at any angle or along the axes, through corners
 * of voxels or anywhere. Some begin late, end early, or are no rays at all, as those before which a picture has something opaque. */
static void make_picture(const int64_t dimensions[3], uint32_t* random, stratus_ray rays[TILES * 64])
{
  const bool parallel = next_random(random) % 2, aligned = next_random(random) % 3 == 0, limited = next_random(random) % 3 == 0;
  const double fine = 0.02 + 1.5 * unit_random(random) * unit_random(random), wide = 1.0 + 0.2 * unit_random(random);
  const double pitch = aligned && next_random(random) % 2 ? 0.5 : next_random(random) % 2 ? wide : fine;
  double eye[3], forward[3], right[3] = { 0 }, up[3] = { 0 }, away = 0.0;
  const int axis = (int)(next_random(random) % 3);
  for (int a = 0; a < 3; ++a) {
    eye[a] = floor(unit_random(random) * (double)dimensions[a] * 2.0) / 2.0;
    forward[a] = aligned ? (a == axis) : unit_random(random) - 0.5;
    away = fmax(away, (double)dimensions[a]);
  }
  for (int a = 0; a < 3; ++a) {
    forward[a] *= next_random(random) % 2 ? 1.0 : -1.0;
    eye[a] += (next_random(random) % 4 == 0 ? 0.0 : -1.5 * away * forward[a]) + (aligned ? 0.0 : unit_random(random));
  }
  right[(axis + 1) % 3] = pitch;
  up[(axis + 2) % 3] = pitch;
  for (int i = 0; i < TILES * 64; ++i) {
    const int x = i / 64 * 8 + i % 8 - TILES * 4, y = i % 64 / 8 - 4;
    rays[i] = (stratus_ray){ .t_max = INFINITY };
    for (int a = 0; a < 3; ++a) {
      const double offset = x * right[a] + y * up[a];
      rays[i].origin[a] = eye[a] + (parallel ? offset : 0.0);
      rays[i].direction[a] = forward[a] + (parallel ? 0.0 : offset / (1.5 * away));
    }
    if (limited && next_random(random) % 3 == 0) {
      rays[i].t_min = 4.0 * unit_random(random);
      rays[i].t_max = next_random(random) % 4 ? rays[i].t_min + 3.0 * unit_random(random) : -INFINITY;
    }
  }
}

/* Steps that the rays take, each in a call of its own. */
static uint64_t steps_alone(stratus_context* context, const stratus_tree* tree, const stratus_ray* rays)
{
  uint64_t steps = 0;
  for (int i = 0; i < TILES * 64; ++i) {
    stratus_hit hit;
    assert_int_equal(stratus_tree_first_hit(context, tree, rays + i, 1, &hit), STRATUS_OK);
    steps += hit.visited;
  }
  return steps;
}

/* Rays that run side by side form beams. Beams hit the same voxels as single rays, in fewer steps. */
static void beams_hit_what_the_walk_hits(void** state)
{
  (void)state;
  static stratus_ray rays[TILES * 64];
  static stratus_hit hits[TILES * 64];
  static const stratus_tree_method methods[4] = { STRATUS_TREE_DISTANCE, STRATUS_TREE_OCTANT, STRATUS_TREE_HYBRID, STRATUS_TREE_WIDE };
  for (int isa = 0; isa <= 2; ++isa) {
    uint32_t random = 11;
    uint64_t steps = 0, single = 0;
    stratus_context* context = host_with_isa(isa, 1);
    for (int round = 0; round < (few_run() ? 24 : 80); ++round) {
      int64_t dimensions[3];
      for (int a = 0; a < 3; ++a) {
        dimensions[a] = 1 + (int64_t)(unit_random(&random) * (round % 7 == 0 ? 9 : 150));
      }
      const double fill = round % 5 == 0 ? 1.0 : round % 5 == 1 ? 0.0003 : round % 5 == 2 ? 0.002 : unit_random(&random);
      stratus_voxels* voxels = random_voxels(context, dimensions, fill, round % 3 == 2 ? 6 : 0, &random);
      stratus_tree_options options = stratus_tree_options_default();
      stratus_tree* tree = NULL;
      options.method = methods[round % 4];
      options.field_emptiness = 1.0 + round / 4 % 4; /* many leaves */
      options.leaf_bricks = 1 + round % 7;
      assert_int_equal(stratus_tree_create(context, voxels, &options, &tree), STRATUS_OK);
      for (int picture = 0; picture < 8; ++picture) {
        make_picture(dimensions, &random, rays);
        compare_hits(context, voxels, tree, rays, TILES * 64);
        assert_int_equal(stratus_tree_first_hit(context, tree, rays, TILES * 64, hits), STRATUS_OK);
        for (int i = 0; i < TILES * 64; ++i) {
          steps += hits[i].visited;
        }
        single += steps_alone(context, tree, rays);
      }
      stratus_tree_destroy(tree);
      stratus_voxels_destroy(voxels);
    }
    print_message("%llu steps, %llu by single rays\n", (unsigned long long)steps, (unsigned long long)single);
    assert_true(steps < single / 2);
    stratus_context_destroy(context);
  }
}

static void long_rows_and_both_entry_sizes_hit_right(void** state)
{
  (void)state;
  uint32_t random = 5;
  stratus_context* context = host_with_isa(2, 2);
  /* Rays in floats end at extents of some 52000 voxels, where slack makes every position doubtful. */
  static const int64_t sizes[5][3] = { { 70000, 3, 2 }, { 3, 5000, 3 }, { 2, 2, 9000 }, { 12, 9, 50000 }, { 4, 262144, 3 } };
  for (int s = 0; s < 5; ++s) {
    for (int dense = 0; dense < 2; ++dense) { /* few voxels: entries of two bytes, many: of three */
      stratus_voxels* voxels = random_voxels(context, sizes[s], dense ? 0.02 : 0.0005, 0, &random);
      check_tree(context, voxels, STRATUS_TREE_OCTANT, &random);
      if (s > 0) {
        check_tree(context, voxels, STRATUS_TREE_DISTANCE, &random);
      }
      check_tree(context, voxels, STRATUS_TREE_HYBRID, &random);
      stratus_voxels_destroy(voxels);
    }
  }
  stratus_context_destroy(context);
}

static void bits_do_not_depend_on_threads(void** state)
{
  (void)state;
  enum { COUNT = 5000 };
  static stratus_ray rays[COUNT];
  static stratus_hit hits[2][COUNT];
  const int64_t dimensions[3] = { 60, 50, 70 };
  for (int method = 0; method < STRATUS_TREE_METHODS; ++method) {
    size_t size[2];
    void* bytes[2];
    for (int threads = 1; threads <= 2; ++threads) {
      uint32_t random = 9;
      stratus_context* context = host_with_isa(2, threads);
      stratus_voxels* voxels = random_voxels(context, dimensions, 0.01, 0, &random);
      stratus_tree_options options = stratus_tree_options_default();
      stratus_tree* tree = NULL;
      options.method = (stratus_tree_method)method;
      options.field_emptiness = 2.0;
      for (int i = 0; i < COUNT; ++i) {
        rays[i] = random_ray(dimensions, &random);
      }
      assert_int_equal(stratus_tree_create(context, voxels, &options, &tree), STRATUS_OK);
      assert_int_equal(stratus_tree_first_hit(context, tree, rays, COUNT, hits[threads - 1]), STRATUS_OK);
      size[threads - 1] = stratus_tree_bytes(tree);
      bytes[threads - 1] = malloc(size[threads - 1]);
      stratus_tree_save(tree, bytes[threads - 1]);
      stratus_tree_destroy(tree);
      stratus_voxels_destroy(voxels);
      stratus_context_destroy(context);
    }
    assert_int_equal(size[0], size[1]);
    assert_memory_equal(bytes[0], bytes[1], size[0]);
    for (int i = 0; i < COUNT; ++i) {
      assert_true(hits[0][i].t == hits[1][i].t && hits[0][i].face == hits[1][i].face && hits[0][i].visited == hits[1][i].visited);
      assert_memory_equal(hits[0][i].voxel, hits[1][i].voxel, sizeof hits[0][i].voxel);
    }
    free(bytes[0]);
    free(bytes[1]);
  }
}

/* One voxel in a volume of given position, spacing, direction and mirror: rays that are known to hit it must hit it. */
static void one_voxel_is_hit_where_it_is(double offset, double spacing, double far)
{
  stratus_context* context = host_with_isa(2, 1);
  uint8_t values[5 * 6 * 7] = { 0 };
  stratus_volume volume = stratus_volume_default();
  stratus_criterion criterion = stratus_criterion_default();
  stratus_voxels* voxels = NULL;
  stratus_tree* tree = NULL;
  values[(3 * 6 + 2) * 5 + 4] = 9;
  volume.values = values;
  volume.type = STRATUS_UINT8;
  volume.dimensions[0] = 5;
  volume.dimensions[1] = 6;
  volume.dimensions[2] = 7;
  for (int a = 0; a < 3; ++a) {
    volume.origin[a] = offset * (a + 1);
    volume.spacing[a] = spacing * (a + 1);
  }
  volume.matrix[0] = -1.0; /* mirrored along x */
  criterion.lower = 5;
  assert_int_equal(stratus_voxels_create(context, &volume, &criterion, &voxels), STRATUS_OK);
  assert_int_equal(stratus_voxels_count(voxels), 1);
  for (int method = 0; method < STRATUS_TREE_METHODS; ++method) {
    stratus_tree_options options = stratus_tree_options_default();
    options.method = (stratus_tree_method)method;
    assert_int_equal(stratus_tree_create(context, voxels, &options, &tree), STRATUS_OK);
    for (int axis = 0; axis < 3; ++axis) {
      for (int side = 0; side < 2; ++side) {
        const int index[3] = { 4, 2, 3 };
        stratus_ray ray = { .t_max = INFINITY };
        stratus_hit hit;
        double center[3], half = spacing * (axis + 1) * 0.5;
        for (int a = 0; a < 3; ++a) {
          center[a] = (volume.origin[a] + volume.spacing[a] * index[a]) * (a == 0 ? -1.0 : 1.0);
          ray.origin[a] = center[a] + spacing * (a + 1) * 0.21;
        }
        ray.origin[axis] = center[axis] + (side ? 1.0 : -1.0) * (half + far * spacing);
        ray.direction[axis] = side ? -2.0 : 2.0;
        assert_int_equal(stratus_tree_first_hit(context, tree, &ray, 1, &hit), STRATUS_OK);
        assert_true(fabs(hit.t * 2.0 - far * spacing) <= 1e-9 * spacing + 4e-15 * (fabs(center[axis]) + far * spacing));
        assert_int_equal(hit.voxel[0], 4);
        assert_int_equal(hit.voxel[1], 2);
        assert_int_equal(hit.voxel[2], 3);
        assert_true(hit.normal[axis] == (side ? 1.0f : -1.0f));
        ray.t_max = hit.t * 0.99;
        assert_int_equal(stratus_tree_first_hit(context, tree, &ray, 1, &hit), STRATUS_OK);
        assert_true(hit.t == INFINITY && hit.voxel[0] == -1 && hit.face == -1);
        ray.t_max = INFINITY;
        ray.origin[axis] = center[axis]; /* from inside */
        assert_int_equal(stratus_tree_first_hit(context, tree, &ray, 1, &hit), STRATUS_OK);
        assert_true(hit.t == 0.0 && hit.face == -1 && hit.normal[axis] == (side ? 1.0f : -1.0f));
      }
    }
    stratus_tree_destroy(tree);
  }
  stratus_voxels_destroy(voxels);
  stratus_context_destroy(context);
}

static void far_rays_large_coordinates_and_small_voxels_hit(void** state)
{
  (void)state;
  one_voxel_is_hit_where_it_is(0.0, 1.0, 3.0);
  one_voxel_is_hit_where_it_is(0.0, 1.0, 1e6);
  one_voxel_is_hit_where_it_is(6e6, 1.0, 3.0);
  one_voxel_is_hit_where_it_is(6e6, 10.0, 1e5);
  one_voxel_is_hit_where_it_is(0.0, 1e-6, 3.0);
  one_voxel_is_hit_where_it_is(0.0, 1.0, 1.0);
}

static void no_voxel_no_hit(void** state)
{
  (void)state;
  stratus_context* context = host_with_isa(2, 2);
  const int64_t dimensions[3] = { 8, 8, 8 };
  stratus_voxels* voxels = NULL;
  assert_int_equal(stratus_voxels_create_list(context, dimensions, NULL, 0, &voxels), STRATUS_OK);
  for (int method = 0; method < STRATUS_TREE_METHODS; ++method) {
    stratus_tree_options options = stratus_tree_options_default();
    stratus_tree_statistics statistics;
    stratus_tree* tree = NULL;
    options.method = (stratus_tree_method)method;
    const stratus_ray ray = { { 4, 4, -3 }, { 0, 0, 1 }, 0, INFINITY };
    stratus_hit hit;
    assert_int_equal(stratus_tree_create(context, voxels, &options, &tree), STRATUS_OK);
    stratus_tree_get_statistics(tree, &statistics);
    assert_int_equal(statistics.nodes, 0);
    assert_int_equal(stratus_tree_first_hit(context, tree, &ray, 1, &hit), STRATUS_OK);
    assert_true(hit.t == INFINITY && hit.voxel[0] == -1 && hit.voxel[1] == -1 && hit.voxel[2] == -1);
    assert_int_equal(stratus_tree_check(context, tree, voxels), STRATUS_OK);
    stratus_tree_destroy(tree);
  }
  stratus_voxels_destroy(voxels);
  stratus_context_destroy(context);
}

static void rays_that_are_none_are_refused(void** state)
{
  (void)state;
  stratus_context* context = host_with_isa(2, 2);
  uint32_t random = 3;
  const int64_t dimensions[3] = { 12, 12, 12 };
  stratus_voxels* voxels = random_voxels(context, dimensions, 0.1, 0, &random);
  static const int methods[2] = { STRATUS_TREE_OCTANT, STRATUS_TREE_SAH };
  for (int m = 0; m < 2; ++m) {
    stratus_tree_options options = stratus_tree_options_default();
    stratus_tree* tree = NULL;
    options.method = (stratus_tree_method)methods[m];
    assert_int_equal(stratus_tree_create(context, voxels, &options, &tree), STRATUS_OK);
    for (int wrong = 0; wrong < 7; ++wrong) {
      stratus_ray rays[40];
      stratus_hit hits[40];
      for (int i = 0; i < 40; ++i) {
        rays[i] = random_ray(dimensions, &random);
      }
      stratus_ray* ray = &rays[17];
      if (wrong == 0) {
        ray->direction[0] = ray->direction[1] = ray->direction[2] = 0.0;
      } else if (wrong == 1) {
        ray->origin[1] = NAN;
      } else if (wrong == 2) {
        ray->direction[2] = INFINITY;
      } else if (wrong == 3) {
        ray->t_min = -INFINITY;
      } else if (wrong == 4) {
        ray->t_max = NAN;
      } else if (wrong == 5) {
        ray->direction[0] = ray->direction[1] = ray->direction[2] = 1e-300;
      } else {
        ray->origin[0] = ray->origin[1] = ray->origin[2] = 1e308;
      }
      assert_int_equal(stratus_tree_first_hit(context, tree, rays, 40, hits), STRATUS_INVALID_ARGUMENT);
      assert_non_null(strstr(stratus_context_message(context), "ray 17"));
      assert_int_equal(stratus_voxels_first_hit(context, voxels, rays, 40, hits), STRATUS_INVALID_ARGUMENT);
      assert_non_null(strstr(stratus_context_message(context), "ray 17"));
    }
    assert_int_equal(stratus_tree_first_hit(context, tree, NULL, 1, NULL), STRATUS_INVALID_ARGUMENT);
    assert_int_equal(stratus_tree_first_hit(context, tree, NULL, 0, NULL), STRATUS_OK);
    stratus_tree_destroy(tree);
  }
  stratus_voxels_destroy(voxels);
  stratus_context_destroy(context);
}

int test_first_hit(void)
{
  const struct CMUnitTest tests[] = { cmocka_unit_test(every_tree_hits_what_the_walk_hits), cmocka_unit_test(beams_hit_what_the_walk_hits),
    cmocka_unit_test(long_rows_and_both_entry_sizes_hit_right), cmocka_unit_test(bits_do_not_depend_on_threads),
    cmocka_unit_test(far_rays_large_coordinates_and_small_voxels_hit), cmocka_unit_test(no_voxel_no_hit),
    cmocka_unit_test(rays_that_are_none_are_refused) };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
