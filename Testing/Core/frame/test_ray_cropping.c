/* SPDX-License-Identifier: BSD-3-Clause
 * Crop regions, masks and jitter of the ray cast in every mode, compared with a double reference, and with the same picture without
 * structure.
 *
 * Planes cut a ray exactly in both. Only the samples' errors are left, which are of first order for an extreme that is on a plane. A mask's
 * border is met to half a step, .05 voxel, and a ray that passes it more closely is wholly right or wholly wrong: MASK_DB. */
#define CASE_FULL_SIZE
#include "picture_case.h"
#include "reference_modes.h"

#define CROP_DB 57.0    /* measured: 61 to 106 */
#define SURFACE_DB 43.0 /* of isosurfaces: 47; a pixel of a rim is wholly right or wrong */
#define MASK_DB 32.0    /* measured: 35 to 57, of means and maxima the least */

static picture drawn, other;
static float expected[4 * CASE_PIXELS_MOST], expected_depth[CASE_PIXELS_MOST];

static const stratus_mode modes[] = { STRATUS_MODE_COMPOSITE, STRATUS_MODE_MAXIMUM, STRATUS_MODE_AVERAGE, STRATUS_MODE_ADDITIVE,
  STRATUS_MODE_ISOSURFACE };
enum { MODES = sizeof modes / sizeof *modes };

static void set_contours(picture_case* c)
{
  const double base = case_type_values[c->volume.type].base, scale = case_type_values[c->volume.type].scale;
  c->options.optics.contour_count = 2;
  c->options.optics.contours[0] = base + 0.1 * scale;
  c->options.optics.contours[1] = base + 0.3 * scale;
}

static double compare(stratus_context* context, const picture_case* c, const char* what)
{
  case_render(context, c, &drawn);
  reference_modes_render(&c->volume, &c->transfer, &c->camera, &c->options, CASE_WIDTH, CASE_HEIGHT, 0.02, expected, expected_depth);
  const double db = reference_psnr(drawn.rgba, expected, CASE_PIXELS);
  print_message("             %s, %s: %.1f dB, %d pixels\n", stratus_mode_name(c->options.mode), what, db, case_lit(&drawn));
  return db;
}

static void expect_same(const char* what)
{
  int differing = 0;
  for (int i = 0; i < CASE_PIXELS; ++i) {
    differing += memcmp(drawn.rgba + 4 * i, other.rgba + 4 * i, 4 * sizeof(float)) != 0 ||
      memcmp(drawn.depth + i, other.depth + i, sizeof(float)) != 0;
  }
  if (differing) {
    print_error("%s: %d of %d pixels differ\n", what, differing, CASE_PIXELS);
    fail();
  }
}

static void crop_between(picture_case* c, uint32_t regions)
{
  c->options.clipping.crop = 1;
  c->options.clipping.crop_regions = regions;
  for (int a = 0; a < 3; ++a) {
    c->options.clipping.crop_bounds[2 * a] = 0.31 * (double)c->volume.dimensions[a];
    c->options.clipping.crop_bounds[2 * a + 1] = 0.63 * (double)c->volume.dimensions[a];
  }
}

/* Each single one of the 27 regions, and the sets that VTK has names for. */
static void each_region_is_where_it_should_be(void** state)
{
  static const uint32_t named[] = { 0x2000u, 0x5ffdfffu, 0x0417410u, 0x7ebfbefu, 0x2ebfeba,
    0x5140145u }; /* the first two: subvolume, its complement */
  picture_case c;
  case_create(*state, &c, STRATUS_FLOAT32, 23, 29, 21, 61u);
  set_contours(&c);
  c.opacity[1] = c.opacity[3] = 0.03; /* every value shows, or some region would be empty */
  c.options.sampling.distance = 0.1;
  for (int i = 0; i < 27 + 6; ++i) {
    char what[64];
    const uint32_t regions = i < 27 ? 1u << i : named[i - 27];
    crop_between(&c, regions);
    c.options.mode = modes[i % 2]; /* composite and maximum: every region counts in both */
    case_camera(*state, &c, i % 8, i % 3 == 0);
    snprintf(what, sizeof what, "regions 0x%07x", (unsigned)regions);
    const double db = compare(*state, &c, what);
    assert_true(case_lit(&drawn) > 0);
    assert_true(db >= CROP_DB);
  }
  case_destroy(&c);
}

