/* SPDX-License-Identifier: BSD-3-Clause
 * Lit samples, gradient opacity and components on the OpenCL device against the host's: one source, so counters agree exactly and pixels to
 * a few units in the last place of the whole picture's colours. */
#include "picture_case.h"
#include "gradients.h"
#include "testing.h"

#include "device_state.h"
#include "volume.h"

/* Of colours near 1. The set-up of rays divides and takes roots in double, which a device may round otherwise. PoCL and Intel's: 0. */
#define LARGEST_DIFFERENCE 1e-5f

static picture on_host;
static picture on_device;

static void compare(
  stratus_context* host, stratus_context* device, const picture_case* c, const stratus_transfer* transfers, const char* what)
{
  stratus_context* contexts[2] = { host, device };
  picture* pictures[2] = { &on_host, &on_device };
  float most = 0.0f;
  int counts = 0;
  for (int i = 0; i < 2; ++i) {
    stratus_ray_caster* caster = NULL;
    picture* p = pictures[i];
    const stratus_image image = { .width = CASE_WIDTH, .height = CASE_HEIGHT, .rgba = p->rgba, .depth = p->depth, .samples = p->samples };
    assert_int_equal(stratus_ray_caster_create(contexts[i], &caster), STRATUS_OK);
    stratus_ray_cast_options options = c->options;
    for (int again = 0; again < 2;
         ++again) { /* with shading after without, and with values kept as floats: nothing stale stays on the device */
      options.light.shade = again && c->options.light.shade;
      assert_int_equal(stratus_ray_caster_render(caster, &c->volume, transfers, &c->camera, &options, &image, &p->report), STRATUS_OK);
    }
    stratus_ray_caster_destroy(caster);
  }
  for (int i = 0; i < CASE_PIXELS; ++i) {
    counts += on_host.samples[i] != on_device.samples[i];
    for (int k = 4 * i; k < 4 * i + 4; ++k) {
      most = fmaxf(most, fabsf(on_host.rgba[k] - on_device.rgba[k]));
    }
  }
  print_message("             %s: %d pixels, apart by %g at most\n", what, case_lit(&on_host), (double)most);
  assert_true(case_lit(&on_host) > case_share(50));
  assert_true(counts == 0 || !device->device->is_cpu || !case_counts_agree()); /* single rays do not wait for others */
  assert_true(most <= LARGEST_DIFFERENCE);
}

