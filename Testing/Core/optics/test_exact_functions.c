/* SPDX-License-Identifier: BSD-3-Clause
 * Pictures show what the function shows, however narrow: windows of single labels, plateaus of a millionth of the range, by every sampling
 * rule and interpolation, with every structure, on host and device. */
#include "stratus.h"
#include "testing.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#define SIDE 20
#define VALUES (SIDE * SIDE * SIDE)
#define WIDTH 17
#define PIXELS (WIDTH * WIDTH)
#define CENTRE (WIDTH * (WIDTH / 2) + WIDTH / 2)

static float drawn[4 * PIXELS], plain[4 * PIXELS];
static union {
  uint8_t of_uint8[VALUES];
  uint16_t of_uint16[VALUES];
  int32_t of_int32[VALUES];
  float of_float[VALUES];
} values;

static stratus_context* open_context(const char* device)
{
  stratus_context* context = NULL;
  stratus_context_options options = stratus_context_options_default();
  options.device = device;
  options.threads = 2;
  assert_int_equal(stratus_context_create(&options, &context, NULL, 0), STRATUS_OK);
  return context;
}

static void put(stratus_type type, int i, double value)
{
  if (type == STRATUS_UINT8) {
    values.of_uint8[i] = (uint8_t)value;
  } else if (type == STRATUS_UINT16) {
    values.of_uint16[i] = (uint16_t)value;
  } else if (type == STRATUS_INT32) {
    values.of_int32[i] = (int32_t)value;
  } else {
    values.of_float[i] = (float)value;
  }
}

/* A slab of `inside` in the middle layers, `outside` about it, and `most` in a corner, for the range. */
static void fill_slab(stratus_type type, double inside, double outside, double most)
{
  for (int i = 0; i < VALUES; ++i) {
    const int z = i / SIDE / SIDE;
    put(type, i, z >= 7 && z < 13 ? inside : outside);
  }
  put(type, 0, most);
}

/* Draws with all structures, which must not differ, or only with octants, and returns the middle pixel's alpha. */
static double draw(stratus_context* context, stratus_type type, const double* opacity, size_t count, stratus_sampling sampling,
  stratus_interpolation interpolation, bool all)
{
  static const double white[] = { 0, 1, 1, 1 };
  const double middle = 0.5 * (SIDE - 1), eye[3] = { middle, middle, 4.0 * SIDE }, focal[3] = { middle, middle, 0.0 }, up[3] = { 0, 1, 0 };
  const stratus_image image = { .width = WIDTH, .height = WIDTH, .rgba = drawn };
  stratus_ray_cast_options options = stratus_ray_cast_options_default();
  stratus_transfer transfer = stratus_transfer_default();
  stratus_volume volume = stratus_volume_default();
  stratus_ray_caster* caster = NULL;
  stratus_camera camera;
  transfer.opacity = opacity;
  transfer.opacity_count = count;
  transfer.color = white;
  transfer.color_count = 1;
  volume.type = type;
  volume.values = &values;
  volume.dimensions[0] = volume.dimensions[1] = volume.dimensions[2] = SIDE;
  options.sampling.rule = sampling;
  options.sampling.interpolation = interpolation;
  options.sampling.distance = 0.25;
  options.sampling.termination = 1.0;
  options.skipping.audit = 1;
  assert_int_equal(stratus_camera_parallel(context, eye, focal, up, 0.6 * SIDE, 1.0, &camera), STRATUS_OK);
  assert_int_equal(stratus_ray_caster_create(context, &caster), STRATUS_OK);
  const int first = all ? STRATUS_STRUCTURE_NONE : STRATUS_STRUCTURE_OCTANT;
  for (int structure = first; structure <= (all ? STRATUS_STRUCTURE_HYBRID : STRATUS_STRUCTURE_OCTANT); ++structure) {
    stratus_ray_cast_report report;
    options.skipping.structure = (stratus_structure)structure;
    if (stratus_ray_caster_render(caster, &volume, &transfer, &camera, &options, &image, &report) != STRATUS_OK) {
      fail_msg("%s", stratus_context_message(context));
    }
    assert_int_equal(report.differing_pixels, 0);
    if (structure == first) {
      memcpy(plain, drawn, sizeof plain);
    }
    assert_memory_equal(plain, drawn, sizeof plain);
  }
  stratus_ray_caster_destroy(caster);
  return (double)drawn[4 * CENTRE + 3];
}

static double absorbed(double opacity, double length)
{
  return -expm1(length * log1p(-opacity));
}

