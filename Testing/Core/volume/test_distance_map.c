/* SPDX-License-Identifier: BSD-3-Clause
 * Distance maps compared with a search of every block. */
#include "structures.h"

static int64_t larger(int64_t a, int64_t b)
{
  return a > b ? a : b;
}

/* Returns the Chebyshev distance from block (i,j,k) to the nearest block of occupancy `target` on the side sides[a] along each axis a (0:
 * both sides), at most `best`. */
static int nearest(const stratus_occupancy* o, int target, const int sides[3], int64_t i, int64_t j, int64_t k, int64_t best)
{
  for (int64_t z = 0; z < o->blocks[2]; ++z) {
    for (int64_t y = 0; y < o->blocks[1]; ++y) {
      for (int64_t x = 0; x < o->blocks[0]; ++x) {
        const int64_t d[3] = { x - i, y - j, z - k };
        if (stratus_occupancy_get(o, x, y, z) != target || d[0] * sides[0] < 0 || d[1] * sides[1] < 0 || d[2] * sides[2] < 0) {
          continue;
        }
        const int64_t distance = larger(larger(llabs(d[0]), llabs(d[1])), llabs(d[2]));
        best = distance < best ? distance : best;
      }
    }
  }
  return (int)best;
}

static int expected_byte(const stratus_occupancy* o, stratus_distance_kind kind, int octant, int64_t i, int64_t j, int64_t k)
{
  static const int all[3] = { 0, 0, 0 };
  const int occupied = stratus_occupancy_get(o, i, j, k);
  if (kind == STRATUS_DISTANCE_BLOCK) {
    return occupied ? 129 : 1;
  }
  if (kind == STRATUS_DISTANCE_PAPER) {
    return nearest(o, 1, all, i, j, k, 255);
  }
  if (occupied) {
    return 128 + nearest(o, 0, all, i, j, k, 127);
  }
  const int sides[3] = { octant & 1 ? 1 : -1, octant & 2 ? 1 : -1, octant & 4 ? 1 : -1 };
  return nearest(o, 1, kind == STRATUS_DISTANCE_OCTANT ? sides : all, i, j, k, 127);
}

static void check_map(const stratus_occupancy* o, const stratus_distance_map* map)
{
  const int octants = map->kind == STRATUS_DISTANCE_OCTANT ? 8 : 1;
  assert_int_equal(map->pitch % 64, 0);
  assert_true(map->pitch >= (size_t)o->blocks[0]);
  assert_int_equal(map->map_bytes, map->pitch * (size_t)(o->blocks[1] * o->blocks[2]));
  assert_int_equal(map->bytes_size, (size_t)octants * map->map_bytes + 64);
  assert_int_equal(stratus_distance_map_bytes(map), map->bytes_size);
  for (int octant = 0; octant < octants; ++octant) {
    for (int64_t k = 0; k < o->blocks[2]; ++k) {
      for (int64_t j = 0; j < o->blocks[1]; ++j) {
        for (int64_t i = 0; i < o->blocks[0]; ++i) {
          const int expected = expected_byte(o, map->kind, octant, i, j, k);
          const size_t at = (size_t)octant * map->map_bytes + (size_t)(k * o->blocks[1] + j) * map->pitch + (size_t)i;
          if (map->bytes[at] != expected) {
            fail_msg("kind %d octant %d block %d,%d,%d of %dx%dx%d: %d, not %d", (int)map->kind, octant, (int)i, (int)j, (int)k,
              (int)o->blocks[0], (int)o->blocks[1], (int)o->blocks[2], map->bytes[at], expected);
          }
          const bool is_distance = expected < 128 || map->kind == STRATUS_DISTANCE_PAPER;
          assert_int_equal(stratus_distance_map_get(map, octant, i, j, k), is_distance ? expected : 0);
        }
      }
    }
  }
}

static void check_kinds(stratus_context* context, int64_t nx, int64_t ny, int64_t nz, int64_t fill, uint32_t* random)
{
  stratus_occupancy* o = make_occupancy(context, nx, ny, nz, fill, random);
  for (int kind = STRATUS_DISTANCE_BLOCK; kind <= STRATUS_DISTANCE_OCTANT; ++kind) {
    stratus_distance_map* map = NULL;
    assert_int_equal(stratus_distance_map_create(context, o, (stratus_distance_kind)kind, &map), STRATUS_OK);
    check_map(o, map);
    stratus_distance_map_destroy(map);
  }
  stratus_occupancy_destroy(o);
}

static void every_kind_equals_brute_force_on_small_grids(void** state)
{
  uint32_t random = 1;
  (void)state;
  for (int threads = 1; threads <= 3; ++threads) {
    stratus_context* context = make_context("host", threads);
    for (int grid = 0; grid < 120; ++grid) {
      const int64_t nx = 1 + random_below(&random, 9), ny = 1 + random_below(&random, 9), nz = 1 + random_below(&random, 9);
      check_kinds(context, nx, ny, nz, grid < 6 ? grid % 3 : random_below(&random, 60), &random);
    }
    stratus_context_destroy(context);
  }
}

