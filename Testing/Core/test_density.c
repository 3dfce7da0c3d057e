/* SPDX-License-Identifier: BSD-3-Clause
 * Bandwidth, density, its derivatives, peak and borders against plain sums over all voxels in double precision. */
#include "voxel_sets.h"
#include "tree.h"

#include <float.h>

#define PI 3.14159265358979323846
#define FEW 400

static stratus_context* context;
static voxel_set set;
static int32_t at[VOXEL_SET_MAX][3];

/* A random set in a random box: noise, sometimes with a solid part, so that bricks are full, sparse and absent. */
static stratus_voxels* random_set(uint32_t* random, int64_t longest, int64_t noise)
{
  set_begin(&set, 1 + random_below(random, longest), 1 + random_below(random, longest), 1 + random_below(random, longest));
  set_add_noise(&set, 1 + random_below(random, noise), random);
  if (random_below(random, 2)) {
    const int64_t* n = set.dimensions;
    set_add_box(&set, 0, n[0] < 6 ? n[0] : 6, 0, n[1] < 5 ? n[1] : 5, 0, n[2] < 7 ? n[2] : 7);
  }
  stratus_voxels* voxels = make_voxels(context, &set);
  list_voxels(voxels, at);
  return voxels;
}

/* ---- plain sums */

typedef struct plain {
  double density, first[3], second[3];
} plain;

/* Eq. 5, and its derivatives term by term. Voxels whose distance is the bandwidth to within rounding are left to either side: their terms in the
 * density and its slope vanish there; that of the second derivative jumps, and `edge` tells. */
static plain sum_plainly(const stratus_voxels* voxels, double h, const double p[3], int* edge)
{
  plain sum = { .density = 0.0 };
  const double n = (double)voxels->count, c = 105.0 / (32.0 * PI);
  *edge = 0;
  for (int64_t v = 0; v < voxels->count; v++) {
    double d[3], squared = 0.0;
    for (int a = 0; a < 3; a++) {
      d[a] = p[a] - at[v][a];
      squared += d[a] * d[a];
    }
    const double t = sqrt(squared) / h;
    *edge |= fabs(t - 1.0) < 1e-9;
    if (t < 1.0) {
      const double u = t * t;
      sum.density += c / (n * h * h * h) * (1.0 - u) * (1.0 - u);
      for (int a = 0; a < 3; a++) {
        sum.first[a] += c / (n * h * h * h) * 2.0 * (1.0 - u) * (-2.0 * d[a] / (h * h));
        sum.second[a] += c / (n * h * h * h) * (8.0 * d[a] * d[a] / (h * h * h * h) - 4.0 * (1.0 - u) / (h * h));
      }
    }
  }
  return sum;
}

static void assert_near(double value, double expected, double tolerance)
{
  if (!(fabs(value - expected) <= tolerance)) {
    fail_msg("%.17g, not %.17g within %g", value, expected, tolerance);
  }
}

/* ---- bandwidth */

static int compare_doubles(const void* a, const void* b)
{
  return (*(const double*)a > *(const double*)b) - (*(const double*)a < *(const double*)b);
}

static double plain_bandwidth(const stratus_voxels* voxels)
{
  static double distance[VOXEL_SET_MAX];
  const double n = (double)voxels->count;
  double mean[3] = { 0, 0, 0 }, average = 0.0, variance = 0.0;
  for (int64_t v = 0; v < voxels->count; v++) {
    for (int a = 0; a < 3; a++) {
      mean[a] += at[v][a] / n;
    }
  }
  for (int64_t v = 0; v < voxels->count; v++) {
    const double x = at[v][0] - mean[0], y = at[v][1] - mean[1], z = at[v][2] - mean[2];
    distance[v] = sqrt(x * x + y * y + z * z);
    average += distance[v] / n;
  }
  for (int64_t v = 0; v < voxels->count; v++) {
    variance += (distance[v] - average) * (distance[v] - average) / n;
  }
  qsort(distance, (size_t)voxels->count, sizeof *distance, compare_doubles);
  const double median = distance[voxels->count / 2];
  return 0.9 * fmin(sqrt(variance), sqrt(1.0 / log(2.0)) * median) * pow(n, -0.2);
}

/* 1e-9 of the box's length: distances are rounded at 1e-16 of it, their deviation's square root at 1e-8 of small deviations, and the median is
 * bracketed to 2^-36 of the largest squared distance. */
