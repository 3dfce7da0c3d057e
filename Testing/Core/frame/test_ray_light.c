/* SPDX-License-Identifier: BSD-3-Clause
 * Shadows and scattering, compared with the double reference, in which a ray goes from each sample to each light. */
#include "picture_case.h"

#include "base.h"
#include "ray_caster.h"
#include "testing.h"
#include "tetra_caster.h"

static picture drawn;
static picture other;
static picture kept;
static float reference[4 * CASE_PIXELS_MOST];

/* The reference draws one pixel of each tile of so many: each of its samples has rays of its own. */
#define TILE (few_run() ? 4 : 5)
/* Limit in dB: maps keep half of the tolerance, 1e-3, and samples are a quarter of a voxel apart. */
#define LEAST_DB 56.0

/* A case that is lit by scattered light alone, from one side. */
static void make_case(stratus_context* context, picture_case* c, stratus_type type)
{
  case_create(context, c, type, 30, 26, 28, 5);
  c->options.light.shade = 1;
  stratus_shading* s = &c->options.light.shading;
  s->ambient = 0.0;
  s->diffuse = 1.0;
  s->specular = 0.0;
  s->shadows = 1;
  s->scattering = 1.0;
  s->light_count = 1;
  s->lights[0] = (stratus_light){ .vector = { 3, -1, 2 }, .color = { 1, 0.9, 0.8 } };
}

static double compare(const char* what, stratus_context* context, const picture_case* c, double wanted)
{
  reference_scene scene = case_scene(c);
  double reference_db = 0.0;
  int picked = 0;
  scene.shading = &c->options.light.shading;
  scene.tile = TILE;
  case_render(context, c, &drawn);
  assert_int_equal(reference_converged(&scene, CASE_WIDTH, CASE_HEIGHT, 54.0, reference, NULL, &reference_db), 0);
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
  assert_true(db >= wanted);
  return db;
}

static void matter_shadows_itself_as_the_reference_says(void** state)
{
  (void)state;
  stratus_context* context = case_context("host", 2);
  picture_case c;
  make_case(context, &c, STRATUS_FLOAT32);
  stratus_shading* s = &c.options.light.shading;
  compare("scattered evenly", context, &c, LEAST_DB);
  s->shadow_length = 6.0;
  compare("shadows of 6 voxels", context, &c, 46.0); /* without near rays */
  memcpy(kept.rgba, drawn.rgba, sizeof drawn.rgba);
  s->shadow_length = 1e6;
  compare("shadows longer than the volume", context, &c, 46.0);
  assert_true(reference_psnr(kept.rgba, drawn.rgba, CASE_PIXELS) < 30.0);
  s->shadow_length = 1e-300; /* no place is so near to another */
  case_render(context, &c, &drawn);
  s->shadows = 0;
  case_render(context, &c, &kept);
  assert_true(reference_psnr(kept.rgba, drawn.rgba, CASE_PIXELS) > 80.0);
  s->shadows = 1;
  s->shadow_length = 0.0;
  s->anisotropy = 0.7;
  if (!few_run()) {
    compare("scattered forward", context, &c, LEAST_DB);
  }
  s->anisotropy = -0.4;
  s->light_count = 2;
  s->lights[1] = (stratus_light){ .vector = { 60, 50, -40 }, .color = { 0.3, 0.5, 1.5 }, .positional = 1 };
  if (!few_run()) { /* the lamp in the volume is another position, of the same two lights */
    compare("a direction and a position", context, &c, LEAST_DB);
    s->shadow_length = 8.0;
    compare("shadows of 8 voxels from both", context, &c, 46.0);
    s->shadow_length = 0.0;
  }
  s->lights[1].vector[0] = 16.0;
  s->lights[1].vector[1] = 11.0;
  s->lights[1].vector[2] = 13.0;
  compare("a lamp in the volume", context, &c, 50.0);
  s->scattering = 0.0;
  s->ambient = 0.1;
  s->specular = 0.3;
  s->lights[1].vector[2] = 60.0;
  compare("reflected", context, &c, LEAST_DB);
  s->scattering = 0.4;
  if (!few_run()) {
    compare("both", context, &c, LEAST_DB);
  }
  case_destroy(&c);
  stratus_context_destroy(context);
}

