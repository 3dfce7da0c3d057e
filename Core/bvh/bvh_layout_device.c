/* SPDX-License-Identifier: BSD-3-Clause
 * The layout of a hierarchy on the context's OpenCL device: buffers for the kernels in bvh_layout.cl, and their launches. Pairs are sorted
 * by depth; then subtrees are computed level by level from the deepest up, and nodes from the root down. */
#include "bvh_build.h"
#include "radix_sort_device.h"

#include <stdio.h>
#include <string.h>

/* As in bvh_layout.cl. */
#define NO_LEVEL UINT32_MAX
#define TOO_DEEP 255
#define DEPTH_BITS 8
#define CLIMBS 7 /* doubling reaches 2^7 levels */

#define GPU_CHUNK STRATUS_DEVICE_GROUP
#define CPU_CHUNK 1024
#define SMALL_CHUNKS 4 /* neighbouring levels of no more chunks are left to one group in one launch */

typedef struct subtree {
  double cost;
  int32_t lo[3], hi[3];
  uint32_t boxes, nodes, height;
  uint32_t unused;
} subtree;

enum {
  BUFFER_PAIRS,
  BUFFER_BOXES,
  BUFFER_NUMBER,
  BUFFER_LINKS,
  BUFFER_LINKS_NEXT,
  BUFFER_BEGIN,
  BUFFER_SUBTREES,
  BUFFER_PLACES,
  BUFFER_NODES,
  BUFFER_ORDER,
  BUFFERS
};

typedef struct layout_device {
  const stratus_bvh_build* build;
  stratus_context* context;
  cl_mem buffers[BUFFERS];
  stratus_device_keys keys; /* depths, with the pairs as values */
  cl_uint pairs, root, leaf_boxes, chunk;
  uint32_t begin[TOO_DEEP + 2]; /* first place of each level among the sorted pairs */
  uint32_t levels;
  size_t group;
  char defines[48];
} layout_device;

bool stratus_device_takes_layout(const stratus_context* context, uint32_t count)
{
  return stratus_device_builds(context) && count > 1 && stratus_device_has_double(context->device) &&
    count <= stratus_device_largest_allocation(context->device) / (2 * sizeof(stratus_tree_node));
}

static stratus_status make_buffers(layout_device* d)
{
  const size_t pairs = d->pairs, boxes = d->build->count;
  const struct {
    const void* host;
    size_t bytes;
  } made[] = { [BUFFER_PAIRS] = { d->build->pairs, pairs * sizeof(stratus_bvh_pair) },
    [BUFFER_BOXES] = { d->build->boxes, boxes * sizeof(stratus_box) },
    [BUFFER_NUMBER] = { d->build->number, boxes * sizeof(uint32_t) },
    [BUFFER_LINKS] = { NULL, pairs * sizeof(cl_uint2) },
    [BUFFER_LINKS_NEXT] = { NULL, pairs * sizeof(cl_uint2) },
    [BUFFER_BEGIN] = { NULL, sizeof d->begin },
    [BUFFER_SUBTREES] = { NULL, pairs * sizeof(subtree) },
    [BUFFER_PLACES] = { NULL, pairs * sizeof(cl_uint4) } };
  for (size_t b = 0; b < COUNT_OF(made); ++b) {
    const cl_mem_flags access = made[b].host ? CL_MEM_READ_ONLY : CL_MEM_READ_WRITE;
    TRY(stratus_device_buffer(d->context, access, made[b].bytes, made[b].host, made[b].host != NULL, &d->buffers[b]));
  }
  return stratus_device_keys_create(d->context, d->pairs, &d->keys);
}

static stratus_status launch_pairs(const layout_device* d, const char* name, const stratus_kernel_argument* arguments, size_t count)
{
  return stratus_device_launch(d->context, "bvh_layout", d->defines, name, arguments, count, (const int64_t[]){ d->pairs, 1, 1 });
}

