/* SPDX-License-Identifier: BSD-3-Clause
 * Effective voxels of a volume. Rows of values are compared with the criterion's intervals, which gives one byte for each value. The bytes
 * are packed into the masks of a row of bricks. */
#include "device.h"
#include "voxels_build.h"

#include <float.h>
#include <omp.h>
#include <string.h>

#define WORD 64 /* flags in a word: 16 bricks' rows of four */

#define TYPE int8_t
#define AS int8_t
#define NAME(f) f##_int8
#define BOUND i
#include "voxels_rows.h"

#define TYPE uint8_t
#define AS uint8_t
#define NAME(f) f##_uint8
#define BOUND i
#include "voxels_rows.h"

#define TYPE int16_t
#define AS int16_t
#define NAME(f) f##_int16
#define BOUND i
#include "voxels_rows.h"

#define TYPE uint16_t
#define AS uint16_t
#define NAME(f) f##_uint16
#define BOUND i
#include "voxels_rows.h"

#define TYPE int32_t
#define AS int32_t
#define NAME(f) f##_int32
#define BOUND i
#include "voxels_rows.h"

#define TYPE uint32_t
#define AS uint32_t
#define NAME(f) f##_uint32
#define BOUND i
#include "voxels_rows.h"

#define TYPE int64_t
#define AS double
#define NAME(f) f##_int64
#define BOUND d
#include "voxels_rows.h"

#define TYPE uint64_t
#define AS double
#define NAME(f) f##_uint64
#define BOUND d
#include "voxels_rows.h"

#define TYPE float
#define AS float
#define NAME(f) f##_float32
#define BOUND d
#include "voxels_rows.h"

#define TYPE double
#define AS double
#define NAME(f) f##_float64
#define BOUND d
#include "voxels_rows.h"
#include "volume_hash.h"

typedef void (*mark_function)(const void*, int64_t, const stratus_bounds*, int64_t, uint8_t*);

static mark_function mark_of(stratus_type type)
{
  static const mark_function marks[] = { mark_int8, mark_uint8, mark_int16, mark_uint16, mark_int32, mark_uint32, mark_int64, mark_uint64,
    mark_float32, mark_float64 };
  return marks[type];
}

/* ---------------------------------------------------------------- intervals in the values' type */

/* Restricts lo..hi to integers within least..most; returns false if there is none. */
static bool whole_bounds(double lo, double hi, double least, double most, stratus_bounds* result)
{
  const double first = fmax(ceil(lo), least), last = fmin(floor(hi), most);
  if (!(first <= last)) {
    return false;
  }
  result->lo.i = (int64_t)first;
  result->hi.i = (int64_t)last;
  return true;
}

/* Restricts lo..hi to finite floats; returns false if there is none. */
static bool float_bounds(double lo, double hi, stratus_bounds* result)
{
  if (lo > FLT_MAX || hi < -FLT_MAX) {
    return false;
  }
  const float first = lo <= -FLT_MAX ? -FLT_MAX : stratus_float_above(lo), last = hi >= FLT_MAX ? FLT_MAX : stratus_float_below(hi);
  result->lo.d = (double)first;
  result->hi.d = (double)last;
  return first <= last;
}

static bool bounds_of(stratus_type type, const double interval[2], stratus_bounds* result)
{
  static const struct {
    double least, most;
  } whole[] = { { INT8_MIN, INT8_MAX }, { 0, UINT8_MAX }, { INT16_MIN, INT16_MAX }, { 0, UINT16_MAX }, { INT32_MIN, INT32_MAX },
    { 0, UINT32_MAX } };
  if (type == STRATUS_FLOAT32) {
    return float_bounds(interval[0], interval[1], result);
  }
  if (type < STRATUS_INT64) {
    return whole_bounds(interval[0], interval[1], whole[type].least, whole[type].most, result);
  }
  result->lo.d = fmax(interval[0], -DBL_MAX);
  result->hi.d = fmin(interval[1], DBL_MAX);
  return result->lo.d <= result->hi.d;
}

