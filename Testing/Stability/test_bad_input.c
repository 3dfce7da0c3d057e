/* SPDX-License-Identifier: BSD-3-Clause
 * Invalid inputs: each is refused with its value in the message, and the ray caster then draws as before. */
#include "small_scene.h"
#include "testing.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

typedef struct inputs {
  stratus_volume volume;
  stratus_transfer transfer;
  stratus_camera camera;
  stratus_ray_cast_options options;
  stratus_image image;
} inputs;

typedef struct fixture {
  stratus_context* context;
  stratus_ray_caster* caster;
  small_scene scene;
  small_picture right, picture;
  float opaque[SMALL_PIXELS];
  inputs good;
} fixture;

static stratus_status draw(fixture* f, const inputs* in)
{
  return stratus_ray_caster_render(f->caster, &in->volume, &in->transfer, &in->camera, &in->options, &in->image, NULL);
}

static void open_fixture(fixture* f, const char* device)
{
  stratus_context_options options = stratus_context_options_default();
  options.device = device;
  options.threads = 1; /* in hundreds of tiny calls threads would only wait for each other */
  memset(f, 0, sizeof *f);
  assert_int_equal(stratus_context_create(&options, &f->context, NULL, 0), STRATUS_OK);
  assert_int_equal(stratus_ray_caster_create(f->context, &f->caster), STRATUS_OK);
  small_scene_fill(&f->scene);
  assert_int_equal(small_scene_camera(f->context, &f->scene), STRATUS_OK);
  f->good.volume = f->scene.volume;
  f->good.transfer = f->scene.transfer;
  f->good.camera = f->scene.camera;
  f->good.options = stratus_ray_cast_options_default();
  f->good.image = (stratus_image){
    .width = SMALL_WIDTH, .height = SMALL_HEIGHT, .rgba = f->right.rgba, .depth = f->right.depth, .samples = f->right.samples
  };
  assert_int_equal(draw(f, &f->good), STRATUS_OK);
  f->good.image.rgba = f->picture.rgba;
  f->good.image.depth = f->picture.depth;
  f->good.image.samples = f->picture.samples;
}

static void close_fixture(fixture* f)
{
  stratus_ray_caster_destroy(f->caster);
  stratus_context_destroy(f->context);
}

static void assert_refused_as(fixture* f, const inputs* in, stratus_status expected, const char* part, int line)
{
  const stratus_status status = draw(f, in);
  const char* message = stratus_context_message(f->context);
  if (status != expected) {
    fail_msg("line %d: %s instead of %s; message: %s", line, stratus_status_name(status), stratus_status_name(expected), message);
  }
  if (!strstr(message, part)) {
    fail_msg("line %d: \"%s\" does not contain %s", line, message, part);
  }
  memset(&f->picture, 0xff, sizeof f->picture);
  assert_int_equal(draw(f, &f->good), STRATUS_OK);
  assert_memory_equal(&f->picture, &f->right, sizeof f->right);
}

/* Applies `spoil` to a copy `in` of valid inputs, and expects the status and a part of the message. */
#define REFUSED_AS(f, expected, part, spoil)                                                                                               \
  do {                                                                                                                                     \
    inputs in = (f)->good;                                                                                                                 \
    spoil;                                                                                                                                 \
    assert_refused_as((f), &in, (expected), (part), __LINE__);                                                                             \
  } while (0)
#define REFUSED(f, part, spoil) REFUSED_AS(f, STRATUS_INVALID_ARGUMENT, part, spoil)

