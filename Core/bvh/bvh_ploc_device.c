/* SPDX-License-Identifier: BSD-3-Clause
 * Parallel locally-ordered clustering on the context's OpenCL device: buffers for the kernels in ploc.cl, and their launches. Several
 * rounds are launched for the clusters of the first of them, because a round leaves half of them or more: the host asks how many are left
 * only after that. */
#include "bvh_build.h"
#include "device.h"

#include <stdio.h>

#define PADDING 16 /* as in ploc.cl */
#define ROUNDS_AT_ONCE 4
#define GPU_CHUNK 1024
#define GPU_LAST 512 /* one group makes the rounds of so few clusters */
#define CPU_CHUNK 2048
#define CPU_LAST CPU_CHUNK

enum {
  BUFFER_BOXES,
  BUFFER_SIDES,
  BUFFER_SIDES_NEXT,
  BUFFER_CHILD,
  BUFFER_CHILD_NEXT,
  BUFFER_NEAREST,
  BUFFER_SUMS,
  BUFFER_STATE,
  BUFFER_PAIRS,
  BUFFERS
};

typedef struct ploc_device {
  stratus_context* context;
  cl_mem buffers[BUFFERS];
  cl_uint count; /* at least as many as there are clusters */
  cl_ulong stride;
  cl_uint chunk, find_chunk;
  cl_int slot;
  size_t group;
  char defines[48];
} ploc_device;

static stratus_status launch(const ploc_device* d, const char* name, const stratus_kernel_argument* arguments, size_t count, size_t groups)
{
  return stratus_device_launch_groups(d->context, "ploc", d->defines, name, arguments, count, groups, d->group);
}

static stratus_status make_buffers(ploc_device* d, const stratus_box* boxes)
{
  const size_t count = d->count, sides = (size_t)d->stride * 6 * sizeof(float), numbers = (count + PADDING) * sizeof(cl_uint);
  const size_t bytes[BUFFERS] = { [BUFFER_SIDES] = sides,
    [BUFFER_SIDES_NEXT] = sides,
    [BUFFER_CHILD] = numbers,
    [BUFFER_CHILD_NEXT] = numbers,
    [BUFFER_NEAREST] = numbers,
    [BUFFER_SUMS] = ((count - 1) / d->chunk + 1) * 2 * sizeof(cl_uint),
    [BUFFER_STATE] = 4 * sizeof(cl_uint),
    [BUFFER_PAIRS] = (count - 1) * sizeof(stratus_bvh_pair) };
  TRY(stratus_device_buffer(d->context, CL_MEM_READ_ONLY, count * sizeof *boxes, boxes, true, &d->buffers[BUFFER_BOXES]));
  for (int b = BUFFER_BOXES + 1; b < BUFFERS; ++b) {
    TRY(stratus_device_buffer(d->context, CL_MEM_READ_WRITE, bytes[b], NULL, false, &d->buffers[b]));
  }
  return STRATUS_OK;
}

static stratus_status start(const ploc_device* d)
{
  const cl_mem* b = d->buffers;
  const cl_uint state[4] = { d->count, 0, 0, 0 };
  const stratus_kernel_argument arguments[] = { ARGUMENT(b[BUFFER_BOXES]), ARGUMENT(d->count), ARGUMENT(d->stride),
    ARGUMENT(b[BUFFER_SIDES]), ARGUMENT(b[BUFFER_CHILD]) };
  TRY(stratus_device_write(d->context, b[BUFFER_STATE], 0, sizeof state, state));
  return stratus_device_launch(
    d->context, "ploc", d->defines, "start", arguments, COUNT_OF(arguments), (const int64_t[]){ d->count, 1, 1 });
}

static void swap_clusters(ploc_device* d)
{
  for (int b = BUFFER_SIDES; b <= BUFFER_CHILD; b += 2) {
    const cl_mem swap = d->buffers[b];
    d->buffers[b] = d->buffers[b + 1];
    d->buffers[b + 1] = swap;
  }
}

