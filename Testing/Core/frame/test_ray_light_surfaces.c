/* SPDX-License-Identifier: BSD-3-Clause
 * Shadows of opaque surfaces on volumes, compared with the double reference, in which a line from each sample to each light meets each
 * triangle. */
#include "picture_case.h"

#include "base.h"
#include "testing.h"

static picture drawn;
static picture other;
static picture kept;
static float reference[4 * CASE_PIXELS_MOST];

/* The reference draws one pixel of each tile of so many. */
#define TILE (few_run() ? 4 : 3)

/* A quad in two triangles. */
static void set_quad(double points[18], const double a[3], const double b[3], const double c[3], const double d[3])
{
  const double* corners[6] = { a, b, c, a, c, d };
  for (int i = 0; i < 6; ++i) {
    memcpy(points + 3 * i, corners[i], 3 * sizeof *points);
  }
}

/* A case that is lit by scattered light alone, and a slanting plate that is between one half of the matter and the light. */
static void make_case(stratus_context* context, picture_case* c, stratus_surfaces* surfaces, double points[18])
{
  static const double corners[4][3] = { { 15, -20, 33 }, { 70, -20, 50 }, { 70, 60, 50 }, { 15, 60, 33 } };
  case_create(context, c, STRATUS_FLOAT32, 30, 26, 28, 5);
  c->options.light.shade = 1;
  set_quad(points, corners[0], corners[1], corners[2], corners[3]);
  *surfaces = (stratus_surfaces){ .points = points, .triangle_count = 2 };
  stratus_shading* s = &c->options.light.shading;
  s->ambient = 0.0;
  s->diffuse = 1.0;
  s->specular = 0.0;
  s->shadows = 1;
  s->scattering = 1.0;
  s->light_count = 1;
  s->lights[0] = (stratus_light){ .vector = { 1, -1, 4 }, .color = { 1, 0.9, 0.8 } };
  s->surfaces = surfaces;
}

/* Draws the case, and returns how many dB it is from the reference in the pixels that this draws. */
static double compare(const char* what, stratus_context* context, const picture_case* c)
{
  reference_scene scene = case_scene(c);
  double reference_db = 0.0;
  int picked = 0;
  scene.shading = &c->options.light.shading;
  scene.tile = TILE;
  case_render(context, c, &drawn);
  assert_int_equal(reference_converged(&scene, CASE_WIDTH, CASE_HEIGHT, 50.0, reference, NULL, &reference_db), 0);
  for (int i = 0; i < CASE_PIXELS; ++i) {
    const int shown = reference_picks(TILE, i % CASE_WIDTH, i / CASE_WIDTH);
    for (int k = 0; k < 4; ++k) {
      other.rgba[4 * i + k] = shown ? drawn.rgba[4 * i + k] : 0.0f;
    }
    picked += other.rgba[4 * i + 3] > 0.0f;
  }
  const double db = reference_psnr(other.rgba, reference, CASE_PIXELS);
  print_message("             %s: %.1f dB, reference %.0f dB, %d pixels, light %.2g by %zu bytes\n", what, db, reference_db, picked,
    drawn.report.light_error, drawn.report.light_bytes);
  assert_true(picked > (few_run() ? 3 : 10));
  return db;
}

static void surfaces_shadow_matter_as_the_reference_says(void** state)
{
  (void)state;
  stratus_context* context = case_context("host", 2);
  stratus_surfaces surfaces;
  picture_case c;
  double points[18];
  make_case(context, &c, &surfaces, points);
  stratus_light* light = c.options.light.shading.lights;
  /* 46: a hard edge is seen at samples a quarter of a voxel apart, each of up to .1 of a pixel */
  assert_true(compare("a direction", context, &c) > 46.0);
  c.options.light.shading.surfaces = NULL;
  case_render(context, &c, &other);
  c.options.light.shading.surfaces = &surfaces;
  assert_true(reference_psnr(other.rgba, drawn.rgba, CASE_PIXELS) < 30.0);
  *light = (stratus_light){ .vector = { 20, -10, 80 }, .color = { 1, 0.9, 0.8 }, .positional = 1 };
  assert_true(compare("a position", context, &c) > 46.0);
  static const double corners[4][3] = { { 4, 4, 18 }, { 24, 4, 15 }, { 24, 15, 15 }, { 4, 15, 18 } };
  set_quad(points, corners[0], corners[1], corners[2], corners[3]);
  surfaces.revision = 1;
  *light = (stratus_light){ .vector = { 16, 11, 21 }, .color = { 1, 0.9, 0.8 }, .positional = 1 };
  assert_true(compare("a lamp and a plate in the volume", context, &c) > 42.0);
  c.options.light.shading.scattering = 0.3;
  c.options.light.shading.specular = 0.4;
  if (!few_run()) {
    assert_true(compare("reflected, too", context, &c) > 42.0);
  }
  case_destroy(&c);
  stratus_context_destroy(context);
}

