/* SPDX-License-Identifier: BSD-3-Clause
 * Effective voxels: exactly those that the criterion shows, whatever the type, stride, centring, ghosts and threads. */
#include "faulty_allocator.h"
#include "reference.h"
#include "structures.h"
#include "volume_hash.h"
#include "voxels.h"

static const double white[4] = { 0, 1, 1, 1 };

static stratus_transfer transfer_of(const double* opacity, size_t count, int clamp)
{
  stratus_transfer t = stratus_transfer_default();
  t.opacity = opacity;
  t.opacity_count = count;
  t.color = white;
  t.color_count = 1;
  t.clamp = clamp;
  return t;
}

/* Opacity between two points is above 0 if it is at either. At a point the last one there counts. */
static bool transfer_shows(const stratus_transfer* t, double x)
{
  const double* p = t->opacity;
  const size_t n = t->opacity_count;
  if (x < p[0]) {
    return t->clamp && p[1] > 0.0;
  }
  if (x > p[2 * n - 2]) {
    return t->clamp && p[2 * n - 1] > 0.0;
  }
  size_t last = 0;
  while (last + 1 < n && p[2 * last + 2] <= x) {
    ++last;
  }
  return p[2 * last + 1] > 0.0 || (x > p[2 * last] && p[2 * last + 3] > 0.0);
}

static bool criterion_shows(const stratus_criterion* c, double x)
{
  return c->transfer ? transfer_shows(c->transfer, x) : x >= c->lower && x <= c->upper;
}

static bool is_effective(const stratus_volume* v, const stratus_criterion* c, int64_t at)
{
  const uint8_t flags = v->cell_centered ? (v->cell_ghosts ? v->cell_ghosts[at] : 0) : (v->point_ghosts ? v->point_ghosts[at] : 0);
  const unsigned out = STRATUS_GHOST_DUPLICATE | (v->cell_centered ? STRATUS_GHOST_HIDDEN_CELL : STRATUS_GHOST_HIDDEN_POINT);
  const double x = reference_value_at(v, at);
  return isfinite(x) && !(flags & out) && criterion_shows(c, x);
}

/* Checks that counts and bounds of the set agree with its bricks, and that these are in order. */
static void check_consistent(const stratus_voxels* s)
{
  int64_t count = 0, lo[3] = { 0 }, hi[3] = { 0 }, low[3], high[3];
  for (int64_t b = 0; b < s->brick_count; ++b) {
    const stratus_brick* k = s->bricks + b;
    assert_true(k->mask != 0 && k->count == __builtin_popcountll(k->mask));
    if (b > 0) {
      const stratus_brick* p = k - 1;
      assert_true(((uint64_t)p->at[2] << 32 | (uint64_t)p->at[1] << 16 | p->at[0]) <
        ((uint64_t)k->at[2] << 32 | (uint64_t)k->at[1] << 16 | k->at[0]));
    }
    for (int bit = 0; bit < 64; ++bit) {
      if (k->mask >> bit & 1) {
        const int64_t at[3] = { 4 * k->at[0] + (bit & 3), 4 * k->at[1] + (bit >> 2 & 3), 4 * k->at[2] + (bit >> 4) };
        for (int a = 0; a < 3; ++a) {
          lo[a] = count == 0 || at[a] < lo[a] ? at[a] : lo[a];
          hi[a] = at[a] >= hi[a] ? at[a] + 1 : hi[a];
        }
        assert_int_equal(stratus_voxels_get(s, at[0], at[1], at[2]), 1);
        ++count;
      }
    }
  }
  stratus_voxels_bounds(s, low, high);
  assert_memory_equal(low, lo, sizeof lo);
  assert_memory_equal(high, hi, sizeof hi);
  assert_int_equal(stratus_voxels_count(s), count);
}

static void check_volume(stratus_context* const contexts[3], const stratus_volume* v, const stratus_criterion* criterion, int64_t* shown)
{
  stratus_voxels* s[3] = { NULL, NULL, NULL };
  const int64_t* n = v->dimensions;
  int64_t dimensions[3], count = 0;
  for (int t = 0; t < 3; ++t) {
    assert_int_equal(stratus_voxels_create(contexts[t], v, criterion, &s[t]), STRATUS_OK);
    assert_int_equal(s[t]->brick_count, s[0]->brick_count);
    assert_memory_equal(s[t]->bricks, s[0]->bricks, (size_t)s[0]->brick_count * sizeof *s[0]->bricks);
    assert_memory_equal(&s[t]->origin, &s[0]->origin, sizeof s[0]->origin);
  }
  for (int64_t i = 0; i < n[0] * n[1] * n[2]; ++i) {
    const bool expected = is_effective(v, criterion, i);
    assert_int_equal(stratus_voxels_get(s[0], i % n[0], i / n[0] % n[1], i / n[0] / n[1]), expected);
    count += expected;
  }
  assert_int_equal(stratus_voxels_count(s[0]), count);
  assert_int_equal(stratus_voxels_get(s[0], -1, 0, 0), 0);
  assert_int_equal(stratus_voxels_get(s[0], 0, n[1], 0), 0);
  stratus_voxels_dimensions(s[0], dimensions);
  assert_memory_equal(dimensions, n, sizeof dimensions);
  check_consistent(s[0]);
  *shown += count;
  for (int t = 0; t < 3; ++t) {
    stratus_voxels_destroy(s[t]);
  }
}

