/* SPDX-License-Identifier: BSD-3-Clause
 * Where points are kept as they are seen in a view. A mesher numbers them in any order; cells that are near one another shall find theirs
 * near one another, too. */
#include "visibility_order.h"

#include <string.h>

#define SCATTERED 16    /* points of a cell further apart in the mean than one point in so many: numbers say nothing of where a point is */
#define FEW_POINTS 4096 /* that fit a cache in any order */

static bool is_scattered(const stratus_visibility_order* order)
{
  double distance = 0.0;
  int64_t asked = 0;
  for (int64_t cell = 0; cell < order->cell_count; cell += 61, ++asked) {
    const int32_t* v = order->vertices + 4 * cell;
    distance += fabs((double)v[1] - v[0]) + fabs((double)v[2] - v[0]) + fabs((double)v[3] - v[0]);
  }
  return order->point_count > FEW_POINTS && distance * SCATTERED > 3.0 * (double)asked * (double)order->point_count;
}

/* In the order in which cells ask for them; those that none asks for come last. */
stratus_status stratus_order_place_points(stratus_visibility_order* order)
{
  const size_t points = (size_t)order->point_count;
  uint32_t placed = 0;
  void* memory;
  if (!is_scattered(order)) {
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
