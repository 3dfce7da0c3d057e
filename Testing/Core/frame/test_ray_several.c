/* SPDX-License-Identifier: BSD-3-Clause
 * Several volumes in one picture: against the double reference, against what must be the same by definition, and to the bit where nothing
 * may change a bit. */
#include "grid_case.h"
#include "several_case.h"

#include "ray_caster.h"
#include "volume.h"
#include "testing.h"

/* dB against the reference in steps of a fifth of a unit, where voxels are .5 to 2.5 units: only the sampling's own error. Measured: 90
 * to 98. */
#define SEVERAL_DB 70.0

static picture drawn, other, third;

static void expect_same(const picture* a, const picture* b)
{
  assert_memory_equal(a->rgba, b->rgba, sizeof a->rgba);
  assert_memory_equal(a->depth, b->depth, sizeof a->depth);
}

static float largest_difference(const picture* a, const picture* b)
{
  float largest = 0.0f;
  for (int i = 0; i < 4 * CASE_PIXELS; ++i) {
    largest = fmaxf(largest, fabsf(a->rgba[i] - b->rgba[i]));
  }
  return largest;
}

static void two_random_volumes_mix_as_the_reference_does(void** state)
{
  for (uint32_t seed = 0; seed < 12; seed += few_run() ? 4 : 1) {
    several_case m;
    char what[32];
    several_create(*state, &m, 2, seed);
    snprintf(what, sizeof what, "two, seed %u", seed);
    assert_true(several_psnr(what, *state, &m, &drawn) >= SEVERAL_DB);
    assert_true(case_lit(&drawn) > CASE_PIXELS / 20);
    several_destroy(&m);
  }
}

static void eight_random_volumes_mix_as_the_reference_does(void** state)
{
  for (uint32_t seed = 0; seed < (few_run() ? 1 : 3); ++seed) {
    several_case m;
    several_create(*state, &m, 8, 40 + seed);
    assert_true(several_psnr("eight", *state, &m, &drawn) >= SEVERAL_DB);
    assert_true(case_lit(&drawn) > CASE_PIXELS / 20);
    several_destroy(&m);
  }
}

/* Half the optical depth of opacity o has opacity 1 - sqrt(1 - o), which is no line between the points: so both functions are constant
 * over what they show. */
/* The first two are stretched 20:1, one of them lit, the third is not; structures change no bit. */
static void stretched_grids_mix_as_the_reference_does(void** state)
{
  for (uint32_t seed = 30; seed < 34; seed += few_run() ? 3 : 1) {
    several_case m;
    grid_case grids[2];
    char what[32];
    several_create(*state, &m, 3, seed);
    for (int n = 0; n < 2; ++n) {
      uint32_t random = seed;
      grid_case_set(&m.of[n], &grids[n], n ? GRID_RANDOM : GRID_GEOMETRIC, 7 - (int)(seed % 4), 0.0, 1.0, 20.0, &random);
      m.of[n].options.sampling.distance = 0.05;
    }
    m.of[0].options.light.shade = (int)(seed % 2);
    snprintf(what, sizeof what, "stretched, seed %u", seed);
    assert_true(several_psnr(what, *state, &m, &drawn) >= SEVERAL_DB);
    assert_true(case_lit(&drawn) > CASE_PIXELS / 20);
    for (int structure = STRATUS_STRUCTURE_NONE; structure <= STRATUS_STRUCTURE_HYBRID; ++structure) {
      for (int n = 0; n < m.count; ++n) {
        m.of[n].options.skipping.structure = (stratus_structure)structure;
      }
      several_draw(*state, &m, &other);
      expect_same(&drawn, &other);
    }
    several_destroy(&m);
  }
}

