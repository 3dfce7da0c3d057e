/* SPDX-License-Identifier: BSD-3-Clause
 * NULL for every argument of every public function. A call that returns a status refuses it, says so where an object can hold the message,
 * and changes nothing. A call without a status takes NULL for something empty. The list is compared with the header, so that no function is
 * left out. */
#include "stratus.h"
#include "tree.h"
#include "octree.h"

#include "small_scene.h"

#include "volume.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

#define CALLS_MOST 1024

static char called[CALLS_MOST][64];
static int calls;
static stratus_context* context;
static void* untouched; /* result of refused calls, which must stay NULL */

static void remember(const char* call)
{
  assert_true(calls < CALLS_MOST);
  snprintf(called[calls++], sizeof *called, "%.*s", (int)strcspn(call, "("), call);
}

static void check_refused(const char* call, stratus_status status, bool names_null, int line)
{
  remember(call);
  if (status != STRATUS_INVALID_ARGUMENT) {
    fail_msg("line %d: %s: %s", line, call, stratus_status_name(status));
  }
  if (names_null && !strstr(context->message, "NULL") && !strstr(context->message, "(null)")) {
    fail_msg("line %d: %s: \"%s\" does not name NULL", line, call, context->message);
  }
  if (untouched) {
    fail_msg("line %d: %s: made something", line, call);
  }
}

/* REFUSES: refused, and the context's message says why. IS_SILENT: refused, with no object for a message. */
#define REFUSES(call) (context->message[0] = '\0', check_refused(#call, (call), true, __LINE__))
#define IS_SILENT(call) check_refused(#call, (call), false, __LINE__)
/* Calls without a status, and calls that allow a NULL. */
#define TAKES(call) (remember(#call), (void)(call))
#define GIVES(expected, call) (remember(#call), assert_true((call) == (expected)))
#define ACCEPTS(call) (remember(#call), assert_int_equal((call), STRATUS_OK))
#define MAKES(type) ((type**)(void*)&untouched)

static int64_t three[3], more[3];
static double six[6], nine[16];

static void bricks(const stratus_volume* v)
{
  const stratus_brick_pool_options options = stratus_brick_pool_options_default();
  const stratus_brick_source source = { .type = STRATUS_FLOAT32 };
  stratus_brick_pool* pool = NULL;
  stratus_brick_pool_report pool_report;
  stratus_bricks_report report;
  TAKES(stratus_brick_pool_options_default());
  IS_SILENT(stratus_brick_pool_create(NULL, &options, MAKES(stratus_brick_pool)));
  REFUSES(stratus_brick_pool_create(context, &options, NULL));
  ACCEPTS(stratus_brick_pool_create(context, NULL, &pool));
  IS_SILENT(stratus_brick_pool_set_memory(NULL, 0));
  TAKES(stratus_brick_pool_get_report(NULL, &pool_report));
  TAKES(stratus_brick_pool_get_report(pool, NULL));
  IS_SILENT(stratus_bricks_create(NULL, pool, &source, MAKES(stratus_bricks)));
  REFUSES(stratus_bricks_create(context, NULL, &source, MAKES(stratus_bricks)));
  REFUSES(stratus_bricks_create(context, pool, NULL, MAKES(stratus_bricks)));
  REFUSES(stratus_bricks_create(context, pool, &source, NULL));
  GIVES(NULL, stratus_bricks_values(NULL));
  GIVES(NULL, stratus_bricks_missing(NULL));
  GIVES(NULL, stratus_bricks_tiles(NULL));
  GIVES(NULL, stratus_bricks_parts(NULL));
  IS_SILENT(stratus_bricks_read_ahead(NULL, NULL));
  GIVES(NULL, stratus_bricks_reads(NULL));
  TAKES(stratus_bricks_get_report(NULL, &report));
  TAKES(stratus_bricks_destroy(NULL));
  stratus_brick_pool_destroy(pool);
  TAKES(stratus_brick_pool_destroy(NULL));
  IS_SILENT(stratus_coarse_recall(NULL, v, MAKES(stratus_coarse)));
  REFUSES(stratus_coarse_recall(context, NULL, MAKES(stratus_coarse)));
  REFUSES(stratus_coarse_recall(context, v, NULL));
  GIVES(NULL, stratus_coarse_volume(NULL));
  TAKES(stratus_coarse_destroy(NULL));
}

static void contexts(void)
{
  char message[128] = "";
  IS_SILENT(stratus_context_create(NULL, NULL, message, sizeof message));
  assert_non_null(strstr(message, "NULL"));
  TAKES(stratus_context_destroy(NULL));
  TAKES(stratus_context_get_programs(NULL, NULL));
  assert_string_equal((remember("stratus_context_message("), stratus_context_message(NULL)), "no context");
  assert_string_equal((remember("stratus_context_device("), stratus_context_device(NULL)), "");
  TAKES(stratus_context_start_build_report(NULL));
  GIVES(0, stratus_context_get_build_report(NULL, NULL, 3));
  GIVES(0, stratus_context_on_device(NULL));
  GIVES(0, stratus_context_threads(NULL));
  IS_SILENT(stratus_device_name(0, NULL, 8));
  assert_true((remember("stratus_hash("), stratus_hash(NULL, 8, 1)) == stratus_hash("", 0, 1));
}

static void inputs(const small_scene* scene)
{
  const double* v = six;
  stratus_camera camera;
  stratus_volume volume = scene->volume;
  stratus_transfer transfer = scene->transfer;
  volume.values = NULL;
  IS_SILENT(stratus_volume_check(NULL, &scene->volume));
  REFUSES(stratus_volume_check(context, NULL));
  REFUSES(stratus_volume_check(context, &volume));
  IS_SILENT(stratus_volume_bounds(NULL, &scene->volume, six));
  REFUSES(stratus_volume_bounds(context, NULL, six));
  REFUSES(stratus_volume_bounds(context, &scene->volume, NULL));
  IS_SILENT(stratus_transfer_check(NULL, &scene->transfer));
  IS_SILENT(stratus_transfer_check(NULL, NULL));
  REFUSES(stratus_transfer_check(context, NULL));
  transfer.opacity = NULL;
  IS_SILENT(stratus_transfer_check(context, &transfer));
  IS_SILENT(stratus_camera_frame(NULL, v, 2, 0, 0, 30, 1, &camera));
  REFUSES(stratus_camera_frame(context, NULL, 2, 0, 0, 30, 1, &camera));
  REFUSES(stratus_camera_frame(context, (const double[]){ 0, 1, 0, 1, 0, 1 }, 2, 0, 0, 30, 1, NULL));
  IS_SILENT(stratus_image_write(NULL, NULL, NULL, NULL));
  REFUSES(stratus_image_write(context, NULL, NULL, "a.png"));
  REFUSES(stratus_image_write(context, &(const stratus_image){ .width = 1, .height = 1 }, NULL, "a.png"));
  REFUSES(stratus_image_write(context, &(const stratus_image){ .width = 1, .height = 1, .rgba = &(float){ 0 } }, NULL, NULL));
  IS_SILENT(stratus_camera_perspective(NULL, v, v, v, 30, 1, &camera));
  REFUSES(stratus_camera_perspective(context, NULL, v, v, 30, 1, &camera));
  REFUSES(stratus_camera_perspective(context, v, NULL, v, 30, 1, &camera));
  REFUSES(stratus_camera_perspective(context, v, v, NULL, 30, 1, &camera));
  REFUSES(stratus_camera_perspective(context, v, v, v, 30, 1, NULL));
  IS_SILENT(stratus_camera_parallel(NULL, v, v, v, 30, 1, &camera));
  REFUSES(stratus_camera_parallel(context, NULL, v, v, 30, 1, &camera));
  REFUSES(stratus_camera_parallel(context, v, NULL, v, 30, 1, &camera));
  REFUSES(stratus_camera_parallel(context, v, v, NULL, 30, 1, &camera));
  REFUSES(stratus_camera_parallel(context, v, v, v, 30, 1, NULL));
}

