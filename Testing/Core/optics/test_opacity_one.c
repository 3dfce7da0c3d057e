/* SPDX-License-Identifier: BSD-3-Clause
 * Opacity 1 stops all light on any path length, by both sampling rules, in volumes and in meshes, on host and device. Opacities just below
 * 1 stay translucent by the right amount. */
#include "tetra_case.h"
#include "testing.h"

#define SIDE 24
#define WIDTH 21
#define PIXELS (WIDTH * WIDTH)
#define CENTRE (WIDTH * (WIDTH / 2) + WIDTH / 2)

static const double spacings[] = { 1.0, 0.03, 1e-3, 1e-6 };
/* The light that is left is a float below 1, which rounds with each sample of a ray. A ray has at most 48 samples, .6 of a voxel apart or
 * more. */
#define ROUNDING (48 * 0x1p-24)

static float values[SIDE * SIDE * SIDE];
static float drawn[4 * PIXELS], other[4 * PIXELS];

static stratus_context* open_context(const char* device)
{
  stratus_context* context = NULL;
  stratus_context_options options = stratus_context_options_default();
  options.device = device;
  options.threads = 2;
  assert_int_equal(stratus_context_create(&options, &context, NULL, 0), STRATUS_OK);
  return context;
}

/* A camera that looks along z through the middle, from `far` spacings away. */
static stratus_camera look_along_z(stratus_context* context, double spacing)
{
  const double middle = 0.5 * (SIDE - 1) * spacing, eye[3] = { middle, middle, 4.0 * SIDE * spacing }, focal[3] = { middle, middle, 0.0 };
  const double up[3] = { 0, 1, 0 };
  stratus_camera camera;
  assert_int_equal(stratus_camera_parallel(context, eye, focal, up, 0.6 * SIDE * spacing, 1.0, &camera), STRATUS_OK);
  return camera;
}

static void fill_slab(float inside, float outside)
{
  for (int i = 0; i < SIDE * SIDE * SIDE; ++i) {
    const int z = i / SIDE / SIDE;
    values[i] = z >= 8 && z < 16 ? inside : outside;
  }
}

static void draw(
  stratus_context* context, double spacing, const stratus_transfer* transfer, const stratus_ray_cast_options* options, float* rgba)
{
  stratus_ray_caster* caster = NULL;
  stratus_volume volume = stratus_volume_default();
  const stratus_camera camera = look_along_z(context, spacing);
  const stratus_image image = { .width = WIDTH, .height = WIDTH, .rgba = rgba };
  volume.values = values;
  for (int a = 0; a < 3; ++a) {
    volume.dimensions[a] = SIDE;
    volume.spacing[a] = spacing;
  }
  assert_int_equal(stratus_ray_caster_create(context, &caster), STRATUS_OK);
  const stratus_status status = stratus_ray_caster_render(caster, &volume, transfer, &camera, options, &image, NULL);
  if (status != STRATUS_OK) {
    fail_msg("%s", stratus_context_message(context));
  }
  stratus_ray_caster_destroy(caster);
}

static stratus_transfer function_of(const double* opacity, size_t count)
{
  static const double white[] = { 0, 1, 1, 1 };
  stratus_transfer transfer = stratus_transfer_default();
  transfer.opacity = opacity;
  transfer.opacity_count = count;
  transfer.color = white;
  transfer.color_count = 1;
  return transfer;
}

static const double step_up[] = { 0.5, 0, 0.51, 1, 1, 1 }, ramp_up[] = { 0, 0, 1, 1 }, all[] = { 0, 1 };
static const struct {
  const double* points;
  size_t count;
} functions[] = { { step_up, 3 }, { ramp_up, 2 }, { all, 1 } };

/* The slab hides what is behind it, whatever the structure. function, kind: named where it does not. */
static void expect_opaque(
  stratus_context* context, double spacing, const stratus_transfer* transfer, stratus_ray_cast_options* options, int function, int kind)
{
  options->skipping.structure = STRATUS_STRUCTURE_NONE;
  draw(context, spacing, transfer, options, drawn);
  if (drawn[4 * CENTRE + 3] != 1.0f || fabsf(drawn[4 * CENTRE] - 1.0f) > 1e-6f) {
    fail_msg("function %d, spacing %g, kind %d: alpha %.9g, red %.9g", function, spacing, kind, (double)drawn[4 * CENTRE + 3],
      (double)drawn[4 * CENTRE]);
  }
  /* few: one structure for each call, in turn */
  static int turn = STRATUS_STRUCTURE_BLOCK;
  turn = turn == STRATUS_STRUCTURE_HYBRID ? STRATUS_STRUCTURE_BLOCK : turn + 1;
  for (int structure = few_run() ? turn : STRATUS_STRUCTURE_BLOCK; structure <= (few_run() ? turn : STRATUS_STRUCTURE_HYBRID);
       ++structure) {
    options->skipping.structure = (stratus_structure)structure;
    draw(context, spacing, transfer, options, other);
    assert_memory_equal(drawn, other, sizeof drawn);
  }
}

