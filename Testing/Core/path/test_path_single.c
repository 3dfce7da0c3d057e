/* SPDX-License-Identifier: BSD-3-Clause
 * The path tracer where light is known in closed form: transmittance by Beer and Lambert, single scattering, and the furnace. */
#include "path_case.h"

#define PI 3.141592653589793

/* 4 pi times the phase function of Henyey and Greenstein. */
static double phase(double g, double cosine)
{
  return (1.0 - g * g) / pow(1.0 + g * g - 2.0 * g * cosine, 1.5);
}

static void alpha_is_one_minus_the_transmittance(void** state)
{
  static const double sizes[] = { 1.0, 1e-6, 1e6 }, tilts[][3] = { { 0, 0, -1 }, { 1, 0.5, -1 }, { -0.3, 0.2, 1 } };
  stratus_context* context = *state;
  path_case c;
  char what[96];
  for (int s = 0; s < 3; ++s) { /* optical depth 1.5 along z */
    for (int t = 0; t < 3; ++t) {
      path_slab(context, &c, 1.5 / sizes[s], sizes[s], 4);
      path_look(context, &c, tilts[t], (double[3]){ 0, 0, 0.5 * sizes[s] }, 10.0 * sizes[s]);
      c.options.albedo = 0.0;
      c.options.seed = (uint64_t)(3 * s + t);
      c.options.samples = path_samples(1200);
      const double* d = tilts[t];
      const double slant = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]) / fabs(d[2]);
      const path_mean mean = path_draw(context, &c);
      snprintf(what, sizeof what, "alpha of a slab of %g, slant %.2f", sizes[s], slant);
      path_assert(what, -expm1(-1.5 * slant), mean.rgba[3], mean.error[3], 0.005);
      assert_true(mean.rgba[0] == 0.0); /* albedo 0 */
    }
  }
  for (int linear = 0; linear < 2; ++linear) { /* values 0..1 along z, whose opacity rises with them to .95 */
    path_slab(context, &c, 1.0, 3.0, 8);
    for (int i = 0; i < 32; ++i) {
      c.values[i] = i / 4 / 7.0;
    }
    const double ramp[] = { 0.0, 0.0, 1.0, 0.95 };
    memcpy(c.opacity, ramp, sizeof ramp);
    c.transfer.opacity_count = 2;
    c.options.interpolation = linear ? STRATUS_INTERPOLATION_LINEAR : STRATUS_INTERPOLATION_NEAREST;
    c.options.samples = path_samples(1500);
    double depth = 3.0 * (0.05 * log(0.05) + 0.95) / 0.95;
    for (int i = 0; i < 8 && !linear; ++i) {
      depth = (i == 0 ? 0.0 : depth) - log1p(-0.95 * i / 7.0) * 3.0 / 7.0 * (i == 0 || i == 7 ? 0.5 : 1.0);
    }
    const path_mean mean = path_draw(context, &c);
    path_assert(linear ? "alpha of a linear field" : "alpha of its nearest values", -expm1(-depth), mean.rgba[3], mean.error[3], 0.005);
  }
}

static void opacity_one_is_opaque_on_any_scale(void** state)
{
  static const double units[] = { 1.0, 1e6, 1e-6 }; /* a slab one, a millionth and a million unit distances thick */
  for (int i = 0; i < 3; ++i) {
    path_case c;
    path_slab(*state, &c, 1.0, 1.0, 4);
    c.opacity[1] = 1.0;
    c.transfer.unit_distance = units[i];
    path_sun(&c, 0.7);
    c.options.bounces = 1;
    c.options.samples = path_samples(1000);
    const path_mean mean = path_draw(*state, &c);
    assert_true(mean.rgba[3] == 1.0);
    path_assert("single scattering of opacity 1", 0.7 / 1.7, mean.rgba[0], mean.error[0], 0.01);
  }
}

static void cells_with_a_corner_that_is_not_finite_neither_absorb_nor_scatter(void** state)
{
  static const double holes[] = { (double)NAN, (double)INFINITY, 1e300 };
  for (int i = 0; i < 3; ++i) { /* of three layers of cells, the upper two are transparent */
    path_case c;
    path_slab(*state, &c, 1.0, 1.0, 4);
    for (int v = 8; v < 12; ++v) {
      c.values[v] = holes[i];
    }
    path_sun(&c, 0.7);
    c.options.bounces = 1;
    c.options.samples = path_samples(1000);
    const path_mean mean = path_draw(*state, &c);
    path_assert("alpha below a hole", -expm1(-1.0 / 3.0), mean.rgba[3], mean.error[3], 0.02);
    path_assert("light below a hole", -0.7 / 1.7 * expm1(-1.7 / 0.7 / 3.0), mean.rgba[0], mean.error[0], 0.02);
  }
}

