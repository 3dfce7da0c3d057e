/* SPDX-License-Identifier: BSD-3-Clause
 * Value ranges, compared with a search of all values of every block. */
#include "structures.h"

/* 1 if a value (cell_centered) or else a cell of the box is hidden. */
static int hidden_in(const stratus_volume* v, const uint8_t* hidden, const int64_t lo[3], const int64_t hi[3])
{
  int64_t n[3], last[3];
  for (int a = 0; a < 3; ++a) {
    n[a] = v->cell_centered || v->dimensions[a] == 1 ? v->dimensions[a] : v->dimensions[a] - 1;
    last[a] = v->cell_centered || v->dimensions[a] == 1 ? hi[a] : hi[a] - 1;
  }
  for (int64_t z = lo[2]; hidden && z <= last[2]; ++z) {
    for (int64_t y = lo[1]; y <= last[1]; ++y) {
      for (int64_t x = lo[0]; x <= last[0]; ++x) {
        if (hidden[(z * n[1] + y) * n[0] + x]) {
          return 1;
        }
      }
    }
  }
  return 0;
}

typedef struct expected {
  float lo, hi;
  int gaps;
} expected;

static expected brute_force(const stratus_volume* v, double bias, const uint8_t* hidden, int64_t size, const int64_t block[3])
{
  expected e = { INFINITY, -INFINITY, 0 };
  int64_t lo[3], hi[3];
  for (int a = 0; a < 3; ++a) {
    lo[a] = block[a] * size;
    hi[a] = lo[a] + size < v->dimensions[a] ? lo[a] + size : v->dimensions[a] - 1;
  }
  for (int64_t z = lo[2]; z <= hi[2]; ++z) {
    for (int64_t y = lo[1]; y <= hi[1]; ++y) {
      for (int64_t x = lo[0]; x <= hi[0]; ++x) {
        const float value = stratus_volume_fetch(v, bias, (size_t)((z * v->dimensions[1] + y) * v->dimensions[0] + x));
        e.gaps |= !isfinite(value);
        e.lo = isfinite(value) && value < e.lo ? value : e.lo;
        e.hi = isfinite(value) && value > e.hi ? value : e.hi;
      }
    }
  }
  e.gaps |= hidden_in(v, hidden, lo, hi);
  return e;
}

static void check_block(const stratus_volume* v, const stratus_value_range* ranges, const uint8_t* hidden, const int64_t block[3])
{
  const expected e = brute_force(v, ranges->bias, hidden, ranges->block_size, block);
  const int64_t b = (block[2] * ranges->blocks[1] + block[1]) * ranges->blocks[0] + block[0];
  double low, high;
  int gaps;
  stratus_value_range_block(ranges, block[0], block[1], block[2], &low, &high, &gaps);
  if (ranges->lo[b] != e.lo || ranges->hi[b] != e.hi || gaps != e.gaps || ranges->gaps[b] != e.gaps) {
    fail_msg("type %d size %d block %d,%d,%d of a volume of %dx%dx%d stride %d: [%.9g, %.9g] gaps %d, not [%.9g, %.9g] %d", (int)v->type,
      ranges->block_size, (int)block[0], (int)block[1], (int)block[2], (int)v->dimensions[0], (int)v->dimensions[1], (int)v->dimensions[2],
      (int)v->value_stride, (double)ranges->lo[b], (double)ranges->hi[b], gaps, (double)e.lo, (double)e.hi, e.gaps);
  }
  assert_true(low == (double)e.lo + ranges->bias && high == (double)e.hi + ranges->bias);
  assert_false(signbit(ranges->lo[b]) && ranges->lo[b] == 0.0f);
}

