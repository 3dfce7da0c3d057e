/* SPDX-License-Identifier: BSD-3-Clause
 * The device's maxima, minima, means, sums and isosurfaces against the host's, cropped, masked and jittered too: the traversal is one
 * source, so the counters agree exactly, and pixels to the few units in the last place that the set-up of rays may be rounded otherwise.
 * PoCL and Intel's: 0. With one work item a ray, as on a GPU, only pixels are compared: rays that wait for others of their packet take
 * more samples. */
#include "picture_case.h"
#include "testing.h"

#include "device_state.h"

#define ULPS_MOST 4

static picture on_host, on_device;

/* Steps between neighbouring floats from a to b. */
static int64_t ulps(float a, float b)
{
  int32_t i, j;
  memcpy(&i, &a, sizeof i);
  memcpy(&j, &b, sizeof j);
  const int64_t x = i < 0 ? INT32_MIN - (int64_t)i : i, y = j < 0 ? INT32_MIN - (int64_t)j : j;
  return x > y ? x - y : y - x;
}

static void ask_for(picture_case* c, int mode, uint32_t seed, const uint8_t* mask)
{
  const double base = case_type_values[c->volume.type].base, scale = case_type_values[c->volume.type].scale;
  c->options.mode = (stratus_mode)mode;
  c->options.sampling.distance = 0.7;
  c->options.skipping.structure = (stratus_structure)(seed % 6);
  c->options.optics.contour_count = 2;
  c->options.optics.contours[0] = base + 0.3 * scale;
  c->options.optics.contours[1] = base + 0.1 * scale;
  c->options.optics.average_range[1] = base + 0.5 * scale;
  c->options.mask.bytes = seed % 2 ? mask : NULL;
  c->options.sampling.jitter = seed % 3 == 1;
  c->options.sampling.jitter_seed = seed;
  c->options.clipping.crop = seed % 3 == 2;
  c->options.clipping.crop_regions = 0x5140145u;
  for (int a = 0; a < 3; ++a) {
    c->options.clipping.crop_bounds[2 * a] = 7.3;
    c->options.clipping.crop_bounds[2 * a + 1] = 13.1;
  }
}

static void modes_are_those_of_the_host(void** state)
{
  const bool one_ray = *(const bool*)*state;
  stratus_context* host = case_context("host", 2);
  stratus_context* device = case_context("0", 2);
  assert_true(stratus_context_on_device(device));
  device->device->is_cpu = !one_ray;
  static const stratus_type types[] = { STRATUS_FLOAT32, STRATUS_UINT8 };
  static uint8_t mask[21 * 19 * 23];
  int64_t most = 0;
  int other_counts = 0, lit = 0, pictures = 0;
  for (size_t i = 0; i < sizeof mask; ++i) {
    mask[i] = (uint8_t)(i % 21 > 6);
  }
  /* Each mode is a kernel; few: three modes by packets, the other three by rays. */
  for (uint32_t seed = few_run() && one_ray; seed < (few_run() ? 6 : one_ray ? 12 : 24); seed += few_run() ? 2 : 1) {
    picture_case c;
    const int mode = seed % 6 == 5 ? STRATUS_MODE_QUANTITIES : STRATUS_MODE_MAXIMUM + (int)(seed % 6);
    case_create(host, &c, types[seed / 6 % 2], 21, 19, 23, seed);
    ask_for(&c, mode, seed, mask);
    if (seed % 4 == 3 && mode != STRATUS_MODE_QUANTITIES) { /* two dependent components: every second value is the other's */
      c.volume.dimensions[0] = 10;
      c.volume.components = 2;
      c.volume.value_stride = 2;
      c.options.optics.dependent = 1;
    }
    case_render(host, &c, &on_host);
    c.options.skipping.audit = 1;
    case_render(device, &c, &on_device);
    if (on_device.report.differing_pixels) {
      print_error("seed %u, %s: the audit on the device found %llu pixels\n", seed, stratus_mode_name(c.options.mode),
        (unsigned long long)on_device.report.differing_pixels);
      fail();
    }
    lit += case_lit(&on_host) > CASE_PIXELS / 50;
    ++pictures;
    for (int i = 0; i < CASE_PIXELS; ++i) {
      other_counts += on_host.samples[i] != on_device.samples[i];
      for (int k = 4 * i; k < 4 * i + 4; ++k) {
        const int64_t apart = ulps(on_host.rgba[k], on_device.rgba[k]);
        most = apart > most ? apart : most;
      }
    }
    case_destroy(&c);
  }
  print_message("             %d pictures of %d, at most %lld units in the last place apart, %d pixels with other counts\n", lit, pictures,
    (long long)most, other_counts);
  assert_true(lit > pictures * 3 / 4);
  assert_true(other_counts == 0 || one_ray || !case_counts_agree());
  assert_true(most <= ULPS_MOST);
  stratus_context_destroy(host);
  stratus_context_destroy(device);
}

/* Samples that follow the voxels take a part of the kernels that other frames leave out. */
static void thin_voxels_are_those_of_the_host(void** state)
{
  static const stratus_mode modes[] = { STRATUS_MODE_COMPOSITE, STRATUS_MODE_AVERAGE, STRATUS_MODE_COMPOSITE };
  stratus_context* host = case_context("host", 2);
  stratus_context* device = case_context("0", 2);
  (void)state;
  for (int i = few_run() ? 2 : 0; i < 3; ++i) { /* a kernel each */
    picture_case c;
    int64_t most = 0;
    case_create(host, &c, STRATUS_FLOAT32, 21, 19, 23, 5);
    c.volume.spacing[2] = 1e-3;
    c.transfer.unit_distance = 1e-2;
    c.options = stratus_ray_cast_options_default();
    c.options.mode = modes[i];
    c.options.sampling.rule = i == 2 ? STRATUS_SAMPLING_CELLS : STRATUS_SAMPLING_AUTO;
    case_camera(host, &c, 2 + i, i == 1);
    case_render(host, &c, &on_host);
    case_render(device, &c, &on_device);
    for (int k = 0; k < 4 * CASE_PIXELS; ++k) {
      const int64_t apart = ulps(on_host.rgba[k], on_device.rgba[k]);
      most = apart > most ? apart : most;
    }
    print_message("             %s, %d pixels, at most %lld units in the last place apart\n", stratus_mode_name(modes[i]),
      case_lit(&on_host), (long long)most);
    assert_true(on_device.report.follows_voxels && case_lit(&on_host) > CASE_PIXELS / 50);
    assert_true(most <= ULPS_MOST);
    case_destroy(&c);
  }
  stratus_context_destroy(host);
  stratus_context_destroy(device);
}

int test_ray_modes_device(void)
{
  if (stratus_device_count() == 0) {
    return test_skip("no OpenCL device on this machine");
  }
  static bool packets = false, one_ray = true;
  const struct CMUnitTest tests[] = {
    cmocka_unit_test_prestate(modes_are_those_of_the_host, &packets),
    cmocka_unit_test_prestate(modes_are_those_of_the_host, &one_ray),
    cmocka_unit_test(thin_voxels_are_those_of_the_host),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