static void structures(const small_scene* scene)
{
  stratus_value_range* ranges = NULL;
  stratus_occupancy* occupancy = NULL;
  stratus_distance_map* map = NULL;
  double low = 0, high = 0;
  int number = 1;
  const stratus_sampling rule = STRATUS_SAMPLING_MIDPOINT;
  IS_SILENT(stratus_value_range_create(NULL, &scene->volume, 0, MAKES(stratus_value_range)));
  REFUSES(stratus_value_range_create(context, NULL, 0, MAKES(stratus_value_range)));
  REFUSES(stratus_value_range_create(context, &scene->volume, 0, NULL));
  ACCEPTS(stratus_value_range_create(context, &scene->volume, 0, &ranges));
  TAKES(stratus_value_range_destroy(NULL));
  TAKES(stratus_value_range_blocks(NULL, three, &number));
  assert_true(three[0] == 0 && number == 0);
  TAKES(stratus_value_range_blocks(ranges, NULL, NULL));
  IS_SILENT(stratus_value_range_whole(NULL, &low, &high));
  ACCEPTS(stratus_value_range_whole(ranges, NULL, NULL));
  TAKES(stratus_value_range_block(NULL, 0, 0, 0, &low, &high, &number));
  assert_true(low > high && number == 0);
  TAKES(stratus_value_range_block(ranges, 0, 0, 0, NULL, NULL, NULL));
  TAKES(stratus_value_range_block(ranges, -1, INT64_MAX, 0, &low, &high, &number));
  assert_true(low > high && number == 0);
  IS_SILENT(stratus_occupancy_create(NULL, ranges, &scene->transfer, rule, MAKES(stratus_occupancy)));
  REFUSES(stratus_occupancy_create(context, NULL, &scene->transfer, rule, MAKES(stratus_occupancy)));
  REFUSES(stratus_occupancy_create(context, ranges, NULL, rule, MAKES(stratus_occupancy)));
  REFUSES(stratus_occupancy_create(context, ranges, &scene->transfer, rule, NULL));
  IS_SILENT(stratus_occupancy_create_between(NULL, ranges, 0, 1, MAKES(stratus_occupancy)));
  REFUSES(stratus_occupancy_create_between(context, NULL, 0, 1, MAKES(stratus_occupancy)));
  REFUSES(stratus_occupancy_create_between(context, ranges, 0, 1, NULL));
  ACCEPTS(stratus_occupancy_create(context, ranges, &scene->transfer, rule, &occupancy));
  TAKES(stratus_occupancy_destroy(NULL));
  TAKES(stratus_occupancy_blocks(NULL, three, &number));
  assert_true(three[1] == 0 && number == 0);
  TAKES(stratus_occupancy_blocks(occupancy, NULL, NULL));
  GIVES(0, stratus_occupancy_count(NULL));
  GIVES(0, stratus_occupancy_get(NULL, 0, 0, 0));
  GIVES(0, stratus_occupancy_get(occupancy, 0, 0, INT64_MAX));
  GIVES(0, stratus_occupancy_get(occupancy, INT64_MIN, 0, 0));
  TAKES(stratus_occupancy_bounds(NULL, three, more));
  assert_true(three[0] == 0 && more[2] == 0);
  TAKES(stratus_occupancy_bounds(occupancy, NULL, NULL));
  IS_SILENT(stratus_distance_map_create(NULL, occupancy, STRATUS_DISTANCE_OCTANT, MAKES(stratus_distance_map)));
  REFUSES(stratus_distance_map_create(context, NULL, STRATUS_DISTANCE_OCTANT, MAKES(stratus_distance_map)));
  REFUSES(stratus_distance_map_create(context, occupancy, STRATUS_DISTANCE_OCTANT, NULL));
  ACCEPTS(stratus_distance_map_create(context, occupancy, STRATUS_DISTANCE_OCTANT, &map));
  TAKES(stratus_distance_map_destroy(NULL));
  GIVES(0, stratus_distance_map_get(NULL, 0, 0, 0, 0));
  GIVES(0, stratus_distance_map_get(map, INT32_MIN, 0, INT64_MAX, 0));
  GIVES(0, stratus_distance_map_bytes(NULL));
  stratus_distance_map_destroy(map);
  stratus_occupancy_destroy(occupancy);
  stratus_value_range_destroy(ranges);
}

static void fields(const stratus_voxels* voxels)
{
  stratus_field* field = NULL;
  double number = 0;
  IS_SILENT(stratus_density_bandwidth(NULL, voxels, &number, NULL));
  REFUSES(stratus_density_bandwidth(context, NULL, &number, NULL));
  REFUSES(stratus_density_bandwidth(context, voxels, NULL, NULL));
  ACCEPTS(stratus_density_bandwidth(context, voxels, &number, NULL));
  IS_SILENT(stratus_density_at(NULL, voxels, 1, six, &number, NULL, NULL));
  REFUSES(stratus_density_at(context, NULL, 1, six, &number, NULL, NULL));
  REFUSES(stratus_density_at(context, voxels, 1, NULL, &number, NULL, NULL));
  REFUSES(stratus_density_at(context, voxels, 1, six, NULL, NULL, NULL));
  ACCEPTS(stratus_density_at(context, voxels, 1, six, &number, NULL, NULL));
  IS_SILENT(stratus_field_create(NULL, voxels, NULL, MAKES(stratus_field), NULL));
  REFUSES(stratus_field_create(context, NULL, NULL, MAKES(stratus_field), NULL));
  REFUSES(stratus_field_create(context, voxels, NULL, NULL, NULL));
  ACCEPTS(stratus_field_create(context, voxels, NULL, &field, NULL));
  TAKES(stratus_field_destroy(NULL));
  GIVES((double)INFINITY, stratus_field_get(NULL, 0, 0, 0));
  GIVES((double)INFINITY, stratus_field_get(field, 0, -1, 0));
  TAKES(stratus_field_distances(NULL, NULL));
  TAKES(stratus_field_distances(field, NULL));
  float rgba[4];
  IS_SILENT(stratus_field_rgba(NULL, voxels, rgba));
  REFUSES(stratus_field_rgba(field, NULL, rgba));
  REFUSES(stratus_field_rgba(field, voxels, NULL));
  stratus_field_destroy(field);
}

