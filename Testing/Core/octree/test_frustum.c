/* SPDX-License-Identifier: BSD-3-Clause
 * Frusta: the half-spaces of a camera, and boxes compared with them and with every separating axis. */
#include "octree_case.h"

static bool point_is_inside(const stratus_frustum* frustum, const double point[3])
{
  const double bounds[6] = { point[0], point[0], point[1], point[1], point[2], point[2] };
  return stratus_frustum_side(frustum, bounds, 0) != STRATUS_SIDE_OUTSIDE;
}

/* A point at u, v, k of the camera's rays is inside if all three are within the window by more than rounding. */
static void planes_hold_what_the_camera_s_rays_reach(void** state)
{
  uint32_t random = 1;
  (void)state;
  stratus_context* context = make_context("host", 1);
  int inside = 0, outside = 0;
  for (int repeat = 0; repeat < 2000; ++repeat) {
    stratus_camera camera = { .parallel = repeat % 2, .far_k = repeat % 3 ? 3.0 : INFINITY };
    camera.near_k = camera.parallel && repeat % 5 == 0 ? -INFINITY : 0.5;
    for (int a = 0; a < 3; ++a) {
      camera.eye[a] = random_unit(&random) - 0.5;
      camera.forward[a] = random_unit(&random) - 0.5 + (a == 0);
      camera.right[a] = 0.3 * random_unit(&random) + (a == 1);
      camera.up[a] = 0.3 * random_unit(&random) + (a == 2);
    }
    stratus_frustum frustum;
    assert_int_equal(stratus_frustum_from_camera(context, &camera, &frustum), STRATUS_OK);
    for (int i = 0; i < 20; ++i) {
      const double u = 3.0 * random_unit(&random) - 1.5, v = 3.0 * random_unit(&random) - 1.5, k = 5.0 * random_unit(&random) - 1.0;
      const double least = fmin(fmin(1.0 - fabs(u), 1.0 - fabs(v)), fmin(k - camera.near_k, camera.far_k - k));
      double point[3];
      for (int a = 0; a < 3; ++a) {
        const double across = u * camera.right[a] + v * camera.up[a];
        point[a] = camera.eye[a] + (camera.parallel ? across + k * camera.forward[a] : k * (camera.forward[a] + across));
      }
      if (fabs(least) > 1e-9) {
        assert_int_equal(point_is_inside(&frustum, point), least > 0.0);
        inside += least > 0.0;
        outside += least < 0.0;
      }
    }
  }
  assert_true(inside > 1000 && outside > 1000);
  stratus_context_destroy(context);
}

static void a_visible_box_is_never_outside(void** state)
{
  static const double scales[] = { 1e-6, 1.0, 1e8 };
  uint32_t random = 2;
  int met = 0, kept = 0, kept_exact = 0;
  (void)state;
  stratus_context* context = make_context("host", 1);
  for (int repeat = 0; repeat < 600; ++repeat) {
    const double scale = scales[repeat % 3];
    double inside[3], bounds[6];
    const stratus_frustum frustum = random_frustum(context, &random, scale, inside);
    for (int i = 0; i < 50; ++i) {
      random_bounds(&random, scale, bounds);
      for (int a = 0; a < 3 && i % 3 == 0; ++a) { /* larger ones, for the corners */
        bounds[2 * a + 1] += scale * random_unit(&random);
      }
      const stratus_side plain = stratus_frustum_side(&frustum, bounds, 0), exact = stratus_frustum_side(&frustum, bounds, 1);
      assert_true(plain != STRATUS_SIDE_OUTSIDE || reach_of(&frustum, bounds) < 0.0L);
      assert_true(plain == STRATUS_SIDE_OUTSIDE || reach_of(&frustum, bounds) > -1e-14L);
      const bool meets = box_meets_frustum(&frustum, bounds, inside, 0.0);
      /* Three planes meet in the frustum's corners far more exactly than a millionth of the scene. */
      const bool nearly = box_meets_frustum(&frustum, bounds, inside, 1e-6 * scale);
      assert_true(!meets || (plain != STRATUS_SIDE_OUTSIDE && exact != STRATUS_SIDE_OUTSIDE));
      assert_true(nearly || exact == STRATUS_SIDE_OUTSIDE);
      assert_true(exact != STRATUS_SIDE_INSIDE || meets);
      met += meets;
      kept += plain != STRATUS_SIDE_OUTSIDE;
      kept_exact += exact != STRATUS_SIDE_OUTSIDE;
    }
  }
  assert_true(kept > met + 10); /* or the exact test had nothing to do */
  assert_true(kept_exact - met <= met / 100);
  stratus_context_destroy(context);
}

