/* SPDX-License-Identifier: BSD-3-Clause
 * Numbers of rays against the double-precision reference, which cuts rays at all planes and integrates each part by Gauss, and against
 * fields whose numbers are known in closed form. */
#include "picture_case.h"
#include "reference_modes.h"
#include "testing.h"

#include "stratus/quantities.h"
#include "stratus/tetrahedra.h"

#define REL 2e-5 /* of an integral or a length, by its largest on any ray; measured: 4e-6 */

static picture drawn;
static float expected[4 * CASE_PIXELS_MOST], expected_depth[CASE_PIXELS_MOST];
static float numbers[STRATUS_QUANTITY_COUNT][CASE_PIXELS_MOST], others[STRATUS_QUANTITY_COUNT][CASE_PIXELS_MOST];

static stratus_quantities want_all(float of[STRATUS_QUANTITY_COUNT][CASE_PIXELS_MOST])
{
  stratus_quantities wanted = stratus_quantities_default();
  wanted.width = CASE_WIDTH;
  wanted.height = CASE_HEIGHT;
  for (int q = 0; q < STRATUS_QUANTITY_COUNT; ++q) {
    wanted.of[q] = of[q];
  }
  return wanted;
}

static void compute(
  stratus_context* context, const stratus_ray_cast_input* inputs, int count, const stratus_camera* camera, const stratus_quantities* wanted)
{
  const stratus_status status = stratus_ray_caster_render_quantities(inputs, count, camera, wanted);
  if (status != STRATUS_OK) {
    print_error("quantities: %s: %s\n", stratus_status_name(status), stratus_context_message(context));
  }
  assert_int_equal(status, STRATUS_OK);
}

/* ---- against the reference */

/* Compares the numbers with the reference's. A ray along a plane or the rim may pass a cell more or less. */
static void expect_reference(stratus_context* context, picture_case* c, const char* what)
{
  double largest[4] = { 0.0 }, off[4] = { 0.0 }, depth_off = 0.0;
  int rims = 0, lit = 0, counts = 0;
  c->options.mode = STRATUS_MODE_QUANTITIES;
  c->options.skipping.audit = 1;
  case_render(context, c, &drawn);
  assert_int_equal(drawn.report.differing_pixels, 0);
  reference_modes_render(&c->volume, &c->transfer, &c->camera, &c->options, CASE_WIDTH, CASE_HEIGHT, 1.0, expected, expected_depth);
  for (int i = 0; i < CASE_PIXELS; ++i) {
    const float *is = drawn.rgba + 4 * i, *should = expected + 4 * i;
    if ((is[3] > 0.0f) != (should[3] > 0.0f)) {
      assert_true(fmax((double)is[2], (double)should[2]) < 0.01); /* it hardly touches the volume */
      ++rims;
      continue;
    }
    lit += is[3] > 0.0f;
    for (int number = 0; number < 3; ++number) {
      largest[number] = fmax(largest[number], fabs((double)should[number]));
      off[number] = fmax(off[number], fabs((double)is[number] - (double)should[number]));
    }
    counts += fabs((double)(is[3] - should[3])) > 0.0;
    if (is[3] > 0.0f && fabs((double)(is[0] - should[0])) <= 1e-6 * fabs((double)should[0])) {
      depth_off = fmax(depth_off, fabs((double)(drawn.depth[i] - expected_depth[i])));
    }
  }
  print_message(
    "             %s: %d rays; largest value %.2g, integral %.2g, length %.2g off by the largest; %d counts, %d rims; depth %.2g\n", what,
    lit, off[0] / largest[0], off[1] / largest[1], off[2] / largest[2], counts, rims, depth_off);
  assert_true(off[1] <= REL * largest[1]);
  assert_true(off[2] <= REL * largest[2]);
  assert_true(off[0] <= REL * largest[0]);
  assert_true(counts <= 2 + lit / 50);
  assert_true(rims <= 2 + lit / 50);
}

static void every_type(void** state)
{
  for (int type = STRATUS_INT8; type <= STRATUS_FLOAT64; ++type) {
    for (int nearest = 0; nearest < 2; ++nearest) {
      picture_case c;
      case_create(*state, &c, (stratus_type)type, 23, 29, 21, 5u + (uint32_t)type);
      c.options.sampling.interpolation = nearest ? STRATUS_INTERPOLATION_NEAREST : STRATUS_INTERPOLATION_LINEAR;
      c.volume.cell_centered = type % 3 == 1;
      expect_reference(*state, &c, case_type_names[type]);
      case_destroy(&c);
    }
  }
}

