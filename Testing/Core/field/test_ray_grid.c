/* SPDX-License-Identifier: BSD-3-Clause
 * Rectilinear grids. Equal spacing given as coordinates draws the image's picture; stretched grids draw the double reference's, which finds
 * cells in the coordinates themselves; no structure, block size or instruction set changes a bit; invalid grids are refused. */
#include "grid_case.h"
#include "ray_cast_host.h"
#include "reference_modes.h"
#include "volume.h"
#include "testing.h"

/* If tables translate positions, floats are rounded differently: one channel of RGBA may differ by this much. */
#define IMAGE_ERROR 1e-5f
/* Limit in dB against the reference with samples a hundredth of a mean voxel apart, about a fifth of the shortest one. It equals the limit
 * of image grids at a quarter of a voxel. */
#define GRID_STEP 0.01
#define GRID_DB 58.0

static picture drawn, other;
static float expected[4 * CASE_PIXELS_MOST], expected_depth[CASE_PIXELS_MOST];

static const stratus_mode modes[] = { STRATUS_MODE_MAXIMUM, STRATUS_MODE_MINIMUM, STRATUS_MODE_AVERAGE, STRATUS_MODE_ADDITIVE,
  STRATUS_MODE_ISOSURFACE };

static void ask_for(picture_case* c, stratus_mode mode)
{
  const double base = case_type_values[c->volume.type].base, scale = case_type_values[c->volume.type].scale;
  c->options.mode = mode;
  c->options.optics.average_range[0] = base - 2.0 * scale;
  c->options.optics.average_range[1] = base + 2.0 * scale;
  c->options.optics.contour_count = mode == STRATUS_MODE_ISOSURFACE ? 3 : 0;
  c->options.optics.contours[0] = base + 0.4 * scale;
  c->options.optics.contours[1] = base + 0.11 * scale;
  c->options.optics.contours[2] = base + 0.2 * scale;
}

static void shine(picture_case* c)
{
  c->options.light.shade = 1;
  c->options.light.shading.ambient = 0.15;
  c->options.light.shading.diffuse = 0.7;
  c->options.light.shading.specular = 0.35;
  c->options.light.shading.specular_power = 12.5;
}

static float largest_difference(void)
{
  float largest = 0.0f;
  for (int i = 0; i < 4 * CASE_PIXELS; ++i) {
    largest = fmaxf(largest, fabsf(drawn.rgba[i] - other.rgba[i]));
  }
  return largest;
}

static void expect_image(stratus_context* context, picture_case* c, grid_case* grid, const char* what)
{
  uint32_t none = 0;
  memset(c->volume.coordinates, 0, sizeof c->volume.coordinates);
  case_render(context, c, &drawn);
  grid_case_set(c, grid, GRID_EQUAL, 7, 0.0, 1.0, 1.0, &none);
  case_render(context, c, &other);
  const float largest = largest_difference();
  print_message("             %s: at most %.2g apart, %d pixels\n", what, (double)largest, case_lit(&drawn));
  assert_true(case_lit(&drawn) > case_share(100));
  assert_true(largest <= IMAGE_ERROR);
}

static void equal_spacing_draws_the_picture_of_the_image(void** state)
{
  static const char* const rules[] = { "auto", "midpoint", "pre-integrated", "cells" };
  for (int centered = 0; centered < 2; ++centered) {
    picture_case c;
    grid_case grid;
    case_create(*state, &c, STRATUS_FLOAT32, 31, 22, 27, 3u + (uint32_t)centered);
    c.volume.cell_centered = centered;
    case_camera(*state, &c, 2, 0);
    for (int rule = STRATUS_SAMPLING_AUTO; rule <= STRATUS_SAMPLING_CELLS; ++rule) {
      c.options.sampling.rule = (stratus_sampling)rule;
      expect_image(*state, &c, &grid, rules[rule]);
    }
    c.options.sampling.rule = STRATUS_SAMPLING_MIDPOINT;
    shine(&c);
    expect_image(*state, &c, &grid, "lit");
    c.options.light.shade = 0;
    for (size_t m = 0; m < sizeof modes / sizeof *modes; ++m) {
      ask_for(&c, modes[m]);
      expect_image(*state, &c, &grid, stratus_mode_name(modes[m]));
    }
    case_destroy(&c);
  }
}

