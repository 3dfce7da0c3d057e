/* SPDX-License-Identifier: BSD-3-Clause
 * One type's tile of rays on the host: included by ray_cast_host.c with STRATUS_TYPE, STRATUS_PREINTEGRATED and RAY_NAME set. */
#include "../kernels/ray_cast.h"

static void RAY_NAME(tile)(const stratus_ray_cast_frame* frame, int x0, int y0, int x1, int y1, stratus_ray_counts* counts)
{
  const stratus_ray_cast_arguments* a = frame->arguments;
  tile_counts mine = { vi_set(0), vi_set(0), vi_set(0), 0 };
  stratus_packet k;
  for (int y = y0; y < y1; y += PACKET_Y) {
    for (int x = x0; x < x1; x += PACKET_X) {
      if (packet_outside(a, x, y)) {
        packet_nothing(&k);
      } else {
        RAY_NAME(ray_load)(a, frame->opaque_depth, x, y, &k);
        RAY_NAME(ray_march)(a, frame->values, frame->hidden, frame->map, frame->table, &k);
      }
      store_packet(frame, &k, x, y, &mine);
    }
  }
  add_counts(&mine, counts);
}

#undef RAY_NAME
#undef STRATUS_TYPE
