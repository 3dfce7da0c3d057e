/* SPDX-License-Identifier: BSD-3-Clause
 * Light that is scattered any number of times, compared with the path tracer, and with closed forms. */
#include "picture_case.h"

#include "base.h"
#include "testing.h"

static picture drawn;
static picture other;
static float paths[4 * CASE_PIXELS_MOST];

/* A case that is lit by a sun and a sky, without reflected light. small: for tests that draw many pictures, or by slow instructions. */
static void make_case(stratus_context* context, picture_case* c, int small)
{
  if (small) {
    case_create(context, c, STRATUS_FLOAT32, 17, 14, 15, 5);
  } else {
    case_create(context, c, STRATUS_FLOAT32, 30, 26, 28, 5);
  }
  c->options.light.shade = 1;
  c->options.sampling.tolerance = 0.01;
  stratus_shading* s = &c->options.light.shading;
  s->ambient = s->specular = 0.0;
  s->diffuse = 1.0;
  s->scattering = 1.0;
  s->multiple = 1;
  s->light_count = 1;
  s->lights[0] = (stratus_light){ .vector = { 3, -1, 2 }, .color = { 0.9, 0.9, 0.9 } };
  for (int i = 0; i < 3; ++i) {
    s->sky_zenith[i] = 0.4; /* grey, which needs one solution, not three */
    s->sky_horizon[i] = 0.1;
  }
}

/* Draws the case by paths. Returns their standard error. */
static double trace(stratus_context* context, const picture_case* c, int samples)
{
  const stratus_shading* s = &c->options.light.shading;
  stratus_path_tracer* tracer = NULL;
  stratus_path_report report;
  const stratus_image image = { .width = CASE_WIDTH, .height = CASE_HEIGHT, .rgba = paths };
  stratus_path_options options = stratus_path_options_default();
  options.samples = samples;
  options.albedo = s->diffuse;
  options.anisotropy = s->anisotropy;
  options.light_count = s->light_count;
  memcpy(options.lights, s->lights, sizeof options.lights);
  memcpy(options.sky_zenith, s->sky_zenith, sizeof options.sky_zenith);
  memcpy(options.sky_horizon, s->sky_horizon, sizeof options.sky_horizon);
  memcpy(options.up, s->up, sizeof options.up);
  assert_int_equal(stratus_path_tracer_create(context, &tracer), STRATUS_OK);
  assert_int_equal(stratus_path_tracer_render(tracer, &c->volume, &c->transfer, &c->camera, &options, &image, &report), STRATUS_OK);
  stratus_path_tracer_destroy(tracer);
  return report.standard_error;
}

static double difference(const float* a, const float* b)
{
  double squares = 0.0, count = 0.0, largest = 0.0;
  reference_error(a, b, CASE_PIXELS, &squares, &count, &largest);
  return sqrt(squares / count);
}

/* Pictures of many scatterings are nearer to the paths than those of one. */
static void many_scatterings_are_near_those_of_paths(void** state)
{
  (void)state;
  const double anisotropies[3] = { 0.0, 0.85, -0.5 };
  stratus_context* context = case_context("host", 2);
  picture_case c;
  make_case(context, &c, 0);
  stratus_shading* s = &c.options.light.shading;
  for (int n = few_run(); n < 3; ++n) {
    s->anisotropy = anisotropies[n];
    s->diffuse = n == 2 ? 0.8 : 1.0;
    const double noise = trace(context, &c, few_run() ? 256 : 1024);
    case_render(context, &c, &drawn);
    s->multiple = 0;
    s->shadows = 1;
    case_render(context, &c, &other);
    s->multiple = 1;
    const double many = difference(drawn.rgba, paths), once = difference(other.rgba, paths);
    const double model = sqrt(fmax(many * many - noise * noise, 0.0)); /* errors of pixels are independent of the noise */
    const double model_once = sqrt(fmax(once * once - noise * noise, 0.0));
    print_message("             g %g: %.4f from the paths, whose standard error is %.4f: %.4f without that; scattered once %.4f\n",
      s->anisotropy, many, noise, model, model_once);
    assert_true(noise < 0.04);
    assert_true(model < 0.03 && model_once > 3.0 * model);
  }
  case_destroy(&c);
  stratus_context_destroy(context);
}

/* Matter that absorbs nothing is invisible in a sky of one radiance. */
static void a_furnace_is_not_seen(void** state)
{
  (void)state;
  stratus_context* context = case_context("host", 2);
  picture_case c;
  static const double white[4] = { 0.0, 1.0, 1.0, 1.0 };
  make_case(context, &c, 0);
  stratus_shading* s = &c.options.light.shading;
  c.transfer.color = white;
  c.transfer.color_count = 1;
  s->light_count = 0;
  for (int i = 0; i < 3; ++i) {
    s->sky_zenith[i] = s->sky_horizon[i] = 0.7;
  }
  for (int n = 0; n < 2; ++n) {
    s->anisotropy = n ? 0.85 : 0.0;
    case_render(context, &c, &drawn);
    double largest = 0.0;
    for (int i = 0; i < 4 * CASE_PIXELS; ++i) {
      largest = fmax(largest, fabs((double)drawn.rgba[i] - (i % 4 < 3 ? 0.7 * (double)drawn.rgba[i / 4 * 4 + 3] : (double)drawn.rgba[i])));
    }
    print_message("             g %g: %.5f\n", s->anisotropy, largest);
    assert_true(largest < 0.004);
  }
  case_destroy(&c);
  stratus_context_destroy(context);
}

