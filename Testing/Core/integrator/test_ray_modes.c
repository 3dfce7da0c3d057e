/* SPDX-License-Identifier: BSD-3-Clause
 * Maxima, minima, means, sums and isosurfaces, compared with a double reference, and with themselves: no structure, number of threads or
 * instruction set changes a bit.
 *
 * Samples lie a tenth of a voxel apart here, so that what is left against the reference is a second-order error: of the extremes some
 * curvature times .05^2/2 voxel, of sums as much; and the table's: half an entry of 4096 times the steepest change of colour or opacity (of
 * the peaked functions below 20 of a range), 2.5e-3. Isosurfaces don't sample: floats leave some 1e-5 voxel, but where a ray grazes a
 * surface it may meet it in one and not in the other. */
#include "volume.h"

#include "picture_case.h"
#include "reference_modes.h"
#include "testing.h"

#define MODE_DB 64.0        /* measured: 69 to 99 */
#define DEPTH_ERROR 1e-4    /* of a surface, voxels; measured: 4.6e-5 */
#define GRAZES_MOST 2       /* pixels of an average; measured: 1 of 1594 */
#define GRAZING_SHARE 0.001 /* of the pixels that may see another surface; measured: 3 of 12,297 */

static picture drawn, other;
static float expected[4 * CASE_PIXELS_MOST], expected_depth[CASE_PIXELS_MOST];

static const stratus_mode modes[] = { STRATUS_MODE_MAXIMUM, STRATUS_MODE_MINIMUM, STRATUS_MODE_AVERAGE, STRATUS_MODE_ADDITIVE,
  STRATUS_MODE_ISOSURFACE };
enum { MODES = sizeof modes / sizeof *modes };

static void ask_for(picture_case* c, stratus_mode mode)
{
  const double base = case_type_values[c->volume.type].base, scale = case_type_values[c->volume.type].scale;
  c->options.mode = mode;
  if (mode == STRATUS_MODE_AVERAGE) {
    c->options.optics.average_range[0] = base - 0.2 * scale;
    c->options.optics.average_range[1] = base + 0.6 * scale;
  } else if (mode == STRATUS_MODE_ISOSURFACE) {
    c->options.sampling.interpolation = STRATUS_INTERPOLATION_LINEAR;
    c->options.optics.contour_count = 4;
    c->options.optics.contours[0] = base + 0.4 * scale; /* not in order, and one transparent */
    c->options.optics.contours[1] = base + 0.11 * scale;
    c->options.optics.contours[2] = base - 0.5 * scale;
    c->options.optics.contours[3] = base + 0.2 * scale;
  }
}

static void draw_expected(const picture_case* c)
{
  reference_modes_render(&c->volume, &c->transfer, &c->camera, &c->options, CASE_WIDTH, CASE_HEIGHT, 0.02, expected, expected_depth);
}

/* An average jumps from nothing to opaque where a ray grazes a value that counts, which a sample meets or misses. Leaves such pixels out.
 */
static void leave_out_grazes(void)
{
  int grazes = 0;
  for (int i = 0; i < CASE_PIXELS; ++i) {
    if (drawn.rgba[4 * i + 3] != expected[4 * i + 3]) {
      memcpy(drawn.rgba + 4 * i, expected + 4 * i, 4 * sizeof *expected);
      ++grazes;
    }
  }
  assert_in_range(grazes, 0, case_share(GRAZES_MOST));
}

static void expect_samples(stratus_context* context, const picture_case* c, const char* what)
{
  case_render(context, c, &drawn);
  draw_expected(c);
  if (c->options.mode == STRATUS_MODE_AVERAGE) {
    leave_out_grazes();
  }
  const double db = reference_psnr(drawn.rgba, expected, CASE_PIXELS);
  print_message("             %s, %s: %.1f dB, %d pixels\n", stratus_mode_name(c->options.mode), what, db, case_lit(&drawn));
  assert_true(case_lit(&drawn) > CASE_PIXELS / 20);
  assert_true(db >= MODE_DB);
}

