/* SPDX-License-Identifier: BSD-3-Clause
 * Peels all leaves in layers on the context's OpenCL device (Li et al. 2012, section 3.1): two launches a layer, and the host asks after
 * every few layers whether any was empty. A leaf with a ring comes back unfinished, and the host peels it. */
#include "radix_sort_device.h"
#include "visibility_order.h"

#include <stdio.h>
#include <string.h>

#define CELLS_MIN ((int64_t)1 << 14) /* the host has peeled fewer before a device could begin */
#define GPU_CHUNKS 256
#define CPU_CHUNKS 64
#define CHUNK_CELLS 128 /* a mesh with few cells gets fewer chunks */
#define LAYERS_AT_ONCE 32
#define BOUNDS_LAYERS 4
#define BOUNDS 5

struct stratus_device_layers {
  cl_mem neighbours, sides, state, list, positions, flags, counts, bounds;
};

typedef struct layers_device {
  const stratus_visibility_order* order;
  stratus_context* context;
  const stratus_device_layers* buffers;
  cl_uint cells;
  size_t group, chunks;
  char defines[48];
} layers_device;

bool stratus_order_layers_on_device(const stratus_visibility_order* order)
{
  const stratus_context* context = order->context;
  return stratus_device_builds(context) && order->cell_count >= CELLS_MIN &&
    (size_t)order->cell_count <= stratus_device_largest_allocation(context->device) / (4 * sizeof(int32_t));
}

void stratus_device_layers_destroy(stratus_context* context, stratus_device_layers* layers)
{
  if (layers) {
    const cl_mem buffers[] = { layers->neighbours, layers->sides, layers->state, layers->list, layers->positions, layers->flags,
      layers->counts, layers->bounds };
    for (size_t i = 0; i < COUNT_OF(buffers); ++i) {
      stratus_device_buffer_release(buffers[i]);
    }
    stratus_release(context, layers);
  }
}

static stratus_status make_buffers(stratus_visibility_order* order)
{
  stratus_context* context = order->context;
  const size_t cells = (size_t)order->cell_count;
  stratus_status status = STRATUS_OK;
  void* memory;
  TRY(stratus_allocate_zero(context, 1, sizeof(stratus_device_layers), &memory));
  stratus_device_layers* layers = memory;
  const struct {
    cl_mem* buffer;
    size_t bytes;
  } made[] = { { &layers->neighbours, 4 * cells * sizeof(int32_t) }, { &layers->sides, cells }, { &layers->state, cells },
    { &layers->list, cells * sizeof(uint32_t) }, { &layers->positions, cells * sizeof(uint32_t) }, { &layers->flags, cells },
    { &layers->counts, GPU_CHUNKS * sizeof(uint32_t) }, { &layers->bounds, BOUNDS * sizeof(uint32_t) } };
  for (size_t i = 0; i < COUNT_OF(made); ++i) {
    TRY_CLEANUP(stratus_device_buffer(context, CL_MEM_READ_WRITE, made[i].bytes, NULL, false, made[i].buffer));
  }
  TRY_CLEANUP(stratus_device_write(context, layers->neighbours, 0, 4 * cells * sizeof(int32_t), order->neighbours));
  TRY_CLEANUP(stratus_device_write(context, layers->sides, 0, cells, order->sides));
  order->device_layers = layers;
  layers = NULL;

cleanup:
  stratus_device_layers_destroy(context, layers);
  return status;
}

static stratus_status launch(const layers_device* d, const char* name, const stratus_kernel_argument* arguments, size_t count)
{
  return stratus_device_launch_groups(d->context, "visibility_layers", d->defines, name, arguments, count, d->chunks, d->group);
}

static stratus_status peel_layer(const layers_device* d, cl_int first, cl_int parity)
{
  const stratus_device_layers* b = d->buffers;
  const stratus_kernel_argument count[] = { ARGUMENT(b->neighbours), ARGUMENT(b->sides), ARGUMENT(b->state), ARGUMENT(d->cells),
    ARGUMENT(first), ARGUMENT(parity), ARGUMENT(b->bounds), ARGUMENT(b->list), ARGUMENT(b->positions), ARGUMENT(b->flags),
    ARGUMENT(b->counts) };
  const stratus_kernel_argument place[] = { ARGUMENT(b->neighbours), ARGUMENT(d->cells), ARGUMENT(first), ARGUMENT(parity),
    ARGUMENT(b->bounds), ARGUMENT(b->list), ARGUMENT(b->positions), ARGUMENT(b->flags), ARGUMENT(b->counts) };
  TRY(launch(d, "count", count, COUNT_OF(count)));
  return launch(d, "place", place, COUNT_OF(place));
}

/* Lists cells until a layer is empty. Sets how many are listed and in how many layers. */
static stratus_status peel(const layers_device* d, uint32_t* count, int* layers)
{
  static const uint32_t zeros[BOUNDS] = { 0 };
  const stratus_device_layers* b = d->buffers;
  const stratus_kernel_argument clear[] = { ARGUMENT(b->positions), ARGUMENT(d->cells) };
  uint32_t bounds[BOUNDS];
  TRY(stratus_device_write(d->context, b->state, 0, d->cells, d->order->state));
  TRY(stratus_device_write(d->context, b->bounds, 0, sizeof zeros, zeros));
  TRY(launch(d, "clear", clear, COUNT_OF(clear)));
  TRY(peel_layer(d, 1, 0));
  int parity = 1;
  do {
    for (int layer = 0; layer < LAYERS_AT_ONCE; ++layer, parity = 1 - parity) {
      TRY(peel_layer(d, 0, parity));
    }
    TRY(stratus_device_read(d->context, b->bounds, 0, sizeof bounds, bounds));
  } while (bounds[2 * parity] < bounds[2 * parity + 1]);
  *count = bounds[2 * parity + 1];
  *layers = (int)bounds[BOUNDS_LAYERS];
  return STRATUS_OK;
}

