/* SPDX-License-Identifier: BSD-3-Clause
 * Signs of faces found by an OpenCL device against the host's, to the bit: those that take exact arithmetic, cells without volume, leaves
 * and scattered meshes among them. Run with the argument `--tiny` it takes small meshes: enough for a simulator to see the kernel. */
#include "structures.h"

#include "device.h"
#include "device_pair.h"
#include "faulty_allocator.h"
#include "mesh_case.h"
#include "visibility_order.h"

#define CALLS_MAX 200

static stratus_visibility_order* make_order(stratus_context* context, const mesh_case* mesh, const stratus_leaves* leaves)
{
  const stratus_mesh view = mesh_case_view(mesh);
  stratus_visibility_order* order = NULL;
  if (stratus_visibility_order_create(context, &view, leaves, &order) != STRATUS_OK) {
    fail_msg("%s", stratus_context_message(context));
  }
  return order;
}

/* Along the axes and askew, parallel and from points of the mesh, near it and far away. */
static stratus_view make_view(const mesh_case* mesh, int number)
{
  uint32_t random = (uint32_t)number + 1;
  stratus_view view = { .parallel = number % 2 };
  const double* point = mesh->points + 3 * (mesh_random(&random) % mesh->point_count);
  for (int a = 0; a < 3; ++a) {
    const double some = 2.0 * mesh_random_unit(&random) - 1.0;
    view.direction[a] = number % 3 == 0 ? (number / 6 % 3 == a) : some;
    view.eye[a] = point[a] + (number % 3 == 0 ? 0.0 : number % 3 == 1 ? some : 50.0 * some);
  }
  return view;
}

/* Returns how many signs took exact arithmetic. */
static int64_t compare_signs(stratus_visibility_order* order, const stratus_view* view)
{
  const size_t bytes = (size_t)order->cell_count * sizeof *order->state;
  uint8_t* expected = malloc(bytes + 1);
  assert_non_null(expected);
  const int64_t exact = stratus_order_find_signs(order, view);
  int64_t open = -1;
  memcpy(expected, order->state, bytes);
  for (size_t i = 0; i < bytes; ++i) {
    order->state[i] ^= 0xff;
  }
  memset(order->seen, 0x55, (size_t)order->point_count * 3 * sizeof *order->seen);
  if (stratus_order_find_signs_on_device(order, view, &open) != STRATUS_OK) {
    fail_msg("%s", stratus_context_message(order->context));
  }
  assert_int_equal(open, exact);
  assert_memory_equal(order->state, expected, bytes);
  assert_true(order->relations_changed || order->cell_count < 2); /* the states were spoilt, and one cell hides no other */
  if (stratus_order_find_signs_on_device(order, view, &open) != STRATUS_OK) {
    fail_msg("%s", stratus_context_message(order->context));
  }
  assert_false(order->relations_changed);
  free(expected);
  return exact;
}

/* Other numbers for the points, far from one another for neighbours. */
static void scatter_points(mesh_case* mesh)
{
  const int64_t count = mesh->point_count, step = 3571; /* a prime that does not divide the count */
  double* points = malloc((size_t)count * 3 * sizeof *points);
  assert_non_null(points);
  assert_true(count % step != 0);
  for (int64_t i = 0; i < count; ++i) {
    memcpy(points + 3 * (i * step % count), mesh->points + 3 * i, 3 * sizeof *points);
  }
  for (int64_t i = 0; i < 4 * mesh->cell_count; ++i) {
    mesh->vertices[i] = (int32_t)(mesh->vertices[i] * step % count);
  }
  free(mesh->points);
  mesh->points = points;
}

/* Grids even, bent, flattened to nothing in places, tiny and far away; scattered cells and points; one cell. */
static mesh_case make_mesh(int kind)
{
  const int side = kind == 6 ? 1 : tiny ? 3 : kind == 5 ? 18 : 6;
  const int n[3] = { side, side, side };
  const double scale = kind == 3 ? 1e-6 : 1.0, offset = kind == 4 ? 6e6 : 0.0;
  mesh_case mesh = mesh_grid(n, kind == 0 ? 0.0 : 0.19, (uint32_t)kind);
  if (kind == 2) {
    for (int64_t i = 0; i < mesh.point_count; ++i) { /* a layer without thickness */
      mesh.points[3 * i] = mesh.points[3 * i] < 1.5 ? mesh.points[3 * i] : fmax(2.0, mesh.points[3 * i] - 1.0);
    }
  }
  mesh_move(&mesh, (const double[]){ scale, scale, scale }, (const double[]){ offset, offset, -offset });
  if (kind == 5) {
    mesh_shuffle(&mesh, 5);
    scatter_points(&mesh);
  }
  mesh.cell_count = kind == 6 ? 1 : mesh.cell_count;
  return mesh;
}

