/* SPDX-License-Identifier: BSD-3-Clause
 * Every kernel on volumes of a few values, on the first OpenCL device: structures as the host builds them, and every structure's picture
 * equal to the plain march's. Small enough for a simulator that checks each access; so no test library, an exit status only. */
#include "stratus.h"
#include "volume.h"

#include "calibration_picture.h"
#include "device_state.h"
#include "testing.h"
#include "volume.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define SIDE 8
#define VALUES_MAX (9 * 9 * 9)

typedef struct tiny {
  const char* name;
  stratus_type type;
  int64_t n[3];
  int cell_centered;
  int ghosts;
  stratus_interpolation interpolation;
} tiny;

typedef struct picture {
  float rgba[4 * SIDE * SIDE];
  float depth[SIDE * SIDE];
  uint32_t samples[SIDE * SIDE];
} picture;

/* clang-format off */
static const tiny volumes[] = {
  { "uint8 9x9x9",           STRATUS_UINT8,   { 9, 9, 9 }, 0, 0, STRATUS_INTERPOLATION_LINEAR },
  { "int16 5x4x3",           STRATUS_INT16,   { 5, 4, 3 }, 1, 0, STRATUS_INTERPOLATION_LINEAR },
  { "float32 9x7x8, ghosts", STRATUS_FLOAT32, { 9, 7, 8 }, 0, 1, STRATUS_INTERPOLATION_LINEAR },
  { "float32 6x5x4 nearest", STRATUS_FLOAT32, { 6, 5, 4 }, 0, 0, STRATUS_INTERPOLATION_NEAREST },
  { "float64 3x8x2",         STRATUS_FLOAT64, { 3, 8, 2 }, 0, 0, STRATUS_INTERPOLATION_LINEAR },
  { "uint32 4x1x6",          STRATUS_UINT32,  { 4, 1, 6 }, 1, 0, STRATUS_INTERPOLATION_NEAREST },
};
/* clang-format on */

static const double opacity[] = { 0, 0, 40, 0, 60, .9, 80, 0, 100, .5 };
static const double color[] = { 0, .1, .3, .9, 100, 1, .7, .2 };

static double values[VALUES_MAX]; /* doubles, so that every type finds its alignment */
static uint8_t cell_ghosts[VALUES_MAX];

static void put(stratus_type type, int64_t at, double value)
{
  switch (type) {
    case STRATUS_UINT8:
      ((uint8_t*)values)[at] = (uint8_t)value;
      break;
    case STRATUS_INT16:
      ((int16_t*)values)[at] = (int16_t)value;
      break;
    case STRATUS_UINT32:
      ((uint32_t*)values)[at] = (uint32_t)value;
      break;
    case STRATUS_FLOAT32:
      ((float*)values)[at] = (float)value;
      break;
    default:
      values[at] = value;
  }
}

/* A tent, 0 to 100, in one corner. */
static stratus_volume fill(const tiny* t)
{
  stratus_volume volume = stratus_volume_default();
  volume.values = values;
  volume.type = t->type;
  volume.cell_centered = t->cell_centered;
  for (int a = 0; a < 3; ++a) {
    volume.dimensions[a] = t->n[a];
    volume.spacing[a] = 1.0 + .25 * a;
  }
  for (int64_t q = 0; q < t->n[0] * t->n[1] * t->n[2]; ++q) {
    const int64_t x = q % t->n[0], y = q / t->n[0] % t->n[1], z = q / (t->n[0] * t->n[1]);
    const double value = 100.0 - 17.0 * (double)(llabs(x - 1) + llabs(y - 1) + llabs(z - 2));
    put(t->type, q, value > 0.0 ? value : 0.0);
  }
  memset(cell_ghosts, 0, sizeof cell_ghosts);
  if (t->ghosts) {
    cell_ghosts[1] = STRATUS_GHOST_HIDDEN_CELL;
    put(t->type, 3, (double)NAN);
    volume.cell_ghosts = cell_ghosts;
  }
  return volume;
}

static int failed(const stratus_context* context, const char* where, const char* name)
{
  printf("FAILED: %s of %s: %s\n", where, name, stratus_context_message(context));
  return 1;
}

