/* SPDX-License-Identifier: BSD-3-Clause
 * Options of trees: values out of range are refused, and each option reaches its builder. */
#include "first_hits.h"

#include "bvh.h"
#include "stratus/distance_field.h"
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

/* The leaves of a tree by the method as published keep what the flooding gave, in parts of a voxel; all else is as in the corrected one. */
static void uncorrected_leaves_hold_the_flooded_distances(void** state)
{
  const int64_t dimensions[3] = { 31, 26, 37 };
  uint32_t random = 7;
  (void)state;
  stratus_voxels* voxels = random_voxels(context, dimensions, 0.01, 0, &random);
  stratus_tree_options options = stratus_tree_options_default();
  stratus_field_options flooding = stratus_field_options_default();
  stratus_tree *corrected = NULL, *raw = NULL;
  stratus_field* field = NULL;
  assert_int_equal(options.uncorrected_flooding, 0);
  options.method = STRATUS_TREE_HYBRID_PAPER;
  options.paper_threshold = 1e18; /* everything is uniform: one leaf */
  assert_int_equal(stratus_tree_create(context, voxels, &options, &corrected), STRATUS_OK);
  options.uncorrected_flooding = 1;
  assert_int_equal(stratus_tree_create(context, voxels, &options, &raw), STRATUS_OK);
  flooding.method = STRATUS_FIELD_AJFA;
  assert_int_equal(stratus_field_create(context, voxels, &flooding, &field, NULL), STRATUS_OK);
  assert_int_equal(raw->node_count, 1);
  assert_int_equal(raw->field_count, 1);
  assert_int_equal(raw->entry_count, corrected->entry_count);
  const stratus_tree_field* f = raw->fields;
  int64_t empty = 0;
  for (int32_t k = 0; k < f->cells[2]; ++k) {
    for (int32_t j = 0; j < f->cells[1]; ++j) {
      for (int32_t i = 0; i < f->cells[0]; ++i) {
        uint64_t mask;
        const int32_t parts = stratus_tree_field_leap(raw, f, 0, i, j, k, &mask);
        assert_int_equal(parts, (int)(32.0 * stratus_field_get(field, i + f->at[0], j + f->at[1], k + f->at[2])));
        assert_int_equal(parts == 0, stratus_tree_field_leap(corrected, f, 0, i, j, k, &mask) == 0);
        empty += parts > 0;
      }
    }
  }
  assert_true(empty > 20000);
  assert_int_equal(stratus_tree_check(context, corrected, voxels), STRATUS_OK);
  assert_int_equal(stratus_tree_check(context, raw, voxels), STRATUS_INVALID_ARGUMENT);
  assert_non_null(strstr(stratus_context_message(context), "without correction"));
  stratus_field_destroy(field);
  stratus_tree_destroy(corrected);
  stratus_tree_destroy(raw);
  stratus_voxels_destroy(voxels);
}

/* A saved tree records that it is uncorrected, so that it never replaces a corrected one. Bytes that record it for a tree of bricks are
 * refused. */
static void a_saved_tree_keeps_that_it_is_uncorrected(void** state)
{
  const int64_t dimensions[3] = { 20, 20, 20 };
  float values[20 * 20 * 20];
  (void)state;
  for (int i = 0; i < 20 * 20 * 20; ++i) {
    values[i] = i % 97 == 0 ? 1.0f : 0.0f;
  }
  stratus_volume volume = stratus_volume_default();
  memcpy(volume.dimensions, dimensions, sizeof dimensions);
  volume.values = values;
  volume.type = STRATUS_FLOAT32;
  stratus_criterion criterion = stratus_criterion_default();
  criterion.lower = 0.5;
  stratus_voxels* voxels = NULL;
  assert_int_equal(stratus_voxels_create(context, &volume, &criterion, &voxels), STRATUS_OK);
  for (int uncorrected = 0; uncorrected <= 1; ++uncorrected) {
    stratus_tree_options options = stratus_tree_options_default();
    stratus_tree *tree = NULL, *loaded = NULL;
    stratus_tree_statistics s;
    int covers = -1;
    options.method = STRATUS_TREE_HYBRID_PAPER;
    options.uncorrected_flooding = uncorrected;
    assert_int_equal(stratus_tree_create(context, voxels, &options, &tree), STRATUS_OK);
    const size_t size = stratus_tree_bytes(tree);
    void *bytes = malloc(size), *again = malloc(size);
    stratus_tree_save(tree, bytes);
    assert_int_equal(stratus_tree_load(context, bytes, size, &loaded), STRATUS_OK);
    stratus_tree_get_statistics(loaded, &s);
    assert_int_equal(s.uncorrected, uncorrected);
    stratus_tree_save(loaded, again);
    assert_memory_equal(bytes, again, size);
    assert_int_equal(stratus_tree_covers(context, loaded, &volume, &criterion, 0, &covers), STRATUS_OK);
    assert_int_equal(covers, !uncorrected);
    free(bytes);
    free(again);
    stratus_tree_destroy(tree);
    stratus_tree_destroy(loaded);
    options.method = STRATUS_TREE_HYBRID; /* ignores the option */
    assert_int_equal(stratus_tree_create(context, voxels, &options, &tree), STRATUS_OK);
    stratus_tree_get_statistics(tree, &s);
    assert_int_equal(s.uncorrected, 0);
    stratus_tree_destroy(tree);
  }
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
    tree = NULL;
    options.agglomerative_by_edges = 0;
    options.uncorrected_flooding = value;
    assert_int_equal(stratus_tree_create(context, voxels, &options, &tree), good ? STRATUS_OK : STRATUS_INVALID_ARGUMENT);
    assert_true(good || strstr(stratus_context_message(context), value < 0 ? "flooding -1 outside 0..1" : "flooding 2 outside 0..1"));
    stratus_tree_destroy(tree);
  }
  stratus_voxels_destroy(voxels);
}

