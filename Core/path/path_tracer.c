/* SPDX-License-Identifier: BSD-3-Clause
 * The path tracer: the sums that it keeps between calls, passes over the pixels, and the image with its errors. */
#include "path.h"

#include "camera.h"
#include "picture.h"
#include "tiles.h"
#include "vector.h"

#include <string.h>

/* Samples of a pixel before its error is compared with the tolerance, and the step of their number. */
#define SAMPLES_FIRST 16
/* How much the number of samples grows at most until the error is compared again. */
#define GROWTH_MOST 4
/* Side of a tile in pixels. */
#define TILE 4

/* Sums of a pixel's paths. */
typedef struct pixel {
  double sum[4], square[4];
  double depth; /* the least */
  uint64_t count;
} pixel;

/* Inputs as numbers that are compared as bytes, padding too. Arrays are their hashes. */
typedef struct field_inputs {
  stratus_volume volume; /* its coordinates are NULL */
  uint64_t coordinates[3], opacity, color;
  double unit_distance;
  int64_t interpolation, clamp, block_size;
} field_inputs;

typedef struct view_inputs {
  stratus_path_scene scene;
  double eye[3], forward[3], right[3], up[3], near_k, far_k;
  int64_t parallel, width, height;
  uint64_t opaque_depth, seed, mask_revision, regions;
  const uint8_t* mask;
  int64_t crops, plane_count;
  double crop[6], planes[STRATUS_CLIP_PLANES_MAX][4];
} view_inputs;

struct stratus_path_tracer {
  stratus_context* context;
  stratus_path_field field;
  field_inputs field_inputs; /* valid if `built` */
  view_inputs view_inputs;   /* valid if `pixels` */
  bool built;
  pixel* pixels; /* NULL: there is no image */
  uint64_t samples, vertices, lookups;
  double ms;
};

stratus_status stratus_path_tracer_create(stratus_context* context, stratus_path_tracer** tracer)
{
  void* memory = NULL;
  if (!context) {
    return STRATUS_INVALID_ARGUMENT;
  }
  if (!tracer) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "tracer is NULL");
  }
  TRY(stratus_allocate_zero(context, 1, sizeof **tracer, &memory));
  *tracer = memory;
  (*tracer)->context = context;
  return STRATUS_OK;
}

static void drop_image(stratus_path_tracer* t)
{
  stratus_release(t->context, t->pixels);
  t->pixels = NULL;
  t->samples = t->vertices = t->lookups = 0;
  t->ms = 0.0;
}

void stratus_path_tracer_destroy(stratus_path_tracer* tracer)
{
  if (tracer) {
    drop_image(tracer);
    stratus_path_field_release(tracer->context, &tracer->field);
    stratus_release(tracer->context, tracer);
  }
}

/* ---- inputs */

static void gather_field(
  const stratus_volume* v, const stratus_transfer* t, const stratus_path_options* options, const stratus_path_field* f, field_inputs* in)
{
  memset(in, 0, sizeof *in);
  in->volume.values = v->values;
  in->volume.type = v->type;
  in->volume.value_stride = v->value_stride;
  in->volume.cell_centered = v->cell_centered != 0;
  in->volume.point_ghosts = v->point_ghosts;
  in->volume.cell_ghosts = v->cell_ghosts;
  in->volume.revision = v->revision;
  memcpy(in->volume.dimensions, v->dimensions, sizeof v->dimensions);
  memcpy(in->volume.origin, v->origin, sizeof v->origin);
  memcpy(in->volume.direction, v->direction, sizeof v->direction);
  memcpy(in->volume.matrix, v->matrix, sizeof v->matrix);
  for (int a = 0; a < 3; ++a) {
    const size_t count = (size_t)v->dimensions[a] + (v->cell_centered != 0);
    in->volume.spacing[a] = v->coordinates[a] ? 0.0 : v->spacing[a];
    in->coordinates[a] = v->coordinates[a] ? stratus_hash(v->coordinates[a], count * sizeof(double), 1) : 0;
  }
  in->opacity = stratus_hash(t->opacity, 2 * t->opacity_count * sizeof(double), 1);
  in->color = stratus_hash(t->color, 4 * t->color_count * sizeof(double), 1);
  in->unit_distance = t->unit_distance;
  in->clamp = t->clamp != 0;
  in->interpolation = options->interpolation;
  in->block_size = f->block_size;
}

