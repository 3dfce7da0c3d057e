/* SPDX-License-Identifier: BSD-3-Clause
 * Same input, same picture: no structure, block size or number of threads changes a bit. The test compares pictures itself and by the
 * caster's own audit, which must agree. */
#include "picture_case.h"
#include "tile_case.h"

static picture first;
static picture second;

static void expect_same(const char* what, const picture* a, const picture* b)
{
  if (memcmp(a->rgba, b->rgba, sizeof a->rgba) || memcmp(a->depth, b->depth, sizeof a->depth)) {
    int differing = 0;
    for (int i = 0; i < CASE_PIXELS; ++i) {
      differing +=
        memcmp(a->rgba + 4 * i, b->rgba + 4 * i, 4 * sizeof(float)) != 0 || memcmp(a->depth + i, b->depth + i, sizeof(float)) != 0;
    }
    print_error("%s: %d of %d pixels differ\n", what, differing, CASE_PIXELS);
    fail();
  }
}

static void structures_change_no_bit(void** state)
{
  (void)state;
  stratus_context* context = case_context("host", 2);
  int lit = 0;
  uint64_t skipped = 0;
  for (uint32_t seed = 1; seed <= 120; seed += few_run() ? 3 : 1) {
    picture_case c;
    char what[128];
    case_create_random(context, seed, &c);
    c.options.skipping.structure = STRATUS_STRUCTURE_NONE;
    case_render(context, &c, &first);
    lit += case_lit(&first) > 0;
    assert_int_equal(first.report.skipped, 0);
    c.options.skipping.audit = 1;
    for (int structure = STRATUS_STRUCTURE_AUTO; structure <= STRATUS_STRUCTURE_HYBRID; ++structure) {
      c.options.skipping.structure = (stratus_structure)structure;
      c.options.skipping.block_size = 2 << (seed + (uint32_t)structure) % 5;
      case_render(context, &c, &second);
      snprintf(what, sizeof what, "seed %u, %s, blocks of %d, %s", seed, stratus_structure_name(c.options.skipping.structure),
        c.options.skipping.block_size, case_type_names[c.volume.type]);
      expect_same(what, &first, &second);
      assert_int_equal(second.report.differing_pixels, 0);
      skipped += second.report.skipped;
    }
    case_destroy(&c);
  }
  assert_true(lit > (few_run() ? 20 : 60)); /* else the pictures show too little */
  assert_true(skipped > 0);
  stratus_context_destroy(context);
}

/* Offers a tree with many leaves. Boxes of hierarchies overlap. */
static void offer_tree(
  stratus_context* context, stratus_ray_caster* caster, const picture_case* c, stratus_tree_method method, int emptiness)
{
  stratus_tree_options options = stratus_tree_options_default();
  options.method = method;
  options.field_emptiness = emptiness;
  options.leaf_bricks = 1 + emptiness % 3;
  options.leaf_voxels = 8;
  case_offer_tree(context, caster, c, &options);
}

static void trees_that_come_with_the_data_change_no_bit(void** state)
{
  (void)state;
  static const stratus_tree_method methods[] = { STRATUS_TREE_HYBRID, STRATUS_TREE_SAH, STRATUS_TREE_HYBRID_PAPER, STRATUS_TREE_LBVH };
  stratus_context* context = case_context("host", 2);
  int used = 0;
  for (uint32_t seed = 1; seed <= 80; seed += few_run() ? 3 : 1) {
    picture_case c;
    char what[128];
    stratus_ray_caster* caster = NULL;
    case_create_random(context, seed, &c);
    c.options.skipping.structure = STRATUS_STRUCTURE_NONE;
    case_render(context, &c, &first);
    assert_int_equal(stratus_ray_caster_create(context, &caster), STRATUS_OK);
    offer_tree(context, caster, &c, methods[seed % 4], 1 + (int)(seed % 5));
    c.options.skipping.structure = STRATUS_STRUCTURE_HYBRID;
    case_render_with(context, caster, &c, &second);
    snprintf(what, sizeof what, "seed %u, %s tree, %s", seed, stratus_tree_method_name(methods[seed % 4]), case_type_names[c.volume.type]);
    expect_same(what, &first, &second);
    assert_int_equal(second.report.structure_builds, !second.report.offered_tree && second.report.occupied_blocks > 0);
    used += second.report.offered_tree;
    case_destroy(&c);
    stratus_ray_caster_destroy(caster);
  }
  assert_true(used > (few_run() ? 13 : 40));
  stratus_context_destroy(context);
}

