/* SPDX-License-Identifier: BSD-3-Clause
 * Several volumes in the modes whose rays keep a number or a hit: each pixel against the double-precision references of each volume by
 * itself, joined here. The functions are opaque and grey, so that a reference's colour is the number that its ray has kept. */
#include "reference_modes.h"
#include "several_case.h"
#include "testing.h"

#define STEP 0.05

static picture drawn, single;
static float of[STRATUS_SEVERAL_MAX][4 * CASE_PIXELS_MOST], depths[STRATUS_SEVERAL_MAX][CASE_PIXELS_MOST];

/* Volumes of floats of one range. */
static void create(stratus_context* context, several_case* m, int count, uint32_t seed)
{
  several_create(context, m, count, seed);
  const stratus_camera camera = m->of[0].camera;
  for (int n = 0; n < count; ++n) {
    case_destroy(&m->of[n]);
    case_create(context, &m->of[n], STRATUS_FLOAT32, 20 + 3 * n, 24, 31 - 2 * n, seed + (uint32_t)n);
    several_place(&m->of[n], seed + 17u * (uint32_t)n);
    several_color(&m->of[n], n);
  }
  m->of[0].camera = camera;
}

/* Makes all volumes show their values from black to white, with opacity 1 (extremes) or a quarter (sums). */
static void make_grey(several_case* m, stratus_mode mode)
{
  const double base = case_type_values[STRATUS_FLOAT32].base, scale = case_type_values[STRATUS_FLOAT32].scale;
  const double low = base - 2.0 * scale, high = base + 2.0 * scale;
  const double opacity = mode == STRATUS_MODE_AVERAGE || mode == STRATUS_MODE_ADDITIVE ? 0.25 : 1.0;
  for (int n = 0; n < m->count; ++n) {
    picture_case* c = &m->of[n];
    const double function[8] = { low, opacity, base, opacity, base + scale, opacity, high, opacity };
    const double color[12] = { low, 0, 0, 0, base, 0.5, 0.5, 0.5, high, 1, 1, 1 };
    memcpy(c->opacity, function, sizeof function);
    memcpy(c->color, color, sizeof color);
    c->transfer.unit_distance = 200.0;
    c->options.mode = mode;
    c->options.sampling.rule = STRATUS_SAMPLING_AUTO;
    c->options.sampling.distance = STEP;
    c->options.clipping.clip_plane_count = 0;
    c->options.clipping.crop = 0;
    c->options.sampling.interpolation = STRATUS_INTERPOLATION_LINEAR;
  }
}

/* Draws each volume by the reference. */
static void draw_references(const several_case* m)
{
  for (int n = 0; n < m->count; ++n) {
    const picture_case* c = &m->of[n];
    reference_modes_render(&c->volume, &c->transfer, &m->of[0].camera, &c->options, CASE_WIDTH, CASE_HEIGHT, 0.5 * STEP, of[n], depths[n]);
  }
}

/* Joins what the references' rays have kept in pixel i. Returns the grey, -1 if nothing is
 * kept. */
static double joined(const several_case* m, stratus_mode mode, int i)
{
  double best = -1.0;
  for (int n = 0; n < m->count; ++n) {
    const double grey = (double)of[n][4 * i];
    const bool any = of[n][4 * i + 3] > 0.0f;
    if (any && mode == STRATUS_MODE_ADDITIVE) {
      best = fmax(best, 0.0) + grey;
    } else if (any && (best < 0.0 || (mode == STRATUS_MODE_MINIMUM ? grey < best : grey > best))) {
      best = grey;
    }
  }
  return mode == STRATUS_MODE_ADDITIVE ? fmin(best, 1.0) : best;
}

static void extremes_and_sums_are_of_all(void** state)
{
  static const stratus_mode modes[] = { STRATUS_MODE_MAXIMUM, STRATUS_MODE_MINIMUM, STRATUS_MODE_ADDITIVE };
  for (uint32_t seed = 0; seed < (few_run() ? 3u : 9u); ++seed) {
    const stratus_mode mode = modes[seed % 3];
    several_case m;
    double squares = 0.0, worst_depth = 0.0;
    int lit = 0, of_second = 0, rims = 0;
    create(*state, &m, 2 + (int)(seed / 3), 400 + seed);
    make_grey(&m, mode);
    draw_references(&m);
    several_draw(*state, &m, &drawn);
    for (int i = 0; i < CASE_PIXELS; ++i) {
      const double expected = joined(&m, mode, i);
      if ((expected < 0.0) != !(drawn.rgba[4 * i + 3] > 0.0f)) { /* a ray along the rim of a volume */
        ++rims;
        continue;
      }
      if (expected < 0.0) {
        continue;
      }
      const double off = fabs((double)drawn.rgba[4 * i] - expected);
      squares += off * off;
      ++lit;
      of_second += of[0][4 * i + 3] > 0.0f && fabs((double)of[0][4 * i] - expected) > 0.01;
      float nearest = INFINITY;
      for (int n = 0; n < m.count; ++n) {
        nearest = fminf(nearest, depths[n][i]);
      }
      if (mode == STRATUS_MODE_ADDITIVE) {
        worst_depth = fmax(worst_depth, fabs((double)(drawn.depth[i] - nearest)));
      }
    }
    print_message("             %s of %d: rms %.2g of 1, %d pixels, %d of others than the first, %d at rims\n", stratus_mode_name(mode),
      m.count, sqrt(squares / lit), lit, of_second, rims);
    assert_true(lit > CASE_PIXELS / 10);
    assert_true(of_second > lit / 20);
    assert_true(rims < lit / 50);
    assert_true(sqrt(squares / lit) < 2e-3);
    assert_true(worst_depth < 4.0 * STEP);
    several_destroy(&m);
  }
}

