/* SPDX-License-Identifier: BSD-3-Clause
 * First hits on the context's device. The host prepares rays and computes hits chunk by chunk, the device walks. The tree is copied with
 * each batch; a device that shares memory with the host reads it in place. */
#include "first_hit_batch.h"

#include "device_frame.h"

#include <stdio.h>
#include <string.h>

#define CHUNKS 512 /* per launch: each one costs as much as many chunks, for threads of the host and of a processor's OpenCL take turns */
#define GROUP 64   /* work items per group, one ray each */

/* The kernel gets the arguments' size by a define and asserts it, too. */
_Static_assert(_Alignof(stratus_hit_arguments) == sizeof(float), "arguments must be scalars of four bytes");

typedef enum buffer_name { ARGUMENTS, ENTRIES, ROWS, MASKS, NODES, FIELDS, BRICKS, RAYS, RESULTS, BUFFERS } buffer_name;

typedef struct launch {
  stratus_context* context;
  const stratus_hit_batch* batch;
  const stratus_hit_functions* functions;
  stratus_hit_arguments arguments;
  cl_kernel kernel;
  bool packets;
  stratus_device_slot slots[BUFFERS];
  const buffer_name* names; /* of the kernel's parameters */
  unsigned parameters;
  stratus_hit_chunk* chunks;
  int32_t *input, *output; /* of a launch; a device that shares memory with the host works in them */
} launch;

/* Copy the arrays of chunk c to their place in the arrays of `count` rays. */
static void pack_chunk(const launch* l, int c, int count)
{
  const stratus_hit_chunk* chunk = &l->chunks[c];
  const size_t bytes = (size_t)chunk->count * 4, first = (size_t)c * STRATUS_HIT_CHUNK, n = (size_t)count;
  int32_t* const words = l->input + first;
  for (size_t a = 0; a < 3; ++a) {
    memcpy(words + a * n, chunk->o[a], bytes);
    memcpy(words + (3 + a) * n, chunk->d[a], bytes);
    memcpy(words + (6 + a) * n, chunk->inverse[a], bytes);
    memcpy(words + (10 + a) * n, chunk->cell[a], bytes);
  }
  memcpy(words + 9 * n, chunk->end, bytes);
}

static void unpack_chunk(const launch* l, int c, int count)
{
  stratus_hit_chunk* chunk = &l->chunks[c];
  const size_t bytes = (size_t)chunk->count * 4, first = (size_t)c * STRATUS_HIT_CHUNK, n = (size_t)count;
  const int32_t* const words = l->output + first;
  memcpy(chunk->state, words, bytes);
  for (size_t a = 0; a < 3; ++a) {
    memcpy(chunk->cell[a], words + (1 + a) * n, bytes);
  }
  memcpy(chunk->visited, words + 4 * n, bytes);
}

static stratus_status walk(launch* l, const stratus_ray* rays, int count, stratus_hit* hits, int* bad)
{
  const int chunks = (count + STRATUS_HIT_CHUNK - 1) / STRATUS_HIT_CHUNK;
  int worst = count;
#pragma omp parallel for schedule(dynamic, 1) num_threads(l->context->threads) reduction(min : worst)
  for (int c = 0; c < chunks; ++c) {
    const int first = c * STRATUS_HIT_CHUNK, left = count - first;
    int wrong = 0;
    if (l->functions->prepare(l->batch, rays + first, left < STRATUS_HIT_CHUNK ? left : STRATUS_HIT_CHUNK, &l->chunks[c], &wrong)) {
      pack_chunk(l, c, count);
    } else {
      worst = first + wrong < worst ? first + wrong : worst;
    }
  }
  *bad = worst < count ? worst : -1;
  if (*bad >= 0) {
    return STRATUS_OK;
  }
  l->arguments.count = count;
  TRY(stratus_slot_send(l->context, l->slots + ARGUMENTS, CL_MEM_READ_ONLY, &l->arguments, sizeof l->arguments));
  TRY(stratus_slot_send(l->context, l->slots + RAYS, CL_MEM_READ_ONLY, l->input, (size_t)count * 13 * 4));
  TRY(stratus_slot_lend(l->context, l->slots + RESULTS, CL_MEM_WRITE_ONLY, l->output, (size_t)count * 5 * 4));
  for (unsigned p = 0; p < l->parameters; ++p) {
    TRY(stratus_device_argument(l->context, l->kernel, p, sizeof(cl_mem), &l->slots[l->names[p]].memory));
  }
  const bool packets = l->packets && !l->batch->tree->wide.node_count;
  const size_t items = packets ? ((size_t)count + 15) / 16 : (size_t)count, local = packets ? 4 : GROUP;
  TRY(stratus_device_run(l->context, l->kernel, 1, &items, &local));
  TRY(stratus_slot_receive(l->context, l->slots + RESULTS, l->output, (size_t)count * 5 * 4));
#pragma omp parallel for schedule(dynamic, 1) num_threads(l->context->threads)
  for (int c = 0; c < chunks; ++c) {
    unpack_chunk(l, c, count);
    l->functions->finish(l->batch, rays + (size_t)c * STRATUS_HIT_CHUNK, &l->chunks[c], hits + (size_t)c * STRATUS_HIT_CHUNK);
  }
  return STRATUS_OK;
}

