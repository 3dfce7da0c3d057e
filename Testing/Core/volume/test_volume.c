/* SPDX-License-Identifier: BSD-3-Clause
 * The view of a volume: the position of its voxels, the meaning of its ghosts, and invalid volumes. */
#define _DEFAULT_SOURCE
#include "stratus.h"

#include "structures.h"

#include <sys/mman.h>
#include <unistd.h>

static stratus_volume cube_of(const void* values, int64_t n)
{
  stratus_volume v = stratus_volume_default();
  v.values = values;
  v.dimensions[0] = v.dimensions[1] = v.dimensions[2] = n;
  return v;
}

/* A volume with a turn about z, one about x, uneven spacing, and a matrix that mirrors, shears and moves. */
static stratus_volume skewed(const void* values)
{
  stratus_volume v = cube_of(values, 3);
  const double c = cos(0.3), s = sin(0.3), matrix[16] = { -2, 0.5, 0, 7, 0, 3, 0, -1, 0.25, 0, 1, 2, 0, 0, 0, 1 };
  const double direction[9] = { c, -s, 0, s, c, 0, 0, 0, 1 };
  memcpy(v.matrix, matrix, sizeof matrix);
  memcpy(v.direction, direction, sizeof direction);
  for (int a = 0; a < 3; ++a) {
    v.origin[a] = 10.0 * (a + 1);
    v.spacing[a] = 0.5 * (a + 1);
  }
  return v;
}

static void voxels_lie_where_direction_and_matrix_put_them(void** state)
{
  (void)state;
  const float values[27] = { 0 };
  for (int cells = 0; cells < 2; ++cells) {
    stratus_volume v = skewed(values);
    v.cell_centered = cells;
    double m[16], world[3];
    stratus_volume_index_to_world(&v, m);
    const double index[3] = { 2, -1, 5 };
    stratus_matrix_point(m, index, world);
    double scaled[3], local[4] = { 0, 0, 0, 1 };
    for (int a = 0; a < 3; ++a) {
      scaled[a] = v.spacing[a] * (index[a] + (cells ? 0.5 : 0.0));
    }
    for (int r = 0; r < 3; ++r) {
      local[r] = v.origin[r] + v.direction[3 * r] * scaled[0] + v.direction[3 * r + 1] * scaled[1] + v.direction[3 * r + 2] * scaled[2];
    }
    for (int r = 0; r < 3; ++r) {
      double expected = 0.0;
      for (int i = 0; i < 4; ++i) {
        expected += v.matrix[4 * r + i] * local[i];
      }
      assert_true(fabs(world[r] - expected) < 1e-12); /* a few ULP of numbers up to 150 */
    }
  }
}

static void the_inverse_leads_back(void** state)
{
  (void)state;
  const float values[27] = { 0 };
  stratus_volume v = skewed(values);
  for (int tiny = 0; tiny < 2; ++tiny) {
    double m[16], inverse[16], world[3], back[3];
    for (int a = 0; a < 3; ++a) {
      v.spacing[a] *= tiny ? 1e-120 : 1.0; /* whose cube underflows */
      v.origin[a] = tiny ? 0.0 : v.origin[a];
    }
    if (tiny) {
      v.matrix[3] = v.matrix[7] = v.matrix[11] = 0.0;
    }
    stratus_volume_index_to_world(&v, m);
    assert_true(stratus_matrix_invert_affine(m, inverse));
    const double index[3] = { 1.25, 0.5, 1.75 };
    stratus_matrix_point(m, index, world);
    stratus_matrix_point(inverse, world, back);
    for (int a = 0; a < 3; ++a) {
      assert_true(fabs(back[a] - index[a]) < 1e-12); /* positions near 100 of spacing 1, an ULP of 1.4e-14, times a condition of 10 */
    }
  }
  const double flat[16] = { 1, 1, 0, 0, 2, 2, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1 }, none[16] = { 0 };
  double unused[16];
  assert_false(stratus_matrix_invert_affine(flat, unused));
  assert_false(stratus_matrix_invert_affine(none, unused));
}