static void check_slab(double alpha, double opacity, stratus_interpolation interpolation, double half_width, const char* what, double k)
{
  /* Nearest: the slab is 6 voxels thick, and its ends may be between two samples. Linear: the 5 voxels between its layers, and half_width
   * voxels at each end, where values between the layers are still in the window. */
  const bool nearest = interpolation == STRATUS_INTERPOLATION_NEAREST;
  const double least = absorbed(opacity, nearest ? 5.7 : 4.7), most = absorbed(opacity, nearest ? 6.3 : 5.3 + 2.0 * half_width);
  if (!(alpha >= least && alpha <= most)) {
    fail_msg("%s %.9g, %s: alpha %.9g, not in %.9g..%.9g", what, k, nearest ? "nearest" : "linear", alpha, least, most);
  }
}

/* Tests every label of bytes and 500 of each larger type. The first ones are drawn with every interpolation and sampling and with all
 * structures, the others only with octants, and the larger types' others with one interpolation and sampling each. */
static void each_label_is_shown_by_its_window(void** state)
{
  enum { OF_BYTES = 256, OF_OTHERS = 500, WITH_ALL = 12 };
  static const stratus_type types[] = { STRATUS_UINT8, STRATUS_UINT16, STRATUS_INT32, STRATUS_FLOAT32 };
  static const double mosts[] = { 255, 65535, 2000000000, 1000000 };
  static const char* const names[] = { "uint8", "uint16", "int32", "float32" };
  uint32_t random = 5;
  for (int type = 0; type < 4; ++type) {
    for (int n = 0; n < (type == 0 ? OF_BYTES : OF_OTHERS); ++n) {
      random = random * 1664525u + 1013904223u;
      const double k = type == 0 ? n : floor((mosts[type] + 1.0) * (double)(random >> 8) / 16777216.0);
      const bool high = k > 0.5 * mosts[type];
      const double outside = high ? 0.0 : mosts[type], inner = high ? k - 1.0 : k + 1.0;
      const double window[] = { k - 0.5, 0, k - 0.5, 0.3, k + 0.5, 0.3, k + 0.5, 0 };
      for (int way = 0; way < 3; ++way) {
        if (type > 0 && n >= WITH_ALL && way != n % 3) {
          continue;
        }
        const stratus_interpolation interpolation = way ? STRATUS_INTERPOLATION_LINEAR : STRATUS_INTERPOLATION_NEAREST;
        const stratus_sampling sampling = way == 2 ? STRATUS_SAMPLING_PREINTEGRATED : STRATUS_SAMPLING_MIDPOINT;
        fill_slab(types[type], k, outside, mosts[type] - outside);
        const double alpha = draw(*state, types[type], window, 4, sampling, interpolation, n < WITH_ALL);
        check_slab(alpha, 0.3, interpolation, 0.5 / fabs(k - outside), names[type], k);
        if (interpolation == STRATUS_INTERPOLATION_NEAREST && type < 2) { /* its neighbours are others */
          fill_slab(types[type], inner, outside, mosts[type] - outside);
          assert_true(draw(*state, types[type], window, 4, sampling, interpolation, n < WITH_ALL) == 0.0);
        }
      }
    }
  }
}

static void a_plateau_of_a_millionth_is_shown(void** state)
{
  const double at = (double)0.3712345f, w = 1e-6;
  const double steps[] = { at - w / 2, 0, at - w / 2, 0.3, at + w / 2, 0.3, at + w / 2, 0 };
  const double ramps[] = { at - w / 2, 0, at - w / 4, 0.3, at + w / 4, 0.3, at + w / 2, 0 };
  for (int way = 0; way < 6; ++way) {
    const stratus_interpolation interpolation = way % 3 ? STRATUS_INTERPOLATION_LINEAR : STRATUS_INTERPOLATION_NEAREST;
    const stratus_sampling sampling = way % 3 == 2 ? STRATUS_SAMPLING_PREINTEGRATED : STRATUS_SAMPLING_MIDPOINT;
    fill_slab(STRATUS_FLOAT32, at, 0.0, 1.0);
    const double alpha = draw(*state, STRATUS_FLOAT32, way < 3 ? steps : ramps, 4, sampling, interpolation, true);
    check_slab(alpha, 0.3, interpolation, 1e-6, way < 3 ? "steps" : "ramps", way);
    fill_slab(STRATUS_FLOAT32, at + w, 0.0, 1.0);
    const double neighbour = draw(*state, STRATUS_FLOAT32, way < 3 ? steps : ramps, 4, sampling, interpolation, true);
    assert_true(way % 3 == 0 ? neighbour == 0.0 : neighbour < 0.1);
  }
}

