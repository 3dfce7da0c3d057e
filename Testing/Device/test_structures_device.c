/* SPDX-License-Identifier: BSD-3-Clause
 * Structures built by an OpenCL device against the host's, to the bit. A context chooses by its device, so the
 * builders of the device are called themselves, and the host's by a context of its own.
 * Run with the argument `--tiny` it takes few and small grids: enough for a simulator to see every kernel. */
#include "structures.h"

#include "device.h"
#include "device_pair.h"
#include "volume_device.h"

/* The same object with its own arrays, full of something else, for the device to fill. */
static stratus_value_range blank_ranges(const stratus_value_range* host)
{
  const size_t count = (size_t)(host->blocks[0] * host->blocks[1] * host->blocks[2]);
  stratus_value_range r = *host;
  r.lo = malloc(count * sizeof(float));
  r.hi = malloc(count * sizeof(float));
  r.gaps = malloc(count);
  assert_non_null(r.lo);
  assert_non_null(r.hi);
  assert_non_null(r.gaps);
  memset(r.lo, 0x55, count * sizeof(float));
  memset(r.hi, 0x55, count * sizeof(float));
  memset(r.gaps, 0x55, count);
  return r;
}

static void compare_ranges(const sample_volume* v, int size)
{
  stratus_value_range* host = NULL;
  assert_int_equal(stratus_value_range_create(host_context, &v->view, size, &host), STRATUS_OK);
  if (!stratus_device_takes_volume(device, &v->view)) {
    assert_true(stratus_type_is_wide(v->view.type)); /* small as it is, only the want of doubles may forbid it */
    stratus_value_range_destroy(host);
    return;
  }
  stratus_value_range r = blank_ranges(host);
  const size_t count = (size_t)(host->blocks[0] * host->blocks[1] * host->blocks[2]);
  if (stratus_device_value_range(device, &v->view, &r) != STRATUS_OK) {
    fail_msg("%s", stratus_context_message(device));
  }
  assert_memory_equal(r.lo, host->lo, count * sizeof(float));
  assert_memory_equal(r.hi, host->hi, count * sizeof(float));
  assert_memory_equal(r.gaps, host->gaps, count);
  assert_true(r.on_device);
  stratus_device_buffer_release(r.device_lo);
  stratus_device_buffer_release(r.device_hi);
  free(r.lo);
  free(r.hi);
  free(r.gaps);
  stratus_value_range_destroy(host);
}

static void value_ranges_of_every_type_equal_the_hosts(void** state)
{
  uint32_t random = 1;
  (void)state;
  for (int type = STRATUS_INT8; type <= STRATUS_FLOAT64; ++type) {
    for (int repeat = 0; repeat < (tiny ? 1 : 6); ++repeat) {
      sample_volume v = make_volume((stratus_type)type, 1 + random_below(&random, 9), 1 + random_below(&random, 9),
        1 + random_below(&random, 9), 1 + random_below(&random, 3), &random);
      compare_ranges(&v, 2 << random_below(&random, 3));
      spoil(&v, 5, &random);
      compare_ranges(&v, 2);
      free_volume(&v);
    }
    sample_volume v = make_volume((stratus_type)type, tiny ? 5 : 131, tiny ? 3 : 17, tiny ? 6 : 9, 1, &random);
    spoil(&v, 200, &random);
    compare_ranges(&v, 4);
    compare_ranges(&v, 32);
    free_volume(&v);
  }
}

static void compare_occupancy(const stratus_value_range* ranges, const stratus_transfer* transfer, bool gaps)
{
  const stratus_fetching fetching = stratus_value_range_fetching(ranges);
  stratus_shown shown;
  stratus_occupancy *host = NULL, filled;
  const size_t count = (size_t)(ranges->blocks[0] * ranges->blocks[1] * ranges->blocks[2]);
  assert_int_equal(stratus_shown_of_transfer(host_context, &fetching, transfer, &shown), STRATUS_OK);
  assert_int_equal(stratus_occupancy_build(host_context, ranges, &shown, gaps, &host), STRATUS_OK);
  filled = *host;
  filled.occupied = malloc(count);
  assert_non_null(filled.occupied);
  memset(filled.occupied, 0x55, count);
  const bool any = stratus_shown_meets(&shown, ranges->whole_lo, ranges->whole_hi);
  if (stratus_device_occupancy(device, ranges, &shown, gaps && any, &filled) != STRATUS_OK) {
    fail_msg("%s", stratus_context_message(device));
  }
  assert_memory_equal(filled.occupied, host->occupied, count);
  free(filled.occupied);
  stratus_occupancy_destroy(host);
  stratus_release(host_context, shown.of);
}

