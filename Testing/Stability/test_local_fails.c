/* SPDX-License-Identifier: BSD-3-Clause
 * Memory runs out while rule local is measured, and while a caster that has measured it draws with another rule. Nothing leaks, no other
 * rule uses the map of rough blocks, and the next picture is right. */
#include "faulty_allocator.h"
#include "picture_case.h"

#define REQUESTS_MAX 400

static picture right;
static picture plain;
static picture again;

static stratus_status draw(stratus_ray_caster* caster, const picture_case* c, picture* p)
{
  const stratus_image image = { .width = CASE_WIDTH, .height = CASE_HEIGHT, .rgba = p->rgba };
  return stratus_ray_caster_render(caster, &c->volume, &c->transfer, &c->camera, &c->options, &image, &p->report);
}

/* Lets the n-th allocation of a picture fail. Returns 1 if it had so many. */
static int draw_failing(faulty_allocator* allocator, int64_t n, stratus_ray_caster* caster, const picture_case* c, stratus_status* status)
{
  allocator->fail_at = allocator->calls + n;
  *status = draw(caster, c, &again);
  const int failed = allocator->calls >= allocator->fail_at;
  allocator->fail_at = 0;
  return failed;
}

static void each_allocation_may_fail(void** state)
{
  (void)state;
  faulty_allocator allocator = { 0 };
  const stratus_context_options options = faulty_options(&allocator, "host");
  stratus_context* context = NULL;
  stratus_ray_caster* caster = NULL;
  picture_case c, other;
  int failures = 0, without = 0;
  assert_int_equal(stratus_context_create(&options, &context, NULL, 0), STRATUS_OK);
  case_create_local(context, 1, &c);
  other = c;
  other.options.sampling.rule = STRATUS_SAMPLING_MIDPOINT;
  other.options.sampling.tolerance = 0.0;
  assert_int_equal(stratus_ray_caster_create(context, &caster), STRATUS_OK);
  assert_int_equal(draw(caster, &c, &right), STRATUS_OK);
  assert_int_equal(draw(caster, &other, &plain), STRATUS_OK);
  assert_int_equal(right.report.sampling, STRATUS_SAMPLING_LOCAL);
  stratus_ray_caster_destroy(caster);
  const int64_t live = allocator.live;

  int more = 1;
  for (int64_t n = 1; more; ++n) { /* while it is measured */
    stratus_status status;
    assert_true(n < REQUESTS_MAX);
    assert_int_equal(stratus_ray_caster_create(context, &caster), STRATUS_OK);
    more = draw_failing(&allocator, n, caster, &c, &status);
    assert_true(status == STRATUS_OUT_OF_MEMORY || status == STRATUS_OK);
    failures += more;
    assert_int_equal(draw(caster, &c, &again), STRATUS_OK);
    if (again.report.sampling == STRATUS_SAMPLING_LOCAL) {
      assert_memory_equal(again.rgba, right.rgba, sizeof right.rgba);
    } else { /* there was no memory for the map, and another rule keeps the tolerance */
      ++without;
      assert_true(again.report.tolerance_met && again.report.expected_error <= c.options.sampling.tolerance);
    }
    stratus_ray_caster_destroy(caster);
    assert_int_equal(allocator.live, live);
  }
  more = 1;
  for (int64_t n = 1; more; ++n) { /* while the caster changes to another rule */
    stratus_status status;
    assert_true(n < REQUESTS_MAX);
    assert_int_equal(stratus_ray_caster_create(context, &caster), STRATUS_OK);
    assert_int_equal(draw(caster, &c, &again), STRATUS_OK);
    more = draw_failing(&allocator, n, caster, &other, &status);
    assert_true(status == STRATUS_OUT_OF_MEMORY || again.report.sampling == STRATUS_SAMPLING_MIDPOINT);
    assert_int_equal(draw(caster, &other, &again), STRATUS_OK);
    assert_memory_equal(again.rgba, plain.rgba, sizeof plain.rgba);
    assert_int_equal(draw(caster, &c, &again), STRATUS_OK);
    assert_memory_equal(again.rgba, right.rgba, sizeof right.rgba);
    stratus_ray_caster_destroy(caster);
    assert_int_equal(allocator.live, live);
  }
  print_message("             %d allocations refused, %d pictures without the rule\n", failures, without);
  assert_true(failures > 20 && without > 0);
  case_destroy(&c);
  stratus_context_destroy(context);
  assert_int_equal(allocator.live, 0);
}

int test_local_fails(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(each_allocation_may_fail),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