/* Brings the listed cells from layers of all leaves to each leaf's layers, leaves front to back. */
static stratus_status sort_by_leaf(const layers_device* d, uint32_t count, const uint32_t* begin_and_rank, uint32_t* cells)
{
  const stratus_visibility_order* order = d->order;
  stratus_context* context = d->context;
  const cl_uint leaves = (cl_uint)order->leaf_count;
  stratus_device_keys keys = { .count = 0 };
  cl_mem begin = NULL, rank = NULL;
  stratus_status status = STRATUS_OK;
  int bits = 1;
  while (leaves >> bits > 0) {
    ++bits;
  }
  TRY_CLEANUP(stratus_device_buffer(context, CL_MEM_READ_ONLY, leaves * sizeof(uint32_t), begin_and_rank, false, &begin));
  TRY_CLEANUP(stratus_device_buffer(context, CL_MEM_READ_ONLY, leaves * sizeof(uint32_t), begin_and_rank + leaves, false, &rank));
  TRY_CLEANUP(stratus_device_keys_create(context, count, &keys));
  const stratus_kernel_argument arguments[] = { ARGUMENT(d->buffers->list), ARGUMENT(count), ARGUMENT(begin), ARGUMENT(rank),
    ARGUMENT(leaves), ARGUMENT(keys.keys[0]), ARGUMENT(keys.values[0]) };
  TRY_CLEANUP(launch(d, "ranks", arguments, COUNT_OF(arguments)));
  TRY_CLEANUP(stratus_device_keys_sort(context, &keys, bits));
  TRY_CLEANUP(stratus_device_read(context, keys.values[0], 0, count * sizeof *cells, cells));
cleanup:
  stratus_device_keys_release(&keys);
  stratus_device_buffer_release(begin);
  stratus_device_buffer_release(rank);
  return status;
}

/* Copies the leaves that are complete to their places, and marks them. */
static void take_leaves(stratus_visibility_order* order, const uint32_t* cells, uint32_t count, uint8_t* peeled)
{
  int64_t at = 0;
  for (int32_t i = 0; i < order->leaf_count; ++i) {
    const int32_t leaf = order->leaf_order[i];
    const int64_t begin = order->leaf_begin[leaf], end = order->leaf_begin[leaf + 1], from = at;
    while (at < count && cells[at] >= begin && cells[at] < end) {
      ++at;
    }
    peeled[leaf] = at - from == end - begin;
    for (int64_t c = from; c < at && peeled[leaf]; ++c) {
      order->cells[order->leaf_output[leaf] + c - from] = stratus_order_cell(order, cells[c]);
    }
  }
}

stratus_status stratus_order_peel_layers_on_device(stratus_visibility_order* order, uint8_t* peeled, int* layers)
{
  stratus_context* context = order->context;
  stratus_status status = STRATUS_OK;
  void *cells = NULL, *leaves = NULL;
  uint32_t count = 0;
  if (!order->device_layers) {
    TRY(make_buffers(order));
  }
  layers_device d = { .order = order,
    .context = context,
    .buffers = order->device_layers,
    .cells = (cl_uint)order->cell_count,
    .group = 1,
    .chunks = CPU_CHUNKS };
  if (!stratus_device_is_cpu(context->device)) {
    d.group = STRATUS_DEVICE_GROUP;
    d.chunks = GPU_CHUNKS;
  }
  const size_t chunks = d.cells / CHUNK_CELLS + 1;
  d.chunks = chunks < d.chunks ? chunks : d.chunks;
  snprintf(d.defines, sizeof d.defines, "-DGROUP=%zu", d.group);
  TRY_CLEANUP(stratus_allocate(context, (size_t)order->leaf_count, 2 * sizeof(uint32_t), &leaves));
  TRY_CLEANUP(stratus_allocate(context, (size_t)order->cell_count, sizeof(uint32_t), &cells));
  uint32_t* const begin_and_rank = leaves;
  for (int32_t i = 0; i < order->leaf_count; ++i) {
    begin_and_rank[i] = (uint32_t)order->leaf_begin[i];
    begin_and_rank[order->leaf_count + order->leaf_order[i]] = (uint32_t)i;
  }
  TRY_CLEANUP(peel(&d, &count, layers));
  if (order->leaf_count > 1 && count > 0) {
    TRY_CLEANUP(sort_by_leaf(&d, count, begin_and_rank, cells));
  } else if (count > 0) {
    TRY_CLEANUP(stratus_device_read(context, d.buffers->list, 0, count * sizeof(uint32_t), cells));
  }
  take_leaves(order, cells, count, peeled);
cleanup:
  stratus_release(context, cells);
  stratus_release(context, leaves);
  return status;
}