/* A value of the volume, so that ends of intervals fall on values. */
static double some_value(const stratus_volume* v, uint32_t* random)
{
  const int64_t count = v->dimensions[0] * v->dimensions[1] * v->dimensions[2];
  const double x = reference_value_at(v, random_below(random, count));
  return isfinite(x) ? x : 0.0;
}

static int compare(const void* a, const void* b)
{
  const double x = *(const double*)a, y = *(const double*)b;
  return (x > y) - (x < y);
}

/* Points at values of the volume, some twice, many without opacity. */
static void random_points(const stratus_volume* v, size_t count, double (*points)[2], uint32_t* random)
{
  for (size_t i = 0; i < count; ++i) {
    points[i][0] = i > 0 && random_below(random, 4) == 0 ? points[i - 1][0] : some_value(v, random);
  }
  qsort(points, count, sizeof *points, compare);
  for (size_t i = 0; i < count; ++i) {
    points[i][1] = random_below(random, 3) ? 0.0 : (double)(1 + random_below(random, 100)) / 100.0;
  }
}

static void every_type_is_compared_exactly(void** state)
{
  static const int64_t sizes[][3] = { { 1, 1, 1 }, { 5, 4, 3 }, { 9, 1, 6 }, { 70, 3, 5 }, { 1, 130, 2 } };
  uint32_t random = 11;
  int64_t shown = 0;
  (void)state;
  stratus_context* contexts[3] = { make_context("host", 1), make_context("host", 2), make_context("host", 3) };
  for (int pass = 0; pass < 10 * 5 * 8; ++pass) {
    const int64_t* n = sizes[pass / 10 % 5];
    sample_volume v = make_volume((stratus_type)(pass % 10), n[0], n[1], n[2], 1 + random_below(&random, 2), &random);
    if (random_below(&random, 2)) {
      spoil(&v, 5, &random);
    }
    if (random_below(&random, 3) == 0) {
      add_ghosts(&v, (int)random_below(&random, 2), 1 + random_below(&random, 3), &random);
      for (int64_t i = 0; i < n[0] * n[1] * n[2]; ++i) { /* most are plain */
        v.point_ghosts[i] = random_below(&random, 3) ? 0 : v.point_ghosts[i];
        v.cell_ghosts[i] = random_below(&random, 3) ? 0 : v.cell_ghosts[i];
      }
    }
    stratus_criterion c = stratus_criterion_default();
    check_volume(contexts, &v.view, &c, &shown);
    c.lower = some_value(&v.view, &random);
    check_volume(contexts, &v.view, &c, &shown);
    c.upper = c.lower;
    check_volume(contexts, &v.view, &c, &shown);
    double points[300][2];
    const size_t count = (size_t)(1 + random_below(&random, pass % 7 == 0 ? 300 : 5)); /* now and then more intervals than are kept */
    random_points(&v.view, count, points, &random);
    const stratus_transfer transfer = transfer_of(points[0], count, (int)random_below(&random, 2));
    c.transfer = &transfer;
    check_volume(contexts, &v.view, &c, &shown);
    free_volume(&v);
  }
  assert_true(shown > 50000);
  for (int t = 0; t < 3; ++t) {
    stratus_context_destroy(contexts[t]);
  }
}