static void a_slab_of_opacity_1_is_opaque_at_any_spacing(void** state)
{
  static const double gradient[] = { 0.0, 0.5 };
  for (int f = 0; f < 3; ++f) {
    for (size_t s = 0; s < sizeof spacings / sizeof *spacings; s += few_run() ? 3 : 1) {
      stratus_transfer transfer = function_of(functions[f].points, functions[f].count);
      for (int kind = 0; kind < 6; ++kind) {
        stratus_ray_cast_options options = stratus_ray_cast_options_default();
        options.sampling.rule = kind % 2 ? STRATUS_SAMPLING_PREINTEGRATED : STRATUS_SAMPLING_MIDPOINT;
        options.sampling.termination = 1.0;
        transfer.gradient = gradient; /* half of an infinite depth is no less */
        transfer.gradient_count = kind / 2 == 1;
        options.clipping.clip_plane_count = kind / 2 == 2; /* the first segment is a part of one */
        options.clipping.clip_planes[0][2] = -1.0;
        options.clipping.clip_planes[0][3] = 12.03 * spacings[s];
        fill_slab(1.0f, 0.0f);
        expect_opaque(*state, spacings[s], &transfer, &options, f, kind);
      }
    }
  }
}

/* The function reaches 1 exactly at the slab's value, which is at any place in the table: at the foot of a plateau, at a peak, between
 * steps. */
static void opacity_1_at_the_value_itself_is_opaque(void** state)
{
  static const double foot[] = { 0, 0, 100.3, 1, 200, 1 }, peak[] = { 0, 0, 100.3, 1, 200, 0 },
                      top[] = { 0, 0, 100.3, 1, 100.3, 0.2, 200, 0.2 };
  static const double window[] = { 99.8, 0, 99.8, 1, 100.8, 1, 100.8, 0 }, narrow[] = { 100.29, 0, 100.29, 1, 100.31, 1, 100.31, 0 };
  const float inside = 100.3f;
  double points[5][8];
  const double* const shapes[] = { foot, peak, top, window, narrow };
  static const size_t counts[] = { 3, 3, 4, 4, 4 };
  for (int f = 0; f < 5; ++f) {
    memcpy(points[f], shapes[f], 2 * counts[f] * sizeof(double));
    for (size_t i = 0; i < counts[f]; ++i) { /* the slab's value is a float */
      points[f][2 * i] = points[f][2 * i] == 100.3 ? (double)inside : points[f][2 * i];
    }
    const stratus_transfer transfer = function_of(points[f], counts[f]);
    for (size_t s = 0; f != 2 && s < sizeof spacings / sizeof *spacings; s += few_run() ? 3 : 1) { /* at `top` the last point's .2 counts */
      for (int kind = 0; kind < 3; ++kind) {
        stratus_ray_cast_options options = stratus_ray_cast_options_default();
        options.sampling.rule = kind == 1 ? STRATUS_SAMPLING_PREINTEGRATED : STRATUS_SAMPLING_MIDPOINT;
        options.sampling.interpolation = kind == 2 ? STRATUS_INTERPOLATION_NEAREST : STRATUS_INTERPOLATION_LINEAR;
        options.sampling.termination = 1.0;
        fill_slab(inside, 0.0f);
        values[0] = 255.0f;
        expect_opaque(*state, spacings[s], &transfer, &options, f, kind);
      }
    }
  }
}

/* Between values far apart the function is 1 over less than a few entries of a table: rays that pass through it end there all the same. */
static void a_narrow_band_of_opacity_1_is_met_on_the_way(void** state)
{
  static const double bands[] = { 100, 0, 100, 1, 101, 1, 101, 0, 60000, 0, 60000, 1, 60001, 1, 60001, 0 };
  const stratus_transfer transfer = function_of(bands, 8);
  stratus_ray_cast_options options = stratus_ray_cast_options_default();
  options.sampling.rule = STRATUS_SAMPLING_PREINTEGRATED;
  options.sampling.termination = 1.0;
  fill_slab(200.0f, 0.0f);
  values[0] = 60001.0f;
  for (int structure = STRATUS_STRUCTURE_NONE; structure <= STRATUS_STRUCTURE_HYBRID; ++structure) {
    options.skipping.structure = (stratus_structure)structure;
    draw(*state, 1e-3, &transfer, &options, drawn);
    if (drawn[4 * CENTRE + 3] != 1.0f) {
      fail_msg("structure %d: alpha %.9g", structure, (double)drawn[4 * CENTRE + 3]);
    }
  }
}