static void regions_in_every_mode(void** state)
{
  for (int mode = 0; mode < MODES; ++mode) {
    picture_case c;
    case_create(*state, &c, STRATUS_UINT16, 23, 29, 21, 71u + (uint32_t)mode);
    set_contours(&c);
    crop_between(&c, 0x5140145u);
    c.options.sampling.distance = 0.1;
    c.options.mode = modes[mode];
    c.volume.cell_centered = mode % 2;
    case_camera(*state, &c, mode, 0);
    const double db = compare(*state, &c, "corners and middles");
    assert_true(case_lit(&drawn) > CASE_PIXELS / 20);
    assert_true(db >= (modes[mode] == STRATUS_MODE_ISOSURFACE ? SURFACE_DB : CROP_DB));
    case_destroy(&c);
  }
}

/* A ray is not cut where it passes between two shown regions: two regions that make up a box draw what the box does, up to the rounding of
 * the planes' positions. */
static void regions_side_by_side_are_one(void** state)
{
  picture_case c;
  case_create(*state, &c, STRATUS_FLOAT32, 23, 29, 21, 61u);
  crop_between(&c, STRATUS_CROP_INSIDE);
  c.options.sampling.rule = STRATUS_SAMPLING_PREINTEGRATED;
  c.options.clipping.crop_bounds[0] = -1.0;
  case_render(*state, &c, &other);
  c.options.clipping.crop_bounds[0] = 2.0;
  c.options.clipping.crop_regions = STRATUS_CROP_INSIDE | STRATUS_CROP_INSIDE >> 1;
  case_render(*state, &c, &drawn);
  assert_true(case_lit(&drawn) > CASE_PIXELS / 50);
  assert_true(reference_psnr(drawn.rgba, other.rgba, CASE_PIXELS) > 90.0);
  case_destroy(&c);
}

static uint8_t* make_mask(const stratus_volume* volume, uint32_t seed)
{
  const int64_t* n = volume->dimensions;
  uint8_t* mask = calloc((size_t)(n[0] * n[1] * n[2]), 1);
  assert_non_null(mask);
  for (int64_t at = 0; at < n[0] * n[1] * n[2]; ++at) {
    const double x = (double)(at % n[0]) - 0.5 * (double)n[0], y = (double)(at / n[0] % n[1]) - 0.5 * (double)n[1];
    const double z = (double)(at / n[0] / n[1]) - 7.0;
    mask[at] = (uint8_t)(x * x + y * y + z * z < 120.0 + seed % 7 ? 1 + at % 255 : 0); /* any number but 0 shows */
  }
  return mask;
}

static void masks_take_values_out(void** state)
{
  for (int mode = 0; mode < 2 * MODES; mode += few_run() ? 3 : 1) {
    picture_case c;
    case_create(*state, &c, mode % 2 ? STRATUS_FLOAT32 : STRATUS_INT16, 23, 29, 21, 81u + (uint32_t)mode);
    set_contours(&c);
    uint8_t* mask = make_mask(&c.volume, (uint32_t)mode);
    c.options.mask.bytes = mask;
    c.options.mode = modes[mode % MODES];
    c.options.sampling.distance = 0.1;
    c.options.sampling.interpolation =
      mode >= MODES && modes[mode % MODES] != STRATUS_MODE_ISOSURFACE ? STRATUS_INTERPOLATION_NEAREST : STRATUS_INTERPOLATION_LINEAR;
    c.volume.cell_centered = mode == 3;
    const double db = compare(*state, &c, c.options.sampling.interpolation == STRATUS_INTERPOLATION_NEAREST ? "masked, nearest" : "masked");
    assert_true(case_lit(&drawn) > CASE_PIXELS / 20);
    assert_true(db >= MASK_DB);
    free(mask);
    case_destroy(&c);
  }
}

