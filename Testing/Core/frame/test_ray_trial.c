/* SPDX-License-Identifier: BSD-3-Clause
 * The automatic structure follows from the costs of frames and builds. The tests give these costs, so that no timing decides a test. Other
 * tests compare the pictures. */
#include "picture_case.h"
#include "ray_caster.h"

static picture first;
static picture second;

/* A case some of whose blocks are occupied, so that there is something to skip. `first` is its picture. */
static void make_case(stratus_context* context, picture_case* c)
{
  for (uint32_t seed = 1;; ++seed) {
    case_create_random(context, seed, c);
    c->options.mode = STRATUS_MODE_COMPOSITE;
    c->options.skipping.block_size = 2;
    c->options.skipping.structure = STRATUS_STRUCTURE_NONE;
    case_render(context, c, &first);
    c->options.skipping.structure = STRATUS_STRUCTURE_DISTANCE;
    case_render(context, c, &second);
    if (second.report.skipped > 0 && second.report.samples > 0 && second.report.occupied_blocks < second.report.blocks &&
      case_lit(&first) > case_share(20)) {
      break;
    }
    case_destroy(c);
  }
  c->options.skipping.structure = STRATUS_STRUCTURE_AUTO;
  c->options.skipping.audit = 1;
}

/* Draws without counts of pixels' samples, which no structure that follows from times gives. */
static void draw(stratus_ray_caster* caster, const picture_case* c)
{
  const stratus_image image = {
    .width = CASE_WIDTH, .height = CASE_HEIGHT, .rgba = second.rgba, .depth = second.depth, .opaque_depth = c->opaque_depth
  };
  assert_int_equal(
    stratus_ray_caster_render(caster, &c->volume, &c->transfer, &c->camera, &c->options, &image, &second.report), STRATUS_OK);
}

/* Draws some frames with given costs and returns the structure of the last. */
static stratus_structure drawn_with(stratus_context* context, picture_case* c, const stratus_ray_costs* costs, int frames)
{
  stratus_ray_caster* caster = NULL;
  assert_int_equal(stratus_ray_caster_create(context, &caster), STRATUS_OK);
  caster->forced = costs;
  for (int frame = 0; frame < frames; ++frame) {
    draw(caster, c);
    assert_memory_equal(first.rgba, second.rgba, sizeof first.rgba);
    assert_int_equal(second.report.differing_pixels, 0);
    assert_memory_equal(
      second.report.why, stratus_structure_name(second.report.structure), strlen(stratus_structure_name(second.report.structure)));
  }
  stratus_ray_caster_destroy(caster);
  return second.report.structure;
}

static void the_cheaper_of_map_and_none_is_drawn(void** state)
{
  picture_case c;
  make_case(*state, &c);
  stratus_ray_costs costs = { .frame = { [STRATUS_STRUCTURE_NONE] = 2.0, [STRATUS_STRUCTURE_DISTANCE] = 3.0 },
    .build = { [STRATUS_STRUCTURE_OCTANT] = 1e9 } };
  assert_int_equal(drawn_with(*state, &c, &costs, 1), STRATUS_STRUCTURE_NONE);
  assert_int_equal(drawn_with(*state, &c, &costs, 3), STRATUS_STRUCTURE_NONE);
  assert_int_equal(second.report.skipped, 0);
  costs.frame[STRATUS_STRUCTURE_NONE] = 4.0;
  assert_int_equal(drawn_with(*state, &c, &costs, 1), STRATUS_STRUCTURE_DISTANCE);
  assert_true(second.report.skipped > 0);
  case_destroy(&c);
}

