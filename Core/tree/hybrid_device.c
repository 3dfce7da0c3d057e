/* SPDX-License-Identifier: BSD-3-Clause
 * Sums of the hybrid tree's builder on the context's OpenCL device: the sums of hybrid_host.c, one launch for all nodes of a batch. Bricks
 * and their order stay on the device while the tree grows. Only the sums are copied back. */
#include "device_frame.h"
#include "hybrid_tree.h"

#include <stdio.h>
#include <string.h>

#define WHOLE 9007199254740992.0 /* 2^53: below it doubles, in which the host adds, are whole numbers */
/* Bricks that a work-group takes. On a processor a group is a single item. */
#define GROUP 64
#define GROUP_CHUNK 512
#define ITEM_CHUNK 4096

typedef struct hybrid_device {
  bool processor;
  cl_mem bricks, order, divided;
  cl_mem densities, start;
  const stratus_density* density; /* whose numbers the two buffers above hold */
  stratus_device_slot slots, chunks, peaks, sums;
  stratus_hybrid_slot* slot; /* of a batch's nodes */
  size_t slot_max;
  stratus_hybrid_chunk* chunk;
  size_t chunk_max, chunk_count;
} hybrid_device;

/* The kernels get the sizes by defines and assert them, too. */
_Static_assert(_Alignof(stratus_hybrid_slot) == sizeof(int) && _Alignof(stratus_hybrid_chunk) == sizeof(int), "scalars of four bytes");

static double longest_extent(const stratus_voxels* voxels)
{
  int64_t longest = 0;
  for (int a = 0; a < 3; ++a) {
    longest = voxels->hi[a] - voxels->lo[a] > longest ? voxels->hi[a] - voxels->lo[a] : longest;
  }
  return (double)longest;
}

bool stratus_hybrid_on_device(const hybrid_build* build)
{
  const stratus_context* context = build->context;
  const double voxels = (double)build->voxels->count, extent = longest_extent(build->voxels);
  return stratus_device_builds(context) && voxels <= (double)UINT32_MAX && voxels * extent * extent < WHOLE &&
    build->voxels->brick_count <= INT32_MAX &&
    (size_t)build->voxels->brick_count <= stratus_device_largest_allocation(context->device) / sizeof(stratus_brick);
}

/* ---------------------------------------------------------------- memory */

static stratus_status make_buffer(stratus_context* context, size_t bytes, cl_mem* buffer)
{
  return stratus_device_buffer(context, CL_MEM_READ_WRITE, bytes, NULL, false, buffer);
}

static stratus_status reserve(stratus_context* context, stratus_device_slot* slot, size_t bytes)
{
  return stratus_slot_reserve(context, slot, CL_MEM_READ_WRITE, bytes);
}

static stratus_status reserve_host(stratus_context* context, void** array, size_t* capacity, size_t count, size_t size)
{
  void* memory;
  if (count <= *capacity) {
    return STRATUS_OK;
  }
  count = count < 2 * *capacity ? 2 * *capacity : count;
  TRY(stratus_allocate(context, count, size, &memory));
  stratus_release(context, *array);
  *array = memory;
  *capacity = count;
  return STRATUS_OK;
}

stratus_status stratus_hybrid_device_create(hybrid_build* build)
{
  stratus_context* context = build->context;
  const size_t count = (size_t)build->voxels->brick_count;
  void* memory;
  TRY(stratus_allocate_zero(context, 1, sizeof *build->device, &memory));
  hybrid_device* const d = build->device = memory;
  d->processor = stratus_device_is_cpu(context->device);
  TRY(stratus_device_buffer(context, CL_MEM_READ_ONLY, count * sizeof(stratus_brick), build->voxels->bricks, true, &d->bricks));
  TRY(make_buffer(context, count * sizeof(uint32_t), &d->order));
  TRY(make_buffer(context, count * sizeof(uint32_t), &d->divided));
  return stratus_device_write(context, d->order, 0, count * sizeof(uint32_t), build->shape->order);
}

void stratus_hybrid_device_destroy(hybrid_build* build)
{
  hybrid_device* const d = build->device;
  if (d) {
    const cl_mem buffers[] = { d->bricks, d->order, d->divided, d->densities, d->start, d->slots.memory, d->chunks.memory, d->peaks.memory,
      d->sums.memory };
    for (size_t i = 0; i < COUNT_OF(buffers); ++i) {
      stratus_device_buffer_release(buffers[i]);
    }
    stratus_release(build->context, d->slot);
    stratus_release(build->context, d->chunk);
    stratus_release(build->context, d);
    build->device = NULL;
  }
}