/* A slab lit by a sun: integrals of exp(-t/mu) exp(-t/mu0) dt/mu. */
static void single_scattering_in_a_slab_has_its_closed_form(void** state)
{
  static const double anisotropies[] = { 0.0, 0.85, -0.5, 0.99, -0.99 }, suns[] = { 1.0, 0.6, 0.15, -0.8, -0.3 };
  stratus_context* context = *state;
  char what[96];
  for (size_t g = 0; g < 5; ++g) {
    for (size_t s = 0; s < 5; ++s) {
      path_case c;
      const double tau = 2.0, sun = suns[s], direction[3] = { 0.3, -0.2, -1.0 }, mu = 1.0 / sqrt(1.13);
      path_slab(context, &c, tau, 1.0, 3);
      path_look(context, &c, direction, (double[3]){ 0, 0, 0.5 }, 10.0);
      path_sun(&c, sun);
      c.color[2] = 0.5;
      c.color[3] = 0.25;
      c.options.albedo = 0.8;
      c.options.lights[0].color[1] = 3.0;
      c.options.anisotropy = anisotropies[g];
      c.options.bounces = 1;
      c.options.samples = path_samples(500);
      c.options.seed = 5 * g + s;
      const double cosine = mu * (0.3 * sqrt(1.0 - sun * sun) - sun), rate = 1.0 / mu + 1.0 / sun;
      const double depth = (sun > 0.0 ? 1.0 : exp(tau / sun)) * -expm1(-tau * rate) / rate / mu;
      const double expected = 0.8 * phase(anisotropies[g], cosine) * depth;
      const path_mean mean = path_draw(context, &c);
      snprintf(what, sizeof what, "single, g %.2f, sun %.2f", anisotropies[g], sun);
      path_assert(what, expected, mean.rgba[0], mean.error[0], 0.03);
      path_assert("    half as bright a colour, 3 times the light", 1.5 * expected, mean.rgba[1], mean.error[1], 0.03);
      path_assert("    a quarter", 0.25 * expected, mean.rgba[2], mean.error[2], 0.03);
    }
  }
}

/* A lamp in the middle of a slab that the rays pass at a distance, by Simpson's rule. */
static void lamps_have_attenuation_and_cones(void** state)
{
  for (int cone = 0; cone < 2; ++cone) {
    path_case c;
    const double sigma = 1.2, lamp[3] = { 0.7, 0.0, 0.4 };
    path_slab(*state, &c, sigma, 1.0, 5);
    c.options.light_count = 1;
    c.options.lights[0] =
      (stratus_light){ .vector = { 0.7, 0.0, 0.4 }, .color = { 2, 2, 2 }, .positional = 1, .attenuation = { 0.5, 0.1, 2.0 } };
    c.options.lights[0].cone_angle = cone ? 60.0 : 0.0;
    c.options.lights[0].cone_exponent = 3.0;
    c.options.lights[0].axis[0] = -2.0;
    c.options.anisotropy = 0.4;
    c.options.bounces = 1;
    c.options.samples = path_samples(1200);
    double expected = 0.0;
    const int steps = 4000;
    for (int i = 0; i <= steps; ++i) {
      const double z = (double)i / steps, to[3] = { lamp[0], 0.0, lamp[2] - z }, r = sqrt(to[0] * to[0] + to[2] * to[2]);
      const double in_cone = to[0] / r < 0.5 ? 0.0 : pow(to[0] / r, 3.0);
      const double light = exp(-sigma * (1.0 - z + r)) * phase(0.4, -to[2] / r) * (cone ? in_cone : 1.0);
      expected += sigma * 2.0 * light / (0.5 + 0.1 * r + 2.0 * r * r) * (i == 0 || i == steps ? 1 : i % 2 ? 4 : 2) / (3.0 * steps);
    }
    const path_mean mean = path_draw(*state, &c);
    path_assert(cone ? "a spot light" : "a lamp", expected, mean.rgba[0], mean.error[0], 0.01);
  }
}

