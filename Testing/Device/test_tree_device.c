/* SPDX-License-Identifier: BSD-3-Clause
 * Effective voxels and trees made by an OpenCL device, equal to the byte to the host's: by work-groups of a GPU, and by the single items
 * that a processor gets. Pieces of a volume, and volumes that do not fit the device. */
#include "voxel_sets.h"

#include "device_pair.h"
#include "hybrid_tree.h"
#include "tree.h"
#include "tree_fields.h"
#include "voxels_build.h"

#define CALLS_MAX 1000000 /* of OpenCL, more than anything here needs */

static voxel_set set;

static void call(stratus_context* context, stratus_status status)
{
  if (status != STRATUS_OK) {
    fail_msg("%s", stratus_context_message(context));
  }
}

/* Returns how many kernels the stage had since the report was started, -1 if it was not done on the device. */
static int64_t kernels_of(const char* name)
{
  stratus_build_stage stages[STRATUS_BUILD_STAGES_MAX];
  const int count = stratus_context_get_build_report(device, stages, STRATUS_BUILD_STAGES_MAX);
  for (int i = 0; i < count; ++i) {
    if (strcmp(stages[i].name, name) == 0 && strcmp(stages[i].where, stratus_context_device(device)) == 0) {
      return (int64_t)stages[i].kernels;
    }
  }
  return -1;
}

/* ---- effective voxels */

static void assert_same_voxels(const stratus_voxels* here, const stratus_voxels* there)
{
  assert_int_equal(there->brick_count, here->brick_count);
  assert_memory_equal(there->bricks, here->bricks, (size_t)here->brick_count * sizeof *here->bricks);
  assert_int_equal(there->count, here->count);
  assert_memory_equal(there->lo, here->lo, sizeof here->lo);
  assert_memory_equal(there->hi, here->hi, sizeof here->hi);
  assert_memory_equal(&there->origin, &here->origin, sizeof here->origin);
}

/* kernels: the expected launches on the device, 0 if the host scans the volume. */
static void compare_voxels(const stratus_volume* volume, const stratus_criterion* criterion, int kernels)
{
  stratus_voxels *here = NULL, *there = NULL;
  call(host_context, stratus_voxels_create(host_context, volume, criterion, &here));
  for (int gpu = 0; gpu < 2; ++gpu) {
    device->device->is_cpu = !gpu;
    stratus_context_start_build_report(device);
    call(device, stratus_voxels_create(device, volume, criterion, &there));
    assert_int_equal(kernels_of("effective voxels"), kernels ? kernels : -1);
    assert_same_voxels(here, there);
    stratus_voxels_destroy(there);
  }
  stratus_voxels_destroy(here);
}

static void voxels_equal_the_hosts(void** state)
{
  static const int64_t sizes[][3] = { { 37, 22, 13 }, { 1, 1, 1 }, { 64, 4, 4 }, { 5, 70, 3 } };
  static const double opacity[] = { 0.1, 0, 0.11, 1, 0.12, 0, 0.5, 0, 0.6, 1 }, white[] = { 0, 1, 1, 1 };
  uint32_t random = 1;
  (void)state;
  for (int type = 0; type <= (tiny ? STRATUS_UINT8 : STRATUS_FLOAT64); ++type) {
    for (int i = 0; i < (tiny ? 1 : 4); ++i) {
      sample_volume v = make_volume((stratus_type)type, sizes[i][0], sizes[i][1], sizes[i][2], 1 + (i == 1 ? 2 : 0) + (i == 3), &random);
      spoil(&v, 9, &random);
      const bool wide = type == STRATUS_INT64 || type == STRATUS_UINT64;
      const int kernels = type < STRATUS_INT64 || type == STRATUS_FLOAT32 || stratus_device_has_double(device->device) ? 3 : 0;
      stratus_criterion criterion = stratus_criterion_default();
      stratus_transfer transfer = stratus_transfer_default();
      compare_voxels(&v.view, &criterion, kernels);
      criterion.lower = type == STRATUS_FLOAT32 ? 0.25 : type == STRATUS_FLOAT64 ? 6e6 + 0.5 : wide ? 1e15 : 3.0;
      criterion.upper = type == STRATUS_FLOAT32 ? 0.75 : type == STRATUS_FLOAT64 ? 6e6 + 1.25 : wide ? 3e17 : 90.0;
      compare_voxels(&v.view, &criterion, kernels);
      transfer.opacity = opacity;
      transfer.opacity_count = 5;
      transfer.color = white;
      transfer.color_count = 1;
      criterion.transfer = &transfer;
      add_ghosts(&v, i % 2, 5, &random);
      for (int64_t n = 0; n < sizes[i][0] * sizes[i][1] * sizes[i][2]; ++n) {
        if (random_below(&random, 3)) {
          v.point_ghosts[n] = v.cell_ghosts[n] = 0;
        }
      }
      compare_voxels(&v.view, &criterion, kernels);
      free_volume(&v);
    }
  }
}

