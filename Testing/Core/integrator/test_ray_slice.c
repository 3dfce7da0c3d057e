/* SPDX-License-Identifier: BSD-3-Clause
 * Slices, compared with a double reference that finds the surface by bisection: planes, spheres, cylinders, cones and saddles, from inside
 * and outside, cropped, clipped and masked, on images and on grids whose spacing changes.
 *
 * Slices don't sample, so that only rounding is left: of a position, some 1e-5 voxel, times the steepest change of colour or opacity, and
 * the table's half an entry, as in the other modes. A ray that grazes the surface may meet it in only one picture. */
#include "grid_case.h"
#include "reference_modes.h"
#include "volume.h"

#define SLICE_DB 64.0    /* as of the modes that sample; measured: 70 and more */
#define DEPTH_ERROR 1e-3 /* in world units, for volumes 30 wide; larger if a ray is nearly in a plane */
#define GRAZING_SHARE 0.003

static picture drawn, other;
static float expected[4 * CASE_PIXELS_MOST], expected_depth[CASE_PIXELS_MOST];

/* Surfaces through a case's volume, whose middle is at `middle`. */
static stratus_slice surface(int kind, const double middle[3])
{
  static const stratus_slice kinds[] = { { .linear = { 0, 0, 1 } }, { .linear = { 1, -2, 0.5 } },
    { .square = { 1, 1, 1 }, .constant = -64.0 }, { .square = { 1, 1, 0 }, .constant = -25.0 }, { .square = { 1, 1, -0.5 } },
    { .square = { 0.05, -0.05, 0, 0.02, 0.01, -0.03 }, .linear = { 0.1, 0.2, 1 } }, { .square = { 1, 2, 3, 0.5 }, .constant = -90.0 } };
  stratus_slice slice = kinds[kind];
  memcpy(slice.center, middle, sizeof slice.center);
  return slice;
}
enum { KINDS = 7 };

static void middle_of(stratus_context* context, const picture_case* c, double middle[3])
{
  double bounds[6];
  assert_int_equal(stratus_volume_bounds(context, &c->volume, bounds), STRATUS_OK);
  for (int a = 0; a < 3; ++a) {
    middle[a] = 0.5 * (bounds[2 * a] + bounds[2 * a + 1]) + 0.3;
  }
}

/* A function that shows most values, so that the surface is seen as a whole. */
static void show_most(picture_case* c)
{
  const double base = case_type_values[c->volume.type].base, scale = case_type_values[c->volume.type].scale;
  const double opacity[8] = { base - scale, 0.2, base - 0.2 * scale, 0.2, base + 0.3 * scale, 0.6, base + scale, 0.9 };
  memcpy(c->opacity, opacity, sizeof opacity);
  c->options.mode = STRATUS_MODE_SLICE;
}

static void expect_reference(stratus_context* context, const picture_case* c, const char* what, int kind)
{
  int grazing = 0, far = 0;
  case_render(context, c, &drawn);
  reference_modes_render(&c->volume, &c->transfer, &c->camera, &c->options, CASE_WIDTH, CASE_HEIGHT, 0.02, expected, expected_depth);
  for (int i = 0; i < CASE_PIXELS; ++i) {
    if (fabsf(drawn.rgba[4 * i + 3] - expected[4 * i + 3]) > 0.02f) {
      memcpy(drawn.rgba + 4 * i, expected + 4 * i, 4 * sizeof *expected);
      ++grazing;
    } else if (isfinite(drawn.depth[i]) != isfinite(expected_depth[i]) ||
      (isfinite(expected_depth[i]) && (double)fabsf(drawn.depth[i] - expected_depth[i]) > DEPTH_ERROR)) {
      ++far;
    }
  }
  const double db = reference_psnr(drawn.rgba, expected, CASE_PIXELS);
  print_message(
    "             %s, surface %d: %.1f dB, %d pixels, %d grazing, %d at another depth\n", what, kind, db, case_lit(&drawn), grazing, far);
  assert_true(case_lit(&drawn) > case_share(60));
  assert_true(db >= SLICE_DB);
  assert_true(grazing + far <= (int)(GRAZING_SHARE * CASE_PIXELS));
}