static void spoilt_volumes_are_refused(void** state)
{
  fixture* f = *state;
  REFUSED(f, "NULL", in.volume.values = NULL);
  REFUSED(f, "99", in.volume.type = (stratus_type)99);
  REFUSED(f, "-7", in.volume.dimensions[0] = -7);
  REFUSED(f, "is 0", in.volume.dimensions[1] = 0);
  REFUSED(f, "-9223372036854775808", in.volume.dimensions[2] = INT64_MIN);
  REFUSED(f, "stride 0", in.volume.value_stride = 0);
  REFUSED(f, "-3", in.volume.value_stride = -3);
  REFUSED(f, "is 0", in.volume.spacing[0] = 0.0);
  REFUSED(f, "-2.5", in.volume.spacing[1] = -2.5);
  REFUSED(f, "nan", in.volume.spacing[2] = NAN);
  REFUSED(f, "inf", in.volume.spacing[2] = INFINITY);
  REFUSED(f, "nan", in.volume.origin[1] = NAN);
  REFUSED(f, "inf", in.volume.matrix[3] = -INFINITY);
  REFUSED(f, "0.5", in.volume.matrix[12] = 0.5);
  REFUSED(f, "singular", memset(in.volume.matrix, 0, 12 * sizeof(double)));
  REFUSED(f, "singular", memset(in.volume.direction, 0, sizeof in.volume.direction));
  REFUSED(f, "inf", in.volume.spacing[0] = 1e308);
}

static void sizes_whose_product_overflows_are_refused(void** state)
{
  fixture* f = *state;
  const int64_t big = (int64_t)1 << 40;
  REFUSED_AS(f, STRATUS_OVERFLOW, "1099511627776", in.volume.dimensions[0] = in.volume.dimensions[1] = in.volume.dimensions[2] = big);
  REFUSED_AS(f, STRATUS_OVERFLOW, "9223372036854775807", in.volume.dimensions[0] = INT64_MAX);
  REFUSED_AS(f, STRATUS_OVERFLOW, "9223372036854775807", in.volume.value_stride = INT64_MAX);
  REFUSED_AS(f, STRATUS_OVERFLOW, "18446744073709551615", in.transfer.opacity_count = SIZE_MAX);
  REFUSED_AS(f, STRATUS_OVERFLOW, "18446744073709551615", in.transfer.color_count = SIZE_MAX);
  REFUSED_AS(f, STRATUS_OVERFLOW, "576460752303423488", in.transfer.opacity_count = SIZE_MAX / 32 + 1); /* the size in bytes overflows */
  REFUSED_AS(
    f, STRATUS_OVERFLOW, "18446744073709551615", (in.transfer.gradient = in.transfer.opacity, in.transfer.gradient_count = SIZE_MAX));
}

/* Lists of items that no array can hold are refused before the first item is read. */
static void counts_beyond_any_array_are_refused(void** state)
{
  fixture* f = *state;
  static const double boxes[12] = { 0 };
  static const stratus_ray ray = { .direction = { 1, 0, 0 } };
  static const int32_t place[3] = { 0 };
  const int64_t n[3] = { 4, 4, 4 };
  const size_t counts[] = { SIZE_MAX, SIZE_MAX / 4, SIZE_MAX / 2 + 2 };
  stratus_octree* octree = NULL;
  stratus_voxels* voxels = NULL;
  stratus_tree* tree = NULL;
  stratus_hit hit;
  uint32_t id = 0;
  assert_int_equal(stratus_octree_create(f->context, NULL, &octree), STRATUS_OK);
  assert_int_equal(stratus_octree_insert(octree, boxes, 1, &id), STRATUS_OK);
  assert_int_equal(stratus_voxels_create_list(f->context, n, place, 1, &voxels), STRATUS_OK);
  assert_int_equal(stratus_tree_create(f->context, voxels, NULL, &tree), STRATUS_OK);
  for (size_t i = 0; i < sizeof counts / sizeof *counts; ++i) {
    const size_t count = counts[i];
    stratus_voxels* none = NULL;
    assert_int_equal(stratus_octree_insert(octree, boxes, count, &id), STRATUS_OVERFLOW);
    assert_int_equal(stratus_octree_insert_oriented(octree, boxes, count, &id), STRATUS_OVERFLOW);
    assert_int_equal(stratus_octree_move(octree, &id, boxes, count), STRATUS_OVERFLOW);
    assert_int_equal(stratus_octree_move_oriented(octree, &id, boxes, count), STRATUS_OVERFLOW);
    assert_int_equal(stratus_octree_remove(octree, &id, count), STRATUS_OVERFLOW);
    assert_int_equal(stratus_voxels_create_list(f->context, n, place, count, &none), STRATUS_OVERFLOW);
    assert_int_equal(stratus_tree_first_hit(f->context, tree, &ray, count, &hit), STRATUS_OVERFLOW);
    assert_int_equal(stratus_voxels_first_hit(f->context, voxels, &ray, count, &hit), STRATUS_OVERFLOW);
    assert_null(none);
  }
  assert_int_equal(stratus_octree_count(octree), 1);
  stratus_tree_destroy(tree);
  stratus_voxels_destroy(voxels);
  stratus_octree_destroy(octree);
}

