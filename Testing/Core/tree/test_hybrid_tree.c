/* SPDX-License-Identifier: BSD-3-Clause
 * Shapes of hybrid trees. Whatever the set and the options, every brick is in one leaf, boxes are tight, and leaves are as small as the
 * options say. */
#include "hybrid_shape.h"

static stratus_context* context;
static voxel_set set;

static stratus_tree_options random_options(stratus_tree_method method, uint32_t* random)
{
  stratus_tree_options options = hybrid_options(method);
  options.max_depth = random_below(random, 3) ? 32 : 1 + (int)random_below(random, 10);
  options.leaf_bricks = 1 + (int)random_below(random, 8);
  options.field_bricks = random_below(random, 3) ? 1 << random_below(random, 16) : 1 << 22;
  options.field_emptiness = 1.0 + (double)random_below(random, 40);
  options.uniform = (double)random_below(random, 4) / 20.0;
  options.paper_threshold = (double)random_below(random, 12);
  options.bandwidth = random_below(random, 2) ? 0.0 : 1.0 + (double)random_below(random, 50);
  options.exact_density |= (int)random_below(random, 2);
  options.density_per_node |= (int)random_below(random, 2);
  return options;
}

static void random_set(uint32_t* random)
{
  set_begin(&set, 1 + random_below(random, 120), 1 + random_below(random, 120), 1 + random_below(random, 120));
  set_add_noise(&set, random_below(random, 1200), random);
  for (int64_t boxes = random_below(random, 4); boxes > 0; --boxes) {
    int64_t lo[3], hi[3];
    for (int a = 0; a < 3; ++a) {
      lo[a] = random_below(random, set.dimensions[a]);
      hi[a] = lo[a] + 1 + random_below(random, 14);
      hi[a] = hi[a] < set.dimensions[a] ? hi[a] : set.dimensions[a];
    }
    set_add_box(&set, lo[0], hi[0], lo[1], hi[1], lo[2], hi[2]);
  }
}

static void every_brick_is_in_one_leaf_of_a_tight_box(void** state)
{
  uint32_t random = 1;
  int64_t splits[4] = { 0, 0, 0, 0 }, fields = 0, leaves = 0;
  (void)state;
  for (int repeat = 0; repeat < 400; ++repeat) {
    random_set(&random);
    stratus_voxels* voxels = make_voxels(context, &set);
    const stratus_tree_options options = random_options(repeat % 3 ? STRATUS_TREE_HYBRID : STRATUS_TREE_HYBRID_PAPER, &random);
    hybrid_shape s = make_shape(context, voxels, &options);
    splits[0] += s.statistics.dbscan_splits;
    splits[1] += s.statistics.density_splits;
    splits[2] += s.statistics.sah_splits;
    splits[3] += s.statistics.median_splits;
    fields += s.fields;
    leaves += s.leaves;
    free_shape(context, &s);
    stratus_voxels_destroy(voxels);
  }
  for (int i = 0; i < 4; ++i) {
    assert_true(splits[i] > 20); /* every kind was tried */
  }
  assert_true(fields > 100 && leaves > 100);
}

static void the_shape_is_the_same_at_any_thread_count(void** state)
{
  uint32_t random = 2;
  (void)state;
  for (int repeat = 0; repeat < 6; ++repeat) {
    set_begin(&set, 256, 128, 256);
    set_add_noise(&set, 6000, &random);
    set_add_box(&set, 20, 40, 30, 50, 200, 220);
    stratus_voxels* voxels = make_voxels(context, &set);
    stratus_tree_options options = hybrid_options(repeat % 2 ? STRATUS_TREE_HYBRID : STRATUS_TREE_HYBRID_PAPER);
    options.field_emptiness = 4.0;
    options.uniform = 0.0;
    hybrid_shape one = make_shape(context, voxels, &options);
    assert_true(one.inner > 0);
    stratus_context* other = make_context("host", 2 + repeat);
    hybrid_shape many = make_shape(other, voxels, &options);
    assert_int_equal(many.shape.node_count, one.shape.node_count);
    assert_memory_equal(many.shape.nodes, one.shape.nodes, one.shape.node_count * sizeof *one.shape.nodes);
    assert_memory_equal(many.shape.order, one.shape.order, (size_t)voxels->brick_count * sizeof *one.shape.order);
    free_shape(other, &many);
    free_shape(context, &one);
    stratus_context_destroy(other);
    stratus_voxels_destroy(voxels);
  }
}

/* Dense or sparse, a set that is neither too large nor too empty for one field gets one, without any density. */
static void one_field_is_enough_where_it_is_affordable(void** state)
{
  uint32_t random = 3;
  (void)state;
  set_begin(&set, 256, 128, 256);
  set_add_noise(&set, 9000, &random);
  set_add_box(&set, 20, 40, 30, 50, 200, 220);
  stratus_voxels* voxels = make_voxels(context, &set);
  const stratus_tree_options options = hybrid_options(STRATUS_TREE_HYBRID);
  hybrid_shape s = make_shape(context, voxels, &options);
  assert_int_equal(s.shape.node_count, 1);
  assert_int_equal(s.fields, 1);
  assert_true(s.statistics.bandwidth == 0.0);
  assert_non_null(strstr(s.statistics.why, "one distance field"));
  free_shape(context, &s);
  stratus_voxels_destroy(voxels);
}