/* A volume of ten times the largest allocation goes to the device in pieces. One layer of bricks must fit, and so must all masks. */
static void a_large_volume_goes_in_pieces(void** state)
{
  uint32_t random = 2;
  sample_volume v = make_volume(STRATUS_FLOAT32, 20, 18, 80, 1, &random);
  stratus_criterion criterion = stratus_criterion_default();
  const size_t largest = device->device->largest_allocation, layer = 4 * 20 * 18 * sizeof(float);
  (void)state;
  criterion.lower = 0.6;
  device->device->largest_allocation = 2 * layer;
  compare_voxels(&v.view, &criterion, 10 + 2);
  device->device->largest_allocation = 3 * layer; /* the last piece has two layers of bricks */
  compare_voxels(&v.view, &criterion, 7 + 2);
  device->device->largest_allocation = layer - 1;
  compare_voxels(&v.view, &criterion, 0);
  device->device->largest_allocation = largest;
  free_volume(&v);
}

/* ---- trees */

static void assert_same_tree(const stratus_tree* here, const stratus_tree* there)
{
  const size_t bytes = stratus_tree_bytes(here);
  assert_int_equal(stratus_tree_bytes(there), bytes);
  uint8_t *a = malloc(bytes), *b = malloc(bytes);
  assert_true(a && b);
  stratus_tree_save(here, a);
  stratus_tree_save(there, b);
  assert_memory_equal(a, b, bytes);
  free(a);
  free(b);
  assert_string_equal(there->statistics.why, here->statistics.why);
}

static void compare_trees(const stratus_voxels* voxels, const stratus_tree_options* options)
{
  stratus_tree *here = NULL, *there = NULL;
  call(host_context, stratus_tree_create(host_context, voxels, options, &here));
  for (int gpu = 0; gpu < 2; ++gpu) {
    device->device->is_cpu = !gpu;
    stratus_context_start_build_report(device);
    call(device, stratus_tree_create(device, voxels, options, &there));
    assert_same_tree(here, there);
    if (options->method <= STRATUS_TREE_OCTANT) {
      /* The paper's node test needs the density of the root, too. */
      assert_int_equal(kernels_of("tree shape") > 0, there->node_count > 1 || options->method == STRATUS_TREE_HYBRID_PAPER);
      const bool has_leaps = there->octants && there->field_count > 0;
      assert_int_equal(kernels_of("tree leaves"), has_leaps ? 7 : -1); /* one launch for all leaves */
    }
    stratus_tree_destroy(there);
  }
  stratus_tree_destroy(here);
}

