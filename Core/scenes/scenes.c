/* SPDX-License-Identifier: BSD-3-Clause
 * The volumes of record, defined to the last voxel, so that figures measured on them can be compared over years. A noise field is cut at an
 * exact quantile, which fixes the occupied fraction, and the values above the cut are shaded. All arithmetic is in single precision without
 * fused operations. A scene is never changed. */
#include "stratus/scenes.h"
#include "volume.h"
#include "scenes_archipelago.h"
#include "scenes_fields.h"
#include "scenes_media.h"
#include "scenes_transfers.h"

#include <omp.h>
#include <stdio.h>
#include <string.h>

#define SLABS 16

typedef struct recipe {
  const char* name;
  int components;
  int n[3];
  stratus_type type;
  int up_axis;
  double quantile;
  double top; /* upper end of the scalar range */
  double opacity;
  void (*field)(const field_tables* tables, int j, int k, float* row); /* NULL: a single voxel is set, or an archipelago */
  /* Shades a row. threshold: the field's quantile; height: the field's maximum less the threshold. `values` may be `row`. */
  void (*shade)(int j, int k, const float* row, float threshold, float height, void* values);
} recipe;

typedef struct scene_storage {
  stratus_scene scene; /* first member, so that stratus_scene_destroy() can cast the caller's pointer */
  void* values;
  scene_functions functions;
  stratus_transfer transfers[2];
  double heights[CUMULUS_LEVELS]; /* of a scene on levels */
} scene_storage;

/* clang-format off */
static const recipe recipes[] = {
  { "cloud", 1, { 256, 128, 256 }, STRATUS_FLOAT32, 1, .97, 1.0,   0.6,   cloud_field, cloud_shade },
  { "plume", 1, { 512, 512, 256 }, STRATUS_UINT8,   2, .99, 255.0, 0.35,  plume_field, plume_shade },
  { "fog",   1, { 256, 256, 256 }, STRATUS_FLOAT32, 1, .20, 1.0,   0.03,  fog_field,   fog_shade },
  { "haze",  1, { 256, 256, 256 }, STRATUS_FLOAT32, 1, .20, 1.0,   0.003, fog_field,   fog_shade },
  { "peak",  1, { 256, 256, 256 }, STRATUS_FLOAT32, 1, .20, 1.0,   0.03,  fog_field,   fog_shade },
  { "voxel", 1, { 256, 256, 256 }, STRATUS_UINT8,   1, 0.0, 255.0, 0.9,   NULL,        NULL },
  { "plume2", 2, { 512, 512, 256 }, STRATUS_UINT8, 2, .99, 255.0, 0.35, plume_field, plume_shade },
  { "bone",    1, { 256, 256, 256 }, STRATUS_UINT16,  1, 0.0, 4095.0, 0.0, ct_field,      ct_shade },
  { "skin",    1, { 256, 256, 256 }, STRATUS_UINT16,  1, 0.0, 4095.0, 0.0, ct_field,      ct_shade },
  { "stripes", 1, { 256, 256, 256 }, STRATUS_FLOAT32, 1, 0.0, 1.0,    0.0, stripes_field, stripes_shade },
  { "shell",   1, { 256, 256, 256 }, STRATUS_FLOAT32, 1, .05, 1.0,    0.0, fog_field,     shell_shade },
  { "plate",   1, { 256, 256, 256 }, STRATUS_FLOAT32, 1, .05, 1.0,    0.0, fog_field,     plate_shade },
  { "archipelago-1024", 1, { ARCHIPELAGO_SIDE, ARCHIPELAGO_SIDE, ARCHIPELAGO_SIDE }, STRATUS_UINT8, 2, 0.0, 255.0, 0.5, NULL, NULL },
  { "labels",  1, { LABEL_SIDE, LABEL_SIDE, LABEL_SIDE }, STRATUS_UINT8, 1, 0.0, 10.0, 0.0, labels_field, labels_shade },
  { "cumulus-rectilinear", 1, { 256, 256, CUMULUS_LEVELS }, STRATUS_FLOAT32, 2, .95, 1.0, 0.6, cumulus_field, cumulus_shade },
};
/* clang-format on */
#define RECIPES ((int)(sizeof recipes / sizeof recipes[0]))

/* ---------------------------------------------------------------- values */

