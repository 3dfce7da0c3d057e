/* SPDX-License-Identifier: BSD-3-Clause
 * Partitions: pieces fill the cells that they were cut from, meet in equal faces, and are in their leaves. */
#include "stratus.h"

#include "partition_case.h"
#include "testing.h"

/* Checks that the border is the box's, that no face is shared by three cells or folded, and that no two points are equal. */
static void assert_box_conforms(stratus_context* context, const stratus_partition_result* cut, const int n[3], double offset)
{
  mesh_case mesh = mesh_of(cut);
  const stratus_mesh view = mesh_case_view(&mesh);
  stratus_adjacency* adjacency = NULL;
  assert_int_equal(stratus_adjacency_create(context, &view, &adjacency), STRATUS_OK);
  assert_int_equal(adjacency->broken_faces + adjacency->folded_faces + adjacency->flat, 0);
  for (int64_t i = 0; i < 4 * mesh.cell_count; ++i) {
    if (adjacency->neighbours[i] < 0) {
      int on = 0;
      for (int side = 0; side < 6; ++side) {
        int points = 0;
        for (int v = 0; v < 4; ++v) {
          const double x = mesh.points[3 * (int64_t)mesh.vertices[4 * (i / 4) + v] + side / 2];
          points += v != i % 4 && fabs(x - offset - (side % 2 ? n[side / 2] : 0)) < 1e-14 * n[side / 2] + 1e-15 * fabs(offset);
        }
        on += points == 3;
      }
      assert_int_equal(on, 1);
    }
  }
  for (int64_t i = mesh.point_count - 1; i >= cut->old_points; --i) {
    for (int64_t j = 0; j < i; ++j) {
      assert_memory_not_equal(mesh.points + 3 * i, mesh.points + 3 * j, 3 * sizeof(double));
    }
  }
  stratus_adjacency_destroy(adjacency);
}

static void assert_conforming(stratus_context* context, const stratus_partition_result* cut, const int n[3])
{
  assert_box_conforms(context, cut, n, 0.0);
}

static void pieces_meet_and_fill_at_every_depth_and_rule(void** state)
{
  static const int n[3] = { 6, 5, 7 };
  int64_t added = 0, leaves = 0;
  (void)state;
  stratus_context* context = mesh_context(2);
  for (int repeat = 0; repeat < 16; repeat += few_run() ? 7 : 1) {
    mesh_case mesh = mesh_grid(n, repeat % 4 == 3 ? 0.0 : 0.19, (uint32_t)repeat);
    stratus_partition_options options = stratus_partition_options_default();
    stratus_partition_result cut;
    mesh_shuffle(&mesh, (uint32_t)repeat);
    options.rule = repeat % 2 ? STRATUS_PARTITION_PAPER : STRATUS_PARTITION_MEDIAN;
    options.depth = 1 + repeat % 5;
    options.planes = 1 + 7 * (repeat % 3);
    options.leaf_cells = 30;
    stratus_partition* partition = make_partition(context, &mesh, &options);
    stratus_partition_get(partition, &cut);
    assert_true(cut.leaves.leaf_count > 1 && cut.leaves.leaf_count <= 1 << options.depth);
    assert_int_equal(cut.tiny_pieces, 0);
    assert_pieces_fill_their_cells(&mesh, &cut);
    assert_conforming(context, &cut, n);
    added += cut.cell_count - mesh.cell_count;
    leaves += cut.leaves.leaf_count;
    stratus_partition_destroy(partition);
    mesh_case_free(&mesh);
  }
  assert_true(added > (few_run() ? 180 : 1000) && leaves > (few_run() ? 18 : 100));
  stratus_context_destroy(context);
}

/* Quadratic hexahedra as they are subdivided: cubes of 20 points and one in the middle, corners of faces cut off. All points but corners
 * are moved by up to 4 roundings, as if computed. `offset` moves all points. */