static void trees(const small_scene* scene, const stratus_voxels* voxels)
{
  const stratus_criterion criterion = stratus_criterion_default();
  stratus_tree* tree = NULL;
  stratus_tree_statistics statistics = { .nodes = 7 };
  stratus_node_box box;
  stratus_ray ray = { .direction = { 1, 0, 0 }, .t_max = 1 };
  stratus_hit hit;
  int covers = 0;
  IS_SILENT(stratus_tree_create(NULL, voxels, NULL, MAKES(stratus_tree)));
  REFUSES(stratus_tree_create(context, NULL, NULL, MAKES(stratus_tree)));
  REFUSES(stratus_tree_create(context, voxels, NULL, NULL));
  ACCEPTS(stratus_tree_create(context, voxels, NULL, &tree));
  TAKES(stratus_tree_destroy(NULL));
  TAKES(stratus_tree_get_statistics(NULL, &statistics));
  assert_true(statistics.nodes == 0);
  TAKES(stratus_tree_get_statistics(tree, NULL));
  TAKES(stratus_tree_boxes(NULL, &box));
  TAKES(stratus_tree_boxes(tree, NULL));
  IS_SILENT(stratus_tree_check(NULL, tree, voxels));
  REFUSES(stratus_tree_check(context, NULL, voxels));
  REFUSES(stratus_tree_check(context, tree, NULL));
  GIVES(0, stratus_tree_bytes(NULL));
  GIVES(0, stratus_tree_hash(NULL));
  TAKES(stratus_tree_save(NULL, &box));
  TAKES(stratus_tree_save(tree, NULL));
  IS_SILENT(stratus_tree_load(NULL, &box, sizeof box, MAKES(stratus_tree)));
  REFUSES(stratus_tree_load(context, NULL, sizeof box, MAKES(stratus_tree)));
  REFUSES(stratus_tree_load(context, &box, sizeof box, NULL));
  IS_SILENT(stratus_tree_covers(NULL, tree, &scene->volume, &criterion, 0, &covers));
  REFUSES(stratus_tree_covers(context, NULL, &scene->volume, &criterion, 0, &covers));
  REFUSES(stratus_tree_covers(context, tree, NULL, &criterion, 0, &covers));
  REFUSES(stratus_tree_covers(context, tree, &scene->volume, NULL, 0, &covers));
  REFUSES(stratus_tree_covers(context, tree, &scene->volume, &criterion, 0, NULL));
  IS_SILENT(stratus_tree_first_hit(NULL, tree, &ray, 1, &hit));
  REFUSES(stratus_tree_first_hit(context, NULL, &ray, 1, &hit));
  REFUSES(stratus_tree_first_hit(context, tree, NULL, 1, &hit));
  REFUSES(stratus_tree_first_hit(context, tree, &ray, 1, NULL));
  ACCEPTS(stratus_tree_first_hit(context, tree, NULL, 0, NULL));
  IS_SILENT(stratus_voxels_first_hit(NULL, voxels, &ray, 1, &hit));
  REFUSES(stratus_voxels_first_hit(context, NULL, &ray, 1, &hit));
  REFUSES(stratus_voxels_first_hit(context, voxels, NULL, 1, &hit));
  REFUSES(stratus_voxels_first_hit(context, voxels, &ray, 1, NULL));
  stratus_tree_destroy(tree);
}

static void voxel_sets(const small_scene* scene)
{
  const stratus_criterion criterion = { .lower = 1e6 + 0.2, .upper = INFINITY };
  const int64_t n[3] = { 4, 4, 4 };
  const int32_t place[3] = { 0 };
  stratus_voxels* voxels = NULL;
  IS_SILENT(stratus_voxels_create(NULL, &scene->volume, &criterion, MAKES(stratus_voxels)));
  REFUSES(stratus_voxels_create(context, NULL, &criterion, MAKES(stratus_voxels)));
  REFUSES(stratus_voxels_create(context, &scene->volume, NULL, MAKES(stratus_voxels)));
  REFUSES(stratus_voxels_create(context, &scene->volume, &criterion, NULL));
  IS_SILENT(stratus_voxels_create_cells(NULL, &scene->volume, &criterion, MAKES(stratus_voxels)));
  REFUSES(stratus_voxels_create_cells(context, NULL, &criterion, MAKES(stratus_voxels)));
  REFUSES(stratus_voxels_create_cells(context, &scene->volume, NULL, MAKES(stratus_voxels)));
  REFUSES(stratus_voxels_create_cells(context, &scene->volume, &criterion, NULL));
  IS_SILENT(stratus_voxels_create_list(NULL, n, place, 1, MAKES(stratus_voxels)));
  REFUSES(stratus_voxels_create_list(context, NULL, place, 1, MAKES(stratus_voxels)));
  REFUSES(stratus_voxels_create_list(context, n, NULL, 1, MAKES(stratus_voxels)));
  REFUSES(stratus_voxels_create_list(context, n, place, 1, NULL));
  TAKES(stratus_voxels_destroy(NULL));
  GIVES(0, stratus_voxels_count(NULL));
  GIVES(0, stratus_voxels_get(NULL, 0, 0, 0));
  TAKES(stratus_voxels_dimensions(NULL, three));
  assert_true(three[0] == 0);
  TAKES(stratus_voxels_bounds(NULL, three, more));
  assert_true(three[0] == 0 && more[0] == 0);
  ACCEPTS(stratus_voxels_create(context, &scene->volume, &criterion, &voxels));
  TAKES(stratus_voxels_dimensions(voxels, NULL));
  TAKES(stratus_voxels_bounds(voxels, NULL, NULL));
  fields(voxels);
  trees(scene, voxels);
  stratus_ray ray;
  IS_SILENT(stratus_voxel_scene_rays(NULL, voxels, 0, &ray));
  REFUSES(stratus_voxel_scene_rays(context, NULL, 0, &ray));
  REFUSES(stratus_voxel_scene_rays(context, voxels, 0, NULL));
  stratus_voxels_destroy(voxels);
}

