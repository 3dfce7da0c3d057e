/* SPDX-License-Identifier: BSD-3-Clause
 * Hard cases for pictures of tetrahedra: views along faces, edges and points; gaps, several parts, folds, flat and inverted cells, slivers,
 * coincident points, seams; nothing to draw; refused memory; invalid arguments. Each case has its expected result. */
#include "faulty_allocator.h"
#include "tetra_case.h"

static tetra_picture picture;
static double reference[4 * TETRA_PIXELS_MOST];

/* A constant transfer function, so that alpha measures the thickness. */
static void make_plain(tetra_case* c, double opacity)
{
  for (int i = 0; i < 4; ++i) {
    c->opacity[2 * i + 1] = opacity;
  }
}

static void agrees(stratus_context* context, const tetra_case* c, double rmse, const char* what)
{
  double largest;
  tetra_draw(context, c, &picture);
  tetra_reference(c, reference, NULL);
  const double error = tetra_error(picture.rgba, reference, &largest);
  if (!(error <= rmse)) {
    print_error("%s: RMSE %.4f of 255, at most %g; largest %.3f\n", what, error, rmse, largest);
  }
  assert_true(error <= rmse);
  assert_int_equal(picture.report.stuck, 0);
}

/* Rays through points, along edges and within faces: every pixel sees the whole cube. */
static void views_along_faces_edges_and_points(void** state)
{
  static const double ups[3][3] = { { 0, 0, 1 }, { 1, 0, 0 }, { 0, 1, 0 } };
  for (int axis = 0; axis < 3; ++axis) {
    for (int back = 0; back < 2; ++back) {
      tetra_case c;
      double eye[3] = { 2, 2, 2 };
      const double focal[3] = { 2, 2, 2 };
      tetra_create(&c, 4, 0.0, 0.0, 1);
      make_plain(&c, 0.2);
      eye[axis] += back ? 9 : -9;
      /* pixels are 1/11.25 wide and 1/9.25 high: with odd numbers of them, many are exactly on the grid's lines */
      assert_int_equal(stratus_camera_parallel(*state, eye, focal, ups[axis], TETRA_HEIGHT / 24.0, 45.0 / 37.0, &c.camera), STRATUS_OK);
      tetra_draw(*state, &c, &picture);
      const double alpha = 1.0 - pow(0.8, 4.0);
      for (int i = 0; i < TETRA_PIXELS; ++i) {
        assert_true(fabs((double)picture.rgba[4 * i + 3] - alpha) < 2e-6);
      }
      assert_int_equal(picture.report.stuck, 0);
      assert_int_equal(picture.report.entries, tetra_method == STRATUS_TETRA_METHOD_MARCH ? TETRA_PIXELS : 0);
      tetra_destroy(&c);
    }
  }
}

static void add_copy(tetra_case* c, int64_t points, int64_t cells, double dx, double dy)
{
  for (int64_t i = 0; i < points; ++i) {
    const int64_t to = c->mesh.point_count + i;
    memcpy(c->points + 3 * to, c->points + 3 * i, 3 * sizeof(double));
    c->points[3 * to] += dx;
    c->points[3 * to + 1] += dy;
    c->values[to] = c->values[i];
  }
  for (int64_t i = 0; i < 4 * cells; ++i) {
    c->vertices[4 * c->mesh.cell_count + i] = c->vertices[i] + (int32_t)c->mesh.point_count;
  }
  c->mesh.point_count += points;
  c->mesh.cell_count += cells;
}

/* Reallocates the arrays of tetra_create() to `times` their size. */
static void widen(tetra_case* c, size_t times)
{
  c->points = realloc(c->points, times * (size_t)c->mesh.point_count * 3 * sizeof(double));
  c->values = realloc(c->values, times * (size_t)c->mesh.point_count * sizeof(float));
  c->vertices = realloc(c->vertices, times * (size_t)c->mesh.cell_count * 4 * sizeof(int32_t));
  assert_true(c->points && c->values && c->vertices);
  c->mesh.points = c->points;
  c->mesh.values = c->values;
  c->mesh.vertices = c->vertices;
}