/* Clusters of different density far apart, and noise: the sets that are split in all ways. */
static void make_clusters(int64_t side, int clusters, int64_t voxels, uint32_t* random)
{
  set_begin(&set, side, side - side / 4, side / 2 + 3);
  for (int c = 0; c < clusters; ++c) {
    int64_t middle[3], radius[3];
    for (int a = 0; a < 3; ++a) {
      middle[a] = random_below(random, set.dimensions[a]);
      radius[a] = 1 + random_below(random, 1 + side / (3 + 4 * c));
    }
    for (int64_t n = 0; n < voxels; ++n) {
      int64_t at[3];
      bool inside = true;
      for (int a = 0; a < 3; ++a) {
        at[a] = middle[a] + (random_below(random, 2 * radius[a]) + random_below(random, 2 * radius[a])) / 2 - radius[a];
        inside = inside && at[a] >= 0 && at[a] < set.dimensions[a];
      }
      if (inside) {
        set_add(&set, at[0], at[1], at[2]);
      }
    }
  }
  set_add_noise(&set, voxels / 8 + 1, random);
}

static void trees_equal_the_hosts(void** state)
{
  static const int64_t sides[] = { 60, 300, 2000, 20000 };
  uint32_t random = 3;
  int splits[4] = { 0, 0, 0, 0 };
  (void)state;
  for (int repeat = 0; repeat < (tiny ? 1 : 16); ++repeat) {
    make_clusters(sides[repeat % 4], 1 + repeat % 5, tiny ? 40 : 1500, &random);
    stratus_voxels* voxels = make_voxels(host_context, &set);
    for (int way = 0; way < (tiny ? 2 : 6); ++way) {
      stratus_tree_options options = stratus_tree_options_default();
      options.method = STRATUS_TREE_HYBRID;
      options.field_emptiness = way == 0 ? options.field_emptiness : 1.0 + (double)random_below(&random, 30);
      options.leaf_bricks = 1 + (int)random_below(&random, 6);
      options.exact_density = way == 2;
      options.density_per_node = way == 3;
      options.bandwidth = way == 4 ? 1.0 + (double)random_below(&random, 40) : 0.0;
      options.max_depth = way == 5 ? 12 : options.max_depth;
      compare_trees(voxels, &options);
      stratus_tree* tree = NULL;
      call(host_context, stratus_tree_create(host_context, voxels, &options, &tree));
      splits[0] += tree->statistics.dbscan_splits;
      splits[1] += tree->statistics.density_splits;
      splits[2] += tree->statistics.sah_splits;
      splits[3] += tree->statistics.median_splits;
      stratus_tree_destroy(tree);
    }
    stratus_voxels_destroy(voxels);
  }
  for (int i = 0; i < 4 && !tiny; ++i) {
    assert_true(splits[i] > 0); /* each way to split was compared */
  }
}

static void other_methods_equal_the_hosts(void** state)
{
  uint32_t random = 4;
  (void)state;
  make_clusters(120, 3, tiny ? 30 : 900, &random);
  stratus_voxels* voxels = make_voxels(host_context, &set);
  for (int method = STRATUS_TREE_HYBRID_PAPER; method <= (tiny ? STRATUS_TREE_HYBRID_PAPER : STRATUS_TREE_OCTANT); ++method) {
    stratus_tree_options options = stratus_tree_options_default();
    options.method = (stratus_tree_method)method;
    compare_trees(voxels, &options);
  }
  stratus_voxels_destroy(voxels);
}

/* Fields of one cell, of rows that end at a word, and of rows of several words, whose leaps cross words. */
static void leaps_cross_words(void** state)
{
  static const int64_t sides[] = { 4, 124, 128, 132, 256, 260, 700 };
  uint32_t random = 5;
  (void)state;
  for (int i = 0; i < (tiny ? 2 : 7); ++i) {
    for (int axis = 0; axis < (tiny ? 1 : 3); ++axis) {
      int64_t n[3] = { 40, 44, 48 };
      n[axis] = sides[i];
      set_begin(&set, n[0], n[1], n[2]);
      set_add_noise(&set, 1 + 4 * (int64_t)i, &random);
      set_add(&set, 0, 0, 0);
      set_add(&set, n[0] - 1, n[1] - 1, n[2] - 1);
      stratus_voxels* voxels = make_voxels(host_context, &set);
      stratus_tree_options options = stratus_tree_options_default();
      options.method = STRATUS_TREE_OCTANT;
      compare_trees(voxels, &options);
      stratus_voxels_destroy(voxels);
    }
  }
}