static void extremes_and_sums_of_every_type(void** state)
{
  for (int type = STRATUS_INT8; type <= STRATUS_FLOAT64; ++type) {
    picture_case c;
    case_create(*state, &c, (stratus_type)type, 23, 29, 21, 5u + (uint32_t)type);
    c.options.sampling.distance = 0.1;
    c.options.mode = modes[type % 4];
    ask_for(&c, modes[type % 4]);
    expect_samples(*state, &c, case_type_names[type]);
    case_destroy(&c);
  }
}

static void extremes_and_sums_from_everywhere(void** state)
{
  for (int mode = 0; mode < 4; ++mode) {
    picture_case c;
    case_create(*state, &c, STRATUS_FLOAT32, 23, 29, 21, 40u + (uint32_t)mode);
    c.options.sampling.distance = 0.1;
    ask_for(&c, modes[mode]);
    c.volume.matrix[1] = 0.3; /* sheared and mirrored */
    c.volume.matrix[10] = -1.0;
    c.volume.cell_centered = mode % 2;
    case_camera(*state, &c, 3, mode % 2);
    expect_samples(*state, &c, "sheared and mirrored");
    for (int i = 0; i < 9; ++i) {
      case_store(c.values, STRATUS_FLOAT32, (size_t)(1000 + 777 * i), (double)NAN);
    }
    c.volume.cell_centered = 0;
    c.volume.revision = 1;
    case_render(*state, &c, &drawn);
    draw_expected(&c);
    int far = 0;
    for (int i = 0; i < 4 * CASE_PIXELS; ++i) {
      far += fabsf(drawn.rgba[i] - expected[i]) > 0.02f;
    }
    assert_true(far < CASE_PIXELS / 100); /* a hole's border is met a tenth of a voxel off at most */
    case_destroy(&c);
  }
}

static void the_depth_of_a_maximum_is_where_it_is(void** state)
{
  picture_case c;
  case_create(*state, &c, STRATUS_FLOAT32, 23, 29, 21, 11u);
  ask_for(&c, STRATUS_MODE_MAXIMUM);
  c.options.sampling.distance = 0.1;
  case_render(*state, &c, &drawn);
  draw_expected(&c);
  int near = 0, shown = 0;
  for (int i = 0; i < CASE_PIXELS; ++i) {
    if (isfinite(drawn.depth[i]) && isfinite(expected_depth[i])) {
      ++shown;
      near += fabsf(drawn.depth[i] - expected_depth[i]) < 0.6f; /* flat maxima: many a step is as good as another */
    }
  }
  assert_true(shown > CASE_PIXELS / 10 && near > shown - shown / 50);
  case_destroy(&c);
}

static void a_sum_is_grey_and_covers_the_volume(void** state)
{
  picture_case c;
  case_create(*state, &c, STRATUS_UINT8, 23, 29, 21, 11u);
  ask_for(&c, STRATUS_MODE_ADDITIVE);
  memset(c.values, 0, 23 * 29 * 21); /* transparent throughout: black, but there */
  for (int structure = STRATUS_STRUCTURE_AUTO; structure <= STRATUS_STRUCTURE_HYBRID; ++structure) {
    c.options.skipping.structure = (stratus_structure)structure;
    case_render(*state, &c, &drawn);
    draw_expected(&c);
    assert_true(case_lit(&drawn) > CASE_PIXELS / 10);
    for (int i = 0; i < CASE_PIXELS; ++i) {
      assert_true(drawn.rgba[4 * i] == 0.0f && drawn.rgba[4 * i + 3] == expected[4 * i + 3]);
    }
  }
  case_destroy(&c);
}

