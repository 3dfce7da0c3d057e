/* SPDX-License-Identifier: BSD-3-Clause
 * Arrays of bricks against the values that their source has: whatever the shapes, the limit of memory and the threads that read, and
 * which parts are read, dropped and kept. */
#define _GNU_SOURCE /* MAP_ANONYMOUS */
#include "bricks_testing.h"
#include "remove_folder.h"

#include <omp.h>
#include <stdio.h>
#include <sys/mman.h>
#include <time.h>

/* A source of values that a formula gives. */
typedef struct formula {
  stratus_type type;
  int64_t dimensions[3], brick[3], before[3];
  int64_t fails_at; /* a brick that holds this value cannot be read; -1: none */
  int released, calls, misplaced;
} formula;

static uint32_t mix(int64_t at)
{
  uint32_t x = (uint32_t)at * 2654435761u + 12345u;
  x ^= x >> 13;
  return x * 2246822519u;
}

static void put(stratus_type type, void* values, int64_t to, int64_t at)
{
  switch (stratus_type_size(type)) {
    case 1:
      ((uint8_t*)values)[to] = (uint8_t)(mix(at) >> 9);
      break;
    case 2:
      ((uint16_t*)values)[to] = (uint16_t)(mix(at) >> 9);
      break;
    case 4:
      if (type == STRATUS_FLOAT32) {
        ((float*)values)[to] = (float)(mix(at) >> 8) * 0x1p-24f;
      } else {
        ((uint32_t*)values)[to] = mix(at);
      }
      break;
    default:
      ((double*)values)[to] = (double)mix(at) + 0.5;
      break;
  }
}

static int read_formula(void* user, const int64_t lo[3], const int64_t size[3], void* values)
{
  formula* const f = user;
  const int64_t* n = f->dimensions;
  int64_t to = 0;
  int failed = 0;
#pragma omp atomic
  ++f->calls;
  for (int a = 0; a < 3; ++a) {
    const int64_t end = lo[a] + size[a];
    const bool begins = lo[a] == 0 || (f->before[a] + lo[a]) % f->brick[a] == 0;
    if (!begins || end > n[a] || ((f->before[a] + end) % f->brick[a] != 0 && end != n[a])) {
#pragma omp atomic
      ++f->misplaced;
    }
  }
  for (int64_t k = lo[2]; k < lo[2] + size[2]; ++k) {
    for (int64_t j = lo[1]; j < lo[1] + size[1]; ++j) {
      for (int64_t i = lo[0]; i < lo[0] + size[0]; ++i) {
        const int64_t at = (k * n[1] + j) * n[0] + i;
        failed = failed || at == f->fails_at;
        put(f->type, values, to++, at);
      }
    }
  }
  return failed;
}

static void release_formula(void* user)
{
  ++((formula*)user)->released;
}

static formula make_formula(stratus_type type, int64_t nx, int64_t ny, int64_t nz, int64_t bx, int64_t by, int64_t bz)
{
  return (formula){ .type = type, .dimensions = { nx, ny, nz }, .brick = { bx, by, bz }, .fails_at = -1 };
}

/* The same without the first values along each axis, so that its first bricks are not whole. */
static formula without_first(formula f, int64_t x, int64_t y, int64_t z)
{
  const int64_t first[3] = { x, y, z };
  for (int a = 0; a < 3; ++a) {
    f.before[a] = first[a] % f.brick[a];
    f.dimensions[a] -= first[a];
  }
  return f;
}

static stratus_brick_source source_of(formula* f)
{
  stratus_brick_source source = { .type = f->type, .read = read_formula, .release = release_formula, .user = f };
  memcpy(source.dimensions, f->dimensions, sizeof source.dimensions);
  memcpy(source.brick, f->brick, sizeof source.brick);
  memcpy(source.before, f->before, sizeof source.before);
  return source;
}

static stratus_bricks* make_bricks(stratus_brick_pool* pool, formula* f)
{
  const stratus_brick_source source = source_of(f);
  stratus_bricks* bricks = NULL;
  assert_int_equal(stratus_bricks_create(host, pool, &source, &bricks), STRATUS_OK);
  assert_non_null(stratus_bricks_values(bricks));
  return bricks;
}

static int is_paged(stratus_brick_pool* pool)
{
  stratus_brick_pool_report report;
  stratus_brick_pool_get_report(pool, &report);
  if (!report.paged) {
    printf("SKIPPED: this system offers no pages that stop their readers\n");
  }
  return report.paged;
}

static stratus_bricks_report report_of(stratus_bricks* bricks)
{
  stratus_bricks_report report;
  stratus_bricks_get_report(bricks, &report);
  return report;
}

static int64_t count_of(const formula* f)
{
  return f->dimensions[0] * f->dimensions[1] * f->dimensions[2];
}

static int equals(const formula* f, const void* values, int64_t at)
{
  double expected;
  const size_t size = stratus_type_size(f->type);
  put(f->type, &expected, 0, at);
  return memcmp(&expected, (const char*)values + (size_t)at * size, size) == 0;
}