/* ---- what does not fit, and a device that fails */

static void what_does_not_fit_is_built_on_the_host(void** state)
{
  uint32_t random = 6;
  const size_t largest = device->device->largest_allocation;
  (void)state;
  make_clusters(300, 2, tiny ? 30 : 500, &random);
  stratus_voxels* voxels = make_voxels(host_context, &set);
  stratus_tree_options options = stratus_tree_options_default();
  options.method = STRATUS_TREE_HYBRID;
  options.field_emptiness = 2.0;
  stratus_tree *here = NULL, *there = NULL;
  call(host_context, stratus_tree_create(host_context, voxels, &options, &here));
  device->device->largest_allocation = (size_t)voxels->brick_count * sizeof(stratus_brick) - 1;
  stratus_context_start_build_report(device);
  call(device, stratus_tree_create(device, voxels, &options, &there));
  assert_int_equal(kernels_of("tree shape"), -1);
  assert_int_equal(kernels_of("tree leaves"), -1);
  device->device->largest_allocation = largest;
  assert_same_tree(here, there);
  stratus_tree_destroy(here);
  stratus_tree_destroy(there);
  stratus_voxels_destroy(voxels);
}

/* Sums that doubles would round are left to the host: there the order of adding would show. */
static void sums_beyond_whole_doubles_are_the_hosts(void** state)
{
  uint32_t random = 7;
  (void)state;
  set_begin(&set, 1 << 18, 1 << 18, 1 << 18);
  set_add_noise(&set, tiny ? 60 : 3000, &random);
  stratus_voxels* voxels = make_voxels(host_context, &set);
  stratus_tree_options options = stratus_tree_options_default();
  options.method = STRATUS_TREE_HYBRID;
  const hybrid_build build = { .context = device, .voxels = voxels, .options = &options };
  assert_true(stratus_hybrid_on_device(&build));
  compare_trees(voxels, &options); /* its bandwidth reaches so far that the lines are the host's */
  stratus_voxels many = *voxels;
  many.count = (int64_t)1 << 20;
  const hybrid_build large = { .context = device, .voxels = &many, .options = &options };
  assert_false(stratus_hybrid_on_device(&large));
  stratus_voxels_destroy(voxels);
}

/* A failure of the device at one call, and its effect on a tree and voxels. If the device is out of memory, or if "auto" chose the device
 * and it fails for any reason, the host builds them. Otherwise the call reports the error and makes nothing, and the next call is right. */
typedef struct failure_case {
  bool named;
  int error;
  bool handed_back;
} failure_case;

