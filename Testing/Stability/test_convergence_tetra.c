/* SPDX-License-Identifier: BSD-3-Clause
 * Tetrahedra converge as theory says: halving the edges of a mesh lowers the error against an analytic field by the expected order, by
 * either method. With them comes a mesh that is broken on purpose, which must fail the same judge. */
#include "convergence.h"
#include "testing.h"

#define BOXES_LEAST 2 /* along an edge of the cube, six cells each */

typedef struct cube_mesh {
  stratus_mesh mesh;
  double* points;
  int32_t* vertices;
  float* values;
} cube_mesh;

/* n^3 boxes of six cells each about the box's diagonal in the unit cube. constant: a cell's value is its first corner's. */
static cube_mesh cube_of(analytic_field field, int n, bool constant)
{
  static const int path[6][2] = { { 0, 1 }, { 0, 2 }, { 1, 0 }, { 1, 2 }, { 2, 0 }, { 2, 1 } };
  const int side = n + 1, step[3] = { 1, side, side * side };
  const size_t points = (size_t)side * (size_t)side * (size_t)side, cells = 6 * (size_t)n * (size_t)n * (size_t)n;
  cube_mesh c = { .mesh = stratus_mesh_default() };
  c.points = malloc(points * 3 * sizeof *c.points);
  c.vertices = malloc(cells * 4 * sizeof *c.vertices);
  c.values = malloc((points + cells) * sizeof *c.values);
  assert_true(c.points && c.vertices && c.values);
  for (int i = 0; i < (int)points; ++i) {
    const int at[3] = { i % side, i / side % side, i / side / side };
    for (int a = 0; a < 3; ++a) {
      c.points[3 * i + a] = (double)at[a] / n;
    }
    c.values[i] = (float)field(c.points + 3 * (size_t)i);
  }
  int32_t* v = c.vertices;
  for (int box = 0; box < n * n * n; ++box) {
    const int corner = box % n + box / n % n * side + box / n / n * step[2];
    for (int t = 0; t < 6; ++t, v += 4) {
      v[0] = corner;
      v[1] = corner + step[path[t][0]];
      v[2] = v[1] + step[path[t][1]];
      v[3] = corner + 1 + side + step[2];
      if (constant) {
        c.values[(v - c.vertices) / 4] = (float)field(c.points + 3 * (size_t)corner);
      }
    }
  }
  c.mesh.points = c.points;
  c.mesh.point_count = (int64_t)points;
  c.mesh.vertices = c.vertices;
  c.mesh.cell_count = (int64_t)cells;
  c.mesh.values = c.values;
  c.mesh.type = STRATUS_FLOAT32;
  c.mesh.cell_values = constant;
  return c;
}

static double error_of(
  stratus_context* context, const analytic_scene* s, const cube_mesh* c, stratus_tetra_method method, const double* truth)
{
  static float rgba[4 * CONVERGENCE_PIXELS];
  const stratus_image image = { .width = CONVERGENCE_SIDE, .height = CONVERGENCE_SIDE, .rgba = rgba };
  stratus_tetra_caster* caster = NULL;
  stratus_tetra_options options = stratus_tetra_options_default();
  options.method = method;
  options.tolerance = 0.0;
  options.termination = 1.0;
  assert_int_equal(stratus_tetra_caster_create(context, &caster), STRATUS_OK);
  if (stratus_tetra_caster_render(caster, &c->mesh, &s->transfer, &s->camera, &options, &image, NULL) != STRATUS_OK) {
    fail_msg("%s", stratus_context_message(context));
  }
  stratus_tetra_caster_destroy(caster);
  return convergence_rms(rgba, truth, 4 * CONVERGENCE_PIXELS);
}

static void cells_have_order_2(void** state)
{
  static double truth[4 * CONVERGENCE_PIXELS];
  static const stratus_tetra_method methods[] = { STRATUS_TETRA_METHOD_MARCH, STRATUS_TETRA_METHOD_PROJECT };
  for (int parallel = 0; parallel < 2; ++parallel) {
    analytic_scene s = { .field = field_waves };
    double errors[2][CONVERGENCE_LEVELS], worse[CONVERGENCE_LEVELS];
    analytic_functions(&s, analytic_ramp, sizeof analytic_ramp / sizeof *analytic_ramp / 2);
    analytic_view(*state, &s, parallel);
    analytic_render(&s, CONVERGENCE_SIDE, 0.5, 0.0, 0.0, truth);
    for (int level = 0; level < CONVERGENCE_LEVELS; ++level) {
      for (int broken = 0; broken < 2; ++broken) {
        cube_mesh c = cube_of(s.field, BOXES_LEAST << level, broken);
        for (int m = 0; m < 2; ++m) {
          const double error = error_of(*state, &s, &c, methods[m], truth);
          (broken ? worse : errors[m])[level] = error;
        }
        free(c.points);
        free(c.vertices);
        free(c.values);
      }
    }
    for (int m = 0; m < 2; ++m) {
      convergence_judge(stratus_tetra_method_name(methods[m]), errors[m], 2.0, "a cell takes its first corner's value", worse);
    }
  }
}

int test_convergence_tetra(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(cells_have_order_2),
  };
  return cmocka_run_group_tests(tests, convergence_start, convergence_stop);
}