/* Reads values at random, by several threads; returns how many are wrong. */
static int64_t wrong_at_random(const formula* f, const void* values, int reads)
{
  const int64_t count = count_of(f);
  int64_t wrong = 0;
#pragma omp parallel for num_threads(4) reduction(+ : wrong)
  for (int i = 0; i < reads; ++i) {
    wrong += !equals(f, values, (int64_t)(((uint64_t)mix(i) << 16 ^ mix(i + reads)) % (uint64_t)count));
  }
  return wrong;
}

static int64_t wrong_in_order(const formula* f, const void* values)
{
  const int64_t count = count_of(f);
  int64_t wrong = 0;
#pragma omp parallel for num_threads(2) reduction(+ : wrong)
  for (int64_t i = 0; i < count; ++i) {
    wrong += !equals(f, values, i);
  }
  return wrong;
}

static void values_are_the_sources(void** state)
{
  (void)state;
  formula all[] = {
    make_formula(STRATUS_FLOAT32, 256, 128, 64, 64, 32, 16), /* parts end where pages do */
    make_formula(STRATUS_UINT8, 301, 257, 67, 50, 33, 9),    /* and where they don't */
    make_formula(STRATUS_INT16, 97, 1021, 31, 97, 100, 1),   /* whole rows */
    make_formula(STRATUS_FLOAT64, 130, 70, 90, 130, 70, 4),  /* whole layers */
    make_formula(STRATUS_UINT32, 3, 5, 20011, 2, 3, 7),      /* many rows to a page */
    make_formula(STRATUS_FLOAT32, 100003, 1, 1, 1000, 8, 8), /* a line */
    make_formula(STRATUS_INT8, 1, 1, 1, 9, 9, 9),            /* a value */
    make_formula(STRATUS_FLOAT32, 40000, 9, 9, 512, 2, 2),
    without_first(make_formula(STRATUS_FLOAT32, 256, 128, 64, 64, 32, 16), 1, 31, 20), /* parts that begin inside of a brick */
    without_first(make_formula(STRATUS_UINT8, 301, 257, 67, 50, 33, 9), 149, 1, 8),
    without_first(make_formula(STRATUS_INT16, 97, 1021, 31, 97, 100, 1), 3, 950, 7), /* inside of the last one along y */
    without_first(make_formula(STRATUS_FLOAT64, 130, 70, 90, 130, 70, 40), 50, 30, 39),
    without_first(make_formula(STRATUS_FLOAT32, 40, 40, 40, 64, 64, 64), 9, 9, 9), /* of a brick that is larger */
  };
  for (size_t i = 0; i < sizeof all / sizeof *all; ++i) {
    formula* const f = &all[i];
    stratus_brick_pool* pool = make_pool(0);
    stratus_bricks* bricks = make_bricks(pool, f);
    assert_int_equal(wrong_at_random(f, stratus_bricks_values(bricks), 1000), 0);
    assert_int_equal(wrong_in_order(f, stratus_bricks_values(bricks)), 0);
    const stratus_bricks_report report = report_of(bricks);
    assert_int_equal(report.parts_here, report.parts);
    assert_int_equal(report.parts_read, report.parts);
    assert_int_equal(report.missing, 0);
    assert_int_equal(*stratus_bricks_missing(bricks), 0);
    assert_int_equal(f->misplaced, 0);
    stratus_bricks_destroy(bricks);
    assert_int_equal(f->released, 1);
    stratus_brick_pool_report left;
    stratus_brick_pool_get_report(pool, &left);
    assert_int_equal(left.resident, 0);
    stratus_brick_pool_destroy(pool);
  }
}

/* Where the system has no such pages, create reads all, and everything else is the same. */
static void without_pages_all_is_read_at_once(void** state)
{
  (void)state;
  formula f = make_formula(STRATUS_UINT16, 130, 77, 40, 32, 32, 8);
  stratus_brick_pool* pool = make_pool(0);
  const int faults = pool->faults;
  pool->faults = -1;
  stratus_bricks* bricks = make_bricks(pool, &f);
  const stratus_bricks_report report = report_of(bricks);
  assert_int_equal(report.parts_here, report.parts);
  assert_int_equal(wrong_in_order(&f, stratus_bricks_values(bricks)), 0);
  stratus_bricks_destroy(bricks);
  assert_int_equal(f.released, 1);
  pool->faults = faults;
  stratus_brick_pool_destroy(pool);
}

static void only_parts_that_are_looked_at_are_read(void** state)
{
  (void)state;
  formula f = make_formula(STRATUS_FLOAT32, 256, 256, 256, 64, 64, 64);
  stratus_brick_pool* pool = make_pool(0);
  if (!is_paged(pool)) {
    stratus_brick_pool_destroy(pool);
    return;
  }
  stratus_bricks* bricks = make_bricks(pool, &f);
  const float* values = stratus_bricks_values(bricks);
  assert_int_equal(report_of(bricks).parts, 16);
  assert_int_equal(report_of(bricks).parts_read, 0);
  for (int64_t k = 70; k < 120; k += 7) {
    for (int64_t i = 0; i < 256; i += 31) {
      assert_true(equals(&f, values, (k * 256 + 130) * 256 + i));
    }
  }
  assert_int_equal(report_of(bricks).parts_read, 1);
  assert_int_equal(report_of(bricks).bytes_read, 256 * 64 * 64 * 4);
  assert_int_equal(f.calls, 4);
  stratus_bricks_destroy(bricks);
  stratus_brick_pool_destroy(pool);
}

