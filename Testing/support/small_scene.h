/* SPDX-License-Identifier: BSD-3-Clause
 * A volume of a few hundred values, and every function of the core that takes one, for tests that repeat all of it for each call that can
 * fail. */
#ifndef STRATUS_SMALL_SCENE_H
#define STRATUS_SMALL_SCENE_H

#include "stratus.h"

#include <math.h>
#include <string.h>

#define SMALL_X 9
#define SMALL_Y 7
#define SMALL_Z 8
#define SMALL_VALUES (SMALL_X * SMALL_Y * SMALL_Z)
#define SMALL_WIDTH 12
#define SMALL_HEIGHT 10
#define SMALL_PIXELS (SMALL_WIDTH * SMALL_HEIGHT)
#define SMALL_SETTINGS 15

typedef struct small_scene {
  double values[SMALL_VALUES]; /* a wide type, which is converted when it is fetched */
  uint8_t cell_ghosts[(SMALL_X - 1) * (SMALL_Y - 1) * (SMALL_Z - 1)];
  stratus_volume volume;
  stratus_transfer transfer, edited;
  stratus_camera camera;
} small_scene;

typedef struct small_picture {
  float rgba[4 * SMALL_PIXELS];
  float depth[SMALL_PIXELS];
  uint32_t samples[SMALL_PIXELS];
} small_picture;

static const double small_opacity[] = { 1e6, 0.0, 1e6 + 0.2, 0.0, 1e6 + 1.0, 0.6 };
static const double small_edited[] = { 1e6, 0.0, 1e6 + 0.4, 0.0, 1e6 + 0.6, 0.8, 1e6 + 0.8, 0.0 };
static const double small_color[] = { 1e6, 0.1, 0.2, 0.9, 1e6 + 1.0, 1.0, 0.8, 0.3 };

/* A ball in one corner of an empty box. Single precision would lose the offset of its values. One value is NaN and one cell is hidden. */
static inline void small_scene_fill(small_scene* scene)
{
  memset(scene, 0, sizeof *scene);
  for (int q = 0; q < SMALL_VALUES; ++q) {
    const int x = q % SMALL_X - 2, y = q / SMALL_X % SMALL_Y - 2, z = q / (SMALL_X * SMALL_Y) - 3;
    const double inside = 1.0 - (double)(x * x + y * y + z * z) / 9.0;
    scene->values[q] = 1e6 + (inside > 0.0 ? inside : 0.0);
  }
  scene->values[SMALL_VALUES - 1] = NAN;
  scene->cell_ghosts[0] = STRATUS_GHOST_HIDDEN_CELL;
  scene->volume = stratus_volume_default();
  scene->volume.values = scene->values;
  scene->volume.type = STRATUS_FLOAT64;
  scene->volume.dimensions[0] = SMALL_X;
  scene->volume.dimensions[1] = SMALL_Y;
  scene->volume.dimensions[2] = SMALL_Z;
  scene->volume.spacing[0] = scene->volume.spacing[1] = scene->volume.spacing[2] = 1.0;
  scene->volume.cell_ghosts = scene->cell_ghosts;
  scene->transfer = stratus_transfer_default();
  scene->transfer.opacity = small_opacity;
  scene->transfer.opacity_count = 3;
  scene->transfer.color = small_color;
  scene->transfer.color_count = 2;
  scene->edited = scene->transfer;
  scene->edited.opacity = small_edited;
  scene->edited.opacity_count = 4;
}

/* A camera that sees the ball. It needs no memory, so that it can be made before any call fails. */
static inline stratus_status small_scene_camera(stratus_context* context, small_scene* scene)
{
  double bounds[6];
  const stratus_status status = stratus_volume_bounds(context, &scene->volume, bounds);
  return status == STRATUS_OK ? stratus_scene_camera(context, bounds, 1, 2, 0, (double)SMALL_WIDTH / SMALL_HEIGHT, &scene->camera) : status;
}

/* A mask that removes the far half. */
static inline const uint8_t* small_mask(void)
{
  static _Thread_local uint8_t mask[SMALL_VALUES];
  for (int q = 0; q < SMALL_VALUES; ++q) {
    mask[q] = q < SMALL_VALUES * 3 / 4;
  }
  return mask;
}

/* A function of two variables that shows the ball, the more so the steeper it is; and an edited one. */
static inline const stratus_transfer_2d* small_transfer_2d(int edited)
{
  static const float rgba[2][16] = { { 0, 0, 0, 0, 1, 0.5f, 0.2f, 0.3f, 0, 0, 0, 0, 0.2f, 0.5f, 1, 0.8f },
    { 0, 0, 0, 0, 0.2f, 0.9f, 0.2f, 0.5f, 0, 0, 0, 0, 0.2f, 0.5f, 1, 0.1f } };
  static const stratus_transfer_2d functions[2] = {
    { .rgba = rgba[0], .columns = 2, .rows = 2, .value_range = { 1e6, 1e6 + 1.0 }, .second_range = { 0.0, 0.5 }, .unit_distance = 1.0 },
    { .rgba = rgba[1], .columns = 2, .rows = 2, .value_range = { 1e6, 1e6 + 1.0 }, .second_range = { 0.0, 0.5 }, .unit_distance = 1.0 }
  };
  return functions + edited;
}

