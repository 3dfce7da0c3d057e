/* SPDX-License-Identifier: BSD-3-Clause
 * Modes that gather no light along the whole ray, and planes and boxes that cut rays, against the double-precision reference: on random
 * meshes with hollows, values of points and of cells, from several sides, and by whichever method draws them. */
#include "tetra_case.h"

#include "tetra_caster.h"

static tetra_picture picture;
static double reference[4 * TETRA_PIXELS_MOST], depth[TETRA_PIXELS_MOST];

static void set_contours(tetra_case* c)
{
  const double contours[4] = { 0.62, 0.35, 0.5, 0.5 };
  memcpy(c->options.contours, contours, sizeof contours);
  c->options.contour_count = 4;
  c->opacity[1] = 0.3; /* no value is transparent */
}

/* A plane, a sphere, a cone or a saddle through the mesh. */
static void set_slice(tetra_case* c, uint32_t kind)
{
  static const stratus_slice kinds[4] = { { .linear = { 1, -2, 0.5 } }, { .square = { 1, 1, 1 }, .constant = -1.7 },
    { .square = { 1, 1, -0.5 } }, { .square = { 0.05, -0.05, 0, 0.02, 0.01, -0.03 }, .linear = { 0.1, 0.2, 1 } } };
  c->options.slice = kinds[kind % 4];
  c->options.slice.center[0] = c->options.slice.center[1] = 2.1;
  c->options.slice.center[2] = 1.9;
}

static void set_planes(tetra_case* c, int planes, int crop)
{
  const double all[2][4] = { { 0.3, -0.5, 0.8, -0.9 }, { -1.0, 0.1, -0.2, 3.1 } }, bounds[6] = { 0.4, 3.3, -INFINITY, 2.9, 0.6, 3.6 };
  memcpy(c->options.clip_planes, all, sizeof all);
  memcpy(c->options.crop_bounds, bounds, sizeof bounds);
  c->options.clip_plane_count = planes;
  c->options.crop = crop;
}

/* A matrix that turns, stretches, shears and moves. */
static void set_matrix(tetra_case* c)
{
  const double matrix[16] = { 0.9, -0.3, 0.1, 0.2, 0.4, 0.8, 0.0, -0.3, 0.1, 0.2, 1.1, 0.1, 0, 0, 0, 1 };
  memcpy(c->mesh.matrix, matrix, sizeof matrix);
}

static void is_right(stratus_context* context, const tetra_case* c, double limit, const char* what)
{
  double largest;
  tetra_reference(c, reference, depth);
  tetra_method = c->options.method;
  tetra_draw(context, c, &picture);
  tetra_method = STRATUS_TETRA_METHOD_MARCH;
  const double error = tetra_error(picture.rgba, reference, &largest);
  if (!(error < limit)) {
    print_error("%s, mode %s, method %s: %.3f of 255, at most %.2f\n", what, stratus_tetra_mode_name(c->options.mode),
      stratus_tetra_method_name(c->options.method), error, largest);
  }
  assert_true(error < limit);
}

/* Values are rounded to the table's 32768 entries: a fraction of a step of 255 in sums, none to speak of in surfaces. */
static void modes_are_right(void** state)
{
  for (uint32_t seed = 0; seed < 30; ++seed) {
    tetra_case c;
    tetra_create(&c, 4, 0.2, seed % 3 == 0 ? 0.25 : 0.0, seed);
    c.options.mode = seed < 20 ? (stratus_tetra_mode)(STRATUS_TETRA_MAXIMUM + seed % 5) : STRATUS_TETRA_SLICE;
    set_slice(&c, seed);
    c.mesh.cell_values = seed % 4 == 3 && c.options.mode != STRATUS_TETRA_ISOSURFACE;
    set_contours(&c);
    set_planes(&c, (int)(seed % 3), seed % 2 == 1);
    if (seed % 4 == 2) {
      set_matrix(&c);
    }
    if (c.options.mode == STRATUS_TETRA_AVERAGE && seed > 5) {
      c.options.average_range[0] = 0.4;
      c.options.average_range[1] = 0.7;
    }
    c.transfer.unit_distance = 8.0; /* sums below 1 */
    tetra_camera(*state, &c, 4, (int)(seed % 8), seed & 1);
    is_right(*state, &c, 0.1, "random mesh");
    for (int i = 0; i < TETRA_PIXELS && c.options.mode >= STRATUS_TETRA_ISOSURFACE; ++i) {
      const double known = depth[i];
      assert_true(isinf(known) || isinf((double)picture.depth[i]) || fabs((double)picture.depth[i] - known) < 1e-3 * known);
    }
    tetra_destroy(&c);
  }
}

