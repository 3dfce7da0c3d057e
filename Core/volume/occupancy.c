/* SPDX-License-Identifier: BSD-3-Clause
 * Occupancy: the blocks that the transfer function shows, by the range test of Deakin & Knackstedt 2019 on value ranges that include the
 * halo. */
#include "clones.h"
#include "volume.h"
#include "volume_device.h"
#include "criterion.h"
#include "device.h"

#include <string.h>

#define RUN 256 /* blocks tested at once: their entries stay in the first cache */

/* Does what stratus_table_shows() does, for a run of blocks. Two loops keep the arithmetic apart, which then vectorises. */
static ALWAYS_INLINE void test_run(
  const stratus_table* table, const float* restrict lo, const float* restrict hi, int64_t count, uint8_t* restrict occupied)
{
  int first[RUN], last[RUN];
  for (int64_t b = 0; b < count; ++b) {
    const float from = lo[b] <= hi[b] ? lo[b] : 0.0f, to = lo[b] <= hi[b] ? hi[b] : 0.0f;
    /* Not fmaxf(), which remains a call because of its rule for NaN. */
    const float slack = STRATUS_HULL_SLACK * (fabsf(from) > fabsf(to) ? fabsf(from) : fabsf(to));
    first[b] = stratus_table_entry(table, from - slack);
    last[b] = stratus_table_entry(table, to + slack);
  }
  for (int64_t b = 0; b < count; ++b) {
    occupied[b] = (lo[b] <= hi[b]) & (table->next_shown[first[b]] <= last[b]);
  }
}

typedef void (*test_function)(const stratus_table*, const float*, const float*, int64_t, uint8_t*);

static void test_run_portable(const stratus_table* table, const float* lo, const float* hi, int64_t count, uint8_t* occupied)
{
  test_run(table, lo, hi, count, occupied);
}

#if HAVE_CLONES
/* stratus_table_entry() is a fused multiply-add, which compiles to a library call without this instruction set. */
__attribute__((target("avx2,fma"))) static void test_run_fused(
  const stratus_table* table, const float* lo, const float* hi, int64_t count, uint8_t* occupied)
{
  test_run(table, lo, hi, count, occupied);
}
#endif

static test_function choose_test(void)
{
#if HAVE_CLONES
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) {
    return test_run_fused;
  }
#endif
  return test_run_portable;
}

/* Number and bounds [lo, hi) of occupied blocks. widen_extent() adds one row of blocks. */
typedef struct extent {
  int64_t count, lo[3], hi[3];
} extent;

static void widen_extent(extent* whole, const uint8_t* row, int64_t n, int64_t j, int64_t k)
{
  int64_t count = 0, first = 0, last = n;
  for (int64_t i = 0; i < n; ++i) {
    count += row[i];
  }
  if (count == 0) {
    return;
  }
  while (!row[first]) {
    ++first;
  }
  while (!row[last - 1]) {
    --last;
  }
  const int64_t lo[3] = { first, j, k }, hi[3] = { last, j + 1, k + 1 };
  whole->count += count;
  for (int a = 0; a < 3; ++a) {
    whole->lo[a] = lo[a] < whole->lo[a] ? lo[a] : whole->lo[a];
    whole->hi[a] = hi[a] > whole->hi[a] ? hi[a] : whole->hi[a];
  }
}

/* ranges and table may be NULL: occupied[] is then set already and only counted. With pre-integration, a block with gaps (values that are
 * not finite, or hidden cells) counts as occupied if the table shows anything: stratus_occupancy_build() tells why. */
