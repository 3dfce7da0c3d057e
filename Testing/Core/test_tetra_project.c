/* SPDX-License-Identifier: BSD-3-Clause
 * Projection of tetrahedra beside the march and the double-precision reference: where no order of cells is right, with leaves, behind what is
 * opaque; and which of the two methods a view is drawn by. What both must do alike is in test_tetra_march*.c, which run once with each. */
#include "tetra_case.h"

/* Half of the bar of record for functions with peaks, for these are smoother. */
#define RMSE_MOST 0.025
/* What the contract says the methods may differ by. */
#define DIFFERENCE_MOST 0.01

static tetra_picture marched, projected;
static double reference[4 * TETRA_PIXELS];

static double difference(void)
{
  double squares = 0.0;
  for (int i = 0; i < 4 * TETRA_PIXELS; ++i) {
    const double d = 255.0 * ((double)marched.rgba[i] - (double)projected.rgba[i]);
    squares += d * d;
  }
  return sqrt(squares / (4.0 * TETRA_PIXELS));
}

static void draw_both(stratus_context* context, tetra_case* c)
{
  tetra_method = c->options.method = STRATUS_TETRA_METHOD_MARCH;
  tetra_draw(context, c, &marched);
  tetra_method = c->options.method = STRATUS_TETRA_METHOD_PROJECT;
  tetra_draw(context, c, &projected);
  assert_true(marched.report.rays > TETRA_PIXELS / 10);
}

static void agrees(const tetra_case* c, const char* what)
{
  double largest;
  tetra_reference(c, reference, NULL);
  const double error = tetra_error(projected.rgba, reference, &largest), apart = difference();
  if (!(error <= RMSE_MOST) || !(apart <= DIFFERENCE_MOST)) {
    print_error("%s: RMSE %.4f of 255, at most %g; largest %.3f; from the march %.4f\n", what, error, RMSE_MOST, largest, apart);
  }
  assert_true(error <= RMSE_MOST && apart <= DIFFERENCE_MOST);
}

/* The march passes cells where the projection composites pieces: as many, where everything shows and rays end nowhere. */
static void pieces_are_the_march_s_segments(void** state)
{
  for (uint32_t seed = 0; seed < 4; ++seed) {
    tetra_case c;
    tetra_create(&c, 4, 0.2, 0.3, seed);
    c.opacity[1] = c.opacity[3] = 0.1;
    tetra_look(*state, &c, 4, (int)seed, seed & 1);
    draw_both(*state, &c);
    agrees(&c, "segments");
    assert_int_equal(marched.report.method, STRATUS_TETRA_METHOD_MARCH);
    /* a ray along an edge may find a piece without length in one way, and none in the other */
    const double passed = (double)marched.report.segments, composited = (double)projected.report.segments;
    assert_true(fabs(passed - composited) <= 1e-3 * passed);
    tetra_destroy(&c);
  }
}

/* Copies of a mesh that overlap it, moved a little each: no order of whole cells is right, and a ray has more pieces than are sorted at once. */
static void cells_that_overlap_are_drawn_again(void** state)
{
  enum { N = 8, COPIES = 3 };
  tetra_case c;
  tetra_create(&c, N, 0.2, 0.0, 3);
  const int64_t points = c.mesh.point_count, cells = c.mesh.cell_count;
  c.points = realloc(c.points, (size_t)(COPIES * points) * 3 * sizeof(double));
  c.values = realloc(c.values, (size_t)(COPIES * points) * sizeof(float));
  c.vertices = realloc(c.vertices, (size_t)(COPIES * cells) * 4 * sizeof(int32_t));
  assert_true(c.points && c.values && c.vertices);
  for (int64_t copy = 1; copy < COPIES; ++copy) {
    for (int64_t i = 0; i < 3 * points; ++i) {
      c.points[3 * copy * points + i] = c.points[i] + 0.31 * (double)copy;
    }
    for (int64_t i = 0; i < points; ++i) {
      c.values[copy * points + i] = c.values[i];
    }
    for (int64_t i = 0; i < 4 * cells; ++i) {
      c.vertices[4 * copy * cells + i] = c.vertices[i] + (int32_t)(copy * points);
    }
  }
  c.mesh.points = c.points;
  c.mesh.values = c.values;
  c.mesh.vertices = c.vertices;
  c.mesh.point_count = COPIES * points;
  c.mesh.cell_count = COPIES * cells;
  c.transfer.unit_distance = 4.0;
  tetra_look(*state, &c, N, 2, 0);
  draw_both(*state, &c);
  double largest;
  tetra_reference(&c, reference, NULL);
  uint32_t most = 0;
  for (int i = 0; i < TETRA_PIXELS; ++i) {
    most = projected.samples[i] > most ? projected.samples[i] : most;
  }
  assert_true(most > 64);
  assert_true(projected.report.again > TETRA_PIXELS / 10);
  /* the march draws one copy's way after the other where they begin, so that the reference alone can judge */
  assert_true(tetra_error(projected.rgba, reference, &largest) <= RMSE_MOST);
  tetra_destroy(&c);
}

