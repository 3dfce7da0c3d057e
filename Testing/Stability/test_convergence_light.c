/* SPDX-License-Identifier: BSD-3-Clause
 * Isosurfaces and light converge as theory says: halving the grid's cell lowers the error of places, normals and lit pictures by the
 * expected order. With each comes a method that is broken on purpose, which must fail the same judge. */
#include "convergence.h"
#include "testing.h"

#define CELLS_LEAST 12
#define CONTOUR 0.4
#define RADIUS (0.45 * (1.0 - CONTOUR))

static analytic_scene ball_of(stratus_context* context, int parallel, bool lit)
{
  analytic_scene s = { .field = field_ball, .lit = lit };
  analytic_functions(&s, analytic_band, sizeof analytic_band / sizeof *analytic_band / 2);
  analytic_view(context, &s, parallel);
  return s;
}

/* Where the ray meets the sphere of the contour, and its light there; NAN near the outline, where no order holds. */
static double meet_ball(const analytic_scene* s, const analytic_ray* r, double lag, double* light)
{
  double along = 0.0, square = 0.0, p[3];
  for (int a = 0; a < 3; ++a) {
    const double d = 0.5 - r->origin[a];
    along += d * r->along[a];
    square += d * d;
  }
  const double off = square - along * along;
  if (off > 0.64 * RADIUS * RADIUS) {
    return NAN;
  }
  const double depth = along - sqrt(RADIUS * RADIUS - off);
  for (int a = 0; a < 3; ++a) {
    p[a] = r->origin[a] + depth * r->along[a];
  }
  *light = analytic_light(s->field, p, r->along, lag);
  return depth;
}

/* The broken methods put a surface behind the first sample beyond it, and take gradients from one side. */
static void surfaces_and_their_light_have_order_2(void** state)
{
  static float rgba[4 * CONVERGENCE_PIXELS], depth[CONVERGENCE_PIXELS];
  for (int parallel = 0; parallel < 2; ++parallel) {
    double places[2][CONVERGENCE_LEVELS], lights[2][CONVERGENCE_LEVELS];
    const analytic_scene s = ball_of(*state, parallel, true);
    const double alpha = linear_between(analytic_band, 5, 2, 1, CONTOUR);
    for (int level = 0; level < CONVERGENCE_LEVELS; ++level) {
      const int cells = CELLS_LEAST << level;
      const stratus_volume volume = analytic_volume(s.field, cells, 0.0);
      stratus_ray_cast_options options = stratus_ray_cast_options_default();
      options.mode = STRATUS_MODE_ISOSURFACE;
      options.optics.contour_count = 1;
      options.optics.contours[0] = CONTOUR;
      options.light.shade = 1;
      options.light.shading.ambient = 0.3;
      options.light.shading.diffuse = 0.7;
      analytic_draw(*state, &s, &volume, &options, CONVERGENCE_SIDE, rgba, depth);
      double squares[4] = { 0.0 };
      int count = 0;
      for (int i = 0; i < CONVERGENCE_PIXELS; ++i) {
        const int row = i / CONVERGENCE_SIDE;
        const analytic_ray r = analytic_ray_at(
          &s.camera, (2.0 * (i % CONVERGENCE_SIDE) + 1.0) / CONVERGENCE_SIDE - 1.0, (2.0 * row + 1.0) / CONVERGENCE_SIDE - 1.0);
        double light, lagging;
        const double place = meet_ball(&s, &r, 0.0, &light);
        if (isnan(place)) {
          continue;
        }
        (void)meet_ball(&s, &r, 1.0 / cells, &lagging);
        const double behind = ceil(place * cells) / cells;
        /* the far side of a sphere is lit as the near side: a + (1 - a) a of both */
        const double red = alpha * (2.0 - alpha) * linear_between(analytic_color, 3, 4, 1, CONTOUR);
        squares[0] += ((double)depth[i] - place) * ((double)depth[i] - place);
        squares[1] += (behind - place) * (behind - place);
        squares[2] += ((double)rgba[4 * i] - red * light) * ((double)rgba[4 * i] - red * light);
        squares[3] += red * red * (lagging - light) * (lagging - light);
        ++count;
      }
      assert_true(count > 50);
      for (int broken = 0; broken < 2; ++broken) {
        places[broken][level] = sqrt(squares[broken] / count);
        lights[broken][level] = sqrt(squares[2 + broken] / count);
      }
      free((void*)volume.values);
    }
    convergence_judge("places of a surface", places[0], 2.0, "the first sample behind it", places[1]);
    convergence_judge("light of a surface", lights[0], 2.0, "gradients from one side", lights[1]);
  }
}

static void lit_samples_have_order_2(void** state)
{
  static float rgba[4 * CONVERGENCE_PIXELS];
  static double truth[4 * CONVERGENCE_PIXELS], lagging[4 * CONVERGENCE_PIXELS];
  for (int rule = 0; rule < 2; ++rule) {
    double errors[CONVERGENCE_LEVELS], worse[CONVERGENCE_LEVELS];
    const analytic_scene s = ball_of(*state, 0, true);
    analytic_render(&s, CONVERGENCE_SIDE, 0.5, 0.0, 0.0, truth);
    for (int level = 0; level < CONVERGENCE_LEVELS; ++level) {
      const int cells = CELLS_LEAST << level;
      const stratus_volume volume = analytic_volume(s.field, cells, 0.0);
      stratus_ray_cast_options options = stratus_ray_cast_options_default();
      options.sampling.rule = rule ? STRATUS_SAMPLING_PREINTEGRATED : STRATUS_SAMPLING_MIDPOINT;
      options.sampling.distance = 1.0 / 1024;
      options.sampling.termination = 1.0;
      options.light.shade = 1;
      options.light.shading.ambient = 0.3;
      options.light.shading.diffuse = 0.7;
      analytic_draw(*state, &s, &volume, &options, CONVERGENCE_SIDE, rgba, NULL);
      errors[level] = convergence_rms(rgba, truth, 4 * CONVERGENCE_PIXELS);
      analytic_render(&s, CONVERGENCE_SIDE, 0.5, 0.0, 1.0 / cells, lagging);
      worse[level] = convergence_rms_double(lagging, truth, 4 * CONVERGENCE_PIXELS);
      free((void*)volume.values);
    }
    convergence_judge(rule ? "lit, pre-integrated" : "lit, midpoint", errors, 2.0, "gradients from one side", worse);
  }
}

int test_convergence_light(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(surfaces_and_their_light_have_order_2),
    cmocka_unit_test(lit_samples_have_order_2),
  };
  return cmocka_run_group_tests(tests, convergence_start, convergence_stop);
}
