/* SPDX-License-Identifier: BSD-3-Clause
 * Bandwidth, and density and its derivatives at points, compared with plain sums over all voxels. */
#include "stratus.h"

#include "density_plain.h"
#include "testing.h"

#include <pthread.h>

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
  for (int64_t v = 0; v < voxels->count; ++v) {
    for (int a = 0; a < 3; ++a) {
      mean[a] += at[v][a] / n;
    }
  }
  for (int64_t v = 0; v < voxels->count; ++v) {
    const double x = at[v][0] - mean[0], y = at[v][1] - mean[1], z = at[v][2] - mean[2];
    distance[v] = sqrt(x * x + y * y + z * z);
    average += distance[v] / n;
  }
  for (int64_t v = 0; v < voxels->count; ++v) {
    variance += (distance[v] - average) * (distance[v] - average) / n;
  }
  qsort(distance, (size_t)voxels->count, sizeof *distance, compare_doubles);
  const double median = distance[voxels->count / 2];
  return 0.9 * fmin(sqrt(variance), sqrt(1.0 / log(2.0)) * median) * pow(n, -0.2);
}

/* The tolerance is 1e-9 of the box's length: distances round at 1e-16 of it, the square root of small deviations at 1e-8 of these, and the
 * median is bracketed to 2^-36 of the largest squared distance. */
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
  for (int repeat = 0; repeat < 200; ++repeat) {
    stratus_voxels* voxels = random_set(&random, repeat % 10 ? 40 : 9000, 1500);
    check_bandwidth(voxels, repeat % 10 ? 40.0 : 9000.0);
    stratus_voxels_destroy(voxels);
  }
}

