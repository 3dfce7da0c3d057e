/* SPDX-License-Identifier: BSD-3-Clause
 * Errors of floodings, written down: distances are never too short, sometimes too long, and unfilled where steps fall too fast. Also memory
 * refused at the n-th request, for every method. */
#include "faulty_allocator.h"
#include "fields.h"

#include "device.h"
#include "device_state.h"
#include "jump_flooding_passes.h"

#include <stdio.h>

#define EDGE 40
#define REQUESTS_MAX 200

typedef struct outcome {
  int64_t longer, unfilled;
} outcome;

/* Compares a flooding with the exact field. A shorter distance is a fault. */
static outcome compare(stratus_context* context, const test_set* s, stratus_field_method method, int is_signed)
{
  stratus_field *exact = make_field(context, s, STRATUS_FIELD_EXACT, is_signed, NULL),
                *flooded = make_field(context, s, method, is_signed, NULL);
  outcome o = { 0, 0 };
  for (int64_t v = 0; v < set_voxels(s); ++v) {
    const double right = fabs(distance_at(exact, v)), got = fabs(distance_at(flooded, v));
    if (got < right) {
      fail_msg("%s, voxel %d: %g is shorter than %g", stratus_field_method_name(method), (int)v, got, right);
    }
    o.unfilled += isinf(got) && !isinf(right);
    o.longer += got > right && !isinf(got);
  }
  stratus_field_destroy(exact);
  stratus_field_destroy(flooded);
  return o;
}

static test_set make_plate(stratus_context* context)
{
  test_set s = make_set(EDGE, EDGE, EDGE);
  for (int64_t j = 0; j < EDGE; ++j) {
    for (int64_t i = 0; i < EDGE; ++i) {
      const int64_t k = (31 * i + 17 * j) / 100 + 8;
      s.effective[(k * EDGE + j) * EDGE + i] = 1;
    }
  }
  take_set(context, &s);
  return s;
}

static test_set make_shell(stratus_context* context)
{
  test_set s = make_set(EDGE, EDGE, EDGE);
  for (int64_t v = 0; v < set_voxels(&s); ++v) {
    const double x = (double)(v % EDGE) - 19.3, y = (double)(v / EDGE % EDGE) - 20.1, z = (double)(v / (EDGE * EDGE)) - 18.7;
    s.effective[v] = fabs(sqrt(x * x + y * y + z * z) - 15.0) < 0.5;
  }
  take_set(context, &s);
  return s;
}

/* longer: numbers of voxels with too long a distance, by method from JFA on. */
static void check_outcomes(stratus_context* context, test_set* s, int is_signed, const int64_t longer[7])
{
  for (int method = STRATUS_FIELD_JFA; method <= STRATUS_FIELD_AJFA_FIG5; ++method) {
    const outcome o = compare(context, s, (stratus_field_method)method, is_signed);
    const int64_t expected = longer[method - STRATUS_FIELD_JFA];
    print_message("  %s: %d of %d too long, %d unfilled\n", stratus_field_method_name((stratus_field_method)method), (int)o.longer,
      (int)set_voxels(s), (int)o.unfilled);
    assert_int_equal(o.longer, expected);
    assert_int_equal(o.unfilled, 0);
  }
  free_set(s);
}

static void plates_and_shells_come_out_as_wrong_as_ever(void** state)
{
  (void)state;
  static const int64_t plate[7] = { 138, 43, 7, 79, 1, 14, 4056 };
  static const int64_t shell[7] = { 85, 28, 5, 69, 3, 9, 3115 };
  stratus_context* context = make_context("host", 2);
  test_set s = make_plate(context);
  check_outcomes(context, &s, 0, plate);
  s = make_shell(context);
  check_outcomes(context, &s, 1, shell);
  stratus_context_destroy(context);
}

