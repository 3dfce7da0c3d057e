/* SPDX-License-Identifier: BSD-3-Clause
 * How much heights are exaggerated. */
#include "structures.h"

#include "stratus/look.h"

#include <math.h>

static void flat_boxes_become_a_fifth_as_high_as_wide(void** state)
{
  (void)state;
  static const struct {
    double bounds[6];
    int up;
    double factor;
  } cases[] = {
    { { 0, 4e7, -1e7, 1e7, -5700, 0 }, 2, 1400 }, /* 1403.5: an ocean */
    { { -1e7, 1e7, 0, 4e7, -5700, 0 }, 2, 1400 }, /* the width is the larger extent */
    { { 0, 60e3, 0, 40e3, -25, 0 }, 2, 480 }, { { 0, 10, 0, 10, 0, 0.99 }, 2, 2 }, { { 0, 10, 0, 10, 0, 1 }, 2, 1 },
    { { 0, 10, 0, 10, 0, 2 }, 2, 1 }, { { 0, 10, 0, 10, 0, 20 }, 2, 1 }, { { 0, 0.001, 0, 10, 0, 10 }, 0, 2000 },
    { { 0, 10, 0, 10, 5, 5 }, 2, 1 }, { { 0, 10, 0, 10, 5, 4 }, 2, 1 }, { { 0, 0, 0, 0, 0, 1 }, 2, 1 },
    { { 0, INFINITY, 0, 1, 0, 1 }, 2, 1 }, { { 0, 1, 0, 1, NAN, 1 }, 2, 1 }, { { 0, 1, 0, 1, 0, 1e-320 }, 2, 1 }, /* the factor overflows */
  };
  for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i) {
    const double factor = stratus_look_height_factor(cases[i].bounds, cases[i].up);
    if (fabs(factor - cases[i].factor) > 1e-12 * cases[i].factor) { /* a power of ten is rounded */
      fail_msg("case %zu: %.17g, not %.17g", i, factor, cases[i].factor);
    }
  }
  assert_true(stratus_look_height_factor(NULL, 2) == 1.0);
  assert_true(stratus_look_height_factor(cases[0].bounds, 3) == 1.0);
}

int test_look_heights(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(flat_boxes_become_a_fifth_as_high_as_wide),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
