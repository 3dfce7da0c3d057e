/* SPDX-License-Identifier: BSD-3-Clause
 * A leaf's cells as they are listed. A mesher's cells come in any order; what then goes over a leaf's cells, neighbour by neighbour, spends its
 * time on memory. So cells that lie scattered are listed in Morton order; all others stay as they come. */
#include "bvh.h"
#include "kdtree.h"

#include "kernels/morton.h"

#include <string.h>

#define FEW_CELLS 4096 /* that fit a cache in any order */
#define SCATTERED 0.1  /* of the leaf's size from one cell to the next, in the mean */
#define AXIS_BITS 10

/* Four times the middle. */
static void add_corners(const stratus_partition* partition, const stratus_kdtree_cell* cell, double sum[3])
{
  sum[0] = sum[1] = sum[2] = 0.0;
  for (int i = 0; i < 12; i++) {
    sum[i % 3] += partition->points[3 * (int64_t)cell->vertex[i / 3] + i % 3];
  }
}

/* low, and the largest extent, of the sums. */
static double find_extent(const stratus_partition* partition, const stratus_kdtree_node* node, double low[3])
{
  double high[3] = { -INFINITY, -INFINITY, -INFINITY }, sum[3];
  low[0] = low[1] = low[2] = INFINITY;
  for (int64_t i = 0; i < node->count; i++) {
    add_corners(partition, node->cells + i, sum);
    for (int a = 0; a < 3; a++) {
      low[a] = fmin(low[a], sum[a]);
      high[a] = fmax(high[a], sum[a]);
    }
  }
  return fmax(fmax(high[0] - low[0], high[1] - low[1]), high[2] - low[2]);
}

static bool is_scattered(const stratus_partition* partition, const stratus_kdtree_node* node, double extent)
{
  double distance = 0.0, here[3], next[3];
  int64_t asked = 0;
  for (int64_t i = 0; i + 1 < node->count; i += 61, asked++) {
    add_corners(partition, node->cells + i, here);
    add_corners(partition, node->cells + i + 1, next);
    distance += fmax(fmax(fabs(next[0] - here[0]), fabs(next[1] - here[1])), fabs(next[2] - here[2]));
  }
  return node->count > FEW_CELLS && distance > SCATTERED * extent * (double)asked;
}

static uint32_t place_on_axis(double value, double low, double extent)
{
  const double scaled = (value - low) / extent * ((1 << AXIS_BITS) - 1);
  return scaled > 0.0 ? (scaled < (1 << AXIS_BITS) - 1 ? (uint32_t)scaled : (1 << AXIS_BITS) - 1) : 0;
}

stratus_status stratus_kdtree_list_cells(const stratus_partition* partition, stratus_kdtree_node* node)
{
  stratus_context* context = partition->context;
  stratus_status status = STRATUS_OK;
  void *keys = NULL, *ranks = NULL, *cells = NULL;
  double low[3], sum[3];
  const size_t count = (size_t)node->count;
  const double extent = find_extent(partition, node, low);
  if (!(extent > 0.0) || !is_scattered(partition, node, extent)) {
    return STRATUS_OK;
  }
  TRY_CLEANUP(stratus_allocate(context, count, sizeof(uint64_t), &keys));
  TRY_CLEANUP(stratus_allocate(context, count, sizeof(uint32_t), &ranks));
  for (size_t i = 0; i < count; i++) {
    add_corners(partition, node->cells + i, sum);
    ((uint64_t*)keys)[i] = morton_code(
      place_on_axis(sum[0], low[0], extent), place_on_axis(sum[1], low[1], extent), place_on_axis(sum[2], low[2], extent), 0);
    ((uint32_t*)ranks)[i] = (uint32_t)i;
  }
  TRY_CLEANUP(stratus_radix_sort(context, keys, ranks, (uint32_t)count, 3 * AXIS_BITS));
  TRY_CLEANUP(stratus_allocate(context, count, sizeof *node->cells, &cells));
  for (size_t i = 0; i < count; i++) {
    ((stratus_kdtree_cell*)cells)[i] = node->cells[((const uint32_t*)ranks)[i]];
  }
  memcpy(node->cells, cells, count * sizeof *node->cells);

cleanup:
  stratus_release(context, keys);
  stratus_release(context, ranks);
  stratus_release(context, cells);
  return status;
}