static void check_volume(stratus_context* context, const stratus_volume* v, int size)
{
  stratus_value_range* ranges = NULL;
  uint8_t* hidden = NULL;
  float lo = INFINITY, hi = -INFINITY;
  int64_t blocks[3];
  int block_size;
  assert_int_equal(stratus_value_range_create(context, v, size, &ranges), STRATUS_OK);
  assert_int_equal(stratus_volume_hidden_cells(context, v, &hidden), STRATUS_OK);
  stratus_value_range_blocks(ranges, blocks, &block_size);
  assert_int_equal(block_size, size);
  for (int a = 0; a < 3; ++a) {
    const int64_t cells = v->dimensions[a] - 1;
    assert_int_equal(blocks[a], cells ? (cells + size - 1) / size : 1);
  }
  for (int64_t b = 0; b < blocks[0] * blocks[1] * blocks[2]; ++b) {
    check_block(v, ranges, hidden, (const int64_t[3]){ b % blocks[0], b / blocks[0] % blocks[1], b / blocks[0] / blocks[1] });
    lo = fminf(lo, ranges->lo[b]);
    hi = fmaxf(hi, ranges->hi[b]);
  }
  assert_true(ranges->whole_lo == lo && ranges->whole_hi == hi);
  double low = 1.0, high = 2.0;
  assert_int_equal(stratus_value_range_whole(ranges, &low, &high), lo <= hi ? STRATUS_OK : STRATUS_INVALID_ARGUMENT);
  assert_true(lo <= hi ? low == (double)lo + ranges->bias && high == (double)hi + ranges->bias : low == 1.0 && high == 2.0);
  stratus_release(context, hidden);
  stratus_value_range_destroy(ranges);
}

static void every_type_and_block_size_equals_brute_force(void** state)
{
  uint32_t random = 1;
  (void)state;
  stratus_context* context = make_context("host", 2);
  for (int type = STRATUS_INT8; type <= STRATUS_FLOAT64; ++type) {
    for (int size = 2; size <= 32; size *= 2) {
      for (int repeat = 0; repeat < 12; ++repeat) {
        sample_volume v = make_volume((stratus_type)type, 1 + random_below(&random, 9), 1 + random_below(&random, 9),
          1 + random_below(&random, 9), 1 + random_below(&random, 3), &random);
        check_volume(context, &v.view, size);
        free_volume(&v);
      }
      sample_volume v = make_volume((stratus_type)type, 70, 37, 35, 1, &random);
      check_volume(context, &v.view, size);
      free_volume(&v);
    }
  }
  stratus_context_destroy(context);
}

static void values_that_are_not_finite_are_skipped_and_flagged(void** state)
{
  uint32_t random = 2;
  (void)state;
  stratus_context* context = make_context("host", 2);
  for (int repeat = 0; repeat < 200; ++repeat) {
    sample_volume v = make_volume(repeat & 1 ? STRATUS_FLOAT32 : STRATUS_FLOAT64, 1 + random_below(&random, 20),
      1 + random_below(&random, 9), 1 + random_below(&random, 9), 1 + random_below(&random, 2), &random);
    spoil(&v, 1 + random_below(&random, 40), &random);
    check_volume(context, &v.view, 2 << random_below(&random, 3));
    free_volume(&v);
  }
  stratus_context_destroy(context);
}

static void a_volume_without_a_finite_value_has_no_range(void** state)
{
  (void)state;
  stratus_context* context = make_context("host", 2);
  float values[27];
  for (int i = 0; i < 27; ++i) {
    values[i] = i % 3 ? NAN : INFINITY;
  }
  stratus_volume v = stratus_volume_default();
  v.values = values;
  v.dimensions[0] = v.dimensions[1] = v.dimensions[2] = 3;
  check_volume(context, &v, 2);
  stratus_context_destroy(context);
}

static void hidden_points_and_cells_are_flagged(void** state)
{
  uint32_t random = 3;
  (void)state;
  stratus_context* context = make_context("host", 2);
  for (int repeat = 0; repeat < 200; ++repeat) {
    sample_volume v =
      make_volume(STRATUS_UINT8, 1 + random_below(&random, 12), 1 + random_below(&random, 9), 1 + random_below(&random, 9), 1, &random);
    add_ghosts(&v, repeat & 1, 1 + random_below(&random, 60), &random);
    check_volume(context, &v.view, 2 << random_below(&random, 3));
    free_volume(&v);
  }
  stratus_context_destroy(context);
}