static void bounds_hold_points_and_whole_cells(void** state)
{
  (void)state;
  const float values[24] = { 0 };
  stratus_context* context = make_context("host", 1);
  stratus_volume v = stratus_volume_default();
  v.values = values;
  v.dimensions[0] = 4;
  v.dimensions[1] = 3;
  v.dimensions[2] = 2;
  for (int a = 0; a < 3; ++a) {
    v.origin[a] = 1.0;
    v.spacing[a] = 2.0;
  }
  double b[6];
  assert_int_equal(stratus_volume_bounds(context, &v, b), STRATUS_OK);
  assert_memory_equal(b, ((const double[]){ 1, 7, 1, 5, 1, 3 }), sizeof b);
  v.cell_centered = 1;
  assert_int_equal(stratus_volume_bounds(context, &v, b), STRATUS_OK);
  assert_memory_equal(b, ((const double[]){ 1, 9, 1, 7, 1, 5 }), sizeof b);
  /* A mirror along x and a quarter turn in the direction: x' = -(-y), y' = x. */
  const double turn[9] = { 0, -1, 0, 1, 0, 0, 0, 0, 1 };
  memcpy(v.direction, turn, sizeof turn);
  v.matrix[0] = -1.0;
  assert_int_equal(stratus_volume_bounds(context, &v, b), STRATUS_OK);
  assert_memory_equal(b, ((const double[]){ -1, 5, 1, 9, 1, 5 }), sizeof b);
  assert_int_equal(stratus_volume_bounds(context, &v, NULL), STRATUS_INVALID_ARGUMENT);
  assert_int_equal(stratus_volume_bounds(context, NULL, b), STRATUS_INVALID_ARGUMENT);
  stratus_context_destroy(context);
}

static void every_type_is_fetched_as_it_is(void** state)
{
  (void)state;
  stratus_volume v = stratus_volume_default();
  v.dimensions[0] = 3;
  v.value_stride = 2;
#define CHECK(TYPE, tag, a, b)                                                                                                             \
  do {                                                                                                                                     \
    const TYPE values[] = { a, 0, b, 0, a, 0 };                                                                                            \
    v.values = values;                                                                                                                     \
    v.type = tag;                                                                                                                          \
    const double bias = stratus_volume_bias(&v);                                                                                           \
    const double least = fabs((double)(b)) < fabs((double)(a)) ? (double)(b) : (double)(a);                                                \
    assert_true(bias == (stratus_type_is_wide(tag) ? least : 0.0));                                                                        \
    assert_true(stratus_volume_fetch(&v, bias, 0) == (float)((double)(a)-bias));                                                           \
    assert_true(stratus_volume_fetch(&v, bias, 1) == (float)((double)(b)-bias));                                                           \
    assert_int_equal(stratus_type_size(tag), sizeof(TYPE));                                                                                \
  } while (0)
  CHECK(int8_t, STRATUS_INT8, -128, 127);
  CHECK(uint8_t, STRATUS_UINT8, 0, 255);
  CHECK(int16_t, STRATUS_INT16, -32768, 32767);
  CHECK(uint16_t, STRATUS_UINT16, 1, 65535);
  CHECK(int32_t, STRATUS_INT32, INT32_MIN, INT32_MAX);
  CHECK(uint32_t, STRATUS_UINT32, 5u, UINT32_MAX);
  CHECK(int64_t, STRATUS_INT64, INT64_C(1) << 50, (INT64_C(1) << 50) + 1);
  CHECK(uint64_t, STRATUS_UINT64, UINT64_C(1) << 52, (UINT64_C(1) << 52) + 3);
  CHECK(float, STRATUS_FLOAT32, 1.5f, -2.25f);
  CHECK(double, STRATUS_FLOAT64, 6e6, 6e6 + 1e-5);
#undef CHECK
  assert_int_equal(stratus_type_size((stratus_type)10), 0);
  /* a fill value in front must not swallow the digits of the rest */
  const double gaps[3] = { NAN, 9.97e36, 4.0 };
  v.values = gaps;
  v.value_stride = 1;
  assert_true(stratus_volume_bias(&v) == 4.0);
  v.dimensions[0] = 1;
  assert_true(stratus_volume_bias(&v) == 0.0);
}