static void check_bandwidth(const stratus_voxels* voxels, double length)
{
  double bandwidth = -1, raw = -1, again = -1;
  assert_int_equal(stratus_density_bandwidth(context, voxels, &bandwidth, &raw), STRATUS_OK);
  assert_near(raw, plain_bandwidth(voxels), 1e-7 * length);
  assert_true(bandwidth == fmax(raw, 1.0));
  assert_int_equal(stratus_density_bandwidth_of(context, voxels->bricks, voxels->brick_count, &again, NULL), STRATUS_OK);
  assert_true(again == bandwidth);
}

static void bandwidth_is_that_of_equations_3_and_4(void** state)
{
  uint32_t random = 1;
  (void)state;
  for (int repeat = 0; repeat < 200; repeat++) {
    stratus_voxels* voxels = random_set(&random, repeat % 10 ? 40 : 9000, 1500);
    check_bandwidth(voxels, repeat % 10 ? 40.0 : 9000.0);
    stratus_voxels_destroy(voxels);
  }
}

/* Most voxels near the middle, a few far out: then the median is the lesser of the two spreads. */
static void bandwidth_takes_the_median_where_it_is_less(void** state)
{
  (void)state;
  set_begin(&set, 300, 300, 300);
  set_add_box(&set, 148, 153, 148, 153, 148, 153);
  for (int i = 0; i < 8; i++) {
    set_add(&set, i & 1 ? 299 : 0, i & 2 ? 299 : 0, i & 4 ? 299 : 0);
  }
  stratus_voxels* voxels = make_voxels(context, &set);
  list_voxels(voxels, at);
  double bandwidth, raw;
  assert_int_equal(stratus_density_bandwidth(context, voxels, &bandwidth, &raw), STRATUS_OK);
  assert_near(raw, plain_bandwidth(voxels), 1e-9 * 300);
  assert_true(raw < 3.0); /* the deviation would make it some 20 */
  stratus_voxels_destroy(voxels);
}

static void bandwidth_of_nothing_one_two_and_a_shell_is_1(void** state)
{
  double bandwidth = -1, raw = -1;
  (void)state;
  for (int count = 0; count < 3; count++) {
    set_begin(&set, 50, 50, 50);
    for (int i = 0; i < count; i++) {
      set_add(&set, 10 + 30 * i, 7, 3);
    }
    stratus_voxels* voxels = make_voxels(context, &set);
    assert_int_equal(stratus_density_bandwidth(context, voxels, &bandwidth, &raw), STRATUS_OK);
    assert_true(bandwidth == 1.0 && raw == 0.0);
    stratus_voxels_destroy(voxels);
  }
  set_begin(&set, 64, 64, 64);
  set_add_shell(&set, 32, 28);
  stratus_voxels* voxels = make_voxels(context, &set);
  assert_int_equal(stratus_density_bandwidth(context, voxels, &bandwidth, &raw), STRATUS_OK);
  list_voxels(voxels, at);
  assert_near(raw, plain_bandwidth(voxels), 1e-9);
  assert_true(bandwidth == 1.0);
  assert_near(raw, 0.04, 0.005);
  stratus_voxels_destroy(voxels);
}

/* ---- at a point */

static double random_bandwidth(uint32_t* random)
{
  static const double some[] = { 0.6, 1.0, 1.5, 2.0, 3.0, 4.2, 7.0, 11.0, 28.0, 33.0, 90.0 };
  return random_below(random, 3) ? some[random_below(random, 11)] : 0.5 + (double)random_below(random, 4000) / 300.0;
}

static void density_and_derivatives_at_points_are_plain_sums(void** state)
{
  uint32_t random = 2;
  (void)state;
  for (int repeat = 0; repeat < 3000; repeat++) {
    stratus_voxels* voxels = random_set(&random, 24, 60);
    const double h = random_bandwidth(&random);
    const double unit = 105.0 / (32.0 * PI) / (h * h * h);
    double p[3], density, first[3], second[3], alone;
    for (int a = 0; a < 3; a++) {
      p[a] = repeat % 2 ? (double)(random_below(&random, 60) - 15) / 2.0 : (double)random_below(&random, 40000) / 1000.0 - 8.0;
    }
    int edge;
    const plain expected = sum_plainly(voxels, h, p, &edge);
    assert_int_equal(stratus_density_at(context, voxels, h, p, &density, first, second), STRATUS_OK);
    assert_near(density, expected.density, 1e-13 * unit);
    for (int a = 0; a < 3; a++) {
      assert_near(first[a], expected.first[a], 1e-12 * unit / h);
      if (!edge) {
        assert_near(second[a], expected.second[a], 1e-12 * unit / (h * h));
      }
    }
    assert_int_equal(stratus_density_at(context, voxels, h, p, &alone, NULL, NULL), STRATUS_OK);
    assert_true(alone == density);
    stratus_voxels_destroy(voxels);
  }
}