/* Blocks between two values, of ranges that the device has made, which it may keep. */
static void between_two_values_equals_the_hosts(void** state)
{
  static const double ends[][2] = { { 0.4, 0.6 }, { 0.3, 0.3 }, { -5.0, 0.001 }, { 0.999, 2.0 }, { 3.0, 4.0 } };
  uint32_t random = 4;
  (void)state;
  for (int keeps = 0; keeps < 2; ++keeps) {
    const stratus_type types[] = { STRATUS_FLOAT32, STRATUS_UINT8, STRATUS_INT32 };
    device->device->is_cpu = !keeps;
    for (size_t t = 0; t < COUNT_OF(types); ++t) {
      sample_volume v = make_volume(types[t], 33, 6, 7, 1, &random);
      stratus_value_range *host_ranges = NULL, *ranges = NULL;
      double low, high;
      spoil(&v, 20, &random);
      assert_int_equal(stratus_value_range_create(host_context, &v.view, 2, &host_ranges), STRATUS_OK);
      assert_int_equal(stratus_value_range_create(device, &v.view, 2, &ranges), STRATUS_OK);
      const int64_t* n = ranges->blocks;
      assert_true(ranges->on_device && (ranges->device_lo != NULL) == keeps);
      assert_int_equal(stratus_value_range_whole(ranges, &low, &high), STRATUS_OK);
      for (size_t e = 0; e < COUNT_OF(ends); ++e) {
        const double lower = low + ends[e][0] * (high - low), upper = low + ends[e][1] * (high - low);
        stratus_occupancy *expected = NULL, *got = NULL;
        assert_int_equal(stratus_occupancy_create_between(host_context, host_ranges, lower, upper, &expected), STRATUS_OK);
        const uint64_t launched = device->report.launched;
        assert_int_equal(stratus_occupancy_create_between(device, ranges, lower, upper, &got), STRATUS_OK);
        assert_int_equal(device->report.launched - launched, 1);
        assert_memory_equal(got->occupied, expected->occupied, (size_t)(n[0] * n[1] * n[2]));
        assert_int_equal(got->count, expected->count);
        assert_true(e > 0 || got->count > 0);
        stratus_occupancy_destroy(got);
        assert_int_equal(stratus_occupancy_create_between(device, host_ranges, lower, upper, &got), STRATUS_OK);
        assert_int_equal(device->report.launched - launched, 1); /* ranges that only the host has */
        stratus_occupancy_destroy(got);
        stratus_occupancy_destroy(expected);
      }
      stratus_value_range_destroy(host_ranges);
      stratus_value_range_destroy(ranges);
      free_volume(&v);
    }
  }
  device->device->is_cpu = true;
}

static void occupancy_equals_the_hosts(void** state)
{
  static const double white[4] = { 0, 1, 1, 1 };
  static const double opacity[][8] = { { -1, 0, 0.5, 0, 0.8, 0.4, 1, 1 }, { -1, 0, 0.41, 0, 0.411, 0.9, 0.412, 0 },
    { -1, 0, 0, 0, 0.5, 0, 1, 0 } };
  uint32_t random = 2;
  (void)state;
  for (int repeat = 0; repeat < 12; ++repeat) {
    sample_volume v = make_volume(
      STRATUS_FLOAT32, 1 + random_below(&random, 200), 1 + random_below(&random, 12), 1 + random_below(&random, 12), 1, &random);
    float* values = v.values;
    for (int64_t i = 0; i < v.view.dimensions[0] * v.view.dimensions[1] * v.view.dimensions[2]; ++i) {
      values[i] = values[i] > 0.9f ? values[i] : 0.01f * values[i]; /* mostly quiet: some blocks stay empty */
    }
    spoil(&v, 300, &random);
    stratus_value_range* ranges = NULL;
    assert_int_equal(stratus_value_range_create(host_context, &v.view, 2, &ranges), STRATUS_OK);
    for (size_t f = 0; f < sizeof opacity / sizeof *opacity && ranges->whole_lo <= ranges->whole_hi; ++f) {
      stratus_transfer transfer = stratus_transfer_default();
      transfer.opacity = opacity[f];
      transfer.opacity_count = 4;
      transfer.color = white;
      transfer.color_count = 1;
      compare_occupancy(ranges, &transfer, false);
      compare_occupancy(ranges, &transfer, true);
    }
    stratus_value_range_destroy(ranges);
    free_volume(&v);
  }
}

/* Returns the number of kernels that make a map. A processor sweeps planes, then along z; then it joins rows, or marks rows of the box of
 * occupied blocks and sweeps octants. A GPU sums along each axis, and searches each map. */
static uint64_t kernels_of_map(int kind, bool processor, bool has_box)
{
  if (kind == STRATUS_DISTANCE_PAPER) {
    return 5;
  }
  if (processor) {
    return kind == STRATUS_DISTANCE_FULL || !has_box ? 3 : 4;
  }
  return kind == STRATUS_DISTANCE_FULL ? 4 : 11;
}

