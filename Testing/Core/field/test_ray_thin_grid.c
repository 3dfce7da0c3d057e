/* SPDX-License-Identifier: BSD-3-Clause
 * Grids whose voxels are a hundred to a thousand million times as long as they are thin, drawn with automatic steps.
 *
 * The oracle: a grid of cubes with the same values, which other tests compare with the reference, seen by a camera that is stretched as the
 * voxels are. Each ray then passes the same places of the same voxels, in lengths that differ by one factor a ray. Largest values, means
 * and surfaces know no lengths, and where rays are parallel the factor is one for all of them. */
#include "transfer_2d_case.h"
#include "base.h"
#include "testing.h"

#define MODES 6
#define THIN_DB 56.0 /* two pictures that keep 60 dB each; measured: 58 and more */
/* At most so many times the samples of the grid of cubes, for which the probe chooses steps of its own; measured: 2.8. */
#define SAMPLES_MORE 4.0

static picture cubes, thin;

/* Squeezes or stretches axis `axis` by `factor`, of the volume and of everything that sees it. */
static void stretch(picture_case* c, int axis, double factor)
{
  const double* f = c->camera.forward;
  const double before = f[0] * f[0] + f[1] * f[1] + f[2] * f[2];
  c->volume.spacing[axis] *= factor;
  c->volume.origin[axis] *= factor;
  c->camera.eye[axis] *= factor;
  c->camera.forward[axis] *= factor;
  c->camera.right[axis] *= factor;
  c->camera.up[axis] *= factor;
  if (c->camera.parallel) {
    c->transfer.unit_distance *= sqrt((f[0] * f[0] + f[1] * f[1] + f[2] * f[2]) / before);
  }
}

static void set_mode(picture_case* c, stratus_mode mode)
{
  c->options = stratus_ray_cast_options_default();
  c->options.mode = mode;
  c->options.optics.contour_count = 1;
  c->options.optics.contours[0] = case_type_values[c->volume.type].base + 0.1 * case_type_values[c->volume.type].scale;
}

static void expect_alike(stratus_context* context, const picture_case* even, const picture_case* uneven, const char* what)
{
  case_render(context, even, &cubes);
  case_render(context, uneven, &thin);
  const double db = reference_psnr(thin.rgba, cubes.rgba, CASE_PIXELS);
  const double more = (double)thin.report.samples / (double)cubes.report.samples;
  print_message("             %s: %s, %.1f dB, %.2f times the samples\n", what, stratus_sampling_name(thin.report.sampling), db, more);
  assert_true(case_lit(&cubes) > case_share(100));
  assert_true(thin.report.follows_voxels && !cubes.report.follows_voxels);
  assert_true(db >= THIN_DB);
  if (thin.report.sampling == cubes.report.sampling && !uneven->options.light.shade) {
    assert_true(more <= SAMPLES_MORE);
  }
}

static void every_mode_draws_thin_voxels(void** state)
{
  static const stratus_mode modes[MODES] = { STRATUS_MODE_COMPOSITE, STRATUS_MODE_MAXIMUM, STRATUS_MODE_MINIMUM, STRATUS_MODE_AVERAGE,
    STRATUS_MODE_ADDITIVE, STRATUS_MODE_ISOSURFACE };
  static const char* const names[MODES] = { "composite", "maximum", "minimum", "average", "additive", "isosurface" };
  static const double factors[] = { 1e-2, 1e-5, 1e-9, 1e5 };
  for (int m = 0; m < MODES; ++m) {
    for (int i = few_run() ? m % 2 : 0; i < 4; i += few_run() ? 2 : 1) {
      picture_case even;
      char what[64];
      case_create(*state, &even, i % 2 ? STRATUS_UINT8 : STRATUS_FLOAT32, 30, 26, 20, 11u + (uint32_t)i);
      set_mode(&even, modes[m]);
      case_camera(*state, &even, 1 + i, modes[m] == STRATUS_MODE_COMPOSITE || modes[m] == STRATUS_MODE_ADDITIVE || i % 2);
      picture_case uneven = even;
      stretch(&uneven, (m + i) % 3, factors[i]);
      snprintf(what, sizeof what, "%s, axis %d by %g", names[m], (m + i) % 3, factors[i]);
      expect_alike(*state, &even, &uneven, what);
      case_destroy(&even);
    }
  }
}

