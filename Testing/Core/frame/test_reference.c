/* SPDX-License-Identifier: BSD-3-Clause
 * The reference renderer, compared with pictures that can be written down. */
#include "reference.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define SIDE 5
#define PIXELS (SIDE * SIDE)

static const double flat_color[] = { 0.0, 0.25, 0.5, 1.0 };
static const double flat_opacity[] = { 0.0, 0.0, 10.0, 0.3 };

static stratus_volume view(const float* values, int64_t nx, int64_t ny, int64_t nz)
{
  stratus_volume v = { .values = values, .type = STRATUS_FLOAT32, .dimensions = { nx, ny, nz }, .value_stride = 1, .spacing = { 1, 1, 1 } };
  for (int i = 0; i < 3; ++i) {
    v.direction[4 * i] = 1.0;
  }
  for (int i = 0; i < 4; ++i) {
    v.matrix[5 * i] = 1.0;
  }
  return v;
}

static stratus_transfer flat_transfer(void)
{
  return (stratus_transfer){
    .opacity = flat_opacity, .opacity_count = 2, .color = flat_color, .color_count = 1, .unit_distance = 2.0, .clamp = 1
  };
}

/* A camera that looks along +z at the square from (0,0) to (4,4), with one unit of the world for each pixel. */
static stratus_camera along_z(void)
{
  return (stratus_camera){
    .eye = { 2, 2, -3 }, .forward = { 0, 0, 1 }, .right = { 2.5, 0, 0 }, .up = { 0, 2.5, 0 }, .far_k = (double)INFINITY, .parallel = 1
  };
}

static void fill(float* values, size_t n, float value)
{
  for (size_t i = 0; i < n; ++i) {
    values[i] = value;
  }
}

static double alpha_of(double length)
{
  return 1.0 - pow(0.7, length / 2.0);
}

static void expect_pixel(const float* pixel, double alpha)
{
  assert_true(fabs((double)pixel[3] - alpha) < 1e-6);
  for (int c = 0; c < 3; ++c) {
    assert_true(fabs((double)pixel[c] - flat_color[1 + c] * alpha) < 1e-6);
  }
}

static void constant_slab_attenuates_by_its_length(void** state)
{
  (void)state;
  float values[5 * 5 * 4];
  float rgba[4 * PIXELS];
  float depth[PIXELS];
  fill(values, 5 * 5 * 4, 10.0f);
  stratus_volume v = view(values, 5, 5, 4);
  const stratus_transfer t = flat_transfer();
  const stratus_camera c = along_z();
  reference_scene scene = { .volume = &v, .transfer = &t, .camera = &c };
  assert_int_equal(reference_render(&scene, SIDE, SIDE, 0.37, rgba, depth), 0);
  expect_pixel(rgba + 4 * 12, alpha_of(3.0));
  assert_true(fabs((double)depth[12] - 3.0) < 1e-6);

  v.cell_centered = 1; /* one voxel longer, half a voxel further at either end */
  assert_int_equal(reference_render(&scene, SIDE, SIDE, 0.37, rgba, NULL), 0);
  expect_pixel(rgba + 4 * 12, alpha_of(4.0));

  v.cell_centered = 0;
  v.spacing[2] = 5.0;
  v.matrix[10] = -0.5; /* mirrored and halved: from z = 0 to -7.5, cut at the eye's plane at -3 */
  assert_int_equal(reference_render(&scene, SIDE, SIDE, 0.37, rgba, NULL), 0);
  expect_pixel(rgba + 4 * 12, alpha_of(3.0));
}