static void ray_casters(const small_scene* scene)
{
  const stratus_ray_cast_options options = { .mask.label_count = 1 };
  static float rgba[4 * SMALL_PIXELS];
  const stratus_image image = { .width = SMALL_WIDTH, .height = SMALL_HEIGHT, .rgba = rgba }, blank = { .width = 1, .height = 1 };
  stratus_ray_caster* c = NULL;
  const stratus_volume* v = &scene->volume;
  const stratus_transfer* t = &scene->transfer;
  IS_SILENT(stratus_ray_caster_create(NULL, MAKES(stratus_ray_caster)));
  REFUSES(stratus_ray_caster_create(context, NULL));
  ACCEPTS(stratus_ray_caster_create(context, &c));
  TAKES(stratus_ray_caster_destroy(NULL));
  TAKES(stratus_ray_caster_release(NULL));
  IS_SILENT(stratus_ray_caster_find_ranges(NULL, v));
  REFUSES(stratus_ray_caster_find_ranges(c, NULL));
  ACCEPTS(stratus_ray_caster_find_ranges(c, v));
  IS_SILENT(stratus_ray_caster_render(NULL, v, t, &scene->camera, NULL, &image, NULL));
  REFUSES(stratus_ray_caster_render(c, NULL, t, &scene->camera, NULL, &image, NULL));
  REFUSES(stratus_ray_caster_render(c, v, NULL, &scene->camera, NULL, &image, NULL));
  REFUSES(stratus_ray_caster_render(c, v, t, NULL, NULL, &image, NULL));
  REFUSES(stratus_ray_caster_render(c, v, t, &scene->camera, NULL, NULL, NULL));
  REFUSES(stratus_ray_caster_render(c, v, t, &scene->camera, NULL, &blank, NULL));
  IS_SILENT(stratus_ray_caster_render(c, v, t, &scene->camera, &options, &image, NULL)); /* labels without a mask */
  ACCEPTS(stratus_ray_caster_render(c, v, t, &scene->camera, NULL, &image, NULL));
  stratus_ray_cast_report report = { 0 };
  TAKES(stratus_ray_cast_report_add(NULL, &report));
  TAKES(stratus_ray_cast_report_add(&report, NULL));
  const stratus_ray_cast_input several[2] = { { .caster = c, .volume = v, .transfer = t }, { .volume = v, .transfer = t } };
  const stratus_ray_cast_input no_volume = { .caster = c, .transfer = t }, no_transfer = { .caster = c, .volume = v };
  IS_SILENT(stratus_ray_caster_render_several(NULL, 1, &scene->camera, &image, NULL));
  IS_SILENT(stratus_ray_caster_render_several(several + 1, 1, &scene->camera, &image, NULL));
  REFUSES(stratus_ray_caster_render_several(several, 2, &scene->camera, &image, NULL));
  REFUSES(stratus_ray_caster_render_several(&no_volume, 1, &scene->camera, &image, NULL));
  REFUSES(stratus_ray_caster_render_several(&no_transfer, 1, &scene->camera, &image, NULL));
  REFUSES(stratus_ray_caster_render_several(several, 1, NULL, &image, NULL));
  REFUSES(stratus_ray_caster_render_several(several, 1, &scene->camera, NULL, NULL));
  ACCEPTS(stratus_ray_caster_render_several(several, 1, &scene->camera, &image, NULL));
  IS_SILENT(stratus_ray_caster_shade_surfaces(NULL, 1, &scene->camera, &image));
  IS_SILENT(stratus_ray_caster_shade_surfaces(several + 1, 1, &scene->camera, &image));
  REFUSES(stratus_ray_caster_shade_surfaces(several, 1, NULL, &image));
  REFUSES(stratus_ray_caster_shade_surfaces(several, 1, &scene->camera, NULL));
  ACCEPTS(stratus_ray_caster_shade_surfaces(several, 1, &scene->camera, &image));
  IS_SILENT(stratus_ray_caster_render_blocks(NULL, 1, &scene->camera, &image, NULL));
  IS_SILENT(stratus_ray_caster_render_blocks(several + 1, 1, &scene->camera, &image, NULL));
  REFUSES(stratus_ray_caster_render_blocks(several, 2, &scene->camera, &image, NULL));
  REFUSES(stratus_ray_caster_render_blocks(&no_volume, 1, &scene->camera, &image, NULL));
  REFUSES(stratus_ray_caster_render_blocks(&no_transfer, 1, &scene->camera, &image, NULL));
  REFUSES(stratus_ray_caster_render_blocks(several, 1, NULL, &image, NULL));
  REFUSES(stratus_ray_caster_render_blocks(several, 1, &scene->camera, NULL, NULL));
  ACCEPTS(stratus_ray_caster_render_blocks(several, 1, &scene->camera, &image, NULL));
  stratus_quantities numbers = stratus_quantities_default();
  numbers.width = SMALL_WIDTH;
  numbers.height = SMALL_HEIGHT;
  numbers.of[STRATUS_QUANTITY_INTEGRAL] = rgba;
  IS_SILENT(stratus_ray_caster_render_quantities(NULL, 1, &scene->camera, &numbers));
  IS_SILENT(stratus_ray_caster_render_quantities(several + 1, 1, &scene->camera, &numbers));
  REFUSES(stratus_ray_caster_render_quantities(several, 2, &scene->camera, &numbers));
  REFUSES(stratus_ray_caster_render_quantities(&no_volume, 1, &scene->camera, &numbers));
  ACCEPTS(stratus_ray_caster_render_quantities(&no_transfer, 1, &scene->camera, &numbers));
  REFUSES(stratus_ray_caster_render_quantities(several, 1, NULL, &numbers));
  REFUSES(stratus_ray_caster_render_quantities(several, 1, &scene->camera, NULL));
  ACCEPTS(stratus_ray_caster_render_quantities(several, 1, &scene->camera, &numbers));
  numbers.of[STRATUS_QUANTITY_TRANSMITTANCE] = rgba;
  REFUSES(stratus_ray_caster_render_quantities(&no_transfer, 1, &scene->camera, &numbers));
  numbers = (stratus_quantities){ .width = 1, .height = 1, .threshold = 0.5 }; /* nothing is wanted */
  ACCEPTS(stratus_ray_caster_render_quantities(several, 1, &scene->camera, &numbers));
  char unit[8];
  TAKES(stratus_quantity_unit(STRATUS_QUANTITY_INTEGRAL, NULL, 1, unit, sizeof unit));
  TAKES(stratus_quantity_unit(STRATUS_QUANTITY_INTEGRAL, "K", 1, NULL, sizeof unit));
  TAKES(stratus_quantity_unit(STRATUS_QUANTITY_INTEGRAL, "K", 1, unit, 0));
  IS_SILENT(stratus_ray_caster_offer_tree(NULL, rgba, sizeof rgba));
  ACCEPTS(stratus_ray_caster_offer_tree(c, NULL, 8));
  stratus_ray_caster_destroy(c);
}

static void clouds(void)
{
  double value = 0.0;
  char moment[STRATUS_TIME_TEXT];
  IS_SILENT(stratus_cloud_extinction(NULL, 1e-3, 1e-5, 1e3, &value));
  REFUSES(stratus_cloud_extinction(context, 1e-3, 1e-5, 1e3, NULL));
  IS_SILENT(stratus_cloud_opacity(NULL, 1, 1, six, &value));
  REFUSES(stratus_cloud_opacity(context, 1, 1, NULL, &value));
  REFUSES(stratus_cloud_opacity(context, 1, 1, six, NULL));
  GIVES(STRATUS_CLOUD_NONE, stratus_cloud_phase_of(NULL, NULL));
  GIVES(STRATUS_CLOUD_UNKNOWN, stratus_cloud_unit(NULL, &value));
  GIVES(STRATUS_CLOUD_UNKNOWN, stratus_cloud_unit("kg/m3", NULL));
  TAKES(stratus_cloud_light(NULL, NULL, NULL));
  GIVES(0.0, stratus_screen_level(NAN));
  IS_SILENT(stratus_air_density(NULL, 1e5, 280, &value));
  REFUSES(stratus_air_density(context, 1e5, 280, NULL));
  TAKES(stratus_air_heights(1, NULL, NULL, NULL));
  IS_SILENT(stratus_air_standard(NULL, 0, &value, six));
  REFUSES(stratus_air_standard(context, 0, NULL, &value));
  REFUSES(stratus_air_standard(context, 0, &value, NULL));
  IS_SILENT(stratus_time_parse(NULL, "2024-06-01", &value));
  REFUSES(stratus_time_parse(context, NULL, &value));
  REFUSES(stratus_time_parse(context, "2024-06-01", NULL));
  GIVES(0.0, stratus_time_unit(NULL));
  IS_SILENT(stratus_time_write(NULL, 0, "days since 2001-01-01", NULL, moment));
  REFUSES(stratus_time_write(context, 0, "days since 2001-01-01", NULL, NULL));
  REFUSES(stratus_time_write(context, 0, NULL, NULL, moment));
  IS_SILENT(stratus_time_value(NULL, "2024-06-01", "days since 2001-01-01", NULL, &value));
  REFUSES(stratus_time_value(context, NULL, "days since 2001-01-01", NULL, &value));
  REFUSES(stratus_time_value(context, "2024-06-01", NULL, NULL, &value));
  REFUSES(stratus_time_value(context, "2024-06-01", "days since 2001-01-01", NULL, NULL));
  IS_SILENT(stratus_sun_position(NULL, 0, 0, 0, &value, six));
  REFUSES(stratus_sun_position(context, 0, 0, 0, NULL, &value));
  REFUSES(stratus_sun_position(context, 0, 0, 0, &value, NULL));
  IS_SILENT(stratus_sun_direction(NULL, 0, 0, 2, six));
  REFUSES(stratus_sun_direction(context, 0, 0, 2, NULL));
}

