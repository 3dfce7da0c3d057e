/* SPDX-License-Identifier: BSD-3-Clause
 * Volumes converge as theory says: halving the step, the piece of a cell, the grid's cell, the pixel and the table's entry lowers the error
 * against analytic fields by the expected order. With each comes a method that is broken on purpose, which must fail the same judge. */
#include "convergence.h"
#include "testing.h"
#include "volume.h"

#define STEP_COARSEST 0.25 /* of the cube's edge: a ray of length 1 has 4 samples, then 8, 16 and 32 */
#define SIDE_LEAST 8       /* pixels along each side of the coarsest picture */

static analytic_scene scene_of(stratus_context* context, analytic_field field, int parallel)
{
  analytic_scene s = { .field = field };
  analytic_functions(&s, analytic_ramp, sizeof analytic_ramp / sizeof *analytic_ramp / 2);
  analytic_view(context, &s, parallel);
  return s;
}

static stratus_ray_cast_options options_of(stratus_sampling sampling, double step)
{
  stratus_ray_cast_options options = stratus_ray_cast_options_default();
  options.sampling.rule = sampling;
  options.sampling.distance = step;
  options.sampling.termination = 1.0;
  return options;
}

/* Draws the product, which grids hold exactly, so that only the step errs. The broken method samples each segment at its front. */
static void judge_steps(stratus_context* context, stratus_sampling sampling, const char* what)
{
  static float rgba[4 * CONVERGENCE_PIXELS];
  static double truth[4 * CONVERGENCE_PIXELS], front[4 * CONVERGENCE_PIXELS];
  for (int parallel = 0; parallel < 2; ++parallel) {
    double errors[CONVERGENCE_LEVELS], worse[CONVERGENCE_LEVELS];
    const analytic_scene s = scene_of(context, field_product, parallel);
    const stratus_volume volume = analytic_volume(s.field, 8, 0.0);
    analytic_render(&s, CONVERGENCE_SIDE, 0.5, 0.0, 0.0, truth);
    for (int level = 0; level < CONVERGENCE_LEVELS; ++level) {
      const double step = STEP_COARSEST / (1 << level);
      const stratus_ray_cast_options options = options_of(sampling, step);
      analytic_draw(context, &s, &volume, &options, CONVERGENCE_SIDE, rgba, NULL);
      errors[level] = convergence_rms(rgba, truth, 4 * CONVERGENCE_PIXELS);
      analytic_render(&s, CONVERGENCE_SIDE, 0.5, step, 0.0, front);
      worse[level] = convergence_rms_double(front, truth, 4 * CONVERGENCE_PIXELS);
    }
    free((void*)volume.values);
    convergence_judge(what, errors, 2.0, "segments taken at their fronts", worse);
  }
}

static void midpoint_steps_have_order_2(void** state)
{
  judge_steps(*state, STRATUS_SAMPLING_MIDPOINT, "midpoint, by steps");
}

static void preintegrated_steps_have_order_2(void** state)
{
  judge_steps(*state, STRATUS_SAMPLING_PREINTEGRATED, "pre-integrated, by steps");
}

/* A piece departs from a straight line by its curvature times the square of its length, so that the error falls with the allowed
 * departure. */
static void pieces_of_cells_have_order_1_in_the_allowed_departure(void** state)
{
  static float rgba[4 * CONVERGENCE_PIXELS];
  static double truth[4 * CONVERGENCE_PIXELS];
  double errors[CONVERGENCE_LEVELS], worse[CONVERGENCE_LEVELS];
  analytic_scene s = scene_of(*state, field_product, 0);
  s.transfer.color_count = 1;                                     /* where colours change, pieces are cut for that, too */
  const stratus_volume volume = analytic_volume(s.field, 1, 0.0); /* one cell: all curvature is within it */
  analytic_render(&s, CONVERGENCE_SIDE, 0.5, 0.0, 0.0, truth);
  for (int level = 0; level < CONVERGENCE_LEVELS; ++level) {
    stratus_ray_cast_options options = options_of(STRATUS_SAMPLING_CELLS, 0.0);
    options.sampling.cell_error = 0.02 / (1 << level);
    analytic_draw(*state, &s, &volume, &options, CONVERGENCE_SIDE, rgba, NULL);
    errors[level] = convergence_rms(rgba, truth, 4 * CONVERGENCE_PIXELS);
    options.sampling.cell_error = 0.02; /* a rule that ignores the allowed departure */
    analytic_draw(*state, &s, &volume, &options, CONVERGENCE_SIDE, rgba, NULL);
    worse[level] = convergence_rms(rgba, truth, 4 * CONVERGENCE_PIXELS);
  }
  free((void*)volume.values);
  convergence_judge("cells, by the allowed departure", errors, 1.0, "pieces that do not change", worse);
}

