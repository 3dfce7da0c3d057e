/* SPDX-License-Identifier: BSD-3-Clause
 * The scenes of record are those that figures were measured on. */
#include "stratus.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <string.h>

#include <cmocka.h>

static stratus_context* open_context(int threads)
{
  stratus_context* context = NULL;
  stratus_context_options options = stratus_context_options_default();
  options.device = "host";
  options.threads = threads;
  assert_int_equal(stratus_context_create(&options, &context, NULL, 0), STRATUS_OK);
  return context;
}

static stratus_scene* make(stratus_context* context, const char* name)
{
  stratus_scene* scene = NULL;
  assert_int_equal(stratus_scene_create(context, name, &scene), STRATUS_OK);
  assert_non_null(scene);
  assert_string_equal(scene->name, name);
  return scene;
}

static int64_t values(const stratus_scene* scene)
{
  return scene->volume.dimensions[0] * scene->volume.dimensions[1] * scene->volume.dimensions[2];
}

static uint64_t hash(const stratus_scene* scene)
{
  const unsigned char* bytes = scene->volume.values;
  const int64_t size = values(scene) * (int64_t)stratus_type_size(scene->volume.type);
  uint64_t h = 0xcbf29ce484222325u;
  for (int64_t i = 0; i < size; ++i) {
    h = (h ^ bytes[i]) * 0x100000001b3u;
  }
  return h;
}

/* Checks the figures of record: size, type, occupied voxels, and the mean to as many digits as are published. */
static void assert_figures(
  const char* name, int64_t nx, int64_t ny, int64_t nz, stratus_type type, int64_t occupied, double mean, double unit)
{
  stratus_context* context = open_context(2);
  stratus_scene* scene = make(context, name);
  const stratus_volume* volume = &scene->volume;
  assert_int_equal(volume->dimensions[0], nx);
  assert_int_equal(volume->dimensions[1], ny);
  assert_int_equal(volume->dimensions[2], nz);
  assert_int_equal(volume->type, type);
  assert_int_equal(stratus_volume_check(context, volume), STRATUS_OK);
  assert_int_equal(stratus_transfer_check(context, &scene->transfer), STRATUS_OK);
  assert_int_equal(stratus_transfer_check(context, &scene->edited), STRATUS_OK);

  int64_t count = 0;
  double sum = 0.0;
  for (int64_t q = 0; q < values(scene); ++q) {
    const double value = type == STRATUS_UINT8 ? ((const uint8_t*)volume->values)[q]
      : type == STRATUS_UINT16                 ? ((const uint16_t*)volume->values)[q]
                                               : (double)((const float*)volume->values)[q];
    count += value > 0.0;
    sum += value;
  }
  assert_int_equal(count, occupied);
  assert_true(fabs(sum / (double)values(scene) - mean) <= .5 * unit);
  assert_true(fabs(scene->mean - mean) <= .5 * unit);
  assert_int_equal((int64_t)llround(scene->occupied * (double)values(scene)), occupied);
  stratus_scene_destroy(context, scene);
  stratus_context_destroy(context);
}

static void cloud_has_the_figures_of_record(void** state)
{
  (void)state;
  assert_figures("cloud", 256, 128, 256, STRATUS_FLOAT32, 251659, .0047676, 1e-7);
}

/* Its levels stretch 16:1, of which the last is 207.7 high. */
static void cumulus_has_the_figures_of_record(void** state)
{
  (void)state;
  stratus_context* context = open_context(2);
  stratus_scene* scene = NULL;
  assert_int_equal(stratus_scene_create(context, "cumulus-rectilinear", &scene), STRATUS_OK);
  assert_int_equal(stratus_volume_check(context, &scene->volume), STRATUS_OK);
  const double* z = scene->volume.coordinates[2];
  assert_true(z[0] == 0.0 && z[1] == 0.4 && fabs((z[95] - z[94]) / (z[1] - z[0]) - pow(1.03, 94)) < 1e-9);
  assert_true(fabs(z[95] - 0.4 * (pow(1.03, 95) - 1.0) / 0.03) < 1e-9);
  stratus_scene_destroy(context, scene);
  stratus_context_destroy(context);
  assert_figures("cumulus-rectilinear", 256, 256, 96, STRATUS_FLOAT32, 314573, .0097367, 1e-7);
}