static void annotations(const small_scene* scene)
{
  const stratus_annotation annotation = stratus_annotation_default();
  const stratus_axis axis = stratus_axis_default();
  stratus_axis_tick ticks[STRATUS_AXIS_TICKS];
  stratus_camera camera = scene->camera;
  float rgba[4] = { 0 };
  stratus_image image = { .width = 1, .height = 1, .rgba = rgba };
  double room[4] = { 0, 1, 0, 1 };
  int count = 0;
  IS_SILENT(stratus_axis_find_ticks(NULL, &axis, 0, 0, 1, 4, ticks, &count));
  REFUSES(stratus_axis_find_ticks(context, NULL, 0, 0, 1, 4, ticks, &count));
  REFUSES(stratus_axis_find_ticks(context, &axis, 0, 0, 1, 4, NULL, &count));
  REFUSES(stratus_axis_find_ticks(context, &axis, 0, 0, 1, 4, ticks, NULL));
  IS_SILENT(stratus_annotation_room(NULL, &annotation, 1, 1, room));
  REFUSES(stratus_annotation_room(context, NULL, 1, 1, room));
  REFUSES(stratus_annotation_room(context, &annotation, 1, 1, NULL));
  IS_SILENT(stratus_camera_in_room(NULL, &camera, 1, 1, room, &camera));
  REFUSES(stratus_camera_in_room(context, NULL, 1, 1, room, &camera));
  REFUSES(stratus_camera_in_room(context, &camera, 1, 1, NULL, &camera));
  REFUSES(stratus_camera_in_room(context, &camera, 1, 1, room, NULL));
  IS_SILENT(stratus_annotation_draw(NULL, &annotation, &camera, &image, NULL, 0, NULL));
  REFUSES(stratus_annotation_draw(context, NULL, &camera, &image, NULL, 0, NULL));
  REFUSES(stratus_annotation_draw(context, &annotation, NULL, &image, NULL, 0, NULL));
  REFUSES(stratus_annotation_draw(context, &annotation, &camera, NULL, NULL, 0, NULL));
  REFUSES(stratus_annotation_draw(context, &annotation, &camera, &image, NULL, 1, NULL));
}

static void globes(const small_scene* scene)
{
  const double degrees[8] = { 0, 0, 1, 0, 0, 1, 1, 1 }, heights[4] = { 0 };
  const stratus_globe earth = stratus_globe_default();
  double points[12];
  stratus_globe_lattice lattice;
  stratus_globe_points from = { .count = 4, .levels = 1, .degrees = degrees, .heights = heights, .height_stride = 1, .factor = 1 };
  stratus_camera camera = scene->camera;
  float rgba[4] = { 0 }, depth = 0, light = 0;
  stratus_image image = { .width = 1, .height = 1, .rgba = rgba };
  int64_t first, stride;
  char text[8];
  IS_SILENT(stratus_globe_find_lattice(NULL, 2, 2, degrees, &lattice));
  REFUSES(stratus_globe_find_lattice(context, 2, 2, NULL, &lattice));
  REFUSES(stratus_globe_find_lattice(context, 2, 2, degrees, NULL));
  assert_int_equal(stratus_globe_find_lattice(context, 2, 2, degrees, &lattice), STRATUS_OK);
  GIVES(0, stratus_globe_columns(NULL));
  GIVES(0, stratus_globe_rows(NULL));
  GIVES(0, stratus_globe_source(NULL, 0, 0, &first, &stride));
  GIVES(0, stratus_globe_source(&lattice, 0, 0, NULL, &stride));
  GIVES(0, stratus_globe_source(&lattice, 0, 0, &first, NULL));
  TAKES(stratus_globe_describe(NULL, text, sizeof text));
  TAKES(stratus_globe_describe(&lattice, NULL, 8));
  TAKES(stratus_globe_height_factor(0, 1)); /* which has no pointer */
  const int64_t lengths[3] = { 2, 1, 1 }, strides[3] = { 1, 2, 2 };
  double longitudes[2] = { 0, 1 };
  int changed;
  IS_SILENT(stratus_longitudes_unwrap(NULL, lengths, strides, longitudes, &changed));
  REFUSES(stratus_longitudes_unwrap(context, NULL, strides, longitudes, &changed));
  REFUSES(stratus_longitudes_unwrap(context, lengths, NULL, longitudes, &changed));
  REFUSES(stratus_longitudes_unwrap(context, lengths, strides, NULL, &changed));
  REFUSES(stratus_longitudes_unwrap(context, lengths, strides, longitudes, NULL));
  IS_SILENT(stratus_globe_place(NULL, &from, points));
  REFUSES(stratus_globe_place(context, NULL, points));
  REFUSES(stratus_globe_place(context, &from, NULL));
  from.degrees = NULL;
  REFUSES(stratus_globe_place(context, &from, points));
  from.degrees = degrees;
  from.heights = NULL;
  REFUSES(stratus_globe_place(context, &from, points));
  IS_SILENT(stratus_globe_end_rays(NULL, &earth, 1, 1, &camera, &depth, &light));
  REFUSES(stratus_globe_end_rays(context, NULL, 1, 1, &camera, &depth, &light));
  REFUSES(stratus_globe_end_rays(context, &earth, 1, 1, NULL, &depth, &light));
  REFUSES(stratus_globe_end_rays(context, &earth, 1, 1, &camera, NULL, &light));
  REFUSES(stratus_globe_end_rays(context, &earth, 1, 1, &camera, &depth, NULL));
  IS_SILENT(stratus_globe_draw(NULL, &earth, &camera, &light, &image));
  REFUSES(stratus_globe_draw(context, NULL, &camera, &light, &image));
  REFUSES(stratus_globe_draw(context, &earth, NULL, &light, &image));
  REFUSES(stratus_globe_draw(context, &earth, &camera, NULL, &image));
  REFUSES(stratus_globe_draw(context, &earth, &camera, &light, NULL));
}

static void color_maps(void)
{
  static double points[4 * STRATUS_COLOR_MAP_COLORS];
  TAKES(stratus_color_map_name(-1));
  IS_SILENT(stratus_color_map_points(NULL, "viridis", 0, 1, points));
  REFUSES(stratus_color_map_points(context, NULL, 0, 1, points));
  REFUSES(stratus_color_map_points(context, "viridis", 0, 1, NULL));
}

static void looks(const small_scene* scene)
{
  stratus_look look = { .opacity_count = 0 };
  stratus_look_values values = { .low = 0 };
  GIVES(1.0, stratus_look_height_factor(NULL, 2));
  GIVES(STRATUS_LOOK_UNKNOWN, stratus_look_kind_of(NULL, NULL, NULL, 0, NULL));
  TAKES(stratus_look_options_default());
  IS_SILENT(stratus_look_count(NULL, &scene->volume, 1, &values));
  REFUSES(stratus_look_count(context, NULL, 1, &values));
  REFUSES(stratus_look_count(context, &scene->volume, 1, NULL));
  IS_SILENT(stratus_look_guess(NULL, &scene->volume, 1, NULL, &look));
  REFUSES(stratus_look_guess(context, NULL, 1, NULL, &look));
  ACCEPTS(stratus_look_guess(context, &scene->volume, 1, NULL, &look));
  REFUSES(stratus_look_guess(context, &scene->volume, 1, NULL, NULL));
}

