/* SPDX-License-Identifier: BSD-3-Clause
 * Occupancy: no empty block shows anything, and no block is occupied without a reason. */
#include "structures.h"

static const double white[4] = { 0, 1, 1, 1 };

static stratus_transfer transfer_of(const double* opacity, size_t count)
{
  stratus_transfer t = stratus_transfer_default();
  t.opacity = opacity;
  t.opacity_count = count;
  t.color = white;
  t.color_count = 1;
  return t;
}

/* Random ranges like a volume's, in 0..1, some without any value. */
static void random_ranges(stratus_context* context, const int64_t n[3], stratus_value_range* r, uint32_t* random)
{
  const int64_t count = n[0] * n[1] * n[2];
  *r = (stratus_value_range){ .context = context, .blocks = { n[0], n[1], n[2] }, .block_size = 4, .whole_lo = 0, .whole_hi = 1 };
  r->lo = malloc((size_t)count * sizeof(float));
  r->hi = malloc((size_t)count * sizeof(float));
  r->gaps = malloc((size_t)count);
  assert_non_null(r->lo);
  assert_non_null(r->hi);
  assert_non_null(r->gaps);
  for (int64_t b = 0; b < count; ++b) {
    const float x = (float)random_below(random, 1001) / 1000.0f, y = x + (float)random_below(random, 50) / 1000.0f;
    const int none = random_below(random, 20) == 0;
    r->lo[b] = none ? INFINITY : x;
    r->hi[b] = none ? -INFINITY : fminf(y, 1.0f);
    r->gaps[b] = none || random_below(random, 20) == 0;
  }
}

static void free_ranges(stratus_value_range* r)
{
  free(r->lo);
  free(r->hi);
  free(r->gaps);
}

/* Ends half of the ranges within a few ULP of the first float that shows. */
static void approach_threshold(const stratus_shown* shown, stratus_value_range* r, uint32_t* random)
{
  for (int64_t b = 0; b < r->blocks[0] * r->blocks[1] * r->blocks[2]; ++b) {
    if (random_below(random, 2)) {
      r->lo[b] = 0.0f;
      r->hi[b] = fmaxf(shown->of[0][0] + (float)(random_below(random, 9) - 4) * 0x1p-25f, 0.0f);
    }
  }
}

/* Returns whether the opacity is above 0 in lo..hi: at its ends, at a point between them, or just below a point. */
static bool function_shows(const stratus_transfer* t, double lo, double hi)
{
  const double(*point)[2] = (const double(*)[2])t->opacity;
  const size_t last = t->opacity_count - 1;
  double ends[2] = { lo, hi }, rgba[4];
  for (int e = 0; lo <= hi && e < 2; ++e) {
    stratus_transfer_at(t, ends[e], rgba);
    if (rgba[3] > 0.0) {
      return true;
    }
  }
  for (size_t i = 0; lo <= hi && i <= last; ++i) {
    const bool first_of = i == 0 || point[i - 1][0] < point[i][0], last_of = i == last || point[i + 1][0] > point[i][0];
    const bool below = point[i][0] > lo && point[i][0] <= hi && (i > 0 || t->clamp); /* some value below the point is in the interval */
    if (point[i][1] > 0.0 && ((first_of && below) || (last_of && point[i][0] >= lo && point[i][0] <= hi))) {
      return true;
    }
  }
  return false;
}

static void check_build(stratus_context* context, const stratus_value_range* r, const stratus_transfer* transfer, bool gaps)
{
  stratus_occupancy* o = NULL;
  int64_t blocks[3], lo[3], hi[3], count = 0, low[3] = { 0, 0, 0 }, high[3] = { 0, 0, 0 };
  int size;
  const bool any = function_shows(transfer, (double)r->whole_lo, (double)r->whole_hi);
  assert_int_equal(
    stratus_occupancy_create(context, r, transfer, gaps ? STRATUS_SAMPLING_PREINTEGRATED : STRATUS_SAMPLING_MIDPOINT, &o), STRATUS_OK);
  stratus_occupancy_blocks(o, blocks, &size);
  assert_memory_equal(blocks, r->blocks, sizeof blocks);
  assert_int_equal(size, r->block_size);
  for (int64_t b = 0; b < blocks[0] * blocks[1] * blocks[2]; ++b) {
    const int64_t at[3] = { b % blocks[0], b / blocks[0] % blocks[1], b / blocks[0] / blocks[1] };
    const int expected = (gaps && any && r->gaps[b]) || function_shows(transfer, (double)r->lo[b], (double)r->hi[b]);
    assert_int_equal(o->occupied[b], expected);
    assert_int_equal(stratus_occupancy_get(o, at[0], at[1], at[2]), expected);
    for (int a = 0; expected && a < 3; ++a) {
      low[a] = count == 0 || at[a] < low[a] ? at[a] : low[a];
      high[a] = at[a] >= high[a] ? at[a] + 1 : high[a];
    }
    count += expected;
  }
  stratus_occupancy_bounds(o, lo, hi);
  assert_int_equal(stratus_occupancy_count(o), count);
  assert_memory_equal(lo, low, sizeof lo);
  assert_memory_equal(hi, high, sizeof hi);
  stratus_occupancy_destroy(o);
}

