/* SPDX-License-Identifier: BSD-3-Clause
 * The memory of a partition: arrays that grow while cells are cut, the result as callers read it, and the release of both. */
#include "partition_build.h"

#include <string.h>

stratus_status stratus_kdtree_reserve(stratus_context* context, void** memory, size_t* capacity, size_t needed, size_t used, size_t size)
{
  if (needed <= *capacity) {
    return STRATUS_OK;
  }
  const size_t grown = *capacity + *capacity / 2 + 16, room = grown > needed ? grown : needed;
  void* larger = NULL;
  TRY(stratus_allocate(context, room, size, &larger));
  if (used > 0) {
    memcpy(larger, *memory, used * size);
  }
  stratus_release(context, *memory);
  *memory = larger;
  *capacity = room;
  return STRATUS_OK;
}

void stratus_partition_destroy(stratus_partition* partition)
{
  if (!partition) {
    return;
  }
  stratus_context* context = partition->context;
  for (int32_t n = 0; n < partition->node_count; ++n) {
    stratus_release(context, partition->nodes[n].cells);
  }
  if (partition->along_capacity > 0) {
    stratus_release(context, partition->along);
  }
  stratus_release(context, partition->nodes);
  stratus_release(context, partition->points);
  stratus_release(context, partition->ends);
  stratus_release(context, partition->weights);
  stratus_release(context, partition->cut);
  stratus_release(context, partition->vertices);
  stratus_release(context, partition->cells);
  stratus_release(context, partition->leaf);
  stratus_release(context, partition->tree);
  stratus_release(context, partition);
}

void stratus_partition_get(const stratus_partition* partition, stratus_partition_result* result)
{
  if (!partition || !result) {
    if (result) {
      *result = (stratus_partition_result){ 0 };
    }
    return;
  }
  *result = (stratus_partition_result){ .points = partition->points,
    .point_count = partition->point_count,
    .vertices = partition->vertices,
    .cell_count = partition->cell_count,
    .cells = partition->cells,
    .leaves = { .nodes = partition->tree,
      .node_count = partition->node_count,
      .leaf_count = partition->leaf_count,
      .leaf = partition->leaf },
    .old_points = partition->old_points,
    .ends = partition->ends,
    .weights = partition->weights,
    .cut_cells = partition->cut_cells,
    .tiny_pieces = partition->tiny_pieces,
    .largest_leaf = partition->largest_leaf,
    .rotations = partition->rotations };
  memcpy(result->leaves.frame, partition->frame, sizeof partition->frame);
}