/* Surfaces change without the maps of the matter, and their pictures come back to the bit. A number that is not finite is an error that
 * leaves the picture as it was. */
static void surfaces_change_alone(void** state)
{
  (void)state;
  stratus_context* context = case_context("host", 2);
  stratus_ray_caster* caster = NULL;
  stratus_ray_cast_report report;
  stratus_surfaces surfaces;
  picture_case c;
  double points[18];
  make_case(context, &c, &surfaces, points);
  assert_int_equal(stratus_ray_caster_create(context, &caster), STRATUS_OK);
  const stratus_image image = { .width = CASE_WIDTH, .height = CASE_HEIGHT, .rgba = drawn.rgba };
  const stratus_image again = { .width = CASE_WIDTH, .height = CASE_HEIGHT, .rgba = other.rgba };
  c.options.light.shading.surfaces = NULL;
  assert_int_equal(stratus_ray_caster_render(caster, &c.volume, &c.transfer, &c.camera, &c.options, &image, &report), STRATUS_OK);
  const uint64_t bytes = report.light_bytes;
  c.options.light.shading.surfaces = &surfaces;
  assert_int_equal(stratus_ray_caster_render(caster, &c.volume, &c.transfer, &c.camera, &c.options, &again, &report), STRATUS_OK);
  assert_true(memcmp(drawn.rgba, other.rgba, sizeof drawn.rgba) != 0);
  assert_int_equal(report.light_builds, 1);
  assert_true(report.light_bytes > bytes);
  points[0] = NAN;
  surfaces.revision = 1;
  memcpy(kept.rgba, other.rgba, sizeof other.rgba);
  assert_int_equal(
    stratus_ray_caster_render(caster, &c.volume, &c.transfer, &c.camera, &c.options, &again, &report), STRATUS_INVALID_ARGUMENT);
  assert_non_null(strstr(stratus_context_message(context), "triangle 0 of the surfaces has the coordinate nan"));
  assert_memory_equal(kept.rgba, other.rgba, sizeof drawn.rgba);
  for (int multiple = 0; multiple < 2; ++multiple) { /* light that is scattered again meets surfaces before all other light does */
    const stratus_surfaces missing = { .triangle_count = 1 };
    c.options.light.shading.multiple = multiple;
    c.options.light.shading.surfaces = &missing;
    assert_int_equal(
      stratus_ray_caster_render(caster, &c.volume, &c.transfer, &c.camera, &c.options, &again, &report), STRATUS_INVALID_ARGUMENT);
    assert_non_null(strstr(stratus_context_message(context), "surfaces of 1 triangles have no points"));
  }
  c.options.light.shading.multiple = 0;
  c.options.light.shading.surfaces = &surfaces;
  points[0] = 15.0;
  surfaces.revision = 2;
  c.options.light.shading.light_count = 0; /* nothing to hide */
  assert_int_equal(stratus_ray_caster_render(caster, &c.volume, &c.transfer, &c.camera, &c.options, &again, &report), STRATUS_OK);
  c.options.light.shading.light_count = 1;
  c.options.light.shading.surfaces = NULL;
  assert_int_equal(stratus_ray_caster_render(caster, &c.volume, &c.transfer, &c.camera, &c.options, &again, &report), STRATUS_OK);
  const uint64_t builds = report.light_builds;
  c.options.light.shading.surfaces = &surfaces;
  surfaces.triangle_count = 0;
  assert_int_equal(stratus_ray_caster_render(caster, &c.volume, &c.transfer, &c.camera, &c.options, &again, &report), STRATUS_OK);
  assert_memory_equal(drawn.rgba, other.rgba, sizeof drawn.rgba);
  assert_int_equal(report.light_builds, builds);
  assert_int_equal(report.light_bytes, bytes);
  stratus_ray_caster_destroy(caster);
  case_destroy(&c);
  stratus_context_destroy(context);
}

/* Gives every second triangle of a mesh over a square, of which each cell has two. */
static size_t set_mesh(double* points, int cells, double size, double height)
{
  size_t count = 0;
  for (int i = 0; i < cells * cells; ++i) {
    const double x = size * (i % cells) / cells - 10.0, y = size * (double)(i / cells) / cells - 10.0, step = size / cells;
    const double a[3] = { x, y, height }, b[3] = { x + step, y, height }, e[3] = { x + step, y + step, height };
    const double d[3] = { x, y + step, height };
    set_quad(points + 9 * count, a, b, e, d);
    count += 2;
  }
  return count;
}