/* Maps a float to an unsigned integer; the integers have the floats' order. */
static uint32_t sort_key(float value)
{
  uint32_t bits;
  memcpy(&bits, &value, sizeof bits);
  return bits & 0x80000000u ? ~bits : bits | 0x80000000u;
}

/* Finds the rank-th smallest value (from 0) exactly. Counts of the keys' upper 11, middle 11 and lower 10 bits need no copy to
 * partition. */
static stratus_status select_rank(stratus_context* context, const float* values, int64_t count, int64_t rank, float* value)
{
  const int threads = context->threads;
  void* memory;
  TRY(stratus_allocate(context, 1 + (size_t)threads, sizeof(int64_t[2048]), &memory)); /* not on threads' stacks, which may be small */
  int64_t(*const rooms)[2048] = memory;
  int64_t* const total = rooms[threads];
  static const int shifts[] = { 21, 10, 0 };
  static const uint32_t masks[] = { 0x7ff, 0x7ff, 0x3ff };
  uint32_t prefix = 0;
  for (int pass = 0; pass < 3; ++pass) {
    const int shift = shifts[pass];
    const uint32_t mask = masks[pass];
    const uint32_t done = pass ? ~0u << shifts[pass - 1] : 0u;
    memset(total, 0, sizeof rooms[0]);
#pragma omp parallel num_threads(threads)
    {
      int64_t* const bins = rooms[omp_get_thread_num()];
      memset(bins, 0, sizeof rooms[0]);
#pragma omp for nowait
      for (int64_t q = 0; q < count; ++q) {
        const uint32_t key = sort_key(values[q]);
        if ((key & done) == prefix) {
          ++bins[(key >> shift) & mask];
        }
      }
#pragma omp critical(stratus_scene_select)
      for (int b = 0; b < 2048; ++b) {
        total[b] += bins[b];
      }
    }
    uint32_t bin = 0;
    while (rank >= total[bin]) {
      rank -= total[bin++];
    }
    prefix |= bin << shift;
  }
  const uint32_t bits = prefix & 0x80000000u ? prefix & 0x7fffffffu : ~prefix;
  memcpy(value, &bits, sizeof *value);
  stratus_release(context, memory);
  return STRATUS_OK;
}

/* Computes the field and shades it, slab by slab, so that the caller can cancel. */
static stratus_status build_values(stratus_context* context, const recipe* recipe, const field_tables* tables, float* field, void* values)
{
  const int nx = recipe->n[0], ny = recipe->n[1], nz = recipe->n[2], threads = context->threads;
  const size_t size = stratus_type_size(recipe->type);
  const int64_t count = (int64_t)nx * ny * nz;
  float top = -INFINITY;
  for (int slab = 0; slab < SLABS; ++slab) {
    TRY(stratus_progress(context, "scene", .6 * slab / SLABS));
#pragma omp parallel for schedule(dynamic, 8) num_threads(threads) reduction(max : top)
    for (int r = ny * (nz * slab / SLABS); r < ny * (nz * (slab + 1) / SLABS); ++r) {
      float* row = field + (int64_t)r * nx;
      recipe->field(tables, r % ny, r / ny, row);
      for (int i = 0; i < nx; ++i) {
        top = row[i] > top ? row[i] : top;
      }
    }
  }
  float threshold;
  TRY(select_rank(context, field, count, (int64_t)(recipe->quantile * (double)(count - 1)), &threshold));
  const float height = top - threshold;
  for (int slab = 0; slab < SLABS; ++slab) {
    TRY(stratus_progress(context, "scene", .7 + .3 * slab / SLABS));
#pragma omp parallel for schedule(dynamic, 8) num_threads(threads)
    for (int r = ny * (nz * slab / SLABS); r < ny * (nz * (slab + 1) / SLABS); ++r) {
      const size_t at = (size_t)r * (size_t)nx;
      recipe->shade(r % ny, r / ny, field + at, threshold, height, (char*)values + at * size);
    }
  }
  return STRATUS_OK;
}