/* The floats next to each end, which differ from it only in the last digit. */
static void ends_of_intervals_are_in_and_feet_of_ramps_are_out(void** state)
{
  static const double ramp[] = { 0.25, 0.0, 0.5, 1.0, 0.75, 0.0 };
  static const double step[] = { 0.5, 0.0, 0.5, 1.0 };
  static const struct {
    const double* points;
    size_t count;
    int clamp;
    float value;
    int shown;
  } cases[] = {
    { ramp, 3, 1, .25f, 0 },
    { ramp, 3, 1, .75f, 0 },
    { ramp, 3, 1, .25000003f, 1 },
    { ramp, 3, 1, .7499999f, 1 },
    { ramp, 3, 1, .5f, 1 },
    { step, 2, 1, .49999997f, 0 },
    { step, 2, 1, .5f, 1 },
    { step, 2, 1, 9.f, 1 },
    { step, 2, 0, .5f, 1 },
    { step, 2, 0, .50000006f, 0 },
    { NULL, 0, 0, .25f, 1 },
    { NULL, 0, 0, .75f, 1 },
    { NULL, 0, 0, .24999999f, 0 },
    { NULL, 0, 0, .75000006f, 0 },
  };
  (void)state;
  stratus_context* context = make_context("host", 1);
  for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i) {
    const stratus_transfer transfer = transfer_of(cases[i].points, cases[i].count, cases[i].clamp);
    const stratus_criterion c = { .transfer = cases[i].points ? &transfer : NULL, .lower = .25, .upper = .75 };
    stratus_volume v = stratus_volume_default();
    stratus_voxels* s = NULL;
    v.values = &cases[i].value;
    assert_int_equal(stratus_voxels_create(context, &v, &c, &s), STRATUS_OK);
    assert_int_equal(stratus_voxels_count(s), cases[i].shown);
    stratus_voxels_destroy(s);
  }
  stratus_context_destroy(context);
}

/* Dense lists, and lists so sparse that bricks are sorted, with duplicates: the set holds exactly the positions. */
static void a_list_makes_the_set_of_its_positions(void** state)
{
  static const int64_t sizes[][3] = { { 1, 1, 1 }, { 9, 5, 7 }, { 64, 64, 64 }, { 1 << 18, 1 << 18, 1 << 18 }, { 1 << 18, 3, 1 << 10 },
    { 1000, 1, 300000 - 1 } };
  uint32_t random = 2;
  (void)state;
  for (int pass = 0; pass < 60; ++pass) {
    int64_t n[3] = { sizes[pass % 6][0], sizes[pass % 6][1], sizes[pass % 6][2] < 1 << 18 ? sizes[pass % 6][2] : 1 << 18 };
    const size_t count = (size_t)random_below(&random, 400);
    int32_t positions[3 * 400];
    for (size_t i = 0; i < 3 * count; ++i) {
      positions[i] = (int32_t)(random_below(&random, 1 << 24) % n[i % 3]);
      if (i >= 30 && random_below(&random, 3)) { /* near another, or the very same */
        const int64_t near = positions[i - 30] + random_below(&random, 3) - 1;
        positions[i] = (int32_t)(near < 0 ? 0 : near >= n[i % 3] ? n[i % 3] - 1 : near);
      }
    }
    stratus_voxels* s[2] = { NULL, NULL };
    for (int t = 0; t < 2; ++t) {
      stratus_context* context = make_context("host", 1 + 2 * t);
      assert_int_equal(stratus_voxels_create_list(context, n, positions, count, &s[t]), STRATUS_OK);
      check_consistent(s[t]);
      int64_t distinct = 0;
      for (size_t i = 0; i < count; ++i) {
        const int32_t* p = positions + 3 * i;
        size_t first = 0;
        while (memcmp(positions + 3 * first, p, 3 * sizeof *p) != 0) {
          ++first;
        }
        distinct += first == i;
        assert_int_equal(stratus_voxels_get(s[t], p[0], p[1], p[2]), 1);
      }
      assert_int_equal(stratus_voxels_count(s[t]), distinct);
      assert_true(s[t]->index_to_world[3] == 0.5 && s[t]->index_to_world[0] == 1.0 && s[t]->origin.hash == 0);
      stratus_voxels_destroy(s[t]);
      stratus_context_destroy(context);
    }
  }
}

/* Threads share a sparse list's sorted keys: a brick whose voxels fall to several of them is still one. */
static void any_number_of_threads_sorts_a_sparse_list_alike(void** state)
{
  enum { BRICKS = 3000, MOST = 2 * 64 * BRICKS };
  static int32_t positions[MOST][3];
  const int64_t n[3] = { 1 << 18, 1 << 17, 1 << 18 };
  uint32_t random = 4;
  size_t count = 0;
  int64_t distinct = 0;
  (void)state;
  for (int b = 0; b < BRICKS; ++b) {
    /* no two are at the same x; many are in a row */
    const int32_t at[3] = { 4 * (b * 21), 4 * (int32_t)random_below(&random, 3), 4 * (int32_t)random_below(&random, 1 << 16) };
    const int voxels = b % 7 ? 1 + (int)random_below(&random, 64) : 64;
    for (int v = 0; v < 2 * voxels; ++v) { /* each is listed twice */
      const int bit = v % voxels;
      positions[count][0] = at[0] + (bit & 3);
      positions[count][1] = at[1] + (bit >> 2 & 3);
      positions[count++][2] = at[2] + (bit >> 4);
    }
    distinct += voxels;
  }
  for (size_t i = count - 1; i > 0; --i) {
    const size_t other = (size_t)random_below(&random, (uint32_t)i + 1);
    int32_t kept[3];
    memcpy(kept, positions[i], sizeof kept);
    memcpy(positions[i], positions[other], sizeof kept);
    memcpy(positions[other], kept, sizeof kept);
  }
  for (int threads = 1; threads <= 9; threads += 2) {
    stratus_context* context = make_context("host", threads);
    stratus_voxels* s = NULL;
    assert_int_equal(stratus_voxels_create_list(context, n, positions[0], count, &s), STRATUS_OK);
    check_consistent(s);
    assert_int_equal(s->brick_count, BRICKS);
    assert_int_equal(stratus_voxels_count(s), distinct);
    for (size_t i = 0; i < count; i += 97) {
      assert_int_equal(stratus_voxels_get(s, positions[i][0], positions[i][1], positions[i][2]), 1);
    }
    stratus_voxels_destroy(s);
    stratus_context_destroy(context);
  }
}

