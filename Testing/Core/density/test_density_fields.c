/* SPDX-License-Identifier: BSD-3-Clause
 * Densities of whole sets, their peaks and their borders, compared with plain sums over all voxels. */
#include "density_plain.h"

#define FEW 400

/* ---- fields */

static stratus_density* make_density(const stratus_voxels* voxels, double h, int exact)
{
  stratus_density* density = NULL;
  if (stratus_density_create(context, voxels->bricks, voxels->brick_count, h, exact, &density) != STRATUS_OK) {
    fail_msg("%s", stratus_context_message(context));
  }
  return density;
}

static void exact_field_is_the_density_at_each_voxel(void** state)
{
  uint32_t random = 4;
  (void)state;
  for (int repeat = 0; repeat < 300; ++repeat) {
    stratus_voxels* voxels = random_set(&random, repeat % 3 ? 30 : 200, FEW);
    const double h = random_bandwidth(&random);
    stratus_density* density = make_density(voxels, h, 1);
    for (int64_t v = 0; v < voxels->count; ++v) {
      int edge;
      const double p[3] = { at[v][0], at[v][1], at[v][2] };
      const double expected = sum_plainly(voxels, h, p, &edge).density;
      /* 2^-24 for the float, and 2^-29 of a voxel's own for each in reach; n of them in reach weigh at least 1. */
      assert_near(density->of[v], expected, expected * 1e-7 + (double)voxels->count * 2e-9 * expected);
    }
    assert_int_equal(density->start[voxels->brick_count], voxels->count);
    stratus_density_destroy(density);
    stratus_voxels_destroy(voxels);
  }
}

/* Tests the error bounds that density.c and density_cells.c state; full bricks are exact. */
static void binned_field_errs_no_more_than_it_says(void** state)
{
  uint32_t random = 5;
  (void)state;
  for (int repeat = 0; repeat < 300; ++repeat) {
    stratus_voxels* voxels = random_set(&random, repeat % 3 ? 40 : 300, FEW);
    const double h = random_bandwidth(&random), unit = 105.0 / (32.0 * PI) / (h * h * h * (double)voxels->count);
    stratus_density* density = make_density(voxels, h, 0);
    double edge_length = 4.0;
    while (h > 30.0 && 8.0 * edge_length <= h) {
      edge_length *= 2.0;
    }
    const double each = fmin(1.0, h > 30.0 ? 1.54 * 0.87 * edge_length * 2.0 / h : 4.72 / h);
    for (int64_t b = 0; b < voxels->brick_count; ++b) {
      int edge;
      const double p[3] = { 4 * voxels->bricks[b].at[0] + 1.5, 4 * voxels->bricks[b].at[1] + 1.5, 4 * voxels->bricks[b].at[2] + 1.5 };
      const double reach = h + (h > 30.0 ? 2.0 * 0.87 * edge_length : 2.6 + 2.6);
      int64_t near = 0;
      for (int64_t v = 0; v < voxels->count; ++v) {
        near += pow(p[0] - at[v][0], 2) + pow(p[1] - at[v][1], 2) + pow(p[2] - at[v][2], 2) < reach * reach;
      }
      assert_near(density->of[b], sum_plainly(voxels, h, p, &edge).density, unit * (double)near * (each + 1e-6));
    }
    stratus_density_destroy(density);
    stratus_voxels_destroy(voxels);
  }
}

static void binned_field_of_full_bricks_is_exact(void** state)
{
  static const double some[] = { 1.0, 2.5, 6.0, 20.0 };
  (void)state;
  set_begin(&set, 40, 40, 40);
  set_add_box(&set, 4, 32, 8, 24, 4, 36);
  stratus_voxels* voxels = make_voxels(context, &set);
  list_voxels(voxels, at);
  for (int i = 0; i < 4; ++i) {
    stratus_density* density = make_density(voxels, some[i], 0);
    for (int64_t b = 0; b < voxels->brick_count; b += 7) {
      int edge;
      const double p[3] = { 4 * voxels->bricks[b].at[0] + 1.5, 4 * voxels->bricks[b].at[1] + 1.5, 4 * voxels->bricks[b].at[2] + 1.5 };
      const double expected = sum_plainly(voxels, some[i], p, &edge).density;
      assert_near(density->of[b], expected, 1e-6 * expected);
    }
    stratus_density_destroy(density);
  }
  stratus_voxels_destroy(voxels);
}