static void halves_of_a_volume_draw_the_whole(void** state)
{
  for (int sampling = STRATUS_SAMPLING_MIDPOINT; sampling <= STRATUS_SAMPLING_PREINTEGRATED; ++sampling) {
    several_case m = { .count = 2 };
    for (int n = 0; n < 2; ++n) {
      case_create(*state, &m.of[n], STRATUS_FLOAT32, 25, 28, 30, 12);
      const double opacity[8] = { -22, 0, -19.95, 0, -19.95, 1.0 - sqrt(1.0 - 0.3), -17, 1.0 - sqrt(1.0 - 0.3) };
      memcpy(m.of[n].opacity, opacity, sizeof opacity);
      m.of[n].options.sampling.rule = (stratus_sampling)sampling;
    }
    several_draw(*state, &m, &drawn);
    const double whole[8] = { -22, 0, -19.95, 0, -19.95, 0.3, -17, 0.3 };
    memcpy(m.of[0].opacity, whole, sizeof whole);
    case_render(*state, &m.of[0], &other);
    assert_true(case_lit(&drawn) > CASE_PIXELS / 20);
    print_message(
      "             halves, %s: %g\n", stratus_sampling_name((stratus_sampling)sampling), (double)largest_difference(&drawn, &other));
    assert_true(largest_difference(&drawn, &other) < 2e-6f);
    several_destroy(&m);
  }
}

static void one_volume_alone_is_the_ordinary_picture(void** state)
{
  several_case m = { .count = 1 };
  case_create(*state, &m.of[0], STRATUS_UINT8, 25, 28, 30, 5);
  several_draw(*state, &m, &drawn);
  case_render(*state, &m.of[0], &other);
  expect_same(&drawn, &other);
  several_destroy(&m);
}

/* An empty volume adds no bit, wherever it is in the order; the picture of the other differs from the ordinary one by rounding only. */
static void an_empty_volume_changes_nothing(void** state)
{
  for (int sampling = STRATUS_SAMPLING_MIDPOINT; sampling <= STRATUS_SAMPLING_PREINTEGRATED; ++sampling) {
    several_case m = { .count = 2 };
    case_create(*state, &m.of[0], STRATUS_UINT8, 25, 28, 30, 5);
    case_create(*state, &m.of[1], STRATUS_FLOAT32, 17, 20, 23, 6);
    m.of[0].options.sampling.rule = (stratus_sampling)sampling;
    memset(m.of[1].opacity, 0, sizeof m.of[1].opacity);
    m.of[1].transfer.opacity_count = 1;
    several_draw(*state, &m, &drawn);
    case_render(*state, &m.of[0], &other);
    print_message("             with an empty one: %g\n", (double)largest_difference(&drawn, &other));
    assert_true(largest_difference(&drawn, &other) < 2e-6f);
    m.of[0].options.skipping.structure = STRATUS_STRUCTURE_NONE;
    m.of[1].options.skipping.structure = STRATUS_STRUCTURE_NONE;
    several_draw(*state, &m, &other);
    expect_same(&drawn, &other);
    m.of[0].transfer.opacity_count = 1;
    several_draw(*state, &m, &drawn);
    assert_int_equal(case_lit(&drawn), 0);
    assert_true(isinf(drawn.depth[CASE_PIXELS / 2]));
    several_destroy(&m);
  }
}

