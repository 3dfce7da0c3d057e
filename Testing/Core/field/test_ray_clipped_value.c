/* SPDX-License-Identifier: BSD-3-Clause
 * Gradients at clip planes that take a given value in place of the field beyond, compared with the double reference, which asks the same of
 * each sample's six neighbours in doubles. */
#include "transfer_2d_case.h"
#include "volume.h"

/* dB against the reference, as of lit samples. A gradient jumps where a neighbour passes a plane, so that steps are short here. */
#define CLIPPED_DB 55.0
#define STEP 0.05

static picture drawn, other;
static transfer_2d_case function;

static void make(stratus_context* context, picture_case* c, stratus_type type, uint32_t seed)
{
  case_create(context, c, type, 22, 24, 20, seed);
  c->options.sampling.distance = STEP;
  c->options.clipping.clip_plane_count = 2;
  const double planes[2][4] = { { 1, 0.4, 0.2, -13 }, { -0.3, 1, -0.2, -4 } };
  memcpy(c->options.clipping.clip_planes, planes, sizeof planes);
  c->options.clipping.clip_gradients = 1;
  c->options.clipping.clipped_value = case_type_values[type].base - 2.0 * case_type_values[type].scale;
}

static void shine(picture_case* c)
{
  c->options.light.shade = 1;
  c->options.light.shading.ambient = 0.1;
  c->options.light.shading.diffuse = 0.8;
  c->options.light.shading.light_count = 1;
  c->options.light.shading.lights[0] = (stratus_light){ .vector = { 3, -1, 2 }, .color = { 1, 1, 1 } };
}

/* Also expects that the value beyond the planes changes the picture. */
static void expect_reference(stratus_context* context, picture_case* c, const char* what)
{
  static float reference[4 * CASE_PIXELS_MOST];
  c->options.clipping.clip_gradients = 0;
  case_render(context, c, &other);
  c->options.clipping.clip_gradients = 1;
  case_render(context, c, &drawn);
  reference_scene scene = case_scene(c);
  scene.shading = c->options.light.shade ? &c->options.light.shading : NULL;
  assert_int_equal(reference_render(&scene, CASE_WIDTH, CASE_HEIGHT, 1.0 / 128.0, reference, NULL), 0);
  const double db = reference_psnr(drawn.rgba, reference, CASE_PIXELS), whole = reference_psnr(other.rgba, reference, CASE_PIXELS);
  print_message("             %s: %.1f dB, by the whole field %.1f dB, %d pixels\n", what, db, whole, case_lit(&drawn));
  assert_true(case_lit(&drawn) > case_share(200));
  assert_true(db >= CLIPPED_DB && whole < CLIPPED_DB - 10.0);
}

static void light_and_gradient_opacity_as_the_reference_says(void** state)
{
  static const double steep[] = { 0.02, 0.0, 0.3, 0.5, 2.0, 1.0 };
  picture_case c;
  make(*state, &c, STRATUS_FLOAT32, 5);
  shine(&c);
  expect_reference(*state, &c, "lit");
  c.options.light.shade = 0;
  c.transfer.gradient = steep;
  c.transfer.gradient_count = 3;
  expect_reference(*state, &c, "gradient opacity");
  c.transfer.gradient_count = 0;
  transfer_2d_case_set(&c, &function, 3, 1.0);
  expect_reference(*state, &c, "a function of two variables");
  case_destroy(&c);
}

static void cells_nearest_values_and_turned_volumes(void** state)
{
  picture_case c;
  make(*state, &c, STRATUS_UINT8, 6);
  shine(&c);
  c.volume.cell_centered = 1;
  c.volume.spacing[0] = 0.7;
  c.volume.spacing[1] = 1.2;
  const double turned[16] = { 0.8, -0.6, 0, 3, 0.6, 0.8, 0.1, -7, 0, 0, -1.2, 9, 0, 0, 0, 1 };
  memcpy(c.volume.matrix, turned, sizeof turned);
  const double planes[2][4] = { { 1, 0.4, 0.2, 2 }, { -0.3, 1, -0.2, -4 } };
  memcpy(c.options.clipping.clip_planes, planes, sizeof planes);
  case_camera(*state, &c, 3, 1);
  expect_reference(*state, &c, "cells, uneven, turned, mirrored and sheared; parallel");
  case_destroy(&c);
  make(*state, &c, STRATUS_INT32, 7); /* relative to a bias */
  shine(&c);
  expect_reference(*state, &c, "int32");
  c.options.sampling.interpolation = STRATUS_INTERPOLATION_NEAREST;
  c.options.sampling.distance = 0.01;
  expect_reference(*state, &c, "nearest");
  case_destroy(&c);
}

