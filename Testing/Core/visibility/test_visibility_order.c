/* SPDX-License-Identifier: BSD-3-Clause
 * Visibility orders, compared with rays: no cell comes before one that hides it, in any view; rings of cells that hide one another lose one
 * relation each; cells that share no points still share faces. */
#include "mesh_case.h"
#include "visibility_order.h"

#define RAYS 120

static stratus_visibility_order* make_order(stratus_context* context, const mesh_case* mesh)
{
  const stratus_mesh view = mesh_case_view(mesh);
  stratus_visibility_order* order = NULL;
  assert_int_equal(stratus_visibility_order_create(context, &view, NULL, &order), STRATUS_OK);
  return order;
}

/* Camera of view 0..23: six directions, each parallel, perspective, near and from inside. The first three directions are along the axes. */
static stratus_camera camera_of(const mesh_case* mesh, int view)
{
  static const double directions[6][3] = { { 1, 0, 0 }, { 0, -1, 0 }, { 0, 0, 1 }, { .6, .5, .3 }, { -.3, .8, -.4 }, { .1, -.2, -1 } };
  double bounds[6], radius = 0.0;
  stratus_camera camera = { .parallel = view % 4 == 0, .far_k = INFINITY };
  mesh_bounds(mesh, bounds);
  for (int a = 0; a < 3; ++a) {
    radius = fmax(radius, bounds[2 * a + 1] - bounds[2 * a]);
  }
  for (int a = 0; a < 3; ++a) {
    static const double distance[4] = { 3.0, 3.0, 0.8, 0.01 };
    camera.forward[a] = directions[view / 4][a];
    camera.eye[a] = 0.5 * (bounds[2 * a] + bounds[2 * a + 1]) - distance[view % 4] * radius * camera.forward[a];
  }
  return camera;
}

/* Checks all views for wrong pairs; returns the last view's result. */
static stratus_visibility_result assert_order_is_right(stratus_context* context, const mesh_case* mesh, stratus_peeling peeling)
{
  stratus_visibility_order* order = make_order(context, mesh);
  stratus_visibility_result result = { 0 };
  int64_t pairs = 0;
  for (int view = 0; view < 24; ++view) {
    const stratus_camera camera = camera_of(mesh, view);
    assert_int_equal(stratus_visibility_order_sort(order, &camera, NULL, peeling, &result), STRATUS_OK);
    assert_int_equal(result.count, mesh->cell_count);
    assert_int_equal(result.cycles + result.forced, 0);
    assert_int_equal(mesh_wrong_pairs(mesh, &camera, result.cells, RAYS, (uint32_t)view, &pairs), 0);
  }
  assert_true(pairs > 24 * RAYS); /* or there was nothing to be wrong */
  stratus_visibility_order_destroy(order);
  return result;
}

static void a_convex_mesh_is_in_order_from_everywhere(void** state)
{
  static const int n[3] = { 5, 6, 7 };
  static const double scales[][3] = { { 1, 1, 1 }, { 1e-6, 1e-6, 1e-6 }, { 1, 1, 1e-5 }, { 1, 1, 1 } };
  static const double offsets[][3] = { { 0, 0, 0 }, { 0, 0, 0 }, { 0, 0, 0 }, { 6e6, -5e6, 100 } };
  (void)state;
  for (int i = 0; i < 8; ++i) {
    stratus_context* context = mesh_context(1 + i % 3);
    mesh_case mesh = mesh_grid(n, i % 2 ? 0.0 : 0.19, 7);
    mesh_move(&mesh, scales[i / 2], offsets[i / 2]);
    mesh_shuffle(&mesh, (uint32_t)i);
    assert_order_is_right(context, &mesh, STRATUS_PEELING_NEAREST);
    const stratus_visibility_result result = assert_order_is_right(context, &mesh, STRATUS_PEELING_LAYERS);
    assert_true(result.layers > 5 && result.layers < mesh.cell_count);
    mesh_case_free(&mesh);
    stratus_context_destroy(context);
  }
}

/* For an eye on a face, an edge or a vertex, or in a plane of faces, many signs are 0. Cells on both sides of such a plane do not hide one
 * another. */
