/* SPDX-License-Identifier: BSD-3-Clause
 * Structures of a volume on the context's OpenCL device: buffers, arguments and launches for the kernels in skipping.cl. */
#include "volume_device.h"

#include "device_frame.h"

#include <stdio.h>

static stratus_status make_buffer(stratus_context* context, size_t bytes, cl_mem* buffer)
{
  return stratus_device_buffer(context, CL_MEM_READ_WRITE, bytes, NULL, false, buffer);
}

static stratus_status make_input(stratus_context* context, size_t bytes, const void* host, cl_mem* buffer)
{
  return stratus_device_buffer(context, CL_MEM_READ_ONLY, bytes, host, true, buffer);
}

static void release_buffers(cl_mem* buffers, size_t count)
{
  for (size_t i = 0; i < count; ++i) {
    stratus_device_buffer_release(buffers[i]);
  }
}

/* ---- value ranges */

static size_t volume_bytes(const stratus_volume* volume)
{
  return ((stratus_volume_count(volume) - 1) * (size_t)volume->value_stride + 1) * stratus_type_size(volume->type);
}

bool stratus_device_takes_volume(const stratus_context* context, const stratus_volume* volume)
{
  /* The buffers of column extremes hold at most one float for every 2x2 values along y and z. */
  const size_t columns = (size_t)volume->dimensions[0] * ((size_t)volume->dimensions[1] / 2 + 1) * ((size_t)volume->dimensions[2] / 2 + 1);
  const size_t largest = stratus_device_largest_allocation(context->device);
  return volume_bytes(volume) <= largest && columns <= largest / sizeof(float) &&
    (!stratus_type_is_wide(volume->type) || stratus_device_has_double(context->device));
}

static const char* value_name(stratus_type type)
{
  static const char* const names[] = { "char", "uchar", "short", "ushort", "int", "uint", "long", "ulong", "float", "double" };
  return names[type];
}

typedef struct range_buffers {
  cl_mem values, column_lo, column_hi, column_bad, lo, hi, gaps;
} range_buffers;

static stratus_status make_range_buffers(
  stratus_context* context, const stratus_volume* volume, size_t columns, size_t blocks, range_buffers* b)
{
  TRY(make_input(context, volume_bytes(volume), volume->values, &b->values));
  TRY(make_buffer(context, columns * sizeof(float), &b->column_lo));
  TRY(make_buffer(context, columns * sizeof(float), &b->column_hi));
  TRY(make_buffer(context, columns, &b->column_bad));
  TRY(make_buffer(context, blocks * sizeof(float), &b->lo));
  TRY(make_buffer(context, blocks * sizeof(float), &b->hi));
  return make_buffer(context, blocks, &b->gaps);
}

static stratus_status run_ranges(
  stratus_context* context, const stratus_volume* volume, const stratus_value_range* ranges, const range_buffers* b)
{
  const cl_long nx = volume->dimensions[0], ny = volume->dimensions[1], nz = volume->dimensions[2], stride = volume->value_stride;
  const cl_long size = ranges->block_size, bx = ranges->blocks[0], by = ranges->blocks[1], bz = ranges->blocks[2];
  const int wide = stratus_type_is_wide(volume->type);
  const cl_float no_bias = 0.0f;
  char defines[64];
  snprintf(defines, sizeof defines, "-DVALUE=%s -DWIDE=%d", value_name(volume->type), wide);
  const stratus_kernel_argument bias = { wide ? sizeof(double) : sizeof no_bias, wide ? (const void*)&ranges->bias : &no_bias };
  for (cl_int stage = 0; stage < 2; ++stage) { /* columns, then blocks */
    const stratus_kernel_argument arguments[] = { ARGUMENT(stage), ARGUMENT(b->values), bias, ARGUMENT(nx), ARGUMENT(ny), ARGUMENT(nz),
      ARGUMENT(stride), ARGUMENT(size), ARGUMENT(bx), ARGUMENT(by), ARGUMENT(bz), ARGUMENT(b->column_lo), ARGUMENT(b->column_hi),
      ARGUMENT(b->column_bad), ARGUMENT(b->lo), ARGUMENT(b->hi), ARGUMENT(b->gaps) };
    const int64_t items[3] = { stage ? bx : nx, by, bz };
    TRY(stratus_device_launch(context, "skipping", defines, "value_ranges", arguments, COUNT_OF(arguments), items));
  }
  return STRATUS_OK;
}

