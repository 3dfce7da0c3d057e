/* SPDX-License-Identifier: BSD-3-Clause
 * Meshes whose parts hide one another in every way: a ring of cells that has no order, parts that interleave or fill one another's hollows,
 * cells that share no point, unused points, a few inverted cells among many, a seam of faces that differ. Each method gives the reference's
 * picture. */
#include "tetra_parts.h"

#define CLOSE 0.025 /* greatest RMSE of 255: half of the bar of record for functions with peaks */

static tetra_picture picture;
static double reference[4 * TETRA_PIXELS_MOST];

static void agrees(stratus_context* context, const tetra_case* c, const char* what)
{
  double largest;
  tetra_draw(context, c, &picture);
  tetra_reference(c, reference, NULL);
  const double error = tetra_error(picture.rgba, reference, &largest);
  if (!(error <= CLOSE)) {
    print_error("%s: RMSE %.4f of 255, at most %g; largest %.3f\n", what, error, CLOSE, largest);
  }
  assert_true(error <= CLOSE);
  assert_int_equal(picture.report.stuck, 0);
}

/* Bars about an axis, each over the next and under the one before: whichever comes first, another hides it. */
static void three_cells_in_a_ring(void** state)
{
  static const double corners[4][3] = { { 0.35, -2, -0.5 }, { 0.85, -2, -0.5 }, { 0.6, 2, 0.3 }, { 0.6, 2, 0.8 } };
  for (int view = 0; view < 9; ++view) {
    tetra_case c;
    tetra_create(&c, 1, 0.0, 0.0, 1);
    tetra_clear(&c, 12, 3);
    for (int bar = 0; bar < 3; ++bar) {
      const double turn = 2.0943951023931953 * bar;
      for (int i = 0; i < 4; ++i) {
        const double x = corners[i][0], y = corners[i][1];
        tetra_add_point(&c, 2.0 + cos(turn) * x - sin(turn) * y, 2.0 + sin(turn) * x + cos(turn) * y, 2.0 + corners[i][2]);
        c.values[4 * bar + i] = 0.3f + 0.3f * (float)bar;
      }
      tetra_add_cell(&c, 4 * bar, 4 * bar + 1, 4 * bar + 2, 4 * bar + 3);
    }
    c.transfer.unit_distance = 0.1; /* nearly opaque: parts behind hardly count */
    tetra_camera(*state, &c, 4, view % 8, view & 1);
    if (view == 8) { /* along the axis, where the ring is one */
      const double eye[3] = { 2, 2, 12 }, focal[3] = { 2, 2, 2 }, up[3] = { 0, 1, 0 };
      assert_int_equal(stratus_camera_perspective(*state, eye, focal, up, 30.0, 1.2, &c.camera), STRATUS_OK);
    }
    agrees(*state, &c, "ring");
    tetra_destroy(&c);
  }
}

static void parts_that_interleave(void** state)
{
  for (int view = 0; view < 8; ++view) {
    tetra_case c;
    tetra_create(&c, 1, 0.0, 0.0, 1);
    tetra_clear(&c, 64 * 8, 64 * 6);
    for (int i = 0; i < 64; ++i) { /* a chess board of boxes of two sizes that touch in parts of faces */
      const double shrink = (i + i / 4 + i / 16) & 1 ? 0.7 : 1.0;
      const double low[3] = { i % 4, i / 4 % 4, i / 16 }, size[3] = { shrink, shrink, shrink };
      tetra_add_box(&c, 1, low, size);
    }
    tetra_camera(*state, &c, 4, view, view & 1);
    agrees(*state, &c, "board");
    tetra_destroy(&c);
  }
}

static void a_part_in_the_hollow_of_another(void** state)
{
  for (int view = 0; view < 4; ++view) {
    tetra_case c;
    tetra_create(&c, 1, 0.0, 0.0, 1);
    tetra_clear(&c, 27 * 8, 27 * 6);
    for (int i = 0; i < 27; ++i) {
      const double shrink = i == 13 ? 0.5 : 1.0, shift = (1.0 - shrink) / 2.0;
      const double low[3] = { i % 3 + shift, i / 3 % 3 + shift, i / 9 + shift }, size[3] = { shrink, shrink, shrink };
      tetra_add_box(&c, 1, low, size);
    }
    tetra_camera(*state, &c, 3, 2 * view, view & 1);
    agrees(*state, &c, "hollow");
    tetra_destroy(&c);
  }
}

/* No cell shares a point with another, so that all faces are border faces. Points far away and in the middle belong to no cell. */
static void points_that_are_there_twice_or_for_nothing(void** state)
{
  tetra_case c, apart;
  tetra_create(&c, 2, 0.2, 0.0, 2);
  tetra_create(&apart, 2, 0.2, 0.0, 2);
  tetra_clear(&apart, 4 * 48 + 3, 48);
  tetra_add_point(&apart, 1e6, -1e6, 3.0);
  tetra_add_point(&apart, 1.0, 1.0, 1.0);
  for (int64_t i = 0; i < 4 * c.mesh.cell_count; ++i) {
    const double* p = c.points + 3 * (int64_t)c.vertices[i];
    apart.values[tetra_add_point(&apart, p[0], p[1], p[2])] = c.values[c.vertices[i]];
    apart.vertices[i] = (int32_t)apart.mesh.point_count - 1;
  }
  apart.mesh.cell_count = c.mesh.cell_count;
  for (int view = 0; view < 4; ++view) {
    tetra_camera(*state, &c, 2, view, view & 1);
    apart.camera = c.camera;
    agrees(*state, &c, "points shared");
    assert_int_equal(picture.report.border_faces, 6 * 2 * 2 * 2);
    agrees(*state, &apart, "points apart");
    assert_int_equal(picture.report.border_faces, 4 * apart.mesh.cell_count);
  }
  apart.points[0] = NAN; /* an unused point's, which is still no place */
  stratus_tetra_caster* caster = NULL;
  const stratus_image image = { .width = TETRA_WIDTH, .height = TETRA_HEIGHT, .rgba = picture.rgba };
  assert_int_equal(stratus_tetra_caster_create(*state, &caster), STRATUS_OK);
  assert_int_equal(stratus_tetra_caster_render(caster, &apart.mesh, &apart.transfer, &apart.camera, &apart.options, &image, NULL),
    STRATUS_INVALID_ARGUMENT);
  assert_non_null(strstr(stratus_context_message(*state), "finite"));
  stratus_tetra_caster_destroy(caster);
  tetra_destroy(&c);
  tetra_destroy(&apart);
}