/* ---------------------------------------------------------------- cells */

static int block_in(const stratus_voxels* s, int64_t i, int64_t j, int64_t k)
{
  const uint64_t mask = stratus_voxels_mask(s, i, j, k);
  assert_true(mask == 0 || mask == ~UINT64_C(0));
  return mask != 0;
}

/* Smooth fields with empty space of one value, like real data. */
static void smooth_values(sample_volume* v, uint32_t* random)
{
  const int64_t* n = v->view.dimensions;
  const double x0 = (double)random_below(random, 100) / 10.0, y0 = (double)random_below(random, 100) / 10.0;
  for (int64_t i = 0; i < n[0] * n[1] * n[2]; ++i) {
    const double f = sin((double)(i % n[0]) * .23 + x0) + cos((double)(i / n[0] % n[1]) * .31 + y0) + sin((double)(i / n[0] / n[1]) * .2);
    ((float*)v->values)[i] = f > 0.5 ? (float)(f - 0.5) : 0.0f;
  }
}

static void blocks_that_either_sampling_shows_are_there_and_few_others(void** state)
{
  uint32_t random = 9;
  int64_t occupied = 0, extra = 0, empty = 0;
  (void)state;
  stratus_context* context = make_context("host", 2);
  for (int pass = 0; pass < 40; ++pass) {
    sample_volume v = make_volume(STRATUS_FLOAT32, 33, 18, 26, 1, &random);
    double points[8][2] = { { 0.0, 0.0 } };
    smooth_values(&v, &random);
    if (pass % 4 == 3) {
      spoil(&v, 500, &random);
    }
    random_points(&v.view, 5, points + 1, &random);
    points[0][0] = -1.0;
    for (int p = 1; p < 6; ++p) {
      points[p][1] = points[p][0] > 0.0 ? points[p][1] : 0.0;
    }
    const stratus_transfer transfer = transfer_of(points[0], 6, 1);
    const stratus_criterion c = { .transfer = &transfer };
    stratus_voxels* s = NULL;
    stratus_value_range* ranges = NULL;
    stratus_occupancy* o[2];
    int64_t blocks[3], dimensions[3];
    assert_int_equal(stratus_voxels_create_cells(context, &v.view, &c, &s), STRATUS_OK);
    assert_int_equal(stratus_value_range_create(context, &v.view, 4, &ranges), STRATUS_OK);
    for (int i = 0; i < 2; ++i) {
      assert_int_equal(
        stratus_occupancy_create(context, ranges, &transfer, i ? STRATUS_SAMPLING_PREINTEGRATED : STRATUS_SAMPLING_MIDPOINT, &o[i]),
        STRATUS_OK);
    }
    stratus_value_range_blocks(ranges, blocks, NULL);
    stratus_voxels_dimensions(s, dimensions);
    for (int a = 0; a < 3; ++a) {
      assert_int_equal(dimensions[a], 4 * blocks[a]);
    }
    check_consistent(s);
    for (int64_t b = 0; b < blocks[0] * blocks[1] * blocks[2]; ++b) {
      const int64_t i = b % blocks[0], j = b / blocks[0] % blocks[1], k = b / blocks[0] / blocks[1];
      const int shown = stratus_occupancy_get(o[0], i, j, k) || stratus_occupancy_get(o[1], i, j, k);
      const int here = block_in(s, i, j, k);
      assert_true(here || !shown);
      occupied += shown;
      extra += here && !shown;
      empty += !here;
    }
    /* Voxel (0,0,0) is the first cell, whose middle is half a step in. */
    assert_true(s->index_to_world[3] == 0.5 && s->index_to_world[7] == 0.5 && s->index_to_world[11] == 0.5);
    stratus_occupancy_destroy(o[0]);
    stratus_occupancy_destroy(o[1]);
    stratus_value_range_destroy(ranges);
    stratus_voxels_destroy(s);
    free_volume(&v);
  }
  assert_true(occupied > 1000 && empty > 1000 && extra * 200 <= occupied);
  stratus_context_destroy(context);
}

