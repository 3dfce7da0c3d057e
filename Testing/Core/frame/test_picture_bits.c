/* SPDX-License-Identifier: BSD-3-Clause
 * Pictures keep their bits, from version to version, whichever compiler built the core and whichever instruction set runs it. */
#define CASE_FULL_SIZE
#include "picture_bits.h"

#include "base.h"
#include "testing.h"

static void every_instruction_set_draws_the_bits_of_record(void** state)
{
  (void)state;
  stratus_context* context = case_context("host", 2);
  int others = 0;
  for (int isa = stratus_isa_highest(); isa >= 0; --isa) {
    static const char* const names[] = { "baseline", "AVX2", "AVX-512 by loads", "AVX-512 by gathers" };
    context->isa = isa;
    others += bits_check(context, names[isa], 0);
  }
  stratus_context_destroy(context);
  assert_int_equal(others, 0);
}

int test_picture_bits(void)
{
  const struct CMUnitTest tests[] = { cmocka_unit_test(every_instruction_set_draws_the_bits_of_record) };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