/* Most voxels lie near the middle and a few far out, so that the median gives the smaller spread. */
static void bandwidth_takes_the_median_where_it_is_less(void** state)
{
  (void)state;
  set_begin(&set, 300, 300, 300);
  set_add_box(&set, 148, 153, 148, 153, 148, 153);
  for (int i = 0; i < 8; ++i) {
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
  for (int count = 0; count < 3; ++count) {
    set_begin(&set, 50, 50, 50);
    for (int i = 0; i < count; ++i) {
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

static void density_and_derivatives_at_points_are_plain_sums(void** state)
{
  uint32_t random = 2;
  (void)state;
  for (int repeat = 0; repeat < 3000; ++repeat) {
    stratus_voxels* voxels = random_set(&random, 24, 60);
    const double h = random_bandwidth(&random);
    const double unit = 105.0 / (32.0 * PI) / (h * h * h);
    double p[3], density, first[3], second[3], again;
    for (int a = 0; a < 3; ++a) {
      p[a] = repeat % 2 ? (double)(random_below(&random, 60) - 15) / 2.0 : (double)random_below(&random, 40000) / 1000.0 - 8.0;
    }
    int edge;
    const plain expected = sum_plainly(voxels, h, p, &edge);
    assert_int_equal(stratus_density_at(context, voxels, h, p, &density, first, second), STRATUS_OK);
    assert_near(density, expected.density, 1e-13 * unit);
    for (int a = 0; a < 3; ++a) {
      assert_near(first[a], expected.first[a], 1e-12 * unit / h);
      if (!edge) {
        assert_near(second[a], expected.second[a], 1e-12 * unit / (h * h));
      }
    }
    assert_int_equal(stratus_density_at(context, voxels, h, p, &again, NULL, NULL), STRATUS_OK);
    assert_true(again == density);
    stratus_voxels_destroy(voxels);
  }
}

/* The derivatives equal central differences of the density and of its first derivative, away from the kernel's end. */
static void derivatives_are_those_of_the_density(void** state)
{
  uint32_t random = 3;
  int compared = 0;
  (void)state;
  for (int repeat = 0; repeat < 400; ++repeat) {
    stratus_voxels* voxels = random_set(&random, 12, 60);
    const double h = 2.0 + (double)random_below(&random, 300) / 100.0, step = 1e-4 * h, unit = 105.0 / (32.0 * PI) / (h * h * h);
    double p[3], at_p, first[3], second[3];
    int edge = 0;
    for (int a = 0; a < 3; ++a) {
      p[a] = (double)random_below(&random, 12000) / 1000.0;
    }
    for (int64_t v = 0; v < voxels->count; ++v) {
      edge |= fabs(sqrt(pow(p[0] - at[v][0], 2) + pow(p[1] - at[v][1], 2) + pow(p[2] - at[v][2], 2)) - h) < 4 * step;
    }
    assert_int_equal(stratus_density_at(context, voxels, h, p, &at_p, first, second), STRATUS_OK);
    for (int a = 0; a < 3 && !edge; ++a) {
      double before[3] = { p[0], p[1], p[2] }, behind[3] = { p[0], p[1], p[2] }, low, high, low_first[3], high_first[3];
      before[a] -= step;
      behind[a] += step;
      assert_int_equal(stratus_density_at(context, voxels, h, before, &low, low_first, NULL), STRATUS_OK);
      assert_int_equal(stratus_density_at(context, voxels, h, behind, &high, high_first, NULL), STRATUS_OK);
      /* The third derivative is at most 24 of these units, so the error at most 4 step^2: 4e-8; differences round at 1e-12. */
      assert_near((high - low) / (2 * step), first[a], 1e-7 * unit / h);
      assert_near((high_first[a] - low_first[a]) / (2 * step), second[a], 1e-6 * unit / (h * h));
      ++compared;
    }
    stratus_voxels_destroy(voxels);
  }
  assert_true(compared > 300);
}

/* The constant is right only if the density integrates to 1 over all space. */
static void density_integrates_to_one(void** state)
{
  (void)state;
  set_begin(&set, 3, 3, 3);
  set_add(&set, 1, 1, 1);
  set_add(&set, 2, 1, 0);
  stratus_voxels* voxels = make_voxels(context, &set);
  double sum = 0.0;
  const double h = 2.0, step = 0.1;
  for (int k = 0; k < 80; ++k) {
    for (int j = 0; j < 80; ++j) {
      for (int i = 0; i < 80; ++i) {
        double density;
        assert_int_equal(stratus_density_at(context, voxels, h, (const double[3]){ i * step - 2.95, j * step - 2.95, k * step - 2.95 },
                           &density, NULL, NULL),
          STRATUS_OK);
        sum += density * step * step * step;
      }
    }
  }
  assert_near(sum, 1.0, 1e-4); /* the midpoint rule's error of a kernel 20 steps wide whose second derivative jumps */
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
  for (int i = 0; i < 6; ++i) {
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

/* ---- stacks */

#ifdef __has_feature /* clang's way */
#define FEATURE(name) __has_feature(name)
#else
#define FEATURE(name) 0
#endif
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__) && !FEATURE(address_sanitizer) && !FEATURE(thread_sanitizer)
#define SMALL_STACK (40 << 10)

static void* work(void* result)
{
  stratus_status* status = result;
  stratus_context_options options = stratus_context_options_default();
  stratus_context* own = NULL;
  stratus_voxels* voxels = NULL;
  stratus_density* density = NULL;
  stratus_scene* scene = NULL;
  double bandwidth;
  options.device = "host";
  options.threads = 1;
  *status = stratus_context_create(&options, &own, NULL, 0);
  *status = *status ? *status : stratus_scene_create(own, "haze", &scene);
  *status = *status ? *status : stratus_voxels_create_list(own, set.dimensions, &set.at[0][0], set.count, &voxels);
  *status = *status ? *status : stratus_density_bandwidth(own, voxels, &bandwidth, NULL);
  *status = *status ? *status : stratus_density_create(own, voxels->bricks, voxels->brick_count, bandwidth, 1, &density);
  stratus_density_destroy(density);
  stratus_voxels_destroy(voxels);
  stratus_scene_destroy(own, scene);
  stratus_context_destroy(own);
  return NULL;
}

/* OpenMP's only thread has the caller's stack. */
static void a_thread_with_a_small_stack_gets_its_answer(void** state)
{
  (void)state;
  pthread_attr_t attributes;
  pthread_t thread;
  stratus_status status = STRATUS_INVALID_ARGUMENT;
  set_begin(&set, 4000, 4000, 4000); /* so sparse that the list is sorted */
  set_add_box(&set, 148, 153, 148, 153, 148, 153);
  set_add(&set, 0, 0, 0);
  set_add(&set, 3999, 3999, 3999);
  assert_int_equal(pthread_attr_init(&attributes), 0);
  assert_int_equal(pthread_attr_setstacksize(&attributes, SMALL_STACK), 0);
  assert_int_equal(pthread_create(&thread, &attributes, work, &status), 0);
  assert_int_equal(pthread_join(thread, NULL), 0);
  assert_int_equal(status, STRATUS_OK);
  pthread_attr_destroy(&attributes);
}
#endif

int test_density(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(bandwidth_is_that_of_equations_3_and_4),
    cmocka_unit_test(bandwidth_takes_the_median_where_it_is_less),
    cmocka_unit_test(bandwidth_of_nothing_one_two_and_a_shell_is_1),
    cmocka_unit_test(density_and_derivatives_at_points_are_plain_sums),
    cmocka_unit_test(derivatives_are_those_of_the_density),
    cmocka_unit_test(density_integrates_to_one),
    cmocka_unit_test(bad_arguments_are_refused_with_their_value),
  };
  return cmocka_run_group_tests(tests, open_context, close_context);
}

int test_density_small_stack(void)
{
#ifdef SMALL_STACK
  const struct CMUnitTest tests[] = { cmocka_unit_test(a_thread_with_a_small_stack_gets_its_answer) };
  return cmocka_run_group_tests(tests, open_context, close_context);
#else
  return test_skip("sanitizers make stacks larger");
#endif
}
