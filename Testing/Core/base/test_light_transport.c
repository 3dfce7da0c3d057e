/* SPDX-License-Identifier: BSD-3-Clause
 * Light that is scattered many times in a box of cells, against what is known of furnaces, of absorbers and of slabs. */
#include "light_transport.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define CELLS_MOST 4096

typedef struct box {
  stratus_transport medium;
  float extinction[CELLS_MOST], albedo[CELLS_MOST], direct[CELLS_MOST];
  float mean[CELLS_MOST], first[CELLS_MOST], moments[STRATUS_TRANSPORT_MOMENTS * CELLS_MOST];
  int sweeps;
} box;

static stratus_context* context;
static box b;

static int start(void** state)
{
  (void)state;
  stratus_context_options options = stratus_context_options_default();
  options.device = "host";
  return stratus_context_create(&options, &context, NULL, 0) == STRATUS_OK ? 0 : -1;
}

static int stop(void** state)
{
  (void)state;
  stratus_context_destroy(context);
  return 0;
}

/* Makes a box of one matter, in vacuum without light. */
static void make_box(int nx, int ny, int nz, double spacing, float extinction, float albedo)
{
  memset(&b, 0, sizeof b);
  b.medium = (stratus_transport){ .size = { nx, ny, nz }, .spacing = { spacing, spacing, spacing } };
  b.medium.extinction = b.extinction;
  b.medium.albedo = b.albedo;
  b.medium.direct = b.direct;
  for (int i = 0; i < nx * ny * nz; ++i) {
    b.extinction[i] = extinction;
    b.albedo[i] = albedo;
  }
}

static void solve(void)
{
  assert_int_equal(stratus_transport_solve(context, &b.medium, 1e-5, b.mean, b.first, b.moments, &b.sweeps), STRATUS_OK);
}

static void directions_are_symmetric(void** state)
{
  (void)state;
  for (int i = 0; i < STRATUS_TRANSPORT_DIRECTIONS; ++i) {
    double way[3], other[3];
    int mirrored = 0;
    (void)stratus_transport_direction(i, way);
    assert_true(fabs(way[0] * way[0] + way[1] * way[1] + way[2] * way[2] - 1.0) < 1e-6);
    for (int k = 0; k < STRATUS_TRANSPORT_DIRECTIONS; ++k) {
      (void)stratus_transport_direction(k, other);
      mirrored += way[0] == -other[0] && way[1] == other[1] && way[2] == other[2];
    }
    assert_int_equal(mirrored, 1);
  }
}

/* A sky of one radiance lights matter that absorbs nothing. Then the matter is invisible: it has the radiance of the sky in all directions.
 */
static void a_furnace_shows_nothing(void** state)
{
  (void)state;
  const float extinctions[4] = { 0.0f, 0.1f, 3.0f, 20.0f };
  for (int n = 0; n < 4; ++n) {
    make_box(13, 7, 9, 0.5, extinctions[n], 1.0f);
    for (int i = 0; i < 13 * 7 * 9; i += 3) {
      b.extinction[i] = 0.0f; /* and holes */
    }
    for (int i = 0; i < STRATUS_TRANSPORT_DIRECTIONS; ++i) {
      b.medium.sky[i] = 2.0f;
    }
    solve();
    for (int i = 0; i < 13 * 7 * 9; ++i) {
      assert_float_equal(b.mean[i], 2.0f, 2e-3f);
      for (int axis = 0; axis < 3; ++axis) {
        assert_float_equal(b.moments[axis * 13 * 7 * 9 + i], 0.0f, 2e-3f);
      }
    }
    print_message("extinction %g: %d sweeps\n", (double)extinctions[n], b.sweeps);
  }
}