static void test_rows(
  const stratus_context* context, const stratus_value_range* ranges, const stratus_table* table, stratus_occupancy* occupancy)
{
  const test_function test = choose_test();
  const int64_t n = occupancy->blocks[0], rows = occupancy->blocks[1] * occupancy->blocks[2];
  const int gaps_show = table && table->sums && table->shown > 0;
  extent whole = { 0, { INT64_MAX, INT64_MAX, INT64_MAX }, { 0, 0, 0 } };
#pragma omp parallel num_threads(context->threads)
  {
    extent mine = { 0, { INT64_MAX, INT64_MAX, INT64_MAX }, { 0, 0, 0 } };
#pragma omp for schedule(static) nowait
    for (int64_t row = 0; row < rows; ++row) {
      const int64_t block = row * n;
      uint8_t* occupied = occupancy->occupied + block;
      for (int64_t i = 0; ranges && i < n; i += RUN) {
        test(table, ranges->lo + block + i, ranges->hi + block + i, n - i < RUN ? n - i : RUN, occupied + i);
      }
      for (int64_t i = 0; gaps_show && i < n; ++i) {
        occupied[i] |= ranges->gaps[block + i];
      }
      widen_extent(&mine, occupied, n, row % occupancy->blocks[1], row / occupancy->blocks[1]);
    }
#pragma omp critical(stratus_occupancy)
    {
      whole.count += mine.count;
      for (int a = 0; a < 3; ++a) {
        whole.lo[a] = mine.lo[a] < whole.lo[a] ? mine.lo[a] : whole.lo[a];
        whole.hi[a] = mine.hi[a] > whole.hi[a] ? mine.hi[a] : whole.hi[a];
      }
    }
  }
  occupancy->count = whole.count;
  if (whole.count > 0) {
    memcpy(occupancy->lo, whole.lo, sizeof whole.lo);
    memcpy(occupancy->hi, whole.hi, sizeof whole.hi);
  }
}

static stratus_status create_empty(stratus_context* context, const stratus_value_range* ranges, stratus_occupancy** out)
{
  void* memory;
  TRY(stratus_allocate_zero(context, 1, sizeof **out, &memory));
  stratus_occupancy* occupancy = memory;
  occupancy->context = context;
  occupancy->block_size = ranges->block_size;
  memcpy(occupancy->blocks, ranges->blocks, sizeof occupancy->blocks);
  const stratus_status status = stratus_allocate(context, (size_t)(ranges->blocks[0] * ranges->blocks[1] * ranges->blocks[2]), 1, &memory);
  if (status != STRATUS_OK) {
    stratus_occupancy_destroy(occupancy);
    return status;
  }
  occupancy->occupied = memory;
  *out = occupancy;
  return STRATUS_OK;
}

stratus_status stratus_occupancy_build(
  stratus_context* context, const stratus_value_range* ranges, const stratus_table* table, stratus_occupancy** out)
{
  stratus_status status = STRATUS_OK;
  stratus_occupancy* occupancy = NULL;

  TRY(stratus_progress(context, "occupancy", 0.0));
  TRY(create_empty(context, ranges, &occupancy));
  if (stratus_device_builds(context) && stratus_device_takes_blocks(context, ranges->blocks)) {
    TRY_CLEANUP(stratus_device_occupancy(context, ranges, table, occupancy));
    test_rows(context, NULL, NULL, occupancy);
  } else {
    test_rows(context, ranges, table, occupancy);
  }
  TRY_CLEANUP(stratus_progress(context, "occupancy", 1.0));
  *out = occupancy;
  occupancy = NULL;

cleanup:
  stratus_occupancy_destroy(occupancy);
  return status;
}

void stratus_occupancy_add(stratus_occupancy* occupancy, const stratus_occupancy* other)
{
  const int64_t blocks = occupancy->blocks[0] * occupancy->blocks[1] * occupancy->blocks[2];
  for (int64_t b = 0; b < blocks; ++b) {
    occupancy->occupied[b] |= other->occupied[b];
  }
  test_rows(occupancy->context, NULL, NULL, occupancy); /* updates the count and the bounds */
}

stratus_status stratus_occupancy_create(stratus_context* context, const stratus_value_range* ranges, const stratus_transfer* transfer,
  stratus_sampling sampling, stratus_occupancy** out)
{
  if (!context) {
    return STRATUS_INVALID_ARGUMENT;
  }
  if (!ranges || !out) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "%s is NULL", ranges ? "occupancy" : "ranges");
  }
  if ((int)sampling < STRATUS_SAMPLING_AUTO || sampling > STRATUS_SAMPLING_PREINTEGRATED) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "sampling %d outside %d..%d", (int)sampling, STRATUS_SAMPLING_AUTO,
      STRATUS_SAMPLING_PREINTEGRATED);
  }
  TRY(stratus_transfer_check(context, transfer));
  /* Pre-integration shows all that single samples show, so that it serves both samplings. */
  const stratus_sampling used = sampling == STRATUS_SAMPLING_AUTO ? STRATUS_SAMPLING_PREINTEGRATED : sampling;
  const int any = ranges->whole_lo <= ranges->whole_hi;
  stratus_table* table = NULL;
  TRY(
    stratus_table_create(context, transfer, ranges->bias, any ? ranges->whole_lo : 0.0f, any ? ranges->whole_hi : 0.0f, used, 1.0, &table));
  const stratus_status status = stratus_occupancy_build(context, ranges, table, out);
  stratus_table_destroy(table);
  return status;
}