static void an_interval_of_cells_keeps_each_block_whose_range_meets_it(void** state)
{
  uint32_t random = 21;
  (void)state;
  stratus_context* context = make_context("host", 2);
  for (int type = 0; type < 10; ++type) {
    sample_volume v = make_volume((stratus_type)type, 13, 9, 6, 2, &random);
    spoil(&v, 50, &random);
    stratus_value_range* ranges = NULL;
    stratus_voxels* s = NULL;
    stratus_criterion c = stratus_criterion_default();
    int64_t blocks[3];
    double whole_hi;
    c.lower = some_value(&v.view, &random);
    assert_int_equal(stratus_voxels_create_cells(context, &v.view, &c, &s), STRATUS_OK);
    assert_int_equal(stratus_value_range_create(context, &v.view, 4, &ranges), STRATUS_OK);
    stratus_value_range_blocks(ranges, blocks, NULL);
    assert_int_equal(stratus_value_range_whole(ranges, NULL, &whole_hi), STRATUS_OK);
    for (int64_t b = 0; b < blocks[0] * blocks[1] * blocks[2]; ++b) {
      const int64_t i = b % blocks[0], j = b / blocks[0] % blocks[1], k = b / blocks[0] / blocks[1];
      double lo, hi;
      int gaps;
      stratus_value_range_block(ranges, i, j, k, &lo, &hi, &gaps);
      if ((gaps && whole_hi >= c.lower) || (lo <= hi && hi >= c.lower)) {
        assert_true(block_in(s, i, j, k));
      } else if (hi < c.lower - 1e-5 * (fabs(hi) + fabs(c.lower))) { /* ten times what a fetched value is rounded by */
        assert_false(block_in(s, i, j, k));
      }
    }
    stratus_voxels_destroy(s);
    stratus_value_range_destroy(ranges);
    free_volume(&v);
  }
  stratus_context_destroy(context);
}

/* ---------------------------------------------------------------- coverage */

static void a_set_that_covers_another_holds_all_of_it(void** state)
{
  uint32_t random = 31;
  int64_t covered = 0, refused = 0;
  (void)state;
  stratus_context* context = make_context("host", 1);
  sample_volume v = make_volume(STRATUS_FLOAT32, 33, 18, 26, 1, &random);
  smooth_values(&v, &random);
  for (int pass = 0; pass < 300; ++pass) {
    double points[2][6][2];
    stratus_transfer transfers[2];
    stratus_criterion c[2];
    stratus_voxels* s[2] = { NULL, NULL };
    random_points(&v.view, 6, points[0], &random);
    memcpy(points[1], points[0], sizeof points[0]);
    for (int p = 0; p < 6; ++p) { /* mostly a part of the first, over other points */
      points[1][p][1] = random_below(&random, 3) ? points[1][p][1] : 0.0;
      points[1][p][0] += random_below(&random, 4) ? 0.0 : 1e-5;
    }
    qsort(points[1], 6, sizeof points[1][0], compare);
    for (int i = 0; i < 2; ++i) {
      transfers[i] = transfer_of(points[i][0], 6, 1);
      c[i] = (stratus_criterion){ .transfer = &transfers[i] };
      if (i == 0 && pass % 3 == 0) {
        c[i] = stratus_criterion_default();
        c[i].lower = some_value(&v.view, &random) / 4.0;
      }
      assert_int_equal(stratus_voxels_create_cells(context, &v.view, &c[i], &s[i]), STRATUS_OK);
    }
    stratus_origin wanted = { .hash = s[1]->origin.hash };
    assert_int_equal(stratus_criterion_intervals(context, &v.view, &c[1], 1, &wanted), STRATUS_OK);
    assert_memory_equal(&wanted, &s[1]->origin, sizeof wanted); /* asked beforehand or kept with the set: the same */
    assert_int_equal(stratus_origin_covers(&s[1]->origin, &wanted), 1);
    const int covers = stratus_origin_covers(&s[0]->origin, &wanted);
    covered += covers;
    refused += !covers;
    for (int64_t b = 0; covers && b < s[1]->brick_count; ++b) {
      assert_true(stratus_voxels_mask(s[0], s[1]->bricks[b].at[0], s[1]->bricks[b].at[1], s[1]->bricks[b].at[2]) != 0);
    }
    stratus_voxels_destroy(s[0]);
    stratus_voxels_destroy(s[1]);
  }
  assert_true(covered > 30 && refused > 30);
  free_volume(&v);
  stratus_context_destroy(context);
}