static void parts_with_gaps_and_parts_that_touch(void** state)
{
  static const double shifts[3] = { 2.7, 2.0, 4.5 }; /* two boxes wide: a gap, coincident points and faces that nothing joins, a wide gap */
  for (int i = 0; i < 3; ++i) {
    tetra_case c;
    tetra_create(&c, 2, 0.0, 0.0, 3);
    const int64_t points = c.mesh.point_count, cells = c.mesh.cell_count;
    widen(&c, 4);
    add_copy(&c, points, cells, shifts[i], 0.0);
    add_copy(&c, points, cells, 0.0, shifts[i]);
    add_copy(&c, points, cells, shifts[i], shifts[i]);
    tetra_camera(*state, &c, 4, i, 0);
    agrees(*state, &c, 0.025, "parts");
    tetra_destroy(&c);
  }
}

/* Points drawn to where cells have almost no volume, or none. */
static void slivers_and_flat_cells(void** state)
{
  static const double thickness[4] = { 1e-3, 1e-7, 1e-12, 0.0 };
  for (int i = 0; i < 4; ++i) {
    tetra_case c;
    tetra_create(&c, 3, 0.0, 0.1, 4);
    for (int64_t p = 0; p < c.mesh.point_count; ++p) {
      if (c.points[3 * p + 2] == 2.0) {
        c.points[3 * p + 2] = 1.0 + thickness[i];
      }
    }
    tetra_camera(*state, &c, 3, i, i & 1);
    agrees(*state, &c, 0.05, "slivers");
    assert_int_equal(picture.report.flat > 0, thickness[i] == 0.0);
    tetra_destroy(&c);
  }
}

/* Flat cells at the border, between two others, and separate; a cell that names a point twice. */
static void flat_cells_at_the_border(void** state)
{
  static const double points[6][3] = { { 0, 0, 0 }, { 3, 0, 0 }, { 0, 3, 0 }, { 3, 3, 0 }, { 1, 1, 3 }, { 5, 5, 0 } };
  static const int32_t vertices[4][4] = { { 0, 1, 2, 4 }, { 0, 1, 2, 3 }, { 0, 0, 1, 4 }, { 1, 2, 3, 5 } };
  tetra_case c;
  tetra_create(&c, 2, 0.0, 0.0, 5);
  memcpy(c.points, points, sizeof points);
  memcpy(c.vertices, vertices, sizeof vertices);
  c.mesh.point_count = 6;
  c.mesh.cell_count = 4;
  for (int view = 0; view < 8; ++view) {
    tetra_camera(*state, &c, 3, view, view & 1);
    agrees(*state, &c, 0.025, "flat");
    assert_int_equal(picture.report.flat, 3);
  }
  tetra_destroy(&c);
}

/* A point pulled through the opposite face inverts cells. Overlapping parts are still drawn, no part is lost, and every ray ends. */
static void inverted_cells(void** state)
{
  for (uint32_t seed = 0; seed < 20; ++seed) {
    tetra_case c;
    tetra_create(&c, 4, 0.9, 0.0, seed);
    make_plain(&c, 0.05);
    for (int i = 0; i < 12; ++i) {
      c.color[i] = i & 3 ? 0.5 : c.color[i]; /* order does not count then, only that every cell does */
    }
    tetra_camera(*state, &c, 4, (int)seed % 8, seed & 1);
    agrees(*state, &c, 0.05, "inverted");
    assert_true(picture.report.folded_faces > 0);
    tetra_destroy(&c);
  }
}

static void seams_whose_diagonals_do_not_match(void** state)
{
  tetra_case c;
  tetra_create(&c, 2, 0.0, 0.0, 6);
  const int64_t points = c.mesh.point_count, cells = c.mesh.cell_count;
  widen(&c, 2);
  add_copy(&c, points, cells, 0.0, 0.0);
  for (int64_t i = points; i < 2 * points; ++i) { /* a mirror image next to it */
    c.points[3 * i] = 4.0 - c.points[3 * i];
  }
  for (int view = 0; view < 8; ++view) {
    tetra_camera(*state, &c, 4, view, 0);
    agrees(*state, &c, 0.025, "seam");
  }
  tetra_destroy(&c);
}