static void an_offset_costs_a_wide_type_no_digits(void** state)
{
  (void)state;
  stratus_context* context = make_context("host", 1);
  const double values[2] = { 6e6, 6e6 + 1e-4 };
  const int64_t integers[2] = { INT64_C(4000000000000), INT64_C(4000000000003) };
  stratus_volume v = stratus_volume_default();
  stratus_value_range* ranges = NULL;
  double low, high;
  v.dimensions[0] = 2;
  v.values = values;
  v.type = STRATUS_FLOAT64;
  assert_int_equal(stratus_value_range_create(context, &v, 0, &ranges), STRATUS_OK);
  assert_int_equal(stratus_value_range_whole(ranges, &low, &high), STRATUS_OK);
  assert_true(low == 6e6 && high == values[1]); /* the float of 1e-4 errs by 4e-12, half an ULP at 6e6 is 5e-10 */
  stratus_value_range_destroy(ranges);
  v.values = integers;
  v.type = STRATUS_INT64;
  assert_int_equal(stratus_value_range_create(context, &v, 0, &ranges), STRATUS_OK);
  assert_int_equal(stratus_value_range_whole(ranges, &low, &high), STRATUS_OK);
  assert_true(low == 4e12 && high == 4e12 + 3);
  stratus_value_range_destroy(ranges);
  stratus_context_destroy(context);
}

static int cancel_at_once(void* user, const char* stage, double fraction)
{
  (void)stage;
  (void)fraction;
  return ++*(int*)user >= 2;
}

static void wrong_arguments_are_refused_and_cancelling_stops(void** state)
{
  static const int sizes[] = { -4, 1, 3, 6, 64, 33 };
  (void)state;
  float value = 1.0f;
  stratus_context* context = make_context("host", 1);
  stratus_value_range* ranges = NULL;
  stratus_volume v = stratus_volume_default();
  assert_int_equal(stratus_value_range_create(context, &v, 4, &ranges), STRATUS_INVALID_ARGUMENT);
  v.values = &value;
  for (size_t i = 0; i < sizeof sizes / sizeof *sizes; ++i) {
    assert_int_equal(stratus_value_range_create(context, &v, sizes[i], &ranges), STRATUS_INVALID_ARGUMENT);
    assert_non_null(strstr(stratus_context_message(context), "2, 4, 8, 16 or 32"));
  }
  assert_int_equal(stratus_value_range_create(context, NULL, 4, &ranges), STRATUS_INVALID_ARGUMENT);
  assert_int_equal(stratus_value_range_create(context, &v, 4, NULL), STRATUS_INVALID_ARGUMENT);
  assert_int_equal(stratus_value_range_create(NULL, &v, 4, &ranges), STRATUS_INVALID_ARGUMENT);
  assert_int_equal(stratus_value_range_whole(NULL, NULL, NULL), STRATUS_INVALID_ARGUMENT);
  stratus_value_range_destroy(NULL);
  stratus_context_destroy(context);

  int calls = 0;
  stratus_context_options options = stratus_context_options_default();
  options.device = "host";
  options.progress = cancel_at_once;
  options.progress_user = &calls;
  assert_int_equal(stratus_context_create(&options, &context, NULL, 0), STRATUS_OK);
  assert_int_equal(stratus_value_range_create(context, &v, 4, &ranges), STRATUS_CANCELLED);
  assert_null(ranges);
  stratus_context_destroy(context);
}

int test_value_range(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(every_type_and_block_size_equals_brute_force),
    cmocka_unit_test(values_that_are_not_finite_are_skipped_and_flagged),
    cmocka_unit_test(a_volume_without_a_finite_value_has_no_range),
    cmocka_unit_test(hidden_points_and_cells_are_flagged),
    cmocka_unit_test(an_offset_costs_a_wide_type_no_digits),
    cmocka_unit_test(wrong_arguments_are_refused_and_cancelling_stops),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
