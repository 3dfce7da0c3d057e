/* SPDX-License-Identifier: BSD-3-Clause
 * Morton codes and hierarchies made by an OpenCL device, equal to the bit to the host's; and a device that fails on the way.
 * A device on a CPU is taken for a GPU here. */
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

static void codes_and_hierarchies_equal_the_hosts(void** state)
{
  static const uint32_t counts[] = { 2, 3, 63, 64, 65, 1000, 5000 };
  uint32_t random = 1;
  (void)state;
  for (int set = 0; set < BOX_SETS; ++set) {
    for (size_t c = 0; c < sizeof counts / sizeof *counts; ++c) {
      stratus_box* boxes = make_boxes((box_set)set, counts[c], &random);
      stratus_bvh_build here = { .context = host_context, .count = counts[c] }, there = { .context = device, .count = counts[c] };
      stratus_bvh_build* both[] = { &here, &there };
      for (int b = 0; b < 2; ++b) {
        assert_int_equal(stratus_bvh_sort_boxes(both[b], boxes), STRATUS_OK);
        both[b]->pairs = malloc((counts[c] - 1) * sizeof *both[b]->pairs);
        assert_non_null(both[b]->pairs);
        memset(both[b]->pairs, 0x55, (counts[c] - 1) * sizeof *both[b]->pairs);
        assert_int_equal(stratus_bvh_build_lbvh(both[b]), STRATUS_OK);
      }
      assert_memory_equal(here.codes, there.codes, counts[c] * sizeof *here.codes);
      assert_memory_equal(here.number, there.number, counts[c] * sizeof *here.number);
      assert_memory_equal(here.pairs, there.pairs, (counts[c] - 1) * sizeof *here.pairs);
      assert_int_equal(here.root, there.root);
      for (int b = 0; b < 2; ++b) {
        stratus_release(both[b]->context, both[b]->boxes);
        stratus_release(both[b]->context, both[b]->number);
        stratus_release(both[b]->context, both[b]->codes);
        free(both[b]->pairs);
      }
      free(boxes);
    }
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
static void a_lost_device_is_a_clean_error(void** state)
{
  uint32_t random = 3;
  stratus_box* boxes = make_boxes(BOXES_RANDOM, 200, &random);
  const stratus_bvh_options options = { STRATUS_TREE_LBVH, 1, 64, STRATUS_BVH_SURFACE };
  stratus_bvh right = make_bvh(host_context, STRATUS_TREE_LBVH, boxes, 200, 1, 64), bvh;
  int64_t calls = 0;
  (void)state;
  for (; calls < 100; ++calls) {
    stratus_device_fail_after(device->device, calls, CL_DEVICE_NOT_AVAILABLE);
    memset(&bvh, 0x55, sizeof bvh);
    const stratus_bvh untouched = bvh;
    const stratus_status status = stratus_bvh_create(device, boxes, 200, &options, &bvh);
    stratus_device_fail_after(device->device, -1, CL_SUCCESS);
    if (status == STRATUS_OK) {
      break;
    }
    assert_int_equal(status, STRATUS_DEVICE_ERROR);
    assert_non_null(strstr(stratus_context_message(device), "CL_DEVICE_NOT_AVAILABLE"));
    assert_memory_equal(&bvh, &untouched, sizeof bvh);
    stratus_bvh again = make_bvh(device, STRATUS_TREE_LBVH, boxes, 200, 1, 64);
    assert_same_bvh(&right, &again, 200);
    stratus_bvh_release(device, &again);
  }
  assert_in_range(calls, 8, 99);
  assert_same_bvh(&right, &bvh, 200);
  stratus_bvh_release(device, &bvh);
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
    cmocka_unit_test(trees_equal_the_hosts),
    cmocka_unit_test(a_lost_device_is_a_clean_error),
  };
  return cmocka_run_group_tests(tests, open_device_as_gpu, close_device);
}