static void nothing_to_draw(void** state)
{
  for (int i = 0; i < 5; ++i) {
    tetra_case c;
    tetra_create(&c, 2, 0.2, 0.0, 7);
    tetra_camera(*state, &c, 2, 0, 0);
    if (i == 0) {
      c.mesh.cell_count = 0;
    } else if (i == 1) {
      c.mesh.cell_count = c.mesh.point_count = 0;
      c.mesh.points = NULL;
      c.mesh.vertices = NULL;
      c.mesh.values = NULL;
    } else if (i == 2) {
      memset(c.hidden, 1, (size_t)c.mesh.cell_count);
      c.mesh.hidden = c.hidden;
    } else if (i == 3) {
      make_plain(&c, 0.0);
    } else {
      for (int64_t p = 0; p < c.mesh.point_count; ++p) {
        c.values[p] = NAN;
      }
    }
    tetra_draw(*state, &c, &picture);
    for (int p = 0; p < TETRA_PIXELS; ++p) {
      assert_true(picture.rgba[4 * p + 3] == 0.0f && isinf(picture.depth[p]) && picture.samples[p] == 0 && picture.rgba8[4 * p] == 0);
    }
    tetra_destroy(&c);
  }
}

static void one_cell(void** state)
{
  tetra_case c;
  tetra_create(&c, 2, 0.2, 0.0, 8);
  c.mesh.cell_count = 1;
  tetra_camera(*state, &c, 1, 0, 0);
  agrees(*state, &c, 0.025, "one cell");
  tetra_destroy(&c);
}

static void arguments_that_are_none(void** state)
{
  tetra_case c;
  stratus_tetra_caster* caster = NULL;
  stratus_context* context = *state;
  tetra_create(&c, 2, 0.2, 0.0, 9);
  tetra_camera(context, &c, 2, 0, 0);
  stratus_image image = { .width = TETRA_WIDTH, .height = TETRA_HEIGHT, .rgba = picture.rgba };
  assert_int_equal(stratus_tetra_caster_create(NULL, &caster), STRATUS_INVALID_ARGUMENT);
  assert_int_equal(stratus_tetra_caster_create(context, NULL), STRATUS_INVALID_ARGUMENT);
  assert_int_equal(stratus_tetra_caster_create(context, &caster), STRATUS_OK);
#define REFUSED(mesh, transfer, camera, options, image, word)                                                                              \
  assert_int_equal(stratus_tetra_caster_render(caster, mesh, transfer, camera, options, image, NULL), STRATUS_INVALID_ARGUMENT);           \
  assert_non_null(strstr(stratus_context_message(context), word))
  assert_int_equal(stratus_tetra_caster_render(NULL, &c.mesh, &c.transfer, &c.camera, NULL, &image, NULL), STRATUS_INVALID_ARGUMENT);
  REFUSED(NULL, &c.transfer, &c.camera, NULL, &image, "mesh");
  REFUSED(&c.mesh, NULL, &c.camera, NULL, &image, "transfer");
  REFUSED(&c.mesh, &c.transfer, NULL, NULL, &image, "camera");
  REFUSED(&c.mesh, &c.transfer, &c.camera, NULL, NULL, "image");
  image.width = 0;
  REFUSED(&c.mesh, &c.transfer, &c.camera, NULL, &image, "1..65536");
  image.width = TETRA_WIDTH;
  stratus_tetra_options options = c.options;
  options.termination = 1.5;
  REFUSED(&c.mesh, &c.transfer, &c.camera, &options, &image, "1.5");
  options = c.options;
  options.mode = (stratus_tetra_mode)(STRATUS_TETRA_QUANTITIES + 1);
  REFUSED(&c.mesh, &c.transfer, &c.camera, &options, &image, "mode 9");
  options = c.options;
  options.method = (stratus_tetra_method)3;
  REFUSED(&c.mesh, &c.transfer, &c.camera, &options, &image, "method 3");
  stratus_mesh mesh = c.mesh;
  mesh.values = NULL;
  REFUSED(&mesh, &c.transfer, &c.camera, NULL, &image, "values");
  mesh = c.mesh;
  mesh.matrix[0] = NAN;
  REFUSED(&mesh, &c.transfer, &c.camera, NULL, &image, "matrix");
  c.vertices[7] = 27;
  REFUSED(&c.mesh, &c.transfer, &c.camera, NULL, &image, "27");
  c.vertices[7] = 3;
  stratus_camera camera = c.camera;
  camera.right[0] = camera.right[1] = camera.right[2] = 0.0;
  REFUSED(&c.mesh, &c.transfer, &camera, NULL, &image, "one plane");
  assert_int_equal(stratus_tetra_caster_render(caster, &c.mesh, &c.transfer, &c.camera, NULL, &image, NULL), STRATUS_OK);
  stratus_tetra_caster_destroy(caster);
  stratus_tetra_caster_destroy(NULL);
  stratus_tetra_caster_release(NULL);
  tetra_destroy(&c);
}

