/* SPDX-License-Identifier: BSD-3-Clause
 * The picture by which host and devices are compared, and the comparison of times. Devices draw it in test_device_choice.c. */
#include "calibration_picture.h"
#include "device_choice.h"
#include "faulty_allocator.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static void the_fastest_is_taken_and_of_equals_the_first(void** state)
{
  (void)state;
  assert_int_equal(stratus_device_fastest(10.0, (const double[]){ 9.0 }, 1), 0);
  assert_int_equal(stratus_device_fastest(10.0, (const double[]){ 10.0 }, 1), -1);
  assert_int_equal(stratus_device_fastest(10.0, (const double[]){ 11.0 }, 1), -1);
  assert_int_equal(stratus_device_fastest(10.0, (const double[]){ 11.0, 4.0, 3.0, 3.0, 12.0 }, 5), 2);
  assert_int_equal(stratus_device_fastest(10.0, (const double[]){ INFINITY, 4.0 }, 2), 1);
  assert_int_equal(stratus_device_fastest(10.0, (const double[]){ INFINITY, INFINITY }, 2), -1);
  assert_int_equal(stratus_device_fastest(INFINITY, (const double[]){ INFINITY }, 1), -1);
  assert_int_equal(stratus_device_fastest(10.0, NULL, 0), -1);
}

static stratus_context* make_host(void)
{
  stratus_context_options options = stratus_context_options_default();
  stratus_context* context = NULL;
  options.device = "host";
  assert_int_equal(stratus_context_create(&options, &context, NULL, 0), STRATUS_OK);
  return context;
}

/* One pixel in double precision. If a value falls between two entries of the table, rounding may take the other, and the light of two
 * entries differs by .1/256 at most: two of 48 samples may fall so. */
static void expect_pixel(int x, int y, const float pixel[4])
{
  double light[4] = { 0.0 };
  for (int i = 0; i < 48; ++i) {
    const double at[3] = { 2.0 + x * 48.0 / 512 + 0.2 * i, 3.0 + y * 48.0 / 512 + 0.1 * i, 1.0 + 1.25 * i };
    double wave = 1.0;
    for (int a = 0; a < 3; ++a) {
      const double low = floor(at[a]), part = at[a] - low;
      wave *= (1.0 - part) * sin(0.37 * low + 0.5) + part * sin(0.37 * (low + 1.0) + 0.5);
    }
    const double entry = floor((0.5 + 0.45 * wave) * 255.0) / 256.0, opacity = 0.05 * entry;
    const double color[4] = { entry, 1.0 - entry, 0.5, 1.0 };
    const double before = 1.0 - light[3];
    for (int c = 0; c < 4; ++c) {
      light[c] += before * opacity * color[c];
    }
  }
  for (int c = 0; c < 4; ++c) {
    assert_true(fabs(pixel[c] - light[c]) < 2 * 0.1 / 256);
  }
}

static void the_picture_is_what_rays_gather_by_every_instruction_set(void** state)
{
  stratus_context* host = make_host();
  stratus_context context = *host;
  float* pictures[2];
  double ms = 0.0;
  (void)state;
  for (int i = 0; i < 2; ++i) {
    pictures[i] = calloc(STRATUS_CALIBRATION_FLOATS, sizeof(float));
    assert_non_null(pictures[i]);
  }
  assert_int_equal(stratus_calibration_picture(&context, pictures[0], &ms), STRATUS_OK);
  assert_true(ms > 0.0 && ms < INFINITY);
  for (int i = 0; i < 512; i += 13) {
    expect_pixel(i, (7 * i + 3) % 512, pictures[0] + 4 * ((7 * i + 3) % 512 * 512 + i));
  }
  expect_pixel(511, 511, pictures[0] + STRATUS_CALIBRATION_FLOATS - 4);
  for (context.isa = host->isa - 1; context.isa >= 0; --context.isa) {
    assert_int_equal(stratus_calibration_picture(&context, pictures[1], &ms), STRATUS_OK);
    assert_memory_equal(pictures[0], pictures[1], STRATUS_CALIBRATION_FLOATS * sizeof(float));
  }
  free(pictures[0]);
  free(pictures[1]);
  stratus_context_destroy(host);
}

static void a_picture_without_memory_is_an_error(void** state)
{
  faulty_allocator allocator = { 0 };
  stratus_context_options options = faulty_options(&allocator, "host");
  stratus_context* context = NULL;
  static float nothing[STRATUS_CALIBRATION_FLOATS];
  double ms;
  (void)state;
  assert_int_equal(stratus_context_create(&options, &context, NULL, 0), STRATUS_OK);
  const int64_t live = allocator.live;
  allocator.fail_at = allocator.calls + 1;
  assert_int_equal(stratus_calibration_picture(context, nothing, &ms), STRATUS_OUT_OF_MEMORY);
  assert_int_equal(allocator.live, live);
  stratus_context_destroy(context);
}

int test_calibration_picture(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(the_fastest_is_taken_and_of_equals_the_first),
    cmocka_unit_test(the_picture_is_what_rays_gather_by_every_instruction_set),
    cmocka_unit_test(a_picture_without_memory_is_an_error),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
