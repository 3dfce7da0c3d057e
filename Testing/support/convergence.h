/* SPDX-License-Identifier: BSD-3-Clause
 * Orders of convergence, after Etiene et al. 2014, "Verifying Volume Rendering Using Discretization Error Analysis": a length is halved
 * again and again, and the error against an analytic field falls by a power of it that theory names. A wrong weight, place or normal shows
 * as a wrong power long before it shows in a picture. The analytic picture is integrated here in double precision, without a grid. */
#ifndef STRATUS_TESTING_CONVERGENCE_H
#define STRATUS_TESTING_CONVERGENCE_H

#include "linear_between.h"
#include "stratus.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define CONVERGENCE_LEVELS 4
/* Errors are C h^p (1 + O(h)). Over three halvings the terms behind the first bend the fitted slope by less than .25 in all cases here, and
 * the next order that a mistake can give is p - 1/2: an error of size h on a share h of the rays. */
#define CONVERGENCE_BAND 0.25
#define CONVERGENCE_SIDE 24
#define CONVERGENCE_PIXELS (CONVERGENCE_SIDE * CONVERGENCE_SIDE)
#define CONVERGENCE_PIECES 2048 /* of an analytic ray: its error is below 1e-6 */

typedef double (*analytic_field)(const double p[3]);

/* A scene in the unit cube, without a grid. */
typedef struct analytic_scene {
  analytic_field field;
  stratus_transfer transfer;
  stratus_camera camera;
  bool lit; /* by a light at the eye: ambient .3, diffuse .7 */
} analytic_scene;

/* Values 0..1: ramps with sharp kinks, so that errors stand out from the rounding of values to a table's entries; colours that change. */
static const double analytic_ramp[] = { 0.0, 0.0, 0.3, 0.0, 0.4, 0.5, 0.55, 0.1, 1.0, 0.6 };
static const double analytic_color[] = { 0.0, 0.1, 0.3, 0.9, 0.5, 0.9, 0.7, 0.2, 1.0, 1.0, 0.1, 0.3 };
/* A band, which keeps away from where the fields here have a kink and from the grid's border. */
static const double analytic_band[] = { 0.0, 0.0, 0.2, 0.0, 0.4, 0.5, 0.6, 0.0, 1.0, 0.0 };

/* A product of coordinates: trilinear, so that every grid has it exactly, and a cubic along a ray. */
static inline double field_product(const double p[3])
{
  return (0.2 + 0.8 * p[0]) * (0.3 + 0.7 * p[1]) * (1.0 - 0.5 * p[2]);
}

/* Curved everywhere, so that no grid has it exactly. */
static inline double field_waves(const double p[3])
{
  return 0.5 + 0.22 * sin(2.9 * p[0] + 1.7 * p[1] + 0.4) + 0.22 * cos(2.3 * p[2] - 1.9 * p[1] + 0.3);
}

/* The distance from the middle. */
static inline double field_ball(const double p[3])
{
  const double x = p[0] - 0.5, y = p[1] - 0.5, z = p[2] - 0.5;
  return 1.0 - sqrt(x * x + y * y + z * z) / 0.45;
}

/* The ray through u, v in -1..1, of a direction of length 1, and its part within the unit cube; from > to where it misses it. */
typedef struct analytic_ray {
  double origin[3], along[3], from, to;
} analytic_ray;

static inline analytic_ray analytic_ray_at(const stratus_camera* k, double u, double v)
{
  analytic_ray r = { .from = 0.0, .to = INFINITY };
  double length = 0.0;
  for (int a = 0; a < 3; ++a) {
    const double side = u * k->right[a] + v * k->up[a];
    r.origin[a] = k->eye[a] + (k->parallel ? side : 0.0);
    r.along[a] = k->forward[a] + (k->parallel ? 0.0 : side);
    length += r.along[a] * r.along[a];
  }
  for (int a = 0; a < 3; ++a) {
    r.along[a] /= sqrt(length);
    const double lo = -r.origin[a] / r.along[a], hi = (1.0 - r.origin[a]) / r.along[a];
    r.from = fmax(r.from, fmin(lo, hi));
    r.to = fmin(r.to, fmax(lo, hi));
  }
  return r;
}

