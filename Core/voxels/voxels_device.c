/* SPDX-License-Identifier: BSD-3-Clause
 * Effective voxels on the context's OpenCL device: buffers, arguments and launches of voxels.cl. Values go there in pieces of whole layers
 * of bricks, so that a volume larger than the largest allocation fits, too; the masks stay until all bricks are known. */
#include "device_frame.h"
#include "voxels_build.h"

#include <stdio.h>
#include <string.h>

typedef struct voxels_device {
  stratus_context* context;
  const stratus_scan* scan;
  stratus_voxels* voxels;
  char defines[64];
  cl_mem intervals, masks, counts, start;
  stratus_device_slot bricks;
  uint64_t* host_start; /* number of bricks in all rows before, for each row and for their end */
} voxels_device;

static size_t plane_values(const stratus_volume* volume)
{
  return (size_t)volume->dimensions[0] * (size_t)volume->dimensions[1];
}

static size_t plane_bytes(const stratus_volume* volume)
{
  return plane_values(volume) * (size_t)volume->value_stride * stratus_type_size(volume->type);
}

static size_t row_count(const stratus_voxels* voxels)
{
  return (size_t)voxels->bricks_along[1] * (size_t)voxels->bricks_along[2];
}

/* The type of an interval's ends on the device: see stratus_bound. */
static const char* end_name(stratus_type type)
{
  return type == STRATUS_FLOAT32 ? "float" : type < STRATUS_INT64 ? "long" : "double";
}

bool stratus_voxels_on_device(const stratus_context* context, const stratus_volume* volume, const stratus_voxels* voxels)
{
  const size_t largest = context->device ? stratus_device_largest_allocation(context->device) : 0;
  return stratus_device_builds(context) && (end_name(volume->type)[0] != 'd' || stratus_device_has_double(context->device)) &&
    STRATUS_BRICK * plane_bytes(volume) <= largest &&
    row_count(voxels) <= largest / sizeof(stratus_brick) / (size_t)voxels->bricks_along[0];
}

static const char* name_of(stratus_type type)
{
  static const char* const names[] = { "char", "uchar", "short", "ushort", "int", "uint", "long", "ulong", "float", "double" };
  return names[type];
}

/* Copies the intervals' ends in the type in which the kernel compares. */
static stratus_status send_intervals(voxels_device* d)
{
  const stratus_scan* scan = d->scan;
  const stratus_type type = scan->volume->type;
  const size_t count = scan->count ? (size_t)scan->count : 1;
  void* memory;
  TRY(stratus_allocate_zero(d->context, count, 2 * sizeof(int64_t), &memory));
  for (int64_t i = 0; i < 2 * scan->count; ++i) {
    const stratus_bound* end = i & 1 ? &scan->intervals[i / 2].hi : &scan->intervals[i / 2].lo;
    if (type == STRATUS_FLOAT32) {
      ((float*)memory)[i] = (float)end->d;
    } else {
      ((stratus_bound*)memory)[i] = *end; /* a long or a double */
    }
  }
  const stratus_status status =
    stratus_device_buffer(d->context, CL_MEM_READ_ONLY, count * 2 * sizeof(int64_t), memory, false, &d->intervals);
  stratus_release(d->context, memory);
  return status;
}

/* Fills the masks of `layers` layers of bricks from layer `first` on. */
static stratus_status fill_masks(const voxels_device* d, int64_t first, int64_t layers)
{
  const stratus_volume* volume = d->scan->volume;
  const int64_t* n = volume->dimensions;
  const int64_t plane = STRATUS_BRICK * first, rest = n[2] - plane, planes = STRATUS_BRICK * layers < rest ? STRATUS_BRICK * layers : rest;
  const size_t values = plane_values(volume) * (size_t)planes, skip = plane_values(volume) * (size_t)plane;
  const size_t bytes = ((values - 1) * (size_t)volume->value_stride + 1) * stratus_type_size(volume->type);
  const cl_long nx = n[0], ny = n[1], nz = planes, stride = volume->value_stride;
  const cl_long bx = d->voxels->bricks_along[0], by = d->voxels->bricks_along[1];
  const cl_uint hidden = d->scan->ghosts ? d->scan->hidden : 0;
  const cl_int intervals = (cl_int)d->scan->count;
  const cl_long before = first;
  cl_mem numbers = NULL, ghosts = NULL;
  stratus_status status;
  TRY_CLEANUP(stratus_device_buffer(d->context, CL_MEM_READ_ONLY, bytes,
    (const uint8_t*)volume->values + skip * (size_t)volume->value_stride * stratus_type_size(volume->type), true, &numbers));
  TRY_CLEANUP(stratus_device_buffer(
    d->context, CL_MEM_READ_ONLY, hidden ? values : 16, hidden ? d->scan->ghosts + skip : NULL, hidden != 0, &ghosts));
  const stratus_kernel_argument arguments[] = { ARGUMENT(numbers), ARGUMENT(nx), ARGUMENT(ny), ARGUMENT(nz), ARGUMENT(stride),
    ARGUMENT(ghosts), ARGUMENT(hidden), ARGUMENT(d->intervals), ARGUMENT(intervals), ARGUMENT(bx), ARGUMENT(by), ARGUMENT(before),
    ARGUMENT(d->masks) };
  const bool by_rows = stratus_device_is_cpu(d->context->device);
  const int64_t rows[3] = { by, layers, 1 }, bricks[3] = { bx, by, layers };
  TRY_CLEANUP(stratus_device_launch(
    d->context, "voxels", d->defines, by_rows ? "mask_rows" : "masks", arguments, COUNT_OF(arguments), by_rows ? rows : bricks));
cleanup:
  stratus_device_buffer_release(numbers);
  stratus_device_buffer_release(ghosts);
  return status;
}