static void boxes_apart_lie_over_each_other(void** state)
{
  for (int view = 0; view < 3; ++view) {
    several_case m = { .count = 2 };
    for (int n = 0; n < 2; ++n) {
      case_create(*state, &m.of[n], n ? STRATUS_INT16 : STRATUS_FLOAT32, 25 + 4 * n, 28, 30, 12u + (uint32_t)n);
      several_color(&m.of[n], n);
      m.of[n].options.sampling.rule = n ? STRATUS_SAMPLING_MIDPOINT : STRATUS_SAMPLING_PREINTEGRATED;
    }
    m.of[1].volume.origin[2] = view == 2 ? 3000.0 : 31.0; /* far apart or close */
    const double eye[3] = { 15, 12, view == 1 ? 120 : -70 }, focal[3] = { 14, 14, 20 }, up[3] = { 0, 1, 0.1 };
    assert_int_equal(stratus_camera_perspective(*state, eye, focal, up, 40.0, 1.2, &m.of[0].camera), STRATUS_OK);
    m.of[1].camera = m.of[0].camera;
    several_draw(*state, &m, &drawn);
    case_render(*state, &m.of[view == 1], &other);
    case_render(*state, &m.of[view != 1], &third);
    int behind = 0;
    for (int i = 0; i < CASE_PIXELS; ++i) {
      const float left = 1.0f - other.rgba[4 * i + 3];
      for (int c = 0; c < 4; ++c) {
        other.rgba[4 * i + c] += left * third.rgba[4 * i + c];
      }
      behind += left < 1.0f && third.rgba[4 * i + 3] > 0.0f;
      other.depth[i] = fminf(other.depth[i], third.depth[i]);
      assert_true(drawn.depth[i] == other.depth[i] || fabsf(drawn.depth[i] - other.depth[i]) < 1e-3f);
    }
    assert_true(view == 2 || behind > case_share(100));
    print_message("             over each other: %g\n", (double)largest_difference(&drawn, &other));
    assert_true(largest_difference(&drawn, &other) < 2e-6f);
    several_destroy(&m);
  }
}

/* Opaque geometry, near and far planes, crop boxes, clip planes, cameras within. */
static void what_bounds_a_ray_bounds_it_in_each_volume(void** state)
{
  static float opaque[CASE_PIXELS_MOST];
  several_case m;
  several_create(*state, &m, 3, 81);
  for (int i = 0; i < CASE_PIXELS; ++i) {
    opaque[i] = i % 7 == 0 ? 1.0f : (float)(i % CASE_WIDTH) / CASE_WIDTH;
  }
  const double eye[3] = { 30, 40, 35 }, focal[3] = { 0, 0, 0 }, up[3] = { 0, 1, 0 };
  assert_int_equal(stratus_camera_parallel(*state, eye, focal, up, 18.0, 1.2, &m.of[0].camera), STRATUS_OK);
  m.of[0].camera.near_k = 45.0;
  m.of[0].camera.far_k = 75.0;
  m.of[0].opaque_depth = opaque;
  assert_true(several_psnr("opaque, near and far", *state, &m, &drawn) >= SEVERAL_DB);
  m.of[0].opaque_depth = NULL;
  m.of[0].options.clipping.crop = 1;
  for (int a = 0; a < 3; ++a) {
    m.of[0].options.clipping.crop_bounds[2 * a] = 4.0;
    m.of[0].options.clipping.crop_bounds[2 * a + 1] = 12.0;
  }
  m.of[2].options.clipping.clip_plane_count = 1;
  const double plane[4] = { 0.3, 0.5, -0.2, 1.0 };
  memcpy(m.of[2].options.clipping.clip_planes[0], plane, sizeof plane);
  assert_true(several_psnr("crop and clip planes", *state, &m, &drawn) >= SEVERAL_DB);
  const double inside[3] = { 1.3, 0.7, 1.1 };
  assert_int_equal(stratus_camera_perspective(*state, inside, eye, up, 80.0, 1.2, &m.of[0].camera), STRATUS_OK);
  assert_true(several_psnr("camera inside", *state, &m, &drawn) >= SEVERAL_DB);
  several_destroy(&m);
}

static void light_and_gradient_opacity_are_each_volumes_own(void** state)
{
  const double gradient[4] = { 0.0, 0.2, 1e9, 1.0 };
  several_case m;
  several_create(*state, &m, 3, 83);
  m.of[0].options.light.shade = 1;
  m.of[0].options.light.shading.specular = 0.3;
  m.of[1].transfer.gradient = gradient;
  m.of[1].transfer.gradient_count = 2;
  double steep[4] = { 0.0, 0.1, 0.05 * case_type_values[m.of[1].volume.type].scale, 1.0 };
  m.of[1].transfer.gradient = steep;
  assert_true(several_psnr("lit, thinned and plain", *state, &m, &drawn) >= SEVERAL_DB);
  several_destroy(&m);
}