/* Number of pixels that differ from the reference; *error: largest error of depth among the others. */
static int compare_surfaces(const picture* p, double* error)
{
  int differing = 0;
  *error = 0.0;
  for (int i = 0; i < CASE_PIXELS; ++i) {
    float largest = 0.0f;
    for (int c = 0; c < 4; ++c) {
      largest = fmaxf(largest, fabsf(p->rgba[4 * i + c] - expected[4 * i + c]));
    }
    const bool both = isfinite(p->depth[i]) && isfinite(expected_depth[i]);
    const double away = both ? fabs((double)p->depth[i] - (double)expected_depth[i]) : 0.0;
    if (largest > 1e-5f || away > 0.1 || isfinite(p->depth[i]) != isfinite(expected_depth[i])) {
      ++differing;
    } else {
      *error = fmax(*error, away);
    }
  }
  return differing;
}

static void isosurfaces_are_where_the_field_is_the_contour(void** state)
{
  int pixels = 0, differing = 0;
  double worst = 0.0;
  for (uint32_t seed = 0; seed < 12; seed += few_run() ? 4 : 1) {
    picture_case c;
    const stratus_type type = (stratus_type)(seed % 10);
    case_create(*state, &c, type, 9 + seed, 17, 14, 90u + seed);
    ask_for(&c, STRATUS_MODE_ISOSURFACE);
    c.volume.spacing[1] = 1.3;
    c.volume.cell_centered = seed % 3 == 1;
    if (seed % 3 == 2) { /* a rough field: cubics with three roots */
      uint32_t random = seed;
      for (size_t i = 0; i < (size_t)((9 + seed) * 17 * 14); ++i) {
        const double f = case_uniform(&random, -0.8, 0.8);
        case_store(c.values, type, i, case_type_values[type].base + f * case_type_values[type].scale);
      }
    }
    case_camera(*state, &c, (int)(seed % 8), (int)(seed % 2));
    case_render(*state, &c, &drawn);
    draw_expected(&c);
    double error;
    const int missed = compare_surfaces(&drawn, &error);
    print_message("             %s%s: %d of %d pixels differ, the others' depth by %.2g voxels at most\n", case_type_names[type],
      seed % 3 == 2 ? ", noise" : "", missed, case_lit(&drawn), error);
    pixels += case_lit(&drawn);
    differing += missed;
    worst = fmax(worst, error);
    case_destroy(&c);
  }
  assert_true(pixels > (few_run() ? CASE_PIXELS / 4 : CASE_PIXELS));
  assert_true(differing <= GRAZING_SHARE * pixels);
  assert_true(worst <= DEPTH_ERROR);
}

/* A contour whose value whole layers of voxels have, as in labels and clamped data: no surface is lost between two cells. */
static void no_ray_slips_between_cells(void** state)
{
  picture_case c;
  case_create(*state, &c, STRATUS_FLOAT32, 16, 16, 16, 1u);
  float* values = c.values;
  for (int i = 0; i < 16 * 16 * 16; ++i) {
    values[i] = (float)(i / 256) - 7.0f; /* rises along z; 0 on a layer of voxels */
  }
  const double opacity[4] = { -1, 1, 1, 1 };
  memcpy(c.opacity, opacity, sizeof opacity);
  c.transfer.opacity_count = 2;
  c.options.mode = STRATUS_MODE_ISOSURFACE;
  c.options.optics.contour_count = 1;
  c.options.optics.contours[0] = 0.0;
  for (int view = 0; view < 8; ++view) {
    case_camera(*state, &c, view, view % 2);
    case_render(*state, &c, &drawn);
    draw_expected(&c);
    double error;
    const int missed = compare_surfaces(&drawn, &error);
    print_message(
      "             view %d: %d of %d pixels differ, the others' depth by %.2g voxels at most\n", view, missed, case_lit(&drawn), error);
    assert_true(case_lit(&drawn) > CASE_PIXELS / 20);
    assert_int_equal(missed, 0);
    assert_true(error < 1e-4);
  }
  case_destroy(&c);
}

