/* SPDX-License-Identifier: BSD-3-Clause
 * Random volumes of different grids that overlap, and their picture as one medium. */
#ifndef STRATUS_TESTING_SEVERAL_CASE_H
#define STRATUS_TESTING_SEVERAL_CASE_H

#include "faulty_allocator.h"
#include "picture_case.h"
#include "reference_several.h"

typedef struct several_case {
  picture_case of[STRATUS_SEVERAL_MAX];                   /* the first one's camera and opaque depth are used */
  const stratus_transfer* transfers[STRATUS_SEVERAL_MAX]; /* of components or labels; NULL: the case's own */
  int count;
} several_case;

/* Rows of colours that differ from volume to volume: value, red, green, blue. */
static inline void several_color(picture_case* c, int n)
{
  static const double rgb[4][3] = { { 0.9, 0.15, 0.1 }, { 0.1, 0.2, 0.95 }, { 0.2, 0.9, 0.2 }, { 0.9, 0.9, 0.8 } };
  const double base = case_type_values[c->volume.type].base, scale = case_type_values[c->volume.type].scale;
  const double color[12] = { base, rgb[n % 4][0], rgb[n % 4][1], rgb[n % 4][2], base + 0.3 * scale, rgb[(n + 1) % 4][0], rgb[n % 4][1],
    rgb[n % 4][2], base + scale, rgb[n % 4][0], rgb[n % 4][1], rgb[(n + 2) % 4][2] };
  memcpy(c->color, color, sizeof color);
}

/* Turns, stretches and moves a volume of about 30 units so that it overlaps other seeds' volumes, which are about the origin. */
static inline void several_place(picture_case* c, uint32_t seed)
{
  uint32_t s = seed * 2654435u + 3u;
  const double angle = case_uniform(&s, 0.0, 6.28), tilt = case_uniform(&s, 0.0, 3.14);
  const double ca = cos(angle), sa = sin(angle), ct = cos(tilt), st = sin(tilt);
  const double turn[3][3] = { { ca, -sa * ct, sa * st }, { sa, ca * ct, -ca * st }, { 0.0, st, ct } };
  double stretch[3];
  for (int a = 0; a < 3; ++a) {
    stretch[a] = (a == 1 && case_random(&s) % 3 == 0 ? -1.0 : 1.0) * 30.0 / (double)c->volume.dimensions[a] * case_uniform(&s, 0.7, 1.3);
  }
  for (int row = 0; row < 3; ++row) {
    double middle = 0.0;
    for (int a = 0; a < 3; ++a) {
      c->volume.matrix[4 * row + a] = turn[row][a] * stretch[a];
      middle += c->volume.matrix[4 * row + a] * 0.5 * (double)(c->volume.dimensions[a] - 1);
    }
    c->volume.matrix[4 * row + 3] = case_uniform(&s, -7.0, 7.0) - middle;
  }
}

/* `count` volumes of random types, sizes, places and spacings. */
static inline void several_create(stratus_context* context, several_case* m, int count, uint32_t seed)
{
  uint32_t s = seed * 7919u + 5u;
  memset(m->transfers, 0, sizeof m->transfers);
  m->count = count;
  for (int n = 0; n < count; ++n) {
    picture_case* c = &m->of[n];
    const int64_t size[3] = { 16 + case_random(&s) % 24, 16 + case_random(&s) % 24, 16 + case_random(&s) % 24 };
    case_create(context, c, (stratus_type)(case_random(&s) % 10), size[0], size[1], size[2], seed + 100u * (uint32_t)n);
    several_place(c, seed + 17u * (uint32_t)n);
    several_color(c, n);
    c->transfer.unit_distance = case_uniform(&s, 1.5, 6.0);
    c->volume.cell_centered = case_random(&s) % 3 == 0;
    c->options.sampling.rule = case_random(&s) % 2 ? STRATUS_SAMPLING_PREINTEGRATED : STRATUS_SAMPLING_MIDPOINT;
    c->options.sampling.distance = 0.2;
  }
  const double eye[3] = { case_uniform(&s, -60, 60), case_uniform(&s, 30, 70), case_uniform(&s, -60, 60) }, focal[3] = { 0, 0, 0 },
               up[3] = { 0.1, 0.2, 1 };
  if (case_random(&s) % 2) {
    assert_int_equal(
      stratus_camera_perspective(context, eye, focal, up, 34.0, (double)CASE_WIDTH / CASE_HEIGHT, &m->of[0].camera), STRATUS_OK);
  } else {
    assert_int_equal(
      stratus_camera_parallel(context, eye, focal, up, 19.0, (double)CASE_WIDTH / CASE_HEIGHT, &m->of[0].camera), STRATUS_OK);
  }
}

static inline void several_destroy(several_case* m)
{
  for (int n = 0; n < m->count; ++n) {
    case_destroy(&m->of[n]);
  }
}

/* Casters of a picture of several. */
typedef struct several_casters {
  stratus_ray_caster* of[STRATUS_SEVERAL_MAX];
} several_casters;