/* Central differences of the density, and of its first derivative, away from the kernel's end. */
static void derivatives_are_those_of_the_density(void** state)
{
  uint32_t random = 3;
  int compared = 0;
  (void)state;
  for (int repeat = 0; repeat < 400; repeat++) {
    stratus_voxels* voxels = random_set(&random, 12, 60);
    const double h = 2.0 + (double)random_below(&random, 300) / 100.0, step = 1e-4 * h, unit = 105.0 / (32.0 * PI) / (h * h * h);
    double p[3], at_p, first[3], second[3];
    int edge = 0;
    for (int a = 0; a < 3; a++) {
      p[a] = (double)random_below(&random, 12000) / 1000.0;
    }
    for (int64_t v = 0; v < voxels->count; v++) {
      edge |= fabs(sqrt(pow(p[0] - at[v][0], 2) + pow(p[1] - at[v][1], 2) + pow(p[2] - at[v][2], 2)) - h) < 4 * step;
    }
    assert_int_equal(stratus_density_at(context, voxels, h, p, &at_p, first, second), STRATUS_OK);
    for (int a = 0; a < 3 && !edge; a++) {
      double before[3] = { p[0], p[1], p[2] }, behind[3] = { p[0], p[1], p[2] }, low, high, low_first[3], high_first[3];
      before[a] -= step;
      behind[a] += step;
      assert_int_equal(stratus_density_at(context, voxels, h, before, &low, low_first, NULL), STRATUS_OK);
      assert_int_equal(stratus_density_at(context, voxels, h, behind, &high, high_first, NULL), STRATUS_OK);
      /* The third derivative is at most 24 of these units, so the error at most 4 step^2: 4e-8; differences round at 1e-12. */
      assert_near((high - low) / (2 * step), first[a], 1e-7 * unit / h);
      assert_near((high_first[a] - low_first[a]) / (2 * step), second[a], 1e-6 * unit / (h * h));
      compared++;
    }
    stratus_voxels_destroy(voxels);
  }
  assert_true(compared > 300);
}