static void blocks_are_occupied_exactly_where_the_function_shows(void** state)
{
  static const double opacities[][8] = { { 0, 0, 0.5, 0, 0.8, 0.4, 1, 1 }, { 0, 0.5, 0.3, 0, 0.7, 0, 1, 0 },
    { 0, 0, 0.41, 0, 0.42, 0.9, 0.43, 0 }, { 0, 0, 0.2, 0, 0.4, 0, 1, 0 }, { 0, 1, 0.2, 1, 0.4, 1, 1, 1 } };
  static const int64_t sizes[][3] = { { 1, 1, 1 }, { 7, 3, 2 }, { 300, 2, 3 }, { 256, 1, 2 }, { 3, 257, 1 } };
  uint32_t random = 1;
  (void)state;
  for (int threads = 1; threads <= 3; ++threads) {
    stratus_context* context = make_context("host", threads);
    for (size_t f = 0; f < sizeof opacities / sizeof *opacities; ++f) {
      const stratus_transfer transfer = transfer_of(opacities[f], 4);
      const stratus_fetching fetching = { 0 };
      stratus_shown shown;
      assert_int_equal(stratus_shown_of_transfer(context, &fetching, &transfer, &shown), STRATUS_OK);
      for (int gaps = 0; gaps < 2; ++gaps) {
        for (size_t s = 0; s < sizeof sizes / sizeof *sizes; ++s) {
          stratus_value_range r;
          random_ranges(context, sizes[s], &r, &random);
          if (shown.count > 0) {
            approach_threshold(&shown, &r, &random);
          }
          check_build(context, &r, &transfer, gaps);
          free_ranges(&r);
        }
      }
      stratus_release(context, shown.of);
    }
    stratus_context_destroy(context);
  }
}

/* All values are 0 or 1: no voxel is within the peak, but every cell between a 0 and a 1 contains it. */
static void a_peak_between_two_voxel_values_is_occupied(void** state)
{
  static const double peak[] = { 0.0, 0.0, 0.40, 0.0, 0.41, 0.9, 0.42, 0.0, 1.0, 0.0 };
  (void)state;
  stratus_context* context = make_context("host", 2);
  const stratus_transfer transfer = transfer_of(peak, 5);
  float values[9 * 9 * 9];
  stratus_volume v = stratus_volume_default();
  v.values = values;
  v.dimensions[0] = v.dimensions[1] = v.dimensions[2] = 9;
  for (int plane = 0; plane < 9; ++plane) { /* where along x the ones begin */
    for (int i = 0; i < 729; ++i) {
      values[i] = i % 9 >= plane ? 1.0f : 0.0f;
    }
    for (int size = 2; size <= 4; size *= 2) {
      for (int sampling = STRATUS_SAMPLING_AUTO; sampling <= STRATUS_SAMPLING_CELLS; ++sampling) {
        stratus_value_range* r = NULL;
        stratus_occupancy* o = NULL;
        int64_t n[3];
        assert_int_equal(stratus_value_range_create(context, &v, size, &r), STRATUS_OK);
        assert_int_equal(stratus_occupancy_create(context, r, &transfer, (stratus_sampling)sampling, &o), STRATUS_OK);
        stratus_occupancy_blocks(o, n, NULL);
        for (int64_t i = 0; i < n[0]; ++i) {
          /* The cell that rises from 0 to 1 is plane-1, and only the block that owns it holds both values. */
          assert_int_equal(stratus_occupancy_get(o, i, 0, 0), plane > 0 && (plane - 1) / size == i);
        }
        stratus_occupancy_destroy(o);
        stratus_value_range_destroy(r);
      }
    }
  }
  stratus_context_destroy(context);
}

