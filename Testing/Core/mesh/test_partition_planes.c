/* SPDX-License-Identifier: BSD-3-Clause
 * The planes of a partition: between cells where possible, the best of all candidates as a loop finds it, and across axes that suit the
 * mesh. */
#include "stratus.h"

#include "partition_case.h"

/* Grid planes that are there to be found. */
static void a_grid_is_cut_between_its_cells(void** state)
{
  static const int n[3] = { 16, 9, 11 };
  (void)state;
  stratus_context* context = mesh_context(1);
  mesh_case mesh = mesh_grid(n, 0.0, 1);
  for (int64_t i = 0; i < mesh.point_count; ++i) { /* bent, so that only planes across x are left */
    double* p = mesh.points + 3 * i;
    p[1] += 0.3 * sin(p[0] + 0.7 * p[2]);
    p[2] += 0.3 * sin(1.3 * p[0] + p[1]);
  }
  stratus_partition* partition = make_partition(context, &mesh, NULL);
  stratus_partition_result cut;
  stratus_partition_get(partition, &cut);
  assert_int_equal(cut.cell_count, mesh.cell_count);
  assert_int_equal(cut.point_count, mesh.point_count);
  assert_int_equal(cut.cut_cells, 0);
  assert_int_equal(cut.leaves.leaf_count, 8);
  assert_true(cut.largest_leaf <= mesh.cell_count / 4);
  stratus_partition_destroy(partition);
  mesh_case_free(&mesh);
  stratus_context_destroy(context);
}

/* Tries all planes of the paper's rule, and counts the pieces of each cell by cell. */
static void the_paper_s_plane_is_the_best_of_all_that_are_admissible(void** state)
{
  static const int n[3] = { 5, 4, 6 };
  static const int all[4][4] = { { 1, 1, 1, 1 }, { 1, 2, 3, 4 }, { 1, 3, 6, 1 }, { 1, 4, 1, 1 } }; /* pieces by vertices below and above */
  static const int share[4][4] = { { 0, 0, 0, 0 }, { 0, 1, 1, 1 }, { 0, 2, 3, 0 }, { 0, 3, 0, 0 } };
  int none = 0, found = 0;
  (void)state;
  stratus_context* context = mesh_context(1);
  for (int repeat = 0; repeat < 12; ++repeat) {
    mesh_case mesh = mesh_grid(n, 0.19, (uint32_t)repeat);
    stratus_partition_options options = stratus_partition_options_default();
    options.rule = STRATUS_PARTITION_PAPER;
    options.depth = 1;
    options.planes = 10 + repeat;
    options.growth = 0.1 + 0.05 * repeat;
    options.imbalance = 0.2 + 0.1 * (repeat % 5);
    options.leaf_cells = 1;
    double least = INFINITY;
    for (int i = 0; i < 3 * options.planes; ++i) {
      const int axis = i / options.planes;
      const double part = (i % options.planes + 1) / (options.planes + 1.0), x = 0.0 * (1.0 - part) + n[axis] * part;
      int64_t below = 0, above = 0, cells = 0;
      for (int64_t c = 0; c < mesh.cell_count; ++c) {
        int l = 0, h = 0;
        for (int v = 0; v < 4; ++v) {
          const double y = mesh.points[3 * (int64_t)mesh.vertices[4 * c + v] + axis];
          l += y < x;
          h += y > x;
        }
        cells += l == 4 || h == 4 ? 1 : all[l][h];
        below += h == 0 ? 1 : l == 0 ? 0 : share[l][h];
        above += h == 0 ? 0 : l == 0 ? 1 : share[h][l];
      }
      assert_int_equal(below + above, cells);
      const double growth = (double)(cells - mesh.cell_count) / (double)mesh.cell_count;
      if (growth <= options.growth && fabs((double)(below - above)) / (0.5 * (double)cells) < options.imbalance && growth < least) {
        least = growth;
      }
    }
    stratus_partition* partition = make_partition(context, &mesh, &options);
    stratus_partition_result cut;
    stratus_partition_get(partition, &cut);
    if (isinf(least)) {
      assert_int_equal(cut.leaves.leaf_count, 1);
      assert_int_equal(cut.cell_count, mesh.cell_count);
      ++none;
    } else {
      assert_int_equal(cut.leaves.leaf_count, 2);
      assert_int_equal(cut.cell_count - mesh.cell_count, (int64_t)(least * (double)mesh.cell_count + 0.5));
      ++found;
    }
    stratus_partition_destroy(partition);
    mesh_case_free(&mesh);
  }
  assert_true(none > 0 && found > 0);
  stratus_context_destroy(context);
}

