/* SPDX-License-Identifier: BSD-3-Clause
 * Functions of two variables, compared with the double reference: the value with the gradient's magnitude or with a second component. No
 * structure, thread or instruction set changes a bit, the tolerance is kept, and combinations without a meaning are refused. */
#include "grid_case.h"
#include "testing.h"
#include "transfer_2d_case.h"
#include "volume.h"

/* dB against the reference at a quarter of a voxel, as of lit samples. */
#define MIDPOINT_DB 58.0
#define STEEPEST 0.25

static picture drawn, other;
static transfer_2d_case function;

static double psnr(const char* what, stratus_context* context, const picture_case* c)
{
  static float reference[4 * CASE_PIXELS_MOST];
  reference_scene scene = case_scene(c);
  double reference_db = 0.0;
  scene.shading = c->options.light.shade ? &c->options.light.shading : NULL;
  case_render(context, c, &drawn);
  assert_int_equal(reference_converged(&scene, CASE_WIDTH, CASE_HEIGHT, 62.0, reference, NULL, &reference_db), 0);
  const double db = reference_psnr(drawn.rgba, reference, CASE_PIXELS);
  print_message("             %s: %.1f dB, reference %.0f dB, %d pixels\n", what, db, reference_db, case_lit(&drawn));
  assert_true(case_lit(&drawn) > case_share(20));
  return db;
}

static void by_the_gradient_as_the_reference_says(void** state)
{
  picture_case c;
  case_create(*state, &c, STRATUS_FLOAT32, 30, 26, 28, 5);
  transfer_2d_case_set(&c, &function, 3, STEEPEST);
  assert_true(psnr("gradient", *state, &c) >= MIDPOINT_DB);
  c.options.light.shade = 1;
  c.options.light.shading.specular = 0.35;
  assert_true(psnr("lit", *state, &c) >= MIDPOINT_DB);
  function.of.unit_distance = 2.5;
  ++function.of.revision;
  assert_true(psnr("another unit", *state, &c) >= MIDPOINT_DB);
  case_destroy(&c);

  case_create(*state, &c, STRATUS_UINT8, 31, 27, 22, 6);
  transfer_2d_case_set(&c, &function, 4, STEEPEST);
  c.volume.spacing[0] = 0.7;
  c.volume.spacing[1] = 1.6;
  const double turned[16] = { 0.8, -0.6, 0, 30, 0.6, 0.8, 0.1, -7, 0, 0, -1.2, 900, 0, 0, 0, 1 };
  memcpy(c.volume.matrix, turned, sizeof turned);
  case_camera(*state, &c, 3, 1);
  c.options.sampling.distance = 0.15;
  assert_true(psnr("uneven, turned, mirrored and sheared; parallel", *state, &c) >= MIDPOINT_DB);
  case_destroy(&c);
}

static void of_every_type_at_borders_and_in_cells(void** state)
{
  for (int type = STRATUS_INT8; type <= STRATUS_FLOAT64; ++type) {
    picture_case c;
    case_create(*state, &c, (stratus_type)type, 9 + type, 5, 12, 11 + (uint32_t)type);
    transfer_2d_case_set(&c, &function, 90u + (uint32_t)type, STEEPEST);
    c.volume.cell_centered = type % 2;
    case_camera(*state, &c, type % 8, 0);
    assert_true(psnr(case_type_names[type], *state, &c) >= MIDPOINT_DB);
    case_destroy(&c);
  }
  picture_case c;
  case_create(*state, &c, STRATUS_UINT16, 20, 20, 20, 4);
  transfer_2d_case_set(&c, &function, 5, STEEPEST);
  c.options.sampling.interpolation = STRATUS_INTERPOLATION_NEAREST;
  c.options.sampling.distance = 0.02;
  assert_true(psnr("nearest", *state, &c) >= MIDPOINT_DB);
  case_destroy(&c);
}

static void by_a_second_component_as_the_reference_says(void** state)
{
  static const stratus_type types[] = { STRATUS_FLOAT32, STRATUS_UINT8, STRATUS_INT32, STRATUS_FLOAT64 };
  for (int i = 0; i < 4; ++i) {
    picture_case c;
    case_create(*state, &c, types[i], 26, 24, 21, 31u + (uint32_t)i);
    transfer_2d_case_pair(&c, &function, 77u + (uint32_t)i);
    transfer_2d_case_set(&c, &function, 12u + (uint32_t)i, 0.0);
    c.volume.cell_centered = i == 1;
    case_camera(*state, &c, i, 0);
    c.options.light.shade = i == 0;
    assert_true(psnr(case_type_names[types[i]], *state, &c) >= MIDPOINT_DB);
    free(function.pairs);
    case_destroy(&c);
  }
}