static void spoilt_transfer_functions_are_refused(void** state)
{
  fixture* f = *state;
  static const double reversed[] = { 1e6 + 3, 0.1, 1e6 + 2, 0.5 };
  static const double unknown[] = { 1e6, 0.1, NAN, 0.5 };
  static const double above[] = { 1e6, 0.1, 1e6 + 1, 1.25 };
  static const double below[] = { 1e6, -0.75, 1e6 + 1, 1.0 };
  static const double no_number[] = { 1e6, NAN };
  static const double infinite[] = { 1e6, 0.1, INFINITY, 0.5 };
  static const double gaudy[] = { 1e6, 0.1, 7.5, 0.9 };
  REFUSED(f, "opacity function has 0 points", in.transfer.opacity_count = 0);
  REFUSED(f, "opacity function has 0 points", in.transfer.opacity = NULL);
  REFUSED(f, "function has 0 points", in.transfer.color_count = 0);
  REFUSED(f, "function has 0 points", in.transfer.color = NULL);
  REFUSED(f, "1e+06", (in.transfer.opacity = reversed, in.transfer.opacity_count = 2));
  REFUSED(f, "nan", (in.transfer.opacity = unknown, in.transfer.opacity_count = 2));
  REFUSED(f, "inf", (in.transfer.opacity = infinite, in.transfer.opacity_count = 2));
  REFUSED(f, "1.25", (in.transfer.opacity = above, in.transfer.opacity_count = 2));
  REFUSED(f, "-0.75", (in.transfer.opacity = below, in.transfer.opacity_count = 2));
  REFUSED(f, "nan", (in.transfer.opacity = no_number, in.transfer.opacity_count = 1));
  REFUSED(f, "7.5", (in.transfer.color = gaudy, in.transfer.color_count = 1));
  REFUSED(f, "unit distance 0", in.transfer.unit_distance = 0.0);
  REFUSED(f, "-4", in.transfer.unit_distance = -4.0);
  REFUSED(f, "nan", in.transfer.unit_distance = NAN);
  REFUSED(f, "inf", in.transfer.unit_distance = INFINITY);
}

static void spoilt_cameras_are_refused(void** state)
{
  fixture* f = *state;
  REFUSED(f, "nan", in.camera.eye[0] = NAN);
  REFUSED(f, "inf", in.camera.eye[2] = INFINITY);
  REFUSED(f, "nan", in.camera.forward[1] = NAN);
  REFUSED(f, "nan", in.camera.right[2] = NAN);
  REFUSED(f, "nan", in.camera.up[0] = NAN);
  REFUSED(f, "forward", memset(in.camera.forward, 0, sizeof in.camera.forward));
  REFUSED(f, "-0.5", in.camera.near_k = -0.5);
  REFUSED(f, "nan", in.camera.near_k = NAN);
  REFUSED(f, "nan", in.camera.far_k = NAN);
  REFUSED(f, "2.5", (in.camera.near_k = 2.5, in.camera.far_k = 1.5));
  REFUSED(f, "3.5", (in.camera.near_k = 3.5, in.camera.far_k = 3.5));
}

