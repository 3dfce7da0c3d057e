/* SPDX-License-Identifier: BSD-3-Clause
 * Visibility orders across gaps, compared with rays: cells that share no face also hide one another, even where only sorting the nearest
 * first would be wrong. */
#include "mesh_case.h"
#include "testing.h"
#include "visibility_order.h"

#define RAYS 400

/* Camera of view 0..23: six directions, each parallel, perspective, near and from inside. */
static stratus_camera camera_of(const mesh_case* mesh, int view)
{
  static const double directions[6][3] = { { 1, 0, 0 }, { 0, -1, 0 }, { 0, 0, 1 }, { .6, .5, .3 }, { -.3, .8, -.4 }, { .1, -.2, -1 } };
  static const double distance[4] = { 3.0, 3.0, 0.8, 0.01 };
  double bounds[6], radius = 0.0;
  stratus_camera camera = { .parallel = view % 4 == 0, .far_k = INFINITY };
  mesh_bounds(mesh, bounds);
  for (int a = 0; a < 3; ++a) {
    radius = fmax(radius, bounds[2 * a + 1] - bounds[2 * a]);
  }
  for (int a = 0; a < 3; ++a) {
    camera.forward[a] = directions[view / 4][a];
    camera.eye[a] = 0.5 * (bounds[2 * a] + bounds[2 * a + 1]) - distance[view % 4] * radius * camera.forward[a];
  }
  return camera;
}

/* Checks the index of gates, which names the first gate in each block of cells, whatever its leaf. Once all cells have come, no way out is
 * left. */
static void assert_gates_are_found_and_passed(const stratus_visibility_order* order)
{
  const int64_t gaps = order->gap_begin[order->leaf_count];
  for (int64_t block = 0; block <= order->cell_count / STRATUS_GAP_BLOCK; ++block) {
    int64_t first = 0;
    while (first < gaps && order->gap_faces[first] / 4 < block * STRATUS_GAP_BLOCK) {
      ++first;
    }
    assert_int_equal(order->gap_at[block], first);
  }
  int64_t nodes = 0, ways_in = 0, ways_out = 0;
  for (int64_t g = 0; g < gaps; ++g) {
    ways_in += order->gates[g].facing < 0;
    ways_out += order->gates[g].facing > 0;
  }
  if (ways_in == 0 || ways_out == 0 || order->leaf_count > 1) {
    return;
  }
  for (int64_t level = gaps; level > 1; nodes += level) {
    level = (level + STRATUS_GATE_CHILDREN - 1) / STRATUS_GATE_CHILDREN;
  }
  for (int64_t g = 0; g < gaps; ++g) {
    assert_true(order->gates[g].facing <= 0 || order->gates[g].passed);
  }
  for (int64_t n = 0; n < nodes; ++n) {
    assert_int_equal(order->gate_nodes[n].left, 0);
  }
}

/* Number of wrong pairs in all 24 views, with one leaf or several. There must be no cycle. */
static int64_t wrong_pairs(const mesh_case* mesh, int threads, int depth, stratus_peeling peeling)
{
  stratus_context* context = mesh_context(threads);
  stratus_visibility_order* order = NULL;
  stratus_partition* partition = NULL;
  stratus_partition_result cut;
  stratus_partition_options options = stratus_partition_options_default();
  options.depth = depth;
  options.leaf_cells = 1;
  stratus_mesh view = mesh_case_view(mesh);
  assert_int_equal(stratus_partition_create(context, &view, &options, &partition), STRATUS_OK);
  stratus_partition_get(partition, &cut);
  mesh_case pieces = mesh_case_allocate(cut.point_count, cut.cell_count);
  memcpy(pieces.points, cut.points, (size_t)cut.point_count * 3 * sizeof(double));
  memcpy(pieces.vertices, cut.vertices, (size_t)cut.cell_count * 4 * sizeof(int32_t));
  view = mesh_case_view(&pieces);
  assert_int_equal(stratus_visibility_order_create(context, &view, &cut.leaves, &order), STRATUS_OK);
  int64_t pairs = 0, wrong = 0;
  for (int v = 0; v < 24; v += few_run() ? 5 : 1) {
    const stratus_camera camera = camera_of(&pieces, v);
    stratus_visibility_result result;
    assert_int_equal(stratus_visibility_order_sort(order, &camera, NULL, peeling, &result), STRATUS_OK);
    assert_int_equal(result.cycles + result.forced, 0);
    wrong += mesh_wrong_pairs(&pieces, &camera, result.cells, RAYS, (uint32_t)v, &pairs);
    if (peeling == STRATUS_PEELING_NEAREST) {
      assert_gates_are_found_and_passed(order);
    }
  }
  assert_true(pairs > 12 * RAYS);
  stratus_visibility_order_destroy(order);
  stratus_partition_destroy(partition);
  stratus_context_destroy(context);
  mesh_case_free(&pieces);
  return wrong;
}