/* ---------------------------------------------------------------- rows */

/* Packs eight bytes of 0 or 1 into eight bits, the first byte into the lowest. */
static uint64_t pack8(const uint8_t* flags)
{
  uint64_t bytes;
  memcpy(&bytes, flags, sizeof bytes);
#if defined(__BYTE_ORDER__) && __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__
  bytes = __builtin_bswap64(bytes);
#endif
  return bytes * UINT64_C(0x0102040810204080) >> 56;
}

/* Adds the flags of a row of voxels to the masks of its bricks, four bits to each at `shift`. flags: padded with 0 to whole words. */
static void add_row(const uint8_t* flags, int64_t bricks, int shift, uint64_t* masks)
{
  for (int64_t first = 0; first < bricks; first += WORD / STRATUS_BRICK) {
    uint64_t word = 0;
    for (int b = 0; b < 8; ++b) {
      word |= pack8(flags + first * STRATUS_BRICK + 8 * b) << 8 * b;
    }
    for (int64_t b = first; word; ++b) {
      masks[b] |= (word & 15) << shift;
      word >>= STRATUS_BRICK;
    }
  }
}

/* Fills the masks of row (j, k) of bricks and returns the hash of its values. */
static uint64_t scan_bricks(
  const stratus_scan* s, int64_t bricks, mark_function mark, int64_t j, int64_t k, void* room, uint8_t* flags, uint64_t* masks)
{
  const int64_t* n = s->volume->dimensions;
  uint64_t hash = 0;
  memset(masks, 0, (size_t)bricks * sizeof *masks);
  for (int64_t z = 4 * k; z < 4 * k + 4 && z < n[2]; ++z) {
    for (int64_t y = 4 * j; y < 4 * j + 4 && y < n[1]; ++y) {
      const void* row = stratus_volume_row(s->volume, y, z, room);
      hash += stratus_volume_hash_row(s->volume, y, z, row);
      mark(row, n[0], s->intervals, s->count, flags);
      const uint8_t* ghosts = s->ghosts ? s->ghosts + (z * n[1] + y) * n[0] : NULL;
      for (int64_t i = 0; ghosts && i < n[0]; ++i) {
        flags[i] &= (ghosts[i] & s->hidden) == 0;
      }
      add_row(flags, bricks, (int)((z % 4 * 4 + y % 4) * 4), masks);
    }
  }
  return hash;
}

/* Fills the masks of all bricks and the hash of all values, which are read once for both. */
static stratus_status scan_rows(
  stratus_context* context, const stratus_scan* s, const int64_t bricks_along[3], uint64_t* masks, uint64_t* hash)
{
  const int64_t nx = bricks_along[0], ny = bricks_along[1], rows = ny * bricks_along[2];
  const size_t line = ((size_t)s->volume->dimensions[0] + WORD - 1) / WORD * WORD;
  const size_t room = s->volume->value_stride == 1 ? 0 : line * stratus_type_size(s->volume->type);
  const mark_function mark = mark_of(s->volume->type);
  uint64_t sum = stratus_volume_hash_shape(s->volume);
  void* memory;
  TRY(stratus_allocate_zero(context, (size_t)context->threads, room + line, &memory));
#pragma omp parallel num_threads(context->threads) reduction(+ : sum)
  {
    uint8_t* mine = (uint8_t*)memory + (size_t)omp_get_thread_num() * (room + line);
#pragma omp for schedule(static)
    for (int64_t row = 0; row < rows; ++row) {
      sum += scan_bricks(s, nx, mark, row % ny, row / ny, mine, mine + room, masks + row * nx);
    }
  }
  stratus_release(context, memory);
  *hash = sum ? sum : 1;
  return STRATUS_OK;
}

