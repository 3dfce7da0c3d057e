/* SPDX-License-Identifier: BSD-3-Clause
 * A picture of components, gradient opacity and labels whose n-th allocation fails: a clean error, no leak, and the right picture from the
 * same caster at the next attempt. */
#include "faulty_allocator.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#define SIDE 10
#define PIXELS 24
#define REQUESTS_MAX 400

typedef struct shading_case {
  float values[2 * SIDE * SIDE * SIDE];
  uint8_t labels[SIDE * SIDE * SIDE];
  stratus_volume volume;
  stratus_transfer transfers[3];
  stratus_camera camera;
  stratus_ray_cast_options options;
} shading_case;

static const double opacity[] = { 0.2, 0.0, 1.0, 0.6 };
static const double color[] = { 0.0, 0.9, 0.5, 0.2 };
static const double steep[] = { 0.0, 0.1, 0.2, 1.0 };

static void fill(stratus_context* context, shading_case* c, int labels)
{
  double bounds[6];
  memset(c, 0, sizeof *c);
  for (int v = 0; v < SIDE * SIDE * SIDE; ++v) {
    c->values[2 * v] = (float)(v % SIDE) / SIDE;
    c->values[2 * v + 1] = (float)(v / SIDE % SIDE) / SIDE;
    c->labels[v] = (uint8_t)(v % 3);
  }
  c->volume = stratus_volume_default();
  c->volume.values = c->values;
  c->volume.value_stride = 2;
  c->volume.components = labels ? 1 : 2;
  for (int i = 0; i < 3; ++i) {
    c->volume.dimensions[i] = SIDE;
    c->volume.spacing[i] = 1.0;
    c->transfers[i] = stratus_transfer_default();
    c->transfers[i].opacity = opacity;
    c->transfers[i].opacity_count = 2;
    c->transfers[i].color = color;
    c->transfers[i].color_count = 1;
  }
  c->transfers[0].gradient = steep;
  c->transfers[0].gradient_count = 2;
  c->options = stratus_ray_cast_options_default();
  c->options.light.shade = 1;
  c->options.skipping.structure = STRATUS_STRUCTURE_DISTANCE;
  c->options.mask.bytes = labels ? c->labels : NULL;
  c->options.mask.label_count = labels ? 2 : 0;
  assert_int_equal(stratus_volume_bounds(context, &c->volume, bounds), STRATUS_OK);
  assert_int_equal(stratus_scene_camera(context, bounds, 2, 1, 0, 1.0, &c->camera), STRATUS_OK);
}

/* *measured: 0 if memory for the probe was refused, so that the picture was drawn with another setting. */
static stratus_status draw(stratus_ray_caster* caster, const shading_case* c, float* rgba, int* measured)
{
  const stratus_image image = { .width = PIXELS, .height = PIXELS, .rgba = rgba };
  stratus_ray_cast_report report = { 0 };
  const stratus_status status = stratus_ray_caster_render(caster, &c->volume, c->transfers, &c->camera, &c->options, &image, &report);
  *measured = strstr(report.why, "no memory to measure") == NULL;
  return status;
}

static void each_allocation_may_fail(int labels)
{
  static shading_case c;
  static float right[4 * PIXELS * PIXELS], again[4 * PIXELS * PIXELS];
  faulty_allocator allocator = { 0 };
  const stratus_context_options options = faulty_options(&allocator, "host");
  stratus_context* context = NULL;
  stratus_ray_caster* caster = NULL;
  int measured = 0;
  assert_int_equal(stratus_context_create(&options, &context, NULL, 0), STRATUS_OK);
  fill(context, &c, labels);
  assert_int_equal(stratus_ray_caster_create(context, &caster), STRATUS_OK);
  assert_int_equal(draw(caster, &c, right, &measured), STRATUS_OK);
  stratus_ray_caster_destroy(caster);
  float sum = 0.0f;
  for (int i = 0; i < 4 * PIXELS * PIXELS; ++i) {
    sum += right[i];
  }
  assert_true(sum > 10.0f);
  const int64_t live = allocator.live;
  int failures = 0, done = 0;
  for (int64_t n = 1; !done; ++n) {
    assert_true(n < REQUESTS_MAX);
    assert_int_equal(stratus_ray_caster_create(context, &caster), STRATUS_OK);
    allocator.fail_at = allocator.calls + n;
    const stratus_status status = draw(caster, &c, again, &measured);
    done = allocator.calls < allocator.fail_at;
    allocator.fail_at = 0;
    if (status != STRATUS_OK || !measured) {
      assert_true(status == STRATUS_OUT_OF_MEMORY || status == STRATUS_OK);
      ++failures;
      assert_int_equal(draw(caster, &c, again, &measured), STRATUS_OK);
      assert_true(measured);
    }
    assert_memory_equal(again, right, sizeof right);
    stratus_ray_caster_destroy(caster);
    assert_int_equal(allocator.live, live);
  }
  assert_true(failures > 10);
  stratus_context_destroy(context);
  assert_int_equal(allocator.live, 0);
}

static void components_and_gradient_opacity(void** state)
{
  (void)state;
  each_allocation_may_fail(0);
}

static void labels(void** state)
{
  (void)state;
  each_allocation_may_fail(1);
}

int test_shading_fails(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(components_and_gradient_opacity),
    cmocka_unit_test(labels),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
