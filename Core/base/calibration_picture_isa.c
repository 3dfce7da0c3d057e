/* SPDX-License-Identifier: BSD-3-Clause
 * A tile of the calibration picture on the host, compiled for one instruction set, STRATUS_ISA. */
#include "calibration_picture.h"

#include "calibration_ray.h"
#include "instruction_set.h"

#ifdef __GNUC__
#pragma GCC diagnostic ignored "-Wunused-function" /* the packets' headers have more than these rays need */
#endif

_Static_assert(CALIBRATION_PIXELS == STRATUS_CALIBRATION_SIDE, "kernel and host must draw the same picture");
_Static_assert(CALIBRATION_VALUES == STRATUS_CALIBRATION_VALUES, "kernel and host must march through the same volume");
_Static_assert(CALIBRATION_ENTRIES == STRATUS_CALIBRATION_ENTRIES, "kernel and host must read the same table");

void STRATUS_ISA_NAME(stratus_calibration_tile)(const float* values, const float* table, int tile, float* rgba)
{
  const int tiles = CALIBRATION_PIXELS / STRATUS_CALIBRATION_TILE;
  const int x0 = tile % tiles * STRATUS_CALIBRATION_TILE, y0 = tile / tiles * STRATUS_CALIBRATION_TILE;
  const vint across = vi_lanes() & vi_set(PACKET_X - 1), down = vi_lanes() >> vi_set(PACKET_X_LOG2);
  for (int y = y0; y < y0 + STRATUS_CALIBRATION_TILE; y += PACKET_Y) {
    for (int x = x0; x < x0 + STRATUS_CALIBRATION_TILE; x += PACKET_X) {
      vfloat pixel[4];
      float color[4][STRATUS_WIDTH];
      calibration_march(values, table, v_from_int(vi_set(x) + across), v_from_int(vi_set(y) + down), pixel);
      for (int c = 0; c < 4; ++c) {
        v_store(color[c], pixel[c]);
      }
      for (int lane = 0; lane < STRATUS_WIDTH; ++lane) {
        float* to = rgba + 4 * ((y + lane / PACKET_X) * CALIBRATION_PIXELS + x + lane % PACKET_X);
        for (int c = 0; c < 4; ++c) {
          to[c] = color[c][lane];
        }
      }
    }
  }
}