/* Returns the exact alpha of a path through a medium of uniform opacity. */
static double absorbed(double opacity, double length)
{
  return -expm1(length * log1p(-opacity));
}

static void what_is_nearly_opaque_is_as_translucent_as_it_should_be(void** state)
{
  static const double nearly[] = { 0.9, 0.999, 0.999999, 1.0 - 0x1p-40 };
  for (size_t n = 0; n < sizeof nearly / sizeof *nearly; ++n) {
    const double without_one[] = { 0, nearly[n] }, with_one[] = { 0, nearly[n], 0.6, nearly[n], 0.7, 1, 1, 1 };
    for (int with = 0; with < 2; ++with) { /* one value of opacity 1 elsewhere costs no precision */
      const stratus_transfer transfer = function_of(with ? with_one : without_one, with ? 4 : 1);
      for (size_t s = 0; s < sizeof spacings / sizeof *spacings; ++s) {
        for (int sampling = STRATUS_SAMPLING_MIDPOINT; sampling <= STRATUS_SAMPLING_PREINTEGRATED; ++sampling) {
          stratus_ray_cast_options options = stratus_ray_cast_options_default();
          options.sampling.rule = (stratus_sampling)sampling;
          options.sampling.distance = spacings[s]; /* by hand: a tolerance would allow all of an alpha this small */
          options.sampling.termination = 1.0;
          fill_slab(0.25f, 0.25f);
          values[0] = with ? 1.0f : 0.0f; /* in a corner, for the table to span it */
          draw(*state, spacings[s], &transfer, &options, drawn);
          const double expected = absorbed(nearly[n], (SIDE - 1) * spacings[s]), alpha = (double)drawn[4 * CENTRE + 3];
          /* sums round depth by a few parts in a million */
          if (!(fabs(alpha - expected) <= 2e-4 * expected + ROUNDING)) {
            fail_msg("opacity %.12g%s, spacing %g, sampling %d: alpha %.9g, not %.9g", nearly[n], with ? " with 1" : "", spacings[s],
              sampling, alpha, expected);
          }
        }
      }
    }
  }
}

/* A value at which the function only touches 1 is passed on the way to others: its logarithm adds up to a depth of 1 per unit distance. */
static void a_peak_that_touches_1_is_no_wall(void** state)
{
  static const double peak[] = { 0, 0, 0.5, 1, 1, 0 };
  const stratus_transfer transfer = function_of(peak, 3);
  stratus_ray_cast_options options = stratus_ray_cast_options_default();
  options.sampling.rule = STRATUS_SAMPLING_PREINTEGRATED;
  options.sampling.termination = 1.0;
  for (int i = 0; i < SIDE * SIDE * SIDE; ++i) {
    values[i] = (float)(i / SIDE / SIDE) / (SIDE - 1);
  }
  for (size_t s = 0; s < sizeof spacings / sizeof *spacings; ++s) {
    draw(*state, spacings[s], &transfer, &options, drawn);
    const double expected = -expm1(-(SIDE - 1) * spacings[s]), alpha = (double)drawn[4 * CENTRE + 3];
    if (!(fabs(alpha - expected) <= 2e-3 * expected + ROUNDING)) {
      fail_msg("spacing %g: alpha %.9g, not %.9g", spacings[s], alpha, expected);
    }
  }
}

static void several_media_are_opaque_where_one_is(void** state)
{
  static float pairs[2 * SIDE * SIDE * SIDE];
  const stratus_transfer both[2] = { function_of(all, 1), function_of((const double[]){ 0, 0.1 }, 1) };
  stratus_ray_cast_options options = stratus_ray_cast_options_default();
  stratus_volume volume = stratus_volume_default();
  options.sampling.termination = 1.0;
  for (size_t s = 0; s < sizeof spacings / sizeof *spacings; ++s) {
    const stratus_camera camera = look_along_z(*state, spacings[s]);
    const stratus_image image = { .width = WIDTH, .height = WIDTH, .rgba = drawn };
    stratus_ray_caster* caster = NULL;
    volume.values = pairs;
    volume.components = 2;
    volume.value_stride = 2;
    for (int a = 0; a < 3; ++a) {
      volume.dimensions[a] = SIDE;
      volume.spacing[a] = spacings[s];
    }
    assert_int_equal(stratus_ray_caster_create(*state, &caster), STRATUS_OK);
    assert_int_equal(stratus_ray_caster_render(caster, &volume, both, &camera, &options, &image, NULL), STRATUS_OK);
    assert_true(drawn[4 * CENTRE + 3] == 1.0f);
    stratus_ray_caster_destroy(caster);
  }
}

