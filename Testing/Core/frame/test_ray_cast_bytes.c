/* SPDX-License-Identifier: BSD-3-Clause
 * The picture in bytes is the float picture rounded, on host and device and in every pixel. Nothing shows outside the reported window. */
#include "picture_case.h"
#include "testing.h"

static picture shown;
static uint8_t bytes[4 * CASE_PIXELS_MOST];

static void render_bytes(stratus_context* context, const picture_case* c)
{
  stratus_ray_caster* caster = NULL;
  const stratus_image image = {
    .width = CASE_WIDTH, .height = CASE_HEIGHT, .rgba = shown.rgba, .opaque_depth = c->opaque_depth, .rgba8 = bytes
  };
  memset(shown.rgba, 0xff, sizeof shown.rgba); /* NaN, so that a pixel left out is noticed */
  memset(bytes, 0xa5, sizeof bytes);
  memset(&shown.report, 0xff, sizeof shown.report);
  assert_int_equal(stratus_ray_caster_create(context, &caster), STRATUS_OK);
  assert_int_equal(stratus_ray_caster_render(caster, &c->volume, &c->transfer, &c->camera, &c->options, &image, &shown.report), STRATUS_OK);
  stratus_ray_caster_destroy(caster);
}

/* Compares bytes with floats; returns the number of pixels outside the window. */
static int expect_rounded(uint32_t seed)
{
  const int* w = shown.report.window;
  int outside = 0;
  assert_true(w[0] >= 0 && w[0] <= w[1] && w[1] <= CASE_WIDTH && w[2] >= 0 && w[2] <= w[3] && w[3] <= CASE_HEIGHT);
  for (int i = 0; i < 4 * CASE_PIXELS; ++i) {
    const int x = i / 4 % CASE_WIDTH, y = i / 4 / CASE_WIDTH;
    const double exact = fmin(255.0, 255.0 * (double)shown.rgba[i]);
    /* Half a byte, and the rounding of a float's product before it is cut. */
    if (!(fabs(exact - bytes[i]) <= 0.5 + 255.0 * 0x1p-23)) {
      print_error("seed %u, pixel (%d, %d): byte %d for %.9g\n", seed, x, y, bytes[i], (double)shown.rgba[i]);
      fail();
    }
    if (x < w[0] || x >= w[1] || y < w[2] || y >= w[3]) {
      assert_true(shown.rgba[i] == 0.0f);
      ++outside;
    }
  }
  return outside / 4;
}

static void expect_bytes(const char* device, uint32_t seeds)
{
  stratus_context* context = case_context(device, 2);
  int lit = 0, outside = 0, inside = 0;
  for (uint32_t seed = 1; seed <= seeds; ++seed) {
    picture_case c;
    case_create_random(context, seed, &c);
    c.options.skipping.audit = seed % 3 == 0; /* draws again, but not into the caller's bytes */
    render_bytes(context, &c);
    const int beyond = expect_rounded(seed);
    lit += case_lit(&shown) > 0;
    outside += beyond > 0;
    inside += beyond < CASE_PIXELS;
    case_destroy(&c);
  }
  print_message(
    "             %d of %u pictures show something, %d have pixels outside the window, %d inside\n", lit, seeds, outside, inside);
  const int least = (int)seeds / 4 < 3 ? (int)seeds / 4 : 3;
  assert_true(lit > least && outside > least && inside > least); /* else the cases test little */
  stratus_context_destroy(context);
}

static void bytes_are_the_rounded_picture(void** state)
{
  (void)state;
  expect_bytes("host", 60);
}

static void bytes_are_the_rounded_picture_on_a_device(void** state)
{
  (void)state;
  expect_bytes("0", few_run() ? 4 : 12);
}

/* Colours above 1 don't wrap around. */
static void bytes_stop_at_255(void** state)
{
  (void)state;
  stratus_context* context = case_context("host", 1);
  picture_case c;
  case_create(context, &c, STRATUS_FLOAT32, 20, 20, 20, 3);
  for (int i = 0; i < 12; ++i) {
    c.color[i] = i % 4 == 0 ? c.color[i] : 1.0;
  }
  for (int i = 1; i < 8; i += 2) {
    c.opacity[i] = 1.0;
  }
  render_bytes(context, &c);
  expect_rounded(0);
  int full = 0;
  for (int i = 0; i < 4 * CASE_PIXELS; ++i) {
    full += bytes[i] == 255;
  }
  assert_true(full > 1000);
  case_destroy(&c);
  stratus_context_destroy(context);
}

static void an_empty_picture_has_no_window(void** state)
{
  (void)state;
  stratus_context* context = case_context("host", 1);
  picture_case c;
  case_create(context, &c, STRATUS_UINT8, 9, 9, 9, 5);
  for (int i = 1; i < 8; i += 2) {
    c.opacity[i] = 0.0;
  }
  render_bytes(context, &c);
  assert_int_equal(expect_rounded(0), CASE_PIXELS);
  case_destroy(&c);
  stratus_context_destroy(context);
}

int test_ray_cast_bytes(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(bytes_are_the_rounded_picture),
    cmocka_unit_test(bytes_stop_at_255),
    cmocka_unit_test(an_empty_picture_has_no_window),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}

int test_ray_cast_bytes_device(void)
{
  const struct CMUnitTest tests[] = { cmocka_unit_test(bytes_are_the_rounded_picture_on_a_device) };
  return stratus_device_count() == 0 ? test_skip("no OpenCL device on this machine") : cmocka_run_group_tests(tests, NULL, NULL);
}
