/* SPDX-License-Identifier: BSD-3-Clause
 * Layers that are drawn together, as maps of light are, compared with pictures of one layer each. */
#include "picture_case.h"

#include "matrix.h"
#include "ray_caster.h"
#include "testing.h"
#include "tetra_case.h"
#include "tetra_caster.h"

/* A number that divides neither the picture nor the volume evenly. */
#define LAYERS 7
/* Of a sample that two layers share, each has a part, whose middle may be rounded into another voxel or over an edge of the function. */
#define LEAST_DB 70.0

static float together[LAYERS * 4 * CASE_PIXELS_MOST], apart[4 * CASE_PIXELS_MOST];

/* Limits a camera to the box, and leaves out its first and last tenth. */
static void look_at(stratus_camera* camera, const double bounds[6])
{
  double lo = INFINITY, hi = -INFINITY, square = 0.0;
  for (int corner = 0; corner < 8; ++corner) {
    double k = 0.0;
    square = 0.0;
    for (int axis = 0; axis < 3; ++axis) {
      k += (bounds[2 * axis + (corner >> axis & 1)] - camera->eye[axis]) * camera->forward[axis];
      square += camera->forward[axis] * camera->forward[axis];
    }
    lo = fmin(lo, k / square);
    hi = fmax(hi, k / square);
  }
  lo = camera->parallel ? lo : fmax(lo, 0.0);
  camera->near_k = lo + 0.1 * (hi - lo);
  camera->far_k = hi - 0.1 * (hi - lo);
}

static stratus_camera part_of(const stratus_camera* all, int layer)
{
  stratus_camera camera = *all;
  camera.near_k = all->near_k + (all->far_k - all->near_k) * layer / LAYERS;
  camera.far_k = all->near_k + (all->far_k - all->near_k) * (layer + 1) / LAYERS;
  return camera;
}

/* Compares a layer, and returns whether it shows anything. */
static bool is_alike(size_t pixels, int layer, const char* what)
{
  const float* here = together + 4 * (size_t)layer * pixels;
  const double db = reference_psnr(here, apart, pixels);
  bool shows = false;
  for (size_t i = 0; i < pixels; ++i) {
    shows = shows || apart[4 * i + 3] > 0.0f;
  }
  if (!(db > LEAST_DB)) {
    fail_msg("%s, layer %d: %.1f dB from the layer by itself", what, layer, db);
  }
  return shows;
}

static void draw_volume(stratus_context* context, picture_case* c, const char* what)
{
  const stratus_image all = { .width = CASE_WIDTH, .height = CASE_HEIGHT, .rgba = together },
                      one = { .width = CASE_WIDTH, .height = CASE_HEIGHT, .rgba = apart };
  stratus_ray_caster* caster = NULL;
  stratus_ray_cast_report report;
  double bounds[6];
  int shown = 0;
  c->options.sampling.termination = 1.0; /* else a ray that is opaque ends, and so do its layers */
  assert_int_equal(stratus_volume_bounds(context, &c->volume, bounds), STRATUS_OK);
  look_at(&c->camera, bounds);
  assert_int_equal(stratus_ray_caster_create(context, &caster), STRATUS_OK);
  caster->layers = LAYERS;
  memset(together, 255, sizeof together);
  assert_int_equal(stratus_ray_caster_render(caster, &c->volume, &c->transfer, &c->camera, &c->options, &all, &report), STRATUS_OK);
  caster->layers = 0;
  for (int layer = 0; layer < LAYERS; ++layer) {
    const stratus_camera part = part_of(&c->camera, layer);
    assert_int_equal(stratus_ray_caster_render(caster, &c->volume, &c->transfer, &part, &c->options, &one, &report), STRATUS_OK);
    shown += is_alike(CASE_PIXELS, layer, what);
  }
  assert_true(shown > 1);
  stratus_ray_caster_destroy(caster);
}

/* Of any grid, type, rule and camera, cropped, clipped, with holes. */
static void layers_of_volumes_are_alike(void** state)
{
  (void)state;
  stratus_context* context = case_context("host", 2);
  for (uint32_t seed = 1; seed < 40; seed += few_run() ? 4 : 1) {
    picture_case c;
    char what[32];
    case_create_random(context, seed, &c);
    c.options.clipping.clip_plane_count = 0; /* some leave nothing to be seen */
    c.options.clipping.crop = 0;
    case_camera(context, &c, (int)(seed % 8), (int)(seed % 2));
    snprintf(what, sizeof what, "random %u", seed);
    draw_volume(context, &c, what);
    case_destroy(&c);
  }
  for (uint32_t seed = 1; seed < 7; seed += few_run() ? 2 : 1) {
    picture_case c;
    char what[32];
    case_create_local(context, seed, &c);
    snprintf(what, sizeof what, "local %u", seed);
    draw_volume(context, &c, what);
    case_destroy(&c);
  }
  stratus_context_destroy(context);
}

