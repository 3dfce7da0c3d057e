/* SPDX-License-Identifier: BSD-3-Clause
 * The voxel sets of record and their rays are those that figures were measured on, to the last voxel. The checksums come from the
 * definitions that first made the sets. */
#include "stratus.h"

#include "structures.h"

#define RAYS (512 * 512)

/* FNV-1a. */
static uint64_t checksum(const void* memory, size_t bytes, uint64_t sum)
{
  for (size_t i = 0; i < bytes; ++i) {
    sum = (sum ^ ((const uint8_t*)memory)[i]) * UINT64_C(0x100000001b3);
  }
  return sum;
}

#define CHECKSUM_START UINT64_C(0xcbf29ce484222325)

/* Checksum of origins and directions as floats, which define a ray of record. */
static uint64_t rays_checksum(stratus_context* context, const stratus_voxels* voxels, int kind)
{
  stratus_ray* rays = malloc(RAYS * sizeof *rays);
  uint64_t sum = CHECKSUM_START;
  assert_non_null(rays);
  assert_int_equal(stratus_voxel_scene_rays(context, voxels, kind, rays), STRATUS_OK);
  for (int r = 0; r < RAYS; ++r) {
    float numbers[6];
    for (int a = 0; a < 3; ++a) {
      numbers[a] = (float)rays[r].origin[a];
      numbers[3 + a] = (float)rays[r].direction[a];
      assert_true((double)numbers[a] == rays[r].origin[a] && (double)numbers[3 + a] == rays[r].direction[a]);
    }
    assert_true(rays[r].t_min == 0.0 && isinf(rays[r].t_max));
    if (kind == 1) {
      assert_false(stratus_voxels_get(voxels, (int64_t)rays[r].origin[0], (int64_t)rays[r].origin[1], (int64_t)rays[r].origin[2]));
    }
    sum = checksum(numbers, sizeof numbers, sum);
  }
  free(rays);
  return sum;
}

/* Standard deviation of the densities of blocks of 8^3 that hold any voxel, over .5. */
static double deviation(const int64_t n[3], const int32_t* positions, size_t count)
{
  const int64_t bx = n[0] / 8, by = n[1] / 8, bz = n[2] / 8;
  int* voxels = calloc((size_t)(bx * by * bz), sizeof *voxels);
  double sum = 0.0, squares = 0.0;
  int64_t blocks = 0;
  assert_non_null(voxels);
  for (size_t v = 0; v < count; ++v) {
    voxels[(positions[3 * v + 2] / 8 * by + positions[3 * v + 1] / 8) * bx + positions[3 * v] / 8]++;
  }
  for (int64_t b = 0; b < bx * by * bz; ++b) {
    sum += voxels[b] / 512.0;
    squares += voxels[b] / 512.0 * (voxels[b] / 512.0);
    blocks += voxels[b] > 0;
  }
  free(voxels);
  return 2.0 * sqrt(squares / (double)blocks - sum / (double)blocks * (sum / (double)blocks));
}

static const struct {
  const char* name;
  int64_t n[3];
  size_t count;
  uint64_t positions, primary, random;
  double deviation; /* 0: not checked */
} record[] = {
  { "17K", { 256, 128, 256 }, 17000, 0x7d95887fdedc93dd, 0x9dbcc1d4b849e02a, 0x8260171a994eb9bf, 0 },
  { "24K", { 256, 128, 256 }, 24000, 0x2cfaa0171c603faf, 0x9dbcc1d4b849e02a, 0xb4d0ebc794ed201e, 0 },
  { "30K", { 256, 128, 256 }, 30000, 0x5a81c0b2f9119561, 0x9dbcc1d4b849e02a, 0x67b98344d7a1ebdf, 0 },
  { "35K", { 256, 128, 256 }, 35000, 0xf207b7eff6d15dc8, 0x9dbcc1d4b849e02a, 0xe3dff6549026092c, 0 },
  { "u225", { 256, 128, 256 }, 20000, 0x22502f7109cb1294, 0x9dbcc1d4b849e02a, 0x6ebece3408d55c5d, .225 },
  { "u367", { 256, 128, 256 }, 20000, 0xc702f08eeaa9e791, 0x9dbcc1d4b849e02a, 0x07463aef3954f9c5, .367 },
  { "u571", { 256, 128, 256 }, 20000, 0xde5f17c597cc44d1, 0x9dbcc1d4b849e02a, 0x3281bbe8ee9cf2f9, .571 },
  { "u640", { 256, 128, 256 }, 20000, 0x3d8cbad086cd0dd6, 0x9dbcc1d4b849e02a, 0xc0361f624e2763ed, .640 },
  { "1M", { 512, 512, 512 }, 1000000, 0xd4075acee557c9c0, 0x49d8465b3347819a, 0x41128fa56ba3d14d, 0 },
  { "10M", { 1024, 1024, 1024 }, 10000000, 0xb6ba32707207c571, 0xc96c830c87e637f2, 0xeb9da98e5f7474da, 0 },
  { "archipelago", { 4096, 4096, 4096 }, 4216282, 0x5f29338eb3283cf2, 0xf5af743e068107ea, 0x480158ddb45a5cbf, 0 },
  { "islets", { 4096, 4096, 4096 }, 408529, 0x99fc8e39a3bca8a4, 0xf5af743e068107ea, 0x10f9a954df559648, 0 },
};