static mesh_case block(int x, int y, int z, const double low[3], const double high[3], double jitter, uint32_t seed)
{
  mesh_case mesh = mesh_grid((const int[3]){ x, y, z }, jitter, seed);
  const double scale[3] = { (high[0] - low[0]) / x, (high[1] - low[1]) / y, (high[2] - low[2]) / z };
  mesh_move(&mesh, scale, low);
  return mesh;
}

/* Two adjacent boxes with the same points, each named twice, but other diagonals: no faces coincide. */
static void a_seam_whose_diagonals_do_not_match_is_no_hole_in_the_order(void** state)
{
  (void)state;
  mesh_case mesh = block(3, 5, 4, (const double[3]){ 0, 0, 0 }, (const double[3]){ 3, 5, 4 }, 0.0, 1);
  const mesh_case other = block(3, 5, 4, (const double[3]){ 3, 5, 0 }, (const double[3]){ 6, 0, 4 }, 0.0, 1);
  mesh = mesh_join(mesh, other);
  mesh_shuffle(&mesh, 8);
  assert_true(wrong_pairs(&mesh, 2, 0, STRATUS_PEELING_LAYERS) > 0); /* else the seam has no effect */
  assert_int_equal(wrong_pairs(&mesh, 2, 0, STRATUS_PEELING_NEAREST), 0);
  assert_int_equal(wrong_pairs(&mesh, 2, 2, STRATUS_PEELING_NEAREST), 0);
  mesh_case_free(&mesh);
}

/* A plate's few long cells, whose centres do not show where they are relative to a fine plate. */
static void long_cells_hide_short_ones_behind_a_gap(void** state)
{
  (void)state;
  mesh_case mesh = block(1, 2, 2, (const double[3]){ 0, 0, 0 }, (const double[3]){ 4, 9, 9 }, 0.1, 1);
  mesh = mesh_join(mesh, block(4, 9, 9, (const double[3]){ 4.1, 0, 0 }, (const double[3]){ 6, 9, 9 }, 0.19, 2));
  mesh = mesh_join(mesh, block(2, 1, 3, (const double[3]){ 6.02, 1, -2 }, (const double[3]){ 7, 11, 9 }, 0.1, 3));
  mesh_shuffle(&mesh, 5);
  for (int depth = 0; depth < 3; ++depth) {
    assert_int_equal(wrong_pairs(&mesh, 1 + depth, depth, STRATUS_PEELING_NEAREST), 0);
  }
  mesh_case_free(&mesh);
}

/* A box with a hollow, whose walls are cells of all sizes, around another one with a hollow, around a block. */
static mesh_case nested(void)
{
  mesh_case mesh = block(2, 2, 2, (const double[3]){ -1, -1, -1 }, (const double[3]){ 1, 1, 1 }, 0.15, 1);
  for (int shell = 1; shell <= 2; ++shell) {
    const double in = shell == 1 ? 1.1 : 2.1, out = in + 0.9;
    const int n = shell == 1 ? 6 : 3;
    for (int side = -1; side <= 1; side += 2) {
      const double thin[2] = { side < 0 ? -out : in, side < 0 ? -in : out };
      mesh = mesh_join(mesh, block(1, n, n, (const double[3]){ thin[0], -out, -out }, (const double[3]){ thin[1], out, out }, 0.1, 2));
      mesh = mesh_join(mesh, block(n, 2, 1, (const double[3]){ -in, thin[0], -out }, (const double[3]){ in, thin[1], out }, 0.1, 3));
      mesh = mesh_join(mesh, block(1, n, 2, (const double[3]){ -in, -in, thin[0] }, (const double[3]){ in, in, thin[1] }, 0.1, 4));
    }
  }
  mesh_shuffle(&mesh, 3);
  return mesh;
}

static void parts_within_hollows_of_others_are_in_order(void** state)
{
  (void)state;
  mesh_case mesh = nested();
  assert_int_equal(wrong_pairs(&mesh, 2, 0, STRATUS_PEELING_NEAREST), 0);
  assert_int_equal(wrong_pairs(&mesh, 2, 3, STRATUS_PEELING_NEAREST), 0);
  mesh_case_free(&mesh);
}