/* A dense ball above a dense plate, in a bone-like function: matter that hides itself within a voxel. */
static void make_ball(stratus_context* context, picture_case* c)
{
  static double opacity[8] = { 0.0, 0.0, 0.4, 0.0, 0.6, 0.9, 1.0, 0.97 };
  static double color[4] = { 0.0, 1.0, 0.9, 0.7 };
  make_case(context, c, STRATUS_FLOAT32);
  float* values = c->values;
  for (int z = 0; z < 28; ++z) {
    for (int y = 0; y < 26; ++y) {
      for (int x = 0; x < 30; ++x) {
        const double ball = 8.0 - sqrt((x - 15) * (x - 15) + (y - 13) * (y - 13) + (z - 18) * (z - 18)), plate = 5.0 - z;
        values[(z * 26 + y) * 30 + x] = (float)fmin(fmax(0.5 + 0.25 * fmax(ball, plate), 0.0), 1.0);
      }
    }
  }
  c->transfer.opacity = opacity;
  c->transfer.opacity_count = 4;
  c->transfer.color = color;
  c->transfer.color_count = 1;
  c->options.sampling.rule = STRATUS_SAMPLING_AUTO;
  c->options.sampling.distance = 0.0;
  c->options.sampling.termination = 0.0;
}

/* Matter that is opaque over a voxel: rays pass the near part of it by themselves, and the expected error holds. */
static void dense_matter_shadows_itself_and_what_is_behind(void** state)
{
  (void)state;
  stratus_context* context = case_context("host", 2);
  picture_case c;
  make_ball(context, &c);
  for (int lamp = 0; lamp < 2; ++lamp) {
    if (lamp) {
      c.options.light.shading.lights[0] = (stratus_light){ .vector = { 50, 10, 60 }, .color = { 1, 1, 1 }, .positional = 1 };
    }
    /* few: a rule for each lamp */
    for (int rule = STRATUS_SAMPLING_AUTO + (few_run() && lamp ? 2 : 0); rule <= STRATUS_SAMPLING_PREINTEGRATED;
         rule += few_run() ? 3 : 1) {
      c.options.sampling.rule = (stratus_sampling)rule;
      compare(stratus_sampling_name((stratus_sampling)rule), context, &c, 44.0);
      assert_true(drawn.report.light_error < 0.01);
    }
  }
  case_destroy(&c);
  stratus_context_destroy(context);
}

/* A place of the ball's or the plate's surface: returns 1 if light from `to` reaches it, 0 if not, -1 where the edge of a shadow is near or
 * the light grazes. normal: of the place. */
static int is_lit(const double place[3], const double normal[3], const double to[3], bool on_ball)
{
  double q[3], along = 0.0, square = 0.0, cosine = 0.0;
  for (int a = 0; a < 3; ++a) {
    q[a] = place[a] - (const double[3]){ 15, 13, 18 }[a];
    along -= q[a] * to[a];
    cosine += normal[a] * to[a];
  }
  for (int a = 0; a < 3; ++a) {
    const double off = q[a] + along * to[a];
    square += off * off;
  }
  if (on_ball || cosine < 0.3) {
    return cosine > 0.3 ? 1 : cosine < -0.3 ? 0 : -1;
  }
  return fabs(sqrt(square) - 7.6) < 1.2 ? -1 : square > 7.6 * 7.6;
}

/* Opaque matter is lit as a surface is: wholly or not at all, whichever rule draws it, also where the crop box cuts it. */
static void opaque_surfaces_are_lit(void** state)
{
  static double opacity[8] = { 0.0, 0.0, 0.6, 0.0, 0.6, 1.0, 1.0, 1.0 };
  const double to[3] = { 0.6, 0.0, 0.8 };
  (void)state;
  stratus_context* context = case_context("host", 2);
  picture_case c;
  make_ball(context, &c);
  c.transfer.opacity = opacity;
  c.options.light.shading.lights[0] = (stratus_light){ .vector = { to[0], to[1], to[2] }, .color = { 1, 1, 1 } };
  c.camera.parallel = 1; /* from above */
  memcpy(c.camera.eye, (const double[3]){ 14.5, 12.5, 40.0 }, sizeof c.camera.eye);
  memcpy(c.camera.forward, (const double[3]){ 0, 0, -1 }, sizeof c.camera.forward);
  memcpy(c.camera.right, (const double[3]){ 13, 0, 0 }, sizeof c.camera.right);
  memcpy(c.camera.up, (const double[3]){ 0, 11, 0 }, sizeof c.camera.up);
  c.camera.near_k = 0.0;
  c.camera.far_k = 40.0;
  for (int i = 0; i < 2 * 3; ++i) {
    const bool cut = i % 2;
    const double crop[6] = { 0.0, 29.0, 0.0, 25.0, 0.0, 20.3 };
    int wrong = 0, lit = 0, dark = 0;
    c.options.sampling.rule =
      (const stratus_sampling[3]){ STRATUS_SAMPLING_AUTO, STRATUS_SAMPLING_PREINTEGRATED, STRATUS_SAMPLING_MIDPOINT }[i / 2];
    c.options.clipping.crop = cut;
    memcpy(c.options.clipping.crop_bounds, crop, sizeof crop);
    case_render(context, &c, &drawn);
    for (int p = 0; p < CASE_PIXELS; ++p) {
      const double x = 14.5 + 13.0 * (2.0 * (p % CASE_WIDTH + 0.5) / CASE_WIDTH - 1.0);
      const double y = 12.5 + 11.0 * (2.0 * (p / CASE_WIDTH + 0.5) / CASE_HEIGHT - 1.0);
      const double square = (x - 15) * (x - 15) + (y - 13) * (y - 13), rise = sqrt(fmax(7.6 * 7.6 - square, 0.0));
      const bool on_ball = square < 7.3 * 7.3, flat = !on_ball || (cut && 18.0 + rise > 20.3);
      const double place[3] = { x, y, on_ball ? fmin(18.0 + rise, cut ? 20.3 : 99.0) : 4.6 };
      const double normal[3] = { flat ? 0.0 : (x - 15) / 7.6, flat ? 0.0 : (y - 13) / 7.6, flat ? 1.0 : rise / 7.6 };
      const int expected = is_lit(place, normal, to, on_ball);
      const bool edge = (square > 7.3 * 7.3 && square < 7.9 * 7.9) || (cut && fabs(18.0 + rise - 20.3) < 0.5);
      if (expected < 0 || edge) {
        continue;
      }
      lit += expected;
      dark += !expected;
      wrong += fabs((double)drawn.rgba[4 * p] - expected) > 0.1;
    }
    print_message("             %s%s: %d lit, %d dark, %d wrong\n", stratus_sampling_name(c.options.sampling.rule), cut ? ", cut" : "", lit,
      dark, wrong);
    assert_true(lit > case_share(500) && dark > case_share(50));
    assert_int_equal(wrong, 0);
  }
  case_destroy(&c);
  stratus_context_destroy(context);
}