static void fields_have_the_same_bits_at_any_thread_count(void** state)
{
  static const double some[] = { 2.7, 5.5, 9.0, 40.0 };
  uint32_t random = 6;
  (void)state;
  set_begin(&set, 200, 90, 200);
  set_add_noise(&set, 6000, &random);
  set_add_box(&set, 50, 70, 40, 60, 100, 120);
  stratus_voxels* voxels = make_voxels(context, &set);
  assert_true(voxels->brick_count > 4096);
  for (int i = 0; i < 8; ++i) {
    stratus_density* one = make_density(voxels, some[i / 2], i % 2);
    double bandwidth, again;
    assert_int_equal(stratus_density_bandwidth(context, voxels, &bandwidth, NULL), STRATUS_OK);
    for (int threads = 2; threads <= 5; threads += 3) {
      stratus_density* many = NULL;
      stratus_context* other = make_context("host", threads);
      assert_int_equal(stratus_density_create(other, voxels->bricks, voxels->brick_count, some[i / 2], i % 2, &many), STRATUS_OK);
      assert_memory_equal(many->of, one->of, sizeof(float) * (size_t)(i % 2 ? voxels->count : voxels->brick_count));
      stratus_density_destroy(many);
      assert_int_equal(stratus_density_bandwidth(other, voxels, &again, NULL), STRATUS_OK);
      assert_true(again == bandwidth);
      stratus_context_destroy(other);
    }
    stratus_density_destroy(one);
  }
  stratus_voxels_destroy(voxels);
}

/* ---- peak */

static int before(const int32_t a[3], const int32_t b[3])
{
  return a[2] != b[2] ? a[2] < b[2] : a[1] != b[1] ? a[1] < b[1] : a[0] < b[0];
}

static void peak_is_the_densest_voxel_and_of_equals_the_first(void** state)
{
  uint32_t random = 7;
  (void)state;
  for (int repeat = 0; repeat < 200; ++repeat) {
    stratus_voxels* voxels = random_set(&random, 30, FEW);
    stratus_density* density = make_density(voxels, 1.0 + (double)random_below(&random, 4), 1);
    int64_t best = 0;
    for (int64_t v = 1; v < voxels->count; ++v) {
      if (density->of[v] > density->of[best] || (density->of[v] >= density->of[best] && before(at[v], at[best]))) {
        best = v;
      }
    }
    int32_t peak[3];
    stratus_density_peak(density, voxels->bricks, NULL, voxels->brick_count, peak);
    assert_memory_equal(peak, at[best], sizeof peak);
    const uint32_t last = (uint32_t)voxels->brick_count - 1;
    stratus_density_peak(density, voxels->bricks, &last, 1, peak);
    assert_int_equal(peak[0] / 4, voxels->bricks[last].at[0]);
    stratus_density_destroy(density);

    density = make_density(voxels, 6.0, 0);
    stratus_density_peak(density, voxels->bricks, NULL, voxels->brick_count, peak);
    assert_int_equal(stratus_voxels_get(voxels, peak[0], peak[1], peak[2]), 1);
    float most = 0.0f, own = -1.0f;
    for (int64_t b = 0; b < voxels->brick_count; ++b) {
      const uint16_t* place = voxels->bricks[b].at;
      most = fmaxf(most, density->of[b]);
      own = place[0] == peak[0] / 4 && place[1] == peak[1] / 4 && place[2] == peak[2] / 4 ? density->of[b] : own;
    }
    assert_true(own == most);
    stratus_density_destroy(density);
    stratus_voxels_destroy(voxels);
  }
}

/* All inner voxels of a solid block tie. The peak is the first of them in (z, y, x). */
static void peak_of_a_solid_block_is_its_first_inner_voxel(void** state)
{
  (void)state;
  set_begin(&set, 40, 40, 40);
  set_add_box(&set, 3, 33, 5, 30, 7, 29);
  stratus_voxels* voxels = make_voxels(context, &set);
  stratus_density* density = make_density(voxels, 3.5, 1);
  int32_t peak[3];
  stratus_density_peak(density, voxels->bricks, NULL, voxels->brick_count, peak);
  assert_int_equal(peak[0], 6);
  assert_int_equal(peak[1], 8);
  assert_int_equal(peak[2], 10);
  stratus_density_destroy(density);
  stratus_voxels_destroy(voxels);
}

/* ---- borders */

typedef struct plane_sums {
  double first, second;
  int near;
} plane_sums;

/* Sums at the plane before voxel `plane` of `axis`, over voxels or, if `whole`, over bricks as weights at their middles. */
static plane_sums at_plane(const stratus_voxels* voxels, double h, const int32_t peak[3], int axis, int plane, int whole)
{
  plane_sums sums = { 0.0, 0.0, 0 };
  const double unit = 105.0 / (32.0 * PI) / ((double)voxels->count * h * h * h);
  for (int64_t i = 0; i < (whole ? voxels->brick_count : voxels->count); ++i) {
    double d[3], u = 0.0;
    for (int a = 0; a < 3; ++a) {
      d[a] = (a == axis ? plane - 0.5 : peak[a]) - (whole ? 4 * voxels->bricks[i].at[a] + 1.5 : at[i][a]);
      u += d[a] * d[a] / (h * h);
    }
    if (u < 1.0) {
      const double weight = whole ? voxels->bricks[i].count : 1.0;
      ++sums.near;
      sums.first += -4.0 * unit * weight * d[axis] / (h * h) * (1.0 - u);
      sums.second += -4.0 * unit * weight / (h * h) * (1.0 - u - 2.0 * d[axis] * d[axis] / (h * h));
    }
  }
  return sums;
}