/* The light that a surface across the field's gradient sends to the eye, of 1. `lag`: 0 for the gradient itself, else the length of a
 * one-sided difference. */
static inline double analytic_light(analytic_field field, const double p[3], const double along[3], double lag)
{
  double gradient[3], square = 0.0, cosine = 0.0;
  for (int a = 0; a < 3; ++a) {
    const double step = lag > 0.0 ? lag : 1e-5;
    double front[3] = { p[0], p[1], p[2] }, back[3] = { p[0], p[1], p[2] };
    front[a] += step;
    back[a] -= lag > 0.0 ? 0.0 : step;
    gradient[a] = (field(front) - field(back)) / (front[a] - back[a]);
    square += gradient[a] * gradient[a];
    cosine += gradient[a] * along[a];
  }
  return 0.3 + 0.7 * fabs(cosine) / sqrt(square);
}

/* Integrates a ray by `pieces` equal ones, of which each takes the field at its part `at`: .5 is the midpoint rule, 0 the rule of left
 * ends, whose order is 1. */
static inline void analytic_integrate(const analytic_scene* s, const analytic_ray* r, int pieces, double at, double lag, double rgba[4])
{
  const stratus_transfer* t = &s->transfer;
  const double h = (r->to - r->from) / pieces;
  memset(rgba, 0, 4 * sizeof *rgba);
  for (int i = 0; i < pieces && r->from < r->to; ++i) {
    double p[3];
    for (int a = 0; a < 3; ++a) {
      p[a] = r->origin[a] + (r->from + (i + at) * h) * r->along[a];
    }
    const double x = s->field(p), opacity = linear_between(t->opacity, t->opacity_count, 2, 1, x);
    if (opacity == 0.0) {
      continue;
    }
    const double alpha = -expm1(log1p(-opacity) * h / t->unit_distance), light = s->lit ? analytic_light(s->field, p, r->along, lag) : 1.0;
    for (size_t c = 0; c < 3; ++c) {
      rgba[c] += (1.0 - rgba[3]) * alpha * light * linear_between(t->color, t->color_count, 4, c + 1, x);
    }
    rgba[3] += (1.0 - rgba[3]) * alpha;
  }
}

/* Draws side*side pixels, through points `at` of each: .5 is the pixel's middle. step: 0 for the picture itself, else the length of pieces
 * that are taken at their left ends. lag: as in analytic_light(). */
static inline void analytic_render(const analytic_scene* s, int side, double at, double step, double lag, double* rgba)
{
  for (int i = 0; i < side * side; ++i) {
    const int row = i / side;
    const double u = 2.0 * (i % side + at) / side - 1.0, v = 2.0 * (row + at) / side - 1.0;
    const analytic_ray r = analytic_ray_at(&s->camera, u, v);
    const int pieces = step > 0.0 ? (int)ceil(fmax(r.to - r.from, 0.0) / step) : CONVERGENCE_PIECES;
    analytic_integrate(s, &r, pieces, step > 0.0 ? 0.0 : 0.5, lag, rgba + 4 * (size_t)i);
  }
}

/* Sets the functions: points, number of points. */
static inline void analytic_functions(analytic_scene* s, const double* opacity, size_t count)
{
  s->transfer = stratus_transfer_default();
  s->transfer.opacity = opacity;
  s->transfer.opacity_count = count;
  s->transfer.color = analytic_color;
  s->transfer.color_count = 3;
  s->transfer.unit_distance = 0.2;
}

/* Views from a corner along no axis. */
static inline void analytic_view(stratus_context* context, analytic_scene* s, int parallel)
{
  const double eye[3] = { 2.1, 1.7, 2.6 }, focal[3] = { 0.5, 0.5, 0.5 }, up[3] = { 0.1, 1.0, 0.2 };
  const stratus_status status = parallel ? stratus_camera_parallel(context, eye, focal, up, 0.6, 1.0, &s->camera)
                                         : stratus_camera_perspective(context, eye, focal, up, 25.0, 1.0, &s->camera);
  assert_int_equal(status, STRATUS_OK);
}

