/* SPDX-License-Identifier: BSD-3-Clause
 * Pictures of the host's ray caster, compared with the double reference: every scalar type, placement, projection and border.
 *
 * With samples a quarter of a voxel apart, the error of sampling itself leaves more than SMOOTH_DB on a field without jumps. Half a voxel
 * or half a step in the wrong place costs more than 20 dB of it. Where the picture has jumps inside (a hole's border, nearest values), a
 * sample stands for a quarter of a voxel across the jump: JUMP_DB. Measured: 75 to 91 and 49 to 61. */
#define _DEFAULT_SOURCE /* MAP_ANONYMOUS, MAP_NORESERVE */
#include "picture_case.h"

#include <stdbool.h>
#include <sys/mman.h>
#include <unistd.h>

#define SMOOTH_DB 70.0
#define JUMP_DB 47.0

static picture drawn;

static void expect(stratus_context* context, const char* what, picture_case* c, double least_db)
{
  const double db = case_psnr(what, context, c, &drawn);
  assert_true(case_lit(&drawn) > CASE_PIXELS / 20);
  assert_true(db >= least_db);
}

static void every_type_is_interpolated(void** state)
{
  for (int type = STRATUS_INT8; type <= STRATUS_FLOAT64; ++type) {
    picture_case c;
    case_create(*state, &c, (stratus_type)type, 29, 24, 32, 7u + (uint32_t)type);
    expect(*state, case_type_names[type], &c, SMOOTH_DB);
    case_destroy(&c);
  }
}

static void every_type_is_drawn_nearest(void** state)
{
  for (int type = STRATUS_INT8; type <= STRATUS_FLOAT64; ++type) {
    picture_case c;
    case_create(*state, &c, (stratus_type)type, 29, 24, 32, 70u + (uint32_t)type);
    c.options.sampling.interpolation = STRATUS_INTERPOLATION_NEAREST;
    expect(*state, case_type_names[type], &c, JUMP_DB);
    case_destroy(&c);
  }
}

static void values_in_cells_reach_half_a_voxel_further(void** state)
{
  picture_case c;
  case_create(*state, &c, STRATUS_FLOAT32, 24, 25, 26, 3);
  c.volume.cell_centered = 1;
  expect(*state, "cell-centred", &c, SMOOTH_DB);
  c.options.sampling.interpolation = STRATUS_INTERPOLATION_NEAREST;
  expect(*state, "cell-centred, nearest", &c, JUMP_DB);
  case_destroy(&c);
}

static void strided_values_are_found(void** state)
{
  picture_case c;
  case_create(*state, &c, STRATUS_UINT16, 24, 25, 26, 4);
  free(c.values);
  c.values = malloc(24 * 25 * 26 * 3 * sizeof(uint16_t));
  memset(c.values, 0xff, 24 * 25 * 26 * 3 * sizeof(uint16_t));
  c.volume.values = c.values;
  c.volume.value_stride = 3;
  case_fill(&c, 4);
  expect(*state, "stride 3", &c, SMOOTH_DB);
  case_destroy(&c);
}

static void cells_with_a_corner_that_is_not_finite_are_transparent(void** state)
{
  for (int type = STRATUS_FLOAT32; type <= STRATUS_FLOAT64; ++type) {
    picture_case c;
    uint32_t seed = 99;
    case_create(*state, &c, (stratus_type)type, 24, 24, 24, 5);
    const double bad[3] = { (double)NAN, (double)INFINITY, -(double)INFINITY };
    for (int i = 0; i < 60; ++i) {
      case_store(c.values, c.volume.type, case_random(&seed) % (24 * 24 * 24), bad[i % 3]);
    }
    expect(*state, "not finite", &c, JUMP_DB);
    c.options.sampling.interpolation = STRATUS_INTERPOLATION_NEAREST;
    expect(*state, "not finite, nearest", &c, JUMP_DB);
    case_destroy(&c);
  }
}

