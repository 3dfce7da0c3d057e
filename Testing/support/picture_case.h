/* SPDX-License-Identifier: BSD-3-Clause
 * Random smooth small volumes, views of them, and their pictures by the ray caster and by the reference, for the picture tests. */
#ifndef STRATUS_TESTING_PICTURE_CASE_H
#define STRATUS_TESTING_PICTURE_CASE_H

#include "instruction_set.h"
#include "picture_size.h"
#include "reference.h"

#include <math.h>
#include <stdbool.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define CASE_WIDTH_MOST 52
#define CASE_HEIGHT_MOST 44
#define CASE_PIXELS_MOST (CASE_WIDTH_MOST * CASE_HEIGHT_MOST)
#define CASE_WIDTH (CASE_SMALL ? CASE_WIDTH_MOST / 2 : CASE_WIDTH_MOST)
#define CASE_HEIGHT (CASE_SMALL ? CASE_HEIGHT_MOST / 2 : CASE_HEIGHT_MOST)
#define CASE_PIXELS (CASE_SMALL ? CASE_PIXELS_MOST / 4 : CASE_PIXELS_MOST)

/* Returns the part of a number of pixels of the large picture that falls to the picture as it is drawn. */
static inline int case_share(int pixels)
{
  return CASE_SMALL ? pixels / 4 : pixels;
}

typedef struct picture {
  float rgba[4 * CASE_PIXELS_MOST];
  float depth[CASE_PIXELS_MOST];
  uint32_t samples[CASE_PIXELS_MOST];
  stratus_ray_cast_report report;
} picture;

typedef struct picture_case {
  stratus_volume volume;
  stratus_transfer transfer;
  stratus_camera camera;
  stratus_ray_cast_options options;
  const float* opaque_depth;
  double opacity[8];
  double color[12];
  void* values;
  uint8_t* point_ghosts;
  uint8_t* cell_ghosts;
} picture_case;

static const char* const case_type_names[] = { "int8", "uint8", "int16", "uint16", "int32", "uint32", "int64", "uint64", "float32",
  "float64" };

/* For each type: values are base + scale*f, with f within -1..1. */
static const struct {
  double base, scale;
} case_type_values[] = { { 3, 120 }, { 127, 120 }, { -200, 30000 }, { 32000, 31000 }, { 1e9, 1e6 }, { 3e9, 1e6 }, { -4e15, 1e7 },
  { 9e15, 1e7 }, { -20, 3 }, { 1e6, 0.001 } };

static inline uint32_t case_random(uint32_t* state)
{
  *state = *state * 1664525u + 1013904223u;
  return *state >> 8;
}

static inline double case_uniform(uint32_t* state, double lo, double hi)
{
  return lo + (hi - lo) * (double)case_random(state) / 16777216.0;
}

static inline void case_store(void* values, stratus_type type, size_t at, double value)
{
  switch (type) {
    case STRATUS_INT8:
      ((int8_t*)values)[at] = (int8_t)lround(value);
      break;
    case STRATUS_UINT8:
      ((uint8_t*)values)[at] = (uint8_t)lround(value);
      break;
    case STRATUS_INT16:
      ((int16_t*)values)[at] = (int16_t)lround(value);
      break;
    case STRATUS_UINT16:
      ((uint16_t*)values)[at] = (uint16_t)lround(value);
      break;
    case STRATUS_INT32:
      ((int32_t*)values)[at] = (int32_t)lround(value);
      break;
    case STRATUS_UINT32:
      ((uint32_t*)values)[at] = (uint32_t)lround(value);
      break;
    case STRATUS_INT64:
      ((int64_t*)values)[at] = (int64_t)llround(value);
      break;
    case STRATUS_UINT64:
      ((uint64_t*)values)[at] = (uint64_t)llround(value);
      break;
    case STRATUS_FLOAT32:
      ((float*)values)[at] = (float)value;
      break;
    case STRATUS_FLOAT64:
      ((double*)values)[at] = value;
      break;
  }
}