static void gather_view(const stratus_path_scene* scene, const stratus_camera* camera, const stratus_path_options* options,
  const stratus_image* image, view_inputs* in)
{
  const stratus_ray_clipping_options* clipping = &options->clipping;
  const size_t pixels = (size_t)image->width * (size_t)image->height;
  memset(in, 0, sizeof *in);
  memcpy(&in->scene, scene, sizeof *scene);
  memcpy(in->eye, camera->eye, sizeof in->eye);
  memcpy(in->forward, camera->forward, sizeof in->forward);
  memcpy(in->right, camera->right, sizeof in->right);
  memcpy(in->up, camera->up, sizeof in->up);
  in->near_k = camera->near_k;
  in->far_k = camera->far_k;
  in->parallel = camera->parallel != 0;
  in->width = image->width;
  in->height = image->height;
  in->opaque_depth = image->opaque_depth ? stratus_hash(image->opaque_depth, pixels * sizeof(float), 1) : 0;
  in->seed = options->seed;
  in->mask = options->mask.bytes;
  in->mask_revision = options->mask.bytes ? options->mask.revision : 0;
  in->crops = clipping->crop != 0;
  if (clipping->crop) {
    in->regions = clipping->crop_regions & STRATUS_CROP_ALL;
    memcpy(in->crop, clipping->crop_bounds, sizeof in->crop);
  }
  in->plane_count = clipping->clip_plane_count;
  memcpy(in->planes, clipping->clip_planes, (size_t)clipping->clip_plane_count * sizeof *in->planes);
}

/* Brings the tracer to these inputs, and drops all that follows from others. */
static stratus_status update(stratus_path_tracer* t, const stratus_volume* volume, const stratus_transfer* transfer,
  const stratus_camera* camera, const stratus_path_options* options, const stratus_image* image, stratus_path_scene* scene)
{
  field_inputs field;
  view_inputs view;
  void* memory = NULL;
  stratus_path_field_set(&t->field, volume, transfer, options);
  stratus_path_scene_set(scene, &t->field, camera, options);
  gather_field(volume, transfer, options, &t->field, &field);
  gather_view(scene, camera, options, image, &view);
  if (!t->built || memcmp(&field, &t->field_inputs, sizeof field) != 0) {
    drop_image(t);
    t->built = false;
    TRY(stratus_path_field_build(t->context, &t->field));
    memcpy(&t->field_inputs, &field, sizeof field);
    t->built = true;
  }
  if (t->pixels && memcmp(&view, &t->view_inputs, sizeof view) == 0) {
    return STRATUS_OK;
  }
  drop_image(t);
  TRY(stratus_allocate_zero(t->context, (size_t)image->width * (size_t)image->height, sizeof *t->pixels, &memory));
  t->pixels = memory;
  memcpy(&t->view_inputs, &view, sizeof view);
  return STRATUS_OK;
}

/* ---- passes */

typedef struct pass {
  const stratus_path_tracer* tracer;
  const stratus_path_scene* scene;
  const stratus_camera* camera;
  const stratus_image* image;
  double eye[3];    /* place */
  uint64_t samples; /* that each pixel has after the pass */
  int tiles_across;
} pass;