/* Trilinear interpolation errs by the square of a cell. The broken method has its values half a cell off, as one that takes values of cells
 * for values of points. */
static void grid_cells_have_order_2(void** state)
{
  static float rgba[4 * CONVERGENCE_PIXELS];
  static double truth[4 * CONVERGENCE_PIXELS];
  static const stratus_sampling rules[] = { STRATUS_SAMPLING_MIDPOINT, STRATUS_SAMPLING_PREINTEGRATED, STRATUS_SAMPLING_CELLS };
  const analytic_scene s = scene_of(*state, field_waves, 0);
  analytic_render(&s, CONVERGENCE_SIDE, 0.5, 0.0, 0.0, truth);
  for (int rule = 0; rule < 3; ++rule) {
    double errors[CONVERGENCE_LEVELS], worse[CONVERGENCE_LEVELS];
    for (int level = 0; level < CONVERGENCE_LEVELS; ++level) {
      for (int broken = 0; broken < 2; ++broken) {
        const stratus_volume volume = analytic_volume(s.field, 4 << level, 0.5 * broken);
        stratus_ray_cast_options options = options_of(rules[rule], rules[rule] == STRATUS_SAMPLING_CELLS ? 0.0 : 1.0 / 512);
        options.sampling.cell_error = 1e-5;
        analytic_draw(*state, &s, &volume, &options, CONVERGENCE_SIDE, rgba, NULL);
        (broken ? worse : errors)[level] = convergence_rms(rgba, truth, 4 * CONVERGENCE_PIXELS);
        free((void*)volume.values);
      }
    }
    convergence_judge(stratus_sampling_name(rules[rule]), errors, 2.0, "values half a cell off", worse);
  }
}

/* Between the middles of pixels a picture is interpolated, at places that stay the same. The broken method sends rays through corners. */
static void pixels_have_order_2(void** state)
{
  enum { PLACES = 500, MOST = SIDE_LEAST << (CONVERGENCE_LEVELS - 1) };
  static float rgba[4 * MOST * MOST];
  static double truth[4 * PLACES], drawn[4 * PLACES], corners[4 * MOST * MOST];
  double errors[2][CONVERGENCE_LEVELS];
  analytic_scene s = scene_of(*state, field_waves, 1);
  const double eye[3] = { 0.5, 0.5, 3.0 }, focal[3] = { 0.5, 0.5, 0.5 }, up[3] = { 0.0, 1.0, 0.0 };
  assert_int_equal(stratus_camera_parallel(*state, eye, focal, up, 0.45, 1.0, &s.camera), STRATUS_OK); /* no outline in the picture */
  const stratus_volume volume = analytic_volume(s.field, 128, 0.0);
  const stratus_ray_cast_options options = options_of(STRATUS_SAMPLING_MIDPOINT, 1.0 / 512);
  for (int level = 0; level < CONVERGENCE_LEVELS; ++level) {
    const int side = SIDE_LEAST << level;
    analytic_draw(*state, &s, &volume, &options, side, rgba, NULL);
    analytic_render(&s, side, 0.0, 0.0, 0.0, corners);
    for (int broken = 0; broken < 2; ++broken) {
      uint32_t random = 1;
      for (int i = 0; i < PLACES; ++i) {
        double place[2], part[2], *out = drawn + 4 * (size_t)i;
        int first[2];
        for (int a = 0; a < 2; ++a) {
          random = random * 1664525u + 1013904223u;
          place[a] = 0.8 * (2.0 * (double)(random >> 8) / 16777216.0 - 1.0);
          const double pixel = 0.5 * (place[a] + 1.0) * side - 0.5;
          first[a] = (int)pixel;
          part[a] = pixel - first[a];
        }
        for (size_t c = 0; c < 4; ++c) {
          out[c] = 0.0;
          for (int k = 0; k < 4; ++k) {
            const size_t at = 4 * (size_t)((first[1] + k / 2) * side + first[0] + k % 2) + c;
            out[c] += (k % 2 ? part[0] : 1.0 - part[0]) * (k / 2 ? part[1] : 1.0 - part[1]) * (broken ? corners[at] : (double)rgba[at]);
          }
        }
        if (level == 0 && !broken) {
          const analytic_ray r = analytic_ray_at(&s.camera, place[0], place[1]);
          analytic_integrate(&s, &r, CONVERGENCE_PIECES, 0.5, 0.0, truth + 4 * (size_t)i);
        }
      }
      errors[broken][level] = convergence_rms_double(drawn, truth, 4 * PLACES);
    }
  }
  free((void*)volume.values);
  convergence_judge("pixels", errors[0], 2.0, "rays through the corners of pixels", errors[1]);
}