static void every_rule_draws_thin_voxels(void** state)
{
  int local = 0;
  for (stratus_sampling rule = STRATUS_SAMPLING_MIDPOINT; rule <= STRATUS_SAMPLING_CELLS; ++rule) {
    picture_case even;
    case_create(*state, &even, STRATUS_FLOAT32, 30, 26, 20, 5);
    set_mode(&even, STRATUS_MODE_COMPOSITE);
    even.options.sampling.rule = rule;
    case_camera(*state, &even, 3, 1);
    picture_case uneven = even;
    stretch(&uneven, 2, 1e-6);
    expect_alike(*state, &even, &uneven, stratus_sampling_name(rule));
    assert_int_equal(thin.report.sampling, rule);
    case_destroy(&even);
  }
  for (uint32_t seed = 1; seed < (few_run() ? 3 : 6); ++seed) { /* options cannot request rule local */
    picture_case even;
    case_create_local(*state, seed, &even);
    even.options.clipping.crop = 0;
    case_camera(*state, &even, (int)seed, 1);
    picture_case uneven = even;
    stretch(&uneven, (int)(seed % 3), 1e-2);
    expect_alike(*state, &even, &uneven, "rough and smooth");
    local += thin.report.sampling == STRATUS_SAMPLING_LOCAL;
    case_destroy(&even);
  }
  assert_true(local > 0);
}

/* No visible part may be missed if rays are nearly in the layers' planes, or if one looks along the long side. */
static void rays_along_the_layers(void** state)
{
  picture_case even;
  case_create(*state, &even, STRATUS_FLOAT32, 30, 26, 20, 8);
  set_mode(&even, STRATUS_MODE_MAXIMUM);
  for (int view = 0; view < 2; ++view) {
    case_camera(*state, &even, 0, 0);
    const double eye[2][3] = { { -30, 12.3, 9.7 }, { 14.2, 12.1, 60 } }, forward[2][3] = { { 1, 0, 0 }, { 0, 0, -1 } };
    memcpy(even.camera.eye, eye[view], sizeof eye[view]);
    memcpy(even.camera.forward, forward[view], sizeof forward[view]);
    memcpy(even.camera.right, ((double[3]){ 0, 0.4, 0 }), sizeof even.camera.right);
    memcpy(even.camera.up, view ? ((double[3]){ 0.4, 0, 0 }) : ((double[3]){ 0, 0, 0.4 }), sizeof even.camera.up);
    picture_case uneven = even;
    stretch(&uneven, 2, 1e-7);
    expect_alike(*state, &even, &uneven, view ? "along the thin side" : "along the layers");
  }
  case_destroy(&even);
}

/* Directions of gradients do change with the voxels, so that the oracle of lit samples is the reference of the thin grid itself. */
static void lit_samples_follow_too(void** state)
{
  static float expected[4 * CASE_PIXELS_MOST];
  static const double steep[4] = { 0.0, 0.3, 2.0, 1.0 };
  for (int thins = few_run() ? 1 : 0; thins < 2; ++thins) {
    picture_case c;
    double agreement;
    case_create(*state, &c, STRATUS_FLOAT32, 22, 20, 16, 4);
    set_mode(&c, STRATUS_MODE_COMPOSITE);
    case_camera(*state, &c, 2, 0);
    stretch(&c, 2, 1e-2);
    c.transfer.unit_distance = 0.05;
    c.options.light.shade = 1;
    c.options.light.shading.specular = 0.35;
    c.transfer.gradient = steep;
    c.transfer.gradient_count = thins ? 2 : 0;
    case_render(*state, &c, &thin);
    reference_scene scene = case_scene(&c);
    scene.shading = &c.options.light.shading;
    assert_int_equal(reference_converged(&scene, CASE_WIDTH, CASE_HEIGHT, THIN_DB, expected, NULL, &agreement), 0);
    const double db = reference_psnr(thin.rgba, expected, CASE_PIXELS);
    print_message("             lit: %.1f dB, the reference %.1f\n", db, agreement);
    assert_true(thin.report.follows_voxels && case_lit(&thin) > case_share(100));
    assert_true(db >= THIN_DB);
    case_destroy(&c);
  }
}