/* Gives the camera's ray through a pixel, and its direction in the world. */
static stratus_path_ray camera_ray(const pass* p, int x, int y, double direction[3])
{
  const stratus_path_field* f = &p->tracer->field;
  const stratus_camera* camera = p->camera;
  const int sides[2] = { p->image->width, p->image->height };
  const size_t at = (size_t)y * (size_t)sides[0] + (size_t)x;
  stratus_path_ray ray = { .begin = 0.0 };
  double from[3], far_k = camera->far_k;
  stratus_camera_ray(camera, sides, x, y, from, direction);
  stratus_path_turn_to_place(f, from, ray.from);
  for (int a = 0; a < 3; ++a) {
    ray.from[a] += p->eye[a];
  }
  if (p->image->opaque_depth) {
    far_k = fmin(far_k, stratus_camera_place(camera, (double)p->image->opaque_depth[at]));
  }
  const double length = stratus_vector_normalize(direction);
  ray.begin = camera->near_k * length;
  ray.end = far_k * length;
  stratus_path_turn_to_place(f, direction, ray.along);
  stratus_path_clip(f, &ray);
  return ray;
}

static void trace_pixel(const pass* p, int x, int y, uint64_t counts[STRATUS_TILE_COUNTS])
{
  const size_t number = (size_t)y * (size_t)p->image->width + (size_t)x;
  pixel* of = &p->tracer->pixels[number];
  double direction[3];
  const stratus_path_ray ray = camera_ray(p, x, y, direction);
  if (!(ray.begin < ray.end)) {
    of->count = p->samples;
  }
  for (; of->count < p->samples; ++of->count) {
    double rgba[4];
    stratus_path_random random = stratus_path_random_of(p->tracer->view_inputs.seed, (uint32_t)number, of->count);
    const double depth = stratus_path_trace(p->scene, &p->tracer->field, &ray, direction, &random, rgba, &counts[0], &counts[1]);
    if (isfinite(depth)) {
      of->depth = of->sum[3] > 0.0 ? fmin(of->depth, depth) : depth;
    }
    for (int c = 0; c < 4; ++c) {
      of->sum[c] += rgba[c];
      of->square[c] += rgba[c] * rgba[c];
    }
  }
}

static void trace_tile(const void* job, int tile, uint64_t counts[STRATUS_TILE_COUNTS])
{
  const pass* p = job;
  const int x0 = tile % p->tiles_across * TILE, y0 = tile / p->tiles_across * TILE;
  for (int y = y0; y < y0 + TILE && y < p->image->height; ++y) {
    for (int x = x0; x < x0 + TILE && x < p->image->width; ++x) {
      trace_pixel(p, x, y, counts);
    }
  }
}

static stratus_status run_pass(stratus_path_tracer* t, pass* p)
{
  uint64_t counts[STRATUS_TILE_COUNTS] = { 0 };
  const int tiles = p->tiles_across * ((p->image->height + TILE - 1) / TILE);
  const double began = stratus_now_ms();
  const stratus_status status = stratus_each_tile(t->context, "path tracing", tiles, trace_tile, p, counts);
  t->vertices += counts[0];
  t->lookups += counts[1];
  t->ms += stratus_now_ms() - began;
  t->samples = status == STRATUS_OK ? p->samples : t->samples;
  return status;
}

/* ---- the image and its errors */

/* Returns the standard error of a channel's mean; NaN after 1 sample. */
static double error_of(const pixel* of, int channel)
{
  const double count = (double)of->count, mean = of->sum[channel] / count;
  return count > 1.0 ? sqrt(fmax(of->square[channel] / count - mean * mean, 0.0) / (count - 1.0)) : (double)NAN;
}

/* Returns the root mean square of the errors, and finds the largest one. */
static double image_error(const stratus_path_tracer* t, double* largest)
{
  const size_t pixels = (size_t)t->view_inputs.width * (size_t)t->view_inputs.height;
  double squares = 0.0, count = 0.0;
  *largest = 0.0;
  for (size_t i = 0; i < pixels; ++i) {
    for (int c = 0; c < 4 && t->pixels[i].sum[3] > 0.0; ++c) {
      const double error = error_of(&t->pixels[i], c);
      squares += error * error;
      *largest = error <= *largest ? *largest : error;
      count += 1.0;
    }
  }
  return count > 0.0 ? sqrt(squares / count) : 0.0;
}