static void planes_that_are_none_or_let_nothing_through(void** state)
{
  (void)state;
  stratus_frustum frustum = { 0 };
  const double bounds[6] = { -1, 1, -1, 1, -1, 1 }, infinite[6] = { -INFINITY, 1, -1, 1, -1, 1 }, nothing[6] = { NAN, NAN, 0, 1, 0, 1 };
  assert_int_equal(stratus_frustum_side(&frustum, bounds, 1), STRATUS_SIDE_INSIDE);
  assert_int_equal(stratus_frustum_side(&frustum, infinite, 1), STRATUS_SIDE_CROSSING);
  assert_int_equal(stratus_frustum_side(&frustum, nothing, 0), STRATUS_SIDE_CROSSING);
  frustum.planes[5][3] = -1e-300;
  assert_int_equal(stratus_frustum_side(&frustum, bounds, 0), STRATUS_SIDE_OUTSIDE);
  /* Coefficients far from 1 mean the same plane. */
  static const double lengths[] = { 1e-300, 1e-20, 1.0, 1e20, 1e300 };
  for (size_t i = 0; i < sizeof lengths / sizeof *lengths; ++i) {
    const stratus_frustum scaled = { .planes = { { lengths[i], 0, 0, -0.5 * lengths[i] } } };
    const double right[6] = { 0.75, 1, 0, 1, 0, 1 }, left[6] = { 0, 0.25, 0, 1, 0, 1 };
    assert_int_equal(stratus_frustum_side(&scaled, right, 0), STRATUS_SIDE_INSIDE);
    assert_int_equal(stratus_frustum_side(&scaled, bounds, 0), STRATUS_SIDE_CROSSING);
    assert_int_equal(stratus_frustum_side(&scaled, left, 0), STRATUS_SIDE_OUTSIDE);
  }
}

/* Side planes that coincide: a frustum of no volume sees what the plane touches, exact or not. */
static void a_frustum_of_no_volume_sees_what_touches_it(void** state)
{
  (void)state;
  const stratus_frustum flat = { .planes = {
                                   { 1, 0, 0, 0 }, { -1, 0, 0, 0 }, { 0, 1, 0, 1 }, { 0, -1, 0, 1 }, { 0, 0, 1, 1 }, { 0, 0, -1, 1 } } };
  const double through[6] = { -1, 1, 0, 1, 0, 1 }, touching[6] = { 0, 1, 0, 1, 0, 1 }, outside[6] = { 1e-9, 1, 0, 1, 0, 1 };
  for (int exact = 0; exact < 2; ++exact) {
    assert_int_equal(stratus_frustum_side(&flat, through, exact), STRATUS_SIDE_CROSSING);
    assert_int_equal(stratus_frustum_side(&flat, touching, exact), STRATUS_SIDE_CROSSING);
    assert_int_equal(stratus_frustum_side(&flat, outside, exact), STRATUS_SIDE_OUTSIDE);
  }
}

static void what_is_no_frustum_is_refused_with_the_value(void** state)
{
  (void)state;
  stratus_context* context = make_context("host", 1);
  const stratus_camera good = { .forward = { 0, 0, -1 }, .right = { 1, 0, 0 }, .up = { 0, 1, 0 }, .far_k = 1 };
  stratus_frustum frustum = { .eye = { 42 } };
  const stratus_frustum untouched = frustum;
  stratus_camera bad[6] = { good, good, good, good, good, good };
  bad[0].right[0] = 0.0;
  bad[1].up[1] = NAN;
  bad[2].near_k = 2.0;
  bad[3].near_k = -1.0;
  bad[4].eye[2] = INFINITY;
  memcpy(bad[5].up, good.right, sizeof good.right);
  for (int i = 0; i < 6; ++i) {
    assert_int_equal(stratus_frustum_from_camera(context, &bad[i], &frustum), STRATUS_INVALID_ARGUMENT);
    assert_true(strlen(stratus_context_message(context)) > 0);
  }
  assert_int_equal(stratus_frustum_from_camera(context, NULL, &frustum), STRATUS_INVALID_ARGUMENT);
  assert_int_equal(stratus_frustum_from_camera(context, &good, NULL), STRATUS_INVALID_ARGUMENT);
  assert_int_equal(stratus_frustum_from_camera(NULL, &good, &frustum), STRATUS_INVALID_ARGUMENT);
  assert_memory_equal(&frustum, &untouched, sizeof frustum);
  assert_int_equal(stratus_frustum_from_camera(context, &good, &frustum), STRATUS_OK);
  frustum.planes[3][1] = NAN;
  assert_int_equal(stratus_frustum_check(context, &frustum), STRATUS_INVALID_ARGUMENT);
  assert_non_null(strstr(stratus_context_message(context), "planes[3][1]"));
  assert_int_equal(stratus_frustum_check(context, NULL), STRATUS_INVALID_ARGUMENT);
  stratus_context_destroy(context);
}

int test_frustum(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(planes_hold_what_the_camera_s_rays_reach),
    cmocka_unit_test(a_visible_box_is_never_outside),
    cmocka_unit_test(planes_that_are_none_or_let_nothing_through),
    cmocka_unit_test(a_frustum_of_no_volume_sees_what_touches_it),
    cmocka_unit_test(what_is_no_frustum_is_refused_with_the_value),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
