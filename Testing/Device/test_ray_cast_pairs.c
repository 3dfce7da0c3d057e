/* SPDX-License-Identifier: BSD-3-Clause
 * A device without double: rays are set up in pairs of floats. The test marks the present device as without double, and compares its
 * pictures with the host's, from near and from a million voxels away, where plain floats would shake by a sixteenth of a voxel. */
#include "picture_case.h"
#include "testing.h"

#include "device_state.h"
#include "volume.h"

/* Of colours in 0..1: a ray moved by a thousandth of a voxel changes these fields by less. */
#define LARGEST_DIFFERENCE 2e-3f

static picture on_host;
static picture on_device;

static void check(stratus_context* host, stratus_context* device, const picture_case* c, const char* what, int* lit)
{
  float most = 0.0f;
  case_render(host, c, &on_host);
  case_render(device, c, &on_device);
  *lit += case_lit(&on_host) > 0;
  for (int i = 0; i < 4 * CASE_PIXELS; ++i) {
    most = fmaxf(most, fabsf(on_host.rgba[i] - on_device.rgba[i]));
  }
  if (!(most <= LARGEST_DIFFERENCE)) {
    print_error("%s: pixels differ by up to %g\n", what, (double)most);
    fail();
  }
}

static void pairs_of_floats_stand_in_for_doubles(void** state)
{
  (void)state;
  stratus_context* host = case_context("host", 2);
  stratus_context* device = case_context("0", 2);
  device->device->has_double = false;
  int lit = 0;
  for (uint32_t seed = 0; seed < 6; ++seed) {
    picture_case c;
    char what[64];
    case_create(host, &c, seed % 2 ? STRATUS_FLOAT32 : STRATUS_UINT8, 24, 30, 27, 41 + seed);
    snprintf(what, sizeof what, "seed %u", seed);
    check(host, device, &c, what, &lit);
    /* the same picture by a long lens */
    for (int axis = 0; axis < 3; ++axis) {
      c.camera.eye[axis] -= 1e6 * c.camera.forward[axis];
      c.camera.right[axis] *= 4e-5;
      c.camera.up[axis] *= 4e-5;
    }
    snprintf(what, sizeof what, "seed %u from far away", seed);
    check(host, device, &c, what, &lit);
    case_destroy(&c);
  }
  assert_true(lit > 8);
  stratus_context_destroy(host);
  stratus_context_destroy(device);
}

int test_ray_cast_pairs(void)
{
  if (stratus_device_count() == 0) {
    return test_skip("no OpenCL device on this machine");
  }
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(pairs_of_floats_stand_in_for_doubles),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