/* ---------------------------------------------------------------- launches */

/* Launches a kernel over groups of items. */
static stratus_status launch(
  const hybrid_build* build, const char* name, const stratus_kernel_argument* arguments, size_t count, size_t groups)
{
  const size_t local = build->device->processor ? 1 : GROUP;
  char defines[96];
  snprintf(defines, sizeof defines, "-DGROUP=%d -DSTRATUS_SLOT_BYTES=%zu -DSTRATUS_CHUNK_BYTES=%zu", (int)local,
    sizeof(stratus_hybrid_slot), sizeof(stratus_hybrid_chunk));
  return stratus_device_launch_groups(build->context, "hybrid_tree", defines, name, arguments, count, groups, local);
}

/* Launches a kernel that sets `count` numbers of the sums. */
static stratus_status clear(const hybrid_build* build, const char* name, size_t count, size_t numbers)
{
  const cl_ulong things = count;
  const stratus_kernel_argument arguments[] = { ARGUMENT(build->device->sums.memory), ARGUMENT(things) };
  return launch(build, name, arguments, COUNT_OF(arguments), build->device->processor ? numbers : (numbers + GROUP - 1) / GROUP);
}

static void describe(const hybrid_build* build, const hybrid_work* work, stratus_hybrid_slot* slot)
{
  const hybrid_node* node = &work->node;
  /* A squared distance is a whole number, and below the reach if it is below the next whole one. */
  const uint64_t reach = (uint64_t)fmin(ceil(4.0 * work->bandwidth * work->bandwidth), 9e18);
  *slot = (stratus_hybrid_slot){ .first = (int)node->first,
    .axis = work->axis,
    .at = (int)work->at,
    .whole = stratus_density_takes_whole_bricks(work->bandwidth, hybrid_exact(build)),
    .reach_low = (unsigned)reach,
    .reach_high = (unsigned)(reach >> 32) };
  memcpy(slot->lo, node->lo, sizeof slot->lo);
  memcpy(slot->hi, node->hi, sizeof slot->hi);
  memcpy(slot->from, work->lo, sizeof slot->from);
  memcpy(slot->to, work->hi, sizeof slot->to);
  memcpy(slot->peak, work->peak, sizeof slot->peak);
  memcpy(slot->plane, work->offered, sizeof slot->plane);
}

/* Cuts the nodes into chunks, and writes slots and chunks to the device. plane: the slots have the nodes' planes, not the offered ones. */
static stratus_status begin(const hybrid_build* build, hybrid_work* const* works, uint32_t count, bool plane)
{
  hybrid_device* const d = build->device;
  stratus_context* context = build->context;
  const uint32_t most = d->processor ? ITEM_CHUNK : GROUP_CHUNK;
  size_t chunks = 0;
  for (uint32_t w = 0; w < count; ++w) {
    chunks += (works[w]->node.count + most - 1) / most;
  }
  TRY(reserve_host(context, (void**)&d->slot, &d->slot_max, count, sizeof *d->slot));
  TRY(reserve_host(context, (void**)&d->chunk, &d->chunk_max, chunks, sizeof *d->chunk));
  d->chunk_count = 0;
  for (uint32_t w = 0; w < count; ++w) {
    const hybrid_node* node = &works[w]->node;
    describe(build, works[w], &d->slot[w]);
    if (plane) {
      d->slot[w].axis = works[w]->plane.axis;
      d->slot[w].plane[0] = works[w]->plane.brick;
    }
    for (uint32_t first = 0; first < node->count; first += most) {
      const uint32_t left = node->count - first;
      d->chunk[d->chunk_count++] =
        (stratus_hybrid_chunk){ .slot = (int)w, .first = (int)(node->first + first), .count = (int)(left < most ? left : most) };
    }
  }
  TRY(reserve(context, &d->slots, count * sizeof *d->slot));
  TRY(reserve(context, &d->chunks, chunks * sizeof *d->chunk));
  TRY(stratus_device_write(context, d->slots.memory, 0, count * sizeof *d->slot, d->slot));
  return stratus_device_write(context, d->chunks.memory, 0, chunks * sizeof *d->chunk, d->chunk);
}

