/* SPDX-License-Identifier: BSD-3-Clause
 * First hits in wide hierarchies: beams of rays that run side by side, that part, that are none, and the rays that are left. Hits are those
 * of the walk from voxel to voxel to the bit. */
#include "first_hits.h"
#include "tree.h"

#define BEAM 64
#define BEAMS 5
#define RAYS (BEAMS * BEAM + 17) /* the last 17 are no whole beam */

/* ---------------------------------------------------------------- sets */

#define SETS 8
#define MOST 20000

/* Makes one of SETS sets: clouds in a large cube, a full ball, long rows along each axis, one voxel, 17 bricks, noise. */
static stratus_voxels* make_set(stratus_context* context, int number, int64_t dimensions[3], uint32_t* random)
{
  static const int64_t sizes[SETS][3] = { { 1100, 900, 1000 }, { 50, 50, 50 }, { 262144, 5, 6 }, { 4, 9000, 5 }, { 6, 3, 60000 },
    { 700, 600, 500 }, { 68, 4, 4 }, { 700, 600, 500 } };
  static int32_t at[MOST][3];
  stratus_voxels* voxels = NULL;
  size_t count = 0;
  double middle[3] = { 0.0 };
  memcpy(dimensions, sizes[number], sizeof sizes[number]);
  for (int i = 0; i < MOST; ++i) {
    bool inside = true;
    double squares = 0.0;
    for (int a = 0; a < 3; ++a) {
      const double size = (double)dimensions[a];
      if (number == 0) {
        middle[a] = i % 2000 == 0 ? unit_random(random) * size : middle[a];
        at[count][a] = (int32_t)(middle[a] + 60.0 * (unit_random(random) + unit_random(random) + unit_random(random) - 1.5));
      } else {
        at[count][a] = (int32_t)(unit_random(random) * size);
      }
      squares += pow(at[count][a] + 0.5 - 0.5 * size, 2.0);
      inside &= at[count][a] >= 0 && at[count][a] < dimensions[a];
    }
    inside &= number != 1 || squares < 600.0;
    inside &= number != 5 || i == 0;
    inside &= number < 2 || number > 4 || i % 8 == 0;
    count += inside;
  }
  assert_int_equal(stratus_voxels_create_list(context, dimensions, at[0], count, &voxels), STRATUS_OK);
  return voxels;
}

static stratus_tree* make_tree(stratus_context* context, const stratus_voxels* voxels)
{
  stratus_tree_options options = stratus_tree_options_default();
  stratus_tree* tree = NULL;
  options.method = STRATUS_TREE_WIDE;
  assert_int_equal(stratus_tree_create(context, voxels, &options, &tree), STRATUS_OK);
  assert_true(tree->wide.node_count > 0);
  return tree;
}

/* ---------------------------------------------------------------- beams */

typedef enum beam_kind {
  PINHOLE,    /* from one origin */
  PARALLEL,   /* side by side */
  STRADDLING, /* from one origin, around an axis: into four octants */
  LATTICE,    /* along an axis or a diagonal, through corners, edges or middles of voxels */
  INSIDE,     /* from within the set */
  FAR,        /* from one origin far away */
  SCATTERED,  /* one direction, from anywhere */
  CORNERS,    /* from one origin into one octant, along three axes */
  BEAM_KINDS
} beam_kind;

