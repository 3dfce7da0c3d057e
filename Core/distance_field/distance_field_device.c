/* SPDX-License-Identifier: BSD-3-Clause
 * Distance fields on the context's OpenCL device: whether it makes them; buffers, arguments and launches of distance_field.cl and
 * jump_flooding.cl. */
#include "device_frame.h"
#include "jump_flooding_passes.h"

#include <stdio.h>
#include <string.h>

#define DEFINES_MAX 64
#define CPU_GROUPS 64 /* of one item, each with a room of its own */
#define LANES 16

bool stratus_field_on_device(const stratus_context* context, const int64_t n[3], size_t bytes)
{
  return stratus_device_builds(context) &&
    (size_t)n[0] * (size_t)n[1] * (size_t)n[2] <= stratus_device_largest_allocation(context->device) / bytes;
}

static stratus_status make_buffer(stratus_context* context, size_t bytes, cl_mem* buffer)
{
  return stratus_device_buffer(context, CL_MEM_READ_WRITE, bytes, NULL, false, buffer);
}

/* ---- exact */

static stratus_status run_axes(
  stratus_context* context, const stratus_bits* set, int is_signed, int wide, cl_mem bits, const cl_mem field[2])
{
  const cl_long nx = set->n[0], ny = set->n[1], nz = set->n[2], words = set->words;
  const cl_int along_x = 0, along_z = 2, with_sign = is_signed;
  const char* defines = wide ? "-DWIDE=1" : "-DWIDE=0";
  const stratus_kernel_argument columns[] = { ARGUMENT(bits), ARGUMENT(nx), ARGUMENT(ny), ARGUMENT(nz), ARGUMENT(words),
    ARGUMENT(with_sign), ARGUMENT(field[0]) };
  const stratus_kernel_argument x[] = { ARGUMENT(field[0]), ARGUMENT(nx), ARGUMENT(ny), ARGUMENT(nz), ARGUMENT(along_x),
    ARGUMENT(field[1]) };
  const stratus_kernel_argument z[] = { ARGUMENT(field[1]), ARGUMENT(nx), ARGUMENT(ny), ARGUMENT(nz), ARGUMENT(along_z),
    ARGUMENT(field[0]) };
  TRY(stratus_device_launch(context, "distance_field", defines, "columns", columns, COUNT_OF(columns), (const int64_t[]){ nx, nz, 1 }));
  TRY(stratus_device_launch(context, "distance_field", defines, "search", x, COUNT_OF(x), set->n));
  return stratus_device_launch(context, "distance_field", defines, "search", z, COUNT_OF(z), set->n);
}

/* 32 bits on a processor: planes, then tiles of columns, in place. */
static stratus_status run_rows(stratus_context* context, const stratus_bits* set, int is_signed, cl_mem bits, int32_t* values)
{
  stratus_status status = STRATUS_OK;
  cl_mem rooms = NULL, kinds = NULL;
  stratus_device_slot field = { .memory = NULL };
  const cl_long nx = set->n[0], ny = set->n[1], nz = set->n[2], words = set->words;
  const cl_int with_sign = is_signed;
  const size_t row = ((size_t)nx + LANES - 1) / LANES * LANES, planes = (size_t)nz, tiles = ((size_t)(nx * ny) + LANES - 1) / LANES;
  const size_t plane_groups = planes < CPU_GROUPS ? planes : CPU_GROUPS, tile_groups = tiles < CPU_GROUPS ? tiles : CPU_GROUPS;
  const cl_long pad = (cl_long)row + 2 * LANES; /* a search reaches over a row, and its vectors over their ends */
  const size_t plane_room = plane_groups * (3 * row + 4 * (size_t)pad), tile_room = tile_groups * 2 * LANES * planes;
  const size_t bytes = (size_t)(nx * ny * nz) * sizeof *values;

  TRY_CLEANUP(make_buffer(context, (plane_room > tile_room ? plane_room : tile_room) * sizeof(cl_int), &rooms));
  TRY_CLEANUP(make_buffer(context, planes, &kinds));
  TRY_CLEANUP(stratus_slot_lend(context, &field, CL_MEM_READ_WRITE, values, bytes));
  const stratus_kernel_argument plane_arguments[] = { ARGUMENT(bits), ARGUMENT(nx), ARGUMENT(ny), ARGUMENT(nz), ARGUMENT(words),
    ARGUMENT(with_sign), ARGUMENT(pad), ARGUMENT(rooms), ARGUMENT(kinds), ARGUMENT(field.memory) };
  const stratus_kernel_argument tile_arguments[] = { ARGUMENT(kinds), ARGUMENT(nx), ARGUMENT(ny), ARGUMENT(nz), ARGUMENT(rooms),
    ARGUMENT(field.memory) };
  TRY_CLEANUP(stratus_device_launch_groups(
    context, "distance_field", "-DWIDE=0", "planes", plane_arguments, COUNT_OF(plane_arguments), plane_groups, 1));
  TRY_CLEANUP(
    stratus_device_launch_groups(context, "distance_field", "-DWIDE=0", "tiles", tile_arguments, COUNT_OF(tile_arguments), tile_groups, 1));
  TRY_CLEANUP(stratus_slot_receive(context, &field, values, bytes));

cleanup:
  stratus_slot_drop(&field);
  stratus_device_buffer_release(rooms);
  stratus_device_buffer_release(kinds);
  return status;
}

