/* SPDX-License-Identifier: BSD-3-Clause
 * Pictures of rectilinear grids by the OpenCL device equal the host's to the bit, in every mode, by packets and by one work item a ray. The
 * device keeps the grid's tables until the coordinates change. */
#include "grid_case.h"
#include "testing.h"

#include "device_state.h"

static picture on_host, on_device;

typedef enum grid_look {
  MIDPOINT,
  PREINTEGRATED,
  CELLS,
  LOCAL,
  MAXIMUM,
  ADDITIVE,
  ISOSURFACE,
  LIT,
  NEAREST_CELLS,
  FIRST_HIT,
  FIRST_HIT_CELLS,
  LOOKS
} grid_look;

static void make_look(stratus_context* context, grid_look look, picture_case* c, grid_case* grid)
{
  const double base = case_type_values[STRATUS_FLOAT32].base, scale = case_type_values[STRATUS_FLOAT32].scale;
  uint32_t random = (uint32_t)look;
  if (look == LOCAL) {
    case_create_local(context, 2, c);
  } else {
    case_create(context, c, STRATUS_FLOAT32, 24, 31, 19, 4u + (uint32_t)look);
  }
  c->volume.cell_centered = look % 2;
  c->options.sampling.rule = look == PREINTEGRATED ? STRATUS_SAMPLING_PREINTEGRATED
    : look == CELLS || look == NEAREST_CELLS       ? STRATUS_SAMPLING_CELLS
    : look == LOCAL                                ? STRATUS_SAMPLING_AUTO
                                                   : STRATUS_SAMPLING_MIDPOINT;
  c->options.mode = look == MAXIMUM ? STRATUS_MODE_MAXIMUM
    : look == ADDITIVE              ? STRATUS_MODE_ADDITIVE
    : look == ISOSURFACE            ? STRATUS_MODE_ISOSURFACE
    : look >= FIRST_HIT             ? STRATUS_MODE_FIRST_HIT
                                    : STRATUS_MODE_COMPOSITE;
  c->options.sampling.interpolation = look == NEAREST_CELLS ? STRATUS_INTERPOLATION_NEAREST : STRATUS_INTERPOLATION_LINEAR;
  c->options.light.shade = look == LIT || look == ISOSURFACE;
  c->options.optics.contour_count = look == ISOSURFACE;
  c->options.optics.contours[0] = base + 0.2 * scale;
  c->options.skipping.structure = look == FIRST_HIT ? STRATUS_STRUCTURE_OCTANT : STRATUS_STRUCTURE_DISTANCE;
  c->options.skipping.audit = 1;
  grid_case_set(c, grid, look == LOCAL ? GRID_RANDOM : GRID_GEOMETRIC, look == LOCAL ? 7 : 1 + (int)look % 7, -3.0, 1.0,
    look == LOCAL ? 8.0 : 100.0, &random);
  case_camera(context, c, (int)look % 8, (int)look / 2 % 2);
}

static void compare(bool one_ray)
{
  stratus_context* host = case_context("host", 2);
  stratus_context* device = case_context("0", 2);
  assert_true(stratus_context_on_device(device));
  device->device->is_cpu = !one_ray;
  for (int look = MIDPOINT; look < LOOKS; look += few_run() ? (one_ray ? 10 : 5) : one_ray ? 3 : 1) {
    picture_case c;
    grid_case grid;
    make_look(host, (grid_look)look, &c, &grid);
    case_render(host, &c, &on_host);
    const uint64_t launched = device->report.launched;
    case_render(device, &c, &on_device);
    assert_true(device->report.launched > launched);
    int differing = 0;
    for (int i = 0; i < CASE_PIXELS; ++i) {
      differing += memcmp(on_host.rgba + 4 * i, on_device.rgba + 4 * i, 4 * sizeof(float)) != 0 || on_host.depth[i] != on_device.depth[i];
    }
    print_message("             look %d: %d pixels, %d differ; %s\n", look, case_lit(&on_host), differing, on_device.report.why);
    assert_true(case_lit(&on_host) > case_share(100));
    assert_int_equal(differing, 0);
    assert_int_equal(on_device.report.differing_pixels, 0);
    assert_null(strstr(on_device.report.why, "drawn on the host"));
    case_destroy(&c);
  }
  stratus_context_destroy(device);
  stratus_context_destroy(host);
}

static void a_device_by_packets_draws_the_hosts_pictures(void** state)
{
  (void)state;
  compare(false);
}

static void a_device_by_rays_draws_the_hosts_pictures(void** state)
{
  (void)state;
  compare(true);
}

static void tables_are_sent_when_coordinates_change(void** state)
{
  (void)state;
  stratus_context* device = case_context("0", 2);
  stratus_ray_caster* caster = NULL;
  picture_case c;
  grid_case grid;
  uint64_t uploads = 0;
  make_look(device, MIDPOINT, &c, &grid);
  c.options.skipping.audit = 0; /* it sends a frame without map */
  assert_int_equal(stratus_ray_caster_create(device, &caster), STRATUS_OK);
  for (int turn = 0; turn < 4; ++turn) {
    uint32_t none = 0;
    if (turn == 2) {
      grid_case_set(&c, &grid, GRID_GEOMETRIC, 7, 0.0, 1.0, 30.0, &none);
    }
    case_render_with(device, caster, &c, &on_device);
    case_render(device, &c, &on_host);
    assert_memory_equal(on_host.rgba, on_device.rgba, sizeof on_host.rgba);
    assert_true(turn == 0 || on_device.report.uploads == uploads + (turn == 2));
    uploads = on_device.report.uploads;
  }
  stratus_ray_caster_destroy(caster);
  case_destroy(&c);
  stratus_context_destroy(device);
}

int test_ray_grid_device(void)
{
  if (stratus_device_count() == 0) {
    return test_skip("no OpenCL device on this machine");
  }
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(a_device_by_packets_draws_the_hosts_pictures),
    cmocka_unit_test(a_device_by_rays_draws_the_hosts_pictures),
    cmocka_unit_test(tables_are_sent_when_coordinates_change),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
