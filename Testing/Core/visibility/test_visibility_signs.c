/* SPDX-License-Identifier: BSD-3-Clause
 * Signs of faces: every instruction set finds the same ones, and an order remains valid as long as they do not change. */
#include "mesh_case.h"
#include "visibility_order.h"

#include "ray_cast_host.h"
#include "testing.h"

static stratus_visibility_order* make_order(stratus_context* context, const mesh_case* mesh, const stratus_leaves* leaves)
{
  const stratus_mesh view = mesh_case_view(mesh);
  stratus_visibility_order* order = NULL;
  assert_int_equal(stratus_visibility_order_create(context, &view, leaves, &order), STRATUS_OK);
  return order;
}

/* A number of faces that is no multiple of the lanes, scattered cells, flat cells, an eye in a face's plane. */
static void every_instruction_set_finds_the_same_signs(void** state)
{
  static const int n[3] = { 5, 4, 3 };
  const int best = stratus_isa_best();
  int64_t exact = 0;
  (void)state;
  stratus_context* context = mesh_context(2);
  for (int kind = 0; kind < 12; ++kind) {
    mesh_case mesh = mesh_grid(n, kind % 3 ? 0.19 : 0.0, (uint32_t)kind);
    if (kind % 2) {
      mesh_shuffle(&mesh, (uint32_t)kind);
    }
    mesh.cell_count -= kind;
    stratus_visibility_order* order = make_order(context, &mesh, NULL);
    const stratus_view view = {
      .parallel = kind / 2 % 2, .direction = { 1, kind % 4 == 3 ? 0.0 : 0.25, 0 }, .eye = { 9, 2, kind % 3 ? 1.5 : 1.0 }
    };
    const size_t bytes = (size_t)order->cell_count * sizeof *order->state;
    void* expected = malloc(bytes);
    assert_non_null(expected);
    context->isa = best;
    exact += stratus_order_find_signs(order, &view);
    memcpy(expected, order->state, bytes);
    for (int isa = 0; isa < best; ++isa) {
      memset(order->state, 0x55, bytes);
      context->isa = isa;
      (void)stratus_order_find_signs(order, &view);
      assert_memory_equal(order->state, expected, bytes);
    }
    free(expected);
    stratus_visibility_order_destroy(order);
    mesh_case_free(&mesh);
  }
  assert_true(exact > 100); /* or nothing was near zero */
  stratus_context_destroy(context);
}

static int64_t wrong_pairs(const mesh_case* mesh, const stratus_camera* camera, const stratus_visibility_result* result)
{
  int64_t pairs = 0;
  const int64_t wrong = mesh_wrong_pairs(mesh, camera, result->cells, 100, 1, &pairs);
  assert_true(pairs > 100);
  return wrong;
}

/* A regular grid has few normals, so that most turns of parallel rays change no sign. Across a gap the order may change without a change of
 * sign. */