/* A table of running sums serves two rules and every step. A trial with one of them predicts nothing for another. */
static void another_sampling_is_tried_anew(void** state)
{
  static const struct {
    stratus_sampling sampling;
    double step, cell_error;
  } samplings[] = { { STRATUS_SAMPLING_PREINTEGRATED, 1.0, 0.0 }, { STRATUS_SAMPLING_PREINTEGRATED, 0.5, 0.0 },
    { STRATUS_SAMPLING_CELLS, 0.5, 0.1 }, { STRATUS_SAMPLING_CELLS, 0.5, 0.05 }, { STRATUS_SAMPLING_PREINTEGRATED, 0.5, 0.05 } };
  picture_case c;
  stratus_ray_caster* caster = NULL;
  stratus_ray_costs costs = { .frame = { [STRATUS_STRUCTURE_NONE] = 2.0, [STRATUS_STRUCTURE_DISTANCE] = 8.0 },
    .build = { [STRATUS_STRUCTURE_OCTANT] = 1e9 } };
  make_case(*state, &c);
  c.options.sampling.interpolation = STRATUS_INTERPOLATION_LINEAR;
  assert_int_equal(stratus_ray_caster_create(*state, &caster), STRATUS_OK);
  caster->forced = &costs;
  for (int i = 0; i < 5; ++i) {
    c.options.sampling.rule = samplings[i].sampling;
    c.options.sampling.distance = samplings[i].step;
    c.options.sampling.cell_error = samplings[i].cell_error;
    /* each sampling's times contradict the earlier sampling's result */
    costs.frame[STRATUS_STRUCTURE_NONE] = i % 2 ? 3.0 : 2.0;
    costs.frame[STRATUS_STRUCTURE_DISTANCE] = i % 2 ? 2.5 : 8.0;
    for (int frame = 0; frame < 3; ++frame) {
      draw(caster, &c);
      assert_int_equal(second.report.sampling, samplings[i].sampling);
      assert_int_equal(second.report.structure, i % 2 ? STRATUS_STRUCTURE_DISTANCE : STRATUS_STRUCTURE_NONE);
      assert_int_equal(second.report.differing_pixels, 0);
    }
  }
  assert_int_equal(second.report.table_builds, 1);
  stratus_ray_caster_destroy(caster);
  case_destroy(&c);
}

/* The second sampling's trial has to wait until frames have taken 50 times what the first's has wasted. */
static void another_sampling_s_result_serves_until_the_next_trial(void** state)
{
  static const stratus_structure expected[] = { STRATUS_STRUCTURE_NONE, STRATUS_STRUCTURE_NONE, STRATUS_STRUCTURE_NONE,
    STRATUS_STRUCTURE_NONE, STRATUS_STRUCTURE_DISTANCE };
  picture_case c;
  stratus_ray_caster* caster = NULL;
  stratus_ray_costs costs = { .frame = { [STRATUS_STRUCTURE_NONE] = 2.0, [STRATUS_STRUCTURE_DISTANCE] = 3.0 },
    .build = { [STRATUS_STRUCTURE_OCTANT] = 1e9 },
    .trial = 0.15 };
  make_case(*state, &c);
  c.options.sampling.rule = STRATUS_SAMPLING_MIDPOINT;
  assert_int_equal(stratus_ray_caster_create(*state, &caster), STRATUS_OK);
  caster->forced = &costs;
  for (int frame = 0; frame < 5; ++frame) {
    c.options.sampling.distance = frame > 0 ? 0.5 : 1.0;
    costs.frame[STRATUS_STRUCTURE_NONE] = frame > 0 ? 3.0 : 2.0;
    costs.frame[STRATUS_STRUCTURE_DISTANCE] = frame > 0 ? 2.0 : 3.0;
    draw(caster, &c);
    assert_int_equal(second.report.structure, expected[frame]);
    assert_int_equal(strstr(second.report.why, "with another sampling") != NULL, frame > 0 && frame < 4);
  }
  stratus_ray_caster_destroy(caster);
  case_destroy(&c);
}

