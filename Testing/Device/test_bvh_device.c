/* SPDX-License-Identifier: BSD-3-Clause
 * Morton codes, hierarchies and layouts made by an OpenCL device, equal to the bit to the host's; and a device that fails in between. A
 * device on a CPU runs twice: as a GPU, and as a CPU. */
#include "boxes.h"

#include "device_pair.h"

static void the_device_builds_what_fits(void** state)
{
  (void)state;
  assert_false(stratus_device_takes_boxes(host_context, 2));
  assert_true(stratus_device_takes_boxes(device, 2));
  device->device->builds = false;
  assert_false(stratus_device_takes_boxes(device, 2));
  device->device->builds = true;
  const size_t largest = device->device->largest_allocation;
  device->device->largest_allocation = 100 * sizeof(stratus_box);
  assert_true(stratus_device_takes_boxes(device, 100));
  assert_false(stratus_device_takes_boxes(device, 101));
  device->device->largest_allocation = largest;
}

/* Where some cases are enough, only one set has the greatest count: the host takes longest for it. */
static bool is_left_out(int set, uint32_t count)
{
  return few_run() && count >= 30000 && set != BOXES_UNEVEN;
}

static void compare_builders(stratus_status (*builder)(stratus_bvh_build*), const stratus_box* boxes, uint32_t count)
{
  stratus_bvh_build here = { .context = host_context, .count = count }, there = { .context = device, .count = count };
  stratus_bvh_build* both[] = { &here, &there };
  for (int b = 0; b < 2; ++b) {
    assert_int_equal(stratus_bvh_sort_boxes(both[b], boxes), STRATUS_OK);
    both[b]->pairs = malloc((count - 1) * sizeof *both[b]->pairs);
    assert_non_null(both[b]->pairs);
    memset(both[b]->pairs, 0x55, (count - 1) * sizeof *both[b]->pairs);
    assert_int_equal(builder(both[b]), STRATUS_OK);
  }
  assert_memory_equal(here.codes, there.codes, count * sizeof *here.codes);
  assert_memory_equal(here.number, there.number, count * sizeof *here.number);
  assert_memory_equal(here.pairs, there.pairs, (count - 1) * sizeof *here.pairs);
  assert_int_equal(here.root, there.root);
  for (int b = 0; b < 2; ++b) {
    stratus_release(both[b]->context, both[b]->boxes);
    stratus_release(both[b]->context, both[b]->number);
    stratus_release(both[b]->context, both[b]->codes);
    free(both[b]->pairs);
  }
}

/* The greatest counts take several rounds of ploc between two answers. */
static void codes_and_hierarchies_equal_the_hosts(void** state)
{
  static const uint32_t counts[] = { 2, 3, 17, 63, 64, 65, 1000, 2048, 2049, 5000, 40000 }, few[] = { 3, 65 };
  const uint32_t rounds = stratus_device_is_cpu(device->device) ? 2049 : 513; /* the least for which ploc takes more than one launch */
  uint32_t random = 1;
  (void)state;
  for (int set = 0; set < BOX_SETS; ++set) {
    for (size_t c = 0; c < (tiny ? COUNT_OF(few) : COUNT_OF(counts)); ++c) {
      const uint32_t count = !tiny ? counts[c] : set == BOXES_UNEVEN && c == 1 ? rounds : few[c];
      if (is_left_out(set, count)) {
        continue;
      }
      stratus_box* boxes = make_boxes((box_set)set, count, &random);
      compare_builders(stratus_bvh_build_lbvh, boxes, count);
      compare_builders(stratus_bvh_build_ploc, boxes, count);
      free(boxes);
    }
  }
}

/* Returns how many kernels the last hierarchy took. */
static int hierarchy_kernels(void)
{
  stratus_build_stage stages[STRATUS_BUILD_STAGES_MAX];
  const int count = stratus_context_get_build_report(device, stages, STRATUS_BUILD_STAGES_MAX);
  for (int i = 0; i < count; ++i) {
    if (strcmp(stages[i].name, "hierarchy") == 0) {
      return (int)stages[i].kernels;
    }
  }
  return -1;
}

static void compare_trees(stratus_tree_method method, const stratus_box* boxes, uint32_t count, int leaf_boxes, int max_depth)
{
  stratus_bvh here = make_bvh(host_context, method, boxes, count, leaf_boxes, max_depth);
  stratus_context_start_build_report(device);
  stratus_bvh there = make_bvh(device, method, boxes, count, leaf_boxes, max_depth);
  assert_same_bvh(&here, &there, count);
  stratus_bvh_release(host_context, &here);
  stratus_bvh_release(device, &there);
}