/* The device's structures against the host's. */
static int same_structures(stratus_context* host, stratus_context* device, const stratus_volume* volume, const stratus_transfer* transfer,
  stratus_sampling sampling, const char* name)
{
  stratus_context* contexts[2] = { host, device };
  stratus_value_range* ranges[2] = { 0 };
  stratus_occupancy* occupancies[2] = { 0 };
  int bad = 0;
  for (int s = 0; s < 2 && !bad; ++s) {
    if (stratus_value_range_create(contexts[s], volume, 2, &ranges[s]) != STRATUS_OK ||
      stratus_occupancy_create(contexts[s], ranges[s], transfer, sampling, &occupancies[s]) != STRATUS_OK) {
      bad = failed(contexts[s], "ranges and occupancy", name);
    }
  }
  const size_t blocks = bad ? 0 : (size_t)(ranges[0]->blocks[0] * ranges[0]->blocks[1] * ranges[0]->blocks[2]);
  if (!bad &&
    (memcmp(ranges[0]->lo, ranges[1]->lo, blocks * sizeof(float)) || memcmp(ranges[0]->hi, ranges[1]->hi, blocks * sizeof(float)) ||
      memcmp(ranges[0]->gaps, ranges[1]->gaps, blocks) || memcmp(occupancies[0]->occupied, occupancies[1]->occupied, blocks))) {
    printf("FAILED: ranges or occupancy of %s differ between host and device\n", name);
    bad = 1;
  }
  for (int kind = STRATUS_DISTANCE_BLOCK; kind <= STRATUS_DISTANCE_OCTANT && !bad; ++kind) {
    stratus_distance_map* maps[2] = { 0 };
    for (int s = 0; s < 2 && !bad; ++s) {
      if (stratus_distance_map_create(contexts[s], occupancies[s], (stratus_distance_kind)kind, &maps[s]) != STRATUS_OK) {
        bad = failed(contexts[s], "distance map", name);
      }
    }
    for (size_t b = 0; b < 8 * blocks && !bad; ++b) {
      const int64_t nx = ranges[0]->blocks[0], ny = ranges[0]->blocks[1], q = (int64_t)(b / 8);
      const int64_t i = q % nx, j = q / nx % ny, k = q / (nx * ny);
      if (stratus_distance_map_get(maps[0], (int)(b % 8), i, j, k) != stratus_distance_map_get(maps[1], (int)(b % 8), i, j, k)) {
        printf("FAILED: distance map %d of %s differs between host and device\n", kind, name);
        bad = 1;
      }
    }
    stratus_distance_map_destroy(maps[0]);
    stratus_distance_map_destroy(maps[1]);
  }
  for (int s = 0; s < 2; ++s) {
    stratus_occupancy_destroy(occupancies[s]);
    stratus_value_range_destroy(ranges[s]);
  }
  return bad;
}

/* Every structure against the plain march, on the device. */
static int same_pictures(stratus_context* context, const stratus_volume* volume, const stratus_transfer* transfer,
  stratus_sampling sampling, stratus_interpolation interpolation, const char* name)
{
  static picture plain, other;
  stratus_ray_caster* caster = NULL;
  stratus_camera camera;
  double bounds[6];
  int bad = 0;
  if (stratus_volume_bounds(context, volume, bounds) != STRATUS_OK ||
    stratus_scene_camera(context, bounds, 1, 2, 0, 1.0, &camera) != STRATUS_OK ||
    stratus_ray_caster_create(context, &caster) != STRATUS_OK) {
    return failed(context, "camera and ray caster", name);
  }
  for (int structure = STRATUS_STRUCTURE_NONE; structure <= STRATUS_STRUCTURE_HYBRID && !bad; ++structure) {
    picture* p = structure == STRATUS_STRUCTURE_NONE ? &plain : &other;
    stratus_ray_cast_options options = stratus_ray_cast_options_default();
    const stratus_image image = { .width = SIDE, .height = SIDE, .rgba = p->rgba, .depth = p->depth, .samples = p->samples };
    options.skipping.structure = (stratus_structure)structure;
    options.sampling.rule = sampling;
    options.sampling.interpolation = interpolation;
    options.skipping.block_size = 2;
    memset(p, 0xff, sizeof *p);
    if (stratus_ray_caster_render(caster, volume, transfer, &camera, &options, &image, NULL) != STRATUS_OK) {
      bad = failed(context, "picture", name);
    } else if (p == &plain) {
      float sum = 0.0f;
      for (int i = 0; i < SIDE * SIDE; ++i) {
        sum += plain.rgba[4 * i + 3];
      }
      if (!(sum > 0.0f)) {
        printf("FAILED: nothing to be seen of %s\n", name);
        bad = 1;
      }
    } else if (memcmp(plain.rgba, other.rgba, sizeof plain.rgba) || memcmp(plain.depth, other.depth, sizeof plain.depth)) {
      printf("FAILED: %s of %s draws another picture than none\n", stratus_structure_name((stratus_structure)structure), name);
      bad = 1;
    }
  }
  stratus_ray_caster_destroy(caster);
  return bad;
}