static void device_and_host_show_the_same(void** state)
{
  static const double steep[] = { 0.0, 0.1, 20.0, 1.0 }, steep_floats[] = { 0.0, 0.1, 0.5, 1.0 };
  stratus_context* host = case_context("host", 2);
  stratus_context* device = case_context("0", 2);
  assert_true(stratus_context_on_device(device));
  device->device->is_cpu = !*(const bool*)*state;
  picture_case c;
  case_create(host, &c, STRATUS_UINT8, 26, 24, 28, 5);
  c.options.light.shade = 1;
  c.options.light.shading.specular = 0.4;
  c.options.sampling.rule = STRATUS_SAMPLING_MIDPOINT;
  compare(host, device, &c, &c.transfer, "lit");
  c.options.sampling.rule = STRATUS_SAMPLING_CELLS;
  compare(host, device, &c, &c.transfer, "lit by cells");
  c.options.sampling.rule = STRATUS_SAMPLING_AUTO;
  compare(host, device, &c, &c.transfer, "lit, an automatic rule");
  c.options.light.shading.shadows = 1;
  c.options.light.shading.scattering = 0.6;
  c.options.light.shading.anisotropy = 0.4;
  c.options.light.shading.light_count = 2;
  c.options.light.shading.lights[0] = (stratus_light){ .vector = { 3, -1, 2 }, .color = { 1, 0.9, 0.8 } };
  c.options.light.shading.lights[1] = (stratus_light){ .vector = { 12, 13, 9 }, .color = { 0.1, 0.2, 0.9 }, .positional = 1 };
  compare(host, device, &c, &c.transfer, "shadows, an automatic rule");
  c.options.sampling.rule = STRATUS_SAMPLING_MIDPOINT;
  compare(host, device, &c, &c.transfer, "shadows, midpoint");
  static const double plate[9] = { 0, 0, 40, 60, 0, 40, 0, 60, 40 };
  const stratus_surfaces surfaces = { .points = plate, .triangle_count = 1 };
  c.options.light.shading.surfaces = &surfaces;
  compare(host, device, &c, &c.transfer, "shadows of a surface");
  c.options.light.shading.surfaces = NULL;
  const double tolerance = c.options.sampling.tolerance;
  c.options.sampling.tolerance = 0.3; /* of which coarse cells are enough */
  c.options.light.shading.multiple = 1;
  c.options.light.shading.sky_zenith[1] = 0.5;
  compare(host, device, &c, &c.transfer, "scattered again");
  c.options.sampling.tolerance = tolerance;
  c.options.light.shading.multiple = 0;
  c.options.light.shading.shadows = 0;
  c.options.light.shading.scattering = 0.0;
  c.options.light.shading.light_count = -1;
  c.transfer.gradient = steep;
  c.transfer.gradient_count = 2;
  c.options.sampling.rule = STRATUS_SAMPLING_PREINTEGRATED;
  compare(host, device, &c, &c.transfer, "lit, gradient opacity, pre-integrated");
  c.options.optics.gradient_distance = 1.5;
  compare(host, device, &c, &c.transfer, "lit, gradient opacity of opacities");
  case_destroy(&c);

  case_create(host, &c, STRATUS_FLOAT32, 26, 24, 28, 5);
  float* memory = gradients_set(&c.volume, true);
  c.transfer.gradient = steep_floats;
  c.transfer.gradient_count = 2;
  c.options.light.shade = 1;
  compare(host, device, &c, &c.transfer, "gradients in place");
  c.volume.values = c.values;
  compare(host, device, &c, &c.transfer, "gradients apart");
  c.options.mode = STRATUS_MODE_ISOSURFACE;
  c.options.optics.contour_count = 1;
  c.options.optics.contours[0] = case_type_values[STRATUS_FLOAT32].base + 0.2 * case_type_values[STRATUS_FLOAT32].scale;
  compare(host, device, &c, &c.transfer, "gradients of an isosurface");
  free(memory);
  case_destroy(&c);

  case_create(host, &c, STRATUS_UINT8, 26, 24, 28, 6); /* every second value the other component */
  c.volume.dimensions[0] = 13;
  c.volume.components = 2;
  c.volume.value_stride = 2;
  c.options.light.shade = 1;
  case_camera(host, &c, 1, 0);
  const stratus_transfer both[2] = { c.transfer, c.transfer };
  compare(host, device, &c, both, "two components");
  c.options.optics.mean_components = 1;
  compare(host, device, &c, both, "two components by their share");
  const stratus_material materials[2] = { { 1, 0.1, 0.5, 0.6, 9.0 }, { 0, 0.0, 0.0, 0.0, 0.0 } };
  c.options.light.materials = materials;
  compare(host, device, &c, both, "two materials");
  c.options.optics.dependent = 1;
  compare(host, device, &c, both, "two dependent components");
  case_destroy(&c);

  static uint8_t labels[26 * 24 * 28];
  static const double green[] = { 0, 0, 1, 0 };
  case_create(host, &c, STRATUS_UINT8, 26, 24, 28, 7);
  for (size_t v = 0; v < sizeof labels; ++v) {
    labels[v] = (uint8_t)(v / 5 % 3);
  }
  stratus_transfer functions[2] = { c.transfer, c.transfer };
  functions[1].color = green;
  functions[1].color_count = 1;
  c.options.mask.bytes = labels;
  c.options.mask.label_count = 1;
  compare(host, device, &c, functions, "labels");
  functions[1].gradient = steep;
  functions[1].gradient_count = 2;
  c.options.light.shade = 1;
  c.options.light.shading.light_count = 1;
  c.options.light.shading.lights[0] = (stratus_light){ .vector = { 40, 50, -10 },
    .color = { 20, 20, 20 },
    .positional = 1,
    .attenuation = { 0.5, 0.02, 0.03 },
    .cone_angle = 20.0,
    .axis = { -2.5, -2.7, 2.4 },
    .cone_exponent = 2.0 };
  compare(host, device, &c, functions, "labels, one thinned, in a cone of dim light");
  case_destroy(&c);
  stratus_context_destroy(host);
  stratus_context_destroy(device);
}

int test_ray_shading_device(void)
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
