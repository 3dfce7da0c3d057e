/* SPDX-License-Identifier: BSD-3-Clause
 * The build report, on the host and on a device that is taken for a GPU: its stages, the place and the number of kernels of each, and the
 * bytes that each stage made, which are equal on both. */
#include "structures.h"

#include "device.h"
#include "device_pair.h"
#include "distance_field.h"
#include "stratus/distance_field.h"
#include "mesh_case.h"
#include "tree.h"

/* Numbers of kernels in a stage. */
#define HOST 0
#define SOME -1 /* one or more kernels, else exactly so many */

typedef struct expected_stage {
  const char* name;
  uint64_t bytes;
  int kernels; /* on the device */
} expected_stage;

static void assert_report(stratus_context* context, const expected_stage* expected, int count)
{
  stratus_build_stage stages[STRATUS_BUILD_STAGES_MAX];
  assert_int_equal(stratus_context_get_build_report(context, stages, STRATUS_BUILD_STAGES_MAX), count);
  for (int i = 0; i < count; ++i) {
    const bool there = context == device && expected[i].kernels != HOST;
    assert_string_equal(stages[i].name, expected[i].name);
    assert_string_equal(stages[i].where, there ? stratus_context_device(device) : "host");
    assert_int_equal(stages[i].bytes, expected[i].bytes);
    assert_true(stages[i].ms >= 0.0);
    if (there && expected[i].kernels == SOME) {
      assert_true(stages[i].kernels > 0);
    } else {
      assert_int_equal(stages[i].kernels, there ? expected[i].kernels : 0);
    }
  }
  stratus_context_start_build_report(context);
}

static void call(stratus_context* context, stratus_status status)
{
  if (status != STRATUS_OK) {
    fail_msg("%s", stratus_context_message(context));
  }
}

static void maps_of_blocks(stratus_context* context)
{
  static const double white[] = { 0, 1, 1, 1 }, opacity[] = { -1, 0, 0.5, 0, 1, 1 };
  uint32_t random = 1;
  sample_volume v = make_volume(STRATUS_FLOAT32, 41, 22, 13, 1, &random);
  stratus_transfer transfer = stratus_transfer_default();
  transfer.opacity = opacity;
  transfer.opacity_count = 3;
  transfer.color = white;
  transfer.color_count = 1;
  const uint64_t blocks = 10 * 6 * 3;
  stratus_value_range* ranges = NULL;
  stratus_occupancy *shown = NULL, *between = NULL;
  stratus_distance_map *flags = NULL, *map = NULL;
  call(context, stratus_value_range_create(context, &v.view, 4, &ranges));
  call(context, stratus_occupancy_create(context, ranges, &transfer, STRATUS_SAMPLING_MIDPOINT, &shown));
  call(context, stratus_distance_map_create(context, shown, STRATUS_DISTANCE_FULL, &map));
  const expected_stage three[] = { { "value ranges", 9 * blocks, SOME }, { "occupancy", blocks, SOME },
    { "distance map", stratus_distance_map_bytes(map), SOME } };
  assert_report(context, three, 3);
  /* Flags of blocks are no distances: the host makes them. */
  call(context, stratus_occupancy_create_between(context, ranges, 0.5, 1.0, &between));
  call(context, stratus_distance_map_create(context, between, STRATUS_DISTANCE_BLOCK, &flags));
  const expected_stage two[] = { { "occupancy", blocks, 1 }, { "distance map", stratus_distance_map_bytes(flags), HOST } };
  assert_report(context, two, 2);
  stratus_distance_map_destroy(flags);
  stratus_distance_map_destroy(map);
  stratus_occupancy_destroy(between);
  stratus_occupancy_destroy(shown);
  stratus_value_range_destroy(ranges);
  free_volume(&v);
}

static void trees(stratus_context* context)
{
  uint32_t random = 2;
  sample_volume v = make_volume(STRATUS_FLOAT32, 40, 36, 32, 1, &random);
  const uint64_t blocks = 10 * 9 * 8;
  stratus_criterion criterion = stratus_criterion_default();
  stratus_tree_options options = stratus_tree_options_default();
  stratus_voxels *cells = NULL, *voxels = NULL;
  stratus_tree* tree = NULL;
  stratus_field* field = NULL;
  criterion.lower = 0.99;
  call(context, stratus_voxels_create_cells(context, &v.view, &criterion, &cells));
  const expected_stage of_cells[] = { { "value ranges", 9 * blocks, SOME }, { "occupancy", blocks, 1 },
    { "effective voxels", (uint64_t)cells->brick_count * sizeof(stratus_brick), HOST } };
  assert_report(context, of_cells, 3);
  call(context, stratus_voxels_create(context, &v.view, &criterion, &voxels));
  const uint64_t bricks = (uint64_t)voxels->brick_count;
  const expected_stage of_voxels[] = { { "effective voxels", bricks * sizeof(stratus_brick), 3 /* masks, counts, bricks */ } };
  assert_report(context, of_voxels, 1);

  options.method = STRATUS_TREE_HYBRID;
  options.field_emptiness = 2.0; /* so that the root is split by density */
  call(context, stratus_tree_create(context, voxels, &options, &tree));
  const uint64_t nodes = tree->node_count * sizeof *tree->nodes;
  const expected_stage of_hybrid[] = { { "density", bricks * sizeof(float), SOME },
    { "tree shape", nodes + bricks * sizeof(uint32_t), SOME },
    { "tree leaves", stratus_tree_memory(tree), 7 /* whatever the number of leaves */ } };
  assert_true(tree->field_count > 1);
  assert_report(context, of_hybrid, 3);
  stratus_tree_destroy(tree);

  options.method = STRATUS_TREE_LBVH;
  call(context, stratus_tree_create(context, voxels, &options, &tree));
  /* Codes and tree; where the device lays it out, pairs sorted by depth, then subtrees and places of all levels in a launch each. */
  const bool lays_out = stratus_device_has_double(device->device);
  const expected_stage of_boxes[] = { { "hierarchy", tree->node_count * sizeof *tree->nodes + (uint64_t)voxels->count * sizeof(uint32_t),
    lays_out ? 2 + 13 + 2 : 2 } };
  assert_report(context, of_boxes, 1);
  stratus_tree_destroy(tree);

  options.method = STRATUS_TREE_DISTANCE;
  call(context, stratus_tree_create(context, voxels, &options, &tree));
  const int32_t* rows = tree->fields[0].cells; /* of at most 10 bricks, which the map keeps in 64 bytes, with 64 bytes behind the last */
  const expected_stage of_distances[] = { { "tree shape", sizeof *tree->nodes + bricks * sizeof(uint32_t), HOST },
    { "distance map", 64 * ((uint64_t)rows[1] * (uint64_t)rows[2] + 1), SOME }, { "tree leaves", stratus_tree_memory(tree), HOST } };
  assert_report(context, of_distances, 3);
  stratus_tree_destroy(tree);

  call(context, stratus_field_create(context, voxels, NULL, &field, NULL));
  const expected_stage of_field[] = { { "distance field", 40 * 36 * 32 * (uint64_t)field->bytes,
    3 /* columns, and a search along x and z */ } };
  assert_report(context, of_field, 1);
  stratus_field_destroy(field);
  stratus_voxels_destroy(voxels);
  stratus_voxels_destroy(cells);
  free_volume(&v);
}

