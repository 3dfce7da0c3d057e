/* SPDX-License-Identifier: BSD-3-Clause
 * Cameras: the rays that the public header promises, and the cameras that are refused. */
#include "structures.h"

static double dot(const double a[3], const double b[3])
{
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* The tolerance covers ten roundings of numbers of order one. */
static void assert_near(double value, double expected)
{
  if (!(fabs(value - expected) <= 1e-14 * fmax(1.0, fabs(expected)))) {
    fail_msg("%.17g, not %.17g", value, expected);
  }
}

static void axes_are_orthogonal_and_as_long_as_the_window(void** state)
{
  uint32_t random = 1;
  (void)state;
  stratus_context* context = make_context("host", 1);
  for (int repeat = 0; repeat < 200; ++repeat) {
    double eye[3], focal[3], up[3];
    for (int a = 0; a < 3; ++a) {
      eye[a] = (double)random_below(&random, 2000) - 1000.0;
      focal[a] = (double)random_below(&random, 2000) - 1000.5;
      up[a] = (double)random_below(&random, 200) - 100.25;
    }
    const double aspect = 0.1 + (double)random_below(&random, 40) / 10.0, size = 1.0 + (double)random_below(&random, 170);
    for (int parallel = 0; parallel < 2; ++parallel) {
      stratus_camera camera;
      const double half = parallel ? size : tan(size * 3.14159265358979323846 / 360.0);
      assert_int_equal(parallel ? stratus_camera_parallel(context, eye, focal, up, size, aspect, &camera)
                                : stratus_camera_perspective(context, eye, focal, up, size, aspect, &camera),
        STRATUS_OK);
      assert_near(dot(camera.forward, camera.forward), 1.0);
      assert_near(dot(camera.forward, camera.right) / (half * aspect), 0.0);
      assert_near(dot(camera.forward, camera.up) / half, 0.0);
      assert_near(dot(camera.up, camera.right) / (half * half * aspect), 0.0);
      assert_near(sqrt(dot(camera.up, camera.up)) / half, 1.0);
      assert_near(sqrt(dot(camera.right, camera.right)) / (half * aspect), 1.0);
      assert_true(dot(camera.up, up) > 0.0);
      assert_memory_equal(camera.eye, eye, sizeof eye);
      assert_true(camera.near_k == 0.0 && camera.far_k == INFINITY && camera.parallel == parallel);
    }
  }
  stratus_context_destroy(context);
}

static void right_is_right(void** state)
{
  (void)state;
  stratus_context* context = make_context("host", 1);
  stratus_camera camera;
  assert_int_equal(stratus_camera_perspective(
                     context, (const double[]){ 0, 0, 5 }, (const double[]){ 0, 0, 0 }, (const double[]){ 0, 1, 0 }, 90.0, 2.0, &camera),
    STRATUS_OK);
  assert_near(camera.right[0], 2.0);
  assert_near(camera.up[1], 1.0);
  assert_near(camera.forward[2], -1.0);
  stratus_context_destroy(context);
}

static void far_and_tiny_scenes_are_aimed_at(void** state)
{
  static const double scales[] = { 1e-300, 1e-6, 6e6, 1e300 };
  (void)state;
  stratus_context* context = make_context("host", 1);
  for (size_t s = 0; s < sizeof scales / sizeof *scales; ++s) {
    stratus_camera camera;
    const double eye[3] = { 0, 0, scales[s] }, focal[3] = { 0, scales[s], 0 }, up[3] = { 0, 0, scales[s] };
    assert_int_equal(stratus_camera_perspective(context, eye, focal, up, 30.0, 1.0, &camera), STRATUS_OK);
    assert_near(camera.forward[1], sqrt(0.5));
    assert_near(camera.forward[2], -sqrt(0.5));
  }
  stratus_context_destroy(context);
}

/* Every corner is inside of the window, and one of them touches the frame. */
static void framed_boxes_fill_the_window(void** state)
{
  uint32_t random = 3;
  (void)state;
  stratus_context* context = make_context("host", 1);
  for (int repeat = 0; repeat < 300; ++repeat) {
    double bounds[6], most = 0.0;
    for (int a = 0; a < 3; ++a) {
      bounds[2 * a] = (double)random_below(&random, 2000) - 1000.0;
      bounds[2 * a + 1] = bounds[2 * a] + (double)random_below(&random, repeat % 3 == a ? 1 : 500);
    }
    bounds[1] += 1.0;
    const double azimuth = (double)random_below(&random, 720) - 360.0, elevation = (double)random_below(&random, 179) - 89.0;
    const double angle = repeat % 2 ? 1.0 + (double)random_below(&random, 120) : 0.0,
                 aspect = 0.2 + (double)random_below(&random, 40) / 10.0;
    stratus_camera camera;
    assert_int_equal(stratus_camera_frame(context, bounds, repeat % 3, azimuth, elevation, angle, aspect, &camera), STRATUS_OK);
    assert_int_equal(camera.parallel, angle == 0.0);
    assert_true(camera.up[repeat % 3] > 0.0);
    assert_near(-camera.forward[repeat % 3], sin(elevation * 3.14159265358979323846 / 180.0));
    for (int corner = 0; corner < 8; ++corner) {
      double p[3];
      for (int a = 0; a < 3; ++a) {
        p[a] = bounds[2 * a + (corner >> a & 1)] - camera.eye[a];
      }
      const double k = dot(p, camera.forward), scale = camera.parallel ? 1.0 : k;
      assert_true(k > 0.0);
      const double u = dot(p, camera.right) / dot(camera.right, camera.right) / scale;
      const double v = dot(p, camera.up) / dot(camera.up, camera.up) / scale;
      most = fmax(most, fmax(fabs(u), fabs(v)));
    }
    assert_true(fabs(most - 0.95) < 1e-9);
  }
  stratus_camera camera;
  const double box[6] = { 0, 1, 0, 1, 0, 1 }, point[6] = { 1, 1, 2, 2, 3, 3 }, turned[6] = { 1, 0, 0, 1, 0, 1 };
  assert_int_equal(stratus_camera_frame(context, box, 3, 0, 0, 30, 1, &camera), STRATUS_INVALID_ARGUMENT);
  assert_non_null(strstr(stratus_context_message(context), "up_axis 3 outside 0..2"));
  assert_int_equal(stratus_camera_frame(context, box, 2, 0, 90, 30, 1, &camera), STRATUS_INVALID_ARGUMENT);
  assert_int_equal(stratus_camera_frame(context, box, 2, 0, 0, 180, 1, &camera), STRATUS_INVALID_ARGUMENT);
  assert_int_equal(stratus_camera_frame(context, box, 2, NAN, 0, 30, 1, &camera), STRATUS_INVALID_ARGUMENT);
  assert_int_equal(stratus_camera_frame(context, box, 2, 0, 0, 30, 0, &camera), STRATUS_INVALID_ARGUMENT);
  assert_int_equal(stratus_camera_frame(context, point, 2, 0, 0, 30, 1, &camera), STRATUS_INVALID_ARGUMENT);
  assert_non_null(strstr(stratus_context_message(context), "diagonal"));
  assert_int_equal(stratus_camera_frame(context, turned, 2, 0, 0, 30, 1, &camera), STRATUS_INVALID_ARGUMENT);
  stratus_context_destroy(context);
}

static void what_is_no_camera_is_refused_with_the_value(void** state)
{
  (void)state;
  stratus_context* context = make_context("host", 1);
  const double eye[3] = { 0, 0, 5 }, focal[3] = { 0, 0, 0 }, up[3] = { 0, 1, 0 }, bad[3] = { 0, NAN, 0 }, zero[3] = { 0, 0, 0 };
  const double along[3] = { 0, 0, -3 }, huge[3] = { 0, 0, -1.7e308 }, opposite[3] = { 0, 0, 1.7e308 };
  const stratus_camera untouched = { .near_k = 42.0 };
  stratus_camera camera = untouched;
  static const double angles[] = { 0.0, -1.0, 180.0, 200.0, NAN, INFINITY };
  static const double scales[] = { 0.0, -1.0, NAN, INFINITY };
  for (size_t i = 0; i < sizeof angles / sizeof *angles; ++i) {
    assert_int_equal(stratus_camera_perspective(context, eye, focal, up, angles[i], 1.0, &camera), STRATUS_INVALID_ARGUMENT);
    assert_non_null(strstr(stratus_context_message(context), "view_angle"));
  }
  for (size_t i = 0; i < sizeof scales / sizeof *scales; ++i) {
    assert_int_equal(stratus_camera_parallel(context, eye, focal, up, scales[i], 1.0, &camera), STRATUS_INVALID_ARGUMENT);
    assert_int_equal(stratus_camera_parallel(context, eye, focal, up, 1.0, scales[i], &camera), STRATUS_INVALID_ARGUMENT);
    assert_non_null(strstr(stratus_context_message(context), "aspect"));
  }
  assert_int_equal(stratus_camera_perspective(context, bad, focal, up, 30.0, 1.0, &camera), STRATUS_INVALID_ARGUMENT);
  assert_non_null(strstr(stratus_context_message(context), "eye[1]"));
  assert_int_equal(stratus_camera_perspective(context, eye, bad, up, 30.0, 1.0, &camera), STRATUS_INVALID_ARGUMENT);
  assert_int_equal(stratus_camera_perspective(context, eye, focal, bad, 30.0, 1.0, &camera), STRATUS_INVALID_ARGUMENT);
  assert_int_equal(stratus_camera_perspective(context, eye, eye, up, 30.0, 1.0, &camera), STRATUS_INVALID_ARGUMENT);
  assert_int_equal(stratus_camera_perspective(context, huge, opposite, up, 30.0, 1.0, &camera), STRATUS_INVALID_ARGUMENT);
  assert_int_equal(stratus_camera_perspective(context, eye, focal, zero, 30.0, 1.0, &camera), STRATUS_INVALID_ARGUMENT);
  assert_int_equal(stratus_camera_perspective(context, eye, focal, along, 30.0, 1.0, &camera), STRATUS_INVALID_ARGUMENT);
  assert_non_null(strstr(stratus_context_message(context), "parallel"));
  assert_int_equal(stratus_camera_perspective(context, NULL, focal, up, 30.0, 1.0, &camera), STRATUS_INVALID_ARGUMENT);
  assert_int_equal(stratus_camera_perspective(context, eye, focal, up, 30.0, 1.0, NULL), STRATUS_INVALID_ARGUMENT);
  assert_int_equal(stratus_camera_perspective(NULL, eye, focal, up, 30.0, 1.0, &camera), STRATUS_INVALID_ARGUMENT);
  assert_memory_equal(&camera, &untouched, sizeof camera);
  stratus_context_destroy(context);
}

int test_camera(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(axes_are_orthogonal_and_as_long_as_the_window),
    cmocka_unit_test(right_is_right),
    cmocka_unit_test(far_and_tiny_scenes_are_aimed_at),
    cmocka_unit_test(framed_boxes_fill_the_window),
    cmocka_unit_test(what_is_no_camera_is_refused_with_the_value),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