/* Launches a kernel over the chunks whose arguments are bricks, order, slots, chunks and `result`. */
static stratus_status run(const hybrid_build* build, const char* name, cl_mem result)
{
  const hybrid_device* d = build->device;
  const stratus_kernel_argument arguments[] = { ARGUMENT(d->bricks), ARGUMENT(d->order), ARGUMENT(d->slots.memory),
    ARGUMENT(d->chunks.memory), ARGUMENT(result) };
  return launch(build, name, arguments, COUNT_OF(arguments), d->chunk_count);
}

static stratus_status order(hybrid_build* build, uint32_t first, uint32_t count)
{
  return stratus_device_read(
    build->context, build->device->order, first * sizeof(uint32_t), count * sizeof(uint32_t), build->shape->order + first);
}

/* ---------------------------------------------------------------- density */

/* Writes the density to the device, once for each. */
static stratus_status take_density(const hybrid_build* build)
{
  hybrid_device* const d = build->device;
  const stratus_density* density = build->density;
  stratus_context* context = build->context;
  stratus_device_buffer_release(d->densities);
  stratus_device_buffer_release(d->start);
  d->densities = d->start = NULL;
  const size_t bricks = (size_t)density->count, values = density->exact ? (size_t)density->start[bricks] : bricks;
  TRY(stratus_device_buffer(context, CL_MEM_READ_ONLY, values * sizeof(float), density->of, true, &d->densities));
  if (density->exact) {
    TRY(stratus_device_buffer(context, CL_MEM_READ_ONLY, (bricks + 1) * sizeof(int64_t), density->start, true, &d->start));
  }
  d->density = density;
  return STRATUS_OK;
}

static stratus_status find_peaks(const hybrid_build* build, bool own)
{
  const hybrid_device* d = build->device;
  const cl_int exact = build->density->exact, of_node = own;
  const cl_mem start = d->start ? d->start : d->densities;
  for (cl_int axis = 3; axis >= 0; --axis) {
    const stratus_kernel_argument arguments[] = { ARGUMENT(d->bricks), ARGUMENT(d->order), ARGUMENT(d->slots.memory),
      ARGUMENT(d->chunks.memory), ARGUMENT(d->densities), ARGUMENT(start), ARGUMENT(exact), ARGUMENT(of_node), ARGUMENT(axis),
      ARGUMENT(d->peaks.memory) };
    TRY(launch(build, "peaks", arguments, COUNT_OF(arguments), d->chunk_count));
  }
  return STRATUS_OK;
}

static stratus_status read_peaks(const hybrid_build* build, hybrid_work* const* works, uint32_t count, void* memory)
{
  const hybrid_device* d = build->device;
  uint32_t(*const peak)[4] = memory;
  int64_t(*const squares)[4] = memory;
  TRY(stratus_device_read(build->context, d->peaks.memory, 0, count * sizeof *peak, peak));
  for (uint32_t w = 0; w < count; ++w) {
    for (int a = 0; a < 3; ++a) {
      works[w]->peak[a] = (int32_t)peak[w][1 + a];
    }
  }
  TRY(stratus_device_read(build->context, d->sums.memory, 0, count * sizeof *squares, squares));
  for (uint32_t w = 0; w < count; ++w) {
    for (int a = 0; a < 3; ++a) {
      works[w]->squares[a] = (double)squares[w][a];
    }
    works[w]->voxels = squares[w][3];
  }
  return STRATUS_OK;
}

static stratus_status peaks(hybrid_build* build, hybrid_work* const* works, uint32_t count, bool own)
{
  hybrid_device* const d = build->device;
  stratus_context* context = build->context;
  stratus_status status = STRATUS_OK;
  void* memory;
  if (count == 0) {
    return STRATUS_OK;
  }
  if (own || d->density != build->density) {
    TRY(take_density(build));
  }
  TRY(begin(build, works, count, false));
  TRY(reserve(context, &d->peaks, (size_t)count * 4 * sizeof(uint32_t)));
  TRY(reserve(context, &d->sums, (size_t)count * 4 * sizeof(int64_t)));
  TRY(stratus_allocate(context, count, 4 * sizeof(int64_t), &memory));
  for (uint32_t w = 0; w < count; ++w) {
    memcpy((uint32_t*)memory + 4 * w, (const uint32_t[4]){ 0, UINT32_MAX, UINT32_MAX, UINT32_MAX }, 4 * sizeof(uint32_t));
  }
  TRY_CLEANUP(stratus_device_write(context, d->peaks.memory, 0, (size_t)count * 4 * sizeof(uint32_t), memory));
  TRY_CLEANUP(find_peaks(build, own));
  TRY_CLEANUP(clear(build, "clear", (size_t)count * 8, (size_t)count * 8));
  const stratus_kernel_argument squares[] = { ARGUMENT(d->bricks), ARGUMENT(d->order), ARGUMENT(d->chunks.memory),
    ARGUMENT(d->peaks.memory), ARGUMENT(d->sums.memory) };
  TRY_CLEANUP(launch(build, "squares", squares, COUNT_OF(squares), d->chunk_count));
  TRY_CLEANUP(read_peaks(build, works, count, memory));
cleanup:
  stratus_release(context, memory);
  return status;
}