static void hidden_points_hide_every_cell_they_touch(void** state)
{
  uint32_t random = 3;
  (void)state;
  stratus_context* context = make_context("host", 2);
  for (int repeat = 0; repeat < 60; ++repeat) {
    sample_volume t =
      make_volume(STRATUS_UINT8, 1 + random_below(&random, 6), 1 + random_below(&random, 6), 1 + random_below(&random, 6), 1, &random);
    add_ghosts(&t, repeat & 1, 1 + random_below(&random, 20), &random);
    const int64_t* p = t.view.dimensions;
    int64_t n[3], c[3];
    uint8_t* hidden = NULL;
    bool any = false;
    for (int a = 0; a < 3; ++a) {
      n[a] = t.view.cell_centered || p[a] == 1 ? p[a] : p[a] - 1;
    }
    assert_int_equal(stratus_volume_hidden_cells(context, &t.view, &hidden), STRATUS_OK);
    for (c[2] = 0; c[2] < n[2]; ++c[2]) {
      for (c[1] = 0; c[1] < n[1]; ++c[1]) {
        for (c[0] = 0; c[0] < n[0]; ++c[0]) {
          const int64_t cell = (c[2] * n[1] + c[1]) * n[0] + c[0];
          bool expected = t.cell_ghosts[cell] & STRATUS_GHOST_HIDDEN_CELL;
          for (int corner = 0; corner < 8 && !t.view.cell_centered; ++corner) {
            const int64_t x = c[0] + (corner & 1), y = c[1] + (corner >> 1 & 1), z = c[2] + (corner >> 2);
            expected |= x < p[0] && y < p[1] && z < p[2] && t.point_ghosts[(z * p[1] + y) * p[0] + x] & STRATUS_GHOST_HIDDEN_POINT;
          }
          assert_int_equal(hidden ? hidden[cell] : 0, expected);
          any |= expected;
        }
      }
    }
    assert_true(any || !hidden);
    stratus_release(context, hidden);
    free_volume(&t);
  }
  stratus_context_destroy(context);
}

static void the_owned_box_leaves_out_another_pieces_cells(void** state)
{
  (void)state;
  uint8_t values[5 * 4 * 3] = { 0 }, cells[4 * 3 * 2] = { 0 }, points[5 * 4 * 3] = { 0 };
  stratus_volume v = stratus_volume_default();
  int64_t lo[3], hi[3];
  v.values = values;
  v.type = STRATUS_UINT8;
  v.dimensions[0] = 5;
  v.dimensions[1] = 4;
  v.dimensions[2] = 3;
  assert_true(stratus_volume_owned(&v, lo, hi));
  assert_memory_equal(lo, ((const int64_t[]){ 0, 0, 0 }), sizeof lo);
  assert_memory_equal(hi, ((const int64_t[]){ 4, 3, 2 }), sizeof hi);
  v.cell_ghosts = cells;
  for (int c = 0; c < 4 * 3 * 2; ++c) {
    cells[c] = c % 4 < 1 || c / 12 == 1 ? STRATUS_GHOST_DUPLICATE : 0;
  }
  assert_false(stratus_volume_owned(&v, lo, hi));
  assert_memory_equal(lo, ((const int64_t[]){ 1, 0, 0 }), sizeof lo);
  assert_memory_equal(hi, ((const int64_t[]){ 4, 3, 1 }), sizeof hi);
  memset(cells, STRATUS_GHOST_DUPLICATE, sizeof cells);
  assert_false(stratus_volume_owned(&v, lo, hi));
  assert_memory_equal(lo, ((const int64_t[]){ 0, 0, 0 }), sizeof lo);
  assert_memory_equal(hi, ((const int64_t[]){ 0, 0, 0 }), sizeof hi);
  /* Only points: the first two layers along x belong to another block, the layer between them and ours is shared. */
  v.cell_ghosts = NULL;
  v.point_ghosts = points;
  for (int p = 0; p < 60; ++p) {
    points[p] = p % 5 < 2 ? STRATUS_GHOST_DUPLICATE : 0;
  }
  assert_false(stratus_volume_owned(&v, lo, hi));
  assert_memory_equal(lo, ((const int64_t[]){ 1, 0, 0 }), sizeof lo);
  assert_memory_equal(hi, ((const int64_t[]){ 4, 3, 2 }), sizeof hi);
}

static void the_default_is_a_unit_grid(void** state)
{
  (void)state;
  const float value = 0;
  stratus_context* context = make_context("host", 1);
  stratus_volume v = stratus_volume_default();
  double m[16];
  assert_int_equal(stratus_volume_check(context, &v), STRATUS_INVALID_ARGUMENT);
  v.values = &value;
  assert_int_equal(stratus_volume_check(context, &v), STRATUS_OK);
  stratus_volume_index_to_world(&v, m);
  for (int i = 0; i < 16; ++i) {
    assert_true(m[i] == (i % 5 == 0 ? 1.0 : 0.0));
  }
  stratus_context_destroy(context);
}

static void refuse(stratus_context* context, const stratus_volume* v, stratus_status status, const char* why)
{
  assert_int_equal(stratus_volume_check(context, v), status);
  if (!strstr(stratus_context_message(context), why)) {
    fail_msg("\"%s\" does not contain \"%s\"", stratus_context_message(context), why);
  }
}