static void a_mask_that_changes_is_read_again(void** state)
{
  stratus_ray_caster* caster = NULL;
  picture_case c;
  case_create(*state, &c, STRATUS_FLOAT32, 23, 29, 21, 61u);
  uint8_t* mask = make_mask(&c.volume, 3);
  assert_int_equal(stratus_ray_caster_create(*state, &caster), STRATUS_OK);
  case_render_with(*state, caster, &c, &drawn);
  const int whole = case_lit(&drawn);
  c.options.mask.bytes = mask;
  case_render_with(*state, caster, &c, &drawn);
  const int masked = case_lit(&drawn);
  assert_true(masked > 0 && masked < whole);
  memset(mask, 0, 23 * 29 * 21);
  case_render_with(*state, caster, &c, &drawn);
  assert_int_equal(case_lit(&drawn), masked); /* the mask's revision is the old one */
  c.options.mask.revision = 1;
  case_render_with(*state, caster, &c, &drawn);
  assert_int_equal(case_lit(&drawn), 0);
  assert_int_equal(drawn.report.range_builds, 1); /* nor did the data */
  c.options.mask.bytes = NULL;
  case_render_with(*state, caster, &c, &drawn);
  assert_int_equal(case_lit(&drawn), whole);
  stratus_ray_caster_destroy(caster);
  free(mask);
  case_destroy(&c);
}

static void structures_and_threads_change_no_bit(void** state)
{
  stratus_context* one = case_context("host", 1);
  uint64_t skipped = 0;
  for (uint32_t seed = 300; seed < 360; ++seed) {
    picture_case c;
    char what[128];
    uint32_t random = seed;
    uint8_t* mask = NULL;
    case_create_random(*state, seed, &c);
    c.options.mode = modes[seed % MODES];
    set_contours(&c);
    if (c.options.mode == STRATUS_MODE_ISOSURFACE) {
      c.options.sampling.interpolation = STRATUS_INTERPOLATION_LINEAR;
    }
    if (seed % 2) {
      crop_between(&c, (case_random(&random) * 8u + case_random(&random)) & STRATUS_CROP_ALL);
    }
    if (seed % 3 == 0) {
      mask = make_mask(&c.volume, seed);
      c.options.mask.bytes = mask;
    }
    if (mask && c.options.sampling.rule == STRATUS_SAMPLING_CELLS) { /* which takes no mask */
      c.options.sampling.rule = STRATUS_SAMPLING_MIDPOINT;
    }
    c.options.sampling.jitter = seed % 5 < 2;
    c.options.sampling.jitter_seed = seed;
    c.options.skipping.structure = STRATUS_STRUCTURE_NONE;
    case_render(*state, &c, &drawn);
    case_render(one, &c, &other);
    expect_same("threads");
    c.options.skipping.audit = 1;
    for (int structure = STRATUS_STRUCTURE_BLOCK; structure <= STRATUS_STRUCTURE_HYBRID; ++structure) {
      c.options.skipping.structure = (stratus_structure)structure;
      case_render(*state, &c, &other);
      snprintf(what, sizeof what, "seed %u, %s, %s", seed, stratus_mode_name(c.options.mode),
        stratus_structure_name(c.options.skipping.structure));
      expect_same(what);
      assert_int_equal(other.report.differing_pixels, 0);
      skipped += other.report.skipped;
    }
    free(mask);
    case_destroy(&c);
  }
  assert_true(skipped > 0);
  stratus_context_destroy(one);
}