/* A ball, lit from the eye, so that depth and geometry determine the picture. Its normals come from central differences over two voxels of
 * a field that bends with a radius of 8: 1 - cos of an angle below .02, and the deviation of the field's cubic from the ball. */
static void surfaces_are_lit_by_the_gradient(void** state)
{
  picture_case c;
  case_create(*state, &c, STRATUS_FLOAT32, 24, 24, 24, 1u);
  for (int i = 0; i < 24 * 24 * 24; ++i) {
    const double x = i % 24 - 11.5, y = i / 24 % 24 - 11.5, z = i / 576 - 11.5;
    ((float*)c.values)[i] = (float)sqrt(x * x + y * y + z * z);
  }
  const double opacity[4] = { 0, 1, 20, 1 };
  memcpy(c.opacity, opacity, sizeof opacity);
  c.transfer.opacity_count = 2;
  c.transfer.color_count = 1;
  c.options.mode = STRATUS_MODE_ISOSURFACE;
  c.options.optics.contour_count = 1;
  c.options.optics.contours[0] = 8.0;
  c.options.light.shade = 1;
  case_camera(*state, &c, 2, 0);
  case_render(*state, &c, &drawn);
  int lit = 0;
  double worst = 0.0;
  for (int i = 0; i < CASE_PIXELS; ++i) {
    const double u = (2.0 * (i % CASE_WIDTH) + 1.0) / CASE_WIDTH - 1.0, v = (2.0 * (i / CASE_WIDTH) + 1.0) / CASE_HEIGHT - 1.0;
    double along[3], length = 0.0, cosine = 0.0;
    if (drawn.rgba[4 * i + 3] < 1.0f) {
      continue;
    }
    for (int a = 0; a < 3; ++a) {
      along[a] = c.camera.forward[a] + u * c.camera.right[a] + v * c.camera.up[a];
      length += along[a] * along[a];
    }
    for (int a = 0; a < 3; ++a) {
      const double place = c.camera.eye[a] + (double)drawn.depth[i] * along[a] / sqrt(length);
      cosine -= along[a] / sqrt(length) * (place - 11.5) / 8.0;
    }
    const double expected_red = c.color[1] * (c.options.light.shading.ambient + c.options.light.shading.diffuse * cosine);
    worst = fmax(worst, fabs((double)drawn.rgba[4 * i] - expected_red) / c.color[1]);
    ++lit;
  }
  print_message("             %d pixels, off by %.4f of their colour at most\n", lit, worst);
  assert_true(lit > CASE_PIXELS / 10);
  assert_true(worst < 0.02);
  c.options.light.shade = 0;
  case_render(*state, &c, &other);
  assert_true(memcmp(drawn.depth, other.depth, sizeof drawn.depth) == 0);
  assert_true(memcmp(drawn.rgba, other.rgba, sizeof drawn.rgba) != 0);
  case_destroy(&c);
}

static void expect_same(const char* what, const picture* a, const picture* b)
{
  int differing = 0;
  for (int i = 0; i < CASE_PIXELS; ++i) {
    differing += memcmp(a->rgba + 4 * i, b->rgba + 4 * i, 4 * sizeof(float)) != 0 || memcmp(a->depth + i, b->depth + i, sizeof(float)) != 0;
  }
  if (differing) {
    print_error("%s: %d of %d pixels differ\n", what, differing, CASE_PIXELS);
    fail();
  }
}