/* Fills the volume with a random smooth field: a sum of a few waves longer than 12 voxels. */
static inline void case_fill(picture_case* c, uint32_t seed)
{
  enum { WAVES = 5 };
  const int64_t* n = c->volume.dimensions;
  double wave[WAVES][4];
  for (int w = 0; w < WAVES; ++w) {
    for (int a = 0; a < 3; ++a) {
      wave[w][a] = case_uniform(&seed, -0.3, 0.3);
    }
    wave[w][3] = case_uniform(&seed, 0.0, 6.28);
  }
  const double base = case_type_values[c->volume.type].base;
  const double scale = case_type_values[c->volume.type].scale;
  for (int64_t at = 0; at < n[0] * n[1] * n[2]; ++at) {
    const double x = (double)(at % n[0]), y = (double)(at / n[0] % n[1]), z = (double)(at / n[0] / n[1]);
    double f = 0.0;
    for (int w = 0; w < WAVES; ++w) {
      f += sin(wave[w][0] * x + wave[w][1] * y + wave[w][2] * z + wave[w][3]) / WAVES;
    }
    case_store(c->values, c->volume.type, (size_t)(at * c->volume.value_stride), base + scale * f);
  }
}

/* Sets the camera to scene camera number `view` about the volume's world bounds. */
static inline void case_camera(stratus_context* context, picture_case* c, int view, int parallel)
{
  double bounds[6];
  assert_int_equal(stratus_volume_bounds(context, &c->volume, bounds), STRATUS_OK);
  assert_int_equal(stratus_scene_camera(context, bounds, 2, view, parallel, (double)CASE_WIDTH / CASE_HEIGHT, &c->camera), STRATUS_OK);
}

/* Makes a case of unit spacing, about half transparent. Samples are a quarter of a voxel apart, so close that only rounding and the
 * second-order error of sampling separate the picture from the reference. Any misplaced half voxel or step then stands out. */
static inline void case_create(
  stratus_context* context, picture_case* c, stratus_type type, int64_t nx, int64_t ny, int64_t nz, uint32_t seed)
{
  memset(c, 0, sizeof *c);
  c->volume = stratus_volume_default();
  c->volume.type = type;
  const int64_t n[3] = { nx, ny, nz };
  for (int a = 0; a < 3; ++a) {
    c->volume.dimensions[a] = n[a];
    c->volume.spacing[a] = 1.0;
  }
  c->volume.value_stride = 1;
  c->values = calloc((size_t)(nx * ny * nz), stratus_type_size(type));
  assert_non_null(c->values);
  c->volume.values = c->values;
  case_fill(c, seed);
  const double base = case_type_values[type].base;
  const double scale = case_type_values[type].scale;
  const double opacity[8] = { base - scale, 0, base + 0.02 * scale, 0, base + 0.3 * scale, 0.12, base + scale, 0.4 };
  const double color[12] = { base, 0.2, 0.3, 0.9, base + 0.3 * scale, 0.9, 0.8, 0.2, base + scale, 1, 0.1, 0.1 };
  memcpy(c->opacity, opacity, sizeof opacity);
  memcpy(c->color, color, sizeof color);
  c->transfer = stratus_transfer_default();
  c->transfer.opacity = c->opacity;
  c->transfer.opacity_count = 4;
  c->transfer.color = c->color;
  c->transfer.color_count = 3;
  c->options = stratus_ray_cast_options_default();
  c->options.sampling.rule = STRATUS_SAMPLING_MIDPOINT;
  c->options.sampling.distance = 0.25;
  c->options.sampling.termination = 1.0;
  case_camera(context, c, 0, 0);
}

