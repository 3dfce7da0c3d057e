/* SPDX-License-Identifier: BSD-3-Clause
 * Gradient opacity, compared with the double reference: of optical depths and of opacities. */
#include "components_case.h"

#include "volume.h"

static picture other;

static void gradient_opacity_thins_as_the_reference_says(void** state)
{
  (void)state;
  static const double steep[] = { 0.05, 0.0, 0.2, 0.4, 0.45, 1.0 };
  stratus_context* context = case_context("host", 2);
  many m;
  many_create(context, &m, STRATUS_FLOAT32, 1, 26, 24, 28, 71);
  many_draw(context, &m, &other);
  m.transfers[0].gradient = steep;
  m.transfers[0].gradient_count = 3;
  many_check("midpoint", context, &m, MIDPOINT_DB);
  double before = 0.0, after = 0.0;
  for (int i = 0; i < CASE_PIXELS; ++i) {
    before += (double)other.rgba[4 * i + 3];
    after += (double)drawn.rgba[4 * i + 3];
    assert_true(drawn.rgba[4 * i + 3] <= other.rgba[4 * i + 3] + 1e-5f);
  }
  assert_true(after < 0.9 * before && after > 0.02 * before);
  m.c.options.light.shade = 1;
  m.c.volume.spacing[1] = 1.5; /* magnitudes are per mean spacing */
  case_camera(context, &m.c, 2, 0);
  many_check("lit, uneven", context, &m, MIDPOINT_DB);
  m.c.options.sampling.rule = STRATUS_SAMPLING_PREINTEGRATED;
  many_check("pre-integrated", context, &m, MIDPOINT_DB);
  many_destroy(&m);
  stratus_context_destroy(context);
}

/* Gradient opacity that scales the opacity over a length shows less than one that scales optical depth, and the less the greater the
 * length. Length 0 means optical depth. */
static void gradient_opacity_of_opacities_thins_as_the_reference_says(void** state)
{
  (void)state;
  static const double steep[] = { 0.05, 0.1, 0.2, 0.4, 0.45, 0.9 };
  static const double lengths[] = { 0.001, 0.5, 3.0, 50.0 };
  stratus_context* context = case_context("host", 2);
  for (int opaque = 0; opaque < 2; ++opaque) {
    many m;
    double before = INFINITY;
    many_create(context, &m, STRATUS_FLOAT32, 1, 26, 24, 28, 71);
    m.transfers[0].gradient = steep;
    m.transfers[0].gradient_count = 3;
    if (opaque) { /* the largest values have opacity 1, which depths cannot thin */
      m.c.opacity[5] = m.c.opacity[7] = 1.0;
    }
    many_draw(context, &m, &other);
    for (int i = 0; i < 4; ++i) {
      char what[64];
      double alpha = 0.0;
      m.c.options.optics.gradient_distance = lengths[i];
      m.c.options.light.shade = i == 2;
      m.c.options.sampling.distance = opaque ? 0.02 : m.c.options.sampling.distance; /* opacity 1 begins like a step */
      snprintf(what, sizeof what, "over %g%s%s", lengths[i], opaque ? ", opacity 1" : "", i == 2 ? ", lit" : "");
      many_check(what, context, &m, opaque ? 58.0 : MIDPOINT_DB);
      for (int pixel = 0; pixel < CASE_PIXELS; ++pixel) {
        alpha += (double)drawn.rgba[4 * pixel + 3];
      }
      assert_true(alpha < before);
      before = alpha;
      if (i == 0 && !opaque) {
        assert_true(reference_psnr(drawn.rgba, other.rgba, CASE_PIXELS) > 55.0);
      }
    }
    m.c.options.sampling.rule = STRATUS_SAMPLING_PREINTEGRATED;
    many_draw(context, &m, &drawn);
    assert_int_equal(drawn.report.sampling, STRATUS_SAMPLING_MIDPOINT);
    many_destroy(&m);
  }
  stratus_context_destroy(context);
}

/* A white slab of opacity 1 in a field of constant gradient: with gradient opacity F, a path of the given length shows F. */
static void a_slab_of_opacity_one_shows_its_gradient_opacity(void** state)
{
  (void)state;
  static const double fifth[] = { 0.0, 0.2, 1.0, 0.2 };
  stratus_context* context = case_context("host", 1);
  picture_case c;
  case_create(context, &c, STRATUS_FLOAT32, 8, 8, 5, 3);
  float* values = c.values;
  for (int v = 0; v < 8 * 8 * 5; ++v) {
    values[v] = (float)(v / 64);
  }
  c.opacity[0] = 0.0, c.opacity[2] = 1.0, c.opacity[4] = 2.0, c.opacity[6] = 4.0;
  c.opacity[1] = c.opacity[3] = c.opacity[5] = c.opacity[7] = 1.0;
  c.transfer.gradient = fifth;
  c.transfer.gradient_count = 2;
  c.volume.spacing[0] = c.volume.spacing[1] = c.volume.spacing[2] = 1.0;
  c.camera = (stratus_camera){ .eye = { 3.5, 3.5, -10.0 },
    .forward = { 0.0, 0.0, 1.0 },
    .right = { 5.0, 0.0, 0.0 },
    .up = { 0.0, 5.0, 0.0 },
    .far_k = INFINITY,
    .parallel = 1 };
  c.options.sampling.distance = 0.1;
  for (int times = 0; times < 4; ++times) { /* the slab is 4 long */
    const double length = times == 0 ? 0.0 : 4.0 / times, wanted = times == 0 ? 1.0 : 1.0 - pow(0.8, times);
    stratus_ray_caster* caster = NULL;
    const stratus_image image = { .width = CASE_WIDTH, .height = CASE_HEIGHT, .rgba = drawn.rgba };
    c.options.optics.gradient_distance = length;
    assert_int_equal(stratus_ray_caster_create(context, &caster), STRATUS_OK);
    assert_int_equal(stratus_ray_caster_render(caster, &c.volume, &c.transfer, &c.camera, &c.options, &image, NULL), STRATUS_OK);
    const double alpha = (double)drawn.rgba[4 * (CASE_HEIGHT / 2 * CASE_WIDTH + CASE_WIDTH / 2) + 3];
    print_message("             over %g: %.6f, wanted %.6f\n", length, alpha, wanted);
    assert_true(fabs(alpha - wanted) < 2e-5); /* floats of 40 samples */
    stratus_ray_caster_destroy(caster);
  }
  case_destroy(&c);
  stratus_context_destroy(context);
}

int test_ray_gradient_opacity(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(gradient_opacity_thins_as_the_reference_says),
    cmocka_unit_test(gradient_opacity_of_opacities_thins_as_the_reference_says),
    cmocka_unit_test(a_slab_of_opacity_one_shows_its_gradient_opacity),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
