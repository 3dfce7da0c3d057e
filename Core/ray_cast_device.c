/* SPDX-License-Identifier: BSD-3-Clause
 * The OpenCL device's way through the traversal: copies of what was built, kept until it is built anew, and the launch. */
#include "device.h"
#include "ray_caster.h"

#include <stdio.h>
#include <string.h>

#define LOCAL_SIDE 8 /* work items a group along each axis where a work item is a ray */

_Static_assert(sizeof(stratus_ray_cast_arguments) == 4 * STRATUS_RAY_CAST_ARGUMENTS_WORDS, "arguments must have no padding");

typedef enum buffer_name { VALUES, HIDDEN, MAP, TABLE, ARGUMENTS, OPAQUE, RGBA, DEPTH, SAMPLES, COUNTS, BUFFERS } buffer_name;

struct stratus_ray_device {
  cl_mem buffers[BUFFERS];
  size_t sizes[BUFFERS];
  uint64_t data_serial, table_serial, map_serial;
};

void stratus_ray_device_destroy(stratus_ray_caster* caster)
{
  if (caster->device) {
    for (int b = 0; b < BUFFERS; ++b) {
      stratus_device_buffer_release(caster->device->buffers[b]);
    }
    stratus_release(caster->context, caster->device);
    caster->device = NULL;
  }
}

/* A buffer of at least `bytes`, made anew only when it has to grow. */
static stratus_status reserve(stratus_ray_caster* caster, buffer_name name, cl_mem_flags access, size_t bytes)
{
  stratus_ray_device* d = caster->device;
  if (d->buffers[name] && d->sizes[name] >= bytes) {
    return STRATUS_OK;
  }
  stratus_device_buffer_release(d->buffers[name]);
  d->buffers[name] = NULL;
  TRY(stratus_device_buffer(caster->context, access, bytes, NULL, false, &d->buffers[name]));
  d->sizes[name] = bytes;
  return STRATUS_OK;
}

/* Copies (or borrows) what was built; `host` NULL leaves a buffer of one byte, since a kernel argument must be something. */
static stratus_status replace(stratus_ray_caster* caster, buffer_name name, const void* host, size_t bytes)
{
  stratus_ray_device* d = caster->device;
  stratus_device_buffer_release(d->buffers[name]);
  d->buffers[name] = NULL;
  TRY(stratus_device_buffer(caster->context, CL_MEM_READ_ONLY, host ? bytes : 16, host, host != NULL, &d->buffers[name]));
  d->sizes[name] = host ? bytes : 16;
  ++caster->uploads;
  return STRATUS_OK;
}

static size_t value_bytes(const stratus_volume* volume)
{
  const size_t values = (size_t)volume->dimensions[0] * (size_t)volume->dimensions[1] * (size_t)volume->dimensions[2];
  return ((values - 1) * (size_t)volume->value_stride + 1) * stratus_type_size(volume->type);
}

static size_t hidden_bytes(const stratus_ray_caster* caster)
{
  size_t bytes = 1;
  for (int axis = 0; axis < 3; ++axis) {
    const size_t n = (size_t)caster->volume.dimensions[axis];
    bytes *= caster->hidden_by_value ? n : n > 1 ? n - 1 : 1;
  }
  return bytes;
}

static stratus_status upload(stratus_ray_caster* caster, const stratus_ray_cast_frame* frame)
{
  stratus_ray_device* d = caster->device;
  if (d->data_serial != caster->data_serial) {
    TRY(replace(caster, VALUES, frame->values, value_bytes(&caster->traversed)));
    TRY(replace(caster, HIDDEN, frame->hidden, frame->hidden ? hidden_bytes(caster) : 0));
    d->data_serial = caster->data_serial;
  }
  if (d->table_serial != caster->table_serial) {
    const size_t entries = (size_t)caster->table->size;
    TRY(replace(caster, TABLE, frame->table, caster->table->rgba ? 8 * entries * sizeof(float) : 4 * (entries + 1) * sizeof(int32_t)));
    d->table_serial = caster->table_serial;
  }
  const uint64_t map_serial = frame->map ? caster->map_serial : 0; /* without a map, none may stay borrowed */
  if (!d->buffers[MAP] || d->map_serial != map_serial) {
    TRY(replace(caster, MAP, frame->map, frame->map ? caster->map->bytes_size : 0));
    d->map_serial = map_serial;
  }
  return STRATUS_OK;
}

static stratus_status prepare(stratus_ray_caster* caster, const stratus_ray_cast_frame* frame, size_t rows)
{
  stratus_context* context = caster->context;
  stratus_ray_device* d = caster->device;
  const size_t pixels = (size_t)frame->arguments->width * (size_t)frame->arguments->height;
  TRY(reserve(caster, ARGUMENTS, CL_MEM_READ_ONLY, sizeof *frame->arguments));
  TRY(stratus_device_write(context, d->buffers[ARGUMENTS], 0, sizeof *frame->arguments, frame->arguments));
  TRY(reserve(caster, OPAQUE, CL_MEM_READ_ONLY, frame->opaque_depth ? pixels * sizeof(float) : 16));
  if (frame->opaque_depth) {
    TRY(stratus_device_write(context, d->buffers[OPAQUE], 0, pixels * sizeof(float), frame->opaque_depth));
  }
  TRY(reserve(caster, RGBA, CL_MEM_WRITE_ONLY, pixels * 4 * sizeof(float)));
  TRY(reserve(caster, DEPTH, CL_MEM_WRITE_ONLY, frame->depth ? pixels * sizeof(float) : 16));
  TRY(reserve(caster, SAMPLES, CL_MEM_WRITE_ONLY, frame->samples ? pixels * sizeof(uint32_t) : 16));
  void* zeros = NULL;
  TRY(stratus_allocate_zero(context, rows, 4 * sizeof(cl_uint), &zeros));
  stratus_status status = reserve(caster, COUNTS, CL_MEM_READ_WRITE, rows * 4 * sizeof(cl_uint));
  if (status == STRATUS_OK) {
    status = stratus_device_write(context, d->buffers[COUNTS], 0, rows * 4 * sizeof(cl_uint), zeros);
  }
  stratus_release(context, zeros);
  return status;
}