/* Several functions in one picture, of which one has divided cells: labels, and independent components. */
static void each_of_several_functions_is_resolved(void** state)
{
  static const double white[] = { 0, 1, 1, 1 }, none[] = { 0, 0 }, some[] = { 0, 0.1 };
  static uint8_t mask[VALUES];
  static float pairs[2 * VALUES];
  const double at = (double)0.3712345f, w = 1e-6;
  const double steps[] = { at - w / 2, 0, at - w / 2, 0.3, at + w / 2, 0.3, at + w / 2, 0 };
  const double middle = 0.5 * (SIDE - 1), eye[3] = { middle, middle, 4.0 * SIDE }, focal[3] = { middle, middle, 0.0 }, up[3] = { 0, 1, 0 };
  const stratus_image image = { .width = WIDTH, .height = WIDTH, .rgba = drawn };
  stratus_transfer transfer[3];
  stratus_camera camera;
  assert_int_equal(stratus_camera_parallel(*state, eye, focal, up, 0.6 * SIDE, 1.0, &camera), STRATUS_OK);
  for (int f = 0; f < 3; ++f) {
    transfer[f] = stratus_transfer_default();
    transfer[f].opacity = f == 0 ? none : f == 1 ? steps : some;
    transfer[f].opacity_count = f == 1 ? 4 : 1;
    transfer[f].color = white;
    transfer[f].color_count = 1;
  }
  fill_slab(STRATUS_FLOAT32, at, 0.0, 1.0);
  for (int i = 0; i < VALUES; ++i) {
    mask[i] = i % SIDE < SIDE / 2 ? 1 : 2;
    pairs[2 * i] = 0.0f;
    pairs[2 * i + 1] = values.of_float[i];
  }
  for (int components = 0; components < 2; ++components) {
    stratus_ray_cast_options options = stratus_ray_cast_options_default();
    stratus_volume volume = stratus_volume_default();
    stratus_ray_caster* caster = NULL;
    volume.values = components ? (void*)pairs : (void*)&values;
    volume.components = 1 + components;
    volume.value_stride = 1 + components;
    volume.dimensions[0] = volume.dimensions[1] = volume.dimensions[2] = SIDE;
    options.sampling.distance = 0.25;
    options.sampling.termination = 1.0;
    options.skipping.audit = 1;
    options.mask.bytes = components ? NULL : mask;
    options.mask.label_count = components ? 0 : 2;
    assert_int_equal(stratus_ray_caster_create(*state, &caster), STRATUS_OK);
    for (int structure = STRATUS_STRUCTURE_NONE; structure <= STRATUS_STRUCTURE_HYBRID; ++structure) {
      stratus_ray_cast_report report;
      options.skipping.structure = (stratus_structure)structure;
      if (stratus_ray_caster_render(caster, &volume, transfer, &camera, &options, &image, &report) != STRATUS_OK) {
        fail_msg("%s", stratus_context_message(*state));
      }
      assert_int_equal(report.differing_pixels, 0);
      const double left = (double)drawn[4 * (CENTRE - 3) + 3], right = (double)drawn[4 * (CENTRE + 3) + 3];
      if (components) {
        check_slab(left, 0.3, STRATUS_INTERPOLATION_LINEAR, 1e-6, "component", 1);
        check_slab(right, 0.3, STRATUS_INTERPOLATION_LINEAR, 1e-6, "component", 1);
      } else {
        const double whole = absorbed(0.1, SIDE - 1);
        check_slab(left, 0.3, STRATUS_INTERPOLATION_LINEAR, 1e-6, "label", 1);
        assert_true(fabs(right - whole) < 0.01);
      }
    }
    stratus_ray_caster_destroy(caster);
  }
}

static int run_on(const char* device)
{
  stratus_context* context = open_context(device);
  const struct CMUnitTest tests[] = {
    cmocka_unit_test_prestate(each_label_is_shown_by_its_window, context),
    cmocka_unit_test_prestate(a_plateau_of_a_millionth_is_shown, context),
    cmocka_unit_test_prestate(each_of_several_functions_is_resolved, context),
  };
  const int failures = cmocka_run_group_tests(tests, NULL, NULL);
  stratus_context_destroy(context);
  return failures;
}

int test_exact_functions(void)
{
  return run_on("host");
}

int test_exact_functions_device(void)
{
  return stratus_device_count() == 0 ? test_skip("no OpenCL device on this machine") : run_on("0");
}