/* Leaves of one box and of many, over few levels and many; one level in the last launches of few pairs, and many pairs in one level. */
static void layouts_equal_the_hosts(void** state)
{
  static const uint32_t counts[] = { 2, 3, 300, 2000, 30000 };
  static const int leaf_boxes[] = { 7, 1, 2, 64 };
  uint32_t random = 4;
  (void)state;
  for (int set = 0; set < BOX_SETS; ++set) {
    for (size_t c = 0; c < (tiny ? 3 : COUNT_OF(counts)); ++c) {
      if (is_left_out(set, counts[c])) {
        continue;
      }
      stratus_box* boxes = make_boxes((box_set)set, counts[c], &random);
      for (size_t l = 0; l < (tiny ? 1 : COUNT_OF(leaf_boxes)); ++l) {
        compare_trees(STRATUS_TREE_LBVH, boxes, counts[c], leaf_boxes[l], 64);
        compare_trees(STRATUS_TREE_PLOC, boxes, counts[c], leaf_boxes[l], 64);
      }
      free(boxes);
    }
  }
}

/* A lattice of 16^3: each round of ploc leaves half of the clusters, so that the tree is complete. Kernels: codes; start, four for each
 * round, and finish; those that sort pairs by depth; then levels up and down. */
static void kernels_of_a_complete_tree(void** state)
{
  stratus_box* boxes = malloc(4096 * sizeof *boxes);
  const bool processor = stratus_device_is_cpu(device->device), has_double = device->device->has_double;
  const int tree = processor ? 1 + 2 + 4 * 1 : 1 + 2 + 4 * 3, sorting = 10 + (processor ? 2 : 3), levels = processor ? 2 : 8;
  (void)state;
  assert_non_null(boxes);
  for (int i = 0; i < 4096; ++i) {
    boxes[i] = unit_box(i % 16, i / 16 % 16, i / 256);
  }
  if (has_double) {
    compare_trees(STRATUS_TREE_PLOC, boxes, 4096, 1, 64);
    assert_int_equal(hierarchy_kernels(), tree + sorting + levels);
    compare_trees(STRATUS_TREE_LBVH, boxes, 4096, 1, 64);
    assert_int_equal(hierarchy_kernels(), 2 + sorting + levels);
    /* The host bounds the depth, which the device finds too great when all subtrees are done. */
    compare_trees(STRATUS_TREE_PLOC, boxes, 4096, 1, 11);
    assert_int_equal(hierarchy_kernels(), tree + sorting + levels / 2);
    compare_trees(STRATUS_TREE_PLOC, boxes, 4096, 2, 11);
    assert_int_equal(hierarchy_kernels(), tree + sorting + levels);
  }
  device->device->has_double = false;
  compare_trees(STRATUS_TREE_PLOC, boxes, 4096, 1, 64);
  assert_int_equal(hierarchy_kernels(), tree);
  device->device->has_double = has_double;
  free(boxes);
}

/* A tree of one box a level: 128 levels below the root are laid out by the device, more by the host, to the same bytes. */
static void chains_equal_the_hosts(void** state)
{
  (void)state;
  for (uint32_t count = 129; count <= 131; ++count) {
    stratus_box boxes[131];
    uint32_t number[131];
    stratus_bvh_pair pairs[2][130];
    stratus_bvh both[2];
    for (uint32_t i = 0; i < count; ++i) {
      boxes[i] = unit_box((int64_t)i * i, 0, 0);
      number[i] = count - 1 - i;
    }
    for (int b = 0; b < 2; ++b) {
      for (uint32_t p = 0; p + 1 < count; ++p) {
        pairs[b][p] = (stratus_bvh_pair){ { STRATUS_BVH_LEAF | p, p + 2 < count ? p + 1 : STRATUS_BVH_LEAF | (p + 1) } };
      }
      const stratus_bvh_build build = {
        .context = b ? device : host_context, .count = count, .max_depth = 200, .boxes = boxes, .number = number, .pairs = pairs[b]
      };
      bool done = false;
      assert_int_equal(stratus_bvh_layout(&build, 1, &both[b]), STRATUS_OK);
      if (b && stratus_device_takes_layout(device, count)) {
        stratus_bvh again = { .nodes = NULL };
        assert_int_equal(stratus_device_layout(&build, 1, &again, &done), STRATUS_OK);
        assert_int_equal(done, count <= 130);
        stratus_bvh_release(device, &again);
      }
    }
    assert_same_bvh(&both[0], &both[1], count);
    stratus_bvh_release(host_context, &both[0]);
    stratus_bvh_release(device, &both[1]);
  }
}

