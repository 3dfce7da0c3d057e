/* SPDX-License-Identifier: BSD-3-Clause
 * The trial of gathers and loads: both read the same values, which a plain loop reads, too, and the choice is one of the two sets. */
#include "gather_trial.h"
#include "instruction_set.h"
#include "structures.h"
#include "testing.h"

#define READS 256
#define ROW 64

static void gathers_and_loads_read_the_same(void** state)
{
  (void)state;
  static float table[STRATUS_GATHER_TRIAL];
  for (int i = 0; i < STRATUS_GATHER_TRIAL; ++i) {
    table[i] = (float)(i % 97);
  }
  for (int seed = 0; seed < 20; ++seed) {
    double sum = 0.0; /* of whole numbers, so that no order rounds */
    for (int lane = 0; lane < 16; ++lane) {
      uint32_t at = (uint32_t)(lane + seed);
      for (int n = 0; n < READS; ++n) {
        const uint32_t index = at & (STRATUS_GATHER_TRIAL / 2 - 1);
        sum += table[index] + table[index + 1] + table[index + ROW] + table[index + ROW + 1];
        at = at * 5 + 37;
      }
    }
    assert_true((double)stratus_gather_trial(table, seed, 0) == sum);
    assert_true((double)stratus_gather_trial(table, seed, 1) == sum);
  }
}

static void the_best_set_is_one_of_both(void** state)
{
  (void)state;
  const int best = stratus_isa_best();
  assert_true(best == 2 || best == 3);
  for (int i = 0; i < 100; ++i) {
    assert_int_equal(stratus_isa_best(), best); /* one measurement serves a process */
  }
}

int test_gather_trial(void)
{
  if (stratus_isa_highest() < 3) {
    return test_skip("this build or machine has no AVX-512");
  }
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(gathers_and_loads_read_the_same),
    cmocka_unit_test(the_best_set_is_one_of_both),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