static void no_structure_or_instruction_set_changes_a_bit(void** state)
{
  stratus_context* contexts[2] = { case_context("host", 1), case_context("host", 3) };
  int lit = 0;
  (void)state;
  for (uint32_t seed = 500; seed < 520; ++seed) {
    picture_case c;
    case_create_random(contexts[0], seed, &c);
    shine(&c);
    c.options.sampling.rule = seed % 2 ? STRATUS_SAMPLING_PREINTEGRATED : STRATUS_SAMPLING_MIDPOINT;
    c.options.clipping.clip_plane_count = 1;
    const double plane[4] = { 1, 0.5, -0.3, -0.5 * (double)c.volume.dimensions[0] };
    memcpy(c.options.clipping.clip_planes[0], plane, sizeof plane);
    c.options.clipping.clip_gradients = 1;
    c.options.clipping.clipped_value = -1e299; /* VTK's default */
    c.options.skipping.structure = STRATUS_STRUCTURE_NONE;
    case_render(contexts[0], &c, &drawn);
    lit += case_lit(&drawn) > 0;
    for (int i = 0; i < 4 * CASE_PIXELS; ++i) {
      assert_true(isfinite(drawn.rgba[i]));
    }
    for (int s = STRATUS_STRUCTURE_BLOCK; s <= STRATUS_STRUCTURE_HYBRID; ++s) {
      c.options.skipping.structure = (stratus_structure)s;
      contexts[1]->isa = s % 3;
      case_render(contexts[1], &c, &other);
      if (memcmp(drawn.rgba, other.rgba, sizeof drawn.rgba) != 0 || memcmp(drawn.depth, other.depth, sizeof drawn.depth) != 0) {
        fail_msg("seed %u, %s: another picture", seed, stratus_structure_name(c.options.skipping.structure));
      }
    }
    case_destroy(&c);
  }
  print_message("             %d pictures\n", lit);
  assert_true(lit > 8);
  stratus_context_destroy(contexts[0]);
  stratus_context_destroy(contexts[1]);
}

static void expect_refusal(stratus_context* context, const picture_case* c, stratus_status status, const char* word)
{
  const stratus_image image = { .width = CASE_WIDTH, .height = CASE_HEIGHT, .rgba = drawn.rgba };
  const stratus_transfer both[2] = { c->transfer, c->transfer };
  stratus_ray_caster* caster = NULL;
  assert_int_equal(stratus_ray_caster_create(context, &caster), STRATUS_OK);
  assert_int_equal(stratus_ray_caster_render(caster, &c->volume, both, &c->camera, &c->options, &image, NULL), status);
  assert_non_null(strstr(stratus_context_message(context), word));
  stratus_ray_caster_destroy(caster);
}

static void what_has_no_such_gradients_is_refused(void** state)
{
  double coordinates[22];
  picture_case c;
  make(*state, &c, STRATUS_FLOAT32, 5);
  c.options.clipping.clipped_value = (double)NAN;
  expect_refusal(*state, &c, STRATUS_INVALID_ARGUMENT, "clipped value nan");
  c.options.clipping.clipped_value = 0.0;
  for (int i = 0; i < 22; ++i) {
    coordinates[i] = i * i;
  }
  c.volume.coordinates[0] = coordinates;
  expect_refusal(*state, &c, STRATUS_UNSUPPORTED, "coordinates");
  c.volume.coordinates[0] = NULL;
  c.volume.dimensions[0] /= 2;
  c.volume.value_stride = c.volume.components = 2;
  expect_refusal(*state, &c, STRATUS_UNSUPPORTED, "several components");
  case_destroy(&c);
}

int test_ray_clipped_value(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(light_and_gradient_opacity_as_the_reference_says),
    cmocka_unit_test(cells_nearest_values_and_turned_volumes),
    cmocka_unit_test(no_structure_or_instruction_set_changes_a_bit),
    cmocka_unit_test(what_has_no_such_gradients_is_refused),
  };
  return cmocka_run_group_tests(tests, case_set_up, case_tear_down);
}
