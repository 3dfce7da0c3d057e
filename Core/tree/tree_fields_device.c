/* SPDX-License-Identifier: BSD-3-Clause
 * Leaves of distance fields on the context's OpenCL device: buffers, arguments and launches of tree_fields.cl, all leaves at once. */
#include "device_frame.h"
#include "tree_arguments.h"
#include "tree_fields.h"

#include <stdio.h>
#include <string.h>

_Static_assert(_Alignof(stratus_leaf_arguments) == sizeof(int), "scalars of four bytes");

enum { ENTRIES, ROWS, MASKS };

typedef struct fields_device {
  stratus_context* context;
  stratus_tree* tree;
  cl_mem bricks, order, leaves, occupied, along_y, along_z;
  stratus_device_slot results[3]; /* ENTRIES, ROWS, MASKS */
  cl_uint leaf_count, words;
  char defines[64];
} fields_device;

static size_t words_of(const stratus_tree* tree)
{
  size_t words = 0;
  for (uint32_t f = 0; f < tree->field_count; ++f) {
    const int32_t* cells = tree->fields[f].cells;
    words += (size_t)(cells[0] + 31) / 32 * (size_t)cells[1] * (size_t)cells[2];
  }
  return words;
}

static size_t codes_of(const stratus_tree* tree)
{
  return ((size_t)1 << tree->entry_bytes) - 1;
}

bool stratus_tree_fields_on_device(const stratus_context* context, const stratus_voxels* voxels, const stratus_tree* tree)
{
  const size_t largest = context->device ? stratus_device_largest_allocation(context->device) : 0, bricks = (size_t)voxels->brick_count;
  return stratus_device_builds(context) && tree->octants && bricks <= largest / sizeof(stratus_brick) &&
    (size_t)tree->entry_count <= largest / (size_t)tree->entry_bytes && words_of(tree) <= largest / (4 * codes_of(tree) * sizeof(cl_uint));
}

/* Describes the leaves in the order of their fields. */
static void describe(const stratus_tree_shape* shape, const stratus_tree* tree, stratus_leaf_arguments* leaves)
{
  uint32_t f = 0, words = 0, masks = 0;
  for (uint32_t n = 0; n < shape->node_count; ++n) {
    const stratus_tree_node* node = &shape->nodes[n];
    if (stratus_tree_node_kind(node) == STRATUS_NODE_FIELD) {
      const stratus_tree_field* field = &tree->fields[f];
      stratus_leaf_arguments* leaf = &leaves[f++];
      *leaf = (stratus_leaf_arguments){ .words = (field->cells[0] + 31) / 32,
        .first_word = words,
        .first_entry = field->first_entry,
        .first_row = field->first_row,
        .first_mask = masks,
        .first = node->first };
      memcpy(leaf->at, field->at, sizeof leaf->at);
      memcpy(leaf->cells, field->cells, sizeof leaf->cells);
      words += (uint32_t)leaf->words * (uint32_t)field->cells[1] * (uint32_t)field->cells[2];
      masks += stratus_tree_node_count(node);
    }
  }
}

static stratus_status make_buffers(fields_device* d, const stratus_voxels* voxels, const stratus_tree_shape* shape)
{
  stratus_context* context = d->context;
  stratus_tree* tree = d->tree;
  const size_t bricks = (size_t)voxels->brick_count, grid = d->words * sizeof(cl_uint), codes = codes_of(tree);
  const cl_mem_flags both = CL_MEM_READ_WRITE;
  void* memory;
  TRY(stratus_allocate(context, d->leaf_count, sizeof(stratus_leaf_arguments), &memory));
  describe(shape, tree, memory);
  const stratus_status status =
    stratus_device_buffer(context, CL_MEM_READ_ONLY, d->leaf_count * sizeof(stratus_leaf_arguments), memory, false, &d->leaves);
  stratus_release(context, memory);
  TRY(status);
  TRY(stratus_device_buffer(context, CL_MEM_READ_ONLY, bricks * sizeof(stratus_brick), voxels->bricks, true, &d->bricks));
  TRY(stratus_device_buffer(context, CL_MEM_READ_ONLY, bricks * sizeof(uint32_t), shape->order, true, &d->order));
  TRY(stratus_device_buffer(context, both, grid, NULL, false, &d->occupied));
  TRY(stratus_device_buffer(context, both, 2 * codes * grid, NULL, false, &d->along_y));
  TRY(stratus_device_buffer(context, both, 4 * codes * grid, NULL, false, &d->along_z));
  TRY(stratus_slot_lend(context, &d->results[ENTRIES], both, tree->entries, (size_t)tree->entry_count * (size_t)tree->entry_bytes));
  TRY(stratus_slot_lend(context, &d->results[ROWS], both, tree->rows, tree->row_count * sizeof(uint32_t)));
  return stratus_slot_lend(context, &d->results[MASKS], both, tree->masks, tree->mask_count * sizeof(uint64_t));
}