/* One of 729 points pulled through others behind it: a few of 3072 cells turn inside out. The colour is uniform, so that order does not
 * matter, only that all cells are drawn. */
static void few_inverted_cells_among_many(void** state)
{
  const double low[3] = { 0, 0, 0 }, size[3] = { 4, 4, 4 };
  for (int view = 0; view < 2; ++view) {
    tetra_case c;
    tetra_create(&c, 1, 0.0, 0.0, 1);
    tetra_clear(&c, 729, 3072);
    tetra_add_box(&c, 8, low, size);
    double* pulled = c.points + 3 * (4 + 9 * (4 + 9 * 4));
    pulled[0] = 2.6;
    pulled[1] = 2.05;
    pulled[2] = 2.025;
    for (int i = 0; i < 12; ++i) {
      c.color[i] = i & 3 ? 0.5 : c.color[i];
    }
    tetra_camera(*state, &c, 4, 3 * view, view & 1);
    agrees(*state, &c, "inverted");
    assert_true(picture.report.folded_faces > 0 && picture.report.folded_faces < 48);
    tetra_destroy(&c);
  }
}

/* A flat cell, and cells on one side of it: no ray leads from one through the flat cell into the other. The colour is uniform, so that
 * order does not matter. chain: there is a second flat cell behind the first. */
static void a_flat_cell_between_cells_that_overlap(void** state)
{
  for (int view = 0; view < 16; ++view) {
    const int chain = view / 8;
    tetra_case c;
    tetra_create(&c, 1, 0.0, 0.0, 1);
    tetra_clear(&c, 10, 10);
    const int32_t p = tetra_add_point(&c, 0, 0, 2), q = tetra_add_point(&c, 4, 0, 2), r = tetra_add_point(&c, 2, 4, 2);
    const int32_t between = tetra_add_point(&c, 2, 0, 2), within = tetra_add_point(&c, 1, 1, 2);
    tetra_add_cell(&c, between, p, q, r);
    tetra_add_cell(&c, p, q, r, tetra_add_point(&c, 2, 1.5, 4));
    if (chain) {
      tetra_add_cell(&c, between, p, r, within);
      tetra_add_cell(&c, between, p, within, tetra_add_point(&c, 1, 1, 3.5));
    } else {
      tetra_add_cell(&c, between, p, r, tetra_add_point(&c, 1, 1, 3.5));
    }
    tetra_add_cell(&c, between, q, r, tetra_add_point(&c, 3, 1, 0));
    for (int i = 0; i < 12; ++i) {
      c.color[i] = i & 3 ? 0.5 : c.color[i];
    }
    c.mesh.matrix[10] = view & 4 ? -1.0 : 1.0; /* from below */
    c.mesh.matrix[11] = view & 4 ? 4.0 : 0.0;
    tetra_camera(*state, &c, 4, view % 8, view & 1);
    agrees(*state, &c, "flat");
    assert_int_equal(picture.report.flat, 1 + chain);
    tetra_destroy(&c);
  }
}

static void a_seam_of_other_faces(void** state)
{
  const double low[3] = { 0, 0, 0 }, offset[3] = { 1.5, 0, 0 }, size[3] = { 1.5, 3, 3 };
  for (int view = 0; view < 8; ++view) {
    tetra_case c;
    tetra_create(&c, 1, 0.0, 0.0, 1);
    tetra_clear(&c, 200, 300);
    tetra_add_box(&c, 2, low, size);
    tetra_add_box(&c, 3, offset, size);
    tetra_camera(*state, &c, 3, view, view & 1);
    agrees(*state, &c, "seam");
    tetra_destroy(&c);
  }
}

int test_tetra_parts_fail(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(three_cells_in_a_ring),
    cmocka_unit_test(parts_that_interleave),
    cmocka_unit_test(a_part_in_the_hollow_of_another),
    cmocka_unit_test(points_that_are_there_twice_or_for_nothing),
    cmocka_unit_test(few_inverted_cells_among_many),
    cmocka_unit_test(a_flat_cell_between_cells_that_overlap),
    cmocka_unit_test(a_seam_of_other_faces),
  };
  int failed = 0;
  for (tetra_method = STRATUS_TETRA_METHOD_MARCH; tetra_method <= STRATUS_TETRA_METHOD_PROJECT; ++tetra_method) {
    failed += cmocka_run_group_tests_name(stratus_tetra_method_name(tetra_method), tests, tetra_start, tetra_stop);
  }
  return failed;
}