/* Get the criterion's intervals that some value of the type can be in. */
static stratus_status take_intervals(
  stratus_context* context, const stratus_criterion* criterion, stratus_scan* s, stratus_origin* origin, void** out)
{
  stratus_intervals list = { 0 };
  void* memory = NULL;
  TRY(stratus_intervals_create(context, criterion, &list));
  const stratus_status status = stratus_allocate(context, (size_t)list.count, sizeof(stratus_bounds), &memory);
  if (status == STRATUS_OK) {
    stratus_bounds* intervals = memory;
    for (int64_t i = 0; i < list.count; ++i) {
      s->count += bounds_of(s->volume->type, list.of[i], intervals + s->count);
    }
    s->intervals = intervals;
    stratus_origin_take(origin, &list);
    *out = memory;
  }
  stratus_release(context, list.of);
  return status;
}

static stratus_status scan_on_host(const stratus_scan* scan, stratus_voxels* voxels)
{
  stratus_context* context = voxels->context;
  const int64_t* n = voxels->bricks_along;
  void* masks;
  TRY(stratus_allocate(context, (size_t)(n[0] * n[1] * n[2]), sizeof(uint64_t), &masks));
  stratus_status status = scan_rows(context, scan, n, masks, &voxels->origin.hash);
  if (status == STRATUS_OK) {
    status = stratus_voxels_take_masks(voxels, masks);
  }
  stratus_release(context, masks);
  return status;
}

static stratus_status scan_values(const stratus_scan* scan, stratus_voxels* voxels)
{
  stratus_context* context = voxels->context;
  if (stratus_voxels_on_device(context, scan->volume, voxels)) {
    const stratus_status status = stratus_device_voxels(context, scan, voxels);
    if (status == STRATUS_OK) {
      stratus_voxels_measure(voxels);
      return stratus_volume_hash(context, scan->volume, &voxels->origin.hash);
    }
    if (!stratus_device_hands_back(context, status)) {
      return status;
    }
  }
  return scan_on_host(scan, voxels);
}

stratus_status stratus_voxels_create(
  stratus_context* context, const stratus_volume* volume, const stratus_criterion* criterion, stratus_voxels** out)
{
  stratus_voxels* voxels = NULL;
  stratus_status status;
  void* intervals = NULL;
  double index_to_world[16];
  TRY(stratus_volume_check(context, volume));
  TRY(stratus_criterion_check(context, criterion));
  if (!out) {
    return stratus_fail(context, STRATUS_INVALID_ARGUMENT, "voxels is NULL");
  }
  if (stratus_volume_is_stretched(volume)) {
    return stratus_fail(context, STRATUS_UNSUPPORTED,
      "effective voxels of a volume with coordinates (a rectilinear grid): they have equal spacing; cells serve");
  }
  const stratus_stage stage = stratus_stage_begin(context);
  TRY(stratus_progress(context, "effective voxels", 0.0));
  TRY(stratus_voxels_create_empty(context, volume->dimensions, &voxels));
  stratus_volume_index_to_world(volume, index_to_world);
  TRY_CLEANUP(stratus_voxels_place(voxels, index_to_world));
  stratus_scan s = { .volume = volume };
  s.ghosts = volume->cell_centered ? volume->cell_ghosts : volume->point_ghosts;
  s.hidden = STRATUS_GHOST_DUPLICATE | (volume->cell_centered ? STRATUS_GHOST_HIDDEN_CELL : STRATUS_GHOST_HIDDEN_POINT);
  TRY_CLEANUP(take_intervals(context, criterion, &s, &voxels->origin, &intervals));
  TRY_CLEANUP(scan_values(&s, voxels));
  stratus_voxels_end_stage(voxels, &stage);
  TRY_CLEANUP(stratus_progress(context, "effective voxels", 1.0));
  *out = voxels;
  voxels = NULL;
cleanup:
  stratus_release(context, intervals);
  stratus_voxels_destroy(voxels);
  return status;
}