static void plume_has_the_figures_of_record(void** state)
{
  (void)state;
  assert_figures("plume", 512, 512, 256, STRATUS_UINT8, 671089, .504719, 1e-6);
}

static void fog_has_the_figures_of_record(void** state)
{
  (void)state;
  assert_figures("fog", 256, 256, 256, STRATUS_FLOAT32, 13421772, .2227117, 1e-7);
}

static void voxel_is_one_voxel_at_its_place(void** state)
{
  (void)state;
  assert_figures("voxel", 256, 256, 256, STRATUS_UINT8, 1, 255.0 / (256.0 * 256.0 * 256.0), 1e-12);
  stratus_context* context = open_context(1);
  stratus_scene* scene = make(context, "voxel");
  assert_int_equal(((const uint8_t*)scene->volume.values)[((int64_t)131 * 256 + 120) * 256 + 140], 255);
  stratus_scene_destroy(context, scene);
  stratus_context_destroy(context);
}

/* The fog needs no function of the C library, so that its bits are the same on every machine and one hash checks every voxel. Haze and peak
 * have the same field, at any number of threads. */
static void fog_haze_and_peak_are_one_field_to_the_last_bit(void** state)
{
  (void)state;
  static const char* names[] = { "fog", "haze", "peak" };
  for (int i = 0; i < 3; ++i) {
    stratus_context* context = open_context(i + 1);
    stratus_scene* scene = make(context, names[i]);
    assert_int_equal(hash(scene), 0xb04f0357b65e510eu);
    stratus_scene_destroy(context, scene);
    stratus_context_destroy(context);
  }
}

/* A head, stripes, solids in fog and labels need no function of the C library but the square root, which is rounded correctly. */
static void bone_to_labels_have_the_figures_of_record_and_their_bits(void** state)
{
  (void)state;
  assert_figures("bone", 256, 256, 256, STRATUS_UINT16, 9881550, 203.346105, 1e-6);
  assert_figures("skin", 256, 256, 256, STRATUS_UINT16, 9881550, 203.346105, 1e-6);
  assert_figures("stripes", 256, 256, 256, STRATUS_FLOAT32, 16777215, .490922981, 1e-9);
  assert_figures("shell", 256, 256, 256, STRATUS_FLOAT32, 15943891, .200320314, 1e-9);
  assert_figures("plate", 256, 256, 256, STRATUS_FLOAT32, 15938355, .190433428, 1e-9);
  assert_figures("labels", 192, 192, 192, STRATUS_UINT8, 2058299, 1.6502776, 1e-7);
  static const struct {
    const char* name;
    uint64_t hash;
  } bits[] = { { "bone", 0xe9b7355f3fd1bd5eu }, { "skin", 0xe9b7355f3fd1bd5eu }, { "stripes", 0x8597b5345ae652c2u },
    { "shell", 0x5b264dd2aecb19c3u }, { "plate", 0xe5a30de5c433fafau }, { "labels", 0x64f726ce0c26f375u } };
  for (int i = 0; i < 6; ++i) {
    stratus_context* context = open_context(1 + i % 3);
    stratus_scene* scene = make(context, bits[i].name);
    assert_int_equal(hash(scene), bits[i].hash);
    stratus_scene_destroy(context, scene);
    stratus_context_destroy(context);
  }
}

/* Counts the blocks of 4^3 cells, their far faces included, in which a value exceeds a limit. */
static int64_t blocks_above(const stratus_scene* scene, float limit)
{
  const int64_t n = scene->volume.dimensions[0], side = (n + 3) / 4;
  const float* all = scene->volume.values;
  int64_t count = 0;
  for (int64_t b = 0; b < side * side * side; ++b) {
    const int64_t at[3] = { b % side * 4, b / side % side * 4, b / side / side * 4 };
    bool above = false;
    for (int64_t c = 0; c < 125; ++c) {
      const int64_t i = at[0] + c % 5, j = at[1] + c / 5 % 5, k = at[2] + c / 25;
      above = above || (i < n && j < n && k < n && all[(k * n + j) * n + i] > limit);
    }
    count += above;
  }
  return count;
}