static void meshes(stratus_context* context)
{
  const int n[3] = { 14, 14, 14 }; /* 16464 cells */
  mesh_case mesh = mesh_grid(n, 0.1, 1);
  const stratus_mesh view = mesh_case_view(&mesh);
  stratus_partition_options options = stratus_partition_options_default();
  stratus_partition* partition = NULL;
  stratus_partition_result cut;
  stratus_visibility_order* order = NULL;
  stratus_visibility_result result;
  stratus_camera camera = { .eye = { 30, 20, 50 }, .forward = { 0, 0, -1 } };
  options.depth = 2;
  call(context, stratus_partition_create(context, &view, &options, &partition));
  stratus_partition_get(partition, &cut);
  const expected_stage of_partition[] = { { "partition",
    (uint64_t)cut.cell_count * 6 * 4 + (uint64_t)cut.point_count * 3 * 8 + (uint64_t)cut.leaves.node_count * sizeof *cut.leaves.nodes,
    SOME /* sorting */ } };
  assert_report(context, of_partition, 1);
  stratus_partition_destroy(partition);
  call(context, stratus_visibility_order_create(context, &view, NULL, &order));
  call(context, stratus_visibility_order_sort(order, &camera, NULL, STRATUS_PEELING_NEAREST, &result));
  const uint64_t cells = (uint64_t)mesh.cell_count;
  const expected_stage of_order[] = { { "visibility order", result.bytes, SOME /* neighbours */ }, { "visibility signs", cells, 1 },
    { "visibility peeling", 4 * cells, HOST } };
  assert_report(context, of_order, 3);
  call(context, stratus_visibility_order_sort(order, &camera, NULL, STRATUS_PEELING_NEAREST, &result));
  assert_report(context, NULL, 0); /* the same view has the same order */
  stratus_visibility_order_destroy(order);
  mesh_case_free(&mesh);
}

static void stages_of_blocks_are_reported(void** state)
{
  (void)state;
  maps_of_blocks(host_context);
  maps_of_blocks(device);
}

static void stages_of_trees_are_reported(void** state)
{
  (void)state;
  trees(host_context);
  trees(device);
}

static void stages_of_meshes_are_reported(void** state)
{
  (void)state;
  meshes(host_context);
  meshes(device);
}

/* A kernel that does not start is no launch, and the report leaves out a stage that fails; the next call is reported. */
static void a_stage_on_a_lost_device_is_not_reported(void** state)
{
  (void)state;
  uint32_t random = 3;
  sample_volume v = make_volume(STRATUS_UINT8, 9, 9, 9, 1, &random);
  stratus_value_range* ranges = NULL;
  const uint64_t before = device->report.launched;
  stratus_device_fail_after(device->device, 0, CL_DEVICE_NOT_AVAILABLE);
  assert_int_not_equal(stratus_value_range_create(device, &v.view, 4, &ranges), STRATUS_OK);
  stratus_device_fail_after(device->device, -1, CL_SUCCESS);
  assert_report(device, NULL, 0);
  assert_int_equal(device->report.launched, before);
  call(device, stratus_value_range_create(device, &v.view, 4, &ranges));
  const expected_stage one[] = { { "value ranges", 9 * 8, SOME } };
  assert_report(device, one, 1);
  stratus_value_range_destroy(ranges);
  free_volume(&v);
}

int test_build_report_device(void)
{
  if (no_device()) {
    return TEST_SKIPPED;
  }
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(stages_of_blocks_are_reported),
    cmocka_unit_test(stages_of_trees_are_reported),
    cmocka_unit_test(stages_of_meshes_are_reported),
    cmocka_unit_test(a_stage_on_a_lost_device_is_not_reported),
  };
  return cmocka_run_group_tests(tests, open_device_as_gpu, close_device);
}