/* A dense ball in thin noise that fills a large box: too empty for one field. The ball's own field must not carry the noise's emptiness. */
static void a_cluster_in_thin_noise_gets_a_field_of_its_own(void** state)
{
  uint32_t random = 4;
  (void)state;
  set_begin(&set, 1024, 1024, 1024);
  set_add_noise(&set, 500, &random);
  set_add_box(&set, 100, 130, 800, 830, 500, 530);
  stratus_voxels* voxels = make_voxels(context, &set);
  const stratus_tree_options options = hybrid_options(STRATUS_TREE_HYBRID);
  hybrid_shape s = make_shape(context, voxels, &options);
  assert_true(s.statistics.dbscan_splits + s.statistics.density_splits > 0);
  assert_true(s.statistics.bandwidth >= 1.0);
  int found = 0;
  for (uint32_t n = 0; n < s.shape.node_count; ++n) {
    const stratus_tree_node* node = s.shape.nodes + n;
    if (stratus_tree_node_kind(node) == STRATUS_NODE_FIELD && stratus_tree_node_count(node) >= 512) {
      ++found;
      assert_true(node->lo[0] <= 100 && node->hi[0] >= 130 && node->lo[1] <= 800 && node->hi[1] >= 830); /* uncut */
      assert_true((double)(node->hi[0] - node->lo[0]) * (node->hi[1] - node->lo[1]) * (node->hi[2] - node->lo[2]) < 0x1p30 / 100);
    }
  }
  assert_int_equal(found, 1);
  free_shape(context, &s);
  stratus_voxels_destroy(voxels);
}

/* The paper's method on the same set: a cut at the cluster's border, a field on the peak's side, leaves of bricks on the other. Its test,
 * in voxels, then passes at once, whatever noise the field still holds. */
static void the_papers_field_is_on_the_peaks_side(void** state)
{
  uint32_t random = 4;
  (void)state;
  set_begin(&set, 1024, 1024, 1024);
  set_add_noise(&set, 500, &random);
  set_add_box(&set, 100, 130, 800, 830, 500, 530);
  stratus_voxels* voxels = make_voxels(context, &set);
  const stratus_tree_options options = hybrid_options(STRATUS_TREE_HYBRID_PAPER);
  hybrid_shape s = make_shape(context, voxels, &options);
  assert_int_equal(s.fields, 1);
  assert_int_equal(s.statistics.dbscan_splits, 1);
  assert_true(s.leaves > 100 && s.most_empty > 1000.0);
  const stratus_tree_node* side = s.shape.nodes + 1;
  assert_int_equal(stratus_tree_node_kind(side), STRATUS_NODE_FIELD);
  assert_true(side->lo[0] <= 100 && side->hi[0] == 130);
  free_shape(context, &s);
  stratus_voxels_destroy(voxels);
}

/* A full box that is larger than a field may be: any cut serves, and no density is computed. */
static void what_is_only_too_large_is_cut_without_density(void** state)
{
  uint32_t random = 6;
  (void)state;
  set_begin(&set, 100, 100, 100);
  set_add_noise(&set, 6000, &random);
  set_add_box(&set, 10, 20, 30, 40, 50, 60);
  stratus_voxels* voxels = make_voxels(context, &set);
  stratus_tree_options options = hybrid_options(STRATUS_TREE_HYBRID);
  options.field_bricks = 2000;
  hybrid_shape s = make_shape(context, voxels, &options);
  assert_true(s.fields >= 8 && s.leaves == 0);
  assert_int_equal(s.statistics.sah_splits, s.inner);
  assert_true(s.statistics.bandwidth == 0.0);
  free_shape(context, &s);
  stratus_voxels_destroy(voxels);
}

/* The options of density have an effect: bandwidth, voxel by voxel, node by node. */
static void a_given_bandwidth_is_the_one_used(void** state)
{
  uint32_t random = 5;
  (void)state;
  set_begin(&set, 100, 100, 100);
  set_add_noise(&set, 3000, &random);
  stratus_voxels* voxels = make_voxels(context, &set);
  for (int way = 0; way < 4; ++way) {
    stratus_tree_options options = hybrid_options(STRATUS_TREE_HYBRID);
    options.field_emptiness = 2.0;
    options.uniform = 0.0;
    options.exact_density = way & 1;
    options.density_per_node = way >> 1;
    double expected;
    hybrid_shape s = make_shape(context, voxels, &options);
    assert_int_equal(stratus_density_bandwidth(context, voxels, &expected, NULL), STRATUS_OK);
    assert_true(s.statistics.bandwidth == expected);
    free_shape(context, &s);
    options.bandwidth = 7.5;
    s = make_shape(context, voxels, &options);
    assert_true(s.statistics.bandwidth == 7.5);
    free_shape(context, &s);
  }
  stratus_voxels_destroy(voxels);
}

static int open_context(void** state)
{
  (void)state;
  context = make_context("host", 1);
  return 0;
}

static int close_context(void** state)
{
  (void)state;
  stratus_context_destroy(context);
  return 0;
}

int test_hybrid_tree(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(every_brick_is_in_one_leaf_of_a_tight_box),
    cmocka_unit_test(the_shape_is_the_same_at_any_thread_count),
    cmocka_unit_test(one_field_is_enough_where_it_is_affordable),
    cmocka_unit_test(a_cluster_in_thin_noise_gets_a_field_of_its_own),
    cmocka_unit_test(the_papers_field_is_on_the_peaks_side),
    cmocka_unit_test(what_is_only_too_large_is_cut_without_density),
    cmocka_unit_test(a_given_bandwidth_is_the_one_used),
  };
  return cmocka_run_group_tests(tests, open_context, close_context);
}
