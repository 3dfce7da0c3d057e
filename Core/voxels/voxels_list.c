/* SPDX-License-Identifier: BSD-3-Clause
 * Effective voxels from a list of positions. Threads mark bricks in a field that has a bit and a number for each possible
 * brick. Where that field would be far larger than the list, the numbers of bricks are sorted instead. */
#include "voxels_build.h"

#include "radix_sort.h"

#include <string.h>

/* A field is used up to so many bytes, and beyond if it has at most so many bricks for each listed voxel. */
#define FIELD_BYTES_MAX ((size_t)32 << 20)
#define FIELD_BRICKS_A_VOXEL 32
#define VOXEL_NS 5.0 /* of one thread for a voxel */

typedef struct voxel_list {
  const int32_t* positions;
  int64_t count;
} voxel_list;

/* Index of the first position outside the dimensions, or the list's length. */
static int64_t first_outside(const stratus_voxels* voxels, const voxel_list* list, int threads)
{
  const uint32_t nx = (uint32_t)voxels->dimensions[0], ny = (uint32_t)voxels->dimensions[1], nz = (uint32_t)voxels->dimensions[2];
  int64_t first = list->count;
#pragma omp parallel for schedule(static) num_threads(threads) reduction(min : first)
  for (int64_t v = 0; v < list->count; ++v) {
    const int32_t* p = list->positions + 3 * v;
    if (((uint32_t)p[0] >= nx || (uint32_t)p[1] >= ny || (uint32_t)p[2] >= nz) && v < first) {
      first = v;
    }
  }
  return first;
}

/* ---------------------------------------------------------------- by a field of bits */

/* All bricks of the dimensions, x fastest: a bit is set in those that hold a voxel, and only these have a number. */
typedef struct brick_field {
  int64_t words; /* 64 bricks each */
  uint64_t* bits;
  uint32_t* number; /* of a brick among those that hold a voxel, in order */
} brick_field;

static inline int64_t brick_of(const stratus_voxels* voxels, const int32_t p[3])
{
  const uint32_t x = (uint32_t)p[0] >> 2, y = (uint32_t)p[1] >> 2, z = (uint32_t)p[2] >> 2;
  return ((int64_t)z * voxels->bricks_along[1] + (int64_t)y) * voxels->bricks_along[0] + (int64_t)x;
}

static inline uint64_t bit_in_brick(const int32_t p[3])
{
  return (uint64_t)1 << ((p[2] & 3) << 4 | (p[1] & 3) << 2 | (p[0] & 3));
}

/* Sets a bit of a word that other threads may change, too, if it is shared. A word of one thread's own takes half the time. */
static inline void set_bit(uint64_t* word, uint64_t bit, bool shared)
{
  if (shared) {
#pragma omp atomic
    *word |= bit;
  } else {
    *word |= bit;
  }
}

static void mark_bricks(const stratus_voxels* voxels, const voxel_list* list, int threads, const brick_field* field)
{
#pragma omp parallel for schedule(static) num_threads(threads)
  for (int64_t v = 0; v < list->count; ++v) {
    const int64_t brick = brick_of(voxels, list->positions + 3 * v);
    const uint64_t bit = (uint64_t)1 << (brick & 63);
    uint64_t before;
#pragma omp atomic read
    before = field->bits[brick >> 6];
    if (!(before & bit)) { /* most voxels are in a brick that another voxel has marked */
      set_bit(&field->bits[brick >> 6], bit, threads > 1);
    }
  }
}

/* Numbers the marked bricks of words [first, last) from `number` on, and sets their places. */
static void place_bricks(stratus_voxels* voxels, const brick_field* field, int64_t first, int64_t last, int64_t number)
{
  const int64_t n = voxels->bricks_along[0], ny = voxels->bricks_along[1];
  int64_t row = first * 64 / n, row_end = (row + 1) * n;
  for (int64_t w = first; w < last; ++w) {
    for (uint64_t left = field->bits[w]; left; left &= left - 1, ++number) {
      const int64_t brick = 64 * w + __builtin_ctzll(left);
      if (brick >= row_end) {
        row = brick / n;
        row_end = (row + 1) * n;
      }
      field->number[brick] = (uint32_t)number;
      voxels->bricks[number] = (stratus_brick){ .at = { (uint16_t)(brick - row_end + n), (uint16_t)(row % ny), (uint16_t)(row / ny) } };
    }
  }
}