static void trees_equal_the_hosts(void** state)
{
  uint32_t random = 2;
  stratus_box* boxes = make_boxes(BOXES_UNEVEN, 3000, &random);
  (void)state;
  for (int method = STRATUS_TREE_SAH; method <= STRATUS_TREE_KMEANS; ++method) {
    stratus_bvh here = make_bvh(host_context, (stratus_tree_method)method, boxes, 3000, 2, 16);
    stratus_bvh there = make_bvh(device, (stratus_tree_method)method, boxes, 3000, 2, 16);
    assert_same_bvh(&here, &there, 3000);
    stratus_bvh_release(host_context, &here);
    stratus_bvh_release(device, &there);
  }
  free(boxes);
}

/* Whichever call the device fails at: an error that says so, nothing made, and the next attempt is right. */
static void lose_the_device(stratus_tree_method method, uint32_t count)
{
  uint32_t random = 3;
  stratus_box* boxes = make_boxes(BOXES_RANDOM, count, &random);
  const stratus_bvh_options options = { method, 1, 64, STRATUS_BVH_SURFACE };
  stratus_bvh right = make_bvh(host_context, method, boxes, count, 1, 64), bvh;
  int64_t calls = 0;
  for (; calls < 2000; ++calls) {
    stratus_device_fail_after(device->device, calls, CL_DEVICE_NOT_AVAILABLE);
    memset(&bvh, 0x55, sizeof bvh);
    const stratus_bvh untouched = bvh;
    const stratus_status status = stratus_bvh_create(device, boxes, count, &options, &bvh);
    stratus_device_fail_after(device->device, -1, CL_SUCCESS);
    if (status == STRATUS_OK) {
      break;
    }
    assert_int_equal(status, STRATUS_DEVICE_ERROR);
    assert_non_null(strstr(stratus_context_message(device), "CL_DEVICE_NOT_AVAILABLE"));
    assert_memory_equal(&bvh, &untouched, sizeof bvh);
  }
  assert_in_range(calls, 40, 1999);
  assert_same_bvh(&right, &bvh, count);
  stratus_bvh_release(device, &bvh);
  stratus_bvh_release(host_context, &right);
  free(boxes);
}

static void a_lost_device_is_a_clean_error(void** state)
{
  (void)state;
  lose_the_device(STRATUS_TREE_LBVH, 200);
  lose_the_device(STRATUS_TREE_PLOC, 3000);
}

/* Whichever call has no memory: the host goes on, to the same bytes. */
static void the_host_goes_on_without_memory(void** state)
{
  uint32_t random = 5;
  stratus_box* boxes = make_boxes(BOXES_UNEVEN, 3000, &random);
  stratus_bvh right = make_bvh(host_context, STRATUS_TREE_PLOC, boxes, 3000, 4, 64);
  (void)state;
  for (int64_t calls = 0; calls < 400; calls += few_run() ? 5 : 1) {
    stratus_device_fail_after(device->device, calls, CL_MEM_OBJECT_ALLOCATION_FAILURE);
    stratus_bvh bvh = make_bvh(device, STRATUS_TREE_PLOC, boxes, 3000, 4, 64);
    stratus_device_fail_after(device->device, -1, CL_SUCCESS);
    assert_same_bvh(&right, &bvh, 3000);
    stratus_bvh_release(device, &bvh);
  }
  stratus_bvh_release(host_context, &right);
  free(boxes);
}

int test_bvh_device(void)
{
  if (no_device()) {
    return TEST_SKIPPED;
  }
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(the_device_builds_what_fits),
    cmocka_unit_test(codes_and_hierarchies_equal_the_hosts),
    cmocka_unit_test(layouts_equal_the_hosts),
    cmocka_unit_test(chains_equal_the_hosts),
  };
  const struct CMUnitTest whole[] = {
    cmocka_unit_test(kernels_of_a_complete_tree),
    cmocka_unit_test(trees_equal_the_hosts),
    cmocka_unit_test(a_lost_device_is_a_clean_error),
    cmocka_unit_test(the_host_goes_on_without_memory),
  };
  int failed = cmocka_run_group_tests_name("as a GPU", tests, open_device_as_gpu, close_device);
  failed += cmocka_run_group_tests_name("as it is", tests, open_device, close_device);
  if (!tiny) {
    failed += cmocka_run_group_tests_name("as a GPU, whole", whole, open_device_as_gpu, close_device);
    failed += cmocka_run_group_tests_name("as it is, whole", whole, open_device, close_device);
  }
  return failed;
}
