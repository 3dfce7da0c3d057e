/* SPDX-License-Identifier: BSD-3-Clause
 * Keys sorted by an OpenCL device, equal to the host's order: by work-groups of a GPU, and by the single items that a processor gets. */
#include "structures.h"

#include "device_pair.h"
#include "radix_sort.h"

#define COUNT_MAX 40000

static uint64_t keys[3][COUNT_MAX]; /* given, the host's, the device's */
static uint32_t values[2][COUNT_MAX];

/* Keys of `bits` bits; few: only so many different ones. */
static void make_keys(uint32_t count, int bits, uint32_t few, uint32_t* random)
{
  const uint64_t mask = bits == 64 ? UINT64_MAX : (UINT64_C(1) << bits) - 1;
  uint64_t some[8];
  for (int i = 0; i < 8; ++i) {
    some[i] = ((uint64_t)next_random(random) << 40 ^ (uint64_t)next_random(random) << 20 ^ next_random(random)) & mask;
  }
  for (uint32_t i = 0; i < count; ++i) {
    const uint64_t other = (uint64_t)next_random(random) << 40 ^ (uint64_t)next_random(random) << 20 ^ next_random(random);
    keys[0][i] = few ? some[random_below(random, few)] : other & mask;
  }
}

static void copy_keys(int to, uint32_t count)
{
  for (uint32_t i = 0; i < count; ++i) {
    keys[1 + to][i] = keys[0][i];
    values[to][i] = i;
  }
}

static void assert_same_order(uint32_t count)
{
  assert_memory_equal(keys[2], keys[1], count * sizeof keys[1][0]);
  assert_memory_equal(values[1], values[0], count * sizeof values[0][0]);
}

static void keys_are_sorted_as_by_the_host(void** state)
{
  static const uint32_t counts[] = { 1, 63, 64, 65, 1024, 1025, 4096, 39999 };
  static const int bits[] = { 1, 8, 31, 63, 64 };
  uint32_t random = 1;
  (void)state;
  for (size_t c = 0; c < (tiny ? 4 : 8); ++c) {
    for (size_t b = 0; b < (tiny ? 2 : 5); ++b) {
      for (uint32_t few = 0; few < 8; few += few ? 3 : 1) { /* 1: all keys are equal, so that no pass moves any */
        make_keys(counts[c], bits[b], few, &random);
        copy_keys(0, counts[c]);
        assert_int_equal(stratus_radix_sort(host_context, keys[1], values[0], counts[c], bits[b]), STRATUS_OK);
        for (int gpu = 0; gpu < 2; ++gpu) {
          device->device->is_cpu = !gpu;
          copy_keys(1, counts[c]);
          assert_int_equal(stratus_device_radix_sort(device, keys[2], values[1], counts[c], bits[b]), STRATUS_OK);
          assert_same_order(counts[c]);
        }
      }
    }
  }
}

/* Many keys go to the device, unless it does not build or they do not fit it. */
static void many_keys_go_to_the_device(void** state)
{
  const size_t largest = device->device->largest_allocation;
  (void)state;
  assert_false(stratus_radix_sort_on_device(host_context, COUNT_MAX));
  assert_false(stratus_radix_sort_on_device(device, 100));
  assert_true(stratus_radix_sort_on_device(device, COUNT_MAX));
  device->device->largest_allocation = COUNT_MAX * sizeof(uint64_t) - 1;
  assert_false(stratus_radix_sort_on_device(device, COUNT_MAX));
  device->device->largest_allocation = largest;
  device->device->builds = false;
  assert_false(stratus_radix_sort_on_device(device, COUNT_MAX));
  device->device->builds = true;
}

/* Whichever call fails for want of memory, the last ones included, the host sorts the keys as they were given. */
static void without_memory_the_host_sorts(void** state)
{
  uint32_t random = 2;
  (void)state;
  if (tiny) {
    return;
  }
  make_keys(COUNT_MAX, 20, 0, &random);
  copy_keys(0, COUNT_MAX);
  assert_int_equal(stratus_radix_sort(host_context, keys[1], values[0], COUNT_MAX, 20), STRATUS_OK);
  copy_keys(1, COUNT_MAX);
  stratus_device_fail_after(device->device, 100000, CL_SUCCESS);
  assert_int_equal(stratus_radix_sort(device, keys[2], values[1], COUNT_MAX, 20), STRATUS_OK);
  const int64_t calls = 100000 - device->device->calls_left;
  assert_true(calls > 20);
  for (int64_t n = 0; n < calls; ++n) {
    copy_keys(1, COUNT_MAX);
    stratus_device_fail_after(device->device, n, CL_MEM_OBJECT_ALLOCATION_FAILURE);
    assert_int_equal(stratus_radix_sort(device, keys[2], values[1], COUNT_MAX, 20), STRATUS_OK);
    stratus_device_fail_after(device->device, -1, CL_SUCCESS);
    assert_same_order(COUNT_MAX);
  }
}

int test_radix_sort_device(void)
{
  if (no_device()) {
    return TEST_SKIPPED;
  }
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(keys_are_sorted_as_by_the_host),
    cmocka_unit_test(many_keys_go_to_the_device),
    cmocka_unit_test(without_memory_the_host_sorts),
  };
  return cmocka_run_group_tests(tests, open_device, close_device);
}