static stratus_status read_back(stratus_ray_caster* caster, const stratus_ray_cast_frame* frame, size_t rows, stratus_ray_counts* counts)
{
  stratus_context* context = caster->context;
  stratus_ray_device* d = caster->device;
  const size_t pixels = (size_t)frame->arguments->width * (size_t)frame->arguments->height;
  void* memory = NULL;
  TRY(stratus_device_read(context, d->buffers[RGBA], 0, pixels * 4 * sizeof(float), frame->rgba));
  if (frame->depth) {
    TRY(stratus_device_read(context, d->buffers[DEPTH], 0, pixels * sizeof(float), frame->depth));
  }
  if (frame->samples) {
    TRY(stratus_device_read(context, d->buffers[SAMPLES], 0, pixels * sizeof(uint32_t), frame->samples));
  }
  TRY(stratus_allocate(context, rows, 4 * sizeof(cl_uint), &memory));
  const cl_uint* row = memory;
  const stratus_status status = stratus_device_read(context, d->buffers[COUNTS], 0, rows * 4 * sizeof(cl_uint), memory);
  *counts = (stratus_ray_counts){ 0 };
  for (size_t i = 0; status == STRATUS_OK && i < rows; ++i) {
    counts->rays += row[4 * i];
    counts->samples += row[4 * i + 1];
    counts->skipped += row[4 * i + 2];
    counts->lookups += row[4 * i + 3];
  }
  stratus_release(context, memory);
  return status;
}

/* Why the device can't draw this volume, or NULL. */
static const char* obstacle(const stratus_ray_caster* caster)
{
  const stratus_device* device = caster->context->device;
  const size_t largest = stratus_device_largest_allocation(device);
  if (value_bytes(&caster->traversed) > largest) {
    return "the volume is larger than the device's largest allocation";
  }
  if (caster->map && caster->map->bytes_size > largest) {
    return "the distance map is larger than the device's largest allocation";
  }
  if (stratus_type_is_wide(caster->traversed.type) && !stratus_device_has_double(device)) {
    return "the device has no double for this type of values";
  }
  return NULL;
}

static stratus_status launch(
  stratus_ray_caster* caster, const stratus_ray_cast_frame* frame, int type, bool preintegrated, bool packets, size_t* rows)
{
  stratus_context* context = caster->context;
  char defines[160];
  cl_kernel kernel;
  snprintf(defines, sizeof defines, "-DSTRATUS_DEVICE=1 -DSTRATUS_TYPE=%d -DSTRATUS_PREINTEGRATED=%d -DSTRATUS_WIDTH=%d%s", type,
    preintegrated, packets ? 16 : 1, stratus_device_has_double(context->device) ? "" : " -DSTRATUS_REAL_PAIR=1");
  TRY(stratus_device_kernel(context, "ray_cast", defines, "ray_cast", &kernel));
  const size_t side = packets ? 4 : 1, group = packets ? 1 : LOCAL_SIDE;
  const size_t global[2] = { ((size_t)frame->arguments->width + side - 1) / side, ((size_t)frame->arguments->height + side - 1) / side };
  const size_t local[2] = { group * (packets ? 4 : 1), group };
  *rows = global[1];
  TRY(prepare(caster, frame, *rows));
  static const buffer_name order[] = { ARGUMENTS, VALUES, HIDDEN, MAP, TABLE, OPAQUE, RGBA, DEPTH, SAMPLES, COUNTS };
  for (unsigned i = 0; i < sizeof order / sizeof *order; ++i) {
    TRY(stratus_device_argument(context, kernel, i, sizeof(cl_mem), &caster->device->buffers[order[i]]));
  }
  return stratus_device_run(context, kernel, 2, global, local);
}

stratus_status stratus_ray_cast_device(stratus_ray_caster* caster, const stratus_ray_cast_frame* frame, int type, bool preintegrated,
  stratus_ray_counts* counts, double* upload_ms, bool* drawn)
{
  stratus_context* context = caster->context;
  const char* why_not = obstacle(caster);
  if (why_not) {
    stratus_log(context, STRATUS_LOG_WARNING, "drawing on the host: %s", why_not);
    return STRATUS_OK;
  }
  if (!caster->device) {
    void* memory = NULL;
    TRY(stratus_allocate_zero(context, 1, sizeof *caster->device, &memory));
    caster->device = memory;
  }
  const double start = stratus_now_ms();
  size_t rows = 0;
  TRY(upload(caster, frame));
  *upload_ms += stratus_now_ms() - start;
  TRY(stratus_progress(context, "ray cast", 0.0));
  const bool packets = stratus_device_is_cpu(context->device) && stratus_device_has_double(context->device);
  TRY(launch(caster, frame, type, preintegrated, packets, &rows));
  TRY(read_back(caster, frame, rows, counts));
  *drawn = true;
  return stratus_progress(context, "ray cast", 1.0);
}
