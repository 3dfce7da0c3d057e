/* SPDX-License-Identifier: BSD-3-Clause
 * Neighbours found by an OpenCL device, as a processor and as a GPU sort, against the host's: faces that many cells share, faces with both
 * cells on one side, flat cells and cells that name a point twice among them. Run with the argument `--tiny` it takes small meshes. */
#include "structures.h"

#include "adjacency_device.h"
#include "device_pair.h"
#include "mesh_case.h"

static stratus_adjacency* make_adjacency(stratus_context* context, const stratus_mesh* mesh)
{
  stratus_adjacency* adjacency = NULL;
  if (stratus_adjacency_create(context, mesh, &adjacency) != STRATUS_OK) {
    fail_msg("%s", stratus_context_message(context));
  }
  return adjacency;
}

static void assert_same(const stratus_adjacency* p, const stratus_adjacency* expected)
{
  assert_memory_equal(p->neighbours, expected->neighbours, (size_t)p->cell_count * 4 * sizeof *p->neighbours);
  assert_memory_equal(p->orientation, expected->orientation, (size_t)p->cell_count);
  assert_int_equal(p->border_faces, expected->border_faces);
  assert_int_equal(p->broken_faces, expected->broken_faces);
  assert_int_equal(p->folded_faces, expected->folded_faces);
  assert_int_equal(p->flat, expected->flat);
  assert_int_equal(p->inverted, expected->inverted);
}

/* Pairs the faces on the device, however few they are. */
static void compare_pairs(const stratus_mesh* mesh, const stratus_adjacency* expected)
{
  for (int gpu = 0; gpu < 2; ++gpu) {
    stratus_adjacency* adjacency = make_adjacency(host_context, mesh);
    device->device->is_cpu = !gpu;
    memset(adjacency->neighbours, 0x55, (size_t)mesh->cell_count * 4 * sizeof *adjacency->neighbours);
    adjacency->broken_faces = adjacency->folded_faces = -1;
    if (stratus_adjacency_pair_on_device(device, mesh, adjacency) != STRATUS_OK) {
      fail_msg("%s", stratus_context_message(device));
    }
    assert_same(adjacency, expected);
    stratus_adjacency_destroy(adjacency);
  }
}

/* Random cells of few points: faces are shared in every way. */
static void neighbours_of_random_cells_are_the_hosts(void** state)
{
  uint32_t random = 3;
  int64_t broken = 0, folded = 0, flat = 0, inner = 0, twice = 0;
  const int repeats = tiny ? 6 : 60;
  (void)state;
  for (int repeat = 0; repeat < repeats; ++repeat) {
    mesh_case mesh = mesh_case_allocate(4 + 3 * (repeat % 6), 1 + mesh_random(&random) % (tiny ? 40 : 300));
    for (int64_t i = 0; i < 3 * mesh.point_count; ++i) {
      mesh.points[i] = mesh_random(&random) % 4;
    }
    for (int64_t i = 0; i < 4 * mesh.cell_count; ++i) {
      mesh.vertices[i] = (int32_t)(mesh_random(&random) % mesh.point_count);
    }
    const stratus_mesh view = mesh_case_view(&mesh);
    stratus_adjacency* expected = make_adjacency(host_context, &view);
    compare_pairs(&view, expected);
    broken += expected->broken_faces;
    folded += expected->folded_faces;
    flat += expected->flat;
    inner += 4 * mesh.cell_count - expected->border_faces;
    for (int64_t cell = 0; cell < mesh.cell_count; ++cell) {
      twice += stratus_names_a_point_twice(mesh.vertices + 4 * cell);
    }
    stratus_adjacency_destroy(expected);
    mesh_case_free(&mesh);
  }
  assert_true(broken > repeats && folded > repeats && flat > repeats && inner > repeats && twice > repeats);
}