/* Sorts pairs by depth. Sets levels to 0 where one is too deep. */
static stratus_status sort_by_depth(layout_device* d)
{
  cl_mem* b = d->buffers;
  const stratus_kernel_argument parents[] = { ARGUMENT(b[BUFFER_PAIRS]), ARGUMENT(d->pairs), ARGUMENT(d->root), ARGUMENT(b[BUFFER_LINKS]) };
  memset(d->begin, 0xff, sizeof d->begin);
  TRY(stratus_device_write(d->context, b[BUFFER_BEGIN], 0, sizeof d->begin, d->begin));
  TRY(launch_pairs(d, "parents", parents, COUNT_OF(parents)));
  for (int i = 0; i < CLIMBS; ++i) {
    const stratus_kernel_argument climb[] = { ARGUMENT(b[BUFFER_LINKS]), ARGUMENT(d->pairs), ARGUMENT(b[BUFFER_LINKS_NEXT]) };
    TRY(launch_pairs(d, "climb", climb, COUNT_OF(climb)));
    const cl_mem swap = b[BUFFER_LINKS];
    b[BUFFER_LINKS] = b[BUFFER_LINKS_NEXT];
    b[BUFFER_LINKS_NEXT] = swap;
  }
  const stratus_kernel_argument depths[] = { ARGUMENT(b[BUFFER_LINKS]), ARGUMENT(d->pairs), ARGUMENT(d->root), ARGUMENT(d->keys.keys[0]),
    ARGUMENT(d->keys.values[0]) };
  TRY(launch_pairs(d, "depths", depths, COUNT_OF(depths)));
  TRY(stratus_device_keys_sort(d->context, &d->keys, DEPTH_BITS));
  const stratus_kernel_argument levels[] = { ARGUMENT(d->keys.keys[0]), ARGUMENT(d->pairs), ARGUMENT(b[BUFFER_BEGIN]) };
  TRY(launch_pairs(d, "levels", levels, COUNT_OF(levels)));
  TRY(stratus_device_read(d->context, b[BUFFER_BEGIN], 0, sizeof d->begin, d->begin));
  d->levels = 0;
  while (d->begin[TOO_DEEP] == NO_LEVEL && d->begin[d->levels] != NO_LEVEL) {
    ++d->levels;
  }
  return STRATUS_OK;
}

static uint32_t chunks_of(const layout_device* d, uint32_t level)
{
  const uint32_t end = level + 1 < d->levels ? d->begin[level + 1] : d->pairs;
  return (end - d->begin[level] - 1) / d->chunk + 1;
}

/* Returns the last level, in steps of 1 or -1, that can share a launch with level `first`. */
static uint32_t last_shared(const layout_device* d, uint32_t first, int step)
{
  uint32_t last = first;
  while (chunks_of(d, last) <= SMALL_CHUNKS && (step > 0 ? last + 1 < d->levels : last > 0) &&
    chunks_of(d, last + (uint32_t)step) <= SMALL_CHUNKS) {
    last += (uint32_t)step;
  }
  return last;
}

static stratus_status launch_levels(
  const layout_device* d, const char* name, cl_uint first, cl_uint last, const stratus_kernel_argument* more, size_t count)
{
  const cl_uint chunk = first == last ? d->chunk : d->pairs;
  stratus_kernel_argument arguments[16] = { ARGUMENT(d->keys.values[0]), ARGUMENT(d->buffers[BUFFER_BEGIN]), ARGUMENT(first),
    ARGUMENT(last), ARGUMENT(d->pairs), ARGUMENT(chunk), ARGUMENT(d->buffers[BUFFER_PAIRS]), ARGUMENT(d->buffers[BUFFER_BOXES]) };
  memcpy(arguments + 8, more, count * sizeof *more);
  return stratus_device_launch_groups(
    d->context, "bvh_layout", d->defines, name, arguments, 8 + count, first == last ? chunks_of(d, first) : 1, d->group);
}

static stratus_status combine_levels(const layout_device* d)
{
  const stratus_kernel_argument more[] = { ARGUMENT(d->leaf_boxes), ARGUMENT(d->buffers[BUFFER_SUBTREES]) };
  for (uint32_t end = d->levels; end > 0;) {
    const uint32_t last = last_shared(d, end - 1, -1);
    TRY(launch_levels(d, "combine", end - 1, last, more, COUNT_OF(more)));
    end = last;
  }
  return STRATUS_OK;
}