/* One volume has steps of the lattice, another every so many. */
static void longer_steps_are_whole_numbers_of_the_lattices(void** state)
{
  several_case m;
  several_create(*state, &m, 2, 85);
  stratus_ray_cast_report reports[STRATUS_SEVERAL_MAX];
  several_casters casters;
  several_casters_create(*state, &casters);
  for (int sampling = STRATUS_SAMPLING_MIDPOINT; sampling <= STRATUS_SAMPLING_PREINTEGRATED; ++sampling) {
    m.of[0].options.sampling.rule = m.of[1].options.sampling.rule = (stratus_sampling)sampling;
    m.of[0].options.sampling.distance = 0.1;
    m.of[1].options.sampling.distance = 0.39;
    assert_true(several_psnr("strides", *state, &m, &drawn) >= SEVERAL_DB);
    assert_int_equal(several_draw_with(&casters, &m, &other, reports), STRATUS_OK);
    expect_same(&drawn, &other);
    assert_true(fabs(reports[0].sample_distance - 0.1) < 1e-12 && fabs(reports[1].sample_distance - 0.3) < 1e-12);
  }
  several_casters_destroy(&casters);
  several_destroy(&m);
}

/* Where both media are deep, a segment's colours change along it, and it is cut into pieces. */
static void deep_media_are_cut_into_pieces(void** state)
{
  several_case m;
  several_create(*state, &m, 2, 87);
  for (int n = 0; n < 2; ++n) {
    m.of[n].options.sampling.rule = STRATUS_SAMPLING_PREINTEGRATED;
    m.of[n].options.sampling.distance = 0.3;
    m.of[n].transfer.unit_distance = 0.1;
  }
  assert_true(several_psnr("deep", *state, &m, &drawn) >= 65.0); /* measured: 74 */
  several_destroy(&m);
}

/* Opacity 1 over an interval stops rays, whichever volume has it. */
static void a_wall_in_one_volume_hides_what_is_behind(void** state)
{
  for (int n = 0; n < 2; ++n) {
    several_case m;
    several_create(*state, &m, 2, 91);
    picture_case* c = &m.of[n];
    const double base = case_type_values[c->volume.type].base, scale = case_type_values[c->volume.type].scale;
    const double opacity[8] = { base - scale, 0, base + 0.2 * scale, 0.1, base + 0.2 * scale, 1.0, base + scale, 1.0 };
    memcpy(c->opacity, opacity, sizeof opacity);
    m.of[0].options.sampling.rule = m.of[1].options.sampling.rule = STRATUS_SAMPLING_PREINTEGRATED;
    m.of[0].options.sampling.distance = m.of[1].options.sampling.distance = 0.02;
    assert_true(several_psnr("wall", *state, &m, &drawn) >= 42.0); /* the silhouette of a wall jumps from pixel to pixel */
    int opaque = 0;
    for (int i = 0; i < CASE_PIXELS; ++i) {
      opaque += drawn.rgba[4 * i + 3] == 1.0f;
    }
    assert_true(opaque > case_share(50));
    several_destroy(&m);
  }
}