static void tetrahedra_of_opacity_1_are_opaque_at_any_size(void** state)
{
  for (int f = 0; f < 3; ++f) {
    for (int method = STRATUS_TETRA_METHOD_MARCH; method <= STRATUS_TETRA_METHOD_PROJECT; ++method) {
      for (size_t s = 0; s < sizeof spacings / sizeof *spacings; ++s) {
        tetra_case c;
        stratus_tetra_caster* caster = NULL;
        const stratus_image image = { .width = WIDTH, .height = WIDTH, .rgba = drawn };
        const double middle = 2.0 * spacings[s], eye[3] = { middle, middle, 20.0 * spacings[s] }, focal[3] = { middle, middle, 0 };
        const double up[3] = { 0, 1, 0 };
        tetra_create(&c, 4, 0.05, 0.0, 3);
        for (int i = 0; i < 5 * 5 * 5; ++i) {
          c.values[i] = i / 25 == 2 || i / 25 == 3 ? 1.0f : 0.0f; /* cells whose points are all 1, and steep ones about them */
        }
        c.mesh.values = c.values;
        for (int i = 0; i < 12; i += 5) {
          c.mesh.matrix[i] = spacings[s];
        }
        stratus_transfer transfer = function_of(functions[f].points, functions[f].count);
        stratus_tetra_options options = stratus_tetra_options_default();
        options.method = (stratus_tetra_method)method;
        options.termination = 1.0;
        assert_int_equal(stratus_camera_parallel(*state, eye, focal, up, 3.0 * spacings[s], 1.0, &c.camera), STRATUS_OK);
        assert_int_equal(stratus_tetra_caster_create(*state, &caster), STRATUS_OK);
        assert_int_equal(stratus_tetra_caster_render(caster, &c.mesh, &transfer, &c.camera, &options, &image, NULL), STRATUS_OK);
        if (drawn[4 * CENTRE + 3] != 1.0f || fabsf(drawn[4 * CENTRE] - 1.0f) > 1e-6f) {
          fail_msg("function %d, method %d, spacing %g: alpha %.9g, red %.9g", f, method, spacings[s], (double)drawn[4 * CENTRE + 3],
            (double)drawn[4 * CENTRE]);
        }
        const double nearly[] = { 0, 0.999999, 0.6, 0.999999, 0.7, 1, 1, 1 };
        for (int i = 0; i < 5 * 5 * 5; ++i) {
          c.values[i] = 0.25f;
        }
        c.values[0] = 1.0f; /* in a corner */
        ++c.mesh.revision;
        transfer = function_of(nearly, 4);
        assert_int_equal(stratus_tetra_caster_render(caster, &c.mesh, &transfer, &c.camera, &options, &image, NULL), STRATUS_OK);
        const double least = absorbed(0.999999, 3.8 * spacings[s]), most = absorbed(0.999999, 4.2 * spacings[s]); /* by the jitter */
        const double alpha = (double)drawn[4 * CENTRE + 3];
        if (!(alpha >= least * 0.9999 && alpha <= most * 1.0001)) {
          fail_msg("nearly opaque, method %d, spacing %g: alpha %.9g, not in %.9g..%.9g", method, spacings[s], alpha, least, most);
        }
        stratus_tetra_caster_destroy(caster);
        tetra_destroy(&c);
      }
    }
  }
}

static int run_on(const char* device)
{
  stratus_context* context = open_context(device);
  const struct CMUnitTest tests[] = {
    cmocka_unit_test_prestate(a_slab_of_opacity_1_is_opaque_at_any_spacing, context),
    cmocka_unit_test_prestate(opacity_1_at_the_value_itself_is_opaque, context),
    cmocka_unit_test_prestate(a_narrow_band_of_opacity_1_is_met_on_the_way, context),
    cmocka_unit_test_prestate(what_is_nearly_opaque_is_as_translucent_as_it_should_be, context),
    cmocka_unit_test_prestate(a_peak_that_touches_1_is_no_wall, context),
    cmocka_unit_test_prestate(several_media_are_opaque_where_one_is, context),
    cmocka_unit_test_prestate(tetrahedra_of_opacity_1_are_opaque_at_any_size, context),
  };
  const int failures = cmocka_run_group_tests(tests, NULL, NULL);
  stratus_context_destroy(context);
  return failures;
}

int test_opacity_one(void)
{
  return run_on("host");
}

int test_opacity_one_device(void)
{
  return stratus_device_count() == 0 ? test_skip("no OpenCL device on this machine") : run_on("0");
}