/* Makes a brick of every marked one, with its place. */
static stratus_status number_bricks(stratus_voxels* voxels, int threads, const brick_field* field)
{
  stratus_context* context = voxels->context;
  void* memory;
  TRY(stratus_allocate_zero(context, (size_t)threads + 1, sizeof(int64_t), &memory));
  int64_t* const start = memory;
#pragma omp parallel for schedule(static, 1) num_threads(threads)
  for (int part = 0; part < threads; ++part) {
    for (int64_t w = field->words * part / threads; w < field->words * (part + 1) / threads; ++w) {
      for (uint64_t left = field->bits[w]; left; left &= left - 1) {
        start[part + 1]++;
      }
    }
  }
  for (int part = 0; part < threads; ++part) {
    start[part + 1] += start[part];
  }
  const int64_t count = start[threads];
  stratus_status status = count > UINT32_MAX
    ? stratus_fail(context, STRATUS_OVERFLOW, "%lld bricks: at most %u", (long long)count, UINT32_MAX)
    : stratus_allocate(context, (size_t)count, sizeof(stratus_brick), &memory);
  if (status == STRATUS_OK) {
    voxels->bricks = memory;
    voxels->brick_count = count;
#pragma omp parallel for schedule(static, 1) num_threads(threads)
    for (int part = 0; part < threads; ++part) {
      place_bricks(voxels, field, field->words * part / threads, field->words * (part + 1) / threads, start[part]);
    }
  }
  stratus_release(context, start);
  return status;
}

static void set_bits(const stratus_voxels* voxels, const voxel_list* list, int threads, const brick_field* field)
{
#pragma omp parallel for schedule(static) num_threads(threads)
  for (int64_t v = 0; v < list->count; ++v) {
    const int32_t* p = list->positions + 3 * v;
    set_bit(&voxels->bricks[field->number[brick_of(voxels, p)]].mask, bit_in_brick(p), threads > 1);
  }
}

static stratus_status take_by_field(stratus_voxels* voxels, const voxel_list* list, int threads)
{
  stratus_context* context = voxels->context;
  const int64_t bricks = voxels->bricks_along[0] * voxels->bricks_along[1] * voxels->bricks_along[2];
  stratus_status status;
  void *bits = NULL, *numbers = NULL;
  brick_field field = { .words = (bricks + 63) / 64 };
  TRY_CLEANUP(stratus_allocate_zero(context, (size_t)field.words, sizeof(uint64_t), &bits));
  TRY_CLEANUP(stratus_allocate(context, (size_t)bricks, sizeof(uint32_t), &numbers));
  field.bits = bits;
  field.number = numbers;
  mark_bricks(voxels, list, threads, &field);
  TRY_CLEANUP(number_bricks(voxels, threads, &field));
  set_bits(voxels, list, threads, &field);
  stratus_voxels_measure(voxels);
cleanup:
  stratus_release(context, numbers);
  stratus_release(context, bits);
  return status;
}

/* ---------------------------------------------------------------- by sorting */

#define VOXEL_SHIFT 58 /* a key's highest 6 bits are the voxel's number in its brick */

/* Bits of numbers 0 .. count - 1. */
static int bits_of(int64_t count)
{
  return count > 1 ? 64 - __builtin_clzll((uint64_t)count - 1) : 0;
}

/* Lists a key for each voxel, whose lowest bits sort as bricks do, and sorts them. */
static stratus_status sort_places(const stratus_voxels* voxels, const voxel_list* list, const int bits[3], int threads, uint64_t* keys)
{
#pragma omp parallel for schedule(static) num_threads(threads)
  for (int64_t v = 0; v < list->count; ++v) {
    const int32_t* p = list->positions + 3 * v;
    const uint64_t x = (uint32_t)p[0] >> 2, y = (uint32_t)p[1] >> 2, z = (uint32_t)p[2] >> 2;
    const uint64_t voxel = (uint64_t)((p[2] & 3) << 4 | (p[1] & 3) << 2 | (p[0] & 3));
    keys[v] = voxel << VOXEL_SHIFT | z << (bits[0] + bits[1]) | y << bits[0] | x;
  }
  return stratus_radix_sort(voxels->context, keys, NULL, (uint32_t)list->count, bits[0] + bits[1] + bits[2]);
}