/* Both methods cut rays at planes and boxes, not cells. */
static void planes_cut_rays(void** state)
{
  for (uint32_t seed = 0; seed < 16; ++seed) {
    tetra_case c;
    tetra_create(&c, 4, 0.2, seed % 3 == 0 ? 0.25 : 0.0, seed);
    set_planes(&c, (int)(seed / 2 % 3), seed / 4 % 2 == 0);
    if (seed % 4 == 2) {
      set_matrix(&c);
    }
    c.options.mode = seed == 5 ? STRATUS_TETRA_MAXIMUM : STRATUS_TETRA_COMPOSITE;
    c.options.method = seed & 1 ? STRATUS_TETRA_METHOD_PROJECT : STRATUS_TETRA_METHOD_MARCH;
    tetra_camera(*state, &c, 4, (int)(seed / 2), seed % 8 > 5);
    is_right(*state, &c, 0.15, "cut");
    tetra_destroy(&c);
  }
}

/* Any of the 27 regions, in every mode: rays are cut exactly where they pass from one to another. */
static void regions_cut_rays(void** state)
{
  for (uint32_t seed = 0; seed < 21; ++seed) {
    tetra_case c;
    tetra_create(&c, 4, 0.2, seed % 3 == 0 ? 0.25 : 0.0, seed);
    set_contours(&c);
    set_slice(&c, seed);
    set_planes(&c, (int)(seed % 2), 1);
    if (seed % 4 == 2) {
      set_matrix(&c);
    }
    c.options.mode = (stratus_tetra_mode)(seed % 7);
    c.options.crop_regions =
      seed == 0 ? STRATUS_CROP_ALL - STRATUS_CROP_INSIDE : ((seed * 2654435761u >> 5) & STRATUS_CROP_ALL) | STRATUS_CROP_INSIDE;
    c.transfer.unit_distance = c.options.mode == STRATUS_TETRA_COMPOSITE ? 1.0 : 8.0;
    tetra_camera(*state, &c, 4, (int)(seed % 8), seed % 5 == 3);
    is_right(*state, &c, 0.15, "regions");
    tetra_destroy(&c);
  }
}

/* A plane that hides all, one that hides nothing, and one without a direction. */
static void planes_at_their_limits(void** state)
{
  static tetra_picture whole;
  tetra_case c;
  tetra_create(&c, 3, 0.2, 0.0, 1);
  tetra_camera(*state, &c, 3, 1, 0);
  tetra_draw(*state, &c, &whole);
  const double planes[4][4] = { { 0, 0, 1, 100 }, { 0, 0, 0, 1 }, { 0, 0, 1, -100 }, { 0, 0, 0, -1 } };
  c.options.clip_plane_count = 1;
  for (int p = 0; p < 4; ++p) {
    memcpy(c.options.clip_planes[0], planes[p], sizeof planes[p]);
    tetra_draw(*state, &c, &picture);
    for (int i = 0; i < 4 * TETRA_PIXELS; ++i) {
      assert_true(p < 2 ? memcmp(picture.rgba + i, whole.rgba + i, sizeof(float)) == 0 : !(picture.rgba[i] > 0.0f));
    }
  }
  tetra_destroy(&c);
}

/* A way along one cell: a ramp from 0 to 1 over two units of length, of opacity .5. */
static void one_cell_by_hand(void** state)
{
  static const double ends[4][3] = { { 0, 0, 0 }, { 9, 0, 0 }, { 0, 9, 0 }, { 0, 0, 2 } };
  static const int32_t vertices[4] = { 0, 1, 2, 3 };
  static const double opacity[4] = { 0, 0.5, 1, 0.5 }, color[4] = { 0, 1, 1, 1 };
  tetra_case c;
  tetra_create(&c, 1, 0.0, 0.0, 1);
  memcpy(c.points, ends, sizeof ends);
  memcpy(c.vertices, vertices, sizeof vertices);
  c.mesh.point_count = 4;
  c.mesh.cell_count = 1;
  c.values[0] = c.values[1] = c.values[2] = 0.0f;
  c.values[3] = 1.0f;
  memcpy(c.opacity, opacity, sizeof opacity);
  memcpy(c.color, color, sizeof color);
  c.transfer.opacity_count = 2;
  c.transfer.color_count = 1;
  c.transfer.unit_distance = 4.0;
  const double eye[3] = { 1e-3, 1e-3, -5 }, middle[3] = { 1e-3, 1e-3, 0 }, up[3] = { 0, 1, 0 };
  assert_int_equal(stratus_camera_parallel(*state, eye, middle, up, 0.01, 1.0, &c.camera), STRATUS_OK);
  const int at = 4 * (TETRA_WIDTH * (TETRA_HEIGHT / 2) + TETRA_WIDTH / 2);
  static const struct {
    stratus_tetra_mode mode;
    double grey;
  } known[3] = { { STRATUS_TETRA_AVERAGE, 0.25 }, { STRATUS_TETRA_ADDITIVE, 0.125 }, { STRATUS_TETRA_ISOSURFACE, 0.5 } };
  c.options.contours[0] = 0.25;
  c.options.contour_count = 1;
  for (int i = 0; i < 3; ++i) {
    c.options.mode = known[i].mode;
    tetra_draw(*state, &c, &picture);
    assert_true(fabs((double)picture.rgba[at] - known[i].grey) < 1e-3);
  }
  assert_true(fabs((double)picture.depth[at / 4] - 5.5) < 1e-3);
  tetra_destroy(&c);
}

