/* SPDX-License-Identifier: BSD-3-Clause
 * Cells that hide one another in a ring: no order is right for all of them, so one relation gives way, on both sides of its face. */
#include "visibility_order.h"

void stratus_order_cut(stratus_visibility_order* order, uint32_t cell, int face)
{
  const uint32_t before = (uint32_t)order->neighbours[4 * (int64_t)cell + face];
  const unsigned after = stratus_order_after(order, before);
  order->state[cell] = (uint8_t)(order->state[cell] & ~(16u << face));
  for (int f = 0; f < 4; ++f) {
    if (after >> f & 1 && order->neighbours[4 * (int64_t)before + f] == (int32_t)cell) {
      order->state[before] = (uint8_t)(order->state[before] & ~(1u << f));
      return;
    }
  }
}
