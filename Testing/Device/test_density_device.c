/* SPDX-License-Identifier: BSD-3-Clause
 * Densities summed by an OpenCL device against the host's, to the bit.
 * Run with the argument `--tiny` it takes few and small sets: enough for a simulator to see every kernel. */
#include "stratus.h"
#include "density_plan.h"

#include "voxel_sets.h"

#include "density.h"
#include "density_plan.h"
#include "device.h"
#include "device_pair.h"
#include "tree.h"

static voxel_set set;

static void compare_sums(const stratus_voxels* voxels, double bandwidth, int exact)
{
  density_plan plan;
  const size_t count = (size_t)voxels->brick_count;
  int64_t* start = calloc(count + 1, sizeof *start);
  assert_non_null(start);
  for (size_t b = 0; b < count; ++b) {
    start[b + 1] = start[b] + voxels->bricks[b].count;
  }
  const size_t values = exact ? (size_t)start[count] : count;
  uint64_t *host = calloc(values, sizeof *host), *filled = malloc(values * sizeof *filled);
  assert_non_null(host);
  assert_non_null(filled);
  memset(filled, 0x55, values * sizeof *filled);
  assert_true(stratus_density_plan_fits(bandwidth, exact));
  assert_int_equal(stratus_density_plan_create(device, bandwidth, exact, &plan), STRATUS_OK);
  assert_true(stratus_device_takes_density(device, &plan, voxels->brick_count, voxels->count));
  stratus_density_rows(&plan, voxels->bricks, voxels->brick_count, start, host);
  if (stratus_device_density(device, &plan, voxels->bricks, voxels->brick_count, start, filled) != STRATUS_OK) {
    fail_msg("%s", stratus_context_message(device));
  }
  assert_memory_equal(filled, host, values * sizeof *host);
  stratus_density_plan_release(&plan);
  free(start);
  free(host);
  free(filled);
}

static void sums_of_weights_equal_the_hosts(void** state)
{
  static const double some[] = { 1.0, 2.0, 3.3, 4.0, 5.5, 6.2, 9.7, 20.0, 28.9 };
  uint32_t random = 1;
  (void)state;
  for (int repeat = 0; repeat < (tiny ? 2 : 27); ++repeat) {
    set_begin(&set, 1 + random_below(&random, 40), 1 + random_below(&random, 40), 1 + random_below(&random, 40));
    set_add_noise(&set, tiny ? 20 : 1 + random_below(&random, 1500), &random);
    if (repeat % 2 && !tiny) {
      set_add_box(&set, 0, set.dimensions[0] / 2, 0, set.dimensions[1] / 2, 0, set.dimensions[2] / 3);
    }
    stratus_voxels* voxels = make_voxels(host_context, &set);
    compare_sums(voxels, some[tiny ? 2 + 3 * repeat : repeat % 9], 1);
    compare_sums(voxels, some[tiny ? 2 + 3 * repeat : repeat % 9], 0);
    stratus_voxels_destroy(voxels);
  }
}

/* The device is asked where it is taken for a GPU, the host beyond what the kernels' rows hold; the field has the same bits. */
static void a_gpu_is_asked_and_its_field_is_the_hosts(void** state)
{
  static const double some[] = { 3.0, 40.0 };
  uint32_t random = 2;
  (void)state;
  set_begin(&set, 60, 50, 40);
  set_add_noise(&set, tiny ? 20 : 900, &random);
  stratus_voxels* voxels = make_voxels(host_context, &set);
  const bool is_cpu = device->device->is_cpu;
  device->device->is_cpu = false;
  for (int i = 0; i < 4; ++i) {
    stratus_density *host = NULL, *filled = NULL;
    assert_int_equal(stratus_density_create(host_context, voxels->bricks, voxels->brick_count, some[i / 2], i % 2, &host), STRATUS_OK);
    assert_int_equal(stratus_density_create(device, voxels->bricks, voxels->brick_count, some[i / 2], i % 2, &filled), STRATUS_OK);
    assert_memory_equal(filled->of, host->of, sizeof(float) * (size_t)(i % 2 ? voxels->count : voxels->brick_count));
    stratus_density_destroy(host);
    stratus_density_destroy(filled);
  }
  /* A device that fails is a clean error, and was asked. */
  stratus_density* none = NULL;
  stratus_device_fail_after(device->device, 3, CL_DEVICE_NOT_AVAILABLE);
  assert_int_equal(stratus_density_create(device, voxels->bricks, voxels->brick_count, 3.0, 1, &none), STRATUS_DEVICE_ERROR);
  assert_null(none);
  stratus_device_fail_after(device->device, -1, 0);
  device->device->is_cpu = is_cpu;
  stratus_voxels_destroy(voxels);
}

int test_density_device(void)
{
  if (no_device()) {
    return TEST_SKIPPED;
  }
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(sums_of_weights_equal_the_hosts),
    cmocka_unit_test(a_gpu_is_asked_and_its_field_is_the_hosts),
  };
  /* A processor's OpenCL has a kernel of its own. */
  const int failed = cmocka_run_group_tests(tests, open_device, close_device);
  return failed + cmocka_run_group_tests(tests, open_device_as_gpu, close_device);
}
