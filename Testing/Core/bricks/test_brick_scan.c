/* SPDX-License-Identifier: BSD-3-Clause
 * Value ranges and coarse copies that are made part after part are those of the values in memory, and each value is read once. */
#include "bricks_testing.h"
#include "look_sample.h"

/* A source of given values. */
typedef struct kept_values {
  stratus_type type;
  int64_t dimensions[3], brick[3], before[3];
  char* values;
  int64_t fails_at; /* a value that cannot be read, with its box; -1: none */
} kept_values;

static int read_values(void* user, const int64_t lo[3], const int64_t size[3], void* to)
{
  const kept_values* const k = user;
  const size_t value = stratus_type_size(k->type), row = (size_t)size[0] * value;
  int failed = 0;
  for (int64_t z = lo[2]; z < lo[2] + size[2]; ++z) {
    for (int64_t y = lo[1]; y < lo[1] + size[1]; ++y) {
      const int64_t at = (z * k->dimensions[1] + y) * k->dimensions[0] + lo[0];
      memcpy(to, k->values + (size_t)at * value, row);
      to = (char*)to + row;
      failed = failed || (at <= k->fails_at && k->fails_at < at + size[0]);
    }
  }
  return failed;
}

static void put(stratus_type type, void* values, int64_t at, int whole)
{
  switch (type) {
    case STRATUS_FLOAT32:
      ((float*)values)[at] = whole % 61 == 0 ? NAN : whole % 67 == 0 ? INFINITY : whole % 3 ? (float)(whole - 100) * 0.37f : -0.0f;
      break;
    case STRATUS_FLOAT64:
      ((double*)values)[at] = whole % 61 == 0 ? (double)NAN : whole % 67 == 0 ? 1e300 : 1e9 + (double)whole * 0.37;
      break;
    case STRATUS_INT8:
    case STRATUS_UINT8:
      ((uint8_t*)values)[at] = (uint8_t)whole;
      break;
    case STRATUS_INT16:
    case STRATUS_UINT16:
      ((uint16_t*)values)[at] = (uint16_t)(whole * 257);
      break;
    case STRATUS_INT32:
    case STRATUS_UINT32:
      ((uint32_t*)values)[at] = (uint32_t)whole * 16843009u;
      break;
    default:
      ((int64_t*)values)[at] = (int64_t)whole * 100000007 - 12345678901;
      break;
  }
}

/* Values that vary between blocks, so that a block with a value too many or too few has another range. */
static void make_values(kept_values* k, uint32_t* random)
{
  const int64_t* n = k->dimensions;
  k->values = malloc((size_t)(n[0] * n[1] * n[2]) * stratus_type_size(k->type));
  k->fails_at = -1;
  assert_non_null(k->values);
  for (int64_t at = 0; at < n[0] * n[1] * n[2]; ++at) {
    const int place = (int)(at % n[0] / 5 + at / n[0] % n[1] / 3 * 7 + at / n[0] / n[1] / 4 * 13);
    put(k->type, k->values, at, place % 150 + (int)random_below(random, 100));
  }
}

static stratus_bricks* make_bricks(stratus_brick_pool* pool, kept_values* k)
{
  stratus_brick_source source = { .type = k->type, .read = read_values, .user = k };
  memcpy(source.dimensions, k->dimensions, sizeof source.dimensions);
  memcpy(source.brick, k->brick, sizeof source.brick);
  memcpy(source.before, k->before, sizeof source.before);
  stratus_bricks* bricks = NULL;
  assert_int_equal(stratus_bricks_create(host, pool, &source, &bricks), STRATUS_OK);
  return bricks;
}

static stratus_volume volume_of(const kept_values* k, stratus_bricks* bricks)
{
  stratus_volume v = stratus_volume_default();
  v.type = k->type;
  v.values = bricks ? stratus_bricks_values(bricks) : k->values;
  memcpy(v.dimensions, k->dimensions, sizeof v.dimensions);
  if (bricks) {
    v.parts = stratus_bricks_parts(bricks);
    v.missing = stratus_bricks_missing(bricks);
  }
  return v;
}

static void ranges_of_parts_are_those_of_values(void** state)
{
  (void)state;
  uint32_t random = 44;
  stratus_brick_pool* pool = make_pool(16 << 20);
  for (int repeat = 0; repeat < 120; ++repeat) {
    kept_values k = { .type = (stratus_type)(repeat % 10) };
    for (int a = 0; a < 3; ++a) {
      k.dimensions[a] = repeat % 7 == a ? 1 : 1 + (int64_t)random_below(&random, a == 0 ? 150 : 90);
      k.brick[a] = 1 + (int64_t)random_below(&random, 40);
      k.before[a] = (int64_t)random_below(&random, (uint32_t)k.brick[a]);
    }
    make_values(&k, &random);
    stratus_bricks* bricks = make_bricks(pool, &k);
    const stratus_volume plain = volume_of(&k, NULL);
    stratus_volume parts = volume_of(&k, bricks);
    if (parts.parts) {
      for (int size = 2; size <= 32; size *= 2) {
        expect_same_ranges(&plain, &parts, size);
      }
      parts.type = parts.type == STRATUS_UINT8 ? STRATUS_INT8 : parts.type == STRATUS_INT8 ? STRATUS_UINT8 : parts.type;
      assert_true((stratus_volume_parts(&parts) == NULL) == (parts.type != k.type)); /* other values */
    }
    stratus_bricks_destroy(bricks);
    free(k.values);
  }
  stratus_brick_pool_destroy(pool);
}