static void crop_planes_and_opaque_depth_cut_the_length(void** state)
{
  (void)state;
  float values[5 * 5 * 4];
  float rgba[4 * PIXELS];
  float opaque[PIXELS];
  fill(values, 5 * 5 * 4, 10.0f);
  const stratus_volume v = view(values, 5, 5, 4);
  const stratus_transfer t = flat_transfer();
  stratus_camera c = along_z();
  reference_scene scene = { .volume = &v, .transfer = &t, .camera = &c, .crop = 1, .crop_bounds = { 1.5, 9, -9, 9, 0.25, 2.5 } };
  assert_int_equal(reference_render(&scene, SIDE, SIDE, 0.1, rgba, NULL), 0);
  expect_pixel(rgba + 4 * 12, alpha_of(2.25));
  expect_pixel(rgba + 4 * 11, 0.0);

  scene.crop = 0;
  scene.clip_plane_count = 2;
  const double planes[2][4] = { { 0, 0, 1, -1 }, { 0, 0, -2, 5 } };
  memcpy(scene.clip_planes, planes, sizeof planes);
  assert_int_equal(reference_render(&scene, SIDE, SIDE, 0.1, rgba, NULL), 0);
  expect_pixel(rgba + 4 * 12, alpha_of(1.5));

  scene.clip_plane_count = 0;
  c.near_k = 2.0;
  c.far_k = 10.0;
  for (int i = 0; i < PIXELS; ++i) {
    opaque[i] = 0.25f; /* at 4 from the eye's plane, z = 1 */
  }
  scene.opaque_depth = opaque;
  assert_int_equal(reference_render(&scene, SIDE, SIDE, 0.1, rgba, NULL), 0);
  expect_pixel(rgba + 4 * 12, alpha_of(1.0));

  c.parallel = 0;
  opaque[12] = (float)(1.25 * (1.0 - 2.0 / 4.0)); /* f (k - n) / (k (f - n)) at k = 4 */
  assert_int_equal(reference_render(&scene, SIDE, SIDE, 0.1, rgba, NULL), 0);
  expect_pixel(rgba + 4 * 12, alpha_of(1.0));
}

/* Along z the value rises from 0 to 10, so alpha is the integral of ln(1 - .03 z) in closed form. */
static void ramp_integrates_the_transfer_function(void** state)
{
  (void)state;
  float values[5 * 5 * 11];
  float rgba[4 * PIXELS];
  double db = 0.0;
  for (int i = 0; i < 5 * 5 * 11; ++i) {
    values[i] = (float)(i / 25);
  }
  const stratus_volume v = view(values, 5, 5, 11);
  const stratus_transfer t = flat_transfer();
  const stratus_camera c = along_z();
  const reference_scene scene = { .volume = &v, .transfer = &t, .camera = &c };
  assert_int_equal(reference_converged(&scene, SIDE, SIDE, 90.0, rgba, NULL, &db), 0);
  assert_true(db >= 100.0);
  /* integral of -ln(1 - .03 z) dz over 0..10 = ((1 - .03 z) ln(1 - .03 z) + .03 z) / .03 at z = 10 */
  const double depth = (0.7 * log(0.7) + 0.3) / 0.03;
  assert_true(fabs((double)rgba[4 * 12 + 3] - (1.0 - exp(-depth / 2.0))) < 2e-6);
}

/* Opacity and colour in vertical steps, at values within cells and on grid planes. */
static const double step_opacity[] = { 0, 0, 2.5, 0, 2.5, .4, 4, .4, 4, .1, 7.25, .1, 7.25, .9, 7.25, .2, 10, .2 };
static const double step_color[] = { 0, 1, 0, 0, 3, 1, 0, 0, 3, 0, 1, 0, 7.25, 0, 1, 0, 7.25, 0, 0, 1, 10, 0, 0, 1 };

static stratus_transfer step_transfer(void)
{
  return (stratus_transfer){
    .opacity = step_opacity, .opacity_count = 9, .color = step_color, .color_count = 6, .unit_distance = 1.0, .clamp = 1
  };
}

/* Along z the value rises from 0 to 10, so that each step's length is known. A piece may be as long as a cell. */
static void vertical_steps_are_cut_where_they_are(void** state)
{
  (void)state;
  float values[5 * 5 * 11];
  float rgba[4 * PIXELS];
  float depth[PIXELS];
  for (int i = 0; i < 5 * 5 * 11; ++i) {
    values[i] = (float)(i / 25);
  }
  const stratus_volume v = view(values, 5, 5, 11);
  const stratus_transfer t = step_transfer();
  const stratus_camera c = along_z();
  const reference_scene scene = { .volume = &v, .transfer = &t, .camera = &c };
  static const struct {
    double opacity, length;
    int color;
  } parts[] = { { .4, .5, 0 }, { .4, 1, 1 }, { .1, 3.25, 1 }, { .2, 2.75, 2 } };
  double expected[4] = { 0, 0, 0, 1 };
  for (int i = 0; i < 4; ++i) {
    const double kept = 1 - pow(1 - parts[i].opacity, parts[i].length);
    expected[parts[i].color] += expected[3] * kept;
    expected[3] *= 1 - kept;
  }
  expected[3] = 1 - expected[3];
  for (int halvings = 0; halvings < 3; ++halvings) {
    assert_int_equal(reference_render(&scene, SIDE, SIDE, ldexp(1.0, -halvings), rgba, depth), 0);
    for (int channel = 0; channel < 4; ++channel) {
      assert_true(fabs((double)rgba[4 * 12 + channel] - expected[channel]) < 2e-7);
    }
    assert_true(fabs((double)depth[12] - 5.5) < 1e-6);
  }
}

