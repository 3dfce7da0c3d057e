/* SPDX-License-Identifier: BSD-3-Clause
 * A stable radix sort. The order is the same at any number of threads. */
#include "radix_sort.h"

#include "device.h"

#include <omp.h>
#include <string.h>

#define DIGIT_BITS_MAX 8
#define DIGITS (1 << DIGIT_BITS_MAX)

typedef struct digit_pass {
  const uint64_t* keys;
  const uint32_t* values; /* NULL: there are none */
  uint64_t* keys_out;
  uint32_t* values_out;
  uint32_t (*places)[DIGITS]; /* one row for each chunk: counts, then places */
  uint32_t count, chunks;
  int shift, digits; /* number of digits: a power of 2 */
} digit_pass;

static uint32_t chunk_begin(const digit_pass* p, uint32_t chunk)
{
  return (uint32_t)((uint64_t)p->count * chunk / p->chunks);
}

static void count_digits(const digit_pass* p, uint32_t chunk)
{
  uint32_t* counts = p->places[chunk];
  memset(counts, 0, (size_t)p->digits * sizeof *counts);
  for (uint32_t i = chunk_begin(p, chunk); i < chunk_begin(p, chunk + 1); ++i) {
    counts[p->keys[i] >> p->shift & (uint64_t)(p->digits - 1)]++;
  }
}

/* Turns counts into first places. Returns false if all keys have the same digit, so that the pass can be skipped. */
static bool place_digits(const digit_pass* p)
{
  uint32_t place = 0;
  for (int digit = 0; digit < p->digits; ++digit) {
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
    const uint32_t to = places[p->keys[i] >> p->shift & (uint64_t)(p->digits - 1)]++;
    p->keys_out[to] = p->keys[i];
    if (p->values) {
      p->values_out[to] = p->values[i];
    }
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

static stratus_status sort_on_host(stratus_context* context, uint64_t* keys, uint32_t* values, uint32_t count, int bits)
{
  stratus_status status = STRATUS_OK;
  void *other_keys = NULL, *other_values = NULL, *places = NULL;
  const int threads = count < 1 << 14 ? 1 : context->threads; /* for fewer keys the sum over the chunks' counts costs too much */

  TRY_CLEANUP(stratus_allocate(context, count, sizeof *keys, &other_keys));
  if (values) {
    TRY_CLEANUP(stratus_allocate(context, count, sizeof *values, &other_values));
  }
  TRY_CLEANUP(stratus_allocate(context, (size_t)threads, DIGITS * sizeof(uint32_t), &places));
  digit_pass p = { keys, values, other_keys, other_values, places, count, (uint32_t)threads, 0, 0 };
  for (int passes = (bits + DIGIT_BITS_MAX - 1) / DIGIT_BITS_MAX, digit_bits; passes > 0; p.shift += digit_bits, --passes) {
    digit_bits = (bits - p.shift + passes - 1) / passes; /* digits of nearly the same size */
    p.digits = 1 << digit_bits;
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
    if (values) {
      memcpy(values, p.values, count * sizeof *values);
    }
  }

cleanup:
  stratus_release(context, other_keys);
  stratus_release(context, other_values);
  stratus_release(context, places);
  return status;
}

stratus_status stratus_radix_sort(stratus_context* context, uint64_t* keys, uint32_t* values, uint32_t count, int bits)
{
  if (values && stratus_radix_sort_on_device(context, count)) {
    const stratus_status status = stratus_device_radix_sort(context, keys, values, count, bits);
    if (!stratus_device_hands_back(context, status)) {
      return status;
    }
  }
  return sort_on_host(context, keys, values, count, bits);
}