/* The constant is right only if all of space holds 1. */
static void density_integrates_to_one(void** state)
{
  (void)state;
  set_begin(&set, 3, 3, 3);
  set_add(&set, 1, 1, 1);
  set_add(&set, 2, 1, 0);
  stratus_voxels* voxels = make_voxels(context, &set);
  double sum = 0.0;
  const double h = 2.0, step = 0.1;
  for (int k = 0; k < 80; k++) {
    for (int j = 0; j < 80; j++) {
      for (int i = 0; i < 80; i++) {
        double density;
        assert_int_equal(
          stratus_density_at(context, voxels, h, (const double[3]){ i * step - 2.95, j * step - 2.95, k * step - 2.95 }, &density, NULL, NULL),
          STRATUS_OK);
        sum += density * step * step * step;
      }
    }
  }
  assert_near(sum, 1.0, 1e-4); /* the midpoint rule's error of a kernel 20 steps wide whose second derivative jumps */
  stratus_voxels_destroy(voxels);
}

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
  for (int repeat = 0; repeat < 300; repeat++) {
    stratus_voxels* voxels = random_set(&random, repeat % 3 ? 30 : 200, FEW);
    const double h = random_bandwidth(&random);
    stratus_density* density = make_density(voxels, h, 1);
    for (int64_t v = 0; v < voxels->count; v++) {
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

/* The bounds of density.c and density_cells.c, and full bricks exactly. */
static void binned_field_errs_no_more_than_it_says(void** state)
{
  uint32_t random = 5;
  (void)state;
  for (int repeat = 0; repeat < 300; repeat++) {
    stratus_voxels* voxels = random_set(&random, repeat % 3 ? 40 : 300, FEW);
    const double h = random_bandwidth(&random), unit = 105.0 / (32.0 * PI) / (h * h * h * (double)voxels->count);
    stratus_density* density = make_density(voxels, h, 0);
    double edge_length = 4.0;
    while (h > 30.0 && 8.0 * edge_length <= h) {
      edge_length *= 2.0;
    }
    const double each = fmin(1.0, h > 30.0 ? 1.54 * 0.87 * edge_length * 2.0 / h : 4.72 / h);
    for (int64_t b = 0; b < voxels->brick_count; b++) {
      int edge;
      const double p[3] = { 4 * voxels->bricks[b].at[0] + 1.5, 4 * voxels->bricks[b].at[1] + 1.5, 4 * voxels->bricks[b].at[2] + 1.5 };
      const double reach = h + (h > 30.0 ? 2.0 * 0.87 * edge_length : 2.6 + 2.6);
      int64_t near = 0;
      for (int64_t v = 0; v < voxels->count; v++) {
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
  for (int i = 0; i < 4; i++) {
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
  for (int i = 0; i < 8; i++) {
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
  for (int repeat = 0; repeat < 200; repeat++) {
    stratus_voxels* voxels = random_set(&random, 30, FEW);
    stratus_density* density = make_density(voxels, 1.0 + (double)random_below(&random, 4), 1);
    int64_t best = 0;
    for (int64_t v = 1; v < voxels->count; v++) {
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
    for (int64_t b = 0; b < voxels->brick_count; b++) {
      const uint16_t* place = voxels->bricks[b].at;
      most = fmaxf(most, density->of[b]);
      own = place[0] == peak[0] / 4 && place[1] == peak[1] / 4 && place[2] == peak[2] / 4 ? density->of[b] : own;
    }
    assert_true(own == most);
    stratus_density_destroy(density);
    stratus_voxels_destroy(voxels);
  }
}

/* A solid block ties in its whole inside: the first voxel of that in (z, y, x). */
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

/* At the plane before voxel `plane` of `axis`, from voxels (or, `whole`, from bricks as weights in their middles). */
static plane_sums at_plane(const stratus_voxels* voxels, double h, const int32_t peak[3], int axis, int plane, int whole)
{
  plane_sums sums = { 0.0, 0.0, 0 };
  const double unit = 105.0 / (32.0 * PI) / ((double)voxels->count * h * h * h);
  for (int64_t i = 0; i < (whole ? voxels->brick_count : voxels->count); i++) {
    double d[3], u = 0.0;
    for (int a = 0; a < 3; a++) {
      d[a] = (a == axis ? plane - 0.5 : peak[a]) - (whole ? 4 * voxels->bricks[i].at[a] + 1.5 : at[i][a]);
      u += d[a] * d[a] / (h * h);
    }
    if (u < 1.0) {
      const double weight = whole ? voxels->bricks[i].count : 1.0;
      sums.near++;
      sums.first += -4.0 * unit * weight * d[axis] / (h * h) * (1.0 - u);
      sums.second += -4.0 * unit * weight / (h * h) * (1.0 - u - 2.0 * d[axis] * d[axis] / (h * h));
    }
  }
  return sums;
}

static void check_side(const stratus_voxels* voxels, double h, const int32_t peak[3], int axis, int side, int whole,
  const stratus_density_borders* borders)
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

/* Bandwidths four times whose square is no whole number: no voxel is at the kernel's very end, where rounding would choose the side. */
static void borders_are_where_the_plain_second_derivative_turns(void** state)
{
  static const double some[] = { 1.037, 1.71, 2.613, 4.137, 9.071, 17.31 };
  uint32_t random = 8;
  int found = 0;
  (void)state;
  for (int repeat = 0; repeat < 200; repeat++) {
    stratus_voxels* voxels = random_set(&random, 40, FEW);
    const double h = some[repeat % 6];
    const int exact = repeat / 6 % 2, whole = !exact && h > 16.0;
    int32_t lo[3], hi[3], peak[3];
    for (int a = 0; a < 3; a++) {
      lo[a] = (int32_t)voxels->lo[a];
      hi[a] = (int32_t)voxels->hi[a];
    }
    stratus_density* density = make_density(voxels, h, 1);
    stratus_density_peak(density, voxels->bricks, NULL, voxels->brick_count, peak);
    stratus_density_borders borders;
    assert_int_equal(
      stratus_density_find_borders(context, voxels->bricks, NULL, voxels->brick_count, h, exact, peak, lo, hi, &borders), STRATUS_OK);
    for (int i = 0; i < 6; i++) {
      check_side(voxels, h, peak, i / 2, i % 2, whole, &borders);
      found += borders.fall[i / 2][i % 2] > 0.0;
    }
    stratus_density_destroy(density);
    stratus_voxels_destroy(voxels);
  }
  assert_true(found > 100);
}

/* Two solid slabs with a gap: seen from the first, density falls most steeply at its end, give or take a voxel. */
static void a_slab_ends_where_its_density_falls(void** state)
{
  (void)state;
  set_begin(&set, 60, 20, 20);
  set_add_box(&set, 4, 20, 0, 20, 0, 20);
  set_add_box(&set, 40, 50, 0, 20, 0, 20);
  stratus_voxels* voxels = make_voxels(context, &set);
  stratus_density_borders borders;
  const int32_t peak[3] = { 12, 10, 10 }, lo[3] = { 0, 0, 0 }, hi[3] = { 60, 20, 20 };
  assert_int_equal(stratus_density_find_borders(context, voxels->bricks, NULL, voxels->brick_count, 3.7, 1, peak, lo, hi, &borders), STRATUS_OK);
  assert_in_range(borders.position[0][0], 3, 5);
  assert_in_range(borders.position[0][1], 19, 21);
  assert_true(borders.fall[0][0] > 0.0 && borders.fall[0][1] > 0.0);
  stratus_voxels_destroy(voxels);
}

/* ---- arguments */

static void bad_arguments_are_refused_with_their_value(void** state)
{
  static const double bad[] = { 0.0, -1.0, NAN, INFINITY, 1e10, 1e-7 };
  const double point[3] = { 0, 0, 0 }, nowhere[3] = { 0, NAN, 0 };
  double value = 7.0;
  (void)state;
  set_begin(&set, 4, 4, 4);
  stratus_voxels* voxels = make_voxels(context, &set);
  assert_int_equal(stratus_density_at(NULL, voxels, 1.0, point, &value, NULL, NULL), STRATUS_INVALID_ARGUMENT);
  assert_int_equal(stratus_density_at(context, NULL, 1.0, point, &value, NULL, NULL), STRATUS_INVALID_ARGUMENT);
  assert_int_equal(stratus_density_at(context, voxels, 1.0, NULL, &value, NULL, NULL), STRATUS_INVALID_ARGUMENT);
  assert_int_equal(stratus_density_at(context, voxels, 1.0, point, NULL, NULL, NULL), STRATUS_INVALID_ARGUMENT);
  assert_int_equal(stratus_density_at(context, voxels, 1.0, nowhere, &value, NULL, NULL), STRATUS_INVALID_ARGUMENT);
  for (int i = 0; i < 6; i++) {
    assert_int_equal(stratus_density_at(context, voxels, bad[i], point, &value, NULL, NULL), STRATUS_INVALID_ARGUMENT);
    assert_non_null(strstr(stratus_context_message(context), "1e-6..1e9"));
  }
  assert_int_equal(stratus_density_bandwidth(NULL, voxels, &value, NULL), STRATUS_INVALID_ARGUMENT);
  assert_int_equal(stratus_density_bandwidth(context, NULL, &value, NULL), STRATUS_INVALID_ARGUMENT);
  assert_int_equal(stratus_density_bandwidth(context, voxels, NULL, NULL), STRATUS_INVALID_ARGUMENT);
  assert_true(value == 7.0);
  assert_int_equal(stratus_density_at(context, voxels, 1.0, point, &value, NULL, NULL), STRATUS_OK);
  assert_true(value == 0.0);
  stratus_voxels_destroy(voxels);
}

static int open_context(void** state)
{
  (void)state;
  context = make_context("host", 1);
  return 0;
}

static int close_context(void** state)
{
  (void)state;
  stratus_context_destroy(context);
  return 0;
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(bandwidth_is_that_of_equations_3_and_4),
    cmocka_unit_test(bandwidth_takes_the_median_where_it_is_less),
    cmocka_unit_test(bandwidth_of_nothing_one_two_and_a_shell_is_1),
    cmocka_unit_test(density_and_derivatives_at_points_are_plain_sums),
    cmocka_unit_test(derivatives_are_those_of_the_density),
    cmocka_unit_test(density_integrates_to_one),
    cmocka_unit_test(exact_field_is_the_density_at_each_voxel),
    cmocka_unit_test(binned_field_errs_no_more_than_it_says),
    cmocka_unit_test(binned_field_of_full_bricks_is_exact),
    cmocka_unit_test(fields_have_the_same_bits_at_any_thread_count),
    cmocka_unit_test(peak_is_the_densest_voxel_and_of_equals_the_first),
    cmocka_unit_test(peak_of_a_solid_block_is_its_first_inner_voxel),
    cmocka_unit_test(borders_are_where_the_plain_second_derivative_turns),
    cmocka_unit_test(a_slab_ends_where_its_density_falls),
    cmocka_unit_test(bad_arguments_are_refused_with_their_value),
  };
  return cmocka_run_group_tests(tests, open_context, close_context);
}