stratus_status stratus_device_value_range(stratus_context* context, const stratus_volume* volume, stratus_value_range* ranges)
{
  stratus_status status = STRATUS_OK;
  range_buffers b = { .values = NULL };
  const size_t rows = (size_t)(ranges->blocks[1] * ranges->blocks[2]), count = rows * (size_t)ranges->blocks[0];

  TRY_CLEANUP(make_range_buffers(context, volume, rows * (size_t)volume->dimensions[0], count, &b));
  TRY_CLEANUP(run_ranges(context, volume, ranges, &b));
  TRY_CLEANUP(stratus_device_read(context, b.lo, 0, count * sizeof(float), ranges->lo));
  TRY_CLEANUP(stratus_device_read(context, b.hi, 0, count * sizeof(float), ranges->hi));
  TRY_CLEANUP(stratus_device_read(context, b.gaps, 0, count, ranges->gaps));
  ranges->on_device = true;
  if (!stratus_device_is_cpu(context->device)) { /* a processor's buffers can be the host's arrays */
    ranges->device_lo = b.lo;
    ranges->device_hi = b.hi;
    b.lo = b.hi = NULL;
  }

cleanup:
  release_buffers((cl_mem[]){ b.values, b.column_lo, b.column_hi, b.column_bad, b.lo, b.hi, b.gaps }, 7);
  return status;
}

/* ---- occupancy */

stratus_status stratus_device_occupancy(
  stratus_context* context, const stratus_value_range* ranges, const stratus_shown* shown, bool gaps_show, stratus_occupancy* occupancy)
{
  static const float none[2] = { INFINITY, -INFINITY }; /* a buffer is never empty */
  stratus_status status = STRATUS_OK;
  cl_mem lo = NULL, hi = NULL, gaps = NULL, intervals = NULL, occupied = NULL;
  const cl_ulong count = (cl_ulong)(ranges->blocks[0] * ranges->blocks[1] * ranges->blocks[2]);
  const cl_int gaps_count = gaps_show, interval_count = (cl_int)shown->count;
  const size_t interval_bytes = shown->count > 0 ? (size_t)shown->count * sizeof *shown->of : sizeof none;

  cl_mem range[2] = { ranges->device_lo, ranges->device_hi };
  if (!range[0]) {
    TRY_CLEANUP(make_input(context, count * sizeof(float), ranges->lo, &lo));
    TRY_CLEANUP(make_input(context, count * sizeof(float), ranges->hi, &hi));
    range[0] = lo;
    range[1] = hi;
  }
  TRY_CLEANUP(make_input(context, count, ranges->gaps, &gaps));
  TRY_CLEANUP(make_input(context, interval_bytes, shown->count > 0 ? (const void*)shown->of : none, &intervals));
  TRY_CLEANUP(make_buffer(context, count, &occupied));
  const stratus_kernel_argument arguments[] = { ARGUMENT(range[0]), ARGUMENT(range[1]), ARGUMENT(gaps), ARGUMENT(intervals),
    ARGUMENT(interval_count), ARGUMENT(gaps_count), ARGUMENT(count), ARGUMENT(occupied) };
  TRY_CLEANUP(stratus_device_launch(
    context, "skipping", NULL, "occupancy", arguments, COUNT_OF(arguments), (const int64_t[]){ (int64_t)count, 1, 1 }));
  TRY_CLEANUP(stratus_device_read(context, occupied, 0, count, occupancy->occupied));

cleanup:
  release_buffers((cl_mem[]){ lo, hi, gaps, intervals, occupied }, 5);
  return status;
}

