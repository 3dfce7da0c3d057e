/* SPDX-License-Identifier: BSD-3-Clause
 * The order of a partition's cells: orders of a view, leaf by leaf, are right, and lists keep near cells near one another. */
#include "stratus.h"

#include "partition_case.h"

/* An order with leaves is right from everywhere, within leaves and across them, although its cells need not come leaf by leaf. */
static void orders_by_leaves_are_right_from_everywhere(void** state)
{
  static const int n[3] = { 5, 5, 5 };
  static const double eyes[][3] = { { 20, 1, 2 }, { -20, 7, 3 }, { 2.5, 2.5, 2.6 }, { 1, 9, 9 }, { 2, 2, -9 } };
  (void)state;
  mesh_case mesh = mesh_grid(n, 0.19, 4);
  stratus_partition_options options = stratus_partition_options_default();
  options.leaf_cells = 20;
  uint32_t* first = NULL;
  for (int threads = 1; threads <= 3; ++threads) {
    stratus_context* context = mesh_context(threads);
    stratus_partition* partition = make_partition(context, &mesh, &options);
    stratus_partition_result cut;
    stratus_partition_get(partition, &cut);
    assert_int_equal(cut.leaves.leaf_count, 8);
    mesh_case pieces = mesh_of(&cut);
    const stratus_mesh view = mesh_case_view(&pieces);
    for (size_t i = 0; i < 2 * sizeof eyes / sizeof *eyes; ++i) {
      stratus_visibility_order* order = NULL;
      stratus_visibility_result result;
      stratus_camera camera = { .parallel = i % 2 };
      int64_t pairs = 0;
      for (int a = 0; a < 3; ++a) {
        camera.eye[a] = eyes[i / 2][a];
        camera.forward[a] = 2.5 - camera.eye[a];
      }
      assert_int_equal(stratus_visibility_order_create(context, &view, &cut.leaves, &order), STRATUS_OK);
      assert_int_equal(stratus_visibility_order_sort(order, &camera, NULL, STRATUS_PEELING_NEAREST, &result), STRATUS_OK);
      assert_int_equal(result.forced, 0);
      assert_true(result.cycles < 10); /* cutting makes a few of its own, and they are broken where hardly anything is seen of it */
      assert_int_equal(mesh_wrong_pairs(&pieces, &camera, result.cells, 150, (uint32_t)i, &pairs), 0);
      assert_true(pairs > 300);
      if (i == 0) {
        const size_t bytes = (size_t)cut.cell_count * sizeof *first;
        first = first ? first : memcpy(malloc(bytes), result.cells, bytes);
        assert_memory_equal(first, result.cells, bytes);
      }
      stratus_visibility_order_destroy(order);
    }
    stratus_partition_destroy(partition);
    stratus_context_destroy(context);
  }
  free(first);
  mesh_case_free(&mesh);
}

/* Mean distance from one cell's first point to the next cell's. */
static double mean_step(const double* points, const int32_t* vertices, int64_t cells)
{
  double sum = 0.0;
  for (int64_t i = 0; i + 1 < cells; ++i) {
    const double *p = points + 3 * (int64_t)vertices[4 * i], *q = p + 3 * ((int64_t)vertices[4 * i + 4] - vertices[4 * i]);
    sum += fabs(p[0] - q[0]) + fabs(p[1] - q[1]) + fabs(p[2] - q[2]);
  }
  return sum / (double)cells;
}

/* Scattered cells are listed near one another, each once. Other cells keep their order. */
static void scattered_cells_are_listed_where_they_are(void** state)
{
  static const int n[3] = { 20, 20, 20 };
  (void)state;
  stratus_context* context = mesh_context(2);
  stratus_partition_options options = stratus_partition_options_default();
  for (int depth = 0; depth < 2; ++depth) {
    for (int scattered = 0; scattered < 2; ++scattered) {
      mesh_case mesh = mesh_grid(n, 0.1, 1);
      if (scattered) {
        mesh_shuffle(&mesh, 3);
      }
      options.depth = depth;
      stratus_partition* partition = make_partition(context, &mesh, &options);
      stratus_partition_result cut;
      stratus_partition_get(partition, &cut);
      assert_pieces_fill_their_cells(&mesh, &cut);
      assert_true(mean_step(cut.points, cut.vertices, cut.cell_count) < 4.0);
      if (scattered) {
        assert_true(mean_step(mesh.points, mesh.vertices, mesh.cell_count) > 15.0);
      }
      for (int64_t i = 1; i < cut.cell_count && !scattered; ++i) {
        assert_true(cut.leaves.leaf[i] != cut.leaves.leaf[i - 1] || cut.cells[i] >= cut.cells[i - 1] || cut.cut_cells > 0);
      }
      stratus_partition_destroy(partition);
      mesh_case_free(&mesh);
    }
  }
  stratus_context_destroy(context);
}

int test_partition_order(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(orders_by_leaves_are_right_from_everywhere),
    cmocka_unit_test(scattered_cells_are_listed_where_they_are),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
