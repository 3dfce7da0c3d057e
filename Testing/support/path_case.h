/* SPDX-License-Identifier: BSD-3-Clause
 * Homogeneous slabs and boxes for the path tracer, whose light is known in closed form or by other methods. */
#ifndef STRATUS_TESTING_PATH_CASE_H
#define STRATUS_TESTING_PATH_CASE_H

#include "picture_case.h"
#include "testing.h"

#define PATH_SIDE 8 /* of the picture; all pixels of a slab expect the same light */
#define PATH_PIXELS (PATH_SIDE * PATH_SIDE)
#define PATH_WIDE 1e4   /* width of a slab of thickness 1 */
#define PATH_SIGMAS 4.0 /* of the standard error; seeds are fixed, so that a test that passes always passes */

typedef struct path_case {
  stratus_volume volume;
  stratus_transfer transfer;
  stratus_camera camera;
  stratus_path_options options;
  double values[8 * 8 * 32], opacity[8], color[4];
  const float* opaque_depth;
} path_case;

typedef struct path_mean {
  double rgba[4], error[4]; /* means over the pixels, and their standard errors */
  stratus_path_report report;
} path_mean;

/* Samples of a pixel: four times as many where not few are enough. */
static inline int path_samples(int few)
{
  return few_run() ? few : 4 * few;
}

/* Looks along `direction` at the point `at`, from `away` of it. Rays are parallel and within a thousandth of `away`. */
static inline void path_look(stratus_context* context, path_case* c, const double direction[3], const double at[3], double away)
{
  double eye[3];
  const double up[3] = { fabs(direction[2]) > 0.5 * sqrt(direction[0] * direction[0] + direction[1] * direction[1]), 0.3, 1.0 };
  const double length = sqrt(direction[0] * direction[0] + direction[1] * direction[1] + direction[2] * direction[2]);
  for (int a = 0; a < 3; ++a) {
    eye[a] = at[a] - away * direction[a] / length;
  }
  assert_int_equal(stratus_camera_parallel(context, eye, at, up, 1e-3 * away, 1.0, &c->camera), STRATUS_OK);
}

/* Makes a slab of extinction `sigma` per length, between z = 0 and `thick`. It has 2 x 2 x `layers` values, all 1, and is white. */
static inline void path_slab(stratus_context* context, path_case* c, double sigma, double thick, int layers)
{
  static const double down[3] = { 0, 0, -1 };
  memset(c, 0, sizeof *c);
  c->volume = stratus_volume_default();
  c->volume.values = c->values;
  c->volume.type = STRATUS_FLOAT64;
  const int64_t n[3] = { 2, 2, layers };
  for (int a = 0; a < 3; ++a) {
    c->volume.dimensions[a] = n[a];
    c->volume.spacing[a] = a < 2 ? PATH_WIDE * thick : thick / (layers - 1);
    c->volume.origin[a] = a < 2 ? -0.5 * PATH_WIDE * thick : 0.0;
  }
  for (int i = 0; i < 4 * layers; ++i) {
    c->values[i] = 1.0;
  }
  c->opacity[0] = 1.0;
  c->opacity[1] = -expm1(-1.0);
  c->color[1] = c->color[2] = c->color[3] = 1.0;
  c->transfer = stratus_transfer_default();
  c->transfer.opacity = c->opacity;
  c->transfer.opacity_count = 1;
  c->transfer.color = c->color;
  c->transfer.color_count = 1;
  c->transfer.unit_distance = 1.0 / sigma;
  c->options = stratus_path_options_default();
  c->options.light_count = 0;
  path_look(context, c, down, (double[3]){ 0, 0, 0.5 * thick }, 10.0 * thick);
}

/* Sets one directional light of radiance 1 whose direction has this cosine to the slab's normal; negative: from below. */
static inline void path_sun(path_case* c, double cosine)
{
  c->options.light_count = 1;
  c->options.lights[0] = (stratus_light){ .vector = { sqrt(1.0 - cosine * cosine), 0.0, cosine }, .color = { 1, 1, 1 } };
}

/* Draws into rgba and errors, floats of PATH_PIXELS pixels. */
static inline void path_draw_into(stratus_context* context, const path_case* c, float* rgba, float* errors, stratus_path_report* report)
{
  stratus_path_tracer* tracer = NULL;
  const stratus_image image = { .width = PATH_SIDE, .height = PATH_SIDE, .rgba = rgba, .opaque_depth = c->opaque_depth };
  assert_int_equal(stratus_path_tracer_create(context, &tracer), STRATUS_OK);
  const stratus_status status = stratus_path_tracer_render(tracer, &c->volume, &c->transfer, &c->camera, &c->options, &image, report);
  if (status != STRATUS_OK) {
    fail_msg("%s", stratus_context_message(context));
  }
  assert_int_equal(stratus_path_tracer_errors(tracer, errors), STRATUS_OK);
  stratus_path_tracer_destroy(tracer);
}

static inline path_mean path_draw(stratus_context* context, const path_case* c)
{
  float rgba[4 * PATH_PIXELS], errors[4 * PATH_PIXELS];
  path_mean mean = { .rgba = { 0.0 } };
  path_draw_into(context, c, rgba, errors, &mean.report);
  for (int i = 0; i < 4 * PATH_PIXELS; ++i) {
    mean.rgba[i % 4] += (double)rgba[i] / PATH_PIXELS;
    mean.error[i % 4] += (double)errors[i] * (double)errors[i] / PATH_PIXELS / PATH_PIXELS;
  }
  for (int i = 0; i < 4; ++i) {
    mean.error[i] = sqrt(mean.error[i]);
  }
  return mean;
}

/* Asserts that a mean is the expected one within its standard error, which is at most the fraction `fine` of it. */
static inline void path_assert(const char* what, double expected, double found, double error, double fine)
{
  print_message("             %-46s expected %.6f found %.6f +- %.6f (%+.2f)\n", what, expected, found, error,
    error > 0.0 ? (found - expected) / error : 0.0);
  assert_true(error > 0.0 && error <= fine * expected);
  assert_true(fabs(found - expected) <= PATH_SIGMAS * error);
}

#endif
