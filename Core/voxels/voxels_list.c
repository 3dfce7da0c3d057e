/* SPDX-License-Identifier: BSD-3-Clause
 * Effective voxels from a list of positions. Threads set bits in a field of masks, one for each possible brick. Where that field would be
 * far larger than the list, the numbers of bricks are sorted instead. */
#include "voxels_build.h"

#include <string.h>

/* A field of masks is used up to so many bytes, and beyond if it has at most so many bricks for each listed voxel. */
#define FIELD_BYTES_MAX ((size_t)32 << 20)
#define FIELD_BRICKS_A_VOXEL 32
#define DIGIT_BITS 11
#define DIGITS (1 << DIGIT_BITS)

typedef struct voxel_list {
  const int32_t* positions;
  int64_t count;
} voxel_list;

/* Index of the first position outside the dimensions, or the list's length. */
static int64_t first_outside(const stratus_voxels* voxels, const voxel_list* list)
{
  const uint32_t nx = (uint32_t)voxels->dimensions[0], ny = (uint32_t)voxels->dimensions[1], nz = (uint32_t)voxels->dimensions[2];
  int64_t first = list->count;
#pragma omp parallel for schedule(static) num_threads(voxels->context->threads) reduction(min : first)
  for (int64_t v = 0; v < list->count; ++v) {
    const int32_t* p = list->positions + 3 * v;
    if (((uint32_t)p[0] >= nx || (uint32_t)p[1] >= ny || (uint32_t)p[2] >= nz) && v < first) {
      first = v;
    }
  }
  return first;
}

static uint64_t bit_of(const int32_t p[3])
{
  return (uint64_t)1 << ((p[2] % 4 * 4 + p[1] % 4) * 4 + p[0] % 4);
}

static stratus_status take_by_field(stratus_voxels* voxels, const voxel_list* list)
{
  stratus_context* context = voxels->context;
  const int64_t nx = voxels->bricks_along[0], ny = voxels->bricks_along[1];
  void* memory = NULL;
  TRY(stratus_allocate_zero(context, (size_t)(nx * ny * voxels->bricks_along[2]), sizeof(uint64_t), &memory));
  uint64_t* masks = memory;
#pragma omp parallel for schedule(static) num_threads(context->threads)
  for (int64_t v = 0; v < list->count; ++v) {
    const int32_t* p = list->positions + 3 * v;
    const int64_t brick = (p[2] / 4 * ny + p[1] / 4) * nx + p[0] / 4;
    const uint64_t bit = bit_of(p);
#pragma omp atomic
    masks[brick] |= bit;
  }
  const stratus_status status = stratus_voxels_take_masks(voxels, masks);
  stratus_release(context, masks);
  return status;
}

/* Key that sorts as bricks do: the brick's place, 16 bits for each axis, and 6 bits for the voxel in it. */
static uint64_t key_of(const int32_t p[3])
{
  return ((uint64_t)(p[2] / 4) << 38) | ((uint64_t)(p[1] / 4) << 22) | ((uint64_t)(p[0] / 4) << 6) |
    (uint64_t)((p[2] % 4 * 4 + p[1] % 4) * 4 + p[0] % 4);
}

/* Sorts by all bits of the brick's place, digit by digit from the lowest. A digit that all keys share is skipped. Returns the array that
 * holds the sorted keys. start: scratch of DIGITS numbers. */
static uint64_t* sort_keys(uint64_t* keys, uint64_t* other, int64_t count, uint64_t* start)
{
  const uint64_t digit = DIGITS - 1;
  for (int shift = 6; count > 0 && shift < 54; shift += DIGIT_BITS) {
    uint64_t sum = 0;
    memset(start, 0, DIGITS * sizeof *start);
    for (int64_t i = 0; i < count; ++i) {
      start[keys[i] >> shift & digit]++;
    }
    if (start[keys[0] >> shift & digit] == (uint64_t)count) {
      continue;
    }
    for (int d = 0; d < DIGITS; ++d) {
      const uint64_t here = start[d];
      start[d] = sum;
      sum += here;
    }
    for (int64_t i = 0; i < count; ++i) {
      other[start[keys[i] >> shift & digit]++] = keys[i];
    }
    uint64_t* swapped = keys;
    keys = other;
    other = swapped;
  }
  return keys;
}

