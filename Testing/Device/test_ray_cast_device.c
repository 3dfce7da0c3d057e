/* SPDX-License-Identifier: BSD-3-Clause
 * The OpenCL device's pictures against the host's: the traversal is one source, so the counters agree exactly where packets are of
 * one width, and pixels to a few units in the last place: the set-up of rays divides and takes roots in double, which a device may round
 * otherwise, and then rounds to float. PoCL and Intel's: 0.
 *
 * One work item a ray, as on a GPU, takes no samples while other rays of a packet do: then a pixel's samples are the host's at most, and
 * the same number where there is no structure. */
#include "picture_case.h"
#include "testing.h"

#include "device_state.h"

#define ULPS_MOST 4
#define LOCAL_SEED 540 /* seeds from here on give cases for rule local */
/* Of so many seeds one is drawn, with one work item a ray or with --few. */
#define ONE_RAY_STEP 4
#define FEW_STEP 13
#define FEW_FIRST (one_ray ? 7 : 1) /* others with one work item a ray than by packets */

static picture on_host;
static picture on_device;

/* Steps between neighbouring floats from a to b; far apart where only one is zero or not finite. */
static int64_t ulps(float a, float b)
{
  int32_t i;
  int32_t j;
  memcpy(&i, &a, sizeof i);
  memcpy(&j, &b, sizeof j);
  const int64_t x = i < 0 ? INT32_MIN - (int64_t)i : i;
  const int64_t y = j < 0 ? INT32_MIN - (int64_t)j : j;
  return x > y ? x - y : y - x;
}

static void compare(bool one_ray)
{
  stratus_context* host = case_context("host", 2);
  stratus_context* device = case_context("0", 2);
  assert_true(stratus_context_on_device(device));
  device->device->is_cpu = !one_ray;
  const uint32_t step = few_run() ? FEW_STEP : one_ray ? ONE_RAY_STEP : 1;
  int64_t most = 0;
  int other_counts = 0, more_samples = 0;
  int pictures = 0, lit = 0;
  int local_cases = 0, local = 0;
  for (uint32_t seed = few_run() ? 500 + FEW_FIRST : 500; seed < 552; seed += step) {
    picture_case c;
    if (seed < LOCAL_SEED) {
      case_create_random(host, seed, &c);
    } else {
      case_create_local(host, seed, &c);
      ++local_cases;
    }
    const stratus_structure structure = (stratus_structure)((seed - 500) / step % 5);
    c.options.skipping.structure = structure;
    case_render(host, &c, &on_host);
    c.options.skipping.audit = 1;
    case_render(device, &c, &on_device);
    if (on_device.report.differing_pixels) {
      print_error("seed %u, %s, %s, %s: the audit on the device found %llu pixels\n", seed, stratus_structure_name(structure),
        case_type_names[c.volume.type], c.options.sampling.interpolation ? "nearest" : "linear",
        (unsigned long long)on_device.report.differing_pixels);
      fail();
    }
    ++pictures;
    lit += case_lit(&on_host) > 0;
    local += on_host.report.sampling == STRATUS_SAMPLING_LOCAL && on_device.report.sampling == STRATUS_SAMPLING_LOCAL;
    for (int i = 0; i < CASE_PIXELS; ++i) {
      other_counts += on_host.samples[i] != on_device.samples[i] && (!one_ray || structure == STRATUS_STRUCTURE_NONE);
      more_samples += on_device.samples[i] > on_host.samples[i];
      for (int k = 4 * i; k < 4 * i + 4; ++k) {
        const int64_t apart = ulps(on_host.rgba[k], on_device.rgba[k]);
        most = apart > most ? apart : most;
      }
    }
    case_destroy(&c);
  }
  print_message("             %d pictures of %d, at most %lld units in the last place apart, %d pixels with other counts, %d with more\n",
    lit, pictures, (long long)most, other_counts, more_samples);
  assert_true(lit > pictures / 3);
  assert_true(local_cases >= (few_run() ? 1 : 2));
  assert_int_equal(local, local_cases);
  assert_true(other_counts == 0 || (!one_ray && !case_counts_agree()));
  assert_true(!one_ray || more_samples == 0);
  assert_true(most <= ULPS_MOST);
  stratus_context_destroy(host);
  stratus_context_destroy(device);
}

static void device_and_host_draw_the_same(void** state)
{
  (void)state;
  compare(false);
}

static void one_work_item_a_ray_draws_the_same(void** state)
{
  (void)state;
  compare(true);
}

int test_ray_cast_device(void)
{
  if (stratus_device_count() == 0) {
    return test_skip("no OpenCL device on this machine");
  }
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(device_and_host_draw_the_same),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}

int test_ray_cast_one_ray(void)
{
  if (stratus_device_count() == 0) {
    return test_skip("no OpenCL device on this machine");
  }
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(one_work_item_a_ray_draws_the_same),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