/* Returns whether the sums of the lines are whole numbers in doubles, too. */
static bool lines_are_whole(const hybrid_build* build, const hybrid_work* work)
{
  const double extent = 2.0 * longest_extent(build->voxels), reach = 2.0 * work->bandwidth;
  const double along = fmin(reach, extent + 1.0), squared = fmin(reach * reach, 3.0 * (extent + 1.0) * (extent + 1.0));
  return (double)build->voxels->count * squared * fmax(along, 3.0) < WHOLE;
}

static stratus_status lines(hybrid_build* build, hybrid_work* const* works, uint32_t count, stratus_density_line* to, size_t size)
{
  hybrid_device* const d = build->device;
  bool whole = true;
  for (uint32_t w = 0; w < count; ++w) {
    whole = whole && lines_are_whole(build, works[w]);
  }
  for (uint32_t w = 0; w < count && !whole; ++w) {
    TRY(order(build, works[w]->node.first, works[w]->node.count));
  }
  if (!whole || count == 0) {
    return stratus_hybrid_sums_host.lines(build, works, count, to, size);
  }
  TRY(begin(build, works, count, false));
  TRY(reserve(build->context, &d->sums, size * sizeof *to));
  TRY(clear(build, "clear", size * 8, size * 8));
  TRY(run(build, "lines", d->sums.memory));
  TRY(stratus_device_read(build->context, d->sums.memory, 0, size * sizeof *to, to));
  for (size_t i = 0; i < size; ++i) {
    int64_t sums[4];
    memcpy(sums, &to[i], sizeof sums);
    to[i] = (stratus_density_line){ (double)sums[0], (double)sums[1], (double)sums[2], (double)sums[3] };
  }
  return STRATUS_OK;
}

static stratus_status histograms(hybrid_build* build, hybrid_work* const* works, uint32_t count, int64_t* counts, size_t size)
{
  hybrid_device* const d = build->device;
  if (count == 0) {
    return STRATUS_OK;
  }
  TRY(begin(build, works, count, false));
  TRY(reserve(build->context, &d->sums, size * sizeof(uint32_t)));
  TRY(clear(build, "clear", size, size));
  TRY(run(build, "histograms", d->sums.memory));
  TRY(stratus_device_read(build->context, d->sums.memory, 0, size * sizeof(uint32_t), counts));
  for (size_t i = size; i-- > 0;) { /* from the last on, so that none is overwritten before it is widened */
    uint32_t narrow;
    memcpy(&narrow, (const uint8_t*)counts + i * sizeof narrow, sizeof narrow);
    counts[i] = narrow;
  }
  return STRATUS_OK;
}

/* ---------------------------------------------------------------- surface area */

static stratus_status sides(hybrid_build* build, hybrid_work* const* works, uint32_t count)
{
  hybrid_device* const d = build->device;
  const size_t bins = (size_t)count * 4;
  stratus_status status = STRATUS_OK;
  void* memory;
  if (count == 0) {
    return STRATUS_OK;
  }
  TRY(begin(build, works, count, false));
  TRY(reserve(build->context, &d->sums, bins * sizeof(hybrid_bin)));
  TRY(clear(build, "clear_bins", bins, bins * sizeof(hybrid_bin) / sizeof(int32_t)));
  TRY(run(build, "sides", d->sums.memory));
  TRY(stratus_allocate(build->context, bins, sizeof(hybrid_bin), &memory));
  TRY_CLEANUP(stratus_device_read(build->context, d->sums.memory, 0, bins * sizeof(hybrid_bin), memory));
  for (uint32_t w = 0; w < count; ++w) {
    memcpy(works[w]->sides, (const hybrid_bin*)memory + 4 * w, sizeof works[w]->sides);
  }
cleanup:
  stratus_release(build->context, memory);
  return status;
}

