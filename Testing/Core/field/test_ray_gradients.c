/* SPDX-License-Identifier: BSD-3-Clause
 * Gradients that a volume has of its own: where they are the differences that rays would take, pictures stay what they are, in every mode
 * that reads gradients; where they are others, they are seen. */
#include "components_case.h"
#include "gradients.h"
#include "transfer_2d_case.h"

static picture other;

/* dB between pictures whose gradients differ by rounding: by differences of the values, and by floats of them. */
#define SAME_DB 120.0

typedef struct gradient_case {
  const char* name;
  stratus_type type;
  int components, in_place;
  stratus_mode mode;
  stratus_interpolation interpolation;
  int centered, stretched, thin, two;
} gradient_case;

static const gradient_case cases[] = {
  { "in place", STRATUS_FLOAT32, 1, 1, .thin = 1 },
  { "apart", STRATUS_FLOAT32, 1, 0, .thin = 1 },
  { "bytes", STRATUS_UINT8, 1, 0, .thin = 0 },
  { "doubles", STRATUS_FLOAT64, 1, 0, .thin = 1 },
  { "three components", STRATUS_FLOAT32, 3, 0, .thin = 1 },
  { "two components of doubles, centred", STRATUS_FLOAT64, 2, 0, .centered = 1 },
  { "nearest", STRATUS_FLOAT32, 1, 1, .interpolation = STRATUS_INTERPOLATION_NEAREST, .thin = 1 },
  { "centred", STRATUS_FLOAT32, 1, 1, .centered = 1 },
  { "stretched", STRATUS_FLOAT32, 1, 1, .stretched = 1, .thin = 1 },
  { "stretched, nearest, centred", STRATUS_FLOAT32, 1, 1, .interpolation = STRATUS_INTERPOLATION_NEAREST, .stretched = 1, .centered = 1 },
  { "isosurface", STRATUS_FLOAT32, 1, 1, .mode = STRATUS_MODE_ISOSURFACE },
  { "isosurface of bytes", STRATUS_UINT8, 1, 0, .mode = STRATUS_MODE_ISOSURFACE, .stretched = 1 },
  { "first hits", STRATUS_FLOAT32, 1, 1, .mode = STRATUS_MODE_FIRST_HIT, .centered = 1 },
  { "first hits, stretched", STRATUS_UINT8, 1, 0, .mode = STRATUS_MODE_FIRST_HIT, .stretched = 1 },
  { "two variables", STRATUS_FLOAT32, 1, 1, .two = 1 },
  { "two variables, stretched", STRATUS_UINT8, 1, 0, .two = 1, .stretched = 1 },
};

/* Coordinates whose cells grow and shrink, the last axis falling. */
static void stretch(stratus_volume* volume, double coordinates[3][40])
{
  for (int axis = 0; axis < 3; ++axis) {
    double at = 0.3;
    for (int64_t i = 0; i <= volume->dimensions[axis]; ++i) {
      coordinates[axis][i] = axis == 2 ? -at : at;
      at += 0.7 + 0.6 * sin(0.9 * (double)i + axis) * sin(0.9 * (double)i + axis);
    }
    volume->coordinates[axis] = coordinates[axis];
  }
}