/* What clip planes, crop boxes and masks hide casts no shadow, near and far. */
static void hidden_matter_casts_no_shadow(void** state)
{
  (void)state;
  stratus_context* context = case_context("host", 2);
  picture_case c;
  make_ball(context, &c);
  c.options.light.shading.lights[0] = (stratus_light){ .vector = { 0.2, 0.1, 1 }, .color = { 1, 1, 1 } };
  c.options.clipping.clip_plane_count = 1;
  const double plane[4] = { -0.3, 0.2, -1.0, 14.0 };
  memcpy(c.options.clipping.clip_planes[0], plane, sizeof plane);
  compare("clipped", context, &c, 44.0);
  c.options.clipping.clip_plane_count = 0;
  c.options.clipping.crop = 1;
  const double crop[6] = { 3.5, 25.0, 4.0, 22.0, 2.0, 16.5 };
  memcpy(c.options.clipping.crop_bounds, crop, sizeof crop);
  compare("cropped", context, &c, 44.0);
  c.options.clipping.crop = 0;

  /* the values above the plate, hidden by a mask, are as if there were none */
  static uint8_t mask[30 * 26 * 28];
  float* values = c.values;
  for (int i = 0; i < 30 * 26 * 28; ++i) {
    mask[i] = i / (30 * 26) < 9;
  }
  c.options.mask.bytes = mask;
  case_render(context, &c, &drawn);
  c.options.mask.bytes = NULL;
  for (int i = 9 * 30 * 26; i < 30 * 26 * 28; ++i) {
    values[i] = 0.0f;
  }
  case_render(context, &c, &other);
  assert_true(reference_psnr(drawn.rgba, other.rgba, CASE_PIXELS) > 40.0);
  case_destroy(&c);
  stratus_context_destroy(context);
}

/* Maps are built when data, function, matter or a light's way change, and by nothing else. */
static void maps_are_built_when_they_are_stale(void** state)
{
  (void)state;
  stratus_context* context = case_context("host", 2);
  stratus_ray_caster* caster = NULL;
  picture_case c;
  make_case(context, &c, STRATUS_FLOAT32);
  c.options.sampling.tolerance = 0.02;             /* of which coarse maps are enough */
  c.options.sampling.rule = STRATUS_SAMPLING_AUTO; /* whose tables are made after the choice */
  c.options.sampling.distance = 0.0;
  assert_int_equal(stratus_ray_caster_create(context, &caster), STRATUS_OK);
  case_render_with(context, caster, &c, &drawn);
  assert_int_equal(drawn.report.light_builds, 1);
  assert_true(drawn.report.light_bytes > 0 && drawn.report.light_ms > 0.0);
  case_camera(context, &c, 3, 0);
  c.options.light.shading.lights[0].color[0] = 0.3;
  c.options.light.shading.anisotropy = 0.5;
  case_render_with(context, caster, &c, &drawn);
  assert_int_equal(drawn.report.light_builds, 1);
  c.options.light.shading.lights[0].vector[0] += 0.5;
  case_render_with(context, caster, &c, &drawn);
  assert_int_equal(drawn.report.light_builds, 2);
  c.opacity[5] *= 0.5;
  case_render_with(context, caster, &c, &drawn);
  assert_int_equal(drawn.report.light_builds, 3);
  case_render(context, &c, &other);
  assert_memory_equal(drawn.rgba, other.rgba, sizeof drawn.rgba);
  ++c.volume.revision;
  case_render_with(context, caster, &c, &drawn);
  assert_int_equal(drawn.report.light_builds, 4);
  c.options.clipping.clip_plane_count = 1;
  c.options.clipping.clip_planes[0][0] = 1.0;
  case_render_with(context, caster, &c, &drawn);
  assert_int_equal(drawn.report.light_builds, 5);
  c.options.light.shading.lights[0].follows_camera = 1; /* then the camera moves it */
  case_render_with(context, caster, &c, &drawn);
  case_camera(context, &c, 4, 0);
  case_render_with(context, caster, &c, &drawn);
  assert_int_equal(drawn.report.light_builds, 7);
  c.options.light.shading.shadows = 0;
  case_render_with(context, caster, &c, &drawn);
  assert_int_equal(drawn.report.light_bytes, 0);
  stratus_ray_caster_destroy(caster);
  case_destroy(&c);
  stratus_context_destroy(context);
}