static stratus_status run_round(ploc_device* d)
{
  const cl_mem* b = d->buffers;
  const size_t chunks = (d->count - 1) / d->chunk + 1;
  const stratus_kernel_argument find[] = { ARGUMENT(b[BUFFER_SIDES]), ARGUMENT(d->stride), ARGUMENT(b[BUFFER_STATE]), ARGUMENT(d->slot),
    ARGUMENT(d->find_chunk), ARGUMENT(b[BUFFER_NEAREST]) };
  const stratus_kernel_argument count[] = { ARGUMENT(b[BUFFER_STATE]), ARGUMENT(d->slot), ARGUMENT(d->chunk), ARGUMENT(b[BUFFER_NEAREST]),
    ARGUMENT(b[BUFFER_SUMS]) };
  const stratus_kernel_argument sum[] = { ARGUMENT(b[BUFFER_STATE]), ARGUMENT(d->slot), ARGUMENT(d->chunk), ARGUMENT(b[BUFFER_SUMS]) };
  const stratus_kernel_argument merge[] = { ARGUMENT(b[BUFFER_SIDES]), ARGUMENT(b[BUFFER_CHILD]), ARGUMENT(d->stride),
    ARGUMENT(b[BUFFER_STATE]), ARGUMENT(d->slot), ARGUMENT(d->chunk), ARGUMENT(b[BUFFER_NEAREST]), ARGUMENT(b[BUFFER_SUMS]),
    ARGUMENT(b[BUFFER_SIDES_NEXT]), ARGUMENT(b[BUFFER_CHILD_NEXT]), ARGUMENT(b[BUFFER_PAIRS]) };
  TRY(launch(d, "find", find, COUNT_OF(find), (d->count - 1) / d->find_chunk + 1));
  TRY(launch(d, "count", count, COUNT_OF(count), chunks));
  TRY(launch(d, "sum", sum, COUNT_OF(sum), 1));
  TRY(launch(d, "merge", merge, COUNT_OF(merge), chunks));
  swap_clusters(d);
  d->slot = 1 - d->slot;
  return STRATUS_OK;
}

static stratus_status finish(const ploc_device* d)
{
  const cl_mem* b = d->buffers;
  const stratus_kernel_argument arguments[] = { ARGUMENT(b[BUFFER_SIDES]), ARGUMENT(b[BUFFER_CHILD]), ARGUMENT(d->stride),
    ARGUMENT(b[BUFFER_STATE]), ARGUMENT(d->slot), ARGUMENT(b[BUFFER_NEAREST]), ARGUMENT(b[BUFFER_SIDES_NEXT]),
    ARGUMENT(b[BUFFER_CHILD_NEXT]), ARGUMENT(b[BUFFER_PAIRS]) };
  return launch(d, "finish", arguments, COUNT_OF(arguments), 1);
}

stratus_status stratus_device_ploc(stratus_context* context, const stratus_box* boxes, uint32_t count, stratus_bvh_pair* pairs)
{
  stratus_status status = STRATUS_OK;
  const bool processor = stratus_device_is_cpu(context->device);
  const cl_uint last = processor ? CPU_LAST : GPU_LAST;
  ploc_device d = { .context = context,
    .count = count,
    .stride = (cl_ulong)count + 3 * PADDING, /* the last vector may begin at the last cluster */
    .chunk = processor ? CPU_CHUNK : GPU_CHUNK,
    .find_chunk = processor ? CPU_CHUNK : STRATUS_DEVICE_GROUP,
    .group = processor ? 1 : STRATUS_DEVICE_GROUP };
  snprintf(d.defines, sizeof d.defines, "-DGROUP=%zu", d.group);
  TRY_CLEANUP(make_buffers(&d, boxes));
  TRY_CLEANUP(start(&d));
  while (d.count > last) {
    for (int round = 0; round < ROUNDS_AT_ONCE && (round == 0 || d.count >> round > last); ++round) {
      TRY_CLEANUP(run_round(&d));
    }
    TRY_CLEANUP(stratus_device_read(context, d.buffers[BUFFER_STATE], 2 * (size_t)d.slot * sizeof(cl_uint), sizeof d.count, &d.count));
  }
  TRY_CLEANUP(finish(&d));
  TRY_CLEANUP(stratus_device_read(context, d.buffers[BUFFER_PAIRS], 0, (size_t)(count - 1) * sizeof *pairs, pairs));
cleanup:
  for (int b = 0; b < BUFFERS; ++b) {
    stratus_device_buffer_release(d.buffers[b]);
  }
  return status;
}