static void floodings_that_halve_leave_nothing_unfilled(void** state)
{
  static const int64_t grids[][3] = { { 1, 1, 1 }, { 2, 3, 5 }, { 9, 1, 7 }, { 33, 17, 1 }, { 40, 40, 40 }, { 1, 1, 63 } };
  (void)state;
  stratus_context* context = make_context("host", 2);
  for (size_t g = 0; g < sizeof grids / sizeof *grids; ++g) {
    for (int corner = 0; corner < 2; ++corner) {
      test_set s = make_set(grids[g][0], grids[g][1], grids[g][2]);
      s.effective[corner ? set_voxels(&s) - 1 : 0] = 1;
      take_set(context, &s);
      for (int method = STRATUS_FIELD_JFA; method <= STRATUS_FIELD_AJFA; ++method) {
        const outcome o = compare(context, &s, (stratus_field_method)method, 0);
        assert_int_equal(o.unfilled, 0);
        assert_int_equal(o.longer, 0); /* there is but one to find */
      }
      free_set(&s);
    }
  }
  stratus_context_destroy(context);
}

/* Which places of a line a single voxel at 42 is carried to by the steps in their order, and none else. */
static void figure_5_leaves_voxels_unfilled_around_a_single_one(void** state)
{
  static const int printed[] = { 64, 48, 15, 10, 3, 1 };
  (void)state;
  stratus_context* context = make_context("host", 2);
  stratus_field_report report;
  test_set s = make_set(128, 8, 1);
  s.effective[42] = 1;
  take_set(context, &s);
  stratus_field* field = make_field(context, &s, STRATUS_FIELD_AJFA_FIG5, 0, &report);
  assert_int_equal(report.passes, 6);
  assert_memory_equal(report.steps, printed, sizeof printed);
  int reached[128] = { 0 }, unfilled = 0;
  reached[42] = 1;
  for (int pass = 0; pass < 6; ++pass) {
    int next[128];
    for (int i = 0; i < 128; ++i) {
      const int low = i - printed[pass], high = i + printed[pass];
      next[i] = reached[i] || (low >= 0 && reached[low]) || (high < 128 && reached[high]);
    }
    memcpy(reached, next, sizeof next);
  }
  for (int i = 0; i < 128; ++i) {
    assert_true(stratus_field_get(field, i, 0, 0) == (reached[i] ? fabs(i - 42.0) : INFINITY));
    unfilled += !reached[i];
  }
  assert_int_equal(unfilled, 16);
  stratus_field_destroy(field);
  free_set(&s);
  stratus_context_destroy(context);
}

static void steps_follow_the_method(void** state)
{
  static const struct {
    stratus_field_method method;
    int steps[16]; /* to the first 0 */
  } expected[] = { { STRATUS_FIELD_JFA, { 20, 10, 5, 3, 2, 1 } }, { STRATUS_FIELD_JFA_1, { 20, 10, 5, 3, 2, 1, 1 } },
    { STRATUS_FIELD_JFA_2, { 20, 10, 5, 3, 2, 1, 2, 1 } }, { STRATUS_FIELD_1_JFA, { 1, 20, 10, 5, 3, 2, 1 } },
    { STRATUS_FIELD_JFA_SQUARED, { 20, 10, 5, 3, 2, 1, 20, 10, 5, 3, 2, 1 } }, { STRATUS_FIELD_AJFA_FIG5, { 20, 15, 5, 3, 1 } } };
  uint32_t random = 3;
  (void)state;
  stratus_context* context = make_context("host", 2);
  test_set s = make_random_set(context, EDGE, 30, 20, 500, &random);
  stratus_field_report report;
  for (size_t m = 0; m < sizeof expected / sizeof *expected; ++m) {
    stratus_field_destroy(make_field(context, &s, expected[m].method, 0, &report));
    int count = 0;
    for (; expected[m].steps[count]; ++count) {
      assert_int_equal(report.steps[count], expected[m].steps[count]);
    }
    assert_int_equal(report.passes, count);
  }
  free_set(&s);
  stratus_context_destroy(context);
}