static void on_grids_whose_spacing_changes(void** state)
{
  picture_case c;
  grid_case grid;
  uint32_t none = 5;
  case_create(*state, &c, STRATUS_FLOAT32, 24, 22, 20, 8);
  grid_case_set(&c, &grid, GRID_GEOMETRIC, 7, 0.0, 1.0, 20.0, &none);
  transfer_2d_case_set(&c, &function, 9, 1.0);
  case_camera(*state, &c, 2, 0);
  c.options.sampling.distance = 0.01;
  assert_true(psnr("stretched 20:1", *state, &c) >= MIDPOINT_DB);
  case_destroy(&c);
}

/* Equal rows make a function of only the value: its points are the columns' middles. */
static void equal_rows_draw_the_picture_of_the_function_of_the_value(void** state)
{
  double opacity[2 * TRANSFER_2D_SIDE], color[4 * TRANSFER_2D_SIDE];
  picture_case c;
  case_create(*state, &c, STRATUS_FLOAT32, 30, 26, 28, 5);
  transfer_2d_case_set(&c, &function, 3, STEEPEST);
  for (int i = 0; i < function.of.columns; ++i) {
    const float* entry = function.rgba + 4 * i;
    for (int j = 1; j < function.of.rows; ++j) {
      memcpy(function.rgba + 4 * (j * function.of.columns + i), entry, 4 * sizeof *entry);
    }
    const double* range = function.of.value_range;
    opacity[2 * i] = color[4 * i] = range[0] + (i + 0.5) / function.of.columns * (range[1] - range[0]);
    opacity[2 * i + 1] = (double)entry[3];
    for (int k = 0; k < 3; ++k) {
      color[4 * i + 1 + k] = (double)entry[k];
    }
  }
  case_render(*state, &c, &drawn);
  c.options.optics.transfer_2d = NULL;
  c.transfer.opacity = opacity;
  c.transfer.color = color;
  c.transfer.opacity_count = c.transfer.color_count = (size_t)function.of.columns;
  case_render(*state, &c, &other);
  const double db = reference_psnr(drawn.rgba, other.rgba, CASE_PIXELS);
  print_message("             %.1f dB, %d pixels\n", db, case_lit(&drawn));
  assert_true(case_lit(&drawn) > case_share(100) && db > 75.0); /* the other has a table of 4096 entries and more */
  case_destroy(&c);
}

static void random_case(stratus_context* context, uint32_t seed, picture_case* c, grid_case* grid)
{
  case_create_random(context, seed, c);
  if (seed % 4 == 0) {
    grid_case_set_random(context, seed, c, grid);
  }
  c->options.sampling.rule = STRATUS_SAMPLING_MIDPOINT;
  c->options.light.shade = seed % 3 == 0;
  function.pairs = NULL;
  if (seed % 2) {
    transfer_2d_case_pair(c, &function, seed + 5);
  }
  transfer_2d_case_set(c, &function, seed, STEEPEST);
  if (seed % 5 == 0) { /* one visible column */
    for (int i = 0; i < 4 * function.of.columns * function.of.rows; ++i) {
      function.rgba[i] = i % 4 == 3 && i / 4 % function.of.columns != function.of.columns / 2 ? 0.0f : 0.7f;
    }
  }
}

static void no_structure_thread_or_instruction_set_changes_a_bit(void** state)
{
  stratus_context* contexts[3] = { case_context("host", 1), case_context("host", 3), case_context("host", 2) };
  int lit = 0, skipped = 0;
  (void)state;
  for (uint32_t seed = 1300; seed < 1350; seed += few_run() ? 3 : 1) {
    picture_case c;
    grid_case grid;
    random_case(contexts[0], seed, &c, &grid);
    c.options.skipping.structure = STRATUS_STRUCTURE_NONE;
    case_render(contexts[0], &c, &drawn);
    lit += case_lit(&drawn) > 0;
    for (int s = STRATUS_STRUCTURE_NONE; s <= STRATUS_STRUCTURE_HYBRID; ++s) {
      const int used = s % 3;
      c.options.skipping.structure = (stratus_structure)s;
      contexts[2]->isa = (int)(seed % 2);
      case_render(contexts[used == 0 ? 2 : used], &c, &other);
      skipped += s == STRATUS_STRUCTURE_DISTANCE && other.report.occupied_blocks < other.report.blocks && other.report.skipped > 0;
      if (memcmp(drawn.rgba, other.rgba, sizeof drawn.rgba) != 0 || memcmp(drawn.depth, other.depth, sizeof drawn.depth) != 0) {
        fail_msg("seed %u, %s: another picture", seed, stratus_structure_name(c.options.skipping.structure));
      }
    }
    free(function.pairs);
    case_destroy(&c);
  }
  print_message("             %d pictures, in %d something was skipped\n", lit, skipped);
  assert_true(lit > (few_run() ? 8 : 25) && skipped > (few_run() ? 2 : 8));
  for (int i = 0; i < 3; ++i) {
    stratus_context_destroy(contexts[i]);
  }
}