static void path_tracers(const small_scene* scene)
{
  static float rgba[4 * SMALL_PIXELS];
  const stratus_image image = { .width = SMALL_WIDTH, .height = SMALL_HEIGHT, .rgba = rgba }, blank = { .width = 1, .height = 1 };
  stratus_path_options options = stratus_path_options_default();
  stratus_path_tracer* p = NULL;
  const stratus_volume* v = &scene->volume;
  const stratus_transfer* t = &scene->transfer;
  options.samples = 1;
  IS_SILENT(stratus_path_tracer_create(NULL, MAKES(stratus_path_tracer)));
  REFUSES(stratus_path_tracer_create(context, NULL));
  ACCEPTS(stratus_path_tracer_create(context, &p));
  TAKES(stratus_path_tracer_destroy(NULL));
  IS_SILENT(stratus_path_tracer_render(NULL, v, t, &scene->camera, NULL, &image, NULL));
  REFUSES(stratus_path_tracer_render(p, NULL, t, &scene->camera, NULL, &image, NULL));
  REFUSES(stratus_path_tracer_render(p, v, NULL, &scene->camera, NULL, &image, NULL));
  REFUSES(stratus_path_tracer_render(p, v, t, NULL, NULL, &image, NULL));
  REFUSES(stratus_path_tracer_render(p, v, t, &scene->camera, NULL, NULL, NULL));
  REFUSES(stratus_path_tracer_render(p, v, t, &scene->camera, NULL, &blank, NULL));
  IS_SILENT(stratus_path_tracer_errors(NULL, rgba));
  IS_SILENT(stratus_path_tracer_errors(p, rgba)); /* of no image */
  ACCEPTS(stratus_path_tracer_render(p, v, t, &scene->camera, &options, &image, NULL));
  REFUSES(stratus_path_tracer_errors(p, NULL));
  ACCEPTS(stratus_path_tracer_render(p, v, t, &scene->camera, NULL, &image, NULL));
  stratus_path_tracer_destroy(p);
}

static void octree_queries(stratus_octree* tree)
{
  uint32_t id = 0;
  size_t count = 0;
  IS_SILENT(stratus_octree_query_box(NULL, six, &id, 1, &count));
  REFUSES(stratus_octree_query_box(tree, NULL, &id, 1, &count));
  REFUSES(stratus_octree_query_box(tree, six, NULL, 1, &count));
  REFUSES(stratus_octree_query_box(tree, six, &id, 1, NULL));
  ACCEPTS(stratus_octree_query_box(tree, six, NULL, 0, &count));
  IS_SILENT(stratus_octree_query_sphere(NULL, six, 1, &id, 1, &count));
  REFUSES(stratus_octree_query_sphere(tree, NULL, 1, &id, 1, &count));
  REFUSES(stratus_octree_query_sphere(tree, six, 1, NULL, 1, &count));
  REFUSES(stratus_octree_query_sphere(tree, six, 1, &id, 1, NULL));
  IS_SILENT(stratus_octree_query_ray(NULL, six, nine, 1, &id, NULL, 1, &count));
  REFUSES(stratus_octree_query_ray(tree, NULL, nine, 1, &id, NULL, 1, &count));
  REFUSES(stratus_octree_query_ray(tree, six, NULL, 1, &id, NULL, 1, &count));
  REFUSES(stratus_octree_query_ray(tree, six, nine, 1, NULL, NULL, 1, &count));
  REFUSES(stratus_octree_query_ray(tree, six, nine, 1, &id, NULL, 1, NULL));
  IS_SILENT(stratus_octree_query_nearest(NULL, six, 1, &id, NULL, &count));
  REFUSES(stratus_octree_query_nearest(tree, NULL, 1, &id, NULL, &count));
  REFUSES(stratus_octree_query_nearest(tree, six, 1, NULL, NULL, &count));
  REFUSES(stratus_octree_query_nearest(tree, six, 1, &id, NULL, NULL));
  ACCEPTS(stratus_octree_query_nearest(tree, six, 1, &id, NULL, &count));
}

static void octrees(const stratus_frustum* frustum)
{
  stratus_octree* tree = NULL;
  stratus_octree_view* view = NULL;
  stratus_octree_visible visible;
  stratus_octree_statistics statistics = { .nodes = 7 };
  stratus_octree_node node;
  uint32_t id = 0;
  IS_SILENT(stratus_octree_create(NULL, NULL, MAKES(stratus_octree)));
  REFUSES(stratus_octree_create(context, NULL, NULL));
  ACCEPTS(stratus_octree_create(context, NULL, &tree));
  TAKES(stratus_octree_destroy(NULL));
  IS_SILENT(stratus_octree_view_create(NULL, MAKES(stratus_octree_view)));
  REFUSES(stratus_octree_view_create(tree, NULL));
  ACCEPTS(stratus_octree_view_create(tree, &view));
  TAKES(stratus_octree_view_destroy(NULL));
  octree_queries(tree); /* of an empty tree, too */
  ACCEPTS(stratus_octree_cull(view, frustum, NULL, &visible));
  IS_SILENT(stratus_octree_insert(NULL, six, 1, &id));
  REFUSES(stratus_octree_insert(tree, NULL, 1, &id));
  REFUSES(stratus_octree_insert(tree, six, 1, NULL));
  ACCEPTS(stratus_octree_insert(tree, NULL, 0, NULL));
  ACCEPTS(stratus_octree_insert(tree, six, 1, &id));
  IS_SILENT(stratus_octree_insert_oriented(NULL, nine, 1, &id));
  REFUSES(stratus_octree_insert_oriented(tree, NULL, 1, &id));
  REFUSES(stratus_octree_insert_oriented(tree, nine, 1, NULL));
  IS_SILENT(stratus_octree_move(NULL, &id, six, 1));
  REFUSES(stratus_octree_move(tree, NULL, six, 1));
  REFUSES(stratus_octree_move(tree, &id, NULL, 1));
  IS_SILENT(stratus_octree_move_oriented(NULL, &id, nine, 1));
  REFUSES(stratus_octree_move_oriented(tree, NULL, nine, 1));
  REFUSES(stratus_octree_move_oriented(tree, &id, NULL, 1));
  IS_SILENT(stratus_octree_remove(NULL, &id, 1));
  REFUSES(stratus_octree_remove(tree, NULL, 1));
  IS_SILENT(stratus_octree_bounds(NULL, id, six));
  REFUSES(stratus_octree_bounds(tree, id, NULL));
  IS_SILENT(stratus_octree_cull(NULL, frustum, NULL, &visible));
  REFUSES(stratus_octree_cull(view, NULL, NULL, &visible));
  REFUSES(stratus_octree_cull(view, frustum, NULL, NULL));
  octree_queries(tree);
  IS_SILENT(stratus_octree_nodes(NULL, frustum, &node));
  REFUSES(stratus_octree_nodes(tree, frustum, NULL));
  IS_SILENT(stratus_octree_check(NULL));
  TAKES(stratus_octree_get_statistics(NULL, &statistics));
  assert_true(statistics.nodes == 0);
  TAKES(stratus_octree_get_statistics(tree, NULL));
  GIVES(0, stratus_octree_count(NULL));
  GIVES(0, stratus_octree_id_limit(NULL));
  TAKES(stratus_octree_clear(NULL));
  stratus_octree_view_destroy(view);
  stratus_octree_destroy(tree);
}

static void frustums(const small_scene* scene)
{
  stratus_frustum frustum = { 0 };
  stratus_frustum_from_camera(context, &scene->camera, &frustum);
  IS_SILENT(stratus_frustum_from_camera(NULL, &scene->camera, &frustum));
  REFUSES(stratus_frustum_from_camera(context, NULL, &frustum));
  REFUSES(stratus_frustum_from_camera(context, &scene->camera, NULL));
  IS_SILENT(stratus_frustum_check(NULL, &frustum));
  REFUSES(stratus_frustum_check(context, NULL));
  GIVES(STRATUS_SIDE_CROSSING, stratus_frustum_side(NULL, six, 1));
  GIVES(STRATUS_SIDE_CROSSING, stratus_frustum_side(&frustum, NULL, 0));
  octrees(&frustum);
}

