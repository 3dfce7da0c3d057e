/* SPDX-License-Identifier: BSD-3-Clause
 * Signs of faces: the same at any instruction set, and an order that stands as long as they do. */
#include "mesh_case.h"
#include "visibility_order.h"

#include "Core/ray_cast.h"

static stratus_visibility_order* make_order(stratus_context* context, const mesh_case* mesh)
{
  const stratus_mesh view = mesh_case_view(mesh);
  stratus_visibility_order* order = NULL;
  assert_int_equal(stratus_visibility_order_create(context, &view, NULL, &order), STRATUS_OK);
  return order;
}

/* Cells, distances and all: a count that fills no lanes evenly, scattered cells, flat ones, an eye in a face's plane. */
static void every_instruction_set_finds_the_same_signs(void** state)
{
  static const int n[3] = { 5, 4, 3 };
  const int best = stratus_ray_cast_best_isa();
  int64_t exact = 0;
  (void)state;
  if (best == 0) {
    print_message("SKIPPED: this machine has the baseline only\n");
    skip();
  }
  stratus_context* context = mesh_context(2);
  for (int kind = 0; kind < 12; kind++) {
    mesh_case mesh = mesh_grid(n, kind % 3 ? 0.19 : 0.0, (uint32_t)kind);
    if (kind % 2) {
      mesh_shuffle(&mesh, (uint32_t)kind);
    }
    mesh.cell_count -= kind;
    stratus_visibility_order* order = make_order(context, &mesh);
    const stratus_view view = { .parallel = kind / 2 % 2, .direction = { 1, kind % 4 == 3 ? 0.0 : 0.25, 0 }, .eye = { 9, 2, kind % 3 ? 1.5 : 1.0 } };
    const size_t bytes = (size_t)order->cell_count * sizeof *order->ordered;
    void* expected = malloc(bytes);
    assert_non_null(expected);
    context->isa = best;
    exact += stratus_order_find_signs(order, &view);
    memcpy(expected, order->ordered, bytes);
    for (int isa = 0; isa < best; isa++) {
      for (int64_t i = 0; i < order->cell_count; i++) {
        order->ordered[i].next = 0x55555555u;
        order->ordered[i].state = order->ordered[i].waiting = 0x55;
      }
      context->isa = isa;
      (void)stratus_order_find_signs(order, &view);
      assert_memory_equal(order->ordered, expected, bytes);
    }
    free(expected);
    stratus_visibility_order_destroy(order);
    mesh_case_free(&mesh);
  }
  assert_true(exact > 100); /* or nothing was near zero */
  stratus_context_destroy(context);
}

/* A regular grid has few normals: most turns of parallel rays change no sign. Across a gap none need change for the order to be another. */
static void an_order_stands_as_long_as_its_signs(void** state)
{
  static const int n[3] = { 4, 4, 4 };
  (void)state;
  stratus_context* context = mesh_context(1);
  for (int gap = 0; gap < 2; gap++) {
    mesh_case mesh = mesh_grid(n, 0.0, 1);
    if (gap) {
      mesh_case other = mesh_grid(n, 0.0, 1);
      mesh_move(&other, (const double[]){ 1, 1, 1 }, (const double[]){ 0, 0, 5 });
      mesh = mesh_join(mesh, other);
    }
    stratus_visibility_order* order = make_order(context, &mesh);
    stratus_camera camera = { .eye = { 2, 2, -9 }, .forward = { 0.1, 0.2, 0.9 }, .parallel = 1, .far_k = INFINITY };
    stratus_visibility_result result;
    int64_t pairs = 0;
    assert_int_equal(stratus_visibility_order_sort(order, &camera, NULL, STRATUS_PEELING_LAYERS, &result), STRATUS_OK);
    const int layers = result.layers;
    camera.forward[1] = 0.21;
    assert_int_equal(stratus_visibility_order_sort(order, &camera, NULL, STRATUS_PEELING_LAYERS, &result), STRATUS_OK);
    assert_int_equal(result.reused, !gap);
    assert_int_equal(result.layers, layers);
    assert_true(gap || mesh_wrong_pairs(&mesh, &camera, result.cells, 100, 1, &pairs) == 0); /* layers cross gaps as it comes */
    camera.forward[1] = -0.2;
    assert_int_equal(stratus_visibility_order_sort(order, &camera, NULL, STRATUS_PEELING_LAYERS, &result), STRATUS_OK);
    assert_int_equal(result.reused, 0);
    assert_true(gap || mesh_wrong_pairs(&mesh, &camera, result.cells, 100, 2, &pairs) == 0);
    assert_true(gap || pairs > 100);
    stratus_visibility_order_destroy(order);
    mesh_case_free(&mesh);
  }
  stratus_context_destroy(context);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(every_instruction_set_finds_the_same_signs),
    cmocka_unit_test(an_order_stands_as_long_as_its_signs),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