static void memory_stays_within_its_limit(void** state)
{
  (void)state;
  enum { LIMIT = 24 << 20 };
  formula f[] = { make_formula(STRATUS_FLOAT32, 256, 256, 256, 64, 64, 16), make_formula(STRATUS_UINT8, 301, 401, 267, 50, 33, 19) };
  stratus_brick_pool* pool = make_pool(LIMIT);
  if (!is_paged(pool)) {
    stratus_brick_pool_destroy(pool);
    return;
  }
  stratus_bricks* bricks[2] = { make_bricks(pool, &f[0]), make_bricks(pool, &f[1]) };
  for (int round = 0; round < 2; ++round) {
    for (int i = 0; i < 2; ++i) {
      assert_int_equal(wrong_at_random(&f[i], stratus_bricks_values(bricks[i]), 300), 0);
      assert_int_equal(wrong_in_order(&f[i], stratus_bricks_values(bricks[i])), 0);
    }
  }
  stratus_brick_pool_report report;
  stratus_brick_pool_get_report(pool, &report);
  assert_int_equal(report.memory, LIMIT);
  assert_true(report.resident <= LIMIT);
  assert_true(report.resident_most <= LIMIT);
  assert_true(report_of(bricks[0]).parts_dropped > 0);
  assert_true(report_of(bricks[0]).parts_read > report_of(bricks[0]).parts);
  stratus_bricks_destroy(bricks[0]);
  assert_int_equal(wrong_in_order(&f[1], stratus_bricks_values(bricks[1])), 0);
  stratus_bricks_destroy(bricks[1]);
  stratus_brick_pool_get_report(pool, &report);
  assert_int_equal(report.resident, 0);
  assert_int_equal(stratus_brick_pool_set_memory(pool, 1), STRATUS_OK);
  stratus_brick_pool_get_report(pool, &report);
  assert_int_equal(report.memory, 16 << 20); /* the least */
  stratus_brick_pool_destroy(pool);
}

/* Array 0 fills the memory, and some of its parts are read once more. Then only array 1 is read: none of its parts is dropped. */
static void parts_stay_while_they_are_read(void** state)
{
  (void)state;
  enum { PARTS = 8, SIDE = 256, PART = SIDE * SIDE * SIDE / PARTS };
  formula f[2] = { make_formula(STRATUS_UINT8, SIDE, SIDE, SIDE, SIDE, SIDE, SIDE / PARTS) };
  f[1] = f[0];
  for (int again = 0; again < PARTS; ++again) {
    stratus_brick_pool* pool = make_pool(PARTS * PART);
    if (!is_paged(pool)) {
      stratus_brick_pool_destroy(pool);
      return;
    }
    stratus_bricks* bricks[2] = { make_bricks(pool, &f[0]), make_bricks(pool, &f[1]) };
    const uint8_t* values[2] = { stratus_bricks_values(bricks[0]), stratus_bricks_values(bricks[1]) };
    for (int part = 0; part < PARTS + again; ++part) {
      assert_true(equals(&f[0], values[0], part % PARTS * PART));
    }
    for (int last = 0; last < PARTS - 2; ++last) {
      for (int part = 0; part <= last; ++part) {
        assert_true(equals(&f[1], values[1], part * PART));
      }
    }
    assert_int_equal(report_of(bricks[1]).parts_read, PARTS - 2);
    assert_int_equal(report_of(bricks[1]).parts_here, PARTS - 2);
    stratus_bricks_destroy(bricks[0]);
    stratus_bricks_destroy(bricks[1]);
    stratus_brick_pool_destroy(pool);
  }
}