static void expect_reference(stratus_context* context, const picture_case* c, const char* what, int axes)
{
  reference_scene scene = case_scene(c);
  double reference_db = 0.0, db;
  scene.shading = c->options.light.shade ? &c->options.light.shading : NULL;
  case_render(context, c, &drawn);
  if (c->options.mode == STRATUS_MODE_COMPOSITE) {
    assert_int_equal(reference_converged(&scene, CASE_WIDTH, CASE_HEIGHT, GRID_DB, expected, NULL, &reference_db), 0);
  } else {
    reference_modes_render(
      &c->volume, &c->transfer, &c->camera, &c->options, CASE_WIDTH, CASE_HEIGHT, 0.5 * GRID_STEP, expected, expected_depth);
  }
  db = reference_psnr(drawn.rgba, expected, CASE_PIXELS);
  print_message("             %s, axes %d%s: %.1f dB, %d pixels; %s\n", what, axes, c->volume.cell_centered ? ", cells" : "", db,
    case_lit(&drawn), drawn.report.why);
  assert_true(case_lit(&drawn) > case_share(100));
  assert_true(db >= GRID_DB);
}

static void make_stretched(stratus_context* context, picture_case* c, grid_case* grid, int axes, int centered)
{
  uint32_t none = 0;
  case_create(context, c, STRATUS_FLOAT32, 23, 29, 21, 5u + (uint32_t)axes);
  c->volume.cell_centered = centered;
  c->options.sampling.distance = GRID_STEP;
  grid_case_set(c, grid, GRID_GEOMETRIC, axes, -4.0, 1.0, 100.0, &none);
  case_camera(context, c, axes, axes % 2);
}

static void grids_stretched_a_hundredfold_draw_the_picture_of_the_reference(void** state)
{
  for (int axes = 1; axes < 8; axes += few_run() ? 3 : 1) {
    picture_case c;
    grid_case grid;
    make_stretched(*state, &c, &grid, axes, axes % 2);
    expect_reference(*state, &c, "midpoint", axes);
    c.options.sampling.rule = STRATUS_SAMPLING_PREINTEGRATED;
    expect_reference(*state, &c, "pre-integrated", axes);
    c.options.sampling.rule = STRATUS_SAMPLING_CELLS;
    expect_reference(*state, &c, "cells", axes);
    c.options.sampling.interpolation = STRATUS_INTERPOLATION_NEAREST;
    expect_reference(*state, &c, "cells, nearest", axes);
    case_destroy(&c);
  }
}

static void they_are_lit_and_thinned_as_the_reference_does(void** state)
{
  for (int axes = 1; axes < 8; axes += few_run() ? 6 : 3) {
    const double gradient[] = { 0.0, 0.1, 0.6, 1.0 };
    picture_case c;
    grid_case grid;
    make_stretched(*state, &c, &grid, axes, axes == 4);
    shine(&c);
    expect_reference(*state, &c, "lit", axes);
    c.options.sampling.interpolation = STRATUS_INTERPOLATION_NEAREST;
    expect_reference(*state, &c, "lit, nearest", axes);
    c.options.sampling.interpolation = STRATUS_INTERPOLATION_LINEAR;
    c.options.light.shade = 0;
    c.transfer.gradient = gradient;
    c.transfer.gradient_count = 2;
    expect_reference(*state, &c, "thinned by the gradient", axes);
    case_destroy(&c);
  }
}

static void every_mode_draws_the_picture_of_the_reference(void** state)
{
  for (size_t m = 0; m < sizeof modes / sizeof *modes; ++m) {
    const int axes = 7 - (int)m;
    picture_case c;
    grid_case grid;
    make_stretched(*state, &c, &grid, axes, m == 1);
    ask_for(&c, modes[m]);
    expect_reference(*state, &c, stratus_mode_name(modes[m]), axes);
    case_destroy(&c);
  }
}

/* The sampling is the probe's own choice. */
static void the_tolerance_is_kept(void** state)
{
  int judged = 0, cases = 0;
  for (uint32_t seed = 0; seed < 30; seed += few_run() ? 4 : 1, ++cases) {
    uint32_t random = seed;
    picture_case c;
    grid_case grid;
    case_create(*state, &c, seed % 2 ? STRATUS_FLOAT32 : STRATUS_UINT8, 20 + seed, 30, 25, seed);
    c.volume.cell_centered = seed % 3 == 0;
    grid_case_set(&c, &grid, seed % 4 ? GRID_GEOMETRIC : GRID_RANDOM, 1 + (int)(seed % 7), 0.0, 1.0, 100.0, &random);
    c.options = stratus_ray_cast_options_default();
    case_camera(*state, &c, (int)(seed % 8), 0);
    const reference_scene scene = case_scene(&c);
    assert_int_equal(reference_render(&scene, CASE_WIDTH, CASE_HEIGHT, 0.25, expected, NULL), 0);
    case_render(*state, &c, &drawn);
    double squares = 0.0, count = 0.0, largest = 0.0;
    reference_error(drawn.rgba, expected, CASE_PIXELS, &squares, &count, &largest);
    const double error = count > 0.0 ? sqrt(squares / count) : 0.0;
    print_message("             %u: error %.2g, at most %.2g; %s\n", seed, error, largest, drawn.report.why);
    assert_true(!drawn.report.tolerance_met || error <= c.options.sampling.tolerance);
    judged += drawn.report.tolerance_met && case_lit(&drawn) > CASE_PIXELS / 20;
    case_destroy(&c);
  }
  assert_true(judged > 25 * cases / 30);
}

