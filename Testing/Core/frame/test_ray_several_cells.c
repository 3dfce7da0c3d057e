/* SPDX-License-Identifier: BSD-3-Clause
 * Volumes among several whose functions are sharp, and whose rays therefore go from cell to cell: against the double reference, against the
 * picture of one volume where both must be the same, and to the bit where nothing may change a bit. */
#include "several_case.h"

#include "ray_caster.h"
#include "testing.h"

/* dB against the reference, which agrees with itself to 80. */
#define CELLS_DB 75.0

static picture drawn, other;

/* Several volumes average a piece's entries of the table. One volume by steps has the piece's colours and opacity in closed form. */
#define COLORS_APART 1e-3f
#define ALPHAS_APART 2e-5f

/* Returns the largest difference in the channels from `first` on. */
static float largest_difference_from(int first, const picture* a, const picture* b)
{
  float largest = 0.0f;
  for (int i = 0; i < 4 * CASE_PIXELS; ++i) {
    largest = i % 4 < first ? largest : fmaxf(largest, fabsf(a->rgba[i] - b->rgba[i]));
  }
  return largest;
}

static float largest_difference(const picture* a, const picture* b)
{
  return largest_difference_from(0, a, b);
}

/* Gives a case a function with a narrow peak (kind 0), a window with vertical edges (1), or both over thin fog (2). */
static void sharpen(picture_case* c, int kind)
{
  const double base = case_type_values[c->volume.type].base, scale = case_type_values[c->volume.type].scale;
  const double functions[3][8] = {
    { base + 0.1 * scale, 0, base + 0.13 * scale, 0.8, base + 0.16 * scale, 0, base + scale, 0 },
    { base + 0.1 * scale, 0, base + 0.1 * scale, 0.4, base + 0.18 * scale, 0.4, base + 0.18 * scale, 0 },
    { base - scale, 0.005, base + 0.15 * scale, 0.01, base + 0.15 * scale, 0.5, base + scale, 0.02 },
  };
  memcpy(c->opacity, functions[kind], sizeof c->opacity);
  c->options.sampling.rule = STRATUS_SAMPLING_CELLS;
  c->options.sampling.cell_error = 1e-5;
}

static void sharp_functions_mix_as_the_reference_does(void** state)
{
  for (test_seeds s = test_seeds_of(2, 5); test_next(&s);) {
    const uint32_t seed = s.seed;
    several_case m;
    char what[48];
    several_create(*state, &m, 2 + (int)(seed % 2), 500 + seed);
    for (int n = 0; n < m.count - (int)(seed % 2); ++n) {
      sharpen(&m.of[n], (int)(seed + (uint32_t)n) % 3);
    }
    snprintf(what, sizeof what, "sharp, seed %u, %d volumes", seed, m.count);
    assert_true(several_psnr(what, *state, &m, &drawn) >= CELLS_DB);
    assert_true(case_lit(&drawn) > CASE_PIXELS / 20);
    several_destroy(&m);
  }
}

/* Nearest values have walls between them. */
static void boxes_about_values_mix_as_the_reference_does(void** state)
{
  for (test_seeds s = test_seeds_of(2, 4); test_next(&s);) {
    const uint32_t seed = s.seed;
    several_case m;
    several_create(*state, &m, 2, 520 + seed);
    for (int n = 0; n < 2; ++n) {
      m.of[n].options.sampling.interpolation = n == 0 || seed % 2 ? STRATUS_INTERPOLATION_NEAREST : STRATUS_INTERPOLATION_LINEAR;
      m.of[n].options.sampling.rule = STRATUS_SAMPLING_CELLS;
      m.of[n].options.sampling.cell_error = 1e-5;
    }
    assert_true(several_psnr("nearest", *state, &m, &drawn) >= CELLS_DB);
    assert_true(case_lit(&drawn) > CASE_PIXELS / 20);
    several_destroy(&m);
  }
}

