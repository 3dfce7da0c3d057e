/* SPDX-License-Identifier: BSD-3-Clause
 * The order of a leaf's cells in memory. Mesh generators write cells in any order, and code that goes from neighbour to neighbour then
 * waits for memory. So cells that lie scattered are listed in Morton order. All others stay as they are. */
#include "cell_morton.h"
#include "partition_build.h"

#include <string.h>

#define SCATTERED 0.1 /* of the leaf's size: mean distance from one cell to the next */
#define AXIS_BITS 10

/* The sum of a cell's corners: four times its middle. */
static void add_corners(const stratus_partition* partition, const stratus_kdtree_cell* cell, double sum[3])
{
  sum[0] = sum[1] = sum[2] = 0.0;
  for (int i = 0; i < 12; ++i) {
    sum[i % 3] += partition->points[3 * (int64_t)cell->vertex[i / 3] + i % 3];
  }
}

/* Sets low[] to the least of the leaf's sums of corners, and returns their largest extent along an axis. */
static double find_extent(const stratus_partition* partition, const stratus_kdtree_node* node, double low[3])
{
  double high[3] = { -INFINITY, -INFINITY, -INFINITY }, sum[3];
  low[0] = low[1] = low[2] = INFINITY;
  for (int64_t i = 0; i < node->count; ++i) {
    add_corners(partition, node->cells + i, sum);
    for (int a = 0; a < 3; ++a) {
      low[a] = fmin(low[a], sum[a]);
      high[a] = fmax(high[a], sum[a]);
    }
  }
  return fmax(fmax(high[0] - low[0], high[1] - low[1]), high[2] - low[2]);
}

/* Samples distances from one cell to the next in memory, as neighbours are not known yet. */
static bool is_scattered(const stratus_partition* partition, const stratus_kdtree_node* node, double extent)
{
  double distance = 0.0, here[3], next[3];
  int64_t asked = 0;
  for (int64_t i = 0; i + 1 < node->count; i += 61, ++asked) {
    add_corners(partition, node->cells + i, here);
    add_corners(partition, node->cells + i + 1, next);
    distance += fmax(fmax(fabs(next[0] - here[0]), fabs(next[1] - here[1])), fabs(next[2] - here[2]));
  }
  return node->count > STRATUS_MORTON_FEW_CELLS && distance > SCATTERED * extent * (double)asked;
}

/* The inputs of place_cell(), which places a cell on the curve. */
typedef struct leaf_places {
  const stratus_partition* partition;
  const stratus_kdtree_cell* cells;
  double low[3], extent;
} leaf_places;

static uint32_t place_cell(const void* data, int64_t cell, double at[3])
{
  const leaf_places* leaf = data;
  double sum[3];
  add_corners(leaf->partition, leaf->cells + cell, sum);
  for (int a = 0; a < 3; ++a) {
    at[a] = (sum[a] - leaf->low[a]) / leaf->extent * ((1 << AXIS_BITS) - 1);
  }
  return 0;
}

stratus_status stratus_kdtree_list_cells(const stratus_partition* partition, stratus_kdtree_node* node)
{
  stratus_context* context = partition->context;
  stratus_status status = STRATUS_OK;
  void *ranks = NULL, *cells = NULL;
  const size_t count = (size_t)node->count;
  leaf_places leaf = { .partition = partition, .cells = node->cells };
  leaf.extent = find_extent(partition, node, leaf.low);
  if (!(leaf.extent > 0.0) || !is_scattered(partition, node, leaf.extent)) {
    return STRATUS_OK;
  }
  const stratus_morton_cells places = { .count = node->count, .axis_bits = AXIS_BITS, .data = &leaf, .place = place_cell };
  TRY_CLEANUP(stratus_allocate(context, count, sizeof(uint32_t), &ranks));
  TRY_CLEANUP(stratus_morton_order(context, &places, ranks));
  TRY_CLEANUP(stratus_allocate(context, count, sizeof *node->cells, &cells));
  for (size_t i = 0; i < count; ++i) {
    ((stratus_kdtree_cell*)cells)[i] = node->cells[((const uint32_t*)ranks)[i]];
  }
  memcpy(node->cells, cells, count * sizeof *node->cells);

cleanup:
  stratus_release(context, ranks);
  stratus_release(context, cells);
  return status;
}
