/* SPDX-License-Identifier: BSD-3-Clause
 * Functions of two variables, slices, and gradients that clip planes change, on the OpenCL device against the host's, in packets and one
 * ray a work item, and with tables that change in between. */
#include "testing.h"
#include "transfer_2d_case.h"

#include "device_state.h"

/* Of colours near 1. The set-up of rays divides and takes roots in double, which a device may round otherwise. PoCL and Intel's: 0. */
#define LARGEST_DIFFERENCE 1e-5f

static picture on_host, on_device;

static void compare(
  stratus_context* host, stratus_context* device, stratus_ray_caster* const casters[2], const picture_case* c, const char* what)
{
  float most = 0.0f;
  case_render_with(host, casters[0], c, &on_host);
  case_render_with(device, casters[1], c, &on_device);
  assert_true(stratus_context_on_device(device));
  for (int i = 0; i < 4 * CASE_PIXELS; ++i) {
    most = fmaxf(most, fabsf(on_host.rgba[i] - on_device.rgba[i]));
  }
  print_message("             %s: %d pixels, apart by %g at most\n", what, case_lit(&on_host), (double)most);
  assert_true(case_lit(&on_host) > case_share(50));
  assert_true(most <= LARGEST_DIFFERENCE);
}

static void device_and_host_show_the_same(void** state)
{
  static transfer_2d_case function;
  stratus_context* contexts[2] = { case_context("host", 2), case_context("0", 2) };
  stratus_ray_caster* casters[2] = { NULL, NULL };
  picture_case c;
  contexts[1]->device->is_cpu = !*(const bool*)*state;
  case_create(contexts[0], &c, STRATUS_FLOAT32, 26, 24, 28, 5);
  for (int i = 0; i < 2; ++i) {
    assert_int_equal(stratus_ray_caster_create(contexts[i], &casters[i]), STRATUS_OK);
  }
  compare(contexts[0], contexts[1], casters, &c, "one variable");
  transfer_2d_case_set(&c, &function, 3, 0.25);
  compare(contexts[0], contexts[1], casters, &c, "value and gradient");
  transfer_2d_case_set(&c, &function, 4, 0.25);
  c.options.light.shade = 1;
  c.options.clipping.clip_plane_count = 1;
  const double plane[4] = { 1, 0.4, 0.2, -13 };
  memcpy(c.options.clipping.clip_planes[0], plane, sizeof plane);
  c.options.clipping.clip_gradients = 1;
  compare(contexts[0], contexts[1], casters, &c, "lit, another function, clipped");
  c.options.optics.transfer_2d = NULL;
  compare(contexts[0], contexts[1], casters, &c, "lit, clipped, one variable");
  c.options.light.shade = 0;
  c.options.clipping.clip_plane_count = 0;
  c.options.mode = STRATUS_MODE_SLICE;
  c.options.slice = (stratus_slice){ .center = { 12, 13, 14 }, .linear = { 0.3, 1, -0.2 } };
  compare(contexts[0], contexts[1], casters, &c, "a plane");
  c.options.slice = (stratus_slice){ .center = { 12, 13, 14 }, .square = { 1, 1, 1 }, .constant = -80.0 };
  compare(contexts[0], contexts[1], casters, &c, "a sphere");
  c.options.mode = STRATUS_MODE_COMPOSITE;
  transfer_2d_case_pair(&c, &function, 9);
  transfer_2d_case_set(&c, &function, 13, 0.0);
  compare(contexts[0], contexts[1], casters, &c, "value and second component");
  for (int i = 0; i < 2; ++i) {
    stratus_ray_caster_destroy(casters[i]);
    stratus_context_destroy(contexts[i]);
  }
  free(function.pairs);
  case_destroy(&c);
}

int test_ray_transfer_2d_device(void)
{
  if (stratus_device_count() == 0) {
    return test_skip("no OpenCL device on this machine");
  }
  static bool packets = false, one_ray = true; /* one work item a ray, as on a GPU */
  const struct CMUnitTest tests[] = {
    cmocka_unit_test_prestate(device_and_host_show_the_same, &packets),
    cmocka_unit_test_prestate(device_and_host_show_the_same, &one_ray),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