/* Makes a buffer of an array of the tree; of an empty one a few bytes, which are never read. */
static stratus_status make_table(launch* l, buffer_name name, size_t bytes, const void* table)
{
  return stratus_slot_keep(l->context, l->slots + name, bytes ? table : NULL, bytes);
}

static stratus_status make_tables(launch* l)
{
  const stratus_tree* tree = l->batch->tree;
  const bool leaves = l->batch->leaves;
  TRY(make_table(l, BRICKS, (size_t)tree->brick_count * sizeof *tree->bricks, tree->bricks));
  if (tree->wide.node_count) {
    return make_table(l, NODES, tree->wide.node_count * sizeof *tree->wide.nodes, tree->wide.nodes);
  }
  TRY(make_table(l, ENTRIES, tree->entry_count ? (size_t)tree->entry_count * (size_t)tree->entry_bytes + 4 : 0, tree->entries));
  TRY(make_table(l, ROWS, (size_t)tree->row_count * sizeof *tree->rows, tree->rows));
  TRY(make_table(l, MASKS, (size_t)tree->mask_count * sizeof *tree->masks, tree->masks));
  TRY(make_table(l, NODES, leaves ? (size_t)tree->node_count * sizeof *tree->nodes : 0, tree->nodes));
  return make_table(l, FIELDS, leaves ? (size_t)tree->field_count * sizeof *tree->fields : 0, tree->fields);
}

static stratus_status begin(launch* l, size_t most)
{
  static const buffer_name of_fields[] = { ARGUMENTS, ENTRIES, ROWS, MASKS, NODES, FIELDS, BRICKS, RAYS, RESULTS };
  static const buffer_name of_wide[] = { ARGUMENTS, NODES, BRICKS, RAYS, RESULTS };
  const stratus_tree* tree = l->batch->tree;
  const bool wide = tree->wide.node_count > 0;
  char defines[224];
  void* memory;
  l->packets = stratus_device_is_cpu(l->context->device);
  l->arguments = stratus_hit_arguments_of(l->batch);
  l->names = wide ? of_wide : of_fields;
  l->parameters = wide ? sizeof of_wide / sizeof *of_wide : sizeof of_fields / sizeof *of_fields;
  const int used = snprintf(defines, sizeof defines, "-DSTRATUS_DEVICE=1 -DSTRATUS_WIDTH=%d -DSTRATUS_ARGUMENTS_BYTES=%zu",
    l->packets ? 16 : 1, sizeof(stratus_hit_arguments));
  if (!wide) {
    snprintf(defines + used, sizeof defines - (size_t)used,
      " -DSTRATUS_LEAVES=%d -DSTRATUS_OCTANTS=%d -DSTRATUS_ENTRY_BYTES=%d -DSTRATUS_CELL_LOG2=%d", l->batch->leaves, tree->octants,
      tree->entry_bytes, tree->cell_log2);
  }
  const char* const name = wide ? "first_hit_wide" : "first_hit";
  TRY(stratus_device_kernel(l->context, name, defines, name, &l->kernel));
  TRY(stratus_allocate(l->context, (most + STRATUS_HIT_CHUNK - 1) / STRATUS_HIT_CHUNK, sizeof *l->chunks, &memory));
  l->chunks = memory;
  TRY(stratus_allocate(l->context, most, 13 * 4, &memory));
  l->input = memory;
  TRY(stratus_allocate(l->context, most, 5 * 4, &memory));
  l->output = memory;
  return make_tables(l);
}

stratus_status stratus_first_hit_device(
  stratus_context* context, const stratus_tree* tree, const stratus_ray* rays, size_t count, stratus_hit* hits)
{
  const size_t most = count < CHUNKS * STRATUS_HIT_CHUNK ? count : CHUNKS * STRATUS_HIT_CHUNK;
  stratus_hit_batch batch;
  stratus_hit_batch_begin(tree, &batch);
  launch l = { .context = context, .batch = &batch, .functions = stratus_hit_functions_for(context) };
  stratus_status status = begin(&l, most);
  for (size_t first = 0; status == STRATUS_OK && first < count; first += most) {
    int bad = -1;
    status = walk(&l, rays + first, count - first < most ? (int)(count - first) : (int)most, hits + first, &bad);
    if (status == STRATUS_OK && bad >= 0) {
      status = stratus_ray_refuse(context, batch.to_voxels, rays + first + bad, first + (size_t)bad);
    }
  }
  stratus_device_drain(context);
  for (int b = 0; b < BUFFERS; ++b) {
    stratus_slot_drop(l.slots + b);
  }
  stratus_release(context, l.input);
  stratus_release(context, l.output);
  stratus_release(context, l.chunks);
  return status;
}