static void spoilt_options_are_refused(void** state)
{
  fixture* f = *state;
  REFUSED(f, "99", in.options.skipping.structure = (stratus_structure)99);
  REFUSED(f, "-1", in.options.skipping.structure = (stratus_structure)-1);
  REFUSED(f, "98", in.options.sampling.rule = (stratus_sampling)98);
  REFUSED(f, "97", in.options.sampling.interpolation = (stratus_interpolation)97);
  REFUSED(f, "-1.5", in.options.sampling.distance = -1.5);
  REFUSED(f, "nan", in.options.sampling.distance = NAN);
  REFUSED(f, "inf", in.options.sampling.distance = INFINITY);
  REFUSED(f, "1e-300", in.options.sampling.distance = 1e-300);
  REFUSED(f, "1.75", in.options.sampling.termination = 1.75);
  REFUSED(f, "-0.25", in.options.sampling.termination = -0.25);
  REFUSED(f, "nan", in.options.sampling.termination = NAN);
  REFUSED(f, "-0.001", in.options.sampling.tolerance = -0.001);
  REFUSED(f, "nan", in.options.sampling.tolerance = NAN);
  REFUSED(f, "inf", in.options.sampling.tolerance = INFINITY);
  REFUSED(f, "1e+16", (in.options.light.shade = 1, in.options.light.shading.ambient = 1e16));
  REFUSED(f, "1e+153", (in.options.light.shade = 1, in.options.light.shading.specular_power = 1e153));
  REFUSED(
    f, "1e+308", (in.options.light.shade = in.options.light.shading.light_count = 1, in.options.light.shading.lights[0].color[2] = 1e308));
  REFUSED(f, "-0.5",
    (in.options.light.shade = in.options.light.shading.light_count = in.options.light.shading.lights[0].separate_specular = 1,
      in.options.light.shading.lights[0].vector[0] = 1.0, in.options.light.shading.lights[0].specular_color[1] = -0.5));
  REFUSED(f, "5", in.options.skipping.block_size = 5);
  REFUSED(f, "64", in.options.skipping.block_size = 64);
  REFUSED(f, "-4", in.options.skipping.block_size = -4);
  REFUSED(f, "7", in.options.clipping.clip_plane_count = 7);
  REFUSED(f, "-1", in.options.clipping.clip_plane_count = -1);
  REFUSED(f, "nan", (in.options.clipping.clip_plane_count = 1, in.options.clipping.clip_planes[0][3] = NAN));
  REFUSED(f, "nan", (in.options.clipping.crop = 1, in.options.clipping.crop_bounds[2] = NAN));
  REFUSED(f, "4.5", (in.options.clipping.crop = 1, in.options.clipping.crop_bounds[0] = 4.5, in.options.clipping.crop_bounds[1] = 3.5));
}

static void spoilt_images_are_refused(void** state)
{
  fixture* f = *state;
  REFUSED(f, "0", in.image.width = 0);
  REFUSED(f, "-12", in.image.height = -12);
  REFUSED(f, "65537", in.image.width = 65537);
  REFUSED(f, "2147483647", in.image.height = INT32_MAX);
  REFUSED(f, "NULL", in.image.rgba = NULL);
  for (int i = 0; i < SMALL_PIXELS; ++i) {
    f->opaque[i] = 1.0f;
  }
  /* A window depth says nothing without a far plane. */
  REFUSED(f, "inf", (in.image.opaque_depth = f->opaque, in.camera.far_k = INFINITY));
}