static inline void several_casters_create(stratus_context* context, several_casters* casters)
{
  for (int n = 0; n < STRATUS_SEVERAL_MAX; ++n) {
    assert_int_equal(stratus_ray_caster_create(context, &casters->of[n]), STRATUS_OK);
  }
}

static inline void several_casters_destroy(several_casters* casters)
{
  for (int n = 0; n < STRATUS_SEVERAL_MAX; ++n) {
    stratus_ray_caster_destroy(casters->of[n]);
  }
}

static inline stratus_status several_draw_with(
  const several_casters* casters, const several_case* m, picture* p, stratus_ray_cast_report reports[STRATUS_SEVERAL_MAX])
{
  stratus_ray_cast_input inputs[STRATUS_SEVERAL_MAX];
  const stratus_image image = { .width = CASE_WIDTH,
    .height = CASE_HEIGHT,
    .rgba = p->rgba,
    .depth = p->depth,
    .samples = p->samples,
    .opaque_depth = m->of[0].opaque_depth };
  for (int n = 0; n < m->count; ++n) {
    inputs[n] = (stratus_ray_cast_input){ .caster = casters->of[n],
      .volume = &m->of[n].volume,
      .transfer = m->transfers[n] ? m->transfers[n] : &m->of[n].transfer,
      .options = &m->of[n].options };
  }
  return stratus_ray_caster_render_several(inputs, m->count, &m->of[0].camera, &image, reports);
}

static inline void several_draw(stratus_context* context, const several_case* m, picture* p)
{
  static stratus_ray_cast_report reports[STRATUS_SEVERAL_MAX];
  several_casters casters;
  several_casters_create(context, &casters);
  const stratus_status status = several_draw_with(&casters, m, p, reports);
  if (status != STRATUS_OK) {
    print_error("several: %s: %s\n", stratus_status_name(status), stratus_context_message(context));
  }
  assert_int_equal(status, STRATUS_OK);
  p->report = reports[0];
  several_casters_destroy(&casters);
}

/* Returns the PSNR against the reference. */
static inline double several_psnr(const char* what, stratus_context* context, const several_case* m, picture* p)
{
  static float reference[4 * CASE_PIXELS_MOST];
  reference_scene scenes[STRATUS_SEVERAL_MAX];
  double reference_db = 0.0;
  for (int n = 0; n < m->count; ++n) {
    scenes[n] = case_scene(&m->of[n]);
    scenes[n].camera = &m->of[0].camera;
    scenes[n].opaque_depth = m->of[0].opaque_depth;
    scenes[n].shading = m->of[n].options.light.shade || m->of[n].options.light.materials ? &m->of[n].options.light.shading : NULL;
    scenes[n].materials = m->of[n].options.light.materials;
    scenes[n].crop_regions = m->of[n].options.clipping.crop_regions;
    scenes[n].gradient_distance = m->of[n].options.optics.gradient_distance;
    scenes[n].dependent = m->of[n].options.optics.dependent;
    scenes[n].mean_components = m->of[n].options.optics.mean_components;
    scenes[n].labels = m->of[n].options.mask.bytes;
    scenes[n].label_count = m->of[n].options.mask.label_count;
    scenes[n].transfer = m->transfers[n] ? m->transfers[n] : scenes[n].transfer;
  }
  several_draw(context, m, p);
  assert_int_equal(reference_converged_several(scenes, m->count, CASE_WIDTH, CASE_HEIGHT, 70.0, reference, NULL, &reference_db), 0);
  const double db = reference_psnr(p->rgba, reference, CASE_PIXELS);
  print_message("             %s: %.1f dB, reference %.0f dB, %d pixels\n", what, db, reference_db, case_lit(p));
  return db;
}

/* Draws the volumes again and again, while one allocation after the other fails: the call says so, nothing leaks, and the next picture is
 * right. */
static inline void several_each_allocation_may_fail(const several_case* m)
{
  static picture drawn, other;
  faulty_allocator allocator = { 0 };
  const stratus_context_options options = faulty_options(&allocator, "host");
  stratus_context* context = NULL;
  several_casters casters;
  int failures = 0;
  assert_int_equal(stratus_context_create(&options, &context, NULL, 0), STRATUS_OK);
  several_draw(context, m, &drawn);
  const int64_t live = allocator.live;
  for (int64_t n = 1; n < 400; ++n) {
    several_casters_create(context, &casters);
    allocator.fail_at = allocator.calls + n;
    const stratus_status status = several_draw_with(&casters, m, &other, NULL);
    const bool failed = allocator.calls >= allocator.fail_at;
    allocator.fail_at = 0;
    assert_true(status == STRATUS_OK || (failed && status == STRATUS_OUT_OF_MEMORY));
    failures += failed;
    assert_int_equal(several_draw_with(&casters, m, &other, NULL), STRATUS_OK);
    assert_memory_equal(other.rgba, drawn.rgba, sizeof drawn.rgba);
    assert_memory_equal(other.depth, drawn.depth, sizeof drawn.depth);
    several_casters_destroy(&casters);
    assert_int_equal(allocator.live, live);
    if (!failed) {
      break;
    }
  }
  assert_true(failures > 10 && failures < 390);
  stratus_context_destroy(context);
}

#endif