static void signs_are_the_hosts_to_the_bit(void** state)
{
  int64_t exact = 0, flat = 0, scattered = 0;
  (void)state;
  for (int kind = 0; kind < 7; ++kind) {
    mesh_case mesh = make_mesh(kind);
    const stratus_mesh view = mesh_case_view(&mesh);
    stratus_partition_options options = stratus_partition_options_default();
    stratus_partition* partition = NULL;
    stratus_partition_result cut;
    options.leaf_cells = 20;
    options.depth = kind % 2 ? 3 : 0;
    assert_int_equal(stratus_partition_create(device, &view, &options, &partition), STRATUS_OK);
    stratus_partition_get(partition, &cut);
    mesh_case pieces = { (double*)(uintptr_t)cut.points, (int32_t*)(uintptr_t)cut.vertices, cut.point_count, cut.cell_count };
    if (kind == 5) { /* as it came, not leaf by leaf */
      pieces = mesh;
    }
    stratus_visibility_order* order = make_order(device, &pieces, kind == 5 ? NULL : &cut.leaves);
    for (int v = 0; v < (tiny ? 4 : 24); ++v) {
      const stratus_view seen = make_view(&pieces, v);
      exact += compare_signs(order, &seen);
    }
    flat += order->flat;
    scattered += order->listed && order->seen_at;
    stratus_visibility_order_destroy(order);
    stratus_partition_destroy(partition);
    mesh_case_free(&mesh);
  }
  assert_true(exact > 0 && flat > 0);
  assert_true(tiny || scattered == 1);
}

/* More cells than come back at once. */
static void what_comes_back_in_parts_is_whole(void** state)
{
  static const int n[3] = { 29, 30, 31 };
  (void)state;
  if (tiny) {
    return;
  }
  mesh_case mesh = mesh_grid(n, 0.1, 3);
  assert_true(mesh.cell_count > (1 << 17) && mesh.cell_count % (1 << 17) != 0);
  stratus_visibility_order* order = make_order(device, &mesh, NULL);
  for (int v = 0; v < 2; ++v) {
    const stratus_view view = make_view(&mesh, v + 1);
    compare_signs(order, &view);
  }
  stratus_visibility_order_destroy(order);
  mesh_case_free(&mesh);
}

/* A device is asked where it is taken for a GPU and cells are many. Whatever it refuses, at any call, is a clean error, and the next order
 * right. */
static void a_gpu_is_asked_and_its_order_is_the_hosts(void** state)
{
  static const int many[3] = { 15, 14, 14 }, few[3] = { 3, 3, 3 };
  const stratus_camera camera = { .eye = { -20, 31, 3 }, .forward = { 1, 0, 0 } };
  (void)state;
  if (tiny) {
    return;
  }
  faulty_allocator allocator = { 0 };
  stratus_context_options options = faulty_options(&allocator, "0");
  stratus_context* context = NULL;
  options.threads = 2;
  assert_int_equal(stratus_context_create(&options, &context, NULL, 0), STRATUS_OK);
  mesh_case mesh = mesh_grid(many, 0.19, 3), small = mesh_grid(few, 0.1, 3);
  stratus_visibility_result expected, result;
  stratus_visibility_order *host = make_order(host_context, &mesh, NULL), *order = make_order(context, &small, NULL);
  assert_int_equal(stratus_visibility_order_sort(host, &camera, NULL, STRATUS_PEELING_NEAREST, &expected), STRATUS_OK);
  context->device->is_cpu = false;
  assert_int_equal(stratus_visibility_order_sort(order, &camera, NULL, STRATUS_PEELING_NEAREST, &result), STRATUS_OK);
  assert_null(order->device_signs);
  stratus_visibility_order_destroy(order);
  for (int memory = 0; memory < 2; ++memory) {
    int n = 0;
    stratus_status status = STRATUS_DEVICE_ERROR;
    for (; n < CALLS_MAX && status != STRATUS_OK; ++n) {
      order = make_order(context, &mesh, NULL);
      if (memory) {
        allocator.fail_at = allocator.calls + n + 1;
      } else {
        stratus_device_fail_after(context->device, n, CL_DEVICE_NOT_AVAILABLE);
      }
      status = stratus_visibility_order_sort(order, &camera, NULL, STRATUS_PEELING_NEAREST, &result);
      assert_true(status == STRATUS_OK || status == (memory ? STRATUS_OUT_OF_MEMORY : STRATUS_DEVICE_ERROR));
      allocator.fail_at = 0;
      stratus_device_fail_after(context->device, -1, 0);
      if (n == 2) {
        assert_int_equal(stratus_visibility_order_sort(order, &camera, NULL, STRATUS_PEELING_NEAREST, &result), STRATUS_OK);
        assert_memory_equal(result.cells, expected.cells, (size_t)mesh.cell_count * sizeof *result.cells);
      }
      if (status == STRATUS_OK) {
        assert_non_null(order->device_signs);
        assert_int_equal(result.exact_signs, expected.exact_signs);
        assert_memory_equal(result.cells, expected.cells, (size_t)mesh.cell_count * sizeof *result.cells);
      }
      stratus_visibility_order_destroy(order);
    }
    assert_true(n > 3 && n < CALLS_MAX);
  }
  stratus_visibility_order_destroy(host);
  mesh_case_free(&mesh);
  mesh_case_free(&small);
  stratus_context_destroy(context);
  assert_int_equal(allocator.live, 0);
}

int test_visibility_signs_device(void)
{
  if (no_device()) {
    return TEST_SKIPPED;
  }
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(signs_are_the_hosts_to_the_bit),
    cmocka_unit_test(what_comes_back_in_parts_is_whole),
    cmocka_unit_test(a_gpu_is_asked_and_its_order_is_the_hosts),
  };
  return cmocka_run_group_tests(tests, open_device, close_device);
}