/* Of an array that fits in memory the parts stay there. One that does not leaves all memory to the tiles that rays read. */
static void each_value_is_read_once(void** state)
{
  (void)state;
  uint32_t random = 45;
  static const int64_t layers[2] = { 300, 420 }; /* 12 and 16.8 million values, in a pool of 16.8 million bytes */
  for (int large = 0; large < 2; ++large) {
    kept_values k = { .type = STRATUS_UINT8, .dimensions = { 200, 200, layers[large] }, .brick = { 33, 21, 18 }, .before = { 0, 20, 1 } };
    stratus_brick_pool* pool = make_pool(16 << 20);
    make_values(&k, &random);
    stratus_bricks* bricks = make_bricks(pool, &k);
    const stratus_volume plain = volume_of(&k, NULL), parts = volume_of(&k, bricks);
    const size_t all = stratus_volume_count(&plain);
    if (parts.parts) {
      stratus_bricks_report report;
      stratus_brick_pool_report of_pool;
      assert_true((stratus_bricks_tiles(bricks) != NULL) == large);
      expect_same_ranges(&plain, &parts, 4);
      stratus_bricks_get_report(bricks, &report);
      assert_int_equal(report.bytes_read, all);
      assert_int_equal(*stratus_bricks_reads(bricks), report.parts_read);
      stratus_brick_pool_get_report(pool, &of_pool);
      assert_true(large ? of_pool.resident == 0 : of_pool.resident >= all);
      assert_memory_equal(parts.values, k.values, all);
      stratus_bricks_get_report(bricks, &report);
      assert_true(large || report.bytes_read == all);
      expect_same_ranges(&plain, &parts, 8); /* of parts in memory */
    }
    stratus_bricks_destroy(bricks);
    stratus_brick_pool_destroy(pool);
    free(k.values);
  }
}

static void coarse_copies_of_parts_are_those_of_values(void** state)
{
  (void)state;
  uint32_t random = 46;
  kept_values k = { .type = STRATUS_UINT8, .dimensions = { 512, 500, 270 }, .brick = { 64, 40, 50 }, .before = { 3, 0, 49 } };
  stratus_brick_pool* pool = make_pool(16 << 20);
  make_values(&k, &random);
  stratus_bricks* bricks = make_bricks(pool, &k);
  const stratus_volume plain = volume_of(&k, NULL), parts = volume_of(&k, bricks);
  stratus_look_sample samples[2] = { { .memory = NULL }, { .memory = NULL } };
  assert_true(stratus_look_samples(&plain));
  assert_int_equal(stratus_look_sample_make(host, &plain, &samples[0]), STRATUS_OK);
  assert_int_equal(stratus_look_sample_make(host, &parts, &samples[1]), STRATUS_OK);
  assert_memory_equal(samples[0].memory, samples[1].memory, stratus_volume_count(&samples[0].view));
  stratus_release(host, samples[0].memory);
  stratus_release(host, samples[1].memory);
  stratus_bricks_destroy(bricks);
  stratus_brick_pool_destroy(pool);
  free(k.values);
}

static void values_that_parts_lack_are_an_error(void** state)
{
  (void)state;
  uint32_t random = 47;
  for (int large = 0; large < 2; ++large) {
    kept_values k = { .type = STRATUS_UINT8, .dimensions = { 200, 200, large ? 420 : 100 }, .brick = { 50, 50, 10 } };
    stratus_brick_pool* pool = make_pool(16 << 20);
    make_values(&k, &random);
    k.fails_at = 1000000;
    stratus_bricks* bricks = make_bricks(pool, &k);
    const stratus_volume parts = volume_of(&k, bricks);
    stratus_value_range* ranges = NULL;
    assert_int_equal(stratus_value_range_create(host, &parts, 4, &ranges), STRATUS_INVALID_ARGUMENT);
    assert_null(ranges);
    assert_int_equal(*stratus_bricks_missing(bricks), 50 * 50 * 10);
    stratus_bricks_destroy(bricks);
    stratus_brick_pool_destroy(pool);
    free(k.values);
  }
}

int test_brick_scan(void)
{
  const struct CMUnitTest tests[] = { cmocka_unit_test(ranges_of_parts_are_those_of_values), cmocka_unit_test(each_value_is_read_once),
    cmocka_unit_test(coarse_copies_of_parts_are_those_of_values), cmocka_unit_test(values_that_parts_lack_are_an_error) };
  return cmocka_run_group_tests(tests, begin, end);
}