/* A light that moves with the camera has shadows where it is, and is probed there: thick matter then needs light at nearby places. */
static void lights_that_follow_the_camera_are_probed_with_their_shadows(void** state)
{
  (void)state;
  stratus_context* context = case_context("host", 2);
  picture_case c;
  make_ball(context, &c);
  stratus_light* light = &c.options.light.shading.lights[0];
  c.options.light.shading.scattering = 1.0;
  c.options.sampling.rule = STRATUS_SAMPLING_CELLS;
  *light = (stratus_light){ .vector = { 0, 0, 1 }, .color = { 1, 1, 1 }, .follows_camera = 1 };
  case_render(context, &c, &drawn);
  *light = (stratus_light){ .color = { 1, 1, 1 } };
  for (int axis = 0; axis < 3; ++axis) {
    light->vector[axis] = -c.camera.forward[axis];
  }
  case_render(context, &c, &other);
  print_message("             light spread %g, %g if it stands still\n", drawn.report.light_spread, other.report.light_spread);
  assert_true(drawn.report.light_spread == other.report.light_spread);
  assert_true(reference_psnr(drawn.rgba, other.rgba, CASE_PIXELS) > 80.0);
  case_destroy(&c);
  stratus_context_destroy(context);
}

/* Structures, instruction sets and threads change no bit. */
static void pictures_with_shadows_are_the_same_however_they_are_made(void** state)
{
  (void)state;
  picture_case c;
  stratus_context* context = case_context("host", 1);
  make_ball(context, &c);
  c.options.sampling.tolerance = 0.02; /* of which coarse maps are enough */
  c.options.light.shading.light_count = 2;
  c.options.light.shading.lights[1] = (stratus_light){ .vector = { 15, 13, 9 }, .color = { 0, 0, 1 }, .positional = 1 };
  case_render(context, &c, &drawn);
  stratus_context_destroy(context);
  for (int isa = 0; isa < 3; ++isa) {
    context = case_context("host", 2);
    context->isa = isa;
    c.options.skipping.structure = isa ? STRATUS_STRUCTURE_NONE : STRATUS_STRUCTURE_DISTANCE;
    c.options.skipping.audit = 1;
    case_render(context, &c, &other);
    assert_memory_equal(drawn.rgba, other.rgba, sizeof drawn.rgba);
    assert_int_equal(other.report.differing_pixels, 0);
    stratus_context_destroy(context);
  }
  case_destroy(&c);
}

/* A volume that was cut in two draws as the whole does: as blocks, and as two of several volumes. What is in one shadows the other. */
static void matter_shadows_other_volumes(void** state)
{
  (void)state;
  stratus_context* context = case_context("host", 2);
  picture_case c;
  make_ball(context, &c);
  c.options.light.shading.lights[0] = (stratus_light){ .vector = { 0.2, 0.1, 1 }, .color = { 1, 1, 1 } };
  case_render(context, &c, &drawn);
  const double blocks = case_psnr_of_parts(context, &c, 8, &drawn, stratus_ray_caster_render_blocks);
  const double several = case_psnr_of_parts(context, &c, 8, &drawn, stratus_ray_caster_render_several);
  print_message("             blocks: %.1f dB, several: %.1f dB from the whole\n", blocks, several);
  assert_true(blocks > 34.0 && several > 34.0);
  case_destroy(&c);
  stratus_context_destroy(context);
}