static void plate_takes_a_thousandth_of_the_blocks_and_fog_most_of_the_rest(void** state)
{
  (void)state;
  stratus_context* context = open_context(2);
  stratus_scene* scene = make(context, "plate");
  const double share = (double)blocks_above(scene, .7f) / (64.0 * 64.0 * 64.0);
  assert_true(share > .0008 && share < .0012);
  assert_true(fabs(scene->occupied - .95) < .001);
  stratus_scene_destroy(context, scene);
  stratus_context_destroy(context);
}

/* Returns how many pairs of neighbouring points have the same value but another opacity or colour. */
static int vertical_steps(const double* points, size_t count, size_t width)
{
  int steps = 0;
  for (size_t i = 1; i < count; ++i) {
    const double *a = points + (i - 1) * width, *b = points + i * width;
    steps += a[0] == b[0] && memcmp(a + 1, b + 1, (width - 1) * sizeof *a) != 0;
  }
  return steps;
}

static void functions_of_skin_stripes_and_labels_jump(void** state)
{
  (void)state;
  static const struct {
    const char* name;
    int opacity, color;
  } jumps[] = { { "bone", 0, 0 }, { "skin", 2, 0 }, { "stripes", 0, 19 }, { "labels", 10, 10 } };
  stratus_context* context = open_context(2);
  for (int i = 0; i < 4; ++i) {
    stratus_scene* scene = make(context, jumps[i].name);
    assert_int_equal(vertical_steps(scene->transfer.opacity, scene->transfer.opacity_count, 2), jumps[i].opacity);
    assert_int_equal(vertical_steps(scene->transfer.color, scene->transfer.color_count, 4), jumps[i].color);
    assert_int_equal(vertical_steps(scene->edited.opacity, scene->edited.opacity_count, 2) > 0, jumps[i].opacity > 0);
    stratus_scene_destroy(context, scene);
  }
  stratus_context_destroy(context);
}

static void assert_points(const double* points, size_t count, size_t width, const double* expected, size_t expected_count)
{
  assert_int_equal(count, expected_count);
  for (size_t i = 0; i < count * width; ++i) {
    assert_true(fabs(points[i] - expected[i]) <= 1e-15 * fabs(expected[i]));
  }
}

static void transfer_functions_are_those_of_record(void** state)
{
  (void)state;
  static const double voxel[] = { 0, 0, 255, .9 };
  static const double edited[] = { 0, 0, .15 * 255, 0, .6 * 255, .72, 255, .45 };
  static const double color[] = { 0, .35, .45, .75, 127.5, .85, .9, .95, 255, 1, .95, .85 };
  static const double edited_color[] = { 0, .7, .3, .2, 127.5, .95, .8, .4, 255, 1, 1, .9 };
  static const double peak[] = { 0, 0, .40, 0, .41, .9, .42, 0, 1, 0 };
  static const double edited_peak[] = { 0, 0, .50, 0, .51, .9, .52, 0, 1, 0 };
  stratus_context* context = open_context(2);
  stratus_scene* scene = make(context, "voxel");
  assert_points(scene->transfer.opacity, scene->transfer.opacity_count, 2, voxel, 2);
  assert_points(scene->edited.opacity, scene->edited.opacity_count, 2, edited, 4);
  assert_points(scene->transfer.color, scene->transfer.color_count, 4, color, 3);
  assert_points(scene->edited.color, scene->edited.color_count, 4, edited_color, 3);
  assert_true(scene->transfer.unit_distance == 1.0 && scene->edited.unit_distance == 1.0);
  stratus_scene_destroy(context, scene);

  scene = make(context, "peak");
  assert_points(scene->transfer.opacity, scene->transfer.opacity_count, 2, peak, 5);
  assert_points(scene->edited.opacity, scene->edited.opacity_count, 2, edited_peak, 5);
  stratus_scene_destroy(context, scene);

  static const struct {
    const char* name;
    double most;
    int up_axis;
  } thin[] = { { "fog", .03, 1 }, { "haze", .003, 1 }, { "cloud", .6, 1 } };
  for (int i = 0; i < 3; ++i) {
    scene = make(context, thin[i].name);
    assert_true(scene->transfer.opacity_count == 2 && scene->transfer.opacity[3] == thin[i].most);
    assert_int_equal(scene->up_axis, thin[i].up_axis);
    stratus_scene_destroy(context, scene);
  }
  stratus_context_destroy(context);
}