static void a_volume_without_values_is_empty(void** state)
{
  static const double all[] = { 0.0, 1.0 };
  (void)state;
  stratus_context* context = make_context("host", 1);
  const stratus_transfer transfer = transfer_of(all, 1);
  const float values[2] = { NAN, NAN };
  stratus_volume v = stratus_volume_default();
  stratus_value_range* r = NULL;
  stratus_occupancy* o = NULL;
  v.values = values;
  v.dimensions[0] = 2;
  assert_int_equal(stratus_value_range_create(context, &v, 4, &r), STRATUS_OK);
  assert_int_equal(stratus_occupancy_create(context, r, &transfer, STRATUS_SAMPLING_MIDPOINT, &o), STRATUS_OK);
  assert_int_equal(stratus_occupancy_count(o), 0);
  stratus_occupancy_destroy(o);
  stratus_value_range_destroy(r);
  stratus_context_destroy(context);
}

static void wrong_arguments_are_refused_with_a_reason(void** state)
{
  static const double reversed[] = { 1.0, 0.5, 0.0, 0.5 }, fine[] = { 0.0, 0.5 };
  uint32_t random = 2;
  (void)state;
  stratus_context* context = make_context("host", 1);
  stratus_transfer transfer = transfer_of(fine, 1), bad = transfer_of(reversed, 2), none = transfer_of(fine, 0);
  stratus_value_range r;
  stratus_occupancy* o = NULL;
  random_ranges(context, (const int64_t[]){ 2, 2, 2 }, &r, &random);
  assert_int_equal(stratus_occupancy_create(NULL, &r, &transfer, STRATUS_SAMPLING_AUTO, &o), STRATUS_INVALID_ARGUMENT);
  assert_int_equal(stratus_occupancy_create(context, NULL, &transfer, STRATUS_SAMPLING_AUTO, &o), STRATUS_INVALID_ARGUMENT);
  assert_int_equal(stratus_occupancy_create(context, &r, NULL, STRATUS_SAMPLING_AUTO, &o), STRATUS_INVALID_ARGUMENT);
  assert_int_equal(stratus_occupancy_create(context, &r, &bad, STRATUS_SAMPLING_AUTO, &o), STRATUS_INVALID_ARGUMENT);
  assert_int_equal(stratus_occupancy_create(context, &r, &none, STRATUS_SAMPLING_AUTO, &o), STRATUS_INVALID_ARGUMENT);
  assert_int_equal(stratus_occupancy_create(context, &r, &transfer, STRATUS_SAMPLING_AUTO, NULL), STRATUS_INVALID_ARGUMENT);
  assert_int_equal(stratus_occupancy_create(context, &r, &transfer, (stratus_sampling)4, &o), STRATUS_INVALID_ARGUMENT);
  assert_non_null(strstr(stratus_context_message(context), "sampling 4"));
  assert_null(o);
  stratus_occupancy_destroy(NULL);
  free_ranges(&r);
  stratus_context_destroy(context);
}

static long double exact_value(const stratus_volume* v, int64_t at)
{
  at *= v->value_stride;
  switch (v->type) {
    case STRATUS_INT8:
      return ((const int8_t*)v->values)[at];
    case STRATUS_UINT8:
      return ((const uint8_t*)v->values)[at];
    case STRATUS_INT16:
      return ((const int16_t*)v->values)[at];
    case STRATUS_UINT16:
      return ((const uint16_t*)v->values)[at];
    case STRATUS_INT32:
      return ((const int32_t*)v->values)[at];
    case STRATUS_UINT32:
      return ((const uint32_t*)v->values)[at];
    case STRATUS_INT64:
      return (long double)((const int64_t*)v->values)[at];
    case STRATUS_UINT64:
      return (long double)((const uint64_t*)v->values)[at];
    case STRATUS_FLOAT32:
      return (long double)((const float*)v->values)[at];
    case STRATUS_FLOAT64:
      return (long double)((const double*)v->values)[at];
  }
  return 0;
}

