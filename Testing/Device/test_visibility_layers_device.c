/* SPDX-License-Identifier: BSD-3-Clause
 * Layers peeled by an OpenCL device, as a processor and as a GPU, against the host's order to the byte: one leaf and many, scattered
 * cells, leaves with rings, which come back to the host. Run with the argument `--tiny` it takes small meshes. */
#include "structures.h"

#include "device.h"
#include "device_pair.h"
#include "mesh_case.h"
#include "visibility_order.h"

static stratus_visibility_order* make_order(const mesh_case* mesh, const stratus_leaves* leaves, stratus_context* context)
{
  const stratus_mesh view = mesh_case_view(mesh);
  stratus_visibility_order* order = NULL;
  if (stratus_visibility_order_create(context, &view, leaves, &order) != STRATUS_OK) {
    fail_msg("%s", stratus_context_message(context));
  }
  return order;
}

static void sort_cells(stratus_visibility_order* order, const stratus_camera* camera, stratus_visibility_result* result)
{
  if (stratus_visibility_order_sort(order, camera, NULL, STRATUS_PEELING_LAYERS, result) != STRATUS_OK) {
    fail_msg("%s", stratus_context_message(order->context));
  }
}

typedef struct compared {
  int64_t layers, cycles, peeled, left; /* leaves that the device peeled, and that it left to the host */
} compared;

/* Compares what the device lists, however few the cells are, with the host's order in a view. */
static void compare_layers(stratus_visibility_order* order, const stratus_camera* camera, compared* seen)
{
  stratus_visibility_result expected;
  const size_t bytes = (size_t)order->cell_count * sizeof *order->cells;
  uint32_t* cells = malloc(bytes + 1);
  uint8_t* peeled = malloc((size_t)order->leaf_count);
  uint8_t* relations = malloc((size_t)order->cell_count + 1);
  assert_true(cells && peeled && relations);
  order->context = host_context;
  sort_cells(order, camera, &expected);
  memcpy(cells, order->cells, bytes);
  order->sorted = false;
  (void)stratus_order_find_signs(order, &order->view); /* the host has cut rings */
  memcpy(relations, order->state, (size_t)order->cell_count);
  order->context = device;
  for (int gpu = 0; gpu < 2; ++gpu) {
    int layers = -1;
    device->device->is_cpu = !gpu;
    memset(order->cells, 0x55, bytes);
    memset(peeled, 7, (size_t)order->leaf_count);
    if (stratus_order_peel_layers_on_device(order, peeled, &layers) != STRATUS_OK) {
      fail_msg("%s", stratus_context_message(device));
    }
    for (int32_t leaf = 0; leaf < order->leaf_count; ++leaf) {
      const int64_t begin = order->leaf_output[leaf], count = order->leaf_begin[leaf + 1] - order->leaf_begin[leaf];
      assert_true(peeled[leaf] <= 1);
      assert_true(!peeled[leaf] || memcmp(order->cells + begin, cells + begin, (size_t)count * sizeof *cells) == 0);
      seen->peeled += peeled[leaf];
      seen->left += !peeled[leaf];
    }
    assert_true(layers <= expected.layers && (expected.cycles > 0 || layers == expected.layers));
    assert_memory_equal(order->state, relations, (size_t)order->cell_count);
  }
  seen->layers = expected.layers > seen->layers ? expected.layers : seen->layers;
  seen->cycles += expected.cycles;
  free(cells);
  free(peeled);
  free(relations);
}

static stratus_camera make_camera(int number)
{
  stratus_camera camera = { .eye = { 13.0 * (number % 3) - 9.0, 7.0 * (number % 5) - 8.0, 20.0 - 9.0 * (number % 4) },
    .forward = { 0.3 * (number % 3), 1.0, 0.7 - 0.4 * (number % 4) },
    .parallel = number % 2 };
  if (number == 0) {
    camera = (stratus_camera){ .forward = { 0, 0, -1 }, .parallel = 1 };
  }
  return camera;
}