static void threads_change_no_bit(void** state)
{
  (void)state;
  stratus_context* contexts[3] = { case_context("host", 1), case_context("host", 2), case_context("host", 3) };
  for (uint32_t seed = 200; seed < 230; seed += few_run() ? 3 : 1) {
    picture_case c;
    char what[64];
    case_create_random(contexts[0], seed, &c);
    c.options.skipping.structure = STRATUS_STRUCTURE_DISTANCE; /* an automatic one follows from times, and counts follow from it */
    case_render(contexts[0], &c, &first);
    for (int t = 1; t < 3; ++t) {
      case_render(contexts[t], &c, &second);
      snprintf(what, sizeof what, "seed %u, %d threads", seed, t + 1);
      expect_same(what, &first, &second);
      assert_memory_equal(first.samples, second.samples, sizeof first.samples);
      assert_int_equal(first.report.samples, second.report.samples);
      assert_int_equal(first.report.skipped, second.report.skipped);
    }
    case_destroy(&c);
  }
  for (int t = 0; t < 3; ++t) {
    stratus_context_destroy(contexts[t]);
  }
}

/* A pixel's picture depends only on its ray. A window of the same rays therefore shows the same pixels in any packets and tiles, but for
 * the rounding of its camera. */
static void tiles_change_nothing_but_roundings(void** state)
{
  (void)state;
  stratus_context* context = case_context("host", 2);
  for (uint32_t seed = 300; seed < 320; ++seed) {
    picture_case c;
    case_create_random(context, seed, &c);
    case_render(context, &c, &first);
    /* The last 8 columns as a window of their own: its camera has their centre and half width in the plane of rays. */
    enum { COLUMNS = 8 };
    static float rgba[4 * COLUMNS * CASE_HEIGHT_MOST];
    const double share = (double)COLUMNS / CASE_WIDTH;
    stratus_camera whole = c.camera;
    for (int a = 0; a < 3; ++a) {
      const double shift = (1.0 - share) * whole.right[a];
      *(whole.parallel ? &c.camera.eye[a] : &c.camera.forward[a]) += shift;
      c.camera.right[a] = share * whole.right[a];
    }
    const stratus_image image = { .width = COLUMNS, .height = CASE_HEIGHT, .rgba = rgba };
    stratus_ray_caster* caster = NULL;
    assert_int_equal(stratus_ray_caster_create(context, &caster), STRATUS_OK);
    assert_int_equal(stratus_ray_caster_render(caster, &c.volume, &c.transfer, &c.camera, &c.options, &image, NULL), STRATUS_OK);
    stratus_ray_caster_destroy(caster);
    for (int y = 0; y < CASE_HEIGHT; ++y) {
      for (int x = 0; x < 4 * COLUMNS; ++x) {
        /* Not to the bit, because the camera itself was rounded again. */
        const float a = rgba[4 * COLUMNS * y + x], b = first.rgba[4 * (CASE_WIDTH * y + CASE_WIDTH - COLUMNS) + x];
        assert_true(fabsf(a - b) <= 2e-3f);
      }
    }
    case_destroy(&c);
  }
  stratus_context_destroy(context);
}

/* Rays read values from tiles as they do from memory in order, in each mode that draws the case. */
static void values_in_tiles_change_no_bit(void** state)
{
  (void)state;
  stratus_context* context = case_context("host", 2);
  int lit = 0, drawn[STRATUS_MODE_QUANTITIES + 1] = { 0 };
  for (uint32_t seed = 600; seed < 680; seed += few_run() ? 3 : 1) {
    const int64_t side[3] = { 1 + seed % 9, 1 + seed / 3 % 7, 1 + seed / 5 % 8 };
    picture_case c;
    case_create_random(context, seed, &c);
    for (int mode = STRATUS_MODE_COMPOSITE; mode <= STRATUS_MODE_SLICE; ++mode) {
      const stratus_image image = { .width = CASE_WIDTH, .height = CASE_HEIGHT, .rgba = first.rgba, .depth = first.depth };
      stratus_ray_caster* caster = NULL;
      c.options.mode = (stratus_mode)mode;
      c.options.optics.contours[0] = c.opacity[4];
      c.options.optics.contour_count = 1;
      c.options.slice = (stratus_slice){ .linear = { 1, -2, 0.5 }, .center = { 5, 5, 5 } };
      assert_int_equal(stratus_ray_caster_create(context, &caster), STRATUS_OK);
      const stratus_status status = stratus_ray_caster_render(caster, &c.volume, &c.transfer, &c.camera, &c.options, &image, NULL);
      stratus_ray_caster_destroy(caster);
      if (status == STRATUS_OK) {
        char what[96];
        tile_volume(&c.volume, side);
        case_render(context, &c, &second);
        free_tiles(&c.volume);
        snprintf(what, sizeof what, "seed %u, mode %d in tiles, %s", seed, mode, case_type_names[c.volume.type]);
        expect_same(what, &first, &second);
        lit += case_lit(&first) > 0;
        ++drawn[mode];
      }
    }
    case_destroy(&c);
  }
  assert_true(lit > (few_run() ? 50 : 150));
  for (int mode = STRATUS_MODE_COMPOSITE; mode <= STRATUS_MODE_SLICE; ++mode) {
    assert_true(drawn[mode] > 0);
  }
  stratus_context_destroy(context);
}