/* Finds the exact least and greatest of those values in block `at` whose fetched values are finite; returns false if there is none. */
static bool exact_range(const stratus_volume* v, int size, double bias, const int64_t at[3], long double range[2])
{
  const int64_t* n = v->dimensions;
  range[0] = (long double)INFINITY;
  range[1] = -(long double)INFINITY;
  for (int64_t k = at[2] * size; k <= (at[2] + 1) * size && k < n[2]; ++k) {
    for (int64_t j = at[1] * size; j <= (at[1] + 1) * size && j < n[1]; ++j) {
      for (int64_t i = at[0] * size; i <= (at[0] + 1) * size && i < n[0]; ++i) {
        const int64_t voxel = (k * n[1] + j) * n[0] + i;
        const long double value = exact_value(v, voxel);
        if (isfinite(stratus_volume_fetch(v, bias, (size_t)voxel))) {
          range[0] = value < range[0] ? value : range[0];
          range[1] = value > range[1] ? value : range[1];
        }
      }
    }
  }
  return range[0] <= range[1];
}

/* Returns whether the value and an end are fetched as one float, so that the value may be on either side. */
static bool is_fetched_as(const stratus_volume* v, double bias, long double value, double end)
{
  return stratus_type_is_wide(v->type) && (float)((double)value - bias) == (float)(end - bias);
}

/* Checks occupancy between two values; returns the number of blocks that only the rounding of wide types made occupied. */
static int64_t check_between(stratus_context* context, const stratus_volume* v, const stratus_value_range* r, double lower, double upper)
{
  stratus_occupancy* o = NULL;
  int64_t count = 0, rounded = 0;
  assert_int_equal(stratus_occupancy_create_between(context, r, lower, upper, &o), STRATUS_OK);
  for (int64_t b = 0; b < r->blocks[0] * r->blocks[1] * r->blocks[2]; ++b) {
    const int64_t at[3] = { b % r->blocks[0], b / r->blocks[0] % r->blocks[1], b / r->blocks[0] / r->blocks[1] };
    long double range[2];
    const bool any = exact_range(v, r->block_size, r->bias, at, range);
    const bool expected = any && range[0] <= (long double)upper && range[1] >= (long double)lower;
    const bool occupied = stratus_occupancy_get(o, at[0], at[1], at[2]);
    if (expected != occupied) {
      if (expected || !(is_fetched_as(v, r->bias, range[0], upper) || is_fetched_as(v, r->bias, range[1], lower))) {
        fail_msg("type %d, block %d of values %.20Lg..%.20Lg, interval %.17g..%.17g: occupied is %d", (int)v->type, (int)b, range[0],
          range[1], lower, upper, (int)occupied);
      }
      ++rounded;
    }
    count += occupied;
  }
  assert_int_equal(stratus_occupancy_count(o), count);
  stratus_occupancy_destroy(o);
  return rounded;
}

static void no_label_of_any_type_is_missed_or_taken_for_another(void** state)
{
  enum { LABELS = 11 };
  uint32_t random = 5;
  (void)state;
  stratus_context* context = make_context("host", 3);
  for (int type = STRATUS_INT8; type <= STRATUS_FLOAT64; ++type) {
    for (int size = 2; size <= 8; size *= 2) {
      sample_volume v = make_volume((stratus_type)type, 17, 9, 12, 1 + type % 2, &random);
      const int64_t count = 17 * 9 * 12;
      const size_t bytes = stratus_type_size((stratus_type)type);
      for (int64_t i = 0; i < count; ++i) { /* one label a block's width, so that blocks of one label are many */
        const int label = (int)((i % 17 / size + i / 17 % 9 / size * 3 + i / 17 / 9 / size * 5) % LABELS);
        const double number = label;
        const float single = (float)label;
        void* to = (char*)v.values + (size_t)(i * v.view.value_stride) * bytes;
        const int64_t whole = label; /* little-endian, as all that this is tested on */
        memcpy(to,
          type == STRATUS_FLOAT64     ? (const void*)&number
            : type == STRATUS_FLOAT32 ? (const void*)&single
                                      : (const void*)&whole,
          bytes);
      }
      stratus_value_range* r = NULL;
      assert_int_equal(stratus_value_range_create(context, &v.view, size, &r), STRATUS_OK);
      for (int k = -1; k <= LABELS; ++k) {
        stratus_occupancy* o = NULL;
        const double ends[][2] = { { k, k }, { k - 0.25, k + 0.25 }, { k + 0.25, k + 0.75 }, { k, INFINITY }, { -INFINITY, k },
          { nextafter(k, INFINITY), k + 0.5 }, { k - 0.5, nextafter(k, -INFINITY) } };
        for (size_t e = 0; e < sizeof ends / sizeof *ends; ++e) {
          const int64_t rounded = check_between(context, &v.view, r, ends[e][0], ends[e][1]);
          assert_true(e >= 5 || rounded == 0);
        }
        assert_int_equal(stratus_occupancy_create_between(context, r, k, k, &o), STRATUS_OK);
        assert_int_equal(stratus_occupancy_count(o) > 0, k >= 0 && k < LABELS);
        stratus_occupancy_destroy(o);
      }
      stratus_value_range_destroy(r);
      free_volume(&v);
    }
  }
  stratus_context_destroy(context);
}