static void sizes_that_overflow_are_refused_and_large_ones_are_not(void** state)
{
  (void)state;
  const double value = 0;
  stratus_context* context = make_context("host", 1);
  stratus_volume v = cube_of(&value, 2048);
  v.type = STRATUS_FLOAT64;
  assert_int_equal(stratus_volume_check(context, &v), STRATUS_OK); /* 64 GiB: only looked at */
  v = cube_of(&value, INT64_C(1) << 22);
  refuse(context, &v, STRATUS_OVERFLOW, "4194304");
  v = cube_of(&value, INT64_C(1) << 20);
  v.type = STRATUS_FLOAT64;
  refuse(context, &v, STRATUS_OVERFLOW, "9223372036854775808 bytes");
  v.dimensions[2] = 1 << 20;
  v.dimensions[1] = 1;
  v.value_stride = INT64_MAX;
  refuse(context, &v, STRATUS_OVERFLOW, "stride");
  v.value_stride = 1;
  v.dimensions[0] = INT64_MAX;
  refuse(context, &v, STRATUS_OVERFLOW, "9223372036854775807");
  stratus_context_destroy(context);
}

static void what_is_no_volume_is_refused_with_the_value(void** state)
{
  (void)state;
  const float values[27] = { 0 };
  stratus_context* context = make_context("host", 1);
  const stratus_volume good = cube_of(values, 3);
  static const double spacings[] = { 0.0, -1.0, NAN, INFINITY };
  stratus_volume v = good;
  assert_int_equal(stratus_volume_check(NULL, &v), STRATUS_INVALID_ARGUMENT);
  refuse(context, NULL, STRATUS_INVALID_ARGUMENT, "NULL");
  v.values = NULL;
  refuse(context, &v, STRATUS_INVALID_ARGUMENT, "values is NULL");
  v = good;
  v.type = (stratus_type)10;
  refuse(context, &v, STRATUS_INVALID_ARGUMENT, "10");
  for (int a = 0; a < 3; ++a) {
    v = good;
    v.dimensions[a] = 0;
    refuse(context, &v, STRATUS_INVALID_ARGUMENT, "0, must be at least 1");
    v.dimensions[a] = -7;
    refuse(context, &v, STRATUS_INVALID_ARGUMENT, "-7");
    for (size_t s = 0; s < sizeof spacings / sizeof *spacings; ++s) {
      v = good;
      v.spacing[a] = spacings[s];
      refuse(context, &v, STRATUS_INVALID_ARGUMENT, "spacing");
    }
    v = good;
    v.origin[a] = NAN;
    refuse(context, &v, STRATUS_INVALID_ARGUMENT, "origin");
    v = good;
    v.direction[4 * a] = 0.0;
    refuse(context, &v, STRATUS_INVALID_ARGUMENT, "direction is singular");
    v.direction[4 * a] = NAN;
    refuse(context, &v, STRATUS_INVALID_ARGUMENT, "direction");
    v = good;
    v.matrix[5 * a] = 0.0;
    refuse(context, &v, STRATUS_INVALID_ARGUMENT, "matrix is singular");
    v.matrix[5 * a] = INFINITY;
    refuse(context, &v, STRATUS_INVALID_ARGUMENT, "matrix");
  }
  v = good;
  v.value_stride = 0;
  refuse(context, &v, STRATUS_INVALID_ARGUMENT, "value_stride 0");
  v = good;
  v.matrix[12] = 0.5;
  refuse(context, &v, STRATUS_INVALID_ARGUMENT, "affine");
  v = good;
  v.spacing[0] = 1e308;
  refuse(context, &v, STRATUS_INVALID_ARGUMENT, "bounds");
  stratus_context_destroy(context);
}