static void hidden_points_and_cells_are_transparent(void** state)
{
  picture_case c;
  uint32_t seed = 77;
  case_create(*state, &c, STRATUS_UINT8, 24, 25, 26, 6);
  c.point_ghosts = calloc(24 * 25 * 26, 1);
  c.cell_ghosts = calloc(24 * 25 * 26, 1);
  for (int i = 0; i < 40; ++i) {
    c.point_ghosts[case_random(&seed) % (24 * 25 * 26)] = STRATUS_GHOST_HIDDEN_POINT;
    c.cell_ghosts[case_random(&seed) % (23 * 24 * 25)] = STRATUS_GHOST_HIDDEN_CELL;
  }
  c.volume.point_ghosts = c.point_ghosts;
  expect(*state, "hidden points", &c, JUMP_DB);
  c.volume.cell_ghosts = c.cell_ghosts;
  expect(*state, "hidden points and cells", &c, JUMP_DB);
  c.volume.point_ghosts = NULL;
  c.options.sampling.interpolation = STRATUS_INTERPOLATION_NEAREST;
  expect(*state, "hidden cells, nearest", &c, JUMP_DB);
  c.volume.cell_centered = 1;
  expect(*state, "hidden values in cells, nearest", &c, JUMP_DB);
  c.options.sampling.interpolation = STRATUS_INTERPOLATION_LINEAR;
  expect(*state, "hidden values in cells", &c, JUMP_DB);
  case_destroy(&c);
}

static void duplicates_are_interpolated_but_not_drawn(void** state)
{
  picture_case c;
  case_create(*state, &c, STRATUS_FLOAT32, 24, 25, 26, 8);
  c.cell_ghosts = calloc(23 * 24 * 25, 1);
  for (int i = 0; i < 23 * 24 * 25; ++i) {
    c.cell_ghosts[i] = i % 23 >= 15 || i / 23 / 24 < 4 ? STRATUS_GHOST_DUPLICATE : 0;
  }
  c.volume.cell_ghosts = c.cell_ghosts;
  expect(*state, "duplicate cells", &c, JUMP_DB);
  case_destroy(&c);
}

static void projections_and_places_agree(void** state)
{
  picture_case c;
  case_create(*state, &c, STRATUS_FLOAT32, 33, 24, 28, 9);
  case_camera(*state, &c, 5, 1);
  expect(*state, "parallel", &c, SMOOTH_DB);
  const double eye[3] = { 13.2, 11.7, 15.1 }, focal[3] = { 20, 12, 10 }, up[3] = { 0.1, 1, 0 };
  assert_int_equal(stratus_camera_perspective(*state, eye, focal, up, 70.0, 1.2, &c.camera), STRATUS_OK);
  expect(*state, "camera inside", &c, SMOOTH_DB);
  c.camera.near_k = 2.5;
  c.camera.far_k = 9.0;
  expect(*state, "near and far", &c, SMOOTH_DB);
  assert_int_equal(stratus_camera_parallel(*state, eye, focal, up, 9.0, 1.2, &c.camera), STRATUS_OK);
  expect(*state, "parallel from inside", &c, SMOOTH_DB);
  c.camera.near_k = -20.0;
  expect(*state, "parallel from behind the plane", &c, SMOOTH_DB);
  const double along[3] = { 16, 12, 60 }, center[3] = { 16, 12, 14 };
  assert_int_equal(stratus_camera_perspective(*state, along, center, up, 40.0, 1.2, &c.camera), STRATUS_OK);
  expect(*state, "along an axis", &c, SMOOTH_DB);
  case_destroy(&c);
}

