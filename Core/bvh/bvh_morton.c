/* SPDX-License-Identifier: BSD-3-Clause
 * Boxes in Morton order, which every builder begins with: neighbours in space become neighbours in memory. Codes come from the device or
 * the host, the same to the bit; the sort is the host's, a radix sort that is stable, so the order is the same at any number of threads. */
#include "bvh_build.h"

#include "morton.h"

#include <omp.h>
#include <string.h>

#define DIGIT_BITS 8
#define DIGITS (1 << DIGIT_BITS)

typedef struct digit_pass {
  const uint64_t* keys;
  const uint32_t* values;
  uint64_t* keys_out;
  uint32_t* values_out;
  uint32_t (*places)[DIGITS]; /* a row a chunk */
  uint32_t count, chunks;
  int shift;
} digit_pass;

static uint32_t chunk_begin(const digit_pass* p, uint32_t chunk)
{
  return (uint32_t)((uint64_t)p->count * chunk / p->chunks);
}

static void count_digits(const digit_pass* p, uint32_t chunk)
{
  uint32_t* counts = p->places[chunk];
  memset(counts, 0, sizeof *p->places);
  for (uint32_t i = chunk_begin(p, chunk); i < chunk_begin(p, chunk + 1); ++i) {
    counts[p->keys[i] >> p->shift & (DIGITS - 1)]++;
  }
}

/* Counts become first places. False: all keys have the same digit. */
static bool place_digits(const digit_pass* p)
{
  uint32_t place = 0;
  for (uint32_t digit = 0; digit < DIGITS; ++digit) {
    const uint32_t before = place;
    for (uint32_t chunk = 0; chunk < p->chunks; ++chunk) {
      const uint32_t here = p->places[chunk][digit];
      p->places[chunk][digit] = place;
      place += here;
    }
    if (place - before == p->count) {
      return false;
    }
  }
  return true;
}

static void scatter_digits(const digit_pass* p, uint32_t chunk)
{
  uint32_t* places = p->places[chunk];
  for (uint32_t i = chunk_begin(p, chunk); i < chunk_begin(p, chunk + 1); ++i) {
    const uint32_t to = places[p->keys[i] >> p->shift & (DIGITS - 1)]++;
    p->keys_out[to] = p->keys[i];
    p->values_out[to] = p->values[i];
  }
}

static bool run_pass(const digit_pass* p, int threads)
{
#pragma omp parallel for schedule(static) num_threads(threads)
  for (uint32_t chunk = 0; chunk < p->chunks; ++chunk) {
    count_digits(p, chunk);
  }
  if (!place_digits(p)) {
    return false;
  }
#pragma omp parallel for schedule(static) num_threads(threads)
  for (uint32_t chunk = 0; chunk < p->chunks; ++chunk) {
    scatter_digits(p, chunk);
  }
  return true;
}

stratus_status stratus_radix_sort(stratus_context* context, uint64_t* keys, uint32_t* values, uint32_t count, int bits)
{
  stratus_status status = STRATUS_OK;
  void *other_keys = NULL, *other_values = NULL, *places = NULL;
  const int threads = count < 1 << 14 ? 1 : context->threads; /* the sum over rows of counts isn't worth it below */

  TRY_CLEANUP(stratus_allocate(context, count, sizeof *keys, &other_keys));
  TRY_CLEANUP(stratus_allocate(context, count, sizeof *values, &other_values));
  TRY_CLEANUP(stratus_allocate(context, (size_t)threads, DIGITS * sizeof(uint32_t), &places));
  digit_pass p = { keys, values, other_keys, other_values, places, count, (uint32_t)threads, 0 };
  for (; p.shift < bits; p.shift += DIGIT_BITS) {
    if (run_pass(&p, threads)) {
      uint64_t* const from_keys = (uint64_t*)p.keys;
      uint32_t* const from_values = (uint32_t*)p.values;
      p.keys = p.keys_out;
      p.values = p.values_out;
      p.keys_out = from_keys;
      p.values_out = from_values;
    }
  }
  if (p.keys != keys) {
    memcpy(keys, p.keys, count * sizeof *keys);
    memcpy(values, p.values, count * sizeof *values);
  }

cleanup:
  stratus_release(context, other_keys);
  stratus_release(context, other_values);
  stratus_release(context, places);
  return status;
}