/* Finds the least and the greatest fetched value that may stand for a value in lower..upper. Wide types use the fetched ends: fetching is
 * monotone, so that a value beyond an end is fetched as a float beyond that end or as the same float. */
static void find_ends(const stratus_value_range* ranges, double lower, double upper, float* first, float* last)
{
  *first = ranges->wide ? (float)(lower - ranges->bias) : stratus_float_above(lower); /* narrow types are fetched exactly */
  *last = ranges->wide ? (float)(upper - ranges->bias) : stratus_float_below(upper);
}

stratus_status stratus_occupancy_create_between(
  stratus_context* context, const stratus_value_range* ranges, double lower, double upper, stratus_occupancy** out)
{
  stratus_occupancy* occupancy = NULL;
  float first, last;
  if (!context) {
    return STRATUS_INVALID_ARGUMENT;
  }
  if (!ranges || !out) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "%s is NULL", ranges ? "occupancy" : "ranges");
  }
  const stratus_criterion criterion = { .lower = lower, .upper = upper };
  TRY(stratus_criterion_check(context, &criterion));
  TRY(stratus_progress(context, "occupancy", 0.0));
  TRY(create_empty(context, ranges, &occupancy));
  find_ends(ranges, lower, upper, &first, &last);
  const int64_t blocks = ranges->blocks[0] * ranges->blocks[1] * ranges->blocks[2];
#pragma omp parallel for schedule(static) num_threads(context->threads)
  for (int64_t b = 0; b < blocks; ++b) {
    occupancy->occupied[b] = (ranges->lo[b] <= ranges->hi[b]) & (ranges->lo[b] <= last) & (ranges->hi[b] >= first);
  }
  test_rows(context, NULL, NULL, occupancy); /* updates the count and the bounds */
  const stratus_status status = stratus_progress(context, "occupancy", 1.0);
  if (status != STRATUS_OK) {
    stratus_occupancy_destroy(occupancy);
    return status;
  }
  *out = occupancy;
  return STRATUS_OK;
}

void stratus_occupancy_destroy(stratus_occupancy* occupancy)
{
  if (occupancy) {
    stratus_context* context = occupancy->context;
    stratus_release(context, occupancy->occupied);
    stratus_release(context, occupancy);
  }
}

void stratus_occupancy_blocks(const stratus_occupancy* occupancy, int64_t blocks[3], int* block_size)
{
  static const stratus_occupancy none;
  occupancy = occupancy ? occupancy : &none;
  if (blocks) {
    memcpy(blocks, occupancy->blocks, sizeof occupancy->blocks);
  }
  if (block_size) {
    *block_size = occupancy->block_size;
  }
}

int64_t stratus_occupancy_count(const stratus_occupancy* occupancy)
{
  return occupancy ? occupancy->count : 0;
}

int stratus_occupancy_get(const stratus_occupancy* occupancy, int64_t i, int64_t j, int64_t k)
{
  if (!occupancy || i < 0 || j < 0 || k < 0 || i >= occupancy->blocks[0] || j >= occupancy->blocks[1] || k >= occupancy->blocks[2]) {
    return 0;
  }
  return occupancy->occupied[(k * occupancy->blocks[1] + j) * occupancy->blocks[0] + i];
}

void stratus_occupancy_bounds(const stratus_occupancy* occupancy, int64_t lo[3], int64_t hi[3])
{
  for (int a = 0; a < 3; ++a) {
    if (lo) {
      lo[a] = occupancy ? occupancy->lo[a] : 0;
    }
    if (hi) {
      hi[a] = occupancy ? occupancy->hi[a] : 0;
    }
  }
}