static void only_the_same_voxels_stand_in_for_first_hits(void** state)
{
  const float values[2] = { 0.0f, 1.0f };
  double comb[200][2];
  (void)state;
  stratus_context* context = make_context("host", 1);
  stratus_volume v = stratus_volume_default();
  stratus_origin a = { .hash = 5 }, b = { .hash = 5 };
  stratus_criterion c = stratus_criterion_default();
  v.values = values;
  v.dimensions[0] = 2;
  c.lower = 0.5;
  assert_int_equal(stratus_criterion_intervals(context, &v, &c, 0, &a), STRATUS_OK);
  assert_int_equal(stratus_criterion_intervals(context, &v, &c, 0, &b), STRATUS_OK);
  assert_int_equal(stratus_origin_covers(&a, &b), 1);
  b.hash = 6; /* other data */
  assert_int_equal(stratus_origin_covers(&a, &b), 0);
  a.hash = b.hash = 0; /* lists */
  assert_int_equal(stratus_origin_covers(&a, &b), 0);
  a.hash = b.hash = 5;
  b.cells = 1; /* another use */
  assert_int_equal(stratus_origin_covers(&a, &b), 0);
  c.lower = 0.75;
  assert_int_equal(stratus_criterion_intervals(context, &v, &c, 0, &b), STRATUS_OK);
  assert_int_equal(stratus_origin_covers(&a, &b), 0); /* fewer are wanted: the others would be hit */
  assert_int_equal(stratus_origin_covers(&b, &a), 0);
  const stratus_transfer transfer = transfer_of(comb[0], 200, 0);
  c.transfer = &transfer;
  for (int i = 0; i < 200; ++i) { /* 66 teeth with gaps between: more than are kept */
    comb[i][0] = i;
    comb[i][1] = i % 3 == 1 ? 1.0 : 0.0; /* feet at 3 n and 3 n + 2, transparent between 3 n + 2 and 3 n + 3 */
  }
  assert_int_equal(stratus_criterion_intervals(context, &v, &c, 0, &b), STRATUS_OK);
  assert_int_equal(b.intervals, 1);
  assert_int_equal(stratus_origin_covers(&a, &b), 0);
  assert_int_equal(stratus_origin_covers(&b, &a), 0);
  comb[1][1] = 0.0; /* one tooth less is another function, of more intervals than are kept, too */
  stratus_origin other = { .hash = 5 };
  assert_int_equal(stratus_criterion_intervals(context, &v, &c, 0, &other), STRATUS_OK);
  assert_int_equal(other.intervals, 1);
  assert_int_equal(stratus_origin_covers(&b, &other), 0);
  a.intervals = 0; /* a tree of nothing */
  assert_int_equal(stratus_origin_covers(&a, &b), 0);
  stratus_context_destroy(context);
}

static uint64_t hash_of(stratus_context* context, const stratus_volume* v)
{
  uint64_t hash = 0;
  assert_int_equal(stratus_volume_hash(context, v, &hash), STRATUS_OK);
  assert_true(hash != 0);
  return hash;
}

static void any_change_of_the_content_changes_the_hash(void** state)
{
  uint32_t random = 4;
  (void)state;
  stratus_context *one = make_context("host", 1), *three = make_context("host", 3);
  for (int type = 0; type < 10; ++type) {
    sample_volume v = make_volume((stratus_type)type, 7, 5, 3, 1, &random);
    sample_volume strided = make_volume((stratus_type)type, 7, 5, 3, 3, &random);
    const size_t size = stratus_type_size((stratus_type)type);
    const uint64_t hash = hash_of(one, &v.view);
    uint8_t* bytes = v.values;
    for (size_t i = 0; i < 105; ++i) {
      memcpy((uint8_t*)strided.values + 3 * i * size, bytes + i * size, size);
    }
    assert_true(hash_of(three, &v.view) == hash);
    assert_true(hash_of(one, &strided.view) == hash);
    for (size_t i = 0; i < 105 * size; ++i) {
      bytes[i] ^= 1;
      assert_true(hash_of(one, &v.view) != hash);
      bytes[i] ^= 1;
    }
    for (size_t i = 0; i + 7 < 105; i += 7) { /* rows that change places */
      uint8_t row[7 * 8];
      memcpy(row, bytes + i * size, 7 * size);
      memmove(bytes + i * size, bytes + (i + 7) * size, 7 * size);
      memcpy(bytes + (i + 7) * size, row, 7 * size);
      assert_true(hash_of(one, &v.view) != hash);
      memcpy(row, bytes + i * size, 7 * size);
      memmove(bytes + i * size, bytes + (i + 7) * size, 7 * size);
      memcpy(bytes + (i + 7) * size, row, 7 * size);
    }
    v.view.dimensions[0] = 5;
    v.view.dimensions[1] = 7;
    assert_true(hash_of(one, &v.view) != hash);
    v.view.dimensions[0] = 7;
    v.view.dimensions[1] = 5;
    v.view.type = (stratus_type)(type ^ 1);
    if (stratus_type_size(v.view.type) == size) {
      assert_true(hash_of(one, &v.view) != hash);
    }
    v.view.type = (stratus_type)type;
    uint8_t ghosts[105] = { 0 };
    v.view.point_ghosts = ghosts;
    assert_true(hash_of(one, &v.view) == hash); /* flags of 0 throughout are none */
    ghosts[40] = STRATUS_GHOST_HIDDEN_POINT;
    const uint64_t hidden = hash_of(three, &v.view);
    assert_true(hidden != hash);
    ghosts[40] = STRATUS_GHOST_DUPLICATE;
    assert_true(hash_of(one, &v.view) != hidden && hash_of(one, &v.view) != hash);
    v.view.point_ghosts = NULL;
    ghosts[40] = STRATUS_GHOST_HIDDEN_CELL;
    v.view.cell_ghosts = ghosts;
    assert_true(hash_of(one, &v.view) != hash);
    v.view.cell_ghosts = NULL;
    free_volume(&v);
    free_volume(&strided);
  }
  stratus_context_destroy(one);
  stratus_context_destroy(three);
}

