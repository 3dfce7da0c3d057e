/* SPDX-License-Identifier: BSD-3-Clause
 * Walks a ray among voxels of any widths, through the distance field of their bricks, up to the first effective voxel. One ray, in double;
 * host and device run the same source.
 *
 * A crossing of a plane between voxels is known by its t and its axis, t = (plane - origin) / direction. Crossings are ordered by t, and at
 * equal t by the axis. The voxel that a ray is in after a crossing follows from only that order: of each axis, the planes behind the
 * crossing are counted by bisection. So a leap over empty bricks ends in the voxel in which the walk from voxel to voxel would be, to the
 * bit (voxel_walk.c). */
#ifndef STRATUS_FIRST_HIT_STRETCHED_H
#define STRATUS_FIRST_HIT_STRETCHED_H

#include "first_hit_arguments.h"
#include "packet.h"

#ifdef STRATUS_DEVICE
typedef ulong hit_mask;
#else
#include <stdbool.h>
typedef uint64_t hit_mask;
#endif

typedef struct hit_stretched {
  CONSTANT stratus_stretched_arguments* a;
  GLOBAL const uchar* entries;
  GLOBAL const uint* rows;
  GLOBAL const hit_mask* masks;
  GLOBAL const double* borders;
  double o[3], d[3], t_min, t_max; /* in voxel coordinates of the mean spacing */
} hit_stretched;

INLINE double stretched_border(const hit_stretched* w, int axis, int voxel)
{
  return w->a->border_at[axis] < 0 ? (double)voxel : w->borders[w->a->border_at[axis] + voxel];
}

INLINE double stretched_time(const hit_stretched* w, int axis, int plane)
{
  return (stretched_border(w, axis, plane) - w->o[axis]) / w->d[axis];
}

/* Whether a crossing comes after another. Axis 3 is the ray's beginning, which comes after every crossing of the same t. */
INLINE bool stretched_after(double t, int axis, double than, int than_axis) { return t > than || (t == than && axis > than_axis); }

/* Returns the voxel along an axis right after the crossing (t, by), which lies among first .. last in the ray's own direction, or one
 * beyond either. */
INLINE int stretched_place(const hit_stretched* w, int axis, int first, int last, double t, int by)
{
  const int up = w->d[axis] > 0.0;
  int from = 0, to = (up ? last - first : first - last) + 2; /* planes behind the crossing */
  while (from < to) {
    const int middle = from + (to - from) / 2, plane = up ? first + middle : first + 1 - middle;
    if (stretched_after(stretched_time(w, axis, plane), axis, t, by)) {
      to = middle;
    } else {
      from = middle + 1;
    }
  }
  return up ? first + from - 1 : first + 1 - from;
}

/* Returns the voxel among first .. last that a ray is in which does not move along the axis; last + 1 if it is in none. */
INLINE int stretched_rest(const hit_stretched* w, int axis, int first, int last)
{
  const int beyond = last + 1;
  if (!(w->o[axis] >= stretched_border(w, axis, first) && w->o[axis] < stretched_border(w, axis, beyond))) {
    return beyond;
  }
  while (first < last) {
    const int middle = first + (last - first + 1) / 2;
    if (stretched_border(w, axis, middle) <= w->o[axis]) {
      first = middle;
    } else {
      last = middle - 1;
    }
  }
  return first;
}

/* Returns how many bricks a ray may leap from a voxel's brick; 0 if the brick is not empty, -1 if the voxel is effective. */
INLINE int stretched_look(const hit_stretched* w, const int voxel[3], int octant)
{
  CONSTANT stratus_stretched_arguments* a = w->a;
  const int bits = a->entry_bytes, low = (1 << bits) - 1;
  const int row = ((voxel[2] >> 2) - a->at[2]) * a->cells[1] + (voxel[1] >> 2) - a->at[1];
  GLOBAL const uchar* e = w->entries + ((size_t)row * (size_t)a->cells[0] + (size_t)((voxel[0] >> 2) - a->at[0])) * (size_t)bits;
  const uint entry = (uint)e[0] | (uint)e[1] << 8 | (bits == 3 ? (uint)e[2] << 16 : 0u);
  if (!(entry & (uint)low)) {
    const int bit = (voxel[0] & 3) | (voxel[1] & 3) << 2 | (voxel[2] & 3) << 4;
    return -(int)(w->masks[w->rows[row] + (entry >> bits)] >> bit & 1u);
  }
  if (!a->octants) {
    return (int)((entry & 0xffffu) >> 2);
  }
  const int code = (int)(entry >> (octant * bits)) & low;
  return bits == 2 ? (1 << code) >> 1 : ((2 + (code & 1)) << (code >> 1)) >> 1;
}

/* Returns whether the ray meets an effective voxel, and finds it. Sets the number of voxels and leaps. */
INLINE bool stretched_walk(const hit_stretched* w, int voxel[3], int* visited)
{
  CONSTANT stratus_stretched_arguments* a = w->a;
  double t = w->t_min;
  int by = 3, octant = 0;
  *visited = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const int first = 4 * a->at[axis], beyond = first + 4 * a->cells[axis];
    octant |= (w->d[axis] > 0.0) << axis;
    if (w->d[axis] != 0.0) {
      const double enters = stretched_time(w, axis, w->d[axis] > 0.0 ? first : beyond);
      if (stretched_after(enters, axis, t, by)) {
        t = enters;
        by = axis;
      }
    }
  }
  for (int axis = 0; axis < 3; ++axis) {
    const int first = 4 * a->at[axis], last = first + 4 * a->cells[axis] - 1;
    voxel[axis] = w->d[axis] == 0.0 ? stretched_rest(w, axis, first, last)
      : w->d[axis] > 0.0            ? stretched_place(w, axis, first, last, t, by)
                                    : stretched_place(w, axis, last, first, t, by);
  }
  while (t <= w->t_max && t < (double)INFINITY) {
    int far[3]; /* the last voxel that is known to be empty */
    double leave[3];
    for (int axis = 0; axis < 3; ++axis) {
      if (voxel[axis] < 4 * a->at[axis] || voxel[axis] >= 4 * (a->at[axis] + a->cells[axis])) {
        return false;
      }
    }
    ++*visited;
    const int leap = stretched_look(w, voxel, octant);
    if (leap < 0) {
      return true;
    }
    for (int axis = 0; axis < 3; ++axis) {
      const int up = w->d[axis] > 0.0, brick = voxel[axis] >> 2, last = a->at[axis] + a->cells[axis] - 1;
      const int ahead = brick + leap - 1 < last ? brick + leap - 1 : last;
      const int behind = brick + 1 - leap > a->at[axis] ? brick + 1 - leap : a->at[axis];
      far[axis] = leap == 0 ? voxel[axis] : up ? 4 * ahead + 3 : 4 * behind;
      leave[axis] = w->d[axis] == 0.0 ? (double)INFINITY : stretched_time(w, axis, far[axis] + up);
    }
    by = leave[0] <= leave[1] ? (leave[0] <= leave[2] ? 0 : 2) : (leave[1] <= leave[2] ? 1 : 2);
    t = leave[by];
    for (int axis = 0; axis < 3; ++axis) {
      if (axis == by) {
        voxel[axis] = far[axis] + (w->d[axis] > 0.0 ? 1 : -1);
      } else if (far[axis] != voxel[axis] && w->d[axis] != 0.0) {
        voxel[axis] = stretched_place(w, axis, voxel[axis], far[axis], t, by);
      }
    }
  }
  return false;
}

#endif
