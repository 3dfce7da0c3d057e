/* SPDX-License-Identifier: BSD-3-Clause
 * The places of cells and points in memory. Cells are listed leaf by leaf, so that a leaf is a range of places. Peeling goes from neighbour
 * to neighbour, so cells that lie scattered in memory are listed along a Morton curve. Points that lie scattered are kept in the order in
 * which the cells read them. */
#include "cell_morton.h"
#include "visibility_order.h"

#include <string.h>

/* Cells are scattered if neighbours' numbers differ in the mean by more than 1/SCATTERED of a leaf. Points are scattered if the numbers of
 * one cell's points differ in the mean by more than 1/SCATTERED of all points. */
#define SCATTERED 16
#define FEW_POINTS 4096 /* so many fit a cache in any order */
#define AXIS_BITS 10
#define LEAF_BITS 16

/* Samples neighbours of the same leaf, and measures how far apart the mesh lists them. */
static bool cells_are_scattered(const stratus_visibility_order* order, const int32_t* leaf)
{
  int64_t pairs = 0;
  double distance = 0.0;
  for (int64_t i = 0; i < 4 * order->cell_count; i += 61) { /* odd: samples all four faces of cells alike */
    const int64_t neighbour = order->adjacency->neighbours[i];
    const bool together = neighbour >= 0 && (!leaf || leaf[neighbour] == leaf[i / 4]);
    pairs += together;
    distance += together ? fabs((double)(neighbour - i / 4)) : 0.0;
  }
  const double cells = (double)order->cell_count / order->leaf_count;
  return cells > STRATUS_MORTON_FEW_CELLS && distance * SCATTERED > (double)pairs * cells;
}

/* The inputs of place_cell(), which places a cell on the curve. */
typedef struct cell_places {
  const stratus_visibility_order* order;
  const int32_t* leaf;
  double scale;
} cell_places;

static uint32_t place_cell(const void* data, int64_t cell, double at[3])
{
  const cell_places* places = data;
  const stratus_visibility_order* order = places->order;
  for (int a = 0; a < 3; ++a) {
    double middle = 0.0;
    for (int v = 0; v < 4; ++v) {
      middle += 0.25 * (order->points[3 * (int64_t)order->vertices[4 * cell + v] + a] - order->bounds[2 * a]);
    }
    at[a] = middle * places->scale;
  }
  return places->leaf ? (uint32_t)places->leaf[cell] : 0;
}

/* Fills `listed`: leaf by leaf, by the Morton code of the cells' middles. */
static stratus_status list_by_place(stratus_visibility_order* order, const int32_t* leaf)
{
  const double* b = order->bounds;
  const double size = fmax(fmax(b[1] - b[0], b[3] - b[2]), b[5] - b[4]);
  const cell_places places = { order, leaf, size > 0.0 ? ((1 << AXIS_BITS) - 1) / size : 0.0 };
  const stratus_morton_cells cells = {
    .count = order->cell_count, .axis_bits = AXIS_BITS, .group_bits = LEAF_BITS, .data = &places, .place = place_cell
  };
  return stratus_morton_order(order->context, &cells, order->listed);
}

/* Makes leaf_begin, and `listed` unless the cells can stay as they come. */
static stratus_status list_cells(stratus_visibility_order* order, const int32_t* leaf)
{
  bool listed = true; /* leaf by leaf, as they come */
  void* memory;
  for (int64_t cell = 0; cell < order->cell_count; ++cell) {
    order->leaf_begin[(leaf ? leaf[cell] : 0) + 1]++;
    listed = listed && (cell == 0 || !leaf || leaf[cell - 1] <= leaf[cell]);
  }
  for (int32_t l = 0; l < order->leaf_count; ++l) {
    order->leaf_begin[l + 1] += order->leaf_begin[l];
  }
  const bool scattered = cells_are_scattered(order, leaf);
  if (listed && !scattered) {
    return STRATUS_OK;
  }
  TRY(stratus_order_allocate(order, (size_t)order->cell_count, sizeof *order->listed, &memory));
  order->listed = memory;
  if (scattered) {
    return list_by_place(order, leaf);
  }
  for (int64_t cell = 0; cell < order->cell_count; ++cell) {
    order->listed[order->leaf_begin[leaf[cell]]++] = (uint32_t)cell;
  }
  for (int32_t l = order->leaf_count; l > 0; --l) {
    order->leaf_begin[l] = order->leaf_begin[l - 1];
  }
  order->leaf_begin[0] = 0;
  return STRATUS_OK;
}