/* Makes a case in which everything is random: type, size, sampling, interpolation, holes, crop, planes, camera. */
static inline void case_create_random(stratus_context* context, uint32_t seed, picture_case* c)
{
  uint32_t s = seed * 7919u + 13u;
  const stratus_type type = (stratus_type)(case_random(&s) % 10);
  const int64_t nx = 1 + case_random(&s) % 40, ny = 1 + case_random(&s) % 40, nz = 2 + case_random(&s) % 40;
  case_create(context, c, type, nx, ny, nz, seed);
  c->options.sampling.rule = (stratus_sampling)(STRATUS_SAMPLING_MIDPOINT + case_random(&s) % 3); /* or pre-integrated, or cells */
  c->options.sampling.interpolation = case_random(&s) % 3 ? STRATUS_INTERPOLATION_LINEAR : STRATUS_INTERPOLATION_NEAREST;
  c->options.sampling.distance = case_uniform(&s, 0.2, 1.9);
  c->options.sampling.termination = case_random(&s) % 2 ? 0.999 : 0.9;
  c->volume.cell_centered = nx == 1 || ny == 1 || case_random(&s) % 3 == 0;
  if (case_random(&s) % 2) { /* a narrow peak: the volume is mostly empty */
    const double base = case_type_values[type].base, scale = case_type_values[type].scale;
    const double peak[8] = { base + 0.1 * scale, 0, base + 0.13 * scale, 0.8, base + 0.16 * scale, 0, base + scale, 0 };
    memcpy(c->opacity, peak, sizeof peak);
  }
  if (type >= STRATUS_FLOAT32 && case_random(&s) % 2) {
    for (int i = 0; i < 20; ++i) {
      case_store(c->values, type, case_random(&s) % (uint32_t)(nx * ny * nz), (double)(i % 2 ? NAN : INFINITY));
    }
  }
  if (case_random(&s) % 4 == 0) {
    c->cell_ghosts = calloc((size_t)(nx * ny * nz), 1);
    for (int i = 0; i < 10; ++i) {
      c->cell_ghosts[case_random(&s) % (uint32_t)(nx * ny * nz)] = STRATUS_GHOST_HIDDEN_CELL;
    }
    c->volume.cell_ghosts = c->cell_ghosts;
  }
  if (case_random(&s) % 4 == 0) {
    c->options.clipping.crop = 1;
    for (int a = 0; a < 3; ++a) {
      c->options.clipping.crop_bounds[2 * a] = case_uniform(&s, -2, 10);
      c->options.clipping.crop_bounds[2 * a + 1] = c->options.clipping.crop_bounds[2 * a] + case_uniform(&s, 1, 30);
    }
  }
  if (case_random(&s) % 4 == 0) {
    c->options.clipping.clip_plane_count = 1;
    for (int a = 0; a < 3; ++a) {
      c->options.clipping.clip_planes[0][a] = case_uniform(&s, -1, 1);
    }
    c->options.clipping.clip_planes[0][3] = case_uniform(&s, -5, 15);
  }
  case_camera(context, c, (int)(case_random(&s) % 8), (int)(case_random(&s) % 2));
  if (case_random(&s) % 4 == 0) { /* from inside */
    for (int a = 0; a < 3; ++a) {
      c->camera.eye[a] = case_uniform(&s, 0, (double)c->volume.dimensions[a]);
    }
  }
}

/* Makes a case of clouds of thin haze with a small rough box among them, whose sampling is left open and becomes rule local at the default
 * tolerance. The type of values, holes, crop and camera are random. */