/* kind 0: a grid; 1: its cells scattered; 2: with irises, whose blades hide one another in rings as seen along z. */
static mesh_case make_mesh(int kind)
{
  const int side = tiny ? 2 : 9, n[3] = { side, side, side };
  mesh_case mesh = mesh_grid(n, 0.19, 4);
  if (kind == 1) {
    mesh_shuffle(&mesh, 5);
  }
  for (int i = 0; i < 4 && kind == 2; ++i) {
    mesh_case iris = mesh_iris(4 + i);
    mesh_move(&iris, (const double[]){ 1, 1, 1 }, (const double[]){ 8.0 * i, 40.0, 0.0 });
    mesh = mesh_join(mesh, iris);
  }
  return mesh;
}

static void layers_are_the_hosts_to_the_byte(void** state)
{
  compared seen = { 0 }, leaves = { 0 };
  (void)state;
  for (int kind = tiny ? 1 : 0; kind < 3; ++kind) {
    mesh_case mesh = make_mesh(kind);
    const stratus_mesh view = mesh_case_view(&mesh);
    stratus_partition_options options = stratus_partition_options_default();
    stratus_partition* partition = NULL;
    stratus_partition_result cut;
    options.leaf_cells = 20;
    options.depth = tiny ? 2 : 4;
    assert_int_equal(stratus_partition_create(host_context, &view, &options, &partition), STRATUS_OK);
    stratus_partition_get(partition, &cut);
    mesh_case pieces = { (double*)(uintptr_t)cut.points, (int32_t*)(uintptr_t)cut.vertices, cut.point_count, cut.cell_count };
    stratus_visibility_order *one = make_order(&mesh, NULL, host_context), *many = make_order(&pieces, &cut.leaves, host_context);
    assert_true(many->leaf_count > 2);
    for (int v = 0; v < (tiny ? 1 : 12); ++v) {
      const stratus_camera camera = make_camera(v);
      compare_layers(one, &camera, &seen);
      compare_layers(many, &camera, &leaves);
    }
    stratus_visibility_order_destroy(one);
    stratus_visibility_order_destroy(many);
    stratus_partition_destroy(partition);
    mesh_case_free(&mesh);
  }
  printf("layers %d, cycles %d, leaves peeled %d, left %d\n", (int)leaves.layers, (int)leaves.cycles, (int)leaves.peeled, (int)leaves.left);
  assert_true(seen.peeled > 0 && leaves.peeled > 0);
  assert_true(seen.cycles > 0 && leaves.cycles > 0 && leaves.left > 0);
  assert_true(tiny || seen.layers > 32); /* more than one batch */
}

/* A device that builds peels the layers of large meshes; without memory the host does. */
static void large_meshes_are_peeled_on_the_device(void** state)
{
  static const int n[3] = { 15, 14, 14 };
  const stratus_camera camera = { .eye = { -20, 31, 3 }, .forward = { 1, 0, 0 } };
  stratus_visibility_result expected, result;
  stratus_build_stage stages[STRATUS_BUILD_STAGES_MAX];
  (void)state;
  if (tiny) {
    return;
  }
  mesh_case mesh = mesh_grid(n, 0.19, 3);
  stratus_visibility_order *host = make_order(&mesh, NULL, host_context), *order = make_order(&mesh, NULL, device);
  sort_cells(host, &camera, &expected);
  device->device->is_cpu = true;
  stratus_context_start_build_report(device);
  stratus_device_fail_after(device->device, 1000000, CL_SUCCESS);
  sort_cells(order, &camera, &result);
  const int64_t calls = 1000000 - device->device->calls_left;
  const int count = stratus_context_get_build_report(device, stages, STRATUS_BUILD_STAGES_MAX);
  assert_true(count > 0);
  assert_string_equal(stages[count - 1].name, "visibility peeling");
  /* A launch to clear, the first layer, and layers up to an empty one, 32 at once: two each. */
  assert_int_equal(stages[count - 1].kernels, 1 + 2 + 2 * 32 * ((expected.layers - 1) / 32 + 1));
  assert_int_equal(result.layers, expected.layers);
  assert_memory_equal(result.cells, expected.cells, (size_t)mesh.cell_count * sizeof *result.cells);
  for (int64_t call = 0; call < calls; call += call < 40 ? 1 : 61) {
    stratus_visibility_order_destroy(order);
    order = make_order(&mesh, NULL, device);
    stratus_device_fail_after(device->device, call, CL_MEM_OBJECT_ALLOCATION_FAILURE);
    sort_cells(order, &camera, &result);
    assert_memory_equal(result.cells, expected.cells, (size_t)mesh.cell_count * sizeof *result.cells);
    order->sorted = false;
    stratus_device_fail_after(device->device, call / 4, CL_DEVICE_NOT_AVAILABLE);
    assert_int_equal(stratus_visibility_order_sort(order, &camera, NULL, STRATUS_PEELING_LAYERS, &result), STRATUS_DEVICE_ERROR);
    stratus_device_fail_after(device->device, -1, CL_SUCCESS);
    sort_cells(order, &camera, &result);
    assert_memory_equal(result.cells, expected.cells, (size_t)mesh.cell_count * sizeof *result.cells);
  }
  stratus_visibility_order_destroy(host);
  stratus_visibility_order_destroy(order);
  mesh_case_free(&mesh);
}