static void null_pointers_are_refused(void** state)
{
  fixture* f = *state;
  const inputs* g = &f->good;
  stratus_context* c = f->context;
  stratus_ray_caster* caster = NULL;
  stratus_value_range* ranges = NULL;
  stratus_occupancy* occupancy = NULL;
  stratus_distance_map* map = NULL;
  double bounds[6];
  const stratus_status bad = STRATUS_INVALID_ARGUMENT;
  assert_int_equal(stratus_ray_caster_render(NULL, &g->volume, &g->transfer, &g->camera, &g->options, &g->image, NULL), bad);
  assert_int_equal(stratus_ray_caster_render(f->caster, NULL, &g->transfer, &g->camera, &g->options, &g->image, NULL), bad);
  assert_int_equal(stratus_ray_caster_render(f->caster, &g->volume, NULL, &g->camera, &g->options, &g->image, NULL), bad);
  assert_int_equal(stratus_ray_caster_render(f->caster, &g->volume, &g->transfer, NULL, &g->options, &g->image, NULL), bad);
  assert_int_equal(stratus_ray_caster_render(f->caster, &g->volume, &g->transfer, &g->camera, &g->options, NULL, NULL), bad);
  assert_int_equal(stratus_ray_caster_render(f->caster, &g->volume, &g->transfer, &g->camera, NULL, &g->image, NULL), STRATUS_OK);
  assert_int_equal(stratus_ray_caster_create(NULL, &caster), bad);
  assert_int_equal(stratus_ray_caster_create(c, NULL), bad);
  assert_int_equal(stratus_value_range_create(NULL, &g->volume, 0, &ranges), bad);
  assert_int_equal(stratus_value_range_create(c, NULL, 0, &ranges), bad);
  assert_int_equal(stratus_value_range_create(c, &g->volume, 0, NULL), bad);
  assert_int_equal(stratus_volume_bounds(c, &g->volume, NULL), bad);
  assert_int_equal(stratus_volume_bounds(NULL, &g->volume, bounds), bad);
  assert_int_equal(stratus_volume_check(c, NULL), bad);
  assert_int_equal(stratus_transfer_check(c, NULL), bad);

  assert_int_equal(stratus_value_range_create(c, &g->volume, 0, &ranges), STRATUS_OK);
  assert_int_equal(stratus_occupancy_create(c, NULL, &g->transfer, STRATUS_SAMPLING_MIDPOINT, &occupancy), bad);
  assert_int_equal(stratus_occupancy_create(c, ranges, NULL, STRATUS_SAMPLING_MIDPOINT, &occupancy), bad);
  assert_int_equal(stratus_occupancy_create(c, ranges, &g->transfer, STRATUS_SAMPLING_MIDPOINT, NULL), bad);
  assert_int_equal(stratus_occupancy_create(c, ranges, &g->transfer, (stratus_sampling)55, &occupancy), bad);
  assert_non_null(strstr(stratus_context_message(c), "55"));
  assert_int_equal(stratus_occupancy_create(c, ranges, &g->transfer, STRATUS_SAMPLING_MIDPOINT, &occupancy), STRATUS_OK);
  assert_int_equal(stratus_distance_map_create(c, NULL, STRATUS_DISTANCE_FULL, &map), bad);
  assert_int_equal(stratus_distance_map_create(c, occupancy, STRATUS_DISTANCE_FULL, NULL), bad);
  assert_int_equal(stratus_distance_map_create(c, occupancy, (stratus_distance_kind)44, &map), bad);
  assert_non_null(strstr(stratus_context_message(c), "44"));
  assert_null(map);
  stratus_occupancy_destroy(occupancy);
  stratus_value_range_destroy(ranges);
  stratus_ray_caster_destroy(NULL);
  stratus_occupancy_destroy(NULL);
  stratus_value_range_destroy(NULL);
  stratus_distance_map_destroy(NULL);
}