static void an_eye_on_points_and_planes_of_the_mesh_sees_the_right_order(void** state)
{
  static const int n[3] = { 4, 4, 4 };
  static const double eyes[][3] = { { 2, 2, 2 }, { 2.5, 2, 2 }, { 2.5, 2.5, 2 }, { 2.5, 2.25, 2 }, { -3, 2, 2 }, { 0, 0, 0 }, { 9, 2.5, 2 },
    { 2.5, 2.5, 2.5 }, { 4, 4, 4 } };
  (void)state;
  stratus_context* context = mesh_context(2);
  mesh_case mesh = mesh_grid(n, 0.0, 1);
  stratus_visibility_order* order = make_order(context, &mesh);
  for (size_t i = 0; i < sizeof eyes / sizeof *eyes; ++i) {
    for (int peeling = 0; peeling < 2; ++peeling) {
      stratus_camera camera = { .forward = { 1, 0, 0 } };
      stratus_visibility_result result;
      int64_t pairs = 0;
      memcpy(camera.eye, eyes[i], sizeof camera.eye);
      assert_int_equal(stratus_visibility_order_sort(order, &camera, NULL, (stratus_peeling)peeling, &result), STRATUS_OK);
      assert_true(result.exact_signs > 0);
      assert_int_equal(mesh_wrong_pairs(&mesh, &camera, result.cells, 2000, 1, &pairs), 0);
      assert_true(pairs > 1000);
    }
  }
  stratus_visibility_order_destroy(order);
  mesh_case_free(&mesh);
  stratus_context_destroy(context);
}

/* Two layers of cubes without thickness. Cells before and behind them are related only through the flat cells. Layers would show a lost
 * relation, since all of the border comes first. */
static void flat_cells_pass_on_who_hides_whom(void** state)
{
  static const int n[3] = { 8, 3, 3 };
  (void)state;
  stratus_context* context = mesh_context(2);
  mesh_case mesh = mesh_grid(n, 0.0, 1);
  for (int64_t i = 0; i < mesh.point_count; ++i) {
    double* x = mesh.points + 3 * i;
    *x -= (*x >= 3.0) + (*x >= 6.0);
  }
  mesh_shuffle(&mesh, 9);
  const stratus_visibility_result result = assert_order_is_right(context, &mesh, STRATUS_PEELING_LAYERS);
  assert_int_equal(result.flat, 2 * 3 * 3 * 6);
  assert_order_is_right(context, &mesh, STRATUS_PEELING_NEAREST);
  mesh_case_free(&mesh);
  stratus_context_destroy(context);
}

static void faces_that_coincide_are_shared_whatever_points_they_name(void** state)
{
  static const int n[3] = { 3, 4, 4 };
  static const double one[3] = { 1, 1, 1 }, offset[3] = { 3, 0, 0 };
  (void)state;
  stratus_context* context = mesh_context(2);
  mesh_case other = mesh_grid(n, 0.0, 1);
  mesh_move(&other, one, offset);
  mesh_case mesh = mesh_join(mesh_grid(n, 0.0, 1), other);
  mesh_shuffle(&mesh, 4);
  assert_order_is_right(context, &mesh, STRATUS_PEELING_LAYERS);
  mesh_case_free(&mesh);
  stratus_context_destroy(context);
}

