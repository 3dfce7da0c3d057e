/* SPDX-License-Identifier: BSD-3-Clause
 * Occupancy: never an empty block that shows something, and no block occupied without a reason. */
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

/* Ranges as a volume's would be, over 0..1, some without any value. */
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
  for (int64_t b = 0; b < count; b++) {
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

/* Lets half of the blocks end within some ULP of the first value that the table shows, where the hull's slack decides. */
static void approach_threshold(const stratus_table* table, stratus_value_range* r, uint32_t* random)
{
  const float threshold = ((float)table->next_shown[0] - table->offset) / table->scale;
  for (int64_t b = 0; b < r->blocks[0] * r->blocks[1] * r->blocks[2]; b++) {
    if (random_below(random, 2)) {
      r->lo[b] = 0.0f;
      r->hi[b] = threshold * (1.0f + (float)(random_below(random, 41) - 20) * 1.5e-7f);
    }
  }
}

static void check_build(stratus_context* context, const stratus_value_range* r, const stratus_table* table)
{
  stratus_occupancy* o = NULL;
  int64_t blocks[3], lo[3], hi[3], count = 0, low[3] = { 0, 0, 0 }, high[3] = { 0, 0, 0 };
  int size;
  assert_int_equal(stratus_occupancy_build(context, r, table, &o), STRATUS_OK);
  stratus_occupancy_blocks(o, blocks, &size);
  assert_memory_equal(blocks, r->blocks, sizeof blocks);
  assert_int_equal(size, r->block_size);
  for (int64_t b = 0; b < blocks[0] * blocks[1] * blocks[2]; b++) {
    const int64_t at[3] = { b % blocks[0], b / blocks[0] % blocks[1], b / blocks[0] / blocks[1] };
    const int gap = table->sums && table->shown && r->gaps[b];
    const int expected = gap || (r->lo[b] <= r->hi[b] && stratus_table_shows(table, r->lo[b], r->hi[b]));
    assert_int_equal(o->occupied[b], expected);
    assert_int_equal(stratus_occupancy_get(o, at[0], at[1], at[2]), expected);
    for (int a = 0; expected && a < 3; a++) {
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

static void blocks_are_occupied_exactly_where_the_table_shows(void** state)
{
  static const double opacities[][8] = { { 0, 0, 0.5, 0, 0.8, 0.4, 1, 1 }, { 0, 0.5, 0.3, 0, 0.7, 0, 1, 0 },
    { 0, 0, 0.41, 0, 0.42, 0.9, 0.43, 0 }, { 0, 0, 0.2, 0, 0.4, 0, 1, 0 }, { 0, 1, 0.2, 1, 0.4, 1, 1, 1 } };
  static const int64_t sizes[][3] = { { 1, 1, 1 }, { 7, 3, 2 }, { 300, 2, 3 }, { 256, 1, 2 }, { 3, 257, 1 } };
  uint32_t random = 1;
  (void)state;
  for (int threads = 1; threads <= 3; threads++) {
    stratus_context* context = make_context("host", threads);
    for (size_t f = 0; f < sizeof opacities / sizeof *opacities; f++) {
      const stratus_transfer transfer = transfer_of(opacities[f], 4);
      for (int sampling = STRATUS_SAMPLING_MIDPOINT; sampling <= STRATUS_SAMPLING_PREINTEGRATED; sampling++) {
        stratus_table* table = NULL;
        assert_int_equal(stratus_table_create(context, &transfer, 0.0, 0.0f, 1.0f, (stratus_sampling)sampling, 1.0, &table), STRATUS_OK);
        for (size_t s = 0; s < sizeof sizes / sizeof *sizes; s++) {
          stratus_value_range r;
          random_ranges(context, sizes[s], &r, &random);
          if (table->shown) {
            approach_threshold(table, &r, &random);
          }
          check_build(context, &r, table);
          free_ranges(&r);
        }
        stratus_table_destroy(table);
      }
    }
    stratus_context_destroy(context);
  }
}

/* Values of 0 and 1 alone: no voxel is within the peak, every cell between a 0 and a 1 is. */
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
  for (int plane = 0; plane < 9; plane++) { /* where along x the ones begin */
    for (int i = 0; i < 729; i++) {
      values[i] = i % 9 >= plane ? 1.0f : 0.0f;
    }
    for (int size = 2; size <= 4; size *= 2) {
      for (int sampling = STRATUS_SAMPLING_AUTO; sampling <= STRATUS_SAMPLING_PREINTEGRATED; sampling++) {
        stratus_value_range* r = NULL;
        stratus_occupancy* o = NULL;
        int64_t n[3];
        assert_int_equal(stratus_value_range_create(context, &v, size, &r), STRATUS_OK);
        assert_int_equal(stratus_occupancy_create(context, r, &transfer, (stratus_sampling)sampling, &o), STRATUS_OK);
        stratus_occupancy_blocks(o, n, NULL);
        for (int64_t i = 0; i < n[0]; i++) {
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
  assert_int_equal(stratus_occupancy_create(context, &r, &transfer, (stratus_sampling)3, &o), STRATUS_INVALID_ARGUMENT);
  assert_non_null(strstr(stratus_context_message(context), "sampling 3"));
  assert_null(o);
  stratus_occupancy_destroy(NULL);
  free_ranges(&r);
  stratus_context_destroy(context);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(blocks_are_occupied_exactly_where_the_table_shows),
    cmocka_unit_test(a_peak_between_two_voxel_values_is_occupied),
    cmocka_unit_test(a_volume_without_values_is_empty),
    cmocka_unit_test(wrong_arguments_are_refused_with_a_reason),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