/* Long steps through a thin shell give wood grain. Jitter must turn it into noise, and keep the light only on average. */
static void jitter_moves_samples_and_nothing_else(void** state)
{
  picture_case c;
  case_create(*state, &c, STRATUS_FLOAT32, 31, 29, 27, 61u);
  c.options.sampling.distance = 1.7;
  case_render(*state, &c, &other);
  c.options.sampling.jitter = 1;
  case_render(*state, &c, &drawn);
  double sum[2] = { 0.0, 0.0 };
  int differing = 0, both = 0;
  for (int i = 0; i < CASE_PIXELS; ++i) {
    differing += drawn.rgba[4 * i + 3] != other.rgba[4 * i + 3];
    both += drawn.rgba[4 * i + 3] > 0.0f && other.rgba[4 * i + 3] > 0.0f;
    sum[0] += (double)drawn.rgba[4 * i + 3];
    sum[1] += (double)other.rgba[4 * i + 3];
  }
  assert_true(differing > both * 9 / 10);
  assert_true(fabs(sum[0] / sum[1] - 1.0) < 0.02);
  case_render(*state, &c, &other);
  expect_same("the same seed");
  c.options.sampling.jitter_seed = 1;
  case_render(*state, &c, &other);
  assert_true(memcmp(drawn.rgba, other.rgba, sizeof drawn.rgba) != 0);
  c.options.sampling.distance = 0.05; /* short steps: where they begin does not matter */
  case_render(*state, &c, &drawn);
  c.options.sampling.jitter = 0;
  case_render(*state, &c, &other);
  assert_true(reference_psnr(drawn.rgba, other.rgba, CASE_PIXELS) > 65.0);
  int near = 0, far = 0;
  for (int i = 0; i < CASE_PIXELS; ++i) { /* depths are measured from the eye, not from the moved lattice's begin */
    if (isfinite(drawn.depth[i]) && isfinite(other.depth[i])) {
      const bool same = fabsf(drawn.depth[i] - other.depth[i]) < 0.5f;
      near += same;
      far += !same;
    }
  }
  /* A ray that only grazes a faint part may meet it on one lattice, and a part behind it on the other. */
  assert_true(near > 100 && far * 100 <= near);
  case_destroy(&c);
}

static void first_hits_and_bad_regions_are_refused(void** state)
{
  stratus_ray_caster* caster = NULL;
  picture_case c;
  case_create(*state, &c, STRATUS_FLOAT32, 9, 9, 9, 3u);
  assert_int_equal(stratus_ray_caster_create(*state, &caster), STRATUS_OK);
  const stratus_image image = { .width = CASE_WIDTH, .height = CASE_HEIGHT, .rgba = drawn.rgba };
  c.options.clipping.crop_regions = STRATUS_CROP_ALL + 1;
  assert_int_equal(
    stratus_ray_caster_render(caster, &c.volume, &c.transfer, &c.camera, &c.options, &image, NULL), STRATUS_INVALID_ARGUMENT);
  assert_non_null(strstr(stratus_context_message(*state), "crop regions 0x8000000"));
  c.options.mode = STRATUS_MODE_FIRST_HIT;
  crop_between(&c, 1);
  assert_int_equal(stratus_ray_caster_render(caster, &c.volume, &c.transfer, &c.camera, &c.options, &image, NULL), STRATUS_UNSUPPORTED);
  assert_non_null(strstr(stratus_context_message(*state), "crop regions"));
  stratus_ray_caster_destroy(caster);
  case_destroy(&c);
}

int test_ray_cropping(void)
{
  const struct CMUnitTest tests[] = { cmocka_unit_test(each_region_is_where_it_should_be), cmocka_unit_test(regions_in_every_mode),
    cmocka_unit_test(regions_side_by_side_are_one), cmocka_unit_test(masks_take_values_out),
    cmocka_unit_test(a_mask_that_changes_is_read_again), cmocka_unit_test(structures_and_threads_change_no_bit),
    cmocka_unit_test(jitter_moves_samples_and_nothing_else), cmocka_unit_test(first_hits_and_bad_regions_are_refused) };
  return cmocka_run_group_tests(tests, case_set_up, case_tear_down);
}
