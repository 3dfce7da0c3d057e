/* SPDX-License-Identifier: BSD-3-Clause
 * The meshes of record: the lattice fills its cube and its cells meet face to face, the plate's surface is closed and encloses the right
 * volume, and both are the meshes that figures were measured on. */
#include "faulty_allocator.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#define WAVELET_LOW -64.324211
#define WAVELET_HIGH 197.079147

static stratus_context* host(void)
{
  stratus_context_options options = stratus_context_options_default();
  stratus_context* context = NULL;
  options.device = "host";
  assert_int_equal(stratus_context_create(&options, &context, NULL, 0), STRATUS_OK);
  return context;
}

static double volume(const double* a, const double* b, const double* c, const double* d)
{
  double u[3], v[3], w[3];
  for (int i = 0; i < 3; ++i) {
    u[i] = b[i] - a[i];
    v[i] = c[i] - a[i];
    w[i] = d[i] - a[i];
  }
  return (u[0] * (v[1] * w[2] - v[2] * w[1]) + u[1] * (v[2] * w[0] - v[0] * w[2]) + u[2] * (v[0] * w[1] - v[1] * w[0])) / 6.0;
}

/* Above 0 if the path a, b, c, d turns the same way at b and c. */
static double turn(const double* a, const double* b, const double* c, const double* d)
{
  double first[3], second[3];
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    first[i] = (b[j] - a[j]) * (c[k] - b[k]) - (b[k] - a[k]) * (c[j] - b[j]);
    second[i] = (c[j] - b[j]) * (d[k] - c[k]) - (c[k] - b[k]) * (d[j] - c[j]);
  }
  return first[0] * second[0] + first[1] * second[1] + first[2] * second[2];
}

static void test_wavelet_fills_its_cube_face_to_face(void** state)
{
  (void)state;
  stratus_context* context = host();
  stratus_mesh_scene* scene = NULL;
  double low = INFINITY, high = -INFINITY;
  assert_int_equal(stratus_mesh_scene_create(context, "wavelet", &scene), STRATUS_OK);
  const stratus_mesh* mesh = &scene->mesh;
  assert_int_equal(stratus_mesh_check(context, mesh), STRATUS_OK);
  assert_int_equal(mesh->cell_count, 998250);
  assert_int_equal(mesh->point_count, 56 * 56 * 56);
  assert_true(scene->quads == NULL && scene->quad_count == 0 && scene->maximum_volume == 0.0);
  for (int64_t c = 0; c < mesh->cell_count; ++c) {
    const int32_t* v = mesh->vertices + 4 * c;
    const double size = volume(mesh->points + 3 * v[0], mesh->points + 3 * v[1], mesh->points + 3 * v[2], mesh->points + 3 * v[3]);
    assert_true(fabs(size) == 1.0 / 6.0);
  }
  for (int64_t i = 0; i < mesh->point_count; ++i) {
    const double value = (double)((const float*)mesh->values)[i];
    assert_true(value == (double)(float)stratus_mesh_scene_value("wavelet", mesh->points + 3 * i));
    low = fmin(low, value);
    high = fmax(high, value);
  }
  assert_true(fabs(low - WAVELET_LOW) < 1e-3 && fabs(high - WAVELET_HIGH) < 1e-3);
  /* Only the faces of the cube have no cell on their other side. */
  stratus_tetra_caster* caster = NULL;
  stratus_tetra_report report;
  static float rgba[4 * 16 * 16];
  const double bounds[6] = { 0, 55, 0, 55, 0, 55 }, opacity[4] = { -100, 0, 200, .1 }, color[4] = { 0, 1, 1, 1 };
  stratus_transfer transfer = stratus_transfer_default();
  stratus_camera camera;
  transfer.opacity = opacity;
  transfer.opacity_count = 2;
  transfer.color = color;
  transfer.color_count = 1;
  const stratus_image image = { .width = 16, .height = 16, .rgba = rgba };
  assert_int_equal(stratus_scene_camera(context, bounds, 2, 0, 0, 1.0, &camera), STRATUS_OK);
  assert_int_equal(stratus_tetra_caster_create(context, &caster), STRATUS_OK);
  assert_int_equal(stratus_tetra_caster_render(caster, mesh, &transfer, &camera, NULL, &image, &report), STRATUS_OK);
  assert_int_equal(report.border_faces, 12 * 55 * 55);
  assert_true(report.flat == 0 && report.broken_faces == 0 && report.folded_faces == 0);
  stratus_tetra_caster_destroy(caster);
  stratus_mesh_scene_destroy(context, scene);
  stratus_context_destroy(context);
}