static stratus_status fill_values(stratus_context* context, const recipe* recipe, void* values)
{
  void* tables = NULL;
  void* field = NULL;
  stratus_status status;
  const size_t count = (size_t)recipe->n[0] * (size_t)recipe->n[1] * (size_t)recipe->n[2];
  if (strcmp(recipe->name, "archipelago-1024") == 0) {
    return stratus_archipelago_fill(context, values);
  }
  if (!recipe->field) {
    memset(values, 0, count);
    ((uint8_t*)values)[((size_t)131 * 256 + 120) * 256 + 140] = 255;
    return STRATUS_OK;
  }
  TRY_CLEANUP(stratus_allocate_zero(context, 1, sizeof(field_tables), &tables));
  if (recipe->type != STRATUS_FLOAT32) {
    TRY_CLEANUP(stratus_allocate(context, count, sizeof(float), &field));
  }
  cloud_tables(tables);
  plume_tables(tables);
  TRY_CLEANUP(build_values(context, recipe, tables, field ? field : values, values));
cleanup:
  stratus_release(context, field);
  stratus_release(context, tables);
  return status;
}

static void measure(stratus_scene* scene, int threads)
{
  const int64_t row = scene->volume.dimensions[0];
  const int64_t rows = scene->volume.dimensions[1] * scene->volume.dimensions[2];
  int64_t occupied = 0;
  double slices[ARCHIPELAGO_SIDE] = { 0 }; /* sums in a fixed order, so that the mean does not depend on the number of threads */
  const int64_t per_slice = scene->volume.dimensions[1];
#pragma omp parallel for num_threads(threads) reduction(+ : occupied)
  for (int64_t k = 0; k < rows / per_slice; ++k) {
    for (int64_t q = k * per_slice * row; q < (k + 1) * per_slice * row; ++q) {
      const int64_t at = q * scene->volume.value_stride;
      const double value = scene->volume.type == STRATUS_UINT8 ? (double)((const uint8_t*)scene->volume.values)[at]
        : scene->volume.type == STRATUS_UINT16                 ? (double)((const uint16_t*)scene->volume.values)[at]
                                                               : (double)((const float*)scene->volume.values)[at];
      occupied += value > 0.0;
      slices[k] += value;
    }
  }
  double sum = 0.0;
  for (int64_t k = 0; k < rows / per_slice; ++k) {
    sum += slices[k];
  }
  scene->occupied = (double)occupied / (double)(rows * row);
  scene->mean = sum / (double)(rows * row);
}

static void set_transfer(scene_storage* storage, const recipe* recipe)
{
  set_functions(recipe->name, recipe->top, recipe->opacity, &storage->functions, &storage->scene.transfer, &storage->scene.edited);
  const double second_color[][4] = { { 0, .95, .75, .25 }, { recipe->top, .8, .2, .1 } };
  memcpy(storage->functions.second_color, second_color, sizeof second_color);
  storage->transfers[0] = storage->transfers[1] = storage->scene.transfer;
  storage->transfers[1].color = storage->functions.second_color[0];
  storage->transfers[1].color_count = 2;
  storage->scene.transfers = storage->transfers;
}

/* Splits the plume into two pollutants in place: the first turns into the second on its way along x. Integers make this exact. */
static void split_plume(const recipe* recipe, uint8_t* values)
{
  const int64_t count = (int64_t)recipe->n[0] * recipe->n[1] * recipe->n[2];
  for (int64_t q = count - 1; q >= 0; --q) { /* backwards: each value is written at an index above the values still to be read */
    const int along = (int)(q % recipe->n[0]), way = along > 8 ? along - 8 : 0, all = recipe->n[0] - 8;
    const int value = values[q];
    values[2 * q] = (uint8_t)((value * (all - way) + all / 2) / all);
    values[2 * q + 1] = (uint8_t)((value * way + all / 2) / all);
  }
}

/* ---------------------------------------------------------------- public functions */

int stratus_scene_count(void)
{
  return RECIPES;
}

const char* stratus_scene_name(int index)
{
  return index >= 0 && index < RECIPES ? recipes[index].name : NULL;
}

static stratus_status find_recipe(stratus_context* context, const char* name, const recipe** result)
{
  char names[224] = "";
  for (int i = 0; i < RECIPES; ++i) {
    if (name && strcmp(name, recipes[i].name) == 0) {
      *result = recipes + i;
      return STRATUS_OK;
    }
    const size_t used = strlen(names);
    snprintf(names + used, sizeof names - used, "%s%s", i ? ", " : "", recipes[i].name);
  }
  return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "unknown scene \"%.100s\"; there are: %s", name ? name : "(null)", names);
}

