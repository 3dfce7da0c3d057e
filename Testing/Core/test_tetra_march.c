/* SPDX-License-Identifier: BSD-3-Clause
 * Pictures of tetrahedra against the double-precision reference, from outside and inside, through hollows, cut by planes and opaque things. */
#include "tetra_case.h"

/* Colours are averaged over pieces of a cell. Half of the bar of record for functions with peaks, for these are smoother. */
#define RMSE_MOST 0.025
#define LARGEST_MOST 0.5

static tetra_picture picture;
static double reference[4 * TETRA_PIXELS], reference_depth[TETRA_PIXELS];

static void check(stratus_context* context, const tetra_case* c, const char* what)
{
  double largest;
  tetra_draw(context, c, &picture);
  tetra_reference(c, reference, reference_depth);
  const double error = tetra_error(picture.rgba, reference, &largest);
  if (!(error <= RMSE_MOST) || !(largest <= LARGEST_MOST)) {
    print_error("%s: RMSE %.4f of 255, at most %g; largest %.3f\n", what, error, RMSE_MOST, largest);
  }
  assert_true(error <= RMSE_MOST && largest <= LARGEST_MOST);
  assert_int_equal(picture.report.stuck, 0);
}

static void from_outside(void** state)
{
  for (uint32_t seed = 0; seed < 6; ++seed) {
    for (int parallel = 0; parallel < 2; ++parallel) {
      tetra_case c;
      tetra_create(&c, 3, 0.2, seed < 2 ? 0.0 : 0.3, seed);
      tetra_look(*state, &c, 3, (int)seed, parallel);
      check(*state, &c, parallel ? "parallel" : "perspective");
      tetra_destroy(&c);
    }
  }
}

static void eye_in_a_cell_on_a_face_and_on_a_point(void** state)
{
  static const double eyes[3][3] = { { 1.3, 1.62, 1.45 }, { 1.5, 1.5, 1.0 }, { 1.0, 2.0, 1.0 } };
  for (int i = 0; i < 3; ++i) {
    for (int holes = 0; holes < 2; ++holes) {
      tetra_case c;
      const double focal[3] = { 3.1, 0.3 + i, 0.9 }, up[3] = { 0, 0, 1 };
      tetra_create(&c, 3, 0.0, holes ? 0.3 : 0.0, 9);
      assert_int_equal(stratus_camera_perspective(*state, eyes[i], focal, up, 80.0, 1.2, &c.camera), STRATUS_OK);
      check(*state, &c, "inside");
      c.camera.near_k = 0.4; /* cells are cut, not dropped */
      c.camera.far_k = 1.1;
      check(*state, &c, "inside, between near and far");
      tetra_destroy(&c);
    }
  }
}

static void ends_at_what_is_opaque(void** state)
{
  static float opaque[TETRA_PIXELS];
  for (int parallel = 0; parallel < 2; ++parallel) {
    tetra_case c;
    uint32_t s = 17;
    tetra_create(&c, 3, 0.2, 0.2, 4);
    tetra_look(*state, &c, 3, 2, parallel);
    c.camera.near_k = parallel ? 5.0 : 7.0;
    c.camera.far_k = 16.0;
    for (int i = 0; i < TETRA_PIXELS; ++i) {
      opaque[i] = (float)tetra_uniform(&s, 0, 1);
    }
    c.opaque_depth = opaque;
    check(*state, &c, "opaque depth");
    tetra_destroy(&c);
  }
}

static void depth_is_where_something_shows_first(void** state)
{
  tetra_case c;
  tetra_create(&c, 3, 0.2, 0.0, 5);
  c.opacity[1] = 0.1; /* everything shows */
  tetra_look(*state, &c, 3, 1, 0);
  check(*state, &c, "depth");
  int compared = 0;
  for (int i = 0; i < TETRA_PIXELS; ++i) {
    assert_int_equal(isinf(picture.depth[i]) != 0, picture.rgba[4 * i + 3] == 0.0f);
    if (isfinite(picture.depth[i]) && isfinite(reference_depth[i])) {
      assert_true(fabs((double)picture.depth[i] - reference_depth[i]) < 0.01); /* the reference's own step */
      ++compared;
    }
  }
  assert_true(compared > 100);
  tetra_destroy(&c);
}