/* No tetrahedron is flat, a wedge's tetrahedra fill it, and only bed, surface and the four sides are borders. */
static void test_estuary_is_filled_face_to_face(void** state)
{
  (void)state;
  stratus_context* context = host();
  stratus_mesh_scene* scene = NULL;
  double filled = 0.0, meant = 0.0;
  assert_int_equal(stratus_mesh_scene_create(context, "estuary", &scene), STRATUS_OK);
  const stratus_mesh* mesh = &scene->mesh;
  assert_int_equal(stratus_mesh_check(context, mesh), STRATUS_OK);
  assert_int_equal(mesh->cell_count, 6 * 96 * 48 * 12);
  for (int64_t c = 0; c < mesh->cell_count; ++c) {
    const int32_t* v = mesh->vertices + 4 * c;
    const double size = volume(mesh->points + 3 * v[0], mesh->points + 3 * v[1], mesh->points + 3 * v[2], mesh->points + 3 * v[3]);
    assert_true(fabs(size) > 1e-7);
    filled += fabs(size);
  }
  const int64_t up = 97 * 49;
  for (int64_t i = 0; i < mesh->point_count; ++i) {
    const double *p = mesh->points + 3 * i, value = (double)((const float*)mesh->values)[i];
    assert_true(value == (double)(float)stratus_mesh_scene_value("estuary", p) && value >= 0.0 && value < 1.3);
    assert_true(i < up || p[2] > p[2 - 3 * up]); /* above the point of the layer beneath */
  }
  for (int64_t cell = 0; cell < mesh->cell_count; cell += 3) { /* a wedge: the mean of its heights times its base */
    const int32_t* v = mesh->vertices + 4 * cell;
    const int32_t *second = v + 4, *third = v + 8;
    const double* p[3] = { mesh->points + 3 * v[0], mesh->points + 3 * second[1], mesh->points + 3 * third[2] };
    double height = 0.0;
    for (int i = 0; i < 3; ++i) {
      height += (p[i][3 * up + 2] - p[i][2]) / 3.0;
    }
    meant += 0.5 * fabs((p[1][0] - p[0][0]) * (p[2][1] - p[0][1]) - (p[1][1] - p[0][1]) * (p[2][0] - p[0][0])) * height;
  }
  assert_true(fabs(filled - meant) < 1e-9 * meant);
  stratus_tetra_caster* caster = NULL;
  stratus_tetra_report report;
  static float rgba[4 * 16 * 16];
  const double bounds[6] = { 0, 12, 0, 6, -1, 0 }, opacity[4] = { 0, 0, 1, .1 }, color[4] = { 0, 1, 1, 1 };
  stratus_transfer transfer = stratus_transfer_default();
  stratus_camera camera;
  transfer.opacity = opacity;
  transfer.opacity_count = 2;
  transfer.color = color;
  transfer.color_count = 1;
  const stratus_image image = { .width = 16, .height = 16, .rgba = rgba };
  assert_int_equal(stratus_scene_camera(context, bounds, 2, 0, 0, 1.0, &camera), STRATUS_OK);
  assert_int_equal(stratus_tetra_caster_create(context, &caster), STRATUS_OK);
  assert_int_equal(stratus_tetra_caster_render(caster, mesh, &transfer, &camera, NULL, &image, &report), STRATUS_OK);
  assert_int_equal(report.border_faces, 4 * 96 * 48 + 4 * (96 + 48) * 12);
  assert_true(report.flat == 0 && report.broken_faces == 0 && report.folded_faces == 0);
  stratus_tetra_caster_destroy(caster);
  stratus_mesh_scene_destroy(context, scene);
  stratus_context_destroy(context);
}

/* Each edge occurs once in each direction, the quads are planar, and they enclose the plate without its holes, which are polygons of 32
 * corners. */