static void orders(const stratus_mesh* mesh, const stratus_camera* camera)
{
  const stratus_leaves nothing = { .node_count = 1, .leaf_count = 1 };
  stratus_partition* partition = NULL;
  stratus_partition_result parts = { .cell_count = 7 };
  stratus_visibility_order* order = NULL;
  stratus_visibility_result result;
  IS_SILENT(stratus_partition_create(NULL, mesh, NULL, MAKES(stratus_partition)));
  REFUSES(stratus_partition_create(context, NULL, NULL, MAKES(stratus_partition)));
  REFUSES(stratus_partition_create(context, mesh, NULL, NULL));
  ACCEPTS(stratus_partition_create(context, mesh, NULL, &partition));
  TAKES(stratus_partition_destroy(NULL));
  TAKES(stratus_partition_get(NULL, &parts));
  assert_true(parts.cell_count == 0);
  TAKES(stratus_partition_get(partition, NULL));
  stratus_partition_destroy(partition);
  IS_SILENT(stratus_visibility_order_create(NULL, mesh, NULL, MAKES(stratus_visibility_order)));
  REFUSES(stratus_visibility_order_create(context, NULL, NULL, MAKES(stratus_visibility_order)));
  REFUSES(stratus_visibility_order_create(context, mesh, &nothing, MAKES(stratus_visibility_order)));
  REFUSES(stratus_visibility_order_create(context, mesh, NULL, NULL));
  ACCEPTS(stratus_visibility_order_create(context, mesh, NULL, &order));
  TAKES(stratus_visibility_order_destroy(NULL));
  IS_SILENT(stratus_visibility_order_sort(NULL, camera, NULL, STRATUS_PEELING_NEAREST, &result));
  REFUSES(stratus_visibility_order_sort(order, NULL, NULL, STRATUS_PEELING_NEAREST, &result));
  REFUSES(stratus_visibility_order_sort(order, camera, NULL, STRATUS_PEELING_NEAREST, NULL));
  ACCEPTS(stratus_visibility_order_sort(order, camera, NULL, STRATUS_PEELING_NEAREST, &result));
  stratus_visibility_order_destroy(order);
}

static void layers(void)
{
  const double numbers[3] = { 0, 1, 2 }, degrees[6] = { 0, 0, 1, 0, 0, 1 }, heights[6] = { 0, 0, 0, 1, 1, 1 };
  int64_t offsets[2] = { 0, 3 }, first[3], count;
  int32_t nodes[6] = { 0, 1, 2 }, prisms[3], vertices[12];
  uint8_t absent[1] = { 0 }, none[3], hidden[1];
  double z[6];
  const stratus_face_table table = { .numbers = numbers, .rows = 1, .columns = 3 };
  stratus_faces faces = { .node_count = 3, .face_count = 1, .offsets = offsets, .nodes = nodes, .absent = absent };
  const stratus_layer_borders borders = { .node_count = 3, .layer_count = 1, .borders = heights };
  IS_SILENT(stratus_faces_from_table(NULL, &table, &faces));
  REFUSES(stratus_faces_from_table(context, NULL, &faces));
  REFUSES(stratus_faces_from_table(context, &table, NULL));
  IS_SILENT(stratus_faces_join_corners(NULL, 3, degrees, nodes, first, &count));
  REFUSES(stratus_faces_join_corners(context, 3, NULL, nodes, first, &count));
  REFUSES(stratus_faces_join_corners(context, 3, degrees, NULL, first, &count));
  REFUSES(stratus_faces_join_corners(context, 3, degrees, nodes, NULL, &count));
  REFUSES(stratus_faces_join_corners(context, 3, degrees, nodes, first, NULL));
  IS_SILENT(stratus_faces_turn(NULL, &faces, degrees, 1));
  REFUSES(stratus_faces_turn(context, NULL, degrees, 1));
  REFUSES(stratus_faces_turn(context, &faces, NULL, 1));
  IS_SILENT(stratus_faces_to_nodes(NULL, &faces, heights, z));
  REFUSES(stratus_faces_to_nodes(context, NULL, heights, z));
  REFUSES(stratus_faces_to_nodes(context, &faces, NULL, z));
  REFUSES(stratus_faces_to_nodes(context, &faces, heights, NULL));
  stratus_flat_faces flat = { .cut = 0 };
  IS_SILENT(stratus_faces_flatten(NULL, &faces, degrees, &flat));
  REFUSES(stratus_faces_flatten(context, NULL, degrees, &flat));
  REFUSES(stratus_faces_flatten(context, &faces, NULL, &flat));
  REFUSES(stratus_faces_flatten(context, &faces, degrees, NULL));
  TAKES(stratus_flat_faces_destroy(NULL, &flat));
  TAKES(stratus_flat_faces_destroy(context, NULL));
  TAKES(stratus_flat_faces_destroy(context, &flat));
  IS_SILENT(stratus_layers_between(NULL, 1, heights, z));
  REFUSES(stratus_layers_between(context, 1, NULL, z));
  REFUSES(stratus_layers_between(context, 1, heights, NULL));
  IS_SILENT(stratus_layers_from_borders(NULL, &borders, z, none));
  REFUSES(stratus_layers_from_borders(context, NULL, z, none));
  REFUSES(stratus_layers_from_borders(context, &borders, NULL, none));
  REFUSES(stratus_layers_from_borders(context, &borders, z, NULL));
  IS_SILENT(stratus_layers_from_heights(NULL, 3, 1, 1, heights, z, none));
  REFUSES(stratus_layers_from_heights(context, 3, 1, 1, NULL, z, none));
  REFUSES(stratus_layers_from_heights(context, 3, 1, 1, heights, NULL, none));
  REFUSES(stratus_layers_from_heights(context, 3, 1, 1, heights, z, NULL));
  IS_SILENT(stratus_layers_from_thicknesses(NULL, 3, 1, heights, heights, NULL, z, none));
  REFUSES(stratus_layers_from_thicknesses(context, 3, 1, NULL, heights, NULL, z, none));
  REFUSES(stratus_layers_from_thicknesses(context, 3, 1, heights, NULL, NULL, z, none));
  REFUSES(stratus_layers_from_thicknesses(context, 3, 1, heights, heights, NULL, NULL, none));
  REFUSES(stratus_layers_from_thicknesses(context, 3, 1, heights, heights, NULL, z, NULL));
  IS_SILENT(stratus_layers_to_borders(NULL, 3, 1, heights, heights, z));
  REFUSES(stratus_layers_to_borders(context, 3, 1, NULL, heights, z));
  REFUSES(stratus_layers_to_borders(context, 3, 1, heights, NULL, z));
  REFUSES(stratus_layers_to_borders(context, 3, 1, heights, heights, NULL));
  IS_SILENT(stratus_prisms_hide(NULL, &faces, 1, heights, NULL, hidden));
  REFUSES(stratus_prisms_hide(context, NULL, 1, heights, NULL, hidden));
  REFUSES(stratus_prisms_hide(context, &faces, 1, NULL, NULL, hidden));
  REFUSES(stratus_prisms_hide(context, &faces, 1, heights, NULL, NULL));
  IS_SILENT(stratus_prisms_divide(NULL, &faces, 1, NULL, &count, vertices, prisms));
  REFUSES(stratus_prisms_divide(context, NULL, 1, NULL, &count, vertices, prisms));
  REFUSES(stratus_prisms_divide(context, &faces, 1, NULL, NULL, vertices, prisms));
  REFUSES(stratus_prisms_divide(context, &faces, 1, NULL, &count, NULL, prisms));
  REFUSES(stratus_prisms_divide(context, &faces, 1, NULL, &count, vertices, NULL));
  faces.nodes = NULL;
  REFUSES(stratus_faces_turn(context, &faces, degrees, 1));
}