static void structures_change_no_bit(void** state)
{
  uint64_t skipped[MODES] = { 0 };
  int lit[MODES] = { 0 };
  for (uint32_t seed = 1; seed <= (few_run() ? 40 : 100); ++seed) {
    const int mode = (int)(seed % MODES);
    picture_case c;
    char what[128];
    case_create_random(*state, seed, &c);
    ask_for(&c, modes[mode]);
    c.options.skipping.structure = STRATUS_STRUCTURE_NONE;
    case_render(*state, &c, &drawn);
    assert_int_equal(drawn.report.skipped, 0);
    lit[mode] += case_lit(&drawn) > 0;
    c.options.skipping.audit = 1;
    for (int structure = STRATUS_STRUCTURE_AUTO; structure <= STRATUS_STRUCTURE_HYBRID; ++structure) {
      c.options.skipping.structure = (stratus_structure)structure;
      c.options.skipping.block_size = 2 << (seed + (uint32_t)structure) % 5;
      case_render(*state, &c, &other);
      snprintf(what, sizeof what, "seed %u, %s, %s, blocks of %d, %s", seed, stratus_mode_name(c.options.mode),
        stratus_structure_name(c.options.skipping.structure), c.options.skipping.block_size, case_type_names[c.volume.type]);
      expect_same(what, &drawn, &other);
      assert_int_equal(other.report.differing_pixels, 0);
      skipped[mode] += other.report.skipped;
    }
    case_destroy(&c);
  }
  for (int mode = 0; mode < MODES; ++mode) {
    assert_true(lit[mode] > (few_run() ? 2 : 5));
    assert_true(skipped[mode] > 0);
  }
}

/* Everything shows, so that no block is empty. But most blocks hold nothing better than the ray has already found. */
static void extremes_pass_blocks_that_hold_nothing_better(void** state)
{
  for (int mode = 0; mode < 2; ++mode) {
    picture_case c;
    case_create(*state, &c, STRATUS_FLOAT32, 40, 40, 40, 17u);
    const double base = case_type_values[STRATUS_FLOAT32].base, opacity[4] = { base - 3, 0.2, base + 3, 0.9 };
    memcpy(c.opacity, opacity, sizeof opacity);
    c.transfer.opacity_count = 2;
    c.options.mode = modes[mode];
    c.options.sampling.distance = 0.5;
    c.options.skipping.structure = STRATUS_STRUCTURE_NONE;
    case_render(*state, &c, &drawn);
    c.options.skipping.structure = STRATUS_STRUCTURE_BLOCK;
    case_render(*state, &c, &other);
    expect_same("block", &drawn, &other);
    print_message("             %s: %llu samples of %llu\n", stratus_mode_name(modes[mode]), (unsigned long long)other.report.samples,
      (unsigned long long)drawn.report.samples);
    assert_int_equal(other.report.occupied_blocks, other.report.blocks);
    assert_true(other.report.samples * 10 < drawn.report.samples * 9); /* measured: 57 and 82 of 100 */
    case_destroy(&c);
  }
}

static void threads_and_instructions_change_no_bit(void** state)
{
  stratus_context* one = case_context("host", 1);
  for (uint32_t seed = 200; seed < (few_run() ? 210 : 230); ++seed) {
    picture_case c;
    case_create_random(*state, seed, &c);
    ask_for(&c, modes[seed % MODES]);
    ((stratus_context*)*state)->isa = 2;
    case_render(*state, &c, &drawn);
    case_render(one, &c, &other);
    expect_same("threads", &drawn, &other);
    for (int isa = 0; isa < 2; ++isa) {
      ((stratus_context*)*state)->isa = isa;
      case_render(*state, &c, &other);
      expect_same("instruction sets", &drawn, &other);
    }
    case_destroy(&c);
  }
  ((stratus_context*)*state)->isa = 2;
  stratus_context_destroy(one);
}