/* The light of the sky along a direction, in matter that does not scatter: Beer's law to each cell's centre. */
static void absorbers_follow_beers_law(void** state)
{
  (void)state;
  make_box(1, 1, 64, 1.0, 0.05f, 0.0f);
  b.medium.spacing[0] = b.medium.spacing[1] = 1e9;
  double expected[64] = { 0.0 }, worst = 0.0;
  for (int i = 0; i < STRATUS_TRANSPORT_DIRECTIONS; ++i) {
    double way[3];
    const double weight = stratus_transport_direction(i, way);
    b.medium.sky[i] = way[2] > 0.0 ? 1.0f : 0.0f;
    for (int k = 0; k < 64; ++k) {
      expected[k] += way[2] > 0.0 ? weight * exp(-0.05 * (k + 0.5) / way[2]) : 0.0;
    }
  }
  solve();
  for (int k = 0; k < 64; ++k) {
    worst = fmax(worst, fabs((double)b.mean[k] - expected[k]));
  }
  print_message("%.2g\n", worst);
  assert_true(worst < 1e-6);
}

/* A slab that absorbs nothing, in even light from one side: the net flux is the same everywhere, 4/3 / (depth + 1.4209) of the incident
 * flux (Hopf 1934: the extrapolated distance is 0.71045). */
static void slabs_let_pass_what_hopf_says(void** state)
{
  (void)state;
  const double depths[3] = { 4.0, 16.0, 64.0 };
  for (int n = 0; n < 3; ++n) {
    const double expected = 0.25 * 4.0 / 3.0 / (depths[n] + 1.4209);
    make_box(1, 1, 64, 1.0 / 64, (float)depths[n], 1.0f);
    b.medium.spacing[0] = b.medium.spacing[1] = 1e9;
    for (int i = 0; i < STRATUS_TRANSPORT_DIRECTIONS; ++i) {
      double way[3];
      (void)stratus_transport_direction(i, way);
      b.medium.sky[i] = way[2] > 0.0 ? 1.0f : 0.0f;
    }
    solve();
    double lowest = INFINITY, largest = 0.0;
    for (int k = 0; k < 64; ++k) {
      lowest = fmin(lowest, (double)b.moments[2 * 64 + k]);
      largest = fmax(largest, (double)b.moments[2 * 64 + k]);
    }
    print_message("depth %g: %.5f..%.5f, expected %.5f, %d sweeps\n", depths[n], lowest, largest, expected, b.sweeps);
    assert_true(lowest > 0.985 * expected && largest < 1.005 * expected);
  }
}

/* `first` is the part of the mean that was scattered once: nearly all of it if the albedo is near 0, less if it is high or if a sky shines.
 */
static void the_first_scattering_is_told(void** state)
{
  (void)state;
  make_box(8, 8, 8, 1.0, 0.3f, 0.02f);
  for (int i = 0; i < 512; ++i) {
    b.direct[i] = 1.0f;
  }
  solve();
  const float few = b.first[4 * 64 + 4 * 8 + 4];
  make_box(8, 8, 8, 1.0, 0.3f, 0.9f);
  for (int i = 0; i < 512; ++i) {
    b.direct[i] = 1.0f;
  }
  solve();
  const float many = b.first[4 * 64 + 4 * 8 + 4];
  for (int i = 0; i < STRATUS_TRANSPORT_DIRECTIONS; ++i) {
    b.medium.sky[i] = 1.0f;
  }
  solve();
  print_message("%.3f %.3f %.3f\n", (double)few, (double)many, (double)b.first[4 * 64 + 4 * 8 + 4]);
  assert_true(few > 0.98f && few <= 1.0f && many < 0.6f && b.first[4 * 64 + 4 * 8 + 4] < 0.7f * many);
}

int test_light_transport(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(directions_are_symmetric),
    cmocka_unit_test(a_furnace_shows_nothing),
    cmocka_unit_test(absorbers_follow_beers_law),
    cmocka_unit_test(slabs_let_pass_what_hopf_says),
    cmocka_unit_test(the_first_scattering_is_told),
  };
  return cmocka_run_group_tests(tests, start, stop);
}