/* The step function, written once more. At a step itself the value before it holds, as in vtkPiecewiseFunction. */
static double step_at(double x, double rgb[3])
{
  rgb[0] = x <= 3 ? 1 : 0;
  rgb[1] = x > 3 && x <= 7.25 ? 1 : 0;
  rgb[2] = x > 7.25 ? 1 : 0;
  return x <= 2.5 ? 0 : x <= 4 ? .4 : x <= 7.25 ? .1 : .2;
}

/* One cell, on whose diagonal the field is a cubic that rises and falls. A million plain steps are the oracle. */
static void cubics_are_cut_at_all_their_crossings(void** state)
{
  (void)state;
  static const float cells[][8] = { { 0, 9, 8, 1, 9, 2, 3, 10 }, { 1, 6, 6, 0, 6, 0, 0, 9 }, { 10, 0, 0, 8, 0, 9, 9, 1 },
    { 3.5f, 3.5f, 3.5f, 3.5f, 3.5f, 3.5f, 3.5f, 3.5f }, { 2.4f, 2.7f, 2.7f, 2.3f, 2.7f, 2.3f, 2.3f, 2.6f } };
  const int steps = 1 << 20;
  const stratus_transfer t = step_transfer();
  const double along = 1 / sqrt(3.0);
  stratus_camera c = { .eye = { -1, -1, -1 },
    .forward = { along, along, along },
    .right = { .1, -.1, 0 },
    .up = { .05, .05, -.1 },
    .far_k = (double)INFINITY,
    .parallel = 1 };
  for (int cell = 0; cell < 5; ++cell) {
    const stratus_volume v = view(cells[cell], 2, 2, 2);
    const reference_scene scene = { .volume = &v, .transfer = &t, .camera = &c };
    double sum[3] = { 0, 0, 0 }, left = 1.0;
    for (int i = 0; i < steps; ++i) {
      const double x = (i + .5) / steps;
      double value = 0.0, rgb[3];
      for (int corner = 0; corner < 8; ++corner) {
        const int ups = (corner & 1) + (corner >> 1 & 1) + (corner >> 2);
        value += (double)cells[cell][corner] * pow(x, ups) * pow(1 - x, 3 - ups);
      }
      const double kept = 1 - pow(1 - step_at(value, rgb), sqrt(3.0) / steps);
      for (int a = 0; a < 3; ++a) {
        sum[a] += left * kept * rgb[a];
      }
      left *= 1 - kept;
    }
    for (int halvings = 0; halvings < 3; ++halvings) {
      float pixel[4];
      assert_int_equal(reference_render(&scene, 1, 1, ldexp(1.0, -halvings), pixel, NULL), 0);
      for (int channel = 0; channel < 4; ++channel) {
        assert_true(fabs((double)pixel[channel] - (channel < 3 ? sum[channel] : 1 - left)) < 3e-6);
      }
    }
  }
}