static void sets_and_rays_are_those_of_record(void** state)
{
  (void)state;
  stratus_context* context = make_context("host", 2);
  assert_int_equal(stratus_voxel_scene_count(), sizeof record / sizeof *record);
  for (size_t s = 0; s < sizeof record / sizeof *record; ++s) {
    int64_t n[3];
    int32_t* positions = NULL;
    size_t count = 0;
    stratus_voxels* voxels = NULL;
    assert_string_equal(stratus_voxel_scene_name((int)s), record[s].name);
    assert_int_equal(stratus_voxel_scene_create(context, record[s].name, n, &positions, &count), STRATUS_OK);
    assert_memory_equal(n, record[s].n, sizeof n);
    assert_int_equal(count, record[s].count);
    assert_true(checksum(positions, 3 * count * sizeof *positions, CHECKSUM_START) == record[s].positions);
    if (record[s].deviation > 0.0) { /* one voxel moves it by less than .0005 */
      assert_float_equal(deviation(n, positions, count), record[s].deviation, .0005);
    }
    assert_int_equal(stratus_voxels_create_list(context, n, positions, count, &voxels), STRATUS_OK);
    assert_int_equal(stratus_voxels_count(voxels), count);
    assert_true(rays_checksum(context, voxels, 0) == record[s].primary);
    assert_true(rays_checksum(context, voxels, 1) == record[s].random);
    stratus_voxels_destroy(voxels);
    stratus_voxel_scene_release(context, positions);
  }
  stratus_context_destroy(context);
}

static void unknown_names_and_kinds_are_refused(void** state)
{
  static const int64_t n[3] = { 1, 1, 1 };
  static const int32_t position[3] = { 0, 0, 0 };
  int64_t dimensions[3];
  int32_t* positions = NULL;
  size_t count = 0;
  stratus_ray ray;
  stratus_voxels* voxels = NULL;
  (void)state;
  stratus_context* context = make_context("host", 1);
  assert_null(stratus_voxel_scene_name(-1));
  assert_null(stratus_voxel_scene_name(stratus_voxel_scene_count()));
  assert_int_equal(stratus_voxel_scene_create(context, "18K", dimensions, &positions, &count), STRATUS_INVALID_ARGUMENT);
  assert_non_null(strstr(stratus_context_message(context), "18K"));
  assert_non_null(strstr(stratus_context_message(context), "17K, 24K"));
  assert_int_equal(stratus_voxel_scene_create(context, NULL, dimensions, &positions, &count), STRATUS_INVALID_ARGUMENT);
  assert_int_equal(stratus_voxel_scene_create(context, "17K", dimensions, NULL, &count), STRATUS_INVALID_ARGUMENT);
  assert_int_equal(stratus_voxel_scene_create(NULL, "17K", dimensions, &positions, &count), STRATUS_INVALID_ARGUMENT);
  assert_null(positions);
  assert_int_equal(stratus_voxels_create_list(context, n, position, 1, &voxels), STRATUS_OK);
  assert_int_equal(stratus_voxel_scene_rays(context, voxels, 2, &ray), STRATUS_INVALID_ARGUMENT);
  assert_int_equal(stratus_voxel_scene_rays(context, voxels, 1, &ray), STRATUS_INVALID_ARGUMENT); /* nowhere empty to begin in */
  assert_non_null(strstr(stratus_context_message(context), "empty"));
  assert_int_equal(stratus_voxel_scene_rays(context, NULL, 0, &ray), STRATUS_INVALID_ARGUMENT);
  stratus_voxels_destroy(voxels);
  stratus_context_destroy(context);
}

int test_voxel_scenes(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(sets_and_rays_are_those_of_record),
    cmocka_unit_test(unknown_names_and_kinds_are_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
