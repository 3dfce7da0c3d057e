/* SPDX-License-Identifier: BSD-3-Clause
 * Options of trees: what is out of range is refused, and an option reaches its builder. */
#include "first_hits.h"

#include "bvh.h"
#include "tree.h"

static stratus_context* context;

static void clusters_merge_by_the_distance_asked_for(void** state)
{
  const int64_t dimensions[3] = { 40, 30, 50 };
  uint32_t random = 1;
  double cost[2];
  (void)state;
  stratus_voxels* voxels = random_voxels(context, dimensions, 0.01, 0, &random);
  const int64_t count = (int64_t)stratus_voxels_count(voxels);
  stratus_box* boxes = malloc((size_t)count * sizeof *boxes);
  assert_non_null(boxes);
  for (int by_edges = 0; by_edges <= 1; ++by_edges) {
    stratus_tree_options options = stratus_tree_options_default();
    assert_int_equal(options.agglomerative_by_edges, 0);
    options.method = STRATUS_TREE_AC;
    options.agglomerative_by_edges = by_edges;
    stratus_tree* tree = NULL;
    assert_int_equal(stratus_tree_create(context, voxels, &options, &tree), STRATUS_OK);
    assert_int_equal(tree->brick_count, count);
    for (int64_t i = 0; i < count; ++i) { /* a brick of a hierarchy's leaf has one voxel */
      const stratus_brick* brick = tree->bricks + i;
      const int bit = __builtin_ctzll(brick->mask);
      const int32_t inside[3] = { bit & 3, bit >> 2 & 3, bit >> 4 };
      for (int a = 0; a < 3; ++a) {
        boxes[i].lo[a] = brick->at[a] * 4 + inside[a];
        boxes[i].hi[a] = boxes[i].lo[a] + 1;
      }
    }
    const stratus_bvh_options wanted = { STRATUS_TREE_AC, 1, 32, by_edges ? STRATUS_BVH_EDGES : STRATUS_BVH_SURFACE };
    stratus_bvh bvh = { .nodes = NULL };
    assert_int_equal(stratus_bvh_create(context, boxes, (uint32_t)count, &wanted, &bvh), STRATUS_OK);
    stratus_tree_statistics s;
    stratus_tree_get_statistics(tree, &s);
    cost[by_edges] = s.sah;
    assert_true(s.sah == stratus_bvh_sah(bvh.nodes, bvh.node_count));
    stratus_bvh_release(context, &bvh);
    stratus_tree_destroy(tree);
  }
  assert_true(cost[0] != cost[1]);
  free(boxes);
  stratus_voxels_destroy(voxels);
}

static void an_option_out_of_range_is_refused_with_its_range(void** state)
{
  const int64_t dimensions[3] = { 5, 5, 5 };
  uint32_t random = 2;
  (void)state;
  stratus_voxels* voxels = random_voxels(context, dimensions, 0.5, 0, &random);
  for (int value = -1; value <= 2; ++value) {
    stratus_tree_options options = stratus_tree_options_default();
    stratus_tree* tree = NULL;
    options.agglomerative_by_edges = value;
    const bool good = value == 0 || value == 1;
    assert_int_equal(stratus_tree_create(context, voxels, &options, &tree), good ? STRATUS_OK : STRATUS_INVALID_ARGUMENT);
    assert_true((tree != NULL) == good);
    assert_true(good || strstr(stratus_context_message(context), value < 0 ? "edges -1 outside 0..1" : "edges 2 outside 0..1"));
    stratus_tree_destroy(tree);
  }
  stratus_voxels_destroy(voxels);
}

int test_tree_options(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(clusters_merge_by_the_distance_asked_for),
    cmocka_unit_test(an_option_out_of_range_is_refused_with_its_range),
  };
  stratus_context_options options = stratus_context_options_default();
  options.device = "host";
  options.threads = 1;
  if (stratus_context_create(&options, &context, NULL, 0) != STRATUS_OK) {
    return 1;
  }
  const int failed = cmocka_run_group_tests(tests, NULL, NULL);
  stratus_context_destroy(context);
  return failed;
}