static inline void case_create_local(stratus_context* context, uint32_t seed, picture_case* c)
{
  static const stratus_type types[] = { STRATUS_FLOAT32, STRATUS_UINT8, STRATUS_INT16, STRATUS_UINT16, STRATUS_FLOAT64, STRATUS_INT8 };
  uint32_t s = seed * 6364136u + 5u;
  const stratus_type type = types[case_random(&s) % 6];
  const int64_t n[3] = { 40 + case_random(&s) % 20, 40 + case_random(&s) % 20, 40 + case_random(&s) % 20 };
  const double base = case_type_values[type].base, scale = case_type_values[type].scale;
  case_create(context, c, type, n[0], n[1], n[2], seed);
  int64_t lo[3];
  for (int a = 0; a < 3; ++a) {
    lo[a] = 4 + case_random(&s) % (uint32_t)(n[a] - 20);
  }
  for (int64_t at = 0; at < n[0] * n[1] * n[2]; ++at) {
    const int64_t p[3] = { at % n[0], at / n[0] % n[1], at / n[0] / n[1] };
    bool inside = true;
    for (int a = 0; a < 3; ++a) {
      inside = inside && p[a] >= lo[a] && p[a] < lo[a] + 9;
    }
    const double haze = -0.6 + 0.15 * sin(0.12 * (double)p[0] + 0.07 * (double)p[1] + 0.05 * (double)p[2]);
    case_store(c->values, type, (size_t)at, base + scale * (inside ? case_uniform(&s, -0.4, 0.95) : haze));
  }
  const double opacity[8] = { base - 0.6 * scale, 0, base - 0.45 * scale, 0.006, base + 0.3 * scale, 0.7, base + 0.5 * scale, 0.05 };
  const double color[12] = { base - 0.9 * scale, 0.2, 0.3, 0.9, base - 0.4 * scale, 0.25, 0.3, 0.9, base + 0.4 * scale, 1, 0.1, 0.1 };
  memcpy(c->opacity, opacity, sizeof opacity);
  memcpy(c->color, color, sizeof color);
  c->options = stratus_ray_cast_options_default();
  c->volume.cell_centered = case_random(&s) % 3 == 0;
  if (case_random(&s) % 3 == 0) {
    c->cell_ghosts = calloc((size_t)(n[0] * n[1] * n[2]), 1);
    for (int i = 0; i < 10; ++i) {
      c->cell_ghosts[case_random(&s) % (uint32_t)(n[0] * n[1] * n[2])] = STRATUS_GHOST_HIDDEN_CELL;
    }
    c->volume.cell_ghosts = c->cell_ghosts;
  }
  if (case_random(&s) % 3 == 0) {
    c->options.clipping.crop = 1;
    c->options.clipping.crop_regions = case_random(&s) % 2 ? STRATUS_CROP_INSIDE : 0x5a5a5a5u;
    for (int a = 0; a < 3; ++a) {
      c->options.clipping.crop_bounds[2 * a] = case_uniform(&s, -2, 20);
      c->options.clipping.crop_bounds[2 * a + 1] = c->options.clipping.crop_bounds[2 * a] + case_uniform(&s, 1, 30);
    }
  }
  case_camera(context, c, (int)(case_random(&s) % 8), (int)(case_random(&s) % 2));
}

static inline void case_destroy(picture_case* c)
{
  free(c->values);
  free(c->point_ghosts);
  free(c->cell_ghosts);
}

static inline void case_render_with(stratus_context* context, stratus_ray_caster* caster, const picture_case* c, picture* p)
{
  const stratus_image image = {
    .width = CASE_WIDTH, .height = CASE_HEIGHT, .rgba = p->rgba, .depth = p->depth, .samples = p->samples, .opaque_depth = c->opaque_depth
  };
  memset(&p->report, 0, sizeof p->report);
  const stratus_status status = stratus_ray_caster_render(caster, &c->volume, &c->transfer, &c->camera, &c->options, &image, &p->report);
  if (status != STRATUS_OK) {
    print_error("render: %s: %s\n", stratus_status_name(status), stratus_context_message(context));
  }
  assert_int_equal(status, STRATUS_OK);
}

static inline void case_render(stratus_context* context, const picture_case* c, picture* p)
{
  stratus_ray_caster* caster = NULL;
  assert_int_equal(stratus_ray_caster_create(context, &caster), STRATUS_OK);
  case_render_with(context, caster, c, p);
  stratus_ray_caster_destroy(caster);
}

static inline reference_scene case_scene(const picture_case* c)
{
  reference_scene scene = { .volume = &c->volume,
    .transfer = &c->transfer,
    .camera = &c->camera,
    .interpolation = c->options.sampling.interpolation,
    .opaque_depth = c->opaque_depth,
    .crop = c->options.clipping.crop,
    .clip_plane_count = c->options.clipping.clip_plane_count,
    .transfer_2d = c->options.optics.transfer_2d,
    .clip_gradients = c->options.clipping.clip_gradients,
    .clipped_value = c->options.clipping.clipped_value };
  memcpy(scene.crop_bounds, c->options.clipping.crop_bounds, sizeof scene.crop_bounds);
  memcpy(scene.clip_planes, c->options.clipping.clip_planes, sizeof scene.clip_planes);
  return scene;
}

/* Returns the number of pixels with alpha > 0. Tests check it, so that none passes on an empty picture. */
static inline int case_lit(const picture* p)
{
  int lit = 0;
  for (int i = 0; i < CASE_PIXELS; ++i) {
    lit += p->rgba[4 * i + 3] > 0.0f;
  }
  return lit;
}