static void wrong_options_are_refused(void** state)
{
  stratus_tetra_caster* caster = NULL;
  tetra_case c;
  tetra_create(&c, 2, 0.2, 0.0, 1);
  tetra_camera(*state, &c, 2, 1, 0);
  const stratus_image image = { .width = TETRA_WIDTH, .height = TETRA_HEIGHT, .rgba = picture.rgba };
  assert_int_equal(stratus_tetra_caster_create(*state, &caster), STRATUS_OK);
  for (int wrong = 0; wrong < 13; ++wrong) {
    stratus_tetra_options o = c.options;
    static const char* const words[] = { "clip_plane_count 7 outside 0..6", "clip_planes[0][2] is nan", "crop_bounds 2 .. 1 along axis 1",
      "average_range 1 .. 0", "0 contour values", "17 contour values", "contour 0 has value inf", "cannot be projected", "values of cells",
      "slice is no surface", "slice's center has inf", "crop regions 0x8000000, must be 0..0x7ffffff",
      "crop regions 0x1 cannot be projected" };
    stratus_mesh mesh = c.mesh;
    o.clip_plane_count = wrong == 0 ? 7 : wrong == 1 ? 1 : 0;
    o.clip_planes[0][2] = wrong == 1 ? NAN : 0.0;
    o.crop = wrong == 2;
    o.crop_bounds[2] = 2.0;
    o.crop_bounds[3] = 1.0;
    o.slice.linear[0] = wrong == 10;
    o.slice.center[1] = wrong == 10 ? (double)INFINITY : 0.0;
    o.mode = wrong == 3 ? STRATUS_TETRA_AVERAGE
      : wrong > 8       ? STRATUS_TETRA_SLICE
      : wrong > 3       ? STRATUS_TETRA_ISOSURFACE
                        : STRATUS_TETRA_COMPOSITE;
    o.average_range[0] = wrong == 3 ? 1.0 : 0.0;
    o.average_range[1] = 0.0;
    o.contour_count = wrong == 4 ? 0 : wrong == 5 ? 17 : 1;
    o.contours[0] = wrong == 6 ? (double)INFINITY : 0.5;
    o.method = wrong == 7 ? STRATUS_TETRA_METHOD_PROJECT : STRATUS_TETRA_METHOD_AUTO;
    if (wrong > 10) {
      o.mode = STRATUS_TETRA_COMPOSITE;
      o.crop = 1;
      o.crop_bounds[2] = 0.0;
      o.crop_regions = wrong == 11 ? STRATUS_CROP_ALL + 1 : 1;
      o.method = wrong == 12 ? STRATUS_TETRA_METHOD_PROJECT : o.method;
    }
    mesh.cell_values = wrong == 8;
    assert_int_equal(stratus_tetra_caster_render(caster, &mesh, &c.transfer, &c.camera, &o, &image, NULL),
      wrong < 7 || (wrong > 8 && wrong < 12) ? STRATUS_INVALID_ARGUMENT : STRATUS_UNSUPPORTED);
    if (!strstr(stratus_context_message(*state), words[wrong])) {
      print_error("%s\n", stratus_context_message(*state));
    }
    assert_non_null(strstr(stratus_context_message(*state), words[wrong]));
  }
  c.options.mode = STRATUS_TETRA_MINIMUM;
  c.options.method = STRATUS_TETRA_METHOD_AUTO;
  stratus_tetra_report report;
  assert_int_equal(stratus_tetra_caster_render(caster, &c.mesh, &c.transfer, &c.camera, &c.options, &image, &report), STRATUS_OK);
  assert_int_equal(report.method, STRATUS_TETRA_METHOD_MARCH);
  assert_string_equal(report.why, "march: mode minimum cannot be projected");
  stratus_tetra_caster_destroy(caster);
  tetra_destroy(&c);
}

int test_tetra_modes(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test_setup_teardown(modes_are_right, tetra_start, tetra_stop),
    cmocka_unit_test_setup_teardown(planes_cut_rays, tetra_start, tetra_stop),
    cmocka_unit_test_setup_teardown(regions_cut_rays, tetra_start, tetra_stop),
    cmocka_unit_test_setup_teardown(planes_at_their_limits, tetra_start, tetra_stop),
    cmocka_unit_test_setup_teardown(one_cell_by_hand, tetra_start, tetra_stop),
    cmocka_unit_test_setup_teardown(wrong_options_are_refused, tetra_start, tetra_stop),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
