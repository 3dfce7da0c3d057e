/* SPDX-License-Identifier: BSD-3-Clause
 * Data that all rays of a batch share, and which trees packets may walk. */
#include "first_hit_batch.h"

#include <string.h>

/* Computes the unit normals of the voxels' faces, which are the gradients of the index coordinates. */
static void find_normals(const stratus_tree* tree, double normal[6][3])
{
  for (int axis = 0; axis < 3; ++axis) {
    double length = 0.0;
    for (int a = 0; a < 3; ++a) {
      length = fmax(length, fabs(tree->world_to_index[4 * axis + a]));
    }
    double scaled[3], squares = 0.0;
    for (int a = 0; a < 3; ++a) {
      scaled[a] = tree->world_to_index[4 * axis + a] / length;
      squares += scaled[a] * scaled[a];
    }
    for (int a = 0; a < 3; ++a) {
      normal[2 * axis + 1][a] = scaled[a] / sqrt(squares);
      normal[2 * axis][a] = -normal[2 * axis + 1][a];
    }
  }
}

void stratus_hit_batch_begin(const stratus_tree* tree, stratus_hit_batch* batch)
{
  int32_t most = 1;
  *batch = (stratus_hit_batch){ .tree = tree, .leaves = tree->node_count != 1 || tree->field_count != 1 };
  memcpy(batch->to_voxels, tree->world_to_index, sizeof batch->to_voxels);
  for (int a = 0; a < 3; ++a) {
    batch->to_voxels[4 * a + 3] += 0.5;
    batch->lo[a] = tree->node_count ? tree->nodes[0].lo[a] : 0;
    batch->hi[a] = tree->node_count ? tree->nodes[0].hi[a] : 0;
    most = tree->dimensions[a] > most ? tree->dimensions[a] : most;
  }
  /* A float position results from a rounded start, direction and length: about five roundings of at most twice the longest edge. */
  batch->slack = 1.2e-7f * 8.0f * (float)most;
  find_normals(tree, batch->normal);
}

bool stratus_hit_takes_packets(const stratus_hit_batch* batch)
{
  const stratus_tree* tree = batch->tree;
  const bool planes = tree->statistics.method == STRATUS_TREE_HYBRID || tree->statistics.method == STRATUS_TREE_HYBRID_PAPER;
  return tree->wide.node_count > 0 ||
    (tree->node_count > 0 && (!batch->leaves || planes) && !tree->statistics.uncorrected && batch->slack <= 0.05f);
}

stratus_hit_arguments stratus_hit_arguments_of(const stratus_hit_batch* batch)
{
  const stratus_tree* tree = batch->tree;
  stratus_hit_arguments a = {
    .octants = tree->octants, .entry_bytes = tree->entry_bytes, .cell_log2 = tree->cell_log2, .slack = batch->slack
  };
  if (!batch->leaves) {
    for (int axis = 0; axis < 3; ++axis) {
      a.at[axis] = tree->fields[0].at[axis];
      a.cells[axis] = tree->fields[0].cells[axis];
    }
    a.row_start = (int)tree->fields[0].first_row;
  }
  return a;
}