static void a_mesh_that_stands_askew_is_turned_before_it_is_cut(void** state)
{
  static const int n[3] = { 8, 8, 8 };
  (void)state;
  stratus_context* context = mesh_context(1);
  mesh_case mesh = mesh_grid(n, 0.0, 1);
  for (int64_t i = 0; i < mesh.point_count; ++i) { /* no plane across x, y or z passes between cells */
    double* p = mesh.points + 3 * i;
    const double x = p[0], y = p[1], z = p[2];
    p[0] = 0.8 * x + 0.6 * y;
    p[1] = -0.6 * x + 0.8 * y + 0.1 * z;
    p[2] = z + 0.4 * x;
  }
  stratus_partition_options options = stratus_partition_options_default();
  stratus_partition_result cut;
  options.rule = STRATUS_PARTITION_PAPER;
  options.depth = 2;
  options.leaf_cells = 1;
  stratus_partition* partition = make_partition(context, &mesh, &options);
  stratus_partition_get(partition, &cut);
  assert_int_equal(cut.rotations, 0);
  stratus_partition_destroy(partition);
  options.depth = 1;
  partition = make_partition(context, &mesh, &options);
  stratus_partition_get(partition, &cut);
  options.growth = 0.999 * (double)(cut.cell_count - mesh.cell_count) / (double)mesh.cell_count; /* below every axis plane's growth */
  stratus_partition_destroy(partition);
  partition = make_partition(context, &mesh, &options);
  stratus_partition_get(partition, &cut);
  assert_int_equal(cut.leaves.leaf_count, 1);
  stratus_partition_destroy(partition);
  options.rotations = 64;
  partition = make_partition(context, &mesh, &options);
  stratus_partition_get(partition, &cut);
  assert_int_equal(cut.leaves.leaf_count, 2);
  assert_true(cut.rotations > 0);
  assert_pieces_fill_their_cells(&mesh, &cut);

  mesh_case pieces = mesh_of(&cut);
  const stratus_mesh view = mesh_case_view(&pieces);
  stratus_visibility_order* order = NULL;
  stratus_visibility_result result;
  assert_int_equal(stratus_visibility_order_create(context, &view, &cut.leaves, &order), STRATUS_OK);
  for (int i = 0; i < 8; ++i) {
    const stratus_camera camera = { .eye = { i % 2 ? 30 : -20, i / 2 % 2 ? 25 : -30, i / 4 ? 40 : -10 }, .forward = { 1, 0, 0 } };
    int64_t pairs = 0;
    assert_int_equal(stratus_visibility_order_sort(order, &camera, NULL, STRATUS_PEELING_NEAREST, &result), STRATUS_OK);
    assert_int_equal(mesh_wrong_pairs(&pieces, &camera, result.cells, 100, (uint32_t)i, &pairs), 0);
  }
  stratus_visibility_order_destroy(order);
  stratus_partition_destroy(partition);
  mesh_case_free(&mesh);
  stratus_context_destroy(context);
}

int test_partition_planes(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(a_grid_is_cut_between_its_cells),
    cmocka_unit_test(the_paper_s_plane_is_the_best_of_all_that_are_admissible),
    cmocka_unit_test(a_mesh_that_stands_askew_is_turned_before_it_is_cut),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