/* Number of pairs in the wrong order, over all relations through faces, which are found anew from the points. */
static int64_t broken_relations(const mesh_case* mesh, const stratus_camera* camera, const uint32_t* cells)
{
  int64_t* rank = malloc((size_t)mesh->cell_count * sizeof *rank);
  int64_t broken = 0;
  assert_non_null(rank);
  for (int64_t i = 0; i < mesh->cell_count; ++i) {
    rank[cells[i]] = i;
  }
  for (int64_t i = 0; i < 16 * mesh->cell_count * mesh->cell_count; ++i) {
    const int64_t p = i / 16 / mesh->cell_count, q = i / 16 % mesh->cell_count;
    const int f = (int)(i / 4 % 4), g = (int)(i % 4);
    int32_t a[3], b[3];
    (void)stratus_face_points(mesh->vertices + 4 * p, f, a);
    (void)stratus_face_points(mesh->vertices + 4 * q, g, b);
    if (p == q || memcmp(a, b, sizeof a) != 0) {
      continue;
    }
    const double *x = mesh->points + 3 * (int64_t)a[0], *y = mesh->points + 3 * (int64_t)a[1], *z = mesh->points + 3 * (int64_t)a[2];
    const int eye = stratus_orientation(x, y, z, camera->eye);
    const int own = stratus_orientation(x, y, z, mesh->points + 3 * (int64_t)mesh->vertices[4 * p + f]);
    broken += eye == own && rank[p] > rank[q]; /* p is on the eye's side: in front */
  }
  free(rank);
  return broken;
}

static void a_ring_of_cells_loses_one_relation(void** state)
{
  (void)state;
  stratus_context* context = mesh_context(1);
  int64_t found = 0;
  for (int count = 3; count <= 12; ++count) {
    mesh_case mesh = mesh_iris(count);
    stratus_visibility_order* order = make_order(context, &mesh);
    for (int side = -1; side <= 1; side += 2) {
      for (int peeling = 0; peeling < 2; ++peeling) {
        const stratus_camera camera = { .eye = { 0.01, 0.02, 30.0 * side }, .forward = { 0, 0, -side } };
        stratus_visibility_result result;
        assert_int_equal(stratus_visibility_order_sort(order, &camera, NULL, (stratus_peeling)peeling, &result), STRATUS_OK);
        assert_int_equal(broken_relations(&mesh, &camera, result.cells), result.cycles);
        assert_int_equal(result.forced, 0);
        found += result.cycles;
      }
    }
    stratus_visibility_order_destroy(order);
    mesh_case_free(&mesh);
  }
  assert_true(found > 0);
  stratus_context_destroy(context);
}

static mesh_case iris_stack(int count)
{
  mesh_case mesh = mesh_iris(5);
  for (int i = 1; i < count; ++i) {
    static const double one[3] = { 1, 1, 1 };
    mesh_case other = mesh_iris(3 + i % 6);
    mesh_move(&other, one, (const double[3]){ 0, 0, 1.5 * i });
    mesh = mesh_join(mesh, other);
  }
  mesh_shuffle(&mesh, 2);
  return mesh;
}

/* Many rings at once, and chains behind them: all rings are broken, in the same way at any number of threads. */
static void many_rings_lose_one_relation_each(void** state)
{
  (void)state;
  mesh_case mesh = iris_stack(30);
  uint32_t* first = NULL;
  for (int threads = 1; threads <= 4; ++threads) {
    stratus_context* context = mesh_context(threads);
    stratus_visibility_order* order = make_order(context, &mesh);
    const stratus_camera camera = { .eye = { 0.01, 0.02, 90.0 }, .forward = { 0, 0, -1 } };
    stratus_visibility_result result;
    assert_int_equal(stratus_visibility_order_sort(order, &camera, NULL, STRATUS_PEELING_NEAREST, &result), STRATUS_OK);
    assert_true(result.cycles >= 30);
    assert_int_equal(broken_relations(&mesh, &camera, result.cells), result.cycles);
    const size_t bytes = (size_t)mesh.cell_count * sizeof *first;
    first = first ? first : memcpy(malloc(bytes), result.cells, bytes);
    assert_memory_equal(first, result.cells, bytes);
    stratus_visibility_order_destroy(order);
    stratus_context_destroy(context);
  }
  free(first);
  mesh_case_free(&mesh);
}

static void assert_each_cell_comes_once(const stratus_visibility_result* result)
{
  uint8_t* seen = calloc((size_t)result->count, 1);
  assert_non_null(seen);
  for (int64_t i = 0; i < result->count; ++i) {
    assert_true(result->cells[i] < result->count && !seen[result->cells[i]]);
    seen[result->cells[i]] = 1;
  }
  free(seen);
}