/* Holes, hidden cells, crop boxes, clip planes, thin grids, cameras inside. Clip planes are not the reference's. */
static void random_cases(void** state)
{
  for (uint32_t seed = 0; seed < (long_run() ? 60u : 16u); ++seed) {
    char what[96];
    picture_case c;
    case_create_random(*state, seed, &c);
    snprintf(what, sizeof what, "seed %u, %s, %s, %s%s%s", seed, case_type_names[c.volume.type],
      c.options.sampling.interpolation == STRATUS_INTERPOLATION_NEAREST ? "nearest" : "linear", c.volume.cell_centered ? "cells" : "points",
      c.cell_ghosts ? ", hidden cells" : "", c.options.clipping.crop ? ", crop" : "");
    c.options.clipping.clip_plane_count = 0;
    expect_reference(*state, &c, what);
    case_destroy(&c);
  }
}

static void masks_and_crop_regions(void** state)
{
  for (int nearest = 0; nearest < 2; ++nearest) {
    for (int centered = 0; centered < 2; ++centered) {
      picture_case c;
      uint8_t mask[20 * 18 * 22];
      uint32_t s = 3u;
      case_create(*state, &c, STRATUS_FLOAT32, 20, 18, 22, 9u);
      c.options.sampling.interpolation = nearest ? STRATUS_INTERPOLATION_NEAREST : STRATUS_INTERPOLATION_LINEAR;
      c.volume.cell_centered = centered;
      for (size_t i = 0; i < sizeof mask; ++i) {
        mask[i] = case_random(&s) % 3 > 0;
      }
      c.options.mask.bytes = mask;
      expect_reference(*state, &c, "mask");
      c.options.clipping.crop = 1;
      c.options.clipping.crop_regions = 0x5a5a5a5u;
      for (int a = 0; a < 3; ++a) {
        c.options.clipping.crop_bounds[2 * a] = 5.2;
        c.options.clipping.crop_bounds[2 * a + 1] = 12.9;
      }
      expect_reference(*state, &c, "mask and crop regions");
      case_destroy(&c);
    }
  }
}

/* ---- closed forms */

/* A field that is linear: base + slope . x. */
static void make_linear(picture_case* c, double base, const double slope[3])
{
  const int64_t* n = c->volume.dimensions;
  for (int64_t at = 0; at < n[0] * n[1] * n[2]; ++at) {
    const double x = (double)(at % n[0]), y = (double)(at / n[0] % n[1]), z = (double)(at / n[0] / n[1]);
    ((float*)c->values)[at] = (float)(base + slope[0] * x + slope[1] * y + slope[2] * z);
  }
  ++c->volume.revision;
}

/* The cut of a pixel's ray with the box 0..last, in world lengths from the eye. */
static bool cut_of(const picture_case* c, int pixel, double origin[3], double along[3], double* from, double* to)
{
  const double u = (2.0 * (pixel % CASE_WIDTH) + 1.0) / CASE_WIDTH - 1.0, v = (2.0 * (pixel / CASE_WIDTH) + 1.0) / CASE_HEIGHT - 1.0;
  double length = 0.0;
  for (int a = 0; a < 3; ++a) {
    const double side = u * c->camera.right[a] + v * c->camera.up[a];
    origin[a] = c->camera.eye[a] + (c->camera.parallel ? side : 0.0);
    along[a] = c->camera.forward[a] + (c->camera.parallel ? 0.0 : side);
    length += along[a] * along[a];
  }
  *from = 0.0;
  *to = INFINITY;
  for (int a = 0; a < 3; ++a) {
    along[a] /= sqrt(length);
    const double near = (0.0 - origin[a]) / along[a], far = ((double)(c->volume.dimensions[a] - 1) - origin[a]) / along[a];
    *from = fmax(*from, fmin(near, far));
    *to = fmin(*to, fmax(near, far));
  }
  return *from < *to;
}