/* Counts the bricks that hold a voxel, row by row, and writes them. */
static stratus_status take_bricks(voxels_device* d)
{
  stratus_voxels* voxels = d->voxels;
  stratus_context* context = d->context;
  const cl_long n = voxels->bricks_along[0];
  const cl_ulong rows = row_count(voxels), ny = (cl_ulong)voxels->bricks_along[1];
  uint64_t* const start = d->host_start;
  void* memory;
  const stratus_kernel_argument count[] = { ARGUMENT(d->masks), ARGUMENT(n), ARGUMENT(rows), ARGUMENT(d->counts) };
  TRY(stratus_device_launch(context, "voxels", d->defines, "count_rows", count, COUNT_OF(count), (const int64_t[]){ (int64_t)rows, 1, 1 }));
  uint32_t* const counts = (uint32_t*)(start + rows + 1);
  TRY(stratus_device_read(context, d->counts, 0, rows * sizeof *counts, counts));
  start[0] = 0;
  for (size_t row = 0; row < rows; ++row) {
    start[row + 1] = start[row] + counts[row];
  }
  voxels->brick_count = (int64_t)start[rows];
  const size_t bytes = (size_t)voxels->brick_count * sizeof *voxels->bricks;
  TRY(stratus_allocate(context, (size_t)voxels->brick_count, sizeof *voxels->bricks, &memory));
  voxels->bricks = memory;
  TRY(stratus_device_write(context, d->start, 0, rows * sizeof *start, start));
  TRY(stratus_slot_lend(context, &d->bricks, CL_MEM_READ_WRITE, voxels->bricks, bytes));
  const stratus_kernel_argument compact[] = { ARGUMENT(d->masks), ARGUMENT(n), ARGUMENT(rows), ARGUMENT(ny), ARGUMENT(d->start),
    ARGUMENT(d->bricks.memory) };
  TRY(
    stratus_device_launch(context, "voxels", d->defines, "compact", compact, COUNT_OF(compact), (const int64_t[]){ (int64_t)rows, 1, 1 }));
  return bytes ? stratus_slot_receive(context, &d->bricks, voxels->bricks, bytes) : STRATUS_OK;
}

static stratus_status run(voxels_device* d)
{
  const size_t rows = row_count(d->voxels), layer = STRATUS_BRICK * plane_bytes(d->scan->volume);
  const int64_t layers = d->voxels->bricks_along[2], most = (int64_t)(stratus_device_largest_allocation(d->context->device) / layer);
  const int64_t piece = most < layers ? most : layers;
  void* memory;
  TRY(stratus_allocate(d->context, rows + 1, sizeof(uint64_t) + sizeof(uint32_t), &memory));
  d->host_start = memory;
  TRY(send_intervals(d));
  TRY(stratus_device_buffer(
    d->context, CL_MEM_READ_WRITE, rows * (size_t)d->voxels->bricks_along[0] * sizeof(uint64_t), NULL, false, &d->masks));
  TRY(stratus_device_buffer(d->context, CL_MEM_READ_WRITE, rows * sizeof(uint32_t), NULL, false, &d->counts));
  TRY(stratus_device_buffer(d->context, CL_MEM_READ_ONLY, rows * sizeof(uint64_t), NULL, false, &d->start));
  for (int64_t first = 0; first < layers; first += piece) {
    TRY(stratus_progress(d->context, "effective voxels", (double)first / (double)layers));
    TRY(fill_masks(d, first, first + piece < layers ? piece : layers - first));
  }
  return take_bricks(d);
}

stratus_status stratus_device_voxels(stratus_context* context, const stratus_scan* scan, stratus_voxels* voxels)
{
  const stratus_type type = scan->volume->type;
  voxels_device d = { .context = context, .scan = scan, .voxels = voxels };
  snprintf(d.defines, sizeof d.defines, "-DVALUE=%s -DAS=%s -DEND=%s", name_of(type), end_name(type)[0] == 'd' ? "double" : name_of(type),
    end_name(type));
  const stratus_status status = run(&d);
  if (status != STRATUS_OK) {
    stratus_slots_return(context, &d.bricks, 1);
    stratus_release(context, voxels->bricks);
    voxels->bricks = NULL;
    voxels->brick_count = 0;
  }
  stratus_slots_return(context, &d.bricks, 1);
  stratus_slot_drop(&d.bricks);
  stratus_device_buffer_release(d.intervals);
  stratus_device_buffer_release(d.masks);
  stratus_device_buffer_release(d.counts);
  stratus_device_buffer_release(d.start);
  stratus_release(context, d.host_start);
  return status;
}