/* Setting 0..SMALL_SETTINGS-1: first all structures, both samplings, both interpolations and an audit, then modes, masks and crop
 * regions, a slice, and a function of two variables. */
static inline stratus_ray_cast_options small_setting(int index)
{
  static const stratus_mode modes[] = { STRATUS_MODE_MAXIMUM, STRATUS_MODE_AVERAGE, STRATUS_MODE_ADDITIVE, STRATUS_MODE_ISOSURFACE,
    STRATUS_MODE_COMPOSITE, STRATUS_MODE_SLICE, STRATUS_MODE_COMPOSITE };
  stratus_ray_cast_options options = stratus_ray_cast_options_default();
  options.skipping.structure = (stratus_structure)(index % 5);
  options.sampling.rule = index == 5 ? STRATUS_SAMPLING_AUTO : index % 2 ? STRATUS_SAMPLING_PREINTEGRATED : STRATUS_SAMPLING_MIDPOINT;
  options.skipping.block_size = index == 3 ? 2 : 0;
  options.sampling.interpolation = index == 7 ? STRATUS_INTERPOLATION_NEAREST : STRATUS_INTERPOLATION_LINEAR;
  options.skipping.audit = index == 6;
  if (index >= 8) {
    options.mode = modes[index - 8];
    options.optics.contour_count = 1;
    options.optics.contours[0] = 1e6 + 0.5;
    options.mask.bytes = index % 2 ? small_mask() : NULL;
    options.clipping.crop = index == 12;
    options.clipping.crop_regions = STRATUS_CROP_ALL - STRATUS_CROP_INSIDE; /* all regions but the middle one */
    for (int side = 0; index == 12 && side < 6; ++side) {
      options.clipping.crop_bounds[side] = side % 2 ? 3.0 : 2.0;
    }
    options.sampling.jitter = index == 12;
    options.slice = (stratus_slice){ .center = { 2.0, 2.0, 3.0 }, .linear = { 0.2, 0.4, 1.0 } };
    options.optics.transfer_2d = index == 14 ? small_transfer_2d(0) : NULL;
    options.sampling.rule = index == 14 ? STRATUS_SAMPLING_MIDPOINT : options.sampling.rule;
  }
  return options;
}

static inline stratus_status small_render(stratus_ray_caster* caster, const small_scene* scene, const stratus_transfer* transfer,
  int setting, small_picture* picture, stratus_ray_cast_report* report)
{
  stratus_ray_cast_options options = small_setting(setting);
  if (options.optics.transfer_2d && transfer == &scene->edited) { /* it holds in place of the function of the value */
    options.optics.transfer_2d = small_transfer_2d(1);
  }
  const stratus_image image = {
    .width = SMALL_WIDTH, .height = SMALL_HEIGHT, .rgba = picture->rgba, .depth = picture->depth, .samples = picture->samples
  };
  memset(picture, 0xff, sizeof *picture);
  return stratus_ray_caster_render(caster, &scene->volume, transfer, &scene->camera, &options, &image, report);
}

static inline uint64_t small_mix(uint64_t sum, uint64_t value)
{
  return (sum ^ value) * 0x100000001b3u;
}

/* Builds each structure separately; *sum depends on all their contents. Everything is released, even after a failure. */
static inline stratus_status small_structures(stratus_context* context, const small_scene* scene, uint64_t* sum)
{
  stratus_value_range* ranges = NULL;
  stratus_occupancy* occupancy = NULL;
  stratus_distance_map* map = NULL;
  int64_t n[3];
  *sum = 0;
  stratus_status status = stratus_value_range_create(context, &scene->volume, 2, &ranges);
  for (int sampling = STRATUS_SAMPLING_MIDPOINT; status == STRATUS_OK && sampling <= STRATUS_SAMPLING_PREINTEGRATED; ++sampling) {
    status = stratus_occupancy_create(context, ranges, &scene->transfer, (stratus_sampling)sampling, &occupancy);
    if (status != STRATUS_OK) {
      break;
    }
    stratus_occupancy_blocks(occupancy, n, NULL);
    for (int kind = STRATUS_DISTANCE_BLOCK; kind <= STRATUS_DISTANCE_OCTANT && status == STRATUS_OK; ++kind) {
      status = stratus_distance_map_create(context, occupancy, (stratus_distance_kind)kind, &map);
      for (int64_t b = 0; status == STRATUS_OK && b < 8 * n[0] * n[1] * n[2]; ++b) {
        const int64_t q = b / 8;
        *sum = small_mix(*sum, (uint64_t)stratus_distance_map_get(map, (int)(b % 8), q % n[0], q / n[0] % n[1], q / (n[0] * n[1])));
      }
      stratus_distance_map_destroy(map);
      map = NULL;
    }
    *sum = small_mix(*sum, (uint64_t)stratus_occupancy_count(occupancy));
    stratus_occupancy_destroy(occupancy);
    occupancy = NULL;
  }
  stratus_value_range_destroy(ranges);
  return status;
}

#endif