/* Automatic settings err by at most the tolerance, and the audit finds no pixel that skipping changed. */
static void the_tolerance_is_kept(void** state)
{
  static const double tolerances[] = { 0.01, 0.001 };
  static float reference[4 * CASE_PIXELS_MOST];
  int met = 0, beyond = 0, pictures = 0;
  for (uint32_t seed = 1; seed <= 12; seed += few_run() ? 5 : 1, pictures += 2) {
    picture_case c;
    case_create(*state, &c, seed % 2 ? STRATUS_FLOAT32 : STRATUS_UINT8, 30, 24, 27, seed);
    function.pairs = NULL;
    if (seed % 3 == 0) {
      transfer_2d_case_pair(&c, &function, seed + 40);
    }
    transfer_2d_case_set(&c, &function, seed, STEEPEST);
    c.options.sampling.rule = STRATUS_SAMPLING_AUTO;
    c.options.sampling.distance = 0.0;
    c.options.sampling.termination = 0.0;
    c.options.skipping.audit = 1;
    const reference_scene scene = case_scene(&c);
    assert_int_equal(reference_render(&scene, CASE_WIDTH, CASE_HEIGHT, 1.0 / 64.0, reference, NULL), 0);
    for (int t = 0; t < 2; ++t) {
      double squares = 0.0, count = 0.0, largest = 0.0;
      c.options.sampling.tolerance = tolerances[t];
      case_render(*state, &c, &drawn);
      assert_int_equal(drawn.report.differing_pixels, 0);
      assert_int_equal(drawn.report.sampling, STRATUS_SAMPLING_MIDPOINT);
      reference_error(drawn.rgba, reference, CASE_PIXELS, &squares, &count, &largest);
      const double ratio = count > 0.0 ? sqrt(squares / count) / tolerances[t] : 0.0;
      print_message("             seed %u, tolerance %g: %.2f of it, expected %.2g, step %.3g, %d pixels\n", seed, tolerances[t], ratio,
        drawn.report.expected_error, drawn.report.sample_distance, case_lit(&drawn));
      met += drawn.report.tolerance_met;
      beyond += drawn.report.tolerance_met && ratio > 1.0;
    }
    free(function.pairs);
    case_destroy(&c);
  }
  assert_int_equal(met, pictures);
  assert_int_equal(beyond, 0);
}

static void new_entries_change_the_picture_and_the_same_rebuild_nothing(void** state)
{
  picture_case c;
  stratus_ray_caster* caster = NULL;
  static picture plain;
  case_create(*state, &c, STRATUS_FLOAT32, 24, 24, 24, 8);
  assert_int_equal(stratus_ray_caster_create(*state, &caster), STRATUS_OK);
  case_render_with(*state, caster, &c, &plain);
  transfer_2d_case_set(&c, &function, 3, STEEPEST);
  case_render_with(*state, caster, &c, &drawn);
  const uint64_t occupancies = drawn.report.occupancy_builds, tables = drawn.report.table_builds;
  assert_true(memcmp(plain.rgba, drawn.rgba, sizeof plain.rgba) != 0);
  case_render_with(*state, caster, &c, &other);
  assert_int_equal(other.report.occupancy_builds, occupancies);
  assert_int_equal(other.report.table_builds, tables);
  assert_memory_equal(drawn.rgba, other.rgba, sizeof drawn.rgba);
  for (int i = 0; i < function.of.columns * function.of.rows; ++i) { /* an edit of only the colour */
    function.rgba[4 * i] = 1.0f - function.rgba[4 * i];
  }
  ++function.of.revision;
  case_render_with(*state, caster, &c, &other);
  assert_true(memcmp(drawn.rgba, other.rgba, sizeof drawn.rgba) != 0);
  c.options.optics.transfer_2d = NULL;
  case_render_with(*state, caster, &c, &other);
  assert_memory_equal(plain.rgba, other.rgba, sizeof plain.rgba);
  stratus_ray_caster_destroy(caster);
  case_destroy(&c);
}