/* AJFA: each step is at least half the one before, the slower fall comes exactly after good passes, and the passes' numbers add up. */
static void the_adaptive_steps_follow_what_the_passes_did(void** state)
{
  static const int64_t fills[] = { 3, 100, 2000, 60000 };
  uint32_t random = 4;
  int slow = 0, fast = 0;
  (void)state;
  stratus_context* context = make_context("host", 2);
  for (size_t f = 0; f < 4; ++f) {
    test_set s = make_random_set(context, EDGE, EDGE, EDGE, fills[f], &random);
    stratus_field_report report;
    stratus_field* field = make_field(context, &s, STRATUS_FIELD_AJFA, 0, &report);
    const double searched = (double)(set_voxels(&s) - s.count);
    double updated = 0.0;
    assert_in_range(report.passes, 2, 64);
    assert_int_equal(report.steps[0], EDGE / 2);
    assert_int_equal(report.steps[report.passes - 1], 1);
    for (int pass = 0; pass < report.passes; ++pass) {
      assert_true(report.e1[pass] >= 0.0 && report.e1[pass] <= 1.0 && report.e2[pass] >= 0.0 && report.e2[pass] <= 1.0);
      updated += report.e1[pass] * searched;
      if (pass + 1 < report.passes && report.steps[pass] > 2) {
        const int step = report.steps[pass], good = report.e1[pass] * (1.0 - report.e2[pass]) >= 0.05;
        assert_int_equal(report.steps[pass + 1], good && (3 * step + 3) / 4 < step ? (3 * step + 3) / 4 : (step + 1) / 2);
        slow += good;
        fast += !good;
      }
    }
    assert_true(fabs(updated - (double)report.updated) < 0.5); /* each term is a whole number up to rounding */
    stratus_field_destroy(field);
    free_set(&s);
  }
  assert_true(slow > 0 && fast > 0);
  stratus_context_destroy(context);
}

/* E1 and E2 by a plain flooding in double precision, pass by pass. */
static void the_first_passes_numbers_follow_equations_6_and_7(void** state)
{
  uint32_t random = 5;
  (void)state;
  stratus_context* context = make_context("host", 2);
  test_set s = make_random_set(context, 9, 8, 7, 12, &random);
  const int64_t total = set_voxels(&s);
  stratus_field_report report;
  stratus_field* field = make_field(context, &s, STRATUS_FIELD_1_JFA, 0, &report);
  double *before = malloc((size_t)total * sizeof(double)), *after = malloc((size_t)total * sizeof(double));
  assert_non_null(before);
  assert_non_null(after);
  /* Step 1 first: a voxel learns the distance to a neighbour. Then step 5, of which only E1 is checked. */
  double updated = 0.0;
  for (int64_t v = 0; v < total; ++v) {
    double best = INFINITY;
    for (int64_t o = 0; o < total; ++o) {
      const int64_t x = llabs(o % 9 - v % 9), y = llabs(o / 9 % 8 - v / 9 % 8), z = llabs(o / 72 - v / 72);
      const double d = sqrt((double)(x * x + y * y + z * z));
      best = s.effective[o] && x <= 1 && y <= 1 && z <= 1 && d < best ? d : best;
    }
    before[v] = s.effective[v] ? 0.0 : INFINITY;
    after[v] = best;
    updated += after[v] < before[v];
  }
  assert_true(fabs(report.e1[0] - updated / (double)(total - s.count)) < 1e-12);
  assert_true(report.e2[0] == 0.0); /* from nothing known */
  free(before);
  free(after);
  stratus_field_destroy(field);
  free_set(&s);
  s = make_set(6, 1, 1);
  s.effective[0] = s.effective[4] = 1;
  take_set(context, &s);
  field = make_field(context, &s, STRATUS_FIELD_JFA, 0, &report);
  /* By hand. Step 3: voxel 1 learns of 4, voxel 3 of 0, both 3 away. Step 2: 1 and 3 learn from each other what is 1 away, 2 learns of 0
   * and 5 by way of 3 of 0, 5 away. Step 1: 5 learns of 4. */
  static const int steps[] = { 3, 2, 1 };
  static const double e1[] = { 2.0 / 4.0, 4.0 / 4.0, 1.0 / 4.0 }, e2[] = { 0.0, (1.0 / 3.0 + 1.0 / 3.0) / 4.0, 1.0 / 5.0 };
  assert_int_equal(report.passes, 3);
  assert_int_equal(report.updated, 7);
  for (int pass = 0; pass < 3; ++pass) {
    assert_int_equal(report.steps[pass], steps[pass]);
    assert_true(fabs(report.e1[pass] - e1[pass]) < 1e-12);
    assert_true(fabs(report.e2[pass] - e2[pass]) < 1e-5); /* ratios are kept in 65536ths */
  }
  stratus_field_destroy(field);
  free_set(&s);
  stratus_context_destroy(context);
}