/* Volumes of one place and grid have rays of equal lengths in all, so that the mean of both is the mean of their means. */
static void means_are_of_all_lengths(void** state)
{
  several_case m;
  double worst = 0.0;
  create(*state, &m, 2, 420);
  const picture_case first = m.of[0];
  case_destroy(&m.of[1]);
  case_create(*state, &m.of[1], STRATUS_FLOAT32, first.volume.dimensions[0], first.volume.dimensions[1], first.volume.dimensions[2], 77);
  memcpy(m.of[1].volume.matrix, first.volume.matrix, sizeof first.volume.matrix);
  memcpy(m.of[1].volume.spacing, first.volume.spacing, sizeof first.volume.spacing);
  memcpy(m.of[1].volume.origin, first.volume.origin, sizeof first.volume.origin);
  memcpy(m.of[1].volume.direction, first.volume.direction, sizeof first.volume.direction);
  m.of[1].volume.cell_centered = first.volume.cell_centered;
  make_grey(&m, STRATUS_MODE_AVERAGE);
  draw_references(&m);
  several_draw(*state, &m, &drawn);
  for (int i = 0; i < CASE_PIXELS; ++i) {
    if (of[0][4 * i + 3] > 0.0f && drawn.rgba[4 * i + 3] > 0.0f) {
      const double expected = 0.5 * ((double)of[0][4 * i] + (double)of[1][4 * i]);
      worst = fmax(worst, fabs((double)drawn.rgba[4 * i] - expected));
    }
  }
  print_message("             average of 2: at most %.2g of 1 off\n", worst);
  assert_true(case_lit(&drawn) > CASE_PIXELS / 10);
  assert_true(worst < 2e-3);
  several_destroy(&m);
}

/* The nearest of the hits of each volume by itself. */
static void nearest_hits_show(void** state)
{
  several_case m;
  int from[3] = { 0, 0, 0 }, lit = 0;
  create(*state, &m, 3, 430);
  static picture each[3];
  for (int n = 0; n < 3; ++n) {
    m.of[n].options.mode = STRATUS_MODE_FIRST_HIT;
    m.of[n].options.clipping.clip_plane_count = 0;
    const stratus_camera own = m.of[n].camera;
    m.of[n].camera = m.of[0].camera;
    case_render(*state, &m.of[n], &each[n]);
    m.of[n].camera = n ? own : m.of[n].camera;
  }
  several_draw(*state, &m, &drawn);
  for (int i = 0; i < CASE_PIXELS; ++i) {
    int nearest = 0;
    for (int n = 1; n < 3; ++n) {
      nearest = each[n].depth[i] < each[nearest].depth[i] ? n : nearest;
    }
    assert_memory_equal(&drawn.depth[i], &each[nearest].depth[i], sizeof(float));
    assert_memory_equal(&drawn.rgba[4 * i], &each[nearest].rgba[4 * i], 4 * sizeof(float));
    from[nearest] += drawn.rgba[4 * i + 3] > 0.0f;
    lit += drawn.rgba[4 * i + 3] > 0.0f;
  }
  print_message("             first hits of 3: %d, %d and %d pixels\n", from[0], from[1], from[2]);
  assert_true(from[0] > lit / 50 && from[1] > lit / 50 && from[2] > lit / 50);
  several_destroy(&m);
}

/* The casters draw ordinary pictures as before, and modes that differ are refused. */
static void casters_keep_nothing(void** state)
{
  several_case m;
  several_casters casters;
  create(*state, &m, 2, 440);
  several_casters_create(*state, &casters);
  make_grey(&m, STRATUS_MODE_MAXIMUM);
  case_render_with(*state, casters.of[0], &m.of[0], &single);
  assert_int_equal(several_draw_with(&casters, &m, &drawn, NULL), STRATUS_OK);
  static picture again;
  case_render_with(*state, casters.of[0], &m.of[0], &again);
  assert_memory_equal(again.rgba, single.rgba, sizeof single.rgba);
  m.of[1].options.mode = STRATUS_MODE_MINIMUM;
  assert_int_equal(several_draw_with(&casters, &m, &drawn, NULL), STRATUS_INVALID_ARGUMENT);
  assert_non_null(strstr(stratus_context_message(*state), "volume 1 of several has mode minimum, volume 0 has maximum"));
  m.of[1].options.mode = STRATUS_MODE_MAXIMUM;
  m.of[1].options.sampling.tolerance = -1.0;
  assert_int_equal(several_draw_with(&casters, &m, &drawn, NULL), STRATUS_INVALID_ARGUMENT);
  assert_non_null(strstr(stratus_context_message(*state), "tolerance"));
  several_casters_destroy(&casters);
  several_destroy(&m);
}

int test_ray_kept(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(extremes_and_sums_are_of_all),
    cmocka_unit_test(means_are_of_all_lengths),
    cmocka_unit_test(nearest_hits_show),
    cmocka_unit_test(casters_keep_nothing),
  };
  return cmocka_run_group_tests(tests, case_set_up, case_tear_down);
}