/* Samplings that change with every frame want as many trials. Each trial finds other times, so that the report shows a new trial. */
static void all_trials_together_take_a_small_share(void** state)
{
  enum { FRAMES = 200 };
  picture_case c;
  stratus_ray_caster* caster = NULL;
  stratus_ray_costs costs = { .build = { [STRATUS_STRUCTURE_OCTANT] = 1e9 }, .trial = 0.1 };
  int trials = 0;
  make_case(*state, &c);
  c.options.sampling.rule = STRATUS_SAMPLING_MIDPOINT;
  c.options.skipping.audit = 0;
  assert_int_equal(stratus_ray_caster_create(*state, &caster), STRATUS_OK);
  caster->forced = &costs;
  for (int frame = 0; frame < FRAMES; ++frame) {
    c.options.sampling.distance = frame % 2 ? 2.0 : 1.0;
    costs.frame[STRATUS_STRUCTURE_NONE] = 1.0 + 1e-4 * frame;
    costs.frame[STRATUS_STRUCTURE_DISTANCE] = 1.0;
    draw(caster, &c);
    trials += strstr(second.report.why, "with another sampling") == NULL;
  }
  assert_in_range(trials, FRAMES / 10, FRAMES / 5 + 1); /* a trial of .1 is a fiftieth of five frames */
  stratus_ray_caster_destroy(caster);
  case_destroy(&c);
}

/* A trial's tiles are part of the picture: with either structure, all pixels are counted once. */
static void a_trial_s_tiles_are_drawn_once(void** state)
{
  picture_case c;
  make_case(*state, &c);
  const stratus_ray_costs costs = { .frame = { [STRATUS_STRUCTURE_NONE] = 4.0, [STRATUS_STRUCTURE_DISTANCE] = 3.0 },
    .build = { [STRATUS_STRUCTURE_OCTANT] = 1e9 } };
  c.options.skipping.structure = STRATUS_STRUCTURE_DISTANCE;
  case_render(*state, &c, &first);
  c.options.skipping.structure = STRATUS_STRUCTURE_AUTO;
  assert_int_equal(drawn_with(*state, &c, &costs, 1), STRATUS_STRUCTURE_DISTANCE);
  assert_int_equal(second.report.samples, first.report.samples);
  assert_int_equal(second.report.skipped, first.report.skipped);
  assert_int_equal(second.report.lookups, first.report.lookups);
  assert_int_equal(second.report.rays, first.report.rays);
  case_destroy(&c);
}

static void a_picture_of_samples_follows_from_no_times(void** state)
{
  picture_case c;
  stratus_ray_caster* caster = NULL;
  const stratus_ray_costs costs = { .frame = { [STRATUS_STRUCTURE_NONE] = 1.0, [STRATUS_STRUCTURE_DISTANCE] = 3.0 },
    .build = { [STRATUS_STRUCTURE_OCTANT] = 1e9 } };
  make_case(*state, &c);
  c.options.skipping.structure = STRATUS_STRUCTURE_DISTANCE;
  case_render(*state, &c, &first);
  c.options.skipping.structure = STRATUS_STRUCTURE_AUTO;
  assert_int_equal(stratus_ray_caster_create(*state, &caster), STRATUS_OK);
  caster->forced = &costs;
  draw(caster, &c);
  assert_int_equal(second.report.structure, STRATUS_STRUCTURE_NONE);
  case_render_with(*state, caster, &c, &second);
  assert_int_equal(second.report.structure, STRATUS_STRUCTURE_DISTANCE);
  assert_memory_equal(first.samples, second.samples, sizeof first.samples);
  assert_memory_equal(first.rgba, second.rgba, sizeof first.rgba);
  stratus_ray_caster_destroy(caster);
  case_destroy(&c);
}