/* Both halves by cells, and one of them by close samples, which overlap the other's stretches everywhere. */
static void halves_of_a_sharp_volume_draw_the_whole(void** state)
{
  const double half = 1.0 - sqrt(1.0 - 0.3);
  for (int kind = 0; kind < 3; ++kind) {
    several_case m = { .count = 2 };
    for (int n = 0; n < 2; ++n) {
      case_create(*state, &m.of[n], STRATUS_FLOAT32, 25, 28, 30, 12);
      const double opacity[8] = { -19.95, 0, -19.95, half, -19.6, half, -19.6, 0 };
      memcpy(m.of[n].opacity, opacity, sizeof opacity);
      m.of[n].options.sampling.rule = n && kind == 1 ? STRATUS_SAMPLING_PREINTEGRATED : STRATUS_SAMPLING_CELLS;
      m.of[n].options.sampling.distance = 0.02;
      m.of[n].options.sampling.cell_error = 1e-4;
      m.of[n].options.sampling.interpolation = kind == 2 ? STRATUS_INTERPOLATION_NEAREST : STRATUS_INTERPOLATION_LINEAR;
    }
    several_draw(*state, &m, &drawn);
    const double whole[8] = { -19.95, 0, -19.95, 0.3, -19.6, 0.3, -19.6, 0 };
    memcpy(m.of[0].opacity, whole, sizeof whole);
    case_render(*state, &m.of[0], &other);
    assert_true(case_lit(&drawn) > CASE_PIXELS / 20);
    const float apart = largest_difference(&drawn, &other), alphas_apart = largest_difference_from(3, &drawn, &other);
    print_message("             halves %d: %g, alpha %g\n", kind, (double)apart, (double)alphas_apart);
    /* close samples meet a window's edge up to a sample off */
    assert_true(apart < (kind == 2 ? 4e-6f : kind == 1 ? 4e-3f : COLORS_APART));
    assert_true(alphas_apart < (kind == 1 ? 4e-3f : ALPHAS_APART));
    several_destroy(&m);
  }
}

/* With a volume that shows nothing the picture is the ordinary one but for rounding, by all rules. */
static void an_empty_volume_changes_nothing(void** state)
{
  for (uint32_t seed = 0; seed < 6; seed += few_run() ? 3 : 1) {
    several_case m = { .count = 2 };
    if (seed < 3) {
      case_create(*state, &m.of[0], STRATUS_UINT8, 25, 28, 30, 5);
      sharpen(&m.of[0], (int)seed);
    } else {
      case_create_local(*state, 40 + seed, &m.of[0]);
      m.of[0].options.clipping.crop = 0;
      m.of[0].options.sampling.tolerance = 0.001 * sqrt(2.0);
    }
    case_create(*state, &m.of[1], STRATUS_FLOAT32, 17, 20, 23, 6);
    memset(m.of[1].opacity, 0, sizeof m.of[1].opacity);
    m.of[1].transfer.opacity_count = 1;
    m.of[1].options.sampling.distance = 100.0;
    several_draw(*state, &m, &drawn);
    m.of[0].options.sampling.tolerance = 0.001;
    case_render(*state, &m.of[0], &other);
    const float apart = largest_difference(&drawn, &other), alphas_apart = largest_difference_from(3, &drawn, &other);
    print_message("             with an empty one: %g, alpha %g; %s\n", (double)apart, (double)alphas_apart, drawn.report.why);
    assert_true(case_lit(&drawn) > CASE_PIXELS / 20);
    assert_int_equal(drawn.report.sampling, other.report.sampling);
    assert_int_equal(other.report.sampling, seed < 3 ? STRATUS_SAMPLING_CELLS : STRATUS_SAMPLING_LOCAL);
    /* rule local counts in samples of two voxels there and in voxels here, which rounds places in a rough box otherwise */
    assert_true(apart < (seed == 1 ? COLORS_APART : seed < 3 ? 4e-6f : 1e-4f));
    assert_true(alphas_apart < (seed < 3 ? ALPHAS_APART : 1e-4f));
    several_destroy(&m);
  }
}

/* Opacity 1 over an interval stops rays by cells, too. Where a ray grazes a wall, it meets or misses it by a rounding. */
static void a_wall_by_cells_hides_what_is_behind(void** state)
{
  static float reference[4 * CASE_PIXELS_MOST];
  for (int n = 0; n < 2; ++n) {
    several_case m;
    reference_scene scenes[2];
    int opaque = 0, grazing = 0;
    several_create(*state, &m, 2, 91);
    picture_case* c = &m.of[n];
    const double base = case_type_values[c->volume.type].base, scale = case_type_values[c->volume.type].scale;
    const double opacity[8] = { base - scale, 0, base + 0.2 * scale, 0.1, base + 0.2 * scale, 1.0, base + scale, 1.0 };
    memcpy(c->opacity, opacity, sizeof opacity);
    for (int i = 0; i < 2; ++i) {
      m.of[i].options.sampling.rule = STRATUS_SAMPLING_CELLS;
      m.of[i].options.sampling.cell_error = 1e-5;
      scenes[i] = case_scene(&m.of[i]);
      scenes[i].camera = &m.of[0].camera;
    }
    several_draw(*state, &m, &drawn);
    assert_int_equal(reference_render_several(scenes, 2, CASE_WIDTH, CASE_HEIGHT, 1.0 / 64, reference, NULL), 0);
    for (int i = 0; i < CASE_PIXELS; ++i) {
      bool far = false;
      for (int channel = 4 * i; channel < 4 * i + 4; ++channel) {
        far = far || fabsf(drawn.rgba[channel] - reference[channel]) > 0.01f;
      }
      opaque += drawn.rgba[4 * i + 3] == 1.0f;
      grazing += far;
    }
    print_message("             a wall in volume %d: %d pixels opaque, %d far off\n", n, opaque, grazing);
    assert_true(opaque > 50);
    assert_true(grazing <= 2);
    several_destroy(&m);
  }
}