static void expect_same(const char* what, uint32_t seed, int number)
{
  if (memcmp(drawn.rgba, other.rgba, sizeof drawn.rgba) || memcmp(drawn.depth, other.depth, sizeof drawn.depth)) {
    fail_msg("seed %u: %s %d changes the picture; %s", seed, what, number, other.report.why);
  }
}

static void no_structure_block_size_or_instruction_set_changes_a_bit(void** state)
{
  stratus_context* context = *state;
  const int best = context->isa;
  int lit = 0, cases = 0;
  for (uint32_t seed = 900; seed < 1020; seed += few_run() ? 5 : 1, ++cases) {
    uint8_t* mask = NULL;
    picture_case c;
    grid_case grid;
    case_create_random(context, seed, &c);
    grid_case_set_random(context, seed, &c, &grid);
    if (seed % 4 == 1) {
      ask_for(&c, modes[seed / 4 % 5]);
      c.options.sampling.interpolation =
        c.options.mode == STRATUS_MODE_ISOSURFACE ? STRATUS_INTERPOLATION_LINEAR : c.options.sampling.interpolation;
    } else if (seed % 8 == 2) {
      shine(&c);
    } else if (seed % 8 == 6) {
      const size_t values = (size_t)(c.volume.dimensions[0] * c.volume.dimensions[1] * c.volume.dimensions[2]);
      mask = malloc(values);
      assert_non_null(mask);
      for (size_t i = 0; i < values; ++i) {
        mask[i] = i % 7 != 0;
      }
      c.options.mask.bytes = mask;
    }
    if (c.options.light.shade || mask) { /* rule cells knows neither */
      c.options.sampling.rule = c.options.sampling.rule == STRATUS_SAMPLING_CELLS ? STRATUS_SAMPLING_MIDPOINT : c.options.sampling.rule;
    }
    c.options.skipping.structure = STRATUS_STRUCTURE_NONE;
    case_render(context, &c, &drawn);
    lit += case_lit(&drawn) > 0;
    for (int structure = STRATUS_STRUCTURE_AUTO; structure <= STRATUS_STRUCTURE_HYBRID; ++structure) {
      c.options.skipping.structure = (stratus_structure)structure;
      c.options.skipping.audit = 1;
      case_render(context, &c, &other);
      expect_same("structure", seed, structure);
      assert_int_equal(other.report.differing_pixels, 0);
      c.options.skipping.audit = 0;
    }
    c.options.skipping.structure = STRATUS_STRUCTURE_DISTANCE;
    c.options.skipping.block_size = 2 << seed % 5;
    case_render(context, &c, &other);
    expect_same("block size", seed, c.options.skipping.block_size);
    for (context->isa = 0; context->isa < best; ++context->isa) {
      case_render(context, &c, &other);
      expect_same("instruction set", seed, context->isa);
    }
    free(mask);
    case_destroy(&c);
  }
  assert_true(lit > cases / 2);
}

static void rule_local_keeps_its_bits_too(void** state)
{
  stratus_context* context = *state;
  int local = 0;
  for (uint32_t seed = 0; seed < 12; seed += few_run() ? 3 : 1) {
    uint32_t random = seed;
    picture_case c;
    grid_case grid;
    case_create_local(context, seed, &c);
    grid_case_set(&c, &grid, GRID_RANDOM, 7, 0.0, 1.0, 8.0, &random);
    c.options.skipping.structure = STRATUS_STRUCTURE_NONE;
    case_render(context, &c, &drawn);
    local += drawn.report.sampling == STRATUS_SAMPLING_LOCAL;
    for (int structure = STRATUS_STRUCTURE_AUTO; structure <= STRATUS_STRUCTURE_HYBRID; ++structure) {
      c.options.skipping.structure = (stratus_structure)structure;
      case_render(context, &c, &other);
      expect_same("structure", seed, structure);
    }
    case_destroy(&c);
  }
  print_message("             %d by rule local\n", local);
  assert_true(local > (few_run() ? 1 : 4));
}