static void far_origins_and_tiny_spacings_lose_nothing(void** state)
{
  picture_case c;
  case_create(*state, &c, STRATUS_FLOAT32, 24, 24, 24, 10);
  const double utm[3] = { 432100.25, 6e6, 1234.5 };
  memcpy(c.volume.origin, utm, sizeof utm);
  case_camera(*state, &c, 1, 0);
  expect(*state, "UTM origin", &c, SMOOTH_DB);
  memset(c.volume.origin, 0, sizeof c.volume.origin);
  for (int a = 0; a < 3; ++a) {
    c.volume.spacing[a] = 1e-6;
  }
  c.options.sampling.distance = 0.25e-6;
  c.transfer.unit_distance = 1e-6;
  case_camera(*state, &c, 2, 0);
  expect(*state, "spacing of a millionth", &c, SMOOTH_DB);
  case_destroy(&c);
}

/* All that shows at all is opaque then, and infinite depths would make colours NaN. */
static void tiny_units_of_length_stay_finite(void** state)
{
  static const double units[] = { 1e-20, 1e-30, 1e-100, 1e-300 };
  static const stratus_sampling rules[] = { STRATUS_SAMPLING_MIDPOINT, STRATUS_SAMPLING_PREINTEGRATED, STRATUS_SAMPLING_CELLS };
  picture_case c;
  case_create(*state, &c, STRATUS_FLOAT32, 24, 24, 24, 10);
  case_camera(*state, &c, 2, 0);
  for (size_t i = 0; i < sizeof units / sizeof *units * 3; ++i) {
    static picture p;
    int opaque = 0;
    c.transfer.unit_distance = units[i / 3];
    c.options.sampling.rule = rules[i % 3];
    case_render(*state, &c, &p);
    for (size_t at = 0; at < 4 * CASE_PIXELS; ++at) {
      assert_true(p.rgba[at] >= 0.0f && p.rgba[at] <= 1.0f);
      opaque += at % 4 == 3 && p.rgba[at] == 1.0f;
    }
    assert_true(opaque > 100);
  }
  case_destroy(&c);
}

static void the_volumes_own_matrix_counts(void** state)
{
  picture_case c;
  case_create(*state, &c, STRATUS_INT16, 24, 30, 20, 11);
  const double spacing[3] = { 1.0, 0.8, 1.7 };
  const double direction[9] = { 0.6, -0.8, 0, 0.8, 0.6, 0, 0, 0, 1 };
  const double matrix[16] = { -1.2, 0.1, 0, 5, 0, 0.9, 0.3, -7, 0.2, 0, 1.4, 100, 0, 0, 0, 1 }; /* mirrors, shears, scales */
  memcpy(c.volume.spacing, spacing, sizeof spacing);
  memcpy(c.volume.direction, direction, sizeof direction);
  case_camera(*state, &c, 3, 0);
  expect(*state, "rotated", &c, SMOOTH_DB);
  memcpy(c.volume.matrix, matrix, sizeof matrix);
  case_camera(*state, &c, 3, 0);
  expect(*state, "mirrored and sheared", &c, SMOOTH_DB);
  case_destroy(&c);
}

static void crop_planes_and_opaque_geometry_end_rays(void** state)
{
  picture_case c;
  float* opaque = malloc(CASE_PIXELS * sizeof *opaque);
  case_create(*state, &c, STRATUS_FLOAT32, 30, 30, 30, 12);
  const double crop[6] = { 3.3, 22.1, -5, 25.6, 4.2, 90 };
  const double planes[2][4] = { { 0.7, 0.2, -0.4, -4.0 }, { 0, -1, -0.3, 24.0 } };
  c.options.clipping.crop = 1;
  memcpy(c.options.clipping.crop_bounds, crop, sizeof crop);
  expect(*state, "crop", &c, SMOOTH_DB);
  c.options.clipping.clip_plane_count = 2;
  memcpy(c.options.clipping.clip_planes, planes, sizeof planes);
  expect(*state, "crop and planes", &c, SMOOTH_DB);
  c.options.clipping.crop = 0;
  expect(*state, "planes", &c, SMOOTH_DB);
  c.options.clipping.clip_plane_count = 0;
  for (int parallel = 0; parallel < 2; ++parallel) {
    case_camera(*state, &c, 4, parallel);
    c.camera.near_k = 50.0;
    c.camera.far_k = 200.0;
    for (int i = 0; i < CASE_PIXELS; ++i) { /* a slanted wall; bare background in the corner */
      const double k = 80.0 + 0.4 * (i % CASE_WIDTH) + 0.3 * (double)(i / CASE_WIDTH);
      opaque[i] = (float)(parallel ? (k - 50.0) / 150.0 : 200.0 * (k - 50.0) / (k * 150.0));
      opaque[i] = i % CASE_WIDTH > 40 ? 1.0f : opaque[i];
    }
    c.opaque_depth = opaque;
    expect(*state, parallel ? "opaque geometry, parallel" : "opaque geometry", &c, SMOOTH_DB);
  }
  free(opaque);
  case_destroy(&c);
}

