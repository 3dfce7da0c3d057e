/* SPDX-License-Identifier: BSD-3-Clause
 * Bricks of one value, as their source says: they are not read, and value ranges and coarse copies are those of all values.
 */
#include "bricks_testing.h"
#include "look_sample.h"

/* A source of which about two in three bricks are one value; of some of these it does not say so. */
typedef struct sparse {
  stratus_type type;
  int64_t dimensions[3], brick, before[3], across[3];
  float* only;
  int calls, useless; /* the latter: for bricks of which it was known */
} sparse;

static uint32_t mix(int64_t at)
{
  uint32_t x = (uint32_t)at * 2654435761u + 12345u;
  x ^= x >> 13;
  return x * 2246822519u >> 8;
}

static int64_t brick_at(const sparse* s, int64_t x, int64_t y, int64_t z)
{
  const int64_t at[3] = { x, y, z };
  int64_t number = 0;
  for (int a = 2; a >= 0; --a) {
    number = number * s->across[a] + (s->before[a] + at[a]) / s->brick;
  }
  return number;
}

static bool is_one(int64_t brick)
{
  return mix(brick) % 3 != 0;
}

static float one_of(int64_t brick)
{
  return (float)(mix(brick) % 2 * 7);
}

static float value_at(const sparse* s, int64_t x, int64_t y, int64_t z)
{
  const int64_t brick = brick_at(s, x, y, z);
  return is_one(brick) ? one_of(brick) : (float)(mix((z * 1000 + y) * 1000 + x) % 101);
}

static void put(stratus_type type, void* values, int64_t to, float value)
{
  stratus_type_fill(type, value, (char*)values + to * (int64_t)stratus_type_size(type), 1);
}

static int read_sparse(void* user, const int64_t lo[3], const int64_t size[3], void* values)
{
  sparse* const s = user;
  int64_t to = 0;
#pragma omp atomic
  ++s->calls;
  if (!isnan(s->only[brick_at(s, lo[0], lo[1], lo[2])])) {
#pragma omp atomic
    ++s->useless;
  }
  for (int64_t z = lo[2]; z < lo[2] + size[2]; ++z) {
    for (int64_t y = lo[1]; y < lo[1] + size[1]; ++y) {
      for (int64_t x = lo[0]; x < lo[0] + size[0]; ++x) {
        put(s->type, values, to++, value_at(s, x, y, z));
      }
    }
  }
  return 0;
}

static stratus_brick_source make_source(sparse* s)
{
  stratus_brick_source source = { .type = s->type, .read = read_sparse, .user = s };
  for (int a = 0; a < 3; ++a) {
    source.dimensions[a] = s->dimensions[a];
    source.brick[a] = s->brick;
    source.before[a] = s->before[a];
    s->across[a] = (s->before[a] + s->dimensions[a] + s->brick - 1) / s->brick;
  }
  const int64_t count = s->across[0] * s->across[1] * s->across[2];
  s->only = malloc((size_t)count * sizeof *s->only);
  assert_non_null(s->only);
  for (int64_t b = 0; b < count; ++b) {
    s->only[b] = is_one(b) && mix(b) % 5 != 0 ? one_of(b) : NAN;
  }
  source.only = s->only;
  return source;
}

static void* all_values(const sparse* s)
{
  const int64_t* n = s->dimensions;
  void* const values = malloc((size_t)(n[0] * n[1] * n[2]) * stratus_type_size(s->type));
  assert_non_null(values);
#pragma omp parallel for num_threads(2)
  for (int64_t z = 0; z < n[2]; ++z) {
    for (int64_t i = 0; i < n[0] * n[1]; ++i) {
      put(s->type, values, z * n[0] * n[1] + i, value_at(s, i % n[0], i / n[0], z));
    }
  }
  return values;
}

static void bricks_of_one_value_are_as_if_read(void** state)
{
  (void)state;
  sparse all[] = {
    { .type = STRATUS_FLOAT32, .dimensions = { 150, 131, 97 }, .brick = 32, .before = { 0, 31, 7 } },
    { .type = STRATUS_UINT8, .dimensions = { 201, 130, 67 }, .brick = 16, .before = { 5, 0, 15 } }, /* tiles of several bricks */
    { .type = STRATUS_INT16, .dimensions = { 33, 32, 1 }, .brick = 32 },
    { .type = STRATUS_FLOAT32, .dimensions = { 90, 70, 66 }, .brick = 8 },
    { .type = STRATUS_UINT8, .dimensions = { 512, 512, 260 }, .brick = 64, .before = { 3, 0, 63 } }, /* large enough for a coarse copy */
  };
  for (size_t i = 0; i < sizeof all / sizeof *all; ++i) {
    sparse* const s = &all[i];
    stratus_brick_pool* const pool = make_pool(0);
    stratus_bricks* bricks = NULL;
    const stratus_brick_source source = make_source(s);
    assert_int_equal(stratus_bricks_create(host, pool, &source, &bricks), STRATUS_OK);
    if (stratus_bricks_tiles(bricks)) { /* there are pages that stop their readers */
      void* const values = all_values(s);
      stratus_volume plain = stratus_volume_default();
      plain.type = s->type;
      memcpy(plain.dimensions, s->dimensions, sizeof plain.dimensions);
      stratus_volume known = plain;
      plain.values = values;
      known.values = stratus_bricks_values(bricks);
      known.tiles = *stratus_bricks_tiles(bricks);
      known.parts = stratus_bricks_parts(bricks);
      assert_non_null(known.parts);
      for (int size = 2; size <= 32; size *= 4) {
        expect_same_ranges(&plain, &known, size);
      }
      if (stratus_look_samples(&plain)) {
        stratus_look_sample samples[2] = { { .memory = NULL }, { .memory = NULL } };
        assert_int_equal(stratus_look_sample_make(host, &plain, &samples[0]), STRATUS_OK);
        assert_int_equal(stratus_look_sample_make(host, &known, &samples[1]), STRATUS_OK);
        assert_memory_equal(samples[0].memory, samples[1].memory, stratus_volume_count(&samples[0].view));
        stratus_release(host, samples[0].memory);
        stratus_release(host, samples[1].memory);
      }
      assert_int_equal(s->useless, 0);
      assert_memory_equal(known.values, values, stratus_volume_count(&plain) * stratus_type_size(s->type));
      free(values);
    }
    stratus_bricks_destroy(bricks);
    stratus_brick_pool_destroy(pool);
    free(s->only);
  }
}

static void kinds_of_values_without_constants_are_refused(void** state)
{
  (void)state;
  sparse s = { .type = STRATUS_FLOAT64, .dimensions = { 8, 8, 8 }, .brick = 8 };
  stratus_brick_pool* const pool = make_pool(0);
  stratus_bricks* bricks = NULL;
  stratus_brick_source source = make_source(&s);
  assert_int_equal(stratus_bricks_create(host, pool, &source, &bricks), STRATUS_INVALID_ARGUMENT);
  assert_non_null(strstr(stratus_context_message(host), "must have one of FLOAT32, or of 8 or 16 bits"));
  source.type = STRATUS_FLOAT32;
  source.components = 2;
  assert_int_equal(stratus_bricks_create(host, pool, &source, &bricks), STRATUS_INVALID_ARGUMENT);
  assert_null(bricks);
  stratus_brick_pool_destroy(pool);
  free(s.only);
}

int test_brick_constants(void)
{
  const struct CMUnitTest tests[] = { cmocka_unit_test(bricks_of_one_value_are_as_if_read),
    cmocka_unit_test(kinds_of_values_without_constants_are_refused) };
  return cmocka_run_group_tests(tests, begin, end);
}