/* Draws two volumes, and expects this number of builds of maps so far. */
static void draw_two(const stratus_ray_cast_input inputs[2], const picture_case* c, case_draw_several* draw, uint64_t builds)
{
  static stratus_ray_cast_report reports[2];
  const stratus_image image = { .width = CASE_WIDTH, .height = CASE_HEIGHT, .rgba = other.rgba };
  assert_int_equal(draw(inputs, 2, &c->camera, &image, reports), STRATUS_OK);
  assert_int_equal(reports[0].light_builds, builds);
  assert_int_equal(reports[1].light_builds, 0);
  for (int n = 0; n < 2; ++n) {
    assert_true(reports[n].light_bytes > 0 && reports[n].light_error > 0.0);
  }
  assert_true(reports[0].light_ms > 0.0 && reports[1].light_ms == 0.0);
}

/* Maps of several inputs follow the inputs' data, whatever their casters have drawn before; they are reported; and they are dropped with
 * all that drew them when no input has shadows. */
static void maps_of_several_are_of_their_data(void** state)
{
  (void)state;
  stratus_context* context = case_context("host", 2);
  picture_case c, second;
  make_case(context, &c, STRATUS_FLOAT32);
  c.options.sampling.tolerance = 0.02;
  case_create(context, &second, STRATUS_FLOAT32, 30, 26, 28, 6);
  stratus_ray_caster* casters[3] = { NULL, NULL, NULL };
  for (int n = 0; n < 3; ++n) {
    assert_int_equal(stratus_ray_caster_create(context, &casters[n]), STRATUS_OK);
  }
  stratus_ray_cast_input inputs[2] = { { .caster = casters[0], .volume = &c.volume, .transfer = &c.transfer, .options = &c.options },
    { .caster = casters[1], .volume = &c.volume, .transfer = &c.transfer, .options = &c.options } };
  draw_two(inputs, &c, stratus_ray_caster_render_several, 1);
  inputs[1].caster = casters[2]; /* the same matter by another caster, then other matter */
  draw_two(inputs, &c, stratus_ray_caster_render_several, 1);
  inputs[1].caster = casters[1];
  inputs[1].volume = &second.volume;
  draw_two(inputs, &c, stratus_ray_caster_render_several, 2);
  inputs[1].caster = casters[2];
  inputs[1].volume = &c.volume;
  draw_two(inputs, &c, stratus_ray_caster_render_several, 3);
  draw_two(inputs, &c, stratus_ray_caster_render_blocks, 3);
  c.options.mode = STRATUS_MODE_ISOSURFACE;
  c.options.optics.contour_count = 1;
  c.options.optics.contours[0] = c.opacity[4];
  draw_two(inputs, &c, stratus_ray_caster_render_several, 4);
  c.options.optics.contours[0] = 0.9 * c.opacity[4] + 0.1 * c.opacity[2];
  draw_two(inputs, &c, stratus_ray_caster_render_several, 5);
  c.options.light.shading.shadows = 0;
  const stratus_image image = { .width = CASE_WIDTH, .height = CASE_HEIGHT, .rgba = other.rgba };
  assert_int_equal(stratus_ray_caster_render_several(inputs, 2, &c.camera, &image, NULL), STRATUS_OK);
  for (int n = 0; n < 3; n += 2) {
    assert_null(casters[n]->light.maps);
    assert_null(casters[n]->parts[STRATUS_RAY_LIGHT_PART]);
  }
  for (int n = 0; n < 3; ++n) {
    stratus_ray_caster_destroy(casters[n]);
  }
  case_destroy(&second);
  case_destroy(&c);
  stratus_context_destroy(context);
}

/* A ball above a plate, in components of their own. */
static void make_components(picture_case* c, float* pairs, float* apart[2])
{
  for (int i = 0; i < 30 * 26 * 28; ++i) {
    const int x = i % 30, y = i / 30 % 26, z = i / (30 * 26);
    const double ball = 6.0 - sqrt((x - 15) * (x - 15) + (y - 13) * (y - 13) + (z - 18) * (z - 18)), plate = 5.3 - z;
    pairs[2 * i] = apart[0][i] = (float)ball;
    pairs[2 * i + 1] = apart[1][i] = (float)plate;
  }
  c->options.mode = STRATUS_MODE_ISOSURFACE;
  c->options.optics.contour_count = 1;
  c->options.optics.contours[0] = 0.0;
  c->options.sampling.tolerance = 0.02;
  c->options.light.shading.lights[0] = (stratus_light){ .vector = { 0.2, 0.1, 1 }, .color = { 1, 1, 1 } };
}

/* Isosurfaces of independent components shadow one another, as surfaces of two volumes do, and the plate is dark in the ball's
 * shadow, whose middle is below the ball as the light falls. */