static void a_single_layer_has_no_thickness_but_a_layer_of_cells_has(void** state)
{
  picture_case c;
  case_create(*state, &c, STRATUS_FLOAT32, 1, 24, 24, 13);
  case_camera(*state, &c, 0, 0);
  case_render(*state, &c, &drawn);
  assert_int_equal(case_lit(&drawn), 0);
  c.volume.cell_centered = 1;
  case_camera(*state, &c, 1, 0);
  expect(*state, "one layer of cells", &c, SMOOTH_DB);
  case_destroy(&c);
}

/* A peak a tenth of the field's step over a voxel wide: the case that pre-integration is made for. */
static void preintegration_keeps_narrow_peaks(void** state)
{
  picture_case c;
  case_create(*state, &c, STRATUS_FLOAT32, 30, 30, 30, 14);
  const double peak[8] = { -20.4, 0, -20.1, 0.9, -19.8, 0, -10, 0 };
  memcpy(c.opacity, peak, sizeof peak);
  c.options.sampling.distance = 0.5;
  c.options.sampling.rule = STRATUS_SAMPLING_PREINTEGRATED;
  expect(*state, "peak, pre-integrated", &c, 40.0);
  const double preintegrated = case_psnr("peak, pre-integrated", *state, &c, &drawn);
  c.options.sampling.rule = STRATUS_SAMPLING_MIDPOINT;
  const double midpoint = case_psnr("peak, midpoint", *state, &c, &drawn);
  assert_true(preintegrated > midpoint);
  case_destroy(&c);
}