/* In the shadow of a whole surface nothing is lit, of any grid and mode, also after many scatterings; small triangles leave no gap between
 * them. Behind the matter, and behind the lamp, a surface hides nothing. */
static void a_whole_surface_hides_a_light(void** state)
{
  (void)state;
  stratus_context* context = case_context("host", 2);
  stratus_surfaces surfaces;
  picture_case c;
  double* points = malloc((size_t)2 * 97 * 97 * 9 * sizeof *points);
  assert_non_null(points);
  make_case(context, &c, &surfaces, points);
  stratus_shading* s = &c.options.light.shading;
  for (int turn = 0; turn < 5; ++turn) {
    s->lights[0] = turn == 1 || turn == 4
      ? (stratus_light){ .vector = { 13, 15, turn == 1 ? 60 : 14 }, .color = { 1, 1, 1 }, .positional = 1 }
      : (stratus_light){ .vector = { 0.2, 0.1, 1 }, .color = { 1, 1, 1 } };
    s->multiple = turn == 2;
    c.options.mode = turn == 3 ? STRATUS_MODE_ISOSURFACE : STRATUS_MODE_COMPOSITE;
    c.options.optics.contour_count = 1;
    c.options.optics.contours[0] = c.opacity[4];
    for (int side = 0; side < 2; ++side) { /* between light and matter, and behind the matter; of the lamp in the matter, far behind it */
      surfaces.triangle_count = set_mesh(points, few_run() ? 31 : 97, 60.0, side || turn == 4 ? -40.0 : 40.0);
      ++surfaces.revision;
      case_render(context, &c, &drawn);
      double most = 0.0;
      for (int i = 0; i < CASE_PIXELS; ++i) {
        for (int k = 0; k < 3; ++k) {
          most = fmax(most, (double)drawn.rgba[4 * i + k]);
        }
      }
      if (side || turn == 4) {
        stratus_surfaces none = { .triangle_count = 0 };
        s->surfaces = &none;
        case_render(context, &c, &other);
        s->surfaces = &surfaces;
        assert_memory_equal(drawn.rgba, other.rgba, sizeof drawn.rgba);
        assert_true(most > 0.02);
      } else {
        assert_true(most == 0.0);
      }
    }
  }
  free(points);
  case_destroy(&c);
  stratus_context_destroy(context);
}

/* Tetrahedra between the same values, and several volumes, take the same shadows. */
static void other_grids_take_the_same_shadows(void** state)
{
  (void)state;
  stratus_context* context = case_context("host", 2);
  stratus_surfaces surfaces;
  picture_case c, none;
  double plate[18];
  make_case(context, &c, &surfaces, plate);
  c.options.sampling.tolerance = 0.004;
  const int64_t* n = c.volume.dimensions;
  double* points = malloc((size_t)(n[0] * n[1] * n[2]) * 3 * sizeof *points);
  assert_non_null(points);
  for (int64_t i = 0; i < n[0] * n[1] * n[2]; ++i) {
    points[3 * i] = (double)(i % n[0]);
    points[3 * i + 1] = (double)(i / n[0] % n[1]);
    points[3 * i + 2] = (double)(i / n[0] / n[1]);
  }
  stratus_mesh mesh = stratus_mesh_default();
  mesh.points = points;
  mesh.point_count = n[0] * n[1] * n[2];
  mesh.values = c.values;
  mesh.type = STRATUS_FLOAT32;
  mesh.cell_count = (n[0] - 1) * (n[1] - 1) * (n[2] - 1);
  for (int a = 0; a < 3; ++a) {
    mesh.lattice[a] = (int32_t)n[a];
  }
  stratus_tetra_options options = stratus_tetra_options_default();
  options.shade = 1;
  options.tolerance = 0.004;
  options.shading = c.options.light.shading;
  stratus_tetra_caster* mesh_caster = NULL;
  stratus_ray_caster *empty = NULL, *caster = NULL;
  const stratus_image image = { .width = CASE_WIDTH, .height = CASE_HEIGHT, .rgba = other.rgba };
  assert_int_equal(stratus_tetra_caster_create(context, &mesh_caster), STRATUS_OK);
  assert_int_equal(stratus_ray_caster_create(context, &empty), STRATUS_OK);
  assert_int_equal(stratus_ray_caster_create(context, &caster), STRATUS_OK);
  case_create(context, &none, STRATUS_FLOAT32, 2, 2, 2, 5);
  memset(none.opacity, 0, sizeof none.opacity);
  for (int i = 0; i < 4; ++i) {
    none.opacity[2 * i] = i;
  }
  case_render(context, &c, &drawn);
  assert_int_equal(stratus_tetra_caster_render(mesh_caster, &mesh, &c.transfer, &c.camera, &options, &image, NULL), STRATUS_OK);
  const double of_mesh = reference_psnr(other.rgba, drawn.rgba, CASE_PIXELS);
  stratus_ray_cast_input inputs[2] = { { .caster = empty, .volume = &none.volume, .transfer = &none.transfer },
    { .caster = caster, .volume = &c.volume, .transfer = &c.transfer, .options = &c.options } };
  assert_int_equal(stratus_ray_caster_render_several(inputs, 2, &c.camera, &image, NULL), STRATUS_OK);
  const double of_several = reference_psnr(other.rgba, drawn.rgba, CASE_PIXELS);
  inputs[1] = (stratus_ray_cast_input){ .tetra = mesh_caster, .mesh = &mesh, .transfer = &c.transfer, .tetra_options = &options };
  assert_int_equal(stratus_ray_caster_render_several(inputs, 2, &c.camera, &image, NULL), STRATUS_OK);
  const double of_both = reference_psnr(other.rgba, drawn.rgba, CASE_PIXELS);
  print_message(
    "             a mesh: %.1f dB, several: %.1f dB, a mesh of several: %.1f dB from the image\n", of_mesh, of_several, of_both);
  assert_true(of_mesh > 40.0 && of_several > 40.0 && of_both > 40.0);
  stratus_ray_caster_destroy(caster);
  stratus_ray_caster_destroy(empty);
  stratus_tetra_caster_destroy(mesh_caster);
  free(points);
  case_destroy(&none);
  case_destroy(&c);
  stratus_context_destroy(context);
}