static void fail_at_each_call(const failure_case* way, const stratus_voxels* voxels, const stratus_volume* volume)
{
  const stratus_criterion criterion = stratus_criterion_default();
  stratus_tree_options options = stratus_tree_options_default();
  stratus_tree *tree = NULL, *right = NULL;
  stratus_voxels *scanned = NULL, *expected = NULL;
  options.method = STRATUS_TREE_HYBRID;
  options.field_emptiness = 4.0;
  options.max_depth = 6;
  call(host_context, stratus_tree_create(host_context, voxels, &options, &right));
  call(host_context, stratus_voxels_create(host_context, volume, &criterion, &expected));
  call(device, stratus_tree_create(device, voxels, &options, &tree)); /* kernels are built */
  stratus_tree_destroy(tree);
  call(device, stratus_voxels_create(device, volume, &criterion, &scanned));
  stratus_voxels_destroy(scanned);
  stratus_device_fail_after(device->device, CALLS_MAX, CL_SUCCESS);
  call(device, stratus_tree_create(device, voxels, &options, &tree));
  stratus_tree_destroy(tree);
  const int64_t tree_calls = CALLS_MAX - device->device->calls_left;
  stratus_device_fail_after(device->device, CALLS_MAX, CL_SUCCESS);
  call(device, stratus_voxels_create(device, volume, &criterion, &scanned));
  stratus_voxels_destroy(scanned);
  const int64_t voxels_calls = CALLS_MAX - device->device->calls_left;
  assert_true(tree_calls > 100 && voxels_calls > 10);
  device->device->named = way->named;
  for (int64_t n = 0; n < tree_calls; n += tiny ? 37 : 7) {
    tree = NULL;
    stratus_device_fail_after(device->device, n, way->error);
    stratus_context_start_build_report(device);
    const stratus_status status = stratus_tree_create(device, voxels, &options, &tree);
    stratus_device_fail_after(device->device, -1, CL_SUCCESS);
    if (way->handed_back) {
      assert_int_equal(kernels_of("tree leaves"), -1); /* the device fails from some call on, and leaves are its last */
      call(device, status);
      assert_same_tree(right, tree);
      stratus_tree_destroy(tree);
    } else {
      assert_int_equal(status, STRATUS_DEVICE_ERROR);
      assert_null(tree);
      assert_non_null(strstr(stratus_context_message(device), stratus_device_error_name(way->error)));
    }
  }
  for (int64_t n = 0; n < voxels_calls; ++n) {
    scanned = NULL;
    stratus_device_fail_after(device->device, n, way->error);
    const stratus_status status = stratus_voxels_create(device, volume, &criterion, &scanned);
    stratus_device_fail_after(device->device, -1, CL_SUCCESS);
    assert_int_equal(status, way->handed_back ? STRATUS_OK : STRATUS_DEVICE_ERROR);
    if (status == STRATUS_OK) {
      assert_same_voxels(expected, scanned);
    }
    stratus_voxels_destroy(scanned);
  }
  device->device->named = true;
  stratus_voxels_destroy(expected);
  stratus_tree_destroy(right);
}

static void the_host_takes_over_or_the_call_fails(void** state)
{
  static const failure_case ways[] = { { true, CL_DEVICE_NOT_AVAILABLE, false }, { true, CL_MEM_OBJECT_ALLOCATION_FAILURE, true },
    { true, CL_OUT_OF_RESOURCES, true }, { false, CL_DEVICE_NOT_AVAILABLE, true }, { false, CL_BUILD_PROGRAM_FAILURE, true } };
  uint32_t random = 8;
  sample_volume v = make_volume(STRATUS_UINT8, 9, 9, 9, 1, &random);
  (void)state;
  make_clusters(300, 2, tiny ? 30 : 400, &random);
  stratus_voxels* voxels = make_voxels(host_context, &set);
  for (size_t w = 0; w < (tiny ? 1 : sizeof ways / sizeof *ways); ++w) {
    fail_at_each_call(&ways[w], voxels, &v.view);
  }
  stratus_voxels_destroy(voxels);
  free_volume(&v);
}

int test_tree_device(void)
{
  if (no_device()) {
    return TEST_SKIPPED;
  }
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(voxels_equal_the_hosts),
    cmocka_unit_test(a_large_volume_goes_in_pieces),
    cmocka_unit_test(trees_equal_the_hosts),
    cmocka_unit_test(other_methods_equal_the_hosts),
    cmocka_unit_test(leaps_cross_words),
    cmocka_unit_test(what_does_not_fit_is_built_on_the_host),
    cmocka_unit_test(sums_beyond_whole_doubles_are_the_hosts),
    cmocka_unit_test(the_host_takes_over_or_the_call_fails),
  };
  return cmocka_run_group_tests(tests, open_device, close_device);
}