/* A dense medium whose colour changes as it becomes opaque: halving the piece changes nothing that a picture could show. */
static void dense_ramps_converge_at_once(void** state)
{
  (void)state;
  static const double opacity[] = { 0, 0, 5, .9, 6, 1, 10, 1 };
  static const double color[] = { 0, 1, 0, 0, 5, 0, 1, 0, 7, 0, 0, 1 };
  float values[5 * 5 * 11];
  float pictures[2][4 * PIXELS];
  for (int i = 0; i < 5 * 5 * 11; ++i) {
    values[i] = (float)(i / 25) + .25f * (float)((i * 7 + i / 25 * 3) % 5);
  }
  const stratus_volume v = view(values, 5, 5, 11);
  const stratus_transfer t = { .opacity = opacity, .opacity_count = 4, .color = color, .color_count = 3, .unit_distance = .5, .clamp = 1 };
  const stratus_camera c = along_z();
  const reference_scene scene = { .volume = &v, .transfer = &t, .camera = &c };
  assert_int_equal(reference_render(&scene, SIDE, SIDE, 1.0, pictures[0], NULL), 0);
  assert_int_equal(reference_render(&scene, SIDE, SIDE, 1.0 / 64, pictures[1], NULL), 0);
  assert_true(reference_psnr(pictures[0], pictures[1], PIXELS) > 90.0);
  assert_true((double)pictures[1][4 * 12 + 3] == 1.0);
}

static void holes_are_transparent(void** state)
{
  (void)state;
  float values[5 * 5 * 4];
  float rgba[4 * PIXELS];
  uint8_t ghosts[5 * 5 * 4] = { 0 };
  fill(values, 5 * 5 * 4, 10.0f);
  values[(1 * 5 + 2) * 5 + 2] = (float)NAN; /* takes cells z in 0..2 around the middle */
  stratus_volume v = view(values, 5, 5, 4);
  const stratus_transfer t = flat_transfer();
  stratus_camera c = along_z();
  c.eye[0] += 0.25; /* off the plane between two cells */
  c.eye[1] += 0.25;
  reference_scene scene = { .volume = &v, .transfer = &t, .camera = &c };
  assert_int_equal(reference_render(&scene, SIDE, SIDE, 0.01, rgba, NULL), 0);
  expect_pixel(rgba + 4 * 12, alpha_of(1.0));

  scene.interpolation = STRATUS_INTERPOLATION_NEAREST; /* only its own half voxel to either side */
  assert_int_equal(reference_render(&scene, SIDE, SIDE, 0.01, rgba, NULL), 0);
  expect_pixel(rgba + 4 * 12, alpha_of(2.0));

  scene.interpolation = STRATUS_INTERPOLATION_LINEAR;
  values[(1 * 5 + 2) * 5 + 2] = 10.0f;
  ghosts[(0 * 5 + 2) * 5 + 2] = STRATUS_GHOST_HIDDEN_POINT;
  v.point_ghosts = ghosts;
  assert_int_equal(reference_render(&scene, SIDE, SIDE, 0.01, rgba, NULL), 0);
  expect_pixel(rgba + 4 * 12, alpha_of(2.0));

  memset(ghosts, 0, sizeof ghosts);
  ghosts[(1 * 4 + 2) * 4 + 2] = STRATUS_GHOST_HIDDEN_CELL;
  v.point_ghosts = NULL;
  v.cell_ghosts = ghosts;
  assert_int_equal(reference_render(&scene, SIDE, SIDE, 0.01, rgba, NULL), 0);
  expect_pixel(rgba + 4 * 12, alpha_of(2.0));
}

static void psnr_counts_lit_pixels_only(void** state)
{
  (void)state;
  const float a[] = { 0, 0, 0, 0, 0.5f, 0.5f, 0.5f, 1.0f };
  const float b[] = { 0, 0, 0, 0, 0.5f, 0.5f, 0.5f, 0.9f };
  const float bad[] = { 0, 0, 0, 0, 0.5f, (float)NAN, 0.5f, 0.9f };
  assert_true(fabs(reference_psnr(a, b, 2) - 26.0206) < 1e-3); /* 10 log10(4 / .01) */
  assert_true(isinf(reference_psnr(a, a, 2)) && reference_psnr(a, a, 2) > 0.0);
  assert_true(isinf(reference_psnr(a, bad, 2)) && reference_psnr(a, bad, 2) < 0.0);
}

int test_reference(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(constant_slab_attenuates_by_its_length),
    cmocka_unit_test(crop_planes_and_opaque_depth_cut_the_length),
    cmocka_unit_test(ramp_integrates_the_transfer_function),
    cmocka_unit_test(vertical_steps_are_cut_where_they_are),
    cmocka_unit_test(cubics_are_cut_at_all_their_crossings),
    cmocka_unit_test(dense_ramps_converge_at_once),
    cmocka_unit_test(holes_are_transparent),
    cmocka_unit_test(psnr_counts_lit_pixels_only),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
