/* SPDX-License-Identifier: BSD-3-Clause
 * Effective voxels from a list of positions. Threads mark bricks in a field that has a bit and a number for each possible
 * brick. Where that field would be far larger than the list, the numbers of bricks are sorted instead. */
#include "voxels_build.h"

#include <string.h>

/* A field is used up to so many bytes, and beyond if it has at most so many bricks for each listed voxel. */
#define FIELD_BYTES_MAX ((size_t)32 << 20)
#define FIELD_BRICKS_A_VOXEL 32
#define VOXEL_NS 5.0 /* of one thread for a voxel */
#define DIGIT_BITS 11
#define DIGITS (1 << DIGIT_BITS)

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
    if (!(before & bit)) { /* most voxels lie in a brick that another one has marked */
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

/* Key that sorts as bricks do: the brick's place, 16 bits for each axis, and 6 bits for the voxel in it. */
static uint64_t key_of(const int32_t p[3])
{
  return ((uint64_t)(p[2] / 4) << 38) | ((uint64_t)(p[1] / 4) << 22) | ((uint64_t)(p[0] / 4) << 6) |
    (uint64_t)((p[2] & 3) << 4 | (p[1] & 3) << 2 | (p[0] & 3));
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
  TRY_CLEANUP(sparse ? take_by_sorting(voxels, &list) : take_by_field(voxels, &list, threads));
  stratus_voxels_end_stage(voxels, &stage);
  *out = voxels;
  voxels = NULL;
cleanup:
  stratus_voxels_destroy(voxels);
  return status;
}