/* All numbers of a linear field; its opacity is the same everywhere, so that the transmittance is exponential. mesh: drawn as one. */
static void expect_linear(
  const picture_case* c, const double slope[3], double base, double opacity, float of[STRATUS_QUANTITY_COUNT][CASE_PIXELS_MOST])
{
  double worst[STRATUS_QUANTITY_COUNT] = { 0.0 };
  int lit = 0, deep = 0;
  for (int i = 0; i < CASE_PIXELS; ++i) {
    double origin[3], along[3], from, to, ends[2] = { base, base };
    if (!cut_of(c, i, origin, along, &from, &to)) {
      assert_true(of[STRATUS_QUANTITY_INTEGRAL][i] == 0.0f || of[STRATUS_QUANTITY_LENGTH][i] < 0.01f);
      continue;
    }
    if (to - from < 0.1) {
      continue;
    }
    for (int a = 0; a < 3; ++a) {
      ends[0] += slope[a] * (origin[a] + from * along[a]);
      ends[1] += slope[a] * (origin[a] + to * along[a]);
    }
    const double passes = pow(1.0 - opacity, (to - from) / c->transfer.unit_distance);
    const double half = from + c->transfer.unit_distance * log(0.5) / log(1.0 - opacity);
    const double should[STRATUS_QUANTITY_COUNT] = { 0.5 * (ends[0] + ends[1]) * (to - from), to - from, 0.5 * (ends[0] + ends[1]),
      fmax(ends[0], ends[1]), ends[0] > ends[1] ? from : to, 0.0, passes, half };
    const double unit[STRATUS_QUANTITY_COUNT] = { 1000.0, 30.0, 100.0, 100.0, 100.0, 1.0, 1.0, 100.0 };
    for (int q = 0; q < STRATUS_QUANTITY_COUNT; ++q) {
      if (q == STRATUS_QUANTITY_CELLS) {
        assert_true(of[q][i] >= 1.0f);
      } else if (q == STRATUS_QUANTITY_TRANSMITTANCE_DEPTH && passes > 0.5 - 1e-3) {
        assert_true(passes < 0.5 + 1e-3 || isnan(of[q][i]));
      } else if (q != STRATUS_QUANTITY_MAXIMUM_DEPTH || fabs(ends[1] - ends[0]) > 0.1) {
        worst[q] = fmax(worst[q], fabs((double)of[q][i] - should[q]) / unit[q]);
        deep += q == STRATUS_QUANTITY_TRANSMITTANCE_DEPTH;
      }
    }
    ++lit;
  }
  print_message("             %d rays, %d of them pass less than half: ", lit, deep);
  for (int q = 0; q < STRATUS_QUANTITY_COUNT; ++q) {
    print_message(" %s %.2g", stratus_quantity_name((stratus_quantity)q), worst[q]);
  }
  print_message("\n");
  assert_true(lit > CASE_PIXELS / 8);
  assert_true(deep > lit / 4 && deep < lit);
  for (int q = 0; q < STRATUS_QUANTITY_COUNT; ++q) {
    assert_true(worst[q] < (q >= STRATUS_QUANTITY_TRANSMITTANCE ? 1e-3 : 1e-5));
  }
}