static void layers_of_parts_and_surfaces_are_alike(void** state)
{
  (void)state;
  stratus_context* context = case_context("host", 2);
  for (int kind = 0; kind < 4; ++kind) {
    static const char* const names[] = { "crop regions", "clipped", "isosurface", "opaque" };
    picture_case c;
    case_create(context, &c, STRATUS_FLOAT32, 30, 26, 28, 5);
    if (kind == 0) {
      c.options.clipping.crop = 1;
      c.options.clipping.crop_regions = 0x5a5a5a5u;
      memcpy(c.options.clipping.crop_bounds, (const double[6]){ 6, 14, 7, 15, 9, 17 }, sizeof c.options.clipping.crop_bounds);
    } else if (kind == 1) {
      c.options.clipping.clip_plane_count = 1;
      memcpy(c.options.clipping.clip_planes[0], (const double[4]){ 0.3, -0.5, 0.8, -6.0 }, 4 * sizeof(double));
    } else if (kind == 2) {
      c.options.mode = STRATUS_MODE_ISOSURFACE;
      c.options.optics.contour_count = 2;
      c.options.optics.contours[0] = case_type_values[STRATUS_FLOAT32].base;
      c.options.optics.contours[1] = case_type_values[STRATUS_FLOAT32].base + 0.3 * case_type_values[STRATUS_FLOAT32].scale;
    } else {
      for (size_t i = 0; i < c.transfer.opacity_count; ++i) {
        c.opacity[2 * i + 1] = i > 1 ? 1.0 : c.opacity[2 * i + 1];
      }
    }
    draw_volume(context, &c, names[kind]);
    case_destroy(&c);
  }
  stratus_context_destroy(context);
}

/* Of meshes with hollows, so that rays come in several times, and of large cells that are in several layers. */
static void layers_of_meshes_are_alike(void** state)
{
  (void)state;
  stratus_context* context = case_context("host", 2);
  for (uint32_t seed = 0; seed < 16; seed += few_run() ? 3 : 1) {
    const stratus_image all = { .width = TETRA_WIDTH, .height = TETRA_HEIGHT, .rgba = together },
                        one = { .width = TETRA_WIDTH, .height = TETRA_HEIGHT, .rgba = apart };
    tetra_case c;
    double bounds[6], lo[3], hi[3];
    char what[32];
    int shown = 0;
    stratus_tetra_caster* caster = NULL;
    tetra_create(&c, 2 + (int)(seed % 5), 0.2, seed % 3 ? 0.3 : 0.0, seed);
    c.mesh.cell_values = seed % 4 == 3;
    tetra_camera(context, &c, 2 + (int)(seed % 5), (int)(seed % 8), (int)(seed & 1));
    if (seed % 5 == 4) {
      c.options.mode = STRATUS_TETRA_ISOSURFACE;
      c.options.contour_count = 2;
      c.options.contours[0] = 0.4;
      c.options.contours[1] = 0.55;
    }
    if (seed % 4 == 2) {
      c.options.clip_plane_count = 1;
      memcpy(c.options.clip_planes[0], (const double[4]){ 0.3, -0.5, 0.8, -0.4 }, 4 * sizeof(double));
    }
    assert_true(stratus_tetra_box(&c.mesh, lo, hi));
    stratus_matrix_box(c.mesh.matrix, lo, hi, bounds);
    look_at(&c.camera, bounds);
    assert_int_equal(stratus_tetra_caster_create(context, &caster), STRATUS_OK);
    caster->layers = LAYERS;
    memset(together, 0, sizeof together);
    assert_int_equal(stratus_tetra_caster_render(caster, &c.mesh, &c.transfer, &c.camera, &c.options, &all, NULL), STRATUS_OK);
    caster->layers = 0;
    for (int layer = 0; layer < LAYERS; ++layer) {
      const stratus_camera part = part_of(&c.camera, layer);
      assert_int_equal(stratus_tetra_caster_render(caster, &c.mesh, &c.transfer, &part, &c.options, &one, NULL), STRATUS_OK);
      snprintf(what, sizeof what, "mesh %u", seed);
      shown += is_alike(TETRA_PIXELS, layer, what);
    }
    assert_true(shown > 1);
    stratus_tetra_caster_destroy(caster);
    tetra_destroy(&c);
  }
  stratus_context_destroy(context);
}

int test_layers(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(layers_of_volumes_are_alike),
    cmocka_unit_test(layers_of_parts_and_surfaces_are_alike),
    cmocka_unit_test(layers_of_meshes_are_alike),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