static void find_borders(const stratus_voxels* voxels, double h, int exact, const int32_t peak[3], const int32_t lo[3], const int32_t hi[3],
  stratus_density_borders* borders)
{
  stratus_density_line* lines = malloc(stratus_density_line_start(lo, hi, 3) * sizeof *lines);
  assert_non_null(lines);
  stratus_density_sum_lines(voxels->bricks, NULL, voxels->brick_count, h, exact, peak, lo, hi, lines);
  stratus_density_scan_lines(lines, voxels->count, h, peak, lo, hi, borders);
  free(lines);
}

static void check_side(
  const stratus_voxels* voxels, double h, const int32_t peak[3], int axis, int side, int whole, const stratus_density_borders* borders)
{
  const int step = side ? 1 : -1, lo = (int)voxels->lo[axis], hi = (int)voxels->hi[axis];
  int position = peak[axis] + side;
  double fall = 0.0;
  for (int p = position; p >= lo && p <= hi; p += step) {
    const plane_sums here = at_plane(voxels, h, peak, axis, p, whole);
    if (here.near == 0 || here.second > 0.0) {
      const int last = p == peak[axis] + side ? p : p - step;
      const double before = fabs(at_plane(voxels, h, peak, axis, last, whole).first), now = fabs(here.first);
      const int steeper = before >= now ? last : p;
      if (steeper > lo && steeper < hi) {
        position = steeper;
        fall = fmax(before, now);
      }
      break;
    }
  }
  assert_int_equal(borders->position[axis][side], position);
  assert_near(borders->fall[axis][side], fall, 1e-12 / (h * h * h * h));
}

/* Four times the bandwidth has no integer square, so that no voxel is at the kernel's very end, where rounding would decide. */
static void borders_are_where_the_plain_second_derivative_turns(void** state)
{
  static const double some[] = { 1.037, 1.71, 2.613, 4.137, 9.071, 17.31 };
  uint32_t random = 8;
  int found = 0;
  (void)state;
  for (int repeat = 0; repeat < 200; ++repeat) {
    stratus_voxels* voxels = random_set(&random, 40, FEW);
    const double h = some[repeat % 6];
    const int exact = repeat / 6 % 2, whole = !exact && h > 16.0;
    int32_t lo[3], hi[3], peak[3];
    for (int a = 0; a < 3; ++a) {
      lo[a] = (int32_t)voxels->lo[a];
      hi[a] = (int32_t)voxels->hi[a];
    }
    stratus_density* density = make_density(voxels, h, 1);
    stratus_density_peak(density, voxels->bricks, NULL, voxels->brick_count, peak);
    stratus_density_borders borders;
    find_borders(voxels, h, exact, peak, lo, hi, &borders);
    for (int i = 0; i < 6; ++i) {
      check_side(voxels, h, peak, i / 2, i % 2, whole, &borders);
      found += borders.fall[i / 2][i % 2] > 0.0;
    }
    stratus_density_destroy(density);
    stratus_voxels_destroy(voxels);
  }
  assert_true(found > 100);
}

/* Two solid slabs with a gap: seen from the first, density falls most steeply at its end, to within a voxel. */
static void a_slab_ends_where_its_density_falls(void** state)
{
  (void)state;
  set_begin(&set, 60, 20, 20);
  set_add_box(&set, 4, 20, 0, 20, 0, 20);
  set_add_box(&set, 40, 50, 0, 20, 0, 20);
  stratus_voxels* voxels = make_voxels(context, &set);
  stratus_density_borders borders;
  const int32_t peak[3] = { 12, 10, 10 }, lo[3] = { 0, 0, 0 }, hi[3] = { 60, 20, 20 };
  find_borders(voxels, 3.7, 1, peak, lo, hi, &borders);
  assert_in_range(borders.position[0][0], 3, 5);
  assert_in_range(borders.position[0][1], 19, 21);
  assert_true(borders.fall[0][0] > 0.0 && borders.fall[0][1] > 0.0);
  stratus_voxels_destroy(voxels);
}

int test_density_fields(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(exact_field_is_the_density_at_each_voxel),
    cmocka_unit_test(binned_field_errs_no_more_than_it_says),
    cmocka_unit_test(binned_field_of_full_bricks_is_exact),
    cmocka_unit_test(fields_have_the_same_bits_at_any_thread_count),
    cmocka_unit_test(peak_is_the_densest_voxel_and_of_equals_the_first),
    cmocka_unit_test(peak_of_a_solid_block_is_its_first_inner_voxel),
    cmocka_unit_test(borders_are_where_the_plain_second_derivative_turns),
    cmocka_unit_test(a_slab_ends_where_its_density_falls),
  };
  return cmocka_run_group_tests(tests, open_context, close_context);
}