static void linear_fields(void** state)
{
  static const double slope[3] = { 0.7, -0.4, 1.3 }, opacity[4] = { -1000.0, 0.04, 1000.0, 0.04 };
  for (int view = 0; view < 6; ++view) {
    picture_case c;
    stratus_ray_caster* caster = NULL;
    case_create(*state, &c, STRATUS_FLOAT32, 20, 24, 18, 1u);
    make_linear(&c, 10.0, slope);
    memcpy(c.opacity, opacity, sizeof opacity);
    c.transfer.opacity_count = 2;
    c.transfer.unit_distance = 1.0;
    case_camera(*state, &c, view, view % 2);
    assert_int_equal(stratus_ray_caster_create(*state, &caster), STRATUS_OK);
    const stratus_ray_cast_input input = { .caster = caster, .volume = &c.volume, .transfer = &c.transfer, .options = &c.options };
    const stratus_quantities wanted = want_all(numbers);
    compute(*state, &input, 1, &c.camera, &wanted);
    expect_linear(&c, slope, 10.0, 0.04, numbers);
    stratus_ray_caster_destroy(caster);

    /* the same field as a lattice of hexahedra, of which each is six tetrahedra */
    stratus_mesh mesh = stratus_mesh_default();
    stratus_tetra_caster* tetra = NULL;
    const int64_t* n = c.volume.dimensions;
    double* points = malloc((size_t)(3 * n[0] * n[1] * n[2]) * sizeof *points);
    assert_non_null(points);
    for (int64_t at = 0; at < n[0] * n[1] * n[2]; ++at) {
      points[3 * at] = (double)(at % n[0]);
      points[3 * at + 1] = (double)(at / n[0] % n[1]);
      points[3 * at + 2] = (double)(at / n[0] / n[1]);
    }
    mesh.points = points;
    mesh.point_count = n[0] * n[1] * n[2];
    mesh.cell_count = (n[0] - 1) * (n[1] - 1) * (n[2] - 1);
    mesh.values = c.values;
    mesh.type = STRATUS_FLOAT32;
    mesh.value_stride = 1;
    for (int a = 0; a < 3; ++a) {
      mesh.lattice[a] = (int32_t)n[a];
    }
    assert_int_equal(stratus_tetra_caster_create(*state, &tetra), STRATUS_OK);
    const stratus_ray_cast_input of_mesh = { .tetra = tetra, .mesh = &mesh, .transfer = &c.transfer };
    const stratus_quantities of_mesh_wanted = want_all(others);
    compute(*state, &of_mesh, 1, &c.camera, &of_mesh_wanted);
    expect_linear(&c, slope, 10.0, 0.04, others);
    stratus_tetra_caster_destroy(tetra);
    free(points);
    case_destroy(&c);
  }
}

/* ---- units */

/* Lengths of a world whose heights are stretched by 10 and whose unit is a kilometre: of each ray the length of its part in the data's own
 * metres. */
static void lengths_are_measured(void** state)
{
  static const double slope[3] = { 0.7, -0.4, 1.3 };
  static const int lengths[] = { STRATUS_QUANTITY_INTEGRAL, STRATUS_QUANTITY_LENGTH, STRATUS_QUANTITY_MAXIMUM_DEPTH,
    STRATUS_QUANTITY_TRANSMITTANCE_DEPTH };
  for (int parallel = 0; parallel < 2; ++parallel) {
    picture_case c;
    stratus_ray_caster* caster = NULL;
    case_create(*state, &c, STRATUS_FLOAT32, 12, 10, 9, 1u);
    make_linear(&c, 10.0, slope);
    case_camera(*state, &c, 1, parallel);
    assert_int_equal(stratus_ray_caster_create(*state, &caster), STRATUS_OK);
    const stratus_ray_cast_input input = { .caster = caster, .volume = &c.volume, .transfer = &c.transfer, .options = &c.options };
    stratus_quantities wanted = want_all(numbers);
    compute(*state, &input, 1, &c.camera, &wanted);
    wanted = want_all(others);
    wanted.measure[0] = wanted.measure[4] = 1000.0;
    wanted.measure[8] = 100.0;
    compute(*state, &input, 1, &c.camera, &wanted);
    int lit = 0;
    for (int i = 0; i < CASE_PIXELS; ++i) {
      const double u = (2.0 * (i % CASE_WIDTH) + 1.0) / CASE_WIDTH - 1.0, v = (2.0 * (i / CASE_WIDTH) + 1.0) / CASE_HEIGHT - 1.0;
      double along[3], whole = 0.0, measured = 0.0;
      for (int a = 0; a < 3; ++a) {
        along[a] = c.camera.forward[a] + (c.camera.parallel ? 0.0 : u * c.camera.right[a] + v * c.camera.up[a]);
        whole += along[a] * along[a];
        measured += along[a] * along[a] * (a < 2 ? 1e6 : 1e4);
      }
      for (int n = 0; n < 4; ++n) {
        const double is = (double)others[lengths[n]][i], should = (double)numbers[lengths[n]][i] * sqrt(measured / whole);
        assert_true(isnan(is) == isnan(should) && !(fabs(is - should) > 1e-5 * fabs(should))); /* a few roundings of floats */
      }
      lit += numbers[STRATUS_QUANTITY_LENGTH][i] > 0.0f;
      assert_memory_equal(&others[STRATUS_QUANTITY_MEAN][i], &numbers[STRATUS_QUANTITY_MEAN][i], sizeof(float));
    }
    assert_true(lit > CASE_PIXELS / 8);
    stratus_ray_caster_destroy(caster);
    case_destroy(&c);
  }
}