/* Without patience for any ring the result is still an order, and reports what it broke: nearest first cuts rings where it meets them,
 * layers sort the remaining cells by distance. The order is then computed anew for every view. */
static void rings_that_take_too_long_are_cut_anywhere(void** state)
{
  (void)state;
  mesh_case mesh = iris_stack(30);
  uint32_t* first[2] = { NULL, NULL };
  for (int threads = 1; threads <= 3; ++threads) {
    stratus_context* context = mesh_context(threads);
    stratus_visibility_order* order = make_order(context, &mesh);
    order->steps_per_cell = -1;
    for (int peeling = 0; peeling < 2; ++peeling) {
      stratus_camera camera = { .eye = { 0.01, 0.02, 90.0 }, .forward = { 0, 0, -1 }, .parallel = 1 };
      stratus_visibility_result result;
      assert_int_equal(stratus_visibility_order_sort(order, &camera, NULL, (stratus_peeling)peeling, &result), STRATUS_OK);
      assert_int_equal(result.count, mesh.cell_count);
      assert_each_cell_comes_once(&result);
      const bool layers = peeling == STRATUS_PEELING_LAYERS;
      assert_true(layers ? result.forced > 0 && result.cycles == 0 : result.forced == 0 && result.cycles >= 30);
      const size_t bytes = (size_t)mesh.cell_count * sizeof **first;
      first[peeling] = first[peeling] ? first[peeling] : memcpy(malloc(bytes), result.cells, bytes);
      assert_memory_equal(first[peeling], result.cells, bytes);
      camera.forward[0] = 1e-9;
      assert_int_equal(stratus_visibility_order_sort(order, &camera, NULL, (stratus_peeling)peeling, &result), STRATUS_OK);
      assert_int_equal(result.reused, 0);
    }
    stratus_visibility_order_destroy(order);
    stratus_context_destroy(context);
  }
  free(first[0]);
  free(first[1]);
  mesh_case_free(&mesh);
}

static void a_folded_cell_spoils_only_its_neighbours(void** state)
{
  static const int n[3] = { 6, 6, 6 };
  (void)state;
  stratus_context* context = mesh_context(2);
  mesh_case mesh = mesh_grid(n, 0.1, 3);
  mesh.points[3 * (3 + 7 * (3 + 7 * 3))] += 1.6; /* a point through its neighbours */
  stratus_visibility_order* order = make_order(context, &mesh);
  for (int view = 0; view < 24; ++view) {
    const stratus_camera camera = camera_of(&mesh, view);
    stratus_visibility_result result;
    int64_t pairs = 0;
    assert_int_equal(stratus_visibility_order_sort(order, &camera, NULL, STRATUS_PEELING_NEAREST, &result), STRATUS_OK);
    assert_true(result.folded > 0 && result.forced == 0);
    /* Cells that overlap hide one another: no order is right for them. The rest is. */
    const int64_t wrong = mesh_wrong_pairs(&mesh, &camera, result.cells, RAYS, 1, &pairs);
    assert_true(wrong * 200 < pairs);
  }
  stratus_visibility_order_destroy(order);
  mesh_case_free(&mesh);
  stratus_context_destroy(context);
}

static void a_mirrored_and_sheared_mesh_is_seen_in_its_own_coordinates(void** state)
{
  static const int n[3] = { 4, 5, 3 };
  static const double matrix[16] = { -2, .5, 0, 7, 0, 1, .3, -4, .1, 0, 3, 1, 0, 0, 0, 1 };
  (void)state;
  stratus_context* context = mesh_context(1);
  mesh_case mesh = mesh_grid(n, 0.15, 3), world = mesh_grid(n, 0.15, 3);
  for (int64_t i = 0; i < world.point_count; ++i) {
    stratus_matrix_point(matrix, mesh.points + 3 * i, world.points + 3 * i);
  }
  stratus_visibility_order* order = make_order(context, &mesh);
  for (int view = 0; view < 24; ++view) {
    const stratus_camera camera = camera_of(&world, view);
    stratus_visibility_result result;
    int64_t pairs = 0;
    assert_int_equal(stratus_visibility_order_sort(order, &camera, matrix, STRATUS_PEELING_LAYERS, &result), STRATUS_OK);
    assert_int_equal(mesh_wrong_pairs(&world, &camera, result.cells, RAYS, 1, &pairs), 0);
  }
  stratus_visibility_order_destroy(order);
  mesh_case_free(&mesh);
  mesh_case_free(&world);
  stratus_context_destroy(context);
}

