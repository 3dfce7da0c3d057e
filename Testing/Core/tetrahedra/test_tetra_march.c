/* SPDX-License-Identifier: BSD-3-Clause
 * Pictures of tetrahedra compared with the double-precision reference: from outside and inside, through hollows, cut by planes and opaque
 * objects. */
#include "tetra_case.h"

#include <float.h>

/* Colours are averaged over pieces of a cell. The bound is half of the bar of record for functions with peaks, since these functions are
 * smoother. */
#define RMSE_MOST 0.025
#define LARGEST_MOST 0.5

static tetra_picture picture;
static double reference[4 * TETRA_PIXELS_MOST], reference_depth[TETRA_PIXELS_MOST];

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
      tetra_camera(*state, &c, 3, (int)seed, parallel);
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
      for (int pixel = 0; pixel < TETRA_PIXELS; ++pixel) { /* a cell that contains the eye begins at the eye */
        assert_true(picture.depth[pixel] >= 0.0f);
      }
      c.camera.near_k = 0.4; /* cells are cut, not dropped */
      c.camera.far_k = 1.1;
      check(*state, &c, "inside, between near and far");
      tetra_destroy(&c);
    }
  }
}

static void ends_at_what_is_opaque(void** state)
{
  static float opaque[TETRA_PIXELS_MOST];
  for (int parallel = 0; parallel < 2; ++parallel) {
    tetra_case c;
    uint32_t s = 17;
    tetra_create(&c, 3, 0.2, 0.2, 4);
    tetra_camera(*state, &c, 3, 2, parallel);
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
  tetra_camera(*state, &c, 3, 1, 0);
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
  tetra_camera(*state, &c, 3, 3, 0);
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
  tetra_camera(*state, &c, 3, 4, 0);
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
    tetra_camera(*state, &c, 3, 5, 0);
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
  static const double matrices[3][12] = { { -1, 0, 0, 3, 0, 1, 0, 0, 0, 0, 1, 0 },
    { 0.6, 0.5, 0, 0.3, -0.4, 0.8, 0.2, 0.7, 0, 0.1, 0.7, 0.4 }, { 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0 } };
  for (int i = 0; i < 5; ++i) {
    tetra_case c;
    tetra_create(&c, 3, 0.2, 0.2, 10);
    memcpy(c.mesh.matrix, matrices[i < 3 ? i : 2], sizeof matrices[0]);
    tetra_camera(*state, &c, 3, 6, i & 1);
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

static void assert_all_in_range(void)
{
  for (int i = 0; i < 4 * TETRA_PIXELS; ++i) {
    assert_true(picture.rgba[i] >= 0.0f && picture.rgba[i] <= 1.0f);
  }
  for (int i = 0; i < TETRA_PIXELS; ++i) {
    assert_true(picture.depth[i] <= INFINITY);
  }
}

/* Cells without volume among others that are drawn: they name a point twice, three or four times, have points in one place or one plane
 * under different numbers, or values that are not finite. */
static void cells_without_volume_show_nothing_and_are_counted(void** state)
{
  for (uint32_t seed = 0; seed < 24; ++seed) {
    tetra_case c;
    int64_t repeated = 0;
    tetra_create(&c, 3, 0.2, 0.0, seed);
    for (int64_t i = 0; i < c.mesh.cell_count; i += 3) {
      int32_t* v = c.vertices + 4 * i;
      for (int k = 0; k < (int)(i / 3 + seed) % 4; ++k) {
        v[k + 1] = v[0];
      }
      repeated += v[0] == v[1];
    }
    for (int64_t i = seed % 5; i < c.mesh.point_count && seed % 3 == 0; i += 7) {
      memcpy(c.points + 3 * i, c.points, 3 * sizeof(double)); /* their cells fold over others: no judge, but for the pixels' range */
    }
    for (int64_t i = 0; i < c.mesh.point_count && seed % 3 == 1; ++i) {
      c.points[3 * i + 2] = 1.5 + 1e-9 * (c.points[3 * i + 2] - 1.5); /* hardly thicker than a plane */
    }
    tetra_camera(*state, &c, 3, (int)seed % 8, seed & 1);
    if (seed % 3 == 2) {
      check(*state, &c, "cells that name a point twice");
    } else {
      tetra_draw(*state, &c, &picture);
    }
    assert_all_in_range();
    assert_int_equal(picture.report.repeated, repeated);
    assert_int_equal(picture.report.blanked, repeated);
    assert_int_equal(picture.report.shown_cells, c.mesh.cell_count - repeated);
    c.values[c.vertices[20]] = -FLT_MAX;
    c.values[c.vertices[32]] = FLT_MAX;
    c.values[c.vertices[4]] = NAN;
    c.values[c.vertices[8]] = INFINITY;
    tetra_draw(*state, &c, &picture);
    assert_all_in_range();
    assert_int_equal(picture.report.repeated, repeated);
    assert_true(picture.report.blanked > repeated);
    assert_int_equal(picture.report.shown_cells + picture.report.blanked, c.mesh.cell_count);
    tetra_destroy(&c);
  }
}

/* Optical depths in the thousands of millions are opaque, and lengths of the unit distance's size look as at size 1. Lengths beyond floats
 * are refused, and the caster can continue. */
static void lengths_of_any_size_are_drawn_or_refused(void** state)
{
  static const double scales[] = { 1e-310, 1e-200, 1e-30, 1e-25, 1e-10, 1e10, 1e20, 1e25, 1e30, 1e31, 1e100, 1e200, 1e290 };
  for (size_t i = 0; i < sizeof scales / sizeof *scales; ++i) {
    for (int kind = 0; kind < 4; ++kind) {
      const double scale = scales[i];
      const int parallel = kind & 1;
      stratus_tetra_caster* caster = NULL;
      tetra_case c;
      tetra_create(&c, 3, 0.2, 0.2, 10);
      tetra_camera(*state, &c, 3, 6, parallel);
      for (int64_t p = 0; p < 3 * c.mesh.point_count; ++p) {
        c.points[p] *= scale;
      }
      for (int a = 0; a < 3; ++a) {
        c.camera.eye[a] *= scale;
        c.camera.right[a] *= parallel ? scale : 1.0;
        c.camera.up[a] *= parallel ? scale : 1.0;
      }
      c.transfer.unit_distance = kind & 2 ? scale : 1.0;
      const stratus_image image = { .width = TETRA_WIDTH, .height = TETRA_HEIGHT, .rgba = picture.rgba, .depth = picture.depth };
      assert_int_equal(stratus_tetra_caster_create(*state, &caster), STRATUS_OK);
      const stratus_status status = stratus_tetra_caster_render(caster, &c.mesh, &c.transfer, &c.camera, &c.options, &image, NULL);
      assert_int_equal(status, scale < 1e-27 || scale > 1e27 ? STRATUS_INVALID_ARGUMENT : STRATUS_OK);
      if (status == STRATUS_OK) {
        assert_all_in_range();
        if (kind & 2) {
          check(*state, &c, "as large as its unit distance");
        }
      } else if (scale > 1e-300) { /* below, a parallel camera's window has no inverse */
        assert_non_null(
          strstr(stratus_context_message(*state), scale < 1.0 ? "must be at least 8.07794e-28" : "must be at most 1.23794e+27"));
      }
      stratus_tetra_caster_destroy(caster);
      tetra_destroy(&c);
    }
  }
}

/* A parallel camera with a window so narrow that products outside it overflow floats. */
static void windows_narrower_than_floats_are_refused(void** state)
{
  tetra_case c;
  stratus_tetra_caster* caster = NULL;
  const stratus_image image = { .width = TETRA_WIDTH, .height = TETRA_HEIGHT, .rgba = picture.rgba, .depth = picture.depth };
  tetra_create(&c, 3, 0.2, 0.2, 10);
  assert_int_equal(stratus_tetra_caster_create(*state, &caster), STRATUS_OK);
  for (int zoom = 0; zoom < 40; zoom += 3) {
    tetra_camera(*state, &c, 3, 6, 1);
    for (int a = 0; a < 3; ++a) {
      c.camera.right[a] *= pow(10.0, -zoom);
      c.camera.up[a] *= pow(10.0, -zoom);
    }
    const stratus_status status = stratus_tetra_caster_render(caster, &c.mesh, &c.transfer, &c.camera, &c.options, &image, NULL);
    assert_int_equal(status, zoom < 12 ? STRATUS_OK : STRATUS_INVALID_ARGUMENT);
    if (status == STRATUS_OK) {
      assert_all_in_range();
    } else {
      assert_non_null(strstr(stratus_context_message(*state), "at most 1.09951e+12"));
    }
  }
  stratus_tetra_caster_destroy(caster);
  tetra_destroy(&c);
}

/* Finite points at depths, in units of a forward of length .1, that are not finite. */
static void depths_beyond_doubles_are_refused(void** state)
{
  static const double points[] = { 0, 0, -5e307, 1, 0, 5e307, 0, 1, 5e307, 1, 1, -5e307 };
  tetra_case c;
  stratus_tetra_caster* caster = NULL;
  const stratus_image image = { .width = TETRA_WIDTH, .height = TETRA_HEIGHT, .rgba = picture.rgba };
  const stratus_camera camera = {
    .forward = { 0, 0, -0.1 }, .right = { 1, 0, 0 }, .up = { 0, 1, 0 }, .near_k = -1e308, .far_k = INFINITY, .parallel = 1
  };
  tetra_create(&c, 1, 0.0, 0.0, 10);
  c.mesh.points = points;
  c.mesh.point_count = 4;
  c.mesh.vertices = (const int32_t[]){ 0, 1, 2, 3 };
  c.mesh.cell_count = 1;
  assert_int_equal(stratus_tetra_caster_create(*state, &caster), STRATUS_OK);
  assert_int_equal(stratus_tetra_caster_render(caster, &c.mesh, &c.transfer, &camera, &c.options, &image, NULL), STRATUS_INVALID_ARGUMENT);
  assert_non_null(strstr(stratus_context_message(*state), "mesh reaches inf"));
  stratus_tetra_caster_destroy(caster);
  tetra_destroy(&c);
}

/* Root mean square error of RGBA in 0..1 over the pixels in which the reference shows anything. */
static double error_of(stratus_context* context, const tetra_case* c)
{
  double sum = 0.0;
  int lit = 0;
  tetra_draw(context, c, &picture);
  for (int i = 0; i < TETRA_PIXELS; ++i) {
    lit += reference[4 * i + 3] > 0.0;
    for (int k = 0; k < 4 && reference[4 * i + 3] > 0.0; ++k) {
      sum += pow((double)picture.rgba[4 * i + k] - reference[4 * i + k], 2.0);
    }
  }
  assert_true(lit > TETRA_PIXELS / 10);
  return sqrt(sum / (4.0 * lit));
}

/* Few large cells in which colours change and light falls at once, so that only their division keeps the error down. */
static void errors_stay_within_the_tolerance(void** state)
{
  static const double tolerances[] = { 0.01, 0.001, 0.0001 }, units[] = { 1.0, 0.2, 0.04 };
  double coarse = 0.0, fine = 0.0;
  for (int scene = 0; scene < 9; ++scene) {
    double errors[3];
    tetra_case c;
    tetra_create(&c, 1 + scene % 3, 0.1, 0.0, (uint32_t)scene);
    const double opacity[8] = { 0.0, 0.1, 0.3, 0.3, 0.6, 0.2, 1.0, 0.4 };
    const double color[12] = { 0.2, 1.0, 0.1, 0.0, 0.5, 0.0, 1.0, 0.2, 0.8, 0.9, 0.0, 1.0 };
    memcpy(c.opacity, opacity, sizeof opacity);
    memcpy(c.color, color, sizeof color);
    c.transfer.unit_distance = units[scene / 3];
    c.options.termination = 0.0;
    tetra_camera(*state, &c, 1 + scene % 3, scene % 8, scene & 1);
    tetra_reference(&c, reference, reference_depth);
    for (int t = 0; t < 3; ++t) {
      c.options.tolerance = tolerances[t];
      errors[t] = error_of(*state, &c);
      if (!(errors[t] <= tolerances[t])) {
        print_error("scene %d, tolerance %g: the error is %g\n", scene, tolerances[t], errors[t]);
      }
      assert_true(errors[t] <= tolerances[t]);
    }
    c.options.tolerance = 0.0;
    assert_true(error_of(*state, &c) <= errors[2] + 1e-6);
    coarse += errors[0];
    fine += errors[2];
    tetra_destroy(&c);
  }
  assert_true(coarse > 10.0 * fine); /* a looser tolerance takes fewer pieces */
}

static void tolerances_that_are_none_are_refused(void** state)
{
  static const double bad[] = { -0.001, NAN, INFINITY };
  static const char* const words[] = { "-0.001", "nan", "inf" };
  const stratus_image image = { .width = TETRA_WIDTH, .height = TETRA_HEIGHT, .rgba = picture.rgba };
  stratus_tetra_caster* caster = NULL;
  tetra_case c;
  tetra_create(&c, 1, 0.0, 0.0, 1);
  tetra_camera(*state, &c, 1, 0, 0);
  assert_int_equal(stratus_tetra_caster_create(*state, &caster), STRATUS_OK);
  for (int i = 0; i < 3; ++i) {
    c.options.tolerance = bad[i];
    assert_int_equal(
      stratus_tetra_caster_render(caster, &c.mesh, &c.transfer, &c.camera, &c.options, &image, NULL), STRATUS_INVALID_ARGUMENT);
    assert_non_null(strstr(stratus_context_message(*state), words[i]));
    assert_non_null(strstr(stratus_context_message(*state), "at least 0"));
  }
  stratus_tetra_caster_destroy(caster);
  tetra_destroy(&c);
}

int test_tetra_march(void)
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
    cmocka_unit_test(cells_without_volume_show_nothing_and_are_counted),
    cmocka_unit_test(lengths_of_any_size_are_drawn_or_refused),
    cmocka_unit_test(windows_narrower_than_floats_are_refused),
    cmocka_unit_test(depths_beyond_doubles_are_refused),
    cmocka_unit_test(errors_stay_within_the_tolerance),
    cmocka_unit_test(tolerances_that_are_none_are_refused),
  };
  int failed = 0;
  for (tetra_method = STRATUS_TETRA_METHOD_MARCH; tetra_method <= STRATUS_TETRA_METHOD_PROJECT; ++tetra_method) {
    failed += cmocka_run_group_tests_name(stratus_tetra_method_name(tetra_method), tests, tetra_start, tetra_stop);
  }
  return failed;
}