/* Builds of other maps may take a twentieth of the time that frames have taken. */
static void octant_maps_are_built_when_frames_have_cost_much_more(void** state)
{
  picture_case c;
  make_case(*state, &c);
  stratus_ray_costs costs = { .frame = {
                                [STRATUS_STRUCTURE_NONE] = 2.0, [STRATUS_STRUCTURE_DISTANCE] = 1.0, [STRATUS_STRUCTURE_OCTANT] = 0.5 } };
  costs.build[STRATUS_STRUCTURE_OCTANT] = 1e9;
  assert_int_equal(drawn_with(*state, &c, &costs, 9), STRATUS_STRUCTURE_DISTANCE);
  assert_int_equal(second.report.structure_builds, 1);
  costs.build[STRATUS_STRUCTURE_OCTANT] = 0.29;
  assert_int_equal(drawn_with(*state, &c, &costs, 6), STRATUS_STRUCTURE_DISTANCE);
  assert_int_equal(second.report.structure_builds, 1);
  assert_int_equal(drawn_with(*state, &c, &costs, 7), STRATUS_STRUCTURE_OCTANT);
  assert_int_equal(second.report.structure_builds, 2);
  costs.frame[STRATUS_STRUCTURE_OCTANT] = 1.05; /* they cost no more than noise: they skip farther */
  assert_int_equal(drawn_with(*state, &c, &costs, 9), STRATUS_STRUCTURE_OCTANT);
  costs.frame[STRATUS_STRUCTURE_OCTANT] = 1.5; /* they are built and lose: the distance map stays, and they are not built again */
  assert_int_equal(drawn_with(*state, &c, &costs, 9), STRATUS_STRUCTURE_DISTANCE);
  assert_int_equal(second.report.structure_builds, 2);
  case_destroy(&c);
}

static void a_tree_that_came_with_the_data_is_drawn_only_where_it_is_cheaper(void** state)
{
  picture_case c;
  int trees = 0;
  for (uint32_t seed = 1; seed <= 40; ++seed) {
    case_create_random(*state, seed, &c);
    c.options.mode = STRATUS_MODE_COMPOSITE;
    c.options.skipping.structure = STRATUS_STRUCTURE_NONE;
    case_render(*state, &c, &first);
    c.options.skipping.structure = STRATUS_STRUCTURE_AUTO;
    for (int cheap = 0; cheap < 2; ++cheap) {
      stratus_ray_caster* caster = NULL;
      const double tree = cheap ? 0.5 : 2.0;
      const stratus_ray_costs costs = { .frame = { [STRATUS_STRUCTURE_NONE] = 4.0,
                                          [STRATUS_STRUCTURE_DISTANCE] = 1.0,
                                          [STRATUS_STRUCTURE_OCTANT] = 3.0,
                                          [STRATUS_STRUCTURE_HYBRID] = tree } };
      assert_int_equal(stratus_ray_caster_create(*state, &caster), STRATUS_OK);
      caster->forced = &costs;
      case_offer_tree(*state, caster, &c, NULL);
      for (int frame = 0; frame < 4; ++frame) { /* builds cost nothing: each frame tries a map */
        draw(caster, &c);
        assert_memory_equal(first.rgba, second.rgba, sizeof first.rgba);
      }
      assert_int_equal(second.report.offered_tree, second.report.structure == STRATUS_STRUCTURE_HYBRID);
      assert_true(cheap || !second.report.offered_tree);
      trees += second.report.offered_tree;
      stratus_ray_caster_destroy(caster);
    }
    case_destroy(&c);
  }
  assert_true(trees > 5);
}

int test_ray_trial(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(the_cheaper_of_map_and_none_is_drawn),
    cmocka_unit_test(another_sampling_is_tried_anew),
    cmocka_unit_test(another_sampling_s_result_serves_until_the_next_trial),
    cmocka_unit_test(all_trials_together_take_a_small_share),
    cmocka_unit_test(a_trial_s_tiles_are_drawn_once),
    cmocka_unit_test(a_picture_of_samples_follows_from_no_times),
    cmocka_unit_test(octant_maps_are_built_when_frames_have_cost_much_more),
    cmocka_unit_test(a_tree_that_came_with_the_data_is_drawn_only_where_it_is_cheaper),
  };
  return cmocka_run_group_tests(tests, case_set_up, case_tear_down);
}
