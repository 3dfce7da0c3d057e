/* SPDX-License-Identifier: BSD-3-Clause
 * Distance fields built by an OpenCL device against the host's, to the bit: by a processor's OpenCL, and by the same taken
 * for a GPU. Run with the argument `--tiny` it takes few and small grids. */
#include "fields.h"

#include "device.h"
#include "device_pair.h"
#include "jump_flooding_passes.h"

static void compare_reports(stratus_field_report* a, stratus_field_report* b)
{
  a->build_ms = b->build_ms = 0.0;
  assert_memory_equal(a, b, sizeof *a);
}

static void compare_method(const test_set* s, stratus_field_method method, int is_signed)
{
  stratus_field_report reports[2];
  memset(reports, 0, sizeof reports);
  stratus_field* a = make_field(host_context, s, method, is_signed, &reports[0]);
  const uint64_t launched = device->report.launched;
  stratus_field* b = make_field(device, s, method, is_signed, &reports[1]);
  const int64_t total = set_voxels(s);
  for (int64_t v = 0; v < total; ++v) {
    if (distance_at(a, v) != distance_at(b, v)) {
      fail_msg("%s signed %d, voxel %d of %dx%dx%d: %g, not %g", stratus_field_method_name(method), is_signed, (int)v, (int)s->n[0],
        (int)s->n[1], (int)s->n[2], distance_at(b, v), distance_at(a, v));
    }
  }
  if (method >= STRATUS_FIELD_JFA) {
    assert_memory_equal(a->nearest, b->nearest, (size_t)total * sizeof(uint32_t));
  } else if (s->count > 0 && s->count < total) {
    assert_true(b->bytes >= 4); /* the device's own: the host would have taken 2 */
    /* A processor takes planes and tiles of columns, a GPU and 64 bits an axis after the other. */
    assert_int_equal(device->report.launched - launched, device->device->is_cpu && b->bytes == 4 ? 2 : 3);
  }
  compare_reports(&reports[0], &reports[1]);
  stratus_field_destroy(a);
  stratus_field_destroy(b);
}

static void compare_set(test_set* s)
{
  for (int method = 0; method <= STRATUS_FIELD_AJFA_FIG5; ++method) {
    for (int is_signed = 0; is_signed < 2; ++is_signed) {
      compare_method(s, (stratus_field_method)method, is_signed);
    }
  }
  free_set(s);
}

static void every_method_equals_the_hosts(void** state)
{
  uint32_t random = 1;
  (void)state;
  for (int grid = 0; grid < (tiny ? 2 : few_run() ? 3 : 12); ++grid) {
    test_set s = make_random_set(host_context, 1 + random_below(&random, 9), 1 + random_below(&random, 9), 1 + random_below(&random, 9),
      grid < 3 ? grid : 1 + random_below(&random, 90), &random);
    compare_set(&s);
  }
  if (!tiny) {
    test_set wide = make_random_set(host_context, 131, 7, 5, 600, &random), high = make_random_set(host_context, 5, 7, 201, 1500, &random);
    test_set cube = make_random_set(host_context, 40, 37, 33, 4000, &random);
    compare_set(&wide);
    compare_set(&high);
    compare_set(&cube);
  }
}

static void squares_beyond_32_bits_equal_the_hosts(void** state)
{
  (void)state;
  if (tiny) {
    return;
  }
  test_set s = make_set(3, 50000, 1);
  s.effective[4] = s.effective[70001] = 1;
  take_set(host_context, &s);
  compare_method(&s, STRATUS_FIELD_EXACT, 1);
  compare_method(&s, STRATUS_FIELD_JFA, 0);
  free_set(&s);
}

/* Every call to the device fails in turn: an error that says so, and the next attempt is right. */
static void a_device_that_is_lost_is_reported_and_nothing_leaks(void** state)
{
  uint32_t random = 2;
  (void)state;
  test_set s = make_random_set(host_context, 6, 5, 4, 20, &random);
  const stratus_field_method methods[] = { STRATUS_FIELD_EXACT, STRATUS_FIELD_AJFA };
  for (size_t m = 0; m < 2; ++m) {
    stratus_field_options options = stratus_field_options_default();
    options.method = methods[m];
    options.is_signed = 1;
    stratus_status status = STRATUS_DEVICE_ERROR;
    int64_t calls = 0;
    for (; status != STRATUS_OK && calls < 2000; ++calls) {
      stratus_field* field = NULL;
      stratus_device_fail_after(device->device, calls, CL_DEVICE_NOT_AVAILABLE);
      status = stratus_field_create(device, s.voxels, &options, &field, NULL);
      stratus_device_fail_after(device->device, -1, CL_SUCCESS);
      if (status != STRATUS_OK) {
        assert_int_equal(status, STRATUS_DEVICE_ERROR);
        assert_null(field);
        assert_non_null(strstr(stratus_context_message(device), "CL_DEVICE_NOT_AVAILABLE"));
      }
      stratus_field_destroy(field);
    }
    assert_int_equal(status, STRATUS_OK);
    assert_true(calls > 10);
    compare_method(&s, methods[m], 1);
  }
  free_set(&s);
}

int test_distance_field_device(void)
{
  if (no_device()) {
    return TEST_SKIPPED;
  }
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(every_method_equals_the_hosts),
    cmocka_unit_test(squares_beyond_32_bits_equal_the_hosts),
    cmocka_unit_test(a_device_that_is_lost_is_reported_and_nothing_leaks),
  };
  /* A processor's OpenCL has a flooding of its own. */
  const int failed = cmocka_run_group_tests(tests, open_device, close_device);
  return failed + cmocka_run_group_tests(tests, open_device_as_gpu, close_device);
}