/* 8 GiB of zeros but for one cube behind index 2^32: no page is touched but by reading. */
static void indices_beyond_32_bits_do_not_overflow(void** state)
{
  const int64_t n = 2048, side = 16, at = 2030;
  const long free_pages = sysconf(_SC_AVPHYS_PAGES);
  uint8_t* values = mmap(NULL, (size_t)(n * n * n), PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (values == MAP_FAILED || (double)free_pages * (double)sysconf(_SC_PAGESIZE) < 2e9) {
    print_message("SKIPPED: 2048^3 needs 8 GiB of address space and 2 GB of free memory\n");
    skip();
  }
  picture_case c;
  case_create(*state, &c, STRATUS_UINT8, side, side, side, 15);
  const double opacity[8] = { 0, 0, 140, 0, 200, 0.12, 255, 0.4 };
  memcpy(c.opacity, opacity, sizeof opacity);
  uint8_t* small = c.values;
  for (int64_t i = 0; i < side * side * side; ++i) {
    const int64_t x = i % side, y = i / side % side, z = i / side / side;
    const bool border = x == 0 || y == 0 || z == 0 || x == side - 1 || y == side - 1 || z == side - 1;
    small[i] = border ? 0 : small[i];
    values[((at + z) * n + at + y) * n + at + x] = small[i];
  }
  for (int a = 0; a < 3; ++a) {
    c.volume.origin[a] = (double)at;
  }
  case_camera(*state, &c, 0, 0);
  static float reference[4 * CASE_PIXELS_MOST];
  const reference_scene scene = case_scene(&c);
  double db = 0.0;
  assert_int_equal(reference_converged(&scene, CASE_WIDTH, CASE_HEIGHT, 70.0, reference, NULL, &db), 0);
  for (int a = 0; a < 3; ++a) {
    c.volume.origin[a] = 0.0;
    c.volume.dimensions[a] = n;
  }
  c.volume.values = values;
  c.options.skipping.block_size = 32;
  for (int structure = STRATUS_STRUCTURE_NONE; structure <= STRATUS_STRUCTURE_HYBRID; ++structure) {
    c.options.skipping.structure = (stratus_structure)structure;
    case_render(*state, &c, &drawn);
    assert_true(case_lit(&drawn) > CASE_PIXELS / 20);
    db = reference_psnr(drawn.rgba, reference, CASE_PIXELS);
    print_message("             2048^3, %s: %.1f dB\n", stratus_structure_name(c.options.skipping.structure), db);
    assert_true(db >= SMOOTH_DB - 10.0); /* the cube's own faces are steep */
  }
  munmap(values, (size_t)(n * n * n));
  case_destroy(&c);
}

static void depth_is_where_the_picture_begins(void** state)
{
  picture_case c;
  static float rgba[4 * CASE_PIXELS_MOST];
  static float depth[CASE_PIXELS_MOST];
  case_create(*state, &c, STRATUS_FLOAT32, 24, 24, 24, 16);
  for (int parallel = 0; parallel < 2; ++parallel) {
    case_camera(*state, &c, 6, parallel);
    const reference_scene scene = case_scene(&c);
    case_render(*state, &c, &drawn);
    assert_int_equal(reference_render(&scene, CASE_WIDTH, CASE_HEIGHT, 1.0 / 64.0, rgba, depth), 0);
    int compared = 0;
    int late = 0;
    for (int i = 0; i < CASE_PIXELS; ++i) {
      assert_int_equal(isfinite(drawn.depth[i]), drawn.rgba[4 * i + 3] > 0.0f);
      if (isfinite(drawn.depth[i])) {
        /* Never before the first opacity by more than the segment that holds it. A ray that only grazes it between two samples sees it
         * later. */
        assert_true(drawn.depth[i] >= depth[i] - 0.26f);
        late += drawn.depth[i] > depth[i] + 0.5f;
        ++compared;
      }
    }
    assert_true(compared > CASE_PIXELS / 20);
    assert_true(late < compared / 20);
  }
  case_destroy(&c);
}

int test_ray_cast(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(every_type_is_interpolated),
    cmocka_unit_test(every_type_is_drawn_nearest),
    cmocka_unit_test(values_in_cells_reach_half_a_voxel_further),
    cmocka_unit_test(strided_values_are_found),
    cmocka_unit_test(cells_with_a_corner_that_is_not_finite_are_transparent),
    cmocka_unit_test(hidden_points_and_cells_are_transparent),
    cmocka_unit_test(duplicates_are_interpolated_but_not_drawn),
    cmocka_unit_test(projections_and_places_agree),
    cmocka_unit_test(far_origins_and_tiny_spacings_lose_nothing),
    cmocka_unit_test(tiny_units_of_length_stay_finite),
    cmocka_unit_test(the_volumes_own_matrix_counts),
    cmocka_unit_test(crop_planes_and_opaque_geometry_end_rays),
    cmocka_unit_test(a_single_layer_has_no_thickness_but_a_layer_of_cells_has),
    cmocka_unit_test(preintegration_keeps_narrow_peaks),
    cmocka_unit_test(depth_is_where_the_picture_begins),
  };
  return cmocka_run_group_tests(tests, case_set_up, case_tear_down);
}

int test_ray_cast_beyond_32_bits(void)
{
  const struct CMUnitTest tests[] = { cmocka_unit_test(indices_beyond_32_bits_do_not_overflow) };
  return cmocka_run_group_tests(tests, case_set_up, case_tear_down);
}