/* Skipping changes no bit, nor does the number of threads, the order of tiles, or a caster that is used again. */
static void no_structure_changes_a_bit(void** state)
{
  stratus_context* threads[2] = { case_context("host", 1), case_context("host", 5) };
  int lit = 0;
  uint64_t skipped = 0;
  const uint32_t seeds = few_run() ? 10 : 40;
  for (uint32_t seed = 0; seed < seeds; ++seed) {
    several_case m = { .count = 2 + (int)(seed % 3) };
    for (int n = 0; n < m.count; ++n) {
      case_create_random(*state, 9000 + 7 * seed + (uint32_t)n, &m.of[n]);
      m.of[n].options.skipping.structure = (stratus_structure)(STRATUS_STRUCTURE_AUTO + (seed + (uint32_t)n) % 6);
      several_place(&m.of[n], 5 * seed + (uint32_t)n);
      if (m.of[n].volume.dimensions[0] == 1 || m.of[n].volume.dimensions[1] == 1) {
        m.of[n].volume.matrix[0] = m.of[n].volume.matrix[5] = m.of[n].volume.matrix[10] = 1.0;
      }
    }
    m.of[0].options.skipping.audit = 1;
    m.of[0].options.sampling.jitter = seed % 4 == 0;
    const double eye[3] = { 40.0 - 3.0 * seed, 30, -20.0 + seed }, focal[3] = { 1, 2, 0 }, up[3] = { 0, 0, 1 };
    assert_int_equal(stratus_camera_perspective(*state, eye, focal, up, 40.0, 1.2, &m.of[0].camera), STRATUS_OK);
    several_draw(*state, &m, &drawn);
    skipped += drawn.report.skipped;
    if (drawn.report.differing_pixels) {
      print_error("seed %u: %llu pixels differ\n", seed, (unsigned long long)drawn.report.differing_pixels);
    }
    assert_int_equal(drawn.report.differing_pixels, 0);
    lit += case_lit(&drawn) > 0;
    for (int t = 0; t < 2; ++t) {
      several_draw(threads[t], &m, &other);
      expect_same(&drawn, &other);
    }
    several_destroy(&m);
  }
  assert_true(lit > (int)seeds / 2);
  assert_true(skipped > 25 * seeds);
  stratus_context_destroy(threads[0]);
  stratus_context_destroy(threads[1]);
}

/* Automatic sampling keeps the tolerance of the whole picture. */
static void automatic_sampling_keeps_the_tolerance(void** state)
{
  for (uint32_t seed = 0; seed < 6; seed += few_run() ? 2 : 1) {
    several_case m;
    several_create(*state, &m, 2 + (int)(seed % 3), 200 + seed);
    for (int n = 0; n < m.count; ++n) {
      m.of[n].options = stratus_ray_cast_options_default();
    }
    assert_true(several_psnr("automatic", *state, &m, &drawn) >= 60.0);
    several_destroy(&m);
  }
}

/* A picture of several leaves casters ready for ordinary ones, and the other way round; nothing is built twice. */
static void casters_serve_both_kinds_of_pictures(void** state)
{
  several_case m;
  several_casters casters;
  stratus_ray_cast_report reports[STRATUS_SEVERAL_MAX];
  several_create(*state, &m, 2, 300);
  several_casters_create(*state, &casters);
  case_render_with(*state, casters.of[0], &m.of[0], &drawn);
  assert_int_equal(several_draw_with(&casters, &m, &other, reports), STRATUS_OK);
  case_render_with(*state, casters.of[0], &m.of[0], &third);
  expect_same(&drawn, &third);
  const uint64_t tables = third.report.table_builds, ranges = third.report.range_builds;
  assert_int_equal(several_draw_with(&casters, &m, &drawn, reports), STRATUS_OK);
  expect_same(&drawn, &other);
  assert_int_equal(reports[0].table_builds, tables);
  assert_int_equal(reports[0].range_builds, ranges);
  several_casters_destroy(&casters);
  several_destroy(&m);
}

