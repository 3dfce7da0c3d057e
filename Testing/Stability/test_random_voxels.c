/* SPDX-License-Identifier: BSD-3-Clause
 * 1,000 random sets of voxels, each in a tree of each of the methods and of random options: rays hit what a plain walk from voxel to voxel
 * hits, to the bit. */
#include "first_hits.h"
#include "testing.h"
#include "tree.h"

#define ALL 1000
#define RAYS 200
#define SLOW_VOXELS 3000 /* clusterings are quadratic: larger sets take the other methods */

static stratus_tree_options choose_tree(stratus_tree_method method, uint32_t* random)
{
  static const double bandwidths[] = { 0.0, 0.0, 1.0, 3.5, 40.0 };
  stratus_tree_options options = stratus_tree_options_default();
  options.method = method;
  options.max_depth = next_random(random) % 3 ? options.max_depth : 1 + (int)(next_random(random) % 12);
  options.leaf_bricks = 1 + (int)(next_random(random) % 9);
  options.leaf_voxels = 1 + (int)(next_random(random) % 9);
  options.field_emptiness = next_random(random) % 2 ? 1.0 + 6.0 * unit_random(random) : options.field_emptiness;
  options.field_bricks = next_random(random) % 3 ? options.field_bricks : 1 + (int64_t)(next_random(random) % 500);
  options.uniform = next_random(random) % 2 ? unit_random(random) : options.uniform;
  options.paper_threshold = next_random(random) % 2 ? 20.0 * unit_random(random) : options.paper_threshold;
  options.bandwidth = bandwidths[next_random(random) % 5];
  options.exact_density = next_random(random) % 4 == 0;
  options.density_per_node = next_random(random) % 4 == 0;
  options.agglomerative_by_edges = next_random(random) % 2 == 0;
  return options;
}

static void trees_hit_what_the_walk_hits(void** state)
{
  (void)state;
  static stratus_ray rays[RAYS];
  stratus_context* contexts[2] = { NULL, NULL };
  int64_t voxel_count = 0, trees = 0;
  for (int i = 0; i < 2; ++i) {
    stratus_context_options options = stratus_context_options_default();
    options.device = "host";
    options.threads = 1 + i;
    assert_int_equal(stratus_context_create(&options, &contexts[i], NULL, 0), STRATUS_OK);
  }
  test_seeds seeds = test_seeds_of(TEST_SOME(ALL), ALL);
  while (test_next(&seeds)) {
    uint32_t random = seeds.seed * 2654435761u + 99u;
    stratus_context* context = contexts[seeds.seed % 2];
    const uint32_t kind = next_random(&random) % 6;
    int64_t dimensions[3];
    for (int a = 0; a < 3; ++a) {
      dimensions[a] = 1 + (int64_t)(unit_random(&random) * (kind == 0 ? 5.0 : kind == 1 ? 100.0 : 40.0));
    }
    if (kind == 2) { /* a row or a plate */
      dimensions[next_random(&random) % 3] = 1;
      dimensions[next_random(&random) % 3] = 1 + (int64_t)(next_random(&random) % 400);
    }
    const double fill = kind == 3 ? 1.0 : pow(10.0, -4.0 * unit_random(&random));
    stratus_voxels* voxels = random_voxels(context, dimensions, fill, kind >= 4 ? 2 + (int)(next_random(&random) % 9) : 0, &random);
    const int64_t count = (int64_t)stratus_voxels_count(voxels);
    for (int i = 0; i < RAYS; ++i) {
      rays[i] = random_ray(dimensions, &random);
    }
    for (int method = 0; method < STRATUS_TREE_METHODS; ++method) {
      const stratus_tree_options options = choose_tree((stratus_tree_method)method, &random);
      const bool slow = method >= STRATUS_TREE_AC || method == STRATUS_TREE_HYBRID_PAPER || options.exact_density;
      stratus_tree* tree = NULL;
      if (slow && count > SLOW_VOXELS) {
        continue;
      }
      if (stratus_tree_create(context, voxels, &options, &tree) != STRATUS_OK || stratus_tree_check(context, tree, voxels) != STRATUS_OK) {
        fail_msg("%s: %s", stratus_tree_method_name(options.method), stratus_context_message(context));
      }
      compare_hits(context, voxels, tree, rays, RAYS);
      stratus_tree_destroy(tree);
      ++trees;
    }
    voxel_count += count;
    stratus_voxels_destroy(voxels);
  }
  print_message("             %u sets, %lld voxels, %lld trees\n", seeds.end, (long long)voxel_count, (long long)trees);
  assert_true(!test_many(&seeds, 40) || (voxel_count > 20000 && trees > 8 * (int64_t)seeds.end));
  stratus_context_destroy(contexts[0]);
  stratus_context_destroy(contexts[1]);
}

int test_random_voxels(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(trees_hit_what_the_walk_hits),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