/* Whole cells far from 0, like UTM coordinates, and the same grid listed from its other end. */
static void far_and_falling_coordinates_draw_the_same(void** state)
{
  uint32_t none = 0;
  picture_case c;
  grid_case grid;
  case_create(*state, &c, STRATUS_FLOAT32, 24, 20, 26, 12);
  c.options.sampling.rule = STRATUS_SAMPLING_PREINTEGRATED; /* a table of samples has steps, at which a rounding may show */
  grid_case_set(&c, &grid, GRID_GEOMETRIC, 7, 0.0, 1.0, 100.0, &none);
  case_camera(*state, &c, 1, 0);
  case_render(*state, &c, &drawn);
  for (int a = 0; a < 3; ++a) {
    for (int64_t i = 0; i < c.volume.dimensions[a]; ++i) {
      grid.of[a][i] += 6e6;
    }
    c.camera.eye[a] += 6e6;
  }
  case_render(*state, &c, &other);
  print_message("             far: %.2g\n", (double)largest_difference());
  assert_true(case_lit(&drawn) > case_share(100));
  assert_true(largest_difference() <= IMAGE_ERROR); /* doubles keep 1e-9 of a voxel there */

  const int64_t *n = c.volume.dimensions, values = n[0] * n[1] * n[2];
  float* turned = malloc((size_t)values * sizeof *turned);
  assert_non_null(turned);
  for (int64_t v = 0; v < values; ++v) { /* turned in x and z */
    const int64_t x = n[0] - 1 - v % n[0], y = v / n[0] % n[1], z = n[2] - 1 - v / n[0] / n[1];
    turned[(z * n[1] + y) * n[0] + x] = ((const float*)c.values)[v];
  }
  for (int a = 0; a < 3; a += 2) {
    for (int64_t i = 0; i < n[a] / 2; ++i) {
      const double swap = grid.of[a][i];
      grid.of[a][i] = grid.of[a][n[a] - 1 - i];
      grid.of[a][n[a] - 1 - i] = swap;
    }
  }
  c.volume.values = turned;
  c.options.clipping.crop = 1;
  c.options.clipping.crop_regions = 0x5a5a5a5u;
  for (int side = 0; side < 6; ++side) {
    c.options.clipping.crop_bounds[side] = 6e6 + (side % 2 ? 16.0 : 5.0) + side / 2;
  }
  case_render(*state, &c, &drawn);
  c.volume.values = c.values;
  for (int a = 0; a < 3; a += 2) {
    for (int64_t i = 0; i < n[a] / 2; ++i) {
      const double swap = grid.of[a][i];
      grid.of[a][i] = grid.of[a][n[a] - 1 - i];
      grid.of[a][n[a] - 1 - i] = swap;
    }
  }
  case_render(*state, &c, &other);
  print_message("             falling, in crop regions: %.2g, %d pixels\n", (double)largest_difference(), case_lit(&drawn));
  assert_true(case_lit(&drawn) > case_share(100));
  assert_true(largest_difference() <= IMAGE_ERROR);
  free(turned);
  case_destroy(&c);
}

static void the_least_grids_are_drawn(void** state)
{
  for (int centered = 0; centered < 2; ++centered) {
    uint32_t random = 3;
    picture_case c;
    grid_case grid;
    case_create(*state, &c, STRATUS_FLOAT32, 2 - centered, 2, 2, 7);
    for (int i = 0; i < 8 >> centered; ++i) {
      case_store(c.values, STRATUS_FLOAT32, (size_t)i, case_type_values[STRATUS_FLOAT32].base + 3.0 * (i % 3 - 0.5));
    }
    c.volume.cell_centered = centered;
    grid_case_set(&c, &grid, GRID_RANDOM, 7, 1.0, 3.0, 100.0, &random);
    case_camera(*state, &c, 3, 0);
    for (int rule = STRATUS_SAMPLING_MIDPOINT; rule <= STRATUS_SAMPLING_CELLS; ++rule) {
      c.options.sampling.rule = (stratus_sampling)rule;
      c.options.sampling.distance = GRID_STEP;
      expect_reference(*state, &c, "least", 7);
    }
    case_destroy(&c);
  }
}

static void refuse(stratus_context* context, const picture_case* c, const char* value, const char* what)
{
  if (stratus_volume_check(context, &c->volume) != STRATUS_INVALID_ARGUMENT) {
    fail_msg("%s: not refused", what);
  }
  const char* message = stratus_context_message(context);
  print_message("             %s\n", message);
  if (!strstr(message, value) || !strstr(message, "along y")) {
    fail_msg("%s: '%s' has no '%s'", what, message, value);
  }
}