static void what_does_not_mix_is_refused(void** state)
{
  several_case m;
  several_casters casters;
  several_create(*state, &m, 2, 301);
  several_casters_create(*state, &casters);
  const stratus_ray_cast_options good = m.of[1].options;
#define REFUSED(status, words)                                                                                                             \
  assert_int_equal(several_draw_with(&casters, &m, &drawn, NULL), status);                                                                 \
  assert_non_null(strstr(stratus_context_message(*state), words));                                                                         \
  m.of[1].options = good
  m.of[1].options.mode = STRATUS_MODE_MAXIMUM;
  REFUSED(STRATUS_UNSUPPORTED, "volume 1 of several has mode maximum");
  m.of[1].options.sampling.rule = STRATUS_SAMPLING_CELLS;
  m.of[1].options.mask.bytes = (const uint8_t*)"";
  REFUSED(STRATUS_UNSUPPORTED, "by cells of a volume with a mask");
  m.of[1].options.clipping.crop = 1;
  m.of[1].options.clipping.crop_regions = STRATUS_CROP_ALL + 1;
  REFUSED(STRATUS_INVALID_ARGUMENT, "crop regions");
  m.of[1].options.sampling.tolerance = -1.0;
  REFUSED(STRATUS_INVALID_ARGUMENT, "tolerance");
  m.of[1].options.mask.label_count = 3;
  REFUSED(STRATUS_INVALID_ARGUMENT, "3 labels without a mask");
  const stratus_transfer_2d empty = { .columns = 0, .rows = 1, .rgba = NULL };
  m.of[1].options.optics.transfer_2d = &empty;
  REFUSED(STRATUS_INVALID_ARGUMENT, "0 x 1 entries");
  m.of[1].volume.spacing[0] = 0.0;
  REFUSED(STRATUS_INVALID_ARGUMENT, "spacing");
  m.of[1].volume.spacing[0] = 1.0;
  m.of[1].volume.origin[0] = 1e9;
  m.of[1].options.sampling.distance = 0.1;
  REFUSED(STRATUS_INVALID_ARGUMENT, "wide");
  m.of[1].volume.origin[0] = 0.0;
  const stratus_ray_caster* kept = casters.of[1];
  casters.of[1] = casters.of[0];
  REFUSED(STRATUS_INVALID_ARGUMENT, "same ray caster");
  casters.of[1] = NULL;
  REFUSED(STRATUS_INVALID_ARGUMENT, "caster is NULL");
  casters.of[1] = (stratus_ray_caster*)(uintptr_t)kept;
  m.count = 9;
  const stratus_ray_cast_input inputs[1] = { { .caster = casters.of[0], .volume = &m.of[0].volume, .transfer = &m.of[0].transfer } };
  assert_int_equal(stratus_ray_caster_render_several(inputs, 9, &m.of[0].camera, NULL, NULL), STRATUS_INVALID_ARGUMENT);
  assert_int_equal(stratus_ray_caster_render_several(inputs, 0, &m.of[0].camera, NULL, NULL), STRATUS_INVALID_ARGUMENT);
  assert_int_equal(stratus_ray_caster_render_several(NULL, 1, &m.of[0].camera, NULL, NULL), STRATUS_INVALID_ARGUMENT);
  m.count = 2;
  assert_int_equal(several_draw_with(&casters, &m, &drawn, NULL), STRATUS_OK);
  several_casters_destroy(&casters);
  several_destroy(&m);
}

static void each_allocation_may_fail(void** state)
{
  several_case m;
  several_create(*state, &m, 2, 400);
  m.of[0].options.skipping.audit = 1;
  several_each_allocation_may_fail(&m);
  several_destroy(&m);
}

int test_ray_several(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(two_random_volumes_mix_as_the_reference_does),
    cmocka_unit_test(eight_random_volumes_mix_as_the_reference_does),
    cmocka_unit_test(stretched_grids_mix_as_the_reference_does),
    cmocka_unit_test(halves_of_a_volume_draw_the_whole),
    cmocka_unit_test(one_volume_alone_is_the_ordinary_picture),
    cmocka_unit_test(an_empty_volume_changes_nothing),
    cmocka_unit_test(boxes_apart_lie_over_each_other),
    cmocka_unit_test(what_bounds_a_ray_bounds_it_in_each_volume),
    cmocka_unit_test(light_and_gradient_opacity_are_each_volumes_own),
    cmocka_unit_test(longer_steps_are_whole_numbers_of_the_lattices),
    cmocka_unit_test(deep_media_are_cut_into_pieces),
    cmocka_unit_test(a_wall_in_one_volume_hides_what_is_behind),
    cmocka_unit_test(no_structure_changes_a_bit),
    cmocka_unit_test(automatic_sampling_keeps_the_tolerance),
    cmocka_unit_test(casters_serve_both_kinds_of_pictures),
    cmocka_unit_test(what_does_not_mix_is_refused),
    cmocka_unit_test(each_allocation_may_fail),
  };
  return cmocka_run_group_tests(tests, case_set_up, case_tear_down);
}