static stratus_status take_by_sorting(stratus_voxels* voxels, const voxel_list* list)
{
  stratus_context* context = voxels->context;
  stratus_status status;
  void *memory = NULL, *bricks = NULL;
  TRY_CLEANUP(stratus_allocate(context, 2 * (size_t)list->count + DIGITS, sizeof(uint64_t), &memory));
  uint64_t* keys = memory;
  for (int64_t v = 0; v < list->count; ++v) {
    keys[v] = key_of(list->positions + 3 * v);
  }
  keys = sort_keys(keys, keys + list->count, list->count, keys + 2 * list->count);
  voxels->brick_count = 0;
  for (int64_t v = 0; v < list->count; ++v) {
    voxels->brick_count += v == 0 || keys[v] >> 6 != keys[v - 1] >> 6;
  }
  TRY_CLEANUP(stratus_allocate(context, (size_t)voxels->brick_count, sizeof(stratus_brick), &bricks));
  voxels->bricks = bricks;
  for (int64_t v = 0, brick = -1; v < list->count; ++v) {
    if (v == 0 || keys[v] >> 6 != keys[v - 1] >> 6) {
      voxels->bricks[++brick] = (stratus_brick){ .at = { (uint16_t)(keys[v] >> 6), (uint16_t)(keys[v] >> 22), (uint16_t)(keys[v] >> 38) } };
    }
    voxels->bricks[brick].mask |= (uint64_t)1 << (keys[v] & 63);
  }
  stratus_voxels_measure(voxels);
cleanup:
  stratus_release(context, memory);
  return status;
}

static stratus_status check_list(
  stratus_context* context, const int64_t dimensions[3], const int32_t* positions, size_t count, stratus_voxels** out)
{
  if (!dimensions || !out) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "%s is NULL", dimensions ? "voxels" : "dimensions");
  }
  if (!positions && count > 0) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "positions is NULL, but count is %zu", count);
  }
  return stratus_array_check(context, "positions", count, 3 * sizeof *positions);
}

stratus_status stratus_voxels_create_list(
  stratus_context* context, const int64_t dimensions[3], const int32_t* positions, size_t count, stratus_voxels** out)
{
  stratus_voxels* voxels = NULL;
  stratus_status status;
  const voxel_list list = { positions, (int64_t)count };
  if (!context) {
    return STRATUS_INVALID_ARGUMENT;
  }
  TRY(check_list(context, dimensions, positions, count, out));
  TRY(stratus_voxels_create_empty(context, dimensions, &voxels));
  const int64_t outside = first_outside(voxels, &list);
  if (outside < list.count) {
    const int32_t* p = positions + 3 * outside;
    status = stratus_fail(context, STRATUS_INVALID_ARGUMENT, "position %lld is (%d, %d, %d), must be in 0..%lld, 0..%lld, 0..%lld",
      (long long)outside, p[0], p[1], p[2], (long long)dimensions[0] - 1, (long long)dimensions[1] - 1, (long long)dimensions[2] - 1);
    goto cleanup;
  }
  for (int a = 0; a < 3; ++a) {
    voxels->index_to_world[4 * a + 3] = 0.5;
  }
  const size_t field = (size_t)(voxels->bricks_along[0] * voxels->bricks_along[1] * voxels->bricks_along[2]);
  const bool sparse = field > FIELD_BYTES_MAX / sizeof(uint64_t) && field / FIELD_BRICKS_A_VOXEL > count;
  TRY_CLEANUP(sparse ? take_by_sorting(voxels, &list) : take_by_field(voxels, &list));
  *out = voxels;
  voxels = NULL;
cleanup:
  stratus_voxels_destroy(voxels);
  return status;
}