/* The length of a line inside a box with a corner at 0. */
static double chord(const double size[3], const double from[3], const double way[3])
{
  double near = 0.0, far = (double)INFINITY;
  for (int a = 0; a < 3; ++a) {
    const double low = (0.0 - from[a]) / way[a], high = (size[a] - from[a]) / way[a];
    near = fmax(near, fmin(low, high));
    far = fmin(far, fmax(low, high));
  }
  return fmax(far - near, 0.0);
}

/* The part of the lights, by Beer's law, that an even box leaves to a place of the floor: by their brightness and cosines. */
static double part_of_lights(const stratus_shading* shading, const double size[3], double x, double y, double z, double passes)
{
  const double place[3] = { x, y, z };
  double sum = 0.0, all = 0.0;
  for (int n = 0; n < shading->light_count; ++n) {
    const stratus_light* light = &shading->lights[n];
    double way[3], length = 0.0;
    for (int a = 0; a < 3; ++a) {
      way[a] = light->vector[a] - (light->positional ? place[a] : 0.0);
      length += way[a] * way[a];
    }
    length = sqrt(length);
    const double bright = (light->color[0] + light->color[1] + light->color[2]) * way[2] / length;
    sum += bright * pow(passes, chord(size, place, way) * length);
    all += bright;
  }
  return sum / all;
}

/* An even box above a floor that the camera sees from above: each pixel's opacity is the box's, and what Beer's law takes from the light on
 * its way to the floor. */