static void units_are_text(void** state)
{
  static const struct {
    const char *values, *integral;
  } cases[] = { { "kg m-3", "kg m-2" }, { "kg/m3", "kg m-2" }, { "kg.m^-3", "kg m-2" }, { "kg m**-3", "kg m-2" },
    { "kg kg-1", "kg kg-1 m" }, { "g/kg", "g kg-1 m" }, { "1", "m" }, { "1/m", "1" }, { "m-1", "1" }, { "K", "K m" }, { "m", "m2" },
    { "W m-2 sr-1", "W m-1 sr-1" }, { "%", "% m" }, { "kg/(m2 s)", "(kg/(m2 s)) m" }, { "10-3", "10-3 m" }, { "kg/", "(kg/) m" },
    { "kg//m", "(kg//m) m" }, { "", "" }, { NULL, "" } };
  char text[64];
  (void)state;
  for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i) {
    stratus_quantity_unit(STRATUS_QUANTITY_INTEGRAL, cases[i].values, 1, text, sizeof text);
    assert_string_equal(text, cases[i].integral);
  }
  stratus_quantity_unit(STRATUS_QUANTITY_INTEGRAL, "K", 0, text, sizeof text);
  assert_string_equal(text, "K grid units");
  stratus_quantity_unit(STRATUS_QUANTITY_LENGTH, NULL, 0, text, sizeof text);
  assert_string_equal(text, "grid units");
  stratus_quantity_unit(STRATUS_QUANTITY_MAXIMUM_DEPTH, "K", 1, text, sizeof text);
  assert_string_equal(text, "m");
  stratus_quantity_unit(STRATUS_QUANTITY_MEAN, "K", 1, text, sizeof text);
  assert_string_equal(text, "K");
  stratus_quantity_unit(STRATUS_QUANTITY_INTEGRAL, "abcdefgh ijk", 1, text, 6);
  assert_string_equal(text, "abcde");
  stratus_quantity_unit(STRATUS_QUANTITY_LENGTH, NULL, 1, NULL, 0);
}

/* ---- several, and blocks */

/* Two halves that meet in a plane have the numbers of the whole; as several, too, because they do not overlap. */
static void halves_have_the_numbers_of_the_whole(void** state)
{
  picture_case c;
  stratus_ray_caster* casters[3];
  case_create(*state, &c, STRATUS_FLOAT32, 25, 20, 22, 7u);
  stratus_ray_cast_input inputs[3];
  stratus_volume halves[3] = { c.volume, c.volume, c.volume };
  for (int n = 0; n < 3; ++n) {
    assert_int_equal(stratus_ray_caster_create(*state, &casters[n]), STRATUS_OK);
    inputs[n] = (stratus_ray_cast_input){ .caster = casters[n], .volume = &halves[n], .transfer = &c.transfer, .options = &c.options };
  }
  halves[1].dimensions[2] = 12;
  halves[2].dimensions[2] = 11;
  halves[2].values = (const float*)c.values + 11 * 25 * 20;
  halves[2].origin[2] = 11.0;
  stratus_quantities wanted = want_all(numbers), of_halves = want_all(others);
  c.transfer.unit_distance = 1.0;
  compute(*state, &inputs[0], 1, &c.camera, &wanted);
  for (int blocks = 0; blocks < 2; ++blocks) {
    double worst[STRATUS_QUANTITY_COUNT] = { 0.0 }, largest[STRATUS_QUANTITY_COUNT] = { 0.0 };
    of_halves.blocks = blocks;
    compute(*state, &inputs[1], 2, &c.camera, &of_halves);
    int lit = 0, deep = 0;
    for (int i = 0; i < CASE_PIXELS; ++i) {
      lit += numbers[STRATUS_QUANTITY_LENGTH][i] > 0.0f;
      deep += !isnan(numbers[STRATUS_QUANTITY_TRANSMITTANCE_DEPTH][i]);
      for (int q = 0; q < STRATUS_QUANTITY_COUNT && numbers[STRATUS_QUANTITY_LENGTH][i] > 0.1f; ++q) {
        const double is = (double)others[q][i], should = (double)numbers[q][i];
        if (q == STRATUS_QUANTITY_TRANSMITTANCE_DEPTH && (isnan(is) || isnan(should))) {
          const double passes = (double)numbers[STRATUS_QUANTITY_TRANSMITTANCE][i];
          assert_true(isnan(is) == isnan(should) || fabs(passes - 0.5) < 2e-3);
          continue;
        }
        if (q != STRATUS_QUANTITY_MAXIMUM_DEPTH) { /* which two equal values may decide in either way */
          worst[q] = fmax(worst[q], fabs(is - should));
          largest[q] = fmax(largest[q], fabs(should));
        }
      }
    }
    print_message("             %s: %d rays, %d pass less than half:", blocks ? "blocks" : "several", lit, deep);
    for (int q = 0; q < STRATUS_QUANTITY_COUNT; ++q) {
      worst[q] /= fmax(largest[q], 1e-30);
      print_message(" %s %.2g", stratus_quantity_name((stratus_quantity)q), worst[q]);
    }
    print_message("\n");
    assert_true(lit > CASE_PIXELS / 8 && deep > lit / 10);
    for (int q = 0; q < STRATUS_QUANTITY_CELLS; ++q) {
      assert_true(worst[q] < 1e-5);
    }
    assert_true(worst[STRATUS_QUANTITY_CELLS] < 0.1);
    assert_true(worst[STRATUS_QUANTITY_TRANSMITTANCE] < 3e-3);
    assert_true(worst[STRATUS_QUANTITY_TRANSMITTANCE_DEPTH] < 1e-2);
  }
  for (int n = 0; n < 3; ++n) {
    stratus_ray_caster_destroy(casters[n]);
  }
  case_destroy(&c);
}