/* ---------------------------------------------------------------- refusals */

static void what_is_out_of_range_is_refused_by_its_value(void** state)
{
  static const int64_t good[3] = { 4, 4, 4 }, long_axis[3] = { 4, (1 << 18) + 1, 4 }, none[3] = { 4, 4, 0 };
  static const int32_t outside[] = { 0, 0, 0, 1, 4, 1 }, negative[] = { 0, 0, -1 };
  const float value = 1.0f;
  (void)state;
  stratus_context* context = make_context("host", 1);
  stratus_voxels* s = NULL;
  stratus_volume v = stratus_volume_default();
  stratus_criterion c = stratus_criterion_default();
  v.values = &value;
#define REFUSED(call, part)                                                                                                                \
  do {                                                                                                                                     \
    assert_int_equal((call), STRATUS_INVALID_ARGUMENT);                                                                                    \
    assert_non_null(strstr(stratus_context_message(context), (part)));                                                                     \
    assert_null(s);                                                                                                                        \
  } while (0)
  REFUSED(stratus_voxels_create_list(context, long_axis, outside, 1, &s), "262145");
  REFUSED(stratus_voxels_create_list(context, none, outside, 1, &s), "along z is 0");
  REFUSED(stratus_voxels_create_list(context, good, outside, 2, &s), "position 1 is (1, 4, 1)");
  REFUSED(stratus_voxels_create_list(context, good, negative, 1, &s), "-1");
  REFUSED(stratus_voxels_create_list(context, good, NULL, 1, &s), "NULL");
  REFUSED(stratus_voxels_create_list(context, NULL, outside, 1, &s), "NULL");
  REFUSED(stratus_voxels_create_list(context, good, outside, 1, NULL), "NULL");
  REFUSED(stratus_voxels_create(context, NULL, &c, &s), "NULL");
  REFUSED(stratus_voxels_create(context, &v, NULL, &s), "NULL");
  REFUSED(stratus_voxels_create(context, &v, &c, NULL), "NULL");
  REFUSED(stratus_voxels_create_cells(context, &v, NULL, &s), "NULL");
  REFUSED(stratus_voxels_create_cells(context, &v, &c, NULL), "NULL");
  c.lower = 3.0;
  c.upper = 2.0;
  REFUSED(stratus_voxels_create(context, &v, &c, &s), "from 3 to 2");
  c.upper = NAN;
  REFUSED(stratus_voxels_create_cells(context, &v, &c, &s), "nan");
  const stratus_transfer empty = stratus_transfer_default();
  c.transfer = &empty;
  REFUSED(stratus_voxels_create(context, &v, &c, &s), "opacity");
  assert_int_equal(stratus_voxels_create_list(context, good, outside, (size_t)-1, &s), STRATUS_OVERFLOW);
  assert_int_equal(stratus_voxels_create(NULL, &v, &c, &s), STRATUS_INVALID_ARGUMENT);
  assert_int_equal(stratus_voxels_create_cells(NULL, &v, &c, &s), STRATUS_INVALID_ARGUMENT);
  assert_int_equal(stratus_voxels_create_list(NULL, good, outside, 1, &s), STRATUS_INVALID_ARGUMENT);
  stratus_voxels_destroy(NULL);
  stratus_context_destroy(context);
}

/* A matrix has an inverse or has none for volumes, sets, trees, rays and saved trees alike. Half a cell moves this volume's cells to where
 * no inverse leads back from. */