static void what_is_no_grid_is_refused(void** state)
{
  uint32_t none = 0;
  picture_case c;
  grid_case grid;
  case_create(*state, &c, STRATUS_FLOAT32, 5, 9, 6, 7);
  grid_case_set(&c, &grid, GRID_EQUAL, 7, 0.0, 1.0, 1.0, &none);
  assert_int_equal(stratus_volume_check(*state, &c.volume), STRATUS_OK);
  grid.of[1][4] = (double)NAN;
  refuse(*state, &c, "coordinate 4", "NaN");
  grid.of[1][4] = (double)INFINITY;
  refuse(*state, &c, "inf", "infinite");
  grid.of[1][4] = 3.0;
  refuse(*state, &c, "coordinates 3 and 4", "repeated");
  grid.of[1][4] = 2.5;
  refuse(*state, &c, "must rise strictly", "not monotone");
  grid.of[1][4] = 3.0 + 1e-6;
  refuse(*state, &c, "2^-19", "too near");
  for (int i = 0; i < 9; ++i) {
    grid.of[1][i] = i % 2 ? -1e308 * (10 - i) / 5 : 1e308 * (10 - i) / 5;
  }
  refuse(*state, &c, "coordinate", "beyond doubles");
  for (int i = 0; i < 9; ++i) {
    grid.of[1][i] = 5.0;
  }
  refuse(*state, &c, "5", "all the same");
  c.volume.dimensions[1] = 1;
  refuse(*state, &c, "must be at least 2", "one coordinate");
  case_destroy(&c);
}

/* Sets of voxels for users' own rays know equal spacing only, and say so. */
static void voxels_are_refused(void** state)
{
  uint32_t none = 0;
  picture_case c;
  grid_case grid;
  stratus_voxels* voxels = NULL;
  const stratus_criterion criterion = stratus_criterion_default();
  case_create(*state, &c, STRATUS_FLOAT32, 9, 9, 9, 7);
  grid_case_set(&c, &grid, GRID_EQUAL, 4, 0.0, 1.0, 1.0, &none);
  assert_int_equal(stratus_voxels_create(*state, &c.volume, &criterion, &voxels), STRATUS_UNSUPPORTED);
  assert_non_null(strstr(stratus_context_message(*state), "rectilinear"));
  case_destroy(&c);
}

/* A caster that has drawn one grid draws another, and an image, as a new one does. */
static void other_coordinates_under_the_same_pointers_are_seen(void** state)
{
  uint32_t none = 0;
  picture_case c;
  grid_case grid;
  stratus_ray_caster* caster = NULL;
  case_create(*state, &c, STRATUS_FLOAT32, 20, 20, 20, 7);
  c.options.sampling.rule = STRATUS_SAMPLING_AUTO;
  assert_int_equal(stratus_ray_caster_create(*state, &caster), STRATUS_OK);
  for (int turn = 0; turn < 4; ++turn) {
    grid_case_set(&c, &grid, GRID_GEOMETRIC, turn == 2 ? 0 : 7, 0.0, 1.0, turn == 1 ? 30.0 : 3.0, &none);
    case_render_with(*state, caster, &c, &other);
    case_render(*state, &c, &drawn);
    expect_same("turn", 0, turn);
    assert_int_equal(other.report.range_builds, 1);
  }
  stratus_ray_caster_destroy(caster);
  case_destroy(&c);
}

int test_ray_grid(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(equal_spacing_draws_the_picture_of_the_image),
    cmocka_unit_test(grids_stretched_a_hundredfold_draw_the_picture_of_the_reference),
    cmocka_unit_test(they_are_lit_and_thinned_as_the_reference_does),
    cmocka_unit_test(every_mode_draws_the_picture_of_the_reference),
    cmocka_unit_test(the_tolerance_is_kept),
    cmocka_unit_test(no_structure_block_size_or_instruction_set_changes_a_bit),
    cmocka_unit_test(rule_local_keeps_its_bits_too),
    cmocka_unit_test(far_and_falling_coordinates_draw_the_same),
    cmocka_unit_test(the_least_grids_are_drawn),
    cmocka_unit_test(what_is_no_grid_is_refused),
    cmocka_unit_test(voxels_are_refused),
    cmocka_unit_test(other_coordinates_under_the_same_pointers_are_seen),
  };
  return cmocka_run_group_tests(tests, case_set_up, case_tear_down);
}