/* The light at the eye shines along the rays. It is one direction where they are parallel. */
static void the_headlight_shines_from_the_eye(void** state)
{
  path_case c;
  path_slab(*state, &c, 1.0, 1.0, 2);
  c.options.light_count = -1;
  c.options.bounces = 1;
  c.options.samples = path_samples(1500);
  const path_mean mean = path_draw(*state, &c);
  path_assert("headlight", -0.5 * expm1(-2.0), mean.rgba[0], mean.error[0], 0.005);
  c.camera.parallel = 0; /* a camera 10 away that sees a thousandth of a radian */
  for (int a = 0; a < 3; ++a) {
    c.camera.right[a] *= 0.01;
    c.camera.up[a] *= 0.01;
  }
  const path_mean lamp = path_draw(*state, &c);
  path_assert("headlight in perspective", -0.5 * expm1(-2.0), lamp.rgba[0], lamp.error[0], 0.005);
  c.options.light_count = 1;
  c.options.lights[0] = (stratus_light){ .vector = { 0, 0, 5 }, .color = { 1, 1, 1 }, .follows_camera = 1 };
  const path_mean follows = path_draw(*state, &c);
  path_assert("a direction that follows the camera", -0.5 * expm1(-2.0), follows.rgba[0], follows.error[0], 0.005);
}

/* In a furnace of radiance 1, a medium that absorbs nothing is as bright as the sky behind it: a pixel's radiance is its alpha, whatever
 * the field, the phase function and the holes. */
static void a_furnace_makes_every_medium_as_bright_as_itself(void** state)
{
  static const double anisotropies[] = { 0.0, 0.85, -0.99, 0.99 };
  for (int kind = 0; kind < 4; ++kind) {
    path_case c;
    uint32_t random = 11u + (uint32_t)kind;
    int collided = 0;
    float rgba[4 * PATH_PIXELS], errors[4 * PATH_PIXELS];
    path_slab(*state, &c, 1.0, 1.0, 2);
    for (int i = 0; i < 8 * 8 * 32; ++i) {
      c.values[i] = case_random(&random) % 30 ? case_uniform(&random, 0.0, 1.0) : (double)NAN;
    }
    const double steps[] = { 0.2, 0.0, 0.5, 0.3, 0.5, 0.9, 1.0, 0.6 };
    memcpy(c.opacity, steps, sizeof steps);
    c.transfer.opacity_count = 4;
    c.transfer.unit_distance = 1.0;
    for (int a = 0; a < 3; ++a) {
      c.volume.dimensions[a] = a < 2 ? 8 : 32;
      c.volume.spacing[a] = a < 2 ? 0.8 : 0.2;
      c.volume.origin[a] = -2.8;
      c.options.sky_zenith[a] = c.options.sky_horizon[a] = 1.0;
    }
    path_look(*state, &c, (double[3]){ 0.4, 1.0, -0.3 }, (double[3]){ 0, 0, 0 }, 2000.0);
    c.options.anisotropy = anisotropies[kind];
    c.options.samples = path_samples(100);
    stratus_path_report report;
    path_draw_into(*state, &c, rgba, errors, &report);
    for (int i = 0; i < PATH_PIXELS; ++i) {
      collided += rgba[4 * i + 3] > 0.2f && rgba[4 * i + 3] < 0.99f;
      for (int channel = 0; channel < 3; ++channel) { /* each path brings 1, so that only the sums' rounding is left */
        assert_true(fabsf(rgba[4 * i + channel] - rgba[4 * i + 3]) <= 1e-6f);
      }
    }
    print_message("             furnace, g %.2f: %d pixels, %.1f scatterings a path\n", anisotropies[kind], collided,
      (double)report.vertices / (double)report.samples / PATH_PIXELS);
    assert_true(collided > 10 && report.vertices > report.samples * PATH_PIXELS / 2);
  }
}

int test_path_single(void)
{
  const struct CMUnitTest tests[] = { cmocka_unit_test(alpha_is_one_minus_the_transmittance),
    cmocka_unit_test(opacity_one_is_opaque_on_any_scale),
    cmocka_unit_test(cells_with_a_corner_that_is_not_finite_neither_absorb_nor_scatter),
    cmocka_unit_test(single_scattering_in_a_slab_has_its_closed_form), cmocka_unit_test(lamps_have_attenuation_and_cones),
    cmocka_unit_test(the_headlight_shines_from_the_eye), cmocka_unit_test(a_furnace_makes_every_medium_as_bright_as_itself) };
  return cmocka_run_group_tests(tests, case_set_up, case_tear_down);
}
