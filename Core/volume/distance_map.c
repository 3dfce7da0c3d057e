/* SPDX-License-Identifier: BSD-3-Clause
 * Distance maps: their allocation, the choice of transform, and plain block skipping, which needs none. */
#include "volume.h"
#include "distance_sweep.h"
#include "volume_device.h"
#include "device.h"

#include <string.h>

#define PITCH 64

static void fill_block(const stratus_context* context, const stratus_occupancy* occupancy, stratus_distance_map* map)
{
  const int64_t n = map->blocks[0], rows = map->blocks[1] * map->blocks[2];
#pragma omp parallel for schedule(static) num_threads(context->threads)
  for (int64_t row = 0; row < rows; ++row) {
    const uint8_t* restrict occupied = occupancy->occupied + row * n;
    uint8_t* restrict bytes = map->bytes + (size_t)row * map->pitch;
    for (int64_t i = 0; i < n; ++i) {
      bytes[i] = (uint8_t)(occupied[i] * DISTANCE_OCCUPIED + 1);
    }
  }
}

/* Traversal may read beyond a row's end. It does not use these bytes, but they must be initialized. */
static void fill_padding(stratus_distance_map* map, size_t maps)
{
  const size_t n = (size_t)map->blocks[0], rows = maps * (size_t)(map->blocks[1] * map->blocks[2]);
  for (size_t row = 0; n < map->pitch && row < rows; ++row) {
    memset(map->bytes + row * map->pitch + n, DISTANCE_MAX, map->pitch - n);
  }
  memset(map->bytes + rows * map->pitch, DISTANCE_MAX, map->bytes_size - rows * map->pitch);
}

static stratus_status allocate_map(stratus_context* context, stratus_distance_map* map, size_t maps)
{
  size_t all;
  void* memory;
  map->pitch = ((size_t)map->blocks[0] + PITCH - 1) / PITCH * PITCH;
  TRY(stratus_product(context, "distance map", map->pitch, (size_t)map->blocks[1], (size_t)map->blocks[2], &map->map_bytes));
  TRY(stratus_product(context, "distance maps", map->map_bytes, maps, 1, &all));
  if (all > SIZE_MAX - PITCH) {
    return stratus_fail(context, STRATUS_OVERFLOW, "distance maps of %zu bytes exceed the address space", all);
  }
  map->bytes_size = all + PITCH;
  TRY(stratus_allocate(context, map->bytes_size, 1, &memory));
  map->bytes = memory;
  return STRATUS_OK;
}

static stratus_status fill_map(stratus_context* context, const stratus_occupancy* occupancy, stratus_distance_map* map)
{
  if (map->kind == STRATUS_DISTANCE_BLOCK) {
    fill_block(context, occupancy, map);
    return STRATUS_OK;
  }
  if (stratus_device_builds(context) && stratus_device_takes_blocks(context, map->blocks)) {
    const stratus_status status = stratus_device_distance_map(context, occupancy, map);
    if (!stratus_device_hands_back(context, status)) {
      return status;
    }
  }
  return map->kind == STRATUS_DISTANCE_PAPER ? stratus_distance_paper(context, occupancy, map)
                                             : stratus_distance_sweep(context, occupancy, map);
}

stratus_status stratus_distance_map_create(
  stratus_context* context, const stratus_occupancy* occupancy, stratus_distance_kind kind, stratus_distance_map** out)
{
  stratus_status status = STRATUS_OK;
  stratus_distance_map* map = NULL;
  void* memory;

  if (!context) {
    return STRATUS_INVALID_ARGUMENT;
  }
  if (!occupancy || !out) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "%s is NULL", occupancy ? "map" : "occupancy");
  }
  if ((int)kind < STRATUS_DISTANCE_BLOCK || kind > STRATUS_DISTANCE_OCTANT) {
    return stratus_fail(
      context, STRATUS_INVALID_ARGUMENT, "distance kind %d outside %d..%d", (int)kind, STRATUS_DISTANCE_BLOCK, STRATUS_DISTANCE_OCTANT);
  }
  const size_t maps = kind == STRATUS_DISTANCE_OCTANT ? 8 : 1;
  const stratus_stage stage = stratus_stage_begin(context);
  TRY(stratus_progress(context, "distance map", 0.0));
  TRY(stratus_allocate_zero(context, 1, sizeof *map, &memory));
  map = memory;
  map->context = context;
  map->kind = kind;
  map->block_size = occupancy->block_size;
  memcpy(map->blocks, occupancy->blocks, sizeof map->blocks);
  TRY_CLEANUP(allocate_map(context, map, maps));
  TRY_CLEANUP(fill_map(context, occupancy, map));
  fill_padding(map, maps);
  stratus_stage_end(context, &stage, "distance map", map->bytes_size);
  TRY_CLEANUP(stratus_progress(context, "distance map", 1.0));
  *out = map;
  map = NULL;

cleanup:
  stratus_distance_map_destroy(map);
  return status;
}

void stratus_distance_map_destroy(stratus_distance_map* map)
{
  if (map) {
    stratus_context* context = map->context;
    stratus_release(context, map->bytes);
    stratus_release(context, map);
  }
}

int stratus_distance_map_get(const stratus_distance_map* map, int octant, int64_t i, int64_t j, int64_t k)
{
  if (!map || i < 0 || j < 0 || k < 0 || i >= map->blocks[0] || j >= map->blocks[1] || k >= map->blocks[2]) {
    return 0;
  }
  const size_t first = map->kind == STRATUS_DISTANCE_OCTANT ? (size_t)(octant & 7) * map->map_bytes : 0;
  const uint8_t byte = map->bytes[first + (size_t)(k * map->blocks[1] + j) * map->pitch + (size_t)i];
  return map->kind == STRATUS_DISTANCE_PAPER || byte < DISTANCE_OCCUPIED ? byte : 0;
}

size_t stratus_distance_map_bytes(const stratus_distance_map* map)
{
  return map ? map->bytes_size : 0;
}