static void make_beam(const int64_t dimensions[3], beam_kind kind, double pitch, uint32_t* random, stratus_ray rays[BEAM])
{
  double eye[3], forward[3], aim[3], most = 0.0;
  const int axis = (int)(next_random(random) % 3), first = (axis + 1) % 3, second = (axis + 2) % 3;
  const double half = next_random(random) % 2 ? 0.5 : 0.0, sign = next_random(random) % 2 ? 1.0 : -1.0;
  for (int a = 0; a < 3; ++a) {
    most = fmax(most, (double)dimensions[a]);
  }
  for (int a = 0; a < 3; ++a) {
    aim[a] = (0.2 + 0.6 * unit_random(random)) * (double)dimensions[a];
    forward[a] = unit_random(random) - 0.5;
    if (kind == STRADDLING) {
      forward[a] = a == axis ? sign : 0.0;
    } else if (kind == LATTICE) {
      aim[a] = floor(aim[a]) + half;
      forward[a] = a == axis ? sign : (double)(next_random(random) % 3) - 1.0;
    }
    eye[a] = aim[a] - (kind == INSIDE ? 0.0 : kind == FAR ? 3e8 : floor(1.5 * most)) * forward[a];
  }
  for (int i = 0; i < BEAM; ++i) {
    const double x = (i % 8 - 3.5) * pitch, y = (double)(i / 8) * pitch - 3.5 * pitch;
    rays[i] = (stratus_ray){ .t_max = INFINITY };
    for (int a = 0; a < 3; ++a) {
      const double offset = a == first ? x : a == second ? y : 0.0;
      rays[i].origin[a] = eye[a];
      if (kind == SCATTERED) {
        rays[i].origin[a] = unit_random(random) * (double)dimensions[a];
        rays[i].direction[a] = forward[a];
      } else if (kind == CORNERS) {
        rays[i].origin[a] = -1.0;
        rays[i].direction[a] = a == i % 3 ? 1.0 : 0.3 * unit_random(random);
      } else if (kind == PARALLEL || kind == LATTICE) {
        rays[i].origin[a] += kind == LATTICE ? floor(offset / pitch) : offset;
        rays[i].direction[a] = forward[a];
      } else {
        rays[i].direction[a] = aim[a] + offset - eye[a];
      }
      rays[i].direction[a] += kind == INSIDE ? forward[a] * most : 0.0;
    }
  }
}

/* Lets some rays of a beam begin late, end early, or be none. */
static void limit_beam(double length, uint32_t* random, stratus_ray rays[BEAM])
{
  const uint32_t kind = next_random(random) % 4;
  for (int i = 0; i < BEAM; ++i) {
    double longest = 0.0;
    for (int a = 0; a < 3; ++a) {
      longest = fmax(longest, fabs(rays[i].direction[a]));
    }
    if (kind == 3 || next_random(random) % 3 == 0) {
      rays[i].t_min = unit_random(random) * 2.0 * length / longest;
      rays[i].t_max = kind == 0 || (kind == 3 && i % 9) ? -INFINITY : rays[i].t_min + unit_random(random) * length / longest;
    }
  }
}

static void beams_of_all_kinds_hit_what_the_walk_hits(void** state)
{
  (void)state;
  static stratus_ray rays[RAYS];
  for (int isa = 0; isa <= 2; ++isa) {
    uint32_t random = 23;
    stratus_context* context = host_with_isa(isa, 1 + isa % 2);
    for (int set = 0; set < SETS; ++set) {
      int64_t dimensions[3];
      stratus_voxels* voxels = make_set(context, set, dimensions, &random);
      stratus_tree* tree = make_tree(context, voxels);
      const double length = fmin((double)dimensions[0], fmin((double)dimensions[1], (double)dimensions[2]));
      const int rounds = set >= 2 && set <= 4 ? 6 : 40; /* the walk takes its time in long sets */
      for (int round = 0; round < rounds; ++round) {
        for (int beam = 0; beam * BEAM < RAYS; ++beam) {
          stratus_ray made[BEAM];
          const beam_kind kind = (beam_kind)(next_random(&random) % BEAM_KINDS);
          make_beam(dimensions, kind, length * pow(10.0, -3.5 * unit_random(&random)), &random, made);
          if (next_random(&random) % 3 == 0) {
            limit_beam(length, &random, made);
          }
          const int left = RAYS - beam * BEAM;
          memcpy(rays + beam * BEAM, made, (size_t)(left < BEAM ? left : BEAM) * sizeof *rays);
        }
        compare_hits(context, voxels, tree, rays, RAYS);
      }
      stratus_tree_destroy(tree);
      stratus_voxels_destroy(voxels);
    }
    stratus_context_destroy(context);
  }
}