/* ---- distance maps */

static size_t sums_count(const int64_t blocks[3])
{
  return (size_t)(blocks[0] + 1) * (size_t)(blocks[1] + 1) * (size_t)(blocks[2] + 1);
}

bool stratus_device_takes_blocks(const stratus_context* context, const int64_t blocks[3])
{
  const size_t sums = sums_count(blocks); /* more than the number of blocks, which the 32-bit sums must hold */
  return sums <= UINT32_MAX && sums <= stratus_device_largest_allocation(context->device) / sizeof(cl_uint);
}

static stratus_status run_sums(stratus_context* context, const int64_t blocks[3], cl_mem occupied, cl_mem sums)
{
  const cl_long nx = blocks[0], ny = blocks[1], nz = blocks[2], sx = nx + 1, sy = ny + 1, sz = nz + 1, one = 1, plane = sx * sy;
  const stratus_kernel_argument along_x[] = { ARGUMENT(occupied), ARGUMENT(nx), ARGUMENT(ny), ARGUMENT(nz), ARGUMENT(sums) };
  const stratus_kernel_argument along_y[] = { ARGUMENT(sums), ARGUMENT(sx), ARGUMENT(one), ARGUMENT(sz), ARGUMENT(plane), ARGUMENT(sy),
    ARGUMENT(sx) };
  const stratus_kernel_argument along_z[] = { ARGUMENT(sums), ARGUMENT(sx), ARGUMENT(one), ARGUMENT(sy), ARGUMENT(sx), ARGUMENT(sz),
    ARGUMENT(plane) };
  TRY(stratus_device_launch(context, "skipping", NULL, "sum_x", along_x, COUNT_OF(along_x), (const int64_t[]){ sy, sz, 1 }));
  TRY(stratus_device_launch(context, "skipping", NULL, "sum_axis", along_y, COUNT_OF(along_y), (const int64_t[]){ sx, sz, 1 }));
  return stratus_device_launch(context, "skipping", NULL, "sum_axis", along_z, COUNT_OF(along_z), (const int64_t[]){ sx, sy, 1 });
}

static stratus_status search_maps(stratus_context* context, stratus_distance_map* map, cl_mem occupied, cl_mem bytes)
{
  stratus_status status = STRATUS_OK;
  cl_mem sums = NULL;
  const cl_long nx = map->blocks[0], ny = map->blocks[1], nz = map->blocks[2], pitch = (cl_long)map->pitch;
  const int octants = map->kind == STRATUS_DISTANCE_OCTANT ? 8 : 1;

  TRY_CLEANUP(make_buffer(context, sums_count(map->blocks) * sizeof(cl_uint), &sums));
  TRY_CLEANUP(run_sums(context, map->blocks, occupied, sums));
  for (int octant = 0; octant < octants; ++octant) {
    const cl_int whole = octants == 1;
    const cl_int x = whole ? 0 : octant & 1 ? 1 : -1, y = whole ? 0 : octant & 2 ? 1 : -1, z = whole ? 0 : octant & 4 ? 1 : -1;
    const stratus_kernel_argument arguments[] = { ARGUMENT(occupied), ARGUMENT(sums), ARGUMENT(nx), ARGUMENT(ny), ARGUMENT(nz), ARGUMENT(x),
      ARGUMENT(y), ARGUMENT(z), ARGUMENT(pitch), ARGUMENT(bytes) };
    TRY_CLEANUP(stratus_device_launch(context, "skipping", NULL, "search", arguments, COUNT_OF(arguments), map->blocks));
    TRY_CLEANUP(stratus_device_read(context, bytes, 0, map->map_bytes, map->bytes + (size_t)octant * map->map_bytes));
  }

cleanup:
  stratus_device_buffer_release(sums);
  return status;
}