/* The volume of n^3 cells of the field in the unit cube. shift: 0, or how far off the values are, in cells. The caller frees volume.values.
 */
static inline stratus_volume analytic_volume(analytic_field field, int n, double shift)
{
  const int side = n + 1;
  float* values = malloc((size_t)side * (size_t)side * (size_t)side * sizeof *values);
  stratus_volume volume = stratus_volume_default();
  assert_non_null(values);
  for (int i = 0; i < side * side * side; ++i) {
    const int at[3] = { i % side, i / side % side, i / side / side };
    const double p[3] = { (at[0] + shift) / n, (at[1] + shift) / n, (at[2] + shift) / n };
    values[i] = (float)field(p);
  }
  volume.values = values;
  volume.type = STRATUS_FLOAT32;
  for (int a = 0; a < 3; ++a) {
    volume.dimensions[a] = side;
    volume.spacing[a] = 1.0 / n;
  }
  return volume;
}

static inline void analytic_draw(stratus_context* context, const analytic_scene* s, const stratus_volume* volume,
  const stratus_ray_cast_options* options, int side, float* rgba, float* depth)
{
  stratus_ray_caster* caster = NULL;
  const stratus_image image = { .width = side, .height = side, .rgba = rgba, .depth = depth };
  assert_int_equal(stratus_ray_caster_create(context, &caster), STRATUS_OK);
  if (stratus_ray_caster_render(caster, volume, &s->transfer, &s->camera, options, &image, NULL) != STRATUS_OK) {
    fail_msg("%s", stratus_context_message(context));
  }
  stratus_ray_caster_destroy(caster);
}

static inline double convergence_rms(const float* rgba, const double* truth, size_t count)
{
  double squares = 0.0;
  for (size_t i = 0; i < count; ++i) {
    const double d = (double)rgba[i] - truth[i];
    squares += d * d;
  }
  return sqrt(squares / (double)count);
}

static inline double convergence_rms_double(const double* rgba, const double* truth, size_t count)
{
  double squares = 0.0;
  for (size_t i = 0; i < count; ++i) {
    squares += (rgba[i] - truth[i]) * (rgba[i] - truth[i]);
  }
  return sqrt(squares / (double)count);
}

/* The slope of the line of least squares through the logarithms of errors at lengths that halve. */
static inline double convergence_slope(const char* what, const double errors[CONVERGENCE_LEVELS])
{
  double slope = 0.0, squares = 0.0;
  for (int i = 0; i < CONVERGENCE_LEVELS; ++i) {
    const double x = 0.5 * (CONVERGENCE_LEVELS - 1) - i;
    slope += x * log2(errors[i]);
    squares += x * x;
  }
  slope /= squares;
  print_message("             %s: order %.2f, errors", what, slope);
  for (int i = 0; i < CONVERGENCE_LEVELS; ++i) {
    print_message(" %.2e", errors[i]);
  }
  print_message("\n");
  return slope;
}

static inline bool convergence_holds(double slope, double order)
{
  return fabs(slope - order) <= CONVERGENCE_BAND; /* false for NaN */
}

/* Fails unless the errors fall as theory says, and unless the errors of a method that is broken on purpose fall otherwise. */
static inline void convergence_judge(const char* what, const double errors[], double order, const char* broken, const double worse[])
{
  const double slope = convergence_slope(what, errors), other = convergence_slope(broken, worse);
  if (!convergence_holds(slope, order)) {
    fail_msg("%s: order %.2f, not %g", what, slope, order);
  }
  if (convergence_holds(other, order)) {
    fail_msg("%s: order %.2f is too close to %g for the test", broken, other, order);
  }
}

/* Set-up and tear-down of a group whose state is a context of the host with two threads. */
static inline int convergence_start(void** state)
{
  stratus_context_options options = stratus_context_options_default();
  stratus_context* context = NULL;
  options.device = "host";
  options.threads = 2;
  const stratus_status status = stratus_context_create(&options, &context, NULL, 0);
  *state = context;
  return status == STRATUS_OK ? 0 : -1;
}

static inline int convergence_stop(void** state)
{
  stratus_context_destroy(*state);
  return 0;
}

#endif