/* Three cells, each over the next one and under the one before: no order is right, and any number of threads gives the same one. */
static void cells_that_hide_one_another_in_a_ring_are_counted(void** state)
{
  static const double corners[4][3] = { { -3.0, 0.8, -1.2 }, { -3.0, 1.4, -1.2 }, { 3.0, 1.1, 1.0 }, { 3.0, 1.1, 1.4 } };
  (void)state;
  mesh_case mesh = mesh_case_allocate(12, 3);
  for (int i = 0; i < 12; ++i) {
    const double angle = i / 4 * 2.0943951023931953, *p = corners[i % 4];
    mesh.points[3 * i] = p[0] * cos(angle) - p[1] * sin(angle);
    mesh.points[3 * i + 1] = p[0] * sin(angle) + p[1] * cos(angle);
    mesh.points[3 * i + 2] = p[2];
    mesh.vertices[i] = i;
  }
  uint32_t first[3];
  for (int threads = 1; threads <= 3; ++threads) {
    stratus_context* context = mesh_context(threads);
    const stratus_mesh view = mesh_case_view(&mesh);
    const stratus_camera camera = { .eye = { 0.0, 0.0, 40.0 }, .forward = { 0, 0, -1 } };
    stratus_visibility_order* order = NULL;
    stratus_visibility_result result;
    assert_int_equal(stratus_visibility_order_create(context, &view, NULL, &order), STRATUS_OK);
    assert_int_equal(stratus_visibility_order_sort(order, &camera, NULL, STRATUS_PEELING_NEAREST, &result), STRATUS_OK);
    assert_int_equal(result.count, mesh.cell_count);
    assert_int_equal(result.cycles, 1);
    assert_int_equal(result.overlaps, 1); /* across gaps, a ring and overlapping cells look alike */
    assert_int_equal(result.forced, 0);
    assert_int_equal(1u << result.cells[0] | 1u << result.cells[1] | 1u << result.cells[2], 7);
    if (threads == 1) {
      memcpy(first, result.cells, (size_t)mesh.cell_count * sizeof *first);
    }
    assert_memory_equal(first, result.cells, (size_t)mesh.cell_count * sizeof *first);
    stratus_visibility_order_destroy(order);
    stratus_context_destroy(context);
  }
  mesh_case_free(&mesh);
}

/* Random cells in a box, which overlap. With `flat` a third of them have no volume: two points in one place, all points in a plane, or a
 * point named twice. */
static mesh_case soup(int64_t cells, bool flat)
{
  uint32_t seed = (uint32_t)cells;
  mesh_case mesh = mesh_case_allocate(4 * cells, cells);
  for (int64_t i = 0; i < 12 * cells; ++i) {
    mesh.points[i] = 4.0 * mesh_random_unit(&seed);
  }
  for (int64_t i = 0; i < 4 * cells; ++i) {
    mesh.vertices[i] = (int32_t)i;
  }
  for (int64_t i = 0; i < cells && flat; i += 3) {
    double* p = mesh.points + 12 * i;
    for (int a = 0; a < 3; ++a) {
      p[9 + a] = i % 2 ? p[a] : p[a] + p[3 + a] - p[6 + a]; /* the fourth in the first's place, or a parallelogram */
    }
    mesh.vertices[4 * i + 3] -= i % 4 == 0 ? 2 : 0; /* or a point named twice */
  }
  return mesh;
}

/* No order is right. The result is some order, the same at any number of threads, and reports that cells overlap. It takes a limited number
 * of tests for each cell; following every ring would take thousands, and more with more cells. */