static void compare_maps_of(stratus_occupancy* o)
{
  const int64_t nx = o->blocks[0];
  assert_true(stratus_device_takes_blocks(device, o->blocks));
  for (int which = 2 * STRATUS_DISTANCE_FULL; which < 2 * STRATUS_DISTANCE_OCTANT + 2; ++which) {
    const int kind = which / 2;
    device->device->is_cpu = which % 2; /* a processor has kernels of its own */
    stratus_distance_map *host = NULL, filled;
    assert_int_equal(stratus_distance_map_create(host_context, o, (stratus_distance_kind)kind, &host), STRATUS_OK);
    filled = *host;
    filled.bytes = malloc(host->bytes_size);
    assert_non_null(filled.bytes);
    memset(filled.bytes, 0x55, host->bytes_size);
    const uint64_t launched = device->report.launched;
    if (stratus_device_distance_map(device, o, &filled) != STRATUS_OK) {
      fail_msg("%s", stratus_context_message(device));
    }
    const bool has_box = o->count > 0 && o->count < nx * o->blocks[1] * o->blocks[2];
    assert_int_equal(device->report.launched - launched, kernels_of_map(kind, device->device->is_cpu, has_box));
    for (size_t row = 0; row < (host->bytes_size - 64) / host->pitch; ++row) {
      assert_memory_equal(filled.bytes + row * host->pitch, host->bytes + row * host->pitch, (size_t)nx);
    }
    free(filled.bytes);
    stratus_distance_map_destroy(host);
  }
  stratus_occupancy_destroy(o);
}

static void compare_maps(int64_t nx, int64_t ny, int64_t nz, int64_t fill, uint32_t* random)
{
  compare_maps_of(make_occupancy(host_context, nx, ny, nz, fill, random));
}

/* A solid box of occupied blocks within the grid: the nearest empty blocks are about it. */
static void compare_maps_of_box(const int64_t n[3], const int64_t lo[3], const int64_t hi[3])
{
  stratus_occupancy* o = NULL;
  uint8_t* bytes = malloc((size_t)(n[0] * n[1] * n[2]));
  assert_non_null(bytes);
  for (int64_t b = 0; b < n[0] * n[1] * n[2]; ++b) {
    const int64_t at[3] = { b % n[0], b / n[0] % n[1], b / (n[0] * n[1]) };
    bytes[b] = 0;
    for (int a = 0; a < 3; ++a) {
      bytes[b] |= at[a] < lo[a] || at[a] >= hi[a];
    }
  }
  assert_int_equal(stratus_occupancy_below(host_context, n, 4, bytes, 1, &o), STRATUS_OK);
  assert_true(o->count > 0);
  free(bytes);
  compare_maps_of(o);
}

static void distance_maps_equal_the_hosts(void** state)
{
  uint32_t random = 3;
  (void)state;
  for (int grid = 0; grid < (tiny ? 3 : 40); ++grid) {
    compare_maps(1 + random_below(&random, 9), 1 + random_below(&random, 9), 1 + random_below(&random, 9),
      grid < 6 ? grid % 3 : random_below(&random, 60), &random);
  }
  for (int box = 0; box < (tiny ? 1 : 12); ++box) {
    int64_t n[3], lo[3], hi[3];
    for (int a = 0; a < 3; ++a) {
      n[a] = 7 + random_below(&random, tiny ? 2 : 30);
      lo[a] = random_below(&random, 3);
      hi[a] = n[a] - random_below(&random, 3);
    }
    compare_maps_of_box(n, lo, hi);
  }
  if (tiny) {
    compare_maps(6, 5, 4, 20, &random);
    return;
  }
  compare_maps(70, 5, 3, 60, &random);
  compare_maps(3, 70, 5, 60, &random);
  compare_maps(300, 2, 1, 2, &random);
  compare_maps(300, 2, 1, 1, &random);
  compare_maps(40, 33, 29, 3000, &random);
  for (int grid = 0; grid < 8; ++grid) { /* rows without a byte behind their last block, most of them empty */
    compare_maps(64 << grid % 2, 2 + random_below(&random, 9), 2 + random_below(&random, 9), 700, &random);
  }
}

/* A device that was named builds, whatever it is; of the others only a GPU does. */
static void a_named_device_builds(void** state)
{
  stratus_device* other = NULL;
  (void)state;
  assert_false(stratus_device_builds(host_context));
  assert_true(stratus_device_builds(device));
  assert_int_equal(stratus_device_open_id(device, stratus_device_id(device->device), &other), STRATUS_OK);
  assert_int_equal(other->builds, !other->is_cpu);
  stratus_device_close(other);
}

int test_structures_device(void)
{
  if (no_device()) {
    return TEST_SKIPPED;
  }
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(value_ranges_of_every_type_equal_the_hosts),
    cmocka_unit_test(between_two_values_equals_the_hosts),
    cmocka_unit_test(occupancy_equals_the_hosts),
    cmocka_unit_test(distance_maps_equal_the_hosts),
    cmocka_unit_test(a_named_device_builds),
  };
  return cmocka_run_group_tests(tests, open_device, close_device);
}