static void components_shadow_one_another(void** state)
{
  static float pairs[2 * 30 * 26 * 28], first[30 * 26 * 28], second[30 * 26 * 28];
  static double opacity[4] = { -20.0, 1.0, 20.0, 1.0 }, color[4] = { 0.0, 1.0, 1.0, 1.0 };
  static stratus_ray_cast_report report;
  float* apart[2] = { first, second };
  (void)state;
  stratus_context* context = case_context("host", 2);
  picture_case c;
  make_case(context, &c, STRATUS_FLOAT32);
  make_components(&c, pairs, apart);
  stratus_transfer transfers[2] = { stratus_transfer_default(), stratus_transfer_default() };
  stratus_volume one[2], both = c.volume;
  stratus_ray_caster* casters[3] = { NULL, NULL, NULL };
  stratus_ray_cast_input inputs[2];
  both.values = pairs;
  both.value_stride = both.components = 2;
  for (int n = 0; n < 3; ++n) {
    assert_int_equal(stratus_ray_caster_create(context, &casters[n]), STRATUS_OK);
  }
  for (int n = 0; n < 2; ++n) {
    transfers[n].opacity = opacity;
    transfers[n].color = color;
    transfers[n].opacity_count = 2;
    transfers[n].color_count = 1;
    one[n] = c.volume;
    one[n].values = apart[n];
    inputs[n] = (stratus_ray_cast_input){ .caster = casters[n], .volume = &one[n], .transfer = &transfers[n], .options = &c.options };
  }
  const stratus_image image = { .width = CASE_WIDTH, .height = CASE_HEIGHT, .rgba = other.rgba },
                      joint = { .width = CASE_WIDTH, .height = CASE_HEIGHT, .rgba = drawn.rgba };
  assert_int_equal(stratus_ray_caster_render_several(inputs, 2, &c.camera, &image, NULL), STRATUS_OK);
  assert_int_equal(stratus_ray_caster_render(casters[2], &both, transfers, &c.camera, &c.options, &joint, &report), STRATUS_OK);
  const double db = reference_psnr(drawn.rgba, other.rgba, CASE_PIXELS);
  print_message("             components: %.1f dB from volumes\n", db);
  assert_true(db > 60.0);
  assert_int_equal(report.light_builds, 1);
  assert_true(report.light_bytes > 0 && report.light_ms > 0.0 && report.light_error > 0.0);
  c.camera.parallel = 1; /* from above: a pixel in the shadow of the ball, and another in the light */
  const double eye[2][3] = { { 12.1, 11.55, 8.0 }, { 26.0, 22.0, 8.0 } };
  for (int n = 0; n < 2; ++n) {
    float pixel[4];
    const stratus_image small = { .width = 1, .height = 1, .rgba = pixel };
    stratus_camera camera = c.camera;
    memcpy(camera.eye, eye[n], sizeof camera.eye);
    memcpy(camera.forward, (const double[3]){ 0, 0, -1 }, sizeof camera.forward);
    memcpy(camera.right, (const double[3]){ 0.1, 0, 0 }, sizeof camera.right);
    memcpy(camera.up, (const double[3]){ 0, 0.1, 0 }, sizeof camera.up);
    camera.near_k = 0.0;
    camera.far_k = 20.0;
    assert_int_equal(stratus_ray_caster_render(casters[2], &both, transfers, &camera, &c.options, &small, &report), STRATUS_OK);
    assert_int_equal(report.light_builds, 1);
    print_message("             %s: %.3f\n", n ? "in the light" : "in the shadow", (double)pixel[0]);
    assert_true(pixel[3] > 0.99f && (n ? pixel[0] > 0.1f : pixel[0] < 0.02f));
  }
  /* components whose materials are not lit have no maps, whatever `shade` says */
  static const stratus_material unlit[2] = { { .shade = 0 }, { .shade = 0 } };
  c.options.light.materials = unlit;
  assert_int_equal(stratus_ray_caster_render(casters[2], &both, transfers, &c.camera, &c.options, &joint, &report), STRATUS_OK);
  assert_int_equal(report.light_bytes, 0);
  for (int n = 0; n < 3; ++n) {
    stratus_ray_caster_destroy(casters[n]);
  }
  case_destroy(&c);
  stratus_context_destroy(context);
}