stratus_status stratus_device_field_exact(stratus_context* context, const stratus_bits* set, stratus_field* field)
{
  stratus_status status = STRATUS_OK;
  cl_mem bits = NULL, buffers[2] = { NULL, NULL };
  void* values = NULL;
  const size_t count = (size_t)(set->n[0] * set->n[1] * set->n[2]);
  const size_t words = (size_t)(set->words * set->n[1] * set->n[2]);
  const int wide = stratus_field_is_wide(set->n);
  const size_t size = wide ? sizeof(int64_t) : sizeof(int32_t);

  TRY_CLEANUP(stratus_allocate(context, count, size, &values));
  TRY_CLEANUP(stratus_device_buffer(context, CL_MEM_READ_ONLY, words * sizeof(uint64_t), set->bits, true, &bits));
  if (stratus_device_is_cpu(context->device) && !wide) {
    TRY_CLEANUP(run_rows(context, set, field->is_signed, bits, values));
  } else {
    TRY_CLEANUP(make_buffer(context, count * size, &buffers[0]));
    TRY_CLEANUP(make_buffer(context, count * size, &buffers[1]));
    TRY_CLEANUP(run_axes(context, set, field->is_signed, wide, bits, buffers));
    TRY_CLEANUP(stratus_device_read(context, buffers[0], 0, count * size, values));
  }
  field->values = values;
  field->bytes = (int)size;
  values = NULL;

cleanup:
  stratus_release(context, values);
  stratus_device_buffer_release(bits);
  stratus_device_buffer_release(buffers[0]);
  stratus_device_buffer_release(buffers[1]);
  return status;
}

/* ---- floodings */

struct flood_device {
  int64_t n[3];
  int wide;
  size_t groups;
  cl_mem from, to, sums;
  cl_uint* host_sums; /* two for each work-group */
};

stratus_status stratus_flood_device_create(stratus_context* context, const int64_t n[3], int wide, const uint32_t* from, flood_device** out)
{
  stratus_status status = STRATUS_OK;
  flood_device* device = NULL;
  void* memory = NULL;
  const size_t rows = (size_t)(n[1] * n[2]), bytes = rows * (size_t)n[0] * sizeof(uint32_t);

  TRY(stratus_allocate_zero(context, 1, sizeof *device, &memory));
  device = memory;
  memcpy(device->n, n, sizeof device->n);
  device->wide = wide;
  device->groups = rows * (((size_t)n[0] + STRATUS_DEVICE_GROUP - 1) / STRATUS_DEVICE_GROUP);
  TRY_CLEANUP(stratus_allocate(context, device->groups, 2 * sizeof(cl_uint), &memory));
  device->host_sums = memory;
  TRY_CLEANUP(make_buffer(context, bytes, &device->from));
  TRY_CLEANUP(make_buffer(context, bytes, &device->to));
  TRY_CLEANUP(make_buffer(context, device->groups * 2 * sizeof(cl_uint), &device->sums));
  TRY_CLEANUP(stratus_device_write(context, device->from, 0, bytes, from));
  *out = device;
  device = NULL;

cleanup:
  stratus_flood_device_destroy(context, device);
  return status;
}

stratus_status stratus_flood_device_pass(stratus_context* context, flood_device* device, int step, flood_count* count)
{
  const flood_layout layout = flood_shifts(device->n);
  const cl_long nx = device->n[0], ny = device->n[1], nz = device->n[2];
  const cl_int step_argument = step, shift_y = layout.shift_y, shift_z = layout.shift_z;
  char defines[DEFINES_MAX];
  snprintf(defines, sizeof defines, "-DSTRATUS_DEVICE=1 -DWIDE=%d -DGROUP=%d", device->wide, STRATUS_DEVICE_GROUP);
  const stratus_kernel_argument arguments[] = { ARGUMENT(device->from), ARGUMENT(nx), ARGUMENT(ny), ARGUMENT(nz), ARGUMENT(step_argument),
    ARGUMENT(shift_y), ARGUMENT(shift_z), ARGUMENT(device->to), ARGUMENT(device->sums) };
  const bool by_rows = stratus_device_is_cpu(context->device);
  const int64_t rows[3] = { ny, nz, 1 };
  TRY(stratus_device_launch(
    context, "jump_flooding", defines, by_rows ? "flood_rows" : "flood", arguments, COUNT_OF(arguments), by_rows ? rows : device->n));
  TRY(stratus_device_read(context, device->sums, 0, device->groups * 2 * sizeof(cl_uint), device->host_sums));
  *count = (flood_count){ 0, 0 };
  for (size_t group = 0; group < device->groups; ++group) {
    count->updated += device->host_sums[2 * group];
    count->ratios += device->host_sums[2 * group + 1];
  }
  const cl_mem swap = device->from;
  device->from = device->to;
  device->to = swap;
  return STRATUS_OK;
}

stratus_status stratus_flood_device_read(stratus_context* context, const flood_device* device, uint32_t* to)
{
  return stratus_device_read(context, device->from, 0, (size_t)(device->n[0] * device->n[1] * device->n[2]) * sizeof(uint32_t), to);
}

void stratus_flood_device_destroy(stratus_context* context, flood_device* device)
{
  if (device) {
    stratus_device_buffer_release(device->from);
    stratus_device_buffer_release(device->to);
    stratus_device_buffer_release(device->sums);
    stratus_release(context, device->host_sums);
    stratus_release(context, device);
  }
}