/* Rule local among others: no structure, thread or order of tiles changes a bit, nor does jitter. */
static void no_structure_changes_a_bit_of_rule_local(void** state)
{
  stratus_context* threads[2] = { case_context("host", 1), case_context("host", 5) };
  int local = 0;
  uint64_t skipped = 0;
  for (uint32_t seed = 0; seed < 12; seed += few_run() ? 3 : 1) {
    several_case m = { .count = 2 + (int)(seed % 2) };
    for (int n = 0; n < m.count; ++n) {
      if (n < 2) {
        case_create_local(*state, 70 + 3 * seed + (uint32_t)n, &m.of[n]);
      } else {
        case_create(*state, &m.of[n], STRATUS_UINT16, 30, 26, 22, seed);
        sharpen(&m.of[n], (int)(seed / 2 % 3));
      }
      if (seed % 3 == 2) { /* fewer blocks show anything */
        m.of[n].opacity[1] = m.of[n].opacity[3] = 0.0;
      }
      m.of[n].options.skipping.structure = (stratus_structure)(STRATUS_STRUCTURE_AUTO + (seed + (uint32_t)n) % 6);
      several_place(&m.of[n], 5 * seed + (uint32_t)n);
    }
    m.of[0].options.skipping.audit = 1;
    m.of[0].options.sampling.jitter = seed % 4 == 0;
    const double eye[3] = { 40.0 - 3.0 * seed, 40, -30.0 + seed }, focal[3] = { 1, 2, 0 }, up[3] = { 0, 0, 1 };
    assert_int_equal(stratus_camera_perspective(*state, eye, focal, up, 40.0, 1.2, &m.of[0].camera), STRATUS_OK);
    several_draw(*state, &m, &drawn);
    assert_true(case_lit(&drawn) > case_share(50));
    local += drawn.report.sampling == STRATUS_SAMPLING_LOCAL;
    skipped += drawn.report.skipped;
    assert_int_equal(drawn.report.differing_pixels, 0);
    for (int t = 0; t < 2; ++t) {
      several_draw(threads[t], &m, &other);
      assert_memory_equal(drawn.rgba, other.rgba, sizeof drawn.rgba);
      assert_memory_equal(drawn.depth, other.depth, sizeof drawn.depth);
    }
    several_destroy(&m);
  }
  assert_true(local >= (few_run() ? 1 : 4));
  assert_true(skipped > (few_run() ? 0 : 1000));
  stratus_context_destroy(threads[0]);
  stratus_context_destroy(threads[1]);
}

/* The probes' settings together keep the tolerance of the whole picture. */
static void automatic_sampling_of_sharp_functions_keeps_the_tolerance(void** state)
{
  int cells = 0;
  test_seeds s = test_seeds_of(3, 6);
  while (test_next(&s)) {
    const uint32_t seed = s.seed;
    several_case m;
    several_create(*state, &m, 2 + (int)(seed % 2), 600 + seed);
    for (int n = 0; n < m.count; ++n) {
      if (n == 0 || seed % 3 == 0) {
        sharpen(&m.of[n], (int)seed % 2);
      }
      m.of[n].options = stratus_ray_cast_options_default();
    }
    assert_true(several_psnr("automatic", *state, &m, &drawn) >= 60.0);
    cells += drawn.report.sampling == STRATUS_SAMPLING_CELLS || drawn.report.sampling == STRATUS_SAMPLING_LOCAL;
    several_destroy(&m);
  }
  assert_true(!test_many(&s, 3) || 2 * cells >= (int)s.end);
}

int test_ray_several_cells(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(sharp_functions_mix_as_the_reference_does),
    cmocka_unit_test(boxes_about_values_mix_as_the_reference_does),
    cmocka_unit_test(halves_of_a_sharp_volume_draw_the_whole),
    cmocka_unit_test(an_empty_volume_changes_nothing),
    cmocka_unit_test(a_wall_by_cells_hides_what_is_behind),
    cmocka_unit_test(no_structure_changes_a_bit_of_rule_local),
    cmocka_unit_test(automatic_sampling_of_sharp_functions_keeps_the_tolerance),
  };
  return cmocka_run_group_tests(tests, case_set_up, case_tear_down);
}