/* Tetrahedra between the same values draw almost as the image does, alone and as one of several. */
static void meshes_have_shadows(void** state)
{
  (void)state;
  stratus_context* context = case_context("host", 2);
  const double tolerance = few_run() ? 0.016 : 0.004; /* few: coarser maps, of the image and of the mesh */
  picture_case c;
  make_case(context, &c, STRATUS_FLOAT32);
  c.options.sampling.tolerance = tolerance;
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
  options.tolerance = tolerance;
  options.shading = c.options.light.shading;
  stratus_tetra_caster* caster = NULL;
  const stratus_image image = { .width = CASE_WIDTH, .height = CASE_HEIGHT, .rgba = other.rgba };
  assert_int_equal(stratus_tetra_caster_create(context, &caster), STRATUS_OK);
  case_render(context, &c, &drawn);
  stratus_tetra_report of_mesh;
  assert_int_equal(stratus_tetra_caster_render(caster, &mesh, &c.transfer, &c.camera, &options, &image, &of_mesh), STRATUS_OK);
  const double alone = reference_psnr(other.rgba, drawn.rgba, CASE_PIXELS);
  assert_int_equal(of_mesh.light_builds, 1);
  assert_true(of_mesh.light_bytes > 0 && of_mesh.light_ms > 0.0 && of_mesh.light_error > 0.0);
  stratus_ray_caster* empty = NULL;
  picture_case none;
  case_create(context, &none, STRATUS_FLOAT32, 2, 2, 2, 5);
  memset(none.opacity, 0, sizeof none.opacity);
  for (int i = 0; i < 4; ++i) {
    none.opacity[2 * i] = i;
  }
  assert_int_equal(stratus_ray_caster_create(context, &empty), STRATUS_OK);
  const stratus_ray_cast_input inputs[2] = { { .caster = empty, .volume = &none.volume, .transfer = &none.transfer },
    { .tetra = caster, .mesh = &mesh, .transfer = &c.transfer, .tetra_options = &options } };
  assert_int_equal(stratus_ray_caster_render_several(inputs, 2, &c.camera, &image, NULL), STRATUS_OK);
  const double several = reference_psnr(other.rgba, drawn.rgba, CASE_PIXELS);
  print_message("             a mesh: %.1f dB, of several: %.1f dB from the image\n", alone, several);
  assert_true(alone > 40.0 && several > 40.0);
  options.shading.shadows = 0;
  assert_int_equal(stratus_ray_caster_render_several(inputs, 2, &c.camera, &image, NULL), STRATUS_OK);
  assert_true(!caster->dark && !caster->light.maps && !caster->lights);
  stratus_ray_caster_destroy(empty);
  stratus_tetra_caster_destroy(caster);
  free(points);
  case_destroy(&none);
  case_destroy(&c);
  stratus_context_destroy(context);
}

/* Numbers at their ends: spacings, anisotropy, albedo, light that grazes a plate, and values that are not finite. */
static void extremes_of_light(void** state)
{
  (void)state;
  stratus_context* context = case_context("host", 2);
  picture_case c;
  make_ball(context, &c);
  c.options.sampling.tolerance = 0.01; /* of which coarse maps are enough */
  case_render(context, &c, &drawn);
  for (int i = 0; i < 2; ++i) {
    picture_case scaled = c;
    const double scale = i ? 1e6 : 1e-6;
    for (int a = 0; a < 3; ++a) {
      scaled.volume.spacing[a] *= scale;
      scaled.camera.eye[a] *= scale;
    }
    scaled.transfer.unit_distance *= scale;
    case_render(context, &scaled, &other);
    print_message("             spacing %g: %.1f dB\n", scale, reference_psnr(other.rgba, drawn.rgba, CASE_PIXELS));
    assert_true(reference_psnr(other.rgba, drawn.rgba, CASE_PIXELS) > 70.0);
  }
  c.options.sampling.tolerance = 0.001;
  stratus_shading* s = &c.options.light.shading;
  s->lights[0] = (stratus_light){ .vector = { 1, 0.1, 0.02 }, .color = { 1, 1, 1 } };
  compare("grazing light", context, &c, 44.0);
  s->diffuse = 0.0;
  case_render(context, &c, &other);
  for (int i = 0; i < 4 * CASE_PIXELS; ++i) {
    assert_true(other.rgba[i] == (i % 4 < 3 ? 0.0f : other.rgba[i]));
  }
  s->diffuse = 1.0;
  float* values = c.values;
  for (int i = 0; i < 30 * 26 * 28; i += 977) {
    values[i] = i % 2 ? NAN : INFINITY;
  }
  for (int i = few_run(); i < 2; ++i) {
    s->anisotropy = i ? -0.99 : 0.99;
    compare("most anisotropic, with values that are not finite", context, &c, 44.0);
  }
  case_destroy(&c);
  stratus_context_destroy(context);
}

/* Scattered light agrees with the path tracer where that scatters once. */
static void scattering_is_that_of_paths(void** state)
{
  (void)state;
  stratus_context* context = case_context("host", 2);
  picture_case c;
  stratus_path_tracer* tracer = NULL;
  stratus_path_report report;
  static float paths[4 * CASE_PIXELS_MOST];
  make_case(context, &c, STRATUS_FLOAT32);
  stratus_shading* s = &c.options.light.shading;
  s->anisotropy = 0.6;
  s->diffuse = 0.8;
  case_render(context, &c, &drawn);
  const stratus_image image = { .width = CASE_WIDTH, .height = CASE_HEIGHT, .rgba = paths };
  stratus_path_options options = stratus_path_options_default();
  options.samples = few_run() ? 64 : 256;
  options.bounces = 1;
  options.albedo = 0.8;
  options.anisotropy = 0.6;
  options.light_count = 1;
  options.lights[0] = s->lights[0];
  assert_int_equal(stratus_path_tracer_create(context, &tracer), STRATUS_OK);
  assert_int_equal(stratus_path_tracer_render(tracer, &c.volume, &c.transfer, &c.camera, &options, &image, &report), STRATUS_OK);
  double squares = 0.0, count = 0.0, largest = 0.0;
  reference_error(drawn.rgba, paths, CASE_PIXELS, &squares, &count, &largest);
  const double error = sqrt(squares / count);
  print_message("             %.5f from the paths, whose standard error is %.5f\n", error, report.standard_error);
  assert_true(error < 1.3 * report.standard_error + 1e-3 && report.standard_error < 0.03);
  stratus_path_tracer_destroy(tracer);
  case_destroy(&c);
  stratus_context_destroy(context);
}

