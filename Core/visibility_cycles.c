/* SPDX-License-Identifier: BSD-3-Clause
 * Cells that hide one another in a ring. No order is right for all of them: the relation through the face that is seen smallest gives way. */
#include "visibility_order.h"

/* A face through which a cell waits for a neighbour that waits itself. -1: none of those that it waits for does, but they are held back across
 * gaps: all else has come. */
static int face_in_front(const stratus_visibility_order* order, uint32_t cell)
{
  const int32_t* neighbours = order->ordered[cell].neighbours;
  for (int f = 0; f < 4; f++) {
    if (order->ordered[cell].state >> (4 + f) & 1 && stratus_order_waits_for(order, (uint32_t)neighbours[f]) > 0) {
      return f;
    }
  }
  return -1;
}

/* STRATUS_NO_CELL if what it waits for is held back. */
static uint32_t cell_in_front(const stratus_visibility_order* order, uint32_t cell)
{
  const int face = face_in_front(order, cell);
  return face < 0 ? STRATUS_NO_CELL : (uint32_t)order->ordered[cell].neighbours[face];
}

uint32_t stratus_order_break_cycle(stratus_visibility_order* order, uint32_t start, int64_t* steps)
{
  /* From cell to cell in front: one comes again. The one that is kept moves up each time the walk has doubled (Brent 1980). */
  uint32_t kept = start, cell = cell_in_front(order, start);
  int64_t power = 1, length = 1;
  for (; kept != cell && cell != STRATUS_NO_CELL; length++, ++*steps) {
    if (length == power) {
      kept = cell;
      power *= 2;
      length = 0;
    }
    cell = cell_in_front(order, cell);
  }
  if (cell == STRATUS_NO_CELL) {
    return cell;
  }
  uint32_t least = cell;
  double least_size = INFINITY;
  do {
    const double size = stratus_order_face_size(order, cell, face_in_front(order, cell));
    if (size < least_size) {
      least_size = size;
      least = cell;
    }
    cell = cell_in_front(order, cell);
    ++*steps;
  } while (cell != kept);

  const int face = face_in_front(order, least);
  const uint32_t front = cell_in_front(order, least);
  const int32_t* neighbours = order->ordered[front].neighbours;
  for (int f = 0; f < 4; f++) {
    if (neighbours[f] == (int32_t)least && order->ordered[front].state >> f & 1) {
      order->ordered[front].state = (uint8_t)(order->ordered[front].state & ~(1u << f));
      break;
    }
  }
  order->ordered[least].state = (uint8_t)(order->ordered[least].state & ~(16u << face));
  order->ordered[least].waiting--;
  return least;
}

static bool comes_before(const stratus_visibility_order* order, uint32_t p, uint32_t q)
{
  return order->ordered[p].key < order->ordered[q].key || (order->ordered[p].key == order->ordered[q].key && p < q);
}

static void sift_down(const stratus_visibility_order* order, uint32_t* cells, int64_t from, int64_t count)
{
  for (int64_t child; (child = 2 * from + 1) < count; from = child) {
    child += child + 1 < count && comes_before(order, cells[child], cells[child + 1]);
    if (!comes_before(order, cells[from], cells[child])) {
      return;
    }
    const uint32_t cell = cells[from];
    cells[from] = cells[child];
    cells[child] = cell;
  }
}

void stratus_order_sort_by_key(const stratus_visibility_order* order, uint32_t* cells, int64_t count)
{
  for (int64_t i = count / 2 - 1; i >= 0; i--) {
    sift_down(order, cells, i, count);
  }
  for (int64_t end = count - 1; end > 0; end--) {
    const uint32_t cell = cells[0];
    cells[0] = cells[end];
    cells[end] = cell;
    sift_down(order, cells, 0, end);
  }
}