static stratus_status place_levels(const layout_device* d)
{
  const cl_mem* b = d->buffers;
  const stratus_kernel_argument more[] = { ARGUMENT(b[BUFFER_SUBTREES]), ARGUMENT(b[BUFFER_NUMBER]), ARGUMENT(b[BUFFER_PLACES]),
    ARGUMENT(b[BUFFER_NODES]), ARGUMENT(b[BUFFER_ORDER]) };
  const cl_uint root[4] = { 0, 1, 0, 0 };
  TRY(stratus_device_write(d->context, b[BUFFER_PLACES], d->root * sizeof root, sizeof root, root));
  for (uint32_t level = 0; level < d->levels;) {
    const uint32_t last = last_shared(d, level, 1);
    TRY(launch_levels(d, "place", level, last, more, COUNT_OF(more)));
    level = last + 1;
  }
  return STRATUS_OK;
}

static stratus_status read_nodes(layout_device* d, uint32_t node_count, stratus_bvh* bvh)
{
  stratus_status status = STRATUS_OK;
  stratus_context* context = d->context;
  const size_t node_bytes = node_count * sizeof(stratus_tree_node), order_bytes = d->build->count * sizeof(uint32_t);
  void *nodes = NULL, *order = NULL;
  TRY_CLEANUP(stratus_device_buffer(context, CL_MEM_WRITE_ONLY, node_bytes, NULL, false, &d->buffers[BUFFER_NODES]));
  TRY_CLEANUP(stratus_device_buffer(context, CL_MEM_WRITE_ONLY, order_bytes, NULL, false, &d->buffers[BUFFER_ORDER]));
  TRY_CLEANUP(place_levels(d));
  TRY_CLEANUP(stratus_allocate(context, node_count, sizeof(stratus_tree_node), &nodes));
  TRY_CLEANUP(stratus_allocate(context, d->build->count, sizeof(uint32_t), &order));
  TRY_CLEANUP(stratus_device_read(context, d->buffers[BUFFER_NODES], 0, node_bytes, nodes));
  TRY_CLEANUP(stratus_device_read(context, d->buffers[BUFFER_ORDER], 0, order_bytes, order));
  *bvh = (stratus_bvh){ .nodes = nodes, .node_count = node_count, .order = order };
  return STRATUS_OK;

cleanup:
  stratus_release(context, nodes);
  stratus_release(context, order);
  return status;
}

stratus_status stratus_device_layout(const stratus_bvh_build* build, int leaf_boxes, stratus_bvh* bvh, bool* done)
{
  stratus_status status = STRATUS_OK;
  stratus_context* context = build->context;
  const bool processor = stratus_device_is_cpu(context->device);
  layout_device d = { .build = build,
    .context = context,
    .pairs = build->count - 1,
    .root = build->root,
    .leaf_boxes = (cl_uint)leaf_boxes,
    .chunk = processor ? CPU_CHUNK : GPU_CHUNK,
    .group = processor ? 1 : STRATUS_DEVICE_GROUP };
  subtree root;
  _Static_assert(sizeof(subtree) == 48 && sizeof(stratus_tree_node) == 32, "the kernels have the same structs");
  _Static_assert(STRATUS_NODE_INNER == 0 && STRATUS_NODE_BRICKS == 1, "the kernels have the same kinds of nodes");
  *done = false;
  snprintf(d.defines, sizeof d.defines, "-DGROUP=%zu", d.group);
  TRY_CLEANUP(make_buffers(&d));
  TRY_CLEANUP(sort_by_depth(&d));
  if (d.levels > 0) {
    TRY_CLEANUP(combine_levels(&d));
    TRY_CLEANUP(stratus_device_read(context, d.buffers[BUFFER_SUBTREES], d.root * sizeof root, sizeof root, &root));
    if (root.height <= (uint32_t)build->max_depth) {
      TRY_CLEANUP(read_nodes(&d, root.nodes, bvh));
      *done = true;
    }
  }
cleanup:
  for (int b = 0; b < BUFFERS; ++b) {
    stratus_device_buffer_release(d.buffers[b]);
  }
  stratus_device_keys_release(&d.keys);
  return status;
}