static stratus_status launch(
  const fields_device* d, const char* kernel, const stratus_kernel_argument* arguments, size_t count, int64_t items, int64_t second)
{
  return stratus_device_launch(d->context, "tree_fields", d->defines, kernel, arguments, count, (const int64_t[]){ items, second, 1 });
}

static stratus_status fill_entries(const fields_device* d)
{
  const stratus_kernel_argument y[] = { ARGUMENT(d->leaves), ARGUMENT(d->leaf_count), ARGUMENT(d->words), ARGUMENT(d->occupied),
    ARGUMENT(d->along_y) };
  const stratus_kernel_argument z[] = { ARGUMENT(d->leaves), ARGUMENT(d->leaf_count), ARGUMENT(d->words), ARGUMENT(d->along_y),
    ARGUMENT(d->along_z) };
  const stratus_kernel_argument x[] = { ARGUMENT(d->leaves), ARGUMENT(d->leaf_count), ARGUMENT(d->words), ARGUMENT(d->occupied),
    ARGUMENT(d->along_z), ARGUMENT(d->results[ENTRIES].memory) };
  TRY(launch(d, "gather_y", y, COUNT_OF(y), d->words, 2));
  TRY(launch(d, "gather_z", z, COUNT_OF(z), d->words, 4));
  return launch(d, "entries", x, COUNT_OF(x), d->words, 1);
}

static stratus_status number_masks(const fields_device* d)
{
  const cl_uint masks = d->tree->mask_count, rows = d->tree->row_count;
  const stratus_kernel_argument starts[] = { ARGUMENT(d->bricks), ARGUMENT(d->order), ARGUMENT(d->leaves), ARGUMENT(d->leaf_count),
    ARGUMENT(masks), ARGUMENT(rows), ARGUMENT(d->results[ROWS].memory) };
  const stratus_kernel_argument numbers[] = { ARGUMENT(d->bricks), ARGUMENT(d->order), ARGUMENT(d->leaves), ARGUMENT(d->leaf_count),
    ARGUMENT(masks), ARGUMENT(rows), ARGUMENT(d->results[ROWS].memory), ARGUMENT(d->results[ENTRIES].memory) };
  TRY(launch(d, "rows", starts, COUNT_OF(starts), rows, 1));
  return launch(d, "numbers", numbers, COUNT_OF(numbers), rows, 1);
}

static stratus_status run(fields_device* d)
{
  stratus_tree* tree = d->tree;
  const cl_uint masks = tree->mask_count;
  const cl_ulong words = d->words;
  const stratus_kernel_argument none[] = { ARGUMENT(d->occupied), ARGUMENT(words) };
  const stratus_kernel_argument marks[] = { ARGUMENT(d->bricks), ARGUMENT(d->order), ARGUMENT(d->leaves), ARGUMENT(d->leaf_count),
    ARGUMENT(masks), ARGUMENT(d->occupied), ARGUMENT(d->results[MASKS].memory) };
  TRY(launch(d, "clear", none, COUNT_OF(none), d->words, 1));
  TRY(launch(d, "mark", marks, COUNT_OF(marks), masks, 1));
  TRY(fill_entries(d));
  TRY(number_masks(d));
  TRY(stratus_slot_receive(d->context, &d->results[ENTRIES], tree->entries, (size_t)tree->entry_count * (size_t)tree->entry_bytes));
  TRY(stratus_slot_receive(d->context, &d->results[ROWS], tree->rows, tree->row_count * sizeof(uint32_t)));
  return stratus_slot_receive(d->context, &d->results[MASKS], tree->masks, tree->mask_count * sizeof(uint64_t));
}

stratus_status stratus_device_tree_fields(
  stratus_context* context, const stratus_voxels* voxels, const stratus_tree_shape* shape, stratus_tree* tree)
{
  stratus_status status = STRATUS_OK;
  fields_device d = { .context = context, .tree = tree, .leaf_count = tree->field_count, .words = (cl_uint)words_of(tree) };
  snprintf(d.defines, sizeof d.defines, "-DBITS=%d -DSTRATUS_ARGUMENTS_BYTES=%zu", tree->entry_bytes, sizeof(stratus_leaf_arguments));
  TRY_CLEANUP(make_buffers(&d, voxels, shape));
  TRY_CLEANUP(run(&d));
cleanup:;
  stratus_slots_return(context, d.results, COUNT_OF(d.results));
  for (size_t i = 0; i < COUNT_OF(d.results); ++i) {
    stratus_slot_drop(&d.results[i]);
  }
  const cl_mem buffers[] = { d.bricks, d.order, d.leaves, d.occupied, d.along_y, d.along_z };
  for (size_t i = 0; i < COUNT_OF(buffers); ++i) {
    stratus_device_buffer_release(buffers[i]);
  }
  return status;
}