static void gradients_that_are_differences_change_nothing(void** state)
{
  (void)state;
  static const double steep[] = { 0.05, 0.1, 0.2, 0.4, 0.45, 0.9 };
  static transfer_2d_case two;
  stratus_context* context = case_context("host", 2);
  for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i) {
    const gradient_case* g = cases + i;
    double coordinates[3][40], thin[6];
    many m;
    many_create(context, &m, g->type, g->components, 22, 19, 24, 71u + (uint32_t)i);
    const double base = case_type_values[g->type].base, scale = case_type_values[g->type].scale;
    for (int n = 0; n < 6; ++n) {
      thin[n] = steep[n] * (n % 2 ? 1.0 : scale / 3.0);
    }
    m.transfers[g->components - 1].gradient = thin;
    m.transfers[g->components - 1].gradient_count = g->thin ? 3 : 0;
    m.c.volume.spacing[0] = 0.7;
    m.c.volume.cell_centered = g->centered;
    if (g->stretched) {
      stretch(&m.c.volume, coordinates);
    }
    m.c.options.mode = g->mode;
    m.c.options.sampling.interpolation = g->interpolation;
    m.c.options.light.shade = 1;
    m.c.options.light.shading.on = 1;
    m.c.options.light.shading.specular = 0.3;
    m.c.options.light.normals = STRATUS_NORMALS_GRADIENT;
    m.c.options.optics.contour_count = 1;
    m.c.options.optics.contours[0] = base + 0.2 * scale;
    if (g->two) {
      transfer_2d_case_set(&m.c, &two, 5, 0.3);
    }
    case_camera(context, &m.c, (int)(i % 8), 0);
    many_draw(context, &m, &drawn);
    float* memory = gradients_set(&m.c.volume, g->in_place);
    many_draw(context, &m, &other);
    const double db = reference_psnr(drawn.rgba, other.rgba, CASE_PIXELS);
    const int64_t* n = m.c.volume.dimensions;
    for (int64_t v = 0; v < 3 * g->components * n[0] * n[1] * n[2]; ++v) { /* the surface turns, and is as steep */
      ((float*)m.c.volume.gradients)[v] *= v / (n[0] * n[1] * n[2]) % 3 == 1 ? -1.0f : 1.0f;
    }
    ++m.c.volume.revision;
    many_draw(context, &m, &other);
    const double turned = reference_psnr(drawn.rgba, other.rgba, CASE_PIXELS);
    print_message("             %s: %.1f dB, %.1f turned, %d pixels\n", g->name, db, turned, case_lit(&drawn));
    assert_true(case_lit(&drawn) > case_share(200));
    assert_true(db > SAME_DB);
    assert_true(turned < 45.0);
    free(memory);
    many_destroy(&m);
  }
  stratus_context_destroy(context);
}

/* A gradient opacity of magnitudes in another length has its values in that length. */
static void magnitudes_are_of_the_length_that_is_set(void** state)
{
  (void)state;
  double steep[] = { 0.05, 0.1, 0.2, 0.4, 0.45, 0.9 };
  stratus_context* context = case_context("host", 2);
  many m;
  many_create(context, &m, STRATUS_FLOAT32, 1, 22, 19, 24, 71);
  m.transfers[0].gradient = steep;
  m.transfers[0].gradient_count = 3;
  m.c.volume.spacing[0] = 0.7;
  many_draw(context, &m, &drawn);
  m.c.options.optics.gradient_length = 5.0;
  many_draw(context, &m, &other);
  assert_true(reference_psnr(drawn.rgba, other.rgba, CASE_PIXELS) < 40.0);
  for (int i = 0; i < 3; ++i) {
    steep[2 * i] *= 5.0 / 0.9; /* the mean spacing */
  }
  many_draw(context, &m, &other);
  assert_true(reference_psnr(drawn.rgba, other.rgba, CASE_PIXELS) > SAME_DB);
  m.c.options.optics.gradient_length = -1.0;
  assert_int_equal(many_status(context, &m, &other), STRATUS_INVALID_ARGUMENT);
  assert_non_null(strstr(stratus_context_message(context), "gradient length -1"));
  many_destroy(&m);
  stratus_context_destroy(context);
}

/* Of a clip plane's value in gradients, a volume with gradients of its own knows nothing. */
static void gradients_of_its_own_are_refused_where_clip_planes_change_them(void** state)
{
  (void)state;
  stratus_context* context = case_context("host", 2);
  many m;
  many_create(context, &m, STRATUS_FLOAT32, 1, 12, 11, 10, 7);
  float* memory = gradients_set(&m.c.volume, true);
  m.c.options.light.shade = 1;
  m.c.options.clipping.clip_gradients = 1;
  m.c.options.clipping.clip_plane_count = 1;
  m.c.options.clipping.clip_planes[0][0] = 1.0;
  assert_int_equal(many_status(context, &m, &other), STRATUS_UNSUPPORTED);
  assert_non_null(strstr(stratus_context_message(context), "a volume with gradients"));
  free(memory);
  many_destroy(&m);
  stratus_context_destroy(context);
}

int test_ray_gradients(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(gradients_that_are_differences_change_nothing),
    cmocka_unit_test(magnitudes_are_of_the_length_that_is_set),
    cmocka_unit_test(gradients_of_its_own_are_refused_where_clip_planes_change_them),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