static stratus_status bins(hybrid_build* build, hybrid_work* const* works, uint32_t count, hybrid_bin* to, size_t size)
{
  hybrid_device* const d = build->device;
  if (count == 0) {
    return STRATUS_OK;
  }
  TRY(begin(build, works, count, false));
  TRY(reserve(build->context, &d->sums, size * sizeof *to));
  TRY(clear(build, "clear_bins", size, size * sizeof *to / sizeof(int32_t)));
  TRY(run(build, "bins", d->sums.memory));
  return stratus_device_read(build->context, d->sums.memory, 0, size * sizeof *to, to);
}

/* ---------------------------------------------------------------- division */

/* A child's box, in bricks and in voxels. */
typedef struct child_box {
  int32_t bricks[2][3], voxels[2][3];
} child_box;

/* Counts the bricks below the planes, chunk by chunk, and gives every chunk its places in the new order. */
static stratus_status place_chunks(const hybrid_build* build, hybrid_work* const* works, uint32_t count, int32_t* below)
{
  hybrid_device* const d = build->device;
  stratus_context* context = build->context;
  TRY(run(build, "count_below", d->sums.memory));
  TRY(stratus_device_read(context, d->sums.memory, 0, d->chunk_count * sizeof *below, below));
  for (uint32_t w = 0; w < count; ++w) {
    works[w]->child[0] = (hybrid_node){ .first = works[w]->node.first };
  }
  for (size_t c = 0; c < d->chunk_count; ++c) {
    works[d->chunk[c].slot]->child[0].count += (uint32_t)below[c];
  }
  size_t c = 0;
  for (uint32_t w = 0; w < count; ++w) {
    hybrid_work* const work = works[w];
    int32_t low = (int32_t)work->node.first, high = low + (int32_t)work->child[0].count;
    work->child[1] = (hybrid_node){ .first = (uint32_t)high, .count = work->node.count - work->child[0].count };
    for (; c < d->chunk_count && d->chunk[c].slot == (int)w; ++c) {
      d->chunk[c].below = low;
      d->chunk[c].above = high;
      low += below[c];
      high += d->chunk[c].count - below[c];
    }
  }
  return stratus_device_write(context, d->chunks.memory, 0, d->chunk_count * sizeof *d->chunk, d->chunk);
}

static stratus_status divide(hybrid_build* build, hybrid_work* const* works, uint32_t count)
{
  hybrid_device* const d = build->device;
  stratus_context* context = build->context;
  stratus_status status = STRATUS_OK;
  void* memory;
  if (count == 0) {
    return STRATUS_OK;
  }
  TRY(begin(build, works, count, true));
  const size_t box_bytes = (size_t)count * 2 * sizeof(child_box), below_bytes = d->chunk_count * sizeof(int32_t);
  const size_t bytes = box_bytes > below_bytes ? box_bytes : below_bytes;
  TRY(reserve(context, &d->sums, bytes));
  TRY(stratus_allocate(context, bytes, 1, &memory));
  TRY_CLEANUP(place_chunks(build, works, count, memory));
  TRY_CLEANUP(clear(build, "clear_boxes", count, box_bytes / sizeof(int32_t)));
  const stratus_kernel_argument all[] = { ARGUMENT(d->bricks), ARGUMENT(d->order), ARGUMENT(d->slots.memory), ARGUMENT(d->chunks.memory),
    ARGUMENT(d->divided), ARGUMENT(d->sums.memory) };
  TRY_CLEANUP(launch(build, "divide", all, COUNT_OF(all), d->chunk_count));
  const stratus_kernel_argument kept[] = { ARGUMENT(d->divided), ARGUMENT(d->chunks.memory), ARGUMENT(d->order) };
  TRY_CLEANUP(launch(build, "keep", kept, COUNT_OF(kept), d->chunk_count));
  TRY_CLEANUP(stratus_device_read(context, d->sums.memory, 0, box_bytes, memory));
  for (uint32_t w = 0; w < count; ++w) {
    for (int side = 0; side < 2; ++side) {
      const child_box* box = (const child_box*)memory + 2 * w + side;
      memcpy(works[w]->child[side].lo, box->bricks[0], sizeof works[w]->child[side].lo);
      memcpy(works[w]->child[side].hi, box->bricks[1], sizeof works[w]->child[side].hi);
      memcpy(works[w]->box[side].lo, box->voxels[0], sizeof works[w]->box[side].lo);
      memcpy(works[w]->box[side].hi, box->voxels[1], sizeof works[w]->box[side].hi);
    }
  }
cleanup:
  stratus_release(context, memory);
  return status;
}

const hybrid_sums stratus_hybrid_sums_device = { peaks, lines, histograms, sides, bins, divide, order };