static void a_cap_on_the_first_step_is_kept_and_leaves_the_far_unknown(void** state)
{
  (void)state;
  stratus_context* context = make_context("host", 2);
  test_set s = make_set(60, 3, 3);
  s.effective[0] = 1;
  take_set(context, &s);
  stratus_field_options options = stratus_field_options_default();
  stratus_field* field = NULL;
  stratus_field_report report;
  options.method = STRATUS_FIELD_JFA;
  options.first_step = 8;
  assert_int_equal(stratus_field_create(context, s.voxels, &options, &field, &report), STRATUS_OK);
  assert_int_equal(report.steps[0], 8);
  assert_int_equal(report.passes, 4);
  for (int64_t i = 0; i < 60; ++i) {
    assert_true(stratus_field_get(field, i, 0, 0) == (i <= 15 ? (double)i : INFINITY)); /* 8 + 4 + 2 + 1 */
  }
  float rgba[4 * 60 * 9];
  assert_int_equal(stratus_field_rgba(field, s.voxels, rgba), STRATUS_OK);
  assert_true(rgba[4 * 16] == -1.0f && rgba[4 * 16 + 1] == -1.0f && rgba[4 * 16 + 2] == -1.0f && isinf(rgba[4 * 16 + 3]));
  assert_true(rgba[4 * 15] == 0.0f && rgba[4 * 15 + 3] == 15.0f);
  stratus_field_destroy(field);
  free_set(&s);
  stratus_context_destroy(context);
}

static void a_line_of_262144_voxels_floods_in_64_bits(void** state)
{
  (void)state;
  stratus_context* context = make_context("host", 2);
  test_set s = make_set(1 << 18, 1, 1);
  s.effective[3] = 1;
  take_set(context, &s);
  const outcome o = compare(context, &s, STRATUS_FIELD_JFA, 0);
  assert_int_equal(o.longer + o.unfilled, 0);
  free_set(&s);
  stratus_context_destroy(context);
}

static void a_grid_that_positions_do_not_name_is_refused(void** state)
{
  (void)state;
  stratus_context* context = make_context("host", 1);
  const int64_t n[3] = { 1 << 11, 1 << 11, 1 << 11 };
  const int32_t at[3] = { 1, 2, 3 };
  stratus_voxels* voxels = NULL;
  stratus_field* field = NULL;
  stratus_field_options options = stratus_field_options_default();
  options.method = STRATUS_FIELD_JFA;
  const stratus_bits set = { .n = { n[0], n[1], n[2] } };
  stratus_field_report report = { .passes = 0 };
  stratus_field nothing = { .context = context };
  assert_int_equal(stratus_voxels_create_list(context, n, at, 1, &voxels), STRATUS_OK);
  assert_int_equal(stratus_flood(context, &set, &options, &nothing, &report), STRATUS_OVERFLOW);
  assert_non_null(strstr(stratus_context_message(context), "take 33"));
  assert_null(field);
  stratus_voxels_destroy(voxels);
  stratus_context_destroy(context);
}

