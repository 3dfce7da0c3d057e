/* SPDX-License-Identifier: BSD-3-Clause
 * The build report: which time, bytes and kernels count for a stage and which for the stages within it, and how stages are summed, listed
 * and forgotten. */
#include "base.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>

#include <cmocka.h>

static stratus_context* make_host(void)
{
  stratus_context_options options = stratus_context_options_default();
  stratus_context* context = NULL;
  options.device = "host";
  assert_int_equal(stratus_context_create(&options, &context, NULL, 0), STRATUS_OK);
  return context;
}

/* Launches are the counts of device_program.c. Stages are made to have begun long ago, so that their times are known. */
static void a_stage_leaves_out_the_stages_within_it(void** state)
{
  (void)state;
  stratus_context* context = make_host();
  stratus_build_stage stages[STRATUS_BUILD_STAGES_MAX];
  const double start = stratus_now_ms();
  stratus_stage outer = stratus_stage_begin(context);
  outer.start_ms -= 1000.0;
  ++context->report.launched;
  for (int i = 0; i < 2; ++i) {
    stratus_stage inner = stratus_stage_begin(context);
    inner.start_ms -= 300.0;
    stratus_stage innermost = stratus_stage_begin(context);
    innermost.start_ms -= 100.0;
    context->report.launched += 4;
    stratus_stage_end(context, &innermost, "innermost", 5);
    stratus_stage_end(context, &inner, "inner", 70);
  }
  context->report.launched += 2;
  stratus_stage_end(context, &outer, "outer", 900);
  const double elapsed = stratus_now_ms() - start + 1e-6;
  assert_int_equal(stratus_context_get_build_report(context, stages, STRATUS_BUILD_STAGES_MAX), 3);
  const char* const names[] = { "innermost", "inner", "outer" };
  const double least_ms[] = { 200.0, 400.0, 400.0 };
  const uint64_t bytes[] = { 10, 140, 900 }, kernels[] = { 8, 0, 3 };
  for (int i = 0; i < 3; ++i) {
    assert_string_equal(stages[i].name, names[i]);
    assert_string_equal(stages[i].where, kernels[i] ? stratus_context_device(context) : "host");
    assert_int_equal(stages[i].bytes, bytes[i]);
    assert_int_equal(stages[i].kernels, kernels[i]);
    /* A stage's own time is its time less the time of the stages within it. The clock adds at most `elapsed`. */
    assert_true(stages[i].ms >= least_ms[i] - elapsed && stages[i].ms <= least_ms[i] + elapsed);
  }
  stratus_context_destroy(context);
}

static void stages_are_summed_by_name_and_place_until_the_next_start(void** state)
{
  (void)state;
  stratus_context* context = make_host();
  stratus_build_stage stages[2] = { { .name = "untouched" }, { .name = "untouched" } };
  assert_int_equal(stratus_context_get_build_report(context, stages, 2), 0);
  for (int i = 0; i < 4; ++i) {
    const stratus_stage stage = stratus_stage_begin(context);
    context->report.launched += (uint64_t)(i % 2);
    stratus_stage_end(context, &stage, "one", 1);
  }
  assert_int_equal(stratus_context_get_build_report(context, stages, 1), 2);
  assert_string_equal(stages[0].where, "host");
  assert_string_equal(stages[1].name, "untouched");
  assert_int_equal(stratus_context_get_build_report(context, stages, 2), 2);
  assert_int_equal(stages[0].bytes, 2);
  assert_int_equal(stages[0].kernels, 0);
  assert_string_equal(stages[1].where, stratus_context_device(context));
  assert_int_equal(stages[1].kernels, 2);

  stratus_context_start_build_report(context);
  assert_int_equal(stratus_context_get_build_report(context, stages, 2), 0);
  const stratus_stage stage = stratus_stage_begin(context);
  stratus_stage_end(context, &stage, "one", 8);
  assert_int_equal(stratus_context_get_build_report(context, stages, 2), 1);
  assert_int_equal(stages[0].bytes, 8);
  stratus_context_destroy(context);
}

static void a_stage_that_failed_is_not_reported(void** state)
{
  (void)state;
  stratus_context* context = make_host();
  stratus_build_stage stages[1];
  const stratus_stage outer = stratus_stage_begin(context);
  (void)stratus_stage_begin(context); /* never ended */
  context->report.launched += 3;
  stratus_stage_end(context, &outer, "outer", 0);
  assert_int_equal(stratus_context_get_build_report(context, stages, 1), 1);
  assert_int_equal(stages[0].kernels, 3);
  stratus_context_destroy(context);
}

static void a_full_report_and_none_are_harmless(void** state)
{
  (void)state;
  static char names[STRATUS_BUILD_STAGES_MAX + 1][8];
  stratus_context* context = make_host();
  for (int i = 0; i <= STRATUS_BUILD_STAGES_MAX; ++i) {
    const stratus_stage stage = stratus_stage_begin(context);
    snprintf(names[i], sizeof names[i], "%d", i);
    stratus_stage_end(context, &stage, names[i], 1);
  }
  assert_int_equal(stratus_context_get_build_report(context, NULL, 100), STRATUS_BUILD_STAGES_MAX);
  assert_int_equal(stratus_context_get_build_report(NULL, NULL, 100), 0);
  stratus_context_start_build_report(NULL);
  stratus_context_destroy(context);
}

int test_build_report(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(a_stage_leaves_out_the_stages_within_it),
    cmocka_unit_test(stages_are_summed_by_name_and_place_until_the_next_start),
    cmocka_unit_test(a_stage_that_failed_is_not_reported),
    cmocka_unit_test(a_full_report_and_none_are_harmless),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
