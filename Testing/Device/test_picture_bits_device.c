/* SPDX-License-Identifier: BSD-3-Clause
 * OpenCL on a processor, PoCL's and Intel's, draws pictures with the bits that are on record for the host. */
#define CASE_FULL_SIZE
#include "picture_bits.h"
#include "testing.h"

static void a_device_draws_the_bits_of_record(void** state)
{
  (void)state;
  stratus_context* context = case_context("0", 2);
  assert_true(stratus_context_on_device(context));
  const int others = bits_check(context, stratus_context_device(context), few_run());
  stratus_context_destroy(context);
  assert_int_equal(others, 0);
}

int test_picture_bits_device(void)
{
  if (stratus_device_count() == 0) {
    return test_skip("no OpenCL device on this machine");
  }
  const struct CMUnitTest tests[] = { cmocka_unit_test(a_device_draws_the_bits_of_record) };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