/* ---- refusals */

static void bad_input_is_refused(void** state)
{
  picture_case c;
  stratus_ray_caster* caster = NULL;
  case_create(*state, &c, STRATUS_FLOAT32, 8, 8, 8, 1u);
  assert_int_equal(stratus_ray_caster_create(*state, &caster), STRATUS_OK);
  const stratus_ray_cast_input input = { .caster = caster, .volume = &c.volume, .transfer = &c.transfer };
  stratus_quantities wanted = want_all(numbers);
  wanted.threshold = 1.0;
  assert_int_equal(stratus_ray_caster_render_quantities(&input, 1, &c.camera, &wanted), STRATUS_INVALID_ARGUMENT);
  assert_non_null(strstr(stratus_context_message(*state), "threshold 1 of the transmittance, must be above 0 and below 1"));
  wanted = want_all(numbers);
  wanted.component = 1;
  assert_int_equal(stratus_ray_caster_render_quantities(&input, 1, &c.camera, &wanted), STRATUS_INVALID_ARGUMENT);
  assert_non_null(strstr(stratus_context_message(*state), "component 1 of input 0, must be 0..0"));
  wanted = want_all(numbers);
  assert_int_equal(stratus_ray_caster_render_quantities(&input, 0, &c.camera, &wanted), STRATUS_INVALID_ARGUMENT);
  assert_int_equal(stratus_ray_caster_render_quantities(&input, 1, &c.camera, NULL), STRATUS_INVALID_ARGUMENT);
  assert_int_equal(stratus_ray_caster_render_quantities(NULL, 1, &c.camera, &wanted), STRATUS_INVALID_ARGUMENT);
  wanted.measure[0] = wanted.measure[4] = 1.0; /* nothing along z */
  assert_int_equal(stratus_ray_caster_render_quantities(&input, 1, &c.camera, &wanted), STRATUS_INVALID_ARGUMENT);
  assert_non_null(strstr(stratus_context_message(*state), "measure has the determinant 0, must be finite and not 0"));
  wanted = want_all(numbers);
  wanted.width = 0;
  assert_int_equal(stratus_ray_caster_render_quantities(&input, 1, &c.camera, &wanted), STRATUS_INVALID_ARGUMENT);
  stratus_ray_caster_destroy(caster);
  case_destroy(&c);
}

int test_ray_quantities(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(every_type),
    cmocka_unit_test(random_cases),
    cmocka_unit_test(masks_and_crop_regions),
    cmocka_unit_test(linear_fields),
    cmocka_unit_test(halves_have_the_numbers_of_the_whole),
    cmocka_unit_test(lengths_are_measured),
    cmocka_unit_test(units_are_text),
    cmocka_unit_test(bad_input_is_refused),
  };
  return cmocka_run_group_tests(tests, case_set_up, case_tear_down);
}