static void cells_that_overlap_need_bounded_work_and_are_counted(void** state)
{
  (void)state;
  for (int flat = 0; flat < 2; ++flat) {
    for (int size = 0; size < 2; ++size) {
      mesh_case mesh = soup(size ? 8000 : 2000, flat != 0);
      uint32_t* first = malloc((size_t)mesh.cell_count * sizeof *first);
      uint8_t* came = calloc((size_t)mesh.cell_count, 1);
      assert_true(first && came);
      for (int threads = 1; threads <= 2; ++threads) {
        stratus_context* context = mesh_context(threads);
        const stratus_mesh view = mesh_case_view(&mesh);
        const stratus_camera camera = { .eye = { 12, 9, 7 }, .forward = { -10, -7, -5 } };
        stratus_visibility_order* order = NULL;
        stratus_visibility_result result;
        assert_int_equal(stratus_visibility_order_create(context, &view, NULL, &order), STRATUS_OK);
        assert_int_equal(stratus_visibility_order_sort(order, &camera, NULL, STRATUS_PEELING_NEAREST, &result), STRATUS_OK);
        const double gaps = (double)order->gap_begin[1];
        assert_true((double)result.gate_tests <= 64.0 * gaps * sqrt(gaps));
        assert_true(result.overlaps > 0 && (double)result.overlaps <= 64.0 + sqrt((double)mesh.cell_count));
        assert_true(result.cycles > 0 && result.forced > 0 && result.forced <= result.count);
        assert_true(result.gate_tests <= 256 * mesh.cell_count);
        if (threads == 1) {
          memcpy(first, result.cells, (size_t)mesh.cell_count * sizeof *first);
        }
        assert_memory_equal(first, result.cells, (size_t)mesh.cell_count * sizeof *first);
        stratus_visibility_order_destroy(order);
        stratus_context_destroy(context);
      }
      for (int64_t i = 0; i < mesh.cell_count; ++i) {
        assert_int_equal(came[first[i]]++, 0);
      }
      free(first);
      free(came);
      mesh_case_free(&mesh);
    }
  }
}

/* Shuffles the points, and the cells' numbers of them. */
static void shuffle_points(mesh_case* mesh, uint32_t seed)
{
  int32_t* at = malloc((size_t)mesh->point_count * sizeof *at);
  double* points = malloc((size_t)mesh->point_count * 3 * sizeof *points);
  assert_true(at && points);
  for (int64_t i = 0; i < mesh->point_count; ++i) {
    const int64_t j = (int64_t)(mesh_random(&seed) % (uint32_t)(i + 1));
    at[i] = at[j];
    at[j] = (int32_t)i;
  }
  for (int64_t i = 0; i < mesh->point_count; ++i) {
    memcpy(points + 3 * (int64_t)at[i], mesh->points + 3 * i, 3 * sizeof *points);
  }
  for (int64_t i = 0; i < 4 * mesh->cell_count; ++i) {
    mesh->vertices[i] = at[mesh->vertices[i]];
  }
  free(mesh->points);
  free(at);
  mesh->points = points;
}

/* A mesh so large that the order itself brings cells and points near one another, in one leaf and in leaves that are listed as they
 * come. */
static void scattered_cells_and_points_come_in_order(void** state)
{
  (void)state;
  mesh_case mesh = block(20, 20, 20, (const double[3]){ 0, 0, 0 }, (const double[3]){ 3, 3, 3 }, 0.15, 1);
  mesh = mesh_join(mesh, block(2, 3, 2, (const double[3]){ 3.05, -1, 0 }, (const double[3]){ 6, 4, 3 }, 0.1, 2));
  mesh_shuffle(&mesh, 1);
  shuffle_points(&mesh, 2);
  stratus_context* context = mesh_context(2);
  const stratus_mesh view = mesh_case_view(&mesh);
  int32_t* leaf = malloc((size_t)mesh.cell_count * sizeof *leaf);
  assert_non_null(leaf);
  for (int64_t i = 0; i < mesh.cell_count; ++i) {
    leaf[i] = mesh.points[3 * (int64_t)mesh.vertices[4 * i]] >= 3.05;
  }
  const stratus_partition_node nodes[3] = { { 0, 1, 2, 0, 3.02 }, { -1, 0, 0, 0, 0 }, { -1, 1, 0, 0, 0 } };
  const stratus_leaves leaves = { nodes, 3, 2, leaf, { 1, 0, 0, 0, 1, 0, 0, 0, 1 } };
  for (int leaf_count = 1; leaf_count <= 2; ++leaf_count) {
    stratus_visibility_order* order = NULL;
    int64_t pairs = 0;
    assert_int_equal(stratus_visibility_order_create(context, &view, leaf_count == 2 ? &leaves : NULL, &order), STRATUS_OK);
    assert_true(order->listed && order->seen_at);
    for (int v = 0; v < 24; v += 5) {
      const stratus_camera camera = camera_of(&mesh, v);
      stratus_visibility_result result;
      assert_int_equal(stratus_visibility_order_sort(order, &camera, NULL, STRATUS_PEELING_NEAREST, &result), STRATUS_OK);
      assert_int_equal(result.cycles + result.forced + result.overlaps, 0);
      assert_true(result.gate_tests > 0 || leaf_count == 2);
      assert_int_equal(mesh_wrong_pairs(&mesh, &camera, result.cells, 60, (uint32_t)v, &pairs), 0);
    }
    assert_true(pairs > 300);
    stratus_visibility_order_destroy(order);
  }
  free(leaf);
  mesh_case_free(&mesh);
  stratus_context_destroy(context);
}