/* A box of side^3 voxels in which `count` blocks of 4^3 voxels lie anywhere. */
static stratus_voxels* scattered_blocks(int32_t side, int count, uint32_t* random)
{
  const int64_t dimensions[3] = { side, side, side };
  int32_t* positions = malloc((size_t)count * 64 * 3 * sizeof *positions);
  stratus_voxels* voxels = NULL;
  assert_non_null(positions);
  for (int b = 0; b < count; ++b) {
    int32_t corner[3];
    for (int a = 0; a < 3; ++a) {
      corner[a] = b < 2 ? (b ? side - 4 : 0) : (int32_t)(unit_random(random) * (side / 4)) * 4;
    }
    for (int v = 0; v < 64; ++v) {
      for (int a = 0; a < 3; ++a) {
        positions[3 * (64 * b + v) + a] = corner[a] + (v >> 2 * a & 3);
      }
    }
  }
  assert_int_equal(stratus_voxels_create_list(context, dimensions, positions, (size_t)count * 64, &voxels), STRATUS_OK);
  free(positions);
  return voxels;
}

static stratus_tree* tree_by(const stratus_voxels* voxels, stratus_tree_method method)
{
  stratus_tree_options options = stratus_tree_options_default();
  stratus_tree* tree = NULL;
  options.method = method;
  assert_int_equal(stratus_tree_create(context, voxels, &options, &tree), STRATUS_OK);
  return tree;
}

static void auto_takes_a_cached_field_or_fewer_bytes(void** state)
{
  static const struct {
    int32_t side;
    int blocks;
    stratus_tree_method method;
  } sets[] = { { 64, 30, STRATUS_TREE_OCTANT }, { 256, 8, STRATUS_TREE_OCTANT }, { 256, 100000, STRATUS_TREE_OCTANT },
    { 240, 3000, STRATUS_TREE_OCTANT }, { 400, 400, STRATUS_TREE_WIDE }, { 400, 60000, STRATUS_TREE_WIDE },
    { 400, 170000, STRATUS_TREE_OCTANT }, { 400, 900000, STRATUS_TREE_OCTANT } };
  uint32_t random = 3;
  int cached = 0, fewer = 0, wide_taken = 0;
  (void)state;
  for (size_t i = 0; i < sizeof sets / sizeof sets[0]; ++i) {
    stratus_voxels* voxels = scattered_blocks(sets[i].side, sets[i].blocks, &random);
    stratus_tree *chosen = tree_by(voxels, STRATUS_TREE_AUTO), *octant = tree_by(voxels, STRATUS_TREE_OCTANT);
    stratus_tree* wide = tree_by(voxels, STRATUS_TREE_WIDE);
    const double field = stratus_tree_octant_bytes(voxels), about = STRATUS_WIDE_BYTES * (double)voxels->brick_count;
    /* The predicted bytes of the field are exact, without its node and place; the hierarchy's are right to a fifth in large sets. */
    assert_int_equal((size_t)field, octant->statistics.bytes - sizeof *octant->nodes - sizeof *octant->fields);
    assert_true(voxels->brick_count < 5000 || fabs((double)wide->statistics.bytes / about - 1.0) < 0.2);
    assert_int_equal(chosen->statistics.method, sets[i].method);
    assert_int_equal(chosen->statistics.bytes, (sets[i].method == STRATUS_TREE_WIDE ? wide : octant)->statistics.bytes);
    assert_non_null(
      strstr(chosen->statistics.why, sets[i].method == STRATUS_TREE_WIDE ? "a wide hierarchy of some" : "one distance field of"));
    cached += field <= 1e6;
    fewer += field > 1e6 && field <= about;
    wide_taken += field > 1e6 && field > about;
    stratus_tree_destroy(chosen);
    stratus_tree_destroy(octant);
    stratus_tree_destroy(wide);
    stratus_voxels_destroy(voxels);
  }
  assert_true(cached >= 2 && fewer >= 2 && wide_taken >= 2);
}

int test_tree_options(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(clusters_merge_by_the_distance_asked_for),
    cmocka_unit_test(uncorrected_leaves_hold_the_flooded_distances),
    cmocka_unit_test(a_saved_tree_keeps_that_it_is_uncorrected),
    cmocka_unit_test(an_option_out_of_range_is_refused_with_its_range),
    cmocka_unit_test(auto_takes_a_cached_field_or_fewer_bytes),
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