stratus_status stratus_scene_create(stratus_context* context, const char* name, stratus_scene** scene)
{
  const recipe* recipe = NULL;
  void* memory = NULL;
  if (!context) {
    return STRATUS_INVALID_ARGUMENT;
  }
  if (!scene) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "the scene's address is NULL");
  }
  TRY(find_recipe(context, name, &recipe));
  TRY(stratus_allocate_zero(context, 1, sizeof(scene_storage), &memory));
  scene_storage* storage = memory;
  const size_t count = (size_t)recipe->n[0] * (size_t)recipe->n[1] * (size_t)recipe->n[2];
  stratus_status status;
  TRY_CLEANUP(stratus_allocate(context, count, stratus_type_size(recipe->type) * (size_t)recipe->components, &storage->values));
  TRY_CLEANUP(fill_values(context, recipe, storage->values));
  if (recipe->components == 2) {
    split_plume(recipe, storage->values);
  }

  storage->scene.name = recipe->name;
  storage->scene.up_axis = recipe->up_axis;
  storage->scene.volume = stratus_volume_default();
  storage->scene.volume.values = storage->values;
  storage->scene.volume.type = recipe->type;
  storage->scene.volume.components = recipe->components;
  storage->scene.volume.value_stride = recipe->components;
  for (int a = 0; a < 3; ++a) {
    storage->scene.volume.dimensions[a] = recipe->n[a];
    storage->scene.volume.spacing[a] = 1.0;
  }
  for (int k = 0; recipe->field == cumulus_field && k < CUMULUS_LEVELS; ++k) {
    storage->heights[k] = cumulus_height(k);
    storage->scene.volume.coordinates[2] = storage->heights;
    storage->scene.volume.spacing[2] = storage->heights[k] / (k > 0 ? k : 1); /* the mean one, at last */
  }
  set_transfer(storage, recipe);
  measure(&storage->scene, context->threads);
cleanup:
  if (status != STRATUS_OK) {
    stratus_scene_destroy(context, &storage->scene);
    return status;
  }
  *scene = &storage->scene;
  return STRATUS_OK;
}

void stratus_scene_destroy(stratus_context* context, stratus_scene* scene)
{
  if (context && scene) {
    scene_storage* storage = (scene_storage*)scene;
    stratus_release(context, storage->values);
    stratus_release(context, storage);
  }
}

stratus_status stratus_scene_camera(
  stratus_context* context, const double bounds[6], int up_axis, int view, int parallel, double aspect, stratus_camera* camera)
{
  const double degree = 3.14159265358979323846 / 180.0;
  double focal[3], up[3] = { 0.0, 0.0, 0.0 }, direction[3], eye[3], square = 0.0;
  if (!context) {
    return STRATUS_INVALID_ARGUMENT;
  }
  if (!bounds || !camera) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "the bounds' or the camera's address is NULL");
  }
  if (up_axis < 0 || up_axis > 2) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "up axis %d outside 0..2", up_axis);
  }
  if (view < 0 || view > 7) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "view %d outside 0..7", view);
  }
  for (int a = 0; a < 3; ++a) {
    const double lo = bounds[2 * a], hi = bounds[2 * a + 1];
    if (!isfinite(lo) || !isfinite(hi) || lo > hi) {
      return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "bounds %g..%g along axis %d are not an ordered finite range", lo, hi, a);
    }
    focal[a] = .5 * (lo + hi);
    square += (hi - lo) * (hi - lo);
  }
  const double radius = .5 * sqrt(square);
  if (!(radius > 0.0) || !isfinite(radius)) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "half the bounds' diagonal is %g, must be above 0", radius);
  }
  const double elevation = 25.0 * degree;
  const double azimuth = (30.0 + 45.0 * view) * degree;
  direction[up_axis] = sin(elevation);
  direction[(up_axis + 1) % 3] = cos(elevation) * cos(azimuth);
  direction[(up_axis + 2) % 3] = cos(elevation) * sin(azimuth);
  up[up_axis] = 1.0;
  for (int a = 0; a < 3; ++a) {
    eye[a] = focal[a] + radius / sin(15.0 * degree) * direction[a];
  }
  return parallel ? stratus_camera_parallel(context, eye, focal, up, .72 * radius, aspect, camera)
                  : stratus_camera_perspective(context, eye, focal, up, 21.6, aspect, camera);
}