/* The first group of the calibration picture: all of its rays would take a simulator an hour. */
static int same_calibration(stratus_context* device)
{
  enum { VALUES = STRATUS_CALIBRATION_VALUES * STRATUS_CALIBRATION_VALUES * STRATUS_CALIBRATION_VALUES };
  static float input[VALUES + 4 * STRATUS_CALIBRATION_ENTRIES], by_host[STRATUS_CALIBRATION_FLOATS], by_device[STRATUS_CALIBRATION_FLOATS];
  const size_t group[2] = { SIDE, SIDE };
  cl_kernel kernel;
  cl_mem buffers[3] = { NULL };
  int bad = 0;
  uint32_t state = 1;
  for (size_t i = 0; i < COUNT_OF(input); ++i) {
    state = state * 1664525u + 1013904223u;
    input[i] = (float)(state >> 8) * 0x1p-24f;
  }
  stratus_calibration_tile_isa0(input, input + VALUES, 0, by_host);
  const char* defines = "-DSTRATUS_DEVICE=1 -DSTRATUS_WIDTH=1";
  bad |= stratus_device_kernel(device, "calibration_picture", defines, "calibration_picture", &kernel) != STRATUS_OK;
  bad |= stratus_device_buffer(device, CL_MEM_READ_ONLY, VALUES * sizeof(float), input, false, &buffers[0]) != STRATUS_OK;
  bad |= stratus_device_buffer(device, CL_MEM_READ_ONLY, sizeof input - VALUES * sizeof(float), input + VALUES, false, &buffers[1]) !=
    STRATUS_OK;
  bad |= stratus_device_buffer(device, CL_MEM_WRITE_ONLY, sizeof by_device, NULL, false, &buffers[2]) != STRATUS_OK;
  for (unsigned i = 0; i < 3 && !bad; ++i) {
    bad |= stratus_device_argument(device, kernel, i, sizeof(cl_mem), &buffers[i]) != STRATUS_OK;
  }
  bad = bad || stratus_device_run(device, kernel, 2, group, group) != STRATUS_OK;
  for (size_t y = 0; y < SIDE && !bad; ++y) {
    const size_t row = 4 * STRATUS_CALIBRATION_SIDE * y, bytes = 4 * SIDE * sizeof(float);
    bad |= stratus_device_read(device, buffers[2], row * sizeof(float), bytes, by_device + row) != STRATUS_OK;
    bad |= memcmp(by_host + row, by_device + row, bytes) != 0;
  }
  for (int i = 0; i < 3; ++i) {
    stratus_device_buffer_release(buffers[i]);
  }
  if (bad) {
    printf("FAILED: the calibration picture is not the host's: %s\n", stratus_context_message(device));
  }
  return bad;
}

int test_device_tiny(void)
{
  char message[1024];
  stratus_context* host = NULL;
  stratus_context* device = NULL;
  stratus_context_options options = stratus_context_options_default();
  stratus_transfer transfer = stratus_transfer_default();
  transfer.opacity = opacity;
  transfer.opacity_count = 5;
  transfer.color = color;
  transfer.color_count = 2;
  if (stratus_device_count() == 0) {
    return test_skip("no OpenCL device on this machine");
  }
  options.device = "0";
  if (stratus_context_create(&options, &device, message, sizeof message) != STRATUS_OK) {
    printf("FAILED: %s\n", message);
    return 1;
  }
  options.device = "host";
  options.threads = 1;
  if (stratus_context_create(&options, &host, message, sizeof message) != STRATUS_OK) {
    printf("FAILED: %s\n", message);
    return 1;
  }
  int bad = same_calibration(device);
  /* As a GPU, one ray a work item and structures built on the device; as a CPU, 16 rays. Each must run on whatever this is. */
  for (int cpu = 0; cpu < 2; ++cpu) {
    device->device->is_cpu = cpu;
    for (size_t v = 0; v < sizeof volumes / sizeof volumes[0]; ++v) {
      const tiny* t = volumes + v;
      const stratus_volume volume = fill(t);
      for (int s = STRATUS_SAMPLING_MIDPOINT; s <= STRATUS_SAMPLING_PREINTEGRATED; ++s) {
        if (t->interpolation == STRATUS_INTERPOLATION_NEAREST && s == STRATUS_SAMPLING_PREINTEGRATED) {
          continue;
        }
        bad += cpu ? 0 : same_structures(host, device, &volume, &transfer, (stratus_sampling)s, t->name);
        bad += same_pictures(device, &volume, &transfer, (stratus_sampling)s, t->interpolation, t->name);
      }
    }
  }
  printf("%s: %d failure(s) on %s\n", bad ? "FAILED" : "ok", bad, stratus_context_device(device));
  stratus_context_destroy(host);
  stratus_context_destroy(device);
  return bad != 0;
}