static void an_order_is_reused_while_the_eye_stays(void** state)
{
  static const int n[3] = { 3, 3, 3 };
  (void)state;
  stratus_context* context = mesh_context(1);
  mesh_case mesh = mesh_grid(n, 0.1, 3);
  stratus_visibility_order* order = make_order(context, &mesh);
  stratus_camera camera = { .eye = { 9, 1, 2 }, .forward = { -1, 0, 0 } };
  stratus_visibility_result result;
  assert_int_equal(stratus_visibility_order_sort(order, &camera, NULL, STRATUS_PEELING_NEAREST, &result), STRATUS_OK);
  assert_int_equal(result.reused, 0);
  camera.forward[1] = 0.5; /* another direction of an eye that has a perspective */
  assert_int_equal(stratus_visibility_order_sort(order, &camera, NULL, STRATUS_PEELING_NEAREST, &result), STRATUS_OK);
  assert_int_equal(result.reused, 1);
  assert_int_equal(stratus_visibility_order_sort(order, &camera, NULL, STRATUS_PEELING_LAYERS, &result), STRATUS_OK);
  assert_int_equal(result.reused, 0);
  camera.parallel = 1;
  assert_int_equal(stratus_visibility_order_sort(order, &camera, NULL, STRATUS_PEELING_LAYERS, &result), STRATUS_OK);
  assert_int_equal(result.reused, 0);
  camera.eye[0] = 100.0;
  assert_int_equal(stratus_visibility_order_sort(order, &camera, NULL, STRATUS_PEELING_LAYERS, &result), STRATUS_OK);
  assert_int_equal(result.reused, 1);
  camera.forward[1] = 0.0;
  assert_int_equal(stratus_visibility_order_sort(order, &camera, NULL, STRATUS_PEELING_LAYERS, &result), STRATUS_OK);
  assert_int_equal(result.reused, 0);
  stratus_visibility_order_destroy(order);
  mesh_case_free(&mesh);
  stratus_context_destroy(context);
}

static void nothing_and_one_cell_have_orders(void** state)
{
  static const double points[12] = { 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1 };
  static const int32_t vertices[4] = { 0, 1, 2, 3 };
  (void)state;
  stratus_context* context = mesh_context(2);
  const stratus_camera camera = { .eye = { 3, 3, 3 }, .forward = { -1, -1, -1 } };
  for (int kind = 0; kind < 3; ++kind) { /* no points, no cells, one */
    stratus_mesh mesh = stratus_mesh_default();
    stratus_visibility_order* order = NULL;
    stratus_visibility_result result;
    mesh.points = points;
    mesh.vertices = vertices;
    mesh.point_count = kind > 0 ? 4 : 0;
    mesh.cell_count = kind > 1;
    assert_int_equal(stratus_visibility_order_create(context, &mesh, NULL, &order), STRATUS_OK);
    for (int peeling = 0; peeling < 2; ++peeling) {
      assert_int_equal(stratus_visibility_order_sort(order, &camera, NULL, (stratus_peeling)peeling, &result), STRATUS_OK);
      assert_int_equal(result.count, kind > 1);
      assert_true(kind < 2 || result.cells[0] == 0);
    }
    stratus_visibility_order_destroy(order);
  }
  stratus_context_destroy(context);
}