static void an_order_stands_as_long_as_its_signs(void** state)
{
  static const int n[3] = { 4, 4, 4 };
  (void)state;
  stratus_context* context = mesh_context(1);
  for (int i = 0; i < 4; ++i) {
    const bool gap = i & 1;
    const stratus_peeling peeling = i & 2 ? STRATUS_PEELING_NEAREST : STRATUS_PEELING_LAYERS;
    const bool exact = !gap || peeling == STRATUS_PEELING_NEAREST; /* layers cross gaps as it comes */
    mesh_case mesh = mesh_grid(n, 0.0, 1);
    if (gap) {
      mesh_case other = mesh_grid(n, 0.0, 1);
      mesh_move(&other, (const double[]){ 1, 1, 1 }, (const double[]){ 0, 0, 5 });
      mesh = mesh_join(mesh, other);
    }
    stratus_visibility_order* order = make_order(context, &mesh, NULL);
    stratus_camera camera = { .eye = { 2, 2, -9 }, .forward = { 0.1, 0.2, 0.9 }, .parallel = 1, .far_k = INFINITY };
    stratus_visibility_result result;
    assert_int_equal(stratus_visibility_order_sort(order, &camera, NULL, peeling, &result), STRATUS_OK);
    const int layers = result.layers;
    camera.forward[1] = 0.21;
    assert_int_equal(stratus_visibility_order_sort(order, &camera, NULL, peeling, &result), STRATUS_OK);
    assert_int_equal(result.reused, !gap);
    assert_int_equal(result.layers, layers);
    assert_true(!exact || wrong_pairs(&mesh, &camera, &result) == 0);
    camera.forward[1] = -0.2;
    assert_int_equal(stratus_visibility_order_sort(order, &camera, NULL, peeling, &result), STRATUS_OK);
    assert_int_equal(result.reused, 0);
    assert_true(!exact || wrong_pairs(&mesh, &camera, &result) == 0);
    stratus_visibility_order_destroy(order);
    mesh_case_free(&mesh);
  }
  stratus_context_destroy(context);
}

/* A partition's planes are along faces, which are then borders of leaves: an eye that passes one of them changes no sign. */
static void leaves_in_another_order_are_another_order(void** state)
{
  static const int n[3] = { 4, 4, 4 };
  (void)state;
  stratus_context* context = mesh_context(1);
  mesh_case mesh = mesh_grid(n, 0.0, 1);
  const stratus_mesh view = mesh_case_view(&mesh);
  stratus_partition* partition = NULL;
  stratus_partition_result cut;
  stratus_partition_options options = stratus_partition_options_default();
  options.leaf_cells = 16;
  assert_int_equal(stratus_partition_create(context, &view, &options, &partition), STRATUS_OK);
  stratus_partition_get(partition, &cut);
  assert_int_equal(cut.cell_count, mesh.cell_count);
  assert_int_equal(cut.leaves.leaf_count, 8);
  memcpy(mesh.vertices, cut.vertices, (size_t)cut.cell_count * 4 * sizeof *mesh.vertices); /* leaf by leaf */
  memcpy(mesh.points, cut.points, (size_t)cut.point_count * 3 * sizeof *mesh.points);
  stratus_visibility_order* order = make_order(context, &mesh, &cut.leaves);
  stratus_camera camera = { .eye = { 1.9, 9.25, 9.65 }, .forward = { 0, -1, -1 }, .far_k = INFINITY };
  stratus_visibility_result result;
  assert_int_equal(stratus_visibility_order_sort(order, &camera, NULL, STRATUS_PEELING_NEAREST, &result), STRATUS_OK);
  camera.eye[0] = 1.95;
  assert_int_equal(stratus_visibility_order_sort(order, &camera, NULL, STRATUS_PEELING_NEAREST, &result), STRATUS_OK);
  assert_int_equal(result.reused, 1);
  assert_int_equal(wrong_pairs(&mesh, &camera, &result), 0);
  camera.eye[0] = 2.05;
  assert_int_equal(stratus_visibility_order_sort(order, &camera, NULL, STRATUS_PEELING_NEAREST, &result), STRATUS_OK);
  assert_false(order->relations_changed);
  assert_int_equal(result.reused, 0);
  assert_int_equal(wrong_pairs(&mesh, &camera, &result), 0);
  stratus_visibility_order_destroy(order);
  stratus_partition_destroy(partition);
  mesh_case_free(&mesh);
  stratus_context_destroy(context);
}

int test_visibility_signs(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(an_order_stands_as_long_as_its_signs),
    cmocka_unit_test(leaves_in_another_order_are_another_order),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}

int test_visibility_signs_isa(void)
{
  if (stratus_isa_best() == 0) {
    return test_skip("the baseline is the only instruction set here");
  }
  const struct CMUnitTest tests[] = { cmocka_unit_test(every_instruction_set_finds_the_same_signs) };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