/* Adds what each ray visits in a call of its own. */
static uint64_t visit_alone(stratus_context* context, const stratus_tree* tree, const stratus_ray rays[BEAM], uint32_t visited[BEAM])
{
  uint64_t sum = 0;
  for (int i = 0; i < BEAM; ++i) {
    stratus_hit hit;
    assert_int_equal(stratus_tree_first_hit(context, tree, rays + i, 1, &hit), STRATUS_OK);
    visited[i] = hit.visited;
    sum += hit.visited;
  }
  return sum;
}

static void rays_side_by_side_share_what_they_visit(void** state)
{
  (void)state;
  for (int isa = 0; isa <= 2; ++isa) {
    uint32_t random = 31, single[BEAM];
    int64_t dimensions[3];
    uint64_t apart = 0, together = 0;
    stratus_context* context = host_with_isa(isa, 1);
    stratus_voxels* voxels = make_set(context, 0, dimensions, &random);
    stratus_tree* tree = make_tree(context, voxels);
    for (int round = 0; round < 100; ++round) {
      stratus_ray rays[BEAM];
      stratus_hit hits[BEAM];
      make_beam(dimensions, round % 2 ? PINHOLE : PARALLEL, 0.2, &random, rays);
      assert_int_equal(stratus_tree_first_hit(context, tree, rays, BEAM, hits), STRATUS_OK);
      apart += visit_alone(context, tree, rays, single);
      for (int i = 0; i < BEAM; ++i) {
        together += hits[i].visited;
        assert_true(hits[i].visited <= single[i] + 64 || i == 0); /* the first ray has the remainder, too */
      }
    }
    print_message("%llu visits, %llu by single rays\n", (unsigned long long)together, (unsigned long long)apart);
    assert_true(apart > 64 * 100 && together < apart / 16);
    stratus_tree_destroy(tree);
    stratus_voxels_destroy(voxels);
    stratus_context_destroy(context);
  }
}

/* Rays that share a direction but not their nodes are traced one by one: each visits as many nodes as a single ray. */
static void rays_far_from_each_other_make_no_beam(void** state)
{
  (void)state;
  for (int isa = 0; isa <= 2; ++isa) {
    uint32_t random = 37, single[BEAM];
    int64_t dimensions[3];
    stratus_context* context = host_with_isa(isa, 1);
    stratus_voxels* voxels = make_set(context, 7, dimensions, &random);
    stratus_tree* tree = make_tree(context, voxels);
    for (int round = 0; round < 40; ++round) {
      stratus_ray rays[BEAM];
      stratus_hit hits[BEAM];
      make_beam(dimensions, round % 2 ? SCATTERED : CORNERS, 1.0, &random, rays);
      assert_int_equal(stratus_tree_first_hit(context, tree, rays, BEAM, hits), STRATUS_OK);
      visit_alone(context, tree, rays, single);
      for (int i = 0; i < BEAM; ++i) {
        assert_int_equal(hits[i].visited, single[i]);
      }
    }
    stratus_tree_destroy(tree);
    stratus_voxels_destroy(voxels);
    stratus_context_destroy(context);
  }
}

static void rays_from_very_far_visit_no_place_without_a_child(void** state)
{
  (void)state;
  for (int isa = 0; isa <= 2; ++isa) {
    stratus_context* context = host_with_isa(isa, 1);
    rays_from_very_far_visit_only_children(context, context);
    stratus_context_destroy(context);
  }
}

int test_wide_hits(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(rays_from_very_far_visit_no_place_without_a_child),
    cmocka_unit_test(beams_of_all_kinds_hit_what_the_walk_hits),
    cmocka_unit_test(rays_side_by_side_share_what_they_visit),
    cmocka_unit_test(rays_far_from_each_other_make_no_beam),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