static void rows_longer_than_the_pitch_keep_their_ends(void** state)
{
  static const int64_t sizes[][3] = { { 70, 5, 3 }, { 64, 3, 4 }, { 65, 4, 2 }, { 3, 70, 5 }, { 4, 3, 67 }, { 129, 2, 2 } };
  uint32_t random = 2;
  (void)state;
  stratus_context* context = make_context("host", 2);
  for (size_t s = 0; s < sizeof sizes / sizeof *sizes; ++s) {
    static const int64_t fills[] = { 0, 1, 2, 3, 40, 400 };
    for (size_t f = 0; f < sizeof fills / sizeof *fills; ++f) {
      check_kinds(context, sizes[s][0], sizes[s][1], sizes[s][2], fills[f], &random);
    }
  }
  stratus_context_destroy(context);
}

static void distances_beyond_127_are_127(void** state)
{
  static const int64_t sizes[][3] = { { 300, 2, 1 }, { 1, 290, 2 }, { 2, 1, 280 } };
  uint32_t random = 3;
  (void)state;
  stratus_context* context = make_context("host", 2);
  for (size_t s = 0; s < sizeof sizes / sizeof *sizes; ++s) {
    for (int repeat = 0; repeat < 4; ++repeat) {
      check_kinds(context, sizes[s][0], sizes[s][1], sizes[s][2], 2, &random);
    }
  }
  stratus_context_destroy(context);
}

/* One occupied block at the end of a row of 300, along each axis. The paper's map contains distances to 255, the other maps to 127. */
static void the_papers_map_has_distances_to_255(void** state)
{
  uint32_t random = 9;
  (void)state;
  stratus_context* context = make_context("host", 2);
  for (int axis = 0; axis < 3; ++axis) {
    int64_t n[3] = { 1, 1, 1 };
    n[axis] = 301;
    stratus_occupancy* o = make_occupancy(context, n[0], n[1], n[2], 0, &random);
    o->occupied[0] = 1;
    o->count = o->hi[0] = o->hi[1] = o->hi[2] = 1;
    o->lo[0] = o->lo[1] = o->lo[2] = 0;
    for (int kind = STRATUS_DISTANCE_FULL; kind <= STRATUS_DISTANCE_PAPER; ++kind) {
      const int most = kind == STRATUS_DISTANCE_PAPER ? 255 : 127;
      stratus_distance_map* map = NULL;
      assert_int_equal(stratus_distance_map_create(context, o, (stratus_distance_kind)kind, &map), STRATUS_OK);
      for (int i = 0; i <= 300; ++i) {
        const int distance = stratus_distance_map_get(map, 0, axis == 0 ? i : 0, axis == 1 ? i : 0, axis == 2 ? i : 0);
        assert_int_equal(distance, i < most ? i : most);
      }
      check_map(o, map);
      stratus_distance_map_destroy(map);
    }
    stratus_occupancy_destroy(o);
  }
  stratus_context_destroy(context);
}

static void a_deep_block_of_occupied_ones_knows_its_depth(void** state)
{
  (void)state;
  uint32_t random = 4;
  stratus_context* context = make_context("host", 2);
  stratus_occupancy* o = make_occupancy(context, 11, 11, 11, 1, &random);
  o->occupied[0] = 0; /* the only empty block gives every other one its depth */
  --o->count;
  stratus_distance_map* map = NULL;
  assert_int_equal(stratus_distance_map_create(context, o, STRATUS_DISTANCE_FULL, &map), STRATUS_OK);
  assert_int_equal(map->bytes[(10 * 11 + 10) * 64 + 10], 128 + 10);
  check_map(o, map);
  stratus_distance_map_destroy(map);
  stratus_occupancy_destroy(o);
  stratus_context_destroy(context);
}

/* A solid box, at every place that leaves 0..2 empty layers on each side: its depth counts from all six sides. */
static void a_solid_box_knows_its_depth_from_every_side(void** state)
{
  uint32_t random = 8;
  (void)state;
  stratus_context* context = make_context("host", 2);
  for (int64_t place = 0; place < 729; place += 7) {
    const int64_t lo[3] = { place % 3, place / 3 % 3, place / 9 % 3 }, hi[3] = { 8 - place / 27 % 3, 8 - place / 81 % 3, 8 - place / 243 };
    stratus_occupancy* o = make_occupancy(context, 8, 8, 8, 0, &random);
    for (int64_t b = 0; b < 512; ++b) {
      const int64_t at[3] = { b % 8, b / 8 % 8, b / 64 };
      o->occupied[b] = at[0] >= lo[0] && at[0] < hi[0] && at[1] >= lo[1] && at[1] < hi[1] && at[2] >= lo[2] && at[2] < hi[2];
      o->count += o->occupied[b];
    }
    memcpy(o->lo, lo, sizeof lo);
    memcpy(o->hi, hi, sizeof hi);
    stratus_distance_map* map = NULL;
    for (int kind = STRATUS_DISTANCE_FULL; kind <= STRATUS_DISTANCE_OCTANT; ++kind) {
      assert_int_equal(stratus_distance_map_create(context, o, (stratus_distance_kind)kind, &map), STRATUS_OK);
      check_map(o, map);
      stratus_distance_map_destroy(map);
    }
    stratus_occupancy_destroy(o);
  }
  stratus_context_destroy(context);
}