static void matter_shadows_surfaces_by_beers_law(void** state)
{
  static double opacity[4] = { 0.0, 0.06, 1.0, 0.06 }, color[4] = { 0.0, 1.0, 1.0, 1.0 };
  static float ends[CASE_PIXELS_MOST];
  static uint8_t bytes[4 * CASE_PIXELS_MOST];
  (void)state;
  stratus_context* context = case_context("host", 2);
  stratus_ray_caster* caster = NULL;
  stratus_surfaces surfaces;
  picture_case c;
  double points[18];
  make_case(context, &c, &surfaces, points);
  const double size[3] = { 29, 25, 27 }, floor_height = -4.0;
  for (int i = 0; i < 30 * 26 * 28; ++i) {
    ((float*)c.values)[i] = 0.5f;
  }
  c.transfer.opacity = opacity;
  c.transfer.opacity_count = 2;
  c.transfer.color = color;
  c.transfer.color_count = 1;
  c.transfer.unit_distance = 1.0;
  c.options.light.shading.surfaces = NULL;
  c.camera = (stratus_camera){
    .eye = { 14, 12, 60 }, .forward = { 0, 0, -1 }, .right = { 45, 0, 0 }, .up = { 0, 40, 0 }, .near_k = 10.0, .far_k = 100.0, .parallel = 1
  };
  for (int i = 0; i < CASE_PIXELS; ++i) {
    ends[i] = (float)((60.0 - floor_height - 10.0) / 90.0);
  }
  const stratus_image image = { .width = CASE_WIDTH, .height = CASE_HEIGHT, .rgba = drawn.rgba, .rgba8 = bytes, .opaque_depth = ends };
  assert_int_equal(stratus_ray_caster_create(context, &caster), STRATUS_OK);
  stratus_shading* shading = &c.options.light.shading;
  for (int lamp = 0; lamp < 3; ++lamp) { /* a direction; a position; both, of which the first faces the floor at a greater angle */
    const stratus_light lights[2] = { { .vector = { 2, 1, 3 }, .color = { 1, 2, 3 } },
      { .vector = { -30, 20, 90 }, .color = { 0.5, 0.5, 0.5 }, .positional = 1 } };
    shading->light_count = lamp == 2 ? 2 : 1;
    memcpy(shading->lights, lights + (lamp == 1), (size_t)shading->light_count * sizeof *lights);
    assert_int_equal(stratus_ray_caster_render(caster, &c.volume, &c.transfer, &c.camera, &c.options, &image, NULL), STRATUS_OK);
    memcpy(other.rgba, drawn.rgba, sizeof drawn.rgba);
    const stratus_ray_cast_input input = { caster, &c.volume, &c.transfer, &c.options, NULL, NULL, NULL };
    assert_int_equal(stratus_ray_caster_shade_surfaces(&input, 1, &c.camera, &image), STRATUS_OK);
    double squares = 0.0, shadow = 0.0, edges = 0.0, worst = 0.0;
    for (int i = 0; i < CASE_PIXELS; ++i) {
      const double u = (2.0 * (i % CASE_WIDTH) + 1.0) / CASE_WIDTH - 1.0, v = (2.0 * (double)(i / CASE_WIDTH) + 1.0) / CASE_HEIGHT - 1.0;
      const double x = 14.0 + 45.0 * u, y = 12.0 + 40.0 * v, part = part_of_lights(shading, size, x, y, floor_height, 0.94);
      double apart = 0.0; /* where the box's sides end the shadow, nodes blur it */
      for (int side = 0; side < 4; ++side) {
        const double step = side & 1 ? 1.5 : -1.5;
        const double beside = part_of_lights(shading, size, x + (side < 2 ? step : 0.0), y + (side < 2 ? 0.0 : step), floor_height, 0.94);
        apart = fmax(apart, fabs(beside - part));
      }
      const double off = 1.0 - (1.0 - (double)other.rgba[4 * i + 3]) * part - (double)drawn.rgba[4 * i + 3];
      squares += apart < 0.1 ? off * off : 0.0;
      edges += apart >= 0.1;
      worst = fmax(worst, fabs(off));
      shadow += part < 0.9;
      assert_memory_equal(&other.rgba[4 * i], &drawn.rgba[4 * i], 3 * sizeof(float));
      assert_true(abs(bytes[4 * i + 3] - (int)(255.0f * drawn.rgba[4 * i + 3] + 0.5f)) == 0);
    }
    print_message("             lights %d: %.2g off, %.2g at edges, %.0f pixels in the shadow, %.0f at edges\n", lamp,
      sqrt(squares / (CASE_PIXELS - edges)), worst, shadow, edges);
    assert_true(sqrt(squares / (CASE_PIXELS - edges)) < 0.004 && worst < 0.5);
    assert_true(shadow > 0.05 * CASE_PIXELS && edges < 0.15 * CASE_PIXELS);
  }
  memcpy(other.rgba, drawn.rgba, sizeof drawn.rgba);
  shading->shadows = 0;
  const stratus_ray_cast_input input = { caster, &c.volume, &c.transfer, &c.options, NULL, NULL, NULL };
  assert_int_equal(stratus_ray_caster_shade_surfaces(&input, 1, &c.camera, &image), STRATUS_OK);
  assert_memory_equal(other.rgba, drawn.rgba, sizeof drawn.rgba);
  assert_int_equal(stratus_ray_caster_shade_surfaces(NULL, 1, &c.camera, &image), STRATUS_INVALID_ARGUMENT);
  stratus_ray_caster_destroy(caster);
  case_destroy(&c);
  stratus_context_destroy(context);
}

int test_ray_light_surfaces(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(surfaces_shadow_matter_as_the_reference_says),
    cmocka_unit_test(surfaces_change_alone),
    cmocka_unit_test(a_whole_surface_hides_a_light),
    cmocka_unit_test(other_grids_take_the_same_shadows),
    cmocka_unit_test(matter_shadows_surfaces_by_beers_law),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