/* Bytes between rows of distances: ROW_MARGIN in skipping.cl. */
#define ROW_MARGIN 64

/* Returns the bytes of one of the four arrays of distances that a processor sweeps. */
static size_t sweep_bytes(const stratus_distance_map* map)
{
  return ((map->pitch + ROW_MARGIN) * (size_t)map->blocks[1] + ROW_MARGIN) * (size_t)map->blocks[2];
}

/* Returns the bytes of the two planes that each octant's sweep keeps. */
static size_t planes_bytes(const stratus_distance_map* map)
{
  return 8 * 2 * ((map->pitch + ROW_MARGIN) * (size_t)(map->blocks[1] + 1) + ROW_MARGIN);
}

/* Returns the bytes of all maps. */
static size_t all_bytes(const stratus_distance_map* map)
{
  return map->kind == STRATUS_DISTANCE_OCTANT ? 8 * map->map_bytes : map->map_bytes;
}

static bool sweeps(const stratus_context* context, const stratus_distance_map* map)
{
  const size_t largest = stratus_device_largest_allocation(context->device);
  return map->kind != STRATUS_DISTANCE_PAPER && stratus_device_is_cpu(context->device) && sweep_bytes(map) <= largest &&
    planes_bytes(map) <= largest && all_bytes(map) <= largest;
}

/* Maps by a processor: the host's sweeps. */
static stratus_status sweep_map(stratus_context* context, const stratus_occupancy* occupancy, stratus_distance_map* map, cl_mem occupied)
{
  stratus_status status = STRATUS_OK;
  cl_kernel kernel;
  cl_mem d[4] = { NULL }, planes = NULL;
  stratus_device_slot bytes = { .memory = NULL };
  const int octants = map->kind == STRATUS_DISTANCE_OCTANT;
  const int64_t* n = map->blocks;
  const cl_long nx = n[0], ny = n[1], nz = n[2], pitch = (cl_long)map->pitch;
  cl_long lo[3] = { 0 }, hi[3] = { 0 }; /* the box in which distances to empty blocks are needed */
  for (int a = 1; a < 3 && occupancy->count > 0 && occupancy->count < n[0] * n[1] * n[2]; ++a) {
    lo[a] = occupancy->lo[a] > 0 ? occupancy->lo[a] - 1 : 0;
    hi[a] = occupancy->hi[a] < n[a] ? occupancy->hi[a] + 1 : n[a];
  }
  TRY_CLEANUP(stratus_slot_lend(context, &bytes, CL_MEM_WRITE_ONLY, map->bytes, all_bytes(map)));
  for (int i = 0; i < 4; ++i) {
    TRY_CLEANUP(make_buffer(context, sweep_bytes(map), &d[i]));
  }
  if (octants) {
    TRY_CLEANUP(make_buffer(context, planes_bytes(map), &planes));
  }
  TRY_CLEANUP(stratus_device_kernel(context, "skipping", NULL, "distance_sweep", &kernel));
  for (cl_int stage = 0; stage < 5; ++stage) {
    const size_t items[5] = { 2 * (size_t)nz, 4, octants ? 0 : (size_t)(ny * nz), octants ? (size_t)((hi[1] - lo[1]) * (hi[2] - lo[2])) : 0,
      octants ? 8 : 0 };
    const size_t one = 1; /* items are few and long: each is a work-group */
    if (items[stage] == 0) {
      continue;
    }
    const stratus_kernel_argument arguments[] = { ARGUMENT(stage), ARGUMENT(occupied), ARGUMENT(nx), ARGUMENT(ny), ARGUMENT(nz),
      ARGUMENT(pitch), ARGUMENT(lo[1]), ARGUMENT(hi[1]), ARGUMENT(lo[2]), ARGUMENT(hi[2]), ARGUMENT(d[0]), ARGUMENT(d[1]), ARGUMENT(d[2]),
      ARGUMENT(d[3]), ARGUMENT(planes), ARGUMENT(bytes.memory) };
    for (unsigned i = 0; i < COUNT_OF(arguments); ++i) {
      TRY_CLEANUP(stratus_device_argument(context, kernel, i, arguments[i].size, arguments[i].value));
    }
    TRY_CLEANUP(stratus_device_run(context, kernel, 1, &items[stage], &one));
  }
  TRY_CLEANUP(stratus_slot_receive(context, &bytes, map->bytes, all_bytes(map)));

cleanup:
  stratus_slot_drop(&bytes);
  stratus_device_buffer_release(planes);
  release_buffers(d, 4);
  return status;
}

