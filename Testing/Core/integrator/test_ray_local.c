/* SPDX-License-Identifier: BSD-3-Clause
 * Rule local: cells in rough blocks, samples in all others. It is chosen if few blocks are rough, keeps the tolerance, and needs fewer
 * samples than either of its two rules. No structure, block size or instruction set changes a bit of its picture. */
#include "picture_case.h"
#include "testing.h"

#include "volume.h"
#include "ray_cast_host.h"

#define SEEDS 24

static picture drawn;
static picture other;

static uint32_t seeds(void)
{
  return few_run() ? SEEDS / 3 : SEEDS;
}

static void it_keeps_the_tolerance(void** state)
{
  static float reference[4 * CASE_PIXELS_MOST];
  int judged = 0;
  for (uint32_t seed = 0; seed < seeds(); ++seed) {
    picture_case c;
    case_create_local(*state, seed, &c);
    if (c.options.clipping.crop && c.options.clipping.crop_regions != STRATUS_CROP_INSIDE) { /* the reference knows one region */
      case_destroy(&c);
      continue;
    }
    const reference_scene scene = case_scene(&c);
    assert_int_equal(reference_render(&scene, CASE_WIDTH, CASE_HEIGHT, 0.125, reference, NULL), 0);
    case_render(*state, &c, &drawn);
    double squares = 0.0, count = 0.0, largest = 0.0;
    reference_error(drawn.rgba, reference, CASE_PIXELS, &squares, &count, &largest);
    const double error = count > 0.0 ? sqrt(squares / count) : 0.0;
    print_message(
      "             %u, %s: error %.2g, at most %.2g; %s\n", seed, case_type_names[c.volume.type], error, largest, drawn.report.why);
    assert_int_equal(drawn.report.sampling, STRATUS_SAMPLING_LOCAL);
    assert_true(error <= c.options.sampling.tolerance);
    judged += case_lit(&drawn) > CASE_PIXELS / 20;
    case_destroy(&c);
  }
  assert_true(judged > (int)seeds() / 3);
}

static void it_takes_fewer_samples_than_cells(void** state)
{
  for (uint32_t seed = 0; seed < 4; ++seed) {
    picture_case c;
    case_create_local(*state, seed, &c);
    c.options.clipping.crop = 0;
    case_render(*state, &c, &drawn);
    assert_int_equal(drawn.report.sampling, STRATUS_SAMPLING_LOCAL);
    c.options.sampling.rule = STRATUS_SAMPLING_CELLS;
    case_render(*state, &c, &other);
    print_message("             %u: %llu samples and cells, %llu cells\n", seed, (unsigned long long)drawn.report.samples,
      (unsigned long long)other.report.samples);
    assert_true(2 * drawn.report.samples < other.report.samples);
    case_destroy(&c);
  }
}

static void expect_same(const char* what, uint32_t seed, int number)
{
  assert_int_equal(other.report.sampling, drawn.report.sampling);
  assert_true(other.report.sample_distance == drawn.report.sample_distance && other.report.cell_error == drawn.report.cell_error);
  if (memcmp(drawn.rgba, other.rgba, sizeof drawn.rgba) || memcmp(drawn.depth, other.depth, sizeof drawn.depth)) {
    fail_msg("seed %u: %s %d changes the picture", seed, what, number);
  }
}

static void nothing_but_the_tolerance_changes_it(void** state)
{
  stratus_context* context = *state;
  const int best = context->isa;
  int lit = 0;
  for (uint32_t seed = 0; seed < seeds(); ++seed) {
    picture_case c;
    case_create_local(context, seed, &c);
    c.options.skipping.structure = STRATUS_STRUCTURE_NONE;
    case_render(context, &c, &drawn);
    assert_int_equal(drawn.report.sampling, STRATUS_SAMPLING_LOCAL);
    lit += case_lit(&drawn) > 0;
    for (int structure = STRATUS_STRUCTURE_AUTO; structure <= STRATUS_STRUCTURE_HYBRID; ++structure) {
      c.options.skipping.structure = (stratus_structure)structure;
      case_render(context, &c, &other);
      expect_same("structure", seed, structure);
    }
    c.options.skipping.structure = STRATUS_STRUCTURE_DISTANCE;
    for (int size = 2; size <= 32; size *= 2) {
      c.options.skipping.block_size = size;
      case_render(context, &c, &other);
      expect_same("block size", seed, size);
    }
    for (context->isa = 0; context->isa < best; ++context->isa) {
      case_render(context, &c, &other);
      expect_same("instruction set", seed, context->isa);
    }
    case_destroy(&c);
  }
  assert_true(lit > (int)seeds() / 2);
}

/* The map of rough blocks is of one function and of one tolerance: after a change, a caster draws what a new one does. */
static void a_changed_function_has_a_map_of_its_own(void** state)
{
  stratus_ray_caster* caster = NULL;
  picture_case c;
  assert_int_equal(stratus_ray_caster_create(*state, &caster), STRATUS_OK);
  case_create_local(*state, 1, &c);
  const double opacity = c.opacity[5];
  for (int step = 0; step < 6; ++step) {
    c.opacity[5] = step == 1 ? 0.004 : step == 3 ? 0.9 : opacity; /* at first nothing is rough, then more is */
    c.options.sampling.tolerance = step == 4 ? 0.01 : 0.001;
    c.options.sampling.rule = step == 5 ? STRATUS_SAMPLING_MIDPOINT : STRATUS_SAMPLING_AUTO;
    case_render_with(*state, caster, &c, &drawn);
    case_render(*state, &c, &other);
    expect_same("step", 1, step);
    assert_true(step == 1 || step > 3 || drawn.report.sampling == STRATUS_SAMPLING_LOCAL);
  }
  c.options.sampling.rule = STRATUS_SAMPLING_AUTO;
  case_render_with(*state, caster, &c, &drawn); /* as measured before the picture of samples */
  case_render(*state, &c, &other);
  expect_same("after samples", 1, 0);
  stratus_ray_caster_destroy(caster);
  case_destroy(&c);
}

static void it_cannot_be_asked_for(void** state)
{
  picture_case c;
  stratus_ray_caster* caster = NULL;
  assert_int_equal(stratus_ray_caster_create(*state, &caster), STRATUS_OK);
  case_create_local(*state, 2, &c);
  c.options.sampling.rule = STRATUS_SAMPLING_LOCAL;
  const stratus_image image = { .width = CASE_WIDTH, .height = CASE_HEIGHT, .rgba = drawn.rgba };
  assert_int_equal(
    stratus_ray_caster_render(caster, &c.volume, &c.transfer, &c.camera, &c.options, &image, NULL), STRATUS_INVALID_ARGUMENT);
  assert_non_null(strstr(stratus_context_message(*state), "sampling 4 (0..3)"));
  stratus_ray_caster_destroy(caster);
  case_destroy(&c);
}

int test_ray_local(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(it_keeps_the_tolerance),
    cmocka_unit_test(it_takes_fewer_samples_than_cells),
    cmocka_unit_test(nothing_but_the_tolerance_changes_it),
    cmocka_unit_test(a_changed_function_has_a_map_of_its_own),
    cmocka_unit_test(it_cannot_be_asked_for),
  };
  return cmocka_run_group_tests(tests, case_set_up, case_tear_down);
}