/* The most bits that a point's number has: 31 of the first point, 31 of the second. The points themselves are not read. */
static void point_numbers_of_31_bits_are_distinct(void** state)
{
  static const int32_t high = INT32_MAX - 8;
  int32_t vertices[4 * 40];
  uint32_t random = 11;
  (void)state;
  stratus_mesh mesh = stratus_mesh_default();
  mesh.vertices = vertices;
  mesh.cell_count = 40;
  mesh.point_count = 8;
  double points[24] = { 0, 0, 0, 3, 0, 0, 0, 3, 0, 0, 0, 3, 5, 4, 7, 1, 9, 2, 4, 4, 1, 8, 0, 6 };
  mesh.points = points;
  for (int i = 0; i < 4 * 40; ++i) {
    vertices[i] = (int32_t)(mesh_random(&random) % 8);
  }
  stratus_adjacency *expected = make_adjacency(host_context, &mesh), *adjacency = make_adjacency(host_context, &mesh);
  for (int i = 0; i < 4 * 40; ++i) {
    vertices[i] = vertices[i] < 4 ? vertices[i] : high + vertices[i]; /* in the same order */
  }
  mesh.point_count = INT32_MAX;
  memset(adjacency->neighbours, 0x55, 4 * 40 * sizeof *adjacency->neighbours);
  assert_int_equal(stratus_adjacency_pair_on_device(device, &mesh, adjacency), STRATUS_OK);
  assert_true(expected->border_faces < 4 * 40);
  assert_same(adjacency, expected);
  stratus_adjacency_destroy(adjacency);
  stratus_adjacency_destroy(expected);
}

/* Large meshes go to the device, which runs kernels for them; without memory the host pairs their faces. */
static void large_meshes_go_to_the_device(void** state)
{
  const int n[3] = { 12, 11, 10 };
  const size_t largest = device->device->largest_allocation;
  (void)state;
  if (tiny) {
    return;
  }
  mesh_case mesh = mesh_grid(n, 0.15, 5);
  mesh_shuffle(&mesh, 6);
  stratus_mesh view = mesh_case_view(&mesh);
  stratus_adjacency* expected = make_adjacency(host_context, &view);
  assert_false(stratus_adjacency_on_device(host_context, &view));
  assert_true(stratus_adjacency_on_device(device, &view));
  device->device->largest_allocation = (size_t)mesh.cell_count * 4 * sizeof(uint64_t) - 1;
  assert_false(stratus_adjacency_on_device(device, &view));
  device->device->largest_allocation = largest;
  view.cell_count = 4095;
  assert_false(stratus_adjacency_on_device(device, &view));
  view.cell_count = mesh.cell_count;
  compare_pairs(&view, expected);
  for (int gpu = 0; gpu < 2; ++gpu) {
    device->device->is_cpu = !gpu;
    const uint64_t launched = device->report.launched;
    stratus_device_fail_after(device->device, 100000, CL_SUCCESS);
    stratus_adjacency* adjacency = make_adjacency(device, &view);
    const int64_t calls = 100000 - device->device->calls_left;
    /* Points have 11 bits: 2 and 3 passes of 8 bits, or 3 and 6 of 4, each of 2 kernels; and keys twice, and pairs. */
    assert_int_equal(device->report.launched - launched, gpu ? 3 + 2 * 9 : 3 + 2 * 5);
    assert_same(adjacency, expected);
    stratus_adjacency_destroy(adjacency);
    for (int64_t call = 0; call < calls; ++call) {
      stratus_device_fail_after(device->device, call, CL_MEM_OBJECT_ALLOCATION_FAILURE);
      adjacency = make_adjacency(device, &view);
      assert_same(adjacency, expected);
      stratus_adjacency_destroy(adjacency);
      adjacency = NULL;
      stratus_device_fail_after(device->device, call, CL_DEVICE_NOT_AVAILABLE);
      assert_int_equal(stratus_adjacency_create(device, &view, &adjacency), STRATUS_DEVICE_ERROR);
      assert_null(adjacency);
    }
    stratus_device_fail_after(device->device, -1, CL_SUCCESS);
  }
  stratus_adjacency_destroy(expected);
  mesh_case_free(&mesh);
}

int test_adjacency_device(void)
{
  if (no_device()) {
    return TEST_SKIPPED;
  }
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(neighbours_of_random_cells_are_the_hosts),
    cmocka_unit_test(point_numbers_of_31_bits_are_distinct),
    cmocka_unit_test(large_meshes_go_to_the_device),
  };
  return cmocka_run_group_tests(tests, open_device, close_device);
}