static void a_value_a_cell(void** state)
{
  tetra_case c;
  tetra_create(&c, 3, 0.2, 0.2, 6);
  c.mesh.cell_values = 1;
  for (int64_t i = 0; i < c.mesh.cell_count; ++i) {
    c.values[i] = (float)(i % 17) / 16.0f;
  }
  tetra_look(*state, &c, 3, 3, 0);
  check(*state, &c, "cell values");
  c.opacity[7] = 0.9; /* most opaque at the largest value: the table's sums are at their end there */
  check(*state, &c, "cell values, opaque at their end");
  tetra_destroy(&c);
}

static void hidden_cells_and_values_that_are_no_numbers(void** state)
{
  tetra_case c;
  tetra_create(&c, 3, 0.2, 0.0, 7);
  for (int64_t i = 0; i < c.mesh.cell_count; i += 5) {
    c.hidden[i] = 1;
  }
  c.mesh.hidden = c.hidden;
  c.values[21] = NAN;
  c.values[42] = INFINITY;
  tetra_look(*state, &c, 3, 4, 0);
  check(*state, &c, "hidden");
  assert_true(picture.report.shown_cells < c.mesh.cell_count * 4 / 5);
  tetra_destroy(&c);
}

static void the_maximum(void** state)
{
  for (int inside = 0; inside < 2; ++inside) {
    tetra_case c;
    tetra_create(&c, 3, 0.2, 0.3, 8);
    c.options.mode = STRATUS_TETRA_MAXIMUM;
    tetra_look(*state, &c, 3, 5, 0);
    if (inside) {
      c.camera.near_k = 10.0;
      c.camera.far_k = 10.4;
    }
    check(*state, &c, "maximum");
    tetra_destroy(&c);
  }
}

static void matrices_and_far_away_places(void** state)
{
  static const double matrices[3][12] = { { -1, 0, 0, 3, 0, 1, 0, 0, 0, 0, 1, 0 }, { 0.6, 0.5, 0, 0.3, -0.4, 0.8, 0.2, 0.7, 0, 0.1, 0.7, 0.4 },
    { 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0 } };
  for (int i = 0; i < 5; ++i) {
    tetra_case c;
    tetra_create(&c, 3, 0.2, 0.2, 10);
    memcpy(c.mesh.matrix, matrices[i < 3 ? i : 2], sizeof matrices[0]);
    tetra_look(*state, &c, 3, 6, i & 1);
    const double scale = i == 3 ? 1e-6 : 1.0, offset = i == 2 ? 6e6 : 0.0;
    for (int64_t p = 0; p < 3 * c.mesh.point_count; ++p) {
      c.points[p] = c.points[p] * scale + offset;
    }
    for (int a = 0; a < 3; ++a) {
      c.camera.eye[a] = c.camera.eye[a] * scale + offset;
      c.camera.right[a] *= c.camera.parallel ? scale : 1.0;
      c.camera.up[a] *= c.camera.parallel ? scale : 1.0;
    }
    c.transfer.unit_distance = scale;
    check(*state, &c, i == 2 ? "6e6" : i == 3 ? "1e-6" : "matrix");
    tetra_destroy(&c);
  }
}

/* A camera far away with a narrow angle sees what a parallel one does: thickness is not lost in the distance. */
static void a_camera_far_away(void** state)
{
  tetra_case c;
  const double eye[3] = { 1.5e5, 1.5, 1.5 }, focal[3] = { 1.5, 1.5, 1.5 }, up[3] = { 0, 0, 1 };
  tetra_create(&c, 3, 0.2, 0.2, 11);
  assert_int_equal(stratus_camera_perspective(*state, eye, focal, up, 0.0015, 1.2, &c.camera), STRATUS_OK);
  check(*state, &c, "far away");
  tetra_destroy(&c);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(from_outside),
    cmocka_unit_test(eye_in_a_cell_on_a_face_and_on_a_point),
    cmocka_unit_test(ends_at_what_is_opaque),
    cmocka_unit_test(depth_is_where_something_shows_first),
    cmocka_unit_test(a_value_a_cell),
    cmocka_unit_test(hidden_cells_and_values_that_are_no_numbers),
    cmocka_unit_test(the_maximum),
    cmocka_unit_test(matrices_and_far_away_places),
    cmocka_unit_test(a_camera_far_away),
  };
  int failed = 0;
  for (tetra_method = STRATUS_TETRA_METHOD_MARCH; tetra_method <= STRATUS_TETRA_METHOD_PROJECT; ++tetra_method) {
    failed += cmocka_run_group_tests_name(stratus_tetra_method_name(tetra_method), tests, tetra_start, tetra_stop);
  }
  return failed;
}