static void the_sweeps_and_the_papers_transform_agree_on_larger_grids(void** state)
{
  uint32_t random = 5;
  (void)state;
  stratus_context* context = make_context("host", 2);
  for (int64_t fill = 2; fill < 200000; fill *= 20) {
    stratus_occupancy* o = make_occupancy(context, 75, 60, 50, fill == 2 ? 2 : fill, &random);
    stratus_distance_map *full = NULL, *paper = NULL;
    assert_int_equal(stratus_distance_map_create(context, o, STRATUS_DISTANCE_FULL, &full), STRATUS_OK);
    assert_int_equal(stratus_distance_map_create(context, o, STRATUS_DISTANCE_PAPER, &paper), STRATUS_OK);
    assert_int_equal(full->bytes_size, paper->bytes_size);
    for (size_t b = 0; b < full->map_bytes; ++b) { /* the paper's map has 0 for occupied blocks */
      assert_int_equal(paper->bytes[b] < 127 ? paper->bytes[b] : 127, full->bytes[b] < 128 ? full->bytes[b] : 0);
    }
    stratus_distance_map_destroy(full);
    stratus_distance_map_destroy(paper);
    stratus_occupancy_destroy(o);
  }
  stratus_context_destroy(context);
}

static void threads_do_not_show_in_the_bytes(void** state)
{
  uint32_t random = 6;
  (void)state;
  stratus_context *one = make_context("host", 1), *many = make_context("host", 7);
  stratus_occupancy* o = make_occupancy(one, 40, 30, 20, 300, &random);
  for (int kind = STRATUS_DISTANCE_BLOCK; kind <= STRATUS_DISTANCE_OCTANT; ++kind) {
    stratus_distance_map *a = NULL, *b = NULL;
    assert_int_equal(stratus_distance_map_create(one, o, (stratus_distance_kind)kind, &a), STRATUS_OK);
    assert_int_equal(stratus_distance_map_create(many, o, (stratus_distance_kind)kind, &b), STRATUS_OK);
    assert_memory_equal(a->bytes, b->bytes, a->bytes_size);
    stratus_distance_map_destroy(a);
    stratus_distance_map_destroy(b);
  }
  stratus_occupancy_destroy(o);
  stratus_context_destroy(one);
  stratus_context_destroy(many);
}

static void wrong_arguments_are_refused_with_a_reason(void** state)
{
  uint32_t random = 7;
  (void)state;
  stratus_context* context = make_context("host", 1);
  stratus_occupancy* o = make_occupancy(context, 2, 2, 2, 2, &random);
  stratus_distance_map* map = NULL;
  assert_int_equal(stratus_distance_map_create(NULL, o, STRATUS_DISTANCE_FULL, &map), STRATUS_INVALID_ARGUMENT);
  assert_int_equal(stratus_distance_map_create(context, NULL, STRATUS_DISTANCE_FULL, &map), STRATUS_INVALID_ARGUMENT);
  assert_int_equal(stratus_distance_map_create(context, o, STRATUS_DISTANCE_FULL, NULL), STRATUS_INVALID_ARGUMENT);
  assert_int_equal(stratus_distance_map_create(context, o, (stratus_distance_kind)4, &map), STRATUS_INVALID_ARGUMENT);
  assert_non_null(strstr(stratus_context_message(context), "4"));
  assert_null(map);
  stratus_distance_map_destroy(NULL);
  stratus_occupancy_destroy(o);
  stratus_context_destroy(context);
}

int test_distance_map(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(every_kind_equals_brute_force_on_small_grids),
    cmocka_unit_test(rows_longer_than_the_pitch_keep_their_ends),
    cmocka_unit_test(distances_beyond_127_are_127),
    cmocka_unit_test(the_papers_map_has_distances_to_255),
    cmocka_unit_test(a_deep_block_of_occupied_ones_knows_its_depth),
    cmocka_unit_test(a_solid_box_knows_its_depth_from_every_side),
    cmocka_unit_test(the_sweeps_and_the_papers_transform_agree_on_larger_grids),
    cmocka_unit_test(threads_do_not_show_in_the_bytes),
    cmocka_unit_test(wrong_arguments_are_refused_with_a_reason),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
