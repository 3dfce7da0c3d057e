/* SPDX-License-Identifier: BSD-3-Clause
 * A pass of jump flooding (Rong & Tan 2006). Each voxel looks at the nearest effective voxel that it knows, and at those known to 26
 * others `step` away, and keeps the nearest of all. Of equally near ones it keeps the one of the smallest index, so that the order of
 * looking does not matter and host and device agree to the bit. */
#include "jump_flooding.h"

#ifndef WIDE
#define WIDE 0
#endif
#if WIDE
typedef long squared_length;
#define LENGTH_MAX LONG_MAX
#else
typedef int squared_length;
#define LENGTH_MAX INT_MAX
#endif
#ifndef GROUP
#define GROUP 64
#endif

static squared_length squared_distance(uint position, const int at[3], int shift_y, int shift_z)
{
  if (position == FLOOD_UNKNOWN) {
    return LENGTH_MAX;
  }
  const squared_length x = (int)(position & ((1u << shift_y) - 1)) - at[0];
  const squared_length y = (int)(position >> shift_y & ((1u << (shift_z - shift_y)) - 1)) - at[1];
  const squared_length z = (int)(position >> shift_z) - at[2];
  return x * x + y * y + z * z;
}

/* A group is GROUP items along x. Group g writes to sums[2 g] how many of its voxels came nearer, and to sums[2 g + 1] the sum of their
 * ratios. */
__kernel void flood(
  __global const uint* from, long nx, long ny, long nz, int step, int shift_y, int shift_z, __global uint* to, __global uint* sums)
{
  __local uint updated[GROUP], ratios[GROUP];
  const int item = (int)get_local_id(0);
  const int at[3] = { (int)get_global_id(0), (int)get_global_id(1), (int)get_global_id(2) };
  updated[item] = ratios[item] = 0;
  if (at[0] < nx) {
    const long here = ((long)at[2] * ny + at[1]) * nx + at[0];
    uint nearest = from[here];
    const squared_length before = squared_distance(nearest, at, shift_y, shift_z);
    squared_length now = before;
    for (int n = 0; n < 27; ++n) {
      const long x = at[0] + (long)step * (n % 3 - 1), y = at[1] + (long)step * (n / 3 % 3 - 1), z = at[2] + (long)step * (n / 9 - 1);
      if (x < 0 || x >= nx || y < 0 || y >= ny || z < 0 || z >= nz) {
        continue;
      }
      const uint position = from[(z * ny + y) * nx + x];
      const squared_length distance = squared_distance(position, at, shift_y, shift_z);
      if (distance < now || (distance == now && position < nearest)) {
        now = distance;
        nearest = position;
      }
    }
    to[here] = nearest;
    if (now < before) {
      updated[item] = 1;
      ratios[item] = before == LENGTH_MAX ? 0 : (uint)flood_ratio((float)now, (float)before);
    }
  }
  for (int other = GROUP / 2; other > 0; other /= 2) {
    barrier(CLK_LOCAL_MEM_FENCE);
    if (item < other) {
      updated[item] += updated[item + other];
      ratios[item] += ratios[item + other];
    }
  }
  if (item == 0) {
    const long group = ((long)get_group_id(2) * get_num_groups(1) + get_group_id(1)) * get_num_groups(0) + get_group_id(0);
    sums[2 * group] = updated[0];
    sums[2 * group + 1] = ratios[0];
  }
}