static void surfaces_show_the_values_on_them(void** state)
{
  for (int kind = 0; kind < KINDS; ++kind) {
    picture_case c;
    double middle[3];
    case_create(*state, &c, kind % 2 ? STRATUS_UINT8 : STRATUS_FLOAT32, 30, 26, 28, 5u + (uint32_t)kind);
    show_most(&c);
    middle_of(*state, &c, middle);
    c.options.slice = surface(kind, middle);
    case_camera(*state, &c, kind % 8, kind == 1);
    expect_reference(*state, &c, "image", kind);
    if (kind == 2) { /* from inside the sphere */
      memcpy(c.camera.eye, middle, sizeof c.camera.eye);
      expect_reference(*state, &c, "from inside", kind);
    }
    case_destroy(&c);
  }
}

static void matrices_cells_crops_planes_and_masks(void** state)
{
  static uint8_t mask[23 * 29 * 21];
  picture_case c;
  double middle[3];
  for (size_t i = 0; i < sizeof mask; ++i) {
    mask[i] = i / 23 % 29 < 17;
  }
  case_create(*state, &c, STRATUS_FLOAT32, 23, 29, 21, 9);
  show_most(&c);
  c.volume.matrix[1] = 0.3; /* sheared and mirrored */
  c.volume.matrix[10] = -1.0;
  c.volume.cell_centered = 1;
  for (int kind = 0; kind < KINDS; kind += 2) {
    case_camera(*state, &c, (3 + kind) % 8, kind == 2);
    middle_of(*state, &c, middle);
    c.options.slice = surface(kind, middle);
    expect_reference(*state, &c, "sheared and mirrored", kind);
  }
  c.options.clipping.crop = 1;
  c.options.clipping.crop_regions = STRATUS_CROP_ALL - STRATUS_CROP_INSIDE;
  for (int a = 0; a < 3; ++a) {
    c.options.clipping.crop_bounds[2 * a] = 1.0;
    c.options.clipping.crop_bounds[2 * a + 1] = 13.0;
  }
  memcpy(&other, &drawn, sizeof other);
  expect_reference(*state, &c, "all regions but the middle one", 6);
  assert_true(reference_psnr(drawn.rgba, other.rgba, CASE_PIXELS) < 40.0);
  c.options.clipping.crop = 0;
  c.options.mask.bytes = mask;
  c.options.sampling.interpolation = STRATUS_INTERPOLATION_NEAREST;
  case_render(*state, &c, &drawn);
  const int masked = case_lit(&drawn);
  c.options.mask.bytes = NULL;
  case_render(*state, &c, &drawn);
  assert_true(masked > case_share(100) && masked < case_lit(&drawn));
  c.options.sampling.interpolation = STRATUS_INTERPOLATION_LINEAR;
  c.options.clipping.clip_plane_count = 1;
  c.options.clipping.clip_planes[0][0] = 1.0;
  c.options.clipping.clip_planes[0][3] = -middle[0];
  case_render(*state, &c, &other);
  assert_true(case_lit(&other) > case_share(100) && case_lit(&other) < case_lit(&drawn));
  case_destroy(&c);
}

static void grids_whose_spacing_changes(void** state)
{
  for (int kind = 0; kind < 3; ++kind) {
    picture_case c;
    grid_case grid;
    double middle[3];
    uint32_t none = 3;
    case_create(*state, &c, STRATUS_FLOAT32, 24, 22, 26, 4);
    show_most(&c);
    grid_case_set(&c, &grid, GRID_GEOMETRIC, 7, 0.0, 1.0, 30.0, &none);
    case_camera(*state, &c, 2 + kind, 0);
    middle_of(*state, &c, middle);
    c.options.slice = surface(kind, middle);
    expect_reference(*state, &c, "stretched 30:1", kind);
    case_destroy(&c);
  }
}