/* One caster changes between all modes, back and forth, and no mode affects another. */
static void a_caster_changes_its_mode(void** state)
{
  stratus_ray_caster* caster = NULL;
  picture_case c;
  case_create(*state, &c, STRATUS_UINT16, 23, 29, 21, 3u);
  assert_int_equal(stratus_ray_caster_create(*state, &caster), STRATUS_OK);
  const stratus_ray_cast_options plain = c.options;
  for (int turn = 0; turn < 14; ++turn) {
    c.options = plain;
    if (turn % 2 == 0) {
      ask_for(&c, modes[turn / 2 % MODES]);
    }
    if (turn >= 10) {
      c.options.optics.contours[0] = 0.7;
      c.options.optics.average_range[1] = 32100.0;
    }
    case_render_with(*state, caster, &c, &drawn);
    case_render(*state, &c, &other);
    expect_same(stratus_mode_name(c.options.mode), &drawn, &other);
    case_render_with(*state, caster, &c, &other);
    assert_int_equal(drawn.report.table_builds, other.report.table_builds); /* the same again builds nothing */
  }
  stratus_ray_caster_destroy(caster);
  case_destroy(&c);
}

static void what_no_mode_can_draw_is_refused(void** state)
{
  picture_case c;
  stratus_ray_caster* caster = NULL;
  case_create(*state, &c, STRATUS_FLOAT32, 9, 9, 9, 3u);
  assert_int_equal(stratus_ray_caster_create(*state, &caster), STRATUS_OK);
  const stratus_image image = { .width = CASE_WIDTH, .height = CASE_HEIGHT, .rgba = drawn.rgba };
  const stratus_ray_cast_options plain = c.options;
  for (int wrong = 0; wrong < 7; ++wrong) {
    static const char* const words[] = { "0 contour", "17 contour", "contour 1 has value nan", "nearest", "average range", "mode 99",
      "average range" };
    c.options = plain;
    ask_for(&c, STRATUS_MODE_ISOSURFACE);
    c.options.optics.contour_count = wrong == 0 ? 0 : wrong == 1 ? 17 : 4;
    c.options.optics.contours[1] = wrong == 2 ? (double)NAN : 0.0;
    c.options.sampling.interpolation = wrong == 3 ? STRATUS_INTERPOLATION_NEAREST : STRATUS_INTERPOLATION_LINEAR;
    c.options.optics.average_range[0] = wrong == 4 ? 2.0 : wrong == 6 ? (double)NAN : -1.0;
    c.options.optics.average_range[1] = 1.0;
    c.options.mode = wrong == 5 ? (stratus_mode)99 : wrong == 4 || wrong == 6 ? STRATUS_MODE_AVERAGE : STRATUS_MODE_ISOSURFACE;
    const stratus_status status = stratus_ray_caster_render(caster, &c.volume, &c.transfer, &c.camera, &c.options, &image, NULL);
    assert_int_equal(status, wrong == 3 ? STRATUS_UNSUPPORTED : STRATUS_INVALID_ARGUMENT);
    if (!strstr(stratus_context_message(*state), words[wrong])) {
      print_error("%s\n", stratus_context_message(*state));
      fail();
    }
  }
  stratus_ray_caster_destroy(caster);
  case_destroy(&c);
}

int test_ray_modes(void)
{
  const struct CMUnitTest tests[] = { cmocka_unit_test(extremes_and_sums_of_every_type),
    cmocka_unit_test(extremes_and_sums_from_everywhere), cmocka_unit_test(the_depth_of_a_maximum_is_where_it_is),
    cmocka_unit_test(a_sum_is_grey_and_covers_the_volume), cmocka_unit_test(isosurfaces_are_where_the_field_is_the_contour),
    cmocka_unit_test(no_ray_slips_between_cells), cmocka_unit_test(surfaces_are_lit_by_the_gradient),
    cmocka_unit_test(structures_change_no_bit), cmocka_unit_test(extremes_pass_blocks_that_hold_nothing_better),
    cmocka_unit_test(threads_and_instructions_change_no_bit), cmocka_unit_test(a_caster_changes_its_mode),
    cmocka_unit_test(what_no_mode_can_draw_is_refused) };
  return cmocka_run_group_tests(tests, case_set_up, case_tear_down);
}