static void meshes(const small_scene* scene)
{
  static const double points[12] = { 0, 0, 0, 4, 0, 0, 0, 4, 0, 0, 0, 4 };
  static const int32_t vertices[4] = { 0, 1, 2, 3 };
  static const float values[4] = { 1e6f, 1e6f, 1e6f, 1000001.0f };
  static float rgba[4 * SMALL_PIXELS];
  const stratus_image image = { .width = SMALL_WIDTH, .height = SMALL_HEIGHT, .rgba = rgba };
  const stratus_transfer* t = &scene->transfer;
  const stratus_camera* camera = &scene->camera;
  stratus_mesh mesh = stratus_mesh_default(), pointless;
  stratus_tetra_caster* c = NULL;
  mesh.points = points;
  mesh.point_count = 4;
  mesh.vertices = vertices;
  mesh.cell_count = 1;
  pointless = mesh;
  pointless.points = NULL;
  IS_SILENT(stratus_mesh_check(NULL, &mesh));
  REFUSES(stratus_mesh_check(context, NULL));
  REFUSES(stratus_mesh_check(context, &pointless));
  orders(&mesh, camera);
  IS_SILENT(stratus_tetra_caster_create(NULL, MAKES(stratus_tetra_caster)));
  REFUSES(stratus_tetra_caster_create(context, NULL));
  ACCEPTS(stratus_tetra_caster_create(context, &c));
  TAKES(stratus_tetra_caster_destroy(NULL));
  TAKES(stratus_tetra_caster_release(NULL));
  REFUSES(stratus_tetra_caster_render(c, &mesh, t, camera, NULL, &image, NULL)); /* a mesh without values */
  mesh.values = values;
  IS_SILENT(stratus_tetra_caster_render(NULL, &mesh, t, camera, NULL, &image, NULL));
  REFUSES(stratus_tetra_caster_render(c, NULL, t, camera, NULL, &image, NULL));
  REFUSES(stratus_tetra_caster_render(c, &mesh, NULL, camera, NULL, &image, NULL));
  REFUSES(stratus_tetra_caster_render(c, &mesh, t, NULL, NULL, &image, NULL));
  REFUSES(stratus_tetra_caster_render(c, &mesh, t, camera, NULL, NULL, NULL));
  ACCEPTS(stratus_tetra_caster_render(c, &mesh, t, camera, NULL, &image, NULL));
  stratus_tetra_caster_destroy(c);
}

static void scenes(void)
{
  stratus_camera camera;
  int32_t* positions = NULL;
  size_t count = 0;
  IS_SILENT(stratus_scene_create(NULL, "cloud", MAKES(stratus_scene)));
  REFUSES(stratus_scene_create(context, NULL, MAKES(stratus_scene)));
  REFUSES(stratus_scene_create(context, "cloud", NULL));
  TAKES(stratus_scene_destroy(context, NULL));
  TAKES(stratus_scene_destroy(NULL, NULL));
  IS_SILENT(stratus_scene_camera(NULL, six, 0, 0, 0, 1, &camera));
  REFUSES(stratus_scene_camera(context, NULL, 0, 0, 0, 1, &camera));
  REFUSES(stratus_scene_camera(context, six, 0, 0, 0, 1, NULL));
  IS_SILENT(stratus_voxel_scene_create(NULL, "17K", three, &positions, &count));
  REFUSES(stratus_voxel_scene_create(context, NULL, three, &positions, &count));
  REFUSES(stratus_voxel_scene_create(context, "17K", NULL, &positions, &count));
  REFUSES(stratus_voxel_scene_create(context, "17K", three, NULL, &count));
  REFUSES(stratus_voxel_scene_create(context, "17K", three, &positions, NULL));
  ACCEPTS(stratus_voxel_scene_create(context, "17K", three, &positions, &count));
  TAKES(stratus_voxel_scene_release(NULL, positions));
  TAKES(stratus_voxel_scene_release(context, NULL));
  stratus_voxel_scene_release(context, positions);
  IS_SILENT(stratus_mesh_scene_create(NULL, "holes", MAKES(stratus_mesh_scene)));
  REFUSES(stratus_mesh_scene_create(context, NULL, MAKES(stratus_mesh_scene)));
  REFUSES(stratus_mesh_scene_create(context, "holes", NULL));
  TAKES(stratus_mesh_scene_destroy(context, NULL));
  TAKES(stratus_mesh_scene_destroy(NULL, NULL));
  assert_true((remember("stratus_mesh_scene_value("), isnan(stratus_mesh_scene_value(NULL, six))));
  assert_true(isnan(stratus_mesh_scene_value("holes", NULL)));
}

/* Functions of the header that take no address. */
static bool takes_an_address(const char* name)
{
  static const char* const ends[] = { "_default", "_name", "_count", "_type_size", "_version" };
  if (strcmp(name, "stratus_device_name") == 0 || strcmp(name, "stratus_octree_count") == 0 || strcmp(name, "stratus_voxels_count") == 0 ||
    strcmp(name, "stratus_occupancy_count") == 0) {
    return true;
  }
  for (size_t i = 0; i < sizeof ends / sizeof *ends; ++i) {
    const size_t length = strlen(name), end = strlen(ends[i]);
    if (length >= end && strcmp(name + length - end, ends[i]) == 0) {
      return false;
    }
  }
  return true;
}

static int check_header(const char* path)
{
  FILE* header = fopen(path, "r");
  char line[1024];
  int functions = 0;
  bool inside = false;
  assert_non_null(header);
  while (fgets(line, sizeof line, header)) {
    inside = inside || strncmp(line, "STRATUS_API", 11) == 0 || strncmp(line, "STRATUS_EXPERIMENTAL", 20) == 0;
    const char* open = inside ? strchr(line, '(') : NULL;
    if (open) {
      const char* name = open;
      bool found = false;
      while (name > line && (name[-1] == '_' || (name[-1] >= 'a' && name[-1] <= 'z'))) {
        --name;
      }
      char text[64];
      snprintf(text, sizeof text, "%.*s", (int)(open - name), name);
      for (int c = 0; c < calls && !found; ++c) {
        found = strcmp(called[c], text) == 0;
      }
      if (!found && takes_an_address(text)) {
        fail_msg("%s is not called with NULL", text);
      }
      ++functions;
      inside = false;
    }
  }
  fclose(header);
  return functions;
}

/* Every header that stratus.h includes. */
static void assert_none_is_left_out(void)
{
  FILE* umbrella = fopen("Core/stratus.h", "r");
  char line[1024];
  int functions = 0;
  assert_non_null(umbrella);
  while (fgets(line, sizeof line, umbrella)) {
    char name[64], path[128];
    if (sscanf(line, "#include \"%63[^\"]\"", name) == 1) {
      snprintf(path, sizeof path, "Core/%s", name);
      functions += check_header(path);
    }
  }
  fclose(umbrella);
  assert_true(functions > 100);
  print_message("             %d calls of %d functions\n", calls, functions);
}

static void no_public_function_falls_over_null(void** state)
{
  (void)state;
  static small_scene scene;
  stratus_context_options options = stratus_context_options_default();
  options.device = "host";
  options.threads = 1;
  assert_int_equal(stratus_context_create(&options, &context, NULL, 0), STRATUS_OK);
  small_scene_fill(&scene);
  assert_int_equal(small_scene_camera(context, &scene), STRATUS_OK);
  nine[0] = nine[4] = nine[8] = 1.0;
  contexts();
  inputs(&scene);
  structures(&scene);
  voxel_sets(&scene);
  ray_casters(&scene);
  clouds();
  color_maps();
  annotations(&scene);
  globes(&scene);
  looks(&scene);
  bricks(&scene.volume);
  path_tracers(&scene);
  frustums(&scene);
  layers();
  meshes(&scene);
  scenes();
  assert_none_is_left_out();
  stratus_context_destroy(context);
}

int test_null(void)
{
  const struct CMUnitTest tests[] = { cmocka_unit_test(no_public_function_falls_over_null) };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