static void spoilt_camera_parameters_are_refused(void** state)
{
  fixture* f = *state;
  stratus_context* c = f->context;
  stratus_camera camera;
  const double eye[3] = { 0, 0, 5 }, focal[3] = { 0, 0, 0 }, up[3] = { 0, 1, 0 }, along[3] = { 0, 0, 2 }, unknown[3] = { 0, NAN, 0 };
#define CAMERA_REFUSED(part, call)                                                                                                         \
  do {                                                                                                                                     \
    assert_int_equal((call), STRATUS_INVALID_ARGUMENT);                                                                                    \
    assert_non_null(strstr(stratus_context_message(c), (part)));                                                                           \
  } while (0)
  CAMERA_REFUSED("view_angle 0", stratus_camera_perspective(c, eye, focal, up, 0, 1, &camera));
  CAMERA_REFUSED("180", stratus_camera_perspective(c, eye, focal, up, 180, 1, &camera));
  CAMERA_REFUSED("nan", stratus_camera_perspective(c, eye, focal, up, NAN, 1, &camera));
  CAMERA_REFUSED("-1", stratus_camera_perspective(c, eye, focal, up, 30, -1, &camera));
  CAMERA_REFUSED("inf", stratus_camera_parallel(c, eye, focal, up, 1, INFINITY, &camera));
  CAMERA_REFUSED("-3", stratus_camera_parallel(c, eye, focal, up, -3, 1, &camera));
  CAMERA_REFUSED("1e+300", stratus_camera_parallel(c, eye, focal, up, 1e10, 1e300, &camera));
  CAMERA_REFUSED("differ", stratus_camera_perspective(c, eye, eye, up, 30, 1, &camera));
  CAMERA_REFUSED("parallel", stratus_camera_perspective(c, eye, focal, along, 30, 1, &camera));
  CAMERA_REFUSED("nan", stratus_camera_perspective(c, eye, unknown, up, 30, 1, &camera));
  CAMERA_REFUSED("NULL", stratus_camera_perspective(c, NULL, focal, up, 30, 1, &camera));
  CAMERA_REFUSED("NULL", stratus_camera_perspective(c, eye, focal, up, 30, 1, NULL));
}

/* An empty volume is no error: its picture is empty. */
static void a_volume_without_a_finite_value_gives_an_empty_picture(void** state)
{
  fixture* f = *state;
  static double values[SMALL_VALUES];
  inputs in = f->good;
  for (int q = 0; q < SMALL_VALUES; ++q) {
    values[q] = q % 2 ? NAN : INFINITY;
  }
  in.volume.values = values;
  memset(&f->picture, 0xff, sizeof f->picture);
  assert_int_equal(draw(f, &in), STRATUS_OK);
  for (int p = 0; p < SMALL_PIXELS; ++p) {
    assert_true(f->picture.rgba[4 * p] == 0.0f && f->picture.rgba[4 * p + 3] == 0.0f);
    assert_true(isinf(f->picture.depth[p]));
  }
  stratus_value_range* ranges = NULL;
  double low, high;
  assert_int_equal(stratus_value_range_create(f->context, &in.volume, 0, &ranges), STRATUS_OK);
  assert_int_equal(stratus_value_range_whole(ranges, &low, &high), STRATUS_INVALID_ARGUMENT);
  assert_non_null(strstr(stratus_context_message(f->context), "no finite value"));
  stratus_value_range_destroy(ranges);
  assert_int_equal(draw(f, &f->good), STRATUS_OK);
  assert_memory_equal(&f->picture, &f->right, sizeof f->right);
}

