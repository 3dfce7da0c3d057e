/* SPDX-License-Identifier: BSD-3-Clause
 * The radix sort on the context's OpenCL device: buffers, places of digits, and launches of radix_sort.cl. */
#include "radix_sort_device.h"
#include "radix_sort.h"

#include <stdio.h>
#include <string.h>

#define GPU_GROUP 64
#define GPU_CHUNK 1024
#define GPU_BITS 4 /* of a digit: few counts in local memory */
#define CPU_CHUNKS 64
#define CPU_BITS 8
/* Fewer keys are sorted in less time than the passes wait for one another. */
#define DEVICE_LEAST (1 << 14)

typedef struct sort_device {
  stratus_context* context;
  stratus_device_keys* keys;
  cl_mem places;
  uint32_t* host_places;
  cl_uint count, chunk, chunks;
  int bits; /* of a digit */
  size_t group;
  char defines[48];
} sort_device;

bool stratus_radix_sort_on_device(const stratus_context* context, uint32_t count)
{
  return stratus_device_builds(context) && count >= DEVICE_LEAST &&
    count <= stratus_device_largest_allocation(context->device) / sizeof(uint64_t);
}

static size_t digits_of(const sort_device* d)
{
  return (size_t)1 << d->bits;
}

static stratus_status make_places(sort_device* d)
{
  void* memory;
  TRY(stratus_allocate(d->context, digits_of(d), d->chunks * sizeof(uint32_t), &memory));
  d->host_places = memory;
  return stratus_device_buffer(d->context, CL_MEM_READ_WRITE, digits_of(d) * d->chunks * sizeof(uint32_t), NULL, false, &d->places);
}

static stratus_status launch(const sort_device* d, const char* name, const stratus_kernel_argument* arguments, size_t count)
{
  return stratus_device_launch_groups(d->context, "radix_sort", d->defines, name, arguments, count, d->chunks, d->group);
}

/* Turns counts into first places. Returns false if all keys have the same digit, so that the pass can be skipped. */
static bool place_digits(const sort_device* d)
{
  uint32_t place = 0;
  for (size_t digit = 0; digit < digits_of(d); ++digit) {
    const uint32_t before = place;
    for (size_t chunk = 0; chunk < d->chunks; ++chunk) {
      const uint32_t here = d->host_places[digit * d->chunks + chunk];
      d->host_places[digit * d->chunks + chunk] = place;
      place += here;
    }
    if (place - before == d->count) {
      return false;
    }
  }
  return true;
}

/* Sorts by one digit; the sorted keys become keys[0]. */
static stratus_status run_pass(sort_device* d, cl_int shift)
{
  const size_t bytes = digits_of(d) * d->chunks * sizeof(uint32_t);
  const stratus_kernel_argument count[] = { ARGUMENT(d->keys->keys[0]), ARGUMENT(d->count), ARGUMENT(shift), ARGUMENT(d->chunk),
    ARGUMENT(d->chunks), ARGUMENT(d->places) };
  TRY(launch(d, "count", count, COUNT_OF(count)));
  TRY(stratus_device_read(d->context, d->places, 0, bytes, d->host_places));
  if (!place_digits(d)) {
    return STRATUS_OK;
  }
  TRY(stratus_device_write(d->context, d->places, 0, bytes, d->host_places));
  const stratus_kernel_argument scatter[] = { ARGUMENT(d->keys->keys[0]), ARGUMENT(d->keys->values[0]), ARGUMENT(d->count), ARGUMENT(shift),
    ARGUMENT(d->chunk), ARGUMENT(d->chunks), ARGUMENT(d->places), ARGUMENT(d->keys->keys[1]), ARGUMENT(d->keys->values[1]) };
  TRY(launch(d, "scatter", scatter, COUNT_OF(scatter)));
  const cl_mem keys = d->keys->keys[0], values = d->keys->values[0];
  d->keys->keys[0] = d->keys->keys[1];
  d->keys->values[0] = d->keys->values[1];
  d->keys->keys[1] = keys;
  d->keys->values[1] = values;
  return STRATUS_OK;
}

stratus_status stratus_device_keys_create(stratus_context* context, uint32_t count, stratus_device_keys* keys)
{
  keys->count = count;
  for (int i = 0; i < 2; ++i) {
    TRY(stratus_device_buffer(context, CL_MEM_READ_WRITE, count * sizeof(uint64_t), NULL, false, &keys->keys[i]));
    TRY(stratus_device_buffer(context, CL_MEM_READ_WRITE, count * sizeof(uint32_t), NULL, false, &keys->values[i]));
  }
  return STRATUS_OK;
}

void stratus_device_keys_release(stratus_device_keys* keys)
{
  for (int i = 0; i < 2; ++i) {
    stratus_device_buffer_release(keys->keys[i]);
    stratus_device_buffer_release(keys->values[i]);
  }
}

stratus_status stratus_device_keys_sort(stratus_context* context, stratus_device_keys* keys, int bits)
{
  stratus_status status = STRATUS_OK;
  sort_device d = { .context = context, .keys = keys, .count = keys->count };
  const bool processor = stratus_device_is_cpu(context->device);
  d.group = processor ? 1 : GPU_GROUP;
  d.bits = processor ? CPU_BITS : GPU_BITS;
  d.chunk = processor ? (d.count + CPU_CHUNKS - 1) / CPU_CHUNKS : GPU_CHUNK;
  d.chunks = (d.count + d.chunk - 1) / d.chunk;
  snprintf(d.defines, sizeof d.defines, "-DGROUP=%zu -DDIGIT_BITS=%d", d.group, d.bits);
  TRY_CLEANUP(make_places(&d));
  for (cl_int shift = 0; shift < bits; shift += d.bits) {
    TRY_CLEANUP(run_pass(&d, shift));
  }
cleanup:
  stratus_device_buffer_release(d.places);
  stratus_release(context, d.host_places);
  return status;
}

stratus_status stratus_device_radix_sort(stratus_context* context, uint64_t* keys, uint32_t* values, uint32_t count, int bits)
{
  stratus_status status = STRATUS_OK;
  stratus_device_keys on_device = { .count = 0 };
  void* sorted = NULL;
  TRY_CLEANUP(stratus_device_keys_create(context, count, &on_device));
  TRY_CLEANUP(stratus_device_write(context, on_device.keys[0], 0, count * sizeof *keys, keys));
  TRY_CLEANUP(stratus_device_write(context, on_device.values[0], 0, count * sizeof *values, values));
  TRY_CLEANUP(stratus_device_keys_sort(context, &on_device, bits));
  /* Both are read before either is written, so that the host can still sort them. */
  TRY_CLEANUP(stratus_allocate(context, count, sizeof *keys + sizeof *values, &sorted));
  uint32_t* const sorted_values = (uint32_t*)((uint64_t*)sorted + count);
  TRY_CLEANUP(stratus_device_read(context, on_device.keys[0], 0, count * sizeof *keys, sorted));
  TRY_CLEANUP(stratus_device_read(context, on_device.values[0], 0, count * sizeof *values, sorted_values));
  memcpy(keys, sorted, count * sizeof *keys);
  memcpy(values, sorted_values, count * sizeof *values);
cleanup:
  stratus_release(context, sorted);
  stratus_device_keys_release(&on_device);
  return status;
}