static mesh_case quadratic_cubes(const int n[3], double offset, uint32_t seed)
{
  const int step[3] = { 1, 2 * n[0] + 1, (2 * n[0] + 1) * (2 * n[1] + 1) };
  mesh_case mesh = mesh_case_allocate((int64_t)step[2] * (2 * n[2] + 1), 36 * (int64_t)n[0] * n[1] * n[2]);
  int64_t cell = 0;
  for (int64_t i = 0; i < mesh.point_count; ++i) {
    const int64_t at[3] = { i % step[1], i / step[1] % (2 * n[1] + 1), i / step[2] };
    for (int a = 0; a < 3; ++a) {
      const double x = offset + 0.5 * (double)at[a];
      const bool corner = at[0] % 2 + at[1] % 2 + at[2] % 2 == 0;
      mesh.points[3 * i + a] = corner ? x : x + fabs(x) * 0x1p-52 * (double)((int)(mesh_random(&seed) % 9) - 4);
    }
  }
  for (int cube = 0; cube < n[0] * n[1] * n[2]; ++cube) {
    const int at[3] = { cube % n[0], cube / n[0] % n[1], cube / n[0] / n[1] };
    const int middle = (2 * at[0] + 1) * step[0] + (2 * at[1] + 1) * step[1] + (2 * at[2] + 1) * step[2];
    for (int side = 0; side < 6; ++side) {
      const int u = step[(side / 2 + 1) % 3], v = step[(side / 2 + 2) % 3];
      const int face = middle + (side % 2 ? step[side / 2] : -step[side / 2]);
      const int round[8] = { face - u - v, face - v, face + u - v, face + u, face + u + v, face + v, face - u + v, face - u };
      const int triangles[6][3] = { { 7, 0, 1 }, { 1, 2, 3 }, { 3, 4, 5 }, { 5, 6, 7 }, { 1, 3, 7 }, { 3, 5, 7 } };
      for (int t = 0; t < 6; ++t, ++cell) { /* both cubes at a face start round it from the same corner */
        mesh.vertices[4 * cell] = middle;
        for (int i = 0; i < 3; ++i) {
          mesh.vertices[4 * cell + 1 + i] = round[triangles[t][side % 2 ? i : 2 - i]];
        }
      }
    }
  }
  return mesh;
}

/* A plane that misses points only by rounding cuts off no piece as thin as that. */
static void what_is_within_rounding_of_a_plane_lies_on_it(void** state)
{
  static const int n[3] = { 4, 4, 4 };
  static const double offsets[] = { 0.0, -2.0, 6e6 };
  int whole = 0, cut_too = 0;
  (void)state;
  stratus_context* context = mesh_context(1);
  for (int repeat = 0; repeat < 24; repeat += few_run() ? 5 : 1) {
    const double offset = offsets[repeat / 8];
    mesh_case mesh = quadratic_cubes(n, offset, (uint32_t)repeat + 1);
    stratus_partition_options options = stratus_partition_options_default();
    stratus_partition_result cut;
    options.rule = repeat % 2 ? STRATUS_PARTITION_PAPER : STRATUS_PARTITION_MEDIAN;
    options.planes = repeat % 4 == 1 ? 7 : 18; /* on the cubes' and their middles' planes, or not */
    options.depth = 1 + repeat / 2 % 4;
    options.leaf_cells = 30;
    stratus_partition* partition = make_partition(context, &mesh, &options);
    stratus_partition_get(partition, &cut);
    assert_true(cut.leaves.leaf_count > 1);
    assert_int_equal(cut.tiny_pieces, 0);
    if (fabs(offset) < 10.0) { /* at 6e6 a point on a cut edge is off by 1e-10 of a cell, however it is rounded */
      assert_pieces_fill_their_cells(&mesh, &cut);
    }
    assert_box_conforms(context, &cut, n, offset);
    whole += cut.cut_cells == 0;
    cut_too += cut.cut_cells > 0;

    mesh_case pieces = mesh_of(&cut);
    const stratus_mesh view = mesh_case_view(&pieces);
    stratus_visibility_order* order = NULL;
    assert_int_equal(stratus_visibility_order_create(context, &view, &cut.leaves, &order), STRATUS_OK);
    stratus_visibility_order_destroy(order);
    stratus_partition_destroy(partition);
    mesh_case_free(&mesh);
  }
  assert_true(whole > 0 && cut_too > 0);
  stratus_context_destroy(context);
}

