/* SPDX-License-Identifier: BSD-3-Clause
 * Cells without volume are on no side of their faces, yet cells before and behind them hide one another through them. Each flat cell gets
 * the side that it would have if it were inflated a little: one that agrees with a neighbour's side, passed on from cell to cell. */
#include "visibility_order.h"

/* The neighbour's face with the same points as face f of the cell; -1: none. The signs are as in stratus_face_points(). */
static int find_face(const stratus_visibility_order* order, int64_t cell, int f, int64_t neighbour, int* sign, int* neighbour_sign)
{
  int32_t points[3], other[3];
  *sign = stratus_face_points(order->vertices + 4 * cell, f, points);
  for (int g = 0; g < 4; ++g) {
    *neighbour_sign = stratus_face_points(order->vertices + 4 * neighbour, g, other);
    if (points[0] == other[0] && points[1] == other[1] && points[2] == other[2] &&
      order->adjacency->neighbours[4 * neighbour + g] == cell) {
      return g;
    }
  }
  return -1;
}

/* The side that a cell needs to agree with the neighbour behind face f; 0: there is none, or it has no side. */
static int wanted_side(const stratus_visibility_order* order, int64_t cell, int f)
{
  const int64_t neighbour = order->adjacency->neighbours[4 * cell + f];
  int sign, neighbour_sign;
  if (neighbour < 0 || order->side[neighbour] == 0 || find_face(order, cell, f, neighbour, &sign, &neighbour_sign) < 0) {
    return 0;
  }
  return -sign * neighbour_sign * order->side[neighbour];
}

/* Breadth first: the queue holds the flat cells that have got a side, each once. */
static void spread_sides(stratus_visibility_order* order, uint32_t* queue)
{
  int64_t end = 0;
  for (int64_t cell = 0; cell < order->cell_count; ++cell) {
    for (int f = 0; f < 4 && order->side[cell] == 0; ++f) {
      const int64_t neighbour = order->adjacency->neighbours[4 * cell + f];
      if (neighbour >= 0 && order->adjacency->orientation[neighbour] != 0) {
        order->side[cell] = (int8_t)wanted_side(order, cell, f);
        if (order->side[cell] != 0) {
          queue[end++] = (uint32_t)cell;
        }
      }
    }
  }
  for (int64_t begin = 0; begin < end; ++begin) {
    const int32_t* neighbours = order->adjacency->neighbours + 4 * (int64_t)queue[begin];
    for (int f = 0; f < 4; ++f) {
      const int64_t neighbour = neighbours[f];
      for (int g = 0; g < 4 && neighbour >= 0 && order->side[neighbour] == 0; ++g) {
        if (order->adjacency->neighbours[4 * neighbour + g] == (int32_t)queue[begin]) {
          order->side[neighbour] = (int8_t)wanted_side(order, neighbour, g);
          if (order->side[neighbour] != 0) {
            queue[end++] = (uint32_t)neighbour;
          }
        }
      }
    }
  }
}

stratus_status stratus_order_side_flat_cells(stratus_visibility_order* order)
{
  void* queue;
  if (order->adjacency->flat == 0) {
    return STRATUS_OK;
  }
  TRY(stratus_allocate(order->context, (size_t)order->adjacency->flat, sizeof(uint32_t), &queue));
  spread_sides(order, queue);
  stratus_release(order->context, queue);
  for (int64_t cell = 0; cell < order->cell_count; ++cell) {
    for (int f = 0; f < 4 && order->adjacency->orientation[cell] == 0; ++f) {
      const int64_t neighbour = order->adjacency->neighbours[4 * cell + f];
      int sign, neighbour_sign;
      const int g = neighbour < 0 ? -1 : find_face(order, cell, f, neighbour, &sign, &neighbour_sign);
      if (g >= 0 && order->side[cell] * order->side[neighbour] * sign * neighbour_sign >= 0) {
        order->adjacency->neighbours[4 * cell + f] = order->adjacency->neighbours[4 * neighbour + g] = -1;
        order->adjacency->folded_faces += 2;
      }
    }
  }
  return STRATUS_OK;
}