/* The whole order, where the device peels some leaves and leaves one with a ring to the host. */
static void a_leaf_with_a_ring_is_peeled_on_the_host(void** state)
{
  static const int n[3] = { 15, 14, 14 };
  const stratus_camera camera = { .forward = { 0, 0, -1 }, .parallel = 1 };
  stratus_visibility_result expected, result;
  stratus_partition* partition = NULL;
  stratus_partition_result cut;
  stratus_build_stage stages[STRATUS_BUILD_STAGES_MAX];
  (void)state;
  if (tiny) {
    return;
  }
  mesh_case mesh = mesh_grid(n, 0.19, 3), iris = mesh_iris(5);
  mesh_move(&iris, (const double[]){ 1, 1, 1 }, (const double[]){ 0.0, 40.0, 0.0 });
  mesh = mesh_join(mesh, iris);
  const stratus_mesh view = mesh_case_view(&mesh);
  assert_int_equal(stratus_partition_create(host_context, &view, NULL, &partition), STRATUS_OK);
  stratus_partition_get(partition, &cut);
  mesh_case pieces = { (double*)(uintptr_t)cut.points, (int32_t*)(uintptr_t)cut.vertices, cut.point_count, cut.cell_count };
  stratus_visibility_order *host = make_order(&pieces, &cut.leaves, host_context), *order = make_order(&pieces, &cut.leaves, device);
  sort_cells(host, &camera, &expected);
  stratus_context_start_build_report(device);
  sort_cells(order, &camera, &result);
  const int count = stratus_context_get_build_report(device, stages, STRATUS_BUILD_STAGES_MAX);
  assert_true(count > 0 && stages[count - 1].kernels > 0);
  assert_true(cut.leaves.leaf_count > 2 && expected.cycles > 0);
  assert_int_equal(result.cycles, expected.cycles);
  assert_int_equal(result.layers, expected.layers);
  assert_int_equal(result.forced, expected.forced);
  assert_memory_equal(result.cells, expected.cells, (size_t)pieces.cell_count * sizeof *result.cells);
  stratus_visibility_order_destroy(host);
  stratus_visibility_order_destroy(order);
  stratus_partition_destroy(partition);
  mesh_case_free(&mesh);
}

int test_visibility_layers_device(void)
{
  if (no_device()) {
    return TEST_SKIPPED;
  }
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(layers_are_the_hosts_to_the_byte),
    cmocka_unit_test(large_meshes_are_peeled_on_the_device),
    cmocka_unit_test(a_leaf_with_a_ring_is_peeled_on_the_host),
  };
  return cmocka_run_group_tests(tests, open_device, close_device);
}