static void test_holes_are_a_closed_surface(void** state)
{
  (void)state;
  stratus_context* context = host();
  stratus_mesh_scene* scene = NULL;
  assert_int_equal(stratus_mesh_scene_create(context, "holes", &scene), STRATUS_OK);
  const int64_t points = scene->mesh.point_count;
  int8_t* edges = calloc((size_t)(points * points), 1);
  double enclosed = 0.0;
  assert_non_null(edges);
  assert_int_equal(scene->mesh.cell_count, 0);
  assert_true(scene->quad_count == 2464 && scene->maximum_volume > 0.0);
  for (int64_t q = 0; q < scene->quad_count; ++q) {
    const int32_t* v = scene->quads + 4 * q;
    const double* p[4];
    for (int i = 0; i < 4; ++i) {
      assert_true(v[i] >= 0 && v[i] < points);
      assert_int_equal(edges[v[i] * points + v[(i + 1) % 4]]++, 0);
      p[i] = scene->mesh.points + 3 * v[i];
    }
    const double zero[3] = { 0, 0, 0 };
    assert_true(fabs(volume(p[0], p[1], p[2], p[3])) < 1e-15);
    for (int i = 0; i < 4; ++i) {
      assert_true(turn(p[i], p[(i + 1) % 4], p[(i + 2) % 4], p[(i + 3) % 4]) > 0.0); /* convex */
    }
    enclosed += volume(zero, p[0], p[1], p[2]) + volume(zero, p[0], p[2], p[3]);
  }
  for (int64_t e = 0; e < points * points; ++e) {
    assert_int_equal(edges[e], edges[e % points * points + e / points]);
  }
  const double hole = 16.0 * .3 * .3 * sin(3.14159265358979323846 / 16.0);
  assert_true(fabs(enclosed - .4 * 24.0 * (1.0 - hole)) < 1e-12);
  for (int64_t i = 0; i < points; ++i) {
    const double value = stratus_mesh_scene_value("holes", scene->mesh.points + 3 * i);
    assert_true(value >= 0.0 && value < 4.0);
  }
  free(edges);
  stratus_mesh_scene_destroy(context, scene);
  stratus_context_destroy(context);
}

static void test_names_and_refusals(void** state)
{
  (void)state;
  stratus_context* context = host();
  stratus_mesh_scene* scene = NULL;
  const double origin[3] = { 0, 0, 0 };
  assert_int_equal(stratus_mesh_scene_count(), 3);
  assert_string_equal(stratus_mesh_scene_name(0), "estuary");
  assert_string_equal(stratus_mesh_scene_name(1), "holes");
  assert_string_equal(stratus_mesh_scene_name(2), "wavelet");
  assert_null(stratus_mesh_scene_name(3));
  assert_null(stratus_mesh_scene_name(-1));
  assert_int_equal(stratus_mesh_scene_create(context, "sieve", &scene), STRATUS_INVALID_ARGUMENT);
  assert_non_null(strstr(stratus_context_message(context), "sieve"));
  assert_int_equal(stratus_mesh_scene_create(context, NULL, &scene), STRATUS_INVALID_ARGUMENT);
  assert_int_equal(stratus_mesh_scene_create(context, "holes", NULL), STRATUS_INVALID_ARGUMENT);
  assert_int_equal(stratus_mesh_scene_create(NULL, "holes", &scene), STRATUS_INVALID_ARGUMENT);
  assert_null(scene);
  assert_true(isnan(stratus_mesh_scene_value("sieve", origin)) && isnan(stratus_mesh_scene_value("holes", NULL)));
  stratus_mesh_scene_destroy(context, NULL);
  stratus_context_destroy(context);
}

static void test_out_of_memory_is_an_error_without_a_leak(void** state)
{
  (void)state;
  for (int index = 0; index < stratus_mesh_scene_count(); ++index) {
    int refused = 0;
    for (int64_t fail_at = 1;; ++fail_at) {
      faulty_allocator allocator = { 0 };
      const stratus_context_options options = faulty_options(&allocator, "host");
      stratus_context* context = NULL;
      stratus_mesh_scene* scene = NULL;
      assert_int_equal(stratus_context_create(&options, &context, NULL, 0), STRATUS_OK);
      const int64_t before = allocator.live;
      allocator.fail_at = allocator.calls + fail_at;
      const stratus_status status = stratus_mesh_scene_create(context, stratus_mesh_scene_name(index), &scene);
      refused += status != STRATUS_OK;
      assert_true(status == STRATUS_OK || (status == STRATUS_OUT_OF_MEMORY && scene == NULL && allocator.live == before));
      stratus_mesh_scene_destroy(context, scene);
      assert_int_equal(allocator.live, before);
      stratus_context_destroy(context);
      if (status == STRATUS_OK) {
        break;
      }
    }
    assert_true(refused >= 3);
  }
}

int test_mesh_scenes(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_wavelet_fills_its_cube_face_to_face),
    cmocka_unit_test(test_estuary_is_filled_face_to_face),
    cmocka_unit_test(test_holes_are_a_closed_surface),
    cmocka_unit_test(test_names_and_refusals),
    cmocka_unit_test(test_out_of_memory_is_an_error_without_a_leak),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
