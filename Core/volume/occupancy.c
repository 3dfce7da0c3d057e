/* SPDX-License-Identifier: BSD-3-Clause
 * Occupancy: the blocks that the transfer function shows, by the range test of Deakin & Knackstedt 2019 on value ranges that include the
 * halo. */
#include "volume.h"
#include "volume_device.h"
#include "criterion.h"
#include "device.h"

#include <string.h>

#define RUN 256 /* blocks tested at once: their ranges stay in the first cache */
/* Up to this many intervals, comparing with all is faster than a search, because it vectorises. */
#define INTERVALS_COMPARED 16

/* Tests a run of blocks. A block without finite values, whose range is INFINITY..-INFINITY, meets no interval. */
static void test_run(
  const stratus_shown* shown, const float* restrict lo, const float* restrict hi, int64_t count, uint8_t* restrict occupied)
{
  if (shown->count > INTERVALS_COMPARED) {
    for (int64_t b = 0; b < count; ++b) {
      occupied[b] = stratus_shown_meets(shown, lo[b], hi[b]);
    }
    return;
  }
  memset(occupied, 0, (size_t)count);
  for (int64_t i = 0; i < shown->count; ++i) {
    const float first = shown->of[i][0], last = shown->of[i][1];
    for (int64_t b = 0; b < count; ++b) {
      occupied[b] |= (lo[b] <= last) & (hi[b] >= first) & (lo[b] <= hi[b]);
    }
  }
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

/* ranges and shown may be NULL: occupied[] is then set already and only counted. gaps: blocks with gaps are occupied. */
static void test_rows(
  const stratus_context* context, const stratus_value_range* ranges, const stratus_shown* shown, bool gaps, stratus_occupancy* occupancy)
{
  const int64_t n = occupancy->blocks[0], rows = occupancy->blocks[1] * occupancy->blocks[2];
  extent whole = { 0, { INT64_MAX, INT64_MAX, INT64_MAX }, { 0, 0, 0 } };
#pragma omp parallel num_threads(context->threads)
  {
    extent mine = { 0, { INT64_MAX, INT64_MAX, INT64_MAX }, { 0, 0, 0 } };
#pragma omp for schedule(static) nowait
    for (int64_t row = 0; row < rows; ++row) {
      const int64_t block = row * n;
      uint8_t* occupied = occupancy->occupied + block;
      for (int64_t i = 0; ranges && i < n; i += RUN) {
        test_run(shown, ranges->lo + block + i, ranges->hi + block + i, n - i < RUN ? n - i : RUN, occupied + i);
      }
      for (int64_t i = 0; gaps && i < n; ++i) {
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

static void end_stage(stratus_context* context, const stratus_stage* stage, const stratus_occupancy* occupancy)
{
  stratus_stage_end(context, stage, "occupancy", (size_t)(occupancy->blocks[0] * occupancy->blocks[1] * occupancy->blocks[2]));
}

static stratus_status create_empty(stratus_context* context, const int64_t blocks[3], int block_size, stratus_occupancy** out)
{
  void* memory;
  TRY(stratus_allocate_zero(context, 1, sizeof **out, &memory));
  stratus_occupancy* occupancy = memory;
  occupancy->context = context;
  occupancy->block_size = block_size;
  memcpy(occupancy->blocks, blocks, sizeof occupancy->blocks);
  const stratus_status status = stratus_allocate(context, (size_t)(blocks[0] * blocks[1] * blocks[2]), 1, &memory);
  if (status != STRATUS_OK) {
    stratus_occupancy_destroy(occupancy);
    return status;
  }
  occupancy->occupied = memory;
  *out = occupancy;
  return STRATUS_OK;
}

stratus_status stratus_occupancy_build(
  stratus_context* context, const stratus_value_range* ranges, const stratus_shown* shown, bool gaps, stratus_occupancy** out)
{
  stratus_status status = STRATUS_OK;
  stratus_occupancy* occupancy = NULL;

  const stratus_stage stage = stratus_stage_begin(context);
  gaps = gaps && stratus_shown_meets(shown, ranges->whole_lo, ranges->whole_hi);
  TRY(stratus_progress(context, "occupancy", 0.0));
  TRY(create_empty(context, ranges->blocks, ranges->block_size, &occupancy));
  bool tested = false;
  if (stratus_device_builds(context) && stratus_device_takes_blocks(context, ranges->blocks)) {
    status = stratus_device_occupancy(context, ranges, shown, gaps, occupancy);
    tested = !stratus_device_hands_back(context, status);
    TRY_CLEANUP(tested ? status : STRATUS_OK);
  }
  test_rows(context, tested ? NULL : ranges, shown, gaps && !tested, occupancy);
  end_stage(context, &stage, occupancy);
  TRY_CLEANUP(stratus_progress(context, "occupancy", 1.0));
  *out = occupancy;
  occupancy = NULL;

cleanup:
  stratus_occupancy_destroy(occupancy);
  return status;
}

stratus_status stratus_occupancy_below(
  stratus_context* context, const int64_t blocks[3], int block_size, const uint8_t* bytes, uint8_t beyond, stratus_occupancy** occupancy)
{
  TRY(create_empty(context, blocks, block_size, occupancy));
  for (int64_t b = 0; b < blocks[0] * blocks[1] * blocks[2]; ++b) {
    (*occupancy)->occupied[b] = bytes[b] < beyond;
  }
  test_rows(context, NULL, NULL, false, *occupancy); /* counts them */
  return STRATUS_OK;
}

void stratus_occupancy_add(stratus_occupancy* occupancy, const stratus_occupancy* other)
{
  const int64_t blocks = occupancy->blocks[0] * occupancy->blocks[1] * occupancy->blocks[2];
  for (int64_t b = 0; b < blocks; ++b) {
    occupancy->occupied[b] |= other->occupied[b];
  }
  test_rows(occupancy->context, NULL, NULL, false, occupancy); /* updates the count and the bounds */
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
  if ((int)sampling < STRATUS_SAMPLING_AUTO || sampling > STRATUS_SAMPLING_CELLS) {
    return stratus_fail(
      context, STRATUS_INVALID_ARGUMENT, "sampling %d outside %d..%d", (int)sampling, STRATUS_SAMPLING_AUTO, STRATUS_SAMPLING_CELLS);
  }
  TRY(stratus_transfer_check(context, transfer));
  const stratus_fetching fetching = stratus_value_range_fetching(ranges);
  stratus_shown shown;
  TRY(stratus_shown_of_transfer(context, &fetching, transfer, &shown));
  /* Segments show all that single samples show, so that they serve every sampling; so do cells. */
  const stratus_status status = stratus_occupancy_build(context, ranges, &shown, sampling != STRATUS_SAMPLING_MIDPOINT, out);
  stratus_release(context, shown.of);
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
  const stratus_stage stage = stratus_stage_begin(context);
  TRY(stratus_progress(context, "occupancy", 0.0));
  TRY(create_empty(context, ranges->blocks, ranges->block_size, &occupancy));
  find_ends(ranges, lower, upper, &first, &last);
  bool tested = false;
  stratus_status status = STRATUS_OK;
  if (ranges->on_device && ranges->context == context && stratus_device_builds(context)) {
    const stratus_shown between = { .count = 1, .of = &(float[2]){ first, last } };
    status = stratus_device_occupancy(context, ranges, &between, false, occupancy);
    tested = !stratus_device_hands_back(context, status);
    status = tested ? status : STRATUS_OK;
  }
  const int64_t blocks = tested ? 0 : ranges->blocks[0] * ranges->blocks[1] * ranges->blocks[2];
#pragma omp parallel for schedule(static) num_threads(context->threads)
  for (int64_t b = 0; b < blocks; ++b) {
    occupancy->occupied[b] = (ranges->lo[b] <= ranges->hi[b]) & (ranges->lo[b] <= last) & (ranges->hi[b] >= first);
  }
  if (status == STRATUS_OK) {
    test_rows(context, NULL, NULL, false, occupancy); /* updates the count and the bounds */
    end_stage(context, &stage, occupancy);
    status = stratus_progress(context, "occupancy", 1.0);
  }
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