/* Each sampling rule has a table, and lit pictures have another. A table is used again when its rule returns, and only then. */
static void rules_that_take_turns_keep_their_tables(void** state)
{
  (void)state;
  static const stratus_sampling rules[] = { STRATUS_SAMPLING_MIDPOINT, STRATUS_SAMPLING_PREINTEGRATED };
  stratus_context* context = case_context("host", 2);
  for (uint32_t seed = 500; seed < 520; ++seed) {
    stratus_ray_caster* used = NULL;
    picture_case c;
    case_create_random(context, seed, &c);
    c.options.sampling.interpolation = STRATUS_INTERPOLATION_LINEAR;
    c.options.sampling.distance = 0.7;
    c.options.light.shade = seed % 2;
    assert_int_equal(stratus_ray_caster_create(context, &used), STRATUS_OK);
    for (int turn = 0; turn < 4; ++turn) {
      c.options.sampling.rule = rules[turn % 2];
      case_render(context, &c, &first);
      case_render_with(context, used, &c, &second);
      expect_same("a rule that returns", &first, &second);
      assert_int_equal(second.report.table_builds, turn == 0 ? 1 : 2);
    }
    case_destroy(&c);
    stratus_ray_caster_destroy(used);
  }
  stratus_context_destroy(context);
}

static void a_caster_that_was_used_before_draws_the_same(void** state)
{
  (void)state;
  stratus_context* context = case_context("host", 2);
  stratus_ray_caster* used = NULL;
  assert_int_equal(stratus_ray_caster_create(context, &used), STRATUS_OK);
  for (uint32_t seed = 400; seed < 440; seed += few_run() ? 3 : 1) {
    picture_case c;
    case_create_random(context, seed, &c);
    c.volume.revision = seed; /* memory may come back at the same address */
    case_render(context, &c, &first);
    case_render_with(context, used, &c, &second);
    expect_same("a used caster", &first, &second);
    const stratus_ray_cast_report before = second.report;
    case_camera(context, &c, 3, 0);
    case_render_with(context, used, &c, &second); /* a camera move builds nothing */
    assert_int_equal(second.report.range_builds, before.range_builds);
    assert_int_equal(second.report.table_builds, before.table_builds);
    assert_int_equal(second.report.occupancy_builds, before.occupancy_builds);
    case_render(context, &c, &first);
    expect_same("a used caster, moved", &first, &second);
    c.opacity[3] = 0.5; /* an edit of the transfer function keeps the ranges */
    c.opacity[5] = 0.25;
    case_render_with(context, used, &c, &second);
    assert_int_equal(second.report.range_builds, before.range_builds);
    assert_true(second.report.table_builds > before.table_builds);
    case_render(context, &c, &first);
    expect_same("a used caster, edited", &first, &second);
    case_destroy(&c);
  }
  stratus_ray_caster_destroy(used);
  stratus_context_destroy(context);
}

static void ranges_found_before_change_no_bit(void** state)
{
  (void)state;
  stratus_context* context = case_context("host", 2);
  for (uint32_t seed = 500; seed < 530; seed += few_run() ? 3 : 1) {
    picture_case c;
    stratus_ray_caster* early = NULL;
    case_create_random(context, seed, &c);
    case_render(context, &c, &first);
    assert_int_equal(stratus_ray_caster_create(context, &early), STRATUS_OK);
    assert_int_equal(stratus_ray_caster_find_ranges(early, &c.volume), STRATUS_OK);
    case_render_with(context, early, &c, &second);
    expect_same("ranges found before", &first, &second);
    assert_true(c.volume.components > 1 || c.volume.cell_centered || c.options.skipping.block_size != 0 || second.report.range_builds == 1);
    stratus_ray_caster_destroy(early);
    case_destroy(&c);
  }
  stratus_context_destroy(context);
}

int test_ray_cast_same(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(structures_change_no_bit),
    cmocka_unit_test(trees_that_come_with_the_data_change_no_bit),
    cmocka_unit_test(threads_change_no_bit),
    cmocka_unit_test(tiles_change_nothing_but_roundings),
    cmocka_unit_test(values_in_tiles_change_no_bit),
    cmocka_unit_test(rules_that_take_turns_keep_their_tables),
    cmocka_unit_test(a_caster_that_was_used_before_draws_the_same),
    cmocka_unit_test(ranges_found_before_change_no_bit),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