static void functions_of_two_variables_follow_too(void** state)
{
  picture_case even;
  static transfer_2d_case f;
  case_create(*state, &even, STRATUS_FLOAT32, 30, 26, 20, 7);
  transfer_2d_case_pair(&even, &f, 3);
  set_mode(&even, STRATUS_MODE_COMPOSITE);
  transfer_2d_case_set(&even, &f, 5, 0.1);
  case_camera(*state, &even, 4, 1);
  picture_case uneven = even;
  stratus_transfer_2d slow = f.of;
  stretch(&uneven, 0, 1e-4);
  slow.unit_distance *= uneven.transfer.unit_distance / even.transfer.unit_distance;
  uneven.options.optics.transfer_2d = &slow;
  expect_alike(*state, &even, &uneven, "two variables");
  free(f.pairs);
  case_destroy(&even);
}

/* The picture is one on every instruction set, with every structure. */
static void no_structure_or_instruction_set_changes_a_bit(void** state)
{
  const stratus_context* host = *state;
  stratus_context* other = case_context("host", 3);
  picture_case c;
  case_create(*state, &c, STRATUS_UINT16, 30, 26, 40, 9);
  set_mode(&c, STRATUS_MODE_COMPOSITE);
  c.options.sampling.tolerance = 0.01;
  case_camera(*state, &c, 5, 0);
  stretch(&c, 1, 1e-3);
  c.transfer.unit_distance = 1e-2;
  for (stratus_sampling rule = STRATUS_SAMPLING_MIDPOINT; rule <= STRATUS_SAMPLING_CELLS; ++rule) {
    c.options.sampling.rule = rule;
    c.options.skipping.structure = STRATUS_STRUCTURE_NONE;
    case_render(*state, &c, &cubes);
    assert_true(case_lit(&cubes) > case_share(100));
    for (int isa = 0; isa <= host->isa; ++isa) {
      for (int structure = STRATUS_STRUCTURE_NONE; structure <= STRATUS_STRUCTURE_HYBRID; ++structure) {
        c.options.skipping.structure = (stratus_structure)structure;
        other->isa = isa;
        case_render(other, &c, &thin);
        assert_memory_equal(thin.rgba, cubes.rgba, sizeof thin.rgba);
        assert_memory_equal(thin.depth, cubes.depth, sizeof thin.depth);
      }
    }
  }
  stratus_context_destroy(other);
  case_destroy(&c);
}

static void a_step_by_hand_is_one_for_all(void** state)
{
  picture_case c;
  case_create(*state, &c, STRATUS_FLOAT32, 30, 26, 20, 5);
  stretch(&c, 2, 1e-3);
  case_render(*state, &c, &thin);
  assert_false(thin.report.follows_voxels);
  assert_true(thin.report.sample_distance >= 0.25 && thin.report.sample_distance <= 0.25);
  c.options.sampling.distance = 0.0;
  case_render(*state, &c, &thin);
  assert_true(thin.report.follows_voxels);
  case_destroy(&c);
}

int test_ray_thin_grid(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(every_mode_draws_thin_voxels),
    cmocka_unit_test(every_rule_draws_thin_voxels),
    cmocka_unit_test(rays_along_the_layers),
    cmocka_unit_test(lit_samples_follow_too),
    cmocka_unit_test(functions_of_two_variables_follow_too),
    cmocka_unit_test(no_structure_or_instruction_set_changes_a_bit),
    cmocka_unit_test(a_step_by_hand_is_one_for_all),
  };
  return cmocka_run_group_tests(tests, case_set_up, case_tear_down);
}