static void plume2_is_the_plume_in_two_parts(void** state)
{
  (void)state;
  stratus_context* context = open_context(2);
  stratus_scene* plume = make(context, "plume");
  stratus_scene* two = make(context, "plume2");
  assert_int_equal(two->volume.components, 2);
  assert_int_equal(two->volume.value_stride, 2);
  assert_int_equal(stratus_volume_check(context, &two->volume), STRATUS_OK);
  assert_ptr_not_equal(two->transfers[0].color, two->transfers[1].color);
  const uint8_t* whole = plume->volume.values;
  const uint8_t* parts = two->volume.values;
  int64_t wrong = 0, begin = 0, end = 0;
  for (int64_t q = 0; q < values(plume); ++q) {
    const int apart = (int)parts[2 * q] + (int)parts[2 * q + 1] - (int)whole[q];
    wrong += apart < -1 || apart > 1;
    begin += q % 512 < 60 ? (int)parts[2 * q] - (int)parts[2 * q + 1] : 0;
    end += q % 512 > 450 ? (int)parts[2 * q + 1] - (int)parts[2 * q] : 0;
  }
  assert_int_equal(wrong, 0);
  assert_true(begin > 0 && end > 0); /* the first part is at the source, the second at the plume's end */
  stratus_scene_destroy(context, plume);
  stratus_scene_destroy(context, two);
  stratus_context_destroy(context);
}

static void names_are_listed_and_an_unknown_one_is_refused(void** state)
{
  (void)state;
  stratus_context* context = open_context(1);
  stratus_scene* scene = NULL;
  assert_int_equal(stratus_scene_count(), 15);
  assert_null(stratus_scene_name(-1));
  assert_null(stratus_scene_name(15));
  assert_int_equal(stratus_scene_create(context, "clowd", &scene), STRATUS_INVALID_ARGUMENT);
  assert_null(scene);
  assert_non_null(strstr(stratus_context_message(context), "clowd"));
  for (int i = 0; i < stratus_scene_count(); ++i) {
    assert_non_null(strstr(stratus_context_message(context), stratus_scene_name(i)));
  }
  assert_int_equal(stratus_scene_create(context, NULL, &scene), STRATUS_INVALID_ARGUMENT);
  assert_int_equal(stratus_scene_create(context, "voxel", NULL), STRATUS_INVALID_ARGUMENT);
  assert_int_equal(stratus_scene_create(NULL, "voxel", &scene), STRATUS_INVALID_ARGUMENT);
  stratus_scene_destroy(context, NULL);
  stratus_context_destroy(context);
}