static void blocks_are_between_the_ends_exactly_where_their_values_are(void** state)
{
  uint32_t random = 6;
  int64_t rounded = 0;
  (void)state;
  stratus_context* context = make_context("host", 2);
  for (int repeat = 0; repeat < 200; ++repeat) {
    const stratus_type type = (stratus_type)(repeat % 10);
    sample_volume v = make_volume(type, 1 + random_below(&random, 12), 1 + random_below(&random, 9), 1 + random_below(&random, 9),
      1 + random_below(&random, 2), &random);
    const int64_t* n = v.view.dimensions;
    spoil(&v, 1 + random_below(&random, 60), &random);
    stratus_value_range* r = NULL;
    assert_int_equal(stratus_value_range_create(context, &v.view, 1 << (1 + repeat / 10 % 3), &r), STRATUS_OK);
    for (int interval = 0; interval < 40; ++interval) {
      double ends[2];
      for (int e = 0; e < 2; ++e) { /* values of the volume, and the doubles about them */
        const double value = (double)exact_value(&v.view, random_below(&random, n[0] * n[1] * n[2]));
        const int64_t way = random_below(&random, 6);
        ends[e] = isnan(value) || way == 0 ? (e ? (double)INFINITY : -(double)INFINITY)
          : way == 1                       ? nextafter(value, INFINITY)
          : way == 2                       ? nextafter(value, -INFINITY)
                                           : value;
      }
      const bool rises = ends[0] <= ends[1];
      rounded += check_between(context, &v.view, r, rises ? ends[0] : ends[1], rises ? ends[1] : ends[0]);
    }
    check_between(context, &v.view, r, INFINITY, INFINITY);
    check_between(context, &v.view, r, -INFINITY, -INFINITY);
    check_between(context, &v.view, r, -INFINITY, INFINITY);
    stratus_value_range_destroy(r);
    free_volume(&v);
  }
  print_message("             %d blocks occupied for their floats' sake\n", (int)rounded);
  stratus_context_destroy(context);
}

static void reversed_and_unknown_ends_are_refused(void** state)
{
  static const double ends[][2] = { { 1, 0.5 }, { NAN, 1 }, { 0, NAN }, { NAN, NAN }, { INFINITY, -INFINITY } };
  uint32_t random = 3;
  (void)state;
  stratus_context* context = make_context("host", 1);
  stratus_value_range r;
  stratus_occupancy* o = NULL;
  random_ranges(context, (const int64_t[]){ 2, 2, 2 }, &r, &random);
  for (size_t i = 0; i < sizeof ends / sizeof *ends; ++i) {
    assert_int_equal(stratus_occupancy_create_between(context, &r, ends[i][0], ends[i][1], &o), STRATUS_INVALID_ARGUMENT);
    assert_non_null(strstr(stratus_context_message(context), isnan(ends[i][0]) || isnan(ends[i][1]) ? "nan" : "lower end"));
  }
  assert_null(o);
  free_ranges(&r);
  stratus_context_destroy(context);
}

int test_occupancy(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(blocks_are_occupied_exactly_where_the_function_shows),
    cmocka_unit_test(a_peak_between_two_voxel_values_is_occupied),
    cmocka_unit_test(a_volume_without_values_is_empty),
    cmocka_unit_test(wrong_arguments_are_refused_with_a_reason),
    cmocka_unit_test(no_label_of_any_type_is_missed_or_taken_for_another),
    cmocka_unit_test(blocks_are_between_the_ends_exactly_where_their_values_are),
    cmocka_unit_test(reversed_and_unknown_ends_are_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