static void bad_scattering_is_refused(void** state)
{
  (void)state;
  stratus_context* context = case_context("host", 1);
  stratus_ray_caster* caster = NULL;
  picture_case c;
  make_case(context, &c, STRATUS_FLOAT32);
  const stratus_image image = { .width = CASE_WIDTH, .height = CASE_HEIGHT, .rgba = drawn.rgba };
  static const double bad[][2] = { { -0.1, 0.0 }, { 1.1, 0.0 }, { 0.5, 0.995 }, { 0.5, -1.0 }, { NAN, 0.0 }, { 0.5, NAN } };
  assert_int_equal(stratus_ray_caster_create(context, &caster), STRATUS_OK);
  for (size_t i = 0; i < sizeof bad / sizeof bad[0]; ++i) {
    c.options.light.shading.scattering = bad[i][0];
    c.options.light.shading.anisotropy = bad[i][1];
    assert_int_equal(
      stratus_ray_caster_render(caster, &c.volume, &c.transfer, &c.camera, &c.options, &image, NULL), STRATUS_INVALID_ARGUMENT);
    assert_non_null(strstr(stratus_context_message(context), "scattering"));
  }
  c.options.light.shading.scattering = c.options.light.shading.anisotropy = 0.0;
  c.options.light.shading.shadow_length = -1.0;
  assert_int_equal(
    stratus_ray_caster_render(caster, &c.volume, &c.transfer, &c.camera, &c.options, &image, NULL), STRATUS_INVALID_ARGUMENT);
  assert_non_null(strstr(stratus_context_message(context), "shadows have a length of -1"));
  c.options.light.shading.shadow_length = 0.0; /* and of several, before maps are made */
  c.options.light.shading.light_count = 20;
  c.options.mode = STRATUS_MODE_ISOSURFACE;
  c.options.optics.contour_count = 1;
  c.options.optics.contours[0] = c.opacity[4];
  stratus_ray_caster* second = NULL;
  assert_int_equal(stratus_ray_caster_create(context, &second), STRATUS_OK);
  stratus_ray_cast_input inputs[2] = { { .caster = caster, .volume = &c.volume, .transfer = &c.transfer, .options = &c.options },
    { .caster = second, .volume = &c.volume, .transfer = &c.transfer, .options = &c.options } };
  assert_int_equal(stratus_ray_caster_render_several(inputs, 2, &c.camera, &image, NULL), STRATUS_INVALID_ARGUMENT);
  c.options.light.shading.light_count = 1;
  assert_int_equal(stratus_ray_caster_render_several(inputs, 2, NULL, &image, NULL), STRATUS_INVALID_ARGUMENT);
  inputs[1].volume = NULL;
  assert_int_equal(stratus_ray_caster_render_several(inputs, 2, &c.camera, &image, NULL), STRATUS_INVALID_ARGUMENT);
  stratus_ray_caster_destroy(second);
  stratus_ray_caster_destroy(caster);
  case_destroy(&c);
  stratus_context_destroy(context);
}

int test_ray_light(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(matter_shadows_itself_as_the_reference_says),
    cmocka_unit_test(dense_matter_shadows_itself_and_what_is_behind),
    cmocka_unit_test(opaque_surfaces_are_lit),
    cmocka_unit_test(hidden_matter_casts_no_shadow),
    cmocka_unit_test(extremes_of_light),
    cmocka_unit_test(scattering_is_that_of_paths),
    cmocka_unit_test(bad_scattering_is_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}

int test_ray_light_maps(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(maps_are_built_when_they_are_stale),
    cmocka_unit_test(lights_that_follow_the_camera_are_probed_with_their_shadows),
    cmocka_unit_test(pictures_with_shadows_are_the_same_however_they_are_made),
    cmocka_unit_test(matter_shadows_other_volumes),
    cmocka_unit_test(maps_of_several_are_of_their_data),
    cmocka_unit_test(components_shadow_one_another),
    cmocka_unit_test(meshes_have_shadows),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