static void nothing_is_cut_where_nothing_is_to_cut(void** state)
{
  static const double points[12] = { 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1 };
  static const int32_t vertices[8] = { 0, 1, 2, 3, 2, 2, 2, 2 };
  (void)state;
  stratus_context* context = mesh_context(1);
  for (int cells = 0; cells <= 2; ++cells) {
    stratus_mesh mesh = stratus_mesh_default();
    stratus_partition* partition = NULL;
    stratus_partition_result cut;
    stratus_partition_options options = stratus_partition_options_default();
    mesh.points = points;
    mesh.vertices = vertices;
    mesh.point_count = 4;
    mesh.cell_count = cells;
    options.leaf_cells = 1;
    assert_int_equal(stratus_partition_create(context, &mesh, &options, &partition), STRATUS_OK);
    stratus_partition_get(partition, &cut);
    assert_true(cut.cell_count >= cells && cut.leaves.leaf_count >= 1);
    stratus_partition_destroy(partition);
  }
  stratus_context_destroy(context);
}

/* Overlapping cells, cut unevenly: some leaves get no cell at all, next to leaves that are cut. */
static void leaves_without_cells_take_part(void** state)
{
  stratus_partition_options options = stratus_partition_options_default();
  uint32_t random = 5;
  int empty = 0;
  (void)state;
  stratus_context* context = mesh_context(1);
  options.imbalance = INFINITY;
  options.depth = 7;
  options.leaf_cells = 1;
  for (int round = 0; round < (few_run() ? 150 : 600); ++round) {
    mesh_case mesh = mesh_case_allocate(13, 13);
    stratus_partition_result cut;
    options.rule = round % 2 ? STRATUS_PARTITION_PAPER : STRATUS_PARTITION_MEDIAN;
    for (int i = 0; i < 39; ++i) {
      mesh.points[i] = (double)(mesh_random(&random) % 4);
    }
    for (int i = 0; i < 52; ++i) {
      mesh.vertices[i] = (int32_t)(mesh_random(&random) % 13);
    }
    stratus_partition* partition = make_partition(context, &mesh, &options);
    stratus_partition_get(partition, &cut);
    for (int32_t leaf = 0; leaf < cut.leaves.leaf_count; ++leaf) {
      int64_t cells = 0;
      for (int64_t c = 0; c < cut.cell_count; ++c) {
        cells += cut.leaves.leaf[c] == leaf;
      }
      empty += cells == 0;
    }
    stratus_partition_destroy(partition);
    mesh_case_free(&mesh);
  }
  print_message("             %d leaves without a cell\n", empty);
  assert_true(empty > 0);
  stratus_context_destroy(context);
}

static void options_out_of_range_are_refused_with_their_values(void** state)
{
  static const char* says[] = { "rule 2", "depth 17", "depth -1", "planes 0", "planes 4097", "growth 0", "growth nan", "imbalance -1",
    "rotations 65", "leaf_cells 0" };
  static const int n[3] = { 1, 1, 1 };
  (void)state;
  stratus_context* context = mesh_context(1);
  mesh_case mesh = mesh_grid(n, 0.0, 1);
  const stratus_mesh view = mesh_case_view(&mesh);
  for (int wrong = 0; wrong < 10; ++wrong) {
    stratus_partition_options options = stratus_partition_options_default();
    stratus_partition* partition = NULL;
    options.rule = wrong == 0 ? (stratus_partition_rule)2 : STRATUS_PARTITION_MEDIAN;
    options.depth = wrong == 1 ? 17 : wrong == 2 ? -1 : 3;
    options.planes = wrong == 3 ? 0 : wrong == 4 ? 4097 : 8;
    options.growth = wrong == 5 ? 0.0 : wrong == 6 ? NAN : 1.0;
    options.imbalance = wrong == 7 ? -1.0 : 0.5;
    options.rotations = wrong == 8 ? 65 : 0;
    options.leaf_cells = wrong == 9 ? 0 : 1;
    assert_int_equal(stratus_partition_create(context, &view, &options, &partition), STRATUS_INVALID_ARGUMENT);
    assert_null(partition);
    assert_non_null(strstr(stratus_context_message(context), says[wrong]));
  }
  mesh_case_free(&mesh);
  stratus_context_destroy(context);
}

int test_partition(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(pieces_meet_and_fill_at_every_depth_and_rule),
    cmocka_unit_test(what_is_within_rounding_of_a_plane_lies_on_it),
    cmocka_unit_test(nothing_is_cut_where_nothing_is_to_cut),
    cmocka_unit_test(leaves_without_cells_take_part),
    cmocka_unit_test(options_out_of_range_are_refused_with_their_values),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