/* Of twice the boxes' middles. */
static void middle_bounds(stratus_context* context, const stratus_box* boxes, uint32_t count, int32_t least[3], int32_t most[3])
{
  int32_t lx = INT32_MAX, ly = INT32_MAX, lz = INT32_MAX, mx = INT32_MIN, my = INT32_MIN, mz = INT32_MIN;
#pragma omp parallel for schedule(static) num_threads(context->threads) reduction(min : lx, ly, lz) reduction(max : mx, my, mz)
  for (uint32_t i = 0; i < count; ++i) {
    const int32_t x = stratus_box_middle(boxes + i, 0), y = stratus_box_middle(boxes + i, 1), z = stratus_box_middle(boxes + i, 2);
    lx = x < lx ? x : lx;
    ly = y < ly ? y : ly;
    lz = z < lz ? z : lz;
    mx = x > mx ? x : mx;
    my = y > my ? y : my;
    mz = z > mz ? z : mz;
  }
  memcpy(least, (const int32_t[]){ lx, ly, lz }, 3 * sizeof *least);
  memcpy(most, (const int32_t[]){ mx, my, mz }, 3 * sizeof *most);
}

/* *bits: of the codes. */
static stratus_status make_codes(stratus_bvh_build* build, const stratus_box* boxes, int* bits)
{
  int32_t least[3], most[3];
  uint32_t extent = 0;
  int shift = 0, axis_bits = 0;
  middle_bounds(build->context, boxes, build->count, least, most);
  for (int a = 0; a < 3; ++a) {
    extent |= (uint32_t)most[a] - (uint32_t)least[a];
  }
  while (extent >> shift >= 1u << 21) {
    ++shift;
  }
  while (extent >> shift >> axis_bits) {
    ++axis_bits;
  }
  *bits = 3 * axis_bits;
  if (stratus_device_takes_boxes(build->context, build->count)) {
    return stratus_device_morton_codes(build->context, boxes, build->count, least, shift, build->codes);
  }
#pragma omp parallel for schedule(static) num_threads(build->context->threads)
  for (uint32_t i = 0; i < build->count; ++i) {
    const stratus_box* box = boxes + i;
    build->codes[i] = morton_code((uint32_t)(stratus_box_middle(box, 0) - least[0]), (uint32_t)(stratus_box_middle(box, 1) - least[1]),
      (uint32_t)(stratus_box_middle(box, 2) - least[2]), shift);
  }
  return STRATUS_OK;
}

stratus_status stratus_bvh_sort_boxes(stratus_bvh_build* build, const stratus_box* boxes)
{
  void* memory;
  int bits = 0;
  TRY(stratus_allocate(build->context, build->count, sizeof *build->codes, &memory));
  build->codes = memory;
  TRY(stratus_allocate(build->context, build->count, sizeof *build->number, &memory));
  build->number = memory;
  TRY(make_codes(build, boxes, &bits));
  for (uint32_t i = 0; i < build->count; ++i) {
    build->number[i] = i;
  }
  TRY(stratus_radix_sort(build->context, build->codes, build->number, build->count, bits));
  TRY(stratus_allocate(build->context, build->count, sizeof *build->boxes, &memory));
  build->boxes = memory;
#pragma omp parallel for schedule(static) num_threads(build->context->threads)
  for (uint32_t i = 0; i < build->count; ++i) {
    build->boxes[i] = boxes[build->number[i]];
  }
  return STRATUS_OK;
}