/* Neighbours are cells of the same leaf only: the leaves' order decides between leaves. places: each cell's; NULL: its own number. */
static void fill_cells(stratus_visibility_order* order, const int8_t* side, const int32_t* leaf, const uint32_t* places)
{
#pragma omp parallel for schedule(static) num_threads(order->context->threads)
  for (int64_t place = 0; place < order->cell_count; ++place) {
    const uint32_t cell = stratus_order_cell(order, (uint32_t)place);
    unsigned sides = (unsigned)(side[cell] + 1) << 4;
    for (int f = 0; f < 4; ++f) {
      const int32_t neighbour = order->adjacency->neighbours[4 * (int64_t)cell + f];
      const bool other = neighbour < 0 || (leaf && leaf[neighbour] != leaf[cell]);
      order->neighbours[4 * place + f] = other ? (int32_t)place : places ? (int32_t)places[neighbour] : neighbour;
      sides |= (unsigned)!other << f;
    }
    order->sides[place] = (uint8_t)sides;
  }
}

static stratus_status allocate_cells(stratus_visibility_order* order)
{
  const size_t cells = (size_t)order->cell_count;
  void* memory;
  TRY(stratus_order_allocate(order, cells, 4 * sizeof *order->neighbours, &memory));
  order->neighbours = memory;
  TRY(stratus_order_allocate(order, cells, sizeof *order->sides, &memory));
  order->sides = memory;
  TRY(stratus_order_allocate(order, cells, sizeof *order->state, &memory));
  order->state = memset(memory, 0, cells);
  TRY(stratus_order_allocate(order, cells, sizeof *order->waiting, &memory));
  order->waiting = memory;
  return STRATUS_OK;
}

stratus_status stratus_order_take_cells(stratus_visibility_order* order, const int8_t* side, const int32_t* leaf)
{
  void* places = NULL;
  TRY(list_cells(order, leaf));
  TRY(allocate_cells(order));
  if (order->listed) {
    TRY(stratus_allocate(order->context, (size_t)order->cell_count, sizeof(uint32_t), &places));
    for (int64_t place = 0; place < order->cell_count; ++place) {
      ((uint32_t*)places)[order->listed[place]] = (uint32_t)place;
    }
  }
  fill_cells(order, side, leaf, places);
  stratus_release(order->context, places);
  return STRATUS_OK;
}

/* ---- points */

static bool points_are_scattered(const stratus_visibility_order* order)
{
  double distance = 0.0;
  int64_t asked = 0;
  for (int64_t cell = 0; cell < order->cell_count; cell += 61, ++asked) {
    const int32_t* v = order->vertices + 4 * cell;
    distance += fabs((double)v[1] - v[0]) + fabs((double)v[2] - v[0]) + fabs((double)v[3] - v[0]);
  }
  return order->point_count > FEW_POINTS && distance * SCATTERED > 3.0 * (double)asked * (double)order->point_count;
}

/* Numbers points in the order in which cells name them; points that no cell names come last. */
stratus_status stratus_order_place_points(stratus_visibility_order* order)
{
  const size_t points = (size_t)order->point_count;
  uint32_t placed = 0;
  void* memory;
  if (!points_are_scattered(order)) {
    return STRATUS_OK;
  }
  TRY(stratus_order_allocate(order, points, sizeof *order->seen_at, &memory));
  order->seen_at = memset(memory, 0xff, points * sizeof *order->seen_at);
  for (int64_t i = 0; i < order->cell_count; ++i) {
    const int32_t* v = stratus_order_vertices(order, (uint32_t)i);
    for (int k = 0; k < 4; ++k) {
      uint32_t* at = order->seen_at + v[k];
      *at = *at == UINT32_MAX ? placed++ : *at;
    }
  }
  for (size_t p = 0; p < points; ++p) {
    order->seen_at[p] = order->seen_at[p] == UINT32_MAX ? placed++ : order->seen_at[p];
  }
  return STRATUS_OK;
}