static stratus_status paper_map(stratus_context* context, stratus_distance_map* map, cl_mem occupied, cl_mem bytes)
{
  stratus_status status = STRATUS_OK;
  cl_mem distance[2] = { NULL, NULL }; /* the seeds and the passes take turns */
  const cl_long nx = map->blocks[0], ny = map->blocks[1], nz = map->blocks[2], rows = ny * nz, pitch = (cl_long)map->pitch;
  const cl_ulong count = (cl_ulong)(nx * rows);

  TRY_CLEANUP(make_buffer(context, (size_t)count, &distance[0]));
  TRY_CLEANUP(make_buffer(context, (size_t)count, &distance[1]));
  const stratus_kernel_argument seed[] = { ARGUMENT(occupied), ARGUMENT(count), ARGUMENT(distance[0]) };
  TRY_CLEANUP(
    stratus_device_launch(context, "skipping", NULL, "paper_seed", seed, COUNT_OF(seed), (const int64_t[]){ (int64_t)count, 1, 1 }));
  for (cl_int axis = 0; axis < 3; ++axis) {
    const stratus_kernel_argument pass[] = { ARGUMENT(distance[axis & 1]), ARGUMENT(nx), ARGUMENT(ny), ARGUMENT(nz), ARGUMENT(axis),
      ARGUMENT(distance[(axis + 1) & 1]) };
    TRY_CLEANUP(stratus_device_launch(context, "skipping", NULL, "paper_axis", pass, COUNT_OF(pass), map->blocks));
  }
  const stratus_kernel_argument place[] = { ARGUMENT(distance[1]), ARGUMENT(nx), ARGUMENT(rows), ARGUMENT(pitch), ARGUMENT(bytes) };
  TRY_CLEANUP(stratus_device_launch(context, "skipping", NULL, "paper_place", place, COUNT_OF(place), (const int64_t[]){ nx, rows, 1 }));
  TRY_CLEANUP(stratus_device_read(context, bytes, 0, map->map_bytes, map->bytes));

cleanup:
  release_buffers(distance, 2);
  return status;
}

stratus_status stratus_device_distance_map(stratus_context* context, const stratus_occupancy* occupancy, stratus_distance_map* map)
{
  stratus_status status = STRATUS_OK;
  cl_mem occupied = NULL, bytes = NULL;
  const size_t count = (size_t)(map->blocks[0] * map->blocks[1] * map->blocks[2]);

  TRY_CLEANUP(make_input(context, count, occupancy->occupied, &occupied));
  if (sweeps(context, map)) {
    TRY_CLEANUP(sweep_map(context, occupancy, map, occupied));
    goto cleanup;
  }
  TRY_CLEANUP(make_buffer(context, map->map_bytes, &bytes));
  if (map->kind == STRATUS_DISTANCE_PAPER) {
    TRY_CLEANUP(paper_map(context, map, occupied, bytes));
  } else {
    TRY_CLEANUP(search_maps(context, map, occupied, bytes));
  }

cleanup:
  release_buffers((cl_mem[]){ occupied, bytes }, 2);
  return status;
}