static void expect_refusal(stratus_context* context, const picture_case* c, stratus_status status, const char* word)
{
  const stratus_image image = { .width = CASE_WIDTH, .height = CASE_HEIGHT, .rgba = drawn.rgba };
  stratus_ray_caster* caster = NULL;
  assert_int_equal(stratus_ray_caster_create(context, &caster), STRATUS_OK);
  assert_int_equal(stratus_ray_caster_render(caster, &c->volume, NULL, &c->camera, &c->options, &image, NULL), status);
  if (!strstr(stratus_context_message(context), word)) {
    fail_msg("'%s' says nothing of '%s'", stratus_context_message(context), word);
  }
  stratus_ray_caster_destroy(caster);
}

static void what_cannot_be_combined_or_is_no_function_is_refused(void** state)
{
  static const struct {
    int columns;
    double lo, hi, unit;
    float entry;
    const char* word;
  } wrong[] = { { 0, 0, 1, 1, 0.5f, "0 x" }, { 5000, 0, 1, 1, 0.5f, "4096" }, { 4, 1, 1, 1, 0.5f, "1..1" },
    { 4, 0, INFINITY, 1, 0.5f, "inf" }, { 4, 0, 1, 0, 0.5f, "unit distance 0" }, { 4, 0, 1, 1, 1.5f, "1.5" }, { 4, 0, 1, 1, NAN, "nan" } };
  picture_case c;
  case_create(*state, &c, STRATUS_FLOAT32, 8, 8, 8, 8);
  transfer_2d_case_set(&c, &function, 3, STEEPEST);
  c.options.sampling.rule = STRATUS_SAMPLING_CELLS;
  expect_refusal(*state, &c, STRATUS_UNSUPPORTED, "cells");
  c.options.sampling.rule = STRATUS_SAMPLING_PREINTEGRATED;
  expect_refusal(*state, &c, STRATUS_UNSUPPORTED, "pre-integrated");
  c.options.sampling.rule = STRATUS_SAMPLING_MIDPOINT;
  c.options.mode = STRATUS_MODE_MAXIMUM;
  expect_refusal(*state, &c, STRATUS_UNSUPPORTED, "maximum");
  c.options.mode = STRATUS_MODE_COMPOSITE;
  c.options.mask.label_count = 2;
  expect_refusal(*state, &c, STRATUS_UNSUPPORTED, "2 labels");
  c.options.mask.label_count = 0;
  c.volume.value_stride = c.volume.components = 3;
  c.volume.dimensions[2] = 2;
  expect_refusal(*state, &c, STRATUS_UNSUPPORTED, "3 components");
  c.volume.value_stride = c.volume.components = 1;
  for (size_t i = 0; i < sizeof wrong / sizeof *wrong; ++i) {
    function.of.columns = wrong[i].columns;
    function.of.rows = 1;
    function.of.value_range[0] = wrong[i].lo;
    function.of.value_range[1] = wrong[i].hi;
    function.of.unit_distance = wrong[i].unit;
    function.rgba[7] = wrong[i].entry;
    expect_refusal(*state, &c, STRATUS_INVALID_ARGUMENT, wrong[i].word);
  }
  case_destroy(&c);
}

int test_ray_transfer_2d(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(by_the_gradient_as_the_reference_says),
    cmocka_unit_test(of_every_type_at_borders_and_in_cells),
    cmocka_unit_test(by_a_second_component_as_the_reference_says),
    cmocka_unit_test(on_grids_whose_spacing_changes),
    cmocka_unit_test(equal_rows_draw_the_picture_of_the_function_of_the_value),
    cmocka_unit_test(no_structure_thread_or_instruction_set_changes_a_bit),
    cmocka_unit_test(the_tolerance_is_kept),
    cmocka_unit_test(new_entries_change_the_picture_and_the_same_rebuild_nothing),
    cmocka_unit_test(what_cannot_be_combined_or_is_no_function_is_refused),
  };
  return cmocka_run_group_tests(tests, case_set_up, case_tear_down);
}