/* Every allocation is refused once: an error with a message, no leak, and the next call draws. */
static void refused_memory(void** state)
{
  static tetra_picture whole;
  tetra_case c;
  tetra_create(&c, 3, 0.2, 0.2, 10);
  tetra_camera(*state, &c, 3, 0, 0);
  tetra_draw(*state, &c, &whole);
  const stratus_image image = { .width = TETRA_WIDTH, .height = TETRA_HEIGHT, .rgba = picture.rgba };
  int refused = 0;
  for (int64_t fail_at = 1;; ++fail_at) {
    faulty_allocator allocator = { 0 };
    const stratus_context_options options = faulty_options(&allocator, "host");
    stratus_context* context = NULL;
    stratus_tetra_caster* caster = NULL;
    assert_int_equal(stratus_context_create(&options, &context, NULL, 0), STRATUS_OK);
    assert_int_equal(stratus_tetra_caster_create(context, &caster), STRATUS_OK);
    const int64_t before = allocator.calls;
    allocator.fail_at = before + fail_at;
    stratus_status status = stratus_tetra_caster_render(caster, &c.mesh, &c.transfer, &c.camera, &c.options, &image, NULL);
    const int reached = allocator.calls >= allocator.fail_at;
    if (reached) {
      assert_int_equal(status, STRATUS_OUT_OF_MEMORY);
      assert_true(strlen(stratus_context_message(context)) > 0);
      ++refused;
      status = stratus_tetra_caster_render(caster, &c.mesh, &c.transfer, &c.camera, &c.options, &image, NULL);
    }
    assert_int_equal(status, STRATUS_OK);
    assert_memory_equal(picture.rgba, whole.rgba, sizeof whole.rgba);
    stratus_tetra_caster_destroy(caster);
    stratus_context_destroy(context);
    assert_int_equal(allocator.live, 0);
    if (!reached) {
      break;
    }
  }
  assert_true(refused > 15);
  tetra_destroy(&c);
}

static int cancel(void* user, const char* stage, double fraction)
{
  (void)fraction;
  return strcmp(stage, user) == 0;
}

static void cancelled(void** state)
{
  static char stage[8];
  tetra_case c;
  stratus_context* context = NULL;
  stratus_tetra_caster* caster = NULL;
  stratus_context_options options = stratus_context_options_default();
  options.device = "host";
  options.threads = 1;
  options.progress = cancel;
  options.progress_user = stage;
  strcpy(stage, stratus_tetra_method_name(tetra_method));
  tetra_create(&c, 3, 0.2, 0.2, 10);
  tetra_camera(*state, &c, 3, 0, 0);
  const stratus_image image = { .width = TETRA_WIDTH, .height = TETRA_HEIGHT, .rgba = picture.rgba };
  assert_int_equal(stratus_context_create(&options, &context, NULL, 0), STRATUS_OK);
  assert_int_equal(stratus_tetra_caster_create(context, &caster), STRATUS_OK);
  assert_int_equal(stratus_tetra_caster_render(caster, &c.mesh, &c.transfer, &c.camera, &c.options, &image, NULL), STRATUS_CANCELLED);
  stage[0] = 'x';
  assert_int_equal(stratus_tetra_caster_render(caster, &c.mesh, &c.transfer, &c.camera, &c.options, &image, NULL), STRATUS_OK);
  stratus_tetra_caster_destroy(caster);
  stratus_context_destroy(context);
  tetra_destroy(&c);
}

int test_tetra_march_fails(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(views_along_faces_edges_and_points),
    cmocka_unit_test(parts_with_gaps_and_parts_that_touch),
    cmocka_unit_test(slivers_and_flat_cells),
    cmocka_unit_test(flat_cells_at_the_border),
    cmocka_unit_test(inverted_cells),
    cmocka_unit_test(seams_whose_diagonals_do_not_match),
    cmocka_unit_test(nothing_to_draw),
    cmocka_unit_test(one_cell),
    cmocka_unit_test(arguments_that_are_none),
    cmocka_unit_test(refused_memory),
    cmocka_unit_test(cancelled),
  };
  int failed = 0;
  for (tetra_method = STRATUS_TETRA_METHOD_MARCH; tetra_method <= STRATUS_TETRA_METHOD_PROJECT; ++tetra_method) {
    failed += cmocka_run_group_tests_name(stratus_tetra_method_name(tetra_method), tests, tetra_start, tetra_stop);
  }
  return failed;
}