static void wrong_views_and_leaves_are_refused(void** state)
{
  static const int n[3] = { 2, 1, 1 };
  (void)state;
  stratus_context* context = mesh_context(1);
  mesh_case mesh = mesh_grid(n, 0.0, 3);
  stratus_visibility_order* order = make_order(context, &mesh);
  stratus_camera camera = { .eye = { NAN, 1, 2 }, .forward = { -1, 0, 0 } };
  stratus_visibility_result result;
  const double flat[16] = { 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1 };
  assert_int_equal(stratus_visibility_order_sort(order, &camera, NULL, STRATUS_PEELING_NEAREST, &result), STRATUS_INVALID_ARGUMENT);
  assert_non_null(strstr(stratus_context_message(context), "eye[0]"));
  camera = (stratus_camera){ .parallel = 1 };
  assert_int_equal(stratus_visibility_order_sort(order, &camera, NULL, STRATUS_PEELING_NEAREST, &result), STRATUS_INVALID_ARGUMENT);
  camera.forward[0] = 1.0;
  assert_int_equal(stratus_visibility_order_sort(order, &camera, flat, STRATUS_PEELING_NEAREST, &result), STRATUS_INVALID_ARGUMENT);
  assert_int_equal(stratus_visibility_order_sort(order, &camera, NULL, (stratus_peeling)2, &result), STRATUS_INVALID_ARGUMENT);
  assert_int_equal(stratus_visibility_order_sort(order, NULL, NULL, STRATUS_PEELING_NEAREST, &result), STRATUS_INVALID_ARGUMENT);
  assert_int_equal(stratus_visibility_order_sort(order, &camera, NULL, STRATUS_PEELING_NEAREST, NULL), STRATUS_INVALID_ARGUMENT);
  stratus_visibility_order_destroy(order);

  int32_t leaf[12];
  for (int i = 0; i < 12; ++i) {
    leaf[i] = i >= 6;
  }
  stratus_partition_node nodes[3] = { { 0, 1, 2, 0, 1.0 }, { -1, 0, 0, 0, 0 }, { -1, 1, 0, 0, 0 } };
  stratus_leaves leaves = { nodes, 3, 2, leaf, { 1, 0, 0, 0, 1, 0, 0, 0, 1 } };
  const stratus_mesh view = mesh_case_view(&mesh);
  assert_int_equal(stratus_visibility_order_create(context, &view, &leaves, &order), STRATUS_OK);
  stratus_visibility_order_destroy(order);
  order = NULL;
  for (int wrong = 0; wrong < 9; ++wrong) {
    stratus_partition_node kept[3];
    memcpy(kept, nodes, sizeof kept);
    stratus_leaves other = leaves;
    leaf[0] = wrong == 0 ? 1 : wrong == 1 ? 2 : wrong == 2 ? -1 : 0;
    nodes[0].value = wrong == 3 ? 1.5 : wrong == 4 ? NAN : 1.0;
    nodes[0].below = wrong == 5 ? 0 : 1;
    nodes[2].below = wrong == 6 ? 0 : 1;
    other.node_count = wrong == 7 ? 2 : 3;
    other.leaf_count = wrong == 8 ? 0 : 2;
    assert_int_equal(stratus_visibility_order_create(context, &view, &other, &order), STRATUS_INVALID_ARGUMENT);
    assert_null(order);
    memcpy(nodes, kept, sizeof kept);
    leaf[0] = 0;
  }
  mesh_case_free(&mesh);
  stratus_context_destroy(context);
}

int test_visibility_order(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(a_convex_mesh_is_in_order_from_everywhere),
    cmocka_unit_test(an_eye_on_points_and_planes_of_the_mesh_sees_the_right_order),
    cmocka_unit_test(flat_cells_pass_on_who_hides_whom),
    cmocka_unit_test(faces_that_coincide_are_shared_whatever_points_they_name),
    cmocka_unit_test(a_ring_of_cells_loses_one_relation),
    cmocka_unit_test(many_rings_lose_one_relation_each),
    cmocka_unit_test(rings_that_take_too_long_are_cut_anywhere),
    cmocka_unit_test(a_folded_cell_spoils_only_its_neighbours),
    cmocka_unit_test(a_mirrored_and_sheared_mesh_is_seen_in_its_own_coordinates),
    cmocka_unit_test(an_order_is_reused_while_the_eye_stays),
    cmocka_unit_test(nothing_and_one_cell_have_orders),
    cmocka_unit_test(wrong_views_and_leaves_are_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