/* The camera's eye is R / sin 15 degrees from the centre, 25 degrees above the plane, and turns by 45 degrees a view. */
static void cameras_stand_where_the_record_says(void** state)
{
  (void)state;
  stratus_context* context = open_context(1);
  const double bounds[6] = { -1, 3, 10, 16, 0, 12 };
  const double centre[3] = { 1, 13, 6 };
  const double degree = acos(-1.0) / 180.0;
  const double radius = 7.0; /* half of sqrt(4^2 + 6^2 + 12^2) */
  for (int u = 0; u < 3; ++u) {
    for (int view = 0; view < 8; ++view) {
      for (int parallel = 0; parallel < 2; ++parallel) {
        stratus_camera camera;
        double offset[3], length = 0.0;
        assert_int_equal(stratus_scene_camera(context, bounds, u, view, parallel, 2.0, &camera), STRATUS_OK);
        for (int a = 0; a < 3; ++a) {
          offset[a] = camera.eye[a] - centre[a];
          length += offset[a] * offset[a];
        }
        length = sqrt(length);
        assert_true(fabs(length - radius / sin(15 * degree)) < 1e-12 * length);
        assert_true(fabs(offset[u] / length - sin(25 * degree)) < 1e-12);
        const double azimuth = atan2(offset[(u + 2) % 3], offset[(u + 1) % 3]) / degree;
        assert_true(fabs(remainder(azimuth - 30 - 45 * view, 360)) < 1e-10);
        double up = 0.0, right = 0.0, ahead = 0.0;
        for (int a = 0; a < 3; ++a) {
          up += camera.up[a] * camera.up[a];
          right += camera.right[a] * camera.right[a];
          ahead -= camera.forward[a] * offset[a] / length;
        }
        const double half = parallel ? .72 * radius : tan(10.8 * degree);
        assert_true(fabs(sqrt(up) - half) < 1e-12 * half && fabs(sqrt(right) - 2 * half) < 2e-12 * half);
        assert_true(fabs(ahead - 1) < 1e-12);
        assert_true(camera.up[u] > 0 && camera.parallel == parallel);
      }
    }
  }
  stratus_context_destroy(context);
}

static void wrong_cameras_are_refused_by_their_value(void** state)
{
  (void)state;
  stratus_context* context = open_context(1);
  const double bounds[6] = { 0, 1, 0, 1, 0, 1 };
  const double point[6] = { 2, 2, 2, 2, 2, 2 };
  const double reversed[6] = { 0, 1, 5, 4, 0, 1 };
  const double unknown[6] = { 0, 1, 0, 1, NAN, 1 };
  stratus_camera camera;
#define REFUSED(call, part)                                                                                                                \
  do {                                                                                                                                     \
    assert_int_equal((call), STRATUS_INVALID_ARGUMENT);                                                                                    \
    assert_non_null(strstr(stratus_context_message(context), (part)));                                                                     \
  } while (0)
  REFUSED(stratus_scene_camera(context, bounds, 3, 0, 0, 1, &camera), "3");
  REFUSED(stratus_scene_camera(context, bounds, -1, 0, 0, 1, &camera), "-1");
  REFUSED(stratus_scene_camera(context, bounds, 1, 8, 0, 1, &camera), "8");
  REFUSED(stratus_scene_camera(context, point, 1, 0, 0, 1, &camera), "diagonal");
  REFUSED(stratus_scene_camera(context, reversed, 1, 0, 0, 1, &camera), "5..4");
  REFUSED(stratus_scene_camera(context, unknown, 1, 0, 0, 1, &camera), "nan");
  REFUSED(stratus_scene_camera(context, bounds, 1, 0, 0, -2, &camera), "-2");
  REFUSED(stratus_scene_camera(context, NULL, 1, 0, 0, 1, &camera), "NULL");
  assert_int_equal(stratus_scene_camera(NULL, bounds, 1, 0, 0, 1, &camera), STRATUS_INVALID_ARGUMENT);
  stratus_context_destroy(context);
}

int test_scenes(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(cloud_has_the_figures_of_record),
    cmocka_unit_test(cumulus_has_the_figures_of_record),
    cmocka_unit_test(plume_has_the_figures_of_record),
    cmocka_unit_test(fog_has_the_figures_of_record),
    cmocka_unit_test(voxel_is_one_voxel_at_its_place),
    cmocka_unit_test(fog_haze_and_peak_are_one_field_to_the_last_bit),
    cmocka_unit_test(bone_to_labels_have_the_figures_of_record_and_their_bits),
    cmocka_unit_test(plate_takes_a_thousandth_of_the_blocks_and_fog_most_of_the_rest),
    cmocka_unit_test(functions_of_skin_stripes_and_labels_jump),
    cmocka_unit_test(transfer_functions_are_those_of_record),
    cmocka_unit_test(plume2_is_the_plume_in_two_parts),
    cmocka_unit_test(names_are_listed_and_an_unknown_one_is_refused),
    cmocka_unit_test(cameras_stand_where_the_record_says),
    cmocka_unit_test(wrong_cameras_are_refused_by_their_value),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