/* The grid is made anew when lights, the sky, colours or the phase function change, and by no camera. */
static void the_grid_is_made_when_it_is_stale(void** state)
{
  (void)state;
  stratus_context* context = case_context("host", 2);
  stratus_ray_caster* caster = NULL;
  picture_case c;
  make_case(context, &c, 1);
  stratus_shading* s = &c.options.light.shading;
  double color[4] = { 0.0, 1.0, 0.8, 0.6 };
  c.transfer.color = color;
  c.transfer.color_count = 1;
  c.options.sampling.tolerance = 0.3; /* of which coarse cells are enough */
  assert_int_equal(stratus_ray_caster_create(context, &caster), STRATUS_OK);
  case_render_with(context, caster, &c, &drawn);
  case_camera(context, &c, 3, 0);
  case_render_with(context, caster, &c, &drawn);
  assert_int_equal(drawn.report.light_builds, 1);
  for (int change = 0; change < 6; ++change) {
    s->lights[0].color[0] *= change == 0 ? 0.5 : 1.0;
    s->sky_zenith[1] *= change == 1 ? 0.5 : 1.0;
    s->anisotropy += change == 2 ? 0.5 : 0.0;
    s->diffuse -= change == 3 ? 0.3 : 0.0;
    color[2] *= change == 4 ? 0.5 : 1.0;
    s->up[0] += change == 5 ? 1.0 : 0.0;
    case_render_with(context, caster, &c, &drawn);
    assert_int_equal(drawn.report.light_builds, 2 + change);
  }
  case_render(context, &c, &other);
  assert_memory_equal(drawn.rgba, other.rgba, sizeof drawn.rgba);
  stratus_ray_caster_destroy(caster);
  case_destroy(&c);
  stratus_context_destroy(context);
}

/* Instruction sets and threads change no bit; a volume that was cut in two, as several volumes and as blocks, draws as the whole does. */
static void pictures_are_the_same_however_they_are_made(void** state)
{
  (void)state;
  stratus_context* context = case_context("host", 1);
  picture_case c;
  make_case(context, &c, 1);
  c.options.light.shading.anisotropy = 0.6;
  c.options.light.shading.sky_zenith[2] = 0.6;
  c.options.sampling.tolerance = 0.3;
  case_render(context, &c, &drawn);
  stratus_context_destroy(context);
  for (int isa = 0; isa < (few_run() ? 1 : 3); ++isa) { /* the portable one differs most */
    context = case_context("host", 2);
    context->isa = isa;
    case_render(context, &c, &other);
    assert_memory_equal(drawn.rgba, other.rgba, sizeof drawn.rgba);
    stratus_context_destroy(context);
  }
  context = case_context("host", 2);
  const double blocks = case_psnr_of_parts(context, &c, 7, &drawn, stratus_ray_caster_render_blocks);
  const double several = case_psnr_of_parts(context, &c, 7, &drawn, stratus_ray_caster_render_several);
  print_message("             blocks: %.1f dB, several: %.1f dB from the whole\n", blocks, several);
  assert_true(blocks > 40.0 && several > 40.0);
  case_destroy(&c);
  stratus_context_destroy(context);
}

static void bad_skies_are_refused(void** state)
{
  (void)state;
  stratus_context* context = case_context("host", 1);
  stratus_ray_caster* caster = NULL;
  picture_case c;
  make_case(context, &c, 1);
  const stratus_shading good = c.options.light.shading;
  const stratus_image image = { .width = CASE_WIDTH, .height = CASE_HEIGHT, .rgba = drawn.rgba };
  assert_int_equal(stratus_ray_caster_create(context, &caster), STRATUS_OK);
  for (int n = 0; n < 4; ++n) {
    stratus_shading* s = &c.options.light.shading;
    *s = good;
    s->scattering = n == 0 ? 0.0 : 1.0;
    s->sky_zenith[2] = n == 1 ? -0.1 : n == 2 ? (double)NAN : 1.0;
    s->up[2] = n == 3 ? 0.0 : 1.0;
    assert_int_equal(
      stratus_ray_caster_render(caster, &c.volume, &c.transfer, &c.camera, &c.options, &image, NULL), STRATUS_INVALID_ARGUMENT);
    print_message("             %s\n", stratus_context_message(context));
  }
  stratus_ray_caster_destroy(caster);
  case_destroy(&c);
  stratus_context_destroy(context);
}

int test_ray_scatter(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(many_scatterings_are_near_those_of_paths),
    cmocka_unit_test(a_furnace_is_not_seen),
    cmocka_unit_test(the_grid_is_made_when_it_is_stale),
    cmocka_unit_test(pictures_are_the_same_however_they_are_made),
    cmocka_unit_test(bad_skies_are_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
