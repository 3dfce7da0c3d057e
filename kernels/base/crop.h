/* SPDX-License-Identifier: BSD-3-Clause
 * Cuts rays into pieces that pass through shown regions only, of the 27 that two planes along each axis make. */
#ifndef STRATUS_CROP_H
#define STRATUS_CROP_H

#include "packet.h"
#include "picture_arguments.h"

/* 1 if the ray of `lane` is in a shown region at s. */
INLINE int crop_shows(int regions, const float crossing[3][2][STRATUS_WIDTH], const float d[3][STRATUS_WIDTH], int lane, float s)
{
  int region = 0;
  for (int axis = 2; axis >= 0; --axis) {
    const float low = crossing[axis][0][lane], high = crossing[axis][1][lane];
    const int forward = d[axis][lane] > 0.0f;
    const int below = forward ? s < low : s > low, above = forward ? s > high : s < high;
    region = 3 * region + (below ? 0 : above ? 2 : 1);
  }
  return regions >> region & 1;
}

/* Finds the pieces of each ray's part first..last, from..to. crossing: where a ray crosses the planes; d: above 0 if it goes up an axis.
 * Unused pieces are empty and come last. */
INLINE void crop_pieces(int regions, const float first[STRATUS_WIDTH], const float last[STRATUS_WIDTH],
  const float crossing[3][2][STRATUS_WIDTH], const float d[3][STRATUS_WIDTH], float from[CROP_PIECES][STRATUS_WIDTH],
  float to[CROP_PIECES][STRATUS_WIDTH])
{
  for (int lane = 0; lane < STRATUS_WIDTH; ++lane) {
    const float begin = first[lane], end = last[lane];
    float cut[8];
    int cuts = 0, pieces = 0, shown = 0;
    cut[cuts++] = begin;
    for (int side = 0; side < 6; ++side) {
      const float s = crossing[side / 2][side % 2][lane];
      int at = cuts;
      if (!(s > begin && s < end)) {
        continue;
      }
      for (; at > 1 && cut[at - 1] > s; --at) {
        cut[at] = cut[at - 1];
      }
      cut[at] = s;
      ++cuts;
    }
    cut[cuts] = end;
    for (int i = 0; i < cuts; ++i) {
      const int shows = cut[i] < cut[i + 1] && crop_shows(regions, crossing, d, lane, 0.5f * (cut[i] + cut[i + 1]));
      if (shows && !shown && pieces < CROP_PIECES) {
        from[pieces++][lane] = cut[i];
      }
      if (shows) {
        to[pieces - 1][lane] = cut[i + 1];
      }
      shown = cut[i] < cut[i + 1] ? shows : shown;
    }
    for (; pieces < CROP_PIECES; ++pieces) {
      from[pieces][lane] = to[pieces][lane] = 0.0f;
    }
  }
}

#endif