/* One method with the n-th request refused, for every n until all is granted. */
static void refuse_each_request(stratus_context* context, faulty_allocator* allocator, const test_set* s, stratus_field_method method)
{
  stratus_field_options options = stratus_field_options_default();
  options.method = method;
  options.is_signed = 1;
  const int64_t live = allocator->live;
  int64_t n = 1;
  for (; n < REQUESTS_MAX; ++n) {
    stratus_field* field = NULL;
    allocator->fail_at = allocator->calls + n;
    const stratus_status status = stratus_field_create(context, s->voxels, &options, &field, NULL);
    allocator->fail_at = 0;
    stratus_field_destroy(field);
    assert_int_equal(allocator->live, live);
    if (status == STRATUS_OK) {
      break;
    }
    assert_int_equal(status, STRATUS_OUT_OF_MEMORY);
    assert_null(field);
    assert_non_null(strstr(stratus_context_message(context), "bytes"));
  }
  assert_in_range(n, 4, REQUESTS_MAX - 1);
}

static void refuse_on(const char* device, int as_gpu)
{
  uint32_t random = 6;
  faulty_allocator allocator = { 0 };
  stratus_context_options options = faulty_options(&allocator, device);
  stratus_context* context = NULL;
  options.threads = 2;
  if (stratus_context_create(&options, &context, NULL, 0) != STRATUS_OK) {
    print_message("  no OpenCL device: left out\n");
    return;
  }
  if (as_gpu) {
    context->device->is_cpu = false;
  }
  test_set s = make_random_set(context, 9, 8, 7, 30, &random);
  for (int method = 0; method <= STRATUS_FIELD_AJFA_FIG5; ++method) {
    if (as_gpu) {
      stratus_field_destroy(make_field(context, &s, (stratus_field_method)method, 1, NULL)); /* kernels are kept: that counts as live */
    }
    refuse_each_request(context, &allocator, &s, (stratus_field_method)method);
  }
  float rgba[4 * 9 * 8 * 7];
  stratus_field* field = make_field(context, &s, STRATUS_FIELD_EXACT, 1, NULL);
  const int64_t live = allocator.live;
  for (int64_t n = 1; n <= 3; ++n) { /* the bits, the rooms */
    allocator.fail_at = allocator.calls + n;
    const stratus_status status = stratus_field_rgba(field, s.voxels, rgba);
    allocator.fail_at = 0;
    assert_int_equal(status, n < 3 ? STRATUS_OUT_OF_MEMORY : STRATUS_OK);
    assert_int_equal(allocator.live, live);
  }
  stratus_field_destroy(field);
  free_set(&s);
  stratus_context_destroy(context);
  assert_int_equal(allocator.live, 0);
}

static void fields_are_made_whole_or_not_at_all(void** state)
{
  (void)state;
  refuse_on("host", 0);
}

static void fields_of_a_device_are_made_whole_or_not_at_all(void** state)
{
  (void)state;
  refuse_on("0", 1);
}

int test_flooding_fails(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(plates_and_shells_come_out_as_wrong_as_ever),
    cmocka_unit_test(floodings_that_halve_leave_nothing_unfilled),
    cmocka_unit_test(figure_5_leaves_voxels_unfilled_around_a_single_one),
    cmocka_unit_test(steps_follow_the_method),
    cmocka_unit_test(the_adaptive_steps_follow_what_the_passes_did),
    cmocka_unit_test(the_first_passes_numbers_follow_equations_6_and_7),
    cmocka_unit_test(a_cap_on_the_first_step_is_kept_and_leaves_the_far_unknown),
    cmocka_unit_test(a_line_of_262144_voxels_floods_in_64_bits),
    cmocka_unit_test(a_grid_that_positions_do_not_name_is_refused),
    cmocka_unit_test(fields_are_made_whole_or_not_at_all),
    cmocka_unit_test(fields_of_a_device_are_made_whole_or_not_at_all),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