/* A convex mesh has no gap, whatever the planes of its border. A block next to it makes gaps of the faces that look at it. */
static void only_faces_that_look_at_others_are_gaps(void** state)
{
  (void)state;
  stratus_context* context = mesh_context(2);
  mesh_case mesh = block(4, 4, 4, (const double[3]){ 0, 0, 0 }, (const double[3]){ 1, 1, 1 }, 0.0, 1);
  for (int blocks = 1; blocks <= 2; ++blocks) {
    const stratus_mesh view = mesh_case_view(&mesh);
    stratus_visibility_order* order = NULL;
    assert_int_equal(stratus_visibility_order_create(context, &view, NULL, &order), STRATUS_OK);
    assert_int_equal(order->gap_begin[1], blocks == 1 ? 0 : 2 * 4 * 4 * 2);
    stratus_visibility_order_destroy(order);
    if (blocks == 1) {
      mesh = mesh_join(mesh, block(4, 4, 4, (const double[3]){ 1.5, 0, 0 }, (const double[3]){ 3, 1, 1 }, 0.0, 1));
    }
  }
  mesh_case_free(&mesh);
  stratus_context_destroy(context);
}

/* Gaps and orders of a mesh do not depend on its unit: no product of its lengths overflows, and none vanishes. */
static void a_mesh_of_any_size_has_the_same_gaps_and_orders(void** state)
{
  static const int exponents[] = { 0, 345, 990, -345, -900 }; /* 2^990: some 1e298; 2^345: its third power overflows */
  (void)state;
  stratus_context* context = mesh_context(2);
  mesh_case mesh = nested();
  const size_t cells = (size_t)mesh.cell_count;
  uint32_t* first = malloc(24 * cells * sizeof *first);
  double* points = malloc((size_t)mesh.point_count * 3 * sizeof *points);
  int64_t gaps = 0;
  assert_true(first && points);
  memcpy(points, mesh.points, (size_t)mesh.point_count * 3 * sizeof *points);
  for (size_t e = 0; e < sizeof exponents / sizeof *exponents; ++e) {
    for (int64_t i = 0; i < 3 * mesh.point_count; ++i) {
      mesh.points[i] = ldexp(points[i], exponents[e]);
    }
    const stratus_mesh view = mesh_case_view(&mesh);
    stratus_visibility_order* order = NULL;
    assert_int_equal(stratus_visibility_order_create(context, &view, NULL, &order), STRATUS_OK);
    gaps = e == 0 ? order->gap_begin[1] : gaps;
    assert_true(gaps > 0);
    assert_int_equal(order->gap_begin[1], gaps);
    for (int v = 0; v < 24; v += few_run() ? 5 : 1) {
      const stratus_camera camera = camera_of(&mesh, v);
      stratus_visibility_result result;
      assert_int_equal(stratus_visibility_order_sort(order, &camera, NULL, STRATUS_PEELING_NEAREST, &result), STRATUS_OK);
      assert_int_equal(result.cycles + result.forced, 0);
      if (e == 0) {
        memcpy(first + (size_t)v * cells, result.cells, cells * sizeof *first);
      }
      assert_memory_equal(first + (size_t)v * cells, result.cells, cells * sizeof *first);
    }
    stratus_visibility_order_destroy(order);
  }
  free(first);
  free(points);
  mesh_case_free(&mesh);
  stratus_context_destroy(context);
}

int test_visibility_gaps(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(a_seam_whose_diagonals_do_not_match_is_no_hole_in_the_order),
    cmocka_unit_test(long_cells_hide_short_ones_behind_a_gap),
    cmocka_unit_test(parts_within_hollows_of_others_are_in_order),
    cmocka_unit_test(cells_that_hide_one_another_in_a_ring_are_counted),
    cmocka_unit_test(cells_that_overlap_need_bounded_work_and_are_counted),
    cmocka_unit_test(scattered_cells_and_points_come_in_order),
    cmocka_unit_test(only_faces_that_look_at_others_are_gaps),
    cmocka_unit_test(a_mesh_of_any_size_has_the_same_gaps_and_orders),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