/* Far from the world's origin, where the squares of coordinates have no digits left for a sphere. */
static void a_sphere_at_utm_coordinates_is_round(void** state)
{
  picture_case c;
  double middle[3];
  case_create(*state, &c, STRATUS_FLOAT32, 30, 26, 28, 5);
  show_most(&c);
  middle_of(*state, &c, middle);
  c.options.slice = surface(2, middle);
  case_camera(*state, &c, 1, 0);
  case_render(*state, &c, &other);
  for (int a = 0; a < 3; ++a) {
    const double shift[3] = { 500000.1, 6000000.7, 200.3 };
    c.volume.origin[a] += shift[a];
    c.options.slice.center[a] += shift[a];
    c.camera.eye[a] += shift[a];
  }
  case_render(*state, &c, &drawn);
  const double db = reference_psnr(drawn.rgba, other.rgba, CASE_PIXELS);
  print_message("             %.1f dB, %d pixels\n", db, case_lit(&drawn));
  assert_true(case_lit(&drawn) > case_share(200) && db > 60.0);
  case_destroy(&c);
}

static void no_structure_thread_or_instruction_set_changes_a_bit(void** state)
{
  stratus_context* contexts[3] = { case_context("host", 1), case_context("host", 3), case_context("host", 2) };
  int lit = 0;
  (void)state;
  for (uint32_t seed = 400; seed < 430; ++seed) {
    picture_case c;
    grid_case grid;
    double middle[3];
    case_create_random(contexts[0], seed, &c);
    if (seed % 4 == 0) {
      grid_case_set_random(contexts[0], seed, &c, &grid);
    }
    c.options.mode = STRATUS_MODE_SLICE;
    c.options.sampling.jitter = seed % 3 == 0; /* moves no surface */
    middle_of(contexts[0], &c, middle);
    c.options.slice = surface((int)(seed % KINDS), middle);
    c.options.skipping.structure = STRATUS_STRUCTURE_NONE;
    case_render(contexts[0], &c, &drawn);
    c.options.sampling.jitter = 0;
    lit += case_lit(&drawn) > 0;
    for (int s = STRATUS_STRUCTURE_AUTO; s <= STRATUS_STRUCTURE_HYBRID; ++s) {
      c.options.skipping.structure = (stratus_structure)s;
      contexts[2]->isa = (int)(seed % 2);
      case_render(contexts[s % 3], &c, &other);
      if (memcmp(drawn.rgba, other.rgba, sizeof drawn.rgba) != 0 || memcmp(drawn.depth, other.depth, sizeof drawn.depth) != 0) {
        fail_msg("seed %u, %s: another picture", seed, stratus_structure_name(c.options.skipping.structure));
      }
    }
    case_destroy(&c);
  }
  print_message("             %d pictures\n", lit);
  assert_true(lit > 12);
  for (int i = 0; i < 3; ++i) {
    stratus_context_destroy(contexts[i]);
  }
}

static void what_is_no_surface_is_refused(void** state)
{
  const stratus_slice wrong[] = { { .constant = 1.0 }, { .linear = { NAN } }, { .linear = { 1 }, .center = { 0, INFINITY } },
    { .square = { 0, 0, 0, 0, 0, -INFINITY } } };
  static const char* const words[] = { "no surface", "linear has nan", "center has inf", "square has -inf" };
  picture_case c;
  stratus_ray_caster* caster = NULL;
  case_create(*state, &c, STRATUS_FLOAT32, 8, 8, 8, 8);
  const stratus_image image = { .width = CASE_WIDTH, .height = CASE_HEIGHT, .rgba = drawn.rgba };
  c.options.mode = STRATUS_MODE_SLICE;
  assert_int_equal(stratus_ray_caster_create(*state, &caster), STRATUS_OK);
  for (int i = 0; i < 4; ++i) {
    c.options.slice = wrong[i];
    assert_int_equal(
      stratus_ray_caster_render(caster, &c.volume, &c.transfer, &c.camera, &c.options, &image, NULL), STRATUS_INVALID_ARGUMENT);
    assert_non_null(strstr(stratus_context_message(*state), words[i]));
  }
  stratus_ray_caster_destroy(caster);
  case_destroy(&c);
}

int test_ray_slice(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(surfaces_show_the_values_on_them),
    cmocka_unit_test(matrices_cells_crops_planes_and_masks),
    cmocka_unit_test(grids_whose_spacing_changes),
    cmocka_unit_test(a_sphere_at_utm_coordinates_is_round),
    cmocka_unit_test(no_structure_thread_or_instruction_set_changes_a_bit),
    cmocka_unit_test(what_is_no_surface_is_refused),
  };
  return cmocka_run_group_tests(tests, case_set_up, case_tear_down);
}