/* Rays that end early end at the same cells, and what comes out of order behind what is opaque is found, too. */
static void opaque_things(void** state)
{
  for (uint32_t seed = 0; seed < 6; ++seed) {
    tetra_case c;
    tetra_create(&c, 4, 0.2, 0.4, seed);
    c.transfer.unit_distance = 0.02;
    tetra_look(*state, &c, 4, (int)seed, seed & 1);
    c.options.termination = 0.999;
    draw_both(*state, &c);
    assert_true(difference() <= 10.0 * DIFFERENCE_MOST); /* a pixel may end one faint piece later */
    for (int i = 0; i < TETRA_PIXELS; ++i) {
      assert_int_equal(isinf(marched.depth[i]) != 0, isinf(projected.depth[i]) != 0);
      assert_true(isinf(marched.depth[i]) || fabs((double)(marched.depth[i] - projected.depth[i])) < 1e-3);
    }
    tetra_destroy(&c);
  }
}

static void leaves_change_nothing_but_roundings(void** state)
{
  stratus_partition* partition = NULL;
  stratus_partition_options options = stratus_partition_options_default();
  stratus_partition_result cut;
  tetra_case c;
  tetra_create(&c, 4, 0.0, 0.0, 5); /* planes of its own cut no cell */
  options.leaf_cells = 16;
  assert_int_equal(stratus_partition_create(*state, &c.mesh, &options, &partition), STRATUS_OK);
  stratus_partition_get(partition, &cut);
  assert_int_equal(cut.cell_count, c.mesh.cell_count);
  assert_true(cut.leaves.leaf_count == 8);
  memcpy(c.vertices, cut.vertices, (size_t)(4 * cut.cell_count) * sizeof *cut.vertices); /* leaf by leaf */
  tetra_look(*state, &c, 4, 3, 0);
  draw_both(*state, &c);
  marched = projected;
  c.options.leaves = &cut.leaves;
  assert_int_equal(projected.report.leaves, 1);
  tetra_draw(*state, &c, &projected);
  assert_int_equal(projected.report.leaves, 8);
  assert_true(difference() <= 1e-4); /* another order, and as right: only what is shorter than rounding may come the other way round */
  stratus_leaves wrong = cut.leaves;
  wrong.leaf_count = 7;
  c.options.leaves = &wrong;
  stratus_tetra_caster* caster = NULL;
  const stratus_image image = { .width = TETRA_WIDTH, .height = TETRA_HEIGHT, .rgba = projected.rgba };
  assert_int_equal(stratus_tetra_caster_create(*state, &caster), STRATUS_OK);
  assert_int_equal(
    stratus_tetra_caster_render(caster, &c.mesh, &c.transfer, &c.camera, &c.options, &image, NULL), STRATUS_INVALID_ARGUMENT);
  assert_non_null(strstr(stratus_context_message(*state), "leaves"));
  stratus_tetra_caster_destroy(caster);
  stratus_partition_destroy(partition);
  tetra_destroy(&c);
}

/* Many cells, small on the screen, that all show: rays pass them for less. One value in a thousand shows: only those cells need be drawn. A camera
 * that stands still sees one method. */
static void auto_chooses_by_what_shows(void** state)
{
  tetra_case c;
  stratus_tetra_caster* caster = NULL;
  const stratus_image image = { .width = TETRA_WIDTH, .height = TETRA_HEIGHT, .rgba = projected.rgba };
  static const stratus_tetra_method expected[2] = { STRATUS_TETRA_METHOD_MARCH, STRATUS_TETRA_METHOD_PROJECT };
  tetra_create(&c, 3, 0.2, 0.0, 6);
  tetra_look(*state, &c, 3, 1, 0);
  c.options.method = STRATUS_TETRA_METHOD_AUTO;
  assert_int_equal(stratus_tetra_options_default().method, STRATUS_TETRA_METHOD_AUTO);
  assert_int_equal(stratus_tetra_caster_create(*state, &caster), STRATUS_OK);
  for (int rare = 0; rare < 2; ++rare) {
    const double opacity[8] = { 0.0, rare ? 0.0 : 0.2, rare ? 0.985 : 0.3, rare ? 0.0 : 0.2, rare ? 0.99 : 0.6, 0.7, 1.0, 0.2 };
    memcpy(c.opacity, opacity, sizeof opacity);
    for (int frame = 0; frame < 3; ++frame) {
      stratus_tetra_report report;
      assert_int_equal(stratus_tetra_caster_render(caster, &c.mesh, &c.transfer, &c.camera, &c.options, &image, &report), STRATUS_OK);
      assert_int_equal(report.method, expected[rare]);
      assert_memory_equal(report.why, stratus_tetra_method_name(report.method), strlen(stratus_tetra_method_name(report.method)));
    }
  }
  stratus_tetra_caster_destroy(caster);
  tetra_destroy(&c);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(pieces_are_the_march_s_segments),
    cmocka_unit_test(cells_that_overlap_are_drawn_again),
    cmocka_unit_test(opaque_things),
    cmocka_unit_test(leaves_change_nothing_but_roundings),
    cmocka_unit_test(auto_chooses_by_what_shows),
  };
  return cmocka_run_group_tests(tests, tetra_start, tetra_stop);
}