/* Optical depths beyond all floats are opaque, and in no way no numbers: by both sampling rules, lit, of several components, summed up. */
static void lengths_of_the_unit_out_of_all_proportion_draw_numbers(void** state)
{
  fixture* f = *state;
  static const double units[] = { 4.9406564584124654e-324, 1e-310, 1e-300, 1e-100, 1e-45, 1e-30, 1e45, 1e300, 1e308 };
  stratus_transfer pair[2] = { f->good.transfer, f->good.transfer };
  for (size_t u = 0; u < sizeof units / sizeof *units; ++u) {
    for (int what = 0; what < 8; what += few_run() && stratus_context_on_device(f->context) ? 5 : 1) { /* a kernel each */
      inputs in = f->good;
      pair[0].unit_distance = pair[1].unit_distance = units[u];
      in.options.sampling.rule = what % 2 ? STRATUS_SAMPLING_PREINTEGRATED : STRATUS_SAMPLING_MIDPOINT;
      in.options.light.shade = what / 2 == 1;
      in.options.mode = what / 2 == 2 ? STRATUS_MODE_ADDITIVE : STRATUS_MODE_COMPOSITE;
      if (what / 2 == 3) { /* as many values as both components have */
        in.volume.components = 2;
        in.volume.value_stride = 2;
        in.volume.dimensions[0] /= 2;
        in.volume.cell_ghosts = NULL;
      }
      const stratus_status status = stratus_ray_caster_render(f->caster, &in.volume, pair, &in.camera, &in.options, &in.image, NULL);
      if (status != STRATUS_OK) {
        fail_msg("unit %g, picture %d: %s", units[u], what, stratus_context_message(f->context));
      }
      float most = 0.0f;
      for (int p = 0; p < SMALL_PIXELS; ++p) {
        const float* rgba = f->picture.rgba + 4 * p;
        for (int c = 0; c < 4; ++c) {
          if (!(rgba[c] >= 0.0f && rgba[c] <= 1.0f)) {
            fail_msg("unit %g, picture %d: pixel %d has %g", units[u], what, p, (double)rgba[c]);
          }
        }
        most = rgba[3] > most ? rgba[3] : most;
      }
      assert_true(units[u] > 1.0 || most > 0.999f);
    }
  }
}

/* Flat images, lines and points have no thickness to be seen, whatever the length that comes with the missing axis. */
static void flat_volumes_are_drawn_whatever_their_spacing(void** state)
{
  fixture* f = *state;
  static const double spacings[] = { 1e-6, 1e-3, 1.0, 1e3, 1e6, 1e9 };
  for (int flat = 1; flat < 8; ++flat) {
    for (size_t s = 0; s < sizeof spacings / sizeof *spacings; ++s) {
      inputs in = f->good;
      in.volume.cell_ghosts = NULL;
      for (int axis = 0; axis < 3; ++axis) {
        if (flat >> axis & 1) {
          in.volume.dimensions[axis] = 1;
          in.volume.spacing[axis] = spacings[s];
        }
      }
      if (draw(f, &in) != STRATUS_OK) {
        fail_msg("flat %d, spacing %g: %s", flat, spacings[s], stratus_context_message(f->context));
      }
    }
  }
}

#define ON(fixture, test) cmocka_unit_test_prestate(test, fixture)
#define ALL(f)                                                                                                                             \
  ON(f, spoilt_volumes_are_refused), ON(f, sizes_whose_product_overflows_are_refused), ON(f, counts_beyond_any_array_are_refused),         \
    ON(f, spoilt_transfer_functions_are_refused), ON(f, spoilt_cameras_are_refused), ON(f, spoilt_options_are_refused),                    \
    ON(f, spoilt_images_are_refused), ON(f, null_pointers_are_refused), ON(f, spoilt_camera_parameters_are_refused),                       \
    ON(f, a_volume_without_a_finite_value_gives_an_empty_picture), ON(f, lengths_of_the_unit_out_of_all_proportion_draw_numbers),          \
    ON(f, flat_volumes_are_drawn_whatever_their_spacing)

static fixture host, device;

static int open_host(void** state)
{
  (void)state;
  open_fixture(&host, "host");
  return 0;
}

static int close_host(void** state)
{
  (void)state;
  close_fixture(&host);
  return 0;
}

static int open_device(void** state)
{
  (void)state;
  open_fixture(&device, "0");
  return 0;
}

static int close_device(void** state)
{
  (void)state;
  close_fixture(&device);
  return 0;
}

int test_bad_input(void)
{
  const struct CMUnitTest tests[] = { ALL(&host) };
  return cmocka_run_group_tests(tests, open_host, close_host);
}

int test_bad_input_device(void)
{
  const struct CMUnitTest tests[] = { ALL(&device) };
  return stratus_device_count() == 0 ? test_skip("no OpenCL device on this machine")
                                     : cmocka_run_group_tests(tests, open_device, close_device);
}