/* Returns the PSNR of the ray caster's picture against the reference. */
static inline double case_psnr(const char* what, stratus_context* context, const picture_case* c, picture* p)
{
  static float reference[4 * CASE_PIXELS_MOST];
  const reference_scene scene = case_scene(c);
  double reference_db = 0.0;
  case_render(context, c, p);
  assert_int_equal(reference_converged(&scene, CASE_WIDTH, CASE_HEIGHT, 70.0, reference, NULL, &reference_db), 0);
  const double db = reference_psnr(p->rgba, reference, CASE_PIXELS);
  print_message("             %s: %.1f dB, reference %.0f dB, %d pixels\n", what, db, reference_db, case_lit(p));
  return db;
}

static inline stratus_context* case_context(const char* device, int threads)
{
  stratus_context_options options = stratus_context_options_default();
  stratus_context* context = NULL;
  char message[512];
  options.device = device;
  options.threads = threads;
  const stratus_status status = stratus_context_create(&options, &context, message, sizeof message);
  if (status != STRATUS_OK) {
    print_error("context on %s: %s\n", device, message);
  }
  assert_int_equal(status, STRATUS_OK);
  return context;
}

/* Offers the caster a tree of the cells that the case's transfer function shows. options: NULL for the default's. */
static inline void case_offer_tree(
  stratus_context* context, stratus_ray_caster* caster, const picture_case* c, const stratus_tree_options* options)
{
  stratus_criterion criterion = stratus_criterion_default();
  stratus_voxels* cells = NULL;
  stratus_tree* tree = NULL;
  criterion.transfer = &c->transfer;
  assert_int_equal(stratus_voxels_create_cells(context, &c->volume, &criterion, &cells), STRATUS_OK);
  assert_int_equal(stratus_tree_create(context, cells, options, &tree), STRATUS_OK);
  void* bytes = malloc(stratus_tree_bytes(tree));
  stratus_tree_save(tree, bytes);
  assert_int_equal(stratus_ray_caster_offer_tree(caster, bytes, stratus_tree_bytes(tree)), STRATUS_OK);
  free(bytes);
  stratus_tree_destroy(tree);
  stratus_voxels_destroy(cells);
}

typedef stratus_status case_draw_several(
  const stratus_ray_cast_input*, int, const stratus_camera*, const stratus_image*, stratus_ray_cast_report*);

/* Returns the PSNR of a case of float32 values that is drawn in two parts, below and above a layer along z, from the whole. */
static inline double case_psnr_of_parts(
  stratus_context* context, const picture_case* c, int64_t layer, const picture* whole, case_draw_several* draw)
{
  static picture p;
  const stratus_image image = { .width = CASE_WIDTH, .height = CASE_HEIGHT, .rgba = p.rgba };
  const int64_t* n = c->volume.dimensions;
  stratus_volume parts[2] = { c->volume, c->volume };
  stratus_ray_cast_input inputs[2];
  parts[0].dimensions[2] = layer + 1;
  parts[1].dimensions[2] = n[2] - layer;
  parts[1].values = (const float*)c->values + layer * n[0] * n[1];
  parts[1].origin[2] += c->volume.spacing[2] * (double)layer;
  for (int i = 0; i < 2; ++i) {
    inputs[i] = (stratus_ray_cast_input){ .volume = &parts[i], .transfer = &c->transfer, .options = &c->options };
    assert_int_equal(stratus_ray_caster_create(context, &inputs[i].caster), STRATUS_OK);
  }
  assert_int_equal(draw(inputs, 2, &c->camera, &image, NULL), STRATUS_OK);
  for (int i = 0; i < 2; ++i) {
    stratus_ray_caster_destroy(inputs[i].caster);
  }
  return reference_psnr(p.rgba, whole->rgba, CASE_PIXELS);
}

/* Set-up and tear-down of a group whose state is a context of the host with two threads. */
static inline int case_set_up(void** state)
{
  *state = case_context("host", 2);
  return 0;
}

static inline int case_tear_down(void** state)
{
  stratus_context_destroy(*state);
  return 0;
}

/* Whether host and device take the same samples. A packet looks the structure up once enough of its rays need it, so that the samples taken
 * in between follow from the width of packets: 16 on a CPU's OpenCL, 16, 8 or 4 on the host. Pictures do not depend on it. */
static inline bool case_counts_agree(void)
{
  return stratus_isa_highest() >= 2;
}

#endif