static void a_set_whose_matrix_has_no_inverse_is_refused(void** state)
{
  static const float values[8] = { 1, 1, 1, 1, 1, 1, 1, 1 };
  (void)state;
  stratus_context* context = make_context("host", 1);
  const stratus_criterion all = stratus_criterion_default();
  stratus_volume v = stratus_volume_default();
  v.values = values;
  v.dimensions[0] = v.dimensions[2] = 2; /* one layer: its points are within doubles */
  for (int far = 0; far < 2; ++far) {    /* far away, and not */
    stratus_voxels* s = NULL;
    v.origin[1] = v.direction[4] = far ? -DBL_MAX : -1.0;
    if (far) {
      REFUSED(stratus_voxels_create_cells(context, &v, &all, &s), "has no inverse");
      continue;
    }
    stratus_tree *tree = NULL, *back = NULL;
    assert_int_equal(stratus_voxels_create_cells(context, &v, &all, &s), STRATUS_OK);
    assert_int_equal(stratus_tree_create(context, s, NULL, &tree), STRATUS_OK);
    const size_t size = stratus_tree_bytes(tree);
    void* bytes = malloc(size);
    stratus_tree_save(tree, bytes);
    assert_int_equal(stratus_tree_load(context, bytes, size, &back), STRATUS_OK);
    free(bytes);
    stratus_tree_destroy(back);
    stratus_tree_destroy(tree);
    stratus_voxels_destroy(s);
  }
  stratus_context_destroy(context);
}

static stratus_status make_one(stratus_context* context, int which, const stratus_volume* v, const stratus_criterion* c, stratus_voxels** s)
{
  static const int64_t dense[3] = { 9, 9, 9 }, sparse[3] = { 1 << 18, 1 << 18, 1 << 18 };
  static const int32_t positions[] = { 1, 2, 3, 4, 5, 6 };
  int64_t n[3];
  int32_t* listed = NULL;
  size_t count;
  switch (which) {
    case 0:
      return stratus_voxels_create(context, v, c, s);
    case 1:
      return stratus_voxels_create_cells(context, v, c, s);
    case 2:
      return stratus_voxels_create_list(context, dense, positions, 2, s);
    case 3:
      return stratus_voxels_create_list(context, sparse, positions, 2, s);
    default: { /* a scene's list is released at once */
      const stratus_status status = stratus_voxel_scene_create(context, "17K", n, &listed, &count);
      stratus_voxel_scene_release(context, listed);
      return status;
    }
  }
}

static void memory_refused_at_any_request_is_reported_and_leaves_nothing(void** state)
{
  static const double points[] = { -1.0, 0.0, 0.5, 1.0 };
  uint32_t random = 6;
  (void)state;
  sample_volume v = make_volume(STRATUS_FLOAT32, 9, 6, 5, 2, &random);
  const stratus_transfer transfer = transfer_of(points, 2, 1);
  const stratus_criterion c = { .transfer = &transfer };
  for (int which = 0; which < 5; ++which) {
    int refusals = 0;
    for (int64_t n = 1;; ++n, ++refusals) {
      faulty_allocator allocator = { 0 };
      stratus_context_options options = faulty_options(&allocator, "host");
      stratus_context* context = NULL;
      stratus_voxels* s = NULL;
      options.threads = 1;
      assert_int_equal(stratus_context_create(&options, &context, NULL, 0), STRATUS_OK);
      const int64_t live = allocator.live;
      allocator.fail_at = allocator.calls + n;
      const stratus_status status = make_one(context, which, &v.view, &c, &s);
      if (status != STRATUS_OK) {
        assert_int_equal(status, STRATUS_OUT_OF_MEMORY);
        assert_null(s);
      }
      stratus_voxels_destroy(s);
      assert_int_equal(allocator.live, live);
      stratus_context_destroy(context);
      if (status == STRATUS_OK) {
        break;
      }
      assert_true(n < 100);
    }
    assert_true(refusals >= 2);
  }
  free_volume(&v);
}

int test_voxels(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(every_type_is_compared_exactly),
    cmocka_unit_test(ends_of_intervals_are_in_and_feet_of_ramps_are_out),
    cmocka_unit_test(a_list_makes_the_set_of_its_positions),
    cmocka_unit_test(any_number_of_threads_sorts_a_sparse_list_alike),
    cmocka_unit_test(blocks_that_either_sampling_shows_are_there_and_few_others),
    cmocka_unit_test(an_interval_of_cells_keeps_each_block_whose_range_meets_it),
    cmocka_unit_test(a_set_that_covers_another_holds_all_of_it),
    cmocka_unit_test(only_the_same_voxels_stand_in_for_first_hits),
    cmocka_unit_test(any_change_of_the_content_changes_the_hash),
    cmocka_unit_test(what_is_out_of_range_is_refused_by_its_value),
    cmocka_unit_test(a_set_whose_matrix_has_no_inverse_is_refused),
    cmocka_unit_test(memory_refused_at_any_request_is_reported_and_leaves_nothing),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