/* The integral of a function over all values, by the table's entries: an entry at its middle errs only where the function has a kink, by
 * the square of its width. Entries taken at their lower ends err everywhere. */
static void entries_of_tables_have_order_2(void** state)
{
  enum { FUNCTIONS = 40, PLACES = 1 << 18 };
  for (int preintegrated = 0; preintegrated < 2; ++preintegrated) {
    double squares[2][CONVERGENCE_LEVELS] = { { 0.0 } };
    uint32_t random = 3;
    for (int f = 0; f < FUNCTIONS; ++f) {
      double opacity[8] = { 0.0, 0.01 };
      for (int i = 1; i < 4; ++i) {
        random = random * 1664525u + 1013904223u;
        opacity[2 * i] = i < 3 ? 0.15 + 0.4 * (i - 1) + 0.3 * (double)(random >> 8) / 16777216.0 : 1.0;
        random = random * 1664525u + 1013904223u;
        opacity[2 * i + 1] = 0.01 + 0.9 * (double)(random >> 8) / 16777216.0;
      }
      stratus_transfer t = stratus_transfer_default();
      t.opacity = opacity;
      t.opacity_count = 4;
      t.color = analytic_color;
      t.color_count = 3;
      double truth = 0.0;
      for (int i = 0; i < PLACES; ++i) {
        truth += -log1p(-linear_between(opacity, 4, 2, 1, (i + 0.5) / PLACES)) / PLACES;
      }
      for (int level = 0; level < CONVERGENCE_LEVELS; ++level) {
        const stratus_table_values values = { .lo = 0.0f, .hi = 1.0f };
        stratus_table* table = NULL;
        const stratus_sampling sampling = preintegrated ? STRATUS_SAMPLING_PREINTEGRATED : STRATUS_SAMPLING_MIDPOINT;
        assert_int_equal(stratus_table_create_fine(*state, &t, &values, sampling, 1.0, 256 << level, &table), STRATUS_OK);
        assert_null(table->first); /* entries are cells */
        double sum = 0.0, lower = 0.0;
        for (int i = 0; i < PLACES; ++i) {
          const double x = (i + 0.5) / PLACES;
          const int entry = stratus_table_entry(table, (float)x);
          const double left = ((double)entry - (double)table->offset) / (double)table->scale;
          lower += -log1p(-linear_between(opacity, 4, 2, 1, left)) / PLACES;
          sum += (table->rgba ? (double)table->rgba[4 * (table->size + entry)]
                              : (table->sums[4 * (entry + 1) + 3] - table->sums[4 * entry + 3]) * table->tau_per_sum) /
            PLACES;
        }
        squares[0][level] += (sum - truth) * (sum - truth) / FUNCTIONS;
        squares[1][level] += (lower - truth) * (lower - truth) / FUNCTIONS;
        stratus_table_destroy(table);
      }
    }
    for (int level = 0; level < CONVERGENCE_LEVELS; ++level) {
      squares[0][level] = sqrt(squares[0][level]);
      squares[1][level] = sqrt(squares[1][level]);
    }
    convergence_judge(preintegrated ? "sums of entries" : "entries", squares[0], 2.0, "entries at their lower ends", squares[1]);
  }
}

int test_convergence(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(midpoint_steps_have_order_2),
    cmocka_unit_test(preintegrated_steps_have_order_2),
    cmocka_unit_test(pieces_of_cells_have_order_1_in_the_allowed_departure),
    cmocka_unit_test(grid_cells_have_order_2),
    cmocka_unit_test(pixels_have_order_2),
    cmocka_unit_test(entries_of_tables_have_order_2),
  };
  return cmocka_run_group_tests(tests, convergence_start, convergence_stop);
}