/* Returns the number of samples until the error is compared again, `last` at most. */
static uint64_t next_stop(const stratus_path_tracer* t, double tolerance, double error, uint64_t last)
{
  if (!(tolerance > 0.0)) {
    return last;
  }
  const double now = (double)t->samples, ratio = error / tolerance;
  const double wanted = t->samples < SAMPLES_FIRST ? SAMPLES_FIRST : now * fmin(ratio * ratio, GROWTH_MOST);
  const double rounded = ceil(fmax(wanted, now + 1.0) / SAMPLES_FIRST) * SAMPLES_FIRST;
  return rounded < (double)last ? (uint64_t)rounded : last;
}

static stratus_status run_passes(stratus_path_tracer* t, pass* p, const stratus_path_options* options)
{
  const uint64_t last = t->samples + (uint64_t)options->samples;
  while (t->samples < last) {
    double largest;
    const double error = t->samples < SAMPLES_FIRST || options->tolerance == 0.0 ? (double)NAN : image_error(t, &largest);
    if (error <= options->tolerance) {
      break;
    }
    p->samples = next_stop(t, options->tolerance, error, last);
    TRY(run_pass(t, p));
  }
  return STRATUS_OK;
}

static void write_image(const stratus_path_tracer* t, const stratus_image* image)
{
  const size_t pixels = (size_t)image->width * (size_t)image->height;
  for (size_t i = 0; i < pixels; ++i) {
    const pixel* of = &t->pixels[i];
    for (int c = 0; c < 4; ++c) {
      image->rgba[4 * i + (size_t)c] = (float)(of->sum[c] / (double)of->count);
    }
    if (image->depth) {
      image->depth[i] = of->sum[3] > 0.0 ? (float)of->depth : INFINITY;
    }
    if (image->samples) {
      image->samples[i] = of->count < UINT32_MAX ? (uint32_t)of->count : UINT32_MAX;
    }
  }
  stratus_image_fill_bytes(image);
}

stratus_status stratus_path_tracer_render(stratus_path_tracer* tracer, const stratus_volume* volume, const stratus_transfer* transfer,
  const stratus_camera* camera, const stratus_path_options* options, const stratus_image* image, stratus_path_report* report)
{
  if (!tracer) {
    return STRATUS_INVALID_ARGUMENT;
  }
  const stratus_path_options defaults = stratus_path_options_default();
  stratus_path_scene scene;
  options = options ? options : &defaults;
  TRY(stratus_path_check(tracer->context, volume, transfer, camera, options, image));
  TRY(update(tracer, volume, transfer, camera, options, image, &scene));
  const bool restarted = tracer->samples == 0;
  pass p = { .tracer = tracer, .scene = &scene, .camera = camera, .image = image, .tiles_across = (image->width + TILE - 1) / TILE };
  stratus_path_to_place(&tracer->field, camera->eye, p.eye);
  TRY(run_passes(tracer, &p, options));
  write_image(tracer, image);
  if (report) {
    *report = (stratus_path_report){ .samples = tracer->samples,
      .vertices = tracer->vertices,
      .lookups = tracer->lookups,
      .seconds = 1e-3 * tracer->ms,
      .restarted = restarted };
    report->standard_error = image_error(tracer, &report->largest_error);
  }
  return STRATUS_OK;
}

stratus_status stratus_path_tracer_errors(const stratus_path_tracer* tracer, float* errors)
{
  if (!tracer) {
    return STRATUS_INVALID_ARGUMENT;
  }
  if (!errors) {
    return stratus_fail(tracer->context, STRATUS_INVALID_ARGUMENT, "errors is NULL");
  }
  if (!tracer->pixels || tracer->samples == 0) {
    return stratus_fail(tracer->context, STRATUS_INVALID_ARGUMENT, "the tracer has no image of which to give errors");
  }
  const size_t values = 4 * (size_t)tracer->view_inputs.width * (size_t)tracer->view_inputs.height;
  for (size_t i = 0; i < values; ++i) {
    errors[i] = (float)error_of(&tracer->pixels[i / 4], (int)(i % 4));
  }
  return STRATUS_OK;
}