/* Allocates `bytes` bytes that end at a page which cannot be read. */
static void* guarded(size_t bytes, void** whole, size_t* size)
{
  const size_t page = (size_t)sysconf(_SC_PAGESIZE);
  *size = (bytes + page - 1) / page * page + page;
  *whole = mmap(NULL, *size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  assert_true(*whole != MAP_FAILED);
  char* wall = (char*)*whole + *size - page;
  assert_int_equal(mprotect(wall, page, PROT_NONE), 0);
  return wall - bytes;
}

static void read_everything(stratus_context* context, stratus_ray_caster* caster, const stratus_volume* v)
{
  static const double opacity[] = { 0, 0, 40, 0.5 }, color[] = { 0, 1, 1, 1 };
  float rgba[4 * 8 * 8];
  const stratus_image image = { .width = 8, .height = 8, .rgba = rgba };
  const double eye[3] = { 20, 14, 9 }, focal[3] = { 1, 1, 1 }, up[3] = { 0, 0, 1 };
  stratus_transfer transfer = stratus_transfer_default();
  stratus_camera camera;
  stratus_voxels* voxels = NULL;
  const stratus_criterion all = stratus_criterion_default();
  transfer.opacity = opacity;
  transfer.opacity_count = 2;
  transfer.color = color;
  transfer.color_count = 1;
  assert_int_equal(stratus_camera_perspective(context, eye, focal, up, 30, 1, &camera), STRATUS_OK);
  for (int setting = 0; setting < 12; ++setting) {
    stratus_ray_cast_options options = stratus_ray_cast_options_default();
    options.skipping.structure = (stratus_structure)(setting % 6);
    options.sampling.interpolation = (stratus_interpolation)(setting / 6);
    assert_int_equal(stratus_ray_caster_render(caster, v, &transfer, &camera, &options, &image, NULL), STRATUS_OK);
    options.mode = STRATUS_MODE_FIRST_HIT;
    assert_int_equal(stratus_ray_caster_render(caster, v, &transfer, &camera, &options, &image, NULL), STRATUS_OK);
  }
  stratus_ray_caster_release(caster);
  assert_int_equal(stratus_voxels_create(context, v, &all, &voxels), STRATUS_OK);
  stratus_voxels_destroy(voxels);
  assert_int_equal(stratus_voxels_create_cells(context, v, &all, &voxels), STRATUS_OK);
  stratus_voxels_destroy(voxels);
}

/* Arrays have just as many values and flags as the header says. Flat images have the cells that VTK gives them. */
static void nothing_behind_values_and_flags_is_read(void** state)
{
  (void)state;
  static const int64_t lengths[] = { 1, 2, 6 };
  static const stratus_type types[] = { STRATUS_UINT8, STRATUS_INT16, STRATUS_FLOAT32, STRATUS_INT64 };
  stratus_context* context = make_context("host", 1);
  stratus_ray_caster* caster = NULL;
  assert_int_equal(stratus_ray_caster_create(context, &caster), STRATUS_OK);
  for (int shape = 0; shape < 27 * 2 * 4; ++shape) {
    stratus_volume v = stratus_volume_default();
    size_t points = 1, cells = 1, sizes[3];
    void *wholes[3], *buffers[3];
    v.type = types[shape / 54];
    v.cell_centered = shape / 27 % 2;
    for (int a = 0, digit = shape % 27; a < 3; ++a, digit /= 3) {
      const int64_t n = lengths[digit % 3];
      v.dimensions[a] = n;
      points *= (size_t)n;
      cells *= (size_t)(v.cell_centered || n == 1 ? n : n - 1);
    }
    const size_t bytes[3] = { points * stratus_type_size(v.type), points, cells };
    for (int b = 0; b < 3; ++b) {
      buffers[b] = guarded(bytes[b], &wholes[b], &sizes[b]);
      memset(buffers[b], b == 0 ? 30 : 0, bytes[b]);
    }
    ((uint8_t*)buffers[1])[points - 1] = STRATUS_GHOST_HIDDEN_POINT; /* the last ones, so that all have been looked at */
    ((uint8_t*)buffers[2])[cells - 1] = STRATUS_GHOST_HIDDEN_CELL;
    v.values = buffers[0];
    read_everything(context, caster, &v);
    v.point_ghosts = buffers[1];
    v.cell_ghosts = buffers[2];
    read_everything(context, caster, &v);
    uint8_t* hidden = NULL;
    assert_int_equal(stratus_volume_hidden_cells(context, &v, &hidden), STRATUS_OK);
    assert_non_null(hidden);
    assert_int_equal(hidden[cells - 1], 1);
    stratus_release(context, hidden);
    for (int b = 0; b < 3; ++b) {
      munmap(wholes[b], sizes[b]);
    }
  }
  stratus_ray_caster_destroy(caster);
  stratus_context_destroy(context);
}

int test_volume(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(voxels_lie_where_direction_and_matrix_put_them),
    cmocka_unit_test(the_inverse_leads_back),
    cmocka_unit_test(bounds_hold_points_and_whole_cells),
    cmocka_unit_test(every_type_is_fetched_as_it_is),
    cmocka_unit_test(hidden_points_hide_every_cell_they_touch),
    cmocka_unit_test(the_owned_box_leaves_out_another_pieces_cells),
    cmocka_unit_test(nothing_behind_values_and_flags_is_read),
    cmocka_unit_test(the_default_is_a_unit_grid),
    cmocka_unit_test(sizes_that_overflow_are_refused_and_large_ones_are_not),
    cmocka_unit_test(what_is_no_volume_is_refused_with_the_value),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