/* Takes memory that goes back to the system as soon as it is released. */
static void* take_memory(size_t bytes)
{
  void* const memory = mmap(NULL, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  assert_ptr_not_equal(memory, MAP_FAILED);
  memset(memory, 1, bytes);
  return memory;
}

/* Other memory of the process takes its share of the limit, but never more than half. */
static void other_memory_of_the_process_counts(void** state)
{
  (void)state;
  enum { LIMIT = 64 << 20, OTHER = 24 << 20, MORE = 80 << 20, SLACK = 4 << 20 };
  formula f = make_formula(STRATUS_FLOAT32, 256, 256, 512, 64, 64, 16);
  stratus_brick_pool_options options = stratus_brick_pool_options_default();
  stratus_brick_pool* pool = NULL;
  options.memory = LIMIT;
  options.whole_process = 1;
  assert_int_equal(stratus_brick_pool_create(host, &options, &pool), STRATUS_OK);
  if (!is_paged(pool) || stratus_brick_memory_private() == 0) {
    stratus_brick_pool_destroy(pool);
    return;
  }
  stratus_bricks* bricks = make_bricks(pool, &f);
  void* const other = take_memory(OTHER);
  assert_int_equal(wrong_in_order(&f, stratus_bricks_values(bricks)), 0);
  assert_in_range(pool->resident, LIMIT / 2, LIMIT - OTHER + SLACK);
  void* const more = take_memory(MORE);
  assert_int_equal(wrong_in_order(&f, stratus_bricks_values(bricks)), 0);
  assert_in_range(pool->resident, LIMIT / 2 - SLACK, LIMIT / 2);
  munmap(more, MORE);
  munmap(other, OTHER);
  assert_int_equal(wrong_in_order(&f, stratus_bricks_values(bricks)), 0);
  assert_true(pool->grown < OTHER / 2); /* sanitizers take some */
  assert_in_range(pool->resident, LIMIT - SLACK - pool->grown, LIMIT);
  stratus_bricks_destroy(bricks);
  stratus_brick_pool_destroy(pool);
}

/* Rows of 4,004 bytes, of which 17 are a part: each shares 2 of its 17 pages with its neighbours, so that such pages of the whole array are
 * more than the memory. */
static void pages_that_parts_share_leave_room(void** state)
{
  (void)state;
  formula f = make_formula(STRATUS_FLOAT32, 1001, 1700, 50, 1001, 1, 1);
  stratus_brick_pool* pool = make_pool(16 << 20);
  if (!is_paged(pool)) {
    stratus_brick_pool_destroy(pool);
    return;
  }
  stratus_bricks* bricks = make_bricks(pool, &f);
  const void* values = stratus_bricks_values(bricks);
  const int64_t count = count_of(&f);
  int64_t wrong = 0;
  for (int64_t i = 0; i < count; i += 1001) { /* of every row, at its ends, which some of the shared pages hold */
    wrong += !equals(&f, values, i) + !equals(&f, values, i + 1000);
  }
  assert_int_equal(wrong, 0);
  const uint64_t once = report_of(bricks).parts_read;
  assert_in_range(once, bricks->rows.parts, bricks->rows.parts + bricks->rows.parts / 8);
  assert_true(bricks->rows.emptied > 0);
  assert_int_equal(wrong_at_random(&f, values, 2000), 0);
  for (int64_t i = 0; i < 17 * 1001; ++i) { /* what is read again and again is read from its file once */
    wrong += !equals(&f, values, 20 * 1001 + i);
  }
  const uint64_t before = report_of(bricks).parts_read;
  for (int64_t i = 0; i < 17 * 1001; ++i) {
    wrong += !equals(&f, values, 20 * 1001 + i);
  }
  assert_int_equal(wrong, 0);
  assert_int_equal(report_of(bricks).parts_read, before);
  assert_in_range(pool->resident, 0, 16 << 20);
  assert_in_range(pool->resident_most, 0, (16 << 20) + (1 << 20));
  stratus_bricks_destroy(bricks);
  assert_int_equal(pool->resident, 0);
  stratus_brick_pool_destroy(pool);
}

/* A part that is read between all others is dropped at most once, when the clock first goes around and all parts look alike. */
static void what_is_read_stays(void** state)
{
  (void)state;
  formula f = make_formula(STRATUS_FLOAT32, 256, 256, 256, 256, 256, 4); /* 64 parts of 1 MiB */
  stratus_brick_pool* pool = make_pool(16 << 20);
  if (!is_paged(pool)) {
    stratus_brick_pool_destroy(pool);
    return;
  }
  stratus_bricks* bricks = make_bricks(pool, &f);
  const float* values = stratus_bricks_values(bricks);
  const int64_t part = 256 * 256 * 4;
  uint64_t reads[4] = { 0 };
  for (int round = 0; round < 3; ++round) {
    for (int64_t p = 1; p < 64; ++p) {
      assert_true(equals(&f, values, p * part + 77));
      assert_true(equals(&f, values, 5 + round));
    }
    reads[round + 1] = report_of(bricks).parts_read;
    assert_true(reads[round + 1] - reads[round] <= 63 + (round == 0 ? 2 : 0));
  }
  assert_true(report_of(bricks).parts_dropped > 100);
  stratus_bricks_destroy(bricks);
  stratus_brick_pool_destroy(pool);
}

static void values_that_cannot_be_read_are_counted(void** state)
{
  (void)state;
  formula f[] = { make_formula(STRATUS_FLOAT32, 128, 128, 64, 32, 32, 16), make_formula(STRATUS_UINT16, 128, 128, 64, 128, 128, 8) };
  for (int i = 0; i < 2; ++i) {
    f[i].fails_at = (17 * 128 + 33) * 128 + 65;
    stratus_brick_pool* pool = make_pool(0);
    stratus_bricks* bricks = make_bricks(pool, &f[i]);
    const void* values = stratus_bricks_values(bricks);
    int64_t wrong = 0;
    for (int64_t z = 0; z < 64; ++z) {
      for (int64_t y = 0; y < 128; ++y) {
        for (int64_t x = 0; x < 128; ++x) {
          const int64_t at = (z * 128 + y) * 128 + x;
          const bool missing = i == 0 ? x / 32 == 2 && y / 32 == 1 && z / 16 == 1 : z / 8 == 2;
          wrong += !missing ? !equals(&f[i], values, at) : i == 0 ? !isnan(((const float*)values)[at]) : ((const uint16_t*)values)[at] != 0;
        }
      }
    }
    assert_int_equal(wrong, 0);
    assert_int_equal(*stratus_bricks_missing(bricks), (i == 0 ? 32 * 32 * 16 * 4 : 128 * 128 * 8 * 2));
    stratus_volume volume = stratus_volume_default();
    volume.values = values;
    volume.type = f[i].type;
    memcpy(volume.dimensions, f[i].dimensions, sizeof volume.dimensions);
    volume.missing = stratus_bricks_missing(bricks);
    stratus_value_range* ranges = NULL;
    assert_int_equal(stratus_value_range_create(host, &volume, 4, &ranges), STRATUS_INVALID_ARGUMENT);
    assert_non_null(strstr(stratus_context_message(host), "missing"));
    stratus_bricks_destroy(bricks);
    stratus_brick_pool_destroy(pool);
  }
}

/* An array that is larger than memory has all values in tiles, too, however they are looked at, within the limit. */
static void tiles_are_the_sources(void** state)
{
  (void)state;
  formula all[] = {
    make_formula(STRATUS_FLOAT32, 128, 96, 80, 32, 32, 16), /* bricks of 64 KiB */
    make_formula(STRATUS_UINT8, 301, 157, 67, 50, 33, 9),   /* small ones, which end anywhere */
    make_formula(STRATUS_INT16, 97, 201, 61, 97, 201, 1),   /* whole layers */
    make_formula(STRATUS_FLOAT64, 130, 70, 30, 1, 1, 1),    /* no bricks */
    make_formula(STRATUS_UINT8, 171, 120, 115, 1, 1, 1),
    make_formula(STRATUS_UINT16, 3 * 61, 70, 90, 3, 1, 1), /* of three components */
    make_formula(STRATUS_FLOAT32, 2 * 61, 70, 90, 2 * 16, 16, 16),
    make_formula(STRATUS_FLOAT32, 400003, 1, 1, 1000, 8, 8),
    without_first(make_formula(STRATUS_FLOAT32, 140, 120, 80, 32, 32, 16), 1, 31, 10), /* the first tiles are not whole */
    without_first(make_formula(STRATUS_UINT8, 301, 157, 67, 50, 33, 9), 20, 32, 1),
    without_first(make_formula(STRATUS_INT16, 97, 201, 61, 97, 201, 12), 30, 60, 11), /* tiles are longer than the part */
    without_first(make_formula(STRATUS_FLOAT32, 2 * 61, 70, 90, 2 * 16, 16, 16), 2 * 7, 9, 5),
  };
  static const int components[] = { 1, 1, 1, 1, 1, 3, 2, 1, 1, 1, 1, 2 };
  for (size_t i = 0; i < sizeof all / sizeof *all; ++i) {
    formula* const f = &all[i];
    const int64_t of_point = components[i], points = f->dimensions[0] / of_point;
    const size_t size = stratus_type_size(f->type);
    stratus_brick_pool* pool = make_pool(1);
    if (!is_paged(pool)) {
      stratus_brick_pool_destroy(pool);
      return;
    }
    const uint64_t memory = (uint64_t)count_of(f) * size * 3 / 4;
    pool->memory = memory;
    stratus_brick_source source = source_of(f);
    source.components = of_point;
    stratus_bricks* bricks = NULL;
    assert_int_equal(stratus_bricks_create(host, pool, &source, &bricks), STRATUS_OK);
    const stratus_tiles* tiles = stratus_bricks_tiles(bricks);
    assert_non_null(tiles);
    assert_int_equal(tiles->dimensions[0], points);
    int64_t wrong = 0;
#pragma omp parallel for num_threads(3) reduction(+ : wrong)
    for (int64_t at = 0; at < count_of(f); ++at) {
      const int64_t x = at % f->dimensions[0], y = at / f->dimensions[0] % f->dimensions[1], z = at / f->dimensions[0] / f->dimensions[1];
      const char* to =
        (const char*)tiles->values + tiles->at[0][x / of_point] + tiles->at[1][y] + tiles->at[2][z] + (size_t)(x % of_point) * size;
      double expected;
      put(f->type, &expected, 0, at);
      wrong += memcmp(&expected, to, size) != 0;
    }
    assert_int_equal(wrong, 0);
    for (int a = 0; a < 3; ++a) {
      assert_int_equal(tiles->at[a][tiles->dimensions[a]], tiles->at[a][tiles->dimensions[a] - 1]);
    }
    stratus_brick_pool_report report;
    stratus_brick_pool_get_report(pool, &report);
    assert_true(report.resident <= memory);
    assert_int_equal(wrong_at_random(f, stratus_bricks_values(bricks), 300), 0); /* the array itself, in the same memory */
    assert_int_equal(f->misplaced, 0);
    stratus_bricks_destroy(bricks);
    assert_int_equal(f->released, 1);
    stratus_brick_pool_get_report(pool, &report);
    assert_int_equal(report.resident, 0);
    stratus_brick_pool_destroy(pool);
  }
}

static void only_tiles_that_are_looked_at_are_read(void** state)
{
  (void)state;
  formula f = make_formula(STRATUS_FLOAT32, 256, 256, 256, 64, 64, 64);
  stratus_brick_pool* pool = make_pool(16 << 20);
  if (!is_paged(pool)) {
    stratus_brick_pool_destroy(pool);
    return;
  }
  stratus_bricks* bricks = make_bricks(pool, &f);
  const stratus_tiles* tiles = stratus_bricks_tiles(bricks);
  assert_non_null(tiles);
  for (int64_t i = 70; i < 120; i += 7) {
    const float* value =
      (const float*)(const void*)((const char*)tiles->values + tiles->at[0][i] + tiles->at[1][130] + tiles->at[2][250 - i]);
    uint64_t expected = 0; /* room for any type: compilers see all of put()'s */
    put(STRATUS_FLOAT32, &expected, 0, ((250 - i) * 256 + 130) * 256 + i);
    assert_memory_equal(value, &expected, sizeof *value);
  }
  assert_int_equal(report_of(bricks).parts_read, 1);
  assert_int_equal(report_of(bricks).bytes_read, 64 * 64 * 64 * 4);
  assert_int_equal(f.calls, 1);
  stratus_bricks_destroy(bricks);
  pool->memory = (uint64_t)1 << 30; /* now it fits */
  bricks = make_bricks(pool, &f);
  assert_null(stratus_bricks_tiles(bricks));
  stratus_bricks_destroy(bricks);
  stratus_brick_pool_destroy(pool);
}

static void wait_a_little(void)
{
  const struct timespec time = { .tv_nsec = 5 * 1000 * 1000 };
  nanosleep(&time, NULL);
}

/* Parts are read where another array's were, when nothing else reads, and only into memory that both leave. */
static void parts_are_read_ahead(void** state)
{
  (void)state;
  enum { NX = 256, NY = 128, NZ = 128, PART = NX * 64 * 32 * 4, TILE = PART / 8 };
  for (int tiled = 0; tiled < 2; ++tiled) {
    formula f[2] = { make_formula(STRATUS_FLOAT32, NX, NY, NZ, 32, 64, 32), make_formula(STRATUS_FLOAT32, NX, NY, NZ, 32, 64, 32) };
    stratus_brick_pool* pool = make_pool(1);
    if (!is_paged(pool)) {
      stratus_brick_pool_destroy(pool);
      return;
    }
    pool->memory = tiled ? 8 << 20 : 1 << 30; /* an array takes 16 MB */
    stratus_bricks* bricks[2] = { make_bricks(pool, &f[0]), make_bricks(pool, &f[1]) };
    pool->memory = 5 * (tiled ? TILE : PART);
    assert_int_equal(stratus_bricks_read_ahead(bricks[1], bricks[0]), STRATUS_OK);
    const stratus_tiles* tiles[2] = { stratus_bricks_tiles(bricks[0]), stratus_bricks_tiles(bricks[1]) };
    assert_int_equal(tiles[0] != NULL, tiled);
    for (int part = 0; part < 2; ++part) {
      const int64_t at = ((40 + 32 * part) * NY + 70) * NX + 90;
      if (tiled) {
        const size_t offset = tiles[0]->at[0][90] + tiles[0]->at[1][70] + tiles[0]->at[2][40 + 32 * part];
        assert_true(isfinite(*(const float*)(const void*)((const char*)tiles[0]->values + offset)));
      } else {
        assert_true(equals(&f[0], stratus_bricks_values(bricks[0]), at));
      }
      for (int tries = 0; tries < 2000 && report_of(bricks[1]).parts_read < (uint64_t)part + 1; ++tries) {
        wait_a_little();
      }
      assert_int_equal(report_of(bricks[1]).parts_read, part + 1);
    }
    assert_int_equal(report_of(bricks[0]).parts_read, 2);
    /* one more part of the first array: there is no room for the second one's, and nothing is dropped for it */
    const size_t third = tiled ? tiles[0]->at[2][100] : 0;
    assert_true(tiled ? isfinite(*(const float*)(const void*)((const char*)tiles[0]->values + third))
                      : equals(&f[0], stratus_bricks_values(bricks[0]), (int64_t)100 * NY * NX));
    for (int tries = 0; tries < 20; ++tries) {
      wait_a_little();
    }
    assert_int_equal(report_of(bricks[1]).parts_read, 2);
    assert_int_equal(report_of(bricks[0]).parts_dropped + report_of(bricks[1]).parts_dropped, 0);
    if (!tiled) { /* a part that was read ahead is not read again */
      assert_true(equals(&f[1], stratus_bricks_values(bricks[1]), ((int64_t)72 * NY + 70) * NX + 91));
      assert_int_equal(report_of(bricks[1]).parts_read, 2);
    }
    assert_int_equal(stratus_bricks_read_ahead(bricks[1], bricks[1]), STRATUS_INVALID_ARGUMENT);
    stratus_bricks_destroy(bricks[0]);
    stratus_bricks_destroy(bricks[1]);
    stratus_brick_pool_destroy(pool);
  }
}

/* A picture of bricks in little memory has the bits of one of values in memory, and reads less where less shows. */
static void pictures_are_the_same(void** state)
{
  (void)state;
  enum { N = 160, SIZE = 96 };
  formula f = make_formula(STRATUS_FLOAT32, N, N, N, 32, 32, 1);
  const double opacity[] = { 0.9, 0.0, 1.0, 0.6 }, color[] = { 0.9, 1.0, 0.5, 0.1, 1.0, 0.2, 0.6, 1.0 };
  stratus_transfer transfer = stratus_transfer_default();
  transfer.opacity = opacity;
  transfer.opacity_count = 2;
  transfer.color = color;
  transfer.color_count = 2;
  stratus_volume volume = stratus_volume_default();
  volume.type = STRATUS_FLOAT32;
  memcpy(volume.dimensions, f.dimensions, sizeof volume.dimensions);
  const size_t count = (size_t)N * N * N;
  float* plain = malloc(count * sizeof *plain);
  assert_non_null(plain);
  for (size_t i = 0; i < count; ++i) {
    put(STRATUS_FLOAT32, plain, (int64_t)i, (int64_t)i);
  }
  stratus_brick_pool* pool = make_pool(1);
  pool->memory = 8 << 20; /* the array takes 16 MB */
  stratus_bricks* bricks = make_bricks(pool, &f);
  float pixels[3][SIZE * SIZE * 4];
  uint64_t reads[3] = { 0 };
  for (int i = 0; i < 3; ++i) {
    stratus_ray_caster* caster = NULL;
    stratus_camera camera;
    const double eye[3] = { 3.0 * N, 0.4 * N, 0.3 * N }, focal[3] = { 0.5 * N, 0.5 * N, 0.5 * N }, up[3] = { 0.0, 1.0, 0.0 };
    volume.values = i == 0 ? plain : stratus_bricks_values(bricks);
    volume.missing = i == 0 ? NULL : stratus_bricks_missing(bricks);
    if (i == 2 && stratus_bricks_tiles(bricks)) {
      volume.tiles = *stratus_bricks_tiles(bricks);
    }
    assert_int_equal(stratus_camera_perspective(host, eye, focal, up, 30.0, 1.0, &camera), STRATUS_OK);
    stratus_image image = { .width = SIZE, .height = SIZE, .rgba = pixels[i] };
    assert_int_equal(stratus_ray_caster_create(host, &caster), STRATUS_OK);
    assert_int_equal(stratus_ray_caster_render(caster, &volume, &transfer, &camera, NULL, &image, NULL), STRATUS_OK);
    stratus_ray_caster_destroy(caster);
    reads[i] = *stratus_bricks_reads(bricks);
  }
  assert_memory_equal(pixels[0], pixels[1], sizeof pixels[0]);
  assert_memory_equal(pixels[0], pixels[2], sizeof pixels[0]);
  assert_true(!stratus_bricks_tiles(bricks) || reads[2] > reads[1]);
  stratus_brick_pool_report report;
  stratus_brick_pool_get_report(pool, &report);
  assert_true(!report.paged || (report.resident_most <= 8 << 20 && report_of(bricks).parts_dropped > 0));
  stratus_bricks_destroy(bricks);
  stratus_brick_pool_destroy(pool);
  free(plain);
}

/* Once value ranges are kept, bricks of one value are not read, and have that value. */
static int read_layered(void* user, const int64_t lo[3], const int64_t size[3], void* values)
{
  const formula* f = user;
  const int failed = read_formula(user, lo, size, values);
  for (int64_t z = 0; z < size[2]; ++z) { /* all but layers 40..59 are 7 */
    for (int64_t i = 0; (lo[2] + z < 40 || lo[2] + z > 59) && i < size[0] * size[1]; ++i) {
      const int64_t to = z * size[0] * size[1] + i;
      if (f->type == STRATUS_FLOAT32) {
        ((float*)values)[to] = 7.0f;
      } else if (f->type == STRATUS_INT16) {
        ((int16_t*)values)[to] = -7;
      } else {
        ((uint8_t*)values)[to] = 7;
      }
    }
  }
  return failed;
}

static void bricks_of_one_value_are_not_read(void** state)
{
  static const stratus_type types[] = { STRATUS_FLOAT32, STRATUS_INT16, STRATUS_UINT8 };
  char folder[] = "/tmp/stratus-bricks-XXXXXX";
  (void)state;
  assert_non_null(mkdtemp(folder));
  setenv("STRATUS_CACHE_DIR", folder, 1);
  for (size_t t = 0; t < sizeof types / sizeof *types; ++t) {
    formula f = make_formula(types[t], 70, 90, 100, 20, 30, 10);
    f.before[0] = t == 1 ? 15 : 0; /* five bricks along x, of which the first has five values */
    const size_t bytes = (size_t)count_of(&f) * stratus_type_size(types[t]);
    char* values[2];
    int calls[2];
    for (int round = 0; round < 2; ++round) {
      stratus_brick_pool* pool = make_pool(0);
      stratus_bricks* bricks = NULL;
      stratus_brick_source source = source_of(&f);
      source.read = read_layered;
      source.identity = 71 + t;
      f.calls = 0;
      assert_int_equal(stratus_bricks_create(host, pool, &source, &bricks), STRATUS_OK);
      stratus_volume volume = stratus_volume_default();
      volume.values = stratus_bricks_values(bricks);
      volume.type = f.type;
      volume.identity = source.identity;
      memcpy(volume.dimensions, f.dimensions, sizeof volume.dimensions);
      stratus_value_range* ranges = NULL;
      assert_int_equal(stratus_value_range_create(host, &volume, 0, &ranges), STRATUS_OK);
      stratus_value_range_destroy(ranges);
      values[round] = malloc(bytes);
      memcpy(values[round], volume.values, bytes);
      calls[round] = f.calls;
      stratus_bricks_destroy(bricks);
      stratus_brick_pool_destroy(pool);
    }
    assert_memory_equal(values[0], values[1], bytes);
    const int across = t == 1 ? 5 : 4;
    assert_int_equal(calls[0], across * 3 * 10);
    assert_int_equal(
      calls[1], across * 3 * 3); /* two layers of bricks with other values, and the one below, whose last block touches them */
    free(values[0]);
    free(values[1]);
  }
  unsetenv("STRATUS_CACHE_DIR");
  remove_folder(folder);
}

static void faults_of_the_caller_are_told(void** state)
{
  (void)state;
  formula f = make_formula(STRATUS_FLOAT32, 8, 8, 8, 4, 4, 4);
  stratus_brick_pool* pool = make_pool(0);
  stratus_bricks* bricks = NULL;
  stratus_brick_pool_options options = { .threads = 65 };
  stratus_brick_pool* none = NULL;
  assert_int_equal(stratus_brick_pool_create(host, &options, &none), STRATUS_INVALID_ARGUMENT);
  assert_non_null(strstr(stratus_context_message(host), "0..64"));
  stratus_brick_source source = source_of(&f);
  source.brick[1] = 0;
  assert_int_equal(stratus_bricks_create(host, pool, &source, &bricks), STRATUS_INVALID_ARGUMENT);
  assert_int_equal(f.released, 1);
  source = source_of(&f);
  source.before[2] = 4;
  assert_int_equal(stratus_bricks_create(host, pool, &source, &bricks), STRATUS_INVALID_ARGUMENT);
  assert_non_null(strstr(stratus_context_message(host), "axis 2 of bricks has 4 values before the array, must be from 0 to 3"));
  source = source_of(&f);
  source.read = NULL;
  assert_int_equal(stratus_bricks_create(host, pool, &source, &bricks), STRATUS_INVALID_ARGUMENT);
  source = source_of(&f);
  source.type = (stratus_type)99;
  assert_int_equal(stratus_bricks_create(host, pool, &source, &bricks), STRATUS_INVALID_ARGUMENT);
  source = source_of(&f);
  source.components = 3;
  assert_int_equal(stratus_bricks_create(host, pool, &source, &bricks), STRATUS_INVALID_ARGUMENT);
  source = source_of(&f);
  source.dimensions[0] = source.dimensions[1] = source.dimensions[2] = INT64_C(1) << 30;
  assert_int_equal(stratus_bricks_create(host, pool, &source, &bricks), STRATUS_OVERFLOW);
  assert_int_equal(f.released, 6);
  assert_null(bricks);
  stratus_brick_pool_destroy(pool);
}

int test_bricks(void)
{
  const struct CMUnitTest tests[] = { cmocka_unit_test(values_are_the_sources), cmocka_unit_test(without_pages_all_is_read_at_once),
    cmocka_unit_test(only_parts_that_are_looked_at_are_read), cmocka_unit_test(memory_stays_within_its_limit),
    cmocka_unit_test(parts_stay_while_they_are_read), cmocka_unit_test(other_memory_of_the_process_counts),
    cmocka_unit_test(pages_that_parts_share_leave_room), cmocka_unit_test(what_is_read_stays),
    cmocka_unit_test(values_that_cannot_be_read_are_counted), cmocka_unit_test(tiles_are_the_sources),
    cmocka_unit_test(only_tiles_that_are_looked_at_are_read), cmocka_unit_test(parts_are_read_ahead),
    cmocka_unit_test(pictures_are_the_same), cmocka_unit_test(bricks_of_one_value_are_not_read),
    cmocka_unit_test(faults_of_the_caller_are_told) };
  return cmocka_run_group_tests(tests, begin, end);
}