/* Where part `part` of the sorted keys begins: where a brick does. */
static int64_t begin_of_part(const uint64_t* keys, int64_t count, int part, int parts)
{
  int64_t v = count * part / parts;
  while (v > 0 && v < count && keys[v] << 6 == keys[v - 1] << 6) {
    ++v;
  }
  return v;
}

static bool begins_brick(const uint64_t* keys, int64_t v, int64_t first)
{
  return v == first || keys[v] << 6 != keys[v - 1] << 6;
}

/* Makes bricks of sorted keys. */
static stratus_status take_sorted(stratus_voxels* voxels, const uint64_t* keys, int64_t count, const int bits[3], int threads)
{
  const uint64_t in_x = ((uint64_t)1 << bits[0]) - 1, in_y = ((uint64_t)1 << bits[1]) - 1, in_z = ((uint64_t)1 << bits[2]) - 1;
  void* memory;
  TRY(stratus_allocate_zero(voxels->context, (size_t)threads + 1, sizeof(int64_t), &memory));
  int64_t* const start = memory;
#pragma omp parallel for schedule(static, 1) num_threads(threads)
  for (int part = 0; part < threads; ++part) {
    const int64_t first = begin_of_part(keys, count, part, threads), end = begin_of_part(keys, count, part + 1, threads);
    for (int64_t v = first; v < end; ++v) {
      start[part + 1] += begins_brick(keys, v, first);
    }
  }
  for (int part = 0; part < threads; ++part) {
    start[part + 1] += start[part];
  }
  const stratus_status status = stratus_allocate(voxels->context, (size_t)start[threads], sizeof(stratus_brick), &memory);
  if (status == STRATUS_OK) {
    voxels->bricks = memory;
    voxels->brick_count = start[threads];
#pragma omp parallel for schedule(static, 1) num_threads(threads)
    for (int part = 0; part < threads; ++part) {
      const int64_t first = begin_of_part(keys, count, part, threads), end = begin_of_part(keys, count, part + 1, threads);
      stratus_brick* brick = voxels->bricks + start[part] - 1;
      for (int64_t v = first; v < end; ++v) {
        if (begins_brick(keys, v, first)) {
          *++brick = (stratus_brick){ .at = { (uint16_t)(keys[v] & in_x), (uint16_t)(keys[v] >> bits[0] & in_y),
                                        (uint16_t)(keys[v] >> (bits[0] + bits[1]) & in_z) } };
        }
        brick->mask |= (uint64_t)1 << (keys[v] >> VOXEL_SHIFT);
      }
    }
  }
  stratus_release(voxels->context, start);
  return status;
}

static stratus_status take_by_sorting(stratus_voxels* voxels, const voxel_list* list, int threads)
{
  const int bits[3] = { bits_of(voxels->bricks_along[0]), bits_of(voxels->bricks_along[1]), bits_of(voxels->bricks_along[2]) };
  void* keys;
  if (list->count > UINT32_MAX) {
    return stratus_fail(voxels->context, STRATUS_OVERFLOW, "%lld positions: at most %u", (long long)list->count, UINT32_MAX);
  }
  TRY(stratus_allocate(voxels->context, (size_t)list->count, sizeof(uint64_t), &keys));
  stratus_status status = sort_places(voxels, list, bits, threads, keys);
  if (status == STRATUS_OK) {
    status = take_sorted(voxels, keys, list->count, bits, threads);
  }
  if (status == STRATUS_OK) {
    stratus_voxels_measure(voxels);
  }
  stratus_release(voxels->context, keys);
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
  const stratus_stage stage = stratus_stage_begin(context);
  TRY(stratus_voxels_create_empty(context, dimensions, &voxels));
  const int threads = stratus_threads_for(context, VOXEL_NS * (double)list.count);
  const int64_t outside = first_outside(voxels, &list, threads);
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
  const bool sparse = field > FIELD_BYTES_MAX / sizeof(uint32_t) && field / FIELD_BRICKS_A_VOXEL > count;
  TRY_CLEANUP(sparse ? take_by_sorting(voxels, &list, threads) : take_by_field(voxels, &list, threads));
  stratus_voxels_end_stage(voxels, &stage);
  *out = voxels;
  voxels = NULL;
cleanup:
  stratus_voxels_destroy(voxels);
  return status;
}
